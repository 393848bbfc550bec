-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Round holes of a surface, as `barwright strengthen --keep holes` finds them.
local bw = require "barwright"
local holes = require "barwright.command.holes"

-- A plate with a hole along z at x = 12 mm, a pin that stands on it at 45 mm, and a notch at its end.
local function plate(turned)
  local function round(x, low)
    local outline = assert(bw.outline.circle {centre = {x, 0.01}, radius = 0.003})
    return assert(bw.surface.extrude(outline, {height = 0.02, curvature = 6})):translate {0, 0, low}
  end
  local body = assert(bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.006}})
  body = assert(assert(body:difference(round(0.012, -0.005))):union(round(0.045, 0.001)))
  body = assert(body:difference(round(0.06, -0.005)))
  return turned and assert(body:rotate({1, 2, 3}, 0.9)) or body
end

describe("round holes", function()
  it("are found where a wall goes round an axis and faces it", function()
    local list = assert(holes.of(plate()))
    assert.equal(1, #list)
    assert.near(0.003, list[1].radius, 1e-5)
    assert.near(0.006, list[1].high - list[1].low, 1e-6)
    local on_wall = holes.test(list)
    assert.is_true(on_wall(0.015, 0.01, 0.003))
    for _, p in ipairs {{0.012, 0.01, 0.003}, {0.048, 0.01, 0.01}, {0.015, 0.01, 0.02}, {0.057, 0.01, 0.003}} do
      assert.is_false(on_wall(p[1], p[2], p[3]))
    end
  end)

  it("are found in any position", function()
    assert.equal(1, #assert(holes.of(plate(true))))
    assert.equal(0, #assert(holes.of(assert(bw.surface.box {min = {0, 0, 0}, max = {1, 1, 1}}))))
  end)
end)
