-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The sole of a shoe under a foot, made steadier by three edits of its material (data-driven, figure
-- 15; the shape is our own).
local bw = require "barwright"

local H = 0.0035
local CELLS = {32, 84, 10}
local LENGTH = CELLS[2] * H

-- Half the width, and the centre line, along the foot (0 heel to 1 toe).
local function half_width(t)
  local heel = math.sqrt(math.max(0, 1 - ((t - 0.14) / 0.16) ^ 2))
  local ball = math.sqrt(math.max(0, 1 - ((t - 0.72) / 0.29) ^ 2))
  local waist = (t > 0.1 and t < 0.75) and 0.62 or 0
  return 0.052 * math.max(0.72 * heel, ball, waist * 0.98)
end

local function centre_line(t)
  return CELLS[1] * H / 2 + 0.006 * math.sin(2.6 * t - 0.4)
end

local function inside(x, y, z)
  local t = y / LENGTH
  local profile = z > 6 * H and 0.9 or 1 -- the upper layers stand back a little
  return math.abs(x - centre_line(t)) < half_width(t) * profile
end

-- Pressure of a standing foot: heel, ball, outer edge.
local function pressure(x, y)
  local t, side = y / LENGTH, (x - centre_line(y / LENGTH)) / 0.05
  local function spot(at, across, wide, high)
    return high * math.exp(-((t - at) / wide) ^ 2 - ((side - across) / 0.5) ^ 2)
  end
  return spot(0.15, 0, 0.11, 1.6e4) + spot(0.7, 0.25, 0.13, 1.2e4) + spot(0.72, -0.3, 0.1, 0.8e4)
    + spot(0.45, 0.55, 0.2, 0.35e4)
end

-- The top of the sole, cell by cell, as a surface that the foot presses.
local function top(grid_cells)
  local points, triangles, number = {}, {}, {}
  local z = CELLS[3] * H
  local function point(i, j)
    local key = i * 10000 + j
    if not number[key] then
      points[#points + 1] = {i * H, j * H, z}
      number[key] = #points
    end
    return number[key]
  end
  for _, cell in ipairs(grid_cells) do
    local a, b = point(cell[1], cell[2]), point(cell[1] + 1, cell[2])
    local c, d = point(cell[1] + 1, cell[2] + 1), point(cell[1], cell[2] + 1)
    triangles[#triangles + 1] = {a, b, c}
    triangles[#triangles + 1] = {a, c, d}
  end
  return bw.surface.new {points = points, triangles = triangles}
end

local function top_cells()
  local list = {}
  for i = 0, CELLS[1] - 1 do
    for j = 0, CELLS[2] - 1 do
      if inside((i + 0.5) * H, (j + 0.5) * H, (CELLS[3] - 0.5) * H) then list[#list + 1] = {i, j} end
    end
  end
  return list
end

local function grid()
  return bw.grid.box {cells = CELLS, spacing = H, material = function(x, y, z)
    if not inside(x, y, z) then return 0 end
    return z < 1.01 * H and 2 or 1 -- a firm outsole under soft foam
  end}
end

-- What changes, edit by edit: a region and its new material.
local edits = {
  {words = "medium posts under the heel", material = 2,
    region = function(x, y) return y < 0.3 * LENGTH and (x // H + y // H) % 2 == 0 end},
  {words = "a hard plate under the arch", material = 3,
    region = function(_, y, z)
      return y > 0.3 * LENGTH and y < 0.6 * LENGTH and z > 2 * H and z < 4 * H
    end},
  {words = "a medium rim around the ball", material = 2,
    region = function(x, y)
      local t = y / LENGTH
      return t > 0.55 and math.abs(x - centre_line(t)) > 0.8 * half_width(t)
    end},
}

return {sole = {
  words = "the sole of a shoe under a standing foot",
  levels = 1,
  grid = grid,
  edits = edits,
  act = function(solid)
    solid:fix {side = "min z"}
    solid:pressure(assert(top(top_cells())), {pressure = pressure})
  end,
}}
