---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Buckling
--
-- Load factors at which a part becomes unstable, and its buckling shapes.

---Load factors by ascending size, and their shapes. A negative factor belongs to the reversed load. `#buckling` is their number.
---Linear theory: loads keep their directions, displacements before buckling are small, and the part is perfect.
---```lua
---local mesh = bw.mesh.box {max = {0.5, 0.01, 0.02}, cells = {24, 1, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.5), force = {-100, 0, 0}}
---local buckling = assert(part:buckling {count = 2})
---print(buckling, buckling.factor, buckling.errors[1], buckling.counted)
---```
---@class bw.Buckling
---@field count integer (count) of load factors
---@field factors bw.Array (-, count × 1, per shape) by ascending size; of one size the positive one first
---@field factor number? (-) the smallest positive one; nil where none is positive
---@field errors bw.Array (-, count × 1, per shape) an exact factor of this mesh lies within this distance; see `error_estimate` for the error of the mesh
---@field counted boolean whether the Sturm count confirmed that none is missing
---@field searched number (-) to this size the wanted factors were searched for; where they were counted all of them are known
---@field solves integer (count) right-hand sides that were solved
---@field recovered integer (count) pairs that were found only after the Sturm count
---@field mesh bw.Mesh of the model
---@field report bw.SolverReport which eigensolver found them, why, and what it took; its residual is the largest error over its factor
local Buckling = {}

---A buckling shape. The largest displacement of a node is 1 m, and the largest component is positive. Shapes of one factor have a
---basis that does not depend on the eigensolver.
---@param i integer (index from 1) the load factor
---@return bw.Array shape (m, node_count × 3, per node) displacement
function Buckling:shape(i) end

---By how much each factor is too large in size on this mesh, relative to it: the recovered stress of the shape gives its error in
---energy. The error of the stress that the load causes is not in it.
---
---Errors: only those that every function may give.
---
---Source: docs/theory/stability.md; docs/theory/error_control.md.
---@return bw.Array? relative (-, count × 1, per shape) the error
---@return string? message
---@return bw.Details? details
function Buckling:error_estimate() end

---The mesh moved along a combination of shapes: an imperfect part, for a nonlinear run.
---
---Errors: geometry (an element is inverted by so large an amplitude).
---```lua
---local mesh = bw.mesh.box {max = {0.5, 0.01, 0.02}, cells = {24, 1, 2}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.5), force = {-100, 0, 0}}
---local bent = assert(part:buckling {count = 1}):imperfect_mesh {amplitude = 1e-3}
---print(bent.box.size[1])
---```
---@param options bw.BucklingImperfectMeshOptions amplitude and shapes
---@return bw.Mesh? mesh the moved mesh
---@return string? message
---@return bw.Details? details
function Buckling:imperfect_mesh(options) end

---An imperfection.
---@class bw.BucklingImperfectMeshOptions
---@field amplitude number (m) the largest displacement of a node
---@field weights? number[] (-, up to count) of the shapes from the first on. Default: {1}

---Writes the shapes to a .vtu file, as fields shape_01, shape_02, ... Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function Buckling:write(path, options) end

---Draws a buckling shape as a PNG file, deformed and coloured by the movement.
---
---Errors: those of `bw.picture`.
---@param i integer (index from 1) the load factor
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Buckling:picture(i, path, options) end

---Releases the load factors and shapes at once.
function Buckling:close() end
