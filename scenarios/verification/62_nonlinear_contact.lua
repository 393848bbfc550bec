-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Contact: a ball between two plates.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Nonlinear solids: contact",
  text = [[The force of plates without friction on a ball in cells that its surface cuts, each a twentieth of the
radius in; points of the surface touch. Beside Hertz's theory with Tatara's correction for the other plate.]]}

local YOUNG, POISSON, RADIUS = 1e6, 0.3, 1

-- An eighth of the ball, cells cut by its surface; the plate comes down on what of the surface is near.
local function squeezed(cells, depth)
  local ball = assert(bw.surface.sphere {radius = RADIUS, subdivisions = 5})
  local grid = assert(bw.grid.voxels(ball, {spacing = RADIUS / cells, material = function(x, y, z)
    return x > 0 and y > 0 and z > 0 and 1 or 0
  end}))
  local points, kept, number, triangles = ball.points:totable(), {}, {}, {}
  for _, t in ipairs(ball.triangles:totable()) do
    local near = true
    for _, n in ipairs(t) do
      local p = points[n]
      near = near and p[1] > -1e-9 and p[2] > -1e-9 and p[3] > 0.6 * RADIUS
    end
    if near then
      local own = {}
      for k, n in ipairs(t) do
        if not number[n] then
          kept[#kept + 1] = points[n]
          number[n] = #kept
        end
        own[k] = number[n]
      end
      triangles[#triangles + 1] = own
    end
  end
  local cap = assert(bw.surface.new {points = kept, triangles = triangles})
  local solid = assert(bw.solid {grid = grid,
    materials = {bw.hyperelastic {law = "neo_hookean", young = YOUNG, poisson = POISSON, density = 1000}}})
  solid:fix({plane = {{0, 0, 0}, {1, 0, 0}}}, {0, false, false})
  solid:fix({plane = {{0, 0, 0}, {0, 1, 0}}}, {false, 0, false})
  solid:fix({plane = {{0, 0, 0}, {0, 0, 1}}}, {false, false, 0})
  solid:contact_plane {point = {0, 0, RADIUS}, normal = {0, 0, -1}, move = {0, 0, -depth}, surface = cap}
  local result = assert(solid:solve {tolerance = 1e-6})
  local force = 4 * result:total_reaction({plane = {{0, 0, 0}, {0, 0, 1}}})[3]
  return force, result.newton
end

-- Hertz, less what the force of the other plate moves at this one, by Boussinesq's half-space (Tatara).
local function theory(depth)
  local low, high = 0, 10 * YOUNG * depth ^ 1.5
  for _ = 1, 100 do
    local force = (low + high) / 2
    local a = (3 * (1 - POISSON ^ 2) * force * RADIUS / (4 * YOUNG)) ^ (1 / 3)
    local away = math.sqrt(4 * RADIUS ^ 2 + a ^ 2)
    local d = a ^ 2 / RADIUS - force / (math.pi * YOUNG)
      * (2 * (1 + POISSON) * RADIUS ^ 2 / away ^ 3 + (1 - POISSON ^ 2) / away)
    if d < depth then low = force else high = force end
  end
  return low
end

local function check(cells, allowed)
  local depth = 0.05 * RADIUS
  expect(squeezed(cells, depth) / theory(depth), ("force over theory, %d cells along the radius"):format(cells))
    :near(1, {relative = allowed, source = "Hertz, Tatara"})
end

scenario("A ball between plates", {tags = {"slow"}, seconds = 1800}, function()
  check(8, 0.1)
  check(16, 0.03)
end)

scenario("A ball between plates, finer", {tags = {"slow", "long"}, seconds = 7200}, function() check(24, 0.03) end)
