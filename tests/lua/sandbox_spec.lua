-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright --sandbox, --memory, --seconds: what works in the sandbox; scripts that fill memory or run for
-- ever. What does not work is in sandbox_escape_spec.lua.
local bw = require "barwright"
local check = require "check"

-- A folder "in" that a script may use, with things around it that it may not.
local function place()
  local folder = check.folder()
  os.execute(("mkdir '%s/in' '%s/in/modules'"):format(folder, folder))
  assert(bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.01}}:write(folder .. "/in/box.stl"))
  os.execute(("cp '%s/in/box.stl' '%s/secret.stl'"):format(folder, folder))
  os.execute(("ln -s '%s/secret.stl' '%s/in/link.stl'"):format(folder, folder))
  os.execute(("ln -s /nowhere/at/all '%s/in/dangling'"):format(folder))
  check.write(folder .. "/in/modules/part.lua", "return {name = ..., where = debug.getinfo(1, 'S').short_src}")
  return folder
end

-- Runs a script in the sandbox of FOLDER/in; OUT is FOLDER, IN is FOLDER/in in it.
local function run(folder, text, program)
  check.write(folder .. "/in/script.lua", ("local OUT, IN = %q, %q\n%s"):format(folder, folder .. "/in", text))
  return check.run(("--sandbox '%s/in' '%s/in/script.lua'"):format(folder, folder), nil, program)
end

local preamble = [[
  local bw, core = require "barwright", require "barwright.core"
  local box = assert(bw.surface.read(IN .. "/box.stl"))
  local mesh = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.02}, cells = {4, 1, 1}}
  local worst = assert(bw.worst_case(bw.model {mesh = mesh, material = bw.material.pla},
    {force = 1, modes = 1, regions = 1}))
  local database = assert(core.database(IN .. "/own.db"))
]]

describe("a script in the sandbox", function()
  for wall, program in pairs {["both walls"] = check.program, ["the first wall alone"] = check.first_wall} do
    it("can do its work inside, behind " .. wall .. " (S9)", function()
      local folder = place()
      local status, out, err = run(folder, preamble .. [[
        local file = assert(io.open(IN .. "/notes.txt", "w"))
        file:write "a note":close()
        assert(os.rename(IN .. "/notes.txt", IN .. "/modules/notes.txt"))
        for line in io.lines(IN .. "/modules/notes.txt") do assert(line == "a note") end
        assert(os.remove(IN .. "/modules/notes.txt"))
        assert(os.remove(IN .. "/link.stl")) -- the link is ours, what it leads to is not
        package.path = IN .. "/modules/?.lua;" .. package.path
        assert(require("part").name == "part")
        assert(dofile(IN .. "/modules/part.lua").where:find "part.lua")
        assert(loadfile(IN .. "/modules/part.lua", "bt", {debug = debug}))
        assert(load("return x", "chunk", "bt", {x = 5})() == 5)
        local name = os.tmpname()
        assert(name:sub(1, #IN) == IN and os.remove(name))
        assert(debug.traceback "x" and debug.getinfo(1, "l").currentline > 1)
        assert(debug.getinfo(print, "S").what == "C")
        local grown = assert(box:wrap()) -- in a child of the engine's
        local filled = assert(bw.mesh.fill(grown, {elements = 300}))
        assert(filled:write(IN .. "/filled.vtu") and bw.mesh.read(IN .. "/filled.vtu"))
        assert(worst:report(IN .. "/report.html") and worst:picture(IN .. "/picture.png"))
        local results = assert(bw.results.open(IN .. "/new/results", {inputs = {IN .. "/box.stl"}}))
        assert(results:write {x = 1})
        assert(database:execute "CREATE TABLE a (b)" and database:change("INSERT INTO a VALUES (?)", 3) == 1)
        assert(os.getenv "BARWRIGHT_QUIET" == "1")
        local sandbox = core.sandbox()
        assert(sandbox.folder == IN or sandbox.folder:find "in$")
        print(sandbox.landlock, sandbox.calls)
        -- As without a sandbox: modes, numbers as names, modules with a first line for the shell.
        assert(io.open(IN .. "/text", "w+b"))
          :write("#!/bin/sh\nreturn {second = debug.getinfo(1, 'l').currentline}"):close()
        assert(dofile(IN .. "/text").second == 2 and loadfile(IN .. "/text")().second == 2)
        assert(not pcall(io.open, IN .. "/text", "q") and not io.open(IN .. "/none"))
        assert(select("#", io.lines(IN .. "/text")) == 4)
        local characters = {}
        for two, one in io.lines(IN .. "/text", 2, 1) do characters[#characters + 1] = two .. (one or "") end
        assert(characters[1] == "#!/" and characters[2] == "bin")
        local output = io.output()
        io.output(IN .. "/printed"):write "word"
        io.close()
        io.output(output)
        assert(io.input(IN .. "/printed") == io.input() and io.read "a" == "word")
        io.input():close()
        local file <close> = assert(io.open(IN .. "/printed", "a"))
        assert(io.type(file) == "file" and tostring(file):find "^file %(0x")
        assert(file:seek "end" == 4 and file:setvbuf "full")
        assert(os.rename(IN .. "/modules", IN .. "/renamed") and os.remove(IN .. "/renamed/part.lua"))
        assert(os.remove(IN .. "/renamed") and not os.remove(IN .. "/renamed"))
      ]], program)
      assert.equal(program == check.program and "" or
        "barwright: this kernel has no Landlock: the sandbox stands on barwright's own checks\n", err)
      assert.equal(0, status)
      assert.truthy(out:match "^%d+\t%a+\n$", out)
      for _, name in ipairs {"filled.vtu", "report.html", "picture.png", "new/results/result.json", "own.db"} do
        assert.truthy(#check.read(folder .. "/in/" .. name) > 0, name)
      end
    end)
  end

  it("may lie elsewhere itself, and be statements (S1)", function()
    local folder = place()
    check.write(folder .. "/outside.lua", "print(... or 'none') print(io.open(arg[0]) ~= nil)")
    local status, out = check.run(("--sandbox '%s/in' '%s/outside.lua' word"):format(folder, folder))
    assert.equal(0, status)
    assert.equal("word\ntrue\n", out)
    check.write(folder .. "/lines", "io.open '/etc/passwd'\n")
    status, out = check.run(("--sandbox '%s/in'"):format(folder), folder .. "/lines")
    assert.equal(0, status)
    assert.truthy(out:find "^nil\t/etc/passwd: refused in the sandbox")
    status, out = check.run(("--sandbox='%s/in' -e 'print(io.open \"/etc/passwd\")'"):format(folder))
    assert.equal(0, status)
    assert.truthy(out:find "^nil\t/etc/passwd: refused in the sandbox")
  end)

  it("is not entered without a folder", function()
    local status, _, err = check.run "--sandbox /no/such/folder -e 'print(1)'"
    assert.equal(2, status)
    assert.truthy(err:find("a folder expected, got '/no/such/folder'", 1, true), err)
    status, _, err = check.run "--sandbox"
    assert.equal(2, status)
    assert.truthy(err:find "a folder expected")
  end)

  it("is where commands work too, unless they start processes (S4)", function()
    local folder = place()
    local status, out, _ = check.run(("--sandbox '%s/in' check '%s/in/box.stl'"):format(folder, folder))
    assert.equal(0, status)
    assert.truthy(out:find "Sound")
    local err
    status, out, err = check.run(("--sandbox '%s/in' check '%s/secret.stl'"):format(folder, folder))
    assert.equal(3, status)
    assert.equal("", out)
    assert.truthy(err:find("refused in the sandbox", 1, true), err)
    status, _, err = check.run(("--sandbox '%s/in' live '%s/in/box.stl'"):format(folder, folder))
    assert.equal(2, status)
    assert.truthy(err:find("starts other processes", 1, true), err)
  end)
end)

describe("the promises", function()
  it("of docs/sandbox.md have each a test of their number", function()
    local tests = {}
    for _, path in ipairs {"lua/sandbox_spec.lua", "lua/sandbox_escape_spec.lua", "lua/escapes.lua",
      "lua/test_kernel.c", "engine/base/test_confine.c", "engine/study/test_connection.c"} do
      for list in check.read(check.root .. "/tests/" .. path):gmatch "%(([SL]%d[SL%d, ]*)%)" do
        for number in list:gmatch "[SL]%d+" do tests[number] = true end
      end
    end
    local count = 0
    for number in check.read(check.root .. "/docs/sandbox.md"):gmatch "\n| ([SL]%d+) |" do
      count = count + 1
      assert.is_true(tests[number], number)
      tests[number] = nil
    end
    assert.truthy(count > 10)
    assert.is_nil(next(tests)) -- nor does a test have a number that is none
  end)
end)

describe("scripts", function()
  it("are loaded as text only (S3)", function()
    local folder = check.folder()
    check.write(folder .. "/compiled", string.dump(load "print 'ran'"))
    local status, out, err = check.run(folder .. "/compiled")
    assert.equal(1, status)
    assert.equal("", out)
    assert.truthy(err:find("loaded as text only", 1, true), err)
    status, out, err = check.run("- ", folder .. "/compiled")
    assert.equal(1, status)
    assert.equal("", out)
    assert.truthy(err:find("loaded as text only", 1, true), err)
    -- At the prompt, too.
    check.write(folder .. "/lines", "\27Lua\n1 + 1\n")
    status, out, err = check.run("", folder .. "/lines")
    assert.equal(0, status)
    assert.equal("2\n", out)
    assert.truthy(err:find("attempt to load a binary chunk", 1, true), err)
  end)
end)

describe("a limit on time", function()
  for what, text in pairs {
    ["a loop"] = "while true do end",
    ["a loop in pcall"] = "while true do pcall(function() while true do end end) end",
    ["a loop in a coroutine"] = "coroutine.wrap(function() while true do end end)()",
    ["a pattern"] = 'string.find(("a"):rep(40), (".-"):rep(20) .. "b")',
    ["an endless sort"] = "table.sort({3, 2, 1, 5, 4}, function() while true do end end)",
    ["a finaliser"] = "setmetatable({}, {__gc = function() while true do end end}) collectgarbage()",
    ["the engine"] = "local m = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {20, 20, 20}} "
      .. "bw.model {mesh = m, material = bw.material.pla}:modes {count = 200}",
  } do
    it("ends " .. what .. " (L3)", function()
      local start = bw.seconds()
      local status, _, err = check.run("--seconds 0.7 -e " .. "'" .. text:gsub("'", "'\\''") .. "'")
      assert.equal(124, status)
      assert.truthy(err:find("stopped after the 0.7 s that --seconds allows", 1, true), err)
      assert.truthy(bw.seconds() - start < 20)
    end)
  end

  it("leaves alone what is done in time, and passes on how it ended (L6)", function()
    assert.equal(7, (check.run "--seconds 600 -e 'os.exit(7)'"))
    assert.equal(0, (check.run "--seconds 1min -e 'print(1)'"))
    assert.equal(1, (check.run "--seconds 600 -e 'error(1)'"))
    local status, _, err = check.run [[--seconds 600 -e 'local core = require "barwright.core"
      os.execute("kill -SEGV " .. core.process())']]
    assert.equal(1, status)
    assert.truthy(err:find("ended by signal 11 (Segmentation fault)", 1, true), err)
    status, _, err = check.run "--seconds soon -e 'print(1)'"
    assert.equal(2, status)
    assert.truthy(err:find("a time such as 60 or 5min expected, got 'soon'", 1, true), err)
  end)

  it("ends the jobs that it started as well (L3)", function()
    local folder = check.folder()
    check.write(folder .. "/script.lua", [[
      local core = require "barwright.core"
      local jobs = {}
      for i = 1, 2 do
        jobs[i] = assert(core.job(function()
          local file = assert(io.open(arg[1] .. "/job" .. i, "w"))
          file:write(core.process()):close()
          while true do end
        end, {name = "endless"}))
      end
      core.wait(jobs, 100)
    ]])
    for _, seconds in ipairs {2, 10, 60} do -- until both jobs have begun, on a busy machine
      assert.equal(124, (check.run(("--seconds %d '%s/script.lua' '%s'"):format(seconds, folder, folder))))
      local second = io.open(folder .. "/job2")
      if second and second:read "n" then break end
    end
    for i = 1, 2 do
      local process = check.read(folder .. "/job" .. i)
      local gone
      for _ = 1, 1200 do
        gone = not os.execute(("kill -0 %s 2>/dev/null"):format(process))
        if gone then break end
        os.execute "sleep 0.05"
      end
      assert.is_true(gone)
    end
  end)

  it("leaves signals to the script (L6)", function()
    for signal, expected in pairs {INT = 130, TERM = 143} do
      local folder = check.folder()
      check.write(folder .. "/script.lua", "io.open(arg[1] .. '/ready', 'w'):close() while true do end")
      local _, _, status = os.execute(([[cd '%s' && { '%s' --seconds 600 script.lua . >out 2>err & pid=$!; n=0
        while [ ! -e ready ] && [ $n -lt 2400 ]; do sleep 0.05; n=$((n+1)); done
        sleep 0.2; kill -%s $pid; wait $pid; } 2>/dev/null]]):format(folder,
        check.program:match "^/" and check.program or os.getenv "PWD" .. "/" .. check.program, signal))
      assert.equal(expected, status)
    end
  end)

  it("removes files that were being written (L4)", function()
    local folder = check.folder()
    check.write(folder .. "/script.lua", [[
      local bw = require "barwright"
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {30, 30, 30}}
      while true do mesh:write(arg[1] .. "/big.vtu") end
    ]])
    assert.equal(124, (check.run(("--seconds 2 '%s/script.lua' '%s'"):format(folder, folder))))
    for name in io.popen("ls " .. folder):lines() do assert.is_nil(name:find "partial", name) end
  end)
end)

describe("a limit on memory", function()
  it("is Lua's (L1)", function()
    for _, text in ipairs {"local t = {} for i = 1, 1e9 do t[i] = {i} end", 'return ("x"):rep(1e9)',
      'local s = "x" while true do s = s .. s end', "local function f(...) return 1 + f(1, ...) end f()"} do
      local status, _, err = check.run("--memory 50M -e '" .. text .. "'")
      assert.equal(1, status)
      assert.truthy(err:find("not enough memory: the script may use 50 MiB", 1, true)
        or err:find("stack overflow", 1, true), err)
    end
    -- A script may catch it, and has its memory back; the limit stays.
    local status, out = check.run([[--memory 50M -e 'local t = {} print(pcall(function() for i = 1, 1e9 do
      t[i] = {i} end end)) t = nil collectgarbage() print(#(("x"):rep(2e7)), pcall(string.rep, "x", 1e8))']])
    assert.equal(0, status)
    assert.equal("false\tnot enough memory\n20000000\tfalse\tnot enough memory\n", out)
  end)

  it("is the engine's (L2)", function()
    local status, out = check.run "--memory 200M -e 'print(pcall(bw.array.zeros, 1e8))'"
    assert.equal(0, status)
    assert.truthy(out:find "^false\t.*out of memory", out)
    status, out = check.run [[--memory 200M -e 'print(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1},
      cells = {100, 100, 100}})']]
    assert.equal(0, status)
    assert.truthy(out:find "^nil\tout of memory", out)
  end)

  it("is named as what it is (L1, L2)", function()
    local _, _, err = check.run "--memory 1000M -e 'return (\"x\"):rep(2e9)'"
    assert.truthy(err:find("the script may use 1000 MiB", 1, true), err)
    -- A child of the engine's that may use 6 GB elsewhere.
    local status, out
    status, out, err = check.run [[--memory 300M -e 'local s = bw.surface.box {min = {0, 0, 0}, max = {1, 1, 1}}
      local _, message, details = bw.mesh.fill(s, {elements = 2000000})
      print(details.status, details.bytes, message)']]
    assert.equal(0, status, err)
    local word, bytes = out:match "^(%a+)\t(%d+)"
    assert.equal("limit", word, out)
    assert.truthy(tonumber(bytes) <= 300 * 2 ^ 20, out)
    assert.is_nil(out:find(" GB", 1, true), out)
  end)

  it("is too little without anything hanging", function()
    local folder = place()
    for _, size in ipairs {"2M", "5M", "12M", "40M"} do
      local words = ("--memory %s --seconds 600 worst '%s/in/box.stl' --elements 500"):format(size, folder)
      local status, _, err = check.run(words)
      assert.truthy(status == 0 or status == 1 or status == 3, size .. ": " .. err)
      assert.is_nil(err:find("fault of barwright", 1, true), err)
    end
  end)

  it("is a size", function()
    for _, size in ipairs {"x", "5", "-1G", "1X", ""} do
      local status, _, err = check.run("--memory '" .. size .. "' -e 'print(1)'")
      assert.equal(2, status)
      assert.truthy(err:find("a size of at least 1M", 1, true), err)
    end
  end)
end)

describe("a limit on the size of files", function()
  it("is reported with file and figure, here and in jobs, and nothing half written stays (L5)", function()
    local folder = check.folder()
    check.write(folder .. "/script.lua", [[
      local bw, core = require "barwright", require "barwright.core"
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {20, 20, 20}}
      local function write(name)
        local _, message = mesh:write(arg[1] .. name)
        return message
      end
      print(write "/here.vtu")
      local job = assert(core.job(function() return write "/job.vtu" end, {}))
      core.wait({job}, 60)
      print(job:result())
      local file = io.open(arg[1] .. "/text", "w")
      print(file:write(("x"):rep(2e6)))
    ]])
    local _, _, status = os.execute(("ulimit -f 100; BARWRIGHT_QUIET=1 '%s' '%s/script.lua' '%s' >'%s/out' 2>&1")
      :format(check.program, folder, folder, folder))
    local out = check.read(folder .. "/out")
    assert.equal(0, status, out)
    for _, name in ipairs {"here", "job"} do
      local limit = out:match(("%s/%s%%.vtu: cannot write: the file may not grow beyond (%%d+) bytes"):format(
        folder:gsub("%p", "%%%0"), name))
      assert.truthy(limit == "51200" or limit == "102400", out) -- shells count in blocks of 512 or 1024
    end
    assert.truthy(out:find("nil\t[^\n]*File too large"), out)
    assert.equal("out\nscript.lua\ntext\n", io.popen(("ls -A '%s'"):format(folder)):read "a")
  end)
end)
