-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Pictures of bridges: the whole, coloured by stress, with load and supports.
local core = require "barwright.core"
local mirror = require "barwright.mirror"
local shown = require "barwright.shown"

local picture = {}

local SHADES, BREAK, INK = 40, 0 / 0, "#222222"

local function colour(t)
  local r, g, b = core.colour(math.max(0, math.min(1, t)))
  return ("#%02x%02x%02x"):format(math.floor(r), math.floor(g), math.floor(b))
end

-- Triangles of equal colour as one drawing: pieces are parted by what is no number.
local function add_triangles(canvas, bridge, at)
  local points, mises = bridge.points:totable(), bridge.von_mises:totable()
  local shades, limit = {}, bridge.stress_limit
  local function shade(a, b, c)
    local t = (mises[a] + mises[b] + mises[c]) / (3 * limit)
    local n = math.max(0, math.min(SHADES, math.floor(SHADES * t + 0.5)))
    local list = shades[n] or {}
    shades[n] = list
    for _, side in ipairs {1, -1} do
      for _, i in ipairs {a, b, c} do list[#list + 1] = {at(side * points[i][1], points[i][2])} end
      list[#list + 1] = {BREAK, BREAK}
    end
  end
  for _, e in ipairs(bridge.elements:totable()) do
    if #e == 6 then
      shade(e[1], e[4], e[6])
      shade(e[4], e[2], e[5])
      shade(e[6], e[5], e[3])
      shade(e[4], e[5], e[6])
    else
      shade(e[1], e[2], e[3])
    end
  end
  for n = 0, SHADES do
    local c = colour(n / SHADES)
    if shades[n] then canvas:polygon(shades[n], {fill = c, stroke = c, width = 0.3}) end
  end
end

local function add_outline(canvas, polygons, at)
  for _, polygon in ipairs(polygons) do
    local list = {}
    for i, p in ipairs(polygon:totable()) do list[i] = {at(p[1], p[2])} end
    list[#list + 1] = list[1]
    canvas:line(list, {stroke = INK, width = 1.2})
  end
end

--- Writes the picture to a path (.svg, .png).
function picture.write(bridge, path)
  local opts = bridge.options
  local scale = 900 / (opts.span + 2 * opts.bearing)
  local high = opts.deck * scale
  local canvas, message, details = core.canvas(1000, high + 150, {
    name = "bridge for " .. core.quantity(opts.load, "N")})
  if not canvas then return nil, message, details end
  local polygons
  polygons, message, details = bridge.whole:polygons()
  if not polygons then return nil, message, details end
  local ground = high + 75
  local function at(x, y) return 500 + x * scale, ground - y * scale end
  canvas:rectangle(0, 0, 1000, high + 150, {fill = "#ffffff"})
  add_triangles(canvas, bridge, at)
  add_outline(canvas, polygons, at)
  local a, b = opts.span / 2 * scale, opts.bearing * scale
  for _, x in ipairs {a, -a - b} do canvas:rectangle(500 + x, ground + 1, b, 14, {fill = "#999999"}) end
  canvas:line({{500, 30}, {500, 65}}, {stroke = INK, width = 2})
  canvas:polygon({{495, 61}, {505, 61}, {500, 73}}, {fill = INK})
  canvas:text(core.quantity(opts.load, "N"), 512, 45, {size = 15, colour = INK})
  for n = 0, SHADES do
    canvas:rectangle(336 + 8 * n, ground + 34, 8.5, 12, {fill = colour(n / SHADES)})
  end
  canvas:text("von Mises 0", 318, ground + 46, {size = 15, align = 1, colour = INK})
  canvas:text(core.quantity(opts.stress_limit, "Pa"), 672, ground + 46, {size = 15, colour = INK})
  canvas:text(("area %s, largest stress %s of the limit"):format(core.quantity(bridge.area, "m2"),
    shown.percent(bridge.utilisation)), 500, ground + 67, {size = 15, align = 0.5, colour = INK})
  return canvas:write(path)
end

--- The bridge as a closed surface of its thickness, for an STL file.
function picture.body(bridge)
  return mirror.body(bridge.points:totable(), bridge.elements:totable(), bridge.options.thickness)
end

return picture
