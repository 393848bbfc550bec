-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Contacts of the drop test on coarse meshes of parts (scripts/worst_case/machine_parts.lua): how many
-- nodes carry an impact, the fraction of impacts on two nodes or fewer, the part of the resultant of the nodal
-- forces across the peg's normal, and the contact's area on this mesh over that on one of four times the elements.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. folder .. "/../worst_case/?.lua;" .. package.path
local options = require "options"
local parts = require "machine_parts"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "contacts of the drop test on coarse meshes of machine parts",
  options = {script.option.out, options.only, options.elements(5000),
    {name = "drops", value = "N", type = "integer", default = 500, min = 1, what = "number of random drops"}},
}

local results = opts.out and assert(script.results(opts.out, opts, {script = "scripts/bench/drops.lua"}))

local function drop(surface, elements)
  local mesh = assert(bw.mesh.fill(surface, {elements = elements, tolerance = 0.1}))
  local model = bw.model {mesh = mesh, material = bw.material.pla}
  return assert(bw.drop_test(model, {drops = opts.drops, seed = 1}))
end

local function measure(part)
  local surface = parts.surface(part)
  local coarse, fine = drop(surface, opts.elements), drop(surface, 4 * opts.elements)
  local along = bw.array.map("r.x * e.x + r.y * e.y + r.z * e.z", {r = coarse.resultants, e = coarse.directions})
  local across = bw.array.map("sqrt((r.x - a * e.x)^2 + (r.y - a * e.y)^2 + (r.z - a * e.z)^2) / norm(r)",
    {r = coarse.resultants, e = coarse.directions, a = along})
  return {part = part.name, elements = coarse.mesh.element_count,
    facet_m2 = coarse.mesh.boundary.area / coarse.mesh.facet_count,
    nodes_min = coarse.nodes:min(), nodes_median = coarse.nodes:quantile(0.5),
    on_two_nodes = coarse.nodes:map("a <= 2"):sum() / opts.drops, sideways_max = across:max(),
    area_m2 = coarse.areas:quantile(0.5), finer_elements = fine.mesh.element_count,
    finer_area_m2 = fine.areas:quantile(0.5), force_n = coarse.forces:quantile(0.5),
    finer_force_n = fine.forces:quantile(0.5)}
end

local rows = {}
for _, part in ipairs(parts.list) do
  if not opts.only or opts.only == part.name then
    local row = measure(part)
    rows[#rows + 1] = row
    print(("%-15s %5d elements: %.1f %% on two nodes or fewer, nodes %d least, %g median; sideways %.1e at most; "
      .. "area %.3f of a facet, %.2f of that with %d elements; force %.2f"):format(row.part, row.elements,
      100 * row.on_two_nodes, row.nodes_min, row.nodes_median, row.sideways_max, row.area_m2 / row.facet_m2,
      row.area_m2 / row.finer_area_m2, row.finer_elements, row.force_n / row.finer_force_n))
    io.stdout:flush()
    collectgarbage()
  end
end
if results then assert(results:write {benchmark = "drops", rows = bw.json.list(rows)}) end
