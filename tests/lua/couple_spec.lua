-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Couplings with remote points in Lua: a cantilever, what is printed, and misuse.
local bw = require "barwright"
local check = require "check"

local function cantilever()
  local mesh = bw.mesh.box {max = {1, 0.1, 0.2}, cells = {6, 1, 2}, order = 2}
  local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 2e11, poisson = 0, density = 7800}}
  part:fix(mesh.boundary:below("x", 0))
  return part, mesh.boundary:above("x", 1)
end

describe("couplings", function()
  it("bend a cantilever by a moment", function()
    for _, kind in ipairs {"rigid", "distributed"} do
      local part, tip = cantilever()
      part:couple {on = tip, kind = kind, moment = {0, 500, 0}}
      local point = assert(part:solve()).couplings[1]
      local curvature = 500 / (2e11 * 0.1 * 0.2 ^ 3 / 12)
      check.near(curvature, point.rotation[2], 1e-7)
      check.near(-curvature / 2, point.displacement[3], 1e-7)
      check.near(500, point.moment[2], 1e-9)
      local static = assert(part:solve())
      local text = tostring(static)
      assert.truthy(text:find("coupling 1: " .. tostring(static.couplings[1]), 1, true), text)
      assert.matches("^remote point moves by %(", tostring(static.couplings[1]))
      assert.is_true(math.abs(point.force[1]) < 1e-6)
    end
  end)

  it("hold with a long lever, and refuse one that is too long for the numbers", function()
    local stiffness = 2e11 * 0.1 * 0.2 ^ 3 / 12
    for _, kind in ipairs {"rigid", "distributed"} do
      local part, tip = cantilever()
      part:couple {on = tip, kind = kind, at = {201, 0.05, 0.1}, force = {0, 0, -1}}
      check.near((200 + 1 / 2) / stiffness, assert(part:solve()).couplings[1].rotation[2], 1e-6)
      part:clear_couplings()
      check.fails("geometry", "1e+06 m from the centre of its face", part:couple {on = tip, kind = kind,
        at = {1e6 + 1, 0.05, 0.1}})
      assert.equal(0, #part.couplings)
    end
  end)

  it("prescribe a motion and give its reaction", function()
    local part, tip = cantilever()
    part:couple {on = tip, displacement = {1e-4, false, false}, rotation = {false, false, 0}}
    local point = assert(part:solve()).couplings[1]
    check.near(2e11 * 0.1 * 0.2 * 1e-4, point.reaction[1], 1e-8)
    check.near(1e-4, point.displacement[1], 1e-10)
    assert.is_true(math.abs(point.reaction_moment[3]) < 1e-4)
    assert.equal(0, point.reaction[2])
  end)

  it("are listed and printed", function()
    local part, tip = cantilever()
    part:couple {on = tip, kind = "rigid", at = {1.5, 0, 0}, force = {0, 0, -3}, mass = 2,
      inertia = {1, 2, 3, 0, 0, 0.5}, spring = {0, 5, 0}, rotational_spring = {7, 0, 0},
      displacement = {false, false, 1e-3}}
    local list = part.couplings
    assert.equal("rigid", list[1].kind)
    check.near(0.02, list[1].area, 1e-12)
    assert.equal(1.5, list[1].at[1])
    assert.equal(-3, list[1].force[3])
    assert.equal(tip.node_count, list[1].node_count)
    local text = tostring(part)
    for _, words in ipairs {"coupling 1: rigid, 0.02 m2, ", "remote point at (1.5, 0, 0) m", "force (0, 0, -3) N",
      "mass 2 kg", "inertia (1, 2, 3) kg m2", "spring (0, 5, 0) N/m", "spring (7, 0, 0) N m/rad",
      "prescribes z = 0.001 m", "no rigid-body mode"} do
      assert.truthy(text:find(words, 1, true), words .. "\n" .. text)
    end
    part:clear_couplings()
    assert.equal(0, #part.couplings)
  end)

  it("stay on a refined mesh", function()
    local part, tip = cantilever()
    part:couple {on = tip, kind = "rigid", at = {1.2, 0.05, 0.1}, moment = {0, 500, 0}}
    local before = assert(part:solve()).couplings[1].rotation[2]
    local fine = part
    for _ = 1, 3 do fine = assert(fine:refined(bw.array.zeros(fine.mesh.element_count) + 1, {order = 2})) end
    assert.is_true(fine.couplings[1].node_count > part.couplings[1].node_count)
    check.near(before, assert(fine:solve()).couplings[1].rotation[2], 1e-6)
  end)

  it("are refused where they make no sense or are not known", function()
    local part, tip = cantilever()
    for _, wrong in ipairs {{on = tip, kind = "soft"}, {force = {1, 0, 0}}, {on = tip, inertia = {1, 2}},
      {on = tip, displacement = {1, true, 0}}, {on = tip, rotation = 1}, {on = tip, mass = -1},
      {on = tip, spring = {-1, 0, 0}}} do
      assert.has_error(function() part:couple(wrong) end)
    end
    part:couple {on = tip, force = {1, 0, 0}}
    local system, why = part:system()
    assert.is_nil(system)
    assert.truthy(why:find("1 coupling:", 1, true), why)
    check.fails("unsupported", "inertia relief is for models without", part:solve {inertia_relief = true})
  end)
end)
