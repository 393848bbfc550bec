-- SPDX-License-Identifier: MIT
-- Lesson 6: a study. How thick must the bar of the dumbbell be?
--   build/barwright examples/06_a_study.lua [FOLDER]
--
-- One worst-case analysis per thickness; failures are kept and the study goes on; the table can be
-- run again by anyone, with the same numbers.
local bw = require "barwright"
local shapes = bw.shapes
local out = arg[1] or "."

local function dumbbell(radius)
  local body = shapes.join({
    shapes.sphere({-0.03, 0, 0}, 0.012), shapes.sphere({0.03, 0, 0}, 0.012),
    shapes.limb({-0.03, 0, 0}, {0.03, 0, 0}, radius),
  }, 0.003)
  return bw.surface.implicit(body,
    {min = {-0.05, -0.02, -0.02}, max = {0.05, 0.02, 0.02}, cells = 50})
end

local rows = {}
for _, radius in ipairs {0.003, 0.004, 0.006} do
  local surface = assert(dumbbell(radius))
  local mesh, message = bw.mesh.fill(surface, {elements = 5000})
  local row = {radius_m = radius}
  if mesh then
    local part = bw.model {mesh = mesh, material = bw.material.green_state_stainless_steel}
    local worst = assert(bw.worst_case(part, {force = 5, pressure = 2e5, modes = 4, regions = 2}))
    row.max_principal_pa, row.utilisation = worst.max_principal, worst.utilisation
    print(("radius %.0f mm: %6.2f MPa, %3.0f %% of strength"):format(radius * 1e3,
      worst.max_principal / 1e6, 100 * worst.utilisation))
    worst:close()
  else
    row.failed = message
  end
  rows[#rows + 1] = row
end
assert(rows[1].max_principal_pa > rows[3].max_principal_pa, "thicker is stronger")

local file = assert(io.open(out .. "/study.json", "w"))
file:write(bw.json.encode({thickness = rows}), "\n")
file:close()
