-- SPDX-License-Identifier: MIT
-- Lesson 26: it touches.
--   build/barwright examples/26_it_touches.lua [FOLDER]
--
-- A plastic shelf of 200 x 60 x 6 mm is held at its left end. A steel peg of 10 mm radius lies across below it,
-- 0.5 mm away. Something on the shelf weighs 3 kg.
local bw = require "barwright"
local folder = arg and arg[1]

local L, b, h, away = 0.2, 0.06, 0.006, 0.5e-3
local mesh = bw.mesh.box {max = {L, b, h}, cells = {60, 8, 3}, order = 2}
local part = bw.model {mesh = mesh, material = bw.material.pla}
part:fix(mesh.boundary:below("x", 0))
part:load {on = mesh.boundary:above("z", h), force = {0, 0, -30}}

-- Without the peg the shelf sinks farther than the peg is away.
print(("without the peg the shelf sinks %.2f mm"):format(-1e3 * assert(part:solve()).displacement:column(3):min()))

-- What may touch what: the underside and a rigid cylinder. Where they touch is part of the answer.
local peg = bw.rigid.cylinder {point = {0.15, 0, -0.01 - away}, axis = {0, 1, 0}, radius = 0.01}
local foot = mesh.boundary:below("z", 0)
local contact = assert(part:contact {{on = foot, with = peg}})
print(contact)
local touch = contact.pairs[1]
print(("the peg carries %.1f N of 30 N"):format(touch.force[3]))
print(("with the peg it sinks %.2f mm"):format(-1e3 * contact.static.displacement:column(3):min()))
-- The force is trusted. The largest pressure is that of the mesh: facets of 3 mm are wider than the contact.
local root = contact.static:reaction_on(mesh.boundary:below("x", 0))
assert(math.abs(root[3] + touch.force[3] - 30) < 1e-3)

-- A shelf that lies on two pegs needs no support, if nothing pushes it sideways.
local loose = bw.model {mesh = mesh, material = bw.material.pla}
loose:load {on = mesh.boundary:above("z", h), force = {0, 0, -30}}
local pegs = {}
for i, x in ipairs {0.04, 0.16} do
  pegs[i] = {on = foot, with = bw.rigid.cylinder {point = {x, 0, -0.01}, axis = {0, 1, 0}, radius = 0.01}}
end
local lying = assert(loose:contact(pegs))
print(lying)
assert(math.abs(lying.pairs[1].force[3] - 15) < 0.1)

-- A shelf of two boards that are glued end to end, in anybody's hands: where does it break first? No pressure acts
-- on the glued faces. The glue itself is not judged.
local whole = bw.mesh.box {max = {L, b, h}, cells = {24, 6, 2}, order = 2}
local boards = assert(whole:split({max = {L / 2, b, h}}, "left")):separated "left"
local glued = bw.model {mesh = boards, material = bw.material.pla}
local seam = boards.boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9)
glued:bond {a = seam & boards.boundary:region "left", b = seam & boards.boundary:region "rest"}
local worst = assert(bw.worst_case(glued, {force = 60, contact = 4e-4}))
print(worst)
-- Screwed on at its left end, it lies on a bracket, which pushes and does not pull: contact opens and closes.
local bracket = {on = boards.boundary:below("z", 0), with = bw.rigid.plane {normal = {0, 0, 1}}}
local shelf = glued:fix(boards.boundary:below("x", 0))
print(assert(bw.worst_case(shelf, {force = 60, contact = 4e-4, pairs = {bracket}})))
if folder then
  assert(worst:picture(folder .. "/glued.png") and contact:picture(folder .. "/contact.png"))
  assert(contact:write(folder .. "/contact.vtu"))
end
-- Next: `with` may be facets of another part of the mesh, with an interference = 20e-6 for a press fit.
