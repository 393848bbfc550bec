-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What machine parts by formula are made of: boxes, cylinders, rotated bodies, holes. Dimensions in mm.
local bw = require "barwright"
local shapes = bw.shapes

local tools = {}

local sqrt, max, abs, pi = math.sqrt, math.max, math.abs, math.pi

function tools.box(x0, y0, z0, x1, y1, z1) return shapes.box({x0, y0, z0}, {x1, y1, z1}) end

--- A cylinder of radius r along an axis ("x", "y", "z") through (a, b), from `from` to `to` along it.
function tools.cylinder(axis, a, b, r, from, to)
  local centre, half = (from + to) / 2, (to - from) / 2
  return function(x, y, z)
    local u, v, w = x, y, z
    if axis == "x" then u, v, w = y, z, x elseif axis == "y" then u, v, w = x, z, y end
    local across, along = sqrt((u - a) ^ 2 + (v - b) ^ 2) - r, abs(w - centre) - half
    return max(across, along)
  end
end

--- `body` rotated by an angle about z.
function tools.rotated(body, angle)
  local c, s = math.cos(angle), math.sin(angle)
  return function(x, y, z) return body(c * x + s * y, -s * x + c * y, z) end
end

--- `body` without what is in any of `others`.
function tools.cut(body, others)
  for _, other in ipairs(others) do body = shapes.cut(body, other) end
  return body
end

--- Cylinders along z in equal distances on a circle.
function tools.bolt_circle(count, radius, hole, from, to)
  local holes = {}
  for i = 1, count do
    local a = 2 * pi * i / count
    holes[i] = tools.cylinder("z", radius * math.cos(a), radius * math.sin(a), hole, from, to)
  end
  return holes
end

--- The surface of a part {name, make} by formula, in metres. `make` gives a body and its box.
function tools.surface(part)
  local f, low, high = part.make()
  return assert(bw.surface.implicit(f, {min = low, max = high, cells = 64})):scale(1e-3)
end

return tools
