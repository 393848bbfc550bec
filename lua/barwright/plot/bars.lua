-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bars, upright or flat, with intervals.
local core = require "barwright.core"
local axis = require "barwright.plot.axis"
local data = require "barwright.plot.data"
local figure = require "barwright.plot.figure"
local frame = require "barwright.plot.frame"
local options = require "barwright.options"
local palette = require "barwright.plot.palette"
local series = require "barwright.plot.series"

local raise = core.raise

local bar_rules = series.rules {
  names = {type = "table", needed = true},
  series = {type = "table", needed = true}, -- {{name, values, low, high, colour}}
  value = {type = "any"}, -- the axis of the values
  label = {type = "string", default = ""}, -- what the names are
  horizontal = {type = "boolean"}, -- default: where names are many or long
  legend = {type = "boolean", default = true},
  notes = {type = "table", default = {}},
}
local bar_series = {name = {type = "string", default = ""}, values = {type = "any", needed = true},
  low = {type = "any"}, high = {type = "any"}, colour = {type = "string"}}

local function read_bars(where, opts)
  local all, lists = {}, {}
  local count = #opts.names
  for n, given in ipairs(data.list(where, "series", opts.series)) do
    local at = ("%s: series %d"):format(where, n)
    local one = options.read(at, given, bar_series)
    one.colour = data.colour(at, one.colour) or palette.series(n)
    for _, key in ipairs {"values", "low", "high"} do
      one[key] = one[key] and data.numbers(at, key, one[key], count)
      lists[#lists + 1] = one[key]
    end
    if (one.low == nil) ~= (one.high == nil) then
      raise(at .. ": low and high, or neither of them, expected, got one")
    end
    all[n] = one
  end
  return all, lists
end

-- One bar with its interval: `along` is the middle across the bars, from `base` to the value.
local function draw_bar(s, f, one, i, along, thick, flat)
  local v = one.values[i]
  local base = f[flat and "x" or "y"]
  local zero = base.log and base.low or 0
  local function place(value)
    if flat then return (f:place(value, i)) end
    return select(2, f:place(i, value))
  end
  local from, to = place(zero), place(v)
  if not to then return end
  local low, length = math.min(from, to), math.max(0.75, math.abs(to - from))
  if flat then s:rectangle(low, along - thick / 2, length, thick, {fill = one.colour})
  else s:rectangle(along - thick / 2, low, thick, length, {fill = one.colour}) end
  local a, b = one.low and place(one.low[i]), one.high and place(one.high[i])
  if a and b then
    local pen, nan, cap = {stroke = palette.ink, width = 1.2}, 0 / 0, math.min(4, thick / 3)
    local list = flat and {a, along, b, along, nan, nan, a, along - cap, a, along + cap, nan, nan, b,
      along - cap, b, along + cap} or {along, a, along, b, nan, nan, along - cap, a, along + cap, a, nan,
      nan, along - cap, b, along + cap, b}
    s:line(list, pen)
  end
end

local function names_of(where, given)
  local out = {}
  for i = 1, #data.list(where, "names", given) do out[i] = tostring(given[i]) end
  return out
end

--- Bars from 0, for each name one of every series, with intervals where low and high are given.
return function(given)
  local where = "plot.bars"
  local opts = options.read(where, given, bar_rules)
  local names = names_of(where, opts.names)
  local all, lists = read_bars(where, opts)
  local values = axis.new(where .. ": value", opts.value, lists, {zero = true})
  local longest = 0
  for _, name in ipairs(names) do longest = math.max(longest, utf8.len(name) or #name) end
  local flat = opts.horizontal
  if flat == nil then flat = #names > 8 or longest > 12 end
  local legend = {}
  for _, one in ipairs(all) do
    if one.name ~= "" then legend[#legend + 1] = {name = one.name, fill = one.colour} end
  end
  local listed = names
  if flat then -- the first on top: the axis counts upwards
    listed = {}
    for i = 1, #names do listed[i] = names[#names + 1 - i] end
  end
  local across = axis.names(opts.label, #listed > 0 and listed or {""})
  local length = #names * math.max(17, 9 * #all) + 90 -- for every name its line
  return figure.new {kind = where, name = opts.title or values.label,
    width = given.width or not flat and math.min(6000, math.max(opts.width, length)) or opts.width,
    height = given.height or flat and math.min(6000, math.max(opts.height, length)) or opts.height,
    draw = function(s)
      local box = frame.around(s, {title = opts.title, legend = opts.legend and legend, notes = opts.notes})
      local f = flat and frame.new(s, box, values, across) or frame.new(s, box, across, values)
      if #names == 0 then f:say "no data" end
      local slot = (flat and f.height or f.width) / math.max(1, #names)
      local thick = math.min(56, slot * 0.76 / math.max(1, #all))
      f:enter(2)
      for i = 1, #names do
        for n, one in ipairs(all) do
          local shift = (n - (#all + 1) / 2) * thick
          local at = flat and f.top + (i - 0.5) * slot or f.left + (i - 0.5) * slot
          draw_bar(s, f, one, i, at + shift, thick * 0.92, flat)
        end
      end
      f:leave()
      local _, zero = f:place(0.5, 0)
      if flat then
        local x = f:place(0, 0.5)
        if x then s:line({x, f.top, x, f.bottom}, {stroke = palette.line, width = 1.2}) end
      elseif zero then
        s:line({f.left, zero, f.right, zero}, {stroke = palette.line, width = 1.2})
      end
      return f
    end}
end
