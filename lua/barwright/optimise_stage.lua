-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the scaling optimisation stands on: a session's shape tried at other factors, without an edit.
-- A point is a shape with the stresses of every load case; the session's own equations follow it, so
-- that what is near the last point is cheap.
local core = require "barwright.core"
local edit_follow = require "barwright.edit_follow"
local edit_pose = require "barwright.edit_pose"
local edit_script = require "barwright.edit_script"
local edit_shape = require "barwright.edit_shape"

local stage = {}
stage.__index = stage

-- Errors in energy, relative: of the solutions that steps are judged by, of the one that is the answer,
-- and of adjoint solutions. The highest stress is off by less than a tenth of that.
local close, exact, slopes_close = 3e-5, 3e-6, 3e-3
local max_iteration_ratio = 0.3 -- of the iterations predicted, which the slenderest of parts would need
local displacements, adjoints = 4, 8 -- of each load case, that are kept to begin others with

--- On the current state of a session. `parts`: load cases, on the session's original mesh.
function stage.new(session, parts, inertia_relief)
  local state = session.history[session.position]
  local relaxed = state.shape and state.shape.how == "relaxed"
  return setmetatable({session = session, state = state, topology = state.topology, parts = parts,
    pose = state.pose, inertia_relief = inertia_relief, relaxing = relaxed or false,
    near = {}, max_iteration_ratio = max_iteration_ratio,
    counts = {shapes = 0, factorisations = 0, solves = 0, adjoints = 0}}, stage)
end

--- The factors of a bone at the start.
function stage:factors(bone)
  return edit_pose.scale(self.pose[bone])
end

--- How every node moves with one factor (1 to 3) of a bone.
function stage:derivative(bone, axis)
  return self.topology.subdomains:pose_derivative(self.pose, bone, axis)
end

-- Fields near the solutions of a load case: its last displacements, and the last adjoint displacements,
-- the latest of each node.
local function guess(self, i)
  local near, list = self.near[i], {}
  for k, field in ipairs(near.displacements) do list[k] = field end
  for _, adjoint in ipairs(near.adjoints) do list[#list + 1] = adjoint.field end
  return list
end

local function remember_displacement(near, field)
  table.insert(near.displacements, 1, field)
  near.displacements[displacements + 1] = nil
end

local function remember_adjoint(near, node, field)
  local list = near.adjoints
  for k, adjoint in ipairs(list) do
    if adjoint.node == node then table.remove(list, k) break end
  end
  table.insert(list, 1, {node = node, field = field})
  list[adjoints + 1] = nil
end

-- `further`: how many adjoint solutions will be asked for there; `known`: a solution, to go on from.
local function solve(self, state, part, i, tolerance, further, known)
  local record, message, details = edit_follow.bring(self.session, state, part)
  if not record then return nil, message, details end
  self.near[i] = self.near[i] or {displacements = {}, adjoints = {}}
  local result, reuse
  result, reuse, details = record.system:statics(record.model, {inertia_relief = self.inertia_relief,
    tolerance = tolerance, energy = true, guess = known and {known} or guess(self, i),
    further = further, max_iteration_ratio = self.max_iteration_ratio}, record.reuse)
  if not result then return nil, reuse, details end
  local current = not record.reuse or reuse.solver ~= "pcg"
  if current and reuse.iterations > 0 then self.max_iteration_ratio = nil end -- in vain
  if not known then remember_displacement(self.near[i], result.displacement) end
  if current then
    local reused = record.reuse and reuse.factor_reused or 0
    if reused < 1 then self.counts.factorisations = self.counts.factorisations + 1 - reused end
  end
  self.counts.solves = self.counts.solves + 1
  return {result = result, model = record.model, system = record.system, von_mises = result.von_mises,
    many = current or reuse.preconditioner == "two_level",
    exact = tolerance <= exact or current and reuse.precision == 64}
end

-- The highest stress under any load.
local function find_highest(point)
  point.max = 0
  for i, case in ipairs(point.cases) do
    local max = case.von_mises:max()
    if max > point.max then point.max, point.node, point.case = max, case.von_mises:argmax(), i end
  end
end

--- The pose with these factors: scales[bone] = {x, y, z} for bones that differ from the start.
function stage:pose_of(scales)
  local pose = self.pose
  for bone, scale in pairs(scales) do pose = edit_pose.with(pose, bone, nil, scale) end
  return pose
end

-- The point where the session is, from its last solution.
local function present(self, part, i)
  local last = self.session.last
  if i > 1 or not last or not last.plain or last.state ~= self.state or part ~= self.session.source
    or self.inertia_relief then
    return nil
  end
  local record = edit_follow.bring(self.session, self.state, part)
  if not record then return nil end
  self.near[i] = {displacements = {last.result.displacement}, adjoints = {}}
  return {result = last.result, model = record.model, system = record.system,
    von_mises = last.result.von_mises, many = true, exact = true}
end

--- The point with these factors. `further`: how many slopes of stresses will be asked for there.
function stage:at(scales, further)
  local pose = self:pose_of(scales)
  local shape, message, details = edit_shape.of(self.topology, pose, self.session.opts)
  if not shape then return nil, message, details end
  if shape.how == "relaxed" and not self.relaxing then -- its nodes are not linear in the factors
    return nil, "elements become so distorted that inner nodes have to be moved", {status = "geometry"}
  end
  self.counts.shapes = self.counts.shapes + 1
  local point = {state = {topology = self.topology, pose = pose, shape = shape, limits = {},
    materials = self.state.materials},
    cases = {}}
  for i, part in ipairs(self.parts) do
    local case = not next(scales) and present(self, part, i) or nil
    if not case then
      case, message, details = solve(self, point.state, part, i, close, further)
      if not case then return nil, message, details end
    end
    point.cases[i] = case
    point.many = case.many -- of the last case: slopes of many nodes cost little more than of one
    self.last = {point = point, case = i}
  end
  find_highest(point)
  return point
end

--- The stresses of a point as exactly as answers are given.
function stage:sharpen(point)
  for i, case in ipairs(point.cases) do
    if not case.exact then
      local message, details
      case, message, details = solve(self, point.state, self.parts[i], i, exact, 0,
        case.result.displacement)
      if not case then return nil, message, details end
      point.cases[i], self.last = case, {point = point, case = i}
    end
  end
  find_highest(point)
  return point
end

--- d stress of nodes of a case by motions of all nodes, at a point: rows for nodes.
function stage:slopes(point, i, nodes, motions)
  local case = point.cases[i]
  if not self.last or self.last.point ~= point or self.last.case ~= i then
    local record, message, details = edit_follow.bring(self.session, point.state, self.parts[i])
    if not record then return nil, message, details end
    case.model, case.system, self.last = record.model, record.system, {point = point, case = i}
  end
  self.counts.adjoints = self.counts.adjoints + #nodes
  local values, slopes, fields = core.von_mises_slopes(case.model, case.system,
    case.result.displacement, nodes, motions, {tolerance = slopes_close,
    energy = true, guess = guess(self, i), max_iteration_ratio = self.max_iteration_ratio})
  if not values then return nil, slopes, fields end
  local count = case.model.mesh.node_count
  for k, node in ipairs(nodes) do
    remember_adjoint(self.near[i], node, fields:rows((k - 1) * count + 1, k * count))
  end
  return slopes
end

--- Goes on with a mesh that was filled again so that a shape which inverts elements can be had: returns
--- whether there is one.
function stage:refill(scales)
  local pose = self:pose_of(scales)
  local shape = edit_shape.repaired(self.topology, pose, self.session.opts)
  if not shape or shape.topology == self.topology then return false end
  self.topology, self.relaxing, self.near, self.last = shape.topology, true, {}, nil
  return true
end

--- Makes these factors the session's next edit.
function stage:commit(scales)
  local names, list = self.topology.skeleton.bone_names, {}
  for bone, scale in pairs(scales) do
    list[#list + 1] = ("[%s] = {scale = %s}"):format(edit_script.value(names[bone]),
      edit_script.vector(scale))
  end
  table.sort(list)
  return self.session:commit {pose = self:pose_of(scales), topology = self.topology,
    script = ("session:pose {%s}"):format(table.concat(list, ", "))}
end

--- The equations of a point that carries no loads but its own inertia, factored, to find its worst load
--- with: those of the session, so that only what changed since is factored.
function stage:view(scales)
  local pose = self:pose_of(scales)
  local shape, message, details = edit_shape.of(self.topology, pose, self.session.opts)
  if not shape then return nil, message, details end
  local source = self.session.source
  local record
  record, message, details = edit_follow.bring(self.session, {topology = self.topology, pose = pose,
    shape = shape, limits = {}, materials = self.state.materials},
    core.model {mesh = source.mesh, material = source.material})
  if not record then return nil, message, details end
  self.last = nil
  local view
  view, message, details = record.system:view()
  if not view then return nil, message, details end
  return view, record.model
end

--- Another load case: forces at the nodes of the original mesh.
function stage:add_forces(forces)
  local source = self.session.source
  local part = core.model {mesh = source.mesh, material = source.material}
  part:load {nodal = forces}
  self.parts[#self.parts + 1] = part
end

return stage
