-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Outlines as polygons whose sides keep the tags of their edges: the sections of solids.
local core = require "barwright.core"

local profile = {}

local function length(x, y) return math.sqrt(x * x + y * y) end

-- A curve has at most so many sides.
local MOST = 100000

local function limited(count, tolerance)
  if count > MOST then
    core.raise(("option 'tolerance': a curve has at most %d sides, and %s asks for more: give a larger one")
      :format(MOST, core.quantity(tolerance, "m")))
  end
  return math.max(1, math.ceil(count - 1e-9))
end

--- Equal sides of a circle's arc of an angle (rad) that stay within a distance of it.
function profile.sides(angle, radius, tolerance)
  local half = tolerance < radius and math.acos(1 - tolerance / radius) or 1
  return limited(angle / (2 * half), tolerance)
end

-- How far a cubic turns, by the directions between 16 places on it.
local function turn(p)
  local sum, last = 0, nil
  local x, y = p[1][1], p[1][2]
  for i = 1, 16 do
    local t = i / 16
    local s = 1 - t
    local a, b, c, d = s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t
    local u = a * p[1][1] + b * p[2][1] + c * p[3][1] + d * p[4][1]
    local v = a * p[1][2] + b * p[2][2] + c * p[3][2] + d * p[4][2]
    local dx, dy = u - x, v - y
    if dx ~= 0 or dy ~= 0 then
      if last then sum = sum + math.abs(math.atan(last[1] * dy - last[2] * dx, last[1] * dx + last[2] * dy)) end
      last = {dx, dy}
    end
    x, y = u, v
  end
  return sum * 16 / 15
end

-- An arc of angle a is a cubic with control points at 4/3 tan(a/4) radii along the tangents. The circle of an edge
-- that is such an arc, as {centre =, angle =} (rad, to the left positive), or nil.
local function circle_of(edge)
  local p, q = edge.from, edge.to
  local a, b = edge.control[1], edge.control[2]
  local ux, uy, vx, vy = a[1] - p[1], a[2] - p[2], q[1] - b[1], q[2] - b[2]
  local first, second = length(ux, uy), length(vx, vy)
  local angle = math.atan(ux * vy - uy * vx, ux * vx + uy * vy)
  local chord = length(q[1] - p[1], q[2] - p[2])
  if first == 0 or second == 0 or math.abs(angle) < 1e-6 or math.abs(angle) > math.pi / 2 then return nil end
  local radius = chord / (2 * math.sin(math.abs(angle) / 2))
  local handle, near = 4 / 3 * math.tan(math.abs(angle) / 4) * radius, 1e-9 * radius
  local side = (angle > 0 and 1 or -1) * radius / first
  local centre = {p[1] - side * uy, p[2] + side * ux}
  if math.abs(first - handle) > near or math.abs(second - handle) > near
      or math.abs(length(q[1] - centre[1], q[2] - centre[2]) - radius) > near then return nil end
  return {centre = centre, angle = angle}
end

-- Places behind the first one of an edge of `count` sides: on its circle where it is an arc.
local function places(outline, e, edge, count)
  local circle, list = edge.control and count > 1 and circle_of(edge), {}
  for i = 1, count - 1 do
    if circle then
      local c, p = circle.centre, edge.from
      local cos, sin = math.cos(circle.angle * i / count), math.sin(circle.angle * i / count)
      local x, y = p[1] - c[1], p[2] - c[2]
      list[i] = {c[1] + cos * x - sin * y, c[2] + sin * x + cos * y}
    else
      list[i] = (outline:at(e, i / count))
    end
  end
  return list
end

--- Sides of an edge (`outline:edge`): a chord of a cubic over the parameter h lies within h²/8 max |B''| of it.
function profile.edge_sides(edge, curvature, tolerance)
  if not edge.control then return 1 end
  local p = {edge.from, edge.control[1], edge.control[2], edge.to}
  local count = math.ceil(math.deg(turn(p)) / curvature - 1e-6)
  if tolerance then
    local bend = 0
    for i = 1, 2 do
      local a, b, c = p[i], p[i + 1], p[i + 2]
      bend = math.max(bend, 6 * length(a[1] - 2 * b[1] + c[1], a[2] - 2 * b[2] + c[2]))
    end
    count = math.max(count, limited(math.sqrt(bend / (8 * tolerance)), tolerance))
  end
  return math.max(count, 1)
end

--- The loops that bound material, as {hole = boolean, edges = list of numbers}: not those between regions.
function profile.loops(outline)
  local by_name, list = {}, {}
  for _, loop in ipairs(outline.loops) do by_name[loop.name] = loop end
  for _, loop in ipairs(outline.loops) do
    local parent = by_name[loop.parent]
    if loop.hole or not parent or parent.hole then
      local edges = {}
      for i = 1, loop.count do edges[i] = loop.first + i - 1 end
      list[#list + 1] = {hole = loop.hole, edges = edges}
    end
  end
  return list
end

local function area(points)
  local sum, last = 0, points[#points]
  for _, p in ipairs(points) do
    sum = sum + last[1] * p[2] - last[2] * p[1]
    last = p
  end
  return sum / 2
end

-- The same polygon the other way round: side i leads from point i to the next one.
local function reversed(polygon)
  local made, count = {points = {}, tags = {}, curved = {}}, #polygon.points
  for i = 1, count do
    local side = (count - i - 1) % count + 1
    made.points[i] = polygon.points[count + 1 - i]
    made.tags[i] = polygon.tags[side]
    made.curved[i] = polygon.curved and polygon.curved[side]
  end
  return made
end

--- A polygon {points =, tags = of the side behind each point, curved = whether that side is one of a curve} with
--- the material on its left.
function profile.oriented(polygon, hole)
  if (area(polygon.points) < 0) ~= (hole or false) then return reversed(polygon) end
  return polygon
end

--- The loops of an outline as oriented polygons. `sides(edge, number)` is how many sides an edge has.
function profile.polygons(outline, sides)
  local list = {}
  for _, loop in ipairs(profile.loops(outline)) do
    local polygon = {points = {}, tags = {}, curved = {}}
    for _, e in ipairs(loop.edges) do
      local edge = outline:edge(e)
      local count = sides(edge, e)
      local behind = places(outline, e, edge, count)
      for i = 1, count do
        polygon.points[#polygon.points + 1] = behind[i - 1] or edge.from
        polygon.tags[#polygon.tags + 1] = edge.tag
        polygon.curved[#polygon.points] = edge.control ~= nil
      end
    end
    list[#list + 1] = profile.oriented(polygon, loop.hole)
  end
  return list
end

--- The triangles between polygons, by numbers of their points one polygon behind the other; or nil, message,
--- details.
function profile.triangles(polygons)
  local list = {}
  for i, polygon in ipairs(polygons) do list[i] = polygon.points end
  local made, message, details = core.polygon_triangles(list)
  if not made then return nil, message, details end
  return made:totable()
end

return profile
