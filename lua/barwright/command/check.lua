-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright check MODEL: what a file holds, what is wrong with it, whether that can be repaired.
local bw = require "barwright"
local check_page = require "barwright.command.check_page"
local core = require "barwright.core"
local file_unit = require "barwright.command.file_unit"
local lengths = require "barwright.command.lengths"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local output = require "barwright.command.output"
local shown = require "barwright.shown"

-- Each kind of defect in words: one, many, what it means.
local kinds = {
  ["open edge"] = {"open edge", "open edges", "only one facet has this edge, so the surface is open there"},
  ["non-manifold edge"] = {"edge with more than two facets", "edges with more than two facets",
    "more than two walls meet there"},
  ["non-manifold point"] = {"point that several sheets share", "points that several sheets share",
    "bodies touch in a point there"},
  ["misoriented edge"] = {"edge whose facets disagree", "edges whose facets disagree",
    "their sides are opposite"},
  ["flipped shell"] = {"shell that faces the wrong way", "shells that face the wrong way", "inside out"},
  ["zero-area facet"] = {"facet without area", "facets without area", "its corners lie on a line"},
  ["duplicate facet"] = {"facet that is there twice", "facets that are there twice", "one of them is too many"},
  ["self-intersection"] = {"pair of facets that cross", "pairs of facets that cross",
    "the surface goes through itself"},
}
local order = {"open edge", "non-manifold edge", "non-manifold point", "misoriented edge", "flipped shell",
  "zero-area facet", "duplicate facet", "self-intersection"}

-- The value below which a fraction of the sorted list lies.
local function quantile(sorted, fraction)
  return sorted[math.max(1, math.ceil(fraction * #sorted))]
end

-- ---- surfaces --------------------------------------------------------------------------------------

-- What the page says first, besides the verdict: facts as of report_verdict.lua, advice, tables of check_page.lua.
local function new_page() return {facts = {}, advice = {}, tables = {}} end

local function add_fact(page, name, text) page.facts[#page.facts + 1] = {name, text} end

local function report_unit(read, page, out)
  local size = file_unit.size_of(read.box)
  local sentence, names = file_unit.guess(size, read.metres_per_unit or 1, read.unit)
  out:json {size_m = size, box_low_m = read.box.min, box_high_m = read.box.max,
    metres_per_unit = read.metres_per_unit, unit_doubtful = sentence ~= nil,
    unit_suggestions = names and bw.json.list(names)}
  add_fact(page, "Size", shown.size(size))
  if not sentence then return end
  out:say(sentence)
  page.advice[#page.advice + 1] = sentence
end

-- What a volume weighs where a material was given.
local function report_mass(read, volume, page, out)
  local material = read.made and read.made.default
  if not material or #read.made.named > 0 then return end
  local mass = material.density and material.density * volume
  if mass then
    out:say("Of %s it weighs %s.", material.name, core.quantity(mass, "kg"))
  else
    out:say("The density of %s is not known, and with it the mass.", material.name)
  end
  out:json {material = material.name, mass_kg = mass}
  add_fact(page, "Material", material.name)
  add_fact(page, "Mass", mass and core.quantity(mass, "kg"))
end

-- So many bodies of a CAD file are listed.
local MAX_BODIES = 20

-- What a CAD file says of its bodies: the exact values, not those of the triangles.
local function report_bodies(read, out)
  local info = read.info
  if not info.bodies then return end
  out:say("The unit of the file: %s; %s with %s.", model.unit_of(read, {unit = read.unit}),
    model.count(#info.bodies, "body", "bodies"), model.count(#info.faces, "face"))
  local bodies = bw.json.list {}
  for i, body in ipairs(info.bodies) do
    bodies[i] = {name = body.name, closed = body.closed, volume_m3 = body.volume, area_m2 = body.area}
    if i <= MAX_BODIES then
      out:say("  %s: %s, surface %s, of the exact shape", body.name,
        body.closed and core.quantity(body.volume, "m3") or "open", core.quantity(body.area, "m2"))
    end
  end
  if #bodies > MAX_BODIES then out:say("  and %d others.", #bodies - MAX_BODIES) end
  out:json {bodies = bodies, exact_volume_m3 = info.exact_volume, exact_area_m2 = info.exact_area}
end

local function report_defects(report, page, out)
  local counts, first, places, rows = {}, {}, {}, {}
  for _, defect in ipairs(report.defects) do
    first[defect.kind] = first[defect.kind] or defect
  end
  for _, kind in ipairs(order) do
    local count, words = report.count[kind] or 0, kinds[kind]
    if count > 0 then
      counts[kind:gsub("[ -]", "_")] = count
      local where = first[kind]
      out:say("  %s: %s; the first at %s", model.count(count, words[1], words[2]), words[3], core.point(where.at))
      places[kind:gsub("[ -]", "_")] = {at_m = where.at, facet = where.facet}
      rows[#rows + 1] = {model.count(count, words[1], words[2]), words[3], core.point(where.at)}
      page.callout = page.callout or {at = where.at, text = words[1]}
    end
  end
  page.tables[#page.tables + 1] = {"What is wrong", {"fault", "what it means", "the first at"}, rows}
  out:json {defects = counts, first_defects = places, holes = report.holes}
end

-- How much of the surface stands on how little material.
local function report_thickness(surface, opts, page, out)
  local values = surface:thickness(2000)
  local list = values:totable()
  table.sort(list)
  local thin, median = quantile(list, 0.01), quantile(list, 0.5)
  if median == math.huge then return true end
  out:say("Walls: 1 %% of the surface has less than %s of material under it, half of it less than %s.",
    core.quantity(thin, "m"), core.quantity(median, "m"))
  out:json {thickness_1_percent_m = thin, thickness_median_m = median}
  add_fact(page, "Walls", ("1 %% of the surface below %s, half of it below %s"):format(core.quantity(thin, "m"),
    core.quantity(median, "m")))
  if not opts.thin then return true end
  local below = 0
  for _, value in ipairs(list) do below = below + (value < opts.thin and 1 or 0) end
  local fraction = below / #list
  out:json {thin_fraction = fraction}
  out:say("%s of the surface has less than the %s asked for.",
    shown.percent(fraction), core.quantity(opts.thin, "m"))
  if fraction <= 0.01 then return true end
  page.advice[#page.advice + 1] = ("%s of the surface has less than %s of material under it: thicken it there.")
    :format(shown.percent(fraction), core.quantity(opts.thin, "m"))
  return false
end

local function report_repair(surface, opts, page, out)
  if not opts.repair then return end
  local repaired, log, details = model.try(surface.repair, surface, {time_limit = opts.seconds})
  out:warnings()
  if not repaired and details and details.status == "cancelled" then
    out:say "Repair was interrupted, so its effect is not known."
    return
  elseif not repaired then
    out:say("Repair does not help: %s", log)
    page.advice[#page.advice + 1] = "Repair does not help: " .. log
    out:json {repairable = false, repair_message = log, repair_status = details and details.status}
    return
  end
  local steps = bw.json.list {}
  out:say("Repair corrects it (what computes does so by itself; `barwright convert IN OUT --repair` keeps it):")
  for i, step in ipairs(log.steps) do
    steps[i] = {name = step.name, count = step.count, moved_m = step.moved, text = step.text}
    out:say("  %s: %s", step.name, lengths(step.text))
  end
  out:say("  Then its volume is %s, and it lies %s.",
    core.quantity(repaired.volume, "m3"), model.moved_text(log.moved))
  page.advice[#page.advice + 1] = ("Repair corrects it, and the commands that compute do so by themselves: the "
    .. "volume is %s then. `barwright convert IN OUT --repair` keeps it."):format(
    core.quantity(repaired.volume, "m3"))
  out:json {repairable = true, repair_steps = steps, repair_moved_m = log.moved,
    repaired_volume_m3 = repaired.volume}
  return repaired
end

-- With --edges: the re-entrant edges without a fillet, where a stress has no finite value.
local function report_edges(surface, opts, picture, page, out)
  if not opts.edges then return end
  local edges, message = surface:singular_edges()
  if not edges then
    out:say("%s.", message)
    return
  end
  out:say("Re-entrant edges without a fillet: %s", tostring(edges))
  local list, rows = bw.json.list {}, {}
  for i, edge in ipairs(edges) do
    rows[i] = {core.point(edge.points[1]), core.quantity(edge.length, "m"),
      ("%.4g degrees"):format(180 / math.pi * edge.angle), ("h^%.4g"):format(-edge.growth)}
    local points = bw.json.list {}
    for k, point in ipairs(edge.points) do points[k] = point end
    list[i] = {length_m = edge.length, angle_rad = edge.angle, exponent = edge.exponent, points_m = points}
  end
  out:json {singular_edges = list}
  page.tables[#page.tables + 1] = {"Re-entrant edges without a fillet", {"begins at", "length",
    "inside the material", "stress grows like"}, rows}
  local lines = {}
  for i, edge in ipairs(edges) do lines[i] = edge.points end
  picture.lines, picture.direction = lines, model.view_of(edges)
  picture.line_name = model.count(#edges, "re-entrant edge") .. " without a fillet"
end

-- The faces that the file names, the largest first: {name =, area =}.
local function named_faces(surface)
  local names, area, list = surface:face_names(), {}, {}
  if #names == 0 then return list end
  local points, groups = surface.points:totable(), surface.groups:totable()
  for t, corners in ipairs(surface.triangles:totable()) do
    local name, u, v = names[groups[t]], {}, {}
    if name and name ~= "" then
      for k = 1, 3 do
        local from = points[corners[1]][k]
        u[k], v[k] = points[corners[2]][k] - from, points[corners[3]][k] - from
      end
      area[name] = (area[name] or 0) + math.sqrt((u[2] * v[3] - u[3] * v[2]) ^ 2
        + (u[3] * v[1] - u[1] * v[3]) ^ 2 + (u[1] * v[2] - u[2] * v[1]) ^ 2) / 2
    end
  end
  for name, size in pairs(area) do list[#list + 1] = {name = name, area = size} end
  table.sort(list, function(a, b)
    if a.area ~= b.area then return a.area > b.area end
    return a.name < b.name
  end)
  return list
end

-- With --faces: the faces, the largest first.
local function report_faces(surface, opts, page, out)
  if not opts.faces then return true end
  local faces, message, details = surface:faces()
  if not faces then return nil, message, details end
  local list, rows = bw.json.list {}, {}
  out:say("%s:", model.count(#faces, "face"))
  for i, face in ipairs(faces) do
    list[i] = {name = face.name, kind = face.kind, area_m2 = face.area, centre_m = face.centre,
      radius_m = face.radius}
    if i <= check_page.MAX_FACES then
      rows[i] = {face.name, core.quantity(face.area, "m2"), face.radius and core.quantity(face.radius, "m") or ""}
      out:say("  %-12s %s%s", face.name, core.quantity(face.area, "m2"),
        face.radius and ", radius " .. core.quantity(face.radius, "m") or "")
    end
  end
  if #faces > check_page.MAX_FACES then out:say("  and %d smaller ones.", #faces - check_page.MAX_FACES) end
  page.tables[#page.tables + 1] = {"Faces", {"face", "area", "radius"}, rows}
  local named = named_faces(surface)
  local entries, named_rows = bw.json.list {}, {}
  if #named > 0 then out:say("%s with names of the file:", model.count(#named, "face")) end
  for i, face in ipairs(named) do
    entries[i] = {name = face.name, area_m2 = face.area}
    if i <= check_page.MAX_FACES then
      named_rows[i] = {face.name, core.quantity(face.area, "m2")}
      out:say("  %-12s %s", face.name, core.quantity(face.area, "m2"))
    end
  end
  if #named > 0 then
    page.tables[#page.tables + 1] = {"Faces that the file names", {"face", "area"}, named_rows}
  end
  if #named > check_page.MAX_FACES then out:say("  and %d smaller ones.", #named - check_page.MAX_FACES) end
  out:json {faces = list, named_faces = #named > 0 and entries or nil}
  return true
end

-- What --edges and --faces ask for, listed; and what the picture and the page mark, with it.
local function report_marked(surface, opts, page, out)
  local marked = {title = model.name(opts.model)}
  report_edges(surface, opts, marked, page, out)
  local ok, message, details = report_faces(surface, opts, page, out)
  if not ok then return nil, message, details end
  if opts.picture and opts.faces then marked.labels = check_page.face_labels(surface, marked) end
  page.surface, page.marked = surface, marked
  return true
end

-- So many faults of each kind have a cross.
local MAX_CROSSES = 20

-- The surface as it was read, with crosses at its faults, unless something else is to be seen of the repaired one.
local function mark_faults(surface, report, box, page, opts)
  if page.surface and (opts.edges or opts.faces) then return end
  local places = {}
  for i, defect in ipairs(report.defects) do places[i] = defect.at end
  page.surface, page.marked = surface, {title = model.name(opts.model) .. ": not sound",
    lines = check_page.crosses(places, box), line_name = "crosses: faults, at most "
      .. MAX_CROSSES .. " of each kind"}
end

local function check_surface(read, opts, page, out)
  local surface = read.surface
  local report = surface:check {limit = MAX_CROSSES}
  out:say("%s: %s, %s, %s.", model.name(read.path), read.format,
    model.count(surface.triangle_count, "triangle"), shown.size(file_unit.size_of(read.box)))
  report_unit(read, page, out)
  report_bodies(read, out)
  out:json {triangles = surface.triangle_count, points = surface.point_count, sound = report.sound,
    closed = report.closed, oriented = report.oriented, shells = report.shells, area_m2 = report.area,
    volume_m3 = report.volume}
  if report.sound then
    page.headline = ("Closed, facing outwards, not crossing itself; %s."):format(
      model.count(report.shells, "shell"))
    out:say("Sound: closed, facing outwards, not crossing itself; %s, %s, surface %s.",
      model.count(report.shells, "shell"), core.quantity(report.volume, "m3"), core.quantity(report.area, "m2"))
    add_fact(page, "Volume", core.quantity(report.volume, "m3"))
    add_fact(page, "Surface", core.quantity(report.area, "m2"))
    report_mass(read, report.volume, page, out)
    local good = report_thickness(surface, opts, page, out)
    if not good then page.headline = "Its surface is sound, but walls are thinner than asked for." end
    local ok, message, details = report_marked(surface, opts, page, out)
    if not ok then return nil, message, details end
    return good
  end
  local text = {report.closed and "closed"
    or report.holes > 0 and ("open, with %s"):format(model.count(report.holes, "hole")) or "open",
    model.count(report.shells, "shell")}
  page.headline = ("Its surface is not sound: %s."):format(table.concat(text, ", "))
  out:say("Not sound (%s):", table.concat(text, ", "))
  report_defects(report, page, out)
  local repaired = report_repair(surface, opts, page, out)
  if repaired then
    report_mass(read, repaired.volume, page, out)
    report_thickness(repaired, opts, page, out)
    local ok, message, details = report_marked(repaired, opts, page, out)
    if not ok then return nil, message, details end
  end
  mark_faults(surface, report, read.box, page, opts)
  return false
end

-- ---- meshes ----------------------------------------------------------------------------------------

-- How many overlaps are said, and what fraction of the smaller body analyses refuse.
local MAX_OVERLAPS, REFUSED = 5, 0.1

-- Whether analyses take the mesh.
local function report_overlaps(mesh, out)
  local overlaps, list, largest = mesh:overlaps(), bw.json.list {}, 0
  for i, overlap in ipairs(overlaps) do
    local a, b = overlap.bodies(1, 1), overlap.bodies(1, 2)
    list[i] = {bodies = {a, b}, depth_m = overlap.depth, volume_m3 = overlap.volume, at_m = overlap.at,
      fraction_of_smaller = overlap.fraction}
    largest = math.max(largest, overlap.fraction)
    if i <= MAX_OVERLAPS then
      out:say("Bodies %d and %d overlap: at least %s deep at %s, volume %s, %s of the smaller one.", a, b,
        core.quantity(overlap.depth, "m"), core.point(overlap.at), core.quantity(overlap.volume, "m3"),
        shown.percent(overlap.fraction))
    end
  end
  if #overlaps > MAX_OVERLAPS then
    out:say("%s%d other pairs overlap.", overlaps.more and "At least " or "", #overlaps - MAX_OVERLAPS)
  end
  if largest > REFUSED then
    out:say "Analyses refuse it: move the bodies apart, or remove the elements of one there."
  elseif #overlaps > 0 then
    out:say "That is right for interference fits in contact and for facets of curved faces; else it is a mistake."
  end
  out:json {overlaps = list}
  return largest <= REFUSED
end

local function check_mesh(read, opts, page, out)
  local mesh = read.mesh
  out:say("%s: %s, a mesh of %s tetrahedra of %d nodes.", model.name(read.path), read.format,
    mesh.order == 1 and "linear" or "quadratic", mesh.order == 1 and 4 or 10)
  model.report_mesh(mesh, read.made, out)
  report_unit(read, page, out)
  add_fact(page, "Volume", core.quantity(mesh.volume, "m3"))
  add_fact(page, "Material", out.object.material)
  add_fact(page, "Mass", out.object.mass_kg and core.quantity(out.object.mass_kg, "kg"))
  local quality = mesh:quality()
  local degrees = 180 / math.pi
  local min, max = quality.dihedral_min, quality.dihedral_max
  if max <= math.pi + 1e-9 then min, max = min * degrees, max * degrees end
  out:say("Angles between faces from %s to %s degrees; volumes from %s to %s; %s.",
    shown.number(min), shown.number(max),
    core.quantity(quality.volume_min, "m3"), core.quantity(quality.volume_max, "m3"),
    model.count(mesh.component_count, "body", "bodies"))
  out:json {order = mesh.order, dihedral_min_degrees = min, dihedral_max_degrees = max,
    volume_min_m3 = quality.volume_min, volume_max_m3 = quality.volume_max}
  local ok, message, details = report_marked(mesh:surface(), opts, page, out)
  if not ok then return nil, message, details end
  local sound = min >= 1
  page.headline = sound and "No element is flat, and no bodies overlap much." or "Elements are too flat."
  if mesh.component_count > 1 then
    out:say("The bodies are not connected: a load on one has no effect on the others.")
    if not report_overlaps(mesh, out) then
      sound, page.headline = false, "Bodies of the mesh overlap."
    end
  end
  if min < 1 then
    out:say("Its flattest element has an angle of %s degrees: stresses there are not to be trusted.",
      shown.number(min))
  end
  out:json {sound = sound}
  return sound
end

-- ---- drawings --------------------------------------------------------------------------------------

local function check_outline(read, _, _, out)
  local outline, holes = read.outline, 0
  for _, loop in ipairs(outline.loops) do holes = holes + (loop.hole and 1 or 0) end
  local size = file_unit.size_of(read.box)
  out:say("%s: %s, %s.", model.name(read.path), read.format, shown.size(size))
  out:say("Sound: %s closed and without crossings, of which %s; %s; area %s, length of the cuts %s.",
    model.count(#outline.loops, "loop"), model.count(holes, "hole"), model.count(outline.edge_count, "edge"),
    core.quantity(outline.area, "m2"), core.quantity(outline.perimeter, "m"))
  out:json {size_m = size, sound = true, loops = #outline.loops, holes = holes, edges = outline.edge_count,
    regions = outline.region_count, area_m2 = outline.area, perimeter_m = outline.perimeter}
  return true
end

local by_kind = {surface = check_surface, mesh = check_mesh, outline = check_outline}

-- What was read, with the material that was given, if any, `made`.
local function open(opts, out)
  local made, message, details
  if #opts.material > 0 then
    made, message = made_of.read(opts)
    if not made then return nil, message, {status = "misuse"} end
  end
  local ok
  ok, message, details = model.check_outputs(opts)
  if not ok then return nil, message, details end
  local read
  read, message, details = model.open(opts.model, opts.unit, out)
  if not read then
    out:json {sound = false}
    return nil, message, details
  end
  read = model.settle_unit(read, opts, out) or read -- a doubt is a finding here
  message = made and made_of.fault(made, read)
  if not message and read.kind == "outline" and (opts.report or made) then
    message = ("option --%s: %s is a drawing, which is flat and has %s"):format(
      opts.report and "report" or "material", read.path,
      opts.report and "no view to turn: --picture FILE.png draws it" or "no mass")
  end
  if message then return nil, message, {status = "misuse"} end
  read.made = made
  return read
end

-- Writes the picture and the page that were asked for; the exit code of a failure.
local function write_files(read, page, sentences, good, opts, out)
  return out:write_files {
    {opts.picture, function()
      if read.kind == "outline" then return read.outline:picture(opts.picture) end
      return page.surface:picture(opts.picture, page.marked)
    end},
    {opts.report, function()
      return check_page.write(page.surface, opts.report, page.marked, {answer = output.sentences(sentences),
        head = {verdict = good and "sound" or "faulty", headline = page.headline, facts = page.facts,
          advice = page.advice}, callout = page.callout, tables = page.tables,
        manifest = {file = opts.model, format = read.format}})
    end}}
end

-- As of the commands that compute, but nothing where it is not given.
local material_option = {}
for key, value in pairs(made_of.option) do material_option[key] = value end
material_option.default, material_option.what = nil, "what it is made of, for its mass: as of `barwright statics`"

return {
  summary = "whether a model is sound, and what is wrong with it",
  about = "Reads a surface (STL OBJ OFF PLY 3MF glTF STEP IGES), a mesh of tetrahedra "
    .. "(MSH VTU PVTU MEDIT INP TetGen) or "
    .. "a drawing (SVG DXF) and reports what is in it: "
    .. "size, and whether the unit can be right; whether the surface is "
    .. "closed, faces outwards, crosses itself; how thin its walls are; what a repair would do; which bodies of a "
    .. "mesh overlap.\n\n"
    .. output.codes("sound", "it has faults (also where they can be repaired)"),
  arguments = {{name = "model", type = "file", what = "the file"}},
  options = {
    material_option,
    model.unit_option,
    {name = "thin", value = "LENGTH", type = "number", unit = "m", above = 0,
      what = "a fault if more than 1 % of the surface has less material under it than this"},
    {name = "edges", value = "yes|no", one_of = {"yes", "no"}, default = "no",
      what = "list the re-entrant edges without a fillet, where the stress has no finite value"},
    {name = "faces", value = "yes|no", one_of = {"yes", "no"}, default = "no",
      what = "list the faces: planes, cylinders, cones, spheres and free forms"},
    {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
      what = "a picture, with crosses at faults: with --edges yes these edges as violet lines, with --faces yes "
        .. "the names of the faces"},
    {name = "report", value = "FILE.html", type = "file", endings = {"html", "htm"},
      what = "write a page with a 3D view that turns"},
    {name = "repair", value = "yes|no", one_of = {"yes", "no"}, default = "yes", what = "try a repair"},
    {name = "seconds", value = "TIME", type = "number", unit = "s", default = 120, above = 0,
      what = "how long the repair may take"},
  },
  examples = {"barwright check hook.stl", {"barwright check --edges yes --picture edges.png hook.stl",
    "where a stress has no finite value"}, {"barwright check --thin 0.8mm hook.stl && echo printable",
    "a wall of 0.8 mm at least, as a condition"}},
  run = function(opts, out)
    opts.repair, opts.edges, opts.faces = opts.repair == "yes", opts.edges == "yes", opts.faces == "yes"
    local read, message, details = open(opts, out)
    if not read then return out:fail(message, details) end
    local sentences, page = out:record(), new_page()
    local good
    good, message, details = by_kind[read.kind](read, opts, page, out)
    out:warnings()
    if good == nil then return out:fail(message, details) end
    out:json {good = good}
    local failed = write_files(read, page, sentences, good, opts, out)
    if failed then return failed end
    return good and 0 or 1
  end,
}
