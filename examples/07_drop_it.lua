-- SPDX-License-Identifier: MIT
-- Lesson 7: drop it a thousand times.
--   build/barwright examples/07_drop_it.lua
--
-- The paper dropped printed models onto a peg and looked where they broke. Here: random orientations,
-- an impact where the peg hits, the rest of the body pushing back by its inertia. All drops share one
-- factorisation. Does the map of breakage agree with the weakness map, which knows of no drop?
local bw = require "barwright"
local shapes = bw.shapes

local body = shapes.join({
  shapes.box({-0.03, -0.01, -0.01}, {-0.005, 0.01, 0.01}),
  shapes.box({0.005, -0.01, -0.01}, {0.03, 0.01, 0.01}),
  shapes.limb({-0.01, 0, 0}, {0.01, 0, 0}, 0.004),
}, 0.002)
local surface = assert(bw.surface.implicit(body,
  {min = {-0.04, -0.02, -0.02}, max = {0.04, 0.02, 0.02}, cells = 48}))
local mesh = assert(bw.mesh.fill(surface, {elements = 5000}))
local part = bw.model {mesh = mesh, material = bw.material.green_state_stainless_steel}

local worst = assert(bw.worst_case(part, {modes = 6, regions = 3}))
local drops = assert(bw.drop_test(part, {drops = 300, seed = 1}))
print(worst)
print(drops)
print(("rank correlation with the weakness map: %.2f"):format(drops:correlation(worst)))
