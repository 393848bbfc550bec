-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Transient dynamics with a known period: a pendulum that swings far, a cantilever that vibrates.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Nonlinear solids: transient dynamics with a known period",
  text = [[A pendulum that swings far, a cantilever that vibrates.]]}

-- Complete elliptic integral of the first kind by the arithmetic-geometric mean.
local function elliptic(k)
  local a, b = 1, math.sqrt(1 - k * k)
  for _ = 1, 40 do a, b = (a + b) / 2, math.sqrt(a * b) end
  return math.pi / (2 * a)
end

-- Times at which value() of a motion passes zero, up to `count` of them.
local function crossings(motion, step, count, value)
  local times, before = {}, value()
  while #times < count do
    assert(motion:step())
    local now = value()
    if before * now < 0 then
      times[#times + 1] = motion.time - step * now / (now - before)
    end
    before = now
    assert(motion.steps < 100000, "it does not swing")
  end
  return times
end

-- A stiff bar hinged on an edge, released from the horizontal: released at 90 degrees, its period is that
-- of a physical pendulum. Moments of the lumped masses, which are what moves.
local function pendulum(scheme, parts)
  local grid = assert(bw.grid.box {size = {1, 0.1, 0.1}, cells = {10, 1, 1}})
  local solid = assert(bw.solid {grid = grid,
    materials = {bw.hyperelastic {law = "corotated", young = 1e9, poisson = 0.3, density = 1000}}})
  solid:fix {where = function(x, _, z) return math.abs(x) < 1e-9 and math.abs(z) < 1e-9 end}
  local g, points, mass = 9.81, grid.points:totable(), solid.mass:totable()
  local first, second, m = {0, 0}, 0, 0
  for i, p in ipairs(points) do
    local mi = type(mass[i]) == "table" and mass[i][1] or mass[i]
    m, second = m + mi, second + mi * (p[1] ^ 2 + p[3] ^ 2)
    first = {first[1] + mi * p[1], first[2] + mi * p[3]}
  end
  local arm = math.sqrt(first[1] ^ 2 + first[2] ^ 2) -- times the mass
  local rise = math.atan(first[2], first[1])         -- of the centre of mass over the horizontal
  local amplitude = math.pi / 2 + rise
  local period = 4 * math.sqrt(second / (g * arm)) * elliptic(math.sin(amplitude / 2))
  solid:gravity {0, 0, -g}
  local step = period / parts
  local motion = assert(solid:transient {scheme = scheme, step = step, tolerance = 1e-9})
  local tip = grid:nodes {where = function(x, _, z) return x > 1 - 1e-9 and z < 1e-9 end}
  -- the angle of the bar's lower edge under the horizontal, past that at which its centre of mass hangs below
  local function angle()
    local u = motion.displacement:gather(tip):totable()[1]
    local below = math.atan(-u[3], 1 + u[1])
    if below < -math.pi / 2 then below = below + 2 * math.pi end -- it swings past the horizontal
    return below - math.pi / 2 - rise
  end
  local first_energy = motion.kinetic + motion.strain + motion.potential
  local times = crossings(motion, step, 3, angle)
  local energy = motion.kinetic + motion.strain + motion.potential
  return (times[3] - times[1]) / period - 1, math.abs(energy - first_energy) / (g * arm)
end

-- A cantilever released from under a small load at its tip: nearly its lowest mode.
local function cantilever(cells, parts)
  local length, side, young, density = 1, 0.05, 1e6, 1000
  local grid = assert(bw.grid.box {size = {length, side, side}, cells = {cells, 1, 1}})
  local solid = assert(bw.solid {grid = grid,
    materials = {bw.hyperelastic {law = "corotated", young = young, poisson = 0, density = density}}})
  solid:fix {side = "min x"}
  solid:force({side = "max x"}, {0, 0, 1e-4})
  local deflected = assert(solid:solve {tolerance = 1e-10})
  local free = assert(bw.solid {grid = grid, materials = solid.materials})
  free:fix {side = "min x"}
  -- Euler's frequency with what the elements add to the stiffness, and Timoshenko's correction by
  -- shear alone: the lumped masses at corners turn with the section as if it were twice as deep
  local cell = length / cells / side
  local omega = 1.8751040687 ^ 2 * math.sqrt(young * (1 + cell ^ 2 / 2) * side ^ 2 / (12 * density)) / length ^ 2
  local period = 2 * math.pi / omega
  local step = period / parts
  local motion = assert(free:transient {scheme = "newmark", step = step, displacement = deflected.displacement,
    tolerance = 1e-9})
  local tip = grid:nodes {side = "max x"}
  local times = crossings(motion, step, 5, function()
    return motion.displacement:gather(tip):column(3):mean()
  end)
  return (times[5] - times[1]) / 2 / period - 1
end

local function swing(parts)
  local period, energy = pendulum("newmark", parts)
  expect(period + 1, ("period over theory, %d steps of Newmark in it"):format(parts))
    :near(1, {absolute = 24 / parts ^ 2, source = "elliptic integral"})
  expect(energy, ("change of energy over weight times arm, %d steps of Newmark in a period"):format(parts))
    :below(200 / parts ^ 2, {source = "theory"})
end

local about = "A stiff bar hinged along an edge and released from the horizontal, beside the period of a rigid "
  .. "pendulum that swings as far: rotations are large, strains small. Two half periods, by where it passes the "
  .. "lowest point."

scenario("A pendulum", {about = about, tags = {"slow"}}, function()
  swing(100)
  swing(200)
end)

scenario("A pendulum, smaller steps", {about = about, tags = {"slow", "long"}}, function() swing(400) end)

scenario("A cantilever that vibrates", {tags = {"slow"}, about = "One row of cells twenty times as long as thick, "
  .. "released from under a load at its tip; two periods, beside Euler's lowest with the stiffness that the "
  .. "elements have."}, function()
  for _, cells in ipairs {20, 40} do
    expect(cantilever(cells, 200) + 1, ("period over theory, %d cells, 200 steps a period"):format(cells))
      :near(1, {relative = 0.01, source = "Euler"})
  end
end)
