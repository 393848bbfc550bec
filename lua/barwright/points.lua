-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Points in space as lists of three numbers.
local points = {}

--- The distance of two points.
function points.distance(a, b)
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end

--- Appends to `chosen` the first entries of `list` (tables with a point `at`) that `wanted` accepts and that lie
--- farther than `apart` from every chosen one, up to `count` in all. Returns `chosen`.
function points.append_apart(chosen, list, count, apart, wanted)
  for _, entry in ipairs(list) do
    local free = #chosen < count and wanted(entry)
    for _, other in ipairs(chosen) do free = free and points.distance(entry.at, other.at) > apart end
    if free then chosen[#chosen + 1] = entry end
  end
  return chosen
end

return points
