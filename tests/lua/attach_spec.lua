-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Attached masses and springs in Lua: a body on springs, what is printed, and misuse.
local bw = require "barwright"
local check = require "check"

local function block()
  local mesh = bw.mesh.box {max = {0.2, 0.2, 0.1}, cells = {2, 2, 1}, order = 2}
  return bw.model {mesh = mesh, material = bw.material.steel}, mesh.boundary
end

describe("attachments", function()
  it("carry a load and set the frequency", function()
    local part, boundary = block()
    part:gravity {0, 0, -10}
    part:attach {on = boundary:below("z", 0), spring = {1e5, 1e5, 1e5}}
    part:attach {on = boundary:above("z", 0.1), mass = 5}
    local mass = bw.material.steel.density * 0.2 * 0.2 * 0.1 + 5
    local static = assert(part:solve())
    check.near(10 * mass, static.attachments[1].force[3], 1e-5)
    check.near(-50, static.attachments[2].force[3], 1e-8)
    check.near(-10 * mass / 1e5, static.displacement:column(3):mean(), 1e-6)
    local modes = assert(part:modes {count = 6})
    local heave, found = math.sqrt(1e5 / mass) / (2 * math.pi), false
    for i = 1, 6 do found = found or math.abs(modes.frequencies[i] / heave - 1) < 1e-3 end
    assert.is_true(found)
  end)

  it("are listed and printed", function()
    local part, boundary = block()
    part:attach {on = boundary:below("z", 0), spring = {1e5, 0, 2e5}}
    part:attach {on = boundary:above("z", 0.1), mass = 5}
    local list = part.attachments
    assert.equal(2, #list)
    check.near(0.04, list[1].area, 1e-12)
    assert.equal(2e5, list[1].spring[3])
    assert.equal(5, list[2].mass)
    local text = tostring(part)
    assert.truthy(text:find("attachment 1: spring (100000, 0, 200000) N/m", 1, true)
      or text:find("attachment 1: spring (1e+05, 0, 2e+05) N/m", 1, true), text)
    assert.truthy(text:find("attachment 2: mass 5 kg", 1, true), text)
    part:clear_attachments()
    assert.equal(0, #part.attachments)
  end)

  it("are refused where they make no sense or are not known", function()
    local part, boundary = block()
    local on = boundary:below("z", 0)
    assert.has_error(function() part:attach {on = on} end)
    assert.has_error(function() part:attach {on = on, mass = 1, spring = {1, 1, 1}} end)
    assert.has_error(function() part:attach {mass = 1} end)
    assert.has_error(function() part:attach {on = on, mass = -1} end)
    part:attach {on = on, mass = 1}
    local system, why = part:system()
    assert.is_nil(system)
    assert.truthy(why:find("1 attachment", 1, true), why)
  end)
end)
