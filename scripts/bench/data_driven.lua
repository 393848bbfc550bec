-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What coarsening by lookup gains, beside tables 1 and 2 and section 6.2 of the paper data-driven: seconds
-- of an iteration on the fine grid and on coarse ones, how much faster the coarse ones are than our own fine
-- grid and than the paper's coarse one, the fraction of quadrature, the time to coarsen 100,000 elements and to
-- follow an edit, conjugate gradients against factors on the figure with bones, and the coarse solid as a
-- preconditioner. All in one run, seconds of the processor (all threads together), which is what to trust
-- on a busy machine.
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. folder .. "/../data_driven/?.lua;" .. package.path
local bw = require "barwright"
local compare = require "compare"
local library_of = require "library"
local scenes = require "scenes"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "coarsening by lookup beside tables 1 and 2 and section 6.2 of the paper data-driven",
  options = {
    {name = "library", value = "FILE.bwm", type = "file", needed = true,
      what = "the library of materials, which scripts/data_driven/build.lua makes"},
    {name = "scene", value = "NAME,...", list = true, one_of = scenes.order, word = "all",
      default = "all", what = "which scenes, or all"},
    script.option.out,
    {name = "only", value = "PART", one_of = {"scenes", "coarsening", "gradients", "library"},
      what = "only this part"},
  },
}

local library, why = bw.metamaterial.read(opts.library)
if not library then script.refuse(why) end
local out = {threads = bw.threads(), levels = library.levels}
local results = opts.out and assert(bw.results.open(opts.out, {script = "scripts/bench/data_driven.lua",
  inputs = {opts.library}, options = {scene = opts.scene, only = opts.only}}))

local function wanted(part) return not opts.only or opts.only == part end

-- ---- tables 1 and 2 ------------------------------------------------------------------------------

local function one_scene(name)
  local scene = scenes[name]
  local fine = assert(scenes.solid(scene, scenes.materials()))
  local paper = library_of.paper(name) or {}
  local rows = assert(compare.scene(scene, fine, {lookup = library}, {"lookup"}, function(row)
    local p = paper["level_" .. row.level]
    row.paper = p
    if row.failed then return print(("  %-12s %d  %s"):format(name, row.level, row.failed)) end
    print(("  %-12s %d %8d | %9.4f (%9s) %6s | %7.1f (%6s) | %4.0f %% | %4d (%3s) | %s"):format(name, row.level,
      row.elements, row.seconds_per_iteration, p and ("%.3f"):format(p.seconds_per_iteration) or "",
      p and ("%.1fx"):format(p.seconds_per_iteration / row.seconds_per_iteration) or "", row.speed_up or 1,
      p and ("%.1f"):format(p.speed_up) or "", 100 * row.quadrature_fraction, row.iterations,
      p and tostring(p.iterations) or "", row.error and ("%.2e"):format(row.error) or ""))
    io.stdout:flush()
  end))
  return rows
end

if wanted "scenes" then
  print("  example  level elements | s / iteration (paper)   less | faster  (paper) | quadrature | "
    .. "iterations | error")
  out.scenes = {}
  local names = opts.scene == "all" and scenes.order or opts.scene
  for _, name in ipairs(names) do out.scenes[name] = one_scene(name) end
end

-- ---- coarsening ----------------------------------------------------------------------------------

-- The median of several runs of the clock, ms: coarsening is short.
local function median(count, f)
  local list = {}
  for i = 1, count do
    collectgarbage()
    local clock = bw.seconds()
    f(i)
    list[i] = 1e3 * (bw.seconds() - clock)
  end
  table.sort(list)
  return list[(count + 1) // 2]
end

if wanted "coarsening" then
  local grid = assert(bw.grid.box {cells = {50, 50, 40}, spacing = 0.01,
    material = function(x, y, z) return (x // 0.01 * 7 + y // 0.01 * 3 + z // 0.01 * 5) // 1 % 3 + 1 end})
  local fine = assert(bw.solid {grid = grid, materials = scenes.materials()})
  out.coarsening = {elements = grid.element_count, ms = {}}
  for level = 1, library.levels do
    local inside = {}
    local all = median(7, function(i) inside[i] = 1e3 * assert(fine:coarsen(library, level)).coarse.seconds end)
    table.sort(inside)
    out.coarsening.ms[level] = {coarsening = inside[4], with_the_solid = all}
    print(("coarsening %d elements, %d level%s: %.1f ms (paper's time of George, 46152 elements: 200 ms); "
      .. "with the "
      .. "coarse solid %.1f ms"):format(grid.element_count, level, level > 1 and "s" or "", inside[4], all))
  end
  local edited = assert(grid:set({min = {0.1, 0.1, 0.1}, max = {0.2, 0.2, 0.2}}, 1))
  local coarse, looked_up = assert(fine:coarsen(library, 1)), 0
  out.coarsening.edit_ms = median(7, function() looked_up = assert(coarse:with(edited)).coarse.looked_up end)
  out.coarsening.edit_looked_up = looked_up
  print(("an edit of 1000 elements: %d blocks looked up, %.1f ms"):format(looked_up, out.coarsening.edit_ms))
end

-- ---- conjugate gradients -------------------------------------------------------------------------

if wanted "gradients" then
  local fine = assert(scenes.solid(scenes.george_bone, scenes.materials()))
  local solids = {[0] = fine}
  for level = 1, library.levels do solids[level] = assert(fine:coarsen(library, level)) end
  out.gradients = bw.json.list {}
  local base
  local function row(level, linear, options)
    local spent, result, message = compare.timed(solids[level].solve, solids[level], compare.as_it_is(options))
    if not result then return print(("  level %d, %-7s %s"):format(level, linear, message)) end
    local report = result.newton
    if level == 0 and linear == "jacobi" then base = spent.processor end
    out.gradients[#out.gradients + 1] = {level = level, linear = linear, seconds = spent.processor,
      iterations = report.iterations, cg_iterations = report.cg_iterations}
    print(("  level %d, %-7s %8.2f s, %3d iterations, %6d of conjugate gradients (%.0f each)%s"):format(level,
      linear,
      spent.processor, report.iterations, report.cg_iterations, report.cg_iterations / report.iterations,
      linear == "jacobi" and level > 0 and base and (", %.0f times faster than fine (paper: %d)"):format(
        base / spent.processor, level == 1 and 20 or 67) or ""))
    io.stdout:flush()
  end
  print "the figure with bones: node blocks (jacobi), factors (direct), a coarse solid (coarse)"
  for level = 0, library.levels do
    row(level, "jacobi", {solver = bw.solver.pcg {preconditioner = bw.solver.jacobi()}})
    row(level, "direct", {solver = bw.solver.cholesky()})
    if level == 0 then row(level, "coarse", {solver = bw.solver.pcg(), coarse = solids[1]}) end
  end
end

-- ---- building ------------------------------------------------------------------------------------

if wanted "library" then
  local materials = {scenes.materials()[1], scenes.materials()[3]}
  local spent, made = compare.timed(bw.metamaterial.build, materials, {voids = false})
  made = assert(made)
  local fits = #made.errors[1]
  out.library = {fits = fits, seconds = spent.processor, seconds_clock = spent.clock,
    seconds_per_block = spent.processor / fits, shipped_seconds = library.seconds,
    shipped_fits = #library.errors[1]}
  print(("a library of two materials, default options: %d blocks, %.1f s of the processor, %.2f s each"):format(
    fits,
    spent.processor, spent.processor / fits))
  if library.seconds > 0 then -- not kept in files of every version
    print(("the library used: %d blocks of level 1, built in %.0f s"):format(#library.errors[1], library.seconds))
  end
end

if results then assert(results:write(out)) end
