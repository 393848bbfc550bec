-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A bird on thin legs, about 70 mm long. It stands on its right foot; the left one is pushed with
-- 5 N. Lengths in mm, x forwards, z up.
local figure = require "figure"

local parts = figure.pairs({
  {chain = {{-9, 0, 33, 8.5}, {0, 0, 33.5, 11}, {8, 0, 36, 10.5}, {14, 0, 44, 7}, {18, 0, 52, 7}}}, -- body
  {from = {23, 0, 52}, to = {33, 0, 49.5}, r = 2.8, r_to = 0.9}, -- beak
  {from = {-14, 0, 34}, to = {-36, 0, 39}, r = 4.5, r_to = 5.5, squash = {1, 1, 0.4}}, -- tail
}, {
  {chain = {{4, 8, 39, 5}, {-5, 17, 43, 6}, {-13, 23, 44, 5}, {-21, 27, 43, 2.5}}, squash = {1, 1, 0.4}}, -- wings
  {chain = {{0, 5, 29, 4.6}, {-2, 5.8, 23, 3.2}, {-3, 6, 19, 1.25}, {-1.5, 6, 11, 0.91}, {0, 6, 4, 1.3}}}, -- legs
  {chain = {{0, 6, 3.2, 1.7}, {4, 6, 2.2, 1.6}, {9, 6, 1.6, 1.3}}, round = 1.2}, -- toes
  {chain = {{0, 6, 3.2, 1.7}, {3, 8, 2.2, 1.6}, {7, 10.5, 1.6, 1.2}}, round = 1.2},
  {chain = {{0, 6, 3.2, 1.7}, {3, 4, 2.2, 1.6}, {7, 1.9, 1.6, 1.2}}, round = 1.2},
  {chain = {{0, 6, 3.2, 1.7}, {-3, 6, 2.2, 1.5}, {-6, 6, 1.6, 1.2}}, round = 1.2},
})

return {
  title = "bird", parts = parts, rounding = 2.5, cell = 0.8,
  joints = {
    {"hips", {-3, 0, 32}}, {"breast", {9, 0, 37}}, {"nape", {17, 0, 50}}, {"beak", {32, 0, 49.7}},
    {"tail tip", {-38, 0, 37}}, {"left wing tip", {-20, 26.5, 43}}, {"right wing tip", {-20, -26.5, 43}},
    {"left knee", {-3, 6, 19}}, {"left ankle", {0, 6, 4}}, {"left toe", {9.5, 6, 1.7}},
    {"right knee", {-3, -6, 19}}, {"right ankle", {0, -6, 4}}, {"right toe", {9.5, -6, 1.7}},
  },
  bones = {
    {"body", "hips", "breast"}, {"neck", "breast", "nape"}, {"head", "nape", "beak"},
    {"tail", "hips", "tail tip"},
    {"left wing", "breast", "left wing tip"}, {"right wing", "breast", "right wing tip"},
    {"left thigh", "hips", "left knee"}, {"left shank", "left knee", "left ankle"},
    {"left foot", "left ankle", "left toe"},
    {"right thigh", "hips", "right knee"}, {"right shank", "right knee", "right ankle"},
    {"right foot", "right ankle", "right toe"},
  },
  near = {{{-2, 6, 14}, 7, 0.6}, {{-2, -6, 14}, 7, 0.6}},
  root = "hips",
  fix = function(boundary) return boundary:box({-8, -13, -1}, {12, -0.5, 2.2}) end,
  loads = {
    {"the left foot is pushed backwards", function(boundary)
      return boundary:box({-8, 0.5, -1}, {12, 13, 2.2})
    end, {-5, 0, 0}},
  },
  session = {heat = 10, threshold = 0.35, thresholds = { -- wider joints where limbs move
    ["left thigh"] = 0.9, ["left shank"] = 0.9, ["left foot"] = 0.9, ["right thigh"] = 0.9,
    ["right shank"] = 0.9, ["right foot"] = 0.9, ["left wing"] = 0.85, ["right wing"] = 0.85,
    tail = 0.65, head = 0.45, neck = 0.45}},
  edits = {
    {"looks to the left", function(session) return session:bone("neck"):rotate {z = 7} end},
    {"a larger head", function(session) return session:bone("head"):scale {1.1, 1.1, 1.1} end},
    {"the tail up", function(session) return session:bone("tail"):rotate {y = 5} end},
    {"the left wing up", function(session) return session:bone("left wing"):rotate {x = 6} end},
    {"a longer left wing", function(session) return session:bone("left wing"):scale {1.15, 1, 1} end},
    {"taken back", function(session) return session:undo() end},
    {"the right wing up", function(session) return session:bone("right wing"):rotate {x = -6} end},
  },
  ties = {{"left shank", "right shank"}, {"left thigh", "right thigh"}, {"left foot", "right foot"}},
}
