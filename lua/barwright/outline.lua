-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- bw.outline: shapes in the plane from lists of points and curves; what edits of them are Lua.
--
-- A loop is a list. An entry {x, y} is a vertex to which a line leads from the vertex before it; an
-- entry {{x, y}, {x, y}, {x, y}} is one to which a cubic leads, by its two control points. The first
-- entry's line or curve comes from the last vertex and closes the loop. Edge n leads from vertex n to
-- the next.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local shapes = require "barwright.outline_shapes"
local shown = require "barwright.shown"

local raise = core.raise

local outline = {}
for name, make in pairs(shapes) do outline[name] = make end
outline.read = core.outline.read

local function kind_of(value)
  return core.class_name(value) or type(value)
end

local function is_pair(value)
  return type(value) == "table" and #value == 2 and type(value[1]) == "number"
    and type(value[2]) == "number"
end

-- ---- loops as lists ------------------------------------------------------------------------------

-- One entry as vertex, control, control.
local function read_entry(where, entry, place)
  if is_pair(entry) then return entry end
  if type(entry) == "table" and #entry == 3 and is_pair(entry[1]) and is_pair(entry[2])
    and is_pair(entry[3]) then
    return entry[3], entry[1], entry[2]
  end
  raise(("%s: point %d: {x, y} or a curve {{x, y}, {x, y}, {x, y}} expected, got %s"):format(where, place,
    core.got(entry)))
end

-- name of every edge by {tag = edge numbers or one number}
local function read_tags(where, given, count)
  local tags = {}
  if given == nil then return tags end
  if type(given) ~= "table" then
    raise(("%s: tags: edges by tag, {name = {1, 2}}, expected, got %s"):format(where, core.got(given)))
  end
  local names = {}
  for name in pairs(given) do
    if type(name) ~= "string" then
      raise(("%s: tags: edges by tag, {name = {1, 2}}, expected, got the key %s"):format(where, core.got(name)))
    end
    names[#names + 1] = name
  end
  table.sort(names)
  for _, name in ipairs(names) do
    local edges = given[name]
    for _, edge in ipairs(type(edges) == "table" and edges or {edges}) do
      if math.type(edge) ~= "integer" or edge < 1 or edge > count then
        raise(("%s: tag '%s': edges from 1 to %d expected, got %s"):format(where, name, count,
          core.got(edge)))
      end
      if tags[edge] then
        raise(("%s: edge %d has the tags '%s' and '%s'"):format(where, edge, tags[edge], name))
      end
      tags[edge] = name
    end
  end
  return tags
end

local loop_keys = {"name", "tag", "tags", "region", "points"}

local function check_keys(where, given)
  for key in pairs(given) do
    local known = math.type(key) == "integer"
    for _, name in ipairs(loop_keys) do known = known or key == name end
    if not known then
      raise(("%s: unknown option '%s': %s"):format(where, tostring(key),
        core.suggestion(tostring(key), loop_keys)))
    end
  end
end

local function check_name(where, name)
  if name ~= nil and type(name) ~= "string" then
    raise(("%s: a name expected, got %s"):format(where, core.got(name)))
  end
  return name
end

-- Adds a loop to a draft {points, segments, loops, tags, tag_number}.
local function add_loop(draft, where, given, region, default_name)
  if type(given) ~= "table" then
    raise(("%s: a list of points expected, got %s"):format(where, core.got(given)))
  end
  check_keys(where, given)
  local list = given.points or given
  if type(list) ~= "table" then
    raise(("%s: option 'points': a list of points expected, got %s"):format(where, core.got(list)))
  end
  local name = check_name(where .. ": name", given.name)
  local tag = check_name(where .. ": tag", given.tag) or name or "boundary"
  local count = #list
  if count == 0 then raise(("%s: one point or more expected, got none"):format(where)) end
  local tags = read_tags(where, given.tags, count)
  local start, control = {}, {}
  for i, entry in ipairs(list) do
    local at, c1, c2 = read_entry(where, entry, i)
    draft.points[#draft.points + 1] = at
    start[i] = #draft.points
    -- the curve that leads here is that of the edge before
    if c1 then
      draft.points[#draft.points + 1] = c1
      draft.points[#draft.points + 1] = c2
      control[(i - 2) % count + 1] = #draft.points - 1
    end
  end
  for i = 1, count do
    local own = tags[i] or tag
    if not draft.tag_number[own] then
      draft.tags[#draft.tags + 1] = own
      draft.tag_number[own] = #draft.tags
    end
    draft.segments[#draft.segments + 1] = {start[i], control[i] or 0,
      control[i] and control[i] + 1 or 0, start[i % count + 1], draft.tag_number[own]}
  end
  draft.loops[#draft.loops + 1] = {count = count, region = region, name = name or default_name}
end

local function new_draft(tags)
  local draft = {points = {}, segments = {}, loops = {}, tags = {}, tag_number = {}}
  for i, tag in ipairs(tags or {}) do
    draft.tags[i] = tag
    draft.tag_number[tag] = i
  end
  return draft
end

-- The loop that a list or an outline stands for.
local function loop_of(where, given)
  if kind_of(given) ~= "outline" then return given end
  if #given.loops ~= 1 then
    raise(("%s: an outline of one loop expected, this has %d"):format(where, #given.loops))
  end
  local list = given:loop(1)
  list.region = nil
  if list.name == "outline" then list.name, list.tag = nil, nil end
  return list
end

local function new_name(names, stem)
  local n = 1
  while names[("%s %d"):format(stem, n)] do n = n + 1 end
  local name = ("%s %d"):format(stem, n)
  names[name] = true
  return name
end

-- Loops under option `key`: each a list, or an outline of one loop.
local function add_all(draft, names, key, given, region_of)
  if type(given) ~= "table" then
    raise(("outline: %s: a list of loops expected, got %s"):format(key, core.got(given)))
  end
  local stem = key:sub(1, -2)
  for i, one in ipairs(given) do
    local where = ("outline: %s %d"):format(stem, i)
    local loop = loop_of(where, one)
    local region = region_of(loop, where)
    local name = type(loop) == "table" and loop.name or new_name(names, stem)
    add_loop(draft, where, loop, region, name)
  end
end

local rules = {
  points = {type = "table", needed = true},
  name = {type = "string", default = "outline"},
  tag = {type = "string"},
  tags = {type = "table"},
  holes = {type = "table", default = {}},
  regions = {type = "table", default = {}},
}

--- An outline from {points = loop, name, tag, tags, holes = {loops}, regions = {loops}}, or from the
--- loop alone.
local function create(given)
  if type(given) ~= "table" then
    raise(("outline: a table of points expected, got %s"):format(core.got(given)))
  end
  if rawlen(given) > 0 then given = {points = given} end
  local opts = options.read("outline", given, rules)
  if #opts.points == 0 then raise "outline: points: a list of points expected, got an empty table" end
  local draft, names = new_draft(), {}
  add_loop(draft, "outline", {points = opts.points, tags = opts.tags, tag = opts.tag or
    (given.name and given.name or "boundary"), name = opts.name}, 1)
  add_all(draft, names, "holes", opts.holes, function() return 0 end)
  local regions = 1
  add_all(draft, names, "regions", opts.regions, function(loop, where)
    local region = type(loop) == "table" and loop.region
    if region and (math.type(region) ~= "integer" or region < 1 or region > regions + 1) then
      raise(("%s: region: a number from 1 to %d expected, got %s"):format(where, regions + 1, core.got(region)))
    end
    region = region or regions + 1
    regions = math.max(regions, region)
    return region
  end)
  return core.outline.make(draft.points, draft.segments, draft.loops, draft.tags)
end

setmetatable(outline, {__call = function(_, given) return create(given) end})

-- ---- methods -------------------------------------------------------------------------------------

local methods = core.classes.outline.methods

--- A loop as a list: what bw.outline takes, with name, region (none: a hole) and tags.
function methods:loop(wanted)
  local loops = self.loops
  local loop
  for i, one in ipairs(loops) do
    if i == wanted or one.name == wanted then loop = one end
  end
  if not loop then
    local names = {}
    for i, one in ipairs(loops) do names[i] = one.name end
    raise(("there is no loop '%s': %s"):format(tostring(wanted),
      core.suggestion(tostring(wanted), names)))
  end
  local list = {name = loop.name, region = loop.region, tags = {}}
  for i = 1, loop.count do
    local edge = self:edge(loop.first + i - 1)
    local place = i % loop.count + 1
    list[place] = edge.control and {edge.control[1], edge.control[2], edge.to} or edge.to
    local tagged = list.tags[edge.tag] or {}
    tagged[#tagged + 1] = i
    list.tags[edge.tag] = tagged
  end
  return list
end

local function add(self, where, given, region, stem)
  local loop = loop_of(where, given)
  local names = {}
  for _, one in ipairs(self.loops) do names[one.name] = true end
  local draft = new_draft(self.tags)
  add_loop(draft, where, loop, region, type(loop) == "table" and loop.name or new_name(names, stem))
  -- A tag that is new comes in by the whole outline, made again.
  if #draft.tags > #self.tags then
    local all = new_draft(self.tags)
    for i, one in ipairs(self.loops) do
      add_loop(all, where, self:loop(i), one.region or 0)
    end
    add_loop(all, where, loop, region, draft.loops[1].name)
    return core.outline.make(all.points, all.segments, all.loops, all.tags)
  end
  return self:with_loop(draft.points, draft.segments, draft.loops[1])
end

--- The outline with a hole more: a loop as a list, or an outline of one loop.
function methods:hole(loop)
  return add(self, "hole", loop, 0, "hole")
end

--- The outline with a region more; `region` of the list is its number, else it is a new one.
function methods:region(loop)
  local given = kind_of(loop) == "outline" and {} or loop
  local number = type(given) == "table" and given.region or self.region_count + 1
  if math.type(number) ~= "integer" or number < 1 or number > self.region_count + 1 then
    raise(("region: a number from 1 to %d expected, got %s"):format(self.region_count + 1,
      core.got(number)))
  end
  return add(self, "region", loop, number, "region")
end

-- Edges by {edges = {...}}, {near = {x, y}, radius = }, {box = {min, max}}, {loop = name}, or numbers.
local selections = {
  edges = {type = "any"},
  near = {type = "table"},
  radius = {type = "number", min = 0},
  box = {type = "table"},
  loop = {type = "any"},
}

local function within(box, min, max)
  for k = 1, 2 do
    if box.min[k] < min[k] or box.max[k] > max[k] then return false end
  end
  return true
end

local function one_selection(self, opts, edges)
  if opts.edges ~= nil then
    return type(opts.edges) == "table" and opts.edges or {opts.edges}
  end
  if opts.near then
    if not is_pair(opts.near) then raise("edges: option 'near': {x, y} expected, got " .. core.got(opts.near)) end
    if not opts.radius then return {self:nearest(opts.near).edge} end
    for edge = 1, self.edge_count do
      if self:edge_distance(edge, opts.near) <= opts.radius then edges[#edges + 1] = edge end
    end
  elseif opts.box then
    local min, max = opts.box[1] or opts.box.min, opts.box[2] or opts.box.max
    if not (is_pair(min) and is_pair(max)) then
      raise("edges: option 'box': {min = {x, y}, max = {x, y}} expected, got " .. core.got(opts.box))
    end
    for edge = 1, self.edge_count do
      if within(self:edge(edge).box, min, max) then edges[#edges + 1] = edge end
    end
  elseif opts.loop then
    local name = opts.loop
    for i, one in ipairs(self.loops) do
      if one.name == name or i == name then
        for edge = one.first, one.first + one.count - 1 do edges[#edges + 1] = edge end
        return edges
      end
    end
    self:loop(name) -- raises and names the nearest
  else
    raise "edges: one of the options edges, near, box and loop expected, got none"
  end
  return edges
end

--- The numbers of edges: {edges = }, {near = {x, y}, radius = }, {box = {min, max}} (wholly inside),
--- {loop = name}, a number or a list of numbers. None raises.
function methods:edges(which)
  if math.type(which) == "integer" then which = {edges = which} end
  if type(which) == "table" and rawlen(which) > 0 then which = {edges = which} end
  local opts = options.read("edges", which, selections)
  local edges = one_selection(self, opts, {})
  if #edges == 0 then raise "edges: no edge lies in the selection" end
  for _, edge in ipairs(edges) do
    if math.type(edge) ~= "integer" or edge < 1 or edge > self.edge_count then
      raise(("edges: numbers from 1 to %d expected, got %s"):format(self.edge_count, core.got(edge)))
    end
  end
  return edges
end

--- The outline with a tag on the edges that self:edges(which) finds.
function methods:tag(name, which)
  if type(name) ~= "string" or name == "" then
    raise(("tag: a name expected, got %s"):format(core.got(name)))
  end
  return self:with_tag(name, self:edges(which))
end

local function check_pair(where, value, default)
  if value == nil then return default end
  if not is_pair(value) then raise(("%s: {x, y} expected, got %s"):format(where, core.got(value))) end
  return value
end

-- x' = c + m (x - c) + d
local function mapped(self, a, b, c, d, about, by)
  local points = self.points:totable()
  for _, p in ipairs(points) do
    local x, y = p[1] - about[1], p[2] - about[2]
    p[1] = about[1] + a * x + b * y + by[1]
    p[2] = about[2] + c * x + d * y + by[2]
  end
  return self:with_points(points)
end

--- Moved as a whole.
function methods:shifted(by)
  return mapped(self, 1, 0, 0, 1, {0, 0}, check_pair("shifted", by, {0, 0}))
end

--- Turned by degrees, counter-clockwise, about a point (default: the centroid).
function methods:rotated(degrees, about)
  if type(degrees) ~= "number" then
    raise(("rotated: an angle in degrees expected, got %s"):format(core.got(degrees)))
  end
  local c, s = math.cos(math.rad(degrees)), math.sin(math.rad(degrees))
  return mapped(self, c, -s, s, c, check_pair("rotated: about", about, self.centroid), {0, 0})
end

--- Scaled by a factor, or by {fx, fy}, about a point (default: the centroid).
function methods:scaled(factor, about)
  local f = type(factor) == "number" and {factor, factor} or factor
  if not is_pair(f) or not (f[1] > 0 and f[2] > 0) then
    raise(("scaled: a factor above 0, or two {fx, fy}, expected, got %s"):format(core.got(factor)))
  end
  return mapped(self, f[1], 0, 0, f[2], check_pair("scaled: about", about, self.centroid), {0, 0})
end

arguments.methods("outline", methods, nil, {loop = "loop: string|integer", hole = "loop: table|outline",
  region = "loop: table|outline", edges = "which: any", tag = "name: any, which: any", shifted = "by: any",
  rotated = "degrees: any, about?: any", scaled = "factor: any, about?: any"})

-- ---- in words ------------------------------------------------------------------------------------

--- Size, area and the loops, a line each.
function core.classes.outline.tostring(self)
  local about = self:measure()
  local size = {about.box.max[1] - about.box.min[1], about.box.max[2] - about.box.min[2]}
  local lines = {("outline, %s: area %s, perimeter %s, %d edges"):format(shown.size(size),
    core.quantity(about.area, "m2"), core.quantity(about.perimeter, "m"), self.edge_count)}
  for i, loop in ipairs(self.loops) do
    local tags, seen = {}, {}
    for edge = loop.first, loop.first + loop.count - 1 do
      local tag = self:edge(edge).tag
      if not seen[tag] then
        tags[#tags + 1] = tag
        seen[tag] = true
      end
    end
    lines[#lines + 1] = ("  %s%s: %s, edges %d to %d, tags %s"):format(loop.name,
      loop.parent and " in " .. loop.parent or "",
      loop.hole and "hole" or "region " .. loop.region, loop.first, loop.first + loop.count - 1,
      table.concat(tags, ", "))
    if i == 20 and #self.loops > 21 then
      lines[#lines + 1] = ("  and %d more"):format(#self.loops - i)
      break
    end
  end
  return table.concat(lines, "\n")
end

shapes.bind(create)
outline.bind = nil

return outline
