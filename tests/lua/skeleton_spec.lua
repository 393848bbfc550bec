-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Skeletons made, asked, changed, written; the subdomains that follow their bones.
local bw = require "barwright"
local check = require "check"
local edit_bodies = require "edit_bodies"

local mm = 1e-3
local beam_skeleton, beam_part, beam = edit_bodies.beam_skeleton, edit_bodies.beam_part, edit_bodies.beam
local body_skeleton, body, compare = edit_bodies.body_skeleton, edit_bodies.body, edit_bodies.compare

describe("a skeleton", function()
  it("is made from named joints and bones", function()
    local s = body_skeleton()
    assert.equal(9, s.joint_count)
    assert.equal(8, s.bone_count)
    assert.equal("hip", s.root)
    local shin = s:bone "left_shin"
    assert.equal("left_thigh", shin.parent)
    assert.equal("left_knee", shin.head)
    assert.same({}, shin.children)
    check.near(20.0997512422 * mm, shin.length, 1e-9)
    assert.same({"left_shin"}, s:bone("left_thigh").children)
    assert.truthy(tostring(s):find "skeleton of 9 joints and 8 bones, root hip\n  trunk: hip to chest, 40 mm")
  end)

  it("names the nearest joint and bone", function()
    local s = beam_skeleton()
    check.raises("no bone 'uper': did you mean 'upper'", s.bone, s, "uper")
    check.raises("no joint 'x'", s.joint, s, "x")
    check.raises("did you mean 'knee'", bw.skeleton.create,
      {joints = {hip = {0, 0, 0}, knee = {0, 0, 1}}, bones = {{"hip", "kne"}}})
    check.raises("unknown option 'bone'", bw.skeleton.create, {joints = {}, bone = {}})
    check.raises("at least one bone", bw.skeleton.create, {joints = {}, bones = {}})
    check.raises("two joints", bw.skeleton.create, {joints = {a = {0, 0, 0}}, bones = {{"a"}}})
  end)

  it("says what is wrong by its names", function()
    local joints = {hip = {0, 0, 0}, knee = {0, 0, 1}, foot = {0, 0, 1}}
    check.raises('bone "shin", from joint "knee" to joint "foot", has no length', bw.skeleton.create,
      {joints = joints, bones = {{"hip", "knee"}, {"knee", "foot", name = "shin"}}})
    check.raises('bone "again", from joint "hip" to joint "knee", closes a cycle', bw.skeleton.create,
      {joints = joints, bones = {{"hip", "knee"}, {"hip", "knee", name = "again"}}})
  end)

  it("in another unit than the part is refused", function()
    local far = bw.skeleton.create {joints = {a = {0, 50, 50}, b = {500, 50, 50}, c = {1000, 50, 50}},
      bones = {{"a", "b"}, {"b", "c"}}}
    check.fails("geometry", "is its unit that of the part?", bw.edit(beam_part(), {skeleton = far}))
  end)

  it("is changed into a new one", function()
    local s = beam_skeleton()
    local more = s:insert_joint("upper", 0.5, "middle")
    assert.equal(3, more.bone_count)
    assert.same({0.25, 0.05, 0.05}, more:joint("middle").at)
    assert.equal(2, more:merge("upper", more:bone("upper").children[1]).bone_count)
    assert.same({1, 0, 0}, s:move_joint("c", {1, 0, 0}):joint("c").at)
    assert.equal("b", s:with_root("b").root)
    assert.equal(1, s:remove("lower").bone_count)
    assert.equal(2, s.bone_count)
  end)

  it("goes to a file and back", function()
    local s, path = body_skeleton(), check.folder() .. "/s.tgf"
    assert(s:write(path))
    local back = assert(bw.skeleton.read(path))
    assert.same(s.joint_names, back.joint_names)
    assert.same(s.bone_names, back.bone_names)
    assert.truthy((s.joints - back.joints):norm() < 1e-15)
    check.fails("io", "missing.tgf", bw.skeleton.read "missing.tgf")
  end)
end)

-- ---- subdomains ---------------------------------------------------------------------------------------

describe("subdomains", function()
  it("cover the part, and say what they follow", function()
    local subdomains = body().subdomains
    for _, beyond in ipairs {0, -1, #subdomains + 1, math.mininteger, math.maxinteger} do
      assert.is_nil(subdomains[beyond])
    end
    local elements, rigid = 0, 0
    for i, subdomain in ipairs(subdomains) do
      assert.equal(i, subdomain.index)
      elements = elements + subdomain.elements
      if subdomain.type == "R" then
        rigid = rigid + 1
        assert.same({subdomain.bone}, subdomain.bones)
      end
    end
    assert.equal(subdomains.mesh.element_count, elements)
    assert.equal(subdomains.rigid_count, rigid)
    assert.truthy(#subdomains > rigid)
    assert.truthy(tostring(subdomains):find "subdomains: %d+ that follow a bone")
    assert.equal(subdomains.mesh.node_count, #subdomains.node_subdomain)
  end)

  it("are changed by hand, as an edit", function()
    local session = beam()
    local blended = session.subdomains[3]
    local before = blended.elements
    -- an element of the blended subdomain beside one of the bone's
    local label, neighbours = session.subdomains.element_subdomain, session.mesh.neighbours
    local chosen
    for e = 1, session.mesh.element_count do
      for k = 1, 4 do
        local other = neighbours(e, k)
        if label[e] == 3 and other > 0 and label[other] == 1 then chosen = e end
      end
    end
    assert(session:assign({chosen}, "upper"))
    assert.equal(before - 1, session.subdomains[3].elements)
    assert(session:bone("upper"):scale(1.1))
    compare(session, assert(session:solve()))
    assert(session:assign({chosen}))
    assert.equal(before, session.subdomains[3].elements)
    compare(session, assert(session:solve()))
    assert(session:undo())
    assert.equal(before - 1, session.subdomains[3].elements)
    for _ = 1, 2 do assert(session:undo()) end
    assert.equal(before, session.subdomains[3].elements)
    check.raises("bone 'nobody'", session.assign, session, {chosen}, "nobody")
  end)

  it("take a threshold for every bone", function()
    local loose = beam {threshold = 0.6}.subdomains
    local strict = beam {threshold = 0.6, thresholds = {lower = 0.99}}.subdomains
    assert.truthy(strict[2].elements < loose[2].elements)
    assert.truthy(strict[1].elements >= loose[1].elements)
    check.raises("no bone 'loer': did you mean 'lower'", beam, {thresholds = {loer = 0.5}})
  end)

  it("lower thresholds until a bone has its fraction of the elements", function()
    local never = beam {threshold = 1, fraction = 0}.subdomains
    local half = beam {threshold = 1, fraction = 0.5}.subdomains
    local more = beam {threshold = 1, fraction = 0.8}.subdomains
    assert.equal(1, #never)
    for bone = 1, 2 do assert.truthy(half[bone].elements < more[bone].elements) end
    check.raises("option 'fraction'", beam, {fraction = 2})
  end)
end)
