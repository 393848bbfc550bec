---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Plane meshes
--
-- Triangle meshes of outlines, and movers that follow an outline.

---Triangle meshes of outlines, and movers that let them follow an outline that is dragged.
---@class bw.PlaneModule
local plane_module = {}

---Fills an outline with triangles. `size` is the wanted edge length in m; without it (or a `field`)
---about `elements` triangles are made (2000). `field` gives the edge length by place: a function of
---x, y, or a formula in them. `minimum_angle` of elements in degrees (25), `curvature`: largest turn of
---a boundary edge in degrees (20). `limit` of elements (5 million), `time_limit` in seconds of computing
---(300), `memory_limit` in bytes (6e9): beyond them nil, a message and details with `limit` "elements",
---"time" or "memory". Every vertex of the outline is a node; with order 2 sides follow the curves.
---@param outline bw.Outline
---@param options? bw.PlaneFillOptions
---@return bw.PlaneMesh?
---@return string? message
---@return bw.Details? details
function plane_module.fill(outline, options) end

---@class bw.PlaneFillOptions
---@field order? integer
---@field size? number
---@field elements? integer
---@field field? function|string|number
---@field minimum_angle? number
---@field curvature? number
---@field limit? integer
---@field time_limit? number
---@field memory_limit? number

---A mesh from arrays: corners first, middles of edges 01, 12, 20 behind them (order 2); elements
---counter-clockwise. Its boundary becomes an outline with one edge per side, unless `outline` is given
---with the `edges` (of every node, 0: inside) and `parameters` (0 up to below 1) of its nodes.
---@param options bw.PlaneNewOptions
---@return bw.PlaneMesh?
---@return string? message
---@return bw.Details? details
function plane_module.new(options) end

---@class bw.PlaneNewOptions
---@field points table|bw.Array
---@field elements table|bw.Array
---@field regions? table|bw.Array
---@field order? integer
---@field outline? bw.Outline
---@field edges? table|bw.Array
---@field parameters? table|bw.Array

---Squares cut in two; its outline has the tags bottom, right, top, left. `diagonal`: "right" (from
---lower left to upper right), "left", "union jack".
---@param options bw.PlaneRectangleOptions
---@return bw.PlaneMesh?
---@return string? message
---@return bw.Details? details
function plane_module.rectangle(options) end

---@class bw.PlaneRectangleOptions
---@field low? number[]
---@field high? number[]
---@field cells? integer[]
---@field order? integer
---@field diagonal? string

---A mover: a mesh that follows its outline. Elements below the quality `distorted` (0.35) call for
---reconnecting, below `rebuild` (0.1) after it for a new mesh. `relocation`: "harmonic" or "springs"
---(with `sweeps` rounds, 2). `force`: at least this level each time. `fill`: options of new meshes; by
---default as many elements as the mesh has.
---@param mesh bw.PlaneMesh
---@param options? bw.PlaneMoverOptions
---@return bw.MeshMotion?
---@return string? message
---@return bw.Details? details
function plane_module.mesh_motion(mesh, options) end

---@class bw.PlaneMoverOptions
---@field relocation? string
---@field sweeps? integer
---@field distorted? number
---@field rebuild? number
---@field force? string
---@field fill? table

---A triangle mesh of an outline; never changed.
---@class bw.PlaneMesh
---@field points bw.Array x, y of nodes, m: corners first
---@field elements bw.Array 3 or 6 nodes, corners counter-clockwise, then middles of edges 01, 12, 20
---@field regions bw.Array of elements
---@field neighbours bw.Array of elements: across edges 01, 12, 20 (0: none)
---@field sides bw.Array edges on the outline, along its edges: start, end (and middle)
---@field side_elements bw.Array of sides: left, right (0: none)
---@field side_edges bw.Array of sides: the outline's edge
---@field node_edges bw.Array of nodes: the outline's edge that they lie on (0: inside)
---@field node_parameters bw.Array of nodes: where on that edge
---@field order integer 1 or 2
---@field node_count integer
---@field corner_count integer
---@field element_count integer
---@field outline bw.Outline
---@field quality table {worst, worst_element, mean, smallest_angle, largest_angle, area, inverted}
---@field element_quality bw.Array of elements: 1 equilateral, 0 flat, below 0 inverted
local PlaneMesh = {}

---The same mesh elsewhere: nodes on the outline must lie on the one given.
---@param outline bw.Outline of the same topology
---@param points table|bw.Array x, y of every node
---@return bw.PlaneMesh?
---@return string? message
---@return bw.Details? details
function PlaneMesh:moved(outline, points) end

---Values at nodes carried to the nodes of another mesh: copied where the nodes are the same,
---interpolated otherwise.
---@param to bw.PlaneMesh
---@param values bw.Array a row for every node
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function PlaneMesh:carry(to, values) end

---The element at a place, or the nearest.
---@param at number[] x, y
---@return integer element
---@return number[] barycentric
---@return number outside distance from the mesh, 0 inside
function PlaneMesh:locate(at) end

---What two meshes have in common: "topology" (the pattern of matrices holds), "nodes" (preconditioners
---and solutions hold), or nil.
---@param other bw.PlaneMesh
---@return string?
function PlaneMesh:shares(other) end

---Writes a .vtu file.
---@param path string
---@param options? bw.GridWriteOptions name = array, of nodes or elements
---@return boolean?
---@return string? message
---@return bw.Details? details
function PlaneMesh:write(path, options) end

---Lets go at once.
function PlaneMesh:close() end

---@class bw.MeshMotion
---@field mesh bw.PlaneMesh the current one
---@field outline bw.Outline the current one
local MeshMotion = {}

---Takes the mesh to an outline. Of the same topology: relocation of nodes, reconnecting by flips, or
---reconstruction, whatever is enough; of another: reconstruction. The report has `level` ("none",
---"relocation", "reconnecting", "reconstruction"), `flips`, `worst` quality and `worst_element`,
---`restored` and `seconds`. On failure the mover is as it was.
---@param outline bw.Outline
---@return table? report
---@return string? message
---@return bw.Details? details
function MeshMotion:follow(outline) end

---The adjoint of relocation: how J grows with the outline's points, from how it grows with the nodes.
---@param gradient table|bw.Array x, y for every node
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function MeshMotion:pull_back(gradient) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return bw.MeshMotion
function MeshMotion:check() end

---Lets go at once.
function MeshMotion:close() end
