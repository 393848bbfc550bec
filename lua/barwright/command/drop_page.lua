-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The pages of `barwright drop`: a view of the part, and the sentences that the command says.
local bw = require "barwright"
local fine_boundary = require "barwright.fine_boundary"
local obstacle = require "barwright.obstacle"
local report = require "barwright.report"

local drop_page = {}

-- From the side and a little below, where the obstacle and what touches it are seen.
local function view_along(down)
  local from = {1, -1.4, 0.8}
  local size = down[1] ^ 2 + down[2] ^ 2 + down[3] ^ 2
  local part = (from[1] * down[1] + from[2] * down[2] + from[3] * down[3]) / size
  local along = 0.5 / math.sqrt(size) - part
  return {from[1] + along * down[1], from[2] + along * down[2], from[3] + along * down[3]}
end

-- words: {title =, answer = sentences, down = of a single drop}; fields: {name, unit, array over elements, scale}
-- each;
-- moved: displacements of nodes, or nil; drawn: lines and their name, or nil.
local function write(result, path, words, fields, moved, drawn)
  local mesh = result.mesh
  local surface, nodes, details = fine_boundary(mesh)
  if not surface then return nil, nodes, details end
  local data = report.data(surface)
  for i, field in ipairs(fields) do
    data.fields[i] = {name = field[1], unit = field[2],
      values = report.floats(mesh:to_nodes(field[3], "max"):gather(nodes) * field[4])}
  end
  if moved then
    data.displacements[1] = {name = "at the largest stress", kind = "load",
      values = report.floats(moved:gather(nodes)), field = 0}
  end
  data.lines = drawn and report.lines(drawn.lines)
  data.rigid = true -- lines do not follow the deformation
  data.view = words.down and view_along(words.down) or data.view
  return report.page(path, {title = words.title, answer = words.answer, data = data,
    body = drawn and report.legend(drawn) or "", manifest = {version = bw.version(),
      elements = mesh.element_count, modes = result.modes.count},
    picture = function(name) return result:picture(name, {title = words.title}) end})
end

--- One drop, a bw.Drop with stresses.
function drop_page.of_drop(drop, path, words)
  local fields = {{"largest principal stress over time", "MPa", drop.max_principal, 1e-6}}
  if drop.utilisation then fields[2] = {"of the strength", "%", drop.utilisation, 100} end
  return write(drop, path, words, fields, drop.displacement,
    obstacle.drawn(drop.onto, drop.mesh, drop.impacts[1].place))
end

--- Random drops, a bw.RandomDrops.
function drop_page.of_random(drops, path, words)
  return write(drops, path, words, {{"drops that overload", "%", drops.exceedance, 100},
    {"mean largest principal stress", "MPa", drops.mean_peak, 1e-6}})
end

return drop_page
