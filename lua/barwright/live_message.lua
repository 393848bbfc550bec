-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Messages of the pages of an edit session's live view, checked by live_check.
local checks = require "barwright.live_check"
local json = require "barwright.json"

local is_object, number_between, whole, flag = checks.is_object, checks.number_between, checks.whole,
  checks.flag
local one_of, or_null, read_object = checks.one_of, checks.or_null, checks.read_object

local live_message = {}

local function vector(check, what)
  return function(value)
    if is_object(value) and #value == 3 then
      local out = {}
      for i = 1, 3 do out[i] = check(value[i]) end
      local count = 0
      for _ in pairs(value) do count = count + 1 end
      if out[1] and out[2] and out[3] and count == 3 then return out end
    end
    return nil, what
  end
end

local function axis(value)
  local out = vector(number_between(-1e3, 1e3), "")(value)
  if out and out[1] ^ 2 + out[2] ^ 2 + out[3] ^ 2 > 1e-12 then return out end
  return nil, "an axis of three numbers that are not all 0"
end

-- Within reach of the body: 20 times its size.
local function place(value, controller)
  local max = 20 * controller.scene.size
  return vector(number_between(-max, max), ("three numbers of at most %g m"):format(max))(value)
end

local function bone(value, controller)
  if type(value) == "string" then
    for _, name in ipairs(controller.session.skeleton.bone_names) do
      if name == value then return value end
    end
  end
  return nil, "the name of a bone"
end

local function joint(value, controller)
  if type(value) == "string" then
    for _, name in ipairs(controller.session.skeleton.joint_names) do
      if name == value then return value end
    end
  end
  return nil, "the name of a joint"
end

local function bones(value, controller)
  if not is_object(value) or #value > 10000 then return nil, "a list of names of bones" end
  local out, count = {}, 0
  for i, name in ipairs(value) do
    if not bone(name, controller) then return nil, "a list of names of bones" end
    out[i] = name
  end
  for _ in pairs(value) do count = count + 1 end
  if count ~= #out then return nil, "a list of names of bones" end
  return out
end

-- Lists of two names and more, no name twice.
local function ties(value, controller)
  local expected, known, count = "lists of names of bones, none of them twice", {}, 0
  if not is_object(value) or #value > 1000 then return nil, expected end
  local out = json.list {}
  for i, list in ipairs(value) do
    local tie = bones(list, controller)
    if not tie or #tie < 2 then return nil, expected end
    for _, name in ipairs(tie) do
      if known[name] then return nil, expected end
      known[name] = true
    end
    out[i] = json.list(tie)
  end
  for _ in pairs(value) do count = count + 1 end
  if count ~= #out then return nil, expected end
  return out
end

-- ---- messages --------------------------------------------------------------------------------------

local turn_fields = {axis = {axis, true}, degrees = {number_between(-3600, 3600), true}}

local function turn(value, controller)
  return read_object("rotate", value, turn_fields, controller)
end

local change_fields = {
  rotate = {turn},
  scale = {vector(number_between(0.01, 100), "three factors from 0.01 to 100")},
  translate = {place},
  reach = {place},
  reset = {one_of(true)},
}

local function change(value, controller)
  local out, why = read_object("change", value, change_fields, controller)
  if not out then return nil, why .. "; a change" end
  local key = next(out)
  if key and next(out, key) == nil then return out end
  return nil, "one of rotate, scale, translate, reach, reset"
end

local stress = number_between(1e-3, 1e15)

local function twist(value)
  local min, max
  if is_object(value) then min, max = value[1], value[2] end
  local angle = number_between(-360, 360)
  if angle(min) and angle(max) and min <= max and #value == 2 then return {min, max} end
  return nil, "two angles from -360 to 360 degrees, the lower one first"
end

local nothing = {}
local types = {
  begin = {bone = {bone}, joint = {joint}, seq = {whole, true}},
  move = {seq = {whole, true}, change = {change, true}},
  ["end"] = {seq = {whole}, cancel = {flag}},
  edit = {bone = {bone}, joint = {joint}, change = {change, true}, seq = {whole}},
  joint_limits = {bone = {bone, true}, swing = {or_null(number_between(0, 180))}, twist = {or_null(twist)}},
  ties = {ties = {ties, true}},
  loads = {loads = {one_of("own", "worst"), true}},
  undo = nothing,
  redo = nothing,
  reset = nothing,
  stop = nothing,
  limit = {von_mises = {or_null(stress), true}},
  optimise = {von_mises = {stress, true}, min_factor = {number_between(0.05, 1)},
    max_factor = {number_between(1, 20)},
    bones = {bones}, move_supports = {flag}},
  export = {format = {one_of("stl", "lua"), true}},
}

--- The message of a text, or nil and why it is none.
function live_message.read(text, controller)
  local message, why = checks.read(text, types, controller)
  if not message then return nil, why end
  if types[message.type].joint and (message.bone == nil) == (message.joint == nil) then
    return nil, message.type .. ": one of 'bone' and 'joint' expected"
  end
  return message
end

live_message.is = checks.is

return live_message
