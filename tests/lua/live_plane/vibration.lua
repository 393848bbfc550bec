-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A house with a window, on ground that shakes.
local bw = require "barwright"
local rubber = bw.material.isotropic {name = "rubber", young = 1e6, poisson = 0.3, density = 1000}
local outline = assert(bw.outline {points = {{0, 0}, {0.1, 0}, {0.1, 0.2}, {0, 0.2}}, tags = {ground = 1},
  holes = {bw.outline.rectangle {min = {0.03, 0.12}, max = {0.07, 0.17}, name = "window"}}})
return assert(bw.responsive.vibration {outline = outline, material = rubber, elements = 500, ground = "ground",
  ground_motion = {x = "1e-3*sin(40*t)"}, step = 2e-3, damping = {1, 1e-4}}), {title = "House"}
