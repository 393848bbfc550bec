---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Shapes
--
-- Bodies as signed distance functions. `bw.surface.implicit` makes a surface of one.

---Bodies as functions `f(x, y, z)` of three coordinates in m. Their value is the distance to the surface in m,
---negative inside. `join`, `fillet`, `intersect` and `cut` give values whose size is that of the distance or less,
---with the same sign. A second result, which may be left out, is the name of the face that is nearest. `named` gives
---one, and all functions here pass it on. `bw.surface.implicit` gives each facet the name at its middle.
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

---A body whose surface has a name, which its facets keep into the mesh. Other names of it are replaced. A function
---names parts of the surface by their place; where it returns nil, names stay as they are.
---```lua
---local plate = bw.shapes.named(bw.shapes.box({-0.03, -0.03, 0}, {0.03, 0.03, 0.005}), "plate")
---local drill = bw.shapes.named(bw.shapes.cylinder({0, 0, -0.01}, {0, 0, 0.02}, 0.008), "bolt hole")
---local body = bw.shapes.cut(plate, drill)
---print(body(0.008, 0, 0.002)) -- 0.0 bolt hole
---```
---@param body fun(x: number, y: number, z: number): number the body
---@param name string|fun(x: number, y: number, z: number): string? of its surface, or a function that returns one
---@return fun(x: number, y: number, z: number): number, string? body the signed distance (m) at a point, and a name
function shapes.named(body, name) end

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
---@param name? string of the fillets. Default: that of the nearer body
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.join(bodies, rounding, name) end

---The union of bodies with a fillet along the concave edges where they meet. The fillet is an arc of the radius where two
---surfaces meet at a right angle, and near one elsewhere.
---```lua
---local foot = bw.shapes.box({-0.02, -0.02, 0}, {0.02, 0.02, 0.005})
---local wall = bw.shapes.box({-0.02, -0.02, 0}, {-0.015, 0.02, 0.04})
---local body = bw.shapes.fillet({foot, wall}, 0.006)
---print(body(-0.0135, 0, 0.0065) < 0) -- true
---```
---@param bodies (fun(x: number, y: number, z: number): number)[] one body or more
---@param radius number (m) of the fillet. Range: above 0
---@param name? string of the fillet. Default: that of the nearer body
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.fillet(bodies, radius, name) end

---What lies inside of all bodies. The convex edges where their surfaces meet are sharp, or rounded as by `fillet`.
---```lua
---local lens = bw.shapes.intersect {bw.shapes.sphere({-0.01, 0, 0}, 0.015), bw.shapes.sphere({0.01, 0, 0}, 0.015)}
---print(lens(0, 0, 0)) -- about -0.005
---```
---@param bodies (fun(x: number, y: number, z: number): number)[] one body or more
---@param radius? number (m) of the rounded edges. Default: 0, sharp edges
---@param name? string of the rounded edges. Default: that of the nearer body
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.intersect(bodies, radius, name) end

---A body without the part that lies inside of another one. The edges of the cut are sharp, or rounded as by `fillet`.
---```lua
---local plate = bw.shapes.box({-0.03, -0.03, 0}, {0.03, 0.03, 0.005})
---local drill = bw.shapes.cylinder({0, 0, -0.01}, {0, 0, 0.02}, 0.008)
---local body = bw.shapes.cut(plate, drill)
---print(body(0, 0, 0.002) > 0) -- true
---```
---@param body fun(x: number, y: number, z: number): number what is cut
---@param tool fun(x: number, y: number, z: number): number what is taken away
---@param radius? number (m) of the rounded edges. Default: 0, sharp edges
---@param name? string of the rounded edges. Default: that of the nearer body
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.cut(body, tool, radius, name) end

---A body whose surface is moved outwards by a distance. It is exact where the value of `body` is its distance.
---```lua
---local box = bw.shapes.offset(bw.shapes.box({0, 0, 0}, {0.1, 0.02, 0.02}), 0.002)
---print(box(0.05, 0.01, 0.021) < 0) -- true
---```
---@param body fun(x: number, y: number, z: number): number the body
---@param distance number (m) outwards; negative: inwards
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.offset(body, distance) end

---The wall of a body: what lies inside of it and within the thickness of its surface. Cut the wall to open it.
---```lua
---local wall = bw.shapes.shell(bw.shapes.sphere({0, 0, 0}, 0.02), 0.002)
---print(wall(0, 0, 0) > 0, wall(0.019, 0, 0) < 0) -- true true
---```
---@param body fun(x: number, y: number, z: number): number the body whose surface is the outer one
---@param thickness number (m) of the wall. Range: above 0
---@param name? string of the inner side of the wall. Default: none
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.shell(body, thickness, name) end

---A cylinder with flat ends.
---```lua
---local rod = bw.shapes.cylinder({0, 0, 0}, {0.1, 0, 0}, 0.01)
---print(rod(0.05, 0, 0), rod(0.12, 0, 0)) -- -0.01 0.02
---```
---@param a bw.Vector (m) the centre of the first end
---@param b bw.Vector (m) the centre of the second end
---@param radius number (m) of the cylinder. Range: above 0
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.cylinder(a, b, radius) end

---A cone or truncated cone with flat ends.
---```lua
---local cone = bw.shapes.cone({0, 0, 0}, {0, 0, 0.03}, 0.01, 0)
---print(cone(0, 0, 0.01) < 0, cone(0.009, 0, 0.02) > 0) -- true true
---```
---@param a bw.Vector (m) the centre of the first end
---@param b bw.Vector (m) the centre of the second end
---@param ra number (m) the radius at `a`. Range: 0 or above
---@param rb number (m) the radius at `b`. Range: 0 or above, not both 0
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.cone(a, b, ra, rb) end

---A torus.
---```lua
---local ring = bw.shapes.torus({0, 0, 0}, {0, 0, 1}, 0.02, 0.003)
---print(ring(0.02, 0, 0)) -- -0.003
---```
---@param centre bw.Vector (m) the centre
---@param axis bw.Vector (any) along the axis, of any length
---@param radius number (m) of the circle that the centre of the tube follows. Range: above 0
---@param tube number (m) radius of the tube. Range: above 0
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.torus(centre, axis, radius, tube) end

---A body at another place.
---```lua
---local ball = bw.shapes.translate(bw.shapes.sphere({0, 0, 0}, 0.01), {0.05, 0, 0})
---print(ball(0.05, 0, 0)) -- -0.01
---```
---@param body fun(x: number, y: number, z: number): number the body
---@param by bw.Vector (m) the displacement
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.translate(body, by) end

---A body rotated about an axis, by the right-hand rule.
---```lua
---local rod = bw.shapes.cylinder({0, 0, 0}, {0.1, 0, 0}, 0.01)
---local up = bw.shapes.rotate(rod, {0, 1, 0}, -math.pi / 2)
---print(up(0, 0, 0.05) < 0) -- true
---```
---@param body fun(x: number, y: number, z: number): number the body
---@param axis bw.Vector (any) along the axis, of any length
---@param angle number (rad) of the rotation
---@param about? bw.Vector (m) a point of the axis. Default: {0, 0, 0}
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.rotate(body, axis, angle, about) end

---The mirror image of a body in a plane.
---```lua
---local left = bw.shapes.sphere({0.03, 0, 0}, 0.01)
---local both = bw.shapes.join {left, bw.shapes.mirror(left, {1, 0, 0})}
---print(both(-0.03, 0, 0)) -- -0.01
---```
---@param body fun(x: number, y: number, z: number): number the body
---@param normal bw.Vector (any) normal to the plane, of any length
---@param point? bw.Vector (m) a point of the plane. Default: {0, 0, 0}
---@return fun(x: number, y: number, z: number): number body the signed distance (m) at a point
function shapes.mirror(body, normal, point) end

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
