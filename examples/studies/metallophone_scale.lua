-- SPDX-License-Identifier: MIT
-- Study: a metallophone's scale.
--   build/barwright examples/studies/metallophone_scale.lua [FOLDER] [--quick]
--
-- One outline, seven notes: each bar is tuned to its pitch while its outline moves as little as that takes.
-- The note is the study's variable, a choice; each trial leaves a file to cut and a sound.
local bw = require "barwright"
local quick = arg[#arg] == "--quick"
local folder = arg[1] ~= "--quick" and arg[1] or "out/metallophone_scale" .. (quick and "_quick" or "")
local mm = 1e-3

local fish = assert(bw.outline {
  {{0.12, 0.03}, {0.03, 0.035}, {0, 0}}, {{0.03, -0.035}, {0.1, -0.03}, {0.15, -0.012}},
  {0.2, -0.03}, {0.19, 0}, {0.2, 0.03}, {0.15, 0.012}})

local results = assert(bw.results.open(folder, {script = arg[0], seed = 1}))
local study = bw.study {
  name = "metallophone", seed = 1, file = results:path(quick and "scale_quick.study" or "scale.study"),
  variables = {
    {name = "note", kind = "choice", of = quick and {"C5", "G5"} or {"C5", "D5", "E5", "F5", "G5", "A5", "B5"}},
  },
  measures = {{name = "frequency", unit = "Hz"}, {name = "cents", unit = "cent"}, {name = "moved", unit = "m"},
    {name = "mass", unit = "kg"}},
  objectives = {{name = "moved", goal = "min"}},
  constraints = {{name = "cents", min = -1, max = 1}},
  design = {"grid"},
  run = function(point, trial)
    local bar, message = bw.responsive.metallophone {outline = fish, thickness = 4 * mm,
      material = bw.material.aluminium, elements = quick and 150 or 300}
    if not bar then return nil, message end
    local tuned
    tuned, message = bar:tune(point.note)
    if not tuned then return nil, message end
    assert(bar.outline:write(trial.folder .. "/" .. point.note .. ".dxf"))
    assert(bar:write_tone(trial.folder .. "/" .. point.note .. ".wav"))
    assert(bar.outline:picture(trial.folder .. "/bar.png", {width = 420, height = 260}))
    return {frequency = tuned.frequency, cents = tuned.cents, moved = tuned.moved,
      mass = bar.outline.area * 4 * mm * bw.material.aluminium.density}
  end,
}
local trials = assert(study:run())
print(trials)
for _, trial in ipairs(trials) do
  print(("%s: %.2f Hz, %+.2f cents, outline moved by %.2f mm, %.0f g; cut %s/%s.dxf"):format(trial.point.note,
    trial.results.frequency, trial.results.cents, trial.results.moved / mm, 1e3 * trial.results.mass,
    trial.folder, trial.point.note))
  assert(math.abs(trial.results.cents) <= 1)
end

-- Higher notes come from smaller bars.
assert(trials[1].results.mass > trials[#trials].results.mass)
assert(trials:report(results:path "scale.html"))
assert(results:write {bars = #trials, moved_largest_m = math.max(table.unpack(trials:column "moved"))})

-- Try: the thickness as a second variable; scripts/metallophone/run.lua adds holes for screws and a page.
