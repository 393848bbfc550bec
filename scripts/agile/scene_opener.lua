-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A bottle opener, about 110 mm long: a tongue hooks under the rim of the cap, the far side of the
-- ring rests on its top, and a hand lifts the handle. Lengths in mm, x from the handle to the ring.
return {
  title = "opener", rounding = 7, cell = 0.9,
  parts = {
    {min = {-62, -8, -3.5}, max = {-4, 8, 3.5}, r = 3}, -- handle
    {min = {-8, -5.4, -2.1}, max = {20, 5.4, 2.1}, r = 1.8}, -- neck
    {disc = {31, 0, 0}, radius = 17, height = 7.5, r = 2.5}, -- ring
  },
  cuts = {
    {disc = {32, 0, 0}, radius = 11, height = 20},
    {disc = {-54, 0, 0}, radius = 3, height = 20}, -- for a string
  },
  more = { -- after the cuts
    {min = {16, -5.5, -3.2}, max = {26.5, 5.5, 2.4}, r = 1.2, round = 2}, -- tongue
  },
  joints = {{"end", {-62, 0, 0}}, {"grip", {-5, 0, 0}}, {"throat", {17, 0, 0}}, {"rim", {47, 0, 0}}},
  bones = {{"handle", "grip", "end"}, {"neck", "grip", "throat"}, {"ring", "throat", "rim"}},
  root = "grip",
  fix = function(boundary)
    local tongue = boundary:box({22.5, -6, -3.5}, {27, 6, 3})
    return tongue:union(boundary:box({42.5, -8, -4}, {48, 8, -2.5}))
  end,
  loads = {
    {"a hand lifts the handle", function(boundary) return boundary:box({-63, -9, -4}, {-46, 9, -2.5}) end,
      {0, 0, 39}},
  },
  session = {heat = 10, threshold = 0.8},
  edits = {
    {"a thicker handle", function(session) return session:bone("handle"):scale {1, 1.08, 1.08} end},
    {"a wider ring", function(session) return session:bone("ring"):scale {1.05, 1.05, 1} end},
    {"the handle turned up", function(session) return session:bone("handle"):rotate {y = 5} end},
    {"a longer neck", function(session) return session:bone("neck"):scale {1.1, 1, 1} end},
    {"taken back", function(session) return session:undo() end},
  },
  ties = {},
}
