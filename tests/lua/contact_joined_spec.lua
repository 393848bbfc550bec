-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Contact beside bonds, remote points, springs and preloads: closed forms, the same without joints, and CalculiX.
-- Lengths are in m.
local bw = require "barwright"
local check = require "check"
local deck = require "deck"


-- The largest difference of two fields at the same nodes, over the largest value of the second.
local function difference(a, b, count)
  local worst, largest = 0, 0
  for i = 1, count do
    for k = 1, 3 do
      worst = math.max(worst, math.abs(a(i, k) - b(i, k)))
      largest = math.max(largest, math.abs(b(i, k)))
    end
  end
  return worst / largest
end

-- A bolt in a sleeve, cut at z = 0, of a material that does not contract: springs in parallel.
local function bolt_in_sleeve()
  local mesh = bw.mesh.box {min = {-0.015, -0.015, -0.02}, max = {0.015, 0.015, 0.02}, cells = {3, 3, 4}}
  local function in_bolt(x, y) return math.abs(x) < 0.005 and math.abs(y) < 0.005 end
  mesh = mesh:split(function(x, y, z) return z > 0 and in_bolt(x, y) end, "upper bolt")
  mesh = mesh:split(function(x, y, z) return z < 0 and in_bolt(x, y) end, "lower bolt")
  mesh = mesh:split(function(x, y, z) return z > 0 and not in_bolt(x, y) end, "upper sleeve")
  for _, region in ipairs {"upper bolt", "lower bolt", "upper sleeve"} do mesh = assert(mesh:separated(region)) end
  local boundary = mesh.boundary
  local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 2e11, poisson = 0}}
  local function cut(region) return boundary:plane({0, 0, 0}, {0, 0, 1}, 1e-9) & boundary:region(region) end
  local pairs = {{on = cut "upper sleeve", with = cut "rest"}}
  local function load(bolt, pull, friction)
    part:clear_supports():clear_bonds():clear_couplings()
    part:fix(boundary:below("z", -0.02))
    part:bond {a = cut "upper bolt", b = cut "lower bolt", preload = bolt.preload, shortening = bolt.shortening}
    part:couple {on = boundary:above("z", 0.02), kind = "rigid", at = {0, 0, 0.03}, force = pull}
    pairs[1].friction = friction
    return assert(part:contact(pairs))
  end
  return load, part, pairs
end

describe("contact of joined bodies", function()
  it("shares a load between bolt and sleeve until they part", function()
    local load = bolt_in_sleeve()
    local tight = load({preload = 1e4}, {0, 0, 0})
    local bolt = tight.static.bonds[1]
    local stiff, soft = 8 / 9, 1 / 9 -- of the sleeve and of the bolt: their areas
    -- both parts are 40 mm long, on 8 and on 1 cm2
    check.near(1e4, bolt.preload, 1e-9)
    check.near(1e4 * 0.04 / 2e11 * (1 / 8e-4 + 1 / 1e-4), bolt.shortening, 1e-9)
    check.near(1e4 / 8e-4, tight.pairs[1].pressure, 1e-9)
    check.near(8e-4, tight.pairs[1].area, 1e-9)
    for _, pull in ipairs {-5e3, 2e3, 1e4, 1.1249e4} do
      local found = load({shortening = bolt.shortening}, {0, 0, pull})
      check.near(1e4 + soft * pull, found.static.bonds[1].preload, 1e-8)
      check.near((1e4 - stiff * pull) / 8e-4, found.pairs[1].pressure, 1e-4)
    end
    for _, pull in ipairs {1.1251e4, 1e5} do
      local found = load({shortening = bolt.shortening}, {0, 0, pull})
      check.near(pull, found.static.bonds[1].preload, 1e-8)
      assert.are.equal(0, found.pairs[1].active)
    end
    assert.is_truthy(tostring(tight):find "pair 1: %(0, 0, 10000%) N")
    assert.is_truthy(tostring(tight):find("bond 1: force on side a (0, 0, -10000) N, preload 10000 N", 1, true))
    assert.is_truthy(tostring(tight.static):find("preload 10000 N, shortening 0.0225 mm; error unknown", 1, true))
  end)

  it("turns the sleeve under a moment, which bolt and contact balance", function()
    local load, part = bolt_in_sleeve()
    local shortening = load({preload = 1e4}, {0, 0, 0}).static.bonds[1].shortening
    part:clear_couplings()
    local found = load({shortening = shortening}, {3e3, 0, 2e3})
    local pair, bond = found.pairs[1], found.static.bonds[1]
    check.near(2e3, -(pair.force[3] + bond.force[3]), 1e-8)
    check.near(3e3, -(pair.force[1] + bond.force[1]), 1e-8)
    check.near(3e3 * 0.03, -(pair.moment[2] + bond.moment[2]), 1e-8) -- the force acts 30 mm above the cut
    assert.is_true(pair.active > 0 and pair.active < pair.candidates)
  end)

  -- A block on a block on a floor, on springs across it; the upper one of two bodies, or of one.
  local function blocks(order, apart)
    local mesh = bw.mesh.box {max = {1, 1, 1}, cells = {3, 2, 4}, order = order}
    mesh = mesh:split({max = {1, 1, 0.5}}, "low"):separated "low"
    mesh = mesh:split({min = {0, 0, 0.75}, max = {1, 1, 1}}, "top")
    if apart then mesh = assert(mesh:separated "top") end
    local boundary = mesh.boundary
    local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 2e9, poisson = 0.3}}
    local joint = boundary:plane({0, 0, 0.5}, {0, 0, 1}, 1e-9)
    local pairs = {{on = joint:facing {0, 0, -1}, with = joint:facing {0, 0, 1}},
      {on = boundary:below("z", 0), with = bw.rigid.plane {normal = {0, 0, 1}}}}
    part:load {on = boundary:above("z", 1), force = {0, 0, -3e5}}
    part:load {on = boundary:above("x", 1) & boundary:above("z", 0.6), force = {0, 0, -2e5}}
    part:attach {on = boundary:below("x", 0), spring = {1e9, 1e9, 0}}
    part:attach {on = boundary:above("x", 1), spring = {1e9, 1e9, 0}}
    if apart then
      local cut = boundary:plane({0, 0, 0.75}, {0, 0, 1}, 1e-9)
      part:bond {a = cut & boundary:region "top", b = cut & boundary:region "rest"}
    end
    return part, pairs
  end

  it("is that of one body where bonded nodes match, also of bodies that contact alone restrains", function()
    for order = 1, 2 do
      local part, pairs = blocks(order, false)
      local bonded, bonded_pairs = blocks(order, true)
      for _, friction in ipairs {0, 0.3} do
        for i = 1, 2 do pairs[i].friction, bonded_pairs[i].friction = friction, friction end
        local one, two = assert(part:contact(pairs)), assert(bonded:contact(bonded_pairs))
        assert.is_true(difference(two.static.displacement, one.static.displacement, #part.mesh.nodes)
          < (friction > 0 and 1e-7 or 1e-8))
        for i = 1, 2 do
          assert.is_true(one.pairs[i].active > 0 and one.pairs[i].active == two.pairs[i].active)
          check.near(one.pairs[i].pressure, two.pairs[i].pressure, 1e-7)
          check.near(5e5, math.abs(two.pairs[i].force[3]), 1e-6)
        end
      end
    end
  end)

  it("is that of the forces at nodes into which a coupling resolves its moment", function()
    for _, kind in ipairs {"rigid", "distributed"} do
      local mesh = bw.mesh.box {max = {2, 1, 1}, cells = {4, 2, 2}, order = 2}
      local boundary = mesh.boundary
      local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 2e9, poisson = 0.3}}
      local foot, far = boundary:below("z", 0), boundary:above("x", 2)
      local pairs = {{on = foot, with = bw.rigid.plane {normal = {0, 0, 1}}}}
      part:fix(boundary:below("x", 0))
      part:couple {on = far, kind = kind, at = {2.5, 0.4, 0.6}, force = {0, 0, -2e5}, moment = {1e5, 1e5, 0},
        spring = {1e6, 2e6, 3e6}}
      local found = assert(part:contact(pairs))
      assert.is_true(found.pairs[1].active > 0 and found.pairs[1].active < found.pairs[1].candidates)
      -- prescribed where they went, the nodes of the face take what the coupling exerts
      local coupling = found.static.couplings[1]
      part:clear_couplings():prescribe(far, found.static.displacement)
      local moved = assert(part:contact(pairs))
      local force = moved.static:reaction_on(far)
      for k = 1, 3 do assert.is_true(math.abs(coupling.force[k] - force[k]) < 1e-8 * 2e5) end
      local nodal = moved.static.reaction:gather(far.nodes):scatter(far.nodes, #mesh.nodes)
      part:clear_supports():fix(boundary:below("x", 0)):load {nodal = nodal}
      local loaded = assert(part:contact(pairs))
      assert.is_true(difference(loaded.static.displacement, found.static.displacement, #mesh.nodes) < 1e-8)
      check.near(found.pairs[1].pressure, loaded.pairs[1].pressure, 1e-8)
    end
  end)

  -- A bolt with heads on two plates, free but for contact; it is cut in its shank, or in one piece.
  local function clamped(whole)
    local mesh = bw.mesh.box {min = {-0.015, -0.015, -0.02}, max = {0.015, 0.015, 0.02}, cells = {6, 6, 4}}
    local function shank(x, y) return math.abs(x) < 0.005 and math.abs(y) < 0.005 end
    mesh = mesh:split(function(x, y, z) return math.abs(z) > 0.01 or shank(x, y) end, "nut")
    mesh = mesh:split(function(x, y, z) return z > 0 and (z > 0.01 or shank(x, y)) end, "head")
    mesh = mesh:split(function(x, y, z) return z > 0 and z < 0.01 and not shank(x, y) end, "plate")
    mesh = assert(mesh:separated "rest"):separated "plate"
    if not whole then mesh = assert(mesh:separated "nut") end
    local boundary = mesh.boundary
    local function at(z, region) return boundary:plane({0, 0, z}, {0, 0, 1}, 1e-9) & boundary:region(region) end
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    local sides = boundary:below("x", -0.015) | boundary:above("x", 0.015)
    part:fix(sides & boundary:region "rest")
    local pairs = {{on = at(0, "plate"), with = at(0, "rest")}, {on = at(0.01, "head"), with = at(0.01, "plate")},
      {on = at(-0.01, "nut"), with = at(-0.01, "rest")}}
    return part, pairs, {a = at(0, "head"), b = at(0, "nut")}, sides & boundary:region "plate"
  end

  it("is tightened as a bolt in one piece whose head has an interference, with friction along a path", function()
    local part, pairs, cut, sides = clamped()
    local whole, whole_pairs, _, whole_sides = clamped(true)
    whole_pairs[2].interference = 1.2e-5
    for _, friction in ipairs {0, 0.2} do
      for i = 1, 3 do pairs[i].friction, whole_pairs[i].friction = friction, friction end
      part:clear_loads():clear_bonds():bond {a = cut.a, b = cut.b, shortening = 1.2e-5}
      whole:clear_loads()
      local tight, same = assert(part:contact(pairs)), assert(whole:contact(whole_pairs))
      for i = 1, 3 do
        check.near(same.pairs[i].force[3], tight.pairs[i].force[3], 1e-8)
        check.near(same.pairs[i].pressure, tight.pairs[i].pressure, 1e-8)
      end
      check.near(tight.static.bonds[1].preload, tight.pairs[2].force[3], 1e-8)
      assert.are.equal(#same.undetermined, #tight.undetermined)
      if friction == 0 then
        -- the force that this shortening gives has this shortening
        part:clear_bonds():bond {a = cut.a, b = cut.b, preload = tight.static.bonds[1].preload}
        check.near(1.2e-5, assert(part:contact(pairs)).static.bonds[1].shortening, 1e-8)
      else
        part:load {on = sides, force = {1e3, 0, 0}}
        whole:load {on = whole_sides, force = {1e3, 0, 0}}
        local sheared = assert(part:contact(pairs, {after = tight, steps = 2}))
        local also = assert(whole:contact(whole_pairs, {after = same, steps = 2}))
        for i = 1, 3 do check.near(also.pairs[i].friction[1], sheared.pairs[i].friction[1], 1e-6) end
        check.near(1e3, sheared.pairs[2].friction[1] - sheared.pairs[1].friction[1], 1e-6)
        part:clear_bonds():bond {a = cut.a, b = cut.b, preload = 1e4}
        check.raises("springs and couplings: these have changed", part.contact, part, pairs, {after = tight})
        part:clear_bonds():bond {a = cut.a, b = cut.b, shortening = 1.2e-5}
        part:clear_loads():load {on = sides, force = {4.2e3, 0, 0}} -- above 0.2 times 10 kN on two faces
        check.fails("unconstrained", "larger coefficient of friction", part:contact(pairs, {after = tight}))
      end
    end
  end)

  it("is the same in finite sliding where nothing slides", function()
    local load, part, pairs = bolt_in_sleeve()
    load({preload = 1e4}, {1e3, 0, 0})
    local small, finite = assert(part:contact(pairs)), assert(part:contact(pairs, {finite_sliding = true}))
    check.near(small.pairs[1].force[3], finite.pairs[1].force[3], 1e-6)
    check.near(small.static.bonds[1].shortening, finite.static.bonds[1].shortening, 1e-3)
  end)

  it("says where a rigid face has no pressure of its own", function()
    local mesh = bw.mesh.box {max = {1, 1, 1}, cells = {3, 3, 3}}
    local part, foot = bw.model {mesh = mesh, material = bw.material.steel}, mesh.boundary:below("z", 0)
    part:couple {on = foot, kind = "rigid", spring = {1e6, 1e6, 0}, rotational_spring = {0, 0, 1e6}, mass = 10}
    part:gravity {0, 0, -10}:load {on = mesh.boundary:above("z", 1), force = {0, 0, -1e4}}
    local found = assert(part:contact {{on = foot, with = bw.rigid.plane {normal = {0, 0, 1}}}})
    check.near(1e4 + 10 * (10 + part.material.density), found.pairs[1].force[3], 1e-8)
    assert.is_truthy(tostring(found):find("nothing decides its pressure there", 1, true))
  end)

  it("has the tractions of its joints", function()
    local load = bolt_in_sleeve()
    local shortening = load({preload = 1e4}, {0, 0, 0}).static.bonds[1].shortening
    local static = load({shortening = shortening}, {0, 0, 9e3}).static
    local traction = assert(static:joint_traction {bond = 1})
    check.near(1.1e4, math.abs(traction.force[3]), 1e-8)
    check.near(1.1e8, traction.normal:max(), 1e-8)
    check.fails("unsupported", "forces of contact are among the loads", static:buckling())
  end)

  it("is refused where it has no meaning, in a sentence", function()
    local part, pairs, cut = clamped()
    part:bond {a = cut.a, b = cut.b, preload = 1e4}
    check.fails("unsupported", "solved by a factor, not by \"pcg\"",
      part:contact(pairs, {solver = bw.solver.pcg {}}))
    part:clear_bonds():load({on = cut.a, force = {0, 0, 1}}):bond {a = cut.a, b = cut.b}
    check.fails("unconstrained", "nothing stops the translation along (0, 0, 1) of body",
      part:contact {pairs[1], pairs[2]})
    part:fix(part.mesh.boundary)
    check.raises("contact pair 1 is on facets that bond 1 joins", function()
      part:contact {{on = cut.a, with = cut.b}}
    end)
    local wedge = bw.mesh.box {max = {1, 1, 0.3}, cells = {3, 3, 1}}
    local sector = bw.model {mesh = wedge, material = bw.material.steel}
    local low, high = wedge.boundary:below("y", 0), wedge.boundary:below("x", 0)
    assert(sector:cyclic {low = low, high = high, count = 4})
    check.fails("unsupported", "sectors of cyclic symmetry", sector:contact {{on = wedge.boundary:below("z", 0),
      with = bw.rigid.plane {normal = {0, 0, 1}}}})
  end)

  if not os.execute "command -v ccx >/dev/null 2>&1" then return end

  -- ccx has contact on stiff springs, and the bond by equations.
  it("has the forces of CalculiX in a bolt that was tightened and pulled", function()
    local part, pairs, cut, sides = clamped()
    local boundary = part.mesh.boundary
    local base = boundary:below("z", -0.02)
    part:bond {a = cut.a, b = cut.b, shortening = 1e-5}
    for _, pull in ipairs {0, 4e-6, 3e-5} do
      part:clear_supports():fix(base):fix(boundary:region "rest" & (boundary:below("x", -0.015)
        | boundary:above("x", 0.015))):prescribe(sides, {0, 0, pull})
      local found = assert(part:contact {pairs[1], pairs[2]})
      local stem = os.tmpname()
      assert(part:write_inp(stem .. ".inp"))
      local model, step = check.read(stem .. ".inp"):match "^(.-)(%*STEP.*)$"
      local lines = {model}
      for i = 1, 2 do
        lines[#lines + 1] = deck.surface(part.mesh, pairs[i].on, "ON" .. i)
        lines[#lines + 1] = deck.surface(part.mesh, pairs[i].with, "WITH" .. i)
      end
      lines[#lines + 1] = deck.node_set("BASE", base) .. "\n" .. deck.node_set("SIDES", sides)
      lines[#lines + 1] = "*SURFACE INTERACTION, NAME=TOUCH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e16"
      for i = 1, 2 do
        lines[#lines + 1] = "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE"
        lines[#lines + 1] = ("ON%d, WITH%d"):format(i, i)
      end
      lines[#lines + 1] = step:gsub("%*END STEP", "*NODE PRINT, NSET=BASE, TOTALS=ONLY\nRF\n"
        .. "*NODE PRINT, NSET=SIDES, TOTALS=ONLY\nRF\n*END STEP")
      check.write(stem .. ".inp", table.concat(lines, "\n"))
      os.execute(("cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1"):format(stem, stem))
      local forces = {}
      for line in assert(io.open(stem .. ".dat")):lines() do
        local z = line:match "^%s+%-?%d%.%d+E[+-]%d+%s+%-?%d%.%d+E[+-]%d+%s+(%-?%d%.%d+E[+-]%d+)%s*$"
        if z then forces[#forces + 1] = tonumber(z) end
      end
      os.execute(("rm -f '%s' '%s'.*"):format(stem, stem))
      assert.are.equal(2, #forces)
      check.near(found.static.bonds[1].preload, -forces[1], 0.02)
    end
  end)
end)
