-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Transients of joined models by modes and by direct integration: a body cut in two, closed forms of oscillators,
-- moving supports, states at rest, and CalculiX (ccx) on the same elements where it is there.
local bw = require "barwright"
local check = require "check"
local beam = require "cut_beam"
local tied_beam = require "tied_beam"

--- A rod along x without lateral contraction, fixed at x = 0, with hardly any mass: 2e9 N/m.
local function rod()
  local mesh = bw.mesh.box {max = {1, 0.1, 0.1}, cells = {4, 1, 1}, order = 2}
  local part = bw.model {mesh = mesh,
    material = bw.material.isotropic {young = 2e11, poisson = 0, density = 1e-3}}
  part:fix(mesh.boundary:below("x", 0))
  return part, mesh.boundary:above("x", 1)
end

describe("transients of joined models", function()
  it("move a body cut in two and bonded as the whole", function()
    local found = {}
    for i, cut in ipairs {false, true} do
      local part, tip = beam(cut, {4, 2, 1})
      part:load {on = tip, force = {0, 30, 100}}:gravity {0, 0, -9.81}
      local modes = assert(part:modes {count = 8, tolerance = 1e-12})
      local now = assert(part:transient {step = 1e-3, modes = modes,
        damping = {ratio = 0.02, mass = 3, stiffness = 1e-6},
        loads = {{{0, 0}, {0.004, 1}, {0.02, 1}, {0.021, 0}}, function(t) return math.sin(300 * t) end}})
      local run = assert(now:run {time = 0.06, probes = {tip = {1, 0, 0}, middle = {0.25, 0.1, 0.05}},
        stress_every = 20})
      local force = {0, 0, 0}
      local reaction = now.reaction
      for k = 1, 3 do for n = 1, #part.mesh.nodes do force[k] = force[k] + reaction(n, k) end end
      found[i] = {run = run, force = force, static = assert(now:static())}
    end
    local whole, cut = table.unpack(found)
    for _, probe in ipairs {"tip", "middle"} do
      for _, field in ipairs {"displacement", "velocity", "acceleration"} do
        check.same(whole.run.probes[probe][field], cut.run.probes[probe][field],
          field == "displacement" and 1e-8 or 1e-7)
      end
    end
    check.same(whole.run.energy.kinetic_energy, cut.run.energy.kinetic_energy, 1e-8)
    check.same(whole.run.energy.strain_energy, cut.run.energy.strain_energy, 1e-8)
    check.same(whole.run.energy.work, cut.run.energy.work, 1e-8)
    check.same(whole.run.energy.damping_energy, cut.run.energy.damping_energy, 1e-8)
    check.same(whole.run.stress.von_mises, cut.run.stress.von_mises, 1e-7)
    check.near(whole.static.energy, cut.static.energy, 1e-7)
    for k = 1, 3 do
      assert.is_true(math.abs(whole.force[k] - cut.force[k]) < 1e-7 * math.abs(whole.force[3]),
        ("%g %g"):format(whole.force[k], cut.force[k]))
    end
  end)

  it("move a body cut in two as the whole by direct integration, on a support that moves", function()
    for _, how in ipairs {{}, {error = 5e-3}} do
      local found = {}
      for i, cut in ipairs {false, true} do
        local part, tip = beam(cut, {4, 2, 1})
        part:load {on = tip, force = {0, 30, 100}}:gravity {0, 0, -9.81}
        part:clear_supports():prescribe(part.mesh.boundary:below("x", 0), {0, 0, 1e-4})
        local velocity = {}
        for n, x in ipairs(part.mesh.nodes:totable()) do velocity[n] = {0, 0, 0.3 * x[1] ^ 2} end
        local now = assert(part:transient {step = 1e-4, error = how.error, rho = 0.8,
          damping = {mass = 3, stiffness = 1e-6}, initial = {velocity = velocity},
          supports = function(t) return math.sin(200 * t) ^ 3 end,
          loads = {{{0, 0}, {0.004, 1}, {0.02, 1}, {0.021, 0}}, function(t) return math.sin(300 * t) end}})
        found[i] = assert(now:run {time = 0.008, probes = {tip = {1, 0, 0}, middle = {0.25, 0.1, 0.05}},
          stress_every = 20})
        found[i].reaction = bw.array.new(now.reaction:column_sums())
      end
      local whole, cut = table.unpack(found)
      assert.equal(#whole.time, #cut.time)
      for _, probe in ipairs {"tip", "middle"} do
        for _, field in ipairs {"displacement", "velocity", "acceleration"} do
          check.same(whole.probes[probe][field], cut.probes[probe][field], 1e-8)
        end
      end
      for _, name in ipairs {"kinetic_energy", "strain_energy", "work", "damping_energy"} do
        check.same(whole.energy[name], cut.energy[name], 1e-7)
      end
      check.same(whole.stress.von_mises, cut.stress.von_mises, 1e-7)
      check.same(whole.reaction, cut.reaction, 1e-7)
    end
  end)

  it("swing a mass on a light rod by its closed form", function()
    local mass, spring, stiffness, force, ratio = 20, 1e9, 2e9, 1e4, 0.03
    local w = math.sqrt((stiffness + spring) / mass)
    local d, v = ratio * w, w * math.sqrt(1 - ratio * ratio)
    local rise = 7 / w
    -- x'' + 2 d x' + w^2 x = f t / m, from rest
    local function ramp(t)
      if t <= 0 then return 0 end
      local a = force / (stiffness + spring)
      local b = 2 * d / w ^ 2
      return a * (t - b + math.exp(-d * t) * (b * math.cos(v * t) + (d * b - 1) / v * math.sin(v * t)))
    end
    for _, how in ipairs {"attached", "rigid", "distributed"} do
      local part, tip = rod()
      local history, options = {{0, 0}, {rise, 1}}, {step = rise / 7, damping = {ratio = ratio}}
      if how == "attached" then
        part:attach {on = tip, mass = mass}:attach {on = tip, spring = {spring, 0, 0}}
          :load {on = tip, force = {force, 0, 0}}
        options.loads = {history}
      else
        part:couple {on = tip, kind = how, mass = mass, spring = {spring, 0, 0}, force = {force, 0, 0}}
        options.couplings = {history}
      end
      options.modes = assert(part:modes {count = 7, tolerance = 1e-12})
      local now = assert(part:transient(options))
      local run = assert(now:run {time = 6 * rise, probes = {tip = {1, 0, 0}}})
      for i = 1, #run.time do
        local t = run.time[i]
        local expected = (ramp(t) - ramp(t - rise)) / rise
        local off = math.abs(run.probes.tip.displacement(i, 1) - expected)
        assert.is_true(off < 1e-6 * force / (stiffness + spring), ("%s %g s: %g of %g"):format(how, t, off,
          expected))
      end
      -- the strain energy has that of the spring, and of its static state it has not
      local x = run.probes.tip.displacement(#run.time, 1)
      check.near(0.5 * (stiffness + spring) * x * x, now.strain_energy, 1e-5)
      check.near(0.5 * stiffness * x * x, assert(now:static()).energy, 1e-5)
      local reaction, held = now.reaction, 0
      for n = 1, #part.mesh.nodes do held = held + reaction(n, 1) end
      check.near(-stiffness * x, held, 1e-5)
    end
  end)

  it("swing a mass on a light rod by direct integration, under a force and from a support that moves", function()
    local mass, spring, stiffness, force, far = 20, 1e9, 2e9, 1e4, 4e-6
    local w = math.sqrt((stiffness + spring) / mass)
    local damping, pulse = 0.06 * w, 0.7 * w -- of the mass; the angular frequency of the force and the support
    local d = damping / 2
    local v = math.sqrt(w * w - d * d)
    -- x'' + 2 d x' + w^2 x = a sin(p t) from rest: particular part, and the free swing that starts at its negative
    local function driven(a, t)
      local p, square = pulse, (w * w - pulse ^ 2) ^ 2 + (2 * d * pulse) ^ 2
      local c, s = -2 * d * p * a / square, (w * w - p * p) * a / square
      return c * math.cos(p * t) + s * math.sin(p * t)
        - math.exp(-d * t) * (c * math.cos(v * t) + (d * c + p * s) / v * math.sin(v * t))
    end
    for _, how in ipairs {"attached", "rigid", "distributed"} do
      local part, tip = rod()
      local function history(t) return math.sin(pulse * t) end
      part:clear_supports():prescribe(part.mesh.boundary:below("x", 0), {far, 0, 0})
      local options = {step = 2 * math.pi / w / 200, rho = 1, damping = {mass = damping}, supports = history}
      if how == "attached" then
        part:attach {on = tip, mass = mass}:attach {on = tip, spring = {spring, 0, 0}}
          :load {on = tip, force = {force, 0, 0}}
        options.loads = {history}
      else
        part:couple {on = tip, kind = how, mass = mass, spring = {spring, 0, 0}, force = {force, 0, 0}}
        options.couplings = {history}
      end
      local off, most = {}, 0
      for i = 1, 3 do -- fixed steps, half of them, and steps that adapt
        local given = {}
        for k, value in pairs(options) do given[k] = value end
        if i == 2 then given.step = options.step / 2 elseif i == 3 then given.error = 1e-3 end
        local run = assert(assert(part:transient(given)):run {time = 30 / w, probes = {tip = {1, 0, 0}}})
        off[i] = 0
        for k = 1, #run.time do
          local expected = driven((force + stiffness * far) / mass, run.time[k])
          off[i], most = math.max(off[i], math.abs(run.probes.tip.displacement(k, 1) - expected)),
            math.max(most, math.abs(expected))
        end
        -- what supports and loads do, the masses and the damping have
        assert.is_true(check.largest(run.energy.lost_energy) < 2e-3 * run.energy.work:max())
        if i == 3 then assert.is_true(off[3] < run.steps.error * most) end
      end
      assert.is_true(off[1] < 4e-3 * most, ("%s: %g of %g"):format(how, off[1], most))
      check.near(4, off[1] / off[2], 0.03) -- of second order
    end
  end)

  it("are the same by direct integration and by all modes", function()
    for i, kind in ipairs {"rigid", "distributed", "rigid", "distributed"} do
      local part, tip = beam(true, {1, 1, 1})
      local moves = i > 2 -- the support, and a component of the point
      if moves then part:clear_supports():prescribe(part.mesh.boundary:below("x", 0), {1e-4, 0, 2e-4}) end
      part:couple {on = tip, kind = kind, at = {1.1, 0.02, 0.05}, mass = 2, inertia = {0.01, 0.02, 0.01},
        force = {0, 0, 30}, moment = {5, 0, 0}, spring = {0, moves and 0 or 3e5, 0},
        displacement = {false, moves and 1e-4, false}}
        :attach {on = part.mesh.boundary:above("z", 0.05), mass = 3}
        :load {on = part.mesh.boundary:above("y", 0.1), force = {0, 100, 0}}
      local modes = assert(part:modes {count = 1000, tolerance = 1e-12})
      assert.is_true(#modes.frequencies < 3 * #part.mesh.nodes) -- all of them
      local first = 2 * math.pi * modes.frequencies[1]
      local function history(t) return math.sin(0.3 * first * t) ^ 3 end
      local function displacement(by, count)
        local now = assert(part:transient {step = 10 / first / count, rho = 1, modes = by,
          damping = {mass = 0.1 * first, stiffness = not moves and 0.01 / first or nil}, loads = {history},
          couplings = {history}, supports = history})
        for _ = 1, count do assert(now:step()) end
        return now.displacement, bw.array.new(now.reaction:column_sums())
      end
      local exact, held = displacement(modes, 6400)
      local off = {}
      for k = 1, 2 do
        local found, reaction = displacement(nil, 400 * k)
        off[k] = check.largest(found - exact)
        check.same(held, reaction, 5e-3)
      end
      assert.is_true(off[1] < 1e-3 * check.largest(exact), ("%s: %g"):format(kind, off[1] / check.largest(exact)))
      -- nothing damps the shortest waves where supports move
      check.near(4, off[1] / off[2], moves and 0.15 or 0.03)
    end
  end)

  it("follow a remote point that moves as a support there", function()
    local function history(t) return math.sin(900 * t) ^ 2 end
    local found = {}
    for _, how in ipairs {"support", "rigid", "distributed"} do
      local part, tip = beam(true, {3, 2, 1})
      part:attach {on = part.mesh.boundary:above("z", 0.05), mass = 1}
      if how == "support" then
        part:prescribe(tip, {0, 1e-4, -2e-4})
      else
        part:couple {on = tip, kind = how, displacement = {0, 1e-4, -2e-4}, rotation = {0, 0, 0}}
      end
      if how == "rigid" then -- by modes too
        local modes = assert(part:modes {count = 20, tolerance = 1e-12})
        found.modes = assert(assert(part:transient {step = 2e-5, supports = history, modes = modes})
          :run {time = 2e-3, probes = {middle = {0.5, 0.1, 0.05}}})
      end
      local now = assert(part:transient {step = 2e-5, supports = history, rho = 1})
      found[how] = assert(now:run {time = 2e-3, probes = {tip = {1, 0, 0}, middle = {0.5, 0.1, 0.05}}})
      found[how].root = bw.array.new(now.reaction:column_sums())
      assert.is_true(check.largest(found[how].energy.lost_energy) < 1e-3 * found[how].energy.work:max())
    end
    for _, field in ipairs {"displacement", "velocity", "acceleration"} do
      check.same(found.support.probes.middle[field], found.rigid.probes.middle[field], 1e-8)
    end
    check.same(found.support.energy.work, found.rigid.energy.work, 1e-8)
    check.same(found.rigid.probes.middle.displacement, found.modes.probes.middle.displacement, 5e-3)
    -- the mean motion of the face; the face itself deforms
    check.same(found.support.probes.middle.displacement, found.distributed.probes.middle.displacement, 0.05)
  end)

  it("fly free, and take from a start what joints allow", function()
    local part = beam(true, {2, 1, 1})
    part:clear_supports():attach {on = part.mesh.boundary:above("x", 1), mass = 10}
    local turned, opened = {}, {}
    for n, x in ipairs(part.mesh.nodes:totable()) do
      turned[n] = {0.1 - 0.5 * x[2], 0.2 + 0.5 * x[1], -0.3}
      opened[n] = {n > #part.mesh.nodes / 2 and 1 or 0, 0, 0}
    end
    local now = assert(part:transient {step = 1e-3, error = 1e-3, rho = 1, initial = {velocity = turned}})
    local before = now.kinetic_energy
    check.same(bw.array.new(turned), now.velocity, 1e-10)
    for _ = 1, 5 do assert(now:step()) end
    check.near(before, now.kinetic_energy + now.strain_energy, 1e-9)
    bw.warnings()
    assert(part:transient {step = 1e-3, initial = {velocity = opened}})
    local said = bw.warnings()
    assert.equal(1, #said)
    assert.truthy(said[1]:find("joints do not allow", 1, true), said[1])
  end)

  it("swing two masses on two springs by their closed form", function()
    -- two light rods, bonded one behind the other: masses m at 0.5 m and 1 m, springs of 2e9 N/m
    local part, tip = beam(true, {3, 1, 1}, bw.material.isotropic {young = 2e11, poisson = 0, density = 1e-3})
    local m, k, middle = 30, 2e9, part.mesh.boundary:above("x", 0.499):below("x", 0.501)
    part:couple {on = tip, kind = "rigid", mass = m}:attach {on = middle:facing {1, 0, 0}, mass = m}
      :gravity {100, 0, 0}
    local now = assert(part:transient {step = 1e-4, modes = assert(part:modes {count = 9, tolerance = 1e-12})})
    local run = assert(now:run {time = 0.01, probes = {tip = {1, 0, 0}}})
    -- lambda of [[2, -1], [-1, 1]] and the shapes (1, s)
    local expected = {}
    for i = 1, #run.time do
      local sum = 0
      for _, sign in ipairs {-1, 1} do
        local lambda = (3 + sign * math.sqrt(5)) / 2
        local s = 2 - lambda -- of the end
        local w2 = lambda * k / m
        sum = sum + s * 100 * (1 + s) / (1 + s * s) / w2 * (1 - math.cos(math.sqrt(w2) * run.time[i]))
      end
      expected[i] = sum
    end
    local most = 0
    for i = 1, #expected do most = math.max(most, expected[i]) end
    for i = 1, #expected do
      local off = math.abs(expected[i] - run.probes.tip.displacement(i, 1))
      assert.is_true(off < 1e-5 * most, ("%g s: %g of %g"):format(run.time[i], off, most))
    end
  end)

  it("come to rest at the static solution, with its reactions and energy", function()
    for _, kind in ipairs {"rigid", "distributed"} do
      local part, tip = beam(true, {3, 2, 1})
      local boundary = part.mesh.boundary
      part:attach {on = boundary:above("z", 0.05), mass = 5}
        :attach {on = boundary:above("y", 0.1), spring = {0, 2e5, 1e6}}
        :couple {on = tip, kind = kind, at = {1.2, 0, 0.1}, mass = 2, spring = {0, 0, 3e5}, force = {50, 200, 0},
          moment = {0, 30, 0}, displacement = {0, false, false}}
      if kind == "distributed" then -- supports hold nodes of its face, along x and y
        part:prescribe(boundary:below("y", 0):above("x", 0.6), {0, false, false})
      end
      part:gravity {1, 2, -9.81}:load {on = boundary:below("z", 0), force = {100, 0, 500}}
      local expected = assert(part:solve())
      local now = assert(part:transient {step = 0.01, modes = assert(part:modes {count = 4, tolerance = 1e-12}),
        damping = {ratio = 0.9}})
      assert(now:run {time = 0.3})
      check.same(expected.displacement, now.displacement, 1e-9)
      check.same(expected.reaction, now.reaction, 1e-8)
      check.near(expected.energy, assert(now:static()).energy, 1e-8)
    end
  end)

  it("refuse what they do not know", function()
    local part, tip = rod()
    part:attach {on = tip, mass = 3}
    local modes = assert(part:modes {count = 2})
    assert(part:transient {step = 1e-3})
    assert(part:transient {step = 1e-3, modes = modes})
    check.raises("there is no coupling 1: the part has 0", function()
      part:transient {step = 1e-3, modes = modes, couplings = {1}}
    end)
    -- modes without the mass are others, and so are those of a part without its bond
    local plain = bw.model {mesh = part.mesh, material = part.material}
    plain:fix(part.mesh.boundary:below("x", 0))
    check.raises("supports and joints", function()
      part:transient {step = 1e-3, modes = assert(plain:modes {count = 2})}
    end)
    part:clear_supports():attach {on = tip, spring = {1e6, 1e6, 1e6}}
    part:prescribe(part.mesh.boundary:below("x", 0), {1e-3, 0, 0})
    check.fails("unsupported", "without a part of the stiffness", part:transient {step = 1e-3,
      modes = assert(part:modes {count = 2}), damping = {stiffness = 1e-6}})
    part:clear_supports():clear_attachments():attach {on = tip, mass = 1}
    check.fails("unconstrained", "rigid-body mode", part:transient {step = 1e-3, modes = modes})
    local halves = beam(true, {2, 1, 1})
    local of_halves = assert(halves:modes {count = 2})
    local loose = bw.model {mesh = halves.mesh, material = halves.material}
    local middle = halves.mesh.boundary:above("x", 0.499):below("x", 0.501)
    loose:fix(halves.mesh.boundary:below("x", 0))
    loose:attach {on = middle:facing {-1, 0, 0}, spring = {1e9, 1e9, 1e9}}
    check.raises("supports and joints", function()
      halves:transient {step = 1e-3, modes = assert(loose:modes {count = 2})}
    end)
    local now = assert(halves:transient {step = 1e-3, modes = of_halves})
    halves:clear_bonds()
    check.raises("supports or joints", function() now:step() end)
    halves:bond {a = middle:facing {1, 0, 0}, b = middle:facing {-1, 0, 0}, preload = 100}
    check.fails("unsupported", "bond 1 has a preload", halves:transient {step = 1e-3, modes = of_halves})
    check.fails("unsupported", "bond 1 has a preload", halves:transient {step = 1e-3})
  end)

  it("give states without what joints exert, of which load factors are refused", function()
    local part, tip = rod()
    part:couple {on = tip, kind = "rigid", mass = 3, force = {-10, 0, 0}}
    local now = assert(part:transient {step = 1e-4, modes = assert(part:modes {count = 3})})
    local static = assert(assert(now:step()):static())
    assert.equal(0, #static.couplings)
    check.fails("unsupported", "what remote points exert", static:buckling())
    assert.truthy(tostring(static):find("error unknown", 1, true))
  end)

  if os.execute "command -v ccx >/dev/null 2>&1" then
    it("are those of *DYNAMIC, DIRECT of CalculiX of a tied beam with a mass on a lever", function()
      -- light: CalculiX integrates the mass of elements with fewer points
      local part, tip = beam(true, {6, 2, 1}, bw.material.isotropic {young = 2e11, poisson = 0.3, density = 1})
      local at, step, steps = {1.1, 0.05, 0.1}, 5e-4, 120
      local rows = {{0, 0}, {0.01, 1}, {0.03, -0.5}, {0.06, 0.2}}
      local amplitude = {}
      for i, row in ipairs(rows) do amplitude[i] = ("%.12g, %.12g"):format(row[1], row[2]) end
      local point, turn = tied_beam(part, tip, at, 5, ([[
*AMPLITUDE, NAME=HISTORY
%s
*STEP, INC=10000
*DYNAMIC, DIRECT, ALPHA=0
%.12g, %.12g
*CLOAD, AMPLITUDE=HISTORY
POINT_NODE, 2, 20.
POINT_NODE, 3, 100.
*NODE PRINT, NSET=POINT
U
*NODE PRINT, NSET=TURN
U
*END STEP
]]):format(table.concat(amplitude, "\n"), step, steps * step))
      part:couple {on = tip, kind = "rigid", at = at, mass = 5, force = {0, 20, 100}}
      local now = assert(part:transient {step = step, rho = 1, couplings = {rows}})
      local places, nodes = tip.mesh.nodes:totable(), tip.nodes:totable()
      assert.equal(steps, #point)
      local off, most = 0, 0
      for i = 1, steps do
        assert(now:step())
        assert.is_true(math.abs(point[i].time - now.time) < 1e-9)
        local u = now.displacement
        for _, n in ipairs(nodes) do -- of the face that moves with the point
          local r = {places[n][1] - at[1], places[n][2] - at[2], places[n][3] - at[3]}
          for c = 1, 3 do
            local d, e = c % 3 + 1, (c + 1) % 3 + 1
            local theirs = point[i][c] + turn[i][d] * r[e] - turn[i][e] * r[d]
            off, most = math.max(off, math.abs(u(n, c) - theirs)), math.max(most, math.abs(theirs))
          end
        end
      end
      assert.is_true(off < 1e-6 * most, ("%g of %g"):format(off, most))
    end)
  end
end)
