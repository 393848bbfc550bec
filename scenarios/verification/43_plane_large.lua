-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Slender cantilevers that bend largely, beside the elastica: no Poisson effect, a hundredth thick.
local bw = require "barwright"
local tools = require "tools"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Sheets: large deflections",
  text = [[Cantilevers a hundredth as thick as long, of triangles with six nodes, beside the elastica.]]}

local LENGTH, HEIGHT, YOUNG = 1, 0.01, 1.2e7
local STIFFNESS = YOUNG * HEIGHT ^ 3 / 12

-- x, y of the tip of theta'' = -(force + weight (1 - s)) cos theta, theta(0) = 0, theta'(1) = 0, by
-- shooting, in units of the length and of E I / L^2; loads act downwards.
local function elastica(force, weight)
  local function shoot(curvature)
    local n, theta, slope, x, y = 2000, 0, curvature, 0, 0
    local h = 1 / n
    local function rates(s, t, k)
      return k, (force + weight * (1 - s)) * math.cos(t), math.cos(t), math.sin(t)
    end
    for i = 0, n - 1 do
      local s = i * h
      local a1, b1, c1, d1 = rates(s, theta, slope)
      local a2, b2, c2, d2 = rates(s + h / 2, theta + h / 2 * a1, slope + h / 2 * b1)
      local a3, b3, c3, d3 = rates(s + h / 2, theta + h / 2 * a2, slope + h / 2 * b2)
      local a4, b4, c4, d4 = rates(s + h, theta + h * a3, slope + h * b3)
      theta = theta + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
      slope = slope + h / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
      x = x + h / 6 * (c1 + 2 * c2 + 2 * c3 + c4)
      y = y + h / 6 * (d1 + 2 * d2 + 2 * d3 + d4)
    end
    return slope, x, y
  end
  -- the moment at the root lies between none and that of the straight beam
  local low, high = -(force + weight / 2), 0
  local root = tools.root(function(k) return (shoot(k)) end, low, high)
  return select(2, shoot(root))
end

local function beam(order, more)
  local options = {outline = assert(bw.outline.rectangle {min = {0, -HEIGHT / 2}, max = {LENGTH, HEIGHT / 2},
    tags = {left = 4, right = 2}}), order = order, size = HEIGHT, material = tools.elastic(YOUNG, 0, 1000),
    conditions = {left = "fixed"}}
  for key, value in pairs(more) do options[key] = value end
  local s = assert(bw.responsive.cantilever(options))
  -- the middle of the end, between its corners
  local a, b = tools.node(s, LENGTH, -HEIGHT / 2), tools.node(s, LENGTH, HEIGHT / 2)
  local u = s.displacement
  return -(u(a, 2) + u(b, 2)) / 2 / LENGTH, -(u(a, 1) + u(b, 1)) / 2 / LENGTH
end

local published = { -- P L^2 / E I: w / L, u / L
  {1, 0.30172077, 0.05643324}, {2, 0.49345748, 0.16064172}, {4, 0.66996418, 0.32894124},
  {10, 0.81060902, 0.55499560},
}

scenario("Cantilever under an end load, large deflection", {tags = {"slow"}}, function()
  for _, line in ipairs(published) do
    local load, w, u = table.unpack(line)
    local deflection, shortening = beam(2, {conditions = {left = "fixed",
      right = {traction = {0, -load * STIFFNESS / LENGTH ^ 2 / HEIGHT}}}})
    local source = "Mattiasson 1981; elliptic integrals"
    expect(deflection, ("P L^2 / E I = %g: deflection / L"):format(load))
      :near(w, {relative = 0.002, source = source})
    expect(shortening, ("P L^2 / E I = %g: shortening / L"):format(load))
      :near(u, {relative = 0.004, source = source})
    -- the shooting that weights are compared with, on the same table
    local _, y = elastica(load, 0)
    expect(-y, ("P L^2 / E I = %g: deflection / L by shooting"):format(load))
      :near(w, {relative = 1e-6, source = source})
  end
end)

scenario("Cantilever under its own weight, large deflection", {tags = {"slow"}}, function()
  for _, load in ipairs {1, 5, 20, 60} do
    local deflection, shortening = beam(2, {gravity = {0, -load * STIFFNESS / (LENGTH ^ 3 * 1000 * HEIGHT)}})
    local x, y = elastica(0, load)
    expect(deflection, ("q L^3 / E I = %g: deflection / L"):format(load))
      :near(-y, {relative = 0.002, source = "elastica by shooting"})
    expect(shortening, ("q L^3 / E I = %g: shortening / L"):format(load))
      :near(1 - x, {relative = 0.004, source = "elastica by shooting"})
  end
end)
