-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Methods of static results, modes and surfaces that put engine calls together: files and pictures.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local shown = require "barwright.shown"
local fine_boundary = require "barwright.fine_boundary"
local options = require "barwright.options"
local shape_files = require "barwright.shape_files"

local raise = core.raise

-- name -> what it is called, unit on the bar, factor
local pictured = {
  von_mises = {"von Mises stress, MPa", 1e-6},
  max_principal = {"largest principal stress, MPa", 1e-6},
  element_von_mises = {"von Mises stress, MPa", 1e-6},
  element_max_principal = {"largest principal stress, MPa", 1e-6},
  utilisation = {"stress over strength, %", 100},
  element_energy = {"strain energy of an element, mJ", 1e3},
  displacement = {"displacement, mm", 1e3},
  reaction = {"reaction, N", 1},
}

local static = core.classes.static.methods

--- Displacement, stress and what follows from it, as .vtu (or what the ending says).
function static:write(path, given)
  local opts = options.copied(given)
  local fields = options.copied(opts.fields, "fields")
  for _, name in ipairs {"displacement", "force", "reaction", "stress", "von_mises",
    "max_principal"} do
    fields[name] = fields[name] or {self[name], on = "nodes"}
  end
  fields.element_stress = fields.element_stress or {self.element_stress, on = "elements"}
  opts.fields = fields
  return self.mesh:write(path, opts)
end

--- The deformed shape coloured by {field = "von_mises"} or {field = an array over nodes or elements}.
function static:picture(path, given)
  local opts = options.copied(given)
  local field = opts.field or "von_mises"
  opts.field = nil
  local values = field
  if type(field) == "string" then
    local about = pictured[field]
    if not about then
      local names = {}
      for name in pairs(pictured) do names[#names + 1] = name end
      raise(("picture: unknown field '%s': %s"):format(field,
        core.suggestion(field, names)))
    end
    values = self[field]
    opts.unit, opts.scale = opts.unit or about[1], opts.scale or about[2]
  end
  options.object("picture", "option 'field'", values, "array")
  local mesh = self.mesh
  local surface, nodes, details = fine_boundary(mesh)
  if not surface then return nil, nodes, details end
  if #values ~= mesh.node_count then values = mesh:to_nodes(values) end
  if values.column_count > 1 then values = core.array.map("norm(a)", {a = values}) end
  opts.values = values:gather(nodes)
  opts.displacement = opts.displacement or self.displacement:gather(nodes)
  return core.picture(surface, path, opts)
end

--- The sum of the reactions on a selection, N.
function static:reaction_on(selection)
  return self.reaction:gather(selection.nodes):column_sums()
end

local modes = core.classes.modes.methods

--- The shapes as .vtu, one field for each mode.
function modes:write(path, given)
  return shape_files.write(self, "mode_%02d", path, given)
end

--- A mode's shape; see shape_files.lua.
function modes:picture(i, path, given)
  return shape_files.picture(self, i, path, given, function()
    local title, frequencies = ("mode %d"):format(i), self.frequencies
    if not frequencies then return title end
    local cents = self:error_estimate()
    cents = cents and cents[i]
    return ("%s: %s%s"):format(title, core.quantity(frequencies[i], "Hz"), cents
      and (", about %s too high"):format(shown.cents(cents))
      or "; " .. core.error_unknown)
  end)
end

local surface = core.classes.surface.methods

-- ---- what a check and a repair found, in words ----

function core.tables.surface_report:__tostring()
  local lines = {("%s: %d shells, %s, volume %s, area %s"):format(
    self.sound and "sound" or "not sound", self.shells, self.closed and "closed" or
    ("open with %d holes"):format(self.holes), core.quantity(self.volume, "m3"), core.quantity(self.area, "m2"))}
  local kinds = {}
  for kind, count in pairs(self.count) do
    if count > 0 then kinds[#kinds + 1] = ("  %s: %d"):format(kind, count) end
  end
  table.sort(kinds)
  for _, line in ipairs(kinds) do lines[#lines + 1] = line end
  for i = 1, math.min(5, #self.defects) do
    local d = self.defects[i]
    lines[#lines + 1] = ("  %s at facet %d, %s"):format(d.kind, d.facet,
      core.point(d.at))
  end
  return table.concat(lines, "\n")
end

function core.tables.shape_log:__tostring()
  if #self.steps == 0 then return "nothing was changed" end
  local lines = {}
  for i, step in ipairs(self.steps) do lines[i] = ("%s: %s"):format(step.name, step.text) end
  return table.concat(lines, "\n")
end

-- ---- pictures ----

--- A shaded picture; options of bw.picture (values over points or facets).
function surface:picture(path, given)
  return core.picture(self, path, given)
end

local mesh = core.classes.mesh.methods

--- The same mesh with all lengths times a factor.
function mesh:scale(factor)
  return self:moved(self.nodes * factor)
end

--- A picture of the mesh; values over nodes or elements.
function mesh:picture(path, given)
  local opts = options.copied(given)
  local boundary, nodes, details = self:surface()
  if not boundary then return nil, nodes, details end
  if opts.values ~= nil then
    local values = opts.values
    options.object("picture", "option 'values'", values, "array")
    if #values ~= self.node_count then values = self:to_nodes(values) end
    opts.values = values:gather(nodes)
  end
  if opts.edges == nil then opts.edges = true end
  return core.picture(boundary, path, opts)
end

-- ---- arguments ----

arguments.methods("static", static, nil, {write = "path: string, options?: options",
  picture = "path: string, options?: options", reaction_on = "selection: selection"})
arguments.methods("modes", modes, nil, {write = "path: string, options?: options",
  picture = "mode: integer, path: string, options?: options"})
arguments.methods("surface", surface, nil, {picture = "path: string, options?: options"})
arguments.methods("mesh", mesh, nil, {scale = "factor: number", picture = "path: string, options?: options"})
