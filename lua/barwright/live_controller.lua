-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The live view's controller: takes the messages of the pages, edits the session, reports to every page how it
-- stands. docs/live.md has the protocol.
--
-- Nothing of a message is believed: live_message checks it whole before anything is done, and what
-- the session refuses is reported to the page that asked. The session changes by whole edits only. While
-- a handle is dragged, edits are tried on a fork; the end of the drag makes one edit of it. A drag
-- never lags behind the hand: its solve is given up when a newer move is there.
--
-- `server` needs send(client, bytes, options), serve(path, mime, bytes, download) and receive(0), so
-- that tests can put a table in its place.
local core = require "barwright.core"
local json = require "barwright.json"
local live_frame = require "barwright.live_frame"
local live_loads = require "barwright.live_loads"
local live_message = require "barwright.live_message"
local shared = require "barwright.live_session"

local notify, notify_all, refuse, send_all = shared.notify, shared.notify_all, shared.refuse, shared.send_all
local own_drag, no_drag = shared.own_drag, shared.no_drag

local controller = {}
controller.__index = controller

local function state_of(session)
  return session.history[session.position]
end

-- ---- reports -------------------------------------------------------------------------------------

local function history(session)
  local list = json.list {}
  for i = math.max(2, session.position - 19), session.position do
    list[#list + 1] = session.history[i].script
  end
  return list
end

-- Seconds that a solve may take before the shape is shown without waiting for it.
local time_limit = 0.1
-- Seconds that a drag may go without new stresses: then a solve is seen through however the hand moves.
local longest = 2

-- Whether what arrived makes the stresses of a drag's move obsolete: its end does, and for a while
-- whatever else is of the same window.
local function overtakes(self)
  local drag, since = self.drag, self.reported_at
  return function(client, kind, text)
    if client ~= drag.client then return false end
    return kind == "close" or live_message.is(text, "end")
      or core.seconds() < since + math.max(longest, 2 * self.seconds), true
  end
end

local function drag_of(drag)
  return drag and {client = drag.client, bone = drag.bone, joint = drag.joint, seq = drag.seq} or nil
end

-- Solves a session or a fork and puts its state in place of the one before. Where it cannot be
-- solved, the shape is reported all the same, and why. The stresses of a drag are left out when a newer
-- move is there first.
local function publish(self, shown)
  local state, start, drag = state_of(shown), core.seconds(), self.drag
  if self.scene.topology ~= state.topology then
    local scene, why = live_frame.scene(state, self.scene.id + 1, self.about)
    if not scene then return nil, why end
    self.scene = scene
    send_all(self, scene.bytes, "scene")
  end
  if self.seconds > time_limit then
    send_all(self, live_frame.shape(self.scene, state, drag_of(drag)), "shape")
  end
  local result, why, details
  if drag and self.seconds > time_limit then
    result, why, details = shared.meanwhile(self, overtakes(self), live_loads.solve, self, shown)
  else
    result, why, details = live_loads.solve(self, shown)
  end
  if not result and drag and details and details.status == "cancelled" then return true end
  self.reported_at = core.seconds()
  self.seconds = self.reported_at - start
  self.revision = self.revision + 1
  local bytes = live_frame.state(self.scene, state, result, {
    revision = self.revision, seconds = self.seconds, limit = self.limit,
    failure = not result and why or nil, edits = self.session.position - 1,
    can_undo = self.session.position > 1, can_redo = #self.session.history > self.session.position,
    script = history(self.session), loads = live_loads.shown(self), ties = self.ties,
    drag = drag_of(drag)})
  self.state = bytes
  send_all(self, bytes, "state")
  return true
end

-- ---- editing -------------------------------------------------------------------------------------

-- A joint gets to a place by turning bones; the root takes everything along.
local function move_joint(session, name, at)
  local skeleton = session.skeleton
  if name ~= skeleton.root then return session:reach({{joint = name, at = at}}) end
  local joint = skeleton:joint(name)
  local now, changes = session.joints:rows(joint.index, joint.index):totable()[1], {}
  for _, bone_name in ipairs(joint.bones) do
    local by = session:bone(bone_name).translation
    for k = 1, 3 do by[k] = by[k] + at[k] - now[k] end
    changes[bone_name] = {translation = by}
  end
  return session:pose(changes)
end

-- Makes a checked change of a bone or a joint, {bone = } or {joint = }, on a session or a fork.
local function apply(session, of, change)
  if of.joint then return move_joint(session, of.joint, change.reach) end
  local name = of.bone
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
  local ok, why = apply(fork, drag, change)
  if ok then
    drag.good, drag.refused = change, false
    return true
  end
  drag.refused = true
  if #fork.history > 1 then assert(fork:redo()) end
  return nil, why
end

--- What is dragged, in words.
function controller:dragged()
  return self.drag.bone or self.drag.joint
end

local handlers = {}

function handlers.begin(self, client, message)
  if not shared.may_begin(self, client, message) then return end
  self.drag = {client = client, bone = message.bone, joint = message.joint, seq = message.seq,
    good = false, fork = self.session:fork {refill = false}}
  self.reported_at = core.seconds() -- the time without new stresses begins here
end

function handlers.move(self, client, message)
  local drag = own_drag(self, client, message)
  if not drag then return end
  drag.seq = message.seq
  if drag.joint and not message.change.reach then
    return refuse(self, client, message, "a joint is moved by 'reach'")
  end
  local ok, why = try(drag, message.change)
  if not ok then return refuse(self, client, message, why) end
  if message.ends then return end -- the end of the drag is there already
  return publish(self, drag.fork)
end

-- The last change that went well becomes an edit. Where the last one asked for was refused, the
-- session is asked again, since it may fill in new elements, which takes too long for a drag.
local function finish(self, keep)
  local drag = self.drag
  self.drag = nil
  local why
  if keep and drag.refused then
    local ok
    ok, why = apply(self.session, drag, drag.wanted)
    keep = not ok
  end
  if keep and drag.good then assert(apply(self.session, drag, drag.good)) end
  return why
end

handlers["end"] = function(self, client, message)
  if not own_drag(self, client, message) then return end
  local why = finish(self, not message.cancel)
  if why then refuse(self, client, message, why) end
  return publish(self, self.session)
end

local function edit(self, client, message, ok, why)
  if not ok then return refuse(self, client, message, why) end
  return publish(self, self.session)
end

function handlers.edit(self, client, message)
  if not no_drag(self, client, message) then return end
  if message.joint and not message.change.reach then
    return refuse(self, client, message, "a joint is moved by 'reach'")
  end
  return edit(self, client, message, apply(self.session, message, message.change))
end

-- How far a bone may turn when a joint is reached for.
function handlers.joint_limits(self, client, message)
  if not no_drag(self, client, message) then return end
  local limit = {swing = message.swing or nil, twist = message.twist or nil}
  return edit(self, client, message,
    self.session:limit(message.bone, next(limit) and limit or nil))
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

--- Bones that change alike when the part is made strong enough.
function handlers.ties(self, _, message)
  self.ties = message.ties
  return publish(self, self.drag and self.drag.fork or self.session)
end

-- ---- optimising ----------------------------------------------------------------------------------

function handlers.optimise(self, client, message)
  if not no_drag(self, client, message) then return end
  self.limit = message.von_mises
  local report, why, details = shared.with_progress(self, "optimising", self.session.optimise, self.session,
    {von_mises = message.von_mises, min_factor = message.min_factor, max_factor = message.max_factor,
      bones = message.bones,
      ties = self.ties, loads = self.loads.kind, worst = self.about.worst,
      move_supports = message.move_supports})
  if not report and shared.stopped(details) then why = "stopped: the shape is as it was" end
  notify_all(self, {type = "optimised", met = report ~= nil, message = report and tostring(report) or why})
  return publish(self, self.session)
end

--- Which loads the stresses are of: the part's own, or the worst ones of the shape as it is.
function handlers.loads(self, client, message)
  if not no_drag(self, client, message) then return end
  if message.loads == "worst" then
    local ok, why, details = shared.with_progress(self, "looking for the worst load", live_loads.find, self)
    if not ok and shared.stopped(details) then why = "stopped: the loads are what they were" end
    notify_all(self, {type = "optimised", met = ok ~= nil, message = ok and live_loads.words(self) or why})
    if not ok then return publish(self, self.session) end
  else
    live_loads.own(self)
  end
  return publish(self, self.session)
end

--- Nothing to stop.
function handlers.stop() end

-- ---- files ---------------------------------------------------------------------------------------

local files = {
  stl = {path = "part.stl", mime = "model/stl", write = function(session, path)
    local report, why = session:export(path)
    if not report then return nil, why end
    return true, tostring(report)
  end},
  lua = {path = "edits.lua", mime = "text/plain; charset=utf-8", write = function(session, path)
    return session:save(path)
  end},
}

function handlers.export(self, client, message)
  local file = files[message.format]
  local note
  local function write(path)
    local ok, words = file.write(self.session, path)
    if not ok then return nil, words end
    note = message.format == "stl" and words or nil
    return true
  end
  local bytes, why = shared.written("." .. message.format, write)
  if not bytes then return refuse(self, client, message, why) end
  self.server:serve(file.path, file.mime, bytes, self.about.name .. "." .. message.format)
  notify(self, client, {type = "file", path = file.path, format = message.format, bytes = #bytes,
    note = note})
end

-- ---- the controller ------------------------------------------------------------------------------------

--- A controller for a session. about: {title, name, solve = options of session:solve, limit, worst = options
--- of bw.worst_case, ties}
function controller.new(session, server, about)
  local state = state_of(session)
  local material = session.source.material
  local strength = type(material.strength) == "number" and material.strength or nil
  about = {title = about.title or "Edit session", name = about.name or "part", strength = strength,
    solve = about.solve or (#session.source.supports == 0 and {inertia_relief = true} or nil),
    limit = about.limit, worst = about.worst, ties = about.ties}
  local self = setmetatable({session = session, server = server, about = about, clients = {},
    revision = 0, seconds = 0, reported_at = 0, later = {}, limit = about.limit or strength,
    loads = {kind = "own"}, ties = json.list(about.ties or {}), drag = nil}, controller)
  local scene, why, details = live_frame.scene(state, 1, about)
  if not scene then return nil, why, details end
  self.scene = scene
  local ok
  ok, why = publish(self, session)
  if not ok then return nil, why, {status = "geometry"} end
  return self
end

local function open(self, client)
  self.clients[client] = true
  notify(self, client, {type = "welcome", client = client, saved = self.about.saved})
  self.server:send(client, self.scene.bytes, {binary = true, replace = "scene"})
  self.server:send(client, self.state, {binary = true, replace = "state"})
end

-- A window that is closed ends its drag.
local function close(self, client)
  shared.leave(self, client, function()
    finish(self, true)
    return publish(self, self.session)
  end)
end

local events = {read = live_message.read, open = open, close = close, handlers = handlers}

--- Handles what arrived: {client, "open" | "message" | "close", text}, ...
function controller:handle(list)
  shared.handle(self, list, events)
end

--- The session will not go on: a drag is ended, the pages are informed.
function controller:finish()
  if self.drag then pcall(finish, self, true) end
  notify_all(self, {type = "closing"})
end

return controller
