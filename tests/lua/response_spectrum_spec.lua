-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Response spectra in Lua: against a motion in time, what print says, files, misuse.
local bw = require "barwright"
local check = require "check"

local folder = check.folder() .. "/"
local L, a, b = 0.2, 0.01, 0.02
local steel = bw.material.isotropic {young = 200e9, poisson = 0.3, density = 7800}

local function beam()
  local mesh = bw.mesh.box {max = {L, b, a}, cells = {10, 1, 1}, order = 2}
  return bw.model({mesh = mesh, material = steel}):fix(mesh.boundary:below("x", 0))
end

-- Half a sine of 100 m/s2 that takes 4 ms.
local function pulse(t) return t < 4e-3 and 100 * math.sin(math.pi * t / 4e-3) or 0 end

-- The largest absolute acceleration of an oscillator on a base that moves so, by small steps.
local function oscillator(frequency, ratio)
  local w, x, v, largest = 2 * math.pi * frequency, 0, 0, 0
  local h = math.min(1e-5, 0.01 / frequency)
  local function force(t, u, s) return -pulse(t) - w * w * u - 2 * ratio * w * s end
  for i = 0, math.ceil((8e-3 + 1 / frequency) / h) do -- Runge and Kutta
    local t = i * h
    local v1, a1 = v, force(t, x, v)
    local v2, a2 = v + h / 2 * a1, force(t + h / 2, x + h / 2 * v1, v + h / 2 * a1)
    local v3, a3 = v + h / 2 * a2, force(t + h / 2, x + h / 2 * v2, v + h / 2 * a2)
    local v4, a4 = v + h * a3, force(t + h, x + h * v3, v + h * a3)
    x, v = x + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    largest = math.max(largest, w * w * math.abs(x))
  end
  return largest
end

describe("response_spectrum", function()
  it("has the largest displacement and stress of a motion in time under the same pulse", function()
    local part, points = beam(), {}
    for k = 0, 30 do points[k + 1] = {20 * 10 ^ (k / 10), oscillator(20 * 10 ^ (k / 10), 0.05)} end
    local spectrum = assert(part:response_spectrum {points = points, direction = {0, 0, 1}})
    local falling = beam():gravity {0, 0, -1}
    local motion = assert(falling:transient {step = 5e-5, damping = {ratio = 0.05}, loads = {pulse},
      modes = assert(falling:modes {count = 12})})
    local run = assert(motion:run {time = 15e-3, probes = {tip = {L, b / 2, a}}, stress_every = 4})
    local tip, largest = run.probes.tip, 0
    for i = 1, #run.time do largest = math.max(largest, math.abs(tip.displacement(i, 3))) end
    check.near(largest, spectrum.displacement(tip.node, 3), 0.02)
    check.near(run.stress.peak.von_mises, spectrum.von_mises:max(), 0.1)
    local masses = spectrum.effective_masses
    check.near(0.613, masses:max() / spectrum.mass, 0.02)
    check.near(spectrum.mass, masses:sum() + spectrum.missing_mass, 1e-12)
    assert.is_true(spectrum.base_force[3] > spectrum.base_force[1] and spectrum.base_force[3] > 0)
  end)

  it("says what it is made of, and writes files and pictures", function()
    local part = beam()
    local points = {{10, 5}, {100, 20}, {4000, 3}}
    local spectrum = assert(part:response_spectrum {points = points, direction = {0, 0, 2}, combination = "srss"})
    local said = tostring(spectrum)
    for _, text in ipairs {"along (0, 0, 1)", "square root of the sum of squares (SRSS)", "none is missing",
      "effective mass 6", "has the base's 3 m/s2", "errors of the combination and of the mesh unknown"} do
      assert.truthy(said:find(text, 1, true), said)
    end
    assert.equal("srss", spectrum.combination)
    assert.equal(#spectrum.accelerations, #spectrum.participation)
    assert(spectrum:write(folder .. "spectrum.vtu") and spectrum:picture(folder .. "spectrum.png"))
    local flexible = assert(part:response_spectrum {points = points, direction = {0, 0, 1}, missing_mass = false,
      combination = "absolute", damping = 0.02})
    assert.truthy(tostring(flexible):find("without the mass that they leave out", 1, true))
    assert.equal(0, flexible.base_acceleration)
  end)

  it("combines directions by SRSS and by 100-40-40", function()
    local part, points = beam(), {{10, 5}, {100, 20}, {4000, 3}}
    local r, axes = {}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}
    for k, d in ipairs(axes) do r[k] = assert(part:response_spectrum {points = points, direction = d}) end
    local srss, most = r[3]:combine {r[1], r[2]}, r[3]:combine({r[1], r[2]}, {rule = "100-40-40"})
    for node = 1, part.mesh.node_count, 7 do
      local sum, s = 0, {}
      for k = 1, 3 do s[k] = r[k].von_mises[node] sum = sum + s[k] ^ 2 end
      check.near(math.sqrt(sum), srss.von_mises[node], 1e-12)
      table.sort(s)
      check.near(s[3] + 0.4 * (s[1] + s[2]), most.von_mises[node], 1e-12)
      local x, y, z = r[1].displacement(node, 3), r[2].displacement(node, 3), r[3].displacement(node, 3)
      check.near(math.sqrt(x * x + y * y + z * z), srss.displacement(node, 3), 1e-12)
    end
    for j = 1, 3 do
      local f = {r[1].base_force[j], r[2].base_force[j], r[3].base_force[j]}
      check.near(math.sqrt(f[1] ^ 2 + f[2] ^ 2 + f[3] ^ 2), srss.base_force[j], 1e-12)
    end
    local given = assert(part:response_spectrum {points = points, direction = axes[2], modes = r[1].modes})
    check.near(r[2].von_mises:max(), given.von_mises:max(), 1e-9)
    assert.equal(r[1].modes, given.modes)
    -- SRSS does not depend on the axes, for one spectrum along all
    local turned = {}
    for k, d in ipairs {{1, 0, 0}, {0, 0.6, 0.8}, {0, -0.8, 0.6}} do
      turned[k] = assert(part:response_spectrum {points = points, direction = d})
    end
    local again = turned[1]:combine {turned[2], turned[3]}
    check.near(srss.von_mises:max(), again.von_mises:max(), 1e-9)
    check.near(srss.base_force[3], again.base_force[3], 1e-9)
    local two = r[1]:combine({r[3]}, {rule = "100-40-40"})
    check.near(math.max(r[1].von_mises[1] + 0.4 * r[3].von_mises[1], 0.4 * r[1].von_mises[1] + r[3].von_mises[1]),
      two.von_mises[1], 1e-12)
    assert.truthy(tostring(most):find("100 % of one and 40 % of each other", 1, true))
    assert.truthy(tostring(srss):find("errors of the combination and of the mesh unknown", 1, true))
    assert(srss:write(folder .. "combined.vtu") and most:picture(folder .. "combined.png"))
    check.raises("not along directions at right angles", r[1].combine, r[1], {r[2], turned[2]})
    check.raises("1 or 2 other responses expected, got 3", r[1].combine, r[1], {r[2], r[3], r[1]})
    check.raises("1 or 2 other responses expected, got 0", r[1].combine, r[1], {})
    check.raises("a response spectrum expected at 1, got", r[1].combine, r[1], {3})
    check.raises("option 'rule'", r[1].combine, r[1], {r[2]}, {rule = "sum"})
    local other = assert(beam():response_spectrum {points = points, direction = {0, 1, 0}})
    check.raises("response 2 is of another model", r[1].combine, r[1], {other})
    local twin = bw.model({mesh = part.mesh, material = steel}):fix(part.mesh.boundary:above("x", L))
    local mirrored = assert(twin:response_spectrum {points = points, direction = {0, 1, 0}})
    check.raises("response 2 is of another model", r[1].combine, r[1], {mirrored})
    -- a load changes nothing of the modes that they share
    part:load {on = part.mesh.boundary:above("x", L), force = {0, 0, 1}}
    local later = assert(part:response_spectrum {points = points, direction = axes[2], modes = r[1].modes})
    check.near(r[1]:combine({r[2]}).von_mises:max(), r[1]:combine({later}).von_mises:max(), 1e-9)
    local own = assert(part:response_spectrum {points = points, direction = axes[2]})
    check.raises("give one of them the modes of the other", r[1].combine, r[1], {own})
    part:clear_loads()
    bw.warnings()
    -- remote points
    part:couple {on = part.mesh.boundary:below("z", 0), at = {0.1, 0.01, -0.05}, mass = 0.1}
    local coupled = {}
    for k, d in ipairs(axes) do coupled[k] = assert(part:response_spectrum {points = points, direction = d}) end
    local point = coupled[3]:combine({coupled[1], coupled[2]}).couplings[1]
    for _, name in ipairs {"displacement", "rotation"} do
      for j = 1, 3 do
        local sum = 0
        for k = 1, 3 do sum = sum + coupled[k].couplings[1][name][j] ^ 2 end
        assert.is_true(sum > 0)
        check.near(math.sqrt(sum), point[name][j], 1e-12)
      end
    end
    check.raises("the model changed in between", r[1].combine, r[1], {coupled[2]})
  end)

  it("warns that loads of the part are not in it", function()
    local points = {{10, 5}, {4000, 3}}
    local bare = assert(beam():response_spectrum {points = points, direction = {0, 0, 1}})
    assert.same({}, bw.warnings())
    local loaded = assert(beam():gravity({0, 0, -9.81}):response_spectrum {points = points, direction = {0, 0, 1}})
    assert.truthy(bw.warnings()[1]:find("the loads of the part, 1 of them, are not in a response spectrum",
      1, true))
    check.near(bare.von_mises:max(), loaded.von_mises:max(), 1e-9)
  end)

  it("refuses misuse in a sentence", function()
    local part, points = beam(), {{1, 1}, {2000, 1}}
    for text, given in pairs {
      ["option 'points' is missing"] = {direction = {1, 0, 0}},
      ["no length"] = {points = points},
      ["option 'points'"] = {points = {1, 2}, direction = {1, 0, 0}},
      ["must ascend"] = {points = {{2, 1}, {1, 1}}, direction = {1, 0, 0}},
      ["below the first point"] = {points = {{1900, 1}, {2000, 1}}, direction = {1, 0, 0}},
      ["option 'combination'"] = {points = points, direction = {1, 0, 0}, combination = "sum"},
      ["unknown option 'ratio'"] = {points = points, direction = {1, 0, 0}, ratio = 0.05},
      ["damping ratio of the response spectrum is 1"] = {points = points, direction = {1, 0, 0}, damping = 1}} do
      check.raises(text, part.response_spectrum, part, given)
    end
    local other = bw.model({mesh = part.mesh, material = steel}):fix(part.mesh.boundary:above("x", L))
    for text, given in pairs {["not elastic modes of this model"] = {modes = assert(other:modes {count = 30})},
      ["the modes end at"] = {modes = assert(part:modes {count = 1})},
      ["modes or a solver"] = {modes = assert(part:modes {count = 1}), solver = bw.eigensolver.lanczos {}},
      ["option 'modes'"] = {modes = 3}} do
      given.points, given.direction = points, {1, 0, 0}
      check.raises(text, part.response_spectrum, part, given)
    end
    local free = bw.model {mesh = part.mesh, material = steel}
    check.fails("unconstrained", "a response spectrum of a body that can move freely",
      free:response_spectrum {points = points, direction = {1, 0, 0}})
    part:temperature(10, 1e-5)
    check.fails("unsupported", "a temperature, which a response spectrum does not know",
      part:response_spectrum {points = points, direction = {1, 0, 0}})
  end)
end)
