-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright respond MODEL: how far a part moves, and how it is stressed, by a vibration of a range of frequencies,
-- by a random vibration (respond_random.lua) or by a response spectrum (respond_spectrum.lua).
local averaging_radius = require "barwright.averaging_radius"
local bw = require "barwright"
local core = require "barwright.core"
local loads_of = require "barwright.command.loads"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local output = require "barwright.command.output"
local page_head = require "barwright.command.page_head"
local places = require "barwright.command.places"
local respond_page = require "barwright.command.respond_page"
local respond_random = require "barwright.command.respond_random"
local respond_spectrum = require "barwright.command.respond_spectrum"
local shown = require "barwright.shown"
local static_picture = require "barwright.command.static_picture"

-- {response =, envelope =, von_mises = of nodes, displacement =, stress =}, the largest of both with their places.
local function respond(part, opts, given)
  local response, envelope, message, details
  response, message, details = model.try(part.harmonic, part,
    {range = {opts.from, opts.to}, damping = {ratio = opts.damping}, base = given.base})
  if not response then return nil, message, details end
  envelope, message, details = response:envelope()
  if not envelope then return nil, message, details end
  return {response = response, envelope = envelope, von_mises = envelope.von_mises,
    displacement = envelope.largest.displacement, stress = envelope.largest.von_mises}
end

-- At the frequency of the largest stress, the largest von Mises amplitude of the mean stress over surface patches;
-- nil of a random vibration and of a spectrum, which have no phases, and of several materials.
local function patch_mean(part, found, radius)
  local frequency, means = found.stress.frequency, {}
  if not frequency or part.material.parts then return nil end
  local forces = {part:force_vector(), nil}
  for k, displacement in ipairs {found.response:displacement(frequency)} do
    local stress = bw.surface_stress(part.mesh, part.material, displacement, forces[k])
    means[k] = stress and bw.surface_mean(part.mesh, stress, radius, part)
  end
  local real, imaginary = means[1], means[2]
  if not (real and imaginary) then return nil end
  -- the square of the stress at phase t is (a + b)/2 + (a - b)/2 cos 2t - c sin 2t
  return bw.array.map("sqrt((a*a + b*b) / 2 + hypot((a*a - b*b) / 2, (s*s - d*d) / 4))", {
    a = core.von_mises(real), b = core.von_mises(imaginary), s = core.von_mises(real + imaginary),
    d = core.von_mises(real - imaginary)}):max()
end

-- Largest stress and displacement on a coarser mesh, and its elements; nil where there is none to compare with.
local function on_coarser(measure, read, opts, given, radius)
  return model.on_coarser(read, opts, 2, function(mesh)
    local part = model.part(read, mesh, opts)
    part = part and loads_of.set_up(part, opts, given, {say = function() end})
    local found = part and measure(part, opts, given)
    return found and {stress = found.stress.value, mean = patch_mean(part, found, radius),
      displacement = found.displacement.value, elements = mesh.element_count}
  end)
end

local FIRST_MODES <const> = 16 -- that any range takes

-- Until it is closed, says how many modes the frequencies need, where they are more, before they are computed.
local function announce_modes(out)
  local before
  before = core.progress(function(stage, fraction)
    local count = tonumber(stage:match "^(%d+) modes$" or 0)
    if count > FIRST_MODES and fraction == 0 then out:say("These frequencies need %d modes.", count) end
    if before then return before(stage, fraction) end
    core.report_progress(stage, fraction)
  end)
  return setmetatable({}, {__close = function() core.progress(before) end})
end

-- `measure`: of a part, as above.
local function analyse(measure, opts, given, out)
  if opts.threads then bw.threads(opts.threads) end
  local mesh, read, why = model.body(setmetatable({order = 2}, {__index = opts}), out)
  if not mesh then return nil, read, why end
  local part, message, details = model.part(read, mesh, opts)
  if part then part, message, details = loads_of.set_up(part, opts, given, out) end
  if not part then return nil, message, details end
  local area = message -- that is supported
  if given.base then
    out:say(opts.psd and "The supports are accelerated by %s times the random process."
      or "The supports are accelerated: amplitude %s.", shown.vector(given.base, "m/s2"))
  end
  local found
  do
    local _ <close> = announce_modes(out)
    found, message, details = measure(part, opts, given)
  end
  out:warnings()
  if not found then return nil, message, details end
  local governing = made_of.governing_node(read.made, part, found.von_mises)
  found.material, found.governing, found.made = part.material, governing, read.made
  found.area = area
  local radius = averaging_radius("respond", nil, part.material, mesh.box)
  found.coarse = on_coarser(measure, read, opts, given, radius)
  local at = governing and mesh.nodes:rows(governing.node, governing.node):totable()[1] or found.stress.at
  found.singular = model.find_singular(part, read, at,
    {stress = found.stress.value, elements = mesh.element_count}, found.coarse)
  if found.singular then
    found.radius, found.mean = radius, governing and patch_mean(part, found, radius)
  end
  return found
end

-- What to do where the stress of a vibration is largest at an end of the range, and may be larger beyond it; or
-- nil.
local function end_advice(frequency, opts)
  local at_to = frequency == opts.to
  if not frequency or opts.band_limited == "yes" or not at_to and (opts.from == 0 or frequency ~= opts.from) then
    return nil
  end
  return ("give a %s, or --band-limited yes where nothing vibrates outside of the range"):format(
    at_to and "larger --to" or "smaller --from")
end

-- The verdict on a stress that is `used` of the strength, within a relative error, and its words. A random
-- vibration exceeds three root mean squares now and then, and more often in a longer time.
local function judge(used, estimated, found, opts)
  local verdict, words = model.verdict(used, estimated)
  if verdict == "unsure" then return verdict, words end
  if verdict ~= "holds" then return "exceeds", "it exceeds the strength" end
  local margins, at_end = found.margins, end_advice(found.stress.frequency, opts)
  local likely = margins and margins.first_passage[margins.node] or 0
  if likely > opts.first_passage then
    return "unsure", ("not certain, as it may exceed the strength within %s with a probability of up to %s")
      :format(core.quantity(margins.duration, "s"), shown.percent(likely))
  end
  if at_end then return "unsure", "not certain, as it is largest at an end of the range: " .. at_end end
  return verdict, "it stays below the strength"
end

-- The stress over strength that is judged, its relative error, the verdict and its words. Of a stress without a
-- finite value it is the mean over patches.
local function judged(found, errors, opts)
  local governing, coarse = found.governing, found.coarse
  if not governing then return nil, nil, "unsure" end
  if not found.singular then
    return governing.used, errors.stress, judge(governing.used, errors.stress, found, opts)
  end
  if not found.mean then
    return governing.used, nil, "unsure",
      "not certain, as the stress may grow without end with finer elements"
  end
  local used = found.mean / governing.material.strength
  local estimated = model.error_of(found.mean, coarse and coarse.mean) + errors.equations
  return used, estimated, judge(used, estimated, found, opts)
end

-- What the stress means for the part, in sentences and in JSON; the verdict.
local function report_verdict(found, mesh, errors, opts, say, out)
  local stress, displacement, governing = found.stress, found.displacement, found.governing
  local used, judged_error, verdict, words = judged(found, errors, opts)
  local large = model.beyond_linear(displacement.value, mesh.box)
  if large then say("Displacements are beyond the range of linear theory: %s.", model.large_deflection) end
  if found.singular then say("%s.", (tostring(found.singular):gsub("^%l", string.upper))) end
  if found.mean then
    say("The mean over a surface patch of radius %s is judged.", core.quantity(found.radius, "m"))
  end
  if used then
    say("The %sstress is %s%s of %s%s: %s.", found.mean and "judged " or "", found.mean
      and shown.estimate(found.mean, "Pa") .. ", " or "", shown.percent(used),
      opts.strength and "the given strength" or "the strength of " .. made_of.governing_text(governing),
      found.mean and (" (estimated error %s)"):format(shown.error(judged_error)) or "", words)
  else
    say("The stress is not judged: %s has no strength that is one number.", found.material.name)
  end
  out:json {verdict = verdict, value = stress.value, at_m = stress.at, estimated_error = errors.stress,
    displacement_m = displacement.value, displacement_estimated_error = errors.displacement,
    displacement_at_m = displacement.at, utilisation = used,
    utilisation_error = judged_error, mean_pa = found.mean, averaging_radius_m = found.mean and found.radius,
    strength_pa = governing and governing.material.strength, governing_region = governing and governing.region,
    coarse_value = found.coarse and found.coarse.stress, singular = found.singular ~= nil,
    beyond_linear_theory = large, damping_ratio = opts.damping, fix = bw.json.list(opts.fix)}
  found.judged = {verdict = verdict, used = used, estimated = judged_error, beyond = large}
  return verdict
end

-- Relative errors of stress and displacement, and how they were estimated.
local function errors_of(found, equations)
  local coarse = found.coarse
  return {equations = equations, stress = model.error_of(found.stress.value, coarse and coarse.stress) + equations,
    displacement = model.error_of(found.displacement.value, coarse and coarse.displacement) + equations,
    way = coarse and "by a coarser mesh" or "assumed, as there is one mesh only"}
end

local function report(found, opts, given, out)
  local response, displacement, stress = found.response, found.displacement, found.stress
  local equations = response.errors:max()
  local say, sentences = out:recorded()
  local errors = errors_of(found, equations)
  out:say("")
  say("The displacement is largest at %s Hz: amplitude %s at %s%s (estimated error %s, %s).",
    shown.number(displacement.frequency), shown.estimate(displacement.value, "m"), core.point(displacement.at),
    given.base and ", relative to the supports" or "", shown.error(errors.displacement), errors.way)
  say("The von Mises stress is largest at %s Hz: amplitude %s at %s (estimated error %s, %s).",
    shown.number(stress.frequency), shown.estimate(stress.value, "Pa"), core.point(stress.at),
    shown.error(errors.stress), errors.way)
  if end_advice(stress.frequency, opts) then
    say("That is an end of the range: the stress may be larger beyond it.")
  end
  local verdict = report_verdict(found, response.mesh, errors, opts, say, out)
  local counted = response.modes.counted
  say("Error of the equations: %s %.1e of the displacement, in energy, by %s (%s) and %s. The error of the "
    .. "mesh is not in it.", counted and "at most" or "about", equations,
    model.count(response.modes.count, "mode"), counted and "counted: none is missing" or "not counted",
    model.count(response.residual_vectors, "residual vector"))
  say "Linear theory, one damping ratio in every mode. Fatigue is not judged."
  out:json {quantity = "largest amplitude of von Mises stress, Pa", frequency_hz = stress.frequency,
    displacement_frequency_hz = displacement.frequency, equations_error = equations, counted = counted,
    natural_frequencies_hz = bw.json.list(response.modes.frequencies:totable()),
    residual_vectors = response.residual_vectors}
  return verdict, sentences, errors
end

local function title_of(found, errors, opts)
  return static_picture.title(model.name(opts.model), {stress = found.stress.value, error = errors.stress,
    judged = found.singular and {}})
end

-- The head of the page. way: what the vibration is, and what is assumed of it.
local function head_of(found, opts, given, way, out)
  local material, mass = page_head.part(found.made, opts, out)
  local about = found.judged
  about.margins, about.way, about.damping, about.allowed = found.margins, way, opts.damping, opts.first_passage
  about.at_end = end_advice(found.stress.frequency, opts)
  about.facts = {{"Loads", #given > 0 and loads_of.text(given) or nil},
    {"Supports accelerated by", given.base and shown.vector(given.base, "m/s2")},
    page_head.constrained(opts.fix, found.area), material, mass}
  return respond_page.head(found, about)
end

-- What the page says: sentences, and how it was made.
local function words_of(found, errors, opts, sentences, picture, head)
  return {title = title_of(found, errors, opts), head = head, answer = table.concat(sentences, "\n"),
    fix = opts.fix,
    picture = picture, manifest = {material = found.material.name, damping_ratio = opts.damping,
      fix = bw.json.list(opts.fix)}}
end

-- By a file of points: `way` is respond_random or respond_spectrum.
local function run_points(way, path, opts, given, out)
  local found, message, details
  given.points, message, details = way.points(path)
  if not given.points then return out:fail(message, details) end
  found, message, details = analyse(way.measure, opts, given, out)
  if not found then return out:fail(message, details) end
  if way.judge then
    local ok
    ok, message, details = way.judge(found, opts, given)
    if not ok then return out:fail(message, details) end
  end
  local errors = errors_of(found, found.equations or 0)
  local say, sentences = out:recorded()
  out:say("")
  way.report(found, errors, opts, say, out)
  local verdict = report_verdict(found, found.response.mesh, errors, opts, say, out)
  local title = title_of(found, errors, opts)
  local function picture(file) return found.response:picture(file, {title = title}) end
  local failed = out:write_files {{opts.vtu, function() return found.response:write(opts.vtu) end},
    {opts.picture, function() return picture(opts.picture) end},
    {opts.report, function()
      return way.page(found, opts.report, words_of(found, errors, opts, sentences, picture,
        head_of(found, opts, given, way.assumption, out)), given)
    end}}
  if failed then return failed end
  return verdict == "holds" and 0 or 1
end

local options = {
  made_of.option,
  model.fix_option,
  loads_of.options.force,
  loads_of.options.pressure,
  {name = "base", value = "AX,AY,AZ",
    what = "the supports are accelerated with this amplitude, in m/s2: 0,0,1g for instance"},
  {name = "from", value = "FREQUENCY", type = "number", unit = "Hz", default = 0, min = 0,
    what = "the lowest frequency"},
  {name = "to", value = "FREQUENCY", type = "number", unit = "Hz", above = 0,
    what = "the highest frequency; needed without --psd and --spectrum"},
  {name = "band-limited", value = "yes|no", one_of = {"yes", "no"}, default = "no",
    what = "yes: nothing vibrates beyond --from and --to; no: a stress that is largest at an end of the range may "
      .. "be larger beyond it, and the verdict is not certain"},
  {name = "damping", value = "RATIO", type = "number", above = 0, below = 1, needed = true,
    what = "of the critical damping, in every mode: 0.01, say, of a metal part, 0.03 of a bolted one"},
  model.unit_option,
  model.elements_option,
  {name = "report", value = "FILE.html", type = "file", endings = {"html", "htm"},
    what = "write a page with a 3D view of the deflection, plots, and a table of the modes"},
  {name = "csv", value = "FILE.csv", type = "file", endings = {"csv"},
    what = "write amplitude and phase over the frequency, where the displacement is largest"},
  {name = "plot", value = "FILE.svg", type = "file", endings = {"svg"}, what = "a plot of these amplitudes"},
  {name = "vtu", value = "FILE.vtu", type = "file", endings = model.field_endings,
    what = "write the fields at the frequency of the largest stress, otherwise the largest values, for "
      .. "ParaView"},
  {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
    what = "a picture of the deflection and the stress at that frequency, otherwise the largest stress"},
  model.threads_option,
}
local of_points = table.move(respond_spectrum.options, 1, #respond_spectrum.options, #respond_random.options + 1,
  {table.unpack(respond_random.options)})
for i, option in ipairs(of_points) do table.insert(options, 9 + i, option) end -- behind --damping
table.move(made_of.value_options, 1, #made_of.value_options, #options + 1, options)

return {
  summary = "how a part answers vibration over a range of frequencies",
  about = "Constrains a part at places, and applies loads that vary harmonically, all in phase, or accelerates "
    .. "the supports. It finds the largest displacement and stress over the frequencies. A surface is repaired "
    .. "where it must be and filled with quadratic tetrahedra. With --psd the vibration is random: it finds root "
    .. "mean squares, the probability that the stress exceeds the strength, and damage. With --spectrum it finds "
    .. "the largest responses to a motion of the supports that is known by its response spectrum.\n\n"
    .. places.help .. "\n\n" .. output.codes("the stress stays below the strength",
      "it exceeds the strength, or that is not certain"),
  arguments = {model.body_argument},
  options = options,
  examples = {"barwright respond bracket.stl --fix min:z --base 0,0,1g --to 500 --damping 0.02 --material steel",
    {"barwright respond arm.stl --fix min:x --force max:x=0,0,5N --from 10 --to 200 --damping 0.01 --plot arm.svg",
      "a force at its end"},
    {"barwright respond box.stl --fix min:z --base 0,0,1g --psd launch.csv --duration 2min --damping 0.02",
      "random vibration in g2/Hz"},
    {"barwright respond rack.stl --fix min:z --spectrum floor.csv --direction 1,0,0 --direction 0,1,0 "
      .. "--damping 0.02",
      "an earthquake, along two axes"}},
  run = function(opts, out)
    local given, message = loads_of.read(opts, "base")
    if not given then return out:misuse(message) end
    message = respond_random.misuse(opts, given) or respond_spectrum.misuse(opts, given)
    if message then return out:misuse(message) end
    if opts.psd then return run_points(respond_random, opts.psd, opts, given, out) end
    if opts.spectrum then return run_points(respond_spectrum, opts.spectrum, opts, given, out) end
    if opts.from >= opts.to then
      return out:misuse(("option --from: a frequency below the %g Hz of --to expected, got %g"):format(opts.to,
        opts.from))
    end
    local found, why, details = analyse(respond, opts, given, out)
    if not found then return out:fail(why, details) end
    local verdict, sentences, errors = report(found, opts, given, out)
    local response, frequency = found.response, found.stress.frequency
    local curve
    if opts.csv or opts.plot or opts.report then
      curve, why, details = response:curve {at = found.displacement.at}
      if not curve then return out:fail(why, details) end
    end
    local failed = out:write_files {{opts.csv, function() return curve:write(opts.csv) end},
      {opts.plot, function() return curve:figure():write(opts.plot) end},
      {opts.vtu, function() return response:write(opts.vtu, frequency) end},
      {opts.picture, function() return response:picture(frequency, opts.picture) end},
      {opts.report, function()
        return respond_page.harmonic(found, opts.report, words_of(found, errors, opts, sentences, function(file)
          return response:picture(frequency, file)
        end, head_of(found, opts, given, ("from %s to %s; loads in phase, steady state"):format(
          core.quantity(opts.from, "Hz"), core.quantity(opts.to, "Hz")), out)), curve)
      end}}
    if failed then return failed end
    return verdict == "holds" and 0 or 1
  end,
}
