-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Write the toy foal of the demonstration as an STL file in millimetres.
--   build/barwright scripts/demo_model/foal.lua foal.stl
local bw = require "barwright"
local shapes = require "barwright.shapes"

local path = assert(arg[1], "usage: foal.lua OUT.stl")
local f, low, high = shapes.foal()
local surface = assert(bw.surface.implicit(f, {low = low, high = high, cells = 110}))
surface = assert(surface:remesh {edge_length = 1.2e-3})
assert(surface:write(path, {unit = "mm"}))
print((tostring(surface):match "^[^\n]*"))
