-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The boundary of a mesh with all of its nodes, for pictures and pages: the largest value may lie in the middle of
-- an edge.
local core = require "barwright.core"

-- The corners of four triangles in the nodes of a facet with mid-edge nodes.
local QUARTERS = {{1, 4, 6}, {4, 2, 5}, {6, 5, 3}, {4, 5, 6}}

--- The surface, and the nodes of the mesh that its points are; or nil, message, details.
return function(mesh)
  if mesh.order == 1 then return mesh:surface() end
  local number, nodes, triangles = {}, {}, {}
  for _, facet in ipairs(mesh.facets:totable()) do
    for i, node in ipairs(facet) do
      if not number[node] then
        nodes[#nodes + 1] = node
        number[node] = #nodes
      end
      facet[i] = number[node]
    end
    for _, corners in ipairs(QUARTERS) do
      triangles[#triangles + 1] = {facet[corners[1]], facet[corners[2]], facet[corners[3]]}
    end
  end
  local found, message, details = core.surface.new {points = mesh.nodes:gather(nodes), triangles = triangles}
  if not found then return nil, message, details end
  return found, core.array.new(nodes)
end
