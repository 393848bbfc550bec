---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Sparse matrices
--
-- Stiffness and mass of a system as matrices, and matrices in files that other programs read: Matrix Market (`.mtx`) and SciPy
-- (`.npz`). Right-hand sides are arrays, in `.npy` and `.mtx` files.

---Sparse matrices, from entries and from files.
---@class bw.SparseMatrixModule
local sparse_matrix_module = {}

---A matrix from its entries, in any order. Entries at one place are added. Numbers outside of the matrix raise.
---```lua
---local a = bw.sparse_matrix.new(2, 2, {1, 1, 2, 2}, {1, 2, 1, 2}, {2, -1, -1, 2})
---print(a, a.symmetric, a:apply({1, 1})[1]) -- 1
---```
---@param row_count integer (count) of rows
---@param column_count integer (count) of columns
---@param rows bw.Array|integer[] (index from 1, n × 1) the row of each entry
---@param columns bw.Array|integer[] (index from 1, n × 1) its column
---@param values bw.Array|number[] (any, n × 1) its value
---@return bw.SparseMatrix matrix the sum
function sparse_matrix_module.new(row_count, column_count, rows, columns, values) end

---A matrix from a file: Matrix Market in coordinate format (real, integer or pattern; general, symmetric or skew-symmetric), or an
---archive of `scipy.sparse.save_npz` in the format CSR. The content decides, not the name.
---
---Errors: io, format (the file is damaged, or an array; `details.line` or `details.byte`), unsupported (complex numbers, other
---formats of SciPy), limit (2^31 - 1 rows, 4 GiB).
---
---Source: R. Boisvert, R. Pozo and K. Remington, The Matrix Market Exchange Formats, NISTIR 5935 (1996).
---```lua
---assert(bw.sparse_matrix.new(2, 3, {1, 2}, {3, 1}, {0.5, 4}):write "a.mtx")
---print(assert(bw.sparse_matrix.read "a.mtx")) -- sparse matrix of 2 x 3, 2 entries
---```
---@param path string the file
---@return bw.SparseMatrix? matrix what is in it
---@return string? message
---@return bw.Details? details
function sparse_matrix_module.read(path) end

---A matrix of which only entries are stored. It does not change. `system:matrix` gives those of a part.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
---local k = assert(part:system()):matrix "stiffness"
---print(k.row_count, k.symmetric, k:write "k.npz")
---```
---@class bw.SparseMatrix
---@field row_count integer (count) of rows
---@field column_count integer (count) of columns
---@field entry_count integer (count) of entries that are stored; both triangles of a symmetric matrix
---@field symmetric boolean whether it is equal to its transpose
local SparseMatrix = {}

---Writes it, by the ending of the path: `.mtx` is Matrix Market, with the lower triangle of a symmetric matrix; `.npz` is what
---`scipy.sparse.load_npz` reads. Numbers are read back to the last bit.
---
---Errors: io, unsupported (another ending), limit (4 GB in an archive).
---@param path string the file
---@return boolean? written true
---@return string? message
---@return bw.Details? details
function SparseMatrix:write(path) end

---The product with a vector.
---@param x bw.Array|number[] (any, column_count × 1) the vector
---@return bw.Array y (any, row_count × 1) the product
function SparseMatrix:apply(x) end

---Solves A x = b with a symmetric positive definite matrix: by a factor, or by preconditioned conjugate gradients. Matrices of
---other programs may be symmetric to rounding only.
---```lua
---local a = bw.sparse_matrix.new(2, 2, {1, 1, 2, 2}, {1, 2, 1, 2}, {2, -1, -1, 2})
---local x, report = assert(a:solve({1, 1}, {solver = bw.solver.cholesky {backend = "cholmod"}}))
---print(x[1], report.backend) -- 1.0 cholmod
---```
---
---Errors: singular (not positive definite; of a factor `details.row`, of conjugate gradients `details.operator`), convergence
---(`details.iterations`, `details.residual`), unsupported (preconditioners of bodies, PETSc), limit (too many entries of the
---factor), memory (`details.bytes`, before any is taken). A matrix that is not symmetric raises.
---
---Source: docs/theory/solving.md; Y. Saad, Iterative Methods for Sparse Linear Systems (2003), section 9.2.
---@param b bw.Array|number[] (any, row_count × k) right-hand sides, a column each
---@param options? bw.LinearSolveOptions solver, preconditioner, guess
---@return bw.Array? x (any, row_count × k) the solutions
---@return bw.SolverReport|string report what the solver did, or the message
---@return bw.Details? details
function SparseMatrix:solve(b, options) end

---The inverse as an operator, by a factor that is kept: for further right-hand sides, or as a preconditioner of similar matrices
---and operators. `bw.solver.jacobi()` gives the inverse of the diagonal.
---```lua
---local a = bw.sparse_matrix.new(2, 2, {1, 1, 2, 2}, {1, 2, 1, 2}, {2, -1, -1, 2})
---local inverse = assert(a:inverse())
---print(inverse:apply({1, 1})[1], inverse.name) -- 1.0 cholesky
---```
---
---Errors: singular (not positive definite; `details.row`), unsupported (preconditioners of bodies, PETSc), limit (too many
---entries of the factor), memory (`details.bytes`, before any is taken). A matrix that is not symmetric raises.
---@param solver? bw.Solver `cholesky` or `jacobi`; a factor of 32 bits has its digits. Default: `cholesky`
---@return bw.Operator? inverse the operator
---@return string? message
---@return bw.Details? details
function SparseMatrix:inverse(solver) end

---The smallest eigenvalues of K x = λ M x and their vectors, K being the matrix.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.02, 0.01}, cells = {8, 2, 1}, order = 2}
---local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
---local system = assert(part:system())
---local found = assert(system:matrix "stiffness":eigenpairs {mass = system:matrix "mass", count = 3})
---print(found, math.sqrt(found.values[1]) / (2 * math.pi))
---```
---
---Errors: singular (K - shift M, or M, is not positive definite), convergence, unsupported (SLEPc, preconditioners of bodies),
---limit (too many pairs, or entries of the factor), memory (`details.bytes`, before any is taken). A matrix or an operator that
---is not symmetric raises.
---
---Source: docs/theory/solving.md; B. N. Parlett, The Symmetric Eigenvalue Problem (1998).
---@param options? bw.EigenpairsOptions how many, mass, eigensolver
---@return bw.Eigenpairs? pairs fewer than asked for where there are fewer
---@return string? message
---@return bw.Details? details
function SparseMatrix:eigenpairs(options) end

---The entries, by rows, columns ascending in each row.
---@return bw.Array rows (index from 1, n × 1) the row of each
---@return bw.Array columns (index from 1, n × 1) its column
---@return bw.Array values (any, n × 1) its value
function SparseMatrix:entries() end

---Releases the matrix at once.
function SparseMatrix:close() end
