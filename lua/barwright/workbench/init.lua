-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The workbench: a part from a file, what holds and loads it, an answer, edits of its surface. Every action is a
-- method, a line of a script, and can be undone. docs/workbench.md.
--
-- `history` has what the actions made so far, `position` where undo and redo are. An entry is never changed:
-- {body, conditions, material, material_options, locked, line, edited = whether the shape was, answer, ...}.
local arguments = require "barwright.arguments"
local body = require "barwright.workbench.body"
local core = require "barwright.core"
local edits = require "barwright.workbench.edits"
local judge = require "barwright.workbench.judge"
local lines = require "barwright.workbench.lines"
local model = require "barwright.command.model"
local options = require "barwright.options"
local advise = require "barwright.workbench.advise"
local state_of = require "barwright.workbench.state"
local writable = require "barwright.writable"

local raise = core.raise

local workbench = {}
workbench.__index = workbench
workbench.__name = "barwright.workbench"

local function now(self)
  return self.history[self.position]
end

-- Refusals of what this part, as it is, does not permit: nil, a sentence, details.
local function refuse(text, status)
  return nil, text, {status = status or "unsupported"}
end

-- ---- opening ---------------------------------------------------------------------------------------

local units = {mm = 1e-3, cm = 1e-2, m = 1, km = 1e3, um = 1e-6, ["in"] = 0.0254, ft = 0.3048}
local unit_names = {"mm", "cm", "m", "km", "um", "in", "ft"}

local open_rules = {unit = {type = "string", one_of = unit_names}}

--- Reads a file, without repair: the shape can be shown already. `prepare` goes on. A `name` of the result takes
--- the place of the path in scripts.
function workbench.read(path, given)
  local opts = options.read("open", given, open_rules)
  local read, message, details = body.read(path, opts.unit)
  if not read then return nil, message, details end
  return setmetatable({path = path, unit_given = opts.unit, raw = read, history = {}, position = 0, revision = 0},
    workbench)
end

--- Repairs the surface that was read and finds its faces.
function workbench:prepare()
  local made, message, details = body.new(self.raw.surface)
  if not made then return nil, self.path .. ": " .. message, details end
  local material = core.material.named "pla"
  self.doubt, self.likely = body.doubt(self.raw, self.unit_given)
  self.history = {{body = made, conditions = {}, material = material, material_options = {name = "pla"},
    locked = {}, revision = 1}}
  self.position, self.revision = 1, self.revision + 1
  self.last_revision = 1
  return self
end

--- Opens a file: its shape, repaired where it must be.
function workbench.open(path, given)
  local self, message, details = workbench.read(path, given)
  if not self then return nil, message, details end
  return self:prepare()
end

-- ---- actions ---------------------------------------------------------------------------------------

-- What an action made takes the place of all that was undone. `change`: what differs from the entry before.
local function act(self, name, given, change)
  local before, entry = now(self), {}
  for _, key in ipairs {"body", "conditions", "material", "material_options", "locked", "edited"} do
    entry[key] = before[key]
    if change[key] ~= nil then entry[key] = change[key] end
  end
  entry.line = lines.action(name, given)
  self.last_revision = self.last_revision + 1
  entry.revision = self.last_revision
  for i = #self.history, self.position + 1, -1 do self.history[i] = nil end
  self.position = self.position + 1
  self.history[self.position] = entry
  self.revision, self.saved = self.revision + 1, false
  return self
end

local function is_face(self, face)
  return math.type(face) == "integer" and face >= 1 and face <= #now(self).body.faces
end

-- Faces that an action names: a list without doubles; or nil and a sentence.
local function read_faces(self, where, list)
  if type(list) ~= "table" or #list == 0 then
    raise(("%s: choose one face or more"):format(where))
  end
  local seen, out = {}, {}
  for _, face in ipairs(list) do
    if not is_face(self, face) then
      raise(("%s: there is no face %s: the part has faces 1 to %d"):format(where, core.got(face),
        #now(self).body.faces))
    end
    if not seen[face] then out[#out + 1] = face end
    seen[face] = true
  end
  return out
end

local function are_numbers(value)
  if type(value) ~= "table" or #value ~= 3 then return false end
  for k = 1, 3 do
    local x = value[k]
    if type(x) ~= "number" or x ~= x or math.abs(x) == math.huge then return false end
  end
  return true
end

local function vector(where, name, value)
  if are_numbers(value) then return {value[1] + 0.0, value[2] + 0.0, value[3] + 0.0} end
  raise(("%s: '%s': three numbers expected"):format(where, name))
end

-- The unit must be confirmed before anything is computed or a length is given.
local function unconfirmed(self)
  if not self.doubt then return nil end
  return ("%s Nothing was computed: choose the unit of the file first."):format(self.doubt)
end

local function with_condition(self, name, given, condition)
  local list = table.move(now(self).conditions, 1, #now(self).conditions, 1, {})
  list[#list + 1] = condition
  return act(self, name, given, {conditions = list})
end

-- A sentence where a load would act on a face that is held, or the other way round.
local function clash(self, condition, but)
  local part = now(self).body
  for i, other in ipairs(now(self).conditions) do
    local one_holds = condition.kind == "all" ~= (other.kind == "all")
    local load = condition.kind == "all" and other or condition
    if i ~= but and one_holds and load.kind ~= "normal" and load.kind ~= "gravity" then
      for _, a in ipairs(condition.faces or {}) do
        for _, b in ipairs(other.faces or {}) do
          if a == b then
            return ("%s is held and cannot be loaded: a load on a support does nothing. Load another face, or "
              .. "remove the support."):format(part.faces[a].name)
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

--- Holds faces: all directions, or only along their normals.
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

local grow_rules = {triangle = {type = "integer", needed = true, min = 1},
  angle = {type = "number", default = 0.35, above = 0, max = math.pi}}

--- Makes a face of its own of the triangles around one, within its face, whose normals differ by at most an angle.
--- Supports and loads of that face keep all of it.
function workbench:grow(given)
  local opts = options.read("grow", given, grow_rules)
  local part = now(self).body
  local grown, number, old = body.grown(part, opts.triangle, opts.angle)
  if not grown then return nil, number, old end
  self.grown_face = number
  if grown == part then return self end
  local list = {}
  for i, condition in ipairs(now(self).conditions) do
    list[i] = condition
    for _, face in ipairs(condition.faces or {}) do
      if face == old then
        local faces = table.move(condition.faces, 1, #condition.faces, 1, {})
        faces[#faces + 1] = number
        list[i] = {kind = condition.kind, faces = faces, vector = condition.vector, value = condition.value}
      end
    end
  end
  local locked = now(self).locked
  if locked[old] then
    local set = {[number] = true}
    for face in pairs(locked) do set[face] = true end
    locked = set
  end
  return act(self, "grow", {triangle = opts.triangle, angle = opts.angle}, {body = grown, conditions = list,
    locked = locked})
end

-- ---- the unit --------------------------------------------------------------------------------------

--- The unit of the numbers in the file. It is chosen before the shape is edited.
function workbench:unit(given)
  local opts = options.read("unit", given, {unit = {type = "string", needed = true, one_of = unit_names}})
  for i = 1, self.position do
    if self.history[i].edited then
      return refuse "The shape was edited with lengths in the former unit: undo the edits, then choose the unit."
    end
  end
  local read, message, details = body.read(self.path, opts.unit)
  if not read then return nil, message, details end
  local made
  made, message, details = body.new(read.surface)
  if not made then return nil, message, details end
  -- the file is as if it had been opened with this unit: what was done so far goes on with the new lengths
  if #self.history > 1 and #made.faces ~= #self.history[1].body.faces then
    return refuse "The faces of the part differ in this unit: open the file again with the unit."
  end
  self.unit_given, self.raw, self.doubt, self.likely = opts.unit, read, nil, nil
  for i = 1, #self.history do
    local entry = self.history[i]
    entry.body, entry.answer, entry.solved, entry.coarse = made, nil, nil, nil
    self.last_revision = self.last_revision + 1
    entry.revision = self.last_revision
  end
  self.revision = self.revision + 1
  return self
end

-- ---- edits of the shape ----------------------------------------------------------------------------

local push_rules = {faces = {type = "table", needed = true}, distance = {type = "number", needed = true}}

local function locked_among(self, faces)
  for _, face in ipairs(faces) do
    if now(self).locked[face] then
      return ("%s is locked: unlock it to move it."):format(now(self).body.faces[face].name)
    end
  end
end

local function may_edit(self, faces)
  return unconfirmed(self) or locked_among(self, faces)
end

-- The body that a push makes, and what goes into the script.
local function pushed(self, given)
  local opts = options.read("push", given, push_rules)
  local faces, message, details = read_faces(self, "push", opts.faces)
  if not faces then return nil, message, details end
  local why = may_edit(self, faces)
  if why then return refuse(why) end
  local distances = {}
  for _, face in ipairs(faces) do distances[face] = opts.distance end
  local made
  made, message, details = edits.push(now(self).body, distances, now(self).locked, "This push")
  if not made then return nil, message, details end
  return made, {faces = faces, distance = opts.distance}
end

local radius_rules = {face = {type = "integer", needed = true},
  radius = {type = "number", needed = true, above = 0}}

local function resized(self, given)
  local opts = options.read("radius", given, radius_rules)
  local faces, message, details = read_faces(self, "radius", {opts.face})
  if not faces then return nil, message, details end
  local why = may_edit(self, faces)
  if why then return refuse(why) end
  local about = now(self).body.faces[opts.face]
  if about.kind ~= "cylinder" and about.kind ~= "sphere" then
    return refuse(("%s has no radius: choose a hole or another round face, or push it."):format(about.name))
  end
  local made
  made, message, details = edits.radius(now(self).body, opts.face, opts.radius)
  if not made then return nil, message, details end
  return made, {face = opts.face, radius = opts.radius}
end

local function grown_all(self, given)
  local opts = options.read("offset", given, {distance = {type = "number", needed = true}})
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local distances = {}
  for face in ipairs(now(self).body.faces) do
    if not now(self).locked[face] then distances[face] = opts.distance end
  end
  local made, message, details = edits.push(now(self).body, distances, now(self).locked, "This offset")
  if not made then return nil, message, details end
  return made, {distance = opts.distance}
end

local shapes = {push = pushed, radius = resized, offset = grown_all}

for name, make in pairs(shapes) do
  workbench[name] = function(self, given)
    local made, line, details = make(self, given)
    if not made then return nil, line, details end
    return act(self, name, line, {body = made, edited = true})
  end
end

--- A coarse answer for a shape that is tried, while a handle is dragged: {push | radius | offset = options}.
--- Nothing changes. Returns the answer, the solution and the body.
function workbench:try(given)
  local name = next(given)
  if not shapes[name] then raise("try: push, radius or offset expected") end
  local made, line, details = shapes[name](self, given[name])
  if not made then return nil, line, details end
  local entry = now(self)
  local answer, static, more = judge.statics(made, entry.material, entry.conditions, judge.elements.drag)
  return answer, static, more, made
end

-- ---- answers ---------------------------------------------------------------------------------------

local function has_loads(entry)
  for _, condition in ipairs(entry.conditions) do
    if condition.kind ~= "all" and condition.kind ~= "normal" then return true end
  end
  return false
end

-- An answer, and its mesh for the picture, go into the entry.
local function keep(self, entry, accuracy, answer, solved)
  answer.accuracy = accuracy
  entry.answer, entry.solved = answer, solved
  self.last_revision = self.last_revision + 1
  entry.revision = self.last_revision
  self.revision = self.revision + 1
  if self.on_answer then self.on_answer(answer) end
end

local function statics(self, entry, accuracy)
  local former = entry.coarse
  if not former then
    local answer, static, more = judge.statics(entry.body, entry.material, entry.conditions, judge.elements.coarse)
    if not answer then return nil, static, more end
    answer.frequency = judge.frequency(more)
    former = {answer = answer, static = static, measure = more.measure, labels = more.labels}
    entry.coarse = former
  end
  if accuracy == "coarse" or not entry.answer then
    keep(self, entry, "coarse", former.answer, {static = former.static, labels = former.labels})
  end
  if accuracy == "coarse" then return entry.answer end
  local answer, static, more = judge.statics(entry.body, entry.material, entry.conditions,
    judge.elements[accuracy], former.measure)
  if not answer then return nil, static, more end
  answer.frequency = former.answer.frequency
  keep(self, entry, accuracy, answer, {static = static, labels = more.labels})
  return answer
end

local answer_rules = {accuracy = {type = "string", default = "default", one_of = {"coarse", "default", "fine"}},
  force = {type = "number", above = 0}}

--- The answer: with loads whether the part carries them, without loads the force that breaks it in the worst way.
function workbench:answer(given)
  local opts = options.read("answer", given, answer_rules)
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local entry = now(self)
  entry.answer_line = lines.action("answer", opts)
  if has_loads(entry) then return statics(self, entry, opts.accuracy) end
  if not entry.material.strength then
    return refuse(("The strength of %s is not known: give it with the material."):format(entry.material.name))
  end
  local answer, found, details = judge.worst(entry.body, entry.material, entry.conditions,
    judge.elements[opts.accuracy], opts.force)
  if not answer then return nil, found, details end
  keep(self, entry, opts.accuracy, answer, {breaking = found})
  return answer
end

--- Stress (Pa) and displacement (m) at a point of the last answer.
function workbench:probe(given)
  local opts = options.read("probe", given, {point = {type = "table", needed = true}})
  local point, message, details = vector("probe", "point", opts.point)
  if not point then return nil, message, details end
  local solved = now(self).solved
  if not (solved and solved.static) then return refuse "There is no result to read: ask for the answer first." end
  local static, at = solved.static, core.array.new {point}
  local stress, why, about = model.try(static.mesh.sample, static.mesh, static.von_mises, at)
  if not stress then return nil, why, about end
  local moved = static.mesh:sample(static.displacement, at)
  return {point = point, von_mises = stress(1, 1), displacement = moved:totable()[1]}
end

-- ---- advice ----------------------------------------------------------------------------------------

local advice_rules = {force = {type = "number", above = 0}}

--- What to thicken, with the gain of each place: kept until the part changes.
function workbench:advice(given)
  local opts = options.read("advice", given, advice_rules)
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local entry = now(self)
  local list, message, details = advise.places(entry, opts, has_loads(entry))
  if not list then return nil, message, details end
  entry.advice, entry.advice_line = list, lines.action("advice", opts)
  self.revision = self.revision + 1
  return list
end

--- Does what an advice says.
function workbench:apply(given)
  local opts = options.read("apply", given, {advice = {type = "integer", needed = true}})
  local entry = now(self)
  local place = (entry.advice or {})[opts.advice]
  if not place then
    raise(("apply: there is no advice %d: ask for advice first"):format(opts.advice))
  end
  return self:thicken {at = place.at, radius = place.radius, offset = place.offset}
end

local thicken_rules = {at = {type = "table", needed = true}, radius = {type = "number", needed = true, above = 0},
  offset = {type = "number", needed = true, above = 0}}

--- Thickens the part around a point by a smooth bump.
function workbench:thicken(given)
  local opts = options.read("thicken", given, thicken_rules)
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local at, message, details = vector("thicken", "at", opts.at)
  if not at then return nil, message, details end
  local entry = now(self)
  local made
  made, message, details = advise.thickened(entry, {at = at, radius = opts.radius, offset = opts.offset})
  if not made then return nil, message, details end
  return act(self, "thicken", {at = at, radius = opts.radius, offset = opts.offset}, {body = made, edited = true})
end

local optimise_rules = {force = {type = "number", above = 0}, factor = {type = "number", above = 0, default = 1.0},
  steps = {type = "integer", min = 1, max = 20, default = 5}}

--- Thickens weak places until the part carries a force in the worst way, or its loads with a factor. The best that
--- was found is kept, also where that is not reached.
function workbench:optimise(given)
  local opts = options.read("optimise", given, optimise_rules)
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local entry = now(self)
  local made, report, details = advise.optimise(entry, opts, has_loads(entry))
  if not made then return nil, report, details end
  self.note = report
  return act(self, "optimise", opts, {body = made, edited = true})
end

-- ---- undo ------------------------------------------------------------------------------------------

--- Takes the last action back.
function workbench:undo()
  if self.position == 1 then return refuse("There is nothing to undo.", "empty") end
  self.position, self.revision, self.saved = self.position - 1, self.revision + 1, false
  return self
end

--- Repeats the action that was taken back.
function workbench:redo()
  if self.position == #self.history then return refuse("There is nothing to redo.", "empty") end
  self.position, self.revision, self.saved = self.position + 1, self.revision + 1, false
  return self
end

-- ---- files -----------------------------------------------------------------------------------------

-- The lines of the actions in force.
local function script_lines(self)
  local list = {}
  for i = 2, self.position do list[#list + 1] = self.history[i].line end
  local entry = now(self)
  if entry.answer_line then
    list[#list + 1] = ("local answer = %s"):format(entry.answer_line)
    list[#list + 1] = "print(answer.sentence)"
  end
  return list
end

--- A script that opens the file and repeats every action in force, and the answer.
function workbench:script()
  return lines.script(self.name or self.path, self.unit_given, script_lines(self))
end

--- Writes the script to a file, else to one beside the part.
function workbench:save(given)
  local opts = options.read("save", given, {path = {type = "string"}})
  local path = opts.path or self.path:gsub("%.%w+$", "") .. ".workbench.lua"
  local ok, message, details = writable(path)
  if not ok then return nil, message, details end
  local file, why = io.open(path, "wb")
  if not file then return nil, why, {status = "io"} end
  file:write(self:script())
  file:close()
  self.saved = path
  return path
end

--- Writes the edited surface to a file, by its ending.
function workbench:export(given)
  local opts = options.read("export", given, {path = {type = "string", needed = true}})
  local ok, message, details = now(self).body.surface:write(opts.path)
  if not ok then return nil, message, details end
  return opts.path
end

--- The session as a plain table: what a page shows.
function workbench:state()
  return state_of(self, script_lines(self))
end

-- What a page draws: the entry in force.
function workbench:current()
  return now(self)
end

function workbench:__tostring()
  local entry = now(self)
  if not entry then return "workbench of " .. self.path end
  return ("workbench of %s: %d faces, %d supports and loads, %s%s"):format(self.path, #entry.body.faces,
    #entry.conditions, entry.material.name, entry.answer and "; " .. entry.answer.sentence or "")
end

arguments.methods("workbench", workbench, workbench, {fix = "options: options", load = "options: options",
  pressure = "options: options", moment = "options: options", gravity = "options?: options",
  change = "options: options", remove = "options: options", material = "options: options",
  lock = "options: options", grow = "options: options", unit = "options: options", push = "options: options",
  radius = "options: options", offset = "options: options", try = "options: options", answer = "options?: options",
  probe = "options: options", advice = "options?: options", apply = "options: options",
  thicken = "options: options", optimise = "options?: options", undo = "", redo = "", script = "",
  save = "options?: options", export = "options: options", state = ""})
arguments.functions("workbench.", workbench, {open = "path: string, options?: options"})

return {class = workbench, open = workbench.open, read = workbench.read, units = units}
