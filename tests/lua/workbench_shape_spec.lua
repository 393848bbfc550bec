-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edits of the workbench beside faces that stay, on both sides of a part, drags of one face after another, what it
-- refuses, and advice without loads.
local bw = require "barwright"
local check = require "check"
local judge = require "barwright.workbench.judge"
local mirror = require "barwright.workbench.mirror"
local model = require "barwright.command.model"

local folder = check.folder()
local LENGTH, WIDTH, HEIGHT = 0.1, 0.02, 0.01

local function open(name, surface)
  local path = folder .. "/" .. name
  assert(surface:write(path))
  return assert(bw.workbench.open(path))
end

local function bored(part, x, radius, segments)
  return assert(part:difference(bw.surface.cylinder {base = {x, 0.015, -0.01}, axis = {0, 0, 0.05},
    radius = radius, segments = segments or 48}))
end

local function beam() return open("beam.stl", bw.surface.box {max = {LENGTH, WIDTH, HEIGHT}}) end

-- The faces that look in a direction, or the cylinders.
local function faces_of(bench, normal)
  local list = {}
  for i, face in ipairs(bench:current().body.faces) do
    local n = face.normal
    local fits = normal and face.kind == "plane" and n[1] * normal[1] + n[2] * normal[2] + n[3] * normal[3] > 0.99
    if fits or not normal and face.kind == "cylinder" then list[#list + 1] = i end
  end
  return list
end

local function facing(bench, normal) return faces_of(bench, normal)[1] end

-- The largest difference of two surfaces' points, of which the first count alike.
local function largest_change(before, after, chosen)
  local most = 0
  local now = after.points:totable()
  for i, p in ipairs(before.points:totable()) do
    if chosen(p) then
      for k = 1, 3 do most = math.max(most, math.abs(now[i][k] - p[k])) end
    end
  end
  return most
end

describe("a bump of the workbench", function()
  it("leaves faces that are locked or constrained where they are", function()
    local plate = bw.surface.box {max = {0.06, 0.03, 0.005}}
    -- A hole of many sides is a cylinder, one of few sides has no primitive.
    for kind, sides in pairs {cylinder = 48, ["free form"] = 24} do
      local bench = open("plate.3mf", bored(plate, 0.045, 0.005, sides))
      local hole
      for i, face in ipairs(bench:current().body.faces) do hole = face.kind == kind and i or hole end
      assert(bench:lock {faces = {hole}})
      local before = bench:current().body.surface
      assert(bench:thicken {at = {0.039, 0.015, 0.005}, radius = 0.006, offset = 0.001}) -- beside its edge
      local after = bench:current().body.surface
      assert.is_true(after.volume > before.volume)
      local inner = 0.005 * math.cos(math.pi / sides) - 1e-6
      local count = 0
      for _, p in ipairs(after.points:totable()) do
        local away = math.sqrt((p[1] - 0.045) ^ 2 + (p[2] - 0.015) ^ 2)
        assert.is_true(away > inner)
        -- The edge stays in the top.
        if away < 0.005 + 1e-6 and p[3] > 0.004 then
          count = count + 1
          assert.is_true(math.abs(p[3] - 0.005) < 1e-6 or p[3] < 0.005, p[3])
        end
      end
      assert.is_true(count >= sides)
      assert.is_true(largest_change(before, after, function(p)
        return math.abs(math.sqrt((p[1] - 0.045) ^ 2 + (p[2] - 0.015) ^ 2) - 0.005) < 1e-5
      end) < 1e-9)
    end
    local bench = open("plate.3mf", plate)
    assert(bench:fix {faces = {facing(bench, {0, 0, -1})}})
    local before = bench:current().body.surface
    assert(bench:thicken {at = {0, 0.015, 0.002}, radius = 0.006, offset = 0.001}) -- it reaches the lower edge
    local after = bench:current().body.surface
    assert.is_true(after.volume > before.volume)
    for _, p in ipairs(after.points:totable()) do assert.is_true(p[3] > -1e-9) end
    assert.is_true(largest_change(before, after, function(p) return p[3] < 1e-9 end) < 1e-9)
  end)

  it("that reaches over the middle of a symmetric part is one in the middle", function()
    local bench = beam()
    assert(bench:symmetry {across = "x"})
    assert(bench:thicken {at = {LENGTH / 2 + 0.0015, WIDTH / 2, HEIGHT}, radius = 0.008, offset = 0.001})
    local top, sum, moment = 0, 0, 0
    for _, p in ipairs(bench:current().body.surface.points:totable()) do
      local up = math.max(p[3] - HEIGHT, 0)
      top, sum, moment = math.max(top, up), sum + up, moment + up * (p[1] - LENGTH / 2)
    end
    assert.is_true(top > 0.0009 and top < 0.0011, top)
    assert.is_true(math.abs(moment / sum) < 0.0005, moment / sum)
  end)
end)

describe("a symmetric part", function()
  it("gets the radius of a hole on both sides", function()
    local bench = open("twin.3mf", bored(bored(bw.surface.box {max = {0.06, 0.03, 0.005}}, 0.045, 0.004), 0.015,
      0.004))
    assert(bench:symmetry {across = "x"})
    local holes = faces_of(bench)
    assert.equal(2, #holes)
    assert(bench:radius {face = holes[1], radius = 0.006})
    for _, hole in ipairs(holes) do check.near(0.006, bench:current().body.faces[hole].radius, 1e-6) end
  end)

  it("has faces of the same kind and area at mirrored places", function()
    local function face(x, area, kind) return {kind = kind or "plane", centre = {x, 0, 0}, area = area} end
    local self = {surface = {box = {min = {0, 0, 0}, max = {1, 1, 1}}}, faces = {face(0, 1), face(1, 1.01),
      face(0.2, 1), face(0.8, 1.1), face(0.3, 1), face(0.7, 1, "cylinder"), face(0.5, 1)}}
    assert.equal(2, mirror.face(self, "x", 1))
    assert.is_nil(mirror.face(self, "x", 3)) -- of another area
    assert.is_nil(mirror.face(self, "x", 5)) -- of another kind
    assert.equal(7, mirror.face(self, "x", 7))
    assert.is_nil(mirror.face(self, "y", 1)) -- nothing lies opposite
    self.faces[8] = {kind = "plane", centre = {0, 1, 0}, area = 1}
    assert.equal(8, mirror.face(self, "y", 1))
    assert.equal(1, mirror.face(self, "y", 8))
  end)
end)

describe("a patch", function()
  it("has triangles that face as the first one does, within the radius", function()
    local ball = bw.surface.implicit("x^2 + 2 * y^2 + 3 * z^2 + x * y / 2 - 4e-4",
      {min = {-0.03, -0.03, -0.03}, max = {0.03, 0.03, 0.03}, cells = 20})
    for _, case in ipairs {{angle = 0.3}, {angle = 1.5, radius = 0.006}} do
      local bench = open("ball.stl", ball)
      case.triangle = 1
      assert(bench:grow(case))
      local body, list = bench:current().body, {}
      local points = body.surface.points:totable()
      for t, corners in ipairs(body.surface.triangles:totable()) do
        if body.labels[t] == bench.grown_faces[1] then
          local a, b, c = points[corners[1]], points[corners[2]], points[corners[3]]
          local u, v, n, middle = {}, {}, {}, {}
          for k = 1, 3 do u[k], v[k], middle[k] = b[k] - a[k], c[k] - a[k], (a[k] + b[k] + c[k]) / 3 end
          for k = 1, 3 do n[k] = u[k % 3 + 1] * v[(k + 1) % 3 + 1] - u[(k + 1) % 3 + 1] * v[k % 3 + 1] end
          local size = math.sqrt(n[1] ^ 2 + n[2] ^ 2 + n[3] ^ 2)
          list[#list + 1] = {t, {n[1] / size, n[2] / size, n[3] / size}, middle}
        end
      end
      assert.is_true(#list > 5)
      local first = list[1]
      assert.equal(1, first[1])
      local widest, farthest = 0, 0
      for _, one in ipairs(list) do
        local n, m, d = one[2], one[3], 0
        local cos = n[1] * first[2][1] + n[2] * first[2][2] + n[3] * first[2][3]
        for k = 1, 3 do d = d + (m[k] - first[3][k]) ^ 2 end
        widest, farthest = math.max(widest, math.acos(math.min(cos, 1))), math.max(farthest, math.sqrt(d))
      end
      assert.is_true(widest <= case.angle + 1e-9 and farthest <= (case.radius or 1) + 1e-12)
      -- It is the whole of what fits, not less.
      assert.is_true(case.radius and farthest > 0.8 * case.radius or not case.radius and widest > 0.7 * case.angle)
    end
  end)
end)

describe("a patch that is a whole face", function()
  it("is that face, and no other one is left without triangles", function()
    local bench = beam()
    local face = bench:current().body.labels[1]
    assert(bench:grow {triangle = 1, angle = 0.5})
    assert.same({face}, bench.grown_faces)
    assert.equal(6, #bench:current().body.faces)
  end)
end)

describe("a drag", function()
  it("of one face after another, and after an edit, is of the face and the shape that are there", function()
    local bench = beam()
    assert(bench:fix {faces = {facing(bench, {-1, 0, 0})}})
    local right, top = facing(bench, {1, 0, 0}), facing(bench, {0, 0, 1})
    assert(bench:load {faces = {right}, force = {0, 0, -20}})
    local density, young = bw.material.pla.density, bw.material.pla.young
    local function tried(face, distance, length, height)
      local answer = assert(bench:try {push = {faces = {face}, distance = distance}})
      check.near(length * WIDTH * height * density, answer.mass, 1e-6)
      check.near(20 * length ^ 3 / (3 * young * WIDTH * height ^ 3 / 12), answer.max_displacement, 0.05)
    end
    tried(top, 1e-3, LENGTH, HEIGHT + 1e-3)
    tried(right, 2e-3, LENGTH + 2e-3, HEIGHT)
    assert(bench:push {faces = {right}, distance = 5e-3})
    tried(right, 2e-3, LENGTH + 7e-3, HEIGHT)
  end)
end)

describe("an answer of the workbench", function()
  it("names the bodies of which not all are held", function()
    local two = bw.surface.box {max = {0.02, 0.02, 0.02}}:linear_array {count = 2, step = {0.05, 0, 0}}
    local bench = open("two.stl", two)
    assert(bench:fix {faces = {facing(bench, {0, 0, -1})}})
    assert(bench:load {faces = {facing(bench, {0, 0, 1})}, force = {0, 0, -1}})
    local answer, message = bench:answer {accuracy = "coarse"}
    assert.is_nil(answer)
    assert.truthy(message:find("2 separate bodies", 1, true), message)
  end)

  it("judges the mean where a re-entrant edge has no finite stress", function()
    local corner = assert(bw.outline {points = {{0, 0}, {0.05, 0}, {0.05, 0.01}, {0.01, 0.01}, {0.01, 0.05},
      {0, 0.05}}})
    local bench = open("corner.stl", assert(bw.surface.extrude(corner, {height = 0.01})))
    for i, face in ipairs(bench:current().body.faces) do -- the ends of both arms
      if face.centre[2] > 0.049 then assert(bench:fix {faces = {i}}) end
      if face.centre[1] > 0.049 then assert(bench:load {faces = {i}, force = {0, -20, 0}}) end
    end
    local entry = bench:current()
    local function solve(elements, former)
      return assert(judge.statics(entry.body, entry.material, entry.conditions, elements, former))
    end
    local _, _, coarse = solve(1500)
    local answer, static = solve(6000, coarse.measure)
    assert.is_true(answer.singular)
    assert.is_true(answer.utilisation < 0.98 * static.utilisation:max())
    assert.truthy(answer.notes[1]:find("has no finite value", 1, true))
    check.near(answer.load / answer.high, answer.force_low, 1e-12)
    check.near(answer.load / answer.low, answer.force_high, 1e-12)
  end)

  it("without loads is of the part that is held, ends once it is certain, and its advice gains", function()
    local bench = beam()
    assert(bench:fix {faces = {facing(bench, {-1, 0, 0})}})
    -- Bending of a cantilever by a force on 10 mm of its end: b h^2 sigma / (6 (L - 5 mm)).
    local bending = WIDTH * HEIGHT ^ 2 * bw.material.pla.strength / (6 * (LENGTH - 0.005))
    local force = 20 * bending
    local answer = assert(bench:answer {accuracy = "coarse", force = force})
    assert.is_true(answer.force > 0.6 * bending and answer.force < 1.5 * bending, answer.force / bending)
    assert.equal("breaks", answer.verdict)
    assert.equal("red", answer.colour)
    assert.equal(3, #bench:current().solved.breaking.history)
    assert.is_true(bench:current().solved.breaking.options.decide)
    check.near(force / answer.force_high, answer.low, 1e-12)
    check.near(force / answer.force_low, answer.high, 1e-12)
    assert.is_true(answer.low < answer.utilisation and answer.utilisation < answer.high)
    local list = assert(bench:advice())
    assert.is_true(#list > 0 and list[1].gain > 0)
  end)

  it("thickens nothing where the part carries its loads, and advises places apart", function()
    local bench = beam()
    assert(bench:fix {faces = {facing(bench, {-1, 0, 0})}})
    assert(bench:load {faces = {facing(bench, {1, 0, 0})}, force = {0, 0, -20}})
    local made, message = bench:optimise {factor = 0.1, steps = 1}
    assert.is_nil(made)
    assert.truthy(message:find("carries its loads already", 1, true), message)
    for _, place in ipairs(assert(bench:advice())) do
      assert.is_true(place.gain > 0.01)
      for _, other in ipairs(bench:current().advice) do
        local d = 0
        for k = 1, 3 do d = d + (place.at[k] - other.at[k]) ^ 2 end
        assert.is_true(d == 0 or math.sqrt(d) > 0.008)
      end
    end
  end)

  it("has an error of the facets where the surface is round", function()
    -- A bar in tension, whole and with a hole of few sides. Where a coarser mesh had found the same stress, the
    -- error is that of the mean, and that of the facets.
    for _, sides in ipairs {0, 16} do
      local bar = bw.surface.box {max = {0.04, 0.02, 0.005}}
      local bench = open("bar.3mf", sides == 0 and bar or assert(bar:difference(bw.surface.cylinder {
        base = {0.02, 0.01, -0.01}, axis = {0, 0, 0.03}, radius = 0.004, segments = sides})))
      assert(bench:fix {faces = {facing(bench, {-1, 0, 0})}})
      assert(bench:load {faces = {facing(bench, {1, 0, 0})}, force = {100, 0, 0}})
      local entry = bench:current()
      local alone = assert(judge.statics(entry.body, entry.material, entry.conditions, 800))
      local answer, static = assert(judge.statics(entry.body, entry.material, entry.conditions, 800,
        {elements = 1, stress = alone.max_stress, used = alone.utilisation, used_mean = alone.utilisation}))
      local mean = model.error_of(answer.max_stress, alone.max_stress, static:error_estimate())
      if sides == 0 then
        assert.is_true(answer.error >= mean)
      else
        assert.is_true(answer.error > 1.05 * mean, ("%g and %g"):format(answer.error, mean))
      end
    end
  end)
end)
