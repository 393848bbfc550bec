-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A Gaussian process through results at places of the unit cube: a value between them, and its standard deviation.
-- The covariance is Matern's of 5/2 with a length for each direction, around a constant mean (Rasmussen and
-- Williams, Gaussian Processes for Machine Learning, 2006; the mean by generalised least squares, their section
-- 2.7).
local core = require "barwright.core"

local process = {}
process.__index = process

local ROOT_5 = math.sqrt(5)

local function correlation(a, b, lengths)
  local square = 0.0
  for k = 1, #a do
    local d = (a[k] - b[k]) / lengths[k]
    square = square + d * d
  end
  local r = ROOT_5 * math.sqrt(square)
  return (1 + r + r * r / 3) * math.exp(-r)
end

-- Cholesky's factor of the correlations with the noise on the diagonal, by rows; nil where it is not positive.
local function factor_of(places, lengths, noise)
  local L = {}
  for i = 1, #places do
    local row = {}
    for j = 1, i do
      local other = L[j] or row
      local sum = i == j and 1 + noise or correlation(places[i], places[j], lengths)
      for k = 1, j - 1 do sum = sum - row[k] * other[k] end
      if i == j then
        if sum <= 0 then return nil end
        row[j] = math.sqrt(sum)
      else
        row[j] = sum / other[j]
      end
    end
    L[i] = row
  end
  return L
end

-- L x = b
local function forward(L, b)
  local x = {}
  for i, row in ipairs(L) do
    local sum = b[i]
    for k = 1, i - 1 do sum = sum - row[k] * x[k] end
    x[i] = sum / row[i]
  end
  return x
end

-- L^T x = b
local function backward(L, b)
  local x = table.move(b, 1, #b, 1, {})
  for i = #L, 1, -1 do
    local row = L[i]
    x[i] = x[i] / row[i]
    for k = 1, i - 1 do x[k] = x[k] - row[k] * x[i] end
  end
  return x
end

local function dot(a, b)
  local sum = 0.0
  for k = 1, #a do sum = sum + a[k] * b[k] end
  return sum
end

--- The process with given lengths and noise (a variance, in parts of that of the process), and the mean and the
--- variance that are likeliest with them, or `mean` and `variance` where given; nil where places are too near each
--- other for this noise.
function process.new(places, values, lengths, noise, mean, variance)
  local L = factor_of(places, lengths, noise)
  if not L then return nil end
  local n, ones = #places, {}
  for i = 1, n do ones[i] = 1.0 end
  local u = forward(L, ones)
  local weight = dot(u, u)
  local self = setmetatable({places = places, lengths = lengths, noise = noise, factor = L,
    known_mean = mean ~= nil}, process)
  self.mean = mean or dot(u, forward(L, values)) / weight
  local rest = {}
  for i = 1, n do rest[i] = values[i] - self.mean end
  local z, logarithm = forward(L, rest), 0.0
  for i = 1, n do logarithm = logarithm + math.log(L[i][i]) end
  self.variance = variance or math.max(dot(z, z) / n, 1e-300)
  self.ones, self.weight, self.alpha = u, weight, backward(L, z)
  self.log_likelihood = -0.5 * dot(z, z) / self.variance - 0.5 * n * math.log(2 * math.pi * self.variance)
    - logarithm
  return self
end

--- The value expected at a place, and its standard deviation (of the function, without noise).
function process:predict(place)
  local k = {}
  for i, other in ipairs(self.places) do k[i] = correlation(place, other, self.lengths) end
  local v = forward(self.factor, k)
  local square = 1 - dot(v, v)
  if not self.known_mean then square = square + (1 - dot(self.ones, v)) ^ 2 / self.weight end
  return self.mean + dot(k, self.alpha), math.sqrt(math.max(0, self.variance * square))
end

--- The values expected at the places, each by all others.
function process:left_out(values)
  local n, out = #self.places, {}
  for i = 1, n do
    local unit = {}
    for k = 1, n do unit[k] = k == i and 1.0 or 0.0 end
    local column = forward(self.factor, unit)
    out[i] = values[i] - self.alpha[i] / dot(column, column)
  end
  return out
end

local SHORTEST, LONGEST = 0.02, 20
local LEAST_NOISE, MOST_NOISE = 1e-9, 1e-1
local EVALUATIONS = 40 -- of the likelihood, for each length

--- The likeliest process. `former`: one from before, where the search begins too.
function process.fit(places, values, former)
  local d = #places[1]
  local min, max, starts = {}, {}, {{}, {}}
  for k = 1, d do
    min[k], max[k] = math.log(SHORTEST), math.log(LONGEST)
    starts[1][k], starts[2][k] = math.log(0.3), math.log(1.5)
  end
  min[d + 1], max[d + 1] = math.log(LEAST_NOISE), math.log(MOST_NOISE)
  starts[1][d + 1], starts[2][d + 1] = math.log(1e-6), math.log(1e-4)
  if former then
    local start = {}
    for k = 1, d do start[k] = math.log(former.lengths[k]) end
    start[d + 1] = math.log(former.noise)
    starts = {start, starts[1]}
  end
  local function at(x)
    local lengths = {}
    for k = 1, d do lengths[k] = math.exp(x[k]) end
    return process.new(places, values, lengths, math.exp(x[d + 1]))
  end
  local best
  for _, start in ipairs(starts) do
    local x = core.minimise {method = "bobyqa", start = start, min = min, max = max, tolerance = 1e-3,
      evaluations = EVALUATIONS * (d + 1), objective = function(x)
        local made = at(x)
        return made and -made.log_likelihood or 1e6 * #places
      end}
    local found = x and at(x) or at(start)
    if found and (not best or found.log_likelihood > best.log_likelihood) then best = found end
  end
  return best
end

return process
