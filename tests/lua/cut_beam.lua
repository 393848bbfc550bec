-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A beam in two halves.
local bw = require "barwright"

-- The model of a beam of two halves, fixed at x = 0, and its tip: in one piece, or cut and bonded, where faces
-- match.
return function(cut, cells, material)
  local nodes, elements, of, seen = {}, {}, {}, {}
  for body = 0, 1 do
    local half = bw.mesh.box {min = {body / 2, 0, 0}, max = {body / 2 + 0.5, 0.1, 0.05}, cells = cells, order = 2}
    for i, p in ipairs(half.nodes:totable()) do
      local key = ("%d %.6f %.6f %.6f"):format(cut and body or 0, p[1], p[2], p[3])
      if not seen[key] then
        nodes[#nodes + 1] = p
        seen[key] = #nodes
      end
      of[i] = seen[key]
    end
    for _, e in ipairs(half.elements:totable()) do
      for k = 1, #e do e[k] = of[e[k]] end
      elements[#elements + 1] = e
    end
  end
  local mesh = assert(bw.mesh.new {nodes = nodes, elements = elements, order = 2})
  local part = bw.model {mesh = mesh,
    material = material or bw.material.isotropic {young = 2e11, poisson = 0.3, density = 7800}}
  part:fix(mesh.boundary:below("x", 0))
  if cut then
    local middle = mesh.boundary:above("x", 0.499):below("x", 0.501)
    part:bond {a = middle:facing {1, 0, 0}, b = middle:facing {-1, 0, 0}}
  end
  return part, mesh.boundary:above("x", 1)
end
