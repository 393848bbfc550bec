-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What happens to everybody once: the wrong file, a folder in place of a file, a disk that is full, a pipe that
-- is closed. Each ends with one sentence and the right exit status, and before the work rather than after it.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"
local mesh_progress = require "barwright.mesh_progress"

local folder = check.folder()
local ball = folder .. "/ball.stl"
assert(assert(bw.surface.sphere {radius = 0.02, subdivisions = 3}):write(ball))
assert(os.execute(("mkdir '%s/adir' '%s/d.html' && : >'%s/empty.stl'"):format(folder, folder, folder)))

-- Words after the program, with @ for the folder: the exit status and one line on standard error.
local function says(status, text, words, before)
  local command = ("cd '%s' && %s BARWRIGHT_QUIET=1 timeout 600 '%s' %s 2>err"):format(folder, before or "",
    check.program, words:gsub("@", folder))
  if not words:find ">" then command = command .. " >out" end
  local _, _, found = os.execute("{ " .. command .. "; } </dev/null")
  local said = check.read(folder .. "/err")
  assert.equal(status, found, words .. ": " .. said)
  assert.truthy(said:find(text, 1, true), words .. ": " .. said)
  assert.equal(1, select(2, said:gsub("\n", "\n")), said)
end

describe("a newcomer gets", function()
  it("how far work over several meshes is, as one progress that never goes back", function()
    local seen = {}
    local before = bw.progress(function(stage, fraction) seen[#seen + 1] = {stage, fraction} end)
    do
      local progress <close> = mesh_progress.open "work"
      progress:mesh(100, {200, 300}, true)
      core.report_progress("filling", 0.9)
      local start = bw.seconds()
      while bw.seconds() < start + 0.02 do end
      progress:mesh(200, {300}, true)
      core.report_progress("filling", 0.1)
      core.report_progress("factorisation", 0)
      progress:mesh(300, {}, false)
      core.report_progress("filling", 0)
    end
    core.report_progress("other", 0.5)
    local stages, last = {}, 0
    for i, one in ipairs(seen) do
      stages[i] = one[1]
      assert.is_true(i == #seen or one[2] >= last and one[2] < 1)
      last = one[2]
    end
    assert.same({"work; mesh 1 of at least 3, filling", "work; mesh 2 of at least 3, filling",
      "work; mesh 2 of at least 3, factorisation", "work; mesh 3 of 3, filling", "other"}, stages)
    assert.is_true(seen[1][2] == 0 and seen[2][2] > 0)
    -- The breaking force is such work.
    seen = {}
    local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.008}, cells = {6, 2, 1}})
    assert(bw.breaking_force(mesh, {material = bw.material.pla, modes = 2, regions = 1}))
    bw.progress(before)
    assert.is_true(#seen > 3)
    for _, one in ipairs(seen) do assert.truthy(one[1]:find("breaking force; mesh 1 of 1, ", 1, true), one[1]) end
  end)

  it("what a file is that is no model, no script and no folder", function()
    for _, command in ipairs {"check @", "worst @", "modes @", "convert @ x.obj",
      "strengthen @ --force 5 --out x.stl", "statics @ --fix min:z --gravity 0,0,-1"} do
      says(3, "the file is empty (0 bytes)", (command:gsub("@", "empty.stl")))
      says(3, "it is a directory", (command:gsub("@", "adir")))
      says(3, "No such file or directory", (command:gsub("@", "nothing.stl")))
    end
    for _, command in ipairs {"study run", "live --no-open", "rerun"} do
      says(3, "No such file or directory", command .. " nothing.lua")
    end
    for _, words in ipairs {"live ball.stl", "study run ball.stl", "test ball.stl", "ball.stl"} do
      says(2, "ball.stl is no script: `barwright check ball.stl` describes it", words)
    end
  end)

  it("before the work that its result cannot be written, and by the name that was given", function()
    says(3, "nodir/r.html: cannot write: there is no folder nodir", "worst ball.stl --report nodir/r.html")
    says(3, "nodir/x.obj: cannot write: there is no folder nodir", "convert ball.stl nodir/x.obj")
    says(3, "empty.stl/r.html: cannot write: no file can be made in the folder empty.stl: Not a directory",
      "worst ball.stl --report empty.stl/r.html")
    says(3, "d.html: cannot be written: it is a folder", "worst ball.stl --report d.html")
    says(2, "option --vtu: a file that ends in .vtu, ", "worst ball.stl --vtu result.zip")
    says(2, "option --vtu: a file that ends in .vtu, ", "modes ball.stl --vtu /dev/full")
    says(2, "option --picture: a file that ends in .png expected, got 'x.jpg'", "modes ball.stl --picture x.jpg")
    says(2, "option --report: a file that ends in .html", "worst ball.stl --report x.pdf")
  end)

  it("that what it printed is lost", function()
    for _, words in ipairs {"help", "materials", "materials --json", "check ball.stl", "manual", "--version",
      "-e 'print(1)'"} do
      says(3, "standard output: ", words .. " >/dev/full")
    end
    says(3, "standard output: ", "help >&-")
  end)

  it("that the environment is wrong", function()
    for _, value in ipairs {"abc", "-3", "0", "2x"} do
      says(2, "BARWRIGHT_THREADS: a number of threads expected, got '" .. value .. "'", "check ball.stl",
        "BARWRIGHT_THREADS=" .. value)
    end
  end)

  it("nothing wrong where names have spaces and umlauts, the locale has commas and there is no home", function()
    local odd = folder .. "/ein Ordner ü"
    assert(os.execute(("mkdir '%s' && cp '%s' '%s/Kugel ß 1.stl'"):format(odd, ball, odd)))
    local _, _, status = os.execute(("cd '%s' && env -u HOME LC_ALL=de_DE.UTF-8 BARWRIGHT_QUIET=1 '%s' worst "
      .. "'Kugel ß 1.stl' --elements 500 --modes 2 --regions 1 --out 'aus gabe' --vtu 'f ü.vtu' >/dev/null 2>err; "
      .. "s=$?; test $s = 0 -o $s = 1 && test ! -s err"):format(odd, check.program))
    assert.equal(0, status)
    assert.is_table(bw.json.decode(check.read(odd .. "/aus gabe/result.json")))
    check.write(odd .. "/rückwärts.lua", "assert(#arg == 0); return require'barwright'.no_such_thing")
    says(3, "rückwärts.lua:1: barwright has no 'no_such_thing'", "live --no-open 'ein Ordner ü/rückwärts.lua'")
    says(2, "was the run started in another folder?", "rerun 'ein Ordner ü/aus gabe'")
  end)
end)
