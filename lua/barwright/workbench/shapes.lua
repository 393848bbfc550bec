-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Actions of a workbench that change the shape of the part: they are put into its class.
local advise = require "barwright.workbench.advise"
local core = require "barwright.core"
local drag = require "barwright.workbench.drag"
local edits = require "barwright.workbench.edits"
local mirror = require "barwright.workbench.mirror"
local options = require "barwright.options"
local session = require "barwright.workbench.session"

local raise = core.raise
local now, refuse, act = session.now, session.refuse, session.act
local read_faces, vector, unconfirmed = session.read_faces, session.vector, session.unconfirmed

local workbench = {}

local push_rules = {faces = {type = "table", needed = true}, distance = {type = "number", needed = true}}

local function locked_among(self, faces)
  for _, face in ipairs(faces) do
    if now(self).locked[face] then
      return ("%s is locked: unlock it to move it."):format(now(self).body.faces[face].name)
    end
  end
end

local function may_edit(self, faces)
  return unconfirmed(self) or locked_among(self, faces)
end

-- Faces with their mirror images where edits are symmetric; nil and a sentence where there is none.
local function on_both_sides(self, faces)
  local across, seen, out = now(self).symmetry, {}, {}
  for _, face in ipairs(faces) do
    local image = not across and face or mirror.face(now(self).body, across, face)
    if not image then
      return nil, ("Nothing lies opposite %s: switch the symmetry off to change it alone."):format(
        now(self).body.faces[face].name)
    end
    for _, one in ipairs {face, image} do
      if not seen[one] then out[#out + 1] = one end
      seen[one] = true
    end
  end
  return out
end

-- A push, and what goes into the script.
local function pushed(self, given)
  local opts = options.read("push", given, push_rules)
  local faces, message, details = read_faces(self, "push", opts.faces)
  if not faces then return nil, message, details end
  local both, alone = on_both_sides(self, faces)
  local why = alone or may_edit(self, both)
  if why then return refuse(why) end
  local distances = {}
  for _, face in ipairs(both) do distances[face] = opts.distance end
  return edits.push(now(self).body, distances, now(self).locked, "This push"), {faces = faces,
    distance = opts.distance}
end

local radius_rules = {face = {type = "integer", needed = true},
  radius = {type = "number", needed = true, above = 0}}

local function resized(self, given)
  local opts = options.read("radius", given, radius_rules)
  local faces, message, details = read_faces(self, "radius", {opts.face})
  if not faces then return nil, message, details end
  local both, alone = on_both_sides(self, faces)
  local why = alone or may_edit(self, both)
  if why then return refuse(why) end
  local about = now(self).body.faces[opts.face]
  if about.kind ~= "cylinder" and about.kind ~= "sphere" then
    return refuse(("%s has no radius: choose a hole or another round face, or push it."):format(about.name))
  end
  return edits.radius(now(self).body, both, opts.radius), {face = opts.face, radius = opts.radius}
end

local offset_rules = {distance = {type = "number", needed = true}}

local function grown_all(self, given)
  local opts = options.read("offset", given, offset_rules)
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local distances = {}
  for face in ipairs(now(self).body.faces) do
    if not now(self).locked[face] then distances[face] = opts.distance end
  end
  return edits.push(now(self).body, distances, now(self).locked, "This offset"), {distance = opts.distance}
end

local shapes = {push = pushed, radius = resized, offset = grown_all}
local rules = {push = push_rules, radius = radius_rules, offset = offset_rules}

for name, make in pairs(shapes) do
  workbench[name] = function(self, given)
    local edit, line, details = make(self, given)
    if not edit then return nil, line, details end
    local made, message, about = edits.made(now(self).body, edit)
    if not made then return nil, message, about end
    return act(self, name, line, {body = made})
  end
end

-- The length of an edit, in proportion to which it moves points: of a radius what it changes.
local function length_of(self, name, given)
  if name ~= "radius" then return given.distance end
  local former = now(self).body.faces[given.face].radius
  return former and given.radius - former or 0 -- without a radius the edit is refused
end

-- Which edit it is, whatever its length.
local function key_of(self, name, given)
  local faces = name == "offset" and {} or read_faces(self, name, given.faces or {given.face})
  return name .. table.concat(faces, ",")
end

-- The trial that goes on, or a new one of an edit: its mesh is that of the body at rest. nil, message, details
-- where the edit is refused or the part cannot be solved.
local function trial_of(self, given)
  local name = next(given)
  if not shapes[name] then raise("try: push, radius or offset expected") end
  local entry, trial, asked = now(self), self.trial, options.read(name, given[name], rules[name])
  local key, length = key_of(self, name, asked), length_of(self, name, asked)
  if trial and trial.entry == entry and trial.key == key then return trial, length end
  local edit, message, details = shapes[name](self, given[name])
  if not edit then return nil, message, details end
  if not session.has_loads(entry) then return {edit = edit}, length end
  self.rest, message, details = drag.rest(entry, self.rest)
  if not self.rest then return nil, message, details end
  trial = {entry = entry, rest = self.rest, key = key}
  if length == 0 then return trial, length end -- which says nothing of how points move
  trial.motion, message, details = drag.motion(self.rest, edit, length)
  if not trial.motion then return nil, message, details end
  self.trial = trial
  return trial, length
end

--- Makes the mesh of a drag, so that its first step is as fast as the others. Nothing changes. `given`: of `try`;
--- without it, the mesh alone.
function workbench:prepare_drag(given)
  local entry, ok, message, details = now(self), true, nil, nil
  if given then
    ok, message, details = trial_of(self, given)
  elseif session.has_loads(entry) and not unconfirmed(self) then
    ok, message, details = drag.rest(entry, self.rest)
    self.rest = ok or self.rest
  end
  if not ok then return nil, message, details end
  return self
end

--- A coarse answer for a shape that is tried, while a handle is dragged: {push | radius | offset = options}.
--- Nothing changes. Returns the answer, the solution and the labels of its facets. Without loads the answer has
--- the mass only.
function workbench:try(given)
  local trial, length, details = trial_of(self, given)
  if not trial then return nil, length, details end
  local entry = now(self)
  if trial.rest then
    local answer, static, more = drag.step(trial, length)
    if answer then return answer, static, more end
  end
  -- No loads, or so far that the mesh cannot follow.
  local name = next(given)
  local edit, message, about = trial.edit, nil, nil
  if not edit then edit, message, about = shapes[name](self, given[name]) end
  if not edit then return nil, message, about end
  local made
  made, message, about = edits.made(entry.body, edit)
  if not made then return nil, message, about end
  if trial.edit then
    return {kind = "shape", mass = entry.material.density and entry.material.density * made.surface.volume}
  end
  local rest
  rest, message, about = drag.rest {body = made, conditions = entry.conditions, material = entry.material}
  if not rest then return nil, message, about end
  trial = {entry = entry, rest = rest, key = trial.key, from = length}
  trial.motion, message, about = drag.motion(rest, edit, length)
  if not trial.motion then return nil, message, about end
  self.trial = trial
  return drag.step(trial, length)
end

--- Does what an advice says.
function workbench:apply(given)
  local opts = options.read("apply", given, {advice = {type = "integer", needed = true}})
  local entry = now(self)
  local place = (entry.advice or {})[opts.advice]
  if not place then
    raise(("apply: there is no advice %d: ask for advice first"):format(opts.advice))
  end
  return self:thicken {at = place.at, radius = place.radius, offset = place.offset}
end

local thicken_rules = {at = {type = "table", needed = true}, radius = {type = "number", needed = true, above = 0},
  offset = {type = "number", needed = true, above = 0}}

--- Thickens the part around a point by a smooth bump.
function workbench:thicken(given)
  local opts = options.read("thicken", given, thicken_rules)
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local at, message, details = vector("thicken", "at", opts.at)
  if not at then return nil, message, details end
  local entry = now(self)
  local made
  made, message, details = advise.thickened(entry, {at = at, radius = opts.radius, offset = opts.offset})
  if not made then return nil, message, details end
  return act(self, "thicken", {at = at, radius = opts.radius, offset = opts.offset}, {body = made})
end

local optimise_rules = {accuracy = {type = "string", one_of = {"coarse", "default", "fine"}},
  force = {type = "number", above = 0}, factor = {type = "number", above = 0, default = 1.0},
  steps = {type = "integer", min = 1, max = 20, default = 5}}

--- Thickens weak places until the part carries a force in the worst way, or its loads with a factor. The best that
--- was found is kept, also where that is not reached.
function workbench:optimise(given)
  local opts = options.read("optimise", given, optimise_rules)
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local entry = now(self)
  -- In the script, which has only the last answer, the accuracy stands for itself.
  opts.accuracy = opts.accuracy or entry.answer and entry.answer.accuracy or "default"
  local made, report, details = advise.optimise(entry, opts, session.has_loads(entry))
  if not made then return nil, report, details end
  return act(self, "optimise", opts, {body = made, note = report})
end

return workbench
