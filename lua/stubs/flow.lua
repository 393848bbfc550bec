---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Flow
--
-- Incompressible flow in the plane, with or without heat, whose outline is dragged.

---A flow, made by `bw.responsive.flow`.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local walls = {left = {x = 0.1, y = 0}, top = "wall", bottom = "wall"}
---local options = {outline = outline, viscosity = 1e-3, step = 0.01, elements = 300, conditions = walls}
---local flow = assert(bw.responsive.flow(options))
---flow:record("drag", function(f) return (f:force "top") end)
---print(assert(flow:step(3)).signals.drag[3], flow:at(0.05, 0.01))
---```
---@class bw.Flow
---@field outline bw.Outline the current outline
---@field reused bw.ReuseStatistics what the last frame reused
---@field report bw.SolverReport? what solved in the last frame, and why; nil where nothing was solved yet
---@field time number (s) the time since the start
---@field velocity bw.Array (m/s, node_count × 2, per node) velocity along x and y
---@field pressure bw.Array (Pa, node_count × 1, per node) pressure
---@field vorticity bw.Array (1/s, node_count × 1, per node) vorticity, ∂v/∂x - ∂u/∂y
---@field signals table<string, number[]> the recorded signals by name: a value for each time step
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh
---@field elements bw.Array (index from 1, element_count × 3, per element) corners of the triangles
---@field element_count integer (count) triangles
---@field node_count integer (count) nodes
local Flow = {}

---Moves a handle of the outline and transfers velocity and pressure to the new mesh. With the option `steady` the steady
---state is found again; otherwise the next time step goes on from there.
---
---Errors: geometry (edges would cross or touch), and those of `bw.responsive.flow`. After a failure the flow is as it was.
---@param handle bw.OutlineHandle what is moved
---@param by number[] (m, {x, y}) the displacement
---@return bw.Flow? flow the same flow
---@return string? message
---@return bw.Details? details
function Flow:drag(handle, by) end

---Takes another outline, of any topology with the tags of the conditions, as `drag` does.
---
---Errors: those of `bw.responsive.flow`. An outline without a tag that a condition is on raises. After a failure the flow is as it was.
---@param outline bw.Outline the other outline
---@return bw.Flow? flow the same flow
---@return string? message
---@return bw.Details? details
function Flow:become(outline) end

---Advances by time steps, all or none. After each step the signals are recorded. A flow that was made without the option
---`step` raises.
---
---Errors: convergence, singular (the linear equations could not be solved). After a failure the flow is as it was, without
---the values that the call recorded.
---@param count? integer (count) time steps, 1 and more. Default: 1
---@return bw.Flow? flow the same flow
---@return string? message
---@return bw.Details? details
function Flow:step(count) end

---Sets the time step for the steps to come. Recorded signals become empty, because their values are a time step apart.
---@param seconds number (s) the time step, above 0
---@return bw.Flow self
function Flow:pace(seconds) end

---Finds the steady state, by Newton's method from the present state, then by implicit steps that grow.
---
---Errors: convergence (no steady state was found: the flow may be unsteady), singular (the linear equations could not be
---solved). After a failure the flow is as it was.
---@return bw.Flow? flow the same flow
---@return string? message
---@return bw.Details? details
function Flow:settle() end

---Records a signal: after every time step `value` is called and its result is appended to `signals[name]`. A result that is
---no number raises in `step`. Without `value` the recording ends and the signal is gone.
---@param name string the name of the signal
---@param value? fun(flow: bw.Flow): number what is recorded. Default: none, the recording ends
---@return bw.Flow self
function Flow:record(name, value) end

---The frequency of a recorded signal, from the times at which it rises through its mean, over its last periods. A name that
---is not recorded raises.
---@param name string the name of the signal
---@param periods? integer (count) whole periods that are averaged, 1 and more. Default: 5
---@return number frequency (1/s) the frequency; 0 where the signal rises through its mean less than twice
function Flow:frequency(name, periods) end

---The force of the fluid on the edges of a tag, from the reactions of the last step. Raises where no step or steady state
---was computed on the present mesh, and for a tag that the outline does not have.
---@param tag string the tag of the edges
---@return number x (N/m) force along x, per depth
---@return number y (N/m) force along y, per depth
function Flow:force(tag) end

---The coefficients of drag and lift of the edges of a tag: the components of the force along and across the stream, over
---1/2 density velocity² length. Raises as `force` does.
---@param tag string the tag of the edges
---@param reference bw.FlowReference velocity and length that the coefficients refer to
---@return number drag (-) coefficient along the stream
---@return number lift (-) coefficient across the stream, 90 degrees counter-clockwise
function Flow:coefficients(tag, reference) end

---What coefficients of drag and lift refer to.
---@class bw.FlowReference
---@field velocity number (m/s) the velocity far from the body, above 0
---@field length number (m) the length of the body, such as the diameter of a cylinder, above 0
---@field stream? number[] (-, {x, y}) the direction of the stream, of any length above 0. Default: {1, 0}

---The fields at a place, interpolated in its element. Outside of the mesh they are those of the nearest place in it.
---@param x number (m) x of the place
---@param y number (m) y of the place
---@return number velocity_x (m/s) velocity along x
---@return number velocity_y (m/s) velocity along y
---@return number pressure (Pa) pressure
function Flow:at(x, y) end

---The pressure at one place less that at another.
---@param from number[] (m, {x, y}) the first place
---@param to number[] (m, {x, y}) the second place
---@return number difference (Pa) pressure at `from` less that at `to`
function Flow:pressure_drop(from, to) end

---A flow with heat that lifts the fluid (Boussinesq), made by `bw.responsive.thermal`.
---```lua
---local options = {outline = assert(bw.plane.rectangle {}).outline, viscosity = 1, diffusivity = 1, elements = 200}
---options.expansion, options.steady, options.gravity = 100, true, {0, -10}
---options.conditions = {left = {x = 0, y = 0, temperature = 1}, right = {x = 0, y = 0, temperature = 0},
---  top = "wall", bottom = "wall"}
---local flow = assert(bw.responsive.thermal(options))
---print(flow:nusselt("left", 1), flow.temperature:max())
---```
---@class bw.ThermalFlow
---@field outline bw.Outline the current outline
---@field reused bw.ReuseStatistics what the last frame reused
---@field report bw.SolverReport? what solved in the last frame, and why; nil where nothing was solved yet
---@field time number (s) the time since the start
---@field velocity bw.Array (m/s, node_count × 2, per node) velocity along x and y
---@field pressure bw.Array (Pa, node_count × 1, per node) pressure
---@field temperature bw.Array (K, node_count × 1, per node) temperature
---@field vorticity bw.Array (1/s, node_count × 1, per node) vorticity, ∂v/∂x - ∂u/∂y
---@field signals table<string, number[]> the recorded signals by name: a value for each time step
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh
---@field elements bw.Array (index from 1, element_count × 3, per element) corners of the triangles
---@field element_count integer (count) triangles
---@field node_count integer (count) nodes
local ThermalFlow = {}

---Moves a handle of the outline and transfers velocity and pressure to the new mesh. With the option `steady` the steady
---state is found again; otherwise the next time step goes on from there.
---
---Errors: geometry (edges would cross or touch), and those of `bw.responsive.thermal`. After a failure the flow is as it was.
---@param handle bw.OutlineHandle what is moved
---@param by number[] (m, {x, y}) the displacement
---@return bw.ThermalFlow? flow the same flow
---@return string? message
---@return bw.Details? details
function ThermalFlow:drag(handle, by) end

---Takes another outline, of any topology with the tags of the conditions, as `drag` does.
---
---Errors: those of `bw.responsive.thermal`. An outline without a tag that a condition is on raises. After a failure the flow is as it was.
---@param outline bw.Outline the other outline
---@return bw.ThermalFlow? flow the same flow
---@return string? message
---@return bw.Details? details
function ThermalFlow:become(outline) end

---Advances by time steps, all or none. After each step the signals are recorded. A flow that was made without the option
---`step` raises.
---
---Errors: convergence, singular (the linear equations could not be solved). After a failure the flow is as it was, without
---the values that the call recorded.
---@param count? integer (count) time steps, 1 and more. Default: 1
---@return bw.ThermalFlow? flow the same flow
---@return string? message
---@return bw.Details? details
function ThermalFlow:step(count) end

---Sets the time step for the steps to come. Recorded signals become empty, because their values are a time step apart.
---@param seconds number (s) the time step, above 0
---@return bw.ThermalFlow self
function ThermalFlow:pace(seconds) end

---Finds the steady state, by Newton's method from the present state, then by implicit steps that grow. A prescribed heat
---flux without a temperature or convection raises: no steady state is determined.
---
---Errors: convergence (no steady state was found: the flow may be unsteady), singular (the linear equations could not be
---solved). After a failure the flow is as it was.
---@return bw.ThermalFlow? flow the same flow
---@return string? message
---@return bw.Details? details
function ThermalFlow:settle() end

---Records a signal: after every time step `value` is called and its result is appended to `signals[name]`. A result that is
---no number raises in `step`. Without `value` the recording ends and the signal is gone.
---@param name string the name of the signal
---@param value? fun(flow: bw.ThermalFlow): number what is recorded. Default: none, the recording ends
---@return bw.ThermalFlow self
function ThermalFlow:record(name, value) end

---The frequency of a recorded signal, from the times at which it rises through its mean, over its last periods. A name that
---is not recorded raises.
---@param name string the name of the signal
---@param periods? integer (count) whole periods that are averaged, 1 and more. Default: 5
---@return number frequency (1/s) the frequency; 0 where the signal rises through its mean less than twice
function ThermalFlow:frequency(name, periods) end

---The force of the fluid on the edges of a tag, from the reactions of the last step. Raises where no step or steady state
---was computed on the present mesh, and for a tag that the outline does not have.
---@param tag string the tag of the edges
---@return number x (N/m) force along x, per depth
---@return number y (N/m) force along y, per depth
function ThermalFlow:force(tag) end

---The coefficients of drag and lift of the edges of a tag: the components of the force along and across the stream, over
---1/2 density velocity² length. Raises as `force` does.
---@param tag string the tag of the edges
---@param reference bw.FlowReference velocity and length that the coefficients refer to
---@return number drag (-) coefficient along the stream
---@return number lift (-) coefficient across the stream, 90 degrees counter-clockwise
function ThermalFlow:coefficients(tag, reference) end

---The heat flow into the fluid through the edges of a tag, over density times heat capacity, per depth: from the reactions of
---the last step where temperatures are prescribed, from fluxes and convection elsewhere. Raises as `force` does.
---@param tag string the tag of the edges
---@return number heat (K m2/s) the heat flow
function ThermalFlow:heat(tag) end

---The heat flow through the edges of a tag over diffusivity times a difference of temperatures. For a square that is heated
---at one side this is the Nusselt number. Raises as `force` does.
---@param tag string the tag of the edges
---@param difference number (K) the difference of temperatures, not 0
---@return number nusselt (-) the ratio
function ThermalFlow:nusselt(tag, difference) end

---The fields at a place, interpolated in its element. Outside of the mesh they are those of the nearest place in it.
---@param x number (m) x of the place
---@param y number (m) y of the place
---@return number velocity_x (m/s) velocity along x
---@return number velocity_y (m/s) velocity along y
---@return number pressure (Pa) pressure
---@return number temperature (K) temperature
function ThermalFlow:at(x, y) end

---The pressure at one place less that at another.
---@param from number[] (m, {x, y}) the first place
---@param to number[] (m, {x, y}) the second place
---@return number difference (Pa) pressure at `from` less that at `to`
function ThermalFlow:pressure_drop(from, to) end

---The engine's flow and its mesh motion, `body` of the flows above. Scripts take these. `frame` is a table that receives what
---the call reused.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local walls = {left = {x = 0.1, y = 0}, top = "wall", bottom = "wall"}
---local flow = assert(bw.responsive.flow {outline = outline, viscosity = 1e-3, elements = 300, conditions = walls})
---print(flow.body:counts())
---```
---@class bw.FlowBody
---@field outline bw.Outline the current outline
---@field velocity bw.Array (m/s, node_count × 2, per node) velocity along x and y
---@field pressure bw.Array (Pa, node_count × 1, per node) pressure
---@field temperature bw.Array? (K, node_count × 1, per node) temperature; nil without heat
---@field vorticity bw.Array (1/s, node_count × 1, per node) vorticity, ∂v/∂x - ∂u/∂y
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh
---@field elements bw.Array (index from 1, element_count × 3, per element) corners of the triangles
---@field time number (s) the time since the start
local FlowBody = {}

---Takes mesh and fields to an outline; it does not solve.
---
---Errors: those of `bw.plane.fill`.
---@param frame bw.ReuseStatistics receives what was reused
---@param outline bw.Outline the outline, with the tags of the conditions
---@return bw.ReuseStatistics? frame the same table
---@return string? message
---@return bw.Details? details
function FlowBody:follow(frame, outline) end

---Advances by time steps, all or none; with the option `step` of 0 it finds the steady state.
---
---Errors: convergence (no steady state was found, or the linear solution stopped early), singular (the equations have no
---unique solution), geometry (an element is inverted).
---@param frame bw.ReuseStatistics receives what was reused
---@param solver? bw.LaggedFactorOptions how linear equations are solved. Default: as stated there
---@param options? bw.FlowBodyStepOptions time step and iterations. Default: as stated there
---@param steps? integer (count) steps. Default: 1
---@return bw.ReuseStatistics? frame the same table
---@return string? message
---@return bw.Details? details
function FlowBody:step(frame, solver, options, steps) end

---Time step and nonlinear iterations of a flow.
---@class bw.FlowBodyStepOptions
---@field step? number (s) the time step, 0 or more; 0: the steady state. Default: 0
---@field bdf? integer (-) order of the backward differentiation in time: 1 or 2. Default: 2
---@field iterations? integer (count) nonlinear iterations, 0 or more; 0: 1 for a time step, 30 for a steady state. Default: 0
---@field tolerance? number (-) relative change of the solution at which nonlinear iterations end, above 0. Default: 1e-8
---@field ale? boolean whether nodes that moved since the last step carry a mesh velocity. Default: false

---The force of the fluid on the edges of a tag, from the reactions of the last step. Raises where no step was computed on the
---present mesh, and for a tag that the outline does not have.
---@param tag string the tag of the edges
---@return number x (N/m) force along x, per depth
---@return number y (N/m) force along y, per depth
function FlowBody:force(tag) end

---The heat flow into the fluid through the edges of a tag, over density times heat capacity, per depth. Raises as `force`
---does, and for a flow without heat.
---@param tag string the tag of the edges
---@return number heat (K m2/s) the heat flow
function FlowBody:heat(tag) end

---The current state of mesh and flow. It copies nothing.
---@return bw.BodyState state the state
function FlowBody:save() end

---Returns to a state, bit for bit. A state of another flow raises.
---
---Errors: only those that every function may give.
---@param state bw.BodyState a state of this flow
---@return bw.FlowBody? flow the same flow
---@return string? message
---@return bw.Details? details
function FlowBody:restore(state) end

---Checks that all parts of it belong together, for tests and debugging. It raises where they do not.
---@return bw.FlowBody self
function FlowBody:check() end

---The fields at a place, interpolated in its element. Outside of the mesh they are those of the nearest place in it.
---@param x number (m) x of the place
---@param y number (m) y of the place
---@return number velocity_x (m/s) velocity along x
---@return number velocity_y (m/s) velocity along y
---@return number pressure (Pa) pressure
---@return number? temperature (K) temperature; nil without heat
function FlowBody:at(x, y) end

---The size of the mesh.
---@return integer elements (count) triangles
---@return integer nodes (count) nodes
function FlowBody:counts() end

---Frees its memory at once.
function FlowBody:close() end
