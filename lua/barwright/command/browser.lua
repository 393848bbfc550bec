-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Opens a page of this machine in the browser. Through a file in a folder that only this user can read: arguments
-- of programs can be read by others, and who knows the address can edit.
local core = require "barwright.core"

local browser = {}

--- Opens an address; the folder to be closed at the end, or nil where there is no display.
function browser.open(address)
  if not (os.getenv "DISPLAY" or os.getenv "WAYLAND_DISPLAY") then return end
  local temporary = core.temporary_folder()
  if not temporary then return end
  local path = temporary.path .. "/live.html"
  local file = io.open(path, "wb")
  if not file then return end
  file:write('<!doctype html><meta name="referrer" content="no-referrer">',
    '<meta http-equiv="refresh" content="0; url=', address, '">')
  file:close()
  os.execute(("xdg-open '%s' >/dev/null 2>&1 &"):format(path))
  return temporary
end

return browser
