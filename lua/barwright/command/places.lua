-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Places on a part as a command line names them, and vectors: "below:z:1mm", "near:0,0,30mm:5mm", "0,0,-10N".
-- One unit behind the last number of a vector or point holds for the numbers before it that have none. A length of
-- a place has a unit, so that nobody is understood in metres who meant millimetres; 0 needs none.
local bw = require "barwright"
local core = require "barwright.core"
local model = require "barwright.command.model"
local on_triangles = require "barwright.on_triangles"
local quantity = require "barwright.command.quantity"

local places = {}

--- For the help of commands that take places.
places.help = "A PLACE on the surface is min:AXIS or max:AXIS (the lowest or highest fiftieth of the part "
  .. "along x, y or z), below:AXIS:COORDINATE, above:AXIS:COORDINATE, near:X,Y,Z:RADIUS, face:NAME (a face that "
  .. "the file names, or one of those that `barwright check --faces yes` lists), or all. Coordinates and radii "
  .. "have a unit; behind a point, one stands for all three: near:0,0,30mm:5mm."

-- ---- numbers ---------------------------------------------------------------------------------------

local function split(text)
  local words = {}
  for word in (text .. ","):gmatch "([^,]*)," do words[#words + 1] = word end
  return words
end

--- Three numbers with commas between, in a unit: "0,0,-10N".
function places.vector(text, unit)
  local words, list = split(text), {}
  local last = quantity.name_in(words[#words]) or ""
  for i, word in ipairs(words) do
    local value, expected = quantity.read(quantity.name_in(word) == "" and word .. last or word, unit)
    if not value then return nil, ("%s expected, got '%s'"):format(expected, word) end
    list[i] = value
  end
  if #list ~= 3 then return nil, ("three numbers such as 0,0,-10 expected, got '%s'"):format(text) end
  return list
end

-- A sentence where a number other than 0 among the words has no unit, and the last word has none for it.
local function missing_unit(text)
  local words = split(text)
  if quantity.name_in(words[#words]) ~= "" then return nil end
  for _, word in ipairs(words) do
    local message = quantity.missing(word, "m", text)
    if message then return message end
  end
end

local function length_of(text)
  local message = missing_unit(text)
  if message then return nil, message end
  local value, expected = quantity.read(text, "m")
  if not value then return nil, ("%s expected, got '%s'"):format(expected, text) end
  return value
end

--- A point whose coordinates have a unit: "0,0,30mm".
function places.point(text)
  local point, message = places.vector(text, "m")
  if not point then return nil, message end
  message = missing_unit(text)
  if message then return nil, message end
  return point
end

local number_of = {x = 1, y = 2, z = 3}

local function axis_of(text)
  local axis = number_of[text]
  if not axis then return nil, ("an axis x, y or z expected, got '%s'"):format(text) end
  return axis
end

-- ---- kinds -----------------------------------------------------------------------------------------

local FRACTION = 0.02 -- of the part, that "min" and "max" take

local function min_end(box, axis)
  return box.min[axis] + FRACTION * (box.max[axis] - box.min[axis])
end

local function max_end(box, axis)
  return box.max[axis] - FRACTION * (box.max[axis] - box.min[axis])
end

local function face_of(text)
  if text == "" then return nil, "the name of a face expected, got nothing" end
  return math.tointeger(tonumber(text)) or text
end

-- So many names of faces are listed.
local MAX_NAMES = 12

-- What follows a name that no face has: the names that there are, the one that resembles it first.
local function other_faces(mesh, name)
  local names, seen = {}, {}
  for _, known in ipairs(mesh:face_names()) do
    if known ~= "" and not seen[known] then names[#names + 1] = known end
    seen[known] = true
  end
  local how = "`barwright check FILE --faces yes` lists faces by shape, such as 'plane 1', which are names too"
  if #names == 0 then return "the file names no faces; " .. how end
  table.sort(names)
  local near = core.suggestion(name, names):match "^did you mean '(.*)'%?$"
  local list = near and {("'%s'"):format(near)} or {}
  for _, known in ipairs(names) do
    if known ~= near and #list < MAX_NAMES then list[#list + 1] = ("'%s'"):format(known) end
  end
  local rest = #names - #list
  local more = rest > 0 and (" and %d more"):format(rest) or ""
  return ("there are %s%s; %s"):format(table.concat(list, ", "), more, how)
end

-- What is said where a mesh or a surface has no face of a name.
local function no_face(mesh, name)
  return ("no face has the name '%s': %s"):format(name, other_faces(mesh, tostring(name)))
end

-- The triangles of a face of a surface by its name in the file, or its name or number among those that are found.
local function triangles_of(surface, name)
  local wanted, labels, list = {}, surface.groups, {}
  for group, known in ipairs(surface:face_names()) do wanted[group] = known == name or nil end
  if not next(wanted) then
    local faces
    faces, labels = surface:faces()
    for number, face in ipairs(faces or {}) do wanted[number] = number == name or face.name == name or nil end
  end
  local triangles = surface.triangles:totable()
  for t, label in ipairs(next(wanted) and labels:totable() or {}) do
    if wanted[label] then list[#list + 1] = triangles[t] end
  end
  return list
end

local ON_FACE = 1e-6 -- of the diagonal: how far a point of a face may lie from its triangles

-- Whether a point lies on a face of a surface: a function; or nil and a sentence.
local function on_face(surface, name)
  local triangles = triangles_of(surface, name)
  if #triangles == 0 then return nil, no_face(surface, name) end
  local on = on_triangles(surface.points:totable(), triangles, ON_FACE * model.diagonal(surface.box))
  return function(p) return on(p[1], p[2], p[3]) end
end

-- Of each kind: how it is written, how its parts are read (with `whole` one part is all the text), what it selects
-- of a boundary, and whether a point lies in it (nil: the surface knows).
local kinds = {
  all = {form = "all", parts = {},
    select = function(boundary) return boundary end,
    test = function() return true end},
  min = {form = "min:AXIS", parts = {axis_of},
    select = function(boundary, box, axis) return boundary:below(axis, min_end(box, axis)) end,
    test = function(p, box, axis) return p[axis] <= min_end(box, axis) end},
  max = {form = "max:AXIS", parts = {axis_of},
    select = function(boundary, box, axis) return boundary:above(axis, max_end(box, axis)) end,
    test = function(p, box, axis) return p[axis] >= max_end(box, axis) end},
  below = {form = "below:AXIS:COORDINATE", parts = {axis_of, length_of},
    select = function(boundary, _, axis, at) return boundary:below(axis, at) end,
    test = function(p, _, axis, at) return p[axis] <= at end},
  above = {form = "above:AXIS:COORDINATE", parts = {axis_of, length_of},
    select = function(boundary, _, axis, at) return boundary:above(axis, at) end,
    test = function(p, _, axis, at) return p[axis] >= at end},
  near = {form = "near:X,Y,Z:RADIUS", parts = {places.point, length_of},
    select = function(boundary, _, point, radius) return boundary:near(point, radius) end,
    test = function(p, _, point, radius)
      return (p[1] - point[1]) ^ 2 + (p[2] - point[2]) ^ 2 + (p[3] - point[3]) ^ 2 <= radius ^ 2
    end},
  face = {form = "face:NAME", parts = {face_of}, whole = true,
    select = function(boundary, _, name) return boundary:face(name) end},
}

-- The kind of a place and its values, or nil and a sentence.
local function read(text)
  local name, rest = text:match "^(%l+):?(.*)$"
  local kind = kinds[name]
  if not kind then
    return nil, ("'%s' is no place: all, min:z, max:z, below:z:1mm, above:z:20mm, near:0,0,30mm:5mm or face:NAME "
      .. "expected"):format(text)
  end
  local words, values = {}, {}
  if kind.whole then
    words[1] = rest
  elseif rest ~= "" then
    for word in (rest .. ":"):gmatch "([^:]*):" do words[#words + 1] = word end
  end
  if #words ~= #kind.parts then
    return nil, ("%s expected, got '%s'"):format(kind.form, text)
  end
  for i, word in ipairs(words) do
    local message
    values[i], message = kind.parts[i](word)
    if not values[i] then return nil, ("'%s': %s"):format(text, message) end
  end
  return kind, values
end

-- ---- what commands ask -----------------------------------------------------------------------------

--- Checks the text of a place without a mesh: nil and a sentence where it is none.
function places.check(text)
  local kind, message = read(text)
  if not kind then return nil, message end
  return true
end

--- "PLACE=VALUE": the place and what stands behind the last "=", or nil and a sentence.
function places.split(text)
  local place, value = text:match "^(.*)=([^=]*)$"
  if not place then return nil, ("PLACE=VALUE expected, got '%s'"):format(text) end
  local ok, message = places.check(place)
  if not ok then return nil, message end
  return place, value
end

--- Whether a point (x, y, z) of a surface lies in one of several places of it: a function; or nil and a sentence.
function places.test(texts, surface)
  local list, box = {}, surface.box
  for i, text in ipairs(texts) do
    local kind, values = read(text)
    if not kind then return nil, values end
    local test, message = kind.test
    if not test then test, message = on_face(surface, values[1]) end
    if not test then return nil, ("%s: %s"):format(text, message) end
    list[i] = function(p) return test(p, box, values[1], values[2]) end
  end
  return function(x, y, z)
    for _, test in ipairs(list) do
      if test {x, y, z} then return true end
    end
    return false
  end
end

--- The selection on a mesh, or nil and a sentence.
function places.select(mesh, text)
  local kind, values = read(text)
  if not kind then return nil, values, {status = "misuse"} end
  local selection, message = model.try(kind.select, mesh.boundary, mesh.box, values[1], values[2])
  if not selection then
    if kind == kinds.face then message = no_face(mesh, values[1]) end
    -- Scripts read numbers of nodes.
    message = message:gsub("the nearest is node %d+ at", "the nearest one is at")
    return nil, ("%s: %s"):format(text, message), {status = "empty"}
  end
  return selection
end

-- Points along the side of a facet at which it is asked whether they lie in a place.
local SAMPLES = 8

-- How much of a triangle lies in a place, by the centres of so many parts along each side.
local function part_inside(kind, values, box, a, b, c, samples)
  local inside, p = 0, {}
  for i = 0, samples - 1 do
    for j = 0, samples - 1 do
      local u, v = (i + 1 / 3) / samples, (j + 1 / 3) / samples
      if i + j >= samples then u, v = 1 - (j + 1 / 3) / samples, 1 - (i + 1 / 3) / samples end
      for k = 1, 3 do p[k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]) end
      if kind.test(p, box, values[1], values[2]) then inside = inside + 1 end
    end
  end
  return inside / samples ^ 2
end

--- A selection holds the facets that lie in a place as a whole. The selection with those that lie in it partly,
--- and which share of their area does; nil where there is none.
function places.wider(mesh, text, selection)
  local kind, values = read(text)
  if not kind.test then return nil end
  local mask, box = {}, mesh.box
  local nodes, facets = mesh.nodes:totable(), mesh.facets:totable()
  for i = 1, #facets do mask[i] = 0 end
  for _, i in ipairs(selection.facets:totable()) do mask[i] = 1 end
  local part, whole = 0, 0
  for i, facet in ipairs(facets) do
    local a, b, c = nodes[facet[1]], nodes[facet[2]], nodes[facet[3]]
    if mask[i] == 0 and part_inside(kind, values, box, a, b, c, 2) > 0 then
      local u, v = {}, {}
      for k = 1, 3 do u[k], v[k] = b[k] - a[k], c[k] - a[k] end
      local area = math.sqrt((u[2] * v[3] - u[3] * v[2]) ^ 2 + (u[3] * v[1] - u[1] * v[3]) ^ 2
        + (u[1] * v[2] - u[2] * v[1]) ^ 2) / 2
      mask[i] = 1
      part = part + area * part_inside(kind, values, box, a, b, c, SAMPLES)
      whole = whole + area
    end
  end
  if part == 0 then return nil end
  return mesh.boundary:where(bw.array.new(mask)), part / whole
end

return places
