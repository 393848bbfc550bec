-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Static benchmarks of sheets with published or closed-form answers.
local bw = require "barwright"
local tools = require "plane_tools"

local cases = {}
local function case(name, run) cases[#cases + 1] = {name = name, run = run} end
local XX, YY = 1, 2 -- columns of a stress: xx yy xy zz

case("NAFEMS LE1, elliptic membrane", function()
  local outline = tools.quarter(2, 1, 3.25, 2.75)
  local s = assert(bw.responsive.steady {outline = outline, material = tools.elastic(210e9, 0.3),
    thickness = 0.1, order = 2, size = "0.01 + 0.1*sqrt((x-2)^2 + y^2)",
    conditions = {bottom = {y = 0}, left = {x = 0}, outside = {pressure = -10e6}}})
  local d = tools.node(s, 2, 0)
  return {
    {"stress yy at D, MPa", 92.7, s.stress(d, YY) / 1e6, 0.005, "NAFEMS LE1"},
    {"displacement x at D, mm", -0.102208, s.displacement(d, 1) * 1e3, 0.002, "own Q2 elements"},
  }
end)

local function cook(plane, young, force, start)
  local outline = assert(bw.outline {points = {{0, 0}, {48, 44}, {48, 52}, {48, 60}, {0, 44}},
    tags = {left = 5, right = {2, 3}}})
  -- fine at the held corner, where stresses have no bound, and at the loaded one, where the traction
  -- ends at a free edge and displacements would converge with h only
  local least = start and 0.4 or 0.02
  local function size(x, y)
    return least + 0.08 * math.min(math.sqrt(x ^ 2 + (y - 44) ^ 2), math.sqrt((x - 48) ^ 2 + (y - 60) ^ 2))
  end
  local s = assert(bw.responsive[start or "steady"] {outline = outline, plane = plane, order = 2,
    material = tools.elastic(young, plane == "strain" and start and 0.3 or 1 / 3),
    size = size,
    conditions = {left = "fixed", right = {traction = {0, force / 16}}}})
  return s.displacement(tools.node(s, 48, 52), 2), s.displacement(tools.node(s, 48, 60), 2)
end

case("Cook's membrane", function()
  local rows = {}
  local middle, corner = cook("stress", 1, 1)
  rows[1] = {"plane stress, middle of the loaded edge (48, 52)", 23.966, middle, 0.001,
    "Cook; Simo and Rifai 1990: 23.96"}
  rows[2] = {"plane stress, corner (48, 60)", 25.17, corner, 0.003, "own Q2 elements, from below"}
  middle, corner = cook("strain", 1, 1)
  rows[3] = {"plane strain, middle", 21.522, middle, 0.001, "own Q2 elements"}
  rows[4] = {"plane strain, corner, E = 70, F = 100", 32.26, corner * 100 / 70, 0.003,
    "solids4foam: CalculiX 32.27, Code_Aster 32.20, Elmer 32.28"}
  rows[5] = {"St. Venant-Kirchhoff, plane strain, E = 240.565, nu = 0.3, F = 100, middle", 7.627,
    (cook("strain", 240.565, 100, "cantilever")), 0.003, "own Q2 elements"}
  return rows
end)

case("Kirsch, hole in a wide plate", function()
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
  return {
    {"stress across the load / tension", 3, stress(tools.node(s, 0, 1), XX), 0.005, "Kirsch 1898"},
    {"stress along the load / tension", -1, stress(tools.node(s, 1, 0), YY), 0.01, "Kirsch 1898"},
    {"largest difference of a stress at any node / tension", most = 0.02, value = worst,
      source = "Kirsch 1898, whole field"},
  }
end)

case("Lame, thick cylinder in plane strain and plane stress", function()
  local rows = {}
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
    rows[#rows + 1] = {"displacement inside x E / p, plane " .. plane, u(1), s.displacement(inner, 1),
      1e-4, source}
    rows[#rows + 1] = {"displacement outside x E / p, plane " .. plane, u(2), s.displacement(outer, 1),
      1e-4, source}
    rows[#rows + 1] = {"hoop stress inside / p, plane " .. plane, 5 / 3, s.stress(inner, 2), 0.002, source}
    if plane == "strain" then
      rows[#rows + 1] = {"axial stress inside / p, plane strain", 0.3 * 2 / 3, s.stress(inner, 4), 0.005, source}
    end
  end
  return rows
end)

return cases
