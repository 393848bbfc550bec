-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the tutorials show runs as it stands, with fewer elements. Lua blocks of a page are one script;
-- those that begin with the name of a file are that file.
local check = require "check"
local bw = require "barwright"

local small = 3000

local function describe_page(page, least_blocks, prepare)
  describe("docs/" .. page, function()
    local text = check.read(check.root .. "/docs/" .. page)
    local folder = check.folder()

    local function adapted(script)
      return (script:gsub("elements = %d+", "elements = " .. small)
        :gsub('"(%l+%.%l+)"', '"' .. folder .. '/%1"'))
    end

    setup(function() if prepare then prepare(folder) end end)

    it("has commands that run", function()
      local count = 0
      for line in text:gmatch "build/barwright ([se]%l+/[^\n`]*)" do
        line = line:gsub("part%.stl", folder .. "/part.stl"):gsub("out/", folder .. "/")
          :gsub("whale%.svg", folder .. "/whale.svg")
          :gsub("%-%-elements %d+", "--elements " .. small):gsub(" %.$", " " .. folder)
        local code, _, complaint = check.run(line)
        assert.message(line .. "\n" .. complaint).are.equal(0, code)
        count = count + 1
      end
      assert.is_true(count >= 1)
    end)

    it("has scripts that run one after the other", function()
      local parts = {}
      for block in text:gmatch "```lua\n(.-)```" do
        local file = block:match "^%-%- (%l+%.lua)\n"
        if file then
          check.write(folder .. "/" .. file, adapted(block))
        else
          parts[#parts + 1] = block
        end
      end
      assert.is_true(#parts >= least_blocks)
      check.write(folder .. "/tutorial.lua", adapted(table.concat(parts, "\n")))
      local code, _, complaint = check.run(folder .. "/tutorial.lua")
      assert.message(complaint).are.equal(0, code)
    end)
  end)
end

describe_page("tutorial.md", 3, function(folder)
  local part = assert(bw.mesh.box {low = {-0.01, -0.01, 0}, high = {0.052, 0.01, 0.022},
    cells = {31, 10, 11}})
  assert(part:surface():write(folder .. "/part.stl", {unit = "mm"}))
end)

describe_page("tutorial_edit.md", 10)

describe_page("tutorial_solids.md", 9)

describe_page("tutorial_responsive.md", 8, function(folder)
  local page = check.read(check.root .. "/docs/tutorial_responsive.md")
  check.write(folder .. "/whale.svg", page:match "```svg\n(.-)```")
end)
