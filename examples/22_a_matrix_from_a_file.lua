-- SPDX-License-Identifier: MIT
-- Lesson 22: a matrix of another program, from a Matrix Market file.
--
-- Any symmetric positive definite matrix can be solved: by the engine's factor, by CHOLMOD, by conjugate
-- gradients. So can its smallest eigenvalues be found, by three eigensolvers.
--
--   build/barwright examples/22_a_matrix_from_a_file.lua [FOLDER]
local bw = require "barwright"
local folder = arg[1] or "."

-- What another program would have written: the Laplacian of a square of n x n points, its lower triangle.
local n = 60
local file = assert(io.open(folder .. "/poisson.mtx", "w"))
file:write("%%MatrixMarket matrix coordinate real symmetric\n", n * n, " ", n * n, " ", 3 * n * n - 2 * n, "\n")
for i = 1, n * n do
  if i > n then file:write(i, " ", i - n, " -1\n") end
  if i % n ~= 1 then file:write(i, " ", i - 1, " -1\n") end
  file:write(i, " ", i, " 4\n")
end
file:close()

local a = assert(bw.sparse_matrix.read(folder .. "/poisson.mtx"))
print(a, a.symmetric and "symmetric" or "not symmetric")

-- One right-hand side, by each solver.
local b = bw.array.zeros(n * n) + 1
local solver = bw.solver
for _, one in ipairs {solver.cholesky(), solver.cholesky {backend = "cholmod"}, solver.cholesky {precision = 32},
  solver.pcg {preconditioner = solver.jacobi()}} do
  local x, report = assert(a:solve(b, {solver = one}))
  print(("%-20s largest x %.6f, %s"):format(one, x:max(), report))
end

-- Several right-hand sides with one factor: columns of an array, or one after the other.
local inverse = assert(a:inverse())
print(("x . b = %.4f"):format(inverse:apply(b):dot(b)))

-- The smallest eigenvalues are 4 - 2 cos(i pi / (n + 1)) - 2 cos(j pi / (n + 1)).
local exact = 4 - 4 * math.cos(math.pi / (n + 1))
local eigensolver = bw.eigensolver
for _, one in ipairs {eigensolver.lanczos(), eigensolver.arpack(), eigensolver.lobpcg()} do
  local found = assert(a:eigenpairs {count = 4, solver = one,
    preconditioner = one.name == "lobpcg" and inverse or nil})
  print(found, ("off by %.1e"):format(math.abs(found.values[1] - exact)))
end

assert(inverse:apply(b):write(folder .. "/x.npy")) -- NumPy reads it
