-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The mirror images of faces and points of a body that is symmetric across an axis.
local distance = require("barwright.points").distance
local model = require "barwright.command.model"

local mirror = {}

local number = {x = 1, y = 2, z = 3}
local sides = {x = "left and the right", y = "front and the back", z = "top and the bottom"}

-- Faces are images of each other where their centres are so near, over the diagonal, and their areas, over the
-- area.
local NEAR, ALIKE = 2e-3, 0.02
-- A face smaller than this, over the largest, may lack its image.
local SMALL = 1e-3

--- The mirror image of a point across the middle of a body.
function mirror.point(self, across, at)
  local k, box, out = number[across], self.surface.box, {at[1], at[2], at[3]}
  out[k] = box.min[k] + box.max[k] - at[k]
  return out
end

--- The face that is the image of a face, which may be itself; nil where there is none.
function mirror.face(self, across, face)
  local one, best, min = self.faces[face], nil, NEAR * model.diagonal(self.surface.box)
  local at = mirror.point(self, across, one.centre)
  for i, other in ipairs(self.faces) do
    local away = distance(other.centre, at)
    if other.kind == one.kind and math.abs(other.area - one.area) <= ALIKE * one.area and away <= min then
      best, min = i, away
    end
  end
  return best
end

--- Why a body is not symmetric, in a sentence; nil where it is.
function mirror.fault(self, across)
  local largest = 0
  for _, face in ipairs(self.faces) do largest = math.max(largest, face.area) end
  for i, face in ipairs(self.faces) do
    if face.area >= SMALL * largest and not mirror.face(self, across, i) then
      return ("The %s of the part are no mirror images: nothing lies opposite %s."):format(sides[across],
        face.name)
    end
  end
end

return mirror
