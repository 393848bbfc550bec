-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Variables that scatter, and the probability of failure: closed forms, a quadrature of the plane, properties.
-- Functions are evaluated here and now, in place of trials.
local check = require "check"
local correlations = require "barwright.study.correlations"
local designs = require "barwright.study.designs"
local distributions = require "barwright.study.distributions"
local normal = require "barwright.study.normal"
local problem_of = require "barwright.study.problem"

-- A design on a function of points: summary, results, how many points were asked for.
local function run(design, opts, f, seed)
  opts.measures = opts.measures or {"g"}
  opts.constraints = opts.constraints or {{name = "g", min = 0}}
  local problem = problem_of.read("test", opts)
  local made = designs.read("test", design, problem, seed or 1)
  local all = {}
  local function evaluate(list)
    local results, trials = {}, {}
    for i, point in ipairs(list) do
      local value, gradients = f(problem:check(point, "point"))
      results[i] = value ~= nil and (type(value) == "table" and value or {g = value})
      trials[i] = {gradients = gradients}
      all[#all + 1] = point
    end
    return results, trials
  end
  return made.run(evaluate, problem, made.opts), all, problem
end

local function standard(count)
  local list = {}
  for k = 1, count do list[k] = {name = "x" .. k, distribution = {"normal", mean = 0, deviation = 1}} end
  return list
end

local function contains(part, text)
  assert.is_truthy(text:find(part, 1, true), text)
end

local function inside(value, low, high, what)
  assert.is_true(low <= value and value <= high,
    ("%s: %.6g to %.6g expected, got %.6g"):format(what, low, high, value))
end

describe("the normal distribution", function()
  -- Abramowitz and Stegun, tables 26.1 and 26.2; the far tail by its asymptotic series.
  it("has the values of tables in both tails", function()
    for _, row in ipairs {{0, 0.5}, {-1, 0.158655253931457}, {-2, 0.0227501319481792}, {-3, 0.00134989803163009},
        {-5, 2.866515718791940e-7}, {1, 0.841344746068543}} do
      check.near(row[2], normal.probability(row[1]), 1e-13)
    end
    local z = 30
    local series = normal.density(z) / z * (1 - 1 / z ^ 2 + 3 / z ^ 4 - 15 / z ^ 6)
    check.near(series, normal.probability(-z), 1e-9)
  end)

  it("is inverted by its quantile", function()
    for z = -30, 4, 0.37 do
      local there = normal.quantile(normal.probability(z))
      assert.is_true(math.abs(there - z) < 1e-10 * math.max(1, math.abs(z)), ("%g %g"):format(z, there - z))
    end
    assert.equal(-math.huge, normal.quantile(0))
    assert.equal(math.huge, normal.quantile(1))
  end)
end)

local kinds = {{"normal", mean = 2, deviation = 0.5}, {"lognormal", mean = 2, deviation = 0.5},
  {"uniform", min = 1, max = 3}, {"weibull", scale = 2, shape = 5}, {"weibull", scale = 2, shape = 1.5, min = 1},
  {"gumbel", mean = 2, deviation = 0.5}}

-- Closed forms of mean, deviation and the probability below 2.3.
local GAMMA = {[5] = {0.918168742399761, 0.887263817503075}, [1.5] = {0.902745292950934, 1.190639348758999}}
local function weibull(scale, shape, min)
  local a, b = GAMMA[shape][1], GAMMA[shape][2]
  return {min + scale * a, scale * math.sqrt(b - a * a), 1 - math.exp(-((2.3 - min) / scale) ^ shape)}
end
local b = 0.5 * math.sqrt(6) / math.pi
local zeta = math.sqrt(math.log(1 + 0.25 ^ 2))
local closed = {
  {2, 0.5, normal.probability(0.6)},
  {2, 0.5, normal.probability((math.log(2.3) - math.log(2) + zeta ^ 2 / 2) / zeta)},
  {2, 2 / math.sqrt(12), 0.65}, weibull(2, 5, 0), weibull(2, 1.5, 1),
  {2, 0.5, math.exp(-math.exp(-(2.3 - 2 + 0.577215664901533 * b) / b))},
}

describe("distributions", function()
  it("have their mean, deviation and probabilities", function()
    for i, given in ipairs(kinds) do
      local d = distributions.read("test", given)
      local mean, square = 0.0, 0.0
      for z = -9, 9, 0.125 do
        local weight, x = 0.125 * normal.density(z), d:value(z)
        mean, square = mean + weight * x, square + weight * x * x
      end
      check.near(closed[i][1], mean, 1e-6)
      check.near(closed[i][2], math.sqrt(square - mean * mean), 1e-5)
      check.near(closed[i][3], normal.probability(d:normal(2.3)), 1e-12)
    end
  end)

  it("go from coordinates to values and back", function()
    for _, given in ipairs(kinds) do
      local d = distributions.read("test", given)
      local reach = given[1] == "uniform" and 5 or 7
      for z = -reach, reach, 0.5 do
        assert.is_true(math.abs(d:normal(d:value(z)) - z) < 1e-6, tostring(d) .. " " .. z)
        local slope = (d:value(z + 1e-5) - d:value(z - 1e-5)) / 2e-5
        assert.is_true(math.abs(slope - d:slope(z)) < 1e-3 * slope + 1e-9, tostring(d) .. " " .. z)
      end
    end
  end)

  it("are refused where they are none", function()
    check.raises("one of gumbel, lognormal, normal, uniform, weibull expected, got string 'norm'",
      distributions.read, "v", {"norm"})
    check.raises("deviation", distributions.read, "v", {"normal", mean = 1, deviation = 0})
    check.raises("min below max expected", distributions.read, "v", {"uniform", min = 2, max = 1})
    check.raises("a finite number expected", distributions.read, "v", {"normal", mean = math.huge, deviation = 1})
    local function read(v) return function() problem_of.read("test", {variables = {v}, measures = {"g"}}) end end
    check.raises("a distribution is of a real", read {name = "x", min = 0, distribution = kinds[1]})
    check.raises("a distribution is of a real", read {name = "x", kind = "integer", distribution = kinds[1]})
    check.raises("give skip = 1", run, {"sobol", count = 4, scramble = false}, {variables = standard(1)},
      function() return 1 end)
    check.raises("design grid works between min and max; 'x1' has a distribution", run, {"grid", levels = 2},
      {variables = standard(1)}, function() return 1 end)
  end)
end)

describe("correlated variables", function()
  local L = distributions.read("test", kinds[2])
  local M = distributions.read("test", {"lognormal", mean = 3, deviation = 1.5})

  -- Of lognormal values it is known: Der Kiureghian and Liu, Journal of Engineering Mechanics 112, 1986.
  it("have the correlation of their normal coordinates by the closed form", function()
    local a, c = L.parameters.log_deviation, M.parameters.log_deviation
    for _, r in ipairs {-0.9, -0.3, 0, 0.5, 0.95} do
      local expected = (math.exp(a * c * r) - 1) / math.sqrt((math.exp(a * a) - 1) * (math.exp(c * c) - 1))
      assert.is_true(math.abs(correlations.of_values(L, M, r) - expected) < 1e-9)
    end
  end)

  it("scatter as they are told to", function()
    local variables = {{name = "a", distribution = kinds[2]}, {name = "b", distribution = kinds[4]},
      {name = "c", distribution = kinds[6]}}
    local _, points, problem = run({"sobol", count = 4096}, {variables = variables,
      correlations = {{"a", "b", 0.6}, {"c", "b", -0.3}}}, function() return 1 end)
    local function correlation(p, q)
      local n, sp, sq, pp, qq, pq = #points, 0.0, 0.0, 0.0, 0.0, 0.0
      for _, point in ipairs(points) do
        local x, y = point[p], point[q]
        sp, sq, pp, qq, pq = sp + x, sq + y, pp + x * x, qq + y * y, pq + x * y
      end
      return (pq - sp * sq / n) / math.sqrt((pp - sp * sp / n) * (qq - sq * sq / n))
    end
    inside(correlation("a", "b"), 0.59, 0.61, "a and b")
    inside(correlation("b", "c"), -0.31, -0.29, "b and c")
    inside(correlation("a", "c"), -0.01, 0.01, "a and c")
    local y = {0.3, -1.2, 2}
    local back = problem:normal_place(problem:normal_point(y))
    for k = 1, 3 do assert.is_true(math.abs(back[k] - y[k]) < 1e-9) end
  end)

  it("are refused where they cannot be", function()
    local function read(list)
      return function()
        problem_of.read("test", {variables = {{name = "a", distribution = kinds[2]},
          {name = "b", min = 0, max = 1}, {name = "c", distribution = kinds[1]},
          {name = "d", distribution = kinds[1]}}, measures = {"g"}, correlations = list})
      end
    end
    check.raises("'b' is no variable with a distribution", read {{"a", "b", 0.1}})
    check.raises("a number between -1 and 1 expected, got 1", read {{"a", "c", 1}})
    check.raises("occur twice", read {{"a", "c", 0.1}, {"c", "a", 0.2}})
    check.raises("not positive definite", read {{"a", "c", 0.9}, {"a", "d", 0.9}, {"c", "d", -0.9}})
    check.raises("is possible", read {{"a", "c", 0.999}})
    check.raises("got the key string 'a_c'", read {a_c = 0.5})
    check.raises("independent variables expected", run, {"sobol_indices", base = 8}, {variables = standard(2),
      correlations = {{"x1", "x2", 0.5}}}, function() return 1 end)
  end)
end)

-- x1 + 2 x2 + 2 x3 reaches 3 beta at the distance beta from the origin.
local function plane(beta)
  return function(p) return beta - (p.x1 + 2 * p.x2 + 2 * p.x3) / 3 end
end

describe("the first-order reliability method", function()
  it("is exact for planes", function()
    for _, beta in ipairs {-1, 0.5, 2, 4.5} do
      local found = run({"form"}, {variables = standard(3)}, plane(beta))
      assert.equal(1, #found.points)
      local one = found.points[1]
      check.near(beta, one.reliability_index, 1e-6)
      check.near(normal.probability(-beta), found.probability, 1e-5)
      check.near(4 / 9, one.importance.x2, 1e-6)
      check.near(beta / 3, one.point.x1, 1e-5)
    end
  end)

  -- Strength and load, both lognormal: the logarithm of their ratio is normal.
  it("is exact for lognormal strength and load, correlated too", function()
    local variables = {{name = "strength", distribution = {"lognormal", mean = 40, deviation = 4}},
      {name = "load", distribution = {"lognormal", mean = 20, deviation = 5}}}
    local zr, zs = math.sqrt(math.log(1.01)), math.sqrt(math.log(1 + 0.0625))
    for _, r in ipairs {0, 0.4} do
      local covariance = math.log(1 + r * math.sqrt((math.exp(zr * zr) - 1) * (math.exp(zs * zs) - 1)))
      local beta = (math.log(2) - zr * zr / 2 + zs * zs / 2) / math.sqrt(zr * zr + zs * zs - 2 * covariance)
      for _, gradient in ipairs {"differences", "run"} do
        local found = run({"form", gradient = gradient}, {variables = variables,
          correlations = r ~= 0 and {{"strength", "load", r}} or nil}, function(p)
            return p.strength - p.load, {g = {strength = 1, load = -1}}
          end)
        check.near(beta, found.points[1].reliability_index, 2e-5)
      end
    end
  end)

  -- Hasofer and Lind, Journal of the Engineering Mechanics Division 100, 1974: the index does not depend on how
  -- the limit is written.
  it("does not depend on how the limit is written", function()
    local variables = {{name = "r", distribution = {"normal", mean = 200, deviation = 20}},
      {name = "s", distribution = {"normal", mean = 100, deviation = 20}}}
    local beta = 100 / math.sqrt(800)
    for _, f in ipairs {function(p) return p.r - p.s end, function(p) return math.log(p.r / p.s) end,
        function(p) return 1 - p.s / p.r end, function(p) return p.r ^ 3 - p.s ^ 3 end} do
      check.near(beta, run({"form"}, {variables = variables}, f).points[1].reliability_index, 1e-4)
    end
  end)

  it("bounds the probability of several limits", function()
    local found = run({"form"}, {variables = standard(2), measures = {"a", "b"},
      constraints = {{name = "a", max = 2}, {name = "b", min = -2.5, max = 3}}},
      function(p) return {a = p.x1, b = p.x2} end)
    assert.equal(3, #found.points)
    local p1, p2, p3 = normal.probability(-2), normal.probability(-2.5), normal.probability(-3)
    check.near(p1, found.low, 1e-5)
    check.near(p1 + p2 + p3, found.high, 1e-5)
    inside(1 - (1 - p1) * (1 - p2 - p3), found.low, found.high, "exact")
    assert.is_nil(found.probability)
  end)

  it("says where there is no design point", function()
    local part = run({"form"}, {variables = standard(2), measures = {"a", "b"},
      constraints = {{name = "a", max = 3}, {name = "b", max = 0.5}}},
      function(p) return {a = p.x1, b = p.x2 > 0.4 and 1 or 0} end)
    assert.is_true(part.probability == nil and part.high == nil)
    contains("at least 0.00135 by planes; 1 of 2 limits have no design point", part.text)
    local found = run({"form"}, {variables = standard(2)}, function() return 1 end)
    assert.equal(0, #found.points)
    assert.equal("flat", found.lost[1].why)
    assert.is_nil(found.probability)
    contains("g < 0: no design point: ended by flat", found.text)
    found = run({"form"}, {variables = standard(2)}, function(p) return p.x1 < 1 and 2 - p.x1 or nil end)
    contains("a trial without a result", found.text)
    check.raises("constraints expected", run, {"form"}, {variables = standard(1), constraints = {}},
      function() return 1 end)
    check.raises("reals expected", run, {"subset"}, {variables = {{name = "c", of = {"p", "q"}}}},
      function() return 1 end)
  end)
end)

-- Four branches (Schueremans and Van Gemert, Structural Safety 27, 2005): four design points in one limit.
local function branches(p)
  local x, y = p.x1, p.x2
  return math.min(3 + 0.1 * (x - y) ^ 2 - (x + y) / math.sqrt(2), 3 + 0.1 * (x - y) ^ 2 + (x + y) / math.sqrt(2),
    x - y + 7 / math.sqrt(2), y - x + 7 / math.sqrt(2))
end

-- Its probability by the quadrature of the plane: in u = (x + y) / sqrt 2 and v = (x - y) / sqrt 2 it is safe for
-- |v| < 3.5 and |u| < 3 + 0.2 v^2.
local function branches_probability()
  local safe, h = 0.0, 0.001
  for v = -3.5 + h / 2, 3.5, h do
    safe = safe + h * normal.density(v) * (1 - 2 * normal.probability(-(3 + 0.2 * v * v)))
  end
  return 1 - safe
end

describe("sampling for failures", function()
  local exact = branches_probability()

  it("finds the four branches", function()
    check.near(2.22e-3, exact, 0.005)
    local found = run({"form", starts = 24}, {variables = standard(2)}, branches)
    assert.equal(4, #found.points)
    local sampled = run({"importance", starts = 24, error = 0.02, count = 20000}, {variables = standard(2)},
      branches)
    inside(exact, sampled.low, sampled.high, sampled.text)
    inside(sampled.deviation / exact, 0, 0.021, "error")
    local levels = run({"subset", count = 4000}, {variables = standard(2)}, branches)
    inside(exact, levels.low, levels.high, levels.text)
    local plain = run({"random", count = 20000}, {variables = standard(2)}, branches)
    inside(exact, plain.failure.low, plain.failure.high, plain.text)
  end)

  -- An interval of 95 % misses in 5 of 100; 12 has a probability of 0.4 %.
  it("gives intervals that hold the truth", function()
    local missed = {importance = 0, subset = 0, random = 0}
    local truth = {importance = normal.probability(-3.5), subset = normal.probability(-3.5), random = exact}
    for seed = 1, 100 do
      for name, design in pairs {importance = {"importance", error = 0.1}, subset = {"subset", count = 300},
          random = {"random", count = 3000}} do
        local found = run(design, {variables = standard(name == "random" and 2 or 3)},
          name == "random" and branches or plane(3.5), seed)
        found = found.failure or found
        if found.low > truth[name] or found.high < truth[name] then missed[name] = missed[name] + 1 end
      end
    end
    inside(missed.importance, 0, 11, "importance")
    inside(missed.random, 0, 11, "random")
    inside(missed.subset, 0, 16, "subset: deviation estimated from one run")
  end)

  -- The search from the medians finds one of two failures. The other is seen around the origin where it is likely,
  -- and by further starts where it is not.
  it("counts failures apart from the design points where they are likely, or starts find them", function()
    local function two(beta) return function(p) return beta - math.abs(p.x1 + 1e-3) end end
    local function both(beta) return normal.probability(-beta + 1e-3) + normal.probability(-beta - 1e-3) end
    local sampled = run({"importance", error = 0.03, count = 20000}, {variables = standard(1)}, two(2))
    inside(both(2), sampled.low, sampled.high, sampled.text)
    contains("assumed: no region of failure lies apart", sampled.text)
    sampled = run({"importance", starts = 8, error = 0.05}, {variables = standard(1)}, two(3.5))
    assert.equal(2, #sampled.form.points)
    inside(both(3.5), sampled.low, sampled.high, sampled.text)
  end)

  it("reaches small probabilities in 20 dimensions", function()
    local function sum(p)
      local s = 0.0
      for k = 1, 20 do s = s + p["x" .. k] end
      return 4.5 - s / math.sqrt(20)
    end
    local truth = normal.probability(-4.5)
    local sampled = run({"importance", error = 0.05}, {variables = standard(20)}, sum)
    inside(truth, sampled.low, sampled.high, sampled.text)
    local levels, asked = run({"subset", count = 1000}, {variables = standard(20)}, sum)
    inside(truth, levels.probability / 3, levels.probability * 3, levels.text)
    assert.is_true(#asked < 8000)
    assert.equal(#asked, levels.count)
  end)

  it("says what it did not find", function()
    local levels = run({"subset", count = 100, levels = 3}, {variables = standard(1)},
      function(p) return 8 - p.x1 end)
    assert.is_nil(levels.probability)
    inside(normal.probability(-8), levels.low, levels.high, levels.text)
    contains("no failure in 3 levels: probability of failure below", levels.text)
    contains("all trials have the same margin", run({"subset", count = 100}, {variables = standard(1)},
      function() return 1 end).text)
    -- A margin that is never negative, and levels that end where failures are known.
    levels = run({"subset", count = 200}, {variables = standard(1)}, function(p) return math.max(0, 1 - p.x1) end)
    assert.is_nil(levels.probability)
    assert.is_true(levels.low == 0 and levels.high > 0)
    levels = run({"subset", levels = 1}, {variables = standard(1)}, function(p) return 1.8 - p.x1 end)
    inside(normal.probability(-1.8), levels.low, levels.high, levels.text)
    local sampled = run({"importance", count = 500}, {variables = standard(1)}, function(p)
      return p.x1 < 6 and 1 or -1
    end)
    assert.is_nil(sampled.probability)
    inside(normal.probability(-6), sampled.low, sampled.high, sampled.text)
    contains("no failure in 500 trials", sampled.text)
    contains("without results count as failures", run({"subset", count = 100}, {variables = standard(1)},
      function(p) return p.x1 < 1 and 1 - p.x1 or nil end).text)
  end)

  it("repeats itself for a seed", function()
    for _, design in ipairs {{"importance"}, {"subset", count = 200}, {"form", starts = 3}} do
      local a = run(design, {variables = standard(2)}, branches)
      local again = run(design, {variables = standard(2)}, branches)
      assert.equal(a.text, again.text)
    end
  end)
end)
