-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the engine's tests print of themselves, as expectations: lines
--   VERIFY | case | quantity | reference | figure | allowed | source
-- of programs that fail when a figure is not within what is allowed. Allowed is a difference ("0.15"),
-- a relative difference ("2 %") or "below": less than the reference.
local bw = require "barwright"
local project = require "project"

local expect = bw.scenario.expect
local engine = {}

local function check(line)
  local cells = {}
  for cell in line:gmatch "[^|]+" do cells[#cells + 1] = cell:match "^%s*(.-)%s*$" end
  local case, quantity, reference, figure, allowed, source = table.unpack(cells)
  local what = expect(tonumber(figure), case .. ": " .. quantity)
  local fraction = allowed:match "^(%S+) %%$"
  if allowed == "below" then
    what:below(tonumber(reference), {source = source})
  elseif fraction then
    what:near(tonumber(reference), {relative = tonumber(fraction) / 100, source = source})
  else
    what:near(tonumber(reference), {absolute = tonumber(allowed), source = source})
  end
end

--- Runs a test program of the build with its slow checks.
function engine.run(t, program)
  local path = project.root .. "/build/tests/" .. program
  local there = io.open(path)
  if not there then t:skip("build/tests/" .. program .. " is not built") end
  there:close()
  local pipe, failed = assert(io.popen(("BARWRIGHT_FULL=1 '%s' 2>&1"):format(path))), {}
  for line in pipe:lines() do
    local verified = line:match "^VERIFY | (.*)$"
    if verified then check(verified) end
    if line:match "^%[  FAILED  %] test" or line:match "^%[  ERROR   %] test" then failed[#failed + 1] = line end
  end
  if not pipe:close() and #failed == 0 then failed[1] = "the program failed" end
  expect(#failed, "tests that fail"):equals(0, {how = ("`build/tests/%s`"):format(program)})
  for _, line in ipairs(failed) do print(line) end
end

return engine
