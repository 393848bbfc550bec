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

describe("a boolean", function()
  it("of random bodies is sound and has the volume of inclusion and exclusion", function()
    math.randomseed(20)
    local tried = 0
    local corner = function() return {math.random(0, 3), math.random(0, 3), math.random(0, 3)} end
    for i = 1, 200 do -- corners on a lattice: many faces of the two lie in one plane
      local p, q = corner(), corner()
      local a = box(p, {p[1] + math.random(3), p[2] + math.random(3), p[3] + math.random(3)})
      local b = i % 2 == 0 and box(q, {q[1] + math.random(3), q[2] + math.random(3), q[3] + math.random(3)})
        or bw.surface.cylinder {base = {q[1], q[2] + 0.3, q[3] - 1}, axis = {0, 0, 3}, radius = 1.3, segments = 24}
      local met, both = pcall(a.intersection, a, b)
      local left, rest = pcall(a.difference, a, b)
      local either = a:union(b)
      if not (met and left and both and rest and either) then goto continue end -- empty, or it touches itself
      tried = tried + 1
      for _, body in ipairs {both, either, rest} do assert.is_true(body:check().sound, i) end
      check.near(a.volume + b.volume, either.volume + both.volume, 1e-9)
      check.near(a.volume - both.volume, rest.volume, 1e-9)
      if i % 2 == 0 then check.near(common(a, b), both.volume, 1e-9) end
      ::continue::
    end
    assert.is_true(tried > 40, tried)
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
