-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- `barwright new`: its scripts run as they are, and no file is written over.
local check = require "check"
local skeletons = require "barwright.command.skeletons"

local folder = check.folder()

-- Runs the program in the folder: exit status and all that it prints.
local function run(words)
  local pipe = assert(io.popen(("cd '%s' && BARWRIGHT_QUIET=1 '%s' %s 2>&1 </dev/null; echo $?"):format(folder,
    check.program, words)))
  local text = pipe:read "a"
  pipe:close()
  local printed, status = text:match "^(.-)(%d+)\n$"
  return tonumber(status), printed
end

-- Of each kind: the commands that it is for, each with a text that it prints.
local kinds = {
  part = {{"beam.lua", "of the strength"}, {"check beam.stl", "Sound"}},
  scenario = {{"test beam.lua", "# 2 passed, 0 failed, 0 skipped"}},
  study = {{"study run beam.lua", "8 trials of study beam: 8 done"}},
  experiment = {{"beam.lua", "written: beam/result.json"}, {"rerun beam/manifest.json", "the same"}},
}

describe("barwright new", function()
  for kind in pairs(skeletons) do
    it("writes a script that runs: " .. kind, function()
      os.remove(folder .. "/beam.lua")
      local status, text = run(("new %s beam.lua"):format(kind))
      assert.equal(0, status, text)
      assert.truthy(text:find("Next: `barwright", 1, true), text)
      for line in check.read(folder .. "/beam.lua"):gmatch "[^\n]*" do
        assert.is_true(#line <= 115, line)
        assert.falsy(line:find "%f[%w]FILE%f[%W]" or line:find "%f[%w]NAME%f[%W]", line)
      end
      for _, use in ipairs(kinds[kind]) do
        status, text = run(use[1])
        assert.equal(0, status, text)
        assert.truthy(text:find(use[2], 1, true), text)
      end
    end)
  end

  it("writes no file over another", function()
    check.write(folder .. "/mine.lua", "-- mine")
    local status, text = run "new part mine.lua"
    assert.equal(2, status)
    assert.truthy(text:find("mine.lua: it is there already", 1, true), text)
    assert.equal("-- mine", check.read(folder .. "/mine.lua"))
  end)

  it("names the file in the next commands as it was given", function()
    assert(os.execute(("mkdir -p '%s/sub'"):format(folder)))
    local status, out = run "new part sub/there.lua"
    assert.equal(0, status)
    assert.truthy(check.read(folder .. "/sub/there.lua"):find("barwright there.lua", 1, true))
    assert.truthy(out:find("`barwright sub/there.lua`", 1, true), out)
  end)

  it("names the file by its kind", function()
    assert.equal(0, (run "new scenario"))
    assert.truthy(check.read(folder .. "/scenario.lua"):find("barwright test scenario.lua", 1, true))
  end)

  it("refuses other names", function()
    for words, sentence in pairs {["new"] = "KIND is missing", ["new gear"] = "one of part, scenario",
      ["new part x.txt"] = "ends in .lua expected", ["new part .lua"] = "ends in .lua expected",
      ["new part 'a b.lua'"] = "letters, digits", ["new part a.lua b.lua"] = "one argument too many"} do
      local status, text = run(words)
      assert.equal(2, status, text)
      assert.truthy(text:find(sentence, 1, true), text)
    end
    assert.equal(3, (run "new part no/such/x.lua"))
  end)
end)
