-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The file of a study: one SQLite database that other programs can read.
--
--   study      format, name, seed, definition and its SHA-256, constraints: name | value
--   variables, measures   in order, with the column that each has in `points` and `results`
--   scripts    every text of the script that trials were run with
--   manifests  program, libraries and machine of every kind of run
--   trials     number, key, seed, status, message, seconds, processor_seconds, peak_bytes, attempts,
--              gradients (JSON), script, manifest
--   points     number and a column for each variable
--   results    number and a column for each measure; only of trials that are done
--   overview   a view: trials with points and results side by side
--
-- A trial is written when it is asked for ("asked"), so that its number is settled, and once more when
-- it has ended; each of these is one transaction. One process writes (run.lua holds the lock).
local core = require "barwright.core"
local json = require "barwright.json"
local variables = require "barwright.study.variables"

local store = {}
store.__index = store
store.__name = "study file"

local FORMAT = "barwright study 1"
local MOST_COLUMNS = 1900 -- SQLite's own limit is 2000

local function quote(name)
  return '"' .. name:gsub('"', '""') .. '"'
end

-- Columns named as the items are; SQL does not tell E from e, so the second becomes e_2.
local function columns_of(items)
  local columns, taken = {}, {number = true}
  for i, item in ipairs(items) do
    local name, k = item.name, 1
    while taken[name:lower()] do
      k = k + 1
      name = ("%s_%d"):format(item.name, k)
    end
    taken[name:lower()] = true
    columns[i] = name
  end
  return columns
end

-- ---- what a file remembers of its study ----------------------------------------------------------------

--- Name, seed, variables and measures as plain data: what a file and a study must agree in.
function store.definition(study)
  local out = {name = study.name, seed = study.seed, variables = json.list {}, measures = json.list {}}
  for i, v in ipairs(study.problem.variables) do
    local item = {name = v.name, kind = v.kind, unit = v.unit}
    if v.kind == "choice" then
      item.of = json.list {}
      for k, value in ipairs(v.of) do item.of[k] = value end
    else
      item.least, item.most, item.scale = v.least, v.most, v.scale
    end
    out.variables[i] = item
  end
  for i, m in ipairs(study.problem.measures) do
    out.measures[i] = {name = m.name, unit = m.unit, optional = m.optional or nil}
  end
  return out
end

local function constraints_of(study)
  local out = json.list {}
  for i, c in ipairs(study.problem.constraints) do out[i] = {name = c.name, least = c.least, most = c.most} end
  return json.encode(out)
end

local function describe(item, field)
  local value = item and item[field]
  return value == nil and "none" or type(value) == "table" and json.encode(value) or tostring(value)
end

-- The first thing in which two definitions differ, as a sentence; nil where they do not.
local function first_difference(old, new)
  if old.name ~= new.name then return ("its study is '%s', not '%s'"):format(old.name, new.name) end
  if old.seed ~= new.seed then return ("its seed is %s, not %s"):format(old.seed, new.seed) end
  for _, list in ipairs {"variables", "measures"} do
    local what = list:sub(1, -2)
    for i = 1, math.max(#old[list], #new[list]) do
      local a, b = old[list][i], new[list][i]
      if not a then return ("%s '%s' is not in it"):format(what, b.name) end
      if not b then return ("its %s '%s' is gone"):format(what, a.name) end
      for _, field in ipairs {"name", "kind", "unit", "least", "most", "scale", "of", "optional"} do
        local was, is = describe(a, field), describe(b, field)
        if was ~= is then
          if field == "name" then return ("its %s %d is '%s', not '%s'"):format(what, i, was, is) end
          return ("%s '%s': %s was %s, is %s"):format(what, a.name, field, was, is)
        end
      end
    end
  end
end

-- ---- opening -------------------------------------------------------------------------------------------

local function column_list(columns, rule)
  local out = {}
  for i, name in ipairs(columns) do out[i] = quote(name) .. (rule or "") end
  return #out > 0 and ", " .. table.concat(out, ", ") or ""
end

-- The statements that make the tables of a file with these columns. Their order is a part of the format:
-- salvage knows by it where in a file each table begins.
local function schema(self)
  local shown = {}
  for _, name in ipairs(self.point_columns) do
    shown[#shown + 1] = (", p.%s AS %s"):format(quote(name), quote(name))
  end
  for _, name in ipairs(self.result_columns) do
    shown[#shown + 1] = (", r.%s AS %s"):format(quote(name), quote(name))
  end
  return {
    "CREATE TABLE study (name TEXT PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE variables (position INTEGER PRIMARY KEY, name TEXT, column_name TEXT, kind TEXT, unit TEXT,"
      .. " least, most, scale TEXT, choices TEXT)",
    "CREATE TABLE measures (position INTEGER PRIMARY KEY, name TEXT, column_name TEXT, unit TEXT)",
    "CREATE TABLE scripts (number INTEGER PRIMARY KEY, sha256 TEXT UNIQUE, path TEXT, text TEXT,"
      .. " constraints TEXT)",
    "CREATE TABLE manifests (number INTEGER PRIMARY KEY, manifest TEXT UNIQUE)",
    "CREATE TABLE trials (number INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE, seed INTEGER NOT NULL,"
      .. " status TEXT NOT NULL, message TEXT, seconds REAL, processor_seconds REAL, peak_bytes INTEGER,"
      .. " attempts INTEGER NOT NULL DEFAULT 0, gradients TEXT, script INTEGER, manifest INTEGER)",
    ("CREATE TABLE points (number INTEGER PRIMARY KEY%s)"):format(column_list(self.point_columns)),
    ("CREATE TABLE results (number INTEGER PRIMARY KEY%s)"):format(column_list(self.result_columns)),
    ("CREATE VIEW overview AS SELECT t.number, t.key, t.seed, t.status, t.message, t.seconds, t.peak_bytes%s"
      .. " FROM trials t JOIN points p ON p.number = t.number LEFT JOIN results r ON r.number = t.number")
      :format(table.concat(shown)),
  }
end

-- Runs f in a transaction: all of it or nothing.
local function transaction(db, f)
  local fine, message, details = db:execute "BEGIN IMMEDIATE"
  if not fine then return nil, message, details end
  fine, message, details = f()
  if fine then fine, message, details = db:execute "COMMIT" end
  if not fine then
    if db.inside_transaction then db:execute "ROLLBACK" end -- a full disk has done so
    return nil, message, details
  end
  return true
end

-- Statements until one fails.
local function all(db, list)
  for _, each in ipairs(list) do
    local fine, message, details
    if type(each) == "string" then
      fine, message, details = db:execute(each)
    else
      fine, message, details = db:change(table.unpack(each, 1, each.n or #each))
    end
    if not fine then return nil, message, details end
  end
  return true
end

local function create(self, study, list)
  return transaction(self.db, function()
    local definition = json.encode(store.definition(study))
    for name, value in pairs {format = FORMAT, name = study.name, seed = tostring(study.seed),
      definition = definition, definition_sha256 = core.sha256_of(definition)} do
      list[#list + 1] = {"INSERT INTO study VALUES (?, ?)", name, value}
    end
    for i, v in ipairs(study.problem.variables) do
      list[#list + 1] = table.pack("INSERT INTO variables VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", i, v.name,
        self.point_columns[i], v.kind, v.unit, v.least, v.most, v.kind == "real" and v.scale or nil,
        v.of and json.encode(json.list(table.move(v.of, 1, #v.of, 1, {}))) or nil)
    end
    for i, m in ipairs(study.problem.measures) do
      list[#list + 1] = table.pack("INSERT INTO measures VALUES (?, ?, ?, ?)", i, m.name,
        self.result_columns[i], m.unit)
    end
    return all(self.db, list)
  end)
end

local function header(db, path)
  local tables, message, details = db:rows "SELECT count(*) AS n FROM sqlite_master"
  if not tables then return nil, message, details end
  if tables[1].n == 0 then return {} end
  local rows = db:rows "SELECT count(*) AS n FROM sqlite_master WHERE name = 'study' OR name = 'trials'"
  if not rows or rows[1].n ~= 2 then
    return nil, path .. ": is an SQLite file, but not one of a study", {status = "format", file = path}
  end
  rows, message, details = db:rows "SELECT name, value FROM study"
  if not rows then return nil, message, details end
  local about = {}
  for _, row in ipairs(rows) do about[row.name] = row.value end
  if not next(about) then return {lost = true} end -- saved from a damaged file, without its head
  if about.format ~= FORMAT then
    return nil, ("%s: written as '%s', this is '%s'"):format(path, tostring(about.format), FORMAT),
      {status = "format", file = path}
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

--- The file of a study: made where it is missing (unless read_only), else checked against the study.
--- continue: a changed script is fine.
function store.open(study, path, wish)
  wish = wish or {}
  local self = setmetatable({path = path, problem = study.problem}, store)
  if #study.problem.variables > MOST_COLUMNS or #study.problem.measures > MOST_COLUMNS then
    core.raise(("study '%s': more than %d variables or measures"):format(study.name, MOST_COLUMNS))
  end
  self.point_columns = columns_of(study.problem.variables)
  self.result_columns = columns_of(study.problem.measures)
  local db, message, details = core.database(path, {read_only = wish.read_only})
  if not db then return nil, store.explain(path, message, details) end
  self.db = db
  local about
  about, message, details = header(db, path)
  if not about then return refuse(self, message, details) end
  if about.lost and not wish.continue then
    return refuse(self, path .. ": which study it is of has been lost. If it is this one, say continue = true "
      .. "(--continue)", {status = "different", file = path})
  elseif not about.definition then
    if wish.read_only then
      return refuse(self, path .. ": holds no study yet", {status = "format", file = path})
    end
    local fine
    fine, message, details = create(self, study, about.lost
      and {"DELETE FROM variables", "DELETE FROM measures"} or schema(self))
    if not fine then return refuse(self, message, details) end
  else
    local old = json.decode(about.definition)
    local new = json.decode(json.encode(store.definition(study)))
    local difference = first_difference(old, new)
    if difference then
      return refuse(self, ("%s: was made by another study: %s. Give the changed study a file of its own "
        .. "(file = \"...\"), or change it back"):format(path, difference), {status = "different", file = path})
    end
  end
  if not wish.read_only then
    local fine
    fine, message, details = self:remember(study, wish.continue)
    if not fine then return refuse(self, message, details) end
  end
  self.insert_point = ("INSERT INTO points VALUES (?%s)"):format((", ?"):rep(#self.point_columns))
  self.insert_result = ("INSERT OR REPLACE INTO results VALUES (?%s)"):format((", ?"):rep(#self.result_columns))
  return self
end

--- The script and the manifest of this run are written down; a script that the file does not know yet is
--- refused unless `continue` is said.
function store:remember(study, continue)
  local script = study.script
  local constraints = constraints_of(study)
  local sha = core.sha256_of(script.text .. "\0" .. constraints)
  local known, message, details = self.db:rows("SELECT number, sha256 FROM scripts ORDER BY number")
  if not known then return nil, message, details end
  for _, row in ipairs(known) do
    if row.sha256 == sha then self.script = row.number end
  end
  if not self.script and #known > 0 and not continue then
    return nil, ("%s: the script%s has changed since its trials were run. If the results that are there still "
      .. "hold, say continue = true (--continue); else give it a new file (file = \"...\", --file)")
      :format(self.path, script.path and " " .. script.path or ""), {status = "different", file = self.path}
  end
  local manifest = json.encode(study:manifest())
  return transaction(self.db, function()
    if not self.script then
      local fine, why, more = self.db:change("INSERT INTO scripts VALUES (?, ?, ?, ?, ?)", #known + 1, sha,
        script.path, script.text, constraints)
      if not fine then return nil, why, more end
      self.script = #known + 1
    end
    local fine, why, more = self.db:change("INSERT OR IGNORE INTO manifests (manifest) VALUES (?)", manifest)
    if not fine then return nil, why, more end
    local rows
    rows, why, more = self.db:rows("SELECT number FROM manifests WHERE manifest = ?", manifest)
    if not rows then return nil, why, more end
    self.manifest = rows[1].number
    return true
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

-- Statements that write a trial as asked for.
local function put_asked(self, trial)
  local fine, message, details = self.db:change(
    "INSERT INTO trials (number, key, seed, status) VALUES (?, ?, ?, 'asked')", trial.number, trial.key,
    trial.seed)
  if not fine then return nil, message, details end
  local values = {}
  for k, v in ipairs(self.problem.variables) do values[k] = to_column(v, trial.point[v.name]) end
  return self.db:change(self.insert_point, trial.number, table.unpack(values, 1, #self.problem.variables))
end

--- Writes that trials were asked for, all or none.
function store:ask(trials)
  return transaction(self.db, function()
    for _, trial in ipairs(trials) do
      local fine, message, details = put_asked(self, trial)
      if not fine then return nil, message, details end
    end
    return true
  end)
end

local function put_outcome(self, trial, script, manifest)
  local fine, message, details = self.db:change("UPDATE trials SET status = ?, message = ?, seconds = ?,"
    .. " processor_seconds = ?, peak_bytes = ?, attempts = ?, gradients = ?, script = ?, manifest = ?"
    .. " WHERE number = ?", trial.status, trial.message, trial.seconds, trial.processor_seconds,
    trial.peak_bytes and math.tointeger(trial.peak_bytes) or nil, trial.attempts,
    trial.gradients and json.encode(trial.gradients) or nil, script, manifest, trial.number)
  if fine and trial.status == "done" then
    local values = {}
    for k, m in ipairs(self.problem.measures) do values[k] = trial.results[m.name] end
    fine, message, details = self.db:change(self.insert_result, trial.number,
      table.unpack(values, 1, #self.problem.measures))
  end
  return fine, message, details
end

--- Writes how a trial ended, in one transaction.
function store:finish(trial)
  return transaction(self.db, function() return put_outcome(self, trial, self.script, self.manifest) end)
end

--- Writes finished trials of another file.
function store:take(trials)
  return transaction(self.db, function()
    for _, trial in ipairs(trials) do
      local fine, message, details = put_asked(self, trial)
      if fine and trial.status ~= "asked" then
        fine, message, details = put_outcome(self, trial, self.script, self.manifest)
      end
      if not fine then return nil, message, details end
    end
    return true
  end)
end

--- All trials by number, those that were only asked for among them.
function store:load()
  local list, message, details = self.db:rows("SELECT number, key, seed, status, message, seconds,"
    .. " processor_seconds, peak_bytes, attempts, gradients FROM trials ORDER BY number")
  if not list then return nil, store.explain(self.path, message, details) end
  local by_number = {}
  for _, trial in ipairs(list) do
    by_number[trial.number] = trial
    if trial.gradients then trial.gradients = json.decode(trial.gradients) end
  end
  local points
  points, message, details = self.db:rows "SELECT * FROM points"
  if not points then return nil, store.explain(self.path, message, details) end
  for _, row in ipairs(points) do
    local trial, point = by_number[row.number], {}
    for k, v in ipairs(self.problem.variables) do point[v.name] = from_column(v, row[self.point_columns[k]]) end
    if trial then trial.point = point end
  end
  local results
  results, message, details = self.db:rows "SELECT * FROM results"
  if not results then return nil, store.explain(self.path, message, details) end
  for _, row in ipairs(results) do
    local trial, values = by_number[row.number], {}
    for k, m in ipairs(self.problem.measures) do values[m.name] = row[self.result_columns[k]] end
    if trial and trial.status == "done" then trial.results = values end
  end
  return list
end

--- The statements that make a file of a study with this definition, in their order; without a definition
--- the tables `points` and `results` have no columns but the number.
function store.schema(definition)
  return table.concat(schema {point_columns = columns_of(definition and definition.variables or {}),
    result_columns = columns_of(definition and definition.measures or {})}, ";\n")
end

--- The definition that a file remembers, or nil where it was lost or changed.
function store.remembered(path)
  local db <close>, message, details = core.database(path)
  if not db then return nil, message, details end
  local about = {}
  for _, row in ipairs(db:rows "SELECT name, value FROM study" or {}) do about[row.name] = row.value end
  local text = about.definition
  if text and core.sha256_of(text) == about.definition_sha256 then return json.decode(text) end
  return nil, path .. ": the definition of its study is lost", {status = "damaged", file = path}
end

--- After a file was saved from a damaged one: what lost a part of itself is to be run again.
function store.mend(path)
  local db <close>, message, details = core.database(path)
  if not db then return nil, message, details end
  local tables = db:rows("SELECT count(*) AS n FROM sqlite_master"
    .. " WHERE name = 'trials' OR name = 'points' OR name = 'results'")
  if not tables or tables[1].n < 3 then return true end
  return transaction(db, function()
    return all(db, {
      "DELETE FROM trials WHERE number NOT IN (SELECT number FROM points)",
      "DELETE FROM points WHERE number NOT IN (SELECT number FROM trials)",
      "UPDATE trials SET status = 'asked' WHERE status = 'done' AND number NOT IN (SELECT number FROM results)",
      "DELETE FROM results WHERE number NOT IN (SELECT number FROM trials WHERE status = 'done')",
    })
  end)
end

--- One file is left, without those beside it that writing ahead makes, so that it can be copied.
function store:close()
  if self.db and self.script then self.db:execute "PRAGMA journal_mode = DELETE" end
  if self.db then self.db:close() end
  self.db = nil
end
store.__close = store.close

return store
