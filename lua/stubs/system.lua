---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Systems
--
-- The equations of a part and what solves them, for many loads of one part.

---The equations of a part, K u = f, and a factor of K, or the preconditioner of conjugate gradients. `part:system()` gives it.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}, order = 2}
---local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
---part:load {on = mesh.boundary:above("x", 0.1), force = {0, 0, -10}}
---local system = assert(part:system())
---print(assert(system:solve(part:force_vector())):column(3):min())
---```
---@class bw.System
---@field times bw.SolveTimes what its parts took
---@field report bw.SolverReport? what solves it, why, and what its solutions took since `part:system`; the residual is |f − K u| / |f|, the largest of all right-hand sides, and is there with iterations alone; nil for equations of an edit session
---@field unknown_count integer (count) of degrees of freedom
---@field rigid_mode_count integer (count) rigid-body motions that are free
local System = {}

---The displacement under nodal forces, with supports at zero. On a free body inertia balances the force first, and the
---displacement has no rigid-body motion. A list of forces is solved in one block, which is faster.
---
---Errors: singular (the solution is not finite), convergence (conjugate gradients do not reach their tolerance).
---@param force bw.Array|bw.Array[] (N, node_count × 3, per node) one, or a list
---@return bw.Array|bw.Array[]|nil displacement (m, node_count × 3, per node) one, or a list
---@return string? message
---@return bw.Details? details
function System:solve(force) end

---The lowest natural frequencies and mode shapes: see `model:modes`.
---
---Errors: convergence (the modes did not converge). An eigensolver on the inverse of equations without a factor raises.
---@param options? bw.SystemModesOptions how many
---@return bw.Modes? modes the modes
---@return string? message
---@return bw.Details? details
function System:modes(options) end

---Load factors under a displacement of these equations, without temperatures: see `static:buckling`.
---
---Errors: those of `static:buckling`. Equations of an edit session without a factor raise.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.01, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
---part:load {on = mesh.boundary:above("x", 0.2), force = {-100, 0, 0}}
---local system = assert(part:system())
---local u = assert(system:solve(part:force_vector()))
---print(assert(system:buckling(u, {count = 1})).factor)
---```
---@param displacement bw.Array|number[][] (m, node_count × 3, per node) such as `system:solve` gives
---@param options? bw.BucklingOptions how many, and of which sign
---@return bw.Buckling? buckling the load factors; fewer than asked for where the search ended before
---@return string? message
---@return bw.Details? details
function System:buckling(displacement, options) end

---How modes are computed.
---@class bw.SystemModesOptions
---@field count? integer (count) of modes. Default: 15
---@field tolerance? number (-) of the relative residuals. Range: above 0, below 1. Default: 1e-8
---@field sturm? boolean count the eigenvalues below the last one by an indefinite factor, so that none is missing. Default: true
---@field seed? integer (seed) of the start vector. Default: 1
---@field solver? bw.Eigensolver|"auto" the eigensolver, not that of SLEPc. Default: "auto"

---The stiffness K (N/m) or the mass M (kg) as a sparse matrix. Rows and columns are the unknowns: components x, y, z that no support
---prescribes, node by node. At a node that a support constrains along a direction of its own they are components along the
---support's frame. Of a part that can move freely, as many further components as it has free rigid-body modes are set to zero and
---have no row: K is positive definite then too.
---
---Errors: only those that every function may give.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
---local system = assert(part:system())
---assert(assert(system:matrix "stiffness"):write "k.mtx")
---assert(system:right_hand_side(bw.array.zeros(mesh.node_count, 3)):write "b.npy")
---```
---@param part "stiffness"|"mass" which one
---@param options? bw.SystemMatrixOptions which rows and columns
---@return bw.SparseMatrix? matrix the matrix
---@return string? message
---@return bw.Details? details
function System:matrix(part, options) end

---Which rows and columns a matrix has.
---@class bw.SystemMatrixOptions
---@field whole? boolean all components without supports: row 3 (node - 1) + 1, 2, 3 of node for x, y, z. Default: false

---The right-hand side b of the unknowns: K x = b gives `system:displacement(x)`. The forces that prescribed displacements cause are subtracted.
---@param force bw.Array|number[][] (N, node_count × 3, per node) nodal forces, such as `part:force_vector()`
---@return bw.Array b (N, unknown_count × 1) in the order of the rows of `system:matrix`
function System:right_hand_side(force) end

---The displacement of all nodes from the unknowns; prescribed components have their prescribed values.
---@param x bw.Array|number[] (m, unknown_count × 1) the unknowns, in the order of the rows of `system:matrix`
---@return bw.Array displacement (m, node_count × 3, per node) in directions x, y, z
function System:displacement(x) end

---Releases the equations and their factor at once.
function System:close() end
