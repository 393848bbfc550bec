-- SPDX-License-Identifier: MIT
-- Lesson 29: large displacements
--   build/barwright examples/33_it_bends_far.lua [FOLDER]
--
-- The strut of lesson 23 buckles at 3.5 times its load if it is perfect. A real one is a little bent, and bends
-- more and more. Southwell's plot reads the critical load from what it does before: of the deflection w over w / P
-- it is the slope.
local bw = require "barwright"
local folder = arg and arg[1]

local L, b, h = 0.5, 0.02, 0.01
local function strut(mesh, force)
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  -- within 1 mm: the head of the bent mesh is no longer quite flat
  part:fix(mesh.boundary:below("x", 0))
  return part:load {on = mesh.boundary:above("x", L - 1e-3), force = {-force, 0, 0}}
end
local straight = bw.mesh.box {max = {L, b, h}, cells = {30, 2, 2}, order = 2}
local buckling = assert(strut(straight, 1000):buckling {count = 1})
local bent = assert(buckling:imperfect_mesh {amplitude = h / 10})

-- Up to 1.02 times the critical load. Steps are of displacements, which grow much where the load hardly does.
local path = assert(strut(bent, 1000):nonlinear {factor = 1.02 * buckling.factor, arc_length = true,
  monitor = {{L, b / 2, h / 2}}})
print(path)
local line = {}
for i, move in ipairs(path:path(1):totable()) do
  local load, w = 1000 * path.factors[i], math.sqrt(move[2] ^ 2 + move[3] ^ 2)
  print(("%5.0f N: the head moves by %6.2f mm, residual %.0e"):format(load, 1000 * w, path.residuals[i]))
  if load > 500 * buckling.factor and load < 950 * buckling.factor then line[#line + 1] = {w, w / load} end
end
local critical = (line[#line][1] - line[1][1]) / (line[#line][2] - line[1][2])
print(("critical load: %.0f N by Southwell, %.0f N by linear buckling"):format(critical, 1000 * buckling.factor))
assert(math.abs(critical / (1000 * buckling.factor) - 1) < 0.01)

-- A shallow arch of PLA is pressed in its middle. Behind a limit point, at which the load is largest, it snaps
-- through: the load of the states in between falls, and they are unstable.
local flat = bw.mesh.box {max = {0.1, 0.01, 0.001}, cells = {30, 3, 1}, order = 2}
local nodes = flat.nodes:totable()
for _, p in ipairs(nodes) do p[3] = p[3] + 0.001 * (1 - math.cos(2 * math.pi * p[1] / 0.1)) end
local mesh = assert(flat:moved(nodes))
local arch = bw.model {mesh = mesh, material = bw.material.pla}
arch:fix(mesh.boundary:below("x", 0)):fix(mesh.boundary:above("x", 0.1))
arch:load {on = mesh.boundary:box({0.046, 0, 0.0027}, {0.054, 0.01, 0.006}), force = {0, 0, -10}}
local snap = assert(arch:nonlinear {factor = 2, steps = 50, arc_length = true, displacement = 0.0045})
print(snap)
local top = 1
while snap.factors[top + 1] > snap.factors[top] do top = top + 1 end
print(("it snaps at about %.1f N; from then on states are unstable: %d negative pivots before, %d behind"):format(
  10 * snap.factors[top], snap.negative_pivots[top - 1], snap.negative_pivots[top + 1]))
assert(snap.negative_pivots[top - 1] == 0 and snap.negative_pivots[top + 1] > 0)
if folder then
  assert(path:write(folder .. "/bent.vtu"))
  assert(path:write_history(folder .. "/bent.csv"))
  assert(snap:picture(folder .. "/snap.png"))
  assert(snap:figure({axis = "z"}):write(folder .. "/snap.svg"))
end
-- Next: the stress, path.von_mises:max(), beside the strength: does it yield before it buckles?
