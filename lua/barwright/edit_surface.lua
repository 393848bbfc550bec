-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The surface of an edit session: the one that the mesh was made from, moved as the mesh was, or the mesh's
-- boundary. docs/theory/edit.md, "The original surface", has the mathematics.
local core = require "barwright.core"

local report = {__name = "barwright.edited_surface"}
report.__index = report

function report:__tostring()
  local text = ("%d triangles, %d before; moved by up to %s; %s from the boundary of the mesh at most"):format(
    self.triangles, self.triangles_before, core.quantity(self.largest_displacement, "m"),
    core.quantity(self.deviation, "m"))
  return self.sound and text .. "; closed and free of crossings"
    or text .. "; the result is not closed or crosses itself: make the edit smaller, or print `surface:check()`"
end

local edit_surface = {}

--- The surface of a shape and a report. `original`: what the mesh was made from, or nil for the mesh's boundary.
function edit_surface.of(shape, original)
  local boundary, nodes, details = shape.mesh:surface()
  if not boundary then return nil, nodes, details end
  local surface, moved = boundary
  if original then
    surface, moved, details = shape.topology.subdomains:posed_surface(shape.maps, original)
    if not surface then return nil, moved, details end
  else
    local rest = shape.topology.mesh.nodes:gather(nodes)
    moved = core.array.map("norm(a)", {a = boundary.points - rest}):max()
  end
  local deviation, checked, message = 0
  if original then
    deviation, message, details = surface:distance(boundary)
    if not deviation then return nil, message, details end
  end
  checked, message, details = surface:check {limit = 1}
  if not checked then return nil, message, details end
  return surface, setmetatable({triangles = surface.triangle_count,
    triangles_before = (original or boundary).triangle_count, largest_displacement = moved, deviation = deviation,
    sound = checked.sound}, report)
end

return edit_surface
