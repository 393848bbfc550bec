---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Systems that follow edits
--
-- The equations of an edit session.

---The equations of a part cut into pieces, kept up to date through edits. Changed by `update`.
---@class bw.LocalSystem
---@field unknown_count integer
---@field piece_count integer
local LocalSystem = {}

---Follows an edit: the moved model, and how every piece lies against the shape that the system was
---made at (rows of bw.Domains:motion).
---@param model bw.Model
---@param motion bw.Array|table
---@return table? reused
---@return string? message
---@return bw.Details? details
function LocalSystem:update(model, motion) end

---@param force bw.Array a row of three for every node
---@param options? table see bw.Session:solve
---@param reused? table of an update, to be completed
---@return bw.Array? displacement
---@return table|string reused or a message
---@return bw.Details? details
function LocalSystem:solve(force, options, reused) end

---The static solution of the model of the last update.
---@param model bw.Model
---@param options? table see bw.Session:solve
---@param reused? table of an update, to be completed
---@return bw.Static?
---@return table|string reused or a message
---@return bw.Details? details
function LocalSystem:statics(model, options, reused) end

---Brings the factor up to date.
---@param reused? table
---@return table? reused
---@return string? message
---@return bw.Details? details
function LocalSystem:refactor(reused) end

---Its equations as a system, the factor brought up to date. Of no use after the next update.
---@return bw.System?
---@return string? message
---@return bw.Details? details
function LocalSystem:view() end

---Bytes of the factor, of what is kept for updating it, of the pieces' coefficients, and of what solves over
---levels (0 until it is first used).
---@return integer factor
---@return integer updates
---@return integer coefficients
---@return integer levels
function LocalSystem:memory() end

---What the current shape would cost from scratch: seconds of its stiffness from all elements, and of
---CHOLMOD's analysis, factor and solve, with the unknowns in the order that was chosen for edits, or
---in that of METIS for a single solution. For benchmarks.
---@param own_order? boolean METIS's order; default false
---@return bw.LocalSystemBaseline?
---@return string? message
---@return bw.Details? details
function LocalSystem:baseline(own_order) end

---@class bw.LocalSystemBaseline
---@field stiffness number
---@field analysis number
---@field factor number
---@field solve number
---@field flops number
---@field entries number

function LocalSystem:close() end
