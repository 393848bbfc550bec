---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Edit sessions
--
-- Parts that are posed and thickened by their skeleton, and solved again after each edit by updating only what the edit changed.
-- docs/tutorial_edit.md begins at the beginning; the theory is in docs/theory/edit.md.

---Beginning edit sessions, and replaying scripts of edits.
---@class bw.EditModule
---@overload fun(part: bw.Model, options?: bw.EditOptions): bw.Session?, string?, bw.Details?
---@field class table<string, any> the methods of sessions
---@field properties table<string, any> the properties of sessions
local edit_module = {}

---Begins an edit session on a part: its mesh is cut into subdomains along a skeleton.
---
---Errors: geometry (no skeleton can be extracted, or the skeleton lies far outside of the part), limit (the extraction took too
---long), singular (the equations of the weights have no solution), io (the journal cannot be written), unsupported (the part has a
---cyclic symmetry).
---
---Source: Y. Xie and others, Agile structural analysis for fabrication-aware shape editing (2015); docs/theory/edit.md.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}, order = 2}
---local skeleton = bw.skeleton.create {joints = {{0.005, 0, 0}, {0.05, 0, 0}, {0.095, 0, 0}}, bones = {{1, 2}, {2, 3}}}
---local part = bw.model({mesh = mesh, material = bw.material.pla}):fix(mesh.boundary:below("x", 0))
---local session = assert(bw.edit(part, {skeleton = skeleton}))
---print(session)
---```
---@param part bw.Model the part, with its supports and loads; order 2 is advised
---@param options? bw.EditOptions skeleton and subdomains
---@return bw.Session? session the session
---@return string? message
---@return bw.Details? details
function edit_module:__call(part, options) end

---Replays a script of edits, into a session or into the one that the script makes. A line that was cut off at the end of a journal
---is passed over.
---
---Errors: io (the file cannot be read), format (it is no such script, or an edit fails; the message names the line), cancelled.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}}
---local how = {skeleton = bw.skeleton.create {joints = {{0.005, 0, 0}, {0.05, 0, 0}, {0.095, 0, 0}}, bones = {{1, 2}, {2, 3}}}}
---local function begin() return assert(bw.edit(bw.model {mesh = mesh, material = bw.material.pla}, how)) end
---local session = assert(begin():bone("bone 2"):scale(1.2)).session
---assert(session:save "edits.lua")
---print(assert(bw.edit.load("edits.lua", begin())))
---```
---@param path string the script
---@param session? bw.Session that the edits are made in. Default: the one that the script begins
---@param options? bw.EditLoadOptions whether the file goes on
---@return bw.Session? session with the edits
---@return boolean|string cut whether a line was cut off; or the message
---@return bw.Details? details
function edit_module.load(path, session, options) end

---Whether a script goes on.
---@class bw.EditLoadOptions
---@field resume? boolean the file becomes the journal of the session. Default: false

---What a saved script begins with: the session that it is replayed into, or a new one on the part (and the options) that the file
---`script` returns.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}}
---local skeleton = bw.skeleton.create {joints = {{0.005, 0, 0}, {0.05, 0, 0}, {0.095, 0, 0}}, bones = {{1, 2}, {2, 3}}}
---local session = assert(bw.edit(bw.model {mesh = mesh, material = bw.material.pla}, {skeleton = skeleton}))
---print(bw.edit.begin(nil, session) == session) -- true
---```
---@param script? string a file that returns the part. Needed where there is no session
---@param session? bw.Session that it is replayed into
---@return bw.Session session the session
function edit_module.begin(script, session) end

---How a session begins.
---@class bw.EditOptions
---@field skeleton? bw.Skeleton inside of the part. Default: extracted from its surface
---@field bones? integer (count) wanted of the extracted skeleton. Default: 0, as many as the shape asks for
---@field threshold? number (-) mean weight from which an element follows one bone. Range: above 0 to 1. Default: 0.95
---@field thresholds? table<string, number> in its place, for single bones by name. Default: none
---@field fraction? number (-) thresholds are lowered until each bone has this fraction of the elements that it moves most; 0: never. Range: 0 to 1. Default: 0.35
---@field heat? number (-) of the skinning weights, above 0; larger: more elements follow one bone. Default: 20
---@field surface? bw.Surface|false that the mesh was made from: `session:surface` is this one, edited; false: the boundary of the mesh. Default: what `bw.mesh.fill` filled, where the part's mesh comes from it
---@field subdomains? bw.Subdomains of the part's own mesh. Default: made from skeleton and weights
---@field quality? number (-) elements of a lower shape quality (`mesh:shapes`) are relaxed. Range: 0 to 0.5. Default: 0.02
---@field relax? boolean relax inner nodes where an edit inverts elements. Default: true
---@field refill? boolean refill subdomains where that fails. Default: true
---@field rotate_material? boolean the axes of an orthotropic material turn with the bones. Default: false, they stay
---@field journal? string a script that every edit is added to at once; an older journal becomes path~, any other file there is refused. Default: none
---@field script? string a file that returns the part and these options, named by saved scripts. Default: none

---A part that is posed and thickened by its skeleton. Edits return something true; where one fails the session is as it was. Supports
---and loads go with the surface; those that are added to the part later count from the next solution. `print` lists the last edits.
---
---Bonds, attachments and couplings go with the surface too, and remote points keep their place. An edit that takes the faces of a bond
---apart is refused. Each solution then recomputes the factor of the joined equations; the stiffness of subdomains is reused. `optimise`
---refuses such parts.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}, order = 2}
---local skeleton = bw.skeleton.create {joints = {{0.005, 0, 0}, {0.05, 0, 0}, {0.095, 0, 0}}, bones = {{1, 2}, {2, 3}}}
---local part = bw.model({mesh = mesh, material = bw.material.pla}):fix(mesh.boundary:below("x", 0))
---local session = assert(bw.edit(part:load {on = mesh.boundary:above("x", 0.1), force = {0, 0, -10}}, {skeleton = skeleton}))
---assert(session:bone("bone 2"):rotate {y = 20})
---print(assert(session:solve()).von_mises:max(), session.edits[1].script)
---```
---@class bw.Session
---@field part bw.Model as it is now
---@field mesh bw.Mesh as it is now
---@field rest bw.Mesh as it was given
---@field subdomains bw.Subdomains of the mesh
---@field skeleton bw.Skeleton at rest
---@field joints bw.Array (m, joint_count × 3, per joint) where they are now
---@field current_pose bw.Array (any, bone_count × 15, per bone) as of `skeleton:rest_pose`
---@field edits bw.SessionEdit[] in force, the oldest first
local Session = {}

---What became of the surface of a session.
---@class bw.EditedSurface
---@field triangles integer (count) of the result
---@field triangles_before integer (count) of the surface that was given
---@field largest_displacement number (m) of a point by the edits
---@field deviation number (m) largest distance between the result and the boundary of the mesh, which is what was analysed
---@field source "original"|"boundary" the surface that the mesh was made from, or the boundary of the mesh
---@field sound boolean no defects: closed, oriented and free of crossings
---@field defects integer (count) crossings, triangles without area and other defects of the result
---@field defects_before integer (count) of the surface before the edit
---@field defects_of_original? integer (count) that the edit would give the original, where the boundary is the result in its place

---An edit of a session.
---@class bw.SessionEdit
---@field script string the line that replays it
---@field mesh "posed"|"relaxed"|"refilled" how the mesh of the shape was made

---A bone to turn, scale and move. An unknown one raises.
---@param name string|integer (index from 1) its name or number
---@return bw.Bone bone the bone
function Session:bone(name) end

---Sets several bones as one edit. What is left out stays.
---
---Errors: geometry (elements would be inverted; details: `element`, the worst, and `inverted`, how many), io (the journal).
---@param changes table<string, bw.BoneChange> by bone: its whole change since rest
---@return bw.Session? self the session
---@return string? message
---@return bw.Details? details
function Session:pose(changes) end

---Inverse kinematics as one edit: turns bones until joints, or tails of bones, are at places, as nearly as limits allow.
---
---Errors: geometry, io (as of `pose`).
---@param target string|integer|bw.SessionReachTarget[] (index from 1) a joint or a bone; or a list of targets
---@param at? bw.Vector (m) of a single target: the place; of a list the options stand here
---@param options? bw.SessionReachOptions when a target counts as met
---@return bw.ReachReport? report how it went
---@return string? message
---@return bw.Details? details
function Session:reach(target, at, options) end

---A place that a joint or a bone is to reach: exactly one of the two.
---@class bw.SessionReachTarget
---@field joint? string|integer (index from 1) the joint
---@field bone? string|integer (index from 1) the bone
---@field at bw.Vector (m) the place
---@field along? number (-) of a bone: which point of it, 0: the head, 1: the tail. Default: 1
---@field weight? number (-) beside other targets, above 0. Default: 1
---@field from? string|integer (index from 1) the first bone that may turn. Default: from the root on

---When a target counts as met.
---@class bw.SessionReachOptions
---@field tolerance? number (m) the largest distance. Default: 1e-6 of the skeleton's size

---Sets how far a bone (or every bone whose head is a joint) may turn against its parent in `reach`, as an edit.
---
---Errors: io (the journal cannot be written).
---@param name string|integer (index from 1) a bone or a joint
---@param limit? bw.BoneLimit the limit. Default: none, which lifts it
---@return bw.Session? self the session
---@return string? message
---@return bw.Details? details
function Session:limit(name, limit) end

---How far a bone may turn.
---@class bw.BoneLimit
---@field swing? number (degrees) largest angle between the bone and where its parent would carry it. Range: 0 to 180. Default: none
---@field twist? number[] (degrees, 2) {lowest, highest} angle about the bone's own axis. Default: none

---Gives elements to a bone's subdomain, or takes them out of those that follow a bone, as an edit. On a refilled mesh, of which
---`elements` are, the subdomains change as they were before it was refilled; the mesh after it may be another one. An element by which
---a subdomain would fall apart raises.
---
---Errors: geometry, io (as of `pose`).
---@param elements bw.Array|integer[] (index from 1, n × 1) the elements
---@param bone? string|integer (index from 1) the bone. Default: none, they are taken out
---@return bw.Session? self the session
---@return string? message
---@return bw.Details? details
function Session:assign(elements, bone) end

---Gives a region of the mesh, or the whole part, another material, as an edit; the other regions keep theirs. The next solution
---updates the elements of the region and what of the factor they reach. The equations are made again for a law that is not isotropic
---where its axes turn with the bones, or where the part had none such before. Other load cases of the session get the material too.
---Saved scripts have the name of a material of the library, or its constants without those of heat. An unknown region raises.
---
---Errors: io (the journal cannot be written).
---@param material bw.Material the same in all elements
---@param region? string its name. Default: none, the whole part
---@return bw.Session? self the session
---@return string? message
---@return bw.Details? details
function Session:set_material(material, region) end

---Sets the bones back to rest, as an edit.
---
---Errors: io (the journal cannot be written).
---@return bw.Session? self the session
---@return string? message
---@return bw.Details? details
function Session:reset() end

---Takes back the last edit, to any depth.
---
---Errors: empty (there is nothing to undo), io (the journal cannot be written).
---@return bw.Session? self the session
---@return string? message
---@return bw.Details? details
function Session:undo() end

---Makes the edit again that was taken back.
---
---Errors: empty (there is nothing to redo), io (the journal cannot be written).
---@return bw.Session? self the session
---@return string? message
---@return bw.Details? details
function Session:redo() end

---A session that begins where this one is, with the same equations and no journal, to try edits in.
---@param options? bw.SessionForkOptions what is done about inverted elements
---@return bw.Session fork the new session
function Session:fork(options) end

---What a fork does about inverted elements.
---@class bw.SessionForkOptions
---@field relax? boolean as of `bw.EditOptions`. Default: that of the session
---@field refill? boolean as of `bw.EditOptions`. Default: that of the session

---Makes one edit of the pose that a fork has come to. Other sessions raise.
---
---Errors: geometry, io (as of `pose`).
---@param fork bw.Session of this session
---@return bw.Session? self the session
---@return string? message
---@return bw.Details? details
function Session:adopt(fork) end

---Makes an edit of a change, for Lua files that add edits. A change that is none raises.
---
---Errors: geometry, io (as of `pose`).
---@param change bw.SessionChange what becomes other; what is left out stays
---@return table<string, any>? state of the session, for the file that made it
---@return string? message
---@return bw.Details? details
function Session:commit(change) end

---A change of a session.
---@class bw.SessionChange
---@field script string the line that replays it
---@field pose? number[][] (any, bone_count × 15, per bone) as of `skeleton:rest_pose`
---@field limits? table<integer, bw.ReachLimit> by the bones' numbers
---@field topology? table<string, any> as barwright.edit_shape makes it
---@field materials? bw.SessionMaterial[] each over those before it

---A material of a change.
---@class bw.SessionMaterial
---@field material bw.Material the same in all elements
---@field region? string its name. Default: none, the whole part

---Solves the part as it is now. `reused` of the solution lists what was reused.
---
---Errors: those of `model:solve`, and unsupported (B-bar elements).
---@param options? bw.SessionSolveOptions how it is solved
---@return bw.Static? static the solution
---@return string? message
---@return bw.Details? details
function Session:solve(options) end

---How a session is solved.
---@class bw.SessionSolveOptions: bw.IncrementalSolveOptions
---@field part? bw.Model another load case: a model of the mesh as it was given. Other supports need another factor. Default: the part

---Scales the bones near high stresses across themselves (their axes y and z) until no node's von Mises stress is above a limit, with
---the smallest change of the shape: the sum over the corner nodes of the squares of their moves. It is one edit. Where it fails the
---session is as it was, and `details.best` is a `bw.Optimisation` of the best that was found.
---
---Errors: infeasible (no factors within the bounds meet the limit), convergence (it was not met in time, or the worst load went on
---changing), unsupported (a slide along the surface's own normals, B-bar or curved elements, a body that is constrained in part and turns
---freely), cancelled, those of `solve`.
---
---Source: Y. Xie and others 2015, section 7; docs/theory/edit.md.
---@param options bw.OptimiseOptions the limit, and what may change
---@return bw.Optimisation? report what was found
---@return string? message
---@return bw.Details? details
function Session:optimise(options) end

---The equations of the session, updated to the current shape, and the model that they belong to.
---
---Errors: those of `solve`.
---@return (bw.IncrementalSystem|bw.JoinedIncrementalSystem)? system the equations
---@return bw.Model|string model of the current shape, or the message
---@return bw.Details? details
function Session:synchronise() end

---Another load case on the current shape.
---
---Errors: geometry, unsupported (as of `model:moved` and `model:transferred`).
---@param part bw.Model of the mesh as it was given
---@return bw.Model? model on the current mesh
---@return string? message
---@return bw.Details? details
function Session:moved(part) end

---The surface as it is now: `session:surface():write("part.stl")`. It is the surface that the mesh was made from, moved as the mesh
---was: its points stay in their order, and its triangles are split only where the edit bends within one. Flat parts that bend may get
---other triangles. Where the edit makes it cross itself, and where the mesh was not filled from a surface, it is the boundary of the mesh.
---
---Errors: memory, limit (it would have too many triangles), cancelled.
---@return bw.Surface? surface with outward facets
---@return bw.EditedSurface|string report what was done, or the message
---@return bw.Details? details
function Session:surface() end

---Writes the surface as it is now to a file: `print(session:export("part.stl", {unit = "mm"}))`.
---
---Errors: those of `surface`; io (the file cannot be written), unsupported (an ending that is not known).
---@param path string the file: STL, OBJ, PLY, OFF or 3MF by its ending
---@param options? bw.SurfaceWriteOptions the unit
---@return bw.EditedSurface? report what was done, with the deviation from what was analysed
---@return string? message
---@return bw.Details? details
function Session:export(path, options) end

---Writes the fields of the current shape to a .vtu file: those of `static:write`, and the subdomains.
---
---Errors: io (the file cannot be written), those of `solve`.
---@param path string the file
---@param options? bw.MeshWriteOptions further fields, unit and version
---@return true? written true
---@return string? message
---@return bw.Details? details
function Session:write(path, options) end

---Draws the current shape under its loads as a PNG file.
---
---Errors: those of `bw.picture` and of `solve`.
---@param path string the file
---@param options? bw.StaticPictureOptions what is drawn and how
---@return true? drawn true
---@return string? message
---@return bw.Details? details
function Session:picture(path, options) end

---Writes one HTML file with a 3D view of the shape under its loads and as it was given, what the bones were changed by, and the
---edits.
---
---Errors: io (the file cannot be written), those of `solve`.
---@param path string the file
---@param options? bw.SessionReportOptions title and manifest
---@return true? written true
---@return string? message
---@return bw.Details? details
function Session:report(path, options) end

---What a report names.
---@class bw.SessionReportOptions
---@field title? string of the page. Default: chosen
---@field manifest? table<string, any> what the results depend on. Default: the version

---Writes the edits in force as a script that replays them.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@return true? written true
---@return string? message
---@return bw.Details? details
function Session:save(path) end

---Checks that all parts of the session belong together, for tests and debugging. Raises where they do not.
---@return bw.Session self
function Session:check() end

---Releases the equations and all states at once, and ends the journal.
function Session:close() end

---A bone of a session. Edits return the bone, so that they can be chained.
---```lua
---local mesh = bw.mesh.box {min = {0, -0.01, -0.01}, max = {0.1, 0.01, 0.01}, cells = {20, 4, 4}}
---local skeleton = bw.skeleton.create {joints = {{0.005, 0, 0}, {0.05, 0, 0}, {0.095, 0, 0}}, bones = {{1, 2}, {2, 3}}}
---local session = assert(bw.edit(bw.model {mesh = mesh, material = bw.material.pla}, {skeleton = skeleton}))
---local bone = session:bone "bone 2"
---print(assert(bone:scale {1, 1.2, 1.2}), bone.factors[2])
---```
---@class bw.Bone
---@field name string its name
---@field index integer (index from 1) its number
---@field session bw.Session that it belongs to
---@field head string the joint nearer the root
---@field tail string the other joint
---@field parent string? the bone that it hangs on; nil at the root
---@field children string[] the bones that hang on it
---@field subdomain integer? (index from 1) the subdomain that follows this bone alone; nil where there is none
---@field from bw.Vector (m) where its head is now
---@field to bw.Vector (m) where its tail is now
---@field factors bw.Vector (-) its scale along and across it
---@field rotation number[][] (-, 3 × 3) against its parent
---@field translation bw.Vector (m) of its head, in its parent's directions
local Bone = {}

---Scales the bone along itself and across itself, on top of what it has.
---
---Errors: geometry, io (as of `session:pose`).
---@param factors bw.Vector|number (-) above 0; one number for all three
---@return bw.Bone? self the bone
---@return string? message
---@return bw.Details? details
function Bone:scale(factors) end

---Rotates the bone about its head, with all that hangs on it, on top of what it has. Directions are those of space.
---
---Errors: geometry, io (as of `session:pose`).
---@param turn bw.BoneTurn|number[][] (-, 3 × 3) the rotation, or its three rows
---@return bw.Bone? self the bone
---@return string? message
---@return bw.Details? details
function Bone:rotate(turn) end

---A rotation: an axis with an angle, or angles about x, y and z, in this order.
---@class bw.BoneTurn
---@field axis? bw.Vector (-) with exactly one of `degrees` and `radians`
---@field degrees? number (degrees) about the axis
---@field radians? number (rad) about the axis
---@field x? number (degrees) about x
---@field y? number (degrees) about y
---@field z? number (degrees) about z

---Moves the bone, with all that hangs on it, on top of what it has.
---
---Errors: geometry, io (as of `session:pose`).
---@param vector bw.Vector (m) in directions of space
---@return bw.Bone? self the bone
---@return string? message
---@return bw.Details? details
function Bone:translate(vector) end

---Sets the whole change of the bone since rest. What is left out stays.
---
---Errors: geometry, io (as of `session:pose`).
---@param change bw.BoneChange the change
---@return bw.Bone? self the bone
---@return string? message
---@return bw.Details? details
function Bone:set(change) end

---The change of a bone since rest.
---@class bw.BoneChange
---@field scale? bw.Vector|number (-) along and across it, above 0
---@field rotation? bw.BoneTurn|number[][] (-, 3 × 3) against its parent, or its three rows
---@field translation? bw.Vector (m) of its head, in its parent's directions

---Sets the bone back to rest.
---
---Errors: geometry, io (as of `session:pose`).
---@return bw.Bone? self the bone
---@return string? message
---@return bw.Details? details
function Bone:reset() end
