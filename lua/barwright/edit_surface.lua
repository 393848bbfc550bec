-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The surface of an edit session: the one that the mesh was made from, moved as the mesh was, or the mesh's
-- boundary. docs/theory/edit.md, "The original surface", has the mathematics.
local core = require "barwright.core"

local report = {__name = "barwright.edited_surface"}
report.__index = report

local function counted(count, one, many)
  return ("%d %s"):format(count, count == 1 and one or many)
end

-- What is wrong with the result, and what was done about it.
local function judgement(self)
  if self.defects_of_original then
    return ("the edit gives the original surface %s (crossings, triangles without area), so this is the boundary "
      .. "of the analysed mesh, without the detail of the original: make the edit smaller to get that"):format(
      counted(self.defects_of_original, "defect", "defects"))
  elseif self.sound then
    return "closed and free of crossings"
  elseif self.defects_before > 0 then
    return ("it has %s; before the edit it had %d: `surface:repair()` before the mesh is filled corrects that")
      :format(counted(self.defects, "defect", "defects"), self.defects_before)
  end
  return ("it has %s (crossings, triangles without area), none before the edit, and the boundary of the analysed "
    .. "mesh crosses itself as well: make the edit smaller"):format(counted(self.defects, "defect", "defects"))
end

function report:__tostring()
  return ("%d triangles, %d before; moved by up to %s; %s from the boundary of the mesh at most; %s"):format(
    self.triangles, self.triangles_before, core.quantity(self.largest_displacement, "m"),
    core.quantity(self.deviation, "m"), judgement(self))
end

local edit_surface = {}

-- How many defects a surface has, or nil, message, details.
local function defects_of(surface)
  local checked, message, details = surface:check {limit = 1}
  if not checked then return nil, message, details end
  local count = 0
  for _, of_kind in pairs(checked.count) do count = count + of_kind end
  return count
end

-- The original surface moved along, and its report.
local function posed(shape, original, boundary)
  local surface, moved, details = shape.topology.subdomains:posed_surface(shape.maps, original)
  if not surface then return nil, moved, details end
  local deviation, before, after, message
  deviation, message, details = surface:distance(boundary)
  if not deviation then return nil, message, details end
  after, message, details = defects_of(surface)
  if not after then return nil, message, details end
  before = after
  if after > 0 then
    before, message, details = defects_of(original)
    if not before then return nil, message, details end
  end
  return surface, {source = "original", triangles = surface.triangle_count,
    triangles_before = original.triangle_count, largest_displacement = moved,
    deviation = deviation, defects = after, defects_before = before}
end

-- The boundary of the mesh and its report.
local function bounding(shape, boundary, nodes)
  local rest = shape.topology.mesh.nodes:gather(nodes)
  local after, message, details = defects_of(boundary)
  if not after then return nil, message, details end
  return boundary, {source = "boundary", triangles = boundary.triangle_count,
    triangles_before = boundary.triangle_count, deviation = 0, defects = after, defects_before = 0,
    largest_displacement = core.array.map("norm(a)", {a = boundary.points - rest}):max()}
end

--- The surface of a shape and a report. `original`: what the mesh was made from, or nil or false for the mesh's
--- boundary, which also comes where the edit makes the original cross itself and the boundary does not.
function edit_surface.of(shape, original)
  local boundary, nodes, details = shape.mesh:surface()
  if not boundary then return nil, nodes, details end
  local surface, about
  if original then
    surface, about, details = posed(shape, original, boundary)
    if not surface then return nil, about, details end
  end
  if not original or about.defects > 0 and about.defects_before == 0 then
    local other, other_about
    other, other_about, details = bounding(shape, boundary, nodes)
    if not other then return nil, other_about, details end
    if not original or other_about.defects == 0 then
      other_about.defects_of_original = about and about.defects
      surface, about = other, other_about
    end
  end
  about.sound = about.defects == 0
  return surface, setmetatable(about, report)
end

return edit_surface
