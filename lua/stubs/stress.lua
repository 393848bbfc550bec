---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Stress fields
--
-- Stresses of a displacement, and scalars of stress tensors.

---@class bw
local bw = {}

---Mean stress of every element under a displacement: a row of six for each.
---@param mesh bw.Mesh
---@param material bw.Material
---@param displacement bw.Array
---@return bw.Array?
function bw.element_stress(mesh, material, displacement) end

---Stress at every node, averaged over the elements around it by volume.
---@param mesh bw.Mesh
---@param material bw.Material
---@param displacement bw.Array
---@return bw.Array?
function bw.nodal_stress(mesh, material, displacement) end

---Stress at the corners of the boundary's facets, three rows of six for each facet: from the displacement of the
---facet's own nodes and the traction on it. At a re-entrant edge it depends on the mesh far less than stresses at nodes.
---What supports push back is no part of the traction (docs/theory/breaking_force.md).
---`bw.surface_mean(mesh, bw.surface_stress(mesh, steel, static.displacement, static.force), 2e-3, static)`
---@param mesh bw.Mesh
---@param material bw.Material
---@param displacement bw.Array m, a row for every node; thermal expansion is not taken off
---@param force? bw.Array N, a row for every node: the load whose traction acts; default none
---@return bw.Array? stress Pa, rows 3 f - 2 to 3 f for facet f, in the order of its corners
---@return string? message
---@return bw.Details? details
function bw.surface_stress(mesh, material, displacement, force) end

---The mean of a field of facets' corners over the boundary that connected facets reach within `radius` of each
---boundary node, weighted by area and 1 - (distance / radius)^2: a nonlocal measure that has a limit under refinement
---where a stress has none. Where the mesh is coarser than the radius, the mean by area over the facets around the
---node. Facets that `supports` constrain in all directions do not count. 0 at inner nodes and inside of such supports.
---@param mesh bw.Mesh
---@param values bw.Array three rows for every facet, such as those of bw.surface_stress; linear between them
---@param radius number m, above 0
---@param supports? bw.Static|bw.Model|bw.System whose supports count; default none
---@return bw.Array? mean a row for every node, of as many columns
---@return string? message
---@return bw.Details? details
function bw.surface_mean(mesh, values, radius, supports) end

---Von Mises stress of rows of stress tensors.
---@param stress bw.Array
---@return bw.Array?
function bw.von_mises(stress) end

---Principal stresses, descending, of rows of stress tensors.
---@param stress bw.Array
---@return bw.Array?
function bw.principal(stress) end

---The principal stress largest in size of rows of stress tensors.
---@param stress bw.Array
---@return bw.Array?
function bw.max_principal(stress) end
