-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A study for study_cluster_spec.lua: cheap trials, some of which fail or are killed.
local bw = require "barwright"

return bw.study {
  name = "cluster", seed = 3,
  variables = {{name = "x", min = 0, max = 1}, {name = "n", kind = "integer", min = 0, max = 4}},
  measures = {{name = "y"}, {name = "r"}},
  objectives = {{name = "y", goal = "min"}},
  design = {"latin_hypercube", count = 30},
  run = function(point, trial)
    if point.n == 3 and point.x > 0.5 then return nil, "too far out" end
    if point.n == 4 and point.x > 0.6 then os.execute "kill -9 $PPID" end
    return {y = (point.x - 0.3) ^ 2 + point.n, r = trial:random()}
  end,
}
