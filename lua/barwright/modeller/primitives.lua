-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Cone, prism and torus, and the number of sides of round ones from a tolerance.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local profile = require "barwright.modeller.profile"
local sections = require "barwright.modeller.sections"
local vectors = require "barwright.modeller.vectors"

local raise = core.raise
local surface = core.surface
local FULL = 2 * math.pi

local function needed(where, opts, key)
  if opts[key] == nil then raise(("%s: option '%s' is needed"):format(where, key)) end
end

-- Sides of a whole circle.
local function around(opts, radius)
  if opts.segments then return opts.segments end
  if opts.tolerance then return math.max(3, profile.sides(FULL, radius, opts.tolerance)) end
  return 48
end

-- The matrix that puts a solid along z at a place, along an axis.
local function placed(made, at, axis)
  local z = vectors.unit(axis)
  local x, y = vectors.frame(z)
  return made:transform {{x[1], y[1], z[1], at[1]}, {x[2], y[2], z[2], at[2]}, {x[3], y[3], z[3], at[3]}}
end

-- A section of a solid along z: a regular polygon; a point where the radius is 0.
local function ring(solid, count, radius, z)
  local list, apex = {}, radius == 0 and solid:point {0, 0, z}
  for i = 1, count do
    local angle = FULL * (i - 1) / count
    list[i] = apex or solid:point {radius * math.cos(angle), radius * math.sin(angle), z}
  end
  return list
end

-- A circle, or a polygon whose sides have tags of their own.
local function polygon_of(count, tag)
  local polygon = {points = {}, tags = {}, curved = {}}
  for i = 1, count do
    local angle = FULL * (i - 1) / count
    polygon.points[i] = {math.cos(angle), math.sin(angle)}
    polygon.tags[i] = tag and tag(i) or "side"
    polygon.curved[i] = not tag
  end
  return polygon
end

-- A frustum along an axis, of `count` sides.
local function frustum(where, opts, count, bottom, top, tag)
  local base, axis = vectors.check(where, "base", opts.base or {0, 0, 0}), vectors.check(where, "axis", opts.axis)
  local height = vectors.norm(axis)
  if height == 0 then raise(where .. ": option 'axis': a vector of some length expected, got 0") end
  local polygons = {polygon_of(count, tag)}
  local triangles, message, details = profile.triangles(polygons)
  if not triangles then return nil, message, details end
  local solid = sections.new()
  local low, high = ring(solid, count, bottom, 0), ring(solid, count, top, height)
  solid:cap("bottom", low, triangles, true)
  solid:cap("top", high, triangles, false)
  solid:join(polygons, low, high)
  local made
  made, message, details = solid:surface()
  if not made then return nil, message, details end
  return placed(made, base, axis)
end

local round = {segments = {type = "integer", min = 3, max = 1000000}, tolerance = {type = "number", above = 0}}

local function rules(more)
  for key, rule in pairs(round) do more[key] = rule end
  return more
end

function surface.cone(given)
  local where = "surface.cone"
  local opts = options.read(where, given, rules {base = {type = "table"}, axis = {type = "table"},
    radius = {type = "number", min = 0}, top_radius = {type = "number", min = 0, default = 0}})
  needed(where, opts, "axis")
  needed(where, opts, "radius")
  local largest = math.max(opts.radius, opts.top_radius)
  if largest == 0 then raise(where .. ": option 'radius': above 0 at one end at least expected") end
  return frustum(where, opts, around(opts, largest), opts.radius, opts.top_radius)
end

function surface.prism(given)
  local where = "surface.prism"
  local opts = options.read(where, given, {base = {type = "table"}, axis = {type = "table"},
    radius = {type = "number", above = 0}, sides = {type = "integer", min = 3, max = 1000000}})
  for _, key in ipairs {"axis", "radius", "sides"} do needed(where, opts, key) end
  return frustum(where, opts, opts.sides, opts.radius, opts.radius, function(i) return "side " .. i end)
end

function surface.torus(given)
  local where = "surface.torus"
  local opts = options.read(where, given, rules {centre = {type = "table"}, axis = {type = "table"},
    radius = {type = "number", above = 0}, tube = {type = "number", above = 0}})
  needed(where, opts, "radius")
  needed(where, opts, "tube")
  local centre = vectors.check(where, "centre", opts.centre or {0, 0, 0})
  local axis = vectors.check(where, "axis", opts.axis or {0, 0, 1})
  if vectors.norm(axis) == 0 then raise(where .. ": option 'axis': a vector of some length expected, got 0") end
  if opts.tube >= opts.radius then
    raise(("%s: option 'tube': less than the radius, %g m, expected, got %g"):format(where, opts.radius,
      opts.tube))
  end
  local count, tube = around(opts, opts.radius + opts.tube), around(opts, opts.tube)
  local polygon = polygon_of(tube, function() return "torus" end)
  for _, p in ipairs(polygon.points) do p[1], p[2] = opts.radius + opts.tube * p[1], opts.tube * p[2] end
  local solid, list = sections.new(), {}
  for k = 1, count do
    local angle = -FULL * (k - 1) / count -- x × y of a section points against the turn
    list[k] = {}
    for i, p in ipairs(polygon.points) do
      list[k][i] = solid:point {p[1] * math.cos(angle), p[1] * math.sin(angle), p[2]}
    end
  end
  local made, message, details = solid:through({polygon}, list, true)
  if not made then return nil, message, details end
  return placed(made, centre, axis)
end

arguments.functions("surface.", surface, {cone = "options: options", prism = "options: options",
  torus = "options: options"})

-- ---- a tolerance for what the engine makes -----------------------------------------------------------

local cylinder, sphere = surface.cylinder, surface.sphere

-- Options without `tolerance`, and the tolerance. Whatever else is wrong the engine says.
local function split(where, given, key)
  if type(given) ~= "table" or rawget(given, "tolerance") == nil then return nil end
  local tolerance, radius = given.tolerance, given.radius
  if type(tolerance) ~= "number" or not (tolerance > 0 and tolerance < math.huge) then
    raise(("%s: option 'tolerance': a length in m above 0 expected, got %s"):format(where, core.got(tolerance)))
  end
  if given[key] ~= nil then raise(("%s: give 'tolerance' or '%s', not both"):format(where, key)) end
  local rest = {}
  for name, value in pairs(given) do
    if name ~= "tolerance" then rest[name] = value end
  end
  return type(radius) == "number" and radius > 0 and radius < math.huge and tolerance or nil, rest
end

function surface.cylinder(given)
  local tolerance, rest = split("surface.cylinder", given, "segments")
  if tolerance then rest.segments = around({tolerance = tolerance}, given.radius) end
  return cylinder(rest or given)
end

-- The largest angle (rad) between the middle of a triangle and its corners on an icosahedron; cutting into four
-- halves it, or a little more than halves it.
local WIDEST = 0.6524
local SLACK = 1.2

function surface.sphere(given)
  local tolerance, rest = split("surface.sphere", given, "subdivisions")
  if tolerance then
    local cuts, angle = 0, WIDEST
    while cuts < 9 and given.radius * (1 - math.cos(angle)) > tolerance do
      cuts = cuts + 1
      angle = SLACK * WIDEST / 2 ^ cuts
    end
    rest.subdivisions = cuts
  end
  return sphere(rest or given)
end
