-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright respond MODEL --psd FILE: random vibration, against the strength and a life curve.
local bw = require "barwright"
local core = require "barwright.core"
local history = require "barwright.history"
local model = require "barwright.command.model"
local quantity = require "barwright.command.quantity"
local respond_page = require "barwright.command.respond_page"
local shown = require "barwright.shown"
local vibration = require "barwright.random_vibration"

local respond_random = {}

local SIGMA = 3

respond_random.options = {
  {name = "psd", value = "FILE.csv", type = "file",
    what = "random vibration: this power spectral density multiplies loads and --base, squared; rows of a "
      .. "frequency in Hz and a density in 1/Hz, which with --base 0,0,1g is in g2/Hz"},
  {name = "duration", value = "TIME", type = "number", unit = "s", above = 0,
    what = "with --psd: how long the vibration lasts"},
  {name = "first-passage", value = "PROBABILITY", type = "number", default = 0.01, above = 0, below = 1,
    what = "with --psd: what is taken as safe, the probability that the stress exceeds the strength within the "
      .. "duration"},
  {name = "life", value = "AMPLITUDE,CYCLES,EXPONENT",
    what = "with --psd: the life curve of fatigue, 160MPa,2e6,5 for instance"},
}

-- The life curve of --life, or nil and a sentence.
local function read_curve(text)
  local amplitude, cycles, exponent = text:match "^([^,]+),([^,]+),([^,]+)$"
  if not amplitude then return nil, "three values as 160MPa,2e6,5 expected, got " .. text end
  local value, message = quantity.read(amplitude, "Pa")
  if not value then return nil, message end
  cycles, exponent = tonumber(cycles), tonumber(exponent)
  if not (value > 0 and cycles and cycles > 0 and cycles < math.huge and exponent and exponent >= 1
    and exponent < math.huge) then
    return nil, "a stress and cycles above 0 and an exponent of 1 or more expected, got " .. text
  end
  return {amplitude = value, cycles = cycles, exponent = exponent}
end

--- What is wrong with the options, or nil; `given` takes the life curve.
function respond_random.misuse(opts, given)
  if not opts.psd then
    for _, name in ipairs {"duration", "first-passage", "life"} do
      if opts.given["--" .. name] then return ("option --%s is for --psd FILE.csv"):format(name) end
    end
    return nil
  end
  for _, name in ipairs {"spectrum", "from", "to", "band-limited", "csv", "plot"} do
    if opts.given["--" .. name] then
      return ("option --%s does not go with --psd: leave one of them out"):format(name)
    end
  end
  if not opts.duration then return "option --duration TIME is missing" end
  if opts.life then
    local message
    given.curve, message = read_curve(opts.life)
    return message and "option --life: " .. message
  end
end

--- The points of a file, or nil, message, details.
function respond_random.points(path)
  local points, message, details = history.rows(path, "frequency")
  if not points then return nil, message, details end
  local function wrong(text, ...)
    return nil, path .. ": " .. text:format(...), {status = "format", file = path}
  end
  local largest = 0
  for _, point in ipairs(points) do
    if point[1] < 0 or point[2] < 0 then
      return wrong("%g 1/Hz at %g Hz: both must be 0 or more", point[2], point[1])
    end
    largest = math.max(largest, point[2])
  end
  if #points < 2 then return wrong "a power spectral density has 2 points or more" end
  if largest == 0 then return wrong "the power spectral density is 0 everywhere" end
  return points
end

-- The largest entry of a nodal field times `SIGMA`, and its place.
local function largest_of(mesh, field)
  local node, column = field:argmax()
  return {value = SIGMA * field(node, column), at = mesh.nodes:rows(node, node):totable()[1]}
end

--- {response =, modes =, von_mises = of nodes, displacement =, stress =, of three deviations, equations = relative
--- error of these}, or nil, message, details.
function respond_random.measure(part, opts, given)
  local points = given.points
  local response, message, details = model.try(part.harmonic, part,
    {range = {points[1][1], points[#points][1]}, damping = {ratio = opts.damping}, base = given.base})
  if not response then return nil, message, details end
  local random, why, more = model.try(response.random, response, {psd = points})
  if not random then return nil, why, more end
  return {response = random, modes = response.modes, equations = random.error,
    von_mises = random.von_mises * SIGMA,
    stress = largest_of(part.mesh, random.von_mises), displacement = largest_of(part.mesh, random.displacement)}
end

--- Strength and fatigue, which coarser meshes do not need: `found` takes margins and damage. True, or nil,
--- message, details.
function respond_random.judge(found, opts, given)
  local message, details
  if found.governing then -- each material has a strength
    found.margins, message, details = found.response:margins {duration = opts.duration, sigma = SIGMA}
    if not found.margins then return nil, message, details end
  end
  if given.curve then
    found.fatigue, message, details = found.response:fatigue {duration = opts.duration, curve = given.curve}
    if not found.fatigue then return nil, message, details end
  end
  return true
end

--- What was found, in sentences and in JSON.
function respond_random.report(found, errors, opts, say, out)
  local random, stress, displacement, m = found.response, found.stress, found.displacement, found.margins
  say("The largest component of the displacement is %s at %s, relative to the supports, three times its root "
    .. "mean square (estimated error %s, %s).", shown.estimate(displacement.value, "m"),
    core.point(displacement.at), shown.error(errors.displacement), errors.way)
  say("The largest von Mises stress is %s at %s, three times its root mean square (estimated error %s, "
    .. "%s).", shown.estimate(stress.value, "Pa"), core.point(stress.at), shown.error(errors.stress),
    errors.way)
  for _, sentence in ipairs(m and vibration.margin_sentences(m) or {}) do say("%s", sentence) end
  if m then
    say("A probability of up to %s is taken as safe (--first-passage).", shown.percent(opts.first_passage))
  end
  local fatigue = found.fatigue
  if fatigue then
    for _, sentence in ipairs(vibration.fatigue_sentences(fatigue)) do say("%s", sentence) end
    say "Life curves scatter by factors of 2 to 10."
  else
    say "Fatigue is not judged: no life curve is given (--life)."
  end
  say("%s.", (vibration.equations(random):gsub("^%l", string.upper)))
  local judged = m and (fatigue and "shares, probabilities and damage" or "shares and probabilities")
    or fatigue and "damage"
  say("%s. The error of the quadrature is unknown%s.", vibration.assumptions,
    judged and ", and that of the mesh in " .. judged or "")
  out:json {quantity = "largest von Mises stress, three times its root mean square, Pa",
    duration_s = opts.duration, exceedance = m and m.exceedance[m.node], crossing_rate_hz = m and m.rate[m.node],
    first_passage = m and m.first_passage[m.node], first_passage_limit = m and opts.first_passage,
    first_passage_poisson = m and m.poisson,
    margin = m and m.margin, beyond_three_deviations = m and m.beyond, equations_error = random.error,
    counted = random.counted, natural_frequencies_hz = bw.json.list(found.modes.frequencies:totable()),
    damage = fatigue and fatigue.damage[fatigue.node],
    life_s = fatigue and fatigue.life < math.huge and fatigue.life or nil, damage_by = fatigue and fatigue.by}
end

--- What is assumed of it, for the head of the page.
respond_random.assumption = "Gaussian vibration about 0, without static stresses; each place by itself"

--- Its page.
respond_random.page = respond_page.random

return respond_random
