-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edits of bones: turning, scaling, moving, setting, inverse kinematics, limits. Each reads its
-- arguments, makes the new pose, and hands it to the session with the line that replays it.
local core = require "barwright.core"
local members = require "barwright.members"
local edit_pose = require "barwright.edit_pose"
local edit_script = require "barwright.edit_script"
local options = require "barwright.options"

local raise = core.raise

local edit_bone = {}

local class = {__name = "barwright.bone"}
local properties = {}

local function state_of(session)
  return session.history[session.position] or raise("this session is closed")
end

-- bone.scale(2) in place of bone:scale(2) is a slip that deserves a better answer than Lua's own.
local function of_bone(self, call)
  if getmetatable(self) ~= class then
    raise(("%s: call it with a colon: bone:%s(...)"):format(call, call))
  end
end

local function row_of(self)
  return state_of(self.session).pose[self.index]
end

-- Commits a change of one bone and gives the handle back, for the next call.
local function change(self, call, rotation, scale, translation)
  local state = state_of(self.session)
  local ok, message, details = self.session:commit {
    script = ("session:bone(%s):%s"):format(edit_script.value(self.name), call),
    pose = edit_pose.with(state.pose, self.index, rotation, scale, translation)}
  if not ok then return nil, message, details end
  return self
end

-- The rotation that a bone takes over from its parent, now.
local function parent_rotation(self)
  local state = state_of(self.session)
  local parent = state.topology.skeleton.parents[self.index]
  if parent == 0 then return edit_pose.identity end
  return state.shape.rotations:rows(parent, parent):totable()[1]
end

--- Thicker or longer: factors along the bone and across it, on top of what it has.
function class:scale(factors)
  of_bone(self, "scale")
  local by, row = edit_pose.read_scale("scale", factors), row_of(self)
  return change(self, "scale" .. edit_script.vector(by), nil,
    {row[10] * by[1], row[11] * by[2], row[12] * by[3]})
end

--- Turned about its head, on top of what it has, with all that hangs on it: {axis =, degrees =},
--- {x =, y =, z =} in degrees, or three rows. Directions are those of the space it stands in.
function class:rotate(turn)
  of_bone(self, "rotate")
  local by = edit_pose.read_rotation("rotate", turn)
  local above = parent_rotation(self)
  local own = edit_pose.multiply(edit_pose.transpose(above),
    edit_pose.multiply(by, edit_pose.multiply(above, edit_pose.rotation(row_of(self)))))
  return change(self, "rotate" .. edit_script.value(turn), own)
end

--- Moved by a vector in metres, with all that hangs on it.
function class:translate(vector)
  of_bone(self, "translate")
  local by, row = edit_pose.read_vector("translate", vector), row_of(self)
  local local_by = edit_pose.apply(edit_pose.transpose(parent_rotation(self)), by)
  return change(self, "translate" .. edit_script.vector(by), nil, nil,
    {row[13] + local_by[1], row[14] + local_by[2], row[15] + local_by[3]})
end

local set_rules = {
  scale = {type = "any"},
  rotation = {type = "any"},
  translation = {type = "any"},
}

-- rotation, scale, translation of {scale =, rotation =, translation =}, and how it is written
local function read_change(where, given)
  local opts = options.read(where, given, set_rules)
  local rotation = opts.rotation and edit_pose.read_rotation(where .. ": rotation", opts.rotation)
  local scale = opts.scale and edit_pose.read_scale(where .. ": scale", opts.scale)
  local translation = opts.translation
    and edit_pose.read_vector(where .. ": translation", opts.translation)
  local text = {}
  if opts.rotation then text[#text + 1] = "rotation = " .. edit_script.value(opts.rotation) end
  if scale then text[#text + 1] = "scale = " .. edit_script.vector(scale) end
  if translation then text[#text + 1] = "translation = " .. edit_script.vector(translation) end
  return rotation, scale, translation, "{" .. table.concat(text, ", ") .. "}"
end

--- Sets its whole change since rest: {scale =, rotation =, translation =}; what is left out stays.
--- The rotation is against its parent, the translation in the parent's directions.
function class:set(given)
  of_bone(self, "set")
  local rotation, scale, translation, text = read_change("set", given)
  return change(self, "set" .. text, rotation, scale, translation)
end

--- Back to rest.
function class:reset()
  of_bone(self, "reset")
  return change(self, "reset()", edit_pose.identity, {1, 1, 1}, {0, 0, 0})
end

-- ---- asking ----------------------------------------------------------------------------------------

-- Name, head, tail, parent, children of the skeleton's bone.
for _, key in ipairs {"head", "tail", "parent", "children"} do
  properties[key] = function(self) return state_of(self.session).topology.skeleton:bone(self.index)[key] end
end

local function place(session, joint)
  local skeleton = state_of(session).topology.skeleton
  local row = session.joints:rows(skeleton:joint(joint).index, skeleton:joint(joint).index)
  return row:totable()[1]
end

--- The number of the subdomain that follows this bone alone, or nil: then the bone only takes part in
--- blending, or moves nothing but what hangs on it.
function properties:subdomain()
  for i, subdomain in ipairs(state_of(self.session).topology.subdomains) do
    if subdomain.bone == self.name then return i end
  end
end

function properties:from() return place(self.session, self.head) end
function properties:to() return place(self.session, self.tail) end
function properties:factors() return edit_pose.scale(row_of(self)) end
function properties:translation() return edit_pose.translation(row_of(self)) end

function properties:rotation()
  local r = row_of(self)
  return {{r[1], r[2], r[3]}, {r[4], r[5], r[6]}, {r[7], r[8], r[9]}}
end

function class:__tostring()
  local state = self.session.history[self.session.position]
  if not state then return ("bone %s of a closed session"):format(self.name) end
  local row, parts = state.pose[self.index], {}
  if row[10] ~= 1 or row[11] ~= 1 or row[12] ~= 1 then
    parts[#parts + 1] = ("scaled by (%.4g, %.4g, %.4g)"):format(row[10], row[11], row[12])
  end
  local axis, angle = edit_pose.axis_and_angle(edit_pose.rotation(row))
  if angle ~= 0 then
    parts[#parts + 1] = ("rotated by %.4g degrees about (%.4g, %.4g, %.4g)"):format(math.deg(angle),
      axis[1], axis[2], axis[3])
  end
  if row[13] ~= 0 or row[14] ~= 0 or row[15] ~= 0 then
    parts[#parts + 1] = "moved by " .. core.point {row[13], row[14], row[15]}
  end
  return ("bone %s from %s to %s, %s"):format(self.name, core.point(self.from), core.point(self.to),
    #parts > 0 and table.concat(parts, ", ") or "at rest")
    .. (self.subdomain and "" or "; no subdomain follows it alone")
end

class.__index = members("a bone", class, properties)

function class:__newindex(name)
  of_bone(self, tostring(name))
  raise(("a bone cannot be changed by assignment to '%s': call bone:set {scale =, rotation =, translation =}")
    :format(tostring(name)))
end

edit_bone.class, edit_bone.properties = class, properties

function edit_bone.handle(session, bone)
  return setmetatable({session = session, index = bone.index, name = bone.name}, class)
end

-- ---- several bones at once ---------------------------------------------------------------------------

function edit_bone.set_pose(session, changes)
  if type(changes) ~= "table" then
    raise(("pose: a table of changes by bones' names expected, got %s"):format(core.got(changes)))
  end
  local state = state_of(session)
  local pose, list = state.pose, {}
  for name, given in pairs(changes) do
    local bone = state.topology.skeleton:bone(name)
    local rotation, scale, translation, text = read_change("pose: " .. bone.name, given)
    pose = edit_pose.with(pose, bone.index, rotation, scale, translation)
    list[#list + 1] = ("[%s] = %s"):format(edit_script.value(bone.name), text)
  end
  table.sort(list)
  local ok, message, details = session:commit {pose = pose,
    script = ("session:pose {%s}"):format(table.concat(list, ", "))}
  if not ok then return nil, message, details end
  return session
end

--- What takes the pose of one state to that of another: changes for set_pose.
function edit_bone.changes(from, to)
  local names, changes = from.topology.skeleton.bone_names, {}
  for b, row in ipairs(to.pose) do
    if row ~= from.pose[b] then
      local r = row
      changes[names[b]] = {rotation = {{r[1], r[2], r[3]}, {r[4], r[5], r[6]}, {r[7], r[8], r[9]}},
        scale = edit_pose.scale(row), translation = edit_pose.translation(row)}
    end
  end
  return changes
end

-- ---- inverse kinematics ------------------------------------------------------------------------------

local target_rules = {
  joint = {type = "any"},
  bone = {type = "any"},
  at = {type = "any", needed = true},
  along = {type = "number"},
  weight = {type = "number", above = 0},
  from = {type = "any"},
}

local function contains(list, value)
  for _, entry in ipairs(list) do
    if entry == value then return true end
  end
  return false
end

-- The bone and the place on it that a joint is: the tail of a bone, or the head of one at the root.
local function bone_at(skeleton, name)
  local joint = skeleton:joint(name)
  local first
  for _, bone_name in ipairs(joint.bones) do
    local bone = skeleton:bone(bone_name)
    if bone.tail == joint.name then return bone.index, 1 end
    first = first or bone.index
  end
  return first, 0
end

-- A name of a joint or of a bone (its tail is meant); an unknown one names the nearest of both.
local function end_of(skeleton, name)
  if contains(skeleton.joint_names, name) then return bone_at(skeleton, name) end
  if contains(skeleton.bone_names, name) then return skeleton:bone(name).index, 1 end
  local known = skeleton.joint_names
  for _, bone in ipairs(skeleton.bone_names) do known[#known + 1] = bone end
  raise(("reach: there is no joint or bone '%s': %s"):format(tostring(name),
    core.suggestion(tostring(name), known)))
end

local function read_list(skeleton, list)
  if #list == 0 then raise("reach: at least one target {joint =, at =} expected, got an empty list") end
  local out = {}
  for i, given in ipairs(list) do
    local opts = options.read("reach", given, target_rules)
    if (opts.joint == nil) == (opts.bone == nil) then
      raise(("reach: target %d: one of the options 'joint' and 'bone' expected, got %s"):format(i,
        opts.joint and "both" or "neither"))
    end
    local bone, along
    if opts.joint ~= nil then
      if opts.along then raise(("reach: target %d: option 'along' goes with 'bone' only"):format(i)) end
      bone, along = bone_at(skeleton, opts.joint)
    else
      bone, along = skeleton:bone(opts.bone).index, opts.along or 1
    end
    out[i] = {bone = bone, along = along, at = edit_pose.read_vector("reach: at", opts.at),
      weight = opts.weight, from = opts.from ~= nil and skeleton:bone(opts.from).index or nil}
  end
  return out
end

local reach_rules = {tolerance = {type = "number", above = 0}}

function edit_bone.reach(session, target, at, given)
  local state = state_of(session)
  local skeleton = state.topology.skeleton
  local targets, arguments
  if type(target) == "table" then
    given = at
    targets, arguments = read_list(skeleton, target), {edit_script.value(target)}
  else
    local bone, along = end_of(skeleton, target)
    at = edit_pose.read_vector("reach: at", at)
    targets = {{bone = bone, along = along, at = at}}
    arguments = {edit_script.value(target), edit_script.vector(at)}
  end
  local opts = options.read("reach", given, reach_rules)
  if opts.tolerance then arguments[#arguments + 1] = edit_script.value(opts) end
  local rows
  if next(state.limits) then
    rows = {}
    for b = 1, skeleton.bone_count do rows[b] = state.limits[b] or false end
  end
  local reached, report, details = skeleton:reach(state.pose, targets, rows, opts.tolerance)
  if not reached then return nil, report, details end
  local ok, message
  ok, message, details = session:commit {pose = reached:totable(),
    script = ("session:reach(%s)"):format(table.concat(arguments, ", "))}
  if not ok then return nil, message, details end
  return report
end

-- ---- limits ------------------------------------------------------------------------------------------

local limit_rules = {
  swing = {type = "number", min = 0, max = 180},
  twist = {type = "table"},
}

local function read_limit(given)
  if given == nil then return nil end
  local opts = options.read("limit", given, limit_rules)
  if opts.twist then
    local min, max = opts.twist[1], opts.twist[2]
    local fits = #opts.twist == 2 and type(min) == "number" and type(max) == "number"
      and -math.huge < min and min <= max and max < math.huge
    if not fits then
      raise(("limit: option 'twist': {lowest, highest}, two numbers in degrees, the lower one first, expected, "
        .. "got {%s, %s}"):format(core.got(min), core.got(max)))
    end
  end
  return {swing = opts.swing and math.rad(opts.swing),
    twist_min = opts.twist and math.rad(opts.twist[1]),
    twist_max = opts.twist and math.rad(opts.twist[2])}
end

function edit_bone.limit(session, name, given)
  local state = state_of(session)
  local skeleton = state.topology.skeleton
  local limit = read_limit(given)
  local limits = {}
  for b, old in pairs(state.limits) do limits[b] = old end
  if contains(skeleton.bone_names, name) then
    limits[skeleton:bone(name).index] = limit
  else
    local joint = skeleton:joint(name)
    for _, bone_name in ipairs(joint.bones) do
      local bone = skeleton:bone(bone_name)
      if bone.head == joint.name then limits[bone.index] = limit end
    end
  end
  local ok, message, details = session:commit {limits = limits,
    script = ("session:limit(%s, %s)"):format(edit_script.value(name), edit_script.value(given))}
  if not ok then return nil, message, details end
  return session
end

return edit_bone
