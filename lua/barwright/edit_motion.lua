-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How each subdomain lies now against the shape that an incremental system was made at. The engine gives it
-- against rest (subdomains:motion); a system made at an edited shape, as after a refill, counts from
-- there: by the maps that take its bones from then to now, which are one map when the subdomain moved as
-- a whole between the two.
local edit_pose = require "barwright.edit_pose"

local edit_motion = {}

-- Linear part and translation of the map that leads from `before` to `now`, rows of [A | b].
local function between(before, now)
  local function split(map)
    return {map[1], map[2], map[3], map[5], map[6], map[7], map[9], map[10], map[11]},
      {map[4], map[8], map[12]}
  end
  local a, b = split(now)
  local a0, b0 = split(before)
  local linear = edit_pose.multiply(a, edit_pose.inverse(a0))
  local moved = edit_pose.apply(linear, b0)
  return linear, {b[1] - moved[1], b[2] - moved[2], b[3] - moved[3]}
end

local tolerance = 1e-13

-- The one linear map that took all bones from `before` to `now`, or nil. `size` is that of the part.
local function common_map(bones, before, now, size)
  local first, shift
  for _, b in ipairs(bones) do
    local linear, translation = between(before[b], now[b])
    if not first then
      first, shift = linear, translation
    else
      for i = 1, 9 do
        if math.abs(linear[i] - first[i]) > tolerance then return nil end
      end
      for i = 1, 3 do
        if math.abs(translation[i] - shift[i]) > tolerance * size then return nil end
      end
    end
  end
  return first
end

local function largest_coordinate(mesh)
  local box, size = mesh.box, 0
  for i = 1, 3 do size = math.max(size, math.abs(box.min[i]), math.abs(box.max[i])) end
  return size
end

--- What a system made at this shape has to remember.
function edit_motion.begin(shape)
  if shape.at_rest then return {relaxed = {}} end
  local motion, message, details = shape.topology.subdomains:motion(shape.maps, shape.rotations)
  if not motion then return nil, message, details end
  local rotated = {}
  for p, row in ipairs(motion:totable()) do
    rotated[p] = edit_pose.transpose {table.unpack(row, 10, 18)}
  end
  return {maps = shape.maps:totable(), rotated = rotated, relaxed = shape.relaxed,
    size = largest_coordinate(shape.mesh)}
end

--- The rows that bring a system to a shape. A subdomain is reshaped where its bones moved differently,
--- or where its inner nodes are relaxed in one of the two.
function edit_motion.rows(memory, shape)
  local topology = shape.topology
  local reported, message, details = topology.subdomains:motion(shape.maps, shape.rotations)
  if not reported then return nil, message, details end
  local motion = reported:totable()
  local now = memory.maps and shape.maps:totable()
  for p, row in ipairs(motion) do
    if now then
      local linear = common_map(topology.stiffness_subdomain_bones[p], memory.maps, now, memory.size)
      local frame = edit_pose.multiply(memory.rotated[p], {table.unpack(row, 10, 18)})
      table.move(linear or edit_pose.identity, 1, 9, 1, row)
      table.move(frame, 1, 9, 10, row)
      row[19] = linear and 0 or 1
    end
    if shape.relaxed[p] or memory.relaxed[p] then row[19] = 1 end
  end
  return motion
end

return edit_motion
