---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Outlines
--
-- Shapes in the plane, bounded by lines and cubic curves. A shape consists of loops. An outer loop holds a region of
-- material, and a hole is a loop inside it. Edges and vertices are numbered from 1 through all loops: edge n leads
-- from vertex n to the next vertex of its loop.

---Making and reading outlines. Called, it makes an outline from loops.
---@class bw.OutlineModule
---@overload fun(options: bw.OutlineOptions|bw.OutlineLoop): bw.Outline?, string?, bw.Details?
local outline_module = {}

---An outline from loops of vertices. Outer loops run counter-clockwise and holes clockwise. A loop given the other way
---is reversed, and begins at the same point.
---
---Errors: geometry (a loop crosses or touches itself or another one, has a cusp, a doubled point or no area, or lies
---outside of what should hold it; details `segment`, `other_segment`, `x`, `y`).
---```lua
---local hole = {{0.02, 0.01}, {0.02, 0.02}, {0.04, 0.02}, {0.04, 0.01}}
---local plate = assert(bw.outline {points = {{0, 0}, {0.1, 0}, {0.1, 0.03}, {0, 0.03}}, holes = {hole}})
---print(plate.area) -- 0.0028
---```
---@param options bw.OutlineOptions|bw.OutlineLoop the loops, or the outer loop alone
---@return bw.Outline? outline the outline
---@return string? message
---@return bw.Details? details
function outline_module:__call(options) end

---A vertex of a loop. `{x, y}` (m) is a vertex at the end of a line. `{{x, y}, {x, y}, {x, y}}` (m) is one at the end of
---a cubic Bézier curve: its two control points, then the vertex.
---@alias bw.OutlineVertex number[]|number[][]

---A loop: the list of its vertices, with names beside them. The first vertex's line or curve comes from the last
---vertex and closes the loop.
---@class bw.OutlineLoop
---@field points? bw.OutlineVertex[] the vertices. Default: the list itself
---@field name? string its name. Default: "outline" for the outer loop, "hole 1", "region 1" and so on for others
---@field tag? string the tag of its edges. Default: its name, else "boundary"
---@field tags? table<string, integer|integer[]> the edges that have another tag (index from 1, within the loop), by tag
---@field region? integer (index from 1) the region inside. Of holes: without meaning. Default: a new region

---The loops of an outline.
---@class bw.OutlineOptions
---@field points bw.OutlineVertex[] the vertices of the outer loop
---@field name? string the name of the outer loop. Default: "outline"
---@field tag? string the tag of the outer loop's edges. Default: `name`, else "boundary"
---@field tags? table<string, integer|integer[]> the edges of the outer loop that have another tag (index from 1), by tag
---@field holes? (bw.OutlineLoop|bw.Outline)[] holes: loops, or outlines of one loop. Default: none
---@field regions? (bw.OutlineLoop|bw.Outline)[] further regions: loops, or outlines of one loop. Default: none

---A rectangle. Its edges are 1 below, 2 right, 3 above and 4 left. With rounded corners each arc has two edges.
---
---Errors: geometry (a hole or a region crosses another loop).
---```lua
---local plate = assert(bw.outline.rectangle {width = 0.1, height = 0.03, tags = {support = 4, load = 2}})
---print(plate.area) -- 0.003
---```
---@param options bw.OutlineRectangleOptions its corners or its size
---@return bw.Outline? outline the rectangle
---@return string? message
---@return bw.Details? details
function outline_module.rectangle(options) end

---A rectangle: `min` and `max`, or `width` and `height`.
---@class bw.OutlineRectangleOptions
---@field min? number[] (m, {x, y}) the lower left corner
---@field max? number[] (m, {x, y}) the upper right corner
---@field width? number (m) the width, above 0
---@field height? number (m) the height, above 0
---@field centre? number[] (m, {x, y}) the centre, beside width and height. Default: half the size, so that the lower left corner is {0, 0}
---@field radius? number (m) the radius of the corners. Range: 0 to half the shorter side. Default: 0
---@field name? string the loop's name. Default: "outline"
---@field tag? string the tag of its edges. Default: `name`, else "boundary"
---@field tags? table<string, integer|integer[]> the edges that have another tag (index from 1), by tag
---@field holes? (bw.OutlineLoop|bw.Outline)[] holes, as in `bw.OutlineOptions`
---@field regions? (bw.OutlineLoop|bw.Outline)[] further regions, as in `bw.OutlineOptions`

---A circle of eight cubic curves, which deviate from it by at most 4e-6 radii.
---
---Errors: geometry (a hole or a region crosses another loop).
---```lua
---local ring = assert(bw.outline.circle {radius = 0.02, holes = {bw.outline.circle {radius = 0.01}}})
---print(ring.area) -- near pi (0.02^2 - 0.01^2)
---```
---@param options bw.OutlineCircleOptions its size
---@return bw.Outline? outline the circle
---@return string? message
---@return bw.Details? details
function outline_module.circle(options) end

---A circle.
---@class bw.OutlineCircleOptions
---@field radius number (m) the radius, above 0
---@field centre? number[] (m, {x, y}) the centre. Default: {0, 0}
---@field name? string the loop's name. Default: "outline"
---@field tag? string the tag of its edges. Default: `name`, else "boundary"
---@field tags? table<string, integer|integer[]> the edges that have another tag (index from 1), by tag
---@field holes? (bw.OutlineLoop|bw.Outline)[] holes, as in `bw.OutlineOptions`
---@field regions? (bw.OutlineLoop|bw.Outline)[] further regions, as in `bw.OutlineOptions`

---An ellipse of eight cubic curves.
---
---Errors: geometry (a hole or a region crosses another loop).
---```lua
---local ellipse = assert(bw.outline.ellipse {radii = {0.02, 0.01}, angle = 30})
---print(ellipse.area) -- near pi 0.02 0.01
---```
---@param options bw.OutlineEllipseOptions its size
---@return bw.Outline? outline the ellipse
---@return string? message
---@return bw.Details? details
function outline_module.ellipse(options) end

---An ellipse.
---@class bw.OutlineEllipseOptions
---@field radii number[] (m, {a, b}) the semi-axes, above 0
---@field centre? number[] (m, {x, y}) the centre. Default: {0, 0}
---@field angle? number (degrees) from the x axis to the first semi-axis, counter-clockwise. Default: 0
---@field name? string the loop's name. Default: "outline"
---@field tag? string the tag of its edges. Default: `name`, else "boundary"
---@field tags? table<string, integer|integer[]> the edges that have another tag (index from 1), by tag
---@field holes? (bw.OutlineLoop|bw.Outline)[] holes, as in `bw.OutlineOptions`
---@field regions? (bw.OutlineLoop|bw.Outline)[] further regions, as in `bw.OutlineOptions`

---A polygon.
---
---Errors: geometry (as of `bw.outline`).
---```lua
---local triangle = assert(bw.outline.polygon {{0, 0}, {0.1, 0}, {0, 0.1}})
---print(triangle.area) -- 0.005
---```
---@param options bw.OutlinePolygonOptions|number[][] (m, n × 2, per corner) options, or the list of corners alone
---@return bw.Outline? outline the polygon
---@return string? message
---@return bw.Details? details
function outline_module.polygon(options) end

---A polygon.
---@class bw.OutlinePolygonOptions
---@field points number[][] (m, n × 2, per corner) the corners
---@field name? string the loop's name. Default: "outline"
---@field tag? string the tag of its edges. Default: `name`, else "boundary"
---@field tags? table<string, integer|integer[]> the edges that have another tag (index from 1), by tag
---@field holes? (bw.OutlineLoop|bw.Outline)[] holes, as in `bw.OutlineOptions`
---@field regions? (bw.OutlineLoop|bw.Outline)[] further regions, as in `bw.OutlineOptions`

---A polygon whose corners are arcs. Edges are numbered in their order: the arc of corner 1, the edge behind it, the arc
---of corner 2 and so on. An arc has an edge for every 45 degrees that have begun. Arcs that do not fit into their
---edges raise.
---
---Errors: geometry (as of `bw.outline`).
---```lua
---local corners = {{0, 0}, {0.1, 0}, {0.1, 0.05}, {0, 0.05}}
---local plate = assert(bw.outline.rounded {points = corners, radius = {0, 0, 0.01, 0.01}})
---print(plate.area) -- near 0.00495708
---```
---@param options bw.OutlineRoundedOptions its corners and radii
---@return bw.Outline? outline the polygon
---@return string? message
---@return bw.Details? details
function outline_module.rounded(options) end

---A polygon with rounded corners.
---@class bw.OutlineRoundedOptions
---@field points number[][] (m, n × 2, per corner) the corners, three or more
---@field radius number|number[] (m, n, per corner) one radius, or one for each corner; 0 keeps a corner sharp
---@field name? string the loop's name. Default: "outline"
---@field tag? string the tag of its edges. Default: `name`, else "boundary"
---@field tags? table<string, integer|integer[]> the edges that have another tag (index from 1), by tag
---@field holes? (bw.OutlineLoop|bw.Outline)[] holes, as in `bw.OutlineOptions`
---@field regions? (bw.OutlineLoop|bw.Outline)[] further regions, as in `bw.OutlineOptions`

---Reads an SVG or DXF drawing. The content decides which format it is. Closed curves become loops, and so do open ones
---that close when put together. Loops inside an even number of others are material (region 1), the rest are holes.
---Names are the id (SVG). Tags are the class (SVG) or the layer (DXF).
---
---Errors: io (the file cannot be read), format (it is neither, damaged, or without a curve), geometry (curves cross,
---touch, or do not close; details `file`, `line`, `x`, `y`).
---```lua
---assert(bw.outline.circle({radius = 0.01}):write "disc.svg")
---local disc, info = assert(bw.outline.read "disc.svg")
---print(disc.area, info.format)
---```
---@param path string the file
---@param options? bw.OutlineReadOptions unit and tolerance
---@return bw.Outline? outline the outline, with coordinates in m
---@return bw.OutlineReadInfo|string info what was read, or the message
---@return bw.Details? details
function outline_module.read(path, options) end

---How a drawing is read.
---@class bw.OutlineReadOptions
---@field unit? string|number (m, per unit of the file) or a name, as in `bw.UnitOptions`. Default: what the file says
---@field tolerance? number (m) how far apart ends may lie that belong together. Default: 1e-5 times the diagonal of the drawing's box

---What an outline was read from.
---@class bw.OutlineReadInfo
---@field format string such as "SVG"
---@field skipped integer (count) elements of the drawing that were not read

---A shape in the plane with holes and regions, bounded by lines and cubic curves. Outlines do not change: methods give
---new ones. `print(outline)` lists its loops.
---```lua
---local plate = assert(bw.outline.rectangle {width = 0.1, height = 0.03})
---local wider = assert(plate:moved({edge = 2}, {0.02, 0}))
---print(plate.area, wider.area) -- 0.003 0.0036
---```
---@class bw.Outline
---@field area number (m2) of the material, without holes
---@field perimeter number (m) of the material; boundaries between regions are not counted
---@field centroid number[] (m, {x, y}) of the material
---@field second_moment bw.OutlineSecondMoment second moments of area of the material
---@field box bw.OutlineBox the smallest box along the axes that holds it
---@field area_gradient bw.Array (m, point_count × 2, per point) derivative of the area by x and y of every point
---@field points bw.Array (m, point_count × 2, per point) x, y of vertices and control points
---@field vertices bw.Array (m, edge_count × 2, per vertex) x, y of the vertices, in the order of their edges
---@field segments bw.Array (index from 1, edge_count × 5, per edge) start, first control point, second control point, end, tag: rows of `points` (control points of a line: 0), and an index of `tags`
---@field loops bw.OutlineLoopInfo[] its loops
---@field tags string[] its tags
---@field edge_count integer (count) of edges, and of vertices
---@field region_count integer (count) of regions
local Outline = {}

---Second moments of area about the centroid.
---@class bw.OutlineSecondMoment
---@field xx number (m4) integral of y²
---@field yy number (m4) integral of x²
---@field xy number (m4) integral of x y

---A box in the plane.
---@class bw.OutlineBox
---@field min number[] (m, {x, y}) the smallest coordinates
---@field max number[] (m, {x, y}) the largest coordinates

---What a loop is.
---@class bw.OutlineLoopInfo
---@field name string its name
---@field hole boolean whether it is a hole
---@field region? integer (index from 1) the region inside; nil of a hole
---@field first integer (index from 1) its first edge
---@field count integer (count) of its edges
---@field parent? string the name of the loop directly around it; nil where there is none

---Writes the outline to a drawing in millimetres, whose ending decides the format: .svg, or .dxf (AutoCAD 2000, with
---tags as layers). Names and regions are kept in SVG alone.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function Outline:write(path) end

---Draws a PNG picture of the regions, and of the edges coloured by tag.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.OutlinePictureOptions its size
---@return true? written true
---@return string? message
---@return bw.Details? details
function Outline:picture(path, options) end

---How an outline is drawn.
---@class bw.OutlinePictureOptions
---@field width? integer (pixels) the width. Range: 16 to 20000. Default: 1200
---@field height? integer (pixels) the height. Range: 16 to 20000. Default: 900
---@field numbers? boolean whether edges have their numbers beside them. Default: false

---Moves a handle.
---
---Errors: geometry (edges would cross or touch).
---@param handle bw.OutlineHandle what is moved
---@param by number[] (m, {x, y}) the displacement
---@return bw.Outline? outline of the same topology
---@return string? message
---@return bw.Details? details
function Outline:moved(handle, by) end

---What is moved: a vertex, an edge, a control point, or a loop. With `loop` beside them, vertex and edge count from
---that loop's first.
---@class bw.OutlineHandle
---@field vertex? integer (index from 1) a vertex, with the control points beside it
---@field edge? integer (index from 1) an edge, with the control points beside its ends
---@field loop? string|integer (index from 1) a loop by name or number, with the loops inside it
---@field control? integer (index from 1) beside `edge`: its first or second control point alone. Range: 1 to 2

---The displacement of each point for a unit displacement of a handle.
---@param handle bw.OutlineHandle what is moved
---@return bw.Array weights (-, point_count × 1, per point) from 0 to 1
function Outline:weights(handle) end

---The same edges with other points.
---
---Errors: geometry (edges would cross or touch).
---@param points number[][]|bw.Array (m, point_count × 2, per point) rows as in `points`
---@return bw.Outline? outline of the same topology
---@return string? message
---@return bw.Details? details
function Outline:with_points(points) end

---Whether one outline was made from the other by moving points.
---@param other bw.Outline another outline
---@return boolean same true where both have the same topology
function Outline:same_topology(other) end

---Adds a hole.
---
---Errors: geometry (the loop crosses or touches another, or lies outside of the material).
---@param loop bw.OutlineLoop|bw.Outline a loop, or an outline of one loop
---@return bw.Outline? outline with the hole
---@return string? message
---@return bw.Details? details
function Outline:hole(loop) end

---Adds a loop with a region inside: that of the loop's `region`, else a new one.
---
---Errors: geometry (the loop crosses or touches another).
---@param loop bw.OutlineLoop|bw.Outline a loop, or an outline of one loop
---@return bw.Outline? outline with the region
---@return string? message
---@return bw.Details? details
function Outline:region(loop) end

---Adds a loop given by arrays.
---
---Errors: geometry (the loop crosses or touches another).
---@param points number[][]|bw.Array (m, n × 2, per point) vertices and control points
---@param segments integer[][]|bw.Array (index from 1, count × 5, per edge) rows of `points`, and a tag, as in `segments`
---@param loop bw.OutlineLoopHeader what the loop is
---@return bw.Outline? outline with the loop
---@return string? message
---@return bw.Details? details
function Outline:with_loop(points, segments, loop) end

---What a loop given by arrays is.
---@class bw.OutlineLoopHeader
---@field count integer (count) of its edges
---@field region integer (index from 1) the region inside; 0 for a hole
---@field name? string its name. Default: "loop" with its number

---Removes a loop and the loops inside it.
---
---Errors: geometry (no loop would be left).
---@param loop string|integer (index from 1) a loop by name or number
---@return bw.Outline? outline without the loop
---@return string? message
---@return bw.Details? details
function Outline:without(loop) end

---Laplacian smoothing: every point moves towards the mean of its neighbours.
---
---Errors: geometry (edges would cross or touch).
---@param options? bw.OutlineSmoothOptions which loop, and how strongly
---@return bw.Outline? outline of the same topology
---@return string? message
---@return bw.Details? details
function Outline:smooth(options) end

---How an outline is smoothed.
---@class bw.OutlineSmoothOptions
---@field loop? string|integer (index from 1) a loop by name or number. Default: all
---@field strength? number (-) the fraction of the way to the mean. Range: 0 to 1. Default: 0.5
---@field rounds? integer (count) how often. Range: 0 to 100000. Default: 1
---@field corner? number (degrees) vertices at which the loop turns by more stay. Range: 0 and more. Default: 30

---Pulls a vertex to a place. Pinned vertices stay. The curve between, up to the first vertex `reach` away along it,
---follows as rigidly as possible. Without pins and reach the loop moves as a whole. With a single pin it rotates about
---it.
---
---Errors: geometry (edges would cross or touch).
---
---Source: Igarashi, Moscovich, Hughes, As-rigid-as-possible shape manipulation, 2005.
---@param vertex integer (index from 1) the vertex
---@param to number[] (m, {x, y}) its new place
---@param options? bw.OutlinePullOptions what stays
---@return bw.Outline? outline of the same topology
---@return string? message
---@return bw.Details? details
function Outline:pull(vertex, to, options) end

---What stays when a vertex is pulled.
---@class bw.OutlinePullOptions
---@field pins? integer[] (index from 1, n) vertices that stay, not the pulled one. Default: none
---@field reach? number (m) how far along the curve the rest follows; 0: up to the pins. Default: 0

---Splits an edge in two without a change of its shape.
---
---Errors: geometry (the new vertex is too close to another).
---@param edge integer (index from 1) the edge
---@param t? number (-) the parameter of the new vertex, between 0 and 1. Default: 0.5
---@return bw.Outline? outline with an edge more
---@return string? message
---@return bw.Details? details
function Outline:split(edge, t) end

---Removes a vertex: one edge replaces the two beside it, with the tag of the first. Two lines give a line. Otherwise the
---edge is a cubic with the same directions at its ends, which undoes a split. The only vertex of a loop raises.
---
---Errors: geometry (edges would cross or touch).
---@param vertex integer (index from 1) the vertex
---@return bw.Outline? outline with an edge fewer
---@return string? message
---@return bw.Details? details
function Outline:join(vertex) end

---The numbers of the edges that are selected. A selection without an edge raises.
---@param which bw.OutlineEdges|integer|integer[] (index from 1, n) a selection, a number, or a list of numbers
---@return integer[] edges (index from 1, n) the edges
function Outline:edges(which) end

---A selection of edges: one of these.
---@class bw.OutlineEdges
---@field edges? integer|integer[] (index from 1, n) a number, or a list of numbers
---@field near? number[] (m, {x, y}) a point: edges within `radius` of it, or without a radius the nearest
---@field radius? number (m) beside `near`: the distance. Range: 0 and more
---@field box? number[][] (m, 2 × 2, {min, max}) the corners of a box: edges that lie wholly inside it
---@field loop? string|integer (index from 1) a loop by name or number: all its edges

---Gives the selected edges a tag.
---
---Errors: only those that every function may give.
---@param name string the tag
---@param which bw.OutlineEdges|integer|integer[] (index from 1, n) a selection, a number, or a list of numbers
---@return bw.Outline? outline with the tag
---@return string? message
---@return bw.Details? details
function Outline:tag(name, which) end

---Gives edges a tag.
---
---Errors: only those that every function may give.
---@param name string the tag
---@param edges integer[] (index from 1, n) the edges
---@return bw.Outline? outline with the tag
---@return string? message
---@return bw.Details? details
function Outline:with_tag(name, edges) end

---Translates the outline.
---
---Errors: geometry (coordinates grow so large that edges are no longer apart).
---@param by? number[] (m, {x, y}) the displacement. Default: {0, 0}
---@return bw.Outline? outline of the same topology
---@return string? message
---@return bw.Details? details
function Outline:shifted(by) end

---Rotates the outline counter-clockwise.
---
---Errors: geometry (coordinates grow so large that edges are no longer apart).
---@param degrees number (degrees) the angle
---@param about? number[] (m, {x, y}) the centre. Default: the centroid
---@return bw.Outline? outline of the same topology
---@return string? message
---@return bw.Details? details
function Outline:rotated(degrees, about) end

---Scales the outline.
---
---Errors: geometry (edges would be too close to each other).
---@param factor number|number[] (-, {fx, fy}) one factor, or one for x and one for y, above 0
---@param about? number[] (m, {x, y}) the centre. Default: the centroid
---@return bw.Outline? outline of the same topology
---@return string? message
---@return bw.Details? details
function Outline:scaled(factor, about) end

---Replaces corners between two lines by arcs. An arc has an edge for every 45 degrees that have begun. Arcs that do not
---fit into their edges raise, and so does a vertex at the end of a curve.
---
---Errors: geometry (arcs would cross another loop).
---```lua
---local corner = {{0, 0}, {0.1, 0}, {0.1, 0.01}, {0.01, 0.01}, {0.01, 0.08}, {0, 0.08}}
---local profile = assert(bw.outline(corner):fillet(0.005, {vertices = 4}))
---print(profile.area) -- near 0.0017 + 0.005^2 (1 - pi / 4)
---```
---@param radius number (m) of the arcs, above 0
---@param options? bw.FilletOptions which corners
---@return bw.Outline? outline with arcs
---@return string? message
---@return bw.Details? details
function Outline:fillet(radius, options) end

---Which corners become arcs.
---@class bw.FilletOptions
---@field vertices? integer|integer[] (index from 1, n) numbers of vertices. Default: all corners between two lines
---@field tag? string the tag of the arcs. Default: "fillet"

---Area, perimeter, centroid, second moments and box. The perimeter of a region counts its boundaries with others.
---@param region? integer (index from 1) the region. Default: all the material
---@return bw.OutlineMeasures measures exact for lines and cubic curves, by Green's theorem
function Outline:measure(region) end

---Measures of a region, or of all the material.
---@class bw.OutlineMeasures
---@field area number (m2) without holes
---@field perimeter number (m) the length of its boundary
---@field centroid number[] (m, {x, y}) the centroid
---@field second_moment bw.OutlineSecondMoment second moments of area
---@field box bw.OutlineBox the smallest box along the axes

---A loop as a list that `bw.outline` takes.
---@param loop string|integer (index from 1) a loop by name or number
---@return bw.OutlineLoop loop with name, region (nil of a hole) and tags
function Outline:loop(loop) end

---What an edge is.
---@param edge integer (index from 1) the edge
---@return bw.OutlineEdge edge its data
function Outline:edge(edge) end

---What an edge is.
---@class bw.OutlineEdge
---@field tag string its tag
---@field loop string the name of its loop
---@field from number[] (m, {x, y}) its start
---@field to number[] (m, {x, y}) its end
---@field control? number[][] (m, 2 × 2, per control point) the control points of a curve; nil of a line
---@field length number (m) its length
---@field box bw.OutlineBox the smallest box that holds the edge

---The place at a parameter of an edge, and its derivative.
---@param edge integer (index from 1) the edge
---@param t number (-) the parameter: 0 at the start, 1 at the end
---@return number[] place (m, {x, y}) the place
---@return number[] derivative (m, {x, y}) its derivative by t
function Outline:at(edge, t) end

---The place of the outline that is nearest to a point.
---@param at number[] (m, {x, y}) the point
---@return bw.OutlinePlace place the nearest place
function Outline:nearest(at) end

---A place on an outline.
---@class bw.OutlinePlace
---@field edge integer (index from 1) the edge
---@field t number (-) the parameter on it, from 0 to 1
---@field distance number (m) from the point that was given
---@field at number[] (m, {x, y}) the place
---@field loop string the name of the edge's loop
---@field vertex integer (index from 1) the end of the edge that is nearer to the point

---The distance of a point from an edge.
---@param edge integer (index from 1) the edge
---@param at number[] (m, {x, y}) the point
---@return number distance (m) the smallest distance
function Outline:edge_distance(edge, at) end

---The loops as polygons.
---
---Errors: limit (the tolerance asks for too many points).
---@param tolerance? number (m) the largest distance from the curves, above 0. Default: 1e-4 times the diagonal of the box
---@return bw.Array[]? polygons (m, n × 2, per point) an array for every loop, without the closing point
---@return string? message
---@return bw.Details? details
function Outline:polygons(tolerance) end

---Frees its memory at once.
function Outline:close() end
