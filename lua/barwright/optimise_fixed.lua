-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the scaling optimisation may not move: nodes of supports, in the directions that they fix, and
-- of selections that the user keeps. An unknown whose motion moves them is none.
local core = require "barwright.core"
local options = require "barwright.options"

local raise = core.raise
local optimise_fixed = {}

local axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}
local still = 1e-9 -- of the part's size: what counts as rounding in a motion by a factor of e

--- Splits the option 'keep' into names of bones and selections on the session's mesh.
function optimise_fixed.split(session, keep)
  local bones, faces = {}, {}
  for i, value in ipairs(keep) do
    if type(value) == "string" then
      bones[#bones + 1] = value
    else
      options.object("optimise", ("keep[%d]"):format(i), value, "selection")
      if value.mesh.node_count ~= session.source.mesh.node_count then
        raise(("optimise: keep[%d]: a selection on the mesh that the session began with expected, got one on %s")
          :format(i, tostring(value.mesh)))
      end
      faces[#faces + 1] = {name = ("what keep[%d] keeps"):format(i), nodes = value.nodes, directions = axes}
    end
  end
  if #keep == 0 and next(keep) ~= nil then
    raise "optimise: option 'keep': a list of names of bones and selections expected, got a table with names"
  end
  return bones, faces
end

--- Adds the supports of parts to a list. A support that slides fixes its direction, or the mean normal.
function optimise_fixed.add_supports(list, parts)
  for _, part in ipairs(parts) do
    for n, support in ipairs(part.supports) do
      local directions = {}
      if support.slide then
        directions[1] = support.direction or support.on.normal
      else
        for k = 1, 3 do
          if support.displacement[k] then directions[#directions + 1] = axes[k] end
        end
      end
      list[#list + 1] = {name = ("support %d"):format(n), support = true, nodes = support.on.nodes,
        directions = directions}
    end
  end
end

-- The numbers that nodes of the original mesh have on a topology.
local function nodes_on(topology, one)
  if not topology.node_from then return one.nodes end
  if one.topology ~= topology then
    local set, list = {}, {}
    for _, node in ipairs(one.nodes:totable()) do set[node] = true end
    for i, from in ipairs(topology.node_from:totable()) do
      if set[from] then list[#list + 1] = i end
    end
    one.topology, one.found = topology, core.array(list, "i32")
  end
  return one.found
end

--- The first of a list that a motion of all nodes moves; nil: none.
function optimise_fixed.moved(list, topology, motion)
  local min, max, size = topology.box.min, topology.box.max, 0
  for k = 1, 3 do size = math.max(size, max[k] - min[k]) end
  for _, one in ipairs(list) do
    local nodes = nodes_on(topology, one)
    if #nodes > 0 then
      local rows = motion:gather(nodes)
      for _, d in ipairs(one.directions) do
        local along = rows:map(("abs(%.17g*a.x + %.17g*a.y + %.17g*a.z)"):format(d[1], d[2], d[3]))
        if along:max() > still * size then return one end
      end
    end
  end
end

return optimise_fixed
