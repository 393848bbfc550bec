-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How far a coarse result is off, without the fine one, and the better of two coarse solids.
--
-- Few Newton steps of the fine solid from the coarse displacements, each with few iterations of
-- conjugate gradients over coarse solids, go most of the way to the fine solution. How far they went is
-- the estimate (engine/nonlinear/correction.c).
local core = require "barwright.core"

local estimate = {}

local STEPS, CG_ITERATIONS = 2, 8

-- Of solids.lua, which stands on this file: case_of, own_coarse, fine_of, naive_of, solve_itself.
local of_solids

--- Tells the functions of solids that this file needs.
function estimate.begin(functions)
  of_solids = functions
end

local function corrected(result)
  local fine, message, details = of_solids.fine_of(result.solid)
  if not fine then return nil, message, details end
  if fine.body.formulation == "b_bar" then -- coarse cells would lock where the fine ones are made not to
    return nil, "the error of a coarse solid is not estimated where a material is B-bar", {status = "unsupported"}
  end
  local case
  case, message, details = of_solids.case_of(fine, 1)
  if not case then return nil, message, details end
  local under
  under, message, details = of_solids.own_coarse(fine, true)
  if message then return nil, message, details end
  local moved
  local solver = core.solver.pcg {max_iterations = CG_ITERATIONS,
    preconditioner = not under and core.solver.jacobi() or nil}
  moved, message, details = fine.body:correct(case, {iterations = STEPS, solver = solver, coarse = under},
    result.fine_displacement)
  if moved then return moved end
  return nil, message or "the coarse displacements invert elements of the fine grid",
    details or {status = "geometry"}
end

--- Of a coarse result: relative to the displacement, over the longest side, corrected displacements.
function estimate.of(result)
  if not result.solid.coarse then
    return nil, "a result of a coarse solid expected: one of the fine solid has no such error",
      {status = "unsupported"}
  end
  local moved, message, details = corrected(result)
  if not moved then return nil, message, details end
  local grid = result.solid.coarse.fine
  local distance = grid:difference(result.fine_displacement, moved)
  local size = grid:difference(moved, core.array.zeros(#moved, 3))
  return distance == 0 and 0.0 or distance / size, distance, moved
end

-- The result of a coarse solid, and its estimated error: nil, message, details where either has none.
local function estimated(coarse, opts)
  local result, message, details = of_solids.solve_itself(coarse, opts)
  if not result then return nil, nil, message, details end
  local relative
  relative, message, details = estimate.of(result)
  if not relative then return result, nil, message, details end
  rawget(result, "cache").estimated_error = relative
  return result, relative
end

-- What ran out or was cancelled says nothing of a solid.
local function ended(details)
  local status = details and details.status
  return status == "memory" or status == "cancelled" or status == "limit"
end

--- The equilibrium of a solid made coarse by a library, or of the naive one where that is estimated to be nearer
--- to the fine one. result.choice = {chosen = "library" | "naive", library =, naive =}: the two estimates, nil
--- where there is none, with the message and details of why. nil, message, details where neither solid has an
--- equilibrium.
function estimate.better(coarse, opts)
  local result, relative, message, details = estimated(coarse, opts)
  if ended(details) then return nil, message, details end
  local twin, why, what = of_solids.naive_of(coarse)
  local naive, of_naive
  if twin then naive, of_naive, why, what = estimated(twin, opts) end
  if ended(what) then return nil, why, what end
  if not result and not naive then return nil, message, details end
  local by_library = result and not (of_naive and not (relative and relative <= of_naive))
  local best = by_library and result or naive
  rawget(best, "cache").choice = {chosen = by_library and "library" or "naive", library = relative,
    naive = of_naive, message = message or why, details = details or what}
  return best
end

return estimate
