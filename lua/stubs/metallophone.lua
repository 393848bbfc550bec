---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Metallophone bars
--
-- Bars as free plates: their modes, tone and tuning.

---A bar that rings. Umetani et al. 2011, section 5.1 and appendix A.
---@class bw.Metallophone
---@field outline bw.Outline as it is now
---@field reused bw.ReuseStatistics what the last frame kept
---@field frequency number of the lowest elastic mode, Hz
---@field frequencies bw.Array of all modes asked for, Hz
---@field note string nearest note and how far above it: "C5 +3.2 cents"
---@field nodal_lines bw.Array rows x0, y0, x1, y1: where the lowest mode is at rest
---@field thickness number m
---@field points bw.Array of the mesh, m
---@field elements bw.Array corners and mid-edge nodes 12, 23, 31, from 1
---@field element_count integer
---@field node_count integer
local Metallophone = {}

---Moves a handle of the outline by {dx, dy}: mesh, tone and mode follow.
---@param handle table {vertex = n}, {edge = n} or {loop = name}
---@param by number[]
---@return bw.Metallophone?
---@return string? message
---@return bw.Details? details
function Metallophone:drag(handle, by) end

---Goes over to another outline.
---@param outline bw.Outline
---@return bw.Metallophone?
---@return string? message
---@return bw.Details? details
function Metallophone:become(outline) end

---Solves again on the shape as it is.
---@return bw.Metallophone?
---@return string? message
---@return bw.Details? details
function Metallophone:solve() end

---How a frequency changes with the outline's points, Hz/m.
---@param mode? integer default 1
---@return bw.Array? gradient a row for every point
---@return string? message
---@return bw.Details? details
function Metallophone:gradient(mode) end

---Deflection and two rotations at every node, mass norm 1.
---@param mode? integer
---@return bw.Array
function Metallophone:mode(mode) end

---The lowest frequencies of vibrations within the bar's plane, Hz: where one lies below `frequency`, the
---bar is too narrow for its thickness to sound as bending says.
---@param count? integer default 1
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function Metallophone:inplane(count) end

---All modes up to the highest that the bar has (`modes` of them, and those within its plane), the lowest first:
---frequency (Hz), kind ("bending" along the long axis, "torsion" about it, "in-plane"), number (from 1 for each
---kind), mode (of the bar; none in the plane). Example: `for _, m in ipairs(assert(bar:spectrum())) do print(m.kind) end`
---@return bw.SpectrumMode[]?
---@return string? message
---@return bw.Details? details
function Metallophone:spectrum() end

---@class bw.SpectrumMode
---@field frequency number
---@field kind string
---@field number integer
---@field mode integer?

---Two places to hold the bar, on the nodal lines of its lowest mode.
---@return number[][]? places
---@return string? message
---@return bw.Details? details
function Metallophone:holes() end

---The sound of a stroke at `at` (default: where the lowest mode moves most): loss factor (default
---0.002), contact of the mallet (s, default 0.0003), seconds (default 2), rate (default 44100).
---@param options? bw.MetallophoneToneOptions
---@return bw.Array? samples between -1 and 1
---@return string? message
---@return bw.Details? details
function Metallophone:tone(options) end

---@class bw.MetallophoneToneOptions
---@field at? number[]
---@field loss? number
---@field contact? number
---@field seconds? number
---@field rate? integer

---How loudly each mode sounds in it, with its sign, the loudest 1 in size.
---@param options? table as for tone
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function Metallophone:gains(options) end

---The tone as a .wav file.
---@param path string
---@param options? bw.MetallophoneToneOptions
---@return boolean?
---@return string? message
---@return bw.Details? details
function Metallophone:write_tone(path, options) end

---Changes the outline until the tone is `target` (Hz, or a note like "C5"), moving it least in the mean
---square and as evenly as the length `smooth` asks (default: a tenth of the size), no point by more than
---the part `move_limit` (0.2) of the width where it is. `ratios`: of the frequencies of the lowest modes of a `kind`
---("bending" or "torsion"), the first of which gets the target: {1, 4, 10}; they are followed by kind and number
---while modes of another kind pass them. `stages` (1) divides the way into as many searches, each with a move limit of its own
---from the outline of the one before: {1, 4, 10} is reached from an even bar in 8 with a move limit of 0.45. Ratios that the outline cannot reach fail with status "infeasible" or
---"convergence" and details.frequencies, the nearest found. More than 5 % off, the size is changed first. `keep`: numbers of points
---that stay (from there), `pins`: of vertices, as in Outline:pull. Met on a mesh `finer` times as fine (default 4). On failure nothing has changed.
---`watch` is called with the bar after every round; where it returns false, tuning ends as a failure.
---@param target number|string
---@param options? bw.MetallophoneTuneOptions
---@return bw.TunedBar?
---@return string? message
---@return bw.Details? details
function Metallophone:tune(target, options) end

---@class bw.MetallophoneTuneOptions
---@field keep? integer[]
---@field pins? integer[]
---@field smooth? number
---@field finer? integer
---@field ratios? number[]
---@field kind? "bending"|"torsion"
---@field move_limit? number
---@field stages? integer
---@field watch? fun(bar: bw.Metallophone): boolean?

---@class bw.TunedBar
---@field frequency number
---@field cents number
---@field moved number
---@field rounds integer
---@field mesh_cents number
---@field modes bw.TunedBarModes[]

---@class bw.TunedBarModes
---@field frequency number
---@field wanted number
---@field cents number
---@field number integer
---@field kind string?

---Where to take material off the edge of a bar that was made and sounds at `measured` Hz: places, the
---best first, each alone enough as far as the change is linear. A cut is at most half as deep as the bar is wide
---there, and a place that needs more is left out.
---
---Errors: `infeasible` where no cut within that bound is enough; the message gives the largest change.
---@param measured number Hz
---@param target number|string
---@param options? bw.MetallophoneTrimOptions
---@return bw.TrimPlace[]?
---@return string? message
---@return bw.Details? details
function Metallophone:trim(measured, target, options) end

---@class bw.MetallophoneTrimOptions
---@field places? integer
---@field width? number

---@class bw.TrimPlace
---@field at number[]
---@field depth number
---@field cents number
---@field per_mm number

---The engine's plate under a metallophone bar; scripts take bw.Metallophone.
---@class bw.Plate
---@field outline bw.Outline
---@field frequencies bw.Array
---@field thickness number
---@field points bw.Array
---@field elements bw.Array
local Plate = {}

---@param frame table
---@param outline bw.Outline
---@return table?
---@return string? message
---@return bw.Details? details
function Plate:follow(frame, outline) end

---@param frame table
---@param options? bw.PlateSolveOptions
---@return table?
---@return string? message
---@return bw.Details? details
function Plate:solve(frame, options) end

---@class bw.PlateSolveOptions
---@field modes? integer
---@field tolerance? number
---@field scratch? boolean

---@param mode? integer
---@return bw.Array
function Plate:mode(mode) end

---@param mode? integer
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function Plate:gradient(mode) end

---@param mode? integer
---@return bw.Array
function Plate:nodal_lines(mode) end

---@param options? table
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function Plate:tone(options) end

---@param options? table
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function Plate:gains(options) end

---@param count? integer
---@return bw.Array?
---@return string? message
---@return bw.Details? details
function Plate:inplane(count) end

---@return integer elements
---@return integer nodes
function Plate:counts() end

---What mesh and body are at.
---@return bw.BodyState
function Plate:keep() end

---Back to what was kept, bit for bit.
---@param state bw.BodyState
---@return table?
---@return string? message
---@return bw.Details? details
function Plate:return_to(state) end

---Checks that all parts of it belong together, for tests and debugging. Raises where they do not.
---@return table
function Plate:check() end

---Releases it early.
function Plate:close() end
