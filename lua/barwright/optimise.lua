-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The scaling optimisation (agile, section 7): the bones near high stresses are made thicker or
-- thinner across themselves until no node's von Mises stress is above a limit, changing the shape
-- least. docs/theory/edit.md, "Scaling optimisation", has the mathematics.
--
-- A problem has unknowns (optimise_unknowns), constrained nodes with models of their stresses
-- (optimise_models), steps (optimise_steps), and a stage on which shapes are tried (optimise_stage).
local core = require "barwright.core"
local optimise_fixed = require "barwright.optimise_fixed"
local models = require "barwright.optimise_models"
local options = require "barwright.options"
local stages = require "barwright.optimise_stage"
local steps = require "barwright.optimise_steps"
local unknowns = require "barwright.optimise_unknowns"
local worst_case = require "barwright.worst_case"

local raise = core.raise

local optimise = {}

local rules = {
  von_mises = {type = "number", needed = true, above = 0},
  bones = {type = "table"}, -- names; left out: those near high stresses
  keep = {type = "table", default = {}}, -- names of bones that stay as they are, selections that do not move
  move_supports = {type = "boolean", default = false},
  ties = {type = "table", default = {}}, -- lists of names of bones that change alike
  min_factor = {type = "number", default = 0.5, above = 0},
  max_factor = {type = "number", default = 3, above = 0},
  cases = {type = "table", default = {}}, -- further parts
  loads = {type = "string", default = "own", one_of = {"own", "worst"}},
  worst = {type = "table", default = {}}, -- options of bw.worst_case
  rounds = {type = "integer", default = 8, min = 1},
  change = {type = "number", default = 0.02, above = 0},
  iterations = {type = "integer", default = 40, min = 1},
  tolerance = {type = "number", default = 1e-4, above = 0},
  step = {type = "number", default = 0.5, above = 0},
  refills = {type = "integer", default = 3, min = 0},
  inertia_relief = {type = "boolean"},
}

-- ---- the loop ------------------------------------------------------------------------------------

-- The best point is one that meets the limit, with the least change of shape; before there is one,
-- that of the lowest stress.
local function better(limit, a, b)
  if a.point.max <= limit and b.point.max <= limit then return a.change < b.change end
  return a.point.max < b.point.max
end

local function note(self, point, t)
  local entry = {max = point.max, change = unknowns.objective(self, t), node = point.node,
    case = point.case, constrained = #self.constraints, unknowns = #self.groups}
  self.history[#self.history + 1] = entry
  local this = {point = point, change = entry.change, t = table.move(t, 1, #t, 1, {})}
  if not self.best or better(self.opts.von_mises, this, self.best) then self.best = this end
  return entry
end

-- Where the mesh stopped all steps: goes to the farthest of their shapes that can be had by filling
-- subdomains again. Returns the point there, on the new mesh, or false.
local function refill(self)
  self.refills = self.refills + 1
  for _, t in ipairs(self.blocked) do
    if self.stage:refill(unknowns.scales(self, t)) then
      self.corners = core.corner_nodes(self.stage.topology.mesh)
      local ok, message, details = unknowns.measure(self)
      if not ok then return nil, message, details end
      self.constraints, self.constrained, self.memory, self.best = {}, {}, nil, nil
      self.t, self.E, self.radius = t, {}, self.opts.step
      local point
      point, message, details = self.stage:at(unknowns.scales(self, t))
      if not point then return nil, message, details end
      models.constrain_highest(self, point)
      return point
    end
  end
  return false
end

-- Whether no node is above the limit at a point, now that it comes to that: nil, message, details where
-- that cannot be said.
local function holds(self, point, entry)
  local ok, message, details = self.stage:sharpen(point)
  if not ok then return nil, message, details end
  entry.max, entry.node, entry.case = point.max, point.node, point.case
  return point.max <= self.opts.von_mises
end

-- From `point` at self.t until no node is above the limit. Returns "met", "infeasible", "stuck", or
-- "slow" when there were too many steps.
local function descend(self, point)
  local last
  while true do
    local ok, message, details = unknowns.choose(self, point)
    if not ok then return nil, message, details end
    local new = models.constrain_peaks(self, point)
    if point.many and #self.groups > 0 then models.watch(self, point) end
    local entry = note(self, point, self.t)
    self.point = point
    local met, over = point.max <= self.opts.von_mises, #self.history > self.opts.iterations
    local ends, taken = met and (over or #self.constraints == 0 or not new and last
      and math.abs(entry.change - last) <= self.opts.tolerance * entry.change), nil
    if over and not met then return "slow" end
    if not ends then
      if #self.groups == 0 then return "infeasible" end
      last = entry.change
      local known
      known, message, details = models.update(self, point)
      if not known then return nil, message, details end
      taken, message, details = steps.take(self, point, self.t, known, met and not new)
      if not taken then return nil, message, details end
    end
    if ends or taken.still and met then
      met, message, details = holds(self, point, entry)
      if met == nil then return nil, message, details end
      if met then return "met" end -- else this point again, above the limit now
    elseif taken.still and not taken.step and #self.blocked > 0 and self.refills < self.opts.refills then
      local other
      other, message, details = refill(self)
      if other == nil then return nil, message, details end
      if other then
        point, last = other, nil
      else
        self.refills = self.opts.refills -- shorter steps are left
      end
    elseif taken.still then
      return taken.step and "infeasible" or "stuck"
    else
      self.t, point = taken.t, taken.point
    end
  end
end

-- Rounds of finding the worst load of the shape as it is, taking it in as a load case, and scaling,
-- until the load found is one that the shape carries.
local function descend_with_worst(self)
  local point, message, details
  for round = 1, self.opts.rounds do
    local view, part, worst
    view, part, details = self.stage:view(unknowns.scales(self, self.t))
    if not view then return nil, part, details end
    self.passing_on = true -- of the progress of the analysis
    worst, message, details = worst_case.class.analyse(part, self.opts.worst, view)
    self.passing_on = false
    if not worst then return nil, message, details end
    self.stage:add_forces(worst:force())
    view:close()
    local entry = {max_principal = worst.max_principal, mode = worst.mode, at = worst.at}
    worst:close()
    self.rounds[round] = entry
    point, message, details = self.stage:at(unknowns.scales(self, self.t))
    if not point then return nil, message, details end
    point, message, details = self.stage:sharpen(point)
    if not point then return nil, message, details end
    entry.max = point.cases[#point.cases].von_mises:max()
    if entry.max <= self.opts.von_mises and round > 1 then
      self.point = point
      return "met"
    end
    local last = entry.max <= self.opts.von_mises * (1 + self.opts.change)
    self.best = nil -- what was best for fewer loads need not be
    local word
    word, message, details = descend(self, point)
    if word ~= "met" or last then return word, message, details end
  end
  return "rounds"
end

-- ---- the answer ----------------------------------------------------------------------------------

local report = {__name = "barwright.optimisation"}
report.__index = report

function report:__tostring()
  local names = {}
  for name in pairs(self.factors) do names[#names + 1] = name end
  table.sort(names)
  local lines = {("%s: %s at most, from %s; limit %s; %d steps, %d nodes, %s"):format(
    self.met and "met" or "not met", core.quantity(self.von_mises, "Pa"), core.quantity(self.from, "Pa"),
    core.quantity(self.limit, "Pa"), self.iterations, self.constrained, core.quantity(self.seconds, "s"))}
  for _, name in ipairs(names) do
    local f = self.factors[name]
    lines[#lines + 1] = ("  %s: (%.4g, %.4g, %.4g)"):format(name, f[1], f[2], f[3])
  end
  return table.concat(lines, "\n")
end

-- What was reached with factors t at a point.
local function answer(self, point, t, met)
  local skeleton, factors = self.stage.topology.skeleton, {}
  for bone, scale in pairs(unknowns.scales(self, t)) do factors[skeleton.bone_names[bone]] = scale end
  local nodes = {}
  for i, constraint in ipairs(self.constraints) do
    nodes[i] = {node = constraint.node, case = constraint.case,
      von_mises = point.cases[constraint.case].von_mises[constraint.node]}
  end
  local change = unknowns.objective(self, t)
  return setmetatable({met = met, von_mises = point.max, node = point.node, case = point.case,
    from = self.history[1] and self.history[1].max or point.max, limit = self.opts.von_mises,
    factors = factors, change = change, mean_move = math.sqrt(change / #self.corners),
    iterations = math.max(0, #self.history - 1), constrained = #self.constraints, nodes = nodes,
    unknowns = #self.groups, history = self.history, rounds = #self.rounds > 0 and self.rounds or nil,
    shapes = self.stage.counts.shapes, solves = self.stage.counts.solves,
    factorisations = self.stage.counts.factorisations, adjoints = self.stage.counts.adjoints,
    seconds = core.seconds() - self.start}, report)
end

local reasons = {
  infeasible = "no factors within the bounds meet the limit of %s: the best has %s at node %d",
  stuck = "no step from where it is brings the stresses nearer to the limit of %s: the best has"
    .. " %s at node %d",
  cancelled = "stopped on the way to the limit of %s: the best has %s at node %d",
  slow = "the limit of %s was not met in time: the best has %s at node %d",
  rounds = "the worst load went on changing; under the last one the limit of %s was met up to"
    .. " %s at node %d",
}
local statuses = {infeasible = "infeasible", stuck = "convergence", slow = "convergence",
  rounds = "convergence", cancelled = "cancelled"}

local function refuse(self, word)
  local best = self.best
  for i = #best.t + 1, #self.groups do best.t[i] = 1 end
  local found = answer(self, best.point, best.t, false)
  local text = reasons[word]:format(core.quantity(self.limit, "Pa"),
    core.quantity(best.point.max, "Pa"), best.point.node or 0)
  local active = {}
  for i, group in ipairs(self.groups) do
    local t = best.t[i] or 1
    if t <= group.min * (1 + 1e-6) or t >= group.max * (1 - 1e-6) then
      for _, bone in ipairs(group.bones) do
        active[#active + 1] = ("%s across %s"):format(self.stage.topology.skeleton.bone_names[bone],
          ("xyz"):sub(group.axis, group.axis))
      end
    end
  end
  if self.refused then text = text .. "; " .. self.refused end
  if word == "cancelled" then
    text = text .. " (details.best); the session is as it was"
  elseif #self.groups == 0 then
    text = text .. "; no bone near the high stresses may change"
  elseif #active > 0 then
    text = text .. "; at their bounds are " .. table.concat(active, ", ")
  elseif self.inverted then
    text = text .. "; further steps are stopped by the mesh: " .. self.inverted .. " (wider blended "
      .. "subdomains, by a higher 'threshold' of the session, fold later)"
  end
  return nil, text, {status = statuses[word], best = found, von_mises = best.point.max}
end

-- ---- progress ------------------------------------------------------------------------------------

-- How many steps may be left: as many as the excess over the limit takes to fall to what is met, at the
-- rate at which it fell last.
local function steps_left(self)
  local history, limit = self.history, self.opts.von_mises
  local function excess(entry) return math.max(entry.max / limit - 1, models.margin) end
  if #history < 2 then return 4 end
  local now, before = excess(history[#history]), excess(history[#history - 1])
  local rate = math.max(0.02, math.min(0.5, now / before))
  return 1 + math.ceil(math.log(models.margin / now) / math.log(rate))
end

-- The whole work as one stage: what the engine tells is a part of a step.
local function reported(self, fraction)
  local done = #self.history
  local part = (done + 0.9 * math.max(0, math.min(1, fraction))) / (done + steps_left(self))
  if #self.rounds > 0 then part = (#self.rounds - 1 + part) / (#self.rounds + 1) end
  self.fraction = math.max(self.fraction or 0, math.min(part, 0.99))
  return self.fraction
end

-- Calls `work` with the progress function in force replaced by one that tells of the optimisation.
local function with_progress(self, work)
  local before
  before = core.progress(function(stage, fraction)
    if not self.passing_on then stage, fraction = "optimise", reported(self, fraction) end
    if before then return before(stage, fraction) end
    core.report_progress(stage, fraction)
  end)
  local ok, word, message, details = pcall(work, self)
  core.progress(before)
  if not ok then error(word, 0) end
  return word, message, details
end

--- Scales bones of a session until its part carries its loads: see the stubs for the options. One edit
--- is made at the end. Returns a report, or nil, message, details with the best point found.
function optimise.run(session, given)
  local opts = options.read("optimise", given, rules)
  local self = {session = session, opts = opts, start = core.seconds(), groups = {}, t = {}, H = {}, E = {},
    motions = {}, chosen = {}, constraints = {}, constrained = {}, history = {}, rounds = {},
    radius = opts.step, price = 0, spare = 0, refills = 0, blocked = {},
    limit = opts.von_mises * (1 - models.margin)}
  local parts = {}
  if opts.loads == "own" then parts[1] = session.source end
  for i, part in ipairs(opts.cases) do
    options.object("optimise", ("cases[%d]"):format(i), part, "model")
    parts[#parts + 1] = part
  end
  for _, part in ipairs(parts) do
    if core.is_joined(part) then
      return nil, "optimise: the slopes of stresses are known of parts without bonds, attachments and couplings: "
        .. "scale bones by edits", {status = "unsupported"}
    end
  end
  local skeleton = session.skeleton
  self.only = opts.bones and unknowns.bones(skeleton, opts.bones, "bones")
  local kept_bones
  kept_bones, self.fixed = optimise_fixed.split(session, opts.keep)
  if not opts.move_supports then optimise_fixed.add_supports(self.fixed, parts) end
  self.keep = unknowns.set(unknowns.bones(skeleton, kept_bones, "keep"))
  self.tied = unknowns.ties(skeleton, opts.ties)
  if opts.min_factor > opts.max_factor then
    raise(("optimise: option 'min_factor': at most max_factor expected, got %s above %s"):format(opts.min_factor,
      opts.max_factor))
  end
  local relief = opts.inertia_relief
  if opts.loads == "worst" then
    if #session.source.supports > 0 then
      raise("optimise: loads = \"worst\" is for a part without supports")
    end
    if relief == nil then relief = true end
  end
  self.stage = stages.new(session, parts, relief)
  if opts.loads == "worst" and self.stage.topology.node_from then
    return nil, "the mesh was refilled, and worst loads are for the mesh that the session began with: begin "
      .. "a session on the edited part", {status = "unsupported"}
  end
  self.corners = core.corner_nodes(self.stage.topology.mesh)
  local word, message, details = with_progress(self, function()
    if opts.loads == "worst" then return descend_with_worst(self) end
    local point, why, about = self.stage:at {}
    if not point then return nil, why, about end
    return descend(self, point)
  end)
  if not word and details.status == "cancelled" and self.best then word = "cancelled" end
  if not word then return nil, message, details end
  if word ~= "met" then return refuse(self, word) end
  local found = answer(self, self.point, self.t, true)
  local scales = unknowns.scales(self, self.t)
  if next(scales) then
    local ok
    ok, message, details = self.stage:commit(scales)
    if not ok then return nil, message, details end
  end
  return found
end

return optimise
