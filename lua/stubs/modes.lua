---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Modes
--
-- Natural frequencies and mode shapes of a part.

---Modes by ascending frequency, or those of the Laplacian. `#modes` is their number.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.002}, cells = {20, 2, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.aluminium}
---local modes = assert(part:modes {count = 3})
---print(modes, modes.frequencies[1], modes:shape(1):column(3):max())
---```
---@class bw.Modes
---@field count integer (count) of modes
---@field components integer (count) of a shape: 3, or 1 of the Laplacian
---@field eigenvalues bw.Array ((rad/s)^2, count × 1, per mode) with density 1 where the material has none; 1/m2 of the Laplacian
---@field frequencies bw.Array? (Hz, count × 1, per mode) nil of the Laplacian, and where the density is not known
---@field residuals bw.Array (-, count × 1, per mode) |K u - lambda M u| / |lambda M u|
---@field rigid_count integer (count) rigid-body motions that were left out
---@field solves integer (count) right-hand sides that were solved
---@field recovered integer (count) modes that were found only after the Sturm count, or by the test in place of it
---@field counted boolean whether the Sturm count confirmed that none is missing
---@field tested boolean whether, without a factor, an iteration from random vectors found no missing mode; that is no proof
---@field nodal_diameters integer[]? (count, count, per mode) of each mode of a sector of cyclic symmetry; nil of the whole
---@field mesh bw.Mesh of the model
---@field report bw.SolverReport which eigensolver found them, why, and what it took
local Modes = {}

---A mode shape, of unit modal mass. Its largest component is positive. Modes of one frequency have a basis that does not
---depend on the eigensolver.
---@param i integer (index from 1) the mode
---@return bw.Array shape (any, node_count × components, per node) displacement, or the value of the Laplacian's mode
function Modes:shape(i) end

---The modes of the whole wheel from those of a sector of cyclic symmetry, of unit modal mass, on the mesh of `Model:whole`. A
---sector's own shape is the real part of a complex one where its nodal diameters are neither 0 nor half the sectors. Modes of the
---whole raise.
---```lua
---local box = bw.mesh.box {max = {1, 1, 0.3}, cells = {3, 3, 1}}
---local part = bw.model {mesh = box, material = bw.material.steel}
---assert(part:cyclic {low = box.boundary:below("y", 0), high = box.boundary:below("x", 0), count = 4})
---local whole = assert(assert(part:modes {count = 4}):whole())
---print(whole, whole.mesh)
---```
---
---Errors: limit (too many nodes).
---
---Source: docs/theory/symmetry.md.
---@return bw.Modes? modes of the whole
---@return string? message
---@return bw.Details? details
function Modes:whole() end

---By how many cents each frequency is too high: the recovered stress of the shape gives its error in energy. Modes of the
---Laplacian raise.
---
---Errors: only those that every function may give.
---
---Source: docs/theory/error_control.md.
---@return bw.Array? cents (cents, count × 1, per mode) 1200 of them are an octave
---@return string? message
---@return bw.Details? details
function Modes:error_estimate() end

---Writes the shapes to a .vtu file, as fields mode_01, mode_02, ... Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function Modes:write(path, options) end

---Draws a mode shape as a PNG file, deformed and coloured by the movement.
---
---Errors: those of `bw.picture`.
---@param i integer (index from 1) the mode
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Modes:picture(i, path, options) end

---Releases the modes at once.
function Modes:close() end
