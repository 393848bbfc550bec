-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edit sessions of parts with bonds, attachments and couplings, beside solutions from scratch.
local bw = require "barwright"
local check = require "check"

-- The beam of edit_bodies, cut at `cut` into two bodies; they share nodes of the cut by place only.
local function cut_beam(cut)
  local whole = check.beam({16, 2, 2}, 2)
  local mesh = assert(whole:split({max = {cut, 1, 1}}, "left")):separated "left"
  local at = mesh.boundary:plane({cut, 0, 0}, {1, 0, 0}, 1e-9)
  return mesh, at & mesh.boundary:region "left", at & mesh.boundary:region "rest"
end

-- Both sides of a cut at 0.25 m follow the upper bone alone.
local function skeleton()
  return bw.skeleton.create {joints = {a = {0, 0.05, 0.05}, b = {0.6, 0.05, 0.05}, c = {1, 0.05, 0.05}},
    bones = {{"a", "b", name = "upper"}, {"b", "c", name = "lower"}}, root = "a"}
end

local function part_of(mesh)
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:below("x", 0)):gravity {0, 0, -9.81}
  return part:load {on = mesh.boundary:above("x", 1), force = {3, 5, -10}}
end

local kinds = {
  bond = function()
    local mesh, a, b = cut_beam(0.25)
    return part_of(mesh):bond {a = a, b = b}, 0.1
  end,
  ["bond where nodes are blended, small edits"] = function()
    local mesh, a, b = cut_beam(0.5)
    return part_of(mesh):bond {a = a, b = b}, 0.02
  end,
  preload = function()
    local mesh, a, b = cut_beam(0.25)
    local part = bw.model({mesh = mesh, material = bw.material.steel}):gravity {0, 0, -9.81}
    part:fix(mesh.boundary:below("x", 0)):fix(mesh.boundary:above("x", 1))
    return part:bond {a = a, b = b, preload = 1000}, 0.1
  end,
  ["springs and a mass"] = function()
    local mesh = check.beam({16, 2, 2}, 2)
    local tip = mesh.boundary:above("x", 1)
    return part_of(mesh):attach({on = tip, spring = {1e5, 2e5, 3e5}}):attach {on = tip, mass = 2}
  end,
  ["a rigid coupling"] = function()
    local mesh = check.beam({16, 2, 2}, 2)
    return part_of(mesh):couple {on = mesh.boundary:above("x", 1), at = {1.2, 0.05, 0.05}, kind = "rigid",
      force = {0, 0, -20}}
  end,
  ["a distributed coupling"] = function()
    local mesh = check.beam({16, 2, 2}, 2)
    return part_of(mesh):couple {on = mesh.boundary:above("x", 1), at = {1.2, 0.05, 0.05}, kind = "distributed",
      force = {0, 0, -20}, moment = {0, 3, 0}}
  end,
}

local function near_scratch(session, given)
  local now = assert(session:solve(given))
  local fresh = assert(session.part:solve())
  local off = (now.displacement - fresh.displacement):map "abs(a)":max()
  assert.is_true(off <= 1e-8 * fresh.displacement:map "abs(a)":max(), ("off by %g m"):format(off))
  check.near(fresh.von_mises:max(), now.von_mises:max(), 1e-7)
  for i, bond in ipairs(fresh.bonds) do
    for k = 1, 3 do assert.is_true(math.abs(bond.force[k] - now.bonds[i].force[k]) <= 1e-6 * 100) end
  end
  return now
end

describe("edit sessions of joined parts", function()
  for name, make in pairs(kinds) do
    it("give what equations from scratch give: " .. name, function()
      local part, size = make()
      size = size or 1
      local session = assert(bw.edit(part, {skeleton = skeleton()}))
      near_scratch(session)
      assert(session:bone("lower"):scale {1, 1 + 0.3 * size, 1 + 0.2 * size})
      local reused = near_scratch(session).reused
      assert.is_true(reused.joined and reused.full and reused.subdomains_reused > 0)
      assert.truthy(tostring(reused):find("the factor of the joined equations recomputed", 1, true))
      assert(session:bone("lower"):rotate {y = 12 * size})
      near_scratch(session)
      local before = session.mesh.nodes
      assert(session:bone("upper"):scale {1, 1 - 0.1 * size, 1 - 0.1 * size})
      local again = near_scratch(session, {check = true}).reused
      assert.is_true(again.ordering and again.difference_solution <= 1e-8)
      -- the same shape: nothing is recomputed, and another load alone does not change that
      session.source:gravity {0, 1, 0}
      again = near_scratch(session).reused
      assert.equal(1, again.factor_reused)
      assert.truthy(tostring(again):find(", the factor of the joined equations$"), tostring(again))
      assert(session:undo())
      assert.equal(0, (session.mesh.nodes - before):map "abs(a)":max())
      near_scratch(session, {solver = bw.solver.cholesky()})
      assert(session:set_material(bw.material.aluminium))
      near_scratch(session)
      near_scratch(session, {solver = bw.solver.pcg {preconditioner = bw.solver.cholesky(), tolerance = 1e-12}})
      session:check()
      session:close()
    end)
  end

  it("follow joints that a part gets later, and other load cases", function()
    local part = part_of(check.beam({16, 2, 2}, 2))
    local session = assert(bw.edit(part, {skeleton = skeleton()}))
    assert.is_false(assert(session:solve()).reused.joined)
    assert(session:bone("lower"):scale(1.2))
    part:attach {on = part.mesh.boundary:above("x", 1), spring = {1e5, 1e5, 1e5}}
    assert.is_true(near_scratch(session).reused.joined)
    local other = part_of(part.mesh)
    local plain = assert(session:solve {part = other})
    assert.is_false(plain.reused.joined)
    assert.is_true(assert(session:solve()).reused.joined)
    local system, model = assert(session:synchronise())
    assert.truthy(tostring(system):find("of a joined model", 1, true))
    assert.is_true(system:follows(model))
    check.raises("the model is not the one", function() assert(system:statics(other)) end)
  end)

  it("refuse an edit that takes the faces of a bond apart", function()
    local mesh, a, b = cut_beam(0.75)
    local part = part_of(mesh):bond {a = a, b = b}
    -- two bones, one in each body: only the blended middle is common to them
    local two = bw.skeleton.create {root = "a", bones = {{"a", "b", name = "root"}, {"b", "c", name = "end"}},
      joints = {a = {0.02, 0.05, 0.05}, b = {0.75, 0.05, 0.05}, c = {1, 0.05, 0.05}}}
    local session = assert(bw.edit(part, {skeleton = two}))
    local nodes = session.mesh.nodes
    local fine, message, about = session:bone("end"):translate {0, 0.05, 0}
    check.fails("geometry", "faces of bond 1 are apart, or overlap, by more than the bond closes "
      .. "(at 10 of the 25 nodes of side a)", fine, message, about)
    assert.equal(1, about.bond)
    check.fails("geometry", "faces of bond 1", session:bone("end"):translate {0.05, 0, 0}) -- a gap
    check.fails("geometry", "faces of bond 1", session:bone("end"):translate {-0.02, 0, 0}) -- an overlap
    check.fails("geometry", "faces of bond 1", session:bone("end"):rotate {y = 5})
    assert.equal(0, #session.edits)
    assert.equal(0, (session.mesh.nodes - nodes):map "abs(a)":max())
    near_scratch(session)
    assert(session:bone("root"):rotate {z = 20}) -- moves both sides alike
    near_scratch(session)
  end)

  it("report that the factor was recomputed", function()
    local mesh = check.beam({16, 2, 2}, 2)
    local part = part_of(mesh):attach {on = mesh.boundary:above("x", 1), mass = 1}
    local session = assert(bw.edit(part, {skeleton = skeleton()}))
    assert(session:bone("lower"):scale(1.2))
    local path = check.folder() .. "/session.html"
    assert(session:report(path))
    assert.truthy(check.read(path):find("The last solution reused: .-factor of the joined equations recomputed"))
  end)

  it("refuse what they do not know", function()
    local mesh = check.beam({16, 2, 2}, 2)
    local part = part_of(mesh):attach {on = mesh.boundary:above("x", 1), mass = 1}
    local session = assert(bw.edit(part, {skeleton = skeleton()}))
    check.fails("unsupported", "without bonds, attachments and couplings", session:optimise {von_mises = 1e6})
    local quarter = bw.mesh.box {max = {1, 1, 1}, cells = {2, 2, 2}}
    local sector = assert(bw.model({mesh = quarter, material = bw.material.steel}):cyclic {count = 4,
      low = quarter.boundary:below("y", 0), high = quarter.boundary:below("x", 0), axis = {0, 0, 1}})
    check.fails("unsupported", "4 sectors of cyclic symmetry", bw.edit(sector))
    check.fails("unsupported", "inertia relief is for models without bonds", session:solve {inertia_relief = true})
  end)
end)
