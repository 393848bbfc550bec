---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Selections
--
-- Parts of the boundary of a mesh, chosen by geometry. Supports and loads act on them. The theory is in
-- docs/theory/faces.md.

---A part of a mesh's boundary: facets and nodes. A geometric method chooses within the selection that it is called on. It
---holds the nodes that satisfy the condition and the facets all of whose corners do. An empty choice raises an error that
---names the nearest node. `a | b`, `a & b` and `a - b` are union, intersection and difference.
---```lua
---local mesh = assert(bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}})
---local left, top = mesh.boundary:below("x", 0), mesh.boundary:facing {0, 0, 1}
---print(left.area, (left | top).area) -- 0.0001 0.0011
---```
---@class bw.Selection
---@field nodes bw.Array (index from 1, node_count × 1) numbers of the mesh's nodes, ascending
---@field facets bw.Array (index from 1, facet_count × 1) numbers of the mesh's facets, ascending
---@field node_count integer (count) of nodes
---@field facet_count integer (count) of facets
---@field area number (m2) of the facets
---@field centre bw.Vector (m) the centre of the area; of the nodes where there is no facet
---@field normal bw.Vector (-) the mean outward normal, unit
---@field mesh bw.Mesh whose boundary it is a part of
---@operator bor(bw.Selection): bw.Selection
---@operator band(bw.Selection): bw.Selection
---@operator sub(bw.Selection): bw.Selection
local Selection = {}

---Where the coordinate is at most a value.
---@param axis 1|2|3|"x"|"y"|"z" the axis
---@param coordinate number (m) the value
---@return bw.Selection selection the part
function Selection:below(axis, coordinate) end

---Where the coordinate is at least a value.
---@param axis 1|2|3|"x"|"y"|"z" the axis
---@param coordinate number (m) the value
---@return bw.Selection selection the part
function Selection:above(axis, coordinate) end

---Inside of a box along the axes.
---@param min bw.Vector (m) the smallest coordinates
---@param max bw.Vector (m) the largest coordinates
---@return bw.Selection selection the part
function Selection:box(min, max) end

---Near a plane, on both sides.
---@param point bw.Vector (m) a point of the plane
---@param normal bw.Vector (-) its normal, of any length but 0
---@param tolerance? number (m) the largest distance. Default: 1e-6 of the diagonal of the mesh's box
---@return bw.Selection selection the part
function Selection:plane(point, normal, tolerance) end

---On the side of a plane that the normal points to.
---@param point bw.Vector (m) a point of the plane
---@param normal bw.Vector (-) its normal, of any length but 0
---@return bw.Selection selection the part
function Selection:beyond(point, normal) end

---Within a radius of a point.
---@param point bw.Vector (m) the point
---@param radius number (m) above 0
---@return bw.Selection selection the part
function Selection:near(point, radius) end

---The same as `near`.
---@param centre bw.Vector (m) the point
---@param radius number (m) above 0
---@return bw.Selection selection the part
function Selection:sphere(centre, radius) end

---Facets whose outward normal has nearly a direction.
---@param direction bw.Vector (-) the direction, of any length but 0
---@param angle? number (rad) the largest angle between the two. Range: 0 to pi. Default: 0.001
---@return bw.Selection selection the part
function Selection:facing(direction, angle) end

---The facets that are connected with the one nearest to a point without an edge sharper than an angle.
---@param point bw.Vector (m) the point
---@param angle? number (rad) the largest angle between normals of neighbours. Range: 0 to pi. Default: 30 degrees
---@return bw.Selection selection the part
function Selection:patch(point, angle) end

---The nodes nearest to a point, as a node set (see `node_set`).
---@param point bw.Vector (m) the point
---@param count? integer (count) how many nodes. Default: 1
---@return bw.Selection selection the nodes
function Selection:nearest(point, count) end

---By a formula in x, y and z, by a function of them that is called for every boundary node, or by a mask. A mask over nodes
---makes a node set.
---@param predicate string|bw.Array|fun(x: number, y: number, z: number): boolean (-, n × 1, per node or per facet) a formula as in `bw.array.map`, coordinates in m; a mask; or a function
---@return bw.Selection selection the part
function Selection:where(predicate) end

---The facets of a region's elements. A region that is not there or not on the boundary raises.
---@param name string of the region
---@return bw.Selection selection the part
function Selection:region(name) end

---A face of the mesh's boundary: one that its surface named (`mesh:face_names()`), or as `mesh:surface():faces()` finds
---them. A face that is not there raises.
---@param which integer|string|bw.FaceNear (index from 1) its number by descending area, its name such as "bolt hole" or "plane 2", or a point that it is nearest to
---@return bw.Selection selection the part
function Selection:face(which) end

---A face by a point near it.
---@class bw.FaceNear
---@field near bw.Vector (m) the point

---The same nodes as a node set. A support accepts a selection without a facet only as a node set: it holds points or an edge.
---@return bw.Selection selection the node set
function Selection:node_set() end

---What is in this selection, in another one of the same mesh, or in both.
---@param other bw.Selection the other one
---@return bw.Selection selection the union
function Selection:union(other) end

---What is in both selections.
---@param other bw.Selection the other one, of the same mesh
---@return bw.Selection selection the intersection
function Selection:intersection(other) end

---What is in this selection and not in the other one. Nodes of the facets that stay are kept.
---@param other bw.Selection the other one, of the same mesh
---@return bw.Selection selection the difference
function Selection:difference(other) end

---Releases the selection at once.
function Selection:close() end
