-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
local bw = require "barwright"
local check = require "check"

-- A dumb-bell: a thin neck between two blocks, so that there is no doubt where it breaks.
local function dumb_bell()
  local grid = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.09, 0.03, 0.03}, cells = {18, 6, 6}})
  local centres = grid.nodes:gather(grid.elements:column(1)) -- one corner of each is enough
  for corner = 2, 4 do centres = centres + grid.nodes:gather(grid.elements:column(corner)) end
  local keep = (centres / 4):map [[a.x < 0.03 or a.x > 0.06 or
    (a.y > 0.01 and a.y < 0.02 and a.z > 0.01 and a.z < 0.02)]]
  return assert(grid:subset(keep))
end

describe("the worst case", function()
  local mesh = dumb_bell()
  local part = bw.model {mesh = mesh, material = bw.material.zp150}
  local worst = assert(bw.worst_case(part, {force = 5, pressure = 2e5, modes = 6, regions = 3}))

  it("breaks in the neck", function()
    assert.truthy(worst.at[1] > 0.025 and worst.at[1] < 0.065)
    assert.truthy(tostring(worst):find "MPa at %(")
    assert.truthy(tostring(worst):find "of the strength; error unknown: one mesh$")
    assert.equal(worst.max_principal, worst.regions[worst.region].max_principal)
    assert.truthy(worst.utilisation > 0)
    local max = 0
    for _, region in ipairs(worst.regions) do max = math.max(max, region.utilisation) end
    assert.equal(max, worst.utilisation)
  end)

  it("finds loads that keep their limits and are in balance", function()
    for i = 1, #worst.regions do
      local p = worst.pressures[i]
      assert.truthy(p:min() >= -1e-6 and p:max() <= 2e5 * (1 + 1e-9))
      check.near(5, p:dot(worst.basis.areas), 1e-6)
      local f = worst:force(i):column_sums()
      for k = 1, 3 do assert.truthy(math.abs(f[k]) < 1e-6) end
    end
  end)

  it("reproduces its stress from the pressure", function()
    local stress = bw.max_principal(assert(worst:stress()))
    check.near(worst.max_principal, stress:max(), 1e-6)
    assert.equal(worst.element, (stress:argmax()))
    assert.truthy((worst.weakness - stress):min() > -1e-6 * worst.max_principal)
    check.near(worst.weakness:max(), worst:surface_weakness():max(), 0.5)
  end)

  it("sums the load into arrows", function()
    local sum = {0, 0, 0}
    local arrows = worst:arrows()
    assert.truthy(#arrows >= 2)
    for _, arrow in ipairs(arrows) do
      for k = 1, 3 do sum[k] = sum[k] + arrow.force[k] end
    end
    for k = 1, 3 do assert.truthy(math.abs(sum[k]) < 1e-6) end
  end)

  it("gives the same bits on one thread and for any order of asking", function()
    local threads = bw.threads()
    bw.threads(threads == 1 and 2 or 1)
    local again = assert(bw.worst_case(bw.model {mesh = mesh, material = bw.material.zp150},
      {force = 5, pressure = 2e5, modes = 6, regions = 3}))
    bw.threads(threads)
    assert.equal(worst.weakness:tostring "<f8", again.weakness:tostring "<f8")
    assert.equal(worst.pressures:tostring "<f8", again.pressures:tostring "<f8")
  end)

  it("has other measures, targets and modes", function()
    local base = {force = 5, pressure = 2e5, modes = 3, regions = 2}
    local function with(key, value)
      local opts = {[key] = value}
      for k, v in pairs(base) do opts[k] = v end
      return assert(bw.worst_case(part, opts))
    end
    assert.truthy(with("measure", "energy").max_principal > 0.3 * worst.max_principal)
    local moved = with("target", "displacement")
    assert.truthy(moved.max_displacement > 0)
    assert.truthy(tostring(moved):find "mm of displacement")
    assert.truthy(with("laplacian", true).max_principal > 0.2 * worst.max_principal)
    assert.truthy(with("force_is_max", true).max_principal > 0.99 * with("force_is_max", false).max_principal)
  end)

  it("can be taken step by step, and no sampled load beats the linear program", function()
    local system, basis, regions = worst.system, worst.basis, worst.weak_regions
    local q = assert(system:solve(assert(regions:objective(1, part.material))))
    local objective = basis:gradient(q)
    local limits = {pressure = 2e5, force = 5}
    local p, value = assert(basis:maximise(system, objective, limits))
    check.near(value, p:dot(objective), 1e-9)
    for i = 1, #worst.regions do -- other regions' loads are allowed too
      assert.truthy(worst.pressures[i]:dot(objective) <= value * (1 + 1e-7))
    end
    -- the objective is the weighted stress of the region: work of the region's forces on the answer
    local u = assert(system:solve(basis:force(p)))
    check.near(value, regions:objective(1, part.material):dot(u), 1e-6)
    check.fails("infeasible", "", basis:maximise(system, objective, {pressure = 1, force = 1e9}))
    check.raises("give 'length' as well", bw.worst_case, part, {failure = "von_mises"})
    check.raises("places of another worst case", bw.worst_case, part, {length = 0.01, places = {1}})
    check.raises("can be false where 'places' are given", bw.worst_case, part, {length = 0.01, screening = false})
    check.raises("rows expected, one for each column", basis.maximise, basis, system, bw.array {1}, limits)
    check.near(mesh.volume, mesh.volumes:sum(), 1e-12)
    check.near(mesh.volume, mesh.node_volumes:sum(), 1e-12)
    local singles = assert(bw.single_regions(mesh, {3, 5}))
    assert.equal(2, #singles)
    assert.equal(5, singles:elements(2)[1])
    assert.equal(1, bw.worst_loads(system, bw.pressure_basis(mesh), assert(bw.weak_regions(mesh,
      part.material, worst.modes, {regions = 1})), limits).peaks.column_count)
  end)

  it("stays near brute force, and drops agree with it", function()
    local brute = assert(bw.brute_force(part, {force = 5, pressure = 2e5, elements = 150}))
    local beside = brute:compare(worst)
    assert.truthy(beside.ratio > 0.8, beside.ratio)
    assert.equal(150, brute.elements)
    assert.truthy(tostring(brute):find "150 elements.*; error unknown: one mesh$")
    local drops = assert(bw.drop_test(part, {drops = 200, seed = 3}))
    assert.equal(200, drops.drops)
    assert.truthy(drops:correlation(worst) > 0.3, drops:correlation(worst))
    assert.equal(drops.mean_peak:tostring "<f8",
      assert(bw.drop_test(part, {drops = 200, seed = 3})).mean_peak:tostring "<f8")
    local folder = check.folder()
    assert(drops:write(folder .. "/d.vtu"))
    assert(drops:picture(folder .. "/d.png", {width = 300, height = 200}))
  end)

  it("is found on cubes that are symmetric but for rounding", function()
    local box = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.1, 0.1}, cells = {3, 3, 3}}
    local element, stress = {}, nil
    for e = 1, #box.elements do element[e] = {table.unpack(box.elements[e], 1, 4)} end
    for _, noise in ipairs {0, 1e-12, 1e-10, 1e-9, 3e-9, 1e-8, 1e-7} do
      math.randomseed(3)
      local node = {}
      for i = 1, #box.nodes do
        node[i] = {}
        for c = 1, 3 do node[i][c] = box.nodes[i][c] + 0.1 * noise * (math.random() - 0.5) end
      end
      local cube = bw.model {mesh = bw.mesh.new {nodes = node, elements = element}, material = bw.material.pla}
      for _, friction in ipairs {0, 0.3} do -- a bound for each node, and one for its directions
        local found = assert(bw.worst_case(cube, {force = 1, pressure = 1e6, method = "paper",
          friction = friction > 0 and friction or nil}))
        if friction == 0 then
          stress = stress or found.max_principal
          check.near(stress, found.max_principal, 1e-6)
        end
      end
    end
  end)

  it("leaves files", function()
    local folder = check.folder()
    assert(worst:write(folder .. "/w.vtu"))
    local _, file = assert(bw.mesh.read(folder .. "/w.vtu"))
    assert.equal(worst.weakness:tostring "<f8", file.fields.weakness:tostring "<f8")
    assert(worst:picture(folder .. "/w.png", {width = 300, height = 200}))
    assert(worst:picture(folder .. "/r.png", {region = 1, width = 300, height = 200}))
    assert(worst:report(folder .. "/w.html", {title = "A <dumb> bell", modes = 2, loads = 2}))
    local page = check.read(folder .. "/w.html")
    assert.truthy(page:find("A &lt;dumb&gt; bell", 1, true))
    assert.is_nil(page:find "{{%l+}}")
    local data = assert(bw.json.decode(page:match '<script type="application/json" id="data">(.-)</script>'))
    assert.equal(4, #data.displacements)
    assert.equal("load", data.displacements[1].kind)
    assert.equal("mode", data.displacements[3].kind)
    assert.equal(#data.displacements[1].values % 4, 0)
    check.raises("did you mean 'title'", worst.report, worst, folder .. "/x.html", {titel = "x"})
  end)

  it("says what is in the way", function()
    -- full pressure everywhere pushes with less than this
    check.fails("infeasible", "", bw.worst_case(part, {force = 1e6, pressure = 1e3, modes = 2}))
    check.raises("unknown option 'preasure': did you mean 'pressure'?", bw.worst_case, part,
      {preasure = 1})
    check.raises("option 'modes': a whole number expected", bw.worst_case, part, {modes = 2.5})
    check.raises("option 'modes': a whole number of at least 1", bw.worst_case, part, {modes = 0})
    check.raises("option 'force': a number above 0 expected, got -1", bw.worst_case, part, {force = -1})
    check.raises("did you mean 'stress'", bw.worst_case, part, {measure = "stres"})
    check.raises("part: a model expected, got mesh", bw.worst_case, mesh)
    check.raises("a region from 1 to", worst.pressure, worst, 99)
  end)

  it("can be closed", function()
    local one = assert(bw.worst_case(part, {force = 5, pressure = 2e5, modes = 1, regions = 1}))
    one:close()
    assert.equal("worst case (closed)", tostring(one))
  end)
end)
