-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- trials:plot(kind, options): plots of bw.plot with a study's names, units, goals and constraints.
local core = require "barwright.core"
local data = require "barwright.plot.data"
local numbers = require "barwright.plot.numbers"
local options = require "barwright.options"
local plot = require "barwright.plot"
local progress = require "barwright.plot.progress"

local raise = core.raise
local plots = {}

-- ---- what the trials say -----------------------------------------------------------------------

local function find(list, name)
  for _, item in ipairs(list) do
    if item.name == name then return item end
  end
end

local function names_of(problem)
  local out = {}
  for _, list in ipairs {problem.variables, problem.measures} do
    for _, item in ipairs(list) do out[#out + 1] = item.name end
  end
  return out
end

--- The item of a name, and whether it is a variable. Raises for unknown ones.
local function known(trials, where, name)
  local problem = trials.problem
  local item = find(problem.variables, name)
  if item then return item, true end
  item = find(problem.measures, name)
  if item then return item, false end
  raise(("%s: '%s' is no variable and no measure: did you mean '%s'?"):format(where, tostring(name),
    core.nearest(tostring(name), names_of(problem))))
end

--- Whether results are there and keep the constraints.
function plots.keeps(problem, trial)
  if trial.status ~= "done" or not trial.results then return false end
  for _, c in ipairs(problem.constraints or {}) do
    local value = trial.results[c.name]
    if value == nil or c.least and value < c.least or c.most and value > c.most then return false end
  end
  return true
end

local function feasible(trials)
  local out = {}
  for i = 1, #trials do out[i] = plots.keeps(trials.problem, trials[i]) end
  return out
end

local function failed(trials)
  local out = {}
  for i = 1, #trials do out[i] = trials[i].status ~= "done" end
  return out
end

local function values_of(trials, name, of_point)
  local out = {}
  for i = 1, #trials do
    local from = of_point and trials[i].point or trials[i].results
    local value = from and from[name]
    if value == nil then out[i] = not of_point and 0 / 0 or false else out[i] = value end
  end
  return out
end

local function goal_of(problem, name)
  local objective = find(problem.objectives or {}, name)
  return objective and (objective.goal or "least")
end

-- A measure over two decades or more is shown by its logarithm where it can be.
local function scale_of(values)
  local least, most = data.range {values}
  return least and least > 0 and most >= 100 * least and "log" or nil
end

-- A column of bw.plot for a variable or a measure.
local function column(trials, where, name)
  local item, of_point = known(trials, where, name)
  local out = {name = name, unit = item.unit, values = values_of(trials, name, of_point),
    goal = not of_point and goal_of(trials.problem, name) or nil}
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
    out.scale = scale_of(out.values)
  end
  return out
end

--- "trial 7: thickness 2 mm, holes 3; mass 12 g"
function plots.note(problem, trial)
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

local function notes_of(trials)
  if #trials > 3000 then return nil end -- a page of them would be slow
  local out = {}
  for i = 1, #trials do out[i] = plots.note(trials.problem, trials[i]) end
  return out
end

--- The places of the best trial (one objective) or of the front (several).
function plots.chosen(trials)
  local problem = trials.problem
  local objectives = problem.objectives or {}
  if #objectives == 0 then return {} end
  local able, list = feasible(trials), {}
  for k, objective in ipairs(objectives) do
    list[k] = {numbers = values_of(trials, objective.name), goal = objective.goal or "least"}
  end
  local out = {}
  for i in pairs(progress.find_front(list, able)) do out[#out + 1] = i end
  table.sort(out)
  if #objectives == 1 then return {out[1]} end
  return out
end

--- What the design says of the results: that of the run, or summed up from the trials that there are.
function plots.summary(trials)
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
  return kind.summarise(trials.problem, design.wish, points, results)
end

-- ---- kinds -------------------------------------------------------------------------------------

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
  local item, of_point = known(trials, where, name)
  if of_point then raise(("%s: '%s' is a variable: a measure expected"):format(where, name)) end
  return item
end

kinds.history = {
  rules = rules {measure = {type = "string"}, goal = {type = "string", one_of = {"least", "most"}},
    scale = {type = "string", one_of = {"linear", "log"}}},
  make = function(trials, where, wish)
    local item = measure_of(trials, where, wish.measure)
    local order, values = {}, values_of(trials, item.name)
    for i = 1, #trials do order[i] = trials[i].number or i end
    return plot.history {values = values, numbers = order, label = item.name, unit = item.unit,
      goal = wish.goal or goal_of(trials.problem, item.name), scale = wish.scale or scale_of(values),
      failed = failed(trials), feasible = feasible(trials), notes = notes_of(trials), title = wish.title,
      width = wish.width, height = wish.height}
  end,
}

kinds.pareto = {
  rules = rules {objectives = {type = "table"}},
  make = function(trials, where, wish)
    local names = wish.objectives
    if not names then
      names = {}
      for i, objective in ipairs(trials.problem.objectives or {}) do names[i] = objective.name end
    end
    if #names < 2 then raise(where .. ": a study of two or more objectives, or objectives = {names}, expected") end
    local list = {}
    for i, name in ipairs(names) do list[i] = column(trials, where, name) end
    return plot.pareto {objectives = list, feasible = feasible(trials), notes = notes_of(trials),
      title = wish.title, width = wish.width, height = wish.height}
  end,
}

-- All variables and measures, or those named; the measures last, the objectives among them first where
-- there are too many.
local function columns_of(trials, where, names, most)
  local problem, list = trials.problem, {}
  if not names then
    names = names_of(problem)
    if #names > most then
      names = {}
      local taken = {}
      local function take(items, room)
        for _, item in ipairs(items or {}) do
          if not taken[item.name] and #names < room then
            names[#names + 1] = item.name
            taken[item.name] = true
          end
        end
      end
      take(problem.variables, math.max(1, most - math.max(1, #(problem.objectives or {}))))
      take(problem.objectives, most)
      take(problem.measures, most)
    end
  end
  for i, name in ipairs(names) do list[i] = column(trials, where, name) end
  return list
end

local function coloured(trials, where, wish)
  local name = wish.colour
  if not name then
    local first = (trials.problem.objectives or {})[1] or trials.problem.measures[1]
    name = first and first.name
  end
  if not name then return nil end
  local item, of_point = known(trials, where, name)
  if of_point and item.kind == "choice" then raise(("%s: colour: '%s' is no number"):format(where, name)) end
  local values = values_of(trials, name, of_point)
  return values, {label = name, unit = item.unit, scale = of_point and item.scale or scale_of(values)},
    goal_of(trials.problem, name)
end

local function stood_back(trials)
  local out = feasible(trials)
  for i = 1, #out do out[i] = not out[i] end
  return out
end

for kind, most in pairs {scatter_matrix = 8, parallel_coordinates = 24} do
  kinds[kind] = {
    rules = rules {columns = {type = "table"}, colour = {type = "string"}},
    make = function(trials, where, wish)
      local values, value, goal = coloured(trials, where, wish)
      local chosen = plots.chosen(trials)
      if #chosen > (kind == "scatter_matrix" and 60 or 12) then chosen = nil end -- many are no choice
      return plot[kind] {columns = columns_of(trials, where, wish.columns, most), values = values,
        value = value, goal = goal, chosen = chosen, faint = stood_back(trials),
        notes = kind == "scatter_matrix" and #trials <= 300 and notes_of(trials) or nil,
        title = wish.title, width = wish.width, height = wish.height}
    end,
  }
end

kinds.scatter = {
  rules = rules {x = {type = "string", needed = true}, y = {type = "string", needed = true},
    colour = {type = "string"}, scale = {type = "string", one_of = {"linear", "log"}}},
  make = function(trials, where, wish)
    local x, y = column(trials, where, wish.x), column(trials, where, wish.y)
    if x.of or y.of then
      raise(("%s: '%s' is a choice: take scatter_matrix"):format(where, x.of and wish.x or wish.y))
    end
    local series = {x = x.values, y = y.values, notes = notes_of(trials)}
    local value
    if wish.colour then series.values, value = coloured(trials, where, wish) end
    return plot.scatter {series = {series}, values = value, title = wish.title, width = wish.width,
      height = wish.height, x = {label = wish.x, unit = x.unit, scale = wish.scale or x.scale, whole = x.whole},
      y = {label = wish.y, unit = y.unit, scale = wish.scale or y.scale, whole = y.whole}}
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
  local low, high, middle = {}, {}, nil
  for i, item in ipairs(list) do
    low[i], high[i] = item.results[1] or 0 / 0, item.results[#item.results] or 0 / 0
    for k, value in ipairs(item.values) do
      if base and value == base[item.name] then middle = item.results[k] end
    end
  end
  return low, high, middle
end

kinds.sensitivity = {
  rules = rules {measure = {type = "string"}},
  make = function(trials, where, wish)
    local item = measure_of(trials, where, wish.measure)
    local summary = plots.summary(trials)
    local given = {label = item.name, title = wish.title, width = wish.width, height = wish.height}
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

-- ---- pictures ----------------------------------------------------------------------------------

local function exists(path)
  local file = io.open(path, "rb")
  if file then file:close() end
  return file ~= nil
end

-- The PNG files of a folder, by name.
local function pictures_in(folder)
  local out = {}
  for _, part in ipairs(core.list_folder and core.list_folder(folder) or {}) do
    if not part.folder and part.name:lower():match "%.png$" then out[#out + 1] = part.name end
  end
  table.sort(out)
  return out
end

--- The picture of a trial: of the name given, else picture.png, else the first PNG file of its folder; nil.
function plots.picture(trial, name)
  local folder = trial.folder
  if type(folder) ~= "string" then return nil end
  if name then return exists(folder .. "/" .. name) and folder .. "/" .. name or nil end
  if exists(folder .. "/picture.png") then return folder .. "/picture.png" end
  local first = pictures_in(folder)[1]
  return first and folder .. "/" .. first
end

-- The point and the first objective in two lines.
local function caption_of(problem, trial)
  local point = {}
  for _, v in ipairs(problem.variables) do
    local value = trial.point and trial.point[v.name]
    if value ~= nil then -- a name stays with its value
      local text = ("%s %s"):format(v.name, numbers.quantity(value, v.unit))
      point[#point + 1] = (text:gsub(" ", "\u{a0}"))
    end
  end
  local found = {}
  for _, list in ipairs {problem.objectives or {}, problem.measures} do
    for _, item in ipairs(list) do
      local measure = find(problem.measures, item.name)
      local value = trial.results and trial.results[item.name]
      if value and not found[item.name] and #found < 2 then
        found[item.name] = true
        found[#found + 1] = ("%s %s"):format(item.name, numbers.quantity(value, measure and measure.unit))
      end
    end
  end
  return ("%s: %s\n%s"):format(tostring(trial.number), #found > 0 and table.concat(found, ", ")
    or tostring(trial.status), table.concat(point, ", "))
end

--- Pictures for a contact sheet: those of the best or the front first, `most` of them.
function plots.pictures(trials, name, most)
  local chosen, order, seen = {}, {}, {}
  for _, i in ipairs(plots.chosen(trials)) do
    chosen[i] = true
    order[#order + 1] = i
  end
  for i = 1, #trials do
    if not chosen[i] then order[#order + 1] = i end
  end
  for _, i in ipairs(order) do
    local path = #seen < most and plots.picture(trials[i], name)
    if path then
      seen[#seen + 1] = {path = path, caption = caption_of(trials.problem, trials[i]), chosen = chosen[i]}
    end
  end
  return seen
end

kinds.contact_sheet = {
  rules = rules {picture = {type = "string"}, most = {type = "integer", least = 1, most = 400, default = 40},
    columns = {type = "integer"}, cell = {type = "number"}},
  make = function(trials, _, wish)
    return plot.contact_sheet {pictures = plots.pictures(trials, wish.picture, wish.most), title = wish.title,
      columns = wish.columns, cell = wish.cell, lines = 3}
  end,
}

--- A figure of the trials. kind: history, pareto, scatter, scatter_matrix, parallel_coordinates,
--- sensitivity, contact_sheet.
function plots.plot(trials, kind, given)
  local one = kinds[kind]
  if not one then
    local names = {}
    for name in pairs(kinds) do names[#names + 1] = name end
    raise(("plot: there is no kind '%s': did you mean '%s'?"):format(tostring(kind),
      core.nearest(tostring(kind), names)))
  end
  local where = "plot " .. kind
  return one.make(trials, where, options.read(where, given, one.rules))
end

return plots
