---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Breaking force
--
-- The smallest force that breaks a body, as an interval, and what to thicken.

---@class bw
local bw = {}

---The least force that breaks a body when it is pushed in the worst way through contacts of a given size, as an
---interval. The force is what presses on one side; the reactions press as much. A surface is filled with quadratic
---tetrahedra on meshes of about 0.25, 0.6 and 1 times `elements` (20000); finer ones follow until the estimated error
---is at most `error` (0.05) or there are `most_elements` (four times `elements`, but not more than 20000 unless asked
---for). A mesh is taken as it is, and the interval is wide. The stress is judged by its
---mean over a surface patch of radius `length` (m; default 2 % of the diagonal of the bounding box; "critical": half
---the critical distance of the material, nil and a message where it has none), by the largest principal stress, or by
---von Mises against yield for the library's metals or `failure = "von_mises"`.
---`contact` is the least area that a force presses on (m2; default 1e-4, at most a twentieth of the surface), `force`
---the load at which `worst` is computed (N; default 20). docs/theory/breaking_force.md.
---```lua
---local rod = bw.surface.box {low = {0, 0, 0}, high = {0.06, 0.01, 0.01}}
---local breaking = assert(bw.breaking_force(rod, {material = bw.material.pla, elements = 300, modes = 2}))
---print(breaking, breaking:verdict(50))
---```
---`fix` gives selections on each mesh that do not move: then the whole force pushes. `forbidden` gives those on which
---nothing presses; `friction` is Coulomb's coefficient (default 0), `hands` the number of places (1 to 16) that are
---pressed at once.
---@param body bw.Surface|bw.Mesh
---@param options bw.BreakingForceOptions
---@return bw.BreakingForce?
---@return string? message
---@return bw.Details? details
function bw.breaking_force(body, options) end

---@class bw.BreakingForceOptions
---@field material bw.Material
---@field force? number
---@field contact? number
---@field fix? fun(mesh: bw.Mesh): bw.Selection|bw.Selection[]
---@field forbidden? fun(mesh: bw.Mesh): bw.Selection|bw.Selection[]
---@field friction? number
---@field hands? integer
---@field error? number
---@field elements? integer
---@field most_elements? integer
---@field length? number|"critical"
---@field failure? "principal"|"von_mises"
---@field modes? integer
---@field regions? integer
---@field seed? integer

---@class bw.BreakingForce
---@field force number N: the estimate
---@field low number N: the lower end of the interval; 0 where the estimated error is 100 %
---@field high number N: the upper end
---@field estimated_error number the larger distance of an end, over the force
---@field at number[] m: where it breaks
---@field region integer of the worst case, whose load breaks it
---@field volume number? m3: of the surface that was given, where it is sound
---@field singular bw.SingularFinding? why the stress there has no finite value: a re-entrant edge within the patch, or the stress grows with finer meshes
---@field excess number by how much meshes may overestimate the mean at that edge, as a share; part of `high`
---@field ties table[] {force is 1 / utilisation, at}: other places that are as weak within the error
---@field history table[] of every mesh {elements, asked, force, utilisation, at, region, point, places, moved, refined, wrapped (a sound surface could not be filled, one wrapped around it was), volume, edge, size, seconds}
---@field contact number m2
---@field held_area number? m2: with `fix`, on the last mesh
---@field forbidden_area number? m2: with `forbidden`
---@field length number m: radius of the patch
---@field failure string
---@field worst bw.WorstCase on the last mesh, under `reference` N
---@field reference number N
---@field material bw.Material
---@field mesh bw.Mesh the last one
---@field surface? bw.Surface
---@field given_mesh? bw.Mesh
---@field near? bw.MeshFillPlace[] edge lengths near places of the last mesh, m
---@field background? number m: edge length of the last mesh away from these places
---@field box table
---@field log? table of the last filling
---@field options table
---@field seconds number
local BreakingForce = {}

---"holds" where the whole interval lies above the force, "breaks" where it lies below, else "unsure".
---@param force number N
---@return string
function BreakingForce:verdict(force) end

---Which places to thicken, and by how much, so that the lower end of the interval reaches `force` (N), from the shape
---gradients of the judged stresses on the last mesh. `estimate` (N) replaces what the estimate is to reach,
---`keep(x, y, z)` is true where nothing may move (m), no offset is more than `most_offset` (default 0.25) radii
---or half of the thickness. Linearised: large offsets need repetition, which bw.strengthen does. nil, message, details where all weak places are
---kept (status "infeasible"), or for loads with friction or hands ("unsupported"). Raises where it is closed.
---docs/theory/strengthen.md.
---```lua
---local rod = bw.surface.box {low = {0, 0, 0}, high = {0.06, 0.01, 0.01}}
---local breaking = assert(bw.breaking_force(rod, {material = bw.material.pla, elements = 300, modes = 2}))
---print(assert(breaking:advice {force = 1.2 * breaking.low}))
---```
---@param options bw.AdviceOptions
---@return bw.Advice?
---@return string? message
---@return bw.Details? details
function BreakingForce:advice(options) end

---@class bw.AdviceOptions
---@field force number
---@field estimate? number
---@field keep? fun(x: number, y: number, z: number): boolean
---@field most_offset? number

---Releases the factor and the modes of the last mesh.
function BreakingForce:close() end

---What to thicken; print tells it in sentences.
---@class bw.Advice
---@field required number N: the force that was asked for
---@field places bw.AdvicePlace[] m: displace the surface outwards by offset around at, up to radius; weakest first, empty where nothing needs or helps. Where places overlap, the surface moves by the largest offset there at most
---@field force number N: the predicted breaking force
---@field low number N: the lower end of its interval
---@field high number N: the upper end

---@class bw.AdvicePlace
---@field at bw.Vector
---@field radius number
---@field offset number
