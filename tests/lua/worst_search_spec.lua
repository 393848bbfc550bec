-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
local bw = require "barwright"
local check = require "check"

package.path = check.root .. "/scripts/worst_case/?.lua;" .. package.path

-- A plate with two holes and a rib: compact, with small features, as machine parts are.
local function plate()
  local grid = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.06, 0.04, 0.012}, cells = {15, 10, 3}})
  local centres = grid.nodes:gather(grid.elements:column(1))
  for corner = 2, 4 do centres = centres + grid.nodes:gather(grid.elements:column(corner)) end
  return assert(grid:subset((centres / 4):map [[(a.z < 0.004 or (a.y > 0.016 and a.y < 0.024 and a.x < 0.044)) and
    not (hypot(a.x - 0.012, a.y - 0.01) < 0.004) and not (hypot(a.x - 0.046, a.y - 0.028) < 0.006)]]))
end

describe("the search of the worst case", function()
  local mesh = plate()
  local part = bw.model {mesh = mesh, material = bw.material.pla}
  local function analyse(more)
    local opts = {force = 10, pressure = 2e5, modes = 6, regions = 3, targets = 16}
    for key, value in pairs(more or {}) do opts[key] = value end
    return assert(bw.worst_case(part, opts))
  end
  local search, paper = analyse(), analyse {method = "paper"}

  it("keeps the paper's method as it is", function()
    local limits = {force = 10, pressure = 2e5}
    local loads = assert(bw.worst_loads(paper.system, paper.basis, paper.weak_regions, limits))
    assert.equal(loads.weakness:tostring "<f8", paper.weakness:tostring "<f8")
    assert.equal(loads.pressures:tostring "<f8", paper.pressures:tostring "<f8")
    assert.equal(loads.worst_region:tostring "<i4", paper.worst_region:tostring "<i4")
    assert.equal(paper.weak_regions.count, #paper.regions)
    for _, region in ipairs(paper.regions) do
      assert.equal("mode", region.origin)
      assert.truthy(region.mode and region.rank)
    end
    assert.equal("search", search.options.method)
    assert.equal("paper", paper.options.method)
  end)

  it("adds loads to those of the modes, and takes none away", function()
    assert.truthy(#search.regions > #paper.regions + 16)
    assert.equal(paper.pressures:tostring "<f8", search.pressures:rows(1, #paper.regions):copy():tostring "<f8")
    assert.truthy((search.weakness - paper.weakness):min() >= 0)
    local found = {}
    for i, region in ipairs(search.regions) do
      found[region.origin] = (found[region.origin] or 0) + 1
      if i > #paper.regions then
        assert.truthy(region.target >= 1 and region.target <= mesh.element_count)
        assert.is_nil(region.mode)
        assert.equal(1, region.elements)
      end
    end
    assert.equal(#paper.regions, found.mode)
    assert.truthy(found.element >= 16 and found.ascent >= 1)
  end)

  it("never loses stress in an ascent", function()
    local count = 0
    for _, region in ipairs(search.regions) do
      if region.origin == "ascent" then
        count = count + 1
        assert.truthy(region.objective >= search.regions[region.from].max_principal * (1 - 1e-9))
        assert.truthy(region.max_principal >= region.objective * (1 - 1e-9))
      end
    end
    assert.truthy(count > 0)
  end)

  it("finds loads that keep their limits, and the stresses of these loads", function()
    for i = 1, #search.regions do
      local p = search.pressures[i]
      assert.truthy(p:min() >= -1e-6 and p:max() <= 2e5 * (1 + 1e-9))
      check.near(10, p:dot(search.basis.areas), 1e-6)
      local f = search:force(i):column_sums()
      for k = 1, 3 do assert.truthy(math.abs(f[k]) < 1e-6) end
    end
    local stress = bw.max_principal(assert(search:stress()))
    check.near(search.max_principal, stress:max(), 1e-6)
    assert.equal(search.element, (stress:argmax()))
    assert.equal(search.max_principal, search.weakness:max())
  end)

  it("reaches brute force", function()
    local limits = {force = 10, pressure = 2e5}
    local brute = assert(bw.brute_force(part, limits))
    assert.truthy(brute:compare(search).ratio > 0.97, brute:compare(search).ratio)
    assert.truthy(search.max_principal > 0.999 * brute.max_principal)
    -- The ascent of every element's principal stress starts from brute force's own loads.
    limits.objective = "principal"
    local best = assert(bw.brute_force(part, limits))
    assert.truthy(best.max_principal >= brute.max_principal * (1 - 1e-9))
    assert.truthy((best.weakness - brute.weakness):min() >= 0)
    assert.equal(best.weakness:max(), best.max_principal)
    assert.equal(best.element, (best.weakness:argmax()))
    assert.truthy(search.max_principal <= 1.05 * best.max_principal)
    limits.elements = 20
    assert.equal(20, assert(bw.brute_force(part, limits)).elements)
  end)

  it("reaches brute force on a crankcase", function()
    local parts, surface = require "machine_parts", nil
    for _, one in ipairs(parts.list) do
      if one.name == "crankcase" then surface = parts.surface(one) end
    end
    local body = assert(bw.mesh.fill(surface, {elements = 2000, tolerance = 0.1}))
    local crankcase, limits = bw.model {mesh = body, material = bw.material.pla}, {force = 20, pressure = 2e5}
    local brute, found = assert(bw.brute_force(crankcase, limits)), assert(bw.worst_case(crankcase, limits))
    assert.truthy(brute:compare(found).ratio > 0.97, brute:compare(found).ratio)
    assert.truthy(found.max_principal > 0.999 * brute.max_principal, found.max_principal / brute.max_principal)
  end)

  it("bounds the largest stress from above", function()
    local box = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}, cells = {8, 2, 2}})
    local body = bw.model {mesh = box, material = bw.material.pla}
    local limits = {force = 5, pressure = 2e5, modes = 4, regions = 2, targets = 8, certify = 0.01}
    local certified = assert(bw.worst_case(body, limits))
    assert.truthy(certified.upper_bound >= certified.max_principal)
    assert.truthy(certified.gap >= 0 and certified.gap <= 0.0101)
    check.near(certified.gap, certified.upper_bound / certified.max_principal - 1, 1e-12)
    assert.truthy(tostring(certified):find "at most [%d.]+ MPa on this mesh; error unknown")
    -- No admissible load that anything else finds exceeds it.
    local best = assert(bw.brute_force(body, {force = 5, pressure = 2e5, objective = "principal"}))
    assert.truthy(best.max_principal <= certified.upper_bound * (1 + 1e-9))
    -- From a poor start (one region of one mode) it finds the larger stress on its own.
    limits.modes, limits.regions, limits.method, limits.certify = 1, 1, "paper", 0.02
    local threads = bw.threads()
    local poor = assert(bw.worst_case(body, limits))
    bw.threads(threads == 1 and 3 or 1)
    local again = assert(bw.worst_case(body, limits))
    bw.threads(threads)
    assert.equal("bound", poor.origin)
    assert.equal("branch and bound, element " .. poor.regions[poor.region].target, poor.regions[poor.region].label)
    assert.truthy(poor.max_principal >= certified.upper_bound / 1.0101 / 1.02)
    assert.equal(poor.upper_bound, again.upper_bound)
    assert.equal(poor.weakness:tostring "<f8", again.weakness:tostring "<f8")
    check.raises("option 'certify'", bw.worst_case, body, {certify = 0.01, target = "displacement"})
    check.raises("option 'certify': a number of at least 0.001", bw.worst_case, body, {certify = 1e-9})
  end)

  it("gives the same bits on any number of threads", function()
    local threads = bw.threads()
    bw.threads(threads == 1 and 3 or 1)
    local again = analyse()
    bw.threads(threads)
    assert.equal(search.weakness:tostring "<f8", again.weakness:tostring "<f8")
    assert.equal(search.pressures:tostring "<f8", again.pressures:tostring "<f8")
  end)

  it("takes fixed bodies, several bodies, forces that may be smaller and few elements", function()
    local fixed = bw.model {mesh = mesh, material = bw.material.pla}
    fixed:fix(mesh.boundary:below(1, 0))
    local worst = assert(bw.worst_case(fixed, {force = 2, pressure = 2e5, modes = 4, targets = 8}))
    assert.truthy(worst.max_principal > 0)
    assert.truthy(analyse({force_is_max = true}).max_principal >= 0.999 * search.max_principal)
    local box = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.05, 0.01, 0.005}, cells = {3, 1, 1}})
    assert.truthy(assert(bw.worst_case(bw.model {mesh = box, material = bw.material.zp150},
      {force = 2, pressure = 2e5, modes = 3})).utilisation > 0)
    local grid = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.09, 0.01, 0.01}, cells = {18, 2, 2}})
    local corner = grid.nodes:gather(grid.elements:column(1))
    for k = 2, 4 do corner = corner + grid.nodes:gather(grid.elements:column(k)) end
    local two = assert(grid:subset((corner / 4):map [[a.x < 0.04 or a.x > 0.05]]))
    assert.equal(2, two.component_count)
    assert.truthy(assert(bw.worst_case(bw.model {mesh = two, material = bw.material.pla},
      {force = 4, pressure = 2e5, modes = 4, targets = 8})).max_principal > 0)
  end)

  it("says what it maximises, and what it does not", function()
    assert.truthy(tostring(search):find "MPa at %(")
    local label = {mode = "^mode %d+, region %d+$", element = "^screening, element %d+$",
      ascent = "^ascent, element %d+$"}
    for _, region in ipairs(search.regions) do assert.truthy(region.label:find(label[region.origin])) end
    check.raises('method "search" maximises stress', bw.worst_case, part,
      {method = "search", target = "displacement"})
    check.raises("option 'method'", bw.worst_case, part, {method = "serch"})
    assert.equal("paper", analyse({target = "displacement"}).options.method)
    check.raises("results of worst_loads", bw.worst_loads, search.system, search.basis, search.weak_regions,
      {force = 10, pressure = 2e5, after = {}})
    check.raises("results of worst_loads for the same mesh", bw.worst_loads, search.system, search.basis,
      search.weak_regions, {force = 10, pressure = 2e5, after = {peaks = bw.array {1, 2}}})
  end)

  it("leaves files", function()
    local folder = check.folder()
    assert(search:write(folder .. "/w.vtu"))
    assert(search:picture(folder .. "/r.png", {region = #search.regions, width = 200, height = 150}))
    assert(search:report(folder .. "/w.html", {modes = 1, loads = 3}))
    assert.truthy(check.read(folder .. "/w.html"):find("screening, element", 1, true))
  end)
end)
