-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One worst case of a large free body: where time and memory go, and what solved.
local bw = require "barwright"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "the worst case of a large body",
  about = "Prints where processor seconds and memory of one worst case go. BODY is block:N, N x N x N cells of "
    .. "six elements, or brick:N, N x 0.8 N x 0.6 N cells.",
  arguments = {{name = "body", what = "what to analyse"}},
  options = {
    {name = "solver", value = "NAME", type = "string", default = "auto", one_of = {"auto", "pcg", "cholesky"},
      what = "the linear solver"},
    {name = "order", value = "1|2", type = "integer", default = 2, one_of = {1, 2}, what = "of the elements"},
    {name = "method", value = "NAME", type = "string", default = "paper", one_of = {"paper", "search"},
      what = "of the worst case"},
  },
}

local shapes = {block = {{1, 0.05}, {1, 0.05}, {1, 0.05}}, brick = {{1, 0.05}, {0.8, 0.041}, {0.6, 0.031}}}
local shape, cells = opts.body:match "^(%a+):(%d+)$"
local sides = shapes[shape or ""]
if not sides then script.refuse(("BODY: block:N or brick:N expected, got '%s'"):format(opts.body)) end

local function processor()
  local fields = {}
  for field in io.open "/proc/self/stat":read "a":match "%) (.*)":gmatch "%S+" do fields[#fields + 1] = field end
  return (tonumber(fields[12]) + tonumber(fields[13])) / 100
end

local count, size = {}, {}
for i, side in ipairs(sides) do count[i], size[i] = math.floor(side[1] * tonumber(cells)), side[2] end
local mesh = assert(bw.mesh.box {max = size, cells = count, order = opts.order})
local part = bw.model {mesh = mesh, material = bw.material.pla}
local solvers = {
  pcg = bw.solver.pcg(opts.order == 1 and {preconditioner = bw.solver.amg()} or nil),
  cholesky = bw.solver.cholesky(),
}
local solver = solvers[opts.solver]
local seconds, spent = bw.seconds(), processor()
local worst = assert(bw.worst_case(part, {method = opts.method, solver = solver}))
seconds, spent = bw.seconds() - seconds, processor() - spent
local peak = tonumber(io.open "/proc/self/status":read "a":match "VmHWM:%s+(%d+)") * 1024
print(("%d tet%d, %d unknowns: %.1f s, %.1f processor seconds, %.2f GB"):format(mesh.element_count,
  opts.order == 1 and 4 or 10, 3 * mesh.node_count, seconds, spent, peak / 1e9))
for _, key in ipairs {"system", "modes", "regions", "linear_programs", "search"} do
  if worst.seconds[key] then print(("  %s: %.1f s"):format(key, worst.seconds[key])) end
end
print(("largest stress %.14g Pa, solve error %.2g"):format(worst.max_principal, worst.solve_error))
print(worst.reports.solver)
print(worst.modes.report)
