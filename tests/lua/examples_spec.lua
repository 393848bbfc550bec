-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Every lesson runs, is under 60 lines, and carries its own run line.
local check = require "check"

describe("the lesson", function()
  local list = assert(io.popen "ls examples/*.lua")
  for path in list:lines() do
    it(path .. " runs", function()
      local folder = check.folder()
      local code, _, complaint = check.run(path .. " " .. folder)
      assert.message(complaint).are.equal(0, code)
    end)
    it(path .. " is short and says how it is run", function()
      local lines, run = 0, false
      for line in io.lines(path) do
        lines = lines + 1
        run = run or line:find("build/barwright " .. path, 1, true) ~= nil
      end
      assert.is_true(lines < 60)
      assert.is_true(run)
    end)
  end
  list:close()
end)
