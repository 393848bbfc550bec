-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a study gives back: a list of trials that have ended, in the order in which the design asked for
-- them, with the questions that are asked of them most.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local csv = require "barwright.study.csv"
local front = require "barwright.study.front"
local numbers = require "barwright.plot.numbers"

local raise = core.raise

local trials = {}
local methods = {}
local meta = {__name = "trials"}
trials.class, trials.meta = methods, meta

function meta.__index(_, name)
  return methods[name]
end

-- ---- one of them -------------------------------------------------------------------------------------

local record = {__name = "trial"}
record.__index = record
trials.record = record

local function values_text(items, values)
  local parts = {}
  for _, item in ipairs(items) do
    local value = values[item.name]
    if value ~= nil then
      parts[#parts + 1] = ("%s %s"):format(item.name, type(value) == "number"
        and numbers.quantity(value, item.unit) or tostring(value))
    end
  end
  return table.concat(parts, ", ")
end

function record:__tostring()
  local problem = self.problem
  local head = ("trial %d (%s): %s"):format(self.number, values_text(problem.variables, self.point), self.status)
  if self.status == "done" then return head .. ": " .. values_text(problem.measures, self.results) end
  return head .. (self.message and ": " .. self.message or "")
end

--- The record as others see it; what is the same for all of them stays in the metatable.
function trials.present(plain, problem, study)
  local own = problem.record_meta
  if not own then
    own = {__name = "trial", __tostring = record.__tostring, __index = {problem = problem}}
    problem.record_meta = own
  end
  if not plain.folder then plain.folder = ("%s/%s"):format(study.trial_folder, plain.key:sub(1, 12)) end
  return setmetatable(plain, own)
end

-- ---- all of them -------------------------------------------------------------------------------------

--- A list of trials of a study.
function trials.new(study, list)
  local self = list or {}
  self.problem, self.study, self.summary = study.problem, study, {}
  return setmetatable(self, meta)
end

--- A message as all trials have it that ended the same way: without the trial's own number.
function trials.common(message)
  return (message:gsub("^trial %d+ ", "the trial "))
end

local function known_column(self, name)
  local problem = self.problem
  if problem.variable[name] then return "point" end
  if problem.measure[name] then return "results" end
  for _, own in ipairs {"number", "seconds", "processor_seconds", "peak_bytes", "seed", "key", "status"} do
    if own == name then return "self" end
  end
  local names = {}
  for _, v in ipairs(problem.variables) do names[#names + 1] = v.name end
  for _, m in ipairs(problem.measures) do names[#names + 1] = m.name end
  raise(("column: '%s' is no variable and no measure: %s"):format(tostring(name),
    core.suggestion(tostring(name), names)))
end

--- The values of a variable, a measure, or of number, seconds, peak_bytes, ..., one for each trial that is
--- done (`all`: of every trial, with false where there is none).
function methods:column(name, opts)
  local place = known_column(self, name)
  local all = opts and opts.all
  local out = {}
  for _, trial in ipairs(self) do
    local from = trial
    if place ~= "self" then from = trial[place] end
    local value = from and from[name]
    if all then
      if value == nil then value = false end
      out[#out + 1] = value
    elseif trial.status == "done" and value ~= nil then
      out[#out + 1] = value
    end
  end
  return out
end

--- The trials of a status ("done", "failed", "time", "memory", "crashed"), or those a function chooses.
function methods:where(which)
  local list = {}
  for _, trial in ipairs(self) do
    local yes
    if type(which) == "function" then yes = which(trial) else yes = trial.status == which end
    if yes then list[#list + 1] = trial end
  end
  return trials.new(self.study, list)
end

local function objective_of(self, name)
  local problem = self.problem
  if name == nil then
    if #problem.objectives == 0 then raise "best: a measure expected, since the study has no objectives" end
    return problem.objectives[1]
  end
  for _, objective in ipairs(problem.objectives) do
    if objective.name == name then return objective end
  end
  if not problem.measure[name] then known_column(self, name) end
  return {name = name, goal = "min"}
end

--- The trial that is best by the first objective, or by the one named, of those that keep the
--- constraints; nil and a sentence where none does.
function methods:best(name)
  local objective, problem = objective_of(self, name), self.problem
  local sign = objective.goal == "max" and -1 or 1
  local best, cost
  for _, trial in ipairs(self) do
    local value = trial.results and trial.results[objective.name]
    if value and problem:violation(trial.results) == 0 and (not best or sign * value < cost) then
      best, cost = trial, sign * value
    end
  end
  if best then return best end
  return nil, ("none of %d trials keeps the constraints"):format(#self), {status = "infeasible"}
end

--- The trials that no other one beats in every objective, of those that keep the constraints, by the
--- first objective.
function methods:front()
  if #self.problem.objectives == 0 then raise "front: a study with objectives expected, got one without" end
  local list, costs = {}, {}
  for _, trial in ipairs(self) do
    if self.problem:feasible(trial) then
      list[#list + 1] = trial
      costs[#costs + 1] = self.problem:costs(trial.results)
    end
  end
  local out = {}
  for _, i in ipairs(front.of(costs)) do out[#out + 1] = list[i] end
  table.sort(out, function(a, b)
    local x, y = self.problem:costs(a.results), self.problem:costs(b.results)
    for k = 1, #x do
      if x[k] ~= y[k] then return x[k] < y[k] end
    end
    return a.number < b.number
  end)
  return trials.new(self.study, out)
end

--- How many there are of each status.
function methods:counts()
  local counts = {done = 0, failed = 0, time = 0, memory = 0, crashed = 0}
  for _, trial in ipairs(self) do counts[trial.status] = (counts[trial.status] or 0) + 1 end
  return counts
end

--- All trials as a table for other programs (RFC 4180).
function methods:csv(path)
  return csv.write(path, self, self.problem)
end

--- A figure; see barwright.study.plots.
function methods:plot(kind, options)
  return require("barwright.study.plots").plot(self, kind, options)
end

--- A measure between the trials; see surrogate.lua.
function methods:surrogate(name)
  return require("barwright.study.surrogate").of(self, name)
end

--- One HTML file; see barwright.study.report.
function methods:report(path, options)
  return require("barwright.study.report").write(self, path, options)
end

arguments.methods("trials", methods, meta, {column = "name: string, options?: options",
  where = "which: string|function",
  best = "name?: string", front = "", counts = "", csv = "path: string", plot = "kind: string, options?: options",
  report = "path: string, options?: options", surrogate = "name: string"})

local bad_words = {failed = "failed", time = "out of time", memory = "out of memory", crashed = "crashed"}

--- "98 done, 2 failed"
function trials.counts_text(counts)
  local parts = {("%d done"):format(counts.done)}
  for _, status in ipairs {"failed", "time", "memory", "crashed"} do
    if counts[status] > 0 then parts[#parts + 1] = ("%d %s"):format(counts[status], bad_words[status]) end
  end
  return table.concat(parts, ", ")
end

function meta.__tostring(self)
  local lines = {("%d trials of study %s: %s"):format(#self, self.study.name, trials.counts_text(self:counts()))}
  if self.stopped then lines[1] = lines[1] .. " (stopped: " .. self.stopped .. ")" end
  local problem = self.problem
  if #problem.objectives == 1 then
    local best, why = self:best()
    lines[#lines + 1] = best and ("%s: %s"):format(problem:goal_text(problem.objectives[1]), tostring(best)) or why
  elseif #problem.objectives > 1 then
    local few = self:front()
    lines[#lines + 1] = ("front of %d trials:"):format(#few)
    for i = 1, math.min(#few, 12) do lines[#lines + 1] = "  " .. tostring(few[i]) end
    if #few > 12 then lines[#lines + 1] = ("  and %d more"):format(#few - 12) end
  else
    for _, m in ipairs(problem.measures) do
      local min, max = math.huge, -math.huge
      for _, value in ipairs(self:column(m.name)) do
        min, max = math.min(min, value), math.max(max, value)
      end
      if min <= max then
        lines[#lines + 1] = ("%s: %s to %s"):format(m.name, numbers.quantity(min, m.unit),
          numbers.quantity(max, m.unit))
      end
    end
  end
  local text = self.summary and self.summary.text
  if text then lines[#lines + 1] = text end
  return table.concat(lines, "\n")
end

return trials
