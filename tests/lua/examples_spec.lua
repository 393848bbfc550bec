-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Every lesson runs, is short, and carries its own run line.
local check = require "check"

local function lessons(pattern, max, arguments)
  local list = assert(io.popen("ls " .. pattern))
  for path in list:lines() do
    it(path .. " runs", function()
      local folder = check.folder()
      local code, _, complaint = check.run(path .. " " .. folder .. arguments)
      assert.message(complaint).are.equal(0, code)
    end)
    it(path .. " is short and says how it is run", function()
      local lines, run = 0, false
      for line in io.lines(path) do
        lines = lines + 1
        run = run or line:find("build/barwright " .. path, 1, true) ~= nil
      end
      assert.is_true(lines < max)
      assert.is_true(run)
    end)
  end
  list:close()
end

describe("the lesson", function() lessons("examples/*.lua", 60, "") end)
describe("the design study", function() lessons("examples/studies/*.lua", 120, " --quick") end)
