-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Run as `mpirun -n 2 barwright --mpi tests/lua/distributed/cases.lua` by distributed_spec.lua: each case is
-- a line "case NAME: ok" or what was wrong. The reference is the engine's own factor, which the C tests
-- compare with CHOLMOD.
local bw = require "barwright"
local check = require "check"

local ranks = require("barwright.distributed").size()
local slepc = bw.eigensolver.slepc {}
local steel = bw.material.isotropic {young = 200e9, poisson = 0.3, density = 8000}

local function case(name, run)
  local ok, message = xpcall(run, debug.traceback)
  print(("case %s: %s"):format(name, ok and "ok" or message))
end

local function largest(array) return math.max(array:max(), -array:min()) end

local function same_field(expected, field, tolerance, what)
  local difference = largest(field - expected) / largest(expected)
  assert(difference < tolerance, ("%s differ by %.2g"):format(what, difference))
end

local function same_static(part, options, tolerance)
  local own = assert(part:solve {inertia_relief = options.inertia_relief})
  local other = assert(part:solve(options))
  same_field(own.displacement, other.displacement, tolerance, "displacements")
  if largest(own.reaction) > 0 then
    same_field(own.reaction, other.reaction, tolerance, "reactions")
  end
  same_field(own.von_mises, other.von_mises, tolerance, "stresses")
  check.near(own.energy, other.energy, tolerance)
  assert(other.residual <= 1e-9, other.residual)
  local report = other.report
  assert(report.ranks == ranks and report.backend == "petsc" and report.solver == options.solver.kind)
  assert((report.iterations ~= nil) == (report.solver == "pcg"))
  assert(report.preconditioner == (report.solver == "pcg" and "amg" or nil))
  assert(own.report.backend == "multifrontal" and other.times == nil)
end

local amg = bw.solver.amg {backend = "petsc"}
local function cg(options)
  options = options or {}
  options.preconditioner = amg
  return bw.solver.pcg(options)
end
local spread = {cg = cg {tolerance = 1e-9}, cholesky = bw.solver.cholesky {backend = "petsc"}}

local function fixed(order)
  local mesh = check.beam({8, 2, 2}, order)
  local part = bw.model {mesh = mesh, material = steel}
  part:fix(mesh.boundary:below(1, 0))
  return part:load {on = mesh.boundary:above(1, 1), force = {1e3, 2e3, -500}}, mesh
end

for _, method in ipairs {"cg", "cholesky"} do
  local options = {solver = spread[method]}
  for order = 1, 2 do
    case(("static tet%d %s"):format(order == 1 and 4 or 10, method), function()
      same_static(fixed(order), options, 1e-8)
    end)
    case(("rotated supports tet%d %s"):format(order == 1 and 4 or 10, method), function()
      local mesh = check.beam({8, 2, 2}, order)
      local part = bw.model {mesh = mesh, material = steel}
      part:slide(mesh.boundary:below(1, 0), {1, 0.4, 0.2}):slide(mesh.boundary:below(2, 0), {0, 1, 0})
      part:prescribe(mesh.boundary:above(1, 1), {1e-5, false, 2e-5})
      part:load {on = mesh.boundary:above(3, 0.1), pressure = 1e5}
      same_static(part, options, 1e-8)
    end)
    case(("free tet%d %s"):format(order == 1 and 4 or 10, method), function()
      local mesh = check.beam({8, 2, 2}, order)
      local part = bw.model {mesh = mesh, material = steel}
      part:load {on = mesh.boundary:above(1, 1), force = {1e3, 2e3, 0}}
      same_static(part, {solver = spread[method], inertia_relief = true}, 1e-8)
    end)
  end
end

-- What a rank must know beside its nodes and elements.
local function clamped(mesh, material, more)
  local part = bw.model {mesh = mesh, material = material, formulation = more}
  part:fix(mesh.boundary:below(1, 0))
  return part:load {on = mesh.boundary:above(1, 1), force = {1e3, 2e3, -500}}
end

case("orthotropic material", function()
  local c, s = math.cos(0.4), math.sin(0.4)
  local material = bw.material.zp150:rotated {{c, -s, 0}, {s, c, 0}, {0, 0, 1}}
  same_static(clamped(check.beam({8, 2, 2}, 2), material), {solver = spread.cholesky}, 1e-8)
end)

case("B-bar elements", function()
  local material = bw.material.isotropic {young = 1e6, poisson = 0.49, density = 1000}
  local part = clamped(check.beam({8, 2, 2}, 2), material, "b_bar")
  same_static(part, {solver = spread.cholesky}, 1e-8)
  same_static(part, {solver = spread.cg}, 1e-7)
end)

case("curved elements", function()
  local mesh = check.beam({8, 2, 2}, 2)
  local rows = {}
  for i = 1, mesh.node_count do
    local x, y, z = mesh.nodes(i, 1), mesh.nodes(i, 2), mesh.nodes(i, 3)
    rows[i] = {x, y + 0.3 * x * (1 - x), z * (1 + 0.5 * x * (1 - x))}
  end
  for _, method in ipairs {"cg", "cholesky"} do
    same_static(clamped(assert(mesh:moved(rows)), steel), {solver = spread[method]}, 1e-8)
  end
end)

case("many rows", function() -- on each rank more than are assembled at once
  local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {26, 26, 26}})
  local part = clamped(mesh, steel)
  local own = assert(part:solve {solver = bw.solver.cholesky {}})
  local other = assert(part:solve {solver = cg {tolerance = 1e-10}})
  same_field(own.displacement, other.displacement, 1e-8, "displacements")
  same_field(own.reaction, other.reaction, 1e-8, "reactions")
end)

case("few iterations", function() -- linear elements as the coarse level of quadratic ones
  for _, turned in ipairs {false, true} do
    local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {8, 8, 8}, order = 2})
    local part = bw.model {mesh = mesh, material = steel}
    part:slide(mesh.boundary:below(1, 0), turned and {1, 0.4, 0.2} or {1, 0, 0})
    part:slide(mesh.boundary:below(2, 0), {0, 1, 0}):load {on = mesh.boundary:above(3, 1), force = {0, 0, 1e3}}
    local report = assert(part:solve {solver = spread.cg, inertia_relief = true}).report
    assert(report.iterations <= 30, report.iterations)
  end
end)

local function same_modes(part, options)
  local own = assert(part:modes {count = options.count})
  local other = assert(part:modes(options))
  assert(#own == #other and own.rigid_count == other.rigid_count)
  for i = 1, #own do check.near(own.eigenvalues[i], other.eigenvalues[i], 1e-8) end
  assert(other.residuals:max() < 1e-7, other.residuals:max())
  assert(other.counted == (options.solver == slepc))
  for i = 1, #own do -- modes of one frequency too; others are known only as well as they are apart
    local low, high = i > 1 and own.eigenvalues[i - 1] or 0, i < #own and own.eigenvalues[i + 1] or math.huge
    local value = own.eigenvalues[i]
    local function apart(gap) return gap <= 0 or gap > 1e-2 * value end
    if i < #own and apart(value - low) and apart(high - value) then
      same_field(own:shape(i), other:shape(i), 1e-5, "shapes " .. i)
    end
  end
  assert(other.report.ranks == ranks and other.report.solver == "slepc")
end

for order = 1, 2 do
  local name = order == 1 and "tet4" or "tet10"
  case("modes " .. name, function() same_modes(fixed(order), {solver = slepc, count = 6}) end)
  case("free modes " .. name, function()
    local mesh = check.beam({8, 2, 2}, order)
    same_modes(bw.model {mesh = mesh, material = steel}, {solver = slepc, count = 6})
  end)
end
local by_cg = bw.eigensolver.slepc {inner = bw.solver.pcg {preconditioner = bw.solver.amg {backend = "petsc"}}}
case("modes by conjugate gradients", function()
  for order = 1, 2 do
    same_modes(fixed(order), {solver = by_cg, count = 4})
  end
end)
case("rotated modes", function()
  for order, solver in ipairs {slepc, by_cg} do
    local mesh = check.beam({8, 2, 2}, order)
    local part = bw.model {mesh = mesh, material = steel}
    part:slide(mesh.boundary:below(1, 0), {1, 0.4, 0.2})
    same_modes(part, {solver = solver, count = 5})
  end
end)

-- The equations stay with the ranks: modes, adjoint solves, stresses.
local function same_worst_case(part, options)
  local limits = {force = 100, pressure = 1e6, modes = 5, regions = 2, targets = 4}
  local own = assert(bw.worst_case(part, limits))
  for key, value in pairs(options) do limits[key] = value end
  local other = assert(bw.worst_case(part, limits))
  assert(#own.regions == #other.regions)
  check.near(own.max_principal, other.max_principal, 1e-8)
  check.near(own.max_displacement, other.max_displacement, 1e-8)
  for i = 1, #own.modes do check.near(own.modes.eigenvalues[i], other.modes.eigenvalues[i], 1e-8) end
  assert(other.modes.report.solver == "slepc" and other.modes.report.ranks == ranks)
  local report = other.reports.solver
  assert(report.backend == "petsc" and report.ranks == ranks and report.solver == options.solver.kind)
  return other
end

for _, name in ipairs {"cg", "cholesky"} do
  local solver = spread[name]
  case("worst case " .. name, function()
    local mesh = check.beam({8, 2, 2}, 2)
    same_worst_case(bw.model {mesh = mesh, material = steel}, {solver = solver})
    same_worst_case(fixed(1), {solver = solver, eigensolver = slepc})
    check.raises("lanczos", bw.worst_case, fixed(1), {force = 100, modes = 2, regions = 1, solver = solver,
      eigensolver = bw.eigensolver.lanczos {}})
  end)
end

case("breaking force", function()
  local mesh = check.beam({4, 2, 2}, 2)
  local limits = {material = bw.material.pla, length = 0.2, modes = 3, regions = 2, elements = 100,
    max_elements = 100}
  local own = assert(bw.breaking_force(mesh, limits))
  limits.solver = spread.cholesky
  local other = assert(bw.breaking_force(mesh, limits))
  check.near(own.force, other.force, 1e-8)
  assert(other.worst.reports.solver.backend == "petsc")
end)

case("many right-hand sides", function()
  local part, mesh = fixed(2)
  local forces = {}
  for k = 1, 3 do
    local rows = {}
    for i = 1, mesh.node_count do rows[i] = {math.sin(k * i), 0, math.cos(i)} end
    forces[k] = bw.array(rows)
  end
  local own = assert(part:system()):solve(forces)
  for _, solver in pairs(spread) do
    local system = assert(part:system {solver = solver})
    local other = assert(system:solve(forces))
    for k = 1, 3 do same_field(own[k], other[k], 1e-8, "displacements") end
    local iterations = system.report.iterations
    assert(assert(part:solve {solver = solver}).report.ranks == ranks) -- closes the system, which is opened again
    same_field(own[1], assert(system:solve(forces[1])), 1e-8, "displacements")
    if solver == spread.cg then -- counted on, where it was opened again
      assert(system.report.iterations > iterations and system.report.energy_error > 0)
    end
    assert(tostring(system):find("petsc", 1, true))
    check.fails("unsupported", "spread over several processes", system:matrix "stiffness")
    check.raises("take slepc", system.modes, system, {solver = bw.eigensolver.lanczos {}})
  end
end)

-- What is written has the mesh, and the fields that static:write would write from rank 0.
local function same_pieces(part, options)
  local path = check.folder() .. "/r.pvtu"
  options.write = path
  local static = assert(part:solve(options))
  local mesh, file = assert(bw.mesh.read(path, {renumber = false}))
  assert(largest(mesh.nodes - part.mesh.nodes) == 0 and largest(mesh.elements - part.mesh.elements) == 0)
  assert(#mesh.regions == #part.mesh.regions)
  for i, region in ipairs(part.mesh.regions) do assert(mesh.regions[i].tag == region.tag) end
  if mesh.element_regions then assert(largest(mesh.element_regions - part.mesh.element_regions) == 0) end
  for _, name in ipairs {"displacement", "force", "reaction", "stress", "von_mises", "max_principal",
    "element_stress"} do
    if largest(static[name]) > 0 then same_field(static[name], file.fields[name], 1e-12, name) end
  end
  local pieces = 0
  for _ in check.read(path):gmatch "<Piece " do pieces = pieces + 1 end
  assert(pieces == ranks, pieces)
  return path
end

case("results by pieces", function()
  for order = 1, 2 do
    same_pieces(fixed(order), {solver = spread.cholesky})
    local mesh = check.beam({8, 2, 2}, order)
    local part = bw.model {mesh = mesh, material = steel}
    part:slide(mesh.boundary:below(1, 0), {1, 0.4, 0.2}):slide(mesh.boundary:below(2, 0), {0, 1, 0})
    part:load {on = mesh.boundary:above(3, 0.1), pressure = 1e5}
    same_pieces(part, {solver = spread.cg, inertia_relief = true})
  end
  local mesh, regions = check.beam({8, 2, 2}, 2), {}
  for e = 1, mesh.element_count do regions[e] = e % 3 + 1 end
  mesh = assert(bw.mesh.new {nodes = mesh.nodes, elements = mesh.elements, regions = regions, order = 2})
  local c, sine = math.cos(0.4), math.sin(0.4)
  local material = bw.material.zp150:rotated {{c, -sine, 0}, {sine, c, 0}, {0, 0, 1}}
  same_pieces(clamped(mesh, material), {solver = spread.cholesky})
end)

case("results that cannot be written", function()
  local part, folder = fixed(2), check.folder()
  local path, last = folder .. "/r.pvtu", ("%s/r_%d.vtu"):format(folder, ranks - 1)
  local options = {solver = spread.cholesky, write = path}
  assert(part:solve(options))
  os.remove(last)
  assert(os.execute("mkdir " .. check.quoted(last))) -- in the place of a file
  check.fails("io", last, part:solve(options))
  for _, name in ipairs {path, ranks > 1 and folder .. "/r_0.vtu" or path} do
    assert(not io.open(name), name)
  end
  assert(os.execute("rmdir " .. check.quoted(last)))
  assert(part:solve(options) and bw.mesh.read(path))
  options.write = folder .. "/r.vtu"
  check.raises("ends in .pvtu", part.solve, part, options)
  part:temperature(10, 1e-5)
  options.write = path
  check.fails("unsupported", "temperatures", part:solve(options))
end)

case("the error in energy", function() -- of a residual that is far smaller
  local mesh = check.beam({30, 2, 2}, 2)
  local part = bw.model {mesh = mesh, material = steel}
  part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {0, 0, 1e3}}
  local k = assert(part:system():matrix("stiffness", {whole = true}))
  local exact, f = assert(part:solve()).displacement, part:force_vector()
  local function product(a, b)
    local sum = 0
    for i, row in ipairs(a:totable()) do
      for c, x in ipairs(row) do sum = sum + x * b[3 * (i - 1) + c] end
    end
    return sum
  end
  local function flat(a)
    local out = {}
    for _, row in ipairs(a:totable()) do for _, x in ipairs(row) do out[#out + 1] = x end end
    return out
  end
  local work = product(exact, flat(f))
  for _, tolerance in ipairs {1e-2, 1e-4, 1e-6} do
    local system = assert(part:system {solver = cg {tolerance = tolerance}})
    local error = assert(system:solve(f)) - exact
    local relative = math.sqrt(product(error, k:apply(flat(error)):column(1)) / work)
    local said = system.report.energy_error
    assert(said > 0.9 * relative and said < 5 * relative, ("%g for %g"):format(said, relative))
  end
end)

case("failures come back, and work goes on", function()
  local part = fixed(1)
  check.fails("convergence", "3 iterations", part:solve {solver = cg {max_iterations = 3}})
  assert(part:solve {solver = cg()})
  local mesh = check.beam({2, 1, 1})
  local free = bw.model {mesh = mesh, material = steel}
  free:load {on = mesh.boundary:above(1, 1), force = {1, 0, 0}}
  check.fails("unconstrained", "not in equilibrium", free:solve {solver = cg()})
  assert(part:modes {solver = slepc, count = 2})
end)

case("a body that is nearly a mechanism is refused", function()
  -- Two cubes that share an edge: the second one turns about it.
  local a = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {1, 1, 1}})
  local nodes, elements, at = {}, {}, {}
  local function add(mesh, shift)
    local place = {}
    for i = 1, mesh.node_count do
      local row = {mesh.nodes(i, 1) + shift, mesh.nodes(i, 2) + shift, mesh.nodes(i, 3)}
      local key = table.concat(row, " ")
      if not at[key] then
        nodes[#nodes + 1] = row
        at[key] = #nodes
      end
      place[i] = at[key]
    end
    for e = 1, mesh.element_count do
      local row = {}
      for k = 1, 4 do row[k] = place[mesh.elements(e, k)] end
      elements[#elements + 1] = row
    end
  end
  add(a, 0)
  add(a, 1)
  local mesh = assert(bw.mesh.new {nodes = nodes, elements = elements})
  local part = bw.model {mesh = mesh, material = steel}
  part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 2), force = {0, 1, 0}}
  local own, _, why = part:solve()
  assert(not own and why.status == "singular")
  for _, method in ipairs {"cholesky", "cg"} do
    local static, message, details = part:solve {solver = spread[method]}
    assert(not static and (details.status == "singular" or details.status == "convergence"), message)
  end
end)

case("misuse", function()
  local part = fixed(1)
  check.raises("goes with a solver of the backend petsc", part.solve, part, {write = "a.pvtu"})
  check.raises("path of a .pvtu", part.solve, part, {solver = cg(), write = 3})
  check.raises("goes with a factor on this machine", part.solve, part, {solver = cg(), memory_limit = 1e9})
  check.raises("Laplacian", part.modes, part, {solver = slepc, laplacian = true})
  check.raises("takes a model", assert(part:system()).modes, part:system(), {solver = slepc})
end)

case("a forked job has no ranks", function()
  local core = require "barwright.core"
  local job = core.job(function()
    local part = fixed(1)
    local static, message, details = part:solve {solver = cg()}
    return tostring(static) .. " " .. details.status .. " " .. message
  end, {seconds = 60})
  core.wait({job}, 60)
  local text = assert(job:result())
  assert(text:find "^nil unsupported a forked job cannot use MPI", text)
end)

case("the same numbers again", function()
  local part = fixed(2)
  local a = assert(part:solve {solver = cg()}).displacement
  local b = assert(part:solve {solver = cg()}).displacement
  assert(largest(a - b) == 0)
end)
print "end"
