-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Reports: one HTML file that opens from disk and needs no network; here that of a worst case. The
-- page is web/report.html, its view web/viewer.mjs; web/README.md names the placeholders and the data.
local beside = require "barwright.beside"
local core = require "barwright.core"
local html = require "barwright.html"
local json = require "barwright.json"
local judged_stress = require "barwright.judged_stress"
local options = require "barwright.options"
local report_verdict = require "barwright.report_verdict"
local shown = require "barwright.shown"

local report = {}

local rules = {
  title = {type = "string"},
  manifest = {type = "table"},
  loads = {type = "integer", default = 6, min = 1}, -- how many regions' loads can be shown
  modes = {type = "integer", default = 15, min = 0},
  lines = {type = "table"}, -- lists of points, drawn over the surface
  line_name = {type = "string"}, -- what they are
  view = {type = "table"}, -- from the object to the viewer
  answer = {type = "string"}, -- sentences in place of that of the largest stress
  verdict = {type = "table"}, -- the head of the page (report_verdict.lua)
  callout = {type = "table"}, -- {at =, text =}: a place with its text in the view
  region = {type = "integer", min = 1}, -- the one whose load is shown first; the worst one if left out
}

--- An array as the page takes it.
function report.floats(array)
  return core.base64(array:tostring "<f4")
end

local floats = report.floats

local function colours()
  local knots = {}
  for i = 0, 32 do knots[i + 1] = {core.colour(i / 32)} end
  return knots
end

--- The data of a page about a surface, without fields and displacements yet.
function report.data(surface)
  return {
    positions = floats(surface.points),
    triangles = core.base64(surface.triangles:tostring("<u4", -1)),
    colours = colours(),
    fields = json.list {},
    displacements = json.list {},
    view = {1, -1.4, 0.8},
  }
end

-- The regions whose loads are shown: one first, then the others by how much stress they cause.
local function chosen_regions(worst, count, first)
  local order = {}
  for i = 1, #worst.regions do order[i] = i end
  table.sort(order, function(a, b)
    if (a == first) ~= (b == first) then return a == first end
    local p, q = worst.regions[a].max_principal, worst.regions[b].max_principal
    if p ~= q then return p > q end
    return a < b
  end)
  local out = {}
  for i = 1, math.min(count, #order) do out[i] = order[i] end
  return out
end

-- The strength in MPa, where one number is known: what colours go up to.
local function limit_of(worst)
  return type(worst.strength) == "number" and worst.strength * 1e-6 or nil
end

local function add_loads(worst, nodes, data, drawn)
  local mesh, judged = worst.mesh, judged_stress(worst.options.failure)
  for k, region in ipairs(drawn) do
    local u, message, details = worst:displacement(region)
    if not u then return nil, message, details end
    local stress
    stress, message, details = worst:stress(region)
    if not stress then return nil, message, details end
    local about = worst.regions[region]
    local name = about.label
    data.fields[#data.fields + 1] = {name = judged.name .. " under the load of " .. name, unit = "MPa",
      limit = limit_of(worst),
      values = floats(mesh:to_nodes(judged.of(stress), "max"):gather(nodes) * 1e-6)}
    data.displacements[k] = {name = "worst load of " .. name, kind = "load",
      values = floats(u:gather(nodes)), field = #data.fields - 1,
      arrows = json.list(worst:arrows(region))}
  end
  return true
end

local function add_modes(worst, nodes, data, count)
  local modes = worst.modes
  if not modes or modes.components ~= 3 then return end
  local frequencies = modes.frequencies
  for i = 1, math.min(count, modes.count) do
    data.displacements[#data.displacements + 1] = {
      name = ("mode %d"):format(i) .. (frequencies and ": " .. core.quantity(frequencies[i], "Hz") or ""),
      kind = "mode", values = floats(modes:shape(i):gather(nodes)), field = json.null,
      arrows = json.list {}}
  end
end

local function table_of_regions(worst, drawn, first)
  local motion, order = {}, chosen_regions(worst, #worst.regions, first)
  for k, region in ipairs(drawn) do motion[region] = k - 1 end
  local rows = {}
  for i, number in ipairs(order) do
    local region = worst.regions[number]
    rows[i] = {["data-motion"] = motion[number], region.label, shown.percent(region.volume_fraction),
      core.quantity(region.max_principal, "Pa"), region.utilisation and shown.percent(region.utilisation) or "",
      core.point(region.at), core.quantity(region.displacement, "m")}
  end
  return "<h2>Weak regions, the largest stress first</h2>\n" .. html.table({"found from", "volume", "stress",
    "of strength", "at", "largest displacement"}, rows, "ranked")
end

--- What the lines in the view stand for, as HTML.
function report.legend(opts)
  if not opts.lines or #opts.lines == 0 or not opts.line_name then return "" end
  return ('<p><span style="color:#6014d6">&#9473;&#9473;</span> %s</p>\n'):format(html.escape(opts.line_name))
end

local function data_of(worst, opts, drawn)
  local surface, nodes, details = worst.mesh:surface()
  if not surface then return nil, nodes, details end
  local data = report.data(surface)
  data.fields[1] = {name = "weakness (largest principal stress)", unit = "MPa", limit = limit_of(worst),
    values = floats(worst.mesh:to_nodes(worst.weakness, "max"):gather(nodes) * 1e-6)}
  local ok, message
  ok, message, details = add_loads(worst, nodes, data, drawn)
  if not ok then return nil, message, details end
  data.fields[#data.fields + 1] = {name = "pressure of the worst load", unit = "MPa",
    values = floats(worst:pressure():gather(nodes) * 1e-6)}
  -- Many points make a heavy page: fewer modes then.
  local max = math.max(3, math.floor(1.5e6 / surface.point_count))
  add_modes(worst, nodes, data, math.min(opts.modes, max))
  return data
end

local function vector_of(name, given)
  local list = json.list {}
  for k = 1, 3 do
    local x = type(given) == "table" and given[k]
    if type(x) ~= "number" or x ~= x or math.abs(x) == math.huge then
      core.raise(("report: option '%s': three finite numbers expected, got %s"):format(name, core.got(given)))
    end
    list[k] = x
  end
  return list
end

--- Lines that the view draws, lists of points each, as the page takes them; nil where there are none.
function report.lines(lines)
  if not lines then return nil end
  local list = json.list {}
  for i, line in ipairs(lines) do
    local points = json.list {}
    for k, point in ipairs(core.class_name(line) == "array" and line:totable() or line) do
      points[k] = vector_of("lines", point)
    end
    list[i] = points
  end
  return list
end

--- A place with its text in the view: {at =, text =}; nil where there is none.
function report.callout(given)
  if not given then return nil end
  return {at = vector_of("callout", given.at), text = given.text}
end

-- The picture that `draw(path)` makes, for a page whose bundle was not built.
local function picture(draw, path)
  local temporary <close> = core.temporary(path)
  local name = temporary and temporary.path .. ".png"
  return name and draw(name) and html.image(name, "picture") or ""
end

--- Writes a page: {title, verdict (report_verdict.lua) or nil,
--- answer, manifest, body (HTML), rows = what a row of its table shows, data,
--- picture = function(path)}.
function report.page(path, page)
  local template = beside.find "report.html"
  if not template then return nil, "the report's template was not found", {status = "io"} end
  local viewer = beside.find "viewer.js"
  return core.write_file(path, html.fill(template, {
    title = html.escape(page.title),
    verdict = report_verdict.html(page.verdict),
    answer = html.escape(page.answer),
    manifest = html.escape(json.encode(page.manifest, "  ")),
    body = page.body,
    rows = page.body:find("data-motion", 1, true) and "; a row of the table shows its " .. page.rows or "",
    data = html.in_script(json.encode(page.data)),
    viewer = viewer and html.in_script(viewer) or "",
    picture = viewer and "" or picture(page.picture, path),
  }))
end

-- The head of the page of a worst case alone, whose stress has no error bar: it judges nothing.
local function verdict_of(worst)
  local used = worst.strength and type(worst.strength) == "number" and worst.max_principal / worst.strength
  return {verdict = "computed", word = used and ("%s of the strength"):format(shown.percent(used))
    or core.quantity(worst.max_principal, "Pa"),
    headline = "The largest stress under the worst load, on one mesh: its error is not estimated.",
    facts = {{"Force", worst.options.force and core.quantity(worst.options.force, "N")},
      {"Largest stress", core.quantity(worst.max_principal, "Pa")}, {"Place", core.point(worst.at)},
      {"Largest displacement", core.quantity(worst.max_displacement, "m")}}}
end

-- Options that JSON can hold: selections and places of other meshes are left out.
local function plain(given)
  local out = {}
  for key, value in pairs(given) do
    local kind = type(value)
    if kind == "number" or kind == "string" or kind == "boolean" then out[key] = value end
  end
  return out
end

--- Writes the report of a worst case to a path. Options: those above.
function report.write(worst, path, given)
  local opts = options.read("report", given, rules)
  if opts.region and opts.region > #worst.regions then
    core.raise(("report: option 'region': 1 to %d expected, got %d"):format(#worst.regions, opts.region))
  end
  local drawn = chosen_regions(worst, opts.loads, opts.region or worst.region)
  local data, message, details = data_of(worst, opts, drawn)
  if not data then return nil, message, details end
  data.view = opts.view and vector_of("view", opts.view) or data.view
  data.lines = report.lines(opts.lines)
  data.callout = report.callout(opts.callout)
  return report.page(path, {
    title = opts.title or "Worst-case analysis",
    verdict = opts.verdict or verdict_of(worst),
    answer = opts.answer or tostring(worst),
    manifest = opts.manifest or {version = core.version, options = plain(worst.options)},
    body = report.legend(opts) .. table_of_regions(worst, drawn, drawn[1]),
    rows = "load",
    data = data,
    picture = function(name) return worst:picture(name, {lines = opts.lines, line_name = opts.line_name}) end,
  })
end

return report
