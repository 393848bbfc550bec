-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The file of a study: one SQLite database that other programs can read.
--
--   study      format, name, seed, definition and its SHA-256, checksums: name | value
--   variables, measures   in order, with the column that each has in `points` and `results`
--   scripts    every text of the script that trials were run with
--   manifests  program, libraries and machine of every kind of run
--   trials     number, key, seed, status, message, seconds, processor_seconds, peak_bytes, attempts,
--              gradients (JSON), script, manifest, checksum
--   points     number and a column for each variable
--   results    number and a column for each measure; only of trials that are done
--   overview   a view: trials with points and results side by side
--
-- A trial is written when it is asked for ("asked"), so that its number is settled, and once more when
-- it has ended; each of these is one transaction. One process writes (run.lua holds the lock).
--
-- Invariant: after each transaction the checksum of every trial is that of its three rows, the tally in `study` is
-- the number of trials and the sum of their checksums, and `study` has a checksum of each other table (seals.lua).
-- Who opens the file verifies the seals; who reads the trials verifies these all, in one snapshot (intact.lua).
local checksum = require "barwright.study.checksum"
local core = require "barwright.core"
local definition = require "barwright.study.definition"
local intact = require "barwright.study.intact"
local json = require "barwright.json"
local seals = require "barwright.study.seals"
local variables = require "barwright.study.variables"

local store = {}
store.__index = store
store.__name = "study file"

local FORMAT = "barwright study 2"
local PLAIN = "barwright study 1" -- without checksums: read and gone on with as it is
store.FORMAT, store.PLAIN = FORMAT, PLAIN
local TALLY = seals.TALLY
local MAX_COLUMNS = 1900 -- SQLite's own limit is 2000

-- ---- transactions --------------------------------------------------------------------------------------

-- Runs f in a transaction: all of it or nothing.
local function transaction(db, f)
  local ok, message, details = db:execute "BEGIN IMMEDIATE"
  if not ok then return nil, message, details end
  ok, message, details = f()
  if ok then ok, message, details = db:execute "COMMIT" end
  if not ok then
    if db.inside_transaction then db:execute "ROLLBACK" end -- a full disk has done so
    return nil, message, details
  end
  return true
end

-- Statements until one fails.
local function all(db, list)
  for _, each in ipairs(list) do
    local ok, message, details
    if type(each) == "string" then
      ok, message, details = db:execute(each)
    else
      ok, message, details = db:change(table.unpack(each, 1, each.n or #each))
    end
    if not ok then return nil, message, details end
  end
  return true
end

-- The tally, from the checksums that the trials have, and the seals.
local function seal(db)
  local rows, message, details = db:rows "SELECT checksum FROM trials"
  if not rows then return nil, message, details end
  local sum = 0
  for _, row in ipairs(rows) do sum = sum + row.checksum end
  local ok
  ok, message, details = db:change("INSERT OR REPLACE INTO study VALUES (?, ?)", TALLY,
    checksum.tally_text(#rows, sum))
  if not ok then return nil, message, details end
  return seals.write(db)
end

--- Statements in one transaction, at whose end the file is sealed if it is to be.
function store.change(db, list, sealed)
  return transaction(db, function()
    local ok, message, details = all(db, list)
    if ok and sealed then return seal(db) end
    return ok, message, details
  end)
end

-- A transaction that changes trials: f adds to self.count and self.sum what it adds to the trials.
local function counted(self, f)
  self.count, self.sum = 0, 0
  if self.plain then return transaction(self.db, f) end
  return transaction(self.db, function()
    local rows, message, details = self.db:rows("SELECT value FROM study WHERE name = ?", TALLY)
    if not rows then return nil, message, details end
    self.count, self.sum = checksum.read_tally(rows[1] and rows[1].value)
    if not self.count then return intact.damaged(self.path, "the number of its trials is lost") end
    local ok
    ok, message, details = f()
    if not ok then return nil, message, details end
    return self.db:change("UPDATE study SET value = ? WHERE name = ?",
      checksum.tally_text(self.count, self.sum), TALLY)
  end)
end

-- ---- opening -------------------------------------------------------------------------------------------

-- ---- opening -------------------------------------------------------------------------------------------

-- The statements of its tables by name; {} for a new file.
local function tables_of(db, path)
  local rows, message, details = db:rows "SELECT name, sql FROM sqlite_master WHERE type = 'table'"
  if not rows then return nil, message, details end
  local out = {}
  for _, row in ipairs(rows) do out[tostring(row.name)] = row.sql end
  if next(out) and not (out.study and out.trials) then
    return nil, path .. ": is an SQLite file, but not one of a study", {status = "format", file = path}
  end
  return out
end
store.tables_of = tables_of

-- Whether the tables are those of a definition.
local function same_tables(tables, about, plain)
  for name, statement in pairs(definition.tables(about, plain)) do
    if tables[name] ~= statement then return false, name end
  end
  return true
end

-- What the table `study` says, and whether the file is one without checksums.
local function header(self, tables)
  local db, path = self.db, self.path
  local expected = definition.tables()
  for _, name in ipairs {"study", "variables", "measures", "scripts", "manifests"} do
    if tables[name] ~= expected[name] then
      return intact.damaged(path, ("its table '%s' is not what it was"):format(name))
    end
  end
  self.plain = tables.trials ~= expected.trials
  local rows, message, details = db:rows "SELECT name, value FROM study NOT INDEXED"
  if not rows then return nil, message, details end
  if #rows == 0 then return {lost = true} end -- saved from a damaged file, without its head
  local about = {}
  for _, row in ipairs(rows) do about[tostring(row.name)] = row.value end
  if about.format ~= FORMAT and about.format ~= PLAIN then
    return nil, ("%s: the format '%s' expected, got '%s'"):format(path, FORMAT, tostring(about.format)),
      {status = "format", file = path}
  end
  if self.plain ~= (about.format == PLAIN) then return intact.damaged(path, "its format is lost") end
  local broken = {}
  if not self.plain then
    broken, message, details = seals.broken(db)
    if not broken then return nil, message, details end
  end
  if #broken > 0 then
    return intact.damaged(path, ("what it says of its study does not match its checksum (%s)"):format(
      table.concat(broken, ", ")))
  end
  if core.sha256_of(tostring(about.definition)) ~= about.definition_sha256 then
    return intact.damaged(path, "the definition of its study does not match its checksum")
  end
  return about
end

--- Explains a failure of the database in the words of a study.
function store.explain(path, message, details)
  local status = details and (details.reason or details.status)
  if details then details.status = status end
  if status == "full" then
    message = ("%s: the disk is full; what was finished before is kept. Make room, then run the study again: "
      .. "it goes on where it was"):format(path)
  elseif status == "damaged" then
    message = ("%s; 'barwright study salvage %s NEW.study' saves what can be read"):format(message, path)
  end
  return message, details
end

local function refuse(self, message, details)
  self.db:close()
  return nil, store.explain(self.path, message, details)
end

-- Reads in one state of the file, whatever is written meanwhile.
local function in_one_state(db, f)
  if db.inside_transaction then return f() end
  local ok, message, details = db:execute "BEGIN"
  if not ok then return nil, message, details end
  local out
  out, message, details = f()
  if db.inside_transaction then db:execute "COMMIT" end
  return out, message, details
end

-- Of a file whose head was lost, what is known again; of a new one, all.
local function begin(self, new)
  local list = new and definition.schema(self.about) or {"DELETE FROM variables", "DELETE FROM measures"}
  for _, each in ipairs(definition.rows(self.about)) do list[#list + 1] = each end
  list[#list + 1] = {"INSERT INTO study VALUES ('format', ?)", self.plain and PLAIN or FORMAT}
  return store.change(self.db, list, not self.plain)
end


-- Compares the file with the study, or begins it; true, or what is in the way.
local function compare(self, opts)
  local tables
  local about, message, details = in_one_state(self.db, function()
    local why, more
    tables, why, more = tables_of(self.db, self.path)
    if not tables then return nil, why, more end
    if not next(tables) then return {} end
    return header(self, tables)
  end)
  if not about then return nil, message, details end
  if not next(tables) then
    if not opts.read_only then return begin(self, true) end
    return nil, self.path .. ": holds no study yet", {status = "format", file = self.path}
  end
  if about.lost then
    if not opts.continue then
      return nil, self.path .. ": the definition of its study is lost. If it is this study, give continue = true "
        .. "(--continue)", {status = "different", file = self.path}
    end
    local same, name = same_tables(tables, self.about, self.plain)
    if not same then
      return nil, ("%s: was made by another study: its table '%s' has other columns"):format(self.path, name),
        {status = "different", file = self.path}
    end
    return begin(self)
  end
  local difference = definition.first_difference(json.decode(about.definition),
    json.decode(json.encode(self.about)))
  if difference then
    return nil, ("%s: was made by another study: %s. Give the changed study a file of its own "
      .. "(file = \"...\"), or change it back"):format(self.path, difference),
      {status = "different", file = self.path}
  end
  local same, name = same_tables(tables, self.about, self.plain)
  if not same then return intact.damaged(self.path, ("its table '%s' is not what it was"):format(name)) end
  return true
end

-- Before anything is written: where SQLite's own lists are damaged, writing would destroy what is sound.
local function ready_to_write(self, study, opts)
  local sound, problems = self.db:check()
  if not sound then return intact.damaged(self.path, problems:match "[^\n]*") end
  return self:remember(study, opts.continue)
end

--- The file of a study: made where it is missing (unless read_only), else checked against the study.
--- continue: a changed script is fine.
function store.open(study, path, opts)
  opts = opts or {}
  if #study.problem.variables > MAX_COLUMNS or #study.problem.measures > MAX_COLUMNS then
    core.raise(("study '%s': at most %d variables and as many measures expected, got %d and %d"):format(study.name,
      MAX_COLUMNS, #study.problem.variables, #study.problem.measures))
  end
  local about = definition.of(study)
  local self = setmetatable({path = path, problem = study.problem, about = about}, store)
  self.point_columns = definition.columns_of(about.variables)
  self.result_columns = definition.columns_of(about.measures)
  local db, message, details = core.database(path, {read_only = opts.read_only})
  if not db then return nil, store.explain(path, message, details) end
  self.db = db
  local ok
  ok, message, details = compare(self, opts)
  if not ok then return refuse(self, message, details) end
  if not opts.read_only then
    ok, message, details = ready_to_write(self, study, opts)
    if not ok then return refuse(self, message, details) end
  end
  if self.plain then
    core.warn(("%s: an older version made it without checksums, so that damage may pass unseen; 'barwright "
      .. "study merge SCRIPT %s --file NEW.study' makes a file with them"):format(path, path))
  end
  self.insert_point = ("INSERT INTO points VALUES (?%s)"):format((", ?"):rep(#self.point_columns))
  self.insert_result = ("INSERT OR REPLACE INTO results VALUES (?%s)"):format((", ?"):rep(#self.result_columns))
  return self
end

--- The script and the manifest of this run are written down; a script that the file does not know yet is
--- refused without `continue`.
function store:remember(study, continue)
  local script = study.script
  local constraints = definition.constraints_of(study)
  local sha = core.sha256_of(script.text .. "\0" .. constraints)
  local known, message, details = self.db:rows("SELECT number, sha256 FROM scripts ORDER BY number")
  if not known then return nil, message, details end
  local last = 0
  for _, row in ipairs(known) do
    if row.sha256 == sha then self.script = row.number end
    last = row.number
  end
  if not self.script and #known > 0 and not continue then
    return nil, ("%s: the script%s has changed since its trials were run. If the results that are there still "
      .. "hold, give continue = true (--continue); else give it a new file (file = \"...\", --file)")
      :format(self.path, script.path and " " .. script.path or ""), {status = "different", file = self.path}
  end
  local manifest = json.encode(study:manifest())
  return transaction(self.db, function()
    if not self.script then
      local ok, why, more = self.db:change("INSERT INTO scripts VALUES (?, ?, ?, ?, ?)", last + 1, sha,
        script.path, script.text, constraints)
      if not ok then return nil, why, more end
      self.script = last + 1
    end
    local ok, why, more = self.db:change("INSERT OR IGNORE INTO manifests (manifest) VALUES (?)", manifest)
    if not ok then return nil, why, more end
    local rows
    rows, why, more = self.db:rows("SELECT number FROM manifests WHERE manifest = ?", manifest)
    if not rows then return nil, why, more end
    self.manifest = rows[1].number
    if self.plain then return true end
    return seals.write(self.db)
  end)
end

-- ---- trials --------------------------------------------------------------------------------------------

local function to_column(variable, value)
  return variable.kind == "choice" and type(value) == "boolean" and tostring(value) or value
end

local function from_column(variable, value)
  if variable.kind ~= "choice" then return value end
  return variable.of[variable.index[variables.choice_text(value)]]
end

local function point_of(self, trial)
  local values = {}
  for k, v in ipairs(self.problem.variables) do values[k] = to_column(v, trial.point[v.name]) end
  return values
end

local function checksum_of(self, row, point, results)
  return checksum.of_trial(row, point, #self.point_columns, results, #self.result_columns)
end

local function put_checksum(self, trial, sum)
  if self.plain then return true end
  return self.db:change("UPDATE trials SET checksum = ? WHERE number = ?", sum, trial.number)
end

-- Statements that write a trial as asked for.
local function put_asked(self, trial)
  local point = point_of(self, trial)
  local sum = checksum_of(self, {number = trial.number, key = trial.key, seed = trial.seed, status = "asked",
    attempts = 0}, point)
  local ok, message, details = self.db:change(
    "INSERT INTO trials (number, key, seed, status) VALUES (?, ?, ?, 'asked')", trial.number, trial.key,
    trial.seed)
  if ok then ok, message, details = put_checksum(self, trial, sum) end
  if not ok then return nil, message, details end
  self.count, self.sum = self.count + 1, self.sum + sum
  return self.db:change(self.insert_point, trial.number, table.unpack(point, 1, #self.point_columns))
end

--- Writes that trials were asked for, all or none.
function store:ask(trials)
  return counted(self, function()
    for _, trial in ipairs(trials) do
      local ok, message, details = put_asked(self, trial)
      if not ok then return nil, message, details end
    end
    return true
  end)
end

local function real(value)
  return value and value + 0.0
end

-- The checksum of a trial as it stands.
local function checksum_there(self, trial)
  if self.plain then return 0 end
  local rows, message, details = self.db:rows("SELECT checksum FROM trials WHERE number = ?", trial.number)
  if not rows then return nil, message, details end
  if not rows[1] then return intact.damaged(self.path, ("trial %d is gone"):format(trial.number)) end
  return rows[1].checksum
end

-- The row of a trial that has ended, as the columns' types make it.
local function row_of(self, trial)
  return {number = trial.number, key = trial.key, seed = trial.seed, status = trial.status,
    message = trial.message, seconds = real(trial.seconds), processor_seconds = real(trial.processor_seconds),
    peak_bytes = trial.peak_bytes and math.tointeger(trial.peak_bytes) or nil, attempts = trial.attempts,
    gradients = trial.gradients and json.encode(trial.gradients) or nil, script = self.script,
    manifest = self.manifest}
end

local function put_outcome(self, trial)
  local before, message, details = checksum_there(self, trial)
  if not before then return nil, message, details end
  local results
  if trial.status == "done" then
    results = {}
    for k, m in ipairs(self.problem.measures) do results[k] = trial.results[m.name] end
  end
  local row = row_of(self, trial)
  local sum = checksum_of(self, row, point_of(self, trial), results)
  local ok
  ok, message, details = self.db:change("UPDATE trials SET status = ?, message = ?, seconds = ?,"
    .. " processor_seconds = ?, peak_bytes = ?, attempts = ?, gradients = ?, script = ?, manifest = ?"
    .. " WHERE number = ?", row.status, row.message, row.seconds, row.processor_seconds, row.peak_bytes,
    row.attempts, row.gradients, row.script, row.manifest, row.number)
  if ok then ok, message, details = put_checksum(self, trial, sum) end
  self.sum = self.sum - before + sum
  if ok and results then
    ok, message, details = self.db:change(self.insert_result, trial.number,
      table.unpack(results, 1, #self.result_columns))
  end
  return ok, message, details
end

--- Writes how a trial ended, in one transaction.
function store:finish(trial)
  return counted(self, function() return put_outcome(self, trial) end)
end

--- Writes finished trials of another file.
function store:take(trials)
  return counted(self, function()
    for _, trial in ipairs(trials) do
      local ok, message, details = put_asked(self, trial)
      if ok and trial.status ~= "asked" then ok, message, details = put_outcome(self, trial) end
      if not ok then return nil, message, details end
    end
    return true
  end)
end

-- A trial as it was read, for others.
local function present(self, trial)
  local out, point = trial.row, {}
  for k, v in ipairs(self.problem.variables) do point[v.name] = from_column(v, trial.point[k]) end
  out.point = point
  if trial.results then
    out.results = {}
    for k, m in ipairs(self.problem.measures) do out.results[m.name] = trial.results[k] end
  end
  if out.gradients then out.gradients = json.decode(out.gradients) end
  out.script, out.manifest, out.checksum = nil, nil, nil
  return out
end

--- All trials by number, those that were only asked for among them; nil, a sentence and details where one of them
--- is not what was written.
function store:load()
  local list, message, details = in_one_state(self.db, function()
    local read, why, more = intact.read(self.db, self.about, self.point_columns, self.result_columns, self.plain)
    if not read then return nil, why, more end
    local tally
    if not self.plain then
      tally, why, more = self.db:rows("SELECT value FROM study WHERE name = ?", TALLY)
      if not tally then return nil, why, more end
      tally = tally[1] and tally[1].value or ""
    end
    local ok
    ok, why, more = intact.verify(self.path, read, tally)
    return ok and read.trials, why, more
  end)
  if not list then return nil, store.explain(self.path, message, details) end
  for i, trial in ipairs(list) do list[i] = present(self, trial) end
  return list
end

--- One file is left, without those beside it that writing ahead makes, so that it can be copied.
function store:close()
  if self.db and self.script then self.db:execute "PRAGMA journal_mode = DELETE" end
  if self.db then self.db:close() end
  self.db = nil
end
store.__close = store.close

return store
