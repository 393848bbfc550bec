-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Geometrically nonlinear statics beside the elastica and a truss that snaps through, for solids of tet10.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Large displacements",
  text = [[Geometrically nonlinear statics beside published values ([theory](theory/finite.md)). The elastica is a
beam without extension and shear; solids that are fifty times as long as thick come near it.]]}

local pi, sqrt = math.pi, math.sqrt
local E = 200e9
local steel = bw.material.isotropic {young = E, poisson = 0.3}
local L, side = 1, 0.02
local EI = E * side ^ 4 / 12
local middle = {{L, side / 2, side / 2}}

local function column(mesh, force)
  local part = bw.model {mesh = mesh, material = steel}
  return part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", L - 1e-3), force = force}
end

local straight = bw.mesh.box {max = {L, side, side}, cells = {50, 2, 2}, order = 2}

scenario("cantilever under a transverse force at its end", function(t)
  local published = {{1, 0.05643, 0.30172}, {2, 0.16064, 0.49346}, {5, 0.38763, 0.71379}, {10, 0.55500, 0.81061}}
  local source = "Mattiasson, Int. J. Num. Meth. Eng. 17 (1981)"
  local path = t:require(column(straight, {0, 0, 10 * EI / L ^ 2}):nonlinear {monitor = middle})
  local moves = path:path(1)
  for _, row in ipairs(published) do
    local load, u, w = table.unpack(row)
    local allowed = {relative = 0.01, source = source}
    expect(-moves(load, 1) / L, ("u / L at P L^2 / (E I) = %g"):format(load)):near(u, allowed)
    expect(moves(load, 3) / L, ("w / L at P L^2 / (E I) = %g"):format(load)):near(w, allowed)
  end
  expect(path.negative_pivots:max(), "negative pivots"):equals(0)
end)

-- Load over the critical load, and the place of the free end, at its slopes of 20 to 80 degrees.
scenario("column far behind its critical load", function(t)
  local published = {{1.015, 0.970, 0.220}, {1.063, 0.881, 0.422}, {1.152, 0.741, 0.593}, {1.293, 0.560, 0.719}}
  local source = "Timoshenko, Gere, Theory of Elastic Stability, table 2-4"
  local critical = pi ^ 2 * EI / (4 * L ^ 2)
  local buckling = t:require(column(straight, {-critical, 0, 0}):buckling {count = 1})
  local bent = t:require(buckling:imperfect_mesh {amplitude = 1e-4 * L})
  local path = t:require(column(bent, {-critical, 0, 0}):nonlinear {factor = 1.3, steps = 20, arc_length = true,
    monitor = middle})
  local moves, at = path:path(1), 2
  local function deflection(i) return sqrt(moves(i, 2) ^ 2 + moves(i, 3) ^ 2) end
  for _, row in ipairs(published) do
    local load, x, y = table.unpack(row)
    while deflection(at) < y * L do at = at + 1 end
    local before, behind = deflection(at - 1), deflection(at)
    local part = (y * L - before) / (behind - before)
    local function between(value) return value(at - 1) + part * (value(at) - value(at - 1)) end
    expect(between(function(i) return path.factors[i] end), ("P over critical at y / L = %g"):format(y))
      :near(load, {relative = 0.005, source = source})
    expect(1 + between(function(i) return moves(i, 1) end) / L, ("x / L at y / L = %g"):format(y))
      :near(x, {relative = 0.01, source = source})
  end
end)

-- Half of von Mises's truss: a bar with a hinge at its foot, whose other end slides down. The bar is stiff at its
-- ends, so that the forces on the hinges do not indent it.
scenario("truss that snaps through", function(t)
  local h, thick, stiff = 0.04, 0.04, 0.05
  local mesh = bw.mesh.box {min = {0, -thick / 2, -thick / 2}, max = {1, thick / 2, thick / 2}, cells = {20, 2, 2},
    order = 2}
  mesh = t:require((mesh:split(function(x) return x < stiff or x > 1 - stiff end, "ends")))
  local nodes = mesh.nodes:totable()
  for _, p in ipairs(nodes) do p[3] = p[3] + h * p[1] end
  mesh = t:require(mesh:moved(nodes))
  local function hinge(x, z)
    return mesh.boundary:box({x - 1e-6, -1, z - 1e-6}, {x + 1e-6, 1, z + 1e-6}):node_set()
  end
  local part = bw.model {mesh = mesh, materials = {rest = bw.material.isotropic {young = E, poisson = 0},
    ends = bw.material.isotropic {young = 1e3 * E, poisson = 0}}}
  local foot, top = hinge(0, 0), hinge(1, h)
  local forces = bw.array.zeros(mesh.node_count, 3):totable()
  local share = {[0] = 1 / 6, 1 / 12}
  part:fix(foot):prescribe(top, {0, 0, false})
  local list = top.nodes:totable()
  for _, i in ipairs(list) do
    local y = math.abs(mesh.nodes(i, 2)) / (thick / 2) -- Simpson's rule on two edges
    forces[i][3] = -1e6 * (y > 0.9 and share[1] or y > 0.4 and 1 / 3 or share[0])
  end
  part:load {nodal = bw.array.new(forces)}
  local path = t:require(part:nonlinear {factor = 1, steps = 2000, arc_length = true, displacement = 1.9 * h,
    monitor = {{1, 0, h}}})
  local k = E * thick ^ 2 * h ^ 2 / (1 + h ^ 2) ^ 2 / (1 - 2 * stiff)
  local high, low = 0, 0
  for i = 1, path.count do high, low = math.max(high, path.factors[i]), math.min(low, path.factors[i]) end
  expect(1e6 * high, "largest load", "N"):near(k * h / sqrt(27), {relative = 0.01, source = "closed form"})
  expect(1e6 * low, "smallest load", "N"):near(-k * h / sqrt(27), {relative = 0.01, source = "closed form"})
  expect(path.negative_pivots:max(), "negative pivots between the limit points"):equals(1)
end)
