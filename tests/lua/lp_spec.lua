-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Solvers of linear programs as an option: every analysis that takes one gives the same answer with each of them.
local bw = require "barwright"
local check = require "check"

local backends = {dual_simplex = "barwright", glpk = "glpk"}

describe("solvers of linear programs", function()
  local mesh = check.beam({10, 2, 2})
  local part = bw.model {mesh = mesh, material = bw.material.pla}
  local limits = {force = 5, pressure = 2e5, modes = 3, regions = 2}

  local function with(opts, solver)
    local out = {lp = solver}
    for key, value in pairs(opts) do out[key] = value end
    return out
  end

  it("say what they are", function()
    for name in pairs(backends) do
      local solver = bw.lp[name] {}
      assert.equal(name, solver.name)
      assert.equal(0, solver.max_iterations)
      assert.equal("linear programs by " .. name, tostring(solver))
      assert.equal(("linear programs by %s, 7 iterations at most"):format(name),
        tostring(bw.lp[name] {max_iterations = 7}))
      assert.equal(name, bw.lp[name]().name)
    end
    check.raises("max_iterations is -2", bw.lp.glpk, {max_iterations = -2})
    check.raises("unknown option 'iterations'", bw.lp.dual_simplex, {iterations = 3})
  end)

  it("give the worst case, with a report", function()
    local free = assert(bw.worst_case(part, limits))
    assert.truthy(free.reports.lp.predicted_cost < free.reports.lp.rival_cost)
    assert.truthy(free.reports.lp.reason:find "predicted")
    check.near(free.max_principal, assert(bw.worst_case(part, with(limits, "auto"))).max_principal, 0)
    for name, backend in pairs(backends) do
      local worst = assert(bw.worst_case(part, with(limits, bw.lp[name] {})))
      local report = worst.reports.lp
      check.near(worst.max_principal, free.max_principal, 1e-6)
      assert.equal(backend, report.backend)
      assert.equal(name .. " was given", report.reason)
      assert.is_nil(report.predicted_cost)
      assert.truthy(report.iterations > 0 and report.seconds > 0 and report.bytes > 0 and report.flops > 0)
      assert.truthy((report.residual or 0) < 1e-9)
      assert.truthy(tostring(report):find("%(" .. backend .. "%): %d+ iterations, "))
    end
  end)

  it("serve bounds, friction, brute force, single objectives and the breaking force", function()
    local basis, system = assert(bw.pressure_basis(mesh)), assert(part:system())
    local objective = basis:gradient(assert(system:solve(assert(
      bw.single_regions(mesh, {5}):objective(1, part.material)))))
    local found = {}
    local function compare(key, value)
      found[key] = found[key] or value
      check.near(value, found[key], 1e-6)
    end
    for name, backend in pairs(backends) do
      local solver = bw.lp[name] {}
      local few = {force = 5, pressure = 2e5, modes = 1, regions = 1, targets = 2, certify = 0.3}
      local bounded = assert(bw.worst_case(part, with(few, solver)))
      compare("bounded", bounded.max_principal)
      -- Multipliers are not unique: the bounds may differ within the tolerance.
      assert.truthy(bounded.gap >= 0 and bounded.gap <= 0.3)
      compare("friction", assert(bw.worst_case(part, with({force = 5, pressure = 2e5, modes = 1, regions = 1,
        method = "paper", friction = 0.3, friction_facets = 4}, solver))).max_principal)
      local brute = assert(bw.brute_force(part, with({force = 5, pressure = 2e5, elements = 3}, solver)))
      compare("brute force", brute.max_principal)
      assert.equal(backend, brute.reports.lp.backend)
      local _, value, report = basis:maximise(system, objective, with({force = 5, pressure = 2e5}, solver))
      compare("maximise", value)
      assert.equal(backend, report.backend)
      local breaking = assert(bw.breaking_force(mesh, with({contact = 1e-4, modes = 1, regions = 1,
        material = part.material, length = 0.005, force = 5}, solver)))
      compare("breaking force", breaking.force)
      assert.equal(backend, breaking.reports.lp.backend)
    end
  end)

  it("are refused where they are something else", function()
    check.raises("option 'lp': a linear program solver of bw.lp or \"auto\" expected, got string 'simplex'",
      bw.worst_case, part, with(limits, "simplex"))
    check.raises("option 'glpk'", bw.worst_case, part, {["glpk"] = true})
    local basis, system = assert(bw.pressure_basis(mesh)), assert(part:system())
    check.raises("option 'lp': bw.lp.dual_simplex {}, bw.lp.glpk {} or \"auto\" expected", bw.worst_loads,
      system, basis, bw.single_regions(mesh, {1}), {pressure = 1e5, force = 1, lp = 3})
  end)

  it("give up at a limit of iterations, and do not ask another solver", function()
    for name in pairs(backends) do
      check.fails("convergence", "not solved by " .. name,
        bw.worst_case(part, with(limits, bw.lp[name] {max_iterations = 1})))
    end
  end)
end)
