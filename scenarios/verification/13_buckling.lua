-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Load factors of linear buckling with closed-form answers, for solids of tet10.
local bw = require "barwright"
local grids = require "grids"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Buckling",
  text = [[Load factors of linear buckling beside closed forms ([theory](theory/stability.md)). Columns are
compared with Engesser's load, Euler's with the shear stiffness k G A.]]}

local pi, cos, sin, sqrt = math.pi, math.cos, math.sin, math.sqrt
local E, nu = 200e9, 0.3
local G = E / (2 * (1 + nu))
local steel = bw.material.isotropic {young = E, poisson = nu}

-- Of a column with a buckling length, a second moment of area, and k times the area.
local function engesser(length, I, kA, shear)
  local euler = pi ^ 2 * E * I / length ^ 2
  return euler / (1 + euler / ((shear or G) * kA))
end

local function bar(L, side, cells)
  local mesh = bw.mesh.box {max = {L, side, side}, cells = cells, order = 2}
  return bw.model {mesh = mesh, material = steel}, mesh.boundary:below("x", 0), mesh.boundary:above("x", L)
end

local function compare(buckling, references, tolerance, source)
  for i, reference in ipairs(references) do
    expect(buckling.factors[i], ("load factor %d"):format(i))
      :near(reference, {relative = tolerance, source = source})
  end
  expect(buckling.counted, "counted"):equals(true)
end

local L, side = 1, 0.05
local I, kA = side ^ 4 / 12, 5 / 6 * side ^ 2

scenario("column, clamped and free", function(t)
  local part, foot, head = bar(L, side, {60, 3, 3})
  part:fix(foot):load {on = head, force = {-1, 0, 0}}
  local buckling = t:require(part:buckling {count = 4})
  local first, second = engesser(2 * L, I, kA), engesser(2 * L / 3, I, kA)
  compare(buckling, {first, first, second, second}, 0.005, "Euler, Engesser")
  expect(buckling.factor):above(0.995 * first)
end)

scenario("column, pinned at both ends, by its half", function(t)
  -- Without contraction: else the pin would hold it back, and compress the section that turns.
  local mesh = bw.mesh.box {max = {L / 2, side, side}, cells = {32, 3, 3}, order = 2}
  local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = E, poisson = 0}}
  local pin = mesh.boundary:above("x", L / 2)
  part:slide(mesh.boundary:below("x", 0), {1, 0, 0}):prescribe(pin, {false, 0, 0})
  part:load {on = pin, force = {-1, 0, 0}}
  local load = engesser(L, I, kA, E / 2)
  compare(t:require(part:buckling {count = 2}), {load, load}, 0.005, "Euler, Engesser")
end)

scenario("column, clamped at both ends, by a prescribed displacement", function(t)
  local part, foot, head = bar(L, side, {60, 3, 3})
  part:fix(foot):prescribe(head, {-1e-6, 0, 0})
  local static = t:require(part:solve())
  local buckling = t:require(static:buckling {count = 2})
  local load = engesser(L / 2, I, kA)
  local force = static:reaction_on(foot)[1]
  for i = 1, 2 do
    expect(buckling.factors[i] * force, ("load %d"):format(i), "N")
      :near(load, {relative = 0.005, source = "Euler, Engesser"})
  end
end)

scenario("column under the worst admissible load", function(t)
  local part, foot = bar(L, side, {40, 2, 2})
  local worst = t:require(bw.worst_buckling(part:fix(foot), {force = 1, contact = side * side}))
  expect(worst.force, "force", "N"):near(engesser(2 * L, I, kA), {relative = 0.005, source = "Euler, Engesser"})
  expect(worst.counted, "counted"):equals(true)
  local along = 0
  for _, arrow in ipairs(worst:arrows()) do along = along + arrow.force[1] end
  expect(-along, "force on the end", "N"):near(1, {relative = 1e-6, source = "compression"})
end)

scenario("free bar under the worst admissible load", function(t)
  local part = bar(L, side, {40, 2, 2})
  local worst = t:require(bw.worst_buckling(part, {force = 2, contact = 2 * side * side}))
  expect(worst.force / 2, "force on each end", "N")
    :near(engesser(L, I, kA), {relative = 0.005, source = "Euler, Engesser: pinned ends"})
end)

scenario("column under tension: negative factors", function(t)
  local part, foot, head = bar(L, side, {40, 2, 2})
  part:fix(foot):load {on = head, force = {1, 0, 0}}
  local load = engesser(2 * L, I, kA)
  local buckling = t:require(part:buckling {count = 2})
  compare(buckling, {-load, -load}, 0.005, "Euler, Engesser")
  expect(buckling.factor == nil, "no positive factor"):equals(true)
end)

scenario("column, clamped, its head on a transverse spring", function(t)
  -- tan u = u - u^3 E I / (k L^3), u^2 = P L^2 / (E I); the spring holds both transverse directions
  local part, foot, head = bar(L, side, {60, 3, 3})
  local k = 10 * E * I / L ^ 3
  part:fix(foot):load {on = head, force = {-1, 0, 0}}
  part:attach {on = head, spring = {0, k, k}}
  local low, high = pi / 2 + 1e-9, 4.4934
  for _ = 1, 60 do
    local u = (low + high) / 2
    if math.tan(u) > u - u ^ 3 / 10 then high = u else low = u end
  end
  local load = engesser(pi * L / low, I, kA)
  compare(t:require(part:buckling {count = 2}), {load, load}, 0.005, "Timoshenko and Gere, section 2.1; Engesser")
end)

scenario("column, half of its head loaded", function(t)
  local part, foot, head = bar(L, side, {48, 2, 2})
  part:fix(foot):load {on = head:above("y", side / 2), force = {-1, 0, 0}}
  local load = engesser(2 * L, I, kA)
  compare(t:require(part:buckling {count = 2}), {load, load}, 0.005, "Euler, Engesser")
end)

scenario("tube, clamped and free, by its half", function(t)
  local R, r, length = 0.05, 0.03, 1
  local grid = grids.mapped({3, 12, 40}, 2, function(u, v, w)
    local radius = r + (R - r) * u
    return {radius * cos(pi * v), radius * sin(pi * v), length * w}
  end)
  local part = bw.model {mesh = grid.mesh, material = steel}
  part:fix(grid:face(3, 0)):slide(grid:face(2, 0):union(grid:face(2, 1)), {0, 1, 0})
  part:load {on = grid:face(3, 1), force = {0, 0, -1}}
  local m = r / R -- Cowper's shear coefficient of a hollow circle
  local k = 6 * (1 + nu) * (1 + m ^ 2) ^ 2 / ((7 + 6 * nu) * (1 + m ^ 2) ^ 2 + (20 + 12 * nu) * m ^ 2)
  local whole = engesser(2 * length, pi / 4 * (R ^ 4 - r ^ 4), k * pi * (R ^ 2 - r ^ 2))
  compare(t:require(part:buckling {count = 1}), {whole / 2}, 0.005, "Euler, Engesser; Cowper 1966")
end)

scenario("square plate, simply supported, compressed along one side", function(t)
  -- Its half. The sides are supported at the mid-plane alone: supports over the thickness hold back contraction
  -- and compress the edge that turns, which lowers the first load by 1.4 %. Along the sides the displacement is
  -- that of uniform compression (hard support): free sides twist, which lowers it by 1.2 %.
  local a, h, n = 1, 0.02, 30
  local mesh = bw.mesh.box {min = {0, 0, -h / 2}, max = {a, a / 2, h / 2}, cells = {n, n // 2, 1}, order = 2}
  local part = bw.model {mesh = mesh, material = steel}
  local left, right = mesh.boundary:below("x", 0), mesh.boundary:above("x", a)
  local ends, near = left:union(right), mesh.boundary:below("y", 0)
  part:slide(mesh.boundary:above("y", a / 2), {0, 1, 0})
  part:prescribe(ends:union(near):plane({0, 0, 0}, {0, 0, 1}):node_set(), {false, false, 0})
  local strain = 1 / (E * h * a / 2)
  for i = 0, 2 * n do
    local x = a * i / (2 * n)
    part:prescribe(near:plane({x, 0, 0}, {1, 0, 0}):node_set(), {-strain * x, false, false})
    if i <= n then
      part:prescribe(ends:plane({0, x, 0}, {0, 1, 0}):node_set(), {false, nu * strain * (x - a / 2), false})
    end
  end
  part:load {on = right, force = {-1, 0, 0}}:load {on = left, force = {1, 0, 0}}
  local D, kGh = E * h ^ 3 / (12 * (1 - nu ^ 2)), 5 / 6 * G * h
  local function load(m) -- of m half-waves along x and one along y: exact in Mindlin's theory
    local square = pi ^ 2 * (m ^ 2 + 1) / a ^ 2
    return a / 2 * D * square ^ 2 / (m * pi / a) ^ 2 / (1 + D * square / kGh)
  end
  compare(t:require(part:buckling {count = 2}), {load(1), load(2)}, 0.005,
    "Timoshenko and Gere, Theory of Elastic Stability; shear: Mindlin 1951")
end)

scenario("cylinder, axially compressed, axisymmetric half-wave", function(t)
  -- The reference is of thin shells. The stress is lower by 0.8 h / R of it, for h from R / 100 to R / 400 and on
  -- a mesh twice as fine; half of that is transverse shear.
  local R, h = 1, 0.0025
  local length = pi * sqrt(R * h) / (12 * (1 - nu ^ 2)) ^ 0.25
  local wedge = pi / 180
  local grid = grids.mapped({2, 1, 24}, 2, function(u, v, w)
    local r = R + h * (u - 0.5)
    return {r * cos(wedge * v), r * sin(wedge * v), length * w}
  end)
  local part = bw.model {mesh = grid.mesh, material = steel}
  part:slide(grid:face(2, 0), {0, 1, 0}):slide(grid:face(2, 1), {-sin(wedge), cos(wedge), 0})
  part:slide(grid:face(3, 0), {0, 0, 1}):prescribe(grid:face(3, 1), {false, false, -1e-6})
  local static = t:require(part:solve())
  local stress = static:reaction_on(grid:face(3, 0))[3] / (wedge * R * h)
  local classical = E * h / (R * sqrt(3 * (1 - nu ^ 2)))
  expect(t:require(static:buckling {count = 1}).factor * stress, "stress", "Pa")
    :near(classical, {relative = 0.005, source = "Lorenz, Timoshenko; thin shells"})
end)

scenario("narrow cantilever, lateral-torsional", function(t)
  -- Above the beam: the mesh by 1 %, and the foot, which holds back warping, by a part of depth over length.
  local length, depth, width = 1, 0.02, 0.002
  local mesh = bw.mesh.box {max = {length, depth, width}, cells = {100, 4, 2}, order = 2}
  local part = bw.model {mesh = mesh, material = steel}
  part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", length), force = {0, -1, 0}}
  local lateral, torsion = E * depth * width ^ 3 / 12, G * depth * width ^ 3 / 3 * (1 - 0.63 * width / depth)
  local load = 4.0126 * sqrt(lateral * torsion) / length ^ 2
  local static = t:require(part:solve())
  for sign, reference in pairs {positive = load, negative = -load} do
    compare(t:require(static:buckling {count = 1, sign = sign}), {reference}, 0.03, "Prandtl 1899")
  end
end)

scenario("column under more than its critical load", function(t)
  -- CalculiX 2.20 may skip the first factor here (its issue 74: 4.37).
  local mesh = bw.mesh.box {max = {3, 0.1, 0.1}, cells = {60, 2, 2}, order = 2}
  local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 210e9, poisson = 0.28}}
  part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 3), force = {-980665, 0, 0}}
  local euler = pi ^ 2 * 210e9 * 0.1 ^ 4 / 12 / 36
  local function factor(times) -- of the modes 1, 3, ... quarter waves
    local load = times ^ 2 * euler
    return load / (1 + load / (210e9 / 2.56 * 5 / 6 * 0.01)) / 980665
  end
  compare(t:require(part:buckling {count = 4}), {factor(1), factor(1), factor(3), factor(3)}, 0.005,
    "Euler, Engesser")
end)
