-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Parts of decks of CalculiX (ccx).
local deck = {}

local FACES = {{1, 2, 3}, {1, 4, 2}, {2, 4, 3}, {3, 4, 1}} -- of its C3D4 and C3D10

--- The faces of a selection in a deck of CalculiX.
function deck.surface(mesh, selection, name)
  local lines = {("*SURFACE, NAME=%s, TYPE=ELEMENT"):format(name)}
  local elements, facets, behind = mesh.elements, mesh.facets, mesh.facet_elements
  for _, f in ipairs(selection.facets:totable()) do
    local e, has = behind(f), {}
    for k = 1, 3 do has[facets(f, k)] = true end
    for face, corners in ipairs(FACES) do
      local all = true
      for _, k in ipairs(corners) do all = all and has[elements(e, k)] end
      if all then lines[#lines + 1] = ("%d, S%d"):format(e, face) end
    end
  end
  return table.concat(lines, "\n")
end

--- The nodes of a selection.
function deck.node_set(name, selection)
  local lines = {"*NSET, NSET=" .. name}
  for _, i in ipairs(selection.nodes:totable()) do lines[#lines + 1] = i .. "," end
  return table.concat(lines, "\n")
end

return deck
