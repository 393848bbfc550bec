-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A metallophone's bar.
local bw = require "barwright"
local followed_kinds = require "followed_kinds"
local fuse = require "fuse"

return followed_kinds.new {
  make = function()
    return bw.responsive.metallophone {outline = followed_kinds.first(), material = bw.material.pla,
      thickness = 0.05, elements = math.random(8, 40), modes = math.random(3)}
  end,
  fields = {"frequencies", "thickness"},
  asks = {function(object) return object:mode(1) end},
  moves = {
    solve = {2, function(subject) return subject.object:solve() end},
    gradient = {1, function(subject) return subject.object:gradient(math.random(4)) end},
    inplane = {0.5, function(subject) return subject.object:inplane() end},
    ["nodal lines"] = {0.5, function(subject) return subject.object.nodal_lines end},
    tune = {0.3, function(subject)
      local object = subject.object
      return object:tune(object.frequency * followed_kinds.uniform(0.9, 1.1), {finer = 1,
        watch = fuse.around(function() return math.random() < 0.7 end)})
    end},
  },
}
