-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Tractions of bonds, attachments, couplings and supports: constant ones, resultants, closed forms, and a lap
-- joint beside one body of a finer mesh.
local bw = require "barwright"
local check = require "check"

local function bar(order)
  local mesh = check.boxes(order, {{{0, 0, 0}, {1, 0.4, 0.4}, {3, 2, 2}}, {{1, 0, 0}, {2, 0.4, 0.4}, {4, 3, 3}}})
  local cut = mesh.boundary:plane({1, 0, 0}, {1, 0, 0}, 1e-9)
  return mesh, cut:facing({1, 0, 0}, 0.1), cut:facing({-1, 0, 0}, 0.1)
end

local function size(v) return math.sqrt(v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2) end

local function sums(part, force, moment)
  for k = 1, 3 do
    assert.is_true(math.abs(part.force[k] - force[k]) < 1e-8 * size(force))
    if moment then assert.is_true(math.abs(part.moment[k] - moment[k]) < 1e-8 * size(moment)) end
  end
end

describe("tractions of joints", function()
  it("are constant where the stress is, on either side of a bond and on planes of symmetry", function()
    for order = 1, 2 do
      for side = 1, 2 do
        local mesh, left, right = bar(order)
        local part = bw.model {mesh = mesh, material = bw.material.steel}
        for axis = 1, 3 do part:symmetry(mesh.boundary:below(axis, 1e-9)) end
        part:bond {a = side == 1 and left or right, b = side == 1 and right or left}
        part:load {on = mesh.boundary:above("x", 2), traction = {5e6, 0, 0}}
        local static = assert(part:solve())
        local bond = assert(static:joint_traction {bond = 1})
        local normal = bond.normal:gather(bond.nodes)
        check.near(5e6, normal:min(), 1e-8)
        check.near(5e6, normal:max(), 1e-8)
        assert.is_true(bond.shear:max() < 0.05)
        check.near(0.16, bond.area, 1e-12)
        check.near((side == 1 and 5e6 or -5e6) * 0.16, bond.force[1], 1e-8)
        assert.is_true(bond.shared > 0)
        assert.matches("^traction of bond 1 on the body: normal 5 MPa to 5 MPa, shear up to .*; error unknown",
          tostring(bond))
        assert.matches("supports take a part that is not included", tostring(bond))
        local plane = assert(static:joint_traction {support = 1})
        normal = plane.normal:gather(plane.nodes)
        check.near(5e6, normal:min(), 1e-8)
        check.near(5e6, normal:max(), 1e-8)
        assert.equal(0, plane.shared)
        sums(plane, {-5e6 * 0.16, 0, 0})
      end
    end
  end)

  it("sum to the load where a bond covers a part of its side", function()
    for case = 1, 3 do
      local order, covered = case == 3 and 2 or 1, case == 2
      local mesh = check.boxes(order, {{{0, 0, 0}, {1, 1, 0.5}, {5, 4, 2}},
        {{0.1, 0.15, 0.5}, {0.7, 0.85, 1}, {3, 2, 2}}})
      local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 1e9, poisson = 0}}
      local cut = mesh.boundary:plane({0, 0, 0.5}, {0, 0, 1}, 1e-9)
      local low, high = cut:facing({0, 0, 1}, 0.1), cut:facing({0, 0, -1}, 0.1)
      part:fix(mesh.boundary:below("z", 0))
      assert(part:bond {a = covered and low or high, b = covered and high or low})
      part:load {on = mesh.boundary:above("z", 1), traction = {3e5, 2e5, -1e5}}
      local static = assert(part:solve())
      local bond = assert(static:joint_traction {bond = 1})
      local area = 0.6 * 0.7
      check.near(area, bond.area, 1e-12)
      local sign = covered and 1 or -1
      sums(bond, {sign * 3e5 * area, sign * 2e5 * area, -sign * 1e5 * area})
      -- its side a has nodes outside of the other body, whose values are no tractions
      local normal = bond.normal:gather(bond.nodes)
      if not covered then assert.is_true(normal:min() > -3e6 and normal:max() < 3e6) end -- 2.8e6 of bending
      assert.equal(0, bond.shared)
    end
  end)

  it("divide reactions between planes that meet at any angle", function()
    local map = {{1, 0.4, 0.2}, {0.1, 0.9, -0.3}, {0, 0.2, 0.8}}
    for order = 1, 2 do
      local box, nodes = bw.mesh.box {max = {1, 1, 1}, cells = {3, 3, 2}, order = order}, {}
      local face = {}
      for i, p in ipairs(box.nodes:totable()) do
        nodes[i] = {}
        for r = 1, 3 do nodes[i][r] = map[r][1] * p[1] + map[r][2] * p[2] + map[r][3] * p[3] end
        for k = 1, 3 do
          face[k], face[-k] = face[k] or {}, face[-k] or {}
          face[k][i], face[-k][i] = p[k] == 0 and 1 or 0, p[k] == 1 and 1 or 0
        end
      end
      local mesh = assert(box:moved(bw.array.new(nodes)))
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      for k = 1, 3 do
        part:symmetry(assert(mesh.boundary:where(bw.array.new(face[k]))))
        part:load {on = assert(mesh.boundary:where(bw.array.new(face[-k]))), pressure = 3e6}
      end
      local static = assert(part:solve()) -- the body shrinks towards the corner, and all planes pass it
      for support = 1, 3 do
        local found = assert(static:joint_traction {support = support})
        local normal = found.normal:gather(found.nodes)
        assert.equal(0, found.shared)
        assert.is_true(found.shear:max() < 0.05)
        check.near(-3e6, normal:min(), 1e-8)
        check.near(-3e6, normal:max(), 1e-8)
      end
    end
  end)

  it("say where the reaction is of other supports too", function()
    local mesh = bw.mesh.box {max = {1, 1, 1}, cells = {2, 2, 2}, order = 2}
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(mesh.boundary:below("z", 0)):symmetry(mesh.boundary:below("x", 0))
    part:load {on = mesh.boundary:above("z", 1), force = {100, 200, 300}}
    local static = assert(part:solve())
    local plane = assert(static:joint_traction {support = 2})
    assert.equal(5, plane.shared)
    assert.matches("at 5 nodes the reaction is of other supports too, and counts whole", tostring(plane))
    local foot = assert(static:joint_traction {support = 1})
    check.near(-300, foot.force[3], 1e-8)
    check.near(-200, foot.force[2], 1e-8)
  end)

  it("balance the loads of a body on springs, couplings and a bond", function()
    for order = 1, 2 do
      local mesh, left, right = bar(order)
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      local boundary = mesh.boundary
      part:attach {on = boundary:below("x", 0), spring = {1e9, 2e9, 3e9}}
      part:attach {on = boundary:above("z", 0.4), mass = 50}
      part:couple {on = boundary:below("y", 0), at = {0.7, -0.5, 0.3}, force = {10, 300, -50}, moment = {5, 6, 7}}
      part:couple {on = boundary:above("x", 2), at = {2.5, 0, 0}, kind = "distributed", force = {1e3, -2e3, 3e3},
        moment = {100, 200, 300}}
      part:bond {a = right, b = left}
      part:gravity {0, 3, -9.81}
      local static = assert(part:solve())
      local spring, mass = static:joint_traction {attachment = 1}, static:joint_traction {attachment = 2}
      local rigid, spread = static:joint_traction {coupling = 1}, static:joint_traction {coupling = 2}
      for i, found in ipairs {spring, mass} do
        sums(found, static.attachments[i].force, static.attachments[i].moment)
      end
      local bond = static.bonds[1]
      sums(static:joint_traction {bond = 1}, bond.force, bond.moment)
      sums(rigid, {10, 300, -50})
      sums(spread, {1e3, -2e3, 3e3})
      local weight = bw.material.steel.density * mesh.volume
      for k = 1, 3 do
        local g = ({0, 3, -9.81})[k]
        local sum = spring.force[k] + mass.force[k] + rigid.force[k] + spread.force[k] + weight * g
        assert.is_true(math.abs(sum) < 1e-8 * weight * 9.81)
      end
      check.near(50 * 9.81 / 0.8, -mass.normal:gather(mass.nodes):min(), 1e-8)
      check.near(50 * 9.81 / 0.8, -mass.normal:gather(mass.nodes):max(), 1e-8)
    end
  end)

  it("of a distributed coupling are linear on its face, of a spring those of the displacement", function()
    local mesh = bw.mesh.box {max = {1, 0.2, 0.2}, cells = {8, 2, 2}, order = 2}
    local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 1e9, poisson = 0}}
    local face = mesh.boundary:above("x", 1)
    part:fix(mesh.boundary:below("x", 0))
    part:couple {on = face, at = {1, 0.1, 0.1}, kind = "distributed", force = {40, 0, 0}, moment = {0, 0, 10}}
    part:attach {on = mesh.boundary:above("z", 0.2), spring = {0, 0, 1e5}}
    local static = assert(part:solve())
    local found = assert(static:joint_traction {coupling = 1})
    local inertia = 0.2 ^ 4 / 12
    -- means over the facets of a corner: exact where the facets around it are symmetric
    for i = 1, mesh.node_count do
      local p = mesh.nodes[i]
      if p[1] == 1 and math.abs(p[2] - 0.1) < 1e-9 and math.abs(p[3] - 0.1) < 1e-9 then
        check.near(40 / 0.04, found.normal[i], 0.02)
      end
    end
    local largest = 10 * 0.1 / inertia
    assert.is_true(found.normal:max() < 1000 + largest and found.normal:max() > 1000 + 0.4 * largest)
    check.near(10, -found.moment[3] * -1 + 40 * 0.1, 1e-8)
    local spring = assert(static:joint_traction {attachment = 1})
    local rise = 0
    for i = 1, mesh.node_count do
      if mesh.nodes[i][3] == 0.2 then rise = math.max(rise, math.abs(static.displacement(i, 3))) end
    end
    assert.is_true(spring.normal:max() <= 1e5 * rise / 0.2 * (1 + 1e-9) and spring.shear:max() < 1e-6)
  end)

  it("of a lap joint agree with those of one body of a finer mesh", function()
    local load = {1e4, 0, 0}
    local function lap(cells, bonded)
      local mesh
      local function inside(x, low, high) return x > low - 1e-9 and x < high + 1e-9 end
      if bonded then
        mesh = check.boxes(2, {{{0, 0, 0}, {0.6, 0.1, 0.1}, {cells * 3, 2, 2}}, {{0.4, 0, 0.1}, {1, 0.1, 0.2},
          {cells * 3, 3, 2}}})
      else
        local box = bw.mesh.box {max = {1, 0.1, 0.2}, cells = {5 * cells, 2, 4}, order = 2}
        local keep, element, nodes = {}, box.elements:totable(), box.nodes:totable()
        for _, e in ipairs(element) do
          local x, z = 0, 0
          for k = 1, 4 do x, z = x + nodes[e[k]][1] / 4, z + nodes[e[k]][3] / 4 end
          if z < 0.1 and x < 0.6 or z > 0.1 and x > 0.4 then keep[#keep + 1] = e end
        end
        local used, place = {}, {}
        for _, e in ipairs(keep) do
          for k, n in ipairs(e) do
            if not used[n] then place[#place + 1], used[n] = nodes[n], #place + 1 end
            e[k] = used[n]
          end
        end
        mesh = assert(bw.mesh.new {nodes = place, elements = keep, order = 2}:split("z > 0.1", "high"))
      end
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      part:fix(mesh.boundary:below("x", 0)):slide(mesh.boundary:above("x", 1), {0, 0, 1})
      part:load {on = mesh.boundary:above("x", 1), force = load}
      local found
      if bonded then
        local cut = mesh.boundary:plane({0, 0, 0.1}, {0, 0, 1}, 1e-9)
        part:bond {a = cut:facing({0, 0, -1}, 0.1), b = cut:facing({0, 0, 1}, 0.1)}
        found = assert(assert(part:solve()):joint_traction {bond = 1})
      else
        found = assert(assert(part:solve()):interface_traction("high", "rest"))
      end
      -- means over the middle of the overlap, away from its singular ends
      local shear, normal, count = 0, 0, 0
      for _, n in ipairs(found.nodes:totable()) do
        local p = mesh.nodes[n]
        if inside(p[1], 0.5, 0.5) and inside(p[2], 0.02, 0.08) then
          shear, normal, count = shear + found.traction(n, 1), normal + found.normal[n], count + 1
        end
      end
      return found, shear / count, normal / count
    end
    local bond, shear, normal = lap(4, true)
    local whole, exact, exact_normal = lap(6, false)
    check.near(-1e4, bond.force[1], 1e-8)
    check.near(-1e4, whole.force[1], 1e-8)
    check.near(0.02, bond.area, 1e-12)
    check.near(exact, shear, 0.03)
    assert.is_true(math.abs(exact_normal - normal) < 0.06 * math.abs(exact_normal))
  end)

  it("go to files and pictures, and refuse what they do not know", function()
    local mesh, left, right = bar(1)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(mesh.boundary:below("x", 0)):bond {a = left, b = right}
    part:attach {on = mesh.boundary:above("x", 2), mass = 1}
    part:load {on = mesh.boundary:above("x", 2), force = {0, 0, 7}}
    local static = assert(part:solve())
    local bond = assert(static:joint_traction {bond = 1})
    local path = os.tmpname() .. ".vtu"
    assert(static:write(path, {fields = {bond = bond.traction}}))
    local _, about = assert(bw.mesh.read(path))
    check.same(bond.traction, about.fields.bond, 1e-15)
    os.remove(path)
    local ask = static.joint_traction
    check.raises("bond: a number from 1 to 1 expected", ask, static, {bond = 2})
    check.raises("coupling: there is none", ask, static, {coupling = 1})
    check.raises("either 'bond' or 'support'", ask, static, {bond = 1, support = 1})
    check.raises("the number of a 'bond', an 'attachment'", ask, static, {})
    check.raises("unknown option 'bonds': did you mean 'bond'", ask, static, {bonds = 1})
    part:clear_bonds():bond {a = left, b = right}
    check.raises("the model has changed since this solution", ask, static, {bond = 1})
    local end_of = mesh.boundary
    local three = end_of:nearest {2, 0, 0} | end_of:nearest {2, 0.4, 0} | end_of:nearest {2, 0, 0.4}
    part:couple {on = three, at = {2, 0, 0}, force = {1, 0, 0}}
    local none, message = assert(part:solve()):joint_traction {coupling = 1}
    assert.is_nil(none)
    assert.matches("on 3 nodes without facets, and a traction needs an area", message)
  end)

  it("are not those of solutions without forces of joints", function()
    local mesh, left, right = bar(1)
    local tip = mesh.boundary:above("x", 2)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(mesh.boundary:below("x", 0)):bond {a = left, b = right}
    part:attach {on = tip, mass = 1}:couple {on = tip, at = {2.5, 0.2, 0.2}, force = {0, 0, 7}}
    local instant = assert(part:transient {step = 1e-4}):static()
    for _, kind in ipairs {"bond", "attachment", "coupling"} do
      check.fails("unsupported", "this solution has no forces of " .. kind .. "s: it is an instant of a transient",
        instant:joint_traction {[kind] = 1})
    end
    assert(instant:joint_traction {support = 1})
  end)

  it("leave tractions between regions of joined models as they are", function()
    local mesh = assert(bar(2):split("x < 0.34", "root"))
    local boundary = mesh.boundary
    local cut = boundary:plane({1, 0, 0}, {1, 0, 0}, 1e-9)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(boundary:below("x", 0)):bond {a = cut:facing({1, 0, 0}, 0.1), b = cut:facing({-1, 0, 0}, 0.1)}
    part:load {on = boundary:above("x", 2), force = {100, 200, 300}}
    local between = assert(assert(part:solve()):interface_traction("root", "rest"))
    sums(between, {100, 200, 300})
    assert.is_true(between.imbalance < 1e-8)
    assert.equal(0, between.shared)
  end)
end)
