-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A kettle, heated from below.
local bw = require "barwright"
local kettle = assert(bw.outline.rectangle {width = 1, height = 1, tags = {bottom = 1, sides = {2, 4}, top = 3}})
return assert(bw.responsive.thermal {outline = kettle, viscosity = 1e-3, diffusivity = 1e-3, expansion = 1,
  gravity = {0, -1}, step = 0.05, elements = 800, conditions = {bottom = {x = 0, y = 0, temperature = 1},
    sides = "wall", top = {x = 0, y = 0, temperature = 0}}}), {title = "Kettle"}
