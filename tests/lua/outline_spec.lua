-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Outlines from lists, shapes by formula, handles, edits, selections of edges, refusals.
local bw = require "barwright"
local check = require "check"

local function plate()
  return assert(bw.outline {
    points = {{0, 0}, {0.4, 0}, {0.4, 0.3}, {0, 0.3}},
    tags = {fixed = 4, load = {2}},
    holes = {bw.outline.circle {centre = {0.1, 0.15}, radius = 0.05, name = "bore"}},
    regions = {{name = "inlay", {0.2, 0.1}, {0.3, 0.1}, {0.3, 0.2}, {0.2, 0.2}}},
  })
end

describe("an outline", function()
  it("is made of lists of points and curves", function()
    local o = plate()
    assert.equal(16, o.edge_count)
    assert.equal(2, o.region_count)
    local tags = o.tags
    table.sort(tags)
    assert.same({"bore", "boundary", "fixed", "inlay", "load"}, tags)
    assert.equal("fixed", o:edge(4).tag)
    assert.equal("load", o:edge(2).tag)
    assert.equal("boundary", o:edge(1).tag)
    assert.equal("bore", o:edge(5).tag)
    assert.equal("outline", o.loops[2].parent)
    assert.is_true(o.loops[2].hole)
    assert.equal(2, o.loops[3].region)
    -- a list the other way round is reversed and begins at the same vertex
    local reversed = assert(bw.outline {{0, 0}, {0, 1}, {2, 1}, {2, 0}})
    assert.same({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, reversed.vertices:totable())
    -- the first entry's curve closes the loop: a parabola over y = 0, of area 4/3
    local bowl = assert(bw.outline {{{1 / 3, 4 / 3}, {-1 / 3, 4 / 3}, {-1, 0}}, {1, 0}})
    check.near(4 / 3, bowl.area, 1e-14)
    check.near(2 / 5, bowl.centroid[2], 1e-14)
    assert.same({0, 0}, {bowl:edge(1).control and 1 or 0, bowl:edge(2).control and 0 or 1})
  end)

  it("measures what closed forms say", function()
    local o = assert(bw.outline.rectangle {width = 6, height = 4, holes = {
      bw.outline.rectangle {min = {1, 1}, max = {3, 2}}}})
    check.near(22, o.area, 1e-14)
    check.near(26, o.perimeter, 1e-14)
    check.near((24 * 3 - 2 * 2) / 22, o.centroid[1], 1e-14)
    assert.same({0, 0}, o.box.min)
    local disc = assert(bw.outline.circle {radius = 2, centre = {5, 5}})
    check.near(4 * math.pi, disc.area, 1e-5)
    check.near(4 * math.pi, disc.perimeter, 1e-5)
    check.near(4 * math.pi, disc.second_moment.xx, 2e-5)
    for i = 0, 100 do -- nowhere farther off than 4.3e-6 radii
      local p = disc:at(1 + i % 8, i / 100)
      check.near(2, math.sqrt((p[1] - 5) ^ 2 + (p[2] - 5) ^ 2), 4.5e-6)
    end
    check.near(2 * math.pi, bw.outline.ellipse({radii = {2, 1}, angle = 30}).area, 1e-5)
    local bar = assert(bw.outline.rectangle {width = 10, height = 2, radius = 1}) -- no edge between the arcs
    check.near(16 + math.pi, bar.area, 1e-5)
    check.near(16 + 2 * math.pi, bar.perimeter, 1e-5)
    assert.equal(10, bar.edge_count)
    local mixed = assert(bw.outline.rounded {points = {{0, 0}, {4, 0}, {4, 4}, {2, 1}},
      radius = {0, 0.2, 0.1, 0.3}})
    assert.equal(4 + 2 + 4 + 1, mixed.edge_count) -- turns of 90, 146 and 30 degrees
  end)

  it("moves by its handles, and refuses what would cross", function()
    local o = plate()
    local moved = assert(o:moved({loop = "bore"}, {0.02, 0.01}))
    assert.is_true(o:same_topology(moved))
    check.near(o.area, moved.area, 1e-13)
    assert.is_true(moved:nearest({0.12, 0.16}).distance > 0.0499)
    local corner = assert(o:moved({vertex = 3}, {0.1, 0.1}))
    assert.same({0.5, 0.4}, corner.vertices:totable()[3])
    local edge = assert(o:moved({loop = "inlay", edge = 2}, {0.05, 0}))
    check.near(0.35, edge:edge(14).from[1], 1e-15)
    local lost, message, details = o:moved({loop = "bore"}, {0.2, 0})
    check.fails("geometry", "of loop 'bore' crosses segment", lost, message, details)
    assert.truthy(details.x and details.segment and details.other_segment)
    assert.equal(16, o.edge_count)
    check.raises("did you mean 'bore'", o.moved, o, {loop = "boer"}, {0, 0})
    check.raises("{vertex = n}, {edge = n} or {loop = name} expected", o.moved, o, {}, {0, 0})
    check.raises("vertex: a number from 1 to 16", o.moved, o, {vertex = 17}, {0, 0})
    check.raises("did you mean 'vertex'", o.moved, o, {vertx = 1}, {0, 0})
    check.raises("two finite numbers", o.moved, o, {vertex = 1}, {0})
    local curved = assert(o:moved({edge = 5, control = 2}, {0.01, 0}))
    check.near(o:edge(5).control[2][1] + 0.01, curved:edge(5).control[2][1], 1e-15)
    assert.same(o.vertices:totable(), curved.vertices:totable())
    check.raises("an edge that is a curve", o.moved, o, {edge = 1, control = 1}, {0, 0})
    local weights = o:weights {loop = "outline"}
    check.near(#weights, weights:sum(), 1e-15)
  end)

  it("gains and loses holes and regions", function()
    local o = plate()
    local more = assert(o:hole(bw.outline.circle {centre = {0.35, 0.15}, radius = 0.03}))
    assert.equal("hole 1", more.loops[4].name)
    check.near(o.area - math.pi * 9e-4, more.area, 1e-5)
    local slot = assert(o:hole {name = "slot", tag = "cut", {0.32, 0.1}, {0.34, 0.1}, {0.34, 0.2}})
    assert.equal("cut", slot:edge(17).tag)
    assert.equal("fixed", slot:edge(4).tag)
    local three = assert(o:region {{0.32, 0.1}, {0.34, 0.1}, {0.34, 0.2}})
    assert.equal(3, three.region_count)
    check.near(0.001, three:measure(3).area, 1e-13)
    check.near(o.area, three.area, 1e-14)
    assert.equal(2, assert(o:region {region = 2, {0.32, 0.1}, {0.34, 0.1}, {0.34, 0.2}}).region_count)
    local fewer = assert(o:without "bore")
    assert.equal(2, #fewer.loops)
    check.near(0.12, fewer.area, 1e-14)
    check.fails("geometry", "nothing would be left", o:without(1))
    check.fails("geometry", "is a hole and lies in no other loop", o:hole {{1, 1}, {2, 1}, {2, 2}})
    check.raises("region: a number from 1 to 3", o.region, o, {region = 5, {0, 0}, {1, 0}, {1, 1}})
    check.raises("region: option 'points': a list of points expected, got function", o.region, o, {points = print})
  end)

  it("comes back from its own loops", function()
    local o = plate()
    local again = assert(bw.outline {points = o:loop "outline", holes = {o:loop "bore"},
      tags = o:loop("outline").tags, regions = {o:loop "inlay"}})
    for edge = 1, 16 do assert.same(o:edge(edge), again:edge(edge)) end
  end)

  it("is smoothed, pulled, split and joined", function()
    local list = {}
    for i = 1, 40 do
      local a = 2 * math.pi * i / 40
      list[i] = {(1 + 0.02 * (-1) ^ i) * math.cos(a), (1 + 0.02 * (-1) ^ i) * math.sin(a)}
    end
    local star = assert(bw.outline(list))
    local smooth = assert(star:smooth {rounds = 5, corner = 90})
    assert.is_true(smooth.perimeter < star.perimeter - 0.1)
    local pulled = assert(smooth:pull(10, {-0.1, 1.4}, {pins = {1, 20}}))
    assert.same({-0.1, 1.4}, pulled.vertices:totable()[10])
    assert.same(smooth.vertices:totable()[30], pulled.vertices:totable()[30])
    check.raises("pinned too", smooth.pull, smooth, 1, {0, 0}, {pins = {1}})
    check.raises("pull: pins: vertices from 1 to 40", smooth.pull, smooth, 1, {0, 0}, {pins = {41}})
    local o = plate()
    local finer = assert(o:split(5, 0.25))
    assert.equal(17, finer.edge_count)
    check.near(o.area, finer.area, 1e-14)
    local back = assert(finer:join(6))
    assert.equal(16, back.edge_count)
    check.near(o.perimeter, back.perimeter, 1e-12)
  end)

  it("finds edges and tags them", function()
    local o = plate()
    assert.same({2}, o:edges {near = {0.41, 0.15}})
    assert.same({1, 4}, o:edges {near = {0, 0}, radius = 1e-3})
    assert.same({1}, o:edges {box = {{-1, -1}, {1, 1e-3}}})
    assert.same({13, 14, 15, 16}, o:edges {loop = "inlay"})
    assert.same({3}, o:edges(3))
    local tagged = assert(o:tag("wall", {1, 2}))
    assert.equal("wall", tagged:edge(2).tag)
    assert.equal("fixed", tagged:edge(4).tag)
    check.raises("no edge lies in the selection", o.tag, o, "x", {box = {{5, 5}, {6, 6}}})
    check.raises("did you mean 'near'", o.tag, o, "x", {nera = {0, 0}})
    check.raises("numbers from 1 to 16", o.tag, o, "x", {99})
    local at = o:nearest {0.2, -0.1}
    assert.equal(1, at.edge)
    check.near(0.1, at.distance, 1e-14)
  end)

  it("is shifted, rotated and scaled", function()
    local o = plate()
    check.near(o.centroid[1] + 1, assert(o:shifted {1, 2}).centroid[1], 1e-13)
    local rotated = assert(o:rotated(90))
    check.near(o.second_moment.xx, rotated.second_moment.yy, 1e-12)
    check.near(o.centroid[1], rotated.centroid[1], 1e-13)
    check.near(6 * o.area, assert(o:scaled {2, 3}).area, 1e-13)
  end)

  it("becomes polygons", function()
    local list = assert(plate():polygons(1e-4))
    assert.equal(3, #list)
    assert.equal(4, #list[1])
    assert.is_true(#list[2] > 16)
    check.raises("a length above 0 expected", plate().polygons, plate(), 0)
  end)

  it("goes to files and comes back", function()
    local folder = check.folder()
    local o = assert(plate():with_tag("fixed edges", {1, 3}))
    assert(o:write(folder .. "/plate.svg"))
    local again, info = assert(bw.outline.read(folder .. "/plate.svg"))
    assert.equal("SVG", info.format)
    for edge = 1, o.edge_count do
      assert.equal(o:edge(edge).tag, again:edge(edge).tag)
      assert.equal(o:edge(edge).loop, again:edge(edge).loop)
      check.near(o:edge(edge).length, again:edge(edge).length, 1e-13)
    end
    assert.equal(2, again.region_count)
    assert(o:write(folder .. "/plate.dxf"))
    local cut = assert(bw.outline.read(folder .. "/plate.dxf", {unit = "mm", tolerance = 1e-6}))
    check.near(o.perimeter + 0.4, cut.perimeter, 1e-13) -- the inlay is a loop inside: a hole
    assert.equal("fixed edges", cut:edge(cut:nearest({0.2, 0}).edge).tag)
    check.raises(".svg or .dxf", o.write, o, folder .. "/plate.png")
    check.fails("io", "cannot be read", bw.outline.read(folder .. "/none.svg"))
    check.write(folder .. "/open.svg", "<svg>\n<path d='M0 0H10V10'/></svg>")
    local none, message, details = bw.outline.read(folder .. "/open.svg", {unit = 1})
    check.fails("geometry", "open.svg:2: a curve is open at", none, message, details)
    assert.equal(2, details.line)
  end)

  it("is drawn", function()
    local folder, o = check.folder(), plate()
    assert(o:picture(folder .. "/a.png", {width = 300, height = 200, numbers = true}))
    assert(o:picture(folder .. "/b.png", {width = 300, height = 200, numbers = true}))
    local bytes = check.read(folder .. "/a.png")
    assert.equal("\x89PNG", bytes:sub(1, 4))
    assert.equal(bytes, check.read(folder .. "/b.png"))
    check.raises("16 to 20000", o.picture, o, folder .. "/a.png", {width = 1})
    check.fails("io", "cannot write", o:picture(folder .. "/none/a.png"))
  end)

  it("tells when memory runs out, and loses nothing", function()
    local core = require "barwright.core"
    local folder, o = check.folder(), plate()
    assert(o:write(folder .. "/a.svg"))
    local works = {
      function() return o:moved({loop = "bore"}, {0.01, 0}) end,
      function() return o:polygons() end,
      function() return bw.outline {{0, 0}, {1, 0}, {0, 1}} end,
      function() return o:pull(1, {0.01, 0.01}, {reach = 0.1}) end,
      function() return o:without "bore" end,
      function() return bw.outline.read(folder .. "/a.svg") end,
    }
    for _, work in ipairs(works) do
      assert(work())
      collectgarbage()
      collectgarbage()
      local _, blocks = core.external()
      for n = 1, 300 do
        core.fail_allocation(n)
        local ok, value, _, details = pcall(work)
        core.fail_allocation(0)
        if ok and value then break end
        assert.is_true(n < 300)
        if ok then assert.equal("memory", details.status) end
      end
      collectgarbage()
      collectgarbage()
      local _, after = core.external()
      assert.equal(blocks, after)
    end
  end)

  it("says in words what it is", function()
    local text = tostring(plate())
    assert.truthy(text:find("outline, 400 x 300 mm: area 1121 cm2", 1, true))
    assert.truthy(text:find("bore in outline: hole, edges 5 to 12, tags bore", 1, true))
    local o <close> = plate()
    o:close()
    assert.equal("outline (closed)", tostring(o))
    check.raises("closed", function() return o.area end)
  end)

  it("refuses wrong lists", function()
    check.raises("point 3: {x, y} or a curve", bw.outline, {{0, 0}, {1, 0}, {1}})
    check.raises("did you mean 'holes'", bw.outline, {points = {{0, 0}, {1, 0}, {1, 1}}, hoels = {}})
    check.raises("a table of points expected, got 3", bw.outline, 3)
    check.raises("edges from 1 to 3", bw.outline, {points = {{0, 0}, {1, 0}, {1, 1}}, tags = {a = 4}})
    check.raises("has the tags", bw.outline, {points = {{0, 0}, {1, 0}, {1, 1}}, tags = {a = 1, b = {1}}})
    check.raises("at most 1e+12", bw.outline, {{0, 0}, {1e13, 0}, {1, 1}})
    check.raises("takes 2414 mm of", bw.outline.rounded, {points = {{0, 0}, {1, 0}, {1, 1}}, radius = 1})
    check.fails("geometry", "crosses", bw.outline {{0, 0}, {1, 1}, {1, 0}, {0, 1}})
    check.fails("geometry", "touches", bw.outline {{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}})
  end)
end)
