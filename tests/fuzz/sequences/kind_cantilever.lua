-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A sheet in large deflection.
local acting = require "acting"
local bw = require "barwright"
local followed_kinds = require "followed_kinds"

return followed_kinds.new {
  make = function()
    acting.load = 1e3
    return bw.responsive.cantilever {outline = followed_kinds.first(), material = acting.rubber,
      elements = math.random(8, 40), order = math.random(2), newton = {iterations = 12, load_steps = 6},
      conditions = {left = "fixed", right = {traction = {0, acting.function_of_load}}}}
  end,
  fields = {"displacement", "stress", "time"},
  moves = {
    load = {2, acting.change},
    solve = {2, function(subject) return subject.object:solve() end},
    ["steady"] = {0.5, function(subject) return subject.object.body:static({level = "none"}) end},
    norm = {0.5, function(subject) return subject.object.body:stress_norm(2) end},
  },
}
