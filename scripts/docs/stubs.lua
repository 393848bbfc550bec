-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Reads annotation stubs: classes with their fields and functions, in order, with their comments.
local stubs = {}

local function new_block()
  return {text = {}, params = {}, returns = {}, fields = {}, overloads = {}}
end

-- One "---@..." line into the block at hand.
local function annotation(block, line)
  local class, rest = line:match "^@class%s+([%w%.]+)%s*(.*)$"
  if class then
    block.class, block.about = class, rest:gsub("^:%s*", "")
    return
  end
  local name, kind = line:match "^@field%s+([%w_]+%??)%s+(.+)$"
  if name then
    block.fields[#block.fields + 1] = {name = name:gsub("%?$", ""), type = kind}
    return
  end
  name, kind = line:match "^@param%s+([%w_]+%??)%s+(.+)$"
  if name then
    block.params[#block.params + 1] = {name = name, type = kind}
    return
  end
  kind = line:match "^@return%s+(.+)$"
  if kind then
    block.returns[#block.returns + 1] = kind
    return
  end
  kind = line:match "^@overload%s+(.+)$"
  if kind then block.overloads[#block.overloads + 1] = kind end
end

-- A type ends at the first blank outside brackets and quotes that is not in "fun(...): x"; the rest is a remark.
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

--- {head = paragraphs, classes = {{name, text, fields, overloads, functions = {{name, colon, text, params,
--- returns}}}}}
function stubs.parse(text)
  local head, classes, by_variable = {""}, {}, {}
  local block, in_head = new_block(), true
  for line in (text .. "\n"):gmatch "(.-)\n" do
    local comment = line:match "^%-%-%-(.*)$"
    local receiver, separator, name, arguments = line:match "^function ([%w_]+)([%.:])([%w_]+)%((.-)%)"
    local variable = line:match "^local ([%w_]+) = {}"
    if in_head and line:match "^%-%- " and not line:match "SPDX" and not line:match "Copyright" then
      head[#head] = head[#head] .. (head[#head] == "" and "" or " ") .. line:sub(4)
    elseif in_head and line == "--" then
      head[#head + 1] = ""
    end
    if comment and comment:match "^@meta" then
      block = new_block()
    elseif comment and comment:match "^@" then
      in_head = false
      annotation(block, comment)
    elseif comment then
      in_head = false
      block.text[#block.text + 1] = comment
    else
      if block.class then
        classes[#classes + 1] = {name = block.class, about = block.about,
          text = table.concat(block.text, " "), fields = block.fields, functions = {},
          overloads = block.overloads}
        if variable then by_variable[variable] = classes[#classes] end
      elseif receiver then
        local class = assert(by_variable[receiver], "no class for " .. receiver)
        class.functions[#class.functions + 1] = {name = name, colon = separator == ":",
          arguments = arguments, text = table.concat(block.text, " "), params = block.params,
          returns = block.returns}
      end
      block = new_block()
    end
  end
  return {head = head, classes = classes}
end

--- class name -> set of its fields' and functions' names
function stubs.names(text)
  local out = {}
  for _, class in ipairs(stubs.parse(text).classes) do
    local names = {}
    for _, field in ipairs(class.fields) do names[field.name] = true end
    for _, f in ipairs(class.functions) do names[f.name] = true end
    out[class.name] = names
  end
  return out
end

return stubs
