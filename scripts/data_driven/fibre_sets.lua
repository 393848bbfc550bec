-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How the scene fibers depends on its fibres: number, radius, turns. For each set the fine bar's stretch and
-- twist, and at each level the naive error, and that of a library grown for the bar from nothing.
local folder = arg[0]:match "^(.*)/[^/]*$" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local scenes = require "scenes"
local script = require "barwright.command.script"
local winding = require "winding"

local sets = {
  {rings = {{16, 12}, {8, 6}}, radius = 1.6, turns = 1}, -- the scene's
  {rings = {{16, 12}, {8, 6}}, radius = 1.6, turns = 0.5},
  {rings = {{16, 12}}, radius = 1.6, turns = 0.5},
  {rings = {{16, 12}, {8, 6}}, radius = 1.1, turns = 1},
  {rings = {{8, 11}, {4, 5}}, radius = 2.2, turns = 0.5},
  {rings = {{8, 11}, {4, 5}}, radius = 2.2, turns = 1},
  {rings = {{8, 11}}, radius = 3.2, turns = 0.25},
}

local opts = script.read {
  summary = "how the scene fibers depends on its fibres",
  about = "About a minute of the processor for each set.",
  options = {
    {name = "only", value = "NUMBER", type = "integer", min = 1, max = #sets, what = "this set alone, from 1"},
    scenes.option.directions(20),
    script.option.threads,
  },
}

-- Stretch of the bar, and how far its end has turned, in degrees.
local function pulled(grid, u)
  local box, nodes = grid.box, assert(grid:nodes {side = "max y"})
  local at, moved = grid.points:gather(nodes):totable(), u:gather(nodes):totable()
  local x0, z0 = (box.min[1] + box.max[1]) / 2, (box.min[3] + box.max[3]) / 2
  local along, across, stretch = 0, 0, 0
  for k, p in ipairs(at) do
    local x, z, v = p[1] - x0, p[3] - z0, moved[k]
    along = along + x * (x + v[1]) + z * (z + v[3])
    across = across + z * (x + v[1]) - x * (z + v[3])
    stretch = stretch + v[2] / #at
  end
  return stretch / (box.max[2] - box.min[2]), math.deg(math.atan(across, along))
end

for number = opts.only or 1, opts.only or #sets do
  local set, rings = sets[number], {}
  for k, ring in ipairs(set.rings) do rings[k] = ("%d at %g"):format(ring[1], ring[2]) end
  local scene = winding(set)
  local fine = assert(scenes.solid(scene, scenes.materials()))
  local reference = assert(fine:solve())
  print(("%d: %s, radius %g cells, turns %g: stretch %.4f, twist %.1f degrees"):format(number,
    table.concat(rings, ", "), set.radius, set.turns, pulled(fine.grid, reference.displacement)))
  local grown = assert(bw.metamaterial.grow(scenes.materials(), fine.grid, {levels = 2,
    directions = opts.directions}))
  for level = 1, 2 do
    local error, line = {}, ("   level %d:"):format(level)
    for _, method in ipairs {"naive", "grown"} do
      local coarse = assert(fine:coarsen(method == "naive" and method or grown, level))
      local solution = assert(coarse:solve {choose = false})
      error[method] = select(2, solution:error(reference))
      local stretch, twist = pulled(fine.grid, solution.fine_displacement)
      line = line .. ("  %s %.2e (stretch %.4f, twist %.1f)"):format(method, error[method], stretch, twist)
    end
    print(line .. ("  ratio %.1f"):format(error.naive / error.grown))
  end
  io.stdout:flush()
end
