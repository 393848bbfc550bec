-- SPDX-License-Identifier: MIT
-- Lesson 8: an edit session.
--   build/barwright examples/08_edit_session.lua [FOLDER]
--
-- A hook of a coat rack carries 60 N. Its skeleton has two bones; an edit turns or thickens what
-- follows a bone, the joint between them is blended, and a solve computes again only what the edit
-- touched.
local bw = require "barwright"
local out = arg[1] or "."
local mm = 1e-3

-- 1. A part as in lesson 2, of order 2: linear tetrahedra are too stiff in bending.
local wall, bend, tip = {0, 0, 0}, {45 * mm, 0, 0}, {62 * mm, 0, 24 * mm}
local shapes = bw.shapes
local body = shapes.cut(shapes.join({shapes.limb(wall, bend, 5 * mm),
  shapes.limb(bend, tip, 5 * mm, 4 * mm)}, 2 * mm), shapes.box({-0.02, -0.02, -0.02}, {0, 0.02, 0.02}))
local surface = assert(bw.surface.implicit(body,
  {min = {-2 * mm, -8 * mm, -8 * mm}, max = {70 * mm, 8 * mm, 32 * mm}, cells = 60}))
local mesh = assert(bw.mesh.fill(surface, {elements = 3000, order = 2}))
local part = bw.model {mesh = mesh, material = bw.material.pla}
part:fix(mesh.boundary:below(1, 0.5 * mm))
part:load {on = mesh.boundary:above(3, 20 * mm), force = {0, 0, -60}}

-- 2. A skeleton by hand (lesson 9 has it extracted), and a session.
local skeleton = bw.skeleton.create {joints = {wall = wall, bend = bend, tip = tip}, root = "wall",
  bones = {{"wall", "bend", name = "arm"}, {"bend", "tip", name = "nose"}}}
local session = assert(bw.edit(part, {skeleton = skeleton}))
print(session.subdomains)
local before = assert(session:solve())
print(("as drawn: %.1f MPa, estimated error %.0f %%"):format(before.von_mises:max() / 1e6,
  100 * before:error_estimate()))

-- 3. Thicken the arm (factors along the bone and across it) and turn the nose up. Loads and supports
--    go with the surface.
assert(session:bone("arm"):scale {1, 1.25, 1.25})
assert(session:bone("nose"):rotate {axis = {0, 1, 0}, degrees = -15})
local now = assert(session:solve())
print(("edited: %.1f MPa; reused: %s"):format(now.von_mises:max() / 1e6, tostring(now.reused)))
assert(now.von_mises:max() < before.von_mises:max())

-- 4. Where should the tip be? Inverse kinematics turns the bones.
local report = assert(session:reach("tip", {60 * mm, 4 * mm, 26 * mm}))
print(("tip left %.2g mm from its place"):format(report.distance * 1e3))

-- 5. Undo goes to any depth. An edit that would turn elements inside out is repaired, or refused.
assert(session:undo())
local ok, message = session:bone("nose"):rotate {axis = {0, 1, 0}, degrees = -170}
print(ok and "that went well" or message)

-- 6. Keep what was done: as a script that replays it, as a picture, as a surface to print.
assert(session:save(out .. "/hook_edits.lua"))
assert(session:picture(out .. "/hook.png"))
assert(assert(session:surface()):write(out .. "/hook.stl"))
-- Next: give bw.edit{journal = "edits.lua"} and kill the program: bw.edit.load("edits.lua", session).
