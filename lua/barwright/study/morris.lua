-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Morris's screening (Technometrics 33, 1991): random walks on a grid of levels that move one variable at
-- a time; mu is the mean of the elementary effects, mu_star that of their sizes (Campolongo et al. 2007),
-- sigma their scatter. Effects are per width of a variable's range (of its logarithm for scale "log").
local core = require "barwright.core"
local numbers = require "barwright.plot.numbers"
local random = require "barwright.study.random"

local morris = {}

morris.morris = {
  summary = "elementary effects along random walks: which variables matter at all",
  rules = {
    trajectories = {type = "integer", default = 10, min = 2, max = 1000000},
    levels = {type = "integer", default = 4, min = 2, max = 1000},
    resamples = {type = "integer", default = 200, min = 0, max = 100000},
    seed = {type = "integer"},
  },
}

function morris.morris.check(_, opts)
  if opts.levels % 2 ~= 0 then
    core.raise("design morris: levels: an even number expected, got " .. core.got(opts.levels))
  end
end

local function walks(problem, opts)
  local source = random.new(opts.seed)
  local d, last = #problem.variables, opts.levels - 1
  local jump = opts.levels // 2 -- in levels: delta = p / (2 (p - 1))
  local places, moves = {}, {}
  for _ = 1, opts.trajectories do
    local at, order = {}, {}
    for k = 1, d do at[k], order[k] = source:integer(0, last), k end
    source:shuffle(order)
    for step = 0, d do
      if step > 0 then
        local k = order[step]
        local sign = at[k] + jump <= last and 1 or -1
        at[k] = at[k] + sign * jump
        moves[#places + 1] = {variable = k, delta = sign * jump / last}
      end
      local place = {}
      for k = 1, d do place[k] = at[k] / last end
      places[#places + 1] = place
    end
  end
  return places, moves
end

function morris.morris.points(problem, opts)
  local points = {}
  for i, place in ipairs(walks(problem, opts)) do points[i] = problem:point(place) end
  return points
end

local function mean(list)
  local sum = 0.0
  for _, x in ipairs(list) do sum = sum + x end
  return sum / #list
end

local function sizes(list)
  local out = {}
  for i, x in ipairs(list) do out[i] = math.abs(x) end
  return out
end

local function deviation(list)
  if #list < 2 then return 0.0 end
  local m, sum = mean(list), 0.0
  for _, x in ipairs(list) do sum = sum + (x - m) ^ 2 end
  return math.sqrt(sum / (#list - 1))
end

-- The middle 95 % of the means of resampled lists.
local function interval(list, resamples, source)
  if resamples == 0 then return nil end
  local means = {}
  for r = 1, resamples do
    local sum = 0.0
    for _ = 1, #list do sum = sum + list[source:integer(1, #list)] end
    means[r] = sum / #list
  end
  table.sort(means)
  return {means[math.max(1, math.floor(0.025 * resamples + 0.5))],
    means[math.min(resamples, math.ceil(0.975 * resamples))]}
end

--- effects[measure] = {{name, mu, mu_star, mu_star_interval, sigma, count}, ...} in the order of the variables.
function morris.morris.summarise(problem, opts, _, results)
  local _, moves = walks(problem, opts)
  local effects, dropped = {}, 0
  for _, measure in ipairs(problem.measures) do
    local lists = {}
    for k = 1, #problem.variables do lists[k] = {} end
    for i = 2, #results do
      local move = moves[i]
      if move then
        local a = results[i - 1] and results[i - 1][measure.name]
        local b = results[i] and results[i][measure.name]
        if a and b then
          local list = lists[move.variable]
          list[#list + 1] = (b - a) / move.delta
        else
          dropped = dropped + 1
        end
      end
    end
    local source, out = random.new(opts.seed), {}
    for k, v in ipairs(problem.variables) do
      local list = lists[k]
      local item = {name = v.name, count = #list}
      if #list > 0 then
        local size = sizes(list)
        item.mu, item.mu_star, item.sigma = mean(list), mean(size), deviation(list)
        item.mu_star_interval = interval(size, opts.resamples, source)
      end
      out[k] = item
    end
    effects[measure.name] = out
  end
  local lines = {}
  for _, measure in ipairs(problem.measures) do
    for _, item in ipairs(effects[measure.name]) do
      if item.mu then
        lines[#lines + 1] = ("%s by %s: mu %s, mu* %s, sigma %s"):format(measure.name, item.name,
          numbers.quantity(item.mu, measure.unit), numbers.quantity(item.mu_star, measure.unit),
          numbers.quantity(item.sigma, measure.unit))
      end
    end
  end
  return {effects = effects, dropped = dropped, text = table.concat(lines, "\n")}
end

return morris
