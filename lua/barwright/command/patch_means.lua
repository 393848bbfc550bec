-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The mean stress over patches of the surface that governs a part. A patch of a part of several materials lies
-- within one of them, as stresses jump between them.
local bw = require "barwright"
local made_of = require "barwright.command.made_of"

local patch_means = {}

-- What governs among the elements that have no node on the surface, which no patch sees.
local function governing_inside(made, static)
  local mesh, on_surface, touches = static.mesh, {}, nil
  for i = 1, mesh.node_count do on_surface[i] = 0 end
  for _, node in ipairs(mesh.boundary.nodes:totable()) do on_surface[node] = 1 end
  on_surface = bw.array(on_surface)
  for k = 1, 4 do
    local corner = on_surface:gather(mesh.elements:column(k))
    touches = touches and touches + corner or corner
  end
  return made_of.governing(made, static, bw.array.map("where(t > 0, 0, u)", {t = touches, u = static.utilisation}))
end

-- Of the patches within one material: the largest stress over strength and the region where it is; nil where no
-- facet is of the material. `stress`: at the corners of facets.
local function governing_patch(made, material, static, stress, radius)
  local mesh, corners, own, region_at = static.mesh, {}, {}, {}
  local elements = mesh.facet_elements:totable()
  for i = 1, mesh.node_count do own[i] = 0 end
  for facet, nodes in ipairs(mesh.facets:totable()) do
    local region = made_of.region_of(static, elements[facet])
    local inside = made_of.material_of(made, region) == material
    for k = 1, 3 do corners[3 * (facet - 1) + k] = inside and 1 or 0 end
    for _, node in ipairs(inside and nodes or {}) do own[node], region_at[node] = 1, region end
  end
  if next(region_at) == nil then return nil end
  corners = bw.array(corners)
  local sum, share = bw.surface_mean(mesh, stress * corners, radius, static),
    bw.surface_mean(mesh, corners, radius, static)
  if not (sum and share) then return nil end
  local used = material:utilisation(bw.array.map("where(o * h > 0, s / max(h, 1e-300), 0)",
    {o = bw.array(own), h = share, s = sum}))
  local node = used:argmax()
  return {used = used[node], material = material, region = region_at[node]}
end

--- The largest mean of stress over strength: {used =, material =, region = name or nil}; nil where the stress of
--- the surface is not known.
function patch_means.governing(made, static, radius)
  local mesh, material = static.mesh, static.material
  local stress = bw.surface_stress(mesh, material, static.displacement, static.force)
  if not stress then return nil end
  if not material.parts then
    local mean = bw.surface_mean(mesh, stress, radius, static)
    return mean and {used = material:utilisation(mean):max(), material = material}
  end
  local governing = governing_inside(made, static)
  for _, one in ipairs(made_of.materials(made)) do
    local found = governing_patch(made, one, static, stress, radius)
    if found and found.used > governing.used then governing = found end
  end
  return governing
end

return patch_means
