-- SPDX-License-Identifier: MIT
-- Lesson 1: where will it break under the worst load?
--   build/barwright examples/01_where_will_it_break.lua [FOLDER]
--
-- A hand can press on a part anywhere, with up to 0.2 MPa under the fingers and 20 N in all. Among
-- all such pressures that keep the part in balance, which one makes the highest stress, and where?
local bw = require "barwright"
local out = arg[1] or "."

-- 1. A shape. Read one with bw.surface.read("file.stl"); here we make a dumbbell, 100 mm long.
local shapes = bw.shapes
local dumbbell = shapes.join({
  shapes.sphere({-0.04, 0, 0}, 0.014),
  shapes.sphere({0.04, 0, 0}, 0.014),
  shapes.limb({-0.04, 0, 0}, {0.04, 0, 0}, 0.005),
}, 0.004)
local surface = assert(bw.surface.implicit(dumbbell,
  {min = {-0.06, -0.02, -0.02}, max = {0.06, 0.02, 0.02}, cells = 60}))
print(surface)

-- 2. Fill it with about 8,000 tetrahedra. The count is met by remeshing the surface to fit.
local mesh = assert(bw.mesh.fill(surface, {elements = 8000}))
print(mesh)

-- 3. Give it a material and ask.
local part = bw.model {mesh = mesh, material = bw.material.pla}
local worst = assert(bw.worst_case(part, {force = 20, pressure = 2e5, modes = 8, regions = 3}))
print(worst)

-- 4. The bar between the balls is the weak place, of course.
assert(math.abs(worst.at[1]) < 0.03, "the neck is where it breaks")
for i, arrow in ipairs(worst:arrows()) do
  print(("arrow %d: %.2f N at x = %.1f mm"):format(i,
    math.sqrt(arrow.force[1] ^ 2 + arrow.force[2] ^ 2 + arrow.force[3] ^ 2), arrow.at[1] * 1e3))
end
assert(worst:picture(out .. "/dumbbell.png"))
-- Next: change the material to bw.material.zp150, or the radius of the bar, and look again.
