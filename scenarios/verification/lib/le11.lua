-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The solid of NAFEMS LE11, 15 degrees of it: a cylinder, a taper and a sphere about z.
local bw = require "barwright"
local grids = require "grids"

local pi, cos, sin = math.pi, math.cos, math.sin
local h, wedge = math.sqrt(0.5), pi / 12

-- Its section in r and z, from inside (u = 0) out, and from the sphere (s = 0) up.
local function section(u, s)
  local inner, outer
  if s <= 1 / 3 then
    local along = 3 * s
    inner = {cos(pi / 4 * along), sin(pi / 4 * along)}
    outer = {1.4 * cos(pi / 6 * along), 1.4 * sin(pi / 6 * along)}
  elseif s <= 2 / 3 then
    local along = 3 * s - 1
    inner = {h, h + along * (1.39 - h)}
    outer = {1.4 * cos(pi / 6) + along * (1 - 1.4 * cos(pi / 6)), 0.7 + along * 0.69}
  else
    local along = 3 * s - 2
    inner, outer = {h, 1.39 + 0.4 * along}, {1, 1.39 + 0.4 * along}
  end
  return inner[1] * (1 - u) + outer[1] * u, inner[2] * (1 - u) + outer[2] * u
end

--- The grid of tet10, and the part with its planes of symmetry and without a temperature. Point A is at (0, 0, 0).
return function(cells)
  local grid = grids.mapped(cells, 2, function(u, v, w)
    local r, z = section(u, w)
    return {r * cos(wedge * v), r * sin(wedge * v), z}
  end)
  local part = bw.model {mesh = grid.mesh,
    material = bw.material.isotropic {young = 210e9, poisson = 0.3, expansion = 2.3e-4, conductivity = 50}}
  part:slide(grid:face(2, 0), {0, 1, 0})
  part:slide(grid:face(2, 1), {-sin(wedge), cos(wedge), 0})
  part:slide(grid:face(3, 0), {0, 0, 1})
  part:slide(grid:face(3, 1), {0, 0, 1})
  return grid, part
end
