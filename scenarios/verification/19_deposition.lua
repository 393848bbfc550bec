-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Parts that are laid down layer by layer: balances of force and moment in closed form.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Deposition",
  text = [[Residual stress of parts that are laid down layer by layer, beside the balance of force and moment
in each step ([theory](theory/deposition.md)).]]}

local E, nu, alpha, change = 200e9, 0.3, 12e-6, -500
local steel = bw.material.isotropic {young = E, poisson = nu, expansion = alpha}
local layers, thickness = 6, 1e-3

-- Stress in the plane of each layer, and the curvature in the end, of a wide plate that nothing constrains.
local function closed_form()
  local stress, bent, shrinkage = {}, 0, alpha * change
  for k = 1, layers do
    local height = k * thickness
    local mean = shrinkage * thickness / height
    local curvature = 6 * shrinkage * thickness * (height - thickness) / height ^ 3
    stress[k] = 0
    for i = 1, k do
      local strain = mean + curvature * ((i - 0.5) * thickness - height / 2) - (i == k and shrinkage or 0)
      stress[i] = stress[i] + E / (1 - nu) * strain
    end
    bent = k == 1 and 0 or bent + curvature
  end
  return stress, bent
end

scenario("A free plate of six layers", function(t)
  local side, height = 48e-3, layers * thickness
  local mesh = bw.mesh.box {max = {side, side, height}, cells = {16, 16, layers}, order = 2}
  local part = bw.model {mesh = mesh, material = steel}
  local built = t:require(part:deposit {layers = layers, change = change})
  local stress, curvature = closed_form()
  local sum, volume = {}, {}
  for e = 1, mesh.element_count do
    local x, y = 0, 0
    for a = 1, 4 do
      x, y = x + mesh.nodes(mesh.elements(e, a), 1) / 4, y + mesh.nodes(mesh.elements(e, a), 2) / 4
    end
    if math.abs(x - side / 2) < height / 2 and math.abs(y - side / 2) < height / 2 then
      local k, v = built.layer(e, 1), mesh.volumes(e, 1)
      sum[k], volume[k] = (sum[k] or 0) + v * built.element_stress(e, 1), (volume[k] or 0) + v
    end
  end
  local source = "balance of force and moment of each layer"
  for k = 1, layers do
    expect(sum[k] / volume[k], ("stress of layer %d in its plane"):format(k), "Pa")
      :near(stress[k], {absolute = 0.01 * stress[layers], source = source})
  end
  -- the sag of the middle of the lowest face below chords of two lengths
  local function lift(x, y)
    return mesh:sample(built.displacement, {{x, y, 1e-9}})(1, 3)
  end
  local middle, reach = side / 2, 6e-3
  local ends = (lift(middle - reach, middle) + lift(middle + reach, middle)) / 2
  expect(2 * (ends - lift(middle, middle)) / reach ^ 2, "curvature", "1/m")
    :near(-curvature, {relative = 0.01, source = source})
end)
