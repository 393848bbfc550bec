-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright convert IN OUT: from one format into another, repaired or filled on the way.
local lengths = require "barwright.command.lengths"
local model = require "barwright.command.model"
local output = require "barwright.command.output"

local surface_endings = {stl = true, obj = true, ply = true, off = true, ["3mf"] = true}
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
    return nil, ("%s: the ending .%s is not known: %s .vtu for bodies, %s for drawings"):format(opts.out, ending,
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

local function run(opts, out)
  if model.same_path(opts["in"], opts.out) then
    return out:misuse(("OUT: %s is IN: give another file"):format(opts.out))
  end
  local read, message, details = model.open(opts["in"], opts.unit, out)
  if not read then return out:fail(message, details) end
  local made
  made, message, details = converted(read, opts, out)
  if not made then return out:fail(message, details) end
  local options = {}
  if read.kind ~= "outline" then
    options.unit = opts.out_unit
    if made == read.mesh and (model.ending(opts.out) == "vtu" or model.ending(opts.out) == "msh") then
      options.fields = fields_of(read)
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
  about = "The ending of OUT says the format: surfaces STL OBJ PLY OFF 3MF VTU MSH, meshes of tetrahedra MSH VTU "
    .. "MESH INP NODE, drawings SVG DXF. A mesh that is written as STL, OBJ, PLY, OFF or 3MF gives its boundary; "
    .. "a surface that is written as MESH, INP or NODE, or with --elements, is filled with tetrahedra. Surfaces "
    .. "are written in millimetres and meshes in metres unless --out-unit says otherwise.\n\n"
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
    {name = "ascii", type = "flag", what = "write STL and PLY as text"},
  },
  examples = {{"barwright convert scan.stl part.obj --repair", "a sound surface"},
    {"barwright convert hook.stl hook.vtu --elements 50000 --order 2", "a mesh for another solver"},
    "barwright convert plate.dxf plate.svg"},
  run = run,
}
