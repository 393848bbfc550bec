-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Which surface the mesh of a part was filled from: edit sessions edit it along with the mesh.
local core = require "barwright.core"

local original_surface = {}

local of_mesh = setmetatable({}, {__mode = "k"}) -- mesh -> surface
local of_part = setmetatable({}, {__mode = "k"}) -- part -> surface

local fill, model = core.mesh.fill, core.model

local function filled(surface, mesh, ...)
  if mesh then of_mesh[mesh] = surface end
  return mesh, ...
end

function core.mesh.fill(surface, ...)
  return filled(surface, fill(surface, ...))
end

local function made(given, part, ...)
  if part and type(given) == "table" then of_part[part] = of_mesh[rawget(given, "mesh")] end
  return part, ...
end

function core.model(given, ...)
  return made(given, model(given, ...))
end

--- The surface that the mesh of a part was filled from in this run, or nil.
function original_surface.of(part)
  return of_part[part]
end

return original_surface
