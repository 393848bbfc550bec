-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the cases of plane.lua share: arcs as curves, places on meshes, integrals over elements.
local bw = require "barwright"

local tools = {}

function tools.elastic(young, poisson, density)
  return bw.material.isotropic {name = "test", young = young, poisson = poisson, density = density}
end

--- Appends to a loop the curves along an ellipse about the origin from one angle (of its parameter,
--- degrees) to another; its last entry must be the start.
function tools.arc(loop, a, b, from, to)
  local n = math.max(1, math.ceil(math.abs(to - from) / 22.5))
  local step = math.rad(to - from) / n
  local k = 4 / 3 * math.tan(step / 4)
  for i = 1, n do
    local s, t = math.rad(from) + (i - 1) * step, math.rad(from) + i * step
    loop[#loop + 1] = {{a * (math.cos(s) - k * math.sin(s)), b * (math.sin(s) + k * math.cos(s))},
      {a * (math.cos(t) + k * math.sin(t)), b * (math.sin(t) - k * math.cos(t))},
      {a * math.cos(t), b * math.sin(t)}}
  end
end

--- A quarter between two ellipses; tags: bottom, outside, left, inside.
function tools.quarter(inner_a, inner_b, outer_a, outer_b)
  local loop = {{inner_a, 0}, {outer_a, 0}}
  tools.arc(loop, outer_a, outer_b, 0, 90)
  local outside = #loop - 2
  loop[#loop + 1] = {0, inner_b}
  tools.arc(loop, inner_a, inner_b, 90, 0)
  -- the last curve leads back to the first vertex
  local last = table.remove(loop)
  loop[1] = {last[1], last[2], loop[1]}
  local edges = {bottom = {1}, outside = {}, left = {2 + outside}, inside = {}}
  for e = 2, 1 + outside do table.insert(edges.outside, e) end
  for e = 3 + outside, #loop do table.insert(edges.inside, e) end
  return assert(bw.outline {points = loop, tags = edges})
end

--- The number of the node at a place, which must be there.
function tools.node(sheet, x, y)
  local best, min = nil, math.huge
  local points = sheet.points
  for i = 1, #points do
    local d = (points(i, 1) - x) ^ 2 + (points(i, 2) - y) ^ 2
    if d < min then best, min = i, d end
  end
  assert(min < 1e-12, ("no node at (%g, %g): the nearest is %g away"):format(x, y, math.sqrt(min)))
  return best
end

-- Seven points of degree 5 (Radon): barycentric coordinates, weights that sum to 1.
local rule = {{1 / 3, 1 / 3, 1 / 3, 0.225}}
for _, sign in ipairs {-1, 1} do
  local a = (6 + sign * math.sqrt(15)) / 21
  local w = (155 + sign * math.sqrt(15)) / 1200
  for k = 1, 3 do
    local p = {a, a, a, w}
    p[k] = 1 - 2 * a
    rule[#rule + 1] = p
  end
end

-- Shape functions and their slopes by the first two barycentric coordinates.
local function shape(order, l)
  local l1, l2, l3 = l[1], l[2], l[3]
  if order == 1 then return {l1, l2, l3}, {{1, 0}, {0, 1}, {-1, -1}} end
  return {l1 * (2 * l1 - 1), l2 * (2 * l2 - 1), l3 * (2 * l3 - 1), 4 * l1 * l2, 4 * l2 * l3, 4 * l3 * l1},
    {{4 * l1 - 1, 0}, {0, 4 * l2 - 1}, {1 - 4 * l3, 1 - 4 * l3}, {4 * l2, 4 * l1},
      {-4 * l2, 4 * (l3 - l2)}, {4 * (l3 - l1), -4 * l1}}
end

--- Calls visit(x, y, weight, u, gradient) at the integration points of all elements, weight with the
--- area; u and gradient (of each component by x and y) are those of `field`, two values for each node.
function tools.integrate(mesh, field, visit)
  local order = mesh.order
  local points, values = mesh.points:totable(), field:totable()
  local tabled = {}
  for q, l in ipairs(rule) do
    local n, s = shape(order, l)
    tabled[q] = {n, s, l[4]}
  end
  for _, e in ipairs(mesh.elements:totable()) do
    for _, at in ipairs(tabled) do
      local n, s, w = at[1], at[2], at[3]
      local x, y, a, b, c, d = 0, 0, 0, 0, 0, 0
      local u, du = {0, 0}, {{0, 0}, {0, 0}}
      for k = 1, #e do
        local p, v = points[e[k]], values[e[k]]
        x, y = x + n[k] * p[1], y + n[k] * p[2]
        a, b = a + s[k][1] * p[1], b + s[k][2] * p[1]
        c, d = c + s[k][1] * p[2], d + s[k][2] * p[2]
        for i = 1, 2 do
          u[i] = u[i] + n[k] * v[i]
          du[i][1] = du[i][1] + s[k][1] * v[i]
          du[i][2] = du[i][2] + s[k][2] * v[i]
        end
      end
      local det = a * d - b * c
      local g = {}
      for i = 1, 2 do
        g[i] = {(du[i][1] * d - du[i][2] * c) / det, (du[i][2] * a - du[i][1] * b) / det}
      end
      visit(x, y, w * math.abs(det) / 2, u, g)
    end
  end
end

--- The root of a function between two places.
function tools.root(f, low, high)
  local at_low = f(low)
  for _ = 1, 200 do
    local midpoint = (low + high) / 2
    if midpoint == low or midpoint == high then break end
    if (f(midpoint) > 0) == (at_low > 0) then low = midpoint else high = midpoint end
  end
  return (low + high) / 2
end

return tools
