-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes docs/images/plots.png: what a study of cantilevers looks like. The deflection and the stress are
-- those of a slender beam under an end load, so that the picture takes no time.
local bw = require "barwright"
local script = require "barwright.command.script"
local root = arg[0]:match "^(.*)/scripts/" or "."

local opts = script.read {
  summary = "docs/images/plots.png: what a study of cantilevers looks like",
  arguments = {{name = "out", type = "file", endings = {"png"}, optional = true, what = "another file"}},
}

local length, load, allowed = 0.1, 20, 60e6
local materials = {{"pla", bw.material.pla}, {"resin", bw.material.resin}}

-- Points that fill the square evenly: multiples of two irrational numbers.
local width, height, kind, mass, stress, bend, fits = {}, {}, {}, {}, {}, {}, {}
for i = 1, 90 do
  local u, v = i * 0.7548776662 % 1, i * 0.5698402910 % 1
  local material = materials[i % 2 + 1]
  local b, h = 4e-3 + 12e-3 * u, 3e-3 + 9e-3 * v
  width[i], height[i], kind[i] = b, h, material[1]
  mass[i] = material[2].density * b * h * length
  stress[i] = 6 * load * length / (b * h ^ 2)
  bend[i] = 4 * load * length ^ 3 / (material[2].young * b * h ^ 3)
  fits[i] = stress[i] <= allowed
end
local mass_column = {name = "mass", unit = "kg", values = mass, goal = "min"}
local bend_column = {name = "deflection", unit = "m", values = bend, goal = "min", scale = "log"}

-- The integral of exp from 0 to 1 by the trapezoidal rule and by Simpson's.
local sizes, errors = {}, {{}, {}}
for i, n in ipairs {2, 4, 8, 16, 32} do
  local h, sums = 1 / n, {0, 0}
  for k = 1, n do
    local a, m, b = math.exp((k - 1) * h), math.exp((k - 0.5) * h), math.exp(k * h)
    sums[1], sums[2] = sums[1] + h * (a + b) / 2, sums[2] + h * (a + 4 * m + b) / 6
  end
  sizes[i] = h
  for rule = 1, 2 do errors[rule][i] = math.abs(sums[rule] - (math.exp(1) - 1)) end
end

local figures = {
  bw.plot.pareto {title = "Front of mass and deflection", objectives = {mass_column, bend_column},
    feasible = fits},
  bw.plot.history {title = "Lightest beam that holds", values = mass, feasible = fits, label = "mass",
    unit = "kg"},
  bw.plot.parallel_coordinates {title = "Every trial over its variables", columns = {
    {name = "width", unit = "m", values = width}, {name = "height", unit = "m", values = height},
    {name = "material", values = kind}, {name = "stress", unit = "Pa", values = stress, scale = "log"},
    bend_column}, values = mass, value = {label = "mass", unit = "kg"},
    faint = (function()
      local out = {}
      for i, good in ipairs(fits) do out[i] = not good end
      return out
    end)()},
  bw.plot.convergence {title = "Two rules for an integral", x = {label = "step"}, y = {label = "error"},
    series = {{name = "trapezoids", x = sizes, y = errors[1]}, {name = "Simpson", x = sizes, y = errors[2]}}},
}
local pictures = {}
for i, figure in ipairs(figures) do pictures[i] = {figure = figure} end
local sheet = bw.plot.contact_sheet {pictures = pictures, columns = 2, cell = 540, lines = 0}
assert(sheet:write(opts.out or root .. "/docs/images/plots.png", {scale = 1.1}))
