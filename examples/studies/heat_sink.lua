-- SPDX-License-Identifier: MIT
-- Study: a heat sink, as light as temperature and stress allow.
--   build/barwright examples/studies/heat_sink.lua [FOLDER] [--quick]
--
-- An aluminium sink with five fins, 50 x 40 mm wide, cools a chip of 25 W by moving air. It sits between two stiff
-- rails, so what the heat expands is pressed back: the stress comes from the computed temperatures. How thick are
-- base and fins, and how high, for the least mass? The chip may get 75 C hot, and a stress of 85 MPa is allowed.
local bw = require "barwright"
local quick = arg[#arg] == "--quick"
local folder = arg[1] ~= "--quick" and arg[1] or "out/heat_sink" .. (quick and "_quick" or "")
local mm, celsius = 1e-3, 273.15
local width, depth, fins, air = 50 * mm, 40 * mm, 5, 20 + celsius
local aluminium = bw.material.aluminium

-- Five fins and four gaps along x, base and fins along z: cells of a grid that are moved, n for each; those of the
-- gaps go.
local function sink(point, n)
  local base, high = n, 3 * n
  local cells = {(2 * fins - 1) * n, 3 * n, base + high}
  local box = bw.mesh.box {max = {1, 1, 1}, cells = cells, order = 2}
  local gap = (width - fins * point.fin) / (fins - 1)
  local places, keep = box.nodes:totable(), {}
  for _, p in ipairs(places) do
    local k, up = p[1] * (2 * fins - 1), p[3] * cells[3]
    local pairs_before, rest = k // 2, k % 2
    p[1] = pairs_before * (point.fin + gap) + math.min(rest, 1) * point.fin + math.max(rest - 1, 0) * gap
    p[2] = p[2] * depth
    p[3] = up <= base and up / base * point.base or point.base + (up - base) / high * point.height
  end
  local unit = box.nodes
  for e, corners in ipairs(box.elements:totable()) do
    local x, z = 0, 0
    for c = 1, 4 do x, z = x + unit(corners[c], 1) / 4, z + unit(corners[c], 3) / 4 end
    keep[e] = (z * cells[3] < base or x * (2 * fins - 1) % 2 < 1) and 1 or 0
  end
  return assert(assert(box:moved(places)):subset(bw.array(keep)))
end

-- Temperatures first, then what they do to the part.
local function measure(point, n)
  local mesh = sink(point, n)
  local bottom = mesh.boundary:below("z", 0)
  local heat = bw.heat {mesh = mesh, material = aluminium}
  local chip = bottom:box({0.3 * width, 0.25 * depth, -1}, {0.7 * width, 0.75 * depth, 1})
  heat:load {on = chip, power = 25}
  heat:load {on = mesh.boundary:difference(bottom), convection = {coefficient = 30, temperature = air}}
  local steady, message = heat:solve()
  if not steady then return nil, message end
  local part = bw.model {mesh = mesh, material = aluminium}
  local rails = mesh.boundary:below("z", point.base)
  part:slide(rails:below("x", 0), {1, 0, 0}):slide(rails:above("x", width - 1e-9), {1, 0, 0})
  part:slide(bottom:nearest({width / 2, depth / 2, 0}, 1), {0, 1, 0})
  part:slide(bottom, {0, 0, 1}):temperature(steady.temperature - air)
  local static
  static, message = part:solve()
  if not static then return nil, message end
  -- At the roots of fins, re-entrant edges, no stress has a finite value: the bottom is judged.
  local stress = static.von_mises:gather(bottom.nodes):max()
  return {mass = mesh.volume * aluminium.density, hottest = steady.highest - celsius, stress = stress},
    {steady = steady, static = static}
end

local results = assert(bw.results.open(folder, {script = arg[0], seed = 1}))
local study = bw.study {
  name = "heat sink", seed = 1, file = results:path(quick and "sink_quick.study" or "sink.study"),
  variables = {
    {name = "base", unit = "m", min = 1.5 * mm, max = 8 * mm, default = 5 * mm},
    {name = "fin", unit = "m", min = 1 * mm, max = 5 * mm, default = 2 * mm},
    {name = "height", unit = "m", min = 10 * mm, max = 60 * mm, default = 30 * mm},
  },
  measures = {{name = "mass", unit = "kg"}, {name = "hottest", unit = "C"}, {name = "stress", unit = "Pa"}},
  objectives = {{name = "mass", goal = "min"}},
  constraints = {{name = "hottest", max = 75}, {name = "stress", max = 85e6}},
  design = {"minimise", evaluations = quick and 6 or 80, tolerance = 1e-3},
  run = function(point)
    local measures, message = measure(point, quick and 1 or 2)
    return measures, type(message) == "string" and message or nil
  end,
}
local trials = assert(study:run())
print(trials)
local best = trials:best() or trials[#trials]
local function say(what, r)
  print(("%s: %.1f g, hottest place %.1f C, stress %.1f MPa"):format(what, 1e3 * r.mass, r.hottest,
    r.stress / 1e6))
end
print(("base %.2f mm, fins %.2f mm thick and %.1f mm high"):format(best.point.base / mm, best.point.fin / mm,
  best.point.height / mm))
say("the study", best.results)

-- A finer mesh of that design gives an estimate of the errors.
local finer, solutions = measure(best.point, quick and 2 or 3)
say("on a finer mesh", finer)
assert(math.abs(finer.hottest - best.results.hottest) < (quick and 8 or 2))
assert(math.abs(finer.stress / best.results.stress - 1) < 0.25)
assert(solutions.steady:picture(results:path "temperature.png"))
assert(solutions.static:picture(results:path "stress.png"))
assert(trials:report(results:path "sink.html"))
assert(results:write {mass_kg = best.results.mass, hottest_c = finer.hottest, stress_pa = finer.stress})
