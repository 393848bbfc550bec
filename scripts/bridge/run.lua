-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Designs a bridge: the smallest area that carries a load on the middle of a span below a stress limit.
local bw = require "barwright"
local core = require "barwright.core"
local html = require "barwright.html"
local script = require "barwright.command.script"

local PASSES, FAILS = 0, 3

local function read_arguments()
  return script.read {
    summary = "a bridge of the smallest area that carries a load",
    about = "Designs a bridge: the smallest area that carries a load on the middle of a span below a stress "
      .. "limit. Ctrl-C ends the search; what is best so far is written.\n\n"
      .. "DIR gets result.json, manifest.json, bridge.svg (coloured by stress), bridge_cut.svg and bridge_cut.dxf "
      .. "(outlines to cut, mm), bridge.stl and report.html.\n\n"
      .. "Exit status: 0 a bridge that passes; 2 the input was refused; 3 none that passes was found; 130 "
      .. "interrupted.",
    options = {script.option.needed_out,
      {name = "span", value = "LENGTH", type = "number", unit = "m", default = 0.2, above = 0,
        what = "distance of the supports"},
      {name = "load", value = "FORCE", type = "number", unit = "N", default = 1500, above = 0,
        what = "on the middle"},
      {name = "limit", value = "STRESS", type = "number", unit = "Pa", default = 30e6, above = 0,
        what = "von Mises stress that the bridge must stay below"},
      {name = "thickness", value = "LENGTH", type = "number", unit = "m", default = 0.004, above = 0,
        what = "thickness of the plate"},
      {name = "depth", value = "LENGTH", type = "number", unit = "m", above = 0,
        what = "height of the load above the feet; without it, half the span"},
      {name = "wall", value = "LENGTH", type = "number", unit = "m", above = 0,
        what = "smallest thickness of walls; without it, a fiftieth of the span"},
      {name = "size", value = "LENGTH", type = "number", unit = "m", above = 0,
        what = "edge of triangles; without it, a hundredth of the span"},
      {name = "material", value = "NAME", what = "of `barwright materials`, instead of --young and --poisson"},
      {name = "young", value = "STRESS", type = "number", unit = "Pa", default = 3e9, above = 0,
        what = "Young's modulus"},
      {name = "poisson", value = "NUMBER", type = "number", default = 0.35, above = -1, below = 0.5,
        what = "Poisson's ratio"},
      {name = "starts", value = "NAME,...", list = true, one_of = {"truss", "gable", "beam", "arch"},
        default = {"truss", "gable", "beam", "arch"}, what = "designs that the search starts from"},
      {name = "rounds", value = "N", type = "integer", default = 120, min = 0, what = "largest number of rounds"},
      {name = "holes", value = "N", type = "integer", default = 6, min = 0,
        what = "holes in a half, at most, that are opened"},
      {name = "polish", value = "N", type = "integer", default = 40, min = 0,
        what = "rounds on the finer mesh, at most"},
      script.option.threads,
    },
  }
end

local function given(value, message, ...)
  if value == nil then script.fail(script.REFUSED, message, ...) end
  return value, message, ...
end

local function checked(...)
  return given(script.checked(...))
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
  local material = opts.material and checked(bw.material.named, opts.material) or checked(
    bw.material.isotropic, {name = "given", young = opts.young, poisson = opts.poisson, density = 1000})
  local results = checked(script.results, opts.out, opts, {script = "scripts/bridge/run.lua"})
  local bridge = checked(bw.responsive.bridge, {span = opts.span, load = opts.load,
    stress_limit = opts.limit, material = material, thickness = opts.thickness, depth = opts.depth,
    wall = opts.wall, size = opts.size})
  local height, beam = checked(bridge.uniform_beam, bridge)
  print(("beam of one height: %s high, %s"):format(core.quantity(height, "m"), core.quantity(beam, "m2")))
  local found = checked(bridge.design, bridge, {starts = opts.starts, rounds = opts.rounds, holes = opts.holes,
    polish = opts.polish, report = function(now)
      if now.round % 20 == 0 then
        print(("%-6s round %3d: %s, stress %.1f %%; best %s"):format(now.start, now.round,
          core.quantity(now.area, "m2"), 100 * now.utilisation, core.quantity(now.best_area, "m2")))
      end
    end})
  local result = {finished = not found.interrupted, passes = found.passes, converged = found.converged,
    start = found.start,
    area_m2 = bridge.area, utilisation = found.utilisation,
    checked_utilisation = found.checked_utilisation, checked_elements = found.checked_elements,
    beam_height_m = height, beam_area_m2 = beam, michell_area_m2 = bridge:michell_area(),
    moment_fraction = bridge:moment_fraction(), message = found.message,
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
  print(("%.1f %% of the area of the beam of one height, %.2f times Michell's bars; %.1f s"):format(
    100 * bridge.area / beam, bridge.area / result.michell_area_m2, result.seconds_total))
  if found.message then print(found.message) end
  return found.passes and PASSES or FAILS
end

script.run(main, FAILS)
