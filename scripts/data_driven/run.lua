-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The experiments of the paper data-driven: each solved on its fine grid, and coarse by lookup, by lookup
-- in the library grown for the grid, naively and by averages, beside the numbers of its table 1.
local folder = arg[0]:match "^(.*)/[^/]*$" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local compare = require "compare"
local library_of = require "library"
local transient = require "transient"
local page = require "page"
local scenes = require "scenes"
local script = require "barwright.command.script"

local SOLVED, NOT_SOLVED = 0, 1

local function read_arguments()
  local opts = script.read {
    summary = "the experiments of the paper data-driven",
    about = "Solves each scene on its fine grid and coarse: by lookup, by lookup in the library grown for the "
      .. "grid, naively and by averages. The errors stand beside the numbers of table 1 of the paper.\n\n"
      .. "The library is built into DIR/three.bwm when none is given; a build that was interrupted carries on. "
      .. "Without lookup among the methods none is built: grown then begins from nothing. DIR gets a folder for "
      .. "each scene with result.json, manifest.json, report.html and pictures, and a report over all scenes that "
      .. "were run into it.\n\n"
      .. "Exit status: 0 all solved; 1 something did not solve; 2 the input was refused; 130 interrupted, what is "
      .. "done is kept.",
    options = {script.option.needed_out,
      scenes.option.scene, scenes.option.library,
      scenes.option.methods {"lookup", "grown", "naive", "average"},
      scenes.option.levels(),
      script.option.threads,
      {name = "no-transient", type = "flag", what = "leave out the transient dynamics after the release"},
    },
  }
  if opts.scene == "all" then opts.scene = scenes.order end
  return opts
end

local function say(name, row)
  if row.failed then
    print(("%-12s %-8s %d  %7d elements  did not solve: %s"):format(name, row.method, row.level,
      row.elements, row.failed))
  else
    print(("%-12s %-8s %d  %7d elements %4d iterations %9.4f s each  %s"):format(name, row.method,
      row.level, row.elements, row.iterations, row.seconds_per_iteration,
      row.error and ("error %.2e, %6.1f times faster"):format(row.error, row.speed_up) or
      ("moved by %.2e"):format(row.movement)))
  end
  io.stdout:flush()
end

-- The materials of the sole are edited one after the other; only what differs is looked up again.
local function edit(scene, fine, library, result, out)
  local list = bw.json.list {}
  result.edits = list
  local grid = fine.grid
  local coarse, message, details
  if library then
    coarse, message, details = fine:coarsen(library, 1)
    if not coarse then return nil, message, details end
  end
  for i, change in ipairs(scene.edits) do
    local row = {words = change.words}
    grid, message, details = grid:set(change.region, change.material)
    if not grid then return nil, message, details end
    fine, message, details = fine:with(grid)
    if not fine then return nil, message, details end
    local spent, reference, solution
    spent, reference, message, details = compare.timed(fine.solve, fine, scene.solve)
    if not reference then return nil, message, details end
    row.seconds_fine, row.deepest_m = spent.processor, -reference.displacement:column(3):min()
    local panels = {{title = "materials", grid = grid}, reference:panel("fine", "movement")}
    if coarse then
      spent, coarse, message, details = compare.timed(coarse.with, coarse, grid)
      if not coarse then return nil, message, details end
      row.seconds_coarsening, row.looked_up = spent.clock, coarse.coarse.looked_up
      spent, solution, message, details = compare.timed(coarse.solve, coarse, compare.as_it_is(scene.solve))
      if not solution then return nil, message, details end
      row.seconds_coarse, row.error = spent.processor, select(2, solution:error(reference))
      row.speed_up = row.seconds_fine / row.seconds_coarse
      panels[3] = solution:panel("lookup", "movement")
      print(("   %s: %d blocks looked up, coarsened in %.2f ms, error %.2e, %.1f times faster"):format(
        change.words, row.looked_up, 1e3 * row.seconds_coarsening, row.error, row.speed_up))
    end
    list[i] = row
    local drawn
    drawn, message, details = bw.grid.picture(("%s/edit_%d.png"):format(out, i), panels,
      {direction = scene.direction, up = {0, 0, 1}, width = 440, height = 360, columns = #panels,
        unit = "movement, mm", scale = 1e3, min = 0})
    if not drawn then return nil, message, details end
  end
  return true
end

local function move(scene, fine, by, solutions, result, out)
  local list = {}
  for _, done in ipairs(solutions) do
    local method, level = done.row.method, done.row.level
    if done.solution and level == 1 and by[method] and method ~= "average" then
      list[#list + 1] = {title = method .. ", level 1", by = by[method], solution = done.solution}
    elseif method == "fine" and scene.transient.fine then
      list[#list + 1] = {title = "fine", solution = done.solution}
    end
  end
  if #list == 0 then return true end
  local opts = {direction = scene.direction}
  for key, value in pairs(scene.transient) do opts[key] = value end
  local message, details
  result.transient, message, details = transient.run(out, opts, fine, list)
  if not result.transient then return nil, message, details end
  for _, each in ipairs(result.transient.solids) do
    print(("   in motion, %s: %.3f s a step of %g ms"):format(each.title, each.seconds_per_step,
      1e3 * result.transient.step_s))
  end
  return true
end

-- The library with fits for the blocks of the scene's own grid, when the options ask for it.
local function grow(scene, fine, opts, library, result)
  local wanted = false
  for _, method in ipairs(opts.methods) do wanted = wanted or method == "grown" end
  if not wanted then return nil end
  local spent, grown, message, details = compare.timed(bw.metamaterial.grow, library or scenes.materials(),
    fine.grid, {levels = scene.levels})
  if not grown then return nil, message, details end
  local blocks = 0
  for level = 1, 2 do
    blocks = blocks + grown.grown[level] - (library and library.grown[level] or 0)
  end
  result.growing = {blocks = blocks, seconds = spent.processor, seconds_clock = spent.clock}
  print(("   grown for its grid: %d blocks, %.1f s"):format(blocks, spent.processor))
  return grown
end

-- Everything about one scene, into its folder; true when all of it solved.
local function run(name, opts, library)
  local scene = {}
  for key, value in pairs(scenes[name]) do scene[key] = value end
  if opts.levels then scene.levels = math.min(scene.levels, opts.levels) end
  local out = opts.out .. "/" .. name
  local results, message = bw.results.open(out, {script = "scripts/data_driven/run.lua",
    options = {scene = name, methods = opts.methods, levels = scene.levels}, inputs = {opts.library}})
  if not results then script.refuse(message) end
  local fine, rows, reference, partial, _
  fine, message = scenes.solid(scene, scenes.materials())
  local result = {scene = name, words = scene.words, paper = library_of.paper(name), finished = false,
    rows = bw.json.list {}}
  local solutions, solved = {}, true
  local by = {lookup = library, naive = "naive", average = "average"}
  if fine then by.grown, message = grow(scene, fine, opts, library, result) end
  if fine and not message then
    rows, reference, _, partial = compare.scene(scene, fine, by, opts.methods,
      function(row, solution)
        say(name, row)
        if row.failed then solved = false end
        result.rows[#result.rows + 1] = row
        solutions[#solutions + 1] = {row = row, solution = solution}
      end)
    if not rows then message, result.rows = reference, partial or result.rows end
  end
  local drawn = rows
  if rows then
    drawn, message = page.pictures(out, scene, fine, solutions)
    if drawn and scene.edits then drawn, message = edit(scene, fine, library, result, out) end
    if drawn and scene.transient and not opts.no_transient then
      drawn, message = move(scene, fine, by, solutions, result, out)
    end
  end
  result.finished = drawn and true or false
  if not result.finished then
    result.message = bw.interrupted() and "interrupted" or message
    print(("%-12s %s"):format(name, result.message))
  end
  assert(results:write(result))
  assert(page.write(out, result))
  assert(page.overall(opts.out, scenes.order))
  return result.finished and solved
end

local opts = read_arguments()
local library
for _, method in ipairs(opts.methods) do
  if not library and (method == "lookup" or (method == "grown" and opts.library)) then
    local levels = 1
    for _, name in ipairs(opts.scene) do
      levels = math.max(levels, math.min(scenes[name].levels, opts.levels or 2))
    end
    local message
    library, message = library_of.get(opts, scenes.materials(), levels)
    if not library then script.fail(script.REFUSED, message) end
  end
end
local all = true
for _, name in ipairs(opts.scene) do
  all = run(name, opts, library) and all
  if bw.interrupted() then script.stop(script.INTERRUPTED, "interrupted; what is done is kept") end
end
os.exit(all and SOLVED or NOT_SOLVED, true)
