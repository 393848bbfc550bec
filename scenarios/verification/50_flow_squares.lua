-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Squares: one whose lid moves, and one heated at a side.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Flow and heat: squares",
  text = [[The lid: velocities on the centre lines beside the tables of Ghia, Ghia and Shin (1982), whose own
deviation from later spectral computations is up to 3 % of an extreme (their v at Re = 100, and the least v at
Re = 1000, 2 % of it; one misprint at Re = 400, x = 0.9063, is left out), and the extremes beside those (Botella
and Peyret 1998; Bruneau and Saad 2006). Nodes in the corners are at rest. The heated side: de Vahl Davis
(1983), at Ra = 1e6 the spectral value 8.825; Prandtl number 0.71, top and bottom without heat. Heat that goes
in and does not come out is what the velocity has left of divergence inside elements.]]}

-- x or y, then u on the vertical and v on the horizontal centre line at Re = 100, 400, 1000
local ghia_u = {
  {0.9766, 0.84123, 0.75837, 0.65928}, {0.9531, 0.68717, 0.55892, 0.46604},
  {0.8516, 0.23151, 0.29093, 0.33304}, {0.7344, 0.00332, 0.16256, 0.18719},
  {0.6172, -0.13641, 0.02135, 0.05702}, {0.5, -0.20581, -0.11477, -0.0608},
  {0.4531, -0.2109, -0.17119, -0.10648}, {0.2813, -0.15662, -0.32726, -0.27805},
  {0.1719, -0.1015, -0.24299, -0.38289}, {0.1016, -0.06434, -0.14612, -0.2973},
  {0.0547, -0.03717, -0.08186, -0.18109},
}
local ghia_v = {
  {0.9688, -0.05906, -0.12146, -0.21388}, {0.9453, -0.10313, -0.22847, -0.39188},
  {0.9063, -0.16914, nil, -0.5155}, {0.8594, -0.22445, -0.44993, -0.42665},
  {0.8047, -0.24533, -0.38598, -0.31966}, {0.5, 0.05454, 0.05186, 0.02526},
  {0.2344, 0.17527, 0.30174, 0.32235}, {0.1563, 0.16077, 0.28124, 0.37095},
  {0.0938, 0.12317, 0.22965, 0.32627}, {0.0625, 0.09233, 0.1836, 0.27485},
}
local extremes = {[100] = {-0.21404, -0.25380, 0.17957}, [1000] = {-0.3885698, -0.5270771, 0.3769447}}

local graded = "0.008 + 0.1*min(min(x, 1 - x), min(y, 1 - y))"

local function square()
  return assert(bw.outline {points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
    tags = {floor = 1, right = 2, ceiling = 3, left = 4}})
end

local function lid(t, k, reynolds)
  local flow = t:require(bw.responsive.flow {outline = square(), viscosity = 1 / reynolds, size = graded,
    steady = true, conditions = {ceiling = {x = 1, y = 0}, floor = "wall", left = "wall", right = "wall"}})
  local how = ("%d triangles"):format(flow.element_count)
  local off = {0, 0}
  for _, row in ipairs(ghia_u) do
    off[1] = math.max(off[1], math.abs((flow:at(0.5, row[1])) - row[k + 1]))
  end
  for _, row in ipairs(ghia_v) do
    if row[k + 1] then
      off[2] = math.max(off[2], math.abs(select(2, flow:at(row[1], 0.5)) - row[k + 1]))
    end
  end
  expect(off[1], "u beside Ghia, of the lid's speed"):below(0.01, {how = how})
  expect(off[2], "v beside Ghia, of the lid's speed"):below(reynolds == 1000 and 0.02 or 0.015, {how = how})
  local found = {0, 0, 0}
  for i = 1, 999 do
    local u = flow:at(0.5, i / 1000)
    local _, v = flow:at(i / 1000, 0.5)
    found = {math.min(found[1], u), math.min(found[2], v), math.max(found[3], v)}
  end
  for i, name in ipairs {"least u", "least v", "largest v"} do
    if extremes[reynolds] then
      expect(found[i], name):near(extremes[reynolds][i], {relative = 0.01, source = "spectral", how = how})
    end
  end
end

local function heated(t, rayleigh, nusselt)
  local prandtl = 0.71
  local flow = t:require(bw.responsive.thermal {outline = square(), size = graded, steady = true,
    viscosity = prandtl, diffusivity = 1, expansion = 1, reference = 0.5, gravity = {0, -rayleigh * prandtl},
    conditions = {floor = "wall", ceiling = "wall", left = {x = 0, y = 0, temperature = 1},
      right = {x = 0, y = 0, temperature = 0}}})
  local how = ("%d triangles"):format(flow.element_count)
  local inward, outward = flow:nusselt("left", 1), flow:nusselt("right", 1)
  expect(inward, "Nusselt number"):near(nusselt, {relative = 0.01, source = rayleigh == 1e6 and "spectral"
    or "de Vahl Davis 1983", how = how})
  expect(math.abs(inward + outward) / inward, "heat in and out"):below(1e-4, {how = how})
end

for k, reynolds in ipairs {100, 400, 1000} do
  scenario(("A moving lid, Re = %d"):format(reynolds), {tags = {"slow"}}, function(t) lid(t, k, reynolds) end)
end

for k, nusselt in ipairs {1.118, 2.243, 4.519, 8.825} do
  scenario(("A heated side, Ra = 1e%d"):format(k + 2), {tags = {"slow"}},
    function(t) heated(t, 10 ^ (k + 2), nusselt) end)
end
