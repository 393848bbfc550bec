-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A soft bar with hard fibres that wind about its axis: pulled, it twists (data-driven, figure 13, which
-- does not say how many fibres or how thick: fibre_sets.lua shows what other ones give).
local winding = require "winding"

local scene = winding {rings = {{16, 12}, {8, 6}}, radius = 1.6, turns = 1}
scene.words = "a soft bar with twenty-four hard fibres that wind about its axis, pulled"
scene.transient = {words = "let go from the pulled shape, four times as slow as it is", fixed = scene.fixed,
  step = 0.01, steps = 60, each = 2} -- fine = true: beside the fine bar, some 20 s of the processor a step

return {fibers = scene}
