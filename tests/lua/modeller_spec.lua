-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The solid modeller: volumes in closed form, soundness and names of faces.
local bw = require "barwright"
local check = require "check"

local pi = math.pi

-- A sound surface with exactly these names of faces, in any order.
local function sound(made, names)
  local surface = assert(made)
  local report = surface:check {limit = 3}
  assert.is_true(report.sound, tostring(report))
  if names then
    local have = surface:face_names()
    table.sort(have)
    table.sort(names)
    assert.same(names, have)
  end
  return surface
end

-- Area of the triangles of each name.
local function area_of(surface, name)
  local names, area = surface:face_names(), 0
  for t, corner in ipairs(surface.triangles:totable()) do
    if names[surface.groups[t]] == name then
      local p = {}
      for k = 1, 3 do p[k] = surface.points[corner[k]] end
      local u, v = {}, {}
      for k = 1, 3 do u[k], v[k] = p[2][k] - p[1][k], p[3][k] - p[1][k] end
      area = area + math.sqrt((u[2] * v[3] - u[3] * v[2]) ^ 2 + (u[3] * v[1] - u[1] * v[3]) ^ 2
        + (u[1] * v[2] - u[2] * v[1]) ^ 2) / 2
    end
  end
  return area
end

-- Area of a regular polygon with its corners on a circle.
local function polygon_area(n, radius) return n / 2 * radius ^ 2 * math.sin(2 * pi / n) end

describe("a primitive", function()
  it("has its volume in closed form and named faces", function()
    local box = sound(bw.surface.box {min = {-1, 0, 2}, max = {2, 1, 4}},
      {"left", "right", "front", "back", "bottom", "top"})
    check.near(6, box.volume, 1e-12)
    check.near(2, area_of(box, "left"), 1e-12)
    check.near(6, area_of(box, "front"), 1e-12)
    check.near(3, area_of(box, "top"), 1e-12)
    local rod = sound(bw.surface.cylinder {axis = {0, 3, 4}, radius = 2, segments = 10},
      {"bottom", "top", "side"})
    check.near(5 * polygon_area(10, 2), rod.volume, 1e-12)
    check.near(polygon_area(10, 2), area_of(rod, "top"), 1e-12)
    sound(bw.surface.sphere {radius = 1}, {"sphere"})
    local cone = sound(bw.surface.cone {base = {1, 2, 3}, axis = {3, 0, -4}, radius = 2, segments = 9},
      {"bottom", "side"})
    check.near(5 / 3 * polygon_area(9, 2), cone.volume, 1e-12)
    local frustum = sound(bw.surface.cone {axis = {0, 0, 2}, radius = 1, top_radius = 3, segments = 7},
      {"bottom", "top", "side"})
    check.near(2 / 3 * (1 + 3 + 9) * polygon_area(7, 1), frustum.volume, 1e-12)
    local point_down = sound(bw.surface.cone {axis = {0, 0, 2}, radius = 0, top_radius = 3, segments = 7})
    check.near(2 / 3 * 9 * polygon_area(7, 1), point_down.volume, 1e-12)
    local nut = sound(bw.surface.prism {axis = {0, 0, -2}, radius = 1.5, sides = 6},
      {"bottom", "top", "side 1", "side 2", "side 3", "side 4", "side 5", "side 6"})
    check.near(2 * polygon_area(6, 1.5), nut.volume, 1e-12)
    for i = 1, 6 do check.near(3, area_of(nut, "side " .. i), 1e-12) end
  end)

  it("of a torus has n sin(2 pi / n) R A", function()
    local made = bw.surface.torus {centre = {1, 1, 1}, axis = {1, 2, 2}, radius = 3, tube = 1, segments = 24}
    local ring = sound(made, {"torus"})
    check.near(24 * math.sin(2 * pi / 24) * 3 * polygon_area(24, 1), ring.volume, 1e-12)
  end)

  it("keeps a tolerance", function()
    for _, tolerance in ipairs {0.3, 0.03, 0.002} do
      local rod = bw.surface.cylinder {axis = {0, 0, 1}, radius = 2, tolerance = tolerance}
      local sides = rod.triangle_count // 4
      assert.is_true(2 * (1 - math.cos(pi / sides)) <= tolerance * (1 + 1e-9))
      assert.is_true(sides == 3 or 2 * (1 - math.cos(pi / (sides - 1))) > tolerance)
      local ball = bw.surface.sphere {radius = 2, tolerance = tolerance}
      local largest = 0
      for _, corner in ipairs(ball.triangles:totable()) do
        local m = {0, 0, 0}
        for k = 1, 3 do
          for i = 1, 3 do m[k] = m[k] + ball.points[corner[i]][k] / 3 end
        end
        largest = math.max(largest, 2 - math.sqrt(m[1] ^ 2 + m[2] ^ 2 + m[3] ^ 2))
      end
      assert.is_true(largest <= tolerance and largest > tolerance / 8, largest)
      local plate = bw.surface.extrude(bw.outline.circle {radius = 2}, {height = 1, tolerance = tolerance,
        curvature = 90})
      for _, p in ipairs(plate.points:totable()) do check.near(2, math.sqrt(p[1] ^ 2 + p[2] ^ 2), 1e-5) end
      local short = pi * 4 - plate.volume -- chords within the tolerance: A - 4 pi t at least
      assert.is_true(short > 0 and short <= 4 * pi * tolerance)
    end
    assert.error_matches(function() bw.surface.cylinder {axis = {0, 0, 1}, radius = 1, tolerance = 0} end,
      "option 'tolerance'")
    assert.error_matches(function() bw.surface.sphere {radius = 1, tolerance = 0.1, subdivisions = 2} end,
      "not both")
  end)
end)

-- A profile with a hole and tags: an L.
local function profile()
  local hole = {{0.4, 0.4}, {0.4, 0.8}, {0.8, 0.8}, {0.8, 0.4}, name = "bore"}
  return assert(bw.outline {points = {{0.2, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0.2, 2}},
    tags = {below = 1, inside = 6}, holes = {hole}})
end

describe("an outline", function()
  it("extruded has area times height, with its tags", function()
    local solid = sound(bw.surface.extrude(profile(), {height = 0.5}),
      {"start", "end", "below", "inside", "boundary", "bore"})
    check.near(0.5 * (2.8 + 0.8 - 0.16), solid.volume, 1e-12)
    check.near(2.8 * 0.5, area_of(solid, "below"), 1e-12)
    check.near(1.6 * 0.5, area_of(solid, "bore"), 1e-12)
    check.near(2.8 + 0.8 - 0.16, area_of(solid, "start"), 1e-12)
    assert.equal(4 * 10 - 4 + 4, solid.triangle_count) -- no points but the corners: 2 caps of 10 + 2 - 2, 20 sides
  end)

  it("revolved has n sin(angle / n) times the moment of its area", function()
    local area = 2.8 + 0.8 - 0.16
    local moment = 2.8 * 1.6 + 0.8 * 0.6 - 0.16 * 0.6
    local wheel = sound(bw.surface.revolve(profile(), {segments = 20}), {"below", "inside", "boundary", "bore"})
    check.near(20 * math.sin(2 * pi / 20) * moment, wheel.volume, 1e-12)
    local part = sound(bw.surface.revolve(profile(), {angle = 2, segments = 22}),
      {"below", "inside", "boundary", "bore", "start", "end"})
    local steps = math.ceil(22 * 2 / (2 * pi))
    check.near(steps * math.sin(2 / steps) * moment, part.volume, 1e-12)
    check.near(area, area_of(part, "end"), 1e-12)
    for _, p in ipairs(part.points:totable()) do assert.is_true(p[2] >= -1e-15) end -- right-handed about z
  end)

  it("that touches its axis gives a solid without a bore", function()
    local cone = sound(bw.surface.revolve(bw.outline.polygon {{0, 0}, {2, 0}, {0, 3}}, {segments = 12}))
    check.near(3 / 3 * polygon_area(12, 2), cone.volume, 1e-12)
    local half = bw.outline {{0, -1}, {1, -1}, {1, 1}, {0, 1}}
    check.near(2 * polygon_area(16, 1), sound(bw.surface.revolve(half, {segments = 16})).volume, 1e-12)
    check.near(pi / 2, sound(bw.surface.revolve(half, {angle = pi / 2, tolerance = 1e-4})).volume, 1e-3)
    local disc = bw.outline.circle {centre = {2, 0}, radius = 1}
    for _, tolerance in ipairs {1e-30, 1e-12} do
      assert.error_matches(function() bw.surface.revolve(disc, {tolerance = tolerance}) end, "100000 sides")
    end
    assert.error_matches(function() bw.surface.revolve(bw.outline.circle {radius = 1}) end,
      "turns about its y axis")
  end)

  it("swept about its centroid has area times length, whatever the corners", function()
    local bar = bw.outline.rectangle {width = 0.2, height = 0.4, centre = {0, 0}}
    local path = {{0, 0, 0}, {0, 0, 2}, {2, 0, 3}, {2, 3, 3}, {4, 4, 4}}
    local length = 2 + math.sqrt(5) + 3 + math.sqrt(6)
    local solid = sound(bw.surface.sweep(bar, {path = path}), {"start", "end", "boundary"})
    check.near(0.08 * length, solid.volume, 1e-12)
    check.near(0.08, area_of(solid, "end"), 1e-12)
    local round = {{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}}
    local frame = sound(bw.surface.sweep(bar, {path = round, closed = true}), {"boundary"})
    check.near(0.08 * 10, frame.volume, 1e-12)
    check.near(0.4, frame.box.max[3] - frame.box.min[3], 1e-12) -- the y axis of the outline points up
  end)

  it("swept along a curve follows it", function()
    local wire = bw.outline.circle {radius = 0.1}
    local turns, rise, radius = 2, 1, 2
    local function helix(t)
      return {radius * math.cos(turns * 2 * pi * t), radius * math.sin(turns * 2 * pi * t), turns * rise * t}
    end
    local spring = sound(bw.surface.sweep(wire, {path = helix, segments = 200}))
    local length = turns * math.sqrt((2 * pi * radius) ^ 2 + rise ^ 2)
    check.near(pi * 0.01 * length, spring.volume, 0.03) -- the chords of wire and path
    local function knot(t) -- not plane: what the frame turns is spread along the path
      local a = 2 * pi * t
      return {2 * math.cos(a), 2 * math.sin(a), 0.7 * math.sin(2 * a)}
    end
    local bar = bw.outline.rectangle {width = 0.1, height = 0.3, centre = {0, 0}}
    sound(bw.surface.sweep(bar, {path = knot, segments = 120, closed = true}), {"boundary"})
  end)

  it("lofted has the volume of a frustum", function()
    local function square(side) return bw.outline.rectangle {width = side, height = side, centre = {0, 0}} end
    local solid = sound(bw.surface.loft({square(4), square(2), square(3)}, {heights = {0, 3, 5}}),
      {"start", "end", "boundary"})
    check.near(3 * (16 + 4 + 8) / 3 + 2 * (4 + 9 + 6) / 3, solid.volume, 1e-12)
    local ring = bw.outline.circle {radius = 2, holes = {bw.outline.circle {radius = 1}}}
    local slim = bw.outline.circle {radius = 1.5, holes = {bw.outline.circle {radius = 0.5}}}
    local tube = sound(bw.surface.loft({ring, slim}, {heights = {1, 2}, tolerance = 1e-4}))
    check.near(pi / 3 * (4 + 2.25 + 3 - 1 - 0.25 - 0.5), tube.volume, 1e-3)
    local adapter = sound(bw.surface.loft({square(4), bw.outline.circle {radius = 2}}, {heights = {0, 1}}))
    assert.is_true(adapter.volume > pi * 4 * 0.97 and adapter.volume < 16)
    assert.error_matches(function() bw.surface.loft({square(1), ring}, {heights = {0, 1}}) end, "loops")
    assert.error_matches(function() bw.surface.loft({nil, ring}, {heights = {0, 1}}) end, "outline 1: an outline")
    assert.error_matches(function() bw.surface.loft({square(1), square(2)}, {heights = {1, 0}}) end, "ascending")
  end)

  it("gets arcs at its corners", function()
    local corner = {{0, 0}, {0.1, 0}, {0.1, 0.01}, {0.01, 0.01}, {0.01, 0.08}, {0, 0.08}}
    local outline = assert(bw.outline(corner))
    local one = assert(outline:fillet(0.005, {vertices = 4, tag = "root"}))
    check.near(outline.area + 0.005 ^ 2 * (1 - pi / 4), one.area, 1e-6)
    sound(bw.surface.extrude(one, {height = 0.02}), {"start", "end", "boundary", "root"})
    local all = assert(outline:fillet(0.005)) -- arcs at the ends of the arms meet
    check.near(outline.area - 4 * 0.005 ^ 2 * (1 - pi / 4), all.area, 1e-6)
    local hexagon = {}
    for i = 1, 6 do hexagon[i] = {math.cos(i * pi / 3), math.sin(i * pi / 3)} end
    local round = assert(bw.outline.polygon(hexagon):fillet(0.2))
    check.near(polygon_area(6, 1) - 6 * 0.04 * (math.tan(pi / 6) - pi / 6), round.area, 1e-6)
    local disc = assert(bw.outline.polygon(hexagon):fillet(math.sqrt(0.75))) -- the inscribed circle
    check.near(0.75 * pi, disc.area, 1e-5)
    assert.error_matches(function() outline:fillet(0.0051) end, "a smaller radius expected")
    assert.error_matches(function() outline:fillet(0.001, {vertices = 7}) end, "numbers from 1 to 6")
  end)
end)

describe("a section of a solid", function()
  local function square(min, max) return {{min, min}, {max, min}, {max, max}, {min, max}} end

  it("has islands in its holes, and no walls between regions", function()
    local outline = assert(bw.outline {points = square(0, 4), holes = {square(1, 3)},
      regions = {square(1.5, 2.5), square(0.2, 0.8)}})
    local solid = sound(bw.surface.extrude(outline, {height = 0.5}))
    check.near(0.5 * (16 - 4 + 1), solid.volume, 1e-12)
    check.near(2 * (16 - 4 + 1) + 0.5 * (16 + 8 + 4), solid.area, 1e-12)
  end)

  it("revolved by less than a turn goes from the outline to the side where its z axis turns to", function()
    -- The outline's y axis is z: a right-handed turn takes x to y.
    local slice = sound(bw.surface.revolve(bw.outline.rectangle {min = {1, 0}, max = {2, 1}}, {angle = pi / 2,
      segments = 40}), {"start", "end", "boundary"})
    for k, value in ipairs {0, 0, 0} do check.near(value + 1, slice.box.min[k] + 1, 1e-12) end
    for k, value in ipairs {2, 2, 1} do check.near(value, slice.box.max[k], 1e-12) end
  end)

  it("on a tolerance has sides that stay within it, and not many more", function()
    local outline = bw.outline.circle {radius = 2}
    for _, tolerance in ipairs {0.1, 0.01, 1e-3} do
      local wheel = assert(bw.surface.torus {radius = 3, tube = 1, tolerance = tolerance})
      local steps = #wheel.points / math.max(3, math.ceil(pi / math.acos(1 - tolerance)))
      assert.is_true(4 * (1 - math.cos(pi / steps)) <= tolerance * (1 + 1e-9), steps) -- at its widest
      local wall = assert(bw.surface.extrude(outline, {height = 1, tolerance = tolerance, curvature = 90}))
      local sides = #wall.points / 2
      local off = 2 * (1 - math.cos(pi / sides))
      assert.is_true(off <= tolerance and (off > tolerance / 4 or sides <= 8), ("%d sides"):format(sides))
    end
    -- By default a side turns by at most 20 degrees: 3 sides for each of 8 arcs of 45 degrees.
    assert.equal(8, #outline.loops == 1 and outline.loops[1].count)
    assert.equal(24, #assert(bw.surface.extrude(outline, {height = 1})).points / 2)
  end)

  it("of a prism has sides numbered counter-clockwise about the axis, from x where it is z", function()
    local axis = {1 / 3, 2 / 3, 2 / 3}
    for _, way in ipairs {{0, 0, 1}, axis} do
      local nut, middles = sound(bw.surface.prism {axis = way, radius = 1, sides = 5}), {}
      local names = nut:face_names()
      for t, corners in ipairs(nut.triangles:totable()) do
        local side = tonumber(names[nut.groups[t]]:match "^side (%d)$")
        if side then
          middles[side] = middles[side] or {0, 0, 0}
          for _, c in ipairs(corners) do
            for k = 1, 3 do middles[side][k] = middles[side][k] + nut.points[c][k] - way[k] / 2 end
          end
        end
      end
      for i = 1, 5 do
        local a, b = middles[i], middles[i % 5 + 1]
        local turn = way[1] * (a[2] * b[3] - a[3] * b[2]) + way[2] * (a[3] * b[1] - a[1] * b[3])
          + way[3] * (a[1] * b[2] - a[2] * b[1])
        assert.is_true(turn > 0)
      end
      if way[3] == 1 then check.near(pi / 5, math.atan(middles[1][2], middles[1][1]), 1e-9) end
    end
  end)

  it("swept along a closed curve is not twisted where it closes, and does not turn back", function()
    local count = 60
    local function knot(t)
      local a = 2 * pi * t
      local far = 2 + 0.5 * math.cos(2 * a)
      return {far * math.cos(a), far * math.sin(a), 0.5 * math.sin(2 * a)}
    end
    local bar = bw.outline.rectangle {width = 0.1, height = 0.6, centre = {0, 0}}
    local points = sound(bw.surface.sweep(bar, {path = knot, segments = count, closed = true})).points:totable()
    assert.equal(4 * count, #points)
    for i = 0, count - 1 do
      local from, to = knot(i / count), knot((i + 1) / count)
      for k = 1, 4 do -- the corners of a section go as far as its place does, but for the bend
        local a, b, off = points[4 * i + k], points[4 * ((i + 1) % count) + k], 0
        for j = 1, 3 do off = off + (b[j] - a[j] - to[j] + from[j]) ^ 2 end
        assert.is_true(math.sqrt(off) < 0.1, ("section %d: %g"):format(i + 1, math.sqrt(off)))
      end
    end
    local path = {{0, 0, 0}, {1, 0, 0}, {1 - math.cos(pi / 36), math.sin(pi / 36), 0}}
    assert.error_matches(function() bw.surface.sweep(bar, {path = path}) end, "turns back at place 2")
  end)

  it("lofted between unlike outlines keeps the corners of both", function()
    local hexagon = {}
    for i = 1, 6 do -- its first corner lies beside the second one of the rectangle
      local angle = -math.atan(1.4, 1.5) + 0.03 + (i - 1) * pi / 3
      hexagon[i] = {2 * math.cos(angle), 2 * math.sin(angle)}
    end
    local low, high = bw.outline.polygon(hexagon), bw.outline.rectangle {width = 3, height = 2.8, centre = {0, 0}}
    local solid = sound(bw.surface.loft({low, high}, {heights = {0, 1}}), {"start", "end", "boundary"})
    check.near(low.area, area_of(solid, "start"), 1e-12)
    check.near(high.area, area_of(solid, "end"), 1e-12)
    -- A point for each corner of either; the loops begin at a corner of each,
    -- and so have two of them in common.
    assert.equal(2 * (6 + 4 - 2), #solid.points)
  end)
end)

describe("a copy", function()
  it("that touches the one before is joined to it", function()
    local row = sound(bw.surface.box {max = {1, 1, 1}}:linear_array {count = 3, step = {1, 0, 0}})
    check.near(3, row.volume, 1e-12)
    check.near(2 * (1 + 3 + 3), row.area, 1e-12)
    local steps = sound(bw.surface.box {max = {1, 1, 1}}:linear_array {count = 3, step = {0.5, 2, 3}})
    for k, value in ipairs {2, 5, 7} do check.near(value, steps.box.max[k], 1e-12) end
  end)

  it("in a ring turns about the centre, by equal angles of a whole turn", function()
    local bolt = bw.surface.cylinder {base = {5, 1, 0}, axis = {0, 0, 1}, radius = 0.2, segments = 8}
    local ring = sound(bolt:polar_array {count = 4, centre = {3, 1, 0}})
    check.near(4 * polygon_area(8, 0.2), ring.volume, 1e-12)
    for k, value in ipairs {0.8, -1.2, 0} do check.near(value + 9, ring.box.min[k] + 9, 1e-12) end
    for k, value in ipairs {5.2, 3.2, 1} do check.near(value, ring.box.max[k], 1e-12) end
  end)

  it("is mirrored and put into rows and rings", function()
    local solid = assert(bw.surface.extrude(profile(), {height = 0.5}))
    local image = sound(solid:mirror({1, 0, 0}, {-1, 0, 0}), solid:face_names())
    check.near(solid.volume, image.volume, 1e-12)
    check.near(-5, image.box.min[1], 1e-12)
    check.near(-2.2, image.box.max[1], 1e-12)
    local row = sound(bw.surface.box {max = {1, 1, 1}}:linear_array {count = 4, step = {0, 0, 2}})
    check.near(4, row.volume, 1e-12)
    check.near(4, area_of(row, "top"), 1e-12)
    local bar = sound(bw.surface.box {max = {1, 1, 1}}:linear_array {count = 4, step = {0.75, 0, 0}})
    check.near(1 + 3 * 0.75, bar.volume, 1e-9)
    local holes = sound(bw.surface.cylinder {base = {3, 0, 0}, axis = {0, 0, 1}, radius = 0.5, segments = 12}
      :polar_array {count = 5})
    check.near(5 * polygon_area(12, 0.5), holes.volume, 1e-12)
    local blade = bw.surface.box {min = {-1, -0.1, 0}, max = {1, 0.1, 1}}
    local fan = sound(blade:polar_array {count = 2, angle = pi / 2})
    check.near(0.4 + 0.4 - 0.04, fan.volume, 1e-9)
  end)
end)

-- A plate with a named hole.
local function plate()
  local drill = bw.surface.cylinder {base = {0.02, 0.02, -0.01}, axis = {0, 0, 0.03}, radius = 0.006,
    segments = 24}
  return assert(bw.surface.box {max = {0.04, 0.04, 0.01}}:difference(drill:named "bolt hole"))
end

local ROUND = 2 * 24 * 0.006 * math.sin(pi / 24) * 0.01
local TOP = 0.04 ^ 2 - polygon_area(24, 0.006)

local function has_names(mesh, round, top)
  check.near(ROUND, mesh.boundary:face("bolt hole").area, round or 0.02)
  check.near(TOP, mesh.boundary:face("top").area, top or 0.02)
  check.near(0.0004, mesh.boundary:face("left").area, 1e-6)
end

describe("a name of a face", function()
  it("survives changes of the surface", function()
    local part = plate()
    local moved = assert(assert(part:rotate({1, 1, 0}, 0.3)):translate {1, 2, 3})
    check.near(TOP, area_of(assert(moved:scale(2)), "top") / 4, 1e-9)
    local fine = assert(part:remesh {edge_length = 0.004})
    check.near(ROUND, area_of(fine, "bolt hole"), 0.02)
    check.near(TOP, area_of(fine, "top"), 0.02)
    -- A triangle taken out of the top is a hole that repair fills.
    local triangles, groups = part.triangles:totable(), part.groups:totable()
    for t = #triangles, 1, -1 do
      if part:face_names()[groups[t]] == "top" then
        table.remove(triangles, t)
        table.remove(groups, t)
        break
      end
    end
    local torn = assert(bw.surface.new {points = part.points, triangles = triangles, groups = groups,
      face_names = part:face_names()})
    local repaired = sound((torn:repair()))
    check.near(TOP, area_of(repaired, "top"), 1e-9)
    check.near(ROUND, area_of(repaired, "bolt hole"), 1e-9)
    assert.same({"a"}, part:named("a"):face_names())
    check.near(TOP, area_of(part:named("lid", "top"), "lid"), 1e-9)
    assert.error_matches(function() part:named("lid", "roof") end, "no face has the name 'roof'")
  end)

  it("is on the mesh, and on meshes made from it", function()
    local part = plate()
    local mesh = assert(bw.mesh.fill(part, {edge_length = 0.004, order = 2}))
    has_names(mesh)
    assert.same(part:face_names(), mesh:face_names())
    check.near(part:face_on(mesh, "top").area, mesh.boundary:face("top").area, 1e-12)
    has_names(assert(mesh:with_order(1)))
    has_names((assert(mesh:renumbered())))
    local nodes = mesh.nodes:totable()
    for _, x in ipairs(nodes) do x[3] = x[3] + 0.1 * x[1] end
    has_names(assert(mesh:moved(nodes)), 0.05, 0.05)
    local tags = {}
    for e = 1, mesh.element_count do tags[e] = e % 2 + 1 end
    has_names(assert(mesh:with_regions(tags)))
    check.near(TOP, area_of(mesh:surface(), "top"), 0.02)
    local keep = {}
    for e, corners in ipairs(mesh.elements:totable()) do
      local x = 0
      for k = 1, 4 do x = x + mesh.nodes[corners[k]][1] / 4 end
      keep[e] = x > 0.02 and 1 or 0
    end
    local half = assert(mesh:subset(bw.array.new(keep)))
    check.near(ROUND / 2, half.boundary:face("bolt hole").area, 0.15)
    assert.error_matches(function() return half.boundary:face "left" end, "no face 'left'")
    assert.error_matches(function() return mesh.boundary:face "lefd" end, "'bolt hole'")
    assert.is_true(mesh.boundary:face("plane 1").area > 0) -- faces that are found have names too
  end)

  it("is on meshes of several parts", function()
    local low = bw.surface.box {max = {1, 1, 1}}
    local high = bw.surface.box {min = {0, 0, 1}, max = {1, 1, 2}}:named("lid", "top")
    local mesh = assert(bw.mesh.fill_parts({low = low, high = high}, {edge_length = 0.5}))
    check.near(1, mesh.boundary:face("lid").area, 1e-12)
    check.near(1, mesh.boundary:face("bottom").area, 1e-12)
    check.near(2, mesh.boundary:face("left").area, 1e-12)
  end)

  it("is written to OBJ and read", function()
    local path = os.tmpname() .. ".obj"
    local part = plate()
    assert(part:write(path, {unit = "m"}))
    local back = assert(bw.surface.read(path, {unit = "m"}))
    os.remove(path)
    check.near(ROUND, area_of(back, "bolt hole"), 1e-9)
    check.near(TOP, area_of(back, "top"), 1e-9)
  end)
end)

-- ---- 200 random solids ---------------------------------------------------------------------------------

-- Solids of the modeller in general position, with their volume by formula.
local function random_solid(random)
  local made, volume
  local kind, n = random(6), random(5, 14)
  if kind == 1 then
    local a, b, h = 0.2 + random(), 0.2 + random(), 0.5 + random()
    made = bw.surface.cone {axis = {0, 0, h}, radius = a, top_radius = b, segments = n}
    volume = h / 3 * (a * a + a * b + b * b) * polygon_area(n, 1)
  elseif kind == 2 then
    local r, t = 0.8 + random(), 0.2 + 0.4 * random()
    made = bw.surface.torus {radius = r, tube = t, segments = n}
    volume = n * math.sin(2 * pi / n) * r * polygon_area(n, t)
  elseif kind == 3 then
    local r, h = 0.3 + random(), 0.4 + random()
    made = bw.surface.prism {axis = {0, 0, h}, radius = r, sides = n}
    volume = h * polygon_area(n, r)
  elseif kind == 4 then
    local w, h = 0.3 + random(), 0.3 + random()
    made = bw.surface.revolve(bw.outline.rectangle {min = {0.5, 0}, max = {0.5 + w, h}}, {segments = n})
    volume = n * math.sin(2 * pi / n) * h * (0.5 + w / 2) * w
  elseif kind == 5 then
    local a, b, h = 0.5 + random(), 0.5 + random(), 0.5 + random()
    local function square(s) return bw.outline.rectangle {width = s, height = s, centre = {0, 0}} end
    made = bw.surface.loft({square(a), square(b)}, {heights = {0, h}})
    volume = h / 3 * (a * a + a * b + b * b)
  else
    local w, h = 0.2 + 0.3 * random(), 0.2 + 0.3 * random()
    local path = {{0, 0, 0}, {0, 0, 1}, {1 + random(), 0, 1.5}, {2, 1 + random(), 2}}
    local length = 0
    for i = 1, 3 do
      local sum = 0
      for k = 1, 3 do sum = sum + (path[i + 1][k] - path[i][k]) ^ 2 end
      length = length + math.sqrt(sum)
    end
    made = bw.surface.sweep(bw.outline.rectangle {width = w, height = h, centre = {0, 0}}, {path = path})
    volume = w * h * length
  end
  made = assert(made):rotate({random() - 0.5, random() - 0.5, random() + 0.1}, 3 * random())
    :translate {0.7 * random(), 0.7 * random(), 0.7 * random()}
  return made, volume
end

-- A random convex polygon with a fillet at each corner, and its area by formula.
local function random_fillet(random)
  local count = random(4, 8)
  local angles, points = {}, {}
  for i = 1, count do angles[i] = 2 * pi * (i - 0.7 + 0.6 * random()) / count end
  for i = 1, count do points[i] = {math.cos(angles[i]), 0.7 * math.sin(angles[i])} end
  local area, most = 0, math.huge
  local turns, lengths = {}, {}
  for i = 1, count do
    local p, q, r = points[(i - 2) % count + 1], points[i], points[i % count + 1]
    area = area + (p[1] * q[2] - p[2] * q[1]) / 2
    local u, v = {q[1] - p[1], q[2] - p[2]}, {r[1] - q[1], r[2] - q[2]}
    turns[i] = math.atan(u[1] * v[2] - u[2] * v[1], u[1] * v[1] + u[2] * v[2])
    lengths[i] = math.sqrt(u[1] ^ 2 + u[2] ^ 2)
  end
  for i = 1, count do
    local before = turns[(i - 2) % count + 1]
    most = math.min(most, lengths[i] / (math.tan(before / 2) + math.tan(turns[i] / 2)))
  end
  local radius = most * (0.1 + 0.8 * random())
  for i = 1, count do area = area - radius ^ 2 * (math.tan(turns[i] / 2) - turns[i] / 2) end
  return assert(bw.outline.polygon(points):fillet(radius)), area
end

describe("of 200 random solids", function()
  it("booleans are sound and have the volume of inclusion and exclusion", function()
    math.randomseed(35)
    local counts = {judged = 0}
    while counts.judged < 60 do
      local a, volume_a = random_solid(math.random)
      local b, volume_b = random_solid(math.random)
      check.near(volume_a, sound(a).volume, 1e-9)
      check.near(volume_b, sound(b).volume, 1e-9)
      local ok, both, message = pcall(a.intersection, a, b)
      if ok and both then
        sound(both)
        local either, rest = sound(a:union(b)), sound(a:difference(b))
        check.near(volume_a + volume_b, either.volume + both.volume, 1e-9)
        check.near(volume_a - both.volume, rest.volume, 1e-9)
        counts.judged = counts.judged + 3
      else
        message = ok and message or both
        assert.truthy(message:match "nothing is left" or message:match "touches itself", message)
        counts.refused = (counts.refused or 0) + 1
        assert.is_true(counts.refused < 20, message)
      end
    end
  end)

  it("filleted profiles with bores are sound and have the volume by formula", function()
    math.randomseed(36)
    for i = 1, 100 do
      local outline, area = random_fillet(math.random)
      check.near(area, outline.area, 2e-5)
      local height = 0.1 + math.random()
      local solid = sound(bw.surface.extrude(outline, {height = height, tolerance = 1e-4}))
      -- Chords within 1e-4 m take less than that times the perimeter.
      assert.is_true(solid.volume < area * height * (1 + 2e-5))
      assert.is_true(solid.volume > (area - 1e-4 * outline.perimeter) * height)
      if i % 5 == 0 then
        local bore = bw.surface.prism {base = {0, 0, -1}, axis = {0.03, 0, 3}, radius = 0.03, sides = 8}
        local both, rest = sound(solid:intersection(bore)), sound(solid:difference(bore))
        check.near(solid.volume - both.volume, rest.volume, 1e-9)
        check.near(height * polygon_area(8, 0.03) * math.sqrt(9.0009) / 3, both.volume, 1e-9)
      end
    end
  end)

  it("rounded boxes by signed distance have the volume of Steiner's formula", function()
    math.randomseed(37)
    for _ = 1, 40 do
      local a, b, c, r = 0.5 + math.random(), 0.5 + math.random(), 0.5 + math.random(), 0.1 + 0.3 * math.random()
      local body = bw.shapes.offset(bw.shapes.box({0, 0, 0}, {a, b, c}), r)
      local solid = sound(bw.surface.implicit(body, {min = {-r - 0.1, -r - 0.1, -r - 0.1},
        max = {a + r + 0.1, b + r + 0.1, c + r + 0.1}, cells = 24}))
      local volume = a * b * c + 2 * r * (a * b + b * c + c * a) + pi * r * r * (a + b + c) + 4 / 3 * pi * r ^ 3
      check.near(volume, solid.volume, 0.01)
    end
  end)
end)
