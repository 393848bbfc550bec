-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Where the project and its models are.
local project = {}

project.root = debug.getinfo(1, "S").source:match "^@(.*)/scenarios/verification/lib/project%.lua$" or "."

--- Lets `require` find the modules of scripts/NAME.
function project.use(name)
  package.path = ("%s/scripts/%s/?.lua;%s"):format(project.root, name, package.path)
end

--- The folder of models that do not come with the project, and the names of those in it that can be
--- read as surfaces; ends the scenario where there are none.
function project.models(t)
  local folder = (os.getenv "BARWRIGHT_SHARED" or project.root .. "/../shared") .. "/models"
  local formats = {stl = true, obj = true, ply = true, off = true, msh = true, vtu = true}
  local list, names = io.popen(("LC_ALL=C ls '%s' 2>/dev/null"):format(folder)), {}
  for name in list:lines() do
    if formats[name:match "%.(%a+)$" or ""] then names[#names + 1] = name end
  end
  list:close()
  if #names == 0 then t:skip("no models in " .. folder:gsub("^.*/%.%./", "../")) end
  return folder, names
end

return project
