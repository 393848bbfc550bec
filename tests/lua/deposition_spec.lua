-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- part:deposit: layers, release, files, and what is refused.
local bw = require "barwright"
local check = require "check"

local steel = bw.material.isotropic {young = 210e9, poisson = 0.3, density = 7850, expansion = 12e-6}
local young, poisson, expansion = steel.young, steel.poisson, steel.expansion

local function box(order)
  return bw.mesh.box {max = {0.04, 0.02, 0.01}, cells = {8, 4, 5}, order = order or 2}
end

describe("a deposition", function()
  it("strains each layer between walls as it is laid", function()
    local mesh = box()
    local part = bw.model {mesh = mesh, material = steel}
    local all = mesh.boundary
    for axis, high in ipairs {0.04, 0.02} do
      local normal = {0, 0, 0}
      normal[axis] = 1
      part:slide(all:below(axis, 0), normal):slide(all:above(axis, high), normal)
    end
    part:slide(all:below(3, 0), {0, 0, 1})
    local built = assert(part:deposit {layers = 5, change = -100})
    local expected = young * expansion * 100 / (1 - poisson)
    assert.equal(5, built.layers)
    assert.equal(0, built.postponed)
    check.near(expected, built.element_von_mises:min(), 1e-8)
    check.near(expected, built.element_von_mises:max(), 1e-8)
    assert.truthy(tostring(built):find("5 layers", 1, true))
    assert.truthy(tostring(built):find("error unknown", 1, true))
  end)

  it("takes layers and changes one by one, in any direction", function()
    local mesh = box(1)
    local part = bw.model {mesh = mesh, material = steel}:fix(mesh.boundary:below("x", 0))
    local by_height = assert(part:deposit {layers = 4, direction = {2, 0, 0}, change = -50})
    local change = bw.array.zeros(mesh.node_count, 1) - 50
    local one_by_one = assert(part:deposit {layer = by_height.layer, change = change})
    assert.equal(0, (by_height.element_stress - one_by_one.element_stress):norm())
    assert.equal(4, by_height.layer:max())
  end)

  it("springs back when it leaves its plate, and pulls on nothing then", function()
    local mesh = box()
    local part = bw.model {mesh = mesh, material = steel}:fix(mesh.boundary:below("z", 0))
    local built = assert(part:deposit {layers = 5, change = -200})
    local off = assert(built:release(bw.model {mesh = mesh, material = steel}))
    assert.is_true(built.reaction:norm() > 1e3)
    assert.equal(0, off.reaction:norm())
    assert.is_true(off.element_von_mises:max() < built.element_von_mises:max())
    -- the layers above are shorter than those beneath, so that the ends rise
    local u, nodes = off.displacement, mesh.nodes
    local ends, middle, n, m = 0, 0, 0, 0
    for i = 1, mesh.node_count do
      if nodes(i, 3) == 0 and (nodes(i, 1) == 0 or nodes(i, 1) == 0.04) then ends, n = ends + u(i, 3), n + 1 end
      if nodes(i, 3) == 0 and math.abs(nodes(i, 1) - 0.02) < 1e-9 then middle, m = middle + u(i, 3), m + 1 end
    end
    assert.is_true(ends / n > middle / m + 1e-6)
  end)

  it("is released with the material that was laid, and with no other", function()
    local mesh = box(1)
    local built = assert(bw.model {mesh = mesh, material = steel}:fix(mesh.boundary:below("z", 0))
      :deposit {layers = 2, change = -50})
    local same = bw.material.isotropic {young = steel.young, poisson = steel.poisson}
    assert(built:release(bw.model {mesh = mesh, material = same}))
    local ok, message = pcall(built.release, built, bw.model {mesh = mesh, material = bw.material.pla})
    assert.is_false(ok)
    assert.truthy(tostring(message):find("another stiffness than it was laid down with", 1, true), message)
  end)

  it("writes files and pictures", function()
    local mesh = box(1)
    local built = assert(bw.model {mesh = mesh, material = steel}:deposit {layers = 2, change = -50})
    local folder = check.folder()
    assert.is_true(built:write(folder .. "/built.vtu"))
    assert.is_true(built:picture(folder .. "/built.png"))
  end)

  it("refuses what it does not know", function()
    local mesh = box(1)
    local part = bw.model {mesh = mesh, material = steel}
    local function raises(text, options)
      local ok, message = pcall(part.deposit, part, options)
      assert.is_false(ok)
      assert.truthy(tostring(message):find(text, 1, true), message)
    end
    raises("one of the options 'layers' and 'layer' expected, got none", {change = -1})
    raises("got both", {layers = 2, layer = {1}, change = -1})
    raises("option 'change'", {layers = 2})
    raises("one for each element, got 1", {layer = {1}, change = -1})
    raises("one for each node, got 2", {layers = 2, change = {1, 2}})
    raises("0 layers: 1 or more expected", {layers = 0, change = -1})
    raises("2147483647 layers, but the mesh has 960 elements: give fewer", {layers = 2147483647, change = -1})
    raises("no length", {layers = 2, direction = {0, 0, 0}, change = -1})
    raises("nothing shrinks", {layers = 2, change = 0})
    part:gravity {0, 0, -9.81}
    raises("has 1 load; leave it out", {layers = 2, change = -1})
  end)
end)
