-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A slab of soft and medium pieces in turn under a harder skin, pushed along the ground (data-driven,
-- figure 12). It is pressed together and bulges towards its end; it does not wrinkle as the paper's does.
local bw = require "barwright"

local H, CELLS, SKIN = 0.01, {128, 8, 16}, 2

return {buckling = {
  words = "a slab of soft and medium pieces in turn, under a skin of medium and hard ones, pushed along the "
    .. "ground",
  levels = 2, up = {0, 1, 0}, direction = {-0.5, 0.6, 1},
  grid = function()
    return bw.grid.box {cells = CELLS, spacing = H, material = function(x, y)
      local piece = math.floor(x / H) % 2
      return y > (CELLS[2] - SKIN) * H and 3 - piece or piece + 1
    end}
  end,
  act = function(solid)
    solid:hold({side = "low y"}, {false, 0, 0})
    solid:hold {side = "low x"}
    solid:force({side = "high x"}, {-1400, 0, 0})
  end,
}}
