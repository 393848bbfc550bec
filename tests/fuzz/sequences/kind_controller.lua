-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The controller of a live view in the plane, with windows that are not there: messages as they come from pages.
local acting = require "acting"
local bw = require "barwright"
local core = require "barwright.core"
local followed_kinds = require "followed_kinds"
local live_plane_controller = require "barwright.live_plane_controller"

local kind = {}
local text_of, uniform = followed_kinds.text_of, followed_kinds.uniform

-- Takes what is sent, and has received nothing.
local server = {}
function server.send() return true end
function server.serve() return true end
function server.receive() return nil end

local makers = {
  function(outline)
    return bw.responsive.steady {outline = outline, material = acting.rubber, elements = 20,
      conditions = {left = "fixed", right = {traction = {acting.function_of_load, 0}}}}
  end,
  function(outline)
    return bw.responsive.flow {outline = outline, viscosity = 0.1, elements = 20, step = 0.1,
      conditions = {left = {x = acting.function_of_load, y = 0}}}
  end,
  function(outline)
    return bw.responsive.metallophone {outline = outline, material = bw.material.pla, thickness = 0.05,
      elements = 20}
  end,
}

function kind.make()
  acting.load = 1
  local object = assert(makers[math.random(3)](followed_kinds.first()))
  local controller = assert(live_plane_controller.new(object, server, {}))
  controller:handle {{1, "open"}, {2, "open"}}
  return {controller = controller, object = object}
end

function kind.seen() return "" end -- a message reports what it did, and has no result

function kind.check(subject)
  local controller, object = subject.controller, subject.object
  controller:handle {} -- what failed in going back is made good with the next message
  object.body:check()
  local here = controller.history[controller.position]
  if not here then error "check: the controller is at no edit" end
  if not controller.drag and text_of(here.outline.points) ~= text_of(object.outline.points) then
    error "check: nothing is dragged, and the outline is not that of the last edit"
  end
end

function kind.close(subject)
  subject.controller:finish()
  subject.object.body:close()
end

local function say(message)
  return function(subject)
    local made = message(subject.object)
    made.seq = made.seq and math.random(100)
    subject.controller:handle {{math.random(2), "message", bw.json.encode(made)}}
    return true
  end
end

local function plain(type) return say(function() return {type = type} end) end

kind.operations = {
  begin = {4, say(function(object)
    return {type = "begin", seq = 1, handle = followed_kinds.handle(object.outline)}
  end)},
  move = {6, say(function() return {type = "move", seq = 1, by = followed_kinds.way(0.3)} end)},
  ["end"] = {3, say(function() return {type = "end", seq = 1, cancel = math.random() < 0.3} end)},
  undo = {1.5, plain "undo"},
  redo = {1.5, plain "redo"},
  reset = {0.3, plain "reset"},
  stop = {0.2, plain "stop"},
  hole = {0.7, say(function()
    return {type = "edit", seq = 1, edit = {kind = "hole", at = {uniform(0, 2), uniform(0, 1)},
      radius = uniform(0.02, 0.3)}}
  end)},
  split = {0.5, say(function(object)
    return {type = "edit", seq = 1, edit = {kind = "split", t = 0.5,
      edge = math.random(object.outline.edge_count)}}
  end)},
  join = {0.5, say(function(object)
    return {type = "edit", seq = 1, edit = {kind = "join", vertex = math.random(object.outline.edge_count)}}
  end)},
  smooth = {0.5, say(function() return {type = "edit", seq = 1, edit = {kind = "smooth", strength = 0.5}} end)},
  tune = {0.2, say(function() return {type = "tune", target = 10 ^ uniform(1, 3)} end)},
  pace = {0.5, say(function() return {type = "pace", running = math.random() < 0.7, steps = math.random(3)} end)},
  ["no sense"] = {0.3, say(function() return {type = "begin", handle = {edge = 1e9}} end)},
  load = {0.5, acting.change},
  idle = {2, function(subject)
    subject.controller.due = core.seconds() - 1
    subject.controller:idle()
    return true
  end},
  leave = {0.3, function(subject)
    local client = math.random(2)
    subject.controller:handle {{client, "close"}, {client, "open"}}
    return true
  end},
}

return kind
