-- SPDX-License-Identifier: MIT
-- Lesson 35: a bracket from numbers.
--   build/barwright examples/35_a_bracket.lua [FOLDER]
--
-- An aluminium angle is screwed to a wall by two bolts and carries 300 N at the tip of its arm. Change a number
-- and run again: supports and loads follow, since faces have names.
local bw = require "barwright"
local folder, mm = arg and arg[1], 1e-3
local arm, wall, thick, width, bolt, radius = 60 * mm, 50 * mm, 6 * mm, 40 * mm, 6 * mm, 6 * mm

local corners = {{0, 0}, {arm, 0}, {arm, thick}, {thick, thick}, {thick, wall}, {0, wall}}
local profile = assert(bw.outline {points = corners, tags = {tip = 2, back = 6}}:fillet(radius, {vertices = 4}))
local angle = assert(bw.surface.extrude(profile, {height = width}))
local first = {-thick, 0.7 * wall, width / 4}
local drill = bw.surface.cylinder({base = first, axis = {3 * thick, 0, 0}, radius = bolt / 2}):named "bolt hole"
local drills = assert(drill:linear_array {count = 2, step = {0, 0, width / 2}})
local bracket = assert(angle:difference(drills))

local mesh = assert(bw.mesh.fill(bracket, {elements = 12000, order = 2}))
local part = bw.model {mesh = mesh, material = bw.material.aluminium}
part:fix(mesh.boundary:face "bolt hole")
part:load {on = mesh.boundary:face "tip", force = {0, -300, 0}}
local static = assert(part:solve())
-- Where the rims of the holes cannot move, the stress has no finite value; the fillet is what is designed.
local stress = static.von_mises:gather(mesh.boundary:face("fillet").nodes):max()
print(("%.0f MPa in the fillet, strength %.0f MPa: %s"):format(stress / 1e6, part.material.strength / 1e6,
  stress < part.material.strength and "it holds" or "it breaks"))

-- What beams say of the section where the arm leaves the fillet; the fillet raises it a little.
local bending = 300 * (arm - thick - radius) * 6 / (width * thick ^ 2)
print(("beam theory: %.0f MPa"):format(bending / 1e6))
assert(stress > bending and stress < 1.6 * bending)
if folder then
  assert(bracket:write(folder .. "/bracket.obj", {unit = "mm"})) -- with the names
  assert(static:picture(folder .. "/bracket.png", {up = {0, 1, 0}}))
end
