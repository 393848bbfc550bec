-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the commands share: reading a MODEL, whatever it is, making a mesh of it, and telling in sentences how
-- large it is. Failures are nil, message, details, the message beginning with the file.
local bw = require "barwright"
local core = require "barwright.core"
local file_unit = require "barwright.command.file_unit"
local growth = require "barwright.singular_growth"
local lengths = require "barwright.command.lengths"
local made_of = require "barwright.command.made_of"
local distance = require("barwright.points").distance
local shown = require "barwright.shown"
local writable = require "barwright.writable"

local model = {}

--- The argument of those that compute.
model.body_argument = {name = "model", type = "file",
  what = "surface (STL OBJ OFF PLY 3MF glTF STEP IGES) or mesh of tetrahedra (MSH VTU PVTU MEDIT INP TetGen)"}

--- The option --unit of every command that reads a model.
model.unit_option = {name = "unit", value = "UNIT", one_of = file_unit.names,
  what = "the unit of the numbers in the file; left out: what the "
    .. "file says for drawings, 3MF, glTF, STEP and IGES, else mm for surfaces, m for meshes of tetrahedra"}

-- The solvers of --solver; each is made when it is asked for.
local solvers = {
  auto = function() return nil end,
  cholesky = function() return bw.solver.cholesky() end,
  multifrontal = function() return bw.solver.cholesky {backend = "multifrontal"} end,
  cholmod = function() return bw.solver.cholesky {backend = "cholmod"} end,
  pcg = function() return bw.solver.pcg() end,
  petsc = function() return bw.solver.pcg {preconditioner = bw.solver.amg {backend = "petsc"}} end,
}

--- The option --solver of those that solve linear systems.
model.solver_option = {name = "solver", value = "NAME", default = "auto",
  one_of = {"auto", "cholesky", "multifrontal", "cholmod", "pcg", "petsc"},
  what = "a sparse factor (cholesky; multifrontal and cholmod name its backend), two-level PCG, which takes a "
    .. "tenth of its memory (pcg), PCG on all processes of mpirun (petsc), or as is cheaper (auto)"}

--- The same of those that solve for many right-hand sides.
model.many_solver_option = {name = "solver", value = "NAME", default = "auto",
  one_of = {"auto", "cholesky", "multifrontal", "cholmod", "pcg", "petsc"},
  what = "a sparse factor (cholesky; multifrontal and cholmod name its backend), two-level PCG without one, where "
    .. "the modes are by LOBPCG (pcg), PCG on all processes of mpirun, where they are by SLEPc (petsc), or a "
    .. "factor unless it is too large (auto)"}

--- What a solver's report says, in the JSON object.
function model.solver_words(report)
  return {solver = report.solver, backend = report.backend, preconditioner = report.preconditioner,
    iterations = report.iterations, residual = report.residual}
end

--- The solver that the options ask for; nil: it is chosen.
function model.solver(opts) return solvers[opts.solver]() end

model.fix_option = {name = "fix", value = "PLACE", many = true,
  what = "a support: all displacements are zero there"}

model.length_option = {name = "length", value = "critical|LENGTH", type = "number", unit = "m", above = 0,
  word = "critical", what = "radius of the surface patch over which the stress is averaged; critical: half the "
    .. "critical distance of the material; without it, 2 % of the part's diagonal"}

model.elements_option = {name = "elements", value = "N", type = "integer", default = 20000, min = 1,
  max = 10000000,
  what = "about how many tetrahedra a surface is filled with: more take longer and show finer stresses"}

model.contact_option = {name = "contact", value = "AREA", type = "number", unit = "m2", default = 1e-4, above = 0,
  what = "the least area over which the load acts, a fingertip's by default"}

--- Where weak regions are looked for.
model.search_options = {
  {name = "modes", value = "N", type = "integer", default = 15, min = 1, max = 500,
    what = "modes of vibration of the first mesh in which weak regions are looked for"},
  {name = "regions", value = "N", type = "integer", default = 5, min = 1, max = 1000,
    what = "weak regions of each mode"},
}

model.order_option = {name = "order", value = "1|2", type = "integer", default = 1, one_of = {1, 2},
  what = "linear or quadratic elements: the latter are far more exact, and slower"}

model.threads_option = {name = "threads", value = "N", type = "integer", min = 1, max = 64,
  what = "number of threads; the numbers do not depend on it"}

-- Less than this is rounding (m).
local MOVED = 1e-9

--- Where a surface lies that a step moved by a length.
function model.moved_text(moved)
  return moved > MOVED and ("at most %s from the input"):format(core.quantity(moved, "m")) or "on the input"
end

function model.name(path)
  return path:match "[^/]+$" or path
end

--- A word as a shell takes it.
function model.shell(word)
  if word:find "^[%w%._/+-]+$" then return word end
  return "'" .. word:gsub("'", "'\\''") .. "'"
end

--- The verdict on a stress that is `used` of the strength, within a relative error, and its words. An error as
--- large as the value decides nothing; without a strength nothing is known.
function model.verdict(used, estimated)
  if not used then return "unsure" end
  if estimated >= 1 then return "unsure", "the error is too large to decide" end
  if used * (1 + estimated) < 1 then return "holds", "it holds" end
  if used * (1 - estimated) > 1 then return "breaks", "it breaks" end
  return "unsure", "too close to decide"
end

-- Of a uniform mesh, for the growth of the stress: the edge length of elements up to a factor.
local function sized(found)
  return found and {value = found.stress, edge = found.elements ^ (-1 / 3)}
end

-- The finding that materials meet at the surface within a radius of a point, or nil.
local function find_meeting(part, read, at, radius)
  local nodes, nearest = part.mesh.nodes, nil
  for _, node in ipairs(made_of.meeting_nodes(read.made, part)) do
    local there = {nodes(node, 1), nodes(node, 2), nodes(node, 3)}
    local away = distance(there, at)
    if away <= radius then nearest, radius = there, away end
  end
  return nearest and growth.meeting(nearest)
end

--- The finding that there is no finite stress at a point of a part, or nil. `fine`, `coarse`: the largest stress
--- on its mesh and on a coarser one or nil, {stress =, elements =}.
function model.find_singular(part, read, at, fine, coarse)
  local sound = read.surface and read.surface:check({limit = 1}).sound
  local found = model.try(part.singular_places, part, {surface = sound and read.surface or nil})
  local radius = growth.radius(growth.edge_length(part.mesh, at))
  return growth.check(found, at, radius, growth.exponent(sized(coarse), sized(fine)))
    or find_meeting(part, read, at, radius)
end

--- The length of a box's diagonal.
function model.diagonal(box)
  local min, max = box.min, box.max
  return math.sqrt((max[1] - min[1]) ^ 2 + (max[2] - min[2]) ^ 2 + (max[3] - min[3]) ^ 2)
end

-- Deflections above this fraction of the longest side are beyond the range of linear theory.
local LARGE = 0.1
model.large_deflection = "more than a tenth of the part's length"

--- Whether linear theory does not hold for a displacement (m).
function model.beyond_linear(displacement, box)
  local longest = 0
  for k = 1, 3 do longest = math.max(longest, box.max[k] - box.min[k]) end
  return displacement > LARGE * longest
end

--- How large a displacement (m) of a mesh is beside the part: {length, thickness = what it is over the longest
--- side and over the mean thickness, thickness_m, beyond = whether linear theory does not hold, text = in words}.
--- The mean thickness is twice the volume over the surface.
function model.deflection(displacement, mesh)
  local longest, thickness = 0, 2 * mesh.volume / mesh.boundary.area
  for k = 1, 3 do longest = math.max(longest, mesh.box.max[k] - mesh.box.min[k]) end
  local found = {length = displacement / longest, thickness = displacement / thickness, thickness_m = thickness,
    beyond = model.beyond_linear(displacement, mesh.box)}
  found.text = ("%s of the longest side, %s of the mean thickness of %s"):format(shown.percent(found.length),
    shown.percent(found.thickness), core.quantity(thickness, "m"))
  return found
end

--- The same in the JSON object, and in words where it is large.
function model.report_deflection(found, say, out)
  out:json {beyond_linear_theory = found.beyond, displacement_over_length = found.length,
    displacement_over_thickness = found.thickness, mean_thickness_m = found.thickness_m}
  if found.beyond then
    say("Displacements are beyond the range of linear theory: %s (%s).", model.large_deflection, found.text)
  elseif found.thickness > 1 then
    say("The displacement is larger than the mean thickness (%s): where a wall is constrained on two sides or "
      .. "more, linear theory overestimates it.", found.text)
  end
end

--- A count with its noun: "1 hole", "3 holes"; `many` where it is not the noun with an s.
function model.count(n, one, many)
  return ("%d %s"):format(n, n == 1 and one or many or one .. "s")
end

function model.pick(keys, from)
  local out = {}
  for _, key in ipairs(keys) do out[key] = from[key] end
  return out
end

-- ---- reading ---------------------------------------------------------------------------------------

local volume_endings = {pvtu = true, msh = true, vtu = true, mesh = true, inp = true, node = true, ele = true}
local both_endings = {msh = true, vtu = true, mesh = true, inp = true}
local drawing_endings = {svg = true, dxf = true}

function model.ending(path)
  return (path:match "%.(%w+)$" or ""):lower()
end

local function with_path(path, message)
  if message:find(path, 1, true) then return message end
  return path .. ": " .. message
end

-- Raised misuse (an argument that the engine refuses) and failures alike as nil, message, details.
function model.try(f, ...)
  local values = table.pack(pcall(f, ...))
  if values[1] then return table.unpack(values, 2, values.n) end
  if bw.interrupted() then error(values[2], 0) end
  return nil, (tostring(values[2]):gsub("^[^\n:]+:%d+: ", "")), {status = "invalid"}
end

--- {kind = "surface" | "mesh" | "outline", surface | mesh | outline =, format =, metres_per_unit =, ...}
function model.read(path, unit)
  local ending = model.ending(path)
  local options = {unit = unit}
  if drawing_endings[ending] then
    local outline, info, details = model.try(bw.outline.read, path, options)
    if not outline then return nil, with_path(path, info), details end
    return {kind = "outline", path = path, outline = outline, format = info.format, box = outline.box, unit = unit}
  end
  local why, what
  if volume_endings[ending] then
    local mesh, info, details = model.try(bw.mesh.read, path, options)
    if mesh then
      return {kind = "mesh", path = path, mesh = mesh, info = info, format = info.format, box = mesh.box,
        unit = unit}
    end
    if not both_endings[ending] or details.status ~= "format" then return nil, with_path(path, info), details end
    why, what = info, details
  end
  local surface, info, details = model.try(bw.surface.read, path, options)
  if not surface then
    -- Of a file that may hold either, the reader of meshes says more.
    return nil, with_path(path, why or info), what or details
  end
  return {kind = "surface", path = path, surface = surface, format = info.format, box = surface.box, unit = unit,
    metres_per_unit = info.metres_per_unit, info = info}
end

-- What was read in a unit: read again where it was taken for another one.
local function in_unit(read, path, unit)
  local metres = file_unit.metres(unit)
  if math.abs(metres / file_unit.taken(read) - 1) > 1e-9 then
    local message, details
    read, message, details = model.read(path, unit)
    core.warnings() -- they are shown already
    if not read then return nil, message, details end
  end
  read.metres_per_unit = metres
  return read
end

--- What was read of a body or a drawing, with its unit settled (file_unit.lua): a size that is implausible for a
--- part is refused, as nil, message, details, unless the unit was given, here or on a terminal.
function model.settle_unit(read, opts, out, path)
  path = path or opts.model
  local unit, message = file_unit.settle(read, path, opts, out)
  if unit == false then return nil, message, {status = "misuse", units = out.object.unit_suggestions} end
  if not unit then return read end
  opts.unit = unit
  opts.given["--unit"] = unit -- for commands that are advised
  local details
  read, message, details = in_unit(read, path, unit)
  if not read then return nil, message, details end
  read.unit = unit
  return read
end

--- What was read without a unit, in that of the environment where the file has none.
function model.in_environment(read, path)
  local unit, message = file_unit.of_environment(read)
  if unit == false then return nil, message, {status = "misuse"} end
  if not unit then return read end
  local details
  read, message, details = in_unit(read, path, unit)
  if not read then return nil, message, details end
  read.unit, read.by_environment = nil, unit -- a doubt about it stays one
  return read
end

--- What was read, in the unit of the environment where neither the file nor the command line has one; and what
--- people want to hear of it.
function model.open(path, unit, out)
  local read, message, details = model.read(path, unit)
  out:warnings()
  if read and not unit then read, message, details = model.in_environment(read, path) end
  if not read then return nil, message, details end
  out:json {file = path, format = read.format, kind = read.kind}
  return read
end

--- Options of pictures and reports that draw the edge of a finding (barwright.singular_growth), or none.
function model.edge_lines(finding)
  local place = finding and finding.place
  if not place or place.length == 0 then return {} end
  return {lines = {place.points}, line_name = place.kind .. (place.angle
    and (", %.4g degrees inside the material"):format(180 / math.pi * place.angle) or "")
    .. ": no finite stress"}
end

-- Edges on opposite sides cancel out: then the longest one is shown.
local ALIGNED = 0.3

--- The direction from the body to the viewer in which re-entrant edges ({length, inward} each) are seen: against
--- their bisectors, from above a little; nil where there is none.
function model.view_of(edges)
  local sum, total, longest = {0, 0, 0}, 0, nil
  for _, edge in ipairs(edges) do
    local inward = edge.inward[#edge.inward // 2 + 1]
    for k = 1, 3 do sum[k] = sum[k] - edge.length * inward[k] end
    total = total + edge.length
    if not longest or edge.length > longest.length then longest = edge end
  end
  if not longest then return nil end
  local size = math.sqrt(sum[1] ^ 2 + sum[2] ^ 2 + sum[3] ^ 2)
  if size < ALIGNED * total or size == 0 then
    if #edges == 1 then return nil end
    return model.view_of {longest}
  end
  return {sum[1] / size, sum[2] / size, sum[3] / size + 0.5}
end

--- A mesh of what was read: as it is, or filled. Says what was done to the surface on the way.
function model.mesh(read, opts, out)
  if read.kind == "outline" then
    return nil, read.path .. ": a drawing is flat: it is no body that could be filled (`barwright check` and "
      .. "`barwright convert` take drawings; docs/tutorial_responsive.md says what can be computed of one)",
      {status = "unsupported"}
  end
  if read.kind == "mesh" then
    local mesh = read.mesh
    if opts.order and opts.order ~= mesh.order then return mesh:with_order(opts.order) end
    out:json {repaired = false, surface_moved_m = 0}
    return mesh
  end
  local mesh, log, details = model.try(bw.mesh.fill, read.surface, {elements = opts.elements, order = opts.order})
  out:warnings()
  if not mesh then return nil, with_path(read.path, log), details end
  local steps = bw.json.list {}
  for i, step in ipairs(log.steps) do
    steps[i] = {name = step.name, count = step.count, moved_m = step.moved, text = step.text}
    out:say("  %s: %s", step.name, lengths(step.text))
  end
  if log.repaired then
    out:say("  The surface was repaired, and lies %s.", model.moved_text(log.surface_moved))
  end
  out:json {repaired = log.repaired, surface_moved_m = log.surface_moved, surface_steps = steps,
    seconds_fill = log.seconds_fill}
  return mesh
end

--- Says and keeps what a mesh is. made: what it is made of (made_of.lua), or nil.
function model.report_mesh(mesh, made, out)
  local mass = made and made_of.mass(made, mesh)
  out:say("%s, %s, %s, %s%s.", model.count(mesh.element_count, "element"), model.count(mesh.node_count, "node"),
    shown.size(file_unit.size_of(mesh.box)), core.quantity(mesh.volume, "m3"),
    mass and ", " .. core.quantity(mass, "kg") or "")
  out:json {elements = mesh.element_count, nodes = mesh.node_count, bodies = mesh.component_count,
    box_low_m = mesh.box.min, box_high_m = mesh.box.max, volume_m3 = mesh.volume,
    area_m2 = mesh.boundary.area, mass_kg = mass}
  if made then made_of.report(made, mesh, out) end
end

-- With --error the first mesh has this fraction of the elements asked for, the last one at most so many times
-- them.
local FIRST, MAX_GROWTH = 1 / 4, 10

--- With --error: what is asked of the first mesh.
function model.first_mesh(opts)
  return setmetatable({elements = math.max(1, math.floor(FIRST * opts.elements)), order = 2}, {__index = opts})
end

--- With --error: options of part:solve and part:modes that go on from the first mesh.
function model.refined(read, opts, mesh, given)
  local sound = read.surface and read.surface:check({limit = 1}).sound
  given.error, given.surface = opts.error, sound and read.surface or nil
  given.max_elements = math.max(MAX_GROWTH * opts.elements, mesh.element_count)
  return given
end

--- With --error: how it was reached.
function model.report_accuracy(accuracy, out)
  local steps = bw.json.list {}
  for i, row in ipairs(accuracy.history) do
    steps[i] = {elements = row.elements, value = row.value, estimated_error = row.estimated_error}
  end
  out:say("")
  out:say("%s", tostring(accuracy))
  out:json {elements = accuracy.elements, nodes = accuracy.part.mesh.node_count, converged = accuracy.converged,
    reason = accuracy.reason, steps = steps}
end

-- A coarser mesh for comparison has this fraction of the elements.
local COARSER = 1 / 4
-- Two meshes of quadratic elements show at least this much uncertainty; one alone leaves so much open.
local MIN_ERROR, ONE_MESH_ERROR = 0.02, 0.5

--- What measure(mesh) finds on a coarser mesh; nil where there is none to compare with.
function model.on_coarser(read, opts, order, measure)
  if read.kind ~= "surface" then return nil end
  local elements = math.max(1, math.floor(opts.elements * COARSER))
  local mesh = model.try(bw.mesh.fill, read.surface, {elements = elements, order = order})
  local found = mesh and measure(mesh)
  bw.warnings() -- those of the finer mesh are shown
  return found
end

--- The relative error of a value that is `coarse` on the coarser mesh; `mean` is another estimate of it.
function model.error_of(value, coarse, mean)
  return math.max(coarse and math.abs(value / coarse - 1) or ONE_MESH_ERROR, mean or 0, MIN_ERROR)
end

-- A path without what does not change it: "./a//b" is "a/b".
local function plain_path(path)
  return (path:gsub("/+", "/"):gsub("/%./", "/"):gsub("^%./", ""))
end

--- Whether two paths are written alike but for what does not change them.
function model.same_path(a, b)
  return plain_path(a) == plain_path(b)
end

--- What the command is to write: a fault before the work and not after it. No file is written over one that is
--- read, or over another that is written. True, or nil, message, details.
function model.check_outputs(opts)
  local role = {}
  role[plain_path(opts.model)] = "the MODEL"
  for _, name in ipairs {"spectrum", "psd"} do
    if opts[name] then role[plain_path(opts[name])] = "the file of --" .. name end
  end
  for _, name in ipairs {"report", "picture", "vtu", "csv", "plot", "out"} do
    local path = opts[name]
    if path then
      local other = role[plain_path(path)]
      if other then
        return nil, ("option --%s: %s is %s: give another file"):format(name, path, other), {status = "misuse"}
      end
      role[plain_path(path)] = "the file of --" .. name
      local ok, message, details = name == "out", nil, nil -- the command itself knows whether it is a folder
      if not ok then ok, message, details = writable(path) end
      if not ok then return nil, message, details end
    end
  end
  return true
end

--- Endings of the files of bodies with fields.
model.field_endings = {"vtu", "pvtu", "msh", "mesh", "inp", "node", "ele"}

--- What is asked about, read and reported: what model.read gives, with `made` (made_of.lua). A size that is
--- implausible for a part is refused unless the unit was given. one: the name of a command that takes one material
--- for all of a part, `read.made.default`, or nil.
function model.start(opts, out, one)
  local ok, message, details = model.check_outputs(opts)
  if not ok then return nil, message, details end
  local made, read
  made, message = made_of.read(opts)
  if made and one then message = made_of.several(made, one) end
  if message then return nil, message, {status = "misuse"} end
  read, message, details = model.open(opts.model, opts.unit, out)
  if not read then return nil, message, details end
  out:say("%s: %s.", model.name(opts.model), read.format)
  read, message, details = model.settle_unit(read, opts, out)
  if not read then return nil, message, details end
  read.made = made
  message = made_of.fault(made, read)
  if message then return nil, message, {status = "misuse"} end
  return read
end

--- The body that is asked about, reported as it is read and filled: mesh, what was read.
function model.body(opts, out)
  local read, message, details = model.start(opts, out)
  if not read then return nil, message, details end
  local mesh
  mesh, message, details = model.mesh(read, opts, out)
  if not mesh then return nil, message, details end
  model.report_mesh(mesh, read.made, out)
  return mesh, read
end

--- The model of a mesh of what was read, without supports and loads; nil, message, details where the elements do
--- not take the formulation asked for.
function model.part(read, mesh, opts)
  return model.try(made_of.make, read.made, bw.model, mesh, {formulation = opts.formulation})
end

--- The unit that a file's numbers were read in, by name where it has one.
function model.unit_of(read, opts)
  if opts.unit then return opts.unit end
  local metres = read.metres_per_unit or 1
  return file_unit.name_of(metres) or ("%g m"):format(metres)
end

return model
