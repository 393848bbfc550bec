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

-- The largest displacement of a picture, over the diagonal of the box.
local DEFORMATION = 0.05

--- A picture of shape i: deformed and coloured by how far each place moves, or where it has one component by its
--- values. Shapes have no scale, so the factor on them is not shown. `title` gives the title where none is
--- given, or nil, a message and details.
function shape_files.picture(self, i, path, given, title)
  local opts = options.copied(given)
  local shape = self:shape(i)
  local surface, nodes, details = self.mesh:surface()
  if not surface then return nil, nodes, details end
  if shape.column_count == 3 then
    opts.values = core.array.map("norm(a)", {a = shape}):gather(nodes)
    opts.unit, opts.scale = opts.unit or "displacement over the largest", opts.scale or 1 / opts.values:max()
    local size, factor = surface.box.size, opts.deformation
    if factor == nil or factor == 0 then
      factor = DEFORMATION * math.sqrt(size[1] ^ 2 + size[2] ^ 2 + size[3] ^ 2) / opts.values:max()
    end
    opts.displacement = shape:gather(nodes)
    if type(factor) == "number" then opts.displacement, opts.deformation = opts.displacement * factor, 1 end
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
