-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Lines and scatters: series of x and y in one frame.
local core = require "barwright.core"
local axis = require "barwright.plot.axis"
local data = require "barwright.plot.data"
local figure = require "barwright.plot.figure"
local frame = require "barwright.plot.frame"
local options = require "barwright.options"
local palette = require "barwright.plot.palette"
local thin = require "barwright.plot.thin"

local raise = core.raise
local series = {}

local size = {
  title = {type = "string"},
  width = {type = "number", min = 120, max = 6000, default = 720},
  height = {type = "number", min = 100, max = 6000, default = 440},
}

--- Rules of options with those that every figure has.
function series.rules(own)
  local out = {}
  for key, rule in pairs(size) do out[key] = rule end
  for key, rule in pairs(own) do out[key] = rule end
  return out
end

-- ---- series of x and y -------------------------------------------------------------------------

local one_rules = {
  name = {type = "string", default = ""},
  x = {type = "any"}, y = {type = "any", needed = true},
  low = {type = "any"}, high = {type = "any"}, -- a band (lines) or intervals (scatter) around y
  notes = {type = "table"}, values = {type = "any"}, colour = {type = "string"},
  marker = {type = "string", one_of = {"disc", "square", "diamond", "triangle", "triangle_down", "cross",
    "plus"}},
  size = {type = "number", above = 0, max = 60},
  markers = {type = "boolean"}, dashed = {type = "boolean"}, steps = {type = "boolean"},
  width = {type = "number", above = 0, max = 30},
}

local rules = series.rules {
  series = {type = "table", needed = true},
  x = {type = "any"}, y = {type = "any"}, -- axes
  values = {type = "any"}, -- the axis of the colours
  marks = {type = "table", default = {}}, -- {x = or y =, name =}: lines across
  legend = {type = "boolean", default = true},
  notes = {type = "table", default = {}},
  diagonal = {type = "boolean", default = false}, -- the line x = y
}

local function read_series(where, given, n)
  local at = ("%s: series %d"):format(where, n)
  local opts = options.read(at, given, one_rules)
  opts.y = data.numbers(at, "y", opts.y)
  if opts.x == nil then
    opts.x = {}
    for i = 1, #opts.y do opts.x[i] = i end
  else
    opts.x = data.numbers(at, "x", opts.x)
  end
  if #opts.x ~= #opts.y then
    raise(("%s: y: %d numbers expected, as x has, got %d"):format(at, #opts.x, #opts.y))
  end
  for _, key in ipairs {"low", "high", "values"} do
    opts[key] = opts[key] and data.numbers(at, key, opts[key], #opts.y)
  end
  if (opts.low == nil) ~= (opts.high == nil) then
    raise(at .. ": low and high, or neither of them, expected, got one")
  end
  opts.notes = data.texts(at, "notes", opts.notes, #opts.y)
  data.colour(at, opts.colour)
  local colour, marker, dash = palette.series(n)
  opts.colour, opts.marker = opts.colour or colour, opts.marker or marker
  if opts.dashed ~= nil then dash = opts.dashed and {6, 3} or nil end
  opts.dash = dash
  return opts
end

-- Flat pixels of a series, nan where there is no place; how many have none.
local function pixels(f, xs, ys)
  local out, lost, nan = {}, 0, 0 / 0
  for i = 1, #xs do
    local x, y = f:place(xs[i], ys[i])
    if not x then lost = lost + 1 end
    out[2 * i - 1], out[2 * i] = x or nan, y or nan
  end
  return out, lost
end
series.pixels = pixels

-- Values that cannot be shown, in words; nil: none.
local function missing(all, x, y)
  local holes, below = 0, 0
  for _, one in ipairs(all) do
    for i = 1, #one.x do
      if one.x[i] ~= one.x[i] or one.y[i] ~= one.y[i] then holes = holes + 1
      elseif x.log and one.x[i] <= 0 or y.log and one.y[i] <= 0 then below = below + 1 end
    end
  end
  local out = {}
  if holes > 0 then
    out[1] = ("%d point%s without a finite number"):format(holes, holes == 1 and "" or "s")
  end
  if below > 0 then
    out[#out + 1] = ("%d point%s of 0 or less %s no place on a log axis"):format(below,
      below == 1 and "" or "s", below == 1 and "has" or "have")
  end
  return out[1] and table.concat(out, "; ") or nil
end

local function staircase(list)
  local out = {}
  for i = 1, #list, 2 do
    if i > 1 then out[#out + 1], out[#out + 2] = list[i], list[i - 1] end
    out[#out + 1], out[#out + 2] = list[i], list[i + 1]
  end
  return out
end
series.staircase = staircase

local function draw_band(s, f, one)
  local outline = {}
  for i = 1, #one.x do
    local x, y = f:place(one.x[i], one.high[i])
    if x then outline[#outline + 1], outline[#outline + 2] = x, y end
  end
  for i = #one.x, 1, -1 do
    local x, y = f:place(one.x[i], one.low[i])
    if x then outline[#outline + 1], outline[#outline + 2] = x, y end
  end
  s:polygon(outline, {fill = one.colour:sub(1, 7) .. "30"})
end

local function draw_intervals(s, f, one)
  local list, nan = {}, 0 / 0
  for i = 1, #one.x do
    local x, low = f:place(one.x[i], one.low[i])
    local _, high = f:place(one.x[i], one.high[i])
    if x and high then
      for _, v in ipairs {x, low, x, high, nan, nan, x - 3, low, x + 3, low, nan, nan, x - 3, high, x + 3,
        high, nan, nan} do
        list[#list + 1] = v
      end
    end
  end
  s:line(list, {stroke = one.colour, width = 1.2})
end

--- Marks of a series at pixels; strokes for crosses, a pale rim for the rest.
function series.pen(marker, colour, many)
  if marker == "cross" or marker == "plus" then return {stroke = colour, width = 1.6} end
  if many then return {fill = colour} end
  return {fill = colour, stroke = "#ffffff", width = 0.8}
end

-- Points coloured by values: groups of one colour, so that each is one list.
local function draw_coloured(s, list, one, bar)
  local groups, order = {}, {}
  for i = 1, #one.x do
    local at = bar:at(one.values[i])
    local step = at and math.floor(math.max(0, math.min(1, at)) * 63 + 0.5) or -1
    if not groups[step] then
      groups[step] = {points = {}, notes = {}}
      order[#order + 1] = step
    end
    local g = groups[step]
    g.points[#g.points + 1], g.points[#g.points + 2] = list[2 * i - 1], list[2 * i]
    g.notes[#g.notes + 1] = one.notes and one.notes[i] or false
  end
  table.sort(order)
  for _, step in ipairs(order) do
    local g = groups[step]
    local points = one.notes and g.points or thin.points(g.points)
    local colour = palette.value(step < 0 and 0 / 0 or step / 63)
    s:markers(one.marker, one.size or 6.5, points, series.pen(one.marker, colour, #one.x > 3000),
      one.notes and g.notes)
  end
end

local function draw_points(s, list, one, default, bar)
  if one.values and bar then return draw_coloured(s, list, one, bar) end
  local many = #list > 6000
  if many and not one.notes then list = thin.points(list) end
  s:markers(one.marker, one.size or many and math.min(default, 3) or default, list,
    series.pen(one.marker, one.colour, many), one.notes or nil)
end

-- Whether a line across runs where the names of upright ones stand.
local function crossed(f, marks)
  for _, mark in ipairs(marks) do
    local _, y = f:place(f.x.log and f.x.low or 0, mark.y or 0)
    if mark.y and y and y - f.top < 20 then return true end
  end
  return false
end

-- Room for the names of marks is inside the frame, beside their lines.
local function draw_marks(s, f, marks)
  for _, mark in ipairs(marks) do
    local pen = {stroke = palette.soft, width = 1.2, dash = {5, 4}}
    local x = mark.x and f:place(mark.x, f.y.log and f.y.low or 0)
    local _, y = f:place(f.x.log and f.x.low or 0, mark.y or 0)
    if mark.x and x then
      s:line({x, f.top, x, f.bottom}, pen)
      local right = x + 6 + s:text_width(mark.name or "", 11) < f.right
      s:text(mark.name or "", right and x + 5 or x - 5, f.top + (crossed(f, marks) and 28 or 12),
        {size = 11, align = right and 0 or 1, colour = palette.soft, halo = true})
    elseif mark.y and y then
      s:line({f.left, y, f.right, y}, pen)
      s:text(mark.name or "", f.right - 4, y - 5, {size = 11, align = 1, colour = palette.soft, halo = true,
        max = f.width - 8})
    end
  end
end

local function legend_of(all, opts, lines)
  local out = {}
  for _, one in ipairs(all) do
    if one.name ~= "" and opts.legend then
      local marked = not lines or one.markers
      out[#out + 1] = {name = one.name, line = lines and one.colour or nil, dash = one.dash,
        width = one.width, marker = marked and one.marker or nil,
        pen = series.pen(one.marker, one.values and palette.soft or one.colour)}
    end
  end
  return #out > 0 and out or nil
end

local function axes_of(where, opts, all)
  local xs, ys = {}, {}
  for i, one in ipairs(all) do
    xs[i] = one.x
    ys[#ys + 1] = one.y
    ys[#ys + 1], ys[#ys + 2] = one.low, one.high
  end
  for _, mark in ipairs(opts.marks) do
    if type(mark) ~= "table" or (data.finite(mark.x) == data.finite(mark.y)) then
      raise(("%s: marks: {x = number, name =} or {y = number, name =} expected, got %s"):format(where,
        type(mark) == "table" and ("x = %s and y = %s"):format(core.got(mark.x), core.got(mark.y))
        or core.got(mark)))
    end
    if mark.x then xs[#xs + 1] = {mark.x} else ys[#ys + 1] = {mark.y} end
  end
  if opts.diagonal then
    for _, list in ipairs {table.unpack(xs)} do ys[#ys + 1] = list end
    for _, list in ipairs {table.unpack(ys)} do xs[#xs + 1] = list end
  end
  return axis.new(where .. ": x", opts.x, xs), axis.new(where .. ": y", opts.y, ys)
end

local function draw_one(s, f, one, lines, bar)
  local list = pixels(f, one.x, one.y)
  if lines then
    if one.low then draw_band(s, f, one) end
    local line = one.steps and staircase(list) or list
    line = thin.clipped(thin.line(line), f.left - 50, f.top - 50, f.right + 50, f.bottom + 50)
    s:line(line, {stroke = one.colour, width = one.width or 2, dash = one.dash, round = not one.dash})
    if one.markers or #one.x == 1 then draw_points(s, list, one, 7) end
  else
    if one.low then draw_intervals(s, f, one) end
    draw_points(s, list, one, 7, bar)
  end
end

local function make(where, given, lines)
  local opts = options.read(where, given, rules)
  local all = {}
  for n, one in ipairs(data.list(where, "series", opts.series)) do all[n] = read_series(where, one, n) end
  local x, y = axes_of(where, opts, all)
  local coloured = {}
  for _, one in ipairs(all) do coloured[#coloured + 1] = one.values end
  local bar = coloured[1] and axis.new(where .. ": values", opts.values, coloured, {pad = 0})
  local notes = {table.unpack(opts.notes)}
  notes[#notes + 1] = missing(all, x, y)
  return figure.new {kind = where, name = opts.title or ("%s against %s"):format(
      y.label ~= "" and y.label or "y", x.label ~= "" and x.label or "x"),
    width = opts.width, height = opts.height,
    draw = function(s)
      local box = frame.around(s, {title = opts.title, legend = legend_of(all, opts, lines), notes = notes})
      if bar then box = frame.colour_bar(s, box, bar) end
      local f = frame.new(s, box, x, y)
      if x.empty or y.empty then f:say "no data" end
      f:enter(5)
      if opts.diagonal then
        local ax, ay = f:place(math.max(x.low, y.low), math.max(x.low, y.low))
        local bx, by = f:place(math.min(x.high, y.high), math.min(x.high, y.high))
        s:line({ax, ay, bx, by}, {stroke = palette.line, width = 1.2, dash = {5, 4}})
      end
      draw_marks(s, f, opts.marks)
      for _, one in ipairs(all) do draw_one(s, f, one, lines, bar) end
      f:leave()
      return f
    end}
end

--- Lines through points, in their order. Where a number is missing the line breaks.
function series.lines(given)
  return make("plot.lines", given, true)
end

--- Points, on request coloured by values.
function series.scatter(given)
  return make("plot.scatter", given, false)
end

return series
