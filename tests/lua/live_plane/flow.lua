-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A cylinder in a stream.
local bw = require "barwright"
local tunnel = assert(bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}},
  tags = {sides = {1, 3}, outlet = 2, inlet = 4},
  holes = {bw.outline.circle {centre = {0.6, 0.5}, radius = 0.12, name = "cylinder", tag = "cylinder"}}})
return assert(bw.responsive.flow {outline = tunnel, viscosity = 2e-3, step = 0.02, elements = 1500,
  conditions = {inlet = {x = 1, y = 0}, sides = {y = 0}, cylinder = "wall"}}), {title = "Stream"}
