-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Answers of a workbench, values at points of them, and advice: they are put into its class.
local advise = require "barwright.workbench.advise"
local core = require "barwright.core"
local judge = require "barwright.workbench.judge"
local lines = require "barwright.workbench.lines"
local model = require "barwright.command.model"
local options = require "barwright.options"
local session = require "barwright.workbench.session"

local now, refuse, has_loads = session.now, session.refuse, session.has_loads
local vector, unconfirmed = session.vector, session.unconfirmed

local workbench = {}

-- An answer, and its mesh for the picture, go into the entry.
local function keep(self, entry, accuracy, answer, solved)
  answer.accuracy = accuracy
  entry.answer, entry.solved = answer, solved
  self.last_revision = self.last_revision + 1
  entry.revision = self.last_revision
  self.revision = self.revision + 1
  if self.on_answer then self.on_answer(answer) end
end

local function statics(self, entry, accuracy)
  local former = entry.coarse
  if not former then
    local answer, static, more = judge.statics(entry.body, entry.material, entry.conditions, judge.elements.coarse)
    if not answer then return nil, static, more end
    answer.frequency = judge.frequency(more)
    former = {answer = answer, static = static, measure = more.measure, labels = more.labels}
    entry.coarse = former
  end
  if accuracy == "coarse" or not entry.answer then
    keep(self, entry, "coarse", former.answer, {static = former.static, labels = former.labels})
  end
  if accuracy == "coarse" then return entry.answer end
  local answer, static, more = judge.statics(entry.body, entry.material, entry.conditions,
    judge.elements[accuracy], former.measure)
  if not answer then return nil, static, more end
  answer.frequency = former.answer.frequency
  keep(self, entry, accuracy, answer, {static = static, labels = more.labels})
  return answer
end

local answer_rules = {accuracy = {type = "string", default = "default", one_of = {"coarse", "default", "fine"}},
  force = {type = "number", above = 0}}

--- The answer: with loads whether the part carries them, without loads the force that breaks it in the worst way.
function workbench:answer(given)
  local opts = options.read("answer", given, answer_rules)
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local entry = now(self)
  entry.answer_line = lines.action("answer", opts)
  if has_loads(entry) then return statics(self, entry, opts.accuracy) end
  if not entry.material.strength then
    return refuse(("The strength of %s is not known: give it with the material."):format(entry.material.name))
  end
  local answer, found, details = judge.worst(entry.body, entry.material, entry.conditions,
    judge.elements[opts.accuracy], opts.force)
  if not answer then return nil, found, details end
  keep(self, entry, opts.accuracy, answer, {breaking = found})
  return answer
end

--- Stress (Pa) and displacement (m) at a point of the last answer.
function workbench:probe(given)
  local opts = options.read("probe", given, {point = {type = "table", needed = true}})
  local point, message, details = vector("probe", "point", opts.point)
  if not point then return nil, message, details end
  local solved = now(self).solved
  local worst = solved and solved.breaking and solved.breaking.worst
  local static, at = solved and solved.static, core.array.new {point}
  if worst then
    local found, missing, what = model.try(worst.mesh.sample, worst.mesh, worst.mesh:to_nodes(worst.weakness), at)
    if not found then return nil, missing, what end
    return {point = point, von_mises = found(1, 1)}
  end
  if not static then return refuse "There is no result to read: ask for the answer first." end
  local stress, why, about = model.try(static.mesh.sample, static.mesh, static.von_mises, at)
  if not stress then return nil, why, about end
  local moved = static.mesh:sample(static.displacement, at)
  return {point = point, von_mises = stress(1, 1), displacement = moved:totable()[1]}
end

-- ---- advice ----------------------------------------------------------------------------------------

local advice_rules = {force = {type = "number", above = 0}}

--- What to thicken, with the gain of each place: kept until the part changes.
function workbench:advice(given)
  local opts = options.read("advice", given, advice_rules)
  local why = unconfirmed(self)
  if why then return refuse(why) end
  local entry = now(self)
  local list, message, details = advise.places(entry, opts, has_loads(entry))
  if not list then return nil, message, details end
  entry.advice, entry.advice_line = list, lines.action("advice", opts)
  self.revision = self.revision + 1
  return list
end

return workbench
