---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Shapes
--
-- Bodies as signed distance functions. `bw.surface.implicit` makes a surface of one.

---Bodies as functions `f(x, y, z)` of three coordinates in m. Their value is the distance to the surface in m,
---negative inside. `join` and `cut` give bounds of the distance, with the same sign.
---@class bw.ShapesModule
local shapes = {}

---A ball.
---```lua
---local ball = bw.shapes.sphere({0, 0, 0}, 0.01)
---print(ball(0, 0, 0), ball(0.02, 0, 0)) -- -0.01 0.01
---```
---@param centre bw.Vector (m) the centre
---@param radius number (m) the radius
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.sphere(centre, radius) end

---A rod with round ends, whose radius changes linearly from one end to the other.
---```lua
---local rod = bw.shapes.limb({0, 0, 0}, {0.1, 0, 0}, 0.01, 0.005)
---local surface = assert(bw.surface.implicit(rod, {min = {-0.02, -0.02, -0.02}, max = {0.12, 0.02, 0.02}}))
---print(surface.volume)
---```
---@param a bw.Vector (m) the centre of the first end
---@param b bw.Vector (m) the centre of the second end
---@param ra number (m) the radius at `a`
---@param rb? number (m) the radius at `b`. Default: `ra`
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.limb(a, b, ra, rb) end

---A box along the axes.
---```lua
---local box = bw.shapes.box({0, 0, 0}, {0.1, 0.02, 0.02})
---print(box(0.05, 0.01, 0.01)) -- -0.01
---```
---@param min bw.Vector (m) the corner with the smallest coordinates
---@param max bw.Vector (m) the corner with the largest coordinates
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.box(min, max) end

---The union of bodies. Fillets of about the size `rounding` smooth the edges where they meet. Where faces
---of two bodies coincide, the rounding moves them outwards by a quarter of it.
---```lua
---local foot = bw.shapes.box({-0.02, -0.02, 0}, {0.02, 0.02, 0.005})
---local post = bw.shapes.limb({0, 0, 0}, {0, 0, 0.06}, 0.006)
---local body = bw.shapes.join({foot, post}, 0.004)
---print(body(0, 0, 0.03) < 0) -- true
---```
---@param bodies (fun(x: number, y: number, z: number): number)[] one body or more
---@param rounding? number (m) how far from both surfaces the fillet begins. Default: 0, sharp edges
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.join(bodies, rounding) end

---A body without the part that lies inside of another one.
---```lua
---local plate = bw.shapes.box({-0.03, -0.03, 0}, {0.03, 0.03, 0.005})
---local drill = bw.shapes.limb({0, 0, -0.01}, {0, 0, 0.02}, 0.008)
---local body = bw.shapes.cut(plate, drill)
---print(body(0, 0, 0.002) > 0) -- true
---```
---@param body fun(x: number, y: number, z: number): number what is cut
---@param tool fun(x: number, y: number, z: number): number what is taken away
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.cut(body, tool) end

---A toy foal that stands on the plane z = 0: a thick body, thin legs, a thin tail. It is about 80 mm long.
---```lua
---local body, min, max = bw.shapes.foal()
---local foal = assert(bw.surface.implicit(body, {min = min, max = max, cells = 40}))
---print(foal)
---```
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
---@return bw.Vector min (m) a corner of a box that holds it
---@return bw.Vector max (m) the opposite corner
function shapes.foal() end

---A bottle opener, about 85 mm long and 34 mm wide, flat in z.
---```lua
---local body, min, max = bw.shapes.opener()
---local opener = assert(bw.surface.implicit(body, {min = min, max = max, cells = 40}))
---print(opener)
---```
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
---@return bw.Vector min (m) a corner of a box that holds it
---@return bw.Vector max (m) the opposite corner
function shapes.opener() end
