-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The part of a stress's error that comes from facets which stand for a round face.
-- docs/theory/error_control.md, term G.
local core = require "barwright.core"
local distance = require("barwright.points").distance

-- Normals of facets that differ by more than this (radians) are at a sharp edge, which is meant.
local SHARP = 0.6

--- The error of a stress at a point, as a fraction of it, 0 inside of the body: it changes by about 2/pi of the
--- angle of a concave kink each time that the mesh becomes finer by e. The largest kink within the radius counts.
return function(mesh, at, radius)
  local boundary, kink = mesh.boundary, 0
  local node = boundary:nearest(at, 1).nodes[1]
  if distance({mesh.nodes(node, 1), mesh.nodes(node, 2), mesh.nodes(node, 3)}, at) > radius then return 0 end
  for _, near in ipairs(boundary:near(at, radius).nodes:totable()) do
    local angle, message, details = core.boundary_kink(mesh, near, SHARP)
    if not angle then return nil, message, details end
    kink = math.max(kink, angle)
  end
  return 2 / math.pi * kink
end
