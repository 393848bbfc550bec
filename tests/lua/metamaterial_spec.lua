-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Libraries of metamaterials from Lua: building, files, lookup, coarse solids beside fine ones.
local bw = require "barwright"
local check = require "check"

local function materials()
  return {bw.hyperelastic {young = 1e5, poisson = 0.4, name = "soft"},
    bw.hyperelastic {young = 1e7, poisson = 0.4, name = "hard"}}
end

-- A small one, made once.
local library
local function small()
  library = library or assert(bw.metamaterial.build(materials(), {directions = 40, magnitudes = 2,
    stretches = 40, voids = false, seed = 3}))
  return library
end

-- Layers of one cell, pulled across: what a coarse cell must learn.
local function layered()
  local grid = assert(bw.grid.box {size = {0.08, 0.16, 0.08}, cells = {4, 8, 4},
    material = function(_, y) return y // 0.02 % 2 + 1 end})
  local solid = assert(bw.solid {grid = grid, materials = materials()})
  solid:fix {side = "min y"}
  return solid:force({side = "max y"}, {0, 120, 0})
end

describe("a library", function()
  it("is built, printed, written and read again", function()
    local made = small()
    assert.equal(1, made.levels)
    assert.equal(22, #made.errors[1]) -- two colours of the cube's corners, up to its symmetries
    assert.is_truthy(tostring(made):find("soft", 1, true))
    local path = check.folder() .. "/two.bwm"
    assert(made:write(path))
    local again = assert(bw.metamaterial.read(path))
    -- how long it took is not in the file
    assert.equal((tostring(made):gsub("built in [^;]*; ", "")), tostring(again))
    local key = {1, 1, 2, 1, 2, 2, 1, 2}
    local a, fit = made:material(key)
    local b = again:material(key)
    assert.same(a.mu:totable(), b.mu:totable())
    assert.is_true(fit >= 1 and fit <= 22)
    check.write(path, "no library at all")
    check.fails("format", "no library file", bw.metamaterial.read(path))
    check.raises("key: 8 materials expected", made.material, made, {1, 2})
  end)

  it("coarsens: far nearer to the fine solution than without", function()
    local fine = layered()
    local reference = assert(fine:solve())
    local coarse = assert(fine:coarsen(small()))
    local error = assert(coarse:solve()):error(reference)
    local naive = assert(assert(fine:coarsen "naive"):solve()):error(reference)
    assert.is_true(error < naive / 3, error .. " against " .. naive)
  end)

  it("follows an edit by looking up what differs", function()
    local fine = layered()
    local coarse = assert(fine:coarsen(small()))
    local grid = assert(fine.grid:set({max = {0.08, 0.04, 0.08}}, 2))
    local followed = assert(coarse:with(grid))
    assert.equal(4, followed.coarse.looked_up)
    local scratch = assert(assert(fine:with(grid)):coarsen(small()))
    assert.equal(0, assert(followed:solve()):error(assert(scratch:solve())))
  end)

  it("stops growing within one fit of very many samples", function()
    local reports = 0
    bw.progress(function()
      reports = reports + 1
      return reports < 10
    end)
    check.fails("cancelled", "", bw.metamaterial.grow(materials(), layered().grid, {directions = 1000000}))
    bw.progress(nil)
  end)

  it("is grown for a grid: of a material table, and further", function()
    local fine = layered()
    local grown = assert(bw.metamaterial.grow(materials(), fine.grid, {levels = 2, directions = 40,
      magnitudes = 2, seed = 3}))
    assert.equal(2, grown.levels)
    assert.same({1, 1}, grown.grown)
    local reference = assert(fine:solve())
    for level = 1, 2 do
      local error = assert(assert(fine:coarsen(grown, level)):solve()):error(reference)
      local naive = assert(assert(fine:coarsen("naive", level)):solve()):error(reference)
      assert.is_true(error < naive / 3, error .. " against " .. naive)
    end
    local path = check.folder() .. "/grown.bwm"
    assert(grown:write(path))
    assert.same({1, 1}, assert(bw.metamaterial.read(path)).grown)
    assert.is_truthy(tostring(grown):find("1 fits of blocks of grids it was grown for", 1, true))
    -- an edit brings blocks that are naive until they are grown
    local grid = assert(fine.grid:set({max = {0.08, 0.02, 0.08}}, 2))
    local key = {2, 2, 2, 2, 2, 2, 2, 2}
    assert.equal(0, select(2, grown:material(key)))
    local further = assert(bw.metamaterial.grow(grown, grid))
    assert.same({2, 1}, further.grown)
    assert.is_true(select(2, further:material(key)) > 0)
    assert.is_true(assert(bw.metamaterial.grow(small(), fine.grid)).grown[1] == 0)
    check.raises("1 or 2", bw.metamaterial.grow, materials(), grid, {levels = 3})
    check.raises("did you mean 'levels'", bw.metamaterial.grow, grown, grid, {level = 3})
    check.raises("grid", bw.metamaterial.grow, grown, 3)
  end)

  -- Hard rods along a soft bar, in a third of the columns, pressed: gradients of strain make blocks of them too
  -- soft, and the coarse bar buckles under what the fine one carries.
  local function pressed_rods()
    local seed, column = 7, {}
    for k = 0, 35 do
      seed = (seed * 1103515245 + 12345) % 2147483648
      column[k] = seed / 2147483648 < 0.3 and 2 or 1
    end
    local grid = assert(bw.grid.box {cells = {6, 12, 6}, spacing = 0.01,
      material = function(x, _, z) return column[6 * math.floor(x / 0.01) + math.floor(z / 0.01)] end})
    local solid = assert(bw.solid {grid = grid, materials = materials()}):fix {side = "min y"}
    return solid:fix({side = "max y"}, {0, -0.006, 0}),
      assert(bw.metamaterial.grow(materials(), grid, {directions = 10}))
  end

  it("estimates its error, and is replaced by the naive one where that is nearer", function()
    local function check_choice(fine, made, expected)
      local reference = assert(fine:solve())
      local error = {}
      for name, by in pairs {library = made, naive = "naive"} do
        local result = assert(assert(fine:coarsen(by)):solve {choose = false})
        assert.is_nil(result.choice)
        error[name] = result:error(reference)
        local estimated, of_size, corrected = result:estimate_error()
        assert.equal(estimated, result.estimated_error)
        assert.is_true(estimated > 0.5 * error[name] and estimated < 1.5 * error[name])
        assert.is_true(of_size > 0 and of_size < estimated)
        -- what it was corrected to is nearer to the fine solution
        assert.is_true(fine.grid:difference(corrected, reference.displacement)
          < 0.5 * fine.grid:difference(result.fine_displacement, reference.displacement))
      end
      local best, how = fine:solve_coarse {by = made}
      assert.equal(how, best.choice)
      assert.equal(expected, how.chosen)
      check.near(math.min(error.library, error.naive), (best:error(reference)), 1e-9)
      assert.equal(math.min(how.library, how.naive), best.estimated_error)
      return error
    end
    local fine, grown = pressed_rods()
    local error = check_choice(fine, grown, "naive")
    assert.is_true(error.library > 3 * error.naive)
    error = check_choice(layered(), small(), "library")
    assert.is_true(error.naive > 3 * error.library)
  end)

  -- A bar of soft cells with hard ones, fixed below, under a force or a displacement of its upper end.
  local function bar(material, load)
    local grid = assert(bw.grid.box {cells = {4, 10, 4}, spacing = 0.01, material = material})
    local solid = assert(bw.solid {grid = grid, materials = materials()}):fix {side = "min y"}
    local across, value = load[2], load[3]
    return solid[load[1]](solid, {side = "max y"}, across and {value, 0, 0} or {0, value, 0})
  end

  it("never answers worse than the naive solid where the estimate tells the two apart", function()
    local seed = 5
    local function drawn()
      seed = (seed * 1103515245 + 12345) % 2147483648
      return seed / 2147483648
    end
    local mixture = {}
    for i = 1, 160 do mixture[i] = drawn() < 0.4 and 2 or 1 end
    local layouts = {
      rods = function(x, _, z) return x // 0.01 % 3 == 1 and z // 0.01 % 3 == 1 and 2 or 1 end,
      mixture = function(x, y, z)
        return mixture[math.floor(1 + x // 0.01 + 4 * (y // 0.01) + 40 * (z // 0.01))]
      end,
    }
    local loads = {pull = {"force", false, 2}, bend = {"force", true, 0.02}, press = {"fix", false, -0.004},
      shear = {"fix", true, 0.01}}
    local chosen = {library = 0, naive = 0}
    for _, material in pairs(layouts) do
      local made = assert(bw.metamaterial.grow(materials(), bar(material, loads.pull).grid, {directions = 10}))
      for name, load in pairs(loads) do
        local fine = bar(material, load)
        local reference = assert(fine:solve())
        local best = assert(assert(fine:coarsen(made)):solve())
        local naive = assert(assert(fine:coarsen "naive"):solve())
        local choice = best.choice
        chosen[choice.chosen] = chosen[choice.chosen] + 1
        assert.equal(math.min(choice.library, choice.naive), best.estimated_error)
        assert.is_true((best:error(reference)) <= 1.05 * naive:error(reference), name)
      end
    end
    assert.is_true(chosen.library > 0 and chosen.naive > 0)
  end)

  it("follows an edit and chooses again; answers by itself where it is asked to", function()
    local fine, made = pressed_rods()
    local coarse = assert(fine:coarsen(made))
    assert.equal("naive", assert(coarse:solve()).choice.chosen)
    local edited = assert(coarse:with(assert(fine.grid:set({max = {0.02, 0.02, 0.02}}, 2))))
    assert.equal("naive", assert(edited:solve()).choice.chosen)
    local itself = assert(coarse:solve {choose = false})
    assert.equal(coarse, itself.solid)
    assert.is_nil(assert(assert(fine:coarsen "naive"):solve()).choice)
    check.raises("option 'choose'", coarse.solve, coarse, {choose = 1})
  end)

  it("has an error to estimate only where it is coarse", function()
    local fine = layered()
    local message, details = select(2, assert(fine:solve()):estimate_error())
    assert.is_truthy(message:find("a result of a coarse solid expected", 1, true))
    assert.equal("unsupported", details.status)
    check.raises("by", fine.solve_coarse, fine, {})
    check.raises("did you mean 'tolerance'", fine.solve_coarse, fine, {by = small(), tolerence = 1})
  end)

  it("refuses another material table", function()
    local grid = assert(bw.grid.box {size = 1, cells = 4})
    local solid = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 3, poisson = 0.1}}})
    check.raises("material table", solid.coarsen, solid, small())
    check.raises("did you mean 'strain'", bw.metamaterial.build, materials(), {strian = 1})
  end)
end)
