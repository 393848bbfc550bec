-- SPDX-License-Identifier: MIT
-- Lesson 24: it gets hot.
--   build/barwright examples/24_it_gets_hot.lua [FOLDER]
--
-- An aluminium plate of 80 x 40 x 5 mm is bolted down at its left end. A chip heats the right end of its top by
-- 15 W, and air at 20 C cools all of it. Temperatures are in kelvin.
local bw = require "barwright"
local folder = arg and arg[1]

local L, b, h, air = 0.08, 0.04, 0.005, 293.15
local mesh = bw.mesh.box {max = {L, b, h}, cells = {24, 12, 3}, order = 2}
local aluminium = bw.material.aluminium
local function heated(body)
  local chip = body.boundary:above("z", h):above("x", 0.75 * L)
  local heat = bw.heat {mesh = body, material = aluminium}
  heat:load {on = chip, power = 15}
  return heat:load {on = body.boundary, convection = {coefficient = 50, temperature = air}}
end

-- The steady state. What goes in goes out again: the balance is printed.
local heat = heated(mesh)
local steady = assert(heat:solve())
print(steady)

-- Linear elements on the same mesh have the larger error: the difference at corners is about theirs.
local linear = assert(heated(mesh:with_order(1)):solve())
local difference = 0
for corner = 1, 4 do
  local fine, coarse = mesh.elements:column(corner), linear.mesh.elements:column(corner)
  difference = math.max(difference,
    (steady.temperature:gather(fine) - linear.temperature:gather(coarse)):map("abs(a)"):max())
end
print(("hottest: %.1f C (estimated error %.2g K); heat into the air: %.3f W; error of the flux: %.1f %%"):format(
  steady.temperature:max() - 273.15, difference, -steady.heat_in[2], 100 * assert(steady:error_estimate())))
assert(math.abs(steady.heat_in[1] + steady.heat_in[2]) < 1e-6)

-- How long does it take? Steps get longer as the temperature settles.
local transient = assert(heat:transient {initial = air, scheme = "bdf2"})
local before, half = 0
assert(transient:run {time = 1800, step = 5, tolerance = 0.2, each = function(now)
  local warm = now.temperature:max() - air > 0.5 * (steady.temperature:max() - air)
  half = half or warm and {before, now.time}
  before = now.time
end})
print(("half of that between %.0f and %.0f s; %d steps for half an hour, each of an estimated error up to 0.2 K")
  :format(half[1], half[2], transient.steps))

-- The stress of the computed temperatures, in a plate that is held at its left end.
local part = bw.model {mesh = mesh, material = aluminium}
part:fix(mesh.boundary:below("x", 0)):temperature(steady.temperature - air, 23e-6)
local static = assert(part:solve())
print(static)
print(("the right end moves %.3f mm, error unknown: one mesh"):format(
  1e3 * static.displacement:map("norm(a)"):max()))
if folder then
  assert(steady:picture(folder .. "/temperature.png"))
  assert(static:picture(folder .. "/thermal_stress.png"))
end
-- Next: radiation = {emissivity = 0.9, temperature = air} beside the air, or `barwright heat` on a file.
