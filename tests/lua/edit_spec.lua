-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edits of bones, inverse kinematics, undo, forks, edits in any order.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"
local edit_bodies = require "edit_bodies"

local mm = 1e-3
local beam_skeleton, beam_part, beam = edit_bodies.beam_skeleton, edit_bodies.beam_part, edit_bodies.beam
local body, same_nodes, compare = edit_bodies.body, edit_bodies.same_nodes, edit_bodies.compare

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
    assert.truthy(tostring(session:bone "lower"):find "scaled by %(1.2, 1, 1%), rotated by 30 degrees")
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
    check.raises("factors above 0", bone.scale, bone, {1, -1, 1})
    check.raises("three finite numbers", bone.scale, bone, {1, 2})
    check.raises("three finite numbers", bone.translate, bone, {1, 0 / 0, 1})
    check.raises("an axis expected, got {0, 0, 0}", bone.rotate, bone, {axis = {0, 0, 0}, degrees = 1})
    check.raises("unknown option 'degres'", bone.rotate, bone, {axis = {0, 0, 1}, degres = 1})
    check.raises("rows of length 1", bone.rotate, bone, {{1, 0, 0}, {0, 2, 0}, {0, 0, 1}})
    check.raises("got a reflection", bone.rotate, bone, {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}})
    check.raises("unknown option 'scal'", session.pose, session, {lower = {scal = {1, 1, 1}}})
    check.raises("did you mean 'solve'", function() return session.sole end)
    check.raises("did you mean 'rotate'", function() return bone.rotat end)
    check.raises("unknown option 'skelton': did you mean 'skeleton'", bw.edit, beam_part(), {skelton = 1})
    check.raises("unknown option 'metod'", session.solve, session, {metod = "auto"})
    check.raises("a solver of bw.solver, or \"auto\"", session.solve, session,
      {solver = "refactr"})
    assert.equal(0, #session.edits)
  end)

  it("called without a colon, or assigned to, is recognised", function()
    local session = beam()
    local bone = session:bone "lower"
    check.raises("with a colon", session.bone, "lower")
    check.raises("with a colon", session.solve, {solver = "auto"})
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
    check.raises("{lowest, highest}, two numbers in degrees", session.limit, session, "lower",
      {twist = {-1 / 0, 1 / 0}})
    check.raises("one of degrees and radians", bone.rotate, bone, {axis = {0, 0, 1}, degrees = "ten"})
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
    check.raises("one of the options 'joint' and 'bone'", session.reach, session, {{at = {0, 0, 0}}})
  end)

  it("keeps to limits", function()
    local session = body()
    local free = assert(session:reach("left_foot", {30 * mm, 0, -30 * mm}))
    assert(session:undo())
    assert(session:limit("left_knee", {swing = 5, twist = {-10, 10}}))
    assert(session:limit("left_thigh", {swing = 5}))
    local fixed = assert(session:reach("left_foot", {30 * mm, 0, -30 * mm}))
    assert.truthy(fixed.distance > free.distance)
    assert.is_false(fixed.reached)
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

-- ---- any part, any edits -----------------------------------------------------------------------------

describe("a session", function()
  local function check_edits(part, opts, solve)
    local session = assert(bw.edit(part, opts))
    local function compare_with_fresh()
      local now, direct = assert(session:solve(solve)), assert(session.part:solve(solve and
        {inertia_relief = solve.inertia_relief}))
      local difference = (direct.displacement - now.displacement):norm() / direct.displacement:norm()
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
    local opts = function() return {skeleton = beam_skeleton()} end
    check_edits(beam_part(1), opts())
    local mesh = check.beam({16, 2, 2}, 2)
    local layered = bw.material.orthotropic {young = {2e9, 3e9, 1.5e9}, poisson = {0.3, 0.25, 0.28},
      shear = {0.8e9, 0.7e9, 0.9e9}, density = 1200}
    local part = bw.model {mesh = mesh, material = layered}
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {3, 1, -10}}
    check_edits(part, opts())
    local free = bw.model {mesh = mesh, material = bw.material.pla}
    free:load {on = mesh.boundary:above(1, 1), force = {0, 0, -10}}
    check.fails("unconstrained", "6 rigid-body modes are unconstrained", assert(bw.edit(free, opts())):solve())
    check_edits(free, opts(), {inertia_relief = true})
    local sliding = bw.model {mesh = mesh, material = bw.material.pla}
    sliding:slide(mesh.boundary:below(1, 0)):fix(mesh.boundary:nearest({0, 0, 0}))
    sliding:slide(mesh.boundary:below(2, 0), {0, 1, 0}):gravity {0, 0, -9.81}
    check_edits(sliding, opts())
  end)

  it("comes through random edits, undos and redos with the equations of a new part", function()
    local runs = os.getenv "BARWRIGHT_FULL" and 40 or 3
    local seed = 12345
    local function random(min, max)
      seed = (seed * 1103515245 + 12345) % 2147483648
      return min + (max - min) * (seed // 65536 / 32768)
    end
    local refused = 0
    for _ = 1, runs do
      local session = body()
      local names = session.skeleton.bone_names
      for _ = 1, 6 do
        local bone = session:bone(names[math.floor(random(1, #names + 1))])
        local kind = math.floor(random(0, 6))
        local ok, _, details
        if kind == 0 then
          ok, _, details = session:undo()
        elseif kind == 1 then
          ok, _, details = session:redo()
        elseif kind == 2 then
          ok, _, details = bone:translate {random(-1, 1) * mm, random(-1, 1) * mm, random(-1, 1) * mm}
        elseif kind == 3 then
          ok, _, details = bone:scale {random(0.8, 1.3), random(0.8, 1.3), random(0.8, 1.3)}
        else
          ok, _, details = bone:rotate {axis = {random(-1, 1), random(-1, 1), 1.1},
            degrees = random(-50, 50)}
        end
        if not ok then
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
