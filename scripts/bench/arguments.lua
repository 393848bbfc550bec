-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Command lines of the scripts that measure: what is not known is refused (exit status 2), so that a
-- slip of the pen does not start a long run.
local suggestion = require "barwright.core".suggestion

--- {name = value} of `arg`: `known` has true for a flag, "value" for an option with a text, and a number for an
--- option with a number (an integer where it is one) and this default.
return function(known)
  local names, opts, i = {}, {}, 1
  for name, kind in pairs(known) do
    names[#names + 1] = "--" .. name
    if type(kind) == "number" then opts[name] = kind end
  end
  while arg[i] do
    local name = arg[i]:match "^%-%-(.+)$"
    local kind = name and known[name]
    local value = kind == true or arg[i + 1]
    if math.type(kind) == "integer" then
      value = math.tointeger(tonumber(value))
    elseif kind and kind ~= true and kind ~= "value" then
      value = tonumber(value)
    end
    local fault = not kind and ("'%s' is not known: %s"):format(arg[i],
      suggestion(arg[i], names)) or not value and ("option --%s: %s expected"):format(name,
      kind == "value" and "a value" or math.type(kind) == "integer" and "an integer" or "a number")
    if fault then
      io.stderr:write(arg[0], ": ", fault, "\n")
      os.exit(2, true)
    end
    opts[name] = value
    i = i + (kind == true and 1 or 2)
  end
  return opts
end
