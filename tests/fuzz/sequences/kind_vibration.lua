-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A sheet on shaking ground.
local acting = require "acting"
local bw = require "barwright"
local followed_kinds = require "followed_kinds"

return followed_kinds.new {
  make = function()
    acting.load = 1e-3
    return bw.responsive.vibration {outline = followed_kinds.first(), material = acting.rubber,
      elements = math.random(8, 40), order = math.random(2), step = 1e-3, ground = "left",
      ground_motion = {y = acting.function_of_load}}
  end,
  fields = {"displacement", "velocity", "acceleration", "time"},
  moves = {
    load = {1, acting.change},
    step = {5, function(subject) return subject.object:step(math.random(4)) end},
    steady = {0.5, function(subject) return subject.object.body:static({level = "none"}) end},
    norm = {0.5, function(subject) return subject.object.body:stress_norm(2) end},
  },
}
