-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Random drops in time of a bottle opener of tet10, beside the drop test and the worst case: seconds of each, what
-- they would take if each drop made its own equations and modes, and rank correlations.
-- Seconds are those of the clock: measure on an idle machine.
local bw = require "barwright"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "random drops in time beside the drop test and the worst case",
  options = {script.option.out,
    {name = "elements", value = "N", type = "integer", default = 40000, min = 1, what = "number of tet10"},
    {name = "drops", value = "N", type = "integer", default = 300, min = 1, what = "drops in time"},
    {name = "quasi-static", value = "N", type = "integer", default = 10000, min = 1,
      what = "drops of the drop test"}},
}

local results = opts.out and assert(script.results(opts.out, opts, {script = "scripts/bench/drop.lua"}))

local body, min, max = bw.shapes.opener()
local surface = assert(bw.surface.implicit(body, {min = min, max = max, cells = 60}))
local mesh = assert(bw.mesh.fill(surface, {elements = opts.elements, order = 2}))
local part = bw.model {mesh = mesh, material = bw.material.pla}
print(("%d tet10, %d nodes"):format(mesh.element_count, mesh.node_count))
local processor = os.clock()
local drops = assert(bw.random_drops(part, {drops = opts.drops}))
processor = os.clock() - processor
local scratch = drops.first_seconds * opts.drops
print(drops)
print(("drops: %.3g s, %.3g s of processor time, %.1f solutions each"):format(drops.seconds, processor,
  drops.solves / opts.drops))
print(("first drop: %.3g s; equations and modes made for each drop: %.3g s, %.1f times as much"):format(
  drops.first_seconds, scratch, scratch / drops.seconds))
local test = assert(bw.drop_test(part, {drops = opts.quasi_static}))
print(test)
local fresh = bw.model {mesh = mesh, material = bw.material.pla}
local single = assert(bw.drop_test(fresh, {drops = 1}))
local test_scratch = single.seconds * opts.quasi_static
print(("drop test: %.3g s; one drop with its own equations: %.3g s; so all of them: %.3g s, %.3g times as much")
  :format(test.seconds, single.seconds, test_scratch, test_scratch / test.seconds))
local both, both_scratch = drops.seconds + test.seconds, scratch + test_scratch
print(("%d quasi-static and %d transient drops: %.3g s (%.3g min); from scratch %.3g s, %.1f times"):format(
  opts.quasi_static, opts.drops, both, both / 60, both_scratch, both_scratch / both))
local begin = bw.seconds()
local worst = assert(bw.worst_case(part, {force = 100}))
print(("worst case: %.3g s"):format(bw.seconds() - begin))
local row = {elements = mesh.element_count, drops = opts.drops, drops_s = drops.seconds,
  drops_processor_s = processor, first_s = drops.first_seconds,
  each_from_scratch_s = scratch, times_less = scratch / drops.seconds, quasi_static = opts.quasi_static,
  drop_test_s = test.seconds, drop_test_each_from_scratch_s = test_scratch, both_s = both,
  both_times_less = both_scratch / both, energy_error = drops.energy_error,
  with_drop_test = drops:correlation(test),
  with_worst_case = drops:correlation(worst), drop_test_with_worst_case = test:correlation(worst)}
print(("rank correlations: drops and drop test %.3f, drops and worst case %.3f, the last two %.3f"):format(
  row.with_drop_test, row.with_worst_case, row.drop_test_with_worst_case))
if results then assert(results:write {benchmark = "drop", rows = bw.json.list {row}}) end
