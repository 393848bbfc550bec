---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Drop test
--
-- Random drops of a part onto a peg, thousands of them from one set of equations.

---@class bw
local bw = {}

---Drops a free part onto a peg in random orientations. The contact area follows from the indentation of part and peg. A part with
---supports, or of a material without a density, raises.
---
---Errors: singular (the matrix is not positive definite), memory (the factor does not fit).
---
---Source: Zhou, Panetta and Zorin 2013, section 5; docs/theory/worst_case.md.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local drops = assert(bw.drop_test(bw.model {mesh = mesh, material = bw.material.pla}, {drops = 100}))
---print(drops, drops:failures())
---```
---@param part bw.Model without supports, of a material with a density
---@param options? bw.DropTestOptions height, peg and number of drops
---@return bw.DropTest? drops what happened
---@return string? message
---@return bw.Details? details
function bw.drop_test(part, options) end

---How a part is dropped.
---@class bw.DropTestOptions
---@field drops? integer (count) of drops. Range: 1 to 100000000. Default: 2000
---@field height? number (m) of the fall, above 0. Default: 1
---@field peg_radius? number (m) of the peg. Default: 0, 2 % of the diagonal of the part's box
---@field duration? number (s) of the contact, above 0; the mean force is 2 m v / duration, with the effective mass m at the contact and the velocity v. Default: 1e-3
---@field seed? integer (seed) of the orientations. Default: 1
---@field solver? bw.Solver|"auto" of the linear systems. Default: "auto", a factor unless it is predicted to take more than 4 GB or more than the free memory

---What happened in the drops. `print` gives it in one line.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local drops = assert(bw.drop_test(part, {drops = 100}))
---print(drops.peaks:max(), drops:correlation(assert(bw.worst_case(part, {force = 50}))))
---```
---@class bw.DropTest
---@field exceedance bw.Array (-, element_count × 1, per element) fraction of drops in which it was stressed beyond the strength
---@field mean_peak bw.Array (Pa, element_count × 1, per element) mean over the drops of its largest principal stress
---@field contacts bw.Array (m, drops × 3, per drop) where the peg touches
---@field directions bw.Array (-, drops × 3, per drop) unit vector along the peg's normal, in which the impulse acts on the part
---@field resultants bw.Array (N, drops × 3, per drop) sum of the nodal forces
---@field nodes bw.Array (count, drops × 1, per drop) nodes that carry the contact
---@field forces bw.Array (N, drops × 1, per drop) mean force of the contact
---@field areas bw.Array (m2, drops × 1, per drop) of the contact, seen along its force
---@field peaks bw.Array (Pa, drops × 1, per drop) largest stress
---@field threshold number (Pa) what counts as overload where the strength is not known: the 97.5th percentile by volume of the first 200 drops; 0 otherwise
---@field drops integer (count) of drops
---@field seconds number (s) in all
---@field reports table<string, bw.SolverReport> of solvers: `solver`, all linear systems
---@field mesh bw.Mesh of the part
---@field options bw.DropTestOptions as they were given, with defaults
local DropTest = {}

---Spearman's rank correlation of `mean_peak` with a weakness, weighted by volume.
---@param other bw.WorstCase|bw.BruteForce|bw.Array (Pa, element_count × 1, per element) the weakness
---@return number rho (-) from -1 to 1
function DropTest:correlation(other) end

---The fraction of drops that overload the weakest element.
---@return number fraction (-) from 0 to 1
function DropTest:failures() end

---Writes `exceedance` and `mean_peak` to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function DropTest:write(path) end

---Draws `exceedance` as a PNG file.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function DropTest:picture(path, options) end
