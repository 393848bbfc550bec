-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Worst loads and breaking forces of machine parts: against brute force, with a certificate, from two meshes.
local bw = require "barwright"
local project = require "project"
project.use "worst_case"
local machine, unseen = require "machine_parts", require "unseen_parts"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Machine parts", text = [[Parts by formula (`scripts/worst_case/machine_parts.lua`,
`unseen_parts.lua`) of PLA that nothing holds. Theory: [worst case](theory/worst_case.md),
[breaking force](theory/breaking_force.md), [singular places](theory/singular.md).]]}

local function part_named(name)
  for _, list in ipairs {machine, unseen} do
    for _, part in ipairs(list.list) do
      if part.name == name then return list.surface(part) end
    end
  end
  error("no part " .. name)
end

-- The search on a mesh, brute force on the same mesh, and the proof that neither missed more than 5 %.
for _, name in ipairs {"clevis", "shelf bracket", "snap clip"} do
  scenario(name .. ": search, brute force, certificate", function(t)
    local mesh = t:require(bw.mesh.fill(part_named(name), {elements = 1500, tolerance = 0.1}))
    local part, path = bw.model {mesh = mesh, material = bw.material.pla}, t.folder .. "/bound.txt"
    local load = {force = 0.05 * 2e5 * mesh.boundary.area, pressure = 2e5}
    local brute = t:require(bw.brute_force(part, load))
    load.certify, load.certificate = 0.05, path
    local worst = t:require(bw.worst_case(part, load))
    local proof = t:require(bw.check_certificate(path))
    local how = ("%d elements, %.3g N"):format(mesh.element_count, load.force)
    expect(brute:compare(worst).ratio, "99.75th percentile by the search over that by brute force"):above(0.9,
      {how = how})
    expect(worst.max_principal / brute.max_principal, "largest stress by the search over that by brute force")
      :above(0.97, {how = how})
    expect(brute.max_principal / proof.upper_bound, "largest stress by brute force over the checked bound")
      :below(1)
    expect(proof.gap, "certified gap"):below(0.0501, {how = ("%d leaves checked"):format(proof.leaves)})
    expect(proof.solve_error / proof.upper_bound, "what the linear solves may add to the bound"):below(1e-5)
  end)
end

-- The judged stress (mean over a patch) under the worst load of each element.
local function min_force(t, found)
  local worst, mesh, max = found.worst, found.mesh, 0
  local limits = {force = worst.options.force, pressure = worst.options.pressure}
  local regions = t:require(bw.single_regions(mesh))
  local loads = t:require(bw.worst_loads(worst.system, worst.basis, regions, limits))
  for i = 1, regions.count do
    local force = worst.basis:force(loads.pressures[i])
    local u = t:require(worst.system:solve(force))
    local stress = t:require(bw.surface_stress(mesh, found.material, u, force))
    local mean = t:require(bw.surface_mean(mesh, stress, found.length, worst.system))
    max = math.max(max, t:require(bw.max_principal(mean)):max())
  end
  return found.material.strength / max * found.reference, regions.count
end

scenario("pipe clamp: breaking force on a mesh against loads from every element", function(t)
  local mesh = t:require(bw.mesh.fill(part_named "pipe clamp", {elements = 500, order = 2, tolerance = 0.1}))
  local found = t:require(bw.breaking_force(mesh, {material = bw.material.pla, contact = 5e-5}))
  local min, count = min_force(t, found)
  expect(found.force / min, "breaking force over the least of all these loads"):below(1.03,
    {how = ("%d quadratic elements as targets; %.4g N"):format(count, found.force)})
end)

-- An angle of two legs without a fillet: cells of 4 mm make its edges sharp.
local function angle()
  local block = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.04, 0.024, 0.04}, cells = {10, 6, 10}})
  local centroid = block.nodes:gather(block.elements:column(1))
  for corner = 2, 4 do centroid = centroid + block.nodes:gather(block.elements:column(corner)) end
  return assert(assert(block:subset((centroid / 4):map "a.x < 0.008 or a.z < 0.008")):surface())
end

scenario("sharp angle: re-entrant edge, interval", function(t)
  local surface = angle()
  local edges = t:require(surface:singular_edges())
  expect(#edges, "re-entrant edges"):equals(1)
  expect(edges[1].length, "its length", "m"):near(0.024, {relative = 1e-6})
  expect(edges[1].exponent, "its exponent"):near(0.5445, {relative = 1e-3, source = "Williams 1952, 270 degrees"})
  local function breaking(elements)
    return t:require(bw.breaking_force(surface, {material = bw.material.pla, elements = elements, length = 3e-3,
      max_elements = elements, modes = 6, regions = 2}))
  end
  local coarse, fine = breaking(800), breaking(4000)
  local place = edges:near(fine.at, fine.length)
  expect(place and place.place.kind, "place of the breaking stress"):equals "re-entrant edge"
  expect(fine.force, "force on more elements, in the coarse interval", "N"):between(coarse.low, coarse.high,
    {how = ("%.4g N on %d elements, %.4g N on %d"):format(coarse.force, coarse.mesh.element_count, fine.force,
      fine.mesh.element_count)})
end)
