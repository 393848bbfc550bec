-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Elements given to a bone by hand. Subdomains are made at rest, and the mesh at rest of a refilled
-- topology only carries positions (edit_shape); so a choice made on a refilled mesh is taken back to
-- the mesh that was filled again, and from there the pose is repaired again. Elements that were kept
-- are the same there; one that was replaced goes with the new one that lies nearest at rest, of
-- those of its subdomain.
local core = require "barwright.core"

local edit_assign = {}

-- The centroids of some elements at rest, as {x, y, z} by number.
local function centroids(mesh, elements)
  local corners = mesh.elements:gather(elements):totable()
  local out = {}
  for i, e in ipairs(elements) do
    local sum = {0, 0, 0}
    for k = 1, 4 do
      for axis = 1, 3 do sum[axis] = sum[axis] + mesh.nodes(corners[i][k], axis) / 4 end
    end
    out[e] = sum
  end
  return out
end

-- The elements of each subdomain, of those in the list.
local function by_subdomain(topology, elements)
  local lists, label = {}, topology.subdomains.element_subdomain
  for _, e in ipairs(elements) do
    local d = label[e]
    lists[d] = lists[d] or {}
    table.insert(lists[d], e)
  end
  return lists
end

local function nearest(place, elements, centroid)
  local best, min = nil, math.huge
  for _, e in ipairs(elements) do
    local at = centroid[e]
    local far = (at[1] - place[1]) ^ 2 + (at[2] - place[2]) ^ 2 + (at[3] - place[3]) ^ 2
    if far < min then best, min = e, far end
  end
  return best
end

-- The elements of the mesh that was filled again that a choice stands for.
local function taken_back(topology, elements)
  local former, from = topology.former, topology.element_from:totable()
  local chosen, out, made, kept, any = {}, {}, {}, {}, false
  for _, e in ipairs(elements) do
    chosen[e] = true
    if from[e] > 0 then out[#out + 1] = from[e] else any = true end
  end
  if not any then return out end
  for e, number in ipairs(from) do
    if number > 0 then kept[number] = true else made[#made + 1] = e end
  end
  local replaced = {}
  for e = 1, former.mesh.element_count do
    if not kept[e] then replaced[#replaced + 1] = e end
  end
  local here, there = centroids(topology.mesh, made), centroids(former.mesh, replaced)
  local new = by_subdomain(topology, made)
  for d, list in pairs(by_subdomain(former, replaced)) do
    for _, e in ipairs(list) do
      if chosen[nearest(there[e], new[d] or {}, here)] then out[#out + 1] = e end
    end
  end
  table.sort(out)
  return out
end

--- The subdomains of a topology with elements given to a bone (nil: taken out of those that follow one),
--- on the mesh as it was before it was refilled; or nil, message, details.
function edit_assign.subdomains(topology, elements, bone)
  local count = topology.mesh.element_count
  if type(elements) ~= "table" then
    core.raise(("assign: a list of elements expected, got %s"):format(core.got(elements)))
  end
  for _, e in ipairs(elements) do
    if math.type(e) ~= "integer" or e < 1 or e > count then
      core.raise(("assign: elements from 1 to %d expected, got %s"):format(count, core.got(e)))
    end
  end
  if not topology.former then return topology.subdomains:assign(elements, bone) end
  repeat
    elements, topology = taken_back(topology, elements), topology.former
  until not topology.former
  if #elements == 0 then
    return nil, "assign: no element of the mesh before it was refilled lies where these elements do",
      {status = "geometry"}
  end
  local ok, subdomains, message, details = pcall(topology.subdomains.assign, topology.subdomains, elements, bone)
  if not ok then
    core.raise("assign, on the mesh as it was before it was refilled: "
      .. subdomains:gsub("^[^\n]-:%d+: ", ""))
  end
  return subdomains, message, details
end

return edit_assign
