-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Outlines for bars, by formula, of a length of one: a fish, a leaf, a bone. What an artist would draw.
local bw = require "barwright"

local shapes = {}

-- A curve's entry, as bw.outline takes it: two controls and the end.
local function to(ax, ay, bx, by, x, y)
  return {{ax, ay}, {bx, by}, {x, y}}
end

function shapes.fish()
  return bw.outline {name = "fish",
    to(0.5, 0.17, 0.12, 0.17, 0, 0), to(0.12, -0.17, 0.5, -0.17, 0.76, -0.05),
    to(0.84, -0.06, 0.92, -0.15, 1, -0.16), to(0.95, -0.08, 0.94, -0.03, 0.94, 0),
    to(0.94, 0.03, 0.95, 0.08, 1, 0.16), to(0.92, 0.15, 0.84, 0.06, 0.76, 0.05)}
end

function shapes.leaf()
  return bw.outline {name = "leaf",
    to(0.7, 0.2, 0.25, 0.2, 0, 0), to(0.25, -0.16, 0.55, -0.2, 0.8, -0.08),
    to(0.88, -0.05, 0.94, -0.03, 1, -0.03), {1, 0.03}, to(0.96, 0.03, 0.94, 0.04, 0.92, 0.05)}
end

function shapes.bone()
  return bw.outline {name = "bone",
    to(0.02, 0.12, -0.02, 0.05, 0.02, 0), to(-0.02, -0.05, 0.02, -0.12, 0.12, -0.11),
    to(0.25, -0.1, 0.35, -0.06, 0.5, -0.06), to(0.65, -0.06, 0.75, -0.1, 0.88, -0.11),
    to(0.98, -0.12, 1.02, -0.05, 0.98, 0), to(1.02, 0.05, 0.98, 0.12, 0.88, 0.11),
    to(0.75, 0.1, 0.65, 0.06, 0.5, 0.06), to(0.35, 0.06, 0.25, 0.1, 0.12, 0.11)}
end

return shapes
