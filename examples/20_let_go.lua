-- SPDX-License-Identifier: MIT
-- Lesson 20: a solid in motion.
--   build/barwright examples/20_let_go.lua [FOLDER]
--
-- A rubber bar is pulled down at its end and let go. It swings; the picture moves.
local bw = require "barwright"
local folder = arg and arg[1] or os.tmpname() .. "_motion"

local grid = assert(bw.grid.box {size = {0.04, 0.2, 0.02}, cells = {4, 20, 2}})
local rubber = bw.hyperelastic {young = 1e6, poisson = 0.4, density = 1000}
local function fixed()
  return assert(bw.solid {grid = grid, materials = {rubber}}):fix {side = "min y"}
end

-- 1. Pulled: a static equilibrium, from which the motion begins.
local pulled = assert(fixed():force({side = "max y"}, {0, 0, -0.6}):solve())
print(pulled)

-- 2. Let go: the same bar without the force. Newmark's scheme keeps the energy; implicit Euler takes
-- some of it in every step, and forgives long steps. Damping may be added to either.
local bar = fixed()
local step = 0.005
local swing = assert(bar:transient {scheme = "newmark", step = step, displacement = pulled.displacement})
local total = swing.kinetic + swing.strain + swing.potential
local end_nodes = grid:nodes {side = "max y"}
local results = assert(bw.results.open(folder, {script = "examples/20_let_go.lua"}))
local frames = {}
local before, rising, periods = nil, false, {}
print "time, s   end, mm   kinetic, J   strain, J"
for i = 0, 108 do
  if i > 0 then assert(swing:step()) end
  local height = swing.displacement:gather(end_nodes):column(3):mean() * 1e3
  if before and rising and height < before then periods[#periods + 1] = swing.time - step end
  rising, before = before and height > before, height
  if i % 6 == 0 then
    print(("%7.3f  %8.2f   %10.6f   %9.6f"):format(swing.time, height, swing.kinetic, swing.strain))
  end
  if i % 3 == 0 then
    frames[#frames + 1] = ("%s/frame_%03d.png"):format(folder, i)
    assert(grid:picture(frames[#frames], {displacement = swing.displacement, direction = {1, -0.4, 0.2},
      up = {0, 0, 1}, view = {{-0.01, -0.01, -0.09}, {0.05, 0.2, 0.09}}, width = 480, height = 400}))
  end
end

-- 3. What the scheme and long steps do to the energy; the bar's slowest note.
local now = swing.kinetic + swing.strain + swing.potential
print(("energy: %.6f J, then %.6f J"):format(total, now))
if #periods > 1 then print(("swings once in %.3f s"):format(periods[2] - periods[1])) end

assert(bw.animation(results:path "swing.png", frames, {seconds = 4 * 3 * step}))
for _, name in ipairs(frames) do os.remove(name) end
print("wrote " .. folder)
