---@meta barwright
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Annotations for editors (the Lua language server reads them) and the source of docs/reference.md.
--
-- Units are SI: metre, kilogram, second, newton, pascal, radian. Indices count from 1. A vector is a
-- table {x, y, z}, or an array of three numbers; a matrix is a table of rows. Tensors are stored
-- xx yy zz yz zx xy. Options are tables; an unknown key raises an error that names the known one that
-- it resembles, or all.
-- Misuse raises. What the world can cause (a bad file, no convergence, no memory) returns nil, a
-- message, and a table of details with a `status` word: io format geometry free singular
-- convergence infeasible limit memory cancelled unsupported internal, empty where what is asked for is not there,
-- and of studies busy damaged different failed foreign. Objects are released by the
-- collector, or at once by `close`, or at the end of the scope of a `<close>` variable.

---@class bw.Vector table {x, y, z}

---@class bw.Box a box along the axes
---@field low bw.Vector
---@field high bw.Vector
---@field size bw.Vector

---The module: `local bw = require "barwright"`.
---@class bw
---@field array bw.ArrayModule
---@field surface bw.SurfaceModule
---@field skeleton bw.SkeletonModule
---@field edit bw.EditModule
---@field outline bw.OutlineModule
---@field responsive bw.ResponsiveModule
---@field plane bw.PlaneModule
---@field grid bw.GridModule
---@field metamaterial bw.MetamaterialModule
---@field mesh bw.MeshModule
---@field material bw.MaterialModule
---@field shapes table bodies by signed distance functions, for surface.implicit: sphere, limb, box, join, cut, ...
---@field json bw.JsonModule
---@field results bw.ResultsModule
---@field scenario bw.ScenarioModule
---@field study bw.StudyModule
---@field plot bw.PlotModule
local bw = {}

---A part: a mesh of a material, to be supported and loaded. `formulation` is that of its elements; "b_bar"
---cures volumetric locking of quadratic elements in nearly incompressible materials. Default: the material's
---own, which is "standard" unless it is that of a B-bar part. Linear elements with "b_bar" raise an error.
---@param options {mesh: bw.Mesh, material: bw.Material, formulation?: "standard"|"b_bar"}
---@return bw.Model
function bw.model(options) end

---Where a part breaks when nobody knows its loads: the largest stress that was found among all pressures
---up to `pressure` with a total of `force` (Zhou, Panetta, Zorin 2013, and a search beside the modes).
---The stress is a lower bound of the largest one, and comes with the load that causes it. A part with supports
---is held by them; its own loads do not count. nil, message, details where no load within the limits is in balance
---(status "infeasible", details.largest_force), or a support prescribes a displacement that is not zero
---("unsupported"). docs/theory/worst_case.md, section 15.
---
---    local worst = bw.worst_case(part, {force = 50, contact = 1e-4, forbidden = mesh.boundary:patch {0, 0, 0.02}})
---@param part bw.Model
---@param options? bw.WorstCaseOptions
---@return bw.WorstCase? worst
---@return string? message
---@return table? details
function bw.worst_case(part, options) end

---Checks a certificate that `bw.worst_case` wrote: that its directions are covered, that the multipliers of each leaf
---prove the leaf's bound, that its load is admissible and reaches its stress. Nothing of the search is used. It takes
---about as long as the bound itself. Returns nil, message, details where it fails; the status is "rejected" where the
---file proves less than it states, "format" where it is no certificate.
---```lua
---assert(bw.worst_case(part, {certify = 0.01, certificate = "bound.txt"}))
---print(assert(bw.check_certificate "bound.txt").upper_bound)
---```
---@param path string
---@return bw.CertificateProof? proof
---@return string? message
---@return table? details
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

---The same as `bw.worst_case` with every element, or a sample of them, as its own region. Slow; the measure of the rest.
---With objective "trace" (default, the paper's) each load maximises the trace of the element's stress;
---with "principal" an ascent of its principal stress follows, about three times as long.
---@param part bw.Model
---@param options? {force: number, pressure: number, contact: number, at_most: boolean, forbidden: bw.Selection|bw.Selection[], friction: number, friction_facets: integer, hands: integer, hand: number, elements: integer, seed: integer, one_sign: boolean, batch: integer, objective: "trace"|"principal"}
---@return bw.BruteForce?
---@return string? message
---@return table? details
function bw.brute_force(part, options) end

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
---local breaking = assert(bw.breaking_force(assert(bw.surface.read "hook.stl"), {material = bw.material.pla}))
---print(breaking, breaking:verdict(50))
---```
---`hold` gives selections on each mesh that do not move: then the whole force pushes. `forbidden` gives those on which
---nothing presses; `friction` is Coulomb's coefficient (default 0), `hands` the number of places (1 to 16) that are
---pressed at once.
---@param body bw.Surface|bw.Mesh
---@param options {material: bw.Material, force?: number, contact?: number, hold?: (fun(mesh: bw.Mesh): bw.Selection|bw.Selection[]), forbidden?: (fun(mesh: bw.Mesh): bw.Selection|bw.Selection[]), friction?: number, hands?: integer, error?: number, elements?: integer, most_elements?: integer, length?: number|"critical", failure?: "principal"|"von_mises", modes?: integer, regions?: integer, seed?: integer}
---@return bw.BreakingForce?
---@return string? message
---@return table? details
function bw.breaking_force(body, options) end

---Thickens a surface around its weak places until the lower end of its breaking force exceeds `force` (N), with at
---most `steps` (default 8) rounds of advice, smooth outward bumps, and analysis. A surface that is not sound is repaired
---first. `keep(x, y, z)` is true where the surface must not move (m). `progress(step)` is called after each step with
---{places, offset, predicted, force, low, high}: how many places, the largest offset (m), the predicted force, the
---computed one and its interval (N). A step that makes the lower end worse is undone: the next one begins from the best
---surface so far with half of the offsets. A step that goes further than the force needs is repeated once with smaller
---offsets. Coordinates of the surface are exact in single precision in `unit` (default 1e-3 m), as binary STL
---has them. Other options: those of bw.breaking_force. nil, message, details where the given surface cannot be
---computed; a force that is not reached is no failure: then it is the best surface that was found, see `reached` and
---`stopped`. docs/theory/strengthen.md.
---```lua
---local result = assert(bw.strengthen(surface, {material = bw.material.pla, force = 50}))
---print(result)
---assert(result.surface:write "stronger.stl")
---```
---@param surface bw.Surface
---@param options {force: number, material: bw.Material, contact?: number, elements?: integer, length?: number|"critical", failure?: "principal"|"von_mises", modes?: integer, regions?: integer, seed?: integer, steps?: integer, keep?: (fun(x: number, y: number, z: number): boolean), unit?: number, progress?: fun(step: table)}
---@return bw.Strengthened?
---@return string? message
---@return table? details
function bw.strengthen(surface, options) end

---Random drops of a free part onto a peg, thousands from one factor. The area of each contact follows from the
---indentation of part and peg.
---@param part bw.Model without supports, of a material with a density
---@param options? {drops: integer, height: number, peg_radius: number, duration: number, seed: integer}
---@return bw.DropTest?
---@return string? message
---@return table? details
function bw.drop_test(part, options) end

---Mean stress of every element under a displacement: a row of six for each.
---@param mesh bw.Mesh
---@param material bw.Material
---@param displacement bw.Array
---@return bw.Array?
function bw.element_stress(mesh, material, displacement) end

---Stress at every node, averaged over the elements around it by volume.
---@param mesh bw.Mesh
---@param material bw.Material
---@param displacement bw.Array
---@return bw.Array?
function bw.nodal_stress(mesh, material, displacement) end

---Stress at the corners of the boundary's facets, three rows of six for each facet: from the displacement of the
---facet's own nodes and the traction on it. At a re-entrant edge it depends on the mesh far less than stresses at nodes.
---What supports push back is no part of the traction (docs/theory/breaking_force.md).
---`bw.surface_mean(mesh, bw.surface_stress(mesh, steel, static.displacement, static.force), 2e-3, static)`
---@param mesh bw.Mesh
---@param material bw.Material
---@param displacement bw.Array m, a row for every node; thermal expansion is not taken off
---@param force? bw.Array N, a row for every node: the load whose traction acts; default none
---@return bw.Array? stress Pa, rows 3 f - 2 to 3 f for facet f, in the order of its corners
---@return string? message
---@return table? details
function bw.surface_stress(mesh, material, displacement, force) end

---The mean of a field of facets' corners over the boundary that connected facets reach within `radius` of each
---boundary node, weighted by area and 1 - (distance / radius)^2: a nonlocal measure that has a limit under refinement
---where a stress has none. Where the mesh is coarser than the radius, the mean by area over the facets around the
---node. Facets that `supports` constrain in all directions do not count. 0 at inner nodes and inside of such supports.
---@param mesh bw.Mesh
---@param values bw.Array three rows for every facet, such as those of bw.surface_stress; linear between them
---@param radius number m, above 0
---@param supports? bw.Static|bw.Model|bw.System whose supports count; default none
---@return bw.Array? mean a row for every node, of as many columns
---@return string? message
---@return table? details
function bw.surface_mean(mesh, values, radius, supports) end

---Von Mises stress of rows of stress tensors.
---@param stress bw.Array
---@return bw.Array?
function bw.von_mises(stress) end

---Principal stresses, descending, of rows of stress tensors.
---@param stress bw.Array
---@return bw.Array?
function bw.principal(stress) end

---The principal stress largest in size of rows of stress tensors.
---@param stress bw.Array
---@return bw.Array?
function bw.max_principal(stress) end

---The steps of the worst case by themselves. First: the weak regions of modes.
---@param mesh bw.Mesh
---@param material bw.Material
---@param modes bw.Modes
---@param options? {measure: "stress"|"energy", target: "stress"|"displacement", fraction: number, regions: integer}
---@return bw.WeakRegions?
---@return string? message
---@return table? details
function bw.weak_regions(mesh, material, modes, options) end

---Every element, or those given, as a region of its own, with a weight of `sign` (default 1).
---@param mesh bw.Mesh
---@param elements? bw.Array|integer[]
---@param sign? number
---@return bw.WeakRegions?
function bw.single_regions(mesh, elements, sign) end

---Pressures at the boundary corner nodes of a mesh, linear over its facets. With a `spacing` (m) they are constant on
---cells of facets instead, whose edges are at most so long, but not shorter than a sixteenth of the facet's.
---`forbidden`: no pressure on these facets; that at corner nodes falls to zero around. Raises where no surface is left. With `friction` (default 0) a node has `friction_facets` (default 8) columns,
---which pull the surface along in so many directions; its pressure is their sum.
---@param mesh bw.Mesh
---@param options? {forbidden?: bw.Selection, spacing?: number, friction?: number, friction_facets?: integer}
---@return bw.PressureBasis?
function bw.pressure_basis(mesh, options) end

---The worst load of every region and the stresses under it: arrays peaks, peak_elements,
---utilisations, utilised_elements, displacements, objectives, seconds, flipped (of regions), weakness,
---worst_region (of elements), pressures (regions x columns of the basis); peak_stresses and own_stresses: of
---every region six components of the stress where it is largest, and in the region's first element.
---`after`: results of an earlier call on the same mesh, whose regions come first in those returned.
---@param system bw.System
---@param basis bw.PressureBasis
---@param regions bw.WeakRegions
---@param options {pressure: number, force: number, at_most?: boolean, hands?: integer, hand_area?: number, one_sign?: boolean, batch?: integer, keep_pressures?: boolean, glpk?: boolean, after?: table}
---@return table?
---@return string? message
---@return table? details
function bw.worst_loads(system, basis, regions, options) end

---The von Mises stress of a static solution at some nodes, and how it changes with the position of
---every node: a block of a row for every node of the mesh for each of the nodes. What middle nodes
---contribute is part of their edge's ends; their own rows are zero. Straight elements only.
---@param part bw.Model
---@param system bw.System|bw.LocalSystem of the part
---@param displacement bw.Array
---@param nodes integer[]|bw.Array
---@param options? {method: "auto"|"refactor"|"iterate"|"levels"|"scratch", tolerance: number, energy: boolean, guess: bw.Array[], hope: number} where a local system iterates: relative residual, or (energy) error in energy; fields to begin with; iterations hoped for over predicted
---@return bw.Array? von_mises
---@return bw.Array|string gradient or a message
---@return table? details
function bw.von_mises_gradient(part, system, displacement, nodes, options) end

---The same for some motions of all nodes: a row for each of the nodes, a column for each motion.
---@param part bw.Model
---@param system bw.System|bw.LocalSystem of the part
---@param displacement bw.Array
---@param nodes integer[]|bw.Array
---@param motions bw.Array[] a row for every node of the mesh each
---@param options? {method: "auto"|"refactor"|"iterate"|"levels"|"scratch", tolerance: number, energy: boolean, guess: bw.Array[], hope: number}
---@return bw.Array? von_mises
---@return bw.Array|string slopes or a message
---@return bw.Array|table adjoint displacements, a block of a row for every node of the mesh for each of the nodes; or details
function bw.von_mises_slopes(part, system, displacement, nodes, motions, options) end

---The least 1/2 x H x + g x with A x <= b and low <= x <= high, H positive definite. Where no x
---fulfils the rows within the bounds, `violation` is the least v so that A x <= b + v has a solution,
---and x the best with it; else it is 0.
---@param program {H: table|bw.Array, g: number[]|bw.Array, A?: table|bw.Array, b?: number[]|bw.Array, low?: number[]|bw.Array, high?: number[]|bw.Array}
---@return bw.Array? x
---@return number|string violation or a message
---@return bw.Array|table multipliers of the rows, or details
function bw.quadratic_program(program) end

---How much each bone moves each node: a row for every node, a column for every bone, rows summing to
---one. `heat`: of the exchange with the bones; default 20.
---@param mesh bw.Mesh
---@param skeleton bw.Skeleton
---@param options? {heat: number}
---@return bw.Array?
---@return string? message
---@return table? details
function bw.skinning_weights(mesh, skeleton, options) end

---Cuts a mesh into domains along a skeleton. `threshold`: mean weight from which an element follows one
---bone; `bone_threshold`: instead of it, one for every bone, where not 0; `share`: thresholds are lowered
---until each bone has this share of the elements that it moves most, default 0.35, negative: never.
---@param mesh bw.Mesh
---@param skeleton bw.Skeleton
---@param weights bw.Array
---@param options? {threshold: number, share: number, bone_threshold: table}
---@return bw.Domains?
---@return string? message
---@return table? details
function bw.domains(mesh, skeleton, weights, options) end

---Spearman's rank correlation of two columns, ties averaged; with weights (volumes), a sample of
---twice the weight counts as two.
---@param a bw.Array
---@param b bw.Array
---@param weights? bw.Array
---@return number?
function bw.rank_correlation(a, b, weights) end

---A shaded picture of a surface as a PNG file.
---@param surface bw.Surface
---@param path string
---@param options? bw.PictureOptions
---@return true?
---@return string? message
---@return table? details
function bw.picture(surface, path, options) end

---Calls f(stage, fraction) while the engine works; false from it asks the engine to stop. nil goes
---back to what the program shows. The function may not call the engine.
---@param f? fun(stage: string, fraction: number): boolean?
---@return function? before the one in force before
function bw.progress(f) end

---The number of threads; with an argument it is set first. Results have the same bits for any number.
---@param n? integer
---@return integer
function bw.threads(n) end

---What the engine remarked since the last call ("the surface was repaired: ..."), oldest first.
---@return string[]
function bw.remarks() end

---Whether Ctrl-C was pressed: for loops that go on after a failed case.
---@return boolean
function bw.interrupted() end

---Seconds of a clock that only goes forward.
---@return number
function bw.seconds() end

---The version, and the commit it was built from ("" when not known).
---@return string version
---@return string commit
function bw.version() end

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

---@class bw.PictureOptions
---@field values? bw.Array over points or facets
---@field displacement? bw.Array a row of three for every point
---@field deformation? number factor on it; 0: chosen
---@field ghost? boolean the undeformed outline behind
---@field arrows? {at: bw.Vector, force: bw.Vector}[]
---@field lines? bw.Array[] lists of points, drawn as violet lines over the surface: edges of surface:singular_edges() for instance
---@field line_name? string what the lines are, for the legend
---@field labels? {at: bw.Vector, text: string}[] texts at places on the surface; left out where the body is in front and over labels before
---@field title? string
---@field unit? string name and unit of the colour bar: "von Mises stress, MPa"
---@field scale? number values are multiplied by it on the bar
---@field low? number lower end of the colours
---@field high? number upper end of the colours
---@field width? integer pixels; default 1200
---@field height? integer pixels; default 900
---@field direction? bw.Vector from the object to the viewer
---@field up? bw.Vector
---@field zoom? number
---@field edges? boolean draw the facets' edges

---PNG files of one size, as pictures of grids and surfaces are, as an animated PNG: `seconds` for each
---(0.05), over again `rounds` times (0: for ever). Browsers play it.
---@param path string
---@param pictures string[] paths
---@param options? {seconds?: number, rounds?: integer}
---@return boolean?
---@return string? message
---@return table? details
function bw.animation(path, pictures, options) end

-- ---- arrays -------------------------------------------------------------------------------------

---Making arrays; `bw.array{...}` is short for `bw.array.new{...}`.
---@class bw.ArrayModule
---@overload fun(rows: table, type?: string): bw.Array
local array_module = {}

---From numbers, or from rows of numbers.
---@param rows table
---@param type? "f64"|"i32"|"i64"|"u8"
---@return bw.Array
function array_module.new(rows, type) end

---@param rows integer
---@param columns? integer
---@param type? "f64"|"i32"|"i64"|"u8"
---@return bw.Array
function array_module.zeros(rows, columns, type) end

---first, first + step, ... up to last.
---@param first number
---@param last number
---@param step? number
---@return bw.Array
function array_module.range(first, last, step) end

---From bytes such as `array:tostring` gives.
---@param format string < or >, then f4 f8 i1 i2 i4 i8 u1 u2 u4 u8
---@param bytes string
---@param columns? integer
---@return bw.Array
function array_module.from_string(format, bytes, columns) end

---A formula over named arrays and numbers: `bw.array.map("x^2 + norm(u)*k", {x = ..., u = ..., k = 3})`.
---Operators of Lua (+ - * / % ^ == ~= < <= > >= and or not), name[k] or name.x for a column, sqrt abs
---exp log sin cos tan asin acos atan floor ceil sign min max atan2 hypot mod norm where(c, yes, no), pi.
---Comparisons make masks (u8).
---@param formula string
---@param variables table<string, bw.Array|number>
---@return bw.Array
function array_module.map(formula, variables) end

---A view of rows x columns numbers; it keeps the memory it looks at alive and cannot be changed.
---`#a` is the number of rows, `a[i]` a number or (with several columns) a row, `a(i, j)` an entry;
---+ - * / ^ work entry by entry with arrays and numbers.
---@class bw.Array
---@field row_count integer
---@field column_count integer
---@field type "f64"|"i32"|"i64"|"u8"
---@operator add(bw.Array|number): bw.Array
---@operator sub(bw.Array|number): bw.Array
---@operator mul(bw.Array|number): bw.Array
---@operator div(bw.Array|number): bw.Array
---@operator pow(bw.Array|number): bw.Array
---@operator unm: bw.Array
---@overload fun(row: integer, column?: integer): number
local Array = {}

---Rows first to last by step, a view; negative ones count from the end.
---@param first? integer
---@param last? integer
---@param step? integer
---@return bw.Array
function Array:rows(first, last, step) end

---Columns first to last by step, a view.
---@param first? integer
---@param last? integer
---@param step? integer
---@return bw.Array
function Array:columns(first, last, step) end

---One column, a view.
---@param column integer
---@return bw.Array
function Array:column(column) end

---The smallest entry (NaN passed over); nil of none.
---@return number?
function Array:min() end

---The largest entry.
---@return number?
function Array:max() end

---Row and column of the smallest entry.
---@return integer? row
---@return integer? column
function Array:argmin() end

---Row and column of the largest entry.
---@return integer? row
---@return integer? column
function Array:argmax() end

---The sum of all entries, compensated.
---@return number
function Array:sum() end

---The mean of all entries, or of one column with weights.
---@param weights? bw.Array
---@return number
function Array:mean(weights) end

---The root of the sum of squares.
---@return number
function Array:norm() end

---The sum of products with an array of the same shape.
---@param other bw.Array
---@return number
function Array:dot(other) end

---One sum for each column.
---@return number[]
function Array:column_sums() end

---The p-th quantile, 0 to 1, of one column; weighted when weights are given.
---@param p number
---@param weights? bw.Array
---@return number?
function Array:quantile(p, weights) end

---One column in ascending order.
---@return bw.Array
function Array:sorted() end

---The numbers of the rows in ascending order of their entries.
---@return bw.Array
function Array:order() end

---A formula with this array as `a`; see `array.map`.
---@param formula string
---@param variables? table<string, bw.Array|number>
---@return bw.Array
function Array:map(formula, variables) end

---A mask: entries greater than x (a number or an array).
---@param x number|bw.Array
---@return bw.Array
function Array:above(x) end

---A mask: entries less than x.
---@param x number|bw.Array
---@return bw.Array
function Array:below(x) end

---The rows of the given numbers.
---@param rows bw.Array|integer[]
---@return bw.Array
function Array:gather(rows) end

---The rows whose mask is not 0.
---@param mask bw.Array
---@return bw.Array
function Array:select(mask) end

---The numbers of the rows whose entry is not 0.
---@return bw.Array
function Array:where() end

---Zeros of `count` rows with row i of this array put at rows[i].
---@param rows bw.Array|integer[]
---@param count integer
---@return bw.Array
function Array:scatter(rows, count) end

---The same numbers in memory of its own.
---@return bw.Array
function Array:copy() end

---Numbers, or rows of numbers.
---@return table
function Array:totable() end

---Bytes, row after row; `offset` is added to every number first.
---@param format string < or >, then f4 f8 i1 i2 i4 i8 u1 u2 u4 u8
---@param offset? number
---@return string
function Array:tostring(format, offset) end

---Lets go at once.
function Array:close() end

-- ---- surfaces -----------------------------------------------------------------------------------

---@class bw.SurfaceModule
local surface_module = {}

---Reads STL, OBJ, OFF, PLY, MSH, VTU, decided by content. Without a unit: millimetres (MSH and VTU:
---metres).
---@param path string
---@param options? {unit: string|number}
---@return bw.Surface? surface
---@return table|string info format, polygons, skipped, groups, metres_per_unit; or a message
---@return table? details
function surface_module.read(path, options) end

---From points (metres) and triangles (numbers of points, counter-clockwise seen from outside).
---@param options {points: table|bw.Array, triangles: table|bw.Array, groups?: table|bw.Array}
---@return bw.Surface?
function surface_module.new(options) end

---@param options {low: bw.Vector, high: bw.Vector}
---@return bw.Surface?
function surface_module.box(options) end

---@param options {centre?: bw.Vector, radius: number, subdivisions?: integer}
---@return bw.Surface?
function surface_module.sphere(options) end

---A closed cylinder; the length of `axis` is its height.
---@param options {base?: bw.Vector, axis: bw.Vector, radius: number, segments?: integer}
---@return bw.Surface?
function surface_module.cylinder(options) end

---The zero set of a function of x, y, z, or of a formula in them ("x^2 + y^2 + z^2 - 1"), that is
---negative inside.
---@param value string|fun(x: number, y: number, z: number): number
---@param options {low: bw.Vector, high: bw.Vector, cells?: integer} cells along the longest side, default 32
---@return bw.Surface?
---@return string? message
---@return table? details
function surface_module.implicit(value, options) end

---A triangle surface. It does not change: methods give new ones.
---@class bw.Surface
---@field points bw.Array point_count x 3, m
---@field triangles bw.Array triangle_count x 3
---@field groups bw.Array? group, solid or region of every facet
---@field point_count integer
---@field triangle_count integer
---@field area number m2
---@field volume number m3; negative when it faces inwards
---@field box bw.Box
local Surface = {}

---Writes .stl .obj .ply .off (millimetres unless told otherwise), .vtu .msh (metres). Fields, by
---point or facet, go into .vtu.
---@param path string
---@param options? {unit: string|number, ascii: boolean, fields: table<string, bw.Array>}
---@return true?
---@return string? message
---@return table? details
function Surface:write(path, options) end

---What is wrong with it: counts by kind, holes, shells, closed, oriented, sound, volume, area, box,
---and a list of defects {kind, facet, other, at}, at most `limit` of a kind.
---@param options? {limit: integer}
---@return table?
function Surface:check(options) end

---Welds, drops duplicates, orients, fills holes, resolves intersections, wraps: only what is needed.
---@param options? {weld: number, fill_holes: boolean, intersections: boolean, wrap: boolean, wrap_alpha: number, wrap_offset: number, time_limit: number, memory_limit: number}
---@return bw.Surface?
---@return table|string log moved and steps, or a message
---@return table? details
function Surface:repair(options) end

---Isotropic remeshing with sharp edges and small features kept. Beyond `time_limit` in seconds of
---computing (300) or `memory_limit` in bytes (6e9): nil, a message and details with `limit` "time" or
---"memory".
---@param options? {edge_length: number, triangles: integer, sharp_angle: number, iterations: integer, tolerance: number, time_limit: number, memory_limit: number}
---@return bw.Surface?
---@return table|string log moved and steps, or a message
---@return table? details
function Surface:remesh(options) end

---A closed surface around anything; holes up to `alpha` (m; 1/50 of the box's diagonal) are bridged, and
---it lies about `offset` (m; alpha / 12) away. A child process makes it; beyond `time_limit` in seconds of
---computing (300) or `memory_limit` in bytes (6e9): nil, a message and details with `limit` "time" or
---"memory".
---@param options? {alpha: number, offset: number, time_limit: number, memory_limit: number}
---@return bw.Surface?
---@return table|string log
---@return table? details
function Surface:wrap(options) end

---Makes neighbours agree and shells face outwards.
---@return bw.Surface?
---@return integer flipped facets that were turned
function Surface:orient() end

---Merges points closer than the tolerance (0: equal ones).
---@param tolerance? number
---@return bw.Surface?
function Surface:weld(tolerance) end

---@param factor number
---@return bw.Surface?
function Surface:scale(factor) end

---@param matrix number[][] three rows of four: [A | b]
---@return bw.Surface?
function Surface:transform(matrix) end

---@param by bw.Vector
---@return bw.Surface?
function Surface:translate(by) end

---Turns about an axis through a centre, right-handed.
---@param axis bw.Vector
---@param angle number radians
---@param centre? bw.Vector
---@return bw.Surface?
function Surface:rotate(axis, angle, centre) end

---The largest distance from one surface to the other, both ways; or how far each of some points is, m.
---@param other bw.Surface|bw.Array|number[][]
---@return number|bw.Array|nil
---@return string? message
---@return table? details
function Surface:distance(other) end

---A part of a surface bounded by sharp edges or by the end of a primitive. Lengths in m, areas in m2. A free
---form has neither point nor residual; a sphere has no axis; planes have no radius.
---@class bw.Face
---@field name string "plane 2": the second largest plane
---@field kind "plane"|"cylinder"|"cone"|"sphere"|"free form"
---@field area number
---@field triangle_count integer
---@field centre number[] of area
---@field normal number[] mean outward; 0 where the face closes on itself
---@field point? number[] of the plane or the axis; the centre of the sphere
---@field axis? number[] unit; the plane's outward normal
---@field radius? number of the cone: at the point
---@field slope? number of the cone: growth of the radius per length along the axis
---@field residual? number largest distance of a corner from the primitive

---The faces by descending area; `print(surface)` lists the largest twelve. Facets whose normals differ by at most
---`angle` (radians, default 30 degrees) are of one face unless primitives part them (docs/theory/faces.md).
---`for _, face in ipairs(surface:faces()) do print(face.name, face.area) end`
---@param options? {angle?: number}
---@return bw.Face[]? faces
---@return bw.Array|string numbers of every triangle the number of its face, or a message
---@return table? details
function Surface:faces(options) end

---@class bw.SingularPlace
---@field kind "re-entrant edge"|"border of a support"|"line load"|"line support"|"point load"|"point support"
---@field points number[][] a polyline, or one point; m
---@field inward number[][] of each point: the bisector into the material, unit
---@field length number m
---@field angle? number inside the material, radians: the mean along the edge
---@field least_angle? number
---@field largest_angle? number
---@field exponent number Williams' lambda: displacements go like r^lambda with the distance r
---@field growth number 1 - lambda: the stress grows like h^-growth with the edge length h of elements

---Places where linear elasticity has no finite stress, as a list of bw.SingularPlace; `print(places)` shows twelve of them.
---@class bw.SingularPlaces
local SingularPlaces = {}

---The place nearest to a point, with the distance and its own nearest point; nil where none is within `radius` (m).
---@param point number[]
---@param radius? number default: any
---@return {place: bw.SingularPlace, distance: number, at: number[], inward: number[]}?
function SingularPlaces:near(point, radius) end

---A list of some of the places: `places.list {places[1], places[3]}`.
---@param chosen bw.SingularPlace[]
---@return bw.SingularPlaces
function SingularPlaces.list(chosen) end

---The re-entrant edges, the longest first: those whose angle inside the material exceeds 180 degrees by more than
---`angle` (radians, default 10 degrees) between two faces that lie on planes, cylinders, cones or spheres, and by more
---than 30 degrees where one is free form. Facets of a round face make no edge (docs/theory/singular.md). nil, a message
---and details for a surface that is open or turned inside out.
---`print(bw.surface.read("bracket.stl", {unit = "mm"}):singular_edges())`
---@param options? {angle?: number}
---@return bw.SingularPlaces?
---@return string? message
---@return table? details
function Surface:singular_edges(options) end

---@param path string
---@param options? bw.PictureOptions
---@return true?
function Surface:picture(path, options) end

---Lets go at once.
function Surface:close() end

-- ---- meshes -------------------------------------------------------------------------------------

---@class bw.MeshModule
local mesh_module = {}

---Fills a surface with tetrahedra by TetGen, in a child process with limits; repairs, remeshes or
---wraps where that is needed, and says so in the log.
---@param surface bw.Surface
---@param options? bw.FillOptions
---@return bw.Mesh? mesh
---@return table|string log repaired, surface_moved, edge_length, attempts, steps, seconds_repair, seconds_remesh, seconds_fill; or a message
---@return table? details
function mesh_module.fill(surface, options) end

---@class bw.FillOptions
---@field elements? integer wanted number of elements
---@field order? 1|2 tet4 or tet10; default 1
---@field edge_length? number of the surface, m; in place of `elements`: see the log of a former filling
---@field surface_tolerance? number m that remeshing may leave the surface by; edges are shorter where it is curved or has small features; default a quarter of the edge length
---@field max_volume? number of an element, m3
---@field radius_edge? number quality bound; default 1.4
---@field dihedral? number smallest dihedral angle asked for
---@field keep_surface? boolean no points added on the surface
---@field remesh? boolean remesh first; default true
---@field repair? boolean repair what is not sound; default true
---@field sharp_angle? number for remeshing; default 40 degrees
---@field near? {at: bw.Vector, radius: number, length: number}[] edge lengths near points; the surface is remeshed to them too
---@field size? string|fun(x: number, y: number, z: number): number edge length wanted, 0: no wish
---@field time_limit? number seconds of one attempt
---@field memory_limit? number bytes of one attempt
---@field tolerance? number on the wanted number of elements

---Reads .vtu .msh .mesh .node/.ele .inp; metres unless told otherwise.
---@param path string
---@param options? {unit: string|number}
---@return bw.Mesh? mesh
---@return table|string file fields, sets, format, skipped; or a message
---@return table? details
function mesh_module.read(path, options) end

---From nodes (metres) and elements (numbers of 4 or 10 nodes).
---@param options {nodes: table|bw.Array, elements: table|bw.Array, order?: 1|2, regions?: table|bw.Array}
---@return bw.Mesh?
function mesh_module.new(options) end

---A box of cells, each cut into six tetrahedra.
---@param options {low: bw.Vector, high: bw.Vector, cells: bw.Vector, order?: 1|2}
---@return bw.Mesh?
function mesh_module.box(options) end

---A mesh of tetrahedra. It does not change: methods give new ones.
---@class bw.Mesh
---@field nodes bw.Array node_count x 3, m
---@field elements bw.Array element_count x 4 or 10 (corners, then the middles of 12 23 31 14 24 34)
---@field regions bw.Array? a tag for every element
---@field volumes bw.Array of every element, m3
---@field node_volumes bw.Array every node's share of the volume: weights for values at nodes
---@field facets bw.Array of the boundary: corners, then middles
---@field facet_elements bw.Array the element behind every facet
---@field neighbours bw.Array element_count x 4: across each face, 0 for none
---@field components bw.Array the body of every node
---@field order integer
---@field node_count integer
---@field element_count integer
---@field facet_count integer
---@field component_count integer
---@field volume number
---@field surface_moved number m, the most by which bw.mesh.fill moved the surface; 0 of other meshes
---@field box bw.Box
---@field boundary bw.Selection the whole boundary, to choose from
local Mesh = {}

---Writes .vtu .msh .mesh .node/.ele .inp; fields {name = array} or {name = {array, on = "elements"}}
---into .vtu and .msh.
---@param path string
---@param options? {fields: table<string, bw.Array|table>, unit: string|number, version: "2.2"|"4.1"}
---@return true?
---@return string? message
---@return table? details
function Mesh:write(path, options) end

---tet4 to tet10 with straight edges, or back.
---@param order 1|2
---@return bw.Mesh?
function Mesh:with_order(order) end

---The same elements with other node positions.
---@param nodes bw.Array|table
---@return bw.Mesh?
---@return string? message
---@return table? details
function Mesh:moved(nodes) end

---All lengths times a factor.
---@param factor number
---@return bw.Mesh?
function Mesh:scale(factor) end

---The elements whose mask is not 0.
---@param mask bw.Array
---@return bw.Mesh?
function Mesh:subset(mask) end

---The same mesh with nodes and elements numbered along a curve that fills space (Hilbert's): an
---optimisation of an edit session takes a tenth to a fifth less processor time than with numbers of a
---mesh generator. Meshes made by bw.mesh.fill are numbered so already.
---@return bw.Mesh?
---@return bw.Array|string nodes of every node the number that it had, or the message
---@return bw.Array|table elements of every element the number that it had, or details
function Mesh:renumbered() end

---Curved elements: the nodes of the boundary's edges on the planes, cylinders, cones and spheres of the surface
---that a mesh of order 2 was filled from. Nodes stay where an element would become too distorted.
---`local mesh, moved = assert(bw.mesh.fill(surface, {order = 2})):curved(surface)`
---@param surface bw.Surface
---@return bw.Mesh? mesh
---@return integer|string count how many nodes moved, or a message
---@return table? details
function Mesh:curved(surface) end

---The boundary as a surface, and the node of every point.
---@return bw.Surface?
---@return bw.Array nodes
function Mesh:surface() end

---The faces of the surface that the mesh was filled from (Surface:faces), with `area` and `triangle_count` of the
---mesh's boundary: what filling has left of each. A face without a facet there has area 0.
---`for i, face in ipairs(mesh:faces(surface)) do print(face.name, face.area / surface:faces()[i].area) end`
---@param surface bw.Surface
---@return bw.Face[]? faces
---@return string? message
---@return table? details
function Mesh:faces(surface) end

---The element that holds a point (or the nearest one), its barycentric weights, whether it is inside.
---@param point bw.Vector
---@return integer element
---@return number[] weights
---@return boolean inside
function Mesh:locate(point) end

---A nodal field at points, by the shape functions of the elements that hold them; of a point outside the value at the
---nearest place of the mesh. `outside`: how far each point lies outside, 0 inside.
---`local stress = part.mesh:sample(static.stress, {{0.01, 0, 0}, {0.02, 0, 0}})`
---@param values bw.Array a row for every node
---@param points bw.Array|number[][]
---@return bw.Array? values a row for every point
---@return bw.Array|string outside m, or a message
---@return table? details
function Mesh:sample(values, points) end

---dihedral_low, dihedral_high, radius_edge_high, aspect_high, volume_low, volume_high, worst.
---@return table
function Mesh:quality() end

---Values of elements at nodes: the mean by volume, or the largest of the elements around.
---@param values bw.Array
---@param how? "mean"|"max"
---@return bw.Array
function Mesh:to_nodes(values, how) end

---The shape quality of every element (mean ratio: 1 for a regular one, 0 or less: inverted), at the
---mesh's own nodes or at others.
---@param nodes? bw.Array
---@return bw.Array
function Mesh:shapes(nodes) end

---How many elements are inverted at these nodes (or poorer than a floor), and which is the worst:
---{inverted, worst, worst_before}.
---@param nodes bw.Array
---@param floor? number
---@return table
function Mesh:judge(nodes, floor) end

---Moves inner corner nodes whose mask is not 0 until no element is inverted.
---@param nodes bw.Array
---@param mask bw.Array of nodes
---@return bw.Array? nodes
---@return table|string report inverted, worst, worst_before, worst_after, moved, iterations; or a message
---@return table? details
function Mesh:relax(nodes, mask) end

---New tetrahedra in the elements whose mask is not 0, at these nodes; the rest and the boundary stay.
---@param nodes bw.Array
---@param mask bw.Array of elements
---@return bw.Mesh?
---@return bw.Array|string node_from the old node of every node, 0 for new ones; or a message
---@return bw.Array|table element_from the old element of every element; -k in the k-th piece
function Mesh:refill(nodes, mask) end

---@param path string
---@param options? bw.PictureOptions values over nodes or elements
---@return true?
function Mesh:picture(path, options) end

---Lets go at once.
function Mesh:close() end

---A part of a mesh's boundary: facets and nodes. Methods choose within it; an empty choice raises an
---error. `a | b`, `a & b`, `a - b` join, intersect and take away.
---@class bw.Selection
---@field nodes bw.Array numbers of mesh nodes
---@field facets bw.Array numbers of boundary facets
---@field node_count integer
---@field facet_count integer
---@field area number m2
---@field centre bw.Vector
---@field normal bw.Vector mean outward normal
---@field mesh bw.Mesh
---@operator bor(bw.Selection): bw.Selection
---@operator band(bw.Selection): bw.Selection
---@operator sub(bw.Selection): bw.Selection
local Selection = {}

---Coordinates up to a value along an axis.
---@param axis 1|2|3|"x"|"y"|"z"
---@param coordinate number
---@return bw.Selection
function Selection:below(axis, coordinate) end

---Coordinates from a value on.
---@param axis 1|2|3|"x"|"y"|"z"
---@param coordinate number
---@return bw.Selection
function Selection:above(axis, coordinate) end

---@param low bw.Vector
---@param high bw.Vector
---@return bw.Selection
function Selection:box(low, high) end

---Within a tolerance (default a millionth of the box) of a plane.
---@param point bw.Vector
---@param normal bw.Vector
---@param tolerance? number
---@return bw.Selection
function Selection:plane(point, normal, tolerance) end

---On the side of a plane that the normal points to.
---@param point bw.Vector
---@param normal bw.Vector
---@return bw.Selection
function Selection:beyond(point, normal) end

---Within a radius of a point.
---@param point bw.Vector
---@param radius number
---@return bw.Selection
function Selection:near(point, radius) end

---The same as `near`.
---@param centre bw.Vector
---@param radius number
---@return bw.Selection
function Selection:sphere(centre, radius) end

---Facets whose outward normal is within an angle (default 0.001) of a direction.
---@param direction bw.Vector
---@param angle? number radians
---@return bw.Selection
function Selection:facing(direction, angle) end

---What hangs together around a point without an edge sharper than an angle (default 30 degrees).
---@param point bw.Vector
---@param angle? number radians
---@return bw.Selection
function Selection:patch(point, angle) end

---The nodes nearest to a point: a node set.
---@param point bw.Vector
---@param count? integer default 1
---@return bw.Selection
function Selection:nearest(point, count) end

---By a formula in x, y, z, a mask over nodes or facets, or a function of x, y, z. A mask over nodes makes a
---node set.
---@param predicate string|bw.Array|fun(x: number, y: number, z: number): boolean
---@return bw.Selection
function Selection:where(predicate) end

---A face of the mesh's boundary (Surface:faces of `mesh:surface()`), within the selection: by number, by name
---or the nearest to a point. An unknown face raises an error.
---`part:fix(mesh.boundary:face {near = {0, 0, 0}})`
---@param which integer|string|{near: bw.Vector}
---@return bw.Selection
function Selection:face(which) end

---The same facets and nodes as a node set. A support takes a node set that covers no facet, to hold points or
---an edge; it refuses any other selection without a facet.
---`part:fix((boundary:below("x", 0) & boundary:below("y", 0)):node_set())`
---@return bw.Selection
function Selection:node_set() end

---@param other bw.Selection
---@return bw.Selection
function Selection:union(other) end

---@param other bw.Selection
---@return bw.Selection
function Selection:intersection(other) end

---@param other bw.Selection
---@return bw.Selection
function Selection:difference(other) end

---Lets go at once.
function Selection:close() end

-- ---- materials ----------------------------------------------------------------------------------

---`bw.material.steel` and the others of the library by name.
---@class bw.MaterialModule
---@field steel bw.Material
---@field aluminium bw.Material
---@field pla bw.Material
---@field abs bw.Material
---@field resin bw.Material
---@field green_state_stainless_steel bw.Material of the worst-case paper
---@field nylon_pa2200 bw.Material of the worst-case paper
---@field zp150 bw.Material of the worst-case paper: printed plaster, three strengths
local material_module = {}

---Young's modulus and strength in Pa, density in kg/m3, toughness: the fracture toughness K_Ic in Pa m^0.5.
---@param options {young: number, poisson: number, density?: number, strength?: number, toughness?: number, name?: string}
---@return bw.Material?
function material_module.isotropic(options) end

---Nine constants along the material axes 1 2 3: young Y1 Y2 Y3, poisson nu23 nu31 nu12 (or the
---transposed poisson_t nu32 nu13 nu21), shear G23 G31 G12 (left out: the worst-case paper's formula),
---axes as rows of a rotation.
---@param options {young: bw.Vector, poisson?: bw.Vector, poisson_t?: bw.Vector, shear?: bw.Vector, axes?: number[][], density?: number, strength?: bw.Vector, toughness?: number, name?: string}
---@return bw.Material?
function material_module.orthotropic(options) end

---A material of the library.
---@param name string
---@return bw.Material?
function material_module.named(name) end

---The names of the library.
---@return string[]
function material_module.names() end

---A linear elastic law. Constants are numbers where it is isotropic, else tables of three.
---@class bw.Material
---@field name string
---@field isotropic boolean
---@field young number|bw.Vector Pa
---@field poisson number|bw.Vector
---@field shear number|bw.Vector Pa
---@field density number? kg/m3
---@field strength number|bw.Vector|nil Pa
---@field toughness number? fracture toughness K_Ic, Pa m^0.5; nil where no published value fits the material
---@field critical_distance number? m: (toughness / strength)^2 / pi, by the largest strength
---@field axes bw.Array 3 x 3, rows are the material axes
---@field turned boolean whether axes differ from element to element (an edit session's, with material_turns); `axes` and `elasticity` are then those before
---@field elasticity bw.Array 6 x 6, Pa
---@field sources table<string, {mean: number, scatter: number?, source: string?}> where values come from and their standard deviations: young_1, poisson_12, strength_1, ..., density, toughness, critical_distance
local Material = {}

---Turned by a rotation, three rows of three.
---@param rotation number[][]
---@return bw.Material?
function Material:rotated(rotation) end

---Tensile strength along a direction; nil when not known.
---@param direction bw.Vector
---@return number?
function Material:strength_along(direction) end

---Stress over strength, the largest over the principal stresses, of rows of stress tensors. Of a
---material turned by element: of the stresses of all elements.
---@param stress bw.Array
---@return bw.Array?
function Material:utilisation(stress) end

---Lets go at once.
function Material:close() end

-- ---- models -------------------------------------------------------------------------------------

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
---@param options {on?: bw.Selection, force?: bw.Vector, traction?: bw.Vector, pressure?: number, torque?: bw.Vector, about?: bw.Vector, net_force?: boolean, nodal?: bw.Array}
---@return bw.Model
function Model:load(options) end

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
---@param options? {surface?: bw.Surface, angle?: number}
---@return bw.SingularPlaces?
---@return string? message
---@return table? details
function Model:singular_places(options) end

---The rigid motions that the supports leave: {component, centre, translation, rotation, text}.
---@return table[]?
function Model:free_motions() end

---Static solution. A load that is not balanced on a free body is refused, unless inertia relief is
---asked for. So are a body whose whole boundary is fixed at zero and a load that acts on supports only; a load of
---which at least 5 % of the area lies on supports is a remark with the share. with "auto" (default): by a factor, or over levels where that counts as much cheaper or the
---factor would take more than 4 GB or more than memory_limit bytes (what is free); "factor": a sparse factor, which other
---loads, modes and the worst case then use; "levels": conjugate gradients over linear and quadratic elements without
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
---@param options? {inertia_relief?: boolean, tolerance?: number, with?: "auto"|"factor"|"levels"|"petsc", memory_limit?: number, iterations?: integer, method?: "auto"|"cg"|"cholesky", rtol?: number, error?: number, of?: string|bw.Vector|table|bw.Selection|(fun(static: bw.Static): number), most_elements?: integer, time_limit?: number, surface?: bw.Surface}
---@return bw.Static?
---@return bw.Accuracy|string? accuracy with `error`, else the message
---@return table? details
function Model:solve(options) end

---The same supports and loads on a mesh with element e bisected levels[e] times (three halve its edges), and
---neighbours as it needs to conform. Facets of supports and loads are those inside of the facets before; fields at
---nodes are interpolated. order 2 raises linear elements; `surface`: as of mesh:curved; `also`: further selections to
---carry. More than most_elements: nil, a message and details. Not for materials turned by element.
---`local fine = assert(part:refined(levels))`
---@param levels bw.Array|table whole numbers from 0 to 30
---@param options? {order?: 1|2, surface?: bw.Surface, also?: bw.Selection[], most_elements?: integer}
---@return bw.Model?
---@return bw.Selection[]|string also those of `also`, or a message
---@return table? details
function Model:refined(levels, options) end

---The lowest modes, elastic or of the Laplacian. with "slepc": elastic ones by SLEPc on all processes that
---mpirun started (docs/howto_cluster.md), method "cholesky" (default: MUMPS, and a count that none is
---missing) or "cg" (conjugate gradients inside, no count).
---With `error`: on tet10 meshes refined until the estimated relative error of every frequency is at most that. The
---second result tells how it went; `history` has the frequencies of every mesh. Limits as of part:solve.
---`local modes, accuracy = part:modes {count = 5, error = 0.001}`
---@param options? {error?: number, most_elements?: integer, time_limit?: number, surface?: bw.Surface, count?: integer, tolerance?: number, sturm?: boolean, seed?: integer, laplacian?: boolean, with?: "factor"|"slepc", method?: "auto"|"cg"|"cholesky", rtol?: number, iterations?: integer}
---@return bw.Modes?
---@return bw.Accuracy|string? accuracy with `error`, else the message
---@return table? details
function Model:modes(options) end

---The equations with their factor.
---@return bw.System?
---@return string? message
---@return table? details
function Model:system() end

---The same supports and loads on a mesh of the same topology: they go with the surface.
---@param mesh bw.Mesh
---@return bw.Model?
---@return string? message
---@return table? details
function Model:moved(mesh) end

---The same on a refilled mesh; `node_from` has the old node of every node, 0 for new ones.
---@param mesh bw.Mesh
---@param node_from bw.Array
---@return bw.Model?
---@return string? message
---@return table? details
function Model:transferred(mesh, node_from) end

---As an .inp for CalculiX; modes > 0: a frequency step. Forces are nodal; gravity and temperatures are
---written as such (one coefficient of expansion, the largest; temperatures are scaled to it).
---@param path string
---@param options? {modes: integer}
---@return true?
---@return string? message
---@return table? details
function Model:write_inp(path, options) end

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

---Why the largest stress has no finite value; `print(finding)` says it in a sentence.
---@class bw.SingularFinding
---@field by "geometry"|"growth"|"geometry and growth" a place that is known to be singular, or growth under refinement
---@field place? bw.SingularPlace
---@field at number[] m: of the place, or where the stress is largest
---@field expected? number by Williams' exponent the stress grows like h^-expected with the edge length h
---@field measured? number the growth from the last mesh but one to the last

---A static solution. Fields are computed when they are first asked for. Names without `element_` are
---over nodes.
---@class bw.Static
---@field displacement bw.Array m
---@field force bw.Array applied, N
---@field reaction bw.Array at held nodes, N
---@field stress bw.Array node_count x 6, Pa
---@field von_mises bw.Array
---@field principal bw.Array descending
---@field principal_directions bw.Array node_count x 9: rows of unit vectors
---@field max_principal bw.Array largest in size
---@field element_stress bw.Array element_count x 6, Pa
---@field element_von_mises bw.Array
---@field element_principal bw.Array
---@field element_max_principal bw.Array
---@field element_energy bw.Array J
---@field utilisation bw.Array stress over strength, of elements
---@field energy number strain energy, J
---@field residual number |K u - f| / |f|
---@field locking string? as of bw.Model
---@field mesh bw.Mesh
---@field material bw.Material
---@field times table? seconds of graph, stiffness, order, factor, levels, solve; factor_entries, factor_flops; nil in an edit session and of PETSc
---@field solver table? with ("factor", "levels"), iterations (over levels), residual, factor_bytes and factor_flops (over levels: as foreseen), coarse_unknowns (of the linear elements), and where a choice was made predicted_factor and predicted_levels (s, of the model's machine); of PETSc: with, method, ranks, iterations, send_seconds, setup_seconds, solve_seconds, processor_seconds and peak_bytes of all ranks, largest_rank_bytes; nil in an edit session
---@field reused table? in an edit session: pattern, ordering, pieces, pieces_kept, pieces_turned, pieces_touched, method, factor_kept, iterations, precision (of the factor, bits: 32 or 64), refinements (iterations that a factor of 32 bits took), predicted_refactor, predicted_iterate, predicted_levels, seconds_unknowns, seconds_stiffness, seconds_factor, seconds_solve, mesh, and with `check` difference_stiffness, difference_solution
local Static = {}

---Zienkiewicz-Zhu: relative error of the whole body in the energy norm, and the error energy of every element. It is
---a mean: the largest stress may be off by more, and facets that stand for a round face are not in it. The error
---of one quantity is that of `part:solve {error = , of = }`.
---@return number? relative
---@return bw.Array elements
function Static:error_estimate() end

---The sum of the reactions on a selection, N.
---@param selection bw.Selection
---@return bw.Vector
function Static:reaction_on(selection) end

---The effective stress of the theory of critical distances at singular edges, the largest first: the mean of the
---stress over 2 L from the edge along the bisector ("line"), or the stress at L / 2 ("point"). It converges where the
---largest stress does not. length: L in m (default: the material's critical_distance); places: those to look at
---(default: the re-entrant edges of the mesh's boundary). Of every place the station of the largest value counts:
---value (largest principal, Pa), stress (the tensor), utilisation, at, estimated_error (relative), edge_length (of the
---elements there, m). nil, a message and details where the length is not known or no line stays in the body.
---`static:effective_stress {places = part:singular_places(), length = 1e-3}`
---@param options? {places?: bw.SingularPlaces, length?: number, method?: "line"|"point"}
---@return {place: bw.SingularPlace, number: integer, at: number[], value: number, stress: number[], utilisation: number?, length: number, method: string, edge_length: number, estimated_error: number}[]?
---@return string? message
---@return table? details
function Static:effective_stress(options) end

---The notch stress intensity factor K of singular edges, the largest first: the normal stress across the bisector is
---K / sqrt(2 pi) r^(exponent - 1) at small distances r. value in Pa m^(1 - exponent). shear: that of the shear stress on
---the bisector, with its own exponent; radial: the stress along the bisector over that across it.
---@param options? {places?: bw.SingularPlaces}
---@return {place: bw.SingularPlace, number: integer, at: number[], value: number, exponent: number, shear: number, shear_exponent: number, radial: number, edge_length: number, estimated_error: number}[]?
---@return string? message
---@return table? details
function Static:notch_stress_intensity(options) end

---The largest stress that re-entrant edges would have with a fillet of a radius (m), the largest first, from their
---notch stress intensity factors. For radii that are small beside the notch (docs/theory/singular.md). estimated_error
---(relative): that of the factor, and 0.1 for the formula.
---`print(static:fillet_stress({radius = 1e-3})[1].value)`
---@param options {radius: number, places?: bw.SingularPlaces}
---@return {place: bw.SingularPlace, number: integer, at: number[], value: number, intensity: number, radius: number, estimated_error: number}[]?
---@return string? message
---@return table? details
function Static:fillet_stress(options) end

---Displacement and stresses as .vtu, with further fields.
---@param path string
---@param options? {fields: table<string, bw.Array>}
---@return true?
---@return string? message
---@return table? details
function Static:write(path, options) end

---The deformed shape coloured by a field: "von_mises" (default), "max_principal", "displacement",
---"utilisation", ..., or an array over nodes or elements.
---@param path string
---@param options? bw.PictureOptions with `field`
---@return true?
function Static:picture(path, options) end

---Lets go at once.
function Static:close() end

---Modes of vibration, ascending; or of the Laplacian (components 1). `#modes` is their number.
---@class bw.Modes
---@field count integer
---@field components integer
---@field eigenvalues bw.Array (rad/s)^2; 1/m2 for the Laplacian
---@field frequencies bw.Array? Hz
---@field residuals bw.Array
---@field rigid_count integer rigid motions recognised and left out
---@field solves integer
---@field recovered integer found only after the Sturm count called for them
---@field counted boolean the Sturm count confirmed that none is missing
---@field mesh bw.Mesh
---@field solver table? of SLEPc: as bw.Static's; nil for the engine's own
local Modes = {}

---The i-th shape, a row for every node, of unit modal mass.
---@param i integer
---@return bw.Array
function Modes:shape(i) end

---By how many cents each frequency is too high: the recovered stress of the shape gives its error in energy, whose
---square is that of the eigenvalue (docs/theory/error_control.md). Not for Laplacian modes.
---`print(modes.frequencies[1], "Hz, too high by", modes:error_estimate()[1], "cents")`
---@return bw.Array? cents
---@return string? message
---@return table? details
function Modes:error_estimate() end

---All shapes as .vtu.
---@param path string
---@param options? table
---@return true?
function Modes:write(path, options) end

---@param i integer
---@param path string
---@param options? bw.PictureOptions
---@return true?
function Modes:picture(i, path, options) end

---Lets go at once.
function Modes:close() end

---The equations of a body and their factor.
---@class bw.System
---@field times table
---@field unknown_count integer
---@field motion_count integer free rigid motions
local System = {}

---Displacement under nodal forces; on a free body the force is balanced by inertia first. A list of forces is solved
---in one block, which is faster, and gives the list of displacements.
---@param force bw.Array|bw.Array[] N: a row of three for every node
---@return bw.Array|bw.Array[]|nil
---@return string? message
---@return table? details
function System:solve(force) end

---The lowest elastic modes, by the system's own factor: see bw.Model:modes.
---@param options? {count: integer, tolerance: number, sturm: boolean, seed: integer}
---@return bw.Modes?
---@return string? message
---@return table? details
function System:modes(options) end

---Lets go at once.
function System:close() end

-- ---- the worst case -----------------------------------------------------------------------------

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
---@return table? details
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
---@return table? details
function WorstCase:write(path) end

---The weakness map with the arrows of the worst load; with {region = i} the stress under that load.
---@param path string
---@param options? bw.PictureOptions
---@return true?
function WorstCase:picture(path, options) end

---One HTML file with a 3D view that turns; needs no network. The load of `region` is shown first (default: that of
---the largest stress); `answer` replaces the sentence above the view.
---@param path string
---@param options? {title: string, manifest: table, loads: integer, modes: integer, lines: (bw.Array|bw.Vector[])[], line_name: string, view: bw.Vector, answer: string, region: integer}
---@return true?
---@return string? message
---@return table? details
function WorstCase:report(path, options) end

---Lets go at once.
function WorstCase:close() end

---Weak regions of modes. `#regions`, `regions[i]` {mode, rank, count, volume, energy, peak}.
---@class bw.WeakRegions
---@field count integer
---@field mesh bw.Mesh
local WeakRegions = {}

---@param i integer
---@return bw.Array
function WeakRegions:elements(i) end

---@param i integer
---@return bw.Array
function WeakRegions:weights(i) end

---Forces whose displacement q gives the region's objective, basis:gradient(q): (15) of the paper.
---@param i integer
---@param material bw.Material
---@return bw.Array?
function WeakRegions:objective(i, material) end

---Lets go at once.
function WeakRegions:close() end

---Pressures at boundary corner nodes, linear over facets, or constant on cells of facets.
---@class bw.PressureBasis
---@field nodes bw.Array mesh node of each pressure; of a cell, the node of its facet nearest to its middle
---@field areas bw.Array m2
---@field count integer columns
---@field directions integer columns of a node, one after the other: 1 without friction
local PressureBasis = {}

---Nodal forces of a pressure.
---@param pressure bw.Array
---@return bw.Array
function PressureBasis:force(pressure) end

---The change of the work of the forces on displacements q with each pressure.
---@param q bw.Array
---@return bw.Array
function PressureBasis:gradient(q) end

---The pressure of an allowed load (0 to `pressure`, total `force`, balanced) that makes
---objective . pressure largest, and that value.
---@param system bw.System
---@param objective bw.Array
---@param options {pressure: number, force: number, at_most?: boolean, hands?: integer, hand_area?: number}
---@return bw.Array? pressure
---@return number|string value or message
---@return table? details
function PressureBasis:maximise(system, objective, options) end

---The pressure at every mesh node: the sum of its columns; where it stands for several cells, their mean by area; 0
---where it has none.
---@param pressure bw.Array
---@return bw.Array
function PressureBasis:nodal(pressure) end

---The forces of a pressure summed into a few arrows {at, force, area}, largest first.
---@param pressure bw.Array
---@param radius? number
---@return table[]?
function PressureBasis:arrows(pressure, radius) end

---Lets go at once.
function PressureBasis:close() end

---@class bw.BruteForce
---@field weakness bw.Array of every element, Pa
---@field peaks bw.Array of every region tried
---@field max_principal number
---@field element integer
---@field elements integer how many were tried
---@field seconds number
---@field mesh bw.Mesh
---@field options table
local BruteForce = {}

---A percentile of the weakness map by volume; default 99.75.
---@param p? number
---@return number
function BruteForce:percentile(p) end

---Beside a worst case: {worst_case, brute_force, ratio}.
---@param worst bw.WorstCase
---@param p? number
---@return table
function BruteForce:compare(worst, p) end

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
---@field held_area number? m2: with `hold`, on the last mesh
---@field forbidden_area number? m2: with `forbidden`
---@field length number m: radius of the patch
---@field failure string
---@field worst bw.WorstCase on the last mesh, under `reference` N
---@field reference number N
---@field material bw.Material
---@field mesh bw.Mesh the last one
---@field surface? bw.Surface
---@field given_mesh? bw.Mesh
---@field near? {at: bw.Vector, radius: number, length: number}[] edge lengths near places of the last mesh, m
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
---print(assert(breaking:advice {force = 50}))
---```
---@param options {force: number, estimate?: number, keep?: (fun(x: number, y: number, z: number): boolean), most_offset?: number}
---@return bw.Advice?
---@return string? message
---@return table? details
function BreakingForce:advice(options) end

---Releases the factor and the modes of the last mesh.
function BreakingForce:close() end

---What to thicken; print tells it in sentences.
---@class bw.Advice
---@field required number N: the force that was asked for
---@field places {at: bw.Vector, radius: number, offset: number}[] m: displace the surface outwards by offset around at, up to radius; weakest first, empty where nothing needs or helps. Where places overlap, the surface moves by the largest offset there at most
---@field force number N: the predicted breaking force
---@field low number N: the lower end of its interval
---@field high number N: the upper end

---A surface and what was added to it; print tells it in one line.
---@class bw.Strengthened
---@field surface bw.Surface the thickened surface
---@field original bw.Surface what it was made from: the given one, repaired where it had to be
---@field reached boolean whether the lower end of the interval is at least the force
---@field stopped? string why the steps ended early
---@field before table {force, low, high, at, estimated_error, singular, contact, volume, mass}: the breaking force (N) of the given surface, with volume (m3) and mass (kg)
---@field after table the same of the thickened one
---@field steps table[] {places, offset, predicted, force, low, high}
---@field added_volume number m3
---@field repaired? boolean
---@field length number m: radius of the judged patch
---@field breaking bw.BreakingForce the analysis of the surface, closed
---@field options table
---@field seconds number

---@class bw.DropTest
---@field exceedance bw.Array of every element: fraction of drops beyond the strength
---@field mean_peak bw.Array of every element: mean largest principal stress, Pa
---@field contacts bw.Array drops x 3, m
---@field pushes bw.Array drops x 3: unit vectors along the peg's normal, in which the impulse acts on the body
---@field resultants bw.Array drops x 3, N: sums of the nodal forces
---@field nodes bw.Array drops: how many nodes carry the contact
---@field forces bw.Array N
---@field areas bw.Array m2: of the contact of each drop, seen along its force
---@field peaks bw.Array largest stress of every drop, Pa
---@field threshold number Pa, where no strength is known
---@field drops integer
---@field seconds number
---@field mesh bw.Mesh
---@field options table
local DropTest = {}

---Rank correlation, by volume, with a weakness map (a worst case, a brute force, an array).
---@param other bw.WorstCase|bw.BruteForce|bw.Array
---@return number?
function DropTest:correlation(other) end

---The fraction of drops that overload the weakest place.
---@return number
function DropTest:failures() end

---@param path string
---@return true?
function DropTest:write(path) end

---@param path string
---@param options? bw.PictureOptions
---@return true?
function DropTest:picture(path, options) end

-- ---- outlines in the plane ----------------------------------------------------------------------

---Outlines. Called: `bw.outline{points = loop, holes = {loops}, regions = {loops}}`, or with a loop
---alone. A loop is a list: {x, y} is a vertex that a line leads to, {{x, y}, {x, y}, {x, y}} one that
---a cubic Bézier curve leads to, with its two control points first; the first entry's line or curve
---comes from the last vertex. Beside its entries a loop may have `name`, `tag` (of its edges; default:
---its name, else "boundary"), `tags` ({name = edge numbers}) and `region` (a number from 1). A hole or
---a region may also be an outline of one loop. Edge n leads from vertex n to the next one; edges and
---vertices are numbered through all loops. Outer loops run counter-clockwise and holes clockwise: a
---list given the other way is turned, and begins at the same point.
---Whatever makes an outline returns nil, message, details when it would cross or touch itself
---(details: segment, other_segment, x, y), and the outline that was there stays as it was.
---@class bw.OutlineModule
local outline_module = {}

---Edges: 1 below, 2 right, 3 above, 4 left; with rounded corners each arc is two edges of its own.
---@param options {low?: number[], high?: number[], width?: number, height?: number, centre?: number[], radius?: number, name?: string, tag?: string, tags?: table, holes?: table, regions?: table}
---@return bw.Outline?
---@return string? message
---@return table? details
function outline_module.rectangle(options) end

---Eight curves, off the circle by 4e-6 radii at most.
---@param options {radius: number, centre?: number[], name?: string, tag?: string, tags?: table, holes?: table, regions?: table}
---@return bw.Outline?
---@return string? message
---@return table? details
function outline_module.circle(options) end

---@param options {radii: number[], centre?: number[], angle?: number, name?: string, tag?: string, tags?: table, holes?: table, regions?: table} angle in degrees
---@return bw.Outline?
---@return string? message
---@return table? details
function outline_module.ellipse(options) end

---@param options table {points = {{x, y}, ...}, name, tag, tags, holes, regions}, or the list of points
---@return bw.Outline?
---@return string? message
---@return table? details
function outline_module.polygon(options) end

---A polygon whose corners are arcs. Edges are numbered as they come: the arc of corner 1, the edge
---behind it, the arc of corner 2, ...
---@param options table {points = {{x, y}, ...}, radius = one, or a list of one for each corner, name, tag, tags, holes, regions}
---@return bw.Outline?
---@return string? message
---@return table? details
function outline_module.rounded(options) end

---Reads an SVG or DXF drawing: closed curves, and open ones that close when put together. Loops inside
---an even number of others are material (region 1), the rest holes. Names are the id (SVG), tags the
---class (SVG) or layer (DXF). `unit`: "mm", ... or metres per unit, left out: what the file says;
---`tolerance`: how far apart ends may lie that belong together, left out: 1e-5 of the size.
---@param path string
---@param options? {unit?: string|number, tolerance?: number}
---@return bw.Outline?
---@return table|string info {format, skipped}, or the message
---@return table? details
function outline_module.read(path, options) end

---A shape in the plane with holes and regions, bounded by lines and cubic curves; never changed: what
---changes it gives a new one, or nil, message, details.
---@class bw.Outline
---@field area number m2, of the material: without holes
---@field perimeter number m, of the material; boundaries between regions not counted
---@field centroid number[]
---@field second_moment table {xx = integral of y^2, yy = of x^2, xy} about the centroid, m4
---@field box table {low, high}
---@field area_gradient bw.Array of every point: how the area grows with x and y
---@field points bw.Array x, y of vertices and control points, m
---@field vertices bw.Array x, y of the vertices in the order of their edges
---@field segments bw.Array of every edge: start, first control, second control, end (rows of points; controls 0 for a line), tag
---@field loops table[] {name, hole, region, first, count, parent}: `first` is its first edge
---@field tags string[]
---@field edge_count integer
---@field region_count integer
local Outline = {}

---Writes it for cutters, in millimetres: .svg or .dxf (AutoCAD 2000; layers are tags). SVG comes back
---with names, regions and tags, both with the same curves.
---@param path string
---@return true?
---@return string? message
---@return table? details
function Outline:write(path) end

---A picture as PNG: regions, edges coloured by tag, with `numbers` those of the edges.
---@param path string
---@param options? {width?: integer, height?: integer, numbers?: boolean} 1200 x 900
---@return true?
---@return string? message
---@return table? details
function Outline:picture(path, options) end

---Moves a handle: {vertex = n} (with the control points beside it), {edge = n}, {loop = name} with the
---loops inside it, or {edge = n, control = 1 or 2}: a control point alone. With a loop beside them,
---vertex and edge count from that loop's first.
---@param handle {vertex?: integer, edge?: integer, loop?: string|integer, control?: integer}
---@param by number[]
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:moved(handle, by) end

---How far each point goes with a handle, 0 to 1.
---@param handle {vertex?: integer, edge?: integer, loop?: string|integer, control?: integer}
---@return bw.Array
function Outline:weights(handle) end

---The same edges with other points, rows as in `points`.
---@param points bw.Array|table
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:with_points(points) end

---Whether one was made from the other by moving points.
---@param other bw.Outline
---@return boolean
function Outline:same_topology(other) end

---A hole more.
---@param loop table|bw.Outline a loop as a list, or an outline of one loop
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:hole(loop) end

---A region more: a new one, or that of the loop's `region`.
---@param loop table|bw.Outline
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:region(loop) end

---A loop more, as the engine takes it: points, rows of `segments` from 1, {count, region (0: a hole), name}.
---@param points table|bw.Array
---@param segments table|bw.Array
---@param loop {count: integer, region: integer, name?: string}
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:with_loop(points, segments, loop) end

---Without a loop and all that lies in it.
---@param loop string|integer
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:without(loop) end

---Laplacian smoothing of one loop or all: every point goes `strength` (0.5) of the way to the middle
---of its neighbours, `rounds` (1) times. Corners of more than `corner` (30) degrees stay.
---@param options? {loop?: string|integer, strength?: number, rounds?: integer, corner?: number}
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:smooth(options) end

---Pulls a vertex to a place. Pinned vertices stay, and the curve between, up to the first vertex
---`reach` away along it, follows as rigidly as possible (Igarashi 2005). Without pins and reach the
---loop moves as a whole; about a single pin it turns.
---@param vertex integer
---@param to number[]
---@param options? {pins?: integer[], reach?: number}
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:pull(vertex, to, options) end

---An edge cut in two at t, 0 to 1.
---@param edge integer
---@param t? number default 0.5
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:split(edge, t) end

---A vertex taken out: one edge remains of the two.
---@param vertex integer
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:join(vertex) end

---The numbers of edges: {edges = numbers}, {near = {x, y}, radius = r} (without a radius: the nearest),
---{box = {{x, y}, {x, y}}} (wholly inside), {loop = name}, a number, or a list. None raises.
---@param which table|integer
---@return integer[]
function Outline:edges(which) end

---A tag on the edges that `edges` finds.
---@param name string
---@param which table|integer
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:tag(name, which) end

---A tag on edges by number.
---@param name string
---@param edges integer[]
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:with_tag(name, edges) end

---Moved as a whole.
---@param by number[]
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:shifted(by) end

---Turned by degrees, counter-clockwise, about a point, left out: the centroid.
---@param degrees number
---@param about? number[]
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:turned(degrees, about) end

---Scaled by a factor, or by {fx, fy}, about a point, left out: the centroid.
---@param factor number|number[]
---@param about? number[]
---@return bw.Outline?
---@return string? message
---@return table? details
function Outline:scaled(factor, about) end

---{area, perimeter, centroid, second_moment, box} of a region, left out: of all the material. The
---perimeter of a region counts its boundaries with others.
---@param region? integer
---@return table
function Outline:measure(region) end

---A loop as a list that bw.outline takes, with name, region (none: a hole) and tags.
---@param loop string|integer
---@return table
function Outline:loop(loop) end

---{tag, loop, from, to, control (of a curve), length, box}.
---@param edge integer
---@return table
function Outline:edge(edge) end

---The place at t, 0 to 1, of an edge, and its derivative by t.
---@param edge integer
---@param t number
---@return number[] place
---@return number[] derivative
function Outline:at(edge, t) end

---The nearest place: {edge, t, distance, at, loop, vertex (the nearer end of the edge)}.
---@param at number[]
---@return table
function Outline:nearest(at) end

---How far an edge is from a point.
---@param edge integer
---@param at number[]
---@return number
function Outline:edge_distance(edge, at) end

---The loops as polygons, one array of points each, nowhere farther than the tolerance from the curves.
---@param tolerance? number default: 1e-4 of the size
---@return bw.Array[]?
---@return string? message
---@return table? details
function Outline:polygons(tolerance) end

---Releases it at once.
function Outline:close() end

-- ---- skeletons and poses ------------------------------------------------------------------------

---@class bw.SkeletonModule
local skeleton_module = {}

---From joints and bones. Joints are {name = {x, y, z}, ...} or a list {{x, y, z, name = "hip"}, ...};
---bones {{"hip", "knee", name = "thigh"}, ...}, joints by name or number, either way round. `root` is a
---joint; left out: the one in the middle. Every joint is reached by one chain of bones.
---@param options {joints: table, bones: table, root?: string|integer}
---@return bw.Skeleton
function skeleton_module.create(options) end

---The curve skeleton of a closed surface as joints and bones. `bones`: wanted number (0: as many as
---branches and bends ask for); `prune`: branches that reach no farther than this many local radii
---out of their junction are left out (1.5); `bend`: how far, in local radii, a bone strays from the
---curve (0.5); `minutes`: the most it may take (5).
---@param surface bw.Surface
---@param options? {bones: integer, prune: number, bend: number, minutes: number}
---@return bw.Skeleton?
---@return string? message
---@return table? details
function skeleton_module.extract(surface, options) end

---Reads a TGF file: "number x y z [name]" for every joint, "#", "from to [name]" for every bone.
---Without a unit: millimetres.
---@param path string
---@param options? {unit: string|number}
---@return bw.Skeleton?
---@return string? message
---@return table? details
function skeleton_module.read(path, options) end

---A tree of joints joined by bones; never changed: what changes it gives a new one. A bone runs from
---its head, nearer the root, to its tail. Bones and joints are called by name, or by number.
---@class bw.Skeleton
---@field joints bw.Array x, y, z of every joint, m
---@field bones bw.Array head and tail of every bone: numbers of joints
---@field joint_names string[]
---@field bone_names string[]
---@field parents bw.Array of every bone: the bone it hangs on, 0 for one at the root
---@field frames bw.Array of every bone: its axes as three rows, x along the bone
---@field root string
---@field joint_count integer
---@field bone_count integer
local Skeleton = {}

---A joint: {index, name, at, bones}.
---@param joint string|integer
---@return table
function Skeleton:joint(joint) end

---A bone: {index, name, head, tail, from, to, length, parent, children}.
---@param bone string|integer
---@return table
function Skeleton:bone(bone) end

---Writes a TGF file; without a unit: millimetres.
---@param path string
---@param options? {unit: string|number}
---@return true?
---@return string? message
---@return table? details
function Skeleton:write(path, options) end

---A joint on a bone, at a fraction of its length from the head; the bone keeps its name on the side
---of its head.
---@param bone string|integer
---@param fraction number
---@param name? string
---@return bw.Skeleton
function Skeleton:insert_joint(bone, fraction, name) end

---@param joint string|integer
---@param at bw.Vector
---@return bw.Skeleton
function Skeleton:move_joint(joint, at) end

---Two bones that meet at a joint of no other bone become one, with the name of the first.
---@param first string|integer
---@param second string|integer
---@return bw.Skeleton
function Skeleton:merge(first, second) end

---Leaves out a bone and all below it.
---@param bone string|integer
---@return bw.Skeleton
function Skeleton:remove(bone) end

---@param joint string|integer
---@return bw.Skeleton
function Skeleton:with_root(joint) end

function Skeleton:close() end

---A pose with every bone at rest: a row of 15 for every bone, its rotation by rows, the scale along its
---axes, the translation of its head.
---@return bw.Array
function Skeleton:rest_pose() end

---Forward kinematics: rows of 12, [A | b], that take the part from rest to the pose, and the rotations
---in A as rows of 9.
---@param pose bw.Array|table
---@return bw.Array? maps
---@return bw.Array rotations
function Skeleton:pose_maps(pose) end

---Where the joints are under maps of the bones.
---@param maps bw.Array|table
---@return bw.Array
function Skeleton:posed_joints(maps) end

---Inverse kinematics: the pose that brings all targets {bone, at, along, weight, from} as near as
---limits allow. `limits` has {swing, twist_low, twist_high} in radians, or false, for every bone.
---@param pose bw.Array|table
---@param targets table[]
---@param limits? table
---@param tolerance? number m
---@return bw.Array? pose
---@return table report distance, iterations, reached
function Skeleton:reach(pose, targets, limits, tolerance) end

---A mesh cut into domains along a skeleton: those of type R follow one bone, those of type F are
---blended between several. `domains[i]` is a table {index, type, bone, bones, elements, adjacent}.
---@class bw.Domains
---@field count integer
---@field rigid_count integer how many follow one bone; these come first
---@field mesh bw.Mesh at rest
---@field skeleton bw.Skeleton
---@field element_domain bw.Array of every element
---@field node_domain bw.Array of every node: the one it goes with
---@field interface bw.Array mask: nodes where elements of several domains meet
---@field piece_count integer domains are cut into pieces for the equations: elements joined through faces that follow the same bones
---@field piece_bones integer[][] the numbers of the bones that each piece follows
---@field element_piece bw.Array of every element
---@field node_piece bw.Array of every node: the one whose frame it goes with
local Domains = {}

---Elements given to a bone's domain, or (without a bone) taken out of those that follow one: new
---domains. An element by which a domain would fall apart, or touch another bone's, is named.
---@param elements bw.Array|integer[]
---@param bone? string|integer
---@return bw.Domains
function Domains:assign(elements, bone) end

---The domains on what `mesh:refill` made of the shape of these maps: the mesh, node_from and
---element_from. `mask` has the elements that were replaced, which are whole blended domains.
---@param maps bw.Array|table
---@param mask bw.Array of elements
---@param mesh bw.Mesh
---@param node_from bw.Array
---@param element_from bw.Array
---@return bw.Domains?
---@return string? message
---@return table? details
function Domains:refilled(maps, mask, mesh, node_from, element_from) end

---The domains with an element that has a node whose mask is not 0.
---@param mask bw.Array
---@return integer[]
function Domains:touched(mask) end

---The pieces with an element that has a node whose mask is not 0.
---@param mask bw.Array
---@return integer[]
function Domains:pieces_touched(mask) end

---Where the nodes are under maps of the bones: corners blended, middle nodes half-way.
---@param maps bw.Array|table
---@return bw.Array?
function Domains:posed_nodes(maps) end

---How every node moves with the scale of a bone along one of its axes.
---@param pose bw.Array|table
---@param bone string|integer
---@param axis integer|"x"|"y"|"z"
---@return bw.Array?
function Domains:pose_derivative(pose, bone, axis) end

---How every piece lies against rest: rows of 19, the linear map, the frame, and 1 where it was
---reshaped.
---@param maps bw.Array|table
---@param rotations bw.Array|table
---@return bw.Array?
function Domains:motion(maps, rotations) end

function Domains:close() end

-- ---- edit sessions ------------------------------------------------------------------------------

---@class bw.EditModule
---@overload fun(part: bw.Model, options?: bw.EditOptions): bw.Session?, string?, table?
---@field class table the methods of sessions
---@field properties table the properties of sessions
local edit_module = {}

---Replays a script of edits, into a session or into the one that the script makes. A line that was
---cut off at the end of a journal is passed over. {resume = true}: the file goes on as the journal.
---@param path string
---@param session? bw.Session
---@param options? {resume: boolean}
---@return bw.Session?
---@return boolean|string cut whether a line was cut off; or a message
---@return table? details
function edit_module.load(path, session, options) end

---What a saved script begins with: the session it is replayed into, or a new one on the part (and the
---options) that the file `script` returns.
---@param script? string
---@param session? bw.Session
---@return bw.Session
function edit_module.begin(script, session) end

---@class bw.EditOptions
---@field skeleton? bw.Skeleton left out: extracted from the part's surface
---@field bones? integer wanted of the extracted skeleton; 0 (default): as many as the shape asks for
---@field threshold? number mean weight from which an element follows one bone; default 0.95
---@field thresholds? table<string, number> instead of it, for single bones
---@field share? number the threshold is lowered until each bone has this share of the elements that it moves most; default 0.35, 0: never
---@field heat? number of the skinning weights; default 20; larger: more elements follow one bone
---@field domains? bw.Domains ready-made ones, of the part's own mesh
---@field quality? number elements poorer than this (mean ratio, 1: regular) are relaxed; default 0.02
---@field relax? boolean relax inner nodes where an edit inverts elements; default true
---@field refill? boolean refill domains where that fails; default true
---@field material_turns? boolean an orthotropic material's axes turn with the bones; default false: they stay, as where the edited shape is printed the same way up
---@field journal? string a script that every edit is added to at once; an older journal becomes path~, any other file there is refused
---@field script? string a file that returns the part and these options, named by saved scripts

---@class bw.OptimiseOptions
---@field von_mises number the limit, Pa
---@field bones? string[] these bones; left out: those of domains with stresses above the limit, and those next to blended domains with such stresses
---@field keep? (string|bw.Selection)[] bones that stay as they are, by name; and selections on the session's original mesh (faces, places) that do not move: no bone is scaled in a direction that would move a node of them
---@field move_supports? boolean let scaled bones move the supports too; default false: as for selections that are kept, in the directions that a support holds
---@field ties? string[][] lists of bones that change by the same factors
---@field low? number least factor since rest; default 0.5
---@field high? number largest factor since rest; default 3
---@field cases? bw.Model[] further load cases: parts on the session's original mesh, with the same supports
---@field loads? "own"|"worst" "worst": the worst load of a part without supports, found again after each round
---@field worst? bw.WorstCaseOptions of finding the worst load
---@field rounds? integer of finding the worst load, at most; default 8
---@field change? number a worst load whose stress is above the limit by no more than this fraction is the last; default 0.02
---@field iterations? integer steps, at most; default 40
---@field tolerance? number relative change of the change of shape at which to stop; default 1e-4
---@field refills? integer how often domains may be filled again where the mesh stops steps; default 3
---@field step? number largest relative change of a factor in the first step; default 0.5
---@field inertia_relief? boolean see bw.Session:solve; with loads = "worst" by default

---What a scaling optimisation found. Prints as a few lines.
---@class bw.Optimisation
---@field met boolean whether no stress is above the limit
---@field von_mises number the largest, Pa
---@field node integer where
---@field case integer under which load: 1 the session's own (unless loads = "worst"), then `cases`, then worst loads
---@field from number the largest before, Pa
---@field limit number
---@field factors table<string, number[]> of the bones that were free to change, since rest
---@field change number m2: the sum over the corner nodes of the squares of their moves
---@field mean_move number m: root mean square
---@field iterations integer steps taken
---@field unknowns integer factors that were free
---@field constrained integer
---@field nodes table[] the constrained nodes: {node, case, von_mises}
---@field history table[] after each step: {max, node, case, change, constrained, unknowns}
---@field rounds? table[] of worst loads: {max, max_principal, mode, at}
---@field shapes integer that were tried
---@field solves integer
---@field adjoints integer
---@field factorisations number a partial one counts as the part of the work that was done
---@field seconds number

---A part that is posed and thickened by its skeleton and solved again after each edit. Edits return
---something true, or nil, message, details when the world is against them (details.status "geometry":
---elements would be inverted, `element` is the worst); then the session is as it was. Supports and
---loads go with the surface; those added to the part later count from the next solve. A part of
---order 2 is advised; an order 1 part stays one.
---@class bw.Session
---@field part bw.Model as it is now
---@field mesh bw.Mesh as it is now
---@field rest bw.Mesh
---@field domains bw.Domains
---@field skeleton bw.Skeleton at rest
---@field joints bw.Array where the joints are now
---@field current_pose bw.Array see bw.Skeleton:rest_pose
---@field edits table[] in force: {script, mesh = "posed" | "relaxed" | "refilled"}
local Session = {}

---A bone to turn, scale and move.
---@param name string|integer
---@return bw.Bone
function Session:bone(name) end

---Sets several bones as one edit: {thigh = {scale =, rotation =, translation =}, ...}, the whole
---change since rest of each; what is left out stays.
---@param changes table<string, table>
---@return bw.Session?
---@return string? message
---@return table? details
function Session:pose(changes) end

---Inverse kinematics: turns bones until a joint (or a bone's tail) is at a place; or several, with a
---list {{joint = | bone =, at =, along =, weight =, from = first bone that may turn}, ...}.
---@param target string|table[]
---@param at? bw.Vector m
---@param options? {tolerance: number}
---@return table? report distance, iterations, reached (false: limits or lengths are in the way)
---@return string? message
---@return table? details
function Session:reach(target, at, options) end

---How far a bone (or every bone whose head is a joint) may turn against its parent in `reach`, in
---degrees; nil lifts the limit.
---@param name string|integer
---@param limit? {swing: number, twist: number[]}
---@return bw.Session?
function Session:limit(name, limit) end

---Gives elements to a bone's domain, or takes them out of those that follow a bone, as an edit. On a
---refilled mesh, of which `elements` are, the domains change as they were before it was refilled, and the
---pose is mended anew: the mesh after it may be another one.
---@param elements bw.Array|integer[]
---@param bone? string|integer
---@return bw.Session?
---@return string? message
---@return table? details
function Session:assign(elements, bone) end

---Everything back to rest, as an edit.
---@return bw.Session?
function Session:reset() end

---Takes back the last edit; to any depth.
---@return bw.Session?
---@return string? message
---@return table? details
function Session:undo() end

---@return bw.Session?
---@return string? message
---@return table? details
function Session:redo() end

---A session that begins where this one is, with the same equations and no journal, to try edits in (a
---drag of a hand). {relax =, refill =} as in bw.EditOptions.
---@param options? {relax: boolean, refill: boolean}
---@return bw.Session
function Session:fork(options) end

---The pose that a fork has come to, as one edit.
---@param fork bw.Session
---@return bw.Session?
---@return string? message
---@return table? details
function Session:adopt(fork) end

---An edit made of a change {script, pose, limits, topology}, for Lua files that add edits.
---@param change table
---@return table? state
---@return string? message
---@return table? details
function Session:commit(change) end

---The static solution of the part as it is now; `reused` of it tells what the edit left standing.
---`part`: another load case, a model of the mesh as it was given (other supports need another factor).
---@param options? {method: "auto"|"refactor"|"iterate"|"levels"|"scratch", tolerance: number, precision: 32|64, check: boolean, inertia_relief: boolean, balance_tolerance: number, part: bw.Model}
---@return bw.Static?
---@return string? message
---@return table? details
function Session:solve(options) end

---Scales the bones near high stresses across themselves (their axes y and z) until no node's von Mises
---stress is above the limit, changing the shape least: the sum over the corner nodes of the squares of
---their moves. One edit, which undo takes back. When the limit cannot be met: nil, message, details
---with status "infeasible" (or "convergence", or "cancelled" after Ctrl-C) and `best`, a report of the
---best that was found; the session is then as it was. Supports do not move unless `move_supports` is set, so that
---what is too high next to a support may be out of the bones' reach.
---@param options bw.OptimiseOptions
---@return bw.Optimisation?
---@return string? message
---@return table? details
function Session:optimise(options) end

---The session's equations, brought to the current shape, and the model they are of.
---@return bw.LocalSystem?
---@return bw.Model|string model or a message
---@return table? details
function Session:synchronise() end

---Another model of the part's first mesh (another load case) on the current shape.
---@param part bw.Model
---@return bw.Model?
---@return string? message
---@return table? details
function Session:moved(part) end

---The boundary as it is now: `session:surface():write("part.stl")`.
---@return bw.Surface?
function Session:surface() end

---Fields of the current shape as .vtu: those of bw.Static:write, and the domains.
---@param path string
---@param options? {fields: table}
---@return true?
---@return string? message
---@return table? details
function Session:write(path, options) end

---A picture of the current shape under its loads.
---@param path string
---@param options? bw.PictureOptions with `field`
---@return true?
---@return string? message
---@return table? details
function Session:picture(path, options) end

---One HTML file with a 3D view of the shape under its loads and as it was drawn, what the bones were
---changed by, and the edits.
---@param path string
---@param options? {title: string, manifest: table}
---@return true?
---@return string? message
---@return table? details
function Session:report(path, options) end

---The edits in force as a script that replays them.
---@param path string
---@return true?
---@return string? message
---@return table? details
function Session:save(path) end

---Checks that all parts of the session belong together, for tests and debugging. Raises where they do not.
---@return bw.Session
function Session:check() end

---Lets go of the equations and all states at once, and ends the journal.
function Session:close() end

---A bone of a session. Edits give the bone back, so that they can be chained.
---@class bw.Bone
---@field name string
---@field index integer
---@field session bw.Session
---@field head string joint
---@field tail string joint
---@field parent string? bone
---@field children string[] bones
---@field domain integer? the domain that follows this bone alone
---@field from bw.Vector where its head is now
---@field to bw.Vector where its tail is now
---@field factors bw.Vector its scale
---@field rotation number[][] against its parent, three rows
---@field translation bw.Vector of its head, in its parent's directions
local Bone = {}

---Scaled by factors along it and across it, or by one factor, on top of what it has.
---@param factors bw.Vector|number
---@return bw.Bone?
---@return string? message
---@return table? details
function Bone:scale(factors) end

---Turned about its head, with all that hangs on it: {axis =, degrees = | radians =}, {x =, y =, z =} in
---degrees (about x first), or three rows of a rotation. Directions are those of space.
---@param turn table
---@return bw.Bone?
---@return string? message
---@return table? details
function Bone:rotate(turn) end

---Moved by a vector in metres, with all that hangs on it.
---@param vector bw.Vector
---@return bw.Bone?
---@return string? message
---@return table? details
function Bone:translate(vector) end

---Sets its whole change since rest; what is left out stays.
---@param change {scale: bw.Vector, rotation: table, translation: bw.Vector}
---@return bw.Bone?
---@return string? message
---@return table? details
function Bone:set(change) end

---Back to rest.
---@return bw.Bone?
---@return string? message
---@return table? details
function Bone:reset() end

---The live view: serves a session, or an object of bw.responsive, as a page on this machine until Ctrl-C.
---See docs/live.md. `solve`, `worst` and `ties` are for sessions; `pace` (steps of time in a frame) and
---`paused` for what goes on in time; `goal` (a shape to be met, drawn in red), `script` (what makes the object, named from the file `saved`) and
---`lines` (edits made first) for objects of bw.responsive.
---@param served bw.Session|bw.SteadySheet|bw.BentSheet|bw.ShakenSheet|bw.Metallophone|bw.Flow|bw.ThermalFlow
---@param options? {port: integer, title: string, name: string, solve: table, von_mises: number, worst: bw.WorstCaseOptions, ties: string[][], saved: string, ready: fun(address: string), pace: integer, paused: boolean, goal: bw.Outline, script: string, lines: string[]}
---@return table?
---@return string? message
---@return table? details
function bw.live(served, options) end

---The equations of a part cut into pieces, kept up to date through edits. Changed by `update`.
---@class bw.LocalSystem
---@field unknown_count integer
---@field piece_count integer
local LocalSystem = {}

---Follows an edit: the moved model, and how every piece lies against the shape that the system was
---made at (rows of bw.Domains:motion).
---@param model bw.Model
---@param motion bw.Array|table
---@return table? reused
---@return string? message
---@return table? details
function LocalSystem:update(model, motion) end

---@param force bw.Array a row of three for every node
---@param options? table see bw.Session:solve
---@param reused? table of an update, to be completed
---@return bw.Array? displacement
---@return table|string reused or a message
---@return table? details
function LocalSystem:solve(force, options, reused) end

---The static solution of the model of the last update.
---@param model bw.Model
---@param options? table see bw.Session:solve
---@param reused? table of an update, to be completed
---@return bw.Static?
---@return table|string reused or a message
---@return table? details
function LocalSystem:statics(model, options, reused) end

---Brings the factor up to date.
---@param reused? table
---@return table? reused
---@return string? message
---@return table? details
function LocalSystem:refactor(reused) end

---Its equations as a system, the factor brought up to date. Of no use after the next update.
---@return bw.System?
---@return string? message
---@return table? details
function LocalSystem:view() end

---Bytes of the factor, of what is kept for updating it, of the pieces' coefficients, and of what solves over
---levels (0 until it is first used).
---@return integer factor
---@return integer updates
---@return integer coefficients
---@return integer levels
function LocalSystem:memory() end

---What the current shape would cost from scratch: seconds of its stiffness from all elements, and of
---CHOLMOD's analysis, factor and solve, with the unknowns in the order that was chosen for edits, or
---in that of METIS for a single solution. For benchmarks.
---@param own_order? boolean METIS's order; default false
---@return {stiffness: number, analysis: number, factor: number, solve: number, flops: number, entries: number}?
---@return string? message
---@return table? details
function LocalSystem:baseline(own_order) end

function LocalSystem:close() end

---The server of the live view (`require "barwright.core".live_server`): answers to this machine alone,
---below a path of 128 random bits, and only to the origin it serves. WebSockets at `address .. "socket"`.
---@class bw.LiveServer
---@field port integer
---@field token string
---@field address string to open in a browser; who knows it can edit
---@field client_count integer open WebSockets
local LiveServer = {}

---What a path below the address answers from now on.
---@param path string "" for the page itself
---@param mime string
---@param bytes string
---@param download? string the name under which browsers save it
---@return bw.LiveServer
function LiveServer:serve(path, mime, bytes, download) end

---Queues a message; never waits for the client. With `replace`, in place of an unsent one of that key.
---@param client integer
---@param bytes string
---@param options? {binary: boolean, replace: string}
---@return boolean sent false when that client is gone
function LiveServer:send(client, bytes, options) end

---The next thing that came, waiting up to so many seconds: nothing when none did; nil, message,
---details after Ctrl-C. Inside a progress function it does not wait.
---@param seconds? number
---@return integer? client
---@return string? kind "open", "message", "close"
---@return string|table? text
function LiveServer:receive(seconds) end

---Ends a client's connection.
---@param client integer
---@param code? integer of RFC 6455, default 1000
---@param reason? string
function LiveServer:disconnect(client, code, reason) end

function LiveServer:close() end

-- ---- files --------------------------------------------------------------------------------------

---JSON with sorted keys and the fewest digits that read back the same; NaN and infinities as null.
---@class bw.JsonModule
---@field null table stands for null
local json_module = {}

---@param value any
---@param indent? string
---@return string
function json_module.encode(value, indent) end

---@param text string
---@return any value or nil
---@return string? message with line and byte
function json_module.decode(text) end

---Marks a table as a list, so that an empty one is [].
---@param list? table
---@return table
function json_module.list(list) end

---Results that can be run again: result.json and manifest.json in a folder.
---@class bw.ResultsModule
local results_module = {}

---@param folder string made when missing
---@param about? {script: string, inputs: string[], options: table, seed: integer}
---@return bw.Results?
---@return string? message
---@return table? details
function results_module.open(folder, about) end

---Peak memory of the process, bytes.
---@return integer?
function results_module.peak_memory() end

---What a run depends on besides its script and inputs: version, commit, libraries, threads, machine.
---@return table
function results_module.surroundings() end

---@class bw.Results
---@field folder string
---@field manifest table
local Results = {}

---The path of a file in the folder.
---@param name string
---@return string
function Results:path(name) end

---Writes result.json (plain numbers, unit in the key) and manifest.json.
---@param result table
---@return true?
---@return string? message
---@return table? details
function Results:write(result) end

-- ---- elastic sheets while their outline is dragged -----------------------------------------------

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
---entries decide over earlier ones. bw.remarks() names conflicts.
---@class bw.ResponsiveModule
local responsive_module = {}

---A bridge over a span (m) with a load (N) on its middle, to stay below a von Mises stress (Pa) with as
---little area as possible. depth: of the pad above the feet (default span / 2); bearing: how far a foot
---reaches onto its bank; pad: width under the load; wall: least width of a member (span / 50); size: of
---elements (span / 100); start: "truss", "gable", "beam", "arch"; outline: a right half to begin with.
---@param options {span: number, load: number, stress_limit: number, material: bw.Material, thickness: number, depth?: number, bearing?: number, pad?: number, wall?: number, size?: number, start?: string, outline?: bw.Outline}
---@return bw.Bridge?
---@return string? message
---@return table? details
function responsive_module.bridge(options) end

---Linear statics, solved in every drag.
---@param options {outline: bw.Outline, material: bw.Material|bw.Material[], thickness?: number|number[], plane?: string, conditions?: table, gravity?: number[], elements?: integer, size?: number|string|function, order?: integer, follow?: table, solver?: table}
---@return bw.SteadySheet?
---@return string? message
---@return table? details
function responsive_module.steady(options) end

---Large deflection (St. Venant-Kirchhoff), brought to equilibrium in every drag by Newton's method:
---newton = {tolerance, iterations, load_steps}.
---@param options {outline: bw.Outline, material: bw.Material|bw.Material[], thickness?: number|number[], plane?: string, conditions?: table, gravity?: number[], elements?: integer, size?: number|string|function, order?: integer, follow?: table, solver?: table, newton?: table}
---@return bw.BentSheet?
---@return string? message
---@return table? details
function responsive_module.cantilever(options) end

---Motion on ground that shakes: the tags of `ground` are moved by shake = {x = , y = } (displacements,
---m). Newmark's method: step (s), beta, gamma; damping = {of mass, of stiffness} (Rayleigh).
---@param options {outline: bw.Outline, material: bw.Material|bw.Material[], thickness?: number|number[], plane?: string, ground?: string|string[], shake?: table, step?: number, beta?: number, gamma?: number, damping?: number[], conditions?: table, gravity?: number[], elements?: integer, size?: number|string|function, order?: integer, follow?: table, solver?: table}
---@return bw.ShakenSheet?
---@return string? message
---@return table? details
function responsive_module.vibration(options) end

---Incompressible flow on linear triangles (SUPG, PSPG), implicit in time, at the shape as it is dragged.
---conditions = {tag = "wall"} or {tag = {x = , y = , traction = {x, y}, pressure = }}: velocities (m/s)
---and loads (Pa; the pressure beyond an open end), each a number, a formula in x, y and t, or a function
---of them; fluid leaves freely where there is none. density (kg/m3, default 1), viscosity (Pa s),
---gravity. Mesh: elements or size (m; a number, a formula in x and y, or a function of them), follow.
---Time: step (s), bdf (order: 1 or 2, the default), iterations (of a step; 1), ale (nodes that moved
---carry a velocity; default false). steady = true: every drag finds the steady state anew, to a relative
---change of tolerance (1e-8). solver as of sheets, tolerance 1e-6.
---@param options {outline: bw.Outline, viscosity: number, density?: number, conditions?: table, gravity?: number[], step?: number, steady?: boolean, bdf?: integer, iterations?: integer, tolerance?: number, ale?: boolean, elements?: integer, size?: number|string|function, follow?: table, solver?: table}
---@return bw.Flow?
---@return string? message
---@return table? details
function responsive_module.flow(options) end

---Flow with heat that is carried along and lifts (Boussinesq): also diffusivity (m2/s), expansion (1/K),
---reference (temperature without lift, and at the start, K), and in the conditions temperature = ,
---heat_flux = (into the fluid, over density times heat capacity: K m/s), convection = {coefficient = (over the same:
---m/s), temperature = (of what is around)}: coefficient (temperature - T) comes in. Numbers, formulas or functions.
---@param options {outline: bw.Outline, viscosity: number, diffusivity: number, density?: number, expansion?: number, reference?: number, conditions?: table, gravity?: number[], step?: number, steady?: boolean, bdf?: integer, iterations?: integer, tolerance?: number, ale?: boolean, elements?: integer, size?: number|string|function, follow?: table, solver?: table}
---@return bw.ThermalFlow?
---@return string? message
---@return table? details
function responsive_module.thermal(options) end

---A bar that rings: the outline extruded to a free plate (Reissner-Mindlin), solved in every drag from the
---last frame's modes and factor. `modes`: how many (default 1); `elements`: default 400, six-node.
---@param options {outline: bw.Outline, material: bw.Material, thickness: number, modes?: integer, elements?: integer, size?: number, tolerance?: number, follow?: table}
---@return bw.Metallophone?
---@return string? message
---@return table? details
function responsive_module.metallophone(options) end

---A bar that rings. Umetani et al. 2011, section 5.1 and appendix A.
---@class bw.Metallophone
---@field outline bw.Outline as it is now
---@field reused bw.Kept what the last frame kept
---@field frequency number of the lowest elastic mode, Hz
---@field frequencies bw.Array of all modes asked for, Hz
---@field note string nearest note and how far above it: "C5 +3.2 cents"
---@field nodal_lines bw.Array rows x0, y0, x1, y1: where the lowest mode is at rest
---@field thickness number m
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners and middles of edges 12, 23, 31, from 1
---@field element_count integer
---@field node_count integer
local Metallophone = {}

---Moves a handle of the outline by {dx, dy}: mesh, tone and mode follow.
---@param handle table {vertex = n}, {edge = n} or {loop = name}
---@param by number[]
---@return bw.Metallophone?
---@return string? message
---@return table? details
function Metallophone:drag(handle, by) end

---Goes over to another outline.
---@param outline bw.Outline
---@return bw.Metallophone?
---@return string? message
---@return table? details
function Metallophone:become(outline) end

---Solves again on the shape as it is.
---@return bw.Metallophone?
---@return string? message
---@return table? details
function Metallophone:solve() end

---How a frequency changes with the outline's points, Hz/m.
---@param mode? integer default 1
---@return bw.Array? gradient a row for every point
---@return string? message
---@return table? details
function Metallophone:gradient(mode) end

---Deflection and two rotations at every node, mass norm 1.
---@param mode? integer
---@return bw.Array
function Metallophone:mode(mode) end

---The lowest frequencies of vibrations within the bar's plane, Hz: where one lies below `frequency`, the
---bar is too narrow for its thickness to sound as bending says.
---@param count? integer default 1
---@return bw.Array?
---@return string? message
---@return table? details
function Metallophone:inplane(count) end

---All modes up to the highest that the bar has (`modes` of them, and those within its plane), the lowest first:
---frequency (Hz), kind ("bending" along the long axis, "torsion" about it, "in-plane"), number (from 1 for each
---kind), mode (of the bar; none in the plane). Example: `for _, m in ipairs(assert(bar:spectrum())) do print(m.kind) end`
---@return {frequency: number, kind: string, number: integer, mode: integer?}[]?
---@return string? message
---@return table? details
function Metallophone:spectrum() end

---Two places to hold the bar, on the nodal lines of its lowest mode.
---@return number[][]? places
---@return string? message
---@return table? details
function Metallophone:holes() end

---The sound of a stroke at `at` (default: where the lowest mode moves most): loss factor (default
---0.002), contact of the mallet (s, default 0.0003), seconds (default 2), rate (default 44100).
---@param options? {at?: number[], loss?: number, contact?: number, seconds?: number, rate?: integer}
---@return bw.Array? samples between -1 and 1
---@return string? message
---@return table? details
function Metallophone:tone(options) end

---How loudly each mode sounds in it, with its sign, the loudest 1 in size.
---@param options? table as for tone
---@return bw.Array?
---@return string? message
---@return table? details
function Metallophone:gains(options) end

---The tone as a .wav file.
---@param path string
---@param options? {at?: number[], loss?: number, contact?: number, seconds?: number, rate?: integer}
---@return boolean?
---@return string? message
---@return table? details
function Metallophone:write_tone(path, options) end

---Changes the outline until the tone is `target` (Hz, or a note like "C5"), moving it least in the mean
---square and as evenly as the length `smooth` asks (default: a tenth of the size), no point by more than
---the part `room` (0.2) of the width where it is. `ratios`: of the frequencies of the lowest modes of a `kind`
---("bending" or "torsion"), the first of which gets the target: {1, 4, 10}; they are followed by kind and number
---while modes of another kind pass them. `stages` (1) divides the way into as many searches, each with room of its own
---from the outline of the one before: {1, 4, 10} is reached from an even bar in 8 with a room of 0.45. Ratios that the outline cannot reach fail with status "infeasible" or
---"convergence" and details.frequencies, the nearest found. More than 5 % off, the size is changed first. `keep`: numbers of points
---that stay (from there), `pins`: of vertices, as in Outline:pull. Met on a mesh `finer` times as fine (default 4). On failure nothing has changed.
---`watch` is called with the bar after every round; where it returns false, tuning ends as a failure.
---@param target number|string
---@param options? {keep?: integer[], pins?: integer[], smooth?: number, finer?: integer, ratios?: number[], kind?: "bending"|"torsion", room?: number, stages?: integer, watch?: fun(bar: bw.Metallophone): boolean?}
---@return {frequency: number, cents: number, moved: number, rounds: integer, mesh_cents: number, modes: {frequency: number, wanted: number, cents: number, number: integer, kind: string?}[]}?
---@return string? message
---@return table? details
function Metallophone:tune(target, options) end

---Where to take material off the edge of a bar that was made and sounds at `measured` Hz: places, the
---best first, each alone enough as far as the change is linear.
---@param measured number Hz
---@param target number|string
---@param options? {places?: integer, width?: number}
---@return {at: number[], depth: number, cents: number, per_mm: number}[]?
---@return string? message
---@return table? details
function Metallophone:trim(measured, target, options) end

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

---@class bw.SteadySheet
---@field outline bw.Outline as it is now
---@field reused bw.Kept what the last frame kept
---@field displacement bw.Array x, y at the nodes, m
---@field stress bw.Array xx, yy, xy, zz at the nodes, Pa
---@field von_mises bw.Array at the nodes, Pa
---@field error_estimate number relative, in energy (Zienkiewicz, Zhu)
---@field mesh bw.PlaneMesh as it is now
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners (and middles of edges 12, 23, 31), from 1
---@field element_count integer
---@field node_count integer
---@field time number s
---@field velocity bw.Array? of a shaken sheet
---@field acceleration bw.Array?
local SteadySheet = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}.
---@param handle {vertex?: integer, edge?: integer, loop?: string|integer}
---@param by number[]
---@return bw.SteadySheet?
---@return string? message
---@return table? details
function SteadySheet:drag(handle, by) end

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.SteadySheet?
---@return string? message
---@return table? details
function SteadySheet:become(outline) end

---Solves again where it stands.
---@return bw.SteadySheet?
---@return string? message
---@return table? details
function SteadySheet:solve() end

---The power mean of von Mises stresses over the area with exponent p (1 to 1000: the larger, the closer
---to their maximum), and its exact gradient by the outline's points and by the mesh's nodes.
---@param p number
---@return number?
---@return bw.Array|string by_points
---@return bw.Array|table by_nodes
function SteadySheet:stress_norm(p) end

---A bridge: its right half is what is held, meshed and moved; tags "foot", "pad", "hold" (the middle of the
---pad), "axis" and "free". Feet and pad stay where they are. Prints as one line.
---@class bw.Bridge
---@field outline bw.Outline of the right half
---@field whole bw.Outline both halves, to cut or print
---@field area number of the whole, m2
---@field stress_limit number Pa
---@field utilisation number largest von Mises stress over the limit
---@field passes boolean
---@field von_mises bw.Array at the nodes, Pa
---@field stress bw.Array xx, yy, xy, zz at the nodes, Pa
---@field displacement bw.Array x, y at the nodes, m
---@field points bw.Array of the half's mesh, m
---@field elements bw.Array corners and middles of edges 12, 23, 31, from 1
---@field element_count integer
---@field node_count integer
---@field error_estimate number relative, in energy
---@field reused bw.Kept what the last frame kept
---@field options table as asked for, with what was chosen
local Bridge = {}

---Moves a handle of the outline by {dx, dy}.
---@param handle {vertex?: integer, edge?: integer, loop?: string|integer}
---@param by number[]
---@return bw.Bridge?
---@return string? message
---@return table? details
function Bridge:drag(handle, by) end

---Push-pin pulling of a curve, as Outline:pull.
---@param vertex integer
---@param to number[]
---@param how? {pins?: integer[], reach?: number}
---@return bw.Bridge?
---@return string? message
---@return table? details
function Bridge:pull(vertex, to, how) end

---Smooths the free curves, as Outline:smooth.
---@param how? {loop?: string|integer, strength?: number, rounds?: integer, corner?: number}
---@return bw.Bridge?
---@return string? message
---@return table? details
function Bridge:smooth(how) end

---A round hole more, and its image on the other half.
---@param centre number[]
---@param radius number
---@return bw.Bridge?
---@return string? message
---@return table? details
function Bridge:hole(centre, radius) end

---A hole less.
---@param loop string|integer
---@return bw.Bridge?
---@return string? message
---@return table? details
function Bridge:without(loop) end

---Becomes another right half; feet and pad are put back where only points moved, else they must be there.
---@param outline bw.Outline
---@return bw.Bridge?
---@return string? message
---@return table? details
function Bridge:become(outline) end

---Largest von Mises stress on another mesh of the same shape, and its number of elements.
---@param size number of elements, m
---@param order? integer
---@return number?
---@return integer|string
---@return table? details
function Bridge:check(size, order) end

---The lowest beam of one height that passes: height and area of the whole.
---@return number?
---@return number|string area
---@return table? details
function Bridge:uniform_beam() end

---Michell's least area of bars for a force in the middle between the middles of the feet.
---@return number
function Bridge:michell_area() end

---Bending moment in the middle over limit thickness depth^2 / 4, which the depth could bear with all of it at the
---limit: a solid beam bears 0.67, nothing above 1.155.
---@return number
function Bridge:moment_share() end

---Finds the shape of least area that passes, and becomes it; where none was found, that of the least stress, and
---`message` says what it bears. passes: utilisation and checked_utilisation are 1 at most. converged: the area
---fell by less than 1 % in the last fifth of the rounds, else `message` says so. starts: where to begin, the best
---is kept: "current" (the outline as it is; default where it was given or changed), "truss", "gable", "beam",
---"arch" (else the default). Holes that were put in by hand stay as they are, whatever the start; a place that must stay
---free of material is such a hole. rounds: of each; holes: most in a half; polish: rounds on a finer mesh, until it passes on one finer still.
---report is told of every round and may return false to end it. Ctrl-C keeps the best.
---@param options? {starts?: string[], rounds?: integer, holes?: integer, polish?: integer, report?: fun(now: table): boolean?}
---@return {start: string, area: number, utilisation: number, passes: boolean, checked_utilisation: number?, checked_elements: integer?, interrupted: boolean, converged: boolean, message: string?, starts: table[]}?
---@return string? message
---@return table? details
function Bridge:design(options) end

---Writes a picture, coloured by stress (.svg, .png).
---@param path string
---@return boolean?
---@return string? message
---@return table? details
function Bridge:picture(path) end

---The bridge as a closed surface of its thickness.
---@return bw.Surface?
---@return string? message
---@return table? details
function Bridge:body() end

---@class bw.BentSheet
---@field outline bw.Outline as it is now
---@field reused bw.Kept what the last frame kept
---@field displacement bw.Array x, y at the nodes, m
---@field stress bw.Array xx, yy, xy, zz at the nodes, Pa
---@field von_mises bw.Array at the nodes, Pa
---@field error_estimate number relative, in energy (Zienkiewicz, Zhu)
---@field mesh bw.PlaneMesh as it is now
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners (and middles of edges 12, 23, 31), from 1
---@field element_count integer
---@field node_count integer
---@field time number s
---@field velocity bw.Array? of a shaken sheet
---@field acceleration bw.Array?
local BentSheet = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}.
---@param handle {vertex?: integer, edge?: integer, loop?: string|integer}
---@param by number[]
---@return bw.BentSheet?
---@return string? message
---@return table? details
function BentSheet:drag(handle, by) end

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.BentSheet?
---@return string? message
---@return table? details
function BentSheet:become(outline) end

---Solves again where it stands.
---@return bw.BentSheet?
---@return string? message
---@return table? details
function BentSheet:solve() end

---@class bw.ShakenSheet
---@field outline bw.Outline as it is now
---@field reused bw.Kept what the last frame kept
---@field displacement bw.Array x, y at the nodes, m
---@field stress bw.Array xx, yy, xy, zz at the nodes, Pa
---@field von_mises bw.Array at the nodes, Pa
---@field error_estimate number relative, in energy (Zienkiewicz, Zhu)
---@field mesh bw.PlaneMesh as it is now
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners (and middles of edges 12, 23, 31), from 1
---@field element_count integer
---@field node_count integer
---@field time number s
---@field velocity bw.Array? of a shaken sheet
---@field acceleration bw.Array?
local ShakenSheet = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}.
---@param handle {vertex?: integer, edge?: integer, loop?: string|integer}
---@param by number[]
---@return bw.ShakenSheet?
---@return string? message
---@return table? details
function ShakenSheet:drag(handle, by) end

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.ShakenSheet?
---@return string? message
---@return table? details
function ShakenSheet:become(outline) end

---Advances by `count` time steps (default 1).
---@param count? integer
---@return bw.ShakenSheet?
---@return string? message
---@return table? details
function ShakenSheet:step(count) end

---What stands behind the applications: a sheet and the mesh that follows. `frame` is a table that is
---filled with what was kept (bw.Kept).
---@class bw.Sheet
---@field outline bw.Outline
---@field displacement bw.Array
---@field velocity bw.Array?
---@field acceleration bw.Array?
---@field stress bw.Array
---@field von_mises bw.Array
---@field error_estimate number
---@field mesh bw.PlaneMesh
---@field points bw.Array
---@field elements bw.Array
---@field order integer
---@field time number
local Sheet = {}

---@param frame table
---@param outline bw.Outline
---@return table?
---@return string? message
---@return table? details
function Sheet:follow(frame, outline) end

---@param frame table
---@param solver? table
---@return table?
---@return string? message
---@return table? details
function Sheet:static(frame, solver) end

---@param frame table
---@param solver? table
---@param newmark? {step?: number, beta?: number, gamma?: number, damping_mass?: number, damping_stiffness?: number}
---@param steps? integer
---@return table?
---@return string? message
---@return table? details
function Sheet:shake(frame, solver, newmark, steps) end

---@param frame table
---@param solver? table
---@param newton? {tolerance?: number, iterations?: integer, load_steps?: integer}
---@return table?
---@return string? message
---@return table? details
function Sheet:bend(frame, solver, newton) end

---What mesh and body are at.
---@return bw.BodyState
function Sheet:keep() end

---Back to what was kept, bit for bit.
---@param state bw.BodyState
---@return table?
---@return string? message
---@return table? details
function Sheet:return_to(state) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return table
function Sheet:check() end

---@param p number
---@return number?
---@return bw.Array|string by_points
---@return bw.Array|table by_nodes
function Sheet:stress_norm(p) end

---@return integer elements
---@return integer nodes
function Sheet:counts() end

---Releases it early.
function Sheet:close() end

---The engine's plate under a metallophone bar; scripts take bw.Metallophone.
---@class bw.Plate
---@field outline bw.Outline
---@field frequencies bw.Array
---@field thickness number
---@field points bw.Array
---@field elements bw.Array
local Plate = {}

---@param frame table
---@param outline bw.Outline
---@return table?
---@return string? message
---@return table? details
function Plate:follow(frame, outline) end

---@param frame table
---@param options? {modes?: integer, tolerance?: number, scratch?: boolean}
---@return table?
---@return string? message
---@return table? details
function Plate:solve(frame, options) end

---@param mode? integer
---@return bw.Array
function Plate:mode(mode) end

---@param mode? integer
---@return bw.Array?
---@return string? message
---@return table? details
function Plate:gradient(mode) end

---@param mode? integer
---@return bw.Array
function Plate:nodal_lines(mode) end

---@param options? table
---@return bw.Array?
---@return string? message
---@return table? details
function Plate:tone(options) end

---@param options? table
---@return bw.Array?
---@return string? message
---@return table? details
function Plate:gains(options) end

---@param count? integer
---@return bw.Array?
---@return string? message
---@return table? details
function Plate:inplane(count) end

---@return integer elements
---@return integer nodes
function Plate:counts() end

---What mesh and body are at.
---@return bw.BodyState
function Plate:keep() end

---Back to what was kept, bit for bit.
---@param state bw.BodyState
---@return table?
---@return string? message
---@return table? details
function Plate:return_to(state) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return table
function Plate:check() end

---Releases it early.
function Plate:close() end

-- ---- grids ---------------------------------------------------------------------------------------

---Grids of hexahedra: boxes, and voxels of closed surfaces.
---@class bw.GridModule
local grid_module = {}

---What is chosen by geometry, in metres, so that it means the same on a fine grid and on its coarse one.
---All parts that are given must hold. Cells count by their middles, `inside` by half their volume. In
---its place a function of x, y, z or a formula (`where`), or a surface (`inside`), may stand.
---@class bw.Region
---@field low? bw.Vector low corner of a box along the axes
---@field high? bw.Vector its high corner; either of the two may be left out
---@field box? bw.Vector[] both at once: {low, high}
---@field centre? bw.Vector of a ball
---@field radius? number of the ball, m
---@field plane? bw.Vector[] {point, normal}: on this plane
---@field beyond? bw.Vector[] {point, normal}: on the side that the normal points to
---@field side? string the outermost nodes or cells: "low x", "high x", "low y", "high y", "low z", "high z"
---@field boundary? boolean with a face that has no neighbour
---@field inside? bw.Surface closed
---@field where? function|string of x, y, z: true, or a number but 0
---@field within? number what lies outside by less counts too, m; default a millionth of a cell

---A box of elements. Two of `size` (or `high`), `cells` and `spacing` are needed; one number stands for
---three alike. `material` is a number (1), a function of x, y, z or a formula in them, taken at the
---middle of each cell, or a list with one for every cell, x fastest; 0 is void.
---@param options {size?: bw.Vector|number, low?: bw.Vector|number, high?: bw.Vector|number, cells?: integer[]|integer, spacing?: bw.Vector|number, material?: integer|function|string|table|bw.Array}
---@return bw.Grid?
---@return string? message
---@return table? details
function grid_module.box(options) end

---The cubes that a closed surface cuts or holds, of side `spacing`, or `cells` (32) along its longest
---side. Cells with a part inside that is smaller than `least` (0.05) are void; others count by their
---part, or as full ones with `whole`. `multiple`: so many cells in each direction, or a multiple of it.
---`material` as for a box, but no list.
---@param surface bw.Surface
---@param options? {spacing?: number, cells?: integer, least?: number, whole?: boolean, multiple?: integer, material?: integer|function|string}
---@return bw.Grid?
---@return string? message
---@return table? details
function grid_module.voxels(surface, options) end

---Grids side by side in one PNG file, with the same camera, scale and colours. A panel is coloured by
---material unless it has `values`, of nodes or elements. With the `embedding` of a surface in its grid
---the surface is drawn in place of the elements.
---@param path string
---@param panels {grid: bw.Grid, title?: string, displacement?: bw.Array|table, values?: bw.Array|table, embedding?: bw.Embedding}[]
---@param options? bw.GridPictureOptions
---@return boolean?
---@return string? message
---@return table? details
function grid_module.picture(path, panels, options) end

---@class bw.GridPictureOptions
---@field width? integer pixels of a panel
---@field height? integer
---@field columns? integer panels in a row; default 4 at most
---@field title? string
---@field unit? string name and unit of the colour bar: "deflection, mm"
---@field scale? number values are multiplied by it on the bar
---@field low? number lower end of the colours
---@field high? number upper end of the colours
---@field deformation? number factor on displacements; default 1
---@field edges? boolean of elements; default true
---@field ghost? boolean the undeformed outline behind
---@field direction? bw.Vector from the object to the viewer
---@field up? bw.Vector
---@field zoom? number
---@field view? bw.Vector[] {low, high}: the box to be seen, for pictures of a sequence; default what the panels fill
---@field names? string[] of materials, for the legend

---Equal boxes of which some are elements, with the nodes that they have; never changed. Cells and nodes
---are numbered x fastest. Corner c of an element (1 to 8) lies at the bits of c - 1: x, y, z.
---@class bw.Grid
---@field cells integer[] of the lattice along x, y, z
---@field spacing bw.Vector sides of a cell, m
---@field origin bw.Vector low corner of the lattice, m
---@field box bw.Box of the elements
---@field element_count integer
---@field node_count integer
---@field points bw.Array x, y, z of nodes, m
---@field elements bw.Array eight nodes each
---@field element_cells bw.Array the cell of each element
---@field materials bw.Array of elements: 1 and above
---@field fractions bw.Array of elements: the part of the cell that is inside the body
---@field material_counts table<integer, integer> elements of each material
---@field volume number m3, fractions counted
local Grid = {}

---The grid with other materials in some cells: cells by number, as they stand; or the elements in a
---region, with `void` its void cells too. Material 0 takes elements away. `material` as for grid.box;
---a list goes with cells by number. The grid itself where nothing changes.
---@param cells integer|integer[]|bw.Array|bw.Region|bw.Surface|function|string
---@param material integer|function|string|table|bw.Array
---@param options? {void?: boolean}
---@return bw.Grid?
---@return string? message
---@return table? details
function Grid:set(cells, material, options) end

---Numbers of the nodes in a region. None at all is an error that names the nearest.
---@param region bw.Region|bw.Surface|function|string
---@return bw.Array?
---@return string? message
---@return table? details
function Grid:nodes(region) end

---Numbers of the elements' cells in a region, with `void` of other cells too.
---@param region bw.Region|bw.Surface|function|string
---@param options? {void?: boolean}
---@return bw.Array?
---@return string? message
---@return table? details
function Grid:cells_in(region, options) end

---2 x 2 x 2 cells become one, `levels` times (1): an element where one of them is. Its materials are
---all 1.
---@param levels? integer
---@return bw.Grid?
---@return bw.Array parents the coarse element of every element; or a message
---@return table? details
function Grid:coarse(levels) end

---The boundary as a surface, two triangles a face, with the materials as groups.
---@return bw.Surface?
---@return bw.Array nodes of the surface's points; or a message
---@return table? details
function Grid:surface() end

---Bodies: elements that hang together by nodes.
---@return integer? count
---@return bw.Array bodies of elements; or a message
---@return table? details
function Grid:components() end

---Points, or those of a surface, that go with the elements. A point outside takes the nearest element,
---up to `reach` cells away (1).
---@param what bw.Surface|bw.Array|table
---@param options? {reach?: number}
---@return bw.Embedding?
---@return string? message
---@return table? details
function Grid:embed(what, options) end

---The mean distance of nodes moved by u and by v, over the longest side of the box.
---@param u table|bw.Array a row of three for every node
---@param v table|bw.Array
---@return number
function Grid:difference(u, v) end

---Draws the elements with their edges, by material or by values, deformed, to a PNG file.
---@param path string
---@param options? bw.GridPictureOptions with `displacement`, `values` and `embedding` as in a panel
---@return boolean?
---@return string? message
---@return table? details
function Grid:picture(path, options) end

---Whether elements and nodes are the same; materials may differ.
---@param other bw.Grid
---@return boolean
function Grid:same_elements(other) end

---Writes a .vtu file of hexahedra with materials and fractions.
---@param path string
---@param options? {fields?: table} name = array, of nodes or elements
---@return boolean?
---@return string? message
---@return table? details
function Grid:write(path, options) end

---Lets go at once.
function Grid:close() end

---Points that go with a grid's elements by trilinear interpolation.
---@class bw.Embedding
---@field grid bw.Grid
---@field elements bw.Array of points
---@field point_count integer
local Embedding = {}

---Values of nodes at the points.
---@param values table|bw.Array a row for every node
---@return bw.Array
function Embedding:values(values) end

---Forces at the points as forces at nodes: the same total, moment and work.
---@param forces table|bw.Array a row for every point
---@return bw.Array
function Embedding:forces(forces) end

---The surface, moved with the nodes.
---@param displacements table|bw.Array a row of three for every node
---@return bw.Surface?
---@return string? message
---@return table? details
function Embedding:moved(displacements) end

---Lets go at once.
function Embedding:close() end

-- ---- nonlinear solids ----------------------------------------------------------------------------

---A law of large deformation, W = mu a(F) + lambda b(F) J/m3: "neo_hookean" (the default; not defined
---where an element is turned inside out), "st_venant_kirchhoff", "corotated", "fixed_corotated". Either
---`young` (Pa) and `poisson`, or Lame's constants `mu` and `lambda` (Pa); `density` in kg/m3. With
---`formulation` = "b_bar" (default "standard") elements do not lock where Poisson's ratio is near 0.5; such a
---material cannot be made coarse.
---@param options {law?: string, young?: number, poisson?: number, mu?: number, lambda?: number, density?: number, name?: string, formulation?: "standard"|"b_bar"}
---@return bw.Hyperelastic
function bw.hyperelastic(options) end

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
---@class bw.Palette
---@field count integer
local Palette = {}

---@param number integer
---@return bw.Hyperelastic
function Palette:material(number) end

---Releases it early.
function Palette:close() end

---A body of hyperelastic materials on a grid; the grid's numbers are places in the palette.
---@param options {grid: bw.Grid, palette: bw.Hyperelastic[]|bw.Palette}
---@return bw.Solid?
---@return string? message
---@return table? details
function bw.solid(options) end

---A solid with its supports and loads. They are kept as they are given, by place (see bw.Region), and
---found again on an edited grid and on coarse ones. Nodes may be given by number too, which binds them
---to the grid.
---@class bw.Solid
---@field grid bw.Grid
---@field palette bw.Palette
---@field element_count integer
---@field node_count integer
---@field mass bw.Array of nodes, kg
---@field levels integer how many times it was made coarse
---@field locking string? a warning of volumetric locking and its cure, or nil; a solve remarks it as well
local Solid = {}

---Holds nodes; or moves them by {x, y, z} (m), where false leaves a component free; or by a function of
---x, y, z that returns three numbers.
---@param where bw.Region|function|string|bw.Array|integer[]
---@param by? table|function
---@return bw.Solid
function Solid:hold(where, by) end

---Holds nodes and turns them about an axis by `angle` (degrees, right-handed), along their arcs; `move` (m)
---shifts them too.
---@param where bw.Region|function|string|bw.Array|integer[]
---@param options {axis: bw.Vector, point?: bw.Vector, angle: number, move?: bw.Vector}
---@return bw.Solid
function Solid:turn(where, options) end

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
---@param options {pressure: number|table|function|bw.Array, follower?: boolean}
---@return bw.Solid
function Solid:pressure(on, options) end

---A plane that the solid's nodes, or the points of a `surface`, may touch and not pass, without
---friction. `normal` points to the solid's side; `move`: its displacement at full load.
---@param options {point: bw.Vector, normal: bw.Vector, move?: bw.Vector, surface?: bw.Surface}
---@return bw.Solid
function Solid:floor(options) end

---Equilibrium by Newton's method, from rest. `path`: parts of the way that are solved one after the
---other (turns: of at most 30 degrees); `steps`: load steps to begin with; `linear`: "direct",
---"jacobi", or "coarse": conjugate gradients over a coarse solid, `coarse` or those that are made. By
---default a factor ("direct") or the last, whichever costs less by counted operations and bytes and the
---iterations that were needed so far. Loads that are more than the solid carries end in a failure that
---says how far it came: details.reached is the last equilibrium on the way. The work until then is
---bounded: `iterations` in a load step (100), `most_iterations` in all of them, where 100 of conjugate
---gradients count as one more (500, and 20 for each of `steps` beyond the first), load steps no smaller
---than `least_step` (1/256). A solid made coarse by a library is compared with the naive coarse one (`choose`, default
---true): both are solved, the errors of both are estimated, and the result is that of the nearer one, which its
---`choice` tells. This takes two to four times as long as `choose = false`.
---@param options? {tolerance?: number, iterations?: integer, most_iterations?: integer, steps?: integer, least_step?: number, path?: integer, linear?: string, coarse?: bw.Solid, cg_tolerance?: number, cg_iterations?: integer, allow_inverted?: boolean, start?: bw.Array, choose?: boolean}
---@return bw.SolidResult?
---@return string? message
---@return table? details
function Solid:solve(options) end

---The solid in motion, its loads at full. `scheme`: "implicit_euler" or "newmark"; `step` in s;
---Rayleigh damping `mass_damping` (1/s) and `stiffness_damping` (s); `iterations` 1: linearly implicit;
---`linear`: "direct" or, for large solids, "jacobi".
---@param options {scheme?: string, step: number, mass_damping?: number, stiffness_damping?: number, beta?: number, gamma?: number, tolerance?: number, iterations?: integer, allow_inverted?: boolean, linear?: string, displacement?: bw.Array, velocity?: bw.Array}
---@return bw.SolidMotion?
---@return string? message
---@return table? details
function Solid:motion(options) end

---The same solid on an edited grid. A coarse solid takes its fine grid, edited, and looks up again only
---what differs.
---@param grid bw.Grid
---@return bw.Solid?
---@return string? message
---@return table? details
function Solid:with(grid) end

---The solid made coarse `levels` times (1): by a library's lookup; or "naive" (points take the material
---of the fine element there), or "average" (constants averaged), for comparison. What a library does not resolve
---(straight stiff rods, displacements that are imposed) it can make worse than "naive": so `solve` chooses between
---the two, while `motion` takes the library as it is.
---@param by bw.Library|"naive"|"average"
---@param levels? integer
---@return bw.Solid?
---@return string? message
---@return table? details
function Solid:coarsen(by, levels) end

---`coarsen` and `solve` in one: options as of `solve`, with `by` and `levels` as of `coarsen`. Beside the result its
---`choice`. Example:
---`local result, how = fine:solve_coarse {by = library}; print(how.chosen, result.estimated_error)`.
---@param options {by: bw.Library, levels?: integer, tolerance?: number, iterations?: integer, most_iterations?: integer, steps?: integer, least_step?: number, path?: integer, linear?: string, cg_tolerance?: number, cg_iterations?: integer, allow_inverted?: boolean}
---@return bw.SolidResult?
---@return table|string how
---@return table? details
function Solid:solve_coarse(options) end

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
---@return table? details
function SolidResult:write(path) end

---The deformed grid, as Grid:picture; `values` may be "von_mises" or "movement" too.
---@param path string
---@param options? table
---@return boolean?
---@return string? message
---@return table? details
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
---@return table? details
function SolidMotion:step(count) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return bw.SolidMotion
function SolidMotion:check() end

---Releases it early.
function SolidMotion:close() end

-- ---- metamaterials -------------------------------------------------------------------------------

---Libraries of coarse materials, fitted once to every block of a palette's materials (data-driven,
---section 4).
---@class bw.MetamaterialModule
local metamaterial_module = {}

---Builds a library: every 2 x 2 x 2 block of the palette's materials (and void, unless `voids` is
---false) is loaded by `directions` (500) forces of `magnitudes` (5), and a material of one cell fitted.
---`levels` 2: blocks of such blocks too. `checkpoint`: a file that a build that was killed carries on
---from.
---@param palette bw.Hyperelastic[]|bw.Palette
---@param options? {levels?: integer, voids?: boolean, directions?: integer, magnitudes?: integer, stretches?: integer, fibres?: integer, strain?: number, ridge?: number, representatives?: integer, seed?: integer, checkpoint?: string}
---@return bw.Library?
---@return string? message
---@return table? details
function metamaterial_module.build(palette, options) end

---A library with fits of its own for the blocks of a grid that have none: of 4 x 4 x 4 cells, with
---`levels` 2, and of 2 x 2 x 2 that were left out. Of a palette, with the options of `build`: a library of
---nothing but this grid's blocks, the others being coarsened naively. Grown for several grids one after the
---other, it serves all. `checkpoint`: a file that keeps finished fits, for any grid.
---@param of bw.Library|bw.Hyperelastic[]|bw.Palette
---@param grid bw.Grid
---@param options? {levels?: integer, checkpoint?: string, voids?: boolean, directions?: integer, magnitudes?: integer, stretches?: integer, fibres?: integer, strain?: number, ridge?: number, seed?: integer}
---@return bw.Library?
---@return string? message
---@return table? details
function metamaterial_module.grow(of, grid, options) end

---@param path string .bwm
---@return bw.Library?
---@return string? message
---@return table? details
function metamaterial_module.read(path) end

---@class bw.Library
---@field levels integer
---@field palette bw.Palette
---@field seconds number that building took
---@field errors table[][] for each level and fit: median, worst, naive_median, naive_worst, force, naive_force, samples
---@field grown integer[] for each of two levels, how many blocks were fitted for grids
local Library = {}

---@param path string .bwm
---@return bw.Library?
---@return string? message
---@return table? details
function Library:write(path) end

---The material of a block, by its 8 materials (64 for level 2), child by child; 0 is void.
---@param key integer[]
---@return bw.Hyperelastic?
---@return integer|string fit its number, or a message
---@return table? details
function Library:material(key) end

---Releases it early.
function Library:close() end

-- ---- plane meshes --------------------------------------------------------------------------------

---Triangle meshes of outlines, and movers that let them follow an outline that is dragged.
---@class bw.PlaneModule
local plane_module = {}

---Fills an outline with triangles. `size` is the wanted edge length in m; without it (or a `field`)
---about `elements` triangles are made (2000). `field` gives the edge length by place: a function of
---x, y, or a formula in them. `minimum_angle` of elements in degrees (25), `curvature`: largest turn of
---a boundary edge in degrees (20). `limit` of elements (5 million), `time_limit` in seconds of computing
---(300), `memory_limit` in bytes (6e9): beyond them nil, a message and details with `limit` "elements",
---"time" or "memory". Every vertex of the outline is a node; with order 2 sides follow the curves.
---@param outline bw.Outline
---@param options? {order?: integer, size?: number, elements?: integer, field?: function|string|number, minimum_angle?: number, curvature?: number, limit?: integer, time_limit?: number, memory_limit?: number}
---@return bw.PlaneMesh?
---@return string? message
---@return table? details
function plane_module.fill(outline, options) end

---A mesh from arrays: corners first, middles of edges 01, 12, 20 behind them (order 2); elements
---counter-clockwise. Its boundary becomes an outline with one edge per side, unless `outline` is given
---with the `edges` (of every node, 0: inside) and `parameters` (0 up to below 1) of its nodes.
---@param options {points: table|bw.Array, elements: table|bw.Array, regions?: table|bw.Array, order?: integer, outline?: bw.Outline, edges?: table|bw.Array, parameters?: table|bw.Array}
---@return bw.PlaneMesh?
---@return string? message
---@return table? details
function plane_module.new(options) end

---Squares cut in two; its outline has the tags bottom, right, top, left. `diagonal`: "right" (from
---lower left to upper right), "left", "union jack".
---@param options {low?: number[], high?: number[], cells?: integer[], order?: integer, diagonal?: string}
---@return bw.PlaneMesh?
---@return string? message
---@return table? details
function plane_module.rectangle(options) end

---A mover: a mesh that follows its outline. Elements below the quality `distorted` (0.35) call for
---reconnecting, below `rebuild` (0.1) after it for a new mesh. `relocation`: "harmonic" or "springs"
---(with `sweeps` rounds, 2). `force`: at least this level each time. `fill`: options of new meshes; by
---default as many elements as the mesh has.
---@param mesh bw.PlaneMesh
---@param options? {relocation?: string, sweeps?: integer, distorted?: number, rebuild?: number, force?: string, fill?: table}
---@return bw.Mover?
---@return string? message
---@return table? details
function plane_module.mover(mesh, options) end

---A triangle mesh of an outline; never changed.
---@class bw.PlaneMesh
---@field points bw.Array x, y of nodes, m: corners first
---@field elements bw.Array 3 or 6 nodes, corners counter-clockwise, then middles of edges 01, 12, 20
---@field regions bw.Array of elements
---@field neighbours bw.Array of elements: across edges 01, 12, 20 (0: none)
---@field sides bw.Array edges on the outline, along its edges: start, end (and middle)
---@field side_elements bw.Array of sides: left, right (0: none)
---@field side_edges bw.Array of sides: the outline's edge
---@field node_edges bw.Array of nodes: the outline's edge that they lie on (0: inside)
---@field node_parameters bw.Array of nodes: where on that edge
---@field order integer 1 or 2
---@field node_count integer
---@field corner_count integer
---@field element_count integer
---@field outline bw.Outline
---@field quality table {worst, worst_element, mean, smallest_angle, largest_angle, area, inverted}
---@field element_quality bw.Array of elements: 1 equilateral, 0 flat, below 0 inverted
local PlaneMesh = {}

---The same mesh elsewhere: nodes on the outline must lie on the one given.
---@param outline bw.Outline of the same topology
---@param points table|bw.Array x, y of every node
---@return bw.PlaneMesh?
---@return string? message
---@return table? details
function PlaneMesh:moved(outline, points) end

---Values at nodes carried to the nodes of another mesh: copied where the nodes are the same,
---interpolated otherwise.
---@param to bw.PlaneMesh
---@param values bw.Array a row for every node
---@return bw.Array?
---@return string? message
---@return table? details
function PlaneMesh:carry(to, values) end

---The element at a place, or the nearest.
---@param at number[] x, y
---@return integer element
---@return number[] barycentric
---@return number outside distance from the mesh, 0 inside
function PlaneMesh:locate(at) end

---What two meshes have in common: "topology" (the pattern of matrices holds), "nodes" (preconditioners
---and solutions hold), or nil.
---@param other bw.PlaneMesh
---@return string?
function PlaneMesh:shares(other) end

---Writes a .vtu file.
---@param path string
---@param options? {fields?: table} name = array, of nodes or elements
---@return boolean?
---@return string? message
---@return table? details
function PlaneMesh:write(path, options) end

---Lets go at once.
function PlaneMesh:close() end

---@class bw.Mover
---@field mesh bw.PlaneMesh the current one
---@field outline bw.Outline the current one
local Mover = {}

---Takes the mesh to an outline. Of the same topology: relocation of nodes, reconnecting by flips, or
---reconstruction, whatever is enough; of another: reconstruction. The report has `level` ("none",
---"relocation", "reconnecting", "reconstruction"), `flips`, `worst` quality and `worst_element`,
---`restored` and `seconds`. On failure the mover is as it was.
---@param outline bw.Outline
---@return table? report
---@return string? message
---@return table? details
function Mover:follow(outline) end

---The adjoint of relocation: how J grows with the outline's points, from how it grows with the nodes.
---@param gradient table|bw.Array x, y for every node
---@return bw.Array?
---@return string? message
---@return table? details
function Mover:pull_back(gradient) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return bw.Mover
function Mover:check() end

---Lets go at once.
function Mover:close() end

---A flow whose outline is dragged.
---@class bw.Flow
---@field outline bw.Outline as it is now
---@field reused bw.Kept what the last frame kept
---@field time number s
---@field velocity bw.Array x, y at the nodes, m/s
---@field pressure bw.Array at the nodes, Pa
---@field vorticity bw.Array at the nodes, 1/s
---@field signals table<string, number[]> that are recorded
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners, from 1
---@field element_count integer
---@field node_count integer
local Flow = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}; the flow goes on
---from where it was (steady: is found anew).
---@param handle {vertex?: integer, edge?: integer, loop?: string|integer}
---@param by number[]
---@return bw.Flow?
---@return string? message
---@return table? details
function Flow:drag(handle, by) end

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.Flow?
---@return string? message
---@return table? details
function Flow:become(outline) end

---Advances by `count` time steps (default 1).
---@param count? integer
---@return bw.Flow?
---@return string? message
---@return table? details
function Flow:step(count) end

---From now on steps of so many seconds; what is recorded begins anew.
---@param seconds number
---@return bw.Flow
function Flow:pace(seconds) end

---Finds the steady state; where there is none, all is as it was.
---@return bw.Flow?
---@return string? message
---@return table? details
function Flow:settle() end

---From now on records value(flow), a number, after every step, in signals[name]; without value: no longer.
---@param name string
---@param value? fun(flow: bw.Flow): number
---@return bw.Flow
function Flow:record(name, value) end

---Of a recorded signal, 1/s, by its last whole periods (default 5); 0 where it does not swing.
---@param name string
---@param periods? integer
---@return number
function Flow:frequency(name, periods) end

---Of the fluid on the edges with a tag, per depth, N/m (reactions of the last step).
---@param tag string
---@return number
---@return number
function Flow:force(tag) end

---Coefficients of drag and lift: force along and across the stream (default {1, 0}) over density / 2
---velocity^2 length.
---@param tag string
---@param given {velocity: number, length: number, stream?: number[]}
---@return number
---@return number
function Flow:coefficients(tag, given) end

---Heat flow into the fluid through the edges with a tag, over density times heat capacity, K m2/s.
---@param tag string
---@return number
function Flow:heat(tag) end

---That over diffusivity times a difference of temperatures: of a square heated at one side the Nusselt
---number.
---@param tag string
---@param difference number
---@return number
function Flow:nusselt(tag, difference) end

---Velocity x, y, pressure (and temperature) at a place.
---@param x number
---@param y number
---@return number
---@return number
---@return number
function Flow:at(x, y) end

---Pressure at one place less that at another.
---@param from number[]
---@param to number[]
---@return number
function Flow:pressure_drop(from, to) end

---A flow with heat whose outline is dragged.
---@class bw.ThermalFlow
---@field outline bw.Outline as it is now
---@field reused bw.Kept what the last frame kept
---@field time number s
---@field velocity bw.Array x, y at the nodes, m/s
---@field pressure bw.Array at the nodes, Pa
---@field temperature bw.Array at the nodes, K
---@field vorticity bw.Array at the nodes, 1/s
---@field signals table<string, number[]> that are recorded
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners, from 1
---@field element_count integer
---@field node_count integer
local ThermalFlow = {}

---Moves a handle of the outline ({vertex = n}, {edge = n}, {loop = name}) by {dx, dy}; the flow goes on
---from where it was (steady: is found anew).
---@param handle {vertex?: integer, edge?: integer, loop?: string|integer}
---@param by number[]
---@return bw.ThermalFlow?
---@return string? message
---@return table? details
function ThermalFlow:drag(handle, by) end

---Goes over to another outline, of any topology with the same tags.
---@param outline bw.Outline
---@return bw.ThermalFlow?
---@return string? message
---@return table? details
function ThermalFlow:become(outline) end

---Advances by `count` time steps (default 1).
---@param count? integer
---@return bw.ThermalFlow?
---@return string? message
---@return table? details
function ThermalFlow:step(count) end

---From now on steps of so many seconds; what is recorded begins anew.
---@param seconds number
---@return bw.ThermalFlow
function ThermalFlow:pace(seconds) end

---Finds the steady state; where there is none, all is as it was.
---@return bw.ThermalFlow?
---@return string? message
---@return table? details
function ThermalFlow:settle() end

---From now on records value(flow), a number, after every step, in signals[name]; without value: no longer.
---@param name string
---@param value? fun(flow: bw.ThermalFlow): number
---@return bw.ThermalFlow
function ThermalFlow:record(name, value) end

---Of a recorded signal, 1/s, by its last whole periods (default 5); 0 where it does not swing.
---@param name string
---@param periods? integer
---@return number
function ThermalFlow:frequency(name, periods) end

---Of the fluid on the edges with a tag, per depth, N/m (reactions of the last step).
---@param tag string
---@return number
---@return number
function ThermalFlow:force(tag) end

---Coefficients of drag and lift: force along and across the stream (default {1, 0}) over density / 2
---velocity^2 length.
---@param tag string
---@param given {velocity: number, length: number, stream?: number[]}
---@return number
---@return number
function ThermalFlow:coefficients(tag, given) end

---Heat flow into the fluid through the edges with a tag, over density times heat capacity, K m2/s.
---@param tag string
---@return number
function ThermalFlow:heat(tag) end

---That over diffusivity times a difference of temperatures: of a square heated at one side the Nusselt
---number.
---@param tag string
---@param difference number
---@return number
function ThermalFlow:nusselt(tag, difference) end

---Velocity x, y, pressure (and temperature) at a place.
---@param x number
---@param y number
---@return number
---@return number
---@return number
---@return number
function ThermalFlow:at(x, y) end

---Pressure at one place less that at another.
---@param from number[]
---@param to number[]
---@return number
function ThermalFlow:pressure_drop(from, to) end

---What stands behind flows: a fluid and the mesh that follows. `frame` is a table that is filled with what
---was kept (bw.Kept).
---@class bw.FlowBody
---@field outline bw.Outline
---@field velocity bw.Array
---@field pressure bw.Array
---@field temperature bw.Array?
---@field vorticity bw.Array
---@field points bw.Array
---@field elements bw.Array
---@field time number
local FlowBody = {}

---@param frame table
---@param outline bw.Outline
---@return table?
---@return string? message
---@return table? details
function FlowBody:follow(frame, outline) end

---Time steps; with step 0 to the steady state.
---@param frame table
---@param solver? table
---@param options? {step?: number, bdf?: integer, iterations?: integer, tolerance?: number, ale?: boolean}
---@param steps? integer
---@return table?
---@return string? message
---@return table? details
function FlowBody:step(frame, solver, options, steps) end

---@param tag string
---@return number x
---@return number y
function FlowBody:force(tag) end

---@param tag string
---@return number
function FlowBody:heat(tag) end

---What mesh and body are at.
---@return bw.BodyState
function FlowBody:keep() end

---Back to what was kept, bit for bit.
---@param state bw.BodyState
---@return table?
---@return string? message
---@return table? details
function FlowBody:return_to(state) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return table
function FlowBody:check() end

---@param x number
---@param y number
---@return number ...
function FlowBody:at(x, y) end

---@return integer elements
---@return integer nodes
function FlowBody:counts() end

function FlowBody:close() end

---What a body that follows an outline, and its mesh, were at.
---@class bw.BodyState
local BodyState = {}

function BodyState:close() end

---Requirements as scripts, run by `barwright test`: `scenario("title", {tags = {"slow"}, skip = "why",
---about = "...", seconds = 600, memory = 4e9}, function(t) ... end)`; the table may be left out.
---@class bw.ScenarioModule
---@overload fun(title: string, options?: table, work: fun(t: bw.Test))
local scenario_module = {}

---Title and text of the file, for reports and manuals.
---@param about {title: string, text: string}
function scenario_module.about(about) end

---A figure to be judged, with what it is and its unit; or whatever a call returned: where that is nil
---and a message, the expectation fails with the message.
---@param figure any
---@param what? string
---@param unit? string
---@return bw.Expectation
function scenario_module.expect(figure, what, unit) end

---What must hold of a figure. A failed expectation is kept and the scenario goes on; `t:require` of what
---it returns stops there. Every form takes {source = "...", how = "..."} for reports.
---@class bw.Expectation
local Expectation = {}

---At most the bound.
---@param bound number
---@param options? {source: string, how: string}
---@return boolean good
---@return string? message
function Expectation:below(bound, options) end

---At least the bound.
---@param bound number
---@param options? {source: string, how: string}
---@return boolean good
---@return string? message
function Expectation:above(bound, options) end

---From low to high.
---@param low number
---@param high number
---@param options? {source: string, how: string}
---@return boolean good
---@return string? message
function Expectation:between(low, high, options) end

---Within `absolute` of the reference, or `relative` of its size, whichever is more; of arrays and lists
---every value, relative to the largest.
---@param reference number|bw.Array|table
---@param options {relative: number, absolute: number, source: string, how: string}
---@return boolean good
---@return string? message
function Expectation:near(reference, options) end

---Exactly this: numbers to the last bit, texts, truth values, tables of these.
---@param other any
---@param options? {source: string, how: string}
---@return boolean good
---@return string? message
function Expectation:equals(other, options) end

---Neither nil nor false.
---@param options? {source: string, how: string}
---@return boolean good
---@return string? message
function Expectation:is_true(options) end

---Of a function, or of what a call returned: it must fail, with a status word and a text in its message;
---{raises = "text"}: by raising an error.
---@param status? string|{status: string, message: string, raises: string, source: string, how: string}
---@param message? string
---@param options? {source: string, how: string}
---@return boolean good
---@return string? message
function Expectation:fails_with(status, message, options) end

---The same modes as others, whatever their signs and whatever the order and the mix of those whose
---frequencies are nearer than `degenerate` (1e-4): frequencies within `relative` (1e-6), of each such group
---the space that it spans within `shapes` (1e-3, the sine of an angle; false: not compared); `last = false`
---leaves the shapes of the last group out, which may be cut.
---@param other bw.Modes
---@param options? {relative: number, degenerate: number, shapes: number|false, last: boolean, source: string, how: string}
---@return boolean good
---@return string? message
function Expectation:same_modes(other, options) end

---What was measured before, kept in baselines/FILE/NAME.json beside the scenario file and written by
---`barwright test --update`: numbers, texts, arrays, tables of these, a static result, modes.
---@param name string
---@param options? {relative: number, absolute: number, degenerate: number, shapes: number, last: boolean, source: string, how: string}
---@return boolean good
---@return string? message
function Expectation:matches_baseline(name, options) end

---What a scenario's function is given.
---@class bw.Test
---@field folder string a scratch folder, removed at the end
local Test = {}

---The values, where the first is there; else the scenario ends here as failed, with the message. Also
---takes what an expectation returns.
---@param value any
---@param message? string
---@return any ...
function Test:require(value, message) end

---Ends the scenario without judging it: what it needs is not there.
---@param reason string
function Test:skip(reason) end

---A sentence for reports and manuals, with values as string.format has them.
---@param text string
---@param ... any
function Test:note(text, ...) end

---A plain table for reports and manuals.
---@param table {heads: string[], rows: any[][], text: string}
function Test:table(table) end

---Drawn into the output folder when the scenario fails: an object with a picture (of modes the one that
---{mode = n} names), a figure of bw.plot, or a function of a path.
---@param object any
---@param options? table those of the picture; caption
function Test:picture_of(object, options) end

---A drawing of lines, markers, text and images, in pixels from the top left corner, y downwards: to be
---written as SVG or PNG. Plots (bw.plot) are made of these.
---@param width number
---@param height number
---@param options? {name?: string} name: what it shows, for those who cannot see it
---@return bw.Canvas?
---@return string? message
---@return table? details
function bw.canvas(width, height, options) end

---A drawing. Points are rows of two numbers or a flat list x, y, x, y; where one is not finite a line
---breaks. A pen is {fill, stroke, width, dash, round}: colours "#rrggbb" or "#rrggbbaa", the stroke's width
---(1), lengths on and off, round ends and corners. What is drawn later lies above. Each drawing method
---returns the canvas.
---@class bw.Canvas
---@field width number
---@field height number
local Canvas = {}

---@param points bw.Array|number[][]|number[]
---@param pen? table
---@return bw.Canvas?
function Canvas:line(points, pen) end

---A closed line, filled by the even-odd rule: loops within are holes.
---@param points bw.Array|number[][]|number[]
---@param pen? table
---@return bw.Canvas?
function Canvas:polygon(points, pen) end

---@param x number
---@param y number
---@param width number
---@param height number
---@param pen? table
---@param radius? number of the corners
---@return bw.Canvas?
function Canvas:rectangle(x, y, width, height, pen, radius) end

---Markers `size` pixels across. Where the pointer rests on one an SVG shows its note.
---@param kind "disc"|"square"|"diamond"|"triangle"|"triangle_down"|"cross"|"plus"
---@param size number
---@param points bw.Array|number[][]|number[]
---@param pen? table
---@param notes? string[] one for each point, or false
---@return bw.Canvas?
function Canvas:markers(kind, size, points, pen, notes) end

---Text on a baseline; align 0 (begins at x), 0.5 or 1 (ends there); angle in degrees, counterclockwise;
---halo: a pale rim.
---@param text string
---@param x number
---@param y number
---@param options? {size?: number, align?: number, angle?: number, colour?: string, bold?: boolean, halo?: boolean}
---@return bw.Canvas?
function Canvas:text(text, x, y, options) end

---How wide a text will be, in pixels.
---@param text string
---@param size number
---@param bold? boolean
---@return number?
function Canvas:text_width(text, size, bold) end

---What is drawn until `leave` is cut at the box; there the part `view` {x, y, width, height} of a drawing
---of its own is seen, as large as fits. Without a view coordinates stay.
---@param x number
---@param y number
---@param width number
---@param height number
---@param view? number[]
---@return bw.Canvas?
function Canvas:enter(x, y, width, height, view) end

---@return bw.Canvas?
function Canvas:leave() end

---A PNG file, as large as fits in the box; one with more pixels than are seen is reduced.
---@param path string
---@param x number
---@param y number
---@param width number
---@param height number
---@return bw.Canvas?
---@return string? message
---@return table? details
function Canvas:image(path, x, y, width, height) end

---Rows of pixels, three bytes each (red, green, blue), from the top, stretched to the box.
---@param bytes string
---@param columns integer
---@param x number
---@param y number
---@param width number
---@param height number
---@return bw.Canvas?
function Canvas:pixels(bytes, columns, x, y, width, height) end

---By the ending: .svg, or .png with `scale` (2) pixels for each of the drawing's. With `outlines` (true)
---the text in an SVG is paths, which look the same everywhere.
---@param path string
---@param options? {scale?: number, outlines?: boolean}
---@return boolean?
---@return string? message
---@return table? details
function Canvas:write(path, options) end

---One <svg> element for a page; text is text unless `outlines`.
---@param options? {outlines?: boolean}
---@return string?
---@return string? message
---@return table? details
function Canvas:svg(options) end

function Canvas:close() end

---Plots: plain data in, a figure out. An axis is its label, or {label, unit, scale = "linear" | "log", least,
---most, prefix = true, whole}: values are in the unit, what is written at the axis may have an SI prefix.
---Lists of numbers are tables or arrays; what is not finite is left out and counted at the foot. Every kind
---takes title, width and height (pixels) too; unknown options raise.
---@class bw.PlotModule
local PlotModule = {}

---Lines through points in their order. A series: {name, y, x (1, 2, ... without), low and high: a band,
---colour, dashed, steps, markers, width}. marks: lines across, {{x = or y =, name}}.
---@param options {series: table[], x?: table|string, y?: table|string, marks?: table[], notes?: string[], legend?: boolean, diagonal?: boolean}
---@return bw.Figure
function PlotModule.lines(options) end

---Points. A series: {name, x, y, low and high: intervals, values: colours by the axis `values`, notes,
---colour, marker, size}.
---@param options {series: table[], x?: table|string, y?: table|string, values?: table|string, marks?: table[], notes?: string[], legend?: boolean, diagonal?: boolean}
---@return bw.Figure
function PlotModule.scatter(options) end

---Bars from 0: for each name one of every series {name, values, low, high, colour}.
---@param options {names: string[], series: table[], value?: table|string, label?: string, horizontal?: boolean, notes?: string[], legend?: boolean}
---@return bw.Figure
function PlotModule.bars(options) end

---The value of each trial in their order, and the best so far; those that miss a constraint (feasible: false)
---and those without a result (failed: true, or no number) are marked.
---@param options {values: number[], numbers?: integer[], goal?: "least"|"most", failed?: boolean[], feasible?: boolean[], label?: string, unit?: string, scale?: "linear"|"log", notes?: string[], trial?: string}
---@return bw.Figure
function PlotModule.history(options) end

---Two objectives with the front and what it beats; three to six pair by pair. An objective: {name, unit,
---goal = "least" | "most", values, scale}.
---@param options {objectives: table[], feasible?: boolean[], front?: integer[], notes?: string[]}
---@return bw.Figure
function PlotModule.pareto(options) end

---Two to ten columns against each other: points below the diagonal, how often on it, rank correlations
---above. A column: {name, unit, values: numbers or names, of: all names, scale, whole}. values: what colours
---the points, value: its axis; chosen: places that stand out; faint: flags of those that stand back.
---@param options {columns: table[], values?: number[], value?: table|string, goal?: "least"|"most", chosen?: integer[], faint?: boolean[], notes?: string[]}
---@return bw.Figure
function PlotModule.scatter_matrix(options) end

---Rows of two to 24 columns as lines over upright axes; options as those of scatter_matrix. The best by the
---coloured values lie on top.
---@param options {columns: table[], values?: number[], value?: table|string, goal?: "least"|"most", chosen?: integer[], faint?: boolean[]}
---@return bw.Figure
function PlotModule.parallel_coordinates(options) end

---What matters: Sobol's indices (first, total) as bars with intervals (first_low, first_high, total_low,
---total_high), Morris' effects (mu_star, sigma, mu_star_low, mu_star_high) in a plane, or one variable at a
---time (low, high: the measure at its least and most; base). label, unit: of the measure.
---@param options {names: string[], first?: number[], total?: number[], mu_star?: number[], sigma?: number[], low?: number[], high?: number[], base?: number, label?: string, unit?: string}
---@return bw.Figure
function PlotModule.sensitivity(options) end

---Errors against size, both logarithmic, with triangles of the slope of each series {name, x, y, slope: what
---it should be, last: so many of the finest are fitted}; the fitted slope stands in the legend.
---@param options {series: table[], x?: table|string, y?: table|string, triangles?: boolean}
---@return bw.Figure
function PlotModule.convergence(options) end

---Pictures in a grid: {path: a PNG file, or figure, caption, chosen: a frame around it}. cell: their width in
---pixels (230), ratio: height by width, lines: of a caption (2).
---@param options {pictures: table[], title?: string, columns?: integer, cell?: number, ratio?: number, lines?: integer}
---@return bw.Figure
function PlotModule.contact_sheet(options) end

---What a plot gives: drawn anew for each file.
---@class bw.Figure
---@field kind string
---@field name string
---@field width number
---@field height number
local Figure = {}

---By the ending: .svg or .png. text: "paths" (default, looks the same everywhere) or "text"; scale: pixels
---of a PNG for each of the figure's (2).
---@param path string
---@param options? {text?: "paths"|"text", scale?: number}
---@return boolean?
---@return string? message
---@return table? details
function Figure:write(path, options) end

---One <svg> element for a page. text: "text" (default) or "paths".
---@param options? {text?: "paths"|"text"}
---@return string?
---@return string? message
---@return table? details
function Figure:svg(options) end

---Where a point of the data lies, in pixels from the figure's top left corner; nil for figures of several
---frames.
---@param x number
---@param y number
---@return number? x
---@return number? y
function Figure:place(x, y) end

---Studies: how many runs of a model are asked for, done once each, kept, and read. Called, it makes one.
---docs/howto_study.md begins at the beginning.
---@class bw.StudyModule
---@overload fun(options: bw.StudyOptions): bw.Study
local StudyModule = {}

---@class bw.StudyOptions
---@field name string
---@field seed? integer default 1
---@field file? string where trials are kept; default NAME.study
---@field variables table[] {name, least, most, unit, scale = "linear"|"log"}, {name, kind = "integer", least, most} or {name, kind = "choice", of = {...}}; default = a value
---@field measures table[] {name, unit, optional}: the numbers that run returns
---@field objectives? table[] {name, goal = "least"|"most"}
---@field constraints? table[] {name, least, most}
---@field design table|fun(evaluate: function, problem: table, options: table): table {"latin_hypercube", count = 100}; see design names
---@field run fun(point: table, trial: bw.Trial): table?, any, any measures by name, and gradients where there are any; nil and a message for a trial that failed
---@field cache? {folder?: string, bytes?: number}
---@field what? string a sentence for people

---Saves what can be read of a damaged file of a study into a new one. Trials that do not match their
---checksums are left out, or asked again where their points are sound: the next run on the new file runs them.
---@param path string a regular file
---@param into string a file that is not there yet
---@return table? report tables, rows, lost, whole, relisted, log
---@return string? message
---@return table? details
function StudyModule.salvage(path, into) end

---The names of all designs.
---@return string[]
function StudyModule.designs() end

---The volume that vectors of costs, all to be small, dominate below a reference.
---@param costs number[][]
---@param reference number[]
---@return number
function StudyModule.hypervolume(costs, reference) end

---@class bw.Study
---@field name string
---@field seed integer
---@field file string
---@field problem table variables, measures, objectives, constraints, completed
---@field design table
---@field trial_folder string where folders of trials lie
---@field script table path and text of the script
---@field run_function function
---@field cache_options table
---@field what string?
local Study = {}

---Runs what is missing of the design's trials, each in a process of its own; what is done before stays. Ends
---early by stop_when(trials so far, in order), after `evaluations` different points, or `seconds_total`;
---seconds and bytes are limits of one trial. retry: trials that failed once more; continue: with a script that
---has changed; output: what trials print goes to output.txt in their folders; shard = {2, 10}: the second of
---ten parts; executor: who runs trials (lua/barwright/study/executor.lua); design: another one than the study's,
---on the same file.
---@param options? {design?: table, workers?: integer, seconds?: number, bytes?: number, stop_when?: function, evaluations?: integer, seconds_total?: number, retry?: boolean, continue?: boolean, output?: boolean, shard?: integer[], executor?: any}
---@return bw.Trials?
---@return string? message
---@return table? details
function Study:run(options) end

---The trials of the file that have ended, by number.
---@return bw.Trials?
---@return string? message
---@return table? details
function Study:trials() end

---How far it is, from the file: done, failed, time, memory, crashed, asked, planned, missing, seconds, running.
---@return table?
---@return string? message
---@return table? details
function Study:status() end

---All trials of the file as a table (RFC 4180).
---@param path string
---@return boolean?
---@return string? message
---@return table? details
function Study:csv(path) end

---Takes over the trials of other files of the same study: taken, duplicates, conflicts.
---@param files string[]|string
---@param options? {continue?: boolean}
---@return table?
---@return string? message
---@return table? details
function Study:merge(files, options) end

---Runs one trial again, by number, the beginning of its key, or a point: trial, before, same (all numbers are
---the same bits), differences. inside: in this process.
---@param which integer|string|table
---@param options? {inside?: boolean, seconds?: number, bytes?: number}
---@return table?
---@return string? message
---@return table? details
function Study:trial(which, options) end

---What `make` returns, made once for all processes and runs and kept in the cache's folder: a mesh, a
---surface, a library, arrays, numbers, strings, tables of these. `what` says what it is; files: files whose
---content matters too.
---@param what any
---@param make fun(): any
---@param options? {files?: string[]}
---@return any
---@return string? message
---@return table? details
function Study:cached(what, make, options) end

---The points that the design will ask for with their keys; nil where they depend on results.
---@return {point: table, key: string}[]?
function Study:planned() end

---The same study with another file.
---@param path string
---@return bw.Study
function Study:use_file(path) end

---What makes the results: program, version, libraries, processors.
---@return table
function Study:manifest() end

---What a study's function gets beside the point.
---@class bw.Trial
---@field number integer
---@field key string
---@field seed integer
---@field point table
---@field study bw.Study
---@field folder string for files of this trial, made when it is asked for
local Trial = {}

---As math.random, from the trial's own seed.
---@param a? integer
---@param b? integer
---@return number
function Trial:random(a, b) end

---A number of the normal distribution, from the trial's own seed.
---@param mean? number
---@param deviation? number
---@return number
function Trial:normal(mean, deviation) end

---See Study:cached.
---@param what any
---@param make fun(): any
---@param options? {files?: string[]}
---@return any
function Trial:cached(what, make, options) end

---A list of trials that have ended: number, key, seed, status ("done", "failed", "time", "memory",
---"crashed"), message, seconds, processor_seconds, peak_bytes, attempts, point, results, gradients, folder.
---@class bw.Trials
---@field problem table
---@field study bw.Study
---@field summary table of the design: best, front, indices, effects, ranges, starts, ...
---@field stopped string? why the design was ended early
local Trials = {}

---The values of a variable or a measure, one for each trial that is done; all: of every trial, false where
---there is none.
---@param name string
---@param options? {all: boolean}
---@return any[]
function Trials:column(name, options) end

---Those of a status, or those that a function chooses.
---@param which string|fun(trial: table): boolean
---@return bw.Trials
function Trials:where(which) end

---The best by the first objective, or the one named, of those that keep the constraints.
---@param name? string
---@return table?
---@return string? message
---@return table? details
function Trials:best(name) end

---Those that none beats in every objective, of those that keep the constraints.
---@return bw.Trials
function Trials:front() end

---How many there are of each status.
---@return table<string, integer>
function Trials:counts() end

---As a table for other programs (RFC 4180), units in the head.
---@param path string
---@return boolean?
---@return string? message
---@return table? details
function Trials:csv(path) end

---A figure with the study's names, units, goals and constraints: history (measure, goal, scale), convergence
---(how the search came closer to the best, or its front to the last one), pareto (objectives: names), scatter
---(x, y, colour: names), scatter_matrix and parallel_coordinates (columns: names, colour), sensitivity
---(measure; of the designs sobol_indices, morris, one_at_a_time), contact_sheet (picture: the file's name,
---most, columns, cell). All take title, width, height.
---@param kind string
---@param options? table
---@return bw.Figure?
---@return string? message
---@return table? details
function Trials:plot(kind, options) end

---One HTML file that needs no network: what was asked and found, failures, plots, pictures of the trials'
---folders (`picture`: the file's name, else picture.png or the first PNG), all trials.
---@param path string
---@param options? {title?: string, text?: string, picture?: string, pictures?: integer, rows?: integer, manifest?: table}
---@return boolean?
---@return string? message
---@return table? details
function Trials:report(path, options) end

-- ---- thickness under a surface ---------------------------------------------------------------------

---How thick the body is under places of its surface that have equal shares of the area (1000 of them): the
---way straight in until the wall on the other side, inf where there is none.
---@param samples? integer
---@return bw.Array? thickness
---@return bw.Array|string places or a message
---@return table? details
function Surface:thickness(samples) end

-- ---- several processes -----------------------------------------------------------------------------

---require "barwright.distributed": the processes that mpirun started. Raises where barwright was built
---without MPI. A solve with `with = "petsc"` loads it by itself; `barwright --mpi` calls start.
---@class bw.Distributed
local Distributed = {}

---Join the others. On rank 0 it returns the number of ranks; on the others it does not return: they work
---for the solves of rank 0 and end with it.
---@return integer? size
---@return string? message
function Distributed.start() end

---Join without serving, for programs whose ranks talk by send and receive.
---@return integer? rank from 0
---@return integer|string size or a message
function Distributed.join() end

---A world of one where none was joined; refused under mpirun without start.
---@return integer? rank
---@return integer|string size or a message
function Distributed.ready() end

---@return integer rank from 0
function Distributed.rank() end

---@return integer size
function Distributed.size() end

---@param rank integer
---@param tag integer 0 to 1000
---@param bytes string
---@return boolean?
---@return string? message
---@return table? details
function Distributed.send(rank, tag, bytes) end

---The next string from any rank; nil when none came in time (negative: wait as long as it takes).
---@param seconds number
---@return integer? rank
---@return integer|string? tag or a message
---@return string? bytes
function Distributed.receive(seconds) end

---End all ranks now, with a sentence on standard error.
---@param message string
function Distributed.abort(message) end

---Versions of MPI, PETSc and SLEPc, a line each.
---@return string?
function Distributed.versions() end
---The sandbox that the program runs the script in: the folder that it may use, which version of the kernel's
---Landlock holds it (0: none) and whether its system calls are filtered; nil outside of a sandbox.
---@return {folder: string, landlock: integer, calls: boolean}?
function bw.sandbox() end

return bw
