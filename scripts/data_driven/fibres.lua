-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A soft bar with hard fibres that wind about its axis: pulled, it twists (data-driven, figure 13).
local bw = require "barwright"

local H, CELLS = 0.01, {32, 100, 32}
local TURNS, THICK = 0.5, 0.022                -- over the length; m: radius of a fibre
local RINGS = {{8, 0.11}, {4, 0.05}}           -- fibres, and m: radius of their helix

local function material(x, y, z)
  local middle, length = CELLS[1] * H / 2, CELLS[2] * H
  local px, pz = x - middle, z - middle
  for _, ring in ipairs(RINGS) do
    for k = 1, ring[1] do
      local angle = 2 * math.pi * (TURNS * y / length + (k - 1) / ring[1])
      local dx, dz = px - ring[2] * math.cos(angle), pz - ring[2] * math.sin(angle)
      if dx * dx + dz * dz < THICK * THICK then return 3 end
    end
  end
  return 1
end

local function held(solid) solid:hold {side = "low y"} end

return {fibers = {
  words = "a soft bar with twelve hard fibres that wind about its axis, pulled",
  levels = 2,
  grid = function() return bw.grid.box {cells = CELLS, spacing = H, material = material} end,
  act = function(solid)
    held(solid)
    solid:force({side = "high y"}, {0, 3500, 0})
  end,
  motion = {words = "let go from the pulled shape, four times as slow as it is", held = held, step = 0.01,
    steps = 60, each = 2}, -- fine = true: beside the fine bar, 22 s of the processor a step
}}
