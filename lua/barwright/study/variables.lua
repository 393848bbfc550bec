-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The variables of a study: reals, integers, choices. Each goes between its values and the unit
-- interval, where designs work: a real linearly or in its logarithm; the k-th of n integers or
-- choices owns the interval from (k-1)/n to k/n, and k's own place is its middle. The place of a real that has a
-- distribution is the probability below it.
local core = require "barwright.core"
local distributions = require "barwright.study.distributions"
local normal = require "barwright.study.normal"
local options = require "barwright.options"

local raise = core.raise

local variables = {}

local rules = {
  name = {type = "string", needed = true},
  kind = {type = "string", one_of = {"real", "integer", "choice"}},
  unit = {type = "string"},
  min = {type = "number"},
  max = {type = "number"},
  scale = {type = "string", one_of = {"linear", "log"}, default = "linear"},
  of = {type = "table"},
  distribution = {type = "table"},
  default = {type = "any"},
  what = {type = "string"}, -- a sentence for people
}

local finite = function(x) return x == x and x ~= math.huge and x ~= -math.huge end

--- One choice as text: distinct for distinct choices of one variable.
function variables.choice_text(value)
  return type(value) == "number" and ("%.17g"):format(value):gsub(",", ".") or tostring(value)
end

local function check_choices(where, v)
  if not v.of or #v.of == 0 then
    raise(("%s: of = {...}, a list of choices, expected, got %s"):format(where, v.of and "no choice" or "nil"))
  end
  v.min, v.max, v.index = nil, nil, {}
  for i, value in ipairs(v.of) do
    local kind = type(value)
    if kind ~= "string" and kind ~= "boolean" and not (kind == "number" and finite(value)) then
      raise(("%s: choice %d: a string, a finite number, true or false expected, got %s"):format(where, i,
        core.got(value)))
    end
    local text = variables.choice_text(value)
    if v.index[text] then raise(("%s: the choice %s occurs twice"):format(where, text)) end
    v.index[text] = i
  end
end

local function check_bounds(where, v)
  if v.of then raise(where .. ": 'of' is for choices; a number has min and max") end
  if not v.min or not v.max then
    raise(("%s: min and max expected, got min = %s and max = %s"):format(where, core.got(v.min), core.got(v.max)))
  end
  if v.kind == "integer" then
    local min, max = math.tointeger(v.min), math.tointeger(v.max)
    if not min or not max then
      raise(("%s: whole numbers expected as min and max of an integer, got %s and %s"):format(where,
        core.got(v.min), core.got(v.max)))
    end
    v.min, v.max = min, max
    if v.scale == "log" then raise(where .. ": kind 'real' expected with scale 'log', got 'integer'") end
  else
    v.min, v.max = v.min + 0.0, v.max + 0.0
    if v.scale == "log" and v.min <= 0 then
      raise(("%s: min above 0 expected with scale 'log', got %.14g"):format(where, v.min))
    end
  end
  if v.min >= v.max then
    raise(("%s: min below max expected, got min = %.14g and max = %.14g"):format(where, v.min, v.max))
  end
end

-- The normal coordinate of the last value on either side: a probability of 1e-19 lies beyond.
local REACH = 9
variables.reach = REACH

-- given: the options before defaults.
local function check_distribution(where, v, given)
  if v.kind ~= "real" or given.min or given.max or given.scale or given.of then
    raise(where .. ": a distribution is of a real without min, max, scale and of")
  end
  v.distribution = distributions.read(where, v.distribution)
  v.min, v.max = v.distribution:value(-REACH), v.distribution:value(REACH)
end

local class = {}
class.__index = class
class.__name = "variable"

local function kind_of(given)
  return given.kind or (given.of and "choice") or "real"
end

--- The list as given, checked and completed.
function variables.read(where, list)
  if type(list) ~= "table" or #list == 0 then
    raise(("%s: variables = {{name = ..., min = ..., max = ...}, ...} expected, got %s"):format(where,
      type(list) == "table" and "none" or core.got(list)))
  end
  local out, seen = {}, {}
  for i, given in ipairs(list) do
    local place = ("%s: variable %d"):format(where, i)
    local v = options.read(place, given, rules)
    place = ("%s: variable '%s'"):format(where, v.name)
    if v.name == "" or v.name:find "[%c]" then
      raise(("%s: variable %d: a name without control characters expected, got %s"):format(where, i,
        core.got(v.name)))
    end
    if seen[v.name] then raise(place .. " occurs twice") end
    seen[v.name] = true
    v.kind = kind_of(v)
    if v.distribution then
      check_distribution(place, v, given)
    elseif v.kind == "choice" then
      check_choices(place, v)
    else
      check_bounds(place, v)
    end
    setmetatable(v, class)
    if v.default ~= nil then v.default = v:check(v.default, place .. ": default") end
    out[i] = v
  end
  return out
end

--- How many values it can take; nil for a real.
function class:count()
  return self.kind == "choice" and #self.of or self.kind == "integer" and self.max - self.min + 1 or nil
end

--- The value that belongs to u from 0 to 1.
function class:value(u)
  local n = self:count()
  if n then
    local k = math.min(n - 1, math.max(0, math.floor(u * n)))
    if self.kind == "choice" then return self.of[k + 1] end -- which may be false
    return self.min + k
  end
  if u <= 0 then return self.min end
  if u >= 1 then return self.max end
  if self.distribution then return self:normal_value(normal.quantile(u)) end
  local x = self.scale == "log" and self.min * (self.max / self.min) ^ u
    or self.min + u * (self.max - self.min)
  return math.min(self.max, math.max(self.min, x))
end

--- The value whose probability is that below z in the standard normal distribution.
function class:normal_value(z)
  if not self.distribution then return self:value(normal.probability(z)) end
  return math.min(self.max, math.max(self.min, self.distribution:value(z)))
end

--- The z of a value.
function class:normal_place(value)
  return self.distribution and self.distribution:normal(value) or normal.quantile(self:place(value))
end

--- d(value)/dz at z.
function class:normal_slope(z)
  if self.distribution then return self.distribution:slope(z) end
  return self:slope(self:normal_value(z)) * normal.density(z)
end

--- The place of a value between 0 and 1.
function class:place(value)
  if self.distribution then return normal.probability(self.distribution:normal(value)) end
  local n = self:count()
  if n then
    local k = self.kind == "choice" and self.index[variables.choice_text(value)] - 1 or value - self.min
    return (k + 0.5) / n
  end
  if self.scale == "log" then return math.log(value / self.min) / math.log(self.max / self.min) end
  return (value - self.min) / (self.max - self.min)
end

--- d(value)/du where the value is.
function class:slope(value)
  if self.distribution then
    local z = self.distribution:normal(value)
    return self.distribution:slope(z) / normal.density(z)
  end
  if self.scale == "log" then return value * math.log(self.max / self.min) end
  return self.max - self.min
end

--- The value in the form that trials get; raises where it is none of the variable's.
function class:check(value, where)
  if self.kind == "choice" then
    local k = value ~= nil and type(value) ~= "table" and self.index[variables.choice_text(value)]
    if k and type(self.of[k]) == type(value) then return self.of[k] end
    local words = {}
    for i, each in ipairs(self.of) do words[i] = variables.choice_text(each) end
    raise(("%s: one of %s expected, got %s"):format(where, table.concat(words, ", "), core.got(value)))
  end
  if type(value) ~= "number" or not finite(value) then
    raise(("%s: a finite number expected, got %s"):format(where, core.got(value)))
  end
  if self.kind == "integer" then
    local whole = math.tointeger(value)
    if not whole then raise(("%s: a whole number expected, got %.14g"):format(where, value)) end
    value = whole
  else
    value = value + 0.0
    if value == 0 then value = 0.0 end -- of the two zeros the positive one
  end
  if value < self.min or value > self.max then
    raise(("%s: a number from %.14g to %.14g expected, got %.14g"):format(where, self.min, self.max, value))
  end
  return value
end

--- The default start of a study: the default of each variable, else its midpoint.
function class:initial()
  if self.default ~= nil then return self.default end
  return self:value(0.5)
end

--- "thickness [m]", "mass"
function variables.title(item)
  return item.unit and item.unit ~= "" and ("%s [%s]"):format(item.name, item.unit) or item.name
end

function class:__tostring()
  if self.kind == "choice" then
    local words = {}
    for i, each in ipairs(self.of) do words[i] = variables.choice_text(each) end
    return ("%s: %s"):format(self.name, table.concat(words, " or "))
  end
  if self.distribution then
    return ("%s: %s%s"):format(self.name, tostring(self.distribution), self.unit and " " .. self.unit or "")
  end
  return ("%s: %s%.6g to %.6g%s%s"):format(self.name, self.kind == "integer" and "whole numbers " or "",
    self.min, self.max, self.unit and " " .. self.unit or "", self.scale == "log" and " (log)" or "")
end

return variables
