-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a part falls on: rigid surfaces as lines of pictures, turned, and the gap to them. docs/theory/drop.md
local core = require "barwright.core"

local obstacle = {}

local SEGMENTS = 48 -- of an arc
local ROUNDS, SETTLED = 100, 1e-7 -- of a search for a place, and the part of the way that it may leave

local function cross(a, b)
  return {a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1]}
end

local function unit(a)
  local length = math.sqrt(a[1] ^ 2 + a[2] ^ 2 + a[3] ^ 2)
  return {a[1] / length, a[2] / length, a[3] / length}
end

-- Two directions across one of length 1.
local function frame_of(axis)
  local least = 1
  for k = 2, 3 do if math.abs(axis[k]) < math.abs(axis[least]) then least = k end end
  local e = {0, 0, 0}
  e[least] = 1
  local u = unit(cross(axis, e))
  return u, cross(axis, u)
end

local function at(p, a, u, b, v)
  return {p[1] + a * u[1] + b * v[1], p[2] + a * u[2] + b * v[2], p[3] + a * u[3] + b * v[3]}
end

-- From -angle to angle about the direction u, towards v.
local function arc(centre, radius, u, v, angle)
  local line = {}
  for i = 0, SEGMENTS do
    local t = angle * (2 * i / SEGMENTS - 1)
    line[i + 1] = at(centre, radius * math.cos(t), u, radius * math.sin(t), v)
  end
  return line
end

--- How it is called.
function obstacle.name(surface)
  local radius = surface.radius and core.quantity(surface.radius, "m")
  if surface.kind == "plane" then return "rigid plane" end
  return (surface.kind == "sphere" and "rigid peg of radius %s" or "rigid edge of radius %s"):format(radius)
end

-- The half of a sphere, as far as half a size.
local function sphere(centre, radius, n, size)
  local u, v = frame_of(n)
  local angle = math.min(math.pi / 2, size / radius)
  local foot = at(centre, radius * math.cos(angle), n, 0, n)
  return {arc(centre, radius, n, u, angle), arc(centre, radius, n, v, angle),
    arc(foot, radius * math.sin(angle), u, v, math.pi)}
end

-- The half of a cylinder about a point of its axis.
local function cylinder(centre, radius, axis, n, size)
  local first, last = at(centre, -size, axis, 0, n), at(centre, size, axis, 0, n)
  local v, angle = cross(axis, n), math.min(math.pi / 2, size / radius)
  local lines = {arc(first, radius, n, v, angle), arc(last, radius, n, v, angle)}
  for _, k in ipairs {1, SEGMENTS / 2 + 1, SEGMENTS + 1} do lines[#lines + 1] = {lines[1][k], lines[2][k]} end
  return lines
end

local function plane(foot, normal, size)
  local u, v = frame_of(normal)
  return {{at(foot, size, u, size, v), at(foot, size, u, -size, v), at(foot, -size, u, -size, v),
    at(foot, -size, u, size, v), at(foot, size, u, size, v)}}
end

--- It as lines near a place, for pictures of a mesh: options `lines` and `line_name` of bw.picture.
function obstacle.drawn(surface, mesh, place)
  local box, size, p, a = mesh.box, 0, surface.point, surface.direction or {0, 0, 0}
  for k = 1, 3 do size = size + (box.max[k] - box.min[k]) ^ 2 / 4 end
  size = math.sqrt(size)
  local along = (place[1] - p[1]) * a[1] + (place[2] - p[2]) * a[2] + (place[3] - p[3]) * a[3]
  local lines
  if surface.kind == "plane" then
    lines = plane(at(place, -along, a, 0, a), a, size)
  else
    local foot = at(p, along, a, 0, a)
    local n = unit {place[1] - foot[1], place[2] - foot[2], place[3] - foot[3]}
    lines = surface.kind == "sphere" and sphere(p, surface.radius, n, size)
      or cylinder(foot, surface.radius, a, n, size)
  end
  return {lines = lines, line_name = obstacle.name(surface)}
end

--- The gap between each node of a mesh and the surface (m).
function obstacle.gap(surface, mesh)
  local nodes, p, a = mesh.nodes, surface.point, surface.direction or {0, 0, 0}
  local given = {x = nodes:column(1), y = nodes:column(2), z = nodes:column(3), p = p[1], q = p[2], r = p[3],
    a = a[1], b = a[2], c = a[3]}
  given.s = core.array.map("(x - p) * a + (y - q) * b + (z - r) * c", given)
  if surface.kind == "plane" then return given.s end
  given.l = surface.radius
  return core.array.map("sqrt((x - p - s * a)^2 + (y - q - s * b)^2 + (z - r - s * c)^2) - l", given)
end

--- A displacement of the nodes (array of n x 3) by which the part, drawn at `factor` times it, lies on the surface
--- without entering it: the displacement `u` and a motion of the whole part along `up`, of length 1.
function obstacle.above(surface, mesh, u, factor, up)
  local nodes, rows, way = mesh.nodes, u:totable(), 0
  local function moved()
    local out = {}
    for i, row in ipairs(rows) do out[i] = {row[1] + way * up[1], row[2] + way * up[2], row[3] + way * up[3]} end
    return core.array.new(out)
  end
  -- A motion changes no gap by more than its length.
  local shown = moved()
  for _ = 1, ROUNDS do
    local change = -obstacle.gap(surface, {nodes = nodes + factor * shown}):min() / factor
    way = way + change
    shown = moved()
    if math.abs(change) <= SETTLED * math.abs(way) then break end
  end
  return shown
end

--- The surface in the axes of a part that falls along `down` (of length 1), of one given in axes whose z is up;
--- `beside`: the direction of its x, of any length and not along `down`.
function obstacle.turned(surface, down, beside)
  local z = {-down[1], -down[2], -down[3]}
  local y = unit(cross(z, beside))
  local x, d = cross(y, z), surface.direction or {0, 0, 0}
  local direction = {}
  for k = 1, 3 do direction[k] = d[1] * x[k] + d[2] * y[k] + d[3] * z[k] end
  if surface.kind == "plane" then return core.rigid.plane {normal = direction} end
  if surface.kind == "sphere" then return core.rigid.sphere {radius = surface.radius} end
  return core.rigid.cylinder {axis = direction, radius = surface.radius}
end

return obstacle
