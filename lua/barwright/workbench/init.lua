-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The workbench: a part from a file, what constrains and loads it, an answer, edits of its surface. Every action
-- is a method, a line of a script, and can be undone. docs/workbench.md.
-- The actions are in conditions.lua, shapes.lua and answers.lua; session.lua has what they share.
local arguments = require "barwright.arguments"
local body = require "barwright.workbench.body"
local core = require "barwright.core"
local deviation_of = require "barwright.workbench.deviation"
local file_unit = require "barwright.command.file_unit"
local lines = require "barwright.workbench.lines"
local options = require "barwright.options"
local session = require "barwright.workbench.session"
local distance = require("barwright.points").distance
local state_of = require "barwright.workbench.state"
local writable = require "barwright.writable"

local workbench = {}
workbench.__index = workbench
workbench.__name = "barwright.workbench"

local now, refuse, act = session.now, session.refuse, session.act

-- ---- opening ---------------------------------------------------------------------------------------

local unit_names = file_unit.names

local open_rules = {unit = {type = "string", one_of = unit_names}, thickness = {type = "number", above = 0}}

-- How the file was read: {read = what it holds, unit =, thickness = those that were given, doubt =, likely =,
-- body = the repaired body, once it is known}.
local function source_of(read, unit, thickness)
  local source = {read = read, unit = unit or read.by_environment, thickness = thickness}
  source.doubt, source.likely = body.doubt(read, unit)
  return source
end

--- Reads a file, without repair: the shape can be shown already. `prepare` goes on. A `name` of the result takes
--- the place of the path in scripts. `environment`: whether BARWRIGHT_UNIT counts where no unit is given.
function workbench.read(path, given, environment)
  local opts = options.read("open", given, open_rules)
  local read, message, details = body.read(path, opts.unit, opts.thickness, environment)
  if not read then return nil, message, details end
  return setmetatable({path = path, source = source_of(read, opts.unit, opts.thickness), history = {},
    position = 0, revision = 0}, workbench)
end

--- Repairs the surface that was read and finds its faces.
function workbench:prepare()
  local made, message, details = body.new(self.source.read.surface)
  if not made then return nil, self.path .. ": " .. message, details end
  self.source.body = made
  self.history = {{body = made, source = self.source, conditions = {}, material = core.material.named "pla",
    material_options = {name = "pla"}, locked = {}, revision = 1}}
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

-- ---- the unit and the thickness --------------------------------------------------------------------

-- Whether two lists of faces have the same kinds and normals, so that a number means the same face in both.
local function same_faces(a, b)
  for i = 1, math.max(#a, #b) do
    if not (a[i] and b[i]) or a[i].kind ~= b[i].kind then return false end
    if a[i].kind == "plane" and distance(a[i].normal, b[i].normal) > 1e-6 then return false end
  end
  return true
end

-- Whether supports, loads or locks of an entry name faces.
local function names_faces(entry)
  for _, condition in ipairs(entry.conditions) do
    if condition.faces then return true end
  end
  return next(entry.locked) ~= nil
end

-- A further entry in which the file is read with another unit or thickness; supports and loads stay on their
-- faces.
local function reopened(self, what, given)
  local entry = now(self)
  local source = entry.source
  if entry.body ~= source.body then
    return refuse(("The shape or its faces were changed with lengths of the former %s: undo that, then choose "
      .. "the %s."):format(what, what))
  end
  local unit, thickness = given.unit or source.unit, given.thickness or source.thickness
  local read, message, details = body.read(self.path, unit, thickness)
  if not read then return nil, message, details end
  local new = source_of(read, unit, thickness)
  new.body, message, details = body.new(read.surface)
  if not new.body then return nil, message, details end
  if names_faces(entry) and not same_faces(entry.body.faces, new.body.faces) then
    return refuse(("The faces of the part get other numbers with this %s: undo the supports and loads, then "
      .. "choose the %s."):format(what, what))
  end
  return act(self, what, given, {body = new.body, source = new})
end

--- The unit of the numbers in the file. It is chosen before the shape is edited.
function workbench:unit(given)
  local opts = options.read("unit", given, {unit = {type = "string", needed = true, one_of = unit_names}})
  return reopened(self, "unit", opts)
end

--- The thickness (m) of the body of a drawing. It is chosen before the shape is edited.
function workbench:thickness(given)
  local opts = options.read("thickness", given, {thickness = {type = "number", needed = true, above = 0}})
  if not self.source.read.thickness then
    return refuse "The file is solid and has a thickness already: push a face instead."
  end
  return reopened(self, "thickness", opts)
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

local function is_edited(entry)
  return entry.body.surface ~= entry.source.body.surface
end

-- The lines of the actions in force, and of what they print.
local function script_lines(self)
  local list = {}
  for i = 2, self.position do list[#list + 1] = self.history[i].line end
  local entry = now(self)
  if is_edited(entry) then list[#list + 1] = "print(workbench:deviation())" end
  if entry.answer_line then
    list[#list + 1] = ("local answer = %s"):format(entry.answer_line)
    list[#list + 1] = "print(answer.sentence)"
  end
  return list
end

--- A script that opens the file and repeats every action in force, and the answer.
function workbench:script()
  return lines.script(self.name or self.path, {unit = self.source.unit, thickness = self.source.thickness},
    script_lines(self))
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

--- How far the edited surface lies from that of the file, as it was repaired: {largest, at, unmoved, points}.
function workbench:deviation()
  local entry = now(self)
  return deviation_of(entry.body.surface, entry.source.body.surface)
end

--- Writes the edited surface to a file, by its ending. Returns the path and the deviation.
function workbench:export(given)
  local opts = options.read("export", given, {path = {type = "string", needed = true}})
  local ok, message, details = now(self).body.surface:write(opts.path)
  if not ok then return nil, message, details end
  local deviation
  deviation, message, details = self:deviation()
  if not deviation then return nil, message, details end
  return opts.path, deviation
end

--- The session as a plain table: what a page shows.
function workbench:state()
  return state_of(self, script_lines(self), is_edited(now(self)) and self:deviation() or nil)
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

for _, actions in ipairs {"conditions", "shapes", "answers"} do
  for name, action in pairs(require("barwright.workbench." .. actions)) do workbench[name] = action end
end

arguments.methods("workbench", workbench, workbench, {fix = "options: options", load = "options: options",
  pressure = "options: options", moment = "options: options", gravity = "options?: options",
  change = "options: options", remove = "options: options", material = "options: options",
  lock = "options: options", symmetry = "options: options", grow = "options: options",
  patch = "options: options", unit = "options: options", thickness = "options: options", push = "options: options",
  radius = "options: options", offset = "options: options", try = "options: options",
  prepare_drag = "options?: options", answer = "options?: options",
  probe = "options: options", advice = "options?: options", apply = "options: options",
  thicken = "options: options", optimise = "options?: options", undo = "", redo = "", script = "", deviation = "",
  save = "options?: options", export = "options: options", state = ""})
arguments.functions("workbench.", workbench, {open = "path: string, options?: options"})

return {class = workbench, open = workbench.open, read = workbench.read}
