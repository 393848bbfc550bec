-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the tutorial shows runs as it stands, with fewer elements.
local check = require "check"
local bw = require "barwright"

describe("the tutorial", function()
  local text = check.read(check.root .. "/docs/tutorial.md")
  local folder = check.folder()
  local small = 3000

  setup(function()
    local part = assert(bw.mesh.box {low = {-0.01, -0.01, 0}, high = {0.052, 0.01, 0.022},
      cells = {31, 10, 11}})
    assert(part:surface():write(folder .. "/part.stl", {unit = "mm"}))
  end)

  it("has commands that run", function()
    local count = 0
    for line in text:gmatch "build/barwright (scripts/[^\n`]*)" do
      line = line:gsub("part%.stl", folder .. "/part.stl"):gsub("out/", folder .. "/")
        :gsub("%-%-elements %d+", "--elements " .. small)
      local code, _, complaint = check.run(line)
      assert.message(line .. "\n" .. complaint).are.equal(0, code)
      count = count + 1
    end
    assert.is_true(count >= 1)
  end)

  it("has scripts that run one after the other", function()
    local parts = {}
    for block in text:gmatch "```lua\n(.-)```" do parts[#parts + 1] = block end
    assert.is_true(#parts >= 3)
    local script = table.concat(parts, "\n"):gsub("elements = %d+", "elements = " .. small)
      :gsub('"(%l+%.%l+)"', '"' .. folder .. '/%1"')
    check.write(folder .. "/tutorial.lua", script)
    local code, _, complaint = check.run(folder .. "/tutorial.lua")
    assert.message(complaint).are.equal(0, code)
  end)
end)
