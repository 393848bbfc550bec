-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The pages of `barwright buckle`: a view of the part under its load and in its buckling shapes, and the sentences
-- that the command says.
local bw = require "barwright"
local body_page = require "barwright.body_page"
local shown = require "barwright.shown"

local buckle_page = {}

--- Writes a page. load: {name, unit, values over nodes, scale, displacement, arrows or nil} of the part under it;
--- picture: of a file name, where the view cannot be shown.
function buckle_page.write(path, title, buckling, load, sentences, picture)
  local moves = {}
  for i = 1, buckling.count do
    local name = ("buckling shape %d: load factor %s"):format(i, shown.number(buckling.factors[i]))
    moves[i] = {name = name, kind = "mode", values = buckling:shape(i)}
  end
  moves[buckling.count + 1] = {name = "under the load", kind = "load", values = load.displacement, field = 0,
    arrows = load.arrows}
  return body_page.write(path, buckling.mesh, {title = title, answer = table.concat(sentences, "\n"),
    fields = {{name = load.name, unit = load.unit, values = load.values, scale = load.scale}},
    displacements = moves,
    picture = picture, manifest = {load_factors = bw.json.list(buckling.factors:totable())}})
end

return buckle_page
