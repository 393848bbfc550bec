-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Pages about one body: fields and displacements over its nodes, on its boundary with the mid-edge nodes.
-- web/README.md names what the view takes.
local core = require "barwright.core"
local fine_boundary = require "barwright.fine_boundary"
local json = require "barwright.json"
local report = require "barwright.report"

local body_page = {}

-- What an array, or one for each frame, is on the boundary. `nodes` is nil where it is there already.
local function floats(values, nodes, scale)
  local frames, parts = core.class_name(values) == "array" and {values} or values, {}
  for i, array in ipairs(frames) do
    array = nodes and array:gather(nodes) or array
    parts[i] = (scale and array * scale or array):tostring "<f4"
  end
  return core.base64(table.concat(parts))
end

--- Writes a page about a mesh: {title =, verdict = (report_verdict.lua) or nil, answer =, callout = {at =, text =}
--- or nil, picture = function(path), and
--- fields = {{name =, unit =, values =, scale =, limit = the strength in this unit or nil}},
--- displacements = {{name =, kind =, values =, imaginary =, field = from 0, or nil, arrows =, times =, seconds =,
--- factor =}}: values over the nodes, or where a `surface` is given, when the mesh may be nil, over its points; a
--- list with an array for each frame where they change in time,
--- lines =, line_name =, rigid =: lines that the view draws, and whether they stay where they are,
--- view = function(surface, nodes) -> direction to the viewer,
--- body = HTML below the view, rows = what a row of its table shows,
--- manifest = what it has besides the version and the number of elements}.
function body_page.write(path, mesh, about)
  local surface, nodes = about.surface, nil
  if not surface then
    local why
    surface, nodes, why = fine_boundary(mesh)
    if not surface then return nil, nodes, why end
  end
  local data, motions = report.data(surface), about.displacements or {}
  for i, field in ipairs(about.fields) do
    local values = floats(field.values, nodes, field.scale)
    data.fields[i] = {name = field.name, unit = field.unit, values = values, limit = field.limit}
  end
  for i, motion in ipairs(motions) do
    data.displacements[i] = {name = motion.name, kind = motion.kind, values = floats(motion.values, nodes),
      imaginary = motion.imaginary and floats(motion.imaginary, nodes), field = motion.field or json.null,
      arrows = json.list(motion.arrows or {}), times = motion.times, seconds = motion.seconds,
      factor = motion.factor}
  end
  data.lines, data.rigid = report.lines(about.lines), about.rigid
  data.callout = report.callout(about.callout)
  if about.view then
    local view, message, why = about.view(surface, nodes)
    if not view then return nil, message, why end
    data.view = json.list(view)
  end
  local manifest = {version = core.version, elements = mesh and mesh.element_count}
  for name, value in pairs(about.manifest or {}) do manifest[name] = value end
  return report.page(path, {title = about.title, verdict = about.verdict, answer = about.answer, data = data,
    body = report.legend(about) .. (about.body or ""), rows = about.rows, manifest = manifest,
    picture = about.picture})
end

return body_page
