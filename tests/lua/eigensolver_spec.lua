-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- bw.eigensolver: descriptions, and each of them wherever modes are computed.
local bw = require "barwright"
local check = require "check"

local names = {"lanczos", "arpack", "lobpcg"}

local function free_part() return bw.model {mesh = check.beam({8, 2, 2}, 2), material = bw.material.steel} end

-- LOBPCG tests where it has no factor.
local function complete(modes) return modes.counted or modes.tested end

describe("eigensolvers", function()
  it("are descriptions that print and close", function()
    assert.equal("eigensolver lanczos", tostring(bw.eigensolver.lanczos()))
    assert.equal("eigensolver arpack, 60 basis vectors", tostring(bw.eigensolver.arpack {basis = 60}))
    assert.equal("eigensolver slepc", tostring(bw.eigensolver.slepc {}))
    local multigrid = bw.solver.amg {backend = "petsc"}
    assert.equal("eigensolver slepc, inner systems by pcg (amg (petsc), tolerance 1e-08)",
      tostring(bw.eigensolver.slepc {inner = bw.solver.pcg {preconditioner = multigrid, tolerance = 1e-8}}))
    local solver = bw.eigensolver.arpack {}
    assert.equal("arpack", solver.name)
    solver:close()
    check.raises("closed", free_part().modes, free_part(), {solver = solver})
  end)

  it("give the same modes of a part, and of the Laplacian", function()
    local part = free_part()
    for _, laplacian in ipairs {false, true} do
      local first
      for _, name in ipairs(names) do
        local modes = assert(part:modes {count = 8, laplacian = laplacian, solver = bw.eigensolver[name] {}})
        assert.equal(name, modes.report.solver)
        assert.is_true(complete(modes))
        assert.is_true(modes.report.residual <= 1e-8 and modes.report.seconds > 0 and modes.report.bytes > 0)
        assert.truthy(tostring(modes):find(name, 1, true))
        first = first or modes
        for i = 1, 8 do check.near(first.eigenvalues[i], modes.eigenvalues[i], 1e-9) end
      end
    end
  end)

  it("are an option of equations, of refinement, of the worst case and of the breaking force", function()
    local part = free_part()
    local system = assert(part:system())
    local solid = bw.model {mesh = check.beam({8, 2, 2}, 1), material = bw.material.pla}
    local worst, force
    for _, name in ipairs(names) do
      local solver = bw.eigensolver[name] {}
      assert.equal(name, assert(system:modes {count = 3, solver = solver}).report.solver)
      assert.equal(name, assert(part:modes {count = 2, error = 0.5, solver = solver}).report.solver)
      local found = assert(bw.worst_case(solid, {force = 1, pressure = 1e6, modes = 3, eigensolver = solver}))
      assert.equal(name, found.modes.report.solver)
      worst = worst or found.max_principal
      check.near(worst, found.max_principal, 1e-6)
      local breaking = assert(bw.breaking_force(bw.surface.box {min = {0, 0, 0}, max = {0.04, 0.01, 0.01}},
        {material = bw.material.pla, elements = 300, modes = 3, regions = 2, eigensolver = solver}))
      force = force or breaking.force
      check.near(force, breaking.force, 1e-6)
    end
  end)

  it("are chosen by default and by the word auto", function()
    local part = free_part()
    for _, options in ipairs {{count = 2}, {count = 2, solver = "auto"},
      {count = 2, solver = "auto", error = 0.5}} do
      assert.equal("lanczos", assert(part:modes(options)).report.solver)
    end
    assert(bw.worst_case(part, {force = 1, pressure = 1e6, modes = 1, regions = 1, eigensolver = "auto"}))
  end)

  it("need no factor on quadratic elements", function()
    local mesh = check.beam({8, 2, 2}, 2)
    local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below(1, 0))
    local modes = assert(part:modes {count = 5, solver = bw.eigensolver.lobpcg {}})
    assert.equal("two_level", modes.report.preconditioner)
    assert.is_true(modes.tested and not modes.counted)
    assert.truthy(tostring(modes):find("none found missing", 1, true))
    local counted = assert(part:modes {count = 5})
    assert.is_true(counted.counted and not counted.tested)
    for i = 1, 5 do check.near(counted.eigenvalues[i], modes.eigenvalues[i], 1e-9) end
    local again = assert(part:modes {count = 5, solver = bw.eigensolver.lobpcg {}})
    assert.equal("cholesky", again.report.preconditioner)
    assert.is_true(again.counted)
  end)

  it("LOBPCG needs no factor of linear elements, held or free", function()
    local mesh = check.beam({8, 2, 2}, 1)
    for _, free in ipairs {false, true} do
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      if not free then part:fix(mesh.boundary:below(1, 0)) end
      local modes = assert(part:modes {count = 5, solver = bw.eigensolver.lobpcg {}})
      assert.equal("amg", modes.report.preconditioner)
      local counted = assert(part:modes {count = 5})
      for i = 1, 5 do check.near(counted.eigenvalues[i], modes.eigenvalues[i], 1e-9) end
    end
    local amg = bw.eigensolver.lobpcg {preconditioner = bw.solver.amg()}
    assert.equal("eigensolver lobpcg, preconditioner amg", tostring(amg))
    assert.equal("amg", assert(free_part():modes {count = 3, solver = amg}).report.preconditioner)
    check.raises("quadratic", function()
      assert(bw.model {mesh = mesh, material = bw.material.steel}:modes {
        solver = bw.eigensolver.lobpcg {preconditioner = bw.solver.two_level()}})
    end)
    check.raises("two_level and amg", bw.eigensolver.lobpcg, {preconditioner = bw.solver.jacobi()})
  end)

  it("say when another takes its place", function()
    local tetrahedron = bw.mesh.new {nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      elements = {{1, 2, 3, 4}}}
    local part = bw.model {mesh = assert(tetrahedron), material = bw.material.steel}
    local modes = assert(part:modes {solver = bw.eigensolver.arpack {}})
    assert.equal(6, modes.count)
    assert.equal("lanczos", modes.report.solver)
    assert.truthy(modes.report.reason:find("too few", 1, true))
  end)

  it("refuse what they are not", function()
    local part = free_part()
    check.raises("option 'solver': an eigensolver (bw.eigensolver.lanczos {}) or \"auto\" expected, got string",
      part.modes, part, {solver = "arpack"})
    check.raises("option 'solver'", part.modes, part, {solver = part})
    check.raises("option 'eigensolver': an eigensolver of bw.eigensolver or \"auto\" expected, got 3",
      bw.worst_case, part,
      {eigensolver = 3})
    check.raises("unknown option 'with'", part.modes, part, {with = "slepc"})
    check.raises("a basis of -3 vectors", bw.eigensolver.arpack, {basis = -3})
    check.raises("did you mean 'basis'?", bw.eigensolver.lanczos, {bases = 3})
    check.raises("'inner'", bw.eigensolver.slepc, {inner = "lu"})
    for _, bad in ipairs {bw.solver.cholesky(), bw.solver.pcg(), bw.solver.jacobi()} do
      check.raises("does not serve SLEPc: give cholesky, or pcg with amg", bw.eigensolver.slepc, {inner = bad})
    end
    check.raises("unknown option 'tolerance'", bw.eigensolver.slepc, {tolerance = 2})
    check.raises("too small for 15 modes: at least 31 expected", part.modes, part,
      {solver = bw.eigensolver.lanczos {basis = 20}})
    check.raises("Laplacian", part.modes, part, {laplacian = true, solver = bw.eigensolver.slepc {}})
  end)
end)

--- A prism along z whose mesh turns into itself by 1/corners of a turn: corners x layers wedges of three elements.
local function prism(corners, layers, height)
  local node, element = {}, {}
  for k = 0, layers do
    node[#node + 1] = {0, 0, height * k / layers}
    for j = 0, corners - 1 do
      local angle = 2 * math.pi * j / corners
      node[#node + 1] = {0.05 * math.cos(angle), 0.05 * math.sin(angle), height * k / layers}
    end
  end
  local row = corners + 1
  for k = 0, layers - 1 do
    for j = 0, corners - 1 do
      local c, a, b = k * row + 1, k * row + 2 + j, k * row + 2 + (j + 1) % corners
      element[#element + 1] = {c, a, b, b + row}
      element[#element + 1] = {c, a, b + row, a + row}
      element[#element + 1] = {c, a + row, b + row, c + row}
    end
  end
  return assert(bw.mesh.new {nodes = node, elements = element}):with_order(2)
end

--- A thin ring whose mesh turns into itself by 1/sectors of a turn.
local function ring(sectors)
  local node, element = {}, {}
  for place = 0, 3 do
    local radius = place % 2 == 0 and 0.95 or 1
    for j = 0, sectors - 1 do
      local angle = 2 * math.pi * j / sectors
      node[#node + 1] = {radius * math.cos(angle), radius * math.sin(angle), place < 2 and 0 or 0.05}
    end
  end
  for j = 0, sectors - 1 do
    local a, b = {}, {}
    for place = 0, 3 do
      a[place], b[place] = place * sectors + j + 1, place * sectors + (j + 1) % sectors + 1
    end
    for _, two in ipairs {{a[1], b[1]}, {b[1], b[0]}, {b[0], b[2]}, {b[2], a[2]}, {a[2], a[3]}, {a[3], a[1]}} do
      element[#element + 1] = {a[0], two[1], two[2], b[3]}
    end
  end
  return assert(bw.mesh.new {nodes = node, elements = element}):with_order(2)
end

--- Largest distance of two shapes' components, of the largest component.
local function distance(one, other)
  local most, size = 0, 0
  for i = 1, #one do
    for c = 1, 3 do
      most, size = math.max(most, math.abs(one[i][c] - other[i][c])), math.max(size, math.abs(one[i][c]))
    end
  end
  return most / size
end

-- Symmetric bodies have pairs of modes of one frequency, and eigensolvers choose the basis of a pair by accident.
-- The last mode asked for may be one of a pair.
describe("modes of one frequency", function()
  local bodies = {
    cube = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.1, 0.1}, cells = {3, 3, 3}, order = 2},
    ["square plate"] = prism(4, 1, 0.01),
    cylinder = prism(12, 4, 0.2),
  }
  for name, mesh in pairs(bodies) do
    it("have one basis for all eigensolvers: " .. name, function()
      local part = bw.model {mesh = mesh, material = bw.material.pla}
      local pairs_seen, cut = 0, false
      local many = assert(part:modes {count = 9})
      for i = 1, 8 do
        local equal = many.eigenvalues[i] == many.eigenvalues[i + 1]
        pairs_seen = pairs_seen + (equal and 1 or 0)
        if equal and not cut then -- the first of a pair alone
          cut = true
          for _, solver in ipairs(names) do
            local few = assert(part:modes {count = i, solver = bw.eigensolver[solver] {}})
            assert.is_true(distance(many:shape(i), few:shape(i)) < 1e-6)
          end
        end
      end
      assert.is_true(pairs_seen >= 2)
      for _, solver in ipairs(names) do
        local modes = assert(part:modes {count = 9, solver = bw.eigensolver[solver] {}})
        for i = 1, 9 do
          check.near(many.eigenvalues[i], modes.eigenvalues[i], 1e-9)
          assert.is_true(distance(many:shape(i), modes:shape(i)) < 1e-6)
        end
      end
    end)
  end

  it("have one basis for waves of up to seven periods around an axis", function()
    local part = bw.model {mesh = ring(32), material = bw.material.pla}
    local first
    for _, solver in ipairs(names) do
      local modes = assert(part:modes {count = 23, solver = bw.eigensolver[solver] {}})
      first = first or modes
      for i = 1, 23 do assert.is_true(distance(first:shape(i), modes:shape(i)) < 1e-6) end
    end
    for i = 1, 19, 2 do assert.are.equal(first.eigenvalues[i], first.eigenvalues[i + 1]) end
  end)

  it("give one worst case", function()
    local part = bw.model {mesh = bodies.cube, material = bw.material.pla}
    local first
    for _, solver in ipairs(names) do
      local worst = assert(bw.worst_case(part, {force = 1, pressure = 1e6, method = "paper",
        eigensolver = bw.eigensolver[solver] {}}))
      first = first or worst.max_principal
      check.near(first, worst.max_principal, 1e-6)
    end
  end)
end)
