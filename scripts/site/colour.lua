-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Lua source as HTML: comments, texts, numbers and reserved words each in a span of their class.
local colour = {}

local reserved = {}
for word in ([[and break do else elseif end false for function goto if in local nil not or repeat return then
  true until while]]):gmatch "%a+" do reserved[word] = true end

-- The end of what begins at `i`, and its class; nil for anything else than these.
local function token(source, i)
  local equals = source:match("^%-%-%[(=*)%[", i)
  if equals then return select(2, source:find("]" .. equals .. "]", i, true)) or #source, "comment" end
  local _, last = source:find("^%-%-[^\n]*", i)
  if last then return last, "comment" end
  equals = source:match("^%[(=*)%[", i)
  if equals then return select(2, source:find("]" .. equals .. "]", i, true)) or #source, "text" end
  local quote = source:match("^[\"']", i)
  if quote then
    local at = i + 1
    while at <= #source do
      local sign = source:sub(at, at)
      if sign == "\\" then
        at = at + 1
      elseif sign == quote or sign == "\n" then
        break
      end
      at = at + 1
    end
    return math.min(at, #source), "text"
  end
  _, last = source:find("^[%a_][%w_]*", i)
  if last then return last, reserved[source:sub(i, last)] and "word" or "name" end
  _, last = source:find("^%d[%w.]*[eE][+-]%d+", i)
  if not last then _, last = source:find("^%d[%w.]*", i) end
  if last then return last, "number" end
end

--- Lua as HTML; `escape` does it for the rest.
function colour.lua(source, escape)
  local out, i = {}, 1
  while i <= #source do
    local last, class = token(source, i)
    last = last or i
    local text = escape(source:sub(i, last))
    out[#out + 1] = class and class ~= "name" and ('<span class="%s">%s</span>'):format(class, text) or text
    i = last + 1
  end
  return table.concat(out)
end

return colour
