-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Static solutions of one load case by two-level conjugate gradients and by the factor: seconds, processor
-- seconds, memory, iterations, and how far the two are apart. Each solution is a process of its own, from the mesh
-- to the displacements.
local bw = require "barwright"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "static solutions by two-level conjugate gradients beside the factors",
  about = "Prints a Markdown table; each row is a process of its own that solves once.\n\n"
    .. "A BODY is SHAPE:CELLS or SHAPE:CELLS:SOLVER, of cubes of six tet10 each: block (N x N x N cells), bar "
    .. "(8N x N x N) or plate (16N x 16N x N). SOLVER is pcg, multifrontal or cholmod; without it, all. With amg "
    .. "elements are tet4.",
  arguments = {{name = "body", many = true, optional = true,
    what = "what to solve (default block:12 block:19 block:26 block:37:pcg)"}},
  options = {{name = "here", type = "flag",
    what = "solve the first BODY, which names its solver, in this process, and print its row alone"}},
}

local solvers = {
  pcg = function() return bw.solver.pcg() end,
  amg = function() return bw.solver.pcg {preconditioner = bw.solver.amg()} end,
  multifrontal = function() return bw.solver.cholesky {backend = "multifrontal"} end,
  cholmod = function() return bw.solver.cholesky {backend = "cholmod"} end,
}
local shapes = {block = {1, 1, 1}, bar = {8, 1, 1}, plate = {16, 16, 1}}

local function processor()
  local fields = {}
  local line = io.open "/proc/self/stat":read "a"
  for field in line:match "%) (.*)":gmatch "%S+" do fields[#fields + 1] = field end
  return (tonumber(fields[12]) + tonumber(fields[13])) / 100
end

local function measure(body, cells, with)
  local n, size = {}, {}
  for i, k in ipairs(shapes[body]) do n[i], size[i] = k * cells, k end
  local order = with == "amg" and 1 or 2
  local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = size, cells = n, order = order})
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, size[1]), force = {1e3, 0, -1e3}}
  local function peak()
    return tonumber(io.open "/proc/self/status":read "a":match "VmHWM:%s+(%d+)") * 1024
  end
  local seconds, spent = bw.seconds(), processor()
  local static = assert(part:solve {solver = solvers[with]()})
  seconds, spent = bw.seconds() - seconds, processor() - spent
  local report = static.report
  local tip = static.displacement:column(3):min()
  print(("| %s %d, %d tet%d | %d | %s | %.1f | %.1f | %s | %.2f | %.2f | %.1e | %.12g |"):format(body, cells,
    mesh.element_count, order == 1 and 4 or 10, mesh.node_count * 3, with, seconds, spent,
    report.iterations or "", peak() / 1e9, report.bytes / 1e9, static.residual, tip))
end

local function parts_of(text)
  local body, cells, solver = text:match "^(%a+):(%d+):?(%a*)$"
  if not shapes[body] or (solver ~= "" and not solvers[solver]) then
    script.refuse(("BODY: block:N, bar:N or plate:N, with :pcg, :amg, :multifrontal or :cholmod behind it or not, "
      .. "expected, got '%s'"):format(text))
  end
  return body, tonumber(cells), solver
end

if opts.here then
  if not opts.body[1] then script.refuse "--here needs a BODY" end
  local body, cells, solver = parts_of(opts.body[1])
  if solver == "" then script.refuse "--here needs a solver behind the BODY: block:12:pcg" end
  measure(body, cells, solver)
  return
end

local program = io.popen "readlink /proc/$PPID/exe":read "l"
print("| body | unknowns | solved | seconds | processor seconds | iterations | peak GB "
  .. "| factor or preconditioner, GB | residual | largest fall, m |")
print "|---|---|---|---|---|---|---|---|---|---|"
for _, text in ipairs(#opts.body > 0 and opts.body or {"block:12", "block:19", "block:26", "block:37:pcg"}) do
  local body, cells, only = parts_of(text)
  for _, with in ipairs(only ~= "" and {only} or {"pcg", "multifrontal", "cholmod"}) do
    os.execute(("BARWRIGHT_QUIET=1 %s %s --here %s:%d:%s"):format(program, arg[0], body, cells, with))
  end
end
