-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes docs/images/coarse.png: a bar of layers bent, on its fine grid, coarse by lookup, coarse naively.
local root = arg[0]:match "^(.*)/scripts/" or "."
package.path = root .. "/scripts/data_driven/?.lua;" .. package.path
local bw = require "barwright"
local scenes = require "scenes"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "docs/images/coarse.png: a bar of layers bent, fine, coarse by lookup, and coarse naively",
  arguments = {{name = "library", type = "file", optional = true,
    what = "a library of materials, FILE.bwm; without it one is built (a minute or two)"}},
}

local materials = scenes.materials()
local library = opts.library and assert(bw.metamaterial.read(opts.library))
  or assert(bw.metamaterial.build(materials, {voids = false, directions = 100}))
local fine = assert(scenes.solid(scenes.bending, materials))
local reference = assert(fine:solve())
local panels = {{grid = fine.grid, title = "layers of three rubbers"},
  reference:panel(("%d elements"):format(fine.element_count), "movement")}
for _, by in ipairs {{library, "looked up"}, {"naive", "without"}} do
  local coarse = assert(fine:coarsen(by[1]))
  local result = assert(coarse:solve {choose = false})
  panels[#panels + 1] = result:panel(("%d, %s: error %.1f %%"):format(coarse.element_count, by[2],
    100 * select(2, result:error(reference))), "movement")
end
assert(bw.grid.picture(root .. "/docs/images/coarse.png", panels, {width = 330, height = 300, columns = 4,
  unit = "movement, mm", scale = 1e3, min = 0, up = {0, 0, 1}}))
