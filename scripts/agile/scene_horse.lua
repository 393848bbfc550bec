-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A horse about 75 mm long on four thin legs, pushed at its chest. Lengths in mm, x forwards, z up.
local figure = require "figure"

local parts = figure.pairs({
  {chain = {{-20, 0, 42, 9}, {-8, 0, 41.5, 9.5}, {6, 0, 41.5, 10}, {16, 0, 44, 10}}}, -- trunk
  {chain = {{17, 0, 46, 8}, {24, 0, 55, 6.2}, {29, 0, 65, 5}}}, -- neck
  {chain = {{29, 0, 67, 5.2}, {35, 0, 63.5, 4.4}, {42, 0, 58.5, 3.3}}}, -- head
  {chain = {{-25, 0, 47, 2.4}, {-32, 0, 43, 2.5}, {-35, 0, 34, 2.6}, {-37, 0, 24, 1.4}}}, -- tail
}, {
  {from = {27, 3, 71}, to = {26.5, 4, 76}, r = 1.8, r_to = 1.1, round = 1.5}, -- ears
  {chain = {{16, 5.5, 40, 6}, {18, 6, 30, 3.6}, {18.5, 6, 21, 1.4}, -- forelegs
    {18, 6, 12, 1.15}, {17.5, 6, 5, 1.2}}},
  {from = {17.7, 6, 3.6}, to = {19, 6, 1.8}, r = 2, r_to = 2.8, round = 1.5},
  {chain = {{-17, 5.5, 41, 7}, {-18.5, 6, 31, 4.6}, {-21.5, 6, 22, 1.55}, -- hind legs
    {-20, 6, 12, 1.25}, {-18.5, 6, 5, 1.3}}},
  {from = {-18.3, 6, 3.6}, to = {-17, 6, 1.8}, r = 2.1, r_to = 2.8, round = 1.5},
})

return {
  title = "horse", parts = parts, rounding = 2.5, cell = 0.9,
  joints = {
    {"back", {0, 0, 44}}, {"withers", {17, 0, 45}}, {"crest", {23, 0, 55}}, {"poll", {29.5, 0, 66}},
    {"muzzle", {43, 0, 58.5}}, {"croup", {-18, 0, 44}}, {"dock", {-32, 0, 43}}, {"tail tip", {-36, 0, 23}},
    {"left elbow", {18, 6, 21}}, {"left fore hoof", {18, 6, 1}},
    {"right elbow", {18, -6, 21}}, {"right fore hoof", {18, -6, 1}},
    {"left hock", {-21, 6, 22}}, {"left hind hoof", {-18, 6, 1}},
    {"right hock", {-21, -6, 22}}, {"right hind hoof", {-18, -6, 1}},
  },
  bones = {
    {"chest", "back", "withers"}, {"loin", "back", "croup"},
    {"lower neck", "withers", "crest"}, {"upper neck", "crest", "poll"}, {"head", "poll", "muzzle"},
    {"tail head", "croup", "dock"}, {"tail", "dock", "tail tip"},
    {"left forearm", "withers", "left elbow"}, {"left cannon", "left elbow", "left fore hoof"},
    {"right forearm", "withers", "right elbow"}, {"right cannon", "right elbow", "right fore hoof"},
    {"left thigh", "croup", "left hock"}, {"left shank", "left hock", "left hind hoof"},
    {"right thigh", "croup", "right hock"}, {"right shank", "right hock", "right hind hoof"},
  },
  near = {{{18, 6, 13}, 7, 0.9}, {{18, -6, 13}, 7, 0.9}, {{-20, 6, 13}, 7, 0.9}, {{-20, -6, 13}, 7, 0.9}},
  root = "back",
  fix = function(boundary) return boundary:below("z", 0.3) end,
  loads = {
    {"a push at the chest", function(boundary) return boundary:near({27, 0, 43}, 6) end, {-56, 0, 0}},
  },
  session = {heat = 100, threshold = 0.95},
  edits = {
    {"the neck lower", function(session) return session:bone("upper neck"):rotate {y = 14} end},
    {"a larger head", function(session) return session:bone("head"):scale {1.05, 1.1, 1.1} end},
    {"the tail to the side", function(session)
      return session:reach("tail tip", {-35e-3, 6e-3, 24e-3})
    end},
    {"a thicker loin", function(session) return session:bone("loin"):scale {1, 1.05, 1.05} end},
    {"taken back", function(session) return session:undo() end},
  },
  ties = {{"left cannon", "right cannon"}, {"left shank", "right shank"},
    {"left forearm", "right forearm"}, {"left thigh", "right thigh"}},
}
