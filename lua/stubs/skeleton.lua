---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Skeletons
--
-- Trees of bones inside a surface, their poses, and skinning weights.

---@class bw
local bw = {}

---How much each bone moves each node: a row for every node, a column for every bone, rows summing to
---one. `heat`: of the exchange with the bones; default 20.
---@param mesh bw.Mesh
---@param skeleton bw.Skeleton
---@param options? bw.SkinningWeightsOptions
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function bw.skinning_weights(mesh, skeleton, options) end

---@class bw.SkinningWeightsOptions
---@field heat? number

---@class bw.SkeletonModule
local skeleton_module = {}

---From joints and bones. Joints are {name = {x, y, z}, ...} or a list {{x, y, z, name = "hip"}, ...};
---bones {{"hip", "knee", name = "thigh"}, ...}, joints by name or number, either way round. `root` is a
---joint; left out: the one in the middle. Every joint is reached by one chain of bones.
---@param options bw.SkeletonCreateOptions
---@return bw.Skeleton
function skeleton_module.create(options) end

---@class bw.SkeletonCreateOptions
---@field joints table
---@field bones table
---@field root? string|integer

---The curve skeleton of a closed surface as joints and bones. `bones`: wanted number (0: as many as
---branches and bends ask for); `prune`: branches that reach no farther than this many local radii
---out of their junction are left out (1.5); `bend`: how far, in local radii, a bone strays from the
---curve (0.5); `minutes`: the most it may take (5).
---@param surface bw.Surface
---@param options? bw.SkeletonExtractOptions
---@return bw.Skeleton?
---@return string? message
---@return bw.Details? details
function skeleton_module.extract(surface, options) end

---@class bw.SkeletonExtractOptions
---@field bones? integer
---@field prune? number
---@field bend? number
---@field minutes? number

---Reads a TGF file: "number x y z [name]" for every joint, "#", "from to [name]" for every bone.
---Without a unit: millimetres.
---@param path string
---@param options? bw.UnitOptions
---@return bw.Skeleton?
---@return string? message
---@return bw.Details? details
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
---@param options? bw.UnitOptions
---@return true?
---@return string? message
---@return bw.Details? details
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
