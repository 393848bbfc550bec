---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Heat
--
-- Conduction of heat in tetrahedral meshes, steady and in time: prescribed temperatures, fluxes, convection, radiation,
-- sources. Temperatures are in kelvin where a body radiates, else kelvin or degrees Celsius.

---@class bw
local bw = {}

---A body that conducts heat, without conditions: no heat passes where none is given.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.02, 0.02}, cells = {8, 2, 2}, order = 2}
---local heat = bw.heat {mesh = mesh, material = bw.material.steel}
---heat:prescribe(mesh.boundary:below("x", 0), 400)
---heat:load {on = mesh.boundary:above("x", 0.1), convection = {coefficient = 25, temperature = 293}}
---print(assert(heat:solve()))
---```
---A material without conductivity raises, and so do bodies that overlap in more than a tenth of the smaller one.
---
---Source: docs/theory/heat.md.
---@param options bw.HeatOptions mesh and material
---@return bw.Heat heat the body
function bw.heat(options) end

---What conducts heat.
---@class bw.HeatOptions
---@field mesh bw.Mesh the body
---@field material? bw.Material of all elements, with a conductivity; needed without `materials`
---@field materials? table<string, bw.Material> the material of each region of the mesh, by its name; instead of `material`

---A mesh with a material and conditions of heat; `print` lists them with their numbers.
---```lua
---local heat = bw.heat {mesh = bw.mesh.box {max = {1, 1, 1}, cells = {2, 2, 2}}, material = bw.material.steel}
---print(heat:load {source = 1000})
---```
---@class bw.Heat
---@field mesh bw.Mesh the body
---@field material bw.Material its material; with several `parts` as `materials` gave them
---@field condition_count integer (count) of conditions, in the order in which they were added
local Heat = {}

---Releases the body at once.
function Heat:close() end

---Prescribes the temperature of a selection. Where several prescribe that of a node, the last one counts.
---
---Errors: `empty` for a selection without a facet that is no node set.
---@param selection bw.Selection where
---@param temperature number|bw.Array (K, node_count × 1) one for all, or one for each node
---@return bw.Heat? heat itself
---@return string? message
---@return bw.Details? details
function Heat:prescribe(selection, temperature) end

---Adds a condition.
---
---Errors: `geometry` for facets without area, and for contact of surfaces that do not touch, with the distance. A selection
---without a facet raises. So does contact with a node on both sides, or with a conductance above 1e9 conductivities over the
---length of a facet.
---@param options bw.HeatLoad one of its kinds
---@return bw.Heat? heat itself
---@return string? message
---@return bw.Details? details
function Heat:load(options) end

---A condition of heat: one of its kinds.
---@class bw.HeatLoad
---@field on? bw.Selection where; without it a power is spread over the volume, as a source is
---@field heat_flux? number (W/m2) into the body
---@field power? number (W) in total, spread evenly over area or volume
---@field source? number|bw.Array (W/m3, node_count × 1) in the whole body; one for all, or one for each node
---@field convection? bw.HeatConvection a flux in proportion to a difference of temperatures
---@field radiation? bw.HeatRadiation a flux by the fourth power of temperatures
---@field contact? bw.HeatContact a flux in proportion to the jump of the temperature from another surface at the same place

---Convection, a flux coefficient (temperature − T) into the body.
---@class bw.HeatConvection
---@field coefficient number (W/(m2 K)) 0 or more
---@field temperature number (K) of the fluid

---Radiation, a flux emissivity σ (temperature⁴ − T⁴) into the body.
---@class bw.HeatRadiation
---@field emissivity number (-) of the surface. Range: 0 to 1.
---@field temperature number (K) of what is around, 0 or more
---@field about? number (K) about which it is linearised; 0: it is not. Default: 0

---Contact that resists heat, a flux conductance (T' − T) from the other surface, where it is T'. Each surface has nodes of its
---own, as `mesh:separated` or two parts have them, which need not match. Facets are in contact where they overlap, the
---others are not. `tostring(heat)` tells the area in contact. The contact of forces, `Model:contact`, is another thing: pressures do
---not change the conductance.
---@class bw.HeatContact
---@field with bw.Selection the other surface, without a node of `on`
---@field conductance number (W/(m2 K)) the reciprocal of the thermal resistance of an area. Range: above 0, to 1e9 conductivities over the length of a facet.
---@field gap? number (m) up to which facets that face each other are in contact. Range: above 0. Default: a twentieth of the mean edge.

---Joins two surfaces that have the same temperature and whose nodes need not match, as `Model:bond` does. Side a follows side b
---where they touch. Make a the side that the other one covers. Linear temperatures pass a plane bond exactly. A
---prescribed temperature of a node on side a wins over the bond. The bond is a condition, whose `heat_in` is from b to a.
---```lua
---local mesh = bw.mesh.box({max = {0.1, 0.01, 0.01}, cells = {10, 1, 1}}):split({max = {0.05, 1, 1}}, "left"):separated "left"
---local heat, boundary = bw.heat {mesh = mesh, material = bw.material.steel}, mesh.boundary
---heat:prescribe(boundary:below("x", 0), 300):load {on = boundary:above("x", 0.1), power = 2}
---heat:bond {a = boundary:region "left", b = boundary:region "rest"}
---print(assert(heat:solve()).heat_in[3])
---```
---
---Errors: `geometry` for sides that do not touch, with the distance, and for facets of side a that side b hardly covers. A side
---without a facet, a node on both sides, and a node that follows others in two bonds, or follows nodes that follow others, raise.
---
---Source: Popp, Wohlmuth, Gee, Wall, SIAM J. Sci. Comput. 34 (2012); docs/theory/heat.md.
---@param options bw.HeatBondOptions the two sides
---@return bw.Heat? heat itself
---@return string? message
---@return bw.Details? details
function Heat:bond(options) end

---The sides of a bond that conducts heat.
---@class bw.HeatBondOptions
---@field a bw.Selection the side that follows
---@field b bw.Selection the side that it follows, without a node of `a`
---@field gap? number (m) up to which facets that face each other are bonded. Range: above 0. Default: a twentieth of the mean edge.

---Gives a condition another value: its temperature, flux, power or source, or the temperature of fluid or surroundings. A
---field of an array is multiplied by it.
---
---Errors: none; a number that is outside its range raises, and so do contact and bonds, which have no value.
---@param condition integer (index from 1) in the order in which they were added
---@param value number (any) in the unit of the condition
---@return bw.Heat? heat itself
---@return string? message
---@return bw.Details? details
function Heat:set(condition, value) end

---The steady state.
---
---Errors: `unconstrained` for a body with neither prescribed temperature nor convection nor radiation nor contact or a bond with one that has; `convergence` where the
---iterations do not reach their tolerance; `unsupported` for a solver that does not serve; `memory` for a factor larger than what
---is free; `geometry` for an inverted element; `singular` where the matrix is not
---positive definite.
---
---Source: docs/theory/heat.md.
---@param options? bw.HeatSolveOptions how
---@return bw.HeatSolution? solution the temperatures
---@return string? message
---@return bw.Details? details
function Heat:solve(options) end

---How equations of heat are solved.
---@class bw.HeatSolveOptions
---@field solver? bw.Solver|"auto" cholesky, or pcg with the preconditioner two_level (quadratic elements), jacobi or cholesky. Default: a factor up to 100,000 unknowns, else pcg.
---@field tolerance? number (-) change of the temperature in an iteration over the largest one, at which radiation and conductivity by temperature are done. Range: above 0, below 1. Default: 1e-10.
---@field max_iterations? integer (count) of these iterations. Range: 1 or more. Default: 100.
---@field error? boolean of a steady state alone, whether the error of the highest temperature is estimated, by one more solution of the linear system. Default: false.

---Begins at time 0.
---
---Errors: `unsupported`
---for a solver that does not serve; `geometry` for an inverted element.
---
---Source: docs/theory/heat.md.
---@param options bw.HeatTransientOptions the start, and how time is stepped
---@return bw.HeatTransient? transient heat at time 0
---@return string? message
---@return bw.Details? details
function Heat:transient(options) end

---How heat spreads in time.
---@class bw.HeatTransientOptions: bw.HeatSolveOptions
---@field initial number|bw.Array (K, node_count × 1) temperature at the start, one for all or one for each node; prescribed ones hold from the start
---@field scheme? "backward_euler"|"crank_nicolson"|"bdf2" of first, second and second order. Default: "backward_euler".
---@field lumped? boolean capacity at nodes, of linear elements: no undershoot beside a jump. Default: false.

---A field of temperatures; `print` shows its range and the balance of heat.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.02, 0.02}, cells = {8, 2, 2}, order = 2}
---local heat = bw.heat {mesh = mesh, material = bw.material.steel}
---heat:prescribe(mesh.boundary:below("x", 0), 400):load {power = 10}
---local solution = assert(heat:solve())
---print(solution.temperature:max(), solution:error_estimate())
---```
---@class bw.HeatSolution
---@field mesh bw.Mesh the body
---@field time number (s) 0 of a steady state
---@field temperature bw.Array (K, n, per node) the field
---@field highest number (K) the highest temperature at a node
---@field highest_node integer (index from 1) where it is
---@field highest_error number? (K) estimate of the error of the highest temperature of the body, with `error = true`; nil otherwise
---@field flux bw.Array (W/m2, n × 3, per node) means over the elements around each, of one material; on an interface the larger one of its sides
---@field element_flux bw.Array (W/m2, n × 3, per element) means over each
---@field reaction bw.Array (W, n, per node) heat into the body where temperatures are prescribed
---@field heat_in bw.Array (W, n, per condition) heat into the body, of contact and bonds from the other surface, which is no part of the balance; in time its mean over the last step
---@field stored number (W) that the body takes up; 0 of a steady state
---@field imbalance number (W) what goes in, less what is stored: rounding, or the tolerance of the solver
---@field iterations integer (count) of radiation and conductivity; 1 of a linear problem
---@field report bw.SolverReport? of the linear systems; nil at the start of a transient
local HeatSolution = {}

---Releases the solution at once.
function HeatSolution:close() end

---The error estimate of Zienkiewicz and Zhu, in the norm of the flux, over that norm. It bounds no single temperature.
---
---Errors: `memory` where there is none left.
---
---Source: O. C. Zienkiewicz and J. Z. Zhu, Int. J. Numer. Meth. Eng. 24 (1987); docs/theory/heat.md.
---@return number? relative (-) about 0.05 for a usual mesh
---@return string? message
---@return bw.Details? details
function HeatSolution:error_estimate() end

---Writes temperature, flux and reaction as `.vtu`, or what the ending says.
---
---Errors: `io` where the file cannot be written; `unsupported` for an unknown ending.
---@param path string of the file
---@return boolean? done true
---@return string? message
---@return bw.Details? details
function HeatSolution:write(path) end

---A picture of the body coloured by its temperature.
---
---Errors: `io` where the file cannot be written; `unsupported` for an unknown ending.
---@param path string of the file
---@param options? bw.PictureOptions of bw.picture
---@return boolean? done true
---@return string? message
---@return bw.Details? details
function HeatSolution:picture(path, options) end

---Heat in time.
---```lua
---local mesh = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {2, 2, 2}}
---local heat = bw.heat {mesh = mesh, material = bw.material.aluminium}
---heat:load {on = mesh.boundary, convection = {coefficient = 25, temperature = 293}}
---local transient = assert(heat:transient {initial = 400, scheme = "bdf2"})
---print(assert(transient:run {time = 600, step = 10}))
---```
---@class bw.HeatTransient
---@field heat bw.Heat the body
---@field now bw.HeatSolution the present state
---@field time number (s) of it
---@field steps integer (count) that were taken
---@field error number (K) estimate of the error of the last step alone, the largest at a node; 0 where there is none yet
local HeatTransient = {}

---Releases it at once.
function HeatTransient:close() end

---A step to where the conditions have the values that they have now.
---
---Errors: those of `heat:solve`. Conditions that were added since the start raise.
---@param seconds number (s) its length, above 0
---@param limit? number (K) of the step's error: a larger one is not taken. Default: none.
---@return boolean? taken whether it was taken
---@return string? message
---@return bw.Details? details
function HeatTransient:step(seconds, limit) end

---Steps to a time, with values of conditions that depend on it.
---
---Errors: those of `step`; `cancelled` where it was interrupted; `convergence` where the step falls below 1e-9 of the time.
---@param options bw.HeatRunOptions how far, and how
---@return bw.HeatSolution? now the state at the end
---@return string? message
---@return bw.Details? details
function HeatTransient:run(options) end

---How far heat is followed.
---@class bw.HeatRunOptions
---@field time number (s) of the end, from the start of the transient. Range: above 0.
---@field step number (s) length of the steps, of the first ones with a tolerance. Range: above 0.
---@field tolerance? number (K) of the error of a step: steps are made longer and shorter by it. The first one or two have no estimate and are taken as they are. Default: none, steps of equal length.
---@field histories? table<integer, bw.History> values by the number of the condition
---@field each? fun(now: bw.HeatSolution) called after each step
