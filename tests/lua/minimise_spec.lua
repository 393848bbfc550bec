-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Minimisers of Lua functions, and points that fill a cube evenly.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local function valley(x)
  local a, b = x[2] - x[1] ^ 2, 1 - x[1]
  return 100 * a * a + b * b, {-400 * x[1] * a - 2 * b, 200 * a}
end

describe("a minimiser", function()
  it("finds the bottom of a valley, with every method", function()
    for _, method in ipairs {"bobyqa", "neldermead", "sbplx", "direct_l", "crs2", "isres", "mma", "slsqp",
      "lbfgs", "cobyla"} do
      local calls = 0
      local x, value, report = core.minimise {method = method, start = {-1.2, 1}, min = {-5, -5}, max = {5, 5},
        tolerance = 1e-8, evaluations = 20000,
        objective = function(at)
          calls = calls + 1
          return valley(at)
        end}
      assert(x, value)
      assert.truthy(value < 0.02, method)
      check.near(value, valley(x), 0)
      assert.equal(calls, report.evaluations)
      assert.equal(report.why ~= "evaluations" and report.why ~= "stuck", report.converged)
    end
  end)

  it("keeps to constraints", function()
    local x, value, report = assert(core.minimise {method = "slsqp", start = {1, 1},
      objective = function(x) return -x[1] - x[2], {-1, -1} end,
      constraints = {function(x) return x[1] ^ 2 + x[2] ^ 2 - 1, bw.array.new {2 * x[1], 2 * x[2]} end}})
    check.near(-math.sqrt(2), value, 1e-6)
    check.near(math.sqrt(0.5), x[1], 1e-4)
    assert.equal("tolerance", report.why)
    assert.truthy(report.violation <= 1e-6)
    local none, message, details = core.minimise {start = {0}, min = {-1}, max = {1},
      objective = function(at) return at[1] end, constraints = {function(at) return 2 + at[1] end}}
    check.fails("infeasible", "satisfies the constraints", none, message, details)
    check.near(1, details.violation, 1e-6)
  end)

  it("carries an error of a function out, and works again after it", function()
    for _, method in ipairs {"cobyla", "bobyqa", "neldermead", "direct_l", "crs2", "isres", "mma", "slsqp",
      "lbfgs"} do
      local calls, mine = 0, {}
      local ok, raised = pcall(core.minimise, {method = method, start = {0, 0}, min = {-1, -1}, max = {1, 1},
        objective = function(x)
          calls = calls + 1
          if calls == 3 then error(mine) end
          return valley(x)
        end})
      assert.is_false(ok)
      assert.equal(mine, raised)
      assert.equal(3, calls)
    end
    check.raises("must return a number, got string", core.minimise,
      {start = {1}, objective = function() return "1" end})
    check.raises("needs gradients", core.minimise,
      {method = "mma", start = {1}, objective = function() return 1 end})
    check.raises("a gradient of 1 numbers", core.minimise,
      {method = "mma", start = {1}, objective = function() return 1, {1, 2} end})
    check.fails("convergence", "the objective is",
      core.minimise {start = {1}, objective = function() return 0 / 0 end})
  end)

  it("may use the engine in its functions, and jobs, and a minimiser", function()
    local function objective(x)
      local job = core.job(function() return ("%.17g"):format((x[1] - 0.5) ^ 2) end)
      core.wait {job}
      local inner = assert(core.minimise {start = {1}, objective = function(y) return y[1] ^ 2 end})
      assert(math.abs(inner[1]) < 0.1 and bw.array.zeros(2, 1).row_count == 2)
      return tonumber(assert(job:result()))
    end
    local x = assert(core.minimise {start = {0.2}, min = {0}, max = {1}, evaluations = 12,
      objective = objective})
    check.near(0.5, x[1], 0.1)
  end)

  it("says what is wrong with its arguments", function()
    local function objective(x) return x[1] end
    check.raises("did you mean 'slsqp'", core.minimise, {method = "slsq", start = {1}, objective = objective})
    check.raises("did you mean 'evaluations'", core.minimise, {evaluation = 7, start = {1}, objective = objective})
    check.raises("a function of x", core.minimise, {start = {1}})
    check.raises("option 'start'", core.minimise, {objective = objective})
    check.raises("option 'max': 1 numbers expected, got 2", core.minimise,
      {min = {0}, max = {1, 2}, objective = objective})
    check.raises("takes no constraints", core.minimise,
      {method = "lbfgs", start = {1}, objective = objective, constraints = {objective}})
    local x = core.minimise {min = {0, -math.huge}, max = {1, math.huge}, start = {0.5, 3},
      objective = function(at) return at[1] + (at[2] - 1) ^ 2 end}
    check.near(1, x[2], 1e-2)
  end)
end)

describe("Sobol points", function()
  it("are rows of an array", function()
    local points = core.sobol(8, 3)
    assert.equal(8, points.row_count)
    assert.equal(3, points.column_count)
    assert.same({0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875}, points:column(1):totable())
    assert.same(core.sobol(4, 2, {seed = 3}):totable(), core.sobol(4, 2, {seed = 3}):totable())
    assert.are_not.same(core.sobol(4, 2, {seed = 3}):totable(), core.sobol(4, 2, {seed = 4}):totable())
    assert.same(core.sobol(6, 2, {seed = 3}):totable()[6], core.sobol(1, 2, {seed = 3, skip = 5}):totable()[1])
    assert.equal(0, core.sobol(0, 5).row_count)
    check.raises("1 to 1111 dimensions", core.sobol, 1, 1112)
    check.raises("a number of points", core.sobol, -1, 1)
    check.raises("did you mean 'seed'", core.sobol, 1, 1, {sead = 1})
  end)
end)
