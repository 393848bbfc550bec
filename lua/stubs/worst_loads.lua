---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Worst loads
--
-- The steps of the worst case by themselves: weak regions, pressure bases, linear programs.

---@class bw
local bw = {}

---The steps of the worst case by themselves. First: the weak regions of modes.
---@param mesh bw.Mesh
---@param material bw.Material
---@param modes bw.Modes
---@param options? bw.WeakRegionsOptions
---@return bw.WeakRegions?
---@return string? message
---@return bw.Details? details
function bw.weak_regions(mesh, material, modes, options) end

---@class bw.WeakRegionsOptions
---@field measure? "stress"|"energy"
---@field target? "stress"|"displacement"
---@field fraction? number
---@field regions? integer

---Every element, or those given, as a region of its own, with a weight of `sign` (default 1).
---@param mesh bw.Mesh
---@param elements? bw.Array|integer[]
---@param sign? number
---@return bw.WeakRegions?
function bw.single_regions(mesh, elements, sign) end

---Pressures at the boundary corner nodes of a mesh, linear over its facets. With a `spacing` (m) they are constant on
---cells of facets instead, whose edges are at most so long, but not shorter than a sixteenth of the facet's.
---`forbidden`: no pressure on these facets; that at corner nodes falls to zero around. Raises where no surface is left. With `friction` (default 0) a node has `friction_facets` (default 8) columns,
---which pull the surface along in so many directions; its pressure is their sum.
---@param mesh bw.Mesh
---@param options? bw.PressureBasisOptions
---@return bw.PressureBasis?
function bw.pressure_basis(mesh, options) end

---@class bw.PressureBasisOptions
---@field forbidden? bw.Selection
---@field spacing? number
---@field friction? number
---@field friction_facets? integer

---The worst load of every region and the stresses under it: arrays peaks, peak_elements,
---utilisations, utilised_elements, displacements, objectives, seconds, flipped (of regions), weakness,
---worst_region (of elements), pressures (regions x columns of the basis); peak_stresses and own_stresses: of
---every region six components of the stress where it is largest, and in the region's first element.
---`after`: results of an earlier call on the same mesh, whose regions come first in those returned.
---@param system bw.System
---@param basis bw.PressureBasis
---@param regions bw.WeakRegions
---@param options bw.WorstLoadsOptions
---@return table?
---@return string? message
---@return bw.Details? details
function bw.worst_loads(system, basis, regions, options) end

---@class bw.WorstLoadsOptions
---@field pressure number
---@field force number
---@field at_most? boolean
---@field hands? integer
---@field hand_area? number
---@field one_sign? boolean
---@field batch? integer
---@field keep_pressures? boolean
---@field glpk? boolean
---@field after? table

---Weak regions of modes. `#regions`, `regions[i]` {mode, rank, count, volume, energy, peak}.
---@class bw.WeakRegions
---@field count integer
---@field mesh bw.Mesh
local WeakRegions = {}

---@param i integer
---@return bw.Array
function WeakRegions:elements(i) end

---@param i integer
---@return bw.Array
function WeakRegions:weights(i) end

---Forces whose displacement q gives the region's objective, basis:gradient(q): (15) of the paper.
---@param i integer
---@param material bw.Material
---@return bw.Array?
function WeakRegions:objective(i, material) end

---Lets go at once.
function WeakRegions:close() end

---Pressures at boundary corner nodes, linear over facets, or constant on cells of facets.
---@class bw.PressureBasis
---@field nodes bw.Array mesh node of each pressure; of a cell, the node of its facet nearest to its middle
---@field areas bw.Array m2
---@field count integer columns
---@field directions integer columns of a node, one after the other: 1 without friction
local PressureBasis = {}

---Nodal forces of a pressure.
---@param pressure bw.Array
---@return bw.Array
function PressureBasis:force(pressure) end

---The change of the work of the forces on displacements q with each pressure.
---@param q bw.Array
---@return bw.Array
function PressureBasis:gradient(q) end

---The pressure of an allowed load (0 to `pressure`, total `force`, balanced) that makes
---objective . pressure largest, and that value.
---@param system bw.System
---@param objective bw.Array
---@param options bw.PressureBasisMaximiseOptions
---@return bw.Array? pressure
---@return number|string value or message
---@return bw.Details? details
function PressureBasis:maximise(system, objective, options) end

---@class bw.PressureBasisMaximiseOptions
---@field pressure number
---@field force number
---@field at_most? boolean
---@field hands? integer
---@field hand_area? number

---The pressure at every mesh node: the sum of its columns; where it stands for several cells, their mean by area; 0
---where it has none.
---@param pressure bw.Array
---@return bw.Array
function PressureBasis:nodal(pressure) end

---The forces of a pressure summed into a few arrows {at, force, area}, largest first.
---@param pressure bw.Array
---@param radius? number
---@return table[]?
function PressureBasis:arrows(pressure, radius) end

---Lets go at once.
function PressureBasis:close() end
