---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Singular places
--
-- Places where linear elasticity has no finite stress: re-entrant edges, borders of supports, loads and supports at points and
-- along lines. `surface:singular_edges()` and `model:singular_places()` find them. The theory is in docs/theory/singular.md.

---A place where the stress has no finite value.
---@class bw.SingularPlace
---@field kind "re-entrant edge"|"border of a support"|"border of a rigid coupling"|"end of a bond"|"line load"|"line support"|"point load"|"point support" what it is
---@field points bw.Vector[] (m, n) a polyline, or one point
---@field inward bw.Vector[] (-, n, per point) the bisector into the material, unit
---@field length number (m) of the polyline; 0 of a point
---@field angle? number (rad) inside the material, the mean along an edge
---@field min_angle? number (rad) the smallest along the edge
---@field largest_angle? number (rad) the largest along the edge
---@field exponent number (-) Williams' lambda: displacements go like r^lambda with the distance r
---@field growth number (-) 1 - lambda: the stress grows like h^-growth with the edge length h of elements

---A list of singular places, in the order of the function that found them. `print` shows twelve of them.
---```lua
---local step = assert(bw.grid.box {size = {0.04, 0.02, 0.02}, cells = {4, 2, 2}, material = "x < 0.02 or z < 0.01"})
---local places = assert(step:surface():singular_edges())
---print(places, #places)
---```
---@class bw.SingularPlaces
local SingularPlaces = {}

---The place nearest to a point; nil where none is within the radius. Of places as near as each other, the one of the fastest
---growth.
---@param point bw.Vector (m) the point, a table of three numbers
---@param radius? number (m) the largest distance. Default: any
---@return bw.NearestSingularPlace? nearest the place, or nil
function SingularPlaces:near(point, radius) end

---The singular place nearest to a point.
---@class bw.NearestSingularPlace
---@field place bw.SingularPlace the place
---@field distance number (m) from the point
---@field at bw.Vector (m) the nearest point of the place
---@field inward bw.Vector (-) the bisector there, unit

---A list of some places: `places.list {places[1], places[3]}`. Other tables than places that were found raise.
---@param chosen bw.SingularPlace[] the places
---@return bw.SingularPlaces places the list
function SingularPlaces.list(chosen) end

---Why a largest stress has no finite value. `print` shows it in a sentence.
---@class bw.SingularFinding
---@field by "geometry"|"growth"|"geometry and growth" a place that is known to be singular, growth under refinement, or both
---@field place? bw.SingularPlace the place that is known
---@field at bw.Vector (m) of the place, or where the stress is largest
---@field expected? number (-) by Williams' exponent the stress grows like h^-expected with the edge length h
---@field measured? number (-) the exponent of the growth from the last mesh but one to the last
