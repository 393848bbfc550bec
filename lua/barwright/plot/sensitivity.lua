-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What matters: Sobol's indices as bars, Morris' effects in the plane of mu* and sigma, one at a time as
-- spans around a base.
local core = require "barwright.core"
local axis = require "barwright.plot.axis"
local bars = require "barwright.plot.bars"
local data = require "barwright.plot.data"
local figure = require "barwright.plot.figure"
local frame = require "barwright.plot.frame"
local numbers = require "barwright.plot.numbers"
local options = require "barwright.options"
local palette = require "barwright.plot.palette"
local series = require "barwright.plot.series"

local raise = core.raise
local where = "plot.sensitivity"

local rules = series.rules {
  names = {type = "table", needed = true},
  first = {type = "any"}, first_low = {type = "any"}, first_high = {type = "any"},
  total = {type = "any"}, total_low = {type = "any"}, total_high = {type = "any"},
  mu_star = {type = "any"}, mu_star_low = {type = "any"}, mu_star_high = {type = "any"},
  sigma = {type = "any"},
  low = {type = "any"}, high = {type = "any"}, base = {type = "number"},
  label = {type = "string"}, unit = {type = "string", default = ""}, -- of the measure
}

local function names_of(given)
  local out = {}
  for i = 1, #given do out[i] = tostring(given[i]) end
  return out
end

-- The order of falling values.
local function ranked(values)
  local order = {}
  for i = 1, #values do order[i] = i end
  table.sort(order, function(a, b)
    local u, v = values[a], values[b]
    if u ~= u or v ~= v then
      if (u ~= u) ~= (v ~= v) then return v ~= v end
    elseif u ~= v then return u > v end
    return a < b
  end)
  return order
end

local function taken(list, order)
  if not list then return nil end
  local out = {}
  for k, i in ipairs(order) do out[k] = list[i] end
  return out
end

local function sobol(opts, given)
  local order = ranked(opts.total or opts.first)
  local list = {}
  for _, key in ipairs {"first", "total"} do
    if opts[key] then
      list[#list + 1] = {name = key == "first" and "first order: by itself" or "total: with all its interactions",
        values = taken(opts[key], order), low = taken(opts[key .. "_low"], order),
        high = taken(opts[key .. "_high"], order)}
    end
  end
  return bars {names = taken(opts.names, order), series = list, horizontal = true,
    value = {label = "fraction of the variance" .. (opts.label and " of " .. opts.label or "")},
    title = opts.title, width = opts.width,
    height = given.height or math.max(180, 90 + #order * (24 + 16 * #list))}
end

-- A name beside its point where it hides no other: right, left, above, below.
local function place_name(s, f, text, x, y, taken_boxes)
  local w, h = s:text_width(text, 11.5), 14
  local tries = {{x, y - 10, 0.5}, {x, y + 19, 0.5}, {x + 9, y - 9, 0}, {x + 9, y + 17, 0}, {x - 9, y - 9, 1},
    {x + 9, y + 4, 0}, {x - 9, y + 4, 1}}
  for pass = 1, 2 do
    for _, try in ipairs(tries) do
      local left = try[1] - try[3] * w
      local box = {left, try[2] - h + 3, left + w, try[2] + 3}
      local free = left > f.left and left + w < f.right + 8 and box[2] > f.top - 6 and box[4] < f.bottom
      for _, other in ipairs(taken_boxes) do
        free = free and (box[3] < other[1] or box[1] > other[3] or box[4] < other[2] or box[2] > other[4])
      end
      if free or pass == 2 then
        taken_boxes[#taken_boxes + 1] = box
        s:text(text, try[1], try[2], {size = 11.5, align = try[3], halo = true})
        return
      end
    end
  end
end

local function draw_morris(s, f, opts)
  local boxes = {}
  for i = 1, #opts.names do
    local x, y = f:place(opts.mu_star[i], opts.sigma[i])
    if x then boxes[#boxes + 1] = {x - 5, y - 5, x + 5, y + 5} end
  end
  f:enter(6)
  for _, slope in ipairs {0.1, 0.5, 1} do
    local reach = math.min(f.x.high, f.y.high / slope)
    local ax, ay = f:place(0, 0)
    local bx, by = f:place(reach, slope * reach)
    s:line({ax, ay, bx, by}, {stroke = palette.line, width = 1, dash = {4, 4}})
  end
  for i = 1, #opts.names do
    local x, y = f:place(opts.mu_star[i], opts.sigma[i])
    local a = x and opts.mu_star_low and f:place(opts.mu_star_low[i], opts.sigma[i])
    local b = x and opts.mu_star_high and f:place(opts.mu_star_high[i], opts.sigma[i])
    if a and b then s:line({a, y, b, y}, {stroke = palette.pale, width = 1.6}) end
  end
  for i = 1, #opts.names do
    local x, y = f:place(opts.mu_star[i], opts.sigma[i])
    if x then s:markers("disc", 9, {x, y}, series.pen("disc", palette.good), {opts.names[i]}) end
  end
  f:leave()
  for _, slope in ipairs {0.1, 0.5, 1} do
    local reach = 0.97 * math.min(f.x.high, f.y.high / slope)
    local x, y = f:place(reach, slope * reach)
    local text = slope == 1 and "σ = μ*" or ("σ = %s μ*"):format(numbers.short(slope))
    local fits = x + 8 + s:text_width(text, 10.5) < f.right
    s:text(text, fits and x + 7 or x, fits and y + 9 or y - 7, {size = 10.5, align = fits and 0 or 1,
      colour = palette.soft, halo = true})
  end
  for i, name in ipairs(opts.names) do
    local x, y = f:place(opts.mu_star[i], opts.sigma[i])
    if x then place_name(s, f, s:shortened(name, 11.5, 160), x, y, boxes) end
  end
end

local function morris(opts)
  local of = opts.label and " on " .. opts.label or ""
  local x = axis.new(where, {label = "μ*: mean size of effects" .. of, unit = opts.unit},
    {opts.mu_star, opts.mu_star_high}, {zero = true, pad = 0.12})
  local y = axis.new(where, {label = "σ: their scatter", unit = opts.unit}, {opts.sigma},
    {zero = true, pad = 0.12})
  return figure.new {kind = where, width = opts.width, height = opts.height,
    name = opts.title or "effects" .. of,
    draw = function(s)
      local f = frame.new(s, frame.around(s, {title = opts.title,
        notes = {"above σ = μ* effects change their sign or depend on other variables; near 0 they are even"}}),
        x, y)
      if x.empty then f:say "no effects" end
      draw_morris(s, f, opts)
      return f
    end}
end

-- Spans from the measure at a variable's minimum to that at its maximum, the widest on top.
local function tornado(opts, given)
  local widths = {}
  for i = 1, #opts.names do widths[i] = math.abs(opts.high[i] - opts.low[i]) end
  local order = ranked(widths)
  local names, count = taken(opts.names, order), #order
  local upwards = {}
  for i = 1, count do upwards[i] = names[count + 1 - i] end
  local x = axis.new(where, {label = opts.label or "", unit = opts.unit}, {opts.low, opts.high,
    opts.base and {opts.base} or {}}, {pad = 0.06})
  local y = axis.names("", count > 0 and upwards or {""})
  return figure.new {kind = where, name = opts.title or "one variable at a time", width = opts.width,
    height = given.height or math.max(180, 110 + 34 * count),
    draw = function(s)
      local box = frame.around(s, {title = opts.title, legend = {{name = "at its minimum", fill = "#56b4e9"},
        {name = "at its maximum", fill = "#d55e00"}}})
      local f = frame.new(s, box, x, y)
      if count == 0 then f:say "no variables" end
      local thick = math.min(24, f.height / math.max(1, count) * 0.7)
      for k, i in ipairs(order) do
        local low, middle = f:place(opts.low[i], count + 1 - k)
        local high = f:place(opts.high[i], 1)
        local base = opts.base and f:place(opts.base, 1) or low and high and (low + high) / 2
        for _, one in ipairs {{low, "#56b4e9"}, {high, "#d55e00"}} do
          if one[1] and base and middle then
            s:rectangle(math.min(base, one[1]), middle - thick / 2, math.max(0.75, math.abs(one[1] - base)),
              thick, {fill = one[2]})
          end
        end
      end
      local base = opts.base and f:place(opts.base, 1)
      if base then s:line({base, f.top, base, f.bottom}, {stroke = palette.soft, width = 1.2}) end
      return f
    end}
end

--- Sobol's indices: names, first and total with first_low, first_high, total_low, total_high. Morris:
--- names, mu_star, sigma, mu_star_low, mu_star_high. One at a time: names, low and high (the measure at each
--- variable's minimum and maximum), base.
return function(given)
  local opts = options.read(where, given, rules)
  opts.names = names_of(data.list(where, "names", opts.names))
  local found = {}
  for _, key in ipairs {"first", "first_low", "first_high", "total", "total_low", "total_high", "mu_star",
    "mu_star_low", "mu_star_high", "sigma", "low", "high"} do
    opts[key] = opts[key] and data.numbers(where, key, opts[key], #opts.names)
    if opts[key] then found[#found + 1] = key end
  end
  if opts.mu_star and opts.sigma then return morris(opts) end
  if opts.low and opts.high then return tornado(opts, given) end
  if opts.first or opts.total then return sobol(opts, given) end
  raise(("%s: first or total (Sobol), mu_star and sigma (Morris), or low and high expected, got %s"):format(where,
    #found > 0 and table.concat(found, " and ") or "none"))
end
