-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Weak places over a sequence of meshes: {places, utilisation} each, places weakest first, each with `at`,
-- `utilisation`, `refined` (this mesh has short edges there) and `settled` (this mesh or one before it).
local distance = require("barwright.points").distance

local weak_places = {}

--- The fraction of the largest mean stress from which a place that no mesh has refined may be the weakest.
weak_places.NEARLY = 0.6
-- Once the growth of the mean stress was seen at so many places that a mesh refined, the largest one counts
-- instead of 1 / NEARLY, but at least this.
local GROWN, MIN_GROWTH = 3, 1.15

-- The weakest place of a list near a point that no mesh had refined.
local function unrefined_near(list, at, length)
  for _, place in ipairs(list) do
    if not place.settled and distance(place.at, at) <= length then return place end
  end
end

--- By which factor the mean stress of a place may grow when it is refined: what was seen between meshes of the
--- same kind, which the first one is not. `length`: places within it are one.
function weak_places.growth(levels, length)
  local max, seen, count = MIN_GROWTH, {}, 0
  for k = 2, #levels - 1 do
    for _, place in ipairs(levels[k + 1].places) do
      local former = place.refined and unrefined_near(levels[k].places, place.at, length)
      if former and not seen[former] then
        seen[former], count = true, count + 1
        max = math.max(max, place.utilisation / former.utilisation)
      end
    end
  end
  local unknown = 1 / weak_places.NEARLY
  return count < GROWN and unknown or math.min(max, unknown)
end

--- Places of the last mesh that may be the weakest once they are refined, and by which factor their stress may
--- grow.
function weak_places.unsettled(levels, length)
  local last, factor, list = levels[#levels], weak_places.growth(levels, length), {}
  for _, place in ipairs(last.places) do
    if not place.settled and factor * place.utilisation >= last.utilisation then list[#list + 1] = place end
  end
  return list, factor
end

--- Places of all meshes that were refined there, those of the last mesh first.
function weak_places.settled(levels)
  local list = {}
  for k = #levels, 1, -1 do
    for _, place in ipairs(levels[k].places) do
      if place.refined then list[#list + 1] = place end
    end
  end
  return list
end

return weak_places
