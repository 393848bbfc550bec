-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Fillets of outlines: corners between two lines replaced by arcs, which have a tag of their own.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local outline = require "barwright.outline"

local raise = core.raise
local methods = core.classes.outline.methods

-- The vertices that are asked for, as a set; nil for all.
local function wanted(self, vertices)
  if vertices == nil then return nil end
  local set, count = {}, self.edge_count
  for _, vertex in ipairs(type(vertices) == "table" and vertices or {vertices}) do
    if math.type(vertex) ~= "integer" or vertex < 1 or vertex > count then
      raise(("fillet: option 'vertices': numbers from 1 to %d expected, got %s"):format(count,
        core.got(vertex)))
    end
    set[vertex] = true
  end
  return set
end

-- The arc of a corner: {cut = length that it takes of either line, turn =, u =, v = directions before and behind,
-- at = the corner}, or nil where the edges go straight on.
local function corner_of(before, after, radius)
  local u = {before.to[1] - before.from[1], before.to[2] - before.from[2]}
  local v = {after.to[1] - after.from[1], after.to[2] - after.from[2]}
  for k = 1, 2 do
    u[k], v[k] = u[k] / before.length, v[k] / after.length
  end
  local turn = math.atan(u[1] * v[2] - u[2] * v[1], u[1] * v[1] + u[2] * v[2])
  if math.abs(turn) < 1e-6 then return nil end
  return {cut = radius * math.tan(math.abs(turn) / 2), turn = turn, u = u, v = v, at = after.from}
end

-- Where the arc of a corner begins.
local function begin_of(corner)
  return {corner.at[1] - corner.cut * corner.u[1], corner.at[2] - corner.cut * corner.u[2]}
end

-- Adds the arc to a loop's entries: a cubic for every 45 degrees that have begun.
local function add_arc(list, corner, radius, tag)
  local side = corner.turn > 0 and 1 or -1
  local from = begin_of(corner)
  local to = {corner.at[1] + corner.cut * corner.v[1], corner.at[2] + corner.cut * corner.v[2]}
  local centre = {from[1] - side * radius * corner.u[2], from[2] + side * radius * corner.u[1]}
  local pieces = math.ceil(math.abs(corner.turn) / (math.pi / 4) - 1e-9)
  local step = corner.turn / pieces
  local k = 4 / 3 * math.tan(math.abs(step) / 4) * radius
  local function at(angle) -- place and direction, turned by the angle
    local cos, sin = math.cos(angle), math.sin(angle)
    local x, y = from[1] - centre[1], from[2] - centre[2]
    return {centre[1] + cos * x - sin * y, centre[2] + sin * x + cos * y},
      {cos * corner.u[1] - sin * corner.u[2], sin * corner.u[1] + cos * corner.u[2]}
  end
  for i = 1, pieces do
    local p, d = at((i - 1) * step)
    local q, e = at(i * step)
    if i == pieces then q, e = to, corner.v end
    list[#list + 1] = {tag = tag, {p[1] + k * d[1], p[2] + k * d[2]}, {q[1] - k * e[1], q[2] - k * e[2]}, q}
  end
end

-- The corners of a loop by number of the vertex in it; raises where an arc does not fit.
local function corners_of(self, loop, set, radius)
  local edges, corners = {}, {}
  for i = 1, loop.count do edges[i] = self:edge(loop.first + i - 1) end
  for i, after in ipairs(edges) do
    local before, vertex = edges[(i - 2) % loop.count + 1], loop.first + i - 1
    if set and set[vertex] and (before.control or after.control) then
      raise(("fillet: vertex %d: a corner between two lines expected, got the end of a curve"):format(vertex))
    end
    if (not set or set[vertex]) and not before.control and not after.control then
      corners[i] = corner_of(before, after, radius)
    end
  end
  for i, edge in ipairs(edges) do
    local first, second = corners[i], corners[i % loop.count + 1]
    local taken = (first and first.cut or 0) + (second and second.cut or 0)
    if not edge.control and taken > edge.length * (1 + 1e-12) then
      raise(("fillet: the arcs at edge %d take %s of its %s: a smaller radius expected, got %s"):format(
        loop.first + i - 1, core.quantity(taken, "m"), core.quantity(edge.length, "m"),
          core.quantity(radius, "m")))
    end
  end
  return edges, corners
end

-- A loop as bw.outline takes it, with its corners replaced. Edge n of that list leads from entry n to the next.
local function filleted(self, loop, set, radius, tag)
  local edges, corners = corners_of(self, loop, set, radius)
  local list, made = {}, {points = {}, name = loop.name, tags = {}}
  for i, edge in ipairs(edges) do
    local first, second = corners[i], corners[i % loop.count + 1]
    if first then add_arc(list, first, radius, tag) end
    if edge.control then
      list[#list + 1] = {tag = edge.tag, edge.control[1], edge.control[2], edge.to}
    elseif (first and first.cut or 0) + (second and second.cut or 0) < edge.length * (1 - 1e-12) then
      list[#list + 1] = {tag = edge.tag, at = second and begin_of(second) or edge.to}
    end -- else the next arc begins where this one ends
  end
  for i, entry in ipairs(list) do
    made.points[i] = entry.at or {entry[1], entry[2], entry[3]}
    made.tags[entry.tag] = made.tags[entry.tag] or {}
    table.insert(made.tags[entry.tag], (i - 2) % #list + 1)
  end
  return made
end

--- The outline with arcs in the place of corners between two lines.
function methods:fillet(radius, given)
  local opts = options.read("fillet", given or {}, {vertices = {type = "any"},
    tag = {type = "string", default = "fillet"}})
  if not (radius > 0 and radius < math.huge) then
    raise(("fillet: radius: a length in m above 0 expected, got %g"):format(radius))
  end
  local set = wanted(self, opts.vertices)
  local holes, regions, outer = {}, {}, nil
  for _, loop in ipairs(self.loops) do
    local made = filleted(self, loop, set, radius, opts.tag)
    if loop.hole then
      holes[#holes + 1] = made
    elseif not outer then
      outer = made
    else
      made.region = loop.region
      regions[#regions + 1] = made
    end
  end
  outer.holes, outer.regions = holes, regions
  return outline(outer)
end

arguments.methods("outline", methods, nil, {fillet = "radius: number, options?: options"})
