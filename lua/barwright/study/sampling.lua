-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Designs that fill the unit cube: independent points, Latin hypercubes, Sobol's sequence.
local core = require "barwright.core"
local random = require "barwright.study.random"
local reliability = require "barwright.study.reliability"

local sampling = {}

local count_rule = {type = "integer", needed = true, min = 1, max = 10000000}
local seed_rule = {type = "integer"}

local function to_points(problem, places)
  local points = {}
  for i, place in ipairs(places) do points[i] = problem:point(place) end
  return points
end

-- The probability of failure, where variables have distributions; the interval is that of independent points, and
-- is wide for points that are spread evenly.
local function failure(problem, _, _, results)
  local found = reliability.of_samples(problem, results)
  return found and {failure = found, text = found.text} or {}
end

sampling.random = {summary = "independent points", rules = {count = count_rule, seed = seed_rule}, scatter = true,
  summarise = failure}
function sampling.random.points(problem, opts)
  local source, places = random.new(opts.seed), {}
  for i = 1, opts.count do
    local place = {}
    for k = 1, #problem.variables do place[k] = source:uniform() end
    places[i] = place
  end
  return to_points(problem, places)
end

-- ---- Latin hypercubes --------------------------------------------------------------------------------

--- `count` places in `dimensions` dimensions: of the `count` equal slices in each direction every one
--- holds one place. jitter: anywhere in the slice, else in its middle.
function sampling.latin(count, dimensions, source, jitter)
  local places = {}
  for i = 1, count do places[i] = {} end
  for k = 1, dimensions do
    local order = {}
    for i = 1, count do order[i] = i end
    source:shuffle(order)
    for i = 1, count do
      places[i][k] = (order[i] - 1 + (jitter and source:uniform() or 0.5)) / count
    end
  end
  return places
end

local function distance2(a, b)
  local sum = 0.0
  for k = 1, #a do
    local d = a[k] - b[k]
    sum = sum + d * d
  end
  return sum
end

--- The square of the least distance between two places.
function sampling.separation(places)
  local min = math.huge
  for i = 2, #places do
    for j = 1, i - 1 do min = math.min(min, distance2(places[i], places[j])) end
  end
  return min
end

-- Morris and Mitchell's measure of how close places come: the sum of 1/d^20 over pairs. Exchanging one
-- coordinate of two places keeps the Latin property, and changes the squares of their distances to the
-- others by one term; exchanges that lower the sum are kept.
local PAIRS = 4000000 -- pairs looked at, for a bound on time
local MAX_SPREAD = 1000 -- more are as far apart as they come

local function nearness(d2)
  if d2 < 1e-12 then d2 = 1e-12 end
  local r = 1 / d2
  local r2 = r * r
  local r4 = r2 * r2
  return r4 * r4 * r2
end

local function all_distances(places)
  local squares = {}
  for i = 1, #places do
    local row = {}
    for j = 1, #places do row[j] = j < i and squares[j][i] or distance2(places[i], places[j]) end
    squares[i] = row
  end
  return squares
end

--- Spreads the places of a Latin hypercube.
function sampling.spread(places, source)
  local n = #places
  if n < 3 then return places end
  local dimensions, squares = #places[1], all_distances(places)
  for _ = 1, math.min(100 * n * dimensions, PAIRS // n) do
    local i, k = source:integer(1, n), source:integer(1, dimensions)
    local j = source:integer(1, n - 1)
    if j >= i then j = j + 1 end
    local a, b, row_i, row_j = places[i][k], places[j][k], squares[i], squares[j]
    local change = 0.0
    for m = 1, n do
      if m ~= i and m ~= j then
        local x = places[m][k]
        local shift = (b - x) * (b - x) - (a - x) * (a - x)
        change = change + nearness(row_i[m] + shift) - nearness(row_i[m])
          + nearness(row_j[m] - shift) - nearness(row_j[m])
      end
    end
    if change < 0 then
      places[i][k], places[j][k] = b, a
      for m = 1, n do
        if m ~= i and m ~= j then
          row_i[m], row_j[m] = distance2(places[i], places[m]), distance2(places[j], places[m])
          squares[m][i], squares[m][j] = row_i[m], row_j[m]
        end
      end
    end
  end
  return places
end

sampling.latin_hypercube = {
  summary = "every one of `count` slices of each variable once",
  rules = {count = count_rule, seed = seed_rule, maximin = {type = "boolean", default = false},
    centroids = {type = "boolean", default = false}},
  scatter = true, summarise = failure,
}
function sampling.latin_hypercube.check(_, opts)
  if opts.maximin and opts.count > MAX_SPREAD then
    core.raise(("design latin_hypercube: maximin is for up to %d points: more are as far apart as they come")
      :format(MAX_SPREAD))
  end
end
function sampling.latin_hypercube.points(problem, opts)
  local source = random.new(opts.seed)
  local places = sampling.latin(opts.count, #problem.variables, source, not opts.centroids)
  if opts.maximin then sampling.spread(places, source) end
  return to_points(problem, places)
end

-- ---- Sobol's sequence --------------------------------------------------------------------------------

--- Places from `skip` on; scrambled by the seed, plain with seed nil.
function sampling.sobol_places(count, dimensions, skip, seed)
  local array, message = core.sobol(count, dimensions, {skip = skip, seed = seed})
  if not array then core.raise("design sobol: " .. message) end
  return array:totable()
end

sampling.sobol = {
  summary = "Sobol's sequence, scrambled by the seed",
  rules = {count = count_rule, seed = seed_rule, skip = {type = "integer", default = 0, min = 0},
    scramble = {type = "boolean", default = true}},
  scatter = true, summarise = failure,
}
function sampling.sobol.check(problem, opts)
  for _, v in ipairs(problem.variables) do
    if v.distribution and not opts.scramble and opts.skip == 0 then
      core.raise(("design sobol: '%s' has a distribution, and the first point without scrambling is its lower "
        .. "end: give skip = 1"):format(v.name))
    end
  end
end
function sampling.sobol.points(problem, opts)
  local places = sampling.sobol_places(opts.count, #problem.variables, opts.skip,
    opts.scramble and opts.seed or nil)
  for i, place in ipairs(places) do
    if type(place) == "number" then places[i] = {place} end -- one variable
  end
  return to_points(problem, places)
end

return sampling
