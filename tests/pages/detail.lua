-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Writes the page of a large body to arg[1]: arg[2] cells along each edge of the box, 40 if left out. Its fields
-- are formulas, since only the page is measured. Prints how long the page takes.
local bw = require "barwright"
local body_page = require "barwright.body_page"
local cells = tonumber(arg[2] or 40)
local mesh = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.1, 0.1}, cells = {cells, cells, cells}, order = 2}
local field = mesh.nodes:map "sin(60 * a[1]) * cos(50 * a[2]) + 10 * a[3]"
local since = os.clock()
assert(body_page.write(arg[1], mesh, {title = "A large body", answer = "Its colours are a formula.",
  fields = {{name = "formula", unit = "MPa", values = field}},
  displacements = {{name = "pull", kind = "load", values = mesh.nodes}}}))
print(("%d elements: the page took %.2f s of processor time"):format(mesh.element_count, os.clock() - since))
