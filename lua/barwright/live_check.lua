-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Messages of the live views' pages, checked: a JSON object with a known type and exactly the fields of
-- that type, each of its kind and within its range. Anything else is a sentence of what is wrong.
local json = require "barwright.json"

local live_check = {}

function live_check.is_object(value)
  return type(value) == "table" and value ~= json.null
end

-- What a page sent, to be shown in a message: no more than a line, and plain.
function live_check.shown(value)
  return (tostring(value):sub(1, 40):gsub("[^\32-\126]", "?"))
end

-- Each check returns the value to use, or nil and what is expected.

function live_check.number_between(min, max)
  return function(value)
    if type(value) == "number" and value >= min and value <= max then return value end -- NaN fails
    return nil, ("a number from %g to %g"):format(min, max)
  end
end

function live_check.whole(value)
  if math.type(value) == "integer" and value >= 0 and value <= 2 ^ 53 then return value end
  return nil, "a whole number"
end

function live_check.flag(value)
  if type(value) == "boolean" then return value end
  return nil, "true or false"
end

function live_check.one_of(...)
  local known, words = {...}, {}
  for i, word in ipairs(known) do words[i] = tostring(word) end
  local expected = table.concat(words, " or ")
  return function(value)
    for _, word in ipairs(known) do
      if word == value then return value end
    end
    return nil, expected
  end
end

function live_check.or_null(check)
  return function(value)
    if value == json.null then return false end
    return check(value)
  end
end

-- ---- objects ---------------------------------------------------------------------------------------

-- fields: name -> {check, needed}
function live_check.read_object(where, value, fields, controller)
  if not live_check.is_object(value) then return nil, where .. ": an object expected" end
  local out = {}
  for key in pairs(value) do
    if not fields[key] then return nil, ("%s: unknown field '%s'"):format(where, live_check.shown(key)) end
  end
  for key, field in pairs(fields) do
    local given = value[key]
    if given ~= nil then
      local read, expected = field[1](given, controller)
      if read == nil then return nil, ("%s: '%s': %s expected"):format(where, key, expected) end
      out[key] = read
    elseif field[2] then
      return nil, ("%s: '%s' is missing"):format(where, key)
    end
  end
  return out
end

--- The message of a text, or nil and why it is none. types: name -> fields
function live_check.read(text, types, controller)
  local value, why = json.decode(text)
  if value == nil then return nil, "not JSON: " .. why end
  if not live_check.is_object(value) then return nil, "a JSON object with a 'type' expected" end
  local kind = value.type
  local fields = type(kind) == "string" and types[kind]
  if not fields then
    return nil, ("unknown type of message '%s'"):format(live_check.shown(kind))
  end
  value.type = nil
  local message
  message, why = live_check.read_object(kind, value, fields, controller)
  if not message then return nil, why end
  message.type = kind
  return message
end

--- Whether a text is a message of a type that has few fields ("stop", "end").
function live_check.is(text, kind)
  if #text > 100 then return false end
  local value = json.decode(text)
  return live_check.is_object(value) and value.type == kind
end

return live_check
