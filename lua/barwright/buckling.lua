-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- part:buckling {...}: static solution and load factors; files, pictures and imperfect meshes of the shapes.
-- docs/theory/stability.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local shape_files = require "barwright.shape_files"
local shown = require "barwright.shown"

local raise = core.raise
local model, buckling = core.classes.model.methods, core.classes.buckling.methods

--- The static solution by a factor, and its load factors; options of static:buckling.
function model:buckling(given)
  local static, message, details = self:solve {solver = core.solver.cholesky {}}
  if not static then return nil, message, details end
  return static:buckling(given)
end

--- The shapes as .vtu, one field for each load factor.
function buckling:write(path, given)
  return shape_files.write(self, "shape_%02d", path, given)
end

--- A shape, deformed and coloured by how far each place moves.
function buckling:picture(i, path, given)
  return shape_files.picture(self, i, path, given, function()
    local errors, message, details = self:error_estimate()
    if not errors then return nil, message, details end
    return ("buckling shape %d: load factor %s, about %s too large"):format(i, shown.number(self.factors[i]),
      shown.error(errors[i]))
  end)
end

--- The mesh moved along a combination of shapes, whose largest displacement is the amplitude (m).
function buckling:imperfect_mesh(given)
  local opts = options.read("imperfect_mesh", given, {
    amplitude = {type = "number", needed = true},
    weights = {type = "table", default = {1}},
  })
  if #opts.weights < 1 or #opts.weights > self.count then
    raise(("imperfect_mesh: option 'weights': 1 to %d numbers expected, one for each shape, got %d"):format(
      self.count, #opts.weights))
  end
  local sum = self:shape(1) * 0
  for i, weight in ipairs(opts.weights) do
    if type(weight) ~= "number" then
      raise(("imperfect_mesh: option 'weights': item %d: a number expected, got %s"):format(i, core.got(weight)))
    end
    sum = sum + self:shape(i) * weight
  end
  local largest = core.array.map("norm(a)", {a = sum}):max()
  if not (largest > 0 and largest < math.huge) then
    raise "imperfect_mesh: option 'weights': finite numbers expected, not all of them zero"
  end
  return self.mesh:moved(self.mesh.nodes + sum * (opts.amplitude / largest))
end

arguments.methods("model", model, nil, {buckling = "options?: options"})
arguments.methods("buckling", buckling, nil, {write = "path: string, options?: options",
  picture = "shape: integer, path: string, options?: options", imperfect_mesh = "options: options"})
