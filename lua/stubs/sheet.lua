---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Sheets
--
-- Elastic sheets in the plane: static, in large deflection, and transient.

---@class bw.SteadySheet
---@field outline bw.Outline as it is now
---@field reused bw.Kept what the last frame kept
---@field displacement bw.Array x, y at the nodes, m
---@field stress bw.Array xx, yy, xy, zz at the nodes, Pa
---@field von_mises bw.Array at the nodes, Pa
---@field error_estimate number relative, in energy (Zienkiewicz, Zhu)
---@field mesh bw.PlaneMesh as it is now
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners (and mid-edge nodes 12, 23, 31), from 1
---@field element_count integer
---@field node_count integer
---@field time number s
---@field velocity bw.Array? of a transient sheet
---@field acceleration bw.Array?
local SteadySheet = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}.
---@param handle bw.DragHandle
---@param by number[]
---@return bw.SteadySheet?
---@return string? message
---@return bw.Details? details
function SteadySheet:drag(handle, by) end

---@class bw.DragHandle
---@field vertex? integer
---@field edge? integer
---@field loop? string|integer

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.SteadySheet?
---@return string? message
---@return bw.Details? details
function SteadySheet:become(outline) end

---Solves again where it stands.
---@return bw.SteadySheet?
---@return string? message
---@return bw.Details? details
function SteadySheet:solve() end

---The power mean of von Mises stresses over the area with exponent p (1 to 1000: the larger, the closer
---to their maximum), and its exact gradient by the outline's points and by the mesh's nodes.
---@param p number
---@return number?
---@return bw.Array|string by_points
---@return bw.Array|table by_nodes
function SteadySheet:stress_norm(p) end

---@class bw.BentSheet
---@field outline bw.Outline as it is now
---@field reused bw.Kept what the last frame kept
---@field displacement bw.Array x, y at the nodes, m
---@field stress bw.Array xx, yy, xy, zz at the nodes, Pa
---@field von_mises bw.Array at the nodes, Pa
---@field error_estimate number relative, in energy (Zienkiewicz, Zhu)
---@field mesh bw.PlaneMesh as it is now
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners (and mid-edge nodes 12, 23, 31), from 1
---@field element_count integer
---@field node_count integer
---@field time number s
---@field velocity bw.Array? of a transient sheet
---@field acceleration bw.Array?
local BentSheet = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}.
---@param handle bw.DragHandle
---@param by number[]
---@return bw.BentSheet?
---@return string? message
---@return bw.Details? details
function BentSheet:drag(handle, by) end

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.BentSheet?
---@return string? message
---@return bw.Details? details
function BentSheet:become(outline) end

---Solves again where it stands.
---@return bw.BentSheet?
---@return string? message
---@return bw.Details? details
function BentSheet:solve() end

---@class bw.ShakenSheet
---@field outline bw.Outline as it is now
---@field reused bw.Kept what the last frame kept
---@field displacement bw.Array x, y at the nodes, m
---@field stress bw.Array xx, yy, xy, zz at the nodes, Pa
---@field von_mises bw.Array at the nodes, Pa
---@field error_estimate number relative, in energy (Zienkiewicz, Zhu)
---@field mesh bw.PlaneMesh as it is now
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners (and mid-edge nodes 12, 23, 31), from 1
---@field element_count integer
---@field node_count integer
---@field time number s
---@field velocity bw.Array? of a transient sheet
---@field acceleration bw.Array?
local ShakenSheet = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}.
---@param handle bw.DragHandle
---@param by number[]
---@return bw.ShakenSheet?
---@return string? message
---@return bw.Details? details
function ShakenSheet:drag(handle, by) end

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.ShakenSheet?
---@return string? message
---@return bw.Details? details
function ShakenSheet:become(outline) end

---Advances by `count` time steps (default 1).
---@param count? integer
---@return bw.ShakenSheet?
---@return string? message
---@return bw.Details? details
function ShakenSheet:step(count) end

---What stands behind the applications: a sheet and the mesh that follows. `frame` is a table that is
---filled with what was kept (bw.Kept).
---@class bw.Sheet
---@field outline bw.Outline
---@field displacement bw.Array
---@field velocity bw.Array?
---@field acceleration bw.Array?
---@field stress bw.Array
---@field von_mises bw.Array
---@field error_estimate number
---@field mesh bw.PlaneMesh
---@field points bw.Array
---@field elements bw.Array
---@field order integer
---@field time number
local Sheet = {}

---@param frame table
---@param outline bw.Outline
---@return table?
---@return string? message
---@return bw.Details? details
function Sheet:follow(frame, outline) end

---@param frame table
---@param solver? table
---@return table?
---@return string? message
---@return bw.Details? details
function Sheet:static(frame, solver) end

---@param frame table
---@param solver? table
---@param newmark? bw.NewmarkOptions
---@param steps? integer
---@return table?
---@return string? message
---@return bw.Details? details
function Sheet:shake(frame, solver, newmark, steps) end

---@class bw.NewmarkOptions
---@field step? number
---@field beta? number
---@field gamma? number
---@field damping_mass? number
---@field damping_stiffness? number

---@param frame table
---@param solver? table
---@param newton? bw.NewtonOptions
---@return table?
---@return string? message
---@return bw.Details? details
function Sheet:bend(frame, solver, newton) end

---@class bw.NewtonOptions
---@field tolerance? number
---@field iterations? integer
---@field load_steps? integer

---What mesh and body are at.
---@return bw.BodyState
function Sheet:keep() end

---Back to what was kept, bit for bit.
---@param state bw.BodyState
---@return table?
---@return string? message
---@return bw.Details? details
function Sheet:return_to(state) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return table
function Sheet:check() end

---@param p number
---@return number?
---@return bw.Array|string by_points
---@return bw.Array|table by_nodes
function Sheet:stress_norm(p) end

---@return integer elements
---@return integer nodes
function Sheet:counts() end

---Releases it early.
function Sheet:close() end

---What a body that follows an outline, and its mesh, were at.
---@class bw.BodyState
local BodyState = {}

function BodyState:close() end
