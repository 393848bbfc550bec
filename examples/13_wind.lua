-- SPDX-License-Identifier: MIT
-- Lesson 13: wind.
--   build/barwright examples/13_wind.lua [FOLDER]
--
-- A cylinder in the wind: vortices part from it in turn. It is dragged up and back while they do.
local bw = require "barwright"
local folder = arg[1] or "."

local tunnel = assert(bw.outline {points = {{0, 0}, {3, 0}, {3, 1}, {0, 1}},
  tags = {sides = {1, 3}, outlet = 2, inlet = 4},
  holes = {bw.outline.circle {centre = {0.6, 0.52}, radius = 0.1, name = "cylinder", tag = "cylinder"}}})

-- Reynolds number 200: density 1, velocity 1, diameter 0.2, viscosity 0.001
local wind = assert(bw.responsive.flow {outline = tunnel, viscosity = 1e-3, step = 0.02,
  size = "0.015 + 0.12*abs(sqrt((x - 0.6)^2 + (y - 0.52)^2) - 0.1)*(1 - 0.7*(x > 0.6))",
  conditions = {inlet = {x = 1, y = 0}, sides = {y = 0}, cylinder = "wall"}})
print(wind)

local about = {velocity = 1, length = 0.2}
wind:record("lift", function(flow) return select(2, flow:coefficients("cylinder", about)) end)
wind:record("drag", function(flow) return (flow:coefficients("cylinder", about)) end)

local out = assert(io.open(folder .. "/lift.csv", "w"))
out:write "time_s,drag,lift\n"
for frame = 1, 150 do
  if frame > 20 and frame <= 40 then assert(wind:drag({loop = "cylinder"}, {0, 0.005})) end
  if frame > 40 and frame <= 60 then assert(wind:drag({loop = "cylinder"}, {0, -0.005})) end
  assert(wind:step(2))
  if frame % 25 == 0 then
    print(("t = %.2f s: %s"):format(wind.time, tostring(wind.reused)))
  end
end
for i, lift in ipairs(wind.signals.lift) do
  out:write(("%.4f,%.5f,%.5f\n"):format(0.02 * i, wind.signals.drag[i], lift))
end
out:close()

print(("Strouhal number %.3f, vorticity from %.0f to %.0f 1/s"):format(
  wind:frequency("lift", 3) * about.length / about.velocity, wind.vorticity:min(), wind.vorticity:max()))
