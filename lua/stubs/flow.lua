---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Flow
--
-- Incompressible flow and heat in the plane.

---A flow whose outline is dragged.
---@class bw.Flow
---@field outline bw.Outline as it is now
---@field reused bw.ReuseStatistics what the last frame kept
---@field time number s
---@field velocity bw.Array x, y at the nodes, m/s
---@field pressure bw.Array at the nodes, Pa
---@field vorticity bw.Array at the nodes, 1/s
---@field signals table<string, number[]> that are recorded
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners, from 1
---@field element_count integer
---@field node_count integer
local Flow = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}; the flow goes on
---from where it was (steady: is recomputed).
---@param handle bw.OutlineHandle
---@param by number[]
---@return bw.Flow?
---@return string? message
---@return bw.Details? details
function Flow:drag(handle, by) end

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.Flow?
---@return string? message
---@return bw.Details? details
function Flow:become(outline) end

---Advances by `count` time steps (default 1).
---@param count? integer
---@return bw.Flow?
---@return string? message
---@return bw.Details? details
function Flow:step(count) end

---From now on steps of so many seconds; what is recorded begins again.
---@param seconds number
---@return bw.Flow
function Flow:pace(seconds) end

---Finds the steady state; where there is none, all is as it was.
---@return bw.Flow?
---@return string? message
---@return bw.Details? details
function Flow:settle() end

---From now on records value(flow), a number, after every step, in signals[name]; without value: no longer.
---@param name string
---@param value? fun(flow: bw.Flow): number
---@return bw.Flow
function Flow:record(name, value) end

---Of a recorded signal, 1/s, by its last whole periods (default 5); 0 where it does not swing.
---@param name string
---@param periods? integer
---@return number
function Flow:frequency(name, periods) end

---Of the fluid on the edges with a tag, per depth, N/m (reactions of the last step).
---@param tag string
---@return number
---@return number
function Flow:force(tag) end

---Coefficients of drag and lift: force along and across the stream (default {1, 0}) over density / 2
---velocity^2 length.
---@param tag string
---@param given bw.FlowReference
---@return number
---@return number
function Flow:coefficients(tag, given) end

---@class bw.FlowReference
---@field velocity number
---@field length number
---@field stream? number[]

---Heat flow into the fluid through the edges with a tag, over density times heat capacity, K m2/s.
---@param tag string
---@return number
function Flow:heat(tag) end

---That over diffusivity times a difference of temperatures: of a square heated at one side the Nusselt
---number.
---@param tag string
---@param difference number
---@return number
function Flow:nusselt(tag, difference) end

---Velocity x, y, pressure (and temperature) at a place.
---@param x number
---@param y number
---@return number
---@return number
---@return number
function Flow:at(x, y) end

---Pressure at one place less that at another.
---@param from number[]
---@param to number[]
---@return number
function Flow:pressure_drop(from, to) end

---A flow with heat whose outline is dragged.
---@class bw.ThermalFlow
---@field outline bw.Outline as it is now
---@field reused bw.ReuseStatistics what the last frame kept
---@field time number s
---@field velocity bw.Array x, y at the nodes, m/s
---@field pressure bw.Array at the nodes, Pa
---@field temperature bw.Array at the nodes, K
---@field vorticity bw.Array at the nodes, 1/s
---@field signals table<string, number[]> that are recorded
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners, from 1
---@field element_count integer
---@field node_count integer
local ThermalFlow = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}; the flow goes on
---from where it was (steady: is recomputed).
---@param handle bw.OutlineHandle
---@param by number[]
---@return bw.ThermalFlow?
---@return string? message
---@return bw.Details? details
function ThermalFlow:drag(handle, by) end

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.ThermalFlow?
---@return string? message
---@return bw.Details? details
function ThermalFlow:become(outline) end

---Advances by `count` time steps (default 1).
---@param count? integer
---@return bw.ThermalFlow?
---@return string? message
---@return bw.Details? details
function ThermalFlow:step(count) end

---From now on steps of so many seconds; what is recorded begins again.
---@param seconds number
---@return bw.ThermalFlow
function ThermalFlow:pace(seconds) end

---Finds the steady state; where there is none, all is as it was.
---@return bw.ThermalFlow?
---@return string? message
---@return bw.Details? details
function ThermalFlow:settle() end

---From now on records value(flow), a number, after every step, in signals[name]; without value: no longer.
---@param name string
---@param value? fun(flow: bw.ThermalFlow): number
---@return bw.ThermalFlow
function ThermalFlow:record(name, value) end

---Of a recorded signal, 1/s, by its last whole periods (default 5); 0 where it does not swing.
---@param name string
---@param periods? integer
---@return number
function ThermalFlow:frequency(name, periods) end

---Of the fluid on the edges with a tag, per depth, N/m (reactions of the last step).
---@param tag string
---@return number
---@return number
function ThermalFlow:force(tag) end

---Coefficients of drag and lift: force along and across the stream (default {1, 0}) over density / 2
---velocity^2 length.
---@param tag string
---@param given bw.FlowReference
---@return number
---@return number
function ThermalFlow:coefficients(tag, given) end

---Heat flow into the fluid through the edges with a tag, over density times heat capacity, K m2/s.
---@param tag string
---@return number
function ThermalFlow:heat(tag) end

---That over diffusivity times a difference of temperatures: of a square heated at one side the Nusselt
---number.
---@param tag string
---@param difference number
---@return number
function ThermalFlow:nusselt(tag, difference) end

---Velocity x, y, pressure (and temperature) at a place.
---@param x number
---@param y number
---@return number
---@return number
---@return number
---@return number
function ThermalFlow:at(x, y) end

---Pressure at one place less that at another.
---@param from number[]
---@param to number[]
---@return number
function ThermalFlow:pressure_drop(from, to) end

---What stands behind flows: a fluid and the mesh that follows. `frame` is a table that is filled with what
---was kept (bw.ReuseStatistics).
---@class bw.FlowBody
---@field outline bw.Outline
---@field velocity bw.Array
---@field pressure bw.Array
---@field temperature bw.Array?
---@field vorticity bw.Array
---@field points bw.Array
---@field elements bw.Array
---@field time number
local FlowBody = {}

---@param frame table
---@param outline bw.Outline
---@return table?
---@return string? message
---@return bw.Details? details
function FlowBody:follow(frame, outline) end

---Time steps; with step 0 to the steady state.
---@param frame table
---@param solver? table
---@param options? bw.FlowBodyStepOptions
---@param steps? integer
---@return table?
---@return string? message
---@return bw.Details? details
function FlowBody:step(frame, solver, options, steps) end

---@class bw.FlowBodyStepOptions
---@field step? number
---@field bdf? integer
---@field iterations? integer
---@field tolerance? number
---@field ale? boolean

---@param tag string
---@return number x
---@return number y
function FlowBody:force(tag) end

---@param tag string
---@return number
function FlowBody:heat(tag) end

---What mesh and body are at.
---@return bw.BodyState
function FlowBody:keep() end

---Back to what was kept, bit for bit.
---@param state bw.BodyState
---@return table?
---@return string? message
---@return bw.Details? details
function FlowBody:return_to(state) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return table
function FlowBody:check() end

---@param x number
---@param y number
---@return number ...
function FlowBody:at(x, y) end

---@return integer elements
---@return integer nodes
function FlowBody:counts() end

function FlowBody:close() end
