-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A new file of a study from a damaged one: the engine copies the rows that can be read, and here those go that
-- are not what was written. The next run runs again what is missing.
local checksum = require "barwright.study.checksum"
local core = require "barwright.core"
local definition = require "barwright.study.definition"
local intact = require "barwright.study.intact"
local json = require "barwright.json"
local seals = require "barwright.study.seals"
local store = require "barwright.study.store"

local salvage = {}

local meta = {__name = "salvage report"}
function meta.__tostring(self)
  local lines = {("%d rows of %d tables were saved%s"):format(self.rows, self.tables,
    self.whole and "; nothing was in the way" or "")}
  table.move(self.log, 1, #self.log, 2, lines)
  if not self.whole then lines[#lines + 1] = "trials that lost a part are run again by the next run" end
  return table.concat(lines, "\n  ")
end

local function nothing(path, why)
  return nil, ("%s: %s: nothing can be saved"):format(path, why), {status = "damaged", file = path}
end

-- ---- what the saved file is of -------------------------------------------------------------------------

-- What its table `study` says, the definition where that is sound, and the statements of the tables.
local function look(into)
  local db <close>, message, details = core.database(into)
  if not db then return nil, message, details end
  local out = {}
  out.tables, message, details = store.tables_of(db, into)
  if not out.tables then return nil, message, details end
  out.about = {}
  if out.tables.study ~= definition.tables().study then return out end
  local rows
  rows, message, details = db:rows "SELECT name, value FROM study"
  if not rows then return nil, message, details end
  for _, row in ipairs(rows) do out.about[tostring(row.name)] = row.value end
  local text = out.about.definition
  if type(text) == "string" and core.sha256_of(text) == out.about.definition_sha256 then
    out.definition = json.decode(text)
  end
  return out
end

-- Whether the tables are those of a study's file; where the definition is lost, apart from the columns of points
-- and results.
local function fitting(seen, plain)
  for name, statement in pairs(definition.tables(seen.definition, plain)) do
    local there = seen.tables[name]
    local free = not seen.definition and (name == "points" or name == "results")
      and type(there) == "string"
      and there:find(("CREATE TABLE %s (number INTEGER PRIMARY KEY"):format(name), 1, true) == 1
    if there ~= statement and not free then return false end
  end
  return true
end

-- ---- trials --------------------------------------------------------------------------------------------

local function columns_of(db, name)
  local rows, message, details = db:rows(("PRAGMA table_xinfo(%s)"):format(name))
  if not rows then return nil, message, details end
  local out = {}
  for _, row in ipairs(rows) do
    if row.cid > 0 then out[row.cid] = row.name end -- the first one is the number
  end
  return out
end

-- Statements that leave each sound trial, ask again for those whose point is sound, and take the others away.
local function cleared(seen, read, plain, columns)
  local list, bad, gone = {}, 0, 0
  for _, trial in ipairs(read.trials) do
    local number = trial.row.number
    if not trial.sound then
      bad = bad + 1
      if seen.definition and intact.is_asked(seen.definition, trial) then
        local asked = {number = number, key = trial.row.key, seed = trial.row.seed, status = "asked", attempts = 0}
        list[#list + 1] = {"UPDATE trials SET status = 'asked', message = NULL, seconds = NULL,"
          .. " processor_seconds = NULL, peak_bytes = NULL, attempts = 0, gradients = NULL, script = NULL,"
          .. " manifest = NULL WHERE number = ?", number}
        if not plain then
          list[#list + 1] = {"UPDATE trials SET checksum = ? WHERE number = ?",
            checksum.of_trial(asked, trial.point, columns), number}
        end
      else
        gone = gone + 1
        list[#list + 1] = {"DELETE FROM trials WHERE number = ?", number}
      end
    end
  end
  for _, statement in ipairs {"DELETE FROM points WHERE number NOT IN (SELECT number FROM trials)",
    "DELETE FROM results WHERE number NOT IN (SELECT number FROM trials WHERE status = 'done')"} do
    list[#list + 1] = statement
  end
  return list, bad, gone
end

-- Without the study's definition the trials of a file that has no checksums are only compared with each other.
local function is_whole(trial)
  return trial.point ~= nil and (trial.row.status ~= "done") == (trial.results == nil)
end

-- What the tables say of the study, from the definition; scripts that are what they were.
local function head(db, seen, plain, list)
  if not seen.definition then
    list[#list + 1] = "DELETE FROM study"
  else
    for _, name in ipairs {"study", "variables", "measures"} do list[#list + 1] = "DELETE FROM " .. name end
    for _, each in ipairs(definition.rows(seen.definition)) do list[#list + 1] = each end
    list[#list + 1] = {"INSERT INTO study VALUES ('format', ?)", plain and store.PLAIN or store.FORMAT}
  end
  local scripts, message, details = db:rows "SELECT number, sha256, text, constraints FROM scripts"
  if not scripts then return nil, message, details end
  for _, row in ipairs(scripts) do
    if core.sha256_of(tostring(row.text) .. "\0" .. tostring(row.constraints)) ~= row.sha256 then
      list[#list + 1] = {"DELETE FROM scripts WHERE number = ?", row.number}
    end
  end
  return true
end

local function add_note(report, text, ...)
  report.log[#report.log + 1] = text:format(...)
  report.whole = false
end

-- Leaves in the saved file what is what was written.
local function repair(into, seen, plain, report)
  local db <close>, message, details = core.database(into)
  if not db then return nil, message, details end
  local point, result, read, broken
  point, message, details = columns_of(db, "points")
  if point then result, message, details = columns_of(db, "results") end
  if result then read, message, details = intact.read(db, seen.definition, point, result, plain) end
  if not read then return nil, message, details end
  if plain and not seen.definition then
    for _, trial in ipairs(read.trials) do trial.sound = is_whole(trial) end
  end
  local list, bad, gone = cleared(seen, read, plain, #point)
  if bad > 0 then
    add_note(report, "%d trials are not what was written; of %d of them nothing is left", bad, gone)
  end
  if not plain and seen.definition then
    local count = checksum.read_tally(seen.about[seals.TALLY])
    if not count then
      add_note(report, "how many trials were written is lost")
    elseif count > #read.trials then
      add_note(report, "%d of %d trials are gone", count - #read.trials, count)
    elseif bad == 0 and not intact.verify(into, read, seen.about[seals.TALLY]) then
      add_note(report, "some trials are older than those that were written last")
    end
    broken, message, details = seals.broken(db)
    if not broken then return nil, message, details end
    if #broken > 0 then
      add_note(report, "what was said of the study is not what was written (%s)", table.concat(broken, ", "))
    end
  end
  if plain and not report.whole then
    add_note(report, "the file has no checksums: look at what its rows say")
  end
  local ok
  ok, message, details = head(db, seen, plain, list)
  if not ok then return nil, message, details end
  return store.change(db, list, not plain and seen.definition)
end

-- ---- the whole -----------------------------------------------------------------------------------------

-- The tables are taken from the file where they are sound, else from its definition.
local function copy(path, into)
  local report, message, details = core.salvage(path, into, table.concat(definition.schema(), ";\n"))
  if not report then return nil, message, details end
  local seen
  seen, message, details = look(into)
  if not seen then
    os.remove(into)
    return nil, message, details
  end
  local plain = seen.about.format == store.PLAIN
    or not seen.about.format and seen.tables.trials == definition.tables(nil, true).trials
  if not report.relisted and fitting(seen, plain) then return report, seen, plain end
  os.remove(into)
  if not seen.definition then
    return nothing(path, "the list of tables and the definition of the study are both damaged")
  end
  report, message, details = core.salvage(path, into,
    table.concat(definition.schema(seen.definition, plain), ";\n"), true)
  if not report then return nil, message, details end
  return report, seen, plain
end

--- Saves what can be read of a damaged file into a new one: {tables, rows, lost, whole, relisted, log}.
function salvage.into(path, into)
  if type(path) ~= "string" or type(into) ~= "string" then
    core.raise(("study.salvage: the paths of the damaged file and of the new one expected, got %s and %s"):format(
      core.got(path), core.got(into)))
  end
  local report, seen, plain = copy(path, into)
  if not report then return nil, seen, plain end
  local ok, message, details = repair(into, seen, plain, report)
  if not ok then
    os.remove(into)
    return nil, message, details
  end
  return setmetatable(report, meta)
end

return salvage
