-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The text of --help, made from a command's table.
local arguments = require "barwright.command.arguments"
local quantity = require "barwright.command.quantity"

local help_text = {}

local WIDTH = 79

--- The words of a text in lines of at most `width`; a line that begins with a space is kept as it is.
function help_text.wrap(text, width)
  local lines = {}
  for paragraph in (text .. "\n"):gmatch "(.-)\n" do
    if paragraph:match "^%s" or paragraph == "" then
      lines[#lines + 1] = paragraph
    else
      local line = ""
      for word in paragraph:gmatch "%S+" do
        if line ~= "" and utf8.len(line) + 1 + utf8.len(word) > width then
          lines[#lines + 1] = line
          line = word
        else
          line = line == "" and word or line .. " " .. word
        end
      end
      lines[#lines + 1] = line
    end
  end
  return lines
end

--- How an argument stands in the usage line.
function help_text.place(rule)
  local name = rule.name:upper():gsub("_", "-")
  if rule.many then name = name .. " ..." end
  return rule.optional and "[" .. name .. "]" or name
end

--- "usage: barwright NAME MODEL [options]"
function help_text.usage(name, command)
  local words = {"barwright", name}
  for _, rule in ipairs(command.arguments or {}) do words[#words + 1] = help_text.place(rule) end
  for _, rule in ipairs(command.options or {}) do
    if rule.needed then words[#words + 1] = ("--%s %s"):format(rule.name, rule.value) end
  end
  words[#words + 1] = "[options]"
  return table.concat(words, " ")
end

--- What stands in brackets behind an option's sentence.
function help_text.notes(rule, is_argument)
  local notes = {}
  if rule.one_of then
    local words = {}
    for i, word in ipairs(rule.one_of) do words[i] = tostring(word) end
    notes[#notes + 1] = table.concat(words, ", ")
  end
  if rule.default ~= nil and rule.type ~= "flag" then
    local words = {}
    for i, value in ipairs(type(rule.default) == "table" and rule.default or {rule.default}) do
      words[i] = type(value) == "number" and quantity.text(value, rule.unit) or tostring(value)
    end
    notes[#notes + 1] = "default " .. table.concat(words, ",")
  elseif rule.unit then
    notes[#notes + 1] = quantity.needed(rule.unit) and "with its unit" or "in " .. rule.unit
  end
  if rule.many and not is_argument then notes[#notes + 1] = "may be repeated" end
  if rule.list then notes[#notes + 1] = "commas between" end
  return #notes > 0 and " (" .. table.concat(notes, "; ") .. ")" or ""
end

--- "--force NEWTONS"
function help_text.option(rule)
  return "--" .. rule.name .. (rule.type ~= "flag" and " " .. rule.value or "")
end

local function table_of(rows, lines)
  local widest = 0
  for _, row in ipairs(rows) do
    if #row[1] <= 24 then widest = math.max(widest, #row[1]) end
  end
  local indent = ("  "):rep(2) .. (" "):rep(widest)
  for _, row in ipairs(rows) do
    local text = help_text.wrap(row[2], WIDTH - #indent)
    if #row[1] > widest then
      lines[#lines + 1] = "  " .. row[1]
      lines[#lines + 1] = indent .. text[1]
    else
      lines[#lines + 1] = "  " .. row[1] .. (" "):rep(widest - #row[1]) .. "  " .. text[1]
    end
    for i = 2, #text do lines[#lines + 1] = indent .. text[i] end
  end
end
help_text.table_of = table_of

--- The whole text for one command.
function help_text.of(name, command)
  local lines = {"usage: " .. help_text.usage(name, command), ""}
  local function add(text)
    for _, line in ipairs(help_text.wrap(text, WIDTH)) do lines[#lines + 1] = line end
  end
  add(command.about or command.summary .. ".")
  if command.arguments and #command.arguments > 0 then
    lines[#lines + 1] = ""
    local rows = {}
    for i, rule in ipairs(command.arguments) do
      rows[i] = {(help_text.place(rule):gsub("[%[%]]", "")), rule.what .. help_text.notes(rule, true)}
    end
    table_of(rows, lines)
  end
  lines[#lines + 1] = ""
  lines[#lines + 1] = "options:"
  local rows = {}
  for i, rule in ipairs(arguments.options(command)) do
    rows[i] = {help_text.option(rule), rule.what .. help_text.notes(rule)}
  end
  table_of(rows, lines)
  if command.examples then
    lines[#lines + 1] = ""
    lines[#lines + 1] = "examples:"
    for _, example in ipairs(command.examples) do
      if type(example) == "string" then
        lines[#lines + 1] = "  " .. example
      else
        lines[#lines + 1] = "  " .. example[1]
        for _, line in ipairs(help_text.wrap(example[2], WIDTH - 6)) do lines[#lines + 1] = "      " .. line end
      end
    end
  end
  return table.concat(lines, "\n")
end

return help_text
