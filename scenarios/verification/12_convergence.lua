-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Orders of convergence, as the test of manufactured solutions prints them.
local bw = require "barwright"
local engine = require "engine"

local scenario = bw.scenario

scenario.about {title = "Convergence",
  text = [[Manufactured solutions on perturbed grids (`tests/engine/convergence`): the error of a smooth field must
fall with the power of the mesh size that theory gives.]]}

scenario("manufactured solutions on tetrahedra", {tags = {"slow"}}, function(t)
  engine.run(t, "convergence_test_manufactured")
end)
