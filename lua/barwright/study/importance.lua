-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The probability of failure by importance sampling around design points. Points are drawn from a mixture of
-- normal distributions: most around the design points of the first-order method, by their probabilities, and a
-- tenth around the origin, which bounds the weights by ten where no design point was found. The weight of a failed
-- trial is the ratio of the densities. The estimate is unbiased, whatever the design points are. Its error is that
-- of the trials, which hardly ever see an unlikely region of failure apart from the design points.
local form = require "barwright.study.form"
local random = require "barwright.study.random"
local reliability = require "barwright.study.reliability"

local importance = {}

local rules = {
  count = {type = "integer", default = 5000, min = 10, max = 10000000}, -- at most, beside the search
  error = {type = "number", default = 0.1, above = 0, max = 1}, -- deviation over estimate at which it ends
  batch = {type = "integer", default = 200, min = 1, max = 100000},
}
for name, rule in pairs(form.rules) do rules[name] = rule end

importance.importance = {summary = "probability of failure by sampling around its likeliest points", rules = rules,
  scatter = true}
local design = importance.importance

function design.check(problem) reliability.check("importance", problem) end

function design.total(problem, opts)
  return form.form.total(problem, opts) + opts.count
end

local AT_ORIGIN = 0.1
local LEAST = 100 -- trials before an end is considered

local function mixture(found, dimensions)
  local origin, sum = {}, 0.0
  for k = 1, dimensions do origin[k] = 0.0 end
  for _, one in ipairs(found) do sum = sum + one.probability end
  local parts = {{centre = origin, weight = sum > 0 and AT_ORIGIN or 1.0}}
  for _, one in ipairs(found) do
    -- a part for the least likely too, whose probability may be misjudged
    local share = sum > 0 and 0.5 * one.probability / sum + 0.5 / #found or 0
    parts[#parts + 1] = {centre = one.y, weight = (1 - AT_ORIGIN) * share}
  end
  return parts
end

local function draw(parts, source)
  local u, y = source:uniform(), {}
  local chosen = parts[#parts]
  for _, part in ipairs(parts) do
    if u < part.weight then
      chosen = part
      break
    end
    u = u - part.weight
  end
  for k = 1, #chosen.centre do y[k] = chosen.centre[k] + source:normal() end
  return y, chosen == parts[1]
end

-- Density of the distribution over that of the mixture.
local function weight_of(parts, y)
  local below = 0.0
  for _, part in ipairs(parts) do
    local exponent = 0.0
    for k, c in ipairs(part.centre) do exponent = exponent + c * (y[k] - 0.5 * c) end
    below = below + part.weight * math.exp(exponent)
  end
  return 1 / below
end

--- probability with low, high (95 %) and deviation, where a trial failed; else low and high alone, by the trials
--- that were drawn from the distribution itself. count: trials drawn; form: what the search found.
function design.run(evaluate, problem, opts)
  local found, lost = form.search(evaluate, problem, opts)
  local parts, limits = mixture(found, #problem.variables), problem:limits()
  local source = random.new(opts.seed + 1)
  local count, sum, square, failures, missing, plain = 0, 0.0, 0.0, 0, 0, 0
  while count < opts.count do
    local points, weights = {}, {}
    for i = 1, math.min(opts.batch, opts.count - count) do
      local y, at_origin = draw(parts, source)
      plain = plain + (at_origin and 1 or 0)
      points[i], weights[i] = problem:normal_point(y), weight_of(parts, y)
    end
    local results = evaluate(points)
    for i = 1, #points do
      if not results[i] then missing = missing + 1 end
      if reliability.least(limits, results[i]) < 0 then
        sum, square, failures = sum + weights[i], square + weights[i] * weights[i], failures + 1
      end
    end
    count = count + #points
    local mean = sum / count
    local deviation = math.sqrt(math.max(0, square / count - mean * mean) / count)
    if count >= LEAST and mean > 0 and deviation <= opts.error * mean then break end
  end
  local out = {count = count, failures = failures, form = {points = found, lost = lost}}
  local lines = {}
  if failures == 0 then
    out.low, out.high = 0.0, select(2, reliability.wilson(0, plain, 1.959963984540054))
    lines[1] = ("no failure in %d trials: probability of failure below %.2g, by %d of them around the medians")
      :format(count, out.high, plain)
  else
    local p = sum / count
    local deviation = math.sqrt(math.max(0, square / count - p * p) / count)
    local half = 1.959963984540054 * deviation
    out.probability, out.deviation = p, deviation
    out.low, out.high = math.max(0, p - half), math.min(1, p + half)
    lines[1] = reliability.text(p, out.low, out.high) .. (" from %d trials around %s, %d of them failures"):format(
      count, #found == 1 and "1 design point" or #found .. " design points", failures)
    if failures < 10 then lines[2] = "the interval is uncertain: fewer than 10 failures were found" end
    if deviation > opts.error * p then
      lines[#lines + 1] = ("the error %.2g of the estimate is above %g: raise count"):format(deviation / p,
        opts.error)
    end
    lines[#lines + 1] = "assumed: no region of failure lies apart from these points; starts and subset look for "
      .. "others"
  end
  if missing > 0 then
    lines[#lines + 1] = ("%d of %d trials without results count as failures"):format(missing, count)
  end
  for _, one in ipairs(found) do lines[#lines + 1] = form.describe(problem, one) end
  for _, one in ipairs(lost) do
    lines[#lines + 1] = ("no design point of %s: ended by %s"):format(reliability.failure_of(one.limit), one.why)
  end
  out.text = table.concat(lines, "\n")
  return out
end

return importance
