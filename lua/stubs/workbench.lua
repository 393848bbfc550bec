---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Workbench
--
-- A part from a file, what constrains and loads it, an answer, edits of its surface: what `barwright open` shows
-- (docs/workbench.md).

---Workbenches. `barwright open` shows one in the browser.
---@class bw.WorkbenchModule
local workbench_module = {}

---Opens a file as a workbench: surfaces, meshes, drawings and scripts that return a surface. The surface is repaired where it must be, and
---its faces are found. The material is PLA until another is chosen.
---
---Errors: io, format, empty (no triangles), geometry (it cannot be repaired).
---```lua
---bw.surface.box {max = {0.1, 0.02, 0.01}}:write "beam.stl"
---local bench = assert(bw.workbench.open("beam.stl", {unit = "mm"}))
---print(#bench:state().faces) -- 6
---```
---@param path string the file
---@param options? bw.WorkbenchOpenOptions its unit and thickness
---@return bw.Workbench? workbench the workbench
---@return string? message
---@return bw.Details? details
function workbench_module.open(path, options) end

---The unit of a file, and the thickness of a drawing.
---@class bw.WorkbenchOpenOptions
---@field unit? "mm"|"cm"|"m"|"km"|"um"|"in"|"ft" of the numbers in the file; confirms it where the size is implausible. Default: what the file says, else mm
---@field thickness? number (m) of the body of a drawing, above 0. Default: 3e-3

---A part with its supports, loads and answer. Every action is a method and a line of `script`; `undo` takes it back. What cannot be
---done returns nil and a sentence that says what to do instead.
---```lua
---bw.surface.box {max = {0.1, 0.02, 0.01}}:write "beam.stl"
---local bench = assert(bw.workbench.open "beam.stl")
---assert(bench:fix {faces = {5}}:load {faces = {6}, force = {0, 0, -20}})
---print(assert(bench:answer {accuracy = "coarse"}).sentence)
---```
---@class bw.Workbench
local Workbench = {}

---Constrains faces. A load on a face that is constrained in all directions is refused.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchFixOptions which faces
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:fix(options) end

---A support.
---@class bw.WorkbenchFixOptions
---@field faces integer[] (index from 1, n × 1) the faces, as in `state`
---@field kind? "all"|"normal" all directions, or along the normals of the faces only. Default: "all"

---Loads faces with a total force.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchForceOptions the force
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:load(options) end

---A force.
---@class bw.WorkbenchForceOptions
---@field faces integer[] (index from 1, n × 1) the faces, as in `state`
---@field force bw.Vector (N) the total

---Loads faces with a moment.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchMomentOptions the moment
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:moment(options) end

---A moment.
---@class bw.WorkbenchMomentOptions
---@field faces integer[] (index from 1, n × 1) the faces, as in `state`
---@field moment bw.Vector (N m) about the centre of the faces

---Loads faces with a pressure.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchPressureOptions the pressure
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:pressure(options) end

---A pressure.
---@class bw.WorkbenchPressureOptions
---@field faces integer[] (index from 1, n × 1) the faces, as in `state`
---@field pressure number (Pa) positive pushes inwards

---Loads the whole part with gravity.
---
---Errors: invalid (with a sentence that says what to do).
---@param options? bw.WorkbenchGravityOptions the acceleration
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:gravity(options) end

---Gravity.
---@class bw.WorkbenchGravityOptions
---@field acceleration? bw.Vector (m/s2) Default: {0, 0, -9.81}

---Changes a support or a load. Fields that its kind does not have are ignored.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchChangeOptions what changes
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:change(options) end

---A change of a support or a load.
---@class bw.WorkbenchChangeOptions
---@field condition integer (index from 1) its number in `state`
---@field faces? integer[] (index from 1, n × 1) other faces
---@field vector? bw.Vector (any) another force (N), moment (N m) or acceleration (m/s2)
---@field value? number (Pa) another pressure
---@field kind? "all"|"normal" of a support

---Removes a support or a load.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchRemoveOptions which
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:remove(options) end

---A support or a load.
---@class bw.WorkbenchRemoveOptions
---@field condition integer (index from 1) its number in `state`

---Chooses the material: one of the library, or values, which replace those of the named one.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchMaterialOptions the material
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:material(options) end

---A material.
---@class bw.WorkbenchMaterialOptions
---@field name? string of the library, as `barwright materials` lists it
---@field young? number (Pa) Young's modulus, above 0
---@field poisson? number (-) Poisson's ratio. Range: 0 to 0.499
---@field strength? number (Pa) the stress at which it fails, above 0
---@field density? number (kg/m3) above 0

---Locks faces, in place of those before: no edit moves them.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchFaces which faces; an empty list unlocks all
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:lock(options) end

---Faces.
---@class bw.WorkbenchFaces
---@field faces integer[] (index from 1, n × 1) the faces, as in `state`

---Makes a face of the triangles around one. They lie within its face, their normals differ by at most an angle from that of the
---first, and they lie within a radius. Supports and loads of the former face keep all of it.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchGrowOptions where, and how far
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:grow(options) end

---Where a face grows.
---@class bw.WorkbenchGrowOptions
---@field triangle? integer (index from 1) of the surface; this or `point` is needed
---@field point? bw.Vector (m) near the surface
---@field radius? number (m) above 0. Default: without limit
---@field angle? number (rad) Range: above 0 to pi. Default: 0.35

---Makes faces of what lies within planes and looks towards a direction, such as a rectangle of the screen.
---
---Errors: empty (nothing lies there).
---@param options bw.WorkbenchPatchOptions where
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:patch(options) end

---What lies within planes.
---@class bw.WorkbenchPatchOptions
---@field planes number[][] (any, n × 4) rows {x, y, z, d}: points p with (x, y, z) · p at least d
---@field towards bw.Vector (-) faces look towards this direction

---Does edits on both sides of the plane through the middle of the part. A part whose faces are no mirror images is refused.
---
---Errors: unsupported (the part is not symmetric).
---@param options bw.WorkbenchSymmetryOptions the plane
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:symmetry(options) end

---A plane of symmetry.
---@class bw.WorkbenchSymmetryOptions
---@field across "x"|"y"|"z"|"none" the axis across which both sides are alike

---Chooses the thickness of the body of a drawing. It is refused once the shape was edited.
---
---Errors: unsupported (the file is no drawing, or the shape was edited).
---@param options bw.WorkbenchThicknessOptions the thickness
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:thickness(options) end

---A thickness.
---@class bw.WorkbenchThicknessOptions
---@field thickness number (m) above 0

---Chooses the unit of the file. It is refused once the shape was edited.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchUnitOptions the unit
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:unit(options) end

---A unit.
---@class bw.WorkbenchUnitOptions
---@field unit "mm"|"cm"|"m"|"km"|"um"|"in"|"ft" of the numbers in the file

---Moves faces along their normals. Their triangles stay, neighbours follow within themselves. It is refused where the surface would cross itself.
---
---Errors: geometry, invalid (a face is locked).
---@param options bw.WorkbenchPushOptions which faces, how far
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:push(options) end

---A push.
---@class bw.WorkbenchPushOptions
---@field faces integer[] (index from 1, n × 1) the faces, as in `state`
---@field distance number (m) positive outwards

---Gives a round face, such as a hole, another radius.
---
---Errors: geometry, invalid (the face is not round).
---@param options bw.WorkbenchRadiusOptions the face and its radius
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:radius(options) end

---A radius.
---@class bw.WorkbenchRadiusOptions
---@field face integer (index from 1) the face
---@field radius number (m) above 0

---Moves all faces outwards but those that are locked.
---
---Errors: geometry.
---@param options bw.WorkbenchOffsetOptions how far
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:offset(options) end

---An offset.
---@class bw.WorkbenchOffsetOptions
---@field distance number (m) positive outwards

---A coarse answer for an edit that is not made: what a page shows while a face is dragged. One mesh follows the steps of an edit.
---Its answer has neither a verdict nor an interval. A part without loads has its mass only. The second result is the solution, nil
---without loads.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchTryOptions one of the edits
---@return bw.WorkbenchAnswer? answer on about 1,000 elements
---@return bw.Static|string? static the solution, or the message
---@return bw.Details? details
function Workbench:try(options) end

---Makes the coarse mesh that `try` moves, and with an edit how it moves, so that the first step of a drag is as fast as the others.
---Nothing changes. It is kept until the part changes. A part without loads needs no mesh.
---
---Errors: invalid (with a sentence that says what to do).
---@param options? bw.WorkbenchTryOptions an edit, of any length but 0. Default: the mesh alone
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:prepare_drag(options) end

---An edit that is tried: one of these.
---@class bw.WorkbenchTryOptions
---@field push? bw.WorkbenchPushOptions a push
---@field radius? bw.WorkbenchRadiusOptions a radius
---@field offset? bw.WorkbenchOffsetOptions an offset

---The answer. With loads: whether the part carries them, as `barwright statics` judges. Without loads: the force that breaks it in the worst way, as of `bw.breaking_force`.
---
---Errors: invalid (nothing constrains the part, all of it is constrained, the unit is not confirmed), and those of meshes and solvers.
---@param options? bw.WorkbenchAnswerOptions how accurate
---@return bw.WorkbenchAnswer? answer the answer, which `state` has too
---@return string? message
---@return bw.Details? details
function Workbench:answer(options) end

---What is asked.
---@class bw.WorkbenchAnswerOptions
---@field accuracy? "coarse"|"default"|"fine" about 3,000, 20,000 or 60,000 elements. Default: "default"
---@field force? number (N) without loads: the force that is judged. Default: none

---An answer.
---@class bw.WorkbenchAnswer
---@field kind "statics"|"worst" with loads or without
---@field verdict "holds"|"breaks"|"unsure"|"none" the verdict; "none" where no force is judged
---@field colour? "green"|"red"|"amber" of the verdict; nil of `try`
---@field sentence string the answer in words
---@field utilisation? number (-) stress over strength
---@field low? number (-) lower end of its interval
---@field high? number (-) upper end
---@field factor? number (-) of all loads at which it breaks
---@field force? number (N) that breaks it: of statics the sum of all loads times `factor`
---@field force_low? number (N) lower end of its interval
---@field force_high? number (N) upper end; nil where the stress may be 0 within its error
---@field at bw.Vector (m) where it breaks
---@field max_displacement number (m) the largest displacement
---@field max_stress? number (Pa) the largest von Mises stress
---@field frequency? number (Hz) the lowest natural frequency
---@field mass? number (kg) of the mesh
---@field error? number (-) estimated relative error; nil of `try`
---@field singular? boolean whether the stress there has no finite value; nil of `try`
---@field notes string[] sentences
---@field load? number (N) the sum of the sizes of all loads
---@field contact? number (m2) of the worst load
---@field elements integer (count) of the mesh
---@field seconds number (s) it took
---@field accuracy? "coarse"|"default"|"fine" as it was asked for

---Stress and displacement of the last answer at a point.
---
---Errors: invalid (with a sentence that says what to do).
---@param options bw.WorkbenchProbeOptions the point
---@return bw.WorkbenchProbe? found the values
---@return string? message
---@return bw.Details? details
function Workbench:probe(options) end

---A point.
---@class bw.WorkbenchProbeOptions
---@field point bw.Vector (m) in the part, or nearest to it

---Values at a point.
---@class bw.WorkbenchProbe
---@field point bw.Vector (m) the point
---@field von_mises number (Pa) the von Mises stress
---@field displacement? bw.Vector (m) the displacement; nil without loads, where the stress is the largest of all worst loads

---Places to thicken. Under loads each gain is that of an analysis of the thickened part on a coarse mesh. Without loads it is the advice about the breaking force, and the gain of the first is that of all together.
---
---Errors: invalid (with a sentence that says what to do).
---@param options? bw.WorkbenchAdviceOptions what the part must carry
---@return bw.WorkbenchPlace[]? places best first
---@return string? message
---@return bw.Details? details
function Workbench:advice(options) end

---What is asked of advice.
---@class bw.WorkbenchAdviceOptions
---@field force? number (N) without loads: that it must carry. Default: a quarter above the interval of the answer

---A place to thicken.
---@class bw.WorkbenchPlace
---@field text string in words
---@field at bw.Vector (m) the place
---@field radius number (m) of the bump
---@field offset number (m) its height
---@field gain? number (-) by which the force that breaks it rises

---Thickens a place of the last advice.
---
---Errors: geometry.
---@param options bw.WorkbenchApplyOptions which
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:apply(options) end

---A place of the advice.
---@class bw.WorkbenchApplyOptions
---@field advice integer (index from 1) its number

---Thickens the part around a point by a smooth bump. Locked faces and those with supports stay.
---
---Errors: geometry, limit (too many points).
---@param options bw.WorkbenchThickenOptions the bump
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:thicken(options) end

---A bump.
---@class bw.WorkbenchThickenOptions
---@field at bw.Vector (m) its centre
---@field radius number (m) above 0
---@field offset number (m) its height, above 0

---Thickens weak places until the part carries its loads, or without loads a force in the worst way. The best that was found is kept.
---
---Errors: infeasible (nothing helps), and those of `bw.strengthen`.
---@param options? bw.WorkbenchOptimiseOptions what it must carry
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:optimise(options) end

---What the part must carry.
---@class bw.WorkbenchOptimiseOptions
---@field accuracy? "coarse"|"default"|"fine" without loads: of each analysis. Default: that of the last answer, else "default"
---@field force? number (N) without loads: above 0
---@field factor? number (-) with loads: on all of them. Default: 1
---@field steps? integer (count) at most. Range: 1 to 20. Default: 5

---Takes the last action back, the choice of a unit or a thickness too. `state` names it before, in `undo_words`.
---
---Errors: invalid (with a sentence that says what to do).
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:undo() end

---Repeats the action that was taken back.
---
---Errors: invalid (with a sentence that says what to do).
---@return bw.Workbench? self the workbench
---@return string? message
---@return bw.Details? details
function Workbench:redo() end

---A script that opens the file, repeats every action in force and the answer. It gives the same numbers.
---@return string text Lua
function Workbench:script() end

---Writes the script to a file.
---
---Errors: io.
---@param options? bw.WorkbenchSaveOptions which file
---@return string? path the file
---@return string? message
---@return bw.Details? details
function Workbench:save(options) end

---A script's file.
---@class bw.WorkbenchSaveOptions
---@field path? string Default: the part's path with the ending .workbench.lua

---How far the edited surface lies from that of the file, as it was repaired. Points that no edit moved are equal bit for bit.
---The result is printed as a sentence.
---```lua
---bw.surface.box {max = {0.1, 0.02, 0.01}}:write "beam.stl"
---local bench = assert(bw.workbench.open "beam.stl")
---assert(bench:push {faces = {1}, distance = 0.001})
---print(assert(bench:deviation()).largest) -- 0.001
---```
---
---Errors: memory.
---@return bw.WorkbenchDeviation? deviation how far, and where
---@return string? message
---@return bw.Details? details
function Workbench:deviation() end

---A deviation from the original surface.
---@class bw.WorkbenchDeviation
---@field largest number (m) the largest distance of a point of one surface from the other one
---@field at? bw.Vector (m) that point; nil where nothing has moved
---@field unmoved integer (count) points of the original that the edited surface has, bit for bit
---@field points integer (count) points of the original

---Writes the edited surface.
---
---Errors: io, format.
---@param options bw.WorkbenchExportOptions which file
---@return string? path the file
---@return bw.WorkbenchDeviation|string|nil deviation how far it lies from the original, or the message
---@return bw.Details? details
function Workbench:export(options) end

---A surface's file.
---@class bw.WorkbenchExportOptions
---@field path string its ending says the format, as of `surface:write`

---All that a page shows, as a plain table: docs/workbench.md lists its fields.
---@return table<string, any> state the state
function Workbench:state() end
