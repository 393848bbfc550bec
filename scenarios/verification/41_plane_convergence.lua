-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Orders of convergence of three- and six-node triangles on meshes as they come, with a curved hole.
--
-- Exact displacements from complex potentials (Kolosov, Muskhelishvili) with phi = exp z, psi = sin z:
--   2 mu (u + iv) = kappa phi - z conj(phi') - conj(psi),
--   xx + yy = 4 Re phi',   yy - xx + 2 i xy = 2 (conj(z) phi'' + psi'),
-- kappa = (3 - nu) / (1 + nu) in plane stress, 3 - 4 nu in plane strain. The edge on the right is loaded
-- with tractions, on all others displacements are given.
local bw = require "barwright"
local tools = require "tools"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Sheets: orders of convergence",
  text = [[Least squares over meshes of several sizes, unstructured, with a curved hole; a smooth field with
displacements and tractions given.]]}

local YOUNG, POISSON = 2.5, 0.25
local MU = YOUNG / (2 * (1 + POISSON))
local exp, sin, cos = math.exp, math.sin, math.cos
local sinh = function(x) return (exp(x) - exp(-x)) / 2 end
local cosh = function(x) return (exp(x) + exp(-x)) / 2 end

local function exact(plane)
  local kappa = plane == "strain" and 3 - 4 * POISSON or (3 - POISSON) / (1 + POISSON)
  return function(x, y)
    local pr, pi = exp(x) * cos(y), exp(x) * sin(y)
    local u = kappa * pr - (x * pr + y * pi) - sin(x) * cosh(y)
    local v = kappa * pi - (y * pr - x * pi) + cos(x) * sinh(y)
    local sum = 4 * pr
    local dr, di = 2 * (x * pr + y * pi + cos(x) * cosh(y)), 2 * (x * pi - y * pr - sin(x) * sinh(y))
    return u / (2 * MU), v / (2 * MU), (sum - dr) / 2, (sum + dr) / 2, di / 2
  end
end

local function errors(plane, order, size)
  local at = exact(plane)
  local function part(i) return function(x, y) return (select(i, at(x, y))) end end
  local outline = assert(bw.outline.rectangle {min = {0, 0}, max = {1, 1}, tags = {right = 2},
    holes = {bw.outline.circle {centre = {0.45, 0.5}, radius = 0.2, name = "hole"}}})
  local exact_u = {x = part(1), y = part(2)}
  local s = assert(bw.responsive.steady {outline = outline, order = order, size = size, plane = plane,
    material = tools.elastic(YOUNG, POISSON),
    solver = bw.solver.pcg {preconditioner = bw.solver.cholesky(), tolerance = 1e-12},
    conditions = {boundary = exact_u, hole = exact_u, right = {traction = {part(3), part(5)}}}})
  -- constants of plane stress, in plane strain those that make it so
  local e, nu = YOUNG, POISSON
  if plane == "strain" then e, nu = YOUNG / (1 - POISSON ^ 2), POISSON / (1 - POISSON) end
  local l2, energy, area = 0, 0, 0
  tools.integrate(s.mesh, s.displacement, function(x, y, w, u, g)
    local ex, ey, sx, sy, t = at(x, y)
    l2 = l2 + w * ((u[1] - ex) ^ 2 + (u[2] - ey) ^ 2)
    local f = e / (1 - nu * nu)
    local dx, dy = f * (g[1][1] + nu * g[2][2]) - sx, f * (g[2][2] + nu * g[1][1]) - sy
    local dt = MU * (g[1][2] + g[2][1]) - t
    energy = energy + w * ((dx * dx + dy * dy - 2 * nu * dx * dy) / e + dt * dt / MU)
    area = area + w
  end)
  return math.sqrt(l2 / area), math.sqrt(energy), s.element_count
end

local function orders(levels)
  for _, plane in ipairs {"stress", "strain"} do
    for order = 1, 2 do
      local sums = {{0, 0}, {0, 0}}
      local n, sx, sxx = 0, 0, 0
      for level = 1, levels do
        local l2, energy, elements = errors(plane, order, 0.14 / 2 ^ (level - 1))
        local h = -0.5 * math.log(elements)
        n, sx, sxx = n + 1, sx + h, sxx + h * h
        for i, value in ipairs {math.log(l2), math.log(energy)} do
          sums[i][1], sums[i][2] = sums[i][1] + value, sums[i][2] + h * value
        end
      end
      for i, name in ipairs {"displacement (L2)", "energy"} do
        local slope = (n * sums[i][2] - sx * sums[i][1]) / (n * sxx - sx * sx)
        expect(slope, ("tri%d, plane %s: order of the error of the %s"):format(3 * order, plane, name))
          :near(order + 2 - i, {relative = 0.07, source = "theory"})
      end
    end
  end
end

scenario("Orders of convergence, meshes of four sizes", function() orders(4) end)

scenario("Orders of convergence, meshes of five sizes", {tags = {"slow"}}, function() orders(5) end)
