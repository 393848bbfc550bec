---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Eigensolvers
--
-- Methods for the lowest modes, as descriptions that `part:modes`, `bw.worst_case` and `bw.breaking_force` take, and `eigenpairs`
-- of matrices and operators.

---Descriptions of eigensolvers. Each is made once and used as often as one likes; `print` shows it. All give the same modes
---within the tolerance. Without one the default of docs/choosing_a_solver.md is used.
---@class bw.EigensolverModule
local eigensolver_module = {}

---A method for the lowest modes: an immutable description.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.02, 0.01}, cells = {10, 2, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---local modes = assert(part:modes {count = 5, solver = bw.eigensolver.arpack {}})
---print(modes.report.solver, modes.report.reason, modes.report.residual)
---```
---@class bw.Eigensolver
---@field name "lanczos"|"arpack"|"lobpcg"|"slepc" the method
local Eigensolver = {}

---Releases the description at once.
function Eigensolver:close() end

---The block Lanczos method on the inverse, with a factor of the stiffness. A pass over the factor serves eight right-hand
---sides, and modes of multiplicity up to eight are found at once.
---```lua
---local solver = bw.eigensolver.lanczos {}
---print(solver) -- eigensolver lanczos
---```
---
---Source: docs/theory/solving.md; R. G. Grimes, J. G. Lewis and H. D. Simon, SIAM J. Matrix Anal. Appl. 15 (1994).
---@param options? bw.EigensolverLanczosOptions its basis
---@return bw.Eigensolver solver the description
function eigensolver_module.lanczos(options) end

---How the block Lanczos method works.
---@class bw.EigensolverLanczosOptions
---@field basis? integer (count) vectors of the basis, from which it restarts; at least the number of modes and 16. Range: 0 to 100000. Default: 0, three times the number of modes and 48

---The implicitly restarted Lanczos method of ARPACK-ng on the inverse, one right-hand side at a time. Runs of several threads
---take turns. Where the body has too few degrees of freedom for its basis, block Lanczos takes its place, and the report says
---so.
---```lua
---local solver = bw.eigensolver.arpack {basis = 60}
---print(solver) -- eigensolver arpack, 60 basis vectors
---```
---
---Source: R. B. Lehoucq, D. C. Sorensen and C. Yang, ARPACK Users' Guide, SIAM 1998.
---@param options? bw.EigensolverArpackOptions its basis
---@return bw.Eigensolver solver the description
function eigensolver_module.arpack(options) end

---How ARPACK works.
---@class bw.EigensolverArpackOptions
---@field basis? integer (count) vectors of the basis, from which it restarts; at least the number of modes and 2. Range: 0 to 100000. Default: 0, twice the number of modes and 20

---The locally optimal block preconditioned conjugate gradient method, for bodies whose factor does not fit into memory. It
---needs no factor: on quadratic elements its preconditioner is the two-level one, on linear elements algebraic multigrid. Where
---the equations have a factor already, that is the preconditioner. Without a factor nothing counts the modes: an iteration from
---random vectors looks for missing ones (`modes.tested`).
---```lua
---local mesh = bw.mesh.box {max = {0.3, 0.1, 0.1}, cells = {6, 2, 2}, order = 2}
---local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
---local modes = assert(part:modes {count = 3, solver = bw.eigensolver.lobpcg {}})
---print(modes.report.preconditioner, modes.tested) -- two_level true
---```
---
---Source: docs/theory/solving.md; A. V. Knyazev, SIAM J. Sci. Comput. 23 (2001).
---@param options? bw.EigensolverLobpcgOptions its preconditioner
---@return bw.Eigensolver solver the description
function eigensolver_module.lobpcg(options) end

---How LOBPCG works.
---@class bw.EigensolverLobpcgOptions
---@field preconditioner? bw.Solver of `two_level`, for quadratic elements, or `amg`. Default: a factor where the equations have one, else by the elements

---The Krylov-Schur method of SLEPc, on all processes that mpirun started (docs/howto_cluster.md). It takes a model, and not
---the modes of the Laplacian.
---```lua
---local multigrid = bw.solver.amg {backend = "petsc"}
---local solver = bw.eigensolver.slepc {inner = bw.solver.pcg {preconditioner = multigrid}}
---print(solver) -- eigensolver slepc, inner systems by pcg (amg (petsc))
---```
---@param options? bw.EigensolverSlepcOptions how its inner systems are solved
---@return bw.Eigensolver solver the description
function eigensolver_module.slepc(options) end

---How SLEPc solves its inner systems.
---@class bw.EigensolverSlepcOptions
---@field inner? bw.Solver|"auto" of the backend "petsc": `bw.solver.cholesky`, a factor by MUMPS, with a count of the eigenvalues; or `bw.solver.pcg` with `bw.solver.amg`, without one. Default: "auto", the factor
