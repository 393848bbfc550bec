-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A scene solved on its fine grid and on coarse ones: times, iterations, errors. Seconds are of the
-- processor, all threads together, which other programs on the machine do not change much; those of the
-- clock are kept beside them.
local bw = require "barwright"

local compare = {}

local function row_of(method, level, solid, solution, spent)
  local report = solution.newton
  local iterations = math.max(1, report.iterations)
  return {method = method, level = level, elements = solid.element_count, nodes = solid.node_count,
    iterations = report.iterations, load_steps = report.load_steps, cg_iterations = report.cg_iterations,
    seconds = spent.processor, seconds_clock = spent.clock,
    seconds_per_iteration = spent.processor / iterations,
    seconds_clock_per_iteration = spent.clock / iterations,
    quadrature_fraction = report.seconds_quadrature / math.max(report.seconds, 1e-9),
    residual = report.residual, energy_j = solution.energy,
    min_det_f = report.shape.min_ratio}
end

--- Runs f and returns what it returns after {processor =, clock =} seconds.
function compare.timed(f, ...)
  local clock, processor = bw.seconds(), os.clock()
  local a, b, c = f(...)
  return {clock = bw.seconds() - clock, processor = os.clock() - processor}, a, b, c
end

--- The mean distance of nodes from rest over the longest side: what an error is to be seen beside.
function compare.movement(solution)
  local u = solution.fine_displacement
  return solution.grid:difference(u, bw.array.zeros(#u, 3))
end

-- What a method coarsens by at a level; nil where that is nothing, or nothing of its own.
local function at_level(by, method, level)
  if type(by) ~= "userdata" then return by end
  if by.levels < level or (method == "grown" and by.grown[level] == 0) then return nil end
  return by
end

--- Options of solve under which a coarse solid answers for itself: its error is what is measured here.
function compare.as_it_is(options)
  local opts = {choose = false}
  for key, value in pairs(options or {}) do opts[key] = value end
  return opts
end

--- Rows of a scene: the fine solution, then by each of the methods at each level: `by[method]` is a
--- library ("lookup", "grown"), "naive" or "average". `each(row, solution)` is called as they are done.
--- Returns the rows and the fine solution; a coarse solid that has no solution is a row with `failed`.
--- nil, message, details, rows so far when the fine one has none or the run is interrupted.
function compare.scene(scene, fine, by, methods, each)
  local rows = bw.json.list {}
  local spent, reference, message, details = compare.timed(fine.solve, fine, scene.solve)
  if not reference then return nil, message, details, rows end
  local row = row_of("fine", 0, fine, reference, spent)
  row.movement = compare.movement(reference)
  rows[1] = row
  each(row, reference)
  for level = 1, scene.levels do
    for _, method in ipairs(methods) do
      local of = at_level(by[method], method, level)
      if of then
        local made, coarse
        made, coarse, message, details = compare.timed(fine.coarsen, fine, of, level)
        if not coarse then return nil, message, details, rows end
        local solution
        spent, solution, message = compare.timed(coarse.solve, coarse, compare.as_it_is(scene.solve))
        if bw.interrupted() then return nil, "interrupted", {status = "cancelled"}, rows end
        if solution then
          row = row_of(method, level, coarse, solution, spent)
          row.error = select(2, solution:error(reference))
          row.speed_up = rows[1].seconds / spent.processor
        else
          row = {method = method, level = level, elements = coarse.element_count, failed = message}
        end
        row.seconds_coarsening = made.clock
        rows[#rows + 1] = row
        each(row, solution)
      end
    end
  end
  return rows, reference
end

return compare
