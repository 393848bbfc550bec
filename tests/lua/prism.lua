-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Surfaces of prisms.
local bw = require "barwright"

-- A prism over a star-shaped profile, its caps fans around `centre`.
return function(profile, centre, height)
  local n, points, triangles = #profile, {}, {}
  for i = 1, n + 1 do
    local p = profile[i] or centre
    points[#points + 1] = {p[1], p[2], 0}
    points[#points + 1] = {p[1], p[2], height}
  end
  for i = 1, n do
    local a, b = 2 * i - 1, 2 * (i % n) + 1
    for _, t in ipairs {{a, b, b + 1}, {a, b + 1, a + 1}, {2 * n + 1, b, a}, {2 * n + 2, a + 1, b + 1}} do
      triangles[#triangles + 1] = t
    end
  end
  return assert(bw.surface.new {points = points, triangles = triangles})
end
