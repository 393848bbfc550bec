-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- surface:nearest against all triangles one after the other, on bodies and on models of other people.
local bw = require "barwright"

local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end
local function sub(a, b) return {a[1] - b[1], a[2] - b[2], a[3] - b[3]} end

-- The squared distance of a point from a segment; from a triangle: from its plane where the foot lies inside.
local function from_segment(p, a, b)
  local d, r = sub(b, a), sub(p, a)
  local t = dot(d, d) > 0 and math.max(0, math.min(1, dot(r, d) / dot(d, d))) or 0
  local apart = {r[1] - t * d[1], r[2] - t * d[2], r[3] - t * d[3]}
  return dot(apart, apart)
end

local function from_triangle(p, a, b, c)
  local u, v, r = sub(b, a), sub(c, a), sub(p, a)
  local n = {u[2] * v[3] - u[3] * v[2], u[3] * v[1] - u[1] * v[3], u[1] * v[2] - u[2] * v[1]}
  local uu, uv, vv, ru, rv = dot(u, u), dot(u, v), dot(v, v), dot(r, u), dot(r, v)
  local det = uu * vv - uv * uv
  if det > 0 then
    local s, t = (vv * ru - uv * rv) / det, (uu * rv - uv * ru) / det
    if s >= 0 and t >= 0 and s + t <= 1 then return dot(r, n) ^ 2 / dot(n, n) end
  end
  return math.min(from_segment(p, a, b), from_segment(p, b, c), from_segment(p, c, a))
end

-- Some random points in twice the box of a surface, and corners of the surface; each nearest triangle is the first
-- of those that are nearest.
local function compare(surface, count)
  local points, triangles, box = surface.points:totable(), surface.triangles:totable(), surface.box
  math.randomseed(11)
  local asked = {}
  for i = 1, count do
    asked[i] = {}
    for k = 1, 3 do
      asked[i][k] = box.min[k] + (2 * math.random() - 0.5) * (box.max[k] - box.min[k])
    end
    asked[count + i] = points[math.random(#points)]
  end
  local found, places, distances = assert(surface:nearest(asked))
  local offsets, size = surface:distance(asked), bw.array.new {box.max}:norm() + bw.array.new {box.min}:norm()
  for i, p in ipairs(asked) do
    local best, each = math.huge, {}
    for t, c in ipairs(triangles) do
      each[t] = math.sqrt(from_triangle(p, points[c[1]], points[c[2]], points[c[3]]))
      best = math.min(best, each[t])
    end
    local here = each[math.tointeger(found[i])]
    assert.is_true(here <= best + 1e-8 * size)
    assert.is_true(math.abs(distances[i] - best) <= 1e-8 * size)
    assert.is_true(math.abs(offsets[i] - best) <= 1e-8 * size)
    local apart = sub({places(i, 1), places(i, 2), places(i, 3)}, p)
    assert.is_true(math.abs(math.sqrt(dot(apart, apart)) - distances[i]) <= 1e-9 * size)
    if i > count then -- a corner: the first triangle that has it
      for t, c in ipairs(triangles) do
        if points[c[1]] == p or points[c[2]] == p or points[c[3]] == p then
          assert.is_true(found[i] <= t)
          break
        end
      end
    end
  end
end

describe("the nearest triangles of a surface", function()
  it("are those of a search among all, of bodies by formula", function()
    compare(bw.surface.sphere {radius = 0.4}, 30)
    compare(bw.surface.cylinder {axis = {0.1, 0.2, 3}, radius = 0.5, segments = 24}, 60)
  end)

  it("are those of a search among all, of models", function()
    for _, name in ipairs {"engine_bracket.obj", "gear_spur.stl", "chair.ply", "bad_zero_area_dup.off"} do
      local file = io.open("../shared/models/" .. name)
      if file then
        file:close()
        compare(assert(bw.surface.read("../shared/models/" .. name, {unit = "mm"})), 20)
      end
    end
  end)

  it("are the first of several that are as near", function()
    local triangles, places, distances = assert(bw.surface.box {max = {1, 1, 1}}:nearest {{0.5, 0.5, 0.5},
      {1, 1, 1}, {0.5, 0.5, -2}})
    assert.same({1, 1}, {triangles[1], triangles[3]})
    assert.same({0.5, 0, 2}, {distances[1], distances[2], distances[3]})
    assert.same({1.0, 1.0, 1.0}, {places(2, 1), places(2, 2), places(2, 3)})
  end)

  it("need triangles and finite points", function()
    local none, message, details = bw.surface.new({points = {{0, 0, 0}}, triangles = {}}):nearest {{0, 0, 0}}
    assert.is_nil(none)
    assert.truthy(message:find("no facets", 1, true))
    assert.equal("geometry", details.status)
    assert.error_matches(function() bw.surface.box {max = {1, 1, 1}}:nearest {{0, 0 / 0, 0}} end, "point 1")
    assert.equal(0, #bw.surface.box({max = {1, 1, 1}}):nearest(bw.array.zeros(0, 3)))
  end)
end)
