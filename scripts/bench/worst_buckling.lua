-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The load that buckles a real part first (docs/theory/stability.md): seconds, memory, what the search takes.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. package.path
local options = require "options"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "worst-case buckling of surfaces in files",
  arguments = {{name = "file", type = "file", what = "a surface; its longest side becomes 100 mm"}},
  options = {script.option.out, options.elements(40000),
    {name = "force", value = "FORCE", type = "number", default = 100, above = 0, what = "total force, N"},
    {name = "contact", value = "AREA", type = "number", default = 1e-4, above = 0, what = "least area, m2"},
    {name = "fixed", type = "flag", what = "fix the lowest twentieth along z"}},
}
local results = opts.out and assert(script.results(opts.out, opts, {script = "scripts/bench/worst_buckling.lua"}))

local surface = assert(bw.surface.read(opts.file, {unit = "mm"}))
local size = surface.box.size
surface = surface:scale(0.1 / math.max(size[1], size[2], size[3]))
local mesh = assert(bw.mesh.fill(surface, {elements = opts.elements, order = 2}))
local part = bw.model {mesh = mesh, material = bw.material.pla}
local box = mesh.box
if opts.fixed then part:fix(mesh.boundary:below("z", box.min[3] + box.size[3] / 20)) end

local before, processor, seconds = bw.results.peak_memory(), os.clock(), bw.seconds()
local worst = assert(bw.worst_buckling(part, {force = opts.force, contact = opts.contact}))
assert(worst.factor, tostring(worst))
local row = {elements = mesh.element_count, nodes = mesh.node_count, pressures = worst.basis.count,
  factor = worst.factor, error = worst.error, mesh_error = worst.mesh_error, counted = worst.counted,
  loads = #worst.loads, analyses = worst.analyses, seconds = bw.seconds() - seconds,
  processor_seconds = os.clock() - processor, memory_bytes_before = before,
  memory_bytes = bw.results.peak_memory()}
print(worst)
print(("%d tet10, %d nodes, %d pressures: factor %.6g within %.1e, %d loads of %d analyses; %.1f s, %.1f s of "
  .. "processor, %.2f GB (%.2f GB before)"):format(row.elements, row.nodes, row.pressures,
  row.factor, row.error, row.loads, row.analyses, row.seconds, row.processor_seconds,
  row.memory_bytes / 1e9, before / 1e9))
if results then results:write {rows = {row}} end
