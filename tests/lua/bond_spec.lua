-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bonds in Lua: a bar of two boxes whose cells do not match, what is printed, and misuse.
local bw = require "barwright"
local check = require "check"

local L = 0.1

-- Two boxes along x, of `gap` between them. `cells_of` both; left out, those that do not match.
local function boxes(gap, cells_of)
  local list = {}
  for n, cells in ipairs(cells_of or {{4, 2, 2}, {5, 3, 3}}) do
    local from = n == 1 and 0 or L + gap
    list[n] = {{from, 0, 0}, {from + L, 0.02, 0.02}, cells}
  end
  return check.boxes(2, list)
end

local function bar(gap, asked, cells_of)
  local mesh = boxes(gap, cells_of)
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  local a = mesh.boundary:plane({L + gap, 0, 0}, {1, 0, 0}, 1e-7)
  local b = mesh.boundary:plane({L, 0, 0}, {1, 0, 0}, 1e-7)
  part:fix(mesh.boundary:below("x", 0))
  return part, part:bond {a = a, b = b, gap = asked}
end

describe("bonds", function()
  it("pass force and moment", function()
    local part = bar(1e-6, 1e-5)
    local mesh = part.mesh
    part:load {on = mesh.boundary:above("x", 2 * L), force = {0, 0, -100}}
    local static = assert(part:solve())
    check.near(100, static.bonds[1].force[3], 1e-8)
    check.near(-100 * 2 * L, static.bonds[1].moment[2], 1e-4)
    -- a slender cantilever: shear adds 0.8 %, the clamp and the few elements take some off
    local steel = bw.material.steel
    local deflection = 100 * (2 * L) ^ 3 / (3 * steel.young * 0.02 ^ 4 / 12)
    check.near(-deflection, static.displacement:column(3):min(), 0.02)
    local modes = assert(part:modes {count = 2})
    local mesh_of_all = bw.mesh.box {max = {2 * L, 0.02, 0.02}, cells = {10, 3, 3}, order = 2}
    local whole = bw.model {mesh = mesh_of_all, material = steel}
    whole:fix(whole.mesh.boundary:below("x", 0))
    check.near(assert(whole:modes {count = 2}).frequencies[1], modes.frequencies[1], 0.01)
  end)

  it("take a preload, and keep its shortening", function()
    local whole = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 1, 1}, order = 2}
    local mesh = assert(whole:split({max = {0.05, 1, 1}}, "left")):separated "left"
    local boundary = mesh.boundary
    local cut = boundary:plane({0.05, 0, 0}, {1, 0, 0}, 1e-9)
    local sides = {a = cut & boundary:region "left", b = cut & boundary:region "rest"}
    local straight = bw.material.isotropic {young = 2e11, poisson = 0}
    local part = bw.model {mesh = mesh, material = straight}
    part:fix(boundary:below("x", 0)):fix(boundary:above("x", 0.1))
    part:bond {a = sides.a, b = sides.b, preload = 1000}
    assert.equal(1000, part.bonds[1].preload)
    assert.truthy(tostring(part):find("preload 1000 N along (1, 0, 0)", 1, true), tostring(part))
    local bond = assert(part:solve()).bonds[1]
    check.near(1000, bond.preload, 1e-10)
    check.near(1000 * 0.1 / (2e11 * 1e-4), bond.shortening, 1e-9)
    -- a mesh that moves, is refined or filled again takes it along
    local turned, same = {}, {}
    for i, p in ipairs(mesh.nodes:totable()) do turned[i], same[i] = {p[2], p[1], -p[3]}, i end
    for name, other in pairs {
      moved = part:moved(assert(mesh:moved(turned))),
      refined = part:refined(bw.array.zeros(mesh.element_count) + 1, {order = 2}),
      transferred = part:transferred(mesh, bw.array.new(same, "i32"))} do
      assert.equal(1000, other.bonds[1].preload, name)
      local found = assert(other:solve()).bonds[1]
      check.near(1000, found.preload, 1e-8)
      check.near(bond.shortening, found.shortening, 1e-8)
    end
    -- a solution keeps it when the part has other bonds
    local static = assert(part:solve())
    assert.truthy(tostring(static):find("bond 1: force on side a (1000, ", 1, true), tostring(static))
    assert.matches("^force on side a %(1000, 0, 0%) N, preload 1000 N, .*; error unknown",
      tostring(static.bonds[1]))
    assert.matches("preload 1000 N, shortening 0.005 mm; error unknown", tostring(static))
    part:clear_bonds():bond {a = sides.a, b = sides.b, shortening = bond.shortening}
    assert.equal(bond.preload, static.bonds[1].preload)
    part:clear_bonds():bond {a = sides.a, b = sides.b}
    assert.equal(bond.preload, static.bonds[1].preload)
    part:clear_bonds():bond {a = sides.a, b = sides.b, shortening = bond.shortening}
    assert.truthy(tostring(part):find("shortened by 5e-06 m", 1, true), tostring(part))
    part:load {on = sides.a, force = {200, 0, 0}}
    check.near(900, assert(part:solve()).bonds[1].preload, 1e-9)
    assert.has_error(function() part:bond {a = sides.a, b = sides.b, preload = 1, shortening = 1} end)
    check.raises("must be above 0", function() part:bond {a = sides.a, b = sides.b, preload = -1000} end)
  end)

  it("buckle as one body, with matching and with other meshes", function()
    local whole = bw.model {mesh = bw.mesh.box {max = {2 * L, 0.02, 0.02}, cells = {8, 2, 2}, order = 2},
      material = bw.material.steel}
    whole:fix(whole.mesh.boundary:below("x", 0))
    whole:load {on = whole.mesh.boundary:above("x", 2 * L), force = {-1000, 0, 0}}
    local expected = assert(whole:buckling {count = 4})
    for i, cells_of in ipairs {{{4, 2, 2}, {4, 2, 2}}, {{4, 2, 2}, {5, 3, 3}}} do
      local part = bar(1e-6, 1e-5, cells_of)
      part:load {on = part.mesh.boundary:above("x", 2 * L), force = {-1000, 0, 0}}
      local static = assert(part:solve())
      for _, name in ipairs {"lanczos", "lobpcg"} do
        local buckling = assert(static:buckling {count = 4, solver = bw.eigensolver[name] {}})
        assert.is_true(buckling.counted)
        for k = 1, 4 do
          check.near(expected.factors[k], buckling.factors[k], i == 1 and 3e-5 or 0.01)
          assert.is_true(buckling.errors[k] < 1e-6 * buckling.factors[k])
        end
        assert.is_true(buckling:error_estimate()[1] < 0.05)
        -- the shape passes the bond without a gap
        local shape, nodes = buckling:shape(1), part.mesh.nodes
        local side = {}
        for n = 1, part.mesh.node_count do
          local at = nodes[n]
          if math.abs(at[1] - L) < 2e-6 and at[2] == 0 and at[3] == 0 then side[#side + 1] = shape[n] end
        end
        assert.equal(2, #side)
        for c = 1, 3 do assert.is_true(math.abs(side[1][c] - side[2][c]) < 1e-4) end
      end
      part:clear_bonds()
      local none, message = static:buckling {count = 1}
      assert.is_nil(none)
      assert.truthy(message, message)
    end
  end)

  it("are listed and printed", function()
    local part = bar(1e-6, 1e-5)
    assert.equal(1, #part.bonds)
    check.near(4e-4, part.bonds[1].area, 1e-12)
    assert.truthy(tostring(part):find("bond 1: 0.0004 m2", 1, true))
    assert.truthy(tostring(part):find("no rigid-body mode is unconstrained", 1, true))
    part:clear_bonds()
    assert.equal(0, #part.bonds)
  end)

  it("say how far the sides are apart, and what else is refused", function()
    local _, made, message = bar(0.003)
    assert.is_nil(made)
    assert.truthy(message:find("0.003 m apart", 1, true), message)
    local part = bar(1e-6, 1e-5)
    local system, why = part:system()
    assert.is_nil(system)
    assert.truthy(why:find("1 bond", 1, true), why)
    assert.has_error(function() part:bond {a = part.mesh.boundary} end)
  end)
end)
