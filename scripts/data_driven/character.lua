-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A figure on its feet that leans and bows under its own weight, soft all through, and with bones
-- (data-driven, figure 17; the shape is our own).
local bw = require "barwright"
local shapes = require "barwright.shapes"

local H = 0.0018              -- m, a cell
local CELLS = {64, 28, 112}
local U = 0.827 * H          -- m: the figure is drawn 132 of these tall

local MIDDLE = {CELLS[1] * H / 2, CELLS[2] * H / 2}
local function at(across, up, ahead)
  return {MIDDLE[1] + across * U, MIDDLE[2] + (ahead or 0) * U, up * U}
end

local body = {
  {at(0, 52), at(0, 82), 17},  -- trunk
  {at(0, 84), at(0, 104), 8},  -- neck
}
for side = -1, 1, 2 do
  body[#body + 1] = {at(side * 12, 5, 4), at(side * 12, 5, -6), 5}  -- foot
  body[#body + 1] = {at(side * 12, 5), at(side * 10, 48), 7}        -- leg
  body[#body + 1] = {at(side * 16, 84), at(side * 31, 56), 5}       -- arm
end

local function limbs_of(scale)
  local list = {}
  for i, limb in ipairs(body) do
    list[i] = shapes.limb(limb[1], limb[2], scale * limb[3] * U)
  end
  return list
end

local parts = limbs_of(1)
parts[#parts + 1] = shapes.sphere(at(0, 114), 15 * U)
local flesh = shapes.join(parts, 4 * U)
local bones = shapes.join(limbs_of(0.34), 0)

local function grid_of(with_bones)
  return function()
    return bw.grid.box {cells = CELLS, spacing = H, material = function(x, y, z)
      local depth = flesh(x, y, z)
      if depth >= 0 then return 0 end
      if with_bones and bones(x, y, z) < 0 then return 3 end
      -- a firmer skin over soft flesh
      return depth > -1.5 * U and 2 or 1
    end}
  end
end

local function act(solid)
  solid:fix {max = {1, 1, 4.01 * H}}
  solid:gravity {0, -1.5, -9.81}
end

return {
  george = {words = "a soft figure that leans under its own weight", levels = 2,
    grid = grid_of(false), act = act, size = 46152, direction = {1.6, -1, 0.4}},
  george_bone = {words = "the same figure with hard bones", levels = 2,
    grid = grid_of(true), act = act, size = 46152, direction = {1.6, -1, 0.4}},
}
