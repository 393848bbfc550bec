-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Whether the place of the largest stress is singular: by geometry, by the growth of the stress under refinement,
-- or by both. docs/theory/singular.md.
local core = require "barwright.core"
require "barwright.singular"

local growth = {}

local finding = {}
finding.__index = finding
finding.__name = "barwright.singular_finding"

--- Stresses that grow faster than h^-ALONE have no finite value, also without a known place; it is h^-0.45 at a
--- re-entrant edge of 90 degrees.
growth.ALONE = 0.3
-- With a known place so much of the growth that is expected there confirms it.
local CONFIRMS = 0.5
-- The edge lengths of two meshes that show a growth differ by at least this factor.
local FINER = 1.15
-- A place within so many edge lengths of elements is the place of the largest stress.
local NEAR = 0.75

local ends = {{1, 2}, {2, 3}, {3, 1}, {1, 4}, {2, 4}, {3, 4}}

-- The mean part of a vector of length one across a direction, over all directions.
local ACROSS = math.pi / 4

--- The mean edge length of the element at a point; across a unit vector, where elements may be long along it.
function growth.edge_length(mesh, point, direction)
  local element, sum = mesh:locate(point), 0
  for _, pair in ipairs(ends) do
    local a, b, square, along = mesh.elements(element, pair[1]), mesh.elements(element, pair[2]), 0, 0
    for k = 1, 3 do
      local x = mesh.nodes(a, k) - mesh.nodes(b, k)
      square, along = square + x ^ 2, along + (direction and x * direction[k] or 0)
    end
    sum = sum + math.sqrt(math.max(square - along ^ 2, 0))
  end
  return sum / (direction and 6 * ACROSS or 6)
end

--- The exponent p of a value that grows like h^-p from one {value, edge} to a finer one; nil where the edges
--- do not differ.
function growth.exponent(coarse, fine)
  if not (coarse and fine) or coarse.edge < FINER * fine.edge then return nil end
  if coarse.value <= 0 or fine.value <= 0 then return nil end
  return math.log(fine.value / coarse.value) / math.log(coarse.edge / fine.edge)
end

--- Within how far of the node of the largest stress a place is the place of it.
function growth.radius(edge)
  return NEAR * edge
end

--- Whether the stress at a point has no finite value: {by, place, at, expected, measured}, or nil. `places`: of
--- the model or surface, or nil; one within `radius` counts; `measured`: growth.exponent; `grows`: the stress is
--- known to grow without end otherwise.
function growth.check(places, at, radius, measured, grows)
  local found = places and places:near(at, radius)
  local expected = found and found.place.growth
  grows = grows or measured ~= nil and measured > (found and CONFIRMS * math.min(expected, 1) or growth.ALONE)
  if not (found or grows) then return nil end
  return setmetatable({by = found and (grows and "geometry and growth" or "geometry") or "growth",
    place = found and found.place, at = found and found.at or at, expected = expected, measured = measured},
    finding)
end

--- The finding that materials meet at the surface at a point: whether the stress grows there is not known.
function growth.meeting(at)
  return setmetatable({by = "materials", at = at}, finding)
end

local function describe(self)
  local place = self.place
  if not place then return "no re-entrant edge, support border or point load is known there" end
  local angle = place.angle and (" of %.4g degrees inside the material"):format(180 / math.pi * place.angle)
  return ("it is at a %s%s at %s"):format(place.kind, angle or "", core.point(self.at))
end

function finding:__tostring()
  if self.by == "materials" then
    return ("the largest stress may have no finite value: different materials meet at the surface at %s"):format(
      core.point(self.at))
  end
  local rates = {}
  if self.expected then rates[1] = ("h^%.4g expected"):format(-self.expected) end
  if self.measured then rates[#rates + 1] = ("h^%.2g measured"):format(-self.measured) end
  return ("the largest stress has no finite value: %s (by %s%s)"):format(describe(self), self.by,
    #rates > 0 and "; " .. table.concat(rates, ", ") or "")
end

return growth
