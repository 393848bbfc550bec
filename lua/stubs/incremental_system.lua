---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Systems that follow edits
--
-- The equations of an edit session, which are updated subdomain by subdomain. The theory is in docs/theory/edit.md.

---The equations of a part cut into subdomains, updated through edits; `update` changes them. `session:synchronise()` gives them.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}, order = 2}
---local skeleton = bw.skeleton.create {joints = {{0.005, 0, 0}, {0.05, 0, 0}, {0.095, 0, 0}}, bones = {{1, 2}, {2, 3}}}
---local part = bw.model({mesh = mesh, material = bw.material.pla}):fix(mesh.boundary:below("x", 0))
---local session = assert(bw.edit(part:load {on = mesh.boundary:above("x", 0.1), force = {0, 0, -10}}, {skeleton = skeleton}))
---local system, model = assert(session:synchronise())
---print(system.subdomain_count, assert(system:solve(model:force_vector())):column(3):min())
---```
---@class bw.IncrementalSystem
---@field unknown_count integer (count) of degrees of freedom
---@field subdomain_count integer (count) of stiffness subdomains
local IncrementalSystem = {}

---Updates the equations to an edited shape, of which regions may be of another material.
---
---Errors: singular (the matrix is not positive definite), unsupported (a material that is not followed), memory.
---@param model bw.Model of the edited shape
---@param motion bw.Array|number[][] (-, subdomain_count × 19, per stiffness subdomain) how each of them lies against the shape that the system was made at, as of `subdomains:motion`
---@return bw.Reuse? reused what was reused
---@return string? message
---@return bw.Details? details
function IncrementalSystem:update(model, motion) end

---Whether an update can bring the equations to a model's material. Isotropic materials follow isotropic ones. Any follows any where
---the equations were made of one that is not isotropic and keeps its axes.
---@param model bw.Model of the edited shape
---@return boolean follows whether it can
function IncrementalSystem:follows(model) end

---The equations of a part with bonds, attachments or couplings, cut into subdomains; `update` changes them.
---`session:synchronise()` gives them. The stiffness of the bodies apart is updated subdomain by subdomain. The factor of the joined
---equations is recomputed where they changed, in the former elimination order where their pattern did not.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}, order = 2}
---local skeleton = bw.skeleton.create {joints = {{0.005, 0, 0}, {0.05, 0, 0}, {0.095, 0, 0}}, bones = {{1, 2}, {2, 3}}}
---local part = bw.model({mesh = mesh, material = bw.material.pla}):fix(mesh.boundary:below("x", 0)):gravity {0, 0, -9.81}
---local session = assert(bw.edit(part:attach {on = mesh.boundary:above("x", 0.1), mass = 1}, {skeleton = skeleton}))
---local system, model = assert(session:synchronise())
---print(system.subdomain_count, assert(system:statics(model)).displacement:column(3):min())
---```
---@class bw.JoinedIncrementalSystem
---@field subdomain_count integer (count) of stiffness subdomains
local JoinedIncrementalSystem = {}

---Updates the equations to an edited shape, of which regions may be of another material and joints may be others.
---
---Errors: unsupported (a material that is not followed, or a cyclic symmetry), memory.
---@param model bw.Model of the edited shape
---@param motion bw.Array|number[][] (-, subdomain_count × 19, per stiffness subdomain) how each of them lies against the shape that the system was made at, as of `subdomains:motion`
---@return bw.Reuse? reused what was reused
---@return string? message
---@return bw.Details? details
function JoinedIncrementalSystem:update(model, motion) end

---Whether an update can bring the equations to a model's material: as of `bw.IncrementalSystem:follows`.
---@param model bw.Model of the edited shape
---@return boolean follows whether it can
function JoinedIncrementalSystem:follows(model) end

---The static solution of the model that the equations were last updated to. Of the options `solver` (of sparse matrices; left out:
---the kept factor), `check` (of the displacement) and `balance_tolerance` count; the others serve parts without joints.
---
---Errors: those of `part:solve` of such a part, internal (with `check`: the displacement differs by more than 1e-8).
---@param model bw.Model of the edited shape
---@param options? bw.IncrementalSolveOptions how it is solved
---@param reused? bw.Reuse of an update, to be completed. Default: a new one
---@return bw.Static? static the solution
---@return bw.Reuse|string reused what was reused, or the message
---@return bw.Details? details
function JoinedIncrementalSystem:statics(model, options, reused) end

---Releases the equations at once.
function JoinedIncrementalSystem:close() end

---How equations that follow edits are solved.
---@class bw.IncrementalSolveOptions
---@field solver? bw.Solver|"auto" `bw.solver.cholesky` updates the factor where edits touched it, with `full` or by CHOLMOD all of it; `bw.solver.pcg` has the two-level preconditioner, for elements of order 2, or a factor: that of the former shape, as it is. Default: "auto", by predicted cost
---@field tolerance? number (-) of iterations, relative residual; the looser of this and of the solver's. Range: above 0, below 1. Default: the solver's, or 1e-10
---@field precision? 32|64 bits of the factor's numbers, where the solver leaves them open; solutions have double precision in any case. Default: by predicted cost
---@field check? boolean compare stiffness and solution with those from scratch; a difference is an internal error. Default: false
---@field energy? boolean the tolerance is that of the error in energy. Default: false
---@field guess? bw.Array[] (m, node_count × 3, per node) fields near the solution, to begin iterations with. Range: at most 64. Default: none; of a session the last solutions of the load case
---@field further? integer (count) right-hand sides that are still to come for the same shape, for the choice of a solver. Default: 0
---@field max_iteration_ratio? number (-) iterations over predicted ones that the choice of a solver counts with. Default: 0, as so far
---@field inertia_relief? boolean balance a load on a free body by inertia. Default: false
---@field balance_tolerance? number (-) a load is balanced when its part along free motions is below this fraction of its size. Default: 1e-6

---The displacement under nodal forces.
---
---Errors: singular (the matrix is not positive definite), convergence (iterations did not converge), memory.
---@param force bw.Array|number[][] (N, node_count × 3, per node) the forces
---@param options? bw.IncrementalSolveOptions how it is solved
---@param reused? bw.Reuse of an update, to be completed. Default: a new one
---@return bw.Array? displacement (m, node_count × 3, per node) the displacement
---@return bw.Reuse|string reused what was reused, or the message
---@return bw.Details? details
function IncrementalSystem:solve(force, options, reused) end

---The static solution of the model of the last update.
---
---Errors: unconstrained (a load is not balanced against free rigid-body motions), singular, convergence, memory (as of `solve`).
---@param model bw.Model of the last update
---@param options? bw.IncrementalSolveOptions how it is solved
---@param reused? bw.Reuse of an update, to be completed. Default: a new one
---@return bw.Static? static the solution
---@return bw.Reuse|string reused what was reused, or the message
---@return bw.Details? details
function IncrementalSystem:statics(model, options, reused) end

---Updates the factor.
---
---Errors: singular (the matrix is not positive definite), memory.
---@param reused? bw.Reuse of an update, to be completed. Default: a new one
---@return bw.Reuse? reused what was reused
---@return string? message
---@return bw.Details? details
function IncrementalSystem:refactor(reused) end

---The equations as a system, with an updated factor. It is of no use after the next update.
---
---Errors: singular (the matrix is not positive definite), memory.
---@return bw.System? system the equations
---@return string? message
---@return bw.Details? details
function IncrementalSystem:view() end

---How much memory the equations take.
---@return integer factor (bytes) of the factor
---@return integer updates (bytes) of what is kept for updating it
---@return integer coefficients (bytes) of the subdomains
---@return integer pcg (bytes) of the two-level preconditioner; 0 until it is first used
function IncrementalSystem:memory() end

---Releases the equations at once.
function IncrementalSystem:close() end
