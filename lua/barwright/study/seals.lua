-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Checksums of the tables of a study's file that hold no trials, and the tally of those that do: rows of the table
-- `study` whose names begin with "checksum of ".
local checksum = require "barwright.study.checksum"

local seals = {}

--- Where the number of trials and the sum of their checksums stand.
seals.TALLY = "checksum of trials"

local tables = {
  study = {"name", "value"},
  variables = {"position", "name", "column_name", "kind", "unit", "min", "max", "scale", "choices"},
  measures = {"position", "name", "column_name", "unit"},
  scripts = {"number", "sha256", "path", "text", "constraints"},
  manifests = {"number", "manifest"},
}

local function is_seal(name)
  return type(name) == "string" and name:find("checksum of ", 1, true) == 1
end

-- The checksum of a table, or nil and why it cannot be read.
local function of_table(db, name)
  local columns = tables[name]
  local rows, message, details = db:rows(("SELECT %s FROM %s NOT INDEXED"):format(table.concat(columns, ", "),
    name))
  if not rows then return nil, message, details end
  local kept, first = {}, columns[1]
  for _, row in ipairs(rows) do
    if not (name == "study" and is_seal(row.name)) then kept[#kept + 1] = row end
  end
  if name == "study" then -- the others are in the order of their numbers
    table.sort(kept, function(a, b) return tostring(a[first]) < tostring(b[first]) end)
  end
  return ("%016x"):format(checksum.of_rows(kept, columns))
end

--- Writes the checksums of all tables.
function seals.write(db)
  for name in pairs(tables) do
    local sum, message, details = of_table(db, name)
    if not sum then return nil, message, details end
    local ok
    ok, message, details = db:change("INSERT OR REPLACE INTO study VALUES (?, ?)", "checksum of " .. name, sum)
    if not ok then return nil, message, details end
  end
  return true
end

--- The names of the tables that do not match their checksums.
function seals.broken(db)
  local rows, message, details = db:rows "SELECT name, value FROM study NOT INDEXED"
  if not rows then return nil, message, details end
  local expected, out = {}, {}
  for _, row in ipairs(rows) do
    if is_seal(row.name) then expected[row.name] = row.value end
  end
  for name in pairs(tables) do
    local sum
    sum, message, details = of_table(db, name)
    if not sum then return nil, message, details end
    if sum ~= expected["checksum of " .. name] then out[#out + 1] = name end
  end
  table.sort(out)
  return out
end

return seals
