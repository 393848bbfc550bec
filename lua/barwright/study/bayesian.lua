-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Minimisation of an objective whose trials are expensive: each next trial is the one that is expected to improve
-- most on the best so far, by a Gaussian process through all trials (Jones, Schonlau and Welch, Journal of Global
-- Optimization 13, 1998). With constraints, the improvement counts by the probability that they are kept
-- (Schonlau, Welch and Jones, 1998).
local core = require "barwright.core"
local normal = require "barwright.study.normal"
local numbers = require "barwright.plot.numbers"
local process = require "barwright.study.gaussian_process"
local random = require "barwright.study.random"
local sampling = require "barwright.study.sampling"

local bayesian = {}

local MAX_TRIALS = 500 -- the work for a trial grows with their cube

bayesian.bayesian = {
  summary = "few expensive trials, each where the most improvement is expected",
  rules = {
    count = {type = "integer", needed = true, min = 3, max = MAX_TRIALS},
    initial = {type = "integer", min = 2, max = MAX_TRIALS}, -- trials of a Latin hypercube first
    batch = {type = "integer", default = 1, min = 1, max = 100}, -- trials at a time
    tolerance = {type = "number", default = 1e-5, min = 0}, -- expected improvement over the range, to end at
    seed = {type = "integer"},
  },
}
local design = bayesian.bayesian

function design.check(problem)
  if #problem.objectives ~= 1 then
    core.raise(("design bayesian: one objective expected, the study has %d%s"):format(#problem.objectives,
      #problem.objectives > 1 and ": use the design pareto" or ""))
  end
end

function design.total(_, opts) return opts.count end

-- The place of the point that a place leads to: integers and choices have places of their own.
local function snapped(problem, place) return problem:place(problem:point(place)) end

local function name_of(place)
  local words = {}
  for k = 1, #place do words[k] = ("%.17g"):format(place[k]) end
  return table.concat(words, " ")
end

-- ---- what is known -----------------------------------------------------------------------------------

-- Values of one measure at all places; a failed trial has the worst value that is known.
local function values_of(search, of)
  local values, worst = {}, -math.huge
  for i, results in ipairs(search.results) do
    values[i] = results and of(results)
    worst = math.max(worst, values[i] or -math.huge)
  end
  for i = 1, #search.results do values[i] = values[i] or worst end
  return values
end

local function range_of(values)
  local min, max = math.huge, -math.huge
  for _, value in ipairs(values) do min, max = math.min(min, value), math.max(max, value) end
  return min, max
end

-- Processes of the objective and of each limit (positive where it is missed), fitted again when the trials have
-- grown by a tenth.
local function fit(search)
  local n = #search.places
  local again = not search.fitted or n >= 1.1 * search.fitted
  local function of(name, values)
    local former = search.processes[name]
    local made = not again and former and process.new(search.places, values, former.lengths, former.noise)
    search.processes[name] = made or process.fit(search.places, values, former)
    return search.processes[name]
  end
  search.values = values_of(search, function(results) return (search.problem:costs(results) or {})[1] end)
  search.objective = of("objective", search.values)
  search.limits = {}
  for i, limit in ipairs(search.problem:limits()) do
    search.limits[i] = of(i, values_of(search, function(results)
      return results[limit.name] and limit.sign * (results[limit.name] - limit.bound)
    end))
  end
  if again then search.fitted = n end
end

-- ---- where to look -----------------------------------------------------------------------------------

local function improvement_at(search, place)
  local likely = 1.0
  for _, limit in ipairs(search.limits) do
    local value, deviation = limit:predict(place)
    likely = likely * (deviation > 0 and normal.probability(-value / deviation) or value <= 0 and 1 or 0)
  end
  if not search.best then return likely end
  local value, deviation = search.objective:predict(place)
  local gain = search.best - value
  if deviation <= 0 then return math.max(0, gain) * likely end
  local z = gain / deviation
  return (gain * normal.probability(z) + deviation * normal.density(z)) * likely
end

local CANDIDATES, NEAR, REFINED = 200, 50, 3 -- for each variable

-- Places spread over the cube, and some near the best one.
local function candidates(search)
  local d, source, list = search.dimensions, search.source, {}
  for i = 1, CANDIDATES * d do
    local place = {}
    for k = 1, d do place[k] = source:uniform() end
    list[i] = place
  end
  for i = 1, search.best_place and NEAR * d or 0 do
    local place, spread = {}, 10 ^ (-1 - 3 * i / (NEAR * d))
    for k = 1, d do
      place[k] = math.min(1, math.max(0, search.best_place[k] + spread * source:normal()))
    end
    list[#list + 1] = place
  end
  return list
end

-- The place where most improvement is expected, among those that were not tried, and how much.
local function next_place(search)
  local list = {}
  for i, place in ipairs(candidates(search)) do
    place = snapped(search.problem, place)
    if not search.tried[name_of(place)] then
      list[#list + 1] = {place = place, gain = improvement_at(search, place), number = i}
    end
  end
  if #list == 0 then return nil, 0.0 end
  table.sort(list, function(a, b)
    if a.gain ~= b.gain then return a.gain > b.gain end
    return a.number < b.number
  end)
  local best = list[1]
  for i = 1, search.continuous and math.min(REFINED, #list) or 0 do
    local low, high = {}, {}
    for k = 1, search.dimensions do low[k], high[k] = 0.0, 1.0 end
    local scale = math.max(best.gain, 1e-300)
    local x = core.minimise {method = "cobyla", start = list[i].place, min = low, max = high, tolerance = 1e-5,
      evaluations = 40 * search.dimensions, objective = function(x)
        local place = {}
        for k = 1, search.dimensions do place[k] = math.min(1, math.max(0, x[k])) end
        return -improvement_at(search, place) / scale
      end}
    if x then
      local place = {}
      for k = 1, search.dimensions do place[k] = math.min(1, math.max(0, x[k])) end
      place = snapped(search.problem, place)
      local gain = improvement_at(search, place)
      if gain > best.gain and not search.tried[name_of(place)] then best = {place = place, gain = gain} end
    end
  end
  return best.place, best.gain
end

-- ---- the search --------------------------------------------------------------------------------------

local function run_trials(search, places)
  local points = {}
  for i, place in ipairs(places) do points[i] = search.problem:point(place) end
  local results = search.evaluate(points)
  for i, place in ipairs(places) do
    search.places[#search.places + 1] = place
    search.results[#search.results + 1] = results[i] or false
    search.tried[name_of(place)] = true
    local costs = search.problem:costs(results[i] or nil)
    if costs and search.problem:violation(results[i]) == 0 and (not search.best or costs[1] < search.best) then
      search.best, search.best_place = costs[1], place
    end
  end
end

-- Several places at a time: the value expected at one is taken as known for the next.
local function next_places(search, count)
  local places, gains = {}, {}
  local kept = {places = search.places, values = search.values, objective = search.objective}
  for i = 1, count do
    local place, gain = next_place(search)
    if not place then break end
    places[i], gains[i] = place, gain
    search.tried[name_of(place)] = true
    if i == count then break end
    search.places = table.move(search.places, 1, #search.places, 1, {})
    search.values = table.move(search.values, 1, #search.values, 1, {})
    search.places[#search.places + 1] = place
    search.values[#search.values + 1] = (search.objective:predict(place))
    local made = process.new(search.places, search.values, search.objective.lengths, search.objective.noise)
    if not made then break end
    search.objective = made
  end
  search.places, search.values, search.objective = kept.places, kept.values, kept.objective
  return places, gains[1] or 0.0
end

-- By how much the process misses trials that it does not know, over the range of the values.
local function error_of(search)
  local min, max = range_of(search.values)
  if max <= min then return 0.0 end
  local sum, left_out = 0.0, search.objective:left_out(search.values)
  for i, value in ipairs(search.values) do sum = sum + (value - left_out[i]) ^ 2 end
  return math.sqrt(sum / #search.values) / (max - min)
end

--- why: "tolerance", "count" or "exhausted" (all points were tried); expected: the improvement that one more trial
--- promises; error: root mean square of what the process misses by at trials that are left out, over the range.
function design.run(evaluate, problem, opts)
  local d = #problem.variables
  local search = {evaluate = evaluate, problem = problem, dimensions = d, places = {}, results = {}, tried = {},
    processes = {}, source = random.new(opts.seed), continuous = true}
  for _, v in ipairs(problem.variables) do search.continuous = search.continuous and v.kind == "real" end
  local initial, first = math.min(opts.count, opts.initial or 3 * d + 2), {}
  for _, place in ipairs(sampling.spread(sampling.latin(initial, d, search.source, true), search.source)) do
    place = snapped(problem, place)
    if not search.tried[name_of(place)] then first[#first + 1] = place end
    search.tried[name_of(place)] = true
  end
  run_trials(search, first)
  local measure = problem.measure[problem.objectives[1].name]
  local out = {why = "count"}
  while #search.places < opts.count do
    local some = false
    for _, results in ipairs(search.results) do some = some or results and problem:costs(results) ~= nil end
    if not some then
      out.text = "no trial has a result: nothing to learn from"
      return out
    end
    fit(search)
    local min, max = range_of(search.values)
    local places, gain = next_places(search, math.min(opts.batch, opts.count - #search.places))
    out.expected, out.error = search.best and gain or nil, error_of(search)
    if #places == 0 then out.why = "exhausted" break end
    if search.best and gain <= opts.tolerance * (max - min) then out.why = "tolerance" break end
    run_trials(search, places)
  end
  out.count = #search.places
  out.text = ("%s after %d trials, ended by %s%s%s"):format(measure.name, out.count, out.why,
    out.expected and "; one more trial is expected to gain " .. numbers.quantity(out.expected, measure.unit) or "",
    out.error and ("; the process misses unknown trials by %.2g of the range"):format(out.error) or "")
  return out
end

return bayesian
