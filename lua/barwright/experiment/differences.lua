-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Two results of one experiment beside each other: every number, text and truth value with the path where
-- it is. What depends on the clock and on the machine is kept apart: seconds, memory, and what is computed
-- from these.
local json = require "barwright.json"

local differences = {}

-- Names of what the clock and the machine decide; everything inside of such a name is of that kind, too.
local patterns = {"^seconds", "_seconds$", "_seconds_", "^ms$", "_ms$", "^ms_", "memory", "^peak_bytes$",
  "_per_second", "^speed_up", "^quadrature_fraction$", "^times_faster$", "ratio_of_seconds", "_timed$",
  "^minutes", "_minutes$"}

--- Whether a value of this name says how long or how much memory, not what came out.
function differences.is_timing(name)
  for _, pattern in ipairs(patterns) do
    if name:find(pattern) then return true end
  end
  return false
end

local function joined(path, key)
  if math.type(key) == "integer" then return ("%s[%d]"):format(path, key) end
  return path == "" and key or path .. "." .. key
end

local function relative(a, b)
  if a == b then return 0 end
  return math.abs(b - a) / math.max(math.abs(a), math.abs(b))
end

local function keys_of(a, b)
  local keys = {}
  for key in pairs(a) do keys[#keys + 1] = key end
  for key in pairs(b) do
    if a[key] == nil then keys[#keys + 1] = key end
  end
  table.sort(keys, function(x, y)
    if math.type(x) == math.type(y) then return x < y end
    return tostring(x) < tostring(y)
  end)
  return keys
end

local function is_table(value)
  return type(value) == "table" and value ~= json.null
end

--- {count of values compared, differences = {{path, before, after, relative}}, timings = likewise}.
--- options: tolerance (relative, of numbers), same = function(text before, text after): texts that count as
--- the same although they differ.
function differences.of(before, after, options)
  local found = {count = 0, differences = {}, timings = {}}
  local function walk(a, b, path, timing)
    if is_table(a) and is_table(b) then
      for _, key in ipairs(keys_of(a, b)) do
        walk(a[key], b[key], joined(path, key), timing or type(key) == "string" and differences.is_timing(key))
      end
      return
    end
    found.count = found.count + 1
    if a == b then return end
    local entry = {path = path, before = a, after = b}
    if type(a) == "number" and type(b) == "number" then
      entry.relative = relative(a, b)
      if not timing and entry.relative <= (options.tolerance or 0) then return end
    elseif type(a) == "string" and type(b) == "string" and options.same and options.same(a, b) then
      return
    end
    table.insert(timing and found.timings or found.differences, entry)
  end
  walk(before, after, "", false)
  return found
end

--- A value in a line of text.
function differences.show(value)
  if value == nil then return "nothing" end
  if value == json.null then return "null" end
  if type(value) == "number" then return json.encode(value) end
  if is_table(value) then return "a table" end
  local text = tostring(value):gsub("%s+", " ")
  return #text > 60 and text:sub(1, 57) .. "..." or text
end

return differences
