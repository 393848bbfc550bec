-- SPDX-License-Identifier: MIT
-- Lesson 5: a material that is not the same in all directions.
--   build/barwright examples/05_materials.lua
--
-- The gypsum of a powder printer (zp150) is five times stiffer along X than along Z. The same bar
-- stretched along X, Y and Z:
local bw = require "barwright"

local gypsum = bw.material.zp150
print(gypsum)

local function stretch(axis)
  local max = {0.01, 0.01, 0.01}
  local cells = {2, 2, 2}
  max[axis], cells[axis] = 0.1, 10
  local mesh = bw.mesh.box {min = {0, 0, 0}, max = max, cells = cells}
  local part = bw.model {mesh = mesh, material = gypsum}
  local pull = {0, 0, 0}
  pull[axis] = 10
  part:load {on = mesh.boundary:above(axis, 0.1 - 1e-9), force = pull}
  pull[axis] = -10
  part:load {on = mesh.boundary:below(axis, 1e-9), force = pull}
  -- No support at all: the loads balance, so the free body is solved exactly.
  local u = assert(part:solve()).displacement:column(axis)
  return u:max() - u:min()
end

for axis = 1, 3 do
  local stretched = stretch(axis)
  local young = 10 / 1e-4 * 0.1 / stretched
  print(("along %s: %.4f mm, that is a Young's modulus of %.3f GPa"):format(
    ("XYZ"):sub(axis, axis), stretched * 1e3, young / 1e9))
  assert(math.abs(young / gypsum.young[axis] - 1) < 1e-6)
end

-- Turned by 90 degrees about Z, X and Y change places.
local rotated = gypsum:rotated {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}
print(rotated)
