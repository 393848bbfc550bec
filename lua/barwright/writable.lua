-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Whether a file can be written at a path, known before the work and not after it.
local core = require "barwright.core"

local IS_A_FOLDER = 21 -- EISDIR

--- true, or nil, a message and details.
return function(path)
  local there <close> = io.open(path, "rb")
  if there and select(3, there:read(0)) == IS_A_FOLDER then
    return nil, path .. ": cannot be written: it is a folder", {status = "io", file = path}
  end
  local probe <close>, message, details = core.temporary(path)
  if probe then return true end
  return nil, message, details
end
