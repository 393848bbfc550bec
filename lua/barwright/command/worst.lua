-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright worst MODEL: the least force that breaks it.
local bw = require "barwright"
local core = require "barwright.core"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local output = require "barwright.command.output"
local places = require "barwright.command.places"
local shown = require "barwright.shown"

-- With --error the last mesh may have so many.
local MAX_ELEMENTS = 200000

local function newtons(force)
  return core.quantity(force, "N")
end

local function keep(breaking, verdict, opts, out)
  local worst, contact, singular = breaking.worst, breaking.contact, breaking.singular
  local edge = singular and singular.place
  out:json {singular_by = singular and singular.by,
    singular_place = edge and {kind = edge.kind, angle_rad = edge.angle, at_m = singular.at}}
  out:json {
    verdict = verdict, breaking_force_n = breaking.force, breaking_force_low_n = breaking.low,
    breaking_force_high_n = breaking.high, estimated_error = breaking.estimated_error, at_m = breaking.at,
    singular = singular ~= nil, contact_area_m2 = contact, contact_area_asked_m2 = opts.contact,
    force_n = opts.force, failure = breaking.failure, averaging_radius_m = breaking.length,
    critical_distance_m = opts.length == "critical" and breaking.material.critical_distance or nil,
    max_principal_pa = worst.max_principal, max_principal_at_m = worst.at,
    strength_pa = worst.strength, max_displacement_m = worst.max_displacement, worst_region = worst.region,
    solver = model.solver_words(breaking.reports.solver),
  }
  local history, ties, regions = bw.json.list {}, bw.json.list {}, bw.json.list {}
  for i, level in ipairs(breaking.history) do
    history[i] = {elements = level.elements, breaking_force_n = level.force, at_m = level.at}
  end
  for i, place in ipairs(breaking.ties) do
    ties[i] = {breaking_force_n = 1 / place.utilisation, at_m = place.at}
  end
  for i, region in ipairs(worst.regions) do
    regions[i] = {origin = region.origin, mode = region.mode, rank = region.rank,
      max_principal_pa = region.max_principal, max_principal_at_m = region.at,
      utilisation = region.utilisation, max_displacement_m = region.displacement, elements = region.elements,
      volume_fraction = region.volume_fraction}
  end
  out:json {history = history, ties = ties, regions = regions}
end

local sentences = {
  holds = "Under %s it holds: the whole interval lies above.",
  breaks = "Under %s it breaks: the whole interval lies below.",
  unsure = "Under %s: too close to decide.",
}

-- The answer, in sentences.
local function report(breaking, verdict, deflection, mass, made, opts, out)
  local singular = breaking.singular
  out:say("")
  out:say("%s breaks at %s under the worst load, on at least %s, at %s; %s%s.", model.name(opts.model),
    shown.interval(breaking.force, breaking.low, breaking.high, "N"), core.quantity(breaking.contact, "m2"),
    core.point(breaking.at), made_of.text(made, opts), mass and ", " .. core.quantity(mass, "kg") or "")
  out:say(sentences[verdict], newtons(opts.force)
    .. (opts.given["--force"] and "" or " (a hand's, as no --force is given)"))
  local others = {}
  for i, place in ipairs(breaking.ties) do
    others[i] = ("%s at %s"):format(shown.estimate(1 / place.utilisation, "N"), core.point(place.at))
  end
  if #others > 0 then
    out:say("  Other places whose breaking force is within the error: %s.", table.concat(others, "; "))
  end
  if singular then
    out:say("  %s. The mean over the patch has one%s.", (tostring(singular):gsub("^%l", string.upper)),
      breaking.excess > 0 and ("; meshes overestimate it by up to %s, which the interval contains")
        :format(shown.error(breaking.excess)) or "")
  end
  if breaking.contact < opts.contact then
    out:say("  The contact is %s instead of %s, a twentieth of the surface.",
      core.quantity(breaking.contact, "m2"),
      core.quantity(opts.contact, "m2"))
  end
  model.report_deflection(deflection, function(text, ...) out:say("  " .. text, ...) end, out)
  out:say("  Estimated from %s; the stress is the mean over a surface patch of radius %s%s, judged by %s. The "
    .. "search for the worst load is heuristic.", model.count(#breaking.history, "mesh", "meshes"),
    core.quantity(breaking.length, "m"), opts.length == "critical" and ", half the critical distance" or "",
    breaking.failure == "von_mises" and "von Mises against yield"
      or "the largest principal stress")
  local solved = breaking.reports.solver
  if solved.solver == "pcg" then out:say("  Solved by %s.", tostring(solved)) end
end

-- The loads that the options admit, as options of bw.breaking_force; or nil and a sentence.
local function read_limits(opts)
  local limits = {friction = opts.friction, hands = opts.hands}
  for name, option in pairs {fix = "fix", forbid = "forbidden"} do
    local texts = opts[name]
    for _, place in ipairs(texts) do
      local ok, message = places.check(place)
      if not ok then return nil, ("option --%s: %s"):format(name, message) end
    end
    limits[option] = #texts > 0 and function(mesh)
      local list = {}
      for i, place in ipairs(texts) do
        local message, details
        list[i], message, details = places.select(mesh, place)
        if not list[i] then return nil, message, details end
      end
      return list
    end or nil
  end
  if opts.hands == 1 and #opts.fix == 0 then
    return nil, "option --hands: a part without supports moves freely under the load of one hand: give --fix "
      .. "PLACE, or more hands"
  end
  return limits
end

local function report_limits(breaking, opts, out)
  local fixed, forbidden = breaking.fixed_area, breaking.forbidden_area
  if fixed then
    out:say("  Constrained at %s (%s): the whole force is a load, the supports react.",
      table.concat(opts.fix, ", "), core.quantity(fixed, "m2"))
  end
  if forbidden then
    out:say("  No load on %s (%s).", table.concat(opts.forbid, ", "), core.quantity(forbidden, "m2"))
  end
  if opts.friction > 0 then
    out:say("  Coefficient of friction %s: loads have tangential parts too.", shown.number(opts.friction))
  end
  if opts.hands then
    out:say("  Loads act within %s at once; where these are is a heuristic search.",
      model.count(opts.hands, "place"))
  end
  out:json {supported_area_m2 = fixed, forbidden_area_m2 = forbidden, friction = opts.friction, hands = opts.hands}
end

-- Options of the advised command that must be those of this one.
local SAME_PART = {"--unit", "--material", "--young", "--poisson", "--strength", "--density", "--toughness",
  "--contact", "--length", "--elements", "--modes", "--regions"}

-- What to thicken where the part does not hold for certain. Advice that fails is reported; the command does not
-- fail. The sentences are returned as well.
local function advise(breaking, verdict, opts, out)
  if verdict == "holds" then return {} end
  local say, texts = out:recorded()
  local advice, message = breaking:advice {force = opts.force}
  if not advice then
    out:json {advice = {force_n = opts.force, message = message}}
    say("No advice: %s.", message)
    return texts
  end
  local thickened, first = bw.json.list {}, advice.places[1]
  for i, place in ipairs(advice.places) do
    thickened[i] = {at_m = place.at, radius_m = place.radius, offset_m = place.offset}
    if place.offset > first.offset then first = place end
  end
  out:json {advice = {force_n = opts.force, places = thickened, predicted_breaking_force_n = advice.force,
    predicted_breaking_force_low_n = advice.low, predicted_breaking_force_high_n = advice.high}}
  if not first then
    say("Advice: no thickening was found that helps.")
    return texts
  end
  say("Advice: thicken %s, most by %s within %s of %s; predicted: breaks at %s.",
    model.count(#thickened, "place"), shown.estimate(first.offset, "m"), shown.estimate(first.radius, "m"),
    core.point(first.at), shown.interval(advice.force, advice.low, advice.high, "N"))
  if #opts.fix + #opts.forbid > 0 then return texts end -- strengthening takes free parts only
  local same = {}
  for _, name in ipairs(SAME_PART) do
    local text = opts.given[name]
    if text then same[#same + 1] = (" %s %s"):format(name, model.shell(text)) end
  end
  say("  `barwright strengthen %s --force %.14gN%s --out FILE.stl` does it and computes the force again.",
    model.shell(opts.model), opts.force, table.concat(same))
  return texts
end

-- The head of the page.
local function head_of(breaking, verdict, deflection, mass, made, opts)
  local interval = shown.interval(breaking.force, breaking.low, breaking.high, "N")
  return {verdict = verdict, headline = ("Breaks at %s under the worst load; %s were asked for."):format(interval,
    newtons(opts.force)), facts = {{"Force asked for", newtons(opts.force)},
    {"Contact, at least", core.quantity(breaking.contact, "m2")}, {"Breaks at", core.point(breaking.at)},
    {"Material", made_of.text(made, opts)}, {"Mass", mass and core.quantity(mass, "kg")},
    {"Constrained at", #opts.fix > 0 and table.concat(opts.fix, ", ") or nil},
    {"Largest displacement", ("%s (%s)"):format(core.quantity(deflection.thickness * deflection.thickness_m, "m"),
      deflection.text)},
    {"Linear theory", deflection.beyond and "left: " .. model.large_deflection or nil}}}
end

-- What pictures draw: a cross where it breaks, as large as the patch that is judged, and the edge of a finding.
local function marks(breaking)
  local lines = {}
  for k = 1, 3 do
    local from, to = {table.unpack(breaking.at)}, {table.unpack(breaking.at)}
    from[k], to[k] = from[k] - breaking.length, to[k] + breaking.length
    lines[k] = {from, to}
  end
  local edge = model.edge_lines(breaking.singular)
  table.move(edge.lines or {}, 1, #(edge.lines or {}), #lines + 1, lines)
  return lines, "cross: it breaks here" .. (edge.lines and "; line: " .. edge.line_name or "")
end

-- From where the place that breaks is seen: the edge of a finding, or the surface there, from above a little.
local function view_of(breaking)
  local singular = breaking.singular
  if singular and singular.place then return model.view_of {singular.place} end
  local normal = breaking.mesh.boundary:near(breaking.at, breaking.length).normal
  return {normal[1], normal[2], normal[3] + 0.5}
end

-- Files that were asked for: name of the option, and how it is written. With --out all of them.
local function write_files(breaking, head, opts, folder, out)
  local worst = breaking.worst
  local lines, line_name = marks(breaking)
  local function marked(given)
    given.lines, given.line_name = lines, line_name
    return given
  end
  local written = {}
  local function leave(path, value, message, details)
    if not value then return nil, message, details end
    written[#written + 1] = path
    return true
  end
  local function file(name, own)
    return own or folder and folder:path(name)
  end
  local vtu, page = file("worst.vtu", opts.vtu), file("report.html", opts.report)
  local title = ("%s breaks at %s; shown under %s"):format(model.name(opts.model),
    shown.interval(breaking.force, breaking.low, breaking.high, "N"), newtons(opts.force))
  local load, ok, message, details = {title = title, region = breaking.region}, true, nil, nil
  if opts.picture then ok, message, details = leave(opts.picture, worst:picture(opts.picture, marked(load))) end
  if ok and folder then
    local path = folder:path "worst_load.png"
    ok, message, details = leave(path, worst:picture(path, marked(load)))
  end
  if ok and folder then
    local path, von_mises = folder:path "weakness.png", breaking.failure == "von_mises"
    ok, message, details = leave(path, worst:picture(path, marked {arrows = {},
      title = von_mises and title or "Each place under its own worst load of " .. newtons(opts.force),
      region = von_mises and breaking.region or nil}))
  end
  if ok and vtu then ok, message, details = leave(vtu, worst:write(vtu)) end
  if ok and page then
    local force = newtons(opts.force)
    local answer = ("Shown first: the load that breaks it, with %s on one side. The colours are stresses of "
      .. "elements, without an estimate of their error."):format(force)
    ok, message, details = leave(page, worst:report(page, marked {manifest = folder and folder.manifest,
      view = view_of(breaking), verdict = head, answer = answer,
      callout = {at = breaking.at, text = "breaks here at " .. shown.interval(breaking.force, breaking.low,
        breaking.high, "N")}, region = breaking.region,
      title = "Worst case of " .. model.name(opts.model)}))
  end
  if not ok then return nil, message, details end
  out:json {files = bw.json.list(written)}
  if #written > 0 then out:say("Written: %s.", table.concat(written, ", ")) end
  return true
end

local function analyse(opts, out)
  local start = bw.seconds()
  local limits, why = read_limits(opts)
  if not limits then return nil, why, {status = "misuse"} end
  if opts.threads then bw.threads(opts.threads) end
  local read, message, details = model.start(opts, out, "worst")
  if not read then return nil, message, details end
  if read.kind == "outline" then return model.mesh(read, opts, out) end
  local folder
  if opts.out then
    local options = model.pick({"force", "contact", "fix", "forbid", "friction", "hands", "error", "length",
      "modes", "regions", "solver", "elements", "material", "unit", "young", "poisson", "strength", "density",
      "toughness"}, opts)
    options.unit = options.unit or read.by_environment
    folder, message, details = bw.results.open(opts.out, {script = "barwright worst", inputs = {opts.model},
      options = options, seed = 1})
    if not folder then return nil, message, details end
  end
  local breaking
  breaking, message, details = model.try(bw.breaking_force, read.surface or read.mesh, {
    material = read.made.default, force = opts.force, contact = opts.contact,
    error = opts.error, decide = not opts.error, elements = opts.elements,
    max_elements = opts.error and math.max(MAX_ELEMENTS, opts.elements) or nil, modes = opts.modes,
    regions = opts.regions, fix = limits.fix, forbidden = limits.forbidden, friction = limits.friction,
    hands = limits.hands, length = opts.length, solver = model.solver(opts)})
  out:warnings()
  if not breaking then return nil, opts.model .. ": " .. message, details end
  local worst = breaking.worst
  local verdict = breaking:verdict(opts.force)
  local deflection = model.deflection(worst.max_displacement * math.min(1, breaking.force / opts.force),
    worst.mesh)
  model.report_mesh(worst.mesh, read.made, out)
  out:json {unit = model.unit_of(read, opts), repaired = breaking.log and breaking.log.repaired or false,
    surface_moved_m = breaking.log and breaking.log.surface_moved or 0}
  keep(breaking, verdict, opts, out)
  report(breaking, verdict, deflection, out.object.mass_kg, read.made, opts, out)
  report_limits(breaking, opts, out)
  local head = head_of(breaking, verdict, deflection, out.object.mass_kg, read.made, opts)
  head.advice = advise(breaking, verdict, opts, out)
  local ok
  ok, message, details = write_files(breaking, head, opts, folder, out)
  if not ok then return nil, message, details end
  out:json {seconds = bw.seconds() - start}
  if folder then
    ok, message, details = folder:write(out.object)
    if not ok then return nil, message, details end
  end
  return verdict
end

local options = {
  made_of.one_option,
  {name = "force", value = "FORCE", type = "number", unit = "N", default = 20, above = 0,
    what = "the force that is judged: the load on one side, which the reactions balance; a hand's by default"},
  model.contact_option,
  {name = "fix", value = "PLACE", many = true,
    what = "a support: all displacements are zero there; then the whole force is a load, and the supports react"},
  {name = "forbid", value = "PLACE", many = true, what = "no load acts there"},
  {name = "friction", value = "MU", type = "number", default = 0, min = 0, max = 100,
    what = "Coulomb's coefficient of friction of the loads; without it, pressure alone"},
  {name = "hands", value = "K", type = "integer", min = 1, max = 16,
    what = "loads act within so many places at once, each as large as two contacts; without it, anywhere"},
  {name = "error", value = "FRACTION", type = "number", above = 0, max = 1,
    what = "refine until the estimated error is this fraction, 0.05 for instance, or the mesh becomes too large; "
      .. "without it, no further than the verdict needs"},
  model.length_option,
  model.unit_option,
  model.elements_option,
  model.search_options[1],
  model.search_options[2],
  model.many_solver_option,
  {name = "report", value = "FILE.html", type = "file", endings = {"html", "htm"},
    what = "write a page with a 3D view that turns"},
  {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
    what = "write a picture of the place that breaks, and the load that does it"},
  {name = "vtu", value = "FILE.vtu", type = "file", endings = model.field_endings,
    what = "write all fields, for ParaView"},
  {name = "out", value = "FOLDER", type = "folder", what = "write all of these and result.json, manifest.json "
    .. "into a folder"},
  model.threads_option,
}
table.move(made_of.value_options, 1, #made_of.value_options, #options + 1, options)

return {
  summary = "the least force that breaks a part, and where",
  about = "Finds the least force that breaks a part under the worst of all loads, so that none must be known "
    .. "(Zhou, Panetta, Zorin 2013). The answer is an interval, estimated from a sequence of meshes of quadratic "
    .. "tetrahedra. A surface is repaired where it must be and filled; a mesh is taken as it is.\n\n"
    .. places.help .. "\n\n"
    .. output.codes("it holds the force asked for", "it breaks, or the interval contains the force"),
  arguments = {model.body_argument},
  options = options,
  examples = {{"barwright worst hook.stl --material pla --report hook.html",
      "opens in a browser, without network"},
    {"barwright worst hook.stl --fix min:z --forbid near:0,0,30mm:5mm", "screwed down, its hole out of reach"},
    {"barwright worst hook.stl --force 50N --json | jq .breaking_force_n", "as one number"}},
  run = function(opts, out)
    local verdict, message, details = analyse(opts, out)
    if not verdict then return out:fail(message, details) end
    return verdict == "holds" and 0 or 1
  end,
}
