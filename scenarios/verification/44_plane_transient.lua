-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Transient sheets: the period of a cantilever and how Newmark's method stretches it, resonance, energy.
local bw = require "barwright"
local tools = require "tools"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Sheets: transient dynamics",
  text = [[Newmark's method: a cantilever fifty times as long as thick, released under gravity or with its support
moved, and a plate with a hole (sides straight: integrals are exact) whose energy is summed outside the engine.]]}

local LENGTH, HEIGHT, YOUNG, DENSITY = 1, 0.02, 1e7, 1000
-- omega of the lowest bending mode (Euler-Bernoulli)
local OMEGA = 1.875104068711961 ^ 2 * math.sqrt(YOUNG * HEIGHT ^ 2 / 12 / DENSITY) / LENGTH ^ 2
local PERIOD = 2 * math.pi / OMEGA

local function beam(more)
  local options = {outline = assert(bw.outline.rectangle {min = {0, 0}, max = {LENGTH, HEIGHT},
    tags = {left = 4}}), order = 2, size = HEIGHT, ground = "left",
    material = tools.elastic(YOUNG, 0, DENSITY)}
  for key, value in pairs(more) do options[key] = value end
  local s = assert(bw.responsive.vibration(options))
  return s, tools.node(s, LENGTH, HEIGHT)
end

-- The mean period of a tip released under gravity, which swings about its static deflection.
local function period(step, periods)
  local g = 1e-3
  local s, tip = beam {step = step, gravity = {0, -g}}
  local static = -g * 1.5 * DENSITY * LENGTH ^ 4 / (YOUNG * HEIGHT ^ 2) -- q L^4 / 8 E I
  local times, last = {}, 0
  while #times < 2 * periods + 1 do
    assert(s:step())
    local now = s.displacement(tip, 2)
    if (now < static) ~= (last < static) then
      times[#times + 1] = s.time - step * (now - static) / (now - last)
    end
    last = now
  end
  return (times[#times] - times[1]) / periods
end

local function energies(s, e, nu, density, gravity)
  local u, v, sum, kinetic = s.displacement, s.velocity, 0, 0
  local f = e / (1 - nu * nu)
  tools.integrate(s.mesh, u, function(_, _, w, at, g)
    local x, y, t = g[1][1], g[2][2], g[1][2] + g[2][1]
    sum = sum + w * (0.5 * f * (x * x + y * y + 2 * nu * x * y + (1 - nu) / 2 * t * t)
      - density * (at[1] * gravity[1] + at[2] * gravity[2]))
  end)
  tools.integrate(s.mesh, v, function(_, _, w, at)
    kinetic = kinetic + 0.5 * density * w * (at[1] ^ 2 + at[2] ^ 2)
  end)
  return sum, kinetic
end

scenario("Periods of a cantilever", {tags = {"slow"}}, function()
  expect(period(PERIOD / 100, 10), "period of the lowest mode, 100 steps a period", "s")
    :near(PERIOD, {relative = 0.003, source = "Euler-Bernoulli"})
  for _, n in ipairs {12, 24} do
    local fine = period(PERIOD / 200, 5)
    local longer = math.pi / n / math.atan(math.pi / n)
    expect(period(PERIOD / n, 40) / fine, ("period at %d steps a period / at 200"):format(n))
      :near(longer / (math.pi / 200 / math.atan(math.pi / 200)),
        {relative = 0.001, source = "trapezoidal rule: tan(w' dt / 2) = w dt / 2"})
  end
end)

scenario("Resonance of a cantilever", {tags = {"slow"}}, function(t)
  local ratio, step, amplitude = 0.05, PERIOD / 60, 1e-4
  local s, tip = beam {step = step, damping = {0, 2 * ratio / OMEGA},
    ground_motion = {y = function(_, _, time) return amplitude * math.sin(OMEGA * time) end}}
  t:require(s:step(60 * 20))
  local max = 0
  for _ = 1, 120 do
    t:require(s:step())
    max = math.max(max, math.abs(s.displacement(tip, 2) - amplitude * math.sin(OMEGA * s.time)))
  end
  expect(max / amplitude, "amplitude at resonance / that of the ground, damping ratio 0.05")
    :near(1.56598 / (2 * ratio), {relative = 0.01, source = "modal analysis, first mode"})
end)

local function energy(t, rounds)
  for order = 1, 2 do
    local gravity = {1, -2}
    local plate = t:require(bw.responsive.vibration {outline = assert(bw.outline.rectangle {width = 2, height = 1,
      tags = {left = 4}, holes = {{{0.5, 0.4}, {0.8, 0.4}, {0.7, 0.7}}}}), ground = "left",
      elements = 300, order = order, material = tools.elastic(1e6, 0.3, 1000), step = 2e-3,
      gravity = gravity, solver = bw.solver.pcg {preconditioner = bw.solver.cholesky(), tolerance = 1e-12}})
    local largest, worst = 0, 0
    for _ = 1, rounds do
      t:require(plate:step(40))
      local other, kinetic = energies(plate, 1e6, 0.3, 1000, gravity)
      largest, worst = math.max(largest, kinetic), math.max(worst, math.abs(other + kinetic))
    end
    expect(worst / largest, ("energy gained or lost / largest kinetic energy, tri%d, %d steps"):format(3 * order,
      40 * rounds)):below(1e-7, {source = "kept by beta = 1/4, gamma = 1/2"})
  end
end

scenario("Energy of a plate", function(t) energy(t, 25) end)

scenario("Energy of a plate, longer", {tags = {"slow"}}, function(t) energy(t, 100) end)
