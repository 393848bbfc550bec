-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The equations kept through edits beside new ones of the same shape.
local bw = require "barwright"
local bodies = require "bodies"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Edit sessions: equations kept",
  text = [[Random sequences of six edits (scaling, turning, moving, reaching, undo, redo) through sessions with
gravity, pressure, a total force, a torque, fixed and sliding supports. What updates, partial refactoring and
lagged-factor iterations leave is compared with a rebuild of everything. Theory: [edit.md](theory/edit.md).]]}

local edits_each = 6
local iterate = bw.solver.pcg {preconditioner = bw.solver.cholesky()}

-- By the method that the session chooses, or by iterating, as far as that converges.
local function solve(session, random)
  if random(0, 1) < 0.5 then
    local result, message, details = session:solve {check = true, solver = iterate}
    if result then return result end
    assert(details.status == "convergence", message)
  end
  return assert(session:solve {check = true})
end

-- A sequence of edits; after each but the last sometimes a solve, after the last always. Returns the
-- largest differences: of the stiffness, of the solution with a new factor (both by the engine's
-- own check), of displacement and stress with those of a new part of the shape.
local function sequence(body, random, seen)
  local session = bodies.session(body)
  for i = 1, edits_each do
    seen.edits = seen.edits + 1
    if not bodies.edit(session, random) then seen.refused = seen.refused + 1 end
    if i == edits_each or random(0, 1) < 0.5 then
      local result = solve(session, random)
      local reused = result.reused
      seen.solves = seen.solves + 1
      seen.iterated = seen.iterated + (reused.preconditioner == "cholesky" and 1 or 0)
      seen.refilled = seen.refilled + (reused.mesh == "refilled" and 1 or 0)
      seen.stiffness = math.max(seen.stiffness, reused.difference_stiffness)
      seen.solution = math.max(seen.solution, reused.difference_solution)
      local direct = assert(session.part:solve())
      local u, s = direct.displacement, direct.von_mises
      seen.displacement = math.max(seen.displacement, (u - result.displacement):norm() / u:norm())
      seen.stress = math.max(seen.stress, (s - result.von_mises):norm() / s:norm())
      direct:close()
      result:close()
    end
  end
  session:close()
end

local function sequences(each)
  local random = bodies.random(20151)
  for _, body in ipairs(bodies.list) do
    local seen = {edits = 0, refused = 0, solves = 0, iterated = 0, refilled = 0, stiffness = 0,
      solution = 0, displacement = 0, stress = 0}
    for _ = 1, each do sequence(body, random, seen) end
    local function row(what, key, bound, how)
      expect(seen[key], body.name .. ": " .. what):below(bound, {how = how})
    end
    row("stiffness", "stiffness", 1e-12, ("%d sequences, %d edits (%d refused), %d solves; largest "
      .. "difference of an entry, of the largest"):format(each, seen.edits, seen.refused, seen.solves))
    row("solution", "solution", 1e-8, ("with a new factor; %d solves iterated, %d are on refilled meshes")
      :format(seen.iterated, seen.refilled))
    row("displacement", "displacement", 1e-8, "with a new part of the shape; norm over the nodes")
    row("von Mises stress", "stress", 1e-8, "likewise")
  end
end

scenario("Equations kept through 30 sequences", function() sequences(10) end)

scenario("Equations kept through 510 sequences", {tags = {"slow", "long"}, seconds = 7200},
  function() sequences(170) end)
