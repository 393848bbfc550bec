-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Text for files that others read: only whole characters, escaped for XML (for HTML: html.lua).
local text = {}

-- Whether XML 1.0 may hold the character.
local function allowed(code)
  return code == 9 or code == 10 or code == 13 or code >= 0x20 and code <= 0xD7FF
    or code >= 0xE000 and code <= 0xFFFD or code >= 0x10000 and code <= 0x10FFFF
end

local REPLACEMENT <const> = "\u{FFFD}"

--- Any bytes as UTF-8 that XML may hold: what is not a character there becomes U+FFFD.
function text.clean(bytes)
  if not bytes:find "[^\t\n\r -~]" then return bytes end
  local out, at = {}, 1
  while at <= #bytes do
    local stop = select(2, utf8.len(bytes, at)) or #bytes + 1 -- the first byte that is not UTF-8
    for _, code in utf8.codes(bytes:sub(at, stop - 1)) do
      out[#out + 1] = allowed(code) and utf8.char(code) or REPLACEMENT
    end
    if stop <= #bytes then out[#out + 1] = REPLACEMENT end
    at = stop + 1
  end
  return table.concat(out)
end

--- Every text in a table of plain data, cleaned in place.
function text.clean_all(value)
  for key, item in pairs(value) do
    if type(item) == "string" then value[key] = text.clean(item)
    elseif type(item) == "table" then text.clean_all(item) end
  end
  return value
end

local xml = {["&"] = "&amp;", ["<"] = "&lt;", [">"] = "&gt;", ['"'] = "&quot;", ["'"] = "&apos;",
  ["\n"] = "&#10;", ["\r"] = "&#13;", ["\t"] = "&#9;"}

--- For attributes and text of XML.
function text.xml(bytes)
  return (text.clean(bytes):gsub("[&<>\"'\n\r\t]", xml))
end

return text
