-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Random vibration: root mean squares of a harmonic response to a random process, and what they mean for strength
-- and fatigue. docs/theory/dynamics.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local members = require "barwright.members"
local nodal_files = require "barwright.nodal_files"
local options = require "barwright.options"
local shown = require "barwright.shown"

local harmonic = core.classes.harmonic.methods

local root_mean_squares, of_margins, of_damage = harmonic.random, harmonic.random_margins, harmonic.random_damage
harmonic.random_margins, harmonic.random_damage = nil, nil -- the engine's, for this file

local random = {}
random.__index = members("random response", random, {})
random.__name = "barwright.random_response"

--- Root mean squares where what acts is multiplied by a random process: {psd = {{Hz, 1/Hz}, ...}}.
function harmonic:random(given)
  local opts = options.read("random", given, {psd = {type = "any", needed = true}})
  local displacement, von_mises, motions_or_details, wrong = root_mean_squares(self, opts.psd)
  if not displacement then return nil, von_mises, motions_or_details end
  local couplings = {}
  for p, motion in ipairs(motions_or_details:totable()) do
    couplings[p] = {displacement = table.move(motion, 1, 3, 1, {}), rotation = table.move(motion, 4, 6, 1, {})}
  end
  return setmetatable({displacement = displacement, von_mises = von_mises, error = wrong,
    counted = self.modes.counted, mesh = self.mesh, couplings = couplings, response = self,
    psd = core.array.new(opts.psd)}, random)
end

--- Root mean squares of displacement and von Mises stress, as .vtu (or what the ending says).
function random:write(path, given)
  return nodal_files.write(self.mesh, {rms_displacement = self.displacement, rms_von_mises = self.von_mises}, path,
    given)
end

--- The body coloured by the root mean square of von Mises stress; options of bw.picture.
function random:picture(path, given)
  return nodal_files.picture(self.mesh, self.von_mises, "root mean square of von Mises stress", path, given)
end

local vibration = {}

--- How sure the modes and the equations of a random response are, in words.
function vibration.equations(self)
  local counted = self.counted
  return ("modes %s; error of the equations %s"):format(counted and "counted: none is missing" or "not counted",
    self.error < math.huge and ("%s %.1e of the displacement, in energy"):format(counted and "at most" or "about",
      self.error) or "unknown")
end

function random:__tostring()
  return ("random response: largest root mean squares %s and %s of von Mises stress, 3 times that %s; %s; errors "
    .. "of the quadrature and of the mesh unknown"):format(core.quantity(self.displacement:max(), "m"),
    core.quantity(self.von_mises:max(), "Pa"), core.quantity(3 * self.von_mises:max(), "Pa"),
    vibration.equations(self))
end

local function place_of(mesh, node)
  return mesh.nodes:rows(node, node):totable()[1]
end

-- ---- strength ------------------------------------------------------------------------------------

local margins = {}
margins.__index = members("random margins", margins, {})
margins.__name = "barwright.random_margins"

--- Probabilities that von Mises stress exceeds the strength: {duration =, strength =, sigma =}.
function random:margins(given)
  local opts = options.read("margins", given, {
    duration = {type = "number", needed = true, min = 0},
    strength = {type = "number", above = 0},
    sigma = {type = "number", default = 3, above = 0},
  })
  local exceedance, rate, used, beyond = of_margins(self.response, self.psd, opts.strength or 0, opts.sigma)
  if not exceedance then return nil, rate, used end
  local made = {mesh = self.mesh, sigma = opts.sigma, duration = opts.duration, exceedance = exceedance,
    rate = rate, used = used,
    first_passage = core.array.map("min(1, p + n * t)", {p = exceedance, n = rate, t = opts.duration})}
  -- where several bounds are 1, the larger share of the time
  local bound = core.array.map("b + (b >= 1) * p", {b = made.first_passage, p = exceedance})
  local node = bound:max() > 0 and bound:argmax() or used:argmax()
  made.node, made.at = node, place_of(self.mesh, node)
  made.poisson = 1 - (1 - exceedance[node]) * math.exp(-rate[node] * opts.duration)
  if made.poisson < 1e-8 then made.poisson = made.first_passage[node] end -- without the rounding of 1
  made.margin_node = used:argmax()
  made.margin_at = place_of(self.mesh, made.margin_node)
  made.margin = 1 / used[made.margin_node] - 1
  made.beyond = beyond[made.margin_node]
  return setmetatable(made, margins)
end

--- What margins say, in sentences.
function vibration.margin_sentences(self)
  local node, duration = self.node, core.quantity(self.duration, "s")
  local out = {
    ("%g times the root mean square of von Mises stress is %s of the strength at %s: the margin is %s."):format(
      self.sigma, shown.percent(self.used[self.margin_node]), core.point(self.margin_at),
      shown.percent(self.margin)),
    ("There von Mises stress exceeds these %g deviations for %s of the time."):format(self.sigma,
      shown.percent(self.beyond)),
  }
  if self.first_passage[node] == 0 then
    out[3] = ("The probability that it exceeds the strength in %s is below 1e-300 at each place."):format(duration)
    return out
  end
  out[3] = ("It exceeds the strength at %s for %s of the time, and begins to %s times a second at most."):format(
    core.point(self.at), shown.percent(self.exceedance[node]), shown.estimate(self.rate[node], ""))
  out[4] = ("The probability that it does so in %s is at most %s; %s where crossings are independent "
    .. "(Poisson)."):format(duration, shown.percent(self.first_passage[node]), shown.percent(self.poisson))
  return out
end

vibration.assumptions = "Stresses are taken as Gaussian with the mean 0, without static ones, each place by itself"
local unknown = vibration.assumptions .. "; errors of the quadrature and of the mesh unknown"

function margins:__tostring()
  return ("random margins: %s %s"):format(table.concat(vibration.margin_sentences(self), " "), unknown)
end

--- Probabilities and rates as .vtu (or what the ending says).
function margins:write(path, given)
  return nodal_files.write(self.mesh, {exceedance = self.exceedance, crossing_rate = self.rate,
    first_passage = self.first_passage, used = self.used}, path, given)
end

--- The body coloured by the used part of the strength; options of bw.picture.
function margins:picture(path, given)
  local opts = options.copied(given)
  opts.unit, opts.scale = opts.unit or ("%g deviations over the strength"):format(self.sigma), opts.scale or 1
  return nodal_files.picture(self.mesh, self.used, "", path, opts)
end

-- ---- fatigue -------------------------------------------------------------------------------------

local fatigue = {}
fatigue.__index = members("random fatigue", fatigue, {})
fatigue.__name = "barwright.random_fatigue"

local methods = {"tovo_benasciutti", "dirlik", "wirsching_light", "narrow_band"} -- as the engine numbers them

--- Damage of the vibration by its spectral moments: {duration =, curve = {amplitude =, cycles =, ...}}.
function random:fatigue(given)
  local opts = options.read("fatigue", given, {
    duration = {type = "number", needed = true, min = 0},
    curve = {type = "table", needed = true},
  })
  local rate, moments, details = of_damage(self.response, self.psd, opts.curve)
  if not rate then return nil, moments, details end
  local node, by = rate:argmax(), {}
  local m = moments:rows(node, node):totable()[1]
  for k, name in ipairs(methods) do
    by[name] = opts.duration * core.spectral_damage(opts.curve, k, m[1], m[2], m[3], m[4])
  end
  local worst = rate[node]
  return setmetatable({mesh = self.mesh, duration = opts.duration, rate = rate, damage = rate * opts.duration,
    moments = moments, by = by, node = node, at = place_of(self.mesh, node),
    life = worst > 0 and 1 / worst or math.huge}, fatigue)
end

--- The damage as .vtu (or what the ending says).
function fatigue:write(path, given)
  return nodal_files.write(self.mesh, {damage = self.damage}, path, given)
end

--- The body coloured by the damage; options of bw.picture.
function fatigue:picture(path, given)
  local opts = options.copied(given)
  opts.unit, opts.scale = opts.unit or "damage in " .. core.quantity(self.duration, "s"), opts.scale or 1
  return nodal_files.picture(self.mesh, self.damage, "", path, opts)
end

--- What damage says, in sentences.
function vibration.fatigue_sentences(self)
  if self.life == math.huge then return {"No amplitude does damage."} end
  local by = self.by
  return {
    ("The damage in %s is %s at %s (Dirlik): damage 1 takes %s."):format(core.quantity(self.duration, "s"),
      shown.estimate(self.damage[self.node], ""), core.point(self.at), shown.estimate(self.life, "s")),
    ("Other methods give %s (Tovo and Benasciutti), %s (Wirsching and Light) and %s (narrow band)."):format(
      shown.estimate(by.tovo_benasciutti, ""), shown.estimate(by.wirsching_light, ""),
      shown.estimate(by.narrow_band, "")),
  }
end

function fatigue:__tostring()
  return ("random fatigue: %s %s; life curves scatter by factors of 2 to 10"):format(
    table.concat(vibration.fatigue_sentences(self), " "), unknown)
end

local files = {write = "path: string, options?: options", picture = "path: string, options?: options"}
arguments.methods("harmonic", harmonic, nil, {random = "options: options"})
arguments.methods("random_response", random, random, {margins = "options: options", fatigue = "options: options",
  write = files.write, picture = files.picture})
arguments.methods("random_margins", margins, margins, files)
arguments.methods("random_fatigue", fatigue, fatigue, files)

return vibration
