-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A free block's modes by the engine, and its matrices in a folder for scripts/bench/slepc_block.py.
local bw = require "barwright"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "modes of a free block, and its matrices for another program",
  about = "A cube of CELLS^3 cells of six tet10. Writes k.npz, m.npz, nodes.npy and eigenvalues_SOLVER.npy, and "
    .. "prints a Markdown row for each solver.",
  arguments = {{name = "cells", type = "integer", min = 2, what = "cells along an edge"},
    {name = "folder", what = "where files are written; it exists"}},
  options = {
    {name = "count", value = "N", type = "integer", default = 15, min = 2, max = 500, what = "number of modes"},
    {name = "solvers", value = "NAME,NAME,...", list = true, default = {"lobpcg"},
      what = "the eigensolvers, by the names of bw.eigensolver"},
  },
}

local function processor()
  local fields = {}
  for field in io.open "/proc/self/stat":read "a":match "%) (.*)":gmatch "%S+" do fields[#fields + 1] = field end
  return (tonumber(fields[12]) + tonumber(fields[13])) / 100
end

local n = opts.cells
local mesh = assert(bw.mesh.box {max = {0.05, 0.05, 0.05}, cells = {n, n, n}, order = 2})
print "| unknowns | solver | modes | iterations | seconds | processor seconds | GB | residual |"
print "|---|---|---|---|---|---|---|---|"
for _, name in ipairs(opts.solvers) do
  local part = bw.model {mesh = mesh, material = bw.material.pla}
  local seconds, spent = bw.seconds(), processor()
  local modes = assert(part:modes {count = opts.count, solver = bw.eigensolver[name] {}})
  print(("| %d | %s | %d | %d | %.1f | %.1f | %.2f | %.1e |"):format(3 * mesh.node_count, name, modes.count,
    modes.report.iterations or 0, bw.seconds() - seconds, processor() - spent, bw.results.peak_memory() / 1e9,
    modes.residuals:max()))
  assert(modes.eigenvalues:write(("%s/eigenvalues_%s.npy"):format(opts.folder, name)))
  modes:close()
  part:close()
  collectgarbage()
end
local system = assert(bw.model {mesh = mesh, material = bw.material.pla}:system {solver = bw.solver.pcg()})
assert(assert(system:matrix("stiffness", {whole = true})):write(opts.folder .. "/k.npz"))
assert(assert(system:matrix("mass", {whole = true})):write(opts.folder .. "/m.npz"))
assert(mesh.nodes:write(opts.folder .. "/nodes.npy"))
