-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Weak regions against brute force, as in figure 7 of the paper worst-case.
local bw = require "barwright"
local project = require "project"
project.use "worst_case"
local bodies = require "bodies_by_formula"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Weak regions against brute force",
  text = [[Brute force makes every element a region of its own. Percentiles are of the weakness map, by volume,
as in figure 7 of the paper; bodies have the numbers of elements of its table 1. How long both take is in
[benchmarks](benchmarks.md).]]}

for _, body in ipairs(bodies.list) do
  scenario(body.name, {tags = {"slow"}, seconds = 3600}, function()
    local found = bodies.compare(body)
    local how = ("%d elements; %.3f MPa by weak regions, %.3f MPa by brute force"):format(found.elements,
      found.both.worst_case / 1e6, found.both.brute_force / 1e6)
    expect(found.both.ratio, "99.75th percentile by weak regions over that by brute force"):between(0.9, 1.02,
      {source = "worst-case, figure 7", how = how})
  end)
end
