-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- `barwright rerun`: the same run again; inputs that are missing or changed; numbers that are others.
local check = require "check"
local differences = require "barwright.experiment.differences"
local json = require "barwright.json"

local SCRIPT = [[
local bw = require "barwright"
local out
for i, word in ipairs(arg) do
  if word == "--out" then out = arg[i + 1] end
  if word:match "^%-%-out=" then out = word:sub(7) end
end
local results = assert(bw.results.open(out or arg[1], {inputs = {INPUT}, options = {x = 1}, seed = 3}))
local file = assert(io.open(INPUT))
local x = file:read "n"
file:close()
assert(results:write {sum = x + OFFSET, seconds_solve = os.clock(), peak_memory_bytes = bw.results.peak_memory(),
  rows = {{value = 2 * x, seconds = os.clock()}, {value = OFFSET == 0 and 3 or 3 + 3e-12}},
  file = (results:path "a"):gsub("//", "/"),
  name = OFFSET == 0 and "a" or "b", list = OFFSET == 0 and {1, 2} or {1, 2, 3}})
]]

local function experiment(words)
  local folder = check.folder()
  check.write(folder .. "/input.txt", "5\n")
  local function script(offset)
    check.write(folder .. "/run.lua", (SCRIPT:gsub("INPUT", ("%q"):format(folder .. "/input.txt"))
      :gsub("OFFSET", tostring(offset))))
  end
  script(0)
  local status, _, err = check.run(("%s/run.lua %s"):format(folder, words:gsub("FOLDER", folder)))
  assert.equal(0, status, err)
  return folder, script
end

local function has(where, part)
  assert.truthy(where:find(part, 1, true), ("\"%s\" is not in: %s"):format(part, where))
end

describe("a run", function()
  it("is repeated, and is the same but for the clock", function()
    for _, words in ipairs {"--out FOLDER/result", "FOLDER/result", "--out=FOLDER/result/",
      "--x 1 --out FOLDER/result"} do
      local folder = experiment(words)
      local status, out, err = check.run(("rerun %s/result/manifest.json"):format(folder))
      assert.equal(0, status, out .. err)
      has(out, "the same")
      local again = json.decode(check.read(folder .. "/result.again/result.json"))
      assert.equal(5, again.sum)
      assert.equal(folder .. "/result.again/a", again.file)
      -- a repeated run is a run
      assert.equal(0, (check.run(("rerun %s/result.again/manifest.json --out %s/third"):format(folder, folder))))
    end
  end)

  it("names the modules that it has loaded, also after the folder was opened, and those that changed", function()
    local folder = check.folder()
    check.write(folder .. "/helper.lua", "return {x = 2}\n")
    check.write(folder .. "/run.lua", [[
local bw = require "barwright"
package.path = arg[0]:match "^(.*)/" .. "/?.lua;" .. package.path
local results = assert(bw.results.open(arg[1], {seed = 1}))
assert(results:write {x = require("helper").x})
]])
    assert.equal(0, (check.run(("%s/run.lua %s/result"):format(folder, folder))))
    local required = json.decode(check.read(folder .. "/result/manifest.json")).required
    assert.equal(1, #required)
    assert.same({module = "helper", file = folder .. "/helper.lua",
      sha256 = require("barwright.core").sha256(folder .. "/helper.lua")}, required[1])
    check.write(folder .. "/helper.lua", "return {x = 2} -- the same\n")
    local status, out = check.run(("rerun %s/result/manifest.json"):format(folder))
    assert.equal(0, status)
    has(out, "module helper: ")
  end)

  it("says which numbers are others, and by how much", function()
    local folder, script = experiment "--out FOLDER/result"
    script(1)
    local status, out = check.run(("rerun %s/result/manifest.json"):format(folder))
    assert.equal(1, status)
    has(out, "run.lua: SHA-256 ")
    has(out, "  sum: 6, was 5, apart by 16.7 %")
    has(out, "  rows[2].value: 3.000000000003, was 3, apart by 1e-10 %")
    has(out, "  name: b, was a")
    has(out, "  list[3]: 3, was nothing")
    local timings, others = out:match "different as the clock[^\n]*: %d\n(.*)different: 4\n(.*)$"
    has(timings, "  seconds_solve: ")
    assert.falsy(others:find("seconds", 1, true))
    local object
    status, out = check.run(("rerun %s/result/manifest.json --json --tolerance 1e-9"):format(folder))
    object = json.decode(out)
    assert.equal(1, status)
    assert.is_false(object.same)
    local paths = {}
    for i, entry in ipairs(object.differences) do paths[i] = entry.path end
    assert.equal("list[3] name sum", table.concat(paths, " "))
    check.near(1 / 6, object.differences[3].relative, 1e-12)
    assert.equal("script", object.surroundings[1].what)
  end)

  it("needs its inputs as they were", function()
    local folder = experiment "--out FOLDER/result"
    check.write(folder .. "/input.txt", "6\n")
    local status, out, err = check.run(("rerun %s/result/manifest.json"):format(folder))
    assert.equal(2, status)
    has(err, "1 of 1 inputs are missing or changed")
    has(out .. err, "/input.txt: is not the file it was")
    status, out = check.run(("rerun %s/result/manifest.json --anyway"):format(folder))
    assert.equal(1, status)
    has(out, "  sum: 6, was 5")
    os.remove(folder .. "/input.txt")
    local _
    status, _, err = check.run(("rerun %s/result/manifest.json"):format(folder))
    assert.equal(2, status)
    has(err, "/input.txt: cannot be read")
    status, _, err = check.run(("rerun %s/result/ --anyway"):format(folder)) -- the folder will do
    assert.equal(3, status)
    has(err, "without a result")
  end)

  it("of scenarios is repeated although its folder lies in theirs", function()
    local folder = check.folder()
    check.write(folder .. "/a.lua", [[local bw = require "barwright"
bw.scenario("a", function() bw.scenario.expect(1):above(0) end)]])
    assert.equal(0, (check.run(("test %s --out %s/out"):format(folder, folder))))
    local status, out, err = check.run(("rerun %s/out/manifest.json"):format(folder))
    assert.equal(0, status, out .. err)
    has(out, ("barwright test %s --out %s/out.again"):format(folder, folder))
  end)

  it("of the page's script does what the page says", function()
    local folder, page = check.folder(), check.read(check.root .. "/docs/howto_experiments.md")
    check.write(folder .. "/bracket.lua", page:match "```lua\n(.-)```")
    local status, _, err = check.run(("%s/bracket.lua %s/result 30"):format(folder, folder))
    assert.equal(0, status, err)
    local out
    status, out = check.run(("rerun %s/result/manifest.json"):format(folder))
    assert.equal(0, status, out)
    has(out, "3 values compared")
  end)

  it("is refused without a manifest that says what was run", function()
    local folder = experiment "--out FOLDER/result"
    assert.equal(3, (check.run("rerun " .. folder .. "/no.json")))
    assert.equal(3, (check.run("rerun " .. folder .. "/input.txt")))
    check.write(folder .. "/result/manifest.json", "{}")
    local status, _, err = check.run("rerun " .. folder .. "/result/manifest.json")
    assert.equal(2, status)
    has(err, "does not say what was run")
  end)
end)

describe("differences", function()
  it("are found at their paths; what the clock decides is apart", function()
    local found = differences.of(
      {a = 1, seconds_a = 1, inner = {seconds = {x = 1}, ratio = 2}, s = "x", n = json.null},
      {a = 1.5, seconds_a = 2, inner = {seconds = {x = 3}, ratio = 2}, s = "y", n = json.null, more = true}, {})
    local paths, timings = {}, {}
    for i, entry in ipairs(found.differences) do paths[i] = entry.path end
    for i, entry in ipairs(found.timings) do timings[i] = entry.path end
    assert.equal("a more s", table.concat(paths, " "))
    assert.equal("inner.seconds.x seconds_a", table.concat(timings, " "))
    check.near(1 / 3, found.differences[1].relative, 1e-12)
    for name, timing in pairs {seconds = true, seconds_fill = true, processor_seconds = true,
      peak_memory_bytes = true,
      frames_per_second = true, speed_up = true, second_moment = false, rounds = false, volume_fraction = false} do
      assert.equal(timing, differences.is_timing(name), name)
    end
  end)
end)
