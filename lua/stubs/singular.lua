---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Singular places
--
-- Places where linear elasticity has no finite stress.

---@class bw.SingularPlace
---@field kind "re-entrant edge"|"border of a support"|"line load"|"line support"|"point load"|"point support"
---@field points number[][] a polyline, or one point; m
---@field inward number[][] of each point: the bisector into the material, unit
---@field length number m
---@field angle? number inside the material, radians: the mean along the edge
---@field least_angle? number
---@field largest_angle? number
---@field exponent number Williams' lambda: displacements go like r^lambda with the distance r
---@field growth number 1 - lambda: the stress grows like h^-growth with the edge length h of elements

---Places where linear elasticity has no finite stress, as a list of bw.SingularPlace; `print(places)` shows twelve of them.
---@class bw.SingularPlaces
local SingularPlaces = {}

---The place nearest to a point, with the distance and its own nearest point; nil where none is within `radius` (m).
---@param point number[]
---@param radius? number default: any
---@return bw.NearestSingularPlace?
function SingularPlaces:near(point, radius) end

---@class bw.NearestSingularPlace
---@field place bw.SingularPlace
---@field distance number
---@field at number[]
---@field inward number[]

---A list of some of the places: `places.list {places[1], places[3]}`.
---@param chosen bw.SingularPlace[]
---@return bw.SingularPlaces
function SingularPlaces.list(chosen) end

---Why the largest stress has no finite value; `print(finding)` says it in a sentence.
---@class bw.SingularFinding
---@field by "geometry"|"growth"|"geometry and growth" a place that is known to be singular, or growth under refinement
---@field place? bw.SingularPlace
---@field at number[] m: of the place, or where the stress is largest
---@field expected? number by Williams' exponent the stress grows like h^-expected with the edge length h
---@field measured? number the growth from the last mesh but one to the last
