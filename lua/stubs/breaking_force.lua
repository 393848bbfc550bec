---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Breaking force
--
-- The smallest force that breaks a body in the worst admissible way, as an interval, and advice on what to
-- thicken.

---@class bw
local bw = {}

---The smallest force that breaks a body when it is pushed in the worst way through contacts of a given size, as an interval. The
---force is what presses on one side; the reactions press as much. With `fix` the whole force pushes.
---
---A surface is filled with tetrahedra of order 2 on meshes of about 0.25, 0.6 and 1 times `elements`. Finer ones follow while the
---estimated error is larger than `error`, up to `max_elements`. A mesh is taken as it is, and the interval is wide. The stress is
---judged by its mean over a surface patch, which has a limit under refinement also at re-entrant edges.
---
---Errors: unsupported (the strength of the material is not known; `length = "critical"` without a toughness, or in a part that is
---too thin), empty (`fix` or `forbidden` returns no selection), those of `bw.mesh.fill` and of `bw.worst_case`. A selection method
---that finds nothing raises an error. What `fix` or `forbidden` returns after nil is returned.
---
---Source: docs/theory/breaking_force.md.
---```lua
---local rod = bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.01, 0.01}}
---local breaking = assert(bw.breaking_force(rod, {material = bw.material.pla, elements = 300, length = 4e-3}))
---print(breaking, breaking:verdict(50))
---```
---@param body bw.Surface|bw.Mesh a closed surface, or a mesh
---@param options bw.BreakingForceOptions material, loads and accuracy
---@return bw.BreakingForce? breaking the answer
---@return string? message
---@return bw.Details? details
function bw.breaking_force(body, options) end

---Material, loads and accuracy of a breaking force.
---@class bw.BreakingForceOptions
---@field material bw.Material with a strength
---@field force? number (N) at which `worst` is computed. Default: 20
---@field contact? number (m2) the smallest area that the force presses on; at most a twentieth of the surface is used. Default: 1e-4
---@field fix? fun(mesh: bw.Mesh): bw.Selection|bw.Selection[] what is fixed, on each mesh. Default: nothing
---@field forbidden? fun(mesh: bw.Mesh): bw.Selection|bw.Selection[] facets on which nothing presses, on each mesh. Default: none
---@field friction? number (-) Coulomb's coefficient of friction. Range: 0 to 100. Default: 0, pressure alone
---@field hands? integer (count) places that are pressed at once. Range: 1 to 16, 2 to 16 without `fix`. Default: anywhere
---@field lp? bw.LpSolver|"auto" what solves the linear programs. Default: "auto", by counted cost
---@field error? number (-) relative error at which refinement ends. Range: above 0 to 1. Default: 0.05
---@field decide? boolean whether refinement also ends after three meshes where `force` lies outside the interval by a factor of 1.5: the verdict is certain, and the interval may be wider. Default: false
---@field elements? integer (count) of the third mesh. Range: 1 to 10000000. Default: 20000
---@field max_elements? integer (count) of the finest mesh. Range: 1 to 10000000. Default: four times `elements`, but not more than 20000 unless `elements` is larger
---@field length? number|"critical" (m) radius of the patch over which the stress is averaged; "critical" is half the critical distance of the material. Default: 2 % of the diagonal of the box
---@field failure? "principal"|"von_mises" what is judged against the strength. Default: "von_mises" of steel and aluminium of the library, else "principal"
---@field modes? integer (count) of modes. Range: 1 to 500. Default: 15
---@field regions? integer (count) weak regions of each mode. Range: 1 to 1000. Default: 5
---@field seed? integer (seed) of the modes. Default: 1
---@field solver? bw.Solver|"auto" of the linear systems. `pcg` needs no factor; the modes then are by LOBPCG with its preconditioner. With the backend "petsc" modes are by SLEPc, and equations stay with the processes. Default: "auto", a factor unless it is predicted to take more than 4 GB or more than the free memory
---@field eigensolver? bw.Eigensolver|"auto" for the modes. Default: "auto"

---The breaking force of a body. `print` gives the answer in one line.
---```lua
---local rod = bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.01, 0.01}}
---local breaking = assert(bw.breaking_force(rod, {material = bw.material.pla, elements = 300, length = 4e-3}))
---print(breaking.low, breaking.force, breaking.high)
---for _, mesh in ipairs(breaking.history) do print(mesh.elements, mesh.force) end
---```
---@class bw.BreakingForce
---@field force number (N) the estimate
---@field low number (N) lower end of the interval; 0 where the estimated error is 100 %
---@field high number (N) upper end of the interval
---@field estimated_error number (-) the larger distance of an end from the estimate, over the estimate
---@field at bw.Vector (m) where it breaks
---@field region integer (index from 1) of the regions of `worst`: whose load breaks it
---@field volume number? (m3) of the surface that was given; nil where it is not sound
---@field singular bw.SingularFinding? why the stress there has no finite value: a re-entrant edge within the patch, or growth with finer meshes; nil otherwise
---@field excess number (-) by which fraction meshes may overestimate the mean stress at that edge; part of `high`
---@field ties bw.BreakingTie[] other places that are as weak within the error
---@field history bw.BreakingMesh[] of every mesh
---@field contact number (m2) the area that the force presses on
---@field fixed_area number? (m2) with `fix`: on the last mesh; nil otherwise
---@field forbidden_area number? (m2) with `forbidden`: on the last mesh; nil otherwise
---@field length number (m) radius of the patch
---@field failure "principal"|"von_mises" what is judged
---@field worst bw.WorstCase on the last mesh, under `reference`
---@field reference number (N) the force of `worst`
---@field material bw.Material of the body
---@field mesh bw.Mesh the last one
---@field surface? bw.Surface that was given
---@field given_mesh? bw.Mesh that was given, with order 2
---@field near? bw.MeshFillPlace[] edge lengths near places of the last mesh
---@field background? number (m) edge length of the last mesh away from these places
---@field box bw.Box of the body
---@field log? bw.MeshFillLog of the last filling
---@field options bw.BreakingForceOptions as they were given, with defaults
---@field reports table<string, bw.SolverReport> of solvers: `lp`, the linear programs on all meshes together; `solver`, their linear systems
---@field seconds number (s) in all
local BreakingForce = {}

---Another place that is as weak within the error.
---@class bw.BreakingTie
---@field at bw.Vector (m) the place
---@field utilisation number (1/N) mean stress over strength, per force; the force that breaks it there is 1 / utilisation
---@field region integer (index from 1) of the regions of the worst case on the last mesh
---@field stress bw.Array (Pa, 1 × 6) the mean tensor under `reference`
---@field point number (1/N) largest stress of the surface over strength, per force

---One mesh of a breaking force.
---@class bw.BreakingMesh
---@field elements integer (count) of the mesh
---@field asked number (count) that were asked for
---@field force number (N) the breaking force on it
---@field utilisation number (1/N) largest mean stress over strength, per force
---@field at bw.Vector (m) where it breaks
---@field region integer (index from 1) of the regions of its worst case
---@field point number (1/N) largest stress of the surface over strength, per force
---@field places bw.BreakingTie[] of large mean stresses, the weakest first
---@field moved number (m) mean distance of the mesh's boundary from the surface, around the place
---@field refined boolean whether elements are small there
---@field wrapped boolean whether a sound surface could not be filled and one wrapped around it was
---@field near bw.MeshFillPlace[] edge lengths near places
---@field volume number (m3) of the mesh
---@field edge? number (m) edge length near the first place
---@field size number (m) edge of a regular tetrahedron of the mean volume
---@field seconds number (s) since the start

---Whether the body carries a force: "holds" where the whole interval lies above it, "breaks" where the interval lies below it, else
---"unsure".
---@param force number (N) the force
---@return "holds"|"breaks"|"unsure" verdict the answer
function BreakingForce:verdict(force) end

---Which places to thicken, and by how much, so that the lower end of the interval reaches a force, from the shape gradients of the
---judged stresses on the last mesh. It is linear: large offsets need repetition, which `bw.strengthen` does. A breaking force that
---is closed raises.
---
---Errors: infeasible (all weak places are kept), unsupported (loads with friction or hands, and other cases without a gradient),
---convergence (a linear or quadratic program found no optimum).
---
---Source: docs/theory/strengthen.md.
---```lua
---local rod = bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.01, 0.01}}
---local breaking = assert(bw.breaking_force(rod, {material = bw.material.pla, elements = 300, length = 4e-3}))
---print(assert(breaking:advice {force = 1.2 * breaking.low}))
---```
---@param options bw.AdviceOptions the force and what must not move
---@return bw.Advice? advice what to thicken
---@return string? message
---@return bw.Details? details
function BreakingForce:advice(options) end

---What advice is asked for.
---@class bw.AdviceOptions
---@field force number (N) that the lower end of the interval is to reach, above 0
---@field estimate? number (N) that the estimate is to reach, above 0. Default: from `force` and the interval
---@field keep? fun(x: number, y: number, z: number): boolean true where the surface must not move; coordinates in m. Default: it may move everywhere
---@field max_offset? number (-) the largest offset over the radius of a place; no offset is more than half of the thickness. Range: above 0 to 1. Default: 0.25

---Releases the factor and the modes of the last mesh at once.
function BreakingForce:close() end

---What to thicken. `print` shows it in sentences.
---@class bw.Advice
---@field required number (N) the force that was asked for
---@field places bw.AdvicePlace[] the weakest first; empty where nothing needs thickening, or where none helps. Where places overlap, the surface moves by the largest offset there
---@field force number (N) the predicted breaking force
---@field low number (N) lower end of its interval
---@field high number (N) upper end of its interval

---A place to thicken: move the surface outwards by `offset` around `at`, falling to 0 at `radius`.
---@class bw.AdvicePlace
---@field at bw.Vector (m) the middle
---@field radius number (m) how far it reaches
---@field offset number (m) how far the surface moves in the middle
