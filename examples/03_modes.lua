-- SPDX-License-Identifier: MIT
-- Lesson 3: natural frequencies and modes.
--   build/barwright examples/03_modes.lua
--
-- A free aluminium bar of 300 x 30 x 6 mm. A free body has six rigid-body motions of frequency zero:
-- they are recognised and left out. Thin-beam theory gives the bending modes:
-- f = (beta L)^2 / (2 pi L^2) sqrt(E I / (rho A)), with cos(beta L) cosh(beta L) = 1.
local bw = require "barwright"

local L, b, h = 0.300, 0.030, 0.006
local mesh = bw.mesh.box {min = {0, 0, 0}, max = {L, b, h}, cells = {40, 4, 1}, order = 2}
local part = bw.model {mesh = mesh, material = bw.material.aluminium}

local modes = assert(part:modes {count = 6})
print(modes)
for i = 1, modes.count do
  print(("mode %d: %8.2f Hz, residual %.1e"):format(i, modes.frequencies[i], modes.residuals[i]))
end

local beta = 4.730040744862704
local I, A = b * h ^ 3 / 12, b * h
local beam = beta ^ 2 / (2 * math.pi * L ^ 2) * math.sqrt(70e9 * I / (2700 * A))
print(("thin-beam theory for the first: %.2f Hz"):format(beam))
assert(math.abs(modes.frequencies[1] / beam - 1) < 0.02)
-- Next: clamp one end with part:fix(...) and ask again: no rigid-body motion is left.
