-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Breaking forces from coarse, medium and fine starts: largest over smallest force, whether each interval contains
-- the force of the finest start, how far the places lie apart in radii of the patch, and processor seconds.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. folder .. "/../worst_case/?.lua;" .. package.path
local bodies = require "bodies"
local distance = require "barwright.points".distance
local options = require "options"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "breaking forces from coarse, medium and fine first meshes",
  about = "Prints a line for each start and body. scripts/bench/bodies.lua lists the bodies.",
  options = {options.models, options.unseen, options.containing, options.each_of_elements {2500, 5000, 10000},
    {name = "overkill", value = "N", type = "integer", default = 0, min = 0,
      what = "compare the answers with the force on one mesh of about so many unknowns, finer around all places "
        .. "that were found: whether each interval contains it, and the estimated error over the real one; "
        .. "0: without"},
  },
}
local starts = opts.elements

-- Whether a place, or one of its ties, lies within a patch of another.
local function same_place(found, other)
  local min = distance(found.at, other.at)
  for _, tie in ipairs(found.ties) do min = math.min(min, distance(tie.at, other.at)) end
  for _, tie in ipairs(other.ties) do min = math.min(min, distance(tie.at, found.at)) end
  return min / found.length
end

-- Elements around a place have edges of this fraction of the radius; the surface is followed to that fraction.
local EDGE, FOLLOWED = 0.2, 0.02

-- The force on a mesh of about opts.overkill unknowns: the background is made finer until there are as many.
local function overkill(surface, found)
  local near, length = {}, found[1].length
  for _, one in ipairs(found) do
    local apart = true
    for _, area in ipairs(near) do apart = apart and distance(area.at, one.at) > length end
    if apart then near[#near + 1] = {at = one.at, radius = length, length = EDGE * length} end
  end
  local edge, mesh = length, nil
  for _ = 1, 8 do
    mesh = assert(bw.mesh.fill(surface, {edge_length = edge, order = 2, near = near,
      surface_tolerance = FOLLOWED * length}))
    local fraction = 3 * mesh.node_count / opts.overkill
    if fraction > 0.95 then break end
    edge = edge * math.max(0.5, fraction ^ (1 / 2.5))
  end
  local one = assert(bw.breaking_force(mesh, {material = bw.material.pla, modes = 2, length = length}))
  print(("%-22s overkill: %.4g N with %d unknowns"):format("", one.force, 3 * mesh.node_count))
  one:close()
  return one
end

print(("%-22s %-8s %-30s %-8s %-8s %s"):format("body", "largest/", "force, N (interval)", "elements", "apart, r",
  "CPU, s"))
local max, covered, all = 1, 0, 0
for _, body in ipairs(bodies(opts)) do
  local found, min_force, max_force = {}, math.huge, 0
  for k, elements in ipairs(starts) do
    local clock = os.clock()
    local one, message = bw.breaking_force(body.surface(), {material = bw.material.pla, elements = elements})
    if one then
      found[#found + 1] = one
      one.start, one.cpu, one.count = elements, os.clock() - clock, one.mesh.element_count
      min_force, max_force = math.min(min_force, one.force), math.max(max_force, one.force)
      one:close()
    else
      print(("%-22s start %d: %s"):format(body.name, elements, message))
    end
    if k == #starts and #found > 0 then max = math.max(max, max_force / min_force) end
  end
  local finest = found[#found]
  local truth = opts.overkill > 0 and finest and overkill(body.surface(), found)
  for k, one in ipairs(found) do
    local inside = one.low <= finest.force and finest.force <= one.high
    if truth then
      inside = one.low <= truth.force and truth.force <= one.high
      local real = math.abs(one.force / truth.force - 1)
      print(("%-22s start %d: estimated %.3f, real %.3f, effectivity %.1f%s"):format("", one.start,
        one.estimated_error, real, one.estimated_error / real, inside and "" or ", misses"))
    end
    if truth or k < #found then covered, all = covered + (inside and 1 or 0), all + 1 end
    local interval = ("%.4g (%.4g to %.4g)%s"):format(one.force, one.low, one.high, inside and "" or " misses")
    print(("%-22s %-8s %-30s %-8d %-8.1f %.0f"):format(k == 1 and body.name or "",
      k == 1 and ("%.3f"):format(max_force / min_force) or "", interval, one.count,
      same_place(one, finest), one.cpu))
  end
  io.stdout:flush()
end
print(("largest over smallest at most %.3f; %d of %d intervals contain the force of the %s"):format(max, covered,
  all, opts.overkill > 0 and "overkill mesh" or "finest start"))
