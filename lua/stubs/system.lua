---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Systems
--
-- The equations of a part with their factor.

---The equations of a body and their factor.
---@class bw.System
---@field times table
---@field unknown_count integer
---@field motion_count integer free rigid motions
local System = {}

---Displacement under nodal forces; on a free body the force is balanced by inertia first. A list of forces is solved
---in one block, which is faster, and gives the list of displacements.
---@param force bw.Array|bw.Array[] N: a row of three for every node
---@return bw.Array|bw.Array[]|nil
---@return string? message
---@return bw.Details? details
function System:solve(force) end

---The lowest elastic modes, by the system's own factor: see bw.Model:modes.
---@param options? bw.SystemModesOptions
---@return bw.Modes?
---@return string? message
---@return bw.Details? details
function System:modes(options) end

---@class bw.SystemModesOptions
---@field count? integer
---@field tolerance? number
---@field sturm? boolean
---@field seed? integer

---Lets go at once.
function System:close() end
