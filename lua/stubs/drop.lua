---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Drop
--
-- A part that falls on a rigid plane, in time. Random drops without time, onto a peg, are the drop test.

---How a part is dropped.
---@class bw.DropOptions
---@field height? number (m) of the fall until it touches. Range: 0 or more. Default: 1
---@field speed? number (m/s) along `down` when it touches, in place of the height. Range: 0 or more. Default: by the height
---@field gravity? number (m/s2) along `down`. Range: 0 or more. Default: 9.80665
---@field down? bw.Vector (-) where it falls, of any length. Default: {0, 0, -1}
---@field spin? bw.Vector (rad/s) angular velocity when it touches. Default: none
---@field onto? bw.RigidSurface a plane, which the part meets along `down` wherever it is. Default: a plane across `down`
---@field damping? bw.Damping by a ratio and by stiffness. Default: none
---@field modes? bw.Modes elastic modes of the part. All of a mesh are refused: contact needs what they leave. Default: the lowest 40, or half of those of a small mesh
---@field impacts? integer (count) that are followed. One is over when no force has acted for a period of the lowest mode. Range: 1 to 10000. Default: 1
---@field time? number (s) at which it ends at the latest. Range: 0 or more. Default: 0, no limit
---@field tolerance? number (-) error of the energy over the kinetic energy at the first touch, for which steps are halved. Range: above 0. Default: 1e-3
---@field samples? integer (count) of the stress in each impact, at least; twice as many at most. Range: 0 to 100000. Default: 100; 0: no stress

---A drop. It does not change. Time is 0 at the first touch. `print` shows the first impact, the largest stress and the balance of
---energy, and says what is assumed.
---```lua
---local mesh = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {1, 1, 1}}
---local drop = assert(bw.model({mesh = mesh, material = bw.material.pla}):drop {down = {-1, -2, -3}})
---print(drop.impacts[1].duration, drop.forces:max(), drop.energy_error)
---```
---@class bw.Drop
---@field times bw.Array (s, n) of the history: at most 2048 for each impact and each flight
---@field forces bw.Array (N, n) of the contact
---@field motion_energy bw.Array (J, n) kinetic energy of the motion as a rigid body
---@field vibration_energy bw.Array (J, n) kinetic energy of the modes
---@field strain_energy bw.Array (J, n) strain energy, that of the contact included
---@field potential_energy bw.Array (J, n) of the weight, 0 at the first touch
---@field damping_energy bw.Array (J, n) taken by damping until then
---@field initial_energy number (J) kinetic energy at the first touch
---@field energy_error number (-) by which the sum of the energies changes at most, over `initial_energy`
---@field mass number (kg) of the part
---@field speed number (m/s) at the first touch
---@field impacts bw.DropImpact[] in order
---@field sample_times bw.Array (s, n) when stresses were taken
---@field sample_stresses bw.Array (Pa, n) largest principal stress of an element then, tension or compression; the mean of the element
---@field max_principal? bw.Array (Pa, element_count × 1, per element) the largest of these times
---@field utilisation? bw.Array (-, element_count × 1, per element) largest stress over strength of these times, where the strength is known
---@field peak? bw.DropPeak the largest stress of all; the fields from here are nil without samples
---@field displacement? bw.Array (m, node_count × 3, per node) of the deformation at the peak, in the frame that moves with the part
---@field velocity number[] (m/s, 3) of the centre of mass at the end
---@field spin number[] (rad/s, 3) angular velocity at the end
---@field step_length number (s) of the shortest steps
---@field steps integer (count) of them, also those that were repeated
---@field solves integer (count) right-hand sides solved for, one for each node that may touch
---@field mesh bw.Mesh of the part
---@field modes bw.Modes that were taken
local Drop = {}

---One impact.
---@class bw.DropImpact
---@field time number (s) of the first force
---@field duration number (s) from the first force to the last
---@field force number (N) the largest force of the contact
---@field force_time number (s) when that is
---@field impulse number (N s) of the contact, along the normal of the plane
---@field area number (m2) the largest area of facets around nodes in contact, seen along the force: known to within one element around the contact
---@field turn number (rad) by which the part turns from the first force to the last
---@field place number[] (m, 3) of the node that touches first, in the mesh
---@field contacts integer (count) of nodes that may touch

---The largest stress of a drop.
---@class bw.DropPeak
---@field stress number (Pa) largest principal stress, tension or compression
---@field time number (s) when
---@field element integer (index from 1) where
---@field place number[] (m, 3) the centre of the element, in the mesh

---Writes the largest stress over time, the utilisation and the deformation at the peak to a .vtu file. Other endings of
---`mesh:write` work, too. A drop without samples raises.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function Drop:write(path) end

---Writes times, force and energies as columns of a CSV file.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function Drop:write_history(path) end

---Draws the largest stress over time as a PNG file. A drop without samples raises.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Drop:picture(path, options) end

---Releases its memory at once.
function Drop:close() end
