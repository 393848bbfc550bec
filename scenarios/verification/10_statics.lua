-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Static benchmarks with published or closed-form answers.
local bw = require "barwright"
local grids = require "grids"
local le11 = require "le11"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Statics",
  text = [[Solids of tetrahedra with ten nodes beside published and closed-form answers. ([How scenarios are
written](howto_scenarios.md). What is only true or false, rigid-body motions, symmetry, the same bits on any number
of threads, is in `tests/` and runs with `scripts/test`.)]]}

local pi, cos, sin, tan = math.pi, math.cos, math.sin, math.tan
local function elastic(young, poisson, density)
  return bw.material.isotropic {young = young, poisson = poisson, density = density}
end
local XX, YY, ZZ, ZX = 1, 2, 3, 5 -- columns of a stress: xx yy zz yz zx xy

scenario("MacNeal-Harder straight cantilever, tet10", function(t)
  local function solve(load)
    local mesh = bw.mesh.box {min = {0, -0.1, -0.05}, max = {6, 0.1, 0.05}, cells = {48, 5, 3}, order = 2}
    local part = bw.model {mesh = mesh, material = elastic(1e7, 0.3)}
    part:fix(mesh.boundary:below(1, 1e-9))
    load.on = mesh.boundary:above(1, 6 - 1e-9)
    part:load(load)
    return mesh, t:require(part:solve()).displacement
  end
  for axis, line in ipairs {{"tip displacement, extension", 3e-5},
    {"tip displacement, in-plane shear", 0.1081}, {"tip displacement, out-of-plane shear", 0.4321}} do
    local force = {0, 0, 0}
    force[axis] = 1
    local mesh, u = solve {force = force}
    expect(u(grids.nearest(mesh, {6, 0, 0}), axis), line[1])
      :near(line[2], {relative = 0.02, source = "MacNeal and Harder 1985"})
  end
  local mesh, u = solve {torque = {1, 0, 0}, about = {6, 0, 0}}
  local twist = (u(grids.nearest(mesh, {6, 0.1, 0}), 3) - u(grids.nearest(mesh, {6, -0.1, 0}), 3)) / 0.2
  expect(twist, "tip twist, unit torque"):near(0.0341, {relative = 0.02, source = "St Venant"})
end)

scenario("MacNeal-Harder twisted beam, tet10", function(t)
  local grid = grids.mapped({24, 4, 2}, 2, function(u, v, w)
    local y, z, a = 1.1 * (v - 0.5), 0.32 * (w - 0.5), pi / 2 * u
    return {12 * u, y * cos(a) - z * sin(a), y * sin(a) + z * cos(a)}
  end)
  for _, line in ipairs {{2, "tip, out of plane", 0.001754}, {3, "tip, in plane", 0.005424}} do
    local axis = line[1]
    local part = bw.model {mesh = grid.mesh, material = elastic(29e6, 0.22)}
    local force = {0, 0, 0}
    force[axis] = 1
    part:fix(grid:face(1, 0))
    part:load {on = grid:face(1, 1), force = force}
    local u = t:require(part:solve()).displacement
    expect(u(grid:node(1, 0.5, 0.5), axis), line[2])
      :near(line[3], {relative = 0.02, source = "MacNeal and Harder 1985"})
  end
end)

local function ellipses(thickness)
  return function(u, v, w)
    local a = pi / 2 * v
    return {(2 * (1 - u) + 3.25 * u) * cos(a), ((1 - u) + 2.75 * u) * sin(a), thickness * w}
  end
end

scenario("NAFEMS LE1, elliptic membrane, tet10", function(t)
  local grid = grids.mapped({16, 32, 1}, 2, ellipses(0.05))
  local part = bw.model {mesh = grid.mesh, material = elastic(210e9, 0.3)}
  part:slide(grid:face(2, 0), {0, 1, 0})
  part:slide(grid:face(2, 1), {1, 0, 0})
  part:slide(grid:face(3, 0), {0, 0, 1})
  part:load {on = grid:face(1, 1), pressure = -10e6}
  local static = t:require(part:solve())
  local d = grid:node(0, 0, 0)
  expect(static.stress(d, YY) / 1e6, "stress yy at D", "MPa")
    :near(92.7, {relative = 0.02, source = "NAFEMS LE1"})
  expect(static.displacement(d, 1) * 1e3, "displacement x at D", "mm")
    :near(-0.102208, {relative = 0.005, source = "own Q2 elements"})
end)

scenario("NAFEMS LE10, thick plate, tet10", function(t)
  local grid = grids.mapped({16, 22, 6}, 2, ellipses(0.6))
  local part = bw.model {mesh = grid.mesh, material = elastic(210e9, 0.3)}
  part:slide(grid:face(2, 0), {0, 1, 0})
  part:slide(grid:face(2, 1), {1, 0, 0})
  part:prescribe(grid:face(1, 1), {0, 0, false})
  part:prescribe(grid:where(function(u, _, w) return u > 1 - 1e-9 and math.abs(w - 0.5) < 1e-9 end),
    {false, false, 0})
  part:load {on = grid:face(3, 1), pressure = 1e6}
  local static = t:require(part:solve())
  expect(static.stress(grid:node(0, 0, 1), YY) / 1e6, "stress yy at D", "MPa")
    :near(-5.38, {relative = 0.02, source = "NAFEMS LE10"})
end)

scenario("NAFEMS LE11, cylinder, taper and sphere, thermal, tet10", function(t)
  local grid, part = le11 {16, 2, 48}
  local change = {}
  for i, p in ipairs(grid.mesh.nodes:totable()) do
    change[i] = math.sqrt(p[1] ^ 2 + p[2] ^ 2) + p[3]
  end
  part:temperature(bw.array.new(change))
  local static = t:require(part:solve())
  expect(static.stress(grid:node(0, 0, 0), ZZ) / 1e6, "stress zz at A", "MPa")
    :near(-105, {relative = 0.02, source = "NAFEMS LE11"})
end)

scenario("Lamé, thick cylinder in plane strain, tet10", function(t)
  local wedge = pi / 6
  local grid = grids.mapped({10, 6, 1}, 2, function(u, v, w)
    return {(1 + u) * cos(wedge * v), (1 + u) * sin(wedge * v), 0.1 * w}
  end)
  local part = bw.model {mesh = grid.mesh, material = elastic(1, 0.3)}
  part:slide(grid:face(2, 0), {0, 1, 0})
  part:slide(grid:face(2, 1), {-sin(wedge), cos(wedge), 0})
  part:slide(grid:face(3, 0), {0, 0, 1})
  part:slide(grid:face(3, 1), {0, 0, 1})
  part:load {on = grid:face(1, 0), pressure = 1}
  local static = t:require(part:solve())
  local a, b = grid:node(0, 0, 0), grid:node(1, 0, 0)
  expect(static.stress(a, YY), "hoop stress at the bore / p"):near(5 / 3, {relative = 0.01, source = "Lamé"})
  expect(static.displacement(a, 1), "radial displacement at the bore")
    :near(1.906666666666667, {relative = 0.005, source = "Lamé"})
  expect(static.displacement(b, 1), "radial displacement outside")
    :near(1.2133333333333334, {relative = 0.005, source = "Lamé"})
end)

-- A solid angle about the x axis: lateral faces are planes through the origin.
local function cone(inner, outer, half)
  return function(u, v, w)
    local y, z = tan(half * (2 * v - 1)), tan(half * (2 * w - 1))
    local r = (inner + (outer - inner) * u) / math.sqrt(1 + y * y + z * z)
    return {r, r * y, r * z}
  end
end
local function hold_cone(part, grid, half)
  part:slide(grid:face(2, 0), {sin(half), cos(half), 0})
  part:slide(grid:face(2, 1), {-sin(half), cos(half), 0})
  part:slide(grid:face(3, 0), {sin(half), 0, cos(half)})
  part:slide(grid:face(3, 1), {-sin(half), 0, cos(half)})
end

scenario("Lamé, hollow sphere, tet10", function(t)
  local half = pi / 12
  local grid = grids.mapped({10, 4, 4}, 2, cone(1, 2, half))
  local part = bw.model {mesh = grid.mesh, material = elastic(1, 0.3)}
  hold_cone(part, grid, half)
  part:load {on = grid:face(1, 0), pressure = 1}
  local static = t:require(part:solve())
  expect(static.stress(grid:node(0, 0.5, 0.5), YY), "hoop stress inside / p")
    :near(5 / 7, {relative = 0.01, source = "Lamé"})
end)

scenario("Goodier, spherical cavity under tension, tet10", function(t)
  local size = 10
  local function patch(shift)
    return function(u, v, w)
      local d = {1, tan(pi / 4 * v), tan(pi / 4 * w)}
      local length = math.sqrt(1 + d[2] ^ 2 + d[3] ^ 2)
      local fraction = (size ^ u - 1) / (size - 1) -- finer towards the cavity
      local r = (1 - fraction) / length + fraction * size
      local x = {}
      for k = 1, 3 do x[(k - 1 + shift) % 3 + 1] = r * d[k] end
      return x
    end
  end
  local grid = grids.patches({16, 9, 9}, 2, {patch(0), patch(1), patch(2)})
  local mesh = grid.mesh
  local part = bw.model {mesh = mesh, material = elastic(1, 0.3)}
  for axis = 1, 3 do
    local normal = {0, 0, 0}
    normal[axis] = 1
    part:slide(mesh.boundary:below(axis, 1e-7), normal)
  end
  part:load {on = mesh.boundary:above(3, size - 1e-7), traction = {0, 0, 1}}
  local static = t:require(part:solve())
  expect(static.stress(grids.nearest(mesh, {1, 0, 0}), ZZ), "largest stress / tension")
    :near((27 - 15 * 0.3) / (2 * (7 - 5 * 0.3)), {relative = 0.02, source = "Goodier 1933"})
end)

scenario("Kirsch, hole in a wide plate, tet10", function(t)
  local size = 30
  local grid = grids.mapped({32, 28, 1}, 2, function(u, v, w)
    local a = pi / 2 * v
    local reach = size / math.max(cos(a), sin(a))
    local fraction = (size ^ u - 1) / (size - 1)
    local r = (1 - fraction) + fraction * reach
    return {r * cos(a), r * sin(a), 0.2 * w}
  end)
  local mesh = grid.mesh
  local part = bw.model {mesh = mesh, material = elastic(1, 0.3)}
  part:slide(grid:face(2, 0), {0, 1, 0})
  part:slide(grid:face(2, 1), {1, 0, 0})
  part:slide(grid:face(3, 0), {0, 0, 1})
  part:load {on = mesh.boundary:above(1, size - 1e-7), traction = {1, 0, 0}}
  local static = t:require(part:solve())
  expect(static.stress(grid:node(0, 1, 0), XX), "stress across the load / tension")
    :near(3, {relative = 0.03, source = "Kirsch 1898"})
  expect(static.stress(grid:node(0, 0, 0), YY), "stress along the load / tension")
    :near(-1, {relative = 0.03, source = "Kirsch 1898"})
end)

scenario("St Venant torsion of a square bar, tet10", function(t)
  local mesh = bw.mesh.box {min = {0, -0.5, -0.5}, max = {6, 0.5, 0.5}, cells = {30, 8, 8}, order = 2}
  local part = bw.model {mesh = mesh, material = elastic(2.6, 0.3)} -- G = 1
  part:load {on = mesh.boundary:below(1, 1e-9), torque = {-1, 0, 0}, about = {0, 0, 0}}
  part:load {on = mesh.boundary:above(1, 6 - 1e-9), torque = {1, 0, 0}, about = {6, 0, 0}}
  local static = t:require(part:solve())
  local function angle(x)
    local u = static.displacement
    return u(grids.nearest(mesh, {x, 0.5, 0}), 3) - u(grids.nearest(mesh, {x, -0.5, 0}), 3)
  end
  local rate = (angle(4) - angle(2)) / 2
  local side = grids.nearest(mesh, {3, 0.5, 0})
  expect(1 / rate, "torsion constant / a^4"):near(0.140577, {relative = 0.01, source = "St Venant"})
  expect(static.stress(side, ZX), "largest shear stress x a^3 / T")
    :near(4.80385, {relative = 0.01, source = "St Venant"})
end)

scenario("square Kirchhoff plates under uniform load, tet10", function(t)
  local thickness = 0.01
  local D = 1 * thickness ^ 3 / (12 * (1 - 0.3 ^ 2))
  for _, line in ipairs {{"simply supported", 0.00406235}, {"clamped", 0.00126532}} do
    local mesh = bw.mesh.box {min = {0, 0, 0}, max = {0.5, 0.5, thickness}, cells = {32, 32, 1}, order = 2}
    local part = bw.model {mesh = mesh, material = elastic(1, 0.3)}
    part:slide(mesh.boundary:above(1, 0.5 - 1e-9), {1, 0, 0})
    part:slide(mesh.boundary:above(2, 0.5 - 1e-9), {0, 1, 0})
    if line[1] == "clamped" then
      part:fix(mesh.boundary:below(1, 1e-9) | mesh.boundary:below(2, 1e-9))
    else
      part:prescribe(mesh.boundary:below(1, 1e-9), {false, 0, 0})
      part:prescribe(mesh.boundary:below(2, 1e-9), {0, false, 0})
    end
    part:load {on = mesh.boundary:above(3, thickness - 1e-9), pressure = 1e-9}
    local u = t:require(part:solve()).displacement
    local centre = -u(grids.nearest(mesh, {0.5, 0.5, 0}), 3)
    expect(centre * D / 1e-9, line[1] .. ": centre deflection x D / (q a^4)")
      :near(line[2], {relative = 0.01, source = "Timoshenko; tolerance 1 % for the thickness"})
  end
end)

scenario("bar under its own weight", function(t)
  local mesh = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.1, 2}, cells = {2, 2, 20}, order = 2}
  local part = bw.model {mesh = mesh, material = elastic(1e9, 0, 1000)}
  part:slide(mesh.boundary:above(3, 2 - 1e-9), {0, 0, 1})
  part:fix(mesh.boundary:nearest({0, 0, 2}, 1))
  part:slide(mesh.boundary:nearest({0.1, 0, 2}, 1), {0, 1, 0})
  part:gravity {0, 0, -9.81}
  local u = t:require(part:solve()).displacement
  expect(-u(grids.nearest(mesh, {0, 0, 0}), 3), "tip displacement")
    :near(1000 * 9.81 * 4 / (2 * 1e9), {relative = 1e-9, source = "rho g L^2 / 2E, exact for no Poisson effect"})
end)
