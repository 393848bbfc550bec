-- SPDX-License-Identifier: MIT
-- Study: a bridge.
--   build/barwright examples/studies/bridge_loads.lua [FOLDER] [--quick]
--
-- How much acrylic does a bridge of 200 mm need for 500 N, 1000 N, 2000 N? Each trial designs one: the outline
-- moves, holes open, until no lighter one keeps the stress below its limit. Beside it: what a plain beam
-- needs, and Michell's bars, the least that any frame could need.
local bw = require "barwright"
local quick = arg[#arg] == "--quick"
local folder = arg[1] ~= "--quick" and arg[1] or "out/bridge_loads" .. (quick and "_quick" or "")
local mm, thickness = 1e-3, 4e-3
local acrylic = bw.material.isotropic {name = "acrylic", young = 3e9, poisson = 0.35, density = 1190}

local results = assert(bw.results.open(folder, {script = arg[0], seed = 1}))
local study = bw.study {
  name = "bridge", seed = 1, file = results:path(quick and "bridge_quick.study" or "bridge.study"),
  variables = {
    {name = "load", unit = "N", min = 500, max = 2000},
    {name = "start", kind = "choice", of = quick and {"truss"} or {"truss", "arch"}},
  },
  measures = {{name = "mass", unit = "kg"}, {name = "beam", unit = "kg"}, {name = "michell"},
    {name = "utilisation"}},
  objectives = {{name = "mass", goal = "min"}},
  constraints = {{name = "utilisation", max = 1}},
  design = {"grid", levels = {load = quick and 2 or 4}},
  run = function(point, trial)
    local bridge, message = bw.responsive.bridge {span = 200 * mm, load = point.load, stress_limit = 30e6,
      material = acrylic, thickness = thickness, size = 4 * mm, wall = 6 * mm}
    if not bridge then return nil, message end
    local _, beam = bridge:uniform_beam()
    local found
    found, message = bridge:design {starts = {point.start}, rounds = quick and 8 or 30,
      polish = quick and 0 or 20}
    if not found then return nil, message end
    assert(bridge:picture(trial.folder .. "/bridge.png"))
    assert(bridge.whole:write(trial.folder .. "/bridge.dxf"))
    local mass = thickness * acrylic.density
    return {mass = found.area * mass, beam = beam * mass, michell = found.area / bridge:michell_area(),
      utilisation = bridge:check(2 * mm) / bridge.stress_limit}
  end,
}
local trials = assert(study:run())
print(trials)
for _, trial in ipairs(trials) do
  if trial.status == "done" then
    print(("%4.0f N from %-5s: %4.1f g; a beam %4.1f g; %.2f times Michell's bars; %.1f %% of the limit"):format(
      trial.point.load, trial.point.start, 1e3 * trial.results.mass, 1e3 * trial.results.beam,
      trial.results.michell, 100 * trial.results.utilisation))
    assert(trial.results.mass < trial.results.beam and trial.results.michell > 1)
  end
end
assert(trials:report(results:path "bridges.html"))
assert(results:write {bridges = #trials})
