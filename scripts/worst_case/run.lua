-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst-case analysis of a model on one mesh from one command.
local bw = require "barwright"
local core = require "barwright.core"
local model = require "barwright.command.model"
local places = require "barwright.command.places"
local script = require "barwright.command.script"
local shown = require "barwright.shown"

local UNFINISHED = 3
local checked = script.checked

local PRESSURE = 2e5

-- The fraction of what full pressure could push that the total force may be: with less room the
-- linear program has few loads to choose from, or none.
local MAX_PRESSURE_FRACTION = 0.05

local function count(name, default, min, max, what)
  return {name = name, value = "N", type = "integer", default = default, min = min, max = max, what = what}
end

-- Without loads in mind: 20 N and 0.2 MPa, a hand's (the worst-case paper, section 6).
local function read_arguments()
  local opts = script.read {
    summary = "the worst-case analysis of a model on one mesh",
    about = "The largest stress that loads within limits cause on one mesh, without a verdict: `barwright worst` "
      .. "gives an "
      .. "interval and a verdict. MODEL is a surface (STL, OBJ, OFF, PLY), which is repaired where it must be and "
      .. "filled, or a mesh of tetrahedra (.msh, .vtu, .mesh, .inp, .node), which is taken as it is. Section 15 "
      .. "of "
      .. "docs/theory/worst_case.md says which loads are admissible.\n\n" .. places.help .. "\n\n"
      .. "Exit status: 0 answered; 2 the input was refused; 3 the computation could not finish.",
    arguments = {{name = "model", type = "file", what = "a surface or a mesh"}},
    options = {script.option.needed_out,
      count("elements", 40000, 1, 100000000, "number of elements that a surface is filled with"),
      model.order_option,
      model.unit_option,
      {name = "material", value = "NAME", default = "pla", one_of = bw.material.names(),
        what = "what it is made of; `barwright materials` lists them"},
      {name = "force", value = "FORCE", type = "number", unit = "N", default = 20, above = 0,
        what = "the total force of the loads"},
      {name = "pressure", value = "STRESS", type = "number", unit = "Pa", above = 0,
        what = ("largest pressure of the loads; without it and --contact %g MPa"):format(PRESSURE / 1e6)},
      {name = "contact", value = "AREA", type = "number", unit = "m2", above = 0,
        what = "smallest area that carries the force, instead of --pressure"},
      model.fix_option,
      {name = "forbid", value = "PLACE", many = true, what = "places where nothing presses"},
      {name = "friction", value = "MU", type = "number", default = 0, min = 0, max = 100,
        what = "coefficient of friction of the loads"},
      count("friction-facets", 8, 3, 64, "facets that stand for the cone of friction"),
      {name = "hands", value = "K", type = "integer", min = 1, max = 16,
        what = "loads act within so many places at once; without it, anywhere"},
      {name = "hand", value = "AREA", type = "number", unit = "m2", above = 0,
        what = "area of each of the --hands"},
      model.search_options[1], model.search_options[2],
      {name = "fraction", value = "FRACTION", type = "number", default = 0.025, above = 0, max = 1,
        what = "fraction of the volume that a weak region may take"},
      {name = "measure", value = "NAME", one_of = {"stress", "energy"}, default = "stress",
        what = "what a mode measures"},
      {name = "target", value = "NAME", one_of = {"stress", "displacement"}, default = "stress",
        what = "what the loads maximise"},
      {name = "laplacian", type = "flag", what = "modes of the Laplacian instead of elastic ones"},
      {name = "method", value = "NAME", one_of = {"search", "paper"},
        what = "how loads are searched (default: search; paper with --target displacement)"},
      {name = "certify", value = "FRACTION", type = "number", min = 0.001, max = 0.5,
        what = "an upper bound that is proved, at most so much above the load that is found"},
      {name = "certificate", value = "FILE", type = "file", what = "the file that proves the bound of --certify"},
      script.option.threads,
    },
  }
  for _, name in ipairs {"fix", "forbid"} do
    for _, place in ipairs(opts[name]) do
      local ok, message = places.check(place)
      if not ok then script.refuse(("option --%s: %s"):format(name, message)) end
    end
  end
  if opts.pressure and opts.contact then
    script.refuse "--pressure and --contact say the same: give one of them"
  end
  if opts.certificate and not opts.certify then
    script.refuse "--certificate is the file that proves --certify's bound"
  end
  if opts.hand and not opts.hands then script.refuse "--hand is the area of each of --hands" end
  opts.pressure = opts.pressure or opts.contact and opts.force / opts.contact or PRESSURE
  return opts.model, opts
end

local warnings = bw.json.list {}

local function report_warnings()
  for _, warning in ipairs(bw.warnings()) do
    warnings[#warnings + 1] = warning
    print("  " .. warning)
  end
end

local refusals = {format = true, geometry = true, io = true, unsupported = true, empty = true,
  invalid = true}

-- A world's failure in preparing the input: refused when the input is to blame.
local function prepared(value, message, details, path)
  if value then return value, message end
  report_warnings()
  if path and not message:find(path, 1, true) then message = path .. ": " .. message end
  script.fail(details and refusals[details.status] and script.REFUSED or UNFINISHED, message, details)
end

local function main()
  local model_path, opts = read_arguments()
  local start = bw.seconds()

  local material = checked(bw.material.named, opts.material)

  -- ---- the model: a mesh, or a surface that is filled ----

  local function filled(path, surface, info, result)
    print(("read %s (%s): %s"):format(path, info.format, surface))
    result.input_triangles = surface.triangle_count
    local mesh, log, details = checked(bw.mesh.fill, surface,
      {elements = opts.elements, order = opts.order})
    prepared(mesh, log, details, path)
    report_warnings()
    result.repaired, result.surface_moved_m = log.repaired, log.surface_moved
    result.attempts = log.attempts
    result.seconds_repair, result.seconds_remesh = log.seconds_repair, log.seconds_remesh
    result.seconds_fill = log.seconds_fill
    result.surface_steps = bw.json.list {}
    for i, step in ipairs(log.steps) do
      result.surface_steps[i] = {name = step.name, count = step.count, moved_m = step.moved,
        text = step.text}
      print(("  %s: %s"):format(step.name, step.text))
    end
    if log.repaired then
      print(("  the surface was repaired; it moved by at most %s"):format(
        core.quantity(log.surface_moved, "m")))
    end
    return mesh
  end

  local function load_mesh(path, result)
    local ending = (path:match "%.(%w+)$" or ""):lower()
    local may_be_mesh = ({msh = 1, vtu = 1, mesh = 1, inp = 1, node = 1, ele = 1})[ending]
    local function surface()
      return checked(bw.surface.read, path, {unit = opts.unit})
    end
    if not may_be_mesh then
      local found, info = prepared(surface())
      return filled(path, found, info, result)
    end
    local mesh, message, details = checked(bw.mesh.read, path, {unit = opts.unit})
    if not mesh then
      -- These formats also contain surfaces. Without one, the message of the reader of meshes is the better one.
      if (ending == "msh" or ending == "vtu") and details.status == "format" then
        local found, info = surface()
        if found then return filled(path, found, info, result) end
      end
      prepared(mesh, message, details)
    end
    print(("read %s (%s)"):format(path, message.format))
    if opts.order ~= mesh.order then mesh = prepared(mesh:with_order(opts.order)) end
    result.repaired, result.surface_moved_m = false, 0
    result.seconds_repair, result.seconds_remesh, result.seconds_fill = 0, 0, 0
    return mesh
  end

  local result = {finished = false, material = opts.material}
  local results = prepared(script.results(opts.out, opts, {script = "scripts/worst_case/run.lua",
    inputs = {model_path}, seed = 1}))
  local mesh = load_mesh(model_path, result)
  print(mesh)
  result.elements, result.nodes = mesh.element_count, mesh.node_count
  result.bodies = mesh.component_count
  result.box_low_m, result.box_high_m = mesh.box.min, mesh.box.max
  result.volume_m3 = mesh.volume
  result.area_m2 = mesh.boundary.area
  if material.density then result.mass_kg = material.density * mesh.volume end

  -- ---- supports and forbidden surfaces ----

  local part = bw.model {mesh = mesh, material = material}
  local forbidden
  local function selections(list, what, use)
    local area = 0
    for _, place in ipairs(list or {}) do
      local selection = prepared(places.select(mesh, place))
      checked(use, selection)
      area = area + selection.area
      print(("  %s at %s (%s)"):format(what, place, core.quantity(selection.area, "m2")))
    end
    return area
  end
  result.supported_area_m2 = selections(opts.fix, "fixed", function(selection) part:fix(selection) end)
  result.forbidden_area_m2 = selections(opts.forbid, "no pressure", function(selection)
    forbidden = forbidden or {}
    forbidden[#forbidden + 1] = selection
  end)

  -- ---- loads ----

  local force = opts.force
  local allowed = MAX_PRESSURE_FRACTION * opts.pressure * result.area_m2
  if force > allowed then
    print(("  %s on a surface of %s is more than %s of the pressure %s times the area: the force is lowered to %s")
      :format(core.quantity(force, "N"), core.quantity(result.area_m2, "m2"), shown.percent(MAX_PRESSURE_FRACTION),
      core.quantity(opts.pressure, "Pa"), core.quantity(allowed, "N")))
    force = allowed
  end
  result.force_n, result.force_asked_n, result.force_lowered = force, opts.force, force < opts.force
  result.pressure_pa = opts.pressure

  -- ---- the analysis ----

  -- Keeps what is done: result.json then says "finished": false and why.
  local function unfinished(message, details)
    result.message, result.status = message, details and details.status
    result.remarks = warnings
    result.seconds_total = bw.seconds() - start
    results:write(result)
    script.fail(UNFINISHED, message, details)
  end

  local worst, message, details = checked(bw.worst_case, part, {force = force,
    pressure = opts.pressure, forbidden = forbidden, friction = opts.friction,
    friction_facets = opts.friction_facets, hands = opts.hands, hand = opts.hand, certify = opts.certify,
    certificate = opts.certificate,
    modes = opts.modes, regions = opts.regions, fraction = opts.fraction,
    measure = opts.measure, target = opts.target, laplacian = opts.laplacian, method = opts.method})
  report_warnings()
  if not worst then unfinished(message, details) end

  result.max_principal_pa, result.max_principal_at_m = worst.max_principal, worst.at
  result.utilisation = worst.utilisation
  result.friction, result.friction_error = opts.friction, worst.friction_error
  result.hands, result.hand_m2 = opts.hands, worst.options.hand
  result.upper_bound_pa, result.gap, result.bounded = worst.upper_bound, worst.gap, worst.bounded
  result.strength_pa = worst.strength
  result.max_displacement_m = worst.max_displacement
  result.worst_region = worst.region
  result.regions = bw.json.list {}
  for i, region in ipairs(worst.regions) do
    result.regions[i] = {origin = region.origin, target = region.target, mode = region.mode,
      rank = region.rank, elements = region.elements,
      volume_fraction = region.volume_fraction, max_principal_pa = region.max_principal,
      max_principal_at_m = region.at, utilisation = region.utilisation,
      max_displacement_m = region.displacement, objective = region.objective,
      seconds = region.seconds}
  end
  result.eigenvalues = worst.modes.eigenvalues
  result.frequencies_hz = worst.modes.frequencies
  for stage, seconds in pairs(worst.seconds) do result["seconds_" .. stage] = seconds end

  -- ---- what is left behind ----

  local outputs_start = bw.seconds()
  local function left(value, why, how)
    if not value then unfinished(why, how) end
  end
  left(worst:write(results:path "worst.vtu"))
  left(worst:picture(results:path "weakness.png"))
  left(worst:picture(results:path "worst_load.png", {region = worst.region}))
  left(worst:report(results:path "report.html", {manifest = results.manifest,
    title = "Worst case of " .. (model_path:match "[^/]+$" or model_path)}))
  result.seconds_outputs = bw.seconds() - outputs_start
  result.seconds_total = bw.seconds() - start
  result.peak_memory_bytes = bw.results.peak_memory()
  result.remarks = warnings
  result.finished = true
  left(results:write(result))

  local used = worst.utilisation
  print(("\n%s"):format(worst))
  print(("The worst load of %s with pressures up to %s causes the largest stress of %s at %s: %s."):format(
    core.quantity(force, "N"), core.quantity(opts.pressure, "Pa"), model_path:match "[^/]+$",
    core.point(worst.at), core.quantity(worst.max_principal, "Pa")))
  if used then
    print(("On this mesh that is %s of the strength of %s; %s. `barwright worst` gives an interval and a "
      .. "verdict."):format(shown.percent(used), opts.material, core.error_unknown))
  else
    print(("The strength of %s is not known."):format(opts.material))
  end
  print(("%d elements, %d modes, %d regions; %s, of which filling %s."):format(
    result.elements, worst.modes.count, #worst.regions,
    core.quantity(result.seconds_total, "s"), core.quantity(result.seconds_fill, "s")))
end

script.run(main, UNFINISHED)
