-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Designs of levels: all combinations, one variable at a time, a list of one's own.
local core = require "barwright.core"
local numbers = require "barwright.plot.numbers"
local options = require "barwright.options"

local raise = core.raise

local grid = {}

local MAX_POINTS = 10000000

-- Values of one variable, evenly from end to end; integers and choices: all, unless fewer are wanted.
local function spread(variable, count, where)
  local all = variable:count()
  if all and (not count or count >= all) then count = all end
  if not count then
    raise(("%s: option 'levels': the number of levels of '%s' is missing"):format(where, variable.name))
  end
  if all and all > MAX_POINTS then
    raise(("%s: option 'levels' is missing: '%s' has %d values"):format(where, variable.name, all))
  end
  local values = {}
  for i = 1, count do
    if all then -- the midpoints of equal intervals, so that the ends are met
      local k = count == 1 and (all - 1) // 2 or (i - 1) * (all - 1) // (count - 1)
      values[i] = variable:value((k + 0.5) / all)
    else
      values[i] = variable:value(count == 1 and 0.5 or (i - 1) / (count - 1))
    end
  end
  return values
end

local function levels_of(variable, opts, where)
  if type(opts) == "table" then
    if #opts == 0 then
      raise(("%s: levels of '%s': one value or more expected, got an empty list"):format(where, variable.name))
    end
    local values = {}
    for i, value in ipairs(opts) do
      values[i] = variable:check(value, ("%s: levels of '%s'"):format(where, variable.name))
    end
    return values
  end
  if opts ~= nil and (math.type(opts) ~= "integer" or opts < 1) then
    raise(("%s: levels of '%s': a whole number from 1 or a list expected, got %s"):format(where,
      variable.name, core.got(opts)))
  end
  return spread(variable, opts, where)
end

--- The values of every variable. levels: a number for all reals (and at most so many of the others), or
--- by name numbers or lists of values.
function grid.levels(problem, opts, where)
  local by_name = type(opts) == "table" and opts or {}
  for name in pairs(by_name) do
    if not problem.variable[name] then
      raise(("%s: levels: '%s' is no variable: %s"):format(where, tostring(name),
        core.suggestion(tostring(name), problem.sorted)))
    end
  end
  local out = {}
  for k, v in ipairs(problem.variables) do
    local own = by_name[v.name]
    if own == nil and type(opts) ~= "table" and v.kind == "real" then own = opts end
    out[k] = levels_of(v, own, where)
  end
  return out
end

-- ---- all combinations --------------------------------------------------------------------------------

grid.grid = {
  summary = "all combinations of levels",
  rules = {levels = {type = "any"}},
}
--- The last variable changes fastest.
function grid.grid.points(problem, opts)
  local where = "design grid"
  local levels = grid.levels(problem, opts.levels, where)
  local count = 1
  for _, values in ipairs(levels) do
    count = count * #values
    if count > MAX_POINTS then
      raise(("%s: at most %d points expected: take fewer levels or another design"):format(where, MAX_POINTS))
    end
  end
  local points = {}
  for n = 0, count - 1 do
    local point, rest = {}, n
    for k = #levels, 1, -1 do
      local values = levels[k]
      point[problem.variables[k].name] = values[rest % #values + 1]
      rest = rest // #values
    end
    points[n + 1] = point
  end
  return points
end

-- ---- a list of one's own -----------------------------------------------------------------------------

grid.points = {
  summary = "a list of points",
  rules = {points = {type = "table", needed = true}},
  scatter = true,
}
function grid.points.points(problem, opts)
  local points = {}
  for i, point in ipairs(opts.points) do
    points[i] = problem:check(point, ("design points: point %d"):format(i))
  end
  return points
end

-- ---- one at a time -----------------------------------------------------------------------------------

grid.one_at_a_time = {
  summary = "each variable over its levels while the others stay",
  rules = {levels = {type = "any", default = 5}, at = {type = "table"}},
}

-- The base first; then for each variable its levels, without the base's own.
local function star(problem, opts)
  local where = "design one_at_a_time"
  local base = problem:initial()
  for name, value in pairs(options.read(where .. ": at", opts.at, (function()
    local rules = {}
    for _, v in ipairs(problem.variables) do rules[v.name] = {type = "any"} end
    return rules
  end)())) do
    base[name] = problem.variable[name]:check(value, ("%s: at: '%s'"):format(where, name))
  end
  return base, grid.levels(problem, opts.levels, where)
end

function grid.one_at_a_time.points(problem, opts)
  local base, levels = star(problem, opts)
  local points = {base}
  for k, v in ipairs(problem.variables) do
    for _, value in ipairs(levels[k]) do
      if value ~= base[v.name] then
        local point = {}
        for name, other in pairs(base) do point[name] = other end
        point[v.name] = value
        points[#points + 1] = point
      end
    end
  end
  return points
end

--- effects[measure] = {{name, min, max, range, values = {...}, results = {...}}, ...}: what each
--- variable does alone, in the order of the variables.
function grid.one_at_a_time.summarise(problem, _, points, results)
  local base = points[1]
  local effects = {}
  for _, measure in ipairs(problem.measures) do
    local list = {}
    for k, v in ipairs(problem.variables) do
      local rows = {}
      for i, point in ipairs(points) do
        local own = i == 1
        if not own and point[v.name] ~= base[v.name] then own = true end
        local value = own and results[i] and results[i][measure.name]
        if value then rows[#rows + 1] = {place = v:place(point[v.name]), value = point[v.name], result = value} end
      end
      table.sort(rows, function(a, b) return a.place < b.place end)
      local item = {name = v.name, values = {}, results = {}}
      for i, row in ipairs(rows) do
        item.values[i], item.results[i] = row.value, row.result
        item.min = math.min(item.min or row.result, row.result)
        item.max = math.max(item.max or row.result, row.result)
      end
      item.range = item.min and item.max - item.min
      list[k] = item
    end
    effects[measure.name] = list
  end
  local lines = {}
  for _, measure in ipairs(problem.measures) do
    for _, item in ipairs(effects[measure.name]) do
      if item.range then
        lines[#lines + 1] = ("%s by %s: %s to %s"):format(measure.name, item.name,
          numbers.quantity(item.min, measure.unit), numbers.quantity(item.max, measure.unit))
      end
    end
  end
  return {base = base, ranges = effects, text = table.concat(lines, "\n")}
end

return grid
