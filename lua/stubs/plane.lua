---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Plane meshes
--
-- Triangle meshes of outlines, and mesh motion: meshes that follow an outline while it is dragged.

---Making triangle meshes of outlines, and mesh motion.
---@class bw.PlaneModule
local plane_module = {}

---Fills an outline with triangles. Every vertex of the outline is a node. With order 2 sides follow the curves.
---
---Errors: geometry (parts of the outline are too close to each other for elements between them), limit (`limit` of the
---details is "elements", "time" or "memory").
---```lua
---local outline = assert(bw.outline.rectangle {width = 0.1, height = 0.03})
---local mesh = assert(bw.plane.fill(outline, {size = 0.005, order = 2}))
---print(mesh)
---```
---@param outline bw.Outline what is filled
---@param options? bw.PlaneFillOptions how finely
---@return bw.PlaneMesh? mesh the mesh
---@return string? message
---@return bw.Details? details
function plane_module.fill(outline, options) end

---How finely an outline is filled. `elements` beside `size` or `field` raises.
---@class bw.PlaneFillOptions
---@field order? integer (-) order of the elements: 1 (3 nodes) or 2 (6 nodes). Default: 1
---@field size? number (m) the wanted edge length, above 0. Default: from `elements`
---@field elements? integer (count) the wanted number of triangles, met within 10 %. Default: 2000
---@field field? string|number|fun(x: number, y: number, z: number): number (m) the wanted edge length by place: a formula in x and y, a number, or a function (z is 0); the smaller of it and `size` counts. Default: none
---@field minimum_angle? number (degrees) the smallest angle that refinement aims at. Range: 0 to 30. Default: 25
---@field curvature? number (degrees) the largest turn of a boundary edge. Range: above 0, to 90. Default: 20
---@field limit? integer (count) the largest number of elements. Range: 1 and more. Default: 5000000
---@field time_limit? number (s) the longest time of computing, above 0. Default: 300
---@field memory_limit? number (bytes) the largest memory, above 0. Default: 6e9

---A mesh from arrays. Its boundary becomes an outline with one edge for each side, unless `outline` is given.
---
---Errors: geometry (an element is inverted or names a node that is not there, a node belongs to no element, sides do
---not fit together, or nodes do not lie on the outline).
---```lua
---local points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}
---local mesh = assert(bw.plane.new {points = points, elements = {{1, 2, 3}, {1, 3, 4}}})
---print(mesh.quality.area) -- 1
---```
---@param options bw.PlaneNewOptions the arrays
---@return bw.PlaneMesh? mesh the mesh
---@return string? message
---@return bw.Details? details
function plane_module.new(options) end

---Nodes and elements of a plane mesh.
---@class bw.PlaneNewOptions
---@field points number[][]|bw.Array (m, n × 2, per node) coordinates: corners first, then mid-edge nodes
---@field elements integer[][]|bw.Array (index from 1, e × 3 or e × 6, per element) corners counter-clockwise; with order 2 the mid-edge nodes of edges 1-2, 2-3 and 3-1 behind them
---@field regions? integer[]|bw.Array (index from 1, e × 1, per element) regions. Default: 1
---@field order? integer (-) order of the elements: 1 or 2. Default: 1
---@field outline? bw.Outline the outline that nodes lie on; its vertices must be nodes. Default: made from the boundary
---@field edges? integer[]|bw.Array (index from 1, n × 1, per node) beside `outline`: the edge that each node lies on; 0 inside
---@field parameters? number[]|bw.Array (-, n × 1, per node) beside `outline`: the place on that edge, from 0 to below 1

---A rectangle of cells, each cut into two triangles. Its outline has the tags bottom, right, top and left.
---
---Errors: only those that every function may give.
---```lua
---local mesh = assert(bw.plane.rectangle {max = {0.2, 0.1}, cells = {20, 10}})
---print(mesh.element_count) -- 400
---```
---@param options bw.PlaneRectangleOptions size and cells
---@return bw.PlaneMesh? mesh the mesh
---@return string? message
---@return bw.Details? details
function plane_module.rectangle(options) end

---A rectangle of cells.
---@class bw.PlaneRectangleOptions
---@field min? number[] (m, {x, y}) the lower left corner. Default: {0, 0}
---@field max? number[] (m, {x, y}) the upper right corner. Default: {1, 1}
---@field cells? integer[] (count, {nx, ny}) cells along x and y. Range: 1 to 1000000. Default: {1, 1}
---@field order? integer (-) order of the elements: 1 or 2. Default: 1
---@field diagonal? "right"|"left"|"union jack" how cells are cut: "right" from the lower left to the upper right, "left" the other way, "union jack" alternating. Default: "right"

---A mesh motion: a mesh that follows its outline, by relocation of nodes, by edge flips, or by a new mesh.
---
---Errors: only those that every function may give.
---```lua
---local outline = assert(bw.outline.rectangle {width = 0.1, height = 0.03})
---local motion = assert(bw.plane.mesh_motion(assert(bw.plane.fill(outline))))
---local report = assert(motion:follow(outline:moved({vertex = 3}, {0.005, 0.005})))
---print(report.level, report.worst)
---```
---@param mesh bw.PlaneMesh the mesh to begin with
---@param options? bw.MeshMotionOptions when nodes are relocated, edges flipped, or meshes made
---@return bw.MeshMotion? motion the mesh motion
---@return string? message
---@return bw.Details? details
function plane_module.mesh_motion(mesh, options) end

---How a mesh follows its outline.
---@class bw.MeshMotionOptions
---@field relocation? "harmonic"|"springs" how inner nodes move: by the harmonic extension of the boundary's displacement, or towards the mean of their neighbours. Default: "harmonic"
---@field rounds? integer (count) rounds of "springs". Range: 0 to 10000. Default: 2
---@field distorted? number (-) element quality below which edges are flipped. Range: 0 to below 1. Default: 0.35
---@field rebuild? number (-) element quality below which, after flips, the outline is filled again. Range: 0 to `distorted`. Default: 0.1
---@field force? "none"|"relocation"|"reconnecting"|"reconstruction" the level that is taken at least, each time. Default: "none"
---@field fill? bw.PlaneFillOptions options of new meshes; their order is the mesh's. Default: as many elements as the mesh has

---A triangle mesh of an outline. Meshes do not change: methods give new ones.
---```lua
---local outline = assert(bw.outline.circle {radius = 0.01})
---local mesh = assert(bw.plane.fill(outline, {elements = 500}))
---print(mesh.node_count, mesh.quality.smallest_angle)
---```
---@class bw.PlaneMesh
---@field points bw.Array (m, node_count × 2, per node) x and y: corners first, then mid-edge nodes
---@field elements bw.Array (index from 1, element_count × 3 or 6, per element) corners counter-clockwise, then the mid-edge nodes of edges 1-2, 2-3 and 3-1
---@field regions bw.Array (index from 1, element_count × 1, per element) the region of the outline
---@field neighbours bw.Array (index from 1, element_count × 3, per element) the elements across edges 1-2, 2-3 and 3-1; 0 at the boundary
---@field sides bw.Array (index from 1, s × 2 or 3, per side) nodes of the element edges on the outline, along its edges: start, end, mid-edge node
---@field side_elements bw.Array (index from 1, s × 2, per side) the elements to the left and to the right; 0 where there is none
---@field side_edges bw.Array (index from 1, s × 1, per side) the outline's edge
---@field node_edges bw.Array (index from 1, node_count × 1, per node) the outline's edge that the node lies on; 0 inside
---@field node_parameters bw.Array (-, node_count × 1, per node) the place on that edge, from 0 to below 1
---@field order integer (-) order of the elements: 1 or 2
---@field node_count integer (count) of nodes
---@field corner_count integer (count) of nodes at corners of elements
---@field element_count integer (count) of elements
---@field outline bw.Outline the outline that it fills
---@field quality bw.PlaneQuality the quality of its elements
---@field element_quality bw.Array (-, element_count × 1, per element) 1 equilateral, 0 flat, below 0 inverted
local PlaneMesh = {}

---The quality of a plane mesh. The quality of an element is 2 √3 times the inradius over the longest edge. With order 2
---it is also multiplied by the smallest Jacobian determinant over the mean one.
---@class bw.PlaneQuality
---@field worst number (-) the lowest quality of an element
---@field worst_element integer (index from 1) the element that has it
---@field mean number (-) the mean quality
---@field smallest_angle number (degrees) of all elements
---@field largest_angle number (degrees) of all elements
---@field area number (m2) of all elements
---@field inverted integer (count) inverted elements

---The same mesh with other coordinates. An outline of another topology raises.
---
---Errors: geometry (an element is inverted, or a node on the outline does not lie on the one given).
---@param outline bw.Outline an outline of the same topology
---@param points number[][]|bw.Array (m, node_count × 2, per node) x and y
---@return bw.PlaneMesh? mesh of the same topology
---@return string? message
---@return bw.Details? details
function PlaneMesh:moved(outline, points) end

---Transfers values at nodes to another mesh: copied where the nodes are the same, interpolated otherwise. Nodes outside
---of the mesh take the value of its nearest place.
---
---Errors: only those that every function may give.
---@param to bw.PlaneMesh the other mesh
---@param values bw.Array (any, node_count × k, per node) values
---@return bw.Array? transferred (any, node_count × k, per node of `to`) values
---@return string? message
---@return bw.Details? details
function PlaneMesh:transfer(to, values) end

---Finds the element at a place, or the nearest one.
---@param at number[] (m, {x, y}) the place
---@return integer element (index from 1) the element
---@return number[] barycentric (-, 3, per corner) barycentric coordinates, of the nearest point of the element
---@return number outside (m) the distance from the mesh; 0 inside
function PlaneMesh:locate(at) end

---What two meshes have in common. With "topology" the sparsity pattern of matrices holds. With "nodes" preconditioners
---and solutions can be reused. It is nil where they have nothing in common.
---@param other bw.PlaneMesh another mesh
---@return "topology"|"nodes"|nil common the highest level
function PlaneMesh:shares(other) end

---Writes a .vtu file.
---
---Errors: io (the file cannot be written).
---@param path string the file, which ends in .vtu
---@param options? bw.GridWriteOptions fields at nodes or elements
---@return true? written true
---@return string? message
---@return bw.Details? details
function PlaneMesh:write(path, options) end

---Frees its memory at once.
function PlaneMesh:close() end

---A mesh that follows its outline. It holds the current mesh, and what relocation computes once for a topology.
---```lua
---local mesh = assert(bw.plane.rectangle {cells = {8, 8}})
---local motion = assert(bw.plane.mesh_motion(mesh))
---assert(motion:follow(mesh.outline:moved({vertex = 3}, {0.1, 0.1})))
---print(motion.mesh:shares(mesh)) -- topology
---```
---@class bw.MeshMotion
---@field mesh bw.PlaneMesh the current mesh
---@field outline bw.Outline the current outline
local MeshMotion = {}

---Takes the mesh to an outline. One of the same topology is followed by relocation of nodes, edge flips or a new mesh,
---whichever suffices first. One of another topology gets a new mesh. After a failure the mesh motion is as it was.
---
---Errors: as of `bw.plane.fill`; singular (the equations of relocation have no unique solution).
---
---Source: Umetani, Takayama, Mitani, Igarashi, A Responsive Finite Element Method to Aid Interactive Geometric Modeling,
---section 3.3.
---@param outline bw.Outline the outline
---@return bw.FollowReport? report what was done
---@return string? message
---@return bw.Details? details
function MeshMotion:follow(outline) end

---How a mesh followed an outline.
---@class bw.FollowReport
---@field level "none"|"relocation"|"reconnecting"|"reconstruction" the most that was necessary: nothing, nodes relocated, edges flipped, or a new mesh
---@field flips integer (count) edges that were flipped
---@field worst number (-) the lowest element quality afterwards
---@field worst_element integer (index from 1) the element that has it
---@field restored boolean whether relocation inverted an element and was undone before the flips
---@field seconds number (s) the time that it took

---The adjoint of harmonic relocation: the derivative of a function by the outline's points, from its derivative by the
---nodes.
---
---Errors: singular (the equations of relocation have no unique solution).
---@param gradient number[][]|bw.Array (any, node_count × 2, per node) derivative by x and y of each node
---@return bw.Array? gradient (any, point_count × 2, per point of the outline) derivative by x and y of each point
---@return string? message
---@return bw.Details? details
function MeshMotion:pull_back(gradient) end

---Checks that all parts of it belong together, for tests and debugging. It raises where they do not.
---@return bw.MeshMotion self
function MeshMotion:check() end

---Frees its memory at once.
function MeshMotion:close() end
