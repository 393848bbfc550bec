-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Heat in a cube with a source, one cold face and a film on the opposite one: the steady state, and steps in time.
local bw = require "barwright"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "heat of a cube: the steady state and steps in time",
  about = "A steel cube of 1 m, of N x N x N cells of six tetrahedra, by conjugate gradients. Processor seconds, "
    .. "and the largest memory of the process until then. Steps are of 50 s, by BDF2, after one that makes the "
    .. "preconditioner. Prints a Markdown table.",
  arguments = {{name = "cells", type = "integer", min = 2, many = true, optional = true,
    what = "cells along an edge, ascending for the memory (default 37: 303,918 elements)"}},
  options = {
    {name = "order", value = "N", type = "integer", default = 2, min = 1, max = 2, what = "order of elements"},
    {name = "bond", type = "flag", what = "cut the cube in two, which a bond joins"},
    {name = "steps", value = "N", type = "integer", default = 20, min = 1, max = 10000, what = "steps in time"},
  },
}

local solver = bw.solver.pcg {preconditioner = opts.order == 2 and bw.solver.two_level {} or bw.solver.jacobi {}}
local function memory() return ("%.0f"):format((bw.results.peak_memory() or 0) / 1e6) end

print "| elements | nodes | iterations | steady, s | memory, MB | iterations of a step | a step, s | memory, MB |"
print "|---|---|---|---|---|---|---|---|"
for _, n in ipairs(#opts.cells > 0 and opts.cells or {37}) do
  local mesh = bw.mesh.box {max = {1, 1, 1}, cells = {n, n, n}, order = opts.order}
  if opts.bond then mesh = mesh:split({max = {n // 2 / n, 1, 1}}, "left"):separated "left" end
  local boundary = mesh.boundary
  local heat = bw.heat {mesh = mesh, material = bw.material.steel}
  heat:prescribe(boundary:below("x", 0), 300):load {source = 1e4}
  heat:load {on = boundary:above("x", 1), convection = {coefficient = 50, temperature = 400}}
  if opts.bond then heat:bond {a = boundary:region "left", b = boundary:region "rest"} end
  local start = os.clock()
  local steady = assert(heat:solve {solver = solver})
  local seconds, used = os.clock() - start, memory()
  local transient = assert(heat:transient {initial = 300, scheme = "bdf2", solver = solver})
  assert(transient:step(50))
  start = os.clock()
  for _ = 1, opts.steps do assert(transient:step(50)) end
  print(("| %d | %d | %d | %.1f | %s | %d | %.2f | %s |"):format(mesh.element_count, mesh.node_count,
    steady.report.iterations, seconds, used, transient.now.report.iterations,
    (os.clock() - start) / opts.steps, memory()))
end
