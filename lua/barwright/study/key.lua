-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a trial is called: the SHA-256 of the study's name, its seed and the point, written in one way
-- only. A point is one trial exactly if its numbers are the same bits.
local core = require "barwright.core"

local key = {}

local function quote(text)
  return ("%d:%s"):format(#text, text)
end

local function word(value)
  if math.type(value) == "integer" then return "i" .. value end
  if type(value) == "number" then return "r" .. ("%.17g"):format(value):gsub(",", ".") end
  if type(value) == "boolean" then return "b" .. tostring(value) end
  return "s" .. quote(value)
end

--- Any plain value (nil, true, false, numbers, strings, tables of such) as text: the same text for
--- equal values, whatever order a table was filled in. nil and what is in the way where it is not plain.
function key.text(value, seen)
  local kind = type(value)
  if kind == "nil" then return "n" end
  if kind ~= "table" then
    if kind == "number" or kind == "string" or kind == "boolean" then return (word(value)) end
    return nil, kind
  end
  seen = seen or {}
  if seen[value] then return nil, "table that contains itself" end
  seen[value] = true
  local parts = {}
  for name, inner in pairs(value) do
    local left, why = key.text(name, seen)
    local right
    if left then right, why = key.text(inner, seen) end
    if not right then return nil, why end
    parts[#parts + 1] = left .. "=" .. right
  end
  seen[value] = nil
  table.sort(parts)
  return "{" .. table.concat(parts, ",") .. "}"
end

--- The key of a point, given the study's name, seed and the variables' names in alphabetical order.
function key.of(name, seed, names, point)
  local parts = {"barwright trial", quote(name), word(seed)}
  for _, variable in ipairs(names) do
    parts[#parts + 1] = quote(variable) .. "=" .. word(point[variable])
  end
  return core.sha256_of(table.concat(parts, "\n"))
end

--- The seed of a trial: 53 bits, so that every program that reads JSON keeps them.
function key.seed(seed, trial_key)
  return tonumber(core.sha256_of("seed " .. word(seed) .. " " .. trial_key):sub(1, 16), 16) >> 11
end

return key
