-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Breaking forces beside those of random drops (impacts.lua). docs/benchmarks.md has the meaning of the columns.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. folder .. "/../worst_case/?.lua;" .. package.path
local bodies = require "bodies"
local impacts_of = require "impacts"
local options = require "options"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "breaking forces beside the contact forces of random drops",
  about = "Prints a Markdown table. scripts/bench/bodies.lua lists the bodies.",
  options = {options.models, options.unseen, options.containing, options.elements(5000),
    {name = "drops", value = "N", type = "integer", default = 200, min = 1, what = "number of random drops"}},
}

print("| body | breaking force, N (interval) | contact, cm2 | peg's contact over it | impacts "
  .. "| least contact force, N | median | below the interval, % | least with inertia, N | below the interval, % "
  .. "| at the weakest place or a tie, % | of the weakest tenth, % |")
print "|---|---|---|---|---|---|---|---|---|---|---|---|"
for _, body in ipairs(bodies(opts)) do
  local found <close> = assert(bw.breaking_force(body.surface(), {material = bw.material.pla,
    elements = opts.elements}))
  local impacts = impacts_of(found, {drops = opts.drops, seed = 1})
  local contact, inertia = impacts.force, impacts.with_inertia
  local known = ("%s | %.4g (%.4g to %.4g) | %.2f"):format(body.name, found.force, found.low, found.high,
    found.contact * 1e4)
  print(("| %s | %.4f | %d | %.4g | %.4g | %.1f | %.4g | %.1f | %.1f | %.1f |"):format(known,
    impacts.peg_area / found.contact, #impacts, contact.min, contact.median, 100 * contact.below, inertia.min,
    100 * inertia.below, 100 * impacts.predicted, 100 * impacts.predicted_of_tenth))
  io.stdout:flush()
end
