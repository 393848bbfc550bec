---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Drop
--
-- A part that falls on a rigid floor, edge or peg, in time, once or many times at random. Random drops without time, onto a peg, are the drop
-- test.

---@class bw
local bw = {}

---Drops a part in random attitudes on a rigid floor, edge or peg, in time, from one set of equations and modes. A part with supports or loads, or
---of a material without density or strength, raises. Cancelled on the way, it returns the drops that are done.
---
---Errors: those of `model:drop`.
---
---Source: docs/theory/drop.md.
---```lua
---local mesh = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {1, 1, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local drops = assert(bw.random_drops(part, {drops = 5}))
---print(drops, drops:failures())
---```
---@param part bw.Model without supports and loads, of a material with density and strength
---@param options? bw.RandomDropsOptions height and number of drops
---@return bw.RandomDrops? drops what happened
---@return string? message
---@return bw.Details? details
function bw.random_drops(part, options) end

---How a part is dropped at random. All directions of the fall are equally likely in the frame of the part.
---@class bw.RandomDropsOptions
---@field drops? integer (count) of drops, 1 or more. Default: 100
---@field seed? integer (seed) of the attitudes. Default: 1
---@field height? number (m) of the fall. Range: above 0. Default: 1
---@field spin? number (rad/s) size of the angular velocity when it touches; its direction is random. Range: 0 or more. Default: 0
---@field damping? bw.Damping by a ratio and by stiffness. Default: none
---@field onto? bw.RigidSurface floor, edge or peg below the centre of mass, without a place, in axes whose z is up: an edge lies in any direction of the horizontal plane. Default: a floor
---@field modes? bw.Modes elastic modes of the part. Default: as of `model:drop`
---@field impacts? integer (count) that are followed in each drop. Range: 1 to 10000. Default: 1
---@field samples? integer (count) of the stress in each impact, at least; twice as many at most. Range: 1 to 100000. Default: 20

---What happened in random drops. `print` gives the probability that the part is overloaded with its 95 % interval, what the drops
---cost, and what is assumed.
---```lua
---local mesh = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {1, 1, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local drops = assert(bw.random_drops(part, {drops = 5}))
---print(drops:correlation(assert(bw.drop_test(part, {drops = 20}))))
---```
---@class bw.RandomDrops
---@field exceedance bw.Array (-, element_count × 1, per element) fraction of drops in which it was stressed beyond the strength. Within an element of a touching node this depends on the mesh
---@field mean_peak bw.Array (Pa, element_count × 1, per element) mean over the drops of its largest principal stress over time
---@field peaks bw.Array (Pa, drops × 1, per drop) largest principal stress of any element
---@field risks bw.Array (-, drops × 1, per drop) largest stress over strength
---@field forces bw.Array (N, drops × 1, per drop) largest force of the first impact
---@field durations bw.Array (s, drops × 1, per drop) of the first impact
---@field directions bw.Array (-, drops × 3, per drop) unit vector of the fall in the frame of the part
---@field energy_error number (-) the largest of all drops, as of `bw.Drop`
---@field furthest_turn number (rad) by which a normal turned in the part in a first impact, at most
---@field drops integer (count) of drops that were done
---@field stopped? "cancelled" where it was cancelled behind the first drop that hits: all figures are of the drops until then
---@field misses integer (count) of drops that miss the obstacle, such as a peg in a hole: they have no stress and do no harm
---@field solves integer (count) right-hand sides solved for
---@field seconds number (s) in all
---@field first_seconds? number (s) until the first drop was done: with the factor and the modes; nil where `modes` were given
---@field modes bw.Modes that all drops took
---@field mesh bw.Mesh of the part
---@field options bw.RandomDropsOptions as they were given, with defaults
local RandomDrops = {}

---Spearman's rank correlation of `mean_peak` with a weakness, weighted by volume.
---@param other bw.WorstCase|bw.DropTest|bw.BruteForce|bw.Array (Pa, element_count × 1, per element) the weakness
---@return number rho (-) from -1 to 1
function RandomDrops:correlation(other) end

---The fraction of drops that overload some element, and Wilson's 95 % interval of the probability that it estimates.
---
---The interval has the error of sampling alone. Elements within one of a touching node count, and their stress depends on the mesh.
---@return number fraction (-) from 0 to 1
---@return number low (-) the lower end
---@return number high (-) the upper end
function RandomDrops:failures() end

---Wilson's 95 % interval of the probability that a drop overloads each element.
---@return bw.Array low (-, element_count × 1, per element) the lower ends
---@return bw.Array high (-, element_count × 1, per element) the upper ends
function RandomDrops:interval() end

---Writes `exceedance`, its interval and `mean_peak` to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function RandomDrops:write(path) end

---Draws `exceedance` as a PNG file.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function RandomDrops:picture(path, options) end

---How a part is dropped.
---@class bw.DropOptions
---@field height? number (m) of the fall until it touches. Range: 0 or more. Default: 1
---@field speed? number (m/s) along `down` when it touches, in place of the height. Both raise. Range: 0 or more. Default: by the height
---@field gravity? number (m/s2) along `down`. Range: 0 or more. Default: 9.80665
---@field down? bw.Vector (-) where it falls, of any length. Default: {0, 0, -1}
---@field spin? bw.Vector (rad/s) angular velocity when it touches. Default: none
---@field onto? bw.RigidSurface floor (plane), peg (sphere) or edge (cylinder), which the part meets from outside, along `down`. One without a place is below the centre of mass. Its radius rounds the tip or edge: at a sharp one, the stress is infinite. Default: a plane across `down`
---@field damping? bw.Damping by a ratio and by stiffness. Default: none
---@field modes? bw.Modes elastic modes of the part. All of a mesh are refused: contact needs what they leave. Default: the lowest 40, or half of those of a small mesh
---@field impacts? integer (count) that are followed. One is over when no force has acted for a period of the lowest mode. Range: 1 to 10000. Default: 1
---@field time? number (s) at which it ends at the latest. Range: 0 or more. Default: 0, no limit
---@field tolerance? number (-) error of the energy over the kinetic energy at the first touch, for which steps are halved. Range: above 0. Default: 1e-3
---@field samples? integer (count) of the stress in each impact, at least; twice as many at most. Range: 0 to 100000. Default: 100; 0: no stress
---@field history? boolean whether `peak_stresses` of the drop are computed, for six solutions. Default: true
---@field fewer? boolean whether to drop it again with half of the modes: `fewer` of the drop, and in `print`. Default: false

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
---@field onto bw.RigidSurface the obstacle, where the part of the mesh touches it
---@field obstacle_depth number (m) by which a peg or edge enters between nodes at the first touch, since nodes alone touch; at most a tenth of its radius
---@field impacts bw.DropImpact[] in order
---@field sample_times bw.Array (s, n) when stresses were taken
---@field sample_stresses bw.Array (Pa, n) largest principal stress of an element then, tension or compression; the mean of the element
---@field peak_stresses? bw.Array (Pa, n) largest principal stress then of the element of `peak`: the history where it peaks, with the errors of the peak; nil without samples or `history`
---@field max_principal? bw.Array (Pa, element_count × 1, per element) the largest of these times
---@field utilisation? bw.Array (-, element_count × 1, per element) largest stress over strength of these times, where the strength is known
---@field peak? bw.DropPeak the largest stress of all; the fields from here are nil without samples
---@field displacement? bw.Array (m, node_count × 3, per node) of the deformation at the peak, in the frame that moves with the part
---@field velocity number[] (m/s, 3) of the centre of mass at the end
---@field spin number[] (rad/s, 3) angular velocity at the end
---@field step_length number (s) of the shortest steps
---@field steps integer (count) of them, also those that were repeated
---@field solves integer (count) right-hand sides: half a solution for each node that touches or lies beside, whole ones for the stress
---@field mesh bw.Mesh of the part
---@field modes bw.Modes that were taken
---@field mode_count integer (count) of the lowest of `modes` that were taken
---@field fewer? bw.Drop the same with half of the modes: what changes has an error by the modes left out; that is no bound of it. nil without the option, and where it fails
local Drop = {}

---One impact.
---@class bw.DropImpact
---@field time number (s) of the first force
---@field duration number (s) from the first force to the last
---@field force number (N) the largest force of the contact, summed over its nodes
---@field force_time number (s) when that is
---@field impulse number (N s) size of the impulse of the contact
---@field area number (m2) the largest area of facets around nodes in contact, seen along the force: known to within one element around the contact
---@field turn number (rad) by which a normal of the contact turns in the part, at most
---@field place number[] (m, 3) of the node that touches first, in the mesh
---@field contacts integer (count) of nodes that touch or come near

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

---Writes times, force, energies and `peak_stresses` as columns of a CSV file. The stress is empty at times when it was not taken.
---A time when it was taken is in the file for up to 1024 samples. Without `peak_stresses` there is no such column.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function Drop:write_history(path) end

---Draws the largest stress over time as a PNG file, and what the part falls on as lines. A drop without samples raises.
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
