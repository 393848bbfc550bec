---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Metamaterials
--
-- Libraries of coarse materials: for each block of fine elements, a material with which one large element
-- answers as the block does. `solid:coarsen` looks them up.

---Libraries of coarse materials, fitted once to the blocks that a table's materials can form.
---
---Source: docs/theory/data_driven.md; D. Chen, D. I. W. Levin, S. Sueda, W. Matusik, Data-driven finite elements
---for geometry and material design, ACM Trans. Graph. 34 (2015), section 4.
---```lua
---local soft = bw.hyperelastic {young = 2e5, poisson = 0.45, density = 1000}
---local stiff = bw.hyperelastic {young = 2e6, poisson = 0.45, density = 1000}
---local library = assert(bw.metamaterial.build({soft, stiff}, {voids = false, directions = 20, magnitudes = 2,
---  stretches = 20, fibres = 1}))
---print(library) -- how many blocks were fitted, and how well
---```
---@class bw.MetamaterialModule
local metamaterial_module = {}

---A library of all blocks: each of 2 × 2 × 2 elements of the materials (and void) is loaded by random forces, and
---the material of one element is fitted to its energies. Blocks that a symmetry of the cube takes into each other
---share one fit. It is the same, bit for bit, for any number of threads, and for a run that carried on from a
---checkpoint.
---
---The errors that were measured are in `errors`. The defaults take minutes; the fewer directions of this example
---are for trying out. Materials that differ from point to point are refused, as is a checkpoint of other materials
---or options.
---
---Errors: limit (more than 2^24 blocks: seven materials and void are the most), io (the checkpoint cannot be read or
---written), format (the checkpoint is damaged), singular (a block's materials do not hold together), memory,
---cancelled (the checkpoint is kept).
---```lua
---local soft = bw.hyperelastic {young = 2e5, poisson = 0.45, density = 1000}
---local stiff = bw.hyperelastic {young = 2e6, poisson = 0.45, density = 1000}
---local library = assert(bw.metamaterial.build({soft, stiff}, {voids = false, directions = 20, magnitudes = 2,
---  stretches = 20, fibres = 1, checkpoint = "two.checkpoint"}))
---print(#library.errors[1], library.errors[1][1].median) -- blocks, and the error of the first
---```
---@param materials bw.Hyperelastic[]|bw.MaterialTable (one to seven) by number: the first is 1
---@param options? bw.MetamaterialBuildOptions how thoroughly
---@return bw.Library? library what was fitted
---@return string? message
---@return bw.Details? details
function metamaterial_module.build(materials, options) end

---How thoroughly blocks are sampled and fitted.
---@class bw.MetamaterialBuildOptions
---@field levels? integer (count) 1: blocks of 2 × 2 × 2 elements; 2: blocks of 4 × 4 × 4 too. Default: 1. Range: 1 to 2; 0 with `build`: nothing is fitted, the library is to be grown
---@field voids? boolean whether blocks with void are fitted too; without, they are coarsened naively. Default: true
---@field directions? integer (count) of force, for each block. Default: 500. Range: at least 1
---@field magnitudes? integer (count) of the force along each direction. Default: 5. Range: 1 to 1000
---@field stretches? integer (count) directions in which a block without symmetry is stretched to find axes of fibres. Default: 500. Range: at least 0
---@field fibres? integer (count) axes of anisotropy at a point. Default: 3. Range: 0 to 3
---@field strain? number (-) the largest deformation that is sampled, roughly. Default: 0.1. Range: 1e-5 to 10
---@field ridge? number (-) λ of formula 4: to move a constant by its own size costs as much as this relative error. Default: 0.01. Range: at least 0
---@field representatives? integer (count) at every stage of level 2; so many blocks are fitted. Default: 400. Range: 8 to 4000
---@field seed? integer (seed) of the random forces. Default: 1
---@field checkpoint? string path of a file that finished fits are added to, and from which a build that was killed carries on. Default: none

---A library with fits of its own for the blocks of a grid that have none: of 2 × 2 × 2 elements those that were left
---out, and with `levels` 2 each of 4 × 4 × 4 for which a representative would stand. Of materials instead of a
---library: nothing but this grid's blocks are fitted, which takes seconds, and others are coarsened naively.
---Grown for several grids one after the other, it serves all; the library that is given stays as it is.
---
---Errors: io (the checkpoint cannot be read or written), format (the checkpoint is damaged), singular (a block's
---materials do not hold together), limit, memory, cancelled (the checkpoint is kept).
---```lua
---local soft = bw.hyperelastic {young = 2e5, poisson = 0.45, density = 1000}
---local stiff = bw.hyperelastic {young = 2e6, poisson = 0.45, density = 1000}
---local grid = assert(bw.grid.box {size = {0.04, 0.02, 0.02}, cells = {4, 2, 2}, material = "where(x < 0.02, 1, 2)"})
---local library = assert(bw.metamaterial.grow({soft, stiff}, grid))
---print(library.grown[1]) -- the blocks that the grid has
---```
---@param of bw.Library|bw.Hyperelastic[]|bw.MaterialTable the library to begin with, or materials by number
---@param grid bw.Grid whose blocks are wanted
---@param options? bw.MetamaterialGrowOptions of a library only `levels` and `checkpoint`, since it has the others
---@return bw.Library? library a new one
---@return string? message
---@return bw.Details? details
function metamaterial_module.grow(of, grid, options) end

---For which blocks a library is grown and, of materials, how thoroughly.
---@class bw.MetamaterialGrowOptions: bw.MetamaterialBuildOptions
---@field levels? integer (count) 1: blocks of 2 × 2 × 2 elements; 2: of 4 × 4 × 4 too. Default: 1. Range: 1 to 2

---A library from a file that `library:write` wrote.
---
---Errors: io (the file cannot be read), format (it is damaged, something else, or of another version), memory.
---```lua
---local library, message, details = bw.metamaterial.read "missing.bwm"
---print(library, message, details.status) -- nil, why, "io"
---```
---@param path string of a .bwm file
---@return bw.Library? library as it was written
---@return string? message
---@return bw.Details? details
function metamaterial_module.read(path) end

---Coarse materials by block. `tostring` says how many, and how large their errors are.
---```lua
---local soft = bw.hyperelastic {young = 2e5, poisson = 0.45, density = 1000}
---local library = assert(bw.metamaterial.build({soft}, {voids = false, directions = 20, magnitudes = 2, fibres = 1}))
---assert(library:write "one.bwm")
---local material, fit = library:material {1, 1, 1, 1, 1, 1, 1, 1}
---print(material, fit, library.errors[1][fit].median)
---```
---@class bw.Library
---@field levels integer (count) of levels that blocks can be looked up at: 1 or 2
---@field materials bw.MaterialTable the materials that the blocks are made of
---@field seconds number (s) that building took, over all runs; 0 of a library that was read
---@field errors bw.LibraryError[][] (one list for each level, one entry for each fit) how well each does; not of blocks it was grown by
---@field grown integer[] (count, 2: for each level) blocks that were fitted for grids
local Library = {}

---How well one coarse material does on deformations that it was not fitted to, and how well the mean of the block's
---materials (the naive one) would do.
---@class bw.LibraryError
---@field median number (-) of energies: the difference from the block's, relative to it
---@field worst number (-) the 95th percentile of the same
---@field naive_median number (-) the median of the naive material
---@field naive_worst number (-) the 95th percentile of the naive material
---@field force number (-) the median of the difference of the element's forces, relative to them
---@field naive_force number (-) the same of the naive material
---@field samples integer (count) deformations that were found; a block may refuse extreme forces

---Writes the library with its materials, fits and errors into one file, with a checksum.
---
---Errors: io (the file cannot be written), memory.
---```lua
---local library = assert(bw.metamaterial.build({bw.hyperelastic {young = 2e5, poisson = 0.45}}, {voids = false,
---  directions = 20, magnitudes = 2, fibres = 1}))
---assert(library:write "one.bwm")
---print(bw.metamaterial.read("one.bwm").seconds) -- 0.0: it was read
---```
---@param path string of a .bwm file
---@return bw.Library? library itself
---@return string? message
---@return bw.Details? details
function Library:write(path) end

---The material of a block. One of void alone has none and is refused, as are levels that the library has not.
---
---Errors: singular, memory.
---```lua
---local soft = bw.hyperelastic {young = 2e5, poisson = 0.45, density = 1000}
---local stiff = bw.hyperelastic {young = 2e6, poisson = 0.45, density = 1000}
---local library = assert(bw.metamaterial.build({soft, stiff}, {voids = false, directions = 20, magnitudes = 2,
---  stretches = 20, fibres = 1}))
---print(library:material {1, 2, 1, 2, 1, 2, 1, 2}) -- a half of each, side by side along x
---```
---@param key integer[] (index from 1, 8, or 64 for level 2; 0: void) materials, child by child: x is the lowest bit of a child's place, then y, then z; of 64, such eights one after the other
---@return bw.Hyperelastic? material of the coarse element
---@return integer|string fit (index from 1) of the fit in `errors`, 0: none was fitted; or a message
---@return bw.Details? details
function Library:material(key) end

---Releases its memory early, which the garbage collector else does.
---```lua
---local grid = assert(bw.grid.box {size = {0.02, 0.02, 0.02}, cells = {2, 2, 2}})
---local library = assert(bw.metamaterial.grow({bw.hyperelastic {young = 2e5, poisson = 0.45}}, grid))
---library:close()
---```
function Library:close() end
