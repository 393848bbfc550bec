-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The first-order reliability method. In coordinates y of the standard normal distribution, the point of failure
-- nearest to the origin is the likeliest (the design point). A plane there in place of the limit gives the
-- probability normal(-|y|). The point is found by the improved algorithm of Hasofer, Lind, Rackwitz and Fiessler
-- with a merit function (Zhang and Der Kiureghian, 1995).
--
-- Each search is a coroutine that yields the points it needs. The points of all searches are one batch of trials.
local normal = require "barwright.study.normal"
local numbers = require "barwright.plot.numbers"
local random = require "barwright.study.random"
local reliability = require "barwright.study.reliability"

local form = {}

form.rules = {
  starts = {type = "integer", default = 1, min = 1, max = 1000}, -- for each limit; the first at the origin
  iterations = {type = "integer", default = 30, min = 1, max = 1000},
  tolerance = {type = "number", default = 1e-3, above = 0, max = 0.1}, -- of the design point
  gradient = {type = "string", one_of = {"run", "differences"}, default = "differences"},
  step = {type = "number", default = 1e-3, above = 0, max = 1}, -- of differences, in standard deviations
  seed = {type = "integer"},
}

form.form = {summary = "probability of failure by the first-order reliability method", rules = form.rules,
  scatter = true}
local design = form.form

function design.check(problem) reliability.check("form", problem) end

--- Each iteration takes a gradient and one trial or more of the line search.
function design.total(problem, opts)
  local each = (opts.gradient == "differences" and #problem.variables or 0) + 2
  return opts.iterations * opts.starts * #problem:limits() * each
end

local function dot(a, b)
  local sum = 0.0
  for k = 1, #a do sum = sum + a[k] * b[k] end
  return sum
end

local function along(y, t, d)
  local out = {}
  for k = 1, #y do out[k] = y[k] + t * d[k] end
  return out
end

local NO_RESULT = setmetatable({}, {__tostring = function() return "a trial has no result" end})

-- Margins at some places.
local function margins(search, places)
  search.evaluations = search.evaluations + #places
  local results, gradients = coroutine.yield(places)
  local out = {}
  for i = 1, #places do
    out[i] = reliability.margin(search.limit, results[i])
    if not out[i] then error(NO_RESULT, 0) end
  end
  return out, gradients
end

-- The gradient that `run` returned, by y.
local function given_gradient(search, y, gradients)
  local problem, limit = search.problem, search.limit
  local given = gradients[1] and gradients[1][limit.name]
  if not given then
    error(("design form: run gave no gradient of '%s': return results, gradients, or give gradient = "
      .. "\"differences\""):format(limit.name), 0)
  end
  local z = problem.correlations and problem.correlations:correlated(y) or y
  local by_z = {}
  for k, v in ipairs(problem.variables) do by_z[k] = -limit.sign * given[v.name] * v:normal_slope(z[k]) end
  return problem.correlations and problem.correlations:gradient(by_z) or by_z
end

local function with_gradient(search, y)
  if search.opts.gradient == "run" then
    local g, gradients = margins(search, {y})
    return g[1], given_gradient(search, y, gradients)
  end
  local places = {y}
  for k = 1, #y do
    local other = along(y, 0, y)
    other[k] = y[k] + search.opts.step
    places[k + 1] = other
  end
  local g, slope = margins(search, places), {}
  for k = 1, #y do slope[k] = (g[k + 1] - g[1]) / search.opts.step end
  return g[1], slope
end

-- The merit is |y|^2 / 2 + c |g|; c above |y| / |slope| makes the direction one of descent.
local function line_search(search, y, g, slope, direction)
  local steps = dot(direction, direction)
  local c = 2 * math.sqrt(dot(y, y) / dot(slope, slope))
  if g ~= 0 then
    local far = along(y, 1, direction)
    c = math.max(c, 0.5 * dot(far, far) / math.abs(g))
  end
  c = c + 1e-9
  local merit = 0.5 * dot(y, y) + c * math.abs(g)
  local descent = dot(y, direction) + c * (g > 0 and 1 or g < 0 and -1 or 0) * dot(slope, direction)
  local t = 1.0
  for _ = 1, 12 do
    local there = along(y, t, direction)
    local value = margins(search, {there})[1]
    if 0.5 * dot(there, there) + c * math.abs(value) <= merit + 0.1 * t * descent then return there end
    t = 0.5 * t
  end
  return t * math.sqrt(steps) < search.opts.tolerance and along(y, t, direction) or nil
end

-- One search, inside its coroutine: what ended it, the place, margin and gradient there.
local function find(search)
  local y = search.start
  local scale
  for _ = 1, search.opts.iterations do
    local g, slope = with_gradient(search, y)
    local square = dot(slope, slope)
    scale = scale or math.max(math.abs(g), math.sqrt(square))
    if square <= 1e-24 * scale * scale or square ~= square then return "flat", y, g, slope end
    local target = along(y, 0, y)
    local t = (dot(slope, y) - g) / square
    for k = 1, #y do target[k] = t * slope[k] end
    local direction = along(target, -1, y)
    search.nearest = y
    if math.sqrt(dot(direction, direction)) <= search.opts.tolerance * (1 + math.sqrt(dot(y, y))) then
      return "converged", target, g, slope
    end
    y = line_search(search, y, g, slope, direction)
    if not y then return "stuck", search.nearest, g, slope end
  end
  return "iterations", y
end

local function starts_of(problem, opts)
  local list, source = {}, random.new(opts.seed)
  for i = 1, opts.starts do
    local y, length = {}, 0.0
    for k = 1, #problem.variables do
      y[k] = i == 1 and 0.0 or source:normal()
      length = length + y[k] * y[k]
    end
    -- at a distance where the limit may be: 3 standard deviations
    for k = 1, i == 1 and 0 or #y do y[k] = y[k] * 3 / math.sqrt(length) end
    list[i] = y
  end
  return list
end

-- Runs all searches; the points that they wait for are one batch.
local function run_all(searches, evaluate, problem)
  local open = {}
  for _, search in ipairs(searches) do
    search.thread = coroutine.create(find)
    search.places = nil
    open[#open + 1] = search
  end
  local results, trials = {}, {}
  while #open > 0 do
    local points, still, first = {}, {}, 0
    for _, search in ipairs(open) do
      local own, gradients = {}, {}
      for i = 1, search.places and #search.places or 0 do
        first = first + 1
        own[i], gradients[i] = results[first], trials[first] and trials[first].gradients
      end
      local ok, why, y, g, slope
      if search.places then
        ok, why, y, g, slope = coroutine.resume(search.thread, own, gradients)
      else
        ok, why, y, g, slope = coroutine.resume(search.thread, search)
      end
      if not ok and why ~= NO_RESULT then error(why, 0) end
      if coroutine.status(search.thread) == "dead" then
        search.why = ok and why or "a trial without a result"
        search.y, search.margin, search.slope = ok and y or search.nearest or search.start, g, slope
        search.converged = search.why == "converged"
      else
        search.places = why
        still[#still + 1] = search
        for _, place in ipairs(why) do points[#points + 1] = problem:normal_point(place) end
      end
    end
    open = still
    if #open > 0 then results, trials = evaluate(points) end
  end
end

-- Whether two design points are one.
local function same(a, b, tolerance)
  local d = along(a, -1, b)
  return math.sqrt(dot(d, d)) <= 20 * tolerance * (1 + math.sqrt(dot(a, a)))
end

local function finished(search)
  local distance = math.sqrt(dot(search.y, search.y))
  -- Failure lies beyond the design point, unless the origin has failed: the margin falls along y there.
  local inside = search.slope and dot(search.slope, search.y) <= 0
  local index = inside and distance or -distance
  local out = {limit = search.limit, y = search.y, why = search.why, converged = search.converged,
    evaluations = search.evaluations, reliability_index = index, probability = normal.probability(-index),
    point = search.problem:normal_point(search.y)}
  if search.slope and not search.problem.correlations then
    out.importance = {}
    local square = dot(search.slope, search.slope)
    for k, v in ipairs(search.problem.variables) do
      out.importance[v.name] = square > 0 and search.slope[k] ^ 2 / square or 0.0
    end
  end
  return out
end

--- The design points of all limits that were found, each once, the nearest first in each limit, and the searches
--- that did not converge.
function form.search(evaluate, problem, opts)
  local searches = {}
  for _, limit in ipairs(problem:limits()) do
    for _, start in ipairs(starts_of(problem, opts)) do
      searches[#searches + 1] = {problem = problem, opts = opts, limit = limit, start = start, evaluations = 0}
    end
  end
  run_all(searches, evaluate, problem)
  local found, lost = {}, {}
  for _, search in ipairs(searches) do
    local one, known = finished(search), nil
    for _, other in ipairs(found) do
      known = known or other.limit == one.limit and same(other.y, one.y, opts.tolerance) and other
    end
    if not one.converged then
      lost[#lost + 1] = one
    elseif known then
      known.evaluations = known.evaluations + one.evaluations
    else
      found[#found + 1] = one
    end
  end
  table.sort(found, function(a, b)
    if a.limit ~= b.limit then return a.limit.name .. a.limit.side < b.limit.name .. b.limit.side end
    return a.reliability_index < b.reliability_index
  end)
  return found, lost
end

--- "stress > 2e+07 most likely at thickness 3.8 mm, ...: reliability index 3.1, ..."
function form.describe(problem, one)
  local parts = {}
  for name, value in pairs(one.importance or {}) do parts[#parts + 1] = {name, value} end
  table.sort(parts, function(a, b)
    if a[2] ~= b[2] then return a[2] > b[2] end
    return a[1] < b[1]
  end)
  local words = {}
  for i, part in ipairs(parts) do
    if part[2] >= 0.005 then words[i] = ("%s %.0f %%"):format(part[1], 100 * part[2]) end
  end
  local place = {}
  for i, v in ipairs(problem.variables) do
    place[i] = ("%s %s"):format(v.name, numbers.quantity(one.point[v.name], v.unit))
  end
  return ("%s likeliest at %s: reliability index %.3f, by a plane probability %.3g, after %d trials%s"):format(
    reliability.failure_of(one.limit), table.concat(place, ", "), one.reliability_index, one.probability,
    one.evaluations, #words > 0 and "; by " .. table.concat(words, ", ") or "")
end

--- points = {{limit, point, reliability_index, probability, importance, evaluations}, ...}; lost: searches without
--- a design point; probability, from `low` to `high`, of any failure: the bounds of events whose joint probability
--- is unknown, exact only where limits are planes. `high` and `probability` are nil where a limit has no point.
function design.run(evaluate, problem, opts)
  local found, lost = form.search(evaluate, problem, opts)
  local out, lines, sum, most, seen = {points = found, lost = lost}, {}, 0.0, 0.0, {}
  for i, one in ipairs(found) do
    seen[one.limit] = true
    sum, most = sum + one.probability, math.max(most, one.probability)
    lines[i] = form.describe(problem, one)
  end
  for _, one in ipairs(lost) do
    lines[#lines + 1] = ("%s: no design point: ended by %s after %d trials"):format(
      reliability.failure_of(one.limit), one.why, one.evaluations)
  end
  local open = 0 -- limits without a point
  for _, one in ipairs(lost) do
    if not seen[one.limit] then open, seen[one.limit] = open + 1, true end
  end
  if #found > 0 and open > 0 then
    out.low = most
    lines[#lines + 1] = ("probability of failure at least %.3g by planes; %d of %d limits have no design point")
      :format(most, open, #problem:limits())
  elseif #found > 0 then
    out.low, out.high = most, math.min(1, sum)
    out.probability = #found == 1 and most or nil
    lines[#lines + 1] = (#found == 1 and ("probability of failure %.3g"):format(most)
      or ("probability of failure from %.3g to %.3g"):format(out.low, out.high))
      .. " by planes in place of the limits; the error is unknown: use the design importance for it"
  end
  out.text = table.concat(lines, "\n")
  return out
end

return form
