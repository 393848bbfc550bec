-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst case of joined models (docs/theory/worst_case.md, section 16): cut bodies against whole ones, unit
-- loads one after the other, balance, and what is refused.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local L, W, H = 0.1, 0.02, 0.015
local steel = bw.material.steel

local function whole(order, cells)
  local mesh = bw.mesh.box {max = {L, W, H}, cells = cells or {8, 2, 2}, order = order}
  return bw.model {material = steel, mesh = mesh}
end

-- The same body, cut across in the middle and bonded: facets match.
local function cut_in_two(order)
  local mesh = assert(whole(order).mesh:split({max = {L / 2, 1, 1}}, "left")):separated "left"
  local part = bw.model {mesh = mesh, material = steel}
  local cut = mesh.boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9)
  part:bond {a = cut & mesh.boundary:region "left", b = cut & mesh.boundary:region "rest"}
  return part, cut
end

-- Two halves whose meshes do not match.
local function unlike_halves(order)
  local mesh = check.boxes(order, {{{0, 0, 0}, {L / 2, W, H}, {5, 2, 2}}, {{L / 2, 0, 0}, {L, W, H}, {6, 3, 3}}})
  local part = bw.model {mesh = mesh, material = steel}
  local cut = mesh.boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9)
  part:bond {a = cut:facing {1, 0, 0}, b = cut:facing {-1, 0, 0}}
  return part, cut
end

local limits = {force = 50, contact = 1e-4}

local function with(more)
  local opts = {}
  for key, value in pairs(limits) do opts[key] = value end
  for key, value in pairs(more or {}) do opts[key] = value end
  return opts
end

-- Stress by place: rows {x, y, z, value} of element centres, sorted.
local function by_place(mesh, values)
  local rows, nodes, elements = {}, mesh.nodes:totable(), mesh.elements:totable()
  for e, row in ipairs(elements) do
    local x = {0, 0, 0}
    for a = 1, 4 do
      for k = 1, 3 do x[k] = x[k] + nodes[row[a]][k] / 4 end
    end
    rows[e] = {math.tointeger(x[1] // 1e-9), math.tointeger(x[2] // 1e-9 + 0), x[3], values[e]}
  end
  table.sort(rows, function(a, b)
    for k = 1, 2 do
      if math.abs(a[k] - b[k]) > 2 then return a[k] < b[k] end
    end
    return a[3] < b[3]
  end)
  return rows
end

local function assert_balanced(worst, i)
  local mesh, force = worst.mesh, worst:force(i)
  local sums, nodes = force:column_sums(), mesh.nodes
  local moment = {0, 0, 0}
  for n = 1, mesh.node_count do
    local x, f = nodes[n], force[n]
    moment[1] = moment[1] + x[2] * f[3] - x[3] * f[2]
    moment[2] = moment[2] + x[3] * f[1] - x[1] * f[3]
    moment[3] = moment[3] + x[1] * f[2] - x[2] * f[1]
  end
  for k = 1, 3 do
    assert.truthy(math.abs(sums[k]) < 1e-6 * limits.force, "force " .. sums[k])
    assert.truthy(math.abs(moment[k]) < 1e-6 * limits.force * L, "moment " .. moment[k])
  end
end

describe("the worst case of a joined body", function()
  -- Pressure may jump where the cut meets the surface, so it is kept off the facets there: then both bodies admit
  -- the same loads.
  for order = 1, 2 do
    for _, held in ipairs {true, false} do
      it(("is that of the whole body, order %d, %s"):format(order, held and "held" or "free"), function()
        local found = {}
        for k, part in ipairs {whole(order), (cut_in_two(order))} do
          local boundary = part.mesh.boundary
          if held then part:fix(boundary:below("x", 0)) end
          local ring = boundary:box({0.36 * L, -1, -1}, {0.64 * L, 1, 1})
          local opts = with {forbidden = ring}
          local worst, brute = assert(bw.worst_case(part, opts)), assert(bw.brute_force(part, opts))
          found[k] = {worst = worst, map = by_place(part.mesh, brute.weakness), brute = brute.max_principal,
            pressed = worst.basis.areas:sum(), modes = worst.modes.frequencies,
            motions = worst.system.rigid_mode_count}
          if not held then assert_balanced(worst) end
        end
        local one, two = found[1], found[2]
        assert.equal(held and 0 or 6, two.motions)
        assert.equal(one.motions, two.motions)
        check.near(one.worst.max_principal, two.worst.max_principal, 1e-8)
        check.near(one.brute, two.brute, 1e-8)
        check.near(one.worst.max_displacement, two.worst.max_displacement, 1e-8)
        check.near(one.pressed, two.pressed, 1e-12)
        for i = 1, 6 do check.near(one.modes[i], two.modes[i], 1e-6) end
        for e, row in ipairs(one.map) do
          assert.truthy(math.abs(row[4] - two.map[e][4]) <= 1e-8 * one.brute, "element " .. e)
        end
        -- the same pressure on both gives the same largest stress, and is the sorted list of the same pressures
        local p = one.worst.pressures[one.worst.region]:totable()
        local q = two.worst.pressures[two.worst.region]:totable()
        table.sort(p)
        table.sort(q)
        assert.equal(#p, #q)
        for j = 1, #p do assert.truthy(math.abs(p[j] - q[j]) <= 1e-6 * p[#p], "pressure " .. j) end
      end)
    end
  end

  it("is near that of the whole body where the meshes do not match", function()
    for order = 1, 2 do
      for _, held in ipairs {true, false} do
        local found = {}
        for k, part in ipairs {whole(order, {12, 3, 3}), (unlike_halves(order))} do
          if held then part:fix(part.mesh.boundary:below("x", 0)) end
          local worst = assert(bw.worst_case(part, limits))
          found[k] = worst.weakness:quantile(0.95, part.mesh.volumes)
        end
        check.near(found[1], found[2], order == 1 and 0.25 or 0.1)
      end
    end
  end)

  it("presses on no covered face, and says so", function()
    for _, make in ipairs {cut_in_two, unlike_halves} do
      local part, cut = make(1)
      local worst = assert(bw.worst_case(part, limits))
      check.near(2 * (L * W + L * H + W * H), worst.basis.areas:sum(), 1e-12)
      check.near(2 * W * H, cut.area, 1e-12)
      local force, mesh = worst:force(), part.mesh
      for n = 1, mesh.node_count do
        local x = mesh.nodes[n]
        local inside = math.abs(x[1] - L / 2) < 1e-9 and x[2] > 1e-9 and x[2] < W - 1e-9 and x[3] > 1e-9
          and x[3] < H - 1e-9
        if inside then
          for k = 1, 3 do assert.equal(0, force[n][k]) end
        end
      end
      assert.truthy(tostring(worst):find("no pressure on 6 cm2 of bonds;", 1, true),
        tostring(worst))
      assert_balanced(worst)
    end
  end)

  it("leaves what a bond covers in part to the outside", function()
    -- a boss on a plate: the plate's face around it is surface
    local mesh = check.boxes(1, {{{0, 0, 0}, {0.06, 0.06, 0.01}, {6, 6, 1}},
      {{0.02, 0.02, 0.01}, {0.04, 0.04, 0.03}, {3, 3, 3}}})
    local part = bw.model {mesh = mesh, material = steel}
    local plane = mesh.boundary:plane({0, 0, 0.01}, {0, 0, 1}, 1e-9)
    part:bond {a = plane:facing {0, 0, -1}, b = plane:facing {0, 0, 1}}
    local worst = assert(bw.worst_case(part, limits))
    check.near(2 * 0.06 ^ 2 + 4 * 0.06 * 0.01 + 4 * 0.02 * 0.02, worst.basis.areas:sum(), 1e-12)
    assert.equal(6, worst.system.rigid_mode_count)
    assert_balanced(worst)
  end)

  it("is what unit loads give that are solved one after the other", function()
    local mesh = check.boxes(1, {{{0, 0, 0}, {L / 2, W, H}, {2, 1, 1}}, {{L / 2, 0, 0}, {L, W, H}, {2, 2, 1}}})
    local function part_of()
      local part = bw.model {mesh = mesh, material = steel}
      local cut = mesh.boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9)
      return part:fix(mesh.boundary:below("x", 0)), part:bond {a = cut:facing {1, 0, 0}, b = cut:facing {-1, 0, 0}}
    end
    local part = part_of()
    local basis = assert(bw.pressure_basis(mesh, {cuts = core.cuts(part)}))
    local responses = {}
    for j = 1, basis.count do
      local unit = {}
      for i = 1, basis.count do unit[i] = i == j and 1e5 or 0 end
      local loaded = part_of()
      loaded:load {nodal = basis:force(bw.array.new(unit))}
      responses[j] = core.element_stress(mesh, steel, assert(loaded:solve()).displacement):totable()
    end
    local max, areas = limits.force / limits.contact, basis.areas
    -- the load of the largest trace in an element, of either sign: full pressure where the gain by area is largest
    local function stress_of(e, sign, row)
      local order, left, stress = {}, limits.force, {0, 0, 0, 0, 0, 0}
      for j = 1, basis.count do order[j] = j end
      local function trace(j) return responses[j][e][1] + responses[j][e][2] + responses[j][e][3] end
      local function gain(j) return sign * trace(j) / areas[j] end
      table.sort(order, function(a, b) return gain(a) > gain(b) end)
      local objective = 0
      for _, j in ipairs(order) do
        local p = math.min(max, left / areas[j])
        left = left - p * areas[j]
        objective = objective + sign * p * trace(j)
        for k = 1, 6 do stress[k] = stress[k] + p / 1e5 * responses[j][row or e][k] end
      end
      return objective, stress
    end
    local brute = assert(bw.brute_force(part, limits))
    local largest = 0
    for e = 1, mesh.element_count do
      local plus, minus = stress_of(e, 1), stress_of(e, -1)
      local sign = minus > plus and -1 or 1
      for row = 1, mesh.element_count do
        local _, stress = stress_of(e, sign, row)
        largest = math.max(largest, core.max_principal(bw.array.new {stress})[1])
      end
    end
    check.near(largest, brute.max_principal, 1e-9)
    -- and its own solution of a load is the static one
    local worst = assert(bw.worst_case(part, limits))
    local loaded = part_of()
    loaded:load {nodal = worst:force()}
    local static = assert(loaded:solve())
    local u, v = worst:displacement(), static.displacement
    assert.truthy((u - v):max() <= 1e-10 * v:max() and (v - u):max() <= 1e-10 * v:max())
  end)

  it("bounds random admissible loads, with its upper bound", function()
    local part = unlike_halves(1)
    part:fix(part.mesh.boundary:below("x", 0))
    local worst = assert(bw.worst_case(part, with {certify = 0.05}))
    assert.truthy(worst.upper_bound >= worst.max_principal and worst.gap <= 0.05 + 1e-9)
    local random, basis, highest = check.random(7), worst.basis, limits.force / limits.contact
    local reached = 0
    for _ = 1, 100 do
      local p, total, sharp = {}, 0, 1 + 7 * random()
      local order = {}
      for j = 1, basis.count do
        p[j] = 0
        order[j] = {j, random() ^ sharp + basis.areas[j] * random()}
      end
      table.sort(order, function(a, b) return a[2] > b[2] end)
      for _, pair in ipairs(order) do
        local value = math.min(highest, (limits.force - total) / basis.areas[pair[1]])
        p[pair[1]] = value
        total = total + value * basis.areas[pair[1]]
        if total >= limits.force * (1 - 1e-12) then break end
      end
      local u = assert(worst.system:solve(basis:force(bw.array.new(p))))
      local stress = core.max_principal(core.element_stress(part.mesh, steel, u)):max()
      assert.truthy(stress <= worst.upper_bound * (1 + 1e-9))
      reached = math.max(reached, stress)
    end
    assert.truthy(reached > 0.05 * worst.max_principal)
  end)

  it("knows couplings and springs", function()
    local clamped, coupled, sprung = whole(1), whole(1), whole(1)
    clamped:fix(clamped.mesh.boundary:below("x", 0))
    coupled:couple {on = coupled.mesh.boundary:below("x", 0), kind = "rigid", displacement = {0, 0, 0},
      rotation = {0, 0, 0}}
    sprung:attach {on = sprung.mesh.boundary:below("x", 0), spring = {1e15, 1e15, 1e15}}
    local forbidden = {}
    for i, part in ipairs {clamped, coupled, sprung} do forbidden[i] = part.mesh.boundary:below("x", 0) end
    local one = assert(bw.worst_case(clamped, with {forbidden = forbidden[1]}))
    for i, part in ipairs {coupled, sprung} do
      local other = assert(bw.worst_case(part, with {forbidden = forbidden[i + 1]}))
      check.near(one.max_principal, other.max_principal, i == 1 and 1e-8 or 1e-3)
    end
    -- a mass changes modes, and no static load; a point that nothing holds leaves the body free
    local plain, heavy, pointed = whole(1), whole(1), whole(1)
    heavy:attach {on = heavy.mesh.boundary:above("x", L), mass = 0.2}
    pointed:couple {on = pointed.mesh.boundary:above("x", L), kind = "distributed", force = {0, 0, 7}}
    local free = assert(bw.brute_force(plain, limits))
    for _, part in ipairs {heavy, pointed} do
      check.near(free.max_principal, assert(bw.brute_force(part, limits)).max_principal, 1e-8)
      local worst = assert(bw.worst_case(part, limits))
      assert.equal(6, worst.system.rigid_mode_count)
      assert_balanced(worst)
    end
    local slow, fast = assert(heavy:modes {count = 1}), assert(plain:modes {count = 1})
    assert.truthy(slow.frequencies[1] < 0.9 * fast.frequencies[1])
  end)

  it("is refused where it has no meaning, in a sentence", function()
    local part = unlike_halves(1)
    for _, name in ipairs {"certificate", "length", "laplacian"} do
      local opts = with {[name] = name == "laplacian" or name == "length" and 0.005 or "file",
        certify = name == "certificate" and 0.1 or nil}
      check.raises("option '" .. name .. "' is for parts without bonds", bw.worst_case, part, opts)
    end
    check.fails("unsupported", "solved by a factor, not by \"pcg\"",
      bw.worst_case(part, with {solver = bw.solver.pcg {}}))
    -- pieces that are free of each other
    local apart = check.boxes(1, {{{0, 0, 0}, {L / 2, W, H}, {2, 1, 1}}, {{L / 2, 0, 0}, {L, W, H}, {2, 1, 1}},
      {{2 * L, 0, 0}, {3 * L, W, H}, {2, 1, 1}}})
    local loose = bw.model {mesh = apart, material = steel}
    local cut = apart.boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9)
    loose:bond {a = cut:facing {1, 0, 0}, b = cut:facing {-1, 0, 0}}
    check.fails("unconstrained", "some bodies move against one another", bw.worst_case(loose, limits))
    -- a gap across which the bond resists rotation, but not of a body that is held
    local gap = 1e-4
    local open = check.boxes(1, {{{0, 0, 0}, {L / 2, W, H}, {2, 1, 1}},
      {{L / 2 + gap, 0, 0}, {L, W, H}, {2, 1, 1}}})
    local function closed()
      local model = bw.model {mesh = open, material = steel}
      model:bond {a = open.boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9),
        b = open.boundary:plane({L / 2 + gap, 0, 0}, {1, 0, 0}, 1e-9), gap = 1e-3}
      return model
    end
    check.fails("geometry", "resists a rotation of the joined body", bw.worst_case(closed(), limits))
    local held = closed()
    held:fix(open.boundary:below("x", 0))
    assert(bw.worst_case(held, limits))
    -- strains without a load
    local mesh = part.mesh
    local pulled = bw.model {mesh = mesh, material = steel}
    cut = mesh.boundary:plane({L / 2, 0, 0}, {1, 0, 0}, 1e-9)
    pulled:bond {a = cut:facing {1, 0, 0}, b = cut:facing {-1, 0, 0}, preload = 100}
    check.fails("unsupported", "bond 1 has a preload", bw.worst_case(pulled, limits))
    local moved = whole(1)
    moved:couple {on = moved.mesh.boundary:below("x", 0), kind = "rigid", displacement = {1e-3, 0, 0},
      rotation = {0, 0, 0}}
    check.fails("unsupported", "coupling 1 has a prescribed motion", bw.worst_case(moved, limits))
    -- a sector, whichever options are given
    local box = bw.mesh.box {max = {W, W, H}, cells = {2, 2, 1}, order = 1}
    local sector = bw.model {mesh = box, material = steel}
    sector:cyclic {low = box.boundary:below("y", 0), high = box.boundary:below("x", 0), count = 4}
    for _, more in ipairs {{}, {length = 1e-3}} do
      check.fails("unsupported", "one of 4 sectors", bw.worst_case(sector, with(more)))
    end
    -- its equations have no matrices and modes
    local worst = assert(bw.worst_case(part, limits))
    check.fails("unsupported", "those of a joined model", worst.system:modes {count = 2})
  end)
end)

describe("a plane of symmetry", function()
  it("takes no pressure", function()
    for order = 1, 2 do
      local mesh = bw.mesh.box {max = {L / 2, W, H}, cells = {4, 2, 2}, order = order}
      local half = bw.model {material = steel, mesh = mesh}
      local plane = half.mesh.boundary:above("x", L / 2)
      half:symmetry(plane)
      local worst = assert(bw.worst_case(half, limits))
      local outer = 2 * (L / 2 * W + L / 2 * H) + W * H
      check.near(outer, worst.basis.areas:sum(), 1e-12)
      -- its loads, mirrored, are loads of the whole: the half has no more stress than that
      local both = assert(bw.worst_case(whole(order), with {force = 2 * limits.force, contact = 2 * limits.contact,
        certify = 0.05}))
      assert.truthy(worst.max_principal <= both.upper_bound * (1 + 1e-9))
      local brute = assert(bw.brute_force(half, limits))
      assert.truthy(brute.max_principal <= both.upper_bound * (1 + 1e-9))
      check.raises("option 'certificate' is for parts without planes of symmetry", bw.worst_case, half,
        with {certify = 0.1, certificate = os.tmpname()})
    end
  end)
end)
