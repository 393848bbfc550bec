-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst-case analysis of a model from one command.
--   build/barwright scripts/worst_case/run.lua MODEL --out DIR [--elements N] [--modes 15]
--       [--regions 5] [--material NAME] [--unit mm] [--force N] [--pressure PA] [--fraction 0.025]
--       [--measure stress|energy] [--target stress|displacement] [--laplacian] [--order 1|2]
--       [--method search|paper] [--certify SHARE [--certificate FILE]]
--       [--contact M2] [--fix PLACE]... [--forbid PLACE]... [--friction MU] [--friction-facets 8]
--       [--hands K] [--hand M2]
-- The last two lines say which loads are admissible (docs/theory/worst_case.md, section 15): --contact
-- instead of --pressure; held and forbidden places such as low:z or near:0,0,30mm:5mm.
-- MODEL: a surface (STL OBJ OFF PLY), which is repaired where it must be and filled, or a mesh of
-- tetrahedra (.msh .vtu .mesh .inp .node), which is taken as it is. The stress is that of one
-- mesh, without a verdict. Exit status 0: answered. 2: the
-- input was refused, one sentence on standard error. 3: the computation could not finish.
local bw = require "barwright"
local core = require "barwright.core"
local places = require "barwright.command.places"

local ANSWERED, REFUSED, UNFINISHED, INTERRUPTED = 0, 2, 3, 130

-- Without loads in mind: 20 N and 0.2 MPa, a hand's (the worst-case paper, section 6).
-- kind, default, least and most ("above": more than the least).
local known = {
  elements = {"whole number", 40000, 1, 1e8}, modes = {"whole number", 15, 1, 500},
  regions = {"whole number", 5, 1, 1000}, material = {"string", "pla"}, unit = {"string"},
  force = {"number", 20, above = 0}, pressure = {"number", nil, above = 0},
  fraction = {"number", 0.025, nil, 1, above = 0}, measure = {"string", "stress"},
  target = {"string", "stress"}, laplacian = {"flag", false}, order = {"whole number", 1, 1, 2},
  contact = {"number", nil, above = 0}, fix = {"places"}, forbid = {"places"},
  friction = {"number", 0, 0, 100}, ["friction-facets"] = {"whole number", 8, 3, 64},
  hands = {"whole number", nil, 1, 16}, hand = {"number", nil, above = 0},
  certify = {"number", nil, 0.001, 0.5}, certificate = {"string"},
  method = {"string"}, out = {"string"}, threads = {"whole number", nil, 1, 64},
}

local PRESSURE = 2e5

-- The share of what full pressure could push that the total force may be: with less room the
-- linear program has few loads to choose from, or none.
local MAX_PRESSURE_FRACTION = 0.05

local function stop(status, message)
  io.stdout:flush()
  io.stderr:write("worst_case: ", (message:gsub("%s*\n%s*", " ")), "\n")
  os.exit(status, true)
end

local function usage(message)
  stop(REFUSED, message .. " (usage: run.lua MODEL --out DIR; --help tells the options)")
end

local function help()
  for line in io.lines(arg[0]) do
    local text = line:match "^%-%- ?(.*)"
    if not text then break end
    if not text:match "^Copyright" then print(text) end
  end
  os.exit(ANSWERED, true)
end

-- Before anything is read or computed: the value of an option, or a refusal.
local function value_of(name, text)
  local kind, _, min, max = table.unpack(known[name], 1, 4)
  local above = known[name].above
  if text == nil then usage(("option --%s: a value expected, got nothing"):format(name)) end
  if kind == "string" then return text end
  if kind == "places" then
    local fine, message = places.check(text)
    if not fine then usage(("option --%s: %s"):format(name, message)) end
    return text
  end
  local value = tonumber(text)
  local fits = value and value - value == 0
  if fits and kind == "whole number" then
    value = math.tointeger(value)
    fits = value ~= nil
  end
  fits = fits and not (min and value < min or max and value > max or above and value <= above)
  if fits then return value end
  local range = min and (" from %g to %.10g"):format(min, max)
    or (max and " above %g and up to %g" or " above %g"):format(above, max)
  usage(("option --%s: a %s%s expected, got '%s'"):format(name, kind, range, text))
end

local function suggestion(name)
  local names = {}
  for key in pairs(known) do names[#names + 1] = "--" .. key end
  return core.suggestion("--" .. name, names)
end

-- Sets an option; places add up.
local function set(opts, name, text)
  local value = value_of(name, text)
  if known[name][1] == "places" then
    opts[name] = opts[name] or {}
    value = table.move({value}, 1, 1, #opts[name] + 1, opts[name])
  end
  opts[name] = value
end

local function read_arguments()
  local opts, model = {}, nil
  for key, about in pairs(known) do opts[key] = about[2] end
  local i = 1
  while i <= #arg do
    local name, joined = arg[i]:match "^%-%-([^=]+)=?(.*)$"
    if arg[i] == "-h" or arg[i] == "--help" then
      help()
    elseif not name then
      if model then usage(("one MODEL expected, got %s and %s"):format(model, arg[i])) end
      model = arg[i]
    elseif not known[name] then
      usage(("unknown option --%s: %s"):format(name, suggestion(name)))
    elseif known[name][1] == "flag" then
      opts[name] = true
    elseif arg[i]:find("=", 1, true) then
      set(opts, name, joined)
    else
      i = i + 1
      set(opts, name, arg[i])
    end
    i = i + 1
  end
  if not model or model == "" then usage "a MODEL is missing" end
  if not opts.out or opts.out == "" then usage "--out DIR is missing" end
  if opts.pressure and opts.contact then usage "--pressure and --contact say the same: give one of them" end
  if opts.certificate and not opts.certify then usage "--certificate is the file that proves --certify's bound" end
  if opts.hand and not opts.hands then usage "--hand is the area of each of --hands" end
  opts.pressure = opts.pressure or opts.contact and opts.force / opts.contact or PRESSURE
  return model, opts
end

-- Everything that can raise is misuse: of the options given on the command line, in this script.
local function checked(status, f, ...)
  local values = table.pack(pcall(f, ...))
  if not values[1] then
    if bw.interrupted() then stop(INTERRUPTED, "interrupted") end
    stop(status, (tostring(values[2]):gsub("^[^:]+:%d+: ", "")))
  end
  return table.unpack(values, 2, values.n)
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
  if details and details.status == "cancelled" then stop(INTERRUPTED, message) end
  if path and not message:find(path, 1, true) then message = path .. ": " .. message end
  stop(details and refusals[details.status] and REFUSED or UNFINISHED, message)
end

local function main()
  local model_path, opts = read_arguments()
  local start = bw.seconds()

  if opts.threads then checked(REFUSED, bw.threads, opts.threads) end
  local material = checked(REFUSED, bw.material.named, opts.material)

  -- ---- the model: a mesh, or a surface that is filled ----

  local function filled(path, surface, info, result)
    print(("read %s (%s): %s"):format(path, info.format, surface))
    result.input_triangles = surface.triangle_count
    local mesh, log, details = checked(REFUSED, bw.mesh.fill, surface,
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
      print(("  the surface was repaired; it moved by at most %.3g mm"):format(log.surface_moved * 1e3))
    end
    return mesh
  end

  local function load_mesh(path, result)
    local ending = (path:match "%.(%w+)$" or ""):lower()
    local may_be_mesh = ({msh = 1, vtu = 1, mesh = 1, inp = 1, node = 1, ele = 1})[ending]
    local function surface()
      return checked(REFUSED, bw.surface.read, path, {unit = opts.unit})
    end
    if not may_be_mesh then
      local found, info = prepared(surface())
      return filled(path, found, info, result)
    end
    local mesh, message, details = checked(REFUSED, bw.mesh.read, path, {unit = opts.unit})
    if not mesh then
      -- These two also hold surfaces. What the reader of meshes says tells more when they do not.
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
  local results = prepared(bw.results.open(opts.out, {script = "scripts/worst_case/run.lua",
    inputs = {model_path}, options = opts, seed = 1}))
  local mesh = load_mesh(model_path, result)
  print(mesh)
  result.elements, result.nodes = mesh.element_count, mesh.node_count
  result.bodies = mesh.component_count
  result.box_low_m, result.box_high_m = mesh.box.low, mesh.box.high
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
      checked(REFUSED, use, selection)
      area = area + selection.area
      print(("  %s at %s (%.4g mm2)"):format(what, place, selection.area * 1e6))
    end
    return area
  end
  result.held_area_m2 = selections(opts.fix, "held", function(selection) part:fix(selection) end)
  result.forbidden_area_m2 = selections(opts.forbid, "no pressure", function(selection)
    forbidden = forbidden or {}
    forbidden[#forbidden + 1] = selection
  end)

  -- ---- loads ----

  local force = opts.force
  local allowed = MAX_PRESSURE_FRACTION * opts.pressure * result.area_m2
  if force > allowed then
    print(("  %.4g N would press the whole surface (%.4g mm2) too much of the way to %.4g MPa: the total"
      .. " force is lowered to %.4g N, %g %% of pressure times area"):format(force,
      result.area_m2 * 1e6, opts.pressure / 1e6, allowed, 100 * MAX_PRESSURE_FRACTION))
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
    stop(details and details.status == "cancelled" and INTERRUPTED or UNFINISHED, message)
  end

  local worst, message, details = checked(REFUSED, bw.worst_case, part, {force = force,
    pressure = opts.pressure, forbidden = forbidden, friction = opts.friction,
    friction_facets = opts["friction-facets"], hands = opts.hands, hand = opts.hand, certify = opts.certify,
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
  print(("Pushed by %.4g N in the worst way that pressures up to %.4g MPa allow, %s is stressed most at"
    .. " (%.4g, %.4g, %.4g) mm: %.4g MPa."):format(force, opts.pressure / 1e6,
    model_path:match "[^/]+$", worst.at[1] * 1e3, worst.at[2] * 1e3, worst.at[3] * 1e3,
    worst.max_principal / 1e6))
  if used then
    print(("On this mesh that is %.3g %% of the strength of %s; %s. `barwright worst` gives an interval and a"
      .. " verdict."):format(100 * used, opts.material, core.error_unknown))
  else
    print(("The strength of %s is not known."):format(opts.material))
  end
  print(("%d elements, %d modes, %d regions; %.1f s, of which filling %.1f s."):format(
    result.elements, worst.modes.count, #worst.regions, result.seconds_total, result.seconds_fill))
end

-- What is raised here is neither the input's fault nor the world's.
local fine, message = xpcall(main, debug.traceback)
if bw.interrupted() then stop(INTERRUPTED, "interrupted") end
if not fine then stop(UNFINISHED, message) end
os.exit(ANSWERED, true)
