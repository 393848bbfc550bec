-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The pages of `barwright drop`: a view of the part, and the sentences that the command says.
local body_page = require "barwright.body_page"
local obstacle = require "barwright.obstacle"

local drop_page = {}

local VIEW = 2 -- the largest scale of the view's slider

-- From the side and a little below, where the obstacle and what touches it are seen.
local function view_along(down)
  local from = {1, -1.4, 0.8}
  local size = down[1] ^ 2 + down[2] ^ 2 + down[3] ^ 2
  local part = (from[1] * down[1] + from[2] * down[2] + from[3] * down[3]) / size
  local along = 0.5 / math.sqrt(size) - part
  return {from[1] + along * down[1], from[2] + along * down[2], from[3] + along * down[3]}
end

-- At this factor the largest displacement is a tenth of the diagonal of the part's box.
local function factor_of(drop)
  local box, square = drop.mesh.box, 0
  for k = 1, 3 do square = square + (box.max[k] - box.min[k]) ^ 2 end
  local largest = drop.displacement:map("norm(a)"):max()
  return largest > 0 and 0.1 * math.sqrt(square) / largest or 1
end

-- words: {title =, head = (report_verdict.lua), answer = sentences, down = of a single drop}; fields: {name, unit,
-- array over elements, scale} each; moved: displacements of nodes and the factor at which they are drawn, or nil;
-- drawn: lines and their name, or nil.
local function write(result, path, words, fields, moved, drawn)
  local mesh, shown = result.mesh, {}
  for i, field in ipairs(fields) do
    shown[i] = {name = field[1], unit = field[2], values = mesh:to_nodes(field[3], "max"), scale = field[4]}
  end
  return body_page.write(path, mesh, {title = words.title, verdict = words.head,
    answer = words.answer, fields = shown,
    displacements = moved and {{name = "at the largest stress", kind = "load", values = moved.values,
      factor = moved.factor, field = 0}},
    body = moved and "<p>The deformation is drawn larger than it is, by the factor beside the slider. The part is "
      .. "moved along its fall so that no drawing enters what it falls on.</p>\n",
    lines = drawn and drawn.lines, line_name = drawn and drawn.line_name, rigid = true,
    view = words.down and function() return view_along(words.down) end, manifest = {modes = result.modes.count},
    picture = function(name) return result:picture(name, {title = words.title}) end})
end

--- One drop, a bw.Drop with stresses.
function drop_page.of_drop(drop, path, words)
  local fields = {{"largest principal stress over time", "MPa", drop.max_principal, 1e-6}}
  if drop.utilisation then fields[2] = {"of the strength", "%", drop.utilisation, 100} end
  -- A deformation that is drawn larger than it is would enter the obstacle: the part is drawn above it.
  local factor, down = factor_of(drop), words.down
  local values = obstacle.above(drop.onto, drop.mesh, drop.displacement, VIEW * factor,
    {-down[1], -down[2], -down[3]})
  return write(drop, path, words, fields, {values = values, factor = factor},
    obstacle.drawn(drop.onto, drop.mesh, drop.impacts[1].place))
end

--- Random drops, a bw.RandomDrops.
function drop_page.of_random(drops, path, words)
  return write(drops, path, words, {{"drops that overload", "%", drops.exceedance, 100},
    {"mean largest principal stress", "MPa", drops.mean_peak, 1e-6}})
end

return drop_page
