-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the tutorials show runs as it stands, with fewer elements; with BARWRIGHT_FULL=1 as printed, at full size.
-- Lua blocks of a page are one script; those that begin with the name of a file are that file.
local check = require "check"
local bw = require "barwright"

local full = os.getenv "BARWRIGHT_FULL" == "1"
local small = 3000
-- What commands get beside, on a mesh in place of the surface. Strengthening takes half a minute: at full size
-- only.
local small_options = {check = "", worst = "--modes 2 --regions 1", statics = "", modes = ""}
local function runs(name) return full and name == "strengthen" or small_options[name] end

local program = "'" .. check.program .. "'"

-- Runs words of a shell in a folder. The exit status, what they print, and what they write to standard error.
local function run_in(folder, words)
  local _, _, code = os.execute(("cd '%s' && BARWRIGHT_QUIET=1 %s >printed 2>complaint"):format(folder, words))
  return code, check.read(folder .. "/printed"), check.read(folder .. "/complaint")
end

local function describe_page(page, min_blocks, prepare)
  describe("docs/" .. page, function()
    local text = check.read(check.root .. "/docs/" .. page)
    local folder = check.folder()

    local function adapted(script)
      return full and script or (script:gsub("elements = %d+", "elements = " .. small)
        :gsub("evaluations = %d+", "evaluations = 3"):gsub("error = 0%.05", "error = 0.3"))
    end

    setup(function()
      os.execute(("mkdir -p '%s/out/demo'"):format(folder))
      if prepare then prepare(folder) end
    end)

    -- Words of a command line; where they are not run as printed, small and on a mesh.
    local function command(line)
      line = line:gsub("%s+#.*", "")
      if full then return line end
      return line:gsub("out/demo/foal%.stl", "part.vtu"):gsub("part%.stl", "part.vtu") .. " "
        .. small_options[line:match "^%l+"]
        .. (line:find("bracket.stl", 1, true) and " --elements " .. small or "")
    end

    it("has commands that run", function()
      local count = 0
      for block in text:gmatch "```sh\n(.-)```" do
        for line in block:gmatch "build/barwright (%l+ [^\n]*)" do
          if runs(line:match "^%l+") then
            local code, out, complaint = run_in(folder, program .. " " .. command(line))
            assert.message(line .. "\n" .. out .. complaint).is_true(code <= 1) -- 1: it breaks, or is unsure
            assert.message(line).equal("", complaint)
            count = count + 1
          end
        end
      end
      for line in text:gmatch "build/barwright ([se]%l+/[^\n`]*)" do
        if not full then line = line:gsub("%-%-elements %d+", "--elements " .. small) end
        local code, out, complaint = run_in(folder, ("%s '%s'/%s"):format(program, check.root, line))
        assert.message(line .. "\n" .. out .. complaint).are.equal(0, code)
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
      assert.is_true(#parts >= min_blocks)
      check.write(folder .. "/tutorial.lua", adapted(table.concat(parts, "\n")))
      local code, out, complaint = run_in(folder, program .. " tutorial.lua")
      assert.message(out .. complaint).are.equal(0, code)
    end)
  end)
end

describe("docs/tutorial.md", function()
  it("shows what the command and the demonstration print", function()
    local text, folder = check.read(check.root .. "/docs/tutorial.md"), check.folder()
    local part = folder .. "/part.vtu"
    assert(assert(bw.mesh.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.008}, cells = {6, 2, 1}}):write(part))
    local status, out = check.run(("worst %s %s --unit m --material zp150"):format(part, small_options.worst))
    assert.is_true(status <= 1, out)
    -- Sentences without their numbers, names and what only some answers have.
    local flat = text:gsub("\n *", " ")
    for sentence in out:match("(.-)\nAdvice"):gsub("%b()", "("):gmatch "%a[%a ]+%a" do
      assert.truthy(#sentence < 18 or sentence == "too close to decide" or flat:find(sentence, 1, true), sentence)
    end
    -- The demonstration: its set-up and the program only write down that they were called.
    assert(os.execute(("mkdir -p %s/build %s/scripts && cp %s/scripts/demo %s/scripts/"):format(folder, folder,
      check.root, folder)))
    check.write(folder .. "/scripts/setup", "#!/bin/bash\n")
    check.write(folder .. "/build/barwright",
      '#!/bin/bash\necho "$0 $*" >>called\n[ "$1" != worst ] || exit $CODE\n')
    assert(os.execute(("chmod +x %s/scripts/setup %s/build/barwright"):format(folder, folder)))
    local function demo(code)
      local _, _, ended = os.execute(("cd %s && CODE=%d scripts/demo >said 2>&1"):format(folder, code))
      return ended, check.read(folder .. "/said")
    end
    local said
    status, said = demo(0)
    assert.equal(0, status)
    local command = text:match "build/barwright worst out/demo[^\n]*"
    assert.truthy(said:find(command, 1, true), said)
    assert.truthy(check.read(folder .. "/called"):find(command, 1, true))
    for _, name in ipairs {"report.html", "picture.png"} do
      assert.truthy(said:match("Open:.*out/demo/" .. name), said)
    end
    status, said = demo(1) -- it breaks, or is unsure: an answer as well
    assert.equal(0, status)
    assert.truthy(said:find("exit status 1", 1, true), said)
    assert.equal(3, (demo(3)))
  end)
end)

describe_page("tutorial.md", 3, function(folder)
  local min, max = {-0.01, -0.01, 0}, {0.052, 0.01, 0.022}
  assert(assert(bw.mesh.box {min = min, max = max, cells = {12, 4, 4}}):write(folder .. "/part.vtu"))
  local part = assert(bw.mesh.box {min = min, max = max, cells = {31, 10, 11}})
  assert(part:surface():write(folder .. "/part.stl", {unit = "mm"}))
  local model = ("'%s/scripts/demo_model/foal.lua' %s/out/demo/foal.stl"):format(check.root, folder)
  assert.equal(0, (check.run(model)))
end)

describe_page("howto_known_loads.md", 3, function(folder)
  local page = check.read(check.root .. "/docs/howto_known_loads.md")
  check.write(folder .. "/bracket.lua", page:match "```lua\n(%-%- bracket%.lua\n.-)```")
  local bracket = dofile(folder .. "/bracket.lua")
  assert(bracket(0.06, 0.05, 0.03, 0.006, 0.004):write(folder .. "/bracket.stl"))
end)

describe_page("tutorial_edit.md", 10)

describe_page("tutorial_solids.md", 9)

describe_page("tutorial_responsive.md", 8, function(folder)
  local page = check.read(check.root .. "/docs/tutorial_responsive.md")
  check.write(folder .. "/whale.svg", page:match "```svg\n(.-)```")
end)

describe("the scripts of", function()
  for name, count in pairs {["live.md"] = 2, ["loads_and_supports.md"] = 3} do
    it("docs/" .. name .. " run by themselves", function()
      local folder, found = check.folder(), 0
      for block in check.read(check.root .. "/docs/" .. name):gmatch "```lua\n(.-)```" do
        found = found + 1
        check.write(folder .. "/script.lua", block)
        local code, out, complaint = run_in(folder, program .. " script.lua")
        assert.message(block .. "\n" .. out .. complaint).equal(0, code)
      end
      assert.equal(count, found)
    end)
  end
end)

describe("README.md", function()
  local text = check.read(check.root .. "/README.md")
  local folder = check.folder()

  setup(function()
    assert(assert(bw.mesh.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.008}, cells = {30, 10, 4}}):surface()
      :write(folder .. "/part.stl", {unit = "mm"}))
    assert.equal(0, (check.run(check.root .. "/examples/09_skeleton_from_stl.lua " .. folder)))
  end)

  it("has commands that run", function()
    local count = 0
    for line in text:gmatch "\nbuild/barwright (%l+ part%.stl[^\n#]*)" do
      local name = line:match "^%l+"
      if runs(name) then
        line = line:gsub("part%.%l+", folder .. "/%0"):gsub("stronger%.stl", folder .. "/%0")
        local code, out, complaint = check.run(line .. " " .. (full and "" or small_options[name] or ""))
        assert.message(line .. "\n" .. out .. complaint).is_true(code <= 1) -- 1: it breaks, or is unsure
        count = count + 1
      end
    end
    assert.is_true(count >= 3)
  end)

  -- Each block is a script that runs as printed; only meshes, fits and populations are smaller.
  it("has scripts of which each runs by itself", function()
    local count = 0
    for block in text:gmatch "```lua\n(.-)```" do
      count = count + 1
      if not full then
        block = block:gsub("elements = %d+", "elements = " .. small):gsub("directions = %d+", "directions = 4")
          :gsub("generations = %d+", "generations = 2"):gsub("(material = bw%.material%.pla)}%)%)\nprint",
            "%1, modes = 2, regions = 1}))\nprint")
      end
      check.write(folder .. "/script.lua", block)
      local code, out, complaint = run_in(folder, program .. " script.lua")
      assert.message(block .. "\n" .. out .. complaint).equal(0, code)
    end
    assert.equal(5, count)
  end)
end)
