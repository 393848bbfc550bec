-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright convert IN OUT: from one format into another, repaired or filled on the way.
local bw = require "barwright"
local lengths = require "barwright.command.lengths"
local model = require "barwright.command.model"
local output = require "barwright.command.output"

local surface_endings = {stl = true, obj = true, ply = true, off = true, ["3mf"] = true, glb = true, usda = true,
  step = true, stp = true}
local coloured_endings = {obj = true, ply = true, ["3mf"] = true, glb = true, usda = true}
local mesh_endings = {msh = true, pvtu = true, mesh = true, inp = true, node = true, ele = true}
local drawing_endings = {svg = true, dxf = true}

local function list(sets)
  local names = {}
  for _, set in ipairs(sets) do
    for name in pairs(set) do names[#names + 1] = "." .. name end
  end
  table.sort(names)
  return table.concat(names, " ")
end

-- What a surface becomes on the way: whole, of another size, finer or coarser.
local function changed(surface, opts, out)
  if opts.repair then
    local report = surface:check {limit = 0}
    if not report.sound then
      local repaired, log, details = model.try(surface.repair, surface)
      out:warnings()
      if not repaired then return nil, "repair: " .. log, details end
      for _, step in ipairs(log.steps) do out:say("  %s: %s", step.name, lengths(step.text)) end
      out:json {repaired = true, repair_moved_m = log.moved}
      surface = repaired
    else
      out:json {repaired = false}
    end
  end
  if opts.edge then
    local even, log, details = model.try(surface.remesh, surface, {edge_length = opts.edge})
    if not even then return nil, "remesh: " .. log, details end
    for _, step in ipairs(log.steps) do out:say("  %s: %s", step.name, lengths(step.text)) end
    surface = even
  end
  return surface
end

-- The object to write, and its options.
local function converted(read, opts, out)
  local ending = model.ending(opts.out)
  local factor = opts.scale
  if read.kind == "outline" then
    if not drawing_endings[ending] then
      return nil, ("%s: a drawing can be written as %s"):format(opts.out, list {drawing_endings}),
        {status = "misuse"}
    end
    if factor then
      local points = read.outline.points * factor
      local outline, message, details = model.try(read.outline.with_points, read.outline, points)
      if not outline then return nil, message, details end
      return outline
    end
    return read.outline
  end
  if drawing_endings[ending] then
    return nil, ("%s: a body can be written as %s .vtu, not as a drawing"):format(opts.out,
      list {surface_endings, mesh_endings}), {status = "misuse"}
  end
  if not (surface_endings[ending] or mesh_endings[ending] or ending == "vtu") then
    local read_only = {iges = "IGES", igs = "IGES"}
    local what = read_only[ending] and read_only[ending] .. " files are read, and not written"
      or ending == "" and "the name has no ending, which says the format"
      or ("the ending .%s is not known"):format(ending)
    return nil, ("%s: %s: %s .vtu for bodies, %s for drawings"):format(opts.out, what,
      list {surface_endings, mesh_endings}, list {drawing_endings}), {status = "misuse"}
  end
  local filled = opts.elements or mesh_endings[ending] and ending ~= "msh" and read.kind == "surface"
  if read.kind == "surface" then
    local surface, message, details = changed(read.surface, opts, out)
    if not surface then return nil, message, details end
    if factor then surface = surface:scale(factor) end
    if not filled or surface_endings[ending] then return surface end
    read.surface = surface
    return model.mesh(read, {elements = opts.elements or 20000, order = opts.order}, out)
  end
  local mesh = read.mesh
  if factor then mesh = mesh:scale(factor) end
  if surface_endings[ending] then return mesh:surface() end
  if opts.order and opts.order ~= mesh.order then mesh = mesh:with_order(opts.order) end
  return mesh
end

local function fields_of(read)
  local fields = read.kind == "mesh" and read.info.fields
  return fields and next(fields) and fields or nil
end

-- A field of the mesh on its boundary: a row for each point or each triangle of the surface, or nil, message,
-- details. Vectors become their length.
local function boundary_values(read, name, nodes)
  local fields, names = fields_of(read) or {}, {}
  for key in pairs(fields) do names[#names + 1] = key end
  table.sort(names)
  local field = fields[name]
  if not field then
    return nil, ("--colours %s: %s has %s"):format(name, model.name(read.path),
      #names > 0 and "the fields " .. table.concat(names, ", ") or "no fields"), {status = "misuse"}
  end
  if field.column_count == 3 then
    field = bw.array.map("norm(a)", {a = field})
  elseif field.column_count ~= 1 then
    return nil, ("--colours %s: the field has %d components, and 1 or 3 become colours"):format(name,
      field.column_count), {status = "misuse"}
  end
  return field:gather(field.row_count == read.mesh.node_count and nodes or read.mesh.facet_elements)
end

-- The boundary of the mesh and the options to write it in colours.
local function coloured(read, opts, options)
  if read.kind ~= "mesh" then
    return nil, "--colours: only fields of meshes (VTU MSH) become colours", {status = "misuse"}
  end
  if not coloured_endings[model.ending(opts.out)] then
    return nil, ("--colours: colours are written to %s, not to %s"):format(list {coloured_endings},
      model.name(opts.out)), {status = "misuse"}
  end
  local surface, nodes = read.mesh:surface()
  local values, message, details = boundary_values(read, opts.colours, nodes)
  if not values then return nil, message, details end
  if opts.scale then surface = surface:scale(opts.scale) end
  options.values = values
  return surface
end

-- Formats that have a unit.
local with_unit = {["3mf"] = true, glb = true, usda = true, step = true, stp = true}

-- Whether the numbers that are written depend on the unit of those that are read: files with a unit, and those of
-- meshes, which are in metres.
local function unit_counts(read, ending)
  return with_unit[ending] or read.kind == "surface" and not surface_endings[ending]
end

local function run(opts, out)
  if model.same_path(opts["in"], opts.out) then
    return out:misuse(("OUT: %s is IN: give another file"):format(opts.out))
  end
  local read, message, details = model.open(opts["in"], opts.unit, out)
  if not read then return out:fail(message, details) end
  if opts.out_unit or opts.edge or opts.elements or unit_counts(read, model.ending(opts.out)) then
    read, message, details = model.settle_unit(read, opts, out, opts["in"])
    if not read then return out:fail(message, details) end
  end
  local made
  made, message, details = converted(read, opts, out)
  if not made then return out:fail(message, details) end
  local options = {}
  if read.kind ~= "outline" then
    options.unit = opts.out_unit
    if made == read.mesh and (model.ending(opts.out) == "vtu" or model.ending(opts.out) == "msh") then
      options.fields = fields_of(read)
    end
    if model.ending(opts.out) == "glb" then
      if opts.out_unit and opts.out_unit ~= "m" then
        return out:misuse("--out-unit: glTF files are in metres: leave it out")
      end
    end
    if opts.colours then
      made, message, details = coloured(read, opts, options)
      if not made then return out:fail(message, details) end
    end
    if opts.ascii and model.ending(opts.out):match "^[sp][tl][ly]$" then options.ascii = true end
  end
  local ok
  ok, message, details = model.try(made.write, made, opts.out, next(options) and options or nil)
  if not ok then return out:fail(message, details) end
  out:warnings()
  out:say("%s: %s", opts.out, tostring(made):match "^[^\n]*")
  out:json {out = opts.out, text = tostring(made)}
end

return {
  summary = "from one file format into another, repaired or filled on the way",
  about = "The ending of OUT says the format: surfaces STL OBJ PLY OFF 3MF GLB USDA STEP VTU MSH, meshes of "
    .. "tetrahedra MSH VTU MESH INP NODE, drawings SVG DXF. A mesh that is written in a format of surfaces gives "
    .. "its boundary; a surface that is written as MESH, INP or NODE, or with --elements, is filled with "
    .. "tetrahedra. Surfaces are written in millimetres and meshes in metres unless --out-unit says otherwise.\n\n"
    .. output.codes "it was written",
  arguments = {{name = "in", type = "file", what = "the file to read"},
    {name = "out", type = "file", what = "the file to write"}},
  options = {
    model.unit_option,
    {name = "out-unit", value = "UNIT", one_of = {"mm", "cm", "m", "in", "um"},
      what = "the unit of the numbers written"},
    {name = "repair", type = "flag", what = "make a surface sound"},
    {name = "edge", value = "LENGTH", type = "number", unit = "m", above = 0,
      what = "remesh a surface to even triangles of about this edge length"},
    {name = "scale", value = "FACTOR", type = "number", above = 0, what = "all lengths times a factor"},
    {name = "elements", value = "N", type = "integer", min = 1, max = 10000000,
      what = "fill a surface with about so many tetrahedra"},
    {name = "order", value = "1|2", type = "integer", one_of = {1, 2}, what = "linear or quadratic tetrahedra"},
    {name = "colours", value = "FIELD", type = "string",
      what = "a field of a mesh as the colours of its boundary, for GLB USDA PLY OBJ 3MF"},
    {name = "ascii", type = "flag", what = "write STL and PLY as text"},
  },
  examples = {{"barwright convert scan.stl part.obj --repair", "a sound surface"},
    {"barwright convert hook.stl hook.vtu --elements 50000 --order 2", "a mesh for another solver"},
    {"barwright convert hook.vtu hook.glb --colours von_mises", "a result for a 3D viewer"},
    "barwright convert plate.dxf plate.svg"},
  run = run,
}
