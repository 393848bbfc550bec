-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- static:joint_traction {bond = 1}: what a joint or a support exerts on the body. docs/theory/joints.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local shown = require "barwright.shown"

local static = core.classes.static.methods
local find = static.joint_traction
local kinds = {"bond", "attachment", "coupling", "support"}

-- What print says where some nodes have other forces too.
local shared = {bond = "at %d nodes supports take a part that is not included",
  support = "at %d nodes the reaction is of other supports too, and counts whole"}

local traction = {}

function traction:__tostring()
  local normal, shear = self.normal:gather(self.nodes), self.shear:gather(self.nodes)
  local text = ("traction of %s %d on the body: normal %s to %s, shear up to %s; force %s on %s; %s"):format(
    self.kind, self.number, core.quantity(normal:min(), "Pa"), core.quantity(normal:max(), "Pa"),
    core.quantity(shear:max(), "Pa"), shown.vector(self.force, "N"), core.quantity(self.area, "m2"),
    core.error_unknown)
  if self.shared == 0 then return text end
  return text .. "; " .. shared[self.kind]:format(self.shared)
end

function static:joint_traction(given)
  local rules = {}
  for _, kind in ipairs(kinds) do rules[kind] = {type = "integer", min = 1} end
  local opts, index = options.read("joint_traction", given, rules), nil
  for i, kind in ipairs(kinds) do
    if opts[kind] and index then core.raise(("joint_traction: either '%s' or '%s'"):format(kinds[index], kind)) end
    if opts[kind] then index = i end
  end
  if not index then
    core.raise("joint_traction: the number of a 'bond', an 'attachment', a 'coupling' or a 'support' expected")
  end
  local found, message, details = find(self, index, opts[kinds[index]])
  if not found then return nil, message, details end
  found.kind, found.number = kinds[index], opts[kinds[index]]
  return setmetatable(found, traction)
end

arguments.methods("static", static, nil, {joint_traction = "options: options"})
