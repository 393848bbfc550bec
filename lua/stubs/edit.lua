---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Edit sessions
--
-- Parts that are posed and thickened by their skeleton and solved again after each edit.

---Making edit sessions and replaying scripts of edits.
---@class bw.EditModule
---@overload fun(part: bw.Model, options?: bw.EditOptions): bw.Session?, string?, bw.Details?
---@field class table the methods of sessions
---@field properties table the properties of sessions
local edit_module = {}

---Begins an edit session on a part: cuts its mesh into domains along a skeleton.
---@param part bw.Model
---@param options? bw.EditOptions
---@return bw.Session? session
---@return string? message
---@return bw.Details? details
function edit_module:__call(part, options) end

---Replays a script of edits, into a session or into the one that the script makes. A line that was
---cut off at the end of a journal is passed over. {resume = true}: the file goes on as the journal.
---@param path string
---@param session? bw.Session
---@param options? bw.EditLoadOptions
---@return bw.Session?
---@return boolean|string cut whether a line was cut off; or a message
---@return bw.Details? details
function edit_module.load(path, session, options) end

---@class bw.EditLoadOptions
---@field resume? boolean

---What a saved script begins with: the session it is replayed into, or a new one on the part (and the
---options) that the file `script` returns.
---@param script? string
---@param session? bw.Session
---@return bw.Session
function edit_module.begin(script, session) end

---@class bw.EditOptions
---@field skeleton? bw.Skeleton left out: extracted from the part's surface
---@field bones? integer wanted of the extracted skeleton; 0 (default): as many as the shape asks for
---@field threshold? number mean weight from which an element follows one bone; default 0.95
---@field thresholds? table<string, number> instead of it, for single bones
---@field share? number the threshold is lowered until each bone has this share of the elements that it moves most; default 0.35, 0: never
---@field heat? number of the skinning weights; default 20; larger: more elements follow one bone
---@field domains? bw.Domains ready-made ones, of the part's own mesh
---@field quality? number elements poorer than this (mean ratio, 1: regular) are relaxed; default 0.02
---@field relax? boolean relax inner nodes where an edit inverts elements; default true
---@field refill? boolean refill domains where that fails; default true
---@field material_turns? boolean an orthotropic material's axes turn with the bones; default false: they stay, as where the edited shape is printed the same way up
---@field journal? string a script that every edit is added to at once; an older journal becomes path~, any other file there is refused
---@field script? string a file that returns the part and these options, named by saved scripts

---A part that is posed and thickened by its skeleton and solved again after each edit. Edits return
---something true, or nil, message, details when the world is against them (details.status "geometry":
---elements would be inverted, `element` is the worst); then the session is as it was. Supports and
---loads go with the surface; those added to the part later count from the next solve. A part of
---order 2 is advised; an order 1 part stays one.
---@class bw.Session
---@field part bw.Model as it is now
---@field mesh bw.Mesh as it is now
---@field rest bw.Mesh
---@field domains bw.Domains
---@field skeleton bw.Skeleton at rest
---@field joints bw.Array where the joints are now
---@field current_pose bw.Array see bw.Skeleton:rest_pose
---@field edits table[] in force: {script, mesh = "posed" | "relaxed" | "refilled"}
local Session = {}

---A bone to turn, scale and move.
---@param name string|integer
---@return bw.Bone
function Session:bone(name) end

---Sets several bones as one edit: {thigh = {scale =, rotation =, translation =}, ...}, the whole
---change since rest of each; what is left out stays.
---@param changes table<string, table>
---@return bw.Session?
---@return string? message
---@return bw.Details? details
function Session:pose(changes) end

---Inverse kinematics: turns bones until a joint (or a bone's tail) is at a place; or several, with a
---list {{joint = | bone =, at =, along =, weight =, from = first bone that may turn}, ...}.
---@param target string|table[]
---@param at? bw.Vector m
---@param options? bw.SessionReachOptions
---@return table? report distance, iterations, reached (false: limits or lengths are in the way)
---@return string? message
---@return bw.Details? details
function Session:reach(target, at, options) end

---@class bw.SessionReachOptions
---@field tolerance? number

---How far a bone (or every bone whose head is a joint) may turn against its parent in `reach`, in
---degrees; nil lifts the limit.
---@param name string|integer
---@param limit? bw.BoneLimit
---@return bw.Session?
function Session:limit(name, limit) end

---@class bw.BoneLimit
---@field swing number
---@field twist number[]

---Gives elements to a bone's domain, or takes them out of those that follow a bone, as an edit. On a
---refilled mesh, of which `elements` are, the domains change as they were before it was refilled, and the
---pose is mended anew: the mesh after it may be another one.
---@param elements bw.Array|integer[]
---@param bone? string|integer
---@return bw.Session?
---@return string? message
---@return bw.Details? details
function Session:assign(elements, bone) end

---Everything back to rest, as an edit.
---@return bw.Session?
function Session:reset() end

---Takes back the last edit; to any depth.
---@return bw.Session?
---@return string? message
---@return bw.Details? details
function Session:undo() end

---@return bw.Session?
---@return string? message
---@return bw.Details? details
function Session:redo() end

---A session that begins where this one is, with the same equations and no journal, to try edits in (a
---drag of a hand). {relax =, refill =} as in bw.EditOptions.
---@param options? bw.SessionForkOptions
---@return bw.Session
function Session:fork(options) end

---@class bw.SessionForkOptions
---@field relax? boolean
---@field refill? boolean

---The pose that a fork has come to, as one edit.
---@param fork bw.Session
---@return bw.Session?
---@return string? message
---@return bw.Details? details
function Session:adopt(fork) end

---An edit made of a change {script, pose, limits, topology}, for Lua files that add edits.
---@param change table
---@return table? state
---@return string? message
---@return bw.Details? details
function Session:commit(change) end

---The static solution of the part as it is now; `reused` of it tells what the edit left standing.
---`part`: another load case, a model of the mesh as it was given (other supports need another factor).
---@param options? bw.SessionSolveOptions
---@return bw.Static?
---@return string? message
---@return bw.Details? details
function Session:solve(options) end

---@class bw.SessionSolveOptions
---@field method? "auto"|"refactor"|"iterate"|"pcg"|"scratch"
---@field tolerance? number
---@field precision? 32|64
---@field check? boolean
---@field inertia_relief? boolean
---@field balance_tolerance? number
---@field part? bw.Model

---Scales the bones near high stresses across themselves (their axes y and z) until no node's von Mises
---stress is above the limit, changing the shape least: the sum over the corner nodes of the squares of
---their moves. One edit, which undo takes back. When the limit cannot be met: nil, message, details
---with status "infeasible" (or "convergence", or "cancelled" after Ctrl-C) and `best`, a report of the
---best that was found; the session is then as it was. Supports do not move unless `move_supports` is set, so that
---what is too high next to a support may be out of the bones' reach.
---@param options bw.OptimiseOptions
---@return bw.Optimisation?
---@return string? message
---@return bw.Details? details
function Session:optimise(options) end

---The session's equations, brought to the current shape, and the model they are of.
---@return bw.LocalSystem?
---@return bw.Model|string model or a message
---@return bw.Details? details
function Session:synchronise() end

---Another model of the part's first mesh (another load case) on the current shape.
---@param part bw.Model
---@return bw.Model?
---@return string? message
---@return bw.Details? details
function Session:moved(part) end

---The boundary as it is now: `session:surface():write("part.stl")`.
---@return bw.Surface?
function Session:surface() end

---Fields of the current shape as .vtu: those of bw.Static:write, and the domains.
---@param path string
---@param options? bw.SessionWriteOptions
---@return true?
---@return string? message
---@return bw.Details? details
function Session:write(path, options) end

---@class bw.SessionWriteOptions
---@field fields? table

---A picture of the current shape under its loads.
---@param path string
---@param options? bw.PictureOptions with `field`
---@return true?
---@return string? message
---@return bw.Details? details
function Session:picture(path, options) end

---One HTML file with a 3D view of the shape under its loads and as it was drawn, what the bones were
---changed by, and the edits.
---@param path string
---@param options? bw.SessionReportOptions
---@return true?
---@return string? message
---@return bw.Details? details
function Session:report(path, options) end

---@class bw.SessionReportOptions
---@field title? string
---@field manifest? table

---The edits in force as a script that replays them.
---@param path string
---@return true?
---@return string? message
---@return bw.Details? details
function Session:save(path) end

---Checks that all parts of the session belong together, for tests and debugging. Raises where they do not.
---@return bw.Session
function Session:check() end

---Lets go of the equations and all states at once, and ends the journal.
function Session:close() end

---A bone of a session. Edits give the bone back, so that they can be chained.
---@class bw.Bone
---@field name string
---@field index integer
---@field session bw.Session
---@field head string joint
---@field tail string joint
---@field parent string? bone
---@field children string[] bones
---@field domain integer? the domain that follows this bone alone
---@field from bw.Vector where its head is now
---@field to bw.Vector where its tail is now
---@field factors bw.Vector its scale
---@field rotation number[][] against its parent, three rows
---@field translation bw.Vector of its head, in its parent's directions
local Bone = {}

---Scaled by factors along it and across it, or by one factor, on top of what it has.
---@param factors bw.Vector|number
---@return bw.Bone?
---@return string? message
---@return bw.Details? details
function Bone:scale(factors) end

---Turned about its head, with all that hangs on it: {axis =, degrees = | radians =}, {x =, y =, z =} in
---degrees (about x first), or three rows of a rotation. Directions are those of space.
---@param turn table
---@return bw.Bone?
---@return string? message
---@return bw.Details? details
function Bone:rotate(turn) end

---Moved by a vector in metres, with all that hangs on it.
---@param vector bw.Vector
---@return bw.Bone?
---@return string? message
---@return bw.Details? details
function Bone:translate(vector) end

---Sets its whole change since rest; what is left out stays.
---@param change bw.BoneChange
---@return bw.Bone?
---@return string? message
---@return bw.Details? details
function Bone:set(change) end

---@class bw.BoneChange
---@field scale bw.Vector
---@field rotation table
---@field translation bw.Vector

---Back to rest.
---@return bw.Bone?
---@return string? message
---@return bw.Details? details
function Bone:reset() end
