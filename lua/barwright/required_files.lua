-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The files of modules that a script has loaded by `require`, beside those of barwright and of Lua itself.
local core = require "barwright.core"

local required_files = {}

-- Whether a module may have a file of the user: it is no part of the program and no library of Lua.
local function foreign(name, value)
  return type(name) == "string" and name ~= "_G" and _G[name] ~= value and name ~= "barwright"
    and not name:find "^barwright%."
end

--- {module, file, sha256} of each, by their names; sha256 is absent where the file is gone.
function required_files.list()
  local names, list = {}, {}
  for name, value in pairs(package.loaded) do
    if foreign(name, value) then names[#names + 1] = name end
  end
  table.sort(names)
  for _, name in ipairs(names) do
    local file = package.searchpath(name, package.path) or package.searchpath(name, package.cpath)
    if file then list[#list + 1] = {module = name, file = file, sha256 = core.sha256(file) or nil} end
  end
  return list
end

return required_files
