-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The actions of a workbench as lines of Lua: the same table gives the same line, and the line the same numbers.
local lines = {}

local function number(value)
  if math.type(value) == "integer" then return tostring(value) end
  for digits = 15, 17 do
    local text = ("%%.%dg"):format(digits):format(value)
    if tonumber(text) == value then return text end
  end
  return ("%a"):format(value)
end

local function text_of(value)
  if type(value) == "number" then return number(value) end
  if type(value) == "string" then return ("%q"):format(value):gsub("\\\n", "\\n") end
  if type(value) ~= "table" then return tostring(value) end
  local parts, keys = {}, {}
  for i, one in ipairs(value) do parts[i] = text_of(one) end
  for key in pairs(value) do
    if type(key) == "string" then keys[#keys + 1] = key end
  end
  table.sort(keys)
  for _, key in ipairs(keys) do parts[#parts + 1] = key .. " = " .. text_of(value[key]) end
  return "{" .. table.concat(parts, ", ") .. "}"
end

--- A value as Lua.
lines.text = text_of

--- The line of an action.
function lines.action(name, options)
  return ("assert(workbench:%s%s)"):format(name, next(options) and " " .. text_of(options) or "()")
end

--- A script that opens a file with options and repeats actions.
function lines.script(path, options, list)
  local out = {'local bw = require "barwright"',
    ("local workbench = assert(bw.workbench.open(%s%s))"):format(text_of(path),
      next(options) and ", " .. text_of(options) or "")}
  table.move(list, 1, #list, 3, out)
  out[#out + 1] = "return workbench"
  return table.concat(out, "\n") .. "\n"
end

return lines
