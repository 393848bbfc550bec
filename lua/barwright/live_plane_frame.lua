-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the page of the plane's live view receives: binary messages (live_pack): a scene (what stays while
-- the outline's topology does), a mesh (its triangles), states. docs/live.md has the fields.
local json = require "barwright.json"
local kinds = require "barwright.live_plane_kinds"
local live_pack = require "barwright.live_pack"

local live_plane_frame = {}

local function segments(outline)
  local bytes = {}
  for i, row in ipairs(outline.segments:totable()) do
    bytes[i] = ("<I4I4I4I4I4"):pack(row[1], row[2], row[3], row[4], row[5])
  end
  return table.concat(bytes)
end

-- An outline as lines to be drawn, x, y each; nan between the loops.
local function polygons(outline)
  local bytes = {}
  for _, loop in ipairs(assert(outline:polygons())) do
    local first = loop:rows(1, 1)
    bytes[#bytes + 1] = loop:tostring "<f4" .. first:tostring "<f4" .. ("<ff"):pack(0 / 0, 0 / 0)
  end
  return table.concat(bytes)
end

--- The scene of an object: segments, loops, fields, what the page offers.
function live_plane_frame.scene(controller, id)
  local object, kind, about = controller.object, controller.kind, controller.about
  local outline = object.outline
  local loops = json.list {}
  for i, loop in ipairs(outline.loops) do
    loops[i] = {name = loop.name, first = loop.first, count = loop.count, region = loop.region or 0,
      parent = loop.parent}
  end
  local blocks = {{"segments", "u4", segments(outline)}}
  if about.goal then blocks[2] = {"goal", "f4", polygons(about.goal)} end
  return live_pack.pack({type = "scene", scene = id, title = about.title, kind = kind.title,
    fields = json.list(kinds.fields(kind)), deform = kind.deform ~= nil, arrows = kind.arrows ~= nil,
    true_size = kind.true_size or false,
    mirror = kind.mirror or false, stress = kind.stress or false, tune = kind.tune or false,
    steps = controller.steps, step = controller.steps and object.opts.step or nil, size = controller.size,
    colours = live_pack.colours(), loops = loops, tags = json.list(outline.tags)}, blocks)
end

--- The triangles, corners and mid-edge nodes; as text, to be compared.
function live_plane_frame.triangles(object)
  return object.elements:tostring("<u4", -1)
end

function live_plane_frame.mesh(object, id, bytes)
  return live_pack.pack({type = "mesh", mesh = id, corners = object.elements.column_count,
    elements = object.element_count, nodes = object.node_count}, {{"elements", "u4", bytes}})
end

local function as_list(rows)
  local out = json.list {}
  for i, row in ipairs(rows) do out[i] = json.list(row) end
  return out
end

--- A state: the outline, where the nodes are, the fields that windows look at. `header` has what the
--- controller adds, `shown` is a set of keys of fields.
function live_plane_frame.state(object, kind, shown, header)
  local outline, reuse = object.outline, object.reused
  header.type = "state"
  header.level, header.reused = header.level or reuse.level, tostring(reuse)
  header.iterations, header.quality = reuse.iterations, reuse.quality
  header.area, header.elements = outline.area, object.element_count
  local blocks = {{"outline", "f4", outline.points:tostring "<f4"},
    {"positions", "f4", object.points:tostring "<f4"}}
  header.fields = {}
  local von_mises -- once, where it is also a field
  for _, field in ipairs(kind.fields) do
    local values = shown[field.key] and field.values(object)
    if values then
      if field.key == "von_mises" then von_mises = values end
      blocks[#blocks + 1] = {field.key, "f4", values:tostring "<f4"}
      header.fields[field.key] = json.list {values:min(), values:max()}
    end
  end
  if kind.stress then
    von_mises = von_mises or object.von_mises
    local at = von_mises:argmax()
    header.maximum, header.at = von_mises[at], json.list(object.points:rows(at, at):totable()[1])
  end
  local deform = kind.deform and kind.deform(object)
  if deform then blocks[#blocks + 1] = {"deform", "f4", deform:tostring "<f4"} end
  local arrows = kind.arrows and kind.arrows(object)
  if arrows then blocks[#blocks + 1] = {"arrows", "f4", arrows:tostring "<f4"} end
  local lines = kind.lines and kind.lines(object)
  if lines then blocks[#blocks + 1] = {"lines", "f4", lines:tostring "<f4"} end
  if kind.steps then header.time = object.time end
  if kind.header then kind.header(object, header) end
  header.readouts = as_list(kind.readouts(object))
  return live_pack.pack(header, blocks)
end

live_plane_frame.read = live_pack.read

return live_plane_frame
