---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Worst loads
--
-- The steps of `bw.worst_case` by themselves: weak regions of modes, pressures, linear programs. Equations and sections are those
-- of Zhou, Panetta and Zorin 2013; docs/theory/worst_case.md has them.

---@class bw
local bw = {}

---The weak regions of modes: connected elements in which a mode has a large stress or energy.
---
---Errors: unsupported (modes of the Laplacian with the target displacement).
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local modes = assert(bw.model({mesh = mesh, material = bw.material.pla}):modes {count = 3})
---local regions = assert(bw.weak_regions(mesh, bw.material.pla, modes))
---print(regions, regions[1].volume)
---```
---@param mesh bw.Mesh the mesh
---@param material bw.Material the material
---@param modes bw.Modes of the mesh, elastic or of the Laplacian
---@param options? bw.WeakRegionsOptions what counts as weak
---@return bw.WeakRegions? regions of all modes
---@return string? message
---@return bw.Details? details
function bw.weak_regions(mesh, material, modes, options) end

---What counts as a weak region.
---@class bw.WeakRegionsOptions
---@field measure? "stress"|"energy" which field is thresholded. Default: "stress"
---@field target? "stress"|"displacement" what the worst load of a region makes largest. Default: "stress"
---@field fraction? number (-) of the volume that counts as weak in a mode. Range: 0 to 1. Default: 0.025
---@field regions? integer (count) of each mode at most. Range: 1 to 100000. Default: 5

---Elements as regions of their own.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---print(bw.single_regions(mesh, {1, 5, 9}).count) -- 3
---```
---@param mesh bw.Mesh the mesh
---@param elements? bw.Array|integer[] (index from 1, n × 1) the elements. Default: all
---@param sign? number (-) weight of each. Default: 1
---@return bw.WeakRegions regions one for each element
function bw.single_regions(mesh, elements, sign) end

---Pressures on the boundary: at the corner nodes of facets, linear over the facets; or with a spacing constant on cells of facets.
---With friction each pressure has several columns, which pull the surface along in as many directions; the pressure is their sum.
---Where no surface is left it raises.
---
---Errors: unsupported (the spacing makes too many cells).
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local basis = assert(bw.pressure_basis(mesh, {forbidden = mesh.boundary:below("x", 0)}))
---print(basis.count, basis.areas:sum())
---```
---@param mesh bw.Mesh the mesh
---@param options? bw.PressureBasisOptions where and how pressure acts
---@return bw.PressureBasis? basis the pressures
---@return string? message
---@return bw.Details? details
function bw.pressure_basis(mesh, options) end

---Where and how pressure acts.
---@class bw.PressureBasisOptions
---@field forbidden? bw.Selection facets without pressure; that at corner nodes falls to zero around them. Default: none
---@field cuts? bw.Selection facets that are no surface, such as what a bond covers: without pressure, and that at nodes around them acts on the other facets there. Default: none
---@field spacing? number (m) longest edge of cells, not below a sixteenth of the facet's. Default: 0, pressures at nodes
---@field friction? number (-) Coulomb's coefficient of friction. Range: 0 to 100. Default: 0
---@field friction_facets? integer (count) columns of each pressure with friction. Range: 3 to 64. Default: 8

---The worst admissible load of every region, and the stresses under it.
---
---Errors: infeasible (no load within the limits is in balance; `details.largest_force`, in N), unsupported (a support prescribes a
---displacement that is not zero), convergence (a linear program found no optimum).
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local basis, regions = assert(bw.pressure_basis(mesh)), bw.single_regions(mesh, {100, 120})
---local loads = assert(bw.worst_loads(assert(part:system()), basis, regions, {pressure = 2e5, force = 20}))
---print(loads.peaks[1], loads.pressures.column_count)
---```
---@param system bw.System the equations of the part
---@param basis bw.PressureBasis of the same mesh
---@param regions bw.WeakRegions of the same mesh
---@param options bw.WorstLoadsOptions the limits
---@return bw.WorstLoads? loads what was found
---@return string? message
---@return bw.Details? details
function bw.worst_loads(system, basis, regions, options) end

---The limits of admissible loads, and how the linear programs are solved.
---@class bw.WorstLoadsOptions
---@field pressure number (Pa) largest pressure
---@field force number (N) total force
---@field force_is_max? boolean the total force may also be smaller. Default: false
---@field hands? integer (count) the pressure lies within so many patches. Default: 0, anywhere
---@field hand_area? number (m2) with `hands`: area of each
---@field one_sign? boolean try only the sign of the weights. Default: false, both
---@field other_sign? boolean with `one_sign`: try only the opposite sign instead. Default: false
---@field contact? bw.ContactSystem judge the loads by the solution with contact, in place of that of the system. Default: none
---@field given? bw.Array (Pa, regions × columns of the basis, per region) loads in place of those that linear programs find. Default: none
---@field batch? integer (count) regions that are worked on at once. Default: 0, chosen
---@field keep_pressures? boolean keep `pressures`. Default: true
---@field lp? bw.LpSolver|"auto" what solves the linear programs. Default: "auto", by counted cost
---@field after? bw.WorstLoads of an earlier call on the same mesh, whose regions come first in what is returned. Default: none

---The worst loads of regions. n is the number of regions.
---@class bw.WorstLoads
---@field peaks bw.Array (Pa, n × 1, per region) largest principal stress under the load
---@field peak_elements bw.Array (index from 1, n × 1, per region) the element with it
---@field peak_stresses bw.Array (Pa, n × 6, per region) the tensor in it
---@field first_stresses bw.Array (Pa, n × 6, per region) the tensor in the region's first element
---@field utilisations bw.Array (-, n × 1, per region) largest stress over strength; 0 where the strength is not known
---@field utilised_elements bw.Array (index from 1, n × 1, per region) the element with it
---@field displacements bw.Array (m, n × 1, per region) largest displacement
---@field objectives bw.Array (any, n × 1, per region) of the linear program
---@field seconds bw.Array (s, n × 1, per region) that it took
---@field flipped bw.Array (-, n × 1, per region) 1 where the weights had the opposite sign
---@field weakness bw.Array (Pa, element_count × 1, per element) largest stress over all loads
---@field worst_region bw.Array (index from 1, element_count × 1, per element) the region whose load causes it
---@field pressures? bw.Array (Pa, n × columns of the basis, per region) the loads
---@field report bw.SolverReport of the linear programs of this call

---Weak regions. `#regions` is their number, `regions[i]` is a `bw.WeakRegion`.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local regions = bw.single_regions(mesh, {100})
---print(regions:elements(1)[1], regions:objective(1, bw.material.pla):norm())
---```
---@class bw.WeakRegions
---@field count integer (count) of regions
---@field mesh bw.Mesh of the regions
local WeakRegions = {}

---A weak region.
---@class bw.WeakRegion
---@field mode? integer (index from 1) the mode
---@field rank? integer (index from 1) its place in the mode
---@field count integer (count) of elements
---@field volume number (m3) of the elements
---@field energy number (J) of the mode in them
---@field peak number (any) largest value of the field that was thresholded

---The elements of a region.
---@param i integer (index from 1) the region
---@return bw.Array elements (index from 1, n × 1) their numbers
function WeakRegions:elements(i) end

---The weights of a region's elements in its objective.
---@param i integer (index from 1) the region
---@return bw.Array weights (any, n × 1, per element) the signed weights; three columns for the target displacement, six for a direction
function WeakRegions:weights(i) end

---Forces whose displacement q gives the gradient of the region's objective by pressures, `basis:gradient(q)`.
---
---Source: Zhou, Panetta and Zorin 2013, equation 15.
---@param i integer (index from 1) the region
---@param material bw.Material the material
---@return bw.Array force (any, node_count × 3, per node) the forces
function WeakRegions:objective(i, material) end

---Releases the regions at once.
function WeakRegions:close() end

---Pressures on the boundary of a mesh; each column is one unknown of the linear programs.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local basis = assert(bw.pressure_basis(mesh))
---local pressure = bw.array.zeros(basis.count) + 1e5
---print(basis:force(pressure):column_sums()[1]) -- uniform pressure is in balance
---```
---@class bw.PressureBasis
---@field nodes bw.Array (index from 1, count × 1, per column) its node; of a cell the node of its facet nearest to its middle
---@field areas bw.Array (m2, count × 1, per column) the area that it acts on
---@field count integer (count) of columns
---@field directions integer (count) columns of each pressure, one after the other; 1 without friction
local PressureBasis = {}

---The nodal forces of a pressure.
---@param pressure bw.Array|number[] (Pa, count × 1, per column) the pressure
---@return bw.Array force (N, node_count × 3, per node) the forces
function PressureBasis:force(pressure) end

---How the work of the pressure's forces on a displacement changes with each column.
---@param q bw.Array|number[][] (m, node_count × 3, per node) the displacement
---@return bw.Array gradient (any, count × 1, per column) J/Pa for a displacement in m
function PressureBasis:gradient(q) end

---The pressure of an admissible load (0 to `pressure`, total `force`, in balance where the part is free) that makes a linear
---objective largest.
---
---Errors: infeasible, unsupported, convergence (as of `bw.worst_loads`).
---@param system bw.System the equations of the part
---@param objective bw.Array|number[] (any, count × 1, per column) the objective
---@param options bw.PressureBasisMaximiseOptions the limits
---@return bw.Array? pressure (Pa, count × 1, per column) the load
---@return number|string value (any) objective · pressure, or the message
---@return bw.SolverReport|bw.Details? report of the linear program, or the details
function PressureBasis:maximise(system, objective, options) end

---The limits of an admissible load.
---@class bw.PressureBasisMaximiseOptions
---@field pressure number (Pa) largest pressure
---@field force number (N) total force
---@field force_is_max? boolean the total force may also be smaller. Default: false
---@field hands? integer (count) the pressure lies within so many patches. Default: 0, anywhere
---@field hand_area? number (m2) with `hands`: area of each
---@field lp? bw.LpSolver|"auto" what solves the linear programs. Default: "auto", by counted cost

---A pressure at every node of the mesh: the sum of the node's columns, or the mean by area over its cells.
---@param pressure bw.Array|number[] (Pa, count × 1, per column) the pressure
---@return bw.Array nodal (Pa, node_count × 1, per node) 0 where the node has none
function PressureBasis:nodal(pressure) end

---The forces of a pressure summed into a few arrows, the largest first.
---
---Errors: only those that every function may give.
---@param pressure bw.Array|number[] (Pa, count × 1, per column) the pressure
---@param radius? number (m) nodes within it that are pushed the same way make one arrow. Default: 0, a twentieth of the box's diagonal
---@return bw.PictureArrow[]? arrows together they carry the whole force
---@return string? message
---@return bw.Details? details
function PressureBasis:arrows(pressure, radius) end

---Releases the basis at once.
function PressureBasis:close() end
