-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Minimisation by NLopt, from one or several starts at once, with gradients that trials return or that
-- differences give.
--
-- NLopt asks for one value after the other from within; several starts are to be one batch of trials. Both
-- fit by replay: a minimiser runs on what is known until it asks for a point that is not, and is given up
-- there; the points of all starts (and the neighbours that differences need) are one batch; then all begin
-- again. A minimiser is deterministic, so it comes by where it was, in microseconds a point. A single start
-- is not given up: its trials are run from within.
local core = require "barwright.core"
local numbers = require "barwright.plot.numbers"
local random = require "barwright.study.random"
local sampling = require "barwright.study.sampling"

local raise = core.raise

local minimise = {}

-- What the methods need and understand.
local methods = {
  cobyla = {constraints = true}, bobyqa = {}, neldermead = {}, sbplx = {},
  direct_l = {global = true}, crs2 = {global = true}, isres = {global = true, constraints = true},
  mma = {gradient = true, constraints = true}, slsqp = {gradient = true, constraints = true},
  lbfgs = {gradient = true},
}
local names = {}
for name in pairs(methods) do names[#names + 1] = name end
table.sort(names)

minimise.minimise = {
  summary = "NLopt's minimisers, from one or several starts",
  rules = {
    method = {type = "string", one_of = names},
    starts = {type = "integer", default = 1, min = 1, max = 10000},
    start = {type = "table"}, -- the point of the first; the others are spread evenly
    evaluations = {type = "integer", default = 200, min = 1}, -- of the objective, for each start
    tolerance = {type = "number", default = 1e-6, min = 0}, -- relative, of objective and variables
    gradient = {type = "string", one_of = {"run", "differences"}, default = "differences"},
    step = {type = "number", default = 1e-4, above = 0, max = 0.1}, -- of differences, parts of the range
    seed = {type = "integer"},
  },
}
local design = minimise.minimise

-- The method in use: the one named, or one that the problem allows.
local function method_of(problem, opts)
  return opts.method or (#problem.constraints > 0 and "cobyla" or #problem.variables == 1 and "cobyla" or "bobyqa")
end

function design.check(problem, opts)
  local name = method_of(problem, opts)
  local kind = methods[name]
  if #problem.objectives ~= 1 then
    raise(("design minimise: one objective expected, the study has %d%s"):format(#problem.objectives,
      #problem.objectives > 1 and ": use the design pareto" or ""))
  end
  if #problem.constraints > 0 and not kind.constraints then
    raise(("design minimise: method '%s' takes no constraints: use cobyla, isres, mma or slsqp"):format(name))
  end
  for _, v in ipairs(problem.variables) do
    if v.kind ~= "real" and not kind.global then
      raise(("design minimise: '%s' is %s %s, method '%s' needs reals: use direct_l, crs2 or isres, or the "
        .. "design pareto"):format(v.name, v.kind == "integer" and "an" or "a", v.kind, name))
    end
  end
  if name == "bobyqa" and #problem.variables < 2 then
    raise "design minimise: bobyqa needs two variables or more: use cobyla"
  end
  if opts.start then problem:check(opts.start, "design minimise: start") end
end

function design.total(problem, opts)
  local each = methods[method_of(problem, opts)].gradient and opts.gradient == "differences"
    and #problem.variables + 1 or 1
  return opts.evaluations * opts.starts * each
end

-- ---- one start -----------------------------------------------------------------------------------------

local attempt = {}
attempt.__index = attempt

local function name_of(place)
  local words = {}
  for k = 1, #place do words[k] = ("%.17g"):format(place[k]) end
  return table.concat(words, " ")
end

-- What stands for a trial that failed: worse than all that was seen, and outside of every constraint.
local function failed_value(self)
  local worst = self.worst or 0
  return worst + 1e3 * (1 + math.abs(worst))
end

local function copy(place) return table.move(place, 1, #place, 1, {}) end

-- Places beside one, for differences: ahead, or back where there is no room.
local function neighbours(self, place)
  local list, step = {}, self.search.opts.step
  for k = 1, #place do
    local other = copy(place)
    other[k] = place[k] + step <= 1 and place[k] + step or place[k] - step
    list[k] = other
  end
  return list
end

-- Gradient of a measure by the places in the unit cube.
local function gradient_of(self, measure, place, known)
  local search, out = self.search, {}
  if search.opts.gradient == "run" then
    local given = known.gradients and known.gradients[measure]
    if not given then
      error(("design minimise: run gave no gradient of '%s': return results, gradients, or give gradient = "
        .. "\"differences\""):format(measure), 0)
    end
    for k, v in ipairs(search.problem.variables) do out[k] = given[v.name] * v:slope(v:value(place[k])) end
    return out
  end
  for k, other in ipairs(neighbours(self, place)) do
    local there = search.known[name_of(other)]
    local a, b = known.results[measure], there and there.results and there.results[measure]
    out[k] = b and (b - a) / (other[k] - place[k]) or 0.0
  end
  return out
end

-- Runs one batch: the places that the attempts need, and what differences want around them.
local function find_out(search, attempts)
  local places, points, seen = {}, {}, {}
  local function want(place)
    local name = name_of(place)
    if seen[name] or search.known[name] then return end
    seen[name] = true
    places[#places + 1] = name
    points[#points + 1] = search.problem:point(place)
  end
  for _, each in ipairs(attempts) do
    want(each.need)
    if each.differences then
      for _, other in ipairs(neighbours(each, each.need)) do want(other) end
    end
  end
  local results, trials = search.evaluate(points)
  for i, name in ipairs(places) do
    search.known[name] = {results = results[i] or nil, gradients = trials[i].gradients}
  end
  for _, each in ipairs(attempts) do
    if each.differences then search.known[name_of(each.need)].around = true end
  end
end

-- What is known of a place; where it is not, the place is noted and the minimiser given up.
local GIVE_UP = setmetatable({}, {__tostring = function() return "a point is not known yet" end})
local function look_up(self, x)
  local place = {}
  for k = 1, self.search.dimensions do place[k] = math.min(1, math.max(0, x[k])) end
  local name = name_of(place)
  local known = self.search.known[name]
  if known and (not self.differences or known.around or not known.results) then return known, place end
  self.need = place
  if self.search.starts > 1 then error(GIVE_UP, 0) end
  find_out(self.search, {self})
  self.need = nil
  return self.search.known[name], place
end

local function objective_function(self)
  local objective = self.search.problem.objectives[1]
  local sign = objective.goal == "max" and -1 or 1
  return function(x)
    local known, place = look_up(self, x)
    local value = known.results and known.results[objective.name]
    if not value then
      local zeros = {}
      for k = 1, #place do zeros[k] = 0.0 end
      return failed_value(self), self.gradient and zeros or nil
    end
    self.size = self.size or value ~= 0 and math.abs(value) or 1 -- methods like numbers near 1
    value = sign * value / self.size
    self.worst = math.max(self.worst or value, value)
    if not self.gradient then return value end
    local gradient = gradient_of(self, objective.name, place, known)
    for k = 1, #gradient do gradient[k] = sign * gradient[k] / self.size end
    return value, gradient
  end
end

local function constraint_function(self, side)
  return function(x)
    local known, place = look_up(self, x)
    local value = known.results and known.results[side.name]
    local gradient = {}
    if not value then
      for k = 1, #place do gradient[k] = 0.0 end
      return 1.0, self.gradient and gradient or nil
    end
    local miss = side.sign * (value - side.bound)
    if not self.gradient then return miss end
    gradient = gradient_of(self, side.name, place, known)
    for k = 1, #gradient do gradient[k] = side.sign * gradient[k] end
    return miss, gradient
  end
end

-- From the beginning as far as what is known goes. self.need is the place that is missing, or self.outcome.
local function replay(self)
  local search = self.search
  self.need, self.worst, self.size = nil, nil, nil
  local low, high, constraints = {}, {}, {}
  for k = 1, search.dimensions do low[k], high[k] = 0.0, 1.0 end
  for i, side in ipairs(search.limits) do constraints[i] = constraint_function(self, side) end
  local ok, x, value, about = pcall(core.minimise, {method = search.method, start = copy(self.start),
    min = low, max = high, evaluations = search.opts.evaluations, seed = search.opts.seed,
    objective = objective_function(self), constraints = #constraints > 0 and constraints or nil,
    value_tolerance = search.opts.tolerance, tolerance = search.opts.tolerance})
  if not ok and x ~= GIVE_UP then error(x, 0) end
  if not ok then return end
  if x == nil then
    self.outcome = {why = value, failed = true}
    return
  end
  local place = {}
  for k = 1, search.dimensions do place[k] = x[k] end
  local sign = search.problem.objectives[1].goal == "max" and -1 or 1
  self.outcome = {place = place, value = sign * value * (self.size or 1), why = about.why,
    evaluations = about.evaluations, converged = about.converged}
end

-- ---- all starts ----------------------------------------------------------------------------------------

local function starts_of(search)
  local opts, problem = search.opts, search.problem
  local first = problem:place(opts.start and problem:check(opts.start, "design minimise: start")
    or problem:initial())
  local list = {first}
  if opts.starts > 1 then
    local places = sampling.latin(opts.starts - 1, search.dimensions, random.new(opts.seed), true)
    for i, place in ipairs(places) do list[i + 1] = place end
  end
  return list
end

local function summary_of(search, attempts)
  local out, lines = {starts = {}, method = search.method}, {}
  local measure = search.problem.measure[search.problem.objectives[1].name]
  for i, each in ipairs(attempts) do
    local outcome = each.outcome
    out.starts[i] = {why = outcome.why, evaluations = outcome.evaluations, value = outcome.value,
      point = outcome.place and search.problem:point(outcome.place), converged = outcome.converged,
      start = search.problem:point(each.start)}
    local value = outcome.value
    lines[i] = ("start %d: %s%s, ended by %s"):format(i,
      value and numbers.quantity(value, measure.unit) or "no result",
      outcome.evaluations and (" after %d evaluations"):format(outcome.evaluations) or "", tostring(outcome.why))
  end
  out.text = ("%s by %s\n%s"):format(measure.name, search.method, table.concat(lines, "\n"))
  return out
end

--- starts = {{start, point, value, why, evaluations}, ...}: where each ended and why. The best trial is
--- trials:best(), as everywhere.
function design.run(evaluate, problem, opts)
  local name = method_of(problem, opts)
  local gradient = methods[name].gradient
  local search = {evaluate = evaluate, problem = problem, opts = opts, method = name, known = {},
    dimensions = #problem.variables, limits = problem:limits(), starts = opts.starts}
  local attempts = {}
  for i, start in ipairs(starts_of(search)) do
    attempts[i] = setmetatable({search = search, start = start, gradient = gradient,
      differences = gradient and opts.gradient == "differences"}, attempt)
  end
  while true do
    local open = {}
    for _, each in ipairs(attempts) do
      if not each.outcome then
        replay(each)
        if not each.outcome then open[#open + 1] = each end
      end
    end
    if #open == 0 then return summary_of(search, attempts) end
    find_out(search, open)
  end
end

return minimise
