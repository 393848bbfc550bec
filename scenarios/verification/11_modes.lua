-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Natural frequencies with published or closed-form answers, for solids of tet10.
local bw = require "barwright"
local grids = require "grids"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Natural frequencies",
  text = [[Solids of tetrahedra with ten nodes beside published and closed-form frequencies.]]}

local pi, cos, sin, tan = math.pi, math.cos, math.sin, math.tan
local steel = {young = 200e9, poisson = 0.3, density = 8000}
local function nafems() return bw.material.isotropic(steel) end

local function compare(modes, first, references, tolerance, source)
  for i, reference in ipairs(references) do
    expect(modes.frequencies[i], ("mode %d"):format(first + i - 1), "Hz")
      :near(reference, {relative = tolerance, source = source})
  end
end

scenario("free-free slender bar", function(t)
  local L, h = 1, 0.01
  local mesh = bw.mesh.box {min = {0, 0, 0}, max = {L, 1.5 * h, h}, cells = {60, 1, 1}, order = 2}
  local part = bw.model {mesh = mesh, material = nafems()}
  local modes = t:require(part:modes {count = 4})
  -- Bending about the two axes alternates: sides h and 1.5 h.
  local function beam(beta, side)
    return beta ^ 2 / (2 * pi * L ^ 2) * math.sqrt(200e9 / 8000 * side ^ 2 / 12)
  end
  compare(modes, 1, {beam(4.730040744862704, h), beam(4.730040744862704, 1.5 * h),
    beam(7.853204624095838, h), beam(7.853204624095838, 1.5 * h)}, 0.01, "Euler-Bernoulli (Blevins)")
end)

scenario("cantilever bar", function(t)
  local L, h = 1, 0.01
  local mesh = bw.mesh.box {min = {0, 0, 0}, max = {L, 1.5 * h, h}, cells = {60, 1, 1}, order = 2}
  local part = bw.model {mesh = mesh, material = nafems()}
  part:fix(mesh.boundary:below(1, 1e-9))
  local modes = t:require(part:modes {count = 4})
  local function beam(beta, side)
    return beta ^ 2 / (2 * pi * L ^ 2) * math.sqrt(200e9 / 8000 * side ^ 2 / 12)
  end
  compare(modes, 1, {beam(1.875104068711961, h), beam(1.875104068711961, 1.5 * h),
    beam(4.694091132974175, h), beam(4.694091132974175, 1.5 * h)}, 0.01, "Euler-Bernoulli")
end)

-- The plates of NAFEMS and Leissa: h/a = 1/200 is thin enough for Kirchhoff's theory.
local function plate(cells, clamped, count)
  local mesh = bw.mesh.box {min = {0, 0, 0}, max = {10, 10, 0.05}, cells = {cells, cells, 1}, order = 2}
  local part = bw.model {mesh = mesh, material = nafems()}
  if clamped then part:fix(mesh.boundary:below(1, 1e-9)) end
  return assert(part:modes {count = count})
end

scenario("NAFEMS FV12, free thin square plate", function()
  compare(plate(28, false, 6), 4, {1.622, 2.360, 2.922, 4.233, 4.233, 7.416}, 0.015, "NAFEMS FV12")
end)

scenario("NAFEMS FV16, cantilevered thin square plate", function()
  compare(plate(28, true, 6), 1, {0.421, 1.029, 2.582, 3.306, 3.753, 6.555}, 0.02, "NAFEMS FV16")
end)

scenario("Leissa, free square plate", function()
  local modes = plate(28, false, 5)
  local D = 200e9 * 0.05 ^ 3 / (12 * (1 - 0.3 ^ 2))
  for i, lambda in ipairs {13.489, 19.789, 24.432, 35.024, 35.024} do
    local omega = 2 * pi * modes.frequencies[i]
    expect(omega * 100 * math.sqrt(8000 * 0.05 / D), ("lambda_%d"):format(i))
      :near(lambda, {relative = 0.015, source = "Leissa; tolerance 1.5 % for the mesh"})
  end
end)

scenario("NAFEMS FV32, cantilevered tapered membrane", function(t)
  -- Half the thickness above the plane of symmetry: in-plane modes only.
  local grid = grids.mapped({24, 12, 1}, 2, function(u, v, w)
    return {10 * u, (v - 0.5) * (5 - 4 * u), 0.025 * w}
  end)
  local part = bw.model {mesh = grid.mesh, material = nafems()}
  part:prescribe(grid:face(1, 0), {0, 0, false})
  part:slide(grid:face(3, 0), {0, 0, 1})
  compare(t:require(part:modes {count = 6}), 1, {44.623, 130.03, 162.70, 246.05, 379.90, 391.44},
    0.005, "NAFEMS FV32")
end)

scenario("NAFEMS FV41, free cylinder, axisymmetric modes", function(t)
  local wedge = pi / 36
  local grid = grids.mapped({4, 1, 40}, 2, function(u, v, w)
    local r = 1.8 + 0.4 * u
    return {r * cos(wedge * v), r * sin(wedge * v), 10 * w}
  end)
  local part = bw.model {mesh = grid.mesh, material = nafems()}
  part:slide(grid:face(2, 0), {0, 1, 0})
  part:slide(grid:face(2, 1), {-sin(wedge), cos(wedge), 0})
  compare(t:require(part:modes {count = 5}), 2, {243.53, 377.41, 394.11, 397.72, 405.28}, 0.005,
    "NAFEMS FV41; mode 1 is the rigid-body motion along the axis")
end)

scenario("NAFEMS FV42, thick hollow sphere, radial modes", function(t)
  local half = pi / 120
  local grid = grids.mapped({40, 1, 1}, 2, function(u, v, w)
    local y, z = tan(half * (2 * v - 1)), tan(half * (2 * w - 1))
    local r = (1.8 + 4.2 * u) / math.sqrt(1 + y * y + z * z)
    return {r, r * y, r * z}
  end)
  local part = bw.model {mesh = grid.mesh, material = nafems()}
  part:slide(grid:face(2, 0), {sin(half), cos(half), 0})
  part:slide(grid:face(2, 1), {-sin(half), cos(half), 0})
  part:slide(grid:face(3, 0), {sin(half), 0, cos(half)})
  part:slide(grid:face(3, 1), {-sin(half), 0, cos(half)})
  compare(t:require(part:modes {count = 5}), 1, {369.91, 838.03, 1451.2, 2117.0, 2795.8}, 0.005,
    "NAFEMS FV42")
end)

scenario("NAFEMS FV52, simply supported thick plate, the mode in the plane", function(t)
  local mesh = bw.mesh.box {min = {0, 0, -0.5}, max = {10, 10, 0.5}, cells = {12, 12, 2}, order = 2}
  local part = bw.model {mesh = mesh, material = nafems()}
  part:prescribe(mesh.boundary:where(function(x, y, z)
    return z < -0.5 + 1e-9 and (x < 1e-9 or y < 1e-9 or x > 10 - 1e-9 or y > 10 - 1e-9)
  end), {false, false, 0})
  local modes = t:require(part:modes {count = 8})
  local nearest = modes.frequencies[1]
  for i = 2, modes.count do
    if math.abs(modes.frequencies[i] - 193.59) < math.abs(nearest - 193.59) then
      nearest = modes.frequencies[i]
    end
  end
  expect(nearest, "mode 8 (independent of how the edge is fixed)", "Hz")
    :near(193.59, {relative = 0.005, source = "NAFEMS FV52"})
end)
