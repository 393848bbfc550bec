-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Singular places of rigid couplings, of bonds beside one body, and of sectors of cyclic symmetry beside their
-- wheels.
local bw = require "barwright"
local check = require "check"

local steel = bw.material.steel

local function sums(places)
  local found = {}
  for _, place in ipairs(places) do
    local key = ("%s %.1f %.4f"):format(place.kind, place.angle or 0, place.exponent or 0)
    found[key] = (found[key] or 0) + place.length
  end
  return found
end

-- A square tube from -a to a inside and -b to b outside, height h: a quarter of it, between cuts that leave the
-- corners of the hole in the direction of `slope`: 1 along the diagonal. Both sectors have a part of the angle at
-- the hole's corner.
local function quarter(order, slope)
  local a, b, h, n = 0.01, 0.03, 0.02, 4
  local mesh = bw.mesh.box {max = {1, 1, h}, cells = {3, 2 * n, 2}, order = order}
  local x0 = a + slope * (b - a) -- where the low cut leaves the outside
  local rows = {}
  for i, p in ipairs(mesh.nodes:totable()) do
    local s, t = p[1], p[2]
    local inner = {a, a * (2 * t - 1)}
    local outer = t <= 0.5 and {x0 + (b - x0) * 2 * t, -b} or {b, -b + (x0 + b) * (2 * t - 1)}
    if slope == 1 then outer = {b, b * (2 * t - 1)} end
    rows[i] = {inner[1] + s * (outer[1] - inner[1]), inner[2] + s * (outer[2] - inner[2]), p[3]}
  end
  local moved = assert(mesh:moved(rows))
  local low = moved.boundary:plane({a, -a, 0}, {b - a, x0 - a, 0}, 1e-9)
  local high = moved.boundary:plane({a, a, 0}, {a - x0, b - a, 0}, 1e-9)
  return bw.model {mesh = moved, material = steel}, low, high, h
end

describe("a rigid coupling", function()
  it("is singular at the rim of its face, as a fixed face is, and a distributed one is not", function()
    for order = 1, 2 do
      local mesh = bw.mesh.box {max = {0.1, 0.02, 0.01}, cells = {10, 2, 1}, order = order}
      local function part() return bw.model {mesh = mesh, material = steel} end
      local fixed, rigid, mean = part(), part(), part()
      local face = mesh.boundary:below("x", 0)
      fixed:fix(face)
      rigid:couple {on = face, kind = "rigid", force = {0, 0, 1}}
      mean:couple {on = face, kind = "distributed", force = {0, 0, 1}}
      local own = {}
      for key, length in pairs(sums(assert(rigid:singular_places()))) do
        own[key:gsub("a rigid coupling", "a support")] = length
      end
      assert.same(sums(assert(fixed:singular_places())), own)
      assert.equal("border of a rigid coupling", assert(rigid:singular_places())[1].kind)
      rigid:fix(face) -- which names what holds it
      assert.equal("border of a support", assert(rigid:singular_places())[1].kind)
      rigid:clear_supports()
      assert.equal(4, #assert(rigid:singular_places()))
      check.near(0.7112, assert(rigid:singular_places())[1].exponent, 1e-4)
      assert.equal(0, #assert(mean:singular_places()))
    end
  end)
end)

describe("a sector of cyclic symmetry", function()
  for _, slope in ipairs {1, 0.36} do
    it(("has the singular places of the wheel, cut in the direction %g"):format(slope), function()
      for order = 1, 2 do
        for _, held in ipairs {false, true} do
          local part, low, high, h = quarter(order, slope)
          if held then part:fix(part.mesh.boundary:below("z", 0)) end
          assert(part:cyclic {low = low, high = high, count = 4})
          local sector, wheel = sums(assert(part:singular_places())), sums(assert(part:whole():singular_places()))
          for key, length in pairs(wheel) do check.near(length / 4, sector[key] or 0, 1e-9) end
          for key in pairs(sector) do assert.truthy(wheel[key], key) end
          local found = assert(part:singular_places())[1]
          if not held then
            assert.equal(1, #assert(part:singular_places()))
            check.near(1.5 * math.pi, found.angle, 1e-6)
            check.near(h, found.length, 1e-9)
          end
        end
      end
    end)
  end

  it("has none where its cut bends", function()
    -- a ring from 1 to 3, cut along a radius up to 2 and along a spiral from there on: the sector has an edge of
    -- more than 180 degrees there, and the wheel has material
    local mesh = bw.mesh.box {max = {1, 1, 1}, cells = {4, 6, 1}, order = 1}
    local rows = {}
    for i, p in ipairs(mesh.nodes:totable()) do
      local r = 1 + 2 * p[1]
      local angle = p[2] * math.pi / 2 + 0.6 * math.max(0, r - 2)
      rows[i] = {r * math.cos(angle), r * math.sin(angle), p[3]}
    end
    local moved = assert(mesh:moved(rows))
    local function on(t)
      return moved.boundary:where(function(x, y)
        local angle = math.atan(y, x) - 0.6 * math.max(0, math.sqrt(x ^ 2 + y ^ 2) - 2)
        return math.abs(angle - t * math.pi / 2) < 1e-9
      end)
    end
    local low, high = on(0), on(1)
    assert.equal(8, low.facets.row_count)
    local part = bw.model {mesh = moved, material = steel}
    assert.truthy(#assert(part:singular_places()) > 0)
    assert(part:cyclic {low = low, high = high, count = 4})
    assert.equal(0, #assert(part:whole():singular_places()))
    assert.equal(0, #assert(part:singular_places()))
  end)
end)

describe("a bond", function()
  local function bonded(list, side)
    local mesh, z = check.boxes(1, list), list[2][1][3]
    local part = bw.model {mesh = mesh, material = steel}
    local cut = mesh.boundary:plane({0, 0, z}, {0, 0, 1}, 1e-9)
    local low, high = cut:facing({0, 0, 1}, 0.1), cut:facing({0, 0, -1}, 0.1)
    assert(part:bond {a = side == 1 and high or low, b = side == 1 and low or high})
    return part, low, high
  end

  it("ends in the re-entrant edges of one body", function()
    local list = {{{0, 0, 0}, {0.6, 0.1, 0.1}, {12, 2, 2}}, {{0.4, 0, 0.1}, {1, 0.1, 0.2}, {13, 3, 2}}}
    local box = bw.mesh.box {max = {1, 0.1, 0.2}, cells = {10, 1, 2}}
    local nodes, keep, place, used = box.nodes:totable(), {}, {}, {}
    for _, e in ipairs(box.elements:totable()) do
      local x, z = 0, 0
      for k = 1, 4 do x, z = x + nodes[e[k]][1] / 4, z + nodes[e[k]][3] / 4 end
      if z < 0.1 and x < 0.6 or z > 0.1 and x > 0.4 then
        for k, n in ipairs(e) do
          if not used[n] then place[#place + 1], used[n] = nodes[n], #place + 1 end
          e[k] = used[n]
        end
        keep[#keep + 1] = e
      end
    end
    local whole = bw.model {mesh = bw.mesh.new {nodes = place, elements = keep}, material = steel}
    local expected = assert(whole:singular_places())
    assert.equal(2, #expected)
    for side = 1, 2 do
      local found = assert(bonded(list, side):singular_places())
      assert.equal(2, #found)
      for _, own in ipairs(found) do
        local other = expected:near(own.points[1]).place
        assert.equal("end of a bond", own.kind)
        check.near(other.length, own.length, 1e-12)
        check.near(other.angle, own.angle, 1e-12)
        check.near(other.exponent, own.exponent, 1e-12)
        for k = 1, 3 do assert.is_true(math.abs(other.inward[1][k] - own.inward[1][k]) < 1e-12) end
      end
    end
  end)

  it("ends around a stud, and nowhere where two bodies end together", function()
    local stud = bonded({{{0, 0, 0}, {1, 1, 0.5}, {5, 4, 2}}, {{0.13, 0.21, 0.5}, {0.77, 0.83, 1}, {3, 2, 2}}}, 1)
    local length = 0
    for _, place in ipairs(assert(stud:singular_places())) do length = length + place.length end
    check.near(2 * 0.64 + 2 * 0.62, length, 1e-12)
    local flush = {{{0, 0, 0}, {1, 1, 0.5}, {5, 4, 2}}, {{0, 0, 0.5}, {1, 1, 1}, {3, 2, 2}}}
    assert.equal(0, #assert(bonded(flush, 1):singular_places()))
  end)

  it("ends where a pin leaves its bore", function()
    local nodes, elements, region, tag = {}, {}, {}, 0
    local function ring(r1, r2, z1, z2, cells) -- a quarter
      local box, before = bw.mesh.box {max = {1, 1, 1}, cells = cells}, #nodes
      tag = tag + 1
      for _, p in ipairs(box.nodes:totable()) do
        local r, angle = r1 + (r2 - r1) * p[1], p[2] * math.pi / 2
        nodes[#nodes + 1] = {r * math.cos(angle), r * math.sin(angle), z1 + (z2 - z1) * p[3]}
      end
      for _, e in ipairs(box.elements:totable()) do
        for k = 1, 4 do e[k] = e[k] + before end
        elements[#elements + 1], region[#region + 1] = e, tag
      end
    end
    ring(0.01, 0.03, 0, 0.01, {4, 6, 3})
    ring(0.004, 0.01, -0.005, 0.015, {2, 8, 7})
    local mesh = bw.mesh.new {nodes = nodes, elements = elements, regions = region}
    local round = mesh.boundary:where(function(x, y) return math.abs(math.sqrt(x * x + y * y) - 0.01) < 2e-4 end)
    local bore, pin = round & mesh.boundary:region "region 1", round & mesh.boundary:region "region 2"
    local part = bw.model {mesh = mesh, material = steel}
    assert(part:bond {a = bore, b = pin})
    local places = assert(part:singular_places())
    assert.equal(2, #places)
    for _, place in ipairs(places) do
      check.near(0.01 * math.pi / 2, place.length, 0.01)
      check.near(1.5 * math.pi, place.angle, 1e-9)
    end
  end)
end)
