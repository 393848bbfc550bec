-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Surfaces whose groups of triangles have names, that moves and booleans keep; outlines extruded to such surfaces.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"

local raise = core.raise
local surface = core.classes.surface.methods

local names_of = setmetatable({}, {__mode = "k"}) -- surface -> names of its groups

local function number_in(names, name)
  for i, known in ipairs(names) do
    if known == name then return i end
  end
  names[#names + 1] = name
  return #names
end

-- The same triangles, whose groups are those of `names` that `rename` gives the old ones.
local function regrouped(from, names, rename)
  local old, groups, numbers = from.groups, {}, {}
  for t = 1, from.triangle_count do
    local name = rename(old and names_of[from] and names_of[from][old[t]])
    numbers[name] = numbers[name] or number_in(names, name)
    groups[t] = numbers[name]
  end
  return assert(core.surface.new {points = from.points, triangles = from.triangles, groups = groups})
end

--- The names of the groups; an empty list where they have none.
function surface:face_names()
  return table.move(names_of[self] or {}, 1, #(names_of[self] or {}), 1, {})
end

--- The same surface with one name for all triangles.
function surface:named(name)
  local names = {}
  local made = regrouped(self, names, function() return name end)
  names_of[made] = names
  return made
end

-- What the engine does, called by its own name: messages about wrong arguments have it.
local plain = {}
for name, method in pairs(surface) do plain[name] = method end

local function keep(self, made, ...)
  if made then names_of[made] = names_of[self] end
  return made, ...
end

function surface:transform(...) return keep(self, plain.transform(self, ...)) end
function surface:translate(...) return keep(self, plain.translate(self, ...)) end
function surface:rotate(...) return keep(self, plain.rotate(self, ...)) end
function surface:scale(...) return keep(self, plain.scale(self, ...)) end
function surface:weld(...) return keep(self, plain.weld(self, ...)) end

-- Both surfaces in groups of one list of names, and the list; as they are where neither has names.
local function grouped_alike(self, other)
  if not (core.class_name(other) == "surface" and (names_of[self] or names_of[other])) then return self, other end
  local names = {}
  local function kept(name) return name or "unnamed" end
  return regrouped(self, names, kept), regrouped(other, names, kept), names
end

local function name_result(names, made, ...)
  if made then names_of[made] = names end
  return made, ...
end

function surface:union(other)
  local first, second, names = grouped_alike(self, other)
  return name_result(names, plain.union(first, second))
end

function surface:difference(other)
  local first, second, names = grouped_alike(self, other)
  return name_result(names, plain.difference(first, second))
end

function surface:intersection(other)
  local first, second, names = grouped_alike(self, other)
  return name_result(names, plain.intersection(first, second))
end

local extrude_rules = {height = {type = "number", above = 0}, curvature = {type = "number", above = 0, max = 90}}

local function extrude(outline, given)
  local opts = options.read("surface.extrude", given, extrude_rules)
  if not opts.height then raise "surface.extrude: option 'height': a length in m expected, got nil" end
  local low, high = outline.box.min, outline.box.max
  local flat, message, details = core.plane.fill(outline, {size = math.max(high[1] - low[1], high[2] - low[2]),
    curvature = opts.curvature})
  if not flat then return nil, message, details end
  local points, triangles, groups, names = {}, {}, {}, {"start", "end"}
  local count = flat.node_count
  local function add(group, a, b, c)
    triangles[#triangles + 1], groups[#groups + 1] = {a, b, c}, group
  end
  for i = 1, count do
    local x, y = flat.points[i][1], flat.points[i][2]
    points[i], points[count + i] = {x, y, 0}, {x, y, opts.height}
  end
  for e = 1, flat.element_count do
    local a, b, c = flat.elements[e][1], flat.elements[e][2], flat.elements[e][3]
    add(1, a, c, b)
    add(2, count + a, count + b, count + c)
  end
  for s = 1, #flat.sides do
    local left, right = flat.side_elements[s][1], flat.side_elements[s][2]
    if left == 0 or right == 0 then
      local a, b = flat.sides[s][1], flat.sides[s][2]
      if left == 0 then a, b = b, a end
      local group = number_in(names, outline.tags[outline.segments[flat.side_edges[s]][5]])
      add(group, a, b, count + b)
      add(group, a, count + b, count + a)
    end
  end
  local made = assert(core.surface.new {points = points, triangles = triangles, groups = groups})
  names_of[made] = names
  return made
end
core.surface.extrude = extrude

--- The part of a mesh's boundary that lies on the triangles of a name.
function surface:face_on(mesh, name)
  local names = names_of[self] or {}
  for i, known in ipairs(names) do
    if known == name then
      local groups, mask = self:groups_on(mesh), {}
      for t = 1, #groups do mask[t] = groups[t] == i and 1 or 0 end
      return mesh.boundary:where(core.array(mask))
    end
  end
  raise(("face_on: no face has the name '%s': %s"):format(name, core.suggestion(name, names)))
end

arguments.methods("surface", surface, nil, {named = "name: string", face_names = "",
  face_on = "mesh: mesh, name: string"})
arguments.functions("surface.", core.surface, {extrude = "outline: outline, options: options"})
