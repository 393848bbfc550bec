-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The backends of the Cholesky factor beside each other: the same equations, one after the other in one run.
local bw = require "barwright"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "the factor of multifrontal and of cholmod, and a solution by it",
  about = "Prints a Markdown table; a row has the least of several runs, in which the backends take turns.\n\n"
    .. "A BODY is block:N (N x N x N cubes of six elements), bar:N (8N x N x N), or a file of a surface with a "
    .. "colon and a number of elements behind it.",
  arguments = {{name = "body", many = true, optional = true,
    what = "what to factor (default block:1 block:2 block:3 block:5 block:8 bar:4)"}},
  options = {
    {name = "runs", value = "N", type = "integer", default = 5, min = 1, what = "of each backend"},
    {name = "order", value = "1|2", type = "integer", default = 2, one_of = {1, 2}, what = "of the elements"},
    {name = "threads", value = "N", type = "integer", default = 1, min = 1,
      what = "threads; the processor seconds of one say the most on a busy machine"},
  },
}
bw.threads(opts.threads)

local backends = {
  {"multifrontal", bw.solver.cholesky {backend = "multifrontal"}},
  {"cholmod", bw.solver.cholesky {backend = "cholmod"}},
  {"cholmod, its ordering", bw.solver.cholesky {backend = "cholmod", ordering = "backend"}},
}

local function mesh_of(text)
  local name, count = text:match "^(.+):(%d+)$"
  if not name then
    script.refuse(("BODY: a name or file, a colon and a number expected, got '%s'"):format(text))
  end
  local n, long = tonumber(count), name == "bar" and 8 or 1
  if name == "block" or name == "bar" then
    return assert(bw.mesh.box {max = {long, 1, 1}, cells = {long * n, n, n}, order = opts.order})
  end
  return assert(bw.mesh.fill(assert(bw.surface.read(name)), {elements = n, order = opts.order}))
end

local function run(mesh, solver)
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  local box = mesh.box
  local size = box.max[1] - box.min[1]
  part:fix(mesh.boundary:below(1, box.min[1] + 0.02 * size)):gravity {0, 0, -9.81}
  local start = os.clock()
  local static = assert(part:solve {solver = solver})
  local times = static.times
  return {processor = os.clock() - start, order = times.order,
    factor = times.factor, solve = times.solve, bytes = static.report.bytes,
    flops = times.factor_flops, unknowns = assert(part:system()).unknown_count}
end

print("| body | unknowns | backend | ordering, s | factor, s | Gflop/s | solution, s | factor, GB | processor, s "
  .. "| over multifrontal |")
print "|---|---|---|---|---|---|---|---|---|---|"
local bodies = #opts.body > 0 and opts.body or {"block:1", "block:2", "block:3", "block:5", "block:8", "bar:4"}
for _, text in ipairs(bodies) do
  local mesh, best = mesh_of(text), {}
  for _ = 1, opts.runs do
    for i, backend in ipairs(backends) do
      local row = run(mesh, backend[2])
      best[i] = best[i] or row
      for key, value in pairs(row) do best[i][key] = math.min(best[i][key], value) end
    end
  end
  for i, backend in ipairs(backends) do
    local row = best[i]
    print(("| %s | %d | %s | %.4f | %.4f | %.1f | %.4f | %.3f | %.4f | %.2f |"):format(text:match "[^/]+$",
      row.unknowns, backend[1], row.order, row.factor, row.flops / row.factor / 1e9, row.solve, row.bytes / 1e9,
      row.processor, row.processor / best[1].processor))
  end
end
