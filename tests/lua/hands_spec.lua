-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst case of few hands (docs/theory/worst_case.md, section 15).
local bw = require "barwright"
local check = require "check"

local box, free, fixed = check.bar()

local limits = {force = 5, pressure = 2e5, modes = 3, regions = 2, targets = 4}
local function analyse(part, more)
  local opts = {}
  for key, value in pairs(limits) do opts[key] = value end
  for key, value in pairs(more) do opts[key] = value end
  return bw.worst_case(part, opts)
end

describe("the worst case of few hands", function()
  it("takes three to bend a free bar; two only squeeze it", function()
    local any = assert(analyse(free, {certify = 0.05}))
    local three = assert(analyse(free, {hands = 3, hand = 1e-4, certify = 0.05}))
    local two = assert(analyse(free, {hands = 2, hand = 1e-4}))
    assert.truthy(three.max_principal > 0.9 * any.max_principal)
    assert.truthy(three.max_principal <= any.upper_bound and three.max_principal <= three.upper_bound)
    assert.truthy(two.max_principal < 0.5 * three.max_principal)
    assert.truthy(tostring(two):find("2 hands of 1 cm2", 1, true))
    -- Equal and opposite, half of the total each.
    local arrows = two:arrows(nil, 0.02)
    assert.equal(2, #arrows)
    for k = 1, 3 do check.near(arrows[1].force[k], -arrows[2].force[k], 1e-6) end
    for i = 1, #two.regions do
      assert.truthy(two.pressures[i]:min() >= -1e-6 and two.pressures[i]:max() <= 2e5 * (1 + 1e-9))
      check.near(5, two.pressures[i]:dot(two.basis.areas), 1e-6)
      local f = two:force(i):column_sums()
      for k = 1, 3 do assert.truthy(math.abs(f[k]) < 1e-6) end
    end
  end)

  it("says that the upper bound leaves the hands out", function()
    local one = assert(analyse(fixed, {hands = 1, certify = 0.05}))
    local two = assert(analyse(free, {hands = 2, certify = 0.05}))
    local any = assert(analyse(free, {certify = 0.05}))
    assert.equal("for pressure anywhere instead of within hands", two.bounded)
    assert.truthy(tostring(two):find("on this mesh for pressure anywhere instead of within hands", 1, true))
    assert.is_nil(any.bounded)
    assert.is_nil(tostring(any):find("anywhere", 1, true))
    -- It is that of any pressure: tight where hands take nothing away, and not for two that can only squeeze.
    check.near(any.max_principal, two.upper_bound, 0.05 * 1.001)
    assert.truthy(one.gap <= 0.0501 and two.gap > 1)
  end)

  it("finds nothing for one hand on a free body, and all for one on a cantilever", function()
    check.fails("infeasible", "no load of 1 hands was found", analyse(free, {hands = 1}))
    local any, one = assert(analyse(fixed, {})), assert(analyse(fixed, {hands = 1, hand = 1e-4}))
    check.near(any.max_principal, one.max_principal, 1e-6)
    assert.equal(1, #one:arrows(nil, 0.02))
    -- By default each hand has the least contact of the whole force.
    check.near(5 / 2e5, assert(analyse(fixed, {hands = 2})).options.hand, 1e-15)
  end)

  it("goes together with friction, forbidden surfaces and brute force", function()
    local top = box.boundary:facing {0, 0, 1}
    local both = assert(analyse(fixed, {hands = 1, hand = 1e-4, friction = 0.3, friction_facets = 4,
      forbidden = top}))
    assert.equal(0, both:pressure():gather(top.nodes):max())
    local brute = assert(bw.brute_force(fixed, {force = 5, pressure = 2e5, hands = 1, hand = 1e-4, elements = 10}))
    local all = assert(bw.brute_force(fixed, {force = 5, pressure = 2e5, elements = 10}))
    assert.truthy(brute.max_principal > 0 and brute.max_principal <= all.max_principal * (1 + 1e-9))
  end)

  it("gives the same bits on any number of threads", function()
    local threads = bw.threads()
    local one = assert(analyse(fixed, {hands = 2}))
    bw.threads(threads == 1 and 3 or 1)
    local again = assert(analyse(fixed, {hands = 2}))
    bw.threads(threads)
    assert.equal(one.pressures:tostring "<f8", again.pressures:tostring "<f8")
  end)

  it("says what it takes", function()
    check.raises("option 'hands': a whole number of at least 1", bw.worst_case, free, {hands = 0})
    check.raises("option 'hands': a whole number of at most 16", bw.brute_force, free, {hands = 17})
    check.raises("option 'hand', the area of each hand, needs option 'hands'", bw.worst_case, free, {hand = 1e-4})
  end)
end)
