---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Operators
--
-- Square matrices that are known by their products alone, from a function of the script or as the inverse of a matrix, and
-- eigenpairs of matrices and operators.

---@class bw
local bw = {}

---An operator whose product a function of the script computes. Conjugate gradients and LOBPCG need no more. The function must be
---linear and always the same. It is called on the thread of the script, and may call barwright, other operators and solvers too.
---Its errors end the solver and are raised again.
---
---Errors: only those that every function may give. Options that are wrong raise.
---```lua
---local a = bw.sparse_matrix.new(3, 3, {1, 2, 3, 1, 2}, {1, 2, 3, 2, 1}, {2, 2, 5, -1, -1})
---local normal = bw.array {1, 1, 1} -- a spring along it
---local with = bw.operator {size = 3, apply = function(x) return a:apply(x) + 10 * normal:dot(x) * normal end}
---print(assert(with:solve({1, 0, 0}, {preconditioner = a:inverse()}))[1])
---```
---@param options bw.OperatorOptions its size and its function
---@return bw.Operator? operator the operator
---@return string? message
---@return bw.Details? details
function bw.operator(options) end

---What an operator is made of.
---@class bw.OperatorOptions
---@field size integer (count) of rows, and of columns. Range: 1 and more
---@field apply fun(x: bw.Array): bw.Array|number[] (any, size × 1) the product with an array of `size` numbers, in an array or a list
---@field name? string what messages call it. Default: "operator"

---A square matrix that is known by its products. `matrix:inverse` gives one, too.
---```lua
---local twice = bw.operator {size = 3, apply = function(x) return 2 * x end}
---print(twice, twice:apply({1, 2, 3})[3]) -- operator "operator" of 3 rows 6.0
---```
---@class bw.Operator
---@field size integer (count) of rows, and of columns
---@field name string what messages call it
local Operator = {}

---The product with a vector. A function that gives too few numbers, or one that is not finite, raises.
---
---Errors: only those that every function may give.
---@param x bw.Array|number[] (any, size × 1) the vector
---@return bw.Array? y (any, size × 1) the product
---@return string? message
---@return bw.Details? details
function Operator:apply(x) end

---Solves A x = b by preconditioned conjugate gradients; A must be symmetric and positive definite.
---
---Errors: singular (not positive definite; `details.operator` names it), convergence (`details.iterations`,
---`details.residual`), limit (2^31 - 1 rows). An operator that is not symmetric raises, where conjugate gradients fail for it.
---
---Source: Y. Saad, Iterative Methods for Sparse Linear Systems (2003), section 9.2.
---@param b bw.Array|number[] (any, size × k) right-hand sides, a column each
---@param options? bw.LinearSolveOptions solver, preconditioner, guess
---@return bw.Array? x (any, size × k) the solutions
---@return bw.SolverReport|string report what the solver did, or the message
---@return bw.Details? details
function Operator:solve(b, options) end

---How A x = b is solved.
---@class bw.LinearSolveOptions
---@field solver? bw.Solver|"auto" `cholesky`, for sparse matrices, or `pcg` with `jacobi` or `cholesky` of the matrix itself. Default: "auto", a factor of a sparse matrix; conjugate gradients for an operator, and where a preconditioner is given
---@field preconditioner? bw.Operator|bw.SparseMatrix of conjugate gradients: near the inverse of A, symmetric and positive definite. Default: that of the solver; the inverse of the diagonal of a sparse matrix, none for an operator
---@field guess? bw.Array|number[] (any, size × k) where conjugate gradients begin. Default: 0

---The smallest eigenvalues of K x = λ M x and their vectors, K being the operator. LOBPCG serves operators; it needs a
---preconditioner near the inverse of K unless that is well-conditioned.
---
---Errors: singular (K - shift M, or M, is not positive definite), convergence, unsupported (SLEPc, preconditioners of bodies),
---limit (too many pairs). A matrix or an operator that is not symmetric raises.
---
---Source: docs/theory/solving.md; A. V. Knyazev, SIAM J. Sci. Comput. 23 (2001).
---@param options? bw.EigenpairsOptions how many, mass, eigensolver
---@return bw.Eigenpairs? pairs fewer than asked for where there are fewer
---@return string? message
---@return bw.Details? details
function Operator:eigenpairs(options) end

---Releases the operator at once. What uses it goes on, but a function of the script is not called any more.
function Operator:close() end

---How eigenpairs are found.
---@class bw.EigenpairsOptions
---@field count? integer (count) pairs wanted. Range: 1 and more. Default: 6
---@field mass? bw.SparseMatrix|bw.Operator M, symmetric and positive definite. Default: the identity
---@field solver? bw.Eigensolver|"auto" `lanczos` and `arpack` for sparse matrices, `lobpcg`. Default: "auto", block Lanczos where K - shift M is a sparse matrix, else LOBPCG, and LOBPCG where a preconditioner is given
---@field preconditioner? bw.Operator|bw.SparseMatrix of LOBPCG: near the inverse of K - shift M, symmetric and positive definite. Default: the inverse of the diagonal of a sparse matrix without shift, else none
---@field tolerance? number (-) relative residual. Range: above 0, below 1. Default: 1e-8
---@field shift? number (any) a number below all eigenvalues, for a K that is singular. Default: 0
---@field test? boolean look for pairs that are missing. Default: true
---@field seed? integer (count) of the start vectors. Default: 1

---Eigenvalues and their vectors. `print` shows the first and the last value with their errors.
---```lua
---local a = bw.sparse_matrix.new(3, 3, {1, 2, 3, 1, 2}, {1, 2, 3, 2, 1}, {2, 2, 5, 1, 1})
---local found = assert(a:eigenpairs {count = 2})
---print(found.values[1], found.errors[1] < 1e-9, found:vector(1)[3]) -- 1.0 true 0.0
---```
---@class bw.Eigenpairs
---@field count integer (count) of pairs
---@field values bw.Array (any, count × 1) the eigenvalues, ascending
---@field errors bw.Array (any, count × 1) an eigenvalue lies within this distance of the value, but for rounding: the residual in the norm of M⁻¹. Infinite where M is too ill-conditioned
---@field residuals bw.Array (-, count × 1) |K x - λ M x| over |(λ - shift) M x|
---@field counted boolean whether the Sturm count confirmed that none is missing; of sparse matrices
---@field tested boolean whether an iteration from random vectors found none below the last one, where nothing counts
---@field recovered integer (count) of pairs found only after the test showed that they were missing
---@field report bw.SolverReport how they were found
local Eigenpairs = {}

---An eigenvector: x · M x = 1, the largest component positive.
---@param k integer (index from 1) which one
---@return bw.Array x (any, size × 1) the vector
function Eigenpairs:vector(k) end

---Releases the pairs at once.
function Eigenpairs:close() end
