-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Command lines of the scripts that measure: what is not known is refused (exit status 2), so that a
-- slip of the pen does not start a long run.
local suggestion = require "barwright.core".suggestion

--- {name = value} of `arg`: `known` has true for a flag and "value" for an option with one.
return function(known)
  local names, wish, i = {}, {}, 1
  for name in pairs(known) do names[#names + 1] = "--" .. name end
  while arg[i] do
    local name = arg[i]:match "^%-%-(.+)$"
    local kind = name and known[name]
    local fault = not kind and ("'%s' is not known: %s"):format(arg[i],
      suggestion(arg[i], names)) or kind == "value" and not arg[i + 1]
      and ("option --%s: a value expected"):format(name)
    if fault then
      io.stderr:write(arg[0], ": ", fault, "\n")
      os.exit(2, true)
    end
    wish[name] = kind == "value" and arg[i + 1] or true
    i = i + (kind == "value" and 2 or 1)
  end
  return wish
end
