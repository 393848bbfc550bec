-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Reading the trials of a study's file, and telling which of them are what was written.
local checksum = require "barwright.study.checksum"
local key = require "barwright.study.key"
local variables = require "barwright.study.variables"

local intact = {}

local NAMED = 10 -- of the damaged trials, at most

--- nil, "hook.study: the file is damaged: ...", details.
function intact.damaged(path, sentence, trials)
  return nil, ("%s: the file is damaged: %s"):format(path, sentence), {status = "damaged", file = path,
    trials = trials}
end

-- ---- files without checksums -----------------------------------------------------------------------------

-- A value of a column as the study's script had it: SQL has no booleans.
local function value_of(variable, value)
  if variable.kind ~= "choice" or (value ~= "true" and value ~= "false") then return value end
  for _, choice in ipairs(variable.of) do
    if type(choice) == "boolean" and variables.choice_text(choice) == value then return choice end
  end
  return value
end

local is_status = {asked = true, done = true, failed = true, time = true, memory = true, crashed = true}

local function is(kind, value)
  return value == nil or type(value) == kind
end

-- Whether the point is the one that the key and the seed were made of.
local function is_asked(about, row, point)
  if not point or type(row.key) ~= "string" then return false end
  local names, values = {}, {}
  for k, v in ipairs(about.variables) do
    if point[k] == nil then return false end
    names[k], values[v.name] = v.name, value_of(v, point[k])
  end
  table.sort(names)
  return key.of(about.name, about.seed, names, values) == row.key and key.seed(about.seed, row.key) == row.seed
end

-- Whether a row that has no checksum can be what was written.
local function is_plausible(about, row, point, results)
  if not is_asked(about, row, point) or not is_status[row.status] or math.type(row.attempts) ~= "integer"
    or not (is("string", row.message) and is("number", row.seconds) and is("number", row.processor_seconds)
    and is("number", row.peak_bytes) and is("string", row.gradients)) then return false end
  if row.status ~= "done" then return results == nil end
  for k, m in ipairs(about.measures) do
    local value = results and results[k]
    if type(value) ~= "number" and not (results and value == nil and m.optional) then return false end
  end
  return true
end

-- ---- reading -------------------------------------------------------------------------------------------

local function in_columns(db, name, columns)
  local rows, message, details = db:rows(("SELECT * FROM %s NOT INDEXED"):format(name))
  if not rows then return nil, message, details end
  local out, count = {}, 0
  for _, row in ipairs(rows) do
    local values = {}
    for k, column in ipairs(columns) do values[k] = row[column] end
    out[row.number] = values
    count = count + 1
  end
  return out, count
end

--- {trials = {{row, point, results, sound}, ...}, alone}: each trial by its number with the values of its point
--- and results by position, and whether it is what was written; alone: rows are out of order or of no trial.
--- `about` is the study's definition; `point` and `result` are the columns; plain: there are no checksums.
function intact.read(db, about, point, result, plain)
  local rows, message, details = db:rows(("SELECT %s%s FROM trials NOT INDEXED ORDER BY number"):format(
    table.concat(checksum.COLUMNS, ", "), plain and "" or ", checksum"))
  if not rows then return nil, message, details end
  local points, point_rows, more = in_columns(db, "points", point)
  if not points then return nil, point_rows, more end
  local results, result_rows
  results, result_rows, more = in_columns(db, "results", result)
  if not results then return nil, result_rows, more end
  local out, before, with_results = {trials = {}}, math.mininteger, 0
  for i, row in ipairs(rows) do
    local own, outcome = points[row.number], results[row.number]
    local sound
    if plain then
      sound = is_plausible(about, row, own, outcome)
    else
      sound = own ~= nil and checksum.of_trial(row, own, #point, outcome, #result) == row.checksum
    end
    if outcome then with_results = with_results + 1 end
    out.trials[i] = {row = row, point = own, results = outcome, sound = sound}
    out.alone = out.alone or row.number <= before
    before = row.number
  end
  out.alone = out.alone or point_rows > #rows or result_rows > with_results
  return out
end

--- Whether at least number, key, seed and point of a trial are what was written.
function intact.is_asked(about, trial)
  return is_asked(about, trial.row, trial.point)
end

local function list_of(numbers)
  local out = {}
  for i = 1, math.min(#numbers, NAMED) do out[i] = tostring(numbers[i]) end
  if #numbers > NAMED then out[NAMED + 1] = ("and %d more"):format(#numbers - NAMED) end
  return table.concat(out, ", ")
end

--- true, or nil, a sentence and details where trials are not what was written, or not all that was.
--- tally: the text that says how many there are and the sum of their checksums; nil where there is none.
function intact.verify(path, read, tally)
  local bad = {}
  for _, trial in ipairs(read.trials) do
    if not trial.sound then bad[#bad + 1] = trial.row.number end
  end
  if #bad == 1 then
    return intact.damaged(path, ("trial %d %s"):format(bad[1], tally and "does not match its checksum"
      or "is not what was written"), bad)
  elseif #bad > 1 then
    return intact.damaged(path, ("%d of %d trials %s (%s)"):format(#bad, #read.trials, tally
      and "do not match their checksums" or "are not what was written", list_of(bad)), bad)
  end
  if read.alone then return intact.damaged(path, "rows of its tables are out of order, doubled or of no trial") end
  if not tally then return true end
  local count, sum = checksum.read_tally(tally)
  if not count then return intact.damaged(path, "the number of its trials is lost") end
  if count > #read.trials then
    return intact.damaged(path, ("%d of %d trials that were written are gone"):format(count - #read.trials, count))
  end
  for _, trial in ipairs(read.trials) do sum = sum - trial.row.checksum end
  if count < #read.trials or sum ~= 0 then
    return intact.damaged(path, "its trials are not those that were written last")
  end
  return true
end

return intact
