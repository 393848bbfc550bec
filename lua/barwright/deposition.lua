-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Depositions: files and pictures of residual stress. docs/theory/deposition.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local fine_boundary = require "barwright.fine_boundary"
local options = require "barwright.options"

local deposition = core.classes.deposition.methods

--- Displacement, reaction, stress and layers, as .vtu (or what the ending says).
function deposition:write(path)
  return self.mesh:write(path, {fields = {
    displacement = {self.displacement, on = "nodes"}, reaction = {self.reaction, on = "nodes"},
    element_stress = {self.element_stress, on = "elements"},
    element_von_mises = {self.element_von_mises, on = "elements"}, layer = {self.layer, on = "elements"}}})
end

--- The deformed body coloured by the von Mises stress of its elements; options of bw.picture.
function deposition:picture(path, given)
  local opts = options.copied(given)
  local surface, nodes, details = fine_boundary(self.mesh)
  if not surface then return nil, nodes, details end
  opts.values = self.mesh:to_nodes(self.element_von_mises):gather(nodes)
  opts.displacement = opts.displacement or self.displacement:gather(nodes)
  opts.unit, opts.scale = opts.unit or "residual von Mises stress, MPa", opts.scale or 1e-6
  return core.picture(surface, path, opts)
end

arguments.methods("deposition", deposition, nil, {write = "path: string",
  picture = "path: string, options?: options"})
