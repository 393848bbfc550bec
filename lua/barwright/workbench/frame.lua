-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The scene of a workbench as a binary message (live_pack): the surface of the part with the face of each
-- triangle, or the boundary of the mesh of a result with stress and displacement.
local core = require "barwright.core"
local live_pack = require "barwright.live_pack"

local frame = {}

local function faces_block(labels)
  return {"faces", "u4", labels:tostring("<i4", -1)} -- 0, no face, becomes 0xFFFFFFFF
end

local function blocks_of(surface, labels)
  return {{"positions", "f4", surface.points:tostring "<f4"},
    {"triangles", "u4", surface.triangles:tostring("<u4", -1)}, labels and faces_block(labels) or nil}
end

local function header_of(kind, surface, revision)
  return {type = "scene", kind = kind, revision = revision, colours = live_pack.colours(),
    points = surface.point_count, triangles = surface.triangle_count,
    box = {min = surface.box.min, max = surface.box.max}}
end

--- The surface of a file as it was read, before anything is known of it.
function frame.raw(surface, revision)
  return live_pack.pack(header_of("file", surface, revision), blocks_of(surface))
end

--- The boundary of the mesh of a solution; nil, message, details where it cannot be made.
function frame.result(static, labels, revision)
  local surface, nodes, details = static.mesh:surface()
  if not surface then return nil, nodes, details end
  local header, blocks = header_of("result", surface, revision), blocks_of(surface, labels)
  local stress = static.von_mises:gather(nodes)
  header.von_mises_max = static.von_mises:max()
  header.displacement_max = static.displacement:map "norm(a)":max()
  blocks[#blocks + 1] = {"von_mises", "f4", stress:tostring "<f4"}
  blocks[#blocks + 1] = {"displacement", "f4", static.displacement:gather(nodes):tostring "<f4"}
  return live_pack.pack(header, blocks)
end

-- The largest stress of all worst loads, where each place is weak: on the boundary of the mesh.
local function weakness(entry, worst)
  local surface, nodes = worst.mesh:surface()
  local labels = core.face_labels(entry.body.surface, entry.body.labels, worst.mesh)
  local stress = surface and labels and worst.mesh:to_nodes(worst.weakness)
  if not stress then return nil end
  local header, blocks = header_of("result", surface, entry.revision), blocks_of(surface, labels)
  header.von_mises_max = stress:max()
  blocks[#blocks + 1] = {"von_mises", "f4", stress:gather(nodes):tostring "<f4"}
  return live_pack.pack(header, blocks)
end

--- The scene of an entry of the history: its shape, or its result where there is one.
function frame.entry(entry)
  local solved = entry.solved
  local worst = solved and solved.breaking and solved.breaking.worst
  local bytes = worst and weakness(entry, worst)
    or solved and solved.static and frame.result(solved.static, solved.labels, entry.revision)
  if bytes then return bytes end
  return live_pack.pack(header_of("shape", entry.body.surface, entry.revision),
    blocks_of(entry.body.surface, entry.body.labels))
end

return frame
