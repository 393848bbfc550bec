---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Sheets
--
-- Elastic sheets in the plane whose outline is dragged: linear statics, large deflection, and transient dynamics.

---A sheet in linear statics, made by `bw.responsive.steady`.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local options = {outline = outline, material = bw.material.pla, elements = 200}
---options.conditions = {left = "fixed", right = {traction = {0, -1e5}}}
---local sheet = assert(bw.responsive.steady(options))
---assert(sheet:drag({vertex = 3}, {0, 0.005}))
---print(sheet:stress_norm(20))
---```
---@class bw.SteadySheet
---@field outline bw.Outline the current outline
---@field mesh bw.PlaneMesh the current mesh
---@field reused bw.ReuseStatistics what the last frame reused
---@field report bw.SolverReport? what solved in the last frame, and why; nil where nothing was solved yet
---@field displacement bw.Array (m, node_count × 2, per node) displacement along x and y
---@field velocity bw.Array? (m/s, node_count × 2, per node) velocity along x and y; nil here
---@field acceleration bw.Array? (m/s2, node_count × 2, per node) acceleration along x and y; nil here
---@field stress bw.Array (Pa, node_count × 4, per node) stress: xx, yy, xy, zz
---@field von_mises bw.Array (Pa, node_count × 1, per node) von Mises stress
---@field error_estimate number (-) relative error in the energy norm, estimated by Zienkiewicz and Zhu
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh
---@field elements bw.Array (index from 1, element_count × 3 or 6, per element) corners, then the mid-edge nodes of edges 1-2, 2-3 and 3-1
---@field element_count integer (count) triangles
---@field node_count integer (count) nodes
---@field time number (s) the time in conditions: 0
local SteadySheet = {}

---Moves a handle of the outline; the sheet is solved again.
---
---Errors: geometry (edges would cross or touch), and those of `bw.responsive.steady`. After a failure the sheet is as it was.
---@param handle bw.OutlineHandle what is moved
---@param by number[] (m, {x, y}) the displacement
---@return bw.SteadySheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function SteadySheet:drag(handle, by) end

---Takes another outline, of any topology with the tags of the conditions; the sheet is solved again.
---
---Errors: those of `bw.responsive.steady`. An outline without a tag that a condition is on raises. After a failure the
---sheet is as it was.
---@param outline bw.Outline the other outline
---@return bw.SteadySheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function SteadySheet:become(outline) end

---Solves again on the outline as it is.
---
---Errors: those of `bw.responsive.steady`. After a failure the sheet is as it was.
---@return bw.SteadySheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function SteadySheet:solve() end

---The power mean of von Mises stresses over the area, (∫ σ^p dA / A)^(1/p), and its exact gradient by one adjoint
---solution. It tends to the largest stress from below as p grows.
---
---Errors: singular, convergence (the adjoint equations could not be solved).
---@param p number (-) the exponent. Range: 1 to 1000
---@return number? norm (Pa) the power mean
---@return bw.Array|string by_points (Pa/m, point_count × 2, per point of the outline) its gradient, or the message
---@return bw.Array|bw.Details by_nodes (Pa/m, node_count × 2, per node) its gradient, or the details
function SteadySheet:stress_norm(p) end

---A sheet in large deflection, made by `bw.responsive.cantilever`.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local options = {outline = outline, material = bw.material.pla, elements = 200}
---options.conditions = {left = "fixed", right = {traction = {0, -1e5}}}
---local sheet = assert(bw.responsive.cantilever(options))
---assert(sheet:drag({vertex = 3}, {0, 0.005}))
---print(sheet.displacement:min(), sheet.reused)
---```
---@class bw.LargeDeflectionSheet
---@field outline bw.Outline the current outline
---@field mesh bw.PlaneMesh the current mesh
---@field reused bw.ReuseStatistics what the last frame reused
---@field report bw.SolverReport? what solved in the last frame, and why; nil where nothing was solved yet
---@field displacement bw.Array (m, node_count × 2, per node) displacement along x and y
---@field velocity bw.Array? (m/s, node_count × 2, per node) velocity along x and y; nil here
---@field acceleration bw.Array? (m/s2, node_count × 2, per node) acceleration along x and y; nil here
---@field stress bw.Array (Pa, node_count × 4, per node) stress: xx, yy, xy, zz (Cauchy)
---@field von_mises bw.Array (Pa, node_count × 1, per node) von Mises stress
---@field error_estimate number (-) relative error in the energy norm, estimated by Zienkiewicz and Zhu
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh
---@field elements bw.Array (index from 1, element_count × 3 or 6, per element) corners, then the mid-edge nodes of edges 1-2, 2-3 and 3-1
---@field element_count integer (count) triangles
---@field node_count integer (count) nodes
---@field time number (s) the time in conditions: 0
local LargeDeflectionSheet = {}

---Moves a handle of the outline; the sheet is brought to equilibrium again.
---
---Errors: geometry (edges would cross or touch), and those of `bw.responsive.cantilever`. After a failure the sheet is as it was.
---@param handle bw.OutlineHandle what is moved
---@param by number[] (m, {x, y}) the displacement
---@return bw.LargeDeflectionSheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function LargeDeflectionSheet:drag(handle, by) end

---Takes another outline, of any topology with the tags of the conditions; the sheet is brought to equilibrium again.
---
---Errors: those of `bw.responsive.cantilever`. An outline without a tag that a condition is on raises. After a failure the
---sheet is as it was.
---@param outline bw.Outline the other outline
---@return bw.LargeDeflectionSheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function LargeDeflectionSheet:become(outline) end

---Solves again on the outline as it is.
---
---Errors: those of `bw.responsive.cantilever`. After a failure the sheet is as it was.
---@return bw.LargeDeflectionSheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function LargeDeflectionSheet:solve() end

---A sheet on moving ground, made by `bw.responsive.vibration`.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local options = {outline = outline, material = bw.material.pla, elements = 200}
---options.ground, options.ground_motion = "left", {y = "0.001 * sin(100 * t)"}
---local sheet = assert(bw.responsive.vibration(options))
---assert(sheet:step(5))
---print(sheet.time, sheet.velocity)
---```
---@class bw.TransientSheet
---@field outline bw.Outline the current outline
---@field mesh bw.PlaneMesh the current mesh
---@field reused bw.ReuseStatistics what the last frame reused
---@field report bw.SolverReport? what solved in the last frame, and why; nil where nothing was solved yet
---@field displacement bw.Array (m, node_count × 2, per node) displacement along x and y
---@field velocity bw.Array? (m/s, node_count × 2, per node) velocity along x and y; nil before the first step
---@field acceleration bw.Array? (m/s2, node_count × 2, per node) acceleration along x and y; nil before the first step
---@field stress bw.Array (Pa, node_count × 4, per node) stress: xx, yy, xy, zz
---@field von_mises bw.Array (Pa, node_count × 1, per node) von Mises stress
---@field error_estimate number (-) relative error in the energy norm, estimated by Zienkiewicz and Zhu
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh
---@field elements bw.Array (index from 1, element_count × 3 or 6, per element) corners, then the mid-edge nodes of edges 1-2, 2-3 and 3-1
---@field element_count integer (count) triangles
---@field node_count integer (count) nodes
---@field time number (s) the time since the start
local TransientSheet = {}

---Moves a handle of the outline; displacements and velocities are transferred to the new mesh.
---
---Errors: geometry (edges would cross or touch), and those of `bw.responsive.vibration`. After a failure the sheet is as it was.
---@param handle bw.OutlineHandle what is moved
---@param by number[] (m, {x, y}) the displacement
---@return bw.TransientSheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function TransientSheet:drag(handle, by) end

---Takes another outline, of any topology with the tags of the conditions; displacements and velocities are transferred to the new mesh.
---
---Errors: those of `bw.responsive.vibration`. An outline without a tag that a condition is on raises. After a failure the
---sheet is as it was.
---@param outline bw.Outline the other outline
---@return bw.TransientSheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function TransientSheet:become(outline) end

---Advances by time steps, all or none.
---
---Errors: singular, convergence (the linear equations could not be solved). After a failure the sheet is as it was.
---@param count? integer (count) steps, 1 and more. Default: 1
---@return bw.TransientSheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function TransientSheet:step(count) end

---The engine's sheet and its mesh motion, `body` of the sheets above. Scripts take these. `frame` is a table that receives
---what the call reused.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local options = {outline = outline, material = bw.material.pla, elements = 200}
---options.conditions = {left = "fixed", right = {traction = {0, -1e5}}}
---local sheet = assert(bw.responsive.steady(options))
---print(sheet.body:counts())
---```
---@class bw.Sheet
---@field outline bw.Outline the current outline
---@field mesh bw.PlaneMesh the current mesh
---@field displacement bw.Array (m, node_count × 2, per node) displacement along x and y
---@field velocity bw.Array? (m/s, node_count × 2, per node) velocity along x and y; nil before the first step in time
---@field acceleration bw.Array? (m/s2, node_count × 2, per node) acceleration along x and y; nil before the first step in time
---@field stress bw.Array (Pa, node_count × 4, per node) stress: xx, yy, xy, zz; Cauchy stress after `large_deflection`
---@field von_mises bw.Array (Pa, node_count × 1, per node) von Mises stress
---@field error_estimate number (-) relative error in the energy norm, estimated by Zienkiewicz and Zhu
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh
---@field elements bw.Array (index from 1, element_count × 3 or 6, per element) corners, then the mid-edge nodes of edges 1-2, 2-3 and 3-1
---@field time number (s) the time since the start
---@field order integer (-) order of the elements: 1 or 2
local Sheet = {}

---Takes mesh and solution to an outline; it does not solve.
---
---Errors: those of `bw.plane.fill`.
---@param frame bw.ReuseStatistics receives what was reused
---@param outline bw.Outline the outline, with the tags of the conditions
---@return bw.ReuseStatistics? frame the same table
---@return string? message
---@return bw.Details? details
function Sheet:follow(frame, outline) end

---How linear equations are solved on a lagged factor.
---@class bw.LaggedFactorOptions
---@field solver? bw.Solver|"auto" as of the analysis. Default: "auto"
---@field max_lag? integer (count) as of the analysis. Default: any number

---Solves linear statics.
---
---Errors: unconstrained, singular (the conditions leave the sheet free to move), convergence (the linear solution stopped
---early).
---@param frame bw.ReuseStatistics receives what was reused
---@param solver? bw.LaggedFactorOptions how linear equations are solved. Default: as stated there
---@return bw.ReuseStatistics? frame the same table
---@return string? message
---@return bw.Details? details
function Sheet:static(frame, solver) end

---Advances by time steps of Newmark's method, all or none.
---
---Errors: singular, convergence (the linear equations could not be solved).
---@param frame bw.ReuseStatistics receives what was reused
---@param solver? bw.LaggedFactorOptions how linear equations are solved. Default: as stated there
---@param newmark? bw.NewmarkOptions the time step and the scheme. Default: as stated there
---@param steps? integer (count) steps. Default: 1
---@return bw.ReuseStatistics? frame the same table
---@return string? message
---@return bw.Details? details
function Sheet:transient(frame, solver, newmark, steps) end

---Newmark's method with Rayleigh damping.
---@class bw.NewmarkOptions
---@field step? number (s) the time step, above 0. Default: 1e-3
---@field beta? number (-) Newmark's beta. Range: gamma / 2 and more. Default: 0.25
---@field gamma? number (-) Newmark's gamma. Range: 1/2 and more. Default: 0.5
---@field damping_mass? number (1/s) coefficient of the mass matrix, 0 or more. Default: 0
---@field damping_stiffness? number (s) coefficient of the stiffness matrix, 0 or more. Default: 0

---Finds equilibrium in large deflection by Newton's method with a line search on the energy.
---
---Errors: convergence (there is no equilibrium on the way, or an element inverts), singular.
---@param frame bw.ReuseStatistics receives what was reused
---@param solver? bw.LaggedFactorOptions how linear equations are solved. Default: as stated there
---@param newton? bw.NewtonOptions when Newton's method ends. Default: as stated there
---@return bw.ReuseStatistics? frame the same table
---@return string? message
---@return bw.Details? details
function Sheet:large_deflection(frame, solver, newton) end

---When Newton's method ends.
---@class bw.NewtonOptions
---@field tolerance? number (-) residual over load, above 0. Default: 1e-8
---@field iterations? integer (count) iterations of a load step, 1 and more. Default: 30
---@field load_steps? integer (count) the most load steps, 1 and more. Default: 64

---The current state of mesh and sheet. It copies nothing.
---@return bw.BodyState state the state
function Sheet:save() end

---Returns to a state, bit for bit. A state of another sheet raises.
---
---Errors: only those that every function may give.
---@param state bw.BodyState a state of this sheet
---@return bw.Sheet? sheet the same sheet
---@return string? message
---@return bw.Details? details
function Sheet:restore(state) end

---Checks that all parts of it belong together, for tests and debugging. It raises where they do not.
---@return bw.Sheet self
function Sheet:check() end

---The power mean of von Mises stresses over the area, (∫ σ^p dA / A)^(1/p), and its exact gradient by one adjoint
---solution. It tends to the largest stress from below as p grows.
---
---Errors: singular, convergence (the adjoint equations could not be solved).
---@param p number (-) the exponent. Range: 1 to 1000
---@return number? norm (Pa) the power mean
---@return bw.Array|string by_points (Pa/m, point_count × 2, per point of the outline) its gradient, or the message
---@return bw.Array|bw.Details by_nodes (Pa/m, node_count × 2, per node) its gradient, or the details
function Sheet:stress_norm(p) end

---The size of the mesh.
---@return integer elements (count) triangles
---@return integer nodes (count) nodes
function Sheet:counts() end

---Frees its memory at once.
function Sheet:close() end

---The state of a body that follows an outline, and of its mesh, made by `keep`.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local options = {outline = outline, material = bw.material.pla, elements = 200}
---options.conditions = {left = "fixed", right = {traction = {0, -1e5}}}
---local sheet = assert(bw.responsive.steady(options))
---local state = sheet.body:save()
---assert(sheet.body:restore(state))
---```
---@class bw.BodyState
local BodyState = {}

---Frees its memory at once.
function BodyState:close() end
