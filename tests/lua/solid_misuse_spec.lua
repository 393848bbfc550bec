-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Grids, solids, motions and libraries in careless and hostile hands: nothing crashes, hangs, leaks or
-- gives a wrong answer without a word.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local nan, inf = 0 / 0, math.huge

local function rubber(young, poisson, density)
  return bw.hyperelastic {young = young or 1e6, poisson = poisson or 0.3, density = density or 1000}
end

local function column(materials)
  local grid = assert(bw.grid.box {size = {0.1, 0.1, 0.2}, cells = {2, 2, 4}})
  return assert(bw.solid {grid = grid, materials = materials or {rubber()}})
end

local function standing(materials) return column(materials):fix {side = "min z"} end

local top = {side = "max z"}

-- A small library, fast to build.
local function small(more)
  local options = {directions = 20, magnitudes = 1, stretches = 20, voids = false, seed = 3}
  for key, value in pairs(more or {}) do options[key] = value end
  return options
end

local function two() return {rubber(1e5, 0.4), rubber(1e7, 0.4)} end

-- With this progress function, which is taken back.
local function showing(progress, f)
  bw.progress(progress)
  local ok, message = pcall(f)
  bw.progress(nil)
  if not ok then error(message, 0) end
end

describe("a grid", function()
  it("refuses sizes that make no cells", function()
    for _, bad in ipairs {0, -1, nan, inf, 1e9, "x", {}, {1, 2}} do
      assert.is_false(pcall(bw.grid.box, {size = 1, cells = bad}))
    end
    for _, bad in ipairs {0, -1, nan, inf} do
      assert.is_false(pcall(bw.grid.box, {size = bad, cells = 2}))
      assert.is_false(pcall(bw.grid.box, {size = 1, spacing = bad}))
      assert.is_false(pcall(bw.grid.box, {cells = 2, spacing = bad}))
    end
    check.raises("lost in rounding", bw.grid.box, {size = 1, cells = 2, min = {1e300, 0, 0}})
    check.raises("no number holds", bw.grid.box, {size = 1e-150, cells = 2})
    check.raises("at most 2^26 cells expected", bw.grid.box, {size = 1, cells = 1000})
  end)

  it("reports what a material function does wrong", function()
    local grid = assert(bw.grid.box {size = 1, cells = 2})
    for text, f in pairs {["whole numbers"] = function() return 1.5 end,
      ["a number expected as its result"] = function() return "a" end,
      ["oops"] = function() error "oops" end,
      ["engine is busy"] = function() return grid:set(1, 2).volume end} do
      check.raises(text, bw.grid.box, {size = 1, cells = 2, material = f})
      check.raises(text, grid.set, grid, {min = {0, 0, 0}}, f)
      check.raises(text == "whole numbers" and "no node" or text, grid.nodes, grid, text == "whole numbers"
        and function() return 0 end or f)
    end
    check.raises("no element", grid.set, grid, {}, 0)
    for _, bad in ipairs {0, 9, 1.5, {0}, {9}, {"a"}, {nan}} do
      assert.is_false(pcall(grid.set, grid, bad, 2))
    end
  end)

  it("of a surface has cells that can be counted", function()
    local sphere = bw.surface.sphere {radius = 1}
    check.fails("limit", "take larger cells", bw.grid.voxels(sphere, {spacing = 1e-9}))
    check.fails("geometry", "cells of 1e+09 m", bw.grid.voxels(sphere, {spacing = 1e9}))
    check.raises("multiples of 0", bw.grid.voxels, sphere, {cells = 8, multiple = 0})
    check.raises("got a list, whose order", bw.grid.voxels, sphere, {cells = 8, material = {1}})
  end)
end)

describe("what acts on a solid", function()
  it("is reported where it is made", function()
    local solid = column()
    for _, bad in ipairs {{0}, {46}, {nan}, {1.5}, {"x"}} do
      check.raises("a node from 1 to 45 expected", solid.fix, solid, bad)
    end
    check.raises("got an empty table", solid.fix, solid, {})
    local endless = setmetatable({}, {__len = function() return "3" end})
    check.raises("a table without a length", solid.fix, solid, endless)
    check.raises("a place expected", solid.force, solid, nil, {1, 0, 0})
    check.raises("no node lies", solid.force, solid, {min = {9, 9, 9}}, {1, 0, 0})
    check.raises("got {false, false, false}", solid.fix, solid, top, {false, false, false})
    for _, bad in ipairs {nan, inf, "1"} do
      check.raises("expected", solid.fix, solid, top, {bad, 0, 0})
      check.raises("expected", solid.force, solid, top, {bad, 0, 0})
      check.raises("expected", solid.gravity, solid, {bad, 0, 0})
      check.raises("expected", solid.pressure, solid, top, {pressure = bad})
      check.raises("expected", solid.contact_plane, solid, {point = {bad, 0, 0}, normal = {0, 0, 1}})
      check.raises("expected", solid.rotate, solid, top, {axis = {0, 0, 1}, angle = bad})
    end
    check.raises("got table: a list goes with a surface", solid.pressure, solid, top, {pressure = {1, 2}})
    check.raises("a direction expected, got {0, 0, 0}", solid.rotate, solid, top, {axis = {0, 0, 0}, angle = 1})
    assert.equal("solid: 16 elements, 45 nodes, 1 materials; 0 supports and loads", tostring(solid))
  end)

  it("may be a function, which is checked", function()
    for _, f in ipairs {function() end, function() return 1, 2 end, function() return nan, 0, 0 end} do
      check.raises("three finite numbers", function() standing():fix(top, f):solve() end)
    end
    local surface = assert(column().grid:surface())
    for _, f in ipairs {function() end, function() return "x" end, function() return nan end} do
      check.raises("finite number", function() standing():pressure(surface, {pressure = f}):solve() end)
      assert.is_false(pcall(function() standing():pressure(top, {pressure = f}):solve() end))
    end
    check.raises("80 rows expected, one for each triangle, got 1", function()
      standing():pressure(surface, {pressure = {1}}):solve()
    end)
    surface:close()
    check.raises("closed", function() standing():pressure(surface, {pressure = 1}) end)
    check.fails("geometry", "from the nearest element",
      standing():pressure(bw.surface.sphere {radius = 1}, {pressure = 1}):solve())
  end)

  it("presses on faces by place as evenly as on their surface in total", function()
    local by_place = assert(standing():pressure(top, {pressure = 3000}):solve())
    check.near(30, by_place:total_reaction({side = "min z"})[3], 1e-6)
    local corner = by_place.displacement:gather(by_place.grid:nodes(top)):column(3)
    assert.is_true(corner:max() < 0)
    local grown = assert(standing():pressure(top, {pressure = function(x) return 6e4 * x end,
      follower = true}):solve())
    check.near(30, grown:total_reaction({side = "min z"})[3], 1e-2)
  end)
end)

describe("a solid", function()
  it("is not solved with options that mean nothing", function()
    local solid = standing():force(top, {0, 0, 100})
    local jacobi, cholmod = bw.solver.jacobi(), bw.solver.cholesky {backend = "cholmod"}
    local pcg = bw.solver.pcg {preconditioner = cholmod}
    for key, list in pairs {tolerance = {0, -1, nan, inf, 1}, iterations = {0, -1, 1.5}, steps = {0, -1},
      max_iterations = {-1, 1.5, "x"}, min_step = {0, -1, 2},
      path = {0, -1, 1001}, solver = {"x", 5, jacobi, cholmod, pcg},
      start = {5, {}, {{1, 2, 3}}}, coarse = {5, {}, solid}} do
      for _, bad in ipairs(list) do
        local ok, message = pcall(solid.solve, solid, {[key] = bad})
        assert.is_false(ok, key .. " = " .. tostring(bad))
        assert.is_string(message)
      end
    end
    for _, bad in ipairs {jacobi, cholmod, pcg, bw.solver.cholesky {full = true}, bw.solver.lu(),
      bw.solver.cholesky {precision = 32}, bw.solver.pcg {preconditioner = bw.solver.amg()}} do
      check.raises("does not serve Newton's method: give cholesky", solid.solve, solid, {solver = bad})
      check.raises("does not serve Newton's method: give cholesky", solid.transient, solid, {solver = bad})
    end
    check.raises("steps in time have no two_level", solid.transient, solid, {solver = bw.solver.pcg()})
    check.raises("leave them out", solid.transient, solid,
      {solver = bw.solver.pcg {preconditioner = jacobi, max_iterations = 7}})
    check.raises("rotations of at most 30000 degrees expected", function()
      standing():rotate(top, {axis = {0, 0, 1}, angle = 1e9}):solve()
    end)
  end)

  it("says so where there is no equilibrium", function()
    for _, act in ipairs {
      function(s) return s:force(top, {0, 0, -1e30}) end,
      function(s) return s:force(top, {1e300, 0, 0}) end,
      function(s) return s:gravity {0, 0, -1e30} end,
      function(s) return s:pressure(top, {pressure = 1e30, follower = true}) end,
      function(s) return s:fix(top, {0, 0, 1e30}) end,
      function(s) return s:contact_plane {point = {0, 0, 0.2}, normal = {0, 0, -1}, move = {0, 0, -0.5}} end} do
      local result, message, details = act(standing()):solve {iterations = 15}
      assert.is_nil(result)
      assert.is_truthy(message:find("load factor", 1, true))
      assert.is_false(details.reached.complete)
    end
    check.fails("unconstrained", "along", column():contact_plane({point = {0, 0, 0}, normal = {0, 0, 1}}):gravity(
      {0, 0, -9.81}):solve())
    check.raises("needs the density", function()
      standing({bw.hyperelastic {young = 1, poisson = 0}}):gravity({0, 0, -1}):solve()
    end)
  end)

  it("finds the equilibria that there are in odd places", function()
    -- ten turns; a floor that the body crosses at first; nearly incompressible; auxetic
    local rotated = assert(standing():rotate(top, {axis = {0, 0, 1}, point = {0.05, 0.05, 0},
      angle = 3600}):solve())
    assert.equal(120, rotated.newton.load_steps)
    local pushed = assert(standing():contact_plane {point = {0, 0, 0.19}, normal = {0, 0, -1}}:solve())
    assert.is_true(pushed.displacement:gather(pushed.grid:nodes(top)):column(3):max() < -0.01 + 1e-9)
    for _, poisson in ipairs {0.4999, -0.5} do
      for _, law in ipairs {"neo_hookean", "corotated"} do
        local result = assert(standing({bw.hyperelastic {law = law, young = 1e6, poisson = poisson}}):force(
          top, {0, 0, 100}):solve())
        check.near(-100, result:total_reaction({side = "min z"})[3], 1e-5)
      end
    end
  end)

  it("outlives what it was made of", function()
    local solid, surface = standing(), column().grid:surface()
    solid:pressure(surface, {pressure = 1000})
    local result = assert(solid:solve())
    local displacement, stress = result.displacement, result.stress
    local before = displacement:norm()
    solid.body:close()
    solid.grid:close()
    solid = nil
    result = nil
    collectgarbage()
    collectgarbage()
    assert.equal(before, displacement:norm())
    assert.is_true(stress:norm() > 0 and solid == nil and result == nil)
    for _, object in ipairs {bw.grid.box {size = 1, cells = 1}, rubber(), column().materials,
      standing():transient {}} do
      object:close()
      assert.is_truthy(tostring(object):find("(closed)", 1, true))
    end
  end)

  it("is solved from coroutines, and stopped by progress", function()
    local run = coroutine.wrap(function()
      coroutine.yield(standing():force(top, {0, 0, 10}):solve())
    end)
    assert(run())
    local large = assert(bw.solid {grid = assert(bw.grid.box {size = 0.1, cells = 12}), materials = {rubber()}})
    large:fix({side = "min z"}):rotate(top, {axis = {0, 0, 1}, angle = 170})
    showing(function() return false end, function()
      check.fails("cancelled", "", large:solve())
    end)
    showing(function() error "enough" end, function() check.raises("enough", large.solve, large) end)
    showing(function() return #large.grid:nodes(top) > 0 end, function()
      check.raises("engine is busy", large.solve, large)
    end)
  end)
end)

describe("a motion", function()
  it("refuses what no motion has", function()
    for key, list in pairs {step = {0, -1, nan, 1e-300, 1e300}, tolerance = {0, nan}, iterations = {0},
      mass_damping = {-1, nan}, stiffness_damping = {-1}, scheme = {"x", 1}, solver = {"coarse", bw.solver.pcg(),
        bw.solver.pcg {preconditioner = bw.solver.jacobi(), tolerance = 1e-3}},
      displacement = {5, {}}, velocity = {{{1, 2, 3}}}} do
      for _, bad in ipairs(list) do
        local solid = standing()
        assert.is_false(pcall(solid.transient, solid, {[key] = bad}), key .. " = " .. tostring(bad))
      end
    end
    check.raises("a table of options", function() standing():transient(5) end)
    check.raises("density", function() standing({bw.hyperelastic {young = 1, poisson = 0}}):transient() end)
    local motion = assert(standing():transient())
    check.raises("of at least 0 expected", motion.step, motion, -1)
  end)

  it("that cannot be is reported, and stays as it was", function()
    local fast = {}
    for i = 1, 45 do fast[i] = {1e30, 0, 0} end
    local motion = assert(standing():transient {velocity = fast})
    local before = motion.kinetic
    check.fails("convergence", "the step from 0 s", motion:step())
    assert.equal(before, motion.kinetic)
    assert.equal(0, motion.steps)
  end)
end)

describe("a library", function()
  it("is not built from options that mean nothing", function()
    for key, list in pairs {levels = {-1, 3}, directions = {0, 10 ^ 9 // 1}, magnitudes = {0}, stretches = {-1},
      fibres = {-1, 4}, strain = {0, -1, nan, 1e30, 1e-30}, ridge = {-1, nan}, representatives = {0},
      seed = {1.5}, checkpoint = {5}} do
      for _, bad in ipairs(list) do
        assert.is_false(pcall(bw.metamaterial.build, {rubber()}, small {[key] = bad}), key)
      end
    end
    local many = {}
    for i = 1, 8 do many[i] = rubber(i * 1e5) end
    check.fails("limit", "up to 7 materials", bw.metamaterial.build(many, small()))
    for _, path in ipairs {"/nowhere/c", "/dev/full", check.folder()} do
      check.fails("io", path, bw.metamaterial.build({rubber()}, small {checkpoint = path}))
    end
  end)

  it("stops, carries on, and refuses another's checkpoint", function()
    local checkpoint = check.folder() .. "/checkpoint"
    local calls = 0
    showing(function()
      calls = calls + 1
      return calls < 2
    end, function()
      local library, _, details = bw.metamaterial.build(two(), small {checkpoint = checkpoint})
      assert.is_true(library ~= nil or details.status == "cancelled")
    end)
    local first = assert(bw.metamaterial.build(two(), small {checkpoint = checkpoint}))
    local again = assert(bw.metamaterial.build(two(), small()))
    local folder = check.folder()
    assert(first:write(folder .. "/a.bwm") and again:write(folder .. "/b.bwm"))
    local text = check.read(folder .. "/a.bwm")
    assert.equal(text, check.read(folder .. "/b.bwm"))
    check.raises("another library", bw.metamaterial.build, two(), small {checkpoint = checkpoint, strain = 0.2})
    -- damaged anywhere: what is left of it counts, the library is the same
    local kept = check.read(checkpoint)
    for _, at in ipairs {#kept // 3, #kept - 1} do
      check.write(checkpoint, kept:sub(1, at) .. string.char(kept:byte(at + 1) ~ 64) .. kept:sub(at + 2))
      assert(assert(bw.metamaterial.build(two(), small {checkpoint = checkpoint})):write(folder .. "/b.bwm"))
      assert.equal(text, check.read(folder .. "/b.bwm"))
    end
    -- files: cut, flipped, longer, a folder, nowhere to write
    local path = folder .. "/c.bwm"
    for at = 0, #text - 1, #text // 40 do
      check.write(path, text:sub(1, at))
      check.fails("format", "c.bwm", bw.metamaterial.read(path))
      check.write(path, text:sub(1, at) .. string.char(text:byte(at + 1) ~ 4) .. text:sub(at + 2))
      check.fails("format", "c.bwm", bw.metamaterial.read(path))
    end
    check.write(path, text .. "x")
    check.fails("format", "follow the end", bw.metamaterial.read(path))
    check.fails("io", "directory", bw.metamaterial.read(folder))
    check.fails("io", "No space", first:write "/dev/full")
    check.fails("io", "cannot write", first:write "/nowhere/x.bwm")
    check.raises("zero bytes", first.write, first, folder .. "/x\0.bwm")
    -- keys and coarsening
    for _, key in ipairs {{1, 1, 1, 1, 1, 1, 1, 3}, {1, 1, 1, 1, 1, 1, 1, -1}, {1, 1, 1, 1, 1, 1, 1, 2 ^ 32 + 1},
      {0, 0, 0, 0, 0, 0, 0, 0}, {1, 2}, {1, 1, 1, 1, 1, 1, 1, nan}} do
      assert.is_false(pcall(first.material, first, key))
    end
    local grid = assert(bw.grid.box {size = {0.04, 0.04, 0.08}, cells = {2, 2, 4}})
    local solid = assert(bw.solid {grid = grid, materials = two()})
    check.raises("coarsening by 2 levels", solid.coarsen, solid, first, 2)
    check.raises("1 or 2 levels", solid.coarsen, solid, first, 2 ^ 32 + 1)
    local other = assert(bw.solid {grid = grid, materials = {rubber(1e7, 0.4), rubber(1e5, 0.4)}})
    check.raises("the material table it was built of", other.coarsen, other, first)
    local coarse = assert(solid:coarsen(first))
    first:close()
    check.raises("closed", solid.coarsen, solid, first)
    collectgarbage()
    assert(coarse:with(assert(grid:set(1, 2))))
  end)
end)

describe("memory", function()
  it("holds nothing afterwards, and a lack of it is reported", function()
    local function work()
      local solid = standing()
      solid:force(top, {0, 0, 10}):pressure({side = "max x"}, {pressure = 10, follower = true})
      local made, message, details = solid:coarsen("naive", 1)
      if not made then return nil, message, details end
      return solid:solve()
    end
    assert(work())
    collectgarbage()
    collectgarbage()
    local _, before = core.external()
    local failures, n = 0, 1
    local step = os.getenv "BARWRIGHT_FULL" and 1 or 13
    while true do
      core.fail_allocation(n, true)
      local ok, result, message, details = pcall(work)
      core.fail_allocation(0, false)
      if ok and result then break end
      failures = failures + 1
      if ok then assert.equal("memory", details.status, message) end
      result, details = nil, nil -- luacheck: ignore 311
      collectgarbage()
      collectgarbage()
      local _, blocks = core.external()
      assert.equal(before, blocks, "blocks after failure " .. n)
      n = n + step
      assert(n < 100000)
    end
    assert.is_true(failures > 5)
  end)
end)
