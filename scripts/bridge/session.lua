-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A bridge to design by hand, in the live view: span 0.2 m, 1500 N on the middle, 30 MPa, 4 mm of acrylic.
--   build/barwright live scripts/bridge/session.lua
-- Drag its curves until the area is as small as it gets while it still passes. The best beam of one height
-- has 15104 mm2; scripts/bridge/run.lua shows what the linear program finds.
local bw = require "barwright"

return bw.responsive.bridge {span = 0.2, load = 1500, stress_limit = 30e6, thickness = 0.004,
  material = bw.material.isotropic {name = "acrylic", young = 3e9, poisson = 0.35, density = 1190}}
