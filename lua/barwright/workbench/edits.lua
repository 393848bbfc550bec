-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edits of a body's own surface: faces are moved along their normals, holes get another radius. Triangles stay;
-- points of the faces that move go along, and neighbouring faces follow within themselves where they can. An edit
-- moves points in proportion to its length.
--
-- {before, after = where the points are, lists, triangles = list, moved = set of the faces that change, radius =
-- {[face] = radius} of those whose radius changes, what = words for a refusal}
local core = require "barwright.core"
local body = require "barwright.workbench.body"
local face_names = require "barwright.face_names"

local edits = {}

local sqrt = math.sqrt

-- A neighbour whose normal leaves the span of those before by less than this sine follows.
local TANGENT = 0.3

-- The normal of each face at each point that it has among `wanted` points: {[point] = {[face] = {x, y, z}}}.
local function normals_at(self, triangles, points, labels, wanted)
  local at = {}
  for t, p in ipairs(triangles) do
    if wanted[p[1]] or wanted[p[2]] or wanted[p[3]] then
      local a, b, c, face = points[p[1]], points[p[2]], points[p[3]], labels[t]
      local plane = self.faces[face].kind == "plane" and self.faces[face].normal
      local u1, u2, u3 = b[1] - a[1], b[2] - a[2], b[3] - a[3]
      local v1, v2, v3 = c[1] - a[1], c[2] - a[2], c[3] - a[3]
      local x, y, z = u2 * v3 - u3 * v2, u3 * v1 - u1 * v3, u1 * v2 - u2 * v1
      for k = 1, 3 do
        local i = p[k]
        if wanted[i] then
          at[i] = at[i] or {}
          local n = at[i][face]
          if plane then
            at[i][face] = plane
          elseif n then
            n[1], n[2], n[3] = n[1] + x, n[2] + y, n[3] + z
          else
            at[i][face] = {x, y, z}
          end
        end
      end
    end
  end
  return at
end

-- The displacement of a point whose faces have normals and distances: those that are pushed first, then the
-- others, which keep the point on themselves. Faces nearly in the span of those before follow.
local function displacement(normals, pushed)
  local order = {}
  for face in pairs(normals) do order[#order + 1] = face end
  table.sort(order, function(a, b)
    local first, second = pushed[a] ~= nil, pushed[b] ~= nil
    if first ~= second then return first end
    return a < b
  end)
  local base, along, u = {}, {}, {0, 0, 0}
  for _, face in ipairs(order) do
    local n = normals[face]
    local size = sqrt(n[1] ^ 2 + n[2] ^ 2 + n[3] ^ 2)
    if size > 0 and #base < 3 then
      local r, reached = {n[1] / size, n[2] / size, n[3] / size}, 0
      for i, e in ipairs(base) do
        local part = (n[1] * e[1] + n[2] * e[2] + n[3] * e[3]) / size
        reached = reached + part * along[i]
        for k = 1, 3 do r[k] = r[k] - part * e[k] end
      end
      local rest = sqrt(r[1] ^ 2 + r[2] ^ 2 + r[3] ^ 2)
      if rest > TANGENT then
        local e = {r[1] / rest, r[2] / rest, r[3] / rest}
        base[#base + 1], along[#base + 1] = e, ((pushed[face] or 0) - reached) / rest
      end
    end
  end
  for i, e in ipairs(base) do
    for k = 1, 3 do u[k] = u[k] + along[i] * e[k] end
  end
  return u
end

--- The body that an edit makes where its surface stays sound; else nil and a sentence.
function edits.made(self, edit)
  local surface, message, details = face_names.moved(self.surface, core.array.new(edit.after))
  if not surface then return nil, message, details end
  local report
  report, message, details = surface:check {limit = 1}
  if not report then return nil, message, details end
  if not report.sound then
    local where = report.defects[1] and " at " .. core.point(report.defects[1].at) or ""
    return nil, ("%s is too far: the surface would cross itself%s. Take a smaller distance."):format(edit.what,
      where), {status = "geometry"}
  end
  return body.moved(self, surface, edit.moved, edit.radius)
end

-- The set of faces that share a point with some.
local function touched(triangles, labels, wanted)
  local set = {}
  for t, p in ipairs(triangles) do
    if wanted[p[1]] or wanted[p[2]] or wanted[p[3]] then set[labels[t]] = true end
  end
  return set
end

local function points_of(triangles, labels, faces)
  local wanted = {}
  for t, p in ipairs(triangles) do
    if faces[labels[t]] then
      for k = 1, 3 do wanted[p[k]] = true end
    end
  end
  return wanted
end

--- The edit that moves faces outwards by distances (m), {[face] = distance}; faces of `locked` (a set) stay where
--- they are.
function edits.push(self, distances, locked, what)
  local triangles, labels, points = self.surface.triangles:totable(), self.labels:totable(),
    self.surface.points:totable()
  local wanted = points_of(triangles, labels, distances)
  local at, pushed = normals_at(self, triangles, points, labels, wanted), {}
  for face in pairs(locked) do pushed[face] = 0 end
  for face, distance in pairs(distances) do pushed[face] = distance end
  local after = {}
  for i, p in ipairs(points) do
    if wanted[i] then
      local u = displacement(at[i], pushed)
      after[i] = {p[1] + u[1], p[2] + u[2], p[3] + u[3]}
    else
      after[i] = p
    end
  end
  return {before = points, after = after, triangles = triangles, moved = touched(triangles, labels, wanted),
    what = what}
end

--- The edit that gives round faces, a list, another radius (m): points move away from the axes in proportion.
function edits.radius(self, faces, radius)
  local triangles, labels, points = self.surface.triangles:totable(), self.labels:totable(),
    self.surface.points:totable()
  local after, every, radii = table.move(points, 1, #points, 1, {}), {}, {}
  for _, face in ipairs(faces) do
    local about = self.faces[face]
    local factor, c, n = radius / about.radius, about.point, about.axis
    radii[face] = radius
    for i in pairs(points_of(triangles, labels, {[face] = true})) do
      local p, q = after[i], {}
      local d = {p[1] - c[1], p[2] - c[2], p[3] - c[3]}
      local along = n and d[1] * n[1] + d[2] * n[2] + d[3] * n[3] or 0
      for k = 1, 3 do
        local foot = c[k] + along * (n and n[k] or 0)
        q[k] = foot + factor * (p[k] - foot)
      end
      after[i], every[i] = q, true
    end
  end
  return {before = points, after = after, triangles = triangles, moved = touched(triangles, labels, every),
    radius = radii, what = "This radius"}
end

return edits
