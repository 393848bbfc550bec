-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Which loads the breaking force admits (docs/theory/breaking_force.md): supports, forbidden surface, friction,
-- hands, in Lua and on the command line.
local bw = require "barwright"
local check = require "check"

local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.01, 0.01}, cells = {10, 2, 1}, order = 2})
local file = check.folder() .. "/bar.vtu"
assert(mesh:write(file))

local function root(of) return of.boundary:below(1, 1e-6) end
local function outer_half(of) return of.boundary:above(1, 0.05) end

local function breaking(given, on)
  local options = {material = bw.material.pla}
  for key, value in pairs(given or {}) do options[key] = value end
  return assert(bw.breaking_force(on or mesh, options))
end

describe("the breaking force of a fixed bar", function()
  it("is that of a cantilever", function()
    local found <close> = breaking {fix = root, force = 7}
    -- sigma = 6 F L / h^3 with the force on the last 10 mm; a patch's mean is less than the stress at the root.
    local stiffest = bw.material.pla.strength * 0.01 ^ 3 / (6 * 0.095)
    assert.is_true(found.force > 0.8 * stiffest and found.force < 1.6 * stiffest, tostring(found))
    assert.is_true(found.at[1] < 0.011) -- elements of 10 mm
    check.near(1e-4, found.fixed_area, 1e-9)
    -- All of the force pushes, and nothing pushes back but the supports.
    assert.equal(7, found.worst.options.force)
    check.near(7, found.worst.pressures[1]:dot(found.worst.basis.areas), 1e-9)
    local free <close> = breaking {force = 7}
    assert.equal(14, free.worst.options.force)
    assert.is_true(found.force < free.force / 2)
    -- Where nothing presses on the outer half, the arm is half as long.
    local near <close> = breaking {fix = root, forbidden = function(of) return {outer_half(of)} end}
    assert.is_true(near.force > 1.7 * found.force and near.force < 2.7 * found.force, near.force / found.force)
    local beyond = found.mesh.boundary:above(1, 0.051) -- cells beside the border share its nodes
    assert.equal(0, near.worst:pressure():gather(beyond.nodes):max())
    check.near(outer_half(mesh).area, near.forbidden_area, 1e-9)
  end)

  it("falls with friction", function()
    local alone <close> = breaking()
    local rough <close> = breaking {friction = 0.5}
    assert.is_true(rough.force < alone.force)
    -- The pyramid contains the cone: its edges are longer, the centres of its faces are not.
    check.near(0.5 / math.cos(math.pi / 8), rough.worst.options.friction, 1e-12)
  end)

  it("grows where few hands press", function()
    local fine = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}, order = 2})
    local alone <close> = breaking(nil, fine)
    local two <close> = breaking({hands = 2}, fine)
    assert.is_true(two.force > 2 * alone.force) -- they can only squeeze
    local one <close> = breaking({fix = root, hands = 1}, fine)
    local fixed <close> = breaking({fix = root}, fine)
    assert.is_true(one.force >= fixed.force * 0.98 and one.force < 1.1 * fixed.force)
  end)

  it("names what is wrong", function()
    local function raises(what, given) check.raises(what, breaking, given) end
    raises("option 'hands': a part without supports moves freely under the load of one hand", {hands = 1})
    raises("option 'fix': a function expected", {fix = root(mesh)})
    raises("option 'fix': a function of the mesh that returns selections", {fix = function() return {7} end})
    raises("option 'friction': a number of at least 0", {friction = -1})
    local function fails(status, what, given)
      given.material = bw.material.pla
      check.fails(status, what, bw.breaking_force(mesh, given))
    end
    fails("invalid", "the whole surface is constrained", {fix = function(of) return of.boundary end})
    fails("empty", "'forbidden' selects nothing", {forbidden = function() return {} end})
    raises("no admissible surface is left for pressures", {forbidden = function(of) return of.boundary end})
    fails("odd", "nothing there", {fix = function() return nil, "nothing there", {status = "odd"} end})
    check.raises("my own mistake", bw.breaking_force, mesh, {material = bw.material.pla,
      fix = function() error "my own mistake" end})
  end)
end)

describe("barwright worst", function()
  local function worst(options)
    return check.run("worst '" .. file .. "' " .. options)
  end

  it("takes supports, forbidden places, friction and hands", function()
    local status, out = worst "--fix min:x --forbid above:x:50mm --friction 0.3 --hands 1 --force 1"
    assert.is_true(status <= 1, out) -- one mesh alone leaves much open
    assert.truthy(out:find("Constrained at min:x (1 cm2)", 1, true))
    assert.truthy(out:find("No load on above:x:50mm", 1, true))
    assert.truthy(out:find("Coefficient of friction 0.3", 1, true))
    assert.truthy(out:find("within 1 place at once", 1, true))
    status, out = worst "--fix min:x --force 5kN --json"
    assert.equal(1, status)
    assert.truthy(out:find '"supported_area_m2": [%d.e-]+')
    assert.truthy(out:find '"friction": 0')
  end)

  it("refuses what is no place and what cannot be", function()
    for options, what in pairs {
      ["--fix nowhere"] = "option --fix: 'nowhere' is no place",
      ["--forbid near:1"] = "option --forbid: near:X,Y,Z:RADIUS expected, got 'near:1'",
      ["--fix near:1,1,1m:1mm"] = "selects no boundary node",
      ["--fix all"] = "the whole surface is constrained",
      ["--forbid all"] = "no admissible surface is left for pressures",
      ["--hands 1"] = "option --hands: a part without supports moves freely",
      ["--hands 0"] = "--hands", ["--friction -0.1"] = "--friction",
    } do
      local status, _, err = worst(options)
      assert.equal(2, status, options)
      assert.truthy(err:find(what, 1, true), err)
    end
  end)
end)
