-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A strip with a hole, pulled at its right end.
local bw = require "barwright"
local outline = assert(bw.outline {points = {{0, 0}, {0.2, 0}, {0.2, 0.1}, {0, 0.1}}, tags = {left = 4, right = 2},
  holes = {bw.outline.circle {centre = {0.06, 0.05}, radius = 0.02, name = "hole"}}})
return assert(bw.responsive.steady {outline = outline, material = bw.material.pla, thickness = 4e-3,
  elements = 1000, conditions = {left = "fixed", right = {traction = {5e6, 0}}}}),
  {title = "Strip", von_mises = 30e6}
