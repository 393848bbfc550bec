-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Remote points and a preload beside closed forms of bars, at rest and shaken; the worst case of bonded halves
-- beside the whole.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Remote points, preload and bonds",
  text = [[Bars of tetrahedra with ten nodes and a Poisson's ratio of 0 beside closed forms
([theory](theory/joints.md)).]]}

local young = 2e11
local straight = bw.material.isotropic {young = young, poisson = 0}

-- A cantilever along x whose force acts at `lever` above the axis and `beyond` the end.
local function offset_force(t, kind, lever, beyond, force)
  local L, b, h = 1, 0.1, 0.2
  local mesh = bw.mesh.box {max = {L, b, h}, cells = {8, 1, 2}, order = 2}
  local part = bw.model {mesh = mesh, material = straight}
  part:fix(mesh.boundary:below("x", 0))
  part:couple {on = mesh.boundary:above("x", L), kind = kind, force = force,
    at = {L + beyond, b / 2, h / 2 + lever}}
  return t:require(part:solve()).couplings[1], L, young * b * h, young * b * h ^ 3 / 12
end

for _, kind in ipairs {"distributed", "rigid"} do
  scenario("Cantilever, force beside and beyond its end, " .. kind .. " coupling", function(t)
    local pull, lever = 5000, 0.5
    local point, L, EA, EI = offset_force(t, kind, lever, 0, {pull, 0, 0})
    local rotation = pull * lever * L / EI
    expect(point.rotation[2], "rotation by a pull 0.5 m above the axis", "rad")
      :near(rotation, {relative = 1e-6, source = "beam theory"})
    expect(point.displacement[1], "displacement of the point along the pull", "m")
      :near(pull * L / EA + rotation * lever, {relative = 1e-6, source = "beam theory"})
    local side, beyond = -200, 0.3
    point, L, EA, EI = offset_force(t, kind, 0, beyond, {0, 0, side})
    expect(point.rotation[2], "rotation by a force 0.3 m beyond the end", "rad")
      :near(-side * (L ^ 2 / 2 + beyond * L) / EI, {relative = 1e-6, source = "beam theory"})
    local shear = 6 / 5 * side * L / (EA / 2)
    expect(point.displacement[3], "displacement of the point along the force", "m")
      :near(side * ((L + beyond) ^ 3 - beyond ^ 3) / (3 * EI) + shear, {relative = 1e-3, source = "Timoshenko"})
  end)
end

-- A bolt and a sleeve, two bars side by side, whose ends a rigid coupling keeps parallel.
scenario("Bolt and sleeve in parallel, preload and working load", function(t)
  local L, side, preload, load = 0.1, 0.01, 20e3, 6e3
  local box = bw.mesh.box {max = {L, 4 * side, side}, cells = {10, 4, 1}, order = 2}
  local keep, nodes = {}, box.nodes:totable()
  for e, row in ipairs(box.elements:totable()) do
    local y = 0
    for a = 1, 4 do y = y + nodes[row[a]][2] / 4 end
    keep[e] = (y < side or y > 2 * side) and 1 or 0
  end
  local bars = assert(box:subset(bw.array.new(keep)))
  local mesh = assert(bars:split({max = {L / 2, side, side}}, "half")):separated "half"
  local cut = mesh.boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9)
  local bolt, sleeve = young * side ^ 2 / L, 2 * young * side ^ 2 / L -- stiffness (N/m)
  local function solve(how, force)
    local part = bw.model {mesh = mesh, material = straight}
    part:fix(mesh.boundary:below("x", 0))
    part:couple {on = mesh.boundary:above("x", L), kind = "rigid", force = {force, 0, 0},
      displacement = {false, 0, 0}, rotation = {0, 0, 0}}
    part:bond {a = cut & mesh.boundary:region "half", b = cut & mesh.boundary:region "rest",
      preload = how.preload, shortening = how.shortening}
    local static = t:require(part:solve())
    return static.bonds[1], static.couplings[1].displacement[1]
  end
  local bond, moved = solve({preload = preload}, 0)
  expect(moved, "displacement of the ends by the preload", "m")
    :near(-preload / sleeve, {relative = 1e-8, source = "bars in parallel"})
  local shortening = preload / bolt + preload / sleeve
  expect(bond.shortening, "shortening of the bolt", "m")
    :near(shortening, {relative = 1e-8, source = "bars in parallel"})
  bond, moved = solve({shortening = shortening}, load)
  expect(bond.preload, "force of the bolt under the working load", "N")
    :near(preload + load * bolt / (bolt + sleeve), {relative = 1e-8, source = "joint diagram"})
  expect(moved, "displacement of the ends under the working load", "m")
    :near(load / (bolt + sleeve) - preload / sleeve, {relative = 1e-8, source = "joint diagram"})
end)

-- A rod of mass density A L with a mass m at its end: with k^2 = omega^2 density / E the amplitude of the end is
-- F / (E A k cot(k L) - omega^2 m). The base shakes the same mass on a light rod: Miles's equation.
scenario("Mass at the end of a rod: harmonic response and Miles", function(t)
  local L, side, mass, force, ratio = 1, 0.1, 50, 1000, 0.05
  local area, density = side ^ 2, 7800
  local mesh = bw.mesh.box {max = {L, side, side}, cells = {30, 1, 1}, order = 2}
  local function rod(of_body)
    local part = bw.model {mesh = mesh,
      material = bw.material.isotropic {young = young, poisson = 0, density = of_body}}
    return part:fix(mesh.boundary:below("x", 0))
  end
  local tip, list = mesh.boundary:above("x", L), {200, 700, 1500}
  local part = rod(density):couple {on = tip, mass = mass, force = {force, 0, 0}}
  local curve = t:require(t:require(part:harmonic {frequencies = list}):curve {coupling = 1})
  for i, f in ipairs(list) do
    local omega = 2 * math.pi * f
    local k = omega * math.sqrt(density / young)
    expect(curve.real(i, 1), ("amplitude of the end at %d Hz"):format(f), "m")
      :near(force / (young * area * k / math.tan(k * L) - omega ^ 2 * mass), {relative = 1e-5, source = "rod"})
  end
  local omega = math.sqrt(young * area / L / mass)
  local last = 20 * omega / (2 * math.pi)
  part = rod(1):couple {on = tip, mass = mass} -- 10 g
  local shaken = t:require(part:harmonic {range = {0, last}, base = {1, 0, 0}, damping = {ratio = ratio}})
  local random = t:require(shaken:random {psd = {{0, 1}, {last, 1}}})
  expect(random.couplings[1].displacement[1], "root mean square of the mass against its base", "m")
    :near(math.sqrt(1 / (8 * ratio * omega ^ 3)), {relative = 2e-4, source = "Miles, J. Aeronaut. Sci. 21 (1954)"})
end)

-- The worst case of a body that was cut across and bonded is that of the whole body, where no pressure acts at
-- the rim of the cut.
for _, held in ipairs {true, false} do
  scenario("Worst case of a bar cut in two, " .. (held and "held" or "free"), function(t)
    local L = 0.1
    local whole = bw.mesh.box {max = {L, 0.02, 0.015}, cells = {8, 2, 2}, order = 2}
    local function largest(mesh, bonded)
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      local boundary = mesh.boundary
      if held then part:fix(boundary:below("x", 0)) end
      if bonded then
        local cut = boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9)
        part:bond {a = cut & boundary:region "left", b = cut & boundary:region "rest"}
      end
      local rim = boundary:box({0.36 * L, -1, -1}, {0.64 * L, 1, 1})
      return t:require(bw.worst_case(part, {force = 50, contact = 1e-4, forbidden = rim})).max_principal
    end
    local cut = assert(whole:split({max = {L / 2, 1, 1}}, "left")):separated "left"
    expect(largest(cut, true), "largest stress of the bonded halves", "Pa")
      :near(largest(whole, false), {relative = 1e-8, source = "the whole body"})
  end)
end

-- A column of length L under a force on a rigid lever a beyond its end, which is at w(L) + a w'(L): cos kL =
-- a k sin kL with k^2 = F / EI. Shear lowers the force as Engesser has it.
for _, kind in ipairs {"distributed", "rigid"} do
  scenario(("Column under a rigid lever, %s coupling"):format(kind), function(t)
    local L, h, w = 1, 0.02, 0.03
    local mesh = bw.mesh.box {max = {L, h, w}, cells = {30, 1, 1}, order = 2}
    for _, a in ipairs {0, 0.3, 1} do
      local part = bw.model {mesh = mesh, material = straight}
      part:fix(mesh.boundary:below("x", 0))
      part:couple {on = mesh.boundary:above("x", L), kind = kind, at = {L + a, h / 2, w / 2}, force = {-1, 0, 0}}
      local factor = t:require(t:require(part:solve()):buckling {count = 1}).factors[1]
      local low, high = 1e-3, math.pi / 2 / L
      for _ = 1, 100 do
        local k = (low + high) / 2
        if math.cos(k * L) > a * k * math.sin(k * L) then low = k else high = k end
      end
      local load = young * w * h ^ 3 / 12 * low ^ 2
      expect(factor, ("critical force, lever of %g m"):format(a), "N"):near(
        load / (1 + 1.2 * load / (young / 2 * h * w)), {relative = 2e-4, source = "Euler, Engesser"})
    end
  end)
end
