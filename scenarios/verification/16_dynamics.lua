-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Responses to loads that change in time with published answers, for solids of tet10.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Dynamics",
  text = [[Responses to loads that change in time beside published answers ([theory](theory/dynamics.md)). The
targets of NAFEMS are those of a thick beam in closed form; here the beam is a solid.]]}

-- NAFEMS Selected Benchmarks for Forced Vibration (1993), test 5: a deep beam of 10 x 2 x 2 m, simply supported.
-- Its half, and a width that has no influence.
local function deep_beam(cells)
  local mesh = bw.mesh.box {max = {5, 2, 2}, cells = cells, order = 2}
  local steel = bw.material.isotropic {young = 200e9, poisson = 0.3, density = 8000}
  local part = bw.model {mesh = mesh, material = steel}
  part:slide(mesh.boundary:below("x", 0), {0, 0, 1}):slide(mesh.boundary:above("x", 5), {1, 0, 0})
  part:slide(mesh.boundary:below("y", 0), {0, 1, 0})
  return part
end

scenario("NAFEMS 5H: harmonic response of a deep beam", function(t)
  local part = deep_beam {15, 5, 5}
  part:gravity {0, 0, 1e6 / (4 * 8000)} -- 1e6 N/m
  local response = t:require(part:harmonic {range = {0, 60}, damping = {mass = 5.36, stiffness = 7.46e-5}})
  local frequency, amplitude = response:curve({at = {5, 1, 1}}):peak "z"
  local edge = response:curve({at = {5, 1, 2}}).node
  local real, imaginary = response:stress(frequency)
  local source = "NAFEMS, Selected Benchmarks for Forced Vibration, test 5H"
  expect(frequency, "frequency of the peak", "Hz"):near(42.65, {relative = 0.01, source = source})
  expect(amplitude, "displacement", "m"):near(13.45e-3, {relative = 0.02, source = source})
  expect(math.sqrt(real(edge, 1) ^ 2 + imaginary(edge, 1) ^ 2), "stress at the edge", "Pa")
    :near(241.9e6, {relative = 0.02, source = source})
  -- 5R: a random load of (1e6 N/m)^2/Hz. The peak of the published density has the half width of its damping.
  local peak = "NAFEMS, Selected Benchmarks for Forced Vibration, test 5R"
  expect(amplitude ^ 2, "spectral density of the displacement at the peak (5R), m2/Hz"):near(180.9e-6,
    {relative = 0.02, source = peak})
  local ratio = (5.36 / (2 * math.pi * 42.65) + 7.46e-5 * 2 * math.pi * 42.65) / 2
  local random = t:require(response:random {psd = {{0, 1}, {60, 1}}})
  local node = response:curve({at = {5, 1, 1}}).node
  expect(random.displacement(node, 3), "root mean square of the displacement (5R)", "m"):near(
    math.sqrt(math.pi * 42.65 * ratio * 180.9e-6), {relative = 0.03,
    source = peak .. ": pi f zeta times the density 180.9 mm2/Hz at the peak, f = 42.65 Hz"})
  expect(response.errors:max(), "bound of the error"):below(1e-8)
end)

scenario("NAFEMS 5T: a deep beam under a load applied at once", function(t)
  local part = deep_beam {15, 5, 5}
  part:gravity {0, 0, 1e6 / (4 * 8000)} -- 1e6 N/m
  local transient = t:require(part:transient {step = 2e-4, rho = 1, damping = {mass = 5.36, stiffness = 7.46e-5}})
  local recording = t:require(transient:run {time = 0.014, probes = {middle = {5, 1, 1}}, stress_every = 1})
  local deflection = recording.probes.middle.displacement:column(3)
  local edge = part.mesh.boundary:nearest({5, 1, 2}).nodes[1]
  local source = "NAFEMS, Selected Benchmarks for Forced Vibration, test 5T"
  expect(deflection:max(), "displacement", "m"):near(1.043e-3, {relative = 0.02, source = source})
  expect(recording.time[deflection:argmax()], "time of the peak", "s")
    :near(0.0117, {relative = 0.02, source = source})
  local static = recording.stress.peak.static.stress[edge]
  expect(math.abs(static[1]), "stress at the edge", "Pa"):near(18.76e6, {relative = 0.02, source = source})
  expect(recording.period_error, "error of the periods, relative"):below(1e-3)
end)

-- The zero of a function whose sign changes between a and b.
local function bisect(f, a, b)
  local positive = f(a) > 0
  for _ = 1, 100 do
    local middle = (a + b) / 2
    if (f(middle) > 0) == positive then a = middle else b = middle end
  end
  return (a + b) / 2
end

-- Natural frequencies of a clamped sandwich beam by the sixth-order theory of Mead and Markus: equal faces bend
-- and stretch, and the core shears. With the deflection w and the axial displacement u of one face, -u of the
-- other,
--   u'' = g (u - d w'/2),   B w'''' - (shear d (d w' - 2 u) / core)' = mass omega^2 w.
-- w is a sum over the roots r of the characteristic cubic, of cosh and sinh of r^0.5 x.
local function sandwich_frequencies(beam, count)
  local L, h, c, d = beam.length, beam.face, beam.core, beam.face + beam.core
  local B, g = beam.young * h ^ 3 / 6, 2 * beam.shear / (c * beam.young * h)
  local stiff = g * (1 + 3 * (d / h) ^ 2)
  local function free_end(frequency) -- vanishes where moment, tension of the faces and shear force can
    local q = beam.mass * (2 * math.pi * frequency) ^ 2 / B
    local function cubic(r) return r ^ 2 * (r - stiff) - q * (r - g) end
    local far = 1 + stiff + q
    local at, rows = {}, {{}, {}, {}}
    for i, r in ipairs {bisect(cubic, -far, 0), bisect(cubic, 0, g), bisect(cubic, g, far)} do
      local s, k = math.sqrt(math.abs(r)), -g * d / (2 * (r - g)) -- u = k w'
      local plus, minus = math.exp(s * L), math.exp(-s * L)
      local C, S = (plus + minus) / 2, (plus - minus) / (2 * s)
      if r < 0 then C, S = math.cos(s * L), math.sin(s * L) / s end
      at[i] = {k = k, even = {r * C, k * r * C, B * r ^ 2 * S - beam.shear * d * (d - 2 * k) / c * r * S},
        odd = {r * S, k * r * S, B * r * C - beam.shear * d * (d - 2 * k) / c * C}}
    end
    -- w = w' = u = 0 at the clamp leave two sums of even terms and one of odd ones
    local x, y, z = at[1], at[2], at[3]
    for i = 1, 3 do
      rows[i] = {x.even[i] - y.even[i], y.even[i] - z.even[i],
        (z.k - y.k) * x.odd[i] + (x.k - z.k) * y.odd[i] + (y.k - x.k) * z.odd[i]}
    end
    local m, n, o = rows[1], rows[2], rows[3]
    return m[1] * (n[2] * o[3] - n[3] * o[2]) - m[2] * (n[1] * o[3] - n[3] * o[1])
      + m[3] * (n[1] * o[2] - n[2] * o[1])
  end
  local found, last = {}, 1
  while #found < count do -- modes are further apart than 10 Hz
    if free_end(last) * free_end(last + 10) < 0 then found[#found + 1] = bisect(free_end, last, last + 10) end
    last = last + 10
  end
  return found
end

-- Faces that do not contract across, as in the theory of beams, and a thin viscoelastic core between them.
scenario("Loss factors of a sandwich beam with a viscoelastic core", function(t)
  local length, face, core = 0.1778, 1.524e-3, 0.127e-3
  local young, shear = 69e9, 2.098e6 / (2 * 1.49)
  local level = {[0] = 0, face, face + core, 2 * face + core}
  local box = bw.mesh.box {max = {length, 0.0127, 3}, cells = {40, 2, 3}}
  local nodes, elements, tags = box.nodes:totable(), box.elements:totable(), {}
  for i, element in ipairs(elements) do
    local z = 0
    for a = 1, 4 do z = z + nodes[element[a]][3] / 4 end
    tags[i] = z > 1 and z < 2 and 2 or 1
  end
  for _, node in ipairs(nodes) do node[3] = level[math.floor(node[3] + 0.5)] end
  local mesh = bw.mesh.new {nodes = nodes, elements = elements, regions = tags, region_names = {"faces", "core"}}
  mesh = t:require(mesh):with_order(2)
  local part = bw.model {mesh = mesh, materials = {
    faces = bw.material.isotropic {young = young, poisson = 0, density = 2800},
    core = bw.material.isotropic {young = 2.098e6, poisson = 0.49, density = 970}}}
  part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", length), force = {0, 0, 1}}
  local response = t:require(part:harmonic {range = {0, 1500}, damping = {loss = {core = 0.1}}})
  local source = "sixth-order theory of Mead and Markus, Journal of Sound and Vibration 10 (1969) 163-175"
  local beam = {length = length, face = face, core = core, young = young, mass = 2 * 2800 * face + 970 * core}
  local function frequencies(factor)
    beam.shear = factor * shear
    return sandwich_frequencies(beam, 3)
  end
  -- The core's share of the strain energy is the derivative of ln omega^2 by ln of its shear modulus: twice that
  -- of ln omega.
  local step, expected = 1e-3, frequencies(1)
  local softer, stiffer = frequencies(math.exp(-step / 2)), frequencies(math.exp(step / 2))
  -- bending out of the plane of the layers; modes 3 and 5 are beside it
  for k, mode in ipairs {1, 2, 4} do
    expect(response.modes.frequencies[mode], ("frequency of mode %d"):format(mode), "Hz")
      :near(expected[k], {relative = 0.001, source = source})
    expect(response.losses[mode] / 0.1, ("loss factor of mode %d over that of the core"):format(mode))
      :near(2 * math.log(stiffer[k] / softer[k]) / step, {relative = 0.004, source = source})
  end
  expect(response.errors:max(), "bound of the error"):below(1e-6)
end)

-- A slender cantilever on a base with a flat response spectrum, up to between its third and fourth bending modes.
scenario("Response spectrum of a slender cantilever", function(t)
  local L, b, h, S = 0.5, 0.02, 0.01, 10
  local steel = bw.material.isotropic {young = 200e9, poisson = 0, density = 8000}
  local mesh = bw.mesh.box {max = {L, b, h}, cells = {40, 2, 1}, order = 2}
  local part = bw.model({mesh = mesh, material = steel}):fix(mesh.boundary:below("x", 0))
  local lambda, at_tip = {1.87510, 4.69409, 7.85476}, {1.5660, 0.8679, 0.5089}
  local part_of_mass = {0.6131, 0.1883, 0.0647}
  local unit = math.sqrt(200e9 * h ^ 2 / (12 * 8000)) / L ^ 2 -- rad/s
  local spectrum = t:require(part:response_spectrum {points = {{1, S}, {9 ^ 2 * unit / (2 * math.pi), S}},
    direction = {0, 0, 1}, combination = "srss", missing_mass = false})
  local source = "closed form of the Bernoulli beam: frequencies lambda^2 (EI / m)^0.5 / L^2, effective masses "
    .. "(2 sigma / lambda)^2, tip 4 sigma / lambda times S / omega^2"
  local force, tip, found = 0, 0, 0
  for k = 1, 3 do
    force = force + (S * part_of_mass[k] * 8000 * L * b * h) ^ 2
    tip = tip + (S * at_tip[k] / (lambda[k] ^ 2 * unit) ^ 2) ^ 2
  end
  local masses = spectrum.effective_masses
  for k = 1, #masses do
    if masses[k] > 0.01 * spectrum.mass then
      found = found + 1
      expect(spectrum.modes.frequencies[k], ("frequency of bending mode %d"):format(found), "Hz")
        :near(lambda[found] ^ 2 * unit / (2 * math.pi), {relative = 0.01, source = source})
      expect(masses[k] / spectrum.mass, ("part of the mass in bending mode %d"):format(found))
        :near(part_of_mass[found], {relative = 0.01, source = source})
    end
  end
  expect(found, "bending modes"):near(3, {absolute = 0, source = source})
  expect(spectrum.base_force[3], "force on the support", "N")
    :near(math.sqrt(force), {relative = 0.01, source = source})
  local node = mesh.boundary:nearest({L, b / 2, h / 2}).nodes[1]
  expect(spectrum.displacement(node, 3), "displacement of the tip", "m")
    :near(math.sqrt(tip), {relative = 0.01, source = source})
end)

-- A bar on a base that is accelerated along it, far below its first mode at c / 4 L = 12.5 kHz: its root has one
-- component of stress, density times L times the acceleration, with the flat spectrum of that up to 100 Hz.
scenario("Random vibration: exceedance and crossings of one component", function(t)
  local length, base, top = 0.1, 1000, 100
  local steel = bw.material.isotropic {young = 200e9, poisson = 0, density = 8000}
  local mesh = bw.mesh.box {max = {length, 0.02, 0.02}, cells = {10, 2, 2}, order = 2}
  local part = bw.model({mesh = mesh, material = steel}):fix(mesh.boundary:below("x", 0))
  local response = t:require(part:harmonic {range = {0, top}, base = {base, 0, 0}, damping = {ratio = 0.01}})
  local random = t:require(response:random {psd = {{0, 1 / top}, {top, 1 / top}}})
  local deviation, level, duration = 8000 * length * base, 4, 0.1
  local m = t:require(random:margins {duration = duration, strength = level * deviation})
  local node = mesh.boundary:nearest({0, 0.01, 0.01}).nodes[1]
  local normal = "normal distribution: erfc(R / (sigma 2^0.5))"
  local rice = "Rice, Bell System Technical Journal 24 (1945)"
  local rate = 2 * top / math.sqrt(3) * math.exp(-level ^ 2 / 2) -- through the strength and through minus that
  expect(random.von_mises[node], "root mean square of von Mises stress", "Pa"):near(deviation,
    {relative = 0.001, source = "closed form: density times length times acceleration"})
  expect(m.margin, "margin at three deviations"):near(level / 3 - 1, {relative = 0.005,
    source = "closed form: 4 / 3 - 1"})
  expect(m.exceedance[node], "share of the time beyond the strength, four deviations"):near(6.334248e-5,
    {relative = 0.005, source = normal})
  expect(m.beyond, "share of the time beyond three deviations"):near(2.699796e-3,
    {relative = 1e-5, source = normal})
  expect(m.rate[node], "crossings of the strength, 1/s"):near(rate, {relative = 0.005, source = rice})
  expect(m.first_passage[node], "bound of the probability within 0.1 s"):near(6.334248e-5 + rate * duration,
    {relative = 0.005, source = "exceedance and rate of the above"})
end)

-- A rod without lateral contraction that lands on its end: Saint-Venant's wave runs to the far end and back.
scenario("Saint-Venant: a rod that lands on its end", function(t)
  local length, side, speed, c = 0.1, 0.01, 2, 1000
  local mesh = bw.mesh.box {max = {length, side, side}, cells = {40, 2, 2}, order = 2}
  local part = bw.model {mesh = mesh,
    material = bw.material.isotropic {young = 1e9, poisson = 0, density = 1000}}
  local drop = t:require(part:drop {speed = speed, gravity = 0, down = {-1, 0, 0}, samples = 0,
    modes = t:require(part:modes {count = 150})})
  local impact, source = drop.impacts[1], "Saint-Venant, Journal de mathématiques 12, 1867"
  expect(impact.duration, "duration, 2 L/c", "s"):near(2 * length / c, {relative = 0.01, source = source})
  expect(impact.impulse / impact.duration, "mean force, density times c A v", "N"):near(
    1000 * c * side ^ 2 * speed, {relative = 0.015, source = source})
end)

-- A block whose lower face is part of a sphere of radius R, with small elements about its lowest point. The
-- contact is 0.02 R wide: Hertz's theory is that of a small one.
local function domed_block(R)
  local mesh = bw.mesh.box {cells = {12, 12, 10}, order = 2}
  local function sinh(x) return (math.exp(x) - math.exp(-x)) / 2 end
  local nodes = mesh.nodes:totable()
  for _, p in ipairs(nodes) do
    for k = 1, 2 do p[k] = 0.6 * R * sinh(6 * (2 * p[k] - 1)) / sinh(6) end
    local low = R - math.sqrt(R ^ 2 - p[1] ^ 2 - p[2] ^ 2)
    p[3] = low + (1.2 * R - low) * (math.exp(6 * p[3]) - 1) / (math.exp(6) - 1)
  end
  return mesh:moved(nodes)
end

local function hertz(t, R, speed, radius, onto)
  local young, poisson = 1e9, 0.3
  local part = bw.model {mesh = t:require(domed_block(R)),
    material = bw.material.isotropic {young = young, poisson = poisson, density = 1000}}
  local drop = t:require(part:drop {speed = speed, gravity = 0, down = {0, 0, -1}, samples = 0, onto = onto,
    modes = t:require(part:modes {count = 20})})
  local stiffness = 4 / 3 * young / (1 - poisson ^ 2) * math.sqrt(radius)
  local deep = (1.25 * drop.mass * speed ^ 2 / stiffness) ^ 0.4
  local source = "Hertz, Journal für die reine und angewandte Mathematik 92, 1881"
  expect(drop.impacts[1].duration, "duration, 2.943 depth/v", "s"):near(2.94327 * deep / speed, {relative = 0.02,
    source = source})
  expect(drop.impacts[1].force, "largest force", "N"):near(stiffness * deep ^ 1.5, {relative = 0.02,
    source = source})
end

scenario("Hertz: impact of a domed block", function(t) hertz(t, 0.01, 0.04, 0.01) end)

-- 1 / radius = 1 / R + 1 / R. Twice the speed makes the contact as wide as on a plane.
scenario("Hertz: impact of a domed block on a peg", function(t)
  hertz(t, 0.01, 0.08, 0.005, bw.rigid.sphere {radius = 0.01})
end)
