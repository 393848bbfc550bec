-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Which loads the worst case admits (docs/theory/worst_case.md, section 15).
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local box = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}, cells = {8, 4, 2}})
local boundary = box.boundary

-- A free bar, or one fixed at x = 0.
local function bar(fixed, mesh)
  local part = bw.model {mesh = mesh or box, material = bw.material.pla}
  if fixed then part:fix(part.mesh.boundary:below(1, 0)) end
  return part
end

local function with(base, more)
  local opts = {}
  for key, value in pairs(base) do opts[key] = value end
  for key, value in pairs(more) do opts[key] = value end
  return opts
end

-- The largest objective of every element, by exact linear programs.
local function objectives(part, forbidden, pressure)
  local basis = assert(bw.pressure_basis(part.mesh, {forbidden = forbidden}))
  return assert(bw.worst_loads(assert(part:system()), basis, assert(bw.single_regions(part.mesh)),
    {force = 2, pressure = pressure or 2e5, keep_pressures = false})).objectives
end

describe("a forbidden surface", function()
  local top, side = boundary:facing {0, 0, 1}, boundary:facing {0, 1, 0}
  local base = {force = 5, pressure = 2e5, modes = 3, regions = 2, targets = 8}

  it("carries no pressure, and can only lower the worst stress", function()
    for _, fixed in ipairs {false, true} do
      local all, less = objectives(bar(fixed)), objectives(bar(fixed), top)
      local min = objectives(bar(fixed), top | side)
      assert.truthy((less - all):max() <= 1e-7 * all:max())
      assert.truthy((min - less):max() <= 1e-7 * all:max())
      assert.truthy((all - min):max() > 0.01 * all:max())
    end
    local free = assert(bw.worst_case(bar(), with(base, {certify = 0.02})))
    local kept = assert(bw.worst_case(bar(), with(base, {certify = 0.02, forbidden = {top, side}})))
    assert.truthy(kept.max_principal <= free.upper_bound)
    assert.truthy(kept.upper_bound <= free.upper_bound * 1.02)
    local whole = top:union(side)
    for i = 1, #kept.regions do
      local p = kept:pressure(i)
      assert.equal(0, p:gather(whole.nodes):max())
      check.near(5, kept.pressures[i]:dot(kept.basis.areas), 1e-6)
      local f = kept:force(i):column_sums()
      for k = 1, 3 do assert.truthy(math.abs(f[k]) < 1e-6) end
    end
    local brute = assert(bw.brute_force(bar(), {force = 5, pressure = 2e5, objective = "principal", elements = 40,
      forbidden = {top, side}}))
    assert.truthy(brute.max_principal > 0 and brute.max_principal <= kept.upper_bound * (1 + 1e-9))
  end)

  it("may leave less force in balance than is asked for, and says how much", function()
    -- Between the ends alone a bar is squeezed: equal forces, full pressure on both at most.
    local jaws = boundary:facing {0, 0, 1} | boundary:facing {0, 0, -1} | side | boundary:facing {0, -1, 0}
    local basis = assert(bw.pressure_basis(box, {forbidden = jaws}))
    local max = 1e5 * basis.areas:sum()
    local _, _, limit = bw.worst_case(bar(), with(base, {pressure = 1e5, force = 1.01 * max, forbidden = jaws}))
    check.near(max, limit.largest_force, 1e-9)
    assert.truthy(bw.worst_case(bar(), with(base, {pressure = 1e5, force = 0.99 * max, forbidden = jaws})))
    -- Five times as many nodes on one side: the other limits the force.
    local one = boundary:facing {1, 0, 0} | boundary:facing {-1, 0, 0} | side | boundary:facing {0, -1, 0}
    local strip = one | boundary:facing({0, 0, 1}):above(1, 0.051)
    local uneven = assert(bw.pressure_basis(box, {forbidden = strip}))
    local low = 0
    for i = 1, uneven.count do
      if box.nodes(uneven.nodes[i], 3) == 0 then low = low + uneven.areas[i] end
    end
    local _, message, details = bw.worst_case(bar(), with(base, {force = 2e5 * uneven.areas:sum(),
      forbidden = strip}))
    assert.truthy(message:find("are in equilibrium up to a total of", 1, true))
    assert.truthy(details.largest_force < 2 * 2e5 * (uneven.areas:sum() - low) * (1 + 1e-9))
    -- Without inertia: no force at all, or what supports take.
    local back = jaws | boundary:facing {1, 0, 0}
    check.fails("infeasible", "are in equilibrium up to a total of 0 N only", bw.worst_case(bar(),
      with(base, {forbidden = back})))
    local none = assert(bw.worst_case(bar(), with(base, {forbidden = back, force_is_max = true})))
    assert.equal(0, none.max_principal)
    local fixed = bw.model {mesh = box, material = bw.material.pla}
    fixed:fix(boundary:facing {1, 0, 0})
    assert.truthy(bw.worst_case(fixed, with(base, {forbidden = back})).max_principal > 0)
  end)

  it("is a selection of facets of the part's mesh", function()
    local worst <close> = assert(bw.worst_case(bar(), with(base, {forbidden = top})))
    local path = os.tmpname()
    assert(worst:report(path)) -- its options hold a selection, which JSON cannot
    check.raises("report: option 'view': three finite numbers", worst.report, worst, path, {view = {"a"}})
    check.raises("report: option 'lines': three finite", worst.report, worst, path, {lines = {{1, 2}}})
    local lines = {{{0, 0, 0}, {1, 0, 0}}, bw.array {{0, 0, 0}, {0, 1, 0}}}
    assert(worst:report(path, {view = {1, 0, 0}, lines = lines}))
    os.remove(path)
    check.raises("option 'forbidden': a selection or a list of selections expected, got", bw.worst_case,
      bar(), {forbidden = 3})
    check.raises("option 'forbidden': a selection or a list", bw.brute_force, bar(), {forbidden = {}})
    check.raises("covers no facet", bw.worst_case, bar(), {forbidden = boundary:nearest({0, 0, 0}, 1)})
    check.raises("no admissible surface is left", bw.worst_case, bar(), {forbidden = boundary})
    local other = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {1, 1, 1}})
    check.raises("on the mesh of the part", bw.worst_case, bar(), {forbidden = other.boundary})
    check.raises("forbidden: a selection on the same mesh", bw.pressure_basis, box, {forbidden = other.boundary})
  end)
end)

describe("the worst load of a fixed body", function()
  -- The largest weighted sum of gains: no row but that of the total force.
  local function knapsack(gain, areas, pressure, force)
    local order, value, left = gain:order(), 0, force
    for k = order.row_count, 1, -1 do
      local j = order[k]
      local part = math.min(left, pressure * areas[j])
      value, left = value + gain[j] * part, left - part
    end
    return value
  end

  it("is that of a search over all directions", function()
    local part, limits = bar(true), {force = 2, pressure = 2e5}
    local worst = assert(bw.worst_case(part, {force = 2, pressure = 2e5, modes = 3, regions = 2, targets = 8,
      certify = 0.01}))
    local gains = {}
    local function gain_of(n) -- of the normal stress in a direction, by pressure and area
      local t = bw.array {{n[1] * n[1], n[2] * n[2], n[3] * n[3], n[2] * n[3], n[3] * n[1], n[1] * n[2]}}
      local regions = assert(core.directed_regions(box, {worst.element}, t))
      return worst.basis:gradient(assert(worst.system:solve(assert(regions:objective(1, part.material)))))
    end
    local h = math.sqrt(0.5)
    local six = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, h, h}, {h, 0, h}, {h, h, 0}}
    for i, n in ipairs(six) do gains[i] = gain_of(n) end
    local areas, largest = worst.basis.areas, 0
    local count = 300
    for i = 1, count do -- directions spread evenly over a half sphere
      local z, angle = (i - 0.5) / count, i * math.pi * (3 - math.sqrt(5))
      local r = math.sqrt(1 - z * z)
      local x, y = r * math.cos(angle), r * math.sin(angle)
      -- n n^T from those of the six directions: 2 y z yz = 2 y z ((0, h, h) less half of yy and zz)
      local gain = gains[1] * (x * x - x * y - x * z) + gains[2] * (y * y - y * z - x * y)
        + gains[3] * (z * z - y * z - x * z) + gains[4] * (2 * y * z) + gains[5] * (2 * x * z)
        + gains[6] * (2 * x * y)
      for _, sign in ipairs {1, -1} do
        local value = knapsack(gain * sign / areas, areas, limits.pressure, limits.force)
        largest = math.max(largest, value)
        if i % 100 == 1 then
          local _, program = assert(worst.basis:maximise(worst.system, gain * sign, limits))
          check.near(program, value, 1e-8)
        end
      end
    end
    assert.truthy(largest <= worst.upper_bound * (1 + 1e-9))
    assert.truthy(largest >= 0.98 * worst.max_principal and largest <= worst.max_principal * 1.0101)
  end)

  it("bends a cantilever at its tip", function()
    local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}, cells = {10, 2, 1}, order = 2})
    local part = bar(true, mesh)
    local worst = assert(bw.worst_case(part, {force = 1, contact = 2e-5, modes = 4, regions = 2}))
    local stress = bw.max_principal(assert(bw.nodal_stress(mesh, part.material, assert(worst:displacement()))))
    -- 6 F L / (b h^2) at the root, where the support of a finite mesh adds to it.
    local beam = 6 * 1 * 0.1 / (0.02 * 0.01 ^ 2)
    assert.truthy(stress:max() > 0.85 * beam and stress:max() < 1.5 * beam, stress:max() / beam)
    assert.truthy(worst.at[1] < 0.02)
    local arrow = worst:arrows()[1]
    assert.truthy(arrow.at[1] > 0.085 and math.abs(arrow.force[3]) > 0.9, arrow.at[1])
  end)

  it("needs supports that leave no rigid-body mode", function()
    local part = bar(true)
    part:prescribe(boundary:above(1, 0.1), {1e-5, false, false})
    check.fails("unsupported", "prescribes a displacement", bw.worst_case(part, {modes = 2}))
    check.fails("unsupported", "prescribes a displacement", bw.brute_force(part, {elements = 2}))
  end)

  it("needs them of the part as it is, not as it was", function()
    local part = bar(true)
    local low, high = boundary:below(1, 0), boundary:above(1, 0.1)
    local function move(x) part:clear_supports():fix(low):prescribe(high, {x, false, false}) end
    move(0)
    assert(bw.worst_case(part, {modes = 2}))
    move(1e-5)
    check.fails("unsupported", "prescribes a displacement", bw.worst_case(part, {modes = 2}))
    move(0)
    assert(bw.worst_case(part, {modes = 2}))
  end)
end)

describe("the least contact", function()
  it("is the total force over the largest pressure", function()
    local base = {force = 5, modes = 3, regions = 2, targets = 8}
    local by_contact = assert(bw.worst_case(bar(), with(base, {contact = 2.5e-5})))
    local by_pressure = assert(bw.worst_case(bar(), with(base, {pressure = 2e5})))
    assert.equal(2e5, by_contact.options.pressure)
    assert.equal(by_pressure.weakness:tostring "<f8", by_contact.weakness:tostring "<f8")
    for i = 1, #by_contact.regions do -- the area under pressure is no less
      local pressed = by_contact.pressures[i]:above(0)
      assert.truthy(pressed:dot(by_contact.basis.areas) >= 2.5e-5 * (1 - 1e-9))
    end
    assert.equal(2e5, assert(bw.worst_case(bar(), {modes = 1, regions = 1, method = "paper"})).options.pressure)
  end)

  it("lowers the worst stress where it is larger", function()
    for _, fixed in ipairs {false, true} do
      local former
      for _, contact in ipairs {5e-6, 2e-5, 8e-5, 3e-4} do
        local now = objectives(bar(fixed), nil, 2 / contact)
        if former then assert.truthy((now - former):max() <= 1e-7 * former:max()) end
        former = now
      end
    end
    local small = assert(bw.worst_case(bar(), {force = 5, contact = 1e-5, modes = 3, targets = 8, certify = 0.02}))
    local large = assert(bw.worst_case(bar(), {force = 5, contact = 1e-3, modes = 3, targets = 8, certify = 0.02}))
    assert.truthy(large.max_principal <= small.upper_bound)
    assert.truthy(large.upper_bound < small.max_principal, large.upper_bound / small.max_principal)
  end)

  it("is given instead of the pressure, and fits on the surface", function()
    check.raises("'pressure' and 'contact'", bw.worst_case, bar(), {contact = 1e-4, pressure = 1e5})
    check.raises("option 'contact': a number above 0 expected", bw.brute_force, bar(), {contact = 0})
    check.fails("infeasible", "a smaller contact", bw.worst_case(bar(), {contact = 1, modes = 1}))
  end)
end)
