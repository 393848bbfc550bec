-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Decks of joined models by CalculiX (ccx): the same displacements to its seven digits, and the same frequencies.
-- Skipped without ccx.
local bw = require "barwright"
local check = require "check"

local function has_ccx() return os.execute "command -v ccx > /dev/null 2>&1" end

-- Two boxes along x whose cells do not match.
local function bar(order, turned, material)
  local mesh = check.boxes(order, {{{0, 0, 0}, {1, 0.5, 0.5}, {3, 2, 2}}, {{1, 0, 0}, {2, 0.5, 0.5}, {4, 3, 3}}},
    turned and function(p) return {0.8 * p[1] - 0.6 * p[2], 0.6 * p[1] + 0.8 * p[2], p[3]} end)
  local along = turned and {0.8, 0.6, 0} or {1, 0, 0}
  local across = turned and {-0.6, 0.8, 0} or {0, 1, 0}
  local boundary = mesh.boundary
  local cut = boundary:plane(along, along, 1e-9)
  local function reverse(v) return {-v[1], -v[2], -v[3]} end
  return {mesh = mesh, part = bw.model {mesh = mesh, material = material or bw.material.steel},
    left = cut:facing(along, 0.1), right = cut:facing(reverse(along), 0.1),
    root = boundary:plane({0, 0, 0}, along, 1e-9),
    far = boundary:plane({2 * along[1], 2 * along[2], 0}, along, 1e-9), top = boundary:above("z", 0.5),
    side = boundary:plane({0, 0, 0}, across, 1e-9), bottom = boundary:below("z", 0)}
end

local function run(part, options)
  local stem = os.tmpname()
  assert(part:write_inp(stem .. ".inp", options))
  os.execute(("cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1"):format(stem, stem))
  local lines = {}
  for line in assert(io.open(stem .. ".dat")):lines() do lines[#lines + 1] = line end
  os.execute(("rm -f '%s' '%s'.*"):format(stem, stem))
  return lines
end

-- Those of the first five modes.
local function frequencies(part)
  local found = {}
  for _, line in ipairs(run(part, {modes = 5})) do
    local number, value = line:match "^%s+(%d+)%s+(%d%.%d+E[+-]%d+)%s+%S+%s+%S+"
    number = tonumber(number)
    if number then found[number] = found[number] or math.sqrt(tonumber(value)) / (2 * math.pi) end
  end
  return found
end

-- The largest difference of displacements over the largest displacement.
local function difference(part)
  local static, worst, largest, found = assert(part:solve()), 0, 0, 0
  local nodes, points = part.mesh.node_count, {}
  for _, line in ipairs(run(part)) do
    local node, x, y, z = line:match "^%s+(%d+)%s+(%S+)%s+(%S+)%s+(%S+)%s*$"
    node = tonumber(node)
    if node and node > nodes then points[node - nodes] = {tonumber(x), tonumber(y), tonumber(z)} end
    if node and node <= nodes then
      found = found + 1
      for k, text in ipairs {x, y, z} do
        local own = static.displacement(node, k)
        worst, largest = math.max(worst, math.abs(own - tonumber(text))), math.max(largest, math.abs(own))
      end
    end
  end
  assert.equal(nodes, found)
  return worst / largest, static, points
end

describe("joined models in CalculiX", function()
  if not has_ccx() then return end

  it("bend a bonded bar as here, with planes of symmetry across the bond", function()
    for order = 1, 2 do
      for _, turned in ipairs {false, true} do
        for side = 1, 2 do
          local b = bar(order, turned)
          b.part:fix(b.root):symmetry(b.side):symmetry(b.bottom)
          b.part:bond {a = side == 1 and b.left or b.right, b = side == 1 and b.right or b.left}
          b.part:load {on = b.far, force = {1e4, 2e4, 3e4}}:gravity {1, 2, -9.81}
          assert.is_true(difference(b.part) < 1e-6)
        end
      end
    end
  end)

  it("move side a of a bond by what supports prescribe there", function()
    local b = bar(2, false)
    b.part:fix(b.root):bond {a = b.right, b = b.left}
    b.part:prescribe(b.bottom & b.mesh.boundary:above("x", 1), {false, false, 1e-4})
    assert.is_true(difference(b.part) < 1e-6)
  end)

  it("move the point of a rigid coupling, with a face that follows it across a bond", function()
    local b = bar(1, true)
    b.part:bond {a = b.right, b = b.left}:couple {on = b.root, kind = "rigid", at = {0, 0.2, 1},
      displacement = {1e-4, 2e-4, 0}, rotation = {1e-4, 0, 3e-4}}
    b.part:load {on = b.far, force = {1e4, 0, 1e4}}
    assert.is_true(difference(b.part) < 1e-6)
  end)

  it("pull a preload", function()
    for _, pull in ipairs {{preload = 3e4}, {shortening = 2e-5}} do
      local b = bar(2, true)
      b.part:fix(b.root):fix(b.far)
      b.part:bond {a = b.right, b = b.left, preload = pull.preload, shortening = pull.shortening}
      b.part:load {on = b.top, force = {0, 0, 1e4}}
      assert.is_true(difference(b.part) < 1e-6)
    end
  end)

  it("hold and load remote points, and springs", function()
    for order = 1, 2 do
      local b = bar(order, order == 2)
      b.part:bond {a = b.right, b = b.left}
      b.part:couple {on = b.root, kind = "rigid", at = {-0.3, 0.2, 0.1}, displacement = {0, 0, false},
        rotation = {0, false, 0}, force = {0, 0, 100}, spring = {0, 0, 1e8}, rotational_spring = {0, 1e7, 0}}
      b.part:couple {on = b.far, kind = "distributed", at = {2.5, 0.2, 0.3}, force = {1e3, 2e3, -3e3},
        moment = {300, 200, 100}, spring = {1e7, 0, 2e7}, rotational_spring = {0, 1e6, 0}, mass = 20}
      b.part:attach {on = b.top, spring = {1e8, 2e8, 3e8}}:attach {on = b.bottom, mass = 100}
      b.part:gravity {3, 0, -9.81}
      local far, static, points = difference(b.part)
      assert.is_true(far < 1e-6, far)
      for i, coupling in ipairs(static.couplings) do -- two nodes each, in their order
        for k = 1, 3 do
          for n, own in ipairs {coupling.displacement[k], coupling.rotation[k]} do
            assert.is_true(math.abs(own - points[2 * i - 2 + n][k]) < 1e-6 * (1e-5 + math.abs(own)))
          end
        end
      end
    end
  end)

  it("name springs of which CalculiX leaves a part out, across a bond too", function()
    for case = 1, 4 do
      local b = bar(1, false)
      local strip = b.left:below("z", 0.3)
      b.part:fix(b.root):attach {on = b.right, spring = {1e10, 0, 1e9}}:load {on = b.top, force = {0, 0, 1e4}}
      b.part:bond {a = b.right, b = b.left, shortening = case == 1 and 2e-5 or nil,
        preload = case == 4 and 3e4 or nil}
      if case == 2 then b.part:prescribe(strip, {false, false, 1e-4}) end
      if case == 3 then
        b.part:couple {on = strip, kind = "rigid", displacement = {0, 0, 1e-4}, rotation = {0, 0, 0}}
      end
      if case == 4 then b.part:fix(b.far) end
      bw.warnings()
      local far = difference(b.part)
      local warnings = table.concat(bw.warnings(), " ")
      if case == 4 then
        assert.is_true(far < 1e-6 and warnings == "", warnings)
      else
        assert.is_true(far > 1e-5, far)
        assert.matches("attachment 1 is on nodes that supports, a rigid coupling or a shortening", warnings)
      end
    end
  end)

  it("vibrate with masses, inertia and springs", function()
    -- light: CalculiX integrates the mass of elements with fewer points, and differs without joints too
    local b = bar(2, true, bw.material.isotropic {young = 2e11, poisson = 0.3, density = 0.1})
    b.part:fix(b.root):bond {a = b.right, b = b.left, preload = 100}
    b.part:couple {on = b.far, kind = "rigid", at = {2.5, 1.2, 0.3}, mass = 300,
      inertia = {30, 40, 25, 3, 1, 2}}
    b.part:attach {on = b.top, mass = 500}:attach {on = b.side, spring = {1e9, 0, 1e9}}
    local modes, found = assert(b.part:modes {count = 5}), frequencies(b.part)
    for k = 1, 5 do check.near(modes.frequencies[k], found[k], 1e-6) end
  end)

  it("vibrate higher there by what the mass of elements lacks, bonded or in one piece", function()
    for order, limits in ipairs {{1e-3, 6e-2}, {1e-6, 1e-4}} do
      local box, parts = bw.mesh.box {max = {2, 0.5, 0.5}, cells = {8, 2, 2}, order = order}, {}
      local halves = assert(box:split({max = {1, 0.5, 0.5}}, "left")):separated "left"
      for i, mesh in ipairs {box, halves} do
        parts[i] = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below("x", 0))
      end
      local cut = halves.boundary:plane({1, 0, 0}, {1, 0, 0}, 1e-9)
      parts[2]:bond {a = cut:facing({1, 0, 0}, 0.1), b = cut:facing({-1, 0, 0}, 0.1)}
      for _, part in ipairs(parts) do
        local modes, found = assert(part:modes {count = 5, tolerance = 1e-10}), frequencies(part)
        for k = 1, 5 do
          local higher = found[k] / modes.frequencies[k] - 1
          assert.is_true(higher > limits[1] and higher < 1.05 * limits[2], higher)
        end
      end
    end
  end)

  it("come back as a mesh, without what is passed over", function()
    local b = bar(2, false)
    b.part:fix(b.root):bond {a = b.right, b = b.left}
    b.part:couple {on = b.far, force = {1, 0, 0}}:attach {on = b.top, mass = 1}
    local path = os.tmpname() .. ".inp"
    assert(b.part:write_inp(path, {modes = 1}))
    local mesh, about = assert(bw.mesh.read(path))
    os.remove(path)
    check.same(b.mesh.nodes, mesh.nodes, 0)
    assert.truthy(about.sets.NALL and about.sets.NJOINTS)
    assert.is_true(about.skipped > 0)
  end)

  it("are refused where a deck cannot have them, or nothing holds them", function()
    local path = os.tmpname()
    local b = bar(1, false)
    b.part:bond {a = b.right, b = b.left}
    check.fails("unconstrained", "leave 6 rigid-body modes unconstrained", b.part:write_inp(path))
    b.part:couple {on = b.root, kind = "distributed", displacement = {0, 0, 0}, rotation = {0, 0, 0}}
    check.fails("unsupported", "the distributed coupling 1 has prescribed values", b.part:write_inp(path))
    b.part:clear_couplings():couple {on = b.root, kind = "rigid", mass = 1, inertia = {1, 1, 5}}
    check.fails("unsupported", "larger than the sum of the other two", b.part:write_inp(path, {modes = 2}))
    os.remove(path)
  end)
end)
