-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bars that ring: pitches, drags, tuning, holding, sound, trimming.
local bw = require "barwright"
local check = require "check"
local pitch = require "barwright.pitch"

local function bar_of(length, width, given, more)
  local outline = assert(bw.outline.rectangle {min = {0, 0}, max = {length, width}})
  for _ = 1, 3 do outline = assert(outline:split(1, 0.5)) end
  more = more or {}
  return assert(bw.responsive.metallophone {outline = outline, thickness = 0.004,
    material = bw.material.aluminium, elements = given or 60, solver = more.solver, max_lag = more.max_lag})
end

local function fish(length)
  local s = length / 0.2
  local function p(x, y) return {x * s, y * s} end
  return assert(bw.outline {
    {p(0.1, 0.035), p(0.03, 0.035), p(0, 0)}, {p(0.03, -0.035), p(0.1, -0.035), p(0.15, -0.012)},
    p(0.2, -0.03), p(0.19, 0), p(0.2, 0.03), p(0.15, 0.012)})
end

describe("pitches", function()
  it("have names and cents", function()
    check.near(440, pitch.frequency "A4", 1e-12)
    check.near(523.2511306, pitch.frequency "C5", 1e-9)
    assert.equal(pitch.frequency "A#3", pitch.frequency "Bb3")
    assert.is_nil(pitch.frequency "H5")
    local name, above = pitch.note(445)
    assert.equal("A4", name)
    check.near(1200 * math.log(445 / 440, 2), above, 1e-9)
    check.near(1200, pitch.cents(880, 440), 1e-9)
  end)
end)

describe("a metallophone bar", function()
  it("rings as a slender free beam, and says so while it is dragged", function()
    local bar = bar_of(0.2, 0.02)
    local m = bw.material.aluminium
    local young, density = m.young, m.density
    local beam = 4.730040744862704 ^ 2 / (2 * math.pi * 0.2 ^ 2) *
      math.sqrt(young * 0.004 ^ 2 / 12 / density)
    check.near(1, bar.frequency / beam, 0.005)
    local before = bar.frequency
    local n = bar.outline:nearest({0.2, 0.01}).edge
    assert(bar:drag({edge = n}, {0.01, 0}))
    assert.is_true(bar.frequency < before)
    check.near(1, bar.frequency / (beam * (0.2 / 0.21) ^ 2), 0.005)
    assert.truthy(tostring(bar):find("Hz", 1, true))
    assert.truthy(tostring(bar.reused):find("relocation", 1, true))
    local direct = assert(bw.responsive.metallophone {outline = bar.outline, thickness = 0.004,
      material = m, elements = 60})
    check.near(1, bar.frequency / direct.frequency, 5e-4)
  end)

  it("takes LOBPCG alone, and reports it", function()
    for lag, factorisations in pairs {[0] = 1, [5] = 0} do
      local bar = bar_of(0.2, 0.03, nil, {solver = bw.eigensolver.lobpcg {}, max_lag = lag})
      assert.same({"lobpcg", "cholesky", "multifrontal"},
        {bar.report.solver, bar.report.preconditioner, bar.report.backend})
      assert.equal("there is no factor of this mesh yet", bar.report.reason)
      assert(bar:drag({vertex = 1}, {-0.001, 0}))
      assert.equal(factorisations, bar.reused.factorisations)
      assert.equal(bar.reused.iterations, bar.report.iterations)
      assert.is_true(bar.report.bytes > 0 and bar.report.residual <= 1e-4)
      assert.is_truthy(tostring(bar):find(tostring(bar.report), 1, true))
    end
    for _, bad in ipairs {bw.eigensolver.lanczos {}, bw.eigensolver.arpack {},
      bw.eigensolver.lobpcg {preconditioner = bw.solver.amg()}} do
      check.raises("does not serve plates that follow an outline: give lobpcg", bar_of, 0.2, 0.03, nil,
        {solver = bad})
    end
    check.raises("option 'solver'", bar_of, 0.2, 0.03, nil, {solver = bw.solver.cholesky()})
  end)

  it("has a gradient that is that of differences", function()
    local bar = bar_of(0.2, 0.03)
    local g = assert(bar:gradient()):totable()
    local outline, values, predicted = bar.outline, {}, 0
    for side, by in ipairs {1e-5, -1e-5} do
      local points = outline.points:totable()
      for i, point in ipairs(points) do
        local dx, dy = math.sin(3 * i), math.cos(5 * i)
        point[1], point[2] = point[1] + by * dx, point[2] + by * dy
        if side == 1 then predicted = predicted + 2e-5 * (g[i][1] * dx + g[i][2] * dy) end
      end
      assert(bar:become(assert(outline:with_points(points))))
      values[side] = bar.frequency
    end
    check.near(1, (values[1] - values[2]) / predicted, 1e-3)
  end)

  it("is tuned to a pitch within a cent, moved little", function()
    local bar = assert(bw.responsive.metallophone {outline = fish(0.2), thickness = 0.004,
      material = bw.material.aluminium, elements = 150})
    local result = assert(bar:tune("C5"))
    assert.is_true(math.abs(result.cents) < 1)
    assert.is_true(result.moved < 0.05)
    local fine = assert(bw.responsive.metallophone {outline = bar.outline, thickness = 0.004,
      material = bw.material.aluminium, elements = 2000})
    assert.is_true(math.abs(pitch.cents(fine.frequency, pitch.frequency "C5")) < 1)
    assert.has_error(function() bar:tune("H5") end)
    -- from far away, and up: the narrow place of the fish is not pinched
    local far = assert(bw.responsive.metallophone {outline = fish(0.17), thickness = 0.004,
      material = bw.material.aluminium, elements = 150})
    assert(math.abs(assert(far:tune "C5").cents) < 1)
    assert.is_true(far.outline.area > 0.8 * bar.outline.area)
  end)

  -- An even bar: bending modes of an Euler-Bernoulli beam, torsion of St Venant, bending in the plane with the
  -- width in the place of the thickness.
  it("names its modes", function()
    local length, width, thick, nu = 0.3, 0.03, 0.004, 0.33
    local rotated = assert(bw.outline.rectangle {min = {0, 0}, max = {length, width}}):rotated(30)
    local bar = assert(bw.responsive.metallophone {outline = rotated, thickness = thick, elements = 200, modes = 7,
      material = bw.material.isotropic {name = "alloy", young = 70e9, poisson = nu, density = 2700}})
    local first = {}
    local last = 0
    for _, mode in ipairs(assert(bar:spectrum())) do
      assert.is_true(mode.frequency >= last)
      last = mode.frequency
      if mode.mode then assert.equal(bar.frequencies[mode.mode], mode.frequency) end
      first[mode.kind .. " " .. mode.number] = mode.frequency
    end
    local speed = math.sqrt(70e9 / 2700)
    for n, root in ipairs {4.7300, 7.8532, 10.9956} do
      local wanted = root ^ 2 / (2 * math.pi * length ^ 2) * speed * thick / math.sqrt(12)
      check.near(wanted, first["bending " .. n], 0.02)
    end
    check.near(math.sqrt(1 / (2 * (1 + nu))) * speed * thick / width / length, first["torsion 1"], 0.05)
    check.near(first["torsion 1"] * 2, first["torsion 2"], 0.05)
    -- sheared and rotated, a deep beam is softer
    check.near(4.73 ^ 2 / (2 * math.pi * length ^ 2) * speed * width / math.sqrt(12), first["in-plane 1"], 0.06)
  end)

  it("follows a mode while one of another kind passes it", function()
    local places = {}
    for i, width in ipairs {0.028, 0.036} do
      local bar = assert(bw.responsive.metallophone {thickness = 0.006, elements = 200, modes = 5,
        outline = assert(bw.outline.rectangle {min = {0, 0}, max = {0.3, width}}),
        material = bw.material.isotropic {name = "alloy", young = 70e9, poisson = 0.33, density = 2700}})
      for _, mode in ipairs(assert(bar:spectrum())) do
        if mode.kind == "bending" and mode.number == 3 then
          check.near(1878, mode.frequency, 0.01)
          places[i] = mode.mode
        end
      end
    end
    assert.same({3, 4}, places)
  end)

  it("is tuned in several modes at once", function()
    local outline = assert(bw.outline.rectangle {min = {0, 0}, max = {0.3, 0.04}})
    for edge = 7, 1, -2 do outline = assert(outline:split(math.min(edge, outline.edge_count), 0.5)) end
    for edge = outline.edge_count, 1, -1 do outline = assert(outline:split(edge, 0.5)) end
    local function bar_of_modes(thickness)
      return assert(bw.responsive.metallophone {outline = outline, thickness = thickness, elements = 200,
        material = bw.material.isotropic {name = "alloy", young = 70e9, poisson = 0.33, density = 2700}})
    end
    local bar = bar_of_modes(0.006)
    local found = assert(bar:tune(350, {ratios = {1, 3}, move_limit = 0.35, finer = 1}))
    assert.equal(2, #found.modes)
    for k, mode in ipairs(found.modes) do
      assert.is_true(math.abs(mode.cents) < 0.5)
      check.near(350 * (2 * k - 1), mode.frequency, 1e-3)
    end
    local three = assert(bw.responsive.metallophone {outline = bar.outline, thickness = 0.006, elements = 800,
      modes = 4, material = bar.opts.material})
    local kinds = {}
    for _, mode in ipairs(assert(three:spectrum())) do kinds[mode.kind .. mode.number] = mode.frequency end
    check.near(3, kinds.bending2 / kinds.bending1, 0.01)
    -- what the outline cannot do is reported, and nothing has changed
    local none = bar_of_modes(0.006)
    local before = none.outline
    local nothing, message, details = none:tune(350, {ratios = {1, 4, 10}, finer = 1})
    assert.is_nil(nothing)
    assert.truthy(message:find("Hz", 1, true) and #details.frequencies == 3)
    assert.equal(before.area, none.outline.area)
    check.raises("each above the one before", none.tune, none, 350, {ratios = {1, 1}})
  end)

  it("reaches 1 : 4 : 10 in stages, past a mode of another kind", function()
    local outline = assert(bw.outline.rectangle {min = {0, 0}, max = {0.3, 0.06}})
    for edge = 7, 1, -2 do outline = assert(outline:split(math.min(edge, outline.edge_count), 0.5)) end
    for edge = outline.edge_count, 1, -1 do outline = assert(outline:split(edge, 0.5)) end
    local bar = assert(bw.responsive.metallophone {outline = outline, thickness = 0.004, elements = 150, modes = 5,
      material = bw.material.isotropic {name = "alloy", young = 70e9, poisson = 0.33, density = 2700}})
    local function frequencies()
      local by_name = {}
      for _, mode in ipairs(assert(bar:spectrum())) do by_name[mode.kind .. mode.number] = mode.frequency end
      return by_name
    end
    local before = frequencies()
    assert.is_true(before.torsion1 > before.bending2)
    local found = assert(bar:tune(220, {ratios = {1, 4, 10}, move_limit = 0.45, stages = 8, finer = 1}))
    for k, ratio in ipairs {1, 4, 10} do
      assert.is_true(math.abs(found.modes[k].cents) < 0.1)
      check.near(220 * ratio, found.modes[k].frequency, 1e-4)
      assert.equal("bending", found.modes[k].kind)
    end
    local after = frequencies()
    assert.is_true(after.torsion1 < after.bending2)
    check.near(4, after.bending2 / after.bending1, 1e-3)
  end)

  it("moves the outline less than other changes that hit the pitch", function()
    local outline = assert(bw.outline.rectangle {min = {0, 0}, max = {0.2, 0.03}})
    for edge = 7, 1, -2 do outline = assert(outline:split(math.min(edge, outline.edge_count), 0.5)) end
    local bar = assert(bw.responsive.metallophone {outline = outline, thickness = 0.004,
      material = bw.material.aluminium, elements = 100})
    local wanted = bar.frequency * 2 ^ (50 / 1200)
    local result = assert(bar:tune(wanted, {finer = 1}))
    -- scaling in the plane by 1 - e hits it too: f goes with the inverse square of the size
    local scale = 1 - 2 ^ (-25 / 1200)
    local ours, scaling = 0, 0
    local to = bar.outline.points:totable()
    for i, at in ipairs(outline.points:totable()) do
      ours = ours + (to[i][1] - at[1]) ^ 2 + (to[i][2] - at[2]) ^ 2
      scaling = scaling + scale ^ 2 * ((at[1] - 0.1) ^ 2 + (at[2] - 0.015) ^ 2)
    end
    assert.is_true(ours < scaling)
    assert.is_true(result.rounds < 20)
    check.near(wanted, bar.frequency, 1e-3)
  end)

  it("follows an outline that becomes ten times as large, in a few rounds", function()
    local bar = bar_of(0.2, 0.04, 120)
    local small = bar.frequency
    assert(bar:become(assert(bar.outline:scaled(10))))
    check.near(small / 100, bar.frequency, 0.02)
    assert.is_true(bar.reused.iterations < 10)
  end)

  it("is thinner than long", function()
    local outline = assert(bw.outline.rectangle {width = 0.2, height = 0.02})
    for _, thickness in ipairs {0.3, 1e-12} do
      check.fails("geometry", "thinner than long", bw.responsive.metallophone {outline = outline,
        material = bw.material.isotropic {young = 70e9, poisson = 0.33, density = 2700},
        thickness = thickness})
    end
  end)

  it("says where to support and where to trim it", function()
    local bar = bar_of(0.2, 0.02, 120)
    local holes = assert(bar:holes())
    table.sort(holes, function(a, b) return a[1] < b[1] end)
    check.near(0.2242 * 0.2, holes[1][1], 0.03)
    check.near((1 - 0.2242) * 0.2, holes[2][1], 0.01)
    for _, hole in ipairs(holes) do check.near(0.01, hole[2], 0.4) end
    -- too low: the ends; too high: the middle
    local up = assert(bar:trim(515, 523))
    assert.is_true(math.min(up[1].at[1], 0.2 - up[1].at[1]) < 0.03)
    local down = assert(bar:trim(531, 523))
    assert.is_true(math.abs(down[1].at[1] - 0.1) < 0.02)
    assert.is_true(up[1].depth > 0 and down[1].depth > 0)
    assert.is_true(up[1].cents > 0 and down[1].cents < 0)
    -- No cut passes the bar, neither the best nor the last of many; the largest change is named.
    local many = assert(bar:trim(515, 523, {places = 8}))
    for _, place in ipairs(many) do
      local along = place.at[1] < 1e-6 or place.at[1] > 0.2 - 1e-6
      assert.is_true(place.depth <= (along and 0.1 or 0.01) + 1e-9, place.depth)
    end
    check.fails("infeasible", "half the width", bar:trim(60, 523))
  end)

  it("knows vibrations within its plane", function()
    local narrow = bar_of(0.2, 0.003)
    assert.is_true(narrow:inplane(1)(1) < narrow.frequency)
    local wide = bar_of(0.2, 0.02)
    assert.is_true(wide:inplane(1)(1) > wide.frequency)
  end)

  it("makes a scale from one command", function()
    local folder = os.tmpname()
    os.remove(folder)
    local script = check.root .. "/scripts/metallophone/run.lua"
    local status, out = check.run(("'%s' --out %s --notes B5 --shape leaf --elements 100"):format(
      script, folder))
    assert.equal(0, status, out)
    local result = bw.json.decode(assert(io.open(folder .. "/result.json")):read "a")
    assert.is_true(math.abs(result.bars[1].cents) < 1)
    local cut = assert(bw.outline.read(folder .. "/B5.dxf"))
    assert.equal(3, #cut.loops)
    check.near(result.bars[1].area_m2, cut.area, 1e-6)
    os.execute("rm -r " .. folder)
    local refused, _, message = check.run(("'%s' --out %s --shap fish"):format(script, folder))
    assert.equal(2, refused)
    assert.truthy(message:find("--shape", 1, true))
  end)

  it("sounds", function()
    local bar = assert(bw.responsive.metallophone {outline = fish(0.2), thickness = 0.004,
      material = bw.material.aluminium, elements = 100, modes = 4})
    local samples = assert(bar:tone {seconds = 0.5, rate = 8000})
    assert.equal(4000, samples.row_count)
    -- with one mode left of two strokes: the amplitudes are as the gains
    local here, there = {at = {0.19, 0.0}, contact = 0}, bar:gains {at = {0.1, 0}, contact = 0}:totable()
    local gains = bar:gains(here):totable()
    local shapes = {}
    assert.equal(4, #gains)
    for k = 1, 4 do shapes[k] = math.abs(gains[k]) end
    assert.equal(1, math.max(table.unpack(shapes)))
    assert.equal(1, math.max(table.unpack(bar:gains():map("abs(a)"):totable())))
    assert.not_equal(gains[2], there[2])
    check.near(0.9, math.max(samples:max(), -samples:min()), 1e-12)
    local path = os.tmpname()
    assert(bar:write_tone(path, {seconds = 0.1}))
    local file = assert(io.open(path, "rb"))
    local text = file:read "a"
    file:close()
    os.remove(path)
    assert.equal("RIFF", text:sub(1, 4))
    assert.equal(44 + 2 * 4410, #text)
    local ok, message = bar:write_tone("/nowhere/x.wav")
    assert.is_nil(ok)
    assert.truthy(message:find("nowhere", 1, true))
  end)

  it("refuses a drag that folds it, and keeps its tone", function()
    local bar = bar_of(0.2, 0.02)
    local before = bar.frequency
    local ok, message = bar:drag({vertex = 1}, {0.5, 0.5})
    assert.is_nil(ok)
    assert.is_string(message)
    assert.equal(before, bar.frequency)
  end)
end)
