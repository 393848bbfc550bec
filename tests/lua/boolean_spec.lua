-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Booleans of closed surfaces, names of their faces, and extruded outlines.
local bw = require "barwright"
local check = require "check"

local function box(min, max) return bw.surface.box {min = min, max = max} end

-- Volume that two boxes along the axes have in common.
local function common(a, b)
  local volume = 1
  for k = 1, 3 do
    volume = volume * math.max(0, math.min(a.box.max[k], b.box.max[k]) - math.max(a.box.min[k], b.box.min[k]))
  end
  return volume
end

-- A body that a boolean gives, or nil and why there is none: nothing is left, or it touches itself.
local function made(a, operation, b)
  local ok, body, message = pcall(a[operation], a, b)
  if ok and body then return body end
  message = ok and message or body
  local why = message:match "nothing is left" or message:match "touches itself"
  assert.truthy(why, message)
  return nil, why
end

-- All three booleans of two bodies: sound, with the volume of inclusion and exclusion. Counts what they gave.
local function judge(a, b, counts)
  local both, empty = made(a, "intersection", b)
  local rest, either = made(a, "difference", b), made(a, "union", b)
  if not (both and rest and either) then
    local why = empty or "other"
    counts[why] = (counts[why] or 0) + 1
    return nil
  end
  counts.judged = (counts.judged or 0) + 1
  for _, body in ipairs {both, either, rest} do assert.is_true(body:check().sound) end
  check.near(a.volume + b.volume, either.volume + both.volume, 1e-9)
  check.near(a.volume - both.volume, rest.volume, 1e-9)
  return both
end

describe("a boolean", function()
  it("of bodies on a lattice, with many faces in one plane, is sound and has the right volume", function()
    math.randomseed(20)
    local counts, corner = {}, function() return {math.random(0, 3), math.random(0, 3), math.random(0, 3)} end
    for i = 1, 200 do
      local p, q = corner(), corner()
      local a = box(p, {p[1] + math.random(3), p[2] + math.random(3), p[3] + math.random(3)})
      local b = i % 2 == 0 and box(q, {q[1] + math.random(3), q[2] + math.random(3), q[3] + math.random(3)})
        or bw.surface.cylinder {base = {q[1], q[2] + 0.3, q[3] - 1}, axis = {0, 0, 3}, radius = 1.3, segments = 24}
      local both = judge(a, b, counts)
      if both and i % 2 == 0 then check.near(common(a, b), both.volume, 1e-9) end
    end
    assert.is_true(counts.judged > 50, bw.json.encode(counts))
  end)

  it("of boxes, balls and cylinders in general position is sound and has the right volume", function()
    math.randomseed(21)
    local random = math.random
    local function body()
      local kind, at = random(3), {random(), random(), random()}
      local made_of = kind == 1 and box({-0.2 - random(), -0.2 - random(), -0.2 - random()}, {0.6, 0.7, 0.8})
        or kind == 2 and bw.surface.sphere {radius = 0.5 + random(), subdivisions = 2}
        or bw.surface.cylinder {base = {0, 0, -1}, axis = {0.3, 0.2, 2}, radius = 0.3 + 0.5 * random(),
          segments = 20}
      return made_of:rotate({random() - 0.5, random() - 0.5, random() + 0.1}, 3 * random()):translate(at)
    end
    local counts = {}
    for _ = 1, 100 do judge(body(), body(), counts) end
    assert.is_true(counts.judged > 60, bw.json.encode(counts))
  end)

  it("says that nothing is left", function()
    assert.error_matches(function()
      return box({0, 0, 0}, {1, 1, 1}):intersection(box({2, 0, 0}, {3, 1, 1}))
    end, "nothing is left")
  end)

  it("keeps names of faces, on the mesh too", function()
    local plate = assert(bw.surface.extrude(bw.outline.rectangle {width = 0.04, height = 0.04, tag = "side"},
      {height = 0.01}))
    check.near(1.6e-5, plate.volume, 1e-15)
    local drill = bw.surface.cylinder {base = {0.02, 0.02, -0.01}, axis = {0, 0, 0.03}, radius = 0.006,
      segments = 24}
    local part = assert(plate:difference(drill:named "bolt hole"))
    assert.is_true(part:check().sound)
    assert.same({"start", "end", "side", "bolt hole"}, part:face_names())
    local area = {0, 0, 0, 0}
    for t = 1, part.triangle_count do area[part.groups[t]] = area[part.groups[t]] + 1 end
    for i = 1, 4 do assert.is_true(area[i] > 0) end
    local mesh = assert(bw.mesh.fill(part, {edge_length = 0.004}))
    local round = 2 * 24 * 0.006 * math.sin(math.pi / 24) * 0.01
    check.near(round, part:face_on(mesh, "bolt hole").area, 0.02)
    check.near(4 * 0.04 * 0.01, part:face_on(mesh, "side").area, 1e-6)
  end)
end)
