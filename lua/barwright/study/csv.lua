-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Trials as a table for other programs: RFC 4180 (lines end with CR LF, quotes where they must be), units
-- in the head, numbers with as many digits as read back the same.
local core = require "barwright.core"
local variables = require "barwright.study.variables"

local csv = {}

local function field(value)
  if value == nil then return "" end
  local text
  if math.type(value) == "float" then
    for digits = 15, 17 do
      text = ("%%.%dg"):format(digits):format(value):gsub(",", ".")
      if tonumber(text) == value then break end
    end
  else
    text = tostring(value)
  end
  if text:find '[",\r\n]' or text:find "^%s" or text:find "%s$" then
    return '"' .. text:gsub('"', '""') .. '"'
  end
  return text
end

local own = {{"number"}, {"key"}, {"seed"}, {"status"}, {"message"}, {"seconds", "s"},
  {"processor_seconds", "s"}, {"peak_bytes", "B"}}

-- Columns that follow from the objectives and constraints: whether a trial keeps the constraints, and whether it
-- is the best or one of the front.
local function judged(trials, problem)
  local columns, on_front = {}, {}
  if #problem.objectives > 0 then
    for _, trial in ipairs(trials:front()) do on_front[trial.number] = true end
  end
  if #problem.constraints > 0 then
    columns[1] = {"feasible", function(trial)
      return trial.status == "done" and problem:violation(trial.results) == 0
    end}
  end
  if #problem.objectives > 0 then
    columns[#columns + 1] = {"front", function(trial) return on_front[trial.number] or false end}
  end
  return columns
end

--- The text of the table.
function csv.text(trials, problem)
  local lines, head, last = {}, {}, judged(trials, problem)
  for _, column in ipairs(own) do head[#head + 1] = field(variables.title {name = column[1], unit = column[2]}) end
  for _, v in ipairs(problem.variables) do head[#head + 1] = field(variables.title(v)) end
  for _, m in ipairs(problem.measures) do head[#head + 1] = field(variables.title(m)) end
  for _, column in ipairs(last) do head[#head + 1] = column[1] end
  lines[1] = table.concat(head, ",")
  for _, trial in ipairs(trials) do
    local row = {}
    for _, column in ipairs(own) do
      local value = trial[column[1]]
      if column[1] == "peak_bytes" and value then value = math.tointeger(value) or value end
      row[#row + 1] = field(value)
    end
    for _, v in ipairs(problem.variables) do row[#row + 1] = field(trial.point[v.name]) end
    for _, m in ipairs(problem.measures) do row[#row + 1] = field(trial.results and trial.results[m.name]) end
    for _, column in ipairs(last) do row[#row + 1] = field(column[2](trial)) end
    lines[#lines + 1] = table.concat(row, ",")
  end
  lines[#lines + 1] = ""
  return table.concat(lines, "\r\n")
end

--- Writes the table; true, or nil and a message.
function csv.write(path, trials, problem)
  return core.write_file(path, csv.text(trials, problem))
end

return csv
