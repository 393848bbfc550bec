-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Systems as sparse matrices: what the matrices are, by physics, and that they give the solutions of the part.
local bw = require "barwright"
local check = require "check"

-- Plain conjugate gradients, over any matrix.
local function solve(a, b)
  local x, r = b * 0, b:copy()
  local p, rr = r:copy(), r:dot(r)
  local start = rr
  for _ = 1, 20 * a.row_count do
    if rr <= 1e-28 * start then break end
    local q = a:apply(p)
    local alpha = rr / p:dot(q)
    x, r = x + p * alpha, r - q * alpha
    local next_rr = r:dot(r)
    p, rr = r + p * (next_rr / rr), next_rr
  end
  return x
end

local function beam(order)
  return bw.mesh.box {max = {0.1, 0.02, 0.02}, cells = {5, 2, 2}, order = order}
end

describe("systems as matrices", function()
  it("hold stiffness and mass of all components", function()
    for order = 1, 2 do
      local mesh = beam(order)
      local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
      local system = assert(part:system())
      local k = assert(system:matrix("stiffness", {whole = true}))
      local m = assert(system:matrix("mass", {whole = true}))
      assert.equal(3 * mesh.node_count, k.row_count)
      assert.truthy(k.symmetric and m.symmetric)
      -- A translation along x, and a rotation about z: no force, the whole mass, its moment of inertia.
      local move, turn = {}, {}
      for i, node in ipairs(mesh.nodes:totable()) do
        move[3 * i - 2], move[3 * i - 1], move[3 * i] = 1, 0, 0
        turn[3 * i - 2], turn[3 * i - 1], turn[3 * i] = 0.01 - node[2], node[1] - 0.05, 0
      end
      move, turn = bw.array.new(move), bw.array.new(turn)
      assert.truthy(k:apply(move):norm() < 1e-9 * bw.material.steel.young * 0.1)
      assert.truthy(k:apply(turn):norm() < 1e-9 * bw.material.steel.young * 0.1)
      local mass = bw.material.steel.density * mesh.volume
      check.near(move:dot(m:apply(move)), mass, 1e-12)
      check.near(turn:dot(m:apply(turn)), mass * (0.1 ^ 2 + 0.02 ^ 2) / 12, order == 2 and 1e-12 or 1e-9)
    end
  end)

  it("give the solution of the part, with supports along normals and prescribed displacements", function()
    local mesh = beam(1)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:prescribe(mesh.boundary:below("x", 0), {1e-6, 0, 2e-6})
    part:slide(mesh.boundary:above("x", 0.1), {1, 0.2, 0.1})
    part:load {on = mesh.boundary:above("z", 0.02), force = {100, 50, -20}}
    local system, solved = assert(part:system()), assert(part:solve())
    local k, b = assert(system:matrix "stiffness"), system:right_hand_side(part:force_vector())
    assert.equal(system.unknown_count, k.row_count)
    assert.equal(system.unknown_count, b.row_count)
    assert.truthy(k.symmetric)
    local u = system:displacement(solve(k, b))
    assert.truthy((u - solved.displacement):norm() < 1e-9 * solved.displacement:norm())
  end)

  it("give natural frequencies", function()
    local mesh = beam(1)
    local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
    local system, modes = assert(part:system()), assert(part:modes {count = 3})
    local k, m = assert(system:matrix "stiffness"), assert(system:matrix "mass")
    for i = 1, 3 do
      local x = system:right_hand_side(modes:shape(i)) -- no support prescribes anything but 0: its unknowns
      check.near(math.sqrt(x:dot(k:apply(x)) / x:dot(m:apply(x))) / (2 * math.pi), modes.frequencies[i], 1e-8)
    end
  end)

  it("of a free part are positive definite by themselves", function()
    local mesh = beam(1)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    local system = assert(part:system())
    local k = assert(system:matrix "stiffness")
    assert.equal(3 * mesh.node_count - 6, k.row_count)
    local force = bw.array.zeros(mesh.node_count, 3)
    local rows = force:totable()
    rows[1][1], rows[#rows][1] = -5, -5 -- not in balance: six supports carry the rest
    local b = system:right_hand_side(bw.array.new(rows))
    local x = solve(k, b)
    assert.truthy((k:apply(x) - b):norm() < 1e-9 * b:norm())
    assert.truthy(x:dot(b) > 0)
  end)

  it("are the same in files", function()
    local mesh = beam(2)
    local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
    local system, folder = assert(part:system()), check.folder()
    for _, name in ipairs {"stiffness", "mass"} do
      local a = assert(system:matrix(name))
      for _, ending in ipairs {"mtx", "npz"} do
        local path = ("%s/%s.%s"):format(folder, name, ending)
        assert.equal(true, a:write(path))
        local back = assert(bw.sparse_matrix.read(path))
        local rows, columns, values = a:entries()
        local other_rows, other_columns, other_values = back:entries()
        assert.equal(rows:tostring "<i4", other_rows:tostring "<i4")
        assert.equal(columns:tostring "<i4", other_columns:tostring "<i4")
        assert.equal(values:tostring "<f8", other_values:tostring "<f8")
      end
    end
    local b = system:right_hand_side(part:load {on = mesh.boundary:above("x", 0.1),
      force = {0, 0, -1}}:force_vector())
    for _, ending in ipairs {"npy", "mtx"} do
      assert.equal(true, b:write(folder .. "/b." .. ending))
      assert.equal(b:tostring "<f8", assert(bw.array.read(folder .. "/b." .. ending)):tostring "<f8")
    end
  end)

  it("say what is wrong", function()
    local folder = check.folder()
    local system = assert(bw.model({mesh = beam(1), material = bw.material.steel}):system())
    check.fails("unsupported", ".mtx", system:matrix "mass":write(folder .. "/m.csv"))
    check.fails("io", "", bw.sparse_matrix.read(folder .. "/none.mtx"))
    check.write(folder .. "/bad.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 1\n1 5 3\n")
    local _, message, details = bw.sparse_matrix.read(folder .. "/bad.mtx")
    assert.truthy(message:find("bad.mtx:3: an entry at (1, 5)", 1, true), message)
    assert.equal(3, details.line)
    check.raises("entry 2 lies at (3, 1) of a matrix of 2 x 2", bw.sparse_matrix.new, 2, 2, {1, 3}, {1, 1}, {1, 1})
    check.raises("stiffness", system.matrix, system, "damping")
    check.raises("unknown", function() system:displacement {1, 2} end)
  end)
end)
