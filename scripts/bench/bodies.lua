-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The bodies that breaking forces are measured on: the machine parts of scripts/worst_case/machine_parts.lua, or
-- the surfaces of a folder named below, scaled to a box diagonal of 100 mm.
local bw = require "barwright"
local distance = require "barwright.points".distance
local parts = require "machine_parts"

-- Chosen before any was measured.
local surfaces = {"anchor.off", "armadillo.obj", "boot.obj", "bottle_opener_round.stl", "cat.obj", "chair.ply",
  "engine_bracket.obj", "fan_blade.stl", "fandisk.obj", "fertility.off", "gear_spur.stl", "rocker_arm.obj",
  "screwdriver.ply", "tray_bottom.stl", "triceratops.off"}
local DIAGONAL = 0.1

local function scaled(surface)
  return surface:scale(DIAGONAL / distance(surface.box.low, surface.box.high))
end

--- Those of the folder `models`, or the machine parts where it is nil, whose name contains `only` (nil: all):
--- a list of {name =, surface = function()}.
return function(models, only)
  local list = {}
  local function add(name, surface)
    if not only or name:find(only, 1, true) then list[#list + 1] = {name = name, surface = surface} end
  end
  if not models then
    for _, part in ipairs(parts.list) do add(part.name, function() return parts.surface(part) end) end
    return list
  end
  for _, file in ipairs(surfaces) do
    add(file:match "^[^.]*", function() return scaled(assert(bw.surface.read(models .. "/" .. file))) end)
  end
  return list
end
