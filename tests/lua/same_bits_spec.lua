-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The same input gives the same bits in every process and on any number of threads.
local bw = require "barwright"
local check = require "check"
local kind_of = require "barwright.scenario.files".kind

local function compared(arguments)
  return check.run(("'%s/scripts/check_same_bits' %s"):format(check.root, arguments))
end

describe("the same input gives the same bits", function()
  it("of every analysis", function()
    local status, out, err = compared(("'%s/tests/lua/every_analysis.lua' --runs 2"):format(check.root))
    assert.equal(0, status, out .. err)
    assert.truthy(out:find("same every_analysis.lua (1 files, status 0)", 1, true), out)
  end)

  -- CGAL orders points and facets of intersections by addresses; the mesh must not show it.
  it("of a surface whose shells overlap", function()
    local points, triangles = {}, {}
    local ball = bw.surface.sphere {radius = 0.02, subdivisions = 3}
    for i, by in ipairs {{0, 0, 0}, {0.01, 0.007, 0.004}} do
      local before = (i - 1) * ball.point_count
      for _, p in ipairs(ball.points:totable()) do
        points[#points + 1] = {p[1] + by[1], p[2] + by[2], p[3] + by[3]}
      end
      for _, t in ipairs(ball.triangles:totable()) do
        triangles[#triangles + 1] = {t[1] + before, t[2] + before, t[3] + before}
      end
    end
    local path = check.folder() .. "/overlap.off"
    assert(assert(bw.surface.new {points = points, triangles = triangles}):write(path, {unit = "mm"}))
    local status, out, err = compared("--only convert --elements 2000 --runs 3 " .. path)
    assert.equal(0, status, out .. err)
    assert.equal(3, select(2, out:gsub("same convert", "")), out)
    assert.equal(3, select(2, out:gsub("status 0", "")), out)
  end)

  -- Without that order this one has two meshes, by chance.
  it("of a gear of five open shells, where the shared models are there", function()
    local path = (os.getenv "BARWRIGHT_SHARED" or check.root .. "/../shared") .. "/models/bad_gear_open.stl"
    if not kind_of(path) then return end
    local status, out, err = compared("--only repaired.off --runs 6 " .. path)
    assert.equal(0, status, out .. err)
  end)

  it("and says where they differ", function()
    local status, out, err = compared("--runs 3 " .. check.script "print(tostring({}))")
    assert.equal(1, status, out .. err)
    assert.truthy(out:find("DIFFERS", 1, true) and out:find("printed.txt: line 1: 'table: ", 1, true), out)
  end)
end)
