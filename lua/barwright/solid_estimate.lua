-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How far a coarse result is off, without the fine one, and the better of two coarse solids.
--
-- Few Newton steps of the fine solid from the coarse displacements, each with few iterations of
-- conjugate gradients over coarse solids, go most of the way to the fine solution. How far they went is
-- the estimate (engine/nonlinear/correction.c).
local core = require "barwright.core"
local options = require "barwright.options"

local estimate = {}

local STEPS, CG_ITERATIONS = 2, 8

-- Of solids.lua, which stands on this file: case_of, own_coarse, fine_of.
local of_solids

--- Tells the functions of solids that this file needs.
function estimate.begin(functions)
  of_solids = functions
end

local function corrected(result)
  local fine, message, details = of_solids.fine_of(result.solid)
  if not fine then return nil, message, details end
  local case
  case, message, details = of_solids.case_of(fine, 1)
  if not case then return nil, message, details end
  local under
  under, message, details = of_solids.own_coarse(fine, true)
  if message then return nil, message, details end
  local moved
  moved, message, details = fine.body:correct(case, {iterations = STEPS, cg_iterations = CG_ITERATIONS,
    coarse = under}, result.fine_displacement)
  if moved then return moved end
  return nil, message or "the coarse displacements turn fine elements inside out", details or {status = "geometry"}
end

--- Of a coarse result: relative to the displacement, over the longest side, corrected displacements.
function estimate.of(result)
  if not result.solid.coarse then
    return nil, "a result on the fine grid has no coarse error to estimate", {status = "unsupported"}
  end
  local moved, message, details = corrected(result)
  if not moved then return nil, message, details end
  local grid = result.solid.coarse.fine
  local distance = grid:difference(result.fine_displacement, moved)
  local size = grid:difference(moved, core.array.zeros(#moved, 3))
  return distance == 0 and 0.0 or distance / size, distance, moved
end

-- The result on a coarse grid with what is estimated of it; nil, message, details.
local function solved(fine, by, levels, wish)
  local coarse, message, details = fine:coarsen(by, levels)
  if not coarse then return nil, message, details end
  local result
  result, message, details = coarse:solve(wish)
  if not result then return nil, message, details end
  local relative
  relative, message, details = result:estimate_error()
  if not relative then return nil, message, details end
  return result, relative
end

--- The result by a library or that of the naive coarse solid, whichever is estimated to be nearer to the
--- fine one; and {chosen = "library" | "naive", library =, naive =}: the two estimates, nil where a solid
--- has no equilibrium. nil, message, details where neither has one.
function estimate.better(fine, given)
  if type(given) ~= "table" then
    core.raise(("solve_coarse: a table of options expected, got %s"):format(type(given)))
  end
  local wish = {}
  for key, value in pairs(given) do wish[key] = value end
  local own = options.read("solve_coarse", {by = wish.by, levels = wish.levels}, {
    by = {type = "library", needed = true}, levels = {type = "integer", default = 1, least = 1, most = 2}})
  wish.by, wish.levels = nil, nil
  local naive, of_naive, naive_details = solved(fine, "naive", own.levels, wish)
  local other, of_other, details = solved(fine, own.by, own.levels, wish)
  if not naive and not other then return nil, of_other, details end
  local chosen = other and (not naive or of_other < of_naive) and "library" or "naive"
  return chosen == "library" and other or naive,
    {chosen = chosen, library = other and of_other, naive = naive and of_naive,
      message = not other and of_other or not naive and of_naive or nil,
      details = not other and details or not naive and naive_details or nil}
end

return estimate
