---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Fatigue
--
-- Damage by load histories: cycles by rainflow counting, a life curve, Miner's sum.

---@class bw
local bw = {}

---The cycles of a history by rainflow counting. Those that close have the count 1, what is left counts as half cycles. A value
---that is not finite raises.
---
---Errors: only those that every function may give.
---
---Source: ASTM E1049-85, section 5.4.4.
---```lua
---local cycles = bw.rainflow {-2, 1, -3, 5, -1, 3, -4, 4, -2}
---for _, cycle in ipairs(cycles:totable()) do print(("range %g, mean %g, count %g"):format(table.unpack(cycle))) end
---```
---@param history number[]|bw.Array (any, n × 1) values in their order
---@return bw.Array? cycles (any, n × 3) rows of range, mean and count
---@return string? message
---@return bw.Details? details
function bw.rainflow(history) end

---The damage of one pass of a load history, at each node, by the signed von Mises stress. The stress is the sum of static solutions
---of unit loads, each times its history. Where materials meet, the largest damage of one of them counts. Numbers outside their ranges raise, and so do histories of different lengths.
---
---Errors: io and format for a history in a file.
---
---Source: docs/theory/dynamics.md.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local static = assert(part:load {on = mesh.boundary:above("x", 0.2), force = {0, 0, 100}}:solve())
---print(bw.fatigue {loads = {{static = static, history = {0, 1, -1, 0.5, 0}}}, curve = {amplitude = 160e6, cycles = 2e6}})
---```
---@param options bw.FatigueOptions loads and life curve
---@return bw.Fatigue? fatigue the damage
---@return string? message
---@return bw.Details? details
function bw.fatigue(options) end

---A load history.
---@class bw.FatigueOptions
---@field loads bw.FatigueLoad[] loads that act together. Range: 1 to 1000
---@field curve bw.LifeCurve the life curve of the material

---A load and its history.
---@class bw.FatigueLoad
---@field static bw.Static the solution for a unit of the load, all on one mesh
---@field history number[]|bw.Array|string (-, n × 1) factors on it, as many for each load; or the path of a CSV file with the columns time and factor, whose times ascend and are those of the other files

---A life curve of fully reversed stress: N = cycles (amplitude / a)^exponent.
---@class bw.LifeCurve
---@field amplitude number (Pa) of stress, at a point of the curve. Range: above 0
---@field cycles? number (-) its life. Range: above 0. Default: 1e6
---@field exponent? number (-) of the curve. Range: 1 or more. Default: 5
---@field limit? number (Pa) smaller amplitudes do no damage. Range: 0 or more. Default: 0
---@field strength? number (Pa) of Goodman's mean stress: a mean above 0 raises the amplitude by 1 / (1 - mean / strength). Default: 0, none

---Damage by a load history.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local static = assert(part:load {on = mesh.boundary:above("x", 0.2), force = {0, 0, 100}}:solve())
---local fatigue = bw.fatigue {loads = {{static = static, history = {0, 1, 0}}}, curve = {amplitude = 160e6, strength = 400e6}}
---print(fatigue.passes, fatigue.at[1], fatigue.damage:max())
---```
---@class bw.Fatigue
---@field damage bw.Array (-, node_count × 1, per node) of one pass
---@field passes number (-) until the damage is 1 somewhere; infinite without damage, 0 where the mean stress reaches the strength
---@field node integer (index from 1) where the damage is largest
---@field at number[] (m, 3) the place of that node
---@field mesh bw.Mesh of the solutions
local Fatigue = {}

---Writes the damage to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function Fatigue:write(path, options) end

---Draws the body as a PNG file, coloured by the damage.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Fatigue:picture(path, options) end
