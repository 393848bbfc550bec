---@meta barwright
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- The module
--
-- `local bw = require "barwright"` gives the module. Its functions and modules are on the pages of this reference.
--
-- Units are SI: metre, kilogram, second, newton, pascal, radian. Indices count from 1. A vector is a table
-- `{x, y, z}` of three numbers or an array of three; a matrix is a table of rows. Stress tensors are stored in the order xx yy zz
-- yz zx xy. Options are tables. An unknown option raises an error that names the known options.
--
-- A call with wrong arguments raises an error that names the line of the script. What a script cannot know before the
-- call (a missing file, a singular system, no memory) returns `nil`, a message and a `bw.Details` table.
--
-- The collector releases objects. `close` releases one at once, and so does the end of the scope of a variable
-- with the attribute `<close>`.

---The kind of a failure, `details.status`:
---
---- `io`: a file cannot be read or written
---- `format`: a file is not what it should be
---- `geometry`: the shape does not allow it
---- `free`: a rigid motion is free
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
---- `busy`, `damaged`, `different`, `failed`, `foreign`: of studies and their files
---@alias bw.Status "io"|"format"|"geometry"|"free"|"singular"|"convergence"|"infeasible"|"limit"|"memory"|"cancelled"|"unsupported"|"internal"|"empty"|"rejected"|"busy"|"damaged"|"different"|"failed"|"foreign"

---Table {x, y, z}.
---@class bw.Vector

---A box along the axes.
---@class bw.Box
---@field low bw.Vector
---@field high bw.Vector
---@field size bw.Vector

---What went wrong, beside the message. Some functions add fields, which their entries name.
---@class bw.Details
---@field status bw.Status what kind of failure it is

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
---@field shapes bw.ShapesModule
---@field json bw.JsonModule
---@field results bw.ResultsModule
---@field scenario bw.ScenarioModule
---@field study bw.StudyModule
---@field plot bw.PlotModule
local bw = {}

---The least 1/2 x H x + g x with A x <= b and low <= x <= high, H positive definite. Where no x
---fulfils the rows within the bounds, `violation` is the least v so that A x <= b + v has a solution,
---and x the best with it; else it is 0.
---@param program bw.QuadraticProgram
---@return bw.Array? x
---@return number|string violation or a message
---@return bw.Array|table multipliers of the rows, or details
function bw.quadratic_program(program) end

---@class bw.QuadraticProgram
---@field H table|bw.Array
---@field g number[]|bw.Array
---@field A? table|bw.Array
---@field b? number[]|bw.Array
---@field low? number[]|bw.Array
---@field high? number[]|bw.Array

---Spearman's rank correlation of two columns, ties averaged; with weights (volumes), a sample of
---twice the weight counts as two.
---@param a bw.Array
---@param b bw.Array
---@param weights? bw.Array
---@return number?
function bw.rank_correlation(a, b, weights) end

---Calls f(stage, fraction) while the engine works; false from it asks the engine to stop. nil goes
---back to what the program shows. The function may not call the engine.
---@param f? fun(stage: string, fraction: number): boolean?
---@return function? before the one in force before
function bw.progress(f) end

---The number of threads; with an argument it is set first. Results have the same bits for any number.
---@param n? integer
---@return integer
function bw.threads(n) end

---What the engine remarked since the last call ("the surface was repaired: ..."), oldest first.
---@return string[]
function bw.remarks() end

---Whether Ctrl-C was pressed: for loops that go on after a failed case.
---@return boolean
function bw.interrupted() end

---Seconds of a clock that only goes forward.
---@return number
function bw.seconds() end

---The version, and the commit it was built from ("" when not known).
---@return string version
---@return string commit
function bw.version() end

---The sandbox that the program runs the script in: the folder that it may use, which version of the kernel's
---Landlock holds it (0: none) and whether its system calls are filtered; nil outside of a sandbox.
---@return bw.Sandbox?
function bw.sandbox() end

---@class bw.Sandbox
---@field folder string
---@field landlock integer
---@field calls boolean

return bw
