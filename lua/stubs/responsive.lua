---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Responsive analyses
--
-- Analyses in the plane that follow an outline while it is dragged.

---Analyses of a plane body whose outline is dragged. Each function makes an object that holds its last good state. A
---drag that outline, mesh or solution refuses returns nil, message and details, and the object is as it was before.
---
---Conditions are given by the tags of the outline. Values are numbers, formulas in x, y (m) and t (s), or functions of
---them. Where edges of different tags meet at a node, what one of them prescribes holds over what the other leaves free.
---Of two prescribed values the one nearest to 0 holds, and of two temperatures the mean. A list of tables of conditions
---has an order: later entries decide over earlier ones. `bw.warnings` names conflicts. A tag that the outline lacks
---raises, and so does an unknown key.
---
---Source: Umetani, Takayama, Mitani, Igarashi, A Responsive Finite Element Method to Aid Interactive Geometric Modeling.
---@class bw.ResponsiveModule
local responsive_module = {}

---A bridge over a span with a load on its middle. Its aim is the least area with which the von Mises stress stays below a
---limit. `Bridge:design` finds the shape. A pad or bearings so small that the load alone presses with more than the limit
---raise, as do a pad as long as the span and a depth below four walls.
---
---Errors: geometry (`outline` does not have foot, pad and axis in their places, or reaches across the axis; details `tag`
---or `x`), and those of `bw.plane.fill`.
---```lua
---local options = {span = 0.2, load = 500, stress_limit = 20e6, thickness = 0.006, material = bw.material.pla}
---local bridge = assert(bw.responsive.bridge(options))
---print(bridge)
---```
---@param options bw.ResponsiveBridgeOptions span, load, limit, and the shape to begin with
---@return bw.Bridge? bridge the bridge, solved
---@return string? message
---@return bw.Details? details
function responsive_module.bridge(options) end

---What a bridge is for, and the shape to begin with. `bar` is load / (thickness stress_limit), the width of a bar that
---carries the load at the limit.
---@class bw.ResponsiveBridgeOptions
---@field span number (m) between the banks, above 0
---@field load number (N) downwards on the pad, above 0
---@field stress_limit number (Pa) the largest von Mises stress that is allowed, above 0
---@field material bw.Material the material
---@field thickness number (m) the thickness, above 0
---@field depth? number (m) the height of the pad above the feet, above 0. Default: half the span
---@field bearing? number (m) how far a foot reaches onto its bank, above 0. Default: the larger of `bar` and 1/25 of the span
---@field pad? number (m) the width under the load, above 0. Default: the larger of twice `bar` and 1/12 of the span
---@field wall? number (m) the smallest width of a member, above 0. Default: 1/50 of the span
---@field size? number (m) the edge length of elements, above 0. Default: 1/100 of the span
---@field start? "truss"|"gable"|"beam"|"arch" the shape to begin with. Default: "gable"
---@field outline? bw.Outline the right half to begin with, instead of `start`. Default: none

---Linear statics of an elastic sheet, solved in every drag.
---
---Errors: unconstrained (the conditions leave the sheet free to move; the message says where), convergence (the linear
---solution stopped early), and those of `bw.plane.fill`.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local ends = {left = "fixed", right = {traction = {0, -1e5}}}
---local sheet = assert(bw.responsive.steady {outline = outline, material = bw.material.pla, conditions = ends})
---assert(sheet:drag({vertex = 3}, {0, 0.005}))
---print(sheet, sheet.von_mises:max())
---```
---@param options bw.ResponsiveSteadyOptions outline, material and conditions
---@return bw.SteadySheet? sheet the sheet, solved
---@return string? message
---@return bw.Details? details
function responsive_module.steady(options) end

---What all elastic sheets are made of.
---@class bw.ResponsiveSteadyOptions
---@field outline bw.Outline the outline to begin with
---@field size? number|string|fun(x: number, y: number, t: number): number (m) the wanted edge length of elements, above 0: a number, a formula in x and y, or a function of them; not beside `elements`. Default: from `elements`
---@field elements? integer (count) the wanted number of triangles, 1 and more. Default: 2000
---@field follow? bw.ResponsiveFollowOptions how the mesh follows the outline. Default: as stated there
---@field order? integer (-) order of the elements: 1 or 2. Default: 1
---@field material bw.Material|bw.Material[] the material, or a list of one for each region; isotropic, or orthotropic with an axis along z
---@field thickness? number|number[] (m, region_count, per region) the thickness, or a list of one for each region; with plane strain loads are per this depth. Default: 1
---@field plane? "stress"|"strain" plane stress or plane strain. Default: "stress"
---@field conditions? bw.SheetConditions|bw.SheetConditions[] supports and loads. Default: none
---@field gravity? number[] (m/s2, {x, y}) the acceleration of gravity. Default: {0, 0}
---@field solver? bw.Solver|"auto" of the linear equations. `bw.solver.cholesky`: a new factor for each solution, with `full` a new analysis too; `bw.solver.pcg` with the preconditioner `bw.solver.cholesky`: iterations on the factor of a former frame as long as they converge, to a relative residual of 1e-8 in at most 60 iterations where it leaves them open. Default: "auto", whichever is predicted to cost less
---@field max_lag? integer (count) linear solutions that a factor may serve beyond the one that it was computed for, 0 or more; not with a solver that computes it for each. Default: any number

---Supports and loads of a sheet by tag of the edges. "fixed": both displacements are 0.
---@alias bw.SheetConditions table<string, "fixed"|bw.SheetCondition>

---What holds on the edges of a tag of a sheet. Without a key the component is free.
---@class bw.SheetCondition
---@field x? number|string|fun(x: number, y: number, t: number): number (m) prescribed displacement along x
---@field y? number|string|fun(x: number, y: number, t: number): number (m) prescribed displacement along y
---@field traction? bw.ResponsivePair (Pa) force per area along x and y
---@field pressure? number|string|fun(x: number, y: number, t: number): number (Pa) pressure along the inner normal

---Two values by place and time: `{x, y}`.
---@alias bw.ResponsivePair (number|string|fun(x: number, y: number, t: number): number)[]

---How the mesh of an analysis follows its outline.
---@class bw.ResponsiveFollowOptions
---@field relocation? "harmonic"|"springs" how inner nodes move: by the harmonic extension of the boundary's displacement, or towards the mean of their neighbours. Default: "harmonic"
---@field rounds? integer (count) rounds of "springs". Range: 0 to 10000. Default: 2
---@field distorted? number (-) element quality below which edges are flipped. Range: 0 to below 1. Default: 0.35
---@field rebuild? number (-) element quality below which, after flips, the outline is filled again. Range: 0 to `distorted`. Default: 0.1
---@field level? "none"|"relocation"|"reconnecting"|"reconstruction" the level that is taken at least, each time. Default: "none"

---Statics of a sheet in large deflection (St. Venant-Kirchhoff), brought to equilibrium in every drag by Newton's method.
---
---Errors: convergence (Newton's method found no equilibrium: the sheet snaps or folds, or an element inverts), unconstrained or singular
---(the conditions leave the sheet free to move), and those of `bw.plane.fill`.
---
---Source: Umetani et al., equation 3.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.01}}).outline
---local options = {outline = outline, material = bw.material.pla, elements = 200}
---options.conditions = {left = "fixed", right = {traction = {0, -1e5}}}
---local sheet = assert(bw.responsive.cantilever(options))
---print(sheet, sheet.reused.newton_iterations)
---```
---@param options bw.ResponsiveCantileverOptions outline, material, conditions and Newton's method
---@return bw.LargeDeflectionSheet? sheet the sheet, in equilibrium
---@return string? message
---@return bw.Details? details
function responsive_module.cantilever(options) end

---A sheet in large deflection.
---@class bw.ResponsiveCantileverOptions: bw.ResponsiveSteadyOptions
---@field newton? bw.NewtonOptions when Newton's method ends. Default: as stated there

---Transient dynamics of a sheet on moving ground, by Newmark's method. It begins at rest, at time 0; `step` advances
---the time. `beta` and `gamma` outside of 2 beta ≥ gamma ≥ 1/2 raise at the first step.
---
---Errors: those of `bw.plane.fill`.
---
---Source: Umetani et al., equations 1 and 2.
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local options = {outline = outline, material = bw.material.pla, elements = 200}
---options.ground, options.ground_motion = "left", {y = "0.001 * sin(100 * t)"}
---local sheet = assert(bw.responsive.vibration(options))
---assert(sheet:step(5))
---print(sheet.time, sheet.von_mises:max())
---```
---@param options bw.ResponsiveVibrationOptions outline, material, ground and time step
---@return bw.TransientSheet? sheet the sheet, at rest
---@return string? message
---@return bw.Details? details
function responsive_module.vibration(options) end

---A sheet on moving ground.
---@class bw.ResponsiveVibrationOptions: bw.ResponsiveSteadyOptions
---@field ground? string|string[] the tags of the edges on the ground; they decide over all conditions. Default: none
---@field ground_motion? bw.GroundMotion the displacement of the ground. Default: 0
---@field step? number (s) the time step, above 0. Default: 1e-3
---@field beta? number (-) Newmark's beta. Range: gamma / 2 and more. Default: 0.25
---@field gamma? number (-) Newmark's gamma. Range: 1/2 and more. Default: 0.5
---@field damping? number[] (any, {mass, stiffness}) Rayleigh damping, both 0 or more: of the mass matrix (1/s) and of the stiffness matrix (s). Default: {0, 0}

---The displacement of the ground by place and time.
---@class bw.GroundMotion
---@field x? number|string|fun(x: number, y: number, t: number): number (m) along x. Default: 0
---@field y? number|string|fun(x: number, y: number, t: number): number (m) along y. Default: 0

---Incompressible flow on linear triangles (SUPG and PSPG stabilisation), implicit in time, at the shape as it is dragged.
---Without `steady` it begins at rest, at time 0, and `step` advances the time. Fluid leaves freely where there is no
---condition. Without an outflow and a prescribed pressure, the mean pressure is 0.
---
---Errors: convergence (there is no steady state, or the linear solution stopped early), singular (the equations have no
---unique solution), and those of `bw.plane.fill`.
---
---Source: Umetani et al., section 4; Tezduyar, Mittal, Ray and Shih, Comput. Methods Appl. Mech. Eng. 95 (1992).
---```lua
---local outline = assert(bw.plane.rectangle {max = {0.1, 0.02}}).outline
---local walls = {left = {x = 0.1, y = 0}, top = "wall", bottom = "wall"}
---local flow = assert(bw.responsive.flow {outline = outline, viscosity = 1e-3, step = 0.01, conditions = walls, elements = 400})
---assert(flow:step(2))
---print(flow.time, flow:force "top")
---```
---@param options bw.ResponsiveFlowOptions outline, fluid, conditions and time step
---@return bw.Flow? flow the flow: at rest, or with `steady` in its steady state
---@return string? message
---@return bw.Details? details
function responsive_module.flow(options) end

---What a flow is made of.
---@class bw.ResponsiveFlowOptions
---@field outline bw.Outline the outline to begin with
---@field size? number|string|fun(x: number, y: number, t: number): number (m) the wanted edge length of elements, above 0: a number, a formula in x and y, or a function of them; not beside `elements`. Default: from `elements`
---@field elements? integer (count) the wanted number of triangles, 1 and more. Default: 2000
---@field follow? bw.ResponsiveFollowOptions how the mesh follows the outline. Default: as stated there
---@field viscosity number (Pa s) dynamic viscosity, above 0
---@field density? number (kg/m3) the density, above 0. Default: 1
---@field conditions? bw.FlowConditions|bw.FlowConditions[] walls, inflow and loads. Default: none
---@field gravity? number[] (m/s2, {x, y}) the acceleration of gravity. Default: {0, 0}
---@field step? number (s) the time step, above 0; `step` of the flow raises without it. Default: none
---@field steady? boolean whether the steady state is found at once and in every drag. Default: false
---@field bdf? integer (-) order of the backward differentiation in time: 1 or 2; the first step has 1. Default: 2
---@field iterations? integer (count) nonlinear iterations of a step; 0: 1 for a time step, 30 for a steady state. Default: 0
---@field tolerance? number (-) relative change of the solution at which nonlinear iterations end, above 0. Default: 1e-8
---@field ale? boolean whether nodes that moved since the last step carry a mesh velocity. Default: false
---@field solver? bw.Solver|"auto" of the linear equations. `bw.solver.lu`: a new factor for each solution, with `full` a new analysis too; `bw.solver.bicgstab`: iterations on the factor of a former step as long as they converge, to a relative residual of 1e-6 in at most 60 iterations where it leaves them open. Default: "auto", whichever is predicted to cost less
---@field max_lag? integer (count) linear solutions that a factor may serve beyond the one that it was computed for, 0 or more; not with a solver that computes it for each. Default: any number

---Conditions of a flow by tag of the edges. "wall": the velocity is 0.
---@alias bw.FlowConditions table<string, "wall"|bw.FlowCondition|bw.HeatCondition>

---What holds on the edges of a tag of a flow. Without a velocity fluid passes freely.
---@class bw.FlowCondition
---@field x? number|string|fun(x: number, y: number, t: number): number (m/s) prescribed velocity along x
---@field y? number|string|fun(x: number, y: number, t: number): number (m/s) prescribed velocity along y
---@field traction? bw.ResponsivePair (Pa) force per area along x and y
---@field pressure? number|string|fun(x: number, y: number, t: number): number (Pa) pressure beyond an open end, along the inner normal

---Flow with heat that is carried along and lifts (Boussinesq).
---
---Errors: as of `bw.responsive.flow`.
---
---Source: Umetani et al., equations 6 to 8.
---```lua
---local options = {outline = assert(bw.plane.rectangle {}).outline, viscosity = 1, diffusivity = 1, expansion = 100}
---options.elements, options.steady, options.gravity = 200, true, {0, -10}
---options.conditions = {left = {x = 0, y = 0, temperature = 1}, right = {x = 0, y = 0, temperature = 0},
---  top = "wall", bottom = "wall"}
---print(assert(bw.responsive.thermal(options)):nusselt("left", 1))
---```
---@param options bw.ResponsiveThermalOptions outline, fluid, conditions and time step
---@return bw.ThermalFlow? flow the flow: at rest, or with `steady` in its steady state
---@return string? message
---@return bw.Details? details
function responsive_module.thermal(options) end

---What a flow with heat is made of. Its conditions may also have those of `bw.HeatCondition`.
---@class bw.ResponsiveThermalOptions: bw.ResponsiveFlowOptions
---@field diffusivity number (m2/s) thermal diffusivity, above 0
---@field expansion? number (1/K) thermal expansion: the lift is -density expansion (T - reference) gravity. Default: 0
---@field reference? number (K) the temperature without lift, and that of the start. Default: 0

---What holds on the edges of a tag of a flow with heat. `temperature` beside `convection` raises.
---@class bw.HeatCondition: bw.FlowCondition
---@field temperature? number|string|fun(x: number, y: number, t: number): number (K) prescribed temperature
---@field heat_flux? number|string|fun(x: number, y: number, t: number): number (K m/s) heat flux into the fluid over density times heat capacity
---@field convection? bw.Convection heat exchange with what is around

---Heat exchange: `coefficient` (`temperature` - T) comes in.
---@class bw.Convection
---@field coefficient number (m/s) heat transfer coefficient over density times heat capacity, 0 or more
---@field temperature number|string|fun(x: number, y: number, t: number): number (K) temperature of what is around

---A metallophone bar: the outline extruded to a free plate (Reissner-Mindlin), solved in every drag from the modes and the
---factor of the last frame. A material without density raises.
---
---Errors: geometry (the thickness is above the larger side of the outline's box, or below a millionth of it),
---convergence (the modes did not reach `tolerance`), and those of `bw.plane.fill`.
---
---Source: Umetani et al., section 5.1 and appendix A.
---```lua
---local outline = assert(bw.outline.rectangle {width = 0.1, height = 0.02})
---local bar = assert(bw.responsive.metallophone {outline = outline, material = bw.material.pla, thickness = 0.004})
---print(bar.frequency, bar.note)
---```
---@param options bw.ResponsiveMetallophoneOptions outline, material and thickness
---@return bw.Metallophone? bar the bar, solved
---@return string? message
---@return bw.Details? details
function responsive_module.metallophone(options) end

---What a metallophone bar is made of.
---@class bw.ResponsiveMetallophoneOptions
---@field outline bw.Outline the outline to begin with
---@field size? number (m) the wanted edge length of elements, above 0; not beside `elements`. Default: from `elements`
---@field elements? integer (count) the wanted number of six-node triangles, 1 and more. Default: 400
---@field follow? bw.ResponsiveFollowOptions how the mesh follows the outline. Default: as stated there
---@field material bw.Material the material; one of its axes is the normal of the plate
---@field thickness number (m) the thickness, above 0
---@field modes? integer (count) elastic modes. Range: 1 to 200. Default: 1
---@field tolerance? number (-) relative error of a mode in the energy norm, above 0; that of the frequency is its square. Default: 1e-4
---@field solver? bw.Eigensolver|"auto" `bw.eigensolver.lobpcg`, on the factor of a former frame. Default: "auto", the same
---@field max_lag? integer (count) solutions that a factor may serve beyond the one that it was computed for, 0 or more. Default: any number, as long as iterations are few

---What a frame reused and what it cost. The numbers are sums over the linear solutions of the frame. It prints as one line.
---Fields that a frame has not computed are nil.
---@class bw.ReuseStatistics
---@field level "none"|"relocation"|"reconnecting"|"reconstruction" the most that the mesh needed: nothing, nodes relocated, edges flipped, or a new mesh
---@field flips integer (count) edges that were flipped
---@field quality number? (-) the lowest quality of an element, 1: equilateral
---@field pattern boolean? whether the sparsity pattern of the matrix was reused
---@field factor boolean? whether a factor of a former frame was used
---@field solution boolean? whether the former solution was the initial guess
---@field analyses integer? (count) symbolic analyses
---@field factorisations integer (count) factorisations
---@field solves integer (count) linear solutions
---@field iterations integer (count) iterations of linear solutions
---@field residual number? (-) the largest relative residual that was reached
---@field seconds_mesh number? (s) time for the mesh
---@field seconds_assemble number? (s) time for the matrices
---@field seconds_factor number? (s) time for factors
---@field seconds_solve number? (s) time for linear solutions
---@field report bw.SolverReport? what solved, and why
---@field newton_iterations integer? (count) of a sheet in large deflection: iterations of Newton's method
---@field load_steps integer? (count) of a sheet in large deflection: load steps
---@field energy number? (J) of a sheet in large deflection: total potential energy
