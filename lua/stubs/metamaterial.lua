---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Metamaterials
--
-- Libraries of coarse materials.

---Libraries of coarse materials, fitted once to every block of a material table's materials (data-driven,
---section 4).
---@class bw.MetamaterialModule
local metamaterial_module = {}

---Builds a library: every 2 x 2 x 2 block of the material table's materials (and void, unless `voids` is
---false) is loaded by `directions` (500) forces of `magnitudes` (5), and a material of one cell fitted.
---`levels` 2: blocks of such blocks too. `checkpoint`: a file that a build that was killed carries on
---from.
---@param materials bw.Hyperelastic[]|bw.MaterialTable
---@param options? bw.MetamaterialBuildOptions
---@return bw.Library?
---@return string? message
---@return bw.Details? details
function metamaterial_module.build(materials, options) end

---@class bw.MetamaterialBuildOptions
---@field levels? integer
---@field voids? boolean
---@field directions? integer
---@field magnitudes? integer
---@field stretches? integer
---@field fibres? integer
---@field strain? number
---@field ridge? number
---@field representatives? integer
---@field seed? integer
---@field checkpoint? string

---A library with fits of its own for the blocks of a grid that have none: of 4 x 4 x 4 cells, with
---`levels` 2, and of 2 x 2 x 2 that were left out. Of a material table, with the options of `build`: a library of
---nothing but this grid's blocks, the others being coarsened naively. Grown for several grids one after the
---other, it serves all. `checkpoint`: a file that keeps finished fits, for any grid.
---@param of bw.Library|bw.Hyperelastic[]|bw.MaterialTable
---@param grid bw.Grid
---@param options? bw.MetamaterialGrowOptions
---@return bw.Library?
---@return string? message
---@return bw.Details? details
function metamaterial_module.grow(of, grid, options) end

---@class bw.MetamaterialGrowOptions
---@field levels? integer
---@field checkpoint? string
---@field voids? boolean
---@field directions? integer
---@field magnitudes? integer
---@field stretches? integer
---@field fibres? integer
---@field strain? number
---@field ridge? number
---@field seed? integer

---@param path string .bwm
---@return bw.Library?
---@return string? message
---@return bw.Details? details
function metamaterial_module.read(path) end

---@class bw.Library
---@field levels integer
---@field materials bw.MaterialTable
---@field seconds number that building took
---@field errors table[][] for each level and fit: median, worst, naive_median, naive_worst, force, naive_force, samples
---@field grown integer[] for each of two levels, how many blocks were fitted for grids
local Library = {}

---@param path string .bwm
---@return bw.Library?
---@return string? message
---@return bw.Details? details
function Library:write(path) end

---The material of a block, by its 8 materials (64 for level 2), child by child; 0 is void.
---@param key integer[]
---@return bw.Hyperelastic?
---@return integer|string fit its number, or a message
---@return bw.Details? details
function Library:material(key) end

---Releases it early.
function Library:close() end
