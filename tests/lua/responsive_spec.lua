-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Sheets whose outline is dragged: conditions by tag, answers after drags, what was reused, refusals.
local bw = require "barwright"
local check = require "check"

local rubber = bw.material.isotropic {name = "rubber", young = 1e6, poisson = 0.3, density = 1000}

local function plate(x)
  return assert(bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, tags = {left = 4, right = 2},
    holes = {bw.outline.circle {centre = {x or 0.6, 0.5}, radius = 0.2, name = "hole"}}})
end

local function steady(more)
  local options = {outline = plate(), material = rubber, elements = 400,
    conditions = {left = "fixed", right = {traction = {1e3, 0}}}}
  for key, value in pairs(more or {}) do options[key] = value end
  return bw.responsive.steady(options)
end

describe("a steady sheet", function()
  it("answers what a strip's closed form says", function()
    local strip = assert(bw.outline.rectangle {width = 2, height = 0.5, tags = {left = 4, right = 2}})
    local s = assert(bw.responsive.steady {outline = strip, elements = 100, order = 2, material =
      bw.material.isotropic {name = "cork", young = 1e6, poisson = 0}, thickness = 0.1,
      conditions = {left = "fixed", right = {traction = {1e3, 0}}}})
    check.near(2e-3, s.displacement:max(), 1e-6)
    check.near(1e3, s.von_mises:max(), 1e-6)
    assert.is_true(s.error_estimate < 1e-6)
    check.near(1e3, (s:stress_norm(4)), 1e-6)
  end)

  it("gives after drags what a sheet made there gives, within the error of the meshes", function()
    local s = assert(steady {elements = 1500, order = 2})
    local seen = {}
    for _ = 1, 12 do
      assert(s:drag({loop = "hole"}, {0.05, 0}))
      seen[s.reused.level] = true
    end
    assert.is_true(seen.relocation)
    local rebuilt = assert(steady {outline = plate(1.2), elements = 1500, order = 2})
    check.near(rebuilt.displacement:max(), s.displacement:max(), 1e-3)
  end)

  it("keeps a corner at rest where two tags ask for different displacements, unless they are ordered", function()
    local outline = assert(bw.outline.rectangle {width = 1, height = 1, tags = {left = 4, lid = 3}})
    local fixed, lifted = {left = "fixed"}, {lid = {y = 1e-3}}
    local function corner(conditions)
      bw.warnings()
      local s = assert(bw.responsive.steady {outline = outline, material = rubber, elements = 50,
        conditions = conditions})
      local node = s.mesh.points:map "hypot(a.x, a.y - 1)":argmin()
      return s.displacement(node, 2), bw.warnings()
    end
    local sentence = "conditions conflict at (0, 1): tag 'left' prescribes y = 0, tag 'lid' 0.001; %s"
    for _, case in ipairs {{{left = "fixed", lid = lifted.lid}, 0,
      "0 is used; conditions in a list are ordered, and the last one decides"},
      {{fixed, lifted}, 1e-3, "0.001 is used, of the condition that is given last"},
      {{lifted, fixed}, 0, "0 is used, of the condition that is given last"}} do
      local value, warnings = corner(case[1])
      assert.equal(case[2], value)
      assert.same({sentence:format(case[3])}, warnings)
    end
  end)

  it("says in one line what it reused", function()
    local s = assert(steady {solver = bw.solver.pcg {preconditioner = bw.solver.cholesky()}})
    assert.truthy(tostring(s.reused):find "reused mesh")
    assert(s:drag({loop = "hole"}, {0.001, 0}))
    local reused = s.reused
    assert.equal("relocation", reused.level)
    assert.is_true(reused.pattern and reused.factor and reused.solution)
    assert.equal(0, reused.factorisations)
    assert.truthy(tostring(reused):find "^relocation; reused nodes, pattern, factor, solution; ")
    local again = assert(steady {follow = {level = "reconstruction"}})
    assert(again:drag({loop = "hole"}, {0.001, 0}))
    assert.equal("reconstruction", again.reused.level)
    assert.equal(1, again.reused.factorisations)
  end)

  it("keeps its last good state when a drag is refused", function()
    local s = assert(steady())
    local before, line = s.displacement:max(), tostring(s.reused)
    check.fails("geometry", "hole", s:drag({loop = "hole"}, {3, 0}))
    assert.equal(before, s.displacement:max())
    assert.equal(line, tostring(s.reused))
    assert(s:drag({loop = "hole"}, {0.01, 0}))
    assert.not_equal(before, s.displacement:max())
  end)

  it("takes values as numbers, formulas and functions of place", function()
    local by_number = assert(steady())
    local calls = 0
    for _, value in ipairs {"1e3 + 0*x*y*t", function(x, y, t)
      calls = calls + 1
      assert(x == 2 and y >= 0 and y <= 1 and t == 0)
      return 1e3
    end} do
      local s = assert(steady {conditions = {left = "fixed", right = {traction = {value, 0}}}})
      check.near(by_number.displacement:max(), s.displacement:max(), 1e-9)
      assert(s:drag({loop = "hole"}, {0.01, 0}))
      collectgarbage()
      assert(s:drag({loop = "hole"}, {0.01, 0}))
    end
    assert.is_true(calls > 0)
    local s = assert(steady {conditions = {left = "fixed", right = {x = "0.1*y", y = 0}}})
    check.near(0.1, s.displacement:max(), 0.2)
  end)

  it("refuses what cannot be, and names the nearest", function()
    check.raises("did you mean 'left'", steady, {conditions = {lefd = "fixed"}})
    check.raises("did you mean 'traction'", steady, {conditions = {left = {tractin = {0, 0}}}})
    check.raises("did you mean 'thickness'", steady, {thicknes = 1})
    check.raises("did you mean 'displacement'", function() return steady().dispacement end)
    check.raises("two values", steady, {conditions = {left = {traction = 5}}})
    check.raises("formula", steady, {conditions = {left = {x = {}}}})
    check.fails("unconstrained", "free to", steady {conditions = {right = {traction = {1, 0}}}})
    check.raises("two numbers", steady, {gravity = {"a", 1}})
    local s = assert(steady())
    check.raises("cannot be set", function() s.time = 3 end)
    check.raises("steady_sheet:drag(...)", function() s.drag({loop = "hole"}, {0, 0}) end)
    check.raises("a handle like", s.drag, s)
    check.raises("a handle like", s.drag, s, {loop = "hole"}, 3)
    check.raises("oops", steady, {conditions = {left = {x = function() error "oops" end, y = 0}}})
  end)

  it("has stresses whose gradient by the outline is that of differences", function()
    local s = assert(steady {solver = bw.solver.pcg {preconditioner = bw.solver.cholesky(), tolerance = 1e-12}})
    local norm, by_points = s:stress_norm(6)
    local weights = s.outline:weights {loop = "hole"}
    local slope = 0
    for i = 1, #by_points do slope = slope + weights[i] * by_points[i][1] end
    local h = 1e-4
    assert(s:drag({loop = "hole"}, {h, 0}))
    local after = s:stress_norm(6)
    assert(s:drag({loop = "hole"}, {-2 * h, 0}))
    local before = s:stress_norm(6)
    assert.is_true(norm > 0)
    check.near((after - before) / (2 * h), slope, 1e-3)
  end)
end)

describe("a large-deflection sheet", function()
  it("that hardly bends is a steady one: strains of 1e-12 lose no digits", function()
    local stiff = bw.material.isotropic {name = "stiff", young = 70e9, poisson = 0.3, density = 2700}
    local options = {outline = plate(), material = stiff, elements = 150,
      gravity = {0, -1e-5}, conditions = {left = "fixed"}}
    local large, linear = assert(bw.responsive.cantilever(options)), assert(bw.responsive.steady(options))
    assert.is_true(large.reused.newton_iterations <= 3)
    check.near(1, large.displacement:min() / linear.displacement:min(), 1e-6)
  end)

  it("is in the state it was in, bit for bit, when a drag has no equilibrium", function()
    local s = assert(bw.responsive.cantilever {outline = plate(), material = rubber, elements = 150,
      gravity = {0, -10}, conditions = {left = "fixed"}, newton = {load_steps = 1}})
    local before, points = s.displacement, s.points:totable()
    local refused
    for _ = 1, 60 do -- ever longer: at last it falls too far for one load step
      local ok, message, details = s:drag({edge = 2}, {0.25, 0})
      if not ok then
        check.fails("convergence", "", ok, message, details)
        refused = true
        break
      end
      before, points = s.displacement, s.points:totable()
    end
    assert.is_true(refused)
    assert.same(points, s.points:totable())
    assert.same(before:totable(), s.displacement:totable())
    assert(s:drag({edge = 2}, {-0.25, 0}))
  end)

  it("sags under its weight and follows drags", function()
    local beam = assert(bw.outline.rectangle {width = 1, height = 0.05, tags = {left = 4}})
    local soft = bw.material.isotropic {name = "soft", young = 1e6, poisson = 0, density = 1000}
    local s = assert(bw.responsive.cantilever {outline = beam, material = soft, order = 2,
      elements = 150, gravity = {0, -1}, conditions = {left = "fixed"}})
    -- w L^4 / (8 E I) with w = rho g h is 0.6 of the length: too much for the linear theory
    local tip = -s.displacement:min()
    assert.is_true(tip > 0.35 and tip < 0.6)
    assert.is_true(s.reused.newton_iterations > 1)
    assert(s:drag({edge = 2}, {0.1, 0}))
    assert.is_true(-s.displacement:min() > tip)
  end)
end)

describe("a transient sheet", function()
  it("moves with the ground, in steps between drags", function()
    local s = assert(bw.responsive.vibration {outline = plate(), material = rubber, elements = 300,
      ground = "left", ground_motion = {y = function(_, _, t) return 0.01 * math.sin(20 * t) end}, step = 1e-3})
    assert.is_nil(s.velocity)
    for i = 1, 20 do
      if i % 4 == 0 then assert(s:drag({loop = "hole"}, {0.02, 0})) end
      assert(s:step())
    end
    check.near(0.02, s.time, 1e-9)
    local points, moved = s.points, s.displacement
    for i = 1, #points do
      if points[i][1] == 0 then check.near(0.01 * math.sin(0.4), moved[i][2], 1e-12) end
    end
    assert.is_true(s.velocity:max() > 0)
    assert(s:step(10))
    check.near(0.03, s.time, 1e-9)
    check.raises("0 or more", bw.responsive.vibration, {outline = plate(), material = rubber,
      elements = 100, ground = "left", damping = {-1, 0}})
    check.raises("above 0", s.step, s, -1)
  end)
end)

-- Drags of every kind of handle, small and far too large: each is done or refused, and the state is
-- good after it. All 10,000 with BARWRIGHT_FULL=1.
describe("solvers", function()
  local cholesky = bw.solver.cholesky()
  -- solver, what the report of a drag says: solver, preconditioner, factorisations
  local rows = {
    {bw.solver.pcg {preconditioner = cholesky, tolerance = 1e-10}, "pcg", "cholesky", 0},
    {cholesky, "cholesky", nil, 1},
    {bw.solver.cholesky {full = true}, "cholesky", nil, 1},
  }
  local kinds = {
    steady = function(options) return bw.responsive.steady(options) end,
    cantilever = function(options) return bw.responsive.cantilever(options) end,
    vibration = function(options)
      options.conditions = {right = {traction = {1e3, 0}}}
      options.ground, options.step = "left", 0.01
      return bw.responsive.vibration(options)
    end,
  }
  local function moved(kind, more)
    local options = {outline = plate(), material = rubber, elements = 300,
      conditions = {left = "fixed", right = {traction = {1e3, 0}}}}
    for key, value in pairs(more) do options[key] = value end
    local s = assert(kinds[kind](options))
    if kind == "vibration" then assert(s:step(3)) end
    assert(s:drag({loop = "hole"}, {0.002, 0}))
    if kind == "vibration" then assert(s:step()) end
    return s
  end

  it("give one answer in every kind of sheet, and say what they did", function()
    for kind in pairs(kinds) do
      local auto = moved(kind, {})
      assert.is_truthy(auto.report.reason:find("cost least", 1, true), kind)
      assert.is_truthy(tostring(auto):find(tostring(auto.report), 1, true))
      for _, row in ipairs(rows) do
        local s = moved(kind, {solver = row[1]})
        local report, what = s.report, kind .. " by " .. tostring(row[1])
        local off = (s.displacement - auto.displacement):norm()
        assert.is_true(off < 1e-6 * auto.displacement:norm(), what .. ": " .. off)
        assert.same({"multifrontal", "it was given"}, {report.backend, report.reason}, what)
        assert.is_true(report.bytes > 0 and report.seconds > 0, what)
        assert.equal(s.reused.iterations, report.iterations or 0, what)
        if kind ~= "cantilever" then -- whose Newton's method keeps a tangent by itself
          assert.same({row[2], row[3]}, {report.solver, report.preconditioner}, what)
          assert.equal(row[4], s.reused.factorisations, what)
          assert.is_true(report.residual < 1e-7, what)
        end
      end
    end
  end)

  it("keep a factor no longer than max_lag says", function()
    for lag, factorisations in pairs {[0] = 1, [1] = 0} do
      local s = moved("steady", {solver = rows[1][1], max_lag = lag})
      assert.equal(factorisations, s.reused.factorisations)
    end
    local s = moved("steady", {max_lag = 0})
    assert.equal("the factor has served as many solutions as max_lag allows", s.report.reason)
  end)

  it("that do not serve are refused, with what does", function()
    local sentence = "does not serve the equations of a plane mesh: give cholesky"
    for _, bad in ipairs {bw.solver.pcg(), bw.solver.jacobi(), bw.solver.lu(), bw.solver.bicgstab(),
      bw.solver.cholesky {backend = "cholmod"}, bw.solver.cholesky {precision = 32},
      bw.solver.cholesky {ordering = "amd"}} do
      for kind, make in pairs(kinds) do
        check.raises(sentence, function()
          local s = make {outline = plate(), material = rubber, elements = 100, solver = bad,
            conditions = {left = "fixed", right = {traction = {1e3, 0}}}}
          if kind == "vibration" then s:step() end
        end)
      end
    end
    check.raises("max_lag has no effect", steady, {solver = cholesky, max_lag = 2})
    check.raises("option 'max_lag'", steady, {max_lag = -1})
    check.raises("option 'solver'", steady, {solver = {method = "full"}})
    check.raises("option 'solver'", steady, {solver = "cholesky"})
  end)
end)

describe("random drags", function()
  local count = os.getenv "BARWRIGHT_FULL" and 10000 or 120
  local common = {material = rubber, elements = 200}
  local function options(more)
    local all = {outline = plate()}
    for key, value in pairs(common) do all[key] = value end
    for key, value in pairs(more) do all[key] = value end
    return all
  end
  local makers = {
    steady = function()
      return bw.responsive.steady(options {conditions = {left = "fixed", right = {traction = {0, 1e3}}}})
    end,
    ["steady, order 2"] = function()
      return bw.responsive.steady(options {order = 2,
        conditions = {left = "fixed", right = {traction = {0, 1e3}}}})
    end,
    cantilever = function()
      return bw.responsive.cantilever(options {conditions = {left = "fixed"}, gravity = {0, -5}})
    end,
    vibration = function()
      -- a drag changes the rest shape under a strained sheet, and so its energy: damped, it is lost again
      return bw.responsive.vibration(options {ground = "left", ground_motion = {y = "0.01*sin(20*t)"},
        damping = {20, 1e-4}})
    end,
  }
  for name, make in pairs(makers) do
    it("leave a good state: " .. name, function()
      local sheet = assert(make())
      local random = check.random(12345)
      local done, refused = 0, 0
      for i = 1, count do
        local handle = random() < 0.5 and {loop = "hole"}
          or {vertex = 1 + math.floor(random() * sheet.outline.edge_count)}
        local reach = random() < 0.1 and 3 or 0.1
        local ok, message, details = sheet:drag(handle,
          {reach * (random() - 0.5), reach * (random() - 0.5)})
        if ok then
          done = done + 1
        else
          refused = refused + 1
          assert(type(message) == "string" and details.status ~= "internal", message)
        end
        if name == "vibration" then assert(sheet:step()) end
        local max = sheet.displacement:max()
        assert(max == max and max < 1e3)
        if i % 40 == 0 then -- wandered off: begin again
          assert(sheet:become(plate()))
        end
      end
      assert.is_true(done > 0.5 * count and refused > 0)
    end)
  end
end)
