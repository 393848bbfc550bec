-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The bodies on which breaking forces are measured, by the options of a bench: the machine parts of
-- scripts/worst_case/machine_parts.lua, with `unseen` those of unseen_parts.lua, with `models` the surfaces of a
-- folder named below, scaled to a box diagonal of 100 mm; with `only` those whose name contains it.
-- A list of {name, surface = function}.
local bw = require "barwright"
local distance = require "barwright.points".distance

-- Chosen before any was measured.
local surfaces = {"anchor.off", "armadillo.obj", "boot.obj", "bottle_opener_round.stl", "cat.obj", "chair.ply",
  "engine_bracket.obj", "fan_blade.stl", "fandisk.obj", "fertility.off", "gear_spur.stl", "rocker_arm.obj",
  "screwdriver.ply", "tray_bottom.stl", "triceratops.off"}
local DIAGONAL = 0.1

local function scaled(path)
  local surface = assert(bw.surface.read(path))
  return surface:scale(DIAGONAL / distance(surface.box.min, surface.box.max))
end

return function(opts)
  local all, list = {}, {}
  if opts.models then
    for _, file in ipairs(surfaces) do
      local path = opts.models .. "/" .. file
      all[#all + 1] = {name = file:match "^[^.]*", surface = function() return scaled(path) end}
    end
  else
    local parts = require(opts.unseen and "unseen_parts" or "machine_parts")
    for _, part in ipairs(parts.list) do
      all[#all + 1] = {name = part.name, surface = function() return parts.surface(part) end}
    end
  end
  for _, body in ipairs(all) do
    if not opts.only or body.name:find(opts.only, 1, true) then list[#list + 1] = body end
  end
  return list
end
