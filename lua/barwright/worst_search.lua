-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The search beside the modes (docs/theory/worst_case.md, section 13): elements chosen by a screening
-- with coarse pressures become targets of their own; the largest stresses found ascend.
local core = require "barwright.core"
local load_limits = require "barwright.load_limits"
local solver_reports = require "barwright.solver_reports"

local worst_search = {}

-- A pressed area F / p_max should span at least two patches.
local PATCHES_PER_CONTACT, FEWEST_PATCHES, MAX_PATCHES = 2, 64, 192
-- The responses to the patches take 24 bytes for each node and patch: so many at most, if 64 fit.
local MAX_BYTES = 2 ^ 29
-- Rounds of targets: at least two; more while the percentile by volume grows by this much.
local ROUNDS, MAX_ROUNDS, GROWTH = 2, 3, 0.01
local PERCENTILE = 0.9975
-- Peaks that ascend at once, and steps at most. A step that gains less than this ends the ascent.
local ASCENTS, ASCENT_STEPS, GAIN = 6, 8, 1e-4
worst_search.GAIN = GAIN
-- Stress that the exact linear program reaches over that of the screening, before any is known.
local FIRST_RATIO = 1.5

--- Numbers 1..count of the elements that a screening left as targets, most promising first: no two of
--- them share a node. `ratio`: what the exact linear program is expected to gain.
local function choose(self, screened, weakness, ratio, count)
  local order, known = {}, weakness:gather(screened.targets)
  for i = 1, screened.targets.row_count do
    local promising = ratio * screened.values[i] > (1 + GROWTH) * known[i]
    if promising and not screened.tried[i] then order[#order + 1] = i end
  end
  local corners, touched, chosen = self.mesh.elements, {}, {}
  for _, i in ipairs(order) do -- the screening is by descending stress
    if #chosen == count then break end
    local element, free = screened.targets[i], true
    for corner = 1, 4 do free = free and not touched[corners(element, corner)] end
    if free then
      for corner = 1, 4 do touched[corners(element, corner)] = true end
      screened.tried[i] = true
      chosen[#chosen + 1] = i
    end
  end
  return chosen
end

local function median(list)
  table.sort(list)
  return list[(#list + 1) // 2]
end

--- The worst loads of more targets, after those at hand.
function worst_search.directed(self, loads, elements, stresses, limits)
  local regions, message, details = core.directed_regions(self.mesh, elements, stresses)
  if not regions then return nil, message, details end
  local opts = {one_sign = true, after = loads}
  for key, value in pairs(limits) do opts[key] = value end
  local more
  more, message, details = core.worst_loads(self.system, self.basis, regions, opts)
  if not more then return nil, message, details end
  solver_reports.add(self.reports, "lp", more.report)
  return more
end

local function rows_of(array, list)
  return array:gather(core.array.new(list, "i32"))
end

local function elements_of(array, list)
  local out = {}
  for k, i in ipairs(list) do out[k] = array[i] end
  return out
end

--- The worst loads of targets that the screening suggests, in rounds, after those at hand. `self.signs`: -1 for
--- the opposite of the stress that the screening found, too.
function worst_search.explore(self, loads, origins, limits)
  local basis, message, details = load_limits.without_friction(self.mesh, self.options, self.basis)
  if not basis then return nil, message, details end
  local patches = math.min(MAX_PATCHES, MAX_BYTES // (24 * self.mesh.node_count),
    PATCHES_PER_CONTACT * limits.pressure * basis.areas:sum() // limits.force)
  local screened
  screened, message, details = core.worst_screening(self.system, basis, {
    pressure = limits.pressure, force = limits.force, force_is_max = limits.force_is_max, lp = limits.lp,
    patches = math.floor(math.max(FEWEST_PATCHES, patches)), targets = 2 * self.options.targets + 32})
  if not screened then return nil, message, details end
  solver_reports.add(self.reports, "lp", screened.report)
  screened.values, screened.tried = core.max_principal(screened.stresses), {}
  local ratio, round = FIRST_RATIO, 0
  local volumes = self.mesh.volumes
  local reached, before = loads.weakness:quantile(PERCENTILE, volumes), 0
  while round < ROUNDS or (round < MAX_ROUNDS and reached > (1 + GROWTH) * before) do
    round = round + 1
    local chosen = choose(self, screened, loads.weakness, ratio, math.max(1, self.options.targets // ROUNDS))
    if #chosen == 0 then break end
    local elements = elements_of(screened.targets, chosen)
    local ratios = {}
    for _, sign in ipairs(self.signs or {1}) do
      local earlier = loads.peaks.row_count
      loads, message, details = worst_search.directed(self, loads, elements,
        rows_of(screened.stresses, chosen) * sign, limits)
      if not loads then return nil, message, details end
      for k, i in ipairs(chosen) do
        origins[earlier + k] = {origin = "element", target = elements[k]}
        if sign == 1 then ratios[k] = loads.objectives[earlier + k] / screened.values[i] end
      end
    end
    ratio = math.max(1, median(ratios))
    before, reached = reached, loads.weakness:quantile(PERCENTILE, volumes)
  end
  return loads
end

-- Loads of the largest peaks that were not tried yet, no two in one element.
local function highest(loads, tried)
  local order, taken, chosen = loads.peaks:order(), {}, {}
  for k = order.row_count, 1, -1 do
    local i = order[k]
    local element = loads.peak_elements[i]
    if loads.peaks[i] > 0 and not taken[element] then -- without stress there is no direction
      taken[element] = true
      if not tried[i] then chosen[#chosen + 1] = i end
      if #chosen == ASCENTS then break end
    end
  end
  return chosen
end

--- The linear programs of the peaks of `chosen` loads, along their principal directions, after the loads at hand.
function worst_search.step(self, loads, origins, limits, chosen)
  local earlier, elements = loads.peaks.row_count, elements_of(loads.peak_elements, chosen)
  local more, message, details = worst_search.directed(self, loads, elements,
    rows_of(loads.peak_stresses, chosen), limits)
  if not more then return nil, message, details end
  for k, i in ipairs(chosen) do
    origins[earlier + k] = {origin = "ascent", target = elements[k], from = i}
  end
  return more
end

--- The largest peaks ascend: each linear program reaches at least the stress that it starts from, in that element.
--- `step`: as worst_search.step.
function worst_search.ascend(self, loads, origins, limits, step)
  local tried = {}
  for _ = 1, ASCENT_STEPS do
    local chosen = highest(loads, tried)
    if #chosen == 0 then break end
    local largest = loads.peaks:max()
    for _, i in ipairs(chosen) do tried[i] = true end
    local more, message, details = step(self, loads, origins, limits, chosen)
    if not more then return nil, message, details end
    loads = more
    if loads.peaks:max() < (1 + GAIN) * largest then break end
  end
  return loads
end

--- An upper bound within `tolerance` of the largest stress: the bound, then results and origins with
--- a load more where a larger stress was found on the way, and the leaves that prove it where a certificate is
--- asked for.
function worst_search.certify(self, loads, origins, limits, tolerance)
  -- Of pressures anywhere, which bounds what hands do.
  local bound, message, details = core.worst_bound(self.system, self.basis, {pressure = limits.pressure,
    force = limits.force, force_is_max = limits.force_is_max, lp = limits.lp, incumbent = loads.peaks:max(),
    tolerance = tolerance, leaves = self.options.certificate ~= nil})
  if not bound then return nil, message, details end
  solver_reports.add(self.reports, "lp", bound.report)
  if bound.element then
    local earlier = loads.peaks.row_count
    loads, message, details = worst_search.directed(self, loads, {bound.element}, bound.stress, limits)
    if not loads then return nil, message, details end
    origins[earlier + 1] = {origin = "bound", target = bound.element}
  end
  return bound.upper, loads, bound.leaves
end

--- More loads after those of the modes' regions: nil, message, details or the results of all, as
--- core.worst_loads gives them. `origins[i]` of each load beyond the first ones: {origin, target, from}.
function worst_search.extend(self, loads, limits)
  local origins = {}
  local more, message, details = worst_search.explore(self, loads, origins, limits)
  if more then more, message, details = worst_search.ascend(self, more, origins, limits, worst_search.step) end
  if not more then return nil, message, details end
  return more, origins
end

return worst_search
