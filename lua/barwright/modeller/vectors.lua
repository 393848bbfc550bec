-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Vectors in space as lists of three numbers, and frames of them.
local core = require "barwright.core"

local vectors = {}

--- Whether a value is a list of three finite numbers.
function vectors.is(value)
  if type(value) ~= "table" or #value ~= 3 then return false end
  for k = 1, 3 do
    local x = value[k]
    if type(x) ~= "number" or x ~= x or math.abs(x) == math.huge then return false end
  end
  return true
end

--- A vector that an option gives; raises where it is none.
function vectors.check(where, key, value)
  if vectors.is(value) then return value end
  core.raise(("%s: option '%s': three finite numbers {x, y, z} expected, got %s"):format(where, key,
    core.got(value)))
end

function vectors.dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end

function vectors.cross(a, b)
  return {a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1]}
end

function vectors.norm(a) return math.sqrt(vectors.dot(a, a)) end

--- a + f b
function vectors.add(a, b, f)
  f = f or 1
  return {a[1] + f * b[1], a[2] + f * b[2], a[3] + f * b[3]}
end

--- The vector over its length, and the length.
function vectors.unit(a)
  local size = vectors.norm(a)
  return {a[1] / size, a[2] / size, a[3] / size}, size
end

--- Turns a vector by the smallest rotation that takes the unit vector `from` to `to`.
function vectors.turned(a, from, to)
  local cross, cos = vectors.cross(from, to), vectors.dot(from, to)
  local k = vectors.dot(cross, a) / (1 + cos)
  local moved = vectors.cross(cross, a)
  return {cos * a[1] + moved[1] + k * cross[1], cos * a[2] + moved[2] + k * cross[2],
    cos * a[3] + moved[3] + k * cross[3]}
end

--- Turns a vector about a unit axis by an angle (rad).
function vectors.about(a, axis, angle)
  local cos, sin = math.cos(angle), math.sin(angle)
  local cross, along = vectors.cross(axis, a), vectors.dot(axis, a) * (1 - cos)
  return {cos * a[1] + sin * cross[1] + along * axis[1], cos * a[2] + sin * cross[2] + along * axis[2],
    cos * a[3] + sin * cross[3] + along * axis[3]}
end

--- Two unit vectors x, y with x × y along the unit vector z; y is as near to `up` as it can be, by default the z
--- axis, or the y axis where z is the z axis. nil where z is along `up`.
function vectors.frame(z, up)
  up = up or (math.abs(z[3]) > 1 - 1e-12 and {0, 1, 0} or {0, 0, 1})
  local x, size = vectors.unit(vectors.cross(up, z))
  if size <= 1e-9 * vectors.norm(up) then return nil end
  return x, vectors.cross(z, x)
end

return vectors
