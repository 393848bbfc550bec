-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Strengthening: a surface is thickened around its weak places until it carries a force. Advice (advice.lua) says
-- where and by how much, bumps (bumps.lua) move the surface, and the breaking force is computed again.
-- docs/theory/strengthen.md has the mathematics.
local advice = require "barwright.advice"
local breaking_force = require "barwright.breaking_force"
local bumps = require "barwright.bumps"
local core = require "barwright.core"
local mesh_progress = require "barwright.mesh_progress"
local options = require "barwright.options"
local distance = require("barwright.points").distance
local shown = require "barwright.shown"

local strengthen = {}
strengthen.__index = strengthen
strengthen.__name = "barwright.strengthen"

local rules = {
  force = {type = "number", above = 0, needed = true},
  material = {type = "material", needed = true},
  contact = {type = "number", default = 1e-4, above = 0},
  elements = {type = "integer", default = 20000, min = 1, max = 10000000},
  length = {type = "any"},
  failure = {type = "string", one_of = {"principal", "von_mises"}},
  modes = {type = "integer", default = 15, min = 1, max = 500},
  regions = {type = "integer", default = 5, min = 1, max = 1000},
  seed = {type = "integer", default = 1},
  steps = {type = "integer", default = 8, min = 1, max = 100},
  keep = {type = "function"},
  unit = {type = "number", default = 1e-3, above = 0},
  progress = {type = "function"},
}

-- How often a bump is halved where the surface crosses itself before it is left out; defects that are looked at,
-- at most, and how far beyond its radius, over the radius, a bump may cause one.
local HALVINGS, DEFECTS, NEAR = 3, 1000, 0.3
-- Crossings are taken out where they are so many at most: more take long, and bumps that cross so much are too
-- high. The volume may change by this fraction of what the bumps add; how often it is tried.
local CROSSINGS, RESOLVED, ROUNDS = 100, 0.2, 3
-- The next step aims higher by what the last one fell short of its prediction, at least so much: what it falls
-- short of the goal alone is less than a new mesh changes. All steps together aim higher by at most so much: a
-- body that is nearly as weak everywhere falls short in each step, at places that no bump covers.
local MIN_MORE, MAX_MORE = 1.05, 1.3
-- A step that moves nothing by more than this fraction of the judged patch's radius has no effect.
local MIN_OFFSET = 1e-3
-- After a step that makes it worse the next one has half the offsets, down to this fraction of what was advised.
local MIN_FRACTION = 0.25
-- What the lower end of a trimmed step aims at over the force, and the fraction of the offsets from which it is
-- not worth an analysis.
local TRIMMED, WORTHWHILE = 1.03, 0.8

local function analyse(self, surface)
  local opts = self.options
  return breaking_force(surface, {material = opts.material, force = opts.force, contact = opts.contact,
    elements = opts.elements, length = self.length or opts.length, failure = opts.failure, modes = opts.modes,
    regions = opts.regions, seed = opts.seed})
end

-- Halves the bumps that reach the defects of a report; those that were halved often enough, from `fraction`, go.
-- Returns whether one is left.
local function lower(places, report, fraction)
  local hit, left = false, false
  for _, place in ipairs(places) do
    for _, defect in ipairs(report.defects) do
      if distance(defect.at, place.at) < (1 + NEAR) * place.radius then
        hit, place.halve = true, true
        break
      end
    end
  end
  for _, place in ipairs(places) do
    if place.halve or not hit then place.fraction = place.fraction / 2 end
    if place.fraction < fraction * 2 ^ -HALVINGS then place.fraction = 0 end
    place.halve = nil
    left = left or place.fraction > 0
  end
  return left
end

-- The Euler characteristic of a closed surface: it changes where a hole closes or a handle forms.
local function characteristic(surface)
  return surface.point_count - surface.triangle_count / 2
end

-- Crossings of a moved surface, as in slots that become narrow, taken out locally: a sound surface of the same
-- topology and nearly the same volume, or nil. Rounding may make new crossings.
local function resolve(self, surface, moved, found)
  if found.count["self-intersection"] > CROSSINGS then return nil end
  local added = math.abs(moved.volume - surface.volume)
  local repaired = moved
  for _ = 1, ROUNDS do
    repaired = repaired:repair {wrap = false}
    repaired = repaired and bumps.rounded(repaired, self.options.unit)
    local report = repaired and repaired:check {limit = 1}
    if not report or report.shells ~= found.shells or characteristic(repaired) ~= characteristic(surface)
      or math.abs(repaired.volume - moved.volume) > RESOLVED * added then return nil end
    if report.sound then return repaired end
  end
end

-- The surface with the bumps of a step, at first with a fraction of their offsets. Where it would cross itself and
-- that cannot be resolved, bumps are halved.
local function apply(self, from)
  local places, surface = from.advised.places, from.surface
  if not from.shape then
    local message
    from.shape, message = bumps.subdivide(bumps.of_surface(surface), places)
    if not from.shape then return nil, message, {status = "limit"} end
    from.units = bumps.units(from.shape, places, self.options.keep)
  end
  for _, place in ipairs(places) do place.fraction = from.fraction end
  repeat
    if core.interrupted() then return nil, "interrupted", {status = "cancelled"} end
    local moved, message, details = bumps.to_surface(bumps.displaced(from.shape, places, from.units))
    moved = moved and bumps.rounded(moved, self.options.unit)
    if not moved then return nil, message, details end
    local report, why, about = moved:check {limit = DEFECTS}
    if not report then return nil, why, about end
    if report.sound then return moved end
    moved = resolve(self, surface, moved, report)
    if moved then return moved end
    local left = lower(places, report, from.fraction)
  until not left
  return nil, ("around %s the surface cannot be thickened further: it would cross itself")
    :format(core.point(places[1].at)), {status = "geometry"}
end

-- Values of a surface and its analysis for the report, or nil, message, details.
local function summary(breaking, surface, material)
  local volume = math.abs(surface.volume)
  local deviation
  if breaking.mesh then
    local boundary, message, details = breaking.mesh:surface()
    if not boundary then return nil, message, details end
    deviation, message, details = surface:distance(boundary)
    if not deviation then return nil, message, details end
  end
  return {deviation = deviation, force = breaking.force, low = breaking.low, high = breaking.high,
    at = breaking.at, estimated_error = breaking.estimated_error, singular = breaking.singular,
    contact = breaking.contact, volume = volume, mass = material.density and material.density * volume}
end

-- Analyses that may follow, each as much work.
local function planned(count)
  local list = {}
  for k = 1, count do list[k] = 1 end
  return list
end

local function note(self, step)
  self.steps[#self.steps + 1] = step
  if self.options.progress then self.options.progress(step) end
end

-- The next steps begin from a surface, the best one so far.
local function begin(self, from, surface, breaking)
  from.surface, from.breaking, from.fraction = surface, breaking, 1
  from.advised, from.shape, from.units = nil, nil, nil
  self.surface, self.breaking = surface, breaking
end

-- A step from a surface, {surface, breaking, fraction}, or why there is none. Its advice is kept: a further
-- step from there has smaller offsets.
local function step_from(self, from, goal)
  local ok, message, details
  if not from.advised then
    ok, message, details = core.report_progress("advice", 0)
    if not ok then return nil, message, details end
    from.advised, message, details = from.breaking:advice {force = self.options.force, keep = self.options.keep,
      estimate = goal}
    from.breaking:close()
    if not from.advised then return nil, message, details end
  end
  local largest = 0
  for _, place in ipairs(from.advised.places) do largest = math.max(largest, place.offset) end
  if from.fraction < MIN_FRACTION or largest < MIN_OFFSET * self.length then
    return nil, "thickening around the weak places does not help any more", {status = "infeasible"}
  end
  ok, message, details = core.report_progress("thickening", 0)
  if not ok then return nil, message, details end
  local moved
  moved, message, details = apply(self, from)
  if not moved then return nil, message, details end
  local count, offset = 0, 0
  from.fraction = 0
  for _, place in ipairs(from.advised.places) do
    count = count + (place.fraction > 0 and 1 or 0)
    offset = math.max(offset, place.fraction * place.offset)
    from.fraction = math.max(from.fraction, place.fraction)
  end
  return moved, {places = count, offset = offset, predicted = from.advised:predict()}
end

local function cancelled(details)
  return core.interrupted() or type(details) == "table" and details.status == "cancelled"
end

-- Why the steps end, where what was found before stays; else a failure.
local function stop(self, why, details)
  self.stopped = why
  if cancelled(details) or details and details.status == "unsupported" then return nil, why, details end
  return true
end

-- Whether one of the bumps moves a place. One that became the weakest elsewhere says nothing about predictions.
local function is_moved(places, at)
  for _, place in ipairs(places) do
    if place.fraction > 0 and distance(place.at, at) < place.radius then return true end
  end
  return false
end

-- A step and its analysis: the surface, the breaking force and the step, or nil, why there is none, and details.
local function take(self, from, goal)
  local moved, step, details = step_from(self, from, goal)
  if not moved then return nil, step, details end
  local current, message, about = analyse(self, moved)
  if not current then return nil, "the surface of the next step cannot be analysed: " .. message, about end
  step.force, step.low, step.high = current.force, current.low, current.high
  note(self, step)
  return moved, current, step
end

-- A step that went further than the force needs is repeated with smaller offsets: those with which the lower end
-- is TRIMMED times the force, as far as the analyses before and after it tell. Returns the lighter surface and its
-- analysis where they reach the force, else those of the step.
local function trim(self, from, moved, current)
  local opts = self.options
  if from.breaking.low == 0 then return moved, current end
  local fraction = math.log(TRIMMED * opts.force / from.breaking.low) / math.log(current.low / from.breaking.low)
  if fraction > WORTHWHILE then return moved, current end
  from.fraction = math.max(fraction * from.fraction, MIN_FRACTION)
  local lighter, lesser = take(self, from)
  if not lighter then return moved, current end
  if lesser.low < opts.force then
    lesser:close()
    return moved, current
  end
  current:close()
  return lighter, lesser
end

-- Steps, each from the best surface so far, until its interval is on the safe side, nothing helps any more, or the
-- steps are used up. What cannot be analysed ends them.
local function run(self, breaking, progress)
  local opts, aim = self.options, 1
  -- The estimate that is needed for the lower end to reach the force, as far as the best analysis tells.
  local goal = advice.goal(breaking, opts.force)
  local from <close> = setmetatable({}, {__close = function(from) from.breaking:close() end})
  begin(self, from, self.original, breaking)
  for number = 1, opts.steps do
    progress:mesh(1, planned(opts.steps - number))
    local moved, current, step = take(self, from, aim * goal)
    if not moved then return stop(self, current, step) end
    if current.low >= opts.force then
      if number < opts.steps then
        progress:mesh(1, {})
        moved, current = trim(self, from, moved, current)
      end
      begin(self, from, moved, current)
      return true
    elseif current.low <= from.breaking.low then
      current:close()
      from.fraction = from.fraction / 2
    else
      goal = advice.goal(current, opts.force)
      if current.force < goal and is_moved(from.advised.places, current.at) then
        aim = math.min(aim * math.max(MIN_MORE, step.predicted / current.force), MAX_MORE)
      end
      begin(self, from, moved, current)
    end
  end
  return true
end

--- A surface thickened around its weak places until its breaking force exceeds {force = N}. Returns nil, message,
--- details where it cannot be computed.
function strengthen.run(surface, given)
  options.object("strengthen", "surface", surface, "surface")
  local opts = options.read("strengthen", given, rules)
  if not opts.material.strength then
    return nil, "the strength of the material is not known", {status = "unsupported"}
  end
  local start = core.seconds()
  local self = setmetatable({options = opts, steps = {}, surface = surface}, strengthen)
  local report, message, details = surface:check {limit = 1}
  if not report then return nil, message, details end
  if not report.sound then
    self.surface, message, details = surface:repair()
    if not self.surface then return nil, message, details end
    self.repaired = true
  end
  self.original = self.surface
  local progress <close> = mesh_progress.open("strengthening", "analysis", true)
  progress:mesh(1, planned(opts.steps))
  local breaking
  breaking, message, details = analyse(self, self.surface)
  if not breaking then return nil, message, details end
  self.length = breaking.length
  self.before, message, details = summary(breaking, self.surface, opts.material)
  if not self.before then
    breaking:close()
    return nil, message, details
  end
  self.breaking = breaking
  if breaking.low < opts.force then
    local ok
    ok, message, details = run(self, breaking, progress)
    if not ok then return nil, message, details end
  end
  breaking:close()
  self.after, message, details = summary(self.breaking, self.surface, opts.material)
  if not self.after then return nil, message, details end
  self.reached = self.after.low >= opts.force
  self.added_volume = self.after.volume - self.before.volume
  self.seconds = core.seconds() - start
  return self
end

function strengthen:__tostring()
  local before, after = self.before, self.after
  return ("breaking force from %s to %s in %d steps, %s more volume; %s %s"):format(
    shown.interval(before.force, before.low, before.high, "N"),
    shown.interval(after.force, after.low, after.high, "N"),
    #self.steps, shown.percent(self.added_volume / before.volume), core.quantity(self.options.force, "N"),
    self.reached and "is reached"
      or "is not reached")
end

return setmetatable({class = strengthen}, {
  __call = function(_, surface, given) return strengthen.run(surface, given) end,
})
