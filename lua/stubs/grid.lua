---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Grids
--
-- Grids of hexahedra, and points embedded in them.

---Grids of hexahedra: boxes, and voxels of closed surfaces.
---@class bw.GridModule
local grid_module = {}

---What is chosen by geometry, in metres, so that it means the same on a fine grid and on its coarse one.
---All parts that are given must hold. Cells count by their middles, `inside` by half their volume. In
---its place a function of x, y, z or a formula (`where`), or a surface (`inside`), may stand.
---@class bw.Region
---@field low? bw.Vector low corner of a box along the axes
---@field high? bw.Vector its high corner; either of the two may be left out
---@field box? bw.Vector[] both at once: {low, high}
---@field centre? bw.Vector of a ball
---@field radius? number of the ball, m
---@field plane? bw.Vector[] {point, normal}: on this plane
---@field beyond? bw.Vector[] {point, normal}: on the side that the normal points to
---@field side? string the outermost nodes or cells: "low x", "high x", "low y", "high y", "low z", "high z"
---@field boundary? boolean with a face that has no neighbour
---@field inside? bw.Surface closed
---@field where? function|string of x, y, z: true, or a number but 0
---@field within? number what lies outside by less counts too, m; default a millionth of a cell

---A box of elements. Two of `size` (or `high`), `cells` and `spacing` are needed; one number stands for
---three alike. `material` is a number (1), a function of x, y, z or a formula in them, taken at the
---middle of each cell, or a list with one for every cell, x fastest; 0 is void.
---@param options bw.GridBoxOptions
---@return bw.Grid?
---@return string? message
---@return bw.Details? details
function grid_module.box(options) end

---@class bw.GridBoxOptions
---@field size? bw.Vector|number
---@field low? bw.Vector|number
---@field high? bw.Vector|number
---@field cells? integer[]|integer
---@field spacing? bw.Vector|number
---@field material? integer|function|string|table|bw.Array

---The cubes that a closed surface cuts or holds, of side `spacing`, or `cells` (32) along its longest
---side. Cells with a part inside that is smaller than `least` (0.05) are void; others count by their
---part, or as full ones with `whole`. `multiple`: so many cells in each direction, or a multiple of it.
---`material` as for a box, but no list.
---@param surface bw.Surface
---@param options? bw.GridVoxelsOptions
---@return bw.Grid?
---@return string? message
---@return bw.Details? details
function grid_module.voxels(surface, options) end

---@class bw.GridVoxelsOptions
---@field spacing? number
---@field cells? integer
---@field least? number
---@field whole? boolean
---@field multiple? integer
---@field material? integer|function|string

---Grids side by side in one PNG file, with the same camera, scale and colours. A panel is coloured by
---material unless it has `values`, of nodes or elements. With the `embedding` of a surface in its grid
---the surface is drawn in place of the elements.
---@param path string
---@param panels bw.GridPanel[]
---@param options? bw.GridPictureOptions
---@return boolean?
---@return string? message
---@return bw.Details? details
function grid_module.picture(path, panels, options) end

---@class bw.GridPanel
---@field grid bw.Grid
---@field title? string
---@field displacement? bw.Array|table
---@field values? bw.Array|table
---@field embedding? bw.Embedding

---@class bw.GridPictureOptions
---@field width? integer pixels of a panel
---@field height? integer
---@field columns? integer panels in a row; default 4 at most
---@field title? string
---@field unit? string name and unit of the colour bar: "deflection, mm"
---@field scale? number values are multiplied by it on the bar
---@field low? number lower end of the colours
---@field high? number upper end of the colours
---@field deformation? number factor on displacements; default 1
---@field edges? boolean of elements; default true
---@field ghost? boolean the undeformed outline behind
---@field direction? bw.Vector from the object to the viewer
---@field up? bw.Vector
---@field zoom? number
---@field view? bw.Vector[] {low, high}: the box to be seen, for pictures of a sequence; default what the panels fill
---@field names? string[] of materials, for the legend

---Equal boxes of which some are elements, with the nodes that they have; never changed. Cells and nodes
---are numbered x fastest. Corner c of an element (1 to 8) lies at the bits of c - 1: x, y, z.
---@class bw.Grid
---@field cells integer[] of the lattice along x, y, z
---@field spacing bw.Vector sides of a cell, m
---@field origin bw.Vector low corner of the lattice, m
---@field box bw.Box of the elements
---@field element_count integer
---@field node_count integer
---@field points bw.Array x, y, z of nodes, m
---@field elements bw.Array eight nodes each
---@field element_cells bw.Array the cell of each element
---@field materials bw.Array of elements: 1 and above
---@field fractions bw.Array of elements: the part of the cell that is inside the body
---@field material_counts table<integer, integer> elements of each material
---@field volume number m3, fractions counted
local Grid = {}

---The grid with other materials in some cells: cells by number, as they stand; or the elements in a
---region, with `void` its void cells too. Material 0 takes elements away. `material` as for grid.box;
---a list goes with cells by number. The grid itself where nothing changes.
---@param cells integer|integer[]|bw.Array|bw.Region|bw.Surface|function|string
---@param material integer|function|string|table|bw.Array
---@param options? bw.GridSetOptions
---@return bw.Grid?
---@return string? message
---@return bw.Details? details
function Grid:set(cells, material, options) end

---@class bw.GridSetOptions
---@field void? boolean

---Numbers of the nodes in a region. None at all is an error that names the nearest.
---@param region bw.Region|bw.Surface|function|string
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function Grid:nodes(region) end

---Numbers of the elements' cells in a region, with `void` of other cells too.
---@param region bw.Region|bw.Surface|function|string
---@param options? bw.GridSetOptions
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function Grid:cells_in(region, options) end

---2 x 2 x 2 cells become one, `levels` times (1): an element where one of them is. Its materials are
---all 1.
---@param levels? integer
---@return bw.Grid?
---@return bw.Array parents the coarse element of every element; or a message
---@return bw.Details? details
function Grid:coarse(levels) end

---The boundary as a surface, two triangles a face, with the materials as groups.
---@return bw.Surface?
---@return bw.Array nodes of the surface's points; or a message
---@return bw.Details? details
function Grid:surface() end

---Bodies: elements that hang together by nodes.
---@return integer? count
---@return bw.Array bodies of elements; or a message
---@return bw.Details? details
function Grid:components() end

---Points, or those of a surface, that go with the elements. A point outside takes the nearest element,
---up to `reach` cells away (1).
---@param what bw.Surface|bw.Array|table
---@param options? bw.GridEmbedOptions
---@return bw.Embedding?
---@return string? message
---@return bw.Details? details
function Grid:embed(what, options) end

---@class bw.GridEmbedOptions
---@field reach? number

---The mean distance of nodes moved by u and by v, over the longest side of the box.
---@param u table|bw.Array a row of three for every node
---@param v table|bw.Array
---@return number
function Grid:difference(u, v) end

---Draws the elements with their edges, by material or by values, deformed, to a PNG file.
---@param path string
---@param options? bw.GridPictureOptions with `displacement`, `values` and `embedding` as in a panel
---@return boolean?
---@return string? message
---@return bw.Details? details
function Grid:picture(path, options) end

---Whether elements and nodes are the same; materials may differ.
---@param other bw.Grid
---@return boolean
function Grid:same_elements(other) end

---Writes a .vtu file of hexahedra with materials and fractions.
---@param path string
---@param options? bw.GridWriteOptions name = array, of nodes or elements
---@return boolean?
---@return string? message
---@return bw.Details? details
function Grid:write(path, options) end

---@class bw.GridWriteOptions
---@field fields? table

---Lets go at once.
function Grid:close() end

---Points that go with a grid's elements by trilinear interpolation.
---@class bw.Embedding
---@field grid bw.Grid
---@field elements bw.Array of points
---@field point_count integer
local Embedding = {}

---Values of nodes at the points.
---@param values table|bw.Array a row for every node
---@return bw.Array
function Embedding:values(values) end

---Forces at the points as forces at nodes: the same total, moment and work.
---@param forces table|bw.Array a row for every point
---@return bw.Array
function Embedding:forces(forces) end

---The surface, moved with the nodes.
---@param displacements table|bw.Array a row of three for every node
---@return bw.Surface?
---@return string? message
---@return bw.Details? details
function Embedding:moved(displacements) end

---Lets go at once.
function Embedding:close() end
