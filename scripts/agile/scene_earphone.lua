-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A headset about 60 mm wide, of a doll's size: a band, an arm and a cup on either side, and a
-- microphone on a boom. Its crown is fixed; the cups are
-- pulled apart, the microphone is pressed. Lengths in mm, y from right to left, z up.
local figure = require "figure"

-- The band: an arc of six pieces in the plane x = 0.
local RADIUS, HEIGHT = 29, 40
local function band(i) -- 0: top, 3: where the arm begins
  local angle = i * math.rad(32)
  return {0, RADIUS * math.sin(angle), HEIGHT + RADIUS * math.cos(angle)}
end
local shoulder = band(3)
local slider = {shoulder[1], shoulder[2] + 0.3, shoulder[3] - 4.5}
local elbow, hub = {0, 30, 29}, {0, 28, 20}
local arc = {}
for i = -3, 3 do
  local p = band(i)
  arc[#arc + 1] = {p[1], p[2], p[3], 2.7}
end
local parts = figure.pairs({{chain = arc, squash = {1.6, 1, 1}}}, {
  {from = shoulder, r = 3.3, squash = {1.2, 1, 1}}, -- slider
  {chain = {{shoulder[1], shoulder[2], shoulder[3], 1.9}, {elbow[1], elbow[2], elbow[3], 1.6},
    {hub[1], hub[2], hub[3], 1.8}, {0, 27, 12, 2}}}, -- arm
  {from = {0, 27.5, 10}, to = {0, 22, 10}, r = 9, r_to = 9.5, squash = {1, 0.55, 1}}, -- cup
})
for _, p in ipairs {
  {chain = {{5, 28, 5, 1.9}, {16, 30, -4, 1.4}, {28, 24, -10, 1.4}, {33, 17, -11, 1.6}}}, -- boom
  {from = {30, 21, -10.6}, to = {33, 17, -11}, r = 2.6, r_to = 3}, -- microphone
} do
  parts[#parts + 1] = p
end

local function mirrored(v) return {v[1], -v[2], v[3]} end

return {
  title = "earphone", parts = parts, rounding = 1.8, cell = 0.75,
  joints = {
    {"top", band(0)}, {"left band 1", band(1)}, {"left band 2", band(2)}, {"left slider", slider},
    {"left elbow", elbow}, {"left hub", hub}, {"left cup", {0, 25, 0.8}},
    {"right band 1", mirrored(band(1))}, {"right band 2", mirrored(band(2))},
    {"right slider", mirrored(slider)}, {"right elbow", mirrored(elbow)}, {"right hub", mirrored(hub)},
    {"right cup", {0, -25, 0.8}},
    {"boom bend", {16, 30, -4}}, {"boom end", {28, 24, -10}}, {"microphone", {33, 17, -11}},
  },
  bones = {
    {"left crown", "top", "left band 1"}, {"left band", "left band 1", "left band 2"},
    {"left temple", "left band 2", "left slider"}, {"left arm", "left slider", "left elbow"},
    {"left yoke", "left elbow", "left hub"}, {"left ear", "left hub", "left cup"},
    {"right crown", "top", "right band 1"}, {"right band", "right band 1", "right band 2"},
    {"right temple", "right band 2", "right slider"}, {"right arm", "right slider", "right elbow"},
    {"right yoke", "right elbow", "right hub"}, {"right ear", "right hub", "right cup"},
    {"boom", "left hub", "boom bend"}, {"boom tip", "boom bend", "boom end"},
    {"microphone", "boom end", "microphone"},
  },
  root = "top",
  fix = function(boundary) return boundary:box({-10, -7, 60}, {10, 7, 80}) end,
  loads = {
    {"the left cup is pulled", function(boundary) return boundary:box({-10, 20, -1}, {10, 40, 4}) end,
      {0, 6.3, 0}},
    {"the right cup is pulled", function(boundary) return boundary:box({-10, -40, -1}, {10, -20, 4}) end,
      {0, -6.3, 0}},
    {"the microphone is pressed", function(boundary) return boundary:near({32, 18, -8}, 3) end,
      {0, 0, -4}},
  },
  session = {heat = 10, threshold = 0.6, thresholds = { -- wider joints where the band will be scaled
    ["left arm"] = 0.8, ["right arm"] = 0.8, ["left temple"] = 0.8, ["right temple"] = 0.8,
    ["left band"] = 0.8, ["right band"] = 0.8}},
  edits = {
    {"the microphone nearer", function(session)
      return session:reach {{joint = "microphone", at = {31e-3, 13e-3, -9e-3}, from = "boom"}}
    end},
    {"a larger microphone", function(session)
      return session:bone("microphone"):scale {1.1, 1.1, 1.1}
    end},
    {"thicker cups", function(session)
      return session:pose {["left ear"] = {scale = {1, 1.1, 1}}, ["right ear"] = {scale = {1, 1.1, 1}}}
    end},
    {"the left arm out", function(session) return session:bone("left arm"):rotate {x = 6} end},
    {"taken back", function(session) return session:undo() end},
  },
  ties = {{"left arm", "right arm"}, {"left yoke", "right yoke"}, {"left temple", "right temple"},
    {"left band", "right band"}, {"left crown", "right crown"}, {"left ear", "right ear"}},
}
