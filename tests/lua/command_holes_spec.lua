-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Round holes of a surface, as `barwright strengthen --keep holes` finds them, and what that command keeps.
local bw = require "barwright"
local check = require "check"
local commands = require "barwright.command"
local holes = require "barwright.command.holes"
local on_triangles = require "barwright.on_triangles"
local places = require "barwright.command.places"

-- A plate with a hole along z at x = 12 mm, a pin that stands on it at 45 mm, and a notch at its end.
local function plate(turned)
  local function round(x, low)
    local outline = assert(bw.outline.circle {centre = {x, 0.01}, radius = 0.003})
    return assert(bw.surface.extrude(outline, {height = 0.02, curvature = 6})):translate {0, 0, low}
  end
  local body = assert(bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.006}})
  body = assert(assert(body:difference(round(0.012, -0.005))):union(round(0.045, 0.001)))
  body = assert(body:difference(round(0.06, -0.005)))
  return turned and assert(body:rotate({1, 2, 3}, 0.9)) or body
end

describe("round holes", function()
  it("are found where a wall goes round an axis and faces it", function()
    local list = assert(holes.of(plate()))
    assert.equal(1, #list)
    assert.near(0.003, list[1].radius, 1e-5)
    assert.near(0.006, list[1].high - list[1].low, 1e-6)
    local on_wall = holes.test(list)
    assert.is_true(on_wall(0.015, 0.01, 0.003))
    for _, p in ipairs {{0.012, 0.01, 0.003}, {0.048, 0.01, 0.01}, {0.015, 0.01, 0.02}, {0.057, 0.01, 0.003}} do
      assert.is_false(on_wall(p[1], p[2], p[3]))
    end
  end)

  it("are found in any position", function()
    assert.equal(1, #assert(holes.of(plate(true))))
    assert.equal(0, #assert(holes.of(assert(bw.surface.box {min = {0, 0, 0}, max = {1, 1, 1}}))))
  end)
end)

-- The largest distance of the points of one list from the nearest one of another.
local function apart(list, others)
  local max = 0
  for _, p in ipairs(list) do
    local min = math.huge
    for _, q in ipairs(others) do
      min = math.min(min, (p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2 + (p[3] - q[3]) ^ 2)
    end
    max = math.max(max, min)
  end
  return math.sqrt(max)
end

-- The points of a surface on what a test says is kept.
local function points_on(surface, test)
  local list = {}
  for _, p in ipairs(surface.points:totable()) do
    if test(p[1], p[2], p[3]) then list[#list + 1] = p end
  end
  return list
end

-- The largest distance of points of a surface on the wall of a hole from its axis.
local function radius_of(surface, hole)
  local max = 0
  for _, p in ipairs(points_on(surface, holes.test {hole})) do
    local d, along = {}, 0
    for k = 1, 3 do d[k] = p[k] - hole.point[k] end
    for k = 1, 3 do along = along + d[k] * hole.axis[k] end
    max = math.max(max, math.sqrt(d[1] ^ 2 + d[2] ^ 2 + d[3] ^ 2 - along ^ 2))
  end
  return max
end

describe("barwright strengthen --keep", function()
  local folder = check.folder()
  local given, list

  -- A strip with two holes, in mm, with coordinates that a binary STL holds: others are rounded by the command.
  setup(function()
    local body = assert(bw.surface.box {max = {0.06, 0.012, 0.003}})
    for _, x in ipairs {0.02, 0.04} do
      local outline = assert(bw.outline.circle {centre = {x, 0.006}, radius = 0.003})
      local pin = assert(bw.surface.extrude(outline, {height = 0.02, curvature = 6}))
      body = assert(body:difference(pin:translate {0, 0, -0.01}))
    end
    assert(body:write(folder .. "/strip.stl", {unit = "mm"}))
    given = assert(bw.surface.read(folder .. "/strip.stl", {unit = "mm"}))
    list = assert(holes.of(given))
    assert.equal(2, #list)
  end)

  -- The surface that the command writes, whose analyses find the part too weak by half between its holes.
  local function strengthened(keep, expected)
    local known = {}
    for _, name in ipairs {"barwright.breaking_force", "barwright.strengthen"} do
      known[name], package.loaded[name] = package.loaded[name], nil
    end
    local force = 40
    package.loaded["barwright.breaking_force"] = function(body)
      force = force + 10
      local found = {force = force, low = force - 5, high = force + 5, at = {0.03, 0.006, 0.003},
        estimated_error = 0.1, contact = 1e-4, length = 0.002, worst = {},
        mesh = {surface = function() return body end}}
      function found.close() end
      function found.advice()
        return {predict = function() return 80 end,
          places = {{at = {0.03, 0.006, 0.003}, radius = 0.009, offset = 1e-4}}}
      end
      return found
    end
    local known_strengthen = bw.strengthen
    rawset(bw, "strengthen", require "barwright.strengthen")
    for name, module in pairs(known) do package.loaded[name] = module end
    local ok, status = pcall(commands.run, "strengthen", folder .. "/strip.stl", "--unit", "mm", "--force", "100N",
      "--quiet", "--steps", "1", "--out", folder .. "/out.stl", "--keep", keep or "near:0,0,-1mm:0.1mm")
    rawset(bw, "strengthen", known_strengthen)
    assert.is_true(ok, status)
    assert.equal(expected or 1, status)
    return expected or assert(bw.surface.read(folder .. "/out.stl", {unit = "mm"}))
  end

  it("holes leaves diameters and positions as they were", function()
    local on_wall = holes.test(list)
    local before = points_on(given, on_wall)
    local made = strengthened "holes"
    for _, hole in ipairs(list) do
      assert.is_true(#points_on(given, holes.test {hole}) > 20)
      assert.near(radius_of(given, hole), radius_of(made, hole), 1e-9)
    end
    assert.is_true(apart(before, points_on(made, on_wall)) < 1e-9)
    -- New points of split edges are rounded to what the file holds.
    assert.is_true(given:distance(points_on(made, on_wall)):max() < 1e-8)
    -- Without it the walls move.
    assert.is_true(apart(before, strengthened().points:totable()) > 1e-6)
  end)

  it("face:NAME leaves a face as it was", function()
    local faces = assert(given:faces())
    local top
    for number, face in ipairs(faces) do
      if face.kind == "plane" and face.point[3] > 0.0029 then top = top or number end
    end
    local function at_top(x, y, z) return z > 0.003 - 1e-9 and x and y end
    local before = points_on(given, at_top)
    local made = strengthened("face:" .. top)
    assert.is_true(made.box.max[3] < 0.003 + 1e-9)
    assert.is_true(apart(before, made.points:totable()) < 1e-9)
    assert.is_true(strengthened().box.max[3] > 0.003 + 1e-6)
    strengthened("face:lid", 2)
    local words = "strengthen %s/strip.stl --force 1N --out %s/o.stl --keep face:lid"
    local status, _, fault = check.run(words:format(folder, folder))
    assert.equal(2, status)
    assert.truthy(fault:find("option --keep: face:lid: no face has the name 'lid': the file names no faces; "
      .. "`barwright check FILE --faces yes` lists faces by shape, such as 'plane 1'", 1, true), fault)
    local named = assert(bw.surface.box {max = {0.06, 0.012, 0.003}}:named("lid", "top"))
    local _, message = places.test({"face:lidd"}, named)
    assert.truthy(message:find("face:lidd: no face has the name 'lidd': there are 'lid', '", 1, true), message)
  end)
end)

describe("points on triangles", function()
  -- A wavy sheet of 2 n^2 triangles, and its points.
  local function sheet(n)
    local points, triangles = {}, {}
    for i = 0, n do
      for j = 0, n do points[#points + 1] = {i / n, j / n, 0.1 * math.sin(5 * i / n) * math.cos(3 * j / n)} end
    end
    for i = 0, n - 1 do
      for j = 1, n do
        local a = i * (n + 1) + j
        table.move({{a, a + n + 1, a + 1}, {a + 1, a + n + 1, a + n + 2}}, 1, 2, #triangles + 1, triangles)
      end
    end
    return points, triangles
  end

  it("are those within a length of them", function()
    local points, triangles = sheet(20)
    local near, surface = 0.01, bw.surface.new {points = points, triangles = triangles}
    local on, wrong, inside, asked = on_triangles(points, triangles, near), 0, 0, {}
    math.randomseed(3)
    for i = 1, 3000 do
      local p = points[i % #points + 1]
      asked[i] = {}
      for k = 1, 3 do asked[i][k] = p[k] + 0.04 * (math.random() - 0.5) end
    end
    for i, away in ipairs(surface:distance(asked):totable()) do
      local found = on(table.unpack(asked[i]))
      inside = inside + (found and 1 or 0)
      if found ~= (away <= near) and math.abs(away - near) > 1e-12 then wrong = wrong + 1 end
    end
    assert.equal(0, wrong)
    assert.is_true(inside > 500 and inside < 2500, inside)
    assert.is_true(on_triangles({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{1, 2, 3}}, 0.1)(1.5, 0.05, 0)) -- no area
    local many = {}
    for i = 1, 20 do many[i] = {1, 2, 3} end -- all in one place
    assert.is_false(on_triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, many, 0.1)(0.6, 0.6, 0.05))
    assert.is_true(on_triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, many, 0.1)(0.5, 0.5, 0.05))
  end)

  it("are found among many triangles without looking at all of them", function()
    local points, triangles = sheet(100)
    local start = os.clock()
    local on = on_triangles(points, triangles, 1e-6)
    for _, p in ipairs(points) do assert(on(p[1], p[2], p[3])) end
    assert.is_true(os.clock() - start < 10, os.clock() - start) -- a search tree per point took 100 s
  end)
end)
