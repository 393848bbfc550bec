---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Surfaces
--
-- Triangle surfaces: reading, checking, repairing, remeshing, and their faces.

---@class bw.SurfaceModule
local surface_module = {}

---Reads STL, OBJ, OFF, PLY, MSH, VTU, decided by content. Without a unit: millimetres (MSH and VTU:
---metres).
---@param path string
---@param options? bw.UnitOptions
---@return bw.Surface? surface
---@return table|string info format, polygons, skipped, groups, metres_per_unit; or a message
---@return bw.Details? details
function surface_module.read(path, options) end

---@class bw.UnitOptions
---@field unit? string|number

---From points (metres) and triangles (numbers of points, counter-clockwise seen from outside).
---@param options bw.SurfaceNewOptions
---@return bw.Surface?
function surface_module.new(options) end

---@class bw.SurfaceNewOptions
---@field points table|bw.Array
---@field triangles table|bw.Array
---@field groups? table|bw.Array

---@param options bw.SurfaceBoxOptions
---@return bw.Surface?
function surface_module.box(options) end

---@class bw.SurfaceBoxOptions
---@field low bw.Vector
---@field high bw.Vector

---@param options bw.SurfaceSphereOptions
---@return bw.Surface?
function surface_module.sphere(options) end

---@class bw.SurfaceSphereOptions
---@field centre? bw.Vector
---@field radius number
---@field subdivisions? integer

---A closed cylinder; the length of `axis` is its height.
---@param options bw.SurfaceCylinderOptions
---@return bw.Surface?
function surface_module.cylinder(options) end

---@class bw.SurfaceCylinderOptions
---@field base? bw.Vector
---@field axis bw.Vector
---@field radius number
---@field segments? integer

---The zero set of a function of x, y, z, or of a formula in them ("x^2 + y^2 + z^2 - 1"), that is
---negative inside.
---@param value string|fun(x: number, y: number, z: number): number
---@param options bw.SurfaceImplicitOptions cells along the longest side, default 32
---@return bw.Surface?
---@return string? message
---@return bw.Details? details
function surface_module.implicit(value, options) end

---@class bw.SurfaceImplicitOptions
---@field low bw.Vector
---@field high bw.Vector
---@field cells? integer

---A triangle surface. It does not change: methods give new ones.
---@class bw.Surface
---@field points bw.Array point_count x 3, m
---@field triangles bw.Array triangle_count x 3
---@field groups bw.Array? group, solid or region of every facet
---@field point_count integer
---@field triangle_count integer
---@field area number m2
---@field volume number m3; negative when it faces inwards
---@field box bw.Box
local Surface = {}

---Writes .stl .obj .ply .off (millimetres unless told otherwise), .vtu .msh (metres). Fields, by
---point or facet, go into .vtu.
---@param path string
---@param options? bw.SurfaceWriteOptions
---@return true?
---@return string? message
---@return bw.Details? details
function Surface:write(path, options) end

---@class bw.SurfaceWriteOptions
---@field unit? string|number
---@field ascii? boolean
---@field fields? table<string, bw.Array>

---What is wrong with it: counts by kind, holes, shells, closed, oriented, sound, volume, area, box,
---and a list of defects {kind, facet, other, at}, at most `limit` of a kind.
---@param options? bw.SurfaceCheckOptions
---@return table?
function Surface:check(options) end

---@class bw.SurfaceCheckOptions
---@field limit? integer

---Welds, drops duplicates, orients, fills holes, resolves intersections, wraps: only what is needed.
---@param options? bw.SurfaceRepairOptions
---@return bw.Surface?
---@return table|string log moved and steps, or a message
---@return bw.Details? details
function Surface:repair(options) end

---@class bw.SurfaceRepairOptions
---@field weld? number
---@field fill_holes? boolean
---@field intersections? boolean
---@field wrap? boolean
---@field wrap_alpha? number
---@field wrap_offset? number
---@field time_limit? number
---@field memory_limit? number

---Isotropic remeshing with sharp edges and small features kept. Beyond `time_limit` in seconds of
---computing (300) or `memory_limit` in bytes (6e9): nil, a message and details with `limit` "time" or
---"memory".
---@param options? bw.SurfaceRemeshOptions
---@return bw.Surface?
---@return table|string log moved and steps, or a message
---@return bw.Details? details
function Surface:remesh(options) end

---@class bw.SurfaceRemeshOptions
---@field edge_length? number
---@field triangles? integer
---@field sharp_angle? number
---@field iterations? integer
---@field tolerance? number
---@field time_limit? number
---@field memory_limit? number

---A closed surface around anything; holes up to `alpha` (m; 1/50 of the box's diagonal) are bridged, and
---it lies about `offset` (m; alpha / 12) away. A child process makes it; beyond `time_limit` in seconds of
---computing (300) or `memory_limit` in bytes (6e9): nil, a message and details with `limit` "time" or
---"memory".
---@param options? bw.SurfaceWrapOptions
---@return bw.Surface?
---@return table|string log
---@return bw.Details? details
function Surface:wrap(options) end

---@class bw.SurfaceWrapOptions
---@field alpha? number
---@field offset? number
---@field time_limit? number
---@field memory_limit? number

---Makes neighbours agree and shells face outwards.
---@return bw.Surface?
---@return integer flipped facets that were turned
function Surface:orient() end

---Merges points closer than the tolerance (0: equal ones).
---@param tolerance? number
---@return bw.Surface?
function Surface:weld(tolerance) end

---@param factor number
---@return bw.Surface?
function Surface:scale(factor) end

---@param matrix number[][] three rows of four: [A | b]
---@return bw.Surface?
function Surface:transform(matrix) end

---@param by bw.Vector
---@return bw.Surface?
function Surface:translate(by) end

---Turns about an axis through a centre, right-handed.
---@param axis bw.Vector
---@param angle number radians
---@param centre? bw.Vector
---@return bw.Surface?
function Surface:rotate(axis, angle, centre) end

---The largest distance from one surface to the other, both ways; or how far each of some points is, m.
---@param other bw.Surface|bw.Array|number[][]
---@return number|bw.Array|nil
---@return string? message
---@return bw.Details? details
function Surface:distance(other) end

---A part of a surface bounded by sharp edges or by the end of a primitive. Lengths in m, areas in m2. A free
---form has neither point nor residual; a sphere has no axis; planes have no radius.
---@class bw.Face
---@field name string "plane 2": the second largest plane
---@field kind "plane"|"cylinder"|"cone"|"sphere"|"free form"
---@field area number
---@field triangle_count integer
---@field centre number[] of area
---@field normal number[] mean outward; 0 where the face closes on itself
---@field point? number[] of the plane or the axis; the centre of the sphere
---@field axis? number[] unit; the plane's outward normal
---@field radius? number of the cone: at the point
---@field slope? number of the cone: growth of the radius per length along the axis
---@field residual? number largest distance of a corner from the primitive

---The faces by descending area; `print(surface)` lists the largest twelve. Facets whose normals differ by at most
---`angle` (radians, default 30 degrees) are of one face unless primitives part them (docs/theory/faces.md).
---`for _, face in ipairs(surface:faces()) do print(face.name, face.area) end`
---@param options? bw.SurfaceFacesOptions
---@return bw.Face[]? faces
---@return bw.Array|string numbers of every triangle the number of its face, or a message
---@return bw.Details? details
function Surface:faces(options) end

---@class bw.SurfaceFacesOptions
---@field angle? number

---The re-entrant edges, the longest first: those whose angle inside the material exceeds 180 degrees by more than
---`angle` (radians, default 10 degrees) between two faces that lie on planes, cylinders, cones or spheres, and by more
---than 30 degrees where one is free form. Facets of a round face make no edge (docs/theory/singular.md). nil, a message
---and details for a surface that is open or turned inside out.
---`print(bw.surface.read("bracket.stl", {unit = "mm"}):singular_edges())`
---@param options? bw.SurfaceFacesOptions
---@return bw.SingularPlaces?
---@return string? message
---@return bw.Details? details
function Surface:singular_edges(options) end

---@param path string
---@param options? bw.PictureOptions
---@return true?
function Surface:picture(path, options) end

---Lets go at once.
function Surface:close() end

---How thick the body is under places of its surface that have equal shares of the area (1000 of them): the
---way straight in until the wall on the other side, inf where there is none.
---@param samples? integer
---@return bw.Array? thickness
---@return bw.Array|string places or a message
---@return bw.Details? details
function Surface:thickness(samples) end
