-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Random numbers of one call, from the seed and the call's number alone (splitmix64), so that a call is made
-- again without those before it.
local Random = {}
Random.__index = Random

function Random:next()
  self.state = self.state + 0x9E3779B97F4A7C15
  local z = self.state
  z = (z ~ (z >> 30)) * 0xBF58476D1CE4E5B9
  z = (z ~ (z >> 27)) * 0x94D049BB133111EB
  return z ~ (z >> 31)
end

--- A number from 0 up to below 1.
function Random:uniform()
  return (self:next() >> 11) * 0x1p-53
end

--- A whole number from 1 to n.
function Random:integer(n)
  return (self:next() >> 1) % n + 1
end

function Random:chance(p)
  return self:uniform() < p
end

function Random:one_of(list)
  return list[self:integer(#list)]
end

return function(seed, call)
  local random = setmetatable({state = seed * 0x632BE59BD9B4E019 + call}, Random)
  random.state = random:next() -- neighbours become unlike each other
  return random
end
