-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A soft slab with a hard skin, pushed along the ground until it buckles (data-driven, figure 12).
local bw = require "barwright"

local H, CELLS = 0.01, {128, 8, 16}

return {buckling = {
  words = "a soft slab with a hard skin on top, pushed along the ground",
  levels = 2,
  grid = function()
    return bw.grid.box {cells = CELLS, spacing = H, material = function(_, y)
      return y > (CELLS[2] - 1) * H and 3 or 1
    end}
  end,
  act = function(solid)
    solid:hold({side = "low y"}, {false, 0, 0})
    solid:hold {side = "low x"}
    solid:force({side = "high x"}, {-440, 0, 0})
  end,
}}
