---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Outlines
--
-- Shapes in the plane, bounded by lines and cubic curves.

---Making and reading outlines; called, it makes one from loops.
---@class bw.OutlineModule
---@overload fun(options: table): bw.Outline?, string?, bw.Details?
local outline_module = {}

---An outline from loops: `bw.outline{points = loop, holes = {loops}, regions = {loops}}`, or from one loop
---alone. A loop is a list: {x, y} is a vertex that a line leads to, {{x, y}, {x, y}, {x, y}} one that
---a cubic Bézier curve leads to, with its two control points first; the first entry's line or curve
---comes from the last vertex. Beside its entries a loop may have `name`, `tag` (of its edges; default:
---its name, else "boundary"), `tags` ({name = edge numbers}) and `region` (a number from 1). A hole or
---a region may also be an outline of one loop. Edge n leads from vertex n to the next one; edges and
---vertices are numbered through all loops. Outer loops run counter-clockwise and holes clockwise: a
---list given the other way is turned, and begins at the same point.
---Whatever makes an outline returns nil, message, details when it would cross or touch itself
---(details: segment, other_segment, x, y), and the outline that was there stays as it was.
---@param options table
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function outline_module:__call(options) end

---Edges: 1 below, 2 right, 3 above, 4 left; with rounded corners each arc is two edges of its own.
---@param options bw.OutlineRectangleOptions
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function outline_module.rectangle(options) end

---@class bw.OutlineRectangleOptions
---@field low? number[]
---@field high? number[]
---@field width? number
---@field height? number
---@field centre? number[]
---@field radius? number
---@field name? string
---@field tag? string
---@field tags? table
---@field holes? table
---@field regions? table

---Eight curves, off the circle by 4e-6 radii at most.
---@param options bw.OutlineCircleOptions
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function outline_module.circle(options) end

---@class bw.OutlineCircleOptions
---@field radius number
---@field centre? number[]
---@field name? string
---@field tag? string
---@field tags? table
---@field holes? table
---@field regions? table

---@param options bw.OutlineEllipseOptions angle in degrees
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function outline_module.ellipse(options) end

---@class bw.OutlineEllipseOptions
---@field radii number[]
---@field centre? number[]
---@field angle? number
---@field name? string
---@field tag? string
---@field tags? table
---@field holes? table
---@field regions? table

---@param options table {points = {{x, y}, ...}, name, tag, tags, holes, regions}, or the list of points
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function outline_module.polygon(options) end

---A polygon whose corners are arcs. Edges are numbered as they come: the arc of corner 1, the edge
---behind it, the arc of corner 2, ...
---@param options table {points = {{x, y}, ...}, radius = one, or a list of one for each corner, name, tag, tags, holes, regions}
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function outline_module.rounded(options) end

---Reads an SVG or DXF drawing: closed curves, and open ones that close when put together. Loops inside
---an even number of others are material (region 1), the rest holes. Names are the id (SVG), tags the
---class (SVG) or layer (DXF). `unit`: "mm", ... or metres per unit, left out: what the file says;
---`tolerance`: how far apart ends may lie that belong together, left out: 1e-5 of the size.
---@param path string
---@param options? bw.OutlineReadOptions
---@return bw.Outline?
---@return table|string info {format, skipped}, or the message
---@return bw.Details? details
function outline_module.read(path, options) end

---@class bw.OutlineReadOptions
---@field unit? string|number
---@field tolerance? number

---A shape in the plane with holes and regions, bounded by lines and cubic curves; never changed: what
---changes it gives a new one, or nil, message, details.
---@class bw.Outline
---@field area number m2, of the material: without holes
---@field perimeter number m, of the material; boundaries between regions not counted
---@field centroid number[]
---@field second_moment table {xx = integral of y^2, yy = of x^2, xy} about the centroid, m4
---@field box table {low, high}
---@field area_gradient bw.Array of every point: how the area grows with x and y
---@field points bw.Array x, y of vertices and control points, m
---@field vertices bw.Array x, y of the vertices in the order of their edges
---@field segments bw.Array of every edge: start, first control, second control, end (rows of points; controls 0 for a line), tag
---@field loops table[] {name, hole, region, first, count, parent}: `first` is its first edge
---@field tags string[]
---@field edge_count integer
---@field region_count integer
local Outline = {}

---Writes it for cutters, in millimetres: .svg or .dxf (AutoCAD 2000; layers are tags). SVG comes back
---with names, regions and tags, both with the same curves.
---@param path string
---@return true?
---@return string? message
---@return bw.Details? details
function Outline:write(path) end

---A picture as PNG: regions, edges coloured by tag, with `numbers` those of the edges.
---@param path string
---@param options? bw.OutlinePictureOptions 1200 x 900
---@return true?
---@return string? message
---@return bw.Details? details
function Outline:picture(path, options) end

---@class bw.OutlinePictureOptions
---@field width? integer
---@field height? integer
---@field numbers? boolean

---Moves a handle: {vertex = n} (with the control points beside it), {edge = n}, {loop = name} with the
---loops inside it, or {edge = n, control = 1 or 2}: a control point alone. With a loop beside them,
---vertex and edge count from that loop's first.
---@param handle bw.OutlineHandle
---@param by number[]
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:moved(handle, by) end

---@class bw.OutlineHandle
---@field vertex? integer
---@field edge? integer
---@field loop? string|integer
---@field control? integer

---How far each point goes with a handle, 0 to 1.
---@param handle bw.OutlineHandle
---@return bw.Array
function Outline:weights(handle) end

---The same edges with other points, rows as in `points`.
---@param points bw.Array|table
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:with_points(points) end

---Whether one was made from the other by moving points.
---@param other bw.Outline
---@return boolean
function Outline:same_topology(other) end

---A hole more.
---@param loop table|bw.Outline a loop as a list, or an outline of one loop
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:hole(loop) end

---A region more: a new one, or that of the loop's `region`.
---@param loop table|bw.Outline
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:region(loop) end

---A loop more, as the engine takes it: points, rows of `segments` from 1, {count, region (0: a hole), name}.
---@param points table|bw.Array
---@param segments table|bw.Array
---@param loop bw.OutlineLoopHeader
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:with_loop(points, segments, loop) end

---@class bw.OutlineLoopHeader
---@field count integer
---@field region integer
---@field name? string

---Without a loop and all that lies in it.
---@param loop string|integer
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:without(loop) end

---Laplacian smoothing of one loop or all: every point goes `strength` (0.5) of the way to the middle
---of its neighbours, `rounds` (1) times. Corners of more than `corner` (30) degrees stay.
---@param options? bw.OutlineSmoothOptions
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:smooth(options) end

---@class bw.OutlineSmoothOptions
---@field loop? string|integer
---@field strength? number
---@field rounds? integer
---@field corner? number

---Pulls a vertex to a place. Pinned vertices stay, and the curve between, up to the first vertex
---`reach` away along it, follows as rigidly as possible (Igarashi 2005). Without pins and reach the
---loop moves as a whole; about a single pin it turns.
---@param vertex integer
---@param to number[]
---@param options? bw.OutlinePullOptions
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:pull(vertex, to, options) end

---@class bw.OutlinePullOptions
---@field pins? integer[]
---@field reach? number

---An edge cut in two at t, 0 to 1.
---@param edge integer
---@param t? number default 0.5
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:split(edge, t) end

---A vertex taken out: one edge remains of the two.
---@param vertex integer
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:join(vertex) end

---The numbers of edges: {edges = numbers}, {near = {x, y}, radius = r} (without a radius: the nearest),
---{box = {{x, y}, {x, y}}} (wholly inside), {loop = name}, a number, or a list. None raises.
---@param which table|integer
---@return integer[]
function Outline:edges(which) end

---A tag on the edges that `edges` finds.
---@param name string
---@param which table|integer
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:tag(name, which) end

---A tag on edges by number.
---@param name string
---@param edges integer[]
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:with_tag(name, edges) end

---Moved as a whole.
---@param by number[]
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:shifted(by) end

---Turned by degrees, counter-clockwise, about a point, left out: the centroid.
---@param degrees number
---@param about? number[]
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:turned(degrees, about) end

---Scaled by a factor, or by {fx, fy}, about a point, left out: the centroid.
---@param factor number|number[]
---@param about? number[]
---@return bw.Outline?
---@return string? message
---@return bw.Details? details
function Outline:scaled(factor, about) end

---{area, perimeter, centroid, second_moment, box} of a region, left out: of all the material. The
---perimeter of a region counts its boundaries with others.
---@param region? integer
---@return table
function Outline:measure(region) end

---A loop as a list that bw.outline takes, with name, region (none: a hole) and tags.
---@param loop string|integer
---@return table
function Outline:loop(loop) end

---{tag, loop, from, to, control (of a curve), length, box}.
---@param edge integer
---@return table
function Outline:edge(edge) end

---The place at t, 0 to 1, of an edge, and its derivative by t.
---@param edge integer
---@param t number
---@return number[] place
---@return number[] derivative
function Outline:at(edge, t) end

---The nearest place: {edge, t, distance, at, loop, vertex (the nearer end of the edge)}.
---@param at number[]
---@return table
function Outline:nearest(at) end

---How far an edge is from a point.
---@param edge integer
---@param at number[]
---@return number
function Outline:edge_distance(edge, at) end

---The loops as polygons, one array of points each, nowhere farther than the tolerance from the curves.
---@param tolerance? number default: 1e-4 of the size
---@return bw.Array[]?
---@return string? message
---@return bw.Details? details
function Outline:polygons(tolerance) end

---Releases it at once.
function Outline:close() end
