-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bodies by formula: signed distance functions f(x, y, z), negative inside, to put together and hand
-- to bw.surface.implicit. Lengths in metres. A second result is the name of the face that is nearest, or nil.
local arguments = require "barwright.arguments"
local core = require "barwright.core"

local raise = core.raise

local shapes = {}

local sqrt, min, max, abs = math.sqrt, math.min, math.max, math.abs

local function check_bodies(name, bodies)
  if #bodies == 0 then
    raise(("shapes.%s: bodies: a list of one function or more expected, got an empty list"):format(name))
  end
  for i = 1, #bodies do
    if type(bodies[i]) ~= "function" then
      raise(("shapes.%s: bodies: entry %d: a function expected, got %s"):format(name, i, core.got(bodies[i])))
    end
  end
end

local function check_size(name, what, value, zero)
  if not (value > 0 or zero and value == 0) or value == math.huge then
    raise(("shapes.%s: %s: a finite length %s expected, got %s"):format(name, what,
      zero and "of 0 or more" or "above 0", core.got(value)))
  end
end

--- The unit vector along v and its length.
local function direction(name, what, v)
  local length = sqrt(v[1] * v[1] + v[2] * v[2] + v[3] * v[3])
  if not (length > 0 and length < math.huge) then
    raise(("shapes.%s: %s: a vector of a finite length above 0 expected"):format(name, what))
  end
  return v[1] / length, v[2] / length, v[3] / length, length
end

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

function shapes.named(body, name)
  if name == "" then raise "shapes.named: name: a text that is not empty expected" end
  local by_place = type(name) == "function" and name
  return function(x, y, z)
    local d, face = body(x, y, z)
    if by_place then return d, by_place(x, y, z) or face end
    return d, name
  end
end

--- Union of bodies whose joints are rounded over the given distance.
function shapes.join(bodies, rounding, name)
  check_bodies("join", bodies)
  local count = #bodies
  rounding = rounding or 0
  return function(x, y, z)
    local d, face = bodies[1](x, y, z)
    for i = 2, count do
      local e, other = bodies[i](x, y, z)
      local h = rounding > 0 and max(rounding - abs(d - e), 0) / rounding or 0
      if e < d then face = other end
      if h > 0 and name then face = name end
      d = min(d, e) - h * h * rounding / 4
    end
    return d, face
  end
end

-- The larger of two values where their sum of squares rounds the edge with an arc of the radius; of planes at
-- right angles it is the distance. And whether the arc is nearest.
local function rounded_max(a, b, radius)
  local u, v = max(a + radius, 0), max(b + radius, 0)
  return min(-radius, max(a, b)) + sqrt(u * u + v * v), u > 0 and v > 0
end

-- The union whose concave edges are arcs of the radius, and whether the arc is nearest.
local function fillet_of_two(a, b, radius)
  local u, v = max(radius - a, 0), max(radius - b, 0)
  return max(radius, min(a, b)) - sqrt(u * u + v * v), u > 0 and v > 0
end

function shapes.fillet(bodies, radius, name)
  check_bodies("fillet", bodies)
  check_size("fillet", "radius", radius)
  return function(x, y, z)
    local d, face = bodies[1](x, y, z)
    for i = 2, #bodies do
      local e, other = bodies[i](x, y, z)
      local value, rounded = fillet_of_two(d, e, radius)
      if e < d then face = other end
      if rounded and name then face = name end
      d = value
    end
    return d, face
  end
end

function shapes.intersect(bodies, radius, name)
  check_bodies("intersect", bodies)
  radius = radius or 0
  check_size("intersect", "radius", radius, true)
  return function(x, y, z)
    local d, face = bodies[1](x, y, z)
    for i = 2, #bodies do
      local e, other = bodies[i](x, y, z)
      local value, rounded = rounded_max(d, e, radius)
      if e > d then face = other end
      if rounded and radius > 0 and name then face = name end
      d = value
    end
    return d, face
  end
end

function shapes.cut(body, tool, radius, name)
  radius = radius or 0
  check_size("cut", "radius", radius, true)
  return function(x, y, z)
    local d, face = body(x, y, z)
    local e, other = tool(x, y, z)
    if -e > d then face = other end
    if radius == 0 then return max(d, -e), face end
    local value, rounded = rounded_max(d, -e, radius)
    return value, rounded and name or face
  end
end

function shapes.offset(body, distance)
  return function(x, y, z)
    local d, face = body(x, y, z)
    return d - distance, face
  end
end

function shapes.shell(body, thickness, name)
  check_size("shell", "thickness", thickness)
  return function(x, y, z)
    local d, face = body(x, y, z)
    if -d - thickness > d then return -d - thickness, name end
    return d, face
  end
end

--- Height along the axis from a, and distance from it: the coordinates of bodies of revolution.
local function around(name, a, b)
  local ux, uy, uz, length = direction(name, "a and b", {b[1] - a[1], b[2] - a[2], b[3] - a[3]})
  local ax, ay, az = a[1], a[2], a[3]
  return length, function(x, y, z)
    local px, py, pz = x - ax, y - ay, z - az
    local h = px * ux + py * uy + pz * uz
    local qx, qy, qz = px - h * ux, py - h * uy, pz - h * uz
    return h, sqrt(qx * qx + qy * qy + qz * qz)
  end
end

function shapes.cylinder(a, b, radius)
  check_size("cylinder", "radius", radius)
  local length, coordinates = around("cylinder", a, b)
  return function(x, y, z)
    local h, r = coordinates(x, y, z)
    local dh, dr = abs(h - length / 2) - length / 2, r - radius
    local oh, outside = max(dh, 0), max(dr, 0)
    return sqrt(oh * oh + outside * outside) + min(max(dh, dr), 0)
  end
end

function shapes.cone(a, b, ra, rb)
  check_size("cone", "ra", ra, true)
  check_size("cone", "rb", rb, true)
  if ra == 0 and rb == 0 then raise "shapes.cone: ra, rb: one of the radii must be above 0" end
  local length, coordinates = around("cone", a, b)
  local slope = rb - ra
  local side2 = length * length + slope * slope
  return function(x, y, z)
    local h, r = coordinates(x, y, z)
    -- the nearest points of the nearer end and of the side, in the half-plane of h and r
    local eh, er = abs(h - length / 2) - length / 2, r - min(r, h < length / 2 and ra or rb)
    local t = max(0, min(1, (h * length + (r - ra) * slope) / side2))
    local sh, sr = h - t * length, r - ra - t * slope
    local inside = eh < 0 and r < ra + slope * h / length
    return (inside and -1 or 1) * sqrt(min(eh * eh + er * er, sh * sh + sr * sr))
  end
end

function shapes.torus(centre, axis, radius, tube)
  check_size("torus", "radius", radius)
  check_size("torus", "tube", tube)
  local ux, uy, uz = direction("torus", "axis", axis)
  local _, coordinates = around("torus", centre, {centre[1] + ux, centre[2] + uy, centre[3] + uz})
  return function(x, y, z)
    local h, r = coordinates(x, y, z)
    return sqrt(h * h + (r - radius) ^ 2) - tube
  end
end

function shapes.translate(body, by)
  local dx, dy, dz = by[1], by[2], by[3]
  return function(x, y, z)
    return body(x - dx, y - dy, z - dz)
  end
end

function shapes.rotate(body, axis, angle, about)
  local ux, uy, uz = direction("rotate", "axis", axis)
  about = about or {0, 0, 0}
  local cx, cy, cz = about[1], about[2], about[3]
  local c, s = math.cos(angle), -math.sin(angle) -- the body is asked at the point rotated back
  return function(x, y, z)
    local px, py, pz = x - cx, y - cy, z - cz
    local k = (1 - c) * (ux * px + uy * py + uz * pz)
    return body(cx + c * px + s * (uy * pz - uz * py) + k * ux,
      cy + c * py + s * (uz * px - ux * pz) + k * uy,
      cz + c * pz + s * (ux * py - uy * px) + k * uz)
  end
end

function shapes.mirror(body, normal, point)
  local nx, ny, nz = direction("mirror", "normal", normal)
  point = point or {0, 0, 0}
  local offset = nx * point[1] + ny * point[2] + nz * point[3]
  return function(x, y, z)
    local d = 2 * (nx * x + ny * y + nz * z - offset)
    return body(x - d * nx, y - d * ny, z - d * nz)
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
  join = "bodies: table, rounding?: number, name?: string",
  cut = "body: function, tool: function, radius?: number, name?: string",
  fillet = "bodies: table, radius: number, name?: string",
  intersect = "bodies: table, radius?: number, name?: string", named = "body: function, name: string|function",
  offset = "body: function, distance: number", shell = "body: function, thickness: number, name?: string",
  cylinder = "a: triple, b: triple, radius: number", cone = "a: triple, b: triple, ra: number, rb: number",
  torus = "centre: triple, axis: triple, radius: number, tube: number", translate = "body: function, by: triple",
  rotate = "body: function, axis: triple, angle: number, about?: triple",
  mirror = "body: function, normal: triple, point?: triple"})

return shapes
