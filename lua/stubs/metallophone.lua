---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Metallophone bars
--
-- Bars as free plates: natural frequencies and modes while the outline is dragged, tone, tuning and trimming.

---A metallophone bar, made by `bw.responsive.metallophone`.
---
---Source: Umetani et al., section 5.1 and appendix A.
---```lua
---local outline = assert(bw.outline.rectangle {width = 0.1, height = 0.02})
---local bar = assert(bw.responsive.metallophone {outline = outline, material = bw.material.pla, thickness = 0.004, modes = 3})
---assert(bar:drag({vertex = 3}, {0.005, 0}))
---print(bar.note, bar.frequencies)
---for _, mode in ipairs(assert(bar:spectrum())) do print(mode.frequency, mode.kind) end
---```
---@class bw.Metallophone
---@field outline bw.Outline the current outline
---@field reused bw.ReuseStatistics what the last frame reused
---@field report bw.SolverReport? what solved in the last frame, and why; nil where nothing was solved yet
---@field frequency number (Hz) natural frequency of the lowest elastic mode
---@field frequencies bw.Array (Hz, mode_count × 1, per mode) natural frequencies of the elastic modes, ascending
---@field note string the nearest note and how far the lowest mode lies above it, such as "C5 +3.2 cents"; A4 is 440 Hz
---@field nodal_lines bw.Array (m, line_count × 4, per line) ends x0, y0, x1, y1 of the pieces of the nodal lines of the lowest mode
---@field thickness number (m) thickness
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh
---@field elements bw.Array (index from 1, element_count × 6, per element) corners, then the mid-edge nodes of edges 1-2, 2-3 and 3-1
---@field element_count integer (count) triangles
---@field node_count integer (count) nodes
local Metallophone = {}

---Moves a handle of the outline; mesh and modes follow.
---
---Errors: geometry (edges would cross or touch), and those of `bw.responsive.metallophone`. After a failure the bar is as it
---was.
---@param handle bw.OutlineHandle what is moved
---@param by number[] (m, {x, y}) the displacement
---@return bw.Metallophone? bar the same bar
---@return string? message
---@return bw.Details? details
function Metallophone:drag(handle, by) end

---Takes another outline, of any topology; mesh and modes follow.
---
---Errors: those of `bw.responsive.metallophone`. After a failure the bar is as it was.
---@param outline bw.Outline the other outline
---@return bw.Metallophone? bar the same bar
---@return string? message
---@return bw.Details? details
function Metallophone:become(outline) end

---Solves again on the outline as it is.
---
---Errors: convergence (the modes did not reach the tolerance). After a failure the bar is as it was.
---@return bw.Metallophone? bar the same bar
---@return string? message
---@return bw.Details? details
function Metallophone:solve() end

---The derivative of a natural frequency by the points of the outline. It holds for a frequency that no other mode has.
---
---Errors: only those that every function may give.
---@param mode? integer (index from 1) the mode. Default: 1
---@return bw.Array? gradient (Hz/m, point_count × 2, per point of the outline) the derivative
---@return string? message
---@return bw.Details? details
function Metallophone:gradient(mode) end

---The shape of a mode: the deflection and the two rotations. The modal mass is 1, and the largest deflection is positive.
---@param mode? integer (index from 1) the mode. Default: 1
---@return bw.Array shape (any, node_count × 3, per node) deflection w in kg^-0.5, then the rotations b in kg^-0.5/m; without shear b is -grad w
function Metallophone:mode(mode) end

---The lowest natural frequencies of vibrations within the plane of the bar. Where one lies below `frequency`, the bar is too
---narrow for its thickness, and bending does not decide the tone. More than the mesh has raises.
---
---Errors: convergence (the modes did not reach a relative error of 1e-6 in the energy norm).
---@param count? integer (count) how many. Range: 1 to 1000. Default: 1
---@return bw.Array? frequencies (Hz, count × 1, per mode) ascending
---@return string? message
---@return bw.Details? details
function Metallophone:inplane(count) end

---All modes up to the highest that the bar has, ascending: its bending and torsion modes, and those within its plane.
---
---Errors: those of `inplane`.
---@return bw.SpectrumMode[]? modes the modes
---@return string? message
---@return bw.Details? details
function Metallophone:spectrum() end

---A mode of a bar.
---@class bw.SpectrumMode
---@field frequency number (Hz) natural frequency
---@field kind "bending"|"torsion"|"in-plane" bending along the long axis, torsion about it, or within the plane of the bar
---@field number integer (index from 1) among the modes of its kind
---@field mode integer? (index from 1) the number for `mode` and `gradient`; nil within the plane

---Two places to support the bar: on the nodal lines of the lowest mode, one on either side of the centroid, as near to the
---long axis as these lines come.
---
---Errors: geometry (the nodal lines do not lie on both sides of the centroid: the lowest mode is no bending mode).
---@return number[][]? places (m, 2 × {x, y}) the places
---@return string? message
---@return bw.Details? details
function Metallophone:holes() end

---The sound of a stroke: the sum of the modes that the bar has, each of which decays. Modes of half the sampling rate and above are
---left out. Options out of range raise.
---
---Errors: only those that every function may give.
---@param options? bw.MetallophoneToneOptions where and how it is struck. Default: as stated there
---@return bw.Array? samples (-, sample_count × 1, per sample) the sound, the largest 0.9 in size
---@return string? message
---@return bw.Details? details
function Metallophone:tone(options) end

---Where and how a bar is struck. The push of the mallet is half a sine in time.
---@class bw.MetallophoneToneOptions
---@field at? number[] (m, {x, y}) the place that is struck, or the nearest one on the bar. Default: where the lowest mode deflects most
---@field loss? number (-) loss factor, above 0: amplitudes decay like exp(-π loss f t). Default: 0.002
---@field contact? number (s) duration of the push, 0 or more. Default: 0.0003
---@field seconds? number (s) duration of the sound, above 0. Range: up to 600. Default: 2
---@field rate? integer (1/s) samples per second, 1000 and more. Default: 44100

---The amplitude of each mode in the sound of a stroke, with its sign. Options out of range raise.
---
---Errors: only those that every function may give.
---@param options? bw.MetallophoneToneOptions where and how it is struck. Default: as stated there
---@return bw.Array? gains (-, mode_count × 1, per mode) the amplitudes, the largest 1 in size
---@return string? message
---@return bw.Details? details
function Metallophone:gains(options) end

---Writes the sound of a stroke as a WAV file, with one channel of 16 bits. Rates above 768000 raise.
---
---Errors: io (the file cannot be written), limit (the file would have more than 2 GB).
---@param path string the file
---@param options? bw.MetallophoneToneOptions where and how it is struck. Default: as stated there
---@return boolean? written true
---@return string? message
---@return bw.Details? details
function Metallophone:write_tone(path, options) end

---Changes the outline until the lowest mode, or the modes of `ratios`, have given frequencies. The change is the smallest one: of
---the displacement and of its unevenness over the length `smooth`, both over the local width, squared and integrated along the
---outline. Where the first frequency is more than 5 % off, the outline is scaled first, and `keep` and `pins` hold from there. The
---frequencies are met within 0.1 cents on a finer mesh where six repetitions suffice; `cents` of the result says how nearly.
---
---Errors: infeasible (the points that may move do not reach the frequencies; details: `frequencies`, the nearest found, in Hz),
---convergence (no step led nearer, or the modes to be tuned are lost; details: `frequencies`), cancelled (`watch` returned false), and those of
---`bw.responsive.metallophone`. After a failure the bar is as it was.
---@param target number|string (Hz) frequency of the lowest mode or of the first of `ratios`, above 0; or a note, such as "C5"
---@param options? bw.MetallophoneTuneOptions what may move, and which modes. Default: as stated there
---@return bw.TunedBar? result what was reached
---@return string? message
---@return bw.Details? details
function Metallophone:tune(target, options) end

---What tuning may change, and which modes it tunes.
---@class bw.MetallophoneTuneOptions
---@field keep? integer[] (index from 1, n) points of the outline that stay. Default: none
---@field pins? integer[] (index from 1, n) vertices of the outline that stay. Default: none
---@field smooth? number (m) the length over which the displacement is smoothed, above 0. Default: a tenth of the diagonal of the outline's box
---@field finer? integer (-) ratio of the elements of the mesh that checks to those of the bar, 1 and more; 1: the bar's own mesh. Default: 4
---@field ratios? number[] (-, n) ratios of the frequencies of the lowest modes of `kind`, ascending and above 0, such as {1, 4, 10}. Default: none, the lowest mode
---@field kind? "bending"|"torsion" the kind of the modes of `ratios`. Default: "bending"
---@field move_limit? number (-) by which fraction of the local width a point may move, above 0. Default: 0.2
---@field stages? integer (count) searches on the way, each with a move limit of its own. Range: 1 to 100. Default: 1
---@field watch? fun(bar: bw.Metallophone): boolean? called after every round; tuning ends where it returns false. Default: none

---A tuned bar. The frequencies are those on the finer mesh.
---@class bw.TunedBar
---@field frequency number (Hz) natural frequency of the first tuned mode
---@field cents number (cents) by how much it lies above its target
---@field moved number (m) the largest displacement of a point of the outline
---@field rounds integer (count) rounds of all searches
---@field mesh_cents number (cents) by how much it lies above the frequency on the bar's own mesh
---@field modes bw.TunedBarModes[] the tuned modes

---A tuned mode.
---@class bw.TunedBarModes
---@field frequency number (Hz) natural frequency on the finer mesh
---@field wanted number (Hz) its target
---@field cents number (cents) by how much it lies above the target
---@field number integer (index from 1) among the tuned modes
---@field kind string? "bending" or "torsion"; nil without `ratios`

---Where to cut material off the edge of a finished bar. Each place alone brings the lowest mode from `measured` to `target`, as
---far as the change is linear. A cut runs over `width` along the edge, and is at most half as deep as the bar is wide there.
---
---Errors: infeasible (no cut is enough; the message gives the largest change), and those of `bw.responsive.metallophone`.
---@param measured number (Hz) measured natural frequency of the lowest mode, above 0
---@param target number|string (Hz) the wanted frequency, above 0; or a note, such as "C5"
---@param options? bw.MetallophoneTrimOptions how wide cuts are, and how many places. Default: as stated there
---@return bw.TrimPlace[]? places the places, at least `width` apart, the shallowest cut first
---@return string? message
---@return bw.Details? details
function Metallophone:trim(measured, target, options) end

---Cuts that trim a bar.
---@class bw.MetallophoneTrimOptions
---@field places? integer (count) places at most, 1 and more. Default: 3
---@field width? number (m) length of a cut along the edge, above 0. Default: a tenth of the perimeter

---A place to cut, and how deep.
---@class bw.TrimPlace
---@field at number[] (m, {x, y}) the place on the edge
---@field depth number (m) depth of the cut in its middle; at distance d along the edge it is this times (1 + cos(2π d / width)) / 2
---@field cents number (cents) by how much the frequency rises
---@field per_mm number (cents/mm) by how much it rises for each millimetre of depth

---The engine's plate and its mesh motion, `body` of a metallophone bar. Scripts take the bar. `frame` is a table that receives
---what the call reused.
---```lua
---local outline = assert(bw.outline.rectangle {width = 0.1, height = 0.02})
---local bar = assert(bw.responsive.metallophone {outline = outline, material = bw.material.pla, thickness = 0.004})
---print(bar.body:counts())
---```
---@class bw.Plate
---@field outline bw.Outline the current outline
---@field frequencies bw.Array (Hz, mode_count × 1, per mode) natural frequencies of the elastic modes, ascending
---@field thickness number (m) thickness
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh
---@field elements bw.Array (index from 1, element_count × 6, per element) corners, then the mid-edge nodes of edges 1-2, 2-3 and 3-1
local Plate = {}

---Takes mesh and modes to an outline; it does not solve.
---
---Errors: geometry (an element is inverted), and those of `bw.plane.fill`.
---@param frame bw.ReuseStatistics receives what was reused
---@param outline bw.Outline the outline
---@return bw.ReuseStatistics? frame the same table
---@return string? message
---@return bw.Details? details
function Plate:follow(frame, outline) end

---Computes the elastic modes, from those of the last frame.
---
---Errors: convergence (the modes did not reach the tolerance).
---@param frame bw.ReuseStatistics receives what was reused
---@param options? bw.PlateSolveOptions how many modes and how exactly. Default: as stated there
---@return bw.ReuseStatistics? frame the same table
---@return string? message
---@return bw.Details? details
function Plate:solve(frame, options) end

---How many modes a plate has, and how exactly they are computed.
---@class bw.PlateSolveOptions
---@field modes? integer (count) elastic modes, 1 and more. Default: 1
---@field tolerance? number (-) relative error of a mode in the energy norm, above 0; that of the frequency is its square. Default: 1e-6
---@field solver? bw.Eigensolver|"auto" `bw.eigensolver.lobpcg`. Default: "auto", the same
---@field max_lag? integer (count) solutions that a factor may serve beyond the one that it was computed for, 0 or more. Default: any number
---@field full? boolean whether nothing of the last frame is used, with a new analysis and factorisation. Default: false

---The shape of a mode: the deflection and the two rotations. A plate that was not solved raises.
---@param mode? integer (index from 1) the mode. Default: 1
---@return bw.Array shape (any, node_count × 3, per node) as of `Metallophone:mode`
function Plate:mode(mode) end

---The derivative of a natural frequency by the points of the outline.
---
---Errors: only those that every function may give.
---@param mode? integer (index from 1) the mode. Default: 1
---@return bw.Array? gradient (Hz/m, point_count × 2, per point of the outline) the derivative
---@return string? message
---@return bw.Details? details
function Plate:gradient(mode) end

---The nodal lines of a mode, where its deflection vanishes, in pieces.
---@param mode? integer (index from 1) the mode. Default: 1
---@return bw.Array lines (m, line_count × 4, per line) ends x0, y0, x1, y1
function Plate:nodal_lines(mode) end

---The sound of a stroke, as of `Metallophone:tone`.
---
---Errors: only those that every function may give.
---@param options? bw.MetallophoneToneOptions where and how it is struck. Default: as stated there
---@return bw.Array? samples (-, sample_count × 1, per sample) the sound, the largest 0.9 in size
---@return string? message
---@return bw.Details? details
function Plate:tone(options) end

---The amplitude of each mode in the sound of a stroke, as of `Metallophone:gains`.
---
---Errors: only those that every function may give.
---@param options? bw.MetallophoneToneOptions where and how it is struck. Default: as stated there
---@return bw.Array? gains (-, mode_count × 1, per mode) the amplitudes, the largest 1 in size
---@return string? message
---@return bw.Details? details
function Plate:gains(options) end

---The lowest natural frequencies of vibrations within the plane, as of `Metallophone:inplane`.
---
---Errors: convergence (the modes did not reach a relative error of 1e-6 in the energy norm).
---@param count? integer (count) how many. Range: 1 to 1000. Default: 1
---@return bw.Array? frequencies (Hz, count × 1, per mode) ascending
---@return string? message
---@return bw.Details? details
function Plate:inplane(count) end

---The size of the mesh.
---@return integer elements (count) triangles
---@return integer nodes (count) nodes
function Plate:counts() end

---The current state of mesh and plate. It copies nothing.
---@return bw.BodyState state the state
function Plate:save() end

---Returns to a state, bit for bit. A state of another plate raises.
---
---Errors: only those that every function may give.
---@param state bw.BodyState a state of this plate
---@return bw.Plate? plate the same plate
---@return string? message
---@return bw.Details? details
function Plate:restore(state) end

---Checks that all parts of it belong together, for tests and debugging. It raises where they do not.
---@return bw.Plate self
function Plate:check() end

---Frees its memory at once.
function Plate:close() end
