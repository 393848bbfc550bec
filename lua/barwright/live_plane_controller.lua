-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The controller of the plane's live view: takes the messages of the pages, moves the outline of an object of
-- bw.responsive, lets its time go on, reports to every page how it stands. docs/live.md has the protocol.
--
-- The object changes by whole edits: each is an outline and a line of Lua, kept in `history`; a drag,
-- however long, is one. A move of a drag starts from the outline where the drag began, so that moves
-- need no order and a newer one takes the place of all that wait. What the outline, the mesh or the
-- solution refuses leaves the last good state, and is reported to the page that asked.
local core = require "barwright.core"
local edits = require "barwright.live_plane_edits"
local followed = require "barwright.followed"
local json = require "barwright.json"
local kinds = require "barwright.live_plane_kinds"
local live_check = require "barwright.live_check"
local live_plane_frame = require "barwright.live_plane_frame"
local live_plane_message = require "barwright.live_plane_message"
local shared = require "barwright.live_session"

local notify, notify_all, refuse, send_all = shared.notify, shared.notify_all, shared.refuse, shared.send_all
local own_drag, no_drag = shared.own_drag, shared.no_drag

local controller = {}
controller.__index = controller

-- Seconds between frames of what goes on in time, at least, and for the steps of one frame, at most.
local frame_time, step_time = 1 / 60, 0.05
-- Edits that are taken back to the very state they left; earlier ones are solved for again.
local states_kept = 50

-- ---- reports -------------------------------------------------------------------------------------

local function size_of(outline)
  local box = outline.box
  return math.sqrt((box.max[1] - box.min[1]) ^ 2 + (box.max[2] - box.min[2]) ^ 2)
end

local function drag_of(drag)
  return drag and {client = drag.client, seq = drag.seq} or nil
end

local function lines(self)
  local list = {}
  for i = 2, self.position do list[#list + 1] = self.history[i].line end
  return list
end

local function last_lines(self)
  local all, list = lines(self), json.list {}
  for i = math.max(1, #all - 19), #all do list[#list + 1] = all[i] end
  return list
end

-- Fields that some window looks at.
local function shown(self)
  local keys = {}
  for _, key in pairs(self.clients) do keys[key] = true end
  keys[self.kind.fields[1].key] = true
  return keys
end

-- Reports how the object stands. What stays is reported again only where it is another one.
local function publish(self)
  local object = self.object
  if not (self.scene and object.outline:same_topology(self.scene.outline)) then
    self.size = size_of(object.outline)
    local id = self.scene and self.scene.id + 1 or 1
    self.scene = {id = id, outline = object.outline, bytes = live_plane_frame.scene(self, id)}
    send_all(self, self.scene.bytes, "scene")
  end
  local level
  local triangles = live_plane_frame.triangles(object)
  if not (self.mesh and self.mesh.triangles == triangles) then
    local id = self.mesh and self.mesh.id + 1 or 1
    -- an analysis that began again calls its mesh its first
    if self.mesh and object.reused.level == "none" then
      level = "reconstruction"
      self.levels.none = math.max(0, (self.levels.none or 0) - 1)
      self.levels[level] = (self.levels[level] or 0) + 1
    end
    self.mesh = {id = id, triangles = triangles, bytes = live_plane_frame.mesh(object, id, triangles)}
    send_all(self, self.mesh.bytes, "mesh")
  end
  self.revision = self.revision + 1
  local header = {level = level, scene = self.scene.id, mesh = self.mesh.id, revision = self.revision,
    seconds = self.seconds, levels = self.levels, limit = self.limit, edits = self.position - 1,
    can_undo = self.position > 1, can_redo = #self.history > self.position,
    script = last_lines(self), drag = drag_of(self.drag), failure = self.failure}
  if self.steps then header.running, header.pace = self.running, self.pace end
  self.state = live_plane_frame.state(object, self.kind, shown(self), header)
  send_all(self, self.state, "state")
  return true
end

-- Counts a frame that took so long.
local function frame(self, since)
  self.seconds = core.seconds() - since
  local level = self.object.reused.level
  self.levels[level] = (self.levels[level] or 0) + 1
end

-- The object goes over to an outline, by `back` if that is given: true, or nil and why it stays as it is.
local function become(self, outline, back)
  local since = core.seconds()
  local ok, why, details
  if back then ok, why, details = back() else ok, why, details = self.object:become(outline) end
  if not ok then return nil, why, details end
  frame(self, since)
  self.failure = nil
  return true
end

-- ---- edits ---------------------------------------------------------------------------------------

-- Keeps the lines in the file of edits: before they are reported.
local function keep(self)
  if not self.about.saved then return true end
  local ok, why = edits.write(self.about.saved, self.about.script, lines(self))
  if not ok then return nil, "the edits cannot be kept: " .. tostring(why) end
  return true
end

--- Where nothing is dragged, the object is as the last whole edit left it: it goes back there after
--- something failed, or when the next message comes, where that fails too.
function controller:settle()
  local here = self.history[self.position]
  if self.drag or self.object.outline == here.outline then return end
  local ok, there = pcall(become, self, here.outline, here.back)
  self.unsettled = not (ok and there)
end

-- The edits up to a place of a history are those that count, where they can be kept.
local function take(self, history, position)
  local former, place = self.history, self.position
  self.history, self.position = history, position
  local ok, why = keep(self)
  if not ok then
    self.history, self.position = former, place
    self:settle()
    return nil, why
  end
  return true
end

-- What the object is now, as an edit.
local function push(self, line)
  local history = table.move(self.history, 1, self.position, 1, {})
  history[#history + 1] = {outline = self.object.outline, line = line, back = followed.saved(self.object)}
  local ok, why = take(self, history, #history)
  if not ok then return nil, why end
  local older = history[#history - states_kept]
  if older then older.back = nil end
  return true
end

local function go_to(self, position)
  local to = self.history[position]
  local ok, why = become(self, to.outline, to.back)
  if not ok then return nil, why end
  return take(self, self.history, position)
end

--- What is dragged, in words.
function controller.dragged()
  return "the outline"
end

local handlers = {}

function handlers.begin(self, client, message)
  if not shared.may_begin(self, client, message) then return end
  self.drag = {client = client, seq = message.seq, handle = message.handle, pins = message.pins,
    reach = message.reach, base = self.object.outline, back = followed.saved(self.object)}
end

function handlers.move(self, client, message)
  local drag = own_drag(self, client, message)
  if not drag then return end
  drag.seq = message.seq
  local outline, why, line = edits.dragged(drag.base, drag, message.by)
  local ok = outline
  if outline then ok, why = become(self, outline) end
  if not ok then return refuse(self, client, message, why) end
  drag.line = line
  if message.ends then return end -- the end of the drag is there already
  if self.steps and self.running then return end -- the next step, which is due soon, shows it
  return publish(self)
end

-- The last shape that went well becomes an edit, or the one where the drag began comes back.
local function finish(self, wanted)
  local drag = self.drag
  self.drag = nil
  if not drag.line then return true end
  if wanted then return push(self, drag.line) end
  local ok, why = become(self, drag.base, drag.back)
  if not ok then self:settle() end
  return ok, why
end

local function done(self, client, message, ok, why)
  if not ok then refuse(self, client, message, why) end
  return publish(self)
end

handlers["end"] = function(self, client, message)
  if not own_drag(self, client, message) then return end
  return done(self, client, message, finish(self, not message.cancel))
end

function handlers.edit(self, client, message)
  if not no_drag(self, client, message) then return end
  local outline, why, line = edits.make(self.object, message.edit)
  local ok = outline
  if outline then ok, why = become(self, outline) end
  if not ok then return refuse(self, client, message, why) end
  return done(self, client, message, push(self, line))
end

local function travel(way)
  return function(self, client, message)
    if not no_drag(self, client, message) then return end
    local position = way(self)
    if not self.history[position] then
      return refuse(self, client, message, "there is nothing to " .. message.type)
    end
    return done(self, client, message, go_to(self, position))
  end
end

handlers.undo = travel(function(self) return self.position - 1 end)
handlers.redo = travel(function(self) return self.position + 1 end)
handlers.reset = travel(function() return 1 end)

-- ---- what is looked at ---------------------------------------------------------------------------

function handlers.show(self, client, message)
  self.clients[client] = message.field
  return publish(self)
end

function handlers.limit(self, _, message)
  self.limit = message.von_mises or nil
  return publish(self)
end

--- Whether time goes on, and by how many steps a frame at most.
function handlers.pace(self, client, message)
  if not self.steps then return refuse(self, client, message, "time does not go on here") end
  if message.running ~= nil then self.running = message.running end
  if message.steps then self.pace = math.floor(message.steps) end
  self.failure = nil
  return publish(self)
end

-- ---- tuning --------------------------------------------------------------------------------------

-- Takes what arrived in the midst of work: whether somebody asked to stop.
local function asked_to_stop(self)
  local stop = false
  while #self.later < 1000 do
    local client, kind, text = self.server:receive(0)
    if not client then break end
    if kind == "message" and live_check.is(text, "stop") then
      stop = true
    else
      self.later[#self.later + 1] = {client, kind, text}
    end
  end
  return stop
end

local function tuned_words(report)
  return ("tuned to %.2f Hz (%+.2f cents) by moving the outline by %s at most; this mesh is %.1f "
    .. "cents off a finer one"):format(report.frequency, report.cents,
    core.quantity(report.moved, "m"), report.mesh_cents)
end

function handlers.tune(self, client, message)
  if not no_drag(self, client, message) then return end
  if not self.kind.tune then return refuse(self, client, message, "this has no tone to be tuned") end
  local since, object = core.seconds(), self.object
  local function watch()
    frame(self, since)
    since = core.seconds()
    publish(self)
    notify_all(self, {type = "progress", stage = ("tuning: %.2f Hz, %s"):format(object.frequency, object.note)})
    return not (asked_to_stop(self) or core.interrupted())
  end
  notify_all(self, {type = "progress", stage = "tuning"})
  local report, why = object:tune(message.target, {watch = watch, pins = message.pins})
  local words = report and tuned_words(report) or why == "stopped" and "stopped: the shape is as it was" or why
  notify_all(self, {type = "tuned", met = report ~= nil, message = words})
  if not report then return publish(self) end
  return done(self, client, message, push(self, edits.tuned(message.target, message.pins)))
end

--- Nothing to stop.
function handlers.stop() end

-- ---- files ---------------------------------------------------------------------------------------

local mimes = {svg = "image/svg+xml", dxf = "image/vnd.dxf", lua = "text/plain; charset=utf-8"}

function handlers.export(self, client, message)
  local format = message.format
  local bytes, why
  if format == "lua" then
    bytes = edits.text(self.about.script or "the_script_that_made_it.lua", lines(self))
  else
    bytes, why = shared.written("." .. format, function(path) return self.object.outline:write(path) end)
  end
  if not bytes then return refuse(self, client, message, why) end
  local path = "outline." .. format
  self.server:serve(path, mimes[format], bytes, self.about.name .. "." .. format)
  notify(self, client, {type = "file", path = path, format = format, bytes = #bytes})
end

-- ---- time ----------------------------------------------------------------------------------------

--- Seconds until `idle` is to be called.
function controller:wait()
  if not (self.steps and self.running and next(self.clients)) then return 3600 end
  return math.max(0, self.due - core.seconds())
end

-- Steps, as many as a frame has time for by what the last ones took, as one frame with the drags before.
local function advance(self)
  local since = core.seconds()
  local count = math.max(1, math.min(self.pace, math.floor(step_time / self.a_step)))
  local ok, why = self.object:step(count)
  if not ok then return nil, why end
  self.a_step = math.max(1e-6, (core.seconds() - since) / count)
  frame(self, since)
  return true
end

--- A frame of what goes on in time, where one is due. What fails stops the time.
function controller:idle()
  local now = core.seconds()
  if not (self.steps and self.running and next(self.clients)) or now < self.due then return end
  local ok, stepped, why = pcall(advance, self)
  if not ok or not stepped then
    self.running = false
    self.failure = tostring(ok and why or stepped)
  end
  publish(self)
  self.due = now + frame_time
end

-- ---- the controller ------------------------------------------------------------------------------------

--- A controller for an object of bw.responsive. about: {title, name, limit, saved = file of edits, script =
--- the script that makes the object as seen from that file, lines = edits of it to be made first,
--- paused, pace = steps a frame, goal = an outline to be met}
function controller.new(object, server, about)
  local kind = kinds.of(object)
  local steps = kind.steps
  if type(steps) == "function" then steps = steps(object) end
  about = {title = about.title or kind.title, name = about.name or "outline", limit = about.limit,
    saved = about.saved, script = about.script, lines = about.lines or {}, pace = about.pace,
    paused = about.paused, goal = about.goal}
  local self = setmetatable({object = object, server = server, kind = kind, about = about,
    clients = {}, later = {}, levels = {}, revision = 0, seconds = 0, size = size_of(object.outline),
    limit = about.limit or kind.limit and kind.limit(object),
    steps = steps or false, running = not about.paused, pace = about.pace or 1,
    due = 0, a_step = 1e-3, position = 1,
    history = {{outline = object.outline, back = followed.saved(object)}}}, controller)
  for i, line in ipairs(about.lines) do
    local ok, why = edits.replay(object, line)
    if not ok then return nil, ("edit %d, %s: %s"):format(i, line, why), {status = "format"} end
    self.position = i + 1
    self.history[self.position] = {outline = object.outline, line = line, back = followed.saved(object)}
  end
  local ok, why = keep(self)
  if not ok then return nil, why, {status = "io"} end
  publish(self)
  return self
end

local function open(self, client)
  self.clients[client] = self.kind.fields[1].key
  notify(self, client, {type = "welcome", client = client, saved = self.about.saved})
  self.server:send(client, self.scene.bytes, {binary = true, replace = "scene"})
  self.server:send(client, self.mesh.bytes, {binary = true, replace = "mesh"})
  self.server:send(client, self.state, {binary = true, replace = "state"})
end

-- A window that is closed ends its drag.
local function close(self, client)
  shared.leave(self, client, function()
    finish(self, true)
    return publish(self)
  end)
end

local events = {read = live_plane_message.read, open = open, close = close, handlers = handlers}

--- Handles what arrived: {client, "open" | "message" | "close", text}, ...
function controller:handle(list)
  if self.unsettled then self:settle() end
  shared.handle(self, list, events)
end

--- The view will not go on: a drag is ended, the pages are informed.
function controller:finish()
  if self.drag then pcall(finish, self, true) end
  notify_all(self, {type = "closing"})
end

return controller
