-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A round bar in a grid that does not follow its side, twisted and bent a little: Saint-Venant, Timoshenko.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

local YOUNG, POISSON, RADIUS, LENGTH = 1e6, 0.3, 0.05, 0.4

scenario.about {title = "Nonlinear solids: round bars in cubes", text = ("A cylinder %g times as long as thick, "
  .. "in cubes that its side cuts; both ends fixed flat. Sections do not warp under torsion, so its stiffness is "
  .. "exact in the limit; bending is Timoshenko's, with Cowper's shear factor, and an end that cannot bulge.")
  :format(LENGTH / (2 * RADIUS))}

-- The bar upright in cells of the height that its radius is cut into.
local function bar(cells)
  local surface = assert(bw.surface.cylinder {base = {0, 0, 0}, axis = {0, 0, LENGTH}, radius = RADIUS,
    segments = 96})
  local grid = assert(bw.grid.voxels(surface, {spacing = RADIUS / cells}))
  return assert(bw.solid {grid = grid,
    materials = {bw.hyperelastic {law = "corotated", young = YOUNG, poisson = POISSON, density = 1000}}})
end

local function twisted(cells)
  local solid, angle = bar(cells), 0.01
  solid:fix {side = "min z"}
  solid:rotate({side = "max z"}, {axis = {0, 0, 1}, angle = math.deg(angle)})
  local result = assert(solid:solve {tolerance = 1e-8})
  local nodes = solid.grid:nodes {side = "max z"}
  local at, by = solid.grid.points:gather(nodes):totable(), result.reaction:gather(nodes):totable()
  local torque = 0
  for i, x in ipairs(at) do torque = torque + x[1] * by[i][2] - x[2] * by[i][1] end
  local height = at[1][3] - solid.grid.points:column(3):min()
  local shear = YOUNG / (2 * (1 + POISSON))
  return torque / (shear * math.pi / 2 * RADIUS ^ 4 * angle / height)
end

local function deflection(cells)
  local solid, force = bar(cells), 1e-3
  solid:fix {side = "min z"}
  solid:force({side = "max z"}, {force, 0, 0})
  local result = assert(solid:solve {tolerance = 1e-8})
  local nodes = solid.grid:nodes {side = "max z"}
  local tip = result.displacement:gather(nodes):column(1):mean()
  local z = solid.grid.points:column(3)
  local height = z:max() - z:min()
  local area, inertia = math.pi * RADIUS ^ 2, math.pi / 4 * RADIUS ^ 4
  local shear, factor = YOUNG / (2 * (1 + POISSON)), 6 * (1 + POISSON) / (7 + 6 * POISSON)
  return tip / (force * height ^ 3 / (3 * YOUNG * inertia) + force * height / (factor * shear * area))
end

local function check(cells, allowed)
  expect(twisted(cells), ("torque over Saint-Venant's, %d cells along the radius"):format(cells))
    :near(1, {relative = allowed, source = "Saint-Venant"})
  expect(deflection(cells), ("deflection over Timoshenko's, %d cells along the radius"):format(cells))
    :near(1, {relative = allowed, source = "Timoshenko, Cowper"})
end

scenario("Round bars in cubes", {tags = {"slow"}}, function()
  check(3, 0.25)
  check(6, 0.08)
end)

scenario("Round bars in smaller cubes", {tags = {"slow", "long"}, seconds = 3600}, function() check(9, 0.05) end)
