-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Files and pictures of values at the nodes of a mesh.
local core = require "barwright.core"
local fine_boundary = require "barwright.fine_boundary"
local options = require "barwright.options"

local nodal_files = {}

--- A mesh file with these arrays by name, beside the fields that are given.
function nodal_files.write(mesh, values, path, given)
  local opts = options.copied(given)
  opts.fields = options.copied(opts.fields, "fields")
  for name, array in pairs(values) do opts.fields[name] = {array, on = "nodes"} end
  return mesh:write(path, opts)
end

--- The body coloured by a stress, in MPa unless the options of bw.picture say otherwise; `what` names it.
function nodal_files.picture(mesh, stress, what, path, given)
  local opts = options.copied(given)
  local surface, nodes, details = fine_boundary(mesh)
  if not surface then return nil, nodes, details end
  opts.values = stress:gather(nodes)
  opts.unit, opts.scale = opts.unit or what .. ", MPa", opts.scale or 1e-6
  return core.picture(surface, path, opts)
end

return nodal_files
