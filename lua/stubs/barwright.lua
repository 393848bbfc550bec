---@meta barwright
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- The module
--
-- `local bw = require "barwright"` gives the module. Its functions and modules are on the pages of this reference.
--
-- Units are SI: metre, kilogram, second, newton, pascal, radian. Indices count from 1. A vector is a table
-- `{x, y, z}` of three numbers or an array of three; a matrix is a table of rows. Stress tensors are stored in the
-- order xx yy zz yz zx xy. Options are tables. An unknown option raises an error that names the known options.
--
-- A call with wrong arguments raises an error that names the line of the script. What a script cannot know before the
-- call (a missing file, a singular system) returns `nil`, a message and a `bw.Details` table, whose `status` is a word.
-- Entries list these words under "Errors". Three of them are not repeated there: `memory` may come from every function
-- that makes an object, `cancelled` from every long computation (Ctrl-C, or a progress function that returned false),
-- and `internal` says that barwright is at fault.
--
-- The collector releases objects. `close` releases one at once, and so does the end of the scope of a variable
-- with the attribute `<close>`.

---The kind of a failure, `details.status`:
---
---- `io`: a file cannot be read or written
---- `format`: a file is not what it should be
---- `geometry`: the shape does not allow it
---- `unconstrained`: a rigid-body mode is not prevented by supports
---- `singular`: the equations have no unique solution
---- `convergence`: an iteration did not converge
---- `infeasible`: nothing fulfils the conditions
---- `limit`: a limit was reached
---- `memory`: memory does not suffice
---- `cancelled`: the user or a progress function stopped it
---- `unsupported`: this build or this case does not have it
---- `internal`: an error of barwright
---- `empty`: what is asked for is not there
---- `rejected`: a certificate proves less than it states
---- `invalid`: what a function that was given, such as `fix`, returned cannot be used
---- `busy`: another process runs this study
---- `damaged`, `foreign`, `newer`: a study file does not match its checksums, is none, or is of a later version
---- `different`: a study file is of another study or of another script
---- `full`: no room is left on the disk
---- `failed`: work in another process failed
---@alias bw.Status "io"|"format"|"geometry"|"unconstrained"|"singular"|"convergence"|"infeasible"|"limit"|"memory"|"cancelled"|"unsupported"|"internal"|"empty"|"rejected"|"invalid"|"busy"|"damaged"|"different"|"failed"|"foreign"|"newer"|"full"

---Three numbers `{x, y, z}`. As an argument an array of three numbers is accepted, too.
---@class bw.Vector

---A box along the axes.
---@class bw.Box
---@field min bw.Vector (m) the smallest coordinates
---@field max bw.Vector (m) the largest coordinates
---@field size bw.Vector (m) `max` less `min`

---What went wrong, beside the message. Functions that add fields name them.
---@class bw.Details
---@field status bw.Status the kind of failure
---@field limit? string with status "limit": which limit was reached, such as "time" or "memory"

---The module: `local bw = require "barwright"`.
---@class bw
---@field array bw.ArrayModule
---@field surface bw.SurfaceModule
---@field skeleton bw.SkeletonModule
---@field edit bw.EditModule
---@field outline bw.OutlineModule
---@field responsive bw.ResponsiveModule
---@field plane bw.PlaneModule
---@field grid bw.GridModule
---@field metamaterial bw.MetamaterialModule
---@field mesh bw.MeshModule
---@field material bw.MaterialModule
---@field solver bw.SolverModule
---@field lp bw.LpModule
---@field rigid bw.RigidModule
---@field sparse_matrix bw.SparseMatrixModule
---@field eigensolver bw.EigensolverModule
---@field shapes bw.ShapesModule
---@field json bw.JsonModule
---@field results bw.ResultsModule
---@field scenario bw.ScenarioModule
---@field study bw.StudyModule
---@field workbench bw.WorkbenchModule
---@field plot bw.PlotModule
local bw = {}

---Minimises 1/2 xᵀ H x + gᵀ x subject to A x ≤ b and min ≤ x ≤ max. Where no x satisfies the rows within the
---bounds, `violation` is the smallest v for which A x ≤ b + v has a solution, and x is the minimiser with that v.
---
---Errors: convergence (the solver did not reach the minimum). A matrix `H` that is not positive definite raises.
---```lua
---local x, violation, multipliers = bw.quadratic_program {H = {{2, 0}, {0, 2}}, g = {-2, -4}, A = {{1, 1}}, b = {1}}
---print(x[1], x[2], violation, multipliers[1]) -- 0 1 0 2
---```
---@param program bw.QuadraticProgram the matrices and bounds
---@return bw.Array? x (any, n × 1) the minimiser
---@return number|string violation (any) v; 0 where the rows hold. Or the message
---@return bw.Array|bw.Details multipliers (any, m × 1) of the rows, 0 or more. Or the details
function bw.quadratic_program(program) end

---A convex quadratic program of n unknowns and m rows.
---@class bw.QuadraticProgram
---@field H number[][]|bw.Array (any, n × n) symmetric and positive definite
---@field g number[]|bw.Array (any, n × 1) the linear term. Range: n from 1 to 1000
---@field A? number[][]|bw.Array (any, m × n) the rows. Default: none. Give the rows a common scale
---@field b? number[]|bw.Array (any, m × 1) right-hand sides of the rows. Range: m up to 10000
---@field min? number[]|bw.Array (any, n × 1) lower bounds. Default: none
---@field max? number[]|bw.Array (any, n × 1) upper bounds. Default: none

---Spearman's rank correlation of two columns. Equal values get the mean of their ranks. With weights, a sample of
---twice the weight counts as two. A column of equal values raises.
---```lua
---local a, b = bw.array {1, 2, 3, 4}, bw.array {10, 20, 40, 30}
---print(bw.rank_correlation(a, b)) -- 0.8
---```
---@param a bw.Array|number[] (any, n × 1) the first column. Range: n of 2 or more
---@param b bw.Array|number[] (any, n × 1) the second column
---@param weights? bw.Array|number[] (any, n × 1) of the samples, such as volumes of elements. Default: all equal
---@return number rho (-) from -1 to 1
function bw.rank_correlation(a, b, weights) end

---Calls `f(stage, fraction)` while the engine works: `stage` names the work, `fraction` goes from 0 to 1 in each stage.
---Where `f` returns false the engine stops, and the call that was running returns the status cancelled. `f` may not
---call the engine. Without an argument the progress line of the program shows the progress again.
---```lua
---local stages = {}
---local before = bw.progress(function(stage) stages[stage] = true end)
---assert(bw.surface.sphere({radius = 0.01}):remesh {edge_length = 0.002})
---bw.progress(before)
---print(next(stages))
---```
---@param f? fun(stage: string, fraction: number): boolean? what is called
---@return (fun(stage: string, fraction: number): boolean?)? before the function that was set before, or nil
function bw.progress(f) end

---The number of threads that the engine uses; with an argument it is set first. Results have the same bits for any
---number of threads.
---```lua
---bw.threads(2)
---print(bw.threads()) -- 2
---```
---@param n? integer (count) the number from now on. Range: 1 to 64. Default: the environment variable BARWRIGHT_THREADS, else the number of processors
---@return integer threads (count) the number in force
function bw.threads(n) end

---The engine's warnings since the last call, such as "the surface was repaired: ...", the oldest first. The prompt
---prints warnings by itself.
---```lua
---local surface = bw.surface.sphere {radius = 0.01}
---assert(bw.mesh.fill(surface, {elements = 500}))
---for _, text in ipairs(bw.warnings()) do print(text) end
---```
---@return string[] warnings sentences
function bw.warnings() end

---Whether Ctrl-C was pressed. A loop that continues after failed cases asks for it.
---```lua
---for case = 1, 3 do
---  if bw.interrupted() then break end
---  print(case)
---end
---```
---@return boolean pressed true after Ctrl-C
function bw.interrupted() end

---A monotonic clock, for measuring durations.
---```lua
---local begin = bw.seconds()
---assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {10, 10, 10}})
---print(bw.seconds() - begin, "s")
---```
---@return number now (s) since an arbitrary moment
function bw.seconds() end

---The version of barwright.
---```lua
---local version, commit = bw.version()
---print(version, commit)
---```
---@return string version such as "0.1.0"
---@return string commit the source's commit, "" where it is not known
function bw.version() end

---The sandbox that the program runs the script in (docs/sandbox.md), or nil outside of a sandbox.
---```lua
---local sandbox = bw.sandbox()
---print(sandbox and sandbox.folder or "no sandbox")
---```
---@return bw.Sandbox? sandbox what holds the script
function bw.sandbox() end

---What a sandbox allows.
---@class bw.Sandbox
---@field folder string the folder that the script may use
---@field landlock integer (-) version of the kernel's Landlock that enforces it, 0: none
---@field calls boolean whether system calls are filtered

return bw
