---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Models
--
-- A part: a mesh of a material with supports and loads.

---@class bw
local bw = {}

---A part: a mesh of a material, to be supported and loaded. `formulation` is that of its elements; "b_bar"
---cures volumetric locking of quadratic elements in nearly incompressible materials. Default: the material's
---own, which is "standard" unless it is that of a B-bar part. Linear elements with "b_bar" raise an error.
---@param options bw.ModelOptions
---@return bw.Model
function bw.model(options) end

---@class bw.ModelOptions
---@field mesh bw.Mesh
---@field material bw.Material
---@field formulation? "standard"|"b_bar"

---A mesh of a material with supports and loads; `print` shows each with area and resultant. Methods
---that change it return it.
---@class bw.Model
---@field mesh bw.Mesh
---@field material bw.Material
---@field formulation string of the elements: "standard" or "b_bar"
---@field locking string? a warning of volumetric locking (Poisson's ratio above 0.48 in standard elements) and its cure; nil where none is expected. A solve remarks it as well
---@field loads table[] {kind, value, area, resultant, moment}
---@field supports table[] {on, slide, displacement, direction (of a slide that was given one)}
local Model = {}

---Holds a selection in all directions. A selection without a facet raises an error, unless it is a node set;
---one that misses more than a tenth of the face along its border is a remark with both areas.
---@param selection bw.Selection
---@return bw.Model
function Model:fix(selection) end

---Lets a selection slide along its surface, or across a given normal.
---@param selection bw.Selection
---@param normal? bw.Vector
---@return bw.Model
function Model:slide(selection, normal) end

---Prescribes displacement, m: {x, y, z} with false where a direction is free, or a row for every node.
---@param selection bw.Selection
---@param displacement table|bw.Array
---@return bw.Model
function Model:prescribe(selection, displacement) end

---@return bw.Model
function Model:clear_supports() end

---Acceleration on the whole body, m/s2.
---@param acceleration bw.Vector
---@return bw.Model
function Model:gravity(acceleration) end

---One of: force (total, N), traction (per area, Pa), pressure (Pa, positive pushes inwards), torque
---(N m), each on a selection; or nodal forces. A torque is a couple: its moment is the same about every
---point (`about` changes nothing), and it has no net force. With net_force = true the traction turns about
---the point `about`, and has a net force where the selection's centre of area is elsewhere.
---@param options bw.ModelLoadOptions
---@return bw.Model
function Model:load(options) end

---@class bw.ModelLoadOptions
---@field on? bw.Selection
---@field force? bw.Vector
---@field traction? bw.Vector
---@field pressure? number
---@field torque? bw.Vector
---@field about? bw.Vector
---@field net_force? boolean
---@field nodal? bw.Array

---Thermal expansion: change of temperature (K, one or one for every node) times a coefficient (1/K).
---@param change number|bw.Array
---@param expansion number
---@return bw.Model
function Model:temperature(change, expansion) end

---@return bw.Model
function Model:clear_loads() end

---Consistent nodal forces of all loads.
---@return bw.Array?
function Model:force_vector() end

---Where the stress has no finite value: re-entrant edges (of `surface`, what the mesh was filled from, or else of the
---mesh's own boundary; `angle` as in surface:singular_edges), borders of supports, forces and supports at single nodes
---and along lines of them. The exponents at supports depend on Poisson's ratio (docs/theory/singular.md). nil, a
---message and details where the shape has no inside.
---`print(part:singular_places {surface = surface})`
---@param options? bw.ModelSingularPlacesOptions
---@return bw.SingularPlaces?
---@return string? message
---@return bw.Details? details
function Model:singular_places(options) end

---@class bw.ModelSingularPlacesOptions
---@field surface? bw.Surface
---@field angle? number

---The rigid motions that the supports leave: {component, centre, translation, rotation, text}.
---@return table[]?
function Model:free_motions() end

---Static solution. A load that is not balanced on a free body is refused, unless inertia relief is
---asked for. So are a body whose whole boundary is fixed at zero and a load that acts on supports only; a load of
---which at least 5 % of the area lies on supports is a remark with the share. with "auto" (default): by a factor, or by two-level PCG where that counts as much cheaper or the
---factor would take more than 4 GB or more than memory_limit bytes (what is free); "factor": a sparse factor, which other
---loads, modes and the worst case then use; "pcg": conjugate gradients over linear and quadratic elements without
---one, in a tenth of the memory, at most that many iterations (2000): quadratic elements, and supports that hold the
---body (docs/theory/solving.md). with "petsc": by PETSc on all processes that mpirun started (docs/howto_cluster.md),
---method "cg" (default: conjugate gradients with multigrid) or "cholesky" (MUMPS), down to a residual of rtol
---(1e-10) in at most that many iterations (2000).
---
---With `error`: tet10 meshes refined by bisection where the error of the quantity `of` comes from, until its
---estimated error is at most that share of its value (docs/theory/error_control.md). `of`: "von_mises" (default),
---"max_principal", "displacement": the largest at nodes; a point, or {at =, field =}: the stress ("von_mises",
---"xx" ... "xy") or displacement ("displacement", "ux", "uy", "uz") there; a selection, or {reaction =, axis =}: the
---reaction on a face; a function of the solution that returns a number. Supports and loads go with their facets.
---`surface`: what the mesh was filled from; edges follow its planes and round faces (default: the mesh's edges stay
---the lines or curves that they are, and facets of round faces count as an error). Limits:
---most_elements (200000), time_limit (s), memory_limit. The second result says how it went; so it does where a limit
---came first.
---`local static, accuracy = part:solve {error = 0.01, of = {at = {0, 1, 0}, field = "xx"}}`
---@param options? bw.ModelSolveOptions
---@return bw.Static?
---@return bw.Accuracy|string? accuracy with `error`, else the message
---@return bw.Details? details
function Model:solve(options) end

---@class bw.ModelSolveOptions
---@field inertia_relief? boolean
---@field tolerance? number
---@field with? "auto"|"factor"|"pcg"|"petsc"
---@field memory_limit? number
---@field iterations? integer
---@field method? "auto"|"cg"|"cholesky"
---@field rtol? number
---@field error? number
---@field of? string|bw.Vector|table|bw.Selection|(fun(static: bw.Static): number)
---@field most_elements? integer
---@field time_limit? number
---@field surface? bw.Surface

---The same supports and loads on a mesh with element e bisected levels[e] times (three halve its edges), and
---neighbours as it needs to conform. Facets of supports and loads are those inside of the facets before; fields at
---nodes are interpolated. order 2 raises linear elements; `surface`: as of mesh:curved; `also`: further selections to
---carry. More than most_elements: nil, a message and details. Not for materials turned by element.
---`local fine = assert(part:refined(levels))`
---@param levels bw.Array|table whole numbers from 0 to 30
---@param options? bw.ModelRefinedOptions
---@return bw.Model?
---@return bw.Selection[]|string also those of `also`, or a message
---@return bw.Details? details
function Model:refined(levels, options) end

---@class bw.ModelRefinedOptions
---@field order? 1|2
---@field surface? bw.Surface
---@field also? bw.Selection[]
---@field most_elements? integer

---The lowest modes, elastic or of the Laplacian. with "slepc": elastic ones by SLEPc on all processes that
---mpirun started (docs/howto_cluster.md), method "cholesky" (default: MUMPS, and a count that none is
---missing) or "cg" (conjugate gradients inside, no count).
---With `error`: on tet10 meshes refined until the estimated relative error of every frequency is at most that. The
---second result tells how it went; `history` has the frequencies of every mesh. Limits as of part:solve.
---`local modes, accuracy = part:modes {count = 5, error = 0.001}`
---@param options? bw.ModelModesOptions
---@return bw.Modes?
---@return bw.Accuracy|string? accuracy with `error`, else the message
---@return bw.Details? details
function Model:modes(options) end

---@class bw.ModelModesOptions
---@field error? number
---@field most_elements? integer
---@field time_limit? number
---@field surface? bw.Surface
---@field count? integer
---@field tolerance? number
---@field sturm? boolean
---@field seed? integer
---@field laplacian? boolean
---@field with? "factor"|"slepc"
---@field method? "auto"|"cg"|"cholesky"
---@field rtol? number
---@field iterations? integer

---The equations with their factor.
---@return bw.System?
---@return string? message
---@return bw.Details? details
function Model:system() end

---The same supports and loads on a mesh of the same topology: they go with the surface.
---@param mesh bw.Mesh
---@return bw.Model?
---@return string? message
---@return bw.Details? details
function Model:moved(mesh) end

---The same on a refilled mesh; `node_from` has the old node of every node, 0 for new ones.
---@param mesh bw.Mesh
---@param node_from bw.Array
---@return bw.Model?
---@return string? message
---@return bw.Details? details
function Model:transferred(mesh, node_from) end

---As an .inp for CalculiX; modes > 0: a frequency step. Forces are nodal; gravity and temperatures are
---written as such (one coefficient of expansion, the largest; temperatures are scaled to it).
---@param path string
---@param options? bw.ModelWriteInpOptions
---@return true?
---@return string? message
---@return bw.Details? details
function Model:write_inp(path, options) end

---@class bw.ModelWriteInpOptions
---@field modes? integer

---Lets go at once.
function Model:close() end

---How part:solve {error =} and part:modes {error =} went; the value of modes is the first frequency. Errors are relative to the value. `print(accuracy)` tells it.
---@class bw.Accuracy
---@field quantity string
---@field value number
---@field estimated_error number
---@field at? bw.Vector where; nil for a function
---@field converged boolean
---@field reason "tolerance"|"elements"|"time"|"memory"|"facets"|"divergence" why there is no finer mesh; facets: those that stand for a round face are a larger error by themselves; divergence: the changes of the value do not fall, so it may have no limit
---@field history table[] of every mesh {elements, unknowns, value, frequencies (of modes), at, edge (length of elements at a largest stress, m), estimated_error, facet_error (its part by facets of round faces), seconds, effectivity: estimated error over the difference to the last value}
---@field elements integer of the last mesh
---@field seconds number
---@field part bw.Model on the last mesh
---@field surface? bw.Surface that curved edges follow
---@field options table
---@field singular? bw.SingularFinding of a largest stress: it has no finite value
