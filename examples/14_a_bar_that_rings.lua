-- SPDX-License-Identifier: MIT
-- Lesson 14: a bar of any outline that rings, tuned to a pitch.
--
-- A plate that hangs free rings at the lowest frequency of its elastic modes. While a handle of its
-- outline is dragged the mesh goes along, the last mode is the first guess and the last factor the
-- preconditioner, so that the tone is there in a frame's time.
--
--   build/barwright examples/14_a_bar_that_rings.lua [FOLDER]
local bw = require "barwright"

local outline = assert(bw.outline {
  {{0.12, 0.03}, {0.03, 0.035}, {0, 0}}, {{0.03, -0.035}, {0.1, -0.03}, {0.15, -0.012}},
  {0.2, -0.03}, {0.19, 0}, {0.2, 0.03}, {0.15, 0.012}})
local bar = assert(bw.responsive.metallophone {outline = outline, thickness = 0.004,
  material = bw.material.aluminium, elements = 200, modes = 5})
print(bar)

-- The tail is pulled out, a little in each frame.
for _ = 1, 10 do assert(bar:drag({vertex = 4}, {0.0005, 0})) end
print(("%.1f Hz, %s; %s"):format(bar.frequency, bar.note, bar.reused))

-- To the pitch, moving the outline least.
local tuned = assert(bar:tune "C5")
print(("%.2f Hz, %+.2f cents, outline moved by %.2f mm"):format(tuned.frequency, tuned.cents,
  1e3 * tuned.moved))

-- Where to support it, what it sounds like, how to cut it.
for _, at in ipairs(assert(bar:holes())) do
  print(("support it at %.1f, %.1f mm"):format(1e3 * at[1], 1e3 * at[2]))
end
local folder = arg[1] or "."
assert(bar:write_tone(folder .. "/c5.wav"))
assert(bar.outline:write(folder .. "/c5.dxf"))

-- Try: the second overtone is not in tune with the first. Minimise |f2 - 4 f1| with bar:gradient(2).
