-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Surfaces of solids from sections: polygons at one place after another, joined by sides and closed by caps.
local core = require "barwright.core"
local profile = require "barwright.modeller.profile"

local sections = {}
sections.__index = sections

--- An empty solid.
function sections.new()
  return setmetatable({points = {}, triangles = {}, groups = {}, names = {}, number = {}, curved = {}},
    sections)
end

--- Tells that a face has triangles that stand for a curved one.
function sections:curve(name) self.curved[name] = true end

--- Adds a point {x, y, z}; its number.
function sections:point(at)
  self.points[#self.points + 1] = at
  return #self.points
end

--- Adds a triangle of a face; none where it has no area because corners are one point.
function sections:triangle(name, a, b, c)
  if a == b or b == c or c == a then return end
  if not self.number[name] then
    self.names[#self.names + 1] = name
    self.number[name] = #self.names
  end
  self.triangles[#self.triangles + 1] = {a, b, c}
  self.groups[#self.groups + 1] = self.number[name]
end

--- Joins two sections, lists of numbers of points, of which `to` lies in front of `from`, by the sides of the
--- polygons.
function sections:join(polygons, from, to)
  local first = 0
  for _, polygon in ipairs(polygons) do
    local count = #polygon.points
    for i = 1, count do
      local a, b = first + i, first + i % count + 1
      if polygon.curved and polygon.curved[i] then self:curve(polygon.tags[i]) end
      self:triangle(polygon.tags[i], from[a], from[b], to[b])
      self:triangle(polygon.tags[i], from[a], to[b], to[a])
    end
    first = first + count
  end
end

--- Closes a section; `behind` where the solid lies in front of it.
function sections:cap(name, section, triangles, behind)
  for _, t in ipairs(triangles) do
    self:triangle(name, section[t[1]], section[t[behind and 3 or 2]], section[t[behind and 2 or 3]])
  end
end

--- The solid whose sections lie one in front of the other: lists of numbers of points. It is closed in a ring, or
--- has the caps "start" and "end". Returns the surface, or nil, message, details.
function sections:through(polygons, list, ring)
  local triangles, message, details = profile.triangles(polygons)
  if not triangles then return nil, message, details end
  if not ring then
    self:cap("start", list[1], triangles, true)
    self:cap("end", list[#list], triangles, false)
  end
  for i = 1, #list - 1 do self:join(polygons, list[i], list[i + 1]) end
  if ring then self:join(polygons, list[#list], list[1]) end
  return self:surface()
end

--- The surface, or nil, message, details.
function sections:surface()
  local curved = {}
  for _, name in ipairs(self.names) do
    if self.curved[name] then curved[#curved + 1] = name end
  end
  return core.surface.new {points = self.points, triangles = self.triangles, groups = self.groups,
    face_names = self.names, curved_faces = curved}
end

return sections
