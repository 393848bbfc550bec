---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Responsive analyses
--
-- Analyses in the plane that keep up with an outline while it is dragged.

---Analyses that keep up with an outline while it is dragged. Each call makes an object that holds its
---last good state: a drag that outline, mesh or solution refuses returns nil, message, details, and
---all is as it was before.
---Common options: outline; material and thickness (m; each one, or a list of one for each region);
---plane ("stress", "strain"); gravity ({x, y}, m/s2); elements or size (m; a number, a formula in x and y, or
---a function of them) and order (1, 2) of the
---mesh; follow ({distorted, rebuild, relocation = "harmonic" | "springs", sweeps, level = at least
---this one: "relocation", "reconnecting", "reconstruction"}); solver ({method = "auto" | "iterate" |
---"refactor" | "scratch", tolerance, iterations}).
---conditions = {tag = "fixed"} or {tag = {x = , y = , traction = {x, y}, pressure = }}: displacements
---(m) and loads (Pa; pressure along the inner normal) on the edges with that tag, each a number, a
---formula in x, y and t, or a function of them. Where edges of different tags meet, what one of them
---prescribes holds over what the other leaves free; of two prescribed values the one nearest to 0 (of
---temperatures the middle). conditions = {{tag = ...}, {tag = ...}}, a list of such tables, has an order: later
---entries decide over earlier ones. bw.warnings() names conflicts.
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
---bears the load at the limit.
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

---Linear statics, solved in every drag.
---@param options bw.ResponsiveSteadyOptions
---@return bw.SteadySheet?
---@return string? message
---@return bw.Details? details
function responsive_module.steady(options) end

---@class bw.ResponsiveSteadyOptions
---@field outline bw.Outline
---@field material bw.Material|bw.Material[]
---@field thickness? number|number[]
---@field plane? string
---@field conditions? table
---@field gravity? number[]
---@field elements? integer
---@field size? number|string|function
---@field order? integer
---@field follow? table
---@field solver? table

---Large deflection (St. Venant-Kirchhoff), brought to equilibrium in every drag by Newton's method:
---newton = {tolerance, iterations, load_steps}.
---@param options bw.ResponsiveCantileverOptions
---@return bw.BentSheet?
---@return string? message
---@return bw.Details? details
function responsive_module.cantilever(options) end

---@class bw.ResponsiveCantileverOptions
---@field outline bw.Outline
---@field material bw.Material|bw.Material[]
---@field thickness? number|number[]
---@field plane? string
---@field conditions? table
---@field gravity? number[]
---@field elements? integer
---@field size? number|string|function
---@field order? integer
---@field follow? table
---@field solver? table
---@field newton? table

---Motion on ground that shakes: the tags of `ground` are moved by shake = {x = , y = } (displacements,
---m). Newmark's method: step (s), beta, gamma; damping = {of mass, of stiffness} (Rayleigh).
---@param options bw.ResponsiveVibrationOptions
---@return bw.ShakenSheet?
---@return string? message
---@return bw.Details? details
function responsive_module.vibration(options) end

---@class bw.ResponsiveVibrationOptions
---@field outline bw.Outline
---@field material bw.Material|bw.Material[]
---@field thickness? number|number[]
---@field plane? string
---@field ground? string|string[]
---@field shake? table
---@field step? number
---@field beta? number
---@field gamma? number
---@field damping? number[]
---@field conditions? table
---@field gravity? number[]
---@field elements? integer
---@field size? number|string|function
---@field order? integer
---@field follow? table
---@field solver? table

---Incompressible flow on linear triangles (SUPG, PSPG), implicit in time, at the shape as it is dragged.
---conditions = {tag = "wall"} or {tag = {x = , y = , traction = {x, y}, pressure = }}: velocities (m/s)
---and loads (Pa; the pressure beyond an open end), each a number, a formula in x, y and t, or a function
---of them; fluid leaves freely where there is none. density (kg/m3, default 1), viscosity (Pa s),
---gravity. Mesh: elements or size (m; a number, a formula in x and y, or a function of them), follow.
---Time: step (s), bdf (order: 1 or 2, the default), iterations (of a step; 1), ale (nodes that moved
---carry a velocity; default false). steady = true: every drag finds the steady state anew, to a relative
---change of tolerance (1e-8). solver as of sheets, tolerance 1e-6.
---@param options bw.ResponsiveFlowOptions
---@return bw.Flow?
---@return string? message
---@return bw.Details? details
function responsive_module.flow(options) end

---@class bw.ResponsiveFlowOptions
---@field outline bw.Outline
---@field viscosity number
---@field density? number
---@field conditions? table
---@field gravity? number[]
---@field step? number
---@field steady? boolean
---@field bdf? integer
---@field iterations? integer
---@field tolerance? number
---@field ale? boolean
---@field elements? integer
---@field size? number|string|function
---@field follow? table
---@field solver? table

---Flow with heat that is carried along and lifts (Boussinesq): also diffusivity (m2/s), expansion (1/K),
---reference (temperature without lift, and at the start, K), and in the conditions temperature = ,
---heat_flux = (into the fluid, over density times heat capacity: K m/s), convection = {coefficient = (over the same:
---m/s), temperature = (of what is around)}: coefficient (temperature - T) comes in. Numbers, formulas or functions.
---@param options bw.ResponsiveThermalOptions
---@return bw.ThermalFlow?
---@return string? message
---@return bw.Details? details
function responsive_module.thermal(options) end

---@class bw.ResponsiveThermalOptions
---@field outline bw.Outline
---@field viscosity number
---@field diffusivity number
---@field density? number
---@field expansion? number
---@field reference? number
---@field conditions? table
---@field gravity? number[]
---@field step? number
---@field steady? boolean
---@field bdf? integer
---@field iterations? integer
---@field tolerance? number
---@field ale? boolean
---@field elements? integer
---@field size? number|string|function
---@field follow? table
---@field solver? table

---A bar that rings: the outline extruded to a free plate (Reissner-Mindlin), solved in every drag from the
---last frame's modes and factor. `modes`: how many (default 1); `elements`: default 400, six-node.
---@param options bw.ResponsiveMetallophoneOptions
---@return bw.Metallophone?
---@return string? message
---@return bw.Details? details
function responsive_module.metallophone(options) end

---@class bw.ResponsiveMetallophoneOptions
---@field outline bw.Outline
---@field material bw.Material
---@field thickness number
---@field modes? integer
---@field elements? integer
---@field size? number
---@field tolerance? number
---@field follow? table

---What a frame reused and what it cost. Prints as one line.
---@class bw.Kept
---@field level string "none", "relocation", "reconnecting" or "reconstruction" of the mesh
---@field flips integer edges flipped
---@field quality number of the worst triangle, 1: equilateral
---@field pattern boolean of the matrix: kept
---@field factor boolean a former factor was used
---@field solution boolean the former solution was the first guess
---@field analyses integer
---@field factorisations integer
---@field solves integer
---@field iterations integer
---@field residual number relative, the largest reached
---@field predicted_iterate number s, of the model's machine
---@field predicted_factor number
---@field seconds_mesh number
---@field seconds_assemble number
---@field seconds_factor number
---@field seconds_solve number
