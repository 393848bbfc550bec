-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Models whose regions are of different materials.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"

local soft = bw.material.isotropic {name = "soft", young = 1e9, density = 1000, strength = 1e6, expansion = 1e-4}
local stiff = bw.material.isotropic {name = "stiff", young = 100e9, density = 8000, strength = 4e8,
  expansion = 1e-5}

--- A bar along x whose halves across x or y (axis) are the regions "low" and "high".
local function bar(axis, order)
  local mesh = bw.mesh.box {max = {2, 1, 1}, cells = {4, 2, 2}, order = order or 2}
  local nodes, tags = mesh.nodes, {}
  for e, row in ipairs(mesh.elements:totable()) do
    local sum = 0
    for a = 1, 4 do sum = sum + nodes(row[a], axis) / 4 end
    tags[e] = sum < (axis == 1 and 1 or 0.5) and 1 or 2
  end
  return assert(mesh:with_regions(tags, {"low", "high"}))
end

local function model(mesh)
  return bw.model {mesh = mesh, materials = {low = soft, high = stiff}}
end

describe("materials by region", function()
  it("refuses regions without a material, unknown names and other values", function()
    local mesh = bar(1)
    check.raises("region 'high' has no material: give it one", bw.model, {mesh = mesh, materials = {low = soft}})
    check.raises("there is no region 'hihg': did you mean 'high'?", bw.model,
      {mesh = mesh, materials = {low = soft, hihg = soft}})
    check.raises("there is no region 'low': the mesh has no regions", bw.model,
      {mesh = bw.mesh.box {}, materials = {low = soft}})
    check.raises("the mesh has no regions: give one material", bw.model, {mesh = bw.mesh.box {}, materials = {}})
    check.raises("region 'low': an open material expected, got 3", bw.model,
      {mesh = mesh, materials = {low = 3, high = soft}})
    check.raises("'material' or option 'materials' expected, not both", bw.model,
      {mesh = mesh, material = soft, materials = {low = soft, high = soft}})
  end)

  it("is the one material where all regions have it", function()
    local one = bw.model {mesh = bar(1), materials = {low = soft, high = soft}}
    assert.is_nil(one.material.parts)
    assert.equals(soft.young, one.material.young)
  end)

  it("lists volume and mass of each material, and what they have in common", function()
    local part = model(bar(1))
    local text = tostring(part)
    assert.matches("material of 'low': soft.-volume 1 m3, mass 1000 kg", text)
    assert.matches("material of 'high': stiff.-volume 1 m3, mass 8000 kg", text)
    assert.equals(2, #part.material.parts)
    assert.equals(1000, part.material.density)
    assert.is_nil(part.material.young)
  end)

  it("does not average stresses across an interface, and takes the strength of each element", function()
    for order = 1, 2 do
      local part = model(bar(2, order))
      local mesh, strain = part.mesh, 1e-4
      part:slide(mesh.boundary:below(1, 0), {1, 0, 0})
      part:slide(mesh.boundary:below(2, 0), {0, 1, 0})
      part:slide(mesh.boundary:below(3, 0), {0, 0, 1})
      part:prescribe(mesh.boundary:above(1, 2), {2 * strain, false, false})
      local static = assert(part:solve())
      for i = 1, mesh.node_count do
        local young = mesh.nodes(i, 2) < 0.5 - 1e-9 and 1e9 or 100e9
        check.near(strain * young, static.stress(i, 1), 1e-8 * strain * young)
      end
      for e = 1, mesh.element_count do
        local low = mesh.element_regions(e, 1) == 1
        check.near(low and strain * 1e9 / 1e6 or strain * 100e9 / 4e8, static.utilisation(e, 1), 1e-8)
      end
      local relative = static:error_estimate()
      assert.is_true(relative < 1e-8)
      local u = static.displacement
      assert.is_true(core.error_product(mesh, part.material, u, u):sum() < 1e-16 * static.energy)
      local recovered = assert(core.recovered_stress(mesh, part.material, u))
      assert.is_true((recovered - static.stress):norm() < 1e-8 * static.stress:norm())
    end
  end)

  it("estimates errors of load factors and modes, and refines for a goal", function()
    local function column(n)
      local mesh = bw.mesh.box {max = {1, 0.1, 0.08}, cells = {10 * n, 2 * n, n}, order = 2}
      mesh = assert(mesh:split("y < 0.05", "low"))
      local part = bw.model {mesh = mesh, materials = {low = bw.material.steel, rest = bw.material.pla}}
      part:fix(mesh.boundary:below("x", 0))
      return part:load {on = mesh.boundary:above("x", 1), force = {-1000, 0, -100}}
    end
    local one = assert(column(1):buckling {count = 2, sign = "positive"})
    local two = assert(column(2):buckling {count = 2, sign = "positive"})
    local fine = assert(column(3):buckling {count = 2, sign = "positive"})
    assert.matches("the shapes' mesh makes them too large by about 1%.7 %%", tostring(one))
    local estimates = {one:error_estimate(), two:error_estimate()}
    for k = 1, 2 do -- against the factor of the finest mesh, less its own error
      local exact = fine.factors[k] * (1 - fine:error_estimate()[k])
      check.near(one.factors[k] / exact - 1, estimates[1][k], 0.3)
      check.near(two.factors[k] / exact - 1, estimates[2][k], 0.4)
    end
    local _, accuracy = assert(column(1):modes {count = 1, error = 0.005})
    assert.is_true(accuracy.converged)
    _, accuracy = assert(column(1):solve {error = 0.01, of = {at = {1, 0.05, 0.04}, field = "uz"}})
    assert.is_true(accuracy.converged)
    local free = bw.model {mesh = column(1).mesh, materials = {low = bw.material.steel, rest = bw.material.pla}}
    free:fix(free.mesh.boundary:below("x", 0))
    local worst = assert(bw.worst_buckling(free, {force = 100, contact = 1e-3}))
    assert.is_true(worst.mesh_error > 0.005 and worst.mesh_error < 0.05)
    check.fails("unsupported", "give a place inside a region", column(1):solve {error = 0.1,
      of = {at = {0.5, 0.05, 0.08}}})
  end)

  it("expands each element as its material does", function()
    local part = model(bar(1))
    local mesh = part.mesh
    for axis = 1, 3 do part:slide(mesh.boundary:below(axis, 0), {axis == 1 and 1 or 0, axis == 2 and 1 or 0,
      axis == 3 and 1 or 0}) end
    for axis = 2, 3 do
      part:slide(mesh.boundary:above(axis, 1), {0, axis == 2 and 1 or 0, axis == 3 and 1 or 0})
    end
    part:temperature(10)
    local static = assert(part:solve())
    check.near(10 * (1e-4 + 1e-5), static.displacement:column(1):max(), 1e-12)
  end)

  it("expands library steel, and refuses a change of temperature on what does not expand", function()
    local mesh = bw.mesh.box {}
    local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
    part:temperature(100)
    assert.is_true(assert(part:solve()).displacement:column(1):max() > 1e-3)
    local inert = bw.model {mesh = bar(1), materials = {low = bw.material.pla, high = bw.material.pla}}
    check.raises("the material pla of region 'low' has no coefficient of expansion", inert.temperature, inert, 100)
    inert:fix(inert.mesh.boundary:below("x", 0))
    check.raises("the material pla of region 'low' has no coefficient of expansion", inert.deposit, inert,
      {layers = 2, change = -100})
    inert:temperature(100, 68e-6)
  end)

  it("balances a free body by its mass", function()
    local part = model(bar(1))
    local mesh = part.mesh
    part:load {on = mesh.boundary:above(1, 2), traction = {9000, 0, 0}}
    local static = assert(part:solve {inertia_relief = true})
    -- an acceleration of 1 m/s2: the soft half, 1000 kg, is behind x = 1
    local sum, count = 0, 0
    for e = 1, mesh.element_count do
      local x = 0
      for a = 1, 4 do x = x + mesh.nodes(mesh.elements(e, a), 1) / 4 end
      if x < 0.5 then sum, count = sum + static.element_stress(e, 1), count + 1 end
    end
    check.near(250, sum / count, 2.5)
  end)

  it("comes back from an input deck by the names of its regions", function()
    local path = os.tmpname() .. ".inp"
    local part = model(bar(1))
    assert(part:fix(part.mesh.boundary:below(1, 0)):write_inp(path))
    local mesh = assert(bw.mesh.read(path))
    os.remove(path)
    assert.same({"low", "high"}, {mesh.regions[1].name, mesh.regions[2].name})
    assert.equals(0, (mesh.element_regions - part.mesh.element_regions):norm())
  end)

  it("takes the formulation of the model", function()
    local part = model(bar(2, 2))
    local fine = bw.model {mesh = part.mesh, materials = {low = soft, high = stiff}, formulation = "b_bar"}
    assert.equals("b_bar", fine.formulation)
    assert.equals(2, #fine.material.parts)
  end)

  it("exert tractions on each other that are in equilibrium with all other loads", function()
    for order = 1, 2 do
      local straight = bar(1, order)
      local nodes, root, far = {}, {}, {}
      for i, p in ipairs(straight.nodes:totable()) do
        local x, y, z = p[1], p[2], p[3]
        nodes[i] = {x + 0.2 * y * y, y + 0.1 * z * x, z + 0.1 * x * x}
        root[i], far[i] = x < 1e-9 and 1 or 0, x > 1.999 and 1 or 0
      end
      local mesh = assert(straight:moved(bw.array.new(nodes)))
      local part, gravity = model(mesh), order == 1 and 9.81 or 0 -- volumes are those of straight edges
      local ends = assert(mesh.boundary:where(bw.array.new(far)))
      part:fix(assert(mesh.boundary:where(bw.array.new(root))))
      part:load {on = ends, traction = {3e3, 2e3, -1e3}}
      part:gravity {0, 0, -gravity}
      part:temperature(20)
      local static = assert(part:solve())
      local between = assert(static:interface_traction("low", "high"))
      local weight = 8000 * mesh:region("high").volume * gravity
      check.near(3e3 * ends.area, between.force[1], 1e-9)
      check.near(2e3 * ends.area, between.force[2], 1e-9)
      check.near(-1e3 * ends.area - weight, between.force[3], 1e-9)
      assert.is_true(between.imbalance < 1e-9)
      assert.equal(0, between.shared)
      local back = assert(static:interface_traction("high", "low"))
      for k = 1, 3 do
        check.near(-between.force[k], back.force[k], 1e-9)
        check.near(-between.moment[k], back.moment[k], 1e-9)
      end
      assert.is_true((between.normal - back.normal):max() < 1e-9 * between.normal:max())
      assert.is_true((between.shear - back.shear):max() < 1e-9 * between.shear:max())
      part:clear_loads()
      check.raises("the model has changed since this solution", static.interface_traction, static, "low", "high")
      assert.matches("^tractions of 'high' on 'low': normal .*Pa to .*Pa, shear up to .*; error unknown",
        tostring(between))
    end
  end)

  it("have constant tractions exactly, and none along supports", function()
    for order = 1, 2 do
      local mesh = bar(2, order)
      local part = bw.model {mesh = mesh, materials = {low = soft, high = soft}}
      for axis = 1, 3 do
        local normal = {axis == 1 and 1 or 0, axis == 2 and 1 or 0, axis == 3 and 1 or 0}
        part:slide(mesh.boundary:below(axis, 1e-9), normal)
      end
      part:load {on = mesh.boundary:above("y", 1), pressure = 5e4}
      part:load {on = mesh.boundary:above("x", 2), traction = {7e4, 0, 0}}
      local between = assert(assert(part:solve()):interface_traction("low", "high"))
      local normal = between.normal:gather(between.nodes)
      check.near(-5e4, normal:min(), 1e-9)
      check.near(-5e4, normal:max(), 1e-9)
      assert.is_true(between.shear:max() < 1e-4)
      check.near(2, between.area, 1e-12)
      assert.is_true(between.shared > 0)
      assert.matches("supports or other regions take a part that is not included", tostring(between))
    end
  end)

  it("say where there are no tractions", function()
    local mesh = assert(bar(1, 1):split("x > 1.5", "end"))
    local part = bw.model {mesh = mesh, materials = {low = soft, high = stiff, ["end"] = soft}}
    part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 2), force = {1, 0, 0}}
    local static = assert(part:solve())
    assert.equal("the regions 'low' and 'end' do not touch", tostring(static:interface_traction("low", "end")))
    check.raises("did you mean 'low'", static.interface_traction, static, "lov", "high")
    check.raises("two different regions expected", static.interface_traction, static, "low", "low")
    local instant = assert(part:transient {step = 1e-5}):static()
    check.fails("unsupported", "other loads than its model", instant:interface_traction("low", "high"))
  end)

  it("rank worst loads by stress over the strength of each", function()
    local mesh = bar(1, 1)
    local function worst_of(strength)
      local other = bw.material.isotropic {young = 1e9, density = 1000, strength = strength}
      local part = bw.model {mesh = mesh, materials = {low = soft, high = other}}
      return assert(bw.worst_case(part, {modes = 6, force = 100, pressure = 1e5}))
    end
    local worst = worst_of(1e3)
    local best = 0
    for _, region in ipairs(worst.regions) do best = math.max(best, region.utilisation) end
    assert.equal(best, worst.utilisation)
    local found = worst.regions[worst.region]
    assert.equal(best, found.utilisation)
    assert.is_true(found.utilised_at[1] > 1)
    check.near(worst_of(1e6).utilisation * 1e6, worst_of(nil).max_principal, 1e-12)
    assert.matches(" of the strength of the material at %(", tostring(worst))
    assert.is_nil(worst_of(nil).utilisation)
    assert.matches("the strength is not known", tostring(worst_of(nil)))
  end)
end)
