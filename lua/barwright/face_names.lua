-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Names of faces of surfaces that are made again in Lua: what moves points keeps the names of facets.
local core = require "barwright.core"

local face_names = {}

--- The group of each facet and the names of groups, as `bw.surface.new` takes them; nil where there are no groups.
function face_names.of(surface)
  local groups = surface.groups
  if groups then return groups, surface:face_names() end
end

--- The surface with other points, and the same triangles and names; or nil, message, details.
function face_names.moved(surface, points)
  local groups, names = face_names.of(surface)
  return core.surface.new {points = points, triangles = surface.triangles, groups = groups, face_names = names}
end

return face_names
