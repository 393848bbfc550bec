-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Slabs under a harder skin, pushed along the ground (data-driven, figure 12). "buckling": of two
-- materials in turn; a force presses it together, and it bulges towards its end. "wrinkling": a soft slab
-- under a skin of one hard material, thick enough for coarse cells to resist its bending, pressed
-- together by a given way.
local bw = require "barwright"

local H, CELLS = 0.01, {128, 8, 16}

-- `material(piece, skin)`: of the piece'th column of cells, in the skin or below.
local function grid(skin, material)
  return function()
    return bw.grid.box {cells = CELLS, spacing = H, material = function(x, y)
      return material(math.floor(x / H) % 2, y > (CELLS[2] - skin) * H)
    end}
  end
end

local function fix(solid)
  solid:fix({side = "min y"}, {false, 0, 0})
  solid:fix {side = "min x"}
end

return {
  buckling = {
    words = "a slab of soft and medium pieces in turn, under a skin of medium and hard ones, pushed along "
      .. "the ground",
    levels = 2, up = {0, 1, 0}, direction = {-0.5, 0.6, 1},
    grid = grid(2, function(piece, skin) return skin and 3 - piece or piece + 1 end),
    act = function(solid)
      fix(solid)
      solid:force({side = "max x"}, {-1400, 0, 0})
    end,
  },
  wrinkling = {
    words = "a soft slab under a hard skin, pressed together along the ground until it wrinkles",
    levels = 2, up = {0, 1, 0}, direction = {-0.5, 0.6, 1},
    grid = grid(4, function(_, skin) return skin and 3 or 1 end),
    act = function(solid)
      fix(solid)
      solid:fix({side = "max x"}, {-0.1, false, false})
    end,
  },
}
