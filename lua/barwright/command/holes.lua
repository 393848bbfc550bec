-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The round holes of a surface: cylindrical faces that go all round their axis and face it.
local model = require "barwright.command.model"
local vectors = require "barwright.modeller.vectors"

local holes = {}

-- Of the sum of the area vectors of a face over its area: less where it goes all round.
local ALL_ROUND = 0.2
-- Of the radius: how far from the wall a point may lie that belongs to it.
local WALL = 0.02

local dot, cross = vectors.dot, vectors.cross

local function minus(a, b) return vectors.add(a, b, -1) end

-- Along the axis from its point, the vector from the axis, and how long this is.
local function from_axis(face, p)
  local d = minus(p, face.point)
  local along = dot(d, face.axis)
  local radial = {d[1] - along * face.axis[1], d[2] - along * face.axis[2], d[3] - along * face.axis[3]}
  return along, radial, math.sqrt(dot(radial, radial))
end

-- Adds a triangle to the sums of its face: its area vector, how much faces the axis, where it begins and ends.
local function add(sum, face, a, b, c)
  local normal, middle = cross(minus(b, a), minus(c, a)), {}
  for k = 1, 3 do middle[k] = (a[k] + b[k] + c[k]) / 3 end
  local _, radial = from_axis(face, middle)
  sum.inward = sum.inward - dot(normal, radial)
  sum.area = sum.area + math.sqrt(dot(normal, normal))
  for k = 1, 3 do sum[k] = sum[k] + normal[k] end
  for _, p in ipairs {a, b, c} do
    local along = from_axis(face, p)
    sum.low, sum.high = math.min(sum.low, along), math.max(sum.high, along)
  end
end

--- The holes of a surface: a list of {point, axis, radius, low, high}, or nil, message, details.
function holes.of(surface)
  local faces, labels, details = model.try(surface.faces, surface)
  if not faces then return nil, labels, details end
  local points, triangles, sums = surface.points:totable(), surface.triangles:totable(), {}
  local outward = surface.volume < 0 and -1 or 1 -- it may face inwards
  for t, label in ipairs(labels:totable()) do
    local face, corner = faces[label], triangles[t]
    if face and face.kind == "cylinder" then
      sums[label] = sums[label] or {0, 0, 0, inward = 0, area = 0, low = math.huge, high = -math.huge}
      add(sums[label], face, points[corner[1]], points[corner[2]], points[corner[3]])
    end
  end
  local list = {}
  for label, face in ipairs(faces) do
    local sum = sums[label]
    if sum and outward * sum.inward > 0 and math.sqrt(dot(sum, sum)) < ALL_ROUND * sum.area then
      list[#list + 1] = {point = face.point, axis = face.axis, radius = face.radius, low = sum.low,
        high = sum.high}
    end
  end
  return list
end

--- Whether a point (x, y, z) lies on the wall of one of the holes: a function.
function holes.test(list)
  return function(x, y, z)
    for _, hole in ipairs(list) do
      local margin = WALL * hole.radius
      local along, _, distance = from_axis(hole, {x, y, z})
      local reaches = along >= hole.low - margin and along <= hole.high + margin
      if reaches and math.abs(distance - hole.radius) <= margin then return true end
    end
    return false
  end
end

return holes
