-- SPDX-License-Identifier: MIT
-- Lesson 12: drag and see.
--   build/barwright examples/12_drag_a_hole.lua [FOLDER]
--
-- A bracket of 4 mm aluminium holds a load at its right edge. While a hole is dragged, the analysis
-- keeps up: mesh, matrix pattern, factor and solution of the frame before are reused as far as they go.
local bw = require "barwright"
local mm = 1e-3

-- 1. An outline with tags: conditions sit on tags and follow the outline through everything.
local outline = assert(bw.outline.rectangle {width = 120 * mm, height = 40 * mm,
  tags = {wall = 4, load = 2},
  holes = {bw.outline.circle {radius = 9 * mm, centre = {30 * mm, 20 * mm}, name = "hole"}}})
local aluminium = bw.material.aluminium

-- 2. Statics, solved in every drag. Values are numbers, formulas in x, y, t, or functions.
local bracket = assert(bw.responsive.steady {outline = outline, material = aluminium,
  thickness = 4 * mm, elements = 2000, conditions = {wall = "fixed", load = {traction = {0, -1e6}}}})
print(bracket)
local best, at = math.huge, nil
for frame = 1, 30 do
  assert(bracket:drag({loop = "hole"}, {2 * mm, 0}))
  local max = bracket.von_mises:max()
  if max < best then best, at = max, 30 + 2 * frame end
  if frame % 5 == 0 then
    print(("hole at %d mm: %.1f MPa; %s"):format(30 + 2 * frame, max / 1e6, tostring(bracket.reused)))
  end
end
print(("the hole does least harm at %d mm: %.1f MPa"):format(at, best / 1e6))

-- 3. A drag that cannot be is refused, and the last good state stays.
local ok, message = bracket:drag({loop = "hole"}, {60 * mm, 0})
assert(not ok)
print("refused: " .. message)

-- 4. Which way should the outline go? The gradient of a power mean of the stresses by its points.
local mean, slopes = bracket:stress_norm(8)
print(("power mean %.2f MPa; its steepest slope %.3g MPa/mm"):format(mean / 1e6,
  math.max(slopes:max(), -slopes:min()) / 1e9))

-- 5. The same outline on ground that shakes at 400 Hz; a drag between time steps changes its tune.
local transient = assert(bw.responsive.vibration {outline = outline, material = aluminium,
  thickness = 4 * mm, elements = 2000, ground = "wall", ground_motion = {y = "1e-4*sin(2*pi*400*t)"},
  step = 5e-5})
for _ = 1, 20 do
  assert(transient:drag({loop = "hole"}, {1 * mm, 0}))
  assert(transient:step(5))
end
print(("after %.0f ms: %.3f mm at most; %s"):format(transient.time * 1e3, transient.displacement:max() * 1e3,
  tostring(transient.reused)))
-- Next: bw.responsive.cantilever for what bends largely, order = 2 for six-node triangles.
