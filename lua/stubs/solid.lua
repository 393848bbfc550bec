---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Solids
--
-- Hyperelastic bodies on grids: large deformation, statics and motion.

---@class bw
local bw = {}

---A law of large deformation, W = mu a(F) + lambda b(F) J/m3: "neo_hookean" (the default; not defined
---where an element is turned inside out), "st_venant_kirchhoff", "corotated", "fixed_corotated". Either
---`young` (Pa) and `poisson`, or Lame's constants `mu` and `lambda` (Pa); `density` in kg/m3. With
---`formulation` = "b_bar" (default "standard") elements do not lock where Poisson's ratio is near 0.5; such a
---material cannot be made coarse.
---@param options bw.HyperelasticOptions
---@return bw.Hyperelastic
function bw.hyperelastic(options) end

---@class bw.HyperelasticOptions
---@field law? string
---@field young? number
---@field poisson? number
---@field mu? number
---@field lambda? number
---@field density? number
---@field name? string
---@field formulation? "standard"|"b_bar"

---@class bw.Hyperelastic
---@field name string
---@field law string of its points; "mixed" where they differ
---@field points integer points of quadrature with constants of their own
---@field uniform boolean the same everywhere, without fibres
---@field density number kg/m3; 0: not known
---@field young number of the first point, Pa
---@field poisson number of the first point
---@field formulation string "standard" or "b_bar"
---@field mu bw.Array of points, Pa
---@field lambda bw.Array of points, Pa
---@field fibre_stiffness bw.Array of points: C of each fibre, Pa (data-driven, formula 2)
---@field fibre bw.Array of points: directions of the fibres, three numbers each
local Hyperelastic = {}

---Energy density and first Piola-Kirchhoff stress at a deformation gradient, of the first point's law.
---@param gradient number[][] 3 x 3
---@return number? energy J/m3
---@return bw.Array|string stress Pa, 3 x 3
function Hyperelastic:energy(gradient) end

---Releases it early.
function Hyperelastic:close() end

---Materials by number, as a solid or a library has them.
---@class bw.MaterialTable
---@field count integer
local MaterialTable = {}

---@param number integer
---@return bw.Hyperelastic
function MaterialTable:material(number) end

---Releases it early.
function MaterialTable:close() end

---A body of hyperelastic materials on a grid; the grid's numbers are places in the palette.
---@param options bw.SolidOptions
---@return bw.Solid?
---@return string? message
---@return bw.Details? details
function bw.solid(options) end

---@class bw.SolidOptions
---@field grid bw.Grid
---@field materials bw.Hyperelastic[]|bw.MaterialTable

---A solid with its supports and loads. They are kept as they are given, by place (see bw.Region), and
---found again on an edited grid and on coarse ones. Nodes may be given by number too, which binds them
---to the grid.
---@class bw.Solid
---@field grid bw.Grid
---@field materials bw.MaterialTable
---@field element_count integer
---@field node_count integer
---@field mass bw.Array of nodes, kg
---@field levels integer how many times it was made coarse
---@field locking string? a warning of volumetric locking and its cure, or nil; a solve reports it as well
local Solid = {}

---Holds nodes; or moves them by {x, y, z} (m), where false leaves a component free; or by a function of
---x, y, z that returns three numbers.
---@param where bw.Region|function|string|bw.Array|integer[]
---@param by? table|function
---@return bw.Solid
function Solid:fix(where, by) end

---Holds nodes and turns them about an axis by `angle` (degrees, right-handed), along their arcs; `move` (m)
---shifts them too.
---@param where bw.Region|function|string|bw.Array|integer[]
---@param options bw.SolidTurnOptions
---@return bw.Solid
function Solid:turn(where, options) end

---@class bw.SolidTurnOptions
---@field axis bw.Vector
---@field point? bw.Vector
---@field angle number
---@field move? bw.Vector

---A total force (N) on the boundary faces of nodes, by area; on the nodes alike where they have none.
---@param where bw.Region|function|string|bw.Array|integer[]
---@param total bw.Vector
---@return bw.Solid
function Solid:force(where, total) end

---@param acceleration bw.Vector m/s2
---@return bw.Solid
function Solid:gravity(acceleration) end

---Pressure (Pa, positive pushes inwards) on the free faces of cells all of whose nodes are in a region,
---or on a surface that is embedded in the solid: a number, a function of x, y, z (of a face's or
---triangle's middle), or for a surface a list with one for each triangle. `follower`: along the normals
---as they turn.
---@param on bw.Region|function|string|bw.Array|integer[]|bw.Surface
---@param options bw.SolidPressureOptions
---@return bw.Solid
function Solid:pressure(on, options) end

---@class bw.SolidPressureOptions
---@field pressure number|table|function|bw.Array
---@field follower? boolean

---A plane that the solid's nodes, or the points of a `surface`, may touch and not pass, without
---friction. `normal` points to the solid's side; `move`: its displacement at full load.
---@param options bw.SolidFloorOptions
---@return bw.Solid
function Solid:contact_plane(options) end

---@class bw.SolidFloorOptions
---@field point bw.Vector
---@field normal bw.Vector
---@field move? bw.Vector
---@field surface? bw.Surface

---Equilibrium by Newton's method, from rest. `path`: parts of the way that are solved one after the
---other (turns: of at most 30 degrees); `steps`: load steps to begin with; `linear`: "direct",
---"jacobi", or "coarse": conjugate gradients over a coarse solid, `coarse` or those that are made. By
---default a factor ("direct") or the last, whichever costs less by counted operations and bytes and the
---iterations that were needed so far. Loads that are more than the solid carries end in a failure that
---says how far it came: details.reached is the last equilibrium on the way. The work until then is
---bounded: `iterations` in a load step (100), `max_iterations` in all of them, where 100 of conjugate
---gradients count as one more (500, and 20 for each of `steps` beyond the first), load steps no smaller
---than `min_step` (1/256). A solid made coarse by a library is compared with the naive coarse one (`choose`, default
---true): both are solved, the errors of both are estimated, and the result is that of the nearer one, which its
---`choice` tells. This takes two to four times as long as `choose = false`.
---@param options? bw.SolidSolveOptions
---@return bw.SolidResult?
---@return string? message
---@return bw.Details? details
function Solid:solve(options) end

---@class bw.SolidSolveOptions
---@field tolerance? number
---@field iterations? integer
---@field max_iterations? integer
---@field steps? integer
---@field min_step? number
---@field path? integer
---@field linear? string
---@field coarse? bw.Solid
---@field cg_tolerance? number
---@field cg_iterations? integer
---@field allow_inverted? boolean
---@field start? bw.Array
---@field choose? boolean

---The solid in motion, its loads at full. `scheme`: "implicit_euler" or "newmark"; `step` in s;
---Rayleigh damping `mass_damping` (1/s) and `stiffness_damping` (s); `iterations` 1: linearly implicit;
---`linear`: "direct" or, for large solids, "jacobi".
---@param options bw.SolidMotionOptions
---@return bw.SolidMotion?
---@return string? message
---@return bw.Details? details
function Solid:motion(options) end

---@class bw.SolidMotionOptions
---@field scheme? string
---@field step number
---@field mass_damping? number
---@field stiffness_damping? number
---@field beta? number
---@field gamma? number
---@field tolerance? number
---@field iterations? integer
---@field allow_inverted? boolean
---@field linear? string
---@field displacement? bw.Array
---@field velocity? bw.Array

---The same solid on an edited grid. A coarse solid takes its fine grid, edited, and looks up again only
---what differs.
---@param grid bw.Grid
---@return bw.Solid?
---@return string? message
---@return bw.Details? details
function Solid:with(grid) end

---The solid made coarse `levels` times (1): by a library's lookup; or "naive" (points take the material
---of the fine element there), or "average" (constants averaged), for comparison. What a library does not resolve
---(straight stiff rods, displacements that are imposed) it can make worse than "naive": so `solve` chooses between
---the two, while `motion` takes the library as it is.
---@param by bw.Library|"naive"|"average"
---@param levels? integer
---@return bw.Solid?
---@return string? message
---@return bw.Details? details
function Solid:coarsen(by, levels) end

---`coarsen` and `solve` in one: options as of `solve`, with `by` and `levels` as of `coarsen`. Beside the result its
---`choice`. Example:
---`local result, how = fine:solve_coarse {by = library}; print(how.chosen, result.estimated_error)`.
---@param options bw.SolidSolveCoarseOptions
---@return bw.SolidResult?
---@return table|string how
---@return bw.Details? details
function Solid:solve_coarse(options) end

---@class bw.SolidSolveCoarseOptions
---@field by bw.Library
---@field levels? integer
---@field tolerance? number
---@field iterations? integer
---@field max_iterations? integer
---@field steps? integer
---@field min_step? number
---@field path? integer
---@field linear? string
---@field cg_tolerance? number
---@field cg_iterations? integer
---@field allow_inverted? boolean

---What a coarse solid's `solve` chose by the estimated errors of both, relative to the displacement (nil where there
---is no equilibrium or no estimate, then with `message` and `details` of why).
---@class bw.CoarseChoice
---@field chosen "library"|"naive"
---@field library number?
---@field naive number?
---@field message string?
---@field details table?

---@class bw.SolidResult
---@field solid bw.Solid
---@field grid bw.Grid
---@field displacement bw.Array of nodes, m
---@field reaction bw.Array of supports and floors at nodes, N
---@field energy number stored, J
---@field complete boolean full load was reached
---@field report table iterations, cg_iterations, stability_iterations, load_steps, analyses (0 where those of an earlier solve were kept), undecided (of these: stability was not found out), residual, seconds, seconds_factor, shape, history, ...
---@field stress bw.Array Cauchy stress at nodes, Pa
---@field element_stress bw.Array
---@field von_mises bw.Array at nodes, Pa
---@field movement bw.Array of nodes: how far each went, m
---@field fine_displacement bw.Array of a coarse solid: at the nodes of its fine grid
---@field estimated_error number? of a coarse solid: the first number of `estimate_error`, kept
---@field choice bw.CoarseChoice? of a solid made coarse by a library: what `solve` chose
local SolidResult = {}

---Mean distance of the fine grid's nodes from those of a reference on the same fine grid: over the mean
---displacement of the reference (1: as wrong as no displacement at all; math.huge where the reference does not
---move), and over the longest side of the body. Example: `local relative, of_size = coarse:error(fine)`.
---@param reference bw.SolidResult
---@return number relative to the displacement
---@return number of_size relative to the longest side of the body
function SolidResult:error(reference) end

---About what `error` says of a coarse result against the fine solution, without that: two Newton steps of the
---fine solid with eight iterations of conjugate gradients each show how far away it is. The last value is
---where they lead, nearer to the fine solution. Only coarse results have it. Example:
---`print(coarse:solve():estimate_error())`.
---@return number? relative to the displacement
---@return number|string of_size relative to the longest side of the body
---@return bw.Array|table corrected displacements at the nodes of the fine grid, m
function SolidResult:estimate_error() end

---The sum of the reactions at nodes.
---@param where bw.Region|function|string
---@return number[]
function SolidResult:total_reaction(where) end

---A .vtu file of hexahedra with displacement, reaction and stresses.
---@param path string
---@return boolean?
---@return string? message
---@return bw.Details? details
function SolidResult:write(path) end

---The deformed grid, as Grid:picture; `values` may be "von_mises" or "movement" too.
---@param path string
---@param options? table
---@return boolean?
---@return string? message
---@return bw.Details? details
function SolidResult:picture(path, options) end

---A panel of bw.grid.picture, to be beside others.
---@param title? string
---@param values? "von_mises"|"movement"|bw.Array
---@return table
function SolidResult:panel(title, values) end

---@class bw.SolidMotion
---@field time number s
---@field steps integer
---@field displacement bw.Array m
---@field velocity bw.Array m/s
---@field acceleration bw.Array m/s2
---@field kinetic number J
---@field strain number J
---@field potential number of loads and gravity, J
---@field dissipated number by damping and the scheme, J
---@field report table of the last step, as of SolidResult
local SolidMotion = {}

---@param count? integer
---@return bw.SolidMotion?
---@return string? message
---@return bw.Details? details
function SolidMotion:step(count) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return bw.SolidMotion
function SolidMotion:check() end

---Releases it early.
function SolidMotion:close() end
