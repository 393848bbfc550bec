-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Whether a file can be written at a path, told before the work and not after it.
local core = require "barwright.core"

local IS_A_FOLDER = 21 -- EISDIR

--- true, or nil, a message and details.
return function(path)
  local there <close> = io.open(path, "rb")
  if there and select(3, there:read(0)) == IS_A_FOLDER then
    return nil, path .. ": cannot be written: it is a folder", {status = "io", file = path}
  end
  local probe = path .. ".probe"
  local fine, message, details = core.write_file(probe, "{}\n")
  if fine then
    os.remove(probe)
    return true
  end
  if message:sub(1, #probe) == probe then message = path .. message:sub(#probe + 1) end
  details.file = path
  return nil, message, details
end
