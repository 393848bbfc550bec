-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst case with friction (docs/theory/worst_case.md, section 15).
local bw = require "barwright"
local check = require "check"

local box, free, fixed = check.bar()

-- The largest objective of every element, by exact linear programs.
local function objectives(part, friction, facets)
  local basis = assert(bw.pressure_basis(box, {friction = friction, friction_facets = facets}))
  return assert(bw.worst_loads(assert(part:system()), basis, assert(bw.single_regions(box)),
    {force = 2, pressure = 2e5, keep_pressures = false})).objectives
end

describe("the worst case with friction", function()
  local limits = {force = 5, pressure = 2e5, modes = 3, regions = 2, targets = 8}
  local function analyse(part, more)
    local opts = {}
    for key, value in pairs(limits) do opts[key] = value end
    for key, value in pairs(more) do opts[key] = value end
    return assert(bw.worst_case(part, opts))
  end

  it("is that of pressure alone where there is none", function()
    local none, alone = analyse(free, {friction = 0}), analyse(free, {})
    assert.equal(alone.weakness:tostring "<f8", none.weakness:tostring "<f8")
    assert.equal(0, none.friction_error)
    assert.is_nil(tostring(none):find "friction")
  end)

  it("grows with the friction, and with the facets from below", function()
    for _, part in ipairs {free, fixed} do
      local former, min = objectives(part, 0), 1e-7
      local first = former
      for _, friction in ipairs {0.1, 0.3, 1} do
        local now = objectives(part, friction, 8)
        assert.truthy((now - former):min() >= -min * former:max())
        former = now
      end
      assert.truthy((former - first):max() > 0.1 * first:max())
      former = nil
      for _, facets in ipairs {3, 6, 12} do
        local inside = objectives(part, 0.4, facets)
        local around = objectives(part, 0.4 / math.cos(math.pi / facets), facets)
        if former then assert.truthy((inside - former):min() >= -min * former:max()) end
        assert.truthy((around - inside):min() >= -min * inside:max())
        former = inside
      end
    end
  end)

  it("keeps its loads within the cone, their total and balance", function()
    local friction, facets = 0.5, 6
    local worst = analyse(free, {friction = friction, friction_facets = facets, certify = 0.05})
    local alone = analyse(free, {certify = 0.05})
    assert.truthy(worst.upper_bound * 1.0001 >= alone.max_principal)
    assert.truthy(worst.gap <= 0.0501)
    check.near(1 - math.cos(math.pi / 6), worst.friction_error, 1e-12)
    assert.truthy(tostring(worst):find("friction 0.5, the cone by 6 facets (13 % narrower at most)", 1, true))
    for i = 1, #worst.regions do
      local p = worst:pressure(i)
      assert.truthy(worst.pressures[i]:min() >= -1e-6 and p:max() <= 2e5 * (1 + 1e-9))
      check.near(5, worst.pressures[i]:dot(worst.basis.areas), 1e-6)
      local f = worst:force(i):column_sums()
      for k = 1, 3 do assert.truthy(math.abs(f[k]) < 1e-6) end
    end
    check.near(worst.max_principal, bw.max_principal(assert(worst:stress())):max(), 1e-6)
    local brute = assert(bw.brute_force(free, {force = 5, pressure = 2e5, friction = friction,
      friction_facets = facets, objective = "principal", elements = 30}))
    assert.truthy(brute.max_principal > 0 and brute.max_principal <= worst.upper_bound * (1 + 1e-9))
  end)

  it("bounds the pyramid's loads, and Coulomb's with a pyramid around the cone", function()
    local inside = analyse(free, {friction = 0.4, friction_facets = 4, certify = 0.02})
    local around = analyse(free, {friction = 0.4 / math.cos(math.pi / 4), friction_facets = 4, certify = 0.02})
    local close = analyse(free, {friction = 0.4, friction_facets = 32})
    assert.equal("for friction of the pyramid, 29 % less than Coulomb's at most", inside.bounded)
    assert.truthy(tostring(inside):find("on this mesh for friction of the pyramid", 1, true))
    assert.truthy(close.max_principal > inside.upper_bound) -- hence the words
    assert.truthy(close.max_principal <= around.upper_bound)
  end)

  it("drags a face by the pressure times the friction", function()
    local top = box.boundary:facing {0, 0, 1}
    local worst = analyse(fixed, {friction = 0.5, friction_facets = 16, forbidden = box.boundary:difference(top)})
    for i = 1, #worst.regions do
      local f = worst:force(i):column_sums()
      check.near(-5, f[3], 1e-6)
      assert.truthy(math.sqrt(f[1] ^ 2 + f[2] ^ 2) <= 0.5 * 5 * (1 + 1e-9))
    end
    -- All drag one way where the bar is bent and pulled most.
    local f = worst:force():column_sums()
    assert.truthy(math.sqrt(f[1] ^ 2 + f[2] ^ 2) > 0.5 * 5 * 0.9)
    local arrows, sum = worst:arrows(), 0
    for _, arrow in ipairs(arrows) do sum = sum + arrow.force[3] end
    check.near(-5, sum, 1e-6)
  end)

  it("gives the same bits on any number of threads", function()
    local threads = bw.threads()
    local one = analyse(free, {friction = 0.3})
    bw.threads(threads == 1 and 3 or 1)
    local again = analyse(free, {friction = 0.3})
    bw.threads(threads)
    assert.equal(one.weakness:tostring "<f8", again.weakness:tostring "<f8")
    assert.equal(one.pressures:tostring "<f8", again.pressures:tostring "<f8")
  end)

  it("says what it takes", function()
    check.raises("option 'friction': a number of at least 0", bw.worst_case, free, {friction = -0.1})
    check.raises("option 'friction_facets': a whole number of at least 3", bw.brute_force, free,
      {friction = 0.1, friction_facets = 2})
    check.raises("a friction cone of 2 facets", bw.pressure_basis, box, {friction = 0.1, friction_facets = 2})
    local basis = assert(bw.pressure_basis(box, {friction = 0.1, friction_facets = 5}))
    assert.equal(5, basis.directions)
    assert.equal(basis.count, 5 * assert(bw.pressure_basis(box)).count)
    check.fails("unsupported", "have no friction", require("barwright.core").worst_screening(assert(free:system()),
      basis, {force = 1, pressure = 1e5}))
  end)
end)
