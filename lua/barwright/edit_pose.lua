-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Poses of a skeleton as tables. A pose is a list of a row for every bone: the rotation (nine numbers
-- by rows), the scale along the bone's axes (three), the translation of its head (three). Rows are
-- never written to once they are in a pose: an edit copies what it changes.
local core = require "barwright.core"

local raise = core.raise
local edit_pose = {}

local identity = {1, 0, 0, 0, 1, 0, 0, 0, 1}
edit_pose.identity = identity

-- ---- 3 x 3 matrices of nine numbers ----------------------------------------------------------------

function edit_pose.multiply(a, b)
  local out = {}
  for i = 0, 6, 3 do
    for j = 1, 3 do
      out[i + j] = a[i + 1] * b[j] + a[i + 2] * b[3 + j] + a[i + 3] * b[6 + j]
    end
  end
  return out
end

function edit_pose.transpose(a)
  return {a[1], a[4], a[7], a[2], a[5], a[8], a[3], a[6], a[9]}
end

function edit_pose.apply(a, x)
  return {
    a[1] * x[1] + a[2] * x[2] + a[3] * x[3],
    a[4] * x[1] + a[5] * x[2] + a[6] * x[3],
    a[7] * x[1] + a[8] * x[2] + a[9] * x[3],
  }
end

function edit_pose.inverse(a)
  local out = {
    a[5] * a[9] - a[6] * a[8], a[3] * a[8] - a[2] * a[9], a[2] * a[6] - a[3] * a[5],
    a[6] * a[7] - a[4] * a[9], a[1] * a[9] - a[3] * a[7], a[3] * a[4] - a[1] * a[6],
    a[4] * a[8] - a[5] * a[7], a[2] * a[7] - a[1] * a[8], a[1] * a[5] - a[2] * a[4],
  }
  local determinant = a[1] * out[1] + a[2] * out[4] + a[3] * out[7]
  for i = 1, 9 do out[i] = out[i] / determinant end
  return out
end

-- Rows made orthonormal again, so that a thousand turns leave no shear behind.
local function orthonormal(a)
  local function length(i)
    return math.sqrt(a[i] * a[i] + a[i + 1] * a[i + 1] + a[i + 2] * a[i + 2])
  end
  local n = length(1)
  local x1, x2, x3 = a[1] / n, a[2] / n, a[3] / n
  local d = x1 * a[4] + x2 * a[5] + x3 * a[6]
  local y1, y2, y3 = a[4] - d * x1, a[5] - d * x2, a[6] - d * x3
  n = math.sqrt(y1 * y1 + y2 * y2 + y3 * y3)
  y1, y2, y3 = y1 / n, y2 / n, y3 / n
  return {x1, x2, x3, y1, y2, y3, x2 * y3 - x3 * y2, x3 * y1 - x1 * y3, x1 * y2 - x2 * y1}
end

--- The rotation about an axis of any length above 0 by an angle in radians.
function edit_pose.about(axis, angle)
  local largest = math.max(math.abs(axis[1]), math.abs(axis[2]), math.abs(axis[3]))
  local x, y, z = axis[1] / largest, axis[2] / largest, axis[3] / largest
  local n = math.sqrt(x * x + y * y + z * z)
  x, y, z = x / n, y / n, z / n
  local c, s = math.cos(angle), math.sin(angle)
  local k = 1 - c
  return {
    c + k * x * x, k * x * y - s * z, k * x * z + s * y,
    k * x * y + s * z, c + k * y * y, k * y * z - s * x,
    k * x * z - s * y, k * y * z + s * x, c + k * z * z,
  }
end

--- Axis and angle in radians of a rotation, for showing it.
function edit_pose.axis_and_angle(r)
  local x, y, z = r[8] - r[6], r[3] - r[7], r[4] - r[2]
  local sine = math.sqrt(x * x + y * y + z * z) / 2
  local angle = math.atan(sine, (r[1] + r[5] + r[9] - 1) / 2)
  if sine > 1e-9 then return {x / (2 * sine), y / (2 * sine), z / (2 * sine)}, angle end
  if angle < 1 then return {0, 0, 1}, 0 end
  -- Half a turn: the axis is the largest column of (r + 1) / 2.
  local column = {1, 2, 3}
  table.sort(column, function(i, j) return r[4 * i - 3] > r[4 * j - 3] end)
  local i = column[1]
  local axis = {r[i] + (i == 1 and 1 or 0), r[3 + i] + (i == 2 and 1 or 0), r[6 + i] + (i == 3 and 1 or 0)}
  local n = math.sqrt(axis[1] ^ 2 + axis[2] ^ 2 + axis[3] ^ 2)
  return {axis[1] / n, axis[2] / n, axis[3] / n}, angle
end

-- ---- rows ------------------------------------------------------------------------------------------

local function row(rotation, scale, translation)
  local out = {}
  for i = 1, 9 do out[i] = rotation[i] end
  for i = 1, 3 do out[9 + i], out[12 + i] = scale[i], translation[i] end
  return out
end

function edit_pose.rotation(bone)
  return {table.unpack(bone, 1, 9)}
end

function edit_pose.scale(bone)
  return {table.unpack(bone, 10, 12)}
end

function edit_pose.translation(bone)
  return {table.unpack(bone, 13, 15)}
end

function edit_pose.rest(bones)
  local pose = {}
  for b = 1, bones do pose[b] = row(identity, {1, 1, 1}, {0, 0, 0}) end
  return pose
end

--- A pose with another row for one bone.
function edit_pose.with(pose, bone, rotation, scale, translation)
  local out = table.move(pose, 1, #pose, 1, {})
  local old = pose[bone]
  out[bone] = row(rotation and orthonormal(rotation) or edit_pose.rotation(old),
    scale or edit_pose.scale(old), translation or edit_pose.translation(old))
  return out
end

--- Whether all bones are at rest.
function edit_pose.all_at_rest(pose)
  local rest = row(identity, {1, 1, 1}, {0, 0, 0})
  for _, bone in ipairs(pose) do
    for i = 1, #rest do
      if bone[i] ~= rest[i] then return false end
    end
  end
  return true
end

-- ---- what a script gives ---------------------------------------------------------------------------

local function finite(value)
  return type(value) == "number" and value == value and math.abs(value) < math.huge
end

--- Three finite numbers, or an error of the function called `where`.
function edit_pose.read_vector(where, value)
  if core.class_name(value) == "array" then value = {value[1], value[2], value[3]} end
  if type(value) == "table" and #value == 3 and finite(value[1]) and finite(value[2])
    and finite(value[3]) then
    return {value[1] + 0.0, value[2] + 0.0, value[3] + 0.0}
  end
  raise(("%s: three finite numbers {x, y, z} expected, got %s"):format(where, core.got(value)))
end

--- Three positive factors, or one for all.
function edit_pose.read_scale(where, value)
  if finite(value) then value = {value, value, value} end
  local scale = edit_pose.read_vector(where, value)
  for i = 1, 3 do
    if scale[i] <= 0 then
      raise(("%s: factors above 0 expected, got %g"):format(where, scale[i]))
    end
  end
  return scale
end

local function read_matrix(where, value)
  local out = {}
  for i = 1, 3 do
    local r = edit_pose.read_vector(where .. ": a row", value[i])
    for j = 1, 3 do out[3 * (i - 1) + j] = r[j] end
  end
  for i = 0, 6, 3 do
    for j = 0, 6, 3 do
      local product = out[i + 1] * out[j + 1] + out[i + 2] * out[j + 2] + out[i + 3] * out[j + 3]
      if math.abs(product - (i == j and 1 or 0)) > 1e-6 then
        raise(("%s: a rotation with rows of length 1 at right angles expected, got rows %d and %d with the "
          .. "product %.7g"):format(where, i // 3 + 1, j // 3 + 1, product))
      end
    end
  end
  local out2 = orthonormal(out)
  if out[7] * out2[7] + out[8] * out2[8] + out[9] * out2[9] < 0 then
    raise(("%s: a rotation expected, got a reflection"):format(where))
  end
  return out2
end

local known_turns = {axis = true, degrees = true, radians = true, x = true, y = true, z = true}

--- {axis =, degrees = | radians =}, {x =, y =, z =} in degrees, turned about x first, or three rows.
function edit_pose.read_rotation(where, value)
  if type(value) ~= "table" then raise(("%s: a table expected, got %s"):format(where, core.got(value))) end
  if #value == 3 then return read_matrix(where, value) end
  for key in pairs(value) do
    if not known_turns[key] then
      raise(("%s: unknown option '%s': {axis =, degrees =}, {x =, y =, z =} or three rows expected")
        :format(where, tostring(key)))
    end
  end
  if value.axis then
    local axis = edit_pose.read_vector(where .. ": axis", value.axis)
    if axis[1] == 0 and axis[2] == 0 and axis[3] == 0 then
      raise(where .. ": an axis expected, got {0, 0, 0}, which has no direction")
    end
    local angle = value.radians or value.degrees
    if value.x or value.y or value.z then raise(where .. ": axis, or x, y and z, expected, got both") end
    if not finite(angle) or value.radians and value.degrees then
      raise(("%s: axis, and one of degrees and radians, expected, got degrees = %s and radians = %s"):format(where,
        core.got(value.degrees), core.got(value.radians)))
    end
    return edit_pose.about(axis, value.radians or math.rad(angle))
  end
  local out = identity
  for k, axis in ipairs {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}} do
    local degrees = value[("xyz"):sub(k, k)]
    if degrees ~= nil then
      if not finite(degrees) then
        raise(("%s: a number of degrees expected, got %s"):format(where, core.got(degrees)))
      end
      out = edit_pose.multiply(edit_pose.about(axis, math.rad(degrees)), out)
    end
  end
  if value.degrees or value.radians or next(value) == nil then
    raise(("%s: {axis =, degrees =}, {x =, y =, z =} or three rows expected, got %s"):format(where,
      next(value) == nil and "an empty table" or "an angle without an axis"))
  end
  return out
end

return edit_pose
