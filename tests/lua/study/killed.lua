-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A study of many cheap trials, for the spec that kills it: FILE COUNT [WORKERS]
local bw = require "barwright"
local study = bw.study {
  name = "killed", seed = 3, file = arg[1],
  variables = {{name = "x", min = -1, max = 1}, {name = "k", kind = "integer", min = 1, max = 1000000}},
  measures = {"y", "r"},
  design = {"random", count = math.tointeger(tonumber(arg[2]))},
  run = function(point, trial) return {y = math.sin(point.x) * point.k, r = trial:random()} end,
}
print(#assert(study:run {workers = math.tointeger(tonumber(arg[3] or 2))}))
