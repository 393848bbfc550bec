-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
--- The bytes of a file, or nil and why there are none.
return function(path)
  local file, why = io.open(path, "rb")
  if not file then return nil, why end
  local text, reason = file:read "a"
  file:close()
  if not text then return nil, ("%s: %s"):format(path, reason) end
  return text
end
