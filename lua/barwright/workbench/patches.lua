-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Faces of their own on a body, where a person points: parts that are scanned or sculpted have few faces with
-- lines around them.
local body = require "barwright.workbench.body"
local core = require "barwright.core"

local patches = {}

-- The middle and the unit normal of a triangle.
local function middle_and_normal(points, p)
  local a, b, c = points[p[1]], points[p[2]], points[p[3]]
  local u1, u2, u3 = b[1] - a[1], b[2] - a[2], b[3] - a[3]
  local v1, v2, v3 = c[1] - a[1], c[2] - a[2], c[3] - a[3]
  local x, y, z = u2 * v3 - u3 * v2, u3 * v1 - u1 * v3, u1 * v2 - u2 * v1
  local size = math.max(math.sqrt(x * x + y * y + z * z), 1e-300)
  return {(a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3, (a[3] + b[3] + c[3]) / 3},
    {x / size, y / size, z / size}
end

local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end

-- The body whose chosen triangles (a set) are faces of their own, one of each face that they are a part of.
-- Returns the body, the faces that the chosen triangles make, and {[new face] = the one that it was a part of}.
local function split(self, chosen)
  local labels, whole, faces = self.labels:totable(), {}, table.move(self.faces, 1, #self.faces, 1, {})
  for t, label in ipairs(labels) do
    whole[label] = whole[label] ~= false and chosen[t] or false
  end
  local made, list, parts, wanted = {}, {}, {}, {}
  for t, label in ipairs(labels) do
    if chosen[t] then
      if not made[label] then
        made[label] = whole[label] and label or #faces + 1
        list[#list + 1] = made[label]
        if not whole[label] then
          local number = made[label]
          local of = faces[label]
          faces[number] = {name = ("patch %d"):format(number), kind = of.kind, radius = of.radius, axis = of.axis,
            point = of.point, slope = of.slope, residual = of.residual}
          parts[number], wanted[number], wanted[label] = label, true, true
        end
      end
      labels[t] = made[label]
    end
  end
  if not next(parts) then return self, list, parts end
  local array = core.array.new(labels, "i32")
  return {surface = self.surface, labels = array, log = self.log, sound = self.sound,
    faces = body.measure(self.surface, array, faces, wanted)}, list, parts
end

--- A face of the triangles around one, within its face: their normals differ by at most an angle (rad) from that
--- of the first, and their middles lie within a radius (m) of a point, or anywhere. As of `split`.
function patches.grown(self, first, angle, radius, around)
  local labels = self.labels:totable()
  local label = labels[first]
  if not label then core.raise "grow: there is no such triangle" end
  local points, triangles = self.surface.points:totable(), self.surface.triangles:totable()
  local at = body.at_edges(triangles, function(t) return labels[t] == label end)
  local chosen, queue, min = {[first] = true}, {first}, math.cos(angle)
  local centre, direction = middle_and_normal(points, triangles[first])
  around = around or centre
  local function belongs(t)
    local middle, normal = middle_and_normal(points, triangles[t])
    local d = {middle[1] - around[1], middle[2] - around[2], middle[3] - around[3]}
    return dot(normal, direction) >= min and dot(d, d) <= radius ^ 2
  end
  for _, t in ipairs(queue) do
    for k = 1, 3 do
      for _, other in ipairs(at[body.edge_key(triangles[t], k)]) do
        if not chosen[other] and belongs(other) then
          chosen[other] = true
          queue[#queue + 1] = other -- which ipairs goes on to
        end
      end
    end
  end
  return split(self, chosen)
end

--- Faces of the triangles whose middles lie within planes {x, y, z, d}, where x X + y Y + z Z >= d, and which look
--- towards a direction. As of `split`; or nil and a sentence.
function patches.within(self, planes, towards)
  local points, chosen = self.surface.points:totable(), {}
  for t, p in ipairs(self.surface.triangles:totable()) do
    local middle, normal = middle_and_normal(points, p)
    local inside = dot(normal, towards) > 0
    for _, plane in ipairs(planes) do inside = inside and dot(plane, middle) >= plane[4] end
    if inside then chosen[t] = true end
  end
  if not next(chosen) then
    return nil, "Nothing of the part lies in the rectangle.", {status = "empty"}
  end
  return split(self, chosen)
end

return patches
