---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Response spectrum
--
-- The largest response of a part whose supports are shaken by a motion that is known by its response spectrum.

---The largest response to a base's motion: modes up to the last point of the spectrum, the static response of what they leave
---out, and their combination. Displacements are relative to the supports. Loads of the part are not in it.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:response_spectrum {points = {{10, 5}, {100, 20}, {2000, 3}}, direction = {0, 0, 1}})
---print(shaken, shaken.von_mises:max() < 200e6)
---assert(shaken:write "shaken.vtu")
---```
---@class bw.ResponseSpectrum
---@field displacement bw.Array (m, node_count × 3, per node) the largest of each component
---@field von_mises bw.Array (Pa, node_count × 1, per node) the largest von Mises stress; where materials meet, that of the one with the largest
---@field base_force number[] (N, 3) on the supports and springs, the largest along each axis
---@field couplings bw.PointMotion[] the largest motion of each coupling's remote point, component by component
---@field participation bw.Array (any, n × 1) participation factor of each mode, of unit modal mass
---@field effective_masses bw.Array (kg, n × 1) effective mass of each mode
---@field accelerations bw.Array (m/s2, n × 1) that the spectrum gives each mode
---@field mass number (kg) of the part
---@field missing_mass number (kg) which the modes leave out
---@field base_acceleration number (m/s2) the acceleration that the missing mass has; 0 where the response lacks it
---@field combination "cqc"|"srss"|"absolute" of the modes
---@field direction number[] (-, 3) of the base's acceleration, of length 1
---@field modes bw.Modes those found; the first of them, up to the last point, are in the response
---@field mesh bw.Mesh of the model
local ResponseSpectrum = {}

---Writes the largest displacement and von Mises stress to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function ResponseSpectrum:write(path, options) end

---Draws the body as a PNG file, coloured by the largest von Mises stress.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function ResponseSpectrum:picture(path, options) end

---The largest response when the base moves along several directions at once, each with a spectrum of its own. The directions
---are at right angles, and their motions do not depend on each other. Responses of another model raise, and so do those from before a
---change of the model and those along other directions. A change of loads does not count where both have the same `modes`.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local base = {points = {{10, 5}, {2000, 3}}, direction = {1, 0, 0}}
---local x = assert(part:response_spectrum(base))
---base.direction, base.modes = {0, 1, 0}, x.modes
---print(x:combine({assert(part:response_spectrum(base))}, {rule = "100-40-40"}))
---```
---
---Source: [theory](../theory/dynamics.md#response-spectrum).
---@param others bw.ResponseSpectrum[] those of the other directions, one or two
---@param options? bw.CombineOptions by which rule
---@return bw.CombinedSpectrum combined the largest response
function ResponseSpectrum:combine(others, options) end

---Releases the response at once.
function ResponseSpectrum:close() end

---How directions are combined.
---@class bw.CombineOptions
---@field rule? "srss"|"100-40-40" root of the sum of squares, or the largest of 100 % of one direction and 40 % of each other. Default: "srss".

---The largest response to several directions at once; `print` shows that of each beside it.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local function along(d) return assert(part:response_spectrum {points = {{10, 5}, {2000, 3}}, direction = d}) end
---local combined = along {0, 0, 1}:combine {along {0, 1, 0}}
---print(combined.von_mises:max(), combined.base_force[3])
---```
---@class bw.CombinedSpectrum
---@field displacement bw.Array (m, node_count × 3, per node) the largest of each component
---@field von_mises bw.Array (Pa, node_count × 1, per node) the largest von Mises stress
---@field base_force number[] (N, 3) on the supports and springs, the largest along each axis
---@field couplings bw.PointMotion[] the largest motion of each coupling's remote point, component by component
---@field rule "srss"|"100-40-40" of the combination
---@field responses bw.ResponseSpectrum[] those of the directions
---@field mesh bw.Mesh of the model
local CombinedSpectrum = {}

---Writes the largest displacement and von Mises stress to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function CombinedSpectrum:write(path, options) end

---Draws the body as a PNG file, coloured by the largest von Mises stress.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function CombinedSpectrum:picture(path, options) end
