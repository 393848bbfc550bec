-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The triangles of a surface that are nearest to points. core.face_labels finds them for triangles that face as
-- the surface does, so each point is asked for by small triangles in several directions, one of which does.
local core = require "barwright.core"
local model = require "barwright.command.model"

-- Pairs of sides of small triangles: their normals are the axes and the diagonals of a cube.
local SIDES = {{{0, 1, 0}, {0, 0, 1}}, {{0, 0, 1}, {1, 0, 0}}, {{1, 0, 0}, {0, 1, 0}},
  {{1, -1, 0}, {1, 1, -2}}, {{1, 1, 0}, {1, -1, -2}}, {{1, 1, 0}, {-1, 1, -2}}, {{1, -1, 0}, {-1, -1, -2}}}
-- Their size, over the diagonal of the surface.
local SIZE = 1e-9

local function beside(p, side, size)
  return {p[1] + size * side[1], p[2] + size * side[2], p[3] + size * side[3]}
end

-- A triangle at the corner that is nearest to a point: where the nearest triangle has no area, and so no normal.
local function at_corner(surface, p)
  local best, min = 1, math.huge
  for i, q in ipairs(surface.points:totable()) do
    local square = (p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2 + (p[3] - q[3]) ^ 2
    if square < min then best, min = i, square end
  end
  for t, corners in ipairs(surface.triangles:totable()) do
    if corners[1] == best or corners[2] == best or corners[3] == best then return t end
  end
  return 1
end

--- The number of the nearest triangle for each of some points; or nil, message, details.
return function(surface, points)
  local numbers, corners, triangles, size = {}, {}, {}, SIZE * model.diagonal(surface.box)
  for t = 1, surface.triangle_count do numbers[t] = t end
  for _, p in ipairs(points) do
    for _, sides in ipairs(SIDES) do
      local n = #corners
      corners[n + 1], corners[n + 2], corners[n + 3] = p, beside(p, sides[1], size), beside(p, sides[2], size)
      triangles[#triangles + 1] = {n + 1, n + 2, n + 3}
    end
  end
  local small, message, details = core.surface.new {points = corners, triangles = triangles}
  if not small then return nil, message, details end
  local labels
  labels, message, details = core.face_labels(surface, core.array.new(numbers, "i32"), small)
  if not labels then return nil, message, details end
  local out = {}
  for i = 1, #points do
    for k = 1, #SIDES do
      local label = labels[(i - 1) * #SIDES + k]
      if label > 0 then out[i] = math.tointeger(label) end
    end
    out[i] = out[i] or at_corner(surface, points[i])
  end
  return out
end
