-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Singular places of rigid couplings, and of sectors of cyclic symmetry beside their wheels.
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
