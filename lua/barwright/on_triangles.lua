-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Whether points lie on triangles, of which there may be many: the triangles are leaves of a tree of boxes that
-- is built once.
local dot = require("barwright.modeller.vectors").dot

-- So many triangles are not divided further.
local LEAF = 4

-- A triangle with a box that is larger by a length.
local function boxed(a, b, c, near)
  local u, v, min, max = {}, {}, {}, {}
  for k = 1, 3 do
    u[k], v[k] = b[k] - a[k], c[k] - a[k]
    min[k], max[k] = math.min(a[k], b[k], c[k]) - near, math.max(a[k], b[k], c[k]) + near
  end
  return {a = a, b = b, u = u, v = v, min = min, max = max}
end

local function middle(t, axis) return t.min[axis] + t.max[axis] end

-- The tree of the triangles: {min, max, left, right} or {min, max, list}.
local function tree(list)
  local min, max = {math.huge, math.huge, math.huge}, {-math.huge, -math.huge, -math.huge}
  for _, t in ipairs(list) do
    for k = 1, 3 do min[k], max[k] = math.min(min[k], t.min[k]), math.max(max[k], t.max[k]) end
  end
  local node = {min = min, max = max}
  if #list <= LEAF then
    node.list = list
    return node
  end
  local axis = 1
  for k = 2, 3 do axis = max[k] - min[k] > max[axis] - min[axis] and k or axis end
  local sum, left, right = 0, {}, {}
  for _, t in ipairs(list) do sum = sum + middle(t, axis) / #list end
  for _, t in ipairs(list) do
    if middle(t, axis) < sum then left[#left + 1] = t else right[#right + 1] = t end
  end
  if #left == 0 or #right == 0 then -- all in one place
    left, right = table.move(list, 1, #list // 2, 1, {}), table.move(list, #list // 2 + 1, #list, 1, {})
  end
  node.left, node.right = tree(left), tree(right)
  return node
end

local function in_box(box, x, y, z)
  local min, max = box.min, box.max
  return min[1] <= x and x <= max[1] and min[2] <= y and y <= max[2] and min[3] <= z and z <= max[3]
end

-- The square of the distance of a point `d` from the line from 0 to `u`.
local function from_edge(d, u)
  local length, along = dot(u, u), dot(d, u)
  local s = length > 0 and math.max(0, math.min(1, along / length)) or 0
  return (d[1] - s * u[1]) ^ 2 + (d[2] - s * u[2]) ^ 2 + (d[3] - s * u[3]) ^ 2
end

local function is_near(t, near, x, y, z)
  local d, u, v = {x - t.a[1], y - t.a[2], z - t.a[3]}, t.u, t.v
  local uu, uv, vv, du, dv = dot(u, u), dot(u, v), dot(v, v), dot(d, u), dot(d, v)
  local area = uu * vv - uv * uv -- twice the area, squared
  if area > 0 then
    local p, q = (vv * du - uv * dv) / area, (uu * dv - uv * du) / area
    if p >= 0 and q >= 0 and p + q <= 1 then
      local square = 0
      for k = 1, 3 do square = square + (d[k] - p * u[k] - q * v[k]) ^ 2 end
      return square <= near * near
    end
  end
  local from_b, third = {x - t.b[1], y - t.b[2], z - t.b[3]}, {v[1] - u[1], v[2] - u[2], v[3] - u[3]}
  return math.min(from_edge(d, u), from_edge(d, v), from_edge(from_b, third)) <= near * near
end

--- A function of x, y, z: whether the point lies on one of some triangles (triples of numbers of points) within
--- a length.
return function(points, triangles, near)
  local list = {}
  for i, corners in ipairs(triangles) do
    list[i] = boxed(points[corners[1]], points[corners[2]], points[corners[3]], near)
  end
  local root = tree(list)
  local function found(node, x, y, z)
    if not in_box(node, x, y, z) then return false end
    if node.left then return found(node.left, x, y, z) or found(node.right, x, y, z) end
    for _, t in ipairs(node.list) do
      if in_box(t, x, y, z) and is_near(t, near, x, y, z) then return true end
    end
    return false
  end
  return function(x, y, z) return found(root, x, y, z) end
end
