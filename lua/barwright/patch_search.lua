-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The search for loads that maximise the mean stress over patches of the boundary, on one mesh. A screening with
-- coarse pressures rates all patches; the best of them get a linear program each; the largest means ascend.
-- docs/theory/breaking_force.md has the mathematics.
local core = require "barwright.core"
local points = require "barwright.points"
local solver_reports = require "barwright.solver_reports"
local distance, append_apart = points.distance, points.append_apart

local patch_search = {}

-- A pressed area F / p_max should span so many patches of pressure.
local PRESSED, FEWEST, MAX = 8, 96, 128
-- For each patch the responses take 24 bytes for each node, and surface stresses 168 for each facet: so many
-- at most, but FEWEST patches always.
local MAX_BYTES = 2 ^ 29
-- Patches that the screening ranks. Those that may come near the largest mean get linear programs, in rounds of so
-- many; patches of one round lie SPREAD radii apart.
local RANKED, ROUNDS, PER_ROUND, SPREAD = 300, 2, 20, 2
-- So many where places of another mesh are known, and where all that reach a utilisation are looked for.
local ROUNDS_OF_KNOWN, ROUNDS_OF_ALL = 1, 5
local NEARLY, GROWTH, FIRST_RATIO = 0.5, 0.02, 1.5
-- Places whose mean stress ascends at once if they are so near to the largest, steps at most, and the gain below
-- which the ascent ends.
local CLOSE, ASCENTS, STEPS, GAIN = 0.85, 6, 3, 0.01
-- Loads at hand that are rated at first.
local BEGUN = 12
-- Peaks of the mean stress that each load adds to the places, and nodes that are looked at for them.
local PEAKS, LOOKED_AT = 4, 400

local function node_at(mesh, node)
  return {mesh.nodes(node, 1), mesh.nodes(node, 2), mesh.nodes(node, 3)}
end

local function weaker(a, b)
  if a.utilisation ~= b.utilisation then return a.utilisation > b.utilisation end
  if a.region ~= b.region then return a.region < b.region end
  return a.node < b.node
end

-- Adds the largest peaks of the mean stress under a load, no two of them in one patch: {utilisation, at, node,
-- region, stress, point}; `stress` is the mean tensor, `point` the largest utilisation by the surface stress.
local function add_peaks(self, load, used, mean, point)
  local order, found = used:order(), {}
  for k = order.row_count, math.max(1, order.row_count - LOOKED_AT), -1 do
    local node = order[k]
    local at, apart = node_at(self.mesh, node), true
    for _, other in ipairs(found) do apart = apart and distance(at, other.at) > self.radius end
    if apart then
      found[#found + 1] = {utilisation = used[node], at = at, node = node, region = load,
        stress = mean:rows(node, node):copy(), point = point}
      if #found == PEAKS then break end
    end
  end
  table.move(found, 1, #found, #self.places + 1, self.places)
end

-- The utilisation of all nodes by mean stresses, a list for the loads of these numbers; its peaks become places.
local function rate(self, numbers)
  local forces, stresses, list = {}, {}, {}
  for k, load in ipairs(numbers) do forces[k] = self.basis:force(self.loads.pressures[load]) end
  local motions, message, details = self.system:solve(forces)
  if not motions then return nil, message, details end
  for k, u in ipairs(motions) do
    stresses[k], message, details = core.surface_stress(self.mesh, self.material, u, forces[k])
    if not stresses[k] then return nil, message, details end
  end
  local means
  means, message, details = core.surface_means(self.mesh, stresses, self.radius, self.system)
  if not means then return nil, message, details end
  for k, stress in ipairs(stresses) do
    local mean = means:columns(6 * k - 5, 6 * k)
    list[k] = self.measure(mean)
    add_peaks(self, numbers[k], list[k], mean, self.measure(stress):max())
  end
  table.sort(self.places, weaker)
  return list
end

-- What a load reaches in its own patch, and in those of the screening.
local function note(self, used, node, load)
  self.own[load] = used[node]
  if not self.screened then return end
  local values, reached = used:gather(self.screened.targets), self.screened.reached
  for i = 1, values.row_count do reached[i] = math.max(reached[i] or 0, values[i]) end
end

-- Loads that maximise the mean stress around nodes in the principal direction of tensors (rows), and their places.
local function add(self, nodes, rows)
  local patches, message, details = core.patch_regions(self.system, self.radius, nodes, core.array.new(rows))
  if not patches then return nil, message, details end
  local opts, first = {one_sign = true, after = self.loads}, self.loads and self.loads.peaks.row_count or 0
  for key, value in pairs(self.limits) do opts[key] = value end
  local loads
  loads, message, details = core.worst_loads(self.system, self.basis, patches, opts)
  if not loads then return nil, message, details end
  solver_reports.add(self.reports, "lp", loads.report)
  self.loads = loads
  local numbers = {}
  for k = 1, patches.count do
    numbers[k] = first + k
    self.origins[first + k] = {origin = "patch", target = nodes[k], elements = patches[k].count,
      volume = patches[k].volume}
  end
  local list
  list, message, details = rate(self, numbers)
  if not list then return nil, message, details end
  for k, used in ipairs(list) do note(self, used, nodes[k], first + k) end
  return true
end

-- Patches that the screening finds: {targets, stresses}, and their utilisation as `values`.
local function screen(self)
  local limits = self.limits
  local bytes = 24 * self.mesh.node_count + 168 * self.mesh.facets.row_count
  local patches = math.min(MAX, MAX_BYTES // bytes,
    PRESSED * limits.pressure * self.basis.areas:sum() // limits.force)
  local screened, message, details = core.worst_screening(self.system, self.screening_basis, {
    pressure = limits.pressure, force = limits.force, force_is_max = limits.force_is_max, lp = limits.lp,
    radius = self.radius, patches = math.floor(math.max(FEWEST, patches)), targets = RANKED})
  if not screened then return nil, message, details end
  solver_reports.add(self.reports, "lp", screened.report)
  screened.values, screened.tried, screened.reached = self.measure(screened.stresses), {}, {}
  self.screened = screened
  screened.order, screened.rows = screened.values:order(), screened.stresses:totable()
  return screened
end

-- Patches that no load at hand stresses as much as their own may: so many at most, the most stressed first, no two
-- of them close together. `ratio`: what a linear program may gain; `least`: the utilisation that counts.
local function choose(self, screened, ratio, min)
  local nodes, rows, chosen = {}, {}, {}
  min = min or NEARLY * (self.places[1] and self.places[1].utilisation or 0)
  for k = screened.order.row_count, 1, -1 do
    local i = screened.order[k]
    local node, promise = screened.targets[i], ratio * screened.values[i]
    local free = not screened.tried[i] and #nodes < PER_ROUND and promise >= min
      and promise > (1 + GROWTH) * (screened.reached[i] or 0)
    for _, other in ipairs(nodes) do
      free = free and distance(node_at(self.mesh, other), node_at(self.mesh, node)) > SPREAD * self.radius
    end
    if free then
      screened.tried[i] = true
      nodes[#nodes + 1], rows[#rows + 1], chosen[#chosen + 1] = node, screened.rows[i], i
    end
  end
  return nodes, rows, chosen
end

local function median(list)
  table.sort(list)
  return list[(#list + 1) // 2]
end

local function explore(self, rounds, min)
  local screened, message, details = self.screened, nil, nil
  if not screened then screened, message, details = screen(self) end
  if not screened then return nil, message, details end
  local ratio = FIRST_RATIO
  for _ = 1, rounds do
    local nodes, rows, chosen = choose(self, screened, ratio, min)
    if #nodes == 0 then break end
    local first = self.loads and self.loads.peaks.row_count or 0
    local ok
    ok, message, details = add(self, nodes, rows)
    if not ok then return nil, message, details end
    local ratios = {}
    for k, i in ipairs(chosen) do ratios[k] = self.own[first + k] / screened.values[i] end
    ratio = math.max(1, median(ratios))
  end
  return true
end

-- Loads for places that are known from another mesh, where a node of this one may lie within a support.
local function add_known(self, known)
  local at, rows = {}, {}
  for k, place in ipairs(known) do at[k], rows[k] = place.at, place.stress:totable()[1] end
  local nodes, message, details = core.nearest_patch_nodes(self.system, core.array.new(at))
  if not nodes then return nil, message, details end
  return add(self, nodes:totable(), rows)
end

-- Places near the largest mean that have not ascended, no two of them in one patch.
local function starts(self)
  local min = CLOSE * self.places[1].utilisation
  return append_apart({}, self.places, ASCENTS, self.radius, function(place)
    return not place.tried and place.utilisation >= min
  end)
end

-- Each step reaches at least the mean that it starts from, but for curved elements. Places where a step gains less
-- than GAIN do not ascend again.
local function ascend(self)
  for _ = 1, STEPS do
    local chosen, nodes, rows = starts(self), {}, {}
    if #chosen == 0 then break end
    for k, place in ipairs(chosen) do
      place.tried, nodes[k], rows[k] = true, place.node, place.stress:totable()[1]
    end
    local first = self.loads.peaks.row_count
    local ok, message, details = add(self, nodes, rows)
    if not ok then return nil, message, details end
    for _, place in ipairs(self.places) do
      local from = chosen[place.region - first]
      place.tried = place.tried or from and place.utilisation < (1 + GAIN) * from.utilisation
    end
  end
  return true
end

-- Places of the loads that stress elements most, no two with their peaks in one patch.
local function begin(self)
  local peaks, elements, chosen, ends = self.loads.peaks, self.loads.peak_elements, {}, {}
  local order = peaks:order()
  for k = order.row_count, 1, -1 do
    local at = node_at(self.mesh, self.mesh.elements(elements[order[k]], 1))
    local apart = #chosen < BEGUN and peaks[order[k]] > 0
    for _, other in ipairs(ends) do apart = apart and distance(at, other) > self.radius end
    if apart then chosen[#chosen + 1], ends[#ends + 1] = order[k], at end
  end
  if #chosen == 0 then return true end
  return rate(self, chosen)
end

--- Searches. `problem`: mesh, material, system, basis, screening_basis, limits (of linear programs), radius (m),
--- reports (to which those of the linear programs are added), measure (from rows of tensors to an array),
--- screening (whether to look for other places), and what it begins with: loads (results of core.worst_loads) or
--- known (places of another mesh). Returns {places, loads, origins}, places weakest first, or nil, message,
--- details. `extend` continues it.
function patch_search.run(problem)
  local self = setmetatable({places = {}, origins = {}, own = {}}, {__index = problem})
  local ok, message, details
  if problem.known then
    ok, message, details = add_known(self, problem.known)
  else
    ok, message, details = begin(self)
  end
  if ok and self.screening then
    ok, message, details = explore(self, problem.known and ROUNDS_OF_KNOWN or ROUNDS)
  end
  if ok then ok, message, details = ascend(self) end
  if not ok then return nil, message, details end
  return self
end

--- Continues a search with linear programs for all patches that may reach a utilisation, not the largest only.
--- Returns it, or nil, message, details.
function patch_search.extend(self, utilisation)
  local ok, message, details = explore(self, ROUNDS_OF_ALL, utilisation)
  if not ok then return nil, message, details end
  return self
end

return patch_search
