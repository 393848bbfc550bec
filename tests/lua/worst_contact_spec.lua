-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst case of parts in contact (docs/theory/worst_case.md, section 17): against contact under each load,
-- random loads, sliding bonds, closed forms, and what is refused.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local L, W, H = 0.1, 0.02, 0.015
local steel = bw.material.steel
local limits = {force = 50, contact = 1e-4}

local function with(more)
  local opts = {}
  for key, value in pairs(limits) do opts[key] = value end
  for key, value in pairs(more or {}) do opts[key] = value end
  return opts
end

-- Two blocks in a row, `gap` apart, the left one supported at its far end, and the right one if `right`.
local function blocks(order, gap, right)
  local mesh = check.boxes(order, {{{0, 0, 0}, {L / 2, W, H}, {4, 2, 2}},
    {{L / 2 + gap, 0, 0}, {L + gap, W, H}, {4, 2, 2}}})
  local function part()
    local model = bw.model {mesh = mesh, material = steel}
    model:fix(mesh.boundary:below("x", 0))
    if right then model:fix(mesh.boundary:above("x", L + gap)) end
    return model
  end
  return part, {{on = mesh.boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9):facing {1, 0, 0},
    with = mesh.boundary:plane({L / 2 + gap, 0, 0}, {1, 0, 0}, 1e-9):facing {-1, 0, 0}}}
end

-- A beam that is supported at one end and rests on a rigid plane along its lower face.
local function beam(order)
  local mesh = bw.mesh.box {max = {L, W, 0.005}, cells = {10, 2, 1}, order = order}
  local function part()
    local model = bw.model {mesh = mesh, material = steel}
    return model:fix(mesh.boundary:below("x", 0))
  end
  return part, {{on = mesh.boundary:below("z", 0), with = bw.rigid.plane {normal = {0, 0, 1}}}}
end

-- A random admissible load: full pressure at nodes in a random order, near one another or not.
local function random_load(random, mesh, basis, force, highest)
  local p, total, order = {}, 0, {}
  local at, node, near = mesh.nodes, basis.nodes, random() < 0.7
  local seed = 1 + math.floor(random() * basis.count)
  local sharp = 1 + 7 * random()
  for j = 1, basis.count do
    p[j] = 0
    local far = 0
    for k = 1, 3 do far = far + (at(node[j], k) - at(node[seed], k)) ^ 2 end
    order[j] = {j, near and -far * (1 + 0.3 * random()) or random() ^ sharp}
  end
  table.sort(order, function(a, b) return a[2] > b[2] end)
  for _, pair in ipairs(order) do
    local value = math.min(highest, (force - total) / basis.areas[pair[1]])
    p[pair[1]] = value
    total = total + value * basis.areas[pair[1]]
    if total >= force * (1 - 1e-12) then break end
  end
  return bw.array.new(p)
end

local function peak_of(mesh, u)
  return core.max_principal(core.element_stress(mesh, steel, u)):max()
end

-- The title of its picture, which has room for about 110 letters.
local function title_of(worst)
  local picture, title = core.picture, nil
  core.picture = function(_, _, given)
    title = given.title
    return true
  end
  local ok, message = pcall(worst.picture, worst, "worst.png")
  core.picture = picture
  assert(ok, message)
  return title
end

describe("the worst case of parts in contact", function()
  it("is the stress that part:contact finds under its load", function()
    for order = 1, 2 do
      for _, case in ipairs {{blocks(order, 0, true)}, {blocks(order, 2e-7, true)}, {beam(order)}} do
        local part, pairs_of = table.unpack(case)
        local worst = assert(bw.worst_case(part(), with {pairs = pairs_of}))
        local loaded = part():load {nodal = worst:force()}
        local contact = assert(loaded:contact(pairs_of))
        local mesh = contact.mesh
        check.near(worst.max_principal, peak_of(mesh, contact.static.displacement), 1e-8)
        check.near(worst.max_principal, core.max_principal(worst:stress()):max(), 1e-12)
        assert.equal(contact.pairs[1].active, worst.touching)
        assert.truthy(tostring(worst):find(("%d of %d corners touch"):format(worst.touching,
          worst.contact.candidates), 1, true), tostring(worst))
        assert.truthy(tostring(worst):find("a lower bound", 1, true))
        local title = title_of(worst)
        assert.is_true(#title < 110 and tostring(worst):find(title:match "^[^;]+", 1, true) == 1, title)
      end
    end
  end)

  it("is not exceeded by random loads", function()
    for _, case in ipairs {{blocks(1, 0, true)}, {beam(1)}} do
      local part, pairs_of = table.unpack(case)
      local worst = assert(bw.worst_case(part(), with {pairs = pairs_of}))
      local random, basis, states = check.random(11), worst.basis, {}
      local most = 0
      for _ = 1, 400 do
        local p = random_load(random, worst.mesh, basis, limits.force, limits.force / limits.contact)
        local u, state = assert(worst.contact:solve(basis:force(p)))
        states[table.concat(state:totable())] = true
        most = math.max(most, peak_of(worst.mesh, u))
      end
      local count = 0
      for _ in pairs(states) do count = count + 1 end
      assert.truthy(count > 10, "states " .. count)
      assert.truthy(most <= worst.max_principal, ("%g of %g"):format(most, worst.max_principal))
      assert.truthy(most > 0.5 * worst.max_principal, ("%g of %g"):format(most, worst.max_principal))
    end
  end)

  it("is not exceeded by the best loads of other states, element by element", function()
    for _, case in ipairs {{blocks(1, 0, true)}, {beam(1)}} do
      local part, pairs_of = table.unpack(case)
      local worst = assert(bw.worst_case(part(), with {pairs = pairs_of}))
      local random, basis, contact, seen = check.random(5), worst.basis, worst.contact, {}
      for _ = 1, 12 do
        local p = random_load(random, worst.mesh, basis, limits.force, limits.force / limits.contact)
        local _, state = assert(contact:solve(basis:force(p)))
        local key = table.concat(state:totable())
        if not seen[key] then
          seen[key] = true
          for sign = -1, 1, 2 do
            local loads = assert(core.worst_loads(contact:in_state(state), basis,
              core.single_regions(worst.mesh, nil, sign), {force = limits.force, one_sign = true,
              pressure = limits.force / limits.contact, contact = contact}))
            assert.truthy(loads.peaks:max() <= worst.max_principal * (1 + 1e-3),
              loads.peaks:max() / worst.max_principal)
          end
        end
      end
    end
  end)

  it("is that of a sliding support where nothing opens", function()
    -- all corners closed are a support that slides
    local part, pairs_of = beam(1)
    local closed = assert(part():contact_system(pairs_of)):in_state "closed"
    local mesh, random, rows = part().mesh, check.random(3), {}
    local sliding = assert(part():slide(mesh.boundary:below("z", 0)):system())
    for i = 1, mesh.node_count do rows[i] = {random() - 0.5, random() - 0.5, random() - 0.5} end
    local u, v = assert(closed:solve(bw.array.new(rows))), assert(sliding:solve(bw.array.new(rows)))
    assert.truthy((u - v):max() <= 1e-8 * v:max() and (v - u):max() <= 1e-8 * v:max())
    -- a block on a plane, pressed on all of its other faces; a plane of symmetry is the same support, with the
    -- same loads. Soft springs hold the block where contact does not
    local block = bw.mesh.box {max = {0.04, 0.03, 0.02}, cells = {4, 3, 2}}
    local foot = block.boundary:below("z", 0)
    local function model()
      return bw.model {mesh = block, material = steel}:attach {on = foot, spring = {1e5, 1e5, 1e5}}
    end
    local opts = {force = 400 * (1 - 1e-9), pressure = 400 / (0.0012 + 2 * 0.02 * 0.07)}
    local slid = assert(bw.worst_case(assert(model():symmetry(foot)), opts))
    opts.pairs = {{on = foot, with = bw.rigid.plane {normal = {0, 0, 1}}}}
    local touching = assert(bw.worst_case(model(), opts))
    assert.equal(touching.contact.candidates, touching.touching)
    assert.truthy(touching.settled)
    check.near(slid.max_principal, touching.max_principal, 1e-8)
  end)

  it("is that of the free part where it lifts off, and not that of a glued one", function()
    local lever = bw.mesh.box {max = {0.1, 0.03, 0.01}, cells = {20, 4, 2}, order = 2}
    local tip = lever.boundary:below("z", 0) & lever.boundary:above("x", 0.0949)
    local function held() return bw.model {mesh = lever, material = steel}:fix(lever.boundary:below("x", 0)) end
    local load = {force = 20, contact = 5e-5, forbidden = lever.boundary:above("x", 0.0949)}
    local free, slid = assert(bw.worst_case(held(), load)), assert(bw.worst_case(held():slide(tip), load))
    load.pairs = {{on = tip, with = bw.rigid.plane {normal = {0, 0, 1}}}}
    local lifted = assert(bw.worst_case(held(), load))
    check.near(free.max_principal, lifted.max_principal, 1e-6)
    assert.truthy(slid.max_principal < 0.5 * lifted.max_principal)
    assert.equal(0, lifted.touching)
    assert.truthy(lifted.settled)
    local part, pairs_of = blocks(1, 0, true)
    local touching = assert(bw.worst_case(part(), with {pairs = pairs_of}))
    local glued = assert(bw.worst_case(part():bond {a = pairs_of[1].on, b = pairs_of[1].with}, limits))
    assert.truthy(glued.max_principal < 0.5 * touching.max_principal)
  end)

  it("closes a gap at the force at which the closed form does", function()
    -- a bar without Poisson's ratio on springs, a gap away from a plane, pressed at its other end: the springs
    -- alone take the force k d that closes the gap, and then k beside E A / L
    local k, gap, young = 3e5, 1e-5, 2e9
    local mesh = bw.mesh.box {max = {L, W, H}, cells = {6, 1, 1}, order = 2}
    local left, right = mesh.boundary:below("x", 0), mesh.boundary:above("x", L)
    local sides = mesh.boundary:below("y", 0) | mesh.boundary:above("y", W) | mesh.boundary:below("z", 0)
      | mesh.boundary:above("z", H)
    local stiffness = young * W * H / L
    local function found(force)
      local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = young, poisson = 0}}
      part:slide(mesh.boundary:below("y", 0)):slide(mesh.boundary:below("z", 0))
      local contact = assert(part:attach {on = right, spring = {k, 0, 0}}:contact_system {{on = left,
        with = bw.rigid.plane {point = {-gap, 0, 0}, normal = {1, 0, 0}}}})
      local basis = bw.pressure_basis(mesh, {cuts = left | sides})
      local pressure = {}
      for j = 1, basis.count do pressure[j] = force / (W * H) end
      local u, state = assert(contact:solve(basis:force(bw.array.new(pressure))))
      local stress = core.max_principal(core.element_stress(mesh, part.material, u))
      return u:column(1):min(), state:sum(), stress:max(), contact
    end
    -- open: the bar moves as a rigid body, without stress
    local moved, touching, stress, contact = found(0.9 * k * gap)
    assert.is_false(contact.closed)
    check.near(-0.9 * gap, moved, 1e-9)
    assert.equal(0, touching)
    assert.truthy(stress < 1e-3)
    -- closed: right end moves by u, k u + E A / L (u - d) = F
    local force = 3 * k * gap
    local u = (force + stiffness * gap) / (k + stiffness)
    moved, touching, stress, contact = found(force)
    check.near(-u, moved, 1e-9)
    assert.equal(contact.candidates, touching)
    check.near(stiffness * (u - gap) / (W * H), stress, 1e-8)
    assert.matches("with gaps or interference", tostring(contact))
  end)

  it("tries each sign of a functional by itself", function()
    local part = beam(1)()
    local system, basis = assert(part:system()), assert(bw.pressure_basis(part.mesh, {}))
    local function loads_of(sign, more)
      local opts = {force = limits.force, pressure = limits.force / limits.contact}
      for key, value in pairs(more) do opts[key] = value end
      return assert(core.worst_loads(system, basis, core.single_regions(part.mesh, nil, sign), opts))
    end
    local plus, both = loads_of(1, {one_sign = true}), loads_of(1, {})
    local minus, negative = loads_of(1, {one_sign = true, other_sign = true}), loads_of(-1, {one_sign = true})
    for i = 1, part.mesh.element_count do
      assert.equal(negative.objectives[i], minus.objectives[i])
      assert.equal(negative.peaks[i], minus.peaks[i])
      assert.equal(1, minus.flipped[i])
      assert.equal(math.max(plus.objectives[i], minus.objectives[i]), both.objectives[i])
    end
  end)

  it("has a factor, also where another analysis needs none", function()
    local part, pairs_of = blocks(1, 0, true)
    local solver = bw.solver.cholesky {precision = 32} -- of refinement to a tolerance
    local worst = assert(bw.worst_case(part(), with {pairs = pairs_of, solver = solver}))
    assert.equal("the equations have a factor by now", worst.system.report.reason)
    check.near(assert(bw.worst_case(part(), with {pairs = pairs_of})).max_principal, worst.max_principal, 1e-10)
    check.fails("unsupported", "solved by a factor, not by \"pcg\"",
      bw.worst_case(part(), with {pairs = pairs_of, solver = bw.solver.pcg {}}))
  end)

  it("is refused where it has no meaning, in a sentence", function()
    local part, pairs_of = blocks(1, 0, true)
    local function given(more)
      local pair = {on = pairs_of[1].on, with = pairs_of[1].with}
      for key, value in pairs(more) do pair[key] = value end
      return with {pairs = {pair}}
    end
    check.fails("unsupported", "contact pair 1 has friction", bw.worst_case(part(), given {friction = 0.2}))
    check.fails("unsupported", "a curved rigid surface",
      bw.worst_case(part(), given {with = bw.rigid.sphere {centre = {1, 0, 0}, radius = 0.5}}))
    local free, pairs_free = blocks(1, 0, false)
    check.fails("unconstrained", "contact alone constrains a body, which is free in the translation",
      bw.worst_case(free(), with {pairs = pairs_free}))
    check.raises("option 'certify' is for parts without contact", bw.worst_case, part(),
      with {pairs = pairs_of, certify = 0.1})
    check.raises("option 'length' is for parts without contact", bw.worst_case, part(),
      with {pairs = pairs_of, length = 0.01})
    check.raises("target \"stress\"", bw.worst_case, part(),
      with {pairs = pairs_of, target = "displacement", method = "paper"})
    check.raises("option 'pairs'", bw.worst_case, part(), with {pairs = 3})
    check.raises("a list of pairs", bw.worst_case, part(), with {pairs = {}})
    check.raises("unknown option 'pairs'", bw.brute_force, part(), with {pairs = pairs_of})
    check.raises("an edit session has no contact", require "barwright.worst_case".class.analyse, part(),
      with {pairs = pairs_of}, {})
  end)
end)
