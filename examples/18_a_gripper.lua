-- SPDX-License-Identifier: MIT
-- Lesson 18: a body from a surface, of two rubbers.
--   build/barwright examples/18_a_gripper.lua [FOLDER]
--
-- A soft finger that air bends: a tube, closed at its ends, of soft rubber with a stiff strip below.
local bw = require "barwright"
local shapes = require "barwright.shapes"
local folder = arg and arg[1] or os.tmpname() .. "_gripper"
local mm = 1e-3

-- 1. A closed surface, as any STL file holds one; here it is written first, with a cavity inside.
local results = assert(bw.results.open(folder, {script = "examples/18_a_gripper.lua"}))
local outer = shapes.limb({0, 0, 0}, {80 * mm, 0, 0}, 10 * mm)
local cavity = shapes.limb({4 * mm, 0, 2 * mm}, {76 * mm, 0, 2 * mm}, 5 * mm)
local function closed(shape)
  return assert(bw.surface.implicit(shape, {min = {-12 * mm, -12 * mm, -12 * mm},
    max = {92 * mm, 12 * mm, 12 * mm}, cells = 52}))
end
assert(closed(shapes.cut(outer, cavity)):write(results:path "finger.stl", {unit = "mm"}))
local surface = assert(bw.surface.read(results:path "finger.stl", {unit = "mm"}))

-- 2. Cubes that it cuts or holds; those that it cuts count by the part inside.
local grid = assert(bw.grid.voxels(surface, {spacing = 2.5 * mm}))
print(grid)
grid = assert(grid:set({max = {1, 1, -6 * mm}}, 2)) -- the strip
local materials = {
  bw.hyperelastic {name = "soft", young = 2e5, poisson = 0.45, density = 1050},
  bw.hyperelastic {name = "strip", young = 5e6, poisson = 0.45, density = 1100},
}

-- 3. Held at its root; air presses on the cavity's own surface, which goes with the cubes around it.
-- The cavity's triangles look outwards from the cavity, so the air pushes against them.
local finger = assert(bw.solid {grid = grid, materials = materials})
finger:fix {max = {-2 * mm, 1, 1}}
finger:pressure(closed(cavity), {pressure = -25e3, follower = true})
local bent = assert(finger:solve())
print(bent)
local u = bent.displacement:gather(grid:nodes {side = "max x"})
print(("the tip goes %.1f mm down and %.1f mm ahead"):format(-u:column(3):mean() / mm,
  u:column(1):mean() / mm))

-- 4. Cubes and the surface that goes with them.
local embedding = assert(grid:embed(surface))
assert(bw.grid.picture(results:path "finger.png", {
  {title = "at rest", grid = grid},
  {title = "25 kPa", grid = grid, displacement = bent.displacement, embedding = embedding},
}, {direction = {0.4, -1, 0.3}, up = {0, 0, 1}, names = {"soft", "strip"}, width = 600, height = 420}))
assert(assert(embedding:moved(bent.displacement)):write(results:path "bent.stl", {unit = "mm"}))
print("wrote " .. folder)
