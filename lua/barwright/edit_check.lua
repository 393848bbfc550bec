-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Whether all parts of a session belong together, for tests and debugging: raises where they do not.
local core = require "barwright.core"

local function demand(fits, text, ...)
  if not fits then core.raise("check: " .. text:format(...)) end
end

local function check_pose(i, state)
  local bones = state.topology.skeleton.bone_count
  demand(#state.pose == bones, "state %d: %d bones expected, got %d", i, bones, #state.pose)
  for b, row in ipairs(state.pose) do
    demand(#row == 15, "state %d: bone %d has %d numbers, 15 expected", i, b, #row)
    for k, value in ipairs(row) do
      demand(value == value and math.abs(value) < math.huge,
        "state %d: number %d of bone %d: a finite number expected, got %s", i, k, b, value)
      demand(k < 10 or k > 12 or value > 0,
        "state %d: factor %d of bone %d: a number above 0 expected, got %s", i, k - 9, b, value)
    end
  end
  for b in pairs(state.limits) do
    demand(math.type(b) == "integer" and b >= 1 and b <= bones,
      "state %d: limits of a bone from 1 to %d expected, got %s", i, bones, b)
  end
end

local function check_shape(i, state)
  local shape, mesh = state.shape, state.topology.mesh
  demand(shape.topology == state.topology, "the shape of state %d is of another topology", i)
  demand(shape.mesh.node_count == mesh.node_count and shape.mesh.element_count == mesh.element_count,
    "the mesh of state %d has %d nodes and %d elements, its topology %d and %d", i, shape.mesh.node_count,
    shape.mesh.element_count, mesh.node_count, mesh.element_count)
  local inverted = mesh:shape_check(shape.mesh.nodes, 0).inverted
  demand(inverted == 0, "the mesh of state %d has %s elements inverted", i, inverted)
end

local function check_equations(record)
  demand(tostring(record.system):find "closed" == nil, "the session's equations are closed")
  demand(record.model.mesh.node_count == record.topology.mesh.node_count,
    "the session's equations are of %d nodes, their topology of %d", record.model.mesh.node_count,
    record.topology.mesh.node_count)
end

return function(session)
  local history, position = session.history, session.position
  demand(history[position], "the session is at state %d of %d", position, #history)
  demand(history[position].shape, "the state that stands has no shape")
  for i, state in ipairs(history) do
    demand(state.topology.subdomains.mesh == state.topology.mesh, "state %d has subdomains of another mesh", i)
    demand(i == 1 or type(state.script) == "string", "state %d cannot be replayed", i)
    check_pose(i, state)
    if state.shape then check_shape(i, state) end
  end
  demand(not session.root or not session.root.root, "a fork hangs on a fork")
  if session.following then check_equations(session.following) end
  return session
end
