-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How a real variable scatters: {"normal", mean = 2.3e9, deviation = 1e8}. Each kind maps the coordinate z of the
-- standard normal distribution to the value of the same probability, and back: where the methods of reliability
-- work, and what keeps both tails exact. Per kind:
--   rules                        its parameters, as barwright.options checks them
--   check(where, parameters)     raises where they are none together; may complete them
--   value(d, z), normal(d, x)    the value at z; z of a value
--   slope(d, z)                  d(value)/dz
local core = require "barwright.core"
local normal = require "barwright.study.normal"
local options = require "barwright.options"

local distributions = {}

local number = {type = "number", needed = true}
local positive = {type = "number", needed = true, above = 0}

-- log(1 + x) and -log(1 - p) of a small p without cancellation: the middle term of u - 1 carries the rounding.
local function log1p(x)
  local u = 1 + x
  return u == 1 and x or math.log(u) * x / (u - 1)
end

-- -log of the probability above z.
local function hazard(z)
  return z < 0 and -log1p(-normal.probability(z)) or -math.log(normal.probability(-z))
end

-- The z with hazard(z) = h.
local function of_hazard(h)
  if h > 0.6931471805599453 then return -normal.quantile(math.exp(-h)) end
  local u = math.exp(-h)
  local p = u == 1 and h or (1 - u) * h / -math.log(u) -- 1 - exp(-h)
  return normal.quantile(p)
end

local kinds = {}

kinds.normal = {
  rules = {mean = number, deviation = positive},
  value = function(d, z) return d.mean + d.deviation * z end,
  normal = function(d, x) return (x - d.mean) / d.deviation end,
  slope = function(d) return d.deviation end,
}

kinds.lognormal = {
  rules = {mean = positive, deviation = positive},
  check = function(_, d)
    d.log_deviation = math.sqrt(log1p((d.deviation / d.mean) ^ 2))
    d.log_mean = math.log(d.mean) - 0.5 * d.log_deviation ^ 2
  end,
  value = function(d, z) return math.exp(d.log_mean + d.log_deviation * z) end,
  normal = function(d, x) return (math.log(x) - d.log_mean) / d.log_deviation end,
  slope = function(d, z) return d.log_deviation * math.exp(d.log_mean + d.log_deviation * z) end,
}

kinds.uniform = {
  rules = {min = number, max = number},
  check = function(where, d)
    if d.min < d.max then return end
    core.raise(("%s: min below max expected, got min = %.14g and max = %.14g"):format(where, d.min, d.max))
  end,
  value = function(d, z)
    if z > 0 then return d.max - (d.max - d.min) * normal.probability(-z) end
    return d.min + (d.max - d.min) * normal.probability(z)
  end,
  normal = function(d, x)
    local below = x - d.min < d.max - x
    local z = normal.quantile((below and x - d.min or d.max - x) / (d.max - d.min))
    return below and z or -z
  end,
  slope = function(d, z) return (d.max - d.min) * normal.density(z) end,
}

kinds.weibull = {
  rules = {scale = positive, shape = positive, min = {type = "number", default = 0}},
  value = function(d, z) return d.min + d.scale * hazard(z) ^ (1 / d.shape) end,
  normal = function(d, x) return of_hazard(((x - d.min) / d.scale) ^ d.shape) end,
  slope = function(d, z)
    local h = hazard(z)
    return d.scale / d.shape * h ^ (1 / d.shape - 1) * normal.density(z) / normal.probability(-z)
  end,
}

local EULER = 0.57721566490153286

-- Of the largest of many: loads.
kinds.gumbel = {
  rules = {mean = number, deviation = positive},
  check = function(_, d)
    d.scale = d.deviation * math.sqrt(6) / math.pi
    d.mode = d.mean - EULER * d.scale
  end,
  value = function(d, z) return d.mode - d.scale * math.log(hazard(-z)) end,
  normal = function(d, x) return -of_hazard(math.exp((d.mode - x) / d.scale)) end,
  slope = function(d, z) return d.scale * normal.density(z) / (normal.probability(z) * hazard(-z)) end,
}

local names = {}
for name in pairs(kinds) do names[#names + 1] = name end
table.sort(names)

local class = {}
class.__index = class
class.__name = "distribution"

--- A distribution from {"normal", mean = ..., deviation = ...}; raises where it is none.
function distributions.read(where, given)
  if type(given) ~= "table" or not kinds[given[1]] then
    local got = type(given) == "table" and given[1] or given
    core.raise(("%s: distribution: {NAME, parameter = value, ...} with one of %s expected, got %s"):format(where,
      table.concat(names, ", "), core.got(got)))
  end
  local kind, parameters = kinds[given[1]], {}
  for key, value in pairs(given) do
    if key ~= 1 then parameters[key] = value end
  end
  where = ("%s: distribution %s"):format(where, given[1])
  parameters = options.read(where, parameters, kind.rules)
  local text, shown = {}, {}
  for name in pairs(kind.rules) do
    local value = parameters[name]
    if value - value ~= 0 then
      core.raise(("%s: %s: a finite number expected, got %s"):format(where, name, value))
    end
    text[#text + 1] = ("%s %.17g"):format(name, value)
    shown[#shown + 1] = ("%s %.6g"):format(name, value)
  end
  table.sort(text)
  table.sort(shown)
  if kind.check then kind.check(where, parameters) end
  return setmetatable({name = given[1], kind = kind, parameters = parameters,
    text = given[1] .. " " .. table.concat(text, ", "),
    shown = given[1] .. ", " .. table.concat(shown, ", ")}, class)
end

--- The value at z, a coordinate of the standard normal distribution.
function class:value(z) return self.kind.value(self.parameters, z) end

--- The z of a value.
function class:normal(value) return self.kind.normal(self.parameters, value) end

--- d(value)/dz at z.
function class:slope(z) return self.kind.slope(self.parameters, z) end

--- "normal, deviation 1e+08, mean 2.3e+09". Its field `text` has all digits: what files store, so that equal texts
--- are equal distributions.
function class:__tostring() return self.shown end

return distributions
