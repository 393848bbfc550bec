-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Trials as a study gives them, made up: for the specs of plots and reports, and for the pages' tests.
local check = require "check"

--- `count` trials with these objectives: of 17 one failed, of 41 one ran out of time.
return function(objectives, count, folder)
  local random = check.random(7)
  local trials = {
    problem = {
      variables = {
        {name = "thickness", unit = "m", kind = "real", min = 1e-3, max = 5e-3, scale = "log"},
        {name = "holes", kind = "integer", min = 0, max = 4, what = "along the rim"},
        {name = "material", kind = "choice", of = {"pla", "zp150"}},
      },
      measures = {{name = "mass", unit = "kg"}, {name = "stress", unit = "Pa", what = "largest von Mises"},
        {name = "stiffness", unit = "N/m"}},
      objectives = objectives,
      constraints = {{name = "stress", max = 55e6}},
    },
    study = {name = "hook & <eye>", seed = 1, file = "hook.study",
      design = {name = "latin_hypercube", opts = {count = count}}},
    summary = {},
  }
  for i = 1, count do
    local point = {thickness = 1e-3 * 5 ^ random(), holes = math.floor(5 * random()),
      material = random() < 0.5 and "pla" or "zp150"}
    local t = point.thickness
    local trial = {number = i, key = ("%064x"):format(i), status = "done", seconds = 0.1 + random(), point = point,
      folder = folder and ("%s/%d"):format(folder, i)}
    trial.results = {mass = 0.02 + 9 * t - 0.002 * point.holes, stiffness = 1e9 * t ^ 2 * (1 + random()),
      stress = 5e4 / t ^ 1.08 * (1 + 0.1 * point.holes) * (0.9 + 0.2 * random())}
    if i % 17 == 0 then
      trial.status, trial.results = "failed", nil
      trial.message = "the <surface> crosses itself & has holes"
    elseif i % 41 == 0 then
      trial.status, trial.results, trial.message = "time", nil, "60 s passed"
    end
    trials[i] = trial
  end
  return trials
end
