-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Lengths in sentences of the engine, which are in m ("moved by 0.002 m", "at (0, 0.1, 0) m", "2 x 3 x 4 m"), as
-- commands print them: in mm; and areas ("2e-8 m2") in the unit that commands choose.
local core = require "barwright.core"

local NUMBER = "^[-+]?%d[%d.]*e?[-+]?%d*$"

local function in_mm(word)
  return ("%.10g"):format(1e3 * tonumber(word))
end

-- The numbers of a text between separators, all or none of them: "2 x 3" by " x ".
local function all_of(text, separator)
  local words = {}
  for word in (text .. separator):gmatch("(.-)" .. separator) do
    if not (word:match(NUMBER) and tonumber(word)) then return nil end
    words[#words + 1] = in_mm(word)
  end
  return table.concat(words, separator)
end

local function run_of(text)
  local last = text:match "[^%s]+$"
  return all_of(text, " x ") or all_of(text, " to ")
    or tonumber(last) and text:sub(1, #text - #last) .. in_mm(last) or nil
end

-- A hint for scripts, which give lengths in m; on the command line they have units.
local HINT = "; coordinates and tolerances are in metres"

--- The sentence with its lengths in mm, and its areas.
return function(text)
  local at = text:find(HINT, 1, true)
  if at then text = text:sub(1, at - 1) .. text:sub(at + #HINT) end
  text = text:gsub("%(([^()]+)%) to %(([^()]+)%) m%f[^%w_/^]", function(low, high)
    low, high = all_of(low, ", "), all_of(high, ", ")
    return low and high and ("(%s) to (%s) mm"):format(low, high)
  end)
  text = text:gsub("%(([^()]+)%) m%f[^%w_/^]", function(inner)
    local list = all_of(inner, ", ")
    return list and ("(%s) mm"):format(list)
  end)
  text = text:gsub("%f[-+%d][-+%d.e][-+%d.e xto]* m%f[^%w_/^]", function(found)
    local numbers = run_of(found:sub(1, -3))
    return numbers and numbers .. " mm"
  end)
  text = text:gsub("%f[-+%d]([-+%d][%d.e+-]*) m2%f[^%w_/^]", function(number)
    return number:match(NUMBER) and tonumber(number) and core.quantity(tonumber(number), "m2")
  end)
  return text
end
