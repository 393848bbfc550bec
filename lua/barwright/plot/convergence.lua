-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Errors against size, both logarithmic, with the slope that each series has.
local core = require "barwright.core"
local axis = require "barwright.plot.axis"
local data = require "barwright.plot.data"
local figure = require "barwright.plot.figure"
local frame = require "barwright.plot.frame"
local numbers = require "barwright.plot.numbers"
local options = require "barwright.options"
local palette = require "barwright.plot.palette"
local series = require "barwright.plot.series"

local raise = core.raise
local where = "plot.convergence"

local rules = series.rules {
  series = {type = "table", needed = true},
  x = {type = "any"}, y = {type = "any"},
  triangles = {type = "boolean", default = true},
}
local one_rules = {
  name = {type = "string", default = ""},
  x = {type = "any", needed = true}, y = {type = "any", needed = true},
  slope = {type = "number"}, -- what it should be; else the nearest half of the fit
  last = {type = "integer", min = 2}, -- so many of the finest are fitted; all without
  colour = {type = "string"}, notes = {type = "table"},
}

-- The slope of a line through logarithms by least squares, over the `last` points of least x.
local function fitted(one)
  local rows = {}
  for i = 1, #one.x do
    if one.x[i] > 0 and one.y[i] > 0 then rows[#rows + 1] = {math.log(one.x[i]), math.log(one.y[i])} end
  end
  table.sort(rows, function(a, b)
    if a[1] ~= b[1] then return a[1] < b[1] end
    return a[2] < b[2]
  end)
  local n = math.min(one.last or #rows, #rows)
  local mx, my = 0, 0
  for i = 1, n do mx, my = mx + rows[i][1] / n, my + rows[i][2] / n end
  local xy, xx = 0, 0
  for i = 1, n do
    xy = xy + (rows[i][1] - mx) * (rows[i][2] - my)
    xx = xx + (rows[i][1] - mx) ^ 2
  end
  one.rows = rows
  if n < 2 or xx <= 1e-24 then return nil end
  return xy / xx
end

local function read(given, n)
  local at = ("%s: series %d"):format(where, n)
  local one = options.read(at, given, one_rules)
  one.x, one.y = data.numbers(at, "x", one.x), data.numbers(at, "y", one.y)
  if #one.x ~= #one.y then raise(("%s: y: %d numbers expected, as x has, got %d"):format(at, #one.x, #one.y)) end
  one.notes = data.texts(at, "notes", one.notes, #one.x)
  data.colour(at, one.colour)
  local colour, marker, dash = palette.series(n)
  one.colour, one.marker, one.dash = one.colour or colour, marker, dash
  one.fit = fitted(one)
  return one
end

-- A triangle of a slope below the middle of a series, its corner on the right.
local function draw_triangle(s, f, one)
  local p = one.slope or math.floor(2 * one.fit + 0.5) / 2
  if p == 0 or #one.rows < 2 then return end
  local first, last = one.rows[1], one.rows[#one.rows]
  local span = last[1] - first[1]
  local a = first[1] + 0.36 * span
  local b = a + math.min(0.28 * span, math.log(10) * 0.6)
  -- the series at a and b, linearly between its points
  local function at(x)
    for i = 2, #one.rows do
      local u, v = one.rows[i - 1], one.rows[i]
      if x <= v[1] and v[1] > u[1] then return u[2] + (v[2] - u[2]) * (x - u[1]) / (v[1] - u[1]) end
    end
    return last[2]
  end
  local down = 14 / f.height * math.log(f.y.high / f.y.low)
  local base = math.min(at(a), at(b) - p * (b - a)) - down
  local x1, y1 = f:place(math.exp(a), math.exp(base))
  local x2, y2 = f:place(math.exp(b), math.exp(base + p * (b - a)))
  if not x1 or not x2 or math.max(y1, y2) > f.bottom - 2 or x2 - x1 < 12 then return end
  s:polygon({x1, y1, x2, y1, x2, y2}, {fill = one.colour .. "1c", stroke = one.colour, width = 1.1})
  s:text(numbers.short(p), x2 + 5, (y1 + y2) / 2, {size = 11, middle = true, colour = one.colour, halo = true})
  if y1 + 14 < f.bottom then
    s:text("1", (x1 + x2) / 2, y1 + 12, {size = 11, align = 0.5, colour = one.colour, halo = true})
  end
end

local function with_default(given, label)
  if type(given) == "string" then given = {label = given} end
  if given ~= nil and type(given) ~= "table" then return given end -- the axis names what it expects
  local out = {label = label, scale = "log"}
  for key, value in pairs(given or {}) do out[key] = value end
  return out
end

--- Series {name, x (size), y (error), slope, last}; the slope of each is fitted and written in the legend.
return function(given)
  local opts = options.read(where, given, rules)
  local all, xs, ys = {}, {}, {}
  for n, one in ipairs(data.list(where, "series", opts.series)) do
    all[n] = read(one, n)
    xs[n], ys[n] = all[n].x, all[n].y
  end
  local x = axis.new(where .. ": x", with_default(opts.x, "size"), xs, {pad = 0.06})
  local y = axis.new(where .. ": y", with_default(opts.y, "error"), ys, {pad = 0.12})
  local legend, lost = {}, 0
  for n, one in ipairs(all) do
    local slope = one.fit and ("slope %s"):format(numbers.fixed(one.fit, 2))
    local name = one.name ~= "" and slope and ("%s (%s)"):format(one.name, slope) or slope or one.name
    if name ~= "" then
      legend[n] = {name = name, line = one.colour, dash = one.dash, marker = one.marker,
        pen = series.pen(one.marker, one.colour)}
    end
    lost = lost + #one.x - #one.rows
  end
  local notes = lost > 0 and {("%d point%s without place: an error of 0, or none"):format(lost,
    lost == 1 and "" or "s")} or nil
  return figure.new {kind = where, width = opts.width, height = opts.height, name = opts.title or "convergence",
    draw = function(s)
      local f = frame.new(s, frame.around(s, {title = opts.title, legend = legend, notes = notes}), x, y)
      if x.empty then f:say "no data" end
      f:enter(5)
      for _, one in ipairs(all) do
        local points = {}
        for i, row in ipairs(one.rows) do
          points[2 * i - 1], points[2 * i] = f:place(math.exp(row[1]), math.exp(row[2]))
        end
        s:line(points, {stroke = one.colour, width = 1.8, dash = one.dash})
        s:markers(one.marker, 7.5, points, series.pen(one.marker, one.colour))
        if opts.triangles and one.fit then draw_triangle(s, f, one) end
      end
      f:leave()
      return f
    end}
end
