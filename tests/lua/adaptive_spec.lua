-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Refined models, recovered stresses, dual problems, and solutions with an error that was asked for.
local bw = require "barwright"
local core = require "barwright.core"

local pi, cos, sin = math.pi, math.cos, math.sin
local elastic = bw.material.isotropic {young = 1, poisson = 0.3, density = 1}

local function box(size, cells)
  return assert(bw.mesh.box {min = {0, 0, 0}, max = size, cells = cells, order = 2})
end

local function cantilever()
  local mesh = box({2, 1, 1}, {2, 1, 1})
  local part = bw.model {mesh = mesh, material = elastic}
  part:fix(mesh.boundary:below(1, 0))
  part:load {on = mesh.boundary:above(1, 2), force = {0, 0, -1e-3}}
  return part
end

-- The quarter of a plate with a hole of radius 1 under tension, in plane strain; edges are curved.
local function plate_with_hole(size)
  local grid = box({1, 1, 1}, {4, 4, 1})
  local moved = {}
  for i, p in ipairs(grid.nodes:totable()) do
    local a = pi / 2 * p[2]
    local reach, fraction = size / math.max(cos(a), sin(a)), (size ^ p[1] - 1) / (size - 1)
    local r = (1 - fraction) + fraction * reach
    moved[i] = {r * cos(a), r * sin(a), p[3]}
  end
  local mesh = assert(grid:moved(moved))
  local part = bw.model {mesh = mesh, material = elastic}
  part:slide(mesh.boundary:below(2, 1e-9), {0, 1, 0}):slide(mesh.boundary:below(1, 1e-9), {1, 0, 0})
  part:slide(mesh.boundary:below(3, 1e-9), {0, 0, 1}):slide(mesh.boundary:above(3, 1 - 1e-9), {0, 0, 1})
  part:load {on = mesh.boundary:above(1, size - 1e-9), traction = {1, 0, 0}}
  return part
end

local function levels(mesh, level_of)
  local list = {}
  for e = 1, mesh.element_count do list[e] = level_of(e) end
  return bw.array.new(list)
end

describe("a refined model", function()
  it("keeps nothing of selections where one is of another mesh", function()
    local part, other = cantilever(), cantilever()
    local own, foreign = part.mesh.boundary:below(1, 0), other.mesh.boundary:below(1, 0)
    local ok, text = pcall(part.refined, part, levels(part.mesh, function() return 1 end),
      {also = {own, own, foreign}})
    assert.is_false(ok)
    assert.matches("selection 3 is not of the model's mesh", text)
  end)

  it("has the supports and loads of the model", function()
    local part = cantilever()
    local fine = assert(part:refined(levels(part.mesh, function(e) return e % 4 end)))
    assert.is_true(fine.mesh.element_count > 2 * part.mesh.element_count)
    assert.near(2, fine.mesh.volume, 1e-12)
    assert.near(1, fine.supports[1].on.area, 1e-12)
    assert.near(1, fine.loads[1].area, 1e-12)
    assert.near(-1e-3, fine.loads[1].resultant[3], 1e-15)
    -- the nodes fixed are all those of the face and no others
    assert.equal(fine.mesh.boundary:below(1, 1e-12).node_count, fine.supports[1].on.node_count)
  end)

  it("keeps a line of nodes a line", function()
    local mesh = box({1, 1, 1}, {2, 2, 2})
    local part = bw.model {mesh = mesh, material = elastic}
    local line = {}
    for i, p in ipairs(mesh.nodes:totable()) do line[i] = p[1] == 0 and p[3] == 0.5 and 1 or 0 end
    part:prescribe(mesh.boundary:where(bw.array.new(line)), {false, false, 0})
    local fine = assert(part:refined(levels(mesh, function() return 3 end)))
    local on, expected = fine.supports[1].on, 0
    for _, p in ipairs(fine.mesh.nodes:totable()) do
      if p[1] == 0 and p[3] == 0.5 then expected = expected + 1 end
    end
    assert.equal(expected, on.node_count)
    assert.is_true(expected > 5)
  end)

  it("interpolates prescribed displacements and temperatures", function()
    local mesh = box({1, 1, 1}, {1, 1, 1})
    local part = bw.model {mesh = mesh, material = elastic}
    local field, change = {}, {}
    for i, p in ipairs(mesh.nodes:totable()) do
      field[i] = {1e-3 * p[1], 2e-3 * p[2], -1e-3 * p[3]}
      change[i] = p[1] - 2 * p[2]
    end
    part:prescribe(mesh.boundary, bw.array.new(field))
    local fine = assert(part:refined(levels(mesh, function() return 3 end)))
    local static = assert(fine:solve())
    for i, p in ipairs(fine.mesh.nodes:totable()) do -- a patch test
      assert.near(2e-3 * p[2], static.displacement(i, 2), 1e-15)
    end
    part:clear_supports()
    part:temperature(bw.array.new(change), 1e-5)
    fine = assert(part:refined(levels(mesh, function() return 3 end)))
    static = assert(fine:solve {inertia_relief = true})
    assert.is_true(static.displacement:map "norm(a)":max() > 1e-6)
    assert.is_true(static.von_mises:max() < 1e-15) -- a linear temperature leaves no stress
  end)

  it("bounds angles however often it is done", function()
    local part = cantilever()
    local before = part.mesh:quality().dihedral_min
    for _ = 1, 4 do
      local near = part.mesh:locate {0, 0, 0}
      part = assert(part:refined(levels(part.mesh, function(e) return e == near and 3 or 0 end)))
    end
    assert.is_true(part.mesh:quality().dihedral_min > before / 3)
  end)

  it("comes to the round faces of a surface", function()
    local surface = bw.surface.cylinder {axis = {0, 0, 1}, radius = 0.5, segments = 24}
    local mesh = assert(bw.mesh.fill(surface, {elements = 300, order = 2}))
    local part = bw.model {mesh = mesh, material = elastic}
    for _ = 1, 2 do
      part = assert(part:refined(levels(part.mesh, function() return 3 end), {surface = surface}))
    end
    local furthest = 0
    for _, node in ipairs(part.mesh.boundary:where("z > 1e-9"):where("z < 1 - 1e-9").nodes:totable()) do
      local r = math.sqrt(part.mesh.nodes(node, 1) ^ 2 + part.mesh.nodes(node, 2) ^ 2)
      furthest = math.max(furthest, math.abs(r - 0.5))
    end
    assert.is_true(furthest < 1e-9, furthest)
  end)

  it("carries further selections, and refuses those of other meshes", function()
    local part = cantilever()
    local top = part.mesh.boundary:above(3, 1)
    local fine, also = assert(part:refined(levels(part.mesh, function() return 1 end), {also = {top}}))
    assert.near(2, also[1].area, 1e-12)
    assert.equal(fine.mesh.node_count, also[1].mesh.node_count)
    local done, message = pcall(part.refined, part, levels(part.mesh, function() return 1 end), {also = also})
    assert.is_false(done)
    assert.matches("not of the model's mesh", message)
  end)

  it("keeps curved edges the curves that they are", function()
    local part = plate_with_hole(10)
    local function hole(mesh) return mesh.boundary:where("x^2 + y^2 < 1.001^2").area end
    local fine = assert(part:refined(levels(part.mesh, function(e) return e % 3 end)))
    assert.is_true(fine.mesh.facet_count > 1.5 * part.mesh.facet_count)
    assert.near(hole(part.mesh), hole(fine.mesh), 1e-8)
    assert.near(pi / 2, hole(fine.mesh), 1e-3)
  end)

  it("stops at the most elements", function()
    local part = cantilever()
    local none, message, details = part:refined(levels(part.mesh, function() return 3 end), {max_elements = 20})
    assert.is_nil(none)
    assert.matches("more than 20 elements", message)
    assert.equal("limit", details.status)
    assert.has_error(function() part:refined(bw.array.new {1, 2}) end)
  end)
end)

describe("recovered stresses", function()
  it("are exact where the stress is linear", function()
    local mesh = assert(cantilever():refined(levels(box({2, 1, 1}, {2, 1, 1}), function(e) return e % 3 end))).mesh
    local rows = {}
    for i, p in ipairs(mesh.nodes:totable()) do rows[i] = {p[1] ^ 2 - p[2] * p[3], p[1] * p[2], 3 * p[3] ^ 2} end
    local u = bw.array.new(rows)
    local recovered, exact = core.recovered_stress(mesh, elastic, u), bw.nodal_stress(mesh, elastic, u)
    assert.is_true((recovered - exact):map "norm(a)":max() < 1e-9)
    assert.is_true(core.error_product(mesh, elastic, u, u):sum() < 1e-18)
  end)
end)

describe("a dual problem", function()
  local function check_work(part)
    local static = assert(part:solve())
    local node = static.von_mises:argmax()
    local force = core.stress_functional(part.mesh, part.material, bw.array.new {node}, {{1, 2, 3, 4, 5, 6}})
    local dual = assert(part:system():solve(force))
    local value = 0
    for k = 1, 6 do value = value + k * static.stress(node, k) end
    local load, work = part:force_vector(), 0
    for i = 1, #load do
      for k = 1, 3 do work = work + load(i, k) * dual(i, k) end
    end
    assert.near(1, work / value, 1e-8)
  end

  it("gives the quantity as its work with the loads", function()
    check_work(cantilever())
    local mesh = box({2, 1, 1}, {2, 1, 1})
    local part = bw.model {mesh = mesh, formulation = "b_bar",
      material = bw.material.isotropic {young = 1, poisson = 0.4999}}
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 2), force = {0, 0, -1e-3}}
    check_work(part)
  end)

  it("knows the forces of a displacement", function()
    local part = cantilever()
    local static = assert(part:solve())
    local force = core.internal_force(part.mesh, elastic, static.displacement)
    assert.is_true((force - static.force - static.reaction):map "norm(a)":max() < 1e-12)
  end)
end)

describe("solve with an error", function()
  it("interpolates at a point as the elements do", function()
    local part = cantilever()
    local static = assert(part:solve())
    for _, at in ipairs {{0.31, 0.42, 0.73}, {1.3, 0.2, 0.55}, {0.05, 0, 0}} do
      for field, column in pairs {xx = 1, xy = 6} do
        local _, accuracy = assert(part:solve {error = 1e-9, of = {at = at, field = field}, max_elements = 1})
        local value = part.mesh:sample(static.stress, {at})(1, column)
        assert.near(value, accuracy.value, 1e-9 * math.abs(value))
      end
      local _, accuracy = assert(part:solve {error = 1e-9, of = {at = at, field = "uz"}, max_elements = 1})
      local value = part.mesh:sample(static.displacement, {at})(1, 3)
      assert.near(value, accuracy.value, 1e-9 * math.abs(value))
    end
  end)

  it("reaches the stress at a hole", function()
    local static, accuracy = assert(plate_with_hole(60):solve {error = 0.01, of = {at = {0, 1, 0}, field = "xx"}})
    assert.truthy(tostring(static):find "; estimated error [%d.]+ %% of the xx at a point$", tostring(static))
    assert.is_true(accuracy.converged)
    assert.equal("tolerance", accuracy.reason)
    assert.near(3, accuracy.value, 0.04) -- the plate is not infinite
    assert.is_true(accuracy.estimated_error <= 0.01)
    assert.is_true(accuracy.elements < 12000)
    assert.equal(accuracy.elements, static.mesh.element_count)
    assert.equal(accuracy.part.mesh.node_count, static.mesh.node_count)
    assert.is_true(#accuracy.history >= 3)
    assert.matches("xx at a point: .*converged", tostring(accuracy))
  end)

  it("gives the same bits on any number of threads", function()
    local threads, values = bw.threads(), {}
    for n = 1, 3 do
      bw.threads(n)
      local _, accuracy = assert(cantilever():solve {error = 0.1, of = "displacement"})
      values[n] = ("%a %a %d"):format(accuracy.value, accuracy.estimated_error, accuracy.elements)
    end
    bw.threads(threads)
    assert.equal(values[1], values[2])
    assert.equal(values[1], values[3])
  end)

  it("finds the largest value by itself", function()
    local _, accuracy = assert(plate_with_hole(60):solve {error = 0.02, of = "max_principal"})
    assert.is_true(accuracy.converged)
    assert.is_nil(accuracy.singular)
    assert.near(3, accuracy.value, 0.08)
    assert.near(1, math.sqrt(accuracy.at[1] ^ 2 + accuracy.at[2] ^ 2), 1e-3)
  end)

  it("knows displacements, reactions and functions", function()
    local part = cantilever()
    local left = part.mesh.boundary:below(1, 0)
    part:prescribe(part.mesh.boundary:above(1, 2), {1e-3, 0, 0}):clear_loads()
    local _, accuracy = assert(part:solve {error = 0.02, of = left})
    assert.is_true(accuracy.converged)
    local _, energy = assert(part:solve {error = 0.01, of = function(static) return static.energy end})
    -- the reaction's work is twice the energy
    assert.near(2 * energy.value / 1e-3, accuracy.value, 0.03 * accuracy.value)
    local _, along = assert(part:solve {error = 0.02, of = {reaction = left, axis = "x"}})
    assert.near(-accuracy.value, along.value, 1e-6 * accuracy.value)
    local _, tip = assert(cantilever():solve {error = 0.01, of = "displacement"})
    assert.is_true(tip.converged)
    local _, corner = assert(cantilever():solve {error = 0.01, of = {at = {2, 0, 0}, field = "uz"}})
    assert.near(-tip.value, corner.value, 0.05 * tip.value)
  end)

  it("says why it ends without the error asked for", function()
    local _, accuracy = assert(cantilever():solve {error = 1e-6, of = "displacement", max_elements = 500})
    assert.is_false(accuracy.converged)
    assert.equal("elements", accuracy.reason)
    assert.is_true(accuracy.elements <= 500)
    -- a stress at a sharp re-entrant border has no limit
    _, accuracy = assert(cantilever():solve {error = 1e-3, max_elements = 20000})
    assert.is_false(accuracy.converged)
    assert.equal("geometry and growth", accuracy.singular.by)
    assert.equal("border of a support", accuracy.singular.place.kind)
    assert.near(1 - 0.7112, accuracy.singular.expected, 1e-4)
    assert.is_true(accuracy.singular.measured > 0.15 and accuracy.singular.measured < 0.6)
    assert.truthy(tostring(accuracy):find("it is at a border of a support of 90 degrees", 1, true))
  end)

  it("ends within a limit of time or memory, with what it has", function()
    local static, accuracy = assert(cantilever():solve {error = 1e-6, of = "displacement", time_limit = 1e-6})
    assert.is_false(accuracy.converged)
    assert.equal("time", accuracy.reason)
    assert.equal(1, #accuracy.history) -- the first mesh is always solved
    assert.equal(accuracy.elements, static.mesh.element_count)
    assert.truthy(tostring(accuracy):find("a finer mesh would take too long", 1, true))
    static, accuracy = assert(cantilever():solve {error = 1e-6, of = "displacement", max_elements = 500,
      time_limit = 1e6})
    assert.equal("elements", accuracy.reason)
    assert.is_true(static.mesh.element_count > accuracy.history[1].elements)
    local refinement = require "barwright.refinement"
    local function step(history, part)
      if #history == 2 then return nil, "out of memory", {status = "memory"} end
      return {result = part, value = 1, error = 0.2,
        parts = levels(part.mesh, function() return 1 end):totable()}
    end
    local part
    part, accuracy = refinement.run(cantilever(), {error = 0.01, max_elements = 10000},
      {name = "", selections = {}, step = step})
    assert.equal("memory", accuracy.reason)
    assert.equal(2, #accuracy.history)
    assert.equal(accuracy.elements, part.mesh.element_count)
  end)

  it("sees facets that stand for a round face", function()
    local curved = plate_with_hole(10).mesh
    local straight = curved:with_order(1):with_order(2)
    local function kink(mesh)
      local node = mesh.boundary:nearest({cos(pi / 4), sin(pi / 4), 0}, 1).nodes[1]
      return math.deg(core.boundary_kink(mesh, node, 0.6))
    end
    assert.near(22.5, kink(straight), 0.01)
    assert.is_true(kink(curved) < 1)
    local facet_error = require "barwright.facet_error"
    local edge = {cos(pi / 4), sin(pi / 4), 0}
    assert.near(0.25, facet_error(straight, edge, 0.1), 1e-3)
    assert.equal(0, facet_error(straight, {4, 4, 0.5}, 0.01)) -- a place inside of the body
    -- an error by facets that refinement does not lessen ends the loop
    local refinement = require "barwright.refinement"
    local function step(_, part)
      return {result = part, value = 1, error = 0.2, facet_error = 0.1,
        parts = levels(part.mesh, function() return 1 end):totable()}
    end
    local _, accuracy = refinement.run(cantilever(), {error = 0.01, max_elements = 1000},
      {name = "", selections = {}, step = step})
    assert.equal("facets", accuracy.reason)
    assert.equal(2, #accuracy.history)
  end)

  it("follows the round faces of a surface", function()
    local surface = bw.surface.cylinder {axis = {0, 0, 1}, radius = 0.5, segments = 24}
    local mesh = assert(bw.mesh.fill(surface, {elements = 300, order = 2}))
    local function tension(options)
      local part = bw.model {mesh = mesh, material = elastic}
      part:slide(mesh.boundary:below(3, 1e-9), {0, 0, 1})
      part:load {on = mesh.boundary:above(3, 1 - 1e-9), traction = {0, 0, 1}}
      options.inertia_relief = true
      return assert(part:solve(options))
    end
    local _, round = tension {error = 0.005, surface = surface}
    assert.is_true(round.converged)
    assert.near(1, round.value, 0.005)
  end)

  it("is the same by two-level PCG as by a factor, of a free body too", function()
    local mesh = box({2, 1, 1}, {2, 1, 1})
    for _, free in ipairs {false, true} do
      local part = bw.model {mesh = mesh, material = elastic}
      if not free then part:fix(mesh.boundary:below(1, 0)) end
      part:load {on = mesh.boundary:above(1, 2), force = {0, 0, -1e-3}}
      local found = {}
      for i, solver in ipairs {bw.solver.cholesky(), bw.solver.pcg()} do
        local _, accuracy = assert(part:solve {error = 0.05, of = "displacement", inertia_relief = free,
          solver = solver})
        found[i] = accuracy
      end
      assert.equal(#found[1].history, #found[2].history)
      assert.near(1, found[2].value / found[1].value, 1e-8)
      assert.near(1, found[2].estimated_error / found[1].estimated_error, 1e-5)
    end
  end)

  it("raises quadratic elements from linear ones", function()
    local mesh = box({2, 1, 1}, {2, 1, 1}):with_order(1)
    local part = bw.model {mesh = mesh, material = elastic}
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 2), force = {0, 0, -1e-3}}
    local static = assert(part:solve {error = 0.05, of = "displacement"})
    assert.equal(2, static.mesh.order)
  end)

  it("names what it does not know", function()
    local part = cantilever()
    local function message(options)
      local ok, text = pcall(part.solve, part, options)
      assert.is_false(ok)
      return text
    end
    assert.matches("von_mises", message {error = 0.01, of = "von_misses"})
    assert.matches("'error'.*is missing", message {of = "displacement"})
    assert.matches("a number above 0 expected", message {error = 0})
    assert.matches("unknown option 'off'", message {error = 0.01, off = 1})
    assert.matches("field", message {error = 0.01, of = {at = {0, 0, 0}, field = "xz"}})
    assert.matches("finite number", message {error = 0.01, of = function() end})
    assert.matches("does not lie in the body", message {error = 0.01, of = {9, 9, 9}})
  end)
end)

describe("modes with an error", function()
  local function bar(cells)
    local mesh = box({5, 1, 0.7}, cells)
    local part = bw.model {mesh = mesh, material = elastic}
    part:fix(mesh.boundary:below(1, 0))
    return part
  end

  it("tell by how many cents they are too high", function()
    local modes = assert(bar {10, 2, 2}:modes {count = 5})
    local cents, fine = modes:error_estimate(), assert(bar {20, 4, 3}:modes {count = 5}).frequencies
    assert.truthy(tostring(modes):find((" left out, none missing; about %.0f cents too high at most"):format(
      cents:max()), 1, true), tostring(modes))
    assert.truthy(tostring(cantilever():solve()):find "; error unknown: one mesh$")
    for k = 1, 5 do
      local excess = 1200 * math.log(modes.frequencies[k] / fine[k], 2)
      assert.is_true(excess > 0)
      local effectivity = cents[k] / excess
      assert.is_true(effectivity > 0.5 and effectivity < 3, ("mode %d: %g"):format(k, effectivity))
    end
  end)

  it("are refined until they are exact enough", function()
    local modes, accuracy = assert(bar {5, 1, 1}:modes {count = 2, error = 0.005})
    assert.is_true(accuracy.converged)
    assert.equal(2, modes.count)
    assert.near(0.004494, modes.frequencies[1], 0.005 * 0.004494) -- of 11,520 elements
    assert.matches("frequencies of 2 modes", tostring(accuracy))
  end)

  it("are refused without a density, and for the Laplacian", function()
    local mesh = box({2, 1, 1}, {2, 1, 1})
    local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 1, poisson = 0.3}}
    local none, message = part:modes {error = 0.01}
    assert.is_nil(none)
    assert.matches("density", message)
    local laplacian = assert(part:modes {count = 2, laplacian = true})
    local done, text = pcall(laplacian.error_estimate, laplacian)
    assert.is_false(done)
    assert.matches("Laplacian modes have no stress", text)
  end)
end)
