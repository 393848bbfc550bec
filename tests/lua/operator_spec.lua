-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Operators of a script, and sparse matrices, by linear solvers and eigensolvers: closed forms, SciPy where it is
-- installed, errors within the script's function, and what it may call and close meanwhile.
local bw = require "barwright"
local check = require "check"

local n = 60

-- The tridiagonal matrix of `diagonal` and -1.
local function chain(diagonal, size)
  size = size or n
  local rows, columns, values = {}, {}, {}
  for i = 1, size do
    for j = math.max(1, i - 1), math.min(size, i + 1) do
      rows[#rows + 1], columns[#columns + 1], values[#values + 1] = i, j, i == j and diagonal or -1
    end
  end
  return bw.sparse_matrix.new(size, size, rows, columns, values)
end

local function exact(k) return 2 - 2 * math.cos(k * math.pi / (n + 1)) end

-- A function of x, as an operator of n rows.
local function operator(apply, name) return bw.operator {size = n, apply = apply, name = name} end

local ones = bw.array.zeros(n) + 1

describe("solutions", function()
  it("are the closed form by each solver", function()
    local a = chain(2)
    local own = operator(function(x) return a:apply(x) end)
    local s = bw.solver
    for _, case in ipairs {{a}, {a, s.cholesky {backend = "cholmod"}}, {a, s.cholesky {precision = 32}},
      {a, s.pcg()}, {a, s.pcg {preconditioner = s.cholesky()}}, {own}, {own, s.pcg {tolerance = 1e-12}}} do
      local x, report = assert(case[1]:solve(ones, {solver = case[2]}))
      for i = 1, n do check.near(i * (n + 1 - i) / 2, x[i], 1e-9) end
      assert.truthy(report.solver == "cholesky" or report.iterations <= n)
      assert.truthy(tostring(report):find(report.solver, 1, true))
    end
  end)

  it("take several right-hand sides and a guess", function()
    local a, rows = chain(2.5), {}
    for i = 1, n do rows[i] = {math.sin(i), 0, i} end
    local b = bw.array.new(rows)
    for _, which in ipairs {a, operator(function(x) return a:apply(x) end)} do
      local x = assert(which:solve(b))
      assert.equal(n, x.row_count)
      assert.equal(3, x.column_count)
      for k = 1, 3 do
        assert.truthy((a:apply(x:column(k)) - b:column(k)):norm() <= 1e-9 * b:column(k):norm())
      end
      local again, report = assert(which:solve(b, {guess = x, solver = bw.solver.pcg {tolerance = 1e-9}}))
      assert.equal(x:tostring "<f8", again:tostring "<f8")
      assert.equal(nil, report.iterations)
    end
  end)

  it("are those of a part with springs, preconditioned by the part's own factor", function()
    local mesh = bw.mesh.box {max = {0.1, 0.02, 0.02}, cells = {10, 2, 2}, order = 2}
    local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
    part:load {on = mesh.boundary:above("x", 0.1), force = {0, 0, -100}}
    local system = assert(part:system())
    local k, b = assert(system:matrix "stiffness"), system:right_hand_side(part:force_vector())
    local normal = system:right_hand_side(bw.array.zeros(mesh.node_count, 3) + 1) * (1 / mesh.node_count)
    local spring = 1e9
    local springs = operator(function(x) return x end) -- of another size: refused below
    local with = bw.operator {size = k.row_count, name = "part on springs",
      apply = function(x) return k:apply(x) + normal * (spring * normal:dot(x)) end}
    local x, report = assert(with:solve(b, {preconditioner = k:inverse()}))
    -- Sherman and Morrison
    local plain, other = assert(k:solve(b)), assert(k:solve(normal))
    local expected = plain - other * (spring * normal:dot(plain) / (1 + spring * normal:dot(other)))
    assert.truthy((x - expected):norm() < 1e-8 * expected:norm())
    assert.truthy((x - plain):norm() > 1e-3 * plain:norm())
    assert.equal("cholesky", report.preconditioner)
    assert.truthy(report.iterations <= 3, report.iterations) -- two different eigenvalues
    check.raises("the preconditioner \"operator\" has 60 rows", with.solve, with, b, {preconditioner = springs})
  end)

  it("and eigenvalues are SciPy's", function()
    local mesh = bw.mesh.box {max = {0.1, 0.02, 0.01}, cells = {8, 2, 1}}
    local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
    part:load {on = mesh.boundary:above("x", 0.1), force = {0, 0, -100}}
    local system, folder = assert(part:system()), check.folder()
    local k, m = assert(system:matrix "stiffness"), assert(system:matrix "mass")
    local b = system:right_hand_side(part:force_vector())
    assert(k:write(folder .. "/k.mtx") and m:write(folder .. "/m.npz") and b:write(folder .. "/b.npy"))
    local ran
    for _, python in ipairs {"python3", "/usr/bin/python3"} do
      local _, _, code = os.execute(("%s %s/tests/lua/solve_scipy.py %s"):format(python, check.root, folder))
      ran = ran or code == 0
    end
    if not ran then return pending "SciPy is not installed" end
    local x, values = assert(bw.array.read(folder .. "/x.npy")), assert(bw.array.read(folder .. "/values.npy"))
    k, m = assert(bw.sparse_matrix.read(folder .. "/k.mtx")), assert(bw.sparse_matrix.read(folder .. "/m.npz"))
    for _, solver in ipairs {bw.solver.cholesky(), bw.solver.cholesky {backend = "cholmod"}, bw.solver.pcg()} do
      assert.truthy((assert(k:solve(b, {solver = solver})) - x):norm() < 1e-7 * x:norm())
    end
    local e = bw.eigensolver
    for _, solver in ipairs {e.lanczos(), e.arpack(), e.lobpcg()} do
      local preconditioner = solver.name == "lobpcg" and k:inverse() or nil
      local pairs_of = assert(k:eigenpairs {mass = m, count = 6, solver = solver, preconditioner = preconditioner})
      for i = 1, 6 do check.near(values[i], pairs_of.values[i], 1e-8) end
    end
  end)
end)

describe("eigenpairs", function()
  it("are the closed form by each eigensolver, with errors", function()
    local a = chain(2)
    local own = operator(function(x) return a:apply(x) end)
    local e = bw.eigensolver
    for _, case in ipairs {{a}, {a, e.lanczos()}, {a, e.arpack()}, {a, e.lobpcg()}, {own},
      {own, e.lobpcg(), a:inverse()}} do
      local found = assert(case[1]:eigenpairs {count = 4, solver = case[2], preconditioner = case[3]})
      assert.equal(4, found.count)
      assert.truthy(found.counted or found.tested)
      for k = 1, 4 do
        check.near(exact(k), found.values[k], 1e-9)
        assert.truthy(math.abs(exact(k) - found.values[k]) <= found.errors[k] + 1e-14)
        assert.truthy(found.residuals[k] < 1e-8)
        local x = found:vector(k)
        assert.truthy((a:apply(x) - x * found.values[k]):norm() < 1e-8)
        check.near(1, x:norm(), 1e-9)
      end
      assert.truthy(tostring(found):match "^4 eigenpairs: 0%.002651.* %(within .*%) to .* by l?")
    end
  end)

  it("are the modes of a part, and of a free one with a shift", function()
    local mesh = bw.mesh.box {max = {0.1, 0.02, 0.01}, cells = {6, 2, 1}, order = 2}
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    local system, modes = assert(part:system()), assert(part:modes {count = 3})
    local k = assert(system:matrix("stiffness", {whole = true}))
    local m = assert(system:matrix("mass", {whole = true}))
    check.fails("singular", "is not positive definite", k:eigenpairs {mass = m})
    local found = assert(k:eigenpairs {mass = m, count = 9, shift = -1e6})
    for i = 1, 6 do assert.truthy(math.abs(found.values[i]) < 1) end
    for i = 1, 3 do check.near(modes.frequencies[i], math.sqrt(found.values[6 + i]) / (2 * math.pi), 1e-8) end
    assert.truthy(found.counted)
  end)
end)

describe("the function of an operator", function()
  it("may call the engine, other operators and solvers", function()
    local a = chain(2)
    local inner = operator(function(x) return a:apply(x) end, "inner")
    local near = chain(2.01)
    local preconditioner = operator(function(x) return (assert(near:solve(x))) end, "near")
    local outer = operator(function(x)
      collectgarbage()
      return inner:apply(x)
    end, "outer")
    local x, report = assert(outer:solve(ones, {preconditioner = preconditioner}))
    check.near(n * n / 8, x[n // 2], 0.05)
    assert.equal("operator", report.preconditioner)
    assert.truthy(report.iterations < 15)
    local found = assert(outer:eigenpairs {count = 2, preconditioner = preconditioner})
    check.near(exact(2), found.values[2], 1e-9)
  end)

  it("raises its own error, and the engine works after it", function()
    local a = chain(2)
    local calls
    local function failing(after, problem)
      calls = 0
      return operator(function(x)
        calls = calls + 1
        if calls > after then error(problem) end
        return a:apply(x)
      end)
    end
    local problem = {}
    for _, after in ipairs {0, 1, 7} do
      for _, method in ipairs {"solve", "eigenpairs", "apply"} do
        local own = failing(after, problem)
        local ok, got = pcall(function()
          if method == "eigenpairs" then return assert(own:eigenpairs()) end
          for _ = 0, after do assert(own[method](own, ones)) end
        end)
        assert.falsy(ok)
        assert.equal(problem, got)
        assert.equal(after + 1, calls)
        check.near(n / 2, (assert(a:solve(ones)))[1], 1e-9)
      end
    end
    check.raises("operator_spec.lua:", function() failing(0, "mine"):solve(ones) end)
    local function deep() error "deep" end
    local _, message = pcall(function()
      return operator(function(x)
        local y = deep(x)
        return y
      end):solve(ones)
    end)
    local calls_of = "\n\t[^\n]*:%d+: in 'apply'"
    assert.truthy(message:match("^[^\n]*operator_spec.lua:%d+: deep" .. calls_of .. calls_of .. "$"))
    check.raises("attempt to yield", function() operator(coroutine.yield):solve(ones) end)
    coroutine.wrap(function()
      check.near(n / 2, (assert(operator(function(x) return a:apply(x) end):solve(ones)))[1], 1e-9)
    end)()
  end)

  it("may call itself no more than too often", function()
    local own
    own = operator(function(x) return (assert(own:solve(x))) end)
    local ok, message = pcall(own.solve, own, ones)
    assert.falsy(ok)
    assert.truthy(#message < 10000, #message)
    check.near(n / 2, (assert(chain(2):solve(ones)))[1], 1e-9)
  end)

  it("must give numbers, as many as there are rows", function()
    check.raises("must return 60 numbers, got 2", function()
      operator(function() return {1, 2} end):solve(ones)
    end)
    check.raises("must return an array of 60 numbers, got nil", function()
      operator(function() end):solve(ones)
    end)
    check.raises("the product of \"mine\" has nan in row 3", function()
      operator(function(x) return x * (x + bw.array.new((function()
        local t = {}
        for i = 1, n do t[i] = i == 3 and 0 / 0 or 1 end
        return t
      end)())) end, "mine"):solve(ones)
    end)
  end)

  it("is named where its product as a preconditioner is not finite", function()
    local a = chain(2)
    local own = operator(function(x) return a:apply(x) end)
    check.raises("the product of \"near\" has nan in row 1", own.solve, own, ones,
      {preconditioner = operator(function(x) return x * (0 / 0) end, "near")})
  end)

  it("must be linear, symmetric and positive definite", function()
    local a = chain(2)
    check.fails("singular", "\"mine\" is not positive definite: p . A p = -",
      operator(function(x) return -a:apply(x) end, "mine"):solve(ones))
    check.fails("singular", "\"mine\" is not positive definite: x . A x = -",
      operator(function(x) return -a:apply(x) end, "mine"):eigenpairs())
    local weight = bw.array.range(1, n)
    for _, method in ipairs {"solve", "eigenpairs"} do
      check.raises("\"mine\" is not symmetric: x . A y = ", function()
        local own = operator(function(x) return a:apply(x) * weight end, "mine")
        assert(own[method](own, method == "solve" and bw.array.range(1, n):sorted() or nil))
      end)
    end
    check.fails("convergence", "in 3 iterations; 1e-10 was requested",
      operator(function(x) return a:apply(x) end):solve(ones, {solver = bw.solver.pcg {max_iterations = 3}}))
    check.raises("needs the entries of a sparse matrix, and \"operator\" is an operator", function()
      operator(function(x) return x end):solve(ones, {solver = bw.solver.cholesky()})
    end)
  end)

  it("may be stopped", function()
    local a, calls = chain(2), 0
    local own = operator(function(x)
      calls = calls + 1
      return a:apply(x)
    end)
    local before = bw.progress(function(stage)
      return stage ~= "conjugate gradients" and not stage:find " modes$"
    end)
    local ok, problem = pcall(function()
      check.fails("cancelled", "", own:solve(bw.array.range(1, n) ^ 2))
      check.fails("cancelled", "", own:eigenpairs())
    end)
    bw.progress(before)
    assert.truthy(ok, problem)
    assert.truthy(calls < 40, calls)
    assert(own:solve(ones))
  end)

  it("is collected with its operator, and what is in use is not", function()
    local a = chain(2)
    local kept = setmetatable({}, {__mode = "k"})
    do
      local own
      local apply = function(x) return own and a:apply(x) end -- a cycle
      own = operator(apply)
      kept[apply] = true
      assert(own:solve(ones))
    end
    collectgarbage()
    collectgarbage()
    assert.equal(nil, next(kept))
    -- the only references go away while the solver runs
    local options = {}
    options.preconditioner = operator(function(x)
      options.preconditioner = nil
      options.solver = nil
      collectgarbage()
      return x * 1
    end)
    options.solver = bw.solver.pcg()
    local x = assert(operator(function(v)
      collectgarbage()
      return a:apply(v)
    end):solve(ones, options))
    check.near(n / 2, x[1], 1e-8)
    -- and so do the objects themselves
    local solver, matrix = bw.solver.pcg(), chain(2)
    local own
    own = operator(function(v)
      solver:close()
      matrix:close()
      return a:apply(v)
    end)
    assert(matrix:solve(ones, {preconditioner = own, solver = solver}))
    own = operator(function(v)
      own:close()
      return a:apply(v)
    end)
    check.raises("it was closed while it was in use", own.solve, own, ones)
  end)

  it("is called on the script's thread alone: the bits are the same on any number", function()
    local a = chain(2, 5000)
    local own = bw.operator {size = 5000, apply = function(x) return a:apply(x) end}
    local b, before, bits = bw.array.range(1, 5000), bw.threads(), nil
    for threads = 1, 2 do
      bw.threads(threads)
      local x = assert(own:solve(b, {preconditioner = chain(2.0001, 5000):inverse()}))
      bits = bits or x:tostring "<f8"
      assert.equal(bits, x:tostring "<f8")
    end
    bw.threads(before)
  end)
end)

describe("memory that runs out", function()
  it("is reported, and nothing is lost", function()
    local core = require "barwright.core"
    local a = chain(2)
    local own = operator(function(x) return a:apply(x) end)
    local preconditioner = assert(chain(2.1):inverse())
    local function works(method)
      local ok, found, message, details = pcall(function()
        if method == "solve" then return own:solve(ones, {preconditioner = preconditioner}) end
        return own:eigenpairs {count = 1, preconditioner = preconditioner, test = false}
      end)
      core.fail_allocation(0, false)
      if ok and found then return true end
      assert.truthy(ok and details.status == "memory" or tostring(found):find "memory", message or found)
    end
    -- Young garbage first: a whole collection of what other tests left takes longer than the call.
    local function blocks(expected)
      if expected then collectgarbage "step" end
      local count = select(2, core.external())
      if count == expected then return count end
      collectgarbage()
      collectgarbage()
      return select(2, core.external())
    end
    local former = collectgarbage "generational"
    finally(function() collectgarbage(former) end)
    for _, method in ipairs {"solve", "eigenpairs"} do
      local before, count = blocks(), 0
      local done
      repeat
        count = count + 1
        core.fail_allocation(count, false)
        done = works(method)
        assert.equal(before, blocks(before))
      until done
      assert.truthy(count > 4)
    end
  end)
end)

describe("arguments", function()
  it("are checked in words", function()
    local a = chain(2)
    check.raises("option 'size' is missing", bw.operator, {apply = function() end})
    check.raises("option 'size': a number of rows of 1 or more expected", bw.operator, {size = 0})
    check.raises("option 'apply': a function of x expected", bw.operator, {size = 1, apply = 3})
    check.raises("option 'name': a string expected", bw.operator, {size = 1, name = {}, apply = print})
    check.raises("b: 60 rows expected", a.solve, a, {1, 2})
    check.raises("option 'preconditioner': an operator or a sparse matrix expected", a.solve, a, ones,
      {preconditioner = bw.solver.jacobi()})
    check.raises("option 'guess': 1 columns expected", a.solve, a, ones, {guess = bw.array.zeros(n, 2)})
    check.raises("works on the elements of a body", function() assert(a:inverse(bw.solver.two_level())) end)
    check.raises("conjugate gradients give no inverse", a.inverse, a, bw.solver.pcg())
    check.raises("give cholesky or jacobi", a.inverse, a, bw.solver.lu())
    check.raises("the matrix of 2 x 3 is not square", function()
      local wide = bw.sparse_matrix.new(2, 3, {}, {}, {})
      wide:solve {1, 2, 3}
    end)
    check.raises("eigenpairs were requested", a.eigenpairs, a, {count = 0})
    assert.equal("operator \"mine\" of 60 rows", tostring(operator(print, "mine")))
  end)

  it("inverses are operators", function()
    local a = chain(2)
    for _, solver in ipairs {bw.solver.cholesky(), bw.solver.cholesky {backend = "cholmod"}} do
      local inverse = assert(a:inverse(solver))
      assert.equal(n, inverse.size)
      assert.equal("cholesky", inverse.name)
      assert.truthy((a:apply(inverse:apply(ones)) - ones):norm() < 1e-9)
    end
    check.near(0.5, assert(a:inverse(bw.solver.jacobi())):apply(ones)[7], 1e-15)
    check.fails("singular", "is not positive definite: elimination fails at row", chain(-1):inverse())
  end)
end)
