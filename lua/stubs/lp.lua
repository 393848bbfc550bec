---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Solvers of linear programs
--
-- How the linear programs of worst loads are solved: by the engine's own method or by GLPK. Without a choice, counted
-- operations decide.

---Solvers of linear programs. A solver is made once and given as the option `lp` to anything that solves linear programs.
---@class bw.LpModule
local lp_module = {}

---The dual simplex method of the engine: the bound-flipping ratio test, on nested samples of the columns. It was made for worst
---loads: few rows, many columns.
---
---Source: A. Koberstein, The Dual Simplex Method, Techniques for a Fast and Stable Implementation, Paderborn 2005; G. Dantzig and
---R. Van Slyke, Generalized Upper Bounding Techniques, J. Comput. Syst. Sci. 1 (1967), for friction; docs/theory/worst_case.md.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---print(assert(bw.worst_case(part, {force = 50, lp = bw.lp.dual_simplex {}})))
---```
---@param options? bw.LpOptions limits
---@return bw.LpSolver solver a description of it
function lp_module.dual_simplex(options) end

---GLPK: its dual simplex method with the bound-flipping ratio test, then with the textbook's on scaled rows, then its primal
---simplex method, until an answer passes the check.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local worst = assert(bw.worst_case(part, {force = 50, lp = bw.lp.glpk {}}))
---print(worst.reports.lp)
---```
---@param options? bw.LpOptions limits
---@return bw.LpSolver solver a description of it
function lp_module.glpk(options) end

---Limits of a solver of linear programs.
---@class bw.LpOptions
---@field max_iterations? integer (count) of an attempt at a program, above 0. Default: chosen by the size of the program

---How linear programs are solved. It does not change, and holds no memory of its own. Every answer is checked: balance to 1e-9 of
---the total force, a duality gap below 1e-8. A solver that is given works alone; where none is, a program whose answer fails
---the check goes to the other solver.
---```lua
---local solver = bw.lp.glpk {max_iterations = 10000}
---print(solver.name, solver)
---```
---@class bw.LpSolver
---@field name "dual_simplex"|"glpk" which one
---@field max_iterations integer (count) of an attempt at a program; 0: chosen by the size of the program
local LpSolver = {}

---Releases the solver at once.
function LpSolver:close() end
