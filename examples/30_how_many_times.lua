-- SPDX-License-Identifier: MIT
-- Lesson 30: how many times?
--   build/barwright examples/30_how_many_times.lua [FOLDER]
--
-- A steel lever of 200 x 30 x 10 mm with a waist is pushed down and sideways again and again. Each load is solved
-- once, for 1 N; histories of the two forces then give the damage everywhere.
local bw = require "barwright"
local folder = arg and arg[1]

local L, b, h = 0.2, 0.03, 0.01
local steel = bw.material.steel
local function unit_loads(cells)
  local box = bw.mesh.box {max = {L, b, h}, cells = cells, order = 2}
  local places = box.nodes:totable()
  for _, p in ipairs(places) do -- half as wide at 60 mm
    p[2] = b / 2 + (p[2] - b / 2) * (1 - 0.5 * math.exp(-((p[1] - 0.06) / 0.015) ^ 2))
  end
  local mesh = assert(box:moved(places))
  local part = bw.model {mesh = mesh, material = steel}:fix(mesh.boundary:below("x", 0))
  local statics = {}
  for i, force in ipairs {{0, -1, 0}, {0, 0, 1}} do
    part:clear_loads():load {on = mesh.boundary:above("x", L), force = force}
    statics[i] = assert(part:solve())
  end
  return statics
end

-- A minute of work: a strong slow swing down, a weak quick one sideways.
local first, second = {}, {}
for i = 0, 600 do
  local t = i / 10
  first[i + 1] = 220 + 220 * math.sin(0.2 * math.pi * t) + 60 * math.sin(1.7 * t)
  second[i + 1] = 90 * math.sin(2.3 * t)
end
local cycles = assert(bw.rainflow(first))
print(("the force down has %g cycles, the largest of %.0f N"):format(cycles:column(3):sum(),
  cycles:column(1):max()))

-- Life of a polished steel bar: 2e6 cycles of +-160 MPa; a mean stress counts by Goodman's line.
local curve = {amplitude = 160e6, cycles = 2e6, exponent = 5, strength = 400e6}
local function life(cells)
  local statics = unit_loads(cells)
  return assert(bw.fatigue {curve = curve, loads = {{static = statics[1], history = first},
    {static = statics[2], history = second}}}), statics
end
local fatigue, statics = life {48, 8, 4}
local coarse = life {24, 4, 2}
print(fatigue)
print(("it lasts %.3g minutes, %.3g on a coarser mesh: stresses enter by the fifth power"):format(fatigue.passes,
  coarse.passes))
print(("error of the unit stresses: %.1f %% and %.1f %% in the energy norm"):format(
  100 * assert(statics[1]:error_estimate()), 100 * assert(statics[2]:error_estimate())))
-- The waist fails, not the clamp, at whose edge the stress would depend on the mesh.
assert(math.abs(fatigue.at[1] - 0.06) < 0.02 and math.abs(fatigue.passes / coarse.passes - 1) < 0.3)
if folder then assert(fatigue:picture(folder .. "/damage.png")) end
-- Next: `history = "force.csv"`, or random:fatigue for random vibration.
