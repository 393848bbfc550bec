-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes the report that tests/pages/run.mjs opens: FOLDER/report.html.
local bw = require "barwright"
local mesh = bw.mesh.box {low = {0, 0, 0}, high = {0.1, 0.02, 0.01}, cells = {20, 4, 2}}
local part = bw.model {mesh = mesh, material = bw.material.pla}
local worst = assert(bw.worst_case(part, {force = 5, modes = 4, regions = 2}))
assert(worst:report(arg[1] .. "/report.html"))
