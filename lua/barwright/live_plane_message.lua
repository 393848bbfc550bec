-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Messages of the pages of the plane's live view, checked by live_check. docs/live.md lists them.
local checks = require "barwright.live_check"
local pitch = require "barwright.pitch"

local number_between, whole, flag = checks.number_between, checks.whole, checks.flag
local one_of, or_null, read_object, is_object = checks.one_of, checks.or_null, checks.read_object,
  checks.is_object

local live_plane_message = {}

-- A list of exactly `count` entries, or of any number up to `max`.
local function list_of(check, count, max, what)
  return function(value, controller)
    if not is_object(value) or count and #value ~= count or #value > (max or count) then
      return nil, what
    end
    local out, entries = {}, 0
    for i = 1, #value do
      out[i] = check(value[i], controller)
      if out[i] == nil then return nil, what end
    end
    for _ in pairs(value) do entries = entries + 1 end
    if entries ~= #out then return nil, what end
    return out
  end
end

-- A place or a way, within 20 times the size of the outline.
local function pair(value, controller)
  local max = 20 * controller.size
  return list_of(number_between(-max, max), 2, nil, ("two numbers of at most %g m"):format(max))(value)
end

local function edge(value, controller)
  local count = controller.object.outline.edge_count
  if math.type(value) == "integer" and value >= 1 and value <= count then return value end
  return nil, ("a whole number from 1 to %d"):format(count)
end

local function loop(value, controller)
  if type(value) == "string" then
    for _, one in ipairs(controller.object.outline.loops) do
      if one.name == value then return value end
    end
  end
  return nil, "the name of a loop"
end

local handle_fields = {vertex = {edge}, edge = {edge}, loop = {loop}, control = {one_of(1, 2)}}

local function handle(value, controller)
  local out, why = read_object("handle", value, handle_fields, controller)
  if not out then return nil, why .. "; a handle" end
  local count = (out.vertex and 1 or 0) + (out.edge and 1 or 0) + (out.loop and 1 or 0)
  if count ~= 1 or out.control and not (out.edge and controller.object.outline:edge(out.edge).control) then
    return nil, "one of vertex, edge, loop (and control of an edge that is a curve)"
  end
  return out
end

local function length(value, controller)
  return number_between(1e-6 * controller.size, controller.size)(value)
end

local edit_fields = {
  smooth = {loop = {loop}, strength = {number_between(0, 1)}},
  hole = {at = {pair, true}, radius = {length, true}},
  remove = {loop = {loop, true}},
  split = {edge = {edge, true}, t = {number_between(1e-3, 1 - 1e-3), true}},
  join = {vertex = {edge, true}},
}

-- {kind = , ...}
local function edit(value, controller)
  local kind = is_object(value) and value.kind
  local fields = type(kind) == "string" and edit_fields[kind]
  if not fields then return nil, "an edit of kind smooth, hole, remove, split or join" end
  value.kind = nil
  local out, why = read_object(kind, value, fields, controller)
  if not out then return nil, why .. "; an edit" end
  out.kind = kind
  return out
end

local function field(value, controller)
  for _, one in ipairs(controller.kind.fields) do
    if one.key == value then return value end
  end
  return nil, "the key of a field"
end

-- A frequency in Hz, or a note.
local function target(value)
  if type(value) == "string" and #value < 8 and pitch.frequency(value) then return value end
  if type(value) == "number" and value > 1e-3 and value < 1e6 then return value end
  return nil, "a frequency in Hz or a note like C5"
end

local nothing = {}
local types = {
  begin = {handle = {handle, true}, pins = {list_of(edge, nil, 1000, "numbers of vertices")},
    reach = {length}, seq = {whole, true}},
  move = {by = {pair, true}, seq = {whole, true}},
  ["end"] = {seq = {whole}, cancel = {flag}},
  edit = {edit = {edit, true}, seq = {whole}},
  show = {field = {field, true}},
  pace = {running = {flag}, steps = {number_between(1, 1000)}},
  limit = {von_mises = {or_null(number_between(1e-3, 1e15)), true}},
  tune = {target = {target, true}, pins = {list_of(edge, nil, 1000, "numbers of vertices")}},
  undo = nothing,
  redo = nothing,
  reset = nothing,
  stop = nothing,
  export = {format = {one_of("svg", "dxf", "lua"), true}},
}

--- The message of a text, or nil and why it is none.
function live_plane_message.read(text, controller)
  local message, why = checks.read(text, types, controller)
  if not message then return nil, why end
  if message.type == "begin" and message.pins and not message.handle.vertex then
    return nil, "begin: with 'pins' a vertex is pulled"
  end
  return message
end

return live_plane_message
