-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Actions of a workbench about what constrains and loads the part, its material and its faces: they are put into
-- its class.
local core = require "barwright.core"
local model = require "barwright.command.model"
local mirror = require "barwright.workbench.mirror"
local options = require "barwright.options"
local patches = require "barwright.workbench.patches"
local session = require "barwright.workbench.session"

local raise = core.raise
local now, refuse, act = session.now, session.refuse, session.act
local read_faces, vector = session.read_faces, session.vector

local workbench = {}

local function with_condition(self, name, given, condition)
  local list = table.move(now(self).conditions, 1, #now(self).conditions, 1, {})
  list[#list + 1] = condition
  return act(self, name, given, {conditions = list})
end

-- A sentence where a load would act on a face that is fixed, or the other way round.
local function clash(self, condition, but)
  local part = now(self).body
  for i, other in ipairs(now(self).conditions) do
    local one_fixes = condition.kind == "all" ~= (other.kind == "all")
    local load = condition.kind == "all" and other or condition
    if i ~= but and one_fixes and load.kind ~= "normal" and load.kind ~= "gravity" then
      for _, a in ipairs(condition.faces or {}) do
        for _, b in ipairs(other.faces or {}) do
          if a == b then
            return ("%s is fixed and cannot be loaded: a load on a support does nothing. Choose another face, or "
              .. "press Remove beside the support."):format(part.faces[a].name)
          end
        end
      end
    end
  end
end

local function add(self, name, given, condition)
  local why = clash(self, condition)
  if why then return refuse(why) end
  return with_condition(self, name, given, condition)
end

local fix_rules = {faces = {type = "table", needed = true},
  kind = {type = "string", default = "all", one_of = {"all", "normal"}}}

--- Constrains faces: all directions, or only along their normals.
function workbench:fix(given)
  local opts = options.read("fix", given, fix_rules)
  local faces, message, details = read_faces(self, "fix", opts.faces)
  if not faces then return nil, message, details end
  return add(self, "fix", {faces = faces, kind = opts.kind}, {kind = opts.kind, faces = faces})
end

-- A load with a vector on faces.
local function vector_load(name, key)
  local rules = {faces = {type = "table", needed = true}, [key] = {type = "table", needed = true}}
  return function(self, given)
    local opts = options.read(name, given, rules)
    local faces, message, details = read_faces(self, name, opts.faces)
    if not faces then return nil, message, details end
    local value
    value, message, details = vector(name, key, opts[key])
    if not value then return nil, message, details end
    return add(self, name, {faces = faces, [key] = value}, {kind = key, faces = faces, vector = value})
  end
end

--- A total force (N) on faces.
workbench.load = vector_load("load", "force")
--- A moment (N m) on faces.
workbench.moment = vector_load("moment", "moment")

local pressure_rules = {faces = {type = "table", needed = true}, pressure = {type = "number", needed = true}}

--- A pressure (Pa) on faces; positive pushes inwards.
function workbench:pressure(given)
  local opts = options.read("pressure", given, pressure_rules)
  local faces, message, details = read_faces(self, "pressure", opts.faces)
  if not faces then return nil, message, details end
  return add(self, "pressure", {faces = faces, pressure = opts.pressure},
    {kind = "pressure", faces = faces, value = opts.pressure})
end

local gravity_rules = {acceleration = {type = "table", default = {0, 0, -9.81}}}

--- Gravity, an acceleration (m/s2).
function workbench:gravity(given)
  local opts = options.read("gravity", given, gravity_rules)
  local value, message, details = vector("gravity", "acceleration", opts.acceleration)
  if not value then return nil, message, details end
  return add(self, "gravity", {acceleration = value}, {kind = "gravity", vector = value})
end

local function numbered(self, where, number)
  local list = now(self).conditions
  if math.type(number) == "integer" and list[number] then return list[number] end
  raise(("%s: there is no support or load %s: there are %d"):format(where, core.got(number), #list))
end

local change_rules = {condition = {type = "integer", needed = true}, faces = {type = "table"},
  vector = {type = "table"}, value = {type = "number"}, kind = {type = "string", one_of = {"all", "normal"}}}

--- Changes a support or a load: its faces, its vector or its value.
function workbench:change(given)
  local opts = options.read("change", given, change_rules)
  local old, message, details = numbered(self, "change", opts.condition)
  if not old then return nil, message, details end
  local new = {kind = old.kind, faces = old.faces, vector = old.vector, value = old.value}
  local line = {condition = opts.condition}
  if opts.faces and old.faces then
    new.faces, message, details = read_faces(self, "change", opts.faces)
    if not new.faces then return nil, message, details end
    line.faces = new.faces
  end
  if opts.vector and old.vector then
    new.vector, message, details = vector("change", "vector", opts.vector)
    if not new.vector then return nil, message, details end
    line.vector = new.vector
  end
  if opts.value and old.value then new.value, line.value = opts.value, opts.value end
  if opts.kind and (old.kind == "all" or old.kind == "normal") then new.kind, line.kind = opts.kind, opts.kind end
  local why = clash(self, new, opts.condition)
  if why then return refuse(why) end
  local list = table.move(now(self).conditions, 1, #now(self).conditions, 1, {})
  list[opts.condition] = new
  return act(self, "change", line, {conditions = list})
end

--- Removes a support or a load.
function workbench:remove(given)
  local opts = options.read("remove", given, {condition = {type = "integer", needed = true}})
  local old, message, details = numbered(self, "remove", opts.condition)
  if not old then return nil, message, details end
  local list = table.move(now(self).conditions, 1, #now(self).conditions, 1, {})
  table.remove(list, opts.condition)
  return act(self, "remove", {condition = opts.condition}, {conditions = list})
end

local material_rules = {name = {type = "string"}, young = {type = "number", above = 0},
  poisson = {type = "number", min = 0, max = 0.499}, strength = {type = "number", above = 0},
  density = {type = "number", above = 0}}

--- The material: one of the library by its name, or by values.
function workbench:material(given)
  local opts = options.read("material", given, material_rules)
  local made, message, details
  if opts.young or opts.poisson or opts.strength or opts.density then
    local base = opts.name and model.try(core.material.named, opts.name) or nil
    local values = {name = opts.name or "own material", young = opts.young or base and base.young,
      poisson = opts.poisson or base and base.poisson, strength = opts.strength or base and base.strength,
      density = opts.density or base and base.density}
    if type(values.young) ~= "number" or type(values.poisson) ~= "number" then
      raise("material: Young's modulus and Poisson's ratio are needed")
    end
    if values.strength ~= nil and type(values.strength) ~= "number" then values.strength = nil end
    made, message, details = core.material.isotropic(values)
  elseif opts.name then
    made, message, details = core.material.named(opts.name)
  else
    raise("material: a name or values are needed")
  end
  if not made then return nil, message, details end
  return act(self, "material", opts, {material = made, material_options = opts})
end

--- Faces that no edit moves, in place of those before; none: all are free.
function workbench:lock(given)
  local opts = options.read("lock", given, {faces = {type = "table", needed = true}})
  local set, faces = {}, {}
  if #opts.faces > 0 then
    local message, details
    faces, message, details = read_faces(self, "lock", opts.faces)
    if not faces then return nil, message, details end
  end
  for _, face in ipairs(faces) do set[face] = true end
  return act(self, "lock", {faces = faces}, {locked = set})
end

-- A further entry with faces that were split off. Supports and loads keep all that they had, and so do locks.
local function with_patches(self, name, line, made, list, parts)
  self.grown_faces = list
  if made == now(self).body then return self end
  local conditions, locked = {}, {}
  for i, condition in ipairs(now(self).conditions) do
    local faces, had = table.move(condition.faces or {}, 1, #(condition.faces or {}), 1, {}), {}
    for _, face in ipairs(faces) do had[face] = true end
    for _, number in ipairs(list) do
      if had[parts[number]] then faces[#faces + 1] = number end
    end
    conditions[i] = {kind = condition.kind, faces = condition.faces and faces, vector = condition.vector,
      value = condition.value}
  end
  for face in pairs(now(self).locked) do locked[face] = true end
  for new, part in pairs(parts) do locked[new] = locked[part] end
  return act(self, name, line, {body = made, conditions = conditions, locked = locked})
end

local grow_rules = {triangle = {type = "integer", min = 1}, point = {type = "table"},
  angle = {type = "number", default = 0.35, above = 0, max = math.pi}, radius = {type = "number", above = 0}}

--- Makes a face of its own of the triangles around one, within its face, whose normals differ by at most an angle
--- from its normal, and which lie within a radius. Supports and loads of that face keep all of it.
function workbench:grow(given)
  local opts = options.read("grow", given, grow_rules)
  local part, point, first = now(self).body, nil, opts.triangle
  if (opts.triangle == nil) == (opts.point == nil) then raise "grow: 'triangle' or 'point' is needed" end
  local why = (opts.point or opts.radius) and session.unconfirmed(self)
  if why then return refuse(why) end
  if opts.point then
    local message, details
    point = vector("grow", "point", opts.point)
    local found
    found, message, details = part.surface:nearest {point}
    if not found then return nil, message, details end
    first = math.tointeger(found[1])
  end
  local made, list, parts = patches.grown(part, first, opts.angle, opts.radius or math.huge, point)
  return with_patches(self, "grow", {triangle = opts.triangle, point = point, angle = opts.angle,
    radius = opts.radius}, made, list, parts)
end

local patch_rules = {planes = {type = "table", needed = true}, towards = {type = "table", needed = true}}

--- Makes faces of their own of what lies within planes and looks towards a direction: a rectangle of the screen.
function workbench:patch(given)
  local opts = options.read("patch", given, patch_rules)
  local why = session.unconfirmed(self)
  if why then return refuse(why) end
  local towards, planes = vector("patch", "towards", opts.towards), {}
  for i, plane in ipairs(opts.planes) do
    if type(plane) ~= "table" or type(plane[4]) ~= "number" then
      raise "patch: 'planes': lists of four numbers expected"
    end
    planes[i] = vector("patch", "planes", {plane[1], plane[2], plane[3]})
    planes[i][4] = plane[4] + 0.0
  end
  local made, list, parts = patches.within(now(self).body, planes, towards)
  if not made then return nil, list, parts end
  return with_patches(self, "patch", {planes = planes, towards = towards}, made, list, parts)
end

local symmetry_rules = {across = {type = "string", needed = true, one_of = {"x", "y", "z", "none"}}}

--- Edits of the shape are done on both sides of the plane through the middle of the part across an axis.
function workbench:symmetry(given)
  local opts = options.read("symmetry", given, symmetry_rules)
  if opts.across ~= "none" then
    local why = mirror.fault(now(self).body, opts.across)
    if why then return refuse(why) end
  end
  return act(self, "symmetry", {across = opts.across}, {symmetry = opts.across ~= "none" and opts.across or false})
end

return workbench
