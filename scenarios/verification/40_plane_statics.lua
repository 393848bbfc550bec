-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Static benchmarks of sheets with published or closed-form answers.
local bw = require "barwright"
local tools = require "tools"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Sheets: statics",
  text = [[Elastic sheets whose outline can be dragged, of triangles with six nodes, beside published and closed-
form answers. Theory: [responsive.md](theory/responsive.md). After any drag the answer with everything reused is
that of a body rebuilt on the same mesh, within 1e-6, for each of the elastic applications:
`tests/engine/responsive/test_drags.c`.]]}

local XX, YY = 1, 2 -- columns of a stress: xx yy xy zz

scenario("NAFEMS LE1, elliptic membrane", function()
  local outline = tools.quarter(2, 1, 3.25, 2.75)
  local s = assert(bw.responsive.steady {outline = outline, material = tools.elastic(210e9, 0.3),
    thickness = 0.1, order = 2, size = "0.01 + 0.1*sqrt((x-2)^2 + y^2)",
    conditions = {bottom = {y = 0}, left = {x = 0}, outside = {pressure = -10e6}}})
  local d = tools.node(s, 2, 0)
  expect(s.stress(d, YY) / 1e6, "stress yy at D", "MPa"):near(92.7, {relative = 0.005, source = "NAFEMS LE1"})
  expect(s.displacement(d, 1) * 1e3, "displacement x at D", "mm")
    :near(-0.102208, {relative = 0.002, source = "own Q2 elements"})
end)

local function cook(plane, young, force, start)
  local outline = assert(bw.outline {points = {{0, 0}, {48, 44}, {48, 52}, {48, 60}, {0, 44}},
    tags = {left = 5, right = {2, 3}}})
  -- fine at the fixed corner, where stresses have no bound, and at the loaded one, where the traction
  -- ends at a free edge and displacements would converge with h only
  local min = start and 0.4 or 0.02
  local function size(x, y)
    return min + 0.08 * math.min(math.sqrt(x ^ 2 + (y - 44) ^ 2), math.sqrt((x - 48) ^ 2 + (y - 60) ^ 2))
  end
  local s = assert(bw.responsive[start or "steady"] {outline = outline, plane = plane, order = 2,
    material = tools.elastic(young, plane == "strain" and start and 0.3 or 1 / 3),
    size = size,
    conditions = {left = "fixed", right = {traction = {0, force / 16}}}})
  return s.displacement(tools.node(s, 48, 52), 2), s.displacement(tools.node(s, 48, 60), 2)
end

scenario("Cook's membrane", function()
  local middle, corner = cook("stress", 1, 1)
  expect(middle, "plane stress, middle of the loaded edge (48, 52)")
    :near(23.966, {relative = 0.001, source = "Cook; Simo and Rifai 1990: 23.96"})
  expect(corner, "plane stress, corner (48, 60)")
    :near(25.17, {relative = 0.003, source = "own Q2 elements, from below"})
  middle, corner = cook("strain", 1, 1)
  expect(middle, "plane strain, middle"):near(21.522, {relative = 0.001, source = "own Q2 elements"})
  expect(corner * 100 / 70, "plane strain, corner, E = 70, F = 100")
    :near(32.26, {relative = 0.003, source = "solids4foam: CalculiX 32.27, Code_Aster 32.20, Elmer 32.28"})
  expect((cook("strain", 240.565, 100, "cantilever")),
    "St. Venant-Kirchhoff, plane strain, E = 240.565, nu = 0.3, F = 100, middle")
    :near(7.627, {relative = 0.003, source = "own Q2 elements"})
end)

scenario("Kirsch, hole in a wide plate", function()
  -- A quarter, loaded with the tractions that Kirsch's field has at its ends: as if it had none.
  local size = 12
  local loop = {{1, 0}, {size, 0}, {size, size}, {0, size}, {0, 1}}
  tools.arc(loop, 1, 1, 90, 0)
  local last = table.remove(loop)
  loop[1] = {last[1], last[2], loop[1]}
  local outline = assert(bw.outline {points = loop,
    tags = {bottom = 1, right = 2, top = 3, left = 4}})
  local function kirsch(x, y)
    local r2, t = x * x + y * y, math.atan(y, x)
    local a, c, s = 1 / r2, math.cos(2 * t), math.sin(2 * t)
    local rr = 0.5 * (1 - a) + 0.5 * (1 - 4 * a + 3 * a * a) * c
    local tt = 0.5 * (1 + a) - 0.5 * (1 + 3 * a * a) * c
    local rt = -0.5 * (1 + 2 * a - 3 * a * a) * s
    local cc, ss, cs = math.cos(t) ^ 2, math.sin(t) ^ 2, math.cos(t) * math.sin(t)
    return rr * cc + tt * ss - 2 * rt * cs, rr * ss + tt * cc + 2 * rt * cs,
      (rr - tt) * cs + rt * (cc - ss)
  end
  local function part(i) return function(x, y) return (select(i, kirsch(x, y))) end end
  local s = assert(bw.responsive.steady {outline = outline, material = tools.elastic(1, 0.3), order = 2,
    size = "0.02 + 0.12*(sqrt(x^2 + y^2) - 1)",
    conditions = {bottom = {y = 0}, left = {x = 0}, right = {traction = {part(1), part(3)}},
      top = {traction = {part(3), part(2)}}}})
  local worst, stress, points = 0, s.stress, s.points
  for i = 1, s.node_count do
    local xx, yy, xy = kirsch(points(i, 1), points(i, 2))
    worst = math.max(worst, math.abs(stress(i, 1) - xx), math.abs(stress(i, 2) - yy),
      math.abs(stress(i, 3) - xy))
  end
  expect(stress(tools.node(s, 0, 1), XX), "stress across the load / tension")
    :near(3, {relative = 0.005, source = "Kirsch 1898"})
  expect(stress(tools.node(s, 1, 0), YY), "stress along the load / tension")
    :near(-1, {relative = 0.01, source = "Kirsch 1898"})
  expect(worst, "largest difference of a stress at any node / tension")
    :below(0.02, {source = "Kirsch 1898, whole field"})
end)

scenario("Lame, thick cylinder in plane strain and plane stress", function()
  local outline = tools.quarter(1, 1, 2, 2)
  for _, plane in ipairs {"strain", "stress"} do
    local s = assert(bw.responsive.steady {outline = outline, material = tools.elastic(1, 0.3), order = 2,
      plane = plane, size = 0.05, conditions = {bottom = {y = 0}, left = {x = 0}, inside = {pressure = 1}}})
    local inner, outer = tools.node(s, 1, 0), tools.node(s, 2, 0)
    -- plane strain is plane stress with other constants
    local e, nu = 1, 0.3
    if plane == "strain" then e, nu = 1 / (1 - 0.3 ^ 2), 0.3 / (1 - 0.3) end
    local function u(r) return 1 / (3 * e) * ((1 - nu) * r + (1 + nu) * 4 / r) end
    local source = "Lame, plane " .. plane
    expect(s.displacement(inner, 1), "displacement inside x E / p, plane " .. plane)
      :near(u(1), {relative = 1e-4, source = source})
    expect(s.displacement(outer, 1), "displacement outside x E / p, plane " .. plane)
      :near(u(2), {relative = 1e-4, source = source})
    expect(s.stress(inner, 2), "hoop stress inside / p, plane " .. plane)
      :near(5 / 3, {relative = 0.002, source = source})
    if plane == "strain" then
      expect(s.stress(inner, 4), "axial stress inside / p, plane strain")
        :near(0.3 * 2 / 3, {relative = 0.005, source = source})
    end
  end
end)
