-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Cyclic symmetry in Lua: a sector beside the whole wheel of its turned copies, what is printed, and misuse.
local bw = require "barwright"
local check = require "check"

local pi = math.pi

-- The axis of all wheels: through a point, in a direction of no coordinate.
local about, axis = {0.3, -0.2, 0.1}, {2 / 3, -1 / 3, 2 / 3}
local one = {1 / math.sqrt(5), 2 / math.sqrt(5), 0}
local two = {axis[2] * one[3] - axis[3] * one[2], axis[3] * one[1] - axis[1] * one[3],
  axis[1] * one[2] - axis[2] * one[1]}

local function vector(x, y, z)
  local v = {}
  for k = 1, 3 do v[k] = x * one[k] + y * two[k] + z * axis[k] end
  return v
end
local function place(x, y, z)
  local v = vector(x, y, z)
  for k = 1, 3 do v[k] = v[k] + about[k] end
  return v
end

-- A ring sector of n: {cells}, radii, which cells stay (a hole, a tooth), order and a seed that moves the nodes
-- inside.
-- Places are {radius, angle, height}; those of the faces move alike.
local function ring(n, cells, order, seed, keep)
  local box = bw.mesh.box {max = {1, 1, 1}, cells = cells, order = 1}
  local random, moved, unit = check.random(seed), {}, box.nodes:totable()
  local of_face = {}
  for i, p in ipairs(unit) do
    local r, t, z = p[1], p[2], p[3]
    local key = ("%.6f %.6f"):format(r, z)
    local d = {random() - 0.5, random() - 0.5, random() - 0.5}
    if t < 1e-9 or t > 1 - 1e-9 then
      of_face[key] = of_face[key] or d
      d = {of_face[key][1], 0, of_face[key][3]}
    end
    r = 1 + r + 0.3 * d[1] / cells[1]
    t = t + 0.3 * d[2] / cells[2]
    z = 0.4 * z + 0.1 * d[3] / cells[3] + 0.1 * math.sin(2 * r)
    moved[i] = {r, t, z}
  end
  for i, p in ipairs(moved) do
    local angle = 2 * pi / n * p[2]
    moved[i] = place(p[1] * math.cos(angle), p[1] * math.sin(angle), p[3])
  end
  local mesh = assert(box:moved(moved))
  if keep then
    local mask = {}
    for e, row in ipairs(mesh.elements:totable()) do
      local r, t, z = 0, 0, 0
      for a = 1, 4 do r, t, z = r + unit[row[a]][1] / 4, t + unit[row[a]][2] / 4, z + unit[row[a]][3] / 4 end
      local function middle(x, count) return (math.floor(x * count) + 0.5) / count end -- of the cell
      mask[e] = keep(middle(r, cells[1]), middle(t, cells[2]), middle(z, cells[3])) and 1 or 0
    end
    mesh = assert(mesh:subset(bw.array.new(mask)))
  end
  return order == 2 and assert(mesh:with_order(2)) or mesh
end

-- A solid wedge of n that reaches the axis: a parallelogram, extruded.
local function wedge(n, cells, order)
  local box = bw.mesh.box {max = {1, 1, 0.5}, cells = cells, order = 1}
  local moved, angle = {}, 2 * pi / n
  for i, p in ipairs(box.nodes:totable()) do
    moved[i] = place(p[1] + p[2] * math.cos(angle), p[2] * math.sin(angle), p[3] + 0.1 * p[1] + 0.1 * p[2])
  end
  local mesh = assert(box:moved(moved))
  return order == 2 and assert(mesh:with_order(2)) or mesh
end

local function polar_of(x)
  local y = {x[1] - about[1], x[2] - about[2], x[3] - about[3]}
  local function dot(v) return y[1] * v[1] + y[2] * v[2] + y[3] * v[3] end
  local a, b = dot(one), dot(two)
  return math.sqrt(a * a + b * b), math.atan(b, a), dot(axis)
end

local function turned(x, angle)
  local r, t, z = polar_of(x)
  return place(r * math.cos(t + angle), r * math.sin(t + angle), z)
end

-- `count` copies of a mesh in one, each turned by an angle more, welded where nodes coincide. Also the numbers
-- of the
-- first one's nodes.
local function copies(mesh, count, angle)
  local nodes, known, elements, first = {}, {}, {}, {}
  for s = 0, count - 1 do
    local number = {}
    for i, p in ipairs(mesh.nodes:totable()) do
      local x = turned(p, s * angle)
      local key = ("%d %d %d"):format(math.floor(x[1] * 1e6 + 0.5), math.floor(x[2] * 1e6 + 0.5),
        math.floor(x[3] * 1e6 + 0.5))
      if not known[key] then
        nodes[#nodes + 1] = x
        known[key] = #nodes
      end
      number[i] = known[key]
      if s == 0 then first[i] = number[i] end
    end
    for _, e in ipairs(mesh.elements:totable()) do
      local row = {}
      for k, node in ipairs(e) do row[k] = number[node] end
      elements[#elements + 1] = row
    end
  end
  return assert(bw.mesh.new {nodes = nodes, elements = elements, order = #elements[1] == 10 and 2 or 1}), first
end

-- Boundary facets by their polar places: test(radius, angle, height) at all corners of a facet.
local function where(mesh, test)
  local nodes, mask = mesh.nodes:totable(), {}
  for i, p in ipairs(nodes) do mask[i] = test(polar_of(p)) and 1 or 0 end
  return assert(mesh.boundary:where(bw.array.new(mask)))
end

local function face(mesh, angle)
  return where(mesh, function(r, t) return r < 1e-9 or math.abs(t - angle) < 1e-9 end)
end

local function sector(mesh, n, from)
  from = from or 0
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  assert(part:cyclic {low = face(mesh, from), high = face(mesh, from + 2 * pi / n), count = n, axis = axis,
    about = about})
  return part
end

local function hole(r, t, z)
  return not (r > 0.3 and r < 0.6 and t > 0.3 and t < 0.6) and not (r > 0.6 and (t < 0.3 or t > 0.7)) and
    not (r > 0.6 and t > 0.5 and z > 0.5)
end

-- Sectors, with what their wheel is held by and loaded with: the same function on the sector and on the wheel.
local function bore(mesh) return where(mesh, function(r) return r < 1.06 end) end
local function below(mesh) -- around the axis
  return mesh.boundary:facing({-axis[1], -axis[2], -axis[3]}, 0.9):intersection(where(mesh,
    function(r) return r < 0.7 end))
end
local cases = {
  {name = "ring of 7, tet4", n = 7, mesh = ring(7, {3, 3, 2}, 1, 41), hold = bore},
  {name = "teeth and holes, 5, tet10", n = 5, mesh = ring(5, {4, 5, 2}, 2, 7, hole), hold = bore},
  {name = "teeth and holes, 6, tet4", n = 6, mesh = ring(6, {5, 6, 2}, 1, 97, hole), hold = bore},
  {name = "ring of 2, tet10", n = 2, mesh = ring(2, {1, 8, 1}, 2, 5), hold = bore},
  {name = "solid wedge of 5, tet10", n = 5, mesh = wedge(5, {2, 2, 1}, 2), hold = below},
  {name = "solid wedge of 4, tet4", n = 4, mesh = wedge(4, {3, 3, 2}, 1), hold = below},
  {name = "solid wedge of 2, tet4", n = 2, mesh = copies(wedge(4, {3, 3, 2}, 1), 2, pi / 2), hold = below},
}

-- Surfaces that all sectors share.
local function outer(mesh) return where(mesh, function(r) return r > 1.85 end) end
local function top(mesh) return mesh.boundary:facing(axis, 0.9) end

local function load(part, mesh)
  part:load {on = top(mesh), pressure = 3e6}
  part:gravity(vector(0, 0, 50))
  part:temperature(30, 1.2e-5)
end

local function largest(a) return math.max(a:max(), -a:min()) end

describe("cyclic symmetry", function()
  for _, case in ipairs(cases) do
    local n, mesh = case.n, case.mesh
    it("has the displacement and the stress of the wheel, " .. case.name, function()
      local part = sector(mesh, n)
      part:fix(case.hold(mesh))
      load(part, mesh)
      local all, first = copies(mesh, n, 2 * pi / n)
      local wheel = bw.model {mesh = all, material = bw.material.steel}
      wheel:fix(case.hold(all))
      load(wheel, all)
      local a, b = assert(part:solve()), assert(wheel:solve {solver = bw.solver.cholesky {}})
      check.near(all.volume, n * mesh.volume, 1e-12)
      local rows, far = a.displacement, 0
      for i = 1, mesh.node_count do
        for k = 1, 3 do far = math.max(far, math.abs(rows(i, k) - b.displacement(first[i], k))) end
      end
      assert.is_true(far < 1e-9 * largest(b.displacement), far / largest(b.displacement))
      check.near(b.energy, n * a.energy, 1e-9)
      far = 0
      local own, its = a.element_stress, b.element_stress -- the wheel begins with the elements of the sector
      for e = 1, mesh.element_count do
        for k = 1, 6 do far = math.max(far, math.abs(own(e, k) - its(e, k))) end
      end
      assert.is_true(far < 1e-8 * largest(its), far / largest(its))
      local whole = assert(a:whole())
      check.near(b.von_mises:max(), whole.von_mises:max(), 1e-8)
      check.near(b.von_mises:mean(), whole.von_mises:mean(), 1e-8)
      check.near(b.energy, whole.energy, 1e-9)
      for k = 1, 3 do -- the bearing of the wheel
        local r = largest(b.reaction)
        assert.is_true(math.abs(b.reaction:column(k):sum() - whole.reaction:column(k):sum()) < 1e-8 * r * n)
      end
      check.near(largest(b.reaction), largest(whole.reaction), 1e-7)
    end)

    it("has the modes of the wheel, " .. case.name, function()
      for free = 0, 1 do
        local part = sector(mesh, n)
        local all = copies(mesh, n, 2 * pi / n)
        local wheel = bw.model {mesh = all, material = bw.material.steel}
        if free == 0 then
          part:fix(case.hold(mesh))
          wheel:fix(case.hold(all))
        end
        local a, b = assert(part:modes {count = 20, tolerance = 1e-10}), assert(wheel:modes {count = 20,
          tolerance = 1e-10})
        assert.equal(b.rigid_count, a.rigid_count)
        assert.equal(free * 6, a.rigid_count)
        assert.is_true(a.counted)
        for i = 1, 20 do check.near(b.eigenvalues[i], a.eigenvalues[i], 1e-8) end
        local whole = assert(a:whole())
        check.near(all.volume, whole.mesh.volume, 1e-12)
      end
    end)
  end

  -- A blade on the upper face of a hub, whose meshes do not match. Its foot ends inside the sector.
  local function block(cells, order, r0, r1, t0, t1, z0, z1)
    local box = bw.mesh.box {max = {1, 1, 1}, cells = cells, order = 1}
    local nodes = box.nodes:totable()
    for i, p in ipairs(nodes) do
      local r, t = r0 + (r1 - r0) * p[1], t0 + (t1 - t0) * p[2]
      nodes[i] = place(r * math.cos(t), r * math.sin(t), z0 + (z1 - z0) * p[3])
    end
    local mesh = assert(box:moved(nodes))
    return order == 2 and assert(mesh:with_order(2)) or mesh
  end

  local function bladed(n, order, from, to)
    local angle = 2 * pi / n
    local nodes, elements = {}, {}
    for _, body in ipairs {block({2, 4, 1}, order, 1, 2, 0, angle, 0, 0.3),
      block({2, 2, 2}, order, 1.3, 1.8, from * angle, to * angle, 0.3, 1.1)} do
      local before = #nodes
      for _, p in ipairs(body.nodes:totable()) do nodes[#nodes + 1] = p end
      for _, e in ipairs(body.elements:totable()) do
        for k, node in ipairs(e) do e[k] = node + before end
        elements[#elements + 1] = e
      end
    end
    return assert(bw.mesh.new {nodes = nodes, elements = elements, order = order})
  end

  local function glued(part, mesh)
    local function side(sign)
      return mesh.boundary:facing({sign * axis[1], sign * axis[2], sign * axis[3]}, 0.9):intersection(
        where(mesh, function(_, _, z) return math.abs(z - 0.3) < 1e-9 end))
    end
    assert(part:bond {a = side(-1), b = side(1)})
    return part
  end

  for order = 1, 2 do
    it("takes bonds inside a sector: those of the wheel, order " .. order, function()
      local n = 5
      local mesh = bladed(n, order, 0.3, 0.8)
      local part = glued(sector(mesh, n), mesh)
      local all, first = copies(mesh, n, 2 * pi / n)
      local wheel = glued(bw.model {mesh = all, material = bw.material.steel}, all)
      for _, pair in ipairs {{part, mesh}, {wheel, all}} do
        local model, its = pair[1], pair[2]
        model:fix(bore(its)):load {on = where(its, function(_, _, z) return z > 1.05 end), pressure = 2e6}
        model:gravity(vector(0, 0, 50))
        model:load {on = where(its, function(r, _, z) return r > 1.75 and r < 1.85 and z > 0.25 end),
          pressure = 5e6}
      end
      local a, b = assert(part:solve()), assert(wheel:solve())
      local far = 0
      for i = 1, mesh.node_count do
        for k = 1, 3 do far = math.max(far, math.abs(a.displacement(i, k) - b.displacement(first[i], k))) end
      end
      assert.is_true(far < 1e-8 * largest(b.displacement), far / largest(b.displacement))
      check.near(b.energy, n * a.energy, 1e-8)
      for _, of in ipairs {assert(a:whole()), assert(assert(part:whole()):solve())} do
        check.near(b.energy, of.energy, 1e-8)
        check.near(b.von_mises:max(), of.von_mises:max(), 1e-7)
        local size, its = 0, b.bonds[1]
        for k = 1, 3 do size = math.max(size, math.abs(its.force[k]), math.abs(its.moment[k])) end
        for k = 1, 3 do
          assert.is_true(math.abs(its.force[k] - of.bonds[1].force[k]) < 1e-7 * size)
          assert.is_true(math.abs(its.moment[k] - of.bonds[1].moment[k]) < 1e-7 * size)
          local r, s = b.reaction:column(k):sum(), of.reaction:column(k):sum()
          assert.is_true(math.abs(r - s) < 1e-7 * largest(b.reaction) * n)
        end
      end
      local whole = assert(a:whole())
      check.fails("unsupported", "no forces of bonds", whole:joint_traction {bond = 1})
      check.fails("unsupported", "support 1 meets a cut face of the sector", a:joint_traction {support = 1})
      check.near(assert(b:joint_traction {support = 1}).normal:max(),
        assert(whole:joint_traction {support = 1}).normal:max(), 1e-6)
      for held = 0, 1 do
        local own = glued(sector(mesh, n), mesh)
        local other = glued(bw.model {mesh = all, material = bw.material.steel}, all)
        if held == 1 then
          own:fix(bore(mesh))
          other:fix(bore(all))
        end
        local x = assert(own:modes {count = 12, tolerance = 1e-10})
        local y = assert(other:modes {count = 12, tolerance = 1e-10})
        assert.equal(held == 1 and 0 or 6, x.rigid_count)
        assert.equal(y.rigid_count, x.rigid_count)
        for i = 1, 12 do check.near(y.eigenvalues[i], x.eigenvalues[i], 1e-8) end
      end
      assert.truthy(tostring(part):find("bond", 1, true))
    end)
  end

  it("refuses bonds that reach a cut, and preloads", function()
    local mesh = bladed(5, 1, 0, 1)
    local part = sector(mesh, 5)
    glued(part, mesh):fix(bore(mesh)):gravity(vector(0, 0, 50))
    check.fails("unsupported", "side a of bond 1 meets a cut face of the sector", part:solve())
    check.fails("unsupported", "side a of bond 1 meets a cut face of the sector", part:modes())
    local pulled, boundary = bw.model {mesh = mesh, material = bw.material.steel}, mesh.boundary
    local function side(sign)
      return boundary:facing({sign * axis[1], sign * axis[2], sign * axis[3]}, 0.9):intersection(
        where(mesh, function(_, _, z) return math.abs(z - 0.3) < 1e-9 end))
    end
    assert(pulled:bond {a = side(-1), b = side(1), preload = 1})
    check.fails("unsupported", "bond 1 has a preload", pulled:cyclic {low = face(mesh, 0),
      high = face(mesh, 2 * pi / 5), count = 5, axis = axis, about = about})
  end)

  it("makes the model of the wheel", function()
    for order = 1, 2 do
      local mesh = ring(7, {4, 4, 2}, order, 3)
      local part = bw.model {mesh = mesh, material = bw.material.orthotropic {young = {10e9, 3e9, 5e9},
        poisson = {0.3, 0.2, 0.25}, shear = {1e9, 2e9, 1.5e9}, density = 500}}
      assert(part:cyclic {low = face(mesh, 0), high = face(mesh, 2 * pi / 7), count = 7, axis = axis,
        about = about})
      part:slide(where(mesh, function(r) return r < 1.06 end), axis)
      part:attach {on = bore(mesh), spring = {1e9, 1e9, 1e9}}
      part:attach {on = top(mesh), mass = 7}
      part:load {on = outer(mesh), traction = {1e5, 2e5, -1e5}}
      part:load {on = top(mesh), torque = {1e3, 2e3, 0}}
      part:load {on = top(mesh), force = {0, 1e4, 0}}
      part:gravity(vector(0, 0, 10))
      local wheel = assert(part:whole())
      assert.is_nil(wheel.cyclic_symmetry)
      local a, b = assert(assert(part:solve()):whole()), assert(wheel:solve())
      local function same(x, y, tolerance)
        local far = 0
        for i = 1, wheel.mesh.node_count do
          for k = 1, 3 do far = math.max(far, math.abs(x(i, k) - y(i, k))) end
        end
        assert.is_true(far < tolerance * largest(y), far / largest(y))
      end
      same(a.displacement, b.displacement, 1e-8)
      same(a.force, b.force, 1e-9)
      same(a.reaction, b.reaction, 1e-7)
      check.near(b.energy, a.energy, 1e-8)
      check.near(b.von_mises:max(), a.von_mises:max(), 1e-7)
    end
  end)

  it("takes faces in either order, and an axis that looks either way", function()
    local mesh = ring(5, {2, 3, 1}, 1, 11)
    local values = {}
    for i = 1, 2 do
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      local faces = {face(mesh, 0), face(mesh, 2 * pi / 5)}
      assert(part:cyclic {low = faces[i], high = faces[3 - i], count = 5, axis = axis, about = about})
      values[i] = assert(part:modes {count = 6, nodal_diameter = 2}).eigenvalues
      local found = part.cyclic_symmetry
      check.near(i == 1 and axis[1] or -axis[1], found.axis[1], 1e-12)
    end
    for i = 1, 6 do check.near(values[1][i], values[2][i], 1e-8) end
  end)

  it("is listed and printed", function()
    local mesh = wedge(5, {2, 2, 1}, 2)
    local part = sector(mesh, 5)
    local found = part.cyclic_symmetry
    assert.equal(5, found.count)
    assert.equal(3, found.axis_node_count)
    assert.is_true(found.distance < 1e-12)
    local text = tostring(part)
    assert.truthy(text:find("cyclic symmetry: one of 5 sectors about the axis through (0.3, -0.2, 0.1) m", 1,
      true), text)
    assert.truthy(text:find("3 nodes on it", 1, true), text)
    assert.truthy(text:find("2 rigid-body modes that all sectors share unconstrained", 1, true), text)
    local modes = assert(part:modes {count = 4})
    assert.equal(4, #modes.nodal_diameters)
    assert.truthy(tostring(modes):find("6 rigid-body motions left out, none missing", 1, true), tostring(modes))
    part:clear_cyclic()
    assert.is_nil(part.cyclic_symmetry)
  end)

  it("is refused where it does not fit", function()
    local mesh = ring(8, {2, 2, 1}, 1, 23)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    local low, high = face(mesh, 0), face(mesh, pi / 4)
    local function cyclic(change)
      local options = {low = low, high = high, count = 8, axis = axis, about = about}
      for key, value in pairs(change) do options[key] = value end
      return part:cyclic(options)
    end
    check.fails("geometry",
      "45 degrees apart about the axis, but those of 9 sectors are 40 degrees apart: give 8 sectors",
      cyclic {count = 9})
    check.fails("geometry", "do not match", cyclic {about = {0, 0, 0}})
    -- faces as good as parallel: no guess of millions of sectors
    local box = bw.mesh.box {min = {-1, -1, 0}, max = {1, 1, 1}, cells = {2, 2, 1}}
    local moved = {}
    for i, p in ipairs(box.nodes:totable()) do moved[i] = {p[1], p[2] * (1 + 1e-9 * p[1]), p[3]} end
    box = assert(box:moved(moved))
    check.fails("geometry", "degrees apart: give another axis", bw.model {mesh = box, material = bw.material.steel}
      :cyclic {low = box.boundary:facing {0, -1, 0}, high = box.boundary:facing {0, 1, 0}, count = 100000,
        axis = {0, 0, 1}})
    check.fails("geometry", "degrees apart: give another axis", cyclic {high = outer(mesh)})
    check.fails("geometry", "degrees apart: give another axis", cyclic {high = high:union(outer(mesh))})
    local part_of = low:intersection(where(mesh, function(r) return r < 1.7 end))
    check.fails("geometry", "the low one has 4 nodes and 2 facets, the high one 6 and 4", cyclic {low = part_of})
    check.raises("2 or more sectors", cyclic, {count = 1})
    check.raises("direction other than", cyclic, {axis = {0, 0, 0}})
    check.raises("'count' is missing", function() part:cyclic {low = low, high = high} end)
    check.raises("an open selection", function() part:cyclic {low = low, count = 8} end)
    assert(cyclic {})
    check.raises("has a cyclic symmetry already", cyclic, {})
    check.fails("unsupported", "one of 8 sectors", bw.edit(part))
    check.fails("unsupported", "takes no preloads", part:bond {a = low, b = outer(mesh), preload = 1})
    check.fails("unsupported", "one of 8 sectors", part:system())
    check.fails("unconstrained", "2 rigid-body modes unconstrained that all sectors share", part:solve())
    check.raises('"all" or', function() part:modes {nodal_diameter = 1.5} end)
    check.raises("has 0 to 4", function() part:modes {nodal_diameter = 5} end)
    check.raises("modes of the Laplacian", function() part:modes {laplacian = true} end)
    local whole = bw.model {mesh = mesh, material = bw.material.steel}
    check.raises("goes with cyclic symmetry only", function() whole:modes {nodal_diameter = 1} end)
    check.raises("this is the whole already", function() whole:whole() end)
  end)

  it("refuses an error of the modes before it computes any", function()
    local part = sector(cases[1].mesh, cases[1].n)
    check.fails("unsupported", "part:whole()", part:modes {error = 0.01})
  end)

  it("refuses what differs from sector to sector", function()
    local mesh = ring(8, {2, 2, 1}, 1, 23)
    local function fresh()
      local part = sector(mesh, 8)
      part:fix(bore(mesh))
      part:load {on = top(mesh), pressure = 1e5}
      return part
    end
    local part = fresh():fix(face(mesh, 0))
    check.raises("has other supports than its partner on the low face", function() part:solve() end)
    check.raises("has other supports than its partner on the low face", function() part:modes() end)
    part = fresh():gravity {0, 0, 10}
    check.raises("load 2 is gravity across the axis", function() part:solve() end)
    part = fresh():load {on = face(mesh, 0), pressure = 1e5}
    check.raises("load 2 acts on a face of the sector that lies inside the whole", function() part:solve() end)
    local change = {}
    for i, x in ipairs(mesh.nodes:totable()) do change[i] = 10 * x[1] end
    part = fresh():temperature(bw.array.new(change))
    check.raises("has another temperature than its partner", function() part:solve() end)
    local solid = sector(wedge(4, {2, 2, 1}, 1), 4)
    local rim = where(solid.mesh, function(r) return r < 1e-9 end):node_set()
    solid:slide(rim, one)
    check.raises("is on the axis, and its supports are not the same after a turn", function() solid:modes() end)
  end)

  it("refuses an axis that passes elements away from their edges", function()
    -- half a block whose middle cells cross the axis, its faces on either side of them
    local nodes, elements = {}, {}
    for side = -1, 1 do
      local low, high = side == 0 and -0.2 or 0.2, side == 0 and 0.2 or 1
      local box = bw.mesh.box {min = {low, 0, 0}, max = {high, 1, 1}, cells = {1, 2, 2}}
      local before = #nodes
      for _, p in ipairs(box.nodes:totable()) do nodes[#nodes + 1] = place(side == -1 and -p[1] or p[1], p[2],
        p[3]) end
      for _, e in ipairs(box.elements:totable()) do
        local row = {}
        for k, node in ipairs(e) do row[k] = node + before end
        elements[#elements + 1] = row
      end
    end
    local mesh = copies(assert(bw.mesh.new {nodes = nodes, elements = elements}), 1, 0)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    local function half(sign)
      return where(mesh, function(r, t)
        return r > 0.1 and math.abs(r * math.sin(t)) < 1e-9 and sign * math.cos(t) > 0
      end)
    end
    check.fails("geometry", "is a corner of a facet that the axis passes",
      part:cyclic {low = half(1), high = half(-1), count = 2, axis = axis, about = about})
  end)
end)
