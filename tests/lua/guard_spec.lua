-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What is in use is not closed, and bound functions accept the objects of their class alone.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"

local function sphere() return bw.surface.sphere {radius = 1} end

describe("a class", function()
  it("hides its metatable", function()
    assert.equal("barwright.surface", getmetatable(sphere()))
  end)

  it("checks the object in every method and property", function()
    local closed, tried = sphere(), 0
    closed:close()
    for name, class in pairs(core.classes) do
      local spoken = core.spoken(name)
      for _, functions in ipairs {class.methods, class.properties, {class.tostring}} do
        for key, bound in pairs(functions) do
          if debug.getinfo(bound, "S").what == "C" and key ~= "close" then
            for _, value in ipairs {5, "text", {}, io.stdout, closed, false} do
              check.raises(name == "surface" and value == closed and "this surface is closed"
                or spoken .. " expected, got", bound, value)
            end
            check.raises(spoken .. " expected, got no value", bound)
            tried = tried + 1
          end
        end
      end
    end
    assert.truthy(tried > 400, tried)
  end)

  it("is not decided by what a script writes", function()
    local description = core.classes.surface
    local name = description.name
    description.name = "mesh"
    assert.equal("surface", core.class_name(sphere()))
    description.name = name
    assert.is_nil(core.class_name(io.stdout))
    assert.is_nil(core.class_name(setmetatable({}, {__name = "barwright.surface"})))
  end)
end)

describe("what is in use", function()
  it("is not closed by a function that the engine calls", function()
    local body = sphere()
    check.raises("nothing may be closed", bw.mesh.fill, body, {size = function()
      body:close()
      return 0.8
    end})
    assert.equal(642, body.point_count)
    check.raises("may not call it", bw.mesh.fill, body, {size = function() return #body:check().defects end})
    check.raises("may not call it", bw.mesh.fill, body, {size = function()
      assert(core.class_name(body.points) == "array") -- a view: it calls nothing, and must not end the guard
      return #body:check().defects
    end})
  end)

  it("is not closed by a finaliser while a bound function runs", function()
    local points, on, refused = sphere().points, true, 0
    local function trap()
      setmetatable({}, {__gc = function()
        if not on then return end
        local _, message = pcall(coroutine.wrap(function() points:close() end))
        if message then refused = refused + 1 end
        trap()
      end})
    end
    trap()
    -- Until a finaliser ran in there: the more other tests left behind, the longer is a cycle of the collector.
    for _ = 1, 1e5 do
      if refused > 0 then break end
      local ok, list = pcall(points.totable, points) -- makes 642 tables
      if not ok then break end -- closed between two calls, which is allowed
      assert.equal(642, #list)
    end
    on = false
    assert.truthy(refused > 0, "no finaliser ran inside of a bound function")
  end)

  it("may be closed by a function that a minimiser calls", function()
    local body = sphere()
    assert(core.minimise {objective = function(x)
      if body then body:close() end
      body = nil
      return (x[1] - 0.3) ^ 2
    end, start = {0.5}, min = {0}, max = {1}, evaluations = 20})
    assert.is_nil(body)
  end)

  it("is at rest again after an error, whatever raised it", function()
    for _ = 1, 3 do
      check.raises("my own", bw.mesh.fill, sphere(), {size = function() error "my own" end})
      assert.equal(1, sphere():check().shells)
    end
  end)
end)
