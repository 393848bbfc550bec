-- SPDX-License-Identifier: MIT
-- Lesson 25: how does it answer when it is shaken?
--   build/barwright examples/25_shake_it.lua [FOLDER]
--
-- An aluminium bracket of 200 x 40 x 6 mm on a shaker that moves its foot up and down with 1 g. The response is
-- known at every frequency of the range, by modes and residual vectors, with a bound of its error.
local bw = require "barwright"
local folder = arg and arg[1]

local mesh = bw.mesh.box {max = {0.2, 0.04, 0.006}, cells = {20, 4, 1}, order = 2}
local part = bw.model {mesh = mesh, material = bw.material.aluminium}:fix(mesh.boundary:below("x", 0))
local response = assert(part:harmonic {range = {10, 1500}, base = {0, 0, 9.81}, damping = {ratio = 0.02}})
print(response)

local tip = assert(response:curve {at = {0.2, 0.02, 0.006}})
local frequency, amplitude = tip:peak "z"
print(("the tip moves by %.3f mm against its foot at %.1f Hz"):format(1e3 * amplitude, frequency))
assert(math.abs(frequency / response.modes.frequencies[1] - 1) < 0.01)

-- The largest stress over a period, at the peak and as if the acceleration were constant.
local stress = response:von_mises(frequency):max()
print(("largest stress %.2f MPa, %.0f times the static one"):format(1e-6 * stress,
  stress / response:von_mises(0):max()))
assert(stress > 20 * response:von_mises(0):max() and stress < bw.material.aluminium.strength)

if folder then
  assert(tip:write(folder .. "/tip.csv"))
  assert(tip:figure():write(folder .. "/tip.svg"))
  assert(response:animate(frequency, folder .. "/shaken.png", {pictures = 8, width = 500, height = 400}))
end

-- In time: a pulse of 1 g, half a sine, for one period of the tip. A page plays three periods.
part:gravity {0, 0, -9.81}
local period = 1 / frequency
local transient = assert(part:transient {step = period / 40,
  loads = {function(t) return t < period and math.sin(math.pi * t / period) or 0 end}})
local motion = assert(transient:run {time = 3 * period, frames = 60, stress_every = 10})
print(motion)
if folder then assert(motion:report(folder .. "/motion.html")) end
part:clear_loads()

-- A sensor of 50 g on the tip, 20 mm above it: its mass rocks, and the frequency falls.
part:couple {on = mesh.boundary:above("x", 0.2), kind = "rigid", at = {0.2, 0.02, 0.026}, mass = 0.05}
local loaded = assert(part:harmonic {range = {10, 1500}, base = {0, 0, 9.81}, damping = {ratio = 0.02}})
local sensor = assert(loaded:curve {coupling = 1})
print(sensor, sensor.rotation)
assert(sensor:peak "z" < 0.8 * frequency)

-- Next: loads in place of the base, damping = {loss = 0.01}, or another place of the curve.
