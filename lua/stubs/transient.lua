---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Motion in time
--
-- Linear bodies under loads and supports that change in time: velocities, stresses and where the energy goes.

---How a part moves.
---@class bw.TransientOptions
---@field step number (s) length of each step. Range: above 0. A twentieth of the shortest period of interest gives 1 % of its length.
---@field error? number (-) of a step, relative to the largest displacement, root mean square over the mass: steps adapt to it. `step` is the first one, and functions of time are looked at in its intervals; the lengths are `step` times a power of 2, 2⁻¹⁰ to 2⁶. Each length needs a factor, and the last six are kept in memory. Not with `modes`. Range: above 0, below 1; 1e-3 to 1e-5 is usual. Default: all steps have one length.
---@field rho? number (-) spectral radius at infinite frequency: 1 damps no motion, 0 takes the fastest away in one step. Range: 0 to 1. Default: 0.9.
---@field modes? bw.Modes elastic modes of the part: the motion is their sum, with rigid-body motions and the static displacement of what they leave out. Default: none, direct integration.
---@field damping? bw.Damping by mass and stiffness, with `modes` a ratio too; a loss factor is refused. Default: none.
---@field initial? bw.InitialMotion where it begins. What `modes`, or joints, do not allow is lost: a warning says how much where it is above 1 %. With `modes` a load that acts at time 0 deforms the part at once by its static part. Default: at rest, undeformed.
---@field loads? table<integer, bw.History> factors of the loads by their number in the part. Default: 1 each, from time 0 on.
---@field couplings? table<integer, bw.History> factors of the forces and moments of remote points, by the number of their coupling in the part. The weight of a point has the factor of the gravity load. Default: 1 each, from time 0 on.
---@field supports? bw.History|table<integer, bw.History> factor of all prescribed displacements, those of remote points too; or factors by the number of the support in the part, 1 for each one left out and for remote points. Velocity and acceleration follow by differences over a step. Supports with different histories must not prescribe the same component of a node, unless both are 0 there. Default: 1.
---@field coupling_motions? table<integer, bw.History> factors of the prescribed motions of remote points, by the number of their coupling in the part. Default: the one of `supports`, or 1 each.

---The start of a motion, where no support prescribes it.
---@class bw.InitialMotion
---@field displacement? bw.Array (m, node_count × 3) Default: 0.
---@field velocity? bw.Array (m/s, node_count × 3) Default: 0.

---A value that changes in time: a number, a function of time (s), rows {time, value} of ascending times, or the path of a CSV
---file with such rows of two columns behind comments (`#`) and a line of headings. Rows are linear between and constant outside. A
---file that ends before the motion, while its value changes, warns.
---@alias bw.History number|(fun(time: number): number)|number[][]|string

---A part in motion; `print` shows its energies.
---```lua
---local mesh = bw.mesh.box {max = {1, 0.1, 0.1}, cells = {4, 1, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:gravity {0, 0, -9.81}
---local transient = assert(part:transient {step = 1e-3})
---print(transient:step():step())
---```
---@class bw.LinearTransient
---@field mesh bw.Mesh the body
---@field time number (s) now
---@field steps integer (count) that were taken
---@field step_length number (s) of the next step
---@field rejected_steps integer (count) that were taken again, where steps adapt
---@field coarse_steps integer (count) of the shortest length, with a larger error than asked for
---@field factors integer (count) that were made; with `modes` 0
---@field error number (-) of the displacement now, relative to the largest, root mean square over the mass: the sum of the estimates of all steps. 0 where steps do not adapt: unknown.
---@field load_count integer (count) of loads
---@field coupling_count integer (count) of couplings
---@field displacement bw.Array (m, n × 3, per node) now, a copy like the others
---@field velocity bw.Array (m/s, n × 3, per node) now
---@field acceleration bw.Array (m/s2, n × 3, per node) now
---@field reaction bw.Array (N, n × 3, per node) of the supports at prescribed components, 0 elsewhere
---@field initial_energy number (J) kinetic and strain energy at time 0
---@field kinetic_energy number (J) now
---@field strain_energy number (J) now, with that of springs
---@field work number (J) of loads and supports since time 0
---@field damping_energy number (J) that the damping took since time 0
---@field lost_energy number (J) that the scheme took: what is missing in the balance of the others
---@field report bw.SolverReport of the factor made last, with the seconds of all
local LinearTransient = {}

---Releases it at once.
function LinearTransient:close() end

---Takes one step. Where steps adapt, one with too large an error is taken again, shorter.
---
---Source: [motion in time](../theory/transient.md).
---
---Errors: `memory` where there is none left. Loads or supports added since the start raise, and so does a step so long that the
---energies are not finite.
---@return bw.LinearTransient? transient itself
---@return string? message
---@return bw.Details? details
function LinearTransient:step() end

---The present displacement as the static solution of the loads less the forces of inertia and damping: for stresses, files,
---pictures and the error estimate. Later steps do not change it. It has no forces of bonds, attachments and couplings, and load
---factors of a part with couplings need a solution of `model:solve`.
---
---Errors: `memory` where there is none left.
---@return bw.Static? static the state
---@return string? message
---@return bw.Details? details
function LinearTransient:static() end

---Steps to a time and records energies at each step, and what is asked for.
---
---Errors: those of `step`; `cancelled` where it was interrupted; `io` where a file cannot be written.
---@param options bw.TransientRunOptions how far, and what is recorded
---@return bw.Recording? recording what was recorded
---@return string? message
---@return bw.Details? details
function LinearTransient:run(options) end

---How far a motion is followed, and what is recorded.
---@class bw.TransientRunOptions
---@field time number (s) of the end, from the start of the transient; the last step ends there or behind. A time before the present one raises. Range: above 0.
---@field probes? table<string, bw.Vector> (m) points by name: the boundary node nearest to each is recorded
---@field stress_every? integer (count) steps from one evaluation of the von Mises stress to the next; it is evaluated at frames, too. Default: none.
---@field frames? integer (count) states on the boundary that are kept for `report`, at instants evenly over the time: the first step that is not before each. 60 are usual. They take 32 bytes per node of the boundary and frame. Range: 2 to 1000. Default: none.
---@field write? string path of a `.pvd` file: states are written beside it as `.vtu`
---@field write_every? integer (count) steps from one file to the next. Default: 1.
---@field each? fun(now: bw.LinearTransient) called at the start and after each step

---What was recorded of a motion; `print` shows the balance of energy, the largest displacements of probes and the largest stress.
---```lua
---local mesh = bw.mesh.box {max = {1, 0.1, 0.1}, cells = {4, 1, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):gravity {0, 0, -9.81}
---local recording = assert(assert(part:transient {step = 1e-4}):run {time = 0.01, probes = {tip = {1, 0, 0}}})
---print(recording.probes.tip.displacement:column(3):min())
---```
---@class bw.Recording
---@field time bw.Array (s, n) of the start and of each step
---@field energy bw.RecordedEnergy energies at these times
---@field probes table<string, bw.Probe> by name
---@field stress? bw.RecordedStress where `stress_every` was given
---@field steps_per_period? number (count) steps per period of the motion until now, in the mean over its strain energy. None where steps adapt, for few steps of less than one period, for motions as a rigid body and with `modes`, which are exact for loads that are linear within a step.
---@field steps? bw.RecordedSteps where steps adapt
---@field frames? bw.RecordedFrames where `frames` was given
---@field period_error? number (-) by which its periods are too long, estimated from `steps_per_period`; above 0.03 a warning names a shorter step
local Recording = {}

---Writes times, energies and probes as columns of a CSV file. To a path that ends in `.xdmf` it writes the frames: the boundary
---with its displacement, and von Mises stress where that was recorded, at each time, for ParaView. Without frames that raises.
---
---Errors: `io` where the file cannot be written.
---@param path string of the file
---@return boolean? done true
---@return string? message
---@return bw.Details? details
function Recording:write(path) end

---Writes a page with the motion in time, which opens from disk: a 3D view that plays the frames, with their time and a factor on
---the displacement. Colours show the von Mises stress where stresses were recorded, and the displacement. Without frames it raises.
---
---Errors: `io` where the file cannot be written.
---```lua
---local mesh = bw.mesh.box {max = {1, 0.1, 0.1}, cells = {4, 1, 1}}
---local part = bw.model {mesh = mesh, material = bw.material.steel}
---part:fix(mesh.boundary:below("x", 0)):gravity {0, 0, -9.81}
---local recording = assert(assert(part:transient {step = 1e-4}):run {time = 0.01, frames = 60, stress_every = 1})
---assert(recording:report "motion.html")
---```
---@param path string of the page
---@param options? bw.RecordingReportOptions what it shows
---@return true? written true
---@return string? message
---@return bw.Details? details
function Recording:report(path, options) end

---Draws the state with the largest von Mises stress, or where no stresses were recorded the frame with the largest displacement,
---coloured by these. Without stresses and frames it raises.
---
---Errors: those of `bw.picture`.
---@param path string of the PNG file
---@param options? bw.PictureOptions how it is drawn
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Recording:picture(path, options) end

---What the page of a motion shows.
---@class bw.RecordingReportOptions
---@field title? string of the page. Default: "Motion in time"
---@field seconds? number (s) in which the page plays the motion. Range: above 0. Default: 6

---States on the boundary of the mesh, kept while a motion was followed.
---@class bw.RecordedFrames
---@field time bw.Array (s, n) of each frame
---@field nodes bw.Array (index from 1, m) of the mesh, those of its boundary
---@field displacement bw.Array[] (m, m × 3, per node of these) of each frame
---@field von_mises? bw.Array[] (Pa, m) of each frame, where `stress_every` was given

---Steps that adapt.
---@class bw.RecordedSteps
---@field taken integer (count) of the recording
---@field shortest? number (s) the shortest of them; nil where none was taken
---@field longest? number (s) the longest of them; nil where none was taken
---@field rejected integer (count) of those taken again since the start of the motion
---@field coarse integer (count) since then of the shortest length allowed, with a larger error than asked for
---@field factors integer (count) made since then
---@field error number (-) of the displacement at the end, relative to the largest, root mean square over the mass: the sum of the estimates of all steps. It is several times the error where errors cancel, and was up to 14 % below it at `rho` 0.2 and 0.3.

---Energies in time.
---@class bw.RecordedEnergy
---@field initial_energy number (J) at the start
---@field kinetic_energy bw.Array (J, n) at each time
---@field strain_energy bw.Array (J, n) at each time
---@field work bw.Array (J, n) of loads and supports until then
---@field damping_energy bw.Array (J, n) taken by damping until then
---@field lost_energy bw.Array (J, n) taken by the scheme until then

---A node in time.
---@class bw.Probe
---@field node integer (index from 1) the boundary node nearest to the point
---@field place number[] (m, 3) where it is
---@field displacement bw.Array (m, n × 3) at each time
---@field velocity bw.Array (m/s, n × 3) at each time
---@field acceleration bw.Array (m/s2, n × 3) at each time

---Stresses in time. Between the times evaluated a stress may be larger.
---@class bw.RecordedStress
---@field time bw.Array (s, n) when stresses were evaluated
---@field von_mises bw.Array (Pa, n) the largest at a node
---@field envelope bw.Array (Pa, node_count) the largest of these times at each node
---@field peak bw.StressPeak the largest of all

---The largest stress of a motion.
---@class bw.StressPeak
---@field von_mises number (Pa) the stress
---@field time number (s) when
---@field node integer (index from 1) where
---@field place number[] (m, 3) where it is
---@field static bw.Static the state then
