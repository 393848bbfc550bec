-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bodies as signed distance functions: their distances, fillets, shells, motions; volumes by closed forms.
local bw = require "barwright"
local shapes = bw.shapes

local pi, sqrt, cos, sin = math.pi, math.sqrt, math.cos, math.sin

-- The volume where f < 0 in a box, by midpoints of n^3 cells whose value is clipped to the width of a cell:
-- second order on smooth surfaces of distance functions.
local function volume(f, box, n)
  local h = {}
  for k = 1, 3 do h[k] = (box.max[k] - box.min[k]) / n end
  local width, sum = (h[1] * h[2] * h[3]) ^ (1 / 3), 0
  for i = 1, n do
    for j = 1, n do
      for k = 1, n do
        local d = f(box.min[1] + (i - 0.5) * h[1], box.min[2] + (j - 0.5) * h[2], box.min[3] + (k - 0.5) * h[3])
        sum = sum + math.max(0, math.min(1, 0.5 - d / width))
      end
    end
  end
  return sum * h[1] * h[2] * h[3]
end

local function near(expected, got, relative)
  assert.is_true(math.abs(got - expected) <= relative * math.abs(expected),
    ("%.6g expected, got %.6g"):format(expected, got))
end

-- The distance of random points by brute force over points of a surface of revolution about z.
local function profile_distance(points, x, y, z)
  local r, best = sqrt(x * x + y * y), math.huge
  for i = 1, #points - 1 do
    local p, q = points[i], points[i + 1]
    local dx, dz = q[1] - p[1], q[2] - p[2]
    local t = math.max(0, math.min(1, ((r - p[1]) * dx + (z - p[2]) * dz) / (dx * dx + dz * dz)))
    best = math.min(best, sqrt((r - p[1] - t * dx) ^ 2 + (z - p[2] - t * dz) ^ 2))
  end
  return best
end

describe("bodies by distance", function()
  it("give the distance of cylinders and cones to both sides", function()
    math.randomseed(7)
    local random = math.random
    for _, case in ipairs {{0.7, 0.7}, {0.8, 0.3}, {0.2, 0.9}, {0.6, 0}, {0, 0.6}} do
      local ra, rb = case[1], case[2]
      local top = {0, 0, 1.5}
      local body = ra == rb and shapes.cylinder({0, 0, 0}, top, ra) or shapes.cone({0, 0, 0}, top, ra, rb)
      local profile = {{0, 0}, {ra, 0}, {rb, 1.5}, {0, 1.5}}
      if ra == 0 then table.remove(profile, 2) elseif rb == 0 then table.remove(profile, 3) end
      for _ = 1, 300 do
        local x, y, z = random() * 3 - 1.5, random() * 3 - 1.5, random() * 3 - 0.75
        local d = body(x, y, z)
        assert.is_true(math.abs(math.abs(d) - profile_distance(profile, x, y, z)) < 1e-12)
        local inside = z > 0 and z < 1.5 and sqrt(x * x + y * y) < ra + (rb - ra) * z / 1.5
        assert.equal(inside, d < 0)
      end
    end
  end)

  it("have the volumes of closed forms", function()
    local box = {min = {-1.6, -1.6, -1.6}, max = {1.6, 1.6, 1.6}}
    near(2 * pi ^ 2 * 1 * 0.4 ^ 2, volume(shapes.torus({0, 0, 0}, {1, 2, 2}, 1, 0.4), box, 48), 2e-3)
    near(4 / 3 * pi * (1.3 ^ 3 - 1), volume(shapes.shell(shapes.sphere({0, 0, 0}, 1.3), 0.3), box, 48), 2e-3)
    near(4 / 3 * pi * 1.2 ^ 3, volume(shapes.offset(shapes.sphere({0, 0, 0}, 1), 0.2), box, 48), 2e-3)
    -- the lens of two balls of radius 1 at the distance 1: pi (4 r + d) (2 r - d)^2 / 12
    local lens = shapes.intersect {shapes.sphere({-0.5, 0, 0}, 1), shapes.sphere({0.5, 0, 0}, 1)}
    near(pi * 5 / 12, volume(lens, box, 64), 5e-3)
  end)

  it("round edges at right angles with arcs of the radius", function()
    local big = 10
    local floor = shapes.box({-big, -big, -big}, {big, big, 0})
    local wall = shapes.box({-big, -big, -big}, {0, big, big})
    local filleted, cut = shapes.fillet({floor, wall}, 0.5), shapes.cut(floor, wall, 0.5)
    local corner = shapes.intersect({floor, shapes.box({0, -big, -big}, {big, big, big})}, 0.5)
    for i = 0, 8 do
      local angle = i / 8 * pi / 2
      assert.is_true(math.abs(filleted(0.5 - 0.5 * cos(angle), 1, 0.5 - 0.5 * sin(angle))) < 1e-12)
      local x, z = 0.5 - 0.5 * cos(angle), -0.5 + 0.5 * sin(angle)
      assert.is_true(math.abs(cut(x, 1, z)) < 1e-12)
      assert.is_true(math.abs(corner(x, 1, z)) < 1e-12)
    end
    assert.is_true(filleted(0.1, 0, 0.1) < 0 and filleted(0.2, 0, 0.2) > 0)
    near((1 - pi / 4) * 0.25, volume(filleted, {min = {0, 0, 0}, max = {1, 1, 1}}, 60), 2e-2)
    assert.equal(shapes.cut(floor, wall)(3, 0, -1), shapes.cut(floor, wall, 0)(3, 0, -1))
  end)

  it("move without a change of distances", function()
    math.randomseed(11)
    local body = shapes.box({0.1, -0.2, 0}, {0.9, 0.3, 0.4})
    local axis, angle, about = {1, -2, 0.5}, 0.7, {0.3, 0.1, -0.2}
    local there = shapes.rotate(body, axis, angle, about)
    local back = shapes.rotate(there, axis, -angle, about)
    local mirrored = shapes.mirror(body, {1, 1, 0}, {0.2, 0, 0})
    local moved = shapes.translate(body, {1, 2, 3})
    for _ = 1, 100 do
      local x, y, z = math.random() * 2 - 1, math.random() * 2 - 1, math.random() * 2 - 1
      assert.is_true(math.abs(back(x, y, z) - body(x, y, z)) < 1e-12)
      assert.is_true(math.abs(moved(x + 1, y + 2, z + 3) - body(x, y, z)) < 1e-12)
      local d = x + y - 0.2
      assert.is_true(math.abs(mirrored(x - d, y - d, z) - body(x, y, z)) < 1e-12)
    end
    -- a quarter turn about z takes x to y
    assert.is_true(math.abs(shapes.rotate(body, {0, 0, 3}, pi / 2)(-0.1, 0.5, 0.2) - body(0.5, 0.1, 0.2)) < 1e-12)
  end)

  it("make a sound surface of a filleted shell", function()
    local post = shapes.cylinder({0, 0, 0}, {0, 0, 0.03}, 0.008)
    local foot = shapes.box({-0.02, -0.02, -0.006}, {0.02, 0.02, 0})
    local bore = shapes.cylinder({0, 0, -0.01}, {0, 0, 0.04}, 0.005)
    local body = shapes.cut(shapes.fillet({foot, post}, 0.004), bore, 0.001)
    local surface = assert(bw.surface.implicit(body, {min = {-0.022, -0.022, -0.008}, max = {0.022, 0.022, 0.032},
      cells = 60}))
    assert.is_true(surface:check().sound)
    -- foot, post and fillet of revolution (Pappus) less the bore and the two rounded edges of it
    local r, a = 0.004, 0.008
    local fillet = 2 * pi * ((1 - pi / 4) * r * r * a + r ^ 3 * (5 / 6 - pi / 4))
    local ring = 2 * pi * ((1 - pi / 4) * 0.001 ^ 2 * 0.005 + 0.001 ^ 3 * (5 / 6 - pi / 4))
    local expected = 0.04 * 0.04 * 0.006 + pi * a * a * 0.03 + fillet - pi * 0.005 ^ 2 * 0.036 - 2 * ring
    near(expected, surface.volume, 5e-3)
  end)

  it("refuse sizes and lists that make no body", function()
    for message, call in pairs {
      ["shapes.cylinder: radius: a finite length above 0 expected"] = function()
        shapes.cylinder({0, 0, 0}, {1, 0, 0}, 0)
      end,
      ["shapes.cylinder: a and b: a vector of a finite length above 0"] = function()
        shapes.cylinder({1, 0, 0}, {1, 0, 0}, 1)
      end,
      ["shapes.cone: ra, rb: one of the radii"] = function() shapes.cone({0, 0, 0}, {1, 0, 0}, 0, 0) end,
      ["shapes.fillet: radius"] = function() shapes.fillet({print}, -1) end,
      ["shapes.fillet: bodies: a list"] = function() shapes.fillet({}, 1) end,
      ["shapes.intersect: bodies: entry 2: a function expected"] = function() shapes.intersect {print, 3} end,
      ["shapes.shell: thickness"] = function() shapes.shell(print, 0) end,
      ["shapes.rotate: axis: a vector"] = function() shapes.rotate(print, {0, 0, 0}, 1) end,
    } do
      assert.error_matches(call, message, 1, true)
    end
  end)
end)
