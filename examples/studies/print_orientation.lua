-- SPDX-License-Identifier: MIT
-- Study: print orientation.
--   build/barwright examples/studies/print_orientation.lua [FOLDER] [--quick]
--
-- A powder printer's gypsum is five times stiffer along its head's passes than across its layers. The same
-- hook is printed lying, standing, or in between: the material's axes are turned, the shape stays. Nobody
-- knows how the hook will be handled, so the measure is the worst case: the fraction of the strength that the
-- worst load uses. First an even sample of all orientations, then a search from the best of them.
local bw = require "barwright"
local quick = arg[#arg] == "--quick"
local folder = arg[1] ~= "--quick" and arg[1] or "out/print_orientation" .. (quick and "_quick" or "")
local mm, sin, cos, pi = 1e-3, math.sin, math.cos, math.pi

-- 1. The hook: made once, before the first trial; every trial has it.
local shapes = bw.shapes
local body = shapes.join({
  shapes.limb({0, 0, 0}, {0, 0, 50 * mm}, 6 * mm),
  shapes.limb({0, 0, 0}, {30 * mm, 0, -8 * mm}, 5 * mm),
  shapes.limb({30 * mm, 0, -8 * mm}, {38 * mm, 0, 12 * mm}, 4 * mm),
}, 3 * mm)
local surface = assert(bw.surface.implicit(body,
  {min = {-10 * mm, -10 * mm, -18 * mm}, max = {46 * mm, 10 * mm, 60 * mm}, cells = 50}))
local mesh = assert(bw.mesh.fill(surface, {elements = quick and 2000 or 8000}))

-- 2. The material's axes: tilted about X, then turned about Z.
local function rotation(tilt, turn)
  return {
    {cos(turn), -sin(turn), 0},
    {sin(turn) * cos(tilt), cos(turn) * cos(tilt), -sin(tilt)},
    {sin(turn) * sin(tilt), cos(turn) * sin(tilt), cos(tilt)},
  }
end

local results = assert(bw.results.open(folder, {script = arg[0], seed = 1}))
local study = bw.study {
  name = "print orientation", seed = 1,
  file = results:path(quick and "orientation_quick.study" or "orientation.study"),
  variables = {
    {name = "tilt", unit = "rad", min = 0, max = pi / 2},
    {name = "turn", unit = "rad", min = 0, max = pi},
  },
  measures = {{name = "utilisation"}, {name = "max_principal", unit = "Pa"}},
  objectives = {{name = "utilisation", goal = "min"}},
  design = {"sobol", count = quick and 4 or 32},
  run = function(point, trial)
    local gypsum = bw.material.zp150:rotated(rotation(point.tilt, point.turn))
    local part = bw.model {mesh = mesh, material = gypsum}
    local worst, message = bw.worst_case(part,
      {force = 20, pressure = 2e5, modes = quick and 4 or 10, regions = 3})
    if not worst then return nil, message end
    -- The picture goes into the report.
    assert(worst:picture(trial.folder .. "/weak.png", {width = 420, height = 320}))
    return {utilisation = worst.utilisation, max_principal = worst.max_principal}
  end,
}

-- 3. All orientations evenly, then downhill from the best.
local trials = assert(study:run())
print(trials)
local best = trials:best()
local found = assert(study:run {design = {"minimise", method = "neldermead", start = best.point,
  evaluations = quick and 3 or 20}})
best = found:best()

-- 4. What it is worth.
local utilisations = trials:column "utilisation"
table.sort(utilisations)
print(("worst orientation tried: %.0f %% of the strength, median %.0f %%, best found %.0f %%"):format(
  100 * utilisations[#utilisations], 100 * utilisations[(#utilisations + 1) // 2], 100 * best.results.utilisation))
print(("print it tilted by %.0f and rotated by %.0f degrees"):format(math.deg(best.point.tilt),
  math.deg(best.point.turn)))
assert(best.results.utilisation <= utilisations[1])
assert(trials:report(results:path "orientation.html"))
assert(results:write {utilisation_best = best.results.utilisation, utilisation_worst = utilisations[#utilisations],
  tilt_rad = best.point.tilt, turn_rad = best.point.turn})

-- Try: other objectives (max_principal alone does not know the layers), the plaster replaced by a material
-- of yours with bw.material.orthotropic {...}.
