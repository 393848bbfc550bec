-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the plots are given: lists of numbers, which are checked; numbers that cannot be shown become nan.
local core = require "barwright.core"
local options = require "barwright.options"
local palette = require "barwright.plot.palette"

local raise = core.raise
local data = {}

-- Beyond these a difference of two values is no number any more.
local largest, smallest = 1e307, 1e-300

--- Whether a value can have a place on an axis.
function data.finite(value)
  return math.type(value) ~= nil and value > -largest and value < largest
end

local function is_array(value)
  return core.class_name(value) == "array"
end

--- A list of numbers from a list or an array of one column. nil, nan and infinite ones become nan;
--- `count`: how many there must be (holes at the end count).
function data.numbers(where, what, given, count)
  if is_array(given) then
    if given.column_count ~= 1 then
      raise(("%s: %s: an array of one column expected, got %d"):format(where, what, given.column_count))
    end
    given = given:totable()
  end
  if type(given) ~= "table" then
    raise(("%s: %s: a list of numbers expected, got %s"):format(where, what, core.got(given)))
  end
  if not options.countable(given) then
    raise(("%s: %s: a list of numbers expected, got a table without a length"):format(where, what))
  end
  local length = #given
  if count and length > count then
    raise(("%s: %s: %d numbers expected, got %d"):format(where, what, count, length))
  end
  local out = {}
  for i = 1, count or length do
    local value = given[i]
    if type(value) == "table" and options.countable(value) and #value == 1 then value = value[1] end
    if value ~= nil and value ~= false and math.type(value) == nil then
      raise(("%s: %s: entry %d: a number expected, got %s"):format(where, what, i, core.got(value)))
    end
    out[i] = data.finite(value) and (math.abs(value) < smallest and 0.0 or value) or 0 / 0
  end
  if count and length < count then
    local any = false
    for key in pairs(given) do any = any or math.type(key) == "integer" and key > length and key <= count end
    if not any and length < count and given.n == nil then
      raise(("%s: %s: %d numbers expected, got %d"):format(where, what, count, length))
    end
  end
  return out
end

--- A list of texts, or nil.
function data.texts(where, what, given, count)
  if given == nil then return nil end
  if type(given) ~= "table" then
    raise(("%s: %s: a list of texts expected, got %s"):format(where, what, core.got(given)))
  end
  local out = {}
  for i = 1, count do
    local text = given[i]
    out[i] = text ~= nil and text ~= false and tostring(text) or false
  end
  return out
end

--- A list that is a table with something in it.
function data.list(where, what, given)
  if type(given) ~= "table" then
    raise(("%s: %s: a list expected, got %s"):format(where, what, core.got(given)))
  end
  if not options.countable(given) then
    raise(("%s: %s: a list expected, got a table without a length"):format(where, what))
  end
  return given
end

function data.colour(where, given)
  if given ~= nil and not palette.is_colour(given) then
    raise(("%s: colour: \"#rrggbb\" or \"#rrggbbaa\" expected, got %s"):format(where, core.got(given)))
  end
  return given
end

--- min, max, of the numbers of lists that are numbers (above 0 with `positive`); nil: none.
function data.range(lists, positive)
  local min, max
  for _, list in ipairs(lists) do
    for i = 1, #list do
      local v = list[i]
      if v == v and (not positive or v > 0) then
        if not min or v < min then min = v end
        if not max or v > max then max = v end
      end
    end
  end
  return min, max
end

--- The median-rank correlation of two lists (Spearman's) over the places where both have numbers; nil
--- where fewer than three or all equal.
function data.rank_correlation(a, b)
  local rows = {}
  for i = 1, #a do
    if a[i] == a[i] and b[i] == b[i] then rows[#rows + 1] = {a[i], b[i]} end
  end
  local n = #rows
  if n < 3 then return nil end
  local ranks = {{}, {}}
  for k = 1, 2 do
    local order = {}
    for i = 1, n do order[i] = i end
    table.sort(order, function(p, q)
      local u, v = rows[p][k], rows[q][k]
      if u ~= v then return u < v end
      return p < q
    end)
    local i = 1
    while i <= n do -- equal values share the mean of their ranks
      local j = i
      while j < n and rows[order[j + 1]][k] == rows[order[i]][k] do j = j + 1 end
      for m = i, j do ranks[k][order[m]] = (i + j) / 2 end
      i = j + 1
    end
  end
  local mean, xy, xx, yy = (n + 1) / 2, 0, 0, 0
  for i = 1, n do
    local dx, dy = ranks[1][i] - mean, ranks[2][i] - mean
    xy, xx, yy = xy + dx * dy, xx + dx * dx, yy + dy * dy
  end
  if xx == 0 or yy == 0 then return nil end
  return xy / math.sqrt(xx * yy)
end

return data
