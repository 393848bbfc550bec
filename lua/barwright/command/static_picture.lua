-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The picture and the page of `barwright statics`: arrows for the loads, the borders of the supports as lines, the
-- edge of a finding, and a title with the answer.
local body_page = require "barwright.body_page"
local core = require "barwright.core"
local distance = require("barwright.points").distance
local has_strength = require "barwright.has_strength"
local model = require "barwright.command.model"
local places = require "barwright.command.places"
local shown = require "barwright.shown"

local static_picture = {}

-- A pressure is drawn as so many arrows at most.
local PRESSURES = 7

local function node_at(mesh, node)
  return {mesh.nodes(node, 1), mesh.nodes(node, 2), mesh.nodes(node, 3)}
end

-- The node of a selection that lies nearest to a point.
local function nearest(selection, point)
  local best, min
  for _, node in ipairs(selection.nodes:totable()) do
    local at = node_at(selection.mesh, node)
    local away = distance(at, point)
    if not min or away < min then best, min = at, away end
  end
  return best
end

local function force_arrow(selection, force)
  return {{at = nearest(selection, selection.centre), force = force}}
end

local function facet_arrow(mesh, facet, force)
  local a, b, c = node_at(mesh, mesh.facets(facet, 1)), node_at(mesh, mesh.facets(facet, 2)),
    node_at(mesh, mesh.facets(facet, 3))
  local at, normal, length = {}, {}, 0
  for k = 1, 3 do
    local i, j = k % 3 + 1, (k + 1) % 3 + 1
    at[k] = (a[k] + b[k] + c[k]) / 3
    normal[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i])
    length = length + normal[k] ^ 2
  end
  for k = 1, 3 do normal[k] = -force * normal[k] / math.sqrt(length) end
  return {at = at, force = normal}
end

local function pressure_arrows(selection, pressure)
  local facets, arrows = selection.facets:totable(), {}
  local count = math.min(PRESSURES, #facets)
  for i = 1, count do
    arrows[i] = facet_arrow(selection.mesh, facets[math.ceil((i - 0.5) / count * #facets)],
      pressure * selection.area / count)
  end
  return arrows
end

--- Arrows {at =, force =} of the loads on a mesh, as the command reads them; mass: kg, for gravity.
function static_picture.arrows(mesh, loads, mass)
  local arrows = {}
  for _, load in ipairs(loads) do
    local selection = assert(places.select(mesh, load.place))
    local new = load.force and force_arrow(selection, load.force) or pressure_arrows(selection, load.pressure)
    table.move(new, 1, #new, #arrows + 1, arrows)
  end
  if loads.gravity and mass then
    local weight = {}
    for k = 1, 3 do weight[k] = mass * loads.gravity[k] end
    arrows[#arrows + 1] = force_arrow(mesh.boundary, weight)[1]
  end
  return arrows
end

--- The border of a selection: the edges that one of its facets has, as lines of two points.
function static_picture.border(selection)
  local mesh, count, ends = selection.mesh, {}, {}
  for _, facet in ipairs(selection.facets:totable()) do
    for i = 1, 3 do
      local p, q = mesh.facets(facet, i), mesh.facets(facet, i % 3 + 1)
      local key = ("%d %d"):format(math.min(p, q), math.max(p, q))
      count[key] = (count[key] or 0) + 1
      if count[key] == 1 then ends[#ends + 1] = {key, p, q} end
    end
  end
  local lines = {}
  for _, edge in ipairs(ends) do
    if count[edge[1]] == 1 then lines[#lines + 1] = {node_at(mesh, edge[2]), node_at(mesh, edge[3])} end
  end
  return lines
end

--- The title for {stress =, error =, verdict = words}: the largest von Mises stress, or where that has no finite
--- value what is judged, `judged` = {used = over the strength, error =, strength =}.
function static_picture.title(name, about)
  local value, error = "largest von Mises stress " .. shown.estimate(about.stress, "Pa"), about.error
  local judged = about.judged
  if judged and not judged.used then return name .. ": the largest stress has no finite value" end
  if judged then
    error = judged.error
    value = type(judged.strength) == "number"
      and "judged mean stress " .. shown.estimate(judged.used * judged.strength, "Pa")
      or ("judged mean stress %s of the strength"):format(shown.percent(judged.used))
  end
  local verdict = about.verdict and "; " .. about.verdict or ""
  return ("%s: %s ± %s%s"):format(name, value, shown.error(error), verdict)
end

--- Options of static:picture for a title, loads, places of supports, a finding or nil, and the mass (kg) or nil.
function static_picture.options(static, title, loads, supports, singular, mass)
  local mesh, lines = static.mesh, {}
  for _, place in ipairs(supports) do
    local border = static_picture.border(assert(places.select(mesh, place)))
    table.move(border, 1, #border, #lines + 1, lines)
  end
  local edge = model.edge_lines(singular)
  table.move(edge.lines or {}, 1, #(edge.lines or {}), #lines + 1, lines)
  local arrows = static_picture.arrows(mesh, loads, mass)
  return {title = title, lines = lines, arrows = arrows, line_name = "border of the supports"
    .. (edge.lines and "; " .. edge.line_name or "")}
end

--- Writes the page: options as of static:picture (title, lines, line_name, arrows), and what stands above
--- the view, {text = sentences, head =, callout =}, the last two as of body_page. The view begins from where the
--- picture is drawn.
function static_picture.report(static, path, options, answer)
  local moved, strength = static.displacement, static.material.strength
  local fields = {{name = "von Mises stress", unit = "MPa", values = static.von_mises, scale = 1e-6,
    limit = type(strength) == "number" and strength * 1e-6 or nil},
    {name = "displacement", unit = "mm", values = moved:map "norm(a)", scale = 1e3}}
  if static.material.parts and has_strength(static.material) then
    fields[3] = {name = "of the strength", unit = "%", values = static.mesh:to_nodes(static.utilisation, "max"),
      scale = 100, limit = 100}
  end
  return body_page.write(path, static.mesh, {title = options.title, verdict = answer.head, answer = answer.text,
    callout = answer.callout, fields = fields,
    displacements = {{name = "under its loads", kind = "load", values = moved, field = 0,
      arrows = options.arrows}},
    lines = options.lines, line_name = options.line_name, view = function(surface, nodes)
      return core.picture_direction(surface, nil, {values = static.von_mises:gather(nodes),
        displacement = moved:gather(nodes), arrows = options.arrows})
    end, manifest = {material = static.material.name},
    picture = function(name) return static:picture(name, options) end})
end

return static_picture
