-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Steps of the scaling optimisation: which nodes are constrained, how their stresses are linearised,
-- the quadratic programme of a step, and how much of it is taken.
--
-- A limit on a stress s is taken as h = (limit / s)^(1/3) >= 1. For a bar in bending, whose stress
-- goes with the inverse cube of its thickness, h is linear in t: few steps are needed.
local core = require "barwright.core"
local unknowns = require "barwright.optimise_unknowns"

local objective, scales_of = unknowns.objective, unknowns.scales
local steps = {margin = 1e-6} -- of the limit: aimed at lower by this fraction, and met to within it

local considered = 0.5 -- stresses below this part of the limit are not linearised
local power = 3
local keep_slopes = 0.01 -- relative change of the factors up to which slopes are kept
local peaks_at_once = 4 -- of a load case
local margin = steps.margin

-- ---- the constrained nodes -----------------------------------------------------------------------

local function constrain(self, case, node)
  local key = case .. ":" .. node
  if self.constrained[key] then return false end
  self.constrained[key] = true
  self.constraints[#self.constraints + 1] = {case = case, node = node}
  return true
end

--- Constrains the highest nodes above the limit, one for each domain and case, a few at a time.
--- Returns whether a new one was among them.
function steps.constrain_peaks(self, point)
  local node_domain, new = self.stage.topology.domains.node_domain, false
  for i, case in ipairs(point.cases) do
    local high = case.von_mises:above(self.limit * (1 + margin)):where()
    if #high > 0 then
      local values = case.von_mises:gather(high)
      local seen, count = {}, 0
      local rank = values:order()
      for k = #high, 1, -1 do
        local node = math.tointeger(high[rank[k]])
        local domain = node_domain[node]
        if not seen[domain] then
          seen[domain], count = true, count + 1
          new = constrain(self, i, node) or new
          if count == peaks_at_once then break end
        end
      end
    end
  end
  return new
end

-- h = (limit / stress)^(1 / power) of a constraint at a point; at least 1 where it is met.
local function height(self, point, constraint)
  local stress = point.cases[constraint.case].von_mises[constraint.node]
  return stress > 0 and (self.limit / stress) ^ (1 / power) or math.huge, stress
end

-- How far the constrained nodes are beyond the limit, in h.
local function shortfall(self, point)
  local worst = 0
  for _, constraint in ipairs(self.constraints) do
    worst = math.max(worst, 1 - height(self, point, constraint))
  end
  return worst
end

-- The slopes of h by t of a constraint change little with t: they are kept for small steps.
local function slopes_hold(self, constraint)
  local at = constraint.at
  if not at or #at < #self.t then return false end
  for i, t in ipairs(self.t) do
    if math.abs(t / at[i] - 1) > keep_slopes then return false end
  end
  return true
end

--- Rows a . (t - t_k) >= 1 - h, for stresses worth considering.
function steps.linearise(self, point)
  local rows = {}
  for i = 1, #point.cases do
    local nodes, list = {}, {}
    for _, constraint in ipairs(self.constraints) do
      local h, stress = height(self, point, constraint)
      if constraint.case == i and stress > considered * self.limit then
        constraint.h = h
        rows[#rows + 1] = constraint
        if not slopes_hold(self, constraint) then
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
          constraint[j] = -constraint.h / (power * constraint.stress) * slopes(k, j)
        end
      end
    end
  end
  return rows
end

-- ---- steps ---------------------------------------------------------------------------------------

-- The programme of one step: within the trust region and the bounds, the least change of shape from
-- the start with all linearised limits met, or with the least shortfall.
local function programme(self, t, rows, radius)
  local n = #t
  local g, low, high, A, b = {}, {}, {}, {}, {}
  local scale = 0
  for i = 1, n do scale = math.max(scale, self.H[i][i]) end
  local H = {}
  for i = 1, n do
    H[i], g[i] = {}, 0
    for j = 1, n do
      H[i][j] = 2 * self.H[i][j] / scale
      g[i] = g[i] - H[i][j]
    end
    low[i] = math.max(self.groups[i].low, t[i] * (1 - radius))
    high[i] = math.min(self.groups[i].high, t[i] * (1 + radius))
  end
  for k, row in ipairs(rows) do
    A[k], b[k] = {}, row.h - 1
    for i = 1, n do
      A[k][i] = -row[i]
      b[k] = b[k] - row[i] * t[i]
    end
  end
  local x, violation, multipliers = core.quadratic_programme {H = H, g = g, A = #rows > 0 and A or nil,
    b = #rows > 0 and b or nil, low = low, high = high}
  if not x then return nil, violation, multipliers end
  return {t = x:totable(), violation = violation, price = #rows > 0 and multipliers:sum() * scale or 0}
end

local function predicted(rows, t, to)
  local worst = 0
  for _, row in ipairs(rows) do
    local h = row.h
    for i = 1, #t do h = h + row[i] * (to[i] - t[i]) end
    worst = math.max(worst, 1 - h)
  end
  return worst
end

local function largest_step(t, to)
  local most = 0
  for i = 1, #t do most = math.max(most, math.abs(to[i] / t[i] - 1)) end
  return most
end

--- One accepted step from `point` at `t`: {t =, point =, still = whether there is nowhere to go, step =
--- nil when none made progress}. The merit is the change of shape plus `price` times the shortfall of
--- the constrained nodes. `met`: the point will do, if the step would hardly change it.
function steps.take(self, point, t, rows, met)
  local now, short = objective(self, t), shortfall(self, point)
  for _ = 1, 12 do
    local step, message, details = programme(self, t, rows, self.radius)
    if not step then return nil, message, details end
    local size = largest_step(t, step.t)
    if size < 1e-10 or met and step.violation == 0 and math.abs(objective(self, step.t) - now)
      <= self.wish.tolerance * now then
      return {t = t, point = point, step = step, still = true}
    end
    local trial
    trial, message, details = self.stage:at(scales_of(self, step.t))
    if trial then
      if step.violation == 0 then self.price = math.max(self.price, 1.5 * step.price) end
      local price, shape = self.price, now - objective(self, step.t)
      if step.violation > 0 then price, shape = 1, 0 end -- nearer to the limits, whatever it costs
      local hoped = shape + price * (short - predicted(rows, t, step.t))
      local got = shape + price * (short - shortfall(self, trial))
      if got >= 0.1 * hoped - 1e-9 * (now + price) then
        if got > 0.7 * hoped and size > 0.999 * self.radius then
          self.radius = math.min(2 * self.radius, 4)
        end
        return {t = step.t, point = trial, step = step, still = step.violation > 0 and hoped < 1e-7}
      end
    elseif details.status ~= "geometry" then
      return nil, message, details
    else
      self.inverted = message
    end
    self.radius = size / 2
  end
  return {t = t, point = point, still = true}
end

return steps
