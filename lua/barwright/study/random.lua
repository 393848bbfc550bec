-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Random numbers that are the same everywhere: xoshiro256** seeded by splitmix64 (Blackman, Vigna),
-- the engine's own generator, with Lua's integers that wrap at 64 bits.
local random = {}
random.__index = random
random.__name = "random"

local function splitmix(state)
  state = state + 0x9e3779b97f4a7c15
  local z = state
  z = (z ~ (z >> 30)) * 0xbf58476d1ce4e5b9
  z = (z ~ (z >> 27)) * 0x94d049bb133111eb
  return state, z ~ (z >> 31)
end

--- A generator of a whole number.
function random.new(seed)
  local self, state = setmetatable({}, random), seed
  for i = 1, 4 do state, self[i] = splitmix(state) end
  return self
end

--- 64 bits as an integer.
function random:bits()
  local s1, s2, s3, s4 = self[1], self[2], self[3], self[4]
  local r = s2 * 5
  r = ((r << 7) | (r >> 57)) * 9
  local t = s2 << 17
  s3 = s3 ~ s1
  s4 = s4 ~ s2
  s2 = s2 ~ s3
  s1 = s1 ~ s4
  s3 = s3 ~ t
  self[1], self[2], self[3], self[4] = s1, s2, s3, (s4 << 45) | (s4 >> 19)
  return r
end

--- From 0 up to below 1.
function random:uniform()
  return (self:bits() >> 11) * 0x1p-53
end

--- Of the normal distribution.
function random:normal(mean, deviation)
  local u, v = 1 - self:uniform(), self:uniform()
  return (mean or 0) + (deviation or 1) * math.sqrt(-2 * math.log(u)) * math.cos(6.283185307179586 * v)
end

--- A whole number from `least` to `most`, each as likely.
function random:integer(min, max)
  local n = max - min + 1
  local above = (-1 >> 1) // n * n -- what lies above would favour the first ones
  local bits
  repeat bits = self:bits() >> 1 until bits < above
  return min + bits % n
end

--- Puts a list into random order.
function random:shuffle(list)
  for i = #list, 2, -1 do
    local k = self:integer(1, i)
    list[i], list[k] = list[k], list[i]
  end
  return list
end

return random
