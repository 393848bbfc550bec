-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The mesh of a pose. The shape is a function of the topology (subdomains on a mesh at rest) and the
-- pose alone: posed from rest, and where that inverts elements, inner nodes relaxed from there. So
-- the same pose gives the same nodes, whatever came before it, and undo need not keep meshes.
-- What relaxing cannot repair is refilled, which makes another topology.
local core = require "barwright.core"
local edit_pose = require "barwright.edit_pose"

local edit_shape = {}

-- The topologies made here: a script cannot make one by hand.
local topologies = setmetatable({}, {__mode = "k"})

--- A topology: subdomains, what is asked about them often, the quality below which elements are
--- repaired, and the numbers that the nodes have in the part as it was given (nil: the same). A refilled
--- one also has the topology before it (`former`), and where its elements were there.
function edit_shape.topology(subdomains, floor, node_from)
  local skeleton, mesh = subdomains.skeleton, subdomains.mesh
  local number = {}
  for i, name in ipairs(skeleton.bone_names) do number[name] = i end
  local list = {}
  for d, subdomain in ipairs(subdomains) do
    local bones = {}
    for k, name in ipairs(subdomain.bones) do bones[k] = number[name] end
    list[d] = {bones = bones, type = subdomain.type, adjacent = subdomain.adjacent,
      elements = subdomain.elements}
  end
  local made = {subdomains = subdomains, skeleton = skeleton, mesh = mesh, list = list, box = mesh.box,
    stiffness_subdomain_bones = subdomains.stiffness_subdomain_bones, node_from = node_from, floor = floor}
  topologies[made] = true
  return made
end

function edit_shape.is_topology(value)
  return topologies[value] == true
end

--- The quality asked for; a mesh that is poor at rest does not forbid edits.
function edit_shape.floor(mesh, quality)
  return math.max(0, math.min(quality, mesh:shapes():min() / 2))
end

-- The subdomains of the elements that are no better than the floor, as a set.
local function poor_subdomains(topology, nodes)
  local poor = topology.mesh:shapes(nodes):map("a <= bound", {bound = topology.floor}):where()
  local set = {}
  for _, d in ipairs(topology.subdomains.element_subdomain:gather(poor):totable()) do set[d] = true end
  return set
end

local function with_neighbours(topology, set)
  local out = {}
  for d in pairs(set) do
    out[d] = true
    for _, other in ipairs(topology.list[d].adjacent) do out[other] = true end
  end
  return out
end

--- One number for every subdomain: 1 for those of the set.
function edit_shape.flags(topology, set)
  local flags = {}
  for d = 1, #topology.list do flags[d] = set[d] and 1 or 0 end
  return core.array(flags, "u8")
end

-- Inner nodes of the subdomains of the set are moved until nothing is inverted.
local function relax(topology, shape, nodes, set)
  local mask = edit_shape.flags(topology, set):gather(topology.subdomains.node_subdomain)
  local relaxed, report, details = topology.mesh:relax(nodes, mask)
  if not relaxed then return nil, report, details end
  local moved = core.array.map("norm(a) > 0", {a = relaxed - nodes})
  shape.relaxed = {}
  for _, p in ipairs(topology.subdomains:stiffness_subdomains_touched(moved)) do shape.relaxed[p] = true end
  if next(shape.relaxed) then shape.how = "relaxed" end
  return relaxed
end

local farthest = 1e6 -- sizes of the part at rest: beyond it, coordinates have no digits left for shapes

-- Whether nodes left the part's surroundings, or the numbers.
local function is_far(topology, nodes)
  local min, max, size = topology.box.min, topology.box.max, 0
  for k = 1, 3 do size = math.max(size, max[k] - min[k]) end
  for k = 1, 3 do
    local column, reach = nodes:column(k), farthest * size
    local mean = column:mean() -- the least and the largest pass over what is no number
    if mean ~= mean or column:min() < min[k] - reach or column:max() > max[k] + reach then return true end
  end
  return false
end

-- So many bones are named in a message.
local NAMED <const> = 4

-- The bones whose subdomain an element is in: "near neck", "between thigh and shin".
local function near_bones(topology, element)
  local bones = topology.subdomains[topology.subdomains.element_subdomain[element]].bones
  if #bones == 1 then return "near " .. bones[1] end
  local names = {table.unpack(bones, 1, math.min(#bones, NAMED))}
  local last = #bones > NAMED and ("%d others"):format(#bones - NAMED) or table.remove(names)
  return ("between %s and %s"):format(table.concat(names, ", "), last)
end

-- A sentence on the worst of the elements that are inverted, and the details of the failure.
local function refusal(topology, nodes, judged)
  local element, at = judged.worst, {0, 0, 0}
  local corners = topology.mesh.elements:rows(element, element):totable()[1]
  for k = 1, 4 do
    for i = 1, 3 do at[i] = at[i] + nodes(corners[k], i) / 4 end
  end
  return ("the edit folds the part over itself, at worst at %s, %s"):format(core.point(at),
    near_bones(topology, element)), {status = "geometry", element = element, inverted = judged.inverted, at = at}
end

-- Relaxing in two rounds: blended subdomains alone, then with their neighbours.
local function relaxed_nodes(topology, shape, nodes)
  local set = poor_subdomains(topology, nodes)
  local out, message, details = relax(topology, shape, nodes, set)
  if out or details.status == "memory" or details.status == "cancelled" then
    return out, message, details
  end
  return relax(topology, shape, nodes, with_neighbours(topology, set))
end

--- The shape of a pose: {maps, rotations, mesh, how = "posed" | "relaxed", relaxed = set of subdomains,
--- topology, rotate_material}. Where elements are inverted and stay so, a fourth value has what refilling
--- starts from.
function edit_shape.of(topology, pose, opts)
  local maps, rotations, details = topology.skeleton:pose_maps(pose)
  if not maps then return nil, rotations, details end
  local nodes, message
  nodes, message, details = topology.subdomains:posed_nodes(maps)
  if not nodes then return nil, message, details end
  if is_far(topology, nodes) then
    return nil, ("the edit takes the part farther away than %.0f times its size: is a factor or a length "
      .. "wrong?"):format(farthest), {status = "geometry"}
  end
  local shape = {topology = topology, maps = maps, rotations = rotations, how = "posed",
    relaxed = {}, at_rest = edit_pose.all_at_rest(pose), rotate_material = opts.rotate_material}
  local judged = topology.mesh:shape_check(nodes, topology.floor)
  local final = nodes
  if judged.inverted > 0 then
    local inverted = topology.mesh:shape_check(nodes, 0)
    if opts.relax then
      final, message, details = relaxed_nodes(topology, shape, nodes)
      if not final and details.status ~= "geometry" then return nil, message, details end
    elseif inverted.inverted > 0 then
      final = nil
    end
    if not final and inverted.inverted == 0 then final = nodes end -- poor, but sound
    if not final then
      message, details = refusal(topology, nodes, inverted)
      return nil, message, details, {nodes = nodes, maps = maps, subdomains = poor_subdomains(topology, nodes)}
    end
  end
  shape.mesh, message, details = topology.mesh:moved(final)
  if not shape.mesh then
    return nil, message, details, details.status == "geometry"
      and {nodes = nodes, maps = maps, subdomains = poor_subdomains(topology, nodes)} or nil
  end
  return shape
end

-- ---- refilling -------------------------------------------------------------------------------------

-- The numbers in the first mesh of nodes that came from a mesh whose own came from it.
local function compose(before, node_from)
  if not before then return node_from end
  local count = #before
  return before:scatter(core.array.range(2, count + 1), count + 1):gather(node_from + 1)
end

-- The topology with new elements in the blended subdomains of the set.
local function refill(topology, inverted)
  local set, any = {}, false
  for d in pairs(inverted.subdomains) do
    if topology.list[d].type == "F" then set[d], any = true, true end
  end
  if not any then return nil, "the fold is where the part follows one bone alone", {status = "geometry"} end
  local mask = edit_shape.flags(topology, set):gather(topology.subdomains.element_subdomain)
  local mesh, node_from, element_from = topology.mesh:refill(inverted.nodes, mask)
  if not mesh then return nil, node_from, element_from end
  local subdomains, message, details = topology.subdomains:refilled(inverted.maps, mask, mesh, node_from,
    element_from)
  if not subdomains then return nil, message, details end
  local other = edit_shape.topology(subdomains, topology.floor, compose(topology.node_from, node_from))
  other.former, other.element_from = topology, element_from
  return other
end

--- The shape of a pose, and where relaxing does not help, on a refilled mesh: then the topology of
--- the shape is another one.
function edit_shape.repaired(topology, pose, opts)
  local shape, message, details, inverted = edit_shape.of(topology, pose, opts)
  if shape or not inverted then return shape, message, details end
  local tried = opts.relax and "; moving what lies inside does not help" or ""
  if opts.refill then
    local other, why, about = refill(topology, inverted)
    if other then
      other.refilled = true
      shape, why, about = edit_shape.of(other, pose, opts)
      if shape then return shape end
    end
    if about.status ~= "geometry" then return nil, why, about end
    tried = tried .. (opts.relax and ", nor does filling it again (%s)"
      or "; filling it again does not help (%s)"):format(
      (why:gsub(": undo the edit or make it smaller$", "")))
  end
  return nil, message .. tried .. ": make the edit smaller, or divide it between more bones", details
end

return edit_shape
