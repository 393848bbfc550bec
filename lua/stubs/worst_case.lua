---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Worst case
--
-- The largest stress among all pressure loads within limits, and the load that causes it.

---@class bw
local bw = {}

---Where a part breaks when nobody knows its loads: the largest stress that was found among all pressures
---up to `pressure` with a total of `force` (Zhou, Panetta, Zorin 2013, and a search beside the modes).
---The stress is a lower bound of the largest one, and comes with the load that causes it. A part with supports
---is held by them; its own loads do not count. nil, message, details where no load within the limits is in balance
---(status "infeasible", details.largest_force), or a support prescribes a displacement that is not zero
---("unsupported"). docs/theory/worst_case.md, section 15.
---```lua
---local mesh = bw.mesh.box {low = {0, 0, 0}, high = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local worst = assert(bw.worst_case(part, {force = 50, contact = 1e-4, forbidden = mesh.boundary:below("x", 0)}))
---print(worst)
---```
---@param part bw.Model
---@param options? bw.WorstCaseOptions
---@return bw.WorstCase? worst
---@return string? message
---@return bw.Details? details
function bw.worst_case(part, options) end

---Checks a certificate that `bw.worst_case` wrote: that its directions are covered, that the multipliers of each leaf
---prove the leaf's bound, that its load is admissible and reaches its stress. Nothing of the search is used. It takes
---about as long as the bound itself. Returns nil, message, details where it fails; the status is "rejected" where the
---file proves less than it states, "format" where it is no certificate.
---```lua
---local mesh = bw.mesh.box {low = {0, 0, 0}, high = {0.1, 0.01, 0.01}, cells = {6, 1, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---assert(bw.worst_case(part, {certify = 0.1, certificate = "bound.txt"}))
---print(assert(bw.check_certificate "bound.txt").upper_bound)
---```
---@param path string
---@return bw.CertificateProof? proof
---@return string? message
---@return bw.Details? details
function bw.check_certificate(path) end

---What a certificate proves: no load within the stated limits stresses any element of the stated mesh more than
---`upper_bound`.
---@class bw.CertificateProof
---@field upper_bound number Pa
---@field solve_error number how much of `upper_bound` stands for what the linear solves may be off by, Pa
---@field reached number the stress that its load reaches, Pa
---@field gap number upper_bound over reached, less one
---@field element integer the element in which it does
---@field elements integer of the mesh
---@field leaves integer that were checked
---@field force number total force, N
---@field pressure number largest pressure, Pa
---@field at_most boolean the total force may also be smaller
---@field friction number coefficient of the pyramid in the friction cone
---@field supports integer
---@field forbidden_facets integer facets on which no pressure acts

---@class bw.WorstCaseOptions
---@field force? number total force, N; default 20: of a free body what pushes and what pushes back
---@field pressure? number largest pressure, Pa; default 0.2 MPa
---@field contact? number instead of `pressure`: the least area over which the total force presses, m2; the largest pressure is force / contact
---@field at_most? boolean the total force may also be smaller; default false
---@field forbidden? bw.Selection|bw.Selection[] facets on which no pressure may act; it is zero at their nodes
---@field hands? integer the pressure lies within so many patches (1 to 16) of the surface; searched for by a heuristic. Left out: anywhere
---@field hand? number area that each of `hands` can reach, m2: a disc; default force / pressure
---@field friction? number Coulomb's coefficient of friction, 0 to 100; default 0: pressure alone
---@field friction_facets? integer facets (3 to 64) of the pyramid in the friction cone, which is narrower by 1 - cos(pi / facets) at most; default 8
---@field method? "search"|"paper" "search" (default for stress): targets beside the modes and an ascent of the principal stress; "paper": the modes' weak regions alone
---@field targets? integer elements that the search makes targets; default 48, half as many more where the answer still grows
---@field certify? number find an upper bound within this share (0.001 to 0.5) of the largest stress, for pressure anywhere where `hands` are given: a fraction of the time of brute force
---@field certificate? string with `certify`: a file that proves the bound (docs/formats.md), for `bw.check_certificate`
---@field length? number radius of surface patches, m: the mean stress over them is searched for (docs/theory/breaking_force.md) instead of the stress of elements; without `method`, `certify`, target "displacement"
---@field failure? "principal"|"von_mises" with `length`: what is judged; default "principal"
---@field places? table[] with `length`: `places` of another worst case, which take the place of the modes
---@field screening? boolean with `places`: false to search from these places only; default true
---@field modes? integer default 15
---@field regions? integer weak regions of each mode; default 5
---@field fraction? number of the volume that counts as weak in a mode; default 0.025
---@field measure? "stress"|"energy" what the threshold is on
---@field target? "stress"|"displacement" what the worst load makes largest
---@field laplacian? boolean the cheaper modes of the Laplacian; default false
---@field one_sign? boolean only the sign that the mode came with; default false: both are tried
---@field tolerance? number of the modes' residuals; default 1e-8
---@field sturm? boolean count the modes by a second factor, so that none is missing; default false
---@field seed? integer of the start vector of the modes; default 1
---@field batch? integer regions worked on at once; 0: chosen
---@field glpk? boolean solve the linear programs by GLPK; default false

---Where a part breaks. `print` gives the answer in one line.
---@class bw.WorstCase
---@field max_principal number Pa
---@field at bw.Vector m
---@field element integer
---@field region integer the worst one, a place in `regions`
---@field origin "mode"|"element"|"ascent"|"bound"|"patch" what the worst load was found from: a mode's weak region, an element of the screening, an ascent, the search of the upper bound, a patch of the boundary
---@field upper_bound number? with `certify`: no load within the limits stresses any element of this mesh more, Pa
---@field bounded string? with `certify`, where the bound is not for the loads that were asked for: "for pressure anywhere instead of within hands" (it holds for hands too), or "for friction of the pyramid, ..." (Coulomb's cone is larger)
---@field friction_error number by how much the friction cone is narrower than asked for at most, as a share; 0 without friction
---@field gap number? with `certify`: how far the bound exceeds the largest stress found, as a share of it
---@field mode integer? where a mode's weak region gave the worst load
---@field rank integer? of that region in its mode
---@field utilisation number? stress over strength
---@field strength number|bw.Vector|nil Pa
---@field max_displacement number m
---@field regions table[] {origin, label, mode, rank (of a mode's region), target, from (element aimed at and, of an ascent, the region it starts from), elements, volume, volume_fraction, energy, max_principal, at, element, utilisation, utilised_at, displacement, objective, seconds, flipped}
---@field weakness bw.Array of every element: the largest stress over all worst loads, Pa
---@field worst_region bw.Array of every element: which region's load causes it
---@field pressures bw.Array regions x columns of the basis: one for each node or cell, several with friction
---@field loads table of arrays with a row for each region, as the linear programs returned them
---@field origins table[] of the regions that no mode gave {origin, target, from}
---@field limits table of the linear programs {pressure, force, at_most, ...}
---@field places table[]? with `length`: where the mean stress is largest, weakest first: {utilisation, at, node, region, stress, point}
---@field modes bw.Modes? none where the search began with `places`
---@field mesh bw.Mesh
---@field material bw.Material
---@field system bw.System
---@field weak_regions bw.WeakRegions? nil with `places`
---@field basis bw.PressureBasis
---@field options table as given, with defaults
---@field seconds table by stage: system, assemble, factor, modes, regions, linear_programs, search, bound
local WorstCase = {}

---The worst pressure of a region (left out: the worst region), for every node of the mesh, Pa.
---@param region? integer
---@return bw.Array
function WorstCase:pressure(region) end

---Continues a search with `length` to all patches whose mean stress may reach a utilisation. Regions keep their
---numbers; new ones follow.
---@param utilisation number stress over strength; without a strength, Pa
---@return bw.WorstCase? self
---@return string? message
---@return bw.Details? details
function WorstCase:extend(utilisation) end

---The nodal forces of that pressure.
---@param region? integer
---@return bw.Array
function WorstCase:force(region) end

---The displacement under it.
---@param region? integer
---@return bw.Array?
function WorstCase:displacement(region) end

---The stress of every element under it.
---@param region? integer
---@return bw.Array?
function WorstCase:stress(region) end

---The pressure summed into a few arrows {at, force, area}, largest first.
---@param region? integer
---@param radius? number
---@return table[]?
function WorstCase:arrows(region, radius) end

---The weakness of every boundary facet.
---@return bw.Array
function WorstCase:surface_weakness() end

---Weakness, and pressure, displacement and stress of the worst load, as .vtu.
---@param path string
---@return true?
---@return string? message
---@return bw.Details? details
function WorstCase:write(path) end

---The weakness map with the arrows of the worst load; with {region = i} the stress under that load.
---@param path string
---@param options? bw.PictureOptions
---@return true?
function WorstCase:picture(path, options) end

---One HTML file with a 3D view that turns; needs no network. The load of `region` is shown first (default: that of
---the largest stress); `answer` replaces the sentence above the view.
---@param path string
---@param options? bw.WorstCaseReportOptions
---@return true?
---@return string? message
---@return bw.Details? details
function WorstCase:report(path, options) end

---@class bw.WorstCaseReportOptions
---@field title? string
---@field manifest? table
---@field loads? integer
---@field modes? integer
---@field lines? (bw.Array|bw.Vector[])[]
---@field line_name? string
---@field view? bw.Vector
---@field answer? string
---@field region? integer

---Lets go at once.
function WorstCase:close() end
