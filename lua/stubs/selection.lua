---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Selections
--
-- Parts of the boundary of a mesh, chosen by geometry. Supports and loads act on them.

---A part of a mesh's boundary: facets and nodes. Methods choose within it; an empty choice raises an
---error. `a | b`, `a & b`, `a - b` join, intersect and take away.
---@class bw.Selection
---@field nodes bw.Array numbers of mesh nodes
---@field facets bw.Array numbers of boundary facets
---@field node_count integer
---@field facet_count integer
---@field area number m2
---@field centre bw.Vector
---@field normal bw.Vector mean outward normal
---@field mesh bw.Mesh
---@operator bor(bw.Selection): bw.Selection
---@operator band(bw.Selection): bw.Selection
---@operator sub(bw.Selection): bw.Selection
local Selection = {}

---Coordinates up to a value along an axis.
---@param axis 1|2|3|"x"|"y"|"z"
---@param coordinate number
---@return bw.Selection
function Selection:below(axis, coordinate) end

---Coordinates from a value on.
---@param axis 1|2|3|"x"|"y"|"z"
---@param coordinate number
---@return bw.Selection
function Selection:above(axis, coordinate) end

---@param low bw.Vector
---@param high bw.Vector
---@return bw.Selection
function Selection:box(low, high) end

---Within a tolerance (default a millionth of the box) of a plane.
---@param point bw.Vector
---@param normal bw.Vector
---@param tolerance? number
---@return bw.Selection
function Selection:plane(point, normal, tolerance) end

---On the side of a plane that the normal points to.
---@param point bw.Vector
---@param normal bw.Vector
---@return bw.Selection
function Selection:beyond(point, normal) end

---Within a radius of a point.
---@param point bw.Vector
---@param radius number
---@return bw.Selection
function Selection:near(point, radius) end

---The same as `near`.
---@param centre bw.Vector
---@param radius number
---@return bw.Selection
function Selection:sphere(centre, radius) end

---Facets whose outward normal is within an angle (default 0.001) of a direction.
---@param direction bw.Vector
---@param angle? number radians
---@return bw.Selection
function Selection:facing(direction, angle) end

---What hangs together around a point without an edge sharper than an angle (default 30 degrees).
---@param point bw.Vector
---@param angle? number radians
---@return bw.Selection
function Selection:patch(point, angle) end

---The nodes nearest to a point: a node set.
---@param point bw.Vector
---@param count? integer default 1
---@return bw.Selection
function Selection:nearest(point, count) end

---By a formula in x, y, z, a mask over nodes or facets, or a function of x, y, z. A mask over nodes makes a
---node set.
---@param predicate string|bw.Array|fun(x: number, y: number, z: number): boolean
---@return bw.Selection
function Selection:where(predicate) end

---A face of the mesh's boundary (Surface:faces of `mesh:surface()`), within the selection: by number, by name
---or the nearest to a point. An unknown face raises an error.
---`part:fix(mesh.boundary:face {near = {0, 0, 0}})`
---@param which integer|string|bw.FaceNear
---@return bw.Selection
function Selection:face(which) end

---@class bw.FaceNear
---@field near bw.Vector

---The same facets and nodes as a node set. A support takes a node set that covers no facet, to hold points or
---an edge; it refuses any other selection without a facet.
---`part:fix((boundary:below("x", 0) & boundary:below("y", 0)):node_set())`
---@return bw.Selection
function Selection:node_set() end

---@param other bw.Selection
---@return bw.Selection
function Selection:union(other) end

---@param other bw.Selection
---@return bw.Selection
function Selection:intersection(other) end

---@param other bw.Selection
---@return bw.Selection
function Selection:difference(other) end

---Lets go at once.
function Selection:close() end
