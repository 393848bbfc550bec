-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Files of CAD programs, STEP and IGES, by OpenCASCADE. Nothing of it is loaded before this file is required;
-- bw.surface.read requires it by itself when it meets such a file.
local found, occt = pcall(require, "barwright.occt")
if not found then
  local why = tostring(occt)
  why = why:find("module 'barwright.occt' not found", 1, true) and "it was built without it" or why
  error(("this barwright has no OpenCASCADE, which reads STEP and IGES files: %s. On Debian 12, "
    .. "scripts/setup --cad installs it (libocct-data-exchange-dev) and builds again; or export a triangle mesh "
    .. "(STL)"):format(why), 0)
end
return {version = occt.version}
