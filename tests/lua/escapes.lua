-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Attempts to get out of the sandbox, in groups: each line is an expression that is nil or false, or raises,
-- where the sandbox holds. OUT is a folder with canaries; IN, in it, is the sandbox's folder. `start` runs
-- before the attempts of a group; `where` is the folder in which the program starts.
local files = [[
  io.open("/etc/passwd")
  io.open(OUT .. "/secret.stl", "rb")
  io.open(OUT .. "/secret.stl", "r+")
  io.open(OUT .. "/secret.stl", "r+b")
  io.open(OUT .. "/secret.stl", "a")
  io.open(OUT .. "/new", "w")
  io.open(OUT .. "/new", "wb")
  io.open(OUT .. "/new", "w+")
  io.open(OUT .. "/new", "a+b")
  io.open(OUT .. "/empty/new", "w")
  io.open(OUT)
  io.open(IN .. "/..")
  io.open "secret.stl"
  io.open "./in/../secret.stl"
  io.open("", "w")
  io.open("new", "w")
  io.open(777)
  io.open(777, "r+")
  io.open(12345, "w")
  io.open(12345.5, "a")
  io.open(-1, "w")
  io.open(1e300, "w")
  io.open(0 / 0, "w")
  io.open(named)
  io.open(named, "w")
  io.open(IN .. "/x", "rw")
  io.open(IN .. "/x", "wx")
  io.open(IN .. "/x", "w,ccs=UTF-8")
  io.open(IN .. "/../secret.stl")
  io.open(IN .. "//..//secret.stl")
  io.open(IN .. "/./.././secret.stl")
  io.open(IN .. "/modules/../../secret.stl")
  io.open(IN .. "/missing/../../secret.stl")
  io.open(IN .. "/link.stl")
  io.open(IN .. "/link.stl", "r+")
  io.open(IN .. "/link.stl", "w")
  io.open(IN .. "/second")
  io.open(IN .. "/loop")
  io.open(IN .. "/loop", "w")
  io.open(IN .. "/dangling", "w")
  io.open(IN .. "/dangling", "a+")
  io.open(IN .. "/dangling/")
  io.open(IN .. "/up/secret.stl")
  io.open(IN .. "/up/new", "w")
  io.open(IN .. "/up/empty/new", "w")
  io.open(IN .. "/up/in/../secret.stl")
  io.open(IN .. "/box.stl\0/../../secret.stl")
  io.open("\0" .. IN .. "/box.stl")
  io.open(OUT .. "/secret.stl\0")
  io.open(OUT .. "/new\0", "w")
  io.open(("x/"):rep(5000) .. "x", "w")
  io.open(IN .. ("/."):rep(3000) .. "/../secret.stl")
  io.open(IN .. "/" .. ("x"):rep(300), "w")
  io.open("/proc/self/environ")
  io.open("/proc/self/mem", "r+")
  io.open("/proc/self/exe", "rb")
  io.open("/proc/self/root" .. OUT .. "/secret.stl")
  io.open("/proc/self/cwd/secret.stl")
  io.open("/proc/self/fd/0")
  io.open("/proc/self/task/self/root/etc/passwd")
  io.open("/proc/1/environ")
  io.open("/proc/sys/kernel/core_pattern", "w")
  io.open("/dev/fd/0")
  io.open("/dev/stdin")
  io.open("/dev/mem")
  io.open("/dev/tty", "w")
  io.open("/dev/shm/barwright_new", "w")
  io.open(package.searchpath("barwright.json", package.path), "a")
  io.open(package.searchpath("barwright.json", package.path):gsub("json.lua$", "new.lua"), "w")
  io.lines "/etc/passwd"
  io.lines(OUT .. "/secret.stl")()
  io.lines(IN .. "/link.stl")()
  io.lines(777)()
  io.lines(named)()
  io.lines(OUT .. "/secret.stl", "a")()
  io.input "/etc/passwd"
  io.input(OUT .. "/secret.stl")
  io.input(777)
  io.input(named)
  io.output(OUT .. "/new")
  io.output(12345)
  io.output(12345.5)
  io.output(777)
  io.output(named)
  io.output(IN .. "/link.stl")
  io.output(IN .. "/dangling")
  io.tmpfile()
  io.open(IN .. "/box.stl", "r"):lines(OUT .. "/secret.stl")()
  os.rename(IN .. "/box.stl", OUT .. "/new")
  os.rename(IN .. "/box.stl", IN .. "/up/new")
  os.rename(IN .. "/box.stl", 12345)
  os.rename(OUT .. "/secret.stl", IN .. "/stolen")
  os.rename(IN .. "/up/secret.stl", IN .. "/stolen")
  os.rename(777, IN .. "/stolen")
  os.rename(IN, OUT .. "/moved")
  os.rename(IN .. "/modules", OUT .. "/empty")
  os.rename(OUT .. "/empty", IN .. "/modules/empty")
  os.rename(IN .. "/box.stl", IN .. "/modules/../../new")
  os.rename(IN .. "/box.stl\0", OUT .. "/new")
  os.remove(OUT .. "/secret.stl")
  os.remove(OUT .. "/empty")
  os.remove(IN .. "/up/secret.stl")
  os.remove(IN .. "/up/empty")
  os.remove(777)
  os.remove(named)
  os.remove(IN)
  os.remove(IN .. "/.")
  os.remove(IN .. "/modules/..")
  os.remove(IN .. "/up/in")
  os.getenv "HOME"
  os.getenv "PATH"
  os.getenv "LD_LIBRARY_PATH"
  os.getenv "BARWRIGHT"
  os.setlocale "C.UTF-8"
  os.setlocale("", "all")
  os.tmpname():sub(1, #IN) ~= IN
  (function() os.rename(IN .. "/link.stl", IN .. "/renamed") return io.open(IN .. "/renamed") end)()
  (function() os.rename(IN .. "/up", IN .. "/modules/up") return io.open(IN .. "/modules/up/secret.stl") end)()
  (function() os.rename(IN .. "/modules/up", IN .. "/deep") return io.open(IN .. "/deep/new", "w") end)()
  (function() local f = io.open(IN .. "/x", "w") f:close() return f:write "x" end)()
  (function() local f = io.open(IN .. "/x") return f:write "x" end)()
  (function() local f = io.open(IN .. "/x", "w") return f:read(1) end)()
]]

local chunks = [[
  dofile "/etc/passwd"
  dofile(OUT .. "/secret.lua")
  dofile(IN .. "/up/secret.lua")
  dofile(777)
  dofile(named)
  dofile(IN .. "/compiled")
  loadfile "/etc/passwd"
  loadfile(OUT .. "/secret.lua")
  loadfile(OUT .. "/secret.lua", "bt", {})
  loadfile(OUT .. "/secret.stl", "b")
  loadfile(IN .. "/compiled")
  loadfile(IN .. "/compiled", "b")
  loadfile(IN .. "/compiled", "bt", {})
  loadfile(IN .. "/marked")
  loadfile(IN .. "/hashed")
  loadfile(IN .. "/modules")
  load(dumped)
  load(dumped, "x", "b")
  load(dumped, "x", "bt")
  load(dumped, "x", "bt", {})
  load(dumped, "=x", nil, nil)
  load(dumped, dumped, dumped)
  load(pieces(dumped, 1))
  load(pieces(dumped, 1), "x", "b")
  load(pieces(dumped, 4), "x", "bt", {})
  load(pieces(dumped, #dumped), "x", "b", nil)
  load(string.dump(function() return 1 end, true), "x", "b")
  load "\27Lua"
  string.dump(io.open)
  string.dump(load)
  require "secret"
  require "up.secret"
  require "..secret"
  require "../secret"
  require "compiled"
  require "\0secret"
  require(OUT .. "/secret")
  package.searchpath("passwd", "/etc/?")
  package.searchpath("secret", OUT .. "/?.lua")
  package.searchpath("secret", IN .. "/../?.lua")
  package.searchpath("secret", IN .. "/up/?.lua")
  package.searchpath("up.secret", IN .. "/?.lua")
  package.searchpath("up.secret", IN .. "/?.lua", ".", "/")
  package.searchpath("777", "?")
  package.searchpath("etc.passwd", "/?", ".", "/")
  package.searchpath("link", IN .. "/?.stl")
  (function() package.path = OUT .. "/?.lua;/etc/?" return require "secret" end)()
  (function() package.path = OUT .. "/?.lua" return require "passwd" end)()
  (function() package.searchers[3] = package.searchers[2] return require "secret" end)()
  (function() package.path = 777 return package.searchpath("x", package.path) end)()
  package.loaded.debug.sethook(function() end, "l")
  package.loaded.io.open(OUT .. "/secret.stl")
  package.loaded["barwright.core"].sandbox().folder ~= IN
  _ENV.io.open(OUT .. "/secret.stl")
  setmetatable({}, {__index = io}).open(OUT .. "/secret.stl")
]]

local programs = [[
  io.popen "id"
  io.popen("id", "w")
  io.popen(12)
  os.execute "true"
  os.execute()
  require "socket.core"
  require "lfs"
  require "posix"
  require "barwright.mpi"
  package.loadlib("libc.so.6", "*")
  package.loadlib("libc.so.6", "system")
  package.loadlib(IN .. "/box.stl", "luaopen_x")
  package.loadlib()
  package.searchers[3]
  package.searchers[4]
  package.cpath ~= ""
  (function() package.cpath = "/usr/lib/x86_64-linux-gnu/?.so;" .. IN .. "/?.so" return require "z" end)()
  (function() package.preload.evil = package.loadlib return require("evil")("libc.so.6", "*") end)()
  package.loaded._G.io.popen "id"
  core.job(function() return "x" end, {})
  core.live_server {}
  pcall(os.execute, "touch new") and os.execute "touch new"
  coroutine.wrap(os.execute) "touch new"
  bw.live(bw.edit(box))
  bw.distributed.start()
  core.job(function() os.execute "touch new" end, {bytes = 1e9, seconds = 5, output = OUT .. "/new"})
  require("barwright.command").run("live", IN .. "/box.stl") == 0
  require("barwright.command").run("test", IN) == 0
  require("barwright.command").run("study", "run", IN .. "/x.lua") == 0
]]

local inside = [[
  debug.getregistry()
  debug.getupvalue(io.open, 1)
  debug.getupvalue(io.lines, 1)
  debug.getupvalue(load, 1)
  debug.getupvalue(require, 1)
  debug.setupvalue(io.open, 1, print)
  debug.upvalueid(io.open, 1)
  debug.upvaluejoin(io.open, 1, print, 1)
  debug.getlocal(1, 1)
  debug.getlocal(io.open, 1)
  debug.setlocal(1, 1, 1)
  debug.sethook()
  debug.sethook(function() end, "c")
  debug.sethook(coroutine.create(print), function() end, "l")
  debug.gethook()
  debug.getmetatable("")
  debug.getmetatable(io.stdout)
  debug.setmetatable("", nil)
  debug.setmetatable(1, {__index = io})
  debug.setmetatable(io.stdout, {})
  debug.getuservalue(io.stdout)
  debug.setuservalue(io.stdout, 1)
  debug.setcstacklimit(1000000)
  debug.debug()
  debug.getinfo(io.open, "f").func
  debug.getinfo(1, "f").func
  debug.getinfo(1, "rf").func
  (debug.getinfo(coroutine.create(print), 0, "f") or {}).func
  debug.getinfo(coroutine.running(), 1, "f").func
  debug.getinfo(1, "L").activelines
  debug.getinfo(1, "SlntufLr").func
  debug.getinfo(">f")
  debug.getinfo(io.open, ">f").func
  debug.getinfo(io.open, ("S"):rep(100) .. "f").func
  coroutine.wrap(debug.sethook)(function() end, "l")
  coroutine.wrap(io.open)(OUT .. "/secret.stl")
  coroutine.wrap(dofile)(OUT .. "/secret.lua")
  coroutine.wrap(function() return coroutine.yield(io.open(OUT .. "/secret.stl")) end)()
  getmetatable("").__index.getregistry
  getmetatable("").__gc
  getmetatable(io.stdout).__index.open
  getmetatable(io.stdout).__index.popen
  getmetatable(io.stdout).__gc({})
  getmetatable(io.stdout).__gc(io.open)
  getmetatable(io.stdout).__close("x")
  getmetatable(io.stdout).__index.lines("/etc/passwd")
  io.lines(setmetatable({}, getmetatable(io.stdout)))
  io.output(setmetatable({}, getmetatable(io.stdout)))
  io.close(setmetatable({}, getmetatable(io.stdout)))
  select(2, xpcall(error, io.open, OUT .. "/secret.stl"))
  table.unpack({pcall(io.open, OUT .. "/secret.stl")}, 2, 2)
  ("x"):gsub("x", io.open) ~= "x"
  (OUT .. "/secret.stl"):gsub("^.*$", function(path) return io.open(path) and "GOT" end):find "GOT"
  table.sort({OUT .. "/new", "x"}, function(a) return io.open(a, "w") ~= nil end)
  (function() getmetatable("").__tostring = function() return OUT .. "/secret.stl" end return io.open("x") end)()
  (function() getmetatable("").__name = OUT return io.open("secret.stl") end)()
  (function() string.format = function() return OUT .. "/secret.stl" end return io.open("x") end)()
  (function() getmetatable(io.stdout).__index = {lines = function() return OUT end} return io.lines(named) end)()
  (function() tostring = function() return OUT .. "/secret.stl" end return io.open("x") end)()
  (function() type = function() return "string" end return io.open(named) end)()
  (function() local t <close> = setmetatable({}, {__close = function() io.open(OUT .. "/new", "w") end}) end)()
  (function() setmetatable({}, {__gc = function() io.open(OUT .. "/new", "w") end}) collectgarbage() end)()
  (function() KEPT = setmetatable({}, {__gc = function() io.open(OUT .. "/new", "w") io.output(12345) end}) end)()
  (function() KEPT2 = setmetatable({}, {__gc = function() os.remove(OUT .. "/secret.stl") dofile(777) end}) end)()
  (function() KEPT3 = setmetatable({}, {__gc = function() os.execute "touch new" io.popen "touch new" end}) end)()
]]

local engine = [[
  bw.surface.read "/etc/passwd"
  bw.surface.read(OUT .. "/secret.stl")
  bw.surface.read(IN .. "/../secret.stl")
  bw.surface.read(IN .. "/link.stl")
  bw.surface.read(IN .. "/up/secret.stl")
  bw.surface.read(IN .. "/dangling")
  bw.surface.read "secret.stl"
  bw.surface.read(777)
  bw.surface.read(named)
  bw.surface.read(OUT .. "/secret.stl\0.stl")
  bw.mesh.read(OUT .. "/secret.stl")
  bw.mesh.read(IN .. "/include.inp")
  bw.mesh.read(IN .. "/input.inp")
  bw.outline.read(OUT .. "/secret.svg")
  bw.outline.read(IN .. "/image.svg")
  bw.metamaterial.read(OUT .. "/secret.stl")
  core.skeleton.read(OUT .. "/secret.stl")
  box:write(OUT .. "/new.stl")
  box:write(OUT .. "/secret.stl")
  box:write(OUT .. "/empty/new.stl")
  box:write(IN .. "/../new.vtu")
  box:write(IN .. "/link.stl")
  box:write(IN .. "/dangling.stl")
  box:write(IN .. "/up/new.stl")
  box:write "new.stl"
  box:write(IN .. "/new.stl\0/../../new.stl")
  box:write("file:" .. OUT .. "/new.stl")
  box:picture(OUT .. "/new.png")
  box:picture(IN .. "/up/new.png")
  mesh:write(OUT .. "/new.inp")
  mesh:write(OUT .. "/new.msh")
  mesh:write(IN .. "/up/new.vtu")
  worst:report(OUT .. "/new.html")
  worst:report(IN .. "/up/new.html")
  worst:picture(OUT .. "/new.png")
  bw.plot.lines({series = {{y = {1, 3, 2}}}}):write(OUT .. "/new.svg")
  bw.plot.lines({series = {{y = {1, 3, 2}}}}):write(IN .. "/up/new.png")
  bw.animation(OUT .. "/new.png", {IN .. "/one.png"})
  bw.animation(IN .. "/all.png", {OUT .. "/one.png"})
  bw.animation(IN .. "/all.png", {IN .. "/one.png", IN .. "/up/one.png"})
  core.wav_write(OUT .. "/new.wav", 44100, bw.array.zeros(10))
  bw.results.open(OUT .. "/new", {})
  bw.results.open(IN .. "/up/new", {})
  bw.results.open(IN .. "/results", {inputs = {OUT .. "/secret.stl"}})
  core.write_file(OUT .. "/new", "x")
  core.write_file(IN .. "/link.stl", "x")
  core.write_file(IN .. "/up/new", "x")
  core.write_file(12345, "x")
  core.write_file("12345", "x")
  core.make_folder(OUT .. "/new")
  core.make_folder(OUT .. "/new/deep")
  core.make_folder(OUT .. "/empty/deep")
  core.make_folder(OUT)
  core.make_folder(IN .. "/up/new")
  core.make_folder(IN .. "/dangling")
  core.make_folder(IN .. "/modules/../../new")
  core.list_folder(OUT)
  core.list_folder "/etc"
  core.list_folder "."
  core.list_folder(IN .. "/up")
  core.list_folder(IN .. "/..")
  core.touch(OUT .. "/secret.stl")
  core.touch(IN .. "/link.stl")
  core.lock(OUT .. "/new.lock")
  core.lock(OUT .. "/secret.stl")
  core.lock(IN .. "/link.stl")
  core.lock(IN .. "/dangling")
  core.lock(IN .. "/up/new.lock")
  core.sha256(OUT .. "/secret.stl")
  core.sha256(IN .. "/link.stl")
  core.sha256 "/proc/self/environ"
  core.may_use(OUT .. "/secret.stl", "read")
  core.may_use(IN .. "/link.stl", "write")
  bw.metamaterial.build(materials, {checkpoint = OUT .. "/new"})
  bw.metamaterial.build(materials, {checkpoint = IN .. "/link.stl"})
  bw.metamaterial.build(materials, {checkpoint = IN .. "/up/new"})
  study(OUT .. "/new.study"):run()
  study(IN .. "/up/new.study"):run()
  study(OUT .. "/secret.db"):trials()
  study(IN .. "/a.study", OUT .. "/new"):run()
]]

local database = [[
  core.database(OUT .. "/new.db")
  core.database(OUT .. "/secret.db")
  core.database(OUT .. "/secret.db", {read_only = true})
  core.database(IN .. "/../secret.db")
  core.database(IN .. "/up/secret.db", {read_only = true})
  core.database(IN .. "/link.db")
  core.database(IN .. "/link.db", {read_only = true})
  core.database(IN .. "/dangling")
  core.database(12345) and false
  core.database(named)
  core.database(IN .. "/x.db\0")
  core.database("file:" .. OUT .. "/secret.db") and io.open(OUT .. "/secret.db")
  contains_outside("file:" .. OUT .. "/secret.db?mode=ro")
  core.database("file:" .. OUT .. "/new.db?mode=rwc") and false
  core.database("file:../new.db") and false
  core.database("file:%2e%2e/secret.db") and contains_outside "file:%2e%2e/secret.db"
  core.database("file://localhost" .. OUT .. "/new.db") and false
  core.database("file:x.db?vfs=unix-none&mode=memory&cache=shared") and false
  core.salvage(OUT .. "/secret.db", IN .. "/new.db")
  core.salvage(IN .. "/link.db", IN .. "/new.db")
  core.salvage(IN .. "/own.db", OUT .. "/new.db")
  core.salvage(IN .. "/own.db", IN .. "/up/new.db")
  core.salvage(IN .. "/own.db", IN .. "/dangling")
  core.salvage(IN .. "/own.db", IN .. "/trap.db") and false
  core.salvage(IN .. "/leak.db", IN .. "/leaked.db") and false
  core.salvage(IN .. "/own.db", IN .. "/a.db", "ATTACH '" .. OUT .. "/new.db' AS x; CREATE TABLE x.y (z)")
  core.salvage(IN .. "/own.db", IN .. "/b.db", "VACUUM INTO '" .. OUT .. "/new.db'")
  core.salvage(IN .. "/own.db", IN .. "/c.db", "SELECT load_extension('libc.so.6')")
  core.salvage(IN .. "/own.db", IN .. "/d.db", "SELECT fts3_tokenizer('x', x'4141414141414141')")
  database:execute("ATTACH '" .. OUT .. "/new.db' AS other")
  database:execute("ATTACH '" .. OUT .. "/secret.db' AS other; CREATE TABLE stolen AS SELECT * FROM other.t")
  database:execute("ATTACH 'file:" .. OUT .. "/new.db' AS other")
  database:execute("VACUUM INTO '" .. OUT .. "/new.db'")
  database:execute "VACUUM"
  database:execute "SELECT load_extension('libc.so.6')"
  database:rows "SELECT hex(fts3_tokenizer('simple'))"
  database:rows("SELECT hex(fts3_tokenizer(?))", "simple")
  database:rows("SELECT fts3_tokenizer('x', ?)", ("A"):rep(8))
  database:execute "CREATE VIRTUAL TABLE x USING fts3(a, tokenize=x)"
  database:execute "CREATE VIRTUAL TABLE x USING fts4(a)"
  database:execute "CREATE VIRTUAL TABLE x USING rtree(a, b, c)"
  database:rows("SELECT readfile(?)", OUT .. "/secret.stl")
  database:rows("SELECT writefile(?, 'x')", OUT .. "/new")
  database:rows("SELECT * FROM fsdir(?)", OUT)
  database:rows "SELECT * FROM pragma_database_list"
  database:rows "SELECT * FROM dbstat"
  database:rows "SELECT randomblob(8)"
  database:rows "SELECT sqlite_source_id()"
  database:execute("PRAGMA temp_store_directory = '" .. OUT .. "'")
  database:execute("PRAGMA data_store_directory = '" .. OUT .. "'")
  database:execute "PRAGMA temp_store = FILE"
  database:execute "PRAGMA writable_schema = ON"
  database:execute "PRAGMA trusted_schema = ON"
  database:execute "PRAGMA journal_mode = OFF"
  database:execute "PRAGMA mmap_size = 1000000000"
  database:execute "PRAGMA locking_mode = EXCLUSIVE"
  database:rows "PRAGMA database_list"
  database:execute "UPDATE sqlite_master SET sql = 'CREATE TABLE x (a)'"
  database:execute "CREATE TEMP TABLE x (a)"
  database:execute "CREATE TRIGGER x AFTER INSERT ON t BEGIN SELECT load_extension('x'); END"
  hot_journal(IN .. "/first.db", OUT .. "/secret.stl")
  hot_journal(IN .. "/second.db", OUT .. "/777")
  hot_journal(IN .. "/third.db", IN .. "/up/secret.lua")
  beside(IN .. "/ahead.db")
  beside(IN .. "/shared.db")
  beside(IN .. "/journal.db")
]]

-- The same SQLite file in many places; journals that name other files.
local database_start = [[
  local database = assert(core.database(IN .. "/own.db"))
  assert(database:execute "CREATE TABLE IF NOT EXISTS t (a)")
  local function use(path)
    local db = core.database(path)
    if not db then return end
    pcall(db.change, db, "INSERT INTO t VALUES (1)")
    pcall(db.execute, db, "PRAGMA journal_mode = DELETE")
    pcall(db.change, db, "INSERT INTO t VALUES (2)")
    return db
  end
  local function beside(path)
    local db = use(path)
    if db then db:close() end
  end
  local function contains_outside(path) -- whether it is a database of what there is outside
    local ok, db = pcall(core.database, path, {read_only = true})
    return ok and db and pcall(db.rows, db, "SELECT * FROM kept")
  end
  -- A rollback journal that says that it belongs to `other`, which SQLite removes when it was played back.
  local function hot_journal(path, other)
    local db = use(path)
    if not db then return end
    local magic, sum = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7", 0
    for i = 1, #other do sum = sum + other:byte(i) end
    local file = assert(io.open(path .. "-journal", "wb"))
    local head = magic .. string.pack(">I4I4I4I4I4", 0, 0, 2, 512, 4096)
    file:write(head, ("\0"):rep(512 - #head), string.pack(">I4", (1 << 30) // 4096 + 1), other,
      string.pack(">I4I4", #other, sum), magic)
    file:close()
    pcall(db.rows, db, "SELECT * FROM t")
    pcall(db.change, db, "INSERT INTO t VALUES (3)")
    db:close()
    pcall(use, path)
  end
]]

local chunks_start = [[
  package.path = IN .. "/?.lua;" .. IN .. "/modules/?.lua;" .. package.path
  local dumped = string.dump(function() return 1 end)
  local function keep(name, text)
    local file = assert(io.open(IN .. "/" .. name, "wb"))
    file:write(text):close()
  end
  keep("compiled", dumped)
  keep("compiled.lua", dumped)
  keep("marked", "\xEF\xBB\xBF" .. dumped)
  keep("hashed", "#!/bin/sh\n" .. dumped)
  local function pieces(text, size)
    local at = 1 - size
    return function()
      at = at + size
      return at <= #text and text:sub(at, at + size - 1) or nil
    end
  end
]]

local engine_start = [[
  local box = assert(bw.surface.read(IN .. "/box.stl"))
  local mesh = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.02}, cells = {4, 1, 1}}
  local worst = assert(bw.worst_case(bw.model {mesh = mesh, material = bw.material.pla},
    {force = 1, modes = 1, regions = 1}))
  local function keep(name, text)
    local file = assert(io.open(IN .. "/" .. name, "wb"))
    file:write(text):close()
  end
  assert(box:picture(IN .. "/one.png"))
  local materials = {bw.hyperelastic {young = 1e5, poisson = 0.4, name = "soft"}}
  local function study(file, cache)
    return bw.study {name = "x", variables = {{name = "a", min = 0, max = 1}}, measures = {{name = "b"}},
      objectives = {"b"}, design = {"latin_hypercube", count = 2}, file = file, cache = cache and {folder = cache},
      run = function(point) return {b = point.a} end}
  end
  keep("include.inp", "*INCLUDE, INPUT=" .. OUT .. "/secret.stl\n")
  keep("input.inp", "*NODE, INPUT=" .. OUT .. "/secret.stl\n")
  keep("image.svg", '<svg xmlns="http://www.w3.org/2000/svg"><use href="' .. OUT .. '/secret.svg#a"/></svg>')
]]

return {
  {name = "files (S1, S2)", where = "", start = "", attempts = files},
  {name = "chunks (S3)", where = "", start = chunks_start, attempts = chunks},
  {name = "programs (S4)", where = "", start = engine_start, attempts = programs},
  {name = "Lua itself (S5)", where = "", start = "", attempts = inside},
  {name = "the engine (S1, S2)", where = "", start = engine_start, attempts = engine},
  {name = "databases (S6)", where = "", start = database_start, attempts = database},
  {name = "databases, from within (S6)", where = "/in", start = database_start, attempts = database},
}
