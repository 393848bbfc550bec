-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Stress measures at singular edges: critical distances, stress intensities, the stress of a fillet.
local bw = require "barwright"
local core = require "barwright.core"
local prism = require "prism"

local pi, cos, sin, sqrt = math.pi, math.cos, math.sin, math.sqrt
local nu = 0.3
local elastic = bw.material.isotropic {young = 1, poisson = nu}

-- A part of a disc with the angle omega inside the material around the edge at x = y = 0.
local function wedge(omega, height)
  local profile = {{0, 0}}
  for i = 0, 24 do
    local t = omega * (i / 24 - 0.5)
    profile[#profile + 1] = {cos(t), sin(t)}
  end
  return prism(profile, {0.3, 0}, height)
end

-- Plane strain in x and y.
local function plane(part, height)
  part:slide(part.mesh.boundary:below(3, 1e-9), {0, 0, 1})
  return part:slide(part.mesh.boundary:above(3, height - 1e-9), {0, 0, 1})
end

-- Williams' symmetric displacement with the stress intensity 1, from the equations of Kolosov and Muskhelishvili:
-- phi = A z^lambda, psi = B z^lambda.
local function williams(omega, exponent)
  local l, gamma = exponent, omega / 2
  local chi = -sin((1 - l) * gamma) / sin((1 + l) * gamma)
  local A = 1 / sqrt(2 * pi) / (l * (1 + l + chi * (1 - l)))
  local B, mu, kappa = chi * (1 - l) * A, 1 / (2 * (1 + nu)), 3 - 4 * nu
  return function(p)
    local r, t = sqrt(p[1] ^ 2 + p[2] ^ 2), math.atan(p[2], p[1])
    local f = r ^ l / (2 * mu)
    local ur = f * ((kappa - l) * A * cos((l - 1) * t) - B * cos((l + 1) * t))
    local ut = f * ((kappa + l) * A * sin((l - 1) * t) + B * sin((l + 1) * t))
    return {ur * cos(t) - ut * sin(t), ur * sin(t) + ut * cos(t), 0}
  end
end

-- A wedge whose round side has Williams' displacement.
local function field(omega, length, edge, height)
  local surface = wedge(omega, height)
  local edges = assert(surface:singular_edges())
  assert.equal(1, #edges)
  local mesh = assert(bw.mesh.fill(surface, {edge_length = 0.25, order = 2,
    near = {{at = {0, 0, height / 2}, radius = 2.5 * length, length = edge}}}))
  local rows, displacement = {}, williams(omega, edges[1].exponent)
  for i, p in ipairs(mesh.nodes:totable()) do rows[i] = displacement(p) end
  local part = plane(bw.model {mesh = mesh, material = elastic}, height)
  part:prescribe(mesh.boundary:where "x^2 + y^2 > 0.98", bw.array.new(rows))
  return assert(part:solve()), edges
end

-- Places of n cells from 0 to `reach`, the first one 0.02 long, each longer than the one before by one factor.
local function graded(reach, n)
  local low, high = 1.0001, 4
  for _ = 1, 60 do
    local midpoint = (low + high) / 2
    if 0.02 * (midpoint ^ n - 1) / (midpoint - 1) > reach then high = midpoint else low = midpoint end
  end
  return function(i) return 0.02 * (low ^ i - 1) / (low - 1) end
end

describe("a nodal field at points", function()
  it("is exact where the elements hold it, and clamped outside", function()
    for order = 1, 2 do
      local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {2, 1, 1}, cells = {3, 2, 2}, order = order})
      local rows = {}
      for i, p in ipairs(mesh.nodes:totable()) do
        rows[i] = {1 + p[1] - 2 * p[2] + 3 * p[3], order == 2 and p[1] * p[2] or 0}
      end
      local values, outside = mesh:sample(bw.array.new(rows), {{0.3, 0.2, 0.7}, {1.9, 0.55, 0.1}, {2.5, 0.5, 0.5}})
      assert.near(1 + 0.3 - 0.4 + 2.1, values(1, 1), 1e-12)
      assert.near(order == 2 and 0.06 or 0, values(1, 2), 1e-12)
      assert.near(1 + 1.9 - 1.1 + 0.3, values(2, 1), 1e-12)
      assert.equal(0, outside(2, 1))
      assert.near(1 + 2 - 1 + 1.5, values(3, 1), 1e-12)
      assert.near(0.5, outside(3, 1), 1e-12)
      assert.has_error(function() mesh:sample(bw.array.zeros(3), {{0, 0, 0}}) end)
    end
  end)
end)

describe("the theory of critical distances", function()
  it("takes its length from toughness and strength", function()
    local brittle = bw.material.isotropic {young = 3e9, poisson = 0.35, strength = 50e6, toughness = 2e6}
    assert.near((2e6 / 50e6) ^ 2 / pi, brittle.critical_distance, 1e-15)
    assert.equal(2e6, brittle.toughness)
    assert.is_nil(elastic.critical_distance)
    assert.is_nil(elastic.toughness)
    assert.near((3 / 36) ^ 2 / pi, bw.material.abs.critical_distance, 1e-12)
    assert.truthy(bw.material.abs.sources.toughness.source:find("Dowling", 1, true))
    assert.truthy(tostring(bw.material.abs):find("fracture toughness 3 MPa m^0.5 +- 0.4 MPa m^0.5", 1, true))
    assert.truthy(tostring(bw.material.nylon_pa2200):find("modulus 1 800 MPa +- 130 MPa: ", 1, true))
    assert.is_nil(bw.material.pla.toughness)
    local steepest = bw.material.orthotropic {young = {1, 1, 1}, poisson = {0.3, 0.3, 0.3}, strength = {1, 2, 4},
      toughness = 4}
    assert.near(1 / pi, steepest.critical_distance, 1e-12)
    assert.has_error(function() bw.material.isotropic {young = 1, poisson = 0, toughness = -1} end)
  end)

  it("has the closed forms of Williams' field", function()
    for _, case in ipairs {{270, 0.02, 0.03}, {315, 0.02, 0.08}} do
      local omega, L = case[1] * pi / 180, 0.1
      local static, edges = field(omega, L, 0.05, 0.1)
      local l = edges[1].exponent
      local lines = assert(static:effective_stress {places = edges, length = L})
      local line = (2 * L) ^ (l - 1) / (l * sqrt(2 * pi))
      assert.equal(1, #lines)
      assert.near(line, lines[1].value, case[2] * line)
      assert.is_true(math.abs(lines[1].value / line - 1) <= lines[1].estimated_error)
      local points = assert(static:effective_stress {places = edges, length = L, method = "point"})
      local point = (L / 2) ^ (l - 1) / sqrt(2 * pi)
      assert.near(point, points[1].value, case[3] * point + 0.005)
      local K = assert(static:notch_stress_intensity {places = edges})
      assert.near(1, K[1].value, 0.03)
      assert.equal(edges[1], K[1].place)
      -- the largest stress at nodes has no such limit
      assert.is_true(static.max_principal:max() > 1.3 * line)
    end
  end)

  it("bounds the mean over a surface patch of radius L / 2 from below at edges of 270 and 300 degrees", function()
    local L, height = 0.2, 0.3
    local function over_line(omega, edge)
      local static, edges = field(omega, 0.75 * L / 2.5, edge, height)
      local stress = assert(core.surface_stress(static.mesh, static.material, static.displacement))
      local mean, largest = assert(core.surface_mean(static.mesh, stress, L / 2)), 0
      for i, p in ipairs(static.mesh.nodes:totable()) do
        if math.abs(p[3] - height / 2) < L / 6 and p[1] ^ 2 + p[2] ^ 2 < L ^ 2 / 4 then
          largest = math.max(largest, core.principal(mean:rows(i, i))(1, 1))
        end
      end
      local l = edges[1].exponent
      return largest * l * sqrt(2 * pi) / (2 * L) ^ (l - 1)
    end
    for omega, limit in pairs {[1.5 * pi] = 1.02, [5 * pi / 3] = 0.98} do
      local coarse, fine = over_line(omega, L / 3), over_line(omega, L / 6)
      assert.is_true(limit < fine and fine < coarse and coarse < 1.22, ("%g: %g, %g"):format(omega, coarse, fine))
    end
  end)

  it("means the surface stress, of the displacement and of the traction that acts", function()
    local part = bw.model {mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.4, 0.1, 0.1}, cells = {8, 2, 2},
      order = 2}), material = elastic}
    local u, mesh = {}, part.mesh
    for i, p in ipairs(mesh.nodes:totable()) do u[i] = {p[1], -nu * p[2], -nu * p[3]} end
    u = core.array.new(u)
    local basis = assert(bw.pressure_basis(mesh))
    local pressure = {}
    for i = 1, basis.count do pressure[i] = 0 end
    local free = assert(bw.surface_stress(mesh, elastic, u))
    assert.equal(3 * mesh.facets.row_count, free.row_count)
    local loaded = assert(bw.surface_stress(mesh, elastic, u, basis:force(pressure)))
    assert.equal(0, (free - loaded):max() - (free - loaded):min())
    local mean = assert(bw.surface_mean(mesh, free, 0.03))
    for i, p in ipairs(mesh.nodes:totable()) do
      if p[3] == 0.1 and p[1] > 0.05 and p[1] < 0.35 then assert.near(1, mean(i, 1), 1e-12) end
    end
    assert.has_error(function() bw.surface_stress(mesh, elastic, u, core.array.new {{0, 0, 0}}) end)
    assert.has_error(function() bw.surface_mean(mesh, u, 0.03) end)
  end)

  it("does not change with the mesh as the largest stress does", function()
    local coarse, edges = field(1.5 * pi, 0.1, 0.08, 0.1)
    local fine = field(1.5 * pi, 0.1, 0.03, 0.1)
    local a = assert(coarse:effective_stress {places = edges, length = 0.1})[1].value
    local b = assert(fine:effective_stress {places = edges, length = 0.1})[1].value
    assert.near(b, a, 0.02 * b)
    assert.is_true(fine.max_principal:max() > 1.15 * coarse.max_principal:max())
  end)

  it("reproduces linear elastic fracture mechanics at a crack in a wide plate", function()
    -- a quarter of the plate; the crack of half length 1 ends where the plane of symmetry is fixed
    local n, wide, height = 16, 12, 0.1
    local grid = assert(bw.mesh.box {min = {-n, 0, 0}, max = {n, n, 1}, cells = {2 * n, n, 1}, order = 1})
    local left, right, up, moved = graded(1, n), graded(wide - 1, n), graded(wide, n), {}
    for i, p in ipairs(grid.nodes:totable()) do
      moved[i] = {1 + (p[1] < 0 and -left(-p[1]) or right(p[1])), up(p[2]), height * p[3]}
    end
    local mesh = assert(grid:moved(moved)):with_order(2)
    local part = plane(bw.model {mesh = mesh, material = elastic}, height)
    part:slide(mesh.boundary:below(1, 1e-9), {1, 0, 0})
    part:slide(mesh.boundary:box({1, 0, 0}, {wide, 0, height}), {0, 1, 0})
    part:load {on = mesh.boundary:above(2, wide - 1e-9), traction = {0, 1, 0}}
    local places = assert(part:singular_places())
    local front = assert(places:near({1, 0, 0.05}, 1e-6)).place
    assert.equal("border of a support", front.kind)
    assert.near(0.5, front.exponent, 1e-9)
    assert.near(1, front.inward[1][1], 1e-12)
    local static = assert(part:solve())
    local chosen = require("barwright.singular").list {front}
    local width = sqrt(1 / cos(pi / (2 * wide))) -- of the finite plate
    local K = assert(static:notch_stress_intensity {places = chosen})[1].value
    assert.near(sqrt(pi) * width, K, 0.04 * K)
    -- the line method in the plate's exact field, sigma x / sqrt(x^2 - 1): sigma sqrt((1 + L) / L)
    for _, L in ipairs {0.1, 0.2} do
      local value = assert(static:effective_stress {places = chosen, length = L})[1].value
      assert.near(sqrt((1 + L) / L) * width, value, 0.03 * value)
      -- it fails where this is the strength: at K_Ic / sqrt(pi (a + L)), with L small at K_Ic / sqrt(pi a)
      local strength, toughness = 1, sqrt(pi * L)
      assert.near(toughness / sqrt(pi * (1 + L)), strength / value * width, 0.02)
    end
  end)

  it("says what is missing", function()
    local static, edges = field(1.5 * pi, 0.1, 0.08, 0.1)
    local none, message, details = static:effective_stress {places = edges}
    assert.is_nil(none)
    assert.truthy(message:find("the critical distance is not known", 1, true))
    assert.equal("unsupported", details.status)
    none, message = static:effective_stress {places = edges, length = 2}
    assert.is_nil(none)
    assert.truthy(message:find("leaves the body", 1, true), message)
    assert.has_error(function() static:effective_stress {places = {}, length = 1} end)
    assert.has_error(function() static:fillet_stress {places = edges} end)
    assert.has_error(function() static:effective_stress {length = 1, method = "area"} end)
  end)
end)

-- A bar with a V-notch of 90 degrees and depth 1, sharp or with a fillet, under tension.
local function notched(radius)
  local height, profile, tip = 0.1, {{-3, -2}, {3, -2}, {3, 1}, {1, 1}}, {0, 0, 0.05}
  if radius then
    local centre = radius * sqrt(2)
    for i = 0, 12 do
      local t = -pi / 4 - pi / 2 * i / 12
      profile[#profile + 1] = {radius * cos(t), centre + radius * sin(t)}
    end
    tip[2] = centre - radius
  else
    profile[5] = {0, 0}
  end
  profile[#profile + 1] = {-1, 1}
  profile[#profile + 1] = {-3, 1}
  local surface = prism(profile, {0, -1}, height)
  local mesh = assert(bw.mesh.fill(surface, {edge_length = 0.5, order = 2,
    near = {{at = tip, radius = 2 * (radius or 0.1), length = radius and radius / 3 or 0.04}}}))
  local part = plane(bw.model {mesh = assert(mesh:curved(surface)), material = elastic}, height)
  local boundary = part.mesh.boundary
  part:slide(boundary:below(1, -3 + 1e-9), {1, 0, 0}):slide(boundary:nearest({-3, -2, 0}, 1), {0, 1, 0})
  part:load {on = boundary:above(1, 3 - 1e-9), traction = {1, 0, 0}}
  return assert(part:solve()), surface
end

describe("the stress of a fillet", function()
  it("follows from the stress intensity of the sharp notch", function()
    local sharp, surface = notched()
    local edges = assert(surface:singular_edges())
    local fillet = assert(sharp:fillet_stress {places = edges, radius = 0.1})[1]
    local round, its_surface = notched(0.1)
    assert.equal(0, #assert(its_surface:singular_edges()))
    local largest = round.max_principal:max()
    assert.near(largest, fillet.value, 0.05 * largest)
    assert.is_true(fillet.estimated_error >= 0.1 and fillet.estimated_error < 0.2) -- the formula's own as well
    -- a smaller radius has a larger stress, like rho^(lambda - 1)
    local smaller = assert(sharp:fillet_stress {places = edges, radius = 0.05})[1]
    assert.near(2 ^ edges[1].growth, smaller.value / fillet.value, 1e-5)
  end)

  it("is that of Peterson's shoulder fillet", function()
    -- half of a flat bar of width 4 and 2 under tension; the field at a shoulder is not symmetric
    local surface = prism({{-5, 0}, {5, 0}, {5, 1}, {0, 1}, {0, 2}, {-5, 2}}, {-0.3, 0.5}, 0.1)
    local mesh = assert(bw.mesh.fill(surface, {edge_length = 0.5, order = 2,
      near = {{at = {0, 1, 0.05}, radius = 0.25, length = 0.04}}}))
    local part = plane(bw.model {mesh = mesh, material = elastic}, 0.1)
    local boundary = mesh.boundary
    part:slide(boundary:below(1, -5 + 1e-9), {1, 0, 0}):slide(boundary:below(2, 1e-9), {0, 1, 0})
    part:load {on = boundary:above(1, 5 - 1e-9), traction = {1, 0, 0}}
    local static, edges = assert(part:solve()), assert(surface:singular_edges())
    -- D / d = 2, t = d / 2: the polynomial of Peterson's chart in Roark's table 17.1 for 2 <= t / r <= 20
    for _, radius in ipairs {0.1, 0.2} do
      local x = 1 / radius
      local root = sqrt(x)
      local factor = 1.042 + 0.982 * root - 0.036 * x + (-0.074 - 0.156 * root - 0.010 * x) / 2
        + (-3.418 + 1.220 * root - 0.005 * x) / 4 + (3.450 - 2.046 * root + 0.051 * x) / 8
      local found = assert(static:fillet_stress {places = edges, radius = radius})[1]
      assert.is_true(found.value > factor and found.value < 1.08 * factor)
    end
  end)
end)
