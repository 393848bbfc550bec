-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bars of 32 x 100 x 32 soft cells with hard fibres that wind about the axis, fixed at one end and pulled.
local bw = require "barwright"

local H, CELLS = 0.01, {32, 100, 32}

--- A scene. set: {rings = {{fibres, radius of their helix}, ...}, radius = of a fibre, turns = over the
--- length}, in cells.
return function(set)
  local function material(x, y, z)
    local px, pz = x / H - CELLS[1] / 2, z / H - CELLS[3] / 2
    for _, ring in ipairs(set.rings) do
      for k = 1, ring[1] do
        local angle = 2 * math.pi * (set.turns * y / (CELLS[2] * H) + (k - 1) / ring[1])
        local dx, dz = px - ring[2] * math.cos(angle), pz - ring[2] * math.sin(angle)
        if dx * dx + dz * dz < set.radius * set.radius then return 3 end
      end
    end
    return 1
  end
  local function fixed(solid) solid:fix {side = "min y"} end
  return {levels = 2, fixed = fixed,
    grid = function() return bw.grid.box {cells = CELLS, spacing = H, material = material} end,
    act = function(solid)
      fixed(solid)
      solid:force({side = "max y"}, {0, 3500, 0})
    end}
end
