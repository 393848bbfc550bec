---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Subdomains
--
-- A mesh cut into subdomains along a skeleton, for edit sessions. The theory is in docs/theory/edit.md.

---@class bw
local bw = {}

---Cuts a mesh into subdomains along a skeleton: those of type R follow one bone, those of type F lie between and are blended. A bone
---without a subdomain is a warning.
---
---Errors: singular (the equations of the blending have no solution), memory (a factor does not fit).
---
---Source: Y. Xie and others, Agile structural analysis for fabrication-aware shape editing (2015), section 4; docs/theory/edit.md.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}}
---local joints = {a = {0.005, 0, 0}, b = {0.05, 0, 0}, c = {0.095, 0, 0}}
---local skeleton = bw.skeleton.create {joints = joints, bones = {{"a", "b"}, {"b", "c"}}}
---local weights = assert(bw.skinning_weights(mesh, skeleton))
---print(assert(bw.subdomains(mesh, skeleton, weights)))
---```
---@param mesh bw.Mesh the mesh
---@param skeleton bw.Skeleton inside of it
---@param weights bw.Array|number[][] (-, node_count × bone_count, per node) as of `bw.skinning_weights`
---@param options? bw.SubdomainsOptions which elements follow one bone
---@return bw.Subdomains? subdomains the subdomains
---@return string? message
---@return bw.Details? details
function bw.subdomains(mesh, skeleton, weights, options) end

---Which elements follow one bone.
---@class bw.SubdomainsOptions
---@field threshold? number (-) mean weight from which an element follows a bone. Range: above 0 to 1. Default: 0.95
---@field fraction? number (-) thresholds are lowered until each bone has this fraction, by volume, of the elements that it moves most; negative: never. Range: up to 1. Default: 0.35
---@field bone_threshold? number[]|bw.Array (-, bone_count × 1, per bone) a threshold of its own, 0: none. Default: none

---The subdomains of a mesh. They do not change: methods give new ones. `#subdomains` is their number, `subdomains[i]` is a `bw.Subdomain`.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}}
---local skeleton = bw.skeleton.create {joints = {{0.005, 0, 0}, {0.05, 0, 0}, {0.095, 0, 0}}, bones = {{1, 2}, {2, 3}}}
---local subdomains = assert(bw.subdomains(mesh, skeleton, assert(bw.skinning_weights(mesh, skeleton))))
---for _, subdomain in ipairs(subdomains) do print(subdomain.type, subdomain.elements) end
---```
---@class bw.Subdomains
---@field count integer (count) of subdomains
---@field rigid_count integer (count) that follow one bone; these come first
---@field mesh bw.Mesh at rest
---@field skeleton bw.Skeleton at rest
---@field element_subdomain bw.Array (index from 1, element_count × 1, per element) its subdomain
---@field node_subdomain bw.Array (index from 1, node_count × 1, per node) the subdomain that it goes with
---@field interface bw.Array (-, node_count × 1, per node) 1 where elements of several subdomains meet, else 0
---@field stiffness_subdomain_count integer (count) of stiffness subdomains: subdomains cut further for the equations, into elements of one region joined through faces that follow the same bones
---@field stiffness_subdomain_bones integer[][] (index from 1, stiffness_subdomain_count, per stiffness subdomain) numbers of the bones that it follows
---@field element_stiffness_subdomain bw.Array (index from 1, element_count × 1, per element) its stiffness subdomain
---@field node_stiffness_subdomain bw.Array (index from 1, node_count × 1, per node) the stiffness subdomain whose frame it goes with
local Subdomains = {}

---A subdomain.
---@class bw.Subdomain
---@field index integer (index from 1) its number
---@field type "R"|"F" R follows one bone, F is blended
---@field bone? string of type R: the bone that it follows
---@field bones string[] all bones that it follows
---@field elements integer (count) of elements
---@field adjacent integer[] (index from 1, n) subdomains that share a node with it

---Elements given to a bone's subdomain, or taken out of the subdomains that follow one. An element by which a subdomain would fall apart, or
---touch another bone's, raises.
---@param elements bw.Array|integer[] (index from 1, n × 1) the elements
---@param bone? string|integer (index from 1) the bone. Default: none, they are taken out
---@return bw.Subdomains subdomains the changed subdomains
function Subdomains:assign(elements, bone) end

---The subdomains on what `mesh:refill` made of the posed shape.
---
---Errors: geometry (bones turn against each other so far that they blend to a plane), singular (the equations of the blending have no
---solution).
---@param maps bw.Array|number[][] (any, bone_count × 12, per bone) the pose, as of `skeleton:pose_maps`
---@param mask bw.Array (-, element_count × 1, per element) not 0: it was replaced; whole blended subdomains
---@param mesh bw.Mesh the refilled mesh
---@param node_from bw.Array (index from 1, n × 1, per node) as of `mesh:refill`
---@param element_from bw.Array (index from 1, e × 1, per element) as of `mesh:refill`
---@return bw.Subdomains? subdomains on the refilled mesh
---@return string? message
---@return bw.Details? details
function Subdomains:refilled(maps, mask, mesh, node_from, element_from) end

---The subdomains with an element that has a marked node.
---@param mask bw.Array (-, node_count × 1, per node) not 0: it is marked
---@return integer[] subdomains (index from 1, n) of the subdomains
function Subdomains:touched(mask) end

---The stiffness subdomains with an element that has a marked node.
---@param mask bw.Array (-, node_count × 1, per node) not 0: it is marked
---@return integer[] numbers (index from 1, n) of the subdomains
function Subdomains:stiffness_subdomains_touched(mask) end

---The nodes under maps of the bones: corners blended, mid-edge nodes halfway.
---@param maps bw.Array|number[][] (any, bone_count × 12, per bone) as of `skeleton:pose_maps`
---@return bw.Array nodes (m, node_count × 3, per node) their places
function Subdomains:posed_nodes(maps) end

---The surface that the mesh was made from under maps of the bones. Its points keep their order, and new ones follow. A triangle is
---split where the map within it differs by more than the tolerance from its interpolation.
---
---Errors: empty (no facets), limit (too many triangles), memory, cancelled.
---@param maps bw.Array|number[][] (any, bone_count × 12, per bone) as of `skeleton:pose_maps`
---@param surface bw.Surface at rest
---@param tolerance? number (m) of the interpolation. Default: 1e-4 of the surface's size
---@return bw.Surface? posed surface
---@return number|string moved (m) how far a point moved at most, or the message
---@return bw.Details? details
function Subdomains:posed_surface(maps, surface, tolerance) end

---How every node moves with the scale of a bone along one of its axes. Places of nodes are linear in the scales.
---
---Source: Y. Xie and others 2015, equation 20.
---@param pose bw.Array|number[][] (any, bone_count × 15, per bone) as of `skeleton:rest_pose`
---@param bone string|integer (index from 1) the bone
---@param axis 1|2|3|"x"|"y"|"z" x along the bone, y and z across it
---@return bw.Array derivative (m, node_count × 3, per node) per unit of scale
function Subdomains:pose_derivative(pose, bone, axis) end

---How every stiffness subdomain lies against rest: its linear map (9) and frame (9) by rows, and 1 where it was reshaped.
---@param maps bw.Array|number[][] (any, bone_count × 12, per bone) as of `skeleton:pose_maps`
---@param rotations bw.Array|number[][] (-, bone_count × 9, per bone) as of `skeleton:pose_maps`
---@return bw.Array motion (-, stiffness_subdomain_count × 19, per stiffness subdomain) the rows
function Subdomains:motion(maps, rotations) end

---Releases the subdomains at once.
function Subdomains:close() end
