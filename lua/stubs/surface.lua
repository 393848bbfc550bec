---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Surfaces
--
-- Triangle surfaces: reading, making, checking, repairing and remeshing them, and their faces.

---Reading and making surfaces.
---@class bw.SurfaceModule
local surface_module = {}

---Reads a surface from an STL, OBJ, OFF, PLY, 3MF, glTF, MSH, VTU, STEP or IGES file. The content decides which format it is. A mesh of
---tetrahedra gives its boundary.
---
---Errors: io (the file cannot be read), format (it is none of these, or damaged), geometry (a coordinate is not finite),
---limit (more than 2147483647 points or triangles).
---```lua
---assert(bw.surface.box({min = {0, 0, 0}, max = {0.02, 0.02, 0.05}}):write "post.stl")
---local surface, info = assert(bw.surface.read("post.stl", {unit = "mm"}))
---print(surface, info.format)
---```
---@param path string the file
---@param options? bw.SurfaceReadOptions the unit of its coordinates, and how triangles follow curved faces
---@return bw.Surface? surface with coordinates in m
---@return bw.SurfaceReadInfo|string info what was read, or the message
---@return bw.Details? details
function surface_module.read(path, options) end

---The unit of a file.
---@class bw.UnitOptions
---@field unit? string|number (m, per unit of the file) or one of "um", "mm", "cm", "m", "km", "in", "ft". Default of surfaces: "m" for paths that end in .msh, .vtu, .pvtu, .mesh, .inp, .node or .ele, else "mm"; of meshes: "m"; of skeletons: "mm"

---How a surface is read.
---@class bw.SurfaceReadOptions
---@field unit? string|number (m, per unit of the file) as in bw.UnitOptions. Default of STEP and IGES: the unit in the file
---@field tolerance? number (m) of STEP and IGES: the largest distance of triangles from curved faces. Default: 1/2000 of the diagonal of the box
---@field angle? number (rad) of STEP and IGES: the largest turn of the normal along a triangle. Default: 0.2

---A body of a STEP or IGES file.
---@class bw.CadBody
---@field name string in the file, or "body 1"
---@field closed boolean whether it has a volume
---@field volume number? (m3) of the exact shape
---@field area number (m2) of the exact shape
---@field surface bw.Surface its triangles alone

---A face of a STEP or IGES file.
---@class bw.CadFace
---@field name string in the file, or "face 1"
---@field kind string "plane", "cylinder", "cone", "sphere", "torus" or "freeform"
---@field body integer (index from 1) its body
---@field area number (m2) of the exact face
---@field radius number? (m) of a cylinder or sphere; the smaller one of a torus

---What a surface was read from.
---@class bw.SurfaceReadInfo
---@field format string such as "STL binary"
---@field polygons integer (count) facets with more than three corners, which were cut into triangles
---@field skipped integer (count) records that were not read: lines, single points, unknown elements
---@field groups integer (count) groups of facets: groups, solids or regions of the file
---@field metres_per_unit number (m, per unit of the file) the unit that was applied: as given, else what the file says, else by the ending
---@field group_names? string[] the names of the objects of a 3MF or glTF file, by group; empty texts where it gives none
---@field bodies bw.CadBody[]? of STEP and IGES
---@field faces bw.CadFace[]? of STEP and IGES; group i is face i
---@field exact_volume number? (m3) of STEP and IGES: of the exact shape of all bodies
---@field exact_area number? (m2) of STEP and IGES: likewise

---A surface from points and triangles.
---
---Errors: geometry (a coordinate is not finite).
---```lua
---local points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}
---local surface = assert(bw.surface.new {points = points, triangles = {{1, 3, 2}, {1, 2, 4}, {2, 3, 4}, {3, 1, 4}}})
---print(surface.volume) -- 0.16666666666667
---```
---@param options bw.SurfaceNewOptions the arrays
---@return bw.Surface? surface the surface
---@return string? message
---@return bw.Details? details
function surface_module.new(options) end

---Points and triangles of a surface.
---@class bw.SurfaceNewOptions
---@field points number[][]|bw.Array (m, n × 3, per point) coordinates
---@field triangles integer[][]|bw.Array (index from 1, t × 3, per triangle) numbers of points, counter-clockwise seen from outside
---@field groups? integer[]|bw.Array (index from 1, t × 1, per triangle) the group of each triangle. Default: none
---@field face_names? string[] names of the groups, by number; empty texts for those without one. Default: none
---@field curved_faces? string[] names among these of faces with triangles that stand for a cylinder or cone, for STEP files. Default: none

---A box along the axes, of 12 triangles. Its faces are "left" and "right" (along x), "front" and "back" (along y),
---"bottom" and "top" (along z).
---```lua
---local box = bw.surface.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}}
---print(box.volume) -- 2e-05
---```
---@param options bw.SurfaceBoxOptions its corners
---@return bw.Surface surface a closed surface
function surface_module.box(options) end

---The corners of a box.
---@class bw.SurfaceBoxOptions
---@field min? bw.Vector (m) the smallest coordinates. Default: {0, 0, 0}
---@field max bw.Vector (m) the largest coordinates

---A sphere of triangles: an icosahedron whose triangles are cut into four `subdivisions` times. It is one face,
---"sphere".
---```lua
---local ball = bw.surface.sphere {radius = 0.01, subdivisions = 4}
---print(ball.triangle_count) -- 5120
---```
---@param options bw.SurfaceSphereOptions its size
---@return bw.Surface surface a closed surface, whose points lie on the sphere
function surface_module.sphere(options) end

---A sphere.
---@class bw.SurfaceSphereOptions
---@field centre? bw.Vector (m) the centre. Default: {0, 0, 0}
---@field radius number (m) the radius, above 0
---@field subdivisions? integer (count) how often triangles are cut into four. Range: 0 to 9. Default: 3
---@field tolerance? number (m) instead: the largest distance of triangles from the sphere, above 0

---A closed cylinder with the faces "bottom", "top" and "side".
---```lua
---local rod = bw.surface.cylinder {axis = {0, 0, 0.1}, radius = 0.005, segments = 96}
---print(rod)
---```
---@param options bw.SurfaceCylinderOptions its size
---@return bw.Surface surface a closed surface, whose points lie on the cylinder
function surface_module.cylinder(options) end

---A cylinder.
---@class bw.SurfaceCylinderOptions
---@field base? bw.Vector (m) the centre of the base. Default: {0, 0, 0}
---@field axis bw.Vector (m) from the base's centre to that of the top; its length is the height
---@field radius number (m) the radius, above 0
---@field segments? integer (count) sides of the polygon that stands for the circle. Range: 3 to 1000000. Default: 48
---@field tolerance? number (m) instead: the largest distance of triangles from the cylinder, above 0

---A closed cone or frustum of a cone with the faces "bottom", "top" and "side".
---```lua
---local nozzle = bw.surface.cone {axis = {0, 0, 0.02}, radius = 0.01, top_radius = 0.004}
---print(nozzle.volume) -- near pi 0.02 (0.01^2 + 0.01 0.004 + 0.004^2) / 3
---```
---@param options bw.SurfaceConeOptions its size
---@return bw.Surface surface a closed surface, whose points lie on the cone
function surface_module.cone(options) end

---A cone.
---@class bw.SurfaceConeOptions
---@field base? bw.Vector (m) the centre of the base. Default: {0, 0, 0}
---@field axis bw.Vector (m) from the base's centre to that of the top; its length is the height
---@field radius number (m) the radius of the base. Range: 0 and more
---@field top_radius? number (m) the radius of the top; 0 of a cone with an apex. Range: 0 and more. Default: 0
---@field segments? integer (count) sides of the polygon that stands for the circle. Range: 3 to 1000000. Default: 48
---@field tolerance? number (m) instead: the largest distance of triangles from the cone, above 0

---A right prism over a regular polygon with the faces "bottom", "top", "side 1", "side 2" and so on. A prism over any
---other polygon is an extruded outline.
---```lua
---local nut = bw.surface.prism {axis = {0, 0, 0.005}, radius = 0.006, sides = 6}
---print(nut.volume) -- 1.5 sqrt(3) 0.006^2 0.005
---```
---@param options bw.SurfacePrismOptions its size
---@return bw.Surface surface a closed surface
function surface_module.prism(options) end

---A prism.
---@class bw.SurfacePrismOptions
---@field base? bw.Vector (m) the centre of the base. Default: {0, 0, 0}
---@field axis bw.Vector (m) from the base's centre to that of the top; its length is the height
---@field radius number (m) from the axis to the corners, above 0
---@field sides integer (count) of the polygon. Range: 3 to 1000000

---A torus, which is one face, "torus".
---```lua
---local ring = bw.surface.torus {radius = 0.02, tube = 0.005}
---print(ring.volume) -- near 2 pi^2 0.02 0.005^2
---```
---@param options bw.SurfaceTorusOptions its size
---@return bw.Surface surface a closed surface, whose points lie on the torus
function surface_module.torus(options) end

---A torus.
---@class bw.SurfaceTorusOptions
---@field centre? bw.Vector (m) the centre. Default: {0, 0, 0}
---@field axis? bw.Vector (-) the axis, of any length but 0. Default: {0, 0, 1}
---@field radius number (m) of the circle in the middle of the tube, above 0
---@field tube number (m) the radius of the tube, above 0 and below `radius`
---@field segments? integer (count) sides of the polygons that stand for either circle. Range: 3 to 1000000. Default: 48
---@field tolerance? number (m) instead: the largest distance of the polygons from their circles, above 0

---An outline extruded along z from 0. The faces have the names "start" (at 0) and "end" and the tags of the outline.
---
---Errors: geometry (loops of the outline touch).
---```lua
---local plate = assert(bw.surface.extrude(bw.outline.rectangle {width = 0.04, height = 0.02}, {height = 0.01}))
---print(plate.volume) -- near 8e-06
---```
---@param outline bw.Outline what is extruded, with its holes
---@param options bw.SurfaceExtrudeOptions how far, and how finely
---@return bw.Surface? surface closed, with named faces
---@return string? message
---@return bw.Details? details
function surface_module.extrude(outline, options) end

---How an outline is extruded.
---@class bw.SurfaceExtrudeOptions
---@field height number (m) the length along z, above 0
---@field curvature? number (degrees) the largest turn between sides along curves. Range: above 0, to 90. Default: 20
---@field tolerance? number (m) the largest distance of sides from curves, above 0. Default: none

---An outline revolved about its y axis, which becomes the z axis: a place x, y goes round at the radius x and the height
---y. The outline lies at x of 0 or more. The faces have the tags of the outline; a part of a turn also has "start"
---(in the plane x, z) and "end". An outline that reaches to the left of the axis raises.
---
---Errors: geometry (loops of the outline touch).
---```lua
---local rim = assert(bw.outline.rectangle {min = {0.03, 0}, max = {0.04, 0.01}, tag = "rim"})
---local wheel = assert(bw.surface.revolve(rim, {segments = 96}))
---print(wheel.volume) -- near 2 pi 0.035 0.0001
---```
---@param outline bw.Outline what is revolved, with its holes
---@param options? bw.SurfaceRevolveOptions how far, and how finely
---@return bw.Surface? surface closed, with named faces
---@return string? message
---@return bw.Details? details
function surface_module.revolve(outline, options) end

---How an outline is revolved.
---@class bw.SurfaceRevolveOptions
---@field angle? number (rad) from the plane x, z on. Range: above 0, to 2 pi. Default: 2 pi
---@field segments? integer (count) sides of a full turn. Range: 3 to 1000000. Default: 48, or by `tolerance`
---@field curvature? number (degrees) the largest turn between sides along curves of the outline. Range: above 0, to 90. Default: 20
---@field tolerance? number (m) the largest distance of sides from curves of the outline and from circles, above 0. Default: none

---An outline swept along a path: its origin follows the path, and its plane stays across it. Sections turn about the
---path as little as they can (a rotation-minimising frame). At a corner of the path the pieces meet in a mitre joint, so
---that the outline is the same all along them. An outline whose centroid is its origin gives area times length. The
---faces have the names "start" and "end" and the tags of the outline. A path that turns back by more than 170 degrees raises.
---
---Errors: geometry (loops of the outline touch). Where the path bends more sharply than the outline is wide, the surface
---crosses itself: `check` says so.
---```lua
---local wire = assert(bw.outline.circle {radius = 0.001})
---local path = {{0, 0, 0}, {0, 0, 0.02}, {0.02, 0, 0.02}}
---local hook = assert(bw.surface.sweep(wire, {path = path}))
---print(hook.volume) -- near pi 0.001^2 0.04
---```
---@param outline bw.Outline what is swept, with its holes
---@param options bw.SurfaceSweepOptions along what
---@return bw.Surface? surface closed, with named faces
---@return string? message
---@return bw.Details? details
function surface_module.sweep(outline, options) end

---How an outline is swept.
---@class bw.SurfaceSweepOptions
---@field path bw.Vector[]|fun(t: number): bw.Vector (m) places that straight pieces join, or a curve for t from 0 to 1
---@field closed? boolean the path leads from its last place to its first. A curve's t = 1 is then its t = 0. Default: false
---@field up? bw.Vector (-) where the outline's y axis points at the first place, as nearly as it can. Default: {0, 0, 1}, or {0, 1, 0} where the path begins along z
---@field segments? integer (count) pieces that a curve is cut into. Range: 3 to 1000000. Default: 64
---@field curvature? number (degrees) the largest turn between sides along curves of the outline. Range: above 0, to 90. Default: 20
---@field tolerance? number (m) the largest distance of sides from curves of the outline, above 0. Default: none

---A solid between outlines at several heights, which straight lines join. Loops belong together in their order, and
---edges one by one where they are as many. Otherwise places of the same fraction of the length belong together, from where
---the solid twists least. The faces have the names "start" and "end" and the tags of the lower outline of each part. Outlines
---of different numbers of loops raise.
---
---Errors: geometry (loops of an outline touch).
---```lua
---local wide = assert(bw.outline.rectangle {width = 0.04, height = 0.04, centre = {0, 0}})
---local slim = assert(bw.outline.rectangle {width = 0.02, height = 0.02, centre = {0, 0}})
---local foot = assert(bw.surface.loft({wide, slim}, {heights = {0, 0.03}}))
---print(foot.volume) -- 0.03 (0.0016 + 0.0004 + 0.0008) / 3
---```
---@param outlines bw.Outline[] two or more
---@param options bw.SurfaceLoftOptions where they lie
---@return bw.Surface? surface closed, with named faces
---@return string? message
---@return bw.Details? details
function surface_module.loft(outlines, options) end

---Where outlines of a loft lie.
---@class bw.SurfaceLoftOptions
---@field heights number[] (m, n, per outline) ascending
---@field curvature? number (degrees) the largest turn between sides along curves. Range: above 0, to 90. Default: 20
---@field tolerance? number (m) the largest distance of sides from curves, above 0. Default: none

---The zero set of a function of x, y and z that is negative inside, by marching tetrahedra. The function must be
---positive on the box's surface. One that is nowhere negative on the grid raises. A second result of the function is the
---name of the face that a facet with this middle lies on, or nil; functions of `bw.shapes` give one by `named`.
---
---Errors: geometry (the function is negative on the box's surface, or not a number), limit (more than 2147483647 points).
---```lua
---local box = {min = {-2, -2, -1}, max = {2, 2, 1}, cells = 60}
---local torus = assert(bw.surface.implicit("(sqrt(x^2 + y^2) - 1.2)^2 + z^2 - 0.25", box))
---print(torus.volume) -- near 2 pi^2 1.2 0.25
---```
---@param value string|fun(x: number, y: number, z: number): number, string? a formula as in `bw.array.map`, or a function, of coordinates in m
---@param options bw.SurfaceImplicitOptions where and how finely it is evaluated
---@return bw.Surface? surface closed and manifold
---@return string? message
---@return bw.Details? details
function surface_module.implicit(value, options) end

---The grid on which a function is evaluated.
---@class bw.SurfaceImplicitOptions
---@field min bw.Vector (m) the smallest coordinates
---@field max bw.Vector (m) the largest coordinates
---@field cells? integer (count) cells along the longest side. Range: 1 to 4000. Default: 32

---A triangle surface. Surfaces do not change: methods give new ones. It may be open or wrong otherwise, as it was read;
---`check` reports it. `print(surface)` lists its largest faces.
---```lua
---local ball = bw.surface.sphere {centre = {0, 0, 0.01}, radius = 0.01}
---print(ball.volume, ball.area, ball.box.max[3])
---```
---@class bw.Surface
---@field points bw.Array (m, point_count × 3, per point) coordinates
---@field triangles bw.Array (index from 1, triangle_count × 3, per triangle) numbers of points, counter-clockwise seen from outside
---@field groups bw.Array? (index from 1, triangle_count × 1, per triangle) its group, solid or region in the file; nil where there is none
---@field point_count integer (count) of points
---@field triangle_count integer (count) of triangles
---@field area number (m2) of all triangles
---@field volume number (m3) that it encloses; negative where it faces inwards
---@field box bw.Box the smallest box that holds it
local Surface = {}

---Writes the surface to a file, whose ending decides the format: .stl (binary), .obj, .ply, .off, .3mf, .glb (glTF 2.0), .usda (USD),
---.step, .vtu or .msh. A STEP file has closed solids: triangles in one plane are one flat face. Chords of cylinders and cones of the
---modeller become true cylindrical and conical faces (`curved_faces`), and other curved faces stay triangles. With `values`, .glb, .usda, .ply, .obj and .3mf have the colours of a picture, as vertex colours or colours of
---triangles. A format that cannot hold the colours or fields raises.
---
---Errors: io (the file cannot be written), limit (more than 4 GB as .glb or .3mf), geometry (of .step: the surface is not closed,
---or not oriented).
---```lua
---local ball = bw.surface.sphere {radius = 0.01}
---assert(ball:write("ball.glb", {values = ball.points:column(3)}))
---```
---@param path string the file
---@param options? bw.SurfaceWriteOptions unit, form, colours and fields
---@return true? written true
---@return string? message
---@return bw.Details? details
function Surface:write(path, options) end

---How a surface is written.
---@class bw.SurfaceWriteOptions
---@field unit? string|number (m, per unit of the file) or a name, as in `bw.UnitOptions`. Default: "m" for .vtu, .msh and .glb, which has no other, else "mm"
---@field ascii? boolean text instead of binary, where the format has both. Default: false
---@field values? bw.Array (any, n × 1, per point or per triangle) what the colours show; grey where not finite. Of .obj per point. Default: none
---@field min? number (any) lower end of the colours. Default: the smallest value
---@field max? number (any) upper end of the colours. Default: the largest value
---@field fields? table<string, bw.Array> arrays with a row for every point or every triangle, by name; for .vtu, and of one column for .ply and .usda
---@field flat? boolean .step: cylinders and cones are written as the flat facets that they have here. Default: false

---What is wrong with the surface. `print` shows it in a few lines.
---
---Errors: only those that every function may give.
---@param options? bw.SurfaceCheckOptions how many defects are listed
---@return bw.SurfaceReport? report the defects
---@return string? message
---@return bw.Details? details
function Surface:check(options) end

---How many defects are listed.
---@class bw.SurfaceCheckOptions
---@field limit? integer (count) defects of each kind in the list. Default: 20

---What a check found. Equal points count as one.
---@class bw.SurfaceReport
---@field count table<string, integer> how many defects there are of each kind: "open edge", "non-manifold edge", "non-manifold point", "misoriented edge", "self-intersection", "duplicate facet", "zero-area facet", "flipped shell"
---@field holes integer (count) closed loops of open edges
---@field shells integer (count) parts that are connected through edges
---@field closed boolean every edge has exactly two triangles
---@field oriented boolean neighbours agree and every shell faces outwards, cavities inwards
---@field sound boolean closed, oriented, manifold, without self-intersections and degenerate triangles
---@field volume number (m3) that it encloses
---@field area number (m2) of all triangles
---@field box bw.Box the smallest box that holds it
---@field defects bw.SurfaceDefect[] at most `limit` of each kind

---One defect of a surface.
---@class bw.SurfaceDefect
---@field kind string as in `count` of the report
---@field facet integer (index from 1) the triangle
---@field other? integer (index from 1) the second triangle of a pair
---@field at bw.Vector (m) the middle of the edge, triangle or intersection

---Makes a sound surface: welds points, drops duplicate and degenerate triangles, orients, fills holes, resolves
---self-intersections and, as the last resort, wraps. Each step is done only where the check calls for it. A sound surface
---comes back as it is, with an empty log.
---
---Errors: geometry (what could not be repaired is in the message and in details: `open_edges`, `self_intersections`),
---limit (time or memory).
---@param options? bw.SurfaceRepairOptions which steps are allowed
---@return bw.Surface? surface sound
---@return bw.ShapeLog|string log what was changed, or the message
---@return bw.Details? details
function Surface:repair(options) end

---Which steps a repair may take.
---@class bw.SurfaceRepairOptions
---@field weld? number (m) points nearer than this become one. Default: 1e-6 of the box's diagonal
---@field fill_holes? boolean fill holes. Default: true
---@field intersections? boolean resolve self-intersections. Default: true
---@field wrap? boolean wrap the surface where nothing else helps. Default: true
---@field wrap_alpha? number (-) `alpha` of the wrap over the box's diagonal. Default: 0.01
---@field wrap_offset? number (-) `offset` of the wrap over the box's diagonal. Default: 0.001
---@field time_limit? number (s) of computing, for the whole repair. Default: 120
---@field memory_limit? number (bytes) of one step. Default: 6e9

---What was done to a surface, step by step. `print` shows it.
---@class bw.ShapeLog
---@field moved number (m) the sum of the steps' distances: a bound on how far the surface moved
---@field steps bw.ShapeStep[] in order; empty where nothing was changed

---One change of a surface.
---@class bw.ShapeStep
---@field name string such as "weld", "fill holes", "orient", "wrap", "remesh"
---@field count integer (count) how many things it changed
---@field moved number (m) the largest distance between the surfaces before and after
---@field text string a sentence

---Remeshes a closed manifold surface with triangles of even size. Sharp edges stay. Where a feature is smaller than the
---edge length, edges there are shorter, down to a twelfth of it.
---
---Errors: geometry (the surface is not closed and manifold, or the result intersects itself), limit (time or memory).
---@param options? bw.SurfaceRemeshOptions size and limits
---@return bw.Surface? surface the new surface
---@return bw.ShapeLog|string log what was changed, or the message
---@return bw.Details? details
function Surface:remesh(options) end

---Size and limits of a remeshing.
---@class bw.SurfaceRemeshOptions
---@field edge_length? number (m) wanted length of edges. Default: from `triangles`
---@field triangles? integer (count) wanted number, where there is no `edge_length`. Default: about as many as there are
---@field sharp_angle? number (rad) edges whose triangles' normals differ by more are kept. Default: 40 degrees
---@field iterations? integer (count) rounds. Range: 1 to 100. Default: 5
---@field tolerance? number (m) the largest distance that the surface may move. Default: a quarter of the edge length
---@field time_limit? number (s) of computing. Default: 300
---@field memory_limit? number (bytes) of memory. Default: 6e9

---A closed manifold surface around this one, by CGAL's alpha wrap in a child process. It bridges holes up to `alpha`.
---
---Errors: geometry (the surface has no size), limit (time, or memory; `details.limit` says which). A surface without
---triangles raises.
---@param options? bw.SurfaceWrapOptions lengths and limits
---@return bw.Surface? surface the wrap
---@return bw.ShapeLog|string log what was changed, or the message
---@return bw.Details? details
function Surface:wrap(options) end

---Lengths and limits of a wrap.
---@class bw.SurfaceWrapOptions
---@field alpha? number (m) the largest hole that is bridged. Default: 1/50 of the box's diagonal
---@field offset? number (m) how far outside of the surface the wrap lies. Default: `alpha` / 12
---@field time_limit? number (s) of computing. Default: 300
---@field memory_limit? number (bytes) of memory. Default: 6e9

---Makes neighbouring triangles agree and shells face outwards, cavities inwards.
---
---Errors: geometry (a surface with one side only, like a Moebius strip; details: `facet`).
---@return bw.Surface? surface the oriented surface
---@return integer|string flipped (count) triangles that were turned, or the message
---@return bw.Details? details
function Surface:orient() end

---Makes one point of those that are nearer to each other than the tolerance. Triangles stay, also those that collapse.
---@param tolerance? number (m) 0 or more. Default: 0, equal points only
---@return bw.Surface surface the welded surface
function Surface:weld(tolerance) end

---The surface with all coordinates times a factor.
---@param factor number (-) the factor
---@return bw.Surface surface the scaled surface
function Surface:scale(factor) end

---The surface under an affine map x → A x + b.
---@param matrix number[][]|bw.Array (any, 3 × 4) rows of [A | b], b in m
---@return bw.Surface surface the mapped surface
function Surface:transform(matrix) end

---The surface moved by a vector.
---@param by bw.Vector (m) the vector
---@return bw.Surface surface the moved surface
function Surface:translate(by) end

---The surface rotated about an axis through a centre, right-handed.
---@param axis bw.Vector (-) the direction, of any length but 0
---@param angle number (rad) the angle
---@param centre? bw.Vector (m) a point of the axis. Default: {0, 0, 0}
---@return bw.Surface surface the rotated surface
function Surface:rotate(axis, angle, centre) end

---The largest distance between two surfaces, in either direction, from samples (points and the mid-edge nodes and
---triangles). With points, how far each of them is from the surface. A surface without triangles beside another one
---raises.
---
---Errors: geometry (points are given, and the surface has no triangles).
---@param other bw.Surface|bw.Array|number[][] (m, n × 3, per point) another surface, or points
---@return number|bw.Array|nil distance (m, n × 1, per point) one number for a surface
---@return string? message
---@return bw.Details? details
function Surface:distance(other) end

---The triangle nearest to each of some points, the place on it, and how far that is. Of triangles that are as near, to 1e-12
---of the largest coordinate, the first: so for a point nearest to an edge or a corner.
---
---Errors: geometry (the surface has no triangles).
---```lua
---local box = bw.surface.box {max = {1, 1, 1}}
---local triangles, places, distances = box:nearest {{0.5, 0.25, 3}}
---print(triangles[1], places(1, 3), distances[1]) -- 3, 1.0, 2.0
---```
---@param points bw.Array|number[][] (m, n × 3, per point) the points
---@return bw.Array? triangles (index from 1, n × 1, per point) the nearest triangles
---@return bw.Array|string places (m, n × 3, per point) the places on them, or the message
---@return bw.Array|bw.Details distances (m, n × 1, per point) the distances from the points, or the details
function Surface:nearest(points) end

---The thickness of the body under places of its surface: the length of the straight line inwards, along the normal, up to
---the opposite wall. Each place stands for the same area.
---
---Errors: geometry (the surface has no area).
---@param samples? integer (count) places. Range: 1 to 10000000. Default: 1000
---@return bw.Array? thickness (m, samples × 1, per place) infinite where there is no wall
---@return bw.Array|string places (m, samples × 3, per place) their coordinates, or the message
---@return bw.Details? details
function Surface:thickness(samples) end

---The union of two bodies: what lies in either. Intersections are exact, points are rounded once at the end. Names of
---faces are kept. Where faces of both coincide, the name is that of the first.
---
---Errors: geometry (a surface is not sound, or the result touches itself), limit (time or memory ran out).
---@param other bw.Surface the other body, closed
---@return bw.Surface? surface the surface of the union
---@return string? message
---@return bw.Details? details
function Surface:union(other) end

---The difference of two bodies: what lies in the first and not in the other. As `union` otherwise. Where nothing is left
---it raises.
---
---Errors: geometry (a surface is not sound, or the result touches itself), limit (time or memory ran out).
---@param other bw.Surface the body that is taken away, closed
---@return bw.Surface? surface the surface of the difference
---@return string? message
---@return bw.Details? details
function Surface:difference(other) end

---The intersection of two bodies: what lies in both. As `union` otherwise. Where nothing is left
---it raises.
---
---Errors: geometry (a surface is not sound, or the result touches itself), limit (time or memory ran out).
---@param other bw.Surface the other body, closed
---@return bw.Surface? surface the surface of the intersection
---@return string? message
---@return bw.Details? details
function Surface:intersection(other) end

---The same surface with a name for all its triangles, or another name for one of its faces. A face that is not there
---raises. Names follow the faces through moves, booleans, repair, remeshing and filling: `mesh.boundary:face(name)`.
---```lua
---local drill = bw.surface.cylinder {base = {0.02, 0.02, -0.01}, axis = {0, 0, 0.03}, radius = 0.006}
---local plate = bw.surface.box {max = {0.04, 0.04, 0.01}}
---local part = assert(plate:difference(drill:named "bolt hole"))
---local mesh = assert(bw.mesh.fill(part, {edge_length = 0.005}))
---print(mesh.boundary:face("bolt hole").area)
---```
---@param name string the name, such as "bolt hole", of at most 47 bytes
---@param face? string the face that gets it. Default: all triangles become one face
---@return bw.Surface surface with the name
function Surface:named(name, face) end

---The names of the groups of triangles.
---@return string[] names by number of the group, empty texts for those without one; an empty list where none has a name
function Surface:face_names() end

---The names of faces with triangles that stand for a curved face: the modeller gives them. In STEP files those that
---lie on a cylinder or cone become it.
---```lua
---local part = bw.surface.cylinder {base = {0, 0, 0}, axis = {0, 0, 0.03}, radius = 0.006}
---print(part:curved_faces()[1]) -- side
---```
---@return string[] names of curved faces; an empty list where there is none
function Surface:curved_faces() end

---The mirror image at a plane.
---
---Errors: only those that every function may give.
---```lua
---local left = bw.surface.box {max = {0.02, 0.01, 0.01}}
---print(left:mirror({1, 0, 0}).box.min[1]) -- -0.02
---```
---@param normal bw.Vector (-) of the plane, of any length but 0
---@param point? bw.Vector (m) a point of the plane. Default: {0, 0, 0}
---@return bw.Surface? surface mirrored, with the same names
---@return string? message
---@return bw.Details? details
function Surface:mirror(normal, point) end

---Copies in a row, as one surface: their union where they meet.
---
---Errors: as of `union`, where copies meet.
---```lua
---local rib = bw.surface.box {max = {0.002, 0.02, 0.01}}
---print(rib:linear_array({count = 5, step = {0.006, 0, 0}}).volume) -- 2e-06
---```
---@param options bw.LinearArrayOptions how many, and how far apart
---@return bw.Surface? surface with the same names
---@return string? message
---@return bw.Details? details
function Surface:linear_array(options) end

---Copies in a row.
---@class bw.LinearArrayOptions
---@field count integer (count) of copies, with the first one. Range: 1 to 100000
---@field step bw.Vector (m) from each copy to the next

---Copies in a ring, as one surface: their union where they meet.
---
---Errors: as of `union`, where copies meet.
---```lua
---local drill = bw.surface.cylinder {base = {0.03, 0, 0}, axis = {0, 0, 0.01}, radius = 0.003}
---local drills = assert(drill:polar_array {count = 6})
---print(drills.volume / drill.volume) -- 6.0
---```
---@param options bw.PolarArrayOptions how many, and about which axis
---@return bw.Surface? surface with the same names
---@return string? message
---@return bw.Details? details
function Surface:polar_array(options) end

---Copies in a ring.
---@class bw.PolarArrayOptions
---@field count integer (count) of copies, with the first one. Range: 1 to 100000
---@field axis? bw.Vector (-) of the ring, of any length but 0. Default: {0, 0, 1}
---@field centre? bw.Vector (m) a point of the axis. Default: {0, 0, 0}
---@field angle? number (rad) from each copy to the next. Default: 2 pi / count

---The part of a mesh's boundary that lies on the triangles of a name. A name that is not there raises.
---@param mesh bw.Mesh a mesh that was filled from the surface
---@param name string of the face
---@return bw.Selection selection the part
function Surface:face_on(mesh, name) end

---The group of the triangle that is nearest to the middle of each facet of a mesh's boundary. A surface without groups
---raises.
---
---Errors: only those that every function may give.
---@param mesh bw.Mesh a mesh that was filled from the surface
---@return bw.Array? groups (index from 1, facet_count × 1, per facet) the groups
---@return string? message
---@return bw.Details? details
function Surface:groups_on(mesh) end

---The faces of the surface by descending area: parts that sharp edges or the end of a plane, cylinder, cone or sphere
---bound.
---
---Errors: only those that every function may give.
---
---Source: docs/theory/faces.md.
---@param options? bw.SurfaceFacesOptions how sharp an edge between faces is
---@return bw.Face[]? faces the largest first
---@return bw.Array|string numbers (index from 1, triangle_count × 1, per triangle) its face, or the message
---@return bw.Details? details
function Surface:faces(options) end

---How sharp an edge between two faces is.
---@class bw.SurfaceFacesOptions
---@field angle? number (rad) triangles whose normals differ by at most this belong to one face, unless primitives divide them. Range: above 0 to 1.5. Default: 30 degrees

---A part of a surface that stands for one smooth shape. A free form has neither `point` nor `residual`, a sphere no `axis`,
---a plane no `radius`.
---@class bw.Face
---@field name string such as "plane 2": the second largest plane
---@field kind "plane"|"cylinder"|"cone"|"sphere"|"free form" the shape
---@field area number (m2) of its triangles
---@field triangle_count integer (count) of its triangles
---@field centre bw.Vector (m) the centre of its area
---@field normal bw.Vector (-) the mean outward normal, unit; 0 where the face closes on itself
---@field point? bw.Vector (m) a point of the plane or of the axis; the centre of the sphere
---@field axis? bw.Vector (-) unit; of a plane the outward normal
---@field radius? number (m) the radius; of a cone at `point`
---@field slope? number (-) of a cone: growth of the radius per length along the axis
---@field residual? number (m) the largest distance of a corner from the primitive

---The re-entrant edges of a closed surface, the longest first: edges at which linear elasticity has no finite stress. An
---edge counts where its angle inside the material exceeds 180 degrees by more than `angle` between two primitives, and by
---more than 30 degrees beside a free form. Edges between triangles of one round face do not count.
---
---Errors: geometry (the surface is open, its triangles disagree, or it faces inwards).
---
---Source: M. L. Williams, J. Appl. Mech. 19 (1952); docs/theory/singular.md.
---@param options? bw.SurfaceSingularEdgesOptions which edges count
---@return bw.SingularPlaces? places a list of `bw.SingularPlace`
---@return string? message
---@return bw.Details? details
function Surface:singular_edges(options) end

---Which edges count as re-entrant.
---@class bw.SurfaceSingularEdgesOptions
---@field angle? number (rad) how far the angle inside must exceed 180 degrees. Range: above 0 to 1.5. Default: 10 degrees

---Draws the surface as a PNG file: see `bw.picture`.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions what is drawn and how
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Surface:picture(path, options) end

---Releases the surface at once.
function Surface:close() end
