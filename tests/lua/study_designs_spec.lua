-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Designs: counts, the Latin property, spread, indices and fronts beside closed forms, minimisers beside
-- known minima. Functions are evaluated here and now, in place of trials.
local check = require "check"
local designs = require "barwright.study.designs"
local front = require "barwright.study.front"
local problem_of = require "barwright.study.problem"
local sampling = require "barwright.study.sampling"
local random = require "barwright.study.random"

local pi = math.pi

local function reals(count, min, max)
  local list = {}
  for k = 1, count do list[k] = {name = "x" .. k, min = min or 0, max = max or 1} end
  return list
end

-- A design on a function of points: problem, summary, points in the order asked, results.
local function run(design, opts, f)
  local problem = problem_of.read("test", opts)
  local made = designs.read("test", design, problem, 1)
  local points, results, batches = {}, {}, 0
  local function evaluate(list)
    local own, trials = {}, {}
    batches = batches + 1
    for i, point in ipairs(list) do
      point = problem:check(point, "point")
      local gradients
      own[i], gradients = f(point)
      trials[i] = {results = own[i] or nil, gradients = gradients}
      points[#points + 1], results[#results + 1] = point, own[i]
    end
    return own, trials
  end
  return problem, made.run(evaluate, problem, made.opts), points, results, batches
end

local function nothing() return {y = 0} end

describe("designs of levels", function()
  local variables = {{name = "a", min = 0, max = 1}, {name = "n", kind = "integer", min = 1, max = 5},
    {name = "c", of = {"p", "q"}}}

  it("combine all", function()
    local _, _, points = run({"grid", levels = 3}, {variables = variables, measures = {"y"}}, nothing)
    assert.equal(3 * 5 * 2, #points)
    local seen = {}
    for _, p in ipairs(points) do seen[("%g %d %s"):format(p.a, p.n, p.c)] = true end
    local count = 0
    for _ in pairs(seen) do count = count + 1 end
    assert.equal(30, count)
    assert.same({a = 0, n = 1, c = "p"}, points[1])
    assert.same({a = 1, n = 5, c = "q"}, points[30])
    _, _, points = run({"grid", levels = {a = {0.25}, n = 3, c = 1}}, {variables = variables, measures = {"y"}},
      nothing)
    assert.equal(3, #points)
    assert.same({1, 3, 5}, {points[1].n, points[2].n, points[3].n})
    check.raises("at most 10000000 points", run, {"grid", levels = 1000}, {variables = reals(4), measures = {"y"}},
      nothing)
    check.raises("'b' is no variable: known is only a", run, {"grid", levels = {b = 1}},
      {variables = {variables[1]}, measures = {"y"}}, nothing)
    check.raises("the number of levels of 'a' is missing", run, {"grid"},
      {variables = variables, measures = {"y"}}, nothing)
  end)

  it("vary one at a time", function()
    local _, summary, points = run({"one_at_a_time", levels = 5, at = {n = 2}}, {variables = variables,
      measures = {"y"}}, function(p) return {y = 10 * p.a + p.n * p.n} end)
    assert.equal(1 + 4 + 4 + 1, #points)
    assert.same({a = 0.5, n = 2, c = "q"}, points[1])
    local a, n, c = table.unpack(summary.ranges.y)
    assert.same({0, 0.25, 0.5, 0.75, 1}, a.values)
    assert.same({10, 24, 0}, {a.range, n.range, c.range})
    assert.same({1, 2, 3, 4, 5}, n.values)
    assert.same({6, 9, 14, 21, 30}, n.results)
  end)
end)

describe("designs that fill the cube", function()
  it("give Latin hypercubes one place in every slice, also spread ones", function()
    for _, maximin in ipairs {false, true} do
      local _, _, points = run({"latin_hypercube", count = 24, maximin = maximin}, {variables = reals(3),
        measures = {"y"}}, nothing)
      for k = 1, 3 do
        local seen = {}
        for _, p in ipairs(points) do
          local slice = math.floor(p["x" .. k] * 24)
          assert.is_nil(seen[slice])
          seen[slice] = true
        end
      end
    end
    local plain = sampling.latin(30, 2, random.new(3), false)
    local before = sampling.separation(plain)
    assert.is_true(sampling.separation(sampling.spread(plain, random.new(3))) > 3 * before)
  end)

  it("repeat with the seed and differ without", function()
    for _, name in ipairs {"random", "latin_hypercube", "sobol"} do
      local opts = {variables = reals(3), measures = {"y"}}
      local _, _, a = run({name, count = 16}, opts, nothing)
      local _, _, b = run({name, count = 16}, opts, nothing)
      local _, _, c = run({name, count = 16, seed = 2}, opts, nothing)
      assert.equal(16, #a)
      assert.same(a, b)
      assert.are_not.same(a, c)
    end
    local _, _, one = run({"sobol", count = 4, scramble = false}, {variables = reals(1), measures = {"y"}},
      nothing)
    assert.equal(4, #one)
  end)

  it("draw as the engine does", function()
    -- The first words of xoshiro256** after splitmix64 of seed 0.
    local source = random.new(0)
    local a, b = source:bits(), source:bits()
    assert.equal(0x99ec5f36cb75f2b4, a)
    assert.equal(0xbf6e1f784956452a, b)
    local sum, square, n = 0, 0, 20000
    for _ = 1, n do
      local x = source:normal(2, 3)
      sum, square = sum + x, square + x * x
    end
    check.near(2, sum / n, 0.05)
    check.near(9, square / n - (sum / n) ^ 2, 0.05)
    local counts = {0, 0, 0}
    for _ = 1, 3000 do
      local k = source:integer(1, 3)
      counts[k] = counts[k] + 1
    end
    for k = 1, 3 do check.near(1000, counts[k], 0.1) end
  end)
end)

-- Ishigami and Homma's function: variances by integration.
local function ishigami(p)
  return {y = math.sin(p.x1) + 7 * math.sin(p.x2) ^ 2 + 0.1 * p.x3 ^ 4 * math.sin(p.x1)}
end
local v1 = 0.5 * (1 + 0.1 * pi ^ 4 / 5) ^ 2
local v2 = 49 / 8
local v13 = 0.01 * pi ^ 8 * (1 / 18 - 1 / 50)
local v = v1 + v2 + v13
local exact = {first = {v1 / v, v2 / v, 0}, total = {(v1 + v13) / v, v2 / v, v13 / v}}

describe("indices of sensitivity", function()
  it("of Ishigami's function are those of the integrals", function()
    for _, estimator in ipairs {"saltelli", "jansen"} do
      local _, summary, points = run({"sobol_indices", base = 4096, estimator = estimator, resamples = 50},
        {variables = reals(3, -pi, pi), measures = {"y"}}, ishigami)
      assert.equal(4096 * 5, #points)
      check.near(v, summary.variance.y, 0.01)
      check.near(3.5, summary.mean.y, 0.01)
      for k, item in ipairs(summary.indices.y) do
        assert.is_true(math.abs(item.first - exact.first[k]) < 0.01, estimator .. k .. " " .. item.first)
        assert.is_true(math.abs(item.total - exact.total[k]) < 0.01, estimator .. k .. " " .. item.total)
        assert.is_true(item.first_interval[1] <= item.first and item.first <= item.first_interval[2])
        assert.is_true(item.total_interval[2] - item.total_interval[1] < 0.12)
      end
    end
  end)

  it("of the g-function are those of the product", function()
    local a = {0, 1, 4.5, 9, 99, 99}
    local _, summary = run({"sobol_indices", base = 2048, resamples = 20}, {variables = reals(6),
      measures = {"y"}}, function(p)
        local y = 1
        for k = 1, 6 do y = y * (math.abs(4 * p["x" .. k] - 2) + a[k]) / (1 + a[k]) end
        return {y = y}
      end)
    local part, product = {}, 1
    for k = 1, 6 do
      part[k] = 1 / (3 * (1 + a[k]) ^ 2)
      product = product * (1 + part[k])
    end
    for k, item in ipairs(summary.indices.y) do
      assert.is_true(math.abs(item.first - part[k] / (product - 1)) < 0.015, k .. " " .. item.first)
      local total = part[k] * product / (1 + part[k]) / (product - 1)
      assert.is_true(math.abs(item.total - total) < 0.015, k .. " " .. item.total)
    end
  end)

  it("leave out rows with a failed trial, and say so", function()
    local n = 0
    local _, summary = run({"sobol_indices", base = 512, resamples = 0}, {variables = reals(3, -pi, pi),
      measures = {"y"}}, function(p)
        n = n + 1
        return n % 100 ~= 0 and ishigami(p) or false
      end)
    assert.is_true(summary.dropped >= 24 and summary.dropped <= 26)
    assert.truthy(summary.text:find("of 512 rows left out", 1, true))
    assert.is_true(math.abs(summary.indices.y[2].total - exact.total[2]) < 0.05)
    assert.is_nil(summary.indices.y[1].first_interval)
  end)

  it("by Morris are exact for what is linear, and find what bends and what does nothing", function()
    local _, summary, points = run({"morris", trajectories = 20, levels = 6}, {variables = reals(4, -1, 3),
      measures = {"y"}}, function(p) return {y = 2 * p.x1 - 3 * p.x2 + 5 * p.x3 ^ 2} end)
    assert.equal(20 * 5, #points)
    local e = summary.effects.y
    check.near(8, e[1].mu, 1e-12)
    check.near(-12, e[2].mu, 1e-12)
    check.near(12, e[2].mu_star, 1e-12)
    assert.is_true(e[1].sigma < 1e-10 and e[2].sigma < 1e-10)
    assert.is_true(e[3].sigma > 1 and e[3].mu_star_interval[1] <= e[3].mu_star)
    assert.same({0, 0, 0, 20}, {e[4].mu, e[4].mu_star, e[4].sigma, e[4].count})
    check.raises("an even number", run, {"morris", levels = 3}, {variables = reals(1), measures = {"y"}}, nothing)
  end)
end)

describe("fronts", function()
  it("hold what none dominates, rank after rank", function()
    local source = check.random(5)
    local costs = {}
    for i = 1, 120 do costs[i] = {math.floor(20 * source()), math.floor(20 * source())} end
    local left = {}
    for i in ipairs(costs) do left[i] = i end
    local fronts = front.ranks(#costs, function(i, j) return front.dominates(costs[i], costs[j]) end)
    for _, list in ipairs(fronts) do
      local own, place = {}, {}
      for _, i in ipairs(left) do own[#own + 1], place[#place + 1] = costs[i], i end
      local expected = {}
      for i in ipairs(own) do
        local beaten = false
        for j in ipairs(own) do beaten = beaten or front.dominates(own[j], own[i]) end
        if not beaten then expected[#expected + 1] = place[i] end
      end
      assert.same(expected, list)
      local found = {}
      for k, i in ipairs(front.of(own)) do found[k] = place[i] end
      assert.same(expected, found)
      local rest, gone = {}, {}
      for _, i in ipairs(list) do gone[i] = true end
      for _, i in ipairs(left) do if not gone[i] then rest[#rest + 1] = i end end
      left = rest
    end
    assert.equal(0, #left)
  end)

  it("enclose a volume", function()
    assert.equal(0.0, front.hypervolume({}, {1, 1}))
    check.near(0.25, front.hypervolume({{0.5, 0.5}, {0.6, 0.5}, {2, 0}}, {1, 1}), 1e-15)
    check.near(0.5 + 0.125, front.hypervolume({{0, 0.5}, {0.75, 0.0}}, {1, 1}), 1e-15)
    -- Three dimensions beside counting.
    local source, points = check.random(2), {}
    local inside, n = 0, 20
    local function lattice() return source() * n // 1 / n end
    for i = 1, 8 do points[i] = {lattice(), lattice(), lattice()} end
    for i = 0, n ^ 3 - 1 do
      local x, y, z = (i % n + 0.5) / n, (i // n % n + 0.5) / n, (i // (n * n) + 0.5) / n
      for _, p in ipairs(points) do
        if p[1] <= x and p[2] <= y and p[3] <= z then
          inside = inside + 1
          break
        end
      end
    end
    check.near(inside / n ^ 3, front.hypervolume(points, {1, 1, 1}), 1e-12)
  end)

  -- Zitzler, Deb and Thiele's first two problems in ten variables, and a problem with constraints.
  local function zdt(shape)
    return function(p)
      local g = 0
      for k = 2, 10 do g = g + p["x" .. k] end
      g = 1 + 9 * g / 9
      return {f1 = p.x1, f2 = g * shape(p.x1 / g)}
    end
  end
  local two = {variables = reals(10), measures = {"f1", "f2"}, objectives = {"f1", "f2"}}

  local function reached(results, problem)
    local costs = {}
    for _, r in ipairs(results) do
      if r and problem:violation(r) == 0 then costs[#costs + 1] = problem:costs(r) end
    end
    return costs
  end

  it("are found by NSGA-II: ZDT1 and ZDT2 to two hundredths of their volume", function()
    for _, each in ipairs {{function(x) return 1 - math.sqrt(x) end, 1.1 * 1.1 - 1 / 3},
      {function(x) return 1 - x * x end, 1.1 * 1.1 - 2 / 3}} do
      local problem, summary, points, results = run({"pareto", population = 60, generations = 100}, two,
        zdt(each[1]))
      assert.equal(60 * 101, #points)
      -- Below 1.1: the front's own area is 1/3 or 2/3, and 0.1 beyond each end.
      local volume = front.hypervolume(reached(results, problem), {1.1, 1.1})
      assert.is_true(volume < each[2] and volume > each[2] - 0.02, volume .. " of " .. each[2])
      for g = 2, #summary.hypervolume do assert.is_true(summary.hypervolume[g] >= summary.hypervolume[g - 1]) end
    end
  end)

  it("are found within constraints", function()
    -- Binh and Korn's: both constraints cut into the square; the front runs from (0, 50) to (136, 4).
    local opts = {variables = {{name = "x", min = 0, max = 5}, {name = "y", min = 0, max = 3}},
      measures = {"f1", "f2", "g1", "g2"}, objectives = {"f1", "f2"},
      constraints = {{name = "g1", max = 25}, {name = "g2", min = 7.7}}}
    local function f(p)
      return {f1 = 4 * p.x ^ 2 + 4 * p.y ^ 2, f2 = (p.x - 5) ^ 2 + (p.y - 5) ^ 2, g1 = (p.x - 5) ^ 2 + p.y ^ 2,
        g2 = (p.x - 8) ^ 2 + (p.y + 3) ^ 2}
    end
    local problem, _, points, results = run({"pareto", population = 40, generations = 40}, opts, f)
    -- The front by its own formula: x = y up to 3, then y = 3.
    local known = {}
    for i = 0, 2000 do
      local t = 5 * i / 2000
      known[#known + 1] = problem:costs(f {x = t, y = math.min(t, 3)})
    end
    local volume = front.hypervolume(reached(results, problem), {140, 50})
    local best = front.hypervolume(known, {140, 50})
    assert.is_true(volume <= best and volume > 0.985 * best, volume .. " of " .. best)
    local _, _, again = run({"pareto", population = 40, generations = 40}, opts, f)
    assert.same(points, again)
  end)

  it("live with integers, choices and trials that fail", function()
    local opts = {variables = {{name = "n", kind = "integer", min = 0, max = 30},
      {name = "c", of = {"a", "b", "c"}}, {name = "x", min = 0, max = 1}},
      measures = {"f", "g"}, objectives = {{name = "f", goal = "max"}, "g"}}
    local problem, _, _, results = run({"pareto", population = 20, generations = 20}, opts, function(p)
      if p.c == "a" then return false end
      return {f = p.n - 5 * p.x, g = p.n ^ 2 + (p.c == "b" and 100 or 0) + p.x}
    end)
    -- On the front c is "c", x is nearly 0, and most of the 31 numbers are there.
    local costs = reached(results, problem)
    local seen, count = {}, 0
    for _, i in ipairs(front.of(costs)) do
      local n = math.floor(-costs[i][1] + 0.5)
      if not seen[n] then
        seen[n] = true
        count = count + 1
      end
    end
    assert.is_true(count >= 20, count)
  end)
end)

describe("minimisation", function()
  local function rosenbrock(p)
    local a, b = 1 - p.x1, p.x2 - p.x1 ^ 2
    return {y = a * a + 100 * b * b}, {y = {x1 = -2 * a - 400 * p.x1 * b, x2 = 200 * b}}
  end
  local plain = {variables = reals(2, -2, 2), measures = {"y"}, objectives = {"y"}}

  local function min(results)
    local best = math.huge
    for _, r in ipairs(results) do if r then best = math.min(best, r.y) end end
    return best
  end

  it("reaches Rosenbrock's valley by every method that suits", function()
    for method, limit in pairs {bobyqa = 1e-6, sbplx = 1e-6, neldermead = 1e-6, slsqp = 1e-6, lbfgs = 1e-6} do
      local _, summary, _, results = run({"minimise", method = method, evaluations = 600, tolerance = 1e-10,
        start = {x1 = -1.2, x2 = 1}, gradient = "run"}, plain, rosenbrock)
      assert.is_true(min(results) < limit, method .. " " .. min(results))
      check.near(summary.starts[1].value, min(results), 1e-9)
    end
    local _, _, _, results = run({"minimise", method = "lbfgs", evaluations = 200, step = 1e-7}, plain, rosenbrock)
    assert.is_true(min(results) < 1e-4, min(results))
    _, _, _, results = run({"minimise", method = "crs2", evaluations = 2000}, plain, rosenbrock)
    assert.is_true(min(results) < 1e-3)
  end)

  it("keeps constraints, with goals of either sense and numbers of any size", function()
    -- The largest box (volume in litres) of a surface of 6 m2 is the cube of 1 m.
    local opts = {variables = {{name = "a", min = 0.1, max = 4, scale = "log"},
      {name = "b", min = 0.1, max = 4}, {name = "c", min = 0.1, max = 4}}, measures = {"litres", "area"},
      objectives = {{name = "litres", goal = "max"}}, constraints = {{name = "area", max = 6}}}
    local function box(p)
      local a, b, c = p.a, p.b, p.c
      return {litres = 1000 * a * b * c, area = 2 * (a * b + b * c + c * a)},
        {litres = {a = 1000 * b * c, b = 1000 * a * c, c = 1000 * a * b},
          area = {a = 2 * (b + c), b = 2 * (a + c), c = 2 * (a + b)}}
    end
    for _, each in ipairs {{"cobyla"}, {"mma", "run"}, {"slsqp", "run"}, {"slsqp", "differences"}} do
      local _, summary = run({"minimise", method = each[1], gradient = each[2], evaluations = 300,
        start = {a = 0.5, b = 0.7, c = 0.9}}, opts, box)
      check.near(1000, summary.starts[1].value, 2e-3)
      check.near(1, summary.starts[1].point.a, 0.05)
    end
  end)

  it("runs several starts side by side, and the best is found", function()
    -- Two valleys; the narrower is the deeper one.
    local opts = {variables = reals(2, -4, 4), measures = {"y"}, objectives = {"y"}}
    local function f(p)
      local r = (p.x1 - 2) ^ 2 + (p.x2 - 2) ^ 2
      return {y = ((p.x1 + 2) ^ 2 + (p.x2 + 1) ^ 2) / 10 - 4 * math.exp(-r / 2)}
    end
    local _, summary, points, _, batches = run({"minimise", starts = 8, evaluations = 80}, opts, f)
    local best, ends = math.huge, {}
    for _, each in ipairs(summary.starts) do
      best = math.min(best, each.value)
      ends[math.floor(each.value * 10)] = true
    end
    assert.equal(8, #summary.starts)
    assert.is_true(best < -0.5, best)
    assert.is_truthy(next(ends, next(ends))) -- more than one valley
    assert.is_true(batches <= 81 and #points > 4 * batches)
    local _, _, again = run({"minimise", starts = 8, evaluations = 80}, opts, f)
    assert.same(points, again)
  end)

  it("goes round trials that fail", function()
    local _, summary = run({"minimise", method = "cobyla", evaluations = 150, start = {x1 = -1, x2 = 1}},
      plain, function(p)
        if p.x1 > 0.5 then return false end
        return {y = (p.x1 - 0.3) ^ 2 + p.x2 ^ 2}
      end)
    assert.is_true(summary.starts[1].value < 1e-3, summary.starts[1].value)
  end)

  it("says what it cannot do", function()
    local limit = {{name = "y", max = 1}}
    check.raises("'bobyqa' takes no constraints: use cobyla", run, {"minimise", method = "bobyqa"},
      {variables = reals(2), measures = {"y"}, objectives = {"y"}, constraints = limit}, nothing)
    check.raises("one objective expected, the study has 2: use the design pareto", run, {"minimise"},
      {variables = reals(2), measures = {"y", "z"}, objectives = {"y", "z"}}, nothing)
    check.raises("needs reals", run, {"minimise"}, {variables = {{name = "n", kind = "integer", min = 0,
      max = 1}, {name = "x", min = 0, max = 1}}, measures = {"y"}, objectives = {"y"}}, nothing)
    check.raises("run gave no gradient of 'y'", run, {"minimise", method = "lbfgs", gradient = "run"}, plain,
      function() return {y = 1} end)
    check.raises("design pareto: objectives expected", run, {"pareto"},
      {variables = reals(1), measures = {"y"}}, nothing)
  end)
end)
