-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Cube and bars of layers: pushed, bent, twisted (data-driven, figures 10 and 11).
local bw = require "barwright"

local H = 0.01 -- m, a cell

-- Soft, medium and hard layers in turn across an axis, each a cell thick: all blocks are mixed.
local function layers(axis)
  return function(x, y, z)
    local at = axis == 1 and x or axis == 2 and y or z
    return math.floor(at / H) % 3 + 1
  end
end

local function box(cells, material)
  return function()
    return bw.grid.box {cells = cells, spacing = H, material = material}
  end
end

local bars = {}

bars.pushing = {
  words = "a cube of layers on the ground, with an even force on its top",
  levels = 2,
  grid = box({16, 16, 16}, layers(3)),
  act = function(solid)
    solid:fix {side = "min z"}
    solid:force({side = "max z"}, {0, 0, -400})
  end,
}

bars.bending = {
  words = "a bar of layers, fixed at one end, with a force across the other",
  levels = 2,
  grid = box({8, 32, 8}, layers(2)),
  act = function(solid)
    solid:fix {side = "min y"}
    solid:force({side = "max y"}, {0, 0, -25})
  end,
}

-- A couple: the halves of the end are pushed sideways, each against the other.
bars.twisting = {
  words = "a bar of layers, fixed at one end and twisted by a couple at the other",
  levels = 2,
  grid = box({8, 32, 8}, layers(2)),
  act = function(solid)
    local centre, force = 4 * H, 60
    solid:fix {side = "min y"}
    solid:force({side = "max y", max = {centre, 1, 1}}, {0, 0, force})
    solid:force({side = "max y", min = {centre, 0, 0}}, {0, 0, -force})
    solid:force({side = "max y", max = {1, 1, centre}}, {-force, 0, 0})
    solid:force({side = "max y", min = {0, 0, centre}}, {force, 0, 0})
  end,
}

return bars
