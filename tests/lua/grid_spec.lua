-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Grids: making, edits, choosing by geometry, coarse counterparts, embedding, files, refusals.
local bw = require "barwright"
local check = require "check"

local function block(material)
  return assert(bw.grid.box {size = {0.8, 0.6, 0.4}, cells = {8, 6, 4}, material = material})
end

describe("a grid", function()
  it("is a box by size, cells, spacing", function()
    local a = block()
    local b = assert(bw.grid.box {max = {0.8, 0.6, 0.4}, spacing = 0.1})
    local c = assert(bw.grid.box {spacing = {0.1, 0.1, 0.1}, cells = {8, 6, 4}, min = {1, 0, 0}})
    assert.same({8, 6, 4}, b.cells)
    assert.is_true(a:same_elements(b) and a:same_elements(c))
    check.near(1.8, c.box.max[1], 1e-12)
    assert.equal(192, a.element_count)
    assert.equal(9 * 7 * 5, a.node_count)
    check.near(0.192, a.volume, 1e-12)
    assert.equal(9 * 7 * 5, #a.points)
    assert.equal(192, #a.elements)
    check.near(0.1, a.spacing[2], 1e-12)
    assert.equal(0, a.origin[3])
    -- corner 8 of an element is a cell away from corner 1 in all directions
    local first = a.elements:totable()[100]
    for d = 1, 3 do
      check.near(0.1, a.points(first[8], d) - a.points(first[1], d), 1e-9)
    end
    assert.is_truthy(tostring(a):find("8 x 6 x 4 cells, 192 elements, 315 nodes, material 1", 1, true))
  end)

  it("takes materials from a function, a formula, a list", function()
    local a = block(function(x) return x > 0.4 and 2 or 1 end)
    local b = block "1 + (x > 0.4)"
    local list = {}
    for i = 1, 192 do list[i] = (i - 1) % 8 < 4 and 1 or 2 end
    local c, d = block(list), block(bw.array(list))
    for _, other in ipairs {b, c, d} do
      assert.same(a.materials:totable(), other.materials:totable())
    end
    assert.same({[1] = 96, [2] = 96}, a.material_counts)
    assert.equal(96, block(function(x) return x > 0.4 end).element_count)
    check.raises("0.5: whole numbers are expected", function() block(0.5) end)
    check.raises("oh dear", function() block(function() error "oh dear" end) end)
    check.raises("192 entries expected, one for each cell, got 3", function() block {1, 2, 3} end)
    check.raises("all its 192 cells are void", function() block(0) end)
  end)

  it("is edited into another", function()
    local a = block()
    local b = a:set({centre = {0.4, 0.3, 0.2}, radius = 0.12}, 2)
    assert.same({[1] = 184, [2] = 8}, b.material_counts)
    assert.same({[1] = 192}, a.material_counts)
    assert.is_true(a:same_elements(b))
    local hole = b:set({max = {0.2, 1, 1}, where = "z > 0.2"}, 0)
    assert.equal(192 - 2 * 6 * 2, hole.element_count)
    -- void cells are filled only when asked for
    assert.is_true(hole:set("x < 0.2", 1) == hole)
    local full = hole:set("x < 0.2", 3, {void = true})
    assert.equal(192, full.element_count)
    assert.equal(2 * 6 * 4, full.material_counts[3])
    local cells = a:cells_in {side = "max z"}
    assert.equal(48, #cells)
    assert.equal(144, a:set(cells, 0).element_count)
    assert.equal(191, a:set(1, 0).element_count)
    local two = a:set({1, 2}, {5, 6})
    assert.equal(5, two.materials[1])
    assert.equal(6, two.materials[2])
    check.raises("cell: a number from 1 to 192", function() a:set(193, 1) end)
    check.raises("cells 1 to 192", function() a:set({193}, 1) end)
    check.raises("no cell lies in the region", function() a:set({min = {2, 2, 2}}, 1) end)
    check.raises("a number of a material (0: void), a function", function() a:set({min = {0, 0, 0}}) end)
  end)

  it("chooses nodes by geometry, on a coarse grid too", function()
    local a = block():set("x > 0.6 and z > 0.2", 0)
    local coarse, parents = a:coarse()
    assert.same({4, 3, 2}, coarse.cells)
    assert.equal(a.element_count, #parents)
    assert.equal(coarse.element_count, parents:max())
    for _, grid in ipairs {a, coarse} do
      local n = grid.cells
      assert.equal((n[2] + 1) * (n[3] + 1), #grid:nodes {side = "min x"})
      assert.equal((n[2] + 1) * (n[3] // 2 + 1), #grid:nodes {side = "max x"})
      assert.equal((n[2] + 1) * (n[3] + 1), #grid:nodes {plane = {{0.4, 0, 0}, {1, 0, 0}}})
      assert.equal(3 * 1 * 1, #grid:nodes {box = {{0, 0, 0}, {2 * grid.spacing[1], 0, 0}}})
      assert.equal(#grid:nodes "x > 0.3", #grid:nodes(function(x) return x > 0.3 end))
      assert.equal(#grid:nodes {beyond = {{0.2, 0, 0}, {-1, 0, 0}}}, #grid:nodes {max = {0.2, 9, 9}})
    end
    assert.equal(1, #a:nodes {centre = {0, 0, 0}, radius = 0.05})
    assert.is_true(#a:nodes {boundary = true} < a.node_count)
    local twice, direct = a:coarse():coarse(), a:coarse(2)
    assert.is_true(twice:same_elements(direct))
    check.raises("the nearest node is at (0.8, 0, 0) m, 0.2 m away", function()
      a:nodes {min = {1, -1, -1}}
    end)
    check.raises("unknown option 'mim': did you mean 'min'?", function() a:nodes {mim = {0, 0, 0}} end)
    check.raises("'max w' is not known: did you mean 'max ", function() a:nodes {side = "max w"} end)
    check.raises("a region expected", function() a:nodes(3) end)
    check.raises("option 'radius' is missing beside 'centre'", function() a:nodes {centre = {0, 0, 0}} end)
  end)

  it("holds what a surface encloses", function()
    local sphere = assert(bw.surface.sphere {centre = {0.1, 0, 0}, radius = 0.5, subdivisions = 3})
    local grid = assert(bw.grid.voxels(sphere, {cells = 15, min_fraction = 0, multiple = 4}))
    assert.same({16, 16, 16}, grid.cells)
    check.near(sphere.volume, grid.volume, 1e-9)
    assert.is_true(grid.fractions:min() > 0 and grid.fractions:max() == 1)
    local halves = assert(bw.grid.voxels(sphere, {cells = 16, material = "1 + (z > 0)"}))
    assert.equal(halves.material_counts[1], halves.material_counts[2])
    assert.equal(1, (grid:components()))
    local inner = assert(bw.surface.sphere {centre = {0.1, 0, 0}, radius = 0.3, subdivisions = 3})
    local core = grid:set(inner, 2)
    check.near(inner.volume, core.material_counts[2] * grid.spacing[1] ^ 3, 0.07)
    check.fails("geometry", "not closed", bw.grid.voxels(bw.surface.new {
      points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, triangles = {{1, 2, 3}}}))
    check.fails("limit", "take larger cells", bw.grid.voxels(sphere, {spacing = 1e-5}))
    check.raises("did you mean 'cells'", function() bw.grid.voxels(sphere, {cell = 3}) end)
    check.raises("got a list, whose order is not known here", function()
      bw.grid.voxels(sphere, {material = {1}})
    end)
  end)

  it("carries what is embedded", function()
    local sphere = assert(bw.surface.sphere {centre = {0, 0, 0}, radius = 0.5, subdivisions = 2})
    local grid = assert(bw.grid.voxels(sphere, {cells = 12}))
    local embedding = assert(grid:embed(sphere))
    local moved = embedding:moved(grid.points) -- twice as large
    check.near(8 * sphere.volume, moved.volume, 1e-9)
    local x = embedding:values(grid.points:column(1))
    assert.equal(embedding.point_count, #x)
    check.near(sphere.points(7, 1), x[7], 1e-9)
    local force = embedding:forces(bw.array.zeros(embedding.point_count, 3):map "a + 1")
    check.near(embedding.point_count, force:column(2):sum(), 1e-9)
    assert.is_true(embedding.grid == grid)
    assert.equal(embedding.point_count, #embedding.elements)
    check.fails("geometry", "point 1 at (3, 0, 0)", grid:embed {{3, 0, 0}})
    check.raises("of places, not of a surface", function()
      grid:embed({{0, 0, 0}}):moved(grid.points)
    end)
  end)

  it("has a boundary and a file", function()
    local grid = block "1 + (x > 0.4)"
    local surface, nodes = grid:surface()
    assert.equal(2 * 2 * (8 * 6 + 6 * 4 + 8 * 4), surface.triangle_count)
    check.near(grid.volume, surface.volume, 1e-12)
    assert.equal(surface.point_count, #nodes)
    local u = grid.points:map "a * 0.1"
    check.near(0, grid:difference(u, u), 0)
    local folder = check.folder()
    assert.is_true(grid:write(folder .. "/block.vtu", {fields = {u = u, m = grid.materials}}))
    assert.is_truthy(check.read(folder .. "/block.vtu"):find('Name="material"', 1, true))
    check.raises("a path that ends in .vtu expected", function() grid:write(folder .. "/block.stl") end)
    grid:close()
    assert.equal("grid (closed)", tostring(grid))
    check.raises("closed", function() return grid.volume end)
  end)

  it("is drawn, alone, beside others, in motion", function()
    local folder = check.folder()
    local grid = block "1 + (x > 0.4)"
    local coarse = assert(grid:coarse())
    local u = grid.points:map "a * 0.1"
    local one, some = folder .. "/one.png", folder .. "/some.png"
    assert.is_true(grid:picture(one, {width = 200, height = 150, displacement = u, ghost = true,
      names = {"soft", "hard"}}))
    assert.is_true(bw.grid.picture(some, {{grid = grid, title = "fine", values = u:column(1)},
      {grid = coarse, title = "coarse", values = coarse.materials}}, {width = 150, height = 150}))
    local frames = {}
    for i = 1, 3 do
      frames[i] = ("%s/%d.png"):format(folder, i)
      assert.is_true(grid:picture(frames[i], {width = 100, height = 80, displacement = u,
        deformation = i, view = {{0, 0, 0}, {1.1, 0.8, 0.5}}}))
    end
    local body = assert(bw.surface.sphere {centre = {0.4, 0.3, 0.2}, radius = 0.15, subdivisions = 2})
    assert.is_true(grid:picture(one, {width = 200, height = 150, displacement = u, ghost = true,
      embedding = grid:embed(body), values = grid.materials}))
    check.raises("of its points in the panel's grid", function()
      coarse:picture(one, {embedding = grid:embed(body)})
    end)
    check.raises("from grid:embed", function() coarse:picture(one, {embedding = grid:embed {{0, 0, 0}}}) end)
    assert.is_true(bw.animation(folder .. "/all.png", frames, {seconds = 0.1}))
    for _, path in ipairs {one, some, folder .. "/all.png"} do
      assert.equal("\137PNG", check.read(path):sub(1, 4))
    end
    assert.is_truthy(check.read(folder .. "/all.png"):find("acTL", 1, true))
    check.raises("did you mean 'displacement'", function() grid:picture(one, {displacment = u}) end)
    check.raises("315 rows expected, one for each node", function()
      grid:picture(one, {displacement = coarse.points})
    end)
    check.raises("a grid expected", function() bw.grid.picture(some, {{title = "a"}}) end)
    check.raises("path of a PNG file expected", function() bw.animation(one, {3}) end)
    check.fails("io", "nothing.png", bw.animation(some, {folder .. "/nothing.png"}))
  end)
end)
