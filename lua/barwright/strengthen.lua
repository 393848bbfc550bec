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
  unit = {type = "number", default = 1e-3, above = 0},
  progress = {type = "function"},
}

-- Places of a step whose surroundings are refined, and the edge length there over the judged patch's radius.
local REFINED, EDGE = 6, 0.7
-- Between two full analyses one mesh is analysed, with fewer modes and regions.
local QUICK_MODES, QUICK_REGIONS = 8, 3
-- How often a bump is halved where the surface crosses itself before it is left out; defects that are looked at,
-- at most, and how far beyond its radius, over the radius, a bump may cause one.
local HALVINGS, DEFECTS, NEAR = 3, 1000, 0.3
-- Where crossings are taken out, the volume may change by this share of what the bumps add; seconds for it; how
-- often it is tried.
local RESOLVED, TIME_LIMIT, ROUNDS = 0.2, 60, 3
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

-- The Euler characteristic of a closed surface: it changes where a hole closes or a handle forms.
local function characteristic(surface)
  return surface.point_count - surface.triangle_count / 2
end

-- Crossings of a moved surface, as in slots that become narrow, taken out locally: a sound surface of the same
-- topology and nearly the same volume, or nil. Rounding may make new crossings.
local function resolve(self, surface, moved, shells)
  local added = math.abs(moved.volume - surface.volume)
  local mended = moved
  for _ = 1, ROUNDS do
    mended = mended:repair {wrap = false, time_limit = TIME_LIMIT}
    mended = mended and bumps.rounded(mended, self.options.unit)
    local report = mended and mended:check {limit = 1}
    if not report or report.shells ~= shells or characteristic(mended) ~= characteristic(surface)
      or math.abs(mended.volume - moved.volume) > RESOLVED * added then return nil end
    if report.sound then return mended end
  end
end

-- The surface with the bumps of a step. Where it would cross itself and that cannot be resolved, bumps are halved.
local function apply(self, surface, places)
  local shape, message = bumps.subdivide(bumps.of_surface(surface), places)
  if not shape then return nil, message, {status = "limit"} end
  for _, place in ipairs(places) do place.share = 1 end
  repeat
    local moved, report, details
    moved, message, details = bumps.to_surface(bumps.displaced(shape, places, self.options.keep))
    moved = moved and bumps.rounded(moved, self.options.unit)
    if not moved then return nil, message, details end
    report, message, details = moved:check {limit = DEFECTS}
    if not report then return nil, message, details end
    if report.sound then return moved end
    moved = resolve(self, surface, moved, report.shells)
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
local function step_on(self, surface, current, goal)
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
  moved, message, details = apply(self, surface, advised.places)
  if not moved then return nil, message, details end
  local count, offset = 0, 0
  for _, place in ipairs(advised.places) do
    count = count + (place.share > 0 and 1 or 0)
    offset = math.max(offset, place.share * place.offset)
  end
  return moved, {places = count, offset = offset, predicted = advised.force, list = advised.places}
end

local function cancelled(details)
  return core.interrupted() or type(details) == "table" and details.status == "cancelled"
end

-- Keeps a surface if it is the best one so far: `best` of all, by the estimate; `sure` of those that were analysed
-- on several meshes, where one that bears the force goes before.
local function remember(self, surface, breaking, is_full)
  local one = {surface = surface, breaking = breaking, force = breaking.force, is_full = is_full}
  if not self.best or one.force > self.best.force then self.best = one end
  if is_full and (not self.sure or breaking.low >= self.options.force or one.force > self.sure.force) then
    self.sure = one
  end
end

-- One mesh of a step's surface; several where that suffices or no step is left. Returns the analysis and whether
-- it is a full one.
local function analyse(self, surface, places, goal)
  local quickly, message, details = quick(self, surface, places)
  if not quickly then return nil, message, details end
  if quickly.force < goal and #self.steps + 1 < self.options.steps then return quickly, false end
  quickly:close()
  local breaking
  breaking, message, details = full(self, surface)
  if not breaking then return nil, message, details end
  return breaking, true
end

-- Steps until a full analysis is on the safe side, nothing helps any more, or the steps are used up. What cannot
-- be analysed ends them, and what was found before stays.
local function run(self, breaking)
  local wish, current, aim, surface = self.options, breaking, 1, self.original
  local goal = wish.force * breaking.force / breaking.low
  for _ = 1, wish.steps do
    local moved, step, details = step_on(self, surface, current, aim * goal)
    current:close()
    if not moved then
      self.stopped = step
      local stops = #self.steps > 0 or details.status == "infeasible" or details.status == "geometry"
      return stops and not cancelled(details) or nil, step, details
    end
    local is_full
    current, is_full, details = analyse(self, moved, step.list, goal)
    if not current then
      self.stopped = "the surface of the next step cannot be analysed: " .. is_full
      return not cancelled(details) or nil, is_full, details
    end
    surface, step.list = moved, nil
    remember(self, surface, current, is_full)
    step.force = current.force
    if current.force < goal then
      aim = aim * math.max(LEAST_MORE, math.min(step.predicted / current.force, MOST_MORE))
    end
    if is_full then
      step.low, step.high = current.low, current.high
      -- The estimate that is needed for the lower end to reach the force, as far as this analysis tells.
      goal = wish.force * current.force / current.low
    end
    note(self, step)
    if is_full and current.low >= wish.force then break end
  end
  current:close()
  return true
end

-- Of what was analysed on several meshes the best surface; the best of all is analysed so first.
local function choose(self)
  local best = self.best
  if not best.is_full and self.sure.breaking.low < self.options.force then
    local breaking, _, details = full(self, best.surface)
    if breaking then
      breaking:close()
      remember(self, best.surface, breaking, true)
    elseif cancelled(details) then
      return nil, "interrupted", details
    end
  end
  self.surface, self.breaking = self.sure.surface, self.sure.breaking
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
  self.length = breaking.length
  self.before = summary(breaking, self.surface, wish.material)
  remember(self, self.surface, breaking, true)
  if breaking.low < wish.force then
    local fine
    fine, message, details = run(self, breaking)
    if not fine then return nil, message, details end
  end
  breaking:close()
  local chosen
  chosen, message, details = choose(self)
  if not chosen then return nil, message, details end
  self.after = summary(self.breaking, self.surface, wish.material)
  self.reached = self.after.low >= wish.force
  self.added_volume = self.after.volume - self.before.volume
  self.best, self.sure = nil, nil
  self.seconds = core.seconds() - start
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
