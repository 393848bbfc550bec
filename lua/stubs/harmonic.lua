---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Harmonic response
--
-- How a part answers loads, or an acceleration of its supports, that vary harmonically in time.

---The answer to loads F cos(2 pi f t): displacements Re(u e^(2 pi i f t)) with a real and an imaginary part, relative to the
---supports. Known at every frequency up to the highest that was asked for.
---Linear theory: small displacements, one phase of all loads.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.2), force = {0, 0, 10}}
---local response = assert(part:harmonic {range = {0, 500}, damping = {ratio = 0.01}})
---print(response, response:curve {at = {0.2, 0.01, 0.005}})
---```
---@class bw.Harmonic
---@field frequencies bw.Array (Hz, n × 1) those asked for, ascending; of a range even steps, and more where the response is sharp
---@field errors bw.Array (-, n × 1) of the displacement at each frequency, over the displacement, both in energy: a bound on this mesh where the modes are counted
---@field modes bw.Modes the modes of its basis
---@field losses bw.Array (-, n × 1) loss factor of each mode: that of the damping, and those of regions by their parts of the mode's strain energy
---@field damped boolean whether anything damps it; at a natural frequency an undamped response has no limit
---@field residual_vectors integer (count) of its basis
---@field solves integer (count) right-hand sides that residual vectors took
---@field mesh bw.Mesh of the model
local Harmonic = {}

---The displacement at a frequency.
---
---Errors: singular (the frequency of a mode that nothing damps). A negative frequency raises.
---@param frequency number (Hz) 0 or more
---@return bw.Array? real (m, node_count × 3, per node) real part
---@return bw.Array|string imaginary (m, node_count × 3, per node) imaginary part, or the message
---@return bw.Details? details
function Harmonic:displacement(frequency) end

---The stress at a frequency: xx, yy, zz, yz, zx, xy. Where materials meet, that of the one with the largest von Mises stress.
---
---Errors: those of `displacement`.
---@param frequency number (Hz) 0 or more
---@return bw.Array? real (Pa, node_count × 6, per node) real part
---@return bw.Array|string imaginary (Pa, node_count × 6, per node) imaginary part, or the message
---@return bw.Details? details
function Harmonic:stress(frequency) end

---The largest von Mises stress over a period, at a frequency.
---
---Errors: those of `displacement`.
---@param frequency number (Hz) 0 or more
---@return bw.Array? von_mises (Pa, node_count × 1, per node) its amplitude
---@return string? message
---@return bw.Details? details
function Harmonic:von_mises(frequency) end

---The displacement of a node over frequencies: real parts along x, y and z, then imaginary parts.
---
---Errors: those of `displacement`.
---@param node integer (index from 1) the node
---@param frequencies? number[]|bw.Array (Hz, n × 1) 0 or more each. Default: those of the response
---@return bw.Array? response (m, n × 6) a row for each frequency
---@return string? message
---@return bw.Details? details
function Harmonic:at_node(node, frequencies) end

---The motion of the remote point of a coupling over frequencies: real parts of its displacement and rotation, then imaginary parts.
---
---Errors: those of `displacement`. A coupling that the part does not have raises.
---@param coupling integer (index from 1) the coupling
---@param frequencies? number[]|bw.Array (Hz, n × 1) 0 or more each. Default: those of the response
---@return bw.Array? response (any, n × 12) a row for each frequency, in m and rad
---@return number[]|string? at (m, 3) where the point is, or the message
---@return bw.Details? details
function Harmonic:at_coupling(coupling, frequencies) end

---The frequency response of a place, which is that of the nearest node, or of the remote point of a coupling.
---
---Errors: those of `displacement`. A coupling that the part does not have raises.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {0, 500}, base = {0, 0, 9.81}, damping = {loss = 0.02}})
---local curve = assert(shaken:curve {at = {0.2, 0.01, 0.005}})
---print(curve:peak "z")
---assert(curve:write "curve.csv" and curve:figure():write "curve.svg")
---```
---@param options bw.HarmonicCurveOptions the place
---@return bw.HarmonicCurve? curve the response
---@return string? message
---@return bw.Details? details
function Harmonic:curve(options) end

---A place, or a coupling, and frequencies.
---@class bw.HarmonicCurveOptions
---@field at? bw.Vector (m) the place
---@field coupling? integer (index from 1) in its place: the coupling whose remote point is meant
---@field frequencies? number[]|bw.Array (Hz, n × 1) 0 or more each. Default: those of the response

---The largest displacement and von Mises stress of each node over frequencies, each over its period. The stress of each vector of
---the basis is computed once.
---
---Errors: those of `displacement`.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {0, 500}, base = {0, 0, 9.81}, damping = {ratio = 0.02}})
---local envelope = assert(shaken:envelope())
---print(envelope, envelope.largest.von_mises.frequency)
---assert(envelope:write "envelope.vtu" and envelope:figure():write "stress.svg")
---```
---@param options? bw.HarmonicEnvelopeOptions the frequencies
---@return bw.HarmonicEnvelope? envelope the largest values
---@return string? message
---@return bw.Details? details
function Harmonic:envelope(options) end

---Frequencies of an envelope.
---@class bw.HarmonicEnvelopeOptions
---@field frequencies? number[]|bw.Array (Hz, n × 1) 0 or more each. Default: those of the response

---Root mean squares where loads and base are multiplied by one random process, stationary and of mean 0.
---
---Errors: singular (nothing damps a mode or a residual vector in the range; a ratio damps modes alone). Points that do not ascend, are negative or reach beyond the highest
---frequency of the response raise.
---
---Source: docs/theory/dynamics.md; Segalman, Fulcher, Reese, Field (1998).
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {20, 2000}, base = {0, 0, 9.81}, damping = {ratio = 0.02}})
---print(assert(shaken:random {psd = {{20, 0.01}, {80, 0.04}, {350, 0.04}, {2000, 0.007}}})) -- g^2/Hz, as the base has 1 g
---```
---@param options bw.HarmonicRandomOptions the process
---@return bw.RandomResponse? random root mean squares
---@return string? message
---@return bw.Details? details
function Harmonic:random(options) end

---A random process.
---@class bw.HarmonicRandomOptions
---@field psd number[][]|bw.Array (any, n × 2) rows of frequency (Hz) and one-sided power spectral density (1/Hz), straight on logarithmic axes, linear where a number is 0; nothing outside

---Writes a frequency's fields to a .vtu file: displacement and stress in two parts, and the amplitude of von Mises stress. Other
---endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written), and those of `displacement`.
---@param path string the file
---@param frequency number (Hz) 0 or more
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function Harmonic:write(path, frequency, options) end

---Draws the operating deflection shape at the phase where it is largest, coloured by the amplitude of von Mises stress.
---
---Errors: those of `bw.picture` and of `displacement`.
---@param frequency number (Hz) 0 or more
---@param path string the PNG file
---@param options? bw.PictureOptions how it is drawn; the largest displacement is a tenth of the box unless `deformation` is given
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Harmonic:picture(frequency, path, options) end

---Draws a period of the operating deflection shape as an animated PNG, as `bw.animation` makes them.
---
---Errors: those of `bw.animation`, of `bw.picture` and of `displacement`.
---@param frequency number (Hz) 0 or more
---@param path string the PNG file
---@param options? bw.HarmonicAnimateOptions how it is drawn and played
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Harmonic:animate(frequency, path, options) end

---How a period is drawn.
---@class bw.HarmonicAnimateOptions: bw.PictureOptions
---@field pictures? integer (count) of a period. Range: 4 to 1000. Default: 24
---@field seconds? number (s) that a period takes on the screen. Range: above 0. Default: 1.2

---Releases the response at once.
function Harmonic:close() end

---The displacement of a node, or the motion of a remote point, over frequencies.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {0, 300}, base = {0, 0, 1}, damping = {ratio = 0.01}})
---local curve = assert(shaken:curve {at = {0.2, 0.01, 0.005}})
---print(curve.node, curve.amplitude:column(3):max(), curve.phase(1, 3))
---```
---@class bw.HarmonicCurve
---@field node integer (index from 1) the node; not of a remote point
---@field coupling integer (index from 1) the coupling of a remote point; not of a node
---@field rotation bw.HarmonicCurve of a remote point: its rotation, in rad where the displacement is in m; not of a node
---@field unit "m"|"rad" of the amplitudes
---@field at number[] (m, 3) where it is
---@field frequencies bw.Array (Hz, n × 1) the frequencies
---@field unlimited boolean whether the response is undamped and has a natural frequency in their range
---@field real bw.Array (m, n × 3) real part along x, y and z
---@field imaginary bw.Array (m, n × 3) imaginary part
---@field amplitude bw.Array (m, n × 3) the largest over a period
---@field phase bw.Array (degrees, n × 3) by which it is before the load; negative: behind
local HarmonicCurve = {}

---The largest amplitude along an axis. The frequencies of a range meet the peaks of modes; those of a list may miss them. A warning
---says where an undamped response has no limit.
---@param axis "x"|"y"|"z" the direction
---@return number frequency (Hz) where it is largest
---@return number amplitude (any) the largest, in m or rad
function HarmonicCurve:peak(axis) end

---Writes the curve as a CSV file, with frequency, amplitudes and phases in its columns.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function HarmonicCurve:write(path) end

---A plot of the amplitudes over the frequency.
---@return bw.Figure figure the plot
function HarmonicCurve:figure() end

---The largest displacement and von Mises stress over frequencies. The frequencies of a range meet the peaks of modes; those of a
---list may miss them.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {0, 300}, base = {0, 0, 1}, damping = {ratio = 0.01}})
---local envelope = assert(shaken:envelope {frequencies = {50, 100, 200}})
---print(envelope.von_mises_peaks:max(), envelope.von_mises_frequency[1])
---```
---@class bw.HarmonicEnvelope
---@field frequencies bw.Array (Hz, n × 1) the frequencies
---@field displacement bw.Array (m, node_count × 1, per node) the largest length of the displacement
---@field displacement_frequency bw.Array (Hz, node_count × 1, per node) the frequency of it
---@field displacement_peaks bw.Array (m, n × 1) the largest over the nodes, at each frequency
---@field displacement_nodes bw.Array (index from 1, n × 1) its node
---@field von_mises bw.Array (Pa, node_count × 1, per node) the largest von Mises stress
---@field von_mises_frequency bw.Array (Hz, node_count × 1, per node) the frequency of it
---@field von_mises_peaks bw.Array (Pa, n × 1) the largest over the nodes, at each frequency
---@field von_mises_nodes bw.Array (index from 1, n × 1) its node
---@field largest table<string, bw.HarmonicLargest> the largest of all, as `largest.displacement` and `largest.von_mises`
---@field mesh bw.Mesh of the model
local HarmonicEnvelope = {}

---The largest value of an envelope.
---@class bw.HarmonicLargest
---@field value number (any) the value, in m or Pa
---@field frequency number (Hz) the first frequency at which it is reached
---@field node integer (index from 1) its node
---@field at number[] (m, 3) where the node is

---Writes the largest values and their frequencies to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function HarmonicEnvelope:write(path, options) end

---Draws the body as a PNG file, coloured by the largest von Mises stress.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function HarmonicEnvelope:picture(path, options) end

---A plot of the largest von Mises stress of the body over the frequency.
---@return bw.Figure figure the plot
function HarmonicEnvelope:figure() end

---A motion of a remote point, of size only: each number is 0 or more.
---@class bw.PointMotion
---@field displacement number[] (m, 3) along x, y and z
---@field rotation number[] (rad, 3) about x, y and z

---Root mean squares of a response to a random process.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {20, 500}, base = {0, 0, 9.81}, damping = {ratio = 0.02}})
---local random = assert(shaken:random {psd = {{20, 0.01}, {500, 0.01}}})
---print(3 * random.von_mises:max() < 400e6, random.displacement:column(3):max())
---```
---@class bw.RandomResponse
---@field displacement bw.Array (m, node_count × 3, per node) root mean square of each component
---@field von_mises bw.Array (Pa, node_count × 1, per node) root of the mean square of von Mises stress
---@field error number (-) of the displacement, in energy, over the displacement: a bound on this mesh where the modes are counted, but for the quadrature
---@field counted boolean whether no mode is missing for certain
---@field mesh bw.Mesh of the model
---@field couplings bw.PointMotion[] root mean squares of the motion of each coupling's remote point
---@field response bw.Harmonic the response that the process multiplies
---@field psd bw.Array (any, n × 2) rows of frequency (Hz) and density (1/Hz) of the process
local RandomResponse = {}

---Compares the vibration with the strength, for a Gaussian process: the margin of `sigma` root mean squares, and the probability
---that von Mises stress exceeds the strength, at an instant and within a duration, at each node by itself. Static stresses are not
---in it. A material whose strengths differ, or are not known, needs `strength`, else it raises.
---
---Errors: those of `Harmonic:random`.
---
---Source: docs/theory/dynamics.md; Segalman, Reese, Field, Fulcher (2000).
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {20, 500}, base = {0, 0, 9.81}, damping = {ratio = 0.02}})
---local random = assert(shaken:random {psd = {{20, 0.01}, {500, 0.01}}})
---print(assert(random:margins {duration = 3600, strength = 250e6}))
---```
---@param options bw.RandomMarginOptions duration and strength
---@return bw.RandomMargins? margins probabilities and the margin
---@return string? message
---@return bw.Details? details
function RandomResponse:margins(options) end

---What a random vibration is compared with.
---@class bw.RandomMarginOptions
---@field duration number (s) how long the vibration lasts. Range: 0 or more
---@field strength? number (Pa) that von Mises stress is compared with. Range: above 0. Default: that of each material
---@field sigma? number (-) root mean squares of the margin. Range: above 0. Default: 3

---The damage of the vibration, for a Gaussian process, by spectral moments of von Mises stress's mean square. Where materials meet,
---the largest damage of one of them counts. A curve with a `strength` raises: the mean stress is 0.
---
---Errors: those of `Harmonic:random`.
---
---Source: docs/theory/dynamics.md; Dirlik (1985); Preumont and Piéfort (1994).
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {20, 500}, base = {0, 0, 9.81}, damping = {ratio = 0.02}})
---local random = assert(shaken:random {psd = {{20, 0.01}, {500, 0.01}}})
---print(assert(random:fatigue {duration = 3600, curve = {amplitude = 160e6, cycles = 2e6, exponent = 5}}))
---```
---@param options bw.RandomFatigueOptions duration and life curve
---@return bw.RandomFatigue? fatigue the damage
---@return string? message
---@return bw.Details? details
function RandomResponse:fatigue(options) end

---A random vibration's duration and the material's life.
---@class bw.RandomFatigueOptions
---@field duration number (s) how long the vibration lasts. Range: 0 or more
---@field curve bw.LifeCurve the life curve of the material, without `strength`

---Writes the root mean squares to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function RandomResponse:write(path, options) end

---Draws the body as a PNG file, coloured by the root mean square of von Mises stress.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function RandomResponse:picture(path, options) end

---How far a random vibration stays from the strength.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {20, 500}, base = {0, 0, 9.81}, damping = {ratio = 0.02}})
---local random = assert(shaken:random {psd = {{20, 0.01}, {500, 0.01}}})
---local margins = assert(random:margins {duration = 3600, strength = 250e6})
---print(margins.margin > 0, margins.first_passage[margins.node] < 1e-3)
---```
---@class bw.RandomMargins
---@field exceedance bw.Array (-, node_count × 1, per node) probability that von Mises stress exceeds the strength at an instant: the share of the time
---@field rate bw.Array (1/s, node_count × 1, per node) how often it rises through the strength, at most
---@field first_passage bw.Array (-, node_count × 1, per node) probability that it exceeds the strength within the duration, at most
---@field used bw.Array (-, node_count × 1, per node) `sigma` root mean squares of von Mises stress over the strength
---@field margin number (-) the strength over `sigma` root mean squares, less 1, where it is least
---@field margin_node integer (index from 1) the node of the margin
---@field margin_at number[] (m, 3) the place of that node
---@field beyond number (-) probability that von Mises stress exceeds `sigma` root mean squares at that node, at an instant; 0.0027 for 3 where one component acts
---@field node integer (index from 1) where a first passage is most probable; where it is certain, the node with the largest `exceedance`
---@field at number[] (m, 3) the place of that node
---@field poisson number (-) probability of a first passage at that node if crossings were independent
---@field sigma number (-) root mean squares of the margin
---@field duration number (s) of the vibration
---@field mesh bw.Mesh of the model
local RandomMargins = {}

---Writes probabilities, rates and used parts of the strength to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function RandomMargins:write(path, options) end

---Draws the body as a PNG file, coloured by the used part of the strength.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function RandomMargins:picture(path, options) end

---Damage by a random vibration.
---```lua
---local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {10, 1, 1}, order = 2}
---local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
---local shaken = assert(part:harmonic {range = {20, 500}, base = {0, 0, 9.81}, damping = {ratio = 0.02}})
---local random = assert(shaken:random {psd = {{20, 0.01}, {500, 0.01}}})
---local fatigue = assert(random:fatigue {duration = 3600, curve = {amplitude = 160e6, cycles = 2e6, exponent = 5}})
---print(fatigue.life, fatigue.at[1], fatigue.by.narrow_band)
---```
---@class bw.RandomFatigue
---@field damage bw.Array (-, node_count × 1, per node) within the duration, by Dirlik's method
---@field rate bw.Array (1/s, node_count × 1, per node) damage per time
---@field moments bw.Array (any, node_count × 4, per node) spectral moments m0 (Pa2), m1 (Pa2 Hz), m2 (Pa2 Hz2) and m4 (Pa2 Hz4)
---@field life number (s) until the damage is 1 somewhere; infinite without damage
---@field by table<string, number> (-) damage at `node` by `dirlik`, `tovo_benasciutti`, `wirsching_light` and `narrow_band`
---@field node integer (index from 1) where the damage is largest
---@field at number[] (m, 3) the place of that node
---@field duration number (s) of the vibration
---@field mesh bw.Mesh of the model
local RandomFatigue = {}

---Writes the damage to a .vtu file. Other endings of `mesh:write` work, too.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function RandomFatigue:write(path, options) end

---Draws the body as a PNG file, coloured by the damage.
---
---Errors: those of `bw.picture`.
---@param path string the file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function RandomFatigue:picture(path, options) end
