-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The API reference: every example of the stubs runs, and what the texts lack never grows.
local check = require "check"
package.path = check.root .. "/scripts/docs/?.lua;" .. package.path
local gaps = require "gaps"
local stubs = require "stubs"

-- What an example is run by where it is not a script for the program alone.
local runners = {
  scenario = "%s test %s",
  live = "timeout --preserve-status --signal INT 4 %s %s", -- Ctrl-C ends what serves
}
local INTERRUPTED = 130

local all = stubs.read(check.root .. "/lua/stubs")

-- A script with the lines of the stub file, so that messages name them.
local function run(program, file, example)
  local folder = check.folder()
  local name = file.name .. ".lua"
  local lines = ("\n"):rep(example.line - 1)
  check.write(folder .. "/" .. name, 'local bw = require "barwright"' .. lines .. example.code)
  local command = (runners[file.name] or "%s %s"):format("'" .. program .. "'", name)
  command = ("cd '%s' && BARWRIGHT_QUIET=1 timeout 300 %s >said 2>&1 </dev/null"):format(folder, command)
  local _, _, status = os.execute(command)
  local said = check.read(folder .. "/said")
  if status == 0 or status == INTERRUPTED and file.name == "live" then return nil end
  if said:find("this barwright has no MPI", 1, true) then return nil end -- it was built without
  return ("lua/stubs/%s:%d: status %s: %s"):format(name, example.line, tostring(status), said)
end

describe("the reference", function()
  for _, file in ipairs(all.files) do
    it("has no gaps in " .. file.name, function()
      local list = gaps.of(all, file)
      local first = list[1] and ("line %d: %s: %s"):format(list[1].line, list[1].kind, list[1].text) or ""
      assert.equal(0, #list, ("scripts/check_reference %s lists them; %s"):format(file.name, first))
    end)
  end

  -- A module of one function, with `change` made to its complete stub: what the check finds.
  local function found(from, to)
    local stub = [[
-- Things
--
-- What things are for.

---Things.
---@class bw.ThingModule
local ThingModule = {}

---A thing.
---```lua
---print(bw.thing.new(1))
---print(bw.thing.new(2))
---```
---@class bw.Thing

---Makes a thing.
---```lua
---local width = 0.1
---print(bw.thing.new(width))
---```
---@param width number (m) the width
---@return bw.Thing thing the thing
function ThingModule.new(width) end
]]
    local changed, count = stub:gsub(from, to)
    assert.equal(1, count)
    local folder = check.folder()
    check.write(folder .. "/barwright.lua",
      "-- bw\n--\n-- All.\n\n---All.\n---@class bw\n---@field thing bw.ThingModule\nlocal bw = {}\n")
    check.write(folder .. "/thing.lua", changed)
    local read, texts = stubs.read(folder), {}
    for _, file in ipairs(read.files) do
      for i, gap in ipairs(gaps.of(read, file)) do texts[i] = gap.kind .. ": " .. gap.text end
    end
    return table.concat(texts, "; ")
  end

  it("is found incomplete where a text, a type, a unit or an example is missing", function()
    assert.equal("", found("Makes", "Creates"))
    assert.equal("parameter: bw.thing.new: width: no text", found(" the width", ""))
    assert.equal("unit: bw.thing.new: width: no unit", found("%(m%) ", ""))
    assert.equal("return: bw.thing.new: result 1: no text", found("Thing thing the thing", "Thing"))
    assert.equal("type: bw.thing.new: result 1: table", found("bw.Thing thing", "table thing"))
    assert.equal("type: bw.thing.new: result 1: no class 'bw.Think'", found("bw.Thing thing", "bw.Think thing"))
    assert.equal("return: bw.thing.new: result 1: no text; type: bw.thing.new: result 1: no type",
      found("bw.Thing thing the thing", ""))
    assert.equal("description: bw.thing.new: no text", found("%-%-%-Makes a thing.\n", ""))
    assert.equal("example: bw.thing.new: no example", found("%-%-%-```lua\n%-%-%-local.-```\n", ""))
    assert.equal("parameter: bw.thing.new: ---@param of (), the function has (width)",
      found("%-%-%-@param[^\n]*\n", ""))
  end)

  it("has examples that run", function()
    local pipe = assert(io.popen(("realpath '%s'"):format(check.program)))
    local program, problems = pipe:read "l", {}
    pipe:close()
    local function try(file, described)
      for _, example in ipairs(described.examples) do problems[#problems + 1] = run(program, file, example) end
    end
    for _, file in ipairs(all.files) do
      for _, class in ipairs(file.classes) do
        try(file, class)
        for _, f in ipairs(class.functions) do try(file, f) end
      end
    end
    assert.equal("", table.concat(problems, "\n"))
  end)
end)
