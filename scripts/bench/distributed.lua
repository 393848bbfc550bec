-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- PETSc and SLEPc beside the engine's own factor: time, memory, iterations. Each row is a process of its own.
local bw = require "barwright"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "PETSc and SLEPc under 1 and 2 ranks beside the engine's own factor",
  about = "Starts `mpirun` with 1 and 2 ranks; each row is a process of its own that solves once. Prints a "
    .. "Markdown table.",
  arguments = {{name = "cells", type = "integer", min = 2, many = true, optional = true,
    what = "cells along an edge of the cube (default 16 28)"}},
  options = {
    {name = "here", value = "SOLVER", one_of = {"own", "own modes", "cholesky", "cg", "SLEPc modes"},
      what = "solve the first cube with this solver in this process, and print its row alone"},
    {name = "order", value = "N", type = "integer", default = 1, min = 1, max = 2,
      what = "order of elements, of --here"},
    {name = "ranks", value = "TEXT", default = "1", what = "what stands in the column of ranks, of --here"},
  },
}

local function measure(kind, cells, order, ranks)
  local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {cells, cells, cells},
    order = order})
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:below(3, 0)):load {on = mesh.boundary:above(3, 1), force = {1e3, 0, -1e3}}
  local seconds, processor = bw.seconds(), os.clock()
  local static, modes
  if kind == "own" then static = assert(part:solve())
  elseif kind == "own modes" then modes = assert(part:modes {count = 10})
  elseif kind == "SLEPc modes" then modes = assert(part:modes {count = 10, solver = bw.eigensolver.slepc {}})
  elseif kind == "cg" then
    static = assert(part:solve {solver = bw.solver.pcg {tolerance = 1e-8,
      preconditioner = bw.solver.amg {backend = "petsc"}}})
  else static = assert(part:solve {solver = bw.solver.cholesky {backend = "petsc"}}) end
  seconds, processor = bw.seconds() - seconds, os.clock() - processor
  local report = (static or modes).report
  local spread = report.ranks and report or {}
  local peak = tonumber(io.open "/proc/self/status":read "a":match "VmHWM:%s+(%d+)") * 1024
  local line = "| %d, tet%d | %s | %s | %.1f | %.1f | %s | %.2f | %.2f |"
  print(line:format(mesh.node_count * 3, order == 1 and 4 or 10, kind, ranks, seconds,
    spread.processor_seconds or processor, spread.iterations or "", (spread.bytes or peak) / 2 ^ 30,
    (spread.largest_rank_bytes or peak) / 2 ^ 30))
end

if opts.here then
  if not opts.cells[1] then script.refuse "--here needs CELLS" end
  measure(opts.here, opts.cells[1], opts.order, opts.ranks)
  return
end

local program = io.popen "readlink /proc/$PPID/exe":read "l"
local function start(kind, cells, order, ranks)
  local own = kind:find "own"
  local command = ("%s %s --here '%s' --order %d --ranks %s %d"):format(own and program or program .. " --mpi",
    arg[0], kind, order, own and "'2 threads'" or ranks, cells)
  if not own then
    command = ("OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 BARWRIGHT_THREADS=1 mpirun "
      .. "--oversubscribe --bind-to none -n %d %s"):format(ranks, command)
  end
  os.execute("BARWRIGHT_QUIET=1 " .. command)
end

local sizes = #opts.cells > 0 and opts.cells or {16, 28}
print "| unknowns | solver | ranks | seconds | processor seconds | iterations | GiB | largest rank |"
print "|---|---|---|---|---|---|---|---|"
for _, cells in ipairs(sizes) do
  for order = 1, 2 do
    local n = order == 1 and cells or cells // 2
    start("own", n, order)
    for _, method in ipairs {"cholesky", "cg"} do
      for ranks = 1, 2 do start(method, n, order, ranks) end
    end
  end
  start("own modes", cells, 1)
  for ranks = 1, 2 do start("SLEPc modes", cells, 1, ranks) end
end
