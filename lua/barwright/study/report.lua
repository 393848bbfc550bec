-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- trials:report(path): one HTML file that opens from disk without network: what was asked, what was
-- found, what failed, all plots that fit, pictures, all trials. The page is web/study.html.
local beside = require "barwright.beside"
local core = require "barwright.core"
local html = require "barwright.html"
local json = require "barwright.json"
local numbers = require "barwright.plot.numbers"
local options = require "barwright.options"
local pictures = require "barwright.study.pictures"
local plots = require "barwright.study.plots"
local says = require "barwright.study.plot_data"

local escape = html.escape
local report = {}

local rules = {
  title = {type = "string"},
  text = {type = "string"}, -- a paragraph above all
  picture = {type = "string"}, -- which file of a trial's folder is its picture
  pictures = {type = "integer", min = 0, max = 400, default = 40}, -- at most so many
  rows = {type = "integer", min = 0, default = 5000}, -- of the table of trials
  manifest = {type = "table"},
}

-- ---- tables ------------------------------------------------------------------------------------

-- One line of a value with its unit as a cell that sorts by number.
local function cell(value, unit)
  if value == nil then return {"", ["data-sort"] = ""} end
  if math.type(value) == nil then return {value, ["data-sort"] = value} end
  return {numbers.quantity(value, unit), ["data-sort"] = (("%.17g"):format(value):gsub(",", "."))}
end

local function range_of(v)
  if v.distribution then return tostring(v.distribution) end
  if v.kind == "choice" then
    local words = {}
    for i, choice in ipairs(v.of) do words[i] = tostring(choice) end
    return table.concat(words, ", ")
  end
  return ("%s to %s%s"):format(numbers.quantity(v.min, v.unit), numbers.quantity(v.max, v.unit),
    v.scale == "log" and ", by its logarithm" or "")
end

local function bounds_of(c, unit)
  local parts = {}
  if c.min then parts[#parts + 1] = "at least " .. numbers.quantity(c.min, unit) end
  if c.max then parts[#parts + 1] = "at most " .. numbers.quantity(c.max, unit) end
  return table.concat(parts, ", ")
end

local function asked(problem)
  local rows = {}
  for i, v in ipairs(problem.variables) do
    rows[i] = {v.name, v.kind or "real", range_of(v), v.unit or "", v.what or ""}
  end
  local out = {"<h3>Variables</h3>\n", html.table({"name", "kind", "range", "unit", "about"}, rows)}
  rows = {}
  for i, m in ipairs(problem.measures) do
    local wanted = {}
    for _, objective in ipairs(problem.objectives or {}) do
      if objective.name == m.name then wanted[#wanted + 1] = "goal: " .. (objective.goal or "min") end
    end
    for _, c in ipairs(problem.constraints or {}) do
      if c.name == m.name then wanted[#wanted + 1] = bounds_of(c, m.unit) end
    end
    rows[i] = {m.name, m.unit or "", table.concat(wanted, "; "), m.what or ""}
  end
  out[#out + 1] = "<h3>Measures</h3>\n"
  out[#out + 1] = html.table({"name", "unit", "wanted", "about"}, rows)
  return table.concat(out)
end

-- "latin_hypercube, count 100"
local function design_text(study)
  local design = type(study) == "table" and study.design
  if type(design) ~= "table" then return nil end
  local parts = {}
  for key, value in pairs(type(design.opts) == "table" and design.opts or {}) do
    if type(value) == "number" or type(value) == "string" or type(value) == "boolean" then
      parts[#parts + 1] = ("%s %s"):format(key, tostring(value))
    end
  end
  table.sort(parts)
  table.insert(parts, 1, tostring(design.name or "a function"))
  return table.concat(parts, ", ")
end

local function facts(trials)
  local study = trials.study or {}
  local seconds = 0
  for i = 1, #trials do seconds = seconds + (trials[i].seconds or 0) end
  local rows = {{"design", design_text(study)}, {"seed", study.seed}, {"file", study.file},
    {"trials", #trials}, {"time of all trials", seconds > 0 and numbers.quantity(seconds, "s") or nil},
    {"stopped", trials.stopped}}
  local out = {'<dl class="facts">\n'}
  for _, key in ipairs {1, 2, 3, 4, 5, 6} do
    local row = rows[key]
    if row[2] ~= nil then
      out[#out + 1] = ("<dt>%s</dt><dd>%s</dd>\n"):format(row[1], escape(tostring(row[2])))
    end
  end
  out[#out + 1] = "</dl>\n"
  return table.concat(out)
end

-- ---- trials ------------------------------------------------------------------------------------

-- The columns of a table of trials: where values are, and the unit that all of a column have.
local function columns_of(trials)
  local out = {}
  for k, list in ipairs {trials.problem.variables, trials.problem.measures} do
    for _, item in ipairs(list) do
      local one = {name = item.name, from = k == 1 and "point" or "results", factor = 1, head = item.name}
      local size = 0
      for i = 1, #trials do
        local value = trials[i][one.from] and trials[i][one.from][item.name]
        if math.type(value) then size = math.max(size, math.abs(value)) end
      end
      if item.unit and item.unit ~= "" and item.kind ~= "choice" then
        local unit
        one.factor, unit = numbers.unit(item.unit, size)
        one.head = item.name .. ", " .. unit
      end
      out[#out + 1] = one
    end
  end
  return out
end

local function head_of(columns)
  local head = {"trial"}
  for k, one in ipairs(columns) do head[k + 1] = one.head end
  return head
end

local function row_of(columns, trial)
  local row = {cell(trial.number)}
  for k, one in ipairs(columns) do
    local value = trial[one.from] and trial[one.from][one.name]
    row[k + 1] = cell(value)
    if math.type(value) then row[k + 1][1] = numbers.short(value * one.factor) end
  end
  return row
end

local words = {done = "done", failed = "failed", time = "out of time", memory = "out of memory",
  crashed = "crashed"}

local function all_trials(trials, max)
  local problem, columns = trials.problem, columns_of(trials)
  local head, rows = head_of(columns), {}
  head[#head + 1] = "status"
  head[#head + 1] = "seconds"
  local chosen = {}
  for _, i in ipairs(says.chosen(trials)) do chosen[i] = true end
  for i = 1, math.min(#trials, max) do
    local trial = trials[i]
    local row = row_of(columns, trial)
    local keeps = says.keeps(problem, trial)
    local status = words[trial.status] or tostring(trial.status)
    if trial.status == "done" and not keeps then status = "misses a constraint" end
    row[#row + 1] = {status .. (trial.message and ": " .. trial.message or ""), ["data-sort"] = status}
    row[#row + 1] = cell(trial.seconds)
    row.class = chosen[i] and "chosen" or trial.status ~= "done" and "bad" or not keeps and "faint" or ""
    rows[i] = row
  end
  local out = {html.table(head, rows, "sortable")}
  if #trials > max then
    out[2] = ('<p class="hint">The first %d of %d trials.</p>\n'):format(max, #trials)
  end
  return table.concat(out)
end

local function found(trials)
  local problem = trials.problem
  local objectives = problem.objectives or {}
  if #trials == 0 then return "<p>There are no trials yet.</p>\n" end
  local chosen = says.chosen(trials)
  if #objectives == 0 then
    local rows = {}
    for i, m in ipairs(problem.measures) do
      local list = {}
      for k = 1, #trials do
        local value = trials[k].results and trials[k].results[m.name]
        if value then list[#list + 1] = value end
      end
      table.sort(list)
      rows[i] = {m.name, cell(list[1], m.unit), cell(list[(#list + 1) // 2], m.unit), cell(list[#list], m.unit)}
    end
    return "<h3>Measures</h3>\n" .. html.table({"measure", "min", "median", "max"}, rows)
  end
  if #chosen == 0 then return "<p>No trial keeps the constraints.</p>\n" end
  local rows, columns = {}, columns_of(trials)
  local name, sign = objectives[1].name, objectives[1].goal == "max" and -1 or 1
  table.sort(chosen, function(a, b)
    local u, v = trials[a].results[name], trials[b].results[name]
    if u ~= v then return sign * u < sign * v end
    return a < b
  end)
  for k, i in ipairs(chosen) do
    if k <= 200 then rows[k] = row_of(columns, trials[i]) end
  end
  local text = #objectives == 1 and "<h3>Best</h3>\n"
    or ("<h3>Front</h3>\n<p>%d trial%s that no other beats:</p>\n"):format(#chosen,
      #chosen == 1 and "" or "s")
  return text .. html.table(head_of(columns), rows, #chosen > 1 and "sortable" or nil)
end

local function join_numbers(list)
  local shown = {}
  for i = 1, math.min(#list, 12) do shown[i] = tostring(list[i]) end
  return table.concat(shown, ", ") .. (#list > 12 and (" and %d more"):format(#list - 12) or "")
end

-- How many ended how.
local function statuses(trials)
  local counts = {}
  for i = 1, #trials do
    local trial = trials[i]
    local status = trial.status or "?"
    if status == "done" and not says.keeps(trials.problem, trial) then status = "infeasible" end
    counts[status] = (counts[status] or 0) + 1
  end
  local out = {'<ul class="counts">\n'}
  for _, one in ipairs {{"done", "done"}, {"infeasible", "done, misses a constraint"}, {"failed", "failed"},
    {"time", "out of time"}, {"memory", "out of memory"}, {"crashed", "crashed"}} do
    if counts[one[1]] then
      out[#out + 1] = ('<li class="%s"><b>%d</b> %s</li>\n'):format(one[1], counts[one[1]], one[2])
    end
  end
  out[#out + 1] = "</ul>\n"
  return table.concat(out)
end

-- The messages of those that failed, the commonest first.
local function failures(trials)
  local by_text, order = {}, {}
  local common = require("barwright.study.trials").common
  for i = 1, #trials do
    local trial = trials[i]
    if trial.status ~= "done" then
      local text = ("%s: %s"):format(words[trial.status] or tostring(trial.status),
        trial.message and common(trial.message) or "no message")
      if not by_text[text] then
        by_text[text] = {}
        order[#order + 1] = text
      end
      table.insert(by_text[text], trial.number or i)
    end
  end
  table.sort(order, function(a, b)
    if #by_text[a] ~= #by_text[b] then return #by_text[a] > #by_text[b] end
    return a < b
  end)
  local rows = {}
  for i = 1, math.min(#order, 100) do
    rows[i] = {cell(#by_text[order[i]]), order[i], join_numbers(by_text[order[i]])}
  end
  if #rows == 0 then return "" end
  return "<h3>What went wrong</h3>\n" .. html.table({"trials", "message", "numbers"}, rows, "wide")
end

-- ---- plots -------------------------------------------------------------------------------------

-- Every plot that fits: {title, kind, options}.
local function fitting(trials)
  local problem, out = trials.problem, {}
  local objectives = problem.objectives or {}
  local function add(title, kind, opts) out[#out + 1] = {title = title, kind = kind, opts = opts} end
  if #trials == 0 then return out end
  if #objectives >= 2 and #objectives <= 6 then add("Front", "pareto") end
  for _, objective in ipairs(objectives) do
    add(("History of %s"):format(objective.name), "history", {measure = objective.name})
  end
  local design = type(trials.study) == "table" and trials.study.design
  local grows = type(design) == "table" and design.kind and not design.kind.points
  if grows and #objectives >= 1 and #objectives <= 3 then add("How the search came closer", "convergence") end
  local summary = says.summary(trials)
  local by_measure = summary.indices or summary.effects or summary.ranges
  for _, m in ipairs(problem.measures) do
    if by_measure and by_measure[m.name] and #by_measure[m.name] > 0 then
      add(("What matters for %s"):format(m.name), "sensitivity", {measure = m.name})
    end
  end
  local count = #problem.variables + #problem.measures
  if count >= 2 then add("Each against each", "scatter_matrix") end
  if count >= 3 and count <= 24 then add("All at once", "parallel_coordinates") end
  return out
end

local function figure_html(title, made, message)
  local svg = made
  if made then svg, message = made:svg() end
  if not svg then
    return ('<p class="hint">%s could not be drawn: %s</p>\n'):format(escape(title), escape(tostring(message)))
  end
  return ("<figure><figcaption>%s</figcaption>\n%s</figure>\n"):format(escape(title), svg)
end

-- A plot that cannot be drawn says so in its place: the rest of the page is not lost with it.
local function all_plots(trials)
  local out = {#trials > 0 and '<p class="hint">A point shows its trial where the pointer rests.</p>\n'
    or '<p class="hint">There is nothing to be drawn yet.</p>\n'}
  for _, one in ipairs(fitting(trials)) do
    local ok, made = pcall(plots.plot, trials, one.kind, one.opts)
    out[#out + 1] = figure_html(one.title, ok and made, not ok and made or nil)
  end
  return table.concat(out)
end

local function all_pictures(trials, opts)
  if opts.pictures == 0 then return "" end
  local list = pictures.of(trials, opts.picture, opts.pictures)
  if #list == 0 then return "" end
  local made = require("barwright.plot").contact_sheet {pictures = list, lines = 3}
  return '<h2 id="pictures">Pictures</h2>\n' .. figure_html("The best first", made)
end

-- ---- the page ----------------------------------------------------------------------------------

-- One sentence above all.
local function answer(trials)
  local problem = trials.problem
  local objectives, chosen = problem.objectives or {}, says.chosen(trials)
  local done = 0
  for i = 1, #trials do done = done + (trials[i].status == "done" and 1 or 0) end
  local text = ("%d trial%s, %d done."):format(#trials, #trials == 1 and "" or "s", done)
  if #objectives == 1 and chosen[1] then
    return text .. " Best: " .. says.note(problem, trials[chosen[1]]) .. "."
  elseif #objectives > 1 and #chosen > 0 then
    return text .. (" %d on the front."):format(#chosen)
  elseif #objectives > 0 and #trials > 0 then
    return text .. " None keeps the constraints."
  end
  return text
end

local function manifest_of(trials, opts)
  if opts.manifest then return opts.manifest end
  local study = trials.study
  if type(study) == "table" and type(study.manifest) == "function" then return study:manifest() end
  return {program = "barwright", version = core.version, commit = core.commit}
end

--- Writes the page. Options: title, text, picture (which file of a trial's folder), pictures (at most so
--- many, 0: none), rows (of the table), manifest.
function report.write(trials, path, given)
  local opts = options.read("report", given, rules)
  local template = beside.find "study.html"
  if not template then return nil, "the report's template was not found", {status = "io"} end
  local study = type(trials.study) == "table" and trials.study or {}
  local about = opts.text or study.what
  return core.write_file(path, html.fill(template, {
    title = escape(opts.title or study.name and "Study " .. study.name or "Study"),
    answer = escape(answer(trials)),
    about = about and ("<p>%s</p>\n"):format(escape(about)) or "",
    facts = facts(trials),
    asked = asked(trials.problem),
    found = found(trials),
    statuses = statuses(trials),
    failures = failures(trials),
    plots = all_plots(trials),
    pictures = all_pictures(trials, opts),
    trials = all_trials(trials, opts.rows),
    manifest = escape(json.encode(manifest_of(trials, opts), "  ")),
  }))
end

return report
