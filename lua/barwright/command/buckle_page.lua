-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The pages of `barwright buckle`: a view of the part under its load and in its buckling shapes, and the sentences
-- that the command says.
local bw = require "barwright"
local fine_boundary = require "barwright.fine_boundary"
local report = require "barwright.report"
local shown = require "barwright.shown"

local buckle_page = {}

--- Writes a page. load: {name, unit, values over nodes, scale, displacement, arrows or nil} of the part under it;
--- picture: of a file name, where the view cannot be shown.
function buckle_page.write(path, title, buckling, load, sentences, picture)
  local mesh = buckling.mesh
  local surface, nodes, details = fine_boundary(mesh)
  if not surface then return nil, nodes, details end
  local data = report.data(surface)
  data.fields[1] = {name = load.name, unit = load.unit,
    values = report.floats(load.values:gather(nodes) * load.scale)}
  for i = 1, buckling.count do
    local name = ("buckling shape %d: load factor %s"):format(i, shown.number(buckling.factors[i]))
    data.displacements[i] = {name = name, kind = "mode",
      values = report.floats(buckling:shape(i):gather(nodes)), field = bw.json.null, arrows = bw.json.list {}}
  end
  data.displacements[buckling.count + 1] = {name = "under the load", kind = "load",
    values = report.floats(load.displacement:gather(nodes)), field = 0, arrows = bw.json.list(load.arrows or {})}
  return report.page(path, {title = title, answer = table.concat(sentences, "\n"), data = data, body = "",
    picture = picture, manifest = {version = bw.version(), elements = mesh.element_count,
      load_factors = bw.json.list(buckling.factors:totable())}})
end

return buckle_page
