---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Meshes
--
-- Meshes of tetrahedra: filling a surface, reading and writing, quality, refinement.

---@class bw.MeshModule
local mesh_module = {}

---Fills a surface with tetrahedra by TetGen, in a child process with limits; repairs, remeshes or
---wraps where that is needed, and says so in the log.
---@param surface bw.Surface
---@param options? bw.MeshFillOptions
---@return bw.Mesh? mesh
---@return table|string log repaired, surface_moved, edge_length, attempts, steps, seconds_repair, seconds_remesh, seconds_fill; or a message
---@return bw.Details? details
function mesh_module.fill(surface, options) end

---@class bw.MeshFillOptions
---@field elements? integer wanted number of elements
---@field order? 1|2 tet4 or tet10; default 1
---@field edge_length? number of the surface, m; in place of `elements`: see the log of a former filling
---@field surface_tolerance? number m that remeshing may leave the surface by; edges are shorter where it is curved or has small features; default a quarter of the edge length
---@field max_volume? number of an element, m3
---@field radius_edge? number quality bound; default 1.4
---@field dihedral? number smallest dihedral angle asked for
---@field keep_surface? boolean no points added on the surface
---@field remesh? boolean remesh first; default true
---@field repair? boolean repair what is not sound; default true
---@field sharp_angle? number for remeshing; default 40 degrees
---@field near? bw.MeshFillPlace[] edge lengths near points; the surface is remeshed to them too
---@field size? string|fun(x: number, y: number, z: number): number edge length wanted, 0: no wish
---@field time_limit? number seconds of one attempt
---@field memory_limit? number bytes of one attempt
---@field tolerance? number on the wanted number of elements

---@class bw.MeshFillPlace
---@field at bw.Vector
---@field radius number
---@field length number

---Reads .vtu .msh .mesh .node/.ele .inp; metres unless told otherwise.
---@param path string
---@param options? bw.UnitOptions
---@return bw.Mesh? mesh
---@return table|string file fields, sets, format, skipped; or a message
---@return bw.Details? details
function mesh_module.read(path, options) end

---From nodes (metres) and elements (numbers of 4 or 10 nodes).
---@param options bw.MeshNewOptions
---@return bw.Mesh?
function mesh_module.new(options) end

---@class bw.MeshNewOptions
---@field nodes table|bw.Array
---@field elements table|bw.Array
---@field order? 1|2
---@field regions? table|bw.Array

---A box of cells, each cut into six tetrahedra.
---@param options bw.MeshBoxOptions
---@return bw.Mesh?
function mesh_module.box(options) end

---@class bw.MeshBoxOptions
---@field low bw.Vector
---@field high bw.Vector
---@field cells bw.Vector
---@field order? 1|2

---A mesh of tetrahedra. It does not change: methods give new ones.
---@class bw.Mesh
---@field nodes bw.Array node_count x 3, m
---@field elements bw.Array element_count x 4 or 10 (corners, then the middles of 12 23 31 14 24 34)
---@field regions bw.Array? a tag for every element
---@field volumes bw.Array of every element, m3
---@field node_volumes bw.Array every node's share of the volume: weights for values at nodes
---@field facets bw.Array of the boundary: corners, then middles
---@field facet_elements bw.Array the element behind every facet
---@field neighbours bw.Array element_count x 4: across each face, 0 for none
---@field components bw.Array the body of every node
---@field order integer
---@field node_count integer
---@field element_count integer
---@field facet_count integer
---@field component_count integer
---@field volume number
---@field surface_moved number m, the most by which bw.mesh.fill moved the surface; 0 of other meshes
---@field box bw.Box
---@field boundary bw.Selection the whole boundary, to choose from
local Mesh = {}

---Writes .vtu .msh .mesh .node/.ele .inp; fields {name = array} or {name = {array, on = "elements"}}
---into .vtu and .msh.
---@param path string
---@param options? bw.MeshWriteOptions
---@return true?
---@return string? message
---@return bw.Details? details
function Mesh:write(path, options) end

---@class bw.MeshWriteOptions
---@field fields? table<string, bw.Array|table>
---@field unit? string|number
---@field version? "2.2"|"4.1"

---tet4 to tet10 with straight edges, or back.
---@param order 1|2
---@return bw.Mesh?
function Mesh:with_order(order) end

---The same elements with other node positions.
---@param nodes bw.Array|table
---@return bw.Mesh?
---@return string? message
---@return bw.Details? details
function Mesh:moved(nodes) end

---All lengths times a factor.
---@param factor number
---@return bw.Mesh?
function Mesh:scale(factor) end

---The elements whose mask is not 0.
---@param mask bw.Array
---@return bw.Mesh?
function Mesh:subset(mask) end

---The same mesh with nodes and elements numbered along a curve that fills space (Hilbert's): an
---optimisation of an edit session takes a tenth to a fifth less processor time than with numbers of a
---mesh generator. Meshes made by bw.mesh.fill are numbered so already.
---@return bw.Mesh?
---@return bw.Array|string nodes of every node the number that it had, or the message
---@return bw.Array|table elements of every element the number that it had, or details
function Mesh:renumbered() end

---Curved elements: the nodes of the boundary's edges on the planes, cylinders, cones and spheres of the surface
---that a mesh of order 2 was filled from. Nodes stay where an element would become too distorted.
---`local mesh, moved = assert(bw.mesh.fill(surface, {order = 2})):curved(surface)`
---@param surface bw.Surface
---@return bw.Mesh? mesh
---@return integer|string count how many nodes moved, or a message
---@return bw.Details? details
function Mesh:curved(surface) end

---The boundary as a surface, and the node of every point.
---@return bw.Surface?
---@return bw.Array nodes
function Mesh:surface() end

---The faces of the surface that the mesh was filled from (Surface:faces), with `area` and `triangle_count` of the
---mesh's boundary: what filling has left of each. A face without a facet there has area 0.
---`for i, face in ipairs(mesh:faces(surface)) do print(face.name, face.area / surface:faces()[i].area) end`
---@param surface bw.Surface
---@return bw.Face[]? faces
---@return string? message
---@return bw.Details? details
function Mesh:faces(surface) end

---The element that holds a point (or the nearest one), its barycentric weights, whether it is inside.
---@param point bw.Vector
---@return integer element
---@return number[] weights
---@return boolean inside
function Mesh:locate(point) end

---A nodal field at points, by the shape functions of the elements that hold them; of a point outside the value at the
---nearest place of the mesh. `outside`: how far each point lies outside, 0 inside.
---`local stress = part.mesh:sample(static.stress, {{0.01, 0, 0}, {0.02, 0, 0}})`
---@param values bw.Array a row for every node
---@param points bw.Array|number[][]
---@return bw.Array? values a row for every point
---@return bw.Array|string outside m, or a message
---@return bw.Details? details
function Mesh:sample(values, points) end

---dihedral_low, dihedral_high, radius_edge_high, aspect_high, volume_low, volume_high, worst.
---@return table
function Mesh:quality() end

---Values of elements at nodes: the mean by volume, or the largest of the elements around.
---@param values bw.Array
---@param how? "mean"|"max"
---@return bw.Array
function Mesh:to_nodes(values, how) end

---The shape quality of every element (mean ratio: 1 for a regular one, 0 or less: inverted), at the
---mesh's own nodes or at others.
---@param nodes? bw.Array
---@return bw.Array
function Mesh:shapes(nodes) end

---How many elements are inverted at these nodes (or poorer than a floor), and which is the worst:
---{inverted, worst, worst_before}.
---@param nodes bw.Array
---@param floor? number
---@return table
function Mesh:judge(nodes, floor) end

---Moves inner corner nodes whose mask is not 0 until no element is inverted.
---@param nodes bw.Array
---@param mask bw.Array of nodes
---@return bw.Array? nodes
---@return table|string report inverted, worst, worst_before, worst_after, moved, iterations; or a message
---@return bw.Details? details
function Mesh:relax(nodes, mask) end

---New tetrahedra in the elements whose mask is not 0, at these nodes; the rest and the boundary stay.
---@param nodes bw.Array
---@param mask bw.Array of elements
---@return bw.Mesh?
---@return bw.Array|string node_from the old node of every node, 0 for new ones; or a message
---@return bw.Array|table element_from the old element of every element; -k in the k-th piece
function Mesh:refill(nodes, mask) end

---@param path string
---@param options? bw.PictureOptions values over nodes or elements
---@return true?
function Mesh:picture(path, options) end

---Lets go at once.
function Mesh:close() end
