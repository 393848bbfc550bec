---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Worst case
--
-- The largest stress among all pressure loads within limits, and the load that causes it. It belongs to one mesh;
-- `bw.breaking_force` gives an answer with an error.

---@class bw
local bw = {}

---The largest stress that was found among all pressures up to a limit with a given total force, and the load that causes it. It
---is a lower bound of the largest one; `certify` adds an upper bound. A part with supports is constrained by them; its own loads do not
---count. Loads on a part without supports are in balance.
---
---Bodies that bonds, couplings and attachments join are one part: its modes, and six rigid-body modes in all. No pressure acts on
---what a bond covers or on a plane of symmetry.
---
---Errors: infeasible (no load within the limits is in balance; `details.largest_force`, in N), unsupported (a support prescribes a
---displacement that is not zero, or a bond has a preload; a sector of cyclic symmetry; a certificate of a material whose axes differ from element to element; Laplacian modes with the
---target displacement), unconstrained (joined bodies move against one another), geometry (a bond closes a gap of bodies that move
---freely), singular, convergence (as of `model:modes`, or a linear program found no optimum), io (the certificate
---cannot be written). Options that contradict each other, and a surface without a facet to press on, raise.
---
---Source: Q. Zhou, J. Panetta and D. Zorin, Worst-Case Structural Analysis, ACM Trans. Graph. 32 (2013), and a search beside its
---modes; docs/theory/worst_case.md.
---```lua
---local mesh = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local worst = assert(bw.worst_case(part, {force = 50, contact = 1e-4, forbidden = mesh.boundary:below("x", 0)}))
---print(worst)
---```
---@param part bw.Model the part
---@param options? bw.WorstCaseOptions the loads and the search
---@return bw.WorstCase? worst the answer
---@return string? message
---@return bw.Details? details
function bw.worst_case(part, options) end

---Which loads are admissible, and how the worst of them is searched for.
---@class bw.WorstCaseOptions
---@field force? number (N) total force: the integral of the pressure. Of a part without supports one half pushes, the other half pushes back. Default: 20
---@field pressure? number (Pa) largest pressure. Default: 2e5
---@field contact? number (m2) in place of `pressure`: the smallest area over which the force presses; the largest pressure is `force / contact`
---@field force_is_max? boolean the total force may also be smaller. Default: false
---@field forbidden? bw.Selection|bw.Selection[] facets on which no pressure acts; it is zero at their nodes. Default: none
---@field hands? integer (count) the pressure lies within so many patches of the surface, by a heuristic search. Range: 1 to 16. Default: anywhere
---@field hand? number (m2) area that each of `hands` can reach: a disc. Default: `force / pressure`
---@field friction? number (-) Coulomb's coefficient of friction. Range: 0 to 100. Default: 0, pressure alone
---@field friction_facets? integer (count) facets of the pyramid in the friction cone. Range: 3 to 64. Default: 8
---@field method? "search"|"paper" "search" adds targets beside the modes and an ascent of the principal stress; "paper" uses the weak regions of the modes alone. Default: "search" for stress, "paper" for displacement
---@field targets? integer (count) elements that the search makes targets; half as many more where the answer still grows. Range: 1 to 100000. Default: 48
---@field certify? number (-) find an upper bound that exceeds the largest stress by at most this fraction. Range: 0.001 to 0.5. Default: none
---@field certificate? string with `certify`: a file that proves the bound (docs/formats.md), for `bw.check_certificate`
---@field length? number (m) radius of surface patches: the mean stress over them is searched for, in place of the stress of elements. Not with `method`, `certify`, or the target displacement. Default: none
---@field failure? "principal"|"von_mises" with `length`: what is judged. "von_mises" needs one strength. Default: "principal"
---@field places? bw.WeakPlace[] with `length`: `places` of another worst case of the same length, from which the search starts in place of modes
---@field screening? boolean with `places`: false to search from these places only. Default: true
---@field pairs? bw.ContactPair[] parts of the mesh, or rigid planes, that touch without friction: what opens and closes with the load. Supports and bonds constrain each body. The equations have a factor. Not with `certify`, `length`, or the target displacement. Default: none
---@field modes? integer (count) of modes. Range: 1 to 500. Default: 15
---@field regions? integer (count) weak regions of each mode. Range: 1 to 1000. Default: 5
---@field fraction? number (-) of the volume that counts as weak in a mode. Range: above 0 to 1. Default: 0.025
---@field measure? "stress"|"energy" which field of a mode is thresholded. Default: "stress"
---@field target? "stress"|"displacement" what the worst load makes largest. Default: "stress"
---@field laplacian? boolean use the modes of the Laplacian. Default: false
---@field one_sign? boolean try only the sign that the mode came with. Default: false, both
---@field tolerance? number (-) relative residual of the modes, above 0. Default: 1e-8, without a factor 1e-6
---@field sturm? boolean count the modes by a second factor, so that none is missing. Default: false
---@field seed? integer (seed) of the modes. Default: 1
---@field solver? bw.Solver|"auto" of the linear systems. `pcg` needs no factor; the modes then are by LOBPCG with its preconditioner. With the backend "petsc" modes are by SLEPc, and equations stay with the processes. Default: "auto", a factor unless it is predicted to take more than 4 GB or more than the free memory
---@field eigensolver? bw.Eigensolver|"auto" for the modes. Default: "auto"
---@field batch? integer (count) regions that are worked on at once. Default: 0, chosen
---@field lp? bw.LpSolver|"auto" what solves the linear programs. Default: "auto", by counted cost

---The worst load that was found, and all others. `print` gives the answer in one line.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local worst = assert(bw.worst_case(bw.model {mesh = mesh, material = bw.material.pla}, {force = 50}))
---print(worst.max_principal, worst.utilisation, #worst.regions)
---print(worst:pressure():max(), worst:stress().row_count)
---```
---@class bw.WorstCase
---@field max_principal number (Pa) magnitude of the largest principal stress of an element
---@field at bw.Vector (m) centre of that element
---@field element integer (index from 1) that element
---@field region integer (index from 1) of `regions`: the one whose load causes it. By stress over strength where strengths are known, each element's by its own material, else by stress
---@field origin "mode"|"element"|"ascent"|"bound"|"patch" what the worst load was found from: a weak region of a mode, an element of the screening, an ascent, the search of the upper bound, a patch of the boundary
---@field upper_bound number? (Pa) with `certify`: no load within the limits stresses any element of this mesh more
---@field bounded string? with `certify`: where the bound is not for exactly the loads that were asked for, for which
---@field friction_error number (-) by which fraction the pyramid may be narrower than the friction cone; 0 without friction
---@field gap number? (-) with `certify`: upper bound over largest stress found, less one
---@field mode integer? (index from 1) the mode whose weak region gave the worst load; nil otherwise
---@field rank integer? (index from 1) of that region in its mode; nil otherwise
---@field utilisation number? (-) the largest stress over strength; nil where the strength is not known
---@field strength number|bw.Vector|nil (Pa) of the material; nil where it is not known
---@field max_displacement number (m) the largest of all worst loads
---@field regions bw.WorstRegion[] one for each worst load
---@field weakness bw.Array (Pa, element_count × 1, per element) the largest stress over all worst loads
---@field worst_region bw.Array (index from 1, element_count × 1, per element) of `regions`: whose load causes it
---@field pressures bw.Array (Pa, regions × columns of the basis, per region) the worst loads
---@field loads bw.WorstLoads what the linear programs gave
---@field origins bw.WorstOrigin[] of the regions behind those of modes
---@field limits bw.WorstLoadsOptions of the linear programs
---@field places bw.WeakPlace[]? with `length`: where the mean stress is largest, the weakest first; nil otherwise
---@field contact bw.ContactSystem? with `pairs`: the equations with contact; nil otherwise
---@field touching integer? (count) with `pairs`: corners that carry pressure under the worst load; nil otherwise
---@field settled boolean? with `pairs`: whether no load of the same state of contact stresses the element more along its direction, within 1e-4; nil otherwise
---@field modes bw.Modes? nil where the search began with `places`
---@field mesh bw.Mesh of the part
---@field material bw.Material of the part
---@field system bw.System the equations of the part
---@field weak_regions bw.WeakRegions? nil with `places`
---@field basis bw.PressureBasis of the pressures
---@field options bw.WorstCaseOptions as they were given, with defaults
---@field solve_error number (-) estimate of what the error of the linear solve does to `max_principal`, as a fraction of it; 0 by a factor
---@field reports table<string, bw.SolverReport> of solvers: `lp`, all linear programs together; `solver`, all linear systems (`modes.report` is of the modes)
---@field seconds table<string, number> by stage: system, assemble, factor, modes, regions, linear_programs, search, bound
local WorstCase = {}

---A target and its worst load.
---@class bw.WorstRegion
---@field origin "mode"|"element"|"ascent"|"bound"|"patch" what it was found from
---@field label string in words
---@field mode? integer (index from 1) of a weak region: its mode
---@field rank? integer (index from 1) of a weak region: its place in the mode
---@field target? integer (index from 1) of others: the element, or the node of the patch
---@field from? integer (index from 1) of an ascent: the region that it starts from
---@field elements integer (count) of the region
---@field volume number (m3) of the region
---@field volume_fraction number (-) of the volume of the part
---@field energy? number (J) of a weak region: of its mode in it
---@field max_principal number (Pa) the largest stress under the load
---@field at bw.Vector (m) centre of the element with it
---@field element integer (index from 1) the element with it
---@field utilisation? number (-) the largest stress over strength under the load
---@field utilised_at? bw.Vector (m) centre of the element with it
---@field displacement number (m) the largest under the load
---@field objective number (any) of the linear program
---@field seconds number (s) that it took
---@field flipped boolean whether the weights had the opposite sign

---What a target beside the modes came from.
---@class bw.WorstOrigin
---@field origin "element"|"ascent"|"bound"|"patch" what it was found from
---@field target integer (index from 1) the element, or the node of the patch
---@field from? integer (index from 1) of an ascent: the region that it starts from
---@field elements? integer (count) of a patch: elements
---@field volume? number (m3) of a patch: of its elements

---A place of a large mean stress over a surface patch.
---@class bw.WeakPlace
---@field utilisation number (-) mean stress over strength; Pa where the strength is not known
---@field at bw.Vector (m) the node in the middle of the patch
---@field node integer (index from 1) that node
---@field region integer (index from 1) of `regions`: the load
---@field stress bw.Array (Pa, 1 × 6) the mean tensor
---@field point number (-) largest stress over strength of the surface under the load

---Continues a search with `length` to all patches whose mean stress may reach a utilisation. Regions keep their numbers; new
---ones follow. A worst case without `length` raises.
---
---Errors: convergence (a linear program found no optimum).
---@param utilisation number (-) stress over strength, above 0; Pa where the strength is not known
---@return bw.WorstCase? self this worst case
---@return string? message
---@return bw.Details? details
function WorstCase:extend(utilisation) end

---The worst pressure of a region.
---@param region? integer (index from 1) of `regions`. Default: that of the largest stress
---@return bw.Array pressure (Pa, node_count × 1, per node) 0 at inner nodes
function WorstCase:pressure(region) end

---The nodal forces of the worst pressure of a region.
---@param region? integer (index from 1) of `regions`. Default: that of the largest stress
---@return bw.Array force (N, node_count × 3, per node) the forces
function WorstCase:force(region) end

---The displacement under the worst pressure of a region. It is kept.
---
---Errors: singular (the solution is not finite).
---@param region? integer (index from 1) of `regions`. Default: that of the largest stress
---@return bw.Array? displacement (m, node_count × 3, per node) the displacement
---@return string? message
---@return bw.Details? details
function WorstCase:displacement(region) end

---The stress of every element under the worst pressure of a region.
---
---Errors: singular (the solution is not finite).
---@param region? integer (index from 1) of `regions`. Default: that of the largest stress
---@return bw.Array? stress (Pa, element_count × 6, per element) tensors
---@return string? message
---@return bw.Details? details
function WorstCase:stress(region) end

---The worst pressure of a region summed into a few arrows, the largest first.
---
---Errors: only those that every function may give.
---@param region? integer (index from 1) of `regions`. Default: that of the largest stress
---@param radius? number (m) nodes within it that are pushed the same way make one arrow. Default: 0, a twentieth of the box's diagonal
---@return bw.PictureArrow[]? arrows together they carry the whole force
---@return string? message
---@return bw.Details? details
function WorstCase:arrows(region, radius) end

---The weakness of every facet: that of the element behind it.
---@return bw.Array weakness (Pa, facet_count × 1, per facet) the largest stress over all worst loads
function WorstCase:surface_weakness() end

---Writes weakness, and pressure, displacement and stress of the worst load, to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written), singular (the solution is not finite).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function WorstCase:write(path) end

---Draws the weakness with the arrows of the worst load as a PNG file; with `region` the stress under the load of that region on
---the deformed shape.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.WorstCasePictureOptions what is drawn and how
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function WorstCase:picture(path, options) end

---How a worst case is drawn.
---@class bw.WorstCasePictureOptions: bw.PictureOptions
---@field region? integer (index from 1) of `regions`: the load whose stress is drawn. Default: none, the weakness

---Writes one HTML file with a 3D view that can be turned. It needs no network.
---
---Errors: io (the file cannot be written), singular (the solution is not finite).
---@param path string the file
---@param options? bw.WorstCaseReportOptions what it shows
---@return true? written true
---@return string? message
---@return bw.Details? details
function WorstCase:report(path, options) end

---What a report shows.
---@class bw.WorstCaseReportOptions
---@field title? string of the page. Default: "Worst-case analysis"
---@field manifest? table<string, any> what the results depend on. Default: version and options
---@field loads? integer (count) of regions whose loads can be shown, 1 or more. Default: 6
---@field modes? integer (count) of modes that can be shown, 0 or more. Default: 15
---@field lines? (bw.Array|bw.Vector[])[] lists of points in m, drawn over the surface
---@field line_name? string what the lines are
---@field view? bw.Vector (-) from the object to the viewer. Default: chosen
---@field answer? string sentences above the view. Default: those of `print`
---@field region? integer (index from 1) the load that is shown first. Default: that of the largest stress

---Releases the equations, the modes and the arrays at once.
function WorstCase:close() end

---Checks a certificate that `bw.worst_case` wrote: that its directions are covered, that the multipliers of each leaf prove the
---leaf's bound, that its load is admissible and reaches its stress. Nothing of the search is used. It takes about as long as the
---bound itself.
---
---Errors: io (the file cannot be read), format (it is no certificate; details: `line`), rejected (it proves less than it states).
---
---Source: docs/theory/worst_case.md, section 14.
---```lua
---local mesh = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.01, 0.01}, cells = {6, 1, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---assert(bw.worst_case(part, {certify = 0.1, certificate = "bound.txt"}))
---print(assert(bw.check_certificate "bound.txt").upper_bound)
---```
---@param path string the file
---@return bw.CertificateProof? proof what it proves
---@return string? message
---@return bw.Details? details
function bw.check_certificate(path) end

---What a certificate proves: no load within the stated limits stresses any element of the stated mesh more than `upper_bound`.
---@class bw.CertificateProof
---@field upper_bound number (Pa) the bound
---@field solve_error number (Pa) the part of it that stands for errors of the linear solves
---@field reached number (Pa) the stress that its load reaches
---@field gap number (-) `upper_bound` over `reached`, less one
---@field element integer (index from 1) the element in which the load reaches it
---@field elements integer (count) of the mesh
---@field leaves integer (count) that were checked
---@field force number (N) total force
---@field pressure number (Pa) largest pressure
---@field force_is_max boolean whether the total force may also be smaller
---@field friction number (-) coefficient of the pyramid in the friction cone
---@field supports integer (count) of supports
---@field forbidden_facets integer (count) facets on which no pressure acts
