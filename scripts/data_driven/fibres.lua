-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A soft bar with hard fibres that wind about its axis: pulled, it twists (data-driven, figure 13).
local bw = require "barwright"

local H, CELLS = 0.01, {32, 100, 32}
local FIBRES, TURNS = 4, 0.5
local AROUND, THICK = 0.11, 0.022 -- m: radius of the helix, and of a fibre

local function material(x, y, z)
  local middle, length = CELLS[1] * H / 2, CELLS[2] * H
  local px, pz = x - middle, z - middle
  for k = 1, FIBRES do
    local angle = 2 * math.pi * (TURNS * y / length + (k - 1) / FIBRES)
    local dx, dz = px - AROUND * math.cos(angle), pz - AROUND * math.sin(angle)
    if dx * dx + dz * dz < THICK * THICK then return 3 end
  end
  return 1
end

local function held(solid) solid:hold {side = "low y"} end

return {fibers = {
  words = "a soft bar with four hard fibres that wind about its axis, pulled",
  levels = 2,
  grid = function() return bw.grid.box {cells = CELLS, spacing = H, material = material} end,
  act = function(solid)
    held(solid)
    solid:force({side = "high y"}, {0, 2500, 0})
  end,
  motion = {words = "let go from the pulled shape, four times as slow as it is", held = held, step = 0.01,
    steps = 60, each = 2},
}}
