-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes the study's report that tests/pages/study.mjs opens: FOLDER/study.html.
local here = arg[0]:match "^(.*)/[^/]*$" or "."
package.path = here .. "/../lua/?.lua;" .. package.path
local report = require "barwright.study.report"
local make = require "study_trials"
assert(report.write(make({{name = "mass", goal = "min"}, {name = "stiffness", goal = "max"}}, 120),
  arg[1] .. "/study.html"))
