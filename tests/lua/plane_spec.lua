-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Plane meshes: filling, arrays, transferring, following, files, refusals.
local bw = require "barwright"
local check = require "check"

local function block()
  return assert(bw.outline.rectangle {min = {0, 0}, max = {3, 1},
    holes = {bw.outline.circle {centre = {1, 0.5}, radius = 0.2, name = "hole"}}})
end

describe("a plane mesh", function()
  it("fills an outline with about as many elements as wanted", function()
    local outline = block()
    for order = 1, 2 do
      local mesh = assert(bw.plane.fill(outline, {elements = 800, order = order}))
      assert.is_true(math.abs(mesh.element_count / 800 - 1) <= 0.1)
      assert.equal(order, mesh.order)
      local quality = mesh.quality
      check.near(outline.area, quality.area, order == 2 and 1e-4 or 5e-3)
      assert.equal(0, quality.inverted)
      check.near(quality.worst, mesh.element_quality:min(), 0)
      check.near(quality.worst, mesh.element_quality[quality.worst_element], 0)
      -- sides lie on the outline's edges
      local sides, edges = mesh.sides:totable(), mesh.side_edges:totable()
      for i, side in ipairs(sides) do
        assert.equal(edges[i], mesh.node_edges[side[1]])
        local x, y = mesh.points(side[1], 1), mesh.points(side[1], 2)
        assert.is_true(outline:edge_distance(edges[i], {x, y}) < 1e-12)
      end
      assert.equal(#sides, #mesh.side_elements)
      assert.equal(mesh.element_count, #mesh.neighbours)
      assert.equal(mesh.node_count, #mesh.node_parameters)
      assert.is_true(mesh.corner_count <= mesh.node_count)
      assert.is_truthy(tostring(mesh):find("triangles of order " .. order, 1, true))
    end
  end)

  it("follows a size field: a function, a formula, a number", function()
    local outline = block()
    local a = assert(bw.plane.fill(outline, {field = function(x) return 0.05 + 0.1 * x end}))
    local b = assert(bw.plane.fill(outline, {field = "0.05 + 0.1*x"}))
    assert.same(a.elements:totable(), b.elements:totable())
    local c = assert(bw.plane.fill(outline, {size = 0.1}))
    local d = assert(bw.plane.fill(outline, {field = 0.1}))
    check.near(1, c.element_count / d.element_count, 0.1)
    check.raises("oh dear", function()
      bw.plane.fill(outline, {field = function() error "oh dear" end})
    end)
    check.raises("size field gives -1", function() bw.plane.fill(outline, {field = "-1"}) end)
  end)

  it("has regions", function()
    local outline = assert(bw.outline.rectangle {min = {0, 0}, max = {2, 1},
      regions = {bw.outline.circle {centre = {1, 0.5}, radius = 0.3, name = "inlay"}}})
    local mesh = assert(bw.plane.fill(outline, {elements = 400}))
    assert.equal(2, mesh.regions:max())
    local both = 0
    for _, pair in ipairs(mesh.side_elements:totable()) do
      if pair[1] > 0 and pair[2] > 0 then
        both = both + 1
        assert.equal(2, mesh.regions[pair[1]])
        assert.equal(1, mesh.regions[pair[2]])
      end
    end
    assert.is_true(both > 8)
  end)

  it("comes from arrays and from formulas", function()
    local mesh = assert(bw.plane.rectangle {min = {0, 0}, max = {2, 1}, cells = {4, 2}, order = 2,
      diagonal = "union jack"})
    assert.equal(16, mesh.element_count)
    assert.same({"bottom", "right", "top", "left"}, mesh.outline.tags)
    local copy = assert(bw.plane.new {points = mesh.points, elements = mesh.elements, order = 2})
    assert.equal(12, copy.outline.edge_count)
    check.near(2, copy.quality.area, 1e-14)
    local on = assert(bw.plane.new {points = mesh.points, elements = mesh.elements, order = 2,
      outline = mesh.outline, edges = mesh.node_edges, parameters = mesh.node_parameters})
    assert.same(mesh.sides:totable(), on.sides:totable())
    local mesh_nil, message, details = bw.plane.new {points = {{0, 0}, {1, 0}, {0, 1}},
      elements = {{1, 3, 2}}}
    assert.is_nil(mesh_nil)
    assert.is_truthy(message:find "counter%-clockwise")
    assert.equal("geometry", details.status)
  end)

  it("follows an outline that is dragged and says at which level", function()
    local outline = block()
    for order = 1, 2 do
      local mesh = assert(bw.plane.fill(outline, {elements = 500, order = order}))
      local motion = assert(bw.plane.mesh_motion(mesh))
      local seen, now = {}, outline
      local field = mesh.points
      for i = 1, 30 do
        now = assert(outline:moved({loop = "hole"}, {0.05 * i, 0}))
        local before = motion.mesh
        local report = assert(motion:follow(now))
        seen[report.level] = (seen[report.level] or 0) + 1
        local shares = {relocation = "topology", reconnecting = "nodes"}
        assert.equal(shares[report.level], motion.mesh:shares(before))
        assert.equal(report.level == "reconnecting", report.flips > 0)
        check.near(report.worst, motion.mesh.quality.worst, 0)
        assert.equal(0, motion.mesh.quality.inverted)
        field = assert(before:transfer(motion.mesh, field))
        assert.equal(motion.mesh.node_count, #field)
      end
      assert.is_true(seen.relocation > 5 and (seen.reconnecting or 0) > 0)
      assert.equal("none", motion:follow(now).level)
      -- another topology: all new
      local report = assert(motion:follow(assert(now:without "hole")))
      assert.equal("reconstruction", report.level)
      assert.equal(1, #motion.outline.loops)
      assert.is_nil(motion.mesh:shares(mesh))
    end
  end)

  it("follows to outlines of quite another size with as many elements", function()
    local function house(size)
      return assert(bw.outline {{0, 0}, {2 * size, 0}, {2 * size, size}, {size, 1.2 * size}, {0, size}})
    end
    local mesh = assert(bw.plane.fill(block(), {elements = 200}))
    local motion = assert(bw.plane.mesh_motion(mesh, {fill = {elements = 200}}))
    for _, outline in ipairs {house(1), assert(bw.outline.rectangle {width = 2e-6, height = 1e-6}), house(1e6),
      assert(bw.outline.rectangle {width = 2e-6, height = 1e-6}), house(1)} do
      assert(motion:follow(outline))
      check.near(200, motion.mesh.element_count, 0.1)
    end
  end)

  it("pulls gradients back to the outline", function()
    local outline = block()
    local mesh = assert(bw.plane.fill(outline, {elements = 200}))
    local motion = assert(bw.plane.mesh_motion(mesh))
    -- J = sum of x of all nodes: moving everything to the right by 1 gains the number of nodes
    local ones = {}
    for i = 1, mesh.node_count do ones[i] = {1, 0} end
    local gradient = assert(motion:pull_back(ones)):totable()
    local sum = 0
    for _, g in ipairs(gradient) do
      sum = sum + g[1]
      assert.is_true(math.abs(g[2]) < 1e-12)
    end
    check.near(mesh.node_count, sum, 1e-9)
  end)

  it("keeps a size field for new meshes", function()
    local outline = block()
    local calls = 0
    local field = function(x) calls = calls + 1 return 0.05 + 0.1 * x end
    local mesh = assert(bw.plane.fill(outline, {field = field}))
    local motion = assert(bw.plane.mesh_motion(mesh, {force = "reconstruction", fill = {field = field}}))
    field = nil -- luacheck: ignore 311
    collectgarbage()
    calls = 0
    local report = assert(motion:follow(assert(outline:moved({loop = "hole"}, {0.1, 0}))))
    assert.equal("reconstruction", report.level)
    assert.is_true(calls > 0)
    check.near(1, motion.mesh.element_count / mesh.element_count, 0.2)
  end)

  it("knows where a place is", function()
    local mesh = assert(bw.plane.rectangle {cells = {2, 2}})
    local element, weights, outside = mesh:locate {0.9, 0.05}
    local corners = mesh.elements:totable()[element]
    local x, y = 0, 0
    for k = 1, 3 do
      x = x + weights[k] * mesh.points(corners[k], 1)
      y = y + weights[k] * mesh.points(corners[k], 2)
    end
    check.near(0.9, x, 1e-15)
    check.near(0.05, y, 1e-15)
    assert.equal(0, outside)
    check.near(0.5, select(3, mesh:locate {1.3, 1.4}), 1e-15)
  end)

  it("is moved with its outline", function()
    local mesh = assert(bw.plane.rectangle {cells = {2, 2}})
    local wider = assert(mesh.outline:with_points {{0, 0}, {2, 0}, {2, 1}, {0, 1}})
    local points = mesh.points:totable()
    for _, p in ipairs(points) do p[1] = 2 * p[1] end
    local moved = assert(mesh:moved(wider, points))
    check.near(2, moved.quality.area, 1e-15)
    assert.equal("topology", moved:shares(mesh))
    assert.is_nil((mesh:moved(wider, mesh.points)))
  end)

  it("is written with fields", function()
    local mesh = assert(bw.plane.rectangle {cells = {3, 2}, order = 2})
    local path = check.folder() .. "/plane.vtu"
    assert(mesh:write(path, {fields = {place = mesh.points, quality = mesh.element_quality}}))
    local text = check.read(path)
    assert.is_truthy(text:find('NumberOfPoints="35" NumberOfCells="12"', 1, true))
    assert.is_truthy(text:find('Name="place" NumberOfComponents="3"', 1, true))
    check.raises(".vtu", function() mesh:write "plane.stl" end)
  end)

  it("refuses what it cannot use", function()
    local outline = block()
    check.raises("did you mean 'elements'", function() bw.plane.fill(outline, {element = 3}) end)
    check.raises("'elements' and 'size'", function() bw.plane.fill(outline, {elements = 30, size = 0.1}) end)
    check.raises("'elements' and 'field'", function() bw.plane.fill(outline, {elements = 30, field = 0.1}) end)
    check.raises("order 4", function() bw.plane.fill(outline, {order = 4}) end)
    check.raises("outline", function() bw.plane.fill {} end)
    check.raises("cells", function() bw.plane.rectangle {cells = {0, 1}} end)
    local none, message, details = bw.plane.fill(outline, {size = 1e-6})
    assert.is_nil(none)
    assert.is_truthy(message:find "limit")
    assert.equal("limit", details.status)
    local mesh = assert(bw.plane.fill(outline, {elements = 100}))
    check.raises("distorted", function() bw.plane.mesh_motion(mesh, {distorted = 2}) end)
    check.raises("72 rows expected, one for each node", function() mesh:transfer(mesh, bw.array.new {1, 2}) end)
  end)
end)
