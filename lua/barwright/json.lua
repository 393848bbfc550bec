-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- JSON, written the same way every time: keys sorted, numbers with the fewest digits that read back
-- as the same number, NaN and infinities as null. Reading keeps integers and gives null as
-- json.null.
local core = require "barwright.core"

local raise = core.raise
local json = {}

--- Stands for null in tables that are read or written.
json.null = setmetatable({}, {__tostring = function() return "null" end, __name = "json.null"})

local escapes = {['"'] = '\\"', ["\\"] = "\\\\", ["\b"] = "\\b", ["\f"] = "\\f", ["\n"] = "\\n",
  ["\r"] = "\\r", ["\t"] = "\\t"}

local function quote(text)
  return '"' .. text:gsub('[%z\1-\31"\\\127]', function(c)
    return escapes[c] or ("\\u%04x"):format(c:byte())
  end) .. '"'
end

local function number(value)
  if math.type(value) == "integer" then return tostring(value) end
  if value ~= value or value == math.huge or value == -math.huge then return "null" end
  for digits = 15, 17 do
    local text = ("%%.%dg"):format(digits):format(value)
    if tonumber(text) == value then
      return (text:gsub(",", ".")) -- some locales write a comma
    end
  end
end

-- A table is a list when its keys are 1..n (empty: an object, unless marked by json.list).
local list_mark = {}

--- Marks a table as a list, so that an empty one is written as [].
function json.list(table)
  if table ~= nil and type(table) ~= "table" then
    raise(("json.list: a table expected, got %s"):format(core.got(table)))
  end
  local ok, list = pcall(setmetatable, table or {}, list_mark)
  if not ok then raise "json.list: a table whose metatable is not protected expected" end
  return list
end

local function is_list(value)
  if getmetatable(value) == list_mark then return true end
  local n = #value
  if n == 0 then return false end
  local count = 0
  for _ in pairs(value) do count = count + 1 end
  return count == n
end

local write

local function write_list(value, out, indent, depth, seen)
  local inner = indent and "\n" .. indent:rep(depth + 1) or ""
  local flat = true
  for _, item in ipairs(value) do flat = flat and type(item) ~= "table" end
  out[#out + 1] = "["
  for i, item in ipairs(value) do
    if i > 1 then out[#out + 1] = indent and flat and ", " or "," end
    if not flat then out[#out + 1] = inner end
    write(item, out, indent, depth + 1, seen)
  end
  out[#out + 1] = not flat and indent and "\n" .. indent:rep(depth) .. "]" or "]"
end

local function write_object(value, out, indent, depth, seen)
  local keys = {}
  for key in pairs(value) do
    if type(key) ~= "string" then
      error(("json: a key of type %s (%s)"):format(type(key), tostring(key)), 0)
    end
    keys[#keys + 1] = key
  end
  if #keys == 0 then
    out[#out + 1] = "{}"
    return
  end
  table.sort(keys)
  local inner = indent and "\n" .. indent:rep(depth + 1) or ""
  out[#out + 1] = "{"
  for i, key in ipairs(keys) do
    out[#out + 1] = (i > 1 and "," or "") .. inner .. quote(key) .. (indent and ": " or ":")
    write(value[key], out, indent, depth + 1, seen)
  end
  out[#out + 1] = indent and "\n" .. indent:rep(depth) .. "}" or "}"
end

function write(value, out, indent, depth, seen)
  if depth > 200 then error("json: tables within tables, more than 200 deep", 0) end
  local kind = type(value)
  if value == json.null or value == nil then
    out[#out + 1] = "null"
  elseif kind == "boolean" then
    out[#out + 1] = tostring(value)
  elseif kind == "number" then
    out[#out + 1] = number(value)
  elseif kind == "string" then
    out[#out + 1] = quote(value)
  elseif kind == "table" then
    if seen[value] then error("json: a table that contains itself", 0) end
    seen[value] = true
    if is_list(value) then
      write_list(value, out, indent, depth, seen)
    else
      write_object(value, out, indent, depth, seen)
    end
    seen[value] = nil
  elseif core.class_name(value) == "array" then
    write(value:totable(), out, indent, depth, seen)
  else
    error(("json: a value of type %s"):format(kind), 0)
  end
end

--- The text of a value; indent: a string such as "  " for lines, nil for one line.
function json.encode(value, indent)
  if indent ~= nil and type(indent) ~= "string" then
    raise(("json.encode: indent: a string expected, got %s"):format(core.got(indent)))
  end
  local out = {}
  local ok, message = pcall(write, value, out, indent, 0, {})
  if not ok and type(message) ~= "string" then error(message, 0) end -- of a metamethod
  if not ok then raise(message) end
  return table.concat(out)
end

-- ---- reading -------------------------------------------------------------------------------------

local function at_line(text, position)
  local _, lines = text:sub(1, position - 1):gsub("\n", "")
  return lines + 1
end

-- A character; what a sentence cannot show, as a byte; or the end.
local function found(text, position)
  if position > #text then return "the end" end
  local character = text:match("^" .. utf8.charpattern, position)
  if character and utf8.len(character) and not character:find "%c" then return ("'%s'"):format(character) end
  return ("byte 0x%02X"):format(text:byte(position))
end

local function refusal(text, position, expected)
  return ("line %d, byte %d: %s expected, got %s"):format(at_line(text, position), position, expected,
    found(text, position))
end

local function fail(text, position, expected)
  error({refusal(text, position, expected)}, 0)
end

local unescapes = {b = "\b", f = "\f", n = "\n", r = "\r", t = "\t", ['"'] = '"', ["\\"] = "\\",
  ["/"] = "/"}

local function read_unicode(text, position)
  local high = text:match("^%x%x%x%x", position)
  if not high then fail(text, position, "four hexadecimal digits") end
  local code = tonumber(high, 16)
  position = position + 4
  if code >= 0xD800 and code < 0xDC00 then
    local low = text:match("^\\u(%x%x%x%x)", position)
    local value = low and tonumber(low, 16) or 0
    if value < 0xDC00 or value > 0xDFFF then fail(text, position, "the second half of a pair") end
    code = 0x10000 + ((code - 0xD800) << 10) + (value - 0xDC00)
    position = position + 6
  end
  return utf8.char(code), position
end

local function read_string(text, position)
  local parts = {}
  position = position + 1
  while true do
    local stop = text:find('["\\%z\1-\31]', position)
    if not stop or text:byte(stop) < 32 then fail(text, stop or #text + 1, 'the closing "') end
    parts[#parts + 1] = text:sub(position, stop - 1)
    if text:sub(stop, stop) == '"' then return table.concat(parts), stop + 1 end
    local escape = text:sub(stop + 1, stop + 1)
    if escape == "u" then
      parts[#parts + 1], position = read_unicode(text, stop + 2)
    elseif unescapes[escape] then
      parts[#parts + 1], position = unescapes[escape], stop + 2
    else
      fail(text, stop + 1, "an escape such as \\n")
    end
  end
end

local function skip(text, position)
  return text:find("[^ \t\r\n]", position) or #text + 1
end

local read

local function read_list(text, position, depth)
  local out = json.list {}
  position = skip(text, position + 1)
  if text:sub(position, position) == "]" then return out, position + 1 end
  while true do
    out[#out + 1], position = read(text, position, depth + 1)
    position = skip(text, position)
    local c = text:sub(position, position)
    if c == "]" then return out, position + 1 end
    if c ~= "," then fail(text, position, "',' or ']'") end
    position = skip(text, position + 1)
  end
end

local function read_object(text, position, depth)
  local out = {}
  position = skip(text, position + 1)
  if text:sub(position, position) == "}" then return out, position + 1 end
  while true do
    if text:sub(position, position) ~= '"' then fail(text, position, "a key in quotes") end
    local key
    key, position = read_string(text, position)
    position = skip(text, position)
    if text:sub(position, position) ~= ":" then fail(text, position, "':'") end
    out[key], position = read(text, skip(text, position + 1), depth + 1)
    position = skip(text, position)
    local c = text:sub(position, position)
    if c == "}" then return out, position + 1 end
    if c ~= "," then fail(text, position, "',' or '}'") end
    position = skip(text, position + 1)
  end
end

local words = {["true"] = true, ["false"] = false, null = json.null}

local function read_number(text, position)
  local digits = text:match("^-?%d+", position)
  if not digits or digits:match "^-?0%d" then fail(text, position, "a value") end
  local rest = position + #digits
  local fraction = text:match("^%.%d+", rest) or ""
  local exponent = text:match("^[eE][+-]?%d+", rest + #fraction) or ""
  local value = fraction == "" and exponent == "" and math.tointeger(tonumber(digits))
    or tonumber(digits .. fraction .. exponent) + 0.0
  return value, rest + #fraction + #exponent
end

function read(text, position, depth)
  if depth > 200 then fail(text, position, "less nesting") end
  local c = text:sub(position, position)
  if c == "{" then return read_object(text, position, depth) end
  if c == "[" then return read_list(text, position, depth) end
  if c == '"' then return read_string(text, position) end
  local word = text:match("^%a+", position)
  if word and words[word] ~= nil then return words[word], position + #word end
  return read_number(text, position)
end

--- The value of a text, or nil and a message with line and byte.
function json.decode(text)
  if type(text) ~= "string" then raise("json.decode: a string expected, got " .. core.got(text)) end
  local ok, value, position = pcall(read, text, skip(text, 1), 0)
  if ok then
    position = skip(text, position)
    if position <= #text then
      return nil, refusal(text, position, "the end")
    end
    return value
  end
  if type(value) == "table" then return nil, value[1] end
  error(value, 0)
end

return json
