-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Reads the types of annotation stubs: "integer|bw.Vector", "{min: number[], cells?: integer}", "fun(x): y".
-- A type is a list of alternatives, each a table with `kind`:
--   name (class or basic type), word and number (literals), list (of), map (key, value),
--   record (fields = {{name, optional, type}}), callback, none (nil is allowed)
local types = {}

local parse_union

local function skip_blanks(text, at)
  return text:find("[^%s]", at) or #text + 1
end

-- The place behind the bracket that closes the one at `at`.
local function behind_bracket(text, at)
  local depth = 0
  for i = at, #text do
    local c = text:sub(i, i)
    if c:match "[%(%{%[<]" then depth = depth + 1 end
    if c:match "[%)%}%]>]" then
      depth = depth - 1
      if depth == 0 then return i + 1 end
    end
  end
  return #text + 1
end

local function parse_record(text, at)
  local fields = {}
  at = skip_blanks(text, at + 1)
  while text:sub(at, at) ~= "}" and at <= #text do
    local name, optional, behind = text:match("^([%w_]+)(%??)%s*:%s*()", at)
    if not name then error("no field in the record " .. text:sub(at)) end
    local kind
    kind, at = parse_union(text, behind)
    fields[#fields + 1] = {name = name, optional = optional == "?", type = kind}
    at = skip_blanks(text, at)
    if text:sub(at, at) == "," then at = skip_blanks(text, at + 1) end
  end
  return {kind = "record", fields = fields}, at + 1
end

local function parse_callback(text, at)
  at = behind_bracket(text, at + 3)
  local result = text:match("^%s*:%s*()", at)
  if result then
    local _
    _, at = parse_union(text, result)
    while text:match("^%s*,%s*[%w_.]+", at) do -- further results
      _, at = parse_union(text, text:match("^%s*,%s*()", at))
    end
  end
  return {kind = "callback"}, at
end

local function parse_one(text, at)
  local c = text:sub(at, at)
  if c == "{" then return parse_record(text, at) end
  if c == '"' then
    local word, behind = text:match('^"([^"]*)"()', at)
    return {kind = "word", word = word}, behind
  end
  if text:match("^fun%(", at) then return parse_callback(text, at) end
  if text:match("^table<", at) then
    local key, value
    key, at = parse_union(text, at + 6)
    value, at = parse_union(text, text:match("^%s*,%s*()", at))
    return {kind = "map", key = key, value = value}, at + 1
  end
  local number, behind = text:match("^(%d+)()", at)
  if number then return {kind = "number", number = math.tointeger(tonumber(number))}, behind end
  local name
  name, behind = text:match("^([%a_][%w_.]*)()", at)
  if not name then error("no type at '" .. text:sub(at) .. "' of '" .. text .. "'") end
  if name == "function" then return {kind = "callback"}, behind end
  return {kind = "name", name = name}, behind
end

-- One alternative, or those between brackets.
local function parse_some(text, at)
  local _
  local inside = text:match("^%(()", at)
  if not inside then
    local one
    one, at = parse_one(text, at)
    return {one}, at
  end
  local some
  some, at = parse_union(text, inside)
  while text:match("^, *()", at) do -- several results of a function: the first counts
    _, at = parse_union(text, text:match("^, *()", at))
  end
  return some, text:match("^%)()", at) or error("no ')' at '" .. text:sub(at) .. "' of '" .. text .. "'")
end

function parse_union(text, at)
  local union = {}
  repeat
    local some
    some, at = parse_some(text, at)
    while text:match("^%[%]", at) do
      some, at = {{kind = "list", of = some}}, at + 2
    end
    table.move(some, 1, #some, #union + 1, union)
    if text:sub(at, at) == "?" then
      union[#union + 1] = {kind = "none"}
      at = at + 1
    end
    local more = text:match("^|()", at)
    if more then at = more end
  until not more
  return union, at
end

local known = {}

--- The alternatives of a type, without what the stubs say behind it.
function types.parse(text)
  known[text] = known[text] or parse_union(text, 1)
  return known[text]
end

return types
