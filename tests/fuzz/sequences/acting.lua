-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Loads and materials of the bodies in the plane. The load is a function of a number that operations change.
local bw = require "barwright"
local fuse = require "fuse"

local acting = {load = 1}

acting.rubber = bw.material.isotropic {name = "rubber", young = 1e6, poisson = 0.3, density = 1000}

--- The load at a place, or time.
acting.function_of_load = fuse.around(function() return acting.load end)

--- The operation that changes it: sometimes to what no solution goes with.
function acting.change()
  local choices = {0, 1, 30, 1e3, 1e5, 1e7, 1e300, 0 / 0, 1 / 0, -1e3}
  acting.load = choices[math.random(#choices)]
  return true
end

return acting
