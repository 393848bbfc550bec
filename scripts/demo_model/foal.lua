-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Write the toy foal of the demonstration as an STL file in millimetres.
local bw = require "barwright"
local script = require "barwright.command.script"
local shapes = require "barwright.shapes"

local opts = script.read {
  summary = "the toy foal of the demonstration as an STL file in millimetres",
  arguments = {{name = "out", type = "file", endings = {"stl"}, what = "the file"}},
}
local f, min, max = shapes.foal()
local surface = assert(bw.surface.implicit(f, {min = min, max = max, cells = 110}))
surface = assert(surface:remesh {edge_length = 1.2e-3})
assert(surface:write(opts.out, {unit = "mm"}))
print((tostring(surface):match "^[^\n]*"))
