-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The experiments of data-driven, end to end on the two smallest scenes, with a small library.
local bw = require "barwright"
local check = require "check"

local folder = check.folder()
local library = folder .. "/small.bwm"
local script = "scripts/data_driven/run.lua"

local function row_of(result, method, level)
  for _, row in ipairs(result.rows) do
    if row.method == method and row.level == level then return row end
  end
end

describe("the experiments of data-driven", function()
  setup(function()
    local materials = {}
    for i, name in ipairs {"soft", "medium", "hard"} do
      materials[i] = bw.hyperelastic {name = name, young = 10 ^ (4 + i), poisson = 0.45, density = 1000}
    end
    local made = assert(bw.metamaterial.build(materials, {voids = false, directions = 8, magnitudes = 1,
      stretches = 20}))
    assert(made:write(library))
  end)

  it("bend and twist bars of layers: at most the paper's errors, far below naive", function()
    local code, said, complaint = check.run(("%s --scene bending,twisting --out %s/out --library %s "
      .. "--methods lookup,naive --levels 1"):format(script, folder, library))
    assert.message(complaint).are.equal(0, code)
    assert.is_truthy(said:find("times faster", 1, true))
    for name, paper in pairs {bending = 5.6e-2, twisting = 1.56e-2} do
      local result = assert(bw.json.decode(check.read(("%s/out/%s/result.json"):format(folder, name))))
      assert.is_true(result.finished)
      assert.equal(paper, result.paper.level_1.error)
      local lookup, naive = row_of(result, "lookup", 1), row_of(result, "naive", 1)
      assert.equal(256, lookup.elements)
      assert.is_true(lookup.error <= paper, name .. ": " .. lookup.error)
      assert.is_true(3 * lookup.error <= naive.error)
      assert.is_true(lookup.speed_up > 1)
      assert.is_nil(row_of(result, "lookup", 2))
      for _, file in ipairs {"manifest.json", "report.html", "rest.png", "shapes.png"} do
        assert.is_true(#check.read(("%s/out/%s/%s"):format(folder, name, file)) > 500)
      end
    end
    local page = check.read(folder .. "/out/report.html")
    assert.is_truthy(page:find("twisting, lookup 1", 1, true))
    assert.is_truthy(page:find("quadrature / whole", 1, true))
    assert.is_falsy(page:find "https?://")
  end)

  it("grow a library for a scene of their own", function()
    local code, said, complaint = check.run(("%s --scene bending --out %s/grown --library %s "
      .. "--methods grown,naive"):format(script, folder, library))
    assert.message(complaint).are.equal(0, code)
    assert.is_truthy(said:find("grown for its grid: 3 blocks", 1, true))
    local result = assert(bw.json.decode(check.read(folder .. "/grown/bending/result.json")))
    assert.equal(3, result.growing.blocks) -- layers of three materials; level 1 is in the library
    local grown, naive = row_of(result, "grown", 2), row_of(result, "naive", 2)
    assert.is_true(3 * grown.error <= naive.error, grown.error)
    assert.is_nil(row_of(result, "grown", 1))
    assert.is_truthy(check.read(folder .. "/grown/report.html"):find("bending, grown 2", 1, true))
  end)

  it("tell of random test geometries", function()
    local code, said, complaint = check.run(("scripts/data_driven/blind.lua --bodies 1 --directions 4 "
      .. "--json %s/blind.json"):format(folder))
    assert.message(complaint).are.equal(0, code)
    assert.is_truthy(said:find("of grown, level 2: median", 1, true))
    local reported = assert(bw.json.decode(check.read(folder .. "/blind.json")))
    assert.equal(2, #reported.rows)
    assert.is_true(reported.rows[1].grown < reported.rows[1].naive)
    code, said, complaint = check.run "scripts/data_driven/blind.lua --bodies many"
    assert.equal(2, code)
    assert.equal("", said)
    assert.is_truthy(complaint:find("option --bodies: a whole number from 1 expected, got 'many'", 1, true))
  end)

  it("tell what a coarse grid can do at best", function()
    local code, said, complaint = check.run(("scripts/data_driven/bound.lua --scene twisting --levels 1 "
      .. "--methods naive,lookup --library %s --json %s/bound.json"):format(library, folder))
    assert.message(complaint).are.equal(0, code)
    assert.is_truthy(said:find("best", 1, true))
    local row = assert(bw.json.decode(check.read(folder .. "/bound.json"))).rows[1]
    local naive, lookup = row.methods.naive, row.methods.lookup
    assert.is_true(row.best < lookup.error and 3 * lookup.error < naive.error)
    assert.is_true(naive.factor > 2 and math.abs(lookup.factor - 1) < 0.1)
    assert.is_true(naive.after_factor < naive.error)
    for words, reported in pairs {["--scene twistin"] = "did you mean 'twisting'?",
      ["--scene twisting --methods naive,lokup"] = "one of naive, lookup, grown expected, got 'lokup'"} do
      code, said, complaint = check.run("scripts/data_driven/bound.lua " .. words)
      assert.equal(2, code)
      assert.equal("", said)
      assert.truthy(complaint:find(reported, 1, true), complaint)
    end
  end)

  it("refuse what they do not know", function()
    for _, each in ipairs {
      {"--scene bendin --out x", "did you mean 'bending'"},
      {"--scene bending --out x --method naive", "did you mean --methods?"},
      {"--scene bending --out x --methods lookup,guess",
        "one of lookup, grown, naive, average expected, got 'guess'"},
      {"--scene bending --out x --levels 3", "a whole number from 1 up to 2 expected, got '3'"},
      {"--scene bending", "option --out DIR is missing"},
      {"--scene bending --out", "a value is missing (DIR)"},
      {"--scene bending --out " .. folder .. "/x --library " .. script, "run.lua"},
    } do
      local code, _, complaint = check.run(script .. " " .. each[1])
      assert.message(each[1] .. ": " .. complaint).are.equal(2, code)
      assert.message(complaint).is_truthy(complaint:find(each[2], 1, true))
      assert.equal(1, select(2, complaint:gsub("\n", "")))
    end
  end)
end)

describe("an equilibrium", function()
  it("reports how far nodes went, and draws it", function()
    local grid = assert(bw.grid.box {size = 0.1, cells = 2})
    local solid = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e6, poisson = 0.3}}})
    solid:fix({side = "min z"}):fix({side = "max z"}, {0.003, 0, 0.004})
    local result = assert(solid:solve())
    check.near(0.005, result.movement:max(), 1e-12)
    local panel = result:panel("moved", "movement")
    assert.equal("moved", panel.title)
    assert.equal(grid, panel.grid)
    assert(bw.grid.picture(folder .. "/panel.png", {panel, result:panel("materials")}))
    assert(result:picture(folder .. "/one.png", {values = "von_mises"}))
    check.raises([["von_mises", "movement" or an array expected]], function()
      result:picture(folder .. "/x.png", {values = "stress"})
    end)
  end)
end)

describe("the best field of a coarse grid", function()
  local best = assert(loadfile "scripts/data_driven/best.lua")()
  local grid = assert(bw.grid.box {size = 0.4, cells = 4})
  local function coarse_of(by)
    local solid = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e6, poisson = 0.3}}})
    return assert(solid:fix({side = "min z"}, by):coarsen("naive", 1))
  end
  local points = grid.points
  local u = bw.array.map("b*p.x*p.z", {b = bw.array.new {{0.1, 0.2, -0.3}}:gather(
    bw.array.zeros(#points, 1, "i32") + 1), p = points})

  it("is a trilinear field itself", function()
    assert.is_true(grid:difference(best.of(grid, coarse_of {0, 0, 0}, u), u) < 1e-9)
  end)

  it("keeps what is fixed, and has the least mean distance", function()
    local field = best.of(grid, coarse_of {0, 0, 0.01}, u)
    local low = grid:nodes {side = "min z"}
    check.near(0.01, field:gather(low):column(3):min(), 1e-15)
    check.near(0.01, field:gather(low):column(3):max(), 1e-15)
    assert.is_true(grid:difference(field, u) < grid:difference(best.of(grid, coarse_of {0, 0, 0.02}, u), u))
  end)

  it("has factors for the whole and for each axis", function()
    check.near(0.5, best.factor(u * 2, u), 1e-15)
    local times = best.factors(best.times(u, {2, 4, 5}), u)
    for c, each in ipairs {0.5, 0.25, 0.2} do check.near(each, times[c], 1e-15) end
  end)
end)
