-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the API reference lacks, by the rules of CONTRIBUTING.md ("The API reference").
local stubs = require "stubs"

local gaps = {}

gaps.kinds = {"description", "parameter", "option", "field", "return", "unit", "type", "errors", "example"}

-- Units that a text may begin with; "any": the unit of what the caller gives.
local units = {}
for _, unit in ipairs {
  "-", "any", "count", "index", "index from 1", "index from 0", "seed", "m", "m2", "m3", "m4", "1/m", "1/m2",
  "mm", "N", "1/N", "N m", "N s", "N/m", "N/m2", "Pa", "1/Pa", "Pa s", "Pa/m", "Pa m^0.5", "Pa m^(1 - exponent)",
  "J", "J/m3", "kg", "kg/m3", "s", "1/s", "1/s2", "minutes", "Hz", "Hz/m", "rad", "rad/s", "(rad/s)^2", "degrees",
  "kg m2", "N m/rad", "cents/mm", "K", "1/K", "K m/s", "K m2/s", "W", "W/m2", "W/m3", "W/K", "W K", "W/(m K)",
  "cents", "W/(m2 K)", "W/(m2 K4)", "J/(kg K)", "m/s", "m/s2", "m2/s", "pixels", "bytes", "bits"} do
  units[unit] = true
end
gaps.units = units

-- The alternatives of a type: those of a union outside of brackets.
local function alternatives(kind)
  local out, depth, from, quoted = {}, 0, 1, false
  for i = 1, #kind + 1 do
    local c = kind:sub(i, i)
    if c == '"' then quoted = not quoted end
    if c:match "[%(%{%[<]" then depth = depth + 1 end
    if c:match "[%)%}%]>]" then depth = depth - 1 end
    if c == "" or c == "|" and depth == 0 and not quoted then
      out[#out + 1] = kind:sub(from, i - 1):gsub("%?$", "")
      from = i + 1
    end
  end
  return out
end
gaps.alternatives = alternatives

-- Whether a value of the type is a number or an array of numbers, and whether it is an array.
local function numeric(kind)
  local number, array = false, false
  for _, one in ipairs(alternatives(kind)) do
    local name, brackets = one:match "^([%w%.]+)([%[%]]*)$"
    if name == "number" or name == "integer" or name == "bw.Vector" then
      number = true
      array = array or brackets ~= "" and name ~= "bw.Vector"
    elseif name == "bw.Array" then
      number, array = true, true
    end
  end
  return number, array
end

local function untyped(kind)
  local plain = kind:gsub('"[^"]*"', ""):gsub("table<", "<")
  return plain:find "{" ~= nil or plain:find "%f[%w_]table%f[^%w_]" ~= nil
    or plain:find "%f[%w_]function%f[^%w_]" ~= nil
end

local basic = {}
for _, word in ipairs {"any", "boolean", "false", "fun", "integer", "nil", "number", "string", "table", "true"} do
  basic[word] = true
end

-- The first word of a type that names no class, alias or basic type; nil: there is none.
local function unknown_word(known, kind)
  local plain = kind:gsub('"[^"]*"', ""):gsub("[%w_]+%??:", "") -- parameters of functions have names
  for word in plain:gmatch "[%a_][%w_%.]*" do
    if not known[word] and not basic[word] then return word end
  end
end

-- A unit in parentheses at the start of the text, for arrays with their shape behind a comma.
local function unit_gap(one)
  local number, array = numeric(one.type)
  if not number then return nil end
  local given = one.text:match "^(%b())"
  if not given then return "no unit" end
  local unit, shape = given:sub(2, -2):match "^([^,]*),?%s*(.*)$"
  if not units[unit] then return ("unit '%s' is not in the list of scripts/docs/gaps.lua"):format(unit) end
  if array and shape == "" then return "no shape behind the unit" end
end

local function add(list, kind, line, text) list[#list + 1] = {kind = kind, line = line, text = text} end

local function add_value(list, kind, where, one, known)
  if one.text:gsub("^%b()%s*", "") == "" then add(list, kind, one.line, where .. ": no text") end
  local unit = unit_gap(one)
  if unit then add(list, "unit", one.line, where .. ": " .. unit) end
  local unknown = unknown_word(known, one.type)
  if one.type == "" then
    add(list, "type", one.line, where .. ": no type")
  elseif unknown then
    add(list, "type", one.line, ("%s: no class '%s'"):format(where, unknown))
  elseif untyped(one.type) then
    add(list, "type", one.line, ("%s: %s"):format(where, one.type))
  end
end

local function add_examples(list, where, line, examples)
  if #examples == 0 then add(list, "example", line, where .. ": no example") end
  for _, example in ipairs(examples) do
    if example.lines < 2 or example.lines > 6 then
      add(list, "example", example.line, where .. ": 2 to 6 lines expected")
    end
  end
end

local function add_function(list, where, f, in_module, known)
  if f.text:gsub("```.-```", "") == "" then add(list, "description", f.line, where .. ": no text") end
  local names = {}
  for i, param in ipairs(f.params) do
    names[i] = param.name
    add_value(list, "parameter", where .. ": " .. param.name, param, known)
  end
  local declared = f.arguments:gsub("%s", "")
  if table.concat(names, ",") ~= declared then
    add(list, "parameter", f.line, ("%s: ---@param of (%s), the function has (%s)"):format(where,
      table.concat(names, ", "), f.arguments))
  end
  local fails = false
  for i, result in ipairs(f.returns) do
    if result.type:find "bw%.Details" then
      fails = true
    elseif result.name ~= "self" and not (result.name == "message" and result.type == "string?") then
      add_value(list, "return", ("%s: result %d"):format(where, i), result, known)
    end
  end
  local nothing = f.returns[1] and f.returns[1].type:match "%?$"
  if not f.text:find "%f[%w]Errors:" then
    if fails then
      add(list, "errors", f.line, where .. ": no paragraph 'Errors:'")
    elseif nothing and not f.text:find "%f[%w]nil%f[^%w]" and not f.returns[1].text:find "%f[%w]nil%f[^%w]" then
      add(list, "errors", f.line, where .. ": may return nil; neither 'Errors:' nor the text says when")
    end
  end
  if in_module or #f.examples > 0 then add_examples(list, where, f.line, f.examples) end
end

--- The gaps of one file, {kind, line, text}, in the order of their lines.
function gaps.of(all, file)
  local list, known = {}, {}
  for name in pairs(all.by_name) do known[name] = true end
  for _, one in ipairs(all.files) do
    for _, alias in ipairs(one.aliases) do known[alias.name] = true end
  end
  if file.title == "" then add(list, "description", 1, "no title") end
  if file.head == "" then add(list, "description", 1, "no text below the title") end
  for _, class in ipairs(file.classes) do
    local spoken, is_module = stubs.spoken(all, class)
    local whole = all.by_name[class.name]
    local objects = #whole.functions > 0
    if whole.file == file.name then
      if class.text == "" then add(list, "description", class.line, class.name .. ": no text") end
      if objects and not is_module or #class.examples > 0 then
        add_examples(list, class.name, class.line, class.examples)
      end
    end
    for _, field in ipairs(class.fields) do
      if not (is_module and field.type:match "Module$") then
        add_value(list, objects and "field" or "option", class.name .. ": " .. field.name, field, known)
      end
    end
    for _, f in ipairs(class.functions) do
      local member = f.name == "__call" and "()" or (f.colon and ":" or ".") .. f.name
      add_function(list, spoken .. member, f, is_module, known)
    end
  end
  table.sort(list, function(a, b) return a.line < b.line end)
  return list
end

return gaps
