-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The experiments of data-driven, table 1, in its order, and the sole of figure 15. Each is {words,
-- levels, grid = function that makes the fine grid, act = function that supports and loads a solid,
-- solve = options}; `size`: the paper's number of elements where its shape is not to be had.
local bw = require "barwright"

local scenes = {order = {"pushing", "bending", "twisting", "buckling", "wrinkling", "fibers", "bridge",
  "bridge_arch", "george", "george_bone", "sole"}}

for _, file in ipairs {"bars", "slab", "fibres", "bridges", "character", "sole"} do
  for name, scene in pairs(require(file)) do scenes[name] = scene end
end

--- Options that several scripts have, as rules of lua/barwright/command/arguments.lua.
scenes.option = {
  scene = {name = "scene", value = "NAME,...", list = true, one_of = scenes.order, word = "all", needed = true,
    what = "which scenes, or all"},
  library = {name = "library", value = "FILE.bwm", type = "file", what = "the library of materials to look up in"},
}

--- How coarse materials are found, all of them by default.
function scenes.option.methods(names)
  return {name = "methods", value = "NAME,...", list = true, one_of = names, default = names,
    what = "how coarse materials are found"}
end

--- Levels of coarsening, all of them without a default.
function scenes.option.levels(default)
  return {name = "levels", value = "N", type = "integer", default = default, min = 1, max = 2,
    what = "levels of coarsening" .. (default and "" or " (default: all)")}
end

function scenes.option.directions(default)
  return {name = "directions", value = "N", type = "integer", default = default, min = 1, max = 5000,
    what = "directions of deformation that are sampled, where a library is built"}
end

--- Three rubbers, each ten times as stiff as the one before (data-driven, section 6).
function scenes.materials()
  local list = {}
  for i, name in ipairs {"soft", "medium", "hard"} do
    list[i] = bw.hyperelastic {law = "neo_hookean", name = name, young = 10 ^ (4 + i), poisson = 0.45,
      density = 1000}
  end
  return list
end

--- A solid of a scene at rest on its fine grid.
function scenes.solid(scene, materials)
  local grid, message, details = scene.grid()
  if not grid then return nil, message, details end
  local solid
  solid, message, details = bw.solid {grid = grid, materials = materials}
  if not solid then return nil, message, details end
  scene.act(solid)
  return solid
end

return scenes
