-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bodies of several materials with closed-form answers.
local bw = require "barwright"
local grids = require "grids"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Bodies of several materials",
  text = [[Bodies whose regions are of different materials, of tetrahedra with ten nodes, beside closed forms.]]}

local pi, cos, sin, tan = math.pi, math.cos, math.sin, math.tan
local YY, ZZ = 2, 3 -- columns of a stress: xx yy zz yz zx xy

local function elastic(young, poisson, expansion, density)
  return bw.material.isotropic {young = young, poisson = poisson, expansion = expansion, density = density}
end

--- The solution of a small system of equations, by elimination.
local function solve(a, b)
  local n = #b
  for i = 1, n do
    local p = i
    for k = i + 1, n do if math.abs(a[k][i]) > math.abs(a[p][i]) then p = k end end
    a[i], a[p], b[i], b[p] = a[p], a[i], b[p], b[i]
    for k = i + 1, n do
      local f = a[k][i] / a[i][i]
      for j = i, n do a[k][j] = a[k][j] - f * a[i][j] end
      b[k] = b[k] - f * b[i]
    end
  end
  for i = n, 1, -1 do
    for j = i + 1, n do b[i] = b[i] - a[i][j] * b[j] end
    b[i] = b[i] / a[i][i]
  end
  return b
end

scenario("Bars in series and side by side, tet10", function(t)
  local soft, stiff = elastic(1e9, 0), elastic(200e9, 0)
  for axis, name in ipairs {"in series", "side by side"} do
    local grid = grids.mapped({4, 4, 2}, 2, function(u, v, w) return {2 * u, v, w} end)
    grid:divide(function(x, y) return (axis == 1 and x / 2 or y) < 0.5 and "soft" or "stiff" end)
    local part = bw.model {mesh = grid.mesh, materials = {soft = soft, stiff = stiff}}
    part:fix(grid:face(1, 0))
    local strain = 1e-3
    if axis == 1 then
      part:load {on = grid:face(1, 1), traction = {1e6, 0, 0}}
    else
      part:prescribe(grid:face(1, 1), {2 * strain, false, false})
    end
    local static = t:require(part:solve())
    if axis == 1 then
      expect(static.displacement(grid:node(1, 0, 0), 1), "end displacement, " .. name, "m")
        :near(1e6 / 1e9 + 1e6 / 200e9, {relative = 1e-10, source = "closed form"})
      local between = t:require(static:interface_traction("soft", "stiff"))
      local normal = between.normal:gather(between.nodes)
      expect(normal:min(), "least normal traction of the interface", "Pa")
        :near(1e6, {relative = 1e-9, source = "equilibrium"})
      expect(normal:max(), "largest normal traction of the interface", "Pa")
        :near(1e6, {relative = 1e-9, source = "equilibrium"})
      expect(between.force[1], "force through the interface", "N")
        :near(1e6, {relative = 1e-9, source = "equilibrium"})
    else
      local force = 0
      for i = 1, grid.mesh.node_count do
        if grid.mesh.nodes(i, 1) == 0 then force = force - static.reaction(i, 1) end
      end
      expect(force, "force, " .. name, "N")
        :near(strain * (0.5e9 + 100e9), {relative = 1e-10, source = "closed form"})
    end
  end
end)

-- The curvature of a strip of two metals of equal thickness: 24 (a2 - a1) dT / (h (14 + n + 1/n)), n = E1/E2.
scenario("Timoshenko, bimetal strip, tet10", function(t)
  local h, length, warmer = 1e-3, 40e-3, 100
  local e1, e2, a1, a2 = 200e9, 70e9, 12e-6, 23e-6
  local grid = grids.mapped({40, 2, 4}, 2, function(u, v, w) return {length * u, 2e-3 * v, h * w} end)
  grid:divide(function(_, _, z) return z < h / 2 and "lower" or "upper" end)
  local part = bw.model {mesh = grid.mesh, materials = {lower = elastic(e1, 0, a1), upper = elastic(e2, 0, a2)}}
  part:slide(grid:face(1, 0), {1, 0, 0})
  part:slide(grid:face(2, 0), {0, 1, 0})
  part:prescribe(grid:where(function(u, _, w) return u < 1e-9 and w < 1e-9 end), {false, false, 0})
  part:temperature(warmer)
  local static = t:require(part:solve())
  local n = e1 / e2
  local curvature = 24 * (a2 - a1) * warmer / (h * (14 + n + 1 / n))
  local half, full = grid:node(0.25, 0, 0), grid:node(0.75, 0, 0)
  local slope = static.displacement(full, 3) - static.displacement(half, 3)
  local own = -2 * slope / ((0.75 ^ 2 - 0.25 ^ 2) * length ^ 2)
  expect(own, "curvature", "1/m"):near(curvature, {relative = 0.01, source = "Timoshenko 1925"})
  -- P h / 2 is what bends both metals: kappa (E1 I1 + E2 I2).
  local between = t:require(static:interface_traction("lower", "upper"))
  expect(between.force[1], "force along the interface", "N")
    :near(2 * curvature * (e1 + e2) * 2e-3 * (h / 2) ^ 3 / 12 / h, {relative = 0.02, source = "Timoshenko 1925"})
end)

--- What two concentric shells have: u = A r + B / r^2 in each, radial stress 3 K A - 4 G B / r^3.
local function moduli(young, poisson)
  return young / (3 * (1 - 2 * poisson)), young / (2 * (1 + poisson))
end

scenario("Lamé, sphere of two layers under pressure, tet10", function(t)
  local a, b, c, p = 1, 1.5, 2, 1e6
  local grid = grids.mapped({12, 8, 8}, 2, function(u, v, w)
    local r, y, z = a + (c - a) * u, tan(pi / 4 * v), tan(pi / 4 * w)
    local size = r / math.sqrt(1 + y * y + z * z)
    return {size, size * y, size * z}
  end)
  grid:divide(function(x, y, z) return math.sqrt(x * x + y * y + z * z) < b and "inner" or "outer" end)
  local part = bw.model {mesh = grid.mesh, materials = {inner = elastic(200e9, 0.3), outer = elastic(20e9, 0.35)}}
  local h = math.sqrt(0.5)
  part:slide(grid:face(2, 0), {0, 1, 0})
  part:slide(grid:face(2, 1), {-h, h, 0})
  part:slide(grid:face(3, 0), {0, 0, 1})
  part:slide(grid:face(3, 1), {-h, 0, h})
  part:load {on = grid:face(1, 0), pressure = p}
  local static = t:require(part:solve())
  local k1, g1 = moduli(200e9, 0.3)
  local k2, g2 = moduli(20e9, 0.35)
  local x = solve({{3 * k1, -4 * g1 / a ^ 3, 0, 0}, {0, 0, 3 * k2, -4 * g2 / c ^ 3},
    {b, 1 / b ^ 2, -b, -1 / b ^ 2}, {3 * k1, -4 * g1 / b ^ 3, -3 * k2, 4 * g2 / b ^ 3}}, {-p, 0, 0, 0})
  expect(static.displacement(grid:node(0, 0, 0), 1), "radial displacement inside", "m")
    :near(x[1] * a + x[2] / a ^ 2, {relative = 0.01, source = "Lamé"})
  expect(static.displacement(grid:node(1, 0, 0), 1), "radial displacement outside", "m")
    :near(x[3] * c + x[4] / c ^ 2, {relative = 0.01, source = "Lamé"})
  expect(static.stress(grid:node(0, 0, 0), YY) / 1e6, "hoop stress inside", "MPa")
    :near((3 * k1 * x[1] + 2 * g1 * x[2] / a ^ 3) / 1e6, {relative = 0.01, source = "Lamé"})
  expect(static.stress(grid:node(0.5, 0, 0), YY) / 1e6, "hoop stress at the interface, inner side", "MPa")
    :near((3 * k1 * x[1] + 2 * g1 * x[2] / b ^ 3) / 1e6, {relative = 0.01, source = "Lamé"})
  expect(static.stress(grid:node(1, 0, 0), YY) / 1e6, "hoop stress outside", "MPa")
    :near((3 * k2 * x[3] + 2 * g2 * x[4] / c ^ 3) / 1e6, {relative = 0.01, source = "Lamé"})
  local between = t:require(static:interface_traction("inner", "outer"))
  local normal = between.normal:gather(between.nodes)
  local radial = 3 * k1 * x[1] - 4 * g1 * x[2] / b ^ 3
  expect(normal:min() / 1e6, "least normal traction of the interface", "MPa")
    :near(radial / 1e6, {relative = 0.02, source = "Lamé"})
  expect(normal:max() / 1e6, "largest normal traction of the interface", "MPa")
    :near(radial / 1e6, {relative = 0.02, source = "Lamé"})
  expect(between.shear:max() / -radial, "shear over normal traction", ""):below(0.02)
end)

-- Interference d is what the hub would expand by if it were free. In plane strain that is (1 + nu) alpha dT b.
scenario("Lamé, press fit of two rings by heat, tet10", function(t)
  local a, b, c, warmer, wedge = 1, 1.5, 2, 100, pi / 6
  local e1, nu1, alpha, e2, nu2 = 70e9, 0.33, 20e-6, 200e9, 0.3
  local grid = grids.mapped({12, 6, 1}, 2, function(u, v, w)
    local r = a + (c - a) * u
    return {r * cos(wedge * v), r * sin(wedge * v), 0.1 * w}
  end)
  grid:divide(function(x, y) return math.sqrt(x * x + y * y) < b and "hub" or "ring" end)
  local part = bw.model {mesh = grid.mesh, materials = {hub = elastic(e1, nu1, alpha), ring = elastic(e2, nu2)}}
  part:slide(grid:face(2, 0), {0, 1, 0})
  part:slide(grid:face(2, 1), {-sin(wedge), cos(wedge), 0})
  part:slide(grid:face(3, 0), {0, 0, 1})
  part:slide(grid:face(3, 1), {0, 0, 1})
  part:temperature(warmer)
  local static = t:require(part:solve())
  local function radial(young, nu, inner, outer) -- u / p at b in plane strain: the hub moves in, the ring out
    local q = (outer ^ 2 + inner ^ 2) / (outer ^ 2 - inner ^ 2)
    local own, ratio = young / (1 - nu * nu), nu / (1 - nu)
    return b / own * (q - ratio), b / own * (q + ratio)
  end
  local hub = radial(e1, nu1, a, b)
  local _, ring = radial(e2, nu2, b, c)
  local p = (1 + nu1) * alpha * warmer * b / (hub + ring)
  expect(static.displacement(grid:node(0.5, 0, 0), 1), "displacement of the interface", "m")
    :near(p * ring, {relative = 0.01, source = "Lamé"})
  expect(static.stress(grid:node(1, 0, 0), YY) / 1e6, "hoop stress outside", "MPa")
    :near(2 * p * b ^ 2 / (c ^ 2 - b ^ 2) / 1e6, {relative = 0.01, source = "Lamé"})
  expect(static.stress(grid:node(0, 0, 0), YY) / 1e6, "hoop stress at the bore", "MPa")
    :near(-2 * p * b ^ 2 / (b ^ 2 - a ^ 2) / 1e6, {relative = 0.01, source = "Lamé"})
  local between = t:require(static:interface_traction("hub", "ring"))
  local normal = between.normal:gather(between.nodes)
  expect(normal:min() / 1e6, "least normal traction of the interface", "MPa")
    :near(-p / 1e6, {relative = 0.02, source = "Lamé"})
  expect(normal:max() / 1e6, "largest normal traction of the interface", "MPa")
    :near(-p / 1e6, {relative = 0.02, source = "Lamé"})
end)

-- A ball in a larger one whose surface has the displacements of a uniform strain. Eshelby's strain in the ball is
-- for an infinite matrix; at a radius of eight the finite size changes it by some (1/8)^3 = 0.2 %.
scenario("Eshelby, spherical inhomogeneity under uniaxial strain, tet10", function(t)
  local radius, core, split, strain = 8, 0.45, 1 / 3, 1e-3
  local function face(u, y, z) -- a point of the block over the core's face x
    local size = math.sqrt(1 + y * y + z * z)
    local out = u <= split and 1 or radius ^ ((u - split) / (1 - split))
    local part = math.min(u / split, 1)
    local r = (1 - part) * core + part * out / size
    return r, r * y, r * z
  end
  local function t4(v) return tan(pi / 4 * v) end
  local grid = grids.patches({9, 9, 9}, 2, {
    function(u, v, w) return {core * t4(u), core * t4(v), core * t4(w)} end,
    function(u, v, w) return {face(u, t4(v), t4(w))} end,
    function(u, v, w) local a, b, c = face(u, t4(v), t4(w)) return {c, a, b} end,
    function(u, v, w) local a, b, c = face(u, t4(v), t4(w)) return {b, c, a} end})
  grid:divide(function(x, y, z) return math.sqrt(x * x + y * y + z * z) < 1 and "ball" or "matrix" end)
  local e1, nu1, e2, nu2 = 200e9, 0.25, 20e9, 0.3
  local part = bw.model {mesh = grid.mesh, materials = {ball = elastic(e1, nu1), matrix = elastic(e2, nu2)}}
  local mesh, far, field = grid.mesh, {}, {}
  for i, x in ipairs(mesh.nodes:totable()) do
    far[i] = x[1] ^ 2 + x[2] ^ 2 + x[3] ^ 2 > (radius * (1 - 1e-6)) ^ 2 and 1 or 0
    field[i] = {0, 0, strain * x[3]}
  end
  for axis = 1, 3 do
    local normal = {axis == 1 and 1 or 0, axis == 2 and 1 or 0, axis == 3 and 1 or 0}
    part:slide(mesh.boundary:below(axis, 1e-9), normal)
  end
  part:prescribe(assert(mesh.boundary:where(bw.array.new(far))), bw.array.new(field))
  local static = t:require(part:solve())
  local k1, g1 = moduli(e1, nu1)
  local k2, g2 = moduli(e2, nu2)
  local alpha, beta = (1 + nu2) / (3 * (1 - nu2)), 2 * (4 - 5 * nu2) / (15 * (1 - nu2))
  local mean = strain / 3 / (1 + alpha * (k1 / k2 - 1))
  local deviator = 2 / 3 * strain / (1 + beta * (g1 / g2 - 1))
  local expected, least, most, sum, volume = 3 * k1 * mean + 2 * g1 * deviator, math.huge, 0, 0, 0
  for i, x in ipairs(mesh.nodes:totable()) do
    if x[1] ^ 2 + x[2] ^ 2 + x[3] ^ 2 < 0.9 then
      local zz = static.stress(i, ZZ)
      least, most = math.min(least, zz), math.max(most, zz)
    end
  end
  for _, e in ipairs(mesh:region("ball").elements:totable()) do
    sum, volume = sum + mesh.volumes(e, 1) * static.element_stress(e, ZZ), volume + mesh.volumes(e, 1)
  end
  expect(sum / volume / 1e6, "mean stress zz in the ball", "MPa")
    :near(expected / 1e6, {relative = 0.01, source = "Eshelby 1957"})
  expect(least / 1e6, "least stress zz in the ball", "MPa")
    :near(expected / 1e6, {relative = 0.025, source = "Eshelby 1957"})
  expect(most / 1e6, "largest stress zz in the ball", "MPa")
    :near(expected / 1e6, {relative = 0.025, source = "Eshelby 1957"})
end)

-- Fixed at x = 0, free at x = l: E1 k1 / tan(k1 l1) = E2 k2 tan(k2 l2), k = omega / c.
scenario("Longitudinal frequencies of a bar of two materials, tet10", function(t)
  local e1, r1, l1, e2, r2, l2 = 70e9, 2700, 0.4, 200e9, 7800, 0.6
  local grid = grids.mapped({40, 1, 1}, 2, function(u, v, w) return {u, 0.02 * v, 0.02 * w} end)
  grid:divide(function(x) return x < l1 and "first" or "second" end)
  local first, second = elastic(e1, 0, 0, r1), elastic(e2, 0, 0, r2)
  local part = bw.model {mesh = grid.mesh, materials = {first = first, second = second}}
  part:fix(grid:face(1, 0))
  for axis = 2, 3 do
    for value = 0, 1 do part:slide(grid:face(axis, value), {0, axis == 2 and 1 or 0, axis == 3 and 1 or 0}) end
  end
  local modes = t:require(part:modes {count = 3})
  local c1, c2 = math.sqrt(e1 / r1), math.sqrt(e2 / r2)
  local function off(w)
    local k1, k2 = w / c1, w / c2
    return e1 * k1 * cos(k1 * l1) * cos(k2 * l2) - e2 * k2 * sin(k2 * l2) * sin(k1 * l1)
  end
  local found, step, w = 0, 50, 50
  while found < 3 do
    if off(w) * off(w + step) < 0 then
      local low, high = w, w + step
      for _ = 1, 60 do
        local middle = (low + high) / 2
        if off(low) * off(middle) <= 0 then high = middle else low = middle end
      end
      found = found + 1
      expect(modes.frequencies[found], "frequency " .. found, "Hz")
        :near(low / (2 * pi), {relative = 0.001, source = "closed form"})
    end
    w = w + step
  end
end)
