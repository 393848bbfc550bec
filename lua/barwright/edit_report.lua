-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The report of an edit session: the shape as it is, with the stress under its loads, beside the shape
-- as it was drawn; what the bones were changed by; the edits.
local core = require "barwright.core"
local html = require "barwright.html"
local json = require "barwright.json"
local options = require "barwright.options"
local report = require "barwright.report"
local shown = require "barwright.shown"

local edit_report = {}

local rules = {title = {type = "string"}, manifest = {type = "table"}}

-- Where boundary nodes of a state's mesh were at first.
local function as_drawn(session, state, nodes)
  local from = state.topology.node_from
  return session.rest.nodes:gather(from and from:gather(nodes) or nodes)
end

local function data_of(session, state, result)
  local mesh = state.shape.mesh
  local surface, nodes, details = mesh:surface()
  if not surface then return nil, nodes, details end
  local data = report.data(surface)
  local labels = core.array.map("a + 0", {a = session.subdomains.node_subdomain})
  data.fields[1] = {name = "von Mises stress", unit = "MPa",
    values = report.floats(result.von_mises:gather(nodes) * 1e-6)}
  data.fields[2] = {name = "subdomain", unit = "", values = report.floats(labels:gather(nodes))}
  data.displacements[1] = {name = "under its loads", kind = "load",
    values = report.floats(result.displacement:gather(nodes)), field = 0, arrows = json.list {}}
  data.displacements[2] = {name = "as it was drawn", kind = "shape",
    values = report.floats(as_drawn(session, state, nodes) - mesh.nodes:gather(nodes)),
    field = json.null, arrows = json.list {}}
  return data
end

-- Bones that are not at rest.
local function table_of_bones(session)
  local rows = {}
  for _, name in ipairs(session.skeleton.bone_names) do
    local bone = session:bone(name)
    local text = tostring(bone)
    if not text:find("at rest", 1, true) then
      rows[#rows + 1] = {name, (text:gsub("^.- mm, ", ""))}
    end
  end
  return "<h2>Bones</h2>\n" .. html.table({"bone", "change since it was drawn"}, rows)
end

local function table_of_edits(session)
  local rows = {}
  for i, edit in ipairs(session.edits) do rows[i] = {i, edit.script, edit.mesh} end
  return "<h2>Edits</h2>\n" .. html.table({"number", "edit", "mesh"}, rows)
end

local function answer(session, result)
  local highest, node = result.von_mises:max(), result.von_mises:argmax()
  local nodes = result.mesh.nodes
  return ("%s von Mises at %s, estimated error %s; %d edit%s"):format(core.quantity(highest, "Pa"),
    core.point {nodes(node, 1), nodes(node, 2), nodes(node, 3)}, shown.error(result:error_estimate()),
    #session.edits, #session.edits == 1 and "" or "s")
end

--- Writes the report to a path. Options: title, manifest.
function edit_report.write(session, state, result, path, given)
  local opts = options.read("report", given, rules)
  local data, message, details = data_of(session, state, result)
  if not data then return nil, message, details end
  return report.page(path, {
    title = opts.title or "Edit session",
    answer = answer(session, result),
    manifest = opts.manifest or {version = core.version},
    body = table_of_bones(session) .. table_of_edits(session)
      .. "<p>The last solution reused: " .. html.escape(tostring(result.reused)) .. ".</p>\n",
    data = data,
    picture = function(name) return result:picture(name) end,
  })
end

return edit_report
