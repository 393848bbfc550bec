-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The command lines of the scripts: all are read as those of the program's commands are.
local check = require "check"

local function lines_of(command)
  local out, pipe = {}, assert(io.popen(("cd '%s' && %s"):format(check.root, command)))
  for line in pipe:lines() do out[#out + 1] = line end
  pipe:close()
  return out
end

local paths = lines_of "grep -rl 'script\\.read {' scripts | sort"

describe("the command line of", function()
  it("scripts is read by one reader", function()
    assert.truthy(#paths >= 35, #paths)
    assert.same({}, lines_of "grep -rnE '\\barg\\[([1-9i]|#)|ipairs\\(arg\\)|#arg' scripts")
  end)

  for _, path in ipairs(paths) do
    it(path .. " has a help and refuses what it does not know", function()
      local status, out, err = check.run(("'%s/%s' --help"):format(check.root, path))
      assert.equal(0, status, err)
      assert.equal("", err)
      assert.truthy(out:find("usage: barwright " .. check.root .. "/" .. path, 1, true), out)
      assert.truthy(out:find("\n  --help", 1, true), out)
      for line in out:gmatch "[^\n]+" do
        assert.truthy(utf8.len(line) <= 80 or line:find "^usage", line)
      end
      status, out, err = check.run(("'%s/%s' --no-such-option"):format(check.root, path))
      assert.equal(2, status, err)
      assert.equal("", out)
      assert.truthy(err:find("unknown option --no-such-option", 1, true), err)
      assert.equal(1, select(2, err:gsub("\n", "")), err)
    end)
  end

  it("a script names the option that may be meant, and has units", function()
    local run = ("'%s/scripts/bridge/run.lua' "):format(check.root)
    local _, out = check.run(run .. "--help")
    out = out:gsub("%s+", " ")
    assert.truthy(out:find("--span LENGTH", 1, true) and out:find("(default 200 mm)", 1, true), out)
    assert.truthy(out:find("(default 30 MPa)", 1, true), out)
    for words, text in pairs {["--spam 0.2m"] = "did you mean --span?", ["--span 0.2"] = "'0.2' has no unit",
      ["--limit 3mm"] = "MPa", ["--starts truss,arc"] = "one of truss, gable, beam, arch expected, got 'arc'",
      ["--span 20cm"] = "option --out DIR is missing"} do
      local status, printed, err = check.run(run .. words)
      assert.equal(2, status)
      assert.equal("", printed)
      assert.truthy(err:find(text, 1, true), err)
    end
  end)
end)
