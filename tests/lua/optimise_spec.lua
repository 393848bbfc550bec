-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The scaling optimisation: closed forms, conditions of an optimum, what cannot be met, several loads,
-- worst loads.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local mm, MPa = 1e-3, 1e6
local axes = {y = 2, z = 3}

local function material(poisson)
  return bw.material.isotropic {young = 2e9, poisson = poisson or 0.35, density = 1100, strength = 50 * MPa}
end

-- A bar of bones of equal length, 300 mm x 24 mm x 16 mm, cut across into subdomains.
local function bar(bones, given)
  given = given or {}
  local cells = given.cells or {24, 2, 2}
  local mesh = assert(bw.mesh.box {min = {0, -12 * mm, -8 * mm}, max = {300 * mm, 12 * mm, 8 * mm},
    cells = cells, order = 2})
  local part = bw.model {mesh = mesh, material = material(given.poisson)}
  if not given.free then part:fix(mesh.boundary:below(1, 0)) end
  if given.load then given.load(part, mesh) end
  local joints, links = {}, {}
  for i = 0, bones do joints[i + 1] = {300 * mm * i / bones, 0, 0} end
  for i = 1, bones do links[i] = {i, i + 1, name = "bone " .. i} end
  local skeleton = bw.skeleton.create {joints = joints, bones = links, root = 1}
  return assert(bw.edit(part, {skeleton = skeleton})), part
end

local function tip(force)
  return function(part, mesh) part:load {on = mesh.boundary:above(1, 300 * mm), force = force} end
end

local function max_of(session, given)
  return assert(session:solve(given)).von_mises:max()
end

-- The change of shape of other factors, from the corner nodes themselves.
local function change_of(before, session)
  local corners = core.corner_nodes(before)
  local d = session.mesh.nodes:gather(corners) - before.nodes:gather(corners)
  return d:dot(d)
end

local iterate = bw.solver.pcg {preconditioner = bw.solver.cholesky()}

describe("the pieces", function()
  it("find the point of a half-plane nearest to another", function()
    local x, violation, multipliers = core.quadratic_program {H = {{1, 0}, {0, 1}}, g = {-2, -1},
      A = {{1, 1}}, b = {1}}
    check.near(1, x[1], 1e-12)
    assert.truthy(math.abs(x[2]) < 1e-12 and violation == 0)
    check.near(1, multipliers[1], 1e-12)
    check.raises("positive definite", core.quadratic_program, {H = {{-1}}, g = {1}})
    check.raises("rows", core.quadratic_program, {H = {{1, 0}, {0, 1}}, g = {1}})
    check.raises("did you mean", core.quadratic_program, {G = {1}})
  end)

  it("tell how a stress changes with the position of every node", function()
    local mesh = check.beam({4, 2, 2}, 2)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {0, 0, -1e4}}
    local static = assert(part:solve())
    local node = static.von_mises:argmax()
    local value, gradient = core.von_mises_gradient(part, part:system(), static.displacement, {node, 1})
    check.near(static.von_mises[node], value[1], 1e-12)
    assert.equal(2 * mesh.node_count, gradient.row_count)
    -- a stretch of all by (1 + s) with the same force: stresses fall by 2 s
    local first = gradient:rows(1, mesh.node_count)
    check.near(-2 * value[1], first:dot(mesh.nodes), 1e-9)
    local _, slopes = core.von_mises_slopes(part, part:system(), static.displacement, {node, 1},
      {mesh.nodes, mesh.nodes * 2})
    check.near(-2 * value[1], slopes(1, 1), 1e-9)
    check.near(-4 * value[2], slopes(2, 2), 1e-9)
    check.raises("nodes", core.von_mises_gradient, part, part:system(), static.displacement, {mesh.node_count + 1})
    check.raises("system", core.von_mises_gradient, part, part, static.displacement, {1})
  end)
end)

describe("the scaling optimisation", function()
  -- Tension without contraction: the stress is F / (area s_y s_z) everywhere. Least change of shape:
  -- H_y (s_y - 1) s_y = H_z (s_z - 1) s_z.
  it("finds the closed form for a bar in tension", function()
    local force = 24 * mm * 16 * mm * 50 * MPa
    local session = bar(1, {poisson = 0, load = tip {force, 0, 0}, cells = {8, 2, 2}})
    local before = session.mesh
    check.near(50 * MPa, max_of(session), 1e-9)
    local found = assert(session:optimise {von_mises = 30 * MPa, move_supports = true})
    assert.truthy(found.met)
    local s = found.factors["bone 1"]
    assert.equal(1, s[1])
    check.near(5 / 3, s[2] * s[3], 2e-6)
    local hy, hz = 0, 0
    for _, x in ipairs(before.nodes:gather(core.corner_nodes(before)):totable()) do
      hy, hz = hy + x[2] ^ 2, hz + x[3] ^ 2
    end
    check.near(hy * (s[2] - 1) * s[2], hz * (s[3] - 1) * s[3], 1e-2)
    check.near(hy * (s[2] - 1) ^ 2 + hz * (s[3] - 1) ^ 2, found.change, 1e-9)
    assert.truthy(max_of(session) <= 30 * MPa)
    check.near(30 * MPa, max_of(session), 1e-5)
  end)

  it("makes one edit, which undo takes back", function()
    local session = bar(3, {load = tip {0, 40, -100}})
    local before, mesh = max_of(session), session.mesh
    local found = assert(session:optimise {von_mises = 0.6 * before, move_supports = true})
    assert.equal(1, #session.edits)
    check.near(found.von_mises, max_of(session), 1e-6)
    assert.truthy(max_of(session) <= 0.6 * before)
    check.near(change_of(mesh, session), found.change, 1e-9)
    -- a new part of that shape has the same
    check.near(found.von_mises, assert(session.part:solve()).von_mises:max(), 1e-6)
    assert.truthy(session:undo())
    check.near(before, max_of(session), 1e-9)
    assert.truthy(session:redo())
    assert.truthy(max_of(session) <= 0.6 * before)
    assert.truthy(tostring(found):find "bone 1")
    local stub = check.read(check.root .. "/lua/stubs/optimise.lua") .. "\n"
    local documented = stub:match "@class bw.Optimisation\n.-\n\n"
    for key in pairs(found) do
      assert.truthy(documented:find("@field " .. key, 1, true), key .. " is not in the stubs")
    end
    -- what already carries its loads is left alone
    local again = assert(session:optimise {von_mises = 0.6 * before, move_supports = true})
    assert.equal(0, again.iterations)
    assert.equal(1, #session.edits)
  end)

  -- No point near the optimum both changes the shape less and carries the load.
  it("leaves no better point nearby", function()
    local session = bar(3, {load = tip {0, 60, -100}})
    local mesh = session.mesh
    local limit = 0.5 * max_of(session)
    local found = assert(session:optimise {von_mises = limit, move_supports = true})
    local random, tried = math.random, 0
    math.randomseed(4)
    for _ = 1, 200 do
      local factors, size = {}, 10 ^ (-1 - 2 * random())
      for name, s in pairs(found.factors) do
        factors[name] = {scale = {1, s[2] * (1 + size * (2 * random() - 1)),
          s[3] * (1 + size * (2 * random() - 1))}}
      end
      assert(session:pose(factors))
      if change_of(mesh, session) < found.change then
        tried = tried + 1
        assert.truthy(max_of(session) > limit, "a better point was found")
      end
      session:undo()
    end
    assert.truthy(tried > 40)
  end)

  it("chooses bones by stress, keeps and adds as asked", function()
    local session = bar(3, {load = tip {0, 0, -100}})
    local before = max_of(session)
    local found = assert(session:optimise {von_mises = 0.9 * before, move_supports = true})
    assert.truthy(found.factors["bone 1"] and not found.factors["bone 3"])
    session:undo()
    check.fails("infeasible", "no bone", session:optimise {von_mises = 0.9 * before, move_supports = true,
      keep = {"bone 1", "bone 2", "bone 3"}})
    found = assert(session:optimise {von_mises = 0.9 * before, move_supports = true, bones = {"bone 1", "bone 3"}})
    assert.truthy(found.factors["bone 3"] and not found.factors["bone 2"])
  end)

  -- Three bones fixed at the left: the first one reaches the support, the last one what is loaded.
  it("does not move supports, nor what is kept", function()
    local session, part = bar(3, {load = tip {0, 0, -100}})
    local before, mesh = max_of(session), session.mesh
    local left, right = mesh.boundary:below(1, 0), mesh.boundary:above(1, 300 * mm)
    local function moved(on)
      local d = session.mesh.nodes:gather(on.nodes) - mesh.nodes:gather(on.nodes)
      return math.sqrt(d:dot(d))
    end
    check.fails("infeasible", "bone 1 across z would move support 1 ('move_supports' allows that)",
      session:optimise {von_mises = 0.9 * before, bones = {"bone 1"}})
    assert.equal(0, #session.edits)
    -- what the others can do, they do
    local bones = {"bone 1", "bone 2", "bone 3"}
    local _, _, details = session:optimise {von_mises = 0.5 * before, bones = bones}
    assert.is_nil(details.best.factors["bone 1"])
    assert.truthy(details.best.factors["bone 3"])
    assert(session:optimise {von_mises = 0.9 * before, bones = bones, move_supports = true})
    assert.is_true(moved(left) > 1e-4 * mm)
    session:undo()
    assert(session:optimise {von_mises = 0.9 * before, bones = bones, move_supports = true, keep = {right}})
    assert.is_true(moved(left) > 1e-4 * mm and moved(right) == 0)
    session:undo()
    check.fails("infeasible", "bone 1 across z would move what keep[1] keeps", session:optimise {
      von_mises = 0.9 * before, bones = {"bone 1"}, move_supports = true, keep = {left, "bone 2"}})
    -- a support that slides holds along its normal only
    local sliding = bw.model {mesh = part.mesh, material = part.material}
    local boundary = part.mesh.boundary
    sliding:slide(boundary:below(1, 0), {1, 0, 0}):slide(boundary:below(3, -8 * mm), {0, 0, 1})
    sliding:fix(boundary:nearest({0, 0, 0}, 1))
    sliding:load {on = boundary:above(1, 300 * mm), force = {1000, 0, 0}}
    local other = assert(bw.edit(sliding, {skeleton = session.skeleton}))
    local limit = 0.9 * max_of(other)
    local found, message, about = other:optimise {von_mises = limit, bones = {"bone 1"}}
    local factors = assert(found or about and about.best, message).factors["bone 1"]
    assert.is_true(factors[2] > 1 and factors[3] == 1) -- the underside holds along z
    other:close()
    check.raises("keep[1]: a selection expected", session.optimise, session, {von_mises = 1, keep = {1}})
  end)

  it("says what cannot be met and leaves the session alone", function()
    local session = bar(3, {load = tip {0, 0, -100}})
    local before = max_of(session)
    local none, message, details = session:optimise {von_mises = 0.5 * before, move_supports = true,
      max_factor = 1.1}
    check.fails("infeasible", "no factors within the bounds", none, message, details)
    assert.truthy(message:find("bone 1 across z", 1, true))
    assert.equal(0, #session.edits)
    local best = details.best
    assert.truthy(not best.met and best.von_mises < before and best.von_mises > 0.5 * before)
    -- thicker than the bounds allow, everywhere, is the best there is
    check.near(1.1, best.factors["bone 1"][3], 1e-6)
    assert(session:pose {["bone 1"] = {scale = best.factors["bone 1"]},
      ["bone 2"] = {scale = best.factors["bone 2"]}})
    check.near(best.von_mises, max_of(session), 0.02)
  end)

  it("starts from factors that are there already", function()
    local session = bar(2, {load = tip {0, 0, -100}})
    local limit = 0.6 * max_of(session)
    assert(session:pose {["bone 1"] = {scale = {1.1, 1.2, 0.9}}, ["bone 2"] = {rotation = {z = 20}}})
    local mesh = session.mesh
    local found = assert(session:optimise {von_mises = limit, move_supports = true})
    assert.equal(1.1, found.factors["bone 1"][1])
    assert.truthy(max_of(session) <= limit)
    check.near(change_of(mesh, session), found.change, 1e-9)
  end)

  it("scales tied bones alike", function()
    -- fixed in the middle, loaded unequally at both ends
    local function load(part, mesh)
      part:fix(mesh.boundary:box({112 * mm, -1, -1}, {188 * mm, 1, 1}))
      part:load {on = mesh.boundary:above(1, 300 * mm), force = {0, 0, -120}}
      part:load {on = mesh.boundary:below(1, 0), force = {0, 0, -60}}
    end
    local session = bar(3, {free = true, load = load})
    local limit = 0.7 * max_of(session)
    local found = assert(session:optimise {von_mises = limit, move_supports = true})
    local plain = found.change
    assert.truthy((found.factors["bone 1"] or {1, 1, 1})[3] < found.factors["bone 3"][3] - 0.05)
    session:undo()
    found = assert(session:optimise {von_mises = limit, move_supports = true, ties = {{"bone 1", "bone 3"}}})
    for _, axis in pairs(axes) do
      assert.equal(found.factors["bone 1"][axis], found.factors["bone 3"][axis])
    end
    assert.truthy(max_of(session) <= limit and found.change > plain)
  end)

  it("carries several loads at once", function()
    local session, part = bar(2, {load = tip {0, 0, -100}})
    local other = bw.model {mesh = part.mesh, material = part.material}
    other:fix(part.mesh.boundary:below(1, 0)):load {on = part.mesh.boundary:above(1, 300 * mm),
      force = {0, 150, 0}}
    local limit = 0.6 * max_of(session)
    local one = assert(session:optimise {von_mises = limit, move_supports = true})
    session:undo()
    local found = assert(session:optimise {von_mises = limit, move_supports = true, cases = {other}})
    assert.truthy(found.change > one.change)
    assert.truthy(max_of(session) <= limit)
    local under_other = assert(session:moved(other):solve()).von_mises:max()
    assert.truthy(under_other <= limit * (1 + 1e-7))
    local cases = {}
    for _, node in ipairs(found.nodes) do cases[node.case] = true end
    assert.truthy(cases[1] and cases[2])
  end)

  it("carries the worst load, found again after each round", function()
    local session = bar(3, {free = true})
    local limit = 0.4 * MPa
    local opts = {force = 20, pressure = 2e5, modes = 4, regions = 2}
    local found = assert(session:optimise {von_mises = limit, move_supports = true, loads = "worst", worst = opts})
    assert.truthy(found.met and #found.rounds >= 2)
    assert.truthy(found.rounds[1].max > limit)
    local last = found.rounds[#found.rounds].max
    assert.truthy(last <= 1.02 * limit)
    assert.equal(1, #session.edits)
    -- the worst load of the final shape
    local final = assert(bw.worst_case(bw.model {mesh = session.mesh, material = material()}, opts))
    local part = bw.model {mesh = session.mesh, material = material()}
    part:load {nodal = final:force()}
    assert.truthy(assert(part:solve {inertia_relief = true}).von_mises:max() <= 1.02 * limit)
    final:close()
  end)

  it("reports how far it is, and leaves the best point when it is stopped", function()
    local session = bar(3, {load = tip {0, 40, -100}})
    local before = max_of(session)
    local reported, last, rising = 0, 0, true
    local old = bw.progress(function(stage, fraction)
      if stage == "optimise" then
        rising, last, reported = rising and fraction >= last, fraction, reported + 1
      end
    end)
    assert(session:optimise {von_mises = 0.6 * before, move_supports = true})
    assert.truthy(reported > 1 and rising and last > 0 and last < 1)
    assert.truthy(session:undo())
    -- At half of them, not after so many calls: work that a pool thread takes over is not reported, so that
    -- their number differs from run to run.
    bw.progress(function(_, fraction) return fraction < 0.5 * last end)
    local none, message, details = session:optimise {von_mises = 0.6 * before, move_supports = true}
    bw.progress(old)
    assert.is_nil(none)
    assert.equal("cancelled", details.status)
    assert.truthy(message:find "stopped" and details.best.von_mises <= before)
    assert.equal(0, #session.edits)
    check.near(before, max_of(session), 1e-9) -- and it can be used
  end)

  it("works in a fork, from which its answer can be taken over", function()
    local session = bar(2, {load = tip {0, 40, -100}})
    local before = max_of(session)
    local fork = session:fork()
    local found = assert(fork:optimise {von_mises = 0.6 * before, move_supports = true})
    check.near(before, max_of(session), 1e-9)
    assert(session:adopt(fork))
    check.near(found.von_mises, max_of(session), 1e-6)
    assert.equal(1, #session.edits)
    fork:close()
  end)

  -- The slopes that steps are made with, solved roughly with the factor of a former shape.
  it("has slopes within 1e-5 of central differences, with a factor left behind too", function()
    local session = bar(2, {load = tip {0, 40, -100}, cells = {16, 2, 2}})
    assert(session:solve())
    local function at(y)
      local fork = session:fork()
      assert(fork:pose {["bone 1"] = {scale = {1, y, 1.02}}})
      return fork
    end
    local fork = at(1.03)
    local system, model = fork:synchronise()
    local result = assert(system:statics(model, {solver = iterate, tolerance = 1e-10}))
    local node = result.von_mises:argmax()
    local motion = session.subdomains:pose_derivative(fork.current_pose, "bone 1", 2)
    local _, slopes = assert(core.von_mises_slopes(model, system, result.displacement, {node}, {motion},
      {solver = iterate, tolerance = 1e-6, guess = {result.displacement}}))
    local h, ends = 1e-3, {}
    for k, y in ipairs {1.03 - h, 1.03 + h} do ends[k] = assert(at(y).part:solve()).von_mises[node] end
    check.near((ends[2] - ends[1]) / (2 * h), slopes(1, 1), 1e-5)
  end)

  it("refuses misuse", function()
    local session = bar(1, {load = tip {0, 0, -1}, cells = {6, 1, 1}})
    check.raises("a table of options expected", session.optimise, session)
    check.raises("did you mean 'von_mises'", session.optimise, session, {von_mise = 1})
    check.raises("a number above 0 expected", session.optimise, session, {von_mises = 0})
    check.raises("bone 1", session.optimise, session, {von_mises = 1, bones = {"bone one"}})
    check.raises("tied twice", session.optimise, session, {von_mises = 1, ties = {{"bone 1"}, {"bone 1"}}})
    check.raises("at most max_factor expected, got 4", session.optimise, session, {von_mises = 1, min_factor = 4})
    check.raises("cases[1]", session.optimise, session, {von_mises = 1, cases = {1}})
    check.raises("without supports", session.optimise, session, {von_mises = 1, loads = "worst"})
    session:close()
    check.raises("closed", session.optimise, session, {von_mises = 1})
  end)
end)
