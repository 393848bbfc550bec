-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The constrained nodes of the scaling optimisation, and what their stresses are expected to do.
--
-- A limit on a stress s is taken as h = (limit / s)^(1/3) >= 1. Between two solutions h is modelled as
-- a product of powers of the factors, h prod (t_i / t_k,i)^q_i, which is what tension and bending are;
-- the exponents come from the stress gradient.
local models = {margin = 1e-6} -- of the limit: aimed at lower by this fraction, and met to within it

local considered = 0.5 -- stresses below this part of the limit are not modelled
local power = 3
local keep_exponents = 0.02 -- relative change of the factors up to which exponents are kept
local nearly = 0.98 -- part of the limit from which a constraint counts as active
local peaks_at_once = 4 -- of a load case
local watched = 0.9 -- part of the limit from which nodes are modelled before they exceed it
local watched_at_once, apart = 8, 0.4 -- of a load case; element sizes between them
local margin = models.margin

-- ---- the constrained nodes -----------------------------------------------------------------------

local function constrain(self, case, node)
  local key = case .. ":" .. node
  if self.constrained[key] then return false end
  self.constrained[key] = true
  self.constraints[#self.constraints + 1] = {case = case, node = node}
  return true
end

--- Constrains the highest nodes above the limit, one for each subdomain and case, a few at a time.
--- Returns whether a new one was among them.
function models.constrain_peaks(self, point)
  local node_subdomain, new = self.stage.topology.subdomains.node_subdomain, false
  for i, case in ipairs(point.cases) do
    local above = case.von_mises:above(self.limit * (1 + margin)):where()
    if #above > 0 then
      local values = case.von_mises:gather(above)
      local seen, count = {}, 0
      local rank = values:order()
      for k = #above, 1, -1 do
        local node = math.tointeger(above[rank[k]])
        local subdomain = node_subdomain[node]
        if not seen[subdomain] then
          seen[subdomain], count = true, count + 1
          new = constrain(self, i, node) or new
          if count == peaks_at_once then break end
        end
      end
    end
  end
  return new
end

-- Nodes above a level, the highest first, none nearer than `distance` to a higher one or to those of
-- `list`; at most `count` with those.
local function spread(stresses, nodes, level, distance, list, count)
  local high = stresses:above(level):where()
  if #high == 0 then return list end
  local rank, at = stresses:gather(high):order(), nodes:gather(high)
  local places = {}
  for i, node in ipairs(list) do places[i] = {nodes(node, 1), nodes(node, 2), nodes(node, 3)} end
  for k = #high, 1, -1 do
    if #list >= count then break end
    local i = rank[k]
    local x, y, z, free = at(i, 1), at(i, 2), at(i, 3), true
    for _, p in ipairs(places) do
      if (x - p[1]) ^ 2 + (y - p[2]) ^ 2 + (z - p[3]) ^ 2 < distance ^ 2 then free = false break end
    end
    if free then
      list[#list + 1], places[#places + 1] = math.tointeger(high[i]), {x, y, z}
    end
  end
  return list
end

--- Constrains nodes that are not yet above the limit, or are not the highest of their subdomain: what a
--- step would bring up next. For points whose adjoint solutions are cheap.
function models.watch(self, point)
  local mesh = point.state.shape.mesh
  local distance = apart * (mesh.volume / mesh.element_count) ^ (1 / 3)
  for i, case in ipairs(point.cases) do
    local list = {}
    for _, constraint in ipairs(self.constraints) do
      if constraint.case == i then list[#list + 1] = constraint.node end
    end
    spread(case.von_mises, mesh.nodes, watched * self.limit, distance, list, watched_at_once)
    for _, node in ipairs(list) do constrain(self, i, node) end
  end
end

--- Constrains the highest node under each load, above the limit or not.
function models.constrain_highest(self, point)
  for i, case in ipairs(point.cases) do constrain(self, i, case.von_mises:argmax()) end
end

-- h = (limit / stress)^(1 / power) of a constraint at a point; at least 1 where it is met.
local function height(self, point, constraint)
  local stress = point.cases[constraint.case].von_mises[constraint.node]
  return stress > 0 and (self.limit / stress) ^ (1 / power) or math.huge, stress
end

--- How far the constrained nodes are beyond the limit, in h.
function models.shortfall(self, point)
  local worst = 0
  for _, constraint in ipairs(self.constraints) do
    worst = math.max(worst, 1 - height(self, point, constraint))
  end
  return worst
end

-- Exponents are kept for small steps.
local function exponents_hold(constraint, to)
  local at = constraint.at
  if not at or #at < #to then return false end
  for i, t in ipairs(to) do
    if math.abs(t / at[i] - 1) > keep_exponents then return false end
  end
  return true
end

--- How many exponents will be recomputed at other factors.
function models.outdated(list, to)
  local count = 0
  for _, model in ipairs(list) do
    if model.active and not exponents_hold(model, to) then count = count + 1 end
  end
  return count
end

-- Whether a model matters too little for its exponents to be recomputed.
local function slack(self, constraint, stress)
  return constraint.at and #constraint.at == #self.t and not constraint.active
    and stress < nearly * self.limit
end

-- Those that are kept are turned so that they explain the last change of h (Broyden).
local function correct(self, constraint, h)
  local step, size, predicted = {}, 0, math.log(constraint.h)
  for i, t in ipairs(self.t) do
    step[i] = math.log(t / (constraint.t[i] or 1))
    size, predicted = size + step[i] ^ 2, predicted + constraint[i] * step[i]
  end
  if size < 1e-12 then return end
  local off = (math.log(h) - predicted) / size
  for i = 1, #step do constraint[i] = constraint[i] + off * step[i] end
end

--- h of a model at other factors.
function models.predict(model, to)
  local h = model.h
  for i = 1, #to do h = h * (to[i] / model.t[i]) ^ model[i] end
  return h
end

--- Which models were at their limit in a step. Where the curvature E predicted that they would do worse
--- at its end than they do, less of it is kept.
function models.check(self, list, multipliers, to, point)
  local predicted, seen = 0, 0
  for i, row in ipairs(self.E) do
    for j = 1, #row do
      predicted = predicted + (to[i] - self.t[i]) * row[j] * (to[j] - self.t[j]) / 2
    end
  end
  for k, model in ipairs(list) do
    model.active = multipliers[k] > 0
    if model.active then
      seen = seen + multipliers[k] * (models.predict(model, to) - height(self, point, model))
    end
  end
  if predicted > 0 and seen < predicted then
    local part = math.max(0, seen / predicted)
    for _, row in ipairs(self.E) do
      for j = 1, #row do row[j] = part * row[j] end
    end
  end
end

--- What a step leaves behind for `learn`: the models that were at their limit, as they were.
function models.remember(self, list, multipliers)
  self.memory = {t = self.t}
  for k, model in ipairs(list) do
    if multipliers[k] > 0 then
      local old = table.move(model, 1, #model, 1, {h = model.h, t = model.t, of = model})
      old.multiplier = multipliers[k]
      self.memory[#self.memory + 1] = old
    end
  end
end

-- E, the curvature of the Lagrangian that the models do not have, from exponents recomputed at the
-- end of a step (symmetric rank one).
local function learn(self)
  local memory, n = self.memory, #self.t
  self.memory = nil
  for i = 1, n do
    self.E[i] = self.E[i] or {}
    for j = 1, n do self.E[i][j] = self.E[i][j] or 0 end
  end
  if not memory or #memory == 0 or #memory[1] < n then return end
  local s, r, rs, rr, ss = {}, {}, 0, 0, 0
  for i = 1, n do s[i], r[i] = self.t[i] - memory.t[i], 0 end
  for _, old in ipairs(memory) do
    if not old.of.new then return end
    local h = models.predict(old, self.t)
    for i = 1, n do
      r[i] = r[i] - old.multiplier * (old.of.h * old.of[i] - h * old[i]) / self.t[i]
    end
  end
  for i = 1, n do
    for j = 1, n do r[i] = r[i] - self.E[i][j] * s[j] end
    rs, rr, ss = rs + r[i] * s[i], rr + r[i] ^ 2, ss + s[i] ^ 2
  end
  if math.abs(rs) <= 1e-6 * math.sqrt(rr * ss) then return end
  for i = 1, n do
    for j = 1, n do self.E[i][j] = self.E[i][j] + r[i] * r[j] / rs end
  end
end

--- Drops E where a step that it led to was not taken. Returns whether there was any.
function models.forget(self)
  local any = false
  for _, row in ipairs(self.E) do
    for j = 1, #row do any, row[j] = any or row[j] ~= 0, 0 end
  end
  return any
end

--- Brings the models of the constrained nodes' h to a point: h, t, and exponents d log h / d log t.
--- Returns those worth considering.
function models.update(self, point)
  local known = {}
  for i = 1, #point.cases do
    local nodes, list = {}, {}
    for _, constraint in ipairs(self.constraints) do
      local h, stress = height(self, point, constraint)
      if constraint.case == i and stress > considered * self.limit then
        local holds = exponents_hold(constraint, self.t) or slack(self, constraint, stress)
        if holds then correct(self, constraint, h) end
        constraint.h, constraint.t, constraint.new = h, self.t, not holds
        known[#known + 1] = constraint
        if not holds then
          nodes[#nodes + 1], list[#list + 1] = constraint.node, constraint
          constraint.stress = stress
        end
      end
    end
    if #nodes > 0 then
      local slopes, message, details = self.stage:slopes(point, i, nodes, self.motions)
      if not slopes then return nil, message, details end
      for k, constraint in ipairs(list) do
        constraint.at = table.move(self.t, 1, #self.t, 1, {})
        for j = 1, #self.t do
          constraint[j] = -self.t[j] * slopes(k, j) / (power * constraint.stress)
        end
      end
    end
  end
  learn(self)
  return known
end

return models
