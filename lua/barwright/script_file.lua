-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A body or a drawing where a script is expected is an easy mistake, and no syntax error.

local endings = {stl = true, obj = true, off = true, ply = true, msh = true, vtu = true, pvtu = true, mesh = true,
  inp = true, svg = true, dxf = true, ["3mf"] = true, glb = true, gltf = true, step = true, stp = true,
  iges = true, igs = true}

local script_file = {}

--- A sentence where the ending of a path says that it is no script.
function script_file.refusal(path)
  local ending = (path:match "%.(%w+)$" or ""):lower()
  if endings[ending] then
    return ("%s is no script: `barwright check %s` describes it"):format(path, path)
  end
end

return script_file
