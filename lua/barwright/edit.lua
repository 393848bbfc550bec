-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edit sessions: a part is posed and thickened by its skeleton, and solved again after each edit by
-- touching only what the edit changed. docs/theory/edit.md explains how.
--
-- A session is a list of states and the place of the current one. A state is a topology, a pose, the
-- limits of the joints and the materials of regions that became others; it never changes. Everything else
-- (mesh, model, equations) follows from it, so that a refused edit leaves nothing to put right, and undo
-- is a step back in the list.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local members = require "barwright.members"
local options = require "barwright.options"
local edit_assign = require "barwright.edit_assign"
local edit_check = require "barwright.edit_check"
local edit_bone = require "barwright.edit_bone"
local edit_follow = require "barwright.edit_follow"
local edit_material = require "barwright.edit_material"
local edit_pose = require "barwright.edit_pose"
local edit_report = require "barwright.edit_report"
local edit_script = require "barwright.edit_script"
local edit_shape = require "barwright.edit_shape"
local edit_surface = require "barwright.edit_surface"
local optimise = require "barwright.optimise"
local original_surface = require "barwright.original_surface"

local raise = core.raise

local class = {__name = "barwright.session"}
local properties = {}

local rules = {
  skeleton = {type = "skeleton"}, -- left out: extracted from the surface
  bones = {type = "integer", default = 0, min = 0}, -- wanted of the extracted one
  surface = {type = "any"}, -- that the mesh was made from, which is edited along; false: the mesh's boundary
  subdomains = {type = "subdomains"}, -- left out: from weights and thresholds
  -- of the subdomains; left out: the engine's own
  threshold = {type = "number", above = 0, max = 1},
  thresholds = {type = "table", default = {}}, -- of single bones, by name
  fraction = {type = "number", min = 0, max = 1}, -- of what a bone moves most
  heat = {type = "number", above = 0},
  quality = {type = "number", default = 0.02, min = 0, max = 0.5},
  relax = {type = "boolean", default = true},
  refill = {type = "boolean", default = true},
  rotate_material = {type = "boolean", default = false},
  journal = {type = "string"},
  script = {type = "string"},
}

-- ---- beginning -----------------------------------------------------------------------------------

local function bone_thresholds(skeleton, given)
  local rows, count = {}, skeleton.bone_count
  for b = 1, count do rows[b] = 0 end
  for name, threshold in pairs(given) do
    local bone = skeleton:bone(name)
    if type(threshold) ~= "number" or not (threshold > 0 and threshold <= 1) then
      raise(("edit: thresholds: bone '%s': a number above 0, at most 1, expected, got %s"):format(bone.name,
        core.got(threshold)))
    end
    rows[bone.index] = threshold
  end
  return rows
end

-- A skeleton far outside of the part, or many times its size, is one in another unit or of another part:
-- it would move nothing, or everything alike.
local function misplaced(skeleton, mesh)
  local box, joints, size, inside = mesh.box, skeleton.joints:totable(), 0, 0
  for k = 1, 3 do size = math.max(size, box.size[k]) end
  for _, at in ipairs(joints) do
    local out = 0
    for k = 1, 3 do out = math.max(out, box.min[k] - at[k], at[k] - box.max[k]) end
    if out <= size then inside = inside + 1 end
  end
  if 2 * inside >= #joints then return nil end
  return ("%d of the skeleton's %d joints are farther from the part than it is long (%s): is its "
    .. "unit that of the part?"):format(#joints - inside, #joints, core.quantity(size, "m"))
end

local function make_subdomains(mesh, opts)
  local skeleton, message, details = opts.skeleton
  if not skeleton then
    local surface
    surface, message, details = mesh:surface()
    if not surface then return nil, message, details end
    skeleton, message, details = core.skeleton.extract(surface, {bones = opts.bones})
    if not skeleton then return nil, message, details end
  end
  message = misplaced(skeleton, mesh)
  if message then return nil, message, {status = "geometry"} end
  local thresholds = bone_thresholds(skeleton, opts.thresholds)
  local weights
  weights, message, details = core.skinning_weights(mesh, skeleton, {heat = opts.heat})
  if not weights then return nil, message, details end
  return core.subdomains(mesh, skeleton, weights, {threshold = opts.threshold,
    bone_threshold = thresholds, fraction = opts.fraction == 0 and -1 or opts.fraction})
end

--- Begins a session on a part. Returns nil, message, details when it cannot.
local function begin(part, given)
  options.object("edit", "part", part, "model")
  local opts = options.read("edit", given, rules)
  if opts.surface == nil then
    opts.surface = original_surface.of(part)
  elseif opts.surface ~= false then
    options.object("edit", "surface", opts.surface, "surface")
  end
  if opts.rotate_material and part.material.rotated_by_element then
    raise("edit: option 'rotate_material': the material axes of the part differ by element already")
  end
  local message, details
  if part.cyclic_symmetry then return core.refuse_joints(part) end
  local mesh, subdomains = part.mesh, opts.subdomains
  if subdomains and subdomains.mesh ~= mesh then
    raise("edit: option 'subdomains': subdomains of the part's mesh expected, got those of another")
  end
  if not subdomains then
    subdomains, message, details = make_subdomains(mesh, opts)
    if not subdomains then return nil, message, details end
  end
  local topology = edit_shape.topology(subdomains, edit_shape.floor(mesh, opts.quality))
  local pose = edit_pose.rest(subdomains.skeleton.bone_count)
  local shape
  shape, message, details = edit_shape.of(topology, pose, opts)
  if not shape then return nil, message, details end
  local self = setmetatable({source = part, opts = opts, position = 1, following = false,
    last = false, record = false, root = false,
    history = {{topology = topology, pose = pose, limits = {}, materials = {}, shape = shape}}}, class)
  if opts.journal then
    local record
    record, message, details = edit_script.open_journal(opts.journal, opts.script)
    if not record then return nil, message, details end
    self.record = record
  end
  return self
end

-- ---- states --------------------------------------------------------------------------------------

local function current(self)
  if getmetatable(self) ~= class then
    raise("call a session's methods with a colon, as in session:solve()")
  end
  local state = self.history[self.position]
  if not state then raise("this session is closed") end
  return state
end

-- Meshes far from the current state are let go: they follow from the pose.
local function forget_far_shapes(self)
  for i, state in ipairs(self.history) do
    if math.abs(i - self.position) > 3 then state.shape = nil end
  end
end

local function ensure_shape(self, state)
  if not state.shape then
    local shape, message, details = edit_shape.of(state.topology, state.pose, self.opts)
    if not shape then return nil, message, details end
    state.shape = shape
  end
  return state.shape
end

-- Makes an edit: {script =, pose =, limits =, topology =, materials =}; what is left out stays. All that may fail
-- comes before the list of states is touched.
local function commit(self, edit)
  local before = current(self)
  local state = {topology = edit.topology or before.topology, pose = edit.pose or before.pose,
    limits = edit.limits or before.limits, materials = edit.materials or before.materials,
    script = edit.script, note = "posed"}
  if edit.pose or edit.topology then
    local shape, message, details = edit_shape.repaired(state.topology, state.pose, self.opts)
    if not shape then return nil, message, details end
    state.topology, state.shape, state.note = shape.topology, shape, shape.how
    local refilled = shape.topology.refilled and shape.topology ~= before.topology
    if refilled then state.note = "refilled" end
    -- Loads that cannot be taken along (on single inner nodes) and bonds that come apart are in the way now, not
    -- at the solve.
    if refilled or #self.source.bonds > 0 then
      local model
      model, message, details = edit_follow.model(state, self.source)
      if not model then return nil, message, details end
    end
  else
    state.shape = before.shape
  end
  if edit.materials then
    local model, message, details = edit_follow.model(state, self.source)
    if not model then return nil, message, details end
  end
  if self.record then
    local ok, message, details = self.record:add(state.script)
    if not ok then return nil, message, details end
  end
  for i = #self.history, self.position + 1, -1 do self.history[i] = nil end
  self.position = self.position + 1
  self.history[self.position] = state
  forget_far_shapes(self)
  return state
end

-- A pose has a row of fifteen finite numbers for each bone; a topology is one of edit_shape's.
local function check_change(self, change)
  local count = current(self).topology.skeleton.bone_count
  local function expected(what, value) raise(("commit: %s expected, got %s"):format(what, core.got(value))) end
  if type(change.script) ~= "string" then expected("script: the line that makes this edit", change.script) end
  if change.limits ~= nil and type(change.limits) ~= "table" then
    expected("limits: a table by bones' numbers", change.limits)
  end
  if change.topology ~= nil and not edit_shape.is_topology(change.topology) then
    expected("topology: one that barwright.edit_shape made", change.topology)
  end
  if change.materials ~= nil and not edit_material.is_list(change.materials) then
    expected("materials: a list of {material =, region =}", change.materials)
  end
  local pose = change.pose
  if pose == nil then return end
  if type(pose) ~= "table" or rawlen(pose) ~= count then
    expected(("pose: a list of %d rows"):format(count), type(pose) == "table" and rawlen(pose) or pose)
  end
  for i = 1, count do
    local row = rawget(pose, i)
    if type(row) ~= "table" or rawlen(row) ~= 15 then
      expected(("pose: fifteen finite numbers in row %d"):format(i), type(row) == "table" and rawlen(row) or row)
    end
    for k = 1, 15 do
      local number = rawget(row, k)
      if type(number) ~= "number" or number - number ~= 0 then
        expected(("pose: a finite number at %d of row %d"):format(k, i), number)
      end
    end
  end
end

--- Makes an edit, for Lua files that add edits: {script =, pose =, limits =, topology =, materials =}.
function class:commit(change)
  check_change(self, change)
  return commit(self, change)
end

local function go_to(self, position, word)
  local state = self.history[position]
  if position < 1 or not state then
    return nil, ("there is nothing to %s"):format(word), {status = "empty"}
  end
  local shape, message, details = ensure_shape(self, state)
  if not shape then return nil, message, details end
  if self.record then
    local ok
    ok, message, details = self.record:add(("session:%s()"):format(word))
    if not ok then return nil, message, details end
  end
  self.position = position
  forget_far_shapes(self)
  return self
end

--- Takes back the last edit.
function class:undo()
  current(self)
  return go_to(self, self.position - 1, "undo")
end

--- Makes the edit again that was taken back.
function class:redo()
  current(self)
  return go_to(self, self.position + 1, "redo")
end

-- ---- edits ---------------------------------------------------------------------------------------

--- A bone to turn, scale and move.
function class:bone(name)
  return edit_bone.handle(self, current(self).topology.skeleton:bone(name))
end

--- Sets several bones at once, as one edit: {left_leg = {scale =, rotation =, translation =}, ...}.
--- These are the bones' whole changes since rest; what is left out stays.
function class:pose(changes)
  current(self)
  return edit_bone.set_pose(self, changes)
end

--- Turns bones so that joints or bones' ends get to places: ("left_foot", {x, y, z}), or a list
--- {{joint = | bone =, at =, along =, weight =, from = first bone of the chain}, ...}. Returns
--- {distance, iterations, reached}.
function class:reach(target, at, given)
  current(self)
  return edit_bone.reach(self, target, at, given)
end

--- How far a bone (or all bones whose head is a joint) may turn against its parent in `reach`:
--- {swing =, twist = {low, high}} in degrees; nil lifts the limit.
function class:limit(name, limit)
  current(self)
  return edit_bone.limit(self, name, limit)
end

--- Gives elements to a bone's subdomain, or (without a bone) takes them out of those that follow one. On
--- a refilled mesh the subdomains change as they were before it, and the pose is repaired again.
function class:assign(elements, bone)
  local state = current(self)
  if type(elements) == "userdata" then elements = elements:totable() end
  local subdomains, message, details = edit_assign.subdomains(state.topology, elements, bone)
  if not subdomains then return nil, message, details end
  local ok
  ok, message, details = commit(self, {topology = edit_shape.topology(subdomains, state.topology.floor),
    script = ("session:assign(%s, %s)"):format(edit_script.list(elements),
      edit_script.value(bone))})
  if not ok then return nil, message, details end
  return self
end

--- Another material for a region, or for the whole part; the others stay.
function class:set_material(material, region)
  local state = current(self)
  if material.parts or material.rotated_by_element then
    raise("set_material: a material that is the same in all elements expected")
  end
  if region then state.shape.mesh:region(region) end
  local ok, message, details = commit(self, {
    script = ("session:set_material(%s%s)"):format(edit_material.script(material),
      region and ", " .. edit_script.value(region) or ""),
    materials = edit_material.changed(state.materials, region, material)})
  if not ok then return nil, message, details end
  return self
end

--- The bones back to rest, as an edit that can be undone.
function class:reset()
  local state = current(self)
  local ok, message, details = commit(self, {script = "session:reset()",
    pose = edit_pose.rest(#state.pose)})
  if not ok then return nil, message, details end
  return self
end

--- Scales the bones near high stresses across themselves until no von Mises stress is above a limit,
--- changing the shape least: {von_mises = }, as one edit. See bw.Session:optimise in the stubs.
function class:optimise(given)
  current(self)
  return optimise.run(self, given)
end

-- ---- trying -----------------------------------------------------------------------------------------

local fork_rules = {
  relax = {type = "boolean"},
  refill = {type = "boolean"},
}

--- A session that begins where this one is, with the same equations and no journal, to try edits in:
--- a drag of a hand, a step of an optimisation. What came of it is taken over by `adopt`.
function class:fork(given)
  current(self)
  local state, opts = {}, {}
  for key, value in pairs(current(self)) do state[key] = value end -- it lets go of its mesh by itself
  for key, value in pairs(self.opts) do opts[key] = value end
  for key, value in pairs(options.read("fork", given, fork_rules)) do opts[key] = value end
  return setmetatable({source = self.source, opts = opts, position = 1, following = false,
    last = false, record = false, root = self.root or self, history = {state}}, class)
end

--- The pose of a fork, as one edit.
function class:adopt(fork)
  if getmetatable(fork) ~= class or fork.root ~= (self.root or self) then
    raise(("adopt: a fork of this session expected, got %s"):format(core.got(fork)))
  end
  local changes = edit_bone.changes(current(self), current(fork))
  if next(changes) == nil then return self end
  return self:pose(changes)
end

-- ---- solving -------------------------------------------------------------------------------------

--- Stresses of the part as it is now; an edit session's result says what was `reused`. Options:
--- solver (of bw.solver), tolerance, precision = 32 | 64 (of the factor; else by cost), check,
--- inertia_relief, balance_tolerance; part = another load case, a model of the mesh as it was given.
function class:solve(given)
  local state, opts, part = current(self), nil, nil
  if type(given) == "table" and given.part ~= nil then
    part, opts = given.part, {}
    options.object("solve", "part", part, "model")
    for key, value in pairs(given) do opts[key] = key ~= "part" and value or nil end
  end
  local result, message, details = edit_follow.solve(self, state, opts or given, part)
  if not result then return nil, message, details end
  if not part then self.last = {state = state, result = result, plain = given == nil} end
  return result
end

--- The equations brought to the current shape: an incremental system, and the model it is of.
function class:synchronise()
  local record, message, details = edit_follow.bring(self, current(self))
  if not record then return nil, message, details end
  return record.system, record.model
end

--- Another part on the mesh as it was given (another load case), on the current shape.
function class:moved(part)
  return edit_follow.model(current(self), part)
end

-- ---- asking --------------------------------------------------------------------------------------

function properties:part()
  local part, message = edit_follow.model(current(self), self.source)
  return part or raise(message)
end

function properties:mesh()
  return current(self).shape.mesh
end

--- The mesh as it was given.
function properties:rest()
  current(self)
  return self.history[1].topology.mesh
end

function properties:subdomains()
  return current(self).topology.subdomains
end

function properties:skeleton()
  return current(self).topology.skeleton
end

--- Where the joints are now.
function properties:joints()
  local state = current(self)
  return state.topology.skeleton:posed_joints(state.shape.maps)
end

--- The pose as an array: see bw.Skeleton:pose_maps.
function properties:current_pose()
  return core.array(current(self).pose)
end

--- The edits in force: {script =, mesh = "posed" | "relaxed" | "refilled"}.
function properties:edits()
  current(self)
  local list = {}
  for i = 2, self.position do
    list[i - 1] = {script = self.history[i].script, mesh = self.history[i].note}
  end
  return list
end

--- The surface as it is now, to write as STL, and a report: the one that the mesh was made from, edited as the
--- mesh was. Where it would cross itself by the edit, and without one, the boundary of the mesh.
function class:surface()
  return edit_surface.of(current(self).shape, self.opts.surface)
end

--- Writes the surface as it is now to a file, by its ending. Options: unit. Returns the report of `surface`.
function class:export(path, given)
  local surface, report, details = self:surface()
  if not surface then return nil, report, details end
  local ok, message
  ok, message, details = surface:write(path, given)
  if not ok then return nil, message, details end
  return report
end

-- The last result, if it is of the current state.
local function result_now(self)
  if self.last and self.last.state == current(self) then return self.last.result end
  return self:solve()
end

--- Writes the fields of the current shape: those of bw.Static, and the subdomains.
function class:write(path, given)
  current(self)
  local result, message, details = result_now(self)
  if not result then return nil, message, details end
  local opts = {}
  for key, value in pairs(given or {}) do opts[key] = value end
  local fields = {}
  if opts.fields ~= nil and type(opts.fields) ~= "table" then
    raise(("write: option 'fields': a table of arrays expected, got %s"):format(core.got(opts.fields)))
  end
  for key, value in pairs(opts.fields or {}) do fields[key] = value end
  fields.subdomain = fields.subdomain or {self.subdomains.element_subdomain, on = "elements"}
  opts.fields = fields
  return result:write(path, opts)
end

--- A picture of the current shape under its loads; options of bw.Static:picture.
function class:picture(path, given)
  current(self)
  local result, message, details = result_now(self)
  if not result then return nil, message, details end
  return result:picture(path, given)
end

--- One HTML file with a 3D view of the shape under its loads and as it was drawn, and the edits.
--- Options: title, manifest.
function class:report(path, given)
  current(self)
  local result, message, details = result_now(self)
  if not result then return nil, message, details end
  return edit_report.write(self, current(self), result, path, given)
end

--- The edits in force as a script that replays them.
function class:save(path)
  current(self)
  if type(path) ~= "string" then raise(("save: the path of a script expected, got %s"):format(core.got(path))) end
  return edit_script.save(self, path)
end

--- Checks that all parts of the session belong together, for tests and debugging. Raises where they do not.
function class:check()
  current(self)
  return edit_check(self)
end

--- Lets go of the equations and of all states at once; ends the journal.
function class:close()
  if self.following then self.following.system:close() end
  if self.record then self.record:close() end
  self.following, self.last, self.record, self.root = false, false, false, false
  self.history, self.position = {}, 0
end
class.__close = class.close

function class:__tostring()
  local state = self.history[self.position]
  if not state then return "edit session (closed)" end
  local subdomains = state.topology.subdomains
  local lines = {("edit session on %s; %d bones, %d subdomains"):format(tostring(state.shape.mesh),
    state.topology.skeleton.bone_count, subdomains.count)}
  if self.position == 1 then
    lines[1] = lines[1] .. "; no edits"
  else
    lines[1] = lines[1] .. ("; %d edit%s"):format(self.position - 1, self.position == 2 and "" or "s")
    for i = math.max(2, self.position - 4), self.position do
      local step = self.history[i]
      local note = step.note ~= "posed" and (" (%s)"):format(step.note) or ""
      local script = #step.script > 100 and step.script:sub(1, 97) .. "..." or step.script
      lines[#lines + 1] = ("  %d: %s%s"):format(i - 1, script, note)
    end
  end
  if #self.history > self.position then
    lines[#lines + 1] = ("  %d to redo"):format(#self.history - self.position)
  end
  return table.concat(lines, "\n")
end

arguments.methods("session", class, class, {
  adopt = "fork: any", undo = "", redo = "", reset = "", synchronise = "", surface = "", close = "",
  export = "path: string, options?: options",
  commit = "change: table",
  bone = "name: string|integer", pose = "changes: table", limit = "name: string|integer, limit?: options",
  reach = "target: string|integer|table, at?: any, options?: options",
  assign = "elements: table|array, bone?: string|integer",
  set_material = "material: material, region?: string", optimise = "options: options",
    fork = "options?: options",
  solve = "options?: options", moved = "part: model", write = "path: string, options?: options",
  picture = "path: string, options?: options", report = "path: string, options?: options", save = "path: any",
})
class.__index = members("a session", class, properties)

function class.__newindex(_, name)
  raise(("a session cannot be changed by assignment to '%s'"):format(tostring(name)))
end

local edit = {class = class, properties = properties}

--- Runs a script that replays edits: see edit_script.
function edit.load(path, session, given)
  return edit_script.load(edit, path, session, given)
end

--- What a saved script begins with.
function edit.begin(script, ...)
  local caller = debug.getinfo(2, "S")
  local asking = caller and caller.source or "=?" -- the first function of a coroutine has none
  return edit_script.begin(edit, asking, script, ...)
end

arguments.functions("edit.", edit, {load = "path: any, session?: session, options?: options",
  begin = "script?: string, session?: any"})

return setmetatable(edit, {__call = function(_, part, given) return begin(part, given) end})
