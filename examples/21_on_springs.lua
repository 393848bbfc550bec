-- SPDX-License-Identifier: MIT
-- Lesson 21: a beam that rests on springs, as an operator of your own.
--
-- The part has no springs. Its stiffness K as a matrix and a function that adds theirs are an operator,
-- which conjugate gradients and LOBPCG take as they take a matrix. The part's own factor preconditions
-- it: K and K with springs differ by little.
--
--   build/barwright examples/21_on_springs.lua
local bw = require "barwright"

-- A cantilever of steel, fixed at x = 0, with 100 N down at its end.
local mesh = bw.mesh.box {max = {0.2, 0.02, 0.01}, cells = {20, 2, 2}, order = 2}
local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
part:load {on = mesh.boundary:above("x", 0.2), force = {0, 0, -100}}
local system = assert(part:system())
local stiffness, mass = assert(system:matrix "stiffness"), assert(system:matrix "mass")
local b = system:right_hand_side(part:force_vector())

-- The last 50 mm of the underside rest on a foundation of 200 kN/m, a spring along z for each node.
local rows, count = {}, 0
for i, node in ipairs(mesh.nodes:totable()) do
  local on = node[1] > 0.15 and node[3] < 1e-9
  rows[i], count = {0, 0, on and 1 or 0}, count + (on and 1 or 0)
end
local springs = bw.array(rows) * (200e3 / count) -- N/m, per node and direction

-- The product: unknowns to displacements of the nodes, their spring forces, and back.
local on_springs = bw.operator {size = stiffness.row_count, name = "beam on springs", apply = function(x)
  return stiffness:apply(x) + system:right_hand_side(springs * system:displacement(x))
end}

local function deflection(x) return -1e3 * system:displacement(x):column(3):min() end

local factor = assert(stiffness:inverse())
local alone = factor:apply(b)
local x, report = assert(on_springs:solve(b, {preconditioner = factor}))
print(("deflection %.3f mm alone, %.3f mm on springs"):format(deflection(alone), deflection(x)))
print(report)

-- The lowest frequencies of both.
local function frequency(value) return math.sqrt(value) / (2 * math.pi) end
local free = assert(stiffness:eigenpairs {mass = mass, count = 3})
local held = assert(on_springs:eigenpairs {mass = mass, count = 3, preconditioner = factor})
for k = 1, 3 do
  local f = frequency(held.values[k]) -- an error of lambda is twice that of f, relative to each
  print(("mode %d: %.1f Hz alone, %.1f Hz on springs, within %.0e Hz"):format(k, frequency(free.values[k]), f,
    f * held.errors[k] / (2 * held.values[k])))
end

-- Try: springs along another direction n. Their force is k (n . u) n at each node.
