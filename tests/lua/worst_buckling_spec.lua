-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The load that buckles a part first: Euler's column, random loads of small bodies, what is certain of an answer.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"

local folder = check.folder() .. "/"
local L, a, b = 0.5, 0.01, 0.02
local E = 200e9
local euler = math.pi ^ 2 * E * b * a ^ 3 / 12 / (4 * L ^ 2)

-- Without transverse contraction, which a clamped end would hold back.
local function column(supported)
  local mesh = bw.mesh.box {max = {L, a, b}, cells = {24, 2, 3}, order = 2}
  local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = E, poisson = 0}}
  if supported then part:fix(mesh.boundary:below("x", 0)) end
  return part, mesh
end

local function plate()
  local mesh = bw.mesh.box {max = {0.2, 0.1, 0.004}, cells = {8, 4, 1}, order = 2}
  local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = E, poisson = 0.3}}
  return part:fix(mesh.boundary:below("x", 0)), mesh
end

-- The factor of a load by another way: its nodal forces on the part.
local function factor_again(part, worst, sign)
  part:clear_loads():load {nodal = worst:nodal_force()}
  return assert(part:buckling {count = 1, sign = sign or "positive", loads_turn = true}).factors[1]
end

describe("worst-case buckling", function()
  it("finds Euler's load where only the end of a column may be pressed, and where all of it may", function()
    for whole = 0, 1 do
      local part, mesh = column(true)
      local sides = mesh.boundary:difference(mesh.boundary:above("x", L))
      local worst = assert(bw.worst_buckling(part, {force = 100, contact = a * b,
        forbidden = whole == 0 and sides or nil}))
      check.near(euler, worst.force, 0.005)
      assert.is_true(worst.counted)
      assert.is_true(worst.error < 1e-6 * worst.factor)
      local total = 0
      for _, arrow in ipairs(worst:arrows()) do
        total = total - arrow.force[1]
        check.near(L, arrow.at[1], 1e-9)
      end
      check.near(100, total, 1e-6)
      check.near(worst.factor, factor_again(part, worst), 1e-8)
    end
  end)

  it("compresses a free bar as a column with pinned ends", function()
    local part = column(false)
    local worst = assert(bw.worst_buckling(part, {force = 200, contact = 2 * a * b}))
    check.near(4 * euler, worst.force / 2, 0.005)
    assert.is_false(worst.counted)
    check.near(worst.factor, factor_again(part, worst), 1e-8)
    local none, message, details = part:buckling {count = 1}
    assert.is_nil(none)
    assert.equal("unconstrained", details.status)
    assert.truthy(message:find("turn with the body", 1, true), message)
  end)

  -- Vertices of the admissible loads from random directions, and ascents from them by the first shape alone.
  local function random_search(worst, sign, count, random)
    local system, basis = worst.system, worst.basis
    local best = 0
    local function value_of(pressure)
      local u = assert(system:solve(basis:force(pressure)))
      local found, buckling = pcall(system.buckling, system, u, {count = 1, sturm = false, loads_turn = true,
        sign = sign > 0 and "positive" or "negative"})
      if not found or buckling.count == 0 then return 0 end -- a load on supports alone causes no stress
      best = math.max(best, 1 / math.abs(buckling.factors[1]))
      return 1 / math.abs(buckling.factors[1]), buckling:shape(1)
    end
    for i = 1, count do
      local objective = {}
      for k = 1, i % 2 == 0 and basis.count or worst.mesh.node_count do
        objective[k] = i % 2 == 0 and random() - 0.5
          or {random() - 0.5, random() - 0.5, random() - 0.5}
      end
      objective = core.array.new(objective)
      if i % 2 == 1 then objective = basis:gradient(assert(system:solve(objective))) end
      local value, shape = value_of((assert(basis:maximise(system, objective, worst.limits))))
      while shape do
        local gradient, work = core.stress_stiffness_gradient(system, shape)
        local slope = basis:gradient(assert(system:solve(gradient))) * (-sign / work)
        local pressure, promised = assert(basis:maximise(system, slope, worst.limits))
        if promised <= value * (1 + 1e-6) then break end
        local reached
        reached, shape = value_of(pressure)
        assert.is_true(reached >= promised * (1 - 1e-6), "an ascent descends")
        value = reached
      end
    end
    return best
  end

  it("is not beaten by random loads of small bodies, of either sign", function()
    local random = check.random(11)
    for i = 1, 4 do
      local part, mesh = plate()
      if i == 3 then part:clear_supports() end
      local sign = i == 2 and -1 or 1
      local worst = assert(bw.worst_buckling(part, {force = 100, pressure = 2e5,
        friction = i == 4 and 0.3 or nil, sign = sign > 0 and "positive" or "negative",
        forbidden = i == 4 and mesh.boundary:above("z", 0.004) or nil}))
      assert.is_true(worst.factor * sign > 0)
      local best = random_search(worst, sign, 12, random)
      assert.is_true(best * math.abs(worst.factor) <= 1 + 1e-6, ("%d: %g, %g"):format(i, best, worst.factor))
      check.near(worst.factor, factor_again(part, worst, sign > 0 and "positive" or "negative"), 1e-8)
      local nodal = worst.basis:force(worst.loads[1].pressure)
      if i < 4 then check.near(100, worst.basis.areas:dot(worst.loads[1].pressure), 1e-8) end
      if i == 3 then assert.is_true(math.abs(nodal:column(3):sum()) < 1e-6) end
    end
  end)

  it("takes the smaller size of both signs", function()
    local part = plate()
    local function factor(sign)
      return assert(bw.worst_buckling(part, {force = 100, sign = sign, modes = 8, ascents = 2})).factor
    end
    local positive, negative, either = factor "positive", factor "negative", factor "either"
    assert.is_true(positive > 0 and negative < 0)
    check.near(math.min(positive, -negative), math.abs(either), 1e-6)
  end)

  it("has the same bits on any number of threads", function()
    local before = bw.threads()
    local pressures, factors = {}, {}
    for threads = 1, 3 do
      bw.threads(threads)
      local worst = assert(bw.worst_buckling(plate(), {force = 100, modes = 6, ascents = 2}))
      factors[threads], pressures[threads] = worst.factor, worst.loads[1].pressure
    end
    bw.threads(before)
    for threads = 2, 3 do
      assert.equal(factors[1], factors[threads])
      assert.equal(0, core.array.map("abs(a - b)", {a = pressures[1], b = pressures[threads]}):max())
    end
  end)

  it("prints, writes and draws the answer", function()
    local worst = assert(bw.worst_buckling(plate(), {force = 100, modes = 6, ascents = 2}))
    local text = tostring(worst)
    assert.truthy(text:find("another load may have a smaller one", 1, true), text)
    assert.truthy(text:find("counted: this load has no smaller factor", 1, true), text)
    assert(worst:picture(folder .. "worst.png", {width = 200, height = 150}))
    assert(worst:write(folder .. "worst.vtu"))
    local _, fields = assert(bw.mesh.read(folder .. "worst.vtu"))
    assert.truthy(fields)
    assert.equal(worst.buckling, worst:factors())
    if #worst.loads > 1 then
      check.near(worst.loads[2].factor, assert(worst:factors(2)).factors[1], 1e-8)
    end
    assert.equal(worst.mesh.node_count, worst:pressure().row_count)
    worst:close()
    assert.equal("worst-case buckling (closed)", tostring(worst))
    assert.has_error(function() worst:pressure() end)
  end)

  it("says in each answer that no load was found", function()
    local mesh = bw.mesh.box {max = {0.1, 0.02, 0.02}, cells = {4, 1, 1}, order = 2}
    local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary)
    local worst = assert(bw.worst_buckling(part, {force = 1, contact = 1e-4}))
    assert.is_nil(worst.factor)
    for name, give in pairs {write = function() return worst:write(folder .. "none.vtu") end,
      picture = function() return worst:picture(folder .. "none.png") end,
      factors = function() return worst:factors() end, pressure = function() return worst:pressure() end} do
      check.raises(name .. ": no load was found that buckles the part", give)
    end
  end)

  it("refuses what it does not know", function()
    local part, mesh = column(true)
    check.misuses {
      ["got both"] = function() bw.worst_buckling(part, {pressure = 1, contact = 1}) end,
      ["option 'modes'"] = function() bw.worst_buckling(part, {modes = 31}) end,
      ["option 'sign'"] = function() bw.worst_buckling(part, {sign = "up"}) end,
      ["model expected"] = function() bw.worst_buckling(mesh) end,
    }
    local none, message, details = bw.worst_buckling(part, {force = 1e6, pressure = 1})
    assert.is_nil(none)
    assert.equal("infeasible", details.status, message)
    part:clear_supports():fix(mesh.boundary:below("x", 0))
    part:prescribe(mesh.boundary:above("x", L), {1e-6, false, false})
    none, message, details = bw.worst_buckling(part, {force = 1})
    assert.is_nil(none)
    assert.equal("unsupported", details.status, message)
  end)
end)

describe("barwright buckle --worst", function()
  local path = folder .. "strut.msh"
  setup(function()
    assert(bw.mesh.box({max = {L, a, b}, cells = {24, 1, 2}, order = 2}):write(path))
  end)

  it("gives the load, of a supported and of a free part", function()
    local status, out = check.run("buckle --json --material steel --fix min:x --forbid min:x --worst 100N "
      .. "--contact 2cm2 --count 2 " .. path)
    local object = bw.json.decode(out)
    assert.same({1, "unsure"}, {status, object.verdict}) -- the search is heuristic
    check.near(bw.material.steel.young / E * euler, object.buckling_force_n, 0.02)
    status, out = check.run("buckle --json --material steel --worst 50kN --contact 2cm2 " .. path)
    object = bw.json.decode(out)
    assert.equal(1, status)
    assert.equal("buckles", object.verdict)
    check.near(4 * bw.material.steel.young / E * euler, object.buckling_force_n, 0.02)
  end)

  it("writes files, and says that the search is heuristic", function()
    local status, out = check.run(("buckle %s --material steel --fix min:x --worst 100N --count 1 "
      .. "--picture %sw.png --vtu %sw.vtu"):format(path, folder, folder))
    assert.equal(1, status)
    assert.truthy(out:find("that was found buckles it, which is not certain of all loads.", 1, true), out)
    assert.truthy(out:find("heuristic", 1, true))
    assert.truthy(out:find("w.png", 1, true))
    assert.truthy(out:find("buckles the part first: [%d.]+ N on at least 1 cm2, a load factor of [%d.]+"), out)
    assert(bw.mesh.read(folder .. "w.vtu"))
  end)

  it("counts the force on one side of a free part where it is too large", function()
    local words = " --material steel --worst 100N --contact 1m2 " .. path
    local status, _, err = check.run("buckle" .. words)
    assert.equal(3, status)
    local area = 2 * (L * a + L * b + a * b)
    assert.truthy(err:find("a force of 100 N on at least 1 m2 has no room", 1, true), err)
    check.near(100 * area / 2, tonumber(err:match("reach ([%d.e-]+) N on each side")), 1e-3)
    status, _, err = check.run("buckle --fix min:x" .. words)
    assert.equal(3, status)
    assert.is_nil(err:find("on each side", 1, true), err)
  end)

  it("refuses mixtures with known loads", function()
    local status, _, err = check.run("buckle --fix min:x --worst 10 --force max:x=1,0,0 " .. path)
    assert.equal(2, status)
    assert.truthy(err:find("leave out", 1, true), err)
    status, _, err = check.run("buckle --fix min:x --force max:x=1,0,0 --forbid min:x " .. path)
    assert.equal(2, status)
    assert.truthy(err:find("--forbid", 1, true), err)
  end)
end)
