-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The unknowns of the scaling optimisation: factors t relative to the start, one for each group. A
-- group is an axis across a bone, or across bones that are tied. Nodes move linearly with t, so that
-- the change of shape, the sum over the corner nodes of |x(t) - x(1)|^2, is (t - 1) . H (t - 1)
-- exactly.
--
-- A problem has groups, t, H and motions (of all nodes by each t), which only grow together.
local core = require "barwright.core"
local optimise_fixed = require "barwright.optimise_fixed"

local raise = core.raise
local unknowns = {}

--- The numbers of bones called by name.
function unknowns.bones(skeleton, names, where)
  local out = {}
  for i, name in ipairs(names) do out[i] = skeleton:bone(name).index end
  if #out == 0 and next(names) ~= nil then
    raise(("optimise: option '%s': a list of names of bones expected, got a table with names"):format(where))
  end
  return out
end

function unknowns.set(list)
  local set = {}
  for _, value in ipairs(list) do set[value] = true end
  return set
end

--- tied[bone]: all bones that change with it.
function unknowns.ties(skeleton, ties)
  local tied = {}
  for _, names in ipairs(ties) do
    if type(names) ~= "table" then
      raise(("optimise: option 'ties': lists of names of bones expected, got %s"):format(core.got(names)))
    end
    local bones = unknowns.bones(skeleton, names, "ties")
    for _, bone in ipairs(bones) do
      if tied[bone] then
        raise(("optimise: option 'ties': bone '%s' is tied twice"):format(
          skeleton:bone(bone).name))
      end
      tied[bone] = bones
    end
  end
  return tied
end

-- The motion of a group and its part of H, on the stage's mesh.
local function measure(self, n)
  local group, motion = self.groups[n], nil
  for _, bone in ipairs(group.bones) do
    local derivative, message, details = self.stage:derivative(bone, group.axis)
    if not derivative then return nil, message, details end
    derivative = derivative * self.stage:factors(bone)[group.axis]
    motion = motion and motion + derivative or derivative
  end
  self.motions[n], group.corners = motion, motion:gather(self.corners)
  self.H[n] = {}
  for i = 1, n do
    self.H[n][i] = group.corners:dot(self.groups[i].corners)
    self.H[i][n] = self.H[n][i]
  end
  return true
end

local function add_group(self, bones, axis)
  local group = {bones = bones, axis = axis, min = 0, max = math.huge}
  for _, bone in ipairs(bones) do
    local start = self.stage:factors(bone)[axis]
    group.min = math.max(group.min, math.min(self.opts.min_factor / start, 1))
    group.max = math.min(group.max, math.max(self.opts.max_factor / start, 1))
  end
  local n = #self.groups + 1
  self.groups[n], self.t[n] = group, 1
  local ok, message, details = measure(self, n)
  if not ok then return nil, message, details end
  local blocked = optimise_fixed.moved(self.fixed, self.stage.topology, self.motions[n])
  if blocked then
    self.refused = ("%s across %s would move %s%s"):format(
      self.stage.topology.skeleton.bone_names[bones[1]], ("xyz"):sub(axis, axis), blocked.name,
      blocked.support and " ('move_supports' allows that)" or "")
  end
  if blocked or self.H[n][n] <= 0 then -- may not move, or moves nothing
    self.groups[n], self.t[n], self.H[n], self.motions[n] = nil, nil, nil, nil
    for i = 1, n - 1 do self.H[i][n] = nil end
  end
  return true
end

--- All of them again, on another mesh.
function unknowns.measure(self)
  for n = 1, #self.groups do
    local ok, message, details = measure(self, n)
    if not ok then return nil, message, details end
  end
  return true
end

-- Takes a bone in, with those tied to it, and the two axes across it.
local function add_bone(self, bone)
  if self.chosen[bone] or self.keep[bone] then return true end
  local bones = self.tied[bone] or {bone}
  for _, other in ipairs(bones) do
    self.chosen[other] = true
  end
  for axis = 2, 3 do
    local ok, message, details = add_group(self, bones, axis)
    if not ok then return nil, message, details end
  end
  return true
end

--- Takes in the bones of subdomains that have stresses above the limit, or are next to a blended subdomain
--- that has; where the bones were named, all these and no others. The set only grows.
function unknowns.choose(self, point)
  for _, bone in ipairs(self.only or {}) do
    local ok, message, details = add_bone(self, bone)
    if not ok then return nil, message, details end
  end
  if self.only then return true end
  local subdomains = self.stage.topology.subdomains
  for _, case in ipairs(point.cases) do
    for _, d in ipairs(subdomains:touched(case.von_mises:above(self.opts.von_mises))) do
      local subdomain = subdomains[d]
      local near = subdomain.type == "R" and {d} or subdomain.adjacent
      for _, other in ipairs(near) do
        local bone = subdomains[other].bone
        if bone then
          local ok, message, details = add_bone(self, self.stage.topology.skeleton:bone(bone).index)
          if not ok then return nil, message, details end
        end
      end
    end
  end
  return true
end

--- Factors {x, y, z} since rest of the bones that may change, by number.
function unknowns.scales(self, t)
  local scales = {}
  for i, group in ipairs(self.groups) do
    for _, bone in ipairs(group.bones) do
      scales[bone] = scales[bone] or self.stage:factors(bone)
      scales[bone][group.axis] = self.stage:factors(bone)[group.axis] * t[i]
    end
  end
  return scales
end

--- The change of shape, m2: a sum over the corner nodes.
function unknowns.objective(self, t)
  local sum = 0
  for i = 1, #t do
    for j = 1, #t do sum = sum + (t[i] - 1) * self.H[i][j] * (t[j] - 1) end
  end
  return sum
end

return unknowns
