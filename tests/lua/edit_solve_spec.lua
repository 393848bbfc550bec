-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A session's answer is that of a new part, and says what it reused.
local bw = require "barwright"
local check = require "check"
local edit_bodies = require "edit_bodies"

local mm = 1e-3
local beam_skeleton, beam_part, beam = edit_bodies.beam_skeleton, edit_bodies.beam_part, edit_bodies.beam
local body, same_nodes, compare = edit_bodies.body, edit_bodies.same_nodes, edit_bodies.compare

local refactor, full = bw.solver.cholesky(), bw.solver.cholesky {full = true}
local iterate = bw.solver.pcg {preconditioner = refactor}

describe("a solve", function()
  local function cantilever()
    local mesh = check.beam {4, 1, 1}
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {0, 0, -10}}
    local skeleton = bw.skeleton.create {joints = {{0, 0.05, 0.05}, {0.5, 0.05, 0.05}, {1, 0.05, 0.05}},
      bones = {{1, 2}, {2, 3, name = "lower"}}, root = 1}
    local session = assert(bw.edit(part, {skeleton = skeleton}))
    assert(session:solve())
    return session
  end

  it("checks what was asked for: iterations down to a loose tolerance pass", function()
    local session = cantilever()
    assert(session:bone("lower"):scale {1, 1.01, 1.01})
    local loose = assert(session:solve {check = true, solver = iterate, tolerance = 0.5})
    assert.truthy(loose.residual > 1e-8)
  end)

  it("of a part without a load is a field of zeros, with a report", function()
    local mesh = check.beam {4, 1, 1}
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(mesh.boundary:below(1, 0))
    local skeleton = bw.skeleton.create {joints = {{0, 0.05, 0.05}, {1, 0.05, 0.05}}, bones = {{1, 2}}, root = 1}
    local static = assert(assert(bw.edit(part, {skeleton = skeleton})):solve())
    assert.are.equal(0, static.displacement:norm())
    assert.are.equal("cholesky", static.report.solver)
  end)

  it("passes its check where rounding leaves no more digits: a limb of a ten thousandth", function()
    for _, solver in ipairs {iterate, refactor} do
      local session = cantilever()
      assert(session:bone("lower"):scale {1, 1e-4, 1e-4})
      local result = assert(session:solve {check = true, solver = solver})
      assert.is_true(result.reused.difference_solution > 1e-8)
    end
  end)

  it("is that of a new part, after every kind of edit, by every method", function()
    local session = body()
    local first = assert(session:solve())
    compare(session, first)
    assert.is_false(first.reused.pattern)
    assert.truthy(first:error_estimate() > 0)
    local edits = {
      function() return session:bone("neck"):rotate {axis = {1, 0, 0}, degrees = 20} end,
      function() return session:bone("trunk"):scale {1, 1.2, 1.3} end,
      function()
        local thick = {scale = {1, 1.3, 1.3}}
        return session:pose {left_thigh = thick, right_thigh = thick}
      end,
      function() return session:reach("left_foot", {18 * mm, 1 * mm, -41 * mm}) end,
      function() return session:undo() end,
      function() return session:bone("trunk"):rotate {z = 40} end,
    }
    for i, edit in ipairs(edits) do
      assert(edit())
      local result = assert(session:solve {solver = ({"auto", refactor, iterate, full})[i % 4 + 1]})
      compare(session, result)
      assert.is_true(result.reused.pattern)
      assert.equal(session.subdomains.stiffness_subdomain_count, result.reused.subdomains)
      assert.truthy(tostring(result.reused):find "^pattern yes, ordering yes, %d+ of %d+ subdomains, ")
    end
    assert(session:solve {check = true})
  end)

  it("obeys a tolerance of the solver, and the looser of it and the session's", function()
    local session, needed = body(), {}
    for k, tolerance in ipairs {1e-4, 1e-10, 1e-13} do
      local solver = bw.solver.pcg {tolerance = tolerance}
      local result = assert(session:solve {solver = solver})
      needed[k] = result.report.iterations
      assert.is_true(result.residual <= math.max(tolerance, 1e-9)) -- K u has this rounding error
      assert(session:bone("trunk"):scale {1, 1 + 1e-3 * k, 1})
    end
    assert.is_true(needed[1] < needed[2] and needed[2] < needed[3], table.concat(needed, ", "))
  end)

  it("describes a solver while it works", function()
    local session, texts = body(), {}
    local solver = bw.solver.pcg {tolerance = 1e-8}
    bw.progress(function() texts[#texts + 1] = tostring(solver) end)
    local ok, message = session:solve {solver = solver}
    bw.progress(nil)
    assert(ok, message)
    assert.is_true(#texts > 0)
    assert.equal("pcg (two_level, tolerance 1e-08)", texts[1])
  end)

  it("by two-level PCG says so, from the first solution on", function()
    local session = body()
    for k = 1, 2 do
      local result = assert(session:solve {solver = bw.solver.pcg(), check = true})
      assert.same({"pcg", "two_level", false}, {result.reused.solver, result.reused.preconditioner,
        result.reused.full})
      assert.truthy(tostring(result.reused):find "two%-level PCG in place of a factor, %d+ iterations")
      assert.is_true(result.reused.iterations > 3 and result.reused.difference_solution < 1e-8)
      assert(session:bone("trunk"):scale {1, 1 + 0.1 * k, 1})
    end
  end)

  it("of a part rotated as a whole keeps every subdomain and the factor", function()
    local session = beam()
    assert(session:bone("lower"):rotate {y = 20})
    assert(session:solve())
    assert(session:bone("upper"):rotate {x = 10, y = 20, z = 30})
    local result = assert(session:solve())
    compare(session, result)
    assert.equal(0, result.reused.subdomains_changed)
    assert.equal(1, result.reused.factor_reused)
  end)

  it("knows of loads that were added later, and of other load cases", function()
    local part = beam_part()
    local session = assert(bw.edit(part, {skeleton = beam_skeleton()}))
    local before = assert(session:solve()).displacement:norm()
    part:load {on = part.mesh.boundary:above(1, 1), force = {0, 0, -1000}}
    assert.truthy(assert(session:solve()).displacement:norm() > 2 * before)
    assert(session:bone("lower"):scale {1, 1.1, 1.1})
    compare(session, assert(session:solve()))
    local other = bw.model {mesh = part.mesh, material = part.material}
    other:load {on = part.mesh.boundary:above(1, 1), force = {0, 1, 0}}
    other:fix(part.mesh.boundary:below(1, 0))
    assert.equal(session.mesh, assert(session:moved(other)).mesh)
    local sideways = assert(session:solve {part = other, solver = refactor})
    local direct = assert(assert(session:moved(other)):solve())
    assert.truthy((direct.displacement - sideways.displacement):norm() < 1e-8 * direct.displacement:norm())
    assert.equal(1, sideways.reused.factor_reused)
    compare(session, assert(session:solve()))
    check.raises("a model expected, got mesh", session.solve, session, {part = part.mesh})
  end)

  it("begins iterations at the last solutions of its load case", function()
    local function iterations(guess)
      local session, counts = body(), 0
      assert(session:solve())
      for i = 1, 4 do
        assert(session:bone("neck"):set {scale = {1, 1 + 0.01 * i, 1 + 0.01 * i}})
        local result = assert(session:solve {solver = iterate, guess = guess})
        counts = counts + result.reused.iterations
        if i == 4 then compare(session, result) end
      end
      return counts
    end
    assert.truthy(iterations(nil) < 0.9 * iterations {})
  end)

  it("has the material turn with the bones where asked for", function()
    local print = assert(bw.material.orthotropic {young = {2e9, 1.8e9, 0.9e9}, poisson = {0.35, 0.3, 0.3},
      shear = {6e8, 4e8, 7e8}, density = 1100, strength = {3e7, 2e7, 1e7}})
    local mesh = check.beam({16, 2, 2}, 2)
    local function part_of(material)
      local part = bw.model {mesh = mesh, material = material}
      part:fix(mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
      return part:load {on = mesh.boundary:above(1, 1), force = {1, 5, -10}}
    end
    local part = part_of(print)
    local session = assert(bw.edit(part, {skeleton = beam_skeleton(), rotate_material = true}))
    assert.is_false(session.part.material.rotated_by_element)
    compare(session, assert(session:solve()))

    -- as a whole: the stress of a part whose material was given rotated from the start
    assert(session:bone("upper"):rotate {z = 90})
    local result = assert(session:solve {check = true})
    assert.equal(1, result.reused.factor_reused)
    assert.is_true(session.part.material.rotated_by_element)
    local rotated = print:rotated {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}
    local direct = assert(assert(part_of(rotated):moved(session.mesh)):solve())
    for _, field in ipairs {"stress", "von_mises", "utilisation"} do
      local want = direct[field]
      assert.truthy((want - result[field]):norm() < 1e-8 * want:norm())
    end
    check.near(direct:error_estimate(), result:error_estimate(), 1e-8)
    local stays = assert(assert(part:moved(session.mesh)):solve())
    assert.truthy((stays.displacement - result.displacement):norm() > 0.1 * result.displacement:norm())

    -- bent: that of a new part, whose material knows how each element lies
    assert(session:bone("lower"):rotate {y = 20})
    compare(session, assert(session:solve {check = true}))
    assert(session:bone("lower"):scale {1, 1.2, 1.1})
    compare(session, assert(session:solve {solver = iterate}))
    assert(session:undo())
    compare(session, assert(session:solve()))
    check.raises("axes of the part differ by element already", bw.edit, session.part, {rotate_material = true})

    -- and the optimiser's slopes are of that material
    local limit = 0.9 * assert(session:solve()).von_mises:max()
    local report = assert(session:optimise {von_mises = limit, move_supports = true})
    assert.is_true(report.met)
    assert.truthy(assert(session:solve()).von_mises:max() <= limit)
    compare(session, assert(session:solve()))
  end)

  it("writes fields and pictures of the shape as it is", function()
    local session, folder = beam(), check.folder()
    assert(session:bone("lower"):rotate {z = 30})
    assert(session:write(folder .. "/now.vtu"))
    assert(session:picture(folder .. "/now.png", {field = "von_mises"}))
    local mesh, file = bw.mesh.read(folder .. "/now.vtu")
    assert.is_true(same_nodes(mesh, session.mesh))
    assert.truthy(file.fields.subdomain and file.fields.von_mises)
    assert(assert(session:surface()):write(folder .. "/now.stl"))
    assert.is_nil(assert(session:solve()).times)
    assert(session:report(folder .. "/now.html", {title = "A bent beam"}))
    local page = check.read(folder .. "/now.html")
    assert.truthy(page:find("A bent beam", 1, true) and page:find("rotated by 30 degrees", 1, true))
    assert.truthy(page:find("session:bone(&quot;lower&quot;):rotate{z = 30}", 1, true))
  end)
end)
