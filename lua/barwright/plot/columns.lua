-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Columns of a table of trials: numbers with a unit, or names (choices), each with an axis.
local core = require "barwright.core"
local axis = require "barwright.plot.axis"
local data = require "barwright.plot.data"
local options = require "barwright.options"

local raise = core.raise
local columns = {}

local rules = {
  name = {type = "string", needed = true},
  unit = {type = "string"},
  scale = {type = "string", one_of = {"linear", "log"}},
  values = {type = "any", needed = true},
  of = {type = "table"}, -- the names, in order
  goal = {type = "string", one_of = {"min", "max"}},
  min = {type = "number"}, max = {type = "number"},
  whole = {type = "boolean"},
}

-- Longer lists are taken for a mistake: an index such as 2^40 leaves so many holes.
local LONGEST = 10000000

local function has_names(values)
  if type(values) ~= "table" then return false end
  for _, value in pairs(values) do
    if math.type(value) == nil and value ~= false then return true end
  end
  return false
end

-- Names become their numbers; the names that there are come in the order in which they are met.
local function numbered(where, given)
  local names, number, out = {}, {}, {}
  for i, name in ipairs(given.of or {}) do
    names[i] = tostring(name)
    number[names[i]] = i
  end
  local count = 0
  if type(given.values) ~= "table" then
    raise(("%s: values: a list of names expected, got %s"):format(where, core.got(given.values)))
  end
  for i in pairs(given.values) do
    if math.type(i) == "integer" and i > count then count = i end
  end
  if count > LONGEST then
    raise(("%s: values: at most %d entries expected, got entry %d"):format(where, LONGEST, count))
  end
  for i = 1, count do
    local value = given.values[i]
    local name = value ~= nil and tostring(value) or nil
    if name and not number[name] then
      if given.of then raise(("%s: one of its names expected, got '%s'"):format(where, name)) end
      names[#names + 1] = name
      number[name] = #names
    end
    out[i] = name and number[name] or 0 / 0
  end
  return out, names
end

--- {name, unit, values, scale, of, goal}: checked, with `numbers` and, later, an axis. `count`: of values.
function columns.read(where, given, count)
  local one = options.read(where, given, rules)
  if one.of or has_names(one.values) then
    one.numbers, one.names = numbered(where, one)
  else
    one.numbers = data.numbers(where, "values", one.values)
  end
  if count and #one.numbers ~= count then
    raise(("%s: %d values expected, as the first column has, got %d"):format(where, count, #one.numbers))
  end
  return one
end

--- All columns of a plot, of one length.
function columns.list(where, given, min, max)
  local out = {}
  for i, one in ipairs(data.list(where, "columns", given)) do
    out[i] = columns.read(("%s: column %d"):format(where, i), one, out[1] and #out[1].numbers)
  end
  if #out < min or #out > max then
    raise(("%s: %d to %d columns expected, got %d"):format(where, min, max, #out))
  end
  return out
end

local better = {min = "  ← better", max = "  better →"}

--- The axis of a column. A log axis without numbers above 0 becomes linear. how: see axis.new.
function columns.axis(where, one, how)
  how = how or {}
  if one.names then return axis.names(one.name, one.names) end
  local scale = one.scale
  if scale == "log" and not data.range({one.numbers}, true) then scale = "linear" end
  local made = axis.new(where, {label = one.name, unit = one.unit or "", scale = scale or "linear",
    min = one.min, max = one.max, whole = one.whole}, {one.numbers}, how)
  if how.goal and one.goal then made.label = made.label .. better[one.goal] end
  return made
end

--- Trues and falses of a list, as many as there are rows.
function columns.flags(where, what, given, count, otherwise)
  local out = {}
  if given ~= nil then data.list(where, what, given) end
  for i = 1, count do
    local value = given and given[i]
    if value == nil then out[i] = otherwise else out[i] = value and true or false end
  end
  return out
end

--- The places of a list as flags.
function columns.chosen(where, what, given, count)
  local out = {}
  for _, i in ipairs(given and data.list(where, what, given) or {}) do
    if math.type(i) ~= "integer" or i < 1 or i > count then
      raise(("%s: %s: places from 1 to %d expected, got %s"):format(where, what, count, core.got(i)))
    end
    out[i] = true
  end
  return out
end

return columns
