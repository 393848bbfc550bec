-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- bw.skeleton: joints and bones as tables that read well, and a skeleton in words.
local core = require "barwright.core"
local options = require "barwright.options"

local raise = core.raise

local skeleton = {extract = core.skeleton.extract, read = core.skeleton.read}

local rules = {
  joints = {type = "table", needed = true},
  bones = {type = "table", needed = true},
  root = {type = "any"},
}

-- {name = {x, y, z}, ...}, in the order of the names; or a list {{x, y, z, name = }, ...}.
local function read_joints(given)
  local names = {}
  for key in pairs(given) do
    if type(key) == "string" then names[#names + 1] = key end
  end
  table.sort(names)
  local joints, number = {}, {}
  if #names > 0 and #given > 0 then
    raise("skeleton.create: joints: a list, or a table by names, expected, got both in one")
  end
  for i, name in ipairs(names) do joints[i] = given[name] end
  for i, joint in ipairs(given) do
    joints[i] = joint
    names[i] = type(joint) == "table" and joint.name or false
  end
  for i, joint in ipairs(joints) do
    if type(joint) ~= "table" or #joint ~= 3 then
      raise(("skeleton.create: joint %s: {x, y, z} expected, got %s"):format(names[i] or i, core.got(joint)))
    end
    if names[i] then number[names[i]] = i end
  end
  return joints, names, number
end

local function joint_number(value, joints, names, number, where)
  if math.type(value) == "integer" and value >= 1 and value <= #joints then return value end
  if number[value] then return number[value] end
  local known = {}
  for _, name in ipairs(names) do known[#known + 1] = name or nil end
  if type(value) == "string" and #known > 0 then
    raise(("skeleton.create: %s: there is no joint '%s': %s"):format(where, value,
      core.suggestion(value, known)))
  end
  raise(("skeleton.create: %s: the name or number of a joint expected, got %s"):format(where,
    core.got(value)))
end

--- A skeleton from {joints = {name = {x, y, z}, ...}, bones = {{"hip", "knee", name = "thigh"}, ...},
--- root = name}. Joints may also be a list, and be called by number.
function skeleton.create(given)
  local opts = options.read("skeleton.create", given, rules)
  local joints, names, number = read_joints(opts.joints)
  local bones, bone_names = {}, {}
  for i, bone in ipairs(opts.bones) do
    local where = ("bone %s"):format(type(bone) == "table" and bone.name or i)
    if type(bone) ~= "table" or #bone ~= 2 then
      raise(("skeleton.create: %s: two joints expected, got %s"):format(where,
        type(bone) == "table" and #bone or core.got(bone)))
    end
    bones[i] = {joint_number(bone[1], joints, names, number, where),
      joint_number(bone[2], joints, names, number, where)}
    bone_names[i] = bone.name or false
  end
  if #joints == 0 or #bones == 0 then
    raise(("skeleton.create: at least one bone with its two joints expected, got %d bones and %d joints"):format(
      #bones, #joints))
  end
  local root = opts.root and joint_number(opts.root, joints, names, number, "root")
  return core.skeleton.make(joints, bones, names, bone_names, root)
end

-- ---- in words ------------------------------------------------------------------------------------

local function add_bones(self, lines, list, indent)
  for _, name in ipairs(list) do
    local bone = self:bone(name)
    lines[#lines + 1] = ("%s%s: %s to %s, %s"):format(indent, name, bone.head, bone.tail,
      core.quantity(bone.length, "m"))
    add_bones(self, lines, bone.children, indent .. "  ")
  end
end

--- The tree of bones, a line each.
function core.classes.skeleton.tostring(self)
  local lines = {("skeleton of %d joints and %d bones, root %s"):format(self.joint_count,
    self.bone_count, self.root)}
  local roots = {}
  for _, name in ipairs(self.bone_names) do
    if not self:bone(name).parent then roots[#roots + 1] = name end
  end
  add_bones(self, lines, roots, "  ")
  return table.concat(lines, "\n")
end

return skeleton
