-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A measure between the trials: a Gaussian process through them, in the places of the unit cube.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local numbers = require "barwright.plot.numbers"
local process = require "barwright.study.gaussian_process"

local surrogate = {}

local MAX_TRIALS = 1000 -- the work grows with their cube

local methods = {}
local meta = {__name = "surrogate", __index = methods}
surrogate.class = methods

--- Of the trials that have the measure; or nil, message, details.
function surrogate.of(trials, name)
  local problem = trials.problem
  local measure = problem.measure[name]
  if not measure then
    local names = {}
    for i, item in ipairs(problem.measures) do names[i] = item.name end
    core.raise(("trials:surrogate: '%s' is no measure: %s"):format(name, core.suggestion(name, names)))
  end
  local places, values = {}, {}
  for _, trial in ipairs(trials) do
    local value = trial.results and trial.results[name]
    if value then places[#places + 1], values[#values + 1] = problem:place(trial.point), value end
  end
  if #values < 3 or #values > MAX_TRIALS then
    return nil, ("3 to %d trials with '%s' expected, got %d"):format(MAX_TRIALS, name, #values),
      {status = #values < 3 and "empty" or "limit"}
  end
  local made = process.fit(places, values)
  if not made then
    return nil, ("no Gaussian process goes through the trials of '%s'"):format(name), {status = "convergence"}
  end
  local self = setmetatable({measure = name, unit = measure.unit, count = #values, process = made,
    problem = problem, lengths = {}}, meta)
  for k, v in ipairs(problem.variables) do self.lengths[v.name] = made.lengths[k] end
  local sum, left_out = 0.0, made:left_out(values)
  for i, value in ipairs(values) do sum = sum + (value - left_out[i]) ^ 2 end
  self.error = math.sqrt(sum / #values)
  return self
end

--- The value at a point, and its standard deviation.
function methods:predict(point)
  return self.process:predict(self.problem:place(self.problem:check(point, "surrogate:predict")))
end

arguments.methods("surrogate", methods, meta, {predict = "point: table"})

function meta.__tostring(self)
  return ("%s between %d trials: misses trials that it does not know by %s (root mean square)")
    :format(self.measure, self.count, numbers.quantity(self.error, self.unit))
end

return surrogate
