-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Strengthening: a surface is thickened around its weak places until it bears a force. Advice (advice.lua) says
-- where and by how much, bumps (bumps.lua) move the surface, and the breaking force is computed again.
-- docs/theory/strengthen.md has the mathematics.
local breaking_force = require "barwright.breaking_force"
local bumps = require "barwright.bumps"
local core = require "barwright.core"
local options = require "barwright.options"

local strengthen = {}
strengthen.__index = strengthen
strengthen.__name = "barwright.strengthen"

local rules = {
  force = {type = "number", above = 0, needed = true},
  material = {type = "material", needed = true},
  contact = {type = "number", default = 1e-4, above = 0},
  elements = {type = "integer", default = 20000, least = 1, most = 10000000},
  length = {type = "any"},
  failure = {type = "string", one_of = {"principal", "von_mises"}},
  modes = {type = "integer", default = 15, least = 1, most = 500},
  regions = {type = "integer", default = 5, least = 1, most = 1000},
  seed = {type = "integer", default = 1},
  steps = {type = "integer", default = 8, least = 1, most = 100},
  keep = {type = "function"},
  progress = {type = "function"},
}

-- Places of a step whose surroundings are refined, and the edge length there over the judged patch's radius.
local REFINED, EDGE = 6, 0.7
-- Between two full analyses one mesh is analysed, with fewer modes and regions.
local QUICK_MODES, QUICK_REGIONS = 8, 3
-- How often a bump is halved where the surface crosses itself before it is left out; defects that are looked at,
-- at most, and how far beyond its radius, over the radius, a bump may cause one.
local HALVINGS, DEFECTS, NEAR = 3, 1000, 0.3
-- Where crossings are taken out, the volume may change by this share of what the bumps add; seconds for it.
local RESOLVED, TIME_LIMIT = 0.2, 60
-- The next step aims higher by what the last one fell short of its prediction, at least and at most so much: what
-- it falls short of the goal alone is less than a new mesh changes.
local LEAST_MORE, MOST_MORE = 1.05, 1.3
-- A step that moves nothing by more than this share of the judged patch's radius has no effect.
local LEAST_OFFSET = 1e-3

local function full(self, surface)
  local wish = self.options
  return breaking_force(surface, {material = wish.material, force = wish.force, contact = wish.contact,
    elements = wish.elements, length = self.length or wish.length, failure = wish.failure, modes = wish.modes,
    regions = wish.regions, seed = wish.seed})
end

-- One mesh, refined around the places of a step.
local function quick(self, surface, places)
  local wish, near = self.options, {}
  local list = table.move(places, 1, #places, 1, {})
  table.sort(list, function(a, b) return a.order < b.order end)
  for i = 1, math.min(REFINED, #list) do
    near[i] = {at = list[i].at, radius = self.length, length = EDGE * self.length}
  end
  local mesh, message, details = core.mesh.fill(surface, {order = 2, elements = wish.elements, near = near})
  if not mesh then return nil, message, details end
  return breaking_force(mesh, {material = wish.material, force = wish.force, contact = wish.contact,
    length = self.length, failure = wish.failure, modes = math.min(QUICK_MODES, wish.modes),
    regions = math.min(QUICK_REGIONS, wish.regions), seed = wish.seed})
end

-- Halves the bumps that reach the defects of a report, those that were halved often enough go. Returns whether one
-- is left.
local function lower(places, report)
  local hit, left = false, false
  for _, place in ipairs(places) do
    for _, defect in ipairs(report.defects) do
      local square = 0
      for c = 1, 3 do square = square + (defect.at[c] - place.at[c]) ^ 2 end
      if square < (1 + NEAR) ^ 2 * place.radius ^ 2 then
        hit, place.halve = true, true
        break
      end
    end
  end
  for _, place in ipairs(places) do
    if place.halve or not hit then place.share = place.share / 2 end
    if place.share < 2 ^ -HALVINGS then place.share = 0 end
    place.halve = nil
    left = left or place.share > 0
  end
  return left
end

-- Crossings of a moved surface, as in slots that close, taken out locally: a sound surface of nearly the same
-- volume, or nil.
local function resolve(surface, moved)
  local mended = moved:repair {wrap = false, time_limit = TIME_LIMIT}
  if not mended then return nil end
  local report = mended:check {limit = 1}
  local added = math.abs(moved.volume - surface.volume)
  return report and report.sound and math.abs(mended.volume - moved.volume) <= RESOLVED * added and mended or nil
end

-- The surface with the bumps of a step. Where it would cross itself and that cannot be resolved, bumps are halved.
local function apply(self, surface, places)
  local shape, message = bumps.subdivide(bumps.of_surface(surface), places)
  if not shape then return nil, message, {status = "limit"} end
  for _, place in ipairs(places) do place.share = 1 end
  repeat
    local moved, report, details
    moved, message, details = bumps.to_surface(bumps.displaced(shape, places, self.options.keep))
    if not moved then return nil, message, details end
    report, message, details = moved:check {limit = DEFECTS}
    if not report then return nil, message, details end
    if report.sound then return moved end
    moved = resolve(surface, moved)
    if moved then return moved end
    if core.interrupted() then return nil, "interrupted", {status = "cancelled"} end
  until not lower(places, report)
  return nil, ("around (%.4g, %.4g, %.4g) mm the surface cannot be thickened further: it would cross itself")
    :format(places[1].at[1] * 1e3, places[1].at[2] * 1e3, places[1].at[3] * 1e3), {status = "geometry"}
end

local function summary(breaking, surface, material)
  local volume = math.abs(surface.volume)
  return {force = breaking.force, low = breaking.low, high = breaking.high, at = breaking.at,
    estimated_error = breaking.estimated_error, singular = breaking.singular, contact = breaking.contact,
    volume = volume, mass = material.density and material.density * volume}
end

local function note(self, step)
  self.steps[#self.steps + 1] = step
  if self.options.progress then self.options.progress(step) end
end

-- A step's advice, the surface that follows it, or why there is none.
local function step_on(self, current, goal)
  local advised, message, details = current:advice {force = self.options.force, keep = self.options.keep,
    estimate = goal}
  if not advised then return nil, message, details end
  local largest = 0
  for i, place in ipairs(advised.places) do
    place.order = i
    largest = math.max(largest, place.offset)
  end
  if largest < LEAST_OFFSET * self.length then
    return nil, "thickening around the weak places does not help any more", {status = "infeasible"}
  end
  local moved
  moved, message, details = apply(self, self.surface, advised.places)
  if not moved then return nil, message, details end
  local count, offset = 0, 0
  for _, place in ipairs(advised.places) do
    count = count + (place.share > 0 and 1 or 0)
    offset = math.max(offset, place.share * place.offset)
  end
  return moved, {places = count, offset = offset, predicted = advised.force, list = advised.places}
end

-- Steps until a full analysis is on the safe side, nothing helps any more, or the steps are used up.
local function run(self, breaking)
  local wish, current, aim = self.options, breaking, 1
  for _ = 1, wish.steps do
    -- The estimate that is needed for the lower end to reach the force, as far as the last full analysis tells.
    local goal = wish.force * breaking.force / breaking.low
    local moved, step, details = step_on(self, current, aim * goal)
    if current ~= breaking then current:close() end
    if not moved then
      self.stopped = step
      return details and (details.status == "infeasible" or details.status == "geometry") or nil, step, details
    end
    local message
    current, message, details = quick(self, moved, step.list)
    if not current then return nil, message, details end
    self.surface, step.list = moved, nil
    step.force = current.force
    if current.force < goal then
      aim = aim * math.max(LEAST_MORE, math.min(step.predicted / current.force, MOST_MORE))
    end
    if current.force >= goal or #self.steps + 1 >= wish.steps then
      current:close()
      breaking:close()
      breaking, message, details = full(self, moved)
      if not breaking then return nil, message, details end
      current, self.breaking = breaking, breaking
      step.force, step.low, step.high = breaking.force, breaking.low, breaking.high
    end
    note(self, step)
    if current == breaking and breaking.low >= wish.force then return true end
  end
  if current ~= breaking then current:close() end
  return true
end

--- A surface thickened around its weak places until its breaking force exceeds {force = N}. Returns nil, message,
--- details where it cannot be computed.
function strengthen.run(surface, given)
  options.object("strengthen", "surface", surface, "surface")
  local wish = options.read("strengthen", given, rules)
  if not wish.material.strength then
    return nil, "the strength of the material is not known", {status = "unsupported"}
  end
  local start = core.seconds()
  local self = setmetatable({options = wish, steps = {}, surface = surface}, strengthen)
  local report, message, details = surface:check {limit = 1}
  if not report then return nil, message, details end
  if not report.sound then
    self.surface, message, details = surface:repair()
    if not self.surface then return nil, message, details end
    self.repaired = true
  end
  self.original = self.surface
  local breaking
  breaking, message, details = full(self, self.surface)
  if not breaking then return nil, message, details end
  self.length, self.breaking = breaking.length, breaking
  self.before = summary(breaking, self.surface, wish.material)
  if breaking.low < wish.force then
    local fine
    fine, message, details = run(self, breaking)
    if not fine then return nil, message, details end
    if self.stopped or self.breaking.worst == nil then
      -- The last steps had no full analysis.
      self.breaking:close()
      if #self.steps > 0 and not self.steps[#self.steps].low then
        self.breaking, message, details = full(self, self.surface)
        if not self.breaking then return nil, message, details end
      end
    end
  end
  self.after = summary(self.breaking, self.surface, wish.material)
  self.reached = self.after.low >= wish.force
  self.added_volume = self.after.volume - self.before.volume
  self.seconds = core.seconds() - start
  self.breaking:close()
  return self
end

function strengthen:__tostring()
  local head = ("breaking force from %.3g N (%.3g to %.3g N) to %.3g N (%.3g to %.3g N)"):format(self.before.force,
    self.before.low, self.before.high, self.after.force, self.after.low, self.after.high)
  return ("%s in %d steps, %.3g %% more volume; %.3g N %s"):format(head, #self.steps,
    100 * self.added_volume / self.before.volume, self.options.force, self.reached and "is reached"
      or "is not reached")
end

return setmetatable({class = strengthen}, {
  __call = function(_, surface, given) return strengthen.run(surface, given) end,
})
