-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The unit of a file that has none: said where it is assumed, asked for on a terminal, refused where it cannot be
-- right.
local bw = require "barwright"
local check = require "check"

local folder = check.folder()
local function path(name) return folder .. "/" .. name end

-- Commands that compute, with what they need besides the model.
local computing = {["worst"] = "", ["strengthen"] = "--force 1N --out " .. path "o.stl", ["modes"] = "",
  ["statics"] = "--fix min:x --force max:x=0,0,1N", ["buckle"] = "--fix min:x --force max:x=0,0,1N",
  ["respond"] = "--fix min:x --base 0,0,1g --to 9 --damping 0.02", ["drop"] = "--height 1m",
  ["heat"] = "--temperature min:x=80C --convection all=10,20C"}

-- What the program prints on a terminal where somebody types lines; nil without the program that makes one.
local function on_terminal(words, typed, environment)
  local pipe = assert(io.popen(("command -v script >/dev/null && printf '%s' | BARWRIGHT_QUIET=1 NO_COLOR=1 %s "
    .. "script -qec \"%s %s\" /dev/null 2>&1"):format(typed, environment or "", check.program, words)))
  local text = pipe:read "a"
  pipe:close()
  return text ~= "" and text:gsub("\r", "") or nil
end

describe("the unit of a file that has none", function()
  setup(function()
    -- 1.016 x 0.1 x 0.1 of some unit
    assert(bw.surface.box {max = {1.016e-3, 1e-4, 1e-4}}:write(path "tiny.stl"))
    assert(bw.surface.box {max = {0.1, 0.01, 0.01}}:write(path "bar.stl"))
    assert(bw.surface.box {max = {0.1, 0.01, 0.01}}:write(path "bar.3mf"))
    assert(bw.surface.box {max = {0.1, 0.01, 0.01}}:write(path "bar.glb"))
    assert(bw.surface.box {max = {1.016, 0.1, 0.1}}:write(path "large.stl", {unit = "um"}))
  end)

  for name, more in pairs(computing) do
    it("is asked for before `barwright " .. name .. "` computes an implausible size", function()
      for file, word in pairs {["tiny.stl"] = "small for a part", ["large.stl"] = "large for a part"} do
        local status, _, fault = check.run(("%s %s %s"):format(name, path(file), more))
        assert.equal(2, status, fault)
        for _, text in ipairs {word, "Nothing was computed; --unit confirms a unit", "--unit "} do
          assert.truthy(fault:find(text, 1, true), fault)
        end
      end
    end)
  end

  it("is told where it is assumed", function()
    local words = " --elements 200 --fix min:x --force max:x=0,0,1N"
    local status, text = check.run("statics " .. path "bar.stl" .. words)
    assert.equal(0, status)
    assert.truthy(text:find("The file has no unit: its numbers are taken as mm (--unit gives another).", 1, true))
    for _, known in ipairs {path "bar.stl" .. " --unit mm", path "bar.3mf", path "bar.glb"} do
      status, text = check.run("statics " .. known .. words)
      assert.equal(0, status)
      assert.falsy(text:find("has no unit", 1, true), text)
    end
    assert.is_true(select(2, check.answer("statics " .. path "bar.stl" .. words)).unit_assumed)
    assert.is_false(select(2, check.answer("statics " .. path "bar.3mf" .. words)).unit_assumed)
  end)

  it("is that of the environment, unless the file or the command line has one", function()
    local function answer(unit, words)
      local pipe = assert(io.popen(("BARWRIGHT_UNIT=%s BARWRIGHT_QUIET=1 %s check --json %s 2>&1"):format(unit,
        check.program, words)))
      local text = pipe:read "a"
      pipe:close()
      return bw.json.decode(text)
    end
    assert.is_true(math.abs(answer("cm", path "bar.stl").size_m[1] - 1) < 1e-6)
    assert.is_false(answer("cm", path "bar.stl").unit_assumed)
    assert.is_true(math.abs(answer("cm", path "bar.3mf").size_m[1] - 0.1) < 1e-6)
    assert.is_true(math.abs(answer("cm", path "bar.stl --unit mm").size_m[1] - 0.1) < 1e-6)
    assert.is_true(answer("", path "bar.stl").unit_assumed)
    assert.is_true(answer("km", path "bar.stl").unit_doubtful) -- 100 km
    local words = ("BARWRIGHT_UNIT=%%s %s modes %s 2>&1"):format(check.program, path "bar.stl")
    for unit, expected in pairs {km = "which makes it 100000000 x", furlong = "BARWRIGHT_UNIT: one of mm, cm"} do
      local pipe = assert(io.popen(words:format(unit)))
      local text = pipe:read "a"
      local _, _, status = pipe:close()
      assert.equal(2, status, text)
      assert.truthy(text:find(expected, 1, true), text)
    end
  end)

  it("is metres in files of meshes, whatever the environment says", function()
    local surface, mesh = bw.surface.box {max = {0.1, 0.02, 0.01}}, bw.mesh.box {max = {0.1, 0.02, 0.01}}
    for name, body in pairs {["s.vtu"] = surface, ["s.msh"] = surface, ["m.vtu"] = mesh, ["m.msh"] = mesh,
      ["m.mesh"] = mesh, ["m.inp"] = mesh, ["m.node"] = mesh} do
      local from, to = path(name), path(name .. ".stl")
      assert(body:write(from))
      local words = "BARWRIGHT_UNIT=mm BARWRIGHT_QUIET=1 %s convert %s %s >/dev/null"
      assert.is_true(os.execute(words:format(check.program, from, to)))
      local size = assert(bw.surface.read(to)).box.max
      for k, length in ipairs {0.1, 0.02, 0.01} do assert.is_true(math.abs(size[k] - length) < 1e-8, name) end
    end
    local text = on_terminal("check " .. path "m.vtu", "", "BARWRIGHT_UNIT=mm")
    if not text then return pending "there is no program `script`" end
    assert.truthy(text:find("100 x 20 x 10 mm", 1, true), text)
    assert.truthy(text:find("its numbers are taken as m (--unit gives another)", 1, true), text)
    assert.falsy(text:find("Unit", 1, true), text)
    text = on_terminal("check " .. path "m.vtu", "mm\\n")
    assert.truthy(text:find("Without a question: --unit mm.", 1, true), text)
  end)

  it("of the environment is an option in the manifest of `barwright worst`", function()
    local words = "BARWRIGHT_UNIT=cm BARWRIGHT_QUIET=1 %s worst %s --elements 200 --modes 1 --regions 1 --out %s"
    local _, _, status = os.execute((words .. " >/dev/null"):format(check.program, path "bar.stl", path "worst"))
    assert.is_true(status < 2)
    assert.equal("cm", bw.json.decode(check.read(path "worst/manifest.json")).options.unit)
  end)

  it("is that of the environment in `barwright open`", function()
    -- Prints the length, the unit, whether it is plausible and whether the saved script opens it in that unit.
    local script = check.script [[
      local controller = require "barwright.workbench.controller"
      local state = require "barwright.workbench.state"
      local server = setmetatable({}, {__index = function() return function() return {} end end})
      local self = controller.new(server)
      local ok, message = self:open(arg[1], arg[2])
      if not ok then print(message) return end
      local source = self.bench:current().source
      print(("%.4g %s %s %s"):format(source.read.surface.box.max[1], tostring(source.unit),
        tostring(source.doubt == nil), tostring(self.bench:script():find('unit = "cm"', 1, true) ~= nil)))]]
    local function opened(unit, words)
      local pipe = assert(io.popen(("BARWRIGHT_UNIT=%s %s %s %s 2>&1"):format(unit, check.program, script, words)))
      local text = pipe:read "a"
      pipe:close()
      return text
    end
    assert.equal("1 cm true true\n", opened("cm", path "bar.stl"))
    assert.equal("0.1 nil true false\n", opened("", path "bar.stl"))
    assert.equal("0.1 mm true false\n", opened("cm", path "bar.stl" .. " mm"))
    assert.equal("0.1 nil true false\n", opened("cm", path "bar.3mf"))
    assert(bw.mesh.box {max = {0.1, 0.02, 0.01}}:write(path "open.vtu"))
    assert.equal("0.1 nil true false\n", opened("cm", path "open.vtu"))
    assert.equal("1e+05 km false false\n", opened("km", path "bar.stl"))
    assert.truthy(opened("furlong", path "bar.stl"):find("BARWRIGHT_UNIT: one of mm, cm", 1, true))
  end)

  it("counts in conversions that write it", function()
    assert.equal(0, (check.run(("convert %s %s"):format(path "tiny.stl", path "same.off"))))
    for _, name in ipairs {"tiny.3mf", "tiny.step", "tiny.glb", "tiny.vtu"} do
      assert.equal(2, (check.run(("convert %s %s"):format(path "tiny.stl", path(name)))), name)
    end
    assert.equal(0, (check.run(("convert %s %s --unit in"):format(path "tiny.stl", path "tiny.3mf"))))
  end)

  it("is asked for on a terminal", function()
    local text = on_terminal("check " .. path "bar.stl", "\\n")
    if not text then return pending "there is no program `script`" end
    assert.truthy(text:find("in mm it is 100 x 10 x 10 mm. Unit [mm]: ", 1, true), text)
    assert.truthy(text:find("12 triangles, 100 x 10 x 10 mm", 1, true), text)
    text = on_terminal("check " .. path "bar.stl", "cm\\n")
    assert.truthy(text:find("12 triangles, 1000 x 100 x 100 mm", 1, true), text)
    assert.truthy(text:find("Without a question: --unit cm, or BARWRIGHT_UNIT=cm for all surfaces", 1, true), text)
    text = on_terminal("check " .. path "bar.stl", "", "BARWRIGHT_UNIT=cm")
    assert.truthy(text:find("taken as cm (BARWRIGHT_UNIT; --unit gives another)", 1, true), text)
    assert.truthy(text:find("12 triangles, 1000 x 100 x 100 mm", 1, true), text)
    assert.falsy(text:find("Unit", 1, true), text)
    -- In doubt there is no default, and what is no unit is asked for again.
    text = on_terminal("check " .. path "tiny.stl", "furlong\\n\\nin\\n")
    assert.equal(2, select(2, text:gsub("One of mm, cm, m, km, um, in, ft is expected. Unit: ", "")), text)
    assert.truthy(text:find("12 triangles, 25.81 x 2.54 x 2.54 mm", 1, true), text)
    for _, words in ipairs {" --unit mm", " --json", " --quiet"} do
      assert.falsy((on_terminal("check " .. path "bar.stl" .. words, "\\n") or ""):find("Unit", 1, true), words)
    end
  end)
end)
