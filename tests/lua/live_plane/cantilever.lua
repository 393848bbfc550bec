-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A soft beam that sags under its weight; its end is to come to a mark.
local bw = require "barwright"
local soft = bw.material.isotropic {name = "soft", young = 1e6, poisson = 0, density = 1000}
local outline = assert(bw.outline.rectangle {width = 0.4, height = 0.02, tags = {left = 4}})
return assert(bw.responsive.cantilever {outline = outline, material = soft, order = 2, elements = 200,
  gravity = {0, -1}, conditions = {left = "fixed"}}),
  {title = "Beam", goal = assert(bw.outline.circle {centre = {0.45, -0.14}, radius = 0.02})}
