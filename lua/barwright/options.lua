-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Tables of options of the functions written in Lua: known keys, types, ranges, defaults.
local core = require "barwright.core"

local options = {}

local function fail(level, where, key, text)
  error(("%s: option '%s': %s"):format(where, key, text), level + 1)
end

local function kind_of(value)
  local meta = getmetatable(value)
  return type(value) == "userdata" and meta and meta.__name and meta.__name:match "[^.]+$"
    or math.type(value) == "integer" and "integer" or type(value)
end

-- rule: {type = "number" | "integer" | "boolean" | "string" | "table" | a class, default =, least =,
-- most =, one_of = {...}, above = }; type "any" is checked by the caller
local function check(where, key, value, rule, level)
  if rule.type == "any" then return end
  local kind = kind_of(value)
  if rule.type == "number" and kind == "integer" then kind = "number" end
  if kind ~= rule.type then
    fail(level + 1, where, key, ("%s expected, got %s"):format(
      rule.type == "integer" and "a whole number" or "a " .. rule.type, kind))
  end
  if rule.type == "number" and (value ~= value or value == math.huge or value == -math.huge) then
    fail(level + 1, where, key, "a finite number expected")
  end
  if rule.above and value <= rule.above then
    fail(level + 1, where, key, ("greater than %g expected, got %g"):format(rule.above, value))
  end
  if rule.least and value < rule.least then
    fail(level + 1, where, key, ("at least %g expected, got %g"):format(rule.least, value))
  end
  if rule.most and value > rule.most then
    fail(level + 1, where, key, ("at most %g expected, got %g"):format(rule.most, value))
  end
  if rule.one_of then
    for _, word in ipairs(rule.one_of) do
      if word == value then return end
    end
    fail(level + 1, where, key, ("'%s' is not known: did you mean '%s'?"):format(value,
      core.nearest(value, rule.one_of)))
  end
end

--- The options with defaults filled in. Raises for unknown keys, naming the nearest known one.
function options.read(where, given, rules, level)
  level = (level or 1) + 1
  if given == nil then given = {} end
  if type(given) ~= "table" then
    error(("%s: a table of options expected, got %s"):format(where, kind_of(given)), level)
  end
  local known = {}
  for key in pairs(rules) do known[#known + 1] = key end
  local out = {}
  for key, value in pairs(given) do
    local rule = rules[key]
    if not rule then
      if type(key) ~= "string" then
        error(("%s: options are named: {name = value}"):format(where), level)
      end
      error(("%s: unknown option '%s': did you mean '%s'?"):format(where, key,
        core.nearest(key, known)), level)
    end
    check(where, key, value, rule, level)
    out[key] = value
  end
  for key, rule in pairs(rules) do
    if out[key] == nil then
      if rule.needed then fail(level, where, key, "is missing") end
      out[key] = rule.default
    end
  end
  return out
end

--- Raises unless the value is an open object of the class.
function options.object(where, argument, value, class, level)
  if kind_of(value) ~= class then
    error(("%s: %s: a %s expected, got %s"):format(where, argument, class, kind_of(value)),
      (level or 1) + 1)
  end
end

return options
