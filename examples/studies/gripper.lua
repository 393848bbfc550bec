-- SPDX-License-Identifier: MIT
-- Study: a gripper's finger from two rubbers.
--   build/barwright examples/studies/gripper.lua [FOLDER] [--quick]
--
-- Air bends a soft finger with a stiff strip below. How stiff and how many layers of cells thick should the
-- strip be, how strong the air? The first-order and total indices of Sobol say which of the three matters for
-- how far the tip goes; then the finger that bends most with no cell crushed.
local bw = require "barwright"
local quick = arg[#arg] == "--quick"
local folder = arg[1] ~= "--quick" and arg[1] or "out/gripper" .. (quick and "_quick" or "")
local mm, shapes = 1e-3, bw.shapes

-- 1. The finger and its cavity, once. A grid coarse enough for hundreds of trials.
local outer = shapes.limb({0, 0, 0}, {80 * mm, 0, 0}, 10 * mm)
local hollow = shapes.limb({4 * mm, 0, 2 * mm}, {76 * mm, 0, 2 * mm}, 5 * mm)
local function closed(shape)
  return assert(bw.surface.implicit(shape,
    {min = {-12 * mm, -12 * mm, -12 * mm}, max = {92 * mm, 12 * mm, 12 * mm}, cells = 52}))
end
local spacing = (quick and 4 or 2.5) * mm
local finger_grid = assert(bw.grid.voxels(closed(shapes.cut(outer, hollow)), {spacing = spacing}))
local cavity = closed(hollow)

local results = assert(bw.results.open(folder, {script = arg[0], seed = 1}))
local study = bw.study {
  name = "gripper", seed = 1, file = results:path(quick and "gripper_quick.study" or "gripper.study"),
  variables = {
    {name = "layers", kind = "integer", min = 1, max = 2},
    {name = "young", unit = "Pa", min = 5e5, max = 2e7, scale = "log"},
    {name = "air", unit = "Pa", min = 5e3, max = 2e4},
  },
  measures = {{name = "down", unit = "m"}, {name = "min_ratio"}},
  objectives = {{name = "down", goal = "max"}},
  constraints = {{name = "min_ratio", min = 0.7}}, -- of volumes: no cell is crushed
  design = {"sobol_indices", base = quick and 2 or 32},
  run = function(point, trial)
    local grid = assert(finger_grid:set({max = {1, 1, -10 * mm + point.layers * spacing}}, 2))
    local finger = assert(bw.solid {grid = grid, materials = {
      bw.hyperelastic {name = "soft", young = 2e5, poisson = 0.45, density = 1050},
      bw.hyperelastic {name = "strip", young = point.young, poisson = 0.45, density = 1100},
    }})
    finger:fix {max = {-2 * mm, 1, 1}}
    finger:pressure(cavity, {pressure = -point.air, follower = true})
    local bent, message = finger:solve()
    if not bent then return nil, message end
    local tip = bent.displacement:gather(grid:nodes {side = "max x"})
    assert(grid:picture(trial.folder .. "/finger.png", {displacement = bent.displacement,
      direction = {0.4, -1, 0.3}, up = {0, 0, 1}, width = 360, height = 260}))
    return {down = -tip:column(3):mean(), min_ratio = bent.newton.shape.min_ratio}
  end,
}

-- 2. What matters.
local trials = assert(study:run())
print(trials) -- with the indices and their intervals
assert(trials:plot("sensitivity", {measure = "down"}):write(results:path "sensitivity.svg"))

-- 3. What to build: the best of all that was tried.
local best = trials:best()
print(("strip of %d layers, %.2g MPa, air of %.0f kPa: the tip goes %.1f mm down"):format(best.point.layers,
  best.point.young / 1e6, best.point.air / 1e3, best.results.down / mm))
assert(best.results.down > 0 and best.results.min_ratio >= 0.7)
assert(trials:report(results:path "gripper.html"))
assert(results:write {down_m = best.results.down, layers = best.point.layers, young_pa = best.point.young,
  air_pa = best.point.air})
