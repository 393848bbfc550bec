-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Points in space as lists of three numbers.
local points = {}

--- The distance of two points.
function points.distance(a, b)
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end

return points
