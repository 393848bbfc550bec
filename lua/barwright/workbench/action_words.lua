-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The actions of a workbench in words, as "Undone: the push of plane 1 by 2 mm." names them.
local core = require "barwright.core"
local file_unit = require "barwright.command.file_unit"
local shown = require "barwright.shown"

local function size(vector, unit)
  return core.quantity(math.sqrt(vector[1] ^ 2 + vector[2] ^ 2 + vector[3] ^ 2), unit)
end

local function length(metres) return core.quantity(metres, "m") end

-- The faces of a body by name, or how many they are.
local function of_faces(body, faces)
  if #faces > 2 then return ("%d faces"):format(#faces) end
  local names = {}
  for i, face in ipairs(faces) do names[i] = body.faces[face].name end
  return table.concat(names, " and ")
end

local kinds = {all = "fixed support", normal = "sliding support", force = "force", pressure = "pressure",
  moment = "moment", gravity = "gravity"}

-- A support or a load that an entry has.
local function condition(entry, number)
  local one = entry.conditions[number]
  if not one.faces then return kinds[one.kind] end
  return ("the %s on %s"):format(kinds[one.kind], of_faces(entry.body, one.faces))
end

-- The faces of one set that are not in another, in order.
local function without(set, other)
  local list = {}
  for face in pairs(set) do
    if not other[face] then list[#list + 1] = face end
  end
  table.sort(list)
  return list
end

-- Locks replace all those before: the words are of the faces that differ.
local function locks(given, before)
  local set, out = {}, {}
  for _, face in ipairs(given.faces) do set[face] = true end
  local added, removed = without(set, before.locked), without(before.locked, set)
  if #added > 0 then out[1] = "the lock of " .. of_faces(before.body, added) end
  if #removed > 0 then out[#out + 1] = "the unlocking of " .. of_faces(before.body, removed) end
  return #out > 0 and table.concat(out, " and ") or "the unchanged locks"
end

-- By action: its options, and the entry before it.
local words = {
  fix = function(given, before)
    return ("the %s of %s"):format(kinds[given.kind], of_faces(before.body, given.faces))
  end,
  load = function(given, before)
    return ("the force of %s on %s"):format(size(given.force, "N"), of_faces(before.body, given.faces))
  end,
  moment = function(given, before)
    return ("the moment of %s on %s"):format(size(given.moment, "N m"), of_faces(before.body, given.faces))
  end,
  pressure = function(given, before)
    return ("the pressure of %s on %s"):format(core.quantity(given.pressure, "Pa"),
      of_faces(before.body, given.faces))
  end,
  gravity = function() return "gravity" end,
  change = function(given, before) return "the change of " .. condition(before, given.condition) end,
  remove = function(given, before) return "the removal of " .. condition(before, given.condition) end,
  material = function(given) return "the material " .. (given.name or "of own values") end,
  lock = locks,
  grow = function() return "the patch" end,
  patch = function() return "the faces in the rectangle" end,
  symmetry = function(given) return given.across == "none" and "the end of symmetry" or "symmetry" end,
  unit = function(given) return "the unit " .. file_unit.words[given.unit] end,
  thickness = function(given) return "the thickness of " .. length(given.thickness) end,
  push = function(given, before)
    return ("the push of %s by %s"):format(of_faces(before.body, given.faces), length(given.distance))
  end,
  radius = function(given, before)
    return ("the radius of %s of %s"):format(length(given.radius), before.body.faces[given.face].name)
  end,
  offset = function(given) return "the offset by " .. length(given.distance) end,
  thicken = function(given)
    return ("the thickening by %s at %s"):format(shown.estimate(given.offset, "m"), core.point(given.at))
  end,
  optimise = function() return "the optimisation" end,
}

--- An action with its options in words. before: the entry that it started from.
return function(name, given, before)
  return words[name](given, before)
end
