-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the plots and the report of a study ask its trials: values by name, who keeps the constraints, who is
-- best, what the design says.
local core = require "barwright.core"
local data = require "barwright.plot.data"
local numbers = require "barwright.plot.numbers"
local progress = require "barwright.plot.progress"

local raise = core.raise
local says = {}

--- The item of a list with this name, or nil.
function says.find(list, name)
  for _, item in ipairs(list) do
    if item.name == name then return item end
  end
end

--- The names of all variables, then of all measures.
function says.names_of(problem)
  local out = {}
  for _, list in ipairs {problem.variables, problem.measures} do
    for _, item in ipairs(list) do out[#out + 1] = item.name end
  end
  return out
end

--- The item of a name, and whether it is a variable. Raises for unknown ones.
function says.known(trials, where, name)
  local problem = trials.problem
  local item = says.find(problem.variables, name)
  if item then return item, true end
  item = says.find(problem.measures, name)
  if item then return item, false end
  raise(("%s: '%s' is no variable and no measure: %s"):format(where, tostring(name),
    core.suggestion(tostring(name), says.names_of(problem))))
end

--- Whether results are there and keep the constraints.
function says.keeps(problem, trial)
  if trial.status ~= "done" or not trial.results then return false end
  for _, c in ipairs(problem.constraints or {}) do
    local value = trial.results[c.name]
    if value == nil or c.min and value < c.min or c.max and value > c.max then return false end
  end
  return true
end

--- The same for all trials.
function says.feasible(trials)
  local out = {}
  for i = 1, #trials do out[i] = says.keeps(trials.problem, trials[i]) end
  return out
end

--- For all trials whether they have no results.
function says.failed(trials)
  local out = {}
  for i = 1, #trials do out[i] = trials[i].status ~= "done" end
  return out
end

--- For all trials the value of a measure (nan: none) or, `of_point`, of a variable (false: none).
function says.values_of(trials, name, of_point)
  local out = {}
  for i = 1, #trials do
    local from = of_point and trials[i].point or trials[i].results
    local value = from and from[name]
    if value == nil then out[i] = not of_point and 0 / 0 or false else out[i] = value end
  end
  return out
end

--- The goal of a measure, or nil where it has none.
function says.goal_of(problem, name)
  local objective = says.find(problem.objectives or {}, name)
  return objective and (objective.goal or "min")
end

--- A measure over two decades or more is shown by its logarithm where it can be.
function says.scale_of(values)
  local min, max = data.range {values}
  return min and min > 0 and max >= 100 * min and "log" or nil
end

--- A column of bw.plot for a variable or a measure.
function says.column(trials, where, name)
  local item, of_point = says.known(trials, where, name)
  local out = {name = name, unit = item.unit, values = says.values_of(trials, name, of_point),
    goal = not of_point and says.goal_of(trials.problem, name) or nil}
  if of_point and item.kind == "choice" then
    out.of = {}
    for i, choice in ipairs(item.of) do out.of[i] = tostring(choice) end
    for i = 1, #trials do out.values[i] = tostring(out.values[i]) end
    out.unit = nil
  elseif of_point then
    out.whole = item.kind == "integer" or nil
    out.scale = item.scale
    for i = 1, #trials do out.values[i] = out.values[i] or 0 / 0 end
  else
    out.scale = says.scale_of(out.values)
  end
  return out
end

--- "trial 7: thickness 2 mm, holes 3; mass 12 g"
function says.note(problem, trial)
  local parts = {{}, {}}
  for k, list in ipairs {problem.variables, problem.measures} do
    for _, item in ipairs(list) do
      local from = k == 1 and trial.point or trial.results
      local value = from and from[item.name]
      if value ~= nil then
        parts[k][#parts[k] + 1] = ("%s %s"):format(item.name, numbers.quantity(value, item.unit))
      end
    end
  end
  local text = ("trial %s: %s"):format(tostring(trial.number), table.concat(parts[1], ", "))
  if #parts[2] > 0 then return text .. "; " .. table.concat(parts[2], ", ") end
  return text .. "; " .. tostring(trial.status) .. (trial.message and ": " .. trial.message or "")
end

function says.notes_of(trials)
  if #trials > 3000 then return nil end -- a page of them would be slow
  local out = {}
  for i = 1, #trials do out[i] = says.note(trials.problem, trials[i]) end
  return out
end

--- The places of the best trial (one objective) or of the front (several).
function says.chosen(trials)
  local problem = trials.problem
  local objectives = problem.objectives or {}
  if #objectives == 0 then return {} end
  local able, list = says.feasible(trials), {}
  for k, objective in ipairs(objectives) do
    list[k] = {numbers = says.values_of(trials, objective.name), goal = objective.goal or "min"}
  end
  local out = {}
  for i in pairs(progress.find_front(list, able)) do out[#out + 1] = i end
  table.sort(out)
  if #objectives == 1 then return {out[1]} end
  return out
end

--- What the design says of the results: that of the run, or summed up from the trials that there are.
function says.summary(trials)
  local summary, study = trials.summary or {}, trials.study
  if summary.indices or summary.effects or summary.ranges then return summary end
  local design = type(study) == "table" and rawget(study, "design")
  local kind = design and design.kind
  if not kind or not kind.summarise or not study.planned then return summary end
  local planned = study:planned()
  if not planned then return summary end
  local by_key, points, results = {}, {}, {}
  for _, trial in ipairs(trials) do by_key[trial.key] = trial end
  for i, one in ipairs(planned) do
    local trial = by_key[one.key]
    points[i] = one.point
    results[i] = trial and trial.status == "done" and trial.results or false
  end
  return kind.summarise(trials.problem, design.opts, points, results)
end

return says
