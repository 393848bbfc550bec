-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Machine parts by formula: plates with ribs and bolt holes, clips, housings, wheels. The worst-case
-- search is measured on them (scripts/bench/worst_search.lua). Dimensions in mm.
local bw = require "barwright"
local tool = require "part_tools"
local shapes = bw.shapes
local box, cylinder, rotated, cut, bolt_circle = tool.box, tool.cylinder, tool.rotated, tool.cut, tool.bolt_circle

local parts = {}

local sqrt, max, abs, pi = math.sqrt, math.max, math.abs, math.pi

local function ribbed_plate()
  local solid = {box(-40, -25, 0, 40, 25, 4)}
  for _, x in ipairs {-20, 0, 20} do solid[#solid + 1] = box(x - 1.5, -25, 0, x + 1.5, 25, 12) end
  local holes = {}
  for _, x in ipairs {-33, 33} do
    for _, y in ipairs {-18, 18} do holes[#holes + 1] = cylinder("z", x, y, 3, -1, 20) end
  end
  return cut(shapes.join(solid), holes), {-44, -29, -4}, {44, 29, 16}
end

local function clip()
  local ring = cut(cylinder("z", 0, 0, 14, 0, 10), {cylinder("z", 0, 0, 11.5, -1, 11), box(-20, -5, -1, 0, 5, 11)})
  local solid = shapes.join {ring, box(11, -2, 0, 30, 2, 10), box(26, -8, 0, 30, 8, 10)}
  return cut(solid, {cylinder("x", 5, 5, 1.6, 20, 40), cylinder("x", -5, 5, 1.6, 20, 40)}),
    {-18, -18, -4}, {34, 18, 14}
end

local function housing()
  local shell = shapes.cut(box(-30, -20, 0, 30, 20, 20), box(-27.5, -17.5, 2.5, 27.5, 17.5, 30))
  local solid = {shell}
  for _, x in ipairs {-24, 24} do
    for _, y in ipairs {-14, 14} do solid[#solid + 1] = cylinder("z", x, y, 4, 0, 18) end
  end
  local tools = {box(20, -6, 8, 40, 6, 15), cylinder("z", 0, 0, 6, -5, 5)}
  for _, x in ipairs {-24, 24} do
    for _, y in ipairs {-14, 14} do tools[#tools + 1] = cylinder("z", x, y, 1.7, 6, 30) end
  end
  return cut(shapes.join(solid), tools), {-34, -24, -4}, {34, 24, 24}
end

local function angle_bracket()
  local solid = shapes.join {box(0, -20, 0, 45, 20, 5), box(0, -20, 0, 5, 20, 45), function(x, y, z)
    return max((x + z - 28) / sqrt(2), abs(y) - 2, -x, -z)
  end}
  return cut(solid, {cylinder("z", 33, 11, 3.2, -1, 9), cylinder("z", 33, -11, 3.2, -1, 9),
    cylinder("x", 11, 33, 3.2, -1, 9), cylinder("x", -11, 33, 3.2, -1, 9)}), {-4, -24, -4}, {49, 24, 49}
end

local function gear()
  local solid = {cylinder("z", 0, 0, 20, 0, 8), cylinder("z", 0, 0, 9, 0, 18)}
  for i = 1, 16 do solid[#solid + 1] = rotated(box(18, -2, 0, 25, 2, 8), 2 * pi * i / 16) end
  local tools = bolt_circle(5, 14, 3, -1, 10)
  tools[#tools + 1] = cylinder("z", 0, 0, 5, -1, 20)
  tools[#tools + 1] = box(0, -1.5, -1, 6.8, 1.5, 20)
  return cut(shapes.join(solid), tools), {-29, -29, -4}, {29, 29, 22}
end

local function flange()
  local tools = bolt_circle(6, 24, 3, -1, 10)
  tools[#tools + 1] = cylinder("z", 0, 0, 10, -1, 50)
  return cut(shapes.join {cylinder("z", 0, 0, 30, 0, 5), cylinder("z", 0, 0, 12.5, 0, 40)}, tools),
    {-34, -34, -4}, {34, 34, 44}
end

local function crankcase()
  local solid = {box(-35, -18, 0, 35, 18, 25), box(-42, -22, 0, 42, 22, 4),
    cylinder("x", 0, 18, 14, -40, 40)}
  local tools = {cylinder("x", 0, 18, 9, -50, 50), box(-31, -14.5, 4, -2, 14.5, 30),
    box(2, -14.5, 4, 31, 14.5, 30)}
  for _, x in ipairs {-38.5, 38.5} do
    for _, y in ipairs {-16, 16} do tools[#tools + 1] = cylinder("z", x, y, 2, -1, 8) end
  end
  return cut(shapes.join(solid), tools), {-46, -26, -4}, {46, 26, 36}
end

local function clevis()
  local solid = shapes.join {box(-10, -10, 0, 10, 10, 12), box(-10, -10, 0, -6, 10, 32),
    box(6, -10, 0, 10, 10, 32),
    cylinder("x", 0, 32, 11, -10.7, -5.3), cylinder("x", 0, 32, 11, 5.3, 10.7), cylinder("z", 0, 0, 5, -30, 2)}
  return cut(solid, {cylinder("x", 0, 32, 4, -20, 20)}), {-15, -15, -34}, {15, 15, 47}
end

local function turbine()
  local solid = {cylinder("z", 0, 0, 12, 0, 14)}
  for i = 1, 9 do
    local a = 2 * pi * i / 9
    solid[#solid + 1] = rotated(function(x, y, z)
      local off = y - 0.35 * (z - 7) -- a blade set at an angle
      return max(abs(off) - 1.2, abs(x - 21) - 11, abs(z - 7) - 6)
    end, a)
  end
  return cut(shapes.join(solid), {cylinder("z", 0, 0, 5, -1, 20)}), {-36, -36, -4}, {36, 36, 18}
end

local function hinge()
  local solid = {box(-30, 0, 0, 30, 28, 3)}
  for _, x in ipairs {-24, 0, 24} do solid[#solid + 1] = cylinder("x", -2, 5.5, 5, x - 6, x + 6) end
  local tools = {cylinder("x", -2, 5.5, 2, -40, 40)}
  for _, x in ipairs {-20, 0, 20} do tools[#tools + 1] = cylinder("z", x, 19, 2.5, -1, 9) end
  return cut(shapes.join(solid), tools), {-34, -11, -4}, {34, 32, 15}
end

local function comb()
  local solid = {box(-40, 0, 0, 40, 8, 4)}
  for i = -9, 9 do solid[#solid + 1] = box(i * 4.2 - 1, -25, 0.8, i * 4.2 + 1, 2, 3.2) end
  return shapes.join(solid), {-44, -29, -4}, {44, 12, 8}
end

-- Plates with holes, pins and ribs drawn by a seed: random test geometries.
local function drawn_plate(seed)
  local state = seed
  local function draw(from, to)
    state = (state * 1103515245 + 12345) % 2147483648
    return from + (to - from) * (state / 2147483648)
  end
  local thick = draw(2, 6)
  local solid, tools = {box(-35, -25, 0, 35, 25, thick)}, {}
  for _ = 1, 3 do
    local x, w = draw(-30, 30), draw(1.2, 3)
    solid[#solid + 1] = box(x - w, draw(-25, -5), 0, x + w, draw(5, 25), thick + draw(3, 12))
  end
  for _ = 1, 3 do
    solid[#solid + 1] = cylinder("z", draw(-28, 28), draw(-18, 18), draw(2, 5), 0, thick + draw(6, 25))
  end
  for _ = 1, 6 do tools[#tools + 1] = cylinder("z", draw(-30, 30), draw(-20, 20), draw(1.5, 5), -5, 40) end
  return cut(shapes.join(solid), tools), {-39, -29, -4}, {39, 29, 40}
end

parts.list = {
  {name = "ribbed plate", make = ribbed_plate}, {name = "clip", make = clip},
  {name = "housing", make = housing}, {name = "angle bracket", make = angle_bracket},
  {name = "gear", make = gear}, {name = "flange", make = flange},
  {name = "crankcase", make = crankcase}, {name = "clevis", make = clevis},
  {name = "turbine", make = turbine}, {name = "hinge", make = hinge}, {name = "comb", make = comb},
  {name = "drawn plate 1", make = function() return drawn_plate(1) end},
  {name = "drawn plate 2", make = function() return drawn_plate(2) end},
  {name = "drawn plate 3", make = function() return drawn_plate(3) end},
}

parts.surface = tool.surface

return parts
