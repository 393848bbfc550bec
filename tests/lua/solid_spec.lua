-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Hyperelastic solids on grids: laws, supports and loads by place, equilibria, coarse solids, motion.
local bw = require "barwright"
local check = require "check"

local function rubber(young, poisson)
  return bw.hyperelastic {young = young or 1e6, poisson = poisson or 0.3, density = 1000}
end

local function column(cells, materials)
  local grid = assert(bw.grid.box {size = {0.1, 0.1, 0.1 * (cells or 1)}, cells = {2, 2, 2 * (cells or 1)}})
  return assert(bw.solid {grid = grid, materials = materials or {rubber()}})
end

-- Free to become thinner: fixed along z below, and just enough in the plane.
local function stand(solid)
  solid:fix({side = "min z"}, {false, false, 0})
  solid:fix({side = "min x"}, {0, false, false})
  return solid:fix({side = "min y"}, {false, 0, false})
end

local ways = {direct = bw.solver.cholesky(), coarse = bw.solver.pcg(),
  jacobi = bw.solver.pcg {preconditioner = bw.solver.jacobi()}}

describe("a hyperelastic material", function()
  it("warns of volumetric locking, and has a formulation that cures it", function()
    local function solved(formulation)
      local soft = bw.hyperelastic {young = 1e6, poisson = 0.499, formulation = formulation}
      check.near(0.499, soft.poisson, 1e-12)
      check.near(1e6, soft.young, 1e-12)
      local grid = assert(bw.grid.box {cells = {2, 2, 4}, spacing = 0.1})
      local solid = assert(bw.solid {grid = grid, materials = {soft}})
      solid:fix {side = "min z"}
      solid:force({side = "max z"}, {1, 0, 0})
      return solid, assert(solid:solve()), soft
    end
    bw.warnings()
    local solid, standard = solved()
    assert.truthy(solid.locking:find('formulation = "b_bar"', 1, true))
    assert.same({solid.locking}, bw.warnings())
    local cured, result, soft = solved "b_bar"
    assert.equal("b_bar", soft.formulation)
    assert.is_nil(cured.locking)
    assert.same({}, bw.warnings())
    assert.is_true(result.energy > 1.2 * standard.energy)
    check.raises("B-bar", cured.coarsen, cured, "naive")
    check.raises("B-bar", cured.solve, cured, {solver = ways.coarse})
  end)

  it("has a law with its constants", function()
    local a = bw.hyperelastic {law = "corotated", young = 2e6, poisson = 0.25, name = "foam"}
    assert.equal("corotated", a.law)
    assert.equal("foam", a.name)
    check.near(2e6, a.young, 1e-12)
    check.near(0.25, a.poisson, 1e-12)
    local b = bw.hyperelastic {mu = a.mu[1], lambda = a.lambda[1]}
    check.near(2e6, b.young, 1e-12)
    assert.equal(8, a.points)
  end)

  it("gives energy and stress: the stress is the energy's slope", function()
    for _, law in ipairs {"neo_hookean", "st_venant_kirchhoff", "corotated", "fixed_corotated"} do
      local m = bw.hyperelastic {law = law, young = 1e6, poisson = 0.3}
      local f = {{1.1, 0.2, 0}, {-0.1, 0.9, 0.05}, {0, 0.1, 1.2}}
      local _, stress = m:energy(f)
      local h = 1e-6
      f[1][2] = 0.2 + h
      local up = m:energy(f)
      f[1][2] = 0.2 - h
      local down = m:energy(f)
      check.near(stress(1, 2), (up - down) / (2 * h), 1e-6)
    end
    assert.is_nil((rubber():energy {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}))
  end)

  it("refuses what is no constant", function()
    check.raises("hyperelastic: the options 'young' and 'poisson'", bw.hyperelastic, {young = 1})
    check.raises("Poisson's ratio is 0.5", bw.hyperelastic, {young = 1, poisson = 0.5})
    check.raises("did you mean 'young'", bw.hyperelastic, {yong = 1, poisson = 0.2})
  end)
end)

describe("a solid", function()
  it("stretched with free sides pulls as the closed form says", function()
    -- compressible neo-Hookean, E = 1, nu = 0.3, stretch 1.5: P/E and lateral stretch
    local solid = stand(column())
    solid:fix({side = "max z"}, {false, false, 0.05})
    local result = assert(solid:solve())
    local reaction = result:total_reaction {side = "max z"}
    check.near(0.3782801763943185, reaction[3] / (0.01 * 1e6), 1e-6)
    local corner = result.displacement:gather(solid.grid:nodes {side = "max x"})
    check.near(0.8801745918 - 1, corner:column(1):max() / 0.1, 1e-6)
    assert.is_true(result.complete)
    assert.is_truthy(tostring(result):find("equilibrium: strain energy", 1, true))
    assert.equal(#result.newton.history, result.newton.iterations)
    -- stress is even: P over the area that is left
    local von_mises = result.von_mises
    check.near(0.3782801763943185e6 / 0.8801745918 ^ 2, von_mises:max(), 1e-6)
    check.near(von_mises:min(), von_mises:max(), 1e-6)
  end)

  it("finds forces, gravity, pressure and floors by place", function()
    local solid = stand(column(2))
    solid:force({side = "max z"}, {0, 0, -30}):gravity {0, 0, -9.81}
    local result = assert(solid:solve())
    local weight = 0.002 * 1000 * 9.81
    check.near(30 + weight, result:total_reaction({side = "min z"})[3], 1e-6)
    local pressed = stand(column(2))
    pressed:pressure(assert(pressed.grid:surface()), {pressure = function(_, _, z)
      return z > 0.1999 and 3000 or 0
    end})
    check.near(30, assert(pressed:solve()):total_reaction({side = "min z"})[3], 1e-6)
    local floored = column(2)
    floored:fix {side = "min z"}
    floored:contact_plane {point = {0, 0, 0.2}, normal = {0, 0, -1}, move = {0, 0, -0.02}}
    local down = assert(floored:solve())
    local top = down.displacement:gather(floored.grid:nodes {side = "max z"})
    check.near(-0.02, top:column(3):max(), 1e-8)
    assert.is_true(down.newton.contacts > 0)
  end)

  it("goes along the arc of a turn", function()
    local solid = column(3)
    solid:fix {side = "min z"}
    solid:rotate({side = "max z"}, {axis = {0, 0, 2}, point = {0.05, 0.05, 0}, angle = 90})
    local result = assert(solid:solve())
    local nodes = solid.grid:nodes {side = "max z"}
    local at, by = solid.grid.points:gather(nodes):totable(), result.displacement:gather(nodes):totable()
    for i = 1, #at do
      local x, y = at[i][1] - 0.05, at[i][2] - 0.05
      check.near(1 - y, 1 + x + by[i][1], 1e-9)
      check.near(1 + x, 1 + y + by[i][2], 1e-9)
    end
    assert.equal(3, result.newton.load_steps)
  end)

  it("has an error relative to the reference's displacement, however little that is", function()
    local function pulled(force)
      local solid = column(2)
      solid:fix {side = "min z"}
      solid:force({side = "max z"}, {0, 0, force})
      return assert(solid:solve())
    end
    local reference, size = pulled(-1e-3), 0.2
    local relative, of_size = pulled(-2e-3):error(reference)
    check.near(1, relative, 1e-3)
    local sum = 0
    for i = 1, #reference.movement do sum = sum + reference.movement[i] end
    check.near(sum / #reference.movement, of_size * size, 1e-3)
    local none = pulled(0)
    check.near(1, (none:error(reference)), 1e-9)
    assert.same({0, 0}, {none:error(none)})
    assert.equal(math.huge, (reference:error(none)))
  end)

  it("is found again on a coarse grid and on an edited one", function()
    local materials = {rubber(1e5), rubber(1e7)}
    local grid = assert(bw.grid.box {size = {0.1, 0.1, 0.3}, cells = {4, 4, 12},
      material = function(x) return x // 0.025 % 2 + 1 end})
    local fine = assert(bw.solid {grid = grid, materials = materials})
    fine:fix {side = "min z"}
    fine:force({side = "max z"}, {0, 0, 100})
    local reference = assert(fine:solve())
    assert.equal(0, reference:error(reference))
    for _, method in ipairs {"naive", "average"} do
      local coarse = assert(fine:coarsen(method, 1))
      assert.equal(24, coarse.element_count)
      assert.equal(1, coarse.levels)
      local result = assert(coarse:solve())
      local error, of_size = result:error(reference)
      assert.is_true(of_size > 0 and of_size < 0.05 and error > of_size, error)
      check.near(-100, result:total_reaction({side = "min z"})[3], 1e-6)
      assert.equal(#reference.displacement, #result.fine_displacement)
    end
    local softer = assert(grid:set({max = {0.1, 0.1, 0.1}}, 1))
    local edited = assert(assert(fine:coarsen("naive", 1)):with(softer))
    local from_scratch = assert(assert(fine:with(softer)):coarsen("naive", 1))
    assert.equal(0, assert(edited:solve()):error(assert(from_scratch:solve())))
    check.raises("nodes given by their numbers", function()
      assert(assert(bw.solid {grid = grid, materials = materials}):fix({1, 2, 3}):coarsen "naive"):solve()
    end)
  end)

  it("is let go where its tangent is not definite: by conjugate gradients as with a factor", function()
    local grid = assert(bw.grid.box {cells = {2, 2, 16}, spacing = 0.01})
    local solid = assert(bw.solid {grid = grid, materials = {rubber()}})
    solid:fix {side = "min z"}
    local pressed, done = {}, {}
    for i, p in ipairs(grid.points:totable()) do pressed[i] = {1e-4 * math.sin(20 * p[3]), 0, -0.3 * p[3]} end
    for i, linear in ipairs {"direct", "jacobi"} do
      local motion = assert(solid:transient {step = 0.1, iterations = 1, solver = ways[linear],
        displacement = bw.array(pressed)})
      done[i] = assert(motion:step()).displacement
    end
    assert.is_true((done[1] - done[2]):norm() < 1e-3 * done[1]:norm())
  end)

  it("solves over a coarse solid as it does with a factor", function()
    local solid = column(3)
    solid:fix {side = "min z"}
    solid:force({side = "max z"}, {2, 0, 20})
    local direct = assert(solid:solve {tolerance = 1e-9})
    for _, linear in ipairs {"coarse", "jacobi"} do
      local other = assert(solid:solve {solver = ways[linear], tolerance = 1e-9})
      assert.is_true(other.newton.cg_iterations > 0)
      assert.is_true(other:error(direct) < 1e-8)
    end
    check.raises("made coarse once from this one", function() solid:solve {coarse = solid} end)
    check.raises("was made coarse twice", function() solid:coarsen("naive", 2):solve {solver = ways.coarse} end)
    -- a coarse solid too, over one that is coarser still; also after an edit
    local coarse = assert(solid:coarsen "naive")
    coarse = assert(coarse:with(assert(solid.grid:set({max = {0.05, 1, 1}}, 0))))
    local by_factor = assert(coarse:solve {tolerance = 1e-9})
    local by_gradients = assert(coarse:solve {solver = ways.coarse, tolerance = 1e-9})
    assert.equal(0, by_factor.newton.cg_iterations)
    assert.is_true(by_gradients.newton.cg_iterations > 0)
    assert.is_true(by_gradients:error(by_factor) < 1e-8)
    -- cells need not be cubes
    local flat = assert(bw.solid {grid = assert(bw.grid.box {size = {0.1, 0.1, 0.1}, cells = {4, 4, 8}}),
      materials = {rubber()}})
    flat:fix {side = "min z"}
    flat:force({side = "max z"}, {2, 0, 20})
    assert.is_true(assert(flat:solve {solver = ways.coarse, tolerance = 1e-9}):error(
      assert(flat:solve {tolerance = 1e-9})) < 1e-8)
  end)

  it("reports how its equations were solved, in statics and in motion", function()
    local solid = column(3)
    solid:fix {side = "min z"}
    solid:force({side = "max z"}, {2, 0, 20})
    for linear, words in pairs {direct = {"cholesky", "multifrontal"}, jacobi = {"pcg", nil, "jacobi"},
      coarse = {"pcg", nil, "two_level"}} do
      local result = assert(solid:solve {solver = ways[linear]})
      local report = result.report
      assert.same(words, {report.solver, report.backend, report.preconditioner})
      assert.equal("it was given", report.reason)
      assert.is_true(report.bytes > 0 and report.seconds > 0 and report.residual <= 1e-6)
      local cg = result.newton.cg_iterations + result.newton.stability_iterations
      assert.equal(cg, report.iterations or 0)
      assert.is_truthy(tostring(result):find(tostring(report), 1, true))
    end
    local report = assert(solid:solve()).report
    assert.same({"cholesky", "there are no coarse solids, which iterations would need"},
      {report.solver, report.reason})
    for _, linear in ipairs {"direct", "jacobi"} do
      local motion = assert(solid:transient {step = 0.01, solver = ways[linear]})
      assert.is_nil(motion.report)
      assert.is_truthy(tostring(motion):find "after 0 steps")
      assert(motion:step(2))
      assert.equal(linear == "direct" and "cholesky" or "pcg", motion.report.solver)
      assert.equal(motion.newton.cg_iterations, motion.report.iterations or 0)
      assert.is_truthy(tostring(motion):find(tostring(motion.report), 1, true))
    end
  end)

  it("leaves a straight column that is not stable, whichever way it solves", function()
    local grid = assert(bw.grid.box {cells = {3, 3, 40}, spacing = 0.01})
    local height = 0.4
    local function sideways(shortening, linear)
      local solid = assert(bw.solid {grid = grid, materials = {rubber()}})
      solid:fix {side = "min z"}
      solid:fix({side = "max z"}, {0, 0, -shortening * height})
      local result = assert(solid:solve {solver = ways[linear]})
      assert.equal(0, result.newton.undecided)
      assert.equal(linear == "coarse", result.newton.stability_iterations > 10)
      local max = 0
      for _, u in ipairs(result.displacement:totable()) do
        max = math.max(max, math.abs(u[1]), math.abs(u[2]))
      end
      return max
    end
    for _, linear in ipairs {"direct", "coarse"} do
      assert.is_true(sideways(0.018, linear) < 3e-4, linear)
      assert.is_true(sideways(0.025, linear) > 5e-3, linear)
    end
  end)

  it("says why it does not solve, and how far it came", function()
    local free = column()
    free:force({side = "max z"}, {0, 0, 1})
    local result, message, details = free:solve()
    assert.is_nil(result)
    assert.equal("unconstrained", details.status)
    assert.is_truthy(message)
    local crushed = stand(column())
    crushed:force({side = "max z"}, {0, 0, -1e9})
    result, message, details = crushed:solve {iterations = 20}
    assert.is_nil(result)
    assert.is_truthy(message:find("load", 1, true))
    assert.is_true(details.reached == nil or not details.reached.complete)
    check.raises("did you mean 'steps'", function() crushed:solve {step = 2} end)
  end)

  it("moves: without a load it stays, falling it falls", function()
    local solid = column()
    solid:gravity {0, 0, -10}
    local motion = assert(solid:transient {step = 0.01, scheme = "newmark"})
    assert(motion:step(10))
    check.near(0.1, motion.time, 1e-12)
    check.near(-0.05, motion.displacement:column(3):mean(), 1e-6)
    check.near(-1, motion.velocity:column(3):mean(), 1e-6)
    local swung = {}
    solid:fix {side = "min z"}
    solid:gravity {3, 0, 0}
    for i, linear in ipairs {"direct", "jacobi"} do
      local swing = assert(solid:transient {step = 0.01, iterations = 1, solver = ways[linear],
        stiffness_damping = 1e-3})
      swung[i] = assert(swing:step(5)).displacement:column(1):max()
      assert.is_true(math.abs(swing.kinetic + swing.strain + swing.potential + swing.dissipated) < 1e-12)
    end
    check.near(swung[1], swung[2], 1e-5)
    assert.is_true(swung[1] > 1e-7)
    check.raises("did you mean 'step'", function() solid:transient {steps = 1} end)
  end)
end)
