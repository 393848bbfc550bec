-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Supports and remote points that move by histories of their own: superposition, rigid motion, closed forms, a
-- body cut in two, and CalculiX (ccx) on the same elements where it is there.
local bw = require "barwright"
local check = require "check"
local beam = require "cut_beam"
local deck = require "deck"

local folder = os.tmpname()
os.remove(folder)

--- A rod along x whose ends are prescribed.
local function rod(left, right, cells)
  local mesh = bw.mesh.box {max = {1, 0.1, 0.08}, cells = cells or {8, 1, 1}, order = 2}
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:prescribe(mesh.boundary:below("x", 0), left):prescribe(mesh.boundary:above("x", 1), right)
  return part
end

local function first(t) return math.sin(2000 * t) ^ 3 end
local function second(t) return 1 - math.cos(1300 * t) end

describe("supports with histories of their own", function()
  it("superpose the motions of each", function()
    local left, right, still = {1e-4, 0, 2e-4}, {-3e-5, 1e-4, 0}, {0, 0, 0}
    for _, way in ipairs {"directly", "by modes"} do
      local function follow(part, supports)
        local modes = way == "by modes" and assert(part:modes {count = 12, tolerance = 1e-12}) or nil
        local now = assert(part:transient {step = 5e-5, rho = 0.9, modes = modes, damping = {mass = 40},
          supports = supports})
        local run = assert(now:run {time = 4e-3, probes = {middle = {0.5, 0.1, 0.08}}})
        return {displacement = now.displacement, velocity = now.velocity, acceleration = now.acceleration,
          reaction = now.reaction, middle = run.probes.middle.displacement, run = run}
      end
      local both = follow(rod(left, right), {first, second})
      local one, other = follow(rod(left, still), {first}), follow(rod(still, right), {[2] = second})
      for _, field in ipairs {"displacement", "velocity", "acceleration", "reaction", "middle"} do
        check.same(both[field], one[field] + other[field], 1e-9)
      end
      -- neither alone, and the supports do the work
      assert.is_true(check.largest(one.middle) > 0.1 * check.largest(both.middle))
      local energy = both.run.energy
      assert.is_true(check.largest(energy.lost_energy) < 3e-2 * energy.work:max())
    end
  end)

  it("move a body as a rigid one where all move alike", function()
    local part = rod({1, 0, 2}, {1, 0, 2})
    local velocity = {}
    for i = 1, #part.mesh.nodes do velocity[i] = {3, 0, 6} end
    for _, how in ipairs {{}, {error = 1e-4}, {modes = assert(part:modes {count = 6})}} do
      local now = assert(part:transient {step = 1e-4, error = how.error, modes = how.modes,
        initial = {velocity = velocity}, supports = {function(t) return 3 * t end, {{0, 0}, {1, 3}}}})
      assert(now:run {time = 4e-3})
      local distance = 3 * now.time
      for _, i in ipairs {1, #part.mesh.nodes // 2, #part.mesh.nodes} do
        check.near(distance, now.displacement(i, 1), 1e-9)
        check.near(2 * distance, now.displacement(i, 3), 1e-9)
      end
      assert.is_true(now.strain_energy < 1e-9 * now.kinetic_energy)
    end
  end)

  -- Masses m at 1/3 and 2/3 of a light rod between ends that move by y1 and y2: m x1'' + k (2 x1 - x2) = k y1.
  it("excite two masses from both ends by their closed form", function()
    local mesh = bw.mesh.box {max = {1.5, 0.1, 0.1}, cells = {3, 1, 1}, order = 1}
    local part = bw.model {mesh = mesh,
      material = bw.material.isotropic {young = 2e11, poisson = 0, density = 1e-3}}
    local m, k, far = 20, 4e9, {2e-6, -5e-6}
    local boundary = mesh.boundary
    part:prescribe(boundary:below("x", 0), {far[1], 0, 0}):prescribe(boundary:above("x", 1.5), {far[2], 0, 0})
    for _, x in ipairs {0.5, 1} do
      local slice = boundary:above("x", x - 1e-3):below("x", x + 1e-3):node_set()
      part:couple {on = slice, kind = "rigid", mass = m, displacement = {false, 0, 0},
        rotation = {0, 0, 0}}
    end
    local w, p = {math.sqrt(k / m), math.sqrt(3 * k / m)}, {0.31 * math.sqrt(k / m), 0.53 * math.sqrt(k / m)}
    local function mode(i, t) -- q'' + w^2 q = sum over the ends of k far / (2 m) (+-1) sin(p t), from rest
      local sum = 0
      for e = 1, 2 do
        local sign = i == 2 and e == 2 and -1 or 1
        sum = sum + sign * k * far[e] / (2 * m) / (w[i] ^ 2 - p[e] ^ 2)
          * (math.sin(p[e] * t) - p[e] / w[i] * math.sin(w[i] * t))
      end
      return sum
    end
    local supports = {function(t) return math.sin(p[1] * t) end, function(t) return math.sin(p[2] * t) end}
    local step = 2 * math.pi / w[2] / 100
    local modes = assert(part:modes {count = 2, tolerance = 1e-12})
    check.near(w[2], 2 * math.pi * modes.frequencies[2], 1e-6)
    local off = {}
    for i, how in ipairs {{step = step}, {step = step / 2}, {step = step, error = 1e-3},
      {step = step / 2, modes = modes}} do
      local now = assert(part:transient {step = how.step, error = how.error, modes = how.modes, rho = 1,
        supports = supports})
      local run = assert(now:run {time = 20 / w[1], probes = {a = {0.5, 0, 0}, b = {1, 0, 0}}})
      local most = 0
      off[i] = 0
      for n, t in ipairs(run.time:totable()) do
        local a, b = mode(1, t) + mode(2, t), mode(1, t) - mode(2, t)
        most = math.max(most, math.abs(a), math.abs(b))
        off[i] = math.max(off[i], math.abs(run.probes.a.displacement(n, 1) - a),
          math.abs(run.probes.b.displacement(n, 1) - b))
      end
      off[i] = off[i] / most
      if how.error then assert.is_true(off[i] < 1.5 * run.steps.error, off[i] .. " " .. run.steps.error) end
    end
    assert.is_true(off[1] < 5e-3, off[1])
    check.near(4, off[1] / off[2], 0.05)
    assert.is_true(off[4] < 1e-3, off[4])
  end)

  it("move a body cut in two as the whole", function()
    for _, how in ipairs {{}, {error = 5e-3}, {modes = 12}} do
      local found = {}
      for i, cut in ipairs {false, true} do
        local part, tip = beam(cut, {4, 2, 1})
        part:clear_supports():prescribe(part.mesh.boundary:below("x", 0), {0, 0, 1e-4})
          :prescribe(tip, {1e-5, 2e-5, 0})
        local modes = how.modes and assert(part:modes {count = how.modes, tolerance = 1e-12})
        local now = assert(part:transient {step = 1e-4, error = how.error, modes = modes,
          supports = {first, second}})
        found[i] = assert(now:run {time = 4e-3, probes = {middle = {0.25, 0.1, 0.05}}})
        found[i].reaction = now.reaction:column_sums()
      end
      local whole, cut = table.unpack(found)
      for _, field in ipairs {"displacement", "velocity", "acceleration"} do
        check.same(whole.probes.middle[field], cut.probes.middle[field], 1e-7)
      end
      check.same(whole.energy.work, cut.energy.work, 1e-7)
      check.same(bw.array.new(whole.reaction), bw.array.new(cut.reaction), 1e-6)
    end
  end)

  it("follow remote points as supports there", function()
    local found = {}
    for _, how in ipairs {"support", "rigid"} do
      local part, tip = beam(true, {3, 2, 1})
      part:clear_supports():prescribe(part.mesh.boundary:below("x", 0), {2e-4, 0, 0})
      local options = {step = 2e-5, rho = 1}
      if how == "support" then
        part:prescribe(tip, {0, 1e-4, -2e-4})
        options.supports = {first, second}
      else
        part:couple {on = tip, kind = "rigid", displacement = {0, 1e-4, -2e-4}, rotation = {0, 0, 0}}
        options.supports, options.coupling_motions = first, {second}
      end
      found[how] = assert(assert(part:transient(options)):run {time = 2e-3, probes = {middle = {0.5, 0.1, 0.05}}})
    end
    for _, field in ipairs {"displacement", "velocity", "acceleration"} do
      check.same(found.support.probes.middle[field], found.rigid.probes.middle[field], 1e-8)
    end
    check.same(found.support.energy.work, found.rigid.energy.work, 1e-8)
  end)

  it("are refused where they contradict, or are none", function()
    local mesh = bw.mesh.box {max = {1, 0.1, 0.08}, cells = {2, 1, 1}}
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:prescribe(mesh.boundary:below("x", 0), {0, 0, 1e-4}):prescribe(mesh.boundary:below("z", 0), {0, 0, 1e-4})
    assert(part:transient {step = 1e-4, supports = first})
    assert(part:transient {step = 1e-4, supports = {first, first}})
    check.raises("with different histories prescribe displacements of the same node", function()
      part:transient {step = 1e-4, supports = {first, second}}
    end)
    check.raises("option 'supports': there is no support 3: the part has 2", part.transient, part,
      {step = 1e-4, supports = {[3] = 1}})
    check.raises("the history of support 2: row 2: the time 0 does not follow the time 0", part.transient, part,
      {step = 1e-4, supports = {1, {{0, 1}, {0, 2}}}})
    check.raises("the history of the supports: row 1: a time is missing", part.transient, part,
      {step = 1e-4, supports = {{}}})
    check.raises("there is no coupling 1: the part has 0", part.transient, part,
      {step = 1e-4, coupling_motions = {1}})
    local path = folder .. ".csv"
    check.write(path, "t,y\n0,0\n0.01,\n")
    check.fails("format", path .. ": line 3: a value is missing",
      part:transient {step = 1e-4, supports = {1, path}})
    check.write(path, "t,y\n0,0\n0.01,1\n")
    bw.warnings()
    local now = assert(rod({1e-4, 0, 0}, {0, 0, 0}):transient {step = 1e-3, supports = {path}})
    assert(now:run {time = 0.01})
    assert.same({}, bw.warnings())
    now:run {time = 0.012}
    now:run {time = 0.013}
    local said = {}
    for _, text in ipairs(bw.warnings()) do if text:find(path, 1, true) then said[#said + 1] = text end end
    assert.equal(1, #said)
    assert.truthy(said[1]:find("line 3: the history ends at 0.01 s, before the motion ends at 0.012 s", 1, true))
    os.remove(path)
  end)

  if os.execute "command -v ccx >/dev/null 2>&1" then
    -- The mass of its C3D10 is of lower order: 16 cells along the rod differ by 8.5e-5, 32 by 1.2e-5.
    it("have the displacements of *DYNAMIC, DIRECT of CalculiX with two amplitudes", function()
      local part = rod({0, 0, 1e-4}, {2e-5, 0, -3e-4}, {40, 1, 1})
      local mesh, stem = part.mesh, os.tmpname()
      local step, steps = 3e-5, 100
      local function amplitude(name, f)
        local lines = {"*AMPLITUDE, NAME=" .. name}
        for i = 0, steps + 2 do lines[#lines + 1] = ("%.15g, %.15g"):format(i * step, f(i * step)) end
        return table.concat(lines, "\n")
      end
      local function left(t) return (1 - math.cos(700 * t)) ^ 2 end
      local function right(t) return (1 - math.cos(1200 * t)) ^ 2 end
      assert(part:write_inp(stem .. ".inp"))
      local model = check.read(stem .. ".inp"):match "^(.-)%*BOUNDARY"
      check.write(stem .. ".inp", table.concat({model .. deck.node_set("LEFT", mesh.boundary:below("x", 0)),
        deck.node_set("RIGHT", mesh.boundary:above("x", 1)), amplitude("A", left), amplitude("B", right),
        ("*STEP, INC=10000\n*DYNAMIC, DIRECT, ALPHA=0\n%.12g, %.12g"):format(step, steps * step),
        "*BOUNDARY, AMPLITUDE=A\nLEFT, 1, 2, 0\nLEFT, 3, 3, 1e-4",
        "*BOUNDARY, AMPLITUDE=B\nRIGHT, 1, 1, 2e-5\nRIGHT, 2, 2, 0\nRIGHT, 3, 3, -3e-4",
        ("*NODE PRINT, NSET=NALL, FREQUENCY=%d\nU\n*END STEP\n"):format(steps)}, "\n"))
      os.execute(("cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1"):format(stem, stem))
      local theirs = {}
      for line in io.lines(stem .. ".dat") do
        local node, x, y, z = line:match "^%s+(%d+)%s+(%S+)%s+(%S+)%s+(%S+)%s*$"
        if node then theirs[tonumber(node)] = {tonumber(x), tonumber(y), tonumber(z)} end
      end
      os.execute(("rm -f '%s' '%s'.*"):format(stem, stem))
      local now = assert(part:transient {step = step, rho = 1, supports = {left, right}})
      for _ = 1, steps do assert(now:step()) end
      assert.equal(#mesh.nodes, #theirs)
      local off = check.largest(bw.array.new(theirs) - now.displacement)
      local most = check.largest(now.displacement)
      assert.is_true(off < 1e-5 * most, ("%g of %g"):format(off, most))
    end)
  end
end)
