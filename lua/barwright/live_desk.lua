-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The live view's desk: takes the messages of the pages, edits the session, tells every page how it
-- stands. docs/live.md has the protocol.
--
-- Nothing of a message is believed: live_message checks it whole before anything is done, and what
-- the session refuses is told to the page that asked. The session changes by whole edits only. While
-- a handle is dragged, edits are tried on a fork; the end of the drag makes one edit of it.
--
-- `server` needs send(client, bytes, options), serve(path, mime, bytes, download) and receive(0), so
-- that tests can put a table in its place.
local core = require "barwright.core"
local json = require "barwright.json"
local live_frame = require "barwright.live_frame"
local live_message = require "barwright.live_message"

local desk = {}
desk.__index = desk

local function state_of(session)
  return session.history[session.position]
end

-- ---- telling -------------------------------------------------------------------------------------

-- A browser closes a socket on text that is not UTF-8; names of bones come from files.
local function tell(self, client, message)
  local text = json.encode(message)
  self.server:send(client, utf8.len(text) and text or (text:gsub("[\128-\255]", "?")))
end

local function tell_all(self, message)
  for client in pairs(self.clients) do tell(self, client, message) end
end

local function refuse(self, client, message, why)
  tell(self, client, {type = "refused", asked = message.type, seq = message.seq, message = why})
end

local function history(session)
  local list = json.list {}
  for i = math.max(2, session.position - 19), session.position do
    list[#list + 1] = session.history[i].script
  end
  return list
end

-- How long a solve may take before the shape is shown without waiting for it.
local patience = 0.1

local function send_all(self, bytes, key)
  for client in pairs(self.clients) do
    self.server:send(client, bytes, {binary = true, replace = key})
  end
end

-- Solves a session or a fork and puts its state in place of the one before. Where it cannot be
-- solved, the shape is told all the same, and why.
local function publish(self, shown)
  local state, start = state_of(shown), core.seconds()
  if self.scene.topology ~= state.topology then
    local scene, why = live_frame.scene(state, self.scene.id + 1, self.about)
    if not scene then return nil, why end
    self.scene = scene
    send_all(self, scene.bytes, "scene")
  end
  if self.seconds > patience then send_all(self, live_frame.shape(self.scene, state), "shape") end
  local result, why = shown:solve(self.about.solve)
  self.seconds = core.seconds() - start
  self.revision = self.revision + 1
  local drag = self.drag
  local bytes = live_frame.state(self.scene, state, result, {
    revision = self.revision, seconds = self.seconds, limit = self.limit,
    trouble = not result and why or nil, edits = self.session.position - 1,
    can_undo = self.session.position > 1, can_redo = #self.session.history > self.session.position,
    script = history(self.session),
    drag = drag and {client = drag.client, bone = drag.bone, seq = drag.seq} or nil})
  self.state = bytes
  send_all(self, bytes, "state")
  return true
end

-- ---- editing -------------------------------------------------------------------------------------

-- Makes a checked change on a session or a fork.
local function apply(session, name, change)
  local bone = session:bone(name)
  if change.rotate then return bone:rotate {axis = change.rotate.axis, degrees = change.rotate.degrees} end
  if change.scale then return bone:scale(change.scale) end
  if change.translate then return bone:translate(change.translate) end
  if change.reset then return bone:reset() end
  return session:reach({{bone = name, at = change.reach}})
end

-- One try of a drag: from where it began, so the one before is taken back first.
local function try(drag, change)
  local fork = drag.fork
  if fork.position > 1 then assert(fork:undo()) end
  drag.wanted = change
  local fine, why = apply(fork, drag.bone, change)
  if fine then
    drag.good, drag.refused = change, false
    return true
  end
  drag.refused = true
  if #fork.history > 1 then assert(fork:redo()) end
  return nil, why
end

local handlers = {}

function handlers.begin(self, client, message)
  if self.drag then
    return refuse(self, client, message, ("bone %s is being dragged in %s window"):format(self.drag.bone,
      self.drag.client == client and "this" or "another"))
  end
  self.drag = {client = client, bone = message.bone, seq = message.seq, good = false,
    fork = self.session:fork {refill = false}}
end

local function own_drag(self, client, message)
  if self.drag and self.drag.client == client then return self.drag end
  refuse(self, client, message, "no drag of this window is going on")
end

function handlers.move(self, client, message)
  local drag = own_drag(self, client, message)
  if not drag then return end
  drag.seq = message.seq
  local fine, why = try(drag, message.change)
  if not fine then return refuse(self, client, message, why) end
  return publish(self, drag.fork)
end

-- The last change that went well becomes an edit. Where the last one asked for was refused, the
-- session is asked again, since it may fill in new elements, which takes too long for a drag.
local function finish(self, keep)
  local drag = self.drag
  self.drag = nil
  local why
  if keep and drag.refused then
    local fine
    fine, why = apply(self.session, drag.bone, drag.wanted)
    keep = not fine
  end
  if keep and drag.good then assert(apply(self.session, drag.bone, drag.good)) end
  return why
end

handlers["end"] = function(self, client, message)
  if not own_drag(self, client, message) then return end
  local why = finish(self, not message.cancel)
  if why then refuse(self, client, message, why) end
  return publish(self, self.session)
end

local function no_drag(self, client, message)
  if not self.drag then return true end
  refuse(self, client, message, ("bone %s is being dragged"):format(self.drag.bone))
end

local function edit(self, client, message, fine, why)
  if not fine then return refuse(self, client, message, why) end
  return publish(self, self.session)
end

function handlers.edit(self, client, message)
  if not no_drag(self, client, message) then return end
  return edit(self, client, message, apply(self.session, message.bone, message.change))
end

for _, word in ipairs {"undo", "redo", "reset"} do
  handlers[word] = function(self, client, message)
    if not no_drag(self, client, message) then return end
    return edit(self, client, message, self.session[word](self.session))
  end
end

function handlers.limit(self, _, message)
  self.limit = message.von_mises or nil
  return publish(self, self.drag and self.drag.fork or self.session)
end

-- ---- optimising ----------------------------------------------------------------------------------

-- While the engine works: tells how far it is, and keeps what arrives for later. False when a page
-- asked to stop.
local function watch(self)
  local shown, going = -1, true
  return function(stage, fraction)
    local now = core.seconds()
    if now - shown > 0.2 then
      shown = now
      tell_all(self, {type = "progress", stage = stage, fraction = fraction})
    end
    while #self.later < 1000 do
      local client, kind, text = self.server:receive(0)
      if not client then break end
      if kind == "message" and live_message.is_stop(text) then
        going = false
      else
        self.later[#self.later + 1] = {client, kind, text}
      end
    end
    return going
  end
end

function handlers.optimise(self, client, message)
  if not no_drag(self, client, message) then return end
  self.limit = message.von_mises
  tell_all(self, {type = "progress", stage = "optimising", fraction = 0})
  local before = core.progress(watch(self))
  local fine, report, why, details = pcall(self.session.optimise, self.session,
    {von_mises = message.von_mises, low = message.low, high = message.high, bones = message.bones})
  core.progress(before)
  if not fine then
    report, why = nil, tostring(report)
  elseif not report and details and details.status == "cancelled" then
    why = "stopped: the shape is as it was"
  end
  tell_all(self, {type = "optimised", met = report ~= nil, message = report and tostring(report) or why})
  return publish(self, self.session)
end

--- Nothing to stop.
function handlers.stop() end

-- ---- files ---------------------------------------------------------------------------------------

-- What a function writes to a path, as text.
local function written(ending, write)
  local name = os.tmpname()
  local path = name .. ending
  local fine, why = write(path)
  local file = fine and io.open(path, "rb")
  local bytes = file and file:read "a"
  if file then file:close() end
  os.remove(path)
  os.remove(name)
  return bytes, why or "a temporary file could not be read"
end

local files = {
  stl = {path = "part.stl", mime = "model/stl", write = function(session, path)
    local surface, why = session:surface()
    if not surface then return nil, why end
    return surface:write(path)
  end},
  lua = {path = "edits.lua", mime = "text/plain; charset=utf-8", write = function(session, path)
    return session:save(path)
  end},
}

function handlers.export(self, client, message)
  local file = files[message.format]
  local bytes, why = written("." .. message.format, function(path) return file.write(self.session, path) end)
  if not bytes then return refuse(self, client, message, why) end
  self.server:serve(file.path, file.mime, bytes, self.about.name .. "." .. message.format)
  tell(self, client, {type = "file", path = file.path, format = message.format, bytes = #bytes})
end

-- ---- the desk ------------------------------------------------------------------------------------

--- A desk for a session. about: {title, name, solve = options of session:solve, limit}
function desk.new(session, server, about)
  local state = state_of(session)
  local material = session.source.material
  local strength = type(material.strength) == "number" and material.strength or nil
  about = {title = about.title or "Edit session", name = about.name or "part", strength = strength,
    solve = about.solve or (#session.source.supports == 0 and {inertia_relief = true} or nil),
    limit = about.limit}
  local self = setmetatable({session = session, server = server, about = about, clients = {},
    revision = 0, seconds = 0, later = {}, limit = about.limit or strength, drag = nil}, desk)
  local scene, why, details = live_frame.scene(state, 1, about)
  if not scene then return nil, why, details end
  self.scene = scene
  local fine
  fine, why = publish(self, session)
  if not fine then return nil, why, {status = "geometry"} end
  return self
end

local function open(self, client)
  self.clients[client] = true
  tell(self, client, {type = "welcome", client = client, saved = self.about.saved})
  self.server:send(client, self.scene.bytes, {binary = true, replace = "scene"})
  self.server:send(client, self.state, {binary = true, replace = "state"})
end

-- Runs a handler. What neither a check nor the session caught is told too; the session is then as
-- the last whole edit left it.
local function protected(self, client, message, handler)
  local fine, result, why = pcall(handler, self, client, message)
  if fine and (result ~= nil or not why) then return end
  if self.drag and self.drag.client == client then self.drag = nil end
  refuse(self, client, message, tostring(fine and why or result))
end

-- A window that is closed ends its drag.
local function close(self, client)
  self.clients[client] = nil
  if self.drag and self.drag.client == client then
    protected(self, client, {type = "end"}, function()
      finish(self, true)
      return publish(self, self.session)
    end)
  end
end

-- Events with their messages read; of moves of one window in a row only the newest counts.
local function read_all(self, events)
  local out, last = {}, nil
  for _, event in ipairs(events) do
    local client, kind, text = event[1], event[2], event[3]
    local entry = {client = client, kind = kind}
    if kind == "message" then
      entry.message, entry.why = live_message.read(text, self)
    end
    if last and entry.message and last.message and entry.message.type == "move"
      and last.message.type == "move" and last.client == client then
      last.message = entry.message
    else
      out[#out + 1], last = entry, entry
    end
  end
  return out
end

--- Handles what arrived: {client, "open" | "message" | "close", text}, ...
function desk:handle(events)
  for _, entry in ipairs(read_all(self, events)) do
    if entry.kind == "open" then
      open(self, entry.client)
    elseif entry.kind == "close" then
      close(self, entry.client)
    elseif entry.message then
      protected(self, entry.client, entry.message, handlers[entry.message.type])
    else
      tell(self, entry.client, {type = "error", message = entry.why})
    end
    if core.interrupted() then return end
  end
  if #self.later > 0 then
    local later = self.later
    self.later = {}
    self:handle(later)
  end
end

--- The session will not go on: a drag is ended, the pages are told.
function desk:finish()
  if self.drag then pcall(finish, self, true) end
  tell_all(self, {type = "bye"})
end

return desk
