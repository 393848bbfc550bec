-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
local bw = require "barwright"
local check = require "check"

describe("a material", function()
  it("is found by name", function()
    assert.equal(210e9, bw.material.steel.young)
    assert.equal(0.3, bw.material.steel.poisson)
    assert.is_true(bw.material.steel.isotropic)
    for _, name in ipairs(bw.material.names()) do
      local material = bw.material[name]
      assert.equal(name, material.name)
      assert.truthy(next(material.sources))
      assert.truthy(tostring(material):find(name, 1, true))
    end
    check.raises("there is no material 'stel': did you mean 'steel'?", function()
      return bw.material.stel
    end)
  end)

  it("is given by constants", function()
    local rubber = bw.material.isotropic {young = 1e6, poisson = 0.49, name = "rubber"}
    check.near(1e6 / 2 / 1.49, rubber.shear, 1e-12)
    assert.is_nil(rubber.density)
    assert.is_nil(rubber.strength)
    assert.is_nil(rubber:strength_along {1, 0, 0})
    check.raises("Poisson", bw.material.isotropic, {young = 1, poisson = 0.5})
    check.raises("did you mean 'young'", bw.material.isotropic, {youngs = 1})
    check.raises("option 'young': a finite number expected, got string", bw.material.isotropic,
      {young = "1e9"})
  end)

  it("has axes that turn", function()
    local wood = bw.material.orthotropic {young = {10e9, 1e9, 0.5e9}, poisson = {0.3, 0.02, 0.3},
      strength = {80e6, 8e6, 4e6}, name = "wood"}
    assert.same({10e9, 1e9, 0.5e9}, wood.young)
    local rotated = wood:rotated {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}
    check.near(wood.elasticity(1, 1), rotated.elasticity(2, 2), 1e-12)
    check.near(80e6, rotated:strength_along {0, 3, 0}, 1e-12)
    check.raises("rotation", wood.rotated, wood, {{2, 0, 0}, {0, 1, 0}, {0, 0, 1}})
  end)

  it("reports how much of its strength a stress uses", function()
    local used = bw.material.steel:utilisation {{235e6, 0, 0, 0, 0, 0}, {-117.5e6, 0, 0, 0, 0, 0}}
    check.near(1, used[1], 1e-12)
    check.near(0.5, used[2], 1e-12)
  end)
end)

describe("a model", function()
  local function bar(order)
    local mesh = check.beam({8, 2, 2}, order)
    local part = bw.model {mesh = mesh,
      material = bw.material.isotropic {young = 200e9, poisson = 0, density = 8000}}
    return part, mesh
  end

  it("warns of volumetric locking, and has a formulation that cures it", function()
    local rubber = bw.material.isotropic {young = 1e6, poisson = 0.4999}
    local function solved(order, formulation)
      local mesh = check.beam({8, 2, 2}, order)
      local part = bw.model {mesh = mesh, material = rubber, formulation = formulation}
      part:fix(mesh.boundary:below(1, 0)):gravity {0, 0, 0}
      return part, assert(part:solve())
    end
    rubber = bw.material.isotropic {young = 1e6, poisson = 0.4999, density = 1000}
    bw.warnings()
    local part, static = solved(2)
    assert.equal("standard", part.formulation)
    assert.truthy(part.locking:find('formulation = "b_bar"', 1, true))
    assert.equal(part.locking, static.locking)
    assert.same({part.locking}, bw.warnings())
    part, static = solved(2, "b_bar")
    assert.equal("b_bar", part.formulation)
    assert.is_nil(part.locking)
    assert.is_nil(static.locking)
    assert.same({}, bw.warnings())
    assert.truthy(tostring(part):find("B-bar", 1, true))
    assert.equal("b_bar", bw.model {mesh = part.mesh, material = part.material}.formulation)
    check.raises("order = 2", solved, 1, "b_bar")
    check.raises("option 'formulation'", solved, 2, "b-bar")
  end)

  it("refuses a support without a facet, unless it is a node set", function()
    local part, mesh = bar()
    local edge = mesh.boundary:below(1, 0) & mesh.boundary:below(2, 0)
    check.raises("no whole facet", part.fix, part, edge)
    check.raises("make it a node set", part.prescribe, part, edge, {0, 0, false})
    check.raises("no whole facet", part.fix, part, mesh.boundary:where "x < 1e-9 and y < 1e-9")
    part:fix(edge:node_set()):slide(mesh.boundary:nearest {1, 0, 0}, {0, 0, 1})
    assert.equal(edge.node_count, edge:node_set().node_count)
  end)

  it("refuses a load that acts on supports only, and a body that is fixed all over", function()
    local part, mesh = bar()
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:below(1, 0), force = {0, 0, 1}}
    check.raises("load 1, a force, acts on supports only", part.solve, part)
    part:clear_loads():clear_supports():fix(mesh.boundary:below(1, 2)):gravity {0, 0, -9.81}
    check.raises("the supports fix all", part.solve, part)
  end)

  it("warns where nothing acts", function()
    local mesh = bw.mesh.box {cells = {2, 2, 2}}
    local part = bw.model {mesh = mesh, material = bw.material.pla}
    part:fix(mesh.boundary:below("x", 0))
    bw.warnings()
    assert.equal(0, assert(part:solve()).displacement:max())
    assert.same({"no load acts and no support moves: the displacement is zero"}, bw.warnings())
    part:load {on = mesh.boundary:above("x", 1), force = {1, 0, 0}}
    assert(part:solve())
    assert.same({}, bw.warnings())
  end)

  it("stretches as a bar does", function()
    local part, mesh = bar()
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {1e6, 0, 0}}
    local static = assert(part:solve())
    -- u = F L / (E A), sigma = F / A
    check.near(1e6 / (200e9 * 0.01), static.displacement:column(1):max(), 1e-9)
    check.near(1e8, static.von_mises:mean(), 1e-9)
    check.near(1e8, static.element_max_principal:max(), 1e-9)
    check.near(1e8, static.principal:column(1):min(), 1e-9)
    check.near(0.5 * 1e6 * 1e6 / (200e9 * 0.01), static.energy, 1e-9)
    check.near(static.energy, static.element_energy:sum(), 1e-9)
    check.near(-1e6, static:reaction_on(mesh.boundary:below(1, 0))[1], 1e-9)
    local relative, elements = static:error_estimate()
    assert.truthy(relative < 1e-6)
    assert.equal(mesh.element_count, #elements)
    assert.equal(mesh, static.mesh)
    assert.truthy(static.residual < 1e-9)
    assert.equal(static.stress, static.stress) -- kept, not computed again
  end)

  it("takes a torque as a couple unless a net force is asked for", function()
    local part, mesh = bar()
    local tip = mesh.boundary:above(1, 1)
    local about = {1, 0.3, -0.2}
    part:load {on = tip, torque = {100, 20, 0}, about = about}
    part:load {on = tip, torque = {100, 20, 0}}
    part:load {on = tip, torque = {100, 20, 0}, about = about, net_force = true}
    local couple, same, rotated = table.unpack(part.loads)
    for k, moment in ipairs {100, 20, 0} do
      assert.is_true(math.abs(couple.resultant[k]) < 1e-9)
      assert.is_true(math.abs(moment - couple.moment[k]) < 1e-9)
      assert.equal(same.moment[k], couple.moment[k])
    end
    local force = rotated.resultant
    assert.is_true(math.abs(force[2]) + math.abs(force[3]) > 10)
    check.near(100, rotated.moment[1] - (about[2] * force[3] - about[3] * force[2]), 1e-9)
    check.raises("'net_force' needs the point", part.load, part, {on = tip, torque = {1, 0, 0}, net_force = true})
    check.raises("'net_force' goes with 'torque' only", part.load, part,
      {on = tip, force = {1, 0, 0}, net_force = true})
  end)

  it("takes loads of every kind, with their resultants", function()
    local part, mesh = bar()
    local tip = mesh.boundary:above(1, 1)
    part:fix(mesh.boundary:below(1, 0))
    part:gravity {0, -10, 0}
    part:load {on = tip, pressure = 1e5}
    part:load {on = tip, traction = {0, 0, 1e5}}
    part:load {on = tip, torque = {100, 0, 0}}
    part:load {nodal = bw.array.zeros(mesh.node_count, 3)}
    part:temperature(10, 1e-5)
    local loads = part.loads
    assert.equal(6, #loads)
    check.near(-800, loads[1].resultant[2], 1e-9)
    check.near(-1000, loads[2].resultant[1], 1e-9)
    check.near(1000, loads[3].resultant[3], 1e-9)
    check.near(100, loads[4].moment[1], 1e-9)
    assert.truthy(tostring(part):find "gravity")
    assert.truthy(tostring(part):find "torque")
    part:clear_loads()
    assert.equal(0, #part.loads)
    assert.equal(0, part:force_vector():norm())
  end)

  it("expands freely when it is warmed", function()
    local part, mesh = bar()
    part:temperature(50, 1e-5)
    local static = assert(part:solve())
    local x = static.displacement:column(1)
    check.near(50 * 1e-5, x:max() - x:min(), 1e-9)
    assert.truthy(static.von_mises:max() < 1) -- Pa, against 1e8 were it fixed
    assert(mesh)
  end)

  it("slides and is pushed by prescribed displacement", function()
    local part, mesh = bar()
    local all = mesh.boundary
    part:slide(all:below(1, 0)):slide(all:below(2, 0), {0, 1, 0}):slide(all:below(3, 0))
    part:prescribe(all:above(1, 1), {1e-3, false, false})
    local static = assert(part:solve())
    check.near(200e9 * 1e-3, static.von_mises:max(), 1e-9)
    local field = assert(part.clear_supports(part) and mesh.nodes:map "a*1e-3")
    part:prescribe(all, field)
    check.near(200e6, assert(part:solve()).element_principal:column(3):min(), 1e-9)
    check.raises("displacement: {x, y, z}", part.prescribe, part, all, {1, true, 0})
  end)

  it("names what is free", function()
    local part, mesh = bar()
    assert.equal(6, #part:rigid_modes())
    part:load {on = mesh.boundary:above(1, 1), force = {1, 0, 0}}
    local value, message, details = part:solve()
    check.fails("unconstrained", "translation", value, message, details)
    assert.equal(6, details.motions)
    local relieved = assert(part:solve {inertia_relief = true})
    assert.truthy(relieved.von_mises:max() > 0)
    part:slide(mesh.boundary:below(1, 0))
    assert.equal(3, #part:rigid_modes())
  end)

  it("solves a balanced load on a free body exactly", function()
    local part, mesh = bar()
    part:load {on = mesh.boundary:above(1, 1), force = {1e6, 0, 0}}
    part:load {on = mesh.boundary:below(1, 0), force = {-1e6, 0, 0}}
    check.near(1e8, assert(part:solve()).element_von_mises:min(), 1e-9)
  end)

  it("has the natural frequency of a free bar", function()
    local part = bar(2)
    local modes = assert(part:modes {count = 8})
    assert.equal(6, modes.rigid_count)
    assert.is_true(modes.counted)
    assert.equal(8, #modes)
    -- longitudinal: c / 2L = 2500 Hz with Poisson's ratio 0
    local nearest = (modes.frequencies - 2500):map("abs(a)"):min()
    assert.truthy(nearest < 5, tostring(modes.frequencies))
    assert.equal(3, modes:shape(1).column_count)
    assert.truthy(modes.residuals:max() < 1e-6)
    check.raises("a number from 1 to 8", modes.shape, modes, 9)
    local laplacian = assert(part:modes {count = 3, laplacian = true})
    check.near(math.pi ^ 2, laplacian.eigenvalues[1], 0.01)
    assert.is_nil(laplacian.frequencies)
  end)

  it("is solved by two-level PCG as by a factor, and says so", function()
    local part, mesh = bar(2)
    part:fix(mesh.boundary:below(1, 0)):gravity {1, 2, -9.81}
    local over = assert(part:solve {solver = bw.solver.pcg {}})
    local report = over.report
    assert.equal("pcg", report.solver)
    assert.equal("two_level", report.preconditioner)
    assert.is_true(report.iterations > 5 and report.iterations < 60)
    assert.is_true(report.residual < 1e-8 and report.residual == over.residual) -- slender: rounding
    assert.is_true(report.bytes > 0 and report.seconds > 0)
    assert.truthy(tostring(over):find("by pcg %(two_level%) in %d+ iterations"))
    assert.truthy(tostring(report):find("^pcg %(two_level%): %d+ iterations, residual .*; it was given$"))
    assert.equal(0, over.times.factor_entries)
    -- the factor is made when something needs it: another solution by it, modes, the system
    local modes = assert(part:modes {count = 2})
    local direct = assert(part:solve())
    assert.equal("cholesky", direct.report.solver)
    assert.equal("multifrontal", direct.report.backend)
    assert.is_nil(direct.report.iterations)
    assert.equal("the equations have a factor already", direct.report.reason)
    assert.falsy(tostring(direct):find "pcg")
    assert.equal(direct.times.factor_entries * 8, direct.report.bytes)
    assert.equal(2, modes.count)
    local max = direct.displacement:map "norm(a)":max()
    assert.is_true((over.displacement - direct.displacement):map "norm(a)":max() < 1e-9 * max)
    check.near(over:error_estimate(), direct:error_estimate(), 1e-8)
    local down = over:reaction_on(mesh.boundary:below(1, 0))
    for i, g in ipairs {1, 2, -9.81} do check.near(-8000 * mesh.volume * g, down[i], 1e-9) end
    check.fails("convergence", "the solver cholesky", part:solve {solver = bw.solver.pcg {max_iterations = 2}})
    check.fails("memory", "the factor of", bw.model {mesh = mesh, material = part.material}
      :fix(mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
      :solve {solver = bw.solver.cholesky {}, memory_limit = 1e4})
    part:clear_supports():clear_loads():load {on = mesh.boundary:below(1, 0), force = {1e3, 2e3, 0}}
    local free = part:solve {solver = bw.solver.pcg {}, inertia_relief = true}
    local same = part:solve {solver = bw.solver.cholesky {}, inertia_relief = true}
    max = same.displacement:map "norm(a)":max()
    assert.equal("pcg", free.report.solver)
    assert.is_true((free.displacement - same.displacement):map "norm(a)":max() < 1e-9 * max)
    local linear = bw.model {mesh = bw.mesh.box {}, material = part.material}
    part:clear_loads():fix(mesh.boundary:below(1, 0)) -- nothing to solve
    assert.truthy(tostring(part:solve {solver = bw.solver.pcg {}}):find("by pcg (two_level)", 1, true))
    part:clear_supports()
    check.raises("these are linear: give cholesky", linear.solve, linear, {solver = bw.solver.pcg {}})
    check.raises("goes with a factor on this machine", part.solve, part,
      {solver = bw.solver.pcg {}, memory_limit = 7})
    for order, name in ipairs {"amg", "two_level"} do -- a small part without memory for a factor
      local small = bw.model {mesh = bw.mesh.box {cells = {4, 4, 4}, order = order}, material = part.material}
      small:fix(small.mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
      if order == 1 then -- also one that can move freely
        small:clear_supports():clear_loads():load {on = small.mesh.boundary:below(1, 0), force = {1e3, 2e3, 0}}
      end
      local done = assert(small:solve {memory_limit = 1e4, inertia_relief = true}).report
      assert.same({"pcg", name, "there is no memory for a factor"},
        {done.solver, done.preconditioner, done.reason})
    end
    check.raises("a solver of bw.solver, or \"auto\"", part.solve, part, {solver = "pcg"})
    check.raises("preconditioner and no solver", part.solve, part, {solver = bw.solver.jacobi {}})
  end)

  it("is refused by every solver where two bars share an edge alone and one of them can rotate", function()
    local box, number = bw.mesh.box {max = {1, 0.1, 0.1}, cells = {5, 2, 2}}, {}
    local nodes, elements, of_bar = {}, {}, box.nodes:totable()
    for side = 0, 1 do
      for _, element in ipairs(box.elements:totable()) do
        local corners = {}
        for k = 1, 4 do
          local x, y, z = table.unpack(of_bar[element[k]])
          local shared = x + side == 1 and z == 0
          local key = ("%s %.3f %.3f %.3f"):format(shared or side, x + side, y, z)
          if not number[key] then nodes[#nodes + 1], number[key] = {x + side, y, z}, #nodes + 1 end
          corners[k] = number[key]
        end
        elements[#elements + 1] = corners
      end
    end
    local mesh = assert(bw.mesh.new {nodes = nodes, elements = elements})
    assert.equal(2 * box.node_count - 3, mesh.node_count)
    for order = 1, 2 do
      local part = bw.model {mesh = mesh:with_order(order), material = bw.material.steel}
      part:fix(part.mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
      for _, solver in ipairs {bw.solver.cholesky(), bw.solver.cholesky {backend = "cholmod"},
        bw.solver.cholesky {precision = 32}, bw.solver.pcg {preconditioner = bw.solver.amg()}} do
        local static, _, details = part:solve {solver = solver}
        assert.is_nil(static, tostring(solver))
        assert.truthy(details.status == "singular" or details.status == "convergence", details.status)
      end
    end
  end)

  it("is solved alike by every solver, which are objects", function()
    local solver = bw.solver
    local part, mesh = bar(2)
    part:fix(mesh.boundary:below(1, 0)):gravity {1, 2, -9.81}
    local expected = assert(part:solve()).displacement
    local max = expected:map "norm(a)":max()
    for _, one in ipairs {
      {solver.cholesky(), "cholesky"},
      {solver.cholesky {backend = "cholmod", ordering = "backend"}, "cholesky (cholmod, ordering backend)"},
      {solver.cholesky {precision = 32}, "cholesky (32 bits)"},
      {solver.pcg {preconditioner = solver.jacobi(), tolerance = 1e-11},
        "pcg (jacobi, tolerance 1e-11)"},
      {solver.pcg {preconditioner = solver.cholesky {backend = "cholmod"}, max_iterations = 9},
        "pcg (cholesky (cholmod), at most 9 iterations)"}} do
      assert.equal(one[2], tostring(one[1]))
      local static = assert(bw.model {mesh = mesh, material = part.material}
        :fix(mesh.boundary:below(1, 0)):gravity {1, 2, -9.81}:solve {solver = one[1]})
      assert.is_true((static.displacement - expected):map "norm(a)":max() < 1e-8 * max)
      assert.equal(one[1].kind, static.report.solver)
    end
    local pcg = solver.pcg {preconditioner = solver.jacobi()}
    assert.equal("jacobi", pcg.preconditioner.kind)
    assert.is_nil(pcg.tolerance)
    assert.equal(7, solver.pcg {max_iterations = 7}.max_iterations)
    assert.is_nil(pcg.backend)
    assert.equal("metis", solver.cholesky {ordering = "metis"}.ordering)
    check.raises("'cholmodd' is not known: did you mean 'cholmod'?", solver.cholesky, {backend = "cholmodd"})
    check.raises("no factor in single precision", solver.cholesky, {backend = "cholmod", precision = 32})
    check.raises("a solver of bw.solver", solver.pcg, {preconditioner = "jacobi"})
    check.raises("an integer of 1 or more expected, got 0", solver.pcg, {max_iterations = 0})
    local closed = solver.pcg()
    closed:close()
    check.raises("option 'solver': this solver is closed", part.solve, part, {solver = closed})
    check.raises("tolerance", solver.pcg, {tolerance = 2})
    local over = assert(part:solve {solver = solver.pcg {preconditioner = solver.amg(), tolerance = 1e-11}})
    assert.equal("amg", over.report.preconditioner)
    assert.is_true((over.displacement - expected):map "norm(a)":max() < 1e-8 * max)
  end)

  it("gives its system, which solves for forces", function()
    local part, mesh = bar()
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {1e6, 0, 0}}
    local static = assert(part:solve())
    local system = assert(part:system())
    local u = assert(system:solve(part:force_vector()))
    local both = assert(system:solve {part:force_vector() * 2, part:force_vector()})
    assert.equal(2, #both)
    check.near(2 * u:max(), both[1]:max(), 1e-12)
    assert.truthy((both[2] - u):norm() < 1e-12 * u:norm())
    assert.has_error(function() system:solve {part:force_vector(), u:rows(1, 2)} end)
    assert.truthy((u - static.displacement):norm() < 1e-12 * u:norm())
    assert.equal(0, system.rigid_mode_count)
    assert.truthy(system.times.factor_entries > 0)
    local stress = bw.element_stress(mesh, part.material, u)
    check.near(1e8, bw.von_mises(stress):max(), 1e-9)
    check.near(1e8, bw.max_principal(stress):max(), 1e-9)
    check.near(1e8, bw.principal(stress)(1, 1), 1e-9)
    check.near(1e8, bw.von_mises(bw.nodal_stress(mesh, part.material, u)):max(), 1e-9)
  end)

  it("says in a deck what holds a free body", function()
    local part, mesh = bar()
    local path = check.folder() .. "/free.inp"
    part:load {on = mesh.boundary:below(1, 0), force = {1, 0, 0}}
    part:load {on = mesh.boundary:above(1, 1), force = {-1, 0, 0}}
    bw.warnings()
    assert(part:write_inp(path))
    local warnings, deck = bw.warnings(), check.read(path)
    assert.equal(1, #warnings)
    assert.truthy(warnings[1]:find("holds it by 6 isostatic constraints", 1, true))
    local _, pins = deck:match "%*%* Isostatic[^*]*%*%*[^*]*%*BOUNDARY\n([^*]*)":gsub("%d+, %d, %d\n", "")
    assert.equal(6, pins)
    local _, blocks = deck:gsub("%*BOUNDARY", "")
    assert.equal(1, blocks)
    part:slide(mesh.boundary:below(1, 0), {1, 0, 0})
    assert(part:write_inp(path))
    assert.truthy(bw.warnings()[1]:find("by 3 isostatic", 1, true))
    _, blocks = check.read(path):gsub("%*BOUNDARY", "")
    assert.equal(2, blocks)
    assert(part:write_inp(path, {modes = 2})) -- modes of a free body are free
    assert.same({}, bw.warnings())
    assert.falsy(check.read(path):find "Isostatic")
  end)

  it("writes files and pictures", function()
    local part, mesh = bar()
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {0, 0, -1e3}}
    local folder = check.folder()
    local static = assert(part:solve())
    assert(static:write(folder .. "/s.vtu"))
    local _, file = assert(bw.mesh.read(folder .. "/s.vtu"))
    assert.equal(static.displacement:tostring "<f8", file.fields.displacement:tostring "<f8")
    assert(static:picture(folder .. "/s.png", {width = 300, height = 200}))
    assert(static:picture(folder .. "/u.png", {field = "displacement", width = 300, height = 200}))
    assert.equal("\137PNG", check.read(folder .. "/s.png"):sub(1, 4))
    assert(part:write_inp(folder .. "/s.inp"))
    assert.truthy(check.read(folder .. "/s.inp"):find "%*STATIC")
    assert.falsy(check.read(folder .. "/s.inp"):find "Isostatic")
    local modes = assert(part:modes {count = 2})
    assert(modes:write(folder .. "/m.vtu"))
    assert(modes:picture(1, folder .. "/m.png", {width = 300, height = 200}))
    assert(modes:picture(1, folder .. "/titled.png", {width = 300, height = 200,
      title = ("mode 1: %.4g Hz, about %.0f cents too high"):format(modes.frequencies[1],
        modes:error_estimate()[1])}))
    assert.is_true(check.read(folder .. "/m.png") == check.read(folder .. "/titled.png"))
    assert(mesh:picture(folder .. "/mesh.png", {width = 300, height = 200}))
    assert(mesh:surface():picture(folder .. "/surface.png", {width = 300, height = 200}))
    check.raises("did you mean 'von_mises'", static.picture, static, folder .. "/x.png",
      {field = "vonmises"})
    check.fails("io", "/no/such", static:write "/no/such/folder/s.vtu")
  end)

  it("reuses the equations of a former part, which stays as it is", function()
    local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {2, 0.4, 0.4}, cells = {20, 4, 4}})
    local function part_of(edit, material)
      local nodes = {}
      for i = 1, mesh.node_count do
        local x, y, z = mesh.nodes(i, 1), mesh.nodes(i, 2), mesh.nodes(i, 3)
        nodes[i] = {x + ((x > 1.99 and y > 0.39 and z > 0.39) and 0.01 * edit or 0), y, z}
      end
      local shape = assert(mesh:moved(nodes))
      local part = bw.model {mesh = shape, material = material or bw.material.pla}
      part:fix(shape.boundary:below(1, 1e-6))
      part:gravity {0, 0, -9.81}
      return part
    end
    local first = assert(part_of(0):solve())
    local former, tip = first, first.displacement:min()
    assert.equal(mesh.element_count, first.times.elements)
    for edit = 1, 3 do
      local part = part_of(edit)
      local again, fresh = assert(part:solve {former = former}), assert(part_of(edit):solve())
      assert.same(fresh.displacement:min(), again.displacement:min())
      assert.equal(0, (fresh.displacement - again.displacement):norm())
      assert.is_true(again.times.elements < 20)
      assert.is_true(edit == 1 or again.times.factor_reused > 0.3 and again.report.reused > 0.3)
      former = edit == 1 and part or edit == 2 and assert(part:system()) or again
    end
    assert.equal(tip, first.displacement:min())
    local other = assert(part_of(3, bw.material.abs):solve {former = former})
    assert.equal(mesh.element_count, other.times.elements)
    local part = part_of(1)
    check.raises("option 'former': a part, a static solution or a system", part.solve, part, {former = mesh})
  end)

  it("raises for misuse", function()
    local part, mesh = bar()
    check.raises("unknown option 'mateial': did you mean 'material'?", bw.model,
      {mesh = mesh, mateial = bw.material.pla})
    check.raises("an open mesh expected, got surface", bw.model,
      {mesh = mesh:surface(), material = bw.material.pla})
    check.raises("one of the options 'force', 'traction'", part.load, part, {on = mesh.boundary})
    check.raises("one of the options 'force', 'traction'", part.load, part, {on = mesh.boundary, force = {1, 0, 0},
      pressure = 3})
    check.raises("option 'on': an open selection expected, got mesh", part.load, part,
      {on = mesh, pressure = 3})
    check.raises("option 'force': three finite numbers", part.load, part,
      {on = mesh.boundary, force = 3})
    check.raises("'about' goes with 'torque' only", part.load, part,
      {on = mesh.boundary, force = {1, 0, 0}, about = {0, 0, 0}})
    check.raises("a model has no 'slove': did you mean 'solve'?", function() part:slove() end)
    mesh:close()
    check.raises("closed", function() return mesh.volume end)
    check.raises("an open mesh expected", bw.model, {mesh = mesh, material = bw.material.pla})
    assert.equal("mesh (closed)", tostring(mesh))
    assert.truthy(part.mesh.volume > 0) -- the model keeps what it depends on
  end)
end)
