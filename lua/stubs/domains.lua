---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Domains
--
-- A mesh cut into domains along a skeleton.

---@class bw
local bw = {}

---Cuts a mesh into domains along a skeleton. `threshold`: mean weight from which an element follows one
---bone; `bone_threshold`: instead of it, one for every bone, where not 0; `share`: thresholds are lowered
---until each bone has this share of the elements that it moves most, default 0.35, negative: never.
---@param mesh bw.Mesh
---@param skeleton bw.Skeleton
---@param weights bw.Array
---@param options? bw.DomainsOptions
---@return bw.Domains?
---@return string? message
---@return bw.Details? details
function bw.domains(mesh, skeleton, weights, options) end

---@class bw.DomainsOptions
---@field threshold? number
---@field share? number
---@field bone_threshold? table

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
---@return bw.Details? details
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
