-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The standard normal distribution, exact to some units in the last place of both tails, and the same bits
-- wherever exp and log have them.
local normal = {}

local ROOT_2PI = math.sqrt(2 * math.pi)

--- The density at z.
function normal.density(z)
  return math.exp(-0.5 * z * z) / ROOT_2PI
end

-- P(0 < Z < z) of a small z >= 0: density times z + z^3/3 + z^5/(3 5) + ..., whose terms are all positive.
local function centre(z)
  local term, sum, n = z, z, 1
  while term > 1e-17 * sum do
    n = n + 2
    term = term * z * z / n
    sum = sum + term
  end
  return normal.density(z) * sum
end

-- P(Z > z) of a large z: density over the continued fraction z + 1/(z + 2/(z + 3/(z + ...))).
local function tail(z)
  local fraction = z
  for n = 100, 1, -1 do fraction = z + n / fraction end
  return normal.density(z) / fraction
end

--- The probability below z. The one above is that below -z, without cancellation.
function normal.probability(z)
  if z > 2.5 then return 1 - tail(z) end
  if z < -2.5 then return tail(-z) end
  return z < 0 and 0.5 - centre(-z) or 0.5 + centre(z)
end

--- The z below which the probability is p, from 0 to 1.
function normal.quantile(p)
  if p > 0.5 then return -normal.quantile(1 - p) end
  if p <= 0 then return -math.huge end
  -- Abramowitz and Stegun 26.2.23 within 4.5e-4, then Halley's steps, which treble the digits.
  local t = math.sqrt(-2 * math.log(p))
  local z = (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308))) - t
  for _ = 1, 2 do
    local step = (normal.probability(z) - p) / normal.density(z)
    z = z - step / (1 + 0.5 * z * step)
  end
  return z
end

return normal
