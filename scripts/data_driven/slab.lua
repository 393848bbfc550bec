-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A slab of soft and medium sheets under a hard skin, pushed along the ground (data-driven, figure 12).
local bw = require "barwright"

local H, CELLS = 0.01, {128, 8, 16}

return {buckling = {
  words = "a slab of soft and medium sheets with a hard skin on top, pushed along the ground",
  levels = 2, up = {0, 1, 0}, direction = {-0.5, 0.6, 1},
  grid = function()
    return bw.grid.box {cells = CELLS, spacing = H, material = function(x, y)
      return y > (CELLS[2] - 1) * H and 3 or math.floor(x / H) % 2 + 1
    end}
  end,
  act = function(solid)
    solid:hold({side = "low y"}, {false, 0, 0})
    solid:hold {side = "low x"}
    solid:force({side = "high x"}, {-1000, 0, 0})
  end,
}}
