-- SPDX-License-Identifier: MIT
-- Lesson 16: the lightest bridge.
--   build/barwright examples/16_a_bridge.lua [FOLDER]
--
-- Span 200 mm with 4 mm of acrylic, carry 1500 N on the middle, keep von Mises stresses below 30 MPa,
-- with as little area as possible.
local bw = require "barwright"
local folder = arg and arg[1] or os.tmpname() .. "_bridge"
local mm = 1e-3

local acrylic = bw.material.isotropic {name = "acrylic", young = 3e9, poisson = 0.35, density = 1190}
local bridge = assert(bw.responsive.bridge {span = 200 * mm, load = 1500, stress_limit = 30e6,
  material = acrylic, thickness = 4 * mm, size = 4 * mm, wall = 6 * mm})
print(bridge)

-- 1. What a plain beam needs.
local height, beam = bridge:uniform_beam()
print(("a beam has to be %.1f mm high: %.0f mm2"):format(height / mm, beam / mm ^ 2))

-- 2. By hand: the analysis keeps up with every drag. Feet and pad stay where they are.
assert(bridge:hole({30 * mm, 40 * mm}, 12 * mm))
for _ = 1, 5 do assert(bridge:drag({loop = "hole 1"}, {-1 * mm, 0})) end
print(("by hand: %.0f mm2, %.0f %% of the limit; %s"):format(bridge.area / mm ^ 2,
  100 * bridge.utilisation, tostring(bridge.reused)))
local ok, message = bridge:drag({loop = "hole 1"}, {0, 80 * mm})
assert(not ok)
print("refused: " .. message)

-- 3. By itself, from two struts and a tie. More starts, rounds and a finer mesh give smaller areas:
-- scripts/bridge/run.lua. The hole would stay where it is: it is taken away.
assert(bridge:without "hole 1")
local found = assert(bridge:design {starts = {"truss"}, rounds = 20, polish = 0})
print(("by itself: %.0f mm2, %.0f %% of the beam; %.2f times Michell's bars"):format(
  found.area / mm ^ 2, 100 * found.area / beam, found.area / bridge:michell_area()))
print(("%.1f %% of the limit on a finer mesh"):format(100 * bridge:check(2 * mm) / bridge.stress_limit))

-- 4. To cut, to print, to look at.
local results = assert(bw.results.open(folder, {script = "examples/16_a_bridge.lua"}))
assert(bridge.whole:write(results:path "bridge.dxf"))
assert(bridge:body():write(results:path "bridge.stl"))
assert(bridge:picture(results:path "bridge.svg"))
print("wrote " .. folder)
