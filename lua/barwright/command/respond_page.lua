-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The pages of `barwright respond`: a view of the part with its deflection and its modes, plots, tables, and the
-- sentences that the command says.
local bw = require "barwright"
local body_page = require "barwright.body_page"
local core = require "barwright.core"
local deflection = require "barwright.deflection"
local html = require "barwright.html"
local model = require "barwright.command.model"
local modes_table = require "barwright.command.modes_table"
local page_head = require "barwright.command.page_head"
local places = require "barwright.command.places"
local shown = require "barwright.shown"
local static_picture = require "barwright.command.static_picture"

local respond_page = {}

-- A probability that is an upper bound, in words.
local function likely(probability)
  return probability < 1e-5 and "below 0.001 %" or "at most " .. shown.percent(probability)
end

local more_elements = "More --elements make the error smaller; less vibration or a thicker part leaves more "
  .. "margin."

--- The head of a page (report_verdict.lua). about: {verdict =, used = stress over strength or nil, estimated = its
--- relative error or nil, margins = of a random vibration or nil, allowed = the probability that is taken as safe,
--- at_end = what to do where the stress is largest at an end of the range, or nil, beyond = whether linear theory
--- is left, way = what the vibration is, damping =, facts =}; found: of the command.
function respond_page.head(found, about)
  local m, stress, displacement = about.margins, found.stress, found.displacement
  local at = stress.frequency and (" at %s Hz"):format(shown.number(stress.frequency)) or ""
  local facts = {page_head.margin(about.used, about.estimated),
    {"Exceeds the strength within " .. (m and core.quantity(m.duration, "s") or ""),
      m and ("probability %s; up to %s is taken as safe"):format(likely(m.first_passage[m.node]),
        shown.percent(about.allowed))},
    {"Largest von Mises stress", ("%s%s, %s"):format(shown.estimate(stress.value, "Pa"), at,
      core.point(stress.at))},
    {"Largest displacement", shown.estimate(displacement.value, "m")}}
  table.move(about.facts, 1, #about.facts, #facts + 1, facts)
  facts[#facts + 1] = {"Damping", shown.percent(about.damping) .. " of critical, in every mode"}
  facts[#facts + 1] = {"Linear theory", about.beyond and "left: the displacement is too large" or nil}
  facts[#facts + 1] = {"Assumption", about.way}
  local headline = page_head.used(about.used, about.estimated)
  if m then headline = headline .. " That is three times the root mean square." end
  local advice = {}
  if about.verdict == "exceeds" then
    advice[1] = "Move the natural frequencies away from the vibration (stiffer or lighter), or add damping."
  elseif about.verdict == "unsure" then
    if about.at_end then
      advice[1] = ("The stress is largest at an end of the range: %s."):format(about.at_end)
    end
    if about.estimated and (not about.at_end or model.verdict(about.used, about.estimated) == "unsure") then
      advice[#advice + 1] = more_elements
    end
  end
  return {verdict = about.verdict, headline = headline, facts = facts, advice = advice}
end

local map = bw.array.map

-- Plots, a list of {caption, figure}, as HTML.
local function plots(list)
  local out = {}
  for i, each in ipairs(list) do
    local svg, message, details = each[2]:svg()
    if not svg then return nil, message, details end
    out[i] = ("<figure><figcaption>%s</figcaption>\n%s</figure>\n"):format(html.escape(each[1]), svg)
  end
  return '<div class="plots">' .. table.concat(out) .. "</div>\n"
end

-- The edges of the places that are constrained.
local function borders(mesh, fix)
  local lines = {}
  for _, place in ipairs(fix) do
    local border = static_picture.border(assert(places.select(mesh, place)))
    table.move(border, 1, #border, #lines + 1, lines)
  end
  return lines
end

-- words: {title, head, answer, fix = places, picture, manifest}; the motions begin with what is `moved`, or with a
-- mode.
local function write(path, mesh, words, fields, motions, body)
  local moved = motions[1]
  return body_page.write(path, mesh, {title = words.title, verdict = words.head,
    answer = words.answer, fields = fields,
    displacements = motions, body = body, rows = "mode", lines = borders(mesh, words.fix),
    line_name = "border of the supports", view = moved and function(surface, nodes)
      return core.picture_direction(surface, nil, {values = fields[1].values:gather(nodes),
        displacement = moved.values:gather(nodes)})
    end, manifest = words.manifest, picture = words.picture})
end

-- The largest length over a period of a displacement of two parts.
local function amplitude(real, imaginary)
  return map("sqrt((a*a + b*b) / 2 + hypot((a*a - b*b) / 2, (s*s - d*d) / 4))", {a = real:map "norm(a)",
    b = imaginary:map "norm(a)", s = (real + imaginary):map "norm(a)", d = (real - imaginary):map "norm(a)"})
end

-- The deflection at a frequency as a motion of the page: its largest phase, and what it passes a quarter later.
local function swing(response, frequency, field)
  local real, imaginary, details = response:displacement(frequency)
  if not real then return nil, imaginary, details end
  local phase = deflection.largest_phase(real, imaginary)
  return {name = ("deflection at %s Hz"):format(shown.number(frequency)), kind = "harmonic", field = field,
    values = deflection.at_phase(real, imaginary, phase),
    imaginary = deflection.at_phase(real, imaginary, phase + math.pi / 2)}, real, imaginary
end

--- Of a vibration over a range: `found` of the command, and the curve where the displacement is largest.
function respond_page.harmonic(found, path, words, curve)
  local response, frequency = found.response, found.stress.frequency
  local motion, real, imaginary = swing(response, frequency, 0)
  if not motion then return nil, real, imaginary end
  local at, motions = (" at %s Hz"):format(shown.number(frequency)), {motion}
  local fields = {
    {name = "amplitude of von Mises stress" .. at, unit = "MPa", values = response:von_mises(frequency),
      scale = 1e-6},
    {name = "amplitude of displacement" .. at, unit = "mm", values = amplitude(real, imaginary), scale = 1e3},
    {name = "von Mises stress, largest over the range", unit = "MPa", values = found.von_mises, scale = 1e-6}}
  if found.displacement.frequency ~= frequency then
    local other, message, details = swing(response, found.displacement.frequency)
    if not other then return nil, message, details end
    motions[2] = other
  end
  local drawn, message, details = plots {
    {"Amplitude of the displacement where it is largest", curve:figure()},
    {"Largest amplitude of von Mises stress in the part", found.envelope:figure()}}
  if not drawn then return nil, message, details end
  local body = "<h2>Over the frequency</h2>\n" .. drawn
    .. modes_table.add(response.modes, motions)
  return write(path, response.mesh, words, fields, motions, body)
end

-- A plot of the points of a file, {frequency, value}, those above 0.
local function figure_of(points, name, unit)
  local x, y = {}, {}
  for _, point in ipairs(points) do
    if point[1] > 0 and point[2] > 0 then x[#x + 1], y[#y + 1] = point[1], point[2] end
  end
  return bw.plot.lines {series = {{x = x, y = y}},
    x = {label = "frequency", unit = "Hz", scale = "log", prefix = false},
    y = {label = name, unit = unit, scale = "log", prefix = false}}
end

local METHODS <const> = {{"dirlik", "Dirlik"}, {"tovo_benasciutti", "Tovo and Benasciutti"},
  {"wirsching_light", "Wirsching and Light"}, {"narrow_band", "narrow band"}}

-- Tables of the margins and of the damage, where there are some.
local function judgement(margins, fatigue)
  local out = ""
  if margins then
    out = "<h2>Strength</h2>\n" .. html.table({"where it is least certain", "value"}, {
      {("margin of %g root mean squares, at %s"):format(margins.sigma, core.point(margins.margin_at)),
        shown.percent(margins.margin)},
      {("von Mises stress above the strength at an instant, at %s"):format(core.point(margins.at)),
        shown.percent(margins.exceedance[margins.node]) .. " of the time"},
      {"crossings of the strength, at most", core.quantity(margins.rate[margins.node], "Hz")},
      {("a first crossing within %s, at most"):format(core.quantity(margins.duration, "s")),
        shown.percent(margins.first_passage[margins.node])},
      {"the same if crossings were independent", shown.percent(margins.poisson)}})
  end
  if fatigue then
    local rows = {}
    for i, method in ipairs(METHODS) do rows[i] = {method[2], shown.number(fatigue.by[method[1]])} end
    out = out .. ("<h2>Fatigue</h2>\n%s<p class=\"hint\">At %s, within %s. Life to a damage of 1: %s, by Dirlik. "
      .. "Life curves scatter by factors of 2 to 10.</p>\n"):format(html.table({"method", "damage"}, rows),
      html.escape(core.point(fatigue.at)), core.quantity(fatigue.duration, "s"),
      fatigue.life < math.huge and core.quantity(fatigue.life, "s") or "without end")
  end
  return out
end

--- Of a random vibration.
function respond_page.random(found, path, words, given)
  local random, margins, fatigue, motions = found.response, found.margins, found.fatigue, {}
  local fields = {
    {name = "von Mises stress, 3 root mean squares", unit = "MPa", values = found.von_mises, scale = 1e-6},
    {name = "displacement, 3 root mean squares", unit = "mm", values = random.displacement:map "norm(a)",
      scale = 3e3}}
  if margins then
    fields[3] = {name = ("%g root mean squares of the strength"):format(margins.sigma), unit = "%",
      values = margins.used, scale = 100}
    fields[4] = {name = "exceeds the strength within the duration, at most", unit = "%",
      values = margins.first_passage, scale = 100}
  end
  if fatigue then fields[#fields + 1] = {name = "damage", unit = "", values = fatigue.damage} end
  local density = figure_of(given.points, "density", "1/Hz")
  local drawn, message, details = plots {{"The power spectral density", density}}
  if not drawn then return nil, message, details end
  local body = judgement(margins, fatigue) .. modes_table.add(found.modes, motions) .. "<h2>The vibration</h2>\n"
    .. drawn
  return write(path, random.mesh, words, fields, motions, body)
end

--- Of a response spectrum.
function respond_page.spectrum(found, path, words, given)
  local all, motions, head = found.response, {}, {}
  local fields = {{name = "largest von Mises stress", unit = "MPa", values = all.von_mises, scale = 1e-6},
    {name = "largest displacement", unit = "mm", values = all.displacement:map "norm(a)", scale = 1e3}}
  for k, one in ipairs(found.responses) do
    local along = "along " .. shown.vector(one.direction, "")
    head[k] = "effective mass " .. along
    if #found.responses > 1 then
      fields[2 + k] = {name = "largest von Mises stress " .. along, unit = "MPa", values = one.von_mises,
        scale = 1e-6}
    end
  end
  local first = found.responses[1]
  head[#head + 1] = "acceleration"
  local function cells(i)
    local out = {}
    for k, one in ipairs(found.responses) do
      out[k] = i <= #one.effective_masses and ("%s (%s)"):format(core.quantity(one.effective_masses[i], "kg"),
        shown.percent(one.effective_masses[i] / one.mass)) or ""
    end
    out[#out + 1] = i <= #first.accelerations and core.quantity(first.accelerations[i], "m/s2")
      or "beyond the spectrum"
    return out
  end
  local spectrum = figure_of(given.points, "acceleration", "m/s2")
  local drawn, message, details = plots {{"The response spectrum", spectrum}}
  if not drawn then return nil, message, details end
  local body = modes_table.add(first.modes, motions, {head = head, cells = cells})
    .. "<h2>The spectrum</h2>\n" .. drawn
  return write(path, all.mesh, words, fields, motions, body)
end

return respond_page
