-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Motion in time from scripts: NAFEMS 5T, histories and their files, supports, what is recorded, misuse.
local bw = require "barwright"
local check = require "check"

local folder = check.folder() .. "/"

local function bar(order)
  local mesh = bw.mesh.box {max = {1, 0.1, 0.08}, cells = {8, 1, 1}, order = order or 1}
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:below("x", 0))
  part:load {on = mesh.boundary:above("x", 1), force = {0, 0, -1000}}
  return part, mesh
end

describe("motion in time", function()
  -- NAFEMS, Selected Benchmarks for Forced Vibration, test 5T: a deep simply supported beam under 1 MN/m applied
  -- at once, 2 % damping of the first mode. Closed form of a beam with shear: 1.043 mm at 0.0117 s, 18.76 MPa.
  -- An edge moves as the axis does; the section's contraction moves the middle of the lower face 1.3 % less.
  it("NAFEMS 5T", function()
    local mesh = bw.mesh.box {max = {10, 2, 2}, cells = {20, 1, 4}, order = 2}
    local material = bw.material.isotropic {young = 200e9, poisson = 0.3, density = 8000}
    local part = bw.model {mesh = mesh, material = material}
    local ends = mesh.boundary:below("x", 0) | mesh.boundary:above("x", 10)
    part:prescribe(ends, {false, 0, 0}):prescribe(mesh.boundary:nearest {0, 1, 1}, {0, false, false})
    part:gravity {0, 0, -1e6 / (8000 * 4)}
    local transient = assert(part:transient {step = 2e-4, rho = 1, damping = {mass = 5.36, stiffness = 7.46e-5}})
    local recording = assert(transient:run {time = 0.014, probes = {middle = {5, 0, 0}, face = {5, 1, 0}},
      stress_every = 1})
    local z = recording.probes.middle.displacement:column(3)
    check.near(-1.043e-3, z:min(), 0.005)
    local face = recording.probes.face.displacement:column(3)
    local curvature = 1e6 * 10 ^ 2 / 8 / (200e9 * 4 / 3)
    check.near(0.3 * curvature / 2 * 1.94, face:min() - z:min(), 0.02)
    check.near(0.0117, recording.time[z:argmin()], 0.02)
    local static = recording.stress.peak.static
    local stress = static.stress[mesh.boundary:nearest({5, 1, 0}).nodes[1]]
    check.near(18.76e6, stress[1], 0.01)
    assert.is_true(math.abs(recording.energy.lost_energy[#z]) < 0.01 * recording.energy.work:max())
    assert.truthy(tostring(recording):find("taken by damping", 1, true))
    assert.truthy(tostring(recording):find("periods too long by about 0.", 1, true))
    assert.is_true(recording.period_error < 0.001)
  end)

  it("NAFEMS 5T by modes, with a damping ratio and a long step", function()
    local mesh = bw.mesh.box {max = {10, 2, 2}, cells = {20, 1, 4}, order = 2}
    local material = bw.material.isotropic {young = 200e9, poisson = 0.3, density = 8000}
    local part = bw.model {mesh = mesh, material = material}
    local ends = mesh.boundary:below("x", 0) | mesh.boundary:above("x", 10)
    part:prescribe(ends, {false, 0, 0}):prescribe(mesh.boundary:nearest {0, 1, 1}, {0, false, false})
    part:gravity {0, 0, -1e6 / (8000 * 4)}
    local modes = assert(part:modes {count = 16})
    local transient = assert(part:transient {step = 6e-4, modes = modes, damping = {ratio = 0.02}})
    local recording = assert(transient:run {time = 0.015, probes = {middle = {5, 0, 0}}})
    check.near(-1.043e-3, recording.probes.middle.displacement:column(3):min(), 0.006)
    assert.truthy(tostring(recording):find("compare with more modes", 1, true))
    assert.truthy(tostring(recording):find("none for loads that are linear within a step", 1, true))
    check.raises("are not elastic modes of this model", part.transient, part, {step = 1e-3,
      modes = bw.model({mesh = mesh, material = material}):modes {count = 2}})
    check.fails("unsupported", "a damping ratio needs modes",
      part:transient {step = 1e-3, damping = {ratio = 0.1}})
  end)

  it("histories as numbers, functions, rows and files are the same", function()
    local part = bar()
    local path = folder .. "load.csv"
    check.write(path, "\xEF\xBB\xBF0,0.5\n1,1\n") -- a mark of the order of bytes, as spreadsheets write it
    local marked = assert(part:transient {step = 1e-4, loads = {path}})
    local half = assert(part:transient {step = 1e-4, loads = {{{0, 0.5}, {1, 1}}}})
    check.near(half.acceleration:norm(), marked.acceleration:norm(), 1e-12)
    check.write(path, "# measured\ntime,force\n0,0\n0.001,1\n0.003, -0.5 # turned\n\n0.01;2\n")
    local rows = {{0, 0}, {0.001, 1}, {0.003, -0.5}, {0.01, 2}}
    local function by_hand(t)
      return t < 0.001 and t / 0.001 or t < 0.003 and 1 - 1.5 * (t - 0.001) / 0.002
        or -0.5 + 2.5 * (t - 0.003) / 0.007
    end
    local tips = {}
    for i, history in ipairs {path, rows, by_hand} do
      local transient = assert(part:transient {step = 2e-4, loads = {history}})
      local recording = assert(transient:run {time = 0.006, probes = {tip = {1, 0, 0}}})
      tips[i] = recording.probes.tip.displacement
      assert.equal(31, #recording.time)
    end
    local scale = tips[1]:column(3):min()
    assert.is_true(scale < -1e-5)
    for i = 2, 3 do
      local off = (tips[i] - tips[1]):column(3)
      assert.is_true(math.max(off:max(), -off:min()) < 1e-9 * -scale)
    end
    local none = assert(part:transient {step = 1e-4, loads = {0}})
    assert.equal(0, assert(none:run {time = 1e-3}).energy.work[11])
  end)

  it("says the line of a history that is none", function()
    local part = bar()
    local path = folder .. "bad.csv"
    for text, what in pairs {
      ["t,f\n0,1\n0.1,\n"] = "line 3: a value is missing",
      ["0,1\n0.1,nan\n"] = "line 2: a value is missing or not a finite number",
      ["0,1\n0.2,3\n0.1,2\n"] = "line 3: the time 0.1 does not follow the time 0.2",
      ["0,1\n\n0,2\n"] = "line 3: the time 0 does not follow the time 0",
      ["0 1\nx 2\n"] = "line 2: a time is missing",
      ["time,force\nmore,words\n0,1\n"] = "line 2: a time is missing",
      ["time,force\n"] = "no row with a time and a value",
      ["1,2\n7\n"] = "line 2: a value is missing",
      ["0;0,5\n1;0,7\n"] = "line 1: two columns, with decimal points, expected",
      ["t,f\n0,1,2\n"] = "line 2: two columns",
      [",1\n1,2\n"] = "line 1: a time is missing"} do
      check.write(path, text)
      check.fails("format", what, part:transient {step = 1e-4, loads = {path}})
    end
    check.fails("io", "none.csv", part:transient {step = 1e-4, loads = {folder .. "none.csv"}})
    check.raises("the history of load 1: row 2: the time 0 does not follow the time 0", part.transient, part,
      {step = 1e-4, loads = {{{0, 1}, {0, 2}}}})
    check.raises("the history of load 1: row 2: a value is missing", part.transient, part,
      {step = 1e-4, loads = {{{0, 1}, {1}}}})
    check.raises("the history of load 1: a number, a function of time, rows", part.transient, part,
      {step = 1e-4, loads = {{}}})
    check.raises("there is no load 2: the part has 1", part.transient, part, {step = 1e-4, loads = {[2] = 1}})
    check.raises("must return a finite number", part.transient, part,
      {step = 1e-4, loads = {function() return 0 / 0 end}})
    check.raises("option 'step'", part.transient, part, {})
    check.fails("unsupported", "a loss factor is for harmonic motion",
      part:transient {step = 1e-4, damping = {loss = 1}})
    check.raises("transient: damping: unknown option 'ratios'", part.transient, part,
      {step = 1e-4, damping = {ratios = 1}})
    check.raises("transient: option 'damping': a table with ratio, mass, stiffness or loss", part.transient, part,
      {step = 1e-4, damping = 0.02})
    check.raises("option 'error'", part.transient, part, {step = 1e-4, error = 0})
    check.raises("a tolerance of 1 for the error of a step", part.transient, part, {step = 1e-4, error = 1})
    check.fails("unsupported", "steps that adapt are for direct integration", part:transient {step = 1e-4,
      error = 1e-3, modes = part:modes {count = 2}})
    check.raises("velocity", part.transient, part, {step = 1e-4, initial = {velocity = {{1, 2, 3}}}})
    local transient = assert(part:transient {step = 1e-4})
    check.raises("a point {x, y, z} expected", transient.run, transient, {time = 1, probes = {a = 3}})
    check.raises("at most 1e8 expected", transient.run, transient, {time = 1e9})
    assert(transient:run {time = 3e-4})
    check.raises("run: the time 0.0002 s is before now, 0.0003 s", transient.run, transient, {time = 2e-4})
    check.raises("the path of a .pvd file", transient.run, transient, {time = 1, write = "a.vtu"})
    part:gravity {0, 0, -1}
    check.raises("begin a new transient", transient.step, transient)
  end)

  it("says that a step is too large, and no more with the step that it names", function()
    local part = bar(2)
    local function follow(step)
      local recording = assert(assert(part:transient {step = step, rho = 1}):run {time = 0.05})
      local warned = bw.warnings()
      return recording, warned[#warned]
    end
    local coarse, said = follow(5e-3)
    assert.truthy(said and said:find("too large for this motion", 1, true))
    assert.truthy(tostring(coarse):find("too large a step", 1, true))
    local named = tonumber(said:match "Take a step of (%S+) s")
    local fine, silent = follow(0.5 * named) -- a step that is far too large does not see all modes
    assert.is_nil(silent)
    assert.is_true(fine.period_error < 0.02)
    assert.truthy(tostring(assert(assert(part:transient {step = 1e-5}):run {time = 2e-5})):find(
      "error by the step unknown", 1, true))
  end)

  -- A bar under a stress s that acts at once: u = s x / E - sum 2 s (-1)^k / (E b^2) sin(b x) cos(b c t),
  -- b = (k + 1/2) pi.
  it("steps that adapt follow a bar under a sudden load within their estimated error", function()
    local mesh = bw.mesh.box {max = {1, 0.02, 0.02}, cells = {40, 1, 1}, order = 2}
    local young, density, stress = 2e11, 8000, 1e6
    local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = young, poisson = 0,
      density = density}}
    part:fix(mesh.boundary:below("x", 0))
    part:load {on = mesh.boundary:above("x", 1), force = {stress * 4e-4, 0, 0}}
    local c = math.sqrt(young / density)
    local period = 4 / c
    local function exact(x, t)
      local u = stress / young * x
      for k = 0, 199 do
        local b = (k + 0.5) * math.pi
        u = u - 2 * stress / young * (-1) ^ k / b ^ 2 * math.sin(b * x) * math.cos(b * c * t)
      end
      return u
    end
    local along, nodes = {}, mesh.nodes
    for i = 1, mesh.node_count do along[i] = nodes[i][1] end
    local function rms(t, field)
      local known, sum = {}, 0
      for i, x in ipairs(along) do
        local key = math.floor(x * 1e6 + 0.5)
        known[key] = known[key] or exact(x, t)
        sum = sum + (known[key] - (field and field[i] or 0)) ^ 2
      end
      return math.sqrt(sum / #along)
    end
    local largest = rms(period / 2)
    for _, tolerance in ipairs {1e-2, 1e-3} do
      local transient = assert(part:transient {step = period / 20, error = tolerance})
      local most, k = 0, 0
      local recording = assert(transient:run {time = 2.5 * period, each = function(now)
        k = k + 1
        if now.time > 2 * period and k % 5 == 0 then
          most = math.max(most, rms(now.time, now.displacement:column(1)) / largest)
        end
      end})
      local estimated = recording.steps.error
      assert.is_true(most < estimated and estimated < 10 * most)
      assert.is_true(most < 0.07)
      assert.equal(0, recording.steps.coarse)
      local text = tostring(recording)
      assert.truthy(text:find("error by the step: about", 1, true))
      assert.truthy(text:find(("%d rejected, %d factors"):format(recording.steps.rejected,
        recording.steps.factors), 1, true))
      assert.is_nil(recording.period_error)
      local none = assert(transient:run {time = transient.time})
      assert.is_nil(none.steps.shortest)
      assert.truthy(tostring(none):find("no step; since the start", 1, true))
    end
  end)

  it("steps that adapt see a short pulse, and take few steps when nothing happens", function()
    local mesh = bw.mesh.box {max = {1, 0.1, 0.08}, cells = {8, 1, 1}, order = 2}
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(mesh.boundary:below("x", 0))
    part:load {on = mesh.boundary:above("x", 1), force = {0, 0, -1000}}
    local period = 1 / assert(part:modes {count = 1}).frequencies[1]
    local w = 2 * math.pi / period
    local rows = {{0, 0}, {30 * period, 0}, {30.05 * period, 1}, {30.1 * period, 0}}
    local function of_time(t)
      local x = t / period - 30
      return x > 0 and x < 0.1 and 1 - math.abs(x / 0.05 - 1) or 0
    end
    local function follow(step, tolerance, history)
      local transient = assert(part:transient {step = step, error = tolerance, loads = {history or rows},
        damping = {mass = 0.1 * w, stiffness = 0.1 / w}})
      local states = {}
      local recording = assert(transient:run {time = 50 * period, each = function(now)
        if now.time > 29 * period and now.time < 34 * period then
          states[#states + 1] = {now.time, now.displacement}
        end
      end})
      return states, recording
    end
    local fine = follow(period / 800)
    local largest = 0
    for _, s in ipairs(fine) do largest = math.max(largest, s[2]:norm()) end
    local function error_of(states)
      local most, i = 0, 1
      for _, s in ipairs(states) do
        while i < #fine - 1 and fine[i + 1][1] <= s[1] do i = i + 1 end
        local x = (s[1] - fine[i][1]) / (fine[i + 1][1] - fine[i][1])
        if x <= 1 then
          most = math.max(most, (s[2] - (fine[i][2] * (1 - x) + fine[i + 1][2] * x)):norm() / largest)
        end
      end
      return most
    end
    local states, recording = follow(period / 20, 1e-4)
    local error = error_of(states)
    assert.is_true(error < recording.steps.error and recording.steps.error < 6 * error)
    assert.is_true(recording.steps.longest > 2 * period) -- longer than the pulse, which it sees all the same
    -- 5 times as many fixed steps have a larger error
    assert.is_true(error_of((follow(50 * period / (5 * recording.steps.taken)))) > error)
    local _, as_function = follow(period / 20, 1e-4, of_time)
    check.near(recording.steps.error, as_function.steps.error, 0.05)
    local none = select(2, follow(period / 20, 1e-4, 0))
    assert.equal(0, none.steps.error)
    assert.is_true(none.steps.taken < 60)
  end)

  it("steps that adapt follow supports, and say where the shortest is too long", function()
    local mesh = bw.mesh.box {max = {1, 0.1, 0.08}, cells = {8, 1, 1}, order = 2}
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:prescribe(mesh.boundary:below("x", 0), {0, 0, 1e-3})
    local period = 1 / assert(part:modes {count = 1}).frequencies[1]
    local function follow(history, options)
      options.supports = history
      local recording = assert(assert(part:transient(options)):run {time = 6 * period, probes = {tip = {1, 0, 0}}})
      return recording, recording.probes.tip.displacement:column(3)
    end
    local function rise(t)
      local x = math.min(1, math.max(0, t / period - 2) / 0.3)
      return 3 * (x - math.sin(2 * math.pi * x) / (2 * math.pi))
    end
    local fine = select(2, follow(rise, {step = period / 2000}))
    local recording, tip = follow(rise, {step = period / 20, error = 1e-4})
    assert.is_true(recording.steps.taken < 1500)
    local off = 0
    for i, time in ipairs(recording.time:totable()) do
      local at = time / (period / 2000) + 1
      local k = math.min(math.floor(at), #fine - 1)
      off = math.max(off, math.abs(tip[i] - fine[k] - (at - k) * (fine[k + 1] - fine[k])))
    end
    assert.is_true(off < 0.01 * 3e-3)
    bw.warnings()
    local sudden = assert(bar(2):transient {step = period / 20, error = 1e-8})
    recording = assert(sudden:run {time = period / 1000})
    assert.is_true(recording.steps.coarse > 0)
    local said = bw.warnings()
    assert.truthy(said[#said]:find("changes in no time there", 1, true))
    assert.truthy(tostring(recording):find("of the shortest length with a larger error", 1, true))
  end)

  it("a support that moves takes a stiff part along", function()
    local mesh = bw.mesh.box {max = {0.1, 0.1, 0.1}, cells = {2, 2, 2}}
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:prescribe(mesh.boundary:below("z", 0), {0, 0, 1e-3})
    local w = 2 * math.pi * 20
    local transient = assert(part:transient {step = 2.5e-4, supports = function(t) return 1 - math.cos(w * t) end})
    local recording = assert(transient:run {time = 0.05, probes = {top = {0, 0, 0.1}}})
    local top = recording.probes.top
    check.near(2e-3, top.displacement:column(3):max(), 0.005)
    check.near(1e-3 * w, top.velocity:column(3):max(), 0.01)
    local weight = 7850 * 1e-3
    local force = transient.reaction:column_sums()[3]
    check.near(weight * 1e-3 * w ^ 2, force, 0.03)
  end)

  it("writes series and columns, and goes on where it was", function()
    local part, mesh = bar()
    local transient = assert(part:transient {step = 1e-4, rho = 1})
    local seen = 0
    local first = assert(transient:run {time = 1e-3, probes = {tip = {1, 0, 0}}, write = folder .. "run.pvd",
      write_every = 5, each = function() seen = seen + 1 end})
    assert.equal(11, seen)
    local series = check.read(folder .. "run.pvd")
    assert.truthy(series:find('file="run_0001.vtu"', 1, true))
    local _, count = series:gsub("<DataSet", "")
    assert.equal(3, count)
    local _, file = assert(bw.mesh.read(folder .. "run_0002.vtu"))
    assert.equal(first.probes.tip.velocity[11][3], file.fields.velocity[first.probes.tip.node][3])
    assert.truthy(file.fields.von_mises)
    assert(first:write(folder .. "run.csv"))
    local columns = check.read(folder .. "run.csv")
    local named = assert(transient:run {time = 1e-3, probes = {["tip, right"] = {1, 0, 0}}})
    assert.truthy(tostring(named):find("error of the mesh unknown", 1, true))
    assert(named:write(folder .. "named.csv"))
    assert.truthy(check.read(folder .. "named.csv"):find(',"tip, right_displacement_x_m",', 1, true))
    assert.truthy(columns:find("^time_s,kinetic_energy_J"))
    assert.equal(12, select(2, columns:gsub("\n", "")))
    local second = assert(transient:run {time = 2e-3, probes = {tip = {1, 0, 0}}})
    local again = assert(part:transient {step = 1e-4, rho = 1})
    local whole = assert(again:run {time = 2e-3, probes = {tip = {1, 0, 0}}})
    assert.equal(whole.probes.tip.displacement[21][3], second.probes.tip.displacement[11][3])
    assert.equal(second.time[1], first.time[11])
    assert.equal(mesh, transient.mesh)
    check.fails("io", "nowhere", transient:run {time = 3e-3, write = folder .. "nowhere/a.pvd"})
  end)

  -- The states of a body followed step by step: {time =, displacement =, von_mises =} each.
  local function states(transient, last)
    local found = {}
    while true do
      found[#found + 1] = {time = transient.time, displacement = transient.displacement,
        von_mises = assert(transient:static()).von_mises}
      if transient.time >= last * (1 - 1e-9) then return found end
      assert(transient:step())
    end
  end

  -- What a page gives its view, numbers decoded.
  local function data_of(path)
    local data = assert(bw.json.decode(check.read(path):match 'id="data">(.-)</script>'))
    local digits = {}
    for i = 1, 64 do
      digits[("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"):sub(i, i)] = i - 1
    end
    function data.number(text, i) -- a float32, from 1
      local bytes = {}
      for k = 4 * (i - 1), 4 * i - 1 do
        local group = {text:byte(k // 3 * 4 + 1, k // 3 * 4 + 4)}
        local bits = 0
        for _, byte in ipairs(group) do bits = bits << 6 | (digits[string.char(byte)] or 0) end
        bytes[#bytes + 1] = string.char(bits >> 8 * (2 - k % 3) & 255)
      end
      return (("<f"):unpack(table.concat(bytes)))
    end
    return data
  end

  it("keeps frames evenly over the time, with the values of its steps", function()
    for _, how in ipairs {{}, {by_modes = true}, {error = 1e-3}, {joined = true}} do
      local function start()
        local part = bar(2)
        if how.joined then
          part:couple {on = part.mesh.boundary:above("x", 1), kind = "distributed", at = {1.1, 0.05, 0.04},
            mass = 5}
        end
        return assert(part:transient {step = 2e-4, error = how.error,
          modes = how.by_modes and assert(part:modes {count = 4}) or nil})
      end
      local all = states(start(), 8e-3)
      local recording = assert(start():run {time = 8e-3, frames = 7, stress_every = 11})
      local frames, i = recording.frames, 0
      for k = 1, 7 do
        repeat i = i + 1 until all[i].time >= (k - 1) * 8e-3 / 6 - 1e-9
        assert.equal(all[i].time, frames.time[k])
        for _, name in ipairs {"displacement", "von_mises"} do
          assert.equal(0, check.largest(all[i][name]:gather(frames.nodes) - frames[name][k]), name)
        end
      end
      assert.equal(7, #frames.time)
      assert.is_true(check.largest(frames.displacement[7]) > 1e-5)
      assert.equal(#frames.nodes, #frames.displacement[1])
      -- What a frame shows is in the envelope.
      for k = 1, 7 do
        local over = frames.von_mises[k] - recording.stress.envelope:gather(frames.nodes)
        assert.is_true(over:max() <= 0)
      end
      assert(recording:report(folder .. "motion.html", {title = "A <bar>", seconds = 4}))
      local page = check.read(folder .. "motion.html")
      assert.truthy(page:find("<title>A &lt;bar&gt;</title>", 1, true))
      assert.truthy(page:find("The view plays them in 4 s, 500 times slower than the part moves.", 1, true))
      assert.truthy(page:find("taken by the scheme", 1, true))
      local data = data_of(folder .. "motion.html")
      local motion = data.displacements[1]
      assert.same(frames.time:totable(), motion.times)
      assert.equal(4, motion.seconds)
      assert.same({"von Mises stress", "displacement"}, {data.fields[1].name, data.fields[2].name})
      local count = #frames.nodes
      for _, at in ipairs {{1, 1}, {4, count // 2}, {7, count}} do
        local k, node = at[1], at[2]
        local place = (k - 1) * count + node
        local u = frames.displacement[k][node]
        check.near(u[3] + 1, data.number(motion.values, 3 * place) + 1, 1e-9)
        check.near(frames.von_mises[k][node] + 1, data.number(data.fields[1].values, place) * 1e6 + 1, 1e-6)
        check.near(1 + u:norm(), data.number(data.fields[2].values, place) * 1e-3 + 1, 1e-9)
      end
    end
  end)

  it("keeps all steps where there are fewer than frames, and none where it was not asked to", function()
    local transient = assert(bar():transient {step = 1e-3})
    local few = assert(transient:run {time = 4e-3, frames = 60})
    assert.same(few.time:totable(), few.frames.time:totable())
    assert.is_nil(few.frames.von_mises)
    assert(few:report(folder .. "few.html"))
    assert(few:picture(folder .. "few.png", {width = 200, height = 150}))
    assert.same({"displacement"}, {data_of(folder .. "few.html").fields[1].name})
    local still = assert(transient:run {time = 4e-3, frames = 5})
    assert.equal(1, #still.frames.time)
    assert(still:report(folder .. "still.html"))
    local none = assert(transient:run {time = 6e-3})
    assert.is_nil(none.frames)
    check.raises("report: the recording has no frames", none.report, none, folder .. "none.html")
    check.raises("neither stresses nor frames", none.picture, none, folder .. "none.png")
    check.raises("option 'frames'", transient.run, transient, {time = 7e-3, frames = 1})
    local stressed = assert(transient:run {time = 8e-3, stress_every = 1})
    assert(stressed:picture(folder .. "stressed.png", {width = 200, height = 150}))
    check.fails("io", "nowhere", few:report(folder .. "nowhere/few.html"))
  end)
end)
