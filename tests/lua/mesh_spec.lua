-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
local bw = require "barwright"
local check = require "check"

describe("a surface", function()
  local box = bw.surface.box {min = {0, 0, 0}, max = {1, 2, 3}}

  it("is made by formula", function()
    check.near(6, box.volume, 1e-14)
    check.near(22, box.area, 1e-14)
    assert.same({1, 2, 3}, box.box.size)
    local ball = bw.surface.sphere {radius = 2, subdivisions = 4}
    check.near(4 / 3 * math.pi * 8, ball.volume, 0.01)
    local rod = bw.surface.cylinder {axis = {0, 0, 5}, radius = 1, segments = 96}
    check.near(5 * math.pi, rod.volume, 0.01)
    local lines = {}
    for line in tostring(box):gmatch "[^\n]+" do lines[#lines + 1] = line end
    assert.equal("surface of 12 triangles and 8 points, 1000 x 2000 x 3000 mm from (0, 0, 0) mm", lines[1])
    assert.equal("  plane 1      6 m2 at (0, 1000, 1500) mm, normal (-1, 0, 0)", lines[2])
    assert.equal(7, #lines)
  end)

  it("has faces", function()
    local rod = bw.surface.cylinder {axis = {0, 0, 5}, radius = 1, segments = 48}
    local faces = rod:faces()
    assert.same({"cylinder 1", "plane 1", "plane 2"}, {faces[1].name, faces[2].name, faces[3].name})
    check.near(1, faces[1].radius, 1e-13)
    check.near(rod.area, faces[1].area + faces[2].area + faces[3].area, 1e-12)
    assert.is_nil(faces[2].radius)
    assert.equal(3, #rod:faces {angle = 0.5})
    check.raises("unknown option 'angel'", rod.faces, rod, {angel = 1})
    -- a facet of the cylinder turns by 7.5 degrees: below that each is a face of its own
    assert.equal(50, #rod:faces {angle = 0.1})
  end)

  it("lies on round faces with curved elements at every size, which pass the patch test", function()
    local ball = bw.surface.sphere {radius = 0.01, subdivisions = 3}
    local rod = bw.surface.cylinder {axis = {0, 0, 0.03}, radius = 0.01, segments = 96}
    local exact = {[ball] = 4 * math.pi * 1e-4, [rod] = 2 * math.pi * 1e-4 + 2 * math.pi * 0.01 * 0.03}
    local gradient = {{1e-3, 2e-4, -3e-4}, {5e-4, -7e-4, 1e-4}, {-2e-4, 4e-4, 6e-4}}
    for surface, area in pairs(exact) do
      for _, elements in ipairs {150, 1000} do
        local straight = assert(bw.mesh.fill(surface, {elements = elements, order = 2, tolerance = 0.5}))
        local mesh, count = assert(straight:curved(surface))
        assert.is_true(count > 0 and count < mesh.boundary.node_count)
        if surface == ball then
          assert.is_true(math.abs(mesh.boundary.area - area) < 0.2 * math.abs(straight.boundary.area - area))
        end
        assert.is_true(math.abs(mesh.boundary.area / area - 1) < 0.005)
        local rows = {}
        for i = 1, mesh.node_count do
          rows[i] = {}
          for k = 1, 3 do
            rows[i][k] = gradient[k][1] * mesh.nodes(i, 1) + gradient[k][2] * mesh.nodes(i, 2)
              + gradient[k][3] * mesh.nodes(i, 3)
          end
        end
        local field = bw.array(rows)
        local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 1e9, poisson = 0.3}}
        local static = assert(part:prescribe(mesh.boundary, field):solve())
        assert.is_true((static.displacement - field):norm() < 1e-12 * field:norm())
        check.near(1, static.von_mises:max() / static.von_mises:min(), 1e-10)
      end
    end
    local flat = assert(bw.mesh.fill(ball, {elements = 150}))
    check.raises("this mesh has order 1", flat.curved, flat, ball)
    local cube = bw.surface.box {max = {1, 1, 1}}
    local _, none = assert(bw.mesh.fill(cube, {elements = 150, order = 2})):curved(cube)
    assert.equal(0, none)
  end)

  it("keeps its faces when it is filled, to be selected on the mesh", function()
    local rod = bw.surface.cylinder {axis = {0, 0, 0.05}, radius = 0.01, segments = 48}
    local mesh = assert(bw.mesh.fill(rod, {elements = 4000}))
    local round, foot = mesh.boundary:face "cylinder 1", mesh.boundary:face {near = {0, 0, 0}}
    check.near(1, -foot.normal[3], 1e-12)
    check.near(round.area + foot.area + mesh.boundary:face {near = {0, 0, 0.05}}.area, mesh.boundary.area, 1e-12)
    for _, node in ipairs(round.nodes:totable()) do
      check.near(0.01, math.sqrt(mesh.nodes(node, 1) ^ 2 + mesh.nodes(node, 2) ^ 2), 1e-12)
    end
    for _, node in ipairs(foot.nodes:totable()) do assert.equal(0, mesh.nodes(node, 3)) end
    local upper = mesh.boundary:above(3, 0.025):face(1)
    assert.is_true(upper.area < round.area and upper.area > 0.3 * round.area)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(foot):load {on = mesh.boundary:face {near = {0, 0, 0.05}}, force = {0, 0, 1}}
    check.raises("no face 4: the name of one of its 3 faces", mesh.boundary.face, mesh.boundary, 4)
    check.raises("the boundary has no face 'plane 7'", mesh.boundary.face, mesh.boundary, "plane 7")
    check.raises("{near = {x, y, z}} expected", mesh.boundary.face, mesh.boundary, {})
    check.raises("a number of 1 or more", mesh.boundary.face, mesh.boundary, 0)
  end)

  it("is made by a function or a formula that is negative inside", function()
    local opts = {min = {-1, -1, -1}, max = {1, 1, 1}, cells = 12}
    local one = assert(bw.surface.implicit("x^2 + y^2 + z^2 - 0.5", opts))
    local two = assert(bw.surface.implicit(function(x, y, z)
      return x * x + y * y + z * z - 0.5
    end, opts))
    assert.equal(one.points:tostring "<f8", two.points:tostring "<f8")
    check.near(4 / 3 * math.pi * 0.5 ^ 1.5, one.volume, 0.05)
    assert.is_true(one:check().sound)
  end)

  it("raises what a function raises, and keeps working", function()
    local opts = {min = {-1, -1, -1}, max = {1, 1, 1}, cells = 8}
    check.raises("my own error", bw.surface.implicit, function() error "my own error" end, opts)
    check.raises("a number expected as its result, got nil", bw.surface.implicit, function() end, opts)
    check.raises("the engine is busy", bw.surface.implicit, function()
      return bw.surface.sphere {radius = 1}
    end, opts)
    check.raises("nothing may be closed", bw.surface.implicit, function() box:close() end, opts)
    local threads = bw.threads()
    assert(bw.surface.implicit(function(x) return x * x - 0.3 + 10 * 0 end, {min = {-1, -1, -1},
      max = {1, 1, 1}, cells = 4}) ~= false)
    assert.equal(threads, bw.threads())
  end)

  it("reports how far points are", function()
    local cube = bw.surface.box {min = {0, 0, 0}, max = {1, 1, 1}}
    assert.same({0.25, 0.0, 5.0}, cube:distance {{0.5, 0.5, 0.25}, {1, 0.5, 0.5}, {4, 0.5, 5}}:totable())
    assert.equal(1, cube:distance(bw.surface.box {min = {0, 0, 0}, max = {2, 1, 1}}))
    check.raises("point 2 is not finite", cube.distance, cube, {{0, 0, 0}, {0 / 0, 0, 0}})
  end)

  it("comes from and gives arrays that count from 1", function()
    local copy = assert(bw.surface.new {points = box.points, triangles = box.triangles})
    assert.same(box.triangles:totable(), copy.triangles:totable())
    assert.equal(1, box.triangles:min())
    assert.equal(8, box.triangles:max())
    check.raises("count from 1", bw.surface.new, {points = box.points, triangles = {{0, 1, 2}}})
    check.fails("geometry", "", bw.surface.new {points = box.points, triangles = {{1, 2, 9}}})
  end)

  it("moves", function()
    check.near(48, box:scale(2).volume, 1e-14)
    assert.same({1, 2, 3}, box:translate({1, 2, 3}).box.min)
    local rotated = box:rotate({0, 0, 1}, math.pi / 2)
    check.near(-2, rotated.box.min[1], 1e-12)
    check.near(1, rotated.box.max[2], 1e-12)
    check.near(6, rotated.volume, 1e-12)
    local again = box:rotate({1, 2, 3}, 0.7, {4, 5, 6}):rotate({1, 2, 3}, -0.7, {4, 5, 6})
    assert.truthy((again.points - box.points):norm() < 1e-14)
    local mirrored = box:transform {{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}
    assert.truthy(math.abs(math.abs(mirrored.volume) - 6) < 1e-12)
    check.raises("rows of 4 numbers", box.transform, box, {{1, 2}, {3, 4}})
  end)

  it("goes through files in millimetres", function()
    local folder = check.folder()
    for _, ending in ipairs {"stl", "obj", "ply", "off"} do
      local path = folder .. "/box." .. ending
      assert.is_true(box:write(path))
      local back, info = assert(bw.surface.read(path))
      check.near(6, back.volume, 1e-6)
      assert.equal(0.001, info.metres_per_unit)
      check.near(6e9, bw.surface.read(path, {unit = "m"}).volume, 1e-6)
      check.near(6 * 25.4 ^ 3, bw.surface.read(path, {unit = "in"}).volume, 1e-6)
    end
    assert.truthy(check.read(folder .. "/box.obj"):find "3000")
  end)

  it("is checked and repaired", function()
    local open = bw.surface.new {points = box.points, triangles = box.triangles:rows(1, 11)}
    local report = open:check()
    assert.is_false(report.sound)
    assert.equal(1, report.holes)
    assert.equal("table", type(report.defects[1].at))
    local whole, log = assert(open:repair())
    check.near(6, whole.volume, 1e-12)
    assert.truthy(#log.steps >= 1)
    assert.truthy(box:distance(box) < 1e-15)
    check.near(0.5, box:distance(box:translate {0.5, 0, 0}), 1e-12)
  end)

  it("says what is wrong with a file", function()
    local value, message, details = bw.surface.read "no/such/file.stl"
    check.fails("io", "no/such/file.stl", value, message, details)
    local path = check.folder() .. "/bad.obj"
    check.write(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n")
    value, message, details = bw.surface.read(path)
    check.fails("format", "bad.obj", value, message, details)
    assert.equal(4, details.line)
  end)

  it("raises for misuse and names what was meant", function()
    check.raises("unknown option 'unti': did you mean 'unit'?", bw.surface.read, "x.stl", {unti = "mm"})
    check.raises("unknown unit 'milimetre'", bw.surface.read, "x.stl", {unit = "milimetre"})
    check.raises("option 'radius': a finite number expected, got string", bw.surface.sphere,
      {radius = "1"})
    check.raises("option 'radius' is missing", bw.surface.sphere, {})
    check.raises("no 'volum': did you mean 'volume'", function() return box.volum end)
    check.raises("points: an array or a table of rows expected, got 1", box.distance, box, 1)
    check.raises("surface expected, got mesh", bw.mesh.fill, check.beam())
    check.raises("named", bw.surface.sphere, {1, 2})
  end)
end)

describe("a mesh", function()
  local beam = check.beam()

  it("is renumbered along a curve, with the old numbers", function()
    local mesh, nodes, elements = assert(beam:renumbered())
    assert.equal(beam.node_count, #nodes)
    assert.truthy((mesh.nodes - beam.nodes:gather(nodes)):norm() == 0)
    check.near(beam.volume, mesh.volume, 1e-15)
    for _, e in ipairs {1, mesh.element_count} do
      for a = 1, 4 do
        assert.equal(beam.elements(math.tointeger(elements[e]), a), nodes[mesh.elements(e, a)])
      end
    end
  end)

  -- Nodes and elements in an order that has nothing to do with where they are.
  local function scattered(mesh)
    local function permutation(n)
      local p = {}
      for i = 1, n do p[i] = i * 7919 % n + 1 end -- 7919 and n without a common divisor
      return p
    end
    local from, of_element = permutation(mesh.node_count), permutation(mesh.element_count)
    local to, nodes, elements = {}, {}, {}
    for new, old in ipairs(from) do
      to[old], nodes[new] = new, {mesh.nodes(old, 1), mesh.nodes(old, 2), mesh.nodes(old, 3)}
    end
    for new, old in ipairs(of_element) do
      local corner = {}
      for a = 1, 4 do corner[a] = to[math.tointeger(mesh.elements(old, a))] end
      elements[new] = corner
    end
    return assert(bw.mesh.new {nodes = nodes, elements = elements})
  end

  it("from a file is renumbered where that pays, fields with it", function()
    local ordered = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 2, 3}, cells = {15, 16, 17}})
    local mesh, path = scattered(ordered), check.folder() .. "/scattered.vtu"
    assert(mesh:write(path, {fields = {height = mesh.nodes:column(3):copy(), volume = mesh.volumes}}))
    bw.warnings()
    local same, plain = assert(bw.mesh.read(path, {renumber = false}))
    assert.truthy((same.nodes - mesh.nodes):norm() == 0)
    assert.is_nil(plain.node_from)
    assert.equal(0, #bw.warnings())
    local read, file = assert(bw.mesh.read(path))
    assert.matches("the mesh is renumbered: its elements spanned %d+ times", bw.warnings()[1])
    assert.truthy((read.nodes - mesh.nodes:gather(file.node_from)):norm() == 0)
    assert.truthy((read.volumes - mesh.volumes:gather(file.element_from)):norm() == 0)
    assert.truthy((file.fields.height - read.nodes:column(3)):norm() == 0)
    assert.truthy((file.fields.volume - read.volumes):norm() == 0)
    check.near(mesh.volume, read.volume, 1e-12)
    assert(read:write(path)) -- along the curve already
    assert.is_nil(select(2, assert(bw.mesh.read(path))).node_from)
    check.raises("option 'renumber': true, false or 'auto' expected, got string 'perhaps'", bw.mesh.read, path,
      {renumber = "perhaps"})
  end)

  it("from a file keeps its sets when it is renumbered", function()
    local path = check.folder() .. "/sets.inp"
    local mesh = scattered(beam)
    assert(mesh:write(path))
    local deck = assert(io.open(path, "a"))
    deck:write("*NSET, NSET=ends\n1, 5, 99\n*ELSET, ELSET=some\n2, 240\n")
    deck:close()
    local old, of_file = assert(bw.mesh.read(path, {renumber = false}))
    local new, file = assert(bw.mesh.read(path, {renumber = true}))
    for name, key in pairs {ends = "nodes", some = "elements"} do
      local from = key == "nodes" and file.node_from or file.element_from
      local before, after = {}, {}
      for i = 1, #of_file.sets[name][key] do before[i] = of_file.sets[name][key][i] end
      for i = 1, #file.sets[name][key] do after[i] = from[math.tointeger(file.sets[name][key][i])] end
      table.sort(after)
      assert.same(before, after)
    end
    assert.equal(old.element_count, new.element_count)
  end)

  it("is a grid, and says so", function()
    assert.equal(240, beam.element_count)
    check.near(0.01, beam.volume, 1e-12)
    check.near(0.01, beam.volumes:sum(), 1e-12)
    assert.equal("mesh of 240 tet4 and 99 nodes, 1000 x 100 x 100 mm from (0, 0, 0) mm", tostring(beam))
    assert.equal(1, beam.elements:min())
    assert.equal(99, beam.elements:max())
    assert.equal(1, beam.component_count)
    local quality = beam:quality()
    assert.truthy(quality.dihedral_min > 0.3 and quality.dihedral_max < 3)
  end)

  it("changes order, size and extent", function()
    local fine = assert(beam:with_order(2))
    assert.equal(10, fine.elements.column_count)
    assert.equal(99, fine:with_order(1).node_count)
    check.near(0.08, beam:scale(2).volume, 1e-12)
    local half = assert(beam:subset(beam:to_nodes(beam.volumes):map("a*0 + 1") and
      bw.array.range(1, 240):below(121)))
    assert.equal(120, half.element_count)
    check.fails("geometry", "", beam:moved(beam.nodes * -1))
    check.raises("rows expected, one for each node", beam.moved, beam, {{1, 2, 3}})
  end)

  it("finds points", function()
    local element, weights, inside = beam:locate {0.5, 0.05, 0.01}
    assert.is_true(inside)
    local x = 0
    for i, w in ipairs(weights) do x = x + w * beam.nodes(beam.elements(element, i), 1) end
    check.near(0.5, x, 1e-12)
    assert.is_false(select(3, beam:locate {2, 0, 0}))
  end)

  it("brings values of elements to nodes", function()
    local ones = beam.volumes:map "a*0 + 3"
    check.near(3, beam:to_nodes(ones):min(), 1e-14)
    local marked = bw.array.range(1, 240):map "where(a == 7, 5, 0)"
    assert.equal(5, beam:to_nodes(marked, "max"):max())
    assert.equal(4, beam:to_nodes(marked, "max"):above(0):where().row_count)
  end)

  it("has a boundary surface", function()
    local surface, nodes = beam:surface()
    check.near(0.01, surface.volume, 1e-12)
    assert.equal(surface.point_count, #nodes)
    assert.truthy((beam.nodes:gather(nodes) - surface.points):norm() == 0)
    check.near(0.42, beam.boundary.area, 1e-12)
  end)

  it("goes through files with fields", function()
    local folder = check.folder()
    local fields = {u = beam.nodes, mark = {beam.volumes, on = "elements"}}
    for _, name in ipairs {"m.vtu", "m.msh", "m.mesh", "m.node", "m.inp"} do
      assert(beam:write(folder .. "/" .. name, {fields = fields}))
      local back, file = assert(bw.mesh.read(folder .. "/" .. name))
      assert.same(beam.elements:totable(), back.elements:totable())
      assert.truthy((beam.nodes - back.nodes):norm() < 1e-7)
      if name == "m.vtu" then
        assert.equal(beam.nodes:tostring "<f8", file.fields.u:tostring "<f8")
        assert.equal(240, #file.fields.mark)
      end
    end
    local inches = assert(bw.mesh.read(folder .. "/m.mesh", {unit = "in"}))
    check.near(0.01 * 0.0254 ^ 3, inches.volume, 1e-9)
    check.raises("field 'u': a row for each of 99 nodes or 240 elements expected, got 3 rows", beam.write, beam,
      folder .. "/x.vtu", {fields = {u = bw.array {1, 2, 3}}})
    check.fails("format", "", bw.mesh.read(check.root .. "/README.md"))
  end)

  it("is made from tables", function()
    local one = assert(bw.mesh.new {nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      elements = {{1, 3, 2, 4}}})
    check.near(1 / 6, one.volume, 1e-14)
    check.fails("geometry", "", bw.mesh.new {nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
      elements = {{1, 2, 3, 4}}})
    check.raises("rows of 4 numbers", bw.mesh.new, {nodes = {{0, 0, 0}}, elements = {{1, 2, 3}}})
  end)

  it("is filled from a surface", function()
    local surface = bw.surface.sphere {radius = 0.05, subdivisions = 3}
    local ball, log = assert(bw.mesh.fill(surface, {elements = 2000}))
    check.near(2000, ball.element_count, 0.2)
    check.near(surface.volume, ball.volume, 0.03)
    assert.is_false(log.repaired)
    assert.truthy(log.attempts >= 1)
    local near = assert(bw.mesh.fill(surface, {size = "where(x > 0, 0.01, 0.03)"}))
    assert.truthy(near.element_count > 100)
    local by_function, message = bw.mesh.fill(surface, {size = function(x)
      return x > 0 and 0.01 or 0.03
    end})
    assert(by_function, message)
    assert.equal(near.element_count, by_function.element_count)
    check.raises("did you mean 'elements'", bw.mesh.fill, surface, {elemets = 5})
    check.raises("a whole number of at least 0 expected, got -5", bw.mesh.fill, surface, {elements = -5})
  end)
end)

describe("a filled ball", function()
  local radius = 0.02
  local ball = assert(bw.surface.implicit("(x * x + y * y + z * z) / 4e-4 - 1 + 0.02 * sin(300 * x)", {
    min = {-0.03, -0.03, -0.03}, max = {0.03, 0.03, 0.03}, cells = 60}))
  local top = {0, 0, radius}

  local function distance(node, at)
    return math.sqrt((node[1] - at[1]) ^ 2 + (node[2] - at[2]) ^ 2 + (node[3] - at[3]) ^ 2)
  end

  it("says by how much its surface was moved", function()
    local mesh, log = assert(bw.mesh.fill(ball, {elements = 300}))
    assert.is_true(log.surface_moved > 0)
    assert.equal(log.surface_moved, mesh.surface_moved)
    assert.equal(log.surface_moved, mesh:with_order(2).surface_moved)
    assert.truthy(tostring(mesh):find(("surface moved by up to %.4g mm"):format(1e3 * log.surface_moved), 1, true))
    local part = bw.model {mesh = mesh, material = bw.material.pla}
    assert.equal(log.surface_moved, part.mesh.surface_moved)
    local box = assert(bw.surface.box {min = {0, 0, 0}, max = {1, 1, 1}})
    for _, exact in ipairs {assert(bw.mesh.fill(box, {elements = 300})), check.beam()} do
      assert.equal(0, exact.surface_moved)
      assert.is_nil(tostring(exact):find("moved", 1, true))
    end
  end)

  it("repeats a filling by the edge length in its log", function()
    local mesh, log = assert(bw.mesh.fill(ball, {elements = 1500}))
    local again = assert(bw.mesh.fill(ball, {edge_length = log.edge_length}))
    check.near(mesh.element_count, again.element_count, 0.3)
    check.raises("give a length in m, or a number of elements", bw.mesh.fill, ball, {edge_length = 1e-3,
      elements = 100})
  end)

  it("follows the surface more closely near a point", function()
    local length, near = 0.012, 0.0015
    local coarse = assert(bw.mesh.fill(ball, {edge_length = length}))
    local fine = assert(bw.mesh.fill(ball, {edge_length = length,
      near = {{at = top, radius = 0.004, length = near}}}))
    -- The largest distance from the zero set, by its value over its slope of 2 / radius, of the centroids of
    -- facets.
    local function away(mesh)
      local surface, max = mesh:surface(), 0
      for _, t in ipairs(surface.triangles:totable()) do
        local at = {0, 0, 0}
        for k = 1, 3 do
          for i = 1, 3 do at[k] = at[k] + surface.points(t[i], k) / 3 end
        end
        if distance(at, top) < 0.004 then
          local value = (at[1] ^ 2 + at[2] ^ 2 + at[3] ^ 2) / 4e-4 - 1 + 0.02 * math.sin(300 * at[1])
          max = math.max(max, math.abs(value) * radius / 2)
        end
      end
      return max
    end
    assert.is_true(away(fine) < 0.3 * away(coarse), ("%g %g"):format(away(fine), away(coarse)))
    assert.is_true(away(fine) < 0.1 * near, away(fine))
  end)

  it("stops being remeshed when its progress is answered with false", function()
    local calls = 0
    bw.progress(function()
      calls = calls + 1
      return calls < 3
    end)
    local made, message = bw.surface.box {min = {0, 0, 0}, max = {1, 1, 1}}:remesh {triangles = 200000,
      iterations = 1}
    bw.progress(nil)
    assert.is_nil(made)
    assert.equal("cancelled", message)
    assert.equal(3, calls)
  end)

  it("stops filling with very many elements while TetGen works", function()
    local box, reports = assert(bw.surface.box {min = {0, 0, 0}, max = {0.1, 0.05, 0.05}}), 0
    bw.progress(function(stage)
      if stage == "filling" then reports = reports + 1 end
      return reports < 4 -- the fourth comes while TetGen works
    end)
    check.fails("cancelled", "", bw.mesh.fill(box, {remesh = false, max_volume = 1e-11}))
    bw.progress(nil)
  end)
end)

describe("a selection", function()
  local beam = check.beam()
  local all = beam.boundary

  it("is geometric", function()
    assert.equal(9, all:below(1, 0).node_count)
    check.near(0.01, all:below("x", 0).area, 1e-12)
    assert.equal(9, all:above(1, 1).node_count)
    assert.equal(9, all:plane({1, 0, 0}, {1, 0, 0}).node_count)
    assert.equal(1, all:near({0, 0, 0}, 0.01).node_count)
    assert.equal(1, all:sphere({0, 0, 0}, 0.01).node_count)
    assert.equal(9, all:box({-1, -1, -1}, {0.01, 1, 1}).node_count)
    check.near(0.1, all:facing({0, 0, 1}, 0.1).area, 1e-12)
    check.near(0.1, all:patch({0.5, 0.05, 0.1}, 0.5).area, 1e-12)
    assert.equal(4, all:nearest({0, 0, 0}, 4).node_count)
    assert.equal(9, all:beyond({0.99, 0, 0}, {1, 0, 0}).node_count)
    local top = all:facing {0, 1, 0}
    check.near(1, top.normal[2], 1e-12)
    check.near(0.5, top.centre[1], 1e-12)
    assert.equal(beam, top.mesh)
  end)

  it("takes a predicate: formula, mask, function", function()
    local formula = all:where "x < 0.05 and z > 0.09"
    local fn = all:where(function(x, _, z) return x < 0.05 and z > 0.09 end)
    local mask = all:where(beam.nodes:map "a.x < 0.05 and a.z > 0.09")
    assert.same(formula.nodes:totable(), fn.nodes:totable())
    assert.same(formula.nodes:totable(), mask.nodes:totable())
    assert.equal(3, formula.node_count)
    local facets = bw.array.range(1, beam.facet_count):below(3)
    assert.equal(2, all:where(facets).facet_count)
    check.raises("unknown name 'w'", all.where, all, "w > 1")
  end)

  it("is joined, cut and narrowed", function()
    local left, right, top = all:below(1, 0), all:above(1, 1), all:above(3, 0.1)
    assert.equal(18, (left | right).node_count)
    assert.equal(3, (left & top).node_count)
    assert.equal(all.facet_count - 8, (all - left).facet_count)
    assert.equal(3, left:above(3, 0.1).node_count) -- within what it is called on
    assert.equal(2, top:nearest({0, 0, 0}, 2).node_count) -- of its own nodes, not of all
    check.near(0.1, beam.nodes(top:nearest({0, 0, 0}).nodes[1], 3), 1e-12)
    assert.same((left | top).nodes:totable(), left:union(top).nodes:totable())
    check.raises("same mesh", left.union, left, check.beam().boundary)
  end)

  it("raises when it is empty, and reports where the mesh is", function()
    check.raises("", all.near, all, {5, 5, 5}, 0.1)
    local ok, message = pcall(all.near, all, {5, 5, 5}, 0.1)
    assert.is_false(ok)
    assert.truthy(message:find "nearest")
    check.raises("", function() return all:below(1, 0) & all:above(1, 1) end)
    check.raises("an axis, 1, 2, 3 or", all.below, all, 4, 0)
    check.raises("three finite numbers", all.near, all, {1, 2}, 0.1)
    check.raises("selection expected", bw.model({mesh = beam,
      material = bw.material.steel}).fix, bw.model {mesh = beam, material = bw.material.steel})
  end)
end)
