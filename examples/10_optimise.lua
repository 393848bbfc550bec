-- SPDX-License-Identifier: MIT
-- Lesson 10: strong enough, and changed as little as can be.
--   build/barwright examples/10_optimise.lua [FOLDER]
--
-- The hook of lesson 8 is to carry its 60 N with six tenths of the stress. How much thicker must it
-- be, and where? The optimiser scales bones across themselves until no stress is above the limit, and
-- of all shapes that do takes the one that moves the corners of the mesh least.
local bw = require "barwright"
local out = arg[1] or "."
local mm, MPa = 1e-3, 1e6

-- 1. The hook, its load, its skeleton: three bones this time, so that the arm can taper.
local wall, middle, bend, tip = {0, 0, 0}, {22 * mm, 0, 0}, {45 * mm, 0, 0}, {62 * mm, 0, 24 * mm}
local shapes = bw.shapes
local body = shapes.cut(shapes.join({shapes.limb(wall, bend, 5 * mm),
  shapes.limb(bend, tip, 5 * mm, 4 * mm)}, 2 * mm), shapes.box({-0.02, -0.02, -0.02}, {0, 0.02, 0.02}))
local surface = assert(bw.surface.implicit(body,
  {min = {-2 * mm, -10 * mm, -10 * mm}, max = {70 * mm, 10 * mm, 32 * mm}, cells = 60}))
local mesh = assert(bw.mesh.fill(surface, {elements = 3000, order = 2}))
local part = bw.model {mesh = mesh, material = bw.material.pla}
part:fix(mesh.boundary:below(1, 0.5 * mm))
part:load {on = mesh.boundary:above(3, 20 * mm), force = {0, 0, -60}}
local skeleton = bw.skeleton.create {joints = {wall = wall, middle = middle, bend = bend, tip = tip},
  root = "wall", bones = {{"wall", "middle", name = "root"}, {"middle", "bend", name = "arm"},
    {"bend", "tip", name = "nose"}}}
local session = assert(bw.edit(part, {skeleton = skeleton}))
local before = assert(session:solve()).von_mises:max()
local limit = 0.6 * before

-- 2. The factors of each bone: along it (always 1), and across it in its two directions. The axes
--    are those of skeleton.frames; the search finds what resists bending most.
local found = assert(session:optimise {von_mises = limit, move_supports = true, max_factor = 2})
print(found)
print(("corners moved %.2g mm on average (root mean square), %d shapes tried, %.1f factorisations")
  :format(found.mean_move / mm, found.shapes, found.factorisations))

-- 3. The answer is one edit. Its stresses are those of a part rebuilt on that shape.
local now = assert(session:solve()).von_mises:max()
assert(now <= limit and #session.edits == 1)
assert(math.abs(assert(session.part:solve()).von_mises:max() / now - 1) < 1e-6)

-- 4. Bounds may forbid what would be needed. Then you get the best that was found, and no edit.
assert(session:undo())
local none, message, details = session:optimise {von_mises = limit, move_supports = true, max_factor = 1.05}
assert(not none and details.status == "infeasible")
print(message)
print(("the best has %.1f MPa"):format(details.best.von_mises / MPa))

-- 5. Keep the stronger one.
assert(session:redo())
assert(session:report(out .. "/stronger_hook.html"))
assert(assert(session:surface()):write(out .. "/stronger_hook.stl"))
-- Next: ties = {{"left leg", "right leg"}}, cases = {another part}, loads = "worst".
