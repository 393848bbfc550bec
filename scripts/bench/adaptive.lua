-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Convergence with error control: benchmarks solved to 1 % by adaptive refinement, beside uniform refinement of
-- the same first mesh.
local folder = arg[0]:match "^(.*)/scripts/bench/" or "."
package.path = folder .. "/scenarios/verification/lib/?.lua;" .. folder .. "/scripts/bench/?.lua;" .. package.path
local bw = require "barwright"
local grids = require "grids"
local le11 = require "le11"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "adaptive refinement to an error beside uniform refinement of the same first mesh",
  about = "Prints a Markdown table. The reference is the exact value where there is one, else the value of an "
    .. "adaptive run to a tenth of the error. Uniform refinement bisects every element once, so that the number "
    .. "doubles, until the error of the value is within the one asked for on that mesh and all later ones, or "
    .. "--max unknowns are reached (\"> N\" then).",
  options = {
    {name = "case", value = "TEXT", what = "only cases whose name contains this text"},
    {name = "error", value = "RATIO", type = "number", default = 0.01, above = 0, below = 1,
      what = "relative error of the value that is asked for"},
    {name = "max", value = "N", type = "integer", default = 300000, min = 1,
      what = "largest number of unknowns of uniform refinement"},
    script.option.out,
  },
}

local pi, cos, sin, tan, sqrt = math.pi, math.cos, math.sin, math.tan, math.sqrt

local function elastic(young, poisson)
  return bw.material.isotropic {young = young, poisson = poisson}
end

local function hold_plane_strain(part, grid)
  part:slide(grid:face(3, 0), {0, 0, 1}):slide(grid:face(3, 1), {0, 0, 1})
end

-- Each case gives a model, what is asked of it, the exact value where it is known, and the published one.
local cases, order = {}, {}
local function case(name, make)
  cases[name] = make
  order[#order + 1] = name
end

-- The field of the first symmetric mode at a re-entrant corner of 90 degrees, plane strain, for a stress intensity
-- of 1: u = r^l / (2 G) (...) with l and q of Szabo and Babuska. The bisector of the solid is the x axis.
local LAMBDA, Q = 0.54448373678246, 0.5430755788367
local function corner_displacement(x, y, shear, poisson)
  local r, t, kappa = sqrt(x * x + y * y), math.atan(y, x), 3 - 4 * poisson
  if r == 0 then return 0, 0 end
  local f = r ^ LAMBDA / (2 * shear)
  return f * ((kappa - Q * (LAMBDA + 1)) * cos(LAMBDA * t) - LAMBDA * cos((LAMBDA - 2) * t)),
    f * ((kappa + Q * (LAMBDA + 1)) * sin(LAMBDA * t) + LAMBDA * sin((LAMBDA - 2) * t))
end

-- The stress along the bisector across it, from the derivatives of the field above.
local function corner_stress(r, shear, poisson)
  local h = 1e-5 * r
  local function d(dx, dy)
    local a, b = corner_displacement(r + dx, dy, shear, poisson)
    local c, e = corner_displacement(r - dx, -dy, shear, poisson)
    return (a - c) / (2 * h), (b - e) / (2 * h)
  end
  local xx, yy = (d(h, 0)), select(2, d(0, h))
  return 2 * shear * (yy + poisson / (1 - 2 * poisson) * (xx + yy))
end

case("L-domain, stress 0.05 from the edge", function()
  local s, young, poisson, r = sqrt(0.5), 1, 0.3, 0.05
  local shear = young / (2 * (1 + poisson))
  local maps = {} -- three squares around the corner, with (a, b) along their sides, rotated by 45 degrees
  for i, low in ipairs {{0, 0}, {-1, 0}, {0, -1}} do
    maps[i] = function(u, v, w)
      local a, b = low[1] + u, low[2] + v
      return {s * (a + b), s * (b - a), 0.1 * w}
    end
  end
  local grid = grids.patches({5, 5, 1}, 2, maps)
  local mesh = grid.mesh
  local part = bw.model {mesh = mesh, material = elastic(young, poisson)}
  local field = {}
  for i, p in ipairs(mesh.nodes:totable()) do
    local ux, uy = corner_displacement(p[1], p[2], shear, poisson)
    field[i] = {ux, uy, 0}
  end
  local far = 1 - 1e-9
  part:prescribe(mesh.boundary:where(function(x, y)
    local a, b = s * (x - y), s * (x + y)
    return math.abs(a) > far or math.abs(b) > far
  end), bw.array.new(field))
  part:slide(mesh.boundary:below(3, 1e-9), {0, 0, 1}):slide(mesh.boundary:above(3, 0.1 - 1e-9), {0, 0, 1})
  return part, {at = {r, 0, 0}, field = "yy"}, corner_stress(r, shear, poisson)
end)

local function ellipses(thickness)
  return function(u, v, w)
    local a = pi / 2 * v
    return {(2 * (1 - u) + 3.25 * u) * cos(a), ((1 - u) + 2.75 * u) * sin(a), thickness * w}
  end
end

case("NAFEMS LE1", function()
  local grid = grids.mapped({2, 8, 1}, 2, ellipses(0.05))
  local part = bw.model {mesh = grid.mesh, material = elastic(210e9, 0.3)}
  part:slide(grid:face(2, 0), {0, 1, 0}):slide(grid:face(2, 1), {1, 0, 0}):slide(grid:face(3, 0), {0, 0, 1})
  part:load {on = grid:face(1, 1), pressure = -10e6}
  return part, {at = {2, 0, 0}, field = "yy"}, nil, 92.7e6
end)

case("NAFEMS LE10", function()
  local grid = grids.mapped({2, 8, 2}, 2, ellipses(0.6))
  local part = bw.model {mesh = grid.mesh, material = elastic(210e9, 0.3)}
  part:slide(grid:face(2, 0), {0, 1, 0}):slide(grid:face(2, 1), {1, 0, 0})
  part:prescribe(grid:face(1, 1), {0, 0, false})
  part:prescribe(grid:where(function(u, _, w) return u > 1 - 1e-9 and math.abs(w - 0.5) < 1e-9 end),
    {false, false, 0})
  part:load {on = grid:face(3, 1), pressure = 1e6}
  return part, {at = {2, 0, 0.6}, field = "yy"}, nil, -5.38e6
end)

case("NAFEMS LE11", function()
  local grid, part = le11 {2, 1, 12}
  local change = {}
  for i, p in ipairs(grid.mesh.nodes:totable()) do change[i] = sqrt(p[1] ^ 2 + p[2] ^ 2) + p[3] end
  part:temperature(bw.array.new(change), 2.3e-4)
  return part, {at = {1, 0, 0}, field = "zz"}, nil, -105e6
end)

case("Kirsch hole", function()
  local size = 100
  local grid = grids.mapped({5, 6, 1}, 2, function(u, v, w)
    local a = pi / 2 * v
    local reach = size / math.max(cos(a), sin(a))
    local fraction = (size ^ u - 1) / (size - 1)
    local r = (1 - fraction) + fraction * reach
    return {r * cos(a), r * sin(a), w}
  end)
  local part = bw.model {mesh = grid.mesh, material = elastic(1, 0.3)}
  part:slide(grid:face(2, 0), {0, 1, 0}):slide(grid:face(2, 1), {1, 0, 0})
  hold_plane_strain(part, grid)
  part:load {on = grid.mesh.boundary:above(1, size - 1e-7), traction = {1, 0, 0}}
  return part, {at = {0, 1, 0}, field = "xx"}, 3, 3
end)

-- A stepped bar of height 3 and 2 with fillets of radius 0.2 in tension: Peterson's chart, a fit to photoelastic
-- tests (Pilkey, stepped flat tension bar, 2 <= t / r <= 20), t = (D - d) / 2. One half, in plane strain. The fit
-- is 3 % lower than the factor (docs/benchmarks.md).
local function peterson(D, d, r)
  local t = (D - d) / 2
  local q, s, x = t / r, sqrt(t / r), 2 * t / D
  return 1.020 + 1.009 * s - 0.048 * q + (-0.065 - 0.165 * s - 0.007 * q) * x
    + (-3.459 + 1.266 * s - 0.016 * q) * x ^ 2 + (3.505 - 2.109 * s + 0.069 * q) * x ^ 3
end

case("fillet of a stepped bar", function()
  local H, h, r, length = 1.5, 1, 0.2, 4
  -- the upper outline and the places below it, by arc parameter
  local stops = {{0, -length, H, -length}, {4, 0, H, -0.9}, {6, 0, h + r, -0.45}, {12, r, h, 0.5},
    {16, length, h, length}}
  local function between(s)
    for i = 2, #stops do
      local a, b = stops[i - 1], stops[i]
      if s <= b[1] + 1e-9 then
        local t = (s - a[1]) / (b[1] - a[1])
        local x, y = a[2] + t * (b[2] - a[2]), a[3] + t * (b[3] - a[3])
        if i == 4 then x, y = r - r * cos(pi / 2 * t), h + r - r * sin(pi / 2 * t) end
        if i == 5 then
          local along = (8 ^ t - 1) / 7
          x = a[2] + along * (b[2] - a[2])
          return x, y, a[4] + along * (b[4] - a[4])
        end
        return x, y, a[4] + t * (b[4] - a[4])
      end
    end
  end
  local grid = grids.mapped({16, 2, 1}, 2, function(u, v, w)
    local x, y, below = between(16 * u)
    return {below + v * (x - below), v * y, 0.1 * w}
  end)
  local part = bw.model {mesh = grid.mesh, material = elastic(1, 0.3)}
  part:slide(grid:face(2, 0), {0, 1, 0}):slide(grid:face(1, 0), {1, 0, 0})
  hold_plane_strain(part, grid)
  part:load {on = grid:face(1, 1), traction = {1, 0, 0}}
  return part, "max_principal", nil, peterson(2 * H, 2 * h, r)
end)

case("spherical cavity", function()
  local size = 20
  local function patch(shift)
    return function(u, v, w)
      local d = {1, tan(pi / 4 * v), tan(pi / 4 * w)}
      local length = sqrt(1 + d[2] ^ 2 + d[3] ^ 2)
      local fraction = (size ^ u - 1) / (size - 1)
      local x = {}
      for k = 1, 3 do x[(k - 1 + shift) % 3 + 1] = ((1 - fraction) / length + fraction * size) * d[k] end
      return x
    end
  end
  local mesh = grids.patches({4, 2, 2}, 2, {patch(0), patch(1), patch(2)}).mesh
  local part = bw.model {mesh = mesh, material = elastic(1, 0.3)}
  for axis = 1, 3 do
    local normal = {0, 0, 0}
    normal[axis] = 1
    part:slide(mesh.boundary:below(axis, 1e-7), normal)
  end
  part:load {on = mesh.boundary:above(3, size - 1e-7), traction = {0, 0, 1}}
  local exact = (27 - 15 * 0.3) / (2 * (7 - 5 * 0.3))
  return part, {at = {1, 0, 0}, field = "zz"}, exact, exact
end)

-- ---- measuring -------------------------------------------------------------------------------------

local tolerance, max = opts.error, opts.max

local components = {xx = 1, yy = 2, zz = 3}

-- The value on one mesh, and its unknowns: nodal stresses, as the adaptive runs measure them.
local function value_on(part, of)
  local static <close> = assert(part:solve {})
  local unknowns = 3 * part.mesh.node_count
  if of == "max_principal" then return static.max_principal:max(), unknowns end
  return part.mesh:sample(static.stress, {of.at})(1, components[of.field]), unknowns
end

-- Unknowns of the first of the meshes, each twice as fine, from which on the value is within the tolerance.
local function uniform(part, of, reference)
  local first, unknowns, last
  while true do
    local value
    value, unknowns = value_on(part, of)
    last = math.abs(value / reference - 1)
    first = last <= tolerance and (first or unknowns) or nil
    if unknowns * 2 > max then return first, unknowns, last end
    local levels = {}
    for e = 1, part.mesh.element_count do levels[e] = 1 end
    part = assert(part:refined(bw.array.new(levels)))
  end
end

local function measure(name)
  local part, of, exact, published = cases[name]()
  local start = bw.seconds()
  local _, accuracy = assert(part:solve {error = tolerance, of = of})
  local seconds = bw.seconds() - start
  local reference = exact
  if not reference then
    local _, finest = assert(part:solve {error = tolerance / 10, of = of, max_elements = 60000})
    reference = finest.value
  end
  local first, reached, left = uniform(part, of, reference)
  local rows = bw.json.list {}
  for i, row in ipairs(accuracy.history) do
    rows[i] = {elements = row.elements, unknowns = row.unknowns, value = row.value,
      estimated_error = row.estimated_error, error = math.abs(row.value / reference - 1)}
  end
  local last = rows[#rows]
  return {case = name, reference = reference, exact = exact ~= nil, published = published, value = accuracy.value,
    estimated_error = accuracy.estimated_error, error = last.error, converged = accuracy.converged,
    reason = accuracy.reason, unknowns = last.unknowns, seconds = seconds, uniform_unknowns = first,
    uniform_reached = reached, uniform_error = left, steps = rows}
end

print("| case | reference | value | error | estimated | unknowns | uniform | ratio "
  .. "| steps: estimated / true error |")
print "|---|---|---|---|---|---|---|---|---|"
local all = bw.json.list {}
for _, name in ipairs(order) do
  if not opts.case or name:find(opts.case, 1, true) then
    local m = measure(name)
    all[#all + 1] = m
    local steps = {}
    for i, row in ipairs(m.steps) do
      steps[i] = ("%.2g"):format(row.estimated_error / math.max(row.error, 1e-12))
    end
    local reached = m.uniform_unknowns
    print(("| %s | %.6g%s | %.6g | %.2f %% | %.2f %% | %d | %s%d | %s%.2f | %s |"):format(name, m.reference,
      m.exact and " (exact)" or "", m.value, 100 * m.error, 100 * m.estimated_error, m.unknowns,
      reached and "" or "> ", reached or m.uniform_reached, reached and "" or "< ",
      m.unknowns / (reached or m.uniform_reached), table.concat(steps, ", ")))
  end
end
if opts.out then
  local results = assert(bw.results.open(opts.out, {options = {error = tolerance, max = max}}))
  assert(results:write {cases = all})
end
