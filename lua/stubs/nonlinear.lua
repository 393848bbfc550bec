---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Geometrically nonlinear statics
--
-- Parts under a growing load, through large displacements and rotations, past limit points too.

---How a load grows.
---@class bw.NonlinearOptions
---@field factor? number (-) load factor at which it ends. Range: above 0. Default: 1
---@field steps? integer (count) a step changes the load factor by at most `factor` / `steps`. Range: 1 to 100000. Default: 10
---@field arc_length? boolean whether the length of a step of displacements is given in place of its load, which passes limit points. Default: false
---@field max_steps? integer (count) it ends after so many. Range: 1 to 100000. Default: 500
---@field displacement? number (m) it ends where a node has moved farther. Range: 0 or more. Default: 0, no limit
---@field tolerance? number (-) residual over load and reactions. Range: above 0, below 1. Default: 1e-8
---@field max_iterations? integer (count) of Newton's method in a step before it is cut. Range: 2 to 1000. Default: 20
---@field monitor? number[][] (m, up to 1000 points) the nodes nearest to them are monitored. Default: the node that moves most at first

---States in equilibrium under a growing load, and the last of them. It does not change. `#path` is the number of steps. `print`
---shows the last state, where it is unstable, and what is assumed. The last state takes nine numbers for each node; of the steps
---before only the figures and the monitored nodes are kept.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.01, 0.002}, cells = {20, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.2), force = {0, 0, 2}}
---local path = assert(part:nonlinear {steps = 5})
---print(path, path.von_mises:max())
---```
---@class bw.Nonlinear
---@field count integer (count) of steps
---@field factor number (-) load factor of the last state
---@field ended "factor"|"displacement"|"steps" why it ended: at the load factor or the displacement that was asked for, or after the largest number of steps
---@field factors bw.Array (-, count × 1) load factor of each step
---@field residuals bw.Array (-, count × 1) residual over load and reactions
---@field energies bw.Array (J, count × 1) strain energy; with temperatures without the part that does not depend on the displacement
---@field largest_displacements bw.Array (m, count × 1) of a node
---@field largest_strains bw.Array (-, count × 1) root of E : E of the Green-Lagrange strain E, the largest at a point of an element's quadrature; above 0.05 the law is not to be trusted there
---@field iterations bw.Array (count, count × 1) of Newton's method, those of steps that were cut too
---@field cuts bw.Array (count, count × 1) how often each step was cut
---@field negative_pivots bw.Array (count, count × 1) of the tangent: directions in which the state is unstable; 0: it is stable
---@field counted boolean whether no pivot was so small that rounding chose its sign
---@field monitors bw.Array (m, n × 3) places of the monitored nodes in the undeformed part
---@field displacement bw.Array (m, node_count × 3, per node) of the last state
---@field reaction bw.Array (N, node_count × 3, per node) of the last state, at prescribed components
---@field stress bw.Array (Pa, node_count × 6, per node) Cauchy stress of the last state xx yy zz yz zx xy, averaged as that of a static solution
---@field element_stress bw.Array (Pa, element_count × 6, per element) the same, the mean over the deformed element
---@field von_mises bw.Array (Pa, node_count × 1, per node) von Mises stress of `stress`; error unknown
---@field element_von_mises bw.Array (Pa, element_count × 1, per element) von Mises stress of `element_stress`; error unknown
---@field mesh bw.Mesh of the model, undeformed
---@field report bw.SolverReport iterations, work and memory of the factors
local Nonlinear = {}

---The displacements of a monitored node, step by step.
---@param monitor? integer (index from 1) which. Default: 1
---@return bw.Array path (m, count × 3) its displacement
function Nonlinear:path(monitor) end

---The sum of the reactions of the last state on a selection.
---@param selection bw.Selection on the mesh of the model
---@return number[] force (N, 3) the reaction
function Nonlinear:reaction_on(selection) end

---Writes the steps as CSV: load factor, displacements of the monitored nodes, largest displacement, energy, residual, iterations
---and negative pivots.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function Nonlinear:write_history(path) end

---A plot of the load factor over the displacement of a monitored node.
---@param options? bw.NonlinearFigureOptions which displacement
---@return bw.Figure figure the figure
function Nonlinear:figure(options) end

---What a plot of load factors is over.
---@class bw.NonlinearFigureOptions
---@field monitor? integer (index from 1) which monitored node. Default: 1
---@field axis? "x"|"y"|"z"|"norm" component of its displacement. Default: "norm"

---Writes displacement, reaction, Cauchy stress and von Mises stress of the last state to a .vtu file, on the undeformed mesh. Other
---endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function Nonlinear:write(path, options) end

---Draws the last state as a PNG file, deformed in its true scale and coloured by its von Mises stress.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Nonlinear:picture(path, options) end

---Releases the states at once.
function Nonlinear:close() end
