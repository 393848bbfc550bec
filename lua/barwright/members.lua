-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- __index of classes in Lua: methods, then properties (functions of the object); any other name is an
-- error that says what is known.
local core = require "barwright.core"

local raise = core.raise

return function(what, class, properties)
  return function(self, name)
    local method = class[name]
    if method ~= nil then return method end
    local property = properties[name]
    if property then return property(self) end
    local names = {}
    for key in pairs(properties) do names[#names + 1] = key end
    for key in pairs(class) do
      if not key:find "^__" then names[#names + 1] = key end
    end
    raise(("%s has no '%s': %s"):format(what, tostring(name),
      core.suggestion(tostring(name), names)))
  end
end
