-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- static:interface_traction(a, b): what print says of it. docs/theory/elements.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local shown = require "barwright.shown"

local static = core.classes.static.methods
local find = static.interface_traction

local tractions = {}

function tractions:__tostring()
  if self.area == 0 then return ("the regions '%s' and '%s' do not touch"):format(self.a, self.b) end
  local normal, shear = self.normal:gather(self.nodes), self.shear:gather(self.nodes)
  local text = ("tractions of '%s' on '%s': normal %s to %s, shear up to %s; force %s on %s; "
    .. "the sides differ by %.1e; %s"):format(self.b, self.a, core.quantity(normal:min(), "Pa"),
    core.quantity(normal:max(), "Pa"), core.quantity(shear:max(), "Pa"), shown.vector(self.force, "N"),
    core.quantity(self.area, "m2"), self.imbalance, core.error_unknown)
  if self.shared == 0 then return text end
  return text .. ("; at %d nodes supports or other regions take a part that is not included"):format(self.shared)
end

function static:interface_traction(a, b)
  local found, message, details = find(self, a, b)
  if not found then return nil, message, details end
  local met, nodes = {}, {}
  for _, facet in ipairs(self.mesh:interface(a, b).facets:totable()) do
    for _, node in ipairs(facet) do
      if not met[node] then nodes[#nodes + 1] = node end
      met[node] = true
    end
  end
  table.sort(nodes)
  found.nodes = core.array.new(nodes, "i32")
  return setmetatable(found, tractions)
end

arguments.methods("static", static, nil, {interface_traction = "a: string, b: string"})
