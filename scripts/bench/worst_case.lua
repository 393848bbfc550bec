-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The paper's worst-case analysis (method "paper") by stage, at the sizes of the paper's table of timings, beside
-- the paper's minutes. Filling is shown on its own.
local bw = require "barwright"
local script = require "barwright.command.script"

-- worst-case, section 5 (full pipeline, minutes)
local paper = {{2723, 0.028}, {42900, 0.308}, {70356, 0.382}, {155383, 2.566}, {322398, 9.601},
  {414894, 4.490}}

local all = {}
for i, line in ipairs(paper) do all[i] = line[1] end

local opts = script.read {
  summary = "the paper's worst-case analysis by stage, beside the paper's minutes",
  arguments = {{name = "model", type = "file", optional = true,
    what = "a surface (default: the toy foal of the demonstration)"}},
  options = {script.option.out,
    {name = "sizes", value = "N,N,...", type = "integer", list = true, one_of = all, default = all,
      what = "the paper's numbers of elements"}},
}
local model = opts.model
local sizes = {}
for _, size in ipairs(opts.sizes) do sizes[size] = true end

local results = opts.out and assert(bw.results.open(opts.out, {script = "scripts/bench/worst_case.lua",
  inputs = {model}, options = {sizes = opts.sizes}}))

local surface
if model then
  surface = assert(bw.surface.read(model))
else
  local f, min, max = bw.shapes.foal()
  surface = assert(bw.surface.implicit(f, {min = min, max = max, cells = 110}))
end

local function peak_gb()
  local file = io.open "/proc/self/status"
  local text = file and file:read "a" or ""
  if file then file:close() end
  return (tonumber(text:match "VmHWM:%s*(%d+)") or 0) / 2 ^ 20
end

-- Each size in a process of its own would give its own peak; sizes ascend, so the peak is the last's.
print("  elements | filling |  system   modes regions   loads |   total |   paper | ratio | peak GB")
local rows = {}
for _, line in ipairs(paper) do
  local wanted, minutes = line[1], line[2]
  if sizes[wanted] then
    local start = bw.seconds()
    local mesh = assert(bw.mesh.fill(surface, {elements = wanted}))
    local filling = bw.seconds() - start
    local part = bw.model {mesh = mesh, material = bw.material.green_state_stainless_steel}
    local area = mesh.boundary.area
    start = bw.seconds()
    local worst = assert(bw.worst_case(part,
      {force = math.min(20, 0.05 * 2e5 * area), modes = 15, regions = 5,
      method = "paper"}))
    local total = bw.seconds() - start
    local s = worst.seconds
    print(("%10d | %6.1f s | %6.2f s %6.2f %7.2f %7.2f | %6.2f s | %5.1f s | %5.1f | %.2f"):format(
      mesh.element_count, filling, s.system, s.modes, s.regions, s.linear_programs, total, 60 * minutes,
      60 * minutes / total, peak_gb()))
    rows[#rows + 1] = {wanted = wanted, elements = mesh.element_count, seconds_filling = filling,
      seconds_system = s.system, seconds_modes = s.modes, seconds_regions = s.regions,
      seconds_loads = s.linear_programs, seconds_total = total, seconds_paper = 60 * minutes,
      times_faster = 60 * minutes / total, peak_memory_gb = peak_gb(), regions = #worst.regions}
    worst:close()
    mesh:close()
    collectgarbage()
  end
end
if results then assert(results:write {benchmark = "worst_case", rows = bw.json.list(rows)}) end
