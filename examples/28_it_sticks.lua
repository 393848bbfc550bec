-- SPDX-License-Identifier: MIT
-- Lesson 28: it sticks.
--   build/barwright examples/28_it_sticks.lua
--
-- A block of 60 x 60 x 20 mm lies on a table. Friction holds it until it is pulled too hard.
local bw = require "barwright"

-- The block is pressed first, then pulled by its top. A path of loads is a chain of contacts, each after the one
-- before.
local table_top = bw.rigid.plane {normal = {0, 0, 1}}
local cuboid = bw.mesh.box {max = {0.06, 0.06, 0.02}, cells = {8, 8, 3}}
local block = bw.model {mesh = cuboid, material = bw.material.pla}
local sole, lid = cuboid.boundary:below("z", 0), cuboid.boundary:above("z", 0.02)
local rough = {{on = sole, with = table_top, friction = 0.4}}
block:load {on = lid, force = {0, 0, -30}}
local pressed = assert(block:contact(rough))
block:load {on = lid, force = {6, 0, 0}}
local holding = assert(block:contact(rough, {after = pressed}))
print(holding)
assert(math.abs(holding.pairs[1].friction[1] + 6) < 1e-3)

-- More than friction holds: 0.4 times 30 N.
block:load {on = lid, force = {7, 0, 0}}
local _, slides = block:contact(rough, {after = holding})
print("pulled by 13 N: " .. slides)
assert(slides:find "nothing stops the translation along %(1, 0, 0%)")
