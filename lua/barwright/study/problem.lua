-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a study asks: variables, measures, objectives and constraints, checked; points made of places in
-- the unit cube; which results are feasible and which of two are better.
local core = require "barwright.core"
local correlations = require "barwright.study.correlations"
local normal = require "barwright.study.normal"
local options = require "barwright.options"
local variables = require "barwright.study.variables"

local raise = core.raise

local problem = {}
problem.__index = problem
problem.__name = "problem"

local measure_rules = {
  name = {type = "string", needed = true},
  unit = {type = "string"},
  what = {type = "string"},
  optional = {type = "boolean", default = false}, -- may be absent from a trial's results
}
local objective_rules = {
  name = {type = "string", needed = true},
  goal = {type = "string", one_of = {"min", "max"}, default = "min"},
}
local constraint_rules = {
  name = {type = "string", needed = true},
  min = {type = "number"},
  max = {type = "number"},
}

local function read_list(where, what, list, rules)
  if type(list) ~= "table" then raise(("%s: %ss = {...} expected, got %s"):format(where, what, core.got(list))) end
  local out, named = {}, {}
  for i, given in ipairs(list) do
    if type(given) == "string" then given = {name = given} end
    local item = options.read(("%s: %s %d"):format(where, what, i), given, rules)
    out[i] = item
    named[item.name] = item
  end
  for key in pairs(list) do
    if math.type(key) ~= "integer" then
      raise(("%s: %ss: a list {{name = ...}, ...} expected, got the key %s"):format(where, what, core.got(key)))
    end
  end
  return out, named
end

local function names_of(list)
  local names = {}
  for i, item in ipairs(list) do names[i] = item.name end
  return names
end

local function known_measure(self, where, what, name)
  if self.measure[name] then return end
  raise(("%s: %s '%s' is no measure: %s"):format(where, what, name,
    core.suggestion(name, names_of(self.measures))))
end

--- From the options of bw.study.
function problem.read(where, given)
  local self = setmetatable({}, problem)
  self.variables = variables.read(where, given.variables)
  self.variable = {}
  for _, v in ipairs(self.variables) do self.variable[v.name] = v end
  self.correlations = correlations.read(where, given.correlations or {}, self.variables)
  self.sorted = names_of(self.variables)
  table.sort(self.sorted)
  self.measures, self.measure = read_list(where, "measure", given.measures, measure_rules)
  if #self.measures == 0 then raise(where .. ": measures = {{name = ...}, ...} expected, got none") end
  local seen = {}
  for _, item in ipairs(self.measures) do
    if seen[item.name] then raise(("%s: measure '%s' occurs twice"):format(where, item.name)) end
    seen[item.name] = true
    if self.variable[item.name] then
      raise(("%s: measure '%s' has the name of a variable"):format(where, item.name))
    end
  end
  self.objectives = read_list(where, "objective", given.objectives or {}, objective_rules)
  self.constraints = read_list(where, "constraint", given.constraints or {}, constraint_rules)
  for _, item in ipairs(self.objectives) do known_measure(self, where, "objective", item.name) end
  for _, item in ipairs(self.constraints) do
    known_measure(self, where, "constraint", item.name)
    if not item.min and not item.max then
      raise(("%s: constraint '%s': min or max expected, got neither"):format(where, item.name))
    end
  end
  return self
end

--- A point from independent coordinates of the standard normal distribution, one for each variable in order.
function problem:normal_point(y)
  local z, point = self.correlations and self.correlations:correlated(y) or y, {}
  for k, v in ipairs(self.variables) do point[v.name] = v:normal_value(z[k]) end
  return point
end

--- The normal coordinates of a point.
function problem:normal_place(point)
  local z = {}
  for k, v in ipairs(self.variables) do z[k] = v:normal_place(point[v.name]) end
  return self.correlations and self.correlations:independent(z) or z
end

-- What a function of each coordinate gives.
local function each(list, f)
  local out = {}
  for k = 1, #list do out[k] = f(list[k]) end
  return out
end

--- A point from places in the unit cube, one for each variable in order; places of independent coordinates where
--- variables are correlated.
function problem:point(place)
  if self.correlations then
    return self:normal_point(each(place, function(u)
      return math.max(-variables.reach, math.min(variables.reach, normal.quantile(u)))
    end))
  end
  local point = {}
  for k, v in ipairs(self.variables) do point[v.name] = v:value(place[k]) end
  return point
end

--- The places of a point.
function problem:place(point)
  if self.correlations then return each(self:normal_place(point), normal.probability) end
  local place = {}
  for k, v in ipairs(self.variables) do place[k] = v:place(point[v.name]) end
  return place
end

--- A copy of the point with checked values; missing ones are the variables' defaults where these have one.
function problem:check(point, where)
  if type(point) ~= "table" then
    raise(("%s: a point {name = value, ...} expected, got %s"):format(where, core.got(point)))
  end
  local out = {}
  for name in pairs(point) do
    if not self.variable[name] then
      raise(("%s: '%s' is no variable: %s"):format(where, tostring(name),
        core.suggestion(tostring(name), self.sorted)))
    end
  end
  for _, v in ipairs(self.variables) do
    local value = point[v.name]
    if value == nil then value = v.default end
    if value == nil then raise(("%s: '%s' is missing"):format(where, v.name)) end
    out[v.name] = v:check(value, ("%s: '%s'"):format(where, v.name))
  end
  return out
end

--- Where a study begins: defaults, else midpoints.
function problem:initial()
  local point = {}
  for _, v in ipairs(self.variables) do point[v.name] = v:initial() end
  return point
end

-- ---- results ---------------------------------------------------------------------------------------

--- By how much results miss the constraints: 0 where they hold, parts of the bound summed else; infinite
--- where there are no results.
function problem:violation(results)
  if not results then return math.huge end
  local sum = 0.0
  for _, c in ipairs(self.constraints) do
    local value = results[c.name]
    if value == nil then return math.huge end
    if c.max and value > c.max then sum = sum + (value - c.max) / (c.max ~= 0 and math.abs(c.max) or 1) end
    if c.min and value < c.min then
      sum = sum + (c.min - value) / (c.min ~= 0 and math.abs(c.min) or 1)
    end
  end
  return sum
end

--- The bounds of the constraints one by one: sign (value - bound) is positive where a value misses one, in parts
--- of the bound.
function problem:limits()
  local limits = {}
  for _, c in ipairs(self.constraints) do
    for _, side in ipairs {"max", "min"} do
      local bound = c[side]
      if bound then
        local sign = (side == "max" and 1 or -1) / (bound ~= 0 and math.abs(bound) or 1)
        limits[#limits + 1] = {name = c.name, side = side, sign = sign, bound = bound}
      end
    end
  end
  return limits
end

--- Every objective as a number that is to be small; nil where one is missing.
function problem:costs(results)
  if not results then return nil end
  local costs = {}
  for k, objective in ipairs(self.objectives) do
    local value = results[objective.name]
    if value == nil then return nil end
    costs[k] = objective.goal == "max" and -value or value
  end
  return costs
end

--- Whether trial a is done, keeps the constraints, and has the objectives.
function problem:feasible(trial)
  return trial.status == "done" and self:violation(trial.results) == 0 and self:costs(trial.results) ~= nil
end

--- "mass in kg to be small"
function problem:goal_text(objective)
  local measure = self.measure[objective.name]
  return ("%s%s"):format(objective.goal == "max" and "maximum " or "minimum ", variables.title(measure))
end

return problem
