-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Every operation of a body that follows an outline happens whole or not at all: after one that is
-- refused, raises, is cancelled or runs out of memory, all that can be seen is as it was.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local rubber = bw.material.isotropic {name = "rubber", young = 1e6, poisson = 0.3, density = 1000}

local function outline(width, tags)
  return assert(bw.outline.rectangle {width = width or 2, height = 1, tags = tags or {left = 4, right = 2}})
end

-- What a function that is a condition does: it raises once `left` calls are used up.
local left = math.huge
local function fuse(value)
  return function()
    left = left - 1
    if left < 0 then error "fuse" end
    return value
  end
end

local function sheet(class, more)
  return function()
    local options = {outline = outline(), material = rubber, elements = 60,
      conditions = {left = {x = 0, y = 0}, right = {traction = {fuse(50), 0}}}}
    for key, value in pairs(more or {}) do options[key] = value end
    return assert(bw.responsive[class](options))
  end
end

local function flow(class, more)
  return function()
    local options = {outline = outline(), viscosity = 0.1, elements = 60, step = 0.1,
      conditions = {left = {x = fuse(1), y = 0}}}
    for key, value in pairs(more or {}) do options[key] = value end
    return assert(bw.responsive[class](options))
  end
end

local asked = {at = {0.3, 0.4}, force = {"left"}}

local kinds = {
  {name = "steady", make = sheet "steady", fields = {"displacement", "von_mises"}},
  {name = "steady of order 2", make = sheet("steady", {order = 2}), fields = {"displacement", "von_mises"}},
  {name = "cantilever", make = sheet("cantilever"), fields = {"displacement", "stress"}},
  {name = "vibration", make = sheet "vibration", steps = true,
    fields = {"displacement", "velocity", "acceleration", "time"}},
  {name = "flow", make = flow "flow", steps = true, fields = {"velocity", "pressure", "vorticity", "time"},
    asked = asked},
  {name = "steady flow", make = flow("flow", {steady = true}), settles = true,
    fields = {"velocity", "pressure", "time"}, asked = asked},
  {name = "thermal", make = flow("thermal", {diffusivity = 0.1, conditions = {
    left = {x = fuse(1), y = 0, temperature = 1}}}), steps = true,
    fields = {"velocity", "temperature", "time"}, asked = asked},
  {name = "bar", make = function()
    return assert(bw.responsive.metallophone {outline = outline(), material = bw.material.pla, thickness = 0.05,
      elements = 60, modes = 2})
  end, fields = {"frequencies", "thickness"}, free = true},
}

-- All that can be seen, as one string; `also` are numbers read by other ways.
local function seen(kind, object)
  local parts = {tostring(object.reused)}
  for _, name in ipairs {"points", "elements", table.unpack(kind.fields)} do
    local value = object[name]
    parts[#parts + 1] = type(value) == "number" and ("%a"):format(value) or value and value:tostring "<f8" or "-"
  end
  parts[#parts + 1] = object.outline.points:tostring "<f8"
  for name, arguments in pairs(kind.asked or {}) do
    local said = table.pack(pcall(object[name], object, table.unpack(arguments)))
    for i = 1, said.n do
      parts[#parts + 1] = type(said[i]) == "number" and ("%a"):format(said[i]) or tostring(said[i])
    end
  end
  return table.concat(parts, "|")
end

-- What is asked of an object: each may fail, and none may leave it half done.
local operations = {
  become = function(object) return object:become(outline(1.9)) end,
  ["become another mesh"] = function(object)
    return object:become(assert(bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {1, 1.2}, {0, 1}},
      tags = {left = 5, right = 2}}))
  end,
  drag = function(object) return object:drag({vertex = 2}, {0.05, 0.02}) end,
  solve = function(object, kind)
    if kind.steps then return object:step(3) end
    return kind.settles and object:settle() or object:solve()
  end,
}

for _, kind in ipairs(kinds) do
  describe("an operation that fails leaves it as it was: " .. kind.name, function()
    local function ready()
      left = math.huge
      local object = kind.make()
      if kind.steps then assert(object:step(2)) end
      assert(object:drag({vertex = 2}, {0.02, 0}))
      if kind.steps then assert(object:step()) end
      return object
    end

    it("refused", function()
      local object = ready()
      local before = seen(kind, object)
      if not kind.free then
        -- no mesh of the circle goes with the conditions
        local circle = bw.outline.circle {centre = {0, 0}, radius = 0.1}
        check.raises("no tag", object.become, object, circle)
        check.raises("no tag", object.body.follow, object.body, {level = "none"}, circle)
      end
      local moved = object.outline:moved({vertex = 1}, {3, 3})
      assert.is_nil(moved)
      assert.is_nil((object:drag({vertex = 1}, {3, 3})))
      assert.equal(before, seen(kind, object))
      assert(object:drag({vertex = 2}, {0.01, 0}))
    end)

    for name, operation in pairs(operations) do
      it("cancelled: " .. name, function()
        local object = ready()
        local before = seen(kind, object)
        local former = bw.progress(function() return false end)
        local ok, said = pcall(operation, object, kind)
        bw.progress(former)
        -- what tells no progress cannot be cancelled by it
        if not (ok and said) then assert.equal(before, seen(kind, object)) end
      end)

      it("out of memory: " .. name, function()
        local object = ready()
        local before = seen(kind, object)
        for n = 1, 400, 7 do
          core.fail_allocation(n, true)
          local ok, said = pcall(operation, object, kind)
          core.fail_allocation(0)
          if ok and said then break end
          assert.equal(before, seen(kind, object))
        end
      end)

      if not kind.free then
        it("a condition raises: " .. name, function()
          local object = ready()
          local before = seen(kind, object)
          for calls = 0, 60, 6 do
            left = calls
            local ok, said = pcall(operation, object, kind)
            left = math.huge
            if ok then break end
            assert.truthy(tostring(said):find "fuse")
            assert.equal(before, seen(kind, object))
          end
        end)
      end
    end
  end)
end

describe("what goes with a sheet", function()
  it("is there after a refusal: the gradient of the stress is that of before", function()
    left = math.huge
    local s = sheet "steady"()
    local norm, by_points, by_nodes = s:stress_norm(2)
    for _ = 1, 5 do
      check.raises("no tag", s.become, s, bw.outline.circle {centre = {0, 0}, radius = 0.1})
      left = 3
      check.raises("fuse", s.solve, s)
      left = math.huge
      local again, points, nodes = s:stress_norm(2)
      assert.equal(norm, again)
      assert.equal(#by_nodes, #nodes)
      for i = 1, #by_points do
        for k = 1, 2 do assert.is_true(math.abs(by_points[i][k] - points[i][k]) <= 1e-6 * norm) end
      end
    end
  end)
end)

describe("a bar that is tuned", function()
  it("is as it was when the script's function raises in the midst of it", function()
    local bar = assert(bw.responsive.metallophone {outline = outline(), material = bw.material.pla,
      thickness = 0.05, elements = 60})
    local before = bar.points:tostring "<f8" .. bar.frequencies:tostring "<f8" .. tostring(bar.reused)
    check.raises("enough", bar.tune, bar, 1.2 * bar.frequency, {watch = function() error "enough" end})
    assert.equal(before, bar.points:tostring "<f8" .. bar.frequencies:tostring "<f8" .. tostring(bar.reused))
  end)
end)

describe("a bar that is tuned without memory", function()
  it("says so", function()
    local bar = assert(bw.responsive.metallophone {outline = outline(), material = bw.material.pla,
      thickness = 0.05, elements = 60})
    local wanted = 1.02 * bar.frequency
    for n = 1, 30 do
      core.fail_allocation(n, true)
      local ok, tuned, _, details = pcall(bar.tune, bar, wanted)
      core.fail_allocation(0)
      assert.truthy(not ok and tostring(tuned):find "memory" or details and details.status == "memory")
    end
  end)
end)

describe("a motion", function()
  it("makes all of the steps that it is asked for, or none", function()
    local grid = assert(bw.grid.box {size = {0.1, 0.1, 0.2}, cells = {1, 1, 2}})
    local solid = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e5, poisson = 0.3,
      density = 1000}}})
    assert(solid:fix {side = "min z"}):force({side = "max z"}, {5, 0, 0})
    local motion = assert(solid:transient {step = 1e-3})
    assert(motion:step(2))
    local function said()
      return motion.displacement:tostring "<f8" .. motion.velocity:tostring "<f8"
        .. ("%a %a %d %a"):format(motion.time, motion.kinetic, motion.steps, motion.newton.residual)
    end
    local before = said()
    for fraction = 1, 3 do
      local former = bw.progress(function(stage, part) return stage ~= "transient" or part < fraction / 4 end)
      check.fails("cancelled", "", motion:step(4))
      bw.progress(former)
      assert.equal(before, said())
    end
    assert(motion:step(4))
    assert.equal(6, motion.steps)
  end)
end)

describe("a progress function", function()
  it("that asks to stop too late stops neither that call nor the next", function()
    local reported = 0
    local former = bw.progress(function(_, fraction)
      reported = reported + 1
      return fraction < 1
    end)
    local mesh, message = bw.plane.fill(outline(), {elements = 20})
    bw.progress(former)
    assert.is_true(reported > 0)
    assert(mesh, message)
    assert(bw.plane.fill(outline(), {elements = 20}))
  end)

  it("that raises where a mesh is rebuilt leaves the motion where it was", function()
    local motion = assert(bw.plane.mesh_motion(assert(bw.plane.fill(outline(), {elements = 20}))))
    local mesh = motion.mesh
    for last = 0, 1 do
      local former = bw.progress(function(_, fraction) return fraction < last or error "no" end)
      check.raises("no", motion.follow, motion, assert(bw.outline {points = {{0, 0}, {2, 0}, {1, 1}}}))
      bw.progress(former)
      assert.is_true(mesh == motion.mesh)
    end
  end)
end)

describe("the signals of a flow", function()
  it("lose what a step recorded that came to nothing", function()
    left = math.huge
    local f = flow "flow"()
    local calls = 0
    f:record("calls", function(self)
      calls = calls + 1
      if calls == 5 then error "enough" end
      self:record("other", function() return 1 end)
      return calls
    end)
    assert(f:step(2))
    local time, velocity = f.time, f.velocity:tostring "<f8"
    check.raises("enough", f.step, f, 4)
    assert.equal(time, f.time)
    assert.equal(velocity, f.velocity:tostring "<f8")
    assert.same({1, 2}, f.signals.calls)
    assert(f:step())
    assert.same({1, 2, 6}, f.signals.calls)
  end)
end)
