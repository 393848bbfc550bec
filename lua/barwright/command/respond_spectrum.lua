-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright respond MODEL --spectrum FILE: the largest responses to supports that shake by a response spectrum.
local bw = require "barwright"
local core = require "barwright.core"
local history = require "barwright.history"
local model = require "barwright.command.model"
local places = require "barwright.command.places"
local respond_page = require "barwright.command.respond_page"
local shown = require "barwright.shown"
local spectra = require "barwright.response_spectrum"

local respond_spectrum = {}

respond_spectrum.options = {
  {name = "spectrum", value = "FILE.csv", type = "file",
    what = "no known vibration: the supports shake by this response spectrum, rows of a frequency in Hz and an "
      .. "acceleration in m/s2, of the ratio of --damping"},
  {name = "direction", value = "X,Y,Z", many = true,
    what = "with --spectrum: the supports shake along it; up to three, at right angles, each independent"},
  {name = "rule", value = "NAME", default = "srss", one_of = {"srss", "100-40-40"},
    what = "how directions are combined: root of the sum of squares, or 100 % of one and 40 % of each other"},
}

-- Vectors of the options --direction, or nil and a sentence.
local function read_directions(texts)
  local list = {}
  if #texts < 1 or #texts > 3 then return nil, ("one to three directions expected, got %d"):format(#texts) end
  for k, text in ipairs(texts) do
    local d, message = places.vector(text)
    if not d then return nil, message end
    local length = math.sqrt(d[1] ^ 2 + d[2] ^ 2 + d[3] ^ 2)
    if length == 0 then return nil, ("'%s' has no length"):format(text) end
    list[k] = {d[1] / length, d[2] / length, d[3] / length}
    for j = 1, k - 1 do
      if not spectra.at_right_angles(list[j], list[k]) then
        return nil, ("'%s' is not at right angles to '%s'"):format(text, texts[j])
      end
    end
  end
  return list
end

--- What is wrong with the options, or nil; `given` takes the directions.
function respond_spectrum.misuse(opts, given)
  if not opts.spectrum then
    for _, name in ipairs {"direction", "rule"} do
      if opts.given["--" .. name] then return ("option --%s is for --spectrum FILE.csv"):format(name) end
    end
    return not opts.to and not opts.psd and "option --to FREQUENCY is missing" or nil
  end
  for _, name in ipairs {"force", "pressure", "base", "from", "to", "band-limited", "csv", "plot"} do
    if opts.given["--" .. name] then
      return ("option --%s is for a vibration and does not go with --spectrum: leave one of them out"):format(name)
    end
  end
  if opts.given["--rule"] and #opts.direction < 2 then
    return "option --rule combines directions: give --direction twice or three times"
  end
  local message
  given.directions, message = read_directions(opts.direction)
  return message and "option --direction: " .. message
end

--- The points of a file, or nil, message, details.
function respond_spectrum.points(path)
  local points, message, details = history.rows(path, "frequency")
  if not points then return nil, message, details end
  for _, point in ipairs(points) do
    if point[1] <= 0 or point[2] <= 0 then
      return nil, ("%s: %g m/s2 at %g Hz: both must be above 0"):format(path, point[2], point[1]),
        {status = "format", file = path}
    end
  end
  if #points < 2 then
    return nil, path .. ": a response spectrum has 2 points or more", {status = "format", file = path}
  end
  return points
end

-- The largest entry of a nodal field and its place.
local function largest_of(mesh, field)
  local node, column = field:argmax()
  return {value = field(node, column), at = mesh.nodes:rows(node, node):totable()[1]}
end

--- {response =, responses = of each direction, von_mises = of nodes, displacement =, stress =}, or nil, message,
--- details.
function respond_spectrum.measure(part, opts, given)
  local responses = {}
  for k, direction in ipairs(given.directions) do
    local response, message, details = model.try(part.response_spectrum, part,
      {points = given.points, direction = direction, damping = opts.damping,
        modes = responses[1] and responses[1].modes})
    if not response then return nil, message, details end
    responses[k] = response
  end
  local all = responses[1]
  if #responses > 1 then all = all:combine({table.unpack(responses, 2)}, {rule = opts.rule}) end
  return {response = all, responses = responses, von_mises = all.von_mises,
    displacement = largest_of(part.mesh, all.displacement),
    stress = largest_of(part.mesh, all.von_mises)}
end

--- What was found, in sentences and in JSON.
function respond_spectrum.report(found, errors, opts, say, out)
  local response, stress, displacement, list = found.response, found.stress, found.displacement, bw.json.list {}
  for k, one in ipairs(found.responses) do
    local lines = spectra.parts(one)
    say("%s.", (lines[1]:gsub("^%l", string.upper)))
    for i = 2, #lines do say("%s", lines[i]) end
    list[k] = {direction = one.direction, mass_kg = one.mass, missing_mass_kg = one.missing_mass,
      base_acceleration_m_s2 = one.base_acceleration, counted = one.modes.counted,
      effective_masses_kg = bw.json.list(one.effective_masses:totable()),
      accelerations_m_s2 = bw.json.list(one.accelerations:totable()), value = one.von_mises:max()}
  end
  local several, frequencies = #list > 1, {}
  for k = 1, #found.responses[1].accelerations do frequencies[k] = found.responses[1].modes.frequencies[k] end
  if several then say("All directions at once are combined by the %s.", spectra.rule_words[opts.rule]) end
  out:say("")
  say("The largest component of the displacement is %s, relative to the supports, at %s (estimated error of "
    .. "the mesh %s, %s).", shown.estimate(displacement.value, "m"), core.point(displacement.at),
    shown.error(errors.displacement), errors.way)
  say("The largest von Mises stress is %s at %s (estimated error of the mesh %s, %s).",
    shown.estimate(stress.value, "Pa"), core.point(stress.at), shown.error(errors.stress), errors.way)
  say("The largest force on the supports is %s along the axes; its error by the mesh is unknown.",
    shown.vector(response.base_force, "N"))
  say("The combination of modes%s is an estimate, whose error is unknown. Linear theory; loads and fatigue "
    .. "are not in it.", several and " and of directions" or "")
  out:json {quantity = "largest von Mises stress, Pa", base_force_n = response.base_force, spectra = list,
    natural_frequencies_hz = bw.json.list(frequencies),
    rule = several and opts.rule or nil, combination = found.responses[1].combination}
end

--- Its page.
respond_spectrum.page = respond_page.spectrum

--- What is assumed, for the head of the page.
respond_spectrum.assumption = "the largest values of all modes, combined by CQC: their error is unknown"

return respond_spectrum
