-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a page of the workbench shows, as a plain table.
local body = require "barwright.workbench.body"
local core = require "barwright.core"
local json = require "barwright.json"
local model = require "barwright.command.model"
local shown = require "barwright.shown"

local words = {all = "fixed", normal = "sliding", force = "force", pressure = "pressure",
  moment = "moment", gravity = "gravity"}
local dimension = {force = "N", moment = "N m", gravity = "m/s2"}

local function place_of(part, faces)
  local sum, area, list = {0, 0, 0}, 0, {}
  for i, face in ipairs(faces) do
    local about = part.faces[face]
    list[i] = about.name
    area = area + about.area
    for k = 1, 3 do sum[k] = sum[k] + about.area * about.centre[k] end
  end
  for k = 1, 3 do sum[k] = area > 0 and sum[k] / area or 0 end
  return sum, table.concat(list, ", ")
end

local function conditions_of(entry)
  local list = json.list {}
  for i, condition in ipairs(entry.conditions) do
    local at, where = place_of(entry.body, condition.faces or {})
    local text = words[condition.kind]
    if condition.vector then text = text .. " " .. shown.vector(condition.vector, dimension[condition.kind]) end
    if condition.value then text = text .. " " .. core.quantity(condition.value, "Pa") end
    list[i] = {index = i, kind = condition.kind, faces = json.list(condition.faces or {}),
      vector = condition.vector, value = condition.value, at = condition.faces and at or nil,
      text = condition.faces and ("%s on %s"):format(text, where) or text .. " on the whole part"}
  end
  return list
end

local function faces_of(entry)
  local list = json.list {}
  for i, face in ipairs(entry.body.faces) do
    list[i] = {index = i, name = face.name, kind = face.kind, area = face.area, radius = face.radius,
      centre = face.centre, normal = face.normal, axis = face.axis, locked = entry.locked[i] or false}
  end
  return list
end

local function plain(value)
  return type(value) == "number" and value or nil
end

local function material_of(material)
  return {name = material.name, young = plain(material.young), poisson = plain(material.poisson),
    strength = plain(material.strength), density = plain(material.density)}
end

local function answer_of(entry)
  local answer = entry.answer
  if not answer then return nil end
  local out = {}
  for key, value in pairs(answer) do out[key] = value end
  out.notes = json.list(answer.notes)
  return out
end

--- The state of a workbench, with the lines of its script and the deviation of an edited part.
return function(self, script, deviation)
  local entry = self:current()
  local source = entry and entry.source or self.source
  local read = source.read
  local out = {type = "state", revision = self.revision, file = model.name(self.path),
    format = read.format, unit = model.unit_of(read, {unit = source.unit}), units_plausible = source.doubt == nil,
    units_message = source.doubt, units_likely = source.likely and json.list(source.likely) or nil,
    saved = self.saved or false, size = body.size(entry and entry.body.surface.box or read.surface.box)}
  if not entry then return out end
  local volume = entry.body.surface.volume
  out.repair = {sound = entry.body.sound, log = json.list(entry.body.log)}
  out.faces, out.conditions = faces_of(entry), conditions_of(entry)
  out.material, out.materials = material_of(entry.material), json.list(core.material.names())
  out.thickness = read.thickness
  out.mass = entry.material.density and entry.material.density * volume or nil
  out.volume = volume
  out.script = json.list(script)
  out.undo, out.redo = self.position > 1, self.position < #self.history
  out.undo_words, out.redo_words = out.undo and entry.words or nil,
    out.redo and self.history[self.position + 1].words or nil
  out.answer, out.note, out.symmetry = answer_of(entry), entry.note, entry.symmetry or "none"
  out.deviation = deviation and {text = tostring(deviation), largest = deviation.largest, at = deviation.at,
    unmoved = deviation.unmoved, points = deviation.points}
  out.grown_faces = json.list(self.grown_faces or {})
  out.advice = json.list {}
  for i, place in ipairs(entry.advice or {}) do
    out.advice[i] = {text = place.text, at = place.at, gain = place.gain}
  end
  return out
end
