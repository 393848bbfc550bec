-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A bridge that sags under its own weight, and the same with arches (data-driven, figure 16).
local bw = require "barwright"

local H = 0.0125
local LENGTH, WIDTH, HEIGHT = 192, 24, 44 -- cells
local DECK, SKIN = 9, 2                   -- cells: thickness, and of its hard upper and lower layers
local PIER = 9                            -- cells

-- In cells, from the low corner.
local function deck(i, _, k)
  local under = HEIGHT - 6 - DECK
  if k < under or k >= under + DECK then return 0 end
  local from_face = math.min(k - under, under + DECK - 1 - k)
  -- hard skins over a soft core, with medium webs across
  if from_face < SKIN then return 2 end
  return i % 12 < 2 and 2 or 1
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
  solid:hold {side = "low z"}
  solid:hold {side = "low x"}
  solid:hold {side = "high x"}
  solid:gravity {0, 0, -9.81}
end

return {
  bridge = {words = "a bridge of soft core and hard skins under its own weight", levels = 2,
    grid = grid_of(false), act = act, size = 56177},
  bridge_arch = {words = "the same bridge with an arch under each side", levels = 2,
    grid = grid_of(true), act = act, size = 65684},
}
