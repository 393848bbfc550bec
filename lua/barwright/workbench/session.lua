-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the actions of a workbench share: the entry in force, refusals, a further entry of the history, and how
-- faces and vectors are read. `history` has what the actions made so far, `position` where undo and redo are. An
-- entry stays as it was made, but for its answers: {body, source, conditions, material, material_options, locked,
-- symmetry, line, words, note, answer, ...}. `trial` is a shape that is tried (drag.lua).
local action_words = require "barwright.workbench.action_words"
local core = require "barwright.core"
local lines = require "barwright.workbench.lines"
local vectors = require "barwright.modeller.vectors"

local raise = core.raise

local session = {}

function session.now(self)
  return self.history[self.position]
end

-- Refusals of what this part, as it is, does not permit: nil, a sentence, details.
function session.refuse(text, status)
  return nil, text, {status = status or "unsupported"}
end

-- What an action made takes the place of all that was undone. `change`: what differs from the entry before.
function session.act(self, name, given, change)
  local before, entry = session.now(self), {}
  for _, key in ipairs {"body", "source", "conditions", "material", "material_options", "locked", "symmetry"} do
    entry[key] = before[key]
    if change[key] ~= nil then entry[key] = change[key] end
  end
  entry.line, entry.words, entry.note = lines.action(name, given), action_words(name, given, before), change.note
  self.last_revision = self.last_revision + 1
  entry.revision = self.last_revision
  for i = #self.history, self.position + 1, -1 do self.history[i] = nil end
  self.position = self.position + 1
  self.history[self.position], self.trial = entry, nil
  self.revision, self.saved = self.revision + 1, false
  return self
end

local function is_face(self, face)
  return math.type(face) == "integer" and face >= 1 and face <= #session.now(self).body.faces
end

-- Faces that an action names: a list without doubles; or nil and a sentence.
function session.read_faces(self, where, list)
  if type(list) ~= "table" or #list == 0 then
    raise(("%s: choose one face or more"):format(where))
  end
  local seen, out = {}, {}
  for _, face in ipairs(list) do
    if not is_face(self, face) then
      raise(("%s: there is no face %s: the part has faces 1 to %d"):format(where, core.got(face),
        #session.now(self).body.faces))
    end
    if not seen[face] then out[#out + 1] = face end
    seen[face] = true
  end
  return out
end

function session.vector(where, name, value)
  if vectors.is(value) then return {value[1] + 0.0, value[2] + 0.0, value[3] + 0.0} end
  raise(("%s: '%s': three numbers expected"):format(where, name))
end

-- The unit must be confirmed before anything is computed or a length is given.
function session.unconfirmed(self)
  local doubt = session.now(self).source.doubt
  return doubt and ("%s Nothing was computed: choose the unit of the file first."):format(doubt)
end

--- Whether an entry has loads.
function session.has_loads(entry)
  for _, condition in ipairs(entry.conditions) do
    if condition.kind ~= "all" and condition.kind ~= "normal" then return true end
  end
  return false
end

return session
