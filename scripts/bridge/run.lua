-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Designs a bridge: the smallest area that carries a load on the middle of a span below a stress limit.
--   build/barwright scripts/bridge/run.lua --out DIR [--span 0.2] [--load 1500] [--limit 30e6]
--       [--thickness 0.004] [--depth 0.1] [--wall 0.004] [--material NAME | --young 3e9 --poisson 0.35]
--       [--starts truss,gable,beam,arch] [--rounds 120] [--holes 6] [--polish 40] [--threads N]
-- Lengths in m, load in N, limit (von Mises) and Young's modulus in Pa. DIR gets result.json,
-- manifest.json, bridge.svg (coloured by stress), bridge_cut.svg and bridge_cut.dxf (outlines to cut,
-- mm), bridge.stl and report.html. Ctrl-C ends the search; what is best so far is written.
-- Exit status 0: a bridge that passes. 2: the input was refused. 3: none that passes was found.
local bw = require "barwright"
local core = require "barwright.core"
local html = require "barwright.html"

local PASSES, REFUSED, FAILS = 0, 2, 3

local known = {
  span = {"number", 0.2}, load = {"number", 1500}, limit = {"number", 30e6},
  thickness = {"number", 0.004}, depth = {"number"}, wall = {"number"}, young = {"number", 3e9},
  poisson = {"number", 0.35}, material = {"string"}, starts = {"string", "truss,gable,beam,arch"},
  rounds = {"whole number", 120}, holes = {"whole number", 6}, polish = {"whole number", 40},
  threads = {"whole number"}, size = {"number"}, out = {"string"},
}

local function stop(status, message)
  io.stdout:flush()
  io.stderr:write("bridge: ", (tostring(message):gsub("%s*\n%s*", " ")), "\n")
  os.exit(status, true)
end

local function help()
  for line in io.lines(arg[0]) do
    local text = line:match "^%-%- ?(.*)"
    if not text then break end
    if not text:match "^Copyright" then print(text) end
  end
  os.exit(PASSES, true)
end

local function read_arguments()
  local opts = {}
  for name, about in pairs(known) do opts[name] = about[2] end
  local i = 1
  while i <= #arg do
    local name, value = arg[i]:match "^%-%-([^=]+)=?(.*)$"
    if arg[i] == "-h" or arg[i] == "--help" then help() end
    if not name or not known[name] then
      local names = {}
      for key in pairs(known) do names[#names + 1] = "--" .. key end
      stop(REFUSED, ("unknown option %s: %s"):format(arg[i],
        require "barwright.core".suggestion("--" .. (name or arg[i]), names)))
    end
    if not arg[i]:find("=", 1, true) then
      i = i + 1
      value = arg[i]
    end
    local kind = known[name][1]
    local read = value
    if kind ~= "string" then read = tonumber(value or "") end
    if kind == "whole number" and read then read = math.tointeger(read) end
    if not read or kind ~= "string" and (read ~= read or read < 0 or read == math.huge) then
      stop(REFUSED, ("option --%s: a %s expected, got %s"):format(name, kind, tostring(value)))
    end
    opts[name] = read
    i = i + 1
  end
  if not opts.out or opts.out == "" then stop(REFUSED, "--out DIR is missing (--help tells the options)") end
  return opts
end

local function checked(f, ...)
  local values = table.pack(pcall(f, ...))
  if not values[1] then stop(REFUSED, (tostring(values[2]):gsub("^[^:]+:%d+: ", ""))) end
  if values[2] == nil then stop(REFUSED, values[3]) end
  return table.unpack(values, 2, values.n)
end

local function page(result, opts, picture)
  local rows = {}
  for i, one in ipairs(result.starts) do
    rows[i] = {one.start, one.area_m2 and ("%.1f"):format(one.area_m2 * 1e6) or one.message,
      one.utilisation and ("%.1f"):format(100 * one.utilisation) or "", one.rounds or ""}
  end
  local about = ("Area %.5g mm²; the best beam of one height needs %.5g mm². Largest von Mises stress %.1f %% of "
    .. "%.4g MPa, on a mesh of %d six-node triangles %.1f %%."):format(result.area_m2 * 1e6,
    result.beam_area_m2 * 1e6, 100 * result.utilisation, opts.limit / 1e6, result.checked_elements or 0,
    100 * (result.checked_utilisation or 0))
  return html.document {title = ("A bridge over %.4g mm for %.4g N"):format(opts.span * 1e3, opts.load),
    body = "<p>" .. html.escape(about) .. "</p>\n" .. html.figure(picture, "the bridge, coloured by stress")
      .. html.table({"start", "area, mm²", "stress, %", "rounds"}, rows, "numbers")}
end

local function main()
  local opts = read_arguments()
  local begin = bw.seconds()
  if opts.threads then checked(bw.threads, opts.threads) end
  local material = opts.material and checked(bw.material.named, opts.material) or checked(
    bw.material.isotropic, {name = "given", young = opts.young, poisson = opts.poisson, density = 1000})
  local names = {}
  for name in opts.starts:gmatch "[^,]+" do names[#names + 1] = name end
  local results = checked(bw.results.open, opts.out, {script = "scripts/bridge/run.lua", options = opts})
  local bridge = checked(bw.responsive.bridge, {span = opts.span, load = opts.load,
    stress_limit = opts.limit, material = material, thickness = opts.thickness, depth = opts.depth,
    wall = opts.wall, size = opts.size})
  local height, beam = checked(bridge.uniform_beam, bridge)
  print(("beam of one height: %.4g mm high, %.5g mm2"):format(height * 1e3, beam * 1e6))
  local found = checked(bridge.design, bridge, {starts = names, rounds = opts.rounds, holes = opts.holes,
    polish = opts.polish, report = function(now)
      if now.round % 20 == 0 then
        print(("%-6s round %3d: %.5g mm2, stress %.1f %%; best %.5g mm2"):format(now.start, now.round,
          now.area * 1e6, 100 * now.utilisation, now.best_area * 1e6))
      end
    end})
  local result = {finished = not found.interrupted, passes = found.passes, converged = found.converged,
    start = found.start,
    area_m2 = bridge.area, utilisation = found.utilisation,
    checked_utilisation = found.checked_utilisation, checked_elements = found.checked_elements,
    beam_height_m = height, beam_area_m2 = beam, michell_area_m2 = bridge:michell_area(),
    moment_share = bridge:moment_share(), message = found.message,
    holes = #bridge.whole.loops - 1, starts = bw.json.list {}}
  for i, one in ipairs(found.starts) do
    result.starts[i] = {start = one.start, area_m2 = one.area, utilisation = one.utilisation,
      passes = one.passes, rounds = one.rounds, message = one.message}
  end
  checked(bridge.picture, bridge, results:path "bridge.svg")
  local whole = bridge.whole
  checked(whole.write, whole, results:path "bridge_cut.svg")
  checked(whole.write, whole, results:path "bridge_cut.dxf")
  local body = checked(bridge.body, bridge)
  checked(body.write, body, results:path "bridge.stl")
  checked(core.write_file, results:path "report.html", page(result, opts, results:path "bridge.svg"))
  result.seconds_total = bw.seconds() - begin
  result.peak_memory_bytes = bw.results.peak_memory()
  checked(results.write, results, result)
  print(("%s, from '%s'"):format(bridge, found.start))
  print(("%.5g mm2: %.1f %% of the beam of one height, %.2f times Michell's bars; %.1f s"):format(
    bridge.area * 1e6, 100 * bridge.area / beam, bridge.area / result.michell_area_m2,
    result.seconds_total))
  if found.message then print(found.message) end
  os.exit(found.passes and PASSES or FAILS, true)
end

main()
