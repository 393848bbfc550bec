---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Domains
--
-- A mesh cut into domains along a skeleton, for edit sessions. The theory is in docs/theory/edit.md.

---@class bw
local bw = {}

---Cuts a mesh into domains along a skeleton: those of type R follow one bone, those of type F lie between and are blended. A bone
---without a domain is a warning.
---
---Errors: singular (the equations of the blending have no solution), memory (a factor does not fit).
---
---Source: Y. Xie and others, Agile structural analysis for fabrication-aware shape editing (2015), section 4; docs/theory/edit.md.
---```lua
---local mesh = bw.mesh.box {low = {0, -0.01, -0.01}, high = {0.1, 0.01, 0.01}, cells = {20, 4, 4}}
---local joints = {a = {0.005, 0, 0}, b = {0.05, 0, 0}, c = {0.095, 0, 0}}
---local skeleton = bw.skeleton.create {joints = joints, bones = {{"a", "b"}, {"b", "c"}}}
---local weights = assert(bw.skinning_weights(mesh, skeleton))
---print(assert(bw.domains(mesh, skeleton, weights)))
---```
---@param mesh bw.Mesh the mesh
---@param skeleton bw.Skeleton inside of it
---@param weights bw.Array|number[][] (-, node_count × bone_count, per node) as of `bw.skinning_weights`
---@param options? bw.DomainsOptions which elements follow one bone
---@return bw.Domains? domains the domains
---@return string? message
---@return bw.Details? details
function bw.domains(mesh, skeleton, weights, options) end

---Which elements follow one bone.
---@class bw.DomainsOptions
---@field threshold? number (-) mean weight from which an element follows a bone. Range: above 0 to 1. Default: 0.95
---@field share? number (-) thresholds are lowered until each bone has this fraction, by volume, of the elements that it moves most; negative: never. Range: up to 1. Default: 0.35
---@field bone_threshold? number[]|bw.Array (-, bone_count × 1, per bone) a threshold of its own, 0: none. Default: none

---The domains of a mesh. They do not change: methods give new ones. `#domains` is their number, `domains[i]` is a `bw.Domain`.
---```lua
---local mesh = bw.mesh.box {low = {0, -0.01, -0.01}, high = {0.1, 0.01, 0.01}, cells = {20, 4, 4}}
---local skeleton = bw.skeleton.create {joints = {{0.005, 0, 0}, {0.05, 0, 0}, {0.095, 0, 0}}, bones = {{1, 2}, {2, 3}}}
---local domains = assert(bw.domains(mesh, skeleton, assert(bw.skinning_weights(mesh, skeleton))))
---for _, domain in ipairs(domains) do print(domain.type, domain.elements) end
---```
---@class bw.Domains
---@field count integer (count) of domains
---@field rigid_count integer (count) that follow one bone; these come first
---@field mesh bw.Mesh at rest
---@field skeleton bw.Skeleton at rest
---@field element_domain bw.Array (index from 1, element_count × 1, per element) its domain
---@field node_domain bw.Array (index from 1, node_count × 1, per node) the domain that it goes with
---@field interface bw.Array (-, node_count × 1, per node) 1 where elements of several domains meet, else 0
---@field piece_count integer (count) of pieces: domains cut further for the equations, into elements joined through faces that follow the same bones
---@field piece_bones integer[][] (index from 1, piece_count, per piece) numbers of the bones that it follows
---@field element_piece bw.Array (index from 1, element_count × 1, per element) its piece
---@field node_piece bw.Array (index from 1, node_count × 1, per node) the piece whose frame it goes with
local Domains = {}

---A domain.
---@class bw.Domain
---@field index integer (index from 1) its number
---@field type "R"|"F" R follows one bone, F is blended
---@field bone? string of type R: the bone that it follows
---@field bones string[] all bones that it follows
---@field elements integer (count) of elements
---@field adjacent integer[] (index from 1, n) domains that share a node with it

---Elements given to a bone's domain, or taken out of the domains that follow one. An element by which a domain would fall apart, or
---touch another bone's, raises.
---@param elements bw.Array|integer[] (index from 1, n × 1) the elements
---@param bone? string|integer (index from 1) the bone. Default: none, they are taken out
---@return bw.Domains domains the changed domains
function Domains:assign(elements, bone) end

---The domains on what `mesh:refill` made of the posed shape.
---
---Errors: geometry (bones turn against each other so far that they blend to a plane), singular (the equations of the blending have no
---solution).
---@param maps bw.Array|number[][] (any, bone_count × 12, per bone) the pose, as of `skeleton:pose_maps`
---@param mask bw.Array (-, element_count × 1, per element) not 0: it was replaced; whole blended domains
---@param mesh bw.Mesh the refilled mesh
---@param node_from bw.Array (index from 1, n × 1, per node) as of `mesh:refill`
---@param element_from bw.Array (index from 1, e × 1, per element) as of `mesh:refill`
---@return bw.Domains? domains on the refilled mesh
---@return string? message
---@return bw.Details? details
function Domains:refilled(maps, mask, mesh, node_from, element_from) end

---The domains with an element that has a marked node.
---@param mask bw.Array (-, node_count × 1, per node) not 0: it is marked
---@return integer[] domains (index from 1, n) their numbers
function Domains:touched(mask) end

---The pieces with an element that has a marked node.
---@param mask bw.Array (-, node_count × 1, per node) not 0: it is marked
---@return integer[] pieces (index from 1, n) their numbers
function Domains:pieces_touched(mask) end

---The nodes under maps of the bones: corners blended, mid-edge nodes halfway.
---@param maps bw.Array|number[][] (any, bone_count × 12, per bone) as of `skeleton:pose_maps`
---@return bw.Array nodes (m, node_count × 3, per node) their places
function Domains:posed_nodes(maps) end

---How every node moves with the scale of a bone along one of its axes. Places of nodes are linear in the scales.
---
---Source: Y. Xie and others 2015, equation 20.
---@param pose bw.Array|number[][] (any, bone_count × 15, per bone) as of `skeleton:rest_pose`
---@param bone string|integer (index from 1) the bone
---@param axis 1|2|3|"x"|"y"|"z" x along the bone, y and z across it
---@return bw.Array derivative (m, node_count × 3, per node) per unit of scale
function Domains:pose_derivative(pose, bone, axis) end

---How every piece lies against rest: its linear map (9) and frame (9) by rows, and 1 where it was reshaped.
---@param maps bw.Array|number[][] (any, bone_count × 12, per bone) as of `skeleton:pose_maps`
---@param rotations bw.Array|number[][] (-, bone_count × 9, per bone) as of `skeleton:pose_maps`
---@return bw.Array motion (-, piece_count × 19, per piece) the rows
function Domains:motion(maps, rotations) end

---Releases the domains at once.
function Domains:close() end
