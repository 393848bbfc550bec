-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The search of the breaking force against brute force on the last mesh: a linear program for every corner on the
-- boundary in three directions along the surface, then ascents from the largest means. Both evaluate all places
-- under each load.
local bw = require "barwright"
local core = require "barwright.core"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. folder .. "/../worst_case/?.lua;" .. package.path
local bodies = require "bodies"
local options = require "options"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "the search of the breaking force against brute force on the same mesh",
  about = "scripts/bench/bodies.lua lists the bodies.",
  options = {options.models, options.unseen, options.containing, options.elements(1000),
    {name = "one", type = "flag",
      what = "search a single uniform mesh, where most elements are larger than the patches"}},
}

local DIRECTIONS, PER_BLOCK, ASCENTS, STEPS = 3, 60, 60, 4

-- A normal at every corner on the boundary, by its number.
local function normals(mesh)
  local nodes, list = mesh.nodes, {}
  for _, facet in ipairs(mesh.facets:totable()) do
    local p = {}
    for k = 1, 3 do p[k] = {nodes(facet[k], 1), nodes(facet[k], 2), nodes(facet[k], 3)} end
    local u, v = {}, {}
    for c = 1, 3 do u[c], v[c] = p[2][c] - p[1][c], p[3][c] - p[1][c] end
    local n = {u[2] * v[3] - u[3] * v[2], u[3] * v[1] - u[1] * v[3], u[1] * v[2] - u[2] * v[1]}
    for k = 1, 3 do
      local sum = list[facet[k]] or {0, 0, 0}
      for c = 1, 3 do sum[c] = sum[c] + n[c] end
      list[facet[k]] = sum
    end
  end
  return list
end

-- The tensor t t^T of a direction t across a normal, at an angle, as xx yy zz yz zx xy.
local function across(n, angle)
  local size = math.sqrt(n[1] ^ 2 + n[2] ^ 2 + n[3] ^ 2)
  local a = {n[1] / size, n[2] / size, n[3] / size}
  local k = 1
  for c = 2, 3 do k = math.abs(a[c]) < math.abs(a[k]) and c or k end
  local e = {0, 0, 0}
  e[k] = 1
  local u = {a[2] * e[3] - a[3] * e[2], a[3] * e[1] - a[1] * e[3], a[1] * e[2] - a[2] * e[1]}
  size = math.sqrt(u[1] ^ 2 + u[2] ^ 2 + u[3] ^ 2)
  for c = 1, 3 do u[c] = u[c] / size end
  local v = {a[2] * u[3] - a[3] * u[2], a[3] * u[1] - a[1] * u[3], a[1] * u[2] - a[2] * u[1]}
  local t = {}
  for c = 1, 3 do t[c] = math.cos(angle) * u[c] + math.sin(angle) * v[c] end
  return {t[1] ^ 2, t[2] ^ 2, t[3] ^ 2, t[2] * t[3], t[3] * t[1], t[1] * t[2]}
end

-- The places of the largest judged mean under the load of each target: {used, node, stress}.
local function places_of(found, nodes, rows)
  local worst, mesh, list = found.worst, found.mesh, {}
  for from = 1, #nodes, PER_BLOCK do
    local to = math.min(from + PER_BLOCK - 1, #nodes)
    local regions = assert(core.patch_regions(worst.system, found.length, table.move(nodes, from, to, 1, {}),
      core.array.new(table.move(rows, from, to, 1, {}))))
    local loads = assert(core.worst_loads(worst.system, worst.basis, regions, {one_sign = true,
      force = worst.limits.force, pressure = worst.limits.pressure, force_is_max = worst.limits.force_is_max}))
    local forces, stresses = {}, {}
    for k = 1, regions.count do forces[k] = worst.basis:force(loads.pressures[k]) end
    for k, u in ipairs(assert(worst.system:solve(forces))) do
      stresses[k] = assert(bw.surface_stress(mesh, found.material, u, forces[k]))
    end
    local means = assert(core.surface_means(mesh, stresses, found.length, worst.system))
    for k = 1, regions.count do
      local mean = means:columns(6 * k - 5, 6 * k)
      local used = found.material:utilisation(mean)
      local node = used:argmax()
      list[#list + 1] = {used = used[node], node = node, stress = mean:rows(node, node):totable()[1]}
    end
  end
  table.sort(list, function(a, b)
    if a.used ~= b.used then return a.used > b.used end
    return a.node < b.node
  end)
  return list
end

-- The largest utilisation over all loads, and how many linear programs there were.
local function brute_force(found)
  local nodes, rows, count = {}, {}, 0
  local list = {}
  for node, normal in pairs(normals(found.mesh)) do list[#list + 1] = {node, normal} end
  table.sort(list, function(a, b) return a[1] < b[1] end)
  for _, one in ipairs(list) do
    for k = 1, DIRECTIONS do
      nodes[#nodes + 1], rows[#rows + 1] = one[1], across(one[2], math.pi * k / DIRECTIONS)
    end
  end
  local max = 0
  for _ = 0, STEPS do
    local places = places_of(found, nodes, rows)
    count, max = count + #nodes, math.max(max, places[1].used)
    nodes, rows = {}, {}
    for k = 1, math.min(ASCENTS, #places) do nodes[k], rows[k] = places[k].node, places[k].stress end
  end
  return max, count
end

print(("%-22s %-9s %-11s %-12s %-12s %s"):format("body", "elements", "programs", "search, N", "brute, N",
  "brute over search"))
local min, all = 1, {}
for _, body in ipairs(bodies(opts)) do
  local surface = body.surface()
  local given = opts.one and assert(bw.mesh.fill(surface, {elements = opts.elements, order = 2,
    tolerance = 0.1}))
  local found <close> = assert(bw.breaking_force(given or surface, {material = bw.material.pla,
    elements = opts.elements, max_elements = opts.elements}))
  local max, count = brute_force(found)
  local brute = found.reference / max
  print(("%-22s %-9d %-11d %-12.4g %-12.4g %.4f"):format(body.name, found.mesh.element_count, count,
    found.force, brute, brute / found.force))
  io.stdout:flush()
  min = math.min(min, brute / found.force)
  all[#all + 1] = brute / found.force
end
table.sort(all)
print(("least %.4f, median %.4f of %d bodies"):format(min, all[(#all + 1) // 2] or 0, #all))
