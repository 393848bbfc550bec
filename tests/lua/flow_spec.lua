-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Flow and heat whose outline is dragged: closed forms, what was reused, forces, signals, refusals.
local bw = require "barwright"
local check = require "check"

local function pipe()
  return assert(bw.outline.rectangle {width = 2, height = 1,
    tags = {bottom = 1, outlet = 2, top = 3, inlet = 4}})
end

local function tunnel(x)
  return assert(bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}},
    tags = {sides = {1, 3}, outlet = 2, inlet = 4},
    holes = {bw.outline.circle {centre = {x or 0.5, 0.5}, radius = 0.1, name = "body", tag = "body"}}})
end

local around = {inlet = {x = 1, y = 0}, sides = {y = 0}, body = "wall"}

local function wind(more)
  local options = {outline = tunnel(), viscosity = 0.01, elements = 500, conditions = around, step = 0.02}
  for key, value in pairs(more or {}) do options[key] = value or nil end
  return bw.responsive.flow(options)
end

-- A cavity whose lid is called so, 0.16 m2/s viscosity; its conditions by the lid's name.
local function cavity(lid, conditions_of, kind)
  local outline = assert(bw.outline.rectangle {width = 1, height = 1,
    tags = {floor = 1, right = 2, [lid] = 3, left = 4}})
  return assert(bw.responsive[kind or "flow"] {outline = outline, viscosity = 0.16, size = 0.1, steady = true,
    diffusivity = kind and 1, conditions = conditions_of(lid)})
end

describe("conditions that meet at a corner", function()
  local function unordered(lid)
    return {[lid] = {x = 1, y = 0}, floor = "wall", left = "wall", right = "wall"}
  end

  it("do not obey their names", function()
    bw.warnings()
    local s = cavity("ceiling", unordered)
    assert.equal(0, (s:at(0, 1)))
    assert.equal(0, (s:at(1, 1)))
    assert.same({"conditions conflict at (0, 1): tag 'left' prescribes x = 0, tag 'ceiling' 1; 0 is used; "
      .. "conditions in a list are ordered, and the last one decides",
      "conditions conflict at (1, 1): tag 'right' prescribes x = 0, tag 'ceiling' 1; 0 is used; "
      .. "conditions in a list are ordered, and the last one decides"}, (function(list)
        table.sort(list)
        return list
      end)(bw.warnings()))
    for _, lid in ipairs {"top", "a", "z"} do
      local other = cavity(lid, unordered)
      for _, y in ipairs {0.1, 0.5, 0.9} do assert.same({s:at(0.5, y)}, {other:at(0.5, y)}) end
    end
  end)

  it("obey the order of a list, the last one first", function()
    bw.warnings()
    for lid_last, corner in pairs {[true] = 1, [false] = 0} do
      for _, lid in ipairs {"ceiling", "top"} do
        local s = cavity(lid, function(name)
          local walls, lids = {floor = "wall", left = "wall", right = "wall"}, {[name] = {x = 1, y = 0}}
          return lid_last and {walls, lids} or {lids, walls}
        end)
        assert.equal(corner, (s:at(0, 1)))
        local wanted = ("%d is used, of the condition that is given last"):format(corner)
        assert.is_truthy(bw.warnings()[1]:find(wanted, 1, true))
      end
    end
  end)

  it("take the mean of temperatures, and what one of them leaves free from the other", function()
    for _, lid in ipairs {"ceiling", "top"} do
      local s = cavity(lid, function(name)
        return {[name] = {y = 0, temperature = 30}, left = {x = 0, y = 0, temperature = 10}, right = "wall",
          floor = "wall"}
      end, "thermal")
      assert.equal(20, (select(4, s:at(0, 1))))
      assert.equal(30, (select(4, s:at(1, 1))))
      assert.equal(0, (s:at(0, 1)))
    end
  end)

  it("that agree are no conflict", function()
    bw.warnings()
    cavity("top", function(name)
      return {[name] = {x = "x*(1 - x)", y = 0}, floor = "wall", left = "wall", right = "wall"}
    end)
    assert.same({}, bw.warnings())
  end)

  it("are refused as a list that is none", function()
    local function with(conditions) return function() wind {conditions = conditions} end end
    check.raises("both: 'inlet' is beside the list", with {{body = "wall"}, inlet = {x = 1, y = 0}})
    check.raises("names 'body' twice", with {{body = "wall"}, {body = {x = 0}}})
    check.raises("entry 2 of the list of conditions: {tag = ...} expected, got string",
      with {{body = "wall"}, "wall"})
  end)
end)

describe("a steady flow", function()
  it("is Poiseuille's in a channel, also driven by pressure", function()
    local profile = {x = "4*y*(1 - y)", y = 0}
    local wanted = 8 * 0.1 * 2 -- 8 mu U / h2 times the length
    for _, inlet in ipairs {profile, {pressure = wanted, y = 0}} do
      local s = assert(bw.responsive.flow {outline = pipe(), viscosity = 0.1, size = 0.08, steady = true,
        conditions = {bottom = "wall", top = "wall", inlet = inlet, outlet = {y = 0}}})
      check.near(1, s:at(1, 0.5), 0.02)
      check.near(wanted * 0.5, s:pressure_drop({0.5, 0.5}, {1.5, 0.5}), 0.03)
      local x = s:force "bottom"
      check.near(wanted / 2, x, 0.1) -- half of what the pressure drives; the corners are the ends' own
      check.near(-4, s.vorticity:min(), 0.1)
    end
  end)

  it("is recomputed in every drag, as from scratch", function()
    local s = assert(wind {steady = true, elements = 1500})
    for _ = 1, 6 do assert(s:drag({loop = "body"}, {0.05, 0})) end
    local rebuilt = assert(wind {steady = true, elements = 1500, outline = tunnel(0.8)})
    local about = {velocity = 1, length = 0.2}
    check.near((rebuilt:coefficients("body", about)), (s:coefficients("body", about)), 0.03)
    assert.is_true(s.reused.solution)
  end)

  it("is warmed by fluxes and cooled by convection", function()
    local still = {x = 0, y = 0}
    local function wall(more)
      local conditions = {inlet = {x = 0, y = 0, heat_flux = 0.7}, top = still, bottom = still,
        outlet = {x = 0, y = 0, convection = {coefficient = 2, temperature = "5 + 0*t"}}}
      for tag, condition in pairs(more or {}) do conditions[tag] = condition end
      return bw.responsive.thermal {outline = pipe(), viscosity = 1, diffusivity = 0.5, size = 0.2,
        steady = true, conditions = conditions}
    end
    local s = assert(wall())
    local _, _, _, temperature = s:at(1, 0.5)
    check.near(5 + 0.7 / 2 + 0.7 / 0.5, temperature, 1e-6)
    check.near(0.7, s:heat "inlet", 1e-9)
    check.near(-0.7, s:heat "outlet", 1e-6)
    assert.equal(0, s:heat "top")
    assert(s:drag({edge = 2}, {1, 0})) -- 3 m long
    _, _, _, temperature = s:at(0, 0.5)
    check.near(5 + 0.7 / 2 + 3 * 0.7 / 0.5, temperature, 1e-6)
    local function by_height(_, y) return 1.4 * y end
    local by_function = assert(wall {inlet = {x = 0, y = 0, heat_flux = by_height}})
    check.near(0.7, by_function:heat "inlet", 1e-9)
    check.raises("no steady state", wall, {outlet = still})
    check.raises("did you mean 'coefficient'", wall, {outlet = {convection = {coeficient = 1}}})
    check.raises("coefficient = m/s", wall, {outlet = {convection = {coefficient = -1, temperature = 0}}})
    check.raises("give one of them", wall,
      {outlet = {temperature = 1, convection = {coefficient = 1, temperature = 0}}})
    check.raises("unknown key 'heat_flux'", wind, {conditions = {body = {heat_flux = 1}}})
  end)

  it("conducts where nothing moves", function()
    local s = assert(bw.responsive.thermal {outline = pipe(), viscosity = 1, diffusivity = 0.5, size = 0.2,
      steady = true, conditions = {inlet = {x = 0, y = 0, temperature = 3}, top = "wall", bottom = "wall",
        outlet = {x = 0, y = 0, temperature = 1}}})
    check.near(0.5, s:heat "inlet", 1e-6) -- alpha dT / length times the height
    check.near(-0.5, s:heat "outlet", 1e-6)
    check.near(0.5, s:nusselt("inlet", 2), 1e-6)
    local _, _, _, temperature = s:at(0.5, 0.5)
    check.near(2.5, temperature, 1e-6)
    assert.equal(3, s.temperature:max())
  end)
end)

describe("a flow in time", function()
  it("goes on through drags and says what it reused", function()
    local s = assert(wind())
    assert(s:step(5))
    for _ = 1, 8 do
      assert(s:drag({loop = "body"}, {0.02, 0}))
      assert(s:step())
      assert.equal(1, s.reused.solves)
      assert.is_true(s.reused.solution)
    end
    assert.truthy(tostring(s.reused):find "^re")
    check.near(13 * 0.02, s.time, 1e-9)
    assert.equal(s.node_count, #s.pressure)
    assert.is_nil(rawget(s, "temperature"))
    assert(s:settle())
    assert.is_true((s:coefficients("body", {velocity = 1, length = 0.2})) > 0)
  end)

  it("answers after drags as a solve from scratch on the same mesh does", function()
    local a = assert(wind {solver = bw.solver.bicgstab {tolerance = 1e-12}})
    local b = assert(wind {max_lag = 0,
      solver = bw.solver.bicgstab {preconditioner = bw.solver.lu {full = true}, tolerance = 1e-12}})
    for _ = 1, 6 do
      for _, s in ipairs {a, b} do
        assert(s:drag({loop = "body"}, {0.03, 0.01}))
        assert(s:step(2))
      end
    end
    local off = (a.velocity - b.velocity):map "abs(a)"
    assert.is_true(off:max() < 1e-6 * a.velocity:max())
  end)

  it("gives one answer by every solver that serves, and says what it did", function()
    local function after(more)
      local s = assert(wind(more))
      assert(s:step(3))
      assert(s:drag({loop = "body"}, {0.005, 0}))
      return assert(s:step())
    end
    local auto = after {}
    assert.is_truthy(auto.report.reason:find("cost least", 1, true))
    for _, row in ipairs {{bw.solver.bicgstab {tolerance = 1e-9}, "bicgstab", "lu", 0},
      {bw.solver.lu(), "lu", nil, 1}, {bw.solver.lu {full = true}, "lu", nil, 1}} do
      local s = after {solver = row[1]}
      local report = s.report
      assert.same({row[2], row[3], "barwright", "it was given"},
        {report.solver, report.preconditioner, report.backend, report.reason})
      assert.equal(row[4], s.reused.factorisations)
      assert.is_true(report.bytes > 0 and report.residual <= 1e-6)
      assert.is_truthy(tostring(s):find(tostring(report), 1, true))
      assert.is_true((s.velocity - auto.velocity):norm() < 1e-4 * auto.velocity:norm())
    end
    for _, bad in ipairs {bw.solver.cholesky(), bw.solver.pcg {preconditioner = bw.solver.cholesky()},
      bw.solver.pcg(), bw.solver.jacobi()} do
      local s = assert(wind {solver = bad})
      check.raises("give lu, or bicgstab", s.step, s)
    end
    local both = assert(wind {solver = bw.solver.lu(), max_lag = 2})
    check.raises("max_lag has no effect", both.step, both)
  end)

  it("records signals and finds their frequency", function()
    local s = assert(wind {conditions = {inlet = {x = "1 + 0.2*sin(20*t)", y = 0}, sides = {y = 0},
      body = "wall"}})
    s:record("speed", function(flow) return (flow:at(0.05, 0.5)) end)
    assert(s:step(100))
    assert.equal(100, #s.signals.speed)
    check.near(20 / (2 * math.pi), s:frequency("speed", 4), 0.02)
    s:record "speed"
    check.raises("no signal 'speed'", s.frequency, s, "speed")
    s:record("speed", function(flow) return (flow:at(0.05, 0.5)) end)
    assert(s:step(2))
    assert(s:pace(0.005):step(200)) -- which has a new signal
    assert.equal(200, #s.signals.speed)
    check.near(2 + 0.04 + 1, s.time, 1e-9)
    check.near(20 / (2 * math.pi), s:frequency("speed", 2), 0.05)
    check.raises("seconds above 0", s.pace, s, 0)
  end)

  it("takes sizes as formulas and functions", function()
    local even = assert(wind {size = 0.1, elements = false})
    for _, size in ipairs {"max(0.02, 0.1*x)", function(x) return math.max(0.02, 0.1 * x) end} do
      local s = assert(wind {size = size, elements = false, follow = {level = "reconstruction"}})
      assert.is_true(s.element_count > 2 * even.element_count)
      assert(s:drag({loop = "body"}, {0.1, 0}))
      assert(s:step())
    end
    check.raises("no size here", wind, {size = function() error "no size here" end, elements = false})
  end)

  it("keeps its last good state when a drag is refused", function()
    local s = assert(wind())
    assert(s:step(3))
    local before = s.velocity:max()
    check.fails("geometry", "body", s:drag({loop = "body"}, {2, 0}))
    assert.equal(before, s.velocity:max())
    assert(s:step())
  end)

  it("has its steady state back bit for bit when a drag finds none", function()
    local s = assert(wind {steady = true, viscosity = 0.005, elements = 700})
    local function bits()
      return s.velocity:tostring "<f8" .. s.pressure:tostring "<f8" .. s.points:tostring "<f8"
    end
    local before, drag, level = bits(), s:force "body", tostring(s.reused)
    s.opts.tolerance = 1e-30 -- which none is found to
    check.fails("convergence", "was requested", s:drag({loop = "body"}, {0.1, 0}))
    assert.equal(before, bits())
    assert.equal(drag, (s:force "body"))
    assert.equal(level, tostring(s.reused))
    s.opts.tolerance = 1e-8
    assert(s:drag({loop = "body"}, {0.05, 0}))
    assert.not_equal(before, bits())
    check.raises("state expected", s.body.restore, s.body, 1)
    -- a state outlives its flow; what it was asked to hold there is gone
    local function speed(_, y) return y end
    local moving = {conditions = {inlet = {x = speed, y = 0}, sides = {y = 0}, body = "wall"}, elements = 200}
    local kept = assert(wind(moving)).body:save()
    collectgarbage()
    collectgarbage()
    local other = assert(wind(moving))
    assert(other.body:restore(kept))
    assert(other:step(2))
    check.raises("another flow", s.body.restore, assert(wind {elements = 200, conditions = {
      inlet = {x = 1, y = 0}}}).body, kept)
  end)

  it("refuses what cannot be, and names the nearest", function()
    check.raises("'viscosity' is missing", bw.responsive.flow, {outline = pipe()})
    check.raises("did you mean 'inlet'", wind, {conditions = {inlt = "wall"}})
    check.raises("\"wall\" or a table", wind, {conditions = {body = "fixed"}})
    check.raises("unknown key 'temperature'", wind, {conditions = {body = {temperature = 1}}})
    check.raises("did you mean 'body'", function() wind():force "bodi" end)
    check.raises("no solution on the present mesh", function() wind():force "body" end)
    check.raises("give the option 'step'", function() wind({step = false}):step() end)
    check.raises("a whole number of steps", function() wind():step(0) end)
    check.raises("'size'", wind, {size = -1, elements = false})
    check.raises("'elements' and 'size'", wind, {size = 0.1})
    check.raises("did you mean 'pressure'", function() return wind().presure end)
    check.raises("oops", function() wind({conditions = {body = {x = function() error "oops" end}}}):step() end)
  end)
end)

-- Drags of every kind of handle, small and far too large, with a step after each: done or refused, and
-- the state is good after it. All 10,000 with BARWRIGHT_FULL=1.
describe("random drags", function()
  local count = os.getenv "BARWRIGHT_FULL" and 10000 or 200
  local function kettle(more)
    return bw.responsive.thermal {ale = more.ale, outline = tunnel(), viscosity = 0.01, diffusivity = 0.01,
      elements = 200, expansion = 1, gravity = {0, -1}, step = 0.1,
      conditions = {sides = {x = 0, y = 0, temperature = 1}, inlet = "wall",
        outlet = "wall", body = {x = 0, y = 0, temperature = 0}}}
  end
  for name, make in pairs {flow = wind, thermal = kettle} do
    for _, ale in ipairs {false, true} do
      it(("leave a good state: %s%s"):format(name, ale and ", moving mesh" or ""), function()
        local s = assert(make {elements = 200, ale = ale})
        local random = check.random(4321)
        local done, refused = 0, 0
        for i = 1, count do
          local handle = random() < 0.5 and {loop = "body"}
            or {vertex = 1 + math.floor(random() * s.outline.edge_count)}
          local reach = random() < 0.1 and 3 or 0.1
          local ok, message, details = s:drag(handle, {reach * (random() - 0.5), reach * (random() - 0.5)})
          if ok then
            done = done + 1
            assert.is_true(s.reused.level == "none" or s.reused.quality > 0)
          else
            refused = refused + 1
            assert(type(message) == "string" and details.status ~= "internal", message)
          end
          assert(s:step())
          local max = s.velocity:max()
          assert(max == max and max < 1e4, max) -- 1 m/s through gaps of a millimetre
          if i % 40 == 0 then assert(s:become(tunnel())) end -- wandered off: begin again
        end
        assert.is_true(done > 0.5 * count and refused > 0)
      end)
    end
  end

  it("is left by a progress function that returns false, however many steps were asked for", function()
    local s = assert(wind {elements = 60})
    local before = bw.progress(function(stage) return stage ~= "time steps" end)
    for _ = 1, 2 do
      check.fails("cancelled", "", s:step(math.maxinteger))
      s:record("drag", function(flow) return (flow:force "body") end)
    end
    assert(bw.mesh.box {max = {1, 1, 1}, cells = {1, 1, 1}}) -- what was asked of one call is not of the next
    bw.progress(before)
    assert(s:step())
  end)
end)
