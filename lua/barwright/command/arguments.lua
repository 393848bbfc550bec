-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The words behind `barwright NAME`, read by what the command's table says of them. A command is a module
-- that returns
--
--   {summary = "one line", about = "more, in paragraphs",
--    arguments = {{name = "model", type = "file", what = "...", optional =, many =, one_of =}, ...},
--    options = {{name = "force", value = "NEWTONS", type = "number", unit = "N", default = 20, above = 0,
--                what = "..."}, ...},
--    examples = {"barwright worst hook.stl --material pla", {"...", "what it does"}},
--    run = function(opts, out) ... return exit_code end}
--
-- Types: "string" (the default), "number" (with a unit where `unit` names one), "integer", "flag", "file",
-- "folder". Rules of numbers: min, max, above, below. Rules of all: one_of, needed, many (a list; options
-- may then be repeated), list (values with commas between, each by the rule), word (a word instead of a value),
-- keyed (a value may have KEY= before it), inline (a
-- function: true where it reads the text by itself, nil where it is another one, else false and a sentence).
-- The options have a field for each name ("-" becomes "_"); flags are true or false. `common` replaces --help,
-- --json and --quiet, which are every command's (script.lua).
local core = require "barwright.core"
local quantity = require "barwright.command.quantity"

local arguments = {}

--- What every command understands besides its own.
arguments.common = {
  {name = "json", type = "flag", what = "print one JSON object instead of sentences"},
  {name = "quiet", type = "flag", what = "print nothing but errors, show no progress"},
  {name = "help", type = "flag", what = "this text"},
}

--- The field of the options that an option or an argument fills.
function arguments.key(name)
  return (name:gsub("%-", "_"))
end

--- The options of a command and those that every command has.
function arguments.options(command)
  local list = {}
  for _, option in ipairs(command.options or {}) do list[#list + 1] = option end
  for _, option in ipairs(command.common or arguments.common) do list[#list + 1] = option end
  return list
end

local function by_name(command)
  local found, names = {}, {}
  for _, option in ipairs(arguments.options(command)) do
    found["--" .. option.name] = option
    names[#names + 1] = "--" .. option.name
  end
  return found, names
end

-- ---- values ----------------------------------------------------------------------------------------

local function range(rule)
  local parts = {}
  if rule.min then parts[#parts + 1] = ("from %.14g"):format(rule.min) end
  if rule.above then parts[#parts + 1] = ("above %.14g"):format(rule.above) end
  if rule.max then parts[#parts + 1] = ("up to %.14g"):format(rule.max) end
  if rule.below then parts[#parts + 1] = ("%sbelow %.14g"):format(#parts > 0 and "and " or "", rule.below) end
  return #parts > 0 and " " .. table.concat(parts, " ") or ""
end

local function fits(rule, value)
  return not (rule.min and value < rule.min or rule.max and value > rule.max
    or rule.above and value <= rule.above or rule.below and value >= rule.below)
end

local function quoted(text)
  return "'" .. text .. "'"
end

local function number_of(rule, text)
  if rule.type == "integer" then
    local value = text:match "^[+-]?%d+$" and math.tointeger(tonumber((text:gsub("^%+", ""))))
    if value and fits(rule, value) then return value end
    return nil, ("a whole number%s expected, got %s"):format(range(rule), quoted(text))
  end
  local value, expected = quantity.read(text, rule.unit)
  if not value then return nil, ("%s%s expected, got %s"):format(expected, range(rule), quoted(text)) end
  if fits(rule, value) then return value end
  return nil, ("a number%s%s expected, got %s"):format(rule.unit and " of " .. rule.unit or "", range(rule),
    quoted(text))
end

local function value_of(rule, text)
  local value = text
  if rule.type == "number" or rule.type == "integer" then
    local message
    value, message = number_of(rule, text)
    if value == nil then return nil, rule.word and ("'%s' or %s"):format(rule.word, message) or message end
    message = quantity.missing(text, rule.unit)
    if message then return nil, message end
  elseif text == "" then
    return nil, "a value expected, got an empty one"
  end
  if rule.endings then
    local ending, known = (text:match "%.(%w+)$" or ""):lower(), false
    for _, one in ipairs(rule.endings) do known = known or one == ending end
    if not known then
      return nil, ("a file that ends in .%s expected, got %s"):format(table.concat(rule.endings, ", ."),
        quoted(text))
    end
  end
  if rule.one_of then
    for _, word in ipairs(rule.one_of) do
      if word == value then return value end
    end
    local words = {}
    for i, word in ipairs(rule.one_of) do words[i] = tostring(word) end
    if #words <= 6 then
      return nil, ("one of %s expected, got %s"):format(table.concat(words, ", "), quoted(text))
    end
    return nil, ("%s is not known: %s"):format(quoted(text), core.suggestion(text, words))
  end
  return value
end

--- The value of one word by a rule, or nil and a sentence without a subject.
function arguments.value(rule, text)
  if rule.inline then
    local own, message = rule.inline(text)
    if own then return text end
    if own == false then return nil, message end
  end
  if rule.keyed then
    local key, word = text:match "^(.*=)([^=]*)$"
    if key then
      local value, message = value_of(rule, word)
      return value and key .. value, message
    end
  end
  if rule.word and text == rule.word then return text end
  if not rule.list then return value_of(rule, text) end
  local list = {}
  for word in (text .. ","):gmatch "([^,]*)," do
    local value, message = value_of(rule, word)
    if value == nil then return nil, message end
    list[#list + 1] = value
  end
  return list
end

-- ---- words -----------------------------------------------------------------------------------------

local function keep(opts, rule, value)
  local key = arguments.key(rule.name)
  if rule.many then
    opts[key] = opts[key] or {}
    table.insert(opts[key], value)
  else
    opts[key] = value
  end
end

-- The option that a name resembles, or all of them, however many these are.
local function meant(name, names)
  local text = core.suggestion(name, names)
  if text:find("^did you mean") then return text end
  table.sort(names)
  return "known are " .. table.concat(names, ", ")
end

-- One option at word i: the number of words taken, or nil and a sentence.
local function read_option(known, names, words, i, opts, given)
  local name, joined = words[i]:match "^(%-%-[^=]+)=(.*)$"
  name = name or words[i]
  if name == "-h" then name = "--help" end
  local rule = known[name]
  if not rule then return nil, ("unknown option %s: %s"):format(name, meant(name, names)) end
  if given[name] and not rule.many and rule.type ~= "flag" then
    return nil, ("option %s is given twice"):format(name)
  end
  given[name] = true
  if rule.type == "flag" then
    if joined then return nil, ("option %s takes no value"):format(name) end
    opts[arguments.key(rule.name)] = true
    return 1
  end
  local text = joined or words[i + 1]
  local is_option = not joined and text and (text == "--" or known[text:match "^[^=]*"] ~= nil)
  if not text or is_option then
    return nil, ("option %s: a value is missing (%s)"):format(name, rule.value or "VALUE")
  end
  local value, message = arguments.value(rule, text)
  if value == nil then return nil, ("option %s: %s"):format(name, message) end
  given[name] = text
  keep(opts, rule, value)
  return joined and 1 or 2
end

local function place_name(rule)
  return rule.name:upper():gsub("[_-]", " ")
end

-- The words that are no options, in order, into the command's arguments.
local function read_places(command, places, opts)
  local rules, at = command.arguments or {}, 1
  for _, text in ipairs(places) do
    local rule = rules[at]
    if not rule then
      return nil, #rules == 0 and ("no argument expected, got '%s'"):format(text)
        or ("'%s' is one argument too many"):format(text)
    end
    local value, message = arguments.value(rule, text)
    if value == nil then return nil, ("%s: %s"):format(place_name(rule), message) end
    keep(opts, rule, value)
    if not rule.many then at = at + 1 end
  end
  for _, rule in ipairs(rules) do
    local key = arguments.key(rule.name)
    if opts[key] == nil then
      if not rule.optional then return nil, place_name(rule) .. " is missing" end
      opts[key] = rule.many and {} or rule.default
    end
  end
  return true
end

local function fill_in(command, opts)
  for _, rule in ipairs(arguments.options(command)) do
    local key = arguments.key(rule.name)
    if opts[key] == nil then
      if rule.needed then
        return nil, ("option --%s %s is missing"):format(rule.name, rule.value or "VALUE")
      end
      if rule.type == "flag" then
        opts[key] = false
      elseif rule.many then
        opts[key] = rule.default or {}
      else
        opts[key] = rule.default
      end
    end
  end
  return true
end

--- The options that the words stand for, or nil and one sentence. Where --help is among them, no more is read. Its
--- `given` has the last text of every option that was given, by "--name"; true for flags.
function arguments.parse(command, words)
  local known, names = by_name(command)
  local opts, places, given, i = {}, {}, {}, 1
  while i <= #words do
    local word = words[i]
    if word == "--" then
      table.move(words, i + 1, #words, #places + 1, places)
      break
    elseif word:sub(1, 1) == "-" and word ~= "-" then
      local taken, message = read_option(known, names, words, i, opts, given)
      if not taken then return nil, message end
      if opts.help then return {help = true} end
      i = i + taken
    else
      places[#places + 1] = word
      i = i + 1
    end
  end
  local ok, message = read_places(command, places, opts)
  if ok then ok, message = fill_in(command, opts) end
  if not ok then return nil, message end
  opts.given = given
  return opts
end

-- ---- the table itself ------------------------------------------------------------------------------

local types = {string = true, number = true, integer = true, flag = true, file = true, folder = true}
local rule_keys = {name = true, value = true, type = true, default = true, one_of = true, what = true,
  optional = true, many = true, needed = true, unit = true, min = true, max = true, above = true,
  below = true, endings = true, word = true, list = true, keyed = true, inline = true}
local command_keys = {summary = "string", about = "string", arguments = "table", options = "table",
  examples = "table", run = "function", server = "boolean", common = "table"}

local function check_rule(rule, is_option, seen)
  local name = tostring(rule.name)
  if not name:match "^%l[%l%d_-]*$" then return name .. ": a name of small letters expected" end
  local key = arguments.key(name)
  if seen[key] then return name .. ": twice" end
  seen[key] = true
  for field in pairs(rule) do
    if not rule_keys[field] then return name .. ": unknown field " .. tostring(field) end
  end
  if not types[rule.type or "string"] then return name .. ": unknown type " .. rule.type end
  if type(rule.what) ~= "string" then return name .. ": what it is is missing" end
  if is_option and rule.type ~= "flag" and not rule.value then return name .. ": value is missing" end
end

--- What is wrong with a command's table, or nil: for tests.
function arguments.fault(command)
  for field, value in pairs(command) do
    if type(value) ~= command_keys[field] then return "field " .. tostring(field) end
  end
  if not command.summary or not (command.run or command.common) then return "summary or run is missing" end
  local seen = {}
  for i, rule in ipairs(command.arguments or {}) do
    local fault = check_rule(rule, false, seen)
    if fault then return fault end
    if rule.many and i < #command.arguments then return rule.name .. ": only the last one can be many" end
  end
  for _, rule in ipairs(arguments.options(command)) do
    local fault = check_rule(rule, rule.name ~= "help", seen)
    if fault then return fault end
  end
end

return arguments
