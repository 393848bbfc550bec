-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Harmonic responses in Lua: options, results, curves, files, pictures, animations.
local bw = require "barwright"
local check = require "check"
local respond_page = require "barwright.command.respond_page"
local core = require "barwright.core"
local prism = require "prism"

local folder = check.folder() .. "/"
local L, a, b = 0.2, 0.01, 0.02
local steel = bw.material.isotropic {young = 200e9, poisson = 0.3, density = 7800}

local function beam(force)
  local mesh = bw.mesh.box {max = {L, b, a}, cells = {10, 1, 1}, order = 2}
  local part = bw.model {mesh = mesh, material = steel}
  part:fix(mesh.boundary:below("x", 0))
  if force then part:load {on = mesh.boundary:above("x", L), force = force} end
  return part
end

-- Lowest bending about the thin side.
local bending = 1.8751 ^ 2 / (2 * math.pi) * math.sqrt(200e9 * a ^ 2 / 12 / 7800) / L ^ 2

describe("harmonic", function()
  it("has the peak of a cantilever at its frequency, 1/(2 ratio) times the static displacement", function()
    local part = beam {0, 0, 10}
    local response = assert(part:harmonic {range = {0, 2 * bending}, damping = {ratio = 0.01}})
    local curve = assert(response:curve {at = {L, b / 2, a / 2}})
    local frequency, amplitude = curve:peak "z"
    check.near(bending, frequency, 0.02)
    local static = assert(part:solve())
    local still = static.displacement(curve.node, 3)
    check.near(still, curve.amplitude(1, 3), 1e-6)
    check.near(0.97 * 50 * still, amplitude, 0.01) -- the first mode has 97 % of the static answer
    assert.is_true(math.abs(curve.phase(1, 3)) < 1e-6)
    check.near(-90, curve.phase((curve.amplitude:column(3):argmax()), 3), 0.03)
    assert.is_true(response.errors:max() < 1e-8)
    assert.is_true(response.residual_vectors > 0 and response.solves > response.residual_vectors)
    assert.is_true(response.modes.counted)
    assert.truthy(tostring(response):find("counted: none is missing", 1, true))
    local said = tostring(response)
    assert.truthy(said:find "at most [%d.e-]+ of the displacement, in energy; error of the mesh unknown")
    assert.truthy(tostring(curve):find("displacement of node", 1, true))
    assert.truthy(tostring(curve):find("error of the mesh unknown", 1, true))
    check.raises("1 to 1000000 frequencies expected", response.curve, response, {at = {0, 0, 0}, frequencies = {}})
  end)

  it("is the same by many modes and by few with residual vectors", function()
    local part = beam {5, 3, 10}
    local options = {frequencies = {0.7 * bending}, damping = {mass = 20, stiffness = 1e-5}}
    options.modes, options.residual_vectors = 1, 40
    local few = assert(part:harmonic(options))
    options.modes, options.residual_vectors = 40, 0
    local many = assert(part:harmonic(options))
    local x, y = few:displacement(0.7 * bending)
    local u, v = many:displacement(0.7 * bending)
    local size = bw.array.map("norm(a)", {a = x}):max()
    assert.is_true(bw.array.map("norm(a)", {a = x - u}):max() < 1e-3 * size)
    assert.is_true(bw.array.map("norm(a)", {a = y - v}):max() < 1e-3 * size)
    assert.is_true(few.errors[1] < 1e-8 and many.errors[1] > 1e-6)
    assert.truthy(many.modes.counted or tostring(many):find("equations about", 1, true))
  end)

  it("moves under an accelerated base as under gravity", function()
    local shaken = assert(beam():harmonic {frequencies = {100}, base = {0, 0, 9.81}, damping = {loss = 0.1}})
    local part = beam()
    part:gravity {0, 0, -9.81}
    local heavy = assert(part:harmonic {frequencies = {100}, damping = {loss = 0.1}})
    local x, u = shaken:displacement(100), heavy:displacement(100)
    assert.is_true(bw.array.map("norm(a)", {a = x - u}):max() < 1e-9 * u:norm())
  end)

  it("has Miles's root mean square of a wide random base", function()
    local shaken = assert(beam():harmonic {
      range = {0, 2 * bending}, base = {0, 0, 9.81}, damping = {ratio = 0.01}})
    local random = assert(shaken:random {psd = {{0, 0.01}, {2 * bending, 0.01}}})
    local curve = assert(shaken:curve {at = {L, b / 2, a / 2}})
    -- sqrt(pi/2 f Q S) times the static displacement under 1 g, but for the part beyond the range
    local expected = math.sqrt(math.pi / 2 * shaken.modes.frequencies[1] * 50 * 0.01) * curve.amplitude(1, 3)
    check.near(expected, random.displacement(curve.node, 3), 0.02)
    check.near(shaken:von_mises(0):max() / curve.amplitude(1, 3),
      random.von_mises:max() / random.displacement(curve.node, 3), 0.1)
    assert.is_true(random.error < 1e-8)
    assert.truthy(tostring(random):find("root mean squares", 1, true))
    assert.truthy(tostring(random):find("modes counted: none is missing; error of the equations at most", 1, true))
    assert(random:write(folder .. "random.vtu"))
    assert(random:picture(folder .. "random.png"))
  end)

  it("compares a random vibration with strength and life", function()
    local shaken = assert(beam():harmonic {
      range = {0, 2 * bending}, base = {0, 0, 9.81}, damping = {ratio = 0.01}})
    local random = assert(shaken:random {psd = {{0, 0.01}, {2 * bending, 0.01}}})
    local rms, node = random.von_mises:max(), random.von_mises:argmax()
    local margins = assert(random:margins {duration = 3600, strength = 5 * rms})
    check.near(2 / 3, margins.margin, 1e-9)
    assert.equal(node, margins.margin_node)
    -- one mode: one component of stress, a normal variable, with Rice's rate at the frequency of the mode
    check.near(0.0027, margins.beyond, 0.01)
    check.near(5.733e-7, margins.exceedance[node], 0.02)
    local rate = 2 * shaken.modes.frequencies[1] * math.exp(-12.5)
    check.near(rate, margins.rate[node], 0.02)
    local long = assert(random:margins {duration = 1 / rate, strength = 5 * rms, sigma = 5})
    check.near(1, long.first_passage[node], 0.02)
    check.near(1 - math.exp(-1), long.poisson, 0.02)
    assert.is_true(math.abs(long.margin) < 1e-9)
    assert.truthy(tostring(margins):find("root mean square of von Mises stress is 60 % of the strength", 1, true))
    assert.truthy(tostring(margins):find("exceeds these 3 deviations for 0.27 % of the time", 1, true))
    assert.truthy(tostring(margins):find("does so in 3600 s is at most", 1, true))
    -- where many bounds are 1, the place that exceeds the strength longest stands for them
    local weak = assert(random:margins {duration = 3600, strength = rms / 2})
    assert.is_true(weak.first_passage:sum() > 2 and weak.first_passage[weak.node] == 1)
    assert.equal(weak.exceedance:max(), weak.exceedance[weak.node])
    local strong = tostring(assert(random:margins {duration = 3600, strength = 1e4 * rms}))
    assert.truthy(strong:find("exceeds the strength in 3600 s is below 1e-300 at each", 1, true), strong)
    assert.falsy(strong:find(" 0 ", 1, true), strong)
    assert(margins:write(folder .. "margins.vtu") and margins:picture(folder .. "margins.png"))

    local curve = {amplitude = 2 * rms, cycles = 1e6, exponent = 4}
    local fatigue = assert(random:fatigue {duration = 10, curve = curve})
    -- Rayleigh's peaks: the mean of amplitude^4 is 8 rms^4
    local narrow = shaken.modes.frequencies[1] * 8 / 2 ^ 4 / 1e6
    check.near(10 * narrow, fatigue.by.narrow_band, 0.02)
    check.near(narrow, fatigue.rate[node], 0.1)
    check.near(10 * fatigue.rate[node], fatigue.damage[node], 1e-12)
    check.near(1 / fatigue.rate[node], fatigue.life, 1e-12)
    check.near(rms ^ 2, fatigue.moments(node, 1), 1e-9)
    assert.equal(fatigue.by.dirlik, fatigue.damage[node])
    assert.truthy(tostring(fatigue):find("life curves scatter", 1, true))
    assert(fatigue:write(folder .. "damage.vtu") and fatigue:picture(folder .. "damage.png"))
    local none = assert(random:fatigue {duration = 10, curve = {amplitude = rms, limit = 1e3 * rms}})
    assert.is_true(none.life == math.huge and none.damage:max() == 0)
    assert.truthy(tostring(none):find("No amplitude does damage", 1, true))

    check.misuses {
      ["option 'duration' is missing"] = function() random:margins {} end,
      ["option 'strength': a number above 0"] = function() random:margins {duration = 1, strength = 0} end,
      ["option 'sigma': a number above 0"] = function() random:margins {duration = 1, strength = 1, sigma = 0} end,
      ["no strength that is one number: give"] = function() random:margins {duration = 1} end,
      ["the mean 0"] = function() random:fatigue {duration = 1, curve = {amplitude = 1, strength = 1}} end,
      ["amplitude of the life curve is 0"] = function() random:fatigue {duration = 1, curve = {}} end,
    }
  end)

  it("writes curves, fields, pictures and animations", function()
    local response = assert(beam({0, 0, 10}):harmonic {range = {0, 500}, damping = {ratio = 0.02}})
    local curve = assert(response:curve {at = {L, 0, 0}, frequencies = {0, 100}})
    assert.equal(2, #curve.frequencies)
    assert(curve:write(folder .. "curve.csv"))
    local lines = 0
    for _ in io.lines(folder .. "curve.csv") do lines = lines + 1 end
    assert.equal(3, lines)
    assert(response:curve({at = {L, 0, 0}}):figure():write(folder .. "curve.svg"))
    local real, imaginary = response:stress(100)
    local von_mises = response:von_mises(100)
    assert.equal(6, real.column_count)
    assert.is_true(imaginary:norm() > 0 and von_mises:min() >= 0)
    assert(response:write(folder .. "response.vtu", 100))
    local _, fields = assert(bw.mesh.read(folder .. "response.vtu"))
    assert.truthy(fields)
    assert(response:picture(100, folder .. "shape.png"))
    assert(response:animate(100, folder .. "moving.png", {pictures = 4, width = 200, height = 150}))
  end)

  it("has the loss factors of regions, by their parts of the strain energy", function()
    local mesh = assert(beam().mesh:split({min = {-1, -1, -1}, max = {L / 2, 1, 1}}, "root"))
    local part = bw.model {mesh = mesh, material = steel}:fix(mesh.boundary:below("x", 0))
      :load {on = mesh.boundary:above("x", L), force = {0, 0, 1}}
    local options = {range = {0, 2 * bending}, damping = {loss = {root = 0.1}}}
    local response = assert(part:harmonic(options))
    local loss = response.losses[1]
    assert.is_true(loss > 0.08 and loss < 0.1) -- most of the strain energy of the first mode
    assert.is_true(response.errors:max() < 1e-7)
    options.damping = {loss = loss}
    local alike = assert(part:harmonic(options))
    check.near(alike:envelope().largest.displacement.value, response:envelope().largest.displacement.value, 0.01)
    check.raises("there is no region 'rot': did you mean 'root'?", part.harmonic, part,
      {range = {0, 1}, damping = {loss = {rot = 1}}})
    check.raises("the loss factor of region root is -1", part.harmonic, part,
      {range = {0, 1}, damping = {loss = {root = -1}}})
    check.raises("a number for region 'root' expected, got string 'much'", part.harmonic, part,
      {range = {0, 1}, damping = {loss = {root = "much"}}})
    local plain = beam {0, 0, 1}
    check.raises("the mesh has no regions", part.harmonic, plain, {range = {0, 1}, damping = {loss = {a = 1}}})
    check.raises("no regions", part.harmonic, plain, {range = {0, 1}, damping = {loss = {}}})
    check.raises("loss", part.transient, part, {step = 1e-4, damping = {loss = {root = 1}}})
  end)

  it("has an envelope over the frequencies: that of its fields", function()
    local response = assert(beam({0, 3, 10}):harmonic {range = {0, 2 * bending}, damping = {ratio = 0.02}})
    local envelope = assert(response:envelope())
    local largest = envelope.largest.von_mises
    local field = response:von_mises(largest.frequency)
    check.near(field:max(), largest.value, 1e-12)
    assert.equal(field:argmax(), largest.node)
    assert.equal(#response.frequencies, #envelope.von_mises_peaks)
    assert.equal(envelope.von_mises:max(), envelope.von_mises_peaks:max())
    assert.equal(largest.frequency, envelope.von_mises_frequency[largest.node])
    for i = 1, #response.frequencies, 20 do
      check.near(response:von_mises(response.frequencies[i]):max(), envelope.von_mises_peaks[i], 1e-12)
    end
    local one = assert(response:envelope {frequencies = {100}})
    check.raises("is known to", function() response:envelope {frequencies = {1e6}} end)
    local u, v = response:displacement(100)
    local node = one.displacement_nodes[1]
    local length = math.max(bw.array.map("norm(a)", {a = u})[node], bw.array.map("norm(a)", {a = v})[node])
    assert.is_true(one.largest.displacement.value >= length and one.largest.displacement.frequency == 100)
    assert.truthy(tostring(envelope):find("envelope over %d+ frequencies: largest displacement .* Hz, node %d+"))
    assert(envelope:write(folder .. "envelope.vtu") and envelope:picture(folder .. "envelope.png"))
    assert(envelope:figure():write(folder .. "envelope.svg"))
  end)

  it("says that an undamped response has no limit at a natural frequency", function()
    local part = beam {0, 0, 10}
    local response = assert(part:harmonic {range = {0, 2 * bending}})
    assert.is_false(response.damped)
    assert.truthy(tostring(response):find("without damping: at a natural frequency it has no limit", 1, true))
    local curve = assert(response:curve {at = {L, b / 2, a / 2}})
    assert.truthy(tostring(curve):find("nothing damps the response", 1, true))
    bw.warnings()
    curve:peak "z"
    assert.truthy(bw.warnings()[1]:find("nothing damps the response", 1, true))
    local below = assert(response:curve {at = {L, 0, 0}, frequencies = {0, 0.5 * bending}})
    assert.is_false(below.unlimited)
    local damped = assert(part:harmonic {range = {0, 2 * bending}, damping = {loss = 0.1}})
    assert.is_true(damped.damped)
    assert.is_nil(tostring(damped):find("damping", 1, true))
    assert(damped:curve {at = {L, 0, 0}}):peak "z"
    assert.same({}, bw.warnings())
  end)

  it("refuses a range beyond all modes of the mesh", function()
    local part = beam {0, 0, 1}
    local ok, message = pcall(part.harmonic, part, {range = {0, 1e12}})
    assert.is_false(ok)
    local bound = tonumber(message:match "none above (%S+) Hz")
    local all = assert(part:modes {count = 3 * (part.mesh.node_count - 15)}).frequencies
    assert.is_true(bound >= all:max() and bound < 6 * all:max(), message)
  end)

  it("counts the modes of a range before it computes them", function()
    for _, joined in ipairs {false, true} do
      local part = beam {0, 0, 1}
      if joined then part:attach {on = part.mesh.boundary:above("x", L), mass = 0.1} end
      local all = assert(part:modes {count = 200}).frequencies
      local stages, to = {}, (all[100] + all[101]) / 2 / 1.5
      local before = bw.progress(function(stage) stages[stage] = true end)
      local response = assert(part:harmonic {range = {0, to}})
      bw.progress(before)
      assert.equal(101, #response.modes.frequencies) -- those below 1.5 times the last frequency, and one more
      assert.is_true(response.modes.counted)
      assert.is_true(stages["counting modes"] and stages["101 modes"])
    end
  end)

  it("refuses a range that needs thousands of modes, and says how many", function()
    local mesh = bw.mesh.box {max = {L, b, a}, cells = {40, 3, 3}, order = 2}
    local part = bw.model {mesh = mesh, material = steel}
    part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", L), force = {0, 0, 1}}
    local count
    for _, to in ipairs {4e5, 6e5} do
      local ok, message = pcall(part.harmonic, part, {range = {0, to}})
      assert.is_false(ok)
      assert.truthy(message:find("at most 2000 are computed for a range", 1, true), message)
      local found = tonumber(message:match "which are (%d+),")
      assert.is_true(found > (count or 2000) and found < 3 * mesh.node_count, message)
      count = found
    end
    assert(part:harmonic {range = {0, 4e5}, modes = 4}) -- as many as are wanted
  end)

  it("refuses misuse in a sentence", function()
    local part = beam {0, 0, 1}
    local response = assert(part:harmonic {frequencies = {10}})
    check.misuses {
      ["either 'frequencies'"] = function() part:harmonic {} end,
      ["two frequencies {from, to}"] = function() part:harmonic {range = {1, 2, 3}} end,
      ["from 5 to 1 Hz"] = function() part:harmonic {range = {5, 1}} end,
      ["option 'damping'"] = function() part:harmonic {range = {0, 1}, damping = 0.02} end,
      ["unknown option 'ratios'"] = function() part:harmonic {range = {0, 1}, damping = {ratios = 1}} end,
      ["ratio is -1"] = function() part:harmonic {range = {0, 1}, damping = {ratio = -1}} end,
      ["401 residual vectors"] = function() part:harmonic {range = {0, 1}, residual_vectors = 401} end,
      ["nothing excites"] = function() beam():harmonic {range = {0, 1}} end,
      ["-1 Hz"] = function() response:displacement(-1) end,
      ["envelope: option 'frequencies': 1 to 1000000"] = function() response:envelope {frequencies = {}} end,
      ["unknown option 'frequency'"] = function() response:envelope {frequency = {1}} end,
      ["option 'psd' is missing"] = function() response:random {} end,
      ["2 points or more"] = function() response:random {psd = {{1, 1}}} end,
      ["larger range"] = function() response:random {psd = {{1, 1}, {11, 1}}} end,
      ["option 'at'"] = function() response:curve {at = {1, 2}} end,
      ['"x", "y" or "z" expected'] = function() response:curve({at = {0, 0, 0}}):peak "w" end,
    }
    local free = bw.model {mesh = part.mesh, material = steel}
    free:load {on = part.mesh.boundary:above("x", L), force = {0, 0, 1}}
    local none, message, details = free:harmonic {range = {0, 1}}
    assert.is_nil(none)
    assert.equal("unconstrained", details.status)
    assert.truthy(message:find("Add supports", 1, true))
  end)
end)

describe("barwright respond", function()
  local path = folder .. "beam.msh"
  setup(function()
    assert(bw.mesh.box({max = {L, b, a}, cells = {10, 1, 1}, order = 2}):write(path))
  end)

  local function answer(words)
    local status, out, err = check.run(("respond --json --young 200GPa --poisson 0.3 --density 7800 --fix min:x "
      .. "--strength 500MPa --damping 0.01 --to %d %s %s"):format(math.ceil(2 * bending), words, path))
    return status, status < 2 and bw.json.decode(out) or out, err
  end

  it("has the resonance of a cantilever: frequency, displacement, stress", function()
    local status, object = answer "--force max:x=0,0,1"
    assert.equal(0, status)
    assert.equal("holds", object.verdict)
    check.near(bending, object.frequency_hz, 0.02)
    check.near(object.displacement_frequency_hz, object.frequency_hz, 0.01)
    check.near(object.natural_frequencies_hz[1], object.frequency_hz, 0.01)
    -- 1/(2 ratio) times the deflection F L^3/(3 E I), of which the first mode has 97 %
    local I = b * a ^ 3 / 12
    local expected = 0.97 * 50 * L ^ 3 / (3 * 200e9 * I)
    check.near(expected, object.displacement_m, 0.03) -- a support that holds the width is 1 to 2 % stiffer
    check.near(L, object.displacement_at_m[1], 1e-9)
    -- curvature of the first mode at the support: 2 (1.8751/L)^2 times half of the deflection of the end
    local stress = 200e9 * a / 2 * 1.8751 ^ 2 / L ^ 2 * object.displacement_m
    check.near(stress, object.value, 0.15)
    assert.is_true(object.displacement_estimated_error >= 0.02)
    assert.is_true(object.counted and object.equations_error < 1e-8)
    assert.is_true(object.estimated_error >= 0.5)
  end)

  it("judges by the strength, but not where the error leaves it open", function()
    local _, object = answer "--force max:x=0,0,1"
    local used = object.utilisation
    for fraction, expected in pairs {[0.6] = "holds", [0.9] = "unsure", [100] = "exceeds"} do
      local status
      status, object = answer(("--force max:x=0,0,%.17g"):format(fraction / used))
      assert.equal(expected, object.verdict)
      assert.equal(expected == "holds" and 0 or 1, status)
    end
    assert.is_true(object.singular) -- at the border of the support
  end)

  it("judges a singular stress by its mean over a patch, as statics does", function()
    local angle = prism({{0, 0}, {0.04, 0}, {0.04, 0.01}, {0.01, 0.01}, {0.01, 0.04}, {0, 0.04}},
      {0.005, 0.005}, 0.01)
    local mesh, file = assert(bw.mesh.fill(angle, {elements = 1500, order = 2})), folder .. "angle.msh"
    assert(mesh:write(file))
    local words = "respond --json --material abs --fix above:y:40mm --force above:x:40mm=0,-20,0 --damping 0.02 "
      .. "--unit m --to 1 " .. file
    local _, out, err = check.run(words)
    local object = assert(bw.json.decode(out), err)
    assert.is_true(object.singular)
    local radius = 0.02 * math.sqrt(2 * 0.04 ^ 2 + 0.01 ^ 2)
    local part = bw.model {mesh = mesh, material = bw.material.abs}
    part:fix(mesh.boundary:above("y", 0.04)):load {on = mesh.boundary:above("x", 0.04), force = {0, -20, 0}}
    local static = assert(part:solve())
    local mean = bw.surface_mean(mesh, bw.surface_stress(mesh, part.material, static.displacement, static.force),
      radius, part)
    local tensor = core.von_mises(mean):max()
    check.near(radius, object.averaging_radius_m, 1e-3)
    check.near(tensor, object.mean_pa, 0.005) -- far below the first mode, with 2 % of the critical damping
    check.near(object.mean_pa / bw.material.abs.strength, object.utilisation, 1e-9)
    _, out = check.run((words:gsub("--json ", "")))
    assert.truthy(out:find("no finite value: it is at a re-entrant edge", 1, true), out)
    assert.truthy(out:find("The mean over a surface patch of radius 1.149 mm is judged.", 1, true), out)
    assert.truthy(out:find("The judged stress is ", 1, true), out)
  end)

  it("has the mean's largest von Mises stress over the phases", function()
    local force, mesh = {0, 1, 1}, beam().mesh
    local _, object = answer "--force max:x=0,1,1"
    local part = bw.model {mesh = mesh, material = steel}:fix(mesh.boundary:below("x", L / 50))
    local on = mesh.boundary:above("x", L - L / 50)
    part:load {on = on, force = force}
    local response = assert(part:harmonic {range = {0, math.ceil(2 * bending)}, damping = {ratio = 0.01}})
    local means, most = {}, 0
    local forces = {part:force_vector(), nil}
    for k, u in ipairs {response:displacement(object.frequency_hz)} do
      local stress = bw.surface_stress(mesh, steel, u, forces[k])
      means[k] = bw.surface_mean(mesh, stress, object.averaging_radius_m, part)
    end
    for i = 0, 359 do
      local phase = math.rad(i / 2)
      most = math.max(most, core.von_mises(means[1] * math.cos(phase) - means[2] * math.sin(phase)):max())
    end
    check.near(most, object.mean_pa, 1e-4)
  end)

  it("shakes at random, against strength and life", function()
    local psd = folder .. "psd.csv"
    local function write(text)
      local file = assert(io.open(psd, "w"))
      file:write(text)
      file:close()
    end
    local function run(words)
      return check.run(("respond --young 200GPa --poisson 0.3 --density 7800 --fix min:x --strength 500MPa "
        .. "--damping 0.01 --psd %s %s %s"):format(psd, words, path))
    end
    write(("frequency,density\n0,0.01\n%.17g,0.01\n"):format(2 * bending))
    local status, out = run(("--json --base 0,0,1g --duration 2min --life 160MPa,2e6,5 --vtu %sr.vtu "
      .. "--picture %sr.png --report %sr.html"):format(folder, folder, folder))
    assert.equal(1, status, out) -- singular at the border of the support
    local object = bw.json.decode(out)
    local shaken = assert(beam():harmonic {
      range = {0, 2 * bending}, base = {0, 0, 9.80665}, damping = {ratio = 0.01}})
    local random = assert(shaken:random {psd = {{0, 0.01}, {2 * bending, 0.01}}})
    check.near(3 * random.von_mises:max(), object.value, 1e-9)
    check.near(random.error, object.estimated_error - 0.5, 0.01) -- of the equations, beside that of one mesh
    local margins = assert(random:margins {duration = 120, strength = 500e6})
    check.near(margins.margin, object.margin, 1e-9)
    check.near(margins.beyond, object.beyond_three_deviations, 1e-9)
    assert.equal(120, object.duration_s)
    local fatigue = assert(random:fatigue {duration = 120, curve = {amplitude = 160e6, cycles = 2e6}})
    check.near(fatigue.life, object.life_s, 1e-9)
    check.near(fatigue.by.narrow_band, object.damage_by.narrow_band, 1e-9)
    for _, name in ipairs {"r.vtu", "r.png"} do assert(io.open(folder .. name)):close() end
    local page = check.read(folder .. "r.html")
    for _, text in ipairs {"margin of 3 root mean squares", "Tovo and Benasciutti</td><td>",
      "exceeds the strength", "Counted: none is missing", '"name":"damage"', "<svg"} do
      assert.truthy(page:find(text, 1, true), text)
    end
    status, out = run "--base 0,0,5g --duration 2min"
    assert.equal(1, status)
    for _, text in ipairs {"three times its root mean square", "the margin is", "of the time", "(Poisson)",
      "Fatigue is not judged", "The error of the quadrature is unknown, and that of the mesh in shares and"} do
      assert.truthy(out:find(text, 1, true), out)
    end
    assert.falsy(out:find("and of the mesh unknown", 1, true), out) -- an estimate of it stands above
    for words, expected in pairs {
      ["--base 0,0,1g"] = "option --duration TIME is missing",
      ["--base 0,0,1g --duration 1min --to 5"] = "option --to does not go with --psd",
      ["--base 0,0,1g --duration 1min --life 1,2"] = "option --life: three values",
      ["--base 0,0,1g --duration 1min --life 1MPa,2,0"] = "option --life: a stress and cycles above 0"} do
      local code, _, err = run(words)
      assert.equal(2, code)
      assert.truthy(err:find(expected, 1, true), err)
    end
    for text, expected in pairs {["1 1\n"] = "2 points or more", ["1 1\n2 -1\n"] = "both must be 0 or more",
      ["1 0\n2 0\n"] = "0 everywhere"} do
      write(text)
      local code, _, err = run "--base 0,0,1g --duration 1min"
      assert.equal(3, code)
      assert.truthy(err:find(expected, 1, true), err)
    end
    local code, _, err = check.run("respond --damping 0.1 --fix min:x --base 0,0,1 --to 9 --duration 1 " .. path)
    assert.equal(2, code)
    assert.truthy(err:find("option --duration is for --psd", 1, true), err)
  end)

  it("says how many modes many frequencies need, before the response", function()
    local status, out, err = check.run(("respond %s --material steel --fix min:x --base 0,0,1 --to 200000 "
      .. "--damping 0.02"):format(path))
    assert.is_true(status < 2, err)
    local count = tonumber(out:match "These frequencies need (%d+) modes.*The displacement is largest")
    assert.is_true(count > 16, out)
    assert.truthy(out:find(("by %d modes (counted"):format(count), 1, true), out)
  end)

  it("shakes the supports as gravity would", function()
    local _, shaken = answer "--base 0,0,1g"
    local response = assert(beam():harmonic {range = {0, math.ceil(2 * bending)}, base = {0, 0, 9.80665},
      damping = {ratio = 0.01}})
    local real, imaginary = response:displacement(shaken.displacement_frequency_hz)
    local amplitude = bw.array.map("sqrt(a*a + b*b)", {a = real, b = imaginary}):max()
    check.near(amplitude, shaken.displacement_m, 1e-3)
    check.near(response:von_mises(shaken.frequency_hz):max(), shaken.value, 1e-6)
  end)

  it("compares with a coarser mesh of a surface, and is not certain at an end of the range", function()
    local surface = folder .. "neck.stl" -- the largest stress is in the neck, far from support and load
    local neck = assert(bw.surface.implicit("max(sqrt(y*y + z*z) - 0.006 - 5.6*x*x, abs(x) - 0.05)",
      {min = {-0.052, -0.022, -0.022}, max = {0.052, 0.022, 0.022}, cells = 40}))
    assert(neck:write(surface, {unit = "mm"}))
    local words = ("respond %s --material steel --elements 600 --fix min:x --pressure max:x=1MPa "
      .. "--from 50 --to 100 --damping 0.02 --strength "):format(surface)
    local status, out = check.run(words .. "1kPa")
    assert.equal(1, status)
    assert.truthy(out:find("it exceeds the strength", 1, true), out)
    assert.truthy(out:find("by a coarser mesh", 1, true), out)
    assert.truthy(out:find("The error of the mesh is not in it", 1, true), out)
    assert.truthy(out:find("an end of the range", 1, true), out)
    local page = folder .. "end.html"
    status, out = check.run(words .. "1GPa --report " .. page)
    assert.equal(1, status, out)
    local advice = "give a smaller --from, or --band-limited yes where nothing vibrates outside of the range"
    assert.truthy(out:find("not certain, as it is largest at an end of the range: " .. advice, 1, true), out)
    assert.truthy(check.read(page):find(advice, 1, true))
    status, out = check.run(words .. "1GPa --band-limited yes")
    assert.equal(0, status, out)
    local right = out:find("it stays below the strength", 1, true) and not out:find("end of the range", 1, true)
    assert.truthy(right, out)
  end)

  it("advises what leaves the answer open: the end of the range, the error, or both", function()
    local found = {stress = {value = 1e6, at = {0, 0, 0}, frequency = 100}, displacement = {value = 1e-6}}
    local function advice(used, estimated, at_end)
      local head = respond_page.head(found, {verdict = "unsure", used = used, estimated = estimated,
        at_end = at_end, damping = 0.02, facts = {}})
      local text = table.concat(head.advice, " ")
      return text:find("More --elements", 1, true) ~= nil, text:find("end of the range: larger", 1, true) ~= nil
    end
    assert.same({true, true}, {advice(0.95, 0.1, "larger")})
    assert.same({false, true}, {advice(0.5, 0.1, "larger")})
    assert.same({true, false}, {advice(0.95, 0.1)})
    assert.same({false, true}, {advice(nil, nil, "larger")})
  end)

  it("says the same of the upper end", function()
    local status, out = check.run(("respond %s --material steel --fix min:x --force max:x=0,0,1 --to 5 "
      .. "--damping 0.02"):format(path))
    assert.equal(1, status)
    assert.truthy(out:find("largest at an end of the range: give a larger --to, or", 1, true), out)
  end)

  it("writes a curve, a plot, fields and a picture", function()
    local words = ("--csv @r.csv --plot @r.svg --vtu @r.vtu --picture @r.png --report @r.html"):gsub("@", folder)
    local status, out = check.run(("respond %s --material steel --fix min:x --force max:x=0,0,1 --to 500 "
      .. "--damping 0.02 %s"):format(path, words))
    assert.equal(0, status, out)
    assert.is_nil(out:find("These frequencies need", 1, true))
    for _, name in ipairs {"r.csv", "r.svg", "r.vtu", "r.png"} do
      assert.truthy(out:find(name, 1, true), out)
      assert(io.open(folder .. name)):close()
    end
    -- the page has the command's sentences, both plots, the modes, and the deflection that is largest first
    local page = check.read(folder .. "r.html")
    for _, sentence in ipairs {"The displacement is largest", "The von Mises stress is largest", "Error of the"} do
      local line = out:match(sentence .. "[^\n]*")
      assert.truthy(page:find(line, 1, true), line)
    end
    local _, drawn = page:gsub("</figcaption>%s*<svg", "")
    assert.equal(2, drawn)
    local modes = tonumber(out:match "by (%d+) modes")
    local _, rows = page:gsub("about [%d.]+ %% too high", "")
    assert.equal(modes, rows)
    local data = bw.json.decode((page:match '<script type="application/json" id="data">(.-)</script>'))
    assert.equal("harmonic", data.displacements[1].kind)
    assert.equal(#data.displacements[1].values, #data.displacements[1].imaginary)
    assert.truthy(data.displacements[#data.displacements].name:find("mode " .. modes, 1, true))
  end)

  local floor = folder .. "floor.csv"
  local points = {{10, 5}, {100, 20}, {8000, 3}}
  local function write(name, text)
    local file = assert(io.open(name, "w"))
    file:write(text)
    file:close()
  end

  local function shake(words)
    write(floor, "frequency,acceleration # Hz, m/s2\n10,5\n100,20\n8000,3\n")
    local status, out, err = check.run(("respond --json --young 200GPa --poisson 0.3 --density 7800 --fix min:x "
      .. "--damping 0.05 --spectrum %s %s %s"):format(floor, words, path))
    return status, status < 2 and bw.json.decode(out) or out, err
  end

  it("has the largest response to a spectrum, along one direction and along three at once", function()
    local part, r = beam(), {}
    for k, direction in ipairs {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}} do
      r[k] = assert(part:response_spectrum {points = points, direction = direction, damping = 0.05})
    end
    local status, one = shake "--direction 0,0,2 --strength 500MPa"
    assert.equal(1, status)
    assert.is_true(one.singular and one.utilisation < 0.5)
    assert.equal("unsure", one.verdict)
    check.near(r[3].von_mises:max(), one.value, 1e-9)
    check.near(r[3].displacement:max(), one.displacement_m, 1e-9)
    check.near(L, one.displacement_at_m[1], 1e-9)
    check.near(r[3].base_force[3], one.base_force_n[3], 1e-9)
    check.near(r[3].effective_masses[1], one.spectra[1].effective_masses_kg[1], 1e-9)
    check.near(r[3].missing_mass, one.spectra[1].missing_mass_kg, 1e-9)
    assert.equal(#r[3].accelerations, #one.natural_frequencies_hz)
    for _, rule in ipairs {"srss", "100-40-40"} do
      local all = r[1]:combine({r[2], r[3]}, {rule = rule})
      local words = "--direction 1,0,0 --direction 0,1,0 --direction 0,0,1 --strength 1kPa --rule " .. rule
      local other
      status, other = shake(words)
      assert.equal(1, status)
      assert.equal(rule, other.rule)
      assert.equal(3, #other.spectra)
      check.near(all.von_mises:max(), other.value, 1e-9)
      check.near(all.base_force[3], other.base_force_n[3], 1e-9)
      assert.equal("unsure", other.verdict) -- singular at the border of the support
    end
  end)

  it("says what a spectrum's response is made of and what it lacks, and writes files", function()
    write(floor, "10 5\n100 20\n4000 3\n")
    local status, out = check.run(("respond %s --material steel --fix min:x --damping 0.05 --spectrum %s "
      .. "--direction 0,1,0 --direction 0,0,1 --vtu %ss.vtu --picture %ss.png --report %ss.html"):format(path,
      floor, folder, folder, folder))
    assert.equal(1, status, out)
    for _, text in ipairs {"not certain, as the stress may grow without end with finer elements",
      "Response spectrum along (0, 1, 0)", "none is missing", "has the base's 3 m/s2",
      "effective mass 6", "square root of the sum of squares (SRSS)", "The largest von Mises stress is",
      "estimated error of the mesh 50 %, assumed", "The largest force on the supports is",
      "its error by the mesh is unknown",
      "modes and of directions is an estimate, whose error is unknown"} do
      assert.truthy(out:find(text, 1, true), out)
    end
    for _, name in ipairs {"s.vtu", "s.png"} do assert(io.open(folder .. name)):close() end
    local page = check.read(folder .. "s.html")
    for _, text in ipairs {"effective mass along (0, 1, 0)", "largest von Mises stress along (0, 0, 1)", "<svg",
      "beyond the spectrum", out:match "The largest force on the supports[^\n]*"} do
      assert.truthy(page:find(text, 1, true), text)
    end
  end)

  it("refuses spectra that cannot be", function()
    write(floor, "10 5\n100 20\n4000 3\n")
    write(folder .. "one.csv", "10 5\n")
    write(folder .. "back.csv", "10 5\n5 5\n")
    write(folder .. "none.csv", "10 5\n20 0\n")
    local begin = "--damping 0.05 --fix min:x --spectrum "
    for words, expected in pairs {
      [begin .. floor] = "option --direction: one to three directions expected, got 0",
      [begin .. floor .. " --direction 0,0,0"] = "'0,0,0' has no length",
      [begin .. floor .. " --direction 1,0,0 --direction 1,1,0"] = "'1,1,0' is not at right angles to '1,0,0'",
      [begin .. floor .. " --direction 1,0,0 --rule srss"] = "--rule combines directions",
      [begin .. floor .. " --direction 1,0,0 --to 100"] = "option --to is for a vibration",
      [begin .. floor .. " --direction 1,0,0 --base 0,0,1g"] = "option --base is for a vibration",
      ["--damping 0.05 --spectrum x.csv --direction 1,0,0"] = "--fix PLACE is missing",
      ["--damping 0.05 --fix min:x --base 0,0,1 --to 10 --rule srss"] = "option --rule is for --spectrum"} do
      local status, _, err = check.run(("respond %s %s"):format(words, path))
      assert.equal(2, status)
      assert.truthy(err:find(expected, 1, true), err)
    end
    write(folder .. "binary.csv", ("solid\0\0\4\0\200\63"):rep(10))
    for name, expected in pairs {
      ["one.csv"] = "one.csv: a response spectrum has 2 points or more",
      ["back.csv"] = "back.csv: line 2: the frequency 5 does not follow the frequency 10",
      ["none.csv"] = "none.csv: 0 m/s2 at 20 Hz: both must be above 0",
      ["binary.csv"] = "binary.csv: no text file: rows of a frequency and a value expected",
      ["missing.csv"] = "missing.csv"} do
      local status, _, err = check.run(("respond %s%s%s --direction 1,0,0 %s"):format(begin, folder, name, path))
      assert.equal(3, status)
      assert.truthy(err:find(expected, 1, true), err)
    end
  end)

  it("refuses what cannot be", function()
    for words, expected in pairs {
      ["--to 100 --damping 0.1 --fix min:x"] = "--force, --pressure or --base is missing",
      ["--to 100 --damping 0.1 --base 0,0,1g"] = "--fix PLACE is missing",
      ["--to 100 --fix min:x --base 0,0,1g"] = "--damping RATIO is missing",
      ["--damping 0.1 --fix min:x --base 0,0,1g"] = "--to FREQUENCY is missing",
      ["--to 100 --from 100 --damping 0.1 --fix min:x --base 0,0,1g"] = "below the 100 Hz of --to",
      ["--to 100 --damping 0.1 --fix min:x --base 1g"] = "option --base: three numbers",
      ["--to 100 --damping 0.1 --fix min:x --base 0,0,1N"] = "option --base: a number with one of the units"} do
      local status, _, err = check.run(("respond %s %s"):format(words, path))
      assert.equal(2, status)
      assert.truthy(err:find(expected, 1, true), err)
    end
  end)
end)
