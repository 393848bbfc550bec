-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Files that go with the Lua files: page templates and the scripts bundled for them. They lie beside
-- this file when installed; in a build tree, where this file is seen through the link
-- build/lua/barwright/beside.lua, bundles lie in build/web.
local read_file = require "barwright.read_file"

local folder = debug.getinfo(1, "S").source:match "^@(.*)[/\\][^/\\]*$" or "."

local beside = {}

--- The bytes of a page template or bundle, or nil where it was not made.
function beside.find(name)
  return read_file(folder .. "/" .. name) or read_file(folder .. "/../../web/" .. name)
end

return beside
