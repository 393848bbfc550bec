---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Contact
--
-- Rigid surfaces, and parts that touch them or each other, without friction or with Coulomb's.

---Rigid surfaces that parts touch: `bw.rigid`.
---@class bw.RigidModule
local rigid_module = {}

---A rigid plane. The part stays on the side of its normal.
---```lua
---local floor = bw.rigid.plane {point = {0, 0, -1e-3}, normal = {0, 0, 1}}
---print(floor, floor.kind, floor.direction[3])
---```
---@param options bw.RigidPlaneOptions place and direction
---@return bw.RigidSurface surface the plane
function rigid_module.plane(options) end

---Where a rigid plane is.
---@class bw.RigidPlaneOptions
---@field point? bw.Vector (m) of the plane. Default: the origin; of a drop, the centre of mass
---@field normal bw.Vector (-) towards the part, of any length

---A rigid sphere. The part is outside of it, or inside.
---```lua
---local ball = bw.rigid.sphere {centre = {0, 0, 0.05}, radius = 0.05}
---print(ball, ball.radius)
---```
---@param options bw.RigidSphereOptions place and size
---@return bw.RigidSurface surface the sphere
function rigid_module.sphere(options) end

---Where a rigid sphere is.
---@class bw.RigidSphereOptions
---@field centre? bw.Vector (m) of the sphere. Default: the origin; of a drop, below the centre of mass
---@field radius number (m) above 0
---@field inside? boolean the part is inside of it. Default: false

---A rigid cylinder of infinite length. The part is outside of it, or inside: a peg, or a bore.
---```lua
---local bore = bw.rigid.cylinder {axis = {0, 1, 0}, radius = 0.01, inside = true}
---print(bore, bore.inside)
---```
---@param options bw.RigidCylinderOptions place and size
---@return bw.RigidSurface surface the cylinder
function rigid_module.cylinder(options) end

---Where a rigid cylinder is.
---@class bw.RigidCylinderOptions
---@field point? bw.Vector (m) of the axis. Default: the origin; of a drop, below the centre of mass
---@field axis bw.Vector (-) its direction, of any length
---@field radius number (m) above 0
---@field inside? boolean the part is inside of it. Default: false

---A rigid surface. It does not change.
---```lua
---local peg = bw.rigid.cylinder {axis = {0, 1, 0}, radius = 0.01}
---print(peg.kind, peg.radius, peg.inside)
---```
---@class bw.RigidSurface
---@field kind "plane"|"sphere"|"cylinder" what it is
---@field point bw.Vector (m) of the plane, the centre, or a point of the axis
---@field direction? bw.Vector (-) the plane's normal or the cylinder's axis, of length 1; nil of a sphere
---@field radius? number (m) nil of a plane
---@field inside boolean whether the part is inside
---@field placed boolean whether `point` or `centre` was given
local RigidSurface = {}

---Releases its memory at once.
function RigidSurface:close() end

---A part in contact. Rotations are small, and so is sliding between parts without `finite_sliding`. Areas and lever arms are those
---of the undeformed part.
---The gap is zero in the mean of the hat function of each corner, and pressure is linear on each facet. Friction holds at the corners.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.1, 0.05}, cells = {8, 4, 2}}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:load {on = mesh.boundary:above("z", 0.05), pressure = 1e6}
---local contact = assert(part:contact {{on = mesh.boundary:below("z", 0), with = bw.rigid.plane {normal = {0, 0, 1}}}})
---print(contact, contact.pairs[1].force[3], contact.pressure:max(), #contact.undetermined)
---```
---@class bw.Contact
---@field static bw.Static the static solution; its model has the forces of contact as a load. `bonds`, `couplings` and `attachments` are what joints do in contact
---@field mesh bw.Mesh of the model
---@field pressure bw.Array (Pa, node_count × 1, per node) on the facets `on` of the pairs; 0 where nothing touches, the larger where pairs meet
---@field gap bw.Array (m, node_count × 1, per node) of the deformed part at the nodes of `on` of the pairs, negative inside of the rigid surface; against facets the mean gap at their corners; infinite elsewhere
---@field traction? bw.Array (Pa, node_count × 3, per node) friction on the facets `on` of the pairs, as `pressure`; nil without friction
---@field slip? bw.Array (m, node_count × 3, per node) of the corners of `on` against what they touch, in the mean, summed over the steps in which they slip; nil without friction
---@field status? bw.Array (-, node_count × 1, per node) 0 where nothing touches, 1 where it sticks, 2 where it slips; nil without friction
---@field steps integer (count) in which the loads grew, with those of the contact before
---@field pairs bw.ContactState[] what each pair does
---@field undetermined string[] motions along which nothing decides the position, such as "translation along (1, 0, 0)"; stress and pressure do not depend on it
---@field iterations integer (count) of linearisations; in finite sliding as often what faces what is found
---@field rotation number (rad) the largest of a part, by least squares over its nodes
---@field changes integer (count) candidates that entered or left the active set
---@field solves integer (count) right-hand sides that were solved with the part's factor
---@field report bw.SolverReport of the equations
local Contact = {}

---What a pair of contact does.
---@class bw.ContactState
---@field area number (m2) that carries pressure; its border is known to within one element
---@field force bw.Vector (N) on the facets `on`, with friction; what they are against has the opposite
---@field moment bw.Vector (N m) about the origin
---@field pressure number (Pa) the largest
---@field at? bw.Vector (m) where that is; nil of an open pair
---@field gap number (m) the smallest of an open pair; 0 of a closed one
---@field penetration number (m) the deepest point between corners: a measure of the error of the mesh
---@field friction? bw.Vector (N) the part of `force` that is friction; nil without it
---@field stick_area? number (m2) the part of `area` that sticks; nil without friction
---@field slip? number (m) the largest at a corner that touches, summed over the steps; nil without friction
---@field work? number (J) that friction took over all steps, by the tractions at the end of each: too large where they grow within a step; nil without friction
---@field candidates integer (count) corners of the facets
---@field active integer (count) corners that carry pressure

---Writes the fields of the static solution and `contact_pressure` as a mesh file, with friction also `friction`, `slip` and
---`contact_status`.
---
---Errors: io (the file cannot be written).
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.1, 0.05}, cells = {4, 2, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:load {on = mesh.boundary:above("z", 0.05), pressure = 1e6}
---local contact = assert(part:contact {{on = mesh.boundary:below("z", 0), with = bw.rigid.plane {normal = {0, 0, 1}}}})
---assert(contact:write "contact.vtu")
---```
---@param path string the ending says which format
---@return true? written true
---@return string? message
---@return bw.Details? details
function Contact:write(path) end

---Draws the deformed part coloured by its contact pressure.
---
---Errors: those of `bw.picture`.
---@param path string a PNG file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Contact:picture(path, options) end

---Releases its memory at once.
function Contact:close() end

---How the equations of a contact system are solved.
---@class bw.ContactSystemOptions
---@field solver? bw.Solver|"auto" of the linear systems, by a factor. Default: "auto", a factor that is kept

---Parts in contact under many loads.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.02, 0.01}, cells = {5, 2, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}:fix(mesh.boundary:below("x", 0))
---local plane = bw.rigid.plane {normal = {0, 0, 1}}
---local contact = assert(part:contact_system {{on = mesh.boundary:below("z", 0), with = plane}})
---print(contact.candidates, contact.closed, contact.cuts.area)
---```
---@class bw.ContactSystem
---@field candidates integer (count) corners of the facets that may touch, but for those that supports keep from moving
---@field pair_count integer (count) of contact pairs
---@field closed boolean whether all of them touch without a load: no gap, no interference
---@field system bw.System the equations without contact
---@field mesh bw.Mesh of the model
---@field cuts bw.Selection? facets that face over more than half of their area, nearer than their size, what they may touch; nil where there are none
local ContactSystem = {}

---The displacement with contact under a load, and which corners touch.
---
---Errors: convergence (rounding keeps the candidates changing), singular (their compliance is).
---@param force bw.Array (N, node_count × 3, per node) nodal forces
---@return bw.Array? displacement (m, node_count × 3, per node) the displacement
---@return bw.Array|string state (-, candidates × 1) 1 where a corner carries pressure, else 0; or the message
---@return bw.Details? details
function ContactSystem:solve(force) end

---The linear equations of a state of contact: the corners in it have no gap, whichever sign their pressure has, and the others
---are open.
---
---Errors: only those that every function may give.
---@param state "closed"|"open"|bw.Array (-, candidates × 1) not 0 where a corner is closed; all of them, or none
---@return bw.System? system the equations
---@return string? message
---@return bw.Details? details
function ContactSystem:in_state(state) end

---Releases its memory at once.
function ContactSystem:close() end
