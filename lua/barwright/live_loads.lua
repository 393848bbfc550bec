-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Which loads a controller shows the stresses of: the part's own, or the worst load (bw.worst_case) of the
-- shape at which it was looked for. That load stays with the nodes through edits; `outdated` says that the
-- shape is another one by now.
local core = require "barwright.core"
local json = require "barwright.json"
local worst_case = require "barwright.worst_case"

local live_loads = {}

local function state_of(session)
  return session.history[session.position]
end

--- Stresses of a session, or a fork, under the controller's loads.
function live_loads.solve(controller, shown)
  local worst = controller.loads.worst
  if not worst then return shown:solve(controller.about.solve) end
  if state_of(shown).topology ~= worst.topology then
    live_loads.own(controller) -- other nodes
    return shown:solve(controller.about.solve)
  end
  return shown:solve {part = worst.part, inertia_relief = true}
end

--- The part's own loads from here on.
function live_loads.own(controller)
  controller.loads = {kind = "own"}
end

--- The worst load of the session's present shape from here on: true, or nil and why there is none.
function live_loads.find(controller)
  local session = controller.session
  local state, source = state_of(session), session.source
  if state.topology.node_from then
    return nil, "the mesh was refilled, and worst loads are for the mesh that the session began with: undo "
      .. "the edit that refilled it", {status = "unsupported"}
  end
  local free = core.model {mesh = state.shape.mesh, material = source.material}
  local worst, why, details = worst_case(free, controller.about.worst)
  if not worst then return nil, why, details end
  local part = core.model {mesh = source.mesh, material = source.material}
  part:load {nodal = worst:force()}
  local arrows = json.list {}
  for i, arrow in ipairs(worst:arrows()) do arrows[i] = {at = arrow.at, force = arrow.force} end
  controller.loads = {kind = "worst", worst = {part = part, arrows = arrows, topology = state.topology,
    shape = state.shape, max_principal = worst.max_principal, force = worst.options.force}}
  worst:close()
  return true
end

--- In words.
function live_loads.words(controller)
  local worst = controller.loads.worst
  return ("the worst load of %s: a principal stress of %s"):format(core.quantity(worst.force, "N"),
    core.quantity(worst.max_principal, "Pa"))
end

--- For the pages.
function live_loads.shown(controller)
  local worst = controller.loads.worst
  if not worst then return {kind = "own"} end
  return {kind = "worst", arrows = worst.arrows, max_principal = worst.max_principal,
    force = worst.force, outdated = state_of(controller.session).shape ~= worst.shape}
end

return live_loads
