-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Round holes of a surface, as `barwright strengthen --keep holes` finds them, and what that command keeps.
local bw = require "barwright"
local check = require "check"
local holes = require "barwright.command.holes"

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

describe("barwright strengthen --keep", function()
  local folder = check.folder()
  local given, list

  -- A strip with two holes, weakest beside them, in mm.
  setup(function()
    local body = assert(bw.surface.box {max = {0.06, 0.012, 0.003}})
    for _, x in ipairs {0.02, 0.04} do
      local outline = assert(bw.outline.circle {centre = {x, 0.006}, radius = 0.003})
      local pin = assert(bw.surface.extrude(outline, {height = 0.02, curvature = 6}))
      body = assert(body:difference(pin:translate {0, 0, -0.01}))
    end
    assert(body:write(folder .. "/strip.obj", {unit = "mm"}))
    given = assert(bw.surface.read(folder .. "/strip.obj", {unit = "mm"}))
    list = assert(holes.of(given))
    assert.equal(2, #list)
  end)

  -- The surface that is written.
  local function strengthened(keep)
    local words = ("strengthen %s/strip.obj --unit mm --force 1kN --elements 300 --modes 2 --regions 1 --steps 1 "
      .. "--out %s/out.obj %s"):format(folder, folder, keep)
    local status, text, fault = check.run(words)
    assert.equal(1, status, fault .. text) -- which is more than a step makes it carry
    local made = assert(bw.surface.read(folder .. "/out.obj", {unit = "mm"}))
    assert.is_true(made.volume > 1.0001 * given.volume)
    return made, text
  end

  it("holes leaves diameters and positions as they were", function()
    local on_wall = holes.test(list)
    local before = points_on(given, on_wall)
    local made, text = strengthened "--keep holes"
    assert.truthy(text:find("Kept: 2 round holes", 1, true), text)
    local after = assert(holes.of(made))
    assert.equal(2, #after)
    for i, hole in ipairs(list) do
      assert.near(hole.radius, after[i].radius, 1e-9)
      for k = 1, 3 do
        assert.near(hole.point[k] - hole.axis[k] * hole.point[3] / hole.axis[3],
          after[i].point[k] - after[i].axis[k] * after[i].point[3] / after[i].axis[3], 1e-9)
      end
    end
    assert.is_true(apart(before, points_on(made, on_wall)) < 1e-9)
    -- Without it the walls move.
    assert.is_true(apart(before, strengthened("").points:totable()) > 1e-6)
  end)

  it("face:NAME leaves a face as it was", function()
    local faces = assert(given:faces())
    local top
    for number, face in ipairs(faces) do
      if face.kind == "plane" and face.point[3] > 0.0029 then top = top or number end
    end
    local function at_top(x, y, z) return z > 0.003 - 1e-9 and x and y end
    local before = points_on(given, at_top)
    local made = strengthened("--keep face:" .. top)
    assert.is_true(made.box.max[3] < 0.003 + 1e-9)
    assert.is_true(apart(before, made.points:totable()) < 1e-9)
    assert.is_true(strengthened("").box.max[3] > 0.003 + 1e-6)
    local status, _, fault = check.run(("strengthen %s/strip.obj --unit mm --force 1kN --out %s/out.obj --keep "
      .. "face:lid"):format(folder, folder))
    assert.equal(2, status)
    assert.truthy(fault:find("no such face", 1, true), fault)
  end)
end)
