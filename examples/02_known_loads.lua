-- SPDX-License-Identifier: MIT
-- Lesson 2: known supports and loads.
--   build/barwright examples/02_known_loads.lua [FOLDER]
--
-- A cantilever of 120 x 10 x 6 mm, clamped at one end, 5 N down at the other. Beam theory says that
-- the tip goes down by P L^3 / (3 E I), plus a little shear.
local bw = require "barwright"
local out = arg[1] or "."

-- 1. Quadratic tetrahedra: linear ones are far too stiff in bending.
local L, b, h = 0.120, 0.010, 0.006
local mesh = bw.mesh.box {min = {0, 0, 0}, max = {L, b, h}, cells = {30, 3, 2}, order = 2}

-- 2. Selections are geometric; one that holds nothing is an error. Axes count from 1.
local steel = bw.material.steel
local part = bw.model {mesh = mesh, material = steel}
part:fix(mesh.boundary:below(1, 1e-6))
part:load {on = mesh.boundary:above(1, L - 1e-6), force = {0, 0, -5}}
print(part)

-- 3. Solve, and compare.
local static = assert(part:solve())
print(static)
local tip = -static.displacement:column(3):min()
local I = b * h ^ 3 / 12
local beam = 5 * L ^ 3 / (3 * 210e9 * I)
print(("tip %.5f mm, beam theory %.5f mm"):format(tip * 1e3, beam * 1e3))
assert(math.abs(tip / beam - 1) < 0.02)

-- 4. How far is the solution off? This is the whole body's error in the energy norm, a mean.
print(("largest von Mises stress %.2f MPa, error in energy %.1f %%"):format(
  static.von_mises:max() / 1e6, 100 * static:error_estimate()))
assert(static:write(out .. "/cantilever.vtu"))
-- Next: open cantilever.vtu in ParaView; refine the mesh and watch the estimate fall.
