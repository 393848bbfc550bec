-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Drops in time: what a script sees of them. The physics is in tests/engine/drop.
local bw = require "barwright"
local check = require "check"

local function box(order)
  local mesh = bw.mesh.box {max = {0.03, 0.02, 0.01}, cells = {3, 2, 1}, order = order or 1}
  return bw.model {mesh = mesh, material = bw.material.pla}
end

describe("drop", function()
  it("gives impacts, a balance of energy and the stress where it peaks", function()
    local part = box(2)
    local drop = assert(part:drop {height = 0.5, down = {-1, -2, -3}, spin = {10, 0, 0}, impacts = 2,
      samples = 20})
    assert.equal(2, #drop.impacts)
    assert.is_true(drop.impacts[2].time > drop.impacts[1].time + drop.impacts[1].duration)
    assert.near(math.sqrt(2 * 9.80665 * 0.5), drop.speed, 1e-12)
    local sum = bw.array.map("a + b + c + d", {a = drop.motion_energy, b = drop.vibration_energy,
      c = drop.strain_energy, d = drop.potential_energy})
    assert.is_true(sum:map("abs(a - e)", {e = drop.initial_energy}):max() <= 1.001e-3 * drop.initial_energy)
    assert.is_true(drop.energy_error < 1e-3)
    assert.near(drop.peak.stress, drop.max_principal[drop.peak.element], 0)
    assert.near(drop.peak.stress, drop.sample_stresses:max(), 0)
    assert.near(drop.peak.stress, drop.max_principal:max(), 0)
    assert.equal(#drop.sample_times, #drop.peak_stresses)
    check.near(drop.peak.stress, drop.peak_stresses:max(), 1e-9)
    assert.equal(drop.peak.time, drop.sample_times[drop.peak_stresses:argmax()])
    local text = tostring(drop)
    for _, words in ipairs {"2 impacts", "by mesh and modes unknown", "free motion is exact", "no friction",
      "no damping", "kept to"} do
      assert.truthy(text:find(words, 1, true), words)
    end
    assert.near(0, drop.impacts[1].place[1], 1e-12)
  end)

  it("shows what half of the modes change", function()
    local part = bw.model {mesh = bw.mesh.box {max = {0.03, 0.02, 0.01}, cells = {6, 4, 2}, order = 2},
      material = bw.material.pla}
    local given = {down = {-1, -2, -3}, modes = assert(part:modes {count = 20}), samples = 20}
    local plain = assert(part:drop(given))
    assert.is_nil(plain.fewer)
    given.fewer = true
    local drop = assert(part:drop(given))
    assert.equal(plain.peak.stress, drop.peak.stress)
    assert.equal(20, drop.mode_count)
    assert.equal(10, drop.fewer.mode_count)
    given.fewer, given.modes = nil, assert(part:modes {count = 10})
    local ten = assert(part:drop(given))
    for _, name in ipairs {"duration", "force", "impulse"} do
      check.near(ten.impacts[1][name], drop.fewer.impacts[1][name], 1e-6)
    end
    check.near(ten.peak.stress, drop.fewer.peak.stress, 1e-6)
    local change = 100 * math.abs(drop.fewer.impacts[1].force / drop.impacts[1].force - 1)
    local words = ("half of the modes the duration .*, the force by %.2g %%%%,"):format(change)
    assert.truthy(tostring(drop):find(words))
    assert.truthy(tostring(drop.fewer):find("10 modes", 1, true))
  end)

  it("is onto a peg or an edge below the centre of mass, or at a place", function()
    local part = box()
    local peg = assert(part:drop {onto = bw.rigid.sphere {radius = 0.05}, samples = 2})
    assert.equal("sphere", peg.onto.kind)
    for k, at in ipairs {0.015, 0.01, -0.05} do assert.near(at, peg.onto.point[k], 1e-3) end
    assert.is_true(peg.obstacle_depth > 0 and peg.obstacle_depth < 0.005)
    assert.truthy(tostring(peg):find("onto a peg of radius 50 mm; between nodes it goes", 1, true))
    local edge = assert(part:drop {onto = bw.rigid.cylinder {point = {0.01, 0, 0}, axis = {0, 1, 0},
      radius = 0.05}, samples = 2})
    assert.near(0.01, edge.onto.point[1], 1e-12)
    assert.is_true(edge.spin[2] > 1) -- it hits beside the centre
    assert.near(0, edge.velocity[2], 1e-3 * edge.speed)
    local floor = assert(part:drop {samples = 2})
    assert.equal(0, floor.obstacle_depth)
    assert.equal("plane", floor.onto.kind)
    assert.near(0, floor.onto.point[3], 1e-12)
  end)

  it("takes modes of a former drop and gives the same bits", function()
    local part = box()
    local first = assert(part:drop {down = {-1, -2, -3}})
    local second = assert(part:drop {down = {-1, -2, -3}, modes = first.modes})
    assert.equal(first.peak.stress, second.peak.stress)
    assert.equal(first.solves, second.solves)
  end)

  it("shows what it falls on, and the gap to it", function()
    local obstacle = require "barwright.obstacle"
    local mesh, place = box().mesh, {0.015, 0.01, 0}
    local centre = {0.015, 0.01, -0.02}
    local surfaces = {bw.rigid.plane {normal = {0, 0, 1}}, bw.rigid.sphere {centre = centre, radius = 0.02},
      bw.rigid.cylinder {point = centre, axis = {1, 2, 0}, radius = 0.02},
      bw.rigid.sphere {centre = {0.015, 0.01, -20}, radius = 20}}
    for _, surface in ipairs(surfaces) do
      local drawn = obstacle.drawn(surface, mesh, place)
      local points = {}
      for _, line in ipairs(drawn.lines) do
        for _, p in ipairs(line) do
          points[#points + 1] = p
          assert.is_true(math.abs(p[1] - 0.015) < 0.04 and math.abs(p[2] - 0.01) < 0.04 and p[3] < 1e-9)
        end
      end
      local gap = obstacle.gap(surface, {nodes = bw.array.new(points)})
      assert.is_true(gap:map("abs(a)"):max() < 1e-9)
      check.near(0.01, obstacle.gap(surface, {nodes = bw.array.new {{0.015, 0.01, 0.01}}})[1], 1e-9)
    end
  end)

  -- The plane's direction need not be that of the fall; a plane is touched at the factor, and at none before.
  it("is drawn above what it falls on, however large its deformation is drawn", function()
    local obstacle = require "barwright.obstacle"
    local length, inside = math.sqrt(14), false
    local plate = bw.mesh.box {max = {0.1, 0.06, 0.004}, cells = {8, 5, 1}, order = 2}
    local part = bw.model {mesh = plate, material = bw.material.pla}
    for _, onto in ipairs {false, bw.rigid.plane {normal = {0.2, 0.5, 0.8}}, bw.rigid.sphere {radius = 0.04},
      bw.rigid.cylinder {axis = {0.3, 1, 0}, radius = 0.05}} do
      local drop = assert(part:drop {height = 0.5, down = {-1, -2, -3}, onto = onto or nil})
      local function least(shown, factor)
        return obstacle.gap(drop.onto, {nodes = drop.mesh.nodes + factor * shown}):min()
      end
      local factor = 0.02 / drop.displacement:map("norm(a)"):max()
      inside = inside or least(drop.displacement, factor) < -1e-3
      local shown = obstacle.above(drop.onto, drop.mesh, drop.displacement, factor,
        {1 / length, 2 / length, 3 / length})
      for _, part_of in ipairs {0.25, 0.5, 0.75, 1} do
        assert.is_true(least(shown, part_of * factor) > -1e-8, tostring(drop.onto))
      end
      if drop.onto.kind == "plane" then assert.near(0, least(shown, factor), 1e-8) end
    end
    assert.is_true(inside) -- as it is, it would be seen inside
  end)

  it("writes its history, fields and a picture", function()
    local drop = assert(box():drop {down = {-1, -2, -3}, samples = 5})
    local csv, vtu, png = os.tmpname(), os.tmpname() .. ".vtu", os.tmpname() .. ".png"
    assert(drop:write_history(csv))
    local lines, stresses = 0, {}
    for line in io.lines(csv) do
      if lines == 0 then
        assert.truthy(line:find("^time_s,force_N,.*,peak_stress_Pa$"))
      else
        stresses[#stresses + 1] = tonumber(line:match ",([^,]*)$")
      end
      lines = lines + 1
    end
    assert.equal(#drop.times + 1, lines)
    assert.equal(#drop.peak_stresses, #stresses)
    for i, stress in ipairs(stresses) do assert.near(drop.peak_stresses[i], stress, 1e-8 * drop.peak.stress) end
    assert(drop:write(vtu))
    assert(drop:picture(png, {width = 64, height = 64}))
    for _, path in ipairs {csv, vtu, png} do os.remove(path) end
  end)

  it("refuses what it does not know, in one sentence", function()
    check.raises("got both", function() box():drop {height = 1, speed = 2} end)
    local part = box()
    local bare = assert(part:drop {down = {-1, -2, -3}, samples = 0})
    assert.is_nil(bare.peak)
    assert.is_nil(bare.peak_stresses)
    local plain = assert(part:drop {down = {-1, -2, -3}, samples = 5, history = false})
    assert.is_nil(plain.peak_stresses)
    assert.equal(assert(part:drop {down = {-1, -2, -3}, samples = 5}).solves, plain.solves + 6)
    assert.error_matches(function() bare:write "/tmp/x.vtu" end, "no stress")
    assert.error_matches(function() part:drop {height = -1} end, "negative")
    assert.error_matches(function() part:drop {onto = 3} end, "onto")
    local function refused(words, surface, options)
      options = options or {}
      options.onto = surface
      local drop, message = part:drop(options)
      assert.is_nil(drop)
      assert.truthy(message:find(words, 1, true), message)
    end
    refused("leave out `inside`", bw.rigid.sphere {radius = 1, inside = true})
    refused("misses the peg of radius 0.005 m: it falls past at a distance of 0.015 m",
      bw.rigid.sphere {centre = {0.05, 0.01, 0}, radius = 0.005})
    refused("make elements smaller", bw.rigid.cylinder {axis = {0, 1, 0}, radius = 0.002})
    assert.error_matches(function() part:drop {onto = bw.rigid.cylinder {axis = {0, 0, 2}, radius = 1}} end,
      "across `down`")
    part:fix(part.mesh.boundary:below("x", 0))
    assert.error_matches(function() part:drop() end, "neither supports nor loads")
  end)

  it("at random gives each place a probability with the error of its sampling", function()
    local part = box()
    local drops = assert(bw.random_drops(part, {drops = 12, height = 3, spin = 2, samples = 5}))
    local low, high = drops:interval()
    local p, least, most = drops:failures()
    assert.equal(12, #drops.peaks)
    assert.is_true(drops.exceedance:max() <= p and least < p and p <= most)
    assert.equal(0, low:min())
    assert.is_true(low:map("b - a", {b = drops.exceedance}):min() >= -1e-15)
    assert.is_true(high:map("a - b", {b = drops.exceedance}):min() >= -1e-15)
    -- Wilson's upper end where nothing was seen: z^2 / (n + z^2)
    assert.near(3.841459 / 15.841459, high:min(), 1e-5)
    assert.near(1, drops:correlation(drops.mean_peak), 1e-12)
    assert.truthy(tostring(drops):find("95 %", 1, true))
    local again = assert(bw.random_drops(part, {drops = 12, height = 3, spin = 2, samples = 5,
      modes = drops.modes}))
    for i = 1, 12 do assert.equal(drops.peaks[i], again.peaks[i]) end
  end)

  it("at random keeps the drops that are done when it is cancelled", function()
    local part, asked = box(), 0
    local whole = assert(bw.random_drops(part, {drops = 4, samples = 2}))
    local function stopped_at(count)
      local last = 0
      asked = 0
      bw.progress(function(stage, fraction)
        if stage:find("random drops", 1, true) then
          assert.is_true(fraction >= last and fraction < 1, stage)
          last = fraction
        end
        if stage == "random drops" then asked = asked + 1 end
        return asked <= count
      end)
      local drops, message, details = bw.random_drops(part, {drops = 9, samples = 2})
      bw.progress(nil)
      return drops, message, details
    end
    local drops = assert(stopped_at(4))
    assert.equal(4, drops.drops)
    assert.equal("cancelled", drops.stopped)
    for i = 1, 4 do assert.equal(whole.peaks[i], drops.peaks[i]) end
    check.near(whole.mean_peak:sum(), drops.mean_peak:sum(), 0)
    assert.truthy(tostring(drops):find("stopped after 4 of 9 drops", 1, true))
    local none, _, details = stopped_at(0)
    assert.is_nil(none)
    assert.equal("cancelled", details.status)
  end)

  it("at random falls on edges in any direction, and a peg in a hole does no harm", function()
    local part = box()
    local function drops_onto(surface)
      return bw.random_drops(part, {drops = 5, samples = 2, seed = 3, onto = surface})
    end
    local edge = assert(drops_onto(bw.rigid.cylinder {axis = {1, 0, 0}, radius = 0.2}))
    assert.equal(0, edge.misses)
    assert.is_true(edge.peaks:min() > 0)
    assert.truthy(tostring(edge):find("rigid edge of radius 200 mm", 1, true))
    -- a large peg is a floor but for the slope where it is touched
    local floor, peg = assert(bw.random_drops(part, {drops = 1, samples = 2})),
      assert(bw.random_drops(part, {drops = 1, samples = 2, onto = bw.rigid.sphere {radius = 1e4}}))
    check.near(floor.forces[1], peg.forces[1], 1e-4)
    assert.error_matches(function() drops_onto(bw.rigid.sphere {centre = {0, 0, 0}, radius = 0.2}) end,
      "leave out its place")
    -- a frame about its centre of mass: along z a peg goes through
    local frame = bw.mesh.box {max = {0.03, 0.03, 0.004}, cells = {6, 6, 1}}
    local corners = 0
    for k = 1, 4 do corners = corners + frame.nodes:gather(frame.elements:column(k)) end
    frame = assert(frame:subset((corners / 4):map "max(abs(a.x - 0.015), abs(a.y - 0.015)) > 0.01"))
    part = bw.model {mesh = frame, material = bw.material.pla}
    local through = assert(bw.random_drops(part, {drops = 8, samples = 2, seed = 3,
      onto = bw.rigid.sphere {radius = 0.006}}))
    assert.is_true(through.misses > 0 and through.misses < 8)
    assert.equal(through.misses, through.forces:map("a == 0"):sum())
    assert.equal(through.misses, through.risks:map("a == 0"):sum())
    assert.truthy(tostring(through):find(("%d of them miss it"):format(through.misses), 1, true))
    local all, message, details = bw.random_drops(part, {drops = 4, onto = bw.rigid.sphere {radius = 1e-5}})
    assert.is_nil(all)
    assert.equal("geometry", details.status)
    assert.truthy(message:find("Make its radius larger", 1, true), message)
  end)

  it("at random refuses a peg that is too deep in any attitude before the first drop", function()
    local core = require "barwright.core"
    local report, reports = core.report_progress, 0
    finally(function() core.report_progress = report end)
    core.report_progress = function(...)
      reports = reports + 1
      return report(...)
    end
    local peg = bw.rigid.sphere {radius = 0.01}
    local part = box()
    assert(bw.random_drops(part, {drops = 1, samples = 2, seed = 5, onto = peg}))
    assert.is_true(reports > 0)
    reports = 0
    local drops, message, details = bw.random_drops(part, {drops = 40, samples = 2, seed = 5, onto = peg})
    assert.is_nil(drops)
    assert.equal("limit", details.status)
    assert.truthy(message:find("make elements smaller", 1, true), message)
    assert.equal(0, reports)
  end)

  it("at random reports progress of the search for misses, which can be stopped", function()
    local fractions = {}
    local before = bw.progress(function(stage, fraction)
      if stage == "which drops miss" then fractions[#fractions + 1] = fraction end
      return #fractions < 3
    end)
    finally(function() bw.progress(before) end)
    local drops, _, details = bw.random_drops(box(), {drops = 8, samples = 2})
    assert.is_nil(drops)
    assert.equal("cancelled", details.status)
    assert.same({0, 1 / 8, 2 / 8}, fractions)
  end)

  it("at random refuses a part whose strength is not known", function()
    local soft = bw.material.isotropic {young = 1e9, poisson = 0.3, density = 1000}
    local part = bw.model {mesh = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {1, 1, 1}}, material = soft}
    assert.error_matches(function() bw.random_drops(part, {drops = 2}) end, "strength")
    -- before the work: parts that would fail later are refused for the strength first
    part:fix(part.mesh.boundary:below("x", 0))
    assert.error_matches(function() bw.random_drops(part, {drops = 2}) end, "strength")
  end)
end)

describe("barwright drop", function()
  local folder = check.folder()
  local rod, cube = folder .. "rod.msh", folder .. "cube.stl"
  setup(function()
    assert(bw.mesh.box({max = {0.1, 0.01, 0.01}, cells = {30, 1, 1}, order = 2}):write(rod))
    local block = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {1, 1, 1}}
    assert(block:surface():write(cube, {unit = "mm"}))
  end)

  local function answer(words)
    local status, out, err = check.run("drop --json " .. words)
    return status, status < 2 and bw.json.decode(out) or out, err
  end

  it("has Saint-Venant's duration and force of a rod on its end", function()
    local status, object = answer("--young 1GPa --poisson 0 --density 1000 --strength 20MPa --height 0.2m "
      .. "--down -1,0,0 " .. rod)
    local speed = math.sqrt(2 * 9.80665 * 0.2)
    check.near(speed, object.speed_m_s, 1e-12)
    check.near(2 * 0.1 / 1000, object.duration_s, 0.05)
    check.near(1000 * 1000 * 1e-4 * speed, object.impulse_n_s / object.duration_s, 0.05)
    -- one mesh: nothing shows that the stress at the end does not depend on it
    assert.equal("unsure", object.verdict)
    assert.equal(1, status)
    assert.is_true(object.touch.depends_on_mesh)
    assert.equal("holds", object.elsewhere.verdict)
    assert.is_nil(object.duration_estimated_error)
    assert.is_true(object.energy_error < 1e-3)
  end)

  it("judges a face that lands flat, and not a corner", function()
    local flat = "--elements 400 --height 5mm --strength %s " .. cube
    local status, object = answer(flat:format "50MPa")
    assert.equal("holds", object.verdict)
    assert.equal(0, status)
    assert.is_false(object.touch.depends_on_mesh)
    status, object = answer(flat:format "10kPa")
    assert.equal("breaks", object.verdict)
    assert.equal(1, status)
    status, object = answer("--elements 400 --height 5mm --strength 1GPa --down -1,-2,-3 " .. cube)
    assert.equal("unsure", object.verdict)
    assert.equal(1, status)
    assert.is_true(object.touch.depends_on_mesh)
    assert.is_true(object.touch.utilisation < 0.1)
  end)

  it("calls a mesh too coarse where nothing is singular", function()
    local ball = folder .. "ball.stl"
    assert(assert(bw.surface.implicit(bw.shapes.sphere({0, 0, 0}, 0.02), {min = {-0.03, -0.03, -0.03},
      max = {0.03, 0.03, 0.03}, cells = 30})):write(ball))
    local words = "--elements 300 --height 1m --down -1,-2,-3 --material pla " .. ball
    local status, object = answer(words)
    assert.equal(1, status)
    assert.equal("unsure", object.verdict)
    assert.is_true(object.too_coarse)
    assert.is_false(object.singular)
    local _, out = check.run("drop " .. words)
    assert.truthy(out:find("the mesh is too coarse. Give more --elements.", 1, true), out)
    assert.is_nil(out:find("no finite value", 1, true))
  end)

  it("says what is assumed, and writes files", function()
    local words = ("--csv @d.csv --vtu @d.vtu --picture @d.png --report @d.html"):gsub("@", folder)
    local status, out = check.run(("drop %s --height 10mm --spin 0,10,0 %s"):format(rod, words))
    assert.equal(1, status)
    for _, text in ipairs {"The impact lasts", "The largest force is", "The impulse is", "error unknown: one mesh",
      "no friction", "rigid plane", "balance of energy", "it may depend on the mesh", "d.csv", "d.vtu",
      "d.png", "d.html"} do
      assert.truthy(out:find(text, 1, true), text .. "\n" .. out)
    end
    for _, name in ipairs {"d.csv", "d.vtu", "d.png"} do assert(io.open(folder .. name)):close() end
    local page = check.read(folder .. "d.html")
    assert.truthy(page:find("so that no drawing enters what it falls on", 1, true))
    assert.truthy(page:find('"factor":%d'))
    for _, sentence in ipairs {"The impact lasts", "The impulse is", "Verdict: "} do
      local line = out:match(sentence .. "[^\n]*")
      assert.truthy(page:find(line, 1, true), line)
    end
  end)

  it("falls on a peg and on an edge", function()
    local status, object = answer("--peg 50mm --height 10mm --at 30mm,5mm,0 " .. rod)
    assert.is_true(status < 2)
    assert.equal(0.05, object.peg_m)
    check.near(0.03, object.first_touch_m[1], 0.1)
    local words = "drop --edge 50mm --along 0,1,0 --height 10mm --report %se.html %s"
    local _, out = check.run(words:format(folder, rod))
    for _, text in ipairs {"rigid edge of radius 50 mm", "Nodes alone touch", "The largest force is"} do
      assert.truthy(out:find(text, 1, true), text .. "\n" .. out)
    end
    assert.truthy(check.read(folder .. "e.html"):find("rigid edge of radius 50 mm</p>", 1, true))
    _, object = answer("--edge 50mm --drops 3 --height 10mm " .. rod)
    assert.equal(0, object.misses)
    assert.is_true(object.shortest_duration_s > 0)
    local failed, _, err = check.run("drop --peg 1mm --at 30mm,50mm,0 " .. rod)
    assert.equal(3, failed)
    assert.truthy(err:find("misses the peg of radius 1 mm", 1, true), err)
    assert.truthy(err:find("or leave out --at", 1, true), err)
    failed, _, err = check.run("drop --edge 0.1mm --along 0,1,0 --at 50.8mm,0,0 " .. rod)
    assert.equal(3, failed)
    assert.truthy(err:find("the edge of radius 0.1 mm", 1, true), err)
    assert.truthy(err:find("give more --elements, or a larger radius", 1, true), err)
  end)

  it("drops at random and leaves the verdict open", function()
    local words = ("--picture @r.png --vtu @r.vtu --report @r.html"):gsub("@", folder)
    local status, out = check.run(("drop %s --height 10mm --drops 4 %s"):format(rod, words))
    assert.equal(1, status)
    for _, text in ipairs {"4 drops from 10 mm", "95 %", "Verdict: unsure", "r.png", "r.vtu", "r.html"} do
      assert.truthy(out:find(text, 1, true), text .. "\n" .. out)
    end
    assert.truthy(check.read(folder .. "r.html"):find(out:match "4 drops from[^\n]*", 1, true))
    local _, object = answer("--drops 4 --height 10m --strength 10kPa " .. rod)
    assert.equal(1, object.value)
    assert.equal("unsure", object.verdict)
    check.near(1 / (1 + 3.841459 / 4), object.low, 1e-5) -- Wilson's lower end where all fail
  end)

  it("names the options that help where too many nodes touch", function()
    assert(bw.mesh.box({max = {0.1, 0.1, 0.02}, cells = {32, 32, 1}, order = 2}):write(folder .. "flat.msh"))
    local status, _, err = check.run("drop " .. folder .. "flat.msh")
    assert.equal(3, status)
    assert.truthy(err:find("touch in one impact: give fewer --elements, or tilt the part by --down", 1, true), err)
  end)

  it("refuses what cannot be", function()
    for words, expected in pairs {["--down 0,0,0"] = "a direction expected", ["--down 1,2"] = "three numbers",
      ["--spin 1g,0,0"] = "rad/s", ["--height 1"] = "no unit", ["--height 0m"] = "above 0",
      ["--drops 3 --down 1,0,0"] = "random directions", ["--drops 3 --spin 1,0,0"] = "without spin",
      ["--drops 3 --csv a.csv"] = "history", ["--peg 1mm --edge 1mm"] = "leave out one", ["--peg 0mm"] = "above 0",
      ["--edge 1mm"] = "--along", ["--along 1,0,0"] = "give --edge", ["--at 1mm,0,0"] = "give --peg or --edge",
      ["--edge 1mm --along 0,0,0"] = "a direction expected", ["--edge 1mm --along 0,0,-2"] = "across --down",
      ["--peg 1mm --at 1,2,3"] = "no unit",
      ["--drops 3 --peg 1mm --at 0,0,0"] = "below the centre of mass", ["--damping 1"] = "above 0 and below 1"} do
      local status, _, err = check.run(("drop %s %s"):format(words, rod))
      assert.equal(2, status)
      assert.truthy(err:find(expected, 1, true), err)
    end
  end)
end)
