-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Ten machine parts by formula that the worst-case search was not developed on. They were written down before
-- the search was run on any of them. Dimensions in mm.
local bw = require "barwright"
local tool = require "part_tools"
local shapes = bw.shapes
local box, cylinder, rotated, cut, bolt_circle = tool.box, tool.cylinder, tool.rotated, tool.cut, tool.bolt_circle

local parts = {}

local sqrt, max, abs, pi = math.sqrt, math.max, math.abs, math.pi

-- A wall of the thickness 2 w around y = y0 below the line a x + b z = c.
local function gusset(a, b, c, y0, w)
  local size = sqrt(a * a + b * b)
  return function(x, y, z) return max((a * x + b * z - c) / size, abs(y - y0) - w, -x, -z) end
end

-- A bearing block: a bore across, a foot with two bolt holes, a rib on each side.
local function pillow_block()
  local solid = {box(-38, -10, 0, 38, 10, 7), cylinder("y", 0, 24, 17, -12, 12), box(-17, -10, 0, 17, 10, 24)}
  for _, s in ipairs {-1, 1} do
    solid[#solid + 1] = function(x, y, z) return max((s * x + z - 34) / sqrt(2), abs(y) - 2, -z, 10 - s * x) end
  end
  return cut(shapes.join(solid), {cylinder("y", 0, 24, 11, -20, 20), cylinder("z", -30, 0, 3.5, -1, 12),
    cylinder("z", 30, 0, 3.5, -1, 12), cylinder("z", 0, 0, 1.8, 30, 60)}), {-42, -16, -4}, {42, 16, 45}
end

-- A gear with a rim, a thin web with lightening holes, and a hub with a keyway.
local function webbed_gear()
  local solid = {cut(cylinder("z", 0, 0, 26, 0, 10), {cylinder("z", 0, 0, 22, -1, 11)}),
    cylinder("z", 0, 0, 24, 3.5, 6.5), cylinder("z", 0, 0, 8, 0, 14)}
  for i = 1, 20 do
    solid[#solid + 1] = rotated(function(x, y, z)
      return max(abs(y) + 0.35 * (x - 25) - 2.2, abs(x - 27.5) - 3, abs(z - 5) - 5)
    end, 2 * pi * i / 20)
  end
  local holes = bolt_circle(6, 15, 4, -1, 12)
  holes[#holes + 1], holes[#holes + 2] = cylinder("z", 0, 0, 4.5, -1, 20), box(0, -1.2, -1, 6, 1.2, 20)
  return cut(shapes.join(solid), holes), {-35, -35, -4}, {35, 35, 18}
end

-- Two arms with hooks on a base with a screw hole.
local function snap_clip()
  local solid = {box(-16, -7, 0, 16, 7, 4)}
  for _, s in ipairs {-1, 1} do
    local near, far = math.min(s * 12, s * 14.5), math.max(s * 12, s * 14.5)
    solid[#solid + 1] = box(near, -7, 0, far, 7, 34)
    solid[#solid + 1] = function(x, y, z)
      return max(abs(y) - 7, 28 - z, (z - 34 + (s * x - 14.5) * 1.2) / 1.6, s * x - 18, 12 - s * x)
    end
  end
  return cut(shapes.join(solid), {cylinder("z", 0, 0, 2.6, -1, 6)}), {-22, -11, -4}, {22, 11, 38}
end

-- A motor's bracket: a large bore and four bolts in the upright plate, slots in the foot, a gusset on each side.
local function motor_bracket()
  local solid = shapes.join {box(0, -25, 0, 40, 25, 4), box(0, -25, 0, 4, 25, 48), gusset(1, 1, 38, -23, 2),
    gusset(1, 1, 38, 23, 2)}
  local holes = {cylinder("x", 0, 27, 11, -1, 6)}
  for _, y in ipairs {-15.5, 15.5} do
    for _, z in ipairs {11.5, 42.5} do holes[#holes + 1] = cylinder("x", y, z, 1.7, -1, 6) end
  end
  for _, y in ipairs {-12, 12} do holes[#holes + 1] = box(15, y - 2, -1, 33, y + 2, 6) end
  return cut(solid, holes), {-4, -29, -4}, {44, 29, 52}
end

-- A flat box with bosses, vents and a plug's opening.
local function vented_case()
  local solid = {cut(box(-36, -24, 0, 36, 24, 14), {box(-34, -22, 2, 34, 22, 20)})}
  local holes = {box(-40, -5, 5, -30, 5, 10)}
  for _, x in ipairs {-26, 26} do
    for _, y in ipairs {-15, 15} do
      solid[#solid + 1], holes[#holes + 1] = cylinder("z", x, y, 3.2, 0, 8), cylinder("z", x, y, 1.2, 3, 20)
    end
  end
  for i = -3, 3 do holes[#holes + 1] = box(i * 5 - 1.1, -9, -1, i * 5 + 1.1, 9, 3) end
  return cut(shapes.join(solid), holes), {-40, -28, -4}, {40, 28, 18}
end

-- A shelf's bracket: two thin arms, a rib between them along the middle, bolt holes beside the rib.
local function shelf_bracket()
  local solid = shapes.join {box(0, -9, 0, 60, 9, 3.5), box(0, -9, 0, 3.5, 9, 42), gusset(0.62, 1, 34, 0, 1.5)}
  local holes = {}
  for _, y in ipairs {-5.5, 5.5} do
    for _, x in ipairs {30, 52} do holes[#holes + 1] = cylinder("z", x, y, 1.8, -1, 5) end
    for _, z in ipairs {20, 37} do holes[#holes + 1] = cylinder("x", y, z, 1.8, -1, 5) end
  end
  return cut(solid, holes), {-4, -13, -4}, {64, 13, 46}
end

-- Half a pipe clamp: a half ring with ears.
local function pipe_clamp()
  local ring = cut(cylinder("y", 0, 0, 20, -8, 8), {cylinder("y", 0, 0, 16.5, -10, 10),
    box(-30, -10, -30, 30, 10, 0)})
  local solid = shapes.join {ring, box(-34, -8, 0, -17, 8, 4), box(17, -8, 0, 34, 8, 4),
    box(-1.5, -8, 17, 1.5, 8, 26)}
  return cut(solid, {cylinder("z", -27, 0, 3, -1, 6), cylinder("z", 27, 0, 3, -1, 6),
    cylinder("x", 0, 23, 1.5, -5, 5)}), {-38, -12, -4}, {38, 12, 30}
end

-- A bell crank: three bosses with bores, two arms with a groove on both sides.
local function bell_crank()
  local solid = shapes.join {cylinder("z", 0, 0, 9, 0, 14), cylinder("z", 45, 0, 6, 2, 12),
    cylinder("z", 0, 32, 6, 2, 12), box(0, -5, 3.5, 45, 5, 10.5), box(-5, 0, 3.5, 5, 32, 10.5)}
  return cut(solid, {cylinder("z", 0, 0, 5, -1, 20), cylinder("z", 45, 0, 3, -1, 20),
    cylinder("z", 0, 32, 3, -1, 20), box(12, -3, 8.5, 37, 3, 20), box(12, -3, -1, 37, 3, 5.5),
    box(-3, 12, 8.5, 3, 24, 20), box(-3, 12, -1, 3, 24, 5.5)}), {-13, -13, -4}, {55, 42, 18}
end

-- A belt pulley with five spokes.
local function spoked_pulley()
  local rim = cut(cylinder("z", 0, 0, 30, 0, 12), {cylinder("z", 0, 0, 25.5, -1, 13), function(x, y, z)
    return max(abs(z - 6) - 3.5, 27.5 - sqrt(x * x + y * y)) -- the belt's groove
  end})
  local solid = {rim, cylinder("z", 0, 0, 8, 0, 16)}
  for i = 1, 5 do solid[#solid + 1] = rotated(box(6, -2.2, 3.5, 27, 2.2, 8.5), 2 * pi * i / 5) end
  return cut(shapes.join(solid), {cylinder("z", 0, 0, 4, -1, 20), cylinder("x", 0, 13.5, 1.2, 0, 12)}),
    {-34, -34, -4}, {34, 34, 20}
end

-- A heat sink: fins on a plate, with corners for four screws.
local function heat_sink()
  local solid, holes = {box(-30, -20, 0, 30, 20, 4)}, {}
  for i = -5, 5 do solid[#solid + 1] = box(i * 4.5 - 0.9, -20, 0, i * 4.5 + 0.9, 20, 18) end
  for _, x in ipairs {-25.5, 25.5} do
    for _, y in ipairs {-15.5, 15.5} do
      holes[#holes + 1], holes[#holes + 2] = cylinder("z", x, y, 5.5, 4, 30), cylinder("z", x, y, 1.7, -1, 6)
    end
  end
  return cut(shapes.join(solid), holes), {-34, -24, -4}, {34, 24, 22}
end

parts.list = {
  {name = "pillow block", make = pillow_block}, {name = "webbed gear", make = webbed_gear},
  {name = "snap clip", make = snap_clip}, {name = "motor bracket", make = motor_bracket},
  {name = "vented case", make = vented_case}, {name = "shelf bracket", make = shelf_bracket},
  {name = "pipe clamp", make = pipe_clamp}, {name = "bell crank", make = bell_crank},
  {name = "spoked pulley", make = spoked_pulley}, {name = "heat sink", make = heat_sink},
}

parts.surface = tool.surface

return parts
