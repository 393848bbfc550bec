-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Arguments of the public functions that are written in Lua, as data beside their class:
--
--   arguments.methods("session", class, class, {moved = "part: model", write = "path: string, options?: table"})
--
-- puts a check in front of each function: that it was called with its object, and that the arguments have their
-- kinds. What is wrong raises and names function and argument. An optional argument has a "?". Kinds are separated
-- by "|": string, number, integer, boolean, table, function, any, a class of the engine (mesh), a class written in
-- Lua by the name it was given here, and
--   pair     two finite numbers {x, y}
--   triple   three finite numbers {x, y, z}
--   options  a table of options: its pairs are read without its metatable
local core = require "barwright.core"
local options = require "barwright.options"

local raise = core.raise

local arguments = {}

local classes, names = {}, {} -- written in Lua: name -> metatable, and back

local function are_numbers(value, count)
  if type(value) ~= "table" then return false end
  for i = 1, count do
    local number = rawget(value, i)
    if type(number) ~= "number" or number ~= number or math.abs(number) == math.huge then return false end
  end
  return rawlen(value) == count
end

local function is_pair(value) return are_numbers(value, 2) end

local tests = {
  any = function() return true end,
  pair = is_pair,
  triple = function(value) return are_numbers(value, 3) end,
  options = function(value) return type(value) == "table" end,
  integer = function(value) return math.type(value) == "integer" end,
}
function tests.table(value) return type(value) == "table" and options.countable(value) end
for _, name in ipairs {"string", "number", "boolean", "function"} do
  tests[name] = function(value) return type(value) == name end
end

local spoken = {pair = "two finite numbers {x, y}", triple = "three finite numbers {x, y, z}",
  options = "a table of options", integer = "a whole number"}

local function is(value, kind)
  if tests[kind] then return tests[kind](value) end
  if classes[kind] then return type(value) == "table" and getmetatable(value) == classes[kind] end
  return options.kind(value) == kind
end

local function kind_of(value)
  return type(value) == "table" and names[getmetatable(value)] or options.kind(value)
end

local function spoken_name(kind)
  return spoken[kind] or core.spoken(kind)
end

local function expected(kinds)
  local words = {}
  for i, kind in ipairs(kinds) do words[i] = spoken_name(kind) end
  return table.concat(words, " or ")
end

-- "part: model, options?: table" as a list
local function parse(text)
  local list = {}
  for name, optional, kinds in text:gmatch "([%w_]+)(%??): ([%w_|]+)" do
    local rule = {name = name, optional = optional == "?", kinds = {}}
    for kind in kinds:gmatch "[^|]+" do rule.kinds[#rule.kinds + 1] = kind end
    list[#list + 1] = rule
  end
  return list
end

-- Tables of the library have a class.
local function got(value) return type(value) == "table" and kind_of(value) or core.got(value) end

local function check_one(where, rule, value)
  if value == nil and rule.optional then return end
  for _, kind in ipairs(rule.kinds) do
    if is(value, kind) and (value ~= nil or kind == "any") then return end
  end
  raise(("%s: %s: %s expected, got %s"):format(where, rule.name, expected(rule.kinds), got(value)))
end

-- The function with its arguments checked; a tail call, so that it finds its caller where it would without.
local function checked(where, f, text, first)
  local rules = parse(text)
  return function(...)
    if first then first(where, (...)) end
    for i, rule in ipairs(rules) do check_one(where, rule, (select(first and i + 1 or i, ...))) end
    return f(...)
  end
end

--- Puts checks in front of methods. `meta`: the metatable of the objects, whose class is known to further checks
--- by its name; none: the class is the engine's.
function arguments.methods(name, methods, meta, signatures)
  local kind = name:gsub(" ", "_")
  if meta then classes[kind], names[meta] = meta, kind end
  local function check_self(where, self)
    if not is(self, kind) then
      raise(("%s: %s expected, got %s: call it with a colon, as in %s:%s(...)"):format(where, expected {kind},
        got(self), kind, where))
    end
  end
  for where, text in pairs(signatures) do
    methods[where] = checked(where, assert(methods[where], where), text, check_self)
  end
end

--- Raises unless the value is {x, y}, two finite numbers.
function arguments.pair(where, value)
  if not is_pair(value) then raise(("%s: %s expected, got %s"):format(where, spoken.pair, core.got(value))) end
end

--- Puts checks in front of functions of a module; `prefix` goes before their names in messages.
function arguments.functions(prefix, module, signatures)
  for where, text in pairs(signatures) do
    module[where] = checked(prefix .. where, assert(module[where], where), text)
  end
end

return arguments
