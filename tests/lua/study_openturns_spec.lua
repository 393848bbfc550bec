-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Distributions, correlated variables and probabilities of failure beside OpenTURNS, where it is installed.
local bw = require "barwright"
local check = require "check"
local designs = require "barwright.study.designs"
local distributions = require "barwright.study.distributions"
local normal = require "barwright.study.normal"
local problem_of = require "barwright.study.problem"

local PYTHON = "/usr/bin/python3"
local there = os.execute(PYTHON .. " -c 'import openturns' 2>/dev/null")

-- What a Python program prints as JSON.
local function python(text)
  local path = os.tmpname()
  check.write(path, "import json\nimport openturns as ot\not.RandomGenerator.SetSeed(1)\n" .. text)
  local pipe = assert(io.popen(PYTHON .. " -W ignore " .. path))
  local out = pipe:read "a"
  pipe:close()
  os.remove(path)
  return assert(bw.json.decode(out))
end

local function run(design, opts, f)
  local problem = problem_of.read("test", opts)
  local made = designs.read("test", design, problem, 1)
  local function evaluate(list)
    local results, trials = {}, {}
    for i, point in ipairs(list) do results[i], trials[i] = {g = f(point)}, {} end
    return results, trials
  end
  return made.run(evaluate, problem, made.opts)
end

describe("OpenTURNS", function()
  if not there then
    pending "python3-openturns is not installed"
    return
  end

  it("has the same distributions", function()
    local found = python [[
b = 0.5 * 6 ** 0.5 / 3.141592653589793
m = ot.LogNormal()
m.setParameter(ot.LogNormalMuSigma()([2, 0.5, 0]))
list = [ot.Normal(2, 0.5), m, ot.Uniform(1, 3), ot.WeibullMin(2, 5, 0), ot.WeibullMin(2, 1.5, 1),
        ot.Gumbel(b, 2 - 0.5772156649015329 * b)]
print(json.dumps([[d.computeQuantile(p)[0] for p in (1e-6, 0.1, 0.5, 0.9, 0.9999)] for d in list]))
]]
    local kinds = {{"normal", mean = 2, deviation = 0.5}, {"lognormal", mean = 2, deviation = 0.5},
      {"uniform", min = 1, max = 3}, {"weibull", scale = 2, shape = 5},
      {"weibull", scale = 2, shape = 1.5, min = 1},
      {"gumbel", mean = 2, deviation = 0.5}}
    for i, given in ipairs(kinds) do
      local d = distributions.read("test", given)
      for k, p in ipairs {1e-6, 0.1, 0.5, 0.9, 0.9999} do
        check.near(found[i][k], d:value(normal.quantile(p)), 1e-8)
      end
    end
  end)

  -- A rod: strength times area against a load, of three kinds of distributions, two of them correlated. The
  -- correlation of the normal coordinates comes from ours; that it is right is the subject of
  -- study_reliability_spec.
  it("finds the same design point, and a probability within both errors", function()
    local opts = {measures = {"g"}, constraints = {{name = "g", min = 0}},
      variables = {{name = "s", distribution = {"weibull", scale = 50e6, shape = 12}},
        {name = "d", distribution = {"normal", mean = 4e-3, deviation = 0.15e-3}},
        {name = "F", distribution = {"gumbel", mean = 300, deviation = 40}}},
      correlations = {{"s", "d", 0.4}}}
    local function f(p) return p.s * math.pi / 4 * p.d ^ 2 / p.F - 1 end
    local factor = problem_of.read("test", opts).correlations.factor
    local found = python(([[
b = 40 * 6 ** 0.5 / 3.141592653589793
R = ot.CorrelationMatrix(3)
R[0, 1] = %.17g
X = ot.ComposedDistribution([ot.WeibullMin(50e6, 12, 0), ot.Normal(4e-3, 0.15e-3),
                             ot.Gumbel(b, 300 - 0.5772156649015329 * b)], ot.NormalCopula(R))
g = ot.SymbolicFunction(['s', 'd', 'F'], ['s*pi_/4*d^2/F-1'])
v = ot.RandomVector(X)
event = ot.ThresholdEvent(ot.CompositeRandomVector(g, v), ot.Less(), 0.0)
solver = ot.AbdoRackwitz()
solver.setMaximumAbsoluteError(1e-8)
solver.setMaximumRelativeError(1e-8)
solver.setMaximumConstraintError(1e-8)
form = ot.FORM(solver, event, X.getMean())
form.run()
r = form.getResult()
point = r.getPhysicalSpaceDesignPoint()
sampler = ot.ImportanceSamplingExperiment(ot.Normal(r.getStandardSpaceDesignPoint(), ot.CovarianceMatrix(3)))
a = ot.ProbabilitySimulationAlgorithm(ot.StandardEvent(event), sampler)
a.setMaximumOuterSampling(200)
a.setBlockSize(1000)
a.setMaximumCoefficientOfVariation(0.005)
a.run()
p = a.getResult()
print(json.dumps({'beta': r.getHasoferReliabilityIndex(), 'point': list(point),
                  'p': p.getProbabilityEstimate(), 'deviation': p.getStandardDeviation()}))
]]):format(factor[2][1]))
    local form = run({"form", tolerance = 1e-4}, opts, f)
    local one = form.points[1]
    check.near(found.beta, one.reliability_index, 1e-4)
    check.near(found.point[1], one.point.s, 1e-3)
    check.near(found.point[2], one.point.d, 1e-3)
    check.near(found.point[3], one.point.F, 1e-3)
    local sampled = run({"importance", error = 0.01, count = 50000}, opts, f)
    local deviation = math.sqrt(sampled.deviation ^ 2 + found.deviation ^ 2)
    assert.is_true(math.abs(sampled.probability - found.p) < 4 * deviation, sampled.text .. " " .. found.p)
  end)

  it("has the four branches' probability within its error", function()
    local found = python [[
g = ot.SymbolicFunction(['x', 'y'], ['min(min(3+0.1*(x-y)^2-(x+y)/sqrt(2), 3+0.1*(x-y)^2+(x+y)/sqrt(2)),'
                                     'min(x-y+7/sqrt(2), y-x+7/sqrt(2)))'])
event = ot.ThresholdEvent(ot.CompositeRandomVector(g, ot.RandomVector(ot.Normal(2))), ot.Less(), 0.0)
a = ot.ProbabilitySimulationAlgorithm(event, ot.MonteCarloExperiment())
a.setMaximumOuterSampling(400)
a.setBlockSize(10000)
a.setMaximumCoefficientOfVariation(0.005)
a.run()
p = a.getResult()
print(json.dumps({'p': p.getProbabilityEstimate(), 'deviation': p.getStandardDeviation()}))
]]
    local opts = {measures = {"g"}, constraints = {{name = "g", min = 0}},
      variables = {{name = "x", distribution = {"normal", mean = 0, deviation = 1}},
        {name = "y", distribution = {"normal", mean = 0, deviation = 1}}}}
    local function f(p)
      local x, y = p.x, p.y
      return math.min(3 + 0.1 * (x - y) ^ 2 - (x + y) / math.sqrt(2),
        3 + 0.1 * (x - y) ^ 2 + (x + y) / math.sqrt(2),
        x - y + 7 / math.sqrt(2), y - x + 7 / math.sqrt(2))
    end
    for _, design in ipairs {{"importance", starts = 24, error = 0.01, count = 50000}, {"subset", count = 5000}} do
      local sampled = run(design, opts, f)
      local deviation = math.sqrt(sampled.deviation ^ 2 + found.deviation ^ 2)
      assert.is_true(math.abs(sampled.probability - found.p) < 4 * deviation, sampled.text .. " " .. found.p)
    end
  end)
end)
