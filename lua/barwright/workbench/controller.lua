-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The workbench's controller: takes the messages of pages, does their actions on a workbench, and sends every page
-- the state and the scene. docs/workbench.md has the protocol.
--
-- `server` needs send(client, bytes, options), serve(path, mime, bytes, download) and receive(0), so that tests
-- can put a table in its place.
local core = require "barwright.core"
local frame = require "barwright.workbench.frame"
local json = require "barwright.json"
local lengths = require "barwright.command.lengths"
local live_check = require "barwright.live_check"
local model = require "barwright.command.model"
local shared = require "barwright.live_session"
local workbench = require "barwright.workbench"

local notify, notify_all, send_all = shared.notify, shared.notify_all, shared.send_all

local controller = {}
controller.__index = controller

-- ---- reports ---------------------------------------------------------------------------------------

local function send_state(self)
  local state = self.bench and self.bench:state() or {type = "state", revision = 0}
  state.message, state.busy, state.latency_ms, state.part = self.message, self.busy, self.latency, self.part
  self.state = state
  notify_all(self, state)
end

local function send_scene(self, bytes)
  self.scene = bytes
  send_all(self, bytes, "scene")
end

-- The state, and the scene where it is another one.
local function publish(self)
  local entry = self.bench and self.bench:current()
  local drawn = entry and (entry.solved or entry.body)
  if drawn and drawn ~= self.shown then
    self.shown = drawn
    send_scene(self, frame.entry(entry))
  end
  send_state(self)
end

local function say(self, text, details)
  local more = type(details) == "table" and (details.element and ("element %d"):format(details.element)) or nil
  self.message = {text = text, details = more}
end

local stages = {coarse = "a first answer"}

-- ---- long work -------------------------------------------------------------------------------------

-- What a page asks for that changes nothing that is computed.
local harmless = {save = true, export = true, probe = true, prepare = true}

local function open_window(self, client)
  if self.clients[client] then return end
  self.clients[client] = true
  notify(self, client, {type = "welcome", client = client, version = core.version})
  if self.scene then self.server:send(client, self.scene, {binary = true, replace = "scene"}) end
  notify(self, client, self.state or {type = "state", revision = 0})
end

-- Long work during which windows open, `cancel` stops it, and an action makes it obsolete and is done then.
local function long(self, what, work, ...)
  local start, shown, last = core.seconds(), -1, nil
  self.busy = {what = what, fraction = 0}
  notify_all(self, {type = "busy", busy = self.busy})
  self.on_progress = function(stage, fraction)
    local now = core.seconds()
    if stage ~= last then start, last = now, stage end -- the time to go is that of the stage
    if now - shown < 0.2 then return end
    shown = now
    local spent = now - start
    self.busy = {what = what, stage = stages[stage] or stage, fraction = fraction,
      to_go_s = fraction and fraction > 0.05 and spent * (1 - fraction) / fraction or nil}
    notify_all(self, {type = "busy", busy = self.busy})
  end
  local results = table.pack(pcall(shared.meanwhile, self, function(client, kind, text)
    if kind == "open" then open_window(self, client) end
    if kind == "upload" then return true, true end
    if kind ~= "message" then return false end
    local message = #text < 65536 and json.decode(text)
    local asked = live_check.is_object(message) and message["do"]
    if asked == "cancel" then return true, false end
    return asked ~= nil and not harmless[asked], true
  end, work, ...))
  self.on_progress, self.busy = nil, nil
  notify_all(self, {type = "busy", busy = json.null})
  if not results[1] then return nil, tostring(results[2]), {status = "internal"} end
  return table.unpack(results, 2, results.n)
end

-- ---- files -----------------------------------------------------------------------------------------

local mimes = {stl = "model/stl", obj = "model/obj", ply = "application/octet-stream", off = "text/plain",
  ["3mf"] = "model/3mf", glb = "model/gltf-binary", step = "model/step", usda = "text/plain; charset=utf-8",
  lua = "text/plain; charset=utf-8"}
local format_names = {}
for name in pairs(mimes) do format_names[#format_names + 1] = name end
table.sort(format_names)

local function stem(self)
  return (model.name(self.bench.path):gsub("%.%w+$", ""):gsub("[^%w_.-]", "_"))
end

local function export(self, client, message)
  local format = tostring(message.format or "stl"):lower()
  if not mimes[format] then
    return nil, ("export: no such format '%s': one of %s expected"):format(live_check.shown(format),
      table.concat(format_names, ", "))
  end
  local bytes, why, deviation
  if format == "lua" then
    bytes = self.bench:script()
  else
    bytes, why = shared.written("." .. format, function(path)
      local written
      written, deviation = self.bench:export {path = path}
      return written, deviation
    end)
  end
  if not bytes then return nil, why end
  local path, name = "export." .. format, stem(self) .. "." .. format
  self.server:serve(path, mimes[format], bytes, name)
  notify(self, client, {type = "file", id = message.id, url = path, name = name, format = format, bytes = #bytes,
    deviation = deviation and tostring(deviation)})
  return true
end

-- ---- actions ---------------------------------------------------------------------------------------

local handlers = {export = export}

-- Actions that are done at once, by the method of the same name.
for _, name in ipairs {"fix", "load", "pressure", "moment", "gravity", "change", "remove", "material", "lock",
  "symmetry", "grow", "patch", "push", "radius", "offset", "thicken"} do
  handlers[name] = function(self, _, _, given) return self.bench[name](self.bench, given) end
end

-- With what was undone, or done again, in words.
function handlers.undo(self)
  local undone = self.bench:current()
  local ok, why, details = self.bench:undo()
  if not ok then return nil, why, details end
  return true, ("Undone: %s."):format(undone.words)
end

function handlers.redo(self)
  local ok, why, details = self.bench:redo()
  if not ok then return nil, why, details end
  return true, ("Done again: %s."):format(self.bench:current().words)
end

-- Those that take long, and what they are called.
local slow = {answer = "computing the answer", advice = "looking for advice", apply = "thickening",
  optimise = "optimising", unit = "reading the file", thickness = "reading the file"}
for name, what in pairs(slow) do
  handlers[name] = function(self, _, _, given)
    return long(self, what, self.bench[name], self.bench, given)
  end
end

function handlers.save(self, client, message)
  if self.folder then return export(self, client, {id = message.id, format = "lua"}) end -- of a dropped file
  local path, why, details = self.bench:save {path = self.save}
  if not path then return nil, why, details end
  return true
end

function handlers.probe(self, client, message, given)
  local found, why, details = self.bench:probe(given)
  if not found then return nil, why, details end
  notify(self, client, {type = "probe", id = message.id, point = found.point, von_mises = found.von_mises,
    displacement = found.displacement})
  return true
end

function handlers.cancel() return true end -- nothing to stop

-- A shape that is tried: its coarse stresses go to the pages, the workbench stays as it is.
function handlers.drag(self, _, _, given)
  local start = core.seconds()
  local answer, static, more = self.bench:try(given)
  if not answer then return nil, static, more end
  self.latency = 1e3 * (core.seconds() - start)
  local bytes = static and frame.result(static, more.labels, self.bench:current().revision)
  if bytes then
    send_all(self, bytes, "scene")
    self.shown = nil -- the scene is that of the drag
  end
  notify_all(self, {type = "drag", answer = answer, latency_ms = self.latency})
  return true
end

-- What will be dragged if anything is: `idle` prepares it.
function handlers.prepare(self, _, _, given)
  self.likely = given
  return true
end

-- What belongs to the message and not to the action.
local function options_of(message)
  local given = {}
  for key, value in pairs(message) do
    if key ~= "id" and key ~= "do" and key ~= "type" and value ~= json.null then given[key] = value end
  end
  return given
end

local function act(self, client, message)
  local name = message["do"]
  local handler = type(name) == "string" and handlers[name]
  if not handler then
    return nil, ("there is no action '%s'"):format(live_check.shown(name)), {status = "misuse"}
  end
  if not (self.bench and self.bench:current()) then
    return nil, "No part is open: drop a file first.", {status = "misuse"}
  end
  return handler(self, client, message, options_of(message))
end

local function take(self, client, message)
  self.message = nil
  local ok, result, why, details = pcall(act, self, client, message)
  if ok and result == nil then
    if not shared.stopped(details) then
      say(self, lengths(tostring(why)), details)
      notify(self, client, {type = "refused", id = message.id, request = message["do"],
        message = self.message.text})
    end
  elseif not ok then
    say(self, (tostring(result):gsub("^[^\n:]+:%d+: ", "")), {status = "misuse"})
    notify(self, client, {type = "refused", id = message.id, request = message["do"], message = self.message.text})
  else
    notify(self, client, {type = "done", id = message.id, request = message["do"], message = why})
  end
  if message["do"] ~= "drag" and message["do"] ~= "prepare" then publish(self) end
end

-- ---- opening ---------------------------------------------------------------------------------------

-- Opens a file in place of the part before: its surface is sent at once, then it is repaired.
local function open(self, path, unit, name)
  if type(path) ~= "string" then return nil, "open: 'path': the name of a file expected", {status = "misuse"} end
  local bench, why, details = model.try(workbench.read, path, {unit = unit}, true)
  if not bench then return nil, why, details end
  send_scene(self, frame.raw(bench.source.read.surface, 0))
  local ready
  ready, why, details = long(self, "checking the surface", bench.prepare, bench)
  if not ready then return nil, why, details end
  bench.name = name
  self.bench, self.shown, self.likely, self.prepared, self.part = bench, nil, nil, nil, self.part + 1
  function bench.on_answer() publish(self) end
  return true
end

-- A dropped file: QUERY, a line feed, the bytes. It is kept in a temporary folder while it is open; a page never
-- names a place on the disk.
local function upload(self, text)
  local query, bytes = text:match "^([^\n]*)\n(.*)$"
  local name = (query:match "name=([^&]*)" or "part.stl"):gsub("%%(%x%x)", function(digits)
    return string.char(tonumber(digits, 16))
  end)
  name = name:gsub("[^%w_. -]", "_"):gsub("^[. ]+", "")
  self.message = nil
  local folder, why, details = core.temporary_folder()
  if folder and model.ending(name) == "lua" then
    folder, why, details = nil, "A script is not run from a page: open it with `barwright open`.", nil
  end
  local file = folder and io.open(folder.path .. "/" .. name, "wb")
  local ok
  if file then
    file:write(bytes)
    file:close()
    ok, why, details = open(self, folder.path .. "/" .. name, nil, name)
  end
  if ok then
    if self.folder then self.folder:close() end
    self.folder = folder
  elseif not shared.stopped(details) then
    say(self, (tostring(why or "the file cannot be kept"):gsub("^[^:]*/([^/:]+:)", "%1")), details)
    if folder then folder:close() end
  end
  publish(self)
end

--- A controller without a part, or that of a file. about: {save = where scripts go}
function controller.new(server, about)
  return setmetatable({server = server, clients = {}, later = {}, part = 0, save = about and about.save},
    controller)
end

--- Opens a file; nil, message, details where it cannot be read.
function controller:open(path, unit)
  local ok, why, details = open(self, path, unit)
  if not ok then return nil, why, details end
  publish(self)
  return true
end

--- A workbench that was made already is served.
function controller:show(bench)
  self.bench, self.shown = bench, nil
  function bench.on_answer() publish(self) end
  publish(self)
end

local function read(text)
  local value, why = json.decode(text)
  if value == nil then return nil, "not JSON: " .. tostring(why) end
  if not live_check.is_object(value) or type(value["do"]) ~= "string" then
    return nil, "a JSON object with a 'do' expected"
  end
  value.type = value["do"] == "drag" and "move" or "action" -- of drags in a row only the newest counts
  return value
end

local function take_whole(self, client, message)
  take(self, client, message)
  return true
end

local events = {read = read, open = open_window, upload = upload,
  close = function(self, client) self.clients[client] = nil end,
  handlers = {action = take_whole, move = take_whole}}

--- Handles what arrived: {client, "open" | "message" | "close", text}, ...
function controller:handle(list)
  shared.handle(self, list, events)
end

-- ---- while nobody asks for anything ----------------------------------------------------------------

-- Whether an event ends the preparation of a drag: not a drag, which needs it.
local function ends_preparation(self)
  return function(client, kind, text)
    if kind == "open" then open_window(self, client) end
    if kind ~= "message" then return kind == "upload", true end
    local message = #text < 65536 and json.decode(text)
    local asked = live_check.is_object(message) and message["do"]
    return asked ~= "drag" and asked ~= "prepare", true
  end
end

--- Prepares the drag of what is likely to be dragged, once for each state of the part; a request of a person stops
--- that, and it begins again afterwards.
function controller:idle()
  local bench = self.bench
  local entry = bench and bench:current()
  while entry and not core.interrupted()
    and (self.prepared ~= entry.revision or self.prepared_for ~= self.likely) do
    local revision, likely = entry.revision, self.likely
    local ok, made, _, details = pcall(shared.meanwhile, self, ends_preparation(self), bench.prepare_drag, bench,
      likely)
    if not (ok and made == nil and shared.stopped(details)) then
      self.prepared, self.prepared_for = revision, likely -- also where it cannot be dragged
    end
    self:handle {}
    bench = self.bench
    entry = bench and bench:current()
  end
end

--- The session will not go on: the pages are informed.
function controller:finish()
  notify_all(self, {type = "closing"})
  if self.folder then self.folder:close() end
  self.folder = nil
end

return controller
