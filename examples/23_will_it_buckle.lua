-- SPDX-License-Identifier: MIT
-- Lesson 23: will it buckle?
--   build/barwright examples/23_will_it_buckle.lua [FOLDER]
--
-- A steel strut of 500 x 20 x 10 mm, clamped at its foot, with 1 kN on its head. Euler's load of such a column is
-- pi^2 E I / (2 L)^2, about its thin side.
local bw = require "barwright"
local folder = arg and arg[1]

local L, b, h = 0.5, 0.02, 0.01
local mesh = bw.mesh.box {max = {L, b, h}, cells = {40, 3, 2}, order = 2}
local part = bw.model {mesh = mesh, material = bw.material.steel}
part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", L), force = {-1000, 0, 0}}

local buckling = assert(part:buckling {count = 3})
print(buckling)
for i = 1, buckling.count do
  print(("load factor %d: %7.3f within %.1e on this mesh, which makes it too large by about %.2g %%"):format(i,
    buckling.factors[i], buckling.errors[i], 100 * buckling:error_estimate()[i]))
end

local euler = math.pi ^ 2 * bw.material.steel.young * b * h ^ 3 / 12 / (2 * L) ^ 2
print(("Euler's load: %.0f N, by the first factor: %.0f N"):format(euler, 1000 * buckling.factor))
assert(buckling.counted and math.abs(1000 * buckling.factor / euler - 1) < 0.01)

-- A thin bracket under a transverse force tips over to its side, in both directions of the force.
local strip = bw.mesh.box {max = {0.3, 0.02, 0.001}, cells = {40, 3, 1}, order = 2}
local bracket = bw.model {mesh = strip, material = bw.material.steel}
bracket:fix(strip.boundary:below("x", 0)):load {on = strip.boundary:above("x", 0.3), force = {0, -10, 0}}
local both = assert(bracket:buckling {count = 2})
print(("the bracket buckles at %.3f and %.3f times its load"):format(both.factors[1], both.factors[2]))
assert(both.factors[1] * both.factors[2] < 0)

-- A mesh that is bent by a tenth of its thickness, for a nonlinear run.
local bent = assert(buckling:imperfect_mesh {amplitude = h / 10})
print(bent)
if folder then
  assert(buckling:picture(1, folder .. "/buckling.png"))
  assert(buckling:write(folder .. "/buckling.vtu"))
end
-- Where the load is not known: which 1 kN, on at least the area of the head, buckles the strut first? The search
-- finds the one above. A part without supports has a force on each side, in balance.
local worst = assert(bw.worst_buckling(part, {force = 1000, contact = b * h, modes = 8, ascents = 2}))
print(worst)
for _, arrow in ipairs(worst:arrows()) do
  print(("  %.0f N along x at x = %.3f m"):format(arrow.force[1], arrow.at[1]))
end
assert(math.abs(worst.factor / buckling.factor - 1) < 0.01)
if folder then assert(worst:picture(folder .. "/worst_buckling.png")) end
-- Next: another sign = "positive", a pressure in place of the force, or `barwright buckle` on a file.
