-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Reads a public C header: macros, types with their fields and values, and functions with their parameters, each
-- with its comment. It knows the C of engine/include as clang-format lays it out, not more.
local headers = {}

-- The text of comments, without marks and line breaks.
local function plain(comment)
  return (comment:gsub("^/%*+", ""):gsub("%*+/$", ""):gsub("\n%s*%*?", " "):gsub("%s+", " ")
    :gsub("^%s+", ""):gsub("%s+$", ""))
end

local function joined(a, b)
  if a == "" or b == "" then return a .. b end
  return a .. " " .. b
end

local function line_at(text, position)
  return select(2, text:sub(1, position):gsub("\n", "")) + 1
end

-- The pieces of C text: {comment = text} or {code = text}, with position. Strings hold no comments in headers.
local function pieces(text, first)
  local list, from = {}, 1
  while from <= #text do
    local start, stop = text:find("/%*.-%*/", from)
    if not start or start > from then
      list[#list + 1] = {code = text:sub(from, (start or #text + 1) - 1), position = first + from - 1}
    end
    if not start then break end
    list[#list + 1] = {comment = text:sub(start, stop), position = first + start - 1}
    from = stop + 1
  end
  return list
end

-- Splits at commas outside of brackets.
local function split(text)
  local out, depth, from = {}, 0, 1
  for i = 1, #text + 1 do
    local c = text:sub(i, i)
    if c:match "[%(%[{]" then depth = depth + 1 end
    if c:match "[%)%]}]" then depth = depth - 1 end
    if c == "" or c == "," and depth == 0 then
      out[#out + 1] = text:sub(from, i - 1):gsub("^%s+", ""):gsub("%s+$", "")
      from = i + 1
    end
  end
  return out
end

-- A declarator behind its type: name, stars, dimensions ("[3]"), whether it is a pointer to a function.
local function declarator(text)
  text = text:gsub("%*%s*const%f[^%w_]", "*")
  local name, arguments = text:match "^%s*%**%s*%(%*([%w_]+)%)%s*(%b())"
  if name then return {name = name, stars = 0, dimensions = "", calls = arguments} end
  name = text:match "^%s*%(%*([%w_]+)%)%s*%["
  if name then return {name = name, stars = 1, dimensions = ""} end
  local stars, rest = text:match "^([%s%*]*)(.*)$"
  name = rest:match "^[%w_]+"
  return {name = name, stars = select(2, stars:gsub("%*", "")), dimensions = rest:match "%[.*$" or ""}
end

-- "const double *x" as a type without const and struct, and its declarator.
local function variable(text)
  -- the last word is the name where no star or bracket comes before it
  local words, tail = text:match "^([%w_%s]+)(.*)$"
  local type, rest
  if tail == "" or tail:match "^%[" then
    type, rest = words:match "^(.-)%s+([%w_]+)$"
    rest = rest .. tail
  else
    type, rest = words:gsub("%s+$", ""), tail
  end
  local one = declarator(rest)
  one.constant = type:find "%f[%w_]const%f[^%w_]" ~= nil
  one.type = type:gsub("%f[%w_]const%f[^%w_]", ""):gsub("%f[%w_]struct%f[^%w_]", ""):gsub("%s+", " ")
    :gsub("^ ", ""):gsub(" $", "")
  return one
end

local function parameters(text)
  local out = {}
  for _, one in ipairs(split(text:sub(2, -2):gsub("%s+", " "))) do
    if one ~= "void" and one ~= "..." and one ~= "" then out[#out + 1] = variable(one) end
  end
  return out
end

-- The items between two ends ("," or ";"), each with the comments before it and behind it on its line.
local function items(text, first, whole, finish)
  local out, leading, current = {}, "", nil
  local function start(position)
    current = {code = "", comment = leading, line = line_at(whole, position)}
    leading = ""
  end
  for _, piece in ipairs(pieces(text, first)) do
    if piece.comment then
      local before = whole:sub(1, piece.position - 1):match "[^\n]*$"
      if current then -- inside of an item
        current.comment = joined(current.comment, plain(piece.comment))
      elseif before:find "%S" and out[#out] then -- behind one, on its line
        out[#out].comment = joined(plain(piece.comment), out[#out].comment)
      else
        leading = joined(leading, plain(piece.comment))
      end
    else
      local depth, from = 0, 1
      for i = 1, #piece.code do
        local c = piece.code:sub(i, i)
        if c:match "[%({%[]" then depth = depth + 1 end
        if c:match "[%)}%]]" then depth = depth - 1 end
        if c == finish and depth == 0 then
          local code = piece.code:sub(from, i - 1)
          if not current then start(piece.position + from - 1 + #code:match "^%s*") end
          current.code = current.code .. code
          out[#out + 1], current, from = current, nil, i + 1
        end
      end
      local rest = piece.code:sub(from)
      if rest:find "%S" then
        if not current then start(piece.position + from - 1 + #rest:match "^%s*") end
        current.code = current.code .. rest
      end
    end
  end
  if current then out[#out + 1] = current end
  for _, item in ipairs(out) do item.code = item.code:gsub("%s+", " "):gsub("^ ", ""):gsub(" $", "") end
  return out
end

local function fields(body, first, whole)
  local out = {}
  for _, item in ipairs(items(body, first, whole, ";")) do
    local names = split(item.code)
    local lead = variable(names[1])
    for i, text in ipairs(names) do
      local one = i == 1 and lead or declarator(text)
      one.type, one.constant, one.comment, one.line = lead.type, lead.constant, item.comment, item.line
      out[#out + 1] = one
    end
  end
  return out
end

local function values(body, first, whole)
  local out = {}
  for _, item in ipairs(items(body, first, whole, ",")) do
    out[#out + 1] = {name = item.code:match "^[%w_]+", comment = item.comment, line = item.line}
  end
  return out
end

-- One declaration, from its first character to its semicolon.
local function declaration(header, code, position, whole, comment)
  local line = line_at(whole, position)
  local stripped = code:gsub("/%*.-%*/", " "):gsub("%s+", " ")
  local open = code:find("{", 1, true)
  if stripped:find "^static inline" then stripped = "BW_API" .. stripped:match "^static inline(.-)%s*{" end
  local entry = {comment = comment, line = line}
  local kind = stripped:match "^typedef (%a+)" or stripped:match "^(%a+) [%w_]*%s*{"
  if open and not code:find "^static" and (kind == "struct" or kind == "enum" or kind == "union") then
    local body = code:match("%b{}"):sub(2, -2)
    entry.name = stripped:match "}%s*([%w_]+)" or stripped:match "^%a+ ([%w_]+) {" or ""
    if kind == "enum" then
      entry.values = values(body, position + open, whole)
      header.enums[#header.enums + 1] = entry
    else
      entry.fields = fields(body, position + open, whole)
      header.structs[#header.structs + 1] = entry
    end
  elseif stripped:find "^typedef" and stripped:find "%(" then
    local name, arguments = stripped:match "([%w_]+)%s*(%b())%s*$"
    entry.name, entry.parameters = name, parameters(arguments)
    header.callbacks[#header.callbacks + 1] = entry
  elseif stripped:find "^typedef struct" then
    entry.name = stripped:match "([%w_]+)$"
    header.opaque[#header.opaque + 1] = entry
  elseif stripped:find "^BW_API extern" then
    entry.name = stripped:match "([%w_]+)%s*%["
    header.constants[#header.constants + 1] = entry
  elseif stripped:find "^BW_API" then
    local result, name, arguments = stripped:match "^BW_API (.-)%s*([%w_]+)%s*(%b())"
    entry.name, entry.parameters = name, parameters(arguments)
    entry.result = result:gsub("%s*%*", " *")
    header.functions[#header.functions + 1] = entry
  end
end

--- A header as lists of {name, comment, line}: macros, structs (with fields), enums (with values), callbacks and
--- functions (with parameters and result), opaque types, constants; `head` is its first comment.
function headers.parse(text)
  local header = {head = "", macros = {}, structs = {}, enums = {}, callbacks = {}, functions = {}, opaque = {},
    constants = {}}
  local comment, position = "", 1
  local last
  local function trailing(from)
    local start, stop = text:find("^[ \t]*/%*.-%*/", from)
    if not start then return from, "" end
    return stop + 1, plain(text:sub(start, stop):match "/%*.*$")
  end
  while position <= #text do
    local blank = text:match("^%s+", position)
    if blank then
      if select(2, blank:gsub("\n", "")) > 1 then comment = "" end -- not of what follows
      position = position + #blank
    elseif text:find("^/%*", position) then
      local _, stop = text:find("%*/", position)
      local one = plain(text:sub(position, stop))
      if header.head == "" and position == 1 then header.head = one
      elseif not one:find "^%-%-%-%-" then comment = joined(comment, one) end
      position = stop + 1
    elseif text:find("^#", position) then
      local stop = text:find("[^\\]\n", position) or #text
      local row = text:sub(position, stop)
      local name = row:match "^#define ([%w_]+)"
      local behind = row:match "/%*.-%*/"
      if name and not name:find "_H$" then
        local line = line_at(text, position)
        -- macros on successive lines share a comment, across #if
        if last and last.stop + 1 == line and comment == "" and not behind then comment = last.comment end
        last = {name = name, comment = joined(comment, behind and plain(behind) or ""), line = line,
          stop = line_at(text, stop)}
        header.macros[#header.macros + 1] = last
      end
      if name then comment = "" elseif last then last.stop = line_at(text, stop) end
      position = stop + 1
    elseif text:find('^extern "C" {', position) then
      position = position + #'extern "C" {'
    elseif text:find("^}", position) then
      position = position + 1
    else
      local depth, stop, i = 0, nil, position
      local inline = text:find("^static inline", position) ~= nil
      while i <= #text and not stop do
        if text:find("^/%*", i) then i = select(2, text:find("%*/", i)) end
        local c = text:sub(i, i)
        if c == "{" then depth = depth + 1 elseif c == "}" then depth = depth - 1 end
        if (c == ";" or inline and c == "}") and depth == 0 then stop = i end
        i = i + 1
      end
      stop = stop or #text
      local code = text:sub(position, stop - 1)
      local after, behind = trailing(stop + 1)
      declaration(header, code, position, text, joined(comment, behind))
      comment, position = "", after
    end
  end
  return header
end

return headers
