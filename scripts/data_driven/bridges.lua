-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A bridge that sags under its own weight, and the same with arches (data-driven, figure 16).
local bw = require "barwright"

local H = 0.0085
local LENGTH, WIDTH, HEIGHT = 192, 24, 44 -- cells
local DECK = 9                            -- cells
local PIER = 9                            -- cells

-- In cells, from the min corner. Firm sheets with soft ones between them, each a cell thick.
local function deck(_, _, k)
  local above = k - (HEIGHT - 6 - DECK)
  if above < 0 or above >= DECK then return 0 end
  return above % 2 == 0 and 3 or 1
end

local function rail(i, j, k)
  if k < HEIGHT - 6 then return 0 end
  if j >= 2 and j < WIDTH - 2 then return 0 end
  return (k >= HEIGHT - 2 or i % 8 < 2) and 2 or 0
end

local function pier(i, _, k)
  return k < HEIGHT - 6 - DECK and (i < PIER or i >= LENGTH - PIER) and 3 or 0
end

-- Steep where it leaves the piers; columns stand on it under the deck.
local function arch(i, j, k)
  local along = (i - LENGTH / 2 + 0.5) / (LENGTH / 2 - PIER)
  if math.abs(along) > 1 or (j >= 6 and j < WIDTH - 6) then return 0 end
  local under = HEIGHT - 6 - DECK
  local top = under - 0.85 * under * along * along
  if k >= under or k <= top - 4 then return 0 end
  return (k <= top or i % 16 < 2) and 3 or 0
end

local function grid_of(with_arch)
  return function()
    return bw.grid.box {cells = {LENGTH, WIDTH, HEIGHT}, spacing = H, material = function(x, y, z)
      local i, j, k = x // H, y // H, z // H
      local m = deck(i, j, k)
      if m == 0 then m = rail(i, j, k) end
      if m == 0 then m = pier(i, j, k) end
      if m == 0 and with_arch then m = arch(i, j, k) end
      return math.tointeger(m) or m
    end}
  end
end

local function act(solid)
  solid:fix {side = "min z"}
  solid:fix {side = "min x"}
  solid:fix {side = "max x"}
  solid:gravity {0, 0, -9.81}
end

return {
  bridge = {words = "a bridge of hard and soft sheets under its own weight", levels = 2,
    grid = grid_of(false), act = act, size = 56177},
  bridge_arch = {words = "the same bridge with an arch under each side", levels = 2,
    grid = grid_of(true), act = act, size = 65684},
}
