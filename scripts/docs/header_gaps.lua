-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the comments of the public C headers lack, by the rules of CONTRIBUTING.md ("The C headers").
local gaps = require "gaps"
local headers = require "headers"
local read_file = require "barwright.read_file"
local statuses = require "statuses"

local header_gaps = {}

header_gaps.kinds = {"comment", "parameter", "unit", "shape", "default", "range", "ownership", "status"}

-- Statuses that the contract names for every function; and BW_IO for those that have a path.
local CONTRACT = {BW_OK = true, BW_INVALID = true, BW_MEMORY = true, BW_CANCELLED = true, BW_INTERNAL = true}
local OWNERS = {"free", "release", "retain", "owned", "owns", "borrow", "cop[iy]", "static", "valid until",
  "lives?%f[^%a]", "clear", "caller's"}
local REALS = {double = true, float = true}

-- The names that the contract explains once, from the lines "(unit)  name, name" of its paragraph "Words".
local function vocabulary(contract)
  local words = {}
  for unit, row in contract:gmatch "\n %*%s+(%b()) +([%l_][%l%d_, ]+)" do
    for name in row:gmatch "[%l%d_]+" do words[name] = unit:sub(2, -2) end
  end
  return words
end

--- What headers share: names of the contract, types that are objects, functions that free, statuses of functions.
function header_gaps.context(folder, sources)
  local context = {words = vocabulary(assert(read_file(folder .. "/barwright.h"))), objects = {}, functions = {},
    enums = {}, statuses = {}, sources = statuses.read(sources), headers = {}}
  local listing = assert(io.popen(("ls '%s'/barwright/*.h"):format(folder)))
  for path in listing:lines() do
    local header = headers.parse(assert(read_file(path)))
    header.name = path:match "([^/]+)%.h$"
    context.headers[#context.headers + 1] = header
    header_gaps.learn(context, header)
  end
  listing:close()
  return context
end

--- Adds the types and functions of a header to the context.
function header_gaps.learn(context, header)
  for _, struct in ipairs(header.structs) do
    local first = struct.fields[1]
    if first and first.type == "bw_object" then context.objects[struct.name] = true end
  end
  for _, one in ipairs(header.opaque) do
    if one.comment:find "[Oo]bject" then context.objects[one.name] = true end
  end
  for _, one in ipairs(header.functions) do context.functions[one.name] = one end
  for _, enum in ipairs(header.enums) do
    context.enums[enum.name] = true
    local list = enum.name == "bw_status" and enum.values or {}
    for _, value in ipairs(list) do context.statuses[value.name] = true end
  end
end

local function add(list, kind, line, text)
  list[#list + 1] = {kind = kind, line = line, text = text, number = #list}
end

-- The brackets that follow a name in a text, at once or behind other names: "a (m, n x 3)", "a, b and c (m)".
-- Second result: whether the name has a star before it, which means a single number.
local function described(text, name)
  local from, mentioned, star = 1, false, false
  while true do
    local start, stop = text:find("%f[%w_]" .. name .. "%f[^%w_]", from)
    if not start then return nil, mentioned, star end
    mentioned = true
    star = star or text:sub(1, start - 1):find "%*$" ~= nil
    local rest = text:sub(stop + 1):gsub("^`", "")
    while true do
      local given = rest:match "^%s*(%b())"
      if given then return given:sub(2, -2), true, star end
      local behind = rest:match "^,? and [`%*]*[%w_]+`?(.*)$" or rest:match "^, [`%*]*[%w_]+`?(.*)$"
      if not behind then break end
      rest = behind
    end
    from = stop + 1
  end
end

-- A unit and a shape, as "m, count x 3", "m" or "count x 3". `count` alone is the shape of a pointer.
local function unit_and_shape(given, pointer)
  local unit, shape = given:match "^([^,;:]*)[,;:]?%s*(.*)$"
  if gaps.units[unit] and not (pointer and given == "count") then return unit, shape end
  return nil, given
end

local function numeric(type)
  return REALS[type] or type:match "^u?int%d*_t$" or type == "int" or type == "size_t" or type == "unsigned"
    or type == "bool"
end

local function owned(text)
  for _, word in ipairs(OWNERS) do
    if text:lower():find(word) then return true end
  end
end

local function parameter_gap(list, context, f, one)
  local where = ("%s: %s"):format(f.name, one.name)
  local text = f.comment
  local word = context.words[one.name]
  local given, mentioned, single = described(text, one.name)
  local pointer = one.stars > 0
  local freed = context.objects[one.type] or context.functions[one.type .. "_free"]
    or context.functions[one.type .. "_destroy"]
  if one.stars > 1 and not freed and one.type ~= "void" and not one.constant
    and not owned(text) then
    add(list, "ownership", f.line, where .. ": who releases it?")
  end
  if not numeric(one.type) or one.calls then
    local bare = one.type == "char" or one.calls
    if bare and not mentioned and not word then add(list, "parameter", f.line, where .. ": not mentioned") end
    return
  end
  local real = REALS[one.type]
  if not mentioned and not (word and not pointer) and not one.name:find "count$" then
    add(list, real and "unit" or pointer and "shape" or "parameter", f.line, where .. ": not mentioned")
    return
  end
  local unit, shape
  if given then unit, shape = unit_and_shape(given, pointer) end
  if real and not unit and not word then add(list, "unit", f.line, where .. ": no unit") end
  if pointer and not single and (not shape or shape == "") and not one.name:find "count$" then
    add(list, "shape", f.line, where .. ": no shape; *" .. one.name .. " if it is one number")
  end
end

local function result_gap(list, f)
  if not f.result then return end
  if f.result:find "%*" and not f.name:find "_word$" and not owned(f.comment) then
    add(list, "ownership", f.line, f.name .. ": who releases its result?")
  end
  if f.result:match "double$" and not f.comment:find "%b()" then
    add(list, "unit", f.line, f.name .. ": no unit of its result")
  elseif f.result:match "double$" then
    for given in f.comment:gmatch "%b()" do
      if unit_and_shape(given:sub(2, -2)) then return end
    end
    add(list, "unit", f.line, f.name .. ": no unit of its result")
  end
end

local function names(set)
  local out = {}
  for word in pairs(set) do out[#out + 1] = word end
  table.sort(out)
  return out
end

local function status_gap(list, context, f)
  if f.result ~= "bw_status" or f.name:find "_check$" then return end
  local near = statuses.of(context.sources, f.name, true)
  if not near then return add(list, "status", f.line, f.name .. ": no definition found") end
  local said = f.comment
  for _, one in ipairs(f.parameters) do
    if one.name == "path" then said = said .. " BW_IO" end
  end
  for other in f.comment:gmatch "[Tt]hose of (bw_[%w_]+)" do
    if context.functions[other] then said = said .. context.functions[other].comment end
  end
  for _, word in ipairs(names(near)) do
    if context.statuses[word] and not CONTRACT[word] and not said:find(word .. "%f[^%w_]") then
      add(list, "status", f.line, ("%s: returns %s; the comment does not say when"):format(f.name, word))
    end
  end
  local prose = f.comment:gsub("`[^`]*`", "")
  if prose:find "%f[%w_]BW_" then
    local far = statuses.of(context.sources, f.name, false)
    for word in prose:gmatch "%f[%w_]BW_[A-Z]+%f[^%w_]" do
      if context.statuses[word] and not far[word] then
        add(list, "status", f.line, ("%s: nothing that it calls returns %s"):format(f.name, word))
      end
    end
  end
end

-- What the contract says of all functions of a kind.
local function covered(name)
  for _, ending in ipairs {"_default", "_free", "_clear", "_destroy", "_word", "_check"} do
    if name:find(ending .. "$") then return true end
  end
end

local function add_function(list, context, f, callback)
  if f.comment:gsub("%b()", "") == "" and not covered(f.name) then
    return add(list, "comment", f.line, f.name .. ": no comment")
  end
  for _, one in ipairs(f.parameters) do parameter_gap(list, context, f, one) end
  if not callback then
    result_gap(list, f)
    status_gap(list, context, f)
  end
end

-- Types of numbers of options that have a range, and the words by which a comment states it. Numbers whose unit
-- the caller decides have none.
local RANGED = {double = true, float = true, int = true, int32_t = true, int64_t = true}
local RANGES = {" or more", "> 0", "above %S", "below %S", "not 0", "finite", "or %d",
  "to %-?[%d`(]", "to BW_", "from %d", "negative", "^%(any%)"}

local function states_range(comment)
  for _, pattern in ipairs(RANGES) do
    if comment:find(pattern) then return true end
  end
  return false
end

local function add_field(list, context, struct, field, has_default)
  local where = ("%s: %s"):format(struct.name, field.name)
  local comment = field.comment
  local plain = field.type == "bw_object" or field.name == "inner" or field.name:find "count$"
    or context.words[field.name] or "bw_" .. field.name == field.type
    or context.objects[field.type] and field.stars == 1
  if comment == "" and not (plain and field.stars == 0 or plain and context.objects[field.type])
    and field.name ~= "inner" then
    return add(list, "comment", field.line, where .. ": no comment")
  end
  local real = REALS[field.type]
  if real or numeric(field.type) and field.stars > 0 then
    local unit, shape
    local given = comment:match "^(%b())"
    if given then unit, shape = unit_and_shape(given:sub(2, -2), field.stars > 0) end
    if real and not unit and not context.words[field.name] then
      add(list, "unit", field.line, where .. ": its comment does not begin with a unit")
    end
    if field.stars > 0 and (not shape or shape == "") then
      add(list, "shape", field.line, where .. ": its comment does not begin with unit and shape")
    end
  end
  if has_default and field.stars == 0 and not field.calls and not comment:find "[Dd]efault"
    and (numeric(field.type) or context.enums[field.type]) and not field.name:find "count$" then
    add(list, "default", field.line, where .. ": no default")
  end
  if has_default and field.stars == 0 and field.dimensions == "" and not field.calls and RANGED[field.type]
    and comment ~= "" and not field.name:find "count$" and not states_range(comment) then
    add(list, "range", field.line, where .. ": no range")
  end
end

-- A struct that is no object, and that no function of its own releases, says who owns what it points to. By the
-- contract, what options point to is read during the call only.
local function add_owner(list, context, struct)
  local released = context.functions[struct.name .. "_clear"]
  if context.objects[struct.name] or released or struct.name:find "_options$" then return end
  for _, field in ipairs(struct.fields) do
    local said = owned(struct.comment .. " " .. field.comment)
    if field.stars > 0 and not context.objects[field.type] and not said then
      add(list, "ownership", field.line, ("%s: %s: who releases it?"):format(struct.name, field.name))
    end
  end
end

--- The gaps of a header of the context, {kind, line, text}, in the order of their lines.
function header_gaps.of(context, header)
  local list = {}
  if header.head == "" then add(list, "comment", 1, "no comment at the top") end
  local typedefs, completed = {}, {} -- "typedef struct a a;" and "struct a {...};" share a comment
  for _, one in ipairs(header.opaque) do typedefs[one.name] = one end
  for _, one in ipairs(header.structs) do
    local typedef = typedefs[one.name]
    if typedef then completed[typedef] = true end
    if typedef and one.comment == "" then one.comment = typedef.comment end
  end
  for _, group in ipairs {header.macros, header.structs, header.enums, header.callbacks, header.opaque,
    header.constants} do
    for _, one in ipairs(group) do
      if one.comment == "" and one.name ~= "" and not completed[one] then
        add(list, "comment", one.line, one.name .. ": no comment")
      end
    end
  end
  for _, one in ipairs(header.opaque) do
    if not completed[one] and not one.comment:find "[Oo]bject" and not owned(one.comment) then
      add(list, "ownership", one.line, one.name .. ": an object, or what releases it?")
    end
  end
  for _, struct in ipairs(header.structs) do
    add_owner(list, context, struct)
    local has_default = context.functions[struct.name .. "_default"] ~= nil
    for _, field in ipairs(struct.fields) do add_field(list, context, struct, field, has_default) end
  end
  for _, enum in ipairs(header.enums) do
    for _, value in ipairs(enum.values) do
      if value.comment == "" then add(list, "comment", value.line, value.name .. ": no comment") end
    end
  end
  for _, one in ipairs(header.callbacks) do add_function(list, context, one, true) end
  for _, one in ipairs(header.functions) do add_function(list, context, one, false) end
  table.sort(list, function(a, b)
    if a.line ~= b.line then return a.line < b.line end
    return a.number < b.number
  end)
  return list
end

return header_gaps
