-- SPDX-License-Identifier: MIT
-- Lesson 31: a rough road.
--   build/barwright examples/31_rough_road.lua [FOLDER]
--
-- A bracket of 200 x 40 x 6 mm, bolted to a vehicle, carries a camera of 500 g. Nobody knows how it will move, but
-- its mean square in each band of frequencies is measured: the power spectral density. The answer is a
-- probability.
local bw = require "barwright"
local folder = arg and arg[1]

local g = 9.80665
local function shaken(cells)
  local mesh = bw.mesh.box {max = {0.2, 0.04, 0.006}, cells = cells, order = 2}
  local part = bw.model {mesh = mesh, material = bw.material.aluminium}:fix(mesh.boundary:below("x", 0))
  part:couple {on = mesh.boundary:above("x", 0.2), kind = "rigid", at = {0.2, 0.02, 0.026}, mass = 0.5}
  return assert(part:harmonic {range = {10, 2000}, base = {0, 0, g}, damping = {ratio = 0.02}})
end
-- Rows of frequency in Hz and density in g^2/Hz, since the base moves with 1 g in the response.
local psd = {{10, 0.03}, {40, 0.12}, {500, 0.12}, {2000, 0.015}}

local response = shaken {24, 5, 2}
local random = assert(response:random {psd = psd})
print(random)

-- Miles: a single oscillator of frequency f and quality Q, under the density S, has the mean square pi/2 f Q S.
local f = response.modes.frequencies[1]
local miles = g * math.sqrt(math.pi / 2 * f * 25 * 0.03 * f / 10)
local tip = random.couplings[1].displacement[3]
print(("first mode at %.1f Hz; the camera moves by %.3f mm in the root mean square; Miles: %.3f mm"):format(f,
  1e3 * tip, 1e3 * miles / (2 * math.pi * f) ^ 2))
assert(math.abs(tip * (2 * math.pi * f) ^ 2 / miles - 1) < 0.05)

-- The largest stress, and what the mesh leaves open: a coarser one gives other values.
local coarse = assert(shaken({12, 3, 1}):random {psd = psd})
local stress, before = random.von_mises:max(), coarse.von_mises:max()
print(("root mean square of von Mises stress: %.2f MPa (coarser mesh: %.2f MPa)"):format(stress / 1e6,
  before / 1e6))
assert(math.abs(stress / before - 1) < 0.2)

-- Does it survive an hour? The margin of three deviations, and the probability that the strength is exceeded.
local margins = assert(random:margins {duration = 3600})
print(margins)
print(("margin %.2f; the strength is exceeded within the hour with a probability of at most %.2g"):format(
  margins.margin, margins.first_passage:max()))

-- The damage of the hour, by a life curve of the material.
local damage = assert(random:fatigue {duration = 3600, curve = {amplitude = 60e6, cycles = 1e7, exponent = 6}})
print(damage)
if folder then
  assert(random:picture(folder .. "/rms.png"))
  assert(margins:picture(folder .. "/margins.png"))
end
-- Next: `barwright respond part.stl --psd road.csv --duration 1h`.
