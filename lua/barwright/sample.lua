-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Samples without replacement that are the same on every machine: splitmix64, partial shuffle.
local sample = {}

local function generator(seed)
  local state = seed
  return function()
    state = state + 0x9E3779B97F4A7C15
    local z = state
    z = (z ~ (z >> 30)) * 0xBF58476D1CE4E5B9
    z = (z ~ (z >> 27)) * 0x94D049BB133111EB
    return z ~ (z >> 31)
  end
end

--- `count` of the numbers 1..total, ascending.
function sample.numbers(total, count, seed)
  local random, moved, out = generator(seed), {}, {}
  for i = 1, math.min(count, total) do
    -- the high 53 bits as a fraction: the bias of a plain remainder is not worth having
    local j = i + math.floor((random() >> 11) * 2.0 ^ -53 * (total - i + 1))
    out[i] = moved[j] or j
    moved[j] = moved[i] or i
  end
  table.sort(out)
  return out
end

return sample
