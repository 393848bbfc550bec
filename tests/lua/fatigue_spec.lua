-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Fatigue in Lua: rainflow counting, damage by histories, files, misuse.
local bw = require "barwright"
local check = require "check"

local folder = check.folder() .. "/"
local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {4, 1, 1}, order = 2}

local function pulled(force)
  local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 200e9, poisson = 0}}
  part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", 0.1), force = force}
  return assert(part:solve())
end

describe("fatigue", function()
  it("counts ASTM's example", function()
    local count = {}
    for _, cycle in ipairs(bw.rainflow({-2, 1, -3, 5, -1, 3, -4, 4, -2}):totable()) do
      count[cycle[1]] = (count[cycle[1]] or 0) + cycle[3]
    end
    assert.same({[3] = 0.5, [4] = 1.5, [6] = 0.5, [8] = 1, [9] = 0.5}, count)
    assert.equal(0, #bw.rainflow {})
  end)

  it("gives a bar under tension the damage of its curve", function()
    local static = pulled {10000, 0, 0} -- 100 MPa
    local curve = {amplitude = 200e6, cycles = 1e6, exponent = 5}
    local fatigue = bw.fatigue {loads = {{static = static, history = {1, -1, 1}}}, curve = curve}
    check.near(32e6, fatigue.passes, 1e-6)
    check.near(1 / 32e6, fatigue.damage:min(), 1e-6)
    assert.truthy(tostring(fatigue):find("passes of the history", 1, true))
    local halves = bw.fatigue {loads = {{static = static, history = {0.25, -0.25, 0.25}},
      {static = static, history = bw.array.new {0.75, -0.75, 0.75}}}, curve = curve}
    check.near(32e6, halves.passes, 1e-6)
    local none = bw.fatigue {loads = {{static = static, history = {1, 1}}}, curve = curve}
    assert.equal(math.huge, none.passes)
    local broken = bw.fatigue {loads = {{static = static, history = {1, 2, 1}}},
      curve = {amplitude = 2e8, strength = 1e8}}
    assert.truthy(tostring(broken):find("the mean stress reaches the strength at node", 1, true))
    assert.truthy(tostring(broken):find("error of the stress unknown", 1, true))
    assert(fatigue:write(folder .. "damage.vtu"))
    assert(fatigue:picture(folder .. "damage.png"))
  end)

  -- By linearity two loads of one history do the damage of their sum, also where stiff and soft material meet:
  -- along the interface the stiff one is stressed more, across it the soft one.
  it("sums the stresses of each material by themselves", function()
    local box = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {2, 2, 2}, order = 2}
    local parts = assert(box:split({min = {0, 0, 0}, max = {0.02, 0.01, 0.02}}, "stiff"))
    local stiff = bw.material.isotropic {young = 200e9, poisson = 0.45}
    local soft = bw.material.isotropic {young = 100e9, poisson = 0, density = 1000}
    local materials = {}
    for _, region in ipairs(parts.regions) do
      materials[region.name] = region.name == "stiff" and stiff or soft
    end
    local function of(along, across)
      local part = bw.model {mesh = parts, materials = materials}
      part:fix(parts.boundary:below("x", 0)):fix(parts.boundary:below("y", 0))
      if along then part:load {on = parts.boundary:above("x", 0.02), force = {20000, 0, 0}} end
      if across then part:load {on = parts.boundary:above("y", 0.02), force = {0, 30000, 0}} end
      return assert(part:solve())
    end
    local curve, history = {amplitude = 200e6}, {1, -1, 0.4, 1}
    local sum = assert(bw.fatigue {loads = {{static = of(true, true), history = history}}, curve = curve})
    local two = assert(bw.fatigue {loads = {{static = of(true), history = history},
      {static = of(false, true), history = history}}, curve = curve})
    local plain = bw.model {mesh = parts, material = soft}:fix(parts.boundary:below("y", 0)):gravity {0, 0, -9.81}
    check.raises("load case 2 has other regions of one material", bw.fatigue, {loads = {
      {static = of(true), history = history}, {static = plain:solve(), history = history}}, curve = curve})
    local quotient = bw.array.map("abs(a - b) / b", {a = two.damage, b = sum.damage})
    assert.is_true(quotient:max() < 1e-6)
  end)

  it("takes histories of CSV files, and says where one has a gap", function()
    local static = pulled {1, 0, 0}
    local function of(history)
      return bw.fatigue {loads = {{static = static, history = history}}, curve = {amplitude = 1}}
    end
    local path = folder .. "history.csv"
    check.write(path, "time,load\n0,0\n0.1,1\n0.3,-0.5\n0.4,1\n")
    assert.equal(of({0, 1, -0.5, 1}).passes, of(path).passes)
    check.write(path, "time,load\n0,0\n0.1,\n0.3,-0.5\n")
    check.fails("format", "line 3: a value is missing", of(path))
    check.fails("io", "No such file", of(folder .. "none.csv"))
    local other = folder .. "other.csv"
    local function both() -- of two loads with a file each
      return bw.fatigue {curve = {amplitude = 1}, loads = {{static = static, history = path},
        {static = static, history = other}}}
    end
    check.write(path, "0,0\n1,1\n2,0\n")
    for text, rows in pairs {["row 2: the time 1 expected, as in the first file, got 1.5"] = "0,0\n1.5,1\n2,0\n",
      ["3 rows expected, as many numbers as load 1 has, got 2"] = "0,0\n1,1\n",
      ["2 rows or more expected, got 1"] = "0,0\n"} do
      check.write(other, rows)
      check.fails("format", text, both())
    end
    check.raises("load 1: entry 2 of the history: a finite number expected, got inf", of, {0, math.huge, 1})
  end)

  it("refuses misuse in a sentence", function()
    local static = pulled {1, 0, 0}
    local function of(loads, curve) return function() bw.fatigue {loads = loads, curve = curve} end end
    local load = {static = static, history = {0, 1}}
    check.misuses {
      ["option 'loads' is missing"] = function() bw.fatigue {curve = {amplitude = 1}} end,
      ["1 to 1000 loads"] = of({}, {amplitude = 1}),
      ["amplitude of the life curve is 0"] = of({load}, {}),
      ["exponent of the life curve"] = of({load}, {amplitude = 1, exponent = 0}),
      ["a list of 2 numbers or more"] = of({{static = static, history = {1}}}, {amplitude = 1}),
      ["a history of 2 numbers expected"] = of({load, {static = static, history = {1, 2, 3}}}, {amplitude = 1}),
      ["unknown option 'slope'"] = of({load}, {slope = 1}),
      ["value 1 of the history"] = function() bw.rainflow {1 / 0} end,
    }
  end)
end)
