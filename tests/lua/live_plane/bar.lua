-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A bar of a metallophone.
local bw = require "barwright"
local outline = assert(bw.outline.rectangle {width = 0.2, height = 0.03, radius = 4e-3})
return assert(bw.responsive.metallophone {outline = outline, thickness = 4e-3, modes = 3,
  material = bw.material.aluminium, elements = 250}), {title = "Bar"}
