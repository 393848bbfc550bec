-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A session whose solves take longer than a hand's moves.
local bw = require "barwright"
local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.12, 0.03, 0.03}, cells = {20, 6, 6}, order = 2})
local part = bw.model {mesh = mesh, material = bw.material.pla}
part:fix(mesh.boundary:below(1, 1e-6))
part:load {on = mesh.boundary:above(1, 0.12 - 1e-6), force = {0, 0, -60}}
local skeleton = bw.skeleton.create {joints = {wall = {0, 0.015, 0.015}, half = {0.06, 0.015, 0.015},
  free = {0.12, 0.015, 0.015}}, root = "wall",
  bones = {{"wall", "half", name = "inner"}, {"half", "free", name = "outer"}}}
return assert(bw.edit(part, {skeleton = skeleton})), {title = "Beam"}
