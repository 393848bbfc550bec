---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Solids
--
-- Hyperelastic bodies on grids: static equilibrium at large deformation, transient dynamics, and coarse solids with an
-- estimate of their error.

---@class bw
local bw = {}

---A hyperelastic material, W = mu a(F) + lambda b(F) with the deformation gradient F. Constants outside their ranges raise.
---
---Source: docs/theory/data_driven.md, "Energies", has a and b of each law; docs/theory/elements.md has B-bar.
---```lua
---local rubber = bw.hyperelastic {young = 1e6, poisson = 0.45, density = 1100, name = "rubber"}
---local gel = bw.hyperelastic {law = "corotated", mu = 2e4, lambda = 5e5, formulation = "b_bar"}
---print(rubber, gel.young)
---```
---@param options bw.HyperelasticOptions law and constants
---@return bw.Hyperelastic material the same at all points of an element
function bw.hyperelastic(options) end

---Law and constants of a hyperelastic material: either `young` and `poisson`, or Lame's constants `mu` and `lambda`.
---@class bw.HyperelasticOptions
---@field law? "neo_hookean"|"st_venant_kirchhoff"|"corotated"|"fixed_corotated" the neo-Hookean energy is not defined where det F <= 0, the others are defined everywhere. Default: "neo_hookean"
---@field young? number (Pa) Young's modulus, above 0
---@field poisson? number (-) Poisson's ratio. Range: above -1, below 0.5
---@field mu? number (Pa) shear modulus, above 0
---@field lambda? number (Pa) Lame's first constant; 3 lambda + 2 mu is above 0
---@field density? number (kg/m3) 0: not known; gravity and `transient` need it. Default: 0
---@field name? string for `print`. Default: that of the law
---@field formulation? "standard"|"b_bar" "b_bar": elements do not lock where Poisson's ratio is near 0.5; such a material cannot be made coarse. Default: "standard"

---A hyperelastic material. That of a coarse element has a law and constants of its own at each quadrature point.
---```lua
---local rubber = bw.hyperelastic {young = 1e6, poisson = 0.45}
---local energy, stress = rubber:energy {{1.2, 0, 0}, {0, 0.93, 0}, {0, 0, 0.93}}
---print(energy, stress(1, 1)) -- J/m3 and Pa of a bar that is stretched by a fifth
---```
---@class bw.Hyperelastic
---@field name string as it was given, or that of the law
---@field law "neo_hookean"|"st_venant_kirchhoff"|"corotated"|"fixed_corotated"|"mixed" of the points; "mixed" where they differ
---@field points integer (count) quadrature points
---@field uniform boolean whether law and constants are the same at all points, without fibres
---@field density number (kg/m3) 0: not known
---@field young number (Pa) Young's modulus of the first point
---@field poisson number (-) Poisson's ratio of the first point
---@field formulation "standard"|"b_bar" how the volumetric strain is integrated
---@field mu bw.Array (Pa, points × 1, per point) shear moduli; with "b_bar" twice the modulus at points 1 to 8, 0 at the others
---@field lambda bw.Array (Pa, points × 1, per point) Lame's first constants; with "b_bar" 0 at points 1 to 8, twice the constant at the others
---@field fibre_stiffness bw.Array (Pa, points × fibres, per point) C of each fibre in formula 2 of docs/theory/data_driven.md
---@field fibre bw.Array (-, points × 3 fibres, per point) unit vectors of the fibres, one after the other
local Hyperelastic = {}

---Energy density and first Piola-Kirchhoff stress at a deformation gradient, by the law and constants of the first
---point, without fibres. nil and a message where the neo-Hookean law is not defined.
---@param gradient number[][]|bw.Array (-, 3 × 3) F_ij = dx_i / dX_j
---@return number? energy (J/m3) W
---@return bw.Array|string stress (Pa, 3 × 3) P_ij = dW / dF_ij; or a message
function Hyperelastic:energy(gradient) end

---Releases its memory early, which the garbage collector else does.
function Hyperelastic:close() end

---Materials by number, as a solid or a library has them.
---```lua
---local grid = bw.grid.box {size = {0.04, 0.02, 0.02}, cells = {4, 2, 2}, material = "1 + (x > 0.02)"}
---local solid = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e5, poisson = 0.4},
---  bw.hyperelastic {young = 1e6, poisson = 0.4}}})
---print(solid.materials.count, solid.materials:material(2).young)
---```
---@class bw.MaterialTable
---@field count integer (count) of materials
local MaterialTable = {}

---One material of the table. A number outside of it raises.
---@param number integer (index from 1) as in the grid
---@return bw.Hyperelastic material that elements of this number are made of
function MaterialTable:material(number) end

---Releases its memory early, which the garbage collector else does.
function MaterialTable:close() end

---A body of hyperelastic materials on a grid. An element whose number is not in the table raises.
---
---Errors: memory.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {10, 2, 2}})
---local bar = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e6, poisson = 0.45}}})
---bar:fix({side = "min x"}):force({side = "max x"}, {0, 0, -0.5})
---print(assert(bar:solve()).movement:max())
---```
---@param options bw.SolidOptions the grid and what it is made of
---@return bw.Solid? solid without supports and loads
---@return string? message
---@return bw.Details? details
function bw.solid(options) end

---The grid of a solid and what it is made of.
---@class bw.SolidOptions
---@field grid bw.Grid the elements, with the numbers of their materials
---@field materials bw.Hyperelastic[]|bw.MaterialTable by number: the first is 1

---A solid with its supports and loads. They are kept as they are given, by place, and applied to the nodes that lie there
---on an edited grid and on coarse ones. Node numbers are accepted, too; they bind the solid to its grid. A place that
---chooses no node raises.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {10, 2, 2}})
---local solid = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e6, poisson = 0.45}}})
---solid:fix({side = "min x"}):rotate({side = "max x"}, {axis = {1, 0, 0}, point = {0, 0.01, 0.01}, angle = 60})
---local twisted = assert(solid:solve())
---print(twisted, twisted.von_mises:max())
---```
---@class bw.Solid
---@field grid bw.Grid that it lies on
---@field materials bw.MaterialTable by the numbers of the grid
---@field element_count integer (count) of elements
---@field node_count integer (count) of nodes
---@field mass bw.Array (kg, node_count × 1, per node) lumped mass
---@field levels integer (count) how many times it was made coarse; 0: not
---@field locking string? a warning of volumetric locking and its cure, which a solve reports as well; nil where none is expected
local Solid = {}

---Prescribes displacements of nodes. A contradiction to an earlier support is raised by `solve` and `transient`.
---@param where bw.Region|bw.Surface|string|fun(x: number, y: number, z: number): (boolean|number)|bw.Array|integer[] (index from 1, n × 1) a place, or node numbers
---@param by? (number|false)[]|fun(x: number, y: number, z: number): number, number, number (m) displacement {x, y, z} at full load, where false leaves a component free; or a function of the node's place that returns all three. Default: {0, 0, 0}
---@return bw.Solid self
function Solid:fix(where, by) end

---Prescribes displacements of nodes that turn about an axis, along their arcs.
---@param where bw.Region|bw.Surface|string|fun(x: number, y: number, z: number): (boolean|number)|bw.Array|integer[] (index from 1, n × 1) a place, or node numbers
---@param options bw.SolidRotateOptions axis and angle
---@return bw.Solid self
function Solid:rotate(where, options) end

---How nodes turn about an axis.
---@class bw.SolidRotateOptions
---@field axis bw.Vector (-) direction of the axis, of any length but 0
---@field point? bw.Vector (m) on the axis. Default: {0, 0, 0}
---@field angle number (degrees) right-handed about the axis
---@field move? bw.Vector (m) a translation beside. Default: {0, 0, 0}

---Applies a total force to the boundary faces all of whose nodes are chosen, by area; where there is no such face, to the
---nodes in equal parts.
---@param where bw.Region|bw.Surface|string|fun(x: number, y: number, z: number): (boolean|number)|bw.Array|integer[] (index from 1, n × 1) a place, or node numbers
---@param total bw.Vector (N) the sum
---@return bw.Solid self
function Solid:force(where, total) end

---Applies gravity to all elements, which need a density. A later call replaces the acceleration.
---@param acceleration bw.Vector (m/s2) such as {0, 0, -9.81}
---@return bw.Solid self
function Solid:gravity(acceleration) end

---Applies pressure to the free faces of elements all of whose nodes are chosen, or to a surface that is embedded in the
---solid.
---@param on bw.Region|bw.Surface|string|fun(x: number, y: number, z: number): (boolean|number)|bw.Array|integer[] (index from 1, n × 1) a place, node numbers, or a surface whose triangles are loaded
---@param options bw.SolidPressureOptions how large the pressure is
---@return bw.Solid self
function Solid:pressure(on, options) end

---How large a pressure on a solid is.
---@class bw.SolidPressureOptions
---@field pressure number|fun(x: number, y: number, z: number): number|number[]|bw.Array (Pa, n × 1, per triangle) positive pushes inwards; a function takes the middle of a face or triangle at rest; a list needs a surface
---@field follower? boolean along the normals of the deformed shape; else of the shape at rest. Default: false

---Adds a rigid contact plane without friction, which the nodes or the points of a surface may touch and not pass.
---@param options bw.SolidContactPlaneOptions where it is
---@return bw.Solid self
function Solid:contact_plane(options) end

---A rigid contact plane.
---@class bw.SolidContactPlaneOptions
---@field point bw.Vector (m) on the plane
---@field normal bw.Vector (-) towards the side of the solid, of any length but 0
---@field move? bw.Vector (m) displacement of the plane at full load. Default: {0, 0, 0}
---@field surface? bw.Surface that touches the plane; it is embedded in the solid. Default: the nodes do

---The stable equilibrium at full load, by Newton's method with line search. Loads, prescribed displacements and contact
---planes grow together from rest. A load step that fails is halved.
---
---A solid made coarse by a library is compared with the naive coarse one: both are solved, the errors of both are
---estimated, and the result is the one with the smaller estimate (`choice`). This takes two to four times as long as
---`choose = false`.
---
---Errors: convergence (a load step finds no equilibrium, as where the load is more than the solid carries), geometry
---(elements are inverted), unconstrained (a part can move as a rigid body), memory, cancelled. Where a load path failed on
---its way, the details have `reached`, the last equilibrium (a bw.SolidResult), and `load`, its load factor.
---
---Source: docs/theory/data_driven.md, "Equilibrium".
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {10, 2, 2}})
---local bar = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e6, poisson = 0.45}}})
---bar:fix({side = "min x"}):force({side = "max x"}, {0, 0, -2})
---local result = assert(bar:solve {steps = 2, solver = bw.solver.cholesky()})
---print(result.report, result.newton.shape.min_ratio)
---```
---@param options? bw.SolidSolveOptions tolerance, load steps and linear solver
---@return bw.SolidResult? result the equilibrium
---@return string? message
---@return bw.Details? details
function Solid:solve(options) end

---Tolerance, load steps and linear solver of an equilibrium.
---@class bw.SolidSolveOptions
---@field tolerance? number (-) norm of the residual over the sum of the norms of applied forces, reactions and contact forces. Range: above 0, below 1. Default: 1e-6
---@field iterations? integer (count) Newton iterations in a load step. Range: at least 1. Default: 100
---@field max_iterations? integer (count) Newton iterations in all load steps, failed ones included; every 100 iterations of conjugate gradients count as one more. Range: at least 1; 0: the default. Default: 500, and 20 for each of `steps` beyond the first
---@field steps? integer (count) load steps to begin with. Range: at least 1. Default: 1
---@field min_step? number (-) a load step of this part of the load that fails ends the solution. Range: above 0 to 1. Default: 1/256
---@field path? integer (count) parts of the load path that are solved one after the other; turns go along their arcs from part to part. Range: 1 to 1000. Default: 1; with turns, one for each 30 degrees
---@field solver? bw.Solver|"auto" of the linear equations: `bw.solver.cholesky`, a factor by the backend "multifrontal" in double precision; `bw.solver.pcg` with `jacobi`, conjugate gradients without a matrix with node blocks, or with `two_level`, with a smoother and a coarse solid. The tolerance of `pcg` is by Eisenstat and Walker where it is left out, its iterations are at most 10000. Default: "auto", the cheaper of a factor and `two_level` by counted costs
---@field coarse? bw.Solid made coarse once from this solid, for `two_level`. Default: naive coarse solids
---@field allow_inverted? boolean accept an equilibrium with inverted elements. Default: false
---@field start? bw.Array|number[][] (m, node_count × 3, per node) initial guess; the loads then act in full from the start. Default: rest
---@field choose? boolean compare a solid made coarse by a library with the naive one. Default: true

---The solid in transient dynamics, its loads in full from the start. Prescribed displacements are at their full values.
---
---Errors: geometry (elements of the initial shape are inverted), memory, cancelled.
---
---Source: docs/theory/data_driven.md, "Time".
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {10, 2, 2}})
---local rubber = bw.hyperelastic {young = 1e6, poisson = 0.45, density = 1100}
---local bar = assert(bw.solid {grid = grid, materials = {rubber}}):fix({side = "min x"}):gravity {0, 0, -9.81}
---local motion = assert(bar:transient {scheme = "newmark", step = 2e-3, mass_damping = 1})
---print(assert(motion:step(10)).displacement:column(3):min())
---```
---@param options? bw.SolidTransientOptions scheme, time step and initial values
---@return bw.SolidTransient? motion at time 0
---@return string? message
---@return bw.Details? details
function Solid:transient(options) end

---Scheme, time step and initial values of a transient solid.
---@class bw.SolidTransientOptions
---@field scheme? "implicit_euler"|"newmark" Newmark's scheme keeps the energy, implicit Euler dissipates some in each step. Default: "implicit_euler"
---@field step? number (s) time step, above 0. Default: 0.01
---@field mass_damping? number (1/s) Rayleigh damping by the mass matrix. Range: at least 0. Default: 0
---@field stiffness_damping? number (s) Rayleigh damping by the stiffness matrix at the start of the step. Range: at least 0. Default: 0
---@field beta? number (-) of Newmark's scheme. Range: gamma / 2 to 2. Default: 0.25
---@field gamma? number (-) of Newmark's scheme. Range: 0.5 to 2. Default: 0.5
---@field tolerance? number (-) as of `solve`. Range: above 0, below 1. Default: 1e-6
---@field iterations? integer (count) Newton iterations in a time step; 1: linearly implicit. Range: at least 1. Default: 30
---@field allow_inverted? boolean accept steps with inverted elements. Default: false
---@field solver? bw.Solver|"auto" of the linear equations: `bw.solver.cholesky`; or, for large solids, `bw.solver.pcg` with `jacobi`, without `tolerance` and `max_iterations`, which follow from the step. Default: "auto", a factor
---@field displacement? bw.Array|number[][] (m, node_count × 3, per node) initial displacements. Default: 0
---@field velocity? bw.Array|number[][] (m/s, node_count × 3, per node) initial velocities. Default: 0

---The same solid on an edited grid. A coarse solid takes its fine grid, edited, and looks up again only the elements that
---differ. A grid on another lattice raises.
---
---Errors: memory, cancelled.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}})
---local bar = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e6, poisson = 0.45}}})
---bar:fix({side = "min x"}):force({side = "max x"}, {0, 0, -0.5})
---local hole = assert(grid:set({centre = {0.05, 0.01, 0.01}, radius = 0.006}, 0))
---print(assert(assert(bar:with(hole)):solve()).movement:max())
---```
---@param grid bw.Grid the edited one
---@return bw.Solid? solid with the same supports and loads
---@return string? message
---@return bw.Details? details
function Solid:with(grid) end

---The solid on a grid made coarse: 2 × 2 × 2 cells become one, with a material that stands for them. "naive": each
---point takes the material of the fine element there; "average": means of their constants. A library can be worse than
---"naive" where its blocks do not behave as they were sampled, as with straight stiff rods or prescribed displacements:
---`solve` chooses between the two, `transient` takes the library.
---
---Materials that differ from point to point or are B-bar raise, as do a coarse solid and another library's materials.
---
---Errors: memory, cancelled.
---
---Source: docs/theory/data_driven.md, "Coarsening by lookup"; D. Chen, D. I. W. Levin, S. Sueda, W. Matusik, Data-driven
---finite elements for geometry and material design, ACM Trans. Graph. 34 (2015), section 4.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}, material = "1 + (z > 0.01)"})
---local soft, stiff = bw.hyperelastic {young = 1e5, poisson = 0.4}, bw.hyperelastic {young = 1e6, poisson = 0.4}
---local fine = assert(bw.solid {grid = grid, materials = {soft, stiff}}):fix {side = "min x"}
---local coarse = assert(fine:force({side = "max x"}, {0, 0, -0.02}):coarsen "naive")
---print(coarse, assert(coarse:solve()):error(assert(fine:solve())))
---```
---@param by bw.Library|"naive"|"average" what the materials come from
---@param levels? integer (count) how many times. Range: 1 to 2, and at most the levels of the library. Default: 1
---@return bw.Solid? coarse with the same supports and loads
---@return string? message
---@return bw.Details? details
function Solid:coarsen(by, levels) end

---`coarsen` by a library and `solve` in one.
---
---Errors: as of `coarsen` and `solve`.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}, material = "1 + (z > 0.01)"})
---local soft, stiff = bw.hyperelastic {young = 1e5, poisson = 0.4}, bw.hyperelastic {young = 1e6, poisson = 0.4}
---local fine = assert(bw.solid {grid = grid, materials = {soft, stiff}}):fix {side = "min x"}
---fine:force({side = "max x"}, {0, 0, -0.02})
---local result, choice = fine:solve_coarse {by = assert(bw.metamaterial.grow({soft, stiff}, grid))}
---print(choice.chosen, result.estimated_error)
---```
---@param options bw.SolidSolveCoarseOptions the library, and options of `solve`
---@return bw.SolidResult? result the equilibrium of the coarse solid
---@return bw.CoarseChoice|string|nil choice which coarse solid it is of, nil with `choose = false`; or a message
---@return bw.Details? details
function Solid:solve_coarse(options) end

---The library that a solid is made coarse by, and options of its equilibrium.
---@class bw.SolidSolveCoarseOptions: bw.SolidSolveOptions
---@field by bw.Library what the materials come from
---@field levels? integer (count) how many times. Range: 1 to 2. Default: 1

---Which of two coarse solids was chosen, by the smaller estimated error (`estimate_error`).
---@class bw.CoarseChoice
---@field chosen "library"|"naive" of which the result is
---@field library number? (-) estimated error of the library's; nil where it has no equilibrium or no estimate
---@field naive number? (-) estimated error of the naive one; nil likewise
---@field message string? why one of them has no estimate
---@field details bw.Details? of this failure

---The equilibrium of a solid. Fields are computed when they are first asked for, and kept.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {10, 2, 2}})
---local bar = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e6, poisson = 0.45}}})
---local result = assert(bar:fix({side = "min x"}):force({side = "max x"}, {0, 0, -0.5}):solve())
---print(result.energy, result:total_reaction({side = "min x"})[3])
---assert(result:picture("bent.png", {values = "von_mises", width = 400, height = 300}))
---```
---@class bw.SolidResult
---@field solid bw.Solid that it is of
---@field grid bw.Grid of the solid
---@field displacement bw.Array (m, node_count × 3, per node) displacements
---@field reaction bw.Array (N, node_count × 3, per node) of supports and contact planes
---@field energy number (J) strain energy
---@field complete boolean whether the full load was reached
---@field newton bw.NewtonReport iterations, residual and times of Newton's method, summed over the parts of the load path
---@field report bw.SolverReport how the linear equations were solved, and why; summed likewise
---@field stress bw.Array (Pa, node_count × 6, per node) Cauchy stress xx yy zz yz zx xy
---@field element_stress bw.Array (Pa, element_count × 6, per element) Cauchy stress, mean over the deformed volume
---@field von_mises bw.Array (Pa, node_count × 1, per node) of `stress`
---@field movement bw.Array (m, node_count × 1, per node) length of the displacement
---@field fine_displacement bw.Array (m, n × 3, per node of the fine grid) of a coarse solid, interpolated; else `displacement`
---@field estimated_error number? (-) first number of `estimate_error`; nil where there is none
---@field choice bw.CoarseChoice? of a solid made coarse by a library: which one `solve` chose; else nil
local SolidResult = {}

---What Newton's method did.
---@class bw.NewtonReport
---@field iterations integer (count) Newton iterations
---@field load_steps integer (count) load steps that reached an equilibrium
---@field failed_steps integer (count) load steps that failed and were made smaller
---@field factorisations integer (count) of the tangent stiffness
---@field analyses integer (count) symbolic analyses; 0 where that of an earlier solve was reused
---@field evaluations integer (count) of energy and forces
---@field cg_iterations integer (count) of conjugate gradients
---@field stability_iterations integer (count) of conjugate gradients that test whether an equilibrium is stable
---@field undecided integer (count) load steps for which this test ended without an answer
---@field contacts integer (count) points on contact planes
---@field load number (-) load factor that was reached; 1: full load
---@field residual number (-) of the last equilibrium, as `tolerance` measures it
---@field seconds_quadrature number (s) energies, forces and stiffnesses of elements
---@field seconds_analysis number (s) symbolic analyses
---@field seconds_factor number (s) factorisations
---@field seconds_solve number (s) solutions of the linear equations
---@field seconds number (s) in all
---@field shape bw.SolidShape how far elements are deformed
---@field history bw.SolidIteration[] (list) one entry for each Newton iteration of the last part of the load path

---How far the elements of a solid are deformed.
---@class bw.SolidShape
---@field min_ratio number (-) the smallest det F of all points
---@field worst_element integer (index from 1) the element that has it
---@field inverted integer (count) elements with a point where det F <= 0
---@field defined boolean whether the energy exists

---One Newton iteration.
---@class bw.SolidIteration
---@field load number (-) load factor
---@field energy number (J) strain energy after it
---@field residual number (-) before the iteration, as `tolerance` measures it
---@field step number (-) accepted step length of the line search
---@field cg_iterations integer (count) of conjugate gradients
---@field contacts integer (count) points on contact planes
---@field projected boolean whether the tangent stiffness was made positive definite

---Mean distance of the fine grid's nodes from those of a reference on the same fine grid.
---
---Source: D. Chen and others 2015, section 6.2.
---@param reference bw.SolidResult of the fine solid, or of another coarse one
---@return number relative (-) to the mean displacement of the reference; 1: as wrong as no displacement; math.huge where the reference does not move
---@return number of_size (-) relative to the longest side of the body
function SolidResult:error(reference) end

---An estimate of `error` of a coarse result, without the fine solution. Two Newton steps of the fine solid with eight
---iterations of conjugate gradients each, from the coarse displacements, show about how far the fine solution is
---away. It is no bound: errors that take many iterations are underestimated.
---
---Errors: unsupported (the result is of a fine solid, or a material is B-bar), geometry (fine elements are inverted),
---memory, cancelled.
---
---Source: docs/theory/data_driven.md, "The error of a coarse solution".
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}, material = "1 + (z > 0.01)"})
---local soft, stiff = bw.hyperelastic {young = 1e5, poisson = 0.4}, bw.hyperelastic {young = 1e6, poisson = 0.4}
---local fine = assert(bw.solid {grid = grid, materials = {soft, stiff}}):fix {side = "min x"}
---local coarse = assert(fine:force({side = "max x"}, {0, 0, -0.02}):coarsen "naive")
---print(assert(coarse:solve()):estimate_error())
---```
---@return number? relative (-) to the mean displacement
---@return number|string of_size (-) relative to the longest side of the body; or a message
---@return bw.Array|bw.Details corrected (m, n × 3, per node of the fine grid) displacements after the steps, nearer to the fine solution; or details
function SolidResult:estimate_error() end

---The sum of the reactions of nodes.
---@param where bw.Region|bw.Surface|string|fun(x: number, y: number, z: number): (boolean|number) their place
---@return bw.Vector reaction (N) the sum
function SolidResult:total_reaction(where) end

---Writes a .vtu file of hexahedra with displacement, reaction and stresses, for ParaView.
---
---Errors: io (the file cannot be written), memory.
---@param path string of a .vtu file
---@return true? written true
---@return string? message
---@return bw.Details? details
function SolidResult:write(path) end

---Draws the deformed grid as a PNG file.
---
---Errors: io (the file cannot be written), memory.
---@param path string of the PNG file
---@param options? bw.SolidPictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function SolidResult:picture(path, options) end

---How the deformed grid of a solid is drawn.
---@class bw.SolidPictureOptions: bw.GridOnePictureOptions
---@field values? "von_mises"|"movement"|bw.Array|number[] (any, n × 1, per node or per element) what colours it. Default: the materials
---@field displacement? bw.Array|number[][] (m, n × 3, per node) how the grid is deformed. Default: that of the result

---A panel of `bw.grid.picture`, which draws several side by side.
---@param title? string a line above. Default: none
---@param values? "von_mises"|"movement"|bw.Array (any, n × 1, per node or per element) what colours it. Default: the materials
---@return bw.GridPanel panel the deformed grid
function SolidResult:panel(title, values) end

---A solid in transient dynamics. Each field is a copy of its moment.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {10, 2, 2}})
---local rubber = bw.hyperelastic {young = 1e6, poisson = 0.45, density = 1100}
---local bar = assert(bw.solid {grid = grid, materials = {rubber}}):fix({side = "min x"}):gravity {0, 0, -9.81}
---local motion = assert(bar:transient {step = 2e-3})
---for _ = 1, 3 do assert(motion:step(5)) end
---print(motion, motion.kinetic + motion.strain + motion.potential + motion.dissipated)
---```
---@class bw.SolidTransient
---@field time number (s) since the start
---@field steps integer (count) time steps so far
---@field displacement bw.Array (m, node_count × 3, per node) displacements
---@field velocity bw.Array (m/s, node_count × 3, per node) velocities
---@field acceleration bw.Array (m/s2, node_count × 3, per node) accelerations; of Newmark's scheme without contact forces
---@field kinetic number (J) kinetic energy
---@field strain number (J) strain energy
---@field potential number (J) potential of gravity and of loads that do not follow
---@field dissipated number (J) by damping, contact planes and the scheme; the sum of all four changes by the work of followers only
---@field newton bw.NewtonReport of the last step
---@field report bw.SolverReport? of its linear equations; nil before the first step
local SolidTransient = {}

---Advances in time. On failure the motion is as it was before the call.
---
---Errors: convergence (a step finds no solution), geometry (it has inverted elements), memory, cancelled. Details have
---`time`, `step`, `residual`, `element` and its place `x`, `y`, `z`.
---@param count? integer (count) time steps. Range: at least 0. Default: 1
---@return bw.SolidTransient? self
---@return string? message
---@return bw.Details? details
function SolidTransient:step(count) end

---Checks that its parts belong together, for tests and debugging. Raises where they do not.
---@return bw.SolidTransient self
function SolidTransient:check() end

---Releases its memory early, which the garbage collector else does.
function SolidTransient:close() end
