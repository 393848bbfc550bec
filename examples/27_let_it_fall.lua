-- SPDX-License-Identifier: MIT
-- Lesson 27: let it fall.
--   build/barwright examples/27_let_it_fall.lua [FOLDER]
--
-- A plastic block of 60 x 40 x 10 mm falls from a table on a stone floor. Lesson 7 has the drop test, which has no
-- time: here the part is followed until it leaves the floor.
local bw = require "barwright"
local folder = arg and arg[1]

local mesh = bw.mesh.box {max = {0.06, 0.04, 0.01}, cells = {12, 8, 2}, order = 2}
local part = bw.model {mesh = mesh, material = bw.material.pla} -- no supports and no loads

-- One drop from 0.8 m. `down` is where the floor is, seen from the part: here below a corner.
local drop = assert(part:drop {height = 0.8, down = {-1, -2, -3}})
print(drop)
local impact = drop.impacts[1]
print(("it touches for %.3g ms, with at most %.0f N: %.0f times its weight"):format(1e3 * impact.duration,
  impact.force, impact.force / (drop.mass * 9.80665)))
print(("largest stress %.1f MPa after %.3g ms"):format(drop.peak.stress / 1e6, 1e3 * drop.peak.time))

-- The history has the force and where the energy is. No coefficient of restitution is given: what does not come
-- back as motion is in the vibration of the part.
local n = #drop.times
print(("of %.0f mJ, %.0f mJ go on as motion and %.0f mJ as vibration"):format(1e3 * drop.initial_energy,
  1e3 * drop.motion_energy[n], 1e3 * (drop.vibration_energy[n] + drop.strain_energy[n])))
assert(drop.energy_error < 1e-3) -- of the energy at the first touch

-- In place of the floor it may hit a peg, with a tip of this radius below the centre of mass, or an edge
-- (bw.rigid.cylinder).
print(assert(part:drop {height = 0.8, onto = bw.rigid.sphere {radius = 0.02}}))

-- Nobody knows how it will fall. Drops at random share one factor and one set of modes, here those of the drop
-- above.
local drops = assert(bw.random_drops(part, {drops = 20, height = 0.8, modes = drop.modes}))
print(drops)
local p, low, high = drops:failures()
print(("%.0f %% of the drops overload some place; 20 drops leave %.0f to %.0f %% open"):format(100 * p, 100 * low,
  100 * high))
assert(low <= p and p <= high)

-- Corners are always crushed where they touch: there the stress depends on the mesh. See where else it is high.
if folder then
  assert(drop:write_history(folder .. "/drop.csv"))
  assert(drop:picture(folder .. "/drop.png"))
  assert(drops:picture(folder .. "/drops.png"))
end
-- Next: `impacts = 3` follows it as it bounces. `barwright drop part.stl --height 0.8m` compares with a coarser
-- mesh.
