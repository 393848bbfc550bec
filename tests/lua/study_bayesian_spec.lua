-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Gaussian processes and the search by expected improvement: published minima, properties, scikit-learn.
local bw = require "barwright"
local check = require "check"
local designs = require "barwright.study.designs"
local problem_of = require "barwright.study.problem"
local process = require "barwright.study.gaussian_process"
local random = require "barwright.study.random"

local function run(design, opts, f)
  opts.measures = opts.measures or {"f"}
  opts.objectives = opts.objectives or {"f"}
  local problem = problem_of.read("test", opts)
  local made = designs.read("test", design, problem, 1)
  local best, count, batches = nil, 0, 0
  local function evaluate(list)
    local results = {}
    batches = batches + 1
    for i, point in ipairs(list) do
      local value = f(problem:check(point, "point"))
      results[i] = value ~= nil and (type(value) == "table" and value or {f = value})
      count = count + 1
      if results[i] and problem:violation(results[i]) == 0 and (not best or results[i].f < best.f) then
        best = {f = results[i].f, point = point}
      end
    end
    return results, {}
  end
  return made.run(evaluate, problem, made.opts), best, count, batches
end

local function branin(p)
  return (p.y - 5.1 / (4 * math.pi ^ 2) * p.x ^ 2 + 5 / math.pi * p.x - 6) ^ 2
    + 10 * (1 - 1 / (8 * math.pi)) * math.cos(p.x) + 10
end
local PLANE = {{name = "x", min = -5, max = 10}, {name = "y", min = 0, max = 15}}

-- Dixon and Szego, Towards Global Optimization 2, 1978.
local A = {{10, 3, 17, 3.5, 1.7, 8}, {0.05, 10, 17, 0.1, 8, 14}, {3, 3.5, 1.7, 10, 17, 8},
  {17, 8, 0.05, 10, 0.1, 14}}
local P = {{1312, 1696, 5569, 124, 8283, 5886}, {2329, 4135, 8307, 3736, 1004, 9991},
  {2348, 1451, 3522, 2883, 3047, 6650}, {4047, 8828, 8732, 5743, 1091, 381}}
local ALPHA = {1, 1.2, 3, 3.2}
local function hartmann(p)
  local sum = 0.0
  for i = 1, 4 do
    local inner = 0.0
    for k = 1, 6 do inner = inner + A[i][k] * (p["x" .. k] - 1e-4 * P[i][k]) ^ 2 end
    sum = sum + ALPHA[i] * math.exp(-inner)
  end
  return -sum
end

describe("a Gaussian process", function()
  local source = random.new(3)
  local places, values = {}, {}
  for i = 1, 25 do
    places[i] = {source:uniform(), source:uniform()}
    values[i] = math.sin(6 * places[i][1]) + places[i][2] ^ 2
  end

  it("goes through what it knows, and knows how far off it is", function()
    local made = process.fit(places, values)
    for i, place in ipairs(places) do
      local value, deviation = made:predict(place)
      assert.is_true(math.abs(value - values[i]) < 1e-3 and deviation < 1e-2)
    end
    local outside, squares = 0, 0.0
    for _ = 1, 400 do
      local place = {source:uniform(), source:uniform()}
      local value, deviation = made:predict(place)
      local off = math.abs(value - math.sin(6 * place[1]) - place[2] ^ 2)
      squares = squares + off * off
      if off > 3 * deviation + 1e-4 then outside = outside + 1 end
    end
    assert.is_true(math.sqrt(squares / 400) < 0.03)
    assert.is_true(outside < 40, outside .. " of 400 beyond three deviations")
  end)

  it("predicts trials that are left out as a process without them does", function()
    local made = process.new(places, values, {0.5, 0.8}, 1e-6, 0.3, 2)
    local left_out = made:left_out(values)
    for _, i in ipairs {1, 7, 25} do
      local fewer, rest = {}, {}
      for k = 1, 25 do
        if k ~= i then fewer[#fewer + 1], rest[#rest + 1] = places[k], values[k] end
      end
      local value = process.new(fewer, rest, {0.5, 0.8}, 1e-6, 0.3, 2):predict(places[i])
      assert.is_true(math.abs(value - left_out[i]) < 1e-7)
    end
  end)

  it("has the likelihood and the predictions of scikit-learn", function()
    if not os.execute "/usr/bin/python3 -c 'import sklearn' 2>/dev/null" then
      pending "python3-sklearn is not installed"
      return
    end
    local asked = {{0.2, 0.9}, {0.5, 0.5}, {1, 0}}
    local path = os.tmpname()
    check.write(path, ([[
import json
import numpy as np
from sklearn.gaussian_process import GaussianProcessRegressor as GP
from sklearn.gaussian_process.kernels import ConstantKernel as C, Matern, WhiteKernel
d = json.loads('%s')
X, y = np.array(d['places']), np.array(d['values']) - 0.3
g = GP(C(2.0) * Matern([0.5, 0.8], nu=2.5), alpha=2e-6, optimizer=None).fit(X, y)
m, s = g.predict(np.array(d['asked']), return_std=True)
print(json.dumps({'l': g.log_marginal_likelihood_value_, 'm': list(m + 0.3), 's': list(s)}))
]]):format(bw.json.encode {places = places, values = values, asked = asked}))
    local pipe = assert(io.popen("/usr/bin/python3 -W ignore " .. path))
    local found = assert(bw.json.decode(pipe:read "a"))
    pipe:close()
    os.remove(path)
    local made = process.new(places, values, {0.5, 0.8}, 1e-6, 0.3, 2)
    check.near(found.l, made.log_likelihood, 1e-8)
    for i, place in ipairs(asked) do
      local value, deviation = made:predict(place)
      check.near(found.m[i], value, 1e-8)
      check.near(found.s[i], deviation, 1e-6)
    end
  end)
end)

describe("a surrogate", function()
  local function trials_of(count)
    local study = bw.study {name = "arc", file = check.folder() .. "/arc.study", design = {"sobol", count = count},
      measures = {{name = "f", unit = "m"}, {name = "flat", optional = true}},
      variables = {{name = "x", min = 0, max = 3}, {name = "idle", min = 0, max = 1}},
      run = function(point) return {f = math.sin(point.x), flat = point.x < 0.2 and 1 or nil} end}
    return assert(study:run())
  end

  it("gives a measure between trials, its deviation and its error", function()
    local trials = trials_of(24)
    local arc = assert(trials:surrogate "f")
    for x = 0.1, 2.9, 0.2 do
      local value, deviation = arc:predict {x = x, idle = 0.4}
      assert.is_true(math.abs(value - math.sin(x)) < 5 * deviation + 1e-3)
      assert.is_true(math.abs(value - math.sin(x)) < 0.02)
    end
    assert.is_true(arc.error < 0.05 and arc.count == 24)
    assert.is_true(arc.lengths.idle > 4 * arc.lengths.x)
    assert.truthy(tostring(arc):find("between 24 trials", 1, true))
    check.raises("'g' is no measure", trials.surrogate, trials, "g")
    check.raises("'idle' is missing", arc.predict, arc, {x = 1})
    check.fails("empty", "3 to 1000 trials with 'flat' expected", trials:surrogate "flat")
  end)
end)

describe("the search by expected improvement", function()
  it("finds Branin's minimum", function()
    local found, best, count = run({"bayesian", count = 60}, {variables = PLANE}, branin)
    assert.is_true(best.f < 0.397887 + 1e-3, best.f .. " " .. found.text)
    assert.is_true(count <= 60 and count == found.count)
    local _, four, _, batches = run({"bayesian", count = 60, batch = 4, tolerance = 0}, {variables = PLANE},
      branin)
    assert.is_true(four.f < 0.397887 + 0.01)
    assert.equal(1 + 13, batches) -- 8 first, then 52
  end)

  it("finds Hartmann's minimum in six dimensions", function()
    local variables = {}
    for k = 1, 6 do variables[k] = {name = "x" .. k, min = 0, max = 1} end
    local found, best = run({"bayesian", count = 100, tolerance = 1e-5}, {variables = variables}, hartmann)
    assert.is_true(best.f < -3.32237 + 0.15, best.f .. " " .. found.text)
  end)

  it("keeps constraints, passes over failed trials and takes integers and choices", function()
    local _, best = run({"bayesian", count = 50}, {variables = PLANE, measures = {"f", "c"},
      constraints = {{name = "c", max = 50}}}, function(p)
      if p.x > 8 and p.y > 12 then return nil end
      return {f = branin(p), c = (p.x - 2.5) ^ 2 + (p.y - 7.5) ^ 2}
    end)
    -- the constraint leaves the minimum at (3.14, 2.275)
    assert.is_true(best.f < 0.45, tostring(best.f))
    local found
    found, best = run({"bayesian", count = 100}, {variables = {{name = "n", kind = "integer", min = 1, max = 6},
      {name = "c", of = {"p", "q", "r"}}}}, function(p) return (p.n - 4) ^ 2 + (p.c == "q" and 0 or 1) end)
    assert.equal(0, best.f)
    assert.is_true(found.count <= 18)
    assert.equal("no trial has a result: nothing to learn from", run({"bayesian", count = 20}, {variables = PLANE},
      function() return nil end).text)
    check.raises("one objective expected", run, {"bayesian", count = 9}, {variables = PLANE, measures = {"a", "b"},
      objectives = {"a", "b"}}, branin)
  end)

  it("repeats itself for a seed", function()
    local a = run({"bayesian", count = 20}, {variables = PLANE}, branin)
    assert.equal(a.text, run({"bayesian", count = 20}, {variables = PLANE}, branin).text)
  end)
end)
