-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edits of the surface that a mesh was made from: what did not move stays, what moved follows the mesh.
local bw = require "barwright"
local edit_bodies = require "edit_bodies"

local models = "../shared/models/"

-- A beam of 1 m with few, long triangles, whose bones follow both halves.
local function beam(change)
  local surface = assert(bw.surface.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}})
  local session = edit_bodies.beam {surface = surface}
  if change then change(session) end
  local edited, report = session:surface()
  return assert(edited, report), report, surface, session
end

-- What a point was in the original: unmoved points have the same bits.
local function unmoved(edited, surface, upto)
  local before, after, count = surface.points:totable(), edited.points:totable(), 0
  for i, p in ipairs(before) do
    if p[1] < upto then
      count = count + 1
      assert.same(p, after[i])
    end
  end
  return count
end

describe("the original surface of a session", function()
  it("stays bit for bit at rest, and where every bone is scaled by 1", function()
    for _, change in ipairs {function() end, function(session)
      for _, name in ipairs(session.skeleton.bone_names) do assert(session:bone(name):scale(1)) end
    end} do
      local edited, report, surface = beam(change)
      assert.same(surface.points:totable(), edited.points:totable())
      assert.same(surface.triangles:totable(), edited.triangles:totable())
      assert.equal(0, report.largest_displacement)
      assert.is_true(report.sound)
    end
  end)

  it("is split where a bone turns, and stays where none did", function()
    local edited, report, surface, session = beam(function(session)
      assert(session:bone("lower"):rotate {axis = {0, 0, 1}, degrees = 20})
    end)
    assert.truthy(report.triangles > report.triangles_before)
    assert.equal(edited.triangle_count, report.triangles)
    assert.equal(4, unmoved(edited, surface, 0.2))
    local found = edited:check {limit = 1}
    assert.is_true(found.closed and found.oriented)
    assert.equal(found.sound, report.sound)
    assert.truthy(report.deviation < 5e-3, report.deviation)
    assert.truthy(math.abs(edited.volume / session.mesh.volume - 1) < 5e-3)
  end)

  it("is the boundary of the mesh without the option", function()
    local session = edit_bodies.beam()
    local surface, report = session:surface()
    assert.equal(session.mesh:surface().triangle_count, surface.triangle_count)
    assert.equal(0, report.deviation)
    assert.is_true(report.sound)
  end)

  it("of models follows the mesh, closed and oriented", function()
    for seed, name in ipairs {"fandisk.obj", "fertility.off"} do
      local read = bw.surface.read(models .. name, {unit = "mm"})
      if not read then return end
      local surface = read:check({limit = 1}).sound and read or assert(read:repair())
      local mesh = assert(bw.mesh.fill(surface, {elements = 1500}))
      local session = assert(bw.edit(bw.model {mesh = mesh, material = bw.material.pla}, {surface = surface}))
      local names = session.skeleton.bone_names
      local bone = session:bone(names[seed % #names + 1])
      assert(bone:scale {1, 1.02 + 0.01 * seed, 1.02})
      local edited, report = session:surface()
      assert(edited, report)
      local found = edited:check {limit = 1}
      assert.is_true(found.closed and found.oriented, name)
      assert.is_true(report.triangles >= surface.triangle_count)
      local mine, its = edited.volume - surface.volume, session.mesh.volume - session.rest.volume
      assert.truthy(math.abs(mine - its) <= 0.1 * math.abs(its) + 1e-4 * surface.volume,
        ("%s: %g and %g m3 more"):format(name, mine, its))
    end
  end)
end)
