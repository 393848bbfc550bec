-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Sectors of cyclic symmetry, beside closed forms of rings and beside the whole wheel.
local bw = require "barwright"
local grids = require "grids"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Cyclic symmetry",
  text = [[One sector of a wheel, of tetrahedra with ten nodes, beside closed forms and beside the whole wheel
([theory](theory/symmetry.md)).]]}

local pi, cos, sin, sqrt = math.pi, math.cos, math.sin, math.sqrt

-- A ring sector of n with radii a and b and height h; its edges are curved.
local function ring(n, cells, a, b, h, material)
  local grid = grids.mapped(cells, 2, function(u, v, w)
    local r, angle = a + (b - a) * u, 2 * pi / n * v
    return {r * cos(angle), r * sin(angle), h * w}
  end)
  local part = bw.model {mesh = grid.mesh, material = material}
  assert(part:cyclic {low = grid:face(2, 0), high = grid:face(2, 1), count = n})
  return part, grid
end

scenario("Lame, ring under internal pressure, one sector of 12", function(t)
  local a, b, h, p, young, poisson = 0.1, 0.2, 0.02, 50e6, 210e9, 0.3
  local part, grid = ring(12, {8, 4, 1}, a, b, h, bw.material.isotropic {young = young, poisson = poisson})
  part:symmetry(grid:face(3, 0))
  local middle = pi / 12 -- the load balances: one place holds the rotation about the axis
  local point = {b * cos(middle), b * sin(middle), 0}
  part:slide(grid.mesh.boundary:nearest(point, 1), {-sin(middle), cos(middle), 0})
  part:load {on = grid:face(1, 0), pressure = p}
  local static = t:require(part:solve())
  local inner = grid:node(0, 0, 1)
  expect(static.displacement(inner, 1), "radial displacement of the bore", "m")
    :near(p * a / young * ((b * b + a * a) / (b * b - a * a) + poisson), {relative = 2e-4, source = "Lame"})
  local whole = t:require(static:whole())
  expect(whole.max_principal:max(), "hoop stress at the bore", "Pa")
    :near(p * (b * b + a * a) / (b * b - a * a), {relative = 0.01, source = "Lame"})
  expect(whole.energy, "strain energy of the ring", "J")
    :near(0.5 * p * 2 * pi * a * h * p * a / young * ((b * b + a * a) / (b * b - a * a) + poisson),
      {relative = 2e-4, source = "Lame"})
end)

-- Love's thin ring: in its plane omega^2 = E I / (rho A R^4) d^2 (d^2 - 1)^2 / (d^2 + 1); out of it with
-- d^2 + E I / (G J) below. A square section has J = 0.1406 h^4.
scenario("Love, free thin ring, nodal diameters 2 to 4, one sector of 16", function(t)
  local radius, h, young, poisson, density = 0.1, 2e-3, 210e9, 0.3, 7800
  local n = 16
  local part = ring(n, {3, 6, 3}, radius - h / 2, radius + h / 2, h,
    bw.material.isotropic {young = young, poisson = poisson, density = density})
  local free = t:require(part:modes {count = 1})
  expect(free.rigid_count, "rigid-body modes left out"):near(6, {absolute = 0, source = "rigid-body motions"})
  local unit = young * h ^ 4 / 12 / (density * h ^ 2 * radius ^ 4)
  local twist = 2 * (1 + poisson) / (12 * 0.1406)
  for d = 2, 4 do
    local modes = t:require(part:modes {count = 4, nodal_diameter = d})
    local bending = unit * d ^ 2 * (d ^ 2 - 1) ^ 2
    local inside, outside = sqrt(bending / (d ^ 2 + 1)) / (2 * pi), sqrt(bending / (d ^ 2 + twist)) / (2 * pi)
    expect(modes.frequencies[1], ("%d nodal diameters, out of the plane"):format(d), "Hz")
      :near(outside, {relative = 0.01, source = "Love"})
    expect(modes.frequencies[2] / modes.frequencies[1] - 1, ("%d nodal diameters, pair"):format(d))
      :near(0, {absolute = 1e-8, source = "symmetry"})
    expect(modes.frequencies[3], ("%d nodal diameters, in the plane"):format(d), "Hz")
      :near(inside, {relative = 0.01, source = "Love"})
  end
end)

-- A hub, a thin web and a blade, twisted: cells of a grid are left out.
local function bladed(n)
  local cells = {8, 4, 4}
  local box = bw.mesh.box {max = {1, 1, 1}, cells = cells, order = 1}
  local unit, places, mask = box.nodes:totable(), {}, {}
  for i, p in ipairs(unit) do
    local r = 0.05 + 0.15 * p[1]
    local angle = 2 * pi / n * p[2] + 3 * math.max(0, r - 0.12) * (p[3] - 0.5)
    places[i] = {r * cos(angle), r * sin(angle), 0.04 * (p[3] - 0.5)}
  end
  for e, row in ipairs(box.elements:totable()) do
    local middle = {0, 0, 0}
    for k = 1, 3 do
      for a = 1, 4 do middle[k] = middle[k] + unit[row[a]][k] / 4 end
      middle[k] = (math.floor(middle[k] * cells[k]) + 0.5) / cells[k]
    end
    local r, angle, z = table.unpack(middle)
    local hub, rim = r < 0.25, r > 0.375 and r < 0.5
    local web, blade = math.abs(z - 0.5) < 0.25, r > 0.5 and angle > 0.25 and angle < 0.75
    mask[e] = (hub or (r < 0.5 and web) or rim or blade) and 1 or 0
  end
  return assert(assert(box:moved(places)):subset(bw.array.new(mask))):with_order(2)
end

scenario("Bladed wheel, one sector of 9 beside the whole", function(t)
  local n = 9
  local mesh = bladed(n)
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  local function cut(angle) return mesh.boundary:plane({0, 0, 0}, {-sin(angle), cos(angle), 0}, 1e-9) end
  assert(part:cyclic {low = cut(0), high = cut(2 * pi / n), count = n})
  part:fix(mesh.boundary:where(function(x, y) return sqrt(x * x + y * y) < 0.0501 end))
  local tip = mesh.boundary:where(function(x, y) return sqrt(x * x + y * y) > 0.1999 end)
  part:load {on = tip, force = {10, 200, 50}}
  local whole = t:require(part:whole())
  local a, b = t:require(t:require(part:solve()):whole()), t:require(whole:solve())
  local function largest(x) return math.max(x:max(), -x:min()) end
  expect(largest(a.displacement - b.displacement) / largest(b.displacement),
    "largest difference of displacements / the largest")
    :near(0, {absolute = 1e-8, source = "the whole wheel"})
  expect(largest(a.stress - b.stress) / largest(b.stress),
    "largest difference of stresses / the largest")
    :near(0, {absolute = 1e-8, source = "the whole wheel"})
  local modes, its = t:require(part:modes {count = 20}), t:require(whole:modes {count = 20})
  local far = 0
  for i = 1, 20 do far = math.max(far, math.abs(modes.eigenvalues[i] / its.eigenvalues[i] - 1)) end
  expect(far, "largest difference of 20 eigenvalues / the eigenvalue")
    :near(0, {absolute = 1e-8, source = "the whole wheel"})
end)
