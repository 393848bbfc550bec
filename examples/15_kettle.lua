-- SPDX-License-Identifier: MIT
-- Lesson 15: a kettle.
--   build/barwright examples/15_kettle.lua [FOLDER]
--
-- A kettle heated from below: how much heat goes in, for the shape that it has, while its bottom is drawn out.
local bw = require "barwright"
local folder = arg[1] or "."

local kettle = assert(bw.outline {points = {{0, 0}, {0.10, 0}, {0.14, 0.06}, {0.12, 0.13}, {0.09, 0.16},
    {0.01, 0.16}, {-0.02, 0.13}, {-0.04, 0.06}},
  tags = {bottom = 1, sides = {2, 8}, top = {3, 4, 5, 6, 7}}})

-- Something as thick as oil: Rayleigh number about 1e6
local oil = {density = 900, viscosity = 0.02, diffusivity = 8e-8, expansion = 7e-4}
local depth, difference = 0.16, 0.1
print(("Rayleigh number %.2g"):format(9.81 * oil.expansion * difference * depth ^ 3
  / (oil.viscosity / oil.density * oil.diffusivity)))

local flow = assert(bw.responsive.thermal {outline = kettle, elements = 1900, step = 20, gravity = {0, -9.81},
  density = oil.density, viscosity = oil.viscosity, diffusivity = oil.diffusivity,
  expansion = oil.expansion, conditions = {sides = "wall", -- no heat through them
    top = {x = 0, y = 0, temperature = 0}, bottom = {x = 0, y = 0, temperature = difference}}})

local out = assert(io.open(folder .. "/kettle.csv", "w"))
out:write "time_s,nusselt,fastest_m_per_s\n"
for frame = 1, 120 do
  if frame > 60 and frame <= 80 then assert(flow:drag({edge = 1}, {0, -0.001})) end
  assert(flow:step())
  out:write(("%g,%.5f,%.6g\n"):format(flow.time, flow:nusselt("bottom", difference), flow.velocity:max()))
  if frame % 20 == 0 then
    print(("t = %4.0f s: heat %5.2f times conduction, fastest %.2f mm/s; %s"):format(flow.time,
      flow:nusselt("bottom", difference), 1e3 * flow.velocity:max(), tostring(flow.reused)))
  end
end
out:close()
