-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- trials:plot(kind, options): plots of bw.plot with a study's names, units, goals and constraints.
local core = require "barwright.core"
local numbers = require "barwright.plot.numbers"
local options = require "barwright.options"
local pictures = require "barwright.study.pictures"
local plot = require "barwright.plot"
local says = require "barwright.study.plot_data"
local search = require "barwright.study.plot_search"

local raise = core.raise
local plots = {}

local function rules(own)
  own.title = {type = "string"}
  own.width = {type = "number"}
  own.height = {type = "number"}
  return own
end

local kinds = {}

-- The measure that is asked for: the one named, the first objective, the first measure.
local function measure_of(trials, where, name)
  local problem = trials.problem
  if not name then
    local first = (problem.objectives or {})[1] or problem.measures[1]
    if not first then raise(where .. ": the study measures nothing") end
    name = first.name
  end
  local item, of_point = says.known(trials, where, name)
  if of_point then raise(("%s: '%s' is a variable: a measure expected"):format(where, name)) end
  return item
end

kinds.history = {
  rules = rules {measure = {type = "string"}, goal = {type = "string", one_of = {"min", "max"}},
    scale = {type = "string", one_of = {"linear", "log"}}},
  make = function(trials, where, opts)
    local item = measure_of(trials, where, opts.measure)
    local order, values = {}, says.values_of(trials, item.name)
    for i = 1, #trials do order[i] = trials[i].number or i end
    return plot.history {values = values, numbers = order, label = item.name, unit = item.unit,
      goal = opts.goal or says.goal_of(trials.problem, item.name), scale = opts.scale or says.scale_of(values),
      failed = says.failed(trials), feasible = says.feasible(trials), notes = says.notes_of(trials),
      title = opts.title, width = opts.width, height = opts.height}
  end,
}

kinds.pareto = {
  rules = rules {objectives = {type = "table"}},
  make = function(trials, where, opts)
    local names = opts.objectives
    if not names then
      names = {}
      for i, objective in ipairs(trials.problem.objectives or {}) do names[i] = objective.name end
    end
    if #names < 2 then raise(where .. ": a study of two or more objectives, or objectives = {names}, expected") end
    local list = {}
    for i, name in ipairs(names) do list[i] = says.column(trials, where, name) end
    return plot.pareto {objectives = list, feasible = says.feasible(trials), notes = says.notes_of(trials),
      title = opts.title, width = opts.width, height = opts.height}
  end,
}

-- All variables and measures, or those named; the measures last, the objectives among them first where
-- there are too many.
local function columns_of(trials, where, names, max)
  local problem, list = trials.problem, {}
  if not names then
    names = says.names_of(problem)
    if #names > max then
      names = {}
      local taken = {}
      local function take(items, allowed)
        for _, item in ipairs(items or {}) do
          if not taken[item.name] and #names < allowed then
            names[#names + 1] = item.name
            taken[item.name] = true
          end
        end
      end
      take(problem.variables, math.max(1, max - math.max(1, #(problem.objectives or {}))))
      take(problem.objectives, max)
      take(problem.measures, max)
    end
  end
  for i, name in ipairs(names) do list[i] = says.column(trials, where, name) end
  return list
end

local function coloured(trials, where, opts)
  local name = opts.colour
  if not name then
    local first = (trials.problem.objectives or {})[1] or trials.problem.measures[1]
    name = first and first.name
  end
  if not name then return nil end
  local item, of_point = says.known(trials, where, name)
  if of_point and item.kind == "choice" then raise(("%s: colour: '%s' is no number"):format(where, name)) end
  local values = says.values_of(trials, name, of_point)
  return values, {label = name, unit = item.unit, scale = of_point and item.scale or says.scale_of(values)},
    says.goal_of(trials.problem, name)
end

local function stood_back(trials)
  local out = says.feasible(trials)
  for i = 1, #out do out[i] = not out[i] end
  return out
end

for kind, max in pairs {scatter_matrix = 8, parallel_coordinates = 24} do
  kinds[kind] = {
    rules = rules {columns = {type = "table"}, colour = {type = "string"}},
    make = function(trials, where, opts)
      local values, value, goal = coloured(trials, where, opts)
      local chosen = says.chosen(trials)
      if #chosen > (kind == "scatter_matrix" and 60 or 12) then chosen = nil end -- many are no choice
      return plot[kind] {columns = columns_of(trials, where, opts.columns, max), values = values,
        value = value, goal = goal, chosen = chosen, faint = stood_back(trials),
        notes = kind == "scatter_matrix" and #trials <= 300 and says.notes_of(trials) or nil,
        title = opts.title, width = opts.width, height = opts.height}
    end,
  }
end

kinds.scatter = {
  rules = rules {x = {type = "string", needed = true}, y = {type = "string", needed = true},
    colour = {type = "string"}, scale = {type = "string", one_of = {"linear", "log"}}},
  make = function(trials, where, opts)
    local x, y = says.column(trials, where, opts.x), says.column(trials, where, opts.y)
    if x.of or y.of then
      raise(("%s: '%s' is a choice: take scatter_matrix"):format(where, x.of and opts.x or opts.y))
    end
    local series = {x = x.values, y = y.values, notes = says.notes_of(trials)}
    local value
    if opts.colour then series.values, value = coloured(trials, where, opts) end
    return plot.scatter {series = {series}, values = value, title = opts.title, width = opts.width,
      height = opts.height, x = {label = opts.x, unit = x.unit, scale = opts.scale or x.scale, whole = x.whole},
      y = {label = opts.y, unit = y.unit, scale = opts.scale or y.scale, whole = y.whole}}
  end,
}

local function ends(list, key, which)
  local out = {}
  for i, item in ipairs(list) do out[i] = item[key] and item[key][which] or 0 / 0 end
  return out
end

local function each(list, key)
  local out = {}
  for i, item in ipairs(list) do out[i] = item[key] or 0 / 0 end
  return out
end

local function has(list, key)
  for _, item in ipairs(list) do
    if item[key] then return true end
  end
  return false
end

-- The measure at the base and at both ends of each variable.
local function spans(list, base)
  local low, high, at_base = {}, {}, nil
  for i, item in ipairs(list) do
    low[i], high[i] = item.results[1] or 0 / 0, item.results[#item.results] or 0 / 0
    for k, value in ipairs(item.values) do
      if base and value == base[item.name] then at_base = item.results[k] end
    end
  end
  return low, high, at_base
end

kinds.sensitivity = {
  rules = rules {measure = {type = "string"}},
  make = function(trials, where, opts)
    local item = measure_of(trials, where, opts.measure)
    local summary = says.summary(trials)
    local given = {label = item.name, title = opts.title, width = opts.width, height = opts.height}
    local list = (summary.indices or summary.effects or summary.ranges or {})[item.name]
    if not list then
      raise(where .. ": a study with the design sobol_indices, morris or one_at_a_time expected")
    end
    given.names = {}
    for i, one in ipairs(list) do given.names[i] = one.name end
    if summary.indices then
      for _, key in ipairs {"first", "total"} do
        given[key] = each(list, key)
        if has(list, key .. "_interval") then
          given[key .. "_low"], given[key .. "_high"] = ends(list, key .. "_interval", 1),
            ends(list, key .. "_interval", 2)
        end
      end
    elseif summary.effects then
      given.unit, given.mu_star, given.sigma = item.unit, each(list, "mu_star"), each(list, "sigma")
      if has(list, "mu_star_interval") then
        given.mu_star_low, given.mu_star_high = ends(list, "mu_star_interval", 1),
          ends(list, "mu_star_interval", 2)
      end
    else
      given.unit = item.unit
      given.low, given.high, given.base = spans(list, summary.base)
    end
    return plot.sensitivity(given)
  end,
}

kinds.convergence = {
  rules = rules {},
  make = function(trials, where, opts)
    local objectives = trials.problem.objectives or {}
    if #objectives == 0 or #objectives > 3 then
      raise(where .. ": a study of one to three objectives expected")
    end
    local x, y, label
    local marks, at = {}, nil
    if #objectives == 1 then
      local best
      local unit = says.find(trials.problem.measures, objectives[1].name).unit
      x, y, at, best = search.gaps(trials, objectives[1])
      if at then
        marks[1] = {x = at, name = "best: " .. numbers.quantity(best, unit)}
        if #x > 0 then x[#x + 1], y[#y + 1] = at, y[#y] end -- the last step ends there
      end
      label = {label = objectives[1].name .. ": best so far, from the best", unit = unit,
        scale = says.scale_of(y) or "linear"}
    else
      x, y = search.volumes(trials, objectives)
      label = {label = "hypervolume of the front so far, of that at the end", min = 0, max = 1.04}
    end
    return plot.lines {series = {{x = x, y = y, steps = true, markers = not at and #x <= 60}}, y = label,
      marks = marks, x = {label = "trial", whole = true}, title = opts.title, width = opts.width,
      height = opts.height}
  end,
}

kinds.contact_sheet = {
  rules = rules {picture = {type = "string"}, max = {type = "integer", min = 1, max = 400, default = 40},
    columns = {type = "integer"}, cell = {type = "number"}},
  make = function(trials, _, opts)
    return plot.contact_sheet {pictures = pictures.of(trials, opts.picture, opts.max), title = opts.title,
      columns = opts.columns, cell = opts.cell, lines = 3}
  end,
}

--- The names of the kinds, in alphabetical order.
function plots.kinds()
  local names = {}
  for name in pairs(kinds) do names[#names + 1] = name end
  table.sort(names)
  return names
end

--- A figure of the trials. kind: history, convergence, pareto, scatter, scatter_matrix,
--- parallel_coordinates, sensitivity, contact_sheet.
function plots.plot(trials, kind, given)
  local one = kinds[kind]
  if not one then
    raise(("plot: there is no kind '%s': one of %s expected"):format(tostring(kind),
      table.concat(plots.kinds(), ", ")))
  end
  local where = "plot " .. kind
  return one.make(trials, where, options.read(where, given, one.rules))
end

return plots
