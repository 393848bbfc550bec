-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Solids from outlines: extruded, revolved, swept, lofted. Faces have the tags of the outline, "start" and "end".
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local profile = require "barwright.modeller.profile"
local sections = require "barwright.modeller.sections"
local vectors = require "barwright.modeller.vectors"

local raise = core.raise

local solids = {}

local DEFAULT_TURN = 20 -- degrees between sides of a curve

local function with_curves(rules)
  rules.curvature = {type = "number", above = 0, max = 90, default = DEFAULT_TURN}
  rules.tolerance = {type = "number", above = 0}
  return rules
end

local function polygons_of(outline, opts)
  return profile.polygons(outline, function(edge)
    return profile.edge_sides(edge, opts.curvature, opts.tolerance)
  end)
end

-- ---- extruded --------------------------------------------------------------------------------------

function solids.extrude(outline, given)
  local opts = options.read("surface.extrude", given, with_curves {height = {type = "number", above = 0}})
  if not opts.height then raise "surface.extrude: option 'height': a length in m expected, got nil" end
  local polygons = polygons_of(outline, opts)
  local solid, list = sections.new(), {{}, {}}
  for k, z in ipairs {0, opts.height} do
    for _, polygon in ipairs(polygons) do
      for _, p in ipairs(polygon.points) do list[k][#list[k] + 1] = solid:point {p[1], p[2], z} end
    end
  end
  return solid:through(polygons, list)
end

-- ---- revolved --------------------------------------------------------------------------------------

local FULL = 2 * math.pi

function solids.revolve(outline, given)
  local opts = options.read("surface.revolve", given, with_curves {
    angle = {type = "number", above = 0, max = FULL * (1 + 1e-12), default = FULL},
    segments = {type = "integer", min = 3, max = 1000000},
  })
  local ring = opts.angle >= FULL * (1 - 1e-12)
  local polygons = polygons_of(outline, opts)
  local low, high = outline.box.min, outline.box.max
  local rounding = 1e-12 * math.max(high[1], high[2] - low[2])
  if low[1] < -rounding then
    raise(("surface.revolve: the outline reaches x = %g m: it turns about its y axis, and lies at x of 0 or more")
      :format(low[1]))
  end
  local steps
  if opts.tolerance and not opts.segments then steps = profile.sides(opts.angle, high[1], opts.tolerance)
  else steps = math.ceil((opts.segments or 48) * opts.angle / FULL - 1e-9) end
  steps = math.max(steps, ring and 3 or 1)
  local solid, list, on_axis = sections.new(), {}, {}
  -- x × y of a section points against a right-handed turn about z: the last section comes first.
  for k = 1, ring and steps or steps + 1 do
    local angle = -opts.angle * (k - 1) / steps + (ring and 0 or opts.angle)
    local cos, sin, list_k = math.cos(angle), math.sin(angle), {}
    if not ring and k == steps + 1 then cos, sin = 1, 0 end
    for _, polygon in ipairs(polygons) do
      for _, p in ipairs(polygon.points) do
        local i = #list_k + 1
        if p[1] <= rounding then
          on_axis[i] = on_axis[i] or solid:point {0, 0, p[2]}
          list_k[i] = on_axis[i]
        else
          list_k[i] = solid:point {p[1] * cos, p[1] * sin, p[2]}
        end
      end
    end
    list[k] = list_k
  end
  for _, polygon in ipairs(polygons) do
    for _, tag in ipairs(polygon.tags) do solid:curve(tag) end
  end
  return solid:through(polygons, list, ring)
end

-- ---- swept -----------------------------------------------------------------------------------------

-- The places of a path: a list, or samples of a curve.
local function places_of(opts)
  local list = {}
  if type(opts.path) == "function" then
    local last = opts.closed and opts.segments - 1 or opts.segments
    for i = 0, last do list[i + 1] = opts.path(i / opts.segments) end
  elseif type(opts.path) == "table" then
    table.move(opts.path, 1, #opts.path, 1, list)
  else
    raise "surface.sweep: option 'path': a list of places {x, y, z}, or a function of 0 to 1, expected"
  end
  for i, at in ipairs(list) do
    if not vectors.is(at) then raise(("surface.sweep: place %d of the path: {x, y, z} expected"):format(i)) end
    local before = list[i - 1] or opts.closed and list[#list]
    if before and vectors.norm(vectors.add(at, before, -1)) == 0 then
      raise(("surface.sweep: place %d of the path is the place before it: leave it out"):format(i))
    end
  end
  if #list < (opts.closed and 3 or 2) then
    raise(("surface.sweep: a path of at least %d places expected, got %d"):format(opts.closed and 3 or 2, #list))
  end
  return list
end

local SHARPEST = math.cos(math.rad(170))

-- Directions of the pieces of a path; raises where it turns back.
local function directions(places, closed)
  local list = {}
  for i = 1, closed and #places or #places - 1 do
    list[i] = vectors.unit(vectors.add(places[i % #places + 1], places[i], -1))
    local before = list[i - 1]
    if before and vectors.dot(before, list[i]) < SHARPEST or closed and i == #places
        and vectors.dot(list[i], list[1]) < SHARPEST then
      raise(("surface.sweep: the path turns back at place %d: a turn of at most 170 degrees expected"):format(i))
    end
  end
  return list
end

-- The x axes of the section on each piece, turned as little as they can be from piece to piece (a
-- rotation-minimising frame). On a closed path what is left over is spread along it.
local function axes(pieces, places, up, closed)
  local x = vectors.frame(pieces[1], up)
  if not x then raise "surface.sweep: option 'up': a vector that is not along the path's begin expected" end
  local list = {x}
  for i = 2, #pieces do list[i] = vectors.turned(list[i - 1], pieces[i - 1], pieces[i]) end
  if closed then
    local back = vectors.turned(list[#pieces], pieces[#pieces], pieces[1])
    local off = math.atan(vectors.dot(vectors.cross(back, x), pieces[1]), vectors.dot(back, x))
    local at, whole = 0, 0
    local lengths = {}
    for i = 1, #pieces do
      lengths[i] = vectors.norm(vectors.add(places[i % #places + 1], places[i], -1))
      whole = whole + lengths[i]
    end
    for i = 1, #pieces do
      list[i] = vectors.about(list[i], pieces[i], off * at / whole)
      at = at + lengths[i]
    end
  end
  return list
end

function solids.sweep(outline, given)
  local opts = options.read("surface.sweep", given, with_curves {
    path = {type = "any"}, up = {type = "table"}, closed = {type = "boolean", default = false},
    segments = {type = "integer", min = 3, max = 1000000, default = 64},
  })
  if opts.up then vectors.check("surface.sweep", "up", opts.up) end
  local places = places_of(opts)
  local pieces = directions(places, opts.closed)
  local across = axes(pieces, places, opts.up, opts.closed)
  local polygons = polygons_of(outline, opts)
  local solid, list = sections.new(), {}
  for i, at in ipairs(places) do
    -- A section lies in the plane that halves the angle of the pieces beside it (a mitre joint): along a piece of
    -- the path the outline keeps its shape.
    local own = math.min(i, #pieces)
    local along, x = pieces[own], across[own]
    local y = vectors.cross(along, x)
    local before = pieces[i - 1] or opts.closed and pieces[#pieces] or along
    local normal = vectors.add(along, before)
    local toward = vectors.dot(normal, along)
    list[i] = {}
    for _, polygon in ipairs(polygons) do
      for _, p in ipairs(polygon.points) do
        local from = {p[1] * x[1] + p[2] * y[1], p[1] * x[2] + p[2] * y[2], p[1] * x[3] + p[2] * y[3]}
        from = vectors.add(from, along, -vectors.dot(from, normal) / toward)
        list[i][#list[i] + 1] = solid:point(vectors.add(at, from))
      end
    end
  end
  return solid:through(polygons, list, opts.closed)
end

-- ---- lofted ----------------------------------------------------------------------------------------

local NEAR, SAMPLES = 1e-9, 64

-- Where the vertices of a loop lie along it, as fractions of its length from the first one on.
local function fractions_of(outline, loop)
  local list, whole = {}, 0
  for i, e in ipairs(loop.edges) do
    list[i] = whole
    whole = whole + outline:edge(e).length
  end
  for i = 1, #list do list[i] = list[i] / whole end
  return list
end

-- The place at a fraction, and the edge that it lies on.
local function place_at(outline, loop, fractions, fraction)
  fraction = fraction % 1
  if fraction > 1 - NEAR then fraction = 0 end
  local e = 1
  while fractions[e + 1] and fractions[e + 1] <= fraction + NEAR do e = e + 1 end
  local from, to = fractions[e], fractions[e + 1] or 1
  local t = math.min(math.max((fraction - from) / (to - from), 0), 1)
  return outline:at(loop.edges[e], t), loop.edges[e]
end

-- Samples of a loop about their mean.
local function samples_of(outline, loop, fractions)
  local list, mean = {}, {0, 0}
  for i = 1, SAMPLES do
    list[i] = place_at(outline, loop, fractions, (i - 1) / SAMPLES)
    for k = 1, 2 do mean[k] = mean[k] + list[i][k] / SAMPLES end
  end
  for _, p in ipairs(list) do p[1], p[2] = p[1] - mean[1], p[2] - mean[2] end
  return list
end

-- From which fraction on a loop's samples lie nearest to those of the first loop; at a vertex if one is near.
local function begin_of(first, samples, fractions)
  local best, least
  for shift = 0, SAMPLES - 1 do
    local sum = 0
    for i, p in ipairs(first) do
      local q = samples[(i - 1 + shift) % SAMPLES + 1]
      sum = sum + (p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2
    end
    if not least or sum < least * (1 - NEAR) then best, least = shift / SAMPLES, sum end
  end
  for _, at in ipairs(fractions) do
    if math.abs(at - best) < 0.75 / SAMPLES then return at end
  end
  return best
end

-- All different numbers of several ascending lists.
local function merged(lists)
  local all, made = {}, {}
  for _, list in ipairs(lists) do table.move(list, 1, #list, #all + 1, all) end
  table.sort(all)
  for _, value in ipairs(all) do
    if #made == 0 or value > made[#made] + NEAR then made[#made + 1] = value end
  end
  return made
end

-- The polygon of a loop with a point at each mark, a fraction from `start` on, and `sides[i]` sides behind mark i.
local function loop_polygon(outline, loop, fractions, start, marks, sides)
  local polygon = {points = {}, tags = {}}
  for i, mark in ipairs(marks) do
    local width = (marks[i + 1] or 1) - mark
    for k = 0, sides[i] - 1 do
      local at, edge = place_at(outline, loop, fractions, start + mark + width * k / sides[i])
      polygon.points[#polygon.points + 1] = at
      polygon.tags[#polygon.tags + 1] = outline:edge(edge).tag
    end
  end
  return profile.oriented(polygon, loop.hole)
end

-- Where the vertices lie from `start` on, ascending.
local function marks_from(fractions, start)
  local list = {}
  for i, at in ipairs(fractions) do
    list[i] = (at - start) % 1
    if list[i] > 1 - NEAR then list[i] = 0 end
  end
  table.sort(list)
  return list
end

-- The polygons of one loop of each outline, point for point alike.
local function alike(outlines, loops, opts)
  local fractions, start, marks, same, first = {}, {}, {}, true, nil
  for i, outline in ipairs(outlines) do
    fractions[i] = fractions_of(outline, loops[i])
    same = same and #fractions[i] == #fractions[1]
  end
  for i, outline in ipairs(outlines) do
    -- Edges that are as many belong together one by one.
    local samples = not same and samples_of(outline, loops[i], fractions[i])
    first = first or samples
    start[i] = same and 0 or begin_of(first, samples, fractions[i])
    marks[i] = marks_from(fractions[i], start[i])
  end
  local common, sides, list = not same and merged(marks), {}, {}
  for m = 1, #(common or marks[1]) do
    sides[m] = 1
    for i, outline in ipairs(outlines) do
      local edge = loops[i].edges[m]
      if common then
        local _, under = place_at(outline, loops[i], fractions[i], start[i] + common[m])
        edge = under
      end
      sides[m] = math.max(sides[m], profile.edge_sides(outline:edge(edge), opts.curvature, opts.tolerance))
    end
  end
  for i, outline in ipairs(outlines) do
    list[i] = loop_polygon(outline, loops[i], fractions[i], start[i], common or marks[i], sides)
  end
  return list
end

-- The polygons of all outlines.
local function all_alike(outlines, opts)
  local loops, result = {}, {}
  for i, outline in ipairs(outlines) do
    loops[i], result[i] = profile.loops(outline), {}
    if #loops[i] ~= #loops[1] then
      raise(("surface.loft: outline %d has %d loops, and outline 1 has %d: as many expected"):format(i, #loops[i],
        #loops[1]))
    end
  end
  for l = 1, #loops[1] do
    local own = {}
    for i = 1, #outlines do own[i] = loops[i][l] end
    for i, polygon in ipairs(alike(outlines, own, opts)) do result[i][l] = polygon end
  end
  return result
end

function solids.loft(outlines, given)
  local opts = options.read("surface.loft", given, with_curves {heights = {type = "table", needed = true}})
  if #outlines < 2 then raise(("surface.loft: at least two outlines expected, got %d"):format(#outlines)) end
  if #opts.heights ~= #outlines then
    raise(("surface.loft: option 'heights': a number for each of the %d outlines expected, got %d")
      :format(#outlines, #opts.heights))
  end
  for i = 1, #outlines do
    local outline = outlines[i]
    if core.class_name(outline) ~= "outline" then
      raise(("surface.loft: outline %d: an outline expected, got %s"):format(i, core.got(outline)))
    end
    local height, before = opts.heights[i], opts.heights[i - 1]
    local finite = type(height) == "number" and height == height and math.abs(height) < math.huge
    if not finite or before and height <= before then
      raise(("surface.loft: option 'heights': ascending lengths in m expected, got %s at outline %d"):format(
        core.got(height), i))
    end
  end
  local all = all_alike(outlines, opts)
  local solid, list = sections.new(), {}
  for k, polygons in ipairs(all) do
    list[k] = {}
    for _, polygon in ipairs(polygons) do
      for _, p in ipairs(polygon.points) do
        list[k][#list[k] + 1] = solid:point {p[1], p[2], opts.heights[k]}
      end
    end
  end
  local first, message, details = profile.triangles(all[1])
  if not first then return nil, message, details end
  local last
  last, message, details = profile.triangles(all[#all])
  if not last then return nil, message, details end
  solid:cap("start", list[1], first, true)
  solid:cap("end", list[#list], last, false)
  for k = 1, #list - 1 do solid:join(all[k], list[k], list[k + 1]) end
  return solid:surface()
end

local surface = core.surface
for _, name in ipairs {"extrude", "revolve", "sweep", "loft"} do surface[name] = solids[name] end
arguments.functions("surface.", surface, {extrude = "outline: outline, options: options",
  revolve = "outline: outline, options?: options", sweep = "outline: outline, options: options",
  loft = "outlines: table, options: options"})

return solids
