-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edit sessions: edits, their mending, undo, scripts, and that a session's answer is that of a part
-- made anew.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

-- ---- a beam of two bones, and a body with limbs ----------------------------------------------------

local function beam_skeleton()
  return bw.skeleton.create {joints = {a = {0, 0.05, 0.05}, b = {0.5, 0.05, 0.05}, c = {1, 0.05, 0.05}},
    bones = {{"a", "b", name = "upper"}, {"b", "c", name = "lower"}}, root = "a"}
end

local function beam_part(order)
  local mesh = check.beam({16, 2, 2}, order or 2)
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
  return part:load {on = mesh.boundary:above(1, 1), force = {0, 0, -10}}
end

local function beam(wish)
  wish = wish or {}
  wish.skeleton = wish.skeleton or beam_skeleton()
  return assert(bw.edit(beam_part(), wish))
end

local mm = 1e-3
local body_joints = {
  hip = {0, 0, 0}, chest = {0, 0, 40 * mm}, head = {0, 0, 60 * mm},
  left_hip = {8 * mm, 0, -4 * mm}, left_knee = {12 * mm, 0, -22 * mm}, left_foot = {14 * mm, 0, -42 * mm},
  right_hip = {-8 * mm, 0, -4 * mm}, right_knee = {-12 * mm, 0, -22 * mm},
  right_foot = {-14 * mm, 0, -42 * mm},
}
local body_bones = {{"hip", "chest", name = "trunk"}, {"chest", "head", name = "neck"},
  {"hip", "left_hip"}, {"left_hip", "left_knee", name = "left_thigh"},
  {"left_knee", "left_foot", name = "left_shin"}, {"hip", "right_hip"},
  {"right_hip", "right_knee", name = "right_thigh"}, {"right_knee", "right_foot", name = "right_shin"}}

local function body_skeleton()
  return bw.skeleton.create {joints = body_joints, bones = body_bones, root = "hip"}
end

local made
local function body_mesh()
  if made then return made end
  local limbs = {}
  for _, bone in ipairs(body_bones) do
    limbs[#limbs + 1] = bw.shapes.limb(body_joints[bone[1]], body_joints[bone[2]], 6 * mm, 5 * mm)
  end
  local surface = assert(bw.surface.implicit(bw.shapes.join(limbs, 3 * mm),
    {low = {-0.025, -0.01, -0.055}, high = {0.025, 0.01, 0.072}, cells = 40}))
  made = assert(bw.mesh.fill(surface, {elements = 1500, order = 2}))
  return made
end

local function body(wish)
  local mesh = body_mesh()
  local part = bw.model {mesh = mesh, material = bw.material.zp150}
  part:fix(mesh.boundary:below(3, -44 * mm))
  part:load {on = mesh.boundary:above(3, 60 * mm), force = {0, 1, -2}}
  wish = wish or {}
  wish.skeleton = wish.skeleton or body_skeleton()
  wish.heat = wish.heat or 1 -- wide joints: few elements stand wide turns
  return assert(bw.edit(part, wish)), part
end

local function same_nodes(a, b)
  return (a.nodes - b.nodes):norm() == 0
end

-- The session's displacement beside that of its part solved anew.
local function compare(session, result)
  local fresh = assert(session.part:solve())
  local difference = (fresh.displacement - result.displacement):norm() / fresh.displacement:norm()
  assert.truthy(difference < 1e-8, ("differs by %g"):format(difference))
  local stress = fresh.von_mises
  assert.truthy((stress - result.von_mises):norm() / stress:norm() < 1e-8)
end

-- ---- skeletons -------------------------------------------------------------------------------------

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

-- ---- domains ---------------------------------------------------------------------------------------

describe("domains", function()
  it("cover the part, and say what they follow", function()
    local domains = body().domains
    local elements, rigid = 0, 0
    for i, domain in ipairs(domains) do
      assert.equal(i, domain.index)
      elements = elements + domain.elements
      if domain.type == "R" then
        rigid = rigid + 1
        assert.same({domain.bone}, domain.bones)
      end
    end
    assert.equal(domains.mesh.element_count, elements)
    assert.equal(domains.rigid_count, rigid)
    assert.truthy(#domains > rigid)
    assert.truthy(tostring(domains):find "domains: %d+ that follow a bone")
    assert.equal(domains.mesh.node_count, #domains.node_domain)
  end)

  it("are changed by hand, as an edit", function()
    local session = beam()
    local blended = session.domains[3]
    local before = blended.elements
    -- an element of the blended domain beside one of the bone's
    local label, neighbours = session.domains.element_domain, session.mesh.neighbours
    local chosen
    for e = 1, session.mesh.element_count do
      for k = 1, 4 do
        local other = neighbours(e, k)
        if label[e] == 3 and other > 0 and label[other] == 1 then chosen = e end
      end
    end
    assert(session:assign({chosen}, "upper"))
    assert.equal(before - 1, session.domains[3].elements)
    assert(session:bone("upper"):scale(1.1))
    compare(session, assert(session:solve()))
    assert(session:assign({chosen}))
    assert.equal(before, session.domains[3].elements)
    compare(session, assert(session:solve()))
    assert(session:undo())
    assert.equal(before - 1, session.domains[3].elements)
    for _ = 1, 2 do assert(session:undo()) end
    assert.equal(before, session.domains[3].elements)
    check.raises("bone 'nobody'", session.assign, session, {chosen}, "nobody")
  end)

  it("take a threshold for every bone", function()
    local loose = beam {threshold = 0.6}.domains
    local strict = beam {threshold = 0.6, thresholds = {lower = 0.99}}.domains
    assert.truthy(strict[2].elements < loose[2].elements)
    assert.truthy(strict[1].elements >= loose[1].elements)
    check.raises("no bone 'loer': did you mean 'lower'", beam, {thresholds = {loer = 0.5}})
  end)
end)

-- ---- edits -----------------------------------------------------------------------------------------

describe("an edit", function()
  it("turns, scales and moves what follows a bone", function()
    local session = beam()
    assert(session:bone("lower"):rotate {axis = {0, 0, 1}, degrees = 30})
    local to = session:bone("lower").to
    check.near(0.5 + 0.5 * math.cos(math.pi / 6), to[1], 1e-12)
    check.near(0.05 + 0.25, to[2], 1e-12)
    assert(session:bone("lower"):scale {1.2, 1, 1})
    check.near(0.05 + 0.3, session:bone("lower").to[2], 1e-12)
    assert(session:bone("upper"):translate {0, 0, 0.1})
    check.near(0.15, session:bone("lower").to[3], 1e-12)
    assert.equal(3, #session.edits)
    assert.truthy(tostring(session):find 'session:bone%("upper"%):translate{0.0, 0.0, 0.1}'
      or tostring(session):find 'session:bone%("upper"%):translate{0, 0, 0.1}')
    assert.truthy(tostring(session:bone "lower"):find "scaled by %(1.2, 1, 1%), turned by 30 degrees")
  end)

  it("turns in the directions of space, whatever the parent does", function()
    local session = beam()
    assert(session:bone("upper"):rotate {x = 90})
    assert(session:bone("lower"):rotate {axis = {0, 0, 1}, degrees = 90})
    local bone = session:bone "lower"
    check.near(bone.from[2] + 0.5, bone.to[2], 1e-12)
  end)

  it("on the whole turns the part as a body, to rounding", function()
    local session = beam()
    local before = session.mesh.nodes
    assert(session:bone("upper"):rotate {axis = {0, 0, 1}, degrees = 90})
    local want = core.array.map("a[1] ^ 2 + a[2] ^ 2", {a = before - 0.05})
    assert.truthy(want)
    check.near(0.1, session.mesh.volume * 10, 1e-12)
    assert.truthy(math.abs(session.mesh.box.size[2] - 1) < 1e-12)
  end)

  it("of several bones is one step", function()
    local session = beam()
    assert(session:pose {upper = {scale = {1, 2, 2}}, lower = {rotation = {y = 10}, scale = 1.5}})
    assert.equal(1, #session.edits)
    assert.same({1, 2, 2}, session:bone("upper").factors)
    assert(session:bone("upper"):set {scale = {1, 1, 1}})
    assert.same({1, 1, 1}, session:bone("upper").factors)
    assert(session:bone("lower"):reset())
    assert.same({1.5, 1.5, 1.5}, (assert(session:undo()):bone("lower").factors))
    assert(session:reset())
    assert.same({1, 1, 1}, session:bone("lower").factors)
  end)

  it("that is wrong raises, names the nearest, and changes nothing", function()
    local session = beam()
    check.raises("no bone 'louer': did you mean 'lower'", session.bone, session, "louer")
    local bone = session:bone "lower"
    check.raises("greater than 0", bone.scale, bone, {1, -1, 1})
    check.raises("three finite numbers", bone.scale, bone, {1, 2})
    check.raises("three finite numbers", bone.translate, bone, {1, 0 / 0, 1})
    check.raises("axis of some length", bone.rotate, bone, {axis = {0, 0, 0}, degrees = 1})
    check.raises("unknown option 'degres'", bone.rotate, bone, {axis = {0, 0, 1}, degres = 1})
    check.raises("rows of length 1", bone.rotate, bone, {{1, 0, 0}, {0, 2, 0}, {0, 0, 1}})
    check.raises("not a reflection", bone.rotate, bone, {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}})
    check.raises("unknown option 'scal'", session.pose, session, {lower = {scal = {1, 1, 1}}})
    check.raises("did you mean 'solve'", function() return session.sole end)
    check.raises("did you mean 'rotate'", function() return bone.rotat end)
    check.raises("unknown option 'skelton': did you mean 'skeleton'", bw.edit, beam_part(), {skelton = 1})
    check.raises("unknown option 'metod'", session.solve, session, {metod = "auto"})
    check.raises("'refactr' is not known: did you mean 'refactor'", session.solve, session,
      {method = "refactr"})
    assert.equal(0, #session.edits)
  end)

  it("called without a colon, or assigned to, is told apart", function()
    local session = beam()
    local bone = session:bone "lower"
    check.raises("with a colon", session.bone, "lower")
    check.raises("with a colon", session.solve, {method = "auto"})
    check.raises("with a colon", session.undo)
    check.raises("with a colon", session.write, "part.vtu")
    check.raises("bone:scale(...)", bone.scale, 2)
    check.raises("by assignment to 'mesh'", function() session.mesh = 1 end)
    check.raises("by assignment to 'factors'", function() bone.factors = {1, 2, 2} end)
  end)

  it("by numbers out of all bounds is refused, and axes may have any length", function()
    local session = beam()
    local bone = session:bone "lower"
    for _, factor in ipairs {1e7, 1e150, 1e300} do
      check.fails("geometry", "is a factor or a length wrong", bone:scale(factor))
    end
    for _, length in ipairs {1e7, 1e100, 1e308} do
      check.fails("geometry", "is a factor or a length wrong", session:bone("upper"):translate {length, 0, 0})
    end
    check.raises("{lowest, highest} in degrees", session.limit, session, "lower", {twist = {-1 / 0, 1 / 0}})
    check.raises("one of degrees, radians", bone.rotate, bone, {axis = {0, 0, 1}, degrees = "ten"})
    assert.equal(0, #session.edits)
    for _, length in ipairs {1e200, 1e-200, 1} do
      assert(bone:rotate {axis = {0, 0, length}, degrees = 10})
    end
    check.near(0.05 + 0.5 * math.sin(math.pi / 6), bone.to[2], 1e-12)
  end)

  it("takes loads and supports along", function()
    local session = beam()
    assert(session:bone("upper"):scale {1, 2, 2})
    local loads = session.part.loads
    assert.same({0, 0, -10}, loads[2].resultant)
    check.near(session.part.mesh.volume * 7850 * 9.81, -loads[1].resultant[3], 0.02)
    check.near(0.04, session.part.supports[1].on.area, 1e-9)
  end)
end)

-- ---- mending ---------------------------------------------------------------------------------------

-- Turns the neck further and further about an axis until an edit ends as asked for.
local function turn_until(session, axis, ending)
  for degrees = 60, 175, 5 do
    local fine, message, details = session:bone("neck"):set {rotation = {[axis] = degrees}}
    if fine and session.edits[#session.edits].mesh == ending then return degrees end
    if not fine and ending == "refused" then return degrees, message, details end
    if fine then assert(session:undo()) end
  end
  error("no turn ended " .. ending)
end

-- The boundary's corner nodes are where the domains as they were at first put them.
local function surface_is_posed(session)
  local first = session.history[1].topology.domains
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
    local fine = strict:bone("neck"):set {rotation = {z = degrees}}
    if not fine then
      fine, message, details = strict:bone("neck"):set {rotation = {z = degrees}}
      check.fails("geometry", "the worst is element", fine, message, details)
    end
  end)

  it("has blended domains refilled where that fails, and goes on", function()
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
    assert.truthy(result.reused.pieces_touched < result.reused.pieces)
    assert(session:bone("neck"):set {rotation = {x = degrees - 20}})
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

  it("has blended domains refilled, and still lets elements be assigned", function()
    local session = body()
    turn_until(session, "x", "refilled")
    -- an element of the filling beside one that follows the neck, and one that follows the neck
    local label, neighbours = session.domains.element_domain, session.mesh.neighbours
    local neck = session.skeleton:bone("neck").index
    local from = session.history[2].topology.element_from
    local blended, following = {}, {}
    for e = 1, session.mesh.element_count do
      for k = 1, 4 do
        local other = neighbours(e, k)
        local beside = other > 0 and session.domains[label[other]].bones[1] == "neck"
          and session.domains[label[other]].type == "R"
        if beside and session.domains[label[e]].type == "F" then
          following[#following + 1] = other
          if from[e] < 0 then blended[#blended + 1] = e end
        end
      end
    end
    local before = session.domains[neck].elements
    assert.truthy(#blended > 0 and #following > 0 and session.domains[neck].type == "R")
    -- the first that leaves the neck's domain in one piece
    local function assign_one(list, bone)
      for _, e in ipairs(list) do
        if pcall(session.assign, session, {e}, bone) then return true end
      end
    end
    assert.is_true(assign_one(following))
    assert.is_true(session.domains[neck].elements < before)
    compare(session, assert(session:solve()))
    assert(session:undo())
    assert.is_true(assign_one(blended, "neck"))
    assert.is_true(session.domains[neck].elements > before)
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
    local fine, message, details = session:bone("neck"):set {rotation = {x = degrees}}
    check.fails("unsupported", "node", fine, message, details)
    assert.equal(0, #session.edits)
  end)

  it("is refused where nothing helps, and the session is as it was", function()
    local session = body()
    assert(session:bone("trunk"):scale {1, 1.1, 1.1})
    local mesh = session.mesh
    local _, message, details = turn_until(session, "y", "refused")
    assert.equal("geometry", details.status)
    assert.truthy(details.inverted > 0 and details.element > 0)
    assert.truthy(message:find "the edit inverts %d+ elements?; the worst is element %d+ at %(")
    assert.truthy(message:find("could not be filled in", 1, true))
    assert.equal(1, #session.edits)
    assert.is_true(same_nodes(mesh, session.mesh))
    compare(session, assert(session:solve()))
  end)
end)

-- ---- inverse kinematics ----------------------------------------------------------------------------

describe("reaching", function()
  it("brings a joint to a place, and several at once", function()
    local session = body()
    local report = assert(session:reach("left_foot", {20 * mm, 3 * mm, -40 * mm}))
    assert.is_true(report.reached)
    local foot = session:bone("left_shin").to
    assert.truthy(math.abs(foot[1] - 0.02) < 1e-6 and math.abs(foot[2] - 0.003) < 1e-6)
    local wide = assert(session:reach {{joint = "left_foot", at = {18 * mm, 0, -37 * mm}, from = "left_thigh"},
      {bone = "right_shin", at = {-18 * mm, 0, -37 * mm}, from = "right_thigh"}})
    assert.truthy(wide.distance < 1e-5)
    assert.equal(2, #session.edits)
    check.raises("no joint or bone 'left_fot': did you mean 'left_foot'", session.reach, session,
      "left_fot", {0, 0, 0})
    check.raises("one of joint and bone", session.reach, session, {{at = {0, 0, 0}}})
  end)

  it("keeps to limits", function()
    local session = body()
    local free = assert(session:reach("left_foot", {30 * mm, 0, -30 * mm}))
    assert(session:undo())
    assert(session:limit("left_knee", {swing = 5, twist = {-10, 10}}))
    assert(session:limit("left_thigh", {swing = 5}))
    local held = assert(session:reach("left_foot", {30 * mm, 0, -30 * mm}))
    assert.truthy(held.distance > free.distance)
    assert.is_false(held.reached)
    check.raises("twist", session.limit, session, "left_knee", {twist = {1}})
    check.raises("no joint 'left_kne'", session.limit, session, "left_kne", {swing = 1})
  end)
end)

-- ---- undo ------------------------------------------------------------------------------------------

describe("undo and redo", function()
  it("go to any depth, with the same bits", function()
    local session = beam()
    local seen = {session.mesh}
    for i = 1, 12 do
      assert(session:bone(i % 2 == 0 and "upper" or "lower"):rotate {x = 3, y = 2 + i, z = -i / 2})
      seen[#seen + 1] = session.mesh
    end
    for i = 12, 1, -1 do
      assert(session:undo())
      assert.is_true(same_nodes(seen[i], session.mesh))
    end
    check.fails("empty", "nothing to undo", session:undo())
    for i = 2, 13 do
      assert(session:redo())
      assert.is_true(same_nodes(seen[i], session.mesh))
    end
    check.fails("empty", "nothing to redo", session:redo())
    assert(session:undo())
    assert(session:bone("lower"):scale(1.1))
    check.fails("empty", "nothing to redo", session:redo())
  end)
end)

-- ---- solving ---------------------------------------------------------------------------------------

describe("a solve", function()
  it("is that of the part made anew, after every kind of edit, by every method", function()
    local session = body()
    local first = assert(session:solve())
    compare(session, first)
    assert.is_false(first.reused.pattern)
    assert.truthy(first:error_estimate() > 0)
    local edits = {
      function() return session:bone("neck"):rotate {axis = {1, 0, 0}, degrees = 20} end,
      function() return session:bone("trunk"):scale {1, 1.2, 1.3} end,
      function()
        local thick = {scale = {1, 1.3, 1.3}}
        return session:pose {left_thigh = thick, right_thigh = thick}
      end,
      function() return session:reach("left_foot", {18 * mm, 1 * mm, -41 * mm}) end,
      function() return session:undo() end,
      function() return session:bone("trunk"):rotate {z = 40} end,
    }
    for i, edit in ipairs(edits) do
      assert(edit())
      local result = assert(session:solve {method = ({"auto", "refactor", "iterate", "scratch"})[i % 4 + 1]})
      compare(session, result)
      assert.is_true(result.reused.pattern)
      assert.equal(session.domains.piece_count, result.reused.pieces)
      assert.truthy(tostring(result.reused):find "^pattern yes, ordering yes, %d+ of %d+ pieces, ")
    end
    assert(session:solve {check = true})
  end)

  it("of a part turned as a whole keeps every domain and the factor", function()
    local session = beam()
    assert(session:bone("lower"):rotate {y = 20})
    assert(session:solve())
    assert(session:bone("upper"):rotate {x = 10, y = 20, z = 30})
    local result = assert(session:solve())
    compare(session, result)
    assert.equal(0, result.reused.pieces_touched)
    assert.equal(1, result.reused.factor_kept)
  end)

  it("knows of loads that were added later, and of other load cases", function()
    local part = beam_part()
    local session = assert(bw.edit(part, {skeleton = beam_skeleton()}))
    local before = assert(session:solve()).displacement:norm()
    part:load {on = part.mesh.boundary:above(1, 1), force = {0, 0, -1000}}
    assert.truthy(assert(session:solve()).displacement:norm() > 2 * before)
    assert(session:bone("lower"):scale {1, 1.1, 1.1})
    compare(session, assert(session:solve()))
    local other = bw.model {mesh = part.mesh, material = part.material}
    other:load {on = part.mesh.boundary:above(1, 1), force = {0, 1, 0}}
    other:fix(part.mesh.boundary:below(1, 0))
    assert.equal(session.mesh, assert(session:moved(other)).mesh)
    local sideways = assert(session:solve {part = other, method = "refactor"})
    local fresh = assert(assert(session:moved(other)):solve())
    assert.truthy((fresh.displacement - sideways.displacement):norm() < 1e-8 * fresh.displacement:norm())
    assert.equal(1, sideways.reused.factor_kept)
    compare(session, assert(session:solve()))
    check.raises("a model expected, got mesh", session.solve, session, {part = part.mesh})
  end)

  it("writes fields and pictures of the shape as it is", function()
    local session, folder = beam(), check.folder()
    assert(session:bone("lower"):rotate {z = 30})
    assert(session:write(folder .. "/now.vtu"))
    assert(session:picture(folder .. "/now.png", {field = "von_mises"}))
    local mesh, file = bw.mesh.read(folder .. "/now.vtu")
    assert.is_true(same_nodes(mesh, session.mesh))
    assert.truthy(file.fields.domain and file.fields.von_mises)
    assert(assert(session:surface()):write(folder .. "/now.stl"))
    assert.is_nil(assert(session:solve()).times)
    assert(session:report(folder .. "/now.html", {title = "A bent beam"}))
    local page = check.read(folder .. "/now.html")
    assert.truthy(page:find("A bent beam", 1, true) and page:find("turned by 30 degrees", 1, true))
    assert.truthy(page:find("session:bone(&quot;lower&quot;):rotate{z = 30}", 1, true))
  end)
end)

-- ---- any part, any edits -----------------------------------------------------------------------------

describe("a session", function()
  local function check_edits(part, wish, solve)
    local session = assert(bw.edit(part, wish))
    local function compare_with_fresh()
      local now, fresh = assert(session:solve(solve)), assert(session.part:solve(solve and
        {inertia_relief = solve.inertia_relief}))
      local difference = (fresh.displacement - now.displacement):norm() / fresh.displacement:norm()
      assert.truthy(difference < 1e-8, ("differs by %g"):format(difference))
    end
    compare_with_fresh()
    assert(session:bone("lower"):scale {1.1, 1.3, 1.2}:rotate {x = 10, z = 35})
    compare_with_fresh()
    assert(session:bone("upper"):rotate {x = 30, y = 20, z = 10})
    compare_with_fresh()
    return session
  end

  it("is as good on linear elements, orthotropic material, free bodies", function()
    local wish = function() return {skeleton = beam_skeleton()} end
    check_edits(beam_part(1), wish())
    local mesh = check.beam({16, 2, 2}, 2)
    local layered = bw.material.orthotropic {young = {2e9, 3e9, 1.5e9}, poisson = {0.3, 0.25, 0.28},
      shear = {0.8e9, 0.7e9, 0.9e9}, density = 1200}
    local part = bw.model {mesh = mesh, material = layered}
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {3, 1, -10}}
    check_edits(part, wish())
    local free = bw.model {mesh = mesh, material = bw.material.pla}
    free:load {on = mesh.boundary:above(1, 1), force = {0, 0, -10}}
    check.fails("free", "6 rigid motions are free", assert(bw.edit(free, wish())):solve())
    check_edits(free, wish(), {inertia_relief = true})
    local sliding = bw.model {mesh = mesh, material = bw.material.pla}
    sliding:slide(mesh.boundary:below(1, 0)):fix(mesh.boundary:nearest({0, 0, 0}))
    sliding:slide(mesh.boundary:below(2, 0), {0, 1, 0}):gravity {0, 0, -9.81}
    check_edits(sliding, wish())
  end)

  it("comes through random edits, undos and redos with the equations of a new part", function()
    local runs = os.getenv "BARWRIGHT_FULL" and 40 or 3
    local seed = 12345
    local function random(low, high)
      seed = (seed * 1103515245 + 12345) % 2147483648
      return low + (high - low) * (seed // 65536 / 32768)
    end
    local refused = 0
    for _ = 1, runs do
      local session = body()
      local names = session.skeleton.bone_names
      for _ = 1, 6 do
        local bone = session:bone(names[math.floor(random(1, #names + 1))])
        local kind = math.floor(random(0, 6))
        local fine, _, details
        if kind == 0 then
          fine, _, details = session:undo()
        elseif kind == 1 then
          fine, _, details = session:redo()
        elseif kind == 2 then
          fine, _, details = bone:translate {random(-1, 1) * mm, random(-1, 1) * mm, random(-1, 1) * mm}
        elseif kind == 3 then
          fine, _, details = bone:scale {random(0.8, 1.3), random(0.8, 1.3), random(0.8, 1.3)}
        else
          fine, _, details = bone:rotate {axis = {random(-1, 1), random(-1, 1), 1.1},
            degrees = random(-50, 50)}
        end
        if not fine then
          refused = refused + 1
          assert.truthy(details.status == "geometry" or details.status == "empty")
        end
        local result = assert(session:solve {check = true})
        assert.truthy(result.reused.difference_stiffness < 1e-13)
        compare(session, result)
      end
    end
    assert.truthy(refused < 5 * runs)
  end)
end)

-- ---- forks -----------------------------------------------------------------------------------------

describe("a fork", function()
  it("tries edits with the same equations, and is taken over as one", function()
    local path = check.folder() .. "/journal.lua"
    local session = beam {journal = path}
    assert(session:bone("upper"):scale {1, 1.1, 1.1})
    assert(session:solve())
    local mesh, text = session.mesh, check.read(path)
    local fork = session:fork {refill = false}
    for _ = 1, 5 do
      assert(fork:bone("lower"):rotate {y = 5})
      local result = assert(fork:solve())
      assert.is_true(result.reused.pattern)
      compare(fork, result)
    end
    assert(fork:undo())
    assert.is_true(same_nodes(mesh, session.mesh))
    assert.equal(text, check.read(path))
    compare(session, assert(session:solve()))
    assert(session:adopt(fork))
    assert.equal(2, #session.edits)
    assert.truthy((session.mesh.nodes - fork.mesh.nodes):norm() < 1e-13)
    fork:close()
    compare(session, assert(session:solve()))
    local again = beam()
    assert(bw.edit.load(path, again))
    assert.is_true(same_nodes(session.mesh, again.mesh))
    check.raises("a fork of this session", session.adopt, session, again)
    assert.equal(2, #assert(session:adopt(session:fork())).edits)
  end)
end)

-- ---- scripts ---------------------------------------------------------------------------------------

describe("a script of edits", function()
  local function edit(session)
    assert(session:bone("left_thigh"):scale {1, 1.1, 1 / 3 + 1})
    assert(session:limit("left_knee", {swing = 40}))
    assert(session:reach("left_foot", {16 * mm, 0.3 * mm, -41 * mm}, {tolerance = 1e-7}))
    assert(session:bone("neck"):rotate {axis = {1, 0.1, 0}, radians = 0.1})
    assert(session:undo())
    assert(session:pose {["right_shin"] = {scale = 1.05}})
  end

  it("replays to the same bits", function()
    local session, path = body(), check.folder() .. "/edits.lua"
    edit(session)
    assert(session:save(path))
    local again = body()
    assert.equal(again, assert(bw.edit.load(path, again)))
    assert.is_true(same_nodes(session.mesh, again.mesh))
    assert.same(session.edits, again.edits)
    assert.is_nil(check.read(path):find("undo", 1, true))
  end)

  it("grows with every edit, and goes on after it was killed", function()
    local folder = check.folder()
    local path = folder .. "/journal.lua"
    local session = body {journal = path}
    edit(session)
    local bits = session.mesh
    local text = check.read(path)
    check.write(folder .. "/cut.lua", text .. 'assert(session:bone("ne')
    local again, cut = bw.edit.load(folder .. "/cut.lua", body(), {resume = true})
    assert.is_true(cut)
    assert.is_true(same_nodes(bits, again.mesh))
    assert(again:bone("neck"):scale(1.01))
    assert(again:undo())
    again:close()
    assert.equal(text .. 'assert(session:bone("neck"):scale{1.01, 1.01, 1.01})\nassert(session:undo())\n',
      check.read(folder .. "/cut.lua"))
    body({journal = path}):close()
    assert.equal(text, check.read(path .. "~"))
  end)

  it("replays after the program was killed in the middle of its edits", function()
    local folder = check.folder()
    check.write(folder .. "/part.lua", [[
local bw = require "barwright"
local mesh = bw.mesh.box {low = {0, 0, 0}, high = {1, 0.1, 0.1}, cells = {12, 2, 2}, order = 2}
local part = bw.model {mesh = mesh, material = bw.material.steel}
return part, {skeleton = bw.skeleton.create {joints = {{0, 0.05, 0.05}, {0.5, 0.05, 0.05}, {1, 0.05, 0.05}},
  bones = {{1, 2, name = "upper"}, {2, 3, name = "lower"}}, root = 1}}
]])
    check.write(folder .. "/work.lua", ([[
local bw = require "barwright"
local folder = %q
local part, wish = dofile(folder .. "/part.lua")
wish.script, wish.journal = "part.lua", folder .. "/journal.lua"
local session = assert(bw.edit(part, wish))
for i = 1, 1e9 do
  assert(session:bone(i %% 2 == 0 and "upper" or "lower"):rotate {axis = {1, i %% 7, 2}, degrees = 1 / i})
  if i %% 5 == 0 then assert(session:undo()) end
end
]]):format(folder))
    for _, seconds in ipairs {0.5, 0.9} do
      os.execute(("sh -c '\"%s\" %s/work.lua >/dev/null 2>&1 & pid=$!; sleep %g; kill -9 $pid'"):format(
        check.program, folder, seconds))
      local path = folder .. "/journal.lua"
      local lines = select(2, check.read(path):gsub("\n", "\n"))
      local session = assert(bw.edit.load(path))
      assert.truthy(#session.edits > 0 and #session.edits < lines)
    end
  end)

  it("runs by itself when it knows the script of its part", function()
    local folder = check.folder()
    check.write(folder .. "/part.lua", [[
local bw = require "barwright"
local mesh = bw.mesh.box {low = {0, 0, 0}, high = {1, 0.1, 0.1}, cells = {8, 1, 1}, order = 2}
local part = bw.model {mesh = mesh, material = bw.material.steel}
part:fix(mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
return part, {skeleton = bw.skeleton.create {joints = {{0, 0.05, 0.05}, {0.5, 0.05, 0.05}, {1, 0.05, 0.05}},
  bones = {{1, 2, name = "upper"}, {2, 3, name = "lower"}}, root = 1}}
]])
    local session = assert(bw.edit.begin(folder .. "/part.lua"))
    assert(session:bone("lower"):rotate {y = 12.5})
    assert(session:save(folder .. "/edits.lua"))
    local alone = assert(bw.edit.load(folder .. "/edits.lua"))
    assert.is_true(same_nodes(session.mesh, alone.mesh))
    local text = check.read(folder .. "/edits.lua"):gsub("return session", "print(session)")
    check.write(folder .. "/shown.lua", text)
    local code, out, complaint = check.run(folder .. "/shown.lua and arguments")
    assert.message(complaint).equal(0, code)
    assert.truthy(out:find 'session:bone%("lower"%):rotate{y = 12.5}')
  end)

  it("that is interrupted says so", function()
    local folder = check.folder()
    check.write(folder .. "/part.lua", [[
local bw = require "barwright"
local mesh = bw.mesh.box {low = {0, 0, 0}, high = {1, 0.1, 0.1}, cells = {8, 1, 1}}
return bw.model {mesh = mesh, material = bw.material.steel}, {skeleton = bw.skeleton.create {
  joints = {{0, 0.05, 0.05}, {1, 0.05, 0.05}}, bones = {{1, 2}}, root = 1}}
]])
    check.write(folder .. "/edits.lua", 'local session = require("barwright").edit.begin("part.lua")\n')
    local before = bw.progress(function() return false end)
    check.fails("cancelled", "edits.lua was interrupted while it was replayed: line 1: ",
      bw.edit.load(folder .. "/edits.lua"))
    bw.progress(before)
    assert(bw.edit.load(folder .. "/edits.lua"))
  end)

  it("that cannot be replayed says where", function()
    local folder = check.folder()
    local path = folder .. "/edits.lua"
    check.write(path, 'local session = require("barwright").edit.begin(nil, ...)\n'
      .. 'assert(session:bone("nobody"):scale{1, 1, 1})\n')
    check.fails("format", "nobody", bw.edit.load(path, beam()))
    check.fails("format", "name no script", bw.edit.load(path))
    check.fails("format", "edits.lua could not be replayed: line 2: there is no bone 'nobody'",
      bw.edit.load(path, beam()))
    check.raises("a session expected", bw.edit.load, path, {})
    check.write(path, "this is not Lua\n")
    check.fails("format", "edits.lua", bw.edit.load(path, beam()))
    check.fails("io", "none.lua", bw.edit.load(folder .. "/none.lua", beam()))
    check.fails("io", "", bw.edit(beam_part(), {skeleton = beam_skeleton(), journal = folder .. "/no/such"}))
  end)
end)

describe("a journal", function()
  it("takes the place of a journal, and of nothing else", function()
    local folder = check.folder()
    local function refuses(path)
      check.fails("io", "no journal of edits", bw.edit(beam_part(), {skeleton = beam_skeleton(), journal = path}))
    end
    check.write(folder .. "/part.lua", "return part\n")
    refuses(folder .. "/part.lua")
    assert.equal("return part\n", check.read(folder .. "/part.lua"))
    refuses(folder)
    refuses "/dev/zero"
    check.write(folder .. "/empty.lua", "")
    beam({journal = folder .. "/empty.lua"}):close()
  end)

  it("is whole again after a disk was full", function()
    local path = check.folder() .. "/journal.lua"
    local session = beam {journal = path}
    assert(session:bone("lower"):rotate {z = 5})
    local mesh, text = session.mesh, check.read(path)
    local full = io.open("/dev/full", "ab")
    if not full then return end
    session.record.file:close()
    session.record.file = full
    check.write(path, text .. 'assert(session:bone("lo') -- as much as went onto the disk
    local fine, message, details = session:bone("lower"):rotate {z = 5}
    check.fails("io", "journal.lua", fine, message, details)
    assert.is_true(same_nodes(mesh, session.mesh))
    assert.equal(1, #session.edits)
    assert(session:bone("upper"):scale(1.1)) -- there is room again
    session:close()
    assert.equal(text .. 'assert(session:bone("upper"):scale{1.1, 1.1, 1.1})\n', check.read(path))
  end)
end)

-- ---- what lives how long ---------------------------------------------------------------------------

describe("a session", function()
  it("keeps its results when it is closed, and lets go of the rest", function()
    collectgarbage()
    collectgarbage()
    local _, blocks = core.external()
    do
      local session = beam()
      assert(session:bone("lower"):rotate {z = 5})
      local result = assert(session:solve())
      local bone, mesh = session:bone "lower", session.mesh
      session:close()
      collectgarbage()
      assert.truthy(result.von_mises:max() > 0 and result.reused.pieces == 3 and mesh.volume > 0)
      assert.equal("edit session (closed)", tostring(session))
      check.raises("closed", session.bone, session, "lower")
      check.raises("closed", bone.scale, bone, 2)
      check.raises("closed", function() return session.mesh end)
    end
    collectgarbage()
    collectgarbage()
    local _, after = core.external()
    assert.equal(blocks, after)
  end)

  it("keeps poses of its states, not meshes", function()
    local session, bytes = beam(), nil
    for i = 1, 120 do
      assert(session:bone("lower"):rotate {z = i % 2 == 0 and 1 or -1})
      if i == 20 then
        collectgarbage()
        collectgarbage()
        bytes = core.external()
      end
    end
    collectgarbage()
    collectgarbage()
    assert.equal(bytes, (core.external()))
    for _ = 1, 120 do assert(session:undo()) end
    assert.is_true(same_nodes(session.rest, session.mesh))
  end)

  it("ends with a status wherever memory runs out, and leaves nothing behind", function()
    local part, path = beam_part(), check.folder() .. "/journal.lua"
    local function whole()
      local session <close> = assert(bw.edit(part, {skeleton = assert(beam_skeleton()), journal = path}))
      assert(session:bone("lower"):rotate {z = 10})
      local limit = 0.95 * assert(session:solve()).von_mises:max()
      assert(session:optimise {von_mises = limit})
      assert(session:undo())
      assert(session:save(path .. ".saved"))
      return assert(session:solve()).von_mises:max()
    end
    local function blocks()
      collectgarbage()
      collectgarbage()
      return select(2, core.external())
    end
    local highest = whole()
    local before, failures = blocks(), 0
    for _, and_later in ipairs {true, false} do
      for n = 1, 1500, os.getenv "BARWRIGHT_FULL" and 1 or 97 do
        core.fail_allocation(n, and_later)
        local fine, answer = pcall(whole)
        core.fail_allocation(0, false)
        if fine then
          check.near(highest, answer, 1e-7)
        else
          failures = failures + 1
          assert.truthy(tostring(answer):find("memory", 1, true), tostring(answer))
        end
        assert.equal(before, blocks())
      end
    end
    assert.truthy(failures > 10)
  end)

  it("is as it was when memory runs out in an edit or a solve", function()
    local session = beam()
    assert(session:bone("lower"):rotate {z = 5})
    assert(session:solve())
    local mesh, n, failures = session.mesh, 1, 0
    while true do
      core.fail_allocation(n, true)
      local fine, result, message, details = pcall(function() -- luacheck: ignore 331
        local bone, why, about = session:bone("upper"):scale {1, 1.01, 1.01}
        if not bone then return nil, why, about end
        return session:solve()
      end)
      core.fail_allocation(0, false)
      if fine and result then break end
      failures = failures + 1
      if fine then assert.equal("memory", details.status, message) end
      if #session.edits == 2 then assert(session:undo()) end
      assert.is_true(same_nodes(mesh, session.mesh))
      n = n + 11
      assert(n < 100000)
    end
    assert.truthy(failures > 3)
    compare(session, assert(session:solve()))
  end)
end)
