---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Linear solvers
--
-- Linear solvers and preconditioners: made once, printable, and handed as `solver` to whatever solves.

---Linear solvers and preconditioners. Without one, or with "auto", the solver is chosen by counted operations and bytes.
---@class bw.SolverModule
local solver_module = {}

---A sparse Cholesky factor, K = L Lᵀ. It serves further solutions, modes and worst cases of the same model. Options that the
---backend does not have raise.
---
---Errors: only those that every function may give.
---
---Source: docs/theory/solving.md; Y. Chen, T. A. Davis, W. W. Hager and S. Rajamanickam, ACM Trans. Math. Softw. 35 (2008).
---```lua
---local solver = bw.solver.cholesky {backend = "cholmod"}
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {20, 2, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):gravity {0, 0, -9.81}
---print(solver, assert(part:solve {solver = solver}).report)
---```
---@param options? bw.CholeskyOptions who computes it, and how
---@return bw.Solver? solver the solver
---@return string? message
---@return bw.Details? details
function solver_module.cholesky(options) end

---How a factor is computed.
---@class bw.CholeskyOptions
---@field backend? "auto"|"multifrontal"|"cholmod"|"petsc" who computes it. "multifrontal" is the engine's own: it gives the same bits on any number of threads, and follows edits. "cholmod" is CHOLMOD's supernodal factor: its last bits depend on the number of threads, and an interruption takes effect only after it. "petsc" is a factor by MUMPS over all processes that mpirun started (docs/howto_cluster.md). Default: "auto", the factor that the equations already have, or "multifrontal"
---@field ordering? "auto"|"metis"|"amd"|"backend" the elimination order: nested dissection or approximate minimum degree of the nodes, or the backend's own of the unknowns. "petsc" has its own only. Default: "auto", nested dissection
---@field precision? 32|64 (bits) of the factor's numbers. Solutions are in double precision in any case: a factor of 32 bits is refined by conjugate gradients. "cholmod" and "petsc" have 64 only. Default: 64, in edit sessions by predicted cost
---@field full? boolean compute the whole factor again where a part or the former analysis would do, in edit sessions and analyses that follow an outline; solids refuse it. Default: false

---Preconditioned conjugate gradients.
---
---Errors: only those that every function may give.
---
---Source: Y. Saad, Iterative Methods for Sparse Linear Systems (2003), section 9.2.
---```lua
---local solver = bw.solver.pcg {preconditioner = bw.solver.jacobi(), tolerance = 1e-8}
---print(solver, solver.preconditioner.kind)
---```
---@param options? bw.PcgOptions preconditioner and limits
---@return bw.Solver? solver the solver
---@return string? message
---@return bw.Details? details
function solver_module.pcg(options) end

---How conjugate gradients work.
---@class bw.PcgOptions
---@field preconditioner? bw.Solver of `two_level`, `amg`, `jacobi` or `cholesky`. Default: `two_level`; of a sparse matrix `jacobi`
---@field tolerance? number (-) relative residual to be reached; of many right-hand sides (`part:system`, `bw.worst_case`, `bw.breaking_force`, `bw.drop_test`) the error in energy over that of the solution. Range: above 0, below 1. Default: 1e-10, of many right-hand sides and of sheets 1e-8; in Newton's method of solids by Eisenstat and Walker
---@field max_iterations? integer (count) at most. Range: 1 and more. Default: 2000; in Newton's method of solids 10000, of sheets 60 before the factor is computed again

---A sparse LU factor, A = L U, for the unsymmetric equations of flows. Its node blocks are factored in single precision,
---or by UMFPACK with pivoting where that does not suffice.
---
---Errors: only those that every function may give.
---
---Source: docs/theory/responsive.md; T. A. Davis, ACM Trans. Math. Softw. 30 (2004).
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local walls = {left = {x = 0.1, y = 0}, top = "wall", bottom = "wall"}
---local flow = assert(bw.responsive.flow {outline = outline, viscosity = 1e-3, step = 0.01, conditions = walls,
---  elements = 300, solver = bw.solver.lu()})
---print(assert(flow:step()).report)
---```
---@param options? bw.LuOptions how it is computed
---@return bw.Solver? solver the solver
---@return string? message
---@return bw.Details? details
function solver_module.lu(options) end

---How an LU factor is computed.
---@class bw.LuOptions
---@field full? boolean with a new symbolic analysis each time. Default: false

---Stabilised biconjugate gradients, for the unsymmetric equations of flows, preconditioned by the LU factor of a former
---step.
---
---Errors: only those that every function may give.
---
---Source: Y. Saad, Iterative Methods for Sparse Linear Systems (2003), section 7.4.2.
---```lua
---local solver = bw.solver.bicgstab {tolerance = 1e-8}
---print(solver) -- bicgstab (lu, tolerance 1e-08)
---```
---@param options? bw.BicgstabOptions preconditioner and limits
---@return bw.Solver? solver the solver
---@return string? message
---@return bw.Details? details
function solver_module.bicgstab(options) end

---How stabilised biconjugate gradients work.
---@class bw.BicgstabOptions
---@field preconditioner? bw.Solver of `lu`. Default: `lu`
---@field tolerance? number (-) relative residual to be reached. Range: above 0, below 1. Default: 1e-6
---@field max_iterations? integer (count) before the factor is computed again. Range: 1 and more. Default: 60

---The two-level preconditioner: a smoother over all nodes, and the linear elements on the same corners solved by a factor. For
---quadratic elements.
---
---Errors: only those that every function may give.
---
---Source: docs/theory/solving.md.
---```lua
---local preconditioner = bw.solver.two_level()
---print(bw.solver.pcg {preconditioner = preconditioner})
---```
---@param options? bw.NoSolverOptions none
---@return bw.Solver? solver the preconditioner
---@return string? message
---@return bw.Details? details
function solver_module.two_level(options) end

---Options of preconditioners that have none.
---@class bw.NoSolverOptions

---Algebraic multigrid by smoothed aggregation as a preconditioner, mainly for linear elements. PETSc's works on all processes
---that mpirun started (docs/howto_cluster.md). The engine's own also serves parts that can move freely.
---
---Errors: only those that every function may give.
---
---Source: P. Vanek, J. Mandel, M. Brezina, Algebraic multigrid by smoothed aggregation (1996); docs/theory/preconditioners.md.
---```lua
---local preconditioner = bw.solver.amg()
---print(bw.solver.pcg {preconditioner = preconditioner})
---```
---@param options? bw.AmgOptions who computes it
---@return bw.Solver? solver the preconditioner
---@return string? message
---@return bw.Details? details
function solver_module.amg(options) end

---Who computes a multigrid hierarchy.
---@class bw.AmgOptions
---@field backend? "auto"|"petsc" PETSc's GAMG, for quadratic elements below linear ones on their corners. Default: "auto", the engine's own

---Block Jacobi as a preconditioner: the inverse of the diagonal blocks of the nodes.
---
---Errors: only those that every function may give.
---
---Source: Y. Saad, Iterative Methods for Sparse Linear Systems (2003), section 10.2.
---```lua
---local preconditioner = bw.solver.jacobi()
---print(bw.solver.pcg {preconditioner = preconditioner})
---```
---@param options? bw.NoSolverOptions none
---@return bw.Solver? solver the preconditioner
---@return string? message
---@return bw.Details? details
function solver_module.jacobi(options) end

---A linear solver or a preconditioner. It never changes; `print` shows it in a line.
---```lua
---local solver = bw.solver.pcg {tolerance = 1e-8}
---print(solver.kind, solver.tolerance, solver.max_iterations) -- pcg 1e-08 nil
---```
---@class bw.Solver
---@field kind "cholesky"|"pcg"|"two_level"|"amg"|"jacobi"|"lu"|"bicgstab" what it is
---@field backend string? of a factor and of multigrid: who computes it
---@field ordering string? of a factor: the elimination order
---@field precision integer? (bits) of a factor: as it was given
---@field full boolean? of a factor: whether it is computed again as a whole
---@field preconditioner bw.Solver? of `pcg` and `bicgstab`, as it was given
---@field tolerance number? (-) of `pcg` and `bicgstab`: relative residual, as it was given
---@field max_iterations integer? (count) of `pcg` and `bicgstab`, as it was given
local Solver = {}

---What a solver did, and why it was chosen. `print` shows it in a line. Predicted costs are those of one reference machine.
---@class bw.SolverReport
---@field solver string the method: "cholesky", "pcg"; of flows "lu", "bicgstab"; of linear programs "dual_simplex", or "simplex" of GLPK; of modes "lanczos", "arpack", "lobpcg" or "slepc"
---@field backend string? which program: "multifrontal", "cholmod", "petsc", "umfpack", "barwright", "glpk"
---@field preconditioner string? "two_level", "amg", "jacobi", "cholesky", "lu", or "operator" of the script's own
---@field reason string? why it was chosen
---@field predicted_cost number? (s) where it was chosen by cost: predicted
---@field rival_cost number? (s) likewise, of the next best solver
---@field flops number? (count) operations of the factorisation
---@field bytes number? (bytes) of the factor or the preconditioner, or of a linear program; of modes with the basis of an eigensolver; with PETSc of all processes at their peaks
---@field seconds number? (s) spent; on linear programs by all threads together
---@field iterations integer? (count) of conjugate gradients, or of all linear programs; of an eigensolver: restarts, of LOBPCG iterations
---@field residual number? (-) relative, at the end; of linear programs the largest violation, as a fraction of the total force
---@field reused number? (-) fraction of the work that an earlier solution had done
---@field ranks integer? (count) of PETSc and SLEPc: processes
---@field send_seconds number? (s) of PETSc and SLEPc: sending the mesh
---@field assembly_seconds number? (s) of PETSc and SLEPc: assembly on the ranks
---@field setup_seconds number? (s) of PETSc and SLEPc: multigrid or factor
---@field solve_seconds number? (s) of PETSc and SLEPc: solving
---@field processor_seconds number? (s) of PETSc and SLEPc: processor time of all processes
---@field largest_rank_bytes number? (bytes) of PETSc and SLEPc: memory of the largest process
---@field energy_error number? (-) of PETSc's conjugate gradients: estimated error of a solution in energy, over that of the solution

---Releases the solver at once. What it was handed to keeps it.
function Solver:close() end
