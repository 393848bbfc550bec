---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Stress fields
--
-- Stresses of a displacement, and scalars of stress tensors. Tensors are rows xx yy zz yz zx xy.

---@class bw
local bw = {}

---The mean stress of every element under a displacement.
---```lua
---local mesh = bw.mesh.box {max = {1, 1, 1}, cells = {2, 2, 2}}
---local stress = bw.element_stress(mesh, bw.material.steel, 1e-3 * mesh.nodes)
---print(stress(1, 1)) -- Pa
---```
---@param mesh bw.Mesh the mesh
---@param material bw.Material the material of all elements
---@param displacement bw.Array|number[][] (m, node_count × 3, per node) the displacement
---@return bw.Array stress (Pa, element_count × 6, per element) tensors
function bw.element_stress(mesh, material, displacement) end

---The stress at every node under a displacement: the mean over the elements around it by volume.
---```lua
---local mesh = bw.mesh.box {max = {1, 1, 1}, cells = {2, 2, 2}, order = 2}
---local stress = bw.nodal_stress(mesh, bw.material.steel, 1e-3 * mesh.nodes)
---print(stress.row_count == mesh.node_count) -- true
---```
---@param mesh bw.Mesh the mesh
---@param material bw.Material the material of all elements
---@param displacement bw.Array|number[][] (m, node_count × 3, per node) the displacement
---@return bw.Array stress (Pa, node_count × 6, per node) tensors
function bw.nodal_stress(mesh, material, displacement) end

---The stress at the corners of the boundary's facets, from the displacement of the facet's own nodes and the traction on it. At
---re-entrant edges it depends on the mesh far less than stresses at nodes. Reactions of supports are no part of the traction.
---
---Errors: only those that every function may give.
---
---Source: docs/theory/breaking_force.md.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}, order = 2}
---local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
---local static = assert(part:load({on = mesh.boundary:above("x", 0.1), force = {0, 0, -10}}):solve())
---local stress = assert(bw.surface_stress(mesh, part.material, static.displacement, static.force))
---print(bw.von_mises(stress):max())
---```
---@param mesh bw.Mesh the mesh
---@param material bw.Material the material of all elements
---@param displacement bw.Array|number[][] (m, node_count × 3, per node) the displacement; thermal expansion is not subtracted
---@param force? bw.Array|number[][] (N, node_count × 3, per node) nodal forces of the traction. Default: none
---@return bw.Array? stress (Pa, 3 facet_count × 6, per corner) rows 3 f - 2 to 3 f belong to facet f, in the order of its corners
---@return string? message
---@return bw.Details? details
function bw.surface_stress(mesh, material, displacement, force) end

---The mean of a field of facets' corners over the boundary that connected facets reach within a radius of each boundary node,
---weighted by area and 1 - (distance / radius)^2. It has a limit under refinement, where a stress may have none. Where the mesh
---is coarser than the radius, it is the mean by area over the facets around the node. Facets that supports fix in all directions
---do not count; it is 0 at inner nodes and inside of such supports.
---
---Errors: only those that every function may give.
---
---Source: docs/theory/breaking_force.md.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}, order = 2}
---local stress = assert(bw.surface_stress(mesh, bw.material.steel, 1e-3 * mesh.nodes))
---local mean = assert(bw.surface_mean(mesh, stress, 2e-3))
---print(bw.max_principal(mean):max())
---```
---@param mesh bw.Mesh the mesh
---@param values bw.Array (any, 3 facet_count × c, per corner) the field, linear between corners, such as `bw.surface_stress` gives
---@param radius number (m) above 0
---@param supports? bw.Static|bw.Model|bw.System whose supports count. Default: none
---@return bw.Array? mean (any, node_count × c, per node) its means
---@return string? message
---@return bw.Details? details
function bw.surface_mean(mesh, values, radius, supports) end

---The von Mises stress of stress tensors.
---```lua
---local stress = bw.array {{1e6, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 1e6}}
---print(bw.von_mises(stress)[2]) -- 1732050.8075689
---```
---@param stress bw.Array|number[][] (Pa, n × 6) tensors
---@return bw.Array von_mises (Pa, n × 1) one for each
function bw.von_mises(stress) end

---The principal stresses of stress tensors.
---```lua
---local stress = bw.array {{1e6, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 1e6}}
---print(bw.principal(stress)(2, 3)) -- -1000000.0
---```
---@param stress bw.Array|number[][] (Pa, n × 6) tensors
---@return bw.Array principal (Pa, n × 3) descending
function bw.principal(stress) end

---The magnitude of the principal stress of largest magnitude, of stress tensors.
---
---Source: Zhou, Panetta and Zorin 2013, equation 6.
---```lua
---local stress = bw.array {{1e6, -3e6, 0, 0, 0, 0}}
---print(bw.max_principal(stress)[1]) -- 3000000.0
---```
---@param stress bw.Array|number[][] (Pa, n × 6) tensors
---@return bw.Array largest (Pa, n × 1) one for each
function bw.max_principal(stress) end
