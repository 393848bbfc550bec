---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Drop test
--
-- Random drops of a part onto a peg.

---@class bw
local bw = {}

---Random drops of a free part onto a peg, thousands from one factor. The area of each contact follows from the
---indentation of part and peg.
---@param part bw.Model without supports, of a material with a density
---@param options? bw.DropTestOptions
---@return bw.DropTest?
---@return string? message
---@return bw.Details? details
function bw.drop_test(part, options) end

---@class bw.DropTestOptions
---@field drops? integer
---@field height? number
---@field peg_radius? number
---@field duration? number
---@field seed? integer

---@class bw.DropTest
---@field exceedance bw.Array of every element: fraction of drops beyond the strength
---@field mean_peak bw.Array of every element: mean largest principal stress, Pa
---@field contacts bw.Array drops x 3, m
---@field pushes bw.Array drops x 3: unit vectors along the peg's normal, in which the impulse acts on the body
---@field resultants bw.Array drops x 3, N: sums of the nodal forces
---@field nodes bw.Array drops: how many nodes carry the contact
---@field forces bw.Array N
---@field areas bw.Array m2: of the contact of each drop, seen along its force
---@field peaks bw.Array largest stress of every drop, Pa
---@field threshold number Pa, where no strength is known
---@field drops integer
---@field seconds number
---@field mesh bw.Mesh
---@field options table
local DropTest = {}

---Rank correlation, by volume, with a weakness map (a worst case, a brute force, an array).
---@param other bw.WorstCase|bw.BruteForce|bw.Array
---@return number?
function DropTest:correlation(other) end

---The fraction of drops that overload the weakest place.
---@return number
function DropTest:failures() end

---@param path string
---@return true?
function DropTest:write(path) end

---@param path string
---@param options? bw.PictureOptions
---@return true?
function DropTest:picture(path, options) end
