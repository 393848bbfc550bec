-- SPDX-License-Identifier: MIT
-- Lesson 9: from an STL file to a stronger part.
--   build/barwright examples/09_skeleton_from_stl.lua [FOLDER]
--
-- A toy figure comes as an STL without anything else. Its skeleton is extracted from the surface,
-- tidied by hand, kept in a file, and used to make the figure strong enough.
local bw = require "barwright"
local out = arg[1] or "."
local mm = 1e-3

-- 1. The STL (here it is made first: a body with two legs and two arms).
local limbs = {}
for _, l in ipairs {{0, 22, 0, 46, 8, 8}, {-4, 22, -12, 0, 6, 4}, {4, 22, 12, 0, 6, 4},
  {-6, 44, -26, 38, 4.5, 3}, {6, 44, 26, 38, 4.5, 3}, {0, 46, 0, 60, 6, 7}} do
  limbs[#limbs + 1] = bw.shapes.limb({l[1] * mm, 0, l[2] * mm}, {l[3] * mm, 0, l[4] * mm},
    l[5] * mm, l[6] * mm)
end
local shape = assert(bw.surface.implicit(bw.shapes.join(limbs, 3 * mm),
  {min = {-32 * mm, -10 * mm, -6 * mm}, max = {32 * mm, 10 * mm, 70 * mm}, cells = 60}))
assert(shape:write(out .. "/figure.stl"))

-- 2. Read, extract the skeleton, see its tree.
local surface = assert(bw.surface.read(out .. "/figure.stl", {unit = "mm"}))
local skeleton = assert(bw.skeleton.extract(surface))
print(skeleton)
assert(skeleton:write(out .. "/figure.tgf"))

-- 3. The leg is the bone that reaches lowest on the left.
local leg
for _, name in ipairs(skeleton.bone_names) do
  local bone = skeleton:bone(name)
  if bone.to[1] < -2 * mm and (not leg or bone.to[3] < leg.to[3]) then leg = bone end
end

-- 4. Standing on one leg under 40 N on the head.
local mesh = assert(bw.mesh.fill(surface, {elements = 3000, order = 2}))
local part = bw.model {mesh = mesh, material = bw.material.pla}
part:fix(mesh.boundary:below(3, 0):beyond({0, 0, 0}, {-1, 0, 0}))
part:load {on = mesh.boundary:above(3, 60 * mm), force = {0, 0, -40}}
local session = assert(bw.edit(part, {skeleton = skeleton, threshold = 0.85}))
local before = assert(session:solve()).von_mises:max()

-- 5. Thicken that leg step by step until the stress is down by a quarter.
local now
repeat
  assert(session:bone(leg.name):scale {1, 1.05, 1.05})
  now = assert(session:solve())
  print(("%s x %.3f: %.2f MPa (%s)"):format(leg.name, session:bone(leg.name).factors[2],
    now.von_mises:max() / 1e6, tostring(now.reused)))
until now.von_mises:max() < 0.75 * before or #session.edits == 12
assert(assert(session:surface()):write(out .. "/stronger.stl"))
-- Next: session:optimise does this for all bones at once, changing the shape as little as it can.
