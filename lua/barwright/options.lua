-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Tables of options of the functions written in Lua: known keys, types, ranges, defaults.
local core = require "barwright.core"

local raise = core.raise

local options = {}

local function fail(where, key, text)
  raise(("%s: option '%s': %s"):format(where, key, text))
end

-- The class of an object of the engine, "integer", or the type.
local function kind_of(value)
  return core.class_name(value) or math.type(value) == "integer" and "integer" or type(value)
end

options.kind = kind_of

local function length(value) return #value end

--- Whether a table's length is a count: a metatable may make anything of it.
function options.countable(value)
  local ok, count = pcall(length, value)
  return ok and math.type(count) == "integer" and count >= 0 and count < 1e9
end

-- Where objects of a class come from.
local origin = {solver = " of bw.solver", eigensolver = " of bw.eigensolver", linear_program_solver = " of bw.lp"}

-- What a rule expects, in words.
local function expected(rule)
  return rule.type == "integer" and "a whole number" or core.spoken(rule.type) .. (origin[rule.type] or "")
end

-- rule: {type = "number" | "integer" | "boolean" | "string" | "table" | a class, default =, min =,
-- max =, one_of = {...}, above =, auto = }; type "any" is checked by the caller. With auto the word "auto" is the
-- same as nothing.
local function check(where, key, value, rule)
  if type(value) == "table" and not options.countable(value) then
    fail(where, key, "a table with a length expected")
  end
  if rule.type == "any" then return end
  local kind = kind_of(value)
  if rule.type == "number" and kind == "integer" then kind = "number" end
  if kind ~= rule.type then
    fail(where, key, ("%s expected, got %s"):format(expected(rule) .. (rule.auto and ' or "auto"' or ""),
      core.got(value)))
  end
  if rule.type == "number" and (value ~= value or value == math.huge or value == -math.huge) then
    fail(where, key, ("a finite number expected, got %s"):format(core.got(value)))
  end
  if rule.above and value <= rule.above then
    fail(where, key, ("%s above %g expected, got %s"):format(expected(rule), rule.above, core.got(value)))
  end
  if rule.min and value < rule.min then
    fail(where, key, ("%s of at least %g expected, got %s"):format(expected(rule), rule.min, core.got(value)))
  end
  if rule.max and value > rule.max then
    fail(where, key, ("%s of at most %g expected, got %s"):format(expected(rule), rule.max, core.got(value)))
  end
  if rule.one_of then
    for _, word in ipairs(rule.one_of) do
      if word == value then return end
    end
    fail(where, key, ("'%s' is not known: %s"):format(value,
      core.suggestion(value, rule.one_of)))
  end
end

--- The options with defaults filled in. Raises for unknown keys.
function options.read(where, given, rules)
  if given == nil then given = {} end
  if type(given) ~= "table" then
    raise(("%s: a table of options expected, got %s"):format(where, core.got(given)))
  end
  local known, keys, values, out = {}, {}, {}, {}
  for key in pairs(rules) do known[#known + 1] = key end
  for key, value in pairs(given) do
    if type(key) ~= "string" then
      raise(("%s: named options expected, {name = value}, got a value at %s"):format(where, core.got(key)))
    end
    keys[#keys + 1], values[key] = key, value
  end
  -- of several mistakes the same one is reported in every run: the order of pairs is that of random hashes
  table.sort(known)
  table.sort(keys)
  for _, key in ipairs(keys) do
    local value, rule = values[key], rules[key]
    if not rule then
      raise(("%s: unknown option '%s': %s"):format(where, key, core.suggestion(key, known)))
    end
    if not (rule.auto and value == "auto") then
      check(where, key, value, rule)
      out[key] = value
    end
  end
  for _, key in ipairs(known) do
    local rule = rules[key]
    if out[key] == nil then
      if rule.needed then raise(("%s: option '%s' is missing"):format(where, key)) end
      out[key] = rule.default
    end
  end
  return out
end

--- Raises unless the value is an open object of the class.
function options.object(where, argument, value, class)
  if kind_of(value) ~= class then
    raise(("%s: %s: %s expected, got %s"):format(where, argument, core.spoken(class), core.got(value)))
  end
end

--- A copy of the options of a call, of which one level is changed, or of the table that its option of a name is.
function options.copied(given, name)
  local out = {}
  if given ~= nil and type(given) ~= "table" then
    raise(("%s expected, got %s"):format(name and ("option '%s': a table"):format(name) or "a table of options",
      core.got(given)))
  end
  for key, value in pairs(given or {}) do out[key] = value end
  return out
end

return options
