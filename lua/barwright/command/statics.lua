-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright statics MODEL: constrained here, loaded there, does it carry the load?
local averaging_radius = require "barwright.averaging_radius"
local bw = require "barwright"
local core = require "barwright.core"
local facet_error = require "barwright.facet_error"
local growth = require "barwright.singular_growth"
local loads_of = require "barwright.command.loads"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local output = require "barwright.command.output"
local page_head = require "barwright.command.page_head"
local patch_means = require "barwright.command.patch_means"
local places = require "barwright.command.places"
local shown = require "barwright.shown"
local singular_places = require "barwright.singular"
local static_picture = require "barwright.command.static_picture"

-- Of a solution: the largest von Mises stress; where strengths are known, what governs (made_of.lua) by elements
-- and in the mean over patches, with stress over strength.
local function measure(static, read, radius)
  local found = {elements = static.mesh.element_count, stress = static.von_mises:max()}
  found.governing = made_of.governing(read.made, static, static.utilisation)
  if not found.governing then return found end
  found.used = found.governing.used
  found.governing_mean = patch_means.governing(read.made, static, radius) or found.governing
  found.used_mean = found.governing_mean.used
  return found
end

-- The same on a coarser mesh with the same loads; nil where there is none to compare with.
local function on_coarser(read, opts, loads, radius)
  return model.on_coarser(read, opts, opts.order, function(mesh)
    local part = model.part(read, mesh, opts)
    part = part and loads_of.set_up(part, opts, loads, {say = function() end})
    local static = part and model.try(part.solve, part, {solver = model.solver(opts)})
    return static and measure(static, read, radius)
  end)
end

-- The part of the error of the stress at a point that no finer mesh of the same surface shows: facets of the file
-- that stand for a round face. Those that the mesh has by itself are gone where it is curved.
local function of_facets(mesh, read, at)
  local sound = mesh.order == 2 and read.surface and read.surface:check({limit = 1}).sound
  local curved = sound and model.try(mesh.curved, mesh, read.surface)
  return facet_error(curved or mesh, at, growth.radius(growth.edge_length(mesh, at)))
end

-- The effective stress of the theory of critical distances at the edge of a finding, where all is known.
local function effective(static, finding)
  local place = finding and finding.place
  if not place or place.length == 0 or not static.material.critical_distance then return nil end
  local list = static:effective_stress {places = singular_places.list {place}}
  return list and list[1]
end

-- Of several materials: the node of the element that governs whose von Mises stress is largest.
local function judged_place(static, governing)
  if not (governing and governing.region) then return nil end
  local mesh, best = static.mesh, nil
  for k = 1, mesh.elements.column_count do
    local node = mesh.elements(governing.element, k)
    if not best or static.von_mises[node] > static.von_mises[best] then best = node end
  end
  return {mesh.nodes(best, 1), mesh.nodes(best, 2), mesh.nodes(best, 3)}
end

-- The largest stress, its error, stress over strength in both measures, and whether it is singular.
local function assess(static, part, read, loads, opts, accuracy, at)
  local radius, mean = opts.radius, static:error_estimate()
  local found = {mean = mean, radius = radius, fine = measure(static, read, radius)}
  if not accuracy then
    found.coarse = on_coarser(read, opts, loads, radius)
    at = judged_place(static, found.fine.governing) or at
    local message, details
    found.facets, message, details = of_facets(static.mesh, read, at)
    if not found.facets then return nil, message, details end
    found.estimated = math.sqrt(model.error_of(found.fine.stress, found.coarse and found.coarse.stress, mean) ^ 2
      + found.facets ^ 2)
    found.singular = model.find_singular(part, read, at, found.fine, found.coarse)
    return found
  end
  found.estimated, found.facets = accuracy.estimated_error, accuracy.history[#accuracy.history].facet_error
  if not accuracy.converged then
    local first = model.try(part.solve, part, {solver = model.solver(opts)})
    found.coarse = first and measure(first, read, radius)
  end
  found.singular = accuracy.singular
  return found
end

-- With --fillet: the largest stress that the re-entrant edges would have with a fillet.
local function report_fillet(static, read, opts, say, out)
  if not opts.fillet then return end
  local sound = read.surface and read.surface:check({limit = 1}).sound
  local list, message = static:fillet_stress {radius = opts.fillet,
    places = sound and read.surface:singular_edges() or nil}
  local found = list and list[1]
  if not found then
    say("The stress of a fillet is not known: %s.", message and message .. " (more --elements may help)"
      or "there is no re-entrant edge")
    return
  end
  local strength = static.material.strength
  local used = type(strength) == "number" and ": " .. shown.percent(found.value / strength) .. " of the strength"
  say("With a fillet of %s the re-entrant edge at %s has a largest principal stress of %s (estimated error %s)%s.",
    core.quantity(opts.fillet, "m"), core.point(found.at), shown.estimate(found.value, "Pa"),
    shown.error(found.estimated_error), used or "")
  out:json {fillet_radius_m = opts.fillet, fillet_stress_pa = found.value,
    fillet_stress_error = found.estimated_error, fillet_at_m = found.at}
end

-- What to do where a part does not hold for certain, a list of sentences.
local function advice_of(verdict, used, error)
  if verdict == "holds" or not used then return {} end
  if verdict == "unsure" and error >= 0.1 then
    return {"The estimated error leaves it open: more --elements, or --error 0.05, make it smaller."}
  end
  return {("It carries these loads where they are %s of what they are, or where it is thicker at the place that "
    .. "the picture marks."):format(shown.percent(1 / (used * (1 + error))))}
end

local function report(static, part, read, loads, opts, accuracy, out)
  local mesh = static.mesh
  local node = static.von_mises:argmax()
  local max = static.displacement:map "norm(a)":max()
  local at = {mesh.nodes(node, 1), mesh.nodes(node, 2), mesh.nodes(node, 3)}
  local found, message, details = assess(static, part, read, loads, opts, accuracy, at)
  if not found then return nil, message, details end
  local fine, coarse, radius, mean = found.fine, found.coarse, found.radius, found.mean
  local stress, used, estimated, singular = fine.stress, fine.used, found.estimated, found.singular
  local critical = effective(static, singular)
  if accuracy then model.report_accuracy(accuracy, out) end
  local judged_error, governing = estimated, fine.governing
  if singular and used then
    used, governing = fine.used_mean, fine.governing_mean
    judged_error = model.error_of(used, coarse and coarse.used_mean, mean)
  end
  local strength = governing and governing.material.strength
  local verdict, words = model.verdict(used, judged_error)
  out:say("")
  local say, text = out:recorded() -- for the page as well
  say("The largest displacement is %s. The von Mises stress is largest at %s: %s (estimated error %s%s).",
    shown.estimate(max, "m"), core.point(at), shown.estimate(stress, "Pa"), shown.error(estimated),
    (coarse or accuracy) and "" or ", one mesh only")
  local deflection = model.deflection(max, mesh)
  model.report_deflection(deflection, say, out)
  if singular then
    say("%s. The mean over a surface patch of radius %s is judged.",
      (tostring(singular):gsub("^%l", string.upper)), core.quantity(radius, "m"))
    if critical then
      say("The effective stress of the theory of critical distances, the mean over %s from the edge, is "
        .. "%s (estimated error %s): %s of the strength.", core.quantity(2 * critical.length, "m"),
        shown.estimate(critical.value, "Pa"), shown.error(critical.estimated_error),
        shown.percent(critical.utilisation))
    end
  end
  report_fillet(static, read, opts, say, out)
  if not used then
    say("The strength of %s is not known.", made_of.without_strength(read.made).name)
  else
    say("The judged stress is %s%s of %s (estimated error %s): %s.", type(strength) == "number"
      and shown.estimate(used * strength, "Pa") .. ", " or "", shown.percent(used),
      opts.strength and "the given strength" or "the strength of " .. made_of.governing_text(governing),
      shown.error(judged_error), words)
    made_of.say_by_region(fine.governing, say)
  end
  local solved = static.report
  if solved.solver == "pcg" then out:say("Solved by %s.", tostring(solved)) end
  out:json {verdict = verdict, value = stress, quantity = "largest von Mises stress, Pa",
    estimated_error = estimated, at_m = at, singular = singular ~= nil,
    averaging_radius_m = singular and radius or nil, unit = model.unit_of(read, opts),
    max_von_mises_pa = stress, max_von_mises_at_m = at,
    max_displacement_m = max, utilisation = used,
    utilisation_error = used and judged_error,
    strength_pa = strength, governing_region = governing and governing.region,
    by_region = governing and fine.governing.by_region, mean_error = mean, facet_error = found.facets,
    coarse_value = coarse and coarse.stress, coarse_elements = coarse and coarse.elements,
    singular_by = singular and singular.by, singular_place = singular and singular.place and {
      kind = singular.place.kind, angle_rad = singular.place.angle, at_m = singular.at},
    growth_expected = singular and singular.expected, growth_measured = singular and singular.measured,
    effective_stress_pa = critical and critical.value,
    effective_stress_error = critical and critical.estimated_error,
    critical_distance_m = critical and critical.length,
    energy_j = static.energy,
    solver = model.solver_words(solved)}
  local title = static_picture.title(model.name(opts.model), {stress = stress, error = estimated,
    judged = singular and {used = used, error = judged_error, strength = strength}, verdict = words})
  local material, mass = page_head.part(read.made, opts, out)
  local head = {verdict = verdict, headline = page_head.used(used, judged_error), facts = {
    page_head.margin(used, judged_error),
    {"Loads", loads_of.text(loads)}, {"Constrained at", table.concat(opts.fix, ", ")},
    {"Judged stress", used and type(strength) == "number" and shown.estimate(used * strength, "Pa") or nil},
    {"Strength", type(strength) == "number" and core.quantity(strength, "Pa") or nil},
    {"Largest von Mises stress", shown.estimate(stress, "Pa") .. ", estimated error " .. shown.error(estimated)},
    {"At", core.point(at)},
    {"Largest displacement", ("%s (%s)"):format(shown.estimate(max, "m"), deflection.text)},
    material, mass,
    {"Linear theory", deflection.beyond and "left: " .. model.large_deflection or nil}},
    advice = advice_of(verdict, used, judged_error)}
  return {verdict = verdict, singular = singular, title = title, text = table.concat(text, "\n"), head = head,
    callout = {at = at, text = "largest: " .. shown.estimate(stress, "Pa")}}
end

local function analyse(opts, loads, out)
  if opts.threads then bw.threads(opts.threads) end
  local start = bw.seconds()
  local mesh, read, why = model.body(opts.error and model.first_mesh(opts) or opts, out)
  if not mesh then return nil, read, why end
  local part, message, details = model.part(read, mesh, opts)
  if not part then return nil, message, details end
  if opts.error and part.material.parts then
    return nil, "option --error refines for the largest stress, which need not govern a part of several "
      .. "materials: leave it out", {status = "misuse"}
  end
  opts.radius, message, details = averaging_radius("statics", opts.length, part.material, mesh.box)
  if not opts.radius then return nil, message, details end
  part, message, details = loads_of.set_up(part, opts, loads, out)
  if not part then return nil, message, details end
  out:json {supported_area_m2 = message}
  local static, accuracy
  if opts.error then
    static, accuracy, details = model.try(part.solve, part, model.refined(read, opts, mesh,
      {of = "von_mises", solver = model.solver(opts)}))
  else
    static, accuracy, details = model.try(part.solve, part, {solver = model.solver(opts)})
  end
  out:warnings()
  if not static then return nil, accuracy, details end
  local answer
  answer, message, details = report(static, part, read, loads, opts, accuracy, out)
  if not answer then return nil, message, details end
  out:json {seconds = bw.seconds() - start}
  return static, answer
end

local options = {
  made_of.option,
  model.fix_option,
  loads_of.options.force,
  loads_of.options.pressure,
  loads_of.options.gravity,
  model.unit_option,
  model.elements_option,
  {name = "error", value = "FRACTION", type = "number", above = 0, max = 1,
    what = "refine where the error of the largest stress comes from until its estimate is this fraction, 0.02 for "
      .. "instance, or the mesh has ten times the elements; the first mesh has a quarter of them"},
  model.length_option,
  {name = "fillet", value = "RADIUS", type = "number", unit = "m", above = 0,
    what = "report the stress that re-entrant edges would have with a fillet of this radius, which is small "
      .. "beside the part"},
  {name = "order", value = "1|2", type = "integer", default = 2, one_of = {1, 2},
    what = "linear or quadratic elements; linear ones are too stiff"},
  {name = "formulation", value = "standard|b_bar", type = "string", default = "standard",
    one_of = {"standard", "b_bar"},
    what = "of quadratic elements: b_bar does not lock where Poisson's ratio is near 0.5"},
  model.solver_option,
  {name = "report", value = "FILE.html", type = "file", endings = {"html", "htm"},
    what = "write a page with a 3D view that turns"},
  {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
    what = "a picture of the deformed part, its stresses, loads and supports"},
  {name = "vtu", value = "FILE.vtu", type = "file", endings = model.field_endings,
    what = "write all fields, for ParaView"},
  model.threads_option,
}
table.move(made_of.value_options, 1, #made_of.value_options, #options + 1, options)

return {
  summary = "whether a part carries a load that is known",
  about = "Constrains a part at places, applies loads at others, and reports how far it deflects and whether it "
    .. "breaks. A surface is repaired where it must be and filled with tetrahedra.\n\n" .. places.help
    .. "\n\n" .. output.codes("it holds", "it breaks, or the estimated error leaves it open"),
  arguments = {model.body_argument},
  options = options,
  examples = {"barwright statics hook.stl --fix min:z --force max:z=0,0,-50",
    {"barwright statics shelf.stl --fix min:x --pressure max:z=2kPa --gravity 0,0,-9.81", "books on a shelf"}},
  run = function(opts, out)
    local loads, message = loads_of.read(opts, "gravity")
    if loads then message = loads_of.nothing(loads) end
    if message then return out:misuse(message) end
    local static, answer, details = analyse(opts, loads, out)
    if not static then return out:fail(answer, details) end -- a message
    local picture
    if opts.picture or opts.report then
      picture = static_picture.options(static, answer.title, loads, opts.fix, answer.singular, out.object.mass_kg)
    end
    local failed = out:write_files {{opts.vtu, function() return static:write(opts.vtu) end},
      {opts.picture, function() return static:picture(opts.picture, picture) end},
      {opts.report, function()
        return static_picture.report(static, opts.report, picture, answer)
      end}}
    if failed then return failed end
    return answer.verdict == "holds" and 0 or 1
  end,
}
