-- SPDX-License-Identifier: MIT
-- Lesson 29: two metals in one mesh.
--   build/barwright examples/29_two_metals.lua [FOLDER]
--
-- A strip of 100 x 10 x 2 mm, steel below and aluminium above, is warmed by 100 K. Aluminium expands more, so the
-- strip bends. Regions of the mesh have the materials.
local bw = require "barwright"
local folder = arg and arg[1]

local L, b, h, warmer = 0.1, 0.01, 0.002, 100
local steel, aluminium = bw.material.steel, bw.material.aluminium
local function strip(cells)
  -- A box names the part that is split off; "rest" is what remains. Files of meshes bring their own regions.
  local mesh = bw.mesh.box {max = {L, b, h}, cells = cells, order = 2}
  mesh = assert(mesh:split({max = {L, b, h / 2}}, "steel"))
  local part = bw.model {mesh = mesh, materials = {steel = steel, rest = aluminium}}
  part:fix(mesh.boundary:below("x", 0))
  return part:temperature(warmer) -- each metal expands by its own coefficient
end

local part = strip {40, 4, 4}
print(part.mesh)
for _, region in ipairs(part.mesh.regions) do print(region) end
local static = assert(part:solve())
print(static)

-- The end moves sideways as Timoshenko's strip of two layers of the same thickness says. A coarser mesh gives an
-- estimate of the error.
local function tip(solved)
  return solved.displacement(solved.mesh.boundary:nearest({L, b / 2, h / 2}, 1).nodes[1], 3)
end
local coarse = assert(strip({20, 2, 2}):solve())
local n = steel.young / aluminium.young
local curvature = 24 * (aluminium.expansion - steel.expansion) * warmer / (h * (14 + n + 1 / n))
print(("the end moves by %.4f mm (a coarser mesh: %.4f mm); Timoshenko's narrow strip: %.4f mm"):format(
  1e3 * tip(static), 1e3 * tip(coarse), -1e3 * curvature * L ^ 2 / 2))
assert(math.abs(tip(static) / (-curvature * L ^ 2 / 2) - 1) < 0.05)

-- What the layers exert on each other: next to nothing in the middle. Where the interface meets the surface,
-- tractions grow without limit as elements become smaller.
local between = assert(static:interface_traction("steel", "rest"))
print(between)
local middle = bw.array.map("(abs(x / 0.1 - 0.5) < 0.2) * (abs(y / 0.01 - 0.5) < 0.3)",
  {x = part.mesh.nodes:column(1), y = part.mesh.nodes:column(2)})
print(("shear between the layers: %.3g MPa in the middle; %.3g MPa at the border depends on the mesh"):format(
  (between.shear * middle):max() / 1e6, between.shear:max() / 1e6))

-- Stresses are averaged inside of each region, never across the interface: they jump there.
print(("largest von Mises stress of the middle %.1f MPa; error of the whole: %.1f %% in the energy norm"):format(
  (static.von_mises * middle):max() / 1e6, 100 * assert(static:error_estimate())))
if folder then assert(static:picture(folder .. "/bimetal.png")) end
-- Next: `barwright statics mesh.msh --material shell=pla --material insert=steel`.
