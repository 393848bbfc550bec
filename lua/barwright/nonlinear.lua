-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- part:nonlinear {...}: files, pictures and curves of geometrically nonlinear statics. docs/theory/finite.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local plot = require "barwright.plot"
local shown = require "barwright.shown"

local raise = core.raise
local nonlinear = core.classes.nonlinear.methods

local axes = {x = 1, y = 2, z = 3}

--- Sum of the reactions of the last state at the nodes of a selection.
function nonlinear:reaction_on(selection)
  return self.reaction:gather(selection.nodes):column_sums()
end

--- The steps as CSV: load factors, what was monitored, and how each state was found.
function nonlinear:write_history(path)
  local heads, columns = {"load_factor"}, {self.factors}
  for i = 1, #self.monitors do
    local moves = self:path(i)
    for name, k in pairs(axes) do
      heads[1 + 3 * (i - 1) + k], columns[1 + 3 * (i - 1) + k] = ("u%d_%s_m"):format(i, name), moves:column(k)
    end
  end
  for _, column in ipairs {{"largest_displacement_m", "largest_displacements"}, {"energy_J", "energies"},
    {"residual", "residuals"}, {"iterations", "iterations"}, {"negative_pivots", "negative_pivots"}} do
    heads[#heads + 1], columns[#columns + 1] = column[1], self[column[2]]
  end
  local lines = {table.concat(heads, ",")}
  for i = 1, self.count do
    local row = {}
    for k, values in ipairs(columns) do row[k] = ("%.17g"):format(values[i]) end
    lines[i + 1] = table.concat(row, ",")
  end
  return core.write_file(path, table.concat(lines, "\n") .. "\n")
end

-- A list that begins at the state without load.
local function from_zero(values)
  local list = {0}
  for i = 1, #values do list[i + 1] = values[i] end
  return list
end

--- A plot of the load factor over the displacement of a monitored node.
function nonlinear:figure(given)
  local opts = options.read("figure", given, {
    monitor = {type = "number", default = 1},
    axis = {type = "string", default = "norm"},
  })
  local moves, place = self:path(opts.monitor), self.monitors:totable()[opts.monitor]
  local across
  if opts.axis == "norm" then
    across = core.array.map("norm(a)", {a = moves})
  elseif axes[opts.axis] then
    across = moves:column(axes[opts.axis])
  else
    raise(("figure: option 'axis': \"x\", \"y\", \"z\" or \"norm\" expected, got %s"):format(core.got(opts.axis)))
  end
  return plot.lines {series = {{x = from_zero(across), y = from_zero(self.factors)}},
    x = {label = opts.axis == "norm" and "displacement" or "displacement along " .. opts.axis, unit = "m"},
    y = {label = "load factor"}, title = ("node at (%g, %g, %g) m"):format(place[1], place[2], place[3])}
end

--- The last state as .vtu or other files.
function nonlinear:write(path, given)
  local opts = options.copied(given)
  opts.fields = options.copied(opts.fields, "fields")
  opts.fields.displacement = {self.displacement, on = "nodes"}
  opts.fields.reaction = {self.reaction, on = "nodes"}
  opts.fields.von_mises = {self.von_mises, on = "nodes"}
  opts.fields.cauchy_stress = {self.stress, on = "nodes"}
  return self.mesh:write(path, opts)
end

--- The last state in its true scale, coloured by its von Mises stress.
function nonlinear:picture(path, given)
  local opts = options.copied(given)
  local surface, nodes, details = self.mesh:surface()
  if not surface then return nil, nodes, details end
  opts.values = self.von_mises:gather(nodes)
  opts.unit, opts.scale = opts.unit or "von Mises stress, MPa", opts.scale or 1e-6
  opts.displacement, opts.deformation = self.displacement:gather(nodes), opts.deformation or 1
  opts.title = opts.title or ("load factor %s; %s"):format(shown.number(self.factor), core.error_unknown)
  return core.picture(surface, path, opts)
end

arguments.methods("nonlinear", nonlinear, nil, {reaction_on = "selection: selection",
  write_history = "path: string", figure = "options?: options", write = "path: string, options?: options",
  picture = "path: string, options?: options"})
