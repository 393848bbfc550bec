---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Static solutions
--
-- Displacements, stresses, reactions and errors of a static solution, and stresses that converge at singular edges.

---A static solution. Fields are computed when they are first asked for, and kept. Names without `element_` belong to nodes, but
---for `utilisation`. Stresses at nodes are means over the elements around by volume.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {20, 2, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.1), force = {0, 0, -10}}
---local static = assert(part:solve())
---print(static.von_mises:max(), static:reaction_on(mesh.boundary:below("x", 0))[3])
---```
---@class bw.Static
---@field displacement bw.Array (m, node_count × 3, per node) of the nodes
---@field force bw.Array (N, node_count × 3, per node) that is applied
---@field reaction bw.Array (N, node_count × 3, per node) at constrained nodes, 0 elsewhere
---@field stress bw.Array (Pa, node_count × 6, per node) tensors xx yy zz yz zx xy, the mean over the elements around a node by volume. Where materials meet, the mean in that one of them in which it has the largest von Mises stress
---@field von_mises bw.Array (Pa, node_count × 1, per node) von Mises stress
---@field principal bw.Array (Pa, node_count × 3, per node) principal stresses, descending
---@field principal_directions bw.Array (-, node_count × 9, per node) unit vectors of the principal stresses, one after the other
---@field max_principal bw.Array (Pa, node_count × 1, per node) magnitude of the principal stress of largest magnitude
---@field element_stress bw.Array (Pa, element_count × 6, per element) mean tensors xx yy zz yz zx xy
---@field element_von_mises bw.Array (Pa, element_count × 1, per element) of `element_stress`
---@field element_principal bw.Array (Pa, element_count × 3, per element) of `element_stress`, descending
---@field element_max_principal bw.Array (Pa, element_count × 1, per element) of `element_stress`
---@field element_energy bw.Array (J, element_count × 1, per element) strain energy
---@field utilisation bw.Array (-, element_count × 1, per element) stress over strength of `element_stress`, see `material:utilisation`
---@field bonds bw.JointForce[] what each bond of the model transmits
---@field attachments bw.JointForce[] what each attachment of the model exerts on the body: the force of a spring, the weight of a mass
---@field couplings bw.CouplingResult[] what each coupling of the model does
---@field energy number (J) strain energy
---@field residual number (-) |K u - f| / |f|
---@field locking string? a warning of volumetric locking, see `bw.Model`; nil where none is expected
---@field mesh bw.Mesh of the model
---@field material bw.Material of the model
---@field times bw.SolveTimes? of the system; nil in an edit session and with "petsc"
---@field report bw.SolverReport which solver found it, and why
---@field reused bw.Reuse? in an edit session: what was reused; nil elsewhere
local Static = {}

---What a bond transmits to its side a (side b has the opposite), or an attachment to the body.
---@class bw.JointForce
---@field force bw.Vector (N) its resultant
---@field moment bw.Vector (N m) its moment about the origin
---@field preload? number (N) that pulls the sides of a bond with a preload together; nil of others
---@field shortening? number (m) by which these sides overlap; nil of others

---The motion of a remote point and its loads. Moments are about the point. `print` shows motion and reactions.
---@class bw.CouplingResult
---@field displacement bw.Vector (m) of the point
---@field rotation bw.Vector (rad) of the point, small
---@field force bw.Vector (N) that it exerts on the body
---@field moment bw.Vector (N m) that it exerts on the body
---@field reaction bw.Vector (N) that holds the point where its displacement is prescribed, 0 elsewhere
---@field reaction_moment bw.Vector (N m) that holds the point where its rotation is prescribed, 0 elsewhere

---What the parts of a solution took.
---@class bw.SolveTimes
---@field pattern number (s) the block sparsity pattern
---@field stiffness number (s) assembly
---@field order number (s) the ordering
---@field factor number (s) the factor
---@field pcg number (s) the two-level preconditioner
---@field solve number (s) triangular solves or iterations
---@field factor_entries integer (count) entries of the factor
---@field factor_flops number (count) operations of the factor
---@field factor_reused number (-) fraction of these that the factor of former equations had done
---@field elements integer (count) elements whose stiffness was computed: with `former` those that differ

---What a solution of an edit session reused, and what it cost. `print` shows it.
---@class bw.Reuse
---@field pattern boolean whether the sparsity pattern was kept
---@field ordering boolean whether the ordering was kept
---@field subdomains integer (count) stiffness subdomains of the equations
---@field subdomains_reused integer (count) subdomains whose coefficients stayed
---@field subdomains_rotated integer (count) subdomains that are unchanged in their own frames
---@field subdomains_changed integer (count) subdomains that changed
---@field solver "cholesky"|"pcg" how it was solved
---@field preconditioner? "cholesky"|"two_level" of "pcg": the former factor, or two levels
---@field full boolean whether every supernode of the factor was computed again
---@field factor_reused number (-) fraction of the factor's work that was not done again
---@field iterations integer (count) of conjugate gradients
---@field precision integer (bits) of the factor's numbers, 32 or 64
---@field refinements integer (count) iterations that made solutions with a factor of 32 bits exact
---@field predicted_refactor number (s) predicted cost of a factor, on one fixed machine
---@field predicted_iterate number (s) predicted cost of iterations with the former factor; 0: not possible
---@field predicted_pcg number (s) predicted cost of two-level PCG; 0: not possible
---@field seconds_unknowns number (s) for the unknowns and their frames
---@field seconds_stiffness number (s) for the stiffness
---@field seconds_factor number (s) for the factor
---@field seconds_solve number (s) for the solution
---@field mesh "posed"|"relaxed"|"refilled" how the mesh of the edited shape was made
---@field joined boolean whether the part has bonds, attachments or couplings: its factor is recomputed whole
---@field difference_stiffness? number (-) with `check`: largest difference to the stiffness from scratch
---@field difference_solution? number (-) with `check`: largest difference to the solution from scratch

---The error of the whole solution in the energy norm. It is a mean: the largest stress may be off by more, and facets that stand
---for a round face are not in it. `part:solve {error = ...}` gives the error of one quantity.
---
---Errors: only those that every function may give.
---
---Source: O. C. Zienkiewicz and J. Z. Zhu, Int. J. Numer. Meth. Eng. 24 (1987).
---@return number? relative (-) the error over the solution, in the energy norm
---@return bw.Array|string elements (J, element_count × 1, per element) energy of the error, or the message
---@return bw.Details? details
function Static:error_estimate() end

---The load factors at which the solution becomes unstable, and their shapes. All loads, temperatures and prescribed displacements
---grow by the factor. The equations get a factor where they have none.
---
---Errors: invalid (a part with bonds, attachments or couplings has changed since), unconstrained (the part can move freely, without
---`loads_turn`), unsupported (a solution in contact, of an edit session or of an external solver; a moment about a
---remote point that can turn about both axes across it), convergence (the iteration did not converge), memory (the factor does not fit), limit (too many load factors for the
---eigensolver). A load that causes no stress raises.
---
---Source: docs/theory/stability.md.
---@param options? bw.BucklingOptions how many, and of which sign
---@return bw.Buckling? buckling the load factors; fewer than asked for where the search ended before
---@return string? message
---@return bw.Details? details
function Static:buckling(options) end

---How load factors are computed.
---@class bw.BucklingOptions
---@field count? integer (count) of load factors. Range: 1 to 500. Default: 4
---@field sign? "either"|"positive"|"negative" those nearest to zero, those of the load as it is, or those of the reversed load. Default: "either"
---@field tolerance? number (-) of the relative residuals of the squares. Range: above 0, below 1. Default: 1e-8
---@field sturm? boolean count the load factors by indefinite factors, so that none is missing. Default: true
---@field seed? integer (seed) of the start vectors. Default: 1
---@field loads_turn? boolean loads of a part without sufficient supports turn with its mean rotation; nothing is counted then. Default: false, such a part is refused
---@field solver? bw.Eigensolver|"auto" the eigensolver: `lanczos`, `arpack` or `lobpcg`. Default: "auto"

---The tractions that two regions of the mesh exert on each other, from the forces that their elements have at the nodes of the
---interface. Each value at a corner is a mean over the facets around it. What a support takes at a node of the interface is not
---included. Nodal forces there, and what a third region or a joint exerts, are divided evenly between the two. Where materials meet at
---the surface of a body, the stress can be singular and the tractions there grow without limit as elements become small.
---
---Errors: unsupported (a sector of cyclic symmetry; an instant of a transient, whose loads have inertia and factors of time). A
---model that has changed since it was solved is refused.
---
---Source: docs/theory/elements.md.
---```lua
---local mesh = assert(bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {20, 2, 2}, order = 2}:split("x < 0.05", "left"))
---local part = bw.model {mesh = mesh, materials = {left = bw.material.steel, rest = bw.material.pla}}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.1), force = {10, 0, 0}}
---local between = assert(assert(part:solve()):interface_traction("left", "rest"))
---print(between, between.force[1]) -- 10 N
---```
---@param a string the region on which they act
---@param b string the region that exerts them
---@return bw.InterfaceTraction? tractions all 0 where the regions do not touch
---@return string? message
---@return bw.Details? details
function Static:interface_traction(a, b) end

---Tractions between two regions. `print` shows the largest, their resultant and what is not included. Their error is not known.
---@class bw.InterfaceTraction
---@field a string the region on which they act
---@field b string the region that exerts them
---@field nodes bw.Array (index from 1, n × 1) of the interface, ascending
---@field traction bw.Array (Pa, node_count × 3, per node) on region a; 0 off the interface
---@field normal bw.Array (Pa, node_count × 1, per node) normal traction, positive in tension; 0 off the interface
---@field shear bw.Array (Pa, node_count × 1, per node) magnitude of the traction along the interface; 0 off it
---@field force bw.Vector (N) on region a, the sum of the nodal forces; region b has the opposite one
---@field moment bw.Vector (N m) the same about the origin
---@field area number (m2) of the interface
---@field shared integer (count) nodes of the interface that supports, joints or other regions hold, too
---@field imbalance number (-) the sum of both sides' nodal forces at the other nodes, over their magnitude. Inertia relief and nodal forces on the interface show here

---The traction that a joint or a support exerts on the body, from the forces at nodes that make up its resultant. Each value at a
---corner is a mean over the facets around it. At the ends of a bond, and at the border of a support or of a rigid coupling, the
---traction can be singular and grow without limit as elements become small. Values at nodes of side a outside of side b, whose
---facets are covered in part, can be far off: let a be the side that the other one covers.
---
---Errors: unsupported (it is on nodes without facets; joints in an instant of a transient and in the whole of a sector; a support
---that meets a cut of a sector: take that of the whole). A model that has changed since it was solved is refused.
---
---Source: docs/theory/joints.md.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:symmetry(mesh.boundary:below("x", 0)):fix(mesh.boundary:below("z", 0))
---part:load {on = mesh.boundary:above("x", 0.1), force = {10, 0, 0}}
---print(assert(assert(part:solve()):joint_traction {support = 1}))
---```
---@param options bw.JointTractionOptions which one
---@return bw.JointTraction? traction on the body
---@return string? message
---@return bw.Details? details
function Static:joint_traction(options) end

---Which joint or support: one of them.
---@class bw.JointTractionOptions
---@field bond? integer (index from 1) of `Model.bonds`: the traction on its side a
---@field attachment? integer (index from 1) of `Model.attachments`
---@field coupling? integer (index from 1) of `Model.couplings`
---@field support? integer (index from 1) of `Model.supports`

---The traction of a joint or a support. `print` shows the largest, the resultant and what is not included. Its error is not known.
---@class bw.JointTraction
---@field kind "bond"|"attachment"|"coupling"|"support" what exerts it
---@field number integer (index from 1) of its kind
---@field nodes bw.Array (index from 1, n × 1) on which it acts, ascending
---@field traction bw.Array (Pa, node_count × 3, per node) on the body; 0 elsewhere
---@field normal bw.Array (Pa, node_count × 1, per node) along the outward normal of the body, positive in tension; 0 elsewhere
---@field shear bw.Array (Pa, node_count × 1, per node) magnitude of the traction along the surface; 0 elsewhere
---@field force bw.Vector (N) on the body, the sum of the nodal forces
---@field moment bw.Vector (N m) the same about the origin
---@field area number (m2) on which it acts
---@field shared integer (count) nodes of a bond at which supports take a part that is left out; of a support, where the reaction is of others too

---The static solution of the whole wheel from that of a sector of cyclic symmetry, with the model of `Model:whole`. A solution of
---the whole, and one whose model has changed, raise.
---```lua
---local box = bw.mesh.box {max = {1, 1, 0.3}, cells = {3, 3, 1}}
---local part = bw.model {mesh = box, material = bw.material.steel}
---assert(part:cyclic {low = box.boundary:below("y", 0), high = box.boundary:below("x", 0), count = 4})
---part:fix(box.boundary:below("z", 0))
---part:load {on = box.boundary:above("z", 0.3), pressure = 1e6}
---print(assert(assert(part:solve()):whole()))
---```
---
---Errors: unsupported (what `Model:whole` does not carry over), limit (too many nodes).
---
---Source: docs/theory/symmetry.md.
---@return bw.Static? static solution of the whole
---@return string? message
---@return bw.Details? details
function Static:whole() end

---The sum of the reactions on a selection.
---@param selection bw.Selection where they are summed
---@return bw.Vector reaction (N) the sum
function Static:reaction_on(selection) end

---The effective stress of the theory of critical distances at singular edges, the largest first. It converges under refinement,
---where the largest stress does not. The bisector of the edge leads into the material. Of every place the station of the largest
---value is listed.
---
---Errors: unsupported (the critical distance of the material is not known, or no line stays in the body), geometry (as of
---`surface:singular_edges`).
---
---Source: D. Taylor, The Theory of Critical Distances (2007); docs/theory/singular.md.
---@param options? bw.EffectiveStressOptions places and length
---@return bw.EffectiveStress[]? list the largest first
---@return string? message
---@return bw.Details? details
function Static:effective_stress(options) end

---Where and over which length an effective stress is taken.
---@class bw.EffectiveStressOptions
---@field places? bw.SingularPlaces that are judged. Default: the re-entrant edges of the mesh's boundary
---@field length? number (m) the critical distance L. Default: `critical_distance` of the material
---@field method? "line"|"point" the mean over 2 L from the edge along the bisector, or the stress at L / 2. Default: "line"

---An effective stress.
---@class bw.EffectiveStress
---@field place bw.SingularPlace the place
---@field number integer (index from 1) of the place in the list
---@field at bw.Vector (m) the station on the edge
---@field value number (Pa) the largest principal stress
---@field stress number[] (Pa, 6) the tensor
---@field utilisation number? (-) stress over strength; nil where the strength is not known
---@field length number (m) L
---@field method "line"|"point" how it was taken
---@field edge_length number (m) of the elements there
---@field estimated_error number (-) relative

---The notch stress intensity factor K of singular edges, the largest first. The normal stress across the bisector is
---K / sqrt(2 pi) r^(exponent - 1) at small distances r from the edge.
---
---Errors: unsupported (no line stays in the body), geometry (as of `surface:singular_edges`).
---
---Source: R. Gross and A. Mendelson, Int. J. Fract. Mech. 8 (1972); docs/theory/singular.md.
---@param options? bw.NotchStressIntensityOptions which places
---@return bw.NotchStressIntensity[]? list the largest first
---@return string? message
---@return bw.Details? details
function Static:notch_stress_intensity(options) end

---Which places are judged.
---@class bw.NotchStressIntensityOptions
---@field places? bw.SingularPlaces that are judged. Default: the re-entrant edges of the mesh's boundary

---A notch stress intensity factor.
---@class bw.NotchStressIntensity
---@field place bw.SingularPlace the place
---@field number integer (index from 1) of the place in the list
---@field at bw.Vector (m) the station on the edge
---@field value number (Pa m^(1 - exponent)) K
---@field exponent number (-) Williams' exponent of the place
---@field shear number (Pa m^(1 - exponent)) the factor of the shear stress on the bisector, with `shear_exponent`
---@field shear_exponent number (-) exponent of the antisymmetric field
---@field radial number (-) stress along the bisector over that across it
---@field edge_length number (m) of the elements there
---@field estimated_error number (-) relative

---The largest stress that re-entrant edges would have with a fillet, the largest first, from their notch stress intensity
---factors. For radii that are small beside the notch.
---
---Errors: those of `notch_stress_intensity`.
---
---Source: P. Lazzarin and S. Filippi, Int. J. Solids Struct. 43 (2006); docs/theory/singular.md.
---@param options bw.FilletStressOptions radius and places
---@return bw.FilletStress[]? list the largest first
---@return string? message
---@return bw.Details? details
function Static:fillet_stress(options) end

---A fillet.
---@class bw.FilletStressOptions
---@field radius number (m) of the fillet, above 0
---@field places? bw.SingularPlaces that are judged. Default: the re-entrant edges of the mesh's boundary

---The stress of a fillet.
---@class bw.FilletStress
---@field place bw.SingularPlace the re-entrant edge
---@field number integer (index from 1) of the place in the list
---@field at bw.Vector (m) the station on the edge
---@field value number (Pa) the largest principal stress in the fillet
---@field intensity number (Pa m^(1 - exponent)) the notch stress intensity factor
---@field radius number (m) of the fillet
---@field estimated_error number (-) relative: that of the factor, and 0.1 for the formula

---Writes displacement, force, reaction and stresses to a .vtu file, with further fields. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function Static:write(path, options) end

---Draws the deformed shape as a PNG file, coloured by a field.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.StaticPictureOptions what is drawn and how
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Static:picture(path, options) end

---How a static solution is drawn.
---@class bw.StaticPictureOptions: bw.PictureOptions
---@field field? "von_mises"|"max_principal"|"element_von_mises"|"element_max_principal"|"utilisation"|"element_energy"|"displacement"|"reaction"|bw.Array (any, n × c, per node or per element) what colours it; of several columns the norm. Default: "von_mises"

---Releases the solution at once.
function Static:close() end
