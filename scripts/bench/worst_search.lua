-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst-case search against brute force on the same mesh: 99.75th percentile by volume and peak of
-- the weakness map, of the paper's weak regions and of the search, and seconds of both.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. folder .. "/../worst_case/?.lua;" .. package.path
local options = require "options"
local script = require "barwright.command.script"

-- Chosen before any was measured.
local surfaces = {"engine_bracket.obj", "gear_spur.stl", "tray_bottom.stl", "rocker_arm.obj", "fandisk.obj",
  "fan_blade.stl", "anchor.off", "bottle_opener_round.stl", "chair.ply", "screwdriver.ply", "fertility.off",
  "triceratops.off", "cat.obj"}
local DIAGONAL, PRESSURE, MAX_PRESSURE_FRACTION = 0.1, 2e5, 0.05

local opts = script.read {
  summary = "the worst-case search against brute force on the same mesh",
  about = "The bodies are the machine parts of scripts/worst_case/machine_parts.lua and, with --models, surfaces "
    .. "of a folder, scaled to a box diagonal of 100 mm.",
  options = {script.option.out, options.models, options.unseen, options.only, options.elements(3000),
    {name = "principal", type = "flag",
      what = "beside it brute force that maximises the principal stress of every element (three times as long)"},
    {name = "certify", value = "FRACTION", type = "number", default = 0, min = 0, max = 0.5,
      what = "an upper bound within that fraction, what of it the search reaches, and its seconds; 0: without"},
  },
}

local results = opts.out and assert(script.results(opts.out, opts, {script = "scripts/bench/worst_search.lua"}))

local function scaled(surface)
  local min, max = surface.box.min, surface.box.max
  local diagonal = math.sqrt((max[1] - min[1]) ^ 2 + (max[2] - min[2]) ^ 2 + (max[3] - min[3]) ^ 2)
  return surface:scale(DIAGONAL / diagonal)
end

local bodies, parts = {}, require(opts.unseen and "unseen_parts" or "machine_parts")
for _, part in ipairs(parts.list) do
  bodies[#bodies + 1] = {name = part.name, surface = function() return parts.surface(part) end}
end
for _, file in ipairs(opts.models and surfaces or {}) do
  bodies[#bodies + 1] = {name = file:match "^[^.]*", surface = function()
    return scaled(assert(bw.surface.read(opts.models .. "/" .. file)))
  end}
end

local function quantile(mesh, map) return map:quantile(0.9975, mesh.volumes) end

-- Processor seconds: other work on the machine does not count.
local function timed(f)
  local start = os.clock()
  local value = f()
  return value, os.clock() - start
end

local function measure(body)
  local mesh = assert(bw.mesh.fill(body.surface(), {elements = opts.elements, tolerance = 0.1}))
  local part = bw.model {mesh = mesh, material = bw.material.pla}
  local load = {force = math.min(20, MAX_PRESSURE_FRACTION * PRESSURE * mesh.boundary.area), pressure = PRESSURE}
  local function with(key, value)
    return {force = load.force, pressure = load.pressure, [key] = value}
  end
  local paper, paper_seconds = timed(function() return assert(bw.worst_case(part, with("method", "paper"))) end)
  local search, search_seconds = timed(function()
    return assert(bw.worst_case(part, with("method", "search")))
  end)
  local brute, brute_seconds = timed(function() return assert(bw.brute_force(part, load)) end)
  local q, peak = quantile(mesh, brute.weakness), brute.max_principal
  local row = {model = body.name, elements = mesh.element_count, force_n = load.force,
    brute_force_pa = q, brute_force_peak_pa = peak, seconds_brute_force = brute_seconds,
    paper = quantile(mesh, paper.weakness) / q, paper_peak = paper.max_principal / peak,
    search = quantile(mesh, search.weakness) / q, search_peak = search.max_principal / peak,
    seconds_paper = paper_seconds, seconds_search = search_seconds, loads = #search.regions}
  if opts.principal then
    local best = assert(bw.brute_force(part, with("objective", "principal")))
    row.principal = quantile(mesh, best.weakness) / q
    row.principal_peak = best.max_principal / peak
  end
  if opts.certify > 0 then
    local certified, seconds = timed(function()
      return assert(bw.worst_case(part, with("certify", opts.certify)))
    end)
    row.upper_bound_pa, row.gap = certified.upper_bound, certified.gap
    row.of_bound, row.seconds_bound = search.max_principal / certified.upper_bound, seconds - search_seconds
  end
  return row
end

local function spread(rows, key)
  local list = {}
  for k, row in ipairs(rows) do list[k] = row[key] end
  table.sort(list)
  return {min = list[1], median = list[(#list + 1) // 2], max = list[#list]}
end

print("model               | elements | paper 99.75 %, peak | search 99.75 %, peak | seconds paper, search "
  .. "(ratio) | brute force")
local rows = {}
for _, body in ipairs(bodies) do
  if not opts.only or opts.only == body.name then
    local row = measure(body)
    row.cost = row.seconds_search / row.seconds_paper
    rows[#rows + 1] = row
    print(("%-19s | %8d | %8.3f %10.3f | %8.3f %11.3f | %6.2f %6.2f (%.2f) | %6.1f s%s"):format(row.model,
      row.elements, row.paper, row.paper_peak, row.search, row.search_peak, row.seconds_paper, row.seconds_search,
      row.cost, row.seconds_brute_force, row.principal
        and ("; principal %.3f %.3f"):format(row.principal, row.principal_peak) or ""))
    if row.gap then
      print(("  upper bound %.4g MPa, gap %.4f, search over bound %.4f, %.1f s"):format(row.upper_bound_pa / 1e6,
        row.gap, row.of_bound, row.seconds_bound))
    end
    io.stdout:flush()
    collectgarbage()
  end
end
local summary = {}
for _, key in ipairs {"paper", "paper_peak", "search", "search_peak", "cost"} do
  local s = spread(rows, key)
  summary[key] = s
  print(("%-12s least %.3f, median %.3f, most %.3f"):format(key, s.min, s.median, s.max))
end
if results then
  assert(results:write {benchmark = "worst_search", rows = bw.json.list(rows), summary = summary})
end
