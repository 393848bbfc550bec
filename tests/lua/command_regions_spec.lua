-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Commands on meshes whose regions are of different materials: --material REGION=NAME.
local bw = require "barwright"
local check = require "check"
local made_of = require "barwright.command.made_of"

local folder = check.folder() .. "/"
local LENGTH, SIDE = 0.1, 0.01

-- A bar along x whose first half is the region "grip", the other one "rest".
local mesh = assert(bw.mesh.box {max = {LENGTH, SIDE, SIDE}, cells = {10, 2, 2}, order = 2}:split("x < 0.05",
  "grip"))
for _, ending in ipairs {"msh", "vtu", "mesh", "inp"} do assert(mesh:write(folder .. "bar." .. ending)) end
assert(bw.surface.box {max = {LENGTH, SIDE, SIDE}}:write(folder .. "bar.stl"))

local BOTH = " --unit m --material rest=pla --material grip=steel"
local materials = {rest = bw.material.pla, grip = bw.material.steel}

local answer = check.answer

local function solved(force, given)
  local part = bw.model {mesh = mesh, materials = given or materials}
  part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", LENGTH), force = force}
  return assert(part:solve())
end

local function used_of(static, region) return static.utilisation:gather(mesh:region(region).elements):max() end

local PULL = " --fix below:x:0 --force above:x:99.9mm=1000N,0,0"

describe("commands on several materials", function()
  it("keep one material for all regions, and say so", function()
    local words = "modes " .. folder .. "bar.msh --count 1 --material steel"
    local _, out = check.run(words)
    assert.truthy(out:find("All of it is steel: the regions are rest, grip, and --material REGION=NAME gives each "
      .. "its own.", 1, true), out)
    local _, object = answer(words)
    assert.same({"rest", "grip"}, object.regions)
    assert.equal("steel", object.material)
    assert.is_nil(object.materials)
    check.near(7850 * LENGTH * SIDE ^ 2, object.mass_kg, 1e-9)
    local _, same = answer("modes " .. folder .. "bar.msh --count 1 --material rest=steel --material grip=steel")
    assert.same(object.frequencies_hz, same.frequencies_hz)
  end)

  it("offer REGION=NAME only where they take it", function()
    local _, out = check.run("worst " .. folder .. "bar.msh --unit m --material steel")
    assert.truthy(out:find("All of it is steel: the regions are rest, grip.\n", 1, true), out)
  end)

  it("take mass, stiffness and strength of each region from files of every format", function()
    local static = solved {1000, 0, 0}
    for _, ending in ipairs {"msh", "vtu", "mesh", "inp"} do
      local status, object = answer("statics " .. folder .. "bar." .. ending .. PULL .. BOTH)
      assert.equal(0, status)
      check.near((1240 + 7850) * LENGTH / 2 * SIDE ^ 2, object.mass_kg, 1e-9)
      assert.equal("pla + steel", object.material)
      assert.same({"pla", "steel"}, {object.materials[1].material, object.materials[2].material})
      -- the bar is longer by F L / (E A) of each half; the fixed end holds it across
      local stress = 1000 / SIDE ^ 2
      check.near(stress * LENGTH / 2 * (1 / 3.6e9 + 1 / 210e9), object.max_displacement_m, 0.05)
      assert.equal("rest", object.governing_region)
      check.near(53e6, object.strength_pa, 1e-12)
      for _, one in ipairs(object.by_region) do
        check.near(used_of(static, one.region), one.utilisation, 1e-6)
      end
    end
  end)

  it("judge the region that governs, not the largest stress", function()
    -- in bending the grip has the larger stress, and the rest the smaller strength
    local words = "statics " .. folder .. "bar.msh --fix below:x:0 --force above:x:99.9mm=0,0,-200N"
    local _, out = check.run(words .. BOTH)
    assert.truthy(out:find("of the strength of pla in region rest", 1, true), out)
    assert.truthy(out:find("Region grip: steel, 5 cm3, 39.25 g.", 1, true), out)
    assert.truthy(out:find("different materials meet at the surface at (50, ", 1, true), out)
    local static = solved {0, 0, -200}
    local function largest(region) return static.element_von_mises:gather(mesh:region(region).elements):max() end
    assert.is_true(largest "grip" > largest "rest")
    local status, object = answer(words .. BOTH)
    assert.equal("materials", object.singular_by)
    local pla, steel = used_of(static, "rest"), used_of(static, "grip")
    assert.is_true(pla > steel)
    check.near(6 * 200 * LENGTH / 2 / SIDE ^ 3 / 53e6, object.utilisation, 0.15) -- M / W, the mean over a patch
    assert.equal("unsure", object.verdict)
    assert.equal(1, status)
    -- of one material alone the other end governs
    local _, swapped = answer(words .. " --unit m --material grip=pla --material rest=steel")
    assert.equal("grip", swapped.governing_region)
  end)

  it("average over patches within one material", function()
    local patch_means = require "barwright.command.patch_means"
    local made = made_of.read {material = {"rest=pla", "grip=steel"}}
    local function governing(given)
      return patch_means.governing(made, solved({1000, 0, 0}, given), 0.004)
    end
    -- both halves have the stress 10 MPa, as if each were alone; patches across would mix the strengths
    local found = governing(materials)
    assert.equal("rest", found.region)
    check.near(10e6 / 53e6, found.used, 0.1)
    -- a body inside, without a surface, is judged by its elements
    local inner = assert(bw.mesh.box {max = {0.04, 0.04, 0.04}, cells = {8, 8, 8}, order = 2}:split(
      "max(max(abs(x - 0.02), abs(y - 0.02)), abs(z - 0.02)) < 0.0101", "core"))
    made = made_of.read {material = {"rest=steel", "core=pla"}}
    local brittle = bw.material.isotropic {young = 210e9, poisson = 0.3, strength = 1e6, name = "brittle"}
    made.named[2][2] = brittle
    local part = bw.model {mesh = inner, materials = {rest = made.named[1][2], core = brittle}}
    part:fix(inner.boundary:below("x", 0)):load {on = inner.boundary:above("x", 0.04), force = {16000, 0, 0}}
    found = patch_means.governing(made, assert(part:solve()), 0.004)
    assert.equal("core", found.region)
    check.near(10, found.used, 0.1)
  end)

  it("give modes, load factors, vibration, drops and temperatures of each material", function()
    local part = bw.model {mesh = mesh, materials = materials}
    part:fix(mesh.boundary:below("x", 0))
    local path = folder .. "bar.msh --fix below:x:0 "
    local _, object = answer("modes " .. path .. "--count 1" .. BOTH)
    check.near(part:modes({count = 1}).frequencies[1], object.frequencies_hz[1], 1e-6)
    _, object = answer("buckle " .. path .. "--force above:x:99.9mm=-1000,0,0 --count 1" .. BOTH)
    local static = solved {-1000, 0, 0}
    local factor = static:buckling({count = 1}).factors[1]
    check.near(factor, object.load_factor, 1e-6)
    check.near(factor * static.utilisation:max(), object.utilisation_at_factor, 1e-6)
    assert.equal("rest", object.governing_region)
    _, object = answer("respond " .. path .. "--base 0,0,10g --to 100 --damping 0.02" .. BOTH)
    assert.equal("rest", object.governing_region)
    check.near(53e6, object.strength_pa, 1e-12)
    assert.is_true(object.utilisation * 53e6 <= object.value)
    assert.is_true(object.singular)
    assert.equal("unsure", object.verdict) -- where the materials meet
    _, object = answer("drop " .. folder .. "bar.msh --height 0.1m" .. BOTH)
    local fall = assert(bw.model {mesh = mesh, materials = materials}:drop {height = 0.1})
    local most = object.touch.utilisation > object.elsewhere.utilisation and object.touch or object.elsewhere
    check.near(fall.utilisation:max(), most.utilisation, 1e-6)
    assert.equal(mesh.regions[mesh.element_regions[fall.utilisation:argmax()]].name, most.region)
    check.near((1240 + 7850) * LENGTH / 2 * SIDE ^ 2 * 9.80665 * 0.1, object.energy_j, 1e-3)
    _, object = answer("drop " .. folder .. "bar.msh --height 5m --drops 2 --elements 100" .. BOTH)
    assert.equal(2, object.drops)
    _, object = answer("heat " .. folder .. "bar.msh --power below:x:0=0.1 --temperature above:x:99.9mm=20C"
      .. BOTH)
    local k = {bw.material.pla.conductivity, bw.material.steel.conductivity}
    local resistance = LENGTH / 2 / SIDE ^ 2 * (1 / k[1] + 1 / k[2])
    check.near(0.1 * resistance, object.value - object.lowest_k, 1e-3)
  end)

  it("show the strength of each on the page", function()
    local _, out = check.run("statics " .. folder .. "bar.msh" .. PULL .. BOTH .. " --report " .. folder
      .. "s.html --picture " .. folder .. "s.png")
    assert.truthy(out:find("Written: ", 1, true), out)
    assert.truthy(check.read(folder .. "s.html"):find("of the strength", 1, true))
  end)

  it("refuse what cannot be, with the list of regions", function()
    local bar, both = folder .. "bar.msh --fix min:x --gravity 0,0,1g --material ", "pla --material grip=steel "
    for words, text in pairs {
      ["statics " .. bar .. "girp=steel --material pla"] = "there is no region 'girp'; the regions are rest, "
        .. "grip",
      ["statics " .. bar .. "grip=steel"] = "region 'rest' has no material: give rest=NAME, or NAME for all "
        .. "others; the regions are rest, grip",
      ["statics " .. bar .. "grip=pla --material " .. both] = "region 'grip' is given twice; the regions are rest",
      ["statics " .. bar .. "pla --material steel"] = "is given twice for all of the part",
      ["statics " .. bar .. "grip=stel"] = "'stel' is not known: did you mean 'steel'?",
      ["statics " .. bar .. "grip="] = "a value expected",
      ["statics " .. bar .. both .. "--young 1GPa"] = "option --young replaces a value of one material",
      ["statics " .. bar .. both .. "--length critical"] = "give a length such as",
      ["statics " .. bar .. both .. "--error 0.1"] = "need not govern a part of several",
      ["modes " .. folder .. "bar.stl --material grip=steel"] = "bar.stl has no regions, which meshes",
      ["worst " .. folder .. "bar.msh --material grip=steel"] = "takes one material for all of a part",
      ["worst " .. folder .. "bar.msh --material " .. both] = "option --material is given twice",
      ["heat " .. folder .. "bar.msh --power min:x=1 --temperature max:x=20C --conductivity 1 --material "
        .. both] = "option --conductivity replaces",
    } do
      local status, _, err = answer(words)
      assert.equal(2, status, words .. ": " .. err)
      assert.truthy(err:find(text, 1, true), words .. ": " .. err)
    end
  end)
end)
