---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Meshes
--
-- Meshes of tetrahedra: filling a surface, reading and writing, quality, changes of nodes and elements. Elements have
-- order 1 (4 nodes) or 2 (10 nodes).

---Making and reading meshes.
---@class bw.MeshModule
local mesh_module = {}

---Fills a surface with tetrahedra by TetGen, in a child process with limits. The surface is repaired, remeshed or wrapped
---where that is needed; log and warnings report it.
---
---Errors: geometry (the surface cannot be filled), limit (time or memory; `details.limit` says which).
---
---Source: docs/theory/filling.md.
---```lua
---local ball = bw.surface.sphere {radius = 0.01}
---local mesh, log = assert(bw.mesh.fill(ball, {elements = 2000, order = 2}))
---print(mesh, log.edge_length)
---```
---@param surface bw.Surface what is filled
---@param options? bw.MeshFillOptions size, order and limits
---@return bw.Mesh? mesh the mesh
---@return bw.MeshFillLog|string log how it went, or the message
---@return bw.Details? details
function mesh_module.fill(surface, options) end

---Fills several closed surfaces with one conforming mesh: each becomes a region of its name, with tags from 1 in the order
---of the names. A part may lie inside another one, which then is what surrounds it; parts may touch, or be apart. Touching
---faces get the same facets on both sides. The surfaces are not remeshed: TetGen adds points on them where elements need
---them. Elements of order 2 have straight edges; `mesh:curved` curves those on one of the surfaces.
---
---Errors: geometry (parts that overlap, a surface that is not sound, or TetGen refuses), limit (time or memory).
---
---Source: docs/theory/filling.md.
---```lua
---local core, shell = bw.surface.sphere {radius = 0.5}, bw.surface.sphere {radius = 1}
---local mesh = assert(bw.mesh.fill_parts({core = core, shell = shell}, {edge_length = 0.4}))
---print(mesh:region("core").volume, mesh:interface("core", "shell").area)
---```
---@param parts table<string, bw.Surface> closed surfaces by the names of their regions
---@param options? bw.MeshFillPartsOptions sizes, order and limits
---@return bw.Mesh? mesh the mesh
---@return string? message
---@return bw.Details? details
function mesh_module.fill_parts(parts, options) end

---Sizes, order and limits of a filling of several surfaces.
---@class bw.MeshFillPartsOptions
---@field order? 1|2 of the elements. Default: 1
---@field edge_length? number (m) of elements, where facets of the surfaces are not shorter. Default: by quality and volume
---@field max_volume? number (m3) of an element. Default: 0, no limit
---@field radius_edge? number (-) bound on circumradius over shortest edge. Range: 0 (none), or 1 and above. Default: 1.4
---@field dihedral? number (rad) smallest dihedral angle asked for. Range: 0 to 0.35. Default: 0, none
---@field keep_surface? boolean add no points on the surfaces. Default: false
---@field merge? number (m) points of the parts that are nearer are one. Default: 1e-9 of the diagonal
---@field near? bw.MeshFillPlace[] shorter edges near points. Default: none
---@field size? string|fun(x: number, y: number, z: number): number wanted edge length in m by place, 0: no bound; a formula as in `bw.array.map`, or a function. Default: none
---@field time_limit? number (s) of one step. Default: 300
---@field memory_limit? number (bytes) of one step. Default: 6e9

---Size, order and limits of a filling.
---@class bw.MeshFillOptions
---@field elements? integer (count) wanted number of elements. Default: 0, as many as quality and the other sizes ask for
---@field order? 1|2 of the elements. Default: 1
---@field edge_length? number (m) of the surface's triangles, in place of `elements`. Default: by quality and volume
---@field surface_tolerance? number (m) how far remeshing may move the surface. Default: a quarter of the edge length
---@field max_volume? number (m3) of an element. Default: 0, no limit
---@field radius_edge? number (-) bound on circumradius over shortest edge. Range: 0 (none), or 1 and above. Default: 1.4
---@field dihedral? number (rad) smallest dihedral angle asked for. Range: 0 to 0.35. Default: 0, none
---@field keep_surface? boolean add no points on the surface. Default: false
---@field remesh? boolean remesh the surface to a size that fits first. Default: true
---@field repair? boolean repair a surface that is not sound. Default: true
---@field sharp_angle? number (rad) edges whose triangles' normals differ by more are kept by remeshing. Default: 40 degrees
---@field near? bw.MeshFillPlace[] shorter edges near points, on the surface too. Default: none
---@field size? string|fun(x: number, y: number, z: number): number wanted edge length in m by place, 0: no bound; a formula as in `bw.array.map`, or a function. Default: none
---@field time_limit? number (s) of one attempt. Default: 300
---@field memory_limit? number (bytes) of one attempt. Default: 6e9
---@field tolerance? number (-) how far the number of elements may be off `elements`, relative. Range: above 0, below 1. Default: 0.15

---Edge lengths near a point.
---@class bw.MeshFillPlace
---@field at bw.Vector (m) the point
---@field radius? number (m) within it edges have the length; outside of it the length grows by 0.3 per distance. Default: 0
---@field length number (m) of edges, above 0

---How a filling went.
---@class bw.MeshFillLog
---@field moved number (m) the sum of the steps' distances: a bound on how far the surface moved
---@field steps bw.ShapeStep[] what was done to the surface, in order
---@field repaired boolean whether the surface was not sound
---@field surface_moved number (m) how far the surface moved
---@field edge_length number (m) the length that the surface was remeshed to
---@field attempts integer (count) runs of TetGen
---@field seconds_repair number (s) of repair
---@field seconds_remesh number (s) of remeshing
---@field seconds_fill number (s) of TetGen

---How a mesh is read.
---@class bw.MeshReadOptions
---@field unit? string|number (m, per unit of the file) or a name, as in `bw.UnitOptions`. Default: "m"
---@field renumber? boolean|"auto" whether nodes and elements are numbered along a space-filling curve. `"auto"` renumbers a mesh of at least 20000 elements where the curve makes the span of node numbers in an element at least four times smaller (geometric mean), and warns. Default: "auto"

---Reads a mesh from a .vtu, .pvtu, .msh, .mesh (MEDIT), .node or .ele (TetGen), or .inp (CalculiX, Abaqus) file. Elements
---that are no tetrahedra are passed over. The pieces of a .pvtu file are joined: by their numbers (GlobalNodeId,
---GlobalElementId) where all pieces have them, else nodes at the same place are one.
---
---Errors: io (the file cannot be read), format (damaged, or without tetrahedra), unsupported (a feature of the format),
---geometry (an element without volume, a node that is not there, a face of three elements), limit (more than 2147483647
---nodes or elements).
---```lua
---local box = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {2, 2, 2}})
---assert(box:write("box.vtu", {fields = {height = box.nodes:column(3):copy()}}))
---local mesh, file = assert(bw.mesh.read "box.vtu")
---print(mesh, file.fields.height:max())
---```
---@param path string the file
---@param options? bw.MeshReadOptions the unit of its coordinates, and which numbers its nodes get
---@return bw.Mesh? mesh the mesh
---@return bw.MeshFile|string file what else the file holds, or the message
---@return bw.Details? details
function mesh_module.read(path, options) end

---What a mesh file holds beside the mesh.
---@class bw.MeshFile
---@field fields table<string, bw.Array> by name, with a row for every node or every element
---@field sets table<string, bw.MeshSet> by name
---@field format string such as "MSH 4.1"
---@field skipped integer (count) elements that were passed over
---@field node_from? bw.Array (index from 1, node_count × 1, per node) of a renumbered mesh: numbers in the file, without unused nodes
---@field element_from? bw.Array (index from 1, element_count × 1, per element) of a renumbered mesh: numbers in the file

---A named set of a mesh file: nodes or elements.
---@class bw.MeshSet
---@field nodes? bw.Array (index from 1, n × 1) numbers of nodes
---@field elements? bw.Array (index from 1, n × 1) numbers of elements

---A mesh from nodes and elements. An element of negative volume is renumbered to a positive one. Nodes that no element
---uses are dropped.
---
---Errors: geometry (no elements, an element without volume, a number of a node that is not there, a face of three
---elements; details: `element`, `node` or `other`), limit (more than 2147483647 nodes or elements).
---```lua
---local nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}
---local mesh = assert(bw.mesh.new {nodes = nodes, elements = {{1, 2, 3, 4}}})
---print(mesh.volume) -- 0.16666666666667
---```
---@param options bw.MeshNewOptions the arrays
---@return bw.Mesh? mesh the mesh
---@return string? message
---@return bw.Details? details
function mesh_module.new(options) end

---Nodes and elements of a mesh.
---@class bw.MeshNewOptions
---@field nodes number[][]|bw.Array (m, n × 3, per node) coordinates
---@field elements integer[][]|bw.Array (index from 1, e × 4 or e × 10, per element) corners, then the mid-edge nodes of the edges 12 23 31 14 24 34
---@field order? 1|2 of the elements. Default: 1
---@field regions? integer[]|bw.Array (-, e × 1, per element) the tag of each element's region, any whole number of 32 bits. Default: none
---@field region_names? table<integer, string> the names of regions by tag. Default: "region 3" for tag 3

---A box of cells, each cut into six tetrahedra. Its sides have the names of those of `bw.surface.box`.
---
---Errors: limit (more than 2147483647 elements).
---```lua
---local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.01, 0.01}, cells = {20, 2, 2}, order = 2})
---print(mesh.element_count, mesh.node_count) -- 480 1025
---```
---@param options bw.MeshBoxOptions corners and cells
---@return bw.Mesh? mesh the mesh
---@return string? message
---@return bw.Details? details
function mesh_module.box(options) end

---A box of cells.
---@class bw.MeshBoxOptions
---@field min? bw.Vector (m) the smallest coordinates. Default: {0, 0, 0}
---@field max? bw.Vector (m) the largest coordinates. Default: {1, 1, 1}
---@field cells? bw.Vector (count) cells along x, y and z. Range: 1 to 1000000 each. Default: {1, 1, 1}
---@field order? 1|2 of the elements. Default: 1

---A mesh of tetrahedra. Meshes do not change: methods give new ones. Facets are the triangles of its boundary.
---```lua
---local mesh = assert(bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 1, 1}})
---print(mesh.volume, mesh.boundary:face({near = {0, 0.005, 0.005}}).area) -- 1e-05 0.0001
---```
---@class bw.Mesh
---@field nodes bw.Array (m, node_count × 3, per node) coordinates
---@field elements bw.Array (index from 1, element_count × 4 or × 10, per element) corners, then the mid-edge nodes of the edges 12 23 31 14 24 34
---@field regions bw.MeshRegion[] named parts of the mesh, ascending by tag; empty where it is not divided
---@field element_regions bw.Array? (index from 1, element_count × 1, per element) the place of its region in `regions`; nil without regions
---@field volumes bw.Array (m3, element_count × 1, per element) of the element with straight edges
---@field node_volumes bw.Array (m3, node_count × 1, per node) its part of the volume: a weight for values of nodes
---@field facets bw.Array (index from 1, facet_count × 3 or × 6, per facet) corners, counter-clockwise seen from outside, then mid-edge nodes
---@field facet_elements bw.Array (index from 1, facet_count × 1, per facet) the element behind it
---@field neighbours bw.Array (index from 1, element_count × 4, per element) the elements across its faces, 0: none. Faces are 132 124 143 234
---@field components bw.Array (index from 1, node_count × 1, per node) the body that it belongs to
---@field order integer (-) of the elements, 1 or 2
---@field node_count integer (count) of nodes
---@field element_count integer (count) of elements
---@field facet_count integer (count) of facets
---@field component_count integer (count) of bodies: parts that share no node
---@field volume number (m3) of all elements
---@field surface_moved number (m) the most by which `bw.mesh.fill` moved the surface; 0 of other meshes
---@field box bw.Box the smallest box that holds it
---@field boundary bw.Selection the whole boundary, to select parts of
local Mesh = {}

---Writes the mesh to a file, whose ending decides the format: .vtu, .pvtu, .msh, .mesh, .node or .ele (both files are
---written), or .inp (nodes, elements and regions). A .pvtu file names pieces of at most 100000 elements, which are written
---beside it (NAME_0.vtu, NAME_1.vtu, ...): less memory for a large mesh, and ParaView reads them in parallel.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function Mesh:write(path, options) end

---How a mesh is written.
---@class bw.MeshWriteOptions
---@field fields? table<string, bw.Array|bw.MeshField> arrays with a row for every node or every element, by name; for .vtu, .pvtu and .msh. Default: none
---@field unit? string|number (m, per unit of the file) or a name, as in `bw.UnitOptions`. Default: "m"
---@field version? "2.2"|"4.1" of the MSH format. Default: "4.1"

---A field of a file with its place: `{array, on = "elements"}`. Needed where a mesh has as many nodes as elements.
---@class bw.MeshField
---@field on "nodes"|"elements" what its rows belong to

---The mesh with elements of another order. Order 2 has straight edges, with mid-edge nodes halfway.
---
---Errors: limit (more than 2147483647 nodes).
---@param order 1|2 of the elements
---@return bw.Mesh? mesh the same mesh where it has this order
---@return string? message
---@return bw.Details? details
function Mesh:with_order(order) end

---The same elements with other positions of the nodes.
---
---Errors: geometry (elements would be flat or inverted, `details.inverted` of them; or a coordinate is not finite).
---@param nodes bw.Array|number[][] (m, node_count × 3, per node) coordinates
---@return bw.Mesh? mesh the moved mesh
---@return string? message
---@return bw.Details? details
function Mesh:moved(nodes) end

---All lengths times a factor.
---
---Errors: geometry (a factor of 0 or below).
---@param factor number (-) above 0
---@return bw.Mesh? mesh the scaled mesh
---@return string? message
---@return bw.Details? details
function Mesh:scale(factor) end

---Some of the elements, with the nodes that they use. No element at all raises.
---
---Errors: only those that every function may give.
---@param mask bw.Array (-, element_count × 1, per element) not 0: the element stays
---@return bw.Mesh? mesh these elements
---@return string? message
---@return bw.Details? details
function Mesh:subset(mask) end

---A region of a mesh: a named part of its elements, such as a part of an assembly or a layer. `print` shows its size.
---@class bw.MeshRegion
---@field name string its name, its own among the regions of the mesh
---@field tag integer (-) its number in files
---@field volume number (m3) of its elements
---@field elements bw.Array (index from 1, n × 1) its elements, ascending

---A region by its name. A name that is not there raises.
---```lua
---local mesh = assert(bw.mesh.box {cells = {2, 1, 1}})
---mesh = assert(mesh:with_regions({1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2}, {"left", "right"}))
---print(mesh:region("left").volume) -- 0.5
---```
---@param name string of the region
---@return bw.MeshRegion region the region
function Mesh:region(name) end

---The same nodes and elements with other regions. Two regions of one name raise.
---
---Errors: only those that every function may give.
---@param tags? integer[]|bw.Array (-, element_count × 1, per element) the tag of its region. Default: none, a mesh without regions
---@param names? table<integer, string> the names of regions by tag. Default: "region 3" for tag 3
---@return bw.Mesh? mesh with these regions
---@return string? message
---@return bw.Details? details
function Mesh:with_regions(tags, names) end

---Elements whose centroid is inside something become a new region; others keep theirs, and without one are in the region
---"rest". The border follows facets of elements, and `log.misplaced` says how far that is from the surface asked for. A
---name that is there, and a region that would be empty or the whole mesh, raise.
---
---Errors: geometry (a surface that is not closed).
---```lua
---local mesh = assert(bw.mesh.box {max = {2, 1, 1}, cells = {4, 2, 2}})
---local split, log = assert(mesh:split({max = {0.5, 1, 1}}, "left"))
---print(split:region("left").volume, log.misplaced) -- 0.5 0.0
---```
---@param where bw.Surface|bw.MeshSplitBox|string|fun(x: number, y: number, z: number): (boolean|number) what is split off: a closed surface, a box, a formula as in `bw.array.map`, or a function
---@param name string of the new region
---@return bw.Mesh? mesh with the region
---@return bw.MeshSplitLog|string log how well elements follow it, or the message
---@return bw.Details? details
function Mesh:split(where, name) end

---A box that splits a mesh.
---@class bw.MeshSplitBox
---@field min? bw.Vector (m) the smallest coordinates. Default: no limit
---@field max? bw.Vector (m) the largest coordinates. Default: no limit

---How well elements follow the surface that a mesh was split at.
---@class bw.MeshSplitLog
---@field volume number (m3) of the new region
---@field misplaced number (m3) parts of elements on the other side of the surface than their centroid, by 64 samples of each
---@field cut integer (count) elements that the surface cuts

---The facets between two regions. A region that is not there raises.
---```lua
---local mesh = assert(bw.mesh.box {max = {2, 1, 1}, cells = {4, 2, 2}})
---mesh = assert(mesh:split({max = {0.5, 1, 1}}, "left"))
---print(mesh:interface("left", "rest").area) -- 1.0
---```
---@param a string a region
---@param b string another region
---@return bw.MeshInterface interface no facet where the regions do not touch
function Mesh:interface(a, b) end

---The same mesh whose region has nodes of its own: those that it shares with other regions are doubled. It is a body of its
---own then, which touches the others. A region that is not there raises.
---
---Errors: limit (more than 2^31 - 1 nodes).
---```lua
---local mesh = assert(bw.mesh.box {max = {2, 1, 1}, cells = {4, 2, 2}})
---mesh = assert(mesh:split({max = {0.5, 1, 1}}, "left"))
---print(mesh.component_count, mesh:separated("left").component_count) -- 1 2
---```
---@param region string its name
---@return bw.Mesh? mesh with these nodes
---@return string? message
---@return bw.Details? details
function Mesh:separated(region) end

---The pairs of bodies that overlap by more than a millionth of the diagonal of the mesh's box, at most 100 of them. Bodies
---that touch are none. The list is empty for a sound assembly, but for interference fits and for facets of curved faces.
---`bw.model` and `bw.heat` refuse a mesh where a pair takes up more than a tenth of its smaller body together. They warn of
---one that is deeper than a twentieth of an edge.
---```lua
---local nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0, 0}, {1.5, 0, 0}, {0.5, 1, 0}, {0.5, 0, 1}}
---local mesh = assert(bw.mesh.new {nodes = nodes, elements = {{1, 2, 3, 4}, {5, 6, 7, 8}}})
---print(mesh:overlaps()[1]) -- bodies 1 and 2 overlap by at least 288.7 mm, volume 20830 cm3
---```
---@return bw.MeshOverlaps overlaps ascending by the numbers of their bodies
function Mesh:overlaps() end

---The pairs of bodies that overlap.
---@class bw.MeshOverlaps
---@field [integer] bw.MeshOverlap a pair
---@field more boolean whether there may be others than the 100 of the list

---Two bodies that overlap. `print` shows its size.
---@class bw.MeshOverlap
---@field bodies bw.Array (index from 1, 1 × 2) as in `mesh.components`
---@field elements bw.Array (index from 1, 1 × 2) one of each body, where the overlap is deepest
---@field at bw.Vector (m) a place there
---@field depth number (m) a lower bound of the motion that takes the bodies apart
---@field volume number (m3) that both take up, of elements with straight edges
---@field fraction number (-) of the volume of the smaller body

---The facets between two regions.
---@class bw.MeshInterface
---@field facets bw.Array (index from 1, n × 3 or × 6) corners, counter-clockwise seen from region b, then mid-edge nodes
---@field elements bw.Array (index from 1, n × 2, per facet) the elements of region a and of region b
---@field area number (m2) of the facets with straight edges

---The same mesh with nodes and elements numbered along Hilbert's space-filling curve. Edit sessions on it take less time
---(docs/benchmarks.md). Meshes that `bw.mesh.fill` made are numbered so.
---
---Errors: only those that every function may give.
---@return bw.Mesh? mesh the renumbered mesh
---@return bw.Array|string nodes (index from 1, node_count × 1, per node) its number before, or the message
---@return bw.Array|bw.Details elements (index from 1, element_count × 1, per element) its number before, or the details
function Mesh:renumbered() end

---Curved elements: mid-edge nodes of the boundary are moved onto the planes, cylinders, cones and spheres of the surface that
---the mesh was filled from. A node stays where an element would become too distorted. A mesh of order 1 raises.
---
---Errors: only those that every function may give.
---
---Source: docs/theory/faces.md.
---@param surface bw.Surface that the mesh was filled from
---@return bw.Mesh? mesh the curved mesh
---@return integer|string count (count) how many nodes moved, or the message
---@return bw.Details? details
function Mesh:curved(surface) end

---The boundary as a surface of the facets' corners.
---@return bw.Surface surface with a triangle for every facet, in their order
---@return bw.Array nodes (index from 1, point_count × 1, per point) the node of the mesh
function Mesh:surface() end

---The names of faces that the mesh got from its surface, such as those of `surface:named` or of a STEP file.
---`boundary:face(name)` selects one.
---```lua
---local mesh = assert(bw.mesh.fill(bw.surface.box {max = {0.03, 0.02, 0.01}}))
---print(mesh:face_names()[1], mesh.boundary:face("top").area)
---```
---@return string[] names empty where none has a name
function Mesh:face_names() end

---The faces of the surface that the mesh was filled from, as `surface:faces()` lists them, with the area and the number of
---facets that each has on the mesh's boundary. A face that the mesh lost has area 0.
---
---Errors: only those that every function may give.
---@param surface bw.Surface that the mesh was filled from
---@return bw.Face[]? faces in the order of `surface:faces()`
---@return string? message
---@return bw.Details? details
function Mesh:faces(surface) end

---The element that holds a point, or the nearest one.
---@param point bw.Vector (m) the point
---@return integer element (index from 1) the element
---@return number[] weights (-, 4) barycentric coordinates of the point, or of the nearest place in the element
---@return boolean inside whether the mesh holds the point
function Mesh:locate(point) end

---Values of a field of nodes at points, by the elements' shape functions. A point outside gets the value at the nearest
---place of the mesh.
---
---Errors: only those that every function may give.
---@param values bw.Array (any, node_count × c, per node) the field
---@param points bw.Array|number[][] (m, n × 3, per point) where it is evaluated
---@return bw.Array? sampled (any, n × c, per point) its values
---@return bw.Array|string outside (m, n × 1, per point) how far the point lies outside of the mesh, 0 inside; or the message
---@return bw.Details? details
function Mesh:sample(values, points) end

---Measures of the elements' quality, over the whole mesh.
---@return bw.MeshQuality quality extremes
function Mesh:quality() end

---Extremes of the quality of elements, with straight edges.
---@class bw.MeshQuality
---@field dihedral_min number (rad) the smallest dihedral angle
---@field dihedral_max number (rad) the largest dihedral angle
---@field radius_edge_max number (-) the largest circumradius over shortest edge
---@field aspect_max number (-) the largest of longest edge over smallest height
---@field volume_min number (m3) of the smallest element
---@field volume_max number (m3) of the largest element
---@field worst integer (index from 1) the element with the smallest dihedral angle

---Values of elements brought to nodes: the mean by volume, or the largest of the elements at the node.
---@param values bw.Array (any, element_count × c, per element) the values
---@param how? "mean"|"max" which of the two. Default: "mean"
---@return bw.Array nodal (any, node_count × c, per node) the values at nodes
function Mesh:to_nodes(values, how) end

---The shape quality of every element with straight edges: the mean ratio, 12 (3 V)^(2/3) over the sum of the squares of its
---edges. It is 1 for a regular tetrahedron, 0 or less for an inverted one.
---@param nodes? bw.Array|number[][] (m, node_count × 3, per node) other positions. Default: the mesh's own
---@return bw.Array quality (-, element_count × 1, per element) the mean ratio
function Mesh:shapes(nodes) end

---How many elements are inverted at other positions of the nodes, and which is the worst.
---@param nodes bw.Array|number[][] (m, node_count × 3, per node) the positions
---@param floor? number (-) elements of a lower shape quality count, too. Default: 0
---@return bw.MeshReport report what was found
function Mesh:shape_check(nodes, floor) end

---Inverted elements, and what was done about them. Shape quality is that of `mesh:shapes`.
---@class bw.MeshReport
---@field inverted integer (count) elements that are inverted, or below the floor
---@field worst integer (index from 1) the worst element; 0 where there is none
---@field worst_before number (-) its shape quality
---@field worst_after number (-) the smallest shape quality after `relax`
---@field moved integer (count) nodes that `relax` moved
---@field iterations integer (count) of `relax`

---Moves inner corner nodes until no element is inverted and the worst quality stops growing. Nodes of the boundary stay, and
---mid-edge nodes stay halfway.
---
---Errors: geometry (elements remain inverted).
---@param nodes bw.Array|number[][] (m, node_count × 3, per node) where they begin
---@param mask bw.Array (-, node_count × 1, per node) not 0: the node may move
---@return bw.Array? relaxed (m, node_count × 3, per node) the new positions
---@return bw.MeshReport|string report how it went, or the message
---@return bw.Details? details
function Mesh:relax(nodes, mask) end

---Replaces some elements by new ones at other positions of the nodes, by TetGen. The boundary and the other elements stay.
---A mask of zeros raises.
---
---Errors: geometry (the boundary of the part intersects itself, or an element outside of it is inverted), limit (time or
---memory).
---@param nodes bw.Array|number[][] (m, node_count × 3, per node) the positions
---@param mask bw.Array (-, element_count × 1, per element) not 0: the element is replaced
---@return bw.Mesh? mesh the refilled mesh
---@return bw.Array|string node_from (index from 1, n × 1, per node) its number before, 0 for new ones; or the message
---@return bw.Array|bw.Details element_from (index from 1, e × 1, per element) its number before, -k in the k-th replaced part; or the details
function Mesh:refill(nodes, mask) end

---Draws the boundary as a PNG file: see `bw.picture`. `values` may belong to nodes or elements.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions what is drawn and how
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Mesh:picture(path, options) end

---Releases the mesh at once.
function Mesh:close() end
