-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bumps: smooth outward displacements of a surface around places, for advice and strengthening. A place is {at =
-- {x, y, z}, radius =, offset =}, m. A shape is {points = {{x, y, z}...}, triangles = {{a, b, c}...}}, and of a
-- surface that has groups also groups = {g...} of triangles and face_names = {name...} of groups.
-- docs/theory/strengthen.md says why they look like this.
local core = require "barwright.core"
local face_names = require "barwright.face_names"
local distance = require("barwright.points").distance

local bumps = {}

-- Full offset up to this fraction of the radius, then a smooth decay to zero.
local FLAT = 0.4
-- Normals diffuse over this fraction of the radius. Where less than MIN of their length is left, as in the middle
-- of a thin rib, the displacement is less as well.
local SMOOTHED, MIN = 0.3, 0.5
-- Over that length: the size of the groups of points that have a direction, and the distance over which points
-- blend those of groups. Of the conjugate gradients for them.
local GATHERED, BLENDED = 0.33, 0.8
local ITERATIONS, PRECISION = 100, 1e-4
-- A part of the surface within the radius that is not connected to the place moves where its normal points
-- away from the place at least so much: the other side of a wall, but not the other side of a gap.
local AWAY = 0.3
-- Towards points that are kept a bump falls to zero over this fraction of the radius. So a bump of at most a
-- quarter of the radius does not reach beyond a kept plane.
local KEPT = 0.5
-- Edges longer than a fraction of the radius are bisected near a place; the first fraction that adds no more
-- points than MAX_ADDED is taken. Rounds at most.
local EDGES, ROUNDS = {1 / 7, 1 / 5, 1 / 3.5}, 40
-- The work of a step grows with the points of the surface.
local MAX_ADDED = 30000

local sqrt = math.sqrt

--- The shape of a surface.
function bumps.of_surface(surface)
  local groups, names = face_names.of(surface)
  return {points = surface.points:totable(), triangles = surface.triangles:totable(),
    groups = groups and groups:totable(), face_names = names}
end

--- The surface of a shape.
function bumps.to_surface(shape)
  return core.surface.new {points = core.array.new(shape.points),
    triangles = core.array.new(shape.triangles, "i32"),
    groups = shape.groups and core.array.new(shape.groups, "i32"), face_names = shape.face_names}
end

--- The surface with coordinates that single precision in a unit (m) holds exactly, as binary STL has them: else a
--- sound surface may cross itself in the file.
function bumps.rounded(surface, unit)
  local rows = surface.points:totable()
  for _, p in ipairs(rows) do
    for c = 1, 3 do p[c] = string.unpack("<f", string.pack("<f", p[c] / unit)) * unit end
  end
  return face_names.moved(surface, core.array.new(rows))
end

--- The shape of a mesh's boundary, mid-edge nodes among its points; `nodes` has the mesh node of each point.
function bumps.of_mesh(mesh)
  local shape, index = {points = {}, triangles = {}, nodes = {}}, {}
  local nodes, facets = mesh.nodes, mesh.facets:totable()
  local function point(node)
    if not index[node] then
      index[node] = #shape.points + 1
      shape.points[index[node]] = {nodes(node, 1), nodes(node, 2), nodes(node, 3)}
      shape.nodes[index[node]] = node
    end
    return index[node]
  end
  local inner = {{1, 4, 6}, {4, 2, 5}, {6, 5, 3}, {5, 6, 4}}
  for _, facet in ipairs(facets) do
    local p = {}
    for k, node in ipairs(facet) do p[k] = point(node) end
    if #p == 3 then
      table.insert(shape.triangles, p)
    else
      for _, t in ipairs(inner) do table.insert(shape.triangles, {p[t[1]], p[t[2]], p[t[3]]}) end
    end
  end
  return shape
end

local function area_vector(points, triangle)
  local a, b, c = points[triangle[1]], points[triangle[2]], points[triangle[3]]
  local ux, uy, uz = b[1] - a[1], b[2] - a[2], b[3] - a[3]
  local vx, vy, vz = c[1] - a[1], c[2] - a[2], c[3] - a[3]
  return (uy * vz - uz * vy) / 2, (uz * vx - ux * vz) / 2, (ux * vy - uy * vx) / 2
end

-- Area vectors and areas of points: thirds of the triangles around. Made once for a shape.
local function measure(shape)
  if shape.normals then return end
  local normals, areas, around = {}, {}, {}
  for i = 1, #shape.points do normals[i], areas[i], around[i] = {0, 0, 0}, 0, {} end
  for t, triangle in ipairs(shape.triangles) do
    local x, y, z = area_vector(shape.points, triangle)
    local size = sqrt(x * x + y * y + z * z)
    for _, i in ipairs(triangle) do
      local n = normals[i]
      n[1], n[2], n[3] = n[1] + x / 3, n[2] + y / 3, n[3] + z / 3
      areas[i] = areas[i] + size / 3
      table.insert(around[i], t)
    end
  end
  for i, n in ipairs(normals) do
    local size = sqrt(n[1] ^ 2 + n[2] ^ 2 + n[3] ^ 2)
    if size > 0 then n[1], n[2], n[3] = n[1] / size, n[2] / size, n[3] / size else normals[i] = {0, 0, 0} end
  end
  shape.normals, shape.areas, shape.around = normals, areas, around
end

-- The points within a distance of a place, and the nearest one.
local function within(shape, at, radius)
  local list, nearest, min = {}, nil, math.huge
  for i, p in ipairs(shape.points) do
    local d = distance(p, at)
    if d < radius then list[#list + 1] = i end
    if d < min then nearest, min = i, d end
  end
  return list, nearest
end

-- Of the points in `inside` (a set) those that triangles connect with the first one, within the set.
local function connected(shape, first, inside)
  local reached, queue, k = {[first] = true}, {first}, 1
  while queue[k] do
    for _, t in ipairs(shape.around[queue[k]]) do
      for _, i in ipairs(shape.triangles[t]) do
        if inside[i] and not reached[i] then
          reached[i] = true
          queue[#queue + 1] = i
        end
      end
    end
    k = k + 1
  end
  return reached
end

-- Groups of the points of a list that triangles connect within a length of one of them: {at, area, normal, links}
-- of each, and the group of each point. The diffusion between groups does not depend on the shapes of the facets:
-- needle facets would hardly conduct across.
local function gathered(shape, list, length)
  local group_of, inside, groups = {}, {}, {}
  for _, i in ipairs(list) do inside[i] = true end
  for _, first in ipairs(list) do
    if not group_of[first] then
      local group, queue, k = {at = {0, 0, 0}, area = 0, normal = {0, 0, 0}, links = {}}, {first}, 1
      groups[#groups + 1] = group
      group_of[first] = #groups
      while queue[k] do
        for _, t in ipairs(shape.around[queue[k]]) do
          for _, j in ipairs(shape.triangles[t]) do
            if inside[j] and not group_of[j] and distance(shape.points[j], shape.points[first]) < length then
              group_of[j] = #groups
              queue[#queue + 1] = j
            end
          end
        end
        k = k + 1
      end
      for _, i in ipairs(queue) do
        local p, n, area = shape.points[i], shape.normals[i], math.max(shape.areas[i], 1e-300)
        group.area = group.area + area
        for c = 1, 3 do
          group.at[c], group.normal[c] = group.at[c] + area * p[c], group.normal[c] + area * n[c]
        end
      end
      for c = 1, 3 do group.at[c], group.normal[c] = group.at[c] / group.area, group.normal[c] / group.area end
    end
  end
  local linked = {}
  for _, i in ipairs(list) do
    for _, t in ipairs(shape.around[i]) do
      for _, j in ipairs(shape.triangles[t]) do
        local g, h = group_of[i], group_of[j]
        local key = h and g < h and g * 4294967296 + h
        if key and not linked[key] then
          linked[key] = true
          table.insert(groups[g].links, h)
          table.insert(groups[h].links, g)
        end
      end
    end
  end
  return groups, group_of
end

-- Solves (M + l^2 L) x = M n for a component of the groups' normals by conjugate gradients with the diagonal as
-- preconditioner. M: areas; L: conductances between groups, those of a lattice of triangles with such areas.
local function diffuse(groups, length, c)
  local count, weights, diagonal, x, r, z, p, q = #groups, {}, {}, {}, {}, {}, {}, {}
  for g, one in ipairs(groups) do
    weights[g], diagonal[g], x[g] = {}, one.area, one.normal[c]
    for k, h in ipairs(one.links) do
      local other = groups[h]
      weights[g][k] = length ^ 2 * (one.area + other.area) / 3
        / math.max(distance(one.at, other.at), GATHERED / 2 * length) ^ 2
      diagonal[g] = diagonal[g] + weights[g][k]
    end
  end
  local function multiply(v, out)
    for g, one in ipairs(groups) do
      local sum, own = one.area * v[g], v[g]
      for k, h in ipairs(one.links) do sum = sum + weights[g][k] * (own - v[h]) end
      out[g] = sum
    end
  end
  local function dot(u, v)
    local sum = 0
    for g = 1, count do sum = sum + u[g] * v[g] end
    return sum
  end
  multiply(x, q)
  for g, one in ipairs(groups) do
    r[g] = one.area * one.normal[c] - q[g]
    z[g] = r[g] / diagonal[g]
    p[g] = z[g]
  end
  local rho = dot(r, z)
  local first = rho
  for _ = 1, ITERATIONS do
    if rho <= PRECISION ^ 2 * first then break end
    multiply(p, q)
    local alpha = rho / dot(p, q)
    for g = 1, count do
      x[g], r[g] = x[g] + alpha * p[g], r[g] - alpha * q[g]
      z[g] = r[g] / diagonal[g]
    end
    local former = rho
    rho = dot(r, z)
    for g = 1, count do p[g] = z[g] + rho / former * p[g] end
  end
  return x
end

-- Values of groups at a point of one of them: their mean over the groups that links connect within a distance,
-- those nearby counting more.
local function interpolated(groups, first, at, length, values)
  local x, y, z, all, seen, queue, k = 0, 0, 0, 0, {[first] = true}, {first}, 1
  while queue[k] do
    local g = queue[k]
    local far = distance(groups[g].at, at) / length
    local weight = (1 - math.min(far, 0.99) ^ 2) ^ 2
    x, y, z = x + weight * values[1][g], y + weight * values[2][g], z + weight * values[3][g]
    all = all + weight
    for _, h in ipairs(groups[g].links) do
      if not seen[h] and distance(groups[h].at, at) < length then
        seen[h] = true
        queue[#queue + 1] = h
      end
    end
    k = k + 1
  end
  return x / all, y / all, z / all
end

-- Normals and directions around places. Directions are normals that diffuse along the surface
-- over a fraction of the radius: the two sides of a wall do not mix, and a crumb of tiny facets takes the
-- direction of what is around it.
local function prepare(shape, places)
  measure(shape)
  local taken, list, length = {}, {}, 0
  for _, place in ipairs(places) do
    length = length + place.radius / #places
    for _, i in ipairs((within(shape, place.at, (1 + 2 * SMOOTHED) * place.radius))) do
      if not taken[i] then
        taken[i] = true
        list[#list + 1] = i
      end
    end
  end
  table.sort(list)
  length = SMOOTHED * length
  local groups, group_of = gathered(shape, list, GATHERED * length)
  local values = {}
  for c = 1, 3 do values[c] = diffuse(groups, length, c) end
  shape.directions = {}
  for _, i in ipairs(list) do
    local x, y, z = interpolated(groups, group_of[i], shape.points[i], BLENDED * length, values)
    local size = math.max(sqrt(x * x + y * y + z * z), MIN)
    shape.directions[i] = {x / size, y / size, z / size}
  end
end

-- 1 up to FLAT of the radius, then a smooth decay to 0.
local function height(fraction)
  if fraction <= FLAT then return 1 end
  local t = (1 - fraction) / (1 - FLAT)
  return t * t * (3 - 2 * t)
end

-- A function that falls to zero at the border of the kept points among those of a list, within a length.
local function kept_fraction(shape, list, keep, length)
  local border, is_kept = {}, {}
  for _, i in ipairs(keep and list or {}) do
    local p = shape.points[i]
    is_kept[i] = keep(p[1], p[2], p[3]) and true or false
  end
  for _, i in ipairs(list) do
    local at_border = false
    for _, t in ipairs(is_kept[i] and shape.around[i] or {}) do
      for _, j in ipairs(shape.triangles[t]) do at_border = at_border or is_kept[j] == false end
    end
    if at_border then border[#border + 1] = shape.points[i] end
  end
  return function(i)
    if is_kept[i] then return 0 end
    local min = length
    for _, p in ipairs(border) do min = math.min(min, distance(p, shape.points[i])) end
    return min / length
  end
end

-- The height of a place's bump at the points of a shape that it moves, and its fraction left beside kept points.
local function heights(shape, place, keep)
  local list, nearest = within(shape, place.at, place.radius)
  local inside, height_at, kept_at = {}, {}, {}
  for _, i in ipairs(list) do inside[i] = true end
  local reached = connected(shape, nearest, inside)
  local fraction = kept_fraction(shape, list, keep, KEPT * place.radius)
  for _, i in ipairs(list) do
    local p, n = shape.points[i], shape.directions[i]
    local x, y, z = p[1] - place.at[1], p[2] - place.at[2], p[3] - place.at[3]
    local far = sqrt(x * x + y * y + z * z)
    local away = x * n[1] + y * n[2] + z * n[3] > AWAY * far
    if reached[i] or away then height_at[i], kept_at[i] = height(far / place.radius), fraction(i) end
  end
  return height_at, kept_at
end

--- The bumps of places on a shape: for each {[point] = {x, y, z}}, displacement over offset. `keep(x, y, z)` is
--- true where nothing moves. A bump by itself has its own height. Where heights h overlap, each is scaled so that
--- they add up to 1 - (1 - h1) (1 - h2) ..., hence to one at most: no point moves by more than the largest offset
--- of the bumps there, and the displacement is linear in the offsets.
function bumps.units(shape, places, keep)
  prepare(shape, places)
  local lists, kept, sums, rests = {}, {}, {}, {}
  for j, place in ipairs(places) do
    lists[j], kept[j] = heights(shape, place, keep)
    for i, h in pairs(lists[j]) do sums[i], rests[i] = (sums[i] or 0) + h, (rests[i] or 1) * (1 - h) end
  end
  for j, list in ipairs(lists) do
    local unit = {}
    for i, h in pairs(list) do
      local n, size = shape.directions[i], sums[i] > 0 and kept[j][i] * h * (1 - rests[i]) / sums[i] or 0
      unit[i] = {size * n[1], size * n[2], size * n[3]}
    end
    lists[j] = unit
  end
  return lists
end

-- ---- subdivision --------------------------------------------------------------------------------------

-- The distance of a point from a segment.
local function to_segment(p, a, b)
  local dx, dy, dz = b[1] - a[1], b[2] - a[2], b[3] - a[3]
  local square = dx * dx + dy * dy + dz * dz
  local t = square > 0 and ((p[1] - a[1]) * dx + (p[2] - a[2]) * dy + (p[3] - a[3]) * dz) / square or 0
  t = math.max(0, math.min(1, t))
  return sqrt((p[1] - a[1] - t * dx) ^ 2 + (p[2] - a[2] - t * dy) ^ 2 + (p[3] - a[3] - t * dz) ^ 2)
end

local function too_long(a, b, places, fraction)
  local length = distance(a, b)
  for _, place in ipairs(places) do
    if length > fraction * place.radius and to_segment(place.at, a, b) < place.radius then return true end
  end
  return false
end

-- The triangles that one becomes, m the midpoints of its edges 12, 23, 31, or false.
local function pieces(points, t, m)
  local count = (m[1] and 1 or 0) + (m[2] and 1 or 0) + (m[3] and 1 or 0)
  if count == 0 then return {t} end
  if count == 3 then
    return {{t[1], m[1], m[3]}, {m[1], t[2], m[2]}, {m[3], m[2], t[3]}, {m[1], m[2], m[3]}}
  end
  -- Turn it so that edge 12 is cut, and with two cuts edge 31 is not.
  while not m[1] or (count == 2 and m[3]) do t, m = {t[2], t[3], t[1]}, {m[2], m[3], m[1]} end
  if count == 1 then return {{t[1], m[1], t[3]}, {m[1], t[2], t[3]}} end
  local out = {{m[1], t[2], m[2]}}
  if distance(points[t[1]], points[m[2]]) <= distance(points[m[1]], points[t[3]]) then
    table.move({{t[1], m[1], m[2]}, {t[1], m[2], t[3]}}, 1, 2, 2, out)
  else
    table.move({{t[1], m[1], t[3]}, {m[1], m[2], t[3]}}, 1, 2, 2, out)
  end
  return out
end

-- The shape with edges near places cut until they are at most a fraction of the radius long; nil beyond MAX_ADDED.
local function cut_to(shape, places, fraction)
  local points, triangles = table.move(shape.points, 1, #shape.points, 1, {}), shape.triangles
  local groups = shape.groups
  for _ = 1, ROUNDS do
    local centroids, known, cut, changed, of_cut = {}, {}, {}, false, groups and {}
    local function mid_edge(a, b)
      if a > b then a, b = b, a end
      local key = a * 4294967296 + b
      if known[key] == nil then
        known[key] = too_long(points[a], points[b], places, fraction)
        if known[key] then
          local p, q = points[a], points[b]
          points[#points + 1] = {(p[1] + q[1]) / 2, (p[2] + q[2]) / 2, (p[3] + q[3]) / 2}
          centroids[key] = #points
        end
      end
      return centroids[key] or false
    end
    for i, t in ipairs(triangles) do
      local m = {mid_edge(t[1], t[2]), mid_edge(t[2], t[3]), mid_edge(t[3], t[1])}
      if m[1] or m[2] or m[3] then changed = true end
      for _, piece in ipairs(pieces(points, t, m)) do
        cut[#cut + 1] = piece
        if groups then of_cut[#cut] = groups[i] end
      end
    end
    triangles, groups = cut, of_cut
    if not changed then break end
    if #points > #shape.points + MAX_ADDED then return nil end
  end
  return {points = points, triangles = triangles, groups = groups, face_names = shape.face_names}
end

--- Bisects edges near places until they are short enough for bumps: the same surface with more triangles.
--- Returns nil and a message where it would take too many points.
function bumps.subdivide(shape, places)
  for _, fraction in ipairs(EDGES) do
    local cut = cut_to(shape, places, fraction)
    if cut then return cut end
  end
  return nil, ("the surface would need more than %d new points around the weak places"):format(MAX_ADDED)
end

--- The shape displaced by the bumps of places, `units`, times their offsets and shares (1 where none is given).
function bumps.displaced(shape, places, units)
  local moved = {}
  for i, p in ipairs(shape.points) do moved[i] = {p[1], p[2], p[3]} end
  for j, place in ipairs(places) do
    local size = (place.fraction or 1) * place.offset
    for i, d in pairs(units[j]) do
      local p = moved[i]
      p[1], p[2], p[3] = p[1] + size * d[1], p[2] + size * d[2], p[3] + size * d[3]
    end
  end
  return {points = moved, triangles = shape.triangles, groups = shape.groups, face_names = shape.face_names}
end

return bumps
