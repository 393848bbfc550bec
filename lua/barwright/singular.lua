-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Singular places: where linear elasticity has no finite stress, found from shape, supports and loads.
-- docs/theory/singular.md.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local distance = require("barwright.points").distance

local places = {}
places.__index = places
places.__name = "barwright.singular_places"

local LINES = 12

local function degrees(angle)
  return 180 / math.pi * angle
end

-- The fraction of the way from a to b of the point nearest to x.
local function fraction_of(a, b, x)
  local along, size = 0, 0
  for k = 1, 3 do
    along = along + (b[k] - a[k]) * (x[k] - a[k])
    size = size + (b[k] - a[k]) ^ 2
  end
  return size > 0 and math.max(0, math.min(1, along / size)) or 0
end

local function mixed(a, b, fraction)
  local out = {}
  for k = 1, 3 do out[k] = (1 - fraction) * a[k] + fraction * b[k] end
  return out
end

local function unit(v)
  local size = distance(v, {0, 0, 0})
  return size > 0 and {v[1] / size, v[2] / size, v[3] / size} or v
end

-- The point of a place nearest to x: distance, point, bisector into the material.
local function nearest_on(place, x)
  local min, at, inward = distance(place.points[1], x), place.points[1], place.inward[1]
  for i = 1, #place.points - 1 do
    local a, b = place.points[i], place.points[i + 1]
    local fraction = fraction_of(a, b, x)
    local point = mixed(a, b, fraction)
    local far = distance(point, x)
    if far < min then
      min, at, inward = far, point, unit(mixed(place.inward[i], place.inward[i + 1], fraction))
    end
  end
  return min, at, inward
end

local function is_point(value)
  for k = 1, 3 do
    local x = rawget(value, k)
    if type(x) ~= "number" or x ~= x or math.abs(x) == math.huge then return false end
  end
  return rawlen(value) == 3
end

--- The place nearest to a point: {place, distance, at, inward}; nil where none is within `radius`. Among those as
--- near, the one of fastest growth.
function places:near(point, radius)
  if not is_point(point) then
    core.raise(("near: point: three finite numbers {x, y, z} expected, got %s"):format(core.got(point)))
  end
  local best
  for _, place in ipairs(self) do
    local far, at, inward = nearest_on(place, point)
    if far <= (radius or math.huge) and (not best or far < best.distance - 1e-9 * (radius or far)
      or far <= best.distance + 1e-9 * (radius or far) and place.exponent < best.place.exponent) then
      best = {place = place, distance = far, at = at, inward = inward}
    end
  end
  return best
end

local function line_of(place)
  local a, b = place.points[1], place.points[#place.points]
  local from = core.point(a)
  if place.length == 0 then return ("%s at %s: stress like h^%.4g"):format(place.kind, from, -place.growth) end
  local where = distance(a, b) == 0 and "ring through " .. from or from .. " to " .. core.point(b)
  local angle = place.angle and (", %.4g degrees inside the material"):format(degrees(place.angle)) or ""
  return ("%s, %s, %s%s: stress like h^%.4g"):format(place.kind, core.quantity(place.length, "m"), where, angle,
    -place.growth)
end

function places:__tostring()
  local lines = {#self == 0 and "no singular places" or ("%d singular place%s"):format(#self,
    #self == 1 and "" or "s")}
  for i = 1, math.min(#self, LINES) do lines[#lines + 1] = "  " .. line_of(self[i]) end
  if #self > LINES then lines[#lines + 1] = ("  and %d more"):format(#self - LINES) end
  return table.concat(lines, "\n")
end

-- The places that were found, as keys.
local found = setmetatable({}, {__mode = "k"})

local function found_ones(list)
  for _, place in ipairs(list) do found[place] = true end
  return setmetatable(list, places)
end

--- A list of places of one's own choice among those that were found.
function places.list(chosen)
  local list = {}
  for i, place in ipairs(chosen) do
    if not found[place] then
      core.raise(("list: item %d: a place of singular_edges or singular_places expected, got %s"):format(i,
        core.got(place)))
    end
    list[i] = place
  end
  return setmetatable(list, places)
end

arguments.methods("singular places", places, places, {near = "point: table, radius?: number"})
arguments.functions("", places, {list = "chosen: table"})

local edge_rules = {angle = {type = "number", above = 0, max = 1.5}}

local surface = core.classes.surface.methods

--- The re-entrant edges of a closed surface, the longest first; nil, message, details where it has no inside.
function surface:singular_edges(given)
  local opts = options.read("singular_edges", given, edge_rules)
  local list, message, details = core.singular_edges(self, opts.angle or 0)
  if not list then return nil, message, details end
  return found_ones(list)
end

local place_rules = {angle = edge_rules.angle, surface = {type = "surface"}}

local model = core.classes.model.methods

--- Re-entrant edges, borders of supports, and what acts on points and lines; nil, message, details where the shape
--- has no inside.
function model:singular_places(given)
  local opts = options.read("singular_places", given, place_rules)
  local list, message, details = core.singular_places(self, opts.surface, opts.angle or 0)
  if not list then return nil, message, details end
  return found_ones(list)
end

arguments.methods("model", model, nil, {singular_places = "options?: options"})
arguments.methods("surface", surface, nil, {singular_edges = "options?: options"})

return places
