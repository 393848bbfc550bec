-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Load factors in Lua: options, results, files, pictures, imperfect meshes, the command.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"

local folder = check.folder() .. "/"
local L, a, b = 0.5, 0.01, 0.02
local steel = bw.material.isotropic {young = 200e9, poisson = 0.3, strength = 250e6}

local function column(force)
  local mesh = bw.mesh.box {max = {L, a, b}, cells = {24, 1, 2}, order = 2}
  local part = bw.model {mesh = mesh, material = steel}
  part:fix(mesh.boundary:below("x", 0))
  if force then part:load {on = mesh.boundary:above("x", L), force = force} end
  return part
end

local euler = math.pi ^ 2 * 200e9 * b * a ^ 3 / 12 / (4 * L ^ 2)

describe("buckling", function()
  it("gives the column's factor, of the load as it is and reversed", function()
    local static = assert(column({-100, 0, 0}):solve())
    local buckling = assert(static:buckling {count = 2})
    check.near(euler / 100, buckling.factor, 0.01)
    assert.equal(buckling.factor, buckling.factors[1])
    assert.equal(2, #buckling)
    assert.equal(2, buckling.count)
    assert.is_true(buckling.counted)
    assert.is_true(buckling.searched >= buckling.factors[2] * (1 - 1e-9))
    assert.is_true(buckling.errors[1] < 1e-6 * buckling.factor)
    assert.equal("lanczos", buckling.report.solver)
    assert.truthy(tostring(buckling):find("2 load factors by lanczos", 1, true))
    assert.truthy(tostring(buckling):find("counted: none is missing", 1, true))
    local reversed = assert(column({100, 0, 0}):buckling {count = 1})
    check.near(-buckling.factor, reversed.factors[1], 1e-6)
    assert.is_nil(reversed.factor)
    local not_counted = assert(static:buckling {count = 1, sturm = false})
    assert.is_false(not_counted.counted)
    assert.truthy(tostring(not_counted):find("not counted", 1, true))
  end)

  it("agrees by each eigensolver, shapes too", function()
    local static = assert(column({-100, 20, 10}):solve())
    local by_lanczos = assert(static:buckling {count = 3, sign = "positive"})
    for _, name in ipairs {"arpack", "lobpcg"} do
      local other = assert(static:buckling {count = 3, sign = "positive", solver = bw.eigensolver[name] {}})
      assert.equal(name, other.report.solver)
      for i = 1, 3 do
        check.near(by_lanczos.factors[i], other.factors[i], 1e-6)
        local apart = bw.array.map("norm(a)", {a = by_lanczos:shape(i) - other:shape(i)}):max()
        assert.is_true(apart < 1e-3, ("%s %d: %g"):format(name, i, apart))
      end
    end
  end)

  it("has an error estimate that a finer mesh confirms", function()
    local function first(cells)
      local mesh = bw.mesh.box {max = {L, a, b}, cells = cells, order = 2}
      local part = bw.model {mesh = mesh, material = steel}
      part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", L), force = {-1, 0, 0}}
      local buckling = assert(part:buckling {count = 1})
      return buckling.factor, buckling:error_estimate()[1]
    end
    local coarse, estimate = first {12, 1, 1}
    local fine = first {48, 2, 4}
    local error = coarse / fine - 1
    assert.is_true(estimate > 0.4 * error and estimate < 2.5 * error, ("%g, %g"):format(estimate, error))
  end)

  it("writes shapes, draws them, and bends the mesh along them", function()
    local part = column {-100, 0, 0}
    local buckling = assert(part:buckling {count = 2})
    local path = folder .. "shapes.vtu"
    assert(buckling:write(path))
    local _, fields = assert(bw.mesh.read(path))
    assert.truthy(fields)
    assert(buckling:picture(1, folder .. "shape.png"))
    local bent = assert(buckling:imperfect_mesh {amplitude = 1e-3})
    local moved = bent.nodes - part.mesh.nodes
    check.near(1e-3, bw.array.map("norm(a)", {a = moved}):max(), 1e-12)
    local mixed = assert(buckling:imperfect_mesh {amplitude = 2e-3, weights = {1, -1}})
    check.near(2e-3, bw.array.map("norm(a)", {a = mixed.nodes - part.mesh.nodes}):max(), 1e-12)
  end)

  it("draws shapes as large as a twentieth of the box, without a factor that would say nothing", function()
    local buckling = assert(column({-100, 0, 0}):buckling {count = 1})
    local picture, drawn = core.picture, {}
    core.picture = function(_, _, options)
      drawn[#drawn + 1] = options
      return true
    end
    local ok, message = pcall(function()
      buckling:picture(1, folder .. "shape.png")
      buckling:picture(1, folder .. "shape.png", {deformation = 0.002})
    end)
    core.picture = picture
    assert(ok, message)
    for i, largest in ipairs {0.05 * math.sqrt(L ^ 2 + a ^ 2 + b ^ 2), 0.002} do
      assert.equal(1, drawn[i].deformation) -- a factor of one is not printed
      check.near(largest, bw.array.map("norm(a)", {a = drawn[i].displacement}):max(), 1e-9)
    end
    local failed, why = pcall(function() buckling:picture(1, folder .. "shape.png", {deformation = "x"}) end)
    assert.is_false(failed)
    assert.truthy(why:find("deformation", 1, true), why)
  end)

  it("refuses misuse in a sentence", function()
    local static = assert(column({-100, 0, 0}):solve())
    local buckling = assert(static:buckling {count = 1})
    check.misuses {
      ["option 'sign'"] = function() static:buckling {sign = "up"} end,
      ["501 load factors"] = function() static:buckling {count = 501} end,
      ["unknown option 'shapes'"] = function() static:buckling {shapes = 2} end,
      ["option 'amplitude' is missing"] = function() buckling:imperfect_mesh {} end,
      ["1 to 1 numbers expected"] = function() buckling:imperfect_mesh {amplitude = 1, weights = {1, 2}} end,
      ["not all of them zero"] = function() buckling:imperfect_mesh {amplitude = 1, weights = {0}} end,
      ["item 1: a number expected"] = function() buckling:imperfect_mesh {amplitude = 1, weights = {"x"}} end,
      ["a table of options expected"] = function() column():buckling(3) end,
    }
    local part = bw.model {mesh = static.mesh, material = steel}
    part:load {on = static.mesh.boundary, pressure = 1e3}
    local none, message, details = assert(part:solve()):buckling()
    assert.is_nil(none)
    assert.equal("unconstrained", details.status)
    assert.truthy(message:find("Add supports", 1, true))
    local failed, why = pcall(function() return column({0, 0, 0}):buckling() end)
    assert.is_false(failed)
    assert.truthy(why:find("no stress", 1, true), why)
  end)
end)

describe("barwright buckle", function()
  it("writes a page of the shapes with the sentences that it says", function()
    local mesh = bw.mesh.box {max = {L, a, b}, cells = {24, 1, 2}, order = 2}
    local body, page = folder .. "page.msh", folder .. "page.html"
    assert(mesh:write(body))
    for load, field in pairs {["--force max:x=-100,0,0"] = "von Mises stress under the load",
      ["--worst 5N"] = "pressure of the load"} do
      local words = "buckle %s --material steel --fix min:x %s --count 2 --report %s"
      local _, out, err = check.run(words:format(body, load, page))
      assert.equal("", err)
      local text = check.read(page)
      local factor = text:match "buckling shape 1: load factor ([%d.]+)"
      assert.truthy(factor and out:find(factor, 1, true), out)
      assert.truthy(text:find("buckling shape 2: load factor", 1, true) and text:find(field, 1, true))
      assert.truthy(text:find("Linear theory: loads keep their directions", 1, true))
      assert.truthy(text:find("<h1>page.msh: ", 1, true))
      assert.is_nil(text:find("row of the table", 1, true))
    end
  end)

  local path = folder .. "strut.msh"
  setup(function()
    assert(bw.mesh.box({max = {L, a, b}, cells = {24, 1, 2}, order = 2}):write(path))
  end)

  local function answer(words)
    local status, out, err = check.run("buckle --json --material steel --fix min:x " .. words .. " " .. path)
    return status, status < 2 and bw.json.decode(out) or out, err
  end

  it("says whether the part buckles, with status and fields", function()
    local status, object = answer "--force max:x=-100,0,0 --count 2"
    assert.equal(0, status)
    assert.equal("holds", object.verdict)
    assert.equal(2, #object.load_factors)
    check.near(bw.material.steel.young / 200e9 * euler / 100, object.load_factor, 0.01)
    assert.is_true(object.counted)
    status, object = answer "--force max:x=-100kN,0,0"
    assert.equal(1, status)
    assert.equal("buckles", object.verdict)
    -- compression has no negative factor nearby, and a count says so
    status, object = answer "--force max:x=-100,0,0 --sign negative --count 1"
    assert.equal(0, status)
    assert.equal(0, #object.load_factors)
    assert.is_true(object.counted and object.searched > 1000)
    status, object = answer "--force max:x=100kN,0,0 --sign negative --count 1"
    assert.equal(1, status)
    assert.is_true(object.load_factors[1] < 0 and object.load_factors[1] > -1)
  end)

  it("writes shapes and a picture, and tells what linear theory leaves out", function()
    local status, out = check.run(("buckle %s --material steel --fix min:x --force max:x=-100,0,0 --count 1 "
      .. "--picture %sb.png --vtu %sb.vtu"):format(path, folder, folder))
    assert.equal(0, status)
    assert.truthy(out:find("loads keep their directions", 1, true))
    assert.truthy(out:find("none is missing", 1, true))
    assert.truthy(out:find("b.png", 1, true))
  end)

  it("refuses a part without supports or loads", function()
    local status, _, err = check.run("buckle --force max:x=-100,0,0 " .. path)
    assert.equal(2, status)
    assert.truthy(err:find("--fix PLACE is missing", 1, true), err)
    status, _, err = check.run("buckle --fix min:x " .. path)
    assert.equal(2, status)
    assert.truthy(err:find("no load is given", 1, true), err)
  end)
end)
