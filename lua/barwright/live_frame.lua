-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the live view's page receives of an edit session: a scene (what stays through edits) and states,
-- binary messages (live_pack). docs/live.md has the fields.
local json = require "barwright.json"
local live_pack = require "barwright.live_pack"

local live_frame = {}

local pack = live_pack.pack

--- What stays while the topology does: {topology, id, surface's nodes, size, bytes}.
function live_frame.scene(state, id, about)
  local topology = state.topology
  local surface, nodes, details = state.shape.mesh:surface()
  if not surface then return nil, nodes, details end
  local skeleton, bones = topology.skeleton, json.list {}
  local ends, parents = skeleton.bones:totable(), skeleton.parents:totable()
  local alone = {}
  for _, subdomain in ipairs(topology.subdomains) do
    if subdomain.bone then alone[subdomain.bone] = true end
  end
  for b, name in ipairs(skeleton.bone_names) do
    bones[b] = {name = name, head = ends[b][1] - 1, tail = ends[b][2] - 1, parent = parents[b] - 1,
      follows = alone[name] or false}
  end
  local box = surface.box
  local size = box.size
  size = math.sqrt(size[1] ^ 2 + size[2] ^ 2 + size[3] ^ 2)
  return {topology = topology, id = id, nodes = nodes, size = size, bytes = pack({type = "scene",
    scene = id, title = about.title, bones = bones, joints = json.list(skeleton.joint_names),
    root = skeleton.root,
    colours = live_pack.colours(), strength = about.strength, size = size,
    elements = state.shape.mesh.element_count},
    {{"triangles", "u4", surface.triangles:tostring("<u4", -1)}})}
end

-- The axes of every bone where it stands now, by rows: x along the bone.
local function axes(state)
  local rest, rotated = state.topology.skeleton.frames:totable(), state.shape.rotations:totable()
  local out = json.list {}
  for b, frame in ipairs(rest) do
    local r, row = rotated[b], {}
    for i = 0, 6, 3 do
      for j = 1, 3 do
        row[i + j] = r[3 * j - 2] * frame[i + 1] + r[3 * j - 1] * frame[i + 2] + r[3 * j] * frame[i + 3]
      end
    end
    out[b] = row
  end
  return out
end

local function factors(state)
  local out = json.list {}
  for b, row in ipairs(state.pose) do out[b] = {row[10], row[11], row[12]} end
  return out
end

-- How far bones may turn when a joint is reached for, in degrees.
local function joint_limits(state)
  local out = json.list {}
  for b = 1, #state.pose do
    local limit = state.limits[b]
    out[b] = limit and {swing = limit.swing and math.deg(limit.swing),
      twist = limit.twist_min and json.list {math.deg(limit.twist_min), math.deg(limit.twist_max)}}
      or json.null
  end
  return out
end

local function positions(scene, state)
  return {"positions", "f4", state.shape.mesh.nodes:gather(scene.nodes):tostring "<f4"}
end

local function place(header, scene, state)
  header.scene = scene.id
  header.joints = json.list(state.topology.skeleton:posed_joints(state.shape.maps):totable())
  header.axes = axes(state)
end

--- A shape alone, to be shown while its stresses are computed.
function live_frame.shape(scene, state, drag)
  local header = {type = "shape", drag = drag}
  place(header, scene, state)
  return pack(header, {positions(scene, state)})
end

--- A state of a session, or of a fork of it: `header` has what the controller adds.
function live_frame.state(scene, state, result, header)
  local mesh = state.shape.mesh
  header.type = "state"
  place(header, scene, state)
  header.factors, header.mesh = factors(state), state.note or "posed"
  header.joint_limits = joint_limits(state)
  local blocks = {positions(scene, state)}
  if result then
    local stress = result.von_mises
    local worst = stress:argmax()
    header.maximum, header.node = stress[worst], worst
    header.at = mesh.nodes:rows(worst, worst):totable()[1]
    header.error = result:error_estimate()
    header.reused = tostring(result.reused)
    blocks[2] = {"von_mises", "f4", stress:gather(scene.nodes):tostring "<f4"}
    blocks[3] = {"displacement", "f4", result.displacement:gather(scene.nodes):tostring "<f4"}
  end
  return pack(header, blocks)
end

live_frame.read = live_pack.read

return live_frame
