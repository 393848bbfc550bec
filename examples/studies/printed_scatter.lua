-- SPDX-License-Identifier: MIT
-- Study: uncertainty of a printed part.
--   build/barwright examples/studies/printed_scatter.lua [FOLDER] [--quick]
--
-- No two printed parts are alike: the three Young's moduli of printed gypsum were measured with a scatter.
-- A hundred parts are drawn from it. How much do the tip's sag, the first frequency and the stress vary, and
-- how many of the parts have a natural frequency below a limit?
local bw = require "barwright"
local quick = arg[#arg] == "--quick"
local folder = arg[1] ~= "--quick" and arg[1] or "out/printed_scatter" .. (quick and "_quick" or "")
local mm = 1e-3

local gypsum = bw.material.zp150
local function source_of(name)
  return assert(gypsum.sources[name], "no measured scatter for " .. name)
end

-- 1. A cantilever of 80 mm, made once.
local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {80 * mm, 12 * mm, 6 * mm},
  cells = {16, 3, 2}, order = 2})
local load = 2 -- N

-- Two independent normal numbers from two even ones (Box and Muller); the trial's own generator, so that
-- trial 17 is the same part wherever and whenever it runs.
local function normal(trial)
  return math.sqrt(-2 * math.log(1 - trial:random())) * math.cos(2 * math.pi * trial:random())
end

local results = assert(bw.results.open(folder, {script = arg[0], seed = 1}))
local count = quick and 10 or 200
local study = bw.study {
  name = "printed scatter", seed = 1,
  file = results:path(quick and "scatter_quick.study" or "scatter.study"),
  variables = {{name = "sample", kind = "integer", min = 1, max = count}},
  measures = {{name = "young_x", unit = "Pa"}, {name = "sag", unit = "m"}, {name = "frequency", unit = "Hz"},
    {name = "stress", unit = "Pa"}},
  design = {"grid"},
  run = function(_, trial)
    local young = {}
    for k, name in ipairs {"young_1", "young_2", "young_3"} do
      local source = source_of(name)
      young[k] = source.mean + source.scatter * normal(trial)
      if young[k] <= 0 then return nil, "a modulus below zero was drawn: too wide for a normal law" end
    end
    local drawn = bw.material.orthotropic {name = "drawn", young = young, poisson = gypsum.poisson,
      density = gypsum.density, strength = gypsum.strength}
    local part = bw.model {mesh = mesh, material = drawn}
    part:fix(mesh.boundary:below(1, 1e-9))
    local modes, message = part:modes {count = 1}
    if not modes then return nil, message end
    part:load {on = mesh.boundary:above(1, 80 * mm - 1e-9), force = {0, 0, -load}}
    local static = assert(part:solve())
    return {young_x = young[1], sag = -static.displacement:column(3):min(), frequency = modes.frequencies[1],
      stress = static.von_mises:max()}
  end,
}
local trials = assert(study:run())
print(trials)

-- 2. Quantiles.
local function quantiles(name, scale, unit)
  local values = trials:column(name)
  table.sort(values)
  local function at(fraction) return values[math.max(1, math.ceil(fraction * #values))] * scale end
  print(("%-10s 5 %%: %.4g, median %.4g, 95 %%: %.4g %s"):format(name, at(0.05), at(0.5), at(0.95), unit))
  return at(0.05), at(0.5), at(0.95)
end
local low, median, high = quantiles("sag", 1 / mm, "mm")
quantiles("frequency", 1, "Hz")
quantiles("stress", 1e-6, "MPa")

-- 3. A check that the sampling is sound: bending goes with 1 / E_x, so sag times E_x hardly varies.
local min, max = math.huge, 0
for _, trial in ipairs(trials) do
  local product = trial.results.sag * trial.results.young_x
  min, max = math.min(min, product), math.max(max, product)
end
assert(max / min < 1.1 and low < median and median < high)
assert(trials:plot("scatter_matrix"):write(results:path "scatter.svg"))
assert(trials:report(results:path "scatter.html"))
assert(results:write {parts = #trials, sag_5_percent_m = low * mm, sag_median_m = median * mm,
  sag_95_percent_m = high * mm})
