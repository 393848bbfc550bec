---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Worst-case buckling
--
-- The load within limits that buckles a part first, where the loads are unknown.

---@class bw
local bw = {}

---The load that buckles a part first, of those that a search finds among all pressures up to a limit with a given total force.
---Its load factor is attained; another load may have a smaller one. A part with supports is constrained by them; its own loads
---and temperatures do not count. Loads on a part without supports are in balance and turn with it.
---
---Errors: infeasible (no load within the limits is in balance; `details.largest_force`, in N), unsupported (a support prescribes a
---displacement that is not zero; bonds or attachments), singular, convergence (as of `model:modes`, or a linear program found no
---optimum). Options that contradict each other, and a surface without a facet to press on, raise.
---
---Source: docs/theory/stability.md, "Worst-case buckling".
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.004}, cells = {10, 2, 1}, order = 2}
---local part = bw.model({mesh = mesh, material = bw.material.pla}):fix(mesh.boundary:below("x", 0))
---local worst = assert(bw.worst_buckling(part, {force = 10, contact = 1e-4, modes = 6, ascents = 2}))
---print(worst, worst.factor)
---```
---@param part bw.Model the part
---@param options? bw.WorstBucklingOptions the loads and the search
---@return bw.WorstBuckling? worst the answer
---@return string? message
---@return bw.Details? details
function bw.worst_buckling(part, options) end

---Which loads are admissible, and how the worst of them is searched for.
---@class bw.WorstBucklingOptions
---@field force? number (N) total force: the integral of the pressure. Of a part without supports one half pushes, the other half pushes back. Default: 20
---@field pressure? number (Pa) largest pressure. Default: 2e5
---@field contact? number (m2) in place of `pressure`: the smallest area over which the force presses; the largest pressure is `force / contact`
---@field force_is_max? boolean the total force may also be smaller. Default: false
---@field forbidden? bw.Selection|bw.Selection[] facets on which no pressure acts; it is zero at their nodes. Default: none
---@field hands? integer (count) the pressure lies within so many patches of the surface, by a heuristic search. Range: 1 to 16. Default: anywhere
---@field hand? number (m2) area that each of `hands` can reach: a disc. Default: `force / pressure`
---@field friction? number (-) Coulomb's coefficient of friction. Range: 0 to 100. Default: 0, pressure alone
---@field friction_facets? integer (count) facets of the pyramid in the friction cone. Range: 3 to 64. Default: 8
---@field sign? "positive"|"negative"|"either" which load factors: of loads that push, of loads that pull, or the smallest in size. Default: "positive"
---@field modes? integer (count) vibration modes that the search begins with. Range: 1 to 30. Default: 15
---@field restarts? integer (count) ascents from random combinations of shapes, on their span. Range: 0 to 10000. Default: 48
---@field ascents? integer (count) ascents with all unknowns in each round. Range: 1 to 1000. Default: 3
---@field shapes? integer (count) buckling shapes of a load that a step tries. Range: 1 to 100. Default: 2
---@field tolerance? number (-) relative residual of modes and shapes. Range: above 0 to 0.1. Default: 1e-8
---@field seed? integer (seed) of start vectors and random combinations. Default: 1
---@field eigensolver? bw.Eigensolver|"auto" of modes and shapes, not SLEPc. Default: "auto"
---@field lp? bw.LpSolver|"auto" what solves the linear programs. Default: "auto", by counted cost

---The load that buckles the part first, and others that were found. `print` gives the answer in one line.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.004}, cells = {10, 2, 1}, order = 2}
---local part = bw.model({mesh = mesh, material = bw.material.pla}):fix(mesh.boundary:below("x", 0))
---local worst = assert(bw.worst_buckling(part, {force = 10, contact = 1e-4, modes = 6, ascents = 2}))
---part:load {nodal = worst:nodal_force()}
---print(worst.factor, assert(part:buckling {count = 1}).factor)
---```
---@class bw.WorstBuckling
---@field factor number? (-) load factor of the worst load found: so many times this load the part buckles; negative for loads that pull. nil where no load was found that buckles it
---@field error number? (-) an exact factor of this mesh and load lies within this distance
---@field mesh_error number? (-) by how much the factor is too large on this mesh, relative to it, as `buckling:error_estimate`
---@field force number? (N) total force at which the worst load buckles the part: the size of the factor times `force` of the options
---@field counted boolean? whether a Sturm count confirmed that this load has no smaller factor; false for a part without supports
---@field buckling bw.Buckling? load factors and shapes of the worst load
---@field loads bw.WorstBucklingLoad[] the different loads that were found, the worst first
---@field friction_error number (-) by which fraction the pyramid may be narrower than the friction cone; 0 without friction
---@field analyses integer (count) loads whose factors were computed
---@field mesh bw.Mesh of the part
---@field material bw.Material of the part
---@field options bw.WorstBucklingOptions with defaults filled in
---@field reports table<string, bw.SolverReport> of the equations (`solver`) and the linear programs (`lp`)
local WorstBuckling = {}

---A load that was found.
---@class bw.WorstBucklingLoad
---@field factor number (-) its smallest load factor
---@field steps integer (count) of its ascent
---@field pressure bw.Array (Pa, n × 1) coefficients of the pressure; `worst:pressure` has it at nodes

---The pressure of a load.
---@param load? integer (index from 1) of `loads`. Default: the worst one
---@return bw.Array pressure (Pa, node_count × 1, per node) zero inside the body
function WorstBuckling:pressure(load) end

---The nodal forces of a load, as `part:load {nodal = ...}` takes them.
---@param load? integer (index from 1) of `loads`. Default: the worst one
---@return bw.Array force (N, node_count × 3, per node) the forces
function WorstBuckling:nodal_force(load) end

---The displacement under a load, by linear theory.
---
---Errors: only those that every function may give.
---@param load? integer (index from 1) of `loads`. Default: the worst one
---@return bw.Array? displacement (m, node_count × 3, per node) the displacement
---@return string? message
---@return bw.Details? details
function WorstBuckling:displacement(load) end

---The pressure of a load summed into a few arrows, largest first.
---
---Errors: only those that every function may give.
---@param load? integer (index from 1) of `loads`. Default: the worst one
---@param radius? number (m) of clusters. Default: a twentieth of the box's diagonal
---@return bw.PictureArrow[]? arrows together they carry the whole force
---@return string? message
---@return bw.Details? details
function WorstBuckling:arrows(load, radius) end

---Load factors and buckling shapes of a load.
---
---Errors: those of `static:buckling`.
---@param load? integer (index from 1) of `loads`. Default: the worst one
---@return bw.Buckling? buckling as many factors as the option `shapes`
---@return string? message
---@return bw.Details? details
function WorstBuckling:factors(load) end

---Writes pressure, displacement and buckling shape of the worst load.
---
---Errors: io (the file cannot be written).
---@param path string the .vtu file
---@return true? written true
---@return string? message
---@return bw.Details? details
function WorstBuckling:write(path) end

---Draws the buckling shape with the arrows of its load as a PNG file.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.WorstBucklingPictureOptions which load, and how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function WorstBuckling:picture(path, options) end

---How it is drawn.
---@class bw.WorstBucklingPictureOptions: bw.PictureOptions
---@field load? integer (index from 1) of `loads`. Default: the worst one

---Releases factor and arrays at once.
function WorstBuckling:close() end
