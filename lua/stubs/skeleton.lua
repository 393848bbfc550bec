---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Skeletons
--
-- Trees of joints and bones inside a surface, their poses, and skinning weights. The theory is in docs/theory/edit.md.

---@class bw
local bw = {}

---How much each bone moves each node: on the surface by a heat equilibrium with the nearest bones that a point sees, inside by a
---Laplace equation. Mid-edge nodes get the mean of their edge's ends.
---
---Errors: singular (the equations have no solution), memory (the factor does not fit).
---
---Source: I. Baran and J. Popović, Automatic Rigging and Animation of 3D Characters, ACM Trans. Graph. 26 (2007);
---docs/theory/edit.md.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}}
---local joints = {a = {0.005, 0, 0}, b = {0.05, 0, 0}, c = {0.095, 0, 0}}
---local skeleton = bw.skeleton.create {joints = joints, bones = {{"a", "b"}, {"b", "c"}}}
---print(assert(bw.skinning_weights(mesh, skeleton)):column_sums()[1] / mesh.node_count) -- about a half
---```
---@param mesh bw.Mesh the mesh
---@param skeleton bw.Skeleton inside of it
---@param options? bw.SkinningWeightsOptions the heat
---@return bw.Array? weights (-, node_count × bone_count, per node) 0 or more; each row sums to 1
---@return string? message
---@return bw.Details? details
function bw.skinning_weights(mesh, skeleton, options) end

---How skinning weights are computed.
---@class bw.SkinningWeightsOptions
---@field heat? number (-) of the exchange with the bones, above 0: along the surface a weight falls from 0.95 to 0.05 in 4.6 / sqrt(heat) distances to the bone. Default: 20

---Making, extracting and reading skeletons.
---@class bw.SkeletonModule
local skeleton_module = {}

---A skeleton from joints and bones. Every joint must be reached by exactly one chain of bones; what is no tree raises.
---```lua
---local joints = {hip = {0, 0, 0.9}, knee = {0, 0, 0.5}, foot = {0, 0, 0.05}}
---local bones = {{"hip", "knee", name = "thigh"}, {"knee", "foot", name = "shank"}}
---local leg = bw.skeleton.create {joints = joints, bones = bones, root = "hip"}
---print(leg)
---```
---@param options bw.SkeletonCreateOptions joints and bones
---@return bw.Skeleton skeleton the tree
function skeleton_module.create(options) end

---Joints and bones of a skeleton.
---@class bw.SkeletonCreateOptions
---@field joints table<string, bw.Vector>|bw.JointGiven[] their places in m by name, or a list, whose joints may have names
---@field bones bw.BoneGiven[] pairs of joints, by name or number, either way round
---@field root? string|integer (index from 1) a joint. Default: the one in the middle

---A joint of a list: {x, y, z, name = "hip"}.
---@class bw.JointGiven: bw.Vector
---@field name? string of at most 47 bytes. Default: "joint 3" and so on

---A bone: {"hip", "knee", name = "thigh"}.
---@class bw.BoneGiven
---@field name? string of at most 47 bytes. Default: "bone 2" and so on

---The curve skeleton of a surface as joints and bones, by CGAL's mean curvature flow in a child process. A ring is cut open, with a
---warning. An open surface is repaired first, with a warning.
---
---Errors: geometry (the surface has several shells, no size, or cannot be repaired), limit (it took longer than `minutes`).
---```lua
---local body, min, max = bw.shapes.foal()
---local foal = assert(bw.surface.implicit(body, {min = min, max = max, cells = 48}))
---print(assert(bw.skeleton.extract(foal, {bones = 12})))
---```
---@param surface bw.Surface closed
---@param options? bw.SkeletonExtractOptions how many bones
---@return bw.Skeleton? skeleton joints lie inside of the surface
---@return string? message
---@return bw.Details? details
function skeleton_module.extract(surface, options) end

---How a skeleton is extracted.
---@class bw.SkeletonExtractOptions
---@field bones? integer (count) wanted number. Default: 0, as many as branches and bends ask for
---@field prune? number (-) a branch that reaches out of its junction by at most this many local radii is left out. Range: 0 and above. Default: 1.5
---@field bend? number (-) how many local radii a bone may stray from the curve, above 0. Default: 0.5
---@field minutes? number (minutes) the longest time it may take, above 0. Default: 5

---Reads a skeleton from a TGF file: "number x y z [name]" for every joint, "#", "from to [name]" for every bone.
---
---Errors: io (the file cannot be read), format (a line is wrong; details: `line`), limit (too many joints).
---```lua
---local rod = bw.skeleton.create {joints = {{0, 0, 0}, {0.1, 0, 0}}, bones = {{1, 2}}}
---assert(rod:write "rod.tgf")
---print(assert(bw.skeleton.read "rod.tgf"))
---```
---@param path string the file
---@param options? bw.UnitOptions the unit of its coordinates. Default: "mm"
---@return bw.Skeleton? skeleton the tree
---@return string? message
---@return bw.Details? details
function skeleton_module.read(path, options) end

---A tree of joints joined by bones. Skeletons do not change: methods give new ones. A bone runs from its head, nearer the root, to
---its tail. Bones and joints are called by name, or by number.
---```lua
---local leg = bw.skeleton.create {joints = {{0, 0, 0.9}, {0, 0, 0.5}, {0, 0, 0.05}}, bones = {{1, 2}, {2, 3}}, root = 1}
---local maps = assert(leg:pose_maps(leg:rest_pose()))
---print(leg:posed_joints(maps)(3, 3)) -- 0.05
---```
---@class bw.Skeleton
---@field joints bw.Array (m, joint_count × 3, per joint) their places
---@field bones bw.Array (index from 1, bone_count × 2, per bone) head and tail: numbers of joints. A parent comes before its children
---@field joint_names string[] in the order of `joints`
---@field bone_names string[] in the order of `bones`
---@field parents bw.Array (index from 1, bone_count × 1, per bone) the bone that it hangs on, 0 at the root
---@field frames bw.Array (-, bone_count × 9, per bone) its axes one after the other: x along the bone, y and z across it
---@field root string the joint's name
---@field joint_count integer (count) of joints
---@field bone_count integer (count) of bones
local Skeleton = {}

---A joint of the skeleton. An unknown one raises.
---@param joint string|integer (index from 1) its name or number
---@return bw.JointInfo joint the joint
function Skeleton:joint(joint) end

---A joint.
---@class bw.JointInfo
---@field index integer (index from 1) its number
---@field name string its name
---@field at bw.Vector (m) its place
---@field bones string[] names of the bones that meet there

---A bone of the skeleton. An unknown one raises.
---@param bone string|integer (index from 1) its name or number
---@return bw.BoneInfo bone the bone
function Skeleton:bone(bone) end

---A bone.
---@class bw.BoneInfo
---@field index integer (index from 1) its number
---@field name string its name
---@field head string the joint nearer the root
---@field tail string the other joint
---@field from bw.Vector (m) where the head is
---@field to bw.Vector (m) where the tail is
---@field length number (m) of the bone
---@field parent? string the bone that it hangs on
---@field children string[] the bones that hang on it

---Writes the skeleton to a TGF file.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.UnitOptions the unit of its coordinates. Default: "mm"
---@return true? written true
---@return string? message
---@return bw.Details? details
function Skeleton:write(path, options) end

---The skeleton with one more joint on a bone. The bone keeps its name on the side of its head.
---@param bone string|integer (index from 1) the bone
---@param fraction number (-) of its length from the head. Range: above 0, below 1
---@param name? string of the new joint. Default: chosen
---@return bw.Skeleton skeleton the changed tree
function Skeleton:insert_joint(bone, fraction, name) end

---The skeleton with a joint at another place. A bone without length raises.
---@param joint string|integer (index from 1) the joint
---@param at bw.Vector (m) the place
---@return bw.Skeleton skeleton the changed tree
function Skeleton:move_joint(joint, at) end

---The skeleton with two bones as one. They must meet at a joint of no other bone; else it raises.
---@param first string|integer (index from 1) whose name stays
---@param second string|integer (index from 1) the other bone
---@return bw.Skeleton skeleton the changed tree
function Skeleton:merge(first, second) end

---The skeleton without a bone and all below it. Where no bone is left it raises.
---@param bone string|integer (index from 1) the bone
---@return bw.Skeleton skeleton the changed tree
function Skeleton:remove(bone) end

---The skeleton with another root.
---@param joint string|integer (index from 1) the root
---@return bw.Skeleton skeleton the changed tree
function Skeleton:with_root(joint) end

---Releases the skeleton at once.
function Skeleton:close() end

---The pose with every bone at rest. A bone's row: its rotation by rows (9), the scale along its own axes (3), the translation of its
---head in the parent's directions (3, in m).
---@return bw.Array pose (any, bone_count × 15, per bone) the pose
function Skeleton:rest_pose() end

---Forward kinematics: the affine maps x → A x + b that take each bone from rest to a pose. A rotation that is none, and a scale of 0
---or below, raise.
---@param pose bw.Array|number[][] (any, bone_count × 15, per bone) as of `rest_pose`
---@return bw.Array maps (any, bone_count × 12, per bone) [A | b] by rows, b in m
---@return bw.Array rotations (-, bone_count × 9, per bone) the rotations in A
function Skeleton:pose_maps(pose) end

---The joints under maps of the bones.
---@param maps bw.Array|number[][] (any, bone_count × 12, per bone) as of `pose_maps`
---@return bw.Array joints (m, joint_count × 3, per joint) their places
function Skeleton:posed_joints(maps) end

---Inverse kinematics: turns bones so that all targets are met as nearly as limits allow, by damped least squares.
---
---Errors: only those that every function may give.
---@param pose bw.Array|number[][] (any, bone_count × 15, per bone) where it begins
---@param targets bw.ReachTarget[] at least one
---@param limits? (bw.ReachLimit|false)[] one for every bone; false: none. Default: none
---@param tolerance? number (m) when a target counts as met. Default: 1e-6 of the skeleton's size
---@return bw.Array? pose (any, bone_count × 15, per bone) the pose
---@return bw.ReachReport|string report how it went, or the message
---@return bw.Details? details
function Skeleton:reach(pose, targets, limits, tolerance) end

---A place that a bone is to reach.
---@class bw.ReachTarget
---@field bone string|integer (index from 1) the bone
---@field at bw.Vector (m) the place
---@field along? number (-) which point of the bone, 0: the head, 1: the tail. Default: 1
---@field weight? number (-) beside other targets. Default: 1
---@field from? string|integer (index from 1) the first bone that may turn. Default: from the root on

---How far a bone may turn against its parent.
---@class bw.ReachLimit
---@field swing? number (rad) largest angle between the bone and where its parent would carry it. Default: none
---@field twist_min? number (rad) smallest angle about the bone's own axis. Default: none
---@field twist_max? number (rad) largest angle about the bone's own axis. Default: none

---How inverse kinematics went.
---@class bw.ReachReport
---@field distance number (m) the largest that is left
---@field iterations integer (count) of the least squares
---@field reached boolean whether all targets are met; otherwise it is the best pose that was found
