-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright study: what each action says, writes, and ends with.
local bw = require "barwright"
local check = require "check"

local script = [[
local bw = require "barwright"
return bw.study {
  name = "hook", seed = 1, file = "%s/hook.study",
  variables = {{name = "thickness", unit = "m", min = 1e-3, max = 5e-3},
    {name = "material", of = {"pla", "abs"}}},
  measures = {{name = "mass", unit = "kg"}, {name = "stress", unit = "Pa"}},
  objectives = {"mass"}, constraints = {{name = "stress", max = 55e6}},
  design = {"latin_hypercube", count = 12},
  run = function(point, trial)
    if trial.number == 3 then return nil, "the mesh is empty" end
    print("this is trial", trial.number)
    return {mass = 10 * point.thickness, stress = 1e5 / point.thickness}
  end,
}
]]

local folder
local function run(arguments)
  local status, said, complaint = check.run("study " .. arguments:gsub("@", folder .. "/"))
  return status, said, complaint
end

describe("barwright study", function()
  setup(function()
    folder = check.folder()
    check.write(folder .. "/hook.lua", script:format(folder))
  end)

  it("reports what there is to do before anything was run", function()
    local status, said = run "status @hook.lua"
    assert.equal(0, status)
    assert.truthy(said:find("12 of the design's 12 trials are missing", 1, true))
    local _
    status, _, said = run "csv @hook.lua"
    assert.equal(3, status)
    assert.truthy(said:find("hook.study", 1, true))
  end)

  it("runs, reports how it went, and has nothing left to do", function()
    local status, said, complaint = run "run @hook.lua --workers 2 --evaluations 5"
    assert.equal("", complaint)
    assert.equal(0, status)
    assert.truthy(said:find("5 trials of study hook: 4 done, 1 failed (stopped: 5 evaluations were made)", 1,
      true))
    assert.truthy(said:find("failed: the mesh is empty", 1, true))
    status, said = run "run @hook.lua --json"
    assert.equal(0, status)
    local object = assert(bw.json.decode(said))
    assert.equal(12, object.trials)
    assert.same({done = 11, failed = 1, time = 0, memory = 0, crashed = 0}, object.counts)
    assert.is_true(object.summary.best.results.stress <= 55e6)
    status, said = run "status @hook.lua --json"
    object = assert(bw.json.decode(said))
    assert.equal(0, object.missing)
    assert.equal("the mesh is empty", object.messages[1].message)
    assert.equal(0, status)
  end)

  it("writes tables, figures and a page", function()
    for name, words in pairs {["t.csv"] = "csv @hook.lua --out @t.csv",
      ["p.svg"] = "plot @hook.lua history --out @p.svg",
      ["xy.svg"] = "plot @hook.lua scatter --x thickness --y stress --colour mass --out @xy.svg",
      ["p.png"] = "plot @hook.lua scatter_matrix --out @p.png", ["r.html"] = "report @hook.lua --out @r.html"} do
      local status, _, complaint = run(words)
      assert.equal("", complaint)
      assert.equal(0, status)
      assert.is_true(#check.read(folder .. "/" .. name) > 500)
    end
    local status, _, complaint = run "plot @hook.lua scatter --x thickness"
    assert.equal(2, status)
    assert.truthy(complaint:find("option --y is missing", 1, true), complaint)
    status, _, complaint = run "plot @hook.lua history --x thickness"
    assert.equal(2, status)
    assert.truthy(complaint:find("plot history: unknown option --x", 1, true), complaint)
    local _, lines = check.read(folder .. "/t.csv"):gsub("\r\n", "")
    assert.equal(13, lines)
  end)

  it("runs one trial again, here or in a job", function()
    local status, said = run "trial @hook.lua 5 --inside"
    assert.equal(0, status)
    assert.truthy(said:find("this is trial\t5", 1, true))
    assert.truthy(said:find("the same numbers, bit for bit", 1, true))
    status, said = run "trial @hook.lua 5 --json"
    assert.equal(0, status)
    assert.is_true(bw.json.decode(said).same)
    local _, complaint
    status, _, complaint = run "trial @hook.lua 55"
    assert.equal(2, status)
    assert.truthy(complaint:find("has no trial 55; its 12 trials", 1, true))
  end)

  it("runs parts and merges them", function()
    for part = 1, 2 do
      assert.equal(0, (run(("run @hook.lua --shard %d/2 --file @part%d.study"):format(part, part))))
    end
    local status, said = run "merge @hook.lua @part1.study @part2.study --file @all.study"
    assert.equal(0, status)
    assert.truthy(said:find("12 trials taken from 2 files, 0 were there already", 1, true))
    run "csv @hook.lua --file @all.study --out @all.csv"
    local function without_time(path) -- nor memory
      local text = check.read(path):gsub("(done,,)[^,]*,[^,]*,[^,]*", "%1")
      return (text:gsub("(empty,)[^,]*,[^,]*,[^,]*", "%1"))
    end
    assert.equal(without_time(folder .. "/t.csv"), without_time(folder .. "/all.csv"))
  end)

  it("is refused a changed script until it may go on", function()
    check.write(folder .. "/other.lua", (script:format(folder):gsub("10 %*", "11 *")))
    local status, _, complaint = run "run @other.lua"
    assert.equal(2, status)
    assert.truthy(complaint:find("--continue", 1, true))
    assert.equal(0, (run "run @other.lua --continue"))
    local said
    status, said = run "trial @other.lua 5"
    assert.equal(1, status)
    assert.truthy(said:find("in the file", 1, true))
  end)

  it("keeps what trials print, runs failed ones again", function()
    local path = folder .. "/hook.trials"
    local status, said = run "run @hook.lua --retry --output --json"
    assert.equal(0, status)
    assert.equal(1, bw.json.decode(said).counts.failed)
    check.write(folder .. "/repaired.lua", (script:format(folder):gsub("== 3", "== 33")))
    status, said = run "run @repaired.lua --retry --output --continue --json"
    assert.equal(0, status)
    assert.equal(12, bw.json.decode(said).counts.done)
    local list = io.popen(("cat '%s'/*/output.txt"):format(path)):read "a"
    assert.truthy(list:find("this is trial\t3", 1, true))
  end)

  it("saves what can be read of a damaged file", function()
    local text = check.read(folder .. "/hook.study")
    check.write(folder .. "/cut.study", text:sub(1, #text - 8192))
    local status, said = run "salvage @cut.study @saved.study"
    assert.equal(0, status)
    assert.truthy(said:find("rows", 1, true))
    local _, complaint
    status, _, complaint = run "salvage @cut.study"
    assert.equal(2, status)
    assert.truthy(complaint:find("the damaged file and the new one expected", 1, true))
  end)

  it("says what was wrong with its words", function()
    for words, text in pairs {
      ["rum @hook.lua"] = "did you mean 'run'",
      ["run"] = "is missing",
      ["run @hook.lua more"] = "one argument too many",
      ["run @hook.lua --worker 2"] = "did you mean --workers",
      ["run @hook.lua --shard 3/2"] = "WHICH/COUNT expected",
      ["trial @hook.lua x"] = "a number, or four or more digits",
      ["trial @hook.lua"] = "is missing",
      ["merge @hook.lua"] = "are missing",
      ["plot @hook.lua"] = "kind of plot is missing: contact_sheet, ",
      ["plot @hook.lua paretto"] = "there is no kind 'paretto': one of contact_sheet, ",
      ["plot @hook.lua sensitivity"] = "design sobol_indices, morris or one_at_a_time expected",
      ["csv @hook.study"] = "hook.study holds trials: the study's script is expected",
    } do
      local status, _, complaint = run(words)
      assert.equal(2, status, words)
      assert.truthy(complaint:find(text, 1, true), complaint)
    end
    local status, _, complaint = run "run @none.lua"
    assert.equal(3, status)
    assert.truthy(complaint:find("none.lua: No such file", 1, true), complaint)
    check.write(folder .. "/no.lua", "return 1")
    status, _, complaint = run "run @no.lua"
    assert.equal(2, status)
    assert.truthy(complaint:find("a file of a study ends with `return bw.study{...}`", 1, true))
    check.write(folder .. "/bad.lua", "error 'here'")
    status, _, complaint = run "run @bad.lua"
    assert.equal(3, status)
    assert.truthy(complaint:find("bad.lua:1: here", 1, true))
    -- what is wrong with a study names its file, and shows nothing of barwright's own calls
    for from, to in pairs {["min = 1e%-3"] = "lowest = 1e-3", ["count = 12"] = "cuont = 12",
      ["latin_hypercube"] = "latin"} do
      check.write(folder .. "/wrong.lua", (script:format(folder):gsub(from, to)))
      status, _, complaint = run "run @wrong.lua"
      assert.equal(3, status)
      assert.truthy(complaint:find("wrong.lua: study hook: ", 1, true), complaint)
      assert.is_nil(complaint:find("traceback", 1, true), complaint)
    end
  end)

  it("counts trials that ended the same way as one", function()
    check.write(folder .. "/exits.lua", (script:format(folder):gsub("hook", "exits")
      :gsub("trial.number == 3.-end", "trial.number < 4 then os.exit(3) end")))
    local status = run "run @exits.lua --memory 2G --json"
    assert.equal(0, status)
    local _, said = run "status @exits.lua"
    assert.truthy(said:find("3 x the trial left its process with exit code 3", 1, true), said)
    run "report @exits.lua --out @exits.html"
    assert.truthy(check.read(folder .. "/exits.html"):find("crashed: the trial left its process", 1, true))
    _, said = run "trial @exits.lua 2"
    assert.truthy(said:find("it ended as it did in the file", 1, true), said)
  end)

  it("does what docs/howto_study.md shows", function()
    local text = check.read(check.root .. "/docs/howto_study.md"):match "`bracket%.lua`.-```lua\n(.-)```"
    check.write(folder .. "/bracket.lua", text)
    local status, said, complaint = run "run @bracket.lua --file @bracket.study --evaluations 3 --workers 2"
    assert.equal("", complaint)
    assert.equal(0, status)
    assert.truthy(said:find("3 trials of study bracket: 3 done", 1, true))
    assert.truthy(said:find("front of", 1, true))
  end)
end)
