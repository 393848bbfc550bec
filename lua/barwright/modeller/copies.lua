-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Mirrored surfaces, rows and rings of copies, and what of a mesh lies on a face of a surface.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local vectors = require "barwright.modeller.vectors"

local raise = core.raise
local surface = core.classes.surface.methods

--- The mirror image of a surface at a plane.
function surface:mirror(normal, point)
  local size = vectors.norm(normal)
  if size == 0 then raise "mirror: normal: a vector other than 0 expected" end
  local n = vectors.unit(normal)
  local shift = 2 * vectors.dot(n, point or {0, 0, 0})
  local rows = {}
  for i = 1, 3 do
    rows[i] = {}
    for j = 1, 3 do rows[i][j] = (i == j and 1 or 0) - 2 * n[i] * n[j] end
    rows[i][4] = shift * n[i]
  end
  return self:transform(rows)
end

local function apart(a, b)
  for k = 1, 3 do
    if a.max[k] < b.min[k] or b.max[k] < a.min[k] then return true end
  end
  return false
end

-- Several surfaces as one, side by side.
local function beside(list)
  local points, triangles, groups, names, number, curved = {}, {}, {}, {}, {}, {}
  for _, part in ipairs(list) do
    for _, name in ipairs(part:curved_faces()) do curved[name] = true end
    local first, own, old = #points, part:face_names(), part.groups
    for _, p in ipairs(part.points:totable()) do points[#points + 1] = p end
    for t, corners in ipairs(part.triangles:totable()) do
      triangles[#triangles + 1] = {corners[1] + first, corners[2] + first, corners[3] + first}
      local name = old and own[old[t]] or ""
      if not number[name] then
        names[#names + 1] = name
        number[name] = #names
      end
      groups[#groups + 1] = number[name]
    end
  end
  local round = {}
  for _, name in ipairs(names) do round[#round + 1] = curved[name] and name or nil end
  return core.surface.new {points = points, triangles = triangles, groups = groups, face_names = names,
    curved_faces = round}
end

-- The union of copies: by booleans where their boxes meet, else side by side.
local function joined(list)
  local bodies = {}
  for _, copy in ipairs(list) do
    local meets = {}
    for i = #bodies, 1, -1 do
      if not apart(bodies[i].box, copy.box) then meets[#meets + 1] = table.remove(bodies, i) end
    end
    for _, body in ipairs(meets) do
      local both, message, details = copy:union(body)
      if not both then return nil, message, details end
      copy = both
    end
    bodies[#bodies + 1] = copy
  end
  return #bodies == 1 and bodies[1] or beside(bodies)
end

local copies = {type = "integer", min = 1, max = 100000}

local function count_of(where, opts)
  if not opts.count then raise(where .. ": option 'count': a number of copies expected, got nil") end
  return opts.count
end

--- Copies in a row.
function surface:linear_array(given)
  local where = "linear_array"
  local opts = options.read(where, given, {count = copies, step = {type = "table"}})
  local count, step = count_of(where, opts), vectors.check(where, "step", opts.step)
  local list = {}
  for i = 1, count do list[i] = self:translate {(i - 1) * step[1], (i - 1) * step[2], (i - 1) * step[3]} end
  return joined(list)
end

--- Copies in a ring about an axis.
function surface:polar_array(given)
  local where = "polar_array"
  local opts = options.read(where, given, {count = copies, axis = {type = "table"}, centre = {type = "table"},
    angle = {type = "number"}})
  local count = count_of(where, opts)
  local axis = vectors.check(where, "axis", opts.axis or {0, 0, 1})
  local centre = vectors.check(where, "centre", opts.centre or {0, 0, 0})
  local list = {}
  for i = 1, count do list[i] = self:rotate(axis, (opts.angle or 2 * math.pi / count) * (i - 1), centre) end
  return joined(list)
end

--- The part of a mesh's boundary that lies on the triangles of a name.
function surface:face_on(mesh, name)
  local names, wanted = self:face_names(), {}
  for i, known in ipairs(names) do wanted[i] = known ~= "" and known == name or nil end
  if not next(wanted) then
    raise(("face_on: no face has the name '%s': %s"):format(name, core.suggestion(name, names)))
  end
  local groups, mask = self:groups_on(mesh), {}
  for t = 1, #groups do mask[t] = wanted[groups[t]] and 1 or 0 end
  return mesh.boundary:where(core.array(mask))
end

arguments.methods("surface", surface, nil, {mirror = "normal: triple, point?: triple",
  linear_array = "options: options", polar_array = "options: options", face_on = "mesh: mesh, name: string"})
