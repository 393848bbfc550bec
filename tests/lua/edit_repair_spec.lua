-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edits that invert elements: relaxed, refilled, refused.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"
local edit_bodies = require "edit_bodies"

local body, same_nodes, compare = edit_bodies.body, edit_bodies.same_nodes, edit_bodies.compare

-- Turns the neck further and further about an axis, one way and then the other, until an edit ends as asked for.
local function turn_until(session, axis, ending)
  for step = 0, 47 do
    local degrees = (60 + 5 * (step % 24)) * (step < 24 and 1 or -1)
    local ok, message, details = session:bone("neck"):set {rotation = {[axis] = degrees}}
    if ok and session.edits[#session.edits].mesh == ending then return degrees end
    if not ok and ending == "refused" then return degrees, message, details end
    if ok then assert(session:undo()) end
  end
  error("no turn ended " .. ending)
end

-- The boundary's corner nodes are where the subdomains as they were at first put them.
local function surface_is_posed(session)
  local first = session.history[1].topology.subdomains
  local want = assert(first:posed_nodes(assert(first.skeleton:pose_maps(session.current_pose))))
  local _, rest_nodes = session.rest:surface()
  local _, nodes = session.mesh:surface()
  assert.truthy((want:gather(rest_nodes) - session.mesh.nodes:gather(nodes)):norm() < 1e-15)
end

describe("an edit that inverts elements", function()
  it("has inner nodes relaxed, alike whatever came before", function()
    local session = body()
    local degrees = turn_until(session, "z", "relaxed")
    compare(session, assert(session:solve()))
    surface_is_posed(session)
    local mesh = session.mesh
    assert(session:bone("left_shin"):rotate {z = 10})
    compare(session, assert(session:solve()))
    assert(session:bone("left_shin"):reset())
    assert.is_true(same_nodes(mesh, session.mesh))
    assert(session:reset())
    assert.is_true(same_nodes(session.rest, session.mesh))
    compare(session, assert(session:solve()))
    local strict = body {relax = false, refill = false}
    local message, details
    local ok = strict:bone("neck"):set {rotation = {z = degrees}}
    if not ok then
      ok, message, details = strict:bone("neck"):set {rotation = {z = degrees}}
      check.fails("geometry", "folds the part over itself", ok, message, details)
    end
  end)

  it("keeps the directions of a material that turns through a refill", function()
    local session = body {rotate_material = true}
    turn_until(session, "x", "refilled")
    compare(session, assert(session:solve {check = true}))
    assert(session:bone("trunk"):rotate {x = 10, z = 20})
    compare(session, assert(session:solve {check = true}))
    assert.truthy(session.part.material.rotated_by_element)
  end)

  it("has blended subdomains refilled where that fails, and goes on", function()
    local session = body()
    local degrees = turn_until(session, "x", "refilled")
    assert.truthy(session.mesh:shapes():min() > 0)
    surface_is_posed(session)
    local refilled = session.mesh
    local result = assert(session:solve())
    assert.truthy(tostring(result.reused):find "^pattern no, .*mesh refilled")
    compare(session, result)
    assert.truthy(session.part.supports[1].on.facet_count > 0)
    -- further edits on the refilled mesh
    assert(session:bone("left_shin"):scale {1, 1.2, 1.2})
    result = assert(session:solve())
    assert.is_true(result.reused.pattern)
    compare(session, result)
    surface_is_posed(session)
    assert(session:bone("trunk"):rotate {x = 10, z = 20})
    result = assert(session:solve())
    compare(session, result)
    assert.truthy(result.reused.subdomains_changed < result.reused.subdomains)
    assert(session:bone("neck"):set {rotation = {x = 0.8 * degrees}})
    surface_is_posed(session)
    compare(session, assert(session:solve()))
    -- back to the mesh as it was, and forth
    local last = session.mesh
    for _ = 1, 3 do assert(session:undo()) end
    assert.is_true(same_nodes(refilled, session.mesh))
    assert(session:undo())
    assert.is_true(same_nodes(session.rest, session.mesh))
    compare(session, assert(session:solve()))
    for _ = 1, 4 do assert(session:redo()) end
    assert.is_true(same_nodes(last, session.mesh))
    -- and by its script
    local path = check.folder() .. "/edits.lua"
    assert(session:save(path))
    assert.is_true(same_nodes(last, assert(bw.edit.load(path, (body()))).mesh))
  end)

  it("has blended subdomains refilled, and still lets elements be assigned", function()
    local session = body()
    turn_until(session, "x", "refilled")
    -- an element of the filling beside one that follows the neck, and one that follows the neck
    local label, neighbours = session.subdomains.element_subdomain, session.mesh.neighbours
    local neck = session.skeleton:bone("neck").index
    local from = session.history[2].topology.element_from
    local blended, following = {}, {}
    for e = 1, session.mesh.element_count do
      for k = 1, 4 do
        local other = neighbours(e, k)
        local beside = other > 0 and session.subdomains[label[other]].bones[1] == "neck"
          and session.subdomains[label[other]].type == "R"
        if beside and session.subdomains[label[e]].type == "F" then
          following[#following + 1] = other
          if from[e] < 0 then blended[#blended + 1] = e end
        end
      end
    end
    local before = session.subdomains[neck].elements
    assert.truthy(#blended > 0 and #following > 0 and session.subdomains[neck].type == "R")
    -- the first that leaves the neck's subdomain in one piece
    local function assign_one(list, bone)
      for _, e in ipairs(list) do
        local ok, edited = pcall(session.assign, session, {e}, bone)
        if ok and edited then return true end
      end
    end
    assert.is_true(assign_one(following))
    assert.is_true(session.subdomains[neck].elements < before)
    compare(session, assert(session:solve()))
    assert(session:undo())
    assert.is_true(assign_one(blended, "neck"))
    assert.is_true(session.subdomains[neck].elements > before)
    compare(session, assert(session:solve()))
    local mesh, path = session.mesh, check.folder() .. "/edits.lua"
    assert(session:save(path))
    assert.is_true(same_nodes(mesh, assert(bw.edit.load(path, (body()))).mesh))
    for _ = 1, 2 do assert(session:undo()) end
    assert.is_true(same_nodes(session.rest, session.mesh))
    check.raises("from 1 to", session.assign, session, {session.mesh.element_count + 1}, "neck")
  end)

  it("is refused where refilling would lose a load on an inner node", function()
    local session, part = body()
    local degrees = turn_until(session, "x", "refilled")
    assert(session:undo())
    part:load {nodal = core.array.map("a * 0 + 1e-3", {a = part.mesh.nodes})}
    local ok, message, details = session:bone("neck"):set {rotation = {x = degrees}}
    check.fails("unsupported", "node", ok, message, details)
    assert.equal(0, #session.edits)
  end)

  it("is refused where nothing helps, and the session is as it was", function()
    local session = body()
    assert(session:bone("trunk"):scale {1, 1.1, 1.1})
    local mesh = session.mesh
    local _, message, details = turn_until(session, "y", "refused")
    assert.equal("geometry", details.status)
    assert.truthy(details.inverted > 0 and details.element > 0)
    assert.truthy(message:find "the edit folds the part over itself, at worst at %([^()]+%) mm, between %a")
    assert.truthy(message:find("nor does filling it again (", 1, true))
    assert.truthy(message:find("make the edit smaller", 1, true))
    assert.falsy(message:find "element")
    assert.equal(3, #details.at)
    assert.equal(1, #session.edits)
    assert.is_true(same_nodes(mesh, session.mesh))
    compare(session, assert(session:solve()))
  end)
end)
