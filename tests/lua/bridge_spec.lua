-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bridges: free forms and their gradients, shapes of least area with known answers, the object, the design.
local bw = require "barwright"
local check = require "check"
local form_of = require "barwright.free_form"
local shape_design = require "barwright.shape_design"
local pulled_plate = dofile(check.root .. "/scenarios/verification/lib/pulled_plate.lua")

local full = os.getenv "BARWRIGHT_FULL" == "1"
local plastic = bw.material.isotropic {name = "plastic", young = 3e9, poisson = 0.35, density = 1200}

local function small_bridge(more)
  local opts = {span = 0.2, load = 1500, stress_limit = 30e6, material = plastic, thickness = 0.004,
    size = 0.005, wall = 0.006}
  for key, value in pairs(more or {}) do opts[key] = value end
  return bw.responsive.bridge(opts)
end

-- A strip pulled at its right end, fixed at x = 0; its upper edge is free, width w at both ends.
local function strip(width, bulge)
  local top = {}
  for i = 0, 10 do
    local x = 0.4 * (1 - i / 10)
    top[i + 1] = {x, width + bulge * math.sin(math.pi * x / 0.4) ^ 2, "free"}
  end
  top[1][3], top[11][3] = "fixed", "y"
  return form_of.create {{name = "strip", {controls = {{0, 0, "fixed"}}}, {line = true, tag = "bottom"},
    {controls = {{0.4, 0, "fixed"}}}, {line = true, tag = "end"},
    {controls = top, first = "clamped", last = "axis"}, {line = true, tag = "wall"}}}
end

local function strip_problem(limit)
  return {material = plastic, thickness = 1, limit = limit, wall = 0.01, gap = 0.01, size = 0.012,
    spacing = 0.04, conditions = {wall = {x = 0}, bottom = {y = 0}, ["end"] = {traction = {1e6, 0}}},
    smooth = 0.3, margin = 0.003, idle = 0.3, holes = 0, rounds = 45}
end

describe("a free form", function()
  it("has the gradients of differences, in area and in stress", function()
    local form, problem = strip(0.05, 0.03), strip_problem(1e6)
    local outline = assert(form:outline())
    local directions = form:directions()
    local sheet = assert(bw.responsive.steady {outline = outline, material = plastic, size = 0.012,
      order = 2, conditions = problem.conditions,
      solver = bw.solver.pcg {preconditioner = bw.solver.cholesky(), tolerance = 1e-12}})
    local _, by_points = sheet:stress_norm(12)
    local g = form:pull_back(by_points:totable(), directions)
    local a = form:pull_back(outline.area_gradient:totable(), directions)
    local step, slope, growth, h = {}, 0, 0, 2e-6
    for c = 1, #form.controls do
      step[c] = math.sin(3 * c)
      slope, growth = slope + g[c] * step[c], growth + a[c] * step[c]
    end
    local function at(t)
      local moved = {}
      for c = 1, #step do moved[c] = t * step[c] end
      local there = form:copy()
      there:move(directions, moved)
      local shape = assert(outline:with_points(there:points()))
      assert(sheet:become(shape))
      return (sheet:stress_norm(12)), shape.area
    end
    local high, more = at(h)
    local low, less = at(-h)
    check.near((high - low) / (2 * h), slope, 1e-4)
    check.near((more - less) / (2 * h), growth, 1e-7)
  end)

  it("keeps its shape when its knots are respaced, and its mirrored ends smooth", function()
    local circle = shape_design.circle("disc", 0.3, 0.1, 0.05, 16)
    circle.hole = nil
    -- the other way round: material inside
    local list = circle[1].controls
    for i = 1, #list // 2 do list[i], list[#list + 1 - i] = list[#list + 1 - i], list[i] end
    local form = form_of.create {circle}
    check.near(math.pi * 0.05 ^ 2, assert(form:outline()).area, 2e-3)
    check.near(form:outline().area, assert(form:respaced(0.012):outline()).area, 2e-3)
    local b = assert(small_bridge())
    local points = b.outline.points
    for _, segment in ipairs(b.outline.segments:totable()) do
      for k = 1, 4 do
        local p = segment[k] > 0 and points[segment[k]]
        assert.is_true(not p or p[1] >= 0)
      end
    end
  end)
end)

describe("a shape of least area", function()
  it("of a pulled strip is the strip of constant width", function()
    -- the end pulls with 1 MPa: at that limit the width is the end's everywhere
    local found = assert(shape_design.search(strip_problem(1.02e6), strip(0.05, 0.03)))
    assert.is_true(found.passes)
    check.near(0.4 * 0.05 / 1.02, found.area, 0.02)
  end)
end)

describe("the largest hole in a pulled plate", function()
  -- In an endless plate an ellipse with its axes in the ratio of the stresses has the same stress all around,
  -- sx + sy, which no hole can be below (Inglis 1913, Cherepanov 1974). With a limit of m (sx + sy), m = 1.08,
  -- other ratios r = a / b pass too: at the ends of an ellipse the stresses are sy (1 + 2 r) - sx and
  -- sx (1 + 2 / r) - sy, so that r lies between the bounds below; how large the hole gets depends on the plate,
  -- (a / 1)^2 < 0.08 here.
  it("is an ellipse with its axes in the ratio of the stresses, as stressed all around", function()
    local cases = {{1e6, 1e6}, {3e6, 2e6}}
    if full then cases[3] = {2e6, 1e6} end
    for _, case in ipairs(cases) do
      local sx, sy = case[1], case[2]
      local form, problem = pulled_plate.with_hole(sx, sy, 0.12, 1.08)
      local found = assert(shape_design.search(problem, form))
      local outline = assert(found.form:outline())
      local hole = pulled_plate.hole(assert(shape_design.sheet(problem, outline, problem.size)), outline)
      local ratio = hole.wide / hole.high
      local low, high = 2 * sx / (problem.limit + sy - sx), (problem.limit + sx - sy) / (2 * sy)
      assert.is_true(ratio >= low and ratio <= high, ("%g, %g to %g"):format(ratio, low, high))
      assert.is_true(hole.wide > 0.15)
      assert.is_true(hole.min > 0.8 * hole.max, ("%g, %g"):format(hole.min, hole.max))
      check.near(problem.limit, hole.max, 0.04)
    end
  end)
end)

describe("holes", function()
  it("become one where the wall between them carries nothing, and not where it does", function()
    -- pulled along x: behind a hole it is calm, beside it most is carried
    for _, case in ipairs {{{0.3, 0}, {0.46, 0}, 1}, {{0.38, -0.08}, {0.38, 0.08}, 2}} do
      local form, problem = pulled_plate.with_hole(1e6, 0, 0.02, 4)
      local loops = {form.loops[1]}
      for k = 1, 2 do
        loops[k + 1] = shape_design.circle("hole " .. k, case[k][1], case[k][2], 0.07, 14)
      end
      form = form_of.create(loops)
      problem.size, problem.holes, problem.idle = 0.02, 2, 0.5
      local sheet = assert(shape_design.sheet(problem, assert(form:outline()), problem.size))
      local one = shape_design.merged(problem, {sheet = sheet}, form)
      assert.equal(case[3], one and #one.loops - 1 or 2)
      if one then
        local outline = assert(one:outline())
        local two = form:outline()
        assert.equal(2, #outline.loops)
        -- the wall is gone, the holes are what they were
        assert.is_true(outline.area < two.area and outline.area > two.area - 0.02 * 0.14 - 0.003)
        problem.rounds = 9
        local found = assert(shape_design.search(problem, form))
        assert.equal(2, #found.form.loops)
        assert.is_true(found.passes)
      end
    end
  end)
end)

-- Where the half beam of length L ends above x: the only crossing of the vertical with its upper curve.
local function height_at(outline, x)
  local max = 0
  for _, polygon in ipairs(outline:polygons()) do
    local list = polygon:totable()
    for k, a in ipairs(list) do
      local b = list[k % #list + 1]
      if (a[1] > x) ~= (b[1] > x) then
        max = math.max(max, a[2] + (x - a[1]) / (b[1] - a[1]) * (b[2] - a[2]))
      end
    end
  end
  return max
end

describe("a beam of uniform strength", function()
  it("is as high as the root of the distance from its end", function()
    -- the right half of a beam with a straight underside, supported around x = L, loaded in its middle:
    -- 6 M / h^2 = limit with M = R (L - x)
    local L, foot, pad, middle, limit = 1, 0.05, 0.06, 0.12, 30e6
    local R = limit * middle ^ 2 / (6 * L)
    local top = {}
    for i = 0, 10 do
      local x = (L + foot / 2) * (1 - i / 10)
      top[i + 1] = {x, 0.14 - 0.06 * (1 - i / 10), "free"}
    end
    top[1] = {L + foot / 2, 0.03, "fixed"}
    top[11][3] = "y"
    local function vertex(x) return {controls = {{x, 0, "fixed"}}} end
    local form = form_of.create {{name = "beam", vertex(0), {line = true, tag = "fixed"}, vertex(0.004),
      {line = true, tag = "pad"}, vertex(pad), {line = true, tag = "under"}, vertex(L - foot / 2),
      {line = true, tag = "foot"}, vertex(L + foot / 2), {line = true, tag = "end"},
      {controls = top, first = "clamped", last = "axis"}, {line = true, tag = "axis"}}}
    local found = assert(shape_design.search({material = plastic, thickness = 1, limit = limit,
      wall = 0.02, gap = 0.02, size = 0.02, spacing = 0.1, smooth = 0.3, margin = 0.003, idle = 0.3,
      holes = 0, rounds = 40, conditions = {axis = {x = 0}, fixed = {y = 0},
        pad = {traction = {0, -R / pad}}, foot = {traction = {0, R / foot}}}}, form))
    assert.is_true(found.passes)
    local outline = found.form:outline()
    for i = 1, 9 do
      check.near(math.sqrt(6 * R * (L - i / 10) / limit), height_at(outline, i / 10), 0.08)
    end
  end)
end)

describe("a bridge", function()
  it("stands, is measured, and needs the beam that the theory of beams predicts", function()
    local b = assert(small_bridge())
    check.near(b.whole.area, b.area, 1e-9)
    assert.is_true(b.utilisation > 0.5 and b.utilisation < 1.5)
    assert.equal(b.utilisation <= 1, b.passes)
    local height, area = b:uniform_beam()
    -- stress 6 M / (t h^2) with M = F (L + bearing - pad / 2) / 4
    local opts = b.options
    local moment = opts.load / 4 * (opts.span + opts.bearing - opts.pad / 2)
    check.near(math.sqrt(6 * moment / (opts.thickness * opts.stress_limit)), height, 0.1)
    check.near((opts.span + 2 * opts.bearing) * height, area, 1e-9)
    local body = assert(b:body())
    check.near(b.area * opts.thickness, body.volume, 2e-3)
    assert.truthy(tostring(b):find "bridge of 200 mm")
  end)

  it("is dragged, pulled, smoothed and gets holes, while its feet and pad stay", function()
    local b = assert(small_bridge())
    local area = b.area
    assert(b:drag({vertex = 4}, {0.003, 0.004}))
    assert.not_equal(area, b.area)
    assert(b:hole({0.03, 0.04}, 0.008))
    assert.equal(3, #b.whole.loops)
    local before = b.area
    check.fails("geometry", "hole 1", b:drag({loop = "hole 1"}, {0, 0.5}))
    assert.equal(before, b.area)
    assert(b:smooth {rounds = 2})
    assert(b:without "hole 1")
    assert(b:pull(5, {0.06, 0.004}, {reach = 0.05}))
    check.fails("geometry", "has to stay", b:become(assert(bw.outline.rectangle {width = 0.1,
      height = 0.1})))
    local near = b.outline:nearest {0.03, 0}
    check.fails("geometry", "own image", b:drag({vertex = near.vertex}, {-0.05, -0.01}))
    local foot = b.outline:nearest {0.1, 0}
    assert(b:drag({vertex = foot.vertex}, {0, 0.001}))
    local at = b.outline.vertices[foot.vertex]
    assert.is_true(math.abs(at[1] - 0.1) + math.abs(at[2]) < 1e-12)
    check.raises("did you mean 'gable'", small_bridge, {start = "gabel"})
    check.raises("more than the limit", small_bridge, {pad = 0.001})
    check.raises("did you mean 'stress_limit'", small_bridge, {stress_limt = 1})
  end)

  it("says what it would carry where no shape passes, and where none can", function()
    local b = assert(small_bridge {load = 4000, size = 0.006})
    check.near(4 * 4000 / 4 * (0.2 + b.options.bearing - b.options.pad / 2) / (30e6 * 0.004 * 0.1 ^ 2),
      b:moment_fraction(), 1e-12)
    local found = assert(b:design {starts = {"gable"}, rounds = 2, polish = 0})
    assert.is_false(found.passes)
    assert.truthy(found.message:find "It carries %d+ N, or 4000 N with a thickness of [%d.]+ mm")
    local low = assert(small_bridge {depth = 0.04})
    local none = check.fails("infeasible", "no bridge of this depth", low:design())
    assert.is_nil(none)
  end)

  it("passes in other cases: twice the load, two thirds of the height", function()
    for _, case in ipairs {{load = 3000}, {depth = 0.07}} do
      case.size, case.wall = full and 0.003 or 0.004, 0.004
      local b = assert(small_bridge(case))
      local found = assert(b:design {starts = {full and "gable" or "beam"}, rounds = full and 70 or 12,
        polish = full and 20 or 0})
      assert.is_true(found.passes, found.message)
      local _, beam = b:uniform_beam()
      assert.is_true(b.area < beam)
    end
  end)

  -- A cable duct that is put in by hand, below the pad.
  it("is designed from the outline as it is, whose holes stay bit for bit", function()
    local b = assert(small_bridge {size = 0.006})
    assert(b:hole({0.02, 0.06}, 0.007))
    local holes = {}
    local function places()
      local list = {}
      for _, loop in ipairs(b.outline.loops) do
        if loop.name == "hole 1" then
          for n = loop.first, loop.first + loop.count - 1 do list[#list + 1] = b.outline:edge(n).from end
        end
      end
      return list
    end
    holes[1] = places()
    assert.is_true(#holes[1] >= 4)
    local reported
    local found = assert(b:design {rounds = 4, holes = 1, polish = 0, report = function(now)
      reported = reported or now
    end})
    assert.equal("current", found.start)
    assert.equal(1, #found.starts)
    assert.equal(2, #reported.outline.loops)
    assert.same(holes[1], places())
    -- the utilisation of the first round is that of the outline as it was, closely
    local same = assert(small_bridge {size = 0.006})
    assert(same:hole({0.02, 0.06}, 0.007))
    check.near(same.utilisation, reported.utilisation, 0.05)
    check.near(same.area, reported.area, 0.01)
    assert.equal(found.utilisation, b.utilisation)
    -- also where another start is asked for, or nothing else
    found = assert(b:design {starts = {"beam"}, rounds = 2, holes = 0, polish = 0})
    assert.equal("beam", found.start)
    assert.same(holes[1], places())
    assert.is_false(found.converged)
    check.fails("infeasible", "do not fit the start 'truss'", b:design {starts = {"truss"}, rounds = 1})
    check.raises("did you mean 'current'", b.design, b, {starts = {"curent"}})
    check.raises("is not known", small_bridge, {start = "current"})
  end)

  it("never passes with a utilisation above 1, and says when it did not converge", function()
    for _, rounds in ipairs {3, 6, 12} do
      local b = assert(small_bridge {size = 0.006})
      local found = assert(b:design {starts = {"beam"}, rounds = rounds, polish = 0})
      assert.equal(found.utilisation <= 1, found.passes)
      assert.equal(b.utilisation, found.utilisation)
      assert.equal(b.passes, found.passes)
      for _, start in ipairs(found.starts) do assert.is_true(not start.passes or start.utilisation <= 1) end
      if not found.converged then assert.is_string(found.message) end
    end
    local b = assert(small_bridge {size = 0.006})
    local found = assert(b:design {starts = {"beam"}, rounds = 3, polish = 0})
    assert.is_false(found.converged)
    assert.truthy(found.message:find("more rounds are needed", 1, true) or not found.passes)
  end)

  it("gets smaller by itself and passes, the same every time", function()
    local function run()
      local b = assert(small_bridge())
      local found = assert(b:design {starts = {"truss"}, rounds = full and 60 or 8, polish = full and 20 or 0})
      return b, found
    end
    local b, found = run()
    assert.is_true(found.passes and b.passes)
    local _, beam = b:uniform_beam()
    assert.is_true(b.area < 0.6 * beam and b.area > b:michell_area())
    if full then assert.is_true(b:check(0.002) <= 30e6 * 1.005) end
    assert.equal(b.area, (run()).area)
  end)

  it("whose image has no memory says so at the script's line", function()
    local bridge = assert(small_bridge {size = 0.02})
    require("barwright.core").fail_allocation(1, false)
    local ok, why = pcall(function() return bridge.whole end)
    require("barwright.core").fail_allocation(0, false)
    assert.is_false(ok)
    assert.truthy(why:find "^[^\n]*bridge_spec%.lua:%d+: out of memory", why)
  end)

  it("that is pulled a kilometre away stops when its progress is answered with false", function()
    local bridge, calls = assert(small_bridge {size = 0.02}), 0
    bw.progress(function()
      calls = calls + 1
      return calls < 20
    end)
    local pulled, message = bridge:pull(2, {0.05, -1000}, {reach = 0.05})
    bw.progress(nil)
    assert.is_nil(pulled)
    assert.equal("cancelled", message)
    assert.equal(20, calls)
  end)

  it("whose picture has no memory says so", function()
    local bridge, core, path = assert(small_bridge {size = 0.02}), require "barwright.core", os.tmpname()
    for n = 1, 60 do
      core.fail_allocation(n, false)
      local ok, written, why = pcall(bridge.picture, bridge, path .. ".svg")
      core.fail_allocation(0, false)
      if not (ok and written) then
        assert.truthy(tostring(ok and why or written):find "memory", tostring(ok and why or written))
      end
    end
    os.remove(path)
    os.remove(path .. ".svg")
  end)
end)
