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

  it("is the boundary of the mesh where this was not made from a surface, or where that is asked for", function()
    local surface = assert(bw.surface.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}})
    local filled = bw.model {mesh = assert(bw.mesh.fill(surface, {elements = 300})), material = bw.material.steel}
    for _, session in ipairs {edit_bodies.beam(),
      assert(bw.edit(filled, {surface = false, skeleton = edit_bodies.beam_skeleton()}))} do
      local boundary, report = session:surface()
      assert.equal(session.mesh:surface().triangle_count, boundary.triangle_count)
      assert.equal("boundary", report.source)
      assert.equal(0, report.deviation)
      assert.is_true(report.sound)
    end
    assert.error(function() bw.edit(filled, {surface = "part.stl"}) end)
  end)

  it("is exported by default, with its report", function()
    local surface = assert(bw.surface.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}})
    local filled = bw.model {mesh = assert(bw.mesh.fill(surface, {elements = 300})), material = bw.material.steel}
    local session = assert(bw.edit(filled, {skeleton = edit_bodies.beam_skeleton()}))
    local path = os.tmpname() .. ".off"
    local report = assert(session:export(path, {unit = "mm"}))
    assert.equal("original", report.source)
    assert.equal(12, assert(bw.surface.read(path, {unit = "mm"})).triangle_count)
    os.remove(path)
    assert.truthy(tostring(report):find("closed and free of crossings", 1, true))
  end)

  it("says what the surface had before the edit", function()
    -- Two boxes that overlap: the surface crosses itself as it was given.
    local first = assert(bw.surface.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}})
    local second = assert(bw.surface.box {min = {0.1, 0.03, 0.03}, max = {0.2, 0.06, 0.2}})
    local points, triangles = first.points:totable(), first.triangles:totable()
    local count = #points
    for _, x in ipairs(second.points:totable()) do points[#points + 1] = x end
    for _, t in ipairs(second.triangles:totable()) do
      triangles[#triangles + 1] = {t[1] + count, t[2] + count, t[3] + count}
    end
    local surface = assert(bw.surface.new {points = points, triangles = triangles})
    local session = edit_bodies.beam {surface = surface}
    assert(session:bone("lower"):scale {1, 1.1, 1.1})
    local _, report = session:surface()
    assert.is_false(report.sound)
    assert.equal("original", report.source)
    assert.truthy(report.defects_before > 0)
    assert.truthy(tostring(report):find(("before the edit it had %d"):format(report.defects_before), 1, true))
  end)

  local function plate()
    local body = assert(bw.surface.box {min = {0, 0, 0}, max = {0.12, 0.05, 0.008}})
    for i, radius in ipairs {0.004, 0.009, 0.006} do
      local centre = {0.02 + 0.035 * (i - 1), 0.02 + 0.003 * i}
      local outline = assert(bw.outline.circle {centre = centre, radius = radius})
      local hole = assert(bw.surface.extrude(outline, {height = 0.02, curvature = 6}))
      body = assert(body:difference(assert(hole:translate {0, 0, -0.005})))
    end
    return body
  end

  -- A wheel with teeth: walls of long, narrow triangles.
  local function wheel()
    local corners = {}
    for i = 0, 59 do
      local radius, angle = i % 4 < 2 and 0.03 or 0.036, math.pi * i / 30
      corners[i + 1] = {radius * math.cos(angle), radius * math.sin(angle)}
    end
    return assert(bw.surface.extrude(assert(bw.outline.polygon(corners)), {height = 0.03}))
  end

  -- Edits of two bones of a session: thicker or thinner, turned, longer or shorter.
  local function random_changes(session, kind, seed)
    local names, changes = session.skeleton.bone_names, {}
    local function random()
      seed = (1103515245 * seed + 12345) % 2147483648
      return seed / 2147483648
    end
    for _ = 1, 2 do
      local name = names[1 + math.floor(random() * #names)]
      local a, b, c = random(), random(), random()
      changes[name] = ({{scale = {1, 0.85 + 0.35 * a, 0.85 + 0.35 * b}},
        {rotation = {axis = {a - 0.5, b - 0.5, c - 0.5}, degrees = 15 * (2 * random() - 1)}},
        {scale = {0.9 + 0.25 * a, 1, 1}}})[kind]
    end
    return changes
  end

  -- The original after an edit is sound, has its own points first, and gains the volume that the mesh gains.
  local function judge(name, session, surface)
    local edited, report = session:surface()
    assert(edited, report)
    assert.equal("original", report.source, name .. ": " .. tostring(report))
    assert.is_true(report.sound, name)
    assert.truthy(edited.point_count >= surface.point_count)
    local mine, its = edited.volume - surface.volume, session.mesh.volume - session.rest.volume
    assert.truthy(math.abs(mine - its) <= 0.1 * math.abs(its) + 0.005 * surface.volume,
      ("%s: %g and %g m3 more"):format(name, mine, its))
  end

  it("of formed bodies stays sound under random edits", function()
    for name, surface in pairs {plate = plate(), wheel = wheel()} do
      local mesh = assert(bw.mesh.fill(surface, {elements = 1200}))
      local session = assert(bw.edit(bw.model {mesh = mesh, material = bw.material.pla}))
      local tried = 0
      for seed = 1, 4 do
        if session:pose(random_changes(session, 1 + seed % 3, seed)) then
          tried = tried + 1
          judge(("%s, seed %d"):format(name, seed), session, surface)
          session:undo()
        end
      end
      assert.truthy(tried >= 3, tried)
    end
  end)

  it("of models stays sound under random edits", function()
    for i, name in ipairs {"gear_spur.stl", "bottle_opener_round.stl", "fan_blade.stl"} do
      local surface = bw.surface.read(models .. name, {unit = "mm"})
      if not surface then return end
      local mesh = assert(bw.mesh.fill(surface, {elements = 1500}))
      local session = assert(bw.edit(bw.model {mesh = mesh, material = bw.material.pla}))
      assert(session:pose(random_changes(session, 1 + i % 3, i)))
      judge(name, session, surface)
    end
  end)
end)
