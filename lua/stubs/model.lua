---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Models
--
-- A model is a part: a mesh of a material with supports and loads. It gives static solutions and modes.

---@class bw
local bw = {}

---A model without supports and loads. B-bar elements cure volumetric locking of quadratic elements in nearly incompressible
---materials. B-bar with linear elements raises, and so do bodies that overlap in more than a tenth of the smaller one.
---
---Source: T. J. R. Hughes, Int. J. Numer. Meth. Eng. 15 (1980); docs/theory/elements.md.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.1), force = {0, 0, -10}}
---print(part)
---```
---@param options bw.ModelOptions mesh and material
---@return bw.Model model the part
function bw.model(options) end

---Mesh and material of a model.
---@class bw.ModelOptions
---@field mesh bw.Mesh the mesh
---@field material? bw.Material the material of all elements; needed without `materials`
---@field materials? table<string, bw.Material> the material of each region of the mesh, by its name; instead of `material`
---@field formulation? "standard"|"b_bar" of the elements. Default: that of the material, "standard" unless it is another model's of B-bar elements

---A mesh of a material with supports and loads. Methods that change it return it, so that calls can be chained. `print` shows
---every support and load with its area and resultant.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {20, 2, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.1), force = {0, 0, -10}}
---local static = assert(part:solve())
---print(static.displacement:column(3):min(), static.von_mises:max())
---```
---@class bw.Model
---@field mesh bw.Mesh its mesh
---@field material bw.Material its material, with the formulation of its elements; with several `parts` as `materials` gave them
---@field formulation "standard"|"b_bar" of its elements
---@field locking string? a warning of volumetric locking, with its cure, where standard elements have a Poisson's ratio above 0.48; nil otherwise. A solution reports it
---@field loads bw.Load[] in the order in which they were added
---@field supports bw.Support[] in the order in which they were added
---@field bonds bw.Bond[] in the order in which they were added
---@field attachments bw.Attachment[] in the order in which they were added
---@field couplings bw.Coupling[] in the order in which they were added
---@field cyclic_symmetry bw.CyclicSymmetry? nil where the body is the whole
local Model = {}

---A load of a model.
---@class bw.Load
---@field kind "pressure"|"traction"|"force"|"torque"|"gravity"|"nodal"|"temperature" what it is
---@field value? number|bw.Vector (any) Pa of a pressure, a vector in Pa of a traction, N of a force, N m of a torque, m/s2 of gravity; nil of nodal forces and temperatures
---@field area number (m2) that it acts on; 0 of gravity, nodal forces and temperatures
---@field resultant bw.Vector (N) its resultant force
---@field moment bw.Vector (N m) its moment about the origin

---A support of a model.
---@class bw.Support
---@field on bw.Selection what it holds
---@field slide boolean whether it holds along normals only
---@field displacement (number|false)[] (m, 3) prescribed, false where it leaves a direction free
---@field direction? bw.Vector (-) the normal of a sliding support that was given one
---@field symmetry? "symmetric"|"antisymmetric" of a plane of symmetry: one support of a symmetric one, two of an antisymmetric one

---A bond of a model.
---@class bw.Bond
---@field a bw.Selection the side that follows
---@field b bw.Selection the side that it follows
---@field area number (m2) of side a that is bonded
---@field gap number (m) the largest one between what is bonded
---@field node_count integer (count) nodes of side a that follow
---@field preload? number (N) that was given
---@field shortening? number (m) that was given

---The cyclic symmetry of a sector.
---@class bw.CyclicSymmetry
---@field low bw.Selection the face that turns into the other one
---@field high bw.Selection that other one
---@field count integer (count) of sectors in the whole
---@field axis bw.Vector (-) unit vector: about it `low` turns into `high` by a full turn over `count`
---@field about bw.Vector (m) a point on the axis
---@field distance number (m) the largest one between nodes that match
---@field axis_node_count integer (count) nodes on the axis, which both faces have

---A mass or a spring of a model.
---@class bw.Attachment
---@field on bw.Selection what it is attached to
---@field area number (m2) that it is spread over; 0 at single nodes
---@field mass? number (kg) in all; nil of a spring
---@field spring? bw.Vector (N/m) stiffness in all, along x, y and z; nil of a mass

---A coupling of a face with a remote point.
---@class bw.Coupling
---@field on bw.Selection what is coupled
---@field kind "rigid"|"distributed" how the face follows the point
---@field at bw.Vector (m) the remote point
---@field area number (m2) of the face; 0 of single nodes
---@field node_count integer (count) nodes that are coupled
---@field force bw.Vector (N) on the remote point
---@field moment bw.Vector (N m) on the remote point

---Fixes a selection in all directions. A selection without a facet raises, unless it is a node set. A warning states where it
---misses more than a tenth of a face along its border.
---@param selection bw.Selection what is fixed
---@return bw.Model self
function Model:fix(selection) end

---Lets a selection slide along its surface, or across a given normal.
---@param selection bw.Selection what slides
---@param normal? bw.Vector (-) the direction that is fixed, of any length but 0. Default: at each node the normal of its surface
---@return bw.Model self
function Model:slide(selection, normal) end

---Makes a plane face of any orientation a plane of symmetry: the displacement along its normal is zero. On a plane of
---antisymmetry those within the plane are zero. Loads, mass, energy, reactions and modes are those of the part that is modelled.
---A selection without a facet raises.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {20, 2, 2}}
---local half = bw.model {mesh = mesh, material = bw.material.steel}
---half:symmetry(mesh.boundary:below("x", 0))
---print(half)
---```
---
---Errors: geometry (the face is not plane, with the deviation).
---
---Source: docs/theory/symmetry.md.
---@param selection bw.Selection the plane face
---@param kind? "symmetric"|"antisymmetric" of the loads and the displacement. Default: "symmetric"
---@return bw.Model? self the model
---@return string? message
---@return bw.Details? details
function Model:symmetry(selection, kind) end

---Prescribes the displacement of a selection. Supports that contradict each other at a node raise when the model is solved.
---@param selection bw.Selection what is moved
---@param displacement (number|false)[]|bw.Array (m, 3; or node_count × 3, per node) {x, y, z} with false where a direction is free, or a row for every node of the mesh
---@return bw.Model self
function Model:prescribe(selection, displacement) end

---Bonds two surfaces of the mesh, whose nodes need not match. Side a follows side b where they touch. Make a the side that the
---other one covers. Constant stress passes through a plane bond exactly. A model with bonds gives static solutions, modes, load factors,
---harmonic responses with random vibration, response spectra, transients, contact and `bw.worst_case`. Other analyses
---refuse it. A side without a facet, and a node on both sides, raise.
---
---A bond can have a preload across a plane section, as of a bolt: give the force first, then keep the `shortening` that the
---static solution gives, and add the loads of operation. Modes keep the shortening. `Mesh:separated` cuts a shank between
---regions.
---```lua
---local mesh = bw.mesh.box({max = {0.1, 0.01, 0.01}, cells = {10, 1, 1}}):split({max = {0.05, 1, 1}}, "left"):separated "left"
---local part, boundary = bw.model {mesh = mesh, material = bw.material.steel}, mesh.boundary
---local cut = boundary:plane({0.05, 0, 0}, {1, 0, 0}, 1e-9)
---part:fix(boundary:below("x", 0)):fix(boundary:above("x", 0.1))
---part:bond {a = cut & boundary:region "left", b = cut & boundary:region "rest", preload = 1000}
---print(assert(part:solve()).bonds[1].shortening)
---```
---
---Errors: geometry (a section with a preload that is not plane; sides that do not touch, with the distance; facets of side a that side b hardly covers).
---
---Source: Popp, Wohlmuth, Gee, Wall, SIAM J. Sci. Comput. 34 (2012); docs/theory/joints.md.
---@param options bw.BondOptions the two sides
---@return bw.Model? self the model
---@return string? message
---@return bw.Details? details
function Model:bond(options) end

---The sides of a bond.
---@class bw.BondOptions
---@field a bw.Selection the side that follows
---@field b bw.Selection the side that it follows
---@field gap? number (m) gap that is closed. Default: a twentieth of the mean edge of the finer side
---@field preload? number (N) force that pulls the sides together, as in the shank of a bolt; it stays whatever other loads act. Side a is plane. Default: none
---@field shortening? number (m) instead: by which the sides overlap, as a nut that was turned; the force follows. Default: none

---Removes all bonds.
---@return bw.Model self
function Model:clear_bonds() end

---Makes the body one of `count` equal sectors of a wheel. The face `low`, turned by a full turn over `count` about the axis, is the
---face `high`: their nodes and facets match one to one. The axis may look either way. Loads, supports, masses and results are
---those of one sector. A sector gives static solutions and modes; other analyses refuse it. It takes bonds whose side a ends inside
---it, and neither preloads nor couplings. A second cyclic symmetry, fewer than two sectors and a selection without a facet raise.
---```lua
---local box = bw.mesh.box {max = {1, 1, 0.3}, cells = {3, 3, 1}}
---local part = bw.model {mesh = box, material = bw.material.steel}
---local low, high = box.boundary:below("y", 0), box.boundary:below("x", 0)
---assert(part:cyclic {low = low, high = high, count = 4})
---local modes = assert(part:modes {count = 6})
---print(part, modes, table.concat(modes.nodal_diameters, " "))
---```
---
---Errors: geometry (faces that do not match, with angle or distance; an axis that passes elements away from their edges),
---unsupported (a model with preloads or couplings).
---
---Source: Thomas, Int. J. Numer. Meth. Eng. 14 (1979); docs/theory/symmetry.md.
---@param options bw.CyclicOptions faces, number of sectors and axis
---@return bw.Model? self the model
---@return string? message
---@return bw.Details? details
function Model:cyclic(options) end

---The sectors of a cyclic symmetry.
---@class bw.CyclicOptions
---@field low bw.Selection a cut face of the sector
---@field high bw.Selection the other one
---@field count integer (count) of sectors in the whole. Range: 2 or more
---@field axis? bw.Vector (-) direction of the axis, of any length but 0. Default: {0, 0, 1}
---@field about? bw.Vector (m) a point on the axis. Default: {0, 0, 0}

---Removes the cyclic symmetry.
---@return bw.Model self
function Model:clear_cyclic() end

---The model of the whole wheel of a sector, without cyclic symmetry. Supports, bonds, attachments, loads and axes of the material
---turn with the sectors. Its nodes are the sector's but those of the high face, turned sector by sector, then those on the axis. A model
---without cyclic symmetry raises.
---
---Errors: unsupported (displacements that are prescribed by a field or in some directions only, springs that differ along x,
---y and z), limit (too many nodes).
---@return bw.Model? model of the whole
---@return string? message
---@return bw.Details? details
function Model:whole() end

---Attaches a mass, or springs to the ground, to a selection: exactly one of them. It is spread evenly over the area, or over the
---nodes of a node set without a facet. Gravity acts on a mass, and modes move it; it does not stiffen the body. Springs restrain
---rigid-body modes as supports do. A model with attachments gives what one with bonds gives. A selection without a facet
---raises, unless it is a node set.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {20, 2, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:attach {on = mesh.boundary:below("x", 0), spring = {1e6, 1e6, 1e6}}
---part:attach {on = mesh.boundary:above("x", 0.1), mass = 0.05}
---print(assert(part:modes {count = 3}).frequencies)
---```
---
---Errors: geometry (facets without area).
---
---Source: docs/theory/joints.md.
---@param options bw.AttachOptions the mass or the springs
---@return bw.Model? self the model
---@return string? message
---@return bw.Details? details
function Model:attach(options) end

---A mass or springs.
---@class bw.AttachOptions
---@field on bw.Selection what it is attached to
---@field mass? number (kg) in all, more than 0
---@field spring? bw.Vector (N/m) stiffness in all, along x, y and z, each 0 or more, not all 0

---Removes all masses and springs.
---@return bw.Model self
function Model:clear_attachments() end

---Couples a face with a remote point, which has a displacement and a rotation. A rigid coupling moves all nodes of the face as a
---rigid body with the point. A distributed coupling leaves the face free to deform: the point moves as the face does in the mean,
---and its force and moment spread over the face as tractions that vary linearly. The point can carry a force, a moment, a mass and
---springs to the ground, and its displacement and rotation can be prescribed. `static.couplings` has its motion and reactions.
---Supports on nodes of a rigid coupling must agree with what the point prescribes. A model with couplings gives what one with
---bonds gives; `curve` of a harmonic response knows remote points. A selection without a facet raises, unless it is
---a node set. Nodes in two rigid couplings raise.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {20, 2, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0))
---part:couple {on = mesh.boundary:above("x", 0.1), at = {0.15, 0.005, 0.005}, force = {0, 0, -20}}
---print(assert(part:solve()).couplings[1].rotation)
---```
---
---Errors: geometry (facets without area, nodes on one line, a remote point farther away than 10000 times the smallest radius of
---gyration of its face). `part:solve` and `part:modes` refuse nodes that a support or a bond moves otherwise, prescribed values
---that are over-constrained, and more than 2000 nodes of a distributed coupling with a mass, springs or prescribed values.
---
---Source: docs/theory/joints.md.
---@param options bw.CoupleOptions the face and the remote point
---@return bw.Model? self the model
---@return string? message
---@return bw.Details? details
function Model:couple(options) end

---A face and its remote point.
---@class bw.CoupleOptions
---@field on bw.Selection the face, or a node set
---@field kind? "rigid"|"distributed" how the face follows. Default: "distributed"
---@field at? bw.Vector (m) the remote point. Default: the centre of the area, or of the nodes
---@field force? bw.Vector (N) on the point. Default: 0
---@field moment? bw.Vector (N m) on the point. Default: 0
---@field mass? number (kg) at the point, 0 or more; gravity acts on it. Default: 0
---@field inertia? number[] (kg m2, 3 or 6) of the mass about the point, as a tensor {xx, yy, zz, yz, zx, xy}; three numbers leave the others 0. Default: 0
---@field spring? bw.Vector (N/m) to the ground, along x, y and z, 0 or more. Default: 0
---@field rotational_spring? bw.Vector (N m/rad) to the ground, about x, y and z, 0 or more. Default: 0
---@field displacement? (number|false)[] (m, 3) prescribed, false where a component is free. Default: free
---@field rotation? (number|false)[] (rad, 3) prescribed, false where a component is free. Default: free

---Removes all couplings.
---@return bw.Model self
function Model:clear_couplings() end

---Removes all supports.
---@return bw.Model self
function Model:clear_supports() end

---Adds an acceleration of the whole body. A material without a density raises.
---@param acceleration bw.Vector (m/s2) such as {0, 0, -9.81}
---@return bw.Model self
function Model:gravity(acceleration) end

---Adds a load: exactly one of force, traction, pressure, torque and nodal forces. A selection without a facet raises.
---
---Errors: geometry (facets without area, or without a lever for a torque).
---@param options bw.ModelLoadOptions the load
---@return bw.Model? self the model
---@return string? message
---@return bw.Details? details
function Model:load(options) end

---A load. A torque is a couple: its moment is the same about every point, and it has no resultant force.
---@class bw.ModelLoadOptions
---@field on? bw.Selection what it acts on; needed but for nodal forces
---@field force? bw.Vector (N) the total, spread evenly over the area
---@field traction? bw.Vector (Pa) force per area
---@field pressure? number (Pa) positive pushes inwards
---@field torque? bw.Vector (N m) by a tangential traction
---@field about? bw.Vector (m) with `net_force`: the point that the traction turns about. Without it, it changes nothing
---@field net_force? boolean the traction turns about `about`; it then has a resultant force where the centre of the area is elsewhere. Default: false
---@field nodal? bw.Array (N, node_count × 3, per node) forces at nodes

---Adds thermal expansion, the same in all directions. Without a coefficient each element expands as its material does.
---Regions whose material has none warn beside others that expand; where none expands it raises.
---@param change number|bw.Array (K, node_count × 1, per node) change of temperature; one number for all nodes
---@param expansion? number (1/K) coefficient of linear expansion of all elements. Default: that of each element's material
---@return bw.Model self
function Model:temperature(change, expansion) end

---Removes all loads.
---@return bw.Model self
function Model:clear_loads() end

---The consistent nodal forces of all loads.
---
---Errors: only those that every function may give.
---@return bw.Array? force (N, node_count × 3, per node) their sum
---@return string? message
---@return bw.Details? details
function Model:force_vector() end

---Places where the stress has no finite value: re-entrant edges, borders of supports and of rigid couplings, forces and supports at
---single nodes and along lines. Exponents at supports depend on Poisson's ratio. Of a sector of cyclic symmetry they are those of
---the whole wheel: a cut face has no edges of its own.
---
---Errors: geometry (the surface is open, or faces inwards).
---
---Source: M. L. Williams, J. Appl. Mech. 19 (1952); docs/theory/singular.md.
---@param options? bw.ModelSingularPlacesOptions where edges are looked for
---@return bw.SingularPlaces? places a list of `bw.SingularPlace`
---@return string? message
---@return bw.Details? details
function Model:singular_places(options) end

---Where re-entrant edges are looked for.
---@class bw.ModelSingularPlacesOptions
---@field surface? bw.Surface that the mesh was filled from. Default: the mesh's own boundary
---@field angle? number (rad) how far an edge's angle inside must exceed 180 degrees. Range: above 0 to 1.5. Default: 10 degrees

---The rigid-body motions that the supports leave free, body by body.
---
---Errors: only those that every function may give.
---@return bw.FreeMotion[]? motions empty where the supports hold the part
---@return string? message
---@return bw.Details? details
function Model:rigid_modes() end

---A rigid-body motion u(x) = translation + rotation × (x - centre), of unit root mean square (m) over the body.
---@class bw.FreeMotion
---@field component integer (index from 1) the body
---@field centre bw.Vector (m) a point of the axis
---@field translation bw.Vector (m) the translation; of a rotation the part along its axis
---@field rotation bw.Vector (rad) the rotation
---@field text string such as "translation along (0, 0, 1)"

---Solves the static problem. With `error` the mesh is refined until the estimated error of one quantity is small enough.
---
---A load that is not balanced on a free body is refused, unless `inertia_relief` is set. A body whose whole boundary is fixed,
---and a load on supports only, raise. A warning states where 5 % or more of a load's area lies on supports.
---
---Without `solver`, it is chosen by counted costs: a sparse Cholesky factor, or conjugate gradients where they cost less than
---half, or where the factor would take more than 4 GB or more than `memory_limit`. Their preconditioner is the two-level one
---on quadratic elements, and algebraic multigrid on linear ones. A factor serves later solutions, modes and worst cases of the same model.
---
---With `error`, elements of order 2 are bisected where the error of the quantity `of` comes from. Supports and loads go with
---their facets. The loop ends when the estimated error is small enough, or at a limit; `accuracy.reason` says which.
---
---Errors: unconstrained (a load is not balanced against free rigid-body motions), singular (the matrix is not positive definite although
---supports hold the part, or so nearly that the residual is above a tenth of the load), convergence (conjugate gradients did not
---converge), memory (the factor does not fit), limit (more than `max_elements` at the first refinement), unsupported (the backend
---"petsc" in a build without MPI).
---
---Source: docs/theory/solving.md; docs/theory/error_control.md.
---@param options? bw.ModelSolveOptions solver and error
---@return bw.Static? static the solution; with `error` on the last mesh
---@return bw.Accuracy|string? accuracy with `error`; else nil, or the message
---@return bw.Details? details
function Model:solve(options) end

---How a static problem is solved.
---@class bw.ModelSolveOptions
---@field inertia_relief? boolean balance a load on a free body by inertia; refused with bonds, attachments, couplings or cyclic symmetry. Default: false
---@field balance_tolerance? number (-) a load is balanced when its part along free motions is below this fraction of its size. Default: 1e-6
---@field solver? bw.Solver|"auto" the solver, of `bw.solver`. Default: "auto", chosen by counted costs
---@field former? bw.Model|bw.Static|bw.System of a part of the same elements at other positions, of another material or with other supports: its equations are reused as far as they fit (`Model:system`). Default: the part's own
---@field memory_limit? number (bytes) that a factor may take; without a solver, and with `bw.solver.cholesky`. Default: the free memory
---@field write? string path of a .pvtu file, with a solver of the backend "petsc": each process writes a piece of what `static:write` writes, and computes its stresses. The matrices are released before. Default: none
---@field error? number (-) relative error to be reached. Range: above 0 to 1. Default: none, one mesh
---@field of? string|bw.Vector|bw.PointGoal|bw.ReactionGoal|bw.Selection|fun(static: bw.Static): number (m, of a point) with `error`: the quantity. A word means the largest value at nodes: "von_mises", "max_principal" or "displacement". A point means the von Mises stress there, a selection the reaction on it, a function the number that it returns. Default: "von_mises"
---@field max_elements? integer (count) with `error`: elements at most. Range: 1 to 100000000. Default: 200000
---@field time_limit? number (s) with `error`: no finer mesh that would probably take longer. Default: none
---@field surface? bw.Surface with `error`: what the mesh was filled from; edges follow its planes and round faces. Default: edges stay as they are, and facets of round faces count as an error

---A stress or displacement at a point, as a goal of refinement.
---@class bw.PointGoal
---@field at bw.Vector (m) the point
---@field field? string "von_mises", "xx", "yy", "zz", "yz", "zx", "xy" of the stress; "displacement", "ux", "uy", "uz". Default: "von_mises"

---A reaction, as a goal of refinement.
---@class bw.ReactionGoal
---@field reaction bw.Selection the face of a support
---@field axis? "x"|"y"|"z" the component. Default: the size

---The model on a mesh whose elements are bisected. Neighbours are bisected as conformity needs. Facets of supports and loads are
---those inside of the facets before; fields at nodes are interpolated.
---
---Errors: limit (more than `max_elements`), geometry (a part of a curved element has no volume), unsupported (a material whose
---axes differ from element to element).
---
---Source: M.-C. Rivara, Int. J. Numer. Meth. Eng. 20 (1984).
---@param levels bw.Array|integer[] (count, element_count × 1, per element) how often each is bisected; three times halve its edges. Range: 0 to 30
---@param options? bw.ModelRefinedOptions order and surface
---@return bw.Model? model the refined model
---@return bw.Selection[]|string also the selections of `also` on the new mesh, or the message
---@return bw.Details? details
function Model:refined(levels, options) end

---How a model is refined.
---@class bw.ModelRefinedOptions
---@field order? 1|2 of the new elements, not below that of the old ones. Default: that of the mesh
---@field surface? bw.Surface that the mesh was filled from, for curved edges as of `mesh:curved`. Default: none
---@field also? bw.Selection[] further selections that are carried over. Range: at most 64. Default: none
---@field max_elements? integer (count) elements at most. Default: 100000000

---The lowest natural frequencies and mode shapes; rigid-body motions are left out. With `error` on meshes of
---order 2 that are refined until the relative error of every frequency is small enough. With `laplacian` the modes of the scalar
---Laplacian instead.
---
---Errors: convergence (the modes did not converge), singular (the matrix is not positive definite), memory (the factor does not
---fit), limit (more than `max_elements` at the first refinement), unsupported (`bw.eigensolver.slepc` in a build without MPI).
---
---Source: docs/theory/solving.md; docs/theory/error_control.md; the Laplacian: Zhou, Panetta and Zorin 2013, section 4.
---@param options? bw.ModelModesOptions how many, solver and error
---@return bw.Modes? modes the modes; fewer than asked for where the mesh has fewer
---@return bw.Accuracy|string? accuracy with `error`; else nil, or the message
---@return bw.Details? details
function Model:modes(options) end

---How modes are computed.
---@class bw.ModelModesOptions
---@field count? integer (count) of modes. Default: 15
---@field tolerance? number (-) of the relative residuals. Range: above 0, below 1. Default: 1e-8
---@field sturm? boolean count the eigenvalues below the last one by an indefinite factor, so that none is missing; without a factor, look for missing ones from random vectors. Default: true
---@field seed? integer (seed) of the start vector. Default: 1
---@field laplacian? boolean modes of the Laplacian, with free boundary. Default: false
---@field nodal_diameter? "all"|integer (count) of cyclic symmetry: modes with so many nodal diameters, 0 to half the sectors, or the lowest of all. Default: "all"
---@field solver? bw.Eigensolver|"auto" the eigensolver; that of SLEPc runs on all processes that mpirun started (docs/howto_cluster.md). Default: "auto"
---@field former? bw.Model|bw.Static|bw.System of a part of the same elements, as of `Model:solve`. Default: the part's own
---@field error? number (-) relative error of every frequency to be reached. Range: above 0 to 1. Default: none, one mesh
---@field max_elements? integer (count) with `error`: elements at most. Range: 1 to 100000000. Default: 200000
---@field time_limit? number (s) with `error`: no finer mesh that would probably take longer. Default: none
---@field surface? bw.Surface with `error`: what the mesh was filled from, for curved edges. Default: edges stay as they are

---The load factors at which the part becomes unstable under its loads: `solve` with a factor, then `static:buckling`.
---
---Errors: those of `model:solve` and of `static:buckling`.
---
---Source: docs/theory/stability.md.
---@param options? bw.BucklingOptions how many, and of which sign
---@return bw.Buckling? buckling the load factors; fewer than asked for where the search ended before
---@return string? message
---@return bw.Details? details
function Model:buckling(options) end

---The part in motion, at time 0. One factor serves all steps.
---```lua
---local mesh = bw.mesh.box {max = {1, 0.1, 0.08}, cells = {8, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 1), force = {0, 0, -1000}}
---local transient = assert(part:transient {step = 1e-4, loads = {{{0, 0}, {1e-3, 1}}}})
---print(assert(transient:run {time = 0.01, probes = {tip = {1, 0, 0}}, stress_every = 5}))
---```
---Displacements are small, loads keep their directions. The part must not change afterwards. It may have bonds, attachments and
---couplings, and moves freely where nothing constrains it; with `modes`, a part with joints must be constrained.
---
---Errors: `memory` for a factor larger than what is free; `unsupported` for temperature loads, preloads, and with `modes` for
---`error` and for supports that move where the part is free or damped by stiffness; `unconstrained` for joints with `modes` where
---the part can move freely; `convergence` where the first acceleration is not found; `io` and `format` for a history in a file;
---`geometry` for an inverted element. Histories that are none, a material without density and modes of another part raise.
---
---Source: J. Chung and G. M. Hulbert, J. Appl. Mech. 60 (1993); docs/theory/transient.md.
---@param options bw.TransientOptions step, damping, start and histories
---@return bw.LinearTransient? transient the part at time 0
---@return string? message
---@return bw.Details? details
function Model:transient(options) end

---Lays the part down layer by layer, and gives the stress that stays. The elements of a layer are added without stress; then they
---change their temperature, and all that was laid deforms. Supports constrain the nodes that are there. Materials need a
---coefficient of expansion.
---
---An element is laid where it has a facet with what was laid, or three corners on supports; else later. A warning states where
---more than 1 % of the volume comes late. Where supports carry no element of the first layer, that begins with its largest
---connected part.
---
---Errors: geometry (elements that are never reached), unsupported (bonds, attachments, supports along the normals of facets), and
---those of `part:solve`. Loads, prescribed displacements, and materials of which none expands raise.
---
---Source: docs/theory/deposition.md.
---@param options bw.ModelDepositOptions layers and change of temperature
---@return bw.Deposition? deposition the part that was laid
---@return string? message
---@return bw.Details? details
function Model:deposit(options) end

---How a part is laid down.
---@class bw.ModelDepositOptions
---@field layers? integer (count) of equal height along `direction`, by the centroids of elements; needed without `layer`. Range: 1 to the number of elements.
---@field direction? bw.Vector (-) with `layers`: from the first layer to the last. Default: {0, 0, 1}
---@field layer? bw.Array|integer[] (index from 1, element_count × 1, per element) the layer of each element, up to their number, instead of `layers`
---@field change number|bw.Array (K, node_count × 1, per node) from the temperature without stress to that at the end; negative where the part cools
---@field solver? bw.Solver|"auto" of each layer, as in `part:solve`. Default: "auto"

---The response to the loads as amplitudes of one phase, or to a harmonic acceleration of the supports, or to both. The basis are
---modes, and residual vectors until the error is below the tolerance.
---
---Errors: unconstrained (the part can move freely), unsupported (temperatures, prescribed displacements), convergence (the modes
---did not converge), memory (the factor does not fit), limit (too many modes). A part that nothing excites, or without density,
---raises.
---
---Source: docs/theory/dynamics.md.
---@param options bw.HarmonicOptions frequencies and damping
---@return bw.Harmonic? response the response
---@return string? message
---@return bw.Details? details
function Model:harmonic(options) end

---The largest response where the supports are shaken by a motion that is known by its response spectrum: all modes up to the last
---point, the static response of what they leave out, and their combination.
---
---Errors: unconstrained (supports leave the part free to move), unsupported (temperatures, prescribed displacements that are not
---zero) and those of `modes`. Points that do not ascend or begin above the first mode raise, and so
---do modes of another part or too few of them.
---Warnings say that the part's loads are not in it, and where no mode is up to the last point.
---
---Source: docs/theory/dynamics.md; Wilson, Der Kiureghian, Bayo (1981).
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---print(assert(part:response_spectrum {points = {{10, 5}, {100, 20}, {2000, 3}}, direction = {0, 0, 1}, damping = 0.02}))
---```
---@param options bw.ResponseSpectrumOptions the spectrum and the combination
---@return bw.ResponseSpectrum? response the largest response
---@return string? message
---@return bw.Details? details
function Model:response_spectrum(options) end

---A response spectrum, and how modes are combined.
---@class bw.ResponseSpectrumOptions
---@field points number[][]|bw.Array (any, n × 2) rows of frequency (Hz) and largest absolute acceleration (m/s2) of an oscillator of that frequency, both above 0, straight on logarithmic axes; the last acceleration is that of the base itself
---@field direction bw.Vector (-) of the base's acceleration, of any length above 0
---@field damping? number (-) ratio to which the points belong, for the correlation of modes. Range: above 0 to below 1. Default: 0.05
---@field combination? "cqc"|"srss"|"absolute" complete quadratic combination, square root of the sum of squares, or sum of magnitudes. Default: "cqc"
---@field missing_mass? boolean whether what the modes leave out follows the base statically. Default: true
---@field solver? bw.Eigensolver|"auto" the eigensolver of the modes, not SLEPc. Default: "auto"
---@field modes? bw.Modes elastic modes of the part, such as those of a response along another direction; the last one at or above the last point, unless they are all. Not with `solver`. Default: computed

---A harmonic response. Either `frequencies` or `range` is given.
---@class bw.HarmonicOptions
---@field frequencies? number[]|bw.Array (Hz, n × 1) 0 or more each. Default: those of `range`
---@field range? number[] (Hz, 2) from and to: 200 even steps, and more where the response is sharp. Default: `frequencies`
---@field damping? bw.Damping how energy is lost. Default: none
---@field base? bw.Vector (m/s2) amplitude of the acceleration of the supports; displacements are relative to them. Default: {0, 0, 0}
---@field modes? integer (count) of modes. Default: all below 1.5 times the highest frequency, which are counted first; more than 2000 raise
---@field residual_vectors? integer (count) at most. Range: 0 to 400. Default: 40
---@field tolerance? number (-) as far as residual vectors reduce the error. Range: 0 to below 1. Default: 1e-8
---@field solver? bw.Eigensolver|"auto" the eigensolver of the modes, not SLEPc. Default: "auto"

---Damping of harmonic responses and motion in time; the parts add up. What one of them does not serve is refused (unsupported).
---@class bw.Damping
---@field ratio? number (-) of the critical damping, in each mode; residual vectors have none. In time with `modes` alone. Range: 0 to below 1. Default: 0
---@field mass? number (1/s) a of Rayleigh's damping C = a M + b K. Range: 0 or more. Default: 0
---@field stiffness? number (s) b of it. Range: 0 or more. Default: 0
---@field loss? number|table<string, number> (-) loss factor h of the stiffness (1 + i h) K, or one by the name of each region, 0 where it has none; not in time. Range: 0 or more. Default: 0

---Equilibrium under the loads, temperatures and prescribed displacements of the part, all times a load factor that grows from 0:
---geometrically nonlinear statics. Displacements and rotations are of any size, strains are small (St. Venant-Kirchhoff law of the
---part's material). Loads keep their directions and sizes, pressures too. Newton's method cuts steps that fail; `arc_length`
---passes limit points. Each state has the number of its unstable directions.
---
---Errors: convergence (no state was found behind a load factor; `details.factor`, `details.node`), geometry (an element inverts;
---`details.element`), unconstrained (the part can move freely), unsupported (bonds, attachments, couplings, cyclic symmetry),
---singular (the stiffness, or the tangent at a state, is singular). A part on which nothing acts raises.
---
---Source: docs/theory/finite.md; Crisfield, Computers & Structures 13 (1981).
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.01, 0.002}, cells = {20, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.2), force = {0, 0, 2}}
---local path = assert(part:nonlinear {steps = 5, monitor = {{0.2, 0.005, 0.001}}})
---print(path, path:path(1)(5, 3))
---```
---@param options? bw.NonlinearOptions steps and what is monitored
---@return bw.Nonlinear? path the states
---@return string? message
---@return bw.Details? details
function Model:nonlinear(options) end

---The part falls on a rigid floor, edge or peg and is followed in time: free fall, impacts, bounces. It is linear elastic about
---its motion as a rigid body. Its modes and the compliance that they leave out carry the contact, without friction. The mesh
---shows its attitude when it touches; positions and times count from then. The model keeps the equations, and `modes` of a former
---drop serve the next: a drop then takes solutions for nodes that touch or lie beside, eight or more at once.
---
---A warning says when the part turns by more than 0.1 rad while it touches, and when the energy is not kept. Nodes that may touch
---are looked for within an estimate of how far the contact moves them, no bound. A warning says when it was too small. Without
---`samples` this stays unknown.
---
---Errors: limit (more than 2000 nodes touch in one impact or 6000 come near, or an impact without end), unsupported (bonds, attachments, couplings,
---a surface with `inside`, damping by mass or a loss factor), convergence and singular (the forces of contact are not found);
---those of `modes`. A part with supports or loads, without density or of several bodies raises.
---
---Source: docs/theory/drop.md.
---```lua
---local mesh = bw.mesh.box {max = {0.03, 0.02, 0.01}, cells = {3, 2, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local drop = assert(part:drop {height = 1, down = {-1, -2, -3}})
---print(drop, drop.peak.stress)
---print(assert(part:drop {height = 1, down = {0, -1, -1}, modes = drop.modes}).impacts[1].force)
---```
---@param options? bw.DropOptions height, attitude, spin and what is recorded
---@return bw.Drop? drop what happened
---@return string? message
---@return bw.Details? details
function Model:drop(options) end

---The part in contact with rigid surfaces, or parts of its mesh with each other, without friction or with Coulomb's, for
---small displacements: contact pressure, friction, resultants and the static solution. Supports and joints may leave motions
---that contact restrains. The factor is that of the part's equations; each candidate that
---may touch takes one solution with it.
---
---Bonds, couplings, attachments and preloads act as in `solve`, and `static` of the result has their forces. So a bolted joint
---may open: tighten the bolt by a bond with `preload`, then give the `shortening` of that result, and the loads.
---
---A warning names pairs that stay open or penetrate for want of smaller facets, motions that nothing decides, and rotations that
---are not small.
---
---Errors: unconstrained (neither supports nor contact balance the load; `details.motion` says along which motion), convergence
---(the part slides far on a curved surface, or friction finds no equilibrium: the message says where), invalid (supports
---press the part into a surface; a pair on facets that a bond joins), empty (a pair without a facet), unsupported (a sector of cyclic symmetry; a part with bonds,
---attachments or couplings and a solver that makes no factor); those of `solve`.
---
---Source: docs/theory/contact.md.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.05, 0.02}, cells = {20, 4, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("z", 0.02), pressure = 1e4}
---local drum = bw.rigid.cylinder {point = {0.15, 0, -0.1}, axis = {0, 1, 0}, radius = 0.1}
---print(assert(part:contact {{on = mesh.boundary:below("z", 0), with = drum, friction = 0.3}}))
---```
---@param pairs bw.ContactPair[] what may touch what
---@param options? bw.ContactOptions solver and limits
---@return bw.Contact? contact pressure, forces and static solution
---@return string? message
---@return bw.Details? details
function Model:contact(pairs, options) end

---The equations of parts in contact without friction for many loads: one factor, and the compliance of all corners that may touch.
---Each load takes two solutions. Loads of the model are left out.
---
---Errors: unsupported (friction, a curved rigid surface, a support that prescribes a displacement, a preload, a solver without a
---factor), unconstrained (supports and bonds leave a body free), invalid (a selection of another mesh, facets of which none faces those, supports that
---constrain all corners), empty (a selection without a facet), limit (more than 8000 corners), memory.
---
---Source: docs/theory/worst_case.md, section 17.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.02, 0.01}, cells = {5, 2, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}:fix(mesh.boundary:below("x", 0))
---local plane = bw.rigid.plane {normal = {0, 0, 1}}
---local contact = assert(part:contact_system {{on = mesh.boundary:below("z", 0), with = plane}})
---print(contact, contact:in_state "closed")
---```
---@param pairs bw.ContactPair[] what may touch what, without friction
---@param options? bw.ContactSystemOptions how the equations are solved
---@return bw.ContactSystem? contact the equations
---@return string? message
---@return bw.Details? details
function Model:contact_system(pairs, options) end

---Facets that may touch a rigid surface, or facets of another part of the mesh.
---@class bw.ContactPair
---@field on bw.Selection with facets; the pressure is on these
---@field with bw.RigidSurface|bw.Selection what they may touch; of facets those that they face in the undeformed mesh
---@field interference? number (m) by which gaps are smaller than in the mesh, as of a press fit; negative: larger. Default: 0
---@field friction? number (-) Coulomb's coefficient of friction. Range: 0 to 100. Default: 0
---@field smooth? boolean gaps are those between round faces through the corners of the facets; normals that differ by less than 35 degrees are of one face. Default: false, as the facets are

---How contact is found.
---@class bw.ContactOptions
---@field solver? bw.Solver|"auto" of the equations. Default: "auto"
---@field tolerance? number (-) mean gap of a corner in contact with a curved surface over the largest displacement of the facets. Range: above 0, below 1. Default: 1e-6
---@field max_iterations? integer (count) of linearisations of curved surfaces in each step, 1 or more. Default: 30
---@field steps? integer (count) in which the loads grow in proportion, 1 or more; with friction the result depends on their path. Default: 1
---@field finite_sliding? boolean between parts: what faces what is found in the displaced shape, again until it stays; rotations are at most 0.2 rad. Default: false, what faces what is that of the undeformed shape
---@field after? bw.Contact with friction: the path goes on from the loads, the place and the slip of this contact with the same mesh, material, joints, supported nodes and selections. Default: from rest, without load

---The equations of the model, ready for many right-hand sides: with a factor, or with the preconditioner of conjugate
---gradients. The model keeps them for what follows.
---
---Without a solver they have a factor, unless that is predicted to take more than 4 GB or more than the free memory: then
---conjugate gradients solve them, with the two-level preconditioner on quadratic elements and multigrid on linear ones. Where
---these do not converge, a factor takes their place, with a warning.
---
---With `former`, the equations of another part of the same elements, only elements that differ are assembled. Where they are
---few and the supports are the same, its factor serves too. The first time, the new factor is kept so that it can be updated.
---From then on, only what such changes reach is factored again: `times.elements` and `times.factor_reused` say how much that
---saved. Solutions have the same bits as without it. The former part and its solutions stay as they are.
---
---With the backend "petsc" they are spread over the processes that mpirun started, when they are first used, and stay there.
---Right-hand sides are sent, and displacements come back. A script has one such system at a time: another takes its place, and
---it is distributed again when it is used again. Its matrices are not here (`system:matrix`).
---
---Errors: singular (the matrix is not positive definite), memory (the factor does not fit), unsupported (the backend
---"petsc" in a build without MPI).
---The two-level preconditioner raises on linear elements.
---@param options? bw.ModelSystemOptions how they are solved
---@return bw.System? system the equations
---@return string? message
---@return bw.Details? details
function Model:system(options) end

---How equations are solved.
---@class bw.ModelSystemOptions
---@field solver? bw.Solver|"auto" what solves them. A `tolerance` of `pcg` is on the error in energy over that of the solution, 1e-8 where it is left out; with "petsc" on the residual over the load, 1e-10. Default: "auto"
---@field former? bw.Model|bw.Static|bw.System of a part of the same elements, whose equations are reused as far as they fit. Default: the part's own

---The same supports and loads on a mesh of the same topology, such as that of an edited shape. They go with the surface; forces
---and gravity keep their directions.
---
---Errors: geometry (a load's facets have no area).
---@param mesh bw.Mesh of the same topology
---@return bw.Model? model the model on the other mesh
---@return string? message
---@return bw.Details? details
function Model:moved(mesh) end

---The same supports and loads on a mesh that `mesh:refill` made.
---
---Errors: unsupported (forces at single inner nodes, or a material whose axes differ from element to element).
---@param mesh bw.Mesh the refilled mesh
---@param node_from bw.Array (index from 1, n × 1, per node) its number before, 0 for new ones
---@return bw.Model? model the model on the refilled mesh
---@return string? message
---@return bw.Details? details
function Model:transferred(mesh, node_from) end

---Writes the model as an .inp file for CalculiX. Forces are nodal. Gravity and temperatures are written as such, with one
---coefficient of expansion: the largest; temperatures are scaled to it.
---
---In a static step a free body is held by isostatic constraints, which carry no load where the loads balance. A warning and a
---comment in the file say so: remove them before you add contact, springs or supports to the deck.
---
---Bonds, attachments and couplings are written as equations, springs and masses that give the same answer. A warning names a spring
---of which CalculiX leaves a part out.
---
---Errors: io (the file cannot be written), unsupported (a node that slides obliquely and is moved, a material whose axes differ
---from element to element, prescribed values of a distributed coupling, a sector of cyclic symmetry, in a frequency step an
---inertia that no body has), unconstrained (in a static step, what joints and supports leave free).
---
---Source: docs/theory/joints.md.
---@param path string the file
---@param options? bw.ModelWriteInpOptions the step
---@return true? written true
---@return string? message
---@return bw.Details? details
function Model:write_inp(path, options) end

---The step of a CalculiX deck.
---@class bw.ModelWriteInpOptions
---@field modes? integer (count) of a frequency step; 0: a static step. Default: 0

---Releases the model, its equations and their factor at once.
function Model:close() end

---How a solution or modes with `error` converged. Errors are relative to the value; of modes the value is the first frequency.
---`print` shows it.
---@class bw.Accuracy
---@field quantity string what was asked for
---@field unit string of the quantity; empty for functions
---@field value number (any) on the last mesh, in the unit of the quantity
---@field estimated_error number (-) relative, on the last mesh
---@field at? bw.Vector (m) where the value is; nil for functions and modes
---@field converged boolean whether the estimated error is small enough
---@field reason "tolerance"|"elements"|"time"|"memory"|"facets"|"divergence" why there is no finer mesh. "facets": those that stand for a round face are a larger error by themselves. "divergence": changes of the value do not fall from mesh to mesh, so that it may have no limit
---@field history bw.AccuracyRow[] of every mesh
---@field elements integer (count) of the last mesh
---@field seconds number (s) in all
---@field part bw.Model on the last mesh
---@field surface? bw.Surface that curved edges follow
---@field options bw.ModelSolveOptions|bw.ModelModesOptions as they were given, with defaults
---@field singular? bw.SingularFinding of a largest stress without a finite value

---One mesh of a refinement.
---@class bw.AccuracyRow
---@field elements integer (count) of the mesh
---@field unknowns integer (count) three for every node
---@field value number (any) in the unit of the quantity
---@field frequencies? number[] (Hz, count) of modes
---@field at? bw.Vector (m) where the value is
---@field edge? number (m) of a largest value: mean edge length of the element there
---@field estimated_error number (-) relative
---@field facet_error? number (-) of a static solution: its part that facets of a round face cause
---@field seconds number (s) since the start
---@field effectivity? number (-) estimated error over the difference to the last value; nil of the last mesh
