-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A two-legged dinosaur about 120 mm long, standing with its left leg back; it is pushed
-- against the snout.
-- Lengths in mm, x forwards, z up.
local figure = require "figure"

local parts = figure.pairs({
  {chain = {{-70, 0, 35, 1.4}, {-50, 0, 33, 3.6}, {-32, 0, 36.5, 6.2}, {-16, 0, 43, 9.8}, {-4, 0, 47, 11.5},
    {8, 0, 50, 11}, {18, 0, 55, 8.8}, {26, 0, 63, 6.8}, {32, 0, 70, 6.8}}}, -- tail, trunk, neck
  {chain = {{33, 0, 71, 7}, {41, 0, 72, 5.8}, {52, 0, 70, 3.6}}}, -- skull and snout
  {chain = {{35, 0, 65, 3.2}, {41, 0, 63.2, 2.8}, {49, 0, 62.5, 2.1}}, round = 1}, -- jaw
}, {
  {chain = {{16, 7, 48, 3.4}, {19, 9, 42, 2.2}, {22, 9.4, 39, 1.9}, {27, 8.8, 40.5, 1.5}}}, -- arms
})
for _, side in ipairs {1, -1} do
  local y = 9 * side
  local back = side == 1 and -7 or 5 -- the left foot stands behind the right one
  for _, p in ipairs {
    {chain = {{-5, y * 0.75, 46, 9}, {0.5 + 0.2 * back, y * 0.95, 37, 7}, {5 + 0.3 * back, y, 28, 4.2},
      {back, y, 19, 2.3}, {-4 + back, y, 11.5, 1.9}, {0 + back, y, 4, 2.8}}}, -- leg
    {chain = {{0 + back, y, 3.6, 3}, {5 + back, y, 2.8, 2.6}, {10 + back, y, 2.2, 1.9}}, round = 1.5}, -- toes
    {chain = {{0 + back, y, 3.6, 3}, {4 + back, y + 2.5, 2.8, 2.5}, {8 + back, y + 5, 2.2, 1.8}}, round = 1.5},
    {chain = {{0 + back, y, 3.6, 3}, {4 + back, y - 2.5, 2.8, 2.5}, {8 + back, y - 5, 2.2, 1.8}}, round = 1.5},
  } do
    parts[#parts + 1] = p
  end
end

return {
  title = "dinosaur", parts = parts, rounding = 3, cell = 1,
  joints = {
    {"hips", {-6, 0, 46}}, {"shoulders", {15, 0, 51}}, {"neck base", {21, 0, 56}}, {"nape", {31, 0, 69}},
    {"snout", {54, 0, 70}}, {"jaw tip", {50, 0, 62}},
    {"tail 1", {-32, 0, 37}}, {"tail 2", {-50, 0, 33}}, {"tail tip", {-69, 0, 34}},
    {"left hand", {28, 8.5, 42}}, {"right hand", {28, -8.5, 42}},
    {"left knee", {2.9, 9, 29}}, {"left ankle", {-11, 9, 12}}, {"left toe", {0, 9, 2.2}},
    {"right knee", {6.5, -9, 29}}, {"right ankle", {1, -9, 12}}, {"right toe", {12, -9, 2.2}},
  },
  bones = {
    {"trunk", "hips", "shoulders"}, {"chest", "shoulders", "neck base"}, {"neck", "neck base", "nape"},
    {"head", "nape", "snout"}, {"jaw", "nape", "jaw tip"},
    {"tail base", "hips", "tail 1"}, {"tail middle", "tail 1", "tail 2"}, {"tail end", "tail 2", "tail tip"},
    {"left arm", "shoulders", "left hand"}, {"right arm", "shoulders", "right hand"},
    {"left thigh", "hips", "left knee"}, {"left shank", "left knee", "left ankle"},
    {"left foot", "left ankle", "left toe"},
    {"right thigh", "hips", "right knee"}, {"right shank", "right knee", "right ankle"},
    {"right foot", "right ankle", "right toe"},
  },
  near = {{{-9, 9, 14}, 7, 1}, {{3, -9, 14}, 7, 1}},
  root = "hips",
  fix = function(boundary) return boundary:below("z", 1.2) end,
  loads = {
    {"a push against the snout", function(boundary) return boundary:near({54, 0, 70}, 6) end, {-15, 0, 0}},
  },
  session = {heat = 10, threshold = 0.42, thresholds = { -- wider joints where limbs will be scaled
    ["left thigh"] = 0.9, ["left shank"] = 0.9, ["left foot"] = 0.9, ["right thigh"] = 0.9,
    ["right shank"] = 0.9, ["right foot"] = 0.9}},
  edits = {
    {"looks up to the left", function(session)
      return session:reach {{joint = "snout", at = {53e-3, 6e-3, 71e-3}, from = "chest"}}
    end},
    {"a larger head", function(session) return session:bone("head"):scale {1.1, 1.05, 1.05} end},
    {"the tail to the side", function(session)
      return session:reach {{joint = "tail tip", at = {-68e-3, -7e-3, 34e-3}, from = "tail middle"}}
    end},
    {"the mouth open", function(session) return session:bone("jaw"):rotate {y = 4} end},
    {"a longer right arm", function(session) return session:bone("right arm"):scale {1.2, 1, 1} end},
    {"taken back", function(session) return session:undo() end},
  },
  ties = {{"left shank", "right shank"}, {"left thigh", "right thigh"},
    {"left foot", "right foot"}},
}
