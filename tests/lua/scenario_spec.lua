-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- `barwright test`: what expectations accept and refuse, what is reported of them, baselines, modes, selection,
-- broken files, jobs with limits.
local check = require "check"
local core = require "barwright.core"
local json = require "barwright.json"
local text = require "barwright.text"

local HEAD = [[local bw = require "barwright"
local scenario, expect = bw.scenario, bw.scenario.expect
]]

-- Runs scenario files {name = text} in a new folder: exit status, TAP, result.json, the folder, errors.
local function tested(files, options)
  local folder = check.folder()
  for name, source in pairs(files) do
    local inner = name:match "^(.*)/"
    if inner then os.execute(("mkdir -p '%s/%s'"):format(folder, inner)) end
    check.write(folder .. "/" .. name, source)
  end
  local status, out, err = check.run(("test %s --out %s/out %s"):format(folder, folder, options or ""))
  local ok, result = pcall(check.read, folder .. "/out/result.json")
  return {status = status, out = out, err = err, folder = folder, again = function(more)
    local code, tap, errors = check.run(("test %s --out %s/out %s"):format(folder, folder, more or ""))
    return code, tap, errors
  end, result = ok and json.decode(result) or nil}
end

local function statuses(run)
  local list = {}
  for i, one in ipairs(run.result.scenarios) do list[i] = one.status end
  return table.concat(list, " ")
end

local function messages(one)
  local list = {}
  for _, entry in ipairs(one.entries) do
    if entry.kind == "expectation" and not entry.good then list[#list + 1] = entry.message end
  end
  return list
end

local function has(where, part)
  assert.truthy(where:find(part, 1, true), ("\"%s\" is not in: %s"):format(part, where))
end

describe("expectations", function()
  it("that are met", function()
    local run = tested {["a.lua"] = HEAD .. [[
scenario("all forms", function(t)
  expect(3, "three", "Pa"):below(3)
  expect(3):above(3)
  expect(3):between(3, 4)
  expect(440.4, "f", "Hz"):near(440, {relative = 0.001, source = "a fork"})
  expect(1e-12):near(0, {absolute = 1e-9})
  expect(bw.array.new {1, 2, 3}):near({1, 2, 3.001}, {relative = 1e-3})
  expect {1, {2, 3}}:equals {1, {2, 3}}
  expect("a"):equals "a"
  expect(true):is_true()
  expect(bw.surface.read "/no/where.stl"):fails_with("io", "where.stl")
  expect(function() return bw.surface.read "/no/where.stl" end):fails_with "io"
  expect(function() return bw.surface.read() end):fails_with {raises = "argument 1: a string expected"}
  expect(nil):equals(nil)
  t:require(expect(1):above(0))
  assert(t:require(5, "five") == 5)
end)]]}
    assert.equal(0, run.status, run.out .. run.err)
    local entries = run.result.scenarios[1].entries
    assert.equal(14, #entries)
    local fork = entries[4]
    assert.same({"f", "Hz", 440.4, 440, 0.001, "a fork", "near", true}, {fork.quantity, fork.unit, fork.figure,
      fork.reference, fork.relative, fork.source, fork.form, fork.good})
    assert.equal(7, fork.line)
  end)

  it("that are not are all listed, with what they saw, and t:require stops", function()
    local run = tested {["a.lua"] = HEAD .. [[
scenario("none is met", function(t)
  expect(3, "three", "Pa"):below(2)
  expect(0 / 0, "not a number"):below(2)
  expect(0 / 0):above(2)
  expect(0 / 0):near(1, {relative = 1})
  expect(5):between(1, 2)
  expect(440, "f", "Hz"):near(441, {relative = 0.001, absolute = 0.5})
  expect(bw.array.new {1, 2, 3}):near({1, 2}, {relative = 1})
  expect(bw.array.new {1, 2, 4}, "list", "m"):near({1, 2, 3}, {relative = 0.1})
  expect {a = {1, 2}}:equals {a = {1, 3}}
  expect(0.1 + 0.2, "sum"):equals(0.3)
  expect(false):is_true()
  expect(bw.surface.read "/no/where.stl"):below(2)
  expect(bw.surface.read "/no/where.stl"):fails_with "format"
  expect(bw.surface.read "/no/where.stl"):fails_with("io", "elsewhere")
  expect(function() return 5 end):fails_with "io"
  expect(function() error "oh" end):fails_with "io"
  t:require(expect(1, "stop"):above(2))
  expect(1, "never"):above(2)
end)]]}
    assert.equal(1, run.status)
    local list = messages(run.result.scenarios[1])
    assert.equal(17, #list, run.out)
    assert.equal("three: 3 Pa, at most 2 Pa expected (by 50 %)", list[1])
    has(list[2], "not a number: nan")
    has(list[6], "440 Hz, 441 Hz expected within 0.1 % or 0.5 Hz")
    has(list[7], "3 values, 2 values expected")
    has(list[8], "value 3 of 3 values is 4 m, 3 m expected: apart by 0.333 of the largest (3 m); within 10 %")
    has(list[9], "a[2] is 2, 3 expected")
    has(list[10], "0.30000000000000004, 0.29999999999999999 expected")
    has(list[12], "nothing to check: /no/where.stl: cannot be read")
    has(list[13], "status io, format expected")
    has(list[15], "it did not fail: 5")
    has(list[16], "it raised an error: ")
    assert.is_nil(run.result.scenarios[1].message)
    assert.falsy(run.out:find "never")
    has(run.out, "/a.lua:4\"")
  end)

  it("that are misused are errors of the script's line, and the others go on", function()
    local run = tested {["a.lua"] = HEAD .. [[
scenario("a", function() expect(1):near(2) end)
scenario("b", function() expect(1):near(0, {relative = 1}) end)
scenario("c", function() expect(1):belo(0) end)
scenario("d", function() expect({}):below(0) end)
scenario("e", function() expect(bw.array.new {1}):below(0) end)
scenario("f", function() expect(1):below("x") end)
scenario("g", function() expect(1):below(2, {sorce = "x"}) end)
scenario("h", function(t) t.requires(1) end)
scenario("i", function() error {} end)
scenario("j", function() end)
scenario("k", function() expect(1):below(2) end)]]}
    assert.equal(1, run.status)
    assert.equal("error error error error error error error error error failed passed", statuses(run))
    for i, part in ipairs {"{absolute = ...} expected, got neither", "absolute", "did you mean 'below'?",
      "a number expected, got table",
      "take its max()", "a number as the bound", "did you mean 'source'?", "did you mean 'require'?",
      "raised a table", "states no expectation"} do
      has(run.result.scenarios[i].message, part)
    end
    has(run.result.scenarios[1].message, "/a.lua:3: near")
  end)
end)

describe("a scenario", function()
  it("may be skipped, with the reason, before and while it runs", function()
    local run = tested {["a.lua"] = HEAD .. [[
scenario("a", {skip = "no #licence"}, function() error "x" end)
scenario("b", {skip = true}, function() error "x" end)
scenario("c", {skip = false}, function(t) t:skip "no program" end)]]}
    assert.equal(0, run.status, run.out)
    assert.equal("skipped skipped skipped", statuses(run))
    has(run.out, "a # SKIP no \\#licence\n")
    has(run.out, "c # SKIP no program\n")
  end)

  it("has notes, tables, a scratch folder, and pictures where it fails", function()
    local run = tested {["a.lua"] = HEAD .. [[
scenario("a", {about = "about it"}, function(t)
  t:note("%d pieces", 3)
  t:table {heads = {"a", "b"}, rows = {{1, "x"}, {2}}, text = "T"}
  local file = assert(io.open(t.folder .. "/scratch", "w"))
  file:close()
  io.stdout:write(t.folder)
  local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {2, 2, 2}}
  t:picture_of(mesh:surface(), {caption = "the <box>"})
  t:picture_of(function(path) return nil, "no paint" end)
  expect(2):below(1)
end)
scenario("b", function(t)
  t:picture_of(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {2, 2, 2}})
  expect(2):above(1)
end)]]}
    assert.equal("failed passed", statuses(run))
    local kinds, picture = {}, nil
    for i, entry in ipairs(run.result.scenarios[1].entries) do
      kinds[i] = entry.kind
      if entry.kind == "picture" then picture = entry end
    end
    assert.equal("note table expectation picture note", table.concat(kinds, " "))
    assert.equal("\137PNG", check.read(run.folder .. "/out/pictures/" .. picture.file):sub(1, 4))
    local page = check.read(run.folder .. "/out/index.html")
    has(page, "the &lt;box&gt;")
    has(page, "no paint")
    local scratch = run.result.scenarios[1].output
    if scratch then assert.is_nil(io.open(scratch .. "/scratch")) end
  end)

  it("is named once, and stated nowhere but in a scenario file", function()
    local run = tested {["a.lua"] = HEAD .. 'scenario("a", print)\nscenario("a", print)',
      ["b.lua"] = HEAD .. 'scenario("", print)', ["c.lua"] = HEAD .. 'scenario("c", {tag = "x"}, print)',
      ["d.lua"] = HEAD .. 'scenario("d", function() scenario("e", print) end)',
      ["e.lua"] = HEAD .. 'scenario("e", {tags = "slow"}, print)'}
    has(run.result.scenarios[1].message, "a.lua:4: scenario 'a': there is one of that title in line 3")
    has(run.result.scenarios[2].message, "b.lua:3: scenario: a title expected")
    has(run.result.scenarios[3].message, "did you mean 'tags'?")
    has(run.result.scenarios[4].message, "d.lua:3: scenario: only in a scenario file")
    has(run.result.scenarios[5].message, "e.lua:3: scenario: option 'tags': a list of words")
    local file = check.folder() .. "/plain.lua"
    check.write(file, HEAD .. 'scenario("a", print)')
    local status, _, err = check.run(file)
    assert.equal(1, status)
    has(err, "barwright test FILE")
  end)
end)

describe("modes", function()
  -- A square bar: bending modes come in pairs, mixed as the rounding will have it.
  local source = HEAD .. [[
local function bar(turned)
  local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}, cells = {8, 2, 2}, order = 2}
  return assert(bw.model {mesh = mesh, material = bw.material.isotropic {young = 1e9, poisson = 0.3,
    density = turned and 1000 * (1 + 1e-9) or 1000}}:modes {count = turned == 3 and 3 or 7})
end
]]
  it("are the same whatever their signs and the mix of a pair", function()
    local run = tested {["a.lua"] = source .. [[
scenario("same", function()
  expect(bar()):same_modes(bar(), {relative = 0})
  expect(bar()):same_modes(bar(1), {relative = 1e-6, last = false})
end)
scenario("others", function()
  expect(bar()):same_modes(bar(3))
  expect(bar()):same_modes(bar(1), {relative = 1e-12, shapes = false})
end)
scenario("kept", function() expect(bar()):matches_baseline("modes", {relative = 1e-6, last = false}) end)]]}
    assert.equal("passed failed failed", statuses(run), run.out)
    local list = messages(run.result.scenarios[2])
    assert.equal("7 modes, 3 expected", list[1])
    has(list[2], "the frequency of mode ")
    local code, tap = run.again "--update --only kept"
    assert.equal(0, code, tap)
    code, tap = run.again "--only kept"
    assert.equal(0, code, tap)
  end)

  it("in groups: spaces are compared, not vectors", function()
    local modes = require "barwright.scenario.modes"
    local array = core.array.new
    local function list(frequencies, shapes)
      return {count = #frequencies, frequencies = frequencies,
        shape = function(_, i) return array(shapes[i]) end}
    end
    local c, s = math.cos(0.7), math.sin(0.7)
    local a = list({1, 2, 2, 3}, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}})
    local b = list({1, 2, 2 * (1 + 1e-6), 3}, {{-2, 0, 0, 0}, {0, c, s, 0}, {0, 3 * s, -3 * c, 0}, {0, 0, 0, 1}})
    local opts = {degenerate = 1e-4}
    local found = modes.compare(a, b, opts)
    assert.equal(3, found.groups)
    assert.truthy(found.shape < 1e-12)
    check.near(1e-6, found.frequency, 1e-3)
    -- apart, the mixed vectors are others
    a.frequencies[3], b.frequencies[3] = 2.1, 2.1
    found = modes.compare(a, b, opts)
    check.near(s, found.shape, 1e-9)
    assert.same({2, 2}, found.group)
    a.frequencies[3] = 2
    -- a space that leans out of the other by an angle
    local leaning = list({1, 2, 2, 3}, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, math.cos(0.01), math.sin(0.01)},
      {0, 0, -math.sin(0.01), math.cos(0.01)}})
    check.near(math.sin(0.01), modes.compare(a, leaning, opts).shape, 1e-9)
    has(modes.compare(a, list({1}, {{1, 0, 0, 0}}), opts).message, "4 modes, 1 expected")
    has(modes.compare(a, list({1, 2, 2, 3}, {{1}, {1}, {1}, {1}}), opts).message, "shapes = false")
    assert.truthy(modes.compare(a, list({1, 2, 2, 0 / 0}, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0},
      {0, 0, 0, 1}}), opts).frequency ~= 0)
  end)
end)

describe("baselines", function()
  local function file(value)
    return HEAD .. ([[
scenario("a", function()
  expect(%s):matches_baseline("kept", {relative = 1e-6})
end)]]):format(value)
  end

  it("are written by --update, and only where they are missing or do not fit", function()
    local run = tested {["deep/a.lua"] =
      file "{mass = 2.5, list = {1, 2}, field = bw.array.new {{1, 2}, {3, 4}}, s = 'x'}"}
    assert.equal(1, run.status)
    has(run.out, "`barwright test --update` writes it")
    assert.equal(0, (run.again "--update"))
    local path = run.folder .. "/deep/baselines/a/kept.json"
    local kept = check.read(path)
    assert.equal(2.5, json.decode(kept).mass)
    assert.equal(0, (run.again()))
    -- within the tolerance: as it was
    check.write(run.folder .. "/deep/a.lua",
      file "{mass = 2.5 * (1 + 1e-8), list = {1, 2}, field = bw.array.new {{1, 2}, {3, 4}}, s = 'x'}")
    assert.equal(0, (run.again "--update"))
    assert.equal(kept, check.read(path))
    for value, part in pairs {
      ["{mass = 2.6, list = {1, 2}, field = bw.array.new {{1, 2}, {3, 4}}, s = 'x'}"] = "mass: 2.6, 2.5 expected",
      ["{mass = 2.5, list = {1, 3}, field = bw.array.new {{1, 2}, {3, 4}}, s = 'x'}"] = "list: 2: 3, 2 expected",
      ["{mass = 2.5, list = {1, 2}, field = bw.array.new {{1, 2}, {3, 5}}, s = 'x'}"] = "value 4 is 5, 4 expected",
      ["{mass = 2.5, list = {1, 2}, field = bw.array.new {{1, 2}, {3, 4}}, s = 'y'}"] = "s: y, x expected",
      ["{mass = 2.5, list = {1, 2}, field = bw.array.new {1, 2}, s = 'x'}"] = "2 x 1 values, 2 x 2 expected",
      ["{mass = 2.5, list = {1, 2}, s = 'x'}"] = "field: is not there any more",
      ["{mass = 2.5, list = {1, 2}, field = 3, s = 'x', new = 1}"] = "expected",
    } do
      check.write(run.folder .. "/deep/a.lua", file(value))
      local code, tap = run.again()
      assert.equal(1, code, value)
      has(tap, part)
    end
    assert.equal(0, (run.again "--update"))
    assert.equal(0, (run.again()))
  end)

  it("that are damaged, and values that cannot be kept, are reported", function()
    local run = tested {["a.lua"] = file "1", ["b.lua"] = file "bw.material.pla", ["baselines/a/kept.json"] = "{"}
    assert.equal("failed error", statuses(run))
    has(messages(run.result.scenarios[1])[1], "kept.json: line 1")
    has(run.result.scenarios[2].message, "a material cannot be kept")
  end)
end)

describe("files", function()
  it("with faults fail by file and line, and the others go on", function()
    local run = tested {["a.lua"] = "local x = = 3\n", ["b.lua"] = HEAD .. '\nerror "at load"',
      ["c.lua"] = "x = 1", ["d.lua"] = HEAD .. 'scenario("good", function() expect(1):above(0) end)',
      ["e.lua"] = 'require "nothing_there"', ["lib/help.lua"] = "return 5", ["f.lua"] = HEAD
        .. 'local five = require "help"\nscenario("helped", function() expect(five):equals(5) end)'}
    assert.equal(1, run.status)
    assert.equal("error error error passed error passed", statuses(run))
    has(run.result.scenarios[1].message, "a.lua:1: unexpected symbol near '='")
    has(run.result.scenarios[2].message, "b.lua:4: at load")
    has(run.result.scenarios[3].message, "c.lua: states no scenario")
    has(run.result.scenarios[5].message, "nothing_there")
    assert.equal(1, run.result.scenarios[1].line)
  end)

  it("and an empty selection are refused", function()
    local run = tested({["a.lua"] = HEAD .. 'scenario("a", {tags = {"slow"}}, function() expect(1):above(0) end)'},
      "--skip-tag slow")
    assert.equal(2, run.status)
    has(run.err, "none of 1 scenarios is asked for by --skip-tag slow (tags: slow)")
    for options, code in pairs {["--only a --tag slow"] = 0, ["--tag slow,fast"] = 0, ["--tag fast"] = 2,
      ["--only in_no_title"] = 2, ["--parallel 0"] = 2, ["--tga slow"] = 2} do
      assert.equal(code, (run.again(options)), options)
    end
    local status, _, err = check.run "test /no/where"
    assert.equal(3, status)
    has(err, "/no/where: there is no such file or folder")
    status, _, err = check.run("test " .. check.folder())
    assert.equal(2, status)
    has(err, "no scenario files")
    assert.equal(2, (check.run "test"))
  end)
end)

describe("what is reported", function()
  it("is well formed with odd characters", function()
    local run = tested {["a.lua"] = HEAD .. [==[
scenario("odd \240 # & < > \" ' \\", function()
  print "\1\2 ]]> & \255 \u{FFFE} \u{1F600}"
  expect("a\0b<&\n\r\27\195\40"):equals "]]>"
end)
scenario("error", function() error "<&\1\200>" end)]==]}
    assert.equal("failed error", statuses(run))
    local xml = check.read(run.folder .. "/out/junit.xml")
    assert.is_nil(xml:find "[%z\1-\8\11\12\14-\31]")
    assert.truthy(utf8.len(xml))
    has(xml, 'tests="2" failures="1" errors="1" skipped="0"')
    if os.execute "command -v xmllint >/dev/null 2>&1" then
      assert.truthy(os.execute(("xmllint --noout '%s/out/junit.xml'"):format(run.folder)))
    end
    -- every line of TAP is a result, a plan, a comment or in a block
    local inside
    for line in run.out:gmatch "[^\n]+" do
      if line == "  ---" then inside = true end
      assert.truthy(inside or line:match "^o?k?n?o?t? ?ok %d+ %- " or line:match "^#"
        or line:match "^1%.%.%d+$"
        or line:match "^TAP version", line)
      if line == "  ..." then inside = false end
    end
    assert.equal("a\u{FFFD}b", text.clean "a\0b")
    assert.equal("\u{FFFD}\u{FFFD}(", text.clean "\240\200(")
    assert.equal("&lt;&#10;\u{1F600}\u{FFFD}\u{FFFD}\u{FFFD}", text.xml "<\n\u{1F600}\xED\xA0\x80")
  end)

  it("is a manual, also from results of several runs", function()
    local run = tested({["a.lua"] = HEAD .. [[
scenario.about {title = "Bars", text = "About bars."}
scenario("quick | one", function(t)
  expect(440.4, "f", "Hz"):near(440, {relative = 0.001, source = "a fork"})
  expect(5, "max"):below(6, {how = "counted"})
  expect({1, 2.02}, "pressures", "Pa"):near({1, 2}, {relative = 0.02})
  expect({1, 2.5}, "pressures", "Pa"):near({1, 2}, {absolute = 0.5})
  t:table {heads = {"a"}, rows = {{"x|y"}}}
end)
scenario("slow one", {tags = {"slow"}}, function() expect(5, "max"):below(4) end)]]}, "--tag slow")
    assert.equal(1, run.status)
    os.execute(("cp -r %s/out %s/first"):format(run.folder, run.folder))
    local manual = run.folder .. "/manual.md"
    assert.equal(0, (run.again("--skip-tag slow --manual " .. manual)))
    local md = check.read(manual)
    has(md, "## Bars\n\nAbout bars.\n\n### quick | one\n")
    has(md, "| quantity | reference | barwright | difference | allowed | source |")
    has(md, "| f, Hz | 440 | 440.4 | +0.0909 % | 0.1 % | a fork |")
    has(md, "| max |  | 5 |  | at most 6 | counted |")
    has(md, "| pressures, largest difference over the largest value |  | 0.01 |  | 2 % |  |")
    has(md, "| pressures, largest difference, Pa |  | 0.5 |  | 0.5 Pa |  |")
    has(md, "| x\\|y |")
    assert.falsy(md:find "slow one")
    assert.equal(0, (run.again(("--skip-tag slow --manual %s --with %s/first/result.json"):format(manual,
      run.folder))))
    md = check.read(manual)
    has(md, "### slow one\n")
    has(md, "5 **outside**")
    assert.equal(2, (run.again(("--manual %s --with %s/a.lua"):format(manual, run.folder))))
  end)

  it("is one object with --json", function()
    local folder = check.folder()
    check.write(folder .. "/a.lua", HEAD .. 'scenario("a", function() print "x" expect(1):above(0) end)')
    local status, out = check.run(("test %s --json"):format(folder))
    assert.equal(0, status)
    local object = assert(json.decode(out))
    assert.same({1, 0, 0}, {object.passed, object.failed, object.skipped})
    assert.equal("passed", object.scenarios[1].status)
  end)
end)

describe("jobs", function()
  it("fail alone where they crash, hang, fill memory or leave things behind", function()
    local run = tested({["a.lua"] = HEAD .. [[
scenario("before", function() left = 1; package.loaded.left = 1; expect(1):above(0) end)
scenario("crash", function()
  expect(1, "one"):above(0)
  os.execute "kill -SEGV $PPID"
  for _ = 1, 1e9 do end
end)
scenario("hang", {seconds = 1}, function() while true do end end)
scenario("exit", function() os.exit(0) end)
scenario("memory", {memory = 1e9}, function()
  local t = {}
  for i = 1, 1e9 do t[i] = ("x"):rep(1e6) .. i end
end)
scenario("after", function()
  expect(left):equals(nil)
  expect(package.loaded.left):equals(nil)
  print "seen"
end)]]}, "--parallel 2")
    assert.equal("passed crashed time crashed memory passed", statuses(run), run.out)
    local crash = run.result.scenarios[2]
    assert.equal(1, #crash.entries)
    has(crash.message, "after 1 expectation)")
    assert.equal("seen\n", run.result.scenarios[6].output)
  end)

  it("say what is wrong with a note or a table", function()
    local run = tested({["a.lua"] = HEAD .. [[scenario("s", function(t)
      local _, note = pcall(t.note, t, "%d pieces", "x")
      expect(note:find("a.lua:%d+: note: the values do not fit the text") ~= nil):is_true()
      local _, table = pcall(t.table, t, {heads = {"a"}, rows = {{1}, 2}})
      expect(table:find("a.lua:%d+: table: row 2: a list of cells expected, got") ~= nil):is_true()
    end)]]})
    assert.equal(0, run.status, run.out)
  end)

  it("compare modes of the Laplacian, and refuse lists that contain themselves", function()
    local run = tested({["a.lua"] = HEAD .. [[scenario("s", function(t)
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {3, 1, 1}}
      local part = bw.model {mesh = mesh, material = bw.material.pla}
      local modes = t:require(part:modes {count = 1, laplacian = true})
      expect(modes):same_modes(modes)
      local list = {1}
      list[2] = list
      local _, why = pcall(function() expect(1):near(list, {relative = 1}) end)
      expect(why:find("near: a number, an array or a list of numbers") ~= nil):is_true()
    end)
    scenario("differ", function()
      local one, other = {}, {}
      one.x, other.x = one, other
      expect(one):equals(other)
    end)]]})
    assert.equal(1, run.status, run.out)
    assert.truthy(run.out:find("ok 1 - ", 1, true) and run.out:find("not ok 2 - ", 1, true), run.out)
    assert.truthy(run.out:find("x.x.x", 1, true), run.out)
  end)

  it("are reported in order whatever ends first", function()
    local source = {HEAD}
    for i = 1, 6 do
      source[#source + 1] = ([[scenario("s%d", function() os.execute "sleep %g" expect(%d):above(0) end)]])
        :format(i, 0.3 - 0.05 * i, i)
    end
    local run = tested({["a.lua"] = table.concat(source, "\n")}, "--parallel 4")
    assert.equal(0, run.status, run.out)
    local order = {}
    for n in run.out:gmatch "ok %d+ %- [^\n]*: s(%d)" do order[#order + 1] = n end
    assert.equal("123456", table.concat(order))
  end)
end)

describe("the project's own scenarios", function()
  it("and those of the page can be read", function()
    local status, _, err = check.run(("test %s/scenarios/verification --only 'there is none'"):format(check.root))
    assert.equal(2, status)
    assert.truthy(tonumber(err:match "none of (%d+) scenarios") > 60, err)
    local folder = check.folder()
    local page = check.read(check.root .. "/docs/howto_scenarios.md")
    check.write(folder .. "/bracket.lua", page:match "```lua\n(.-)```")
    local out
    status, out = check.run("test " .. folder)
    assert.equal(0, status, out)
  end)
end)
