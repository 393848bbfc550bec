-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Drops in time of random attitudes from one factor and one set of modes: how likely each place is to break.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local has_strength = require "barwright.has_strength"
local obstacle = require "barwright.obstacle"
local options = require "barwright.options"
local random = require "barwright.study.random"
local shown = require "barwright.shown"

local random_drops = {}
random_drops.__index = random_drops
random_drops.__name = "barwright.random_drops"

local rules = {
  drops = {type = "integer", default = 100, min = 1},
  seed = {type = "integer", default = 1},
  height = {type = "number", default = 1, above = 0},
  spin = {type = "number", default = 0, min = 0},
  damping = {type = "any"}, -- read where it is used
  onto = {type = "rigid_surface"},
  modes = {type = "modes"},
  impacts = {type = "integer", default = 1, min = 1},
  samples = {type = "integer", default = 20, min = 1},
}

local QUANTILE = 1.959964 -- of the normal distribution, for 95 %

-- Wilson's interval of a probability of which a fraction p of n was seen.
local function interval(p, n)
  local square = QUANTILE * QUANTILE
  local middle = (p + square / (2 * n)) / (1 + square / n)
  local half = QUANTILE / (1 + square / n) * math.sqrt(p * (1 - p) / n + square / (4 * n * n))
  return p > 0 and middle - half or 0, p < 1 and middle + half or 1 -- which it is but for rounding
end

local function direction(generator)
  local x, y, z, length
  repeat
    x, y, z = generator:normal(), generator:normal(), generator:normal()
    length = math.sqrt(x * x + y * y + z * z)
  until length > 1e-6
  return {x / length, y / length, z / length}
end

local function scaled(a, s) return {a[1] * s, a[2] * s, a[3] * s} end

-- The options of each drop.
local function attitudes_of(opts)
  local generator, attitudes = random.new(opts.seed), {}
  for i = 1, opts.drops do
    local down = direction(generator)
    local spin = scaled(direction(generator), opts.spin)
    attitudes[i] = {height = opts.height, down = down, spin = spin, damping = opts.damping,
      onto = opts.onto and obstacle.turned(opts.onto, down, direction(generator)), impacts = opts.impacts,
      samples = opts.samples}
  end
  return attitudes
end

-- Of the time of a drop behind the first: what the first one takes, as long as no other is known.
local FIRST = 20

-- From here on, until it is closed, the progress is that of all drops: by the seconds of those that are done.
local function open_progress(self)
  local progress = {shown = 0}
  local count, start = self.options.drops, core.seconds()
  local function fraction_of()
    local done, spent = self.drops, core.seconds() - start
    if done == 0 then return 0 end
    progress.first = progress.first or spent
    local each = done > 1 and (spent - progress.first) / (done - 1) or progress.first / FIRST
    progress.shown = math.max(progress.shown, math.min(0.99, spent / (spent + each * (count - done))))
    return progress.shown
  end
  local before
  before = core.progress(function(stage, fraction)
    if stage ~= "random drops" then
      stage = ("random drops; drop %d of %d, %s"):format(math.min(self.drops + 1, count), count, stage)
    end
    fraction = stage == "random drops" and fraction == 1 and 1 or fraction_of()
    if before then return before(stage, fraction) end
    core.report_progress(stage, fraction)
  end)
  return setmetatable(progress, {__close = function() core.progress(before) end})
end

-- Drops once more. True; or nil, a message, details, and nothing has changed.
local function add(self, part, attitude, misses)
  local row, impact = {peaks = 0, forces = 0, durations = 0, risks = 0, directions = attitude.down}, nil
  if not misses then
    local drop, message, details = part:drop(attitude)
    if not drop then return nil, message, details end
    self.modes, impact = drop.modes, drop.impacts[1]
    self.exceeded = core.array.map("s + (u > 1)", {s = self.exceeded or 0, u = drop.utilisation})
    self.sum = core.array.map("s + u", {s = self.sum or 0, u = drop.max_principal})
    self.energy_error = math.max(self.energy_error, drop.energy_error)
    self.solves = self.solves + drop.solves
    if impact then
      row.peaks, row.forces, row.durations = drop.peak.stress, impact.force, impact.duration
      row.risks = drop.utilisation:max()
      self.furthest_turn = math.max(self.furthest_turn, impact.turn)
    end
    drop:close()
  end
  if not impact then self.misses = self.misses + 1 end -- or it passes beside, for its spin
  for name, list in pairs(self.rows) do list[#list + 1] = row[name] end
  return true
end

--- Drops a part whose strength and density are known.
function random_drops.analyse(part, given)
  options.object("random_drops", "part", part, "model")
  local opts = options.read("random_drops", given, rules)
  if not has_strength(part.material) then
    core.raise "random_drops: the strength of the material is not known: give one, or take part:drop"
  end
  if opts.onto and opts.onto.placed then
    core.raise "random_drops: the obstacle is below the centre of mass: leave out its place"
  end
  local self = setmetatable({options = opts, mesh = part.mesh, drops = 0, misses = 0}, random_drops)
  local begin, modes, attitudes = core.seconds(), opts.modes, attitudes_of(opts)
  local misses, text, why = core.drop_misses(part, attitudes)
  if not misses then return nil, text, why end
  local _ <close> = open_progress(self)
  self.rows = {peaks = {}, forces = {}, durations = {}, directions = {}, risks = {}}
  self.energy_error, self.solves, self.furthest_turn = 0, 0, 0
  for i, attitude in ipairs(attitudes) do
    local ok, message, details = core.report_progress("random drops", (i - 1) / opts.drops)
    if ok then
      attitude.modes, attitude.history = modes, false
      ok, message, details = add(self, part, attitude, misses[i])
    end
    if not ok then
      if details.status ~= "cancelled" or not self.exceeded then return nil, message, details end
      self.stopped = "cancelled" -- those that are done are as random as all
      break
    end
    self.first_seconds = self.first_seconds or not opts.modes and self.modes and core.seconds() - begin or nil
    self.drops, modes = i, modes or self.modes
  end
  if not self.stopped then core.report_progress("random drops", 1) end
  for name, list in pairs(self.rows) do self[name] = core.array.new(list) end
  self.exceedance, self.mean_peak = self.exceeded / self.drops, self.sum / self.drops
  self.modes = modes
  self.seconds = core.seconds() - begin
  self.rows, self.exceeded, self.sum = nil, nil, nil
  return self
end

--- Spearman's rank correlation, weighted by volume, of where drops stress the part with a weakness map (a
--- worst case, a drop test, a brute force, or an array over elements).
function random_drops:correlation(other)
  local map = type(other) == "table" and (other.weakness or other.mean_peak) or other
  return core.rank_correlation(self.mean_peak, map, self.mesh.volumes)
end

--- The fraction of drops in which some place was overloaded, and the ends of its 95 % interval.
function random_drops:failures()
  local p = self.risks:map("a > 1"):sum() / self.drops
  return p, interval(p, self.drops)
end

--- The 95 % interval of the probability that each element breaks: its ends.
function random_drops:interval()
  local n, square = self.drops, QUANTILE * QUANTILE
  local given = {p = self.exceedance, m = square / (2 * n), d = 1 + square / n, q = QUANTILE, n = n,
    r = square / (4 * n * n)}
  return core.array.map("(p > 0) * (p + m - q * sqrt(p * (1 - p) / n + r)) / d", given),
    core.array.map("min(1, (p + m + q * sqrt(p * (1 - p) / n + r)) / d)", given)
end

--- Everything as a .vtu.
function random_drops:write(path)
  local low, high = self:interval()
  return self.mesh:write(path, {fields = {exceedance = {self.exceedance, on = "elements"},
    exceedance_low = {low, on = "elements"}, exceedance_high = {high, on = "elements"},
    mean_peak = {self.mean_peak, on = "elements"}}})
end

--- A picture of how often each place was overloaded. Options: those of bw.picture.
function random_drops:picture(path, given)
  local opts = options.copied(given)
  local surface, nodes, details = self.mesh:surface()
  if not surface then return nil, nodes, details end
  opts.values = self.mesh:to_nodes(self.exceedance, "max"):gather(nodes)
  opts.unit = opts.unit or "drops that overload, %"
  opts.scale = opts.scale or 100
  return core.picture(surface, path, opts)
end

function random_drops:__tostring()
  local p, low, high = self:failures()
  local place = self.exceedance:argmax()
  return table.concat({
    (self.stopped and ("stopped after %d of %d drops; "):format(self.drops, self.options.drops) or "")
      .. ("%d drops from %g m: the part is overloaded in %s of them, by their number %s to %s (95 %%)"):format(
      self.drops, self.options.height, shown.percent(p), shown.percent(low), shown.percent(high))
      .. (self.misses > 0 and ("; %d of them miss it"):format(self.misses) or ""),
    ("  element %d most often, in %s of them; largest stress %.4g MPa, largest force %.4g N"):format(place,
      shown.percent(self.exceedance[place]), self.peaks:max() / 1e6, self.forces:max()),
    ("  %.3g s in all%s; energy kept to %.1e"):format(self.seconds, self.first_seconds
      and (", about %.3g s with equations and modes made for each drop"):format(self.first_seconds * self.drops)
      or "", self.energy_error),
    ("  linear elasticity, %s, no friction; error of mesh, modes and samples unknown: within an element"):format(
      self.options.onto and obstacle.name(self.options.onto) or "rigid plane"),
    "  of a node that touches, stress and overload depend on the mesh"}, "\n")
end

arguments.methods("random drops", random_drops, random_drops, {
  correlation = "other: worst_case|drop_test|brute_force|array", failures = "", interval = "",
  write = "path: string", picture = "path: string, options?: options"})

return setmetatable({class = random_drops}, {
  __call = function(_, part, given) return random_drops.analyse(part, given) end,
})
