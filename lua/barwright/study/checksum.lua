-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Checksums of what a study's file holds: SQLite trusts the pages it reads, so a row that was changed, replaced by
-- an older one or lost is recognised by these alone.
--
-- A checksum is the first 64 bits of the SHA-256 of values in a canonical form, as a signed integer. Damage passes
-- for sound with a probability of 2^-64. Each trial has one. A set of trials has their number and the sum of their
-- checksums modulo 2^64, which does not depend on an order: a write adds the new one and takes off the old one.
-- docs/formats.md defines the form.
local core = require "barwright.core"

local checksum = {}

local function put(out, value)
  local kind = math.type(value)
  if value == nil then
    out[#out + 1] = "\0"
  elseif kind == "integer" then
    out[#out + 1] = string.pack("<Bi8", 1, value)
  elseif kind == "float" then
    out[#out + 1] = string.pack("<Bd", 2, value)
  else
    out[#out + 1] = string.pack("<Bs4", 3, value)
  end
end

local function of_bytes(parts)
  return math.tointeger(tonumber("0x" .. core.sha256_of(table.concat(parts)):sub(1, 16)))
end

-- The columns of the table `trials` that count, in the order in which they do.
checksum.COLUMNS = {"number", "key", "seed", "status", "message", "seconds", "processor_seconds", "peak_bytes",
  "attempts", "gradients", "script", "manifest"}

--- Of a trial: its row of `trials` by name, the values of its row of `points`, and of `results` where it has one
--- (false: none), by position.
function checksum.of_trial(row, point, point_count, results, result_count)
  local parts = {}
  for _, name in ipairs(checksum.COLUMNS) do put(parts, row[name]) end
  for i = 1, point_count do put(parts, point[i]) end
  parts[#parts + 1] = results and "R" or "N"
  for i = 1, results and result_count or 0 do put(parts, results[i]) end
  return of_bytes(parts)
end

--- Of a list of rows, with the names of the columns that count.
function checksum.of_rows(rows, columns)
  local parts = {}
  for _, row in ipairs(rows) do
    for _, name in ipairs(columns) do put(parts, row[name]) end
    parts[#parts + 1] = "\n"
  end
  return of_bytes(parts)
end

--- "120 00c3a5f1e2d4b697": a number of trials and the sum of their checksums.
function checksum.tally_text(count, sum)
  return ("%d %016x"):format(count, sum)
end

--- Both of such a text; nil where it is none.
function checksum.read_tally(text)
  local count, sum = tostring(text):match "^(%d+) (%x+)$"
  if not count or #sum ~= 16 or #count > 18 then return nil end
  return math.tointeger(tonumber(count)), math.tointeger(tonumber("0x" .. sum))
end

return checksum
