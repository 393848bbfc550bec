-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Pictures of bridges: the whole, coloured by stress, with load and supports, as SVG.
local core = require "barwright.core"
local mirror = require "barwright.mirror"

local picture = {}

local function colour(t)
  local r, g, b = core.colour(math.max(0, math.min(1, t)))
  return ("#%02x%02x%02x"):format(math.floor(r), math.floor(g), math.floor(b))
end

-- Triangles of equal colour in one path each.
local function add_triangles(out, bridge, scale)
  local points, mises = bridge.points:totable(), bridge.von_mises:totable()
  local shades, limit = {}, bridge.stress_limit
  local function shade(a, b, c)
    local t = (mises[a] + mises[b] + mises[c]) / (3 * limit)
    local n = math.max(0, math.min(40, math.floor(40 * t + 0.5)))
    shades[n] = shades[n] or {}
    local path = shades[n]
    for _, side in ipairs {1, -1} do
      for k, i in ipairs {a, b, c} do
        path[#path + 1] = ("%s%.2f %.2f"):format(k == 1 and "M" or "L", side * points[i][1] * scale,
          -points[i][2] * scale)
      end
      path[#path + 1] = "Z"
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
  for n = 0, 40 do
    if shades[n] then
      local c = colour(n / 40)
      out[#out + 1] = ('<path fill="%s" stroke="%s" stroke-width="0.3" d="%s"/>'):format(c, c,
        table.concat(shades[n]))
    end
  end
end

local function add_outline(out, outline, scale)
  local path = {}
  for _, polygon in ipairs(outline:polygons()) do
    for i, p in ipairs(polygon:totable()) do
      path[#path + 1] = ("%s%.2f %.2f"):format(i == 1 and "M" or "L", p[1] * scale, -p[2] * scale)
    end
    path[#path + 1] = "Z"
  end
  out[#out + 1] = ('<path fill="none" stroke="#222" stroke-width="1.2" d="%s"/>'):format(
    table.concat(path))
end

--- Writes the picture to a path (.svg).
function picture.write(bridge, path)
  local wish = bridge.options
  local width = wish.span + 2 * wish.bearing
  local scale = 900 / width
  local high = wish.deck * scale
  local out = {('<svg xmlns="http://www.w3.org/2000/svg" width="1000" height="%.0f"'
    .. ' viewBox="-500 %.0f 1000 %.0f" font-family="sans-serif" font-size="15">'):format(high + 150,
    -high - 75, high + 150), ('<rect x="-500" y="%.0f" width="1000" height="%.0f" fill="white"/>'):format(
    -high - 75, high + 150)}
  add_triangles(out, bridge, scale)
  add_outline(out, bridge.whole, scale)
  local a, b = wish.span / 2 * scale, wish.bearing * scale
  for _, side in ipairs {-1, 1} do
    local x = side > 0 and a or -a - b
    out[#out + 1] = ('<rect x="%.1f" y="1" width="%.1f" height="14" fill="#999"/>'):format(x, b)
  end
  out[#out + 1] = ('<path stroke="#222" stroke-width="2" fill="#222" d="M0 %.1f V%.1f M-5 %.1f L5 %.1f L0'
    .. ' %.1f Z"/>'):format(-high - 45, -high - 10, -high - 14, -high - 14, -high - 2)
  out[#out + 1] = ('<text x="12" y="%.0f">%.4g N</text>'):format(-high - 30, wish.load)
  for n = 0, 40 do
    out[#out + 1] = ('<rect x="%d" y="34" width="8.5" height="12" fill="%s"/>'):format(-164 + 8 * n,
      colour(n / 40))
  end
  out[#out + 1] = '<text x="-182" y="46" text-anchor="end">von Mises 0</text>'
  out[#out + 1] = ('<text x="172" y="46">%.4g MPa</text>'):format(wish.stress_limit / 1e6)
  out[#out + 1] = ('<text x="0" y="67" text-anchor="middle">area %.5g mm2, largest stress %.1f %% of the'
    .. ' limit</text>'):format(bridge.area * 1e6, 100 * bridge.utilisation)
  out[#out + 1] = "</svg>\n"
  return core.write_file(path, table.concat(out, "\n"))
end

--- The bridge as a closed surface of its thickness, for an STL file.
function picture.body(bridge)
  return mirror.body(bridge.points:totable(), bridge.elements:totable(), bridge.options.thickness)
end

return picture
