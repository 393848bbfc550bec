-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Files and pictures of eigenvectors: modes of vibration, and shapes of buckling. Each is an object with `mesh`,
-- `count` and `shape(i)`.
local core = require "barwright.core"
local options = require "barwright.options"

local shape_files = {}

--- A mesh file with a field for each shape, called by `name`, a format of its number.
function shape_files.write(self, name, path, given)
  local opts = options.copied(given)
  opts.fields = options.copied(opts.fields, "fields")
  for i = 1, self.count do opts.fields[name:format(i)] = {self:shape(i), on = "nodes"} end
  return self.mesh:write(path, opts)
end

--- A picture of shape i: deformed and coloured by how far each place moves, or where it has one component by its
--- values. `title` gives the title where none is given, or nil, a message and details.
function shape_files.picture(self, i, path, given, title)
  local opts = options.copied(given)
  local shape = self:shape(i)
  local surface, nodes, details = self.mesh:surface()
  if not surface then return nil, nodes, details end
  if shape.column_count == 3 then
    opts.values = core.array.map("norm(a)", {a = shape}):gather(nodes)
    opts.unit, opts.scale = opts.unit or "displacement over the largest", opts.scale or 1 / opts.values:max()
    opts.displacement = shape:gather(nodes)
  else
    opts.values = shape:gather(nodes)
  end
  if not opts.title then
    opts.title, nodes, details = title()
    if not opts.title then return nil, nodes, details end
  end
  return core.picture(surface, path, opts)
end

return shape_files
