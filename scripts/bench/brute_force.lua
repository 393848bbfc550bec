-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Weak regions against brute force, as the paper's figure 7 and table 1: 99.75th percentiles side by
-- side, and seconds beside the paper's.
--   build/barwright scripts/bench/brute_force.lua [--out FILE.json] [--markdown FILE.md] [--quick]
local bw = require "barwright"
local shapes = bw.shapes

-- worst-case, table 1 (elements, brute force, seconds)
local paper = {[2723] = 681.367, [2869] = 793.362, [2904] = 894.610, [5332] = 2120.361,
  [11020] = 11029.721, [12853] = 11334.362, [14163] = 27775.900, [16008] = 19917.838}

local function body(make, cells)
  local f, low, high = make()
  return assert(bw.surface.implicit(f, {low = low, high = high, cells = cells}))
end

local function dumbbell()
  return shapes.join({shapes.sphere({-0.03, 0, 0}, 0.012), shapes.sphere({0.03, 0, 0}, 0.012),
    shapes.limb({-0.03, 0, 0}, {0.03, 0, 0}, 0.006)}, 0.004), {-0.05, -0.02, -0.02}, {0.05, 0.02, 0.02}
end

local function stool()
  local bodies = {shapes.box({-0.03, -0.02, 0.03}, {0.03, 0.02, 0.038})}
  for _, x in ipairs {-0.025, 0.025} do
    for _, y in ipairs {-0.015, 0.015} do
      bodies[#bodies + 1] = shapes.limb({x, y, 0}, {x * 0.9, y * 0.9, 0.033}, 0.0035, 0.0045)
    end
  end
  return shapes.join(bodies, 0.003), {-0.04, -0.03, -0.006}, {0.04, 0.03, 0.047}
end

local function hook()
  local bodies = {shapes.limb({0, 0, 0}, {0, 0, 0.05}, 0.004, 0.003)}
  local last = {0, 0, 0.05}
  for step = 1, 8 do
    local a = math.pi * step / 8
    local at = {0.012 * (1 - math.cos(a)), 0, 0.05 + 0.012 * math.sin(a)}
    bodies[#bodies + 1] = shapes.limb(last, at, 0.003, 0.0028)
    last = at
  end
  bodies[#bodies + 1] = shapes.sphere({0, 0, -0.003}, 0.008)
  return shapes.join(bodies, 0.0015), {-0.015, -0.015, -0.015}, {0.04, 0.015, 0.08}
end

-- name, elements wanted (as in the paper's table), shape, cells of its first surface
local models = {
  {"dumbbell", 2723, dumbbell, 40},
  {"stool", 2869, stool, 48},
  {"hook", 5332, hook, 64},
  {"opener", 11020, shapes.opener, 64},
  {"foal", 16008, shapes.foal, 64},
}

local out, markdown, quick
for i, a in ipairs(arg) do
  if a == "--out" then out = arg[i + 1] end
  if a == "--markdown" then markdown = arg[i + 1] end
  if a == "--quick" then quick = true end
end

print("model    | elements | weak regions | brute force  | ratio | seconds (paper)      | faster")
local rows, ratios = {}, {}
for i, model in ipairs(models) do
  if quick and i > 2 then break end
  local name, wanted, make = model[1], model[2], model[3]
  local mesh = assert(bw.mesh.fill(body(make, model[4]), {elements = wanted, tolerance = 0.05}))
  local part = bw.model {mesh = mesh, material = bw.material.green_state_stainless_steel}
  local load = {force = math.min(20, 0.05 * 2e5 * mesh.boundary.area), pressure = 2e5}
  local worst = assert(bw.worst_case(part, load))
  local all = assert(bw.brute_force(part, load))
  local both = all:compare(worst, 99.75)
  print(("%-8s | %8d | %8.3f MPa | %8.3f MPa | %5.3f | %7.1f s (%7.0f s) | %5.0f"):format(name,
    mesh.element_count, both.worst_case / 1e6, both.brute_force / 1e6, both.ratio, all.seconds,
    paper[wanted], paper[wanted] / all.seconds))
  ratios[#ratios + 1] = both.ratio
  rows[#rows + 1] = {model = name, elements = mesh.element_count,
    weak_regions_pa = both.worst_case, brute_force_pa = both.brute_force, ratio = both.ratio,
    seconds_brute_force = all.seconds, seconds_paper = paper[wanted],
    times_faster = paper[wanted] / all.seconds}
end
table.sort(ratios)
local median = ratios[(#ratios + 1) // 2]
print(("median ratio %.3f"):format(median))
if markdown then
  local lines = {"## Weak regions against brute force", "",
    "Made by `build/barwright scripts/bench/brute_force.lua --markdown FILE`. Brute force makes every",
    "element a region of its own. Percentiles are of the weakness map, by volume, as in figure 7 of the",
    "paper; the paper's seconds are those of its table 1 for the nearest number of elements.", "",
    "| model | elements | 99.75th percentile, weak regions | brute force | ratio | s | paper, s | faster |",
    "|---|---|---|---|---|---|---|---|"}
  for _, row in ipairs(rows) do
    lines[#lines + 1] = ("| %s | %d | %.3f MPa | %.3f MPa | %.3f | %.1f | %.0f | %.0f times |"):format(
      row.model, row.elements, row.weak_regions_pa / 1e6, row.brute_force_pa / 1e6, row.ratio,
      row.seconds_brute_force, row.seconds_paper, row.times_faster)
  end
  lines[#lines + 1] = ("\nMedian ratio %.3f.\n"):format(median)
  local file = assert(io.open(markdown, "w"))
  file:write(table.concat(lines, "\n"), "\n")
  file:close()
end
if out then
  local file = assert(io.open(out, "w"))
  file:write(bw.json.encode {benchmark = "brute_force", rows = rows, median_ratio = median}, "\n")
  file:close()
end
