-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What coarse grids can do, whatever their materials: the fine solution's best approximation by trilinear
-- displacements of the coarse grid, under the supports, beside the errors of coarse solids; and how much of these
-- is left when the coarse displacement is multiplied by one factor (the whole too stiff or too soft), or by
-- one for each axis.
local folder = arg[0]:match "^(.*)/[^/]*$" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local best = require "best"
local compare = require "compare"
local core = require "barwright.core"
local scenes = require "scenes"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "the best approximation of fine solutions on coarse grids, beside the errors of coarse solids",
  about = "Without a library only naive and grown (from nothing).\n\n"
    .. "Exit status: 0 done; 1 a scene has no fine solution; 2 the input was refused.",
  options = {
    scenes.option.scene, scenes.option.library,
    scenes.option.methods {"naive", "lookup", "grown"},
    scenes.option.levels(2),
    script.option.json, script.option.threads,
  },
}

local names, methods = opts.scene == "all" and scenes.order or opts.scene, opts.methods

local library, message
if opts.library then
  library, message = bw.metamaterial.read(opts.library)
  if not library then script.refuse(message) end
end

local rows, status = bw.json.list {}, 0
local wanted = {}
for _, method in ipairs(methods) do wanted[method] = true end
for _, name in ipairs(names) do
  local scene = scenes[name]
  local fine = assert(scenes.solid(scene, scenes.materials()))
  local reference
  reference, message = fine:solve(scene.solve)
  if not reference then
    print(("%-12s no fine solution: %s"):format(name, message))
    status = 1
  else
    local u = reference.displacement
    local by = {naive = "naive", lookup = library}
    if wanted.grown then
      by.grown = assert(bw.metamaterial.grow(library or scenes.materials(), fine.grid, {levels = scene.levels}))
    end
    for level = 1, math.min(scene.levels, opts.levels) do
      local coarse = assert(fine:coarsen("naive", level))
      local field = best.of(fine.grid, coarse, u)
      local row = {scene = name, level = level, moved = compare.movement(reference),
        best = fine.grid:difference(field, u), methods = {}}
      print(("%-12s %d  moved %.2e, best %.2e"):format(name, level, row.moved, row.best))
      for _, method in ipairs(methods) do
        local of = by[method]
        local solid = of and (of == "naive" and coarse or of.levels >= level and fine:coarsen(of, level))
        local solution
        if solid then solution, message = solid:solve(compare.as_it_is(scene.solve)) end
        if solution then
          local v = solution.fine_displacement
          local one, all = best.factor(v, u), best.factors(v, u)
          local part = {error = select(2, solution:error(reference)), factor = one, factors = all,
            after_factor = fine.grid:difference(v * one, u),
            after_factors = fine.grid:difference(best.times(v, all), u)}
          row.methods[method] = part
          print(("   %-7s error %.2e, %5.1f times the best; times %.3f: %.2e; times %.3f, %.3f, %.3f: %.2e")
            :format(method, part.error, part.error / row.best, one, part.after_factor, all[1], all[2], all[3],
              part.after_factors))
        elseif solid then
          print(("   %-7s no solution: %s"):format(method, message))
        end
      end
      rows[#rows + 1] = row
      io.stdout:flush()
    end
  end
end
if opts.json then
  assert(core.write_file(opts.json, bw.json.encode {rows = rows}))
end
os.exit(status, true)
