-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A bridge, edited by hand.
local bw = require "barwright"
local followed_kinds = require "followed_kinds"

local kind = {}
local text_of = followed_kinds.text_of

function kind.make()
  local starts = {"truss", "gable", "beam", "arch"}
  local bridge = assert(bw.responsive.bridge {span = 0.2, load = 100, stress_limit = 30e6, thickness = 0.004,
    material = bw.material.pla, size = 0.02, wall = 0.008, start = starts[math.random(4)]})
  return {object = bridge}
end

function kind.seen(subject)
  local object = subject.object
  return table.concat({text_of(object.points), text_of(object.elements), text_of(object.displacement),
    text_of(object.stress), text_of(object.outline.points), tostring(object.reused), text_of(object.area)}, "|")
end

function kind.check(subject) subject.object.sheet.body:check() end

function kind.close(subject)
  subject.object.sheet.body:close()
  if pcall(function() return subject.object.points end) then error "a closed bridge answers" end
end

local function part_of(size) return {followed_kinds.uniform(0, size), followed_kinds.uniform(0, size)} end

kind.operations = {
  drag = {5, function(subject)
    return subject.object:drag(followed_kinds.handle(subject.object.outline), followed_kinds.way(0.05))
  end},
  smooth = {1, function(subject) return subject.object:smooth() end},
  hole = {2, function(subject) return subject.object:hole(part_of(0.1), followed_kinds.uniform(0.002, 0.02)) end},
  without = {1, function(subject)
    local loops = subject.object.outline.loops
    return subject.object:without(loops[math.random(#loops)].name)
  end},
  become = {1, function(subject)
    if math.random() < 0.5 then return subject.object:become(followed_kinds.first()) end
    local outline, message = subject.object.outline:moved(followed_kinds.handle(subject.object.outline),
      followed_kinds.way(0.02))
    if not outline then return nil, message end
    return subject.object:become(outline)
  end},
}

return kind
