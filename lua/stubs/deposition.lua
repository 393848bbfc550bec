---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Depositions
--
-- Residual stress and distortion of parts that are laid down layer by layer, such as prints, welds and castings.

---A part that was laid down. Linear elasticity without yielding: stresses above the yield stress are not what the part has.
---```lua
---local mesh = bw.mesh.box {max = {0.04, 0.01, 0.01}, cells = {8, 2, 4}, order = 2}
---local steel = bw.material.isotropic {young = 210e9, poisson = 0.3, expansion = 12e-6}
---local part = bw.model {mesh = mesh, material = steel}:fix(mesh.boundary:below("z", 0))
---local built = assert(part:deposit {layers = 4, change = -200})
---print(built, assert(built:release(bw.model {mesh = mesh, material = steel})))
---```
---@class bw.Deposition
---@field layers integer (count) in which elements were laid
---@field layer bw.Array (index from 1, element_count × 1, per element) the layer with which it was laid
---@field postponed integer (count) elements laid later than asked for, because nothing that was laid had a facet with them
---@field postponed_volume number (m3) of these
---@field displacement bw.Array (m, node_count × 3, per node) since the node was laid
---@field element_stress bw.Array (Pa, element_count × 6, per element) mean tensors xx yy zz yz zx xy
---@field element_von_mises bw.Array (Pa, element_count × 1, per element) of `element_stress`
---@field reaction bw.Array (N, node_count × 3, per node) of the supports
---@field residual number (-) the largest one of the layers' static solutions
---@field mesh bw.Mesh of the part
local Deposition = {}

---Other supports, in place of those that the part was laid on: what they exerted is taken away, and the part springs back.
---
---Errors: unconstrained and others of `part:solve`. A model of another mesh or stiffness, and one with loads or prescribed
---displacements, raise.
---@param part bw.Model of the same mesh, with the supports that stay; without any the part is free
---@param options? bw.DepositionReleaseOptions solver
---@return bw.Deposition? released the part afterwards
---@return string? message
---@return bw.Details? details
function Deposition:release(part, options) end

---How a released part is solved.
---@class bw.DepositionReleaseOptions
---@field solver? bw.Solver|"auto" as in `part:solve`. Default: "auto"

---Writes displacement, reaction, stress and layers.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function Deposition:write(path) end

---Draws the deformed part as a PNG file, coloured by its von Mises stress: means of elements, brought to the nodes by volume.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Deposition:picture(path, options) end

---Releases the deposition at once.
function Deposition:close() end
