-- SPDX-License-Identifier: MIT
-- Lesson 4: files as they are.
--   build/barwright examples/04_repair.lua
--
-- Real files have holes, flipped facets, cracks. `check` says what is wrong and where; `repair` corrects
-- it and says how far the surface moved.
local bw = require "barwright"

-- 1. A sound ball, and the same with every 97th facet gone and every 10th turned over.
local ball = assert(bw.surface.sphere {centre = {0, 0, 0}, radius = 0.02, subdivisions = 3})
print(ball:check().sound)
local kept = {}
for i, t in ipairs(ball.triangles:totable()) do
  if i % 97 ~= 0 then
    kept[#kept + 1] = i % 10 == 0 and {t[1], t[3], t[2]} or t
  end
end
local broken = assert(bw.surface.new {points = ball.points, triangles = kept})

-- 2. What is wrong?
local report = broken:check()
print(report)
assert(not report.sound and report.holes > 0)

-- 3. Repair it.
local repaired, log = broken:repair()
assert(repaired, log)
for _, step in ipairs(log) do print(step.name, step.text) end
assert(repaired:check().sound)
print(("volume %.3f cm3, of the ball %.3f cm3"):format(repaired.volume * 1e6, ball.volume * 1e6))
assert(math.abs(repaired.volume / ball.volume - 1) < 0.01)

-- 4. What the world causes comes back as nil and a sentence, so that a study can go on.
local nothing, message, details = bw.surface.read "no_such_file.stl"
print(nothing, message, details.status)
