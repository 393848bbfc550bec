-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the modes of a plate are: bending along its long axis, or torsion about it.
--
-- In slices across the long axis the mean of the slope along it is what bending has, and the mean of the
-- slope across it what torsion has: a slice that only curves has no mean slope across. The larger of the two,
-- squared and summed over the slices, names the mode. Modes of one kind are numbered from the lowest, so
-- that a mode keeps its name where one of the other kind passes it.
local mode_kinds = {}

local SLICES = 16

--- Unit vector along which an outline is longest, by its second moments.
function mode_kinds.long_axis(outline)
  local m = outline.second_moment
  local angle = 0.5 * math.atan(-2 * m.xy, m.xx - m.yy)
  -- moment about the axis at `angle` is least: the shape lies along it
  local function about(t)
    return m.xx * math.cos(t) ^ 2 + m.yy * math.sin(t) ^ 2 - 2 * m.xy * math.sin(t) * math.cos(t)
  end
  if about(angle) > about(angle + math.pi / 2) then angle = angle + math.pi / 2 end
  return {math.cos(angle), math.sin(angle)}
end

-- The slice that each node is in.
local function slices(points, axis)
  local along, min, max, slice = {}, math.huge, -math.huge, {}
  for i, p in ipairs(points) do
    along[i] = p[1] * axis[1] + p[2] * axis[2]
    min, max = math.min(min, along[i]), math.max(max, along[i])
  end
  for i, s in ipairs(along) do
    slice[i] = math.min(SLICES, 1 + math.floor(SLICES * (s - min) / (max - min)))
  end
  return slice
end

local function kind_of(shape, slice, axis)
  local count, along, across = {}, {}, {}
  for k = 1, SLICES do count[k], along[k], across[k] = 0, 0, 0 end
  for i, row in ipairs(shape) do
    local k = slice[i]
    count[k] = count[k] + 1
    along[k] = along[k] + row[2] * axis[1] + row[3] * axis[2]
    across[k] = across[k] - row[2] * axis[2] + row[3] * axis[1]
  end
  local bending, torsion = 0, 0
  for k = 1, SLICES do
    if count[k] > 0 then
      bending, torsion = bending + along[k] ^ 2 / count[k], torsion + across[k] ^ 2 / count[k]
    end
  end
  return torsion > bending and "torsion" or "bending"
end

--- {mode, frequency, kind, number} of each mode that a bar has, in their order.
function mode_kinds.of(bar)
  local axis = mode_kinds.long_axis(bar.outline)
  local slice = slices(bar.points:totable(), axis)
  local list, number = {}, {bending = 0, torsion = 0}
  for mode, frequency in ipairs(bar.frequencies:totable()) do
    local kind = kind_of(bar:mode(mode):totable(), slice, axis)
    number[kind] = number[kind] + 1
    list[mode] = {mode = mode, frequency = frequency, kind = kind, number = number[kind]}
  end
  return list
end

--- The numbers of the `count` lowest modes of a kind; nil where the bar has fewer.
function mode_kinds.lowest(bar, kind, count)
  local found = {}
  for _, one in ipairs(mode_kinds.of(bar)) do
    if one.kind == kind and #found < count then found[#found + 1] = one.mode end
  end
  return #found == count and found or nil
end

return mode_kinds
