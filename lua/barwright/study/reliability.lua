-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How likely a study's constraints are violated when its variables scatter: what the designs form, importance and
-- subset share. All work with independent coordinates y of the standard normal distribution, one for each
-- variable. The margin of a limit is positive where its constraint is kept, in parts of the bound.
local core = require "barwright.core"
local normal = require "barwright.study.normal"

local reliability = {}

--- Raises where no probability of failure is defined, or the methods cannot work.
function reliability.check(name, problem)
  if #problem.constraints == 0 then
    core.raise(("design %s: constraints expected: a trial that violates one has failed"):format(name))
  end
  for _, v in ipairs(problem.variables) do
    if v.kind ~= "real" then
      core.raise(("design %s: '%s' is %s %s: reals expected; random and sobol take all kinds"):format(name, v.name,
        v.kind == "integer" and "an" or "a", v.kind))
    end
  end
end

--- The margin of one limit; nil where there is no result.
function reliability.margin(limit, results)
  local value = results and results[limit.name]
  return value and -limit.sign * (value - limit.bound)
end

--- The least margin of all limits; minus infinity where a result is missing: such a trial counts as failed.
function reliability.least(limits, results)
  local least = math.huge
  for _, limit in ipairs(limits) do
    least = math.min(least, reliability.margin(limit, results) or -math.huge)
  end
  return least
end

--- Wilson's interval of a probability of which `hits` of `count` trials are known.
function reliability.wilson(hits, count, z)
  local p, z2 = hits / count, z * z
  local middle = (p + z2 / (2 * count)) / (1 + z2 / count)
  local half = z * math.sqrt(p * (1 - p) / count + z2 / (4 * count * count)) / (1 + z2 / count)
  return hits == 0 and 0.0 or middle - half, hits == count and 1.0 or middle + half
end

--- The reliability index of a probability: minus its quantile.
function reliability.index(p) return -normal.quantile(p) end

--- "probability of failure 0.0023 (0.0021 to 0.0025), reliability index 2.83"
function reliability.text(p, low, high)
  local text = ("probability of failure %.3g"):format(p)
  if low then text = ("%s (%.3g to %.3g)"):format(text, low, high) end
  if p > 0 and p < 1 then text = ("%s, reliability index %.3f"):format(text, reliability.index(p)) end
  return text
end

--- "stress > 2e+07": when a limit has failed.
function reliability.failure_of(limit)
  return ("%s %s %.6g"):format(limit.name, limit.side == "max" and ">" or "<", limit.bound)
end

--- How many of the results are missing, as a sentence; nil where none is.
function reliability.missing(results)
  local count = 0
  for i = 1, #results do
    if not results[i] then count = count + 1 end
  end
  return count > 0 and ("%d of %d trials without results count as failures"):format(count, #results) or nil
end

--- A summary of trials drawn from the distributions themselves; nil where no variable has one or nothing can fail.
function reliability.of_samples(problem, results)
  local scattered = false
  for _, v in ipairs(problem.variables) do scattered = scattered or v.distribution ~= nil end
  if not scattered or #problem.constraints == 0 or #results == 0 then return nil end
  local limits, hits = problem:limits(), 0
  for i = 1, #results do
    if reliability.least(limits, results[i]) < 0 then hits = hits + 1 end
  end
  local out = {probability = hits / #results, failures = hits}
  out.low, out.high = reliability.wilson(hits, #results, 1.959963984540054)
  out.text = reliability.text(out.probability, out.low, out.high)
    .. (hits < 10 and ("; %d failures are few: form, importance or subset needs fewer trials"):format(hits) or "")
  local missing = reliability.missing(results)
  if missing then out.text = out.text .. "\n" .. missing end
  return out
end

return reliability
