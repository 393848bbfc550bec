-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Sobol's indices: which part of a result's variance comes from each variable alone (first order), and
-- which with all that it does together with others (total). Two matrices A and B of points, and for every
-- variable A with that column from B (Saltelli et al., Computer Physics Communications 181, 2010).
local core = require "barwright.core"
local random = require "barwright.study.random"
local sampling = require "barwright.study.sampling"

local indices = {}

indices.sobol_indices = {
  summary = "parts of the variance by variable, alone and with others",
  rules = {
    base = {type = "integer", needed = true, min = 2, max = 10000000},
    estimator = {type = "string", one_of = {"saltelli", "jansen"}, default = "saltelli"}, -- of the first order
    resamples = {type = "integer", default = 200, min = 0, max = 100000},
    level = {type = "number", default = 0.95, above = 0, max = 0.999},
    seed = {type = "integer"},
  },
  scatter = "independent",
}
local design = indices.sobol_indices

--- For each row of the two matrices: A, B, then A with one column of B after another.
function design.points(problem, opts)
  local d = #problem.variables
  local points = {}
  for _, row in ipairs(sampling.sobol_places(opts.base, 2 * d, 0, opts.seed)) do
    local a, b = table.move(row, 1, d, 1, {}), table.move(row, d + 1, 2 * d, 1, {})
    points[#points + 1] = problem:point(a)
    points[#points + 1] = problem:point(b)
    for k = 1, d do
      local kept = a[k]
      a[k] = b[k]
      points[#points + 1] = problem:point(a)
      a[k] = kept
    end
  end
  return points
end

-- Rows {a, b, ab1, ..., abd} of one measure that are complete, less the mean, which cancels in theory and
-- is most of the rounding and of the scatter in practice.
local function rows_of(problem, results, name)
  local d = #problem.variables
  local rows, dropped = {}, 0
  for first = 1, #results - d - 1, d + 2 do
    local row = {}
    for k = 0, d + 1 do
      local value = results[first + k] and results[first + k][name]
      if not value then break end
      row[k + 1] = value
    end
    if #row == d + 2 then rows[#rows + 1] = row else dropped = dropped + 1 end
  end
  local sum = 0.0
  for _, row in ipairs(rows) do sum = sum + row[1] + row[2] end
  local mean = #rows > 0 and sum / (2 * #rows) or 0
  for _, row in ipairs(rows) do
    for k = 1, d + 2 do row[k] = row[k] - mean end
  end
  return rows, dropped, mean
end

-- The sums of some rows: variance, and for each variable first order and total.
local function estimate(rows, chosen, d, estimator)
  local n = #rows
  local sum, square = 0.0, 0.0
  local first, total = {}, {}
  for k = 1, d do first[k], total[k] = 0.0, 0.0 end
  for i = 1, n do
    local row = rows[chosen and chosen[i] or i]
    local a, b = row[1], row[2]
    sum, square = sum + a + b, square + a * a + b * b
    for k = 1, d do
      local ab = row[k + 2]
      local other = a - ab
      total[k] = total[k] + other * other
      if estimator == "jansen" then
        local own = b - ab
        first[k] = first[k] + own * own
      else
        first[k] = first[k] + b * (ab - a)
      end
    end
  end
  local variance = square / (2 * n) - (sum / (2 * n)) ^ 2
  if variance ~= variance or variance <= 0 then return 0.0, nil, nil end
  for k = 1, d do
    total[k] = total[k] / (2 * n) / variance
    first[k] = estimator == "jansen" and 1 - first[k] / (2 * n) / variance or first[k] / n / variance
  end
  return variance, first, total
end

local function spread(list, level)
  table.sort(list)
  local n, tail = #list, (1 - level) / 2
  if n == 0 then return nil end
  return {list[math.max(1, math.floor(tail * n + 0.5))], list[math.min(n, math.ceil((1 - tail) * n))]}
end

-- Intervals by the bootstrap: rows drawn with replacement.
local function intervals(rows, d, opts)
  local first, total = {}, {}
  for k = 1, d do first[k], total[k] = {}, {} end
  local source, chosen = random.new(opts.seed), {}
  for _ = 1, opts.resamples do
    for i = 1, #rows do chosen[i] = source:integer(1, #rows) end
    local _, f, t = estimate(rows, chosen, d, opts.estimator)
    for k = 1, f and d or 0 do
      first[k][#first[k] + 1], total[k][#total[k] + 1] = f[k], t[k]
    end
  end
  return first, total
end

local function of_measure(problem, opts, results, name)
  local d = #problem.variables
  local rows, dropped, mean = rows_of(problem, results, name)
  local out = {}
  if #rows < 2 then return out, dropped, mean, 0.0 end
  local variance, first, total = estimate(rows, nil, d, opts.estimator)
  local first_list, total_list = {}, {}
  if first and opts.resamples > 0 then first_list, total_list = intervals(rows, d, opts) end
  for k, v in ipairs(problem.variables) do
    out[k] = {name = v.name, first = first and first[k] or 0.0, total = total and total[k] or 0.0,
      first_interval = first_list[k] and spread(first_list[k], opts.level),
      total_interval = total_list[k] and spread(total_list[k], opts.level)}
  end
  return out, dropped, mean, variance
end

--- indices[measure] = {{name, first, first_interval, total, total_interval}, ...} in the order of the
--- variables; variance[measure], mean[measure], dropped = rows with a trial that has no result.
function design.summarise(problem, opts, _, results)
  local out = {indices = {}, variance = {}, mean = {}, dropped = 0}
  local lines = {}
  for _, m in ipairs(problem.measures) do
    local list, dropped, mean, variance = of_measure(problem, opts, results, m.name)
    out.indices[m.name], out.mean[m.name], out.variance[m.name] = list, mean, variance
    out.dropped = math.max(out.dropped, dropped)
    for _, item in ipairs(list) do
      local f, t = item.first_interval, item.total_interval
      lines[#lines + 1] = f and ("%s by %s: first %.3f (%.3f to %.3f), total %.3f (%.3f to %.3f)"):format(m.name,
        item.name, item.first, f[1], f[2], item.total, t[1], t[2])
        or ("%s by %s: first %.3f, total %.3f"):format(m.name, item.name, item.first, item.total)
    end
  end
  if opts.base & (opts.base - 1) ~= 0 then
    lines[#lines + 1] = ("base = %d is no power of 2: %d would fill the cube more evenly"):format(opts.base,
      1 << math.ceil(math.log(opts.base, 2)))
  end
  if out.dropped > 0 then
    lines[#lines + 1] = ("%d of %d rows left out, where a trial failed"):format(out.dropped, opts.base)
  end
  out.text = table.concat(lines, "\n")
  return out
end

function design.check(problem)
  if #problem.variables > 500 then
    core.raise "design sobol_indices: at most 500 variables expected: screen them with morris first"
  end
end

return indices
