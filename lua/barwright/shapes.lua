-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bodies by formula: signed distance functions f(x, y, z), negative inside, to put together and hand
-- to bw.surface.implicit. Lengths in metres.
local arguments = require "barwright.arguments"
local core = require "barwright.core"

local raise = core.raise

local shapes = {}

local sqrt, min, max, abs = math.sqrt, math.min, math.max, math.abs

function shapes.sphere(centre, radius)
  local cx, cy, cz = centre[1], centre[2], centre[3]
  return function(x, y, z)
    local dx, dy, dz = x - cx, y - cy, z - cz
    return sqrt(dx * dx + dy * dy + dz * dz) - radius
  end
end

--- A limb from a to b whose radius goes linearly from ra to rb (rb defaults to ra).
function shapes.limb(a, b, ra, rb)
  rb = rb or ra
  local ax, ay, az = a[1], a[2], a[3]
  local bx, by, bz = b[1] - ax, b[2] - ay, b[3] - az
  local length2 = bx * bx + by * by + bz * bz
  return function(x, y, z)
    local px, py, pz = x - ax, y - ay, z - az
    local t = (px * bx + py * by + pz * bz) / length2
    t = max(0, min(1, t))
    local dx, dy, dz = px - t * bx, py - t * by, pz - t * bz
    return sqrt(dx * dx + dy * dy + dz * dz) - (ra + t * (rb - ra))
  end
end

function shapes.box(lower, upper)
  local cx, cy, cz = (lower[1] + upper[1]) / 2, (lower[2] + upper[2]) / 2, (lower[3] + upper[3]) / 2
  local hx, hy, hz = (upper[1] - lower[1]) / 2, (upper[2] - lower[2]) / 2, (upper[3] - lower[3]) / 2
  return function(x, y, z)
    local dx, dy, dz = abs(x - cx) - hx, abs(y - cy) - hy, abs(z - cz) - hz
    local ox, oy, oz = max(dx, 0), max(dy, 0), max(dz, 0)
    return sqrt(ox * ox + oy * oy + oz * oz) + min(max(dx, dy, dz), 0)
  end
end

--- Union of bodies whose joints are rounded over the given distance.
function shapes.join(bodies, rounding)
  local count = #bodies
  if count == 0 then raise "shapes.join: bodies: a list of one function or more expected, got an empty list" end
  for i = 1, count do
    if type(bodies[i]) ~= "function" then
      raise(("shapes.join: bodies: entry %d: a function expected, got %s"):format(i, core.got(bodies[i])))
    end
  end
  rounding = rounding or 0
  return function(x, y, z)
    local d = bodies[1](x, y, z)
    for i = 2, count do
      local e = bodies[i](x, y, z)
      local h = rounding > 0 and max(rounding - abs(d - e), 0) / rounding or 0
      d = min(d, e) - h * h * rounding / 4
    end
    return d
  end
end

function shapes.cut(body, tool)
  return function(x, y, z)
    return max(body(x, y, z), -tool(x, y, z))
  end
end

--- A toy foal, about 70 mm long, standing on z = 0: thick body, thin legs, a thin tail. Returns the
--- function and its box.
function shapes.foal()
  local mm = 1e-3
  local function at(x, y, z)
    return {x * mm, y * mm, z * mm}
  end
  local bodies = {
    shapes.limb(at(-18, 0, 42), at(16, 0, 43), 10 * mm, 11 * mm), -- trunk
    shapes.limb(at(18, 0, 46), at(30, 0, 66), 7 * mm, 4.5 * mm), -- neck
    shapes.limb(at(29, 0, 67), at(42, 0, 60), 5.5 * mm, 3.2 * mm), -- head
    shapes.limb(at(28, 2.5, 71), at(27, 4, 77), 1.6 * mm, 0.9 * mm), -- ears
    shapes.limb(at(28, -2.5, 71), at(27, -4, 77), 1.6 * mm, 0.9 * mm),
    shapes.limb(at(-26, 0, 47), at(-37, 0, 28), 2.4 * mm, 1.4 * mm), -- tail
  }
  for _, leg in ipairs {{15, 5.5, 0}, {17, -5.5, 3}, {-19, 5.5, -2}, {-17, -5.5, 1}} do
    local x, y, lean = leg[1], leg[2], leg[3]
    bodies[#bodies + 1] = shapes.limb(at(x, y, 38), at(x + lean, y, 20), 5.5 * mm, 2.6 * mm)
    bodies[#bodies + 1] = shapes.limb(at(x + lean, y, 20), at(x + lean / 2, y, 4), 2.6 * mm, 1.9 * mm)
    bodies[#bodies + 1] = shapes.limb(at(x + lean / 2, y, 2.4), at(x + lean / 2 + 2, y, 2.2), 2.6 * mm, 2.2 * mm)
  end
  return shapes.join(bodies, 3 * mm), at(-44, -16, -3), at(50, 16, 83)
end

--- A bottle opener, about 85 mm long and 12 mm thick, flat in z.
function shapes.opener()
  local mm = 1e-3
  local function slab(x0, y0, x1, y1, h)
    return shapes.box({x0 * mm, y0 * mm, -h * mm}, {x1 * mm, y1 * mm, h * mm})
  end
  local body = shapes.join({
    slab(-40, -7, 20, 7, 4),
    slab(15, -17, 45, 17, 4),
  }, 8 * mm)
  local mouth = shapes.join({slab(22, -10, 38, 10, 9), slab(18, -3, 24, 3, 9)}, 0)
  return shapes.cut(body, mouth), {-0.046, -0.022, -0.01}, {0.052, 0.022, 0.01}
end

arguments.functions("shapes.", shapes, {sphere = "centre: triple, radius: number",
  limb = "a: triple, b: triple, ra: number, rb?: number", box = "min: triple, max: triple",
  join = "bodies: table, rounding?: number", cut = "body: function, tool: function"})

return shapes
