-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The cache of studies: what is read back equals what was made; made once by many; never half; old ones go.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local function study(folder, more)
  local opts = {name = "c", file = folder .. "/c.study", cache = {folder = folder .. "/cache"},
    variables = {{name = "x", kind = "integer", min = 1, max = 6}}, measures = {"y"}, design = {"grid"},
    run = function() return {y = 1} end}
  for key, value in pairs(more or {}) do opts[key] = value end
  return bw.study(opts)
end

local function files_of(folder)
  local list = {}
  for _, part in ipairs(core.list_folder(folder) or {}) do
    for _, entry in ipairs(core.list_folder(folder .. "/" .. part.name) or {}) do
      list[#list + 1] = {path = folder .. "/" .. part.name .. "/" .. entry.name, bytes = entry.bytes}
    end
  end
  return list
end

local function same_array(a, b)
  assert.equal(a.type, b.type)
  assert.same({a.row_count, a.column_count}, {b.row_count, b.column_count})
  assert.same(a:totable(), b:totable())
end

describe("the cache", function()
  it("refuses to wait for what it makes itself", function()
    local one = study(check.folder())
    local again
    again = function() return one:cached("same", again) end
    check.raises("asks for the entry that it computes", one.cached, one, "same", again)
    assert.equal(5, one:cached("same", function() return 5 end))
  end)

  it("gives back plain data as they were", function()
    local one = study(check.folder())
    local value = {1, 2.0, -0.0, "a\0b", true, false, {x = {y = {1 / 3, 2 ^ 53 + 1.0}}, [7] = "seven", [1.5] = {}},
      math.mininteger, math.huge, 5e-324, [20] = "far"}
    local made = 0
    local function make()
      made = made + 1
      return value
    end
    local first, second = one:cached("data", make), one:cached("data", make)
    assert.equal(1, made)
    assert.same(value, first)
    assert.same(value, second)
    assert.equal("float", math.type(second[2]))
    assert.equal(-math.huge, 1 / second[3])
    assert.is_false(one:cached("no", function() return false end))
    assert.is_false(one:cached("no", function() error "made twice" end))
    assert.equal(0, #one:cached("empty", function() return {} end))
  end)

  it("keeps nothing where the user has no folder", function()
    local folder = check.folder()
    check.write(folder .. "/script.lua", [[
      local study = bw.study {name = "c", file = arg[1] .. "/c.study",
        variables = {{name = "x", min = 0, max = 1}}, measures = {{name = "y"}},
        design = {"random", count = 1}, run = print}
      local made = 0
      for _ = 1, 2 do study:cached("what", function() made = made + 1 return made end) end
      print(made)
    ]])
    local there = io.open "/tmp/.cache/barwright"
    local _, _, status = os.execute(("env -u HOME -u XDG_CACHE_HOME '%s' -e '' '%s/script.lua' '%s' >'%s/out'")
      :format(check.program, folder, folder, folder))
    assert.equal(0, status)
    assert.equal("2\n", check.read(folder .. "/out"))
    assert.equal(there ~= nil, io.open "/tmp/.cache/barwright" ~= nil)
  end)

  it("gives back meshes, surfaces, arrays and libraries bit for bit", function()
    local one = study(check.folder())
    local materials = {bw.hyperelastic {name = "soft", young = 1e5, poisson = 0.4, density = 1000},
      bw.hyperelastic {name = "hard", young = 1e7, poisson = 0.4, density = 1000}}
    local function make()
      local surface = assert(bw.surface.sphere {radius = 1 / 3, subdivisions = 1})
      return {mesh = check.beam({4, 1, 1}, 2), surface = surface,
        lists = {bw.array {1 / 3, 2, 3}, bw.array({{1, 2}, {3, 4}}, "i32"), bw.array.zeros(0, 3)},
        library = assert(bw.metamaterial.build(materials, {voids = false, directions = 4, magnitudes = 1,
          stretches = 8}))}
    end
    local made = assert(one:cached({"bodies", size = 1 / 3}, make))
    local read = assert(one:cached({size = 1 / 3, "bodies"}, function() error "made twice" end))
    same_array(made.mesh.nodes, read.mesh.nodes)
    same_array(made.mesh.elements, read.mesh.elements)
    assert.equal(2, read.mesh.order)
    same_array(made.surface.points, read.surface.points)
    same_array(made.surface.triangles, read.surface.triangles)
    for i = 1, 3 do same_array(made.lists[i], read.lists[i]) end
    local folder = check.folder()
    assert(made.library:write(folder .. "/a.bwm"))
    assert(read.library:write(folder .. "/b.bwm"))
    assert.equal(check.read(folder .. "/a.bwm"), check.read(folder .. "/b.bwm"))
    local alone = assert(one:cached("mesh", function() return made.mesh end))
    same_array(alone.nodes, one:cached("mesh", error).nodes)
    check.raises("expected of the function, got a function", one.cached, one, "f", function() return {print} end)
    check.raises("got a table that contains itself", one.cached, one, "t", function()
      local t = {}
      t[1] = t
      return t
    end)
    check.raises("tables of them expected, got a function", one.cached, one, {print}, function() return 1 end)
  end)

  it("knows the contents of files by which something was made", function()
    local folder = check.folder()
    local one = study(folder)
    local path = folder .. "/in.txt"
    local function size() return one:cached("size", function() return #check.read(path) end, {files = {path}}) end
    check.write(path, "abc")
    assert.equal(3, size())
    check.write(path, "abcd")
    assert.equal(4, size())
    os.remove(path)
    check.fails("io", "in.txt", size())
  end)

  it("has one make it while others wait, in many jobs at once", function()
    local folder = check.folder()
    local one = study(folder, {run = function(point, trial)
      local value = trial:cached("shared", function()
        local file = io.open(folder .. "/log", "a")
        file:write "made\n"
        file:close()
        os.execute "sleep 0.3"
        return {number = 42}
      end)
      return {y = value.number + 0 * point.x}
    end})
    local trials = assert(one:run {workers = 6})
    assert.same({42, 42, 42, 42, 42, 42}, trials:column "y")
    assert.equal("made\n", check.read(folder .. "/log"))
    local left = files_of(folder .. "/cache")
    assert.equal(1, #left)
    assert.equal(64, #left[1].path:match "[^/]+$")
  end)

  it("keeps nothing of who failed, was killed, or wrote half", function()
    local folder = check.folder()
    local one = study(folder)
    check.fails("geometry", "no", one:cached("bad", function() return nil, "no", {status = "geometry"} end))
    check.raises("oops", one.cached, one, "bad", function() error "oops" end)
    local job = core.job(function()
      one:cached("bad", function() os.execute "kill -9 $PPID" end)
      return ""
    end, {})
    core.wait({job})
    assert.equal("fine", one:cached("bad", function() return "fine" end))
    local entry = files_of(folder .. "/cache")
    assert.equal(1, #entry)
    local text = check.read(entry[1].path)
    for _, broken in ipairs {text:sub(1, -2), text:sub(1, 30), "", text:gsub("fine", "fill")} do
      check.write(entry[1].path, broken)
      assert.equal("again", one:cached("bad", function() return "again" end))
      assert.equal("again", one:cached("bad", function() return "no" end))
    end
  end)

  it("throws out what was used longest ago when it is full", function()
    local folder = check.folder()
    local one = study(folder, {cache = {folder = folder .. "/cache", bytes = 50000}})
    local made = {}
    local function get(name)
      return #one:cached(name, function()
        made[name] = (made[name] or 0) + 1
        return name:rep(10000)
      end)
    end
    for _, name in ipairs {"a", "b", "c", "d"} do
      assert.equal(10000, get(name))
      os.execute "sleep 0.02"
    end
    get "a" -- used again: now b is the oldest
    os.execute "sleep 0.02"
    get "e"
    local sum = 0
    for _, file in ipairs(files_of(folder .. "/cache")) do sum = sum + file.bytes end
    assert.is_true(sum <= 50000)
    get "a"
    get "c"
    assert.same({a = 1, b = 1, c = 1, d = 1, e = 1}, made)
    get "b"
    assert.equal(2, made.b)
    assert.equal(60000, #one:cached("large", function() return ("x"):rep(60000) end))
    get "a"
    assert.equal(1, made.a)
  end)

  it("does without where its folder cannot be used", function()
    local one = study(check.folder(), {cache = {folder = "/proc/none"}})
    local n = 0
    for i = 1, 2 do
      assert.equal(i, one:cached("x", function()
        n = n + 1
        return n
      end))
    end
  end)
end)
