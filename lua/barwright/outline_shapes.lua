-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Outlines by formula: rectangles, polygons with rounded corners, circles and ellipses.
--
-- An arc of angle a is a cubic with control points at 4/3 tan(a/4) radii along the tangents; it is
-- off the circle by about 2e-6 (a/45°)^6 radii, so that arcs are cut into pieces of at most 45°.
local core = require "barwright.core"
local options = require "barwright.options"

local raise = core.raise

local shapes = {}
local create

local function is_pair(value)
  return type(value) == "table" and #value == 2 and type(value[1]) == "number"
    and type(value[2]) == "number"
end

local function pair(where, value, default)
  if value == nil and default then return default end
  if not is_pair(value) then raise(("%s: {x, y} expected, got %s"):format(where, core.got(value))) end
  return value
end

-- What every shape passes on to bw.outline.
local common = {"name", "tag", "tags", "holes", "regions"}

local function read(where, given, rules)
  for _, key in ipairs(common) do rules[key] = {type = "any"} end
  return options.read(where, given, rules)
end

local function make(points, opts)
  local given = {points = points}
  for _, key in ipairs(common) do given[key] = opts[key] end
  return create(given)
end

-- Adds the arc from the angle `from` to `to` about a centre, which the last entry already reaches.
-- An entry is written by at(radius, angle) so that ellipses share it.
local function add_arc(list, from, to, place, tangent)
  local pieces = math.max(1, math.ceil(math.abs(to - from) / (math.pi / 4) - 1e-9))
  local step = (to - from) / pieces
  local k = 4 / 3 * math.tan(step / 4)
  for i = 1, pieces do
    local a, b = from + (i - 1) * step, from + i * step
    local p, q = place(a), place(b)
    local u, v = tangent(a), tangent(b)
    list[#list + 1] = {{p[1] + k * u[1], p[2] + k * u[2]}, {q[1] - k * v[1], q[2] - k * v[2]}, q}
  end
end

--- An ellipse from {centre, radii = {a, b}, angle = degrees}.
function shapes.ellipse(given)
  local opts = read("outline.ellipse", given, {
    centre = {type = "table"},
    radii = {type = "table", needed = true},
    angle = {type = "number", default = 0},
  })
  local c = pair("outline.ellipse: centre", opts.centre, {0, 0})
  local r = pair("outline.ellipse: radii", opts.radii)
  if not (r[1] > 0 and r[2] > 0) then
    raise(("outline.ellipse: radii above 0 expected, got %g and %g"):format(r[1], r[2]))
  end
  local cos, sin = math.cos(math.rad(opts.angle)), math.sin(math.rad(opts.angle))
  local function rotated(x, y)
    return {cos * x - sin * y, sin * x + cos * y}
  end
  local function place(a)
    local p = rotated(r[1] * math.cos(a), r[2] * math.sin(a))
    return {c[1] + p[1], c[2] + p[2]}
  end
  local list = {}
  add_arc(list, 0, 2 * math.pi, place, function(a)
    return rotated(-r[1] * math.sin(a), r[2] * math.cos(a))
  end)
  -- the curve that closes the loop leads to its first vertex
  table.insert(list, 1, table.remove(list))
  list[1][3] = place(0)
  return make(list, opts)
end

--- A circle from {centre, radius}.
function shapes.circle(given)
  local opts = read("outline.circle", given, {
    centre = {type = "table"},
    radius = {type = "number", needed = true, above = 0},
  })
  local passed = {centre = opts.centre, radii = {opts.radius, opts.radius}}
  for _, key in ipairs(common) do passed[key] = opts[key] end
  return shapes.ellipse(passed)
end

-- A vertex, unless the last entry leads there already: two arcs may meet without a line between.
local function add_vertex(list, p, size)
  local last = list[#list]
  local at = last and (is_pair(last) and last or last[3])
  if not at or math.abs(at[1] - p[1]) + math.abs(at[2] - p[2]) > 1e-9 * size then
    list[#list + 1] = p
  end
end

-- The corner b of a polygon a, b, c cut off by an arc of the radius.
local function round_corner(list, a, b, c, radius, number)
  local function unit(p, q)
    local x, y = q[1] - p[1], q[2] - p[2]
    local length = math.sqrt(x * x + y * y)
    return {x / length, y / length}, length
  end
  local u, before = unit(a, b)
  local v, after = unit(b, c)
  local turn = math.atan(u[1] * v[2] - u[2] * v[1], u[1] * v[1] + u[2] * v[2])
  local cut = radius * math.tan(math.abs(turn) / 2)
  if radius == 0 or math.abs(turn) < 1e-9 then
    add_vertex(list, b, before)
    return 0
  end
  local max = math.min(before, after) * (1 + 1e-12)
  if cut > max then
    raise(("outline.rounded: corner %d: a smaller radius expected, got %s: the arc takes %s of its edges, "
      .. "which are %s and %s long"):format(number, core.quantity(radius, "m"), core.quantity(cut, "m"),
      core.quantity(before, "m"), core.quantity(after, "m")))
  end
  local side = turn > 0 and 1 or -1
  local start = {b[1] - cut * u[1], b[2] - cut * u[2]}
  local centre = {start[1] - side * radius * u[2], start[2] + side * radius * u[1]}
  local from = math.atan(start[2] - centre[2], start[1] - centre[1])
  add_vertex(list, start, before)
  add_arc(list, from, from + turn, function(angle)
    return {centre[1] + radius * math.cos(angle), centre[2] + radius * math.sin(angle)}
  end, function(angle)
    return {-radius * math.sin(angle), radius * math.cos(angle)}
  end)
  return cut
end

--- A polygon with its corners rounded, from {points, radius = one or a list of one for each corner}.
function shapes.rounded(given)
  local opts = read("outline.rounded", given, {
    points = {type = "table", needed = true},
    radius = {type = "any", needed = true},
  })
  local points, list, cut = opts.points, {}, {}
  local count = rawlen(points)
  if count < 3 then raise(("outline.rounded: points: three or more expected, got %d"):format(count)) end
  for i = 1, count do pair(("outline.rounded: point %d"):format(i), rawget(points, i)) end
  for i, p in ipairs(points) do
    local radius = opts.radius
    if type(radius) == "table" then radius = radius[i] end
    if type(radius) ~= "number" or radius < 0 then
      raise(("outline.rounded: radius: corner %d: a length of at least 0 m expected, got %s"):format(i,
        core.got(radius)))
    end
    cut[i] = round_corner(list, points[(i - 2) % count + 1], p, points[i % count + 1], radius, i)
  end
  -- Where the last arc comes back to the first vertex, it is the curve that leads there.
  local first, last = list[1], list[#list]
  if not is_pair(last) and math.abs(last[3][1] - first[1]) + math.abs(last[3][2] - first[2]) <=
    1e-9 * (math.abs(last[1][1] - last[3][1]) + math.abs(last[1][2] - last[3][2])) then
    list[1] = {last[1], last[2], first}
    list[#list] = nil
  end
  for i, p in ipairs(points) do
    local q = points[i % count + 1]
    local length = math.sqrt((q[1] - p[1]) ^ 2 + (q[2] - p[2]) ^ 2)
    local taken = cut[i] + cut[i % count + 1]
    if taken > length * (1 + 1e-12) then
      raise(("outline.rounded: smaller radii expected at the ends of edge %d: its arcs take %s, and it is %s "
        .. "long"):format(i, core.quantity(taken, "m"), core.quantity(length, "m")))
    end
  end
  return make(list, opts)
end

--- A polygon from {points}.
function shapes.polygon(given)
  local list = type(given) == "table" and rawlen(given) > 0
  local opts = read("outline.polygon", list and {points = given} or given, {
    points = {type = "table", needed = true},
  })
  for i, p in ipairs(opts.points) do pair(("outline.polygon: point %d"):format(i), p) end
  return make(opts.points, opts)
end

--- A rectangle from {min, max}, or {width, height, centre}; `radius` rounds its corners. Edges:
--- 1 below, 2 right, 3 above, 4 left.
function shapes.rectangle(given)
  local opts = read("outline.rectangle", given, {
    min = {type = "table"},
    max = {type = "table"},
    width = {type = "number", above = 0},
    height = {type = "number", above = 0},
    centre = {type = "table"},
    radius = {type = "number", min = 0, default = 0},
  })
  local min, max
  if opts.min or opts.max then
    min = pair("outline.rectangle: min", opts.min)
    max = pair("outline.rectangle: max", opts.max)
    if opts.width or opts.height or opts.centre then
      raise "outline.rectangle: either min and max, or width, height and centre, expected, got both"
    end
  else
    if not (opts.width and opts.height) then
      raise "outline.rectangle: min and max, or width and height, expected, got neither"
    end
    local c = pair("outline.rectangle: centre", opts.centre, {opts.width / 2, opts.height / 2})
    min = {c[1] - opts.width / 2, c[2] - opts.height / 2}
    max = {c[1] + opts.width / 2, c[2] + opts.height / 2}
  end
  if not (max[1] > min[1] and max[2] > min[2]) then
    raise(("outline.rectangle: max above min expected, got {%g, %g} and {%g, %g}"):format(max[1], max[2], min[1],
      min[2]))
  end
  local points = {{min[1], min[2]}, {max[1], min[2]}, {max[1], max[2]}, {min[1], max[2]}}
  if opts.radius == 0 then return make(points, opts) end
  local passed = {points = points, radius = opts.radius}
  for _, key in ipairs(common) do passed[key] = opts[key] end
  return shapes.rounded(passed)
end

function shapes.bind(function_of_outline)
  create = function_of_outline
end

return shapes
