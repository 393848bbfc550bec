-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Weak regions against brute force, as the paper's figure 7 and table 1: 99.75th percentiles side by
-- side, and seconds beside the paper's.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. folder .. "/../worst_case/?.lua;" .. package.path
local bodies = require "bodies_by_formula"
local script = require "barwright.command.script"

-- worst-case, table 1 (elements, brute force, seconds)
local paper = {[2723] = 681.367, [2869] = 793.362, [2904] = 894.610, [5332] = 2120.361,
  [11020] = 11029.721, [12853] = 11334.362, [14163] = 27775.900, [16008] = 19917.838}

local opts = script.read {
  summary = "weak regions against brute force, beside figure 7 and table 1 of the paper worst-case",
  options = {script.option.out,
    {name = "bodies", value = "N", type = "integer", default = #bodies.list, min = 1,
      what = "the N smallest bodies alone"},
    {name = "elements", value = "FRACTION", type = "number", default = 1, above = 0,
      what = "this fraction of the paper's numbers of elements"},
  },
}

local results = opts.out and assert(bw.results.open(opts.out, {script = "scripts/bench/brute_force.lua",
  options = {bodies = opts.bodies, elements = opts.elements}}))

print("model    | elements | weak regions | brute force  | ratio | seconds (paper)      | faster")
local rows, ratios = {}, {}
for k, body in ipairs(bodies.list) do
  if k > opts.bodies then break end
  local found = bodies.compare(body, math.floor(opts.elements * body.elements))
  local both, seconds, theirs = found.both, found.brute.seconds, paper[body.elements]
  print(("%-8s | %8d | %8.3f MPa | %8.3f MPa | %5.3f | %7.1f s (%7.0f s) | %5.0f"):format(body.name,
    found.elements, both.worst_case / 1e6, both.brute_force / 1e6, both.ratio, seconds, theirs, theirs / seconds))
  ratios[#ratios + 1] = both.ratio
  rows[#rows + 1] = {model = body.name, elements = found.elements, elements_paper = body.elements,
    weak_regions_pa = both.worst_case, brute_force_pa = both.brute_force, ratio = both.ratio,
    seconds_brute_force = seconds, seconds_weak_regions = found.seconds, seconds_paper = theirs}
end
table.sort(ratios)
local median = ratios[(#ratios + 1) // 2]
print(("median ratio %.3f"):format(median))
if results then
  assert(results:write {benchmark = "brute_force", rows = bw.json.list(rows), median_ratio = median})
end
