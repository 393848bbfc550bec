-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Studies: variables, trials with their statuses, the file, going on, one writer, trials run again, tables,
-- files merged.
local bw = require "barwright"
local check = require "check"

local function options(folder, more)
  local out = {
    name = "beam", seed = 7, file = folder .. "/beam.study",
    variables = {
      {name = "height", unit = "m", min = 0.01, max = 0.1, scale = "log"},
      {name = "holes", kind = "integer", min = 0, max = 4},
      {name = "stiff", kind = "choice", of = {true, false}},
    },
    measures = {{name = "mass", unit = "kg"}, {name = "sag", unit = "m"}},
    design = {"random", count = 20},
    run = function(point, trial)
      return {mass = point.height * (10 - point.holes), sag = trial:random() * (point.stiff and 1 or 2)}
    end,
  }
  for key, value in pairs(more or {}) do out[key] = value end
  return out
end

local function study(more, folder)
  return bw.study(options(folder or check.folder(), more))
end

local function numbers(trials)
  local out = {}
  for _, trial in ipairs(trials) do
    out[trial.key] = {trial.number, trial.seed, trial.status, trial.results and trial.results.mass or false,
      trial.results and trial.results.sag or false}
  end
  return out
end

describe("the definition of a study", function()
  it("is checked, and says what is expected", function()
    for _, each in ipairs {
      {{variabels = {}}, "did you mean 'variables'"},
      {{variables = {}}, "variables = {{name"},
      {{variables = {{name = "a", min = 1, max = 1}}}, "'a': min below max expected, got min = 1 and max = 1"},
      {{variables = {{name = "a", min = -1, max = 1, scale = "log"}}},
        "min above 0 expected with scale 'log', got -1"},
      {{variables = {{name = "a", kind = "integer", min = 0.5, max = 3}}}, "whole numbers"},
      {{variables = {{name = "a", kind = "choice"}}}, "of = {...}"},
      {{variables = {{name = "a", of = {"x", "x"}}}}, "the choice x occurs twice"},
      {{variables = {{name = "a", min = 0, max = 1}, {name = "a", min = 0, max = 1}}}, "'a' occurs twice"},
      {{variables = {{name = "a", min = 0, max = 1, default = 2}}}, "a number from 0 to 1 expected, got 2"},
      {{measures = {}}, "measures = {{name"},
      {{measures = {"height"}}, "measure 'height' has the name of a variable"},
      {{objectives = {{name = "mas"}}}, "did you mean 'mass'"},
      {{constraints = {{name = "sag"}}}, "min or max expected, got neither"},
      {{design = {"latin", count = 3}}, "one of bayesian, form, grid, importance, "},
      {{variables = {{name = "a", low = 0, max = 1}}}, "unknown option 'low': known are default, "},
      {{design = {"random", cuont = 3}}, "did you mean 'count'"},
      {{design = {"random"}}, "option 'count' is missing"},
      {{run = 1}, "a function (point, trial) expected"},
      {{name = "a/b"}, "without slashes"},
    } do check.raises(each[2], study, each[1]) end
  end)

  it("brings the unit interval to values and back", function()
    local variables = require "barwright.study.variables"
    local list = variables.read("x", {{name = "r", min = -2, max = 5}, {name = "l", min = 1e-3, max = 10,
      scale = "log"}, {name = "i", kind = "integer", min = -1, max = 2}, {name = "c", of = {"a", 2, true}}})
    for k, v in ipairs(list) do
      local seen, source = {}, check.random(k)
      for _ = 1, 200 do
        local u = source()
        local value = v:value(u)
        seen[value] = true
        assert.equal(value, v:check(value, "here"))
        local back = v:value(v:place(value))
        if v:count() then assert.equal(value, back) else check.near(value, back, 1e-12) end
      end
      local count = 0
      for _ in pairs(seen) do count = count + 1 end
      assert.equal(v:count() or 200, count)
    end
    assert.equal(-2.0, list[1]:value(0))
    assert.equal(5.0, list[1]:value(1))
    assert.equal(10.0, list[2]:value(1))
    check.near(0.1, list[2]:value(0.5), 1e-14)
    assert.equal(2, list[3]:value(1))
    check.raises("expected, got 3", list[3].check, list[3], 3, "here")
    check.raises("one of a, 2, true expected", list[4].check, list[4], "2", "here")
  end)

  it("names a trial by its point, whatever the order of variables", function()
    local key = require "barwright.study.key"
    local a = key.of("s", 1, {"x", "y"}, {x = 0.1, y = "k"})
    assert.equal(64, #a)
    assert.equal(a, key.of("s", 1, {"x", "y"}, {y = "k", x = 0.1}))
    for _, other in ipairs {key.of("s", 2, {"x", "y"}, {x = 0.1, y = "k"}), key.of("t", 1, {"x", "y"},
      {x = 0.1, y = "k"}), key.of("s", 1, {"x", "y"}, {x = 0.1 + 2 ^ -56, y = "k"}),
      key.of("s", 1, {"x", "y"}, {x = 0.1, y = "K"})} do assert.are_not.equal(a, other) end
    assert.are_not.equal(key.of("s", 1, {"x"}, {x = 1}), key.of("s", 1, {"x"}, {x = 1.0}))
    local seed = key.seed(1, a)
    assert.is_true(seed >= 0 and seed < 2 ^ 53)
    assert.are_not.equal(seed, key.seed(2, a))
  end)
end)

describe("a run", function()
  it("runs every trial once; again, it asks the file", function()
    local folder, log = check.folder(), check.folder() .. "/log"
    local function make(more)
      local opts = options(folder, more)
      local inner = opts.run
      opts.run = function(point, trial)
        local file = io.open(log, "a")
        file:write(trial.number, "\n")
        file:close()
        return inner(point, trial)
      end
      return bw.study(opts)
    end
    local first = assert(make():run {workers = 2})
    assert.equal(20, #first)
    for i, trial in ipairs(first) do
      assert.equal(i, trial.number)
      assert.equal("done", trial.status)
      check.near(trial.point.height * (10 - trial.point.holes), trial.results.mass, 1e-15)
      assert.equal("boolean", type(trial.point.stiff))
      assert.is_true(trial.seconds >= 0 and trial.peak_bytes > 1e6)
    end
    local again = make()
    local second = assert(again:run {workers = 1})
    assert.same(numbers(first), numbers(second))
    assert.same(numbers(first), numbers(assert(again:trials())))
    local _, runs = check.read(log):gsub("\n", "")
    assert.equal(20, runs)
    assert.truthy(tostring(second):find("20 trials of study beam: 20 done", 1, true))
    assert.truthy(tostring(second[3]):find("trial 3 (height", 1, true))
  end)

  it("gives the same numbers by any number of workers, alone, and in parts that are merged", function()
    local whole = numbers(assert(study():run {workers = 1}))
    assert.same(whole, numbers(assert(study():run {workers = 3})))
    local folder = check.folder()
    for part = 1, 3 do
      local own = bw.study(options(folder)):use_file(("%s/part%d.study"):format(folder, part))
      local some = assert(own:run {workers = 2, shard = {part, 3}})
      assert.equal(part == 3 and 6 or 7, #some)
      assert.equal("the other parts are run elsewhere", some.stopped)
    end
    local target = bw.study(options(folder))
    local merged = assert(target:merge {folder .. "/part1.study", folder .. "/part3.study"})
    assert.equal(13, merged.taken)
    assert.equal(7, target:status().missing)
    merged = assert(target:merge {folder .. "/part2.study", folder .. "/part1.study"})
    assert.same({7, 7, 0}, {merged.taken, merged.duplicates, #merged.conflicts})
    assert.same(whole, numbers(assert(target:trials())))
    assert.same(whole, numbers(assert(target:run())))
  end)

  it("records what fails, crashes, hangs and fills memory, and goes on; retry runs those again", function()
    local folder = check.folder()
    local function make(repaired)
      return bw.study {name = "bad", file = folder .. "/bad.study",
        measures = {"m", {name = "o", optional = true}},
        variables = {{name = "k", kind = "integer", min = 1, max = 9}}, design = {"grid"},
        run = function(point)
          local k = repaired and 1 or point.k
          if k == 2 then error("broken " .. point.k) end
          if k == 3 then return nil, "no convergence" end
          if k == 4 then os.execute("kill -SEGV $PPID") end
          if k == 5 then os.execute "sleep 1000" end
          if k == 6 then return {m = #("x"):rep(1 << 30)} end
          if k == 7 then return {m = 0 / 0} end
          if k == 8 then return {mm = 1} end
          if k == 9 then return {} end
          return {m = point.k, o = k == 1 and 2 or nil}
        end}
    end
    local trials = assert(make():run {seconds = 5, bytes = 3e8, workers = 2})
    local status = {}
    for i, trial in ipairs(trials) do status[i] = trial.status end
    assert.same({"done", "failed", "failed", "crashed", "time", "memory", "failed", "failed", "failed"}, status)
    for k, text in pairs {[2] = "broken 2", [3] = "no convergence", [7] = "measure 'm' is not a number",
      [8] = "did you mean 'm'", [9] = "returned no 'm'"} do
      assert.truthy(trials[k].message:find(text, 1, true), trials[k].message)
    end
    assert.same({done = 1, failed = 5, crashed = 1, time = 1, memory = 1}, trials:counts())
    assert.same({1}, trials:column "m")
    assert.same({1, false, false, false, false, false, false, false, false}, trials:column("m", {all = true}))
    assert.equal(5, #trials:where "failed")
    local state = make():status()
    assert.equal(0, state.missing)
    assert.equal(1, state.crashed)
    assert.equal(1, make(true):run():counts().done)
    local repaired = assert(make(true):run {retry = true})
    assert.equal(9, repaired:counts().done)
    assert.equal(2, repaired[5].attempts)
    assert.equal(1, repaired[1].attempts)
  end)

  it("goes on with a changed script when asked to, and remembers both", function()
    local folder = check.folder()
    local text = [[
      local bw, file, factor = require "barwright", ...
      return bw.study {name = "script", file = file, variables = {{name = "x", min = 0, max = 1}},
        measures = {"y"}, design = {"random", count = 4}, run = function(point) return {y = %d * point.x} end}
    ]]
    local function make(factor)
      check.write(folder .. "/s.lua", text:format(factor))
      return assert(loadfile(folder .. "/s.lua"))(folder .. "/s.study")
    end
    local one = assert(make(1):run {evaluations = 2})
    check.fails("different", "continue = true", make(2):run())
    local both = assert(make(2):run {continue = true})
    assert.equal(one[2].results.y, both[2].results.y)
    check.near(2 * both[3].point.x, both[3].results.y, 1e-15)
    assert.equal(4, #assert(make(1):run()))
    assert.equal(4, #assert(make(2):run()))
    local other = make(1):use_file(folder .. "/other.study")
    assert(other:run())
    check.fails("different", "another text", other:merge(folder .. "/s.study"))
    assert.equal(2, #assert(other:merge(folder .. "/s.study", {continue = true})).conflicts)
  end)

  it("ends early: by evaluations, by what the trials say, by time", function()
    local trials = assert(study():run {evaluations = 7, workers = 2})
    assert.equal(7, #trials)
    assert.equal("7 evaluations were made", trials.stopped)
    local one = study()
    local seen
    trials = assert(one:run {workers = 2, stop_when = function(so_far)
      seen = #so_far
      return #so_far == 5
    end})
    assert.equal(5, seen)
    assert.is_true(#trials >= 5)
    assert.equal(20, #assert(one:run()))
    trials = assert(study({run = function() os.execute "sleep 0.2" return {mass = 1, sag = 1} end})
      :run {seconds_total = 1.5, workers = 1})
    assert.is_true(#trials <= 9, #trials)
    assert.truthy(trials.stopped:find "seconds have passed")
  end)

  it("goes on with designs that grow from results as if nothing had been", function()
    local function make(folder, design, objectives)
      return bw.study {name = "grow", file = folder .. "/grow.study", measures = {"y", "z"}, design = design,
        variables = {{name = "a", min = -2, max = 2}, {name = "b", min = 0.1, max = 10, scale = "log"}},
        objectives = objectives, run = function(point)
          local file = io.open(folder .. "/log", "a")
          file:write "x"
          file:close()
          return {y = (point.a - 1) ^ 2 + math.log(point.b) ^ 2, z = point.a ^ 2 + point.b},
            {y = {a = 2 * (point.a - 1), b = 2 * math.log(point.b) / point.b}}
        end}
    end
    for _, each in ipairs {
      {{"pareto", population = 8, generations = 4}, {"y", "z"}},
      {{"minimise", method = "lbfgs", gradient = "run", evaluations = 30}, {"y"}},
      {{"minimise", method = "bobyqa", starts = 3, evaluations = 12}, {"y"}},
      {{"minimise", method = "slsqp", evaluations = 10}, {"y"}},
    } do
      local one, two = check.folder(), check.folder()
      local whole = assert(make(one, each[1], each[2]):run {workers = 2})
      local runs = #check.read(one .. "/log")
      assert.equal(#whole, runs)
      for _, max in ipairs {3, 7, 11} do
        local some = assert(make(two, each[1], each[2]):run {evaluations = max, workers = 1})
        assert.equal(math.min(max, #whole), #some)
      end
      local rest = assert(make(two, each[1], each[2]):run())
      assert.equal(runs, #check.read(two .. "/log"))
      assert.equal(#whole, #rest)
      for i, trial in ipairs(whole) do
        assert.equal(trial.key, rest[i].key)
        assert.equal(trial.number, rest[i].number)
        assert.same(trial.results, rest[i].results)
        assert.same(trial.gradients, rest[i].gradients)
      end
      if #each[2] == 1 then
        assert.equal(whole.summary.best.key, rest.summary.best.key)
        assert.is_true(whole:best().results.y < 1e-2, whole:best().results.y)
        assert.same(whole.summary.starts, rest.summary.starts)
      else
        assert.equal(#whole.summary.front, #rest.summary.front)
        assert.is_true(#whole:front() > 4)
      end
    end
  end)

  it("raises what a design or the progress raises, unchanged", function()
    local ok, message = pcall(function()
      return study({objectives = {"mass"}, design = function() error("my own error", 0) end}):run()
    end)
    assert.same({false, "my own error"}, {ok, message})
  end)

  it("is stopped by a progress function that returns false, at the end too, and no other call is", function()
    for _, at in ipairs {0, 1} do
      local before = bw.progress(function(_, fraction) return fraction < at end)
      check.fails("cancelled", "run it again", study({objectives = {"mass"}}):run())
      bw.progress(before)
      assert(bw.mesh.box {max = {1, 1, 1}, cells = {1, 1, 1}})
    end
  end)

  it("lets a function be the design", function()
    local rounds = 0
    local one = study {objectives = {"mass"}, design = function(evaluate, problem)
      local point = problem:initial()
      while true do
        rounds = rounds + 1
        local other = {height = point.height / 1.2, holes = point.holes, stiff = point.stiff}
        if other.height < 0.01 then return {rounds = rounds} end
        local results, trials = evaluate {point, other}
        assert(results[1].mass > results[2].mass and trials[2].point.height == other.height)
        point = other
      end
    end}
    local trials = assert(one:run())
    assert.equal(rounds, #trials)
    assert.equal(rounds, trials.summary.rounds)
    assert.equal(trials[#trials].key, trials:best().key)
    assert.equal(5, #assert(one:run {design = {"random", count = 5, seed = 9}}))
    assert.equal(rounds + 5, #assert(one:trials()))
    check.raises("oops here", function()
      study({design = function() error "oops here" end}):run()
    end)
    check.raises("'hieght' is no variable: did you mean 'height'", function()
      study({design = function(evaluate) evaluate {{hieght = 1}} end}):run()
    end)
  end)

  it("refuses a file of another study and a second run at the same time, with the reason", function()
    local folder = check.folder()
    assert(bw.study(options(folder)):run())
    local other = options(folder)
    other.variables[1].max = 0.2
    check.fails("different", "variable 'height': max was 0.1, is 0.2", bw.study(other):run())
    other = options(folder, {seed = 8})
    check.fails("different", "its seed is 7, not 8", bw.study(other):run())
    other = options(folder)
    table.remove(other.variables)
    check.fails("different", "its variable 'stiff' is gone", bw.study(other):run())
    check.fails("different", "variable 'stiff' is gone", bw.study(other):trials())
    check.write(folder .. "/text.study", "no database at all, but a text that is long enough to be one")
    check.fails("foreign", "text.study", bw.study(options(folder, {file = folder .. "/text.study"})):run())
    check.fails("io", "nowhere", bw.study(options(folder, {file = "/nowhere/x.study"})):run())
    -- A run inside of a run of the same file, and one of another process.
    local outer = options(folder, {file = folder .. "/lock.study"})
    local inner
    local design = function(evaluate, problem)
      inner = table.pack(bw.study(options(folder, {file = folder .. "/lock.study"})):run())
      return evaluate {problem:initial()} and {} or {}
    end
    outer.design = design
    local locked = bw.study(outer)
    assert.equal(1, #assert(locked:run()))
    check.fails("busy", "is being run by this process", table.unpack(inner, 1, inner.n))
  end)

  it("shows trials their own folder and numbers, and never each other", function()
    local count = 0
    local trials = assert(study({run = function(_, trial)
      count = count + 1
      check.write(trial.folder .. "/note.txt", tostring(trial.number))
      math.random()
      return {mass = count, sag = trial:random(3, 5) + math.random() + trial:normal(0, 1)}
    end}):run {output = true})
    for i, trial in ipairs(trials) do
      assert.equal(1, trial.results.mass)
      assert.equal(tostring(i), check.read(trial.folder .. "/note.txt"))
    end
    assert.equal(0, count)
    assert.same(trials:column "sag", assert(study({run = trials.study.run_function}):run()):column "sag")
  end)
end)

describe("one trial again", function()
  it("gives the same bits; reports what differs", function()
    local folder = check.folder()
    local one = bw.study(options(folder))
    local trials = assert(one:run())
    for _, opts in ipairs {{}, {inside = true}} do
      local again = assert(one:trial(5, opts))
      assert.is_true(again.same)
      assert.same(trials[5].results, again.trial.results)
      assert.equal(trials[5].key, again.trial.key)
    end
    assert.is_true(one:trial(trials[9].key:sub(1, 16)).same)
    assert.is_true(one:trial(trials[9].point).same)
    local opts = options(folder)
    opts.run = function() return {mass = 1, sag = 2} end
    local other = assert(bw.study(opts):trial(5))
    assert.is_false(other.same)
    assert.equal("mass", other.differences[1].name)
    assert.truthy(tostring(other):find("in the file, 1 now", 1, true))
    check.fails("empty", "has no trial 99", one:trial(99))
    check.fails("empty", "no trial whose key begins with ffffffffffff", one:trial "ffffffffffff")
    check.raises("four or more digits", one.trial, one, "x")
    local added = assert(one:trial {height = 0.05, holes = 1, stiff = true})
    assert.is_nil(added.before)
    assert.equal("done", added.trial.status)
  end)
end)

describe("trials that edit one session", function()
  it("do not see each other: the same bits in any order, on any number of workers and alone", function()
    local folder = check.folder()
    local mesh = assert(bw.mesh.box {max = {0.06, 0.01, 0.01}, cells = {12, 2, 2}})
    local part = bw.model {mesh = mesh, material = bw.material.pla}
    part:fix(mesh.boundary:below(1, 0))
    part:load {on = mesh.boundary:above(1, 0.06), force = {0, 0, -1}}
    local session = assert(bw.edit(part, {skeleton = bw.skeleton.create {root = "wall", joints = {
      wall = {0, 0.005, 0.005}, middle = {0.03, 0.005, 0.005}, tip = {0.06, 0.005, 0.005}},
      bones = {{"wall", "middle", name = "arm"}, {"middle", "tip", name = "hand"}}}}))
    assert(session:solve())
    local function made(file, widths)
      local points = {}
      for i, width in ipairs(widths) do points[i] = {width = width} end
      return bw.study {name = "session", file = folder .. file, measures = {"sag"},
        variables = {{name = "width", min = 0.8, max = 1.2}}, design = {"points", points = points},
        run = function(point)
          assert(session:bone("arm"):scale {1, point.width, point.width})
          return {sag = -assert(session:solve()).displacement:column(3):min()}
        end}
    end
    local sag = {}
    local first = made("/one.study", {0.9, 1, 1.1, 0.95})
    for _, trial in ipairs(assert(first:run {workers = 1})) do sag[trial.point.width] = trial.results.sag end
    assert.is_true(sag[0.9] > sag[0.95] and sag[0.95] > sag[1] and sag[1] > sag[1.1])
    for _, trial in ipairs(assert(made("/two.study", {0.95, 1.1, 1, 0.9}):run {workers = 2})) do
      assert.equal(sag[trial.point.width], trial.results.sag)
    end
    assert.is_true(assert(first:trial(3)).same)
  end)
end)

describe("tables and merging", function()
  it("follow RFC 4180, with units in the head", function()
    local folder = check.folder()
    local one = bw.study {name = "a table", file = folder .. "/t.study", design = {"points", points = {{x = 0.1,
      ['say "hi"'] = "a,b"}, {x = 1 / 3, ['say "hi"'] = "line\nbreak"}}}, measures = {{name = "y", unit = "Pa"}},
      variables = {{name = "x", unit = "m", min = 0, max = 1},
        {name = 'say "hi"', of = {"a,b", "line\nbreak"}}},
      run = function(point)
        if point.x > 0.3 then error "no, really" end
        return {y = 3}
      end}
    assert(one:run())
    assert(one:csv(folder .. "/t.csv"))
    local text = check.read(folder .. "/t.csv")
    local head, rest = text:match "^(.-)\r\n(.*)$"
    assert.equal('number,key,seed,status,message,seconds [s],processor_seconds [s],peak_bytes [B],x [m],'
      .. '"say ""hi""",y [Pa]', head)
    assert.truthy(rest:match '^1,%x+,%d+,done,,[%d.e-]+,[%d.e-]+,%d+,0%.1,"a,b",3\r\n')
    assert.truthy(rest:find('no, really",', 1, true))
    assert.truthy(rest:find(',0.333333333333333', 1, true))
    assert.equal("\r\n", text:sub(-2))
  end)

  it("say which trials keep the constraints and which are on the front", function()
    local folder = check.folder()
    local one = bw.study {name = "front", file = folder .. "/f.study", design = {"points",
      points = {{x = 1}, {x = 2}, {x = 3}, {x = 4}}}, variables = {{name = "x", min = 0, max = 5}},
      measures = {"a", "b"}, objectives = {"a", "b"}, constraints = {{name = "a", max = 3}},
      run = function(point) return point.x < 4 and {a = point.x, b = point.x == 2 and 9 or -point.x} or nil end}
    assert(one:run())
    assert(one:csv(folder .. "/f.csv"))
    local rows = {}
    for row in check.read(folder .. "/f.csv"):gmatch "(.-)\r\n" do
      rows[#rows + 1] = row:match "([^,]*,[^,]*)$"
    end
    assert.same({"feasible,front", "true,true", "true,false", "true,true", "false,false"}, rows)
  end)

  it("keeps the first of two different numbers, and says so", function()
    local folder = check.folder()
    local function make(value, file)
      local opts = options(folder, {file = folder .. "/" .. file})
      opts.run = function(point) return {mass = point.holes == 2 and value or 0, sag = 0} end
      return bw.study(opts)
    end
    local one, two = make(1, "one.study"), make(2, "two.study")
    assert(one:run())
    assert(two:run())
    local merged = assert(one:merge(folder .. "/two.study"))
    assert.is_true(#merged.conflicts > 0)
    assert.equal(20, #merged.conflicts + merged.duplicates)
    assert.same({1, 2}, {merged.conflicts[1].kept, merged.conflicts[1].other})
    check.fails("io", "three.study", one:merge {folder .. "/three.study"})
  end)
end)
