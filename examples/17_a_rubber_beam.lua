-- SPDX-License-Identifier: MIT
-- Lesson 17: rubber that bends a long way.
--   build/barwright examples/17_a_rubber_beam.lua [FOLDER]
--
-- A beam of rubber, 200 mm long, is fixed at one end; a growing weight hangs from the other. Small
-- deflections go with the weight, large ones do not: the beam turns into the weight's direction.
local bw = require "barwright"
local folder = arg and arg[1] or os.tmpname() .. "_beam"
local mm = 1e-3

-- 1. A grid of cubes, and what they are made of.
local grid = assert(bw.grid.box {size = {200 * mm, 20 * mm, 20 * mm}, spacing = 5 * mm})
local rubber = bw.hyperelastic {law = "neo_hookean", young = 1e6, poisson = 0.45, density = 1100}
print(grid)

-- 2. Supports and loads are given by place. Newton's method finds where everything is in balance.
local function loaded(force)
  local beam = assert(bw.solid {grid = grid, materials = {rubber}})
  beam:fix {side = "min x"}
  beam:force({side = "max x"}, {0, 0, -force})
  return assert(beam:solve())
end

local tip = {side = "max x"}
local function sag(result)
  return -result.displacement:gather(grid:nodes(tip)):column(3):mean() / mm
end

local results = assert(bw.results.open(folder, {script = "examples/17_a_rubber_beam.lua"}))
local min = sag(loaded(0.01)) / 0.01
local panels, last = {}, nil
for i, force in ipairs {0.5, 2, 6} do
  last = loaded(force)
  print(("%4.1f N: sags %6.1f mm; in proportion it were %6.1f mm; %d iterations"):format(force, sag(last),
    force * min, last.newton.iterations))
  panels[i] = last:panel(("%g N"):format(force), "von_mises")
end
assert(sag(last) < 0.2 / mm) -- a beam cannot sag more than it is long

-- 3. The reaction of the support equals the load.
print(("reaction %.3f N; smallest volume ratio %.3f"):format(
  last:total_reaction({side = "min x"})[3], last.newton.shape.min_ratio))

-- 4. Side by side, with the stress that the materials carry.
assert(bw.grid.picture(results:path "beam.png", panels, {direction = {0.3, -1, 0.2}, up = {0, 0, 1},
  unit = "von Mises stress, kPa", scale = 1e-3, ghost = true, width = 480, height = 480}))
assert(last:write(results:path "beam.vtu"))
print("wrote " .. folder)
