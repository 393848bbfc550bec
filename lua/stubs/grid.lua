---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Grids
--
-- Grids of hexahedra for solids of large deformation, and points embedded in them.

---Grids of hexahedra: boxes, and voxels of closed surfaces.
---```lua
---local bar = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}})
---local ball = assert(bw.grid.voxels(bw.surface.sphere {radius = 0.01}, {cells = 16}))
---print(bar.element_count, ball.element_count)
---```
---@class bw.GridModule
local grid_module = {}

---What is chosen by geometry, so that it means the same on a fine grid and on its coarse one. All parts that are given
---must hold; without any it is everywhere. Cells count by their centres, and `inside` by half their volume. In place of
---the table a function of x, y, z or a formula (`where`), or a surface (`inside`), may stand.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}})
---local left, right = grid:nodes {side = "min x"}, grid:nodes {min = {0.08, -1, -1}, side = "max z"}
---print(#left, #right, #grid:nodes "hypot(x, y) < 0.01")
---```
---@class bw.Region
---@field min? bw.Vector (m) the corner with the smallest coordinates of a box along the axes. Default: open below
---@field max? bw.Vector (m) the corner with the largest coordinates. Default: open above
---@field box? bw.Vector[] (m, 2: min, max) both at once
---@field centre? bw.Vector (m) of a ball; with `radius`
---@field radius? number (m) of the ball; with `centre`. Range: at least 0
---@field plane? bw.Vector[] (m, 2: point, normal) on this plane
---@field beyond? bw.Vector[] (m, 2: point, normal) on the side of the plane that the normal points to
---@field side? "min x"|"max x"|"min y"|"max y"|"min z"|"max z" the outermost nodes or cells there
---@field boundary? boolean nodes or cells with a face that has no neighbour
---@field inside? bw.Surface in a closed surface, up to half a cell
---@field where? string|fun(x: number, y: number, z: number): (boolean|number) of coordinates in m: true, or a number but 0; a formula as in `bw.array.map`
---@field within? number (m) what lies outside of box, ball, planes or side by less counts too. Default: a millionth of a cell

---A box of elements. Two of `size` (or `max`), `cells` and `spacing` are needed. A box all of whose cells are void is
---refused, as are more than 2^26 cells.
---
---Errors: memory.
---```lua
---local even = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, spacing = 0.005})
---local layers = assert(bw.grid.box {size = 0.04, cells = 8, material = "1 + (z > 0.02)"})
---local pipe = assert(bw.grid.box {min = -0.02, max = 0.02, cells = 16,
---  material = function(x, y) return x ^ 2 + y ^ 2 > 0.01 ^ 2 end})
---print(even.element_count, layers.material_counts[2], pipe.volume)
---```
---@param options bw.GridBoxOptions place, cells and materials
---@return bw.Grid? grid the box
---@return string? message
---@return bw.Details? details
function grid_module.box(options) end

---Place, cells and materials of a box.
---@class bw.GridBoxOptions
---@field size? bw.Vector|number (m) sides of the box; one number stands for three alike
---@field min? bw.Vector|number (m) the corner with the smallest coordinates. Default: 0
---@field max? bw.Vector|number (m) the corner with the largest coordinates, in place of `size`
---@field cells? integer[]|integer (count, 3: along x, y, z) of cells; one number stands for three alike
---@field spacing? bw.Vector|number (m) sides of a cell, of which `size` must be a whole number
---@field material? integer|string|fun(x: number, y: number, z: number): (number|boolean)|integer[]|bw.Array (index from 1, n × 1, per cell, x fastest; 0: void) number of the material: one for all; a formula as in `bw.array.map` or a function (true is 1), taken at the middle of each cell, coordinates in m; or a list. Default: 1

---The cubes that a closed surface cuts or holds, with the part of each that is inside. A surface of which no cell holds
---enough is refused. `bw.warnings` says where the grid falls into several bodies.
---
---Errors: geometry (the surface is not closed, has no size or encloses nothing), limit (too many cells), memory,
---cancelled.
---```lua
---local ball = bw.surface.sphere {radius = 0.01}
---local grid = assert(bw.grid.voxels(ball, {cells = 16, material = "1 + (x > 0)"}))
---print(grid.volume / ball.volume) -- 1.0: cut cells count by their part
---```
---@param surface bw.Surface a closed one
---@param options? bw.GridVoxelsOptions how fine, and of what
---@return bw.Grid? grid its elements
---@return string? message
---@return bw.Details? details
function grid_module.voxels(surface, options) end

---How fine a surface is filled, and of what.
---@class bw.GridVoxelsOptions
---@field spacing? number (m) side of the cubes. Default: from `cells`
---@field cells? integer (count) along the longest side, rounded up to a multiple of `multiple`; without `spacing`. Default: 32
---@field min_fraction? number (-) cells with a smaller part inside are void. Range: 0 to 1. Default: 0.05
---@field whole? boolean whether other cells count as full, not by their part. Default: false
---@field multiple? integer (count) the number of cells in each direction is a multiple of it, so that so many can become one. Default: 1
---@field material? integer|string|fun(x: number, y: number, z: number): (number|boolean) (index from 1) as of a box, but no list; 0: void. Default: 1

---Grids side by side in one PNG file, with the same camera, scale and colours.
---
---Errors: io (the file cannot be written), memory.
---```lua
---local grid = assert(bw.grid.box {size = {0.04, 0.02, 0.02}, cells = {8, 4, 4}, material = "1 + (x > 0.02)"})
---local coarse = grid:coarse()
---assert(bw.grid.picture("grids.png", {{grid = grid, title = "fine"}, {grid = coarse, title = "coarse"}},
---  {width = 300}))
---```
---@param path string of the PNG file
---@param panels bw.GridPanel[] (one to 64) from left to right, then in rows
---@param options? bw.GridPictureOptions for all panels
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function grid_module.picture(path, panels, options) end

---What one panel shows of a grid: its materials, or values.
---@class bw.GridPanelOptions
---@field title? string a line above
---@field displacement? bw.Array|number[][] (m, n × 3, per node) how the grid is deformed
---@field values? bw.Array|number[] (any, n × 1, per node or per element) what colours it. Default: the materials
---@field embedding? bw.Embedding of a surface in the grid, which is drawn in place of the elements

---A grid and what is shown of it.
---@class bw.GridPanel: bw.GridPanelOptions
---@field grid bw.Grid what is drawn

---How panels of grids are drawn.
---@class bw.GridPictureOptions
---@field width? integer (pixels) of a panel. Default: 640; of `grid:picture` 1000
---@field height? integer (pixels) of a panel. Default: 560; of `grid:picture` 800
---@field columns? integer (count) panels in a row. Default: all, but 4 at most
---@field title? string a line at the top; of `grid:picture` that of the panel
---@field unit? string name and unit of the colour bar: "deflection, mm"
---@field scale? number (-) values are multiplied by it for the colour bar. Default: 1
---@field min? number (any) lower end of the colours, before `scale`. Default: the smallest value of all panels
---@field max? number (any) upper end of the colours, before `scale`. Default: the largest value of all panels
---@field deformation? number (-) factor on displacements. Default: 1
---@field edges? boolean draw the edges of elements. Default: true
---@field ghost? boolean draw the undeformed outline behind. Default: false
---@field direction? bw.Vector (-) from the object to the viewer. Default: from the front right and above
---@field up? bw.Vector (-) the direction that is up in the picture. Default: {0, 0, 1}
---@field zoom? number (-) 1: the largest panel fills its frame. Range: above 0 to 10000. Default: 1
---@field view? bw.Vector[] (m, 2: min, max) the box to be seen, so that pictures of a sequence fit each other. Default: what the panels fill
---@field names? string[] of materials by number, for the legend. Default: their numbers

---How one grid is drawn.
---@class bw.GridOnePictureOptions: bw.GridPictureOptions
---@field displacement? bw.Array|number[][] (m, n × 3, per node) how the grid is deformed
---@field values? bw.Array|number[] (any, n × 1, per node or per element) what colours it. Default: the materials
---@field embedding? bw.Embedding of a surface in the grid, which is drawn in place of the elements

---Equal boxes of which some are elements, with the nodes that they have. A grid is never changed: edits return another,
---which shares what stayed.
---
---Cells and nodes are numbered from 1, x fastest, then y. Corner c of an element (1 to 8) is given by the bits of c - 1:
---x, y, z.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}})
---local hole = assert(grid:set({centre = {0.05, 0.01, 0.01}, radius = 0.006}, 0))
---print(grid, hole.element_count, hole.volume)
---```
---@class bw.Grid
---@field cells integer[] (count, 3: along x, y, z) of the lattice
---@field spacing bw.Vector (m) sides of a cell
---@field origin bw.Vector (m) the corner with the smallest coordinates of the lattice
---@field box bw.Box of the elements
---@field element_count integer (count) of elements
---@field node_count integer (count) of nodes
---@field points bw.Array (m, n × 3, per node) coordinates
---@field elements bw.Array (index from 1, n × 8, per element) its nodes
---@field element_cells bw.Array (index from 1, n × 1, per element) its cell in the lattice
---@field materials bw.Array (index from 1, n × 1, per element) its material
---@field fractions bw.Array (-, n × 1, per element) the part of the cell that is inside the body
---@field material_counts table<integer, integer> elements of each material
---@field volume number (m3) of the elements, fractions counted
local Grid = {}

---The grid with other materials in some cells. Material 0 takes elements away; void cells that get a material become
---full elements. The grid itself where nothing changes; a grid without elements is refused.
---
---Errors: geometry (the surface of a region is not closed), memory, cancelled.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}})
---local two = assert(grid:set("x > 0.05", 2))
---local filled = assert(assert(grid:set({1, 2, 3}, 0)):set({side = "min x"}, 1, {void = true}))
---print(two.material_counts[2], filled.element_count)
---```
---@param cells integer|integer[]|bw.Array|bw.Region|bw.Surface|string|fun(x: number, y: number, z: number): (boolean|number) (index from 1, n × 1) cells by number, void ones too; or a region, of which elements count
---@param material integer|string|fun(x: number, y: number, z: number): (number|boolean)|integer[]|bw.Array (index from 1, n × 1, per cell) as of `bw.grid.box`; a list goes with cells by number
---@param options? bw.GridSetOptions whether void cells count
---@return bw.Grid? grid the edited one
---@return string? message
---@return bw.Details? details
function Grid:set(cells, material, options) end

---Which cells of a region count.
---@class bw.GridSetOptions
---@field void? boolean also cells that are no elements. Default: false

---The nodes in a region. None at all is refused, with a message that names the nearest.
---
---Errors: geometry (the surface of a region is not closed), memory, cancelled.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}})
---local tip = assert(grid:nodes {side = "max x"})
---print(#tip, grid.points(tip(1), 1))
---```
---@param region bw.Region|bw.Surface|string|fun(x: number, y: number, z: number): (boolean|number) which
---@return bw.Array? nodes (index from 1, n × 1) in ascending order
---@return string? message
---@return bw.Details? details
function Grid:nodes(region) end

---The cells of elements in a region; there may be none.
---
---Errors: geometry (the surface of a region is not closed), memory, cancelled.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}})
---local middle = assert(grid:cells_in {min = {0.04, 0, 0}, max = {0.06, 0.02, 0.02}})
---print(#middle, assert(grid:set(middle, 2)).material_counts[2])
---```
---@param region bw.Region|bw.Surface|string|fun(x: number, y: number, z: number): (boolean|number) which
---@param options? bw.GridSetOptions whether void cells count
---@return bw.Array? cells (index from 1, n × 1) in ascending order
---@return string? message
---@return bw.Details? details
function Grid:cells_in(region, options) end

---The grid of which 2 × 2 × 2 cells have become one, which is an element where one of them is. Its materials are all
---1, and its cells full. `solid:coarsen` gives such a grid materials that answer as the fine ones do.
---
---Errors: memory.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}})
---local coarse, parents = grid:coarse(2)
---print(coarse.element_count, parents(1))
---```
---@param levels? integer (count) so many times. Range: 1 to 30. Default: 1
---@return bw.Grid? grid the coarse one
---@return bw.Array|string parents (index from 1, n × 1, per element of the fine grid) its coarse element; or a message
---@return bw.Details? details
function Grid:coarse(levels) end

---The boundary of the elements as a surface, two triangles a face, with the materials as groups.
---
---Errors: limit, memory.
---```lua
---local grid = assert(bw.grid.box {size = {0.1, 0.02, 0.02}, cells = {20, 4, 4}})
---local surface, nodes = grid:surface()
---assert(surface:write "box.stl")
---print(surface.area, nodes(1))
---```
---@return bw.Surface? surface the boundary
---@return bw.Array|string nodes (index from 1, n × 1, per point of the surface) its node; or a message
---@return bw.Details? details
function Grid:surface() end

---Bodies: elements that hang together by nodes.
---
---Errors: memory.
---```lua
---local two = assert(bw.grid.box {size = 0.03, cells = 3, material = "x < 0.01 or x > 0.02"})
---local count, bodies = two:components()
---print(count, bodies(1)) -- 2 1
---```
---@return integer? count (count) of bodies
---@return bw.Array|string bodies (index from 1, n × 1, per element) its body; or a message
---@return bw.Details? details
function Grid:components() end

---Points, or those of a surface, that go with the elements by trilinear interpolation. A point outside of all elements
---goes with the nearest.
---
---Errors: geometry (a point is further outside than `reach`), memory, cancelled.
---```lua
---local ball = bw.surface.sphere {radius = 0.01}
---local grid = assert(bw.grid.voxels(ball, {cells = 8}))
---local embedding = assert(grid:embed(ball))
---print(embedding.point_count == ball.point_count)
---```
---@param what bw.Surface|bw.Array|number[][] (m, n × 3) a surface, or places
---@param options? bw.GridEmbedOptions how far outside points may lie
---@return bw.Embedding? embedding of the points
---@return string? message
---@return bw.Details? details
function Grid:embed(what, options) end

---How far outside of the grid points may lie.
---@class bw.GridEmbedOptions
---@field reach? number (count) of cells in each direction. Range: at least 0. Default: 1

---How far two deformations of the grid differ: the mean distance of nodes moved by u and by v, over the longest side of
---`box`.
---
---Source: docs/theory/data_driven.md; Chen and others 2015, section 6.2.
---```lua
---local grid = assert(bw.grid.box {size = 1, cells = 2})
---local still, stretched = grid.points:map "0 * a", grid.points:map "0.1 * a"
---print(grid:difference(still, stretched)) -- relative
---```
---@param u bw.Array|number[][] (m, n × 3, per node) displacements
---@param v bw.Array|number[][] (m, n × 3, per node) displacements
---@return number difference (-) relative to the longest side
function Grid:difference(u, v) end

---Draws the elements as a PNG file, by material or by values, deformed.
---
---Errors: io (the file cannot be written), memory.
---```lua
---local grid = assert(bw.grid.box {size = {0.04, 0.02, 0.02}, cells = {8, 4, 4}, material = "1 + (x > 0.02)"})
---assert(grid:picture("grid.png", {names = {"rubber", "steel"}, width = 400, height = 300}))
---```
---@param path string of the PNG file
---@param options? bw.GridOnePictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Grid:picture(path, options) end

---Whether elements and nodes are the same as those of another grid; materials may differ.
---```lua
---local grid = assert(bw.grid.box {size = 0.02, cells = 2})
---print(grid:same_elements(assert(grid:set(1, 2))), grid:same_elements(assert(grid:set(1, 0)))) -- true false
---```
---@param other bw.Grid the other
---@return boolean same whether they are
function Grid:same_elements(other) end

---Writes a .vtu file of hexahedra with their materials and fractions, for ParaView.
---
---Errors: io (the file cannot be written), memory.
---```lua
---local grid = assert(bw.grid.box {size = 0.02, cells = 2})
---assert(grid:write("grid.vtu", {fields = {height_m = grid.points:column(3)}}))
---```
---@param path string of a .vtu file
---@param options? bw.GridWriteOptions what is written beside
---@return true? written true
---@return string? message
---@return bw.Details? details
function Grid:write(path, options) end

---What is written beside materials and fractions.
---@class bw.GridWriteOptions
---@field fields? table<string, bw.Array> by name: one row for each node or element

---Releases its memory early, which the garbage collector else does.
---```lua
---local grid = assert(bw.grid.box {size = 0.02, cells = 2})
---grid:close()
---```
function Grid:close() end

---Points that go with a grid's elements by trilinear interpolation.
---```lua
---local ball = bw.surface.sphere {radius = 0.01}
---local grid = assert(bw.grid.voxels(ball, {cells = 8}))
---local embedding = assert(grid:embed(ball))
---local stretched = assert(embedding:moved(grid.points:map "0.1 * a"))
---print(stretched.box.size[1])
---```
---@class bw.Embedding
---@field grid bw.Grid that the points go with
---@field elements bw.Array (index from 1, n × 1, per point) the element that it goes with
---@field point_count integer (count) of points
local Embedding = {}

---Values of nodes at the points.
---```lua
---local grid = assert(bw.grid.box {size = 1, cells = 2})
---local embedding = assert(grid:embed {{0.2, 0.5, 0.7}})
---print(embedding:values(grid.points)) -- the place itself
---```
---@param values bw.Array|number[]|number[][] (any, n × k, per node) of any number of columns
---@return bw.Array values (any, n × k, per point) interpolated
function Embedding:values(values) end

---Forces at the points as forces at nodes with the same total, moment and work.
---```lua
---local grid = assert(bw.grid.box {size = 1, cells = 2})
---local embedding = assert(grid:embed {{0.2, 0.5, 0.7}})
---local nodal = embedding:forces {{0, 0, -10}}
---print(nodal:column(3):sum()) -- -10.0
---```
---@param forces bw.Array|number[]|number[][] (N, n × 3, per point) forces; any number of columns
---@return bw.Array forces (N, n × 3, per node) the same
function Embedding:forces(forces) end

---The surface, moved with the nodes. An embedding of places has none and is refused.
---
---Errors: memory.
---```lua
---local ball = bw.surface.sphere {radius = 0.01}
---local grid = assert(bw.grid.voxels(ball, {cells = 8}))
---local lifted = assert(assert(grid:embed(ball)):moved(grid.points:map "0 * a + 0.001"))
---print(lifted.box.min[3]) -- 1 mm above
---```
---@param displacements bw.Array|number[][] (m, n × 3, per node) of the nodes
---@return bw.Surface? surface a moved copy
---@return string? message
---@return bw.Details? details
function Embedding:moved(displacements) end

---Releases its memory early, which the garbage collector else does.
---```lua
---local embedding = assert(assert(bw.grid.box {size = 1, cells = 2}):embed {{0.2, 0.5, 0.7}})
---embedding:close()
---```
function Embedding:close() end
