-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Reads the annotation stubs in lua/stubs, a file for each module: classes with their fields and functions, in
-- order, with their texts. CONTRIBUTING.md says how they are written.
local read_file = require "barwright.read_file"

local stubs = {}

--- A type ends at the first blank outside brackets and quotes that is not in "fun(...): x"; a text follows.
function stubs.split(kind)
  local depth, quoted = 0, false
  for i = 1, #kind do
    local c = kind:sub(i, i)
    if c == '"' then quoted = not quoted end
    if c:match "[%(%{%[<]" then depth = depth + 1 end
    if c:match "[%)%}%]>]" then depth = depth - 1 end
    if c == " " and depth == 0 and not quoted and not kind:sub(1, i - 1):match ":$" then
      return kind:sub(1, i - 1), kind:sub(i + 1)
    end
  end
  return kind, ""
end

local function new_block()
  return {lines = {}, params = {}, returns = {}, fields = {}, overloads = {}}
end

-- "name? type text" as a parameter or a field; "[1]" is the first value of a table.
local function named(rest, line)
  local name, optional, described = rest:match "^(%[?[%w_%.]+%]?)(%??)%s+(.+)$"
  if not name then error(("line %d: a name and a type expected: %s"):format(line, rest), 0) end
  local kind, text = stubs.split(described)
  return {name = name, optional = optional == "?", type = kind, text = text, line = line}
end

local function returned(rest, line)
  local kind, remark = stubs.split(rest)
  local name, text = remark:match "^([%a_][%w_]*)%s*(.*)$"
  return {name = name, type = kind, text = text or remark, line = line}
end

-- One "---@..." line into the block at hand.
local function annotation(block, comment, line)
  local word, rest = comment:match "^@(%a+)%s*(.*)$"
  if word == "class" then
    block.class, block.parent = rest:match "^([%w%._]+):?%s*([%w%._]*)"
  elseif word == "alias" then
    block.alias, block.type = rest:match "^([%w%._]+)%s+(.*)$"
  elseif word == "field" then
    block.fields[#block.fields + 1] = named(rest, line)
  elseif word == "param" then
    block.params[#block.params + 1] = named(rest, line)
  elseif word == "return" then
    block.returns[#block.returns + 1] = returned(rest, line)
  elseif word == "overload" then
    block.overloads[#block.overloads + 1] = rest
  end
end

-- The ```lua blocks of a text: {line (of the first line of code), code}.
local function examples_of(lines)
  local out, code
  out = {}
  for _, one in ipairs(lines) do
    if one.text:match "^```lua%s*$" then
      code = {line = one.line + 1}
    elseif code and one.text:match "^```%s*$" then
      out[#out + 1] = {line = code.line, lines = #code, code = table.concat(code, "\n") .. "\n"}
      code = nil
    elseif code then
      code[#code + 1] = one.text
    end
  end
  return out
end

-- The text's lines as they stand, without empty ones at its ends.
local function joined(lines)
  local out = {}
  for i, one in ipairs(lines) do out[i] = one.text end
  return (table.concat(out, "\n"):gsub("^\n+", ""):gsub("\n+$", ""))
end

--- One file: {name, title, head, classes, aliases}.
--- A class: {name, parent (a class whose fields it has, too), line, text, examples, fields, overloads, functions}.
--- A function: {name, colon, arguments, text, examples, params, returns, line}.
--- A field or parameter: {name, optional, type, text, line}; a return: {name, type, text, line}.
function stubs.parse(text, name)
  local head, classes, aliases, by_variable = {}, {}, {}, {}
  local block, in_head, number = new_block(), true, 0
  for line in (text .. "\n"):gmatch "(.-)\n" do
    number = number + 1
    local comment = line:match "^%-%-%-(.*)$"
    local receiver, separator, member, arguments = line:match "^function ([%w_]+)([%.:])([%w_]+)%((.-)%)"
    local variable = line:match "^local ([%w_]+) = {}"
    if in_head and line:match "^%-%-" and not comment and not line:match "SPDX" and not line:match "Copyright" then
      head[#head + 1] = {text = (line:gsub("^%-%- ?", ""))}
    elseif comment and not comment:match "^@meta" then
      in_head = false
      if comment:match "^@" then
        annotation(block, comment, number)
      else
        block.lines[#block.lines + 1] = {text = comment, line = number}
      end
    else
      local described = {line = number, text = joined(block.lines), examples = examples_of(block.lines),
        fields = block.fields, overloads = block.overloads, functions = {}}
      if block.class then
        described.name, described.parent = block.class, block.parent ~= "" and block.parent or nil
        classes[#classes + 1] = described
        if variable then by_variable[variable] = described end
      elseif block.alias then
        described.name, described.type = block.alias, block.type
        aliases[#aliases + 1] = described
      elseif receiver then
        local class = by_variable[receiver] or error(("%s: no class for %s"):format(name, receiver), 0)
        class.functions[#class.functions + 1] = {name = member, colon = separator == ":", arguments = arguments,
          text = described.text, examples = described.examples, params = block.params, returns = block.returns,
          line = number}
      end
      block = new_block()
    end
  end
  local title, rest = joined(head):match "^([^\n]*)\n*(.*)$"
  return {name = name, title = title, head = rest, classes = classes, aliases = aliases}
end

--- All files of a folder, the module itself first, then by name: {files, classes (of one name put together, in
--- order), by_name}. A class has `file`, the name of the file that it is in.
function stubs.read(folder)
  local names = {}
  local pipe = assert(io.popen("ls '" .. folder:gsub("'", "'\\''") .. "'"))
  for line in pipe:lines() do names[#names + 1] = line:match "^(.*)%.lua$" end
  pipe:close()
  table.sort(names, function(a, b)
    if (a == "barwright") ~= (b == "barwright") then return a == "barwright" end
    return a < b
  end)
  local all = {files = {}, classes = {}, by_name = {}}
  for _, name in ipairs(names) do
    local file = stubs.parse(assert(read_file(folder .. "/" .. name .. ".lua")), name)
    all.files[#all.files + 1] = file
    for _, class in ipairs(file.classes) do
      local whole = all.by_name[class.name]
      if not whole then
        whole = {name = class.name, parent = class.parent, file = name, text = class.text, fields = {},
          overloads = {}, functions = {}}
        all.by_name[class.name] = whole
        all.classes[#all.classes + 1] = whole
      end
      for _, list in ipairs {"fields", "overloads", "functions"} do
        table.move(class[list], 1, #class[list], #whole[list] + 1, whole[list])
      end
    end
  end
  return all
end

--- class name -> set of its fields' and functions' names
function stubs.names(all)
  local out = {}
  for _, class in ipairs(all.classes) do
    local names = {}
    for _, field in ipairs(class.fields) do names[field.name] = true end
    for _, f in ipairs(class.functions) do
      if f.name ~= "__call" then names[f.name] = true end
    end
    out[class.name] = names
  end
  return out
end

--- How a script spells a class of functions: "bw.surface" for the module bw.SurfaceModule, "surface" for an object
--- of bw.Surface. The second result is true for modules.
function stubs.spoken(all, class)
  if class.name == "bw" then return "bw", true end
  for _, field in ipairs(all.by_name.bw.fields) do
    if field.type == class.name then return "bw." .. field.name, true end
  end
  return (class.name:gsub("^bw%.", ""):gsub("(%l)(%u)", "%1_%2"):lower()), false
end

return stubs
