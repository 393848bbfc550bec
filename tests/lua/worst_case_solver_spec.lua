-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The option `solver` of the analyses with many right-hand sides: the answers of the factor, within the error that
-- is stated, and reports that say what solved.
local bw = require "barwright"
local check = require "check"

local function wood()
  return bw.material.orthotropic {name = "wood", young = {10e9, 0.8e9, 0.5e9}, poisson = {0.3, 0.02, 0.35},
    shear = {0.05e9, 0.7e9, 0.6e9}, density = 700, strength = {40e6, 5e6, 4e6}}
end

local function block(material, cells)
  local mesh = assert(bw.mesh.box {max = {0.05, 0.041, 0.031}, cells = cells or {9, 7, 5}, order = 2})
  return bw.model {mesh = mesh, material = material}
end

-- Free; fixed at an end; on a slide along an oblique normal as well.
local bodies = {
  free = block, held = function(material)
    local part = block(material)
    return part:fix(part.mesh.boundary:below("x", 1e-6))
  end,
  oblique = function(material)
    local part = block(material)
    return part:fix(part.mesh.boundary:below("x", 1e-6)):slide(part.mesh.boundary:above("y", 0.0409),
      {0.1, 1, 0.2})
  end,
}

local function answer(part, solver, method)
  return assert(bw.worst_case(part, {force = 20, pressure = 2e6, modes = 4, regions = 2, targets = 6,
    method = method, solver = solver}))
end

describe("worst cases without a factor", function()
  it("say what to take where LOBPCG does not converge", function()
    local worst, message = bw.worst_case(block(bw.material.pla, {5, 4, 3}), {modes = 4,
      solver = bw.solver.pcg {preconditioner = bw.solver.jacobi()}})
    assert.is_nil(worst)
    local advice = "or take another preconditioner, or equations that have a factor (the solver cholesky)"
    assert.truthy(message:find(advice, 1, true))
  end)

  it("have modes as exact as regions need", function()
    local options = {modes = 4, regions = 2, method = "paper", solver = bw.solver.pcg()}
    local worst = assert(bw.worst_case(block(bw.material.pla), options))
    options.tolerance = 1e-9
    local exact = assert(bw.worst_case(block(bw.material.pla), options))
    assert.is_true(exact.modes.report.iterations > worst.modes.report.iterations)
    check.near(exact.max_principal, worst.max_principal, 1e-9)
    for i = 1, 4 do check.near(exact.modes.eigenvalues[i], worst.modes.eigenvalues[i], 1e-10) end
  end)

  for name, materials in pairs {free = {bw.material.pla, wood()}, held = {bw.material.pla}, oblique = {wood()}} do
    local make = bodies[name]
    for _, material in ipairs(materials) do
      it(("give the factor's answers: %s, %s"):format(name, material.name), function()
        local own = answer(make(material), nil, "search")
        local found = answer(make(material), bw.solver.pcg(), "search")
        check.near(own.max_principal, found.max_principal, 1e-6)
        check.near(own.utilisation, found.utilisation, 1e-6)
        for i = 1, own.modes.count do check.near(own.modes.eigenvalues[i], found.modes.eigenvalues[i], 1e-8) end
        assert.equal(0, own.solve_error)
        assert.is_true(found.solve_error > 0 and found.solve_error < 1e-5)
        assert.is_true(math.abs(found.max_principal / own.max_principal - 1) <= found.solve_error)
        local sentence = "the solver is estimated to change the stress by [%d.e-]+ %%; error unknown: one mesh$"
        assert.truthy(tostring(found):find(sentence))
        assert.is_nil(tostring(own):find "the solver is estimated")
        assert.equal("cholesky", own.reports.solver.solver)
        assert.equal("a factor serves many right-hand sides", own.reports.solver.reason)
        local report = found.reports.solver
        assert.equal("pcg", report.solver)
        assert.equal("two_level", report.preconditioner)
        assert.equal("lobpcg", found.modes.report.solver)
        assert.equal("two_level", found.modes.report.preconditioner)
        assert.is_true(report.iterations > 0 and report.residual < 1e-5)
        assert.is_true(report.bytes > 0 and report.seconds > 0)
        assert.truthy(tostring(found.system):find "solved by pcg with two_level$")
      end)
    end
  end

  it("keep what the tolerance says", function()
    local own = answer(bodies.free(bw.material.pla), nil, "paper").max_principal
    for _, tolerance in ipairs {1e-4, 1e-6} do
      local found = answer(bodies.free(bw.material.pla), bw.solver.pcg {tolerance = tolerance}, "paper")
      assert.is_true(math.abs(found.max_principal / own - 1) <= found.solve_error)
      assert.is_true(found.solve_error < 1e3 * tolerance)
      assert.equal(1e-6, found.options.tolerance) -- of the modes, by default
    end
  end)

  it("are by other preconditioners too", function()
    local own = answer(bodies.held(bw.material.pla), nil, "paper").max_principal
    for _, preconditioner in ipairs {bw.solver.amg(), bw.solver.cholesky {precision = 32}} do
      local found = answer(bodies.held(bw.material.pla), bw.solver.pcg {preconditioner = preconditioner}, "paper")
      assert.equal(preconditioner.kind, found.reports.solver.preconditioner)
      check.near(own, found.max_principal, 1e-6)
    end
  end)

  it("bound, extend and close", function()
    local found = assert(bw.worst_case(block(bw.material.pla, {5, 4, 3}), {force = 20, pressure = 2e6, modes = 3,
      regions = 2, targets = 4, certify = 0.3, solver = bw.solver.pcg()}))
    local own = assert(bw.worst_case(block(bw.material.pla, {5, 4, 3}), {force = 20, pressure = 2e6, modes = 3,
      regions = 2, targets = 4, certify = 0.3}))
    check.near(own.upper_bound, found.upper_bound, 1e-6)
    local patches = assert(bw.worst_case(block(bw.material.pla), {force = 20, contact = 1e-5, length = 0.006,
      modes = 3, solver = bw.solver.pcg()}))
    check.near(assert(bw.worst_case(block(bw.material.pla), {force = 20, contact = 1e-5, length = 0.006,
      modes = 3})).utilisation, patches.utilisation, 1e-6)
    assert(patches:extend(0.9 * patches.utilisation))
    patches:close()
  end)

  it("refuse an eigensolver on the inverse", function()
    local part = block(bw.material.pla, {3, 2, 2})
    check.raises("eigensolver 'lanczos' needs a factor", bw.worst_case, part,
      {force = 20, pressure = 2e6, solver = bw.solver.pcg(), eigensolver = bw.eigensolver.lanczos {}})
    assert.equal("cholesky", assert(bw.worst_case(part, {force = 20, pressure = 2e6, modes = 2, regions = 1,
      eigensolver = bw.eigensolver.arpack {}})).reports.solver.solver)
    check.raises("a solver of bw.solver or \"auto\" expected", bw.worst_case, part, {solver = "pcg"})
    check.raises("preconditioner and no solver", bw.worst_case, part, {solver = bw.solver.amg()})
    local system = assert(part:system {solver = bw.solver.pcg()})
    check.raises("needs a factor", system.modes, system, {solver = bw.eigensolver.lanczos {}})
  end)
end)

describe("other analyses without a factor", function()
  it("drop a part as with one", function()
    local own = assert(bw.drop_test(block(bw.material.pla), {drops = 40}))
    local found = assert(bw.drop_test(block(bw.material.pla), {drops = 40, solver = bw.solver.pcg()}))
    assert.equal("pcg", found.reports.solver.solver)
    check.near(own.peaks:max(), found.peaks:max(), 1e-6)
    check.near(own.mean_peak:max(), found.mean_peak:max(), 1e-6)
  end)

  it("break a part at the same force", function()
    local surface = bw.surface.box {min = {0, 0, 0}, max = {0.04, 0.01, 0.008}}
    local opts = {material = bw.material.pla, elements = 300, modes = 3, regions = 2}
    local own = assert(bw.breaking_force(surface, opts))
    opts.solver = bw.solver.pcg()
    local found = assert(bw.breaking_force(surface, opts))
    check.near(own.force, found.force, 1e-6)
    assert.equal("pcg", found.reports.solver.solver)
    assert.equal("cholesky", own.reports.solver.solver)
  end)
end)
