-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The body of a workbench: what was read from a file, its sound surface, and the faces that a person picks. A body
-- is never changed; an edit makes another one.
--
-- {surface =, labels = array of the face of each triangle, faces = list of {name, kind, area, centre, normal,
-- radius, axis, point}, log = sentences, sound = whether the surface of the file was sound}
local core = require "barwright.core"
local file_unit = require "barwright.command.file_unit"
local lengths = require "barwright.command.lengths"
local model = require "barwright.command.model"

local body = {}

-- ---- reading ---------------------------------------------------------------------------------------

local flat = {svg = true, dxf = true}

-- What a script returns: a surface, or nil and why not.
local function from_script(path)
  local file, why = io.open(path)
  if not file then return nil, why, {status = "io", file = path} end
  file:close()
  local made, message, details = model.try(dofile, path)
  if made == nil then return nil, message or path .. ": the script returns nothing", details end
  local kind = core.class_name(made)
  if kind == "mesh" then made, message, details = made:surface() end
  if made and core.class_name(made) ~= "surface" then
    return nil, path .. ": a script that returns a surface or a mesh expected; `barwright live` opens edit "
      .. "sessions and outlines", {status = "format"}
  end
  return made, message, details
end

-- How thick the body of a drawing is where nothing else is said (m): the thickness of many sheets and prints.
local THICKNESS = 3e-3

-- A drawing as a body of a thickness.
local function from_drawing(path, unit, thickness)
  local read, message, details = model.read(path, unit)
  if not read then return nil, message, details end
  thickness = thickness or THICKNESS
  local surface
  surface, message, details = model.try(core.surface.extrude, read.outline, {height = thickness, curvature = 10})
  if not surface then return nil, path .. ": " .. message, details end
  return {surface = surface, format = read.format, metres_per_unit = 1, exact_unit = true, thickness = thickness}
end

--- What a file holds: {surface = as it is in the file, format =, metres_per_unit =, by_environment = its unit
--- where the environment gave it, thickness = of the body of a drawing}, or nil, message, details.
--- `environment`: whether its unit counts where there is none else.
function body.read(path, unit, thickness, environment)
  local ending = model.ending(path)
  if ending == "lua" then
    local surface, message, details = from_script(path)
    if not surface then return nil, message, details end
    return {surface = surface, format = "Lua script", metres_per_unit = 1, exact_unit = true}
  end
  if flat[ending] then return from_drawing(path, unit, thickness) end
  local read, message, details = model.read(path, unit)
  if read and environment and not unit then read, message, details = model.in_environment(read, path) end
  if not read then return nil, message, details end
  local surface = read.surface
  if not surface then
    surface, message, details = read.mesh:surface()
    if not surface then return nil, message, details end
  end
  if surface.triangle_count == 0 then
    return nil, path .. ": the file has no triangles", {status = "empty"}
  end
  return {surface = surface, format = read.format, metres_per_unit = read.metres_per_unit or 1,
    by_environment = read.by_environment}
end

--- The lengths of the sides of a box.
function body.size(box)
  return {box.max[1] - box.min[1], box.max[2] - box.min[2], box.max[3] - box.min[3]}
end

local in_words = {each = function(unit, size) return ("in %s it is %s"):format(file_unit.words[unit], size) end,
  none = ""}

--- A sentence where the size is implausible for a part, and the units that would make it plausible; else nil.
function body.doubt(read, unit)
  local text, likely = file_unit.guess(body.size(read.surface.box), read.metres_per_unit,
    unit ~= nil or read.exact_unit, in_words)
  return text and (text:gsub("%. in ", ". In ")), likely
end

-- ---- repair ----------------------------------------------------------------------------------------

-- Kinds of defects in words, one and many.
local words = {["open edge"] = {"open edge", "open edges"},
  ["non-manifold edge"] = {"edge with more than two triangles", "edges with more than two triangles"},
  ["non-manifold point"] = {"point where the surface touches itself", "points where the surface touches itself"},
  ["misoriented edge"] = {"edge between triangles that face opposite ways",
    "edges between triangles that face opposite ways"},
  ["self-intersection"] = {"place where the surface crosses itself", "places where the surface crosses itself"},
  ["duplicate facet"] = {"triangle that is there twice", "triangles that are there twice"},
  ["zero-area facet"] = {"triangle without area", "triangles without area"},
  ["flipped shell"] = {"shell that faces inwards", "shells that face inwards"}}

local function defects(report)
  local kinds, list = {}, {}
  for kind, count in pairs(report.count) do
    if count > 0 then kinds[#kinds + 1] = kind end
  end
  table.sort(kinds)
  for i, kind in ipairs(kinds) do
    local known = words[kind] or {kind, kind .. "s"}
    list[i] = ("The file has %s."):format(model.count(report.count[kind], known[1], known[2]))
  end
  return list
end

-- A sound surface and what was done, in sentences.
local function sound(surface)
  local report, message, details = surface:check {limit = 1}
  if not report then return nil, message, details end
  if report.sound then return surface, {"The surface is closed and sound: nothing was repaired."}, true end
  local log = defects(report)
  local repaired, steps, about = model.try(surface.repair, surface)
  if not repaired then return nil, steps, about end
  for _, step in ipairs(steps.steps) do
    log[#log + 1] = ("Repaired: %s: %s."):format(step.name, (lengths(step.text):gsub("%.$", "")))
  end
  log[#log + 1] = ("The repaired surface lies %s."):format(model.moved_text(steps.moved))
  return repaired, log, false
end

-- ---- faces -----------------------------------------------------------------------------------------

--- Area, centre and mean normal of some faces, from their triangles. `wanted`: set of faces, or nil for all.
function body.measure(surface, labels, faces, wanted)
  local points, triangles, list = surface.points:totable(), surface.triangles:totable(), {}
  for i, face in ipairs(faces) do
    if wanted and not wanted[i] then
      list[i] = face
    else
      list[i] = {name = face.name, kind = face.kind, radius = face.radius, axis = face.axis, point = face.point,
        slope = face.slope, residual = face.residual, area = 0, triangle_count = 0, centre = {0, 0, 0},
        normal = {0, 0, 0}, whole = true}
    end
  end
  for t, label in ipairs(labels:totable()) do
    local face = list[label]
    if face and face.whole then
      local p = triangles[t]
      local a, b, c = points[p[1]], points[p[2]], points[p[3]]
      local u1, u2, u3 = b[1] - a[1], b[2] - a[2], b[3] - a[3]
      local v1, v2, v3 = c[1] - a[1], c[2] - a[2], c[3] - a[3]
      local n1, n2, n3 = (u2 * v3 - u3 * v2) / 2, (u3 * v1 - u1 * v3) / 2, (u1 * v2 - u2 * v1) / 2
      local area = math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
      face.area, face.triangle_count = face.area + area, face.triangle_count + 1
      local n, centre = face.normal, face.centre
      n[1], n[2], n[3] = n[1] + n1, n[2] + n2, n[3] + n3
      for k = 1, 3 do centre[k] = centre[k] + area * (a[k] + b[k] + c[k]) / 3 end
    end
  end
  for _, face in ipairs(list) do
    if face.whole then
      face.whole = nil
      local n = face.normal
      local size = math.sqrt(n[1] ^ 2 + n[2] ^ 2 + n[3] ^ 2)
      for k = 1, 3 do
        face.centre[k] = face.area > 0 and face.centre[k] / face.area or 0
        n[k] = size > 1e-9 * face.area and n[k] / size or 0
      end
      if face.kind == "plane" then face.point, face.axis = face.centre, n end
    end
  end
  return list
end

--- The body with other points of the same triangles. `moved`: set of the faces that changed; `radius`: of the
--- faces whose radius changed.
function body.moved(self, surface, moved, radius)
  local faces = body.measure(surface, self.labels, self.faces, moved)
  for i, value in pairs(radius or {}) do faces[i].radius = value end
  return {surface = surface, labels = self.labels, faces = faces, log = self.log, sound = self.sound}
end

--- What the k-th edge of a triangle, a list of points, is named by.
function body.edge_key(triangle, k)
  local a, b = triangle[k], triangle[k % 3 + 1]
  if a > b then a, b = b, a end
  return a * 4294967296 + b
end

--- The triangles at each edge by its name, of those that are wanted, a function of their number; or of all.
function body.at_edges(triangles, wanted)
  local at = {}
  for t, triangle in ipairs(triangles) do
    if not wanted or wanted(t) then
      for k = 1, 3 do
        local key = body.edge_key(triangle, k)
        at[key] = at[key] or {}
        table.insert(at[key], t)
      end
    end
  end
  return at
end

-- Labels of all triangles: those without one take that of a neighbour.
local function spread(surface, labels)
  local triangles, list = surface.triangles:totable(), labels:totable()
  local at_edge = body.at_edges(triangles)
  local queue = {}
  for t, label in ipairs(list) do
    if label > 0 then queue[#queue + 1] = t end
  end
  for _, t in ipairs(queue) do
    for k = 1, 3 do
      for _, other in ipairs(at_edge[body.edge_key(triangles[t], k)]) do
        if list[other] == 0 then
          list[other] = list[t]
          queue[#queue + 1] = other -- which ipairs goes on to
        end
      end
    end
  end
  return core.array.new(list, "i32")
end

-- A part is sculpted where its largest face is free form and has so much of the area. What is found there on few
-- triangles and little area by chance is no face that a person would pick.
local SCULPTED, SPECK, FEW = 0.3, 2e-3, 12

-- The faces without specks, whose triangles take the faces around them.
local function without_specks(self)
  local total, largest = 0, self.faces[1]
  for _, face in ipairs(self.faces) do
    total = total + face.area
    if face.area > largest.area then largest = face end
  end
  if not largest or largest.kind ~= "free form" or largest.area < SCULPTED * total then return self end
  local number, kept = {}, {}
  for i, face in ipairs(self.faces) do
    number[i] = 0
    if face.area >= SPECK * total or face.triangle_count > FEW then
      kept[#kept + 1] = face
      number[i] = #kept
    end
  end
  if #kept == #self.faces then return self end
  local labels = self.labels:totable()
  for t, label in ipairs(labels) do labels[t] = number[label] or 0 end
  local all = spread(self.surface, core.array.new(labels, "i32"))
  for _, label in ipairs(all:totable()) do
    if label == 0 then return self end -- a shell of specks alone
  end
  self.labels = all
  self.faces = body.measure(self.surface, self.labels, kept)
  return self
end

local function with_faces(self)
  local faces, labels, details = model.try(self.surface.faces, self.surface)
  if not faces then return nil, labels, details end
  self.faces, self.labels = faces, labels
  return without_specks(self)
end

--- The body of a surface that was read: repaired where it must be, with its faces. nil, message, details where it
--- cannot be repaired.
function body.new(surface)
  local repaired, log, is_sound = sound(surface)
  if not repaired then return nil, log, is_sound end
  return with_faces {surface = repaired, log = log, sound = is_sound}
end

--- The body with another surface, whose triangles take the faces of those that they lie on.
function body.replaced(self, surface)
  local labels, message, details = core.face_labels(self.surface, self.labels, surface)
  if not labels then return nil, message, details end
  labels = spread(surface, labels)
  return {surface = surface, labels = labels, faces = body.measure(surface, labels, self.faces), log = self.log,
    sound = self.sound}
end

-- ---- meshes ----------------------------------------------------------------------------------------

--- A mesh of about so many elements, with `labels` of its facets (0: none); or nil, message, details.
function body.mesh(self, elements, order)
  local mesh, log, details = model.try(core.mesh.fill, self.surface, {elements = elements, order = order or 2})
  if not mesh then return nil, log, details end
  local labels, message
  labels, message, details = core.face_labels(self.surface, self.labels, mesh)
  if not labels then return nil, message, details end
  return mesh, labels
end

-- The facet of a mesh whose middle is nearest to a point.
local function nearest_facet(mesh, at)
  local nodes, best, min = mesh.nodes:totable(), 1, math.huge
  for i, facet in ipairs(mesh.facets:totable()) do
    local square = 0
    for k = 1, 3 do
      square = square + ((nodes[facet[1]][k] + nodes[facet[2]][k] + nodes[facet[3]][k]) / 3 - at[k]) ^ 2
    end
    if square < min then best, min = i, square end
  end
  return best
end

--- The selection on the boundary of a mesh of some faces. A face without a facet of its own, smaller than the
--- elements, takes the facet nearest to its centre.
function body.select(self, mesh, labels, faces)
  local wanted, found, mask = {}, {}, {}
  for _, face in ipairs(faces) do wanted[face] = true end
  for i, label in ipairs(labels:totable()) do
    mask[i] = wanted[label] and 1 or 0
    if wanted[label] then found[label] = true end
  end
  for _, face in ipairs(faces) do
    if not found[face] then mask[nearest_facet(mesh, self.faces[face].centre)] = 1 end
  end
  return mesh.boundary:where(core.array.new(mask))
end

return body
