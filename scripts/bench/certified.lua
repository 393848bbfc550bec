-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Upper bounds of the worst case on machine parts (scripts/worst_case/machine_parts.lua): the gap, how much of
-- the bound the search alone reaches, processor seconds, and the size of the certificate.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. folder .. "/../worst_case/?.lua;" .. package.path
local options = require "options"
local script = require "barwright.command.script"

-- Chosen before the bound was computed on any of them.
local developed = {"gear", "housing", "clip", "angle bracket", "flange"}
local unseen = {"pillow block", "motor bracket", "bell crank"}
local FORCE, PRESSURE = 20, 2e5

local opts = script.read {
  summary = "certified upper bounds of the worst case on machine parts",
  options = {script.option.out, options.unseen, options.only, options.elements(40000),
    {name = "gap", value = "FRACTION", type = "number", default = 0.05, min = 0.001, max = 0.5,
      what = "the largest gap between bound and load that is asked for"},
    {name = "check", type = "flag", what = "check the certificate as well"},
    {name = "brute", type = "flag", what = "the processor seconds of brute force on the same mesh, too"},
  },
}

local results = opts.out and assert(script.results(opts.out, opts, {script = "scripts/bench/certified.lua"}))

local parts = require(opts.unseen and "unseen_parts" or "machine_parts")
local chosen = opts.unseen and unseen or developed

local function measure(part, path)
  local mesh = assert(bw.mesh.fill(parts.surface(part), {elements = opts.elements, tolerance = 0.1}))
  local model = bw.model {mesh = mesh, material = bw.material.pla}
  local load, brute = {force = FORCE, pressure = PRESSURE}, nil
  local start = os.clock()
  if opts.brute then
    assert(bw.brute_force(model, load))
    brute, start = os.clock() - start, os.clock()
  end
  local search <close> = assert(bw.worst_case(model, load))
  local searched = os.clock()
  load.certify, load.certificate = opts.gap, path
  local worst <close> = assert(bw.worst_case(model, load))
  local row = {part = part.name, elements = mesh.element_count, nodes = mesh.node_count,
    pressures = worst.basis.count, reached_pa = worst.max_principal, upper_bound_pa = worst.upper_bound,
    gap = worst.gap, search_over_bound = search.max_principal / worst.upper_bound,
    seconds_search = searched - start, seconds_certified = os.clock() - searched,
    seconds_brute_force = brute}
  local file <close> = assert(io.open(path))
  row.certificate_bytes = file:seek "end"
  if opts.check then
    start = os.clock()
    row.checked_bound_pa = assert(bw.check_certificate(path)).upper_bound
    row.seconds_check = os.clock() - start
  end
  return row
end

local function brute_text(row)
  local seconds = row.seconds_brute_force
  return seconds and (", brute force %.1f s (%.2f times)"):format(seconds, row.seconds_certified / seconds) or ""
end

local rows, path = {}, os.tmpname()
for _, part in ipairs(parts.list) do
  local wanted = false
  for _, name in ipairs(chosen) do wanted = wanted or name == part.name and (opts.only or name) == name end
  if wanted then
    local row = measure(part, path)
    rows[#rows + 1] = row
    print(("%-14s %6d elements %5d pressures: gap %.4f, search over bound %.4f, search %.1f s, certified %.1f s, "
      .. "certificate %.1f MB%s%s"):format(row.part, row.elements, row.pressures, row.gap, row.search_over_bound,
      row.seconds_search, row.seconds_certified, row.certificate_bytes / 1e6,
      row.seconds_check and (", checked in %.1f s"):format(row.seconds_check) or "",
      brute_text(row)))
    io.stdout:flush()
    collectgarbage()
  end
end
os.remove(path)
if results then assert(results:write {benchmark = "certified", rows = bw.json.list(rows)}) end
