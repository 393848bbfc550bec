-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Steps of the scaling optimisation: the least change of shape by which the models meet the limits, by
-- quadratic programs one after the other without solving a shape, and how much of it is taken.
local core = require "barwright.core"
local models = require "barwright.optimise_models"
local unknowns = require "barwright.optimise_unknowns"

local steps = {}

local predict, objective = models.predict, unknowns.objective
local programs = 50 -- of one step, at most
local min_radius = 0.005 -- of the trust region, where the mesh stops steps
local spared = 0.2 -- of what the objective may be off by at the end, that a margin in h may cost

-- Adds the curvature of -h of a model, times a multiplier: h (D - v v^T) with D = q_i / t_i^2 and
-- v = q_i / t_i. `convex`: only what is surely positive semidefinite of it, positive exponents, and v
-- shortened where they sum to more than one.
local function add_curvature(B, model, at, h, multiplier, convex)
  local q, sum = {}, 0
  for i = 1, #at do
    q[i] = convex and math.max(0, model[i]) or model[i]
    sum = sum + q[i]
  end
  local shorter = convex and math.max(1, sum) or 1
  for i = 1, #at do
    B[i][i] = B[i][i] + multiplier * h * q[i] / at[i] ^ 2
    for j = 1, #at do
      B[i][j] = B[i][j] - multiplier * h * q[i] * q[j] / (at[i] * at[j] * shorter)
    end
  end
end

-- Whether a matrix is positive definite by a margin.
local function positive(B)
  local L = {}
  for i = 1, #B do
    L[i] = {}
    for j = 1, i do
      local sum = B[i][j]
      for k = 1, j - 1 do sum = sum - L[i][k] * L[j][k] end
      if i == j then
        if sum <= 0.01 * B[i][i] or sum ~= sum then return false end
        L[i][i] = math.sqrt(sum)
      else
        L[i][j] = sum / L[j][j]
      end
    end
  end
  return true
end

-- The Hessian of the Lagrangian that the models make, with E; less of it where it is not positive
-- definite. H alone may be hardly so, where two bones move the same nodes.
local function hessian(self, at, list, multipliers, convex, plain)
  local B = {}
  for i = 1, #at do
    B[i] = {}
    for j = 1, #at do B[i][j] = 2 * self.H[i][j] + (plain and 0 or self.E[i][j]) end
    B[i][i] = B[i][i] + 1e-9 * self.H[i][i]
  end
  for k, model in ipairs(list) do
    if multipliers[k] and multipliers[k] > 0 then
      add_curvature(B, model, at, predict(model, at), multipliers[k], convex)
    end
  end
  if plain or positive(B) then return B end
  return hessian(self, at, list, multipliers, true, convex)
end

-- One quadratic program: the models linearised `at` some factors, with the curvature that they have
-- by the multipliers of the last one.
local function program(self, at, list, multipliers, min, max)
  local n, scale = #at, 0
  local B, g, A, b = hessian(self, at, list, multipliers), {}, {}, {}
  for k, model in ipairs(list) do
    local h = predict(model, at)
    local right = h - 1 - self.spare
    A[k] = {}
    for i = 1, n do
      A[k][i] = -h * model[i] / at[i]
      right = right + A[k][i] * at[i]
    end
    b[k] = right
  end
  for i = 1, n do scale = math.max(scale, B[i][i]) end
  for i = 1, n do
    g[i] = 0
    for j = 1, n do
      g[i] = g[i] + (2 * self.H[i][j] * (at[j] - 1) + self.E[i][j] * (at[j] - self.t[j])
        - B[i][j] * at[j]) / scale
    end
  end
  for i = 1, n do
    for j = 1, n do B[i][j] = B[i][j] / scale end
  end
  local x, violation, prices = core.quadratic_program {H = B, g = g, A = #list > 0 and A or nil,
    b = #list > 0 and b or nil, min = min, max = max}
  if not x then return nil, violation, prices end
  prices = prices:totable()
  for k = 1, #prices do prices[k] = prices[k] * scale end
  return {t = x:totable(), violation = violation, multipliers = prices}
end

-- How far the models are beyond the limit.
local function predicted(list, to)
  local worst = 0
  for _, model in ipairs(list) do worst = math.max(worst, 1 - predict(model, to)) end
  return worst
end

local function largest_step(t, to)
  local max = 0
  for i = 1, #t do max = math.max(max, math.abs(to[i] / t[i] - 1)) end
  return max
end

-- The least change of shape from the start by which the models meet the limit, or nearly do so where
-- none does, within the bounds and the trust region around t: quadratic programs in turn.
local function solve_models(self, t, list, radius)
  local min, max = {}, {}
  for i = 1, #t do
    min[i] = math.max(self.groups[i].min, t[i] * (1 - radius))
    max[i] = math.min(self.groups[i].max, t[i] * (1 + radius))
  end
  local at, multipliers, step = t, {}, nil
  for _ = 1, programs do
    local message, details
    step, message, details = program(self, at, list, multipliers, min, max)
    if not step then return nil, message, details end
    local moved = largest_step(at, step.t)
    at, multipliers = step.t, step.violation == 0 and step.multipliers or {}
    if moved < 1e-9 then break end
  end
  step.price = 0
  for _, multiplier in ipairs(step.multipliers) do step.price = step.price + multiplier end
  if step.violation == 0 and step.price > 0 then
    self.spare = math.min(1e-3, spared * self.opts.tolerance * objective(self, step.t) / step.price)
  end
  return step
end

--- One accepted step from `point` at `t`: {t =, point =, still = whether there is nowhere to go, step =
--- nil when none made progress}. The merit is the change of shape plus `price` times the shortfall of
--- the constrained nodes. `met`: the point will do, if the step would hardly change it.
function steps.take(self, point, t, list, met)
  local now, short = objective(self, t), models.shortfall(self, point)
  self.blocked = {}
  for try = 1, 12 do
    local step, message, details = solve_models(self, t, list, self.radius)
    if not step then return nil, message, details end
    local size = largest_step(t, step.t)
    local inside = size < 0.999 * self.radius
    if size < 1e-10 or met and step.violation == 0 and inside
      and math.abs(objective(self, step.t) - now) <= self.opts.tolerance * now then
      return {t = t, point = point, step = step, still = true}
    end
    local trial
    trial, message, details = self.stage:at(unknowns.scales(self, step.t),
      models.outdated(list, step.t))
    if trial then
      if step.violation == 0 then self.price = math.max(self.price, 1.5 * step.price) end
      local price, shape = self.price, now - objective(self, step.t)
      if step.violation > 0 then price, shape = 1, 0 end -- nearer to the limits, whatever it costs
      local expected = shape + price * (short - predicted(list, step.t))
      local got = shape + price * (short - models.shortfall(self, trial))
      if got >= 0.1 * expected - 1e-9 * (now + price) then
        if got > 0.7 * expected and not inside then self.radius = math.min(2 * self.radius, 4) end
        models.check(self, list, step.multipliers, step.t, trial)
        if step.violation == 0 then models.remember(self, list, step.multipliers) end
        return {t = step.t, point = trial, step = step, still = step.violation > 0
          and expected < 1e-7 and inside}
      end
    elseif details.status ~= "geometry" then
      return nil, message, details
    else
      self.inverted = message
      self.blocked[#self.blocked + 1] = step.t
    end
    if not trial and try >= 3 and self.refills < self.opts.refills then break end
    if not trial and self.stage.relaxing and self.radius < min_radius then break end
    if try > 1 then models.forget(self) end
    if try == 3 and not trial and not self.stage.relaxing then
      self.stage.relaxing = true -- shorter steps do not help: let inner nodes move
    else
      self.radius = size / 2
    end
  end
  return {t = t, point = point, still = true}
end

return steps
