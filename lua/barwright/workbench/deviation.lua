-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How far an edited surface lies from the original, where, and which points have not moved by a single bit.
local core = require "barwright.core"
local model = require "barwright.command.model"

local report = {__name = "barwright.workbench_deviation"}
report.__index = report

function report:__tostring()
  local unmoved = ("%d of %d points of the original are where they were, bit for bit"):format(self.unmoved,
    self.points)
  if self.largest == 0 then return "The shape is the original: " .. unmoved .. "." end
  return ("At most %s from the original, at %s; %s."):format(core.quantity(self.largest, "m"), core.point(self.at),
    unmoved)
end

local BYTES = 24 -- of a point

-- The rows of the points of a surface that are no points of another one, bit for bit.
local function moved_rows(surface, other)
  local bytes, of_other, known, rows = surface.points:tostring "<f8", other.points:tostring "<f8", {}, {}
  for at = 1, #of_other, BYTES do known[of_other:sub(at, at + BYTES - 1)] = true end
  for at = 1, #bytes, BYTES do
    if not known[bytes:sub(at, at + BYTES - 1)] then rows[#rows + 1] = (at - 1) // BYTES + 1 end
  end
  return rows
end

-- The largest distance of some points of a surface from another one, and where; 0 without points.
local function largest(surface, rows, other)
  if #rows == 0 then return 0 end
  local points = surface.points:gather(core.array.new(rows, "i32"))
  local away, message, details = model.try(other.distance, other, points)
  if not away then return nil, message, details end
  local row = away:argmax()
  return away(row), {points(row, 1), points(row, 2), points(row, 3)}
end

-- Reports of surfaces beside the original that they were compared with.
local made = setmetatable({}, {__mode = "k"})

--- The deviation of a surface from the original: {largest (m), at, unmoved = how many points of the original it
--- has, points = of the original}; or nil, message, details.
return function(surface, original)
  local known = made[surface]
  if known and known.original == original then return known.report end
  local out = setmetatable({largest = 0, unmoved = original.point_count, points = original.point_count}, report)
  if surface ~= original then
    local before = moved_rows(original, surface)
    out.unmoved = out.points - #before
    for _, pair in ipairs {{surface, moved_rows(surface, original), original}, {original, before, surface}} do
      local away, at, details = largest(table.unpack(pair))
      if not away then return nil, at, details end
      if away > out.largest then out.largest, out.at = away, at end
    end
  end
  made[surface] = {original = original, report = out}
  return out
end
