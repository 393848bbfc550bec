-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The session of the live view's tests: a hook of two bones under 60 N.
local bw = require "barwright"
local mm = 1e-3
local wall, bend, tip = {0, 0, 0}, {45 * mm, 0, 0}, {62 * mm, 0, 24 * mm}
local shapes = bw.shapes
local body = shapes.cut(shapes.join({shapes.limb(wall, bend, 5 * mm),
  shapes.limb(bend, tip, 5 * mm, 4 * mm)}, 2 * mm), shapes.box({-0.02, -0.02, -0.02}, {0, 0.02, 0.02}))
local surface = assert(bw.surface.implicit(body,
  {min = {-2 * mm, -8 * mm, -8 * mm}, max = {70 * mm, 8 * mm, 32 * mm}, cells = 40}))
local mesh = assert(bw.mesh.fill(surface, {elements = 1500, order = 2}))
local part = bw.model {mesh = mesh, material = bw.material.pla}
part:fix(mesh.boundary:below(1, 0.5 * mm))
part:load {on = mesh.boundary:above(3, 20 * mm), force = {0, 0, -60}}
local skeleton = bw.skeleton.create {joints = {wall = wall, bend = bend, tip = tip}, root = "wall",
  bones = {{"wall", "bend", name = "arm"}, {"bend", "tip", name = "nose"}}}
return assert(bw.edit(part, {skeleton = skeleton})), {title = "Hook"}
