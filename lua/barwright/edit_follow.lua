-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The equations of a session. One incremental system follows the edits within a topology; another topology
-- (a refilled mesh, other subdomains) needs another system, made at the shape it is needed for, and so does
-- another law that is not isotropic. Parts with joints have a system of their own kind, that computes what the
-- joints make of the stiffness at every shape. What a solve reused is reported in words.
local core = require "barwright.core"
local edit_material = require "barwright.edit_material"
local edit_motion = require "barwright.edit_motion"
local shown = require "barwright.shown"

local edit_follow = {}

-- ---- joints ---------------------------------------------------------------------------------------

local function separated(bond, where)
  return nil, ("after the edit the faces of bond %d are apart, or overlap, by more than the bond closes (%s): "
    .. "edit bones that move both sides alike, make the edit smaller, or give the bond a larger 'gap'")
    :format(bond, where), {status = "geometry", bond = bond}
end

-- What keeps a part with bonds from being carried over to a shape.
local function bond_refusal(message, details)
  if not details.bond then return nil, message, details end
  if details.distance or details.node then return separated(details.bond, "at all nodes, or around one") end
  return nil, ("after the edit bond %d is none: %s"):format(details.bond, message), details
end

-- A node that followed side b and does not any more lets the faces come apart there.
local function check_bonds(part, model)
  local before = part.bonds
  for i, bond in ipairs(model.bonds) do
    local count = before[i].node_count
    if bond.node_count < count then
      return separated(i, ("at %d of the %d nodes of side a"):format(count - bond.node_count, count))
    end
  end
  return model
end

--- A part given on the original mesh, with its supports and loads on the shape of a state, of the
--- materials that regions have there. Where the
--- material turns with the bones, every subdomain has its own directions there.
function edit_follow.model(state, part)
  local shape, topology = state.shape, state.topology
  local model, message, details
  if topology.node_from then
    model, message, details = part:transferred(shape.mesh, topology.node_from)
  else
    model, message, details = part:moved(shape.mesh)
  end
  if not model then return bond_refusal(message, details) end
  model, message, details = check_bonds(part, model)
  if not model then return nil, message, details end
  model, message, details = edit_material.apply(model, state.materials)
  if not model then return nil, message, details end
  if shape.rotate_material and not shape.at_rest then
    local motion
    motion, message, details = topology.subdomains:motion(shape.maps, shape.rotations)
    if not motion then return nil, message, details end
    return core.rotate_material(model, topology.subdomains, motion)
  end
  return model
end

local function make(owner, state, model)
  local joined = core.is_joined(model)
  local new = joined and core.joined_incremental_system or core.incremental_system
  local system, message, details = new(model, state.topology.subdomains, state.shape.rotate_material)
  if not system then return nil, message, details end
  local memory
  memory, message, details = edit_motion.begin(state.shape)
  if not memory then return nil, message, details end
  local former = owner.following
  owner.following = {topology = state.topology, system = system, model = model, memory = memory, joined = joined,
    near = setmetatable({}, {__mode = "k"})}
  if former then former.system:close() end
  return owner.following
end

local function follow(record, state, model)
  local motion, reuse, message, details
  motion, message, details = edit_motion.rows(record.memory, state.shape)
  if not motion then return nil, message, details end
  reuse, message, details = record.system:update(model, motion)
  if not reuse then return nil, message, details end
  record.model, record.reuse = model, reuse
  return record
end

-- Whether the equations there are can be brought to a model of a state.
local function can_follow(record, state, model)
  return record and record.topology == state.topology and record.joined == core.is_joined(model)
    and record.system:follows(model)
end

--- Brings the session's equations to a state: {system, model, reuse = nil when they are new}. A fork
--- has those of the session it was forked from. `part`: another one's supports and loads.
function edit_follow.bring(session, state, part)
  local owner = rawget(session, "root") or session
  local model, message, details = edit_follow.model(state, part or session.source)
  if not model then return nil, message, details end
  local record = owner.following
  if can_follow(record, state, model) then return follow(record, state, model) end
  record, message, details = make(owner, state, model)
  if not record then return nil, message, details end
  return record
end

-- ---- what was reused -------------------------------------------------------------------------------

local reused = setmetatable({}, {__mode = "k"})

--- Of a result of an edit session: what its solve reused, and what it cost.
core.classes.static.properties.reused = function(static) return reused[static] end

-- What solved the equations, in words.
local function way(reuse)
  if reuse.joined then
    if reuse.solver == "pcg" then return ("conjugate gradients on the joined equations, %d iterations"):format(
      reuse.iterations) end
    return reuse.full and "the factor of the joined equations recomputed" or "the factor of the joined equations"
  end
  if reuse.preconditioner == "two_level" then
    return ("two-level PCG in place of a factor, %d iterations"):format(reuse.iterations)
  end
  if reuse.solver == "pcg" then return ("the factor as it was, %d iterations"):format(reuse.iterations) end
  return reuse.full and "nothing of the factor" or shown.percent(reuse.factor_reused) .. " of the factor"
end

function core.tables.reuse:__tostring()
  local function yes(flag) return flag and "yes" or "no" end
  local text = ("pattern %s, ordering %s, %d of %d subdomains, %s"):format(yes(self.pattern),
    yes(self.ordering), self.subdomains - self.subdomains_changed, self.subdomains,
    way(self))
  if self.precision == 32 then text = text .. " in single precision" end
  if self.mesh and self.mesh ~= "posed" then text = text .. "; mesh " .. self.mesh end
  return text
end

-- Of equations that were made for this solve.
local function complete_new(reuse, subdomains)
  reuse.pattern, reuse.ordering = false, false
  reuse.subdomains, reuse.subdomains_reused, reuse.subdomains_rotated = subdomains, 0, 0
  reuse.subdomains_changed, reuse.factor_reused = subdomains, 0
  reuse.full = reuse.solver ~= "pcg"
end

local solutions = 2 -- of each load case, that are kept to begin iterations with

-- The options with the last solutions of the load case as a guess, unless others are given.
local function with_guess(given, near)
  if not near or given and given.guess then return given end
  local opts = {guess = near}
  for key, value in pairs(given or {}) do opts[key] = value end
  return opts
end

--- The static solution of a state.
function edit_follow.solve(session, state, given, part)
  local record, message, details = edit_follow.bring(session, state, part)
  if not record then return nil, message, details end
  local before, case = record.reuse, part or session.source
  local result, reuse
  result, reuse, details = record.system:statics(record.model, with_guess(given, record.near[case]), before)
  if not result then return nil, reuse, details end
  local near = record.near[case] or {}
  record.near[case] = {result.displacement, table.unpack(near, 1, solutions - 1)}
  if not before then complete_new(reuse, state.topology.subdomains.stiffness_subdomain_count) end
  reuse.mesh, reuse.joined = state.note or "posed", record.joined
  reused[result] = reuse
  return result
end

return edit_follow
