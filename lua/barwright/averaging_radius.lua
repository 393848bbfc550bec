-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The radius of the surface patch over which breaking forces average the stress: a length, "critical" for the
-- material's, or a fraction of the part. docs/theory/breaking_force.md.
local core = require "barwright.core"
local distance = require("barwright.points").distance

-- The default, over the diagonal of the bounding box.
local FRACTION = 0.02
-- Over the critical distance: at edges of 265 to 305 degrees the mean over this radius is that of the line method.
local CRITICAL = 0.5

local function thinnest(box)
  local min = math.huge
  for k = 1, 3 do min = math.min(min, box.max[k] - box.min[k]) end
  return min
end

local function of_material(material, box)
  local L = material.critical_distance
  if not L then
    return nil, ("length 'critical': the fracture toughness of %s is not known: give a length in m, or a material "
      .. "with strength and toughness"):format(material.name ~= "" and material.name or "the material"),
      {status = "unsupported"}
  end
  if 2 * L > thinnest(box) then
    return nil, ("length 'critical': the mean over twice the critical distance, %s, does not fit into a part "
      .. "that is %s thick: give a length"):format(core.quantity(2 * L, "m"), core.quantity(thinnest(box), "m")),
      {status = "unsupported"}
  end
  return CRITICAL * L
end

--- The radius in m that an option `length` of `where` asks for; nil, message, details where the material has none.
return function(where, length, material, box)
  if length == nil then return FRACTION * distance(box.min, box.max) end
  if length == "critical" then return of_material(material, box) end
  if type(length) ~= "number" or not (length > 0 and length < math.huge) then
    core.raise(("%s: option 'length': a length in m above 0 or 'critical' expected, got %s"):format(where,
      core.got(length)))
  end
  return length
end
