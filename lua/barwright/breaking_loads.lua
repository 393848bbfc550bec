-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Which loads the breaking force admits: supports, forbidden surface, friction, hands. Selections are functions of
-- the mesh, since each refinement has a mesh of its own. docs/theory/breaking_force.md has the mathematics.
local core = require "barwright.core"
local options = require "barwright.options"

local raise = core.raise

local breaking_loads = {}

-- Facets of the pyramid around the cone of friction.
local FACETS = 8

--- Adds the options of admissible loads to the rules of the breaking force.
function breaking_loads.rules(rules)
  rules.fix = {type = "function"}
  rules.forbidden = {type = "function"}
  rules.friction = {type = "number", default = 0, min = 0, max = 100}
  rules.hands = {type = "integer", min = 1, max = 16}
  rules.lp = {type = "linear_program_solver", auto = true}
  return rules
end

--- Raises where the options contradict each other.
function breaking_loads.check(opts)
  if opts.hands == 1 and not opts.fix then
    raise("breaking_force: option 'hands': a part without supports moves freely under the load of one hand: give "
      .. "the option 'fix', or more hands")
  end
end

-- The selections on a mesh that an option's function gives, as a list.
local function selections(name, make, mesh)
  local given, message, details = make(mesh)
  if given == nil and message then return nil, message, details end
  local list = options.kind(given) == "table" and options.countable(given) and given or {given}
  if #list == 0 then return nil, ("option '%s' selects nothing"):format(name), {status = "empty"} end
  for i = 1, #list do
    if options.kind(list[i]) ~= "selection" or list[i].mesh ~= mesh then
      raise(("breaking_force: option '%s': a function of the mesh that returns selections on it expected, "
        .. "got %s"):format(name, options.kind(list[i]) == "selection" and "a selection on another mesh"
        or core.got(list[i])))
    end
  end
  return list
end

local function union_of(list)
  local whole = list[1]
  for i = 2, #list do whole = whole:union(list[i]) end
  return whole
end

--- The part on a mesh and the options of its worst case: `force` on one side over at least `contact`. What the
--- loads are is kept in `self` (fixed_area, forbidden_area). Returns nil, message, details if a selection fails.
function breaking_loads.part(self, mesh)
  local opts = self.options
  local part = core.model {mesh = mesh, material = self.material}
  -- Supports carry the reaction: the whole force is pressure.
  local sides = opts.fix and 1 or 2
  local limits = {force = sides * opts.force, pressure = opts.force / self.contact}
  if opts.fix then
    local fixed, message, details = selections("fix", opts.fix, mesh)
    if not fixed then return nil, message, details end
    for _, on in ipairs(fixed) do part:fix(on) end
    if union_of(fixed).facet_count == mesh.facet_count then
      return nil, "the whole surface is constrained: no load stresses the part", {status = "invalid"}
    end
    self.fixed_area = union_of(fixed).area
  end
  if opts.forbidden then
    local forbidden, message, details = selections("forbidden", opts.forbidden, mesh)
    if not forbidden then return nil, message, details end
    limits.forbidden, self.forbidden_area = forbidden, union_of(forbidden).area
  end
  if opts.friction > 0 then -- the pyramid contains the cone
    limits.friction, limits.friction_facets = opts.friction / math.cos(math.pi / FACETS), FACETS
  end
  limits.lp = opts.lp
  if opts.hands then
    limits.hands, limits.hand = opts.hands, 2 * self.contact
  end
  return part, limits
end

return breaking_loads
