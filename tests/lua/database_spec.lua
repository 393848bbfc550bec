-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Files of results from Lua.
local core = require "barwright.core"
local check = require "check"

local function filled(path, count)
  local db = assert(core.database(path))
  assert(db:execute "CREATE TABLE trial (key TEXT PRIMARY KEY, number INTEGER, mass REAL, note TEXT)")
  assert(db:execute "BEGIN")
  for i = 1, count or 10 do
    assert.equal(1, db:change("INSERT INTO trial VALUES (?, ?, ?, ?)", "key " .. i, i, i / 3, ("x"):rep(100)))
  end
  assert(db:execute "COMMIT")
  return db
end

describe("a database", function()
  it("gives back what was put in", function()
    local path = check.folder() .. "/a.study"
    local db = filled(path, 3)
    local values = {math.maxinteger, math.mininteger, 0.1, -0.0, 1e308, math.huge, "", "ä\n'", "a\0b", false}
    assert(db:execute "CREATE TABLE value (a, b)")
    for i, value in ipairs(values) do
      assert.equal(1, db:change("INSERT INTO value VALUES (?, ?)", i, value))
    end
    db:change("INSERT INTO value VALUES (?, ?)", #values + 1, nil)
    db:change("INSERT INTO value VALUES (?, ?)", #values + 2, 0 / 0)
    local rows = assert(db:rows "SELECT b FROM value ORDER BY a")
    assert.equal(#values + 2, #rows)
    for i = 1, #values - 1 do
      assert.equal(values[i], rows[i].b)
      assert.equal(math.type(values[i]), math.type(rows[i].b))
    end
    assert.equal(0, rows[#values].b)
    assert.is_nil(rows[#values + 1].b)
    assert.is_nil(rows[#values + 2].b)
    assert.same({{number = 2, mass = 2 / 3}}, db:rows("SELECT number, mass FROM trial WHERE key = ?", "key 2"))
    assert.same({}, db:rows "SELECT * FROM trial WHERE number > 100")
    assert.equal(2, db:change "DELETE FROM trial WHERE number > 1")
    assert.equal(0, db:change "CREATE TABLE other (a)")
    assert.equal(path, db.path)
    assert.equal("database: " .. path, tostring(db))
    assert.is_true(db:check())
    db:close()
    check.raises("closed", db.rows, db, "SELECT 1")
    local again <close> = assert(core.database(path, {read_only = true}))
    assert.equal(1, again:rows "SELECT count(*) AS n FROM trial"[1].n)
    check.fails("io", "readonly", again:change "DELETE FROM trial")
  end)

  it("raises what is wrong in the script", function()
    local db <close> = filled(check.folder() .. "/a.study")
    check.raises("syntax error", db.execute, db, "SELEKT 1")
    check.raises("no such table", db.rows, db, "SELECT * FROM none_such")
    check.raises("parameters expected", db.rows, db, "SELECT ?", 1, 2)
    check.raises("parameters expected", db.change, db, "DELETE FROM trial WHERE number = ?")
    check.raises("parameter 1: nil, a number", db.rows, db, "SELECT ?", {})
    check.raises("one statement expected", db.rows, db, "SELECT 1; SELECT 2")
    check.raises("a statement of SQL expected", db.rows, db, " ")
    check.raises("did you mean 'read_only'", core.database, "x", {readonly = true})
    check.fails("constraint", "UNIQUE", db:change("INSERT INTO trial (key) VALUES (?)", "key 1"))
    assert.equal(10, db:rows "SELECT count(*) AS n FROM trial"[1].n)
  end)

  it("refuses what is no file of its own", function()
    local folder = check.folder()
    check.write(folder .. "/text", "number,mass\n1,2\n")
    check.fails("foreign", "not a database", core.database(folder .. "/text"))
    assert.equal("number,mass\n1,2\n", check.read(folder .. "/text"))
    check.write(folder .. "/empty", "")
    check.fails("foreign", "empty", core.database(folder .. "/empty", {read_only = true}))
    check.fails("io", "folder", core.database(folder))
    check.fails("io", "No such file", core.database(folder .. "/none", {read_only = true}))
    check.fails("io", "unable to open", core.database(folder .. "/no such folder/a"))
    assert(core.database(folder .. "/empty")):close()
    local db <close> = assert(core.database(folder .. "/empty", {read_only = true}))
    assert.same({}, db:rows "SELECT * FROM sqlite_master")
  end)

  it("is a file whatever its name begins with", function()
    local folder = check.folder()
    check.write(folder .. "/s.lua", [[
      local core = require "barwright.core"
      for _, name in ipairs {"file:x?mode=memory", "file:y?vfs=none", ":memory:", "file:%2e%2e/z"} do
        local db = assert(core.database(name))
        assert(db:execute "CREATE TABLE t (a)")
        assert(db.path == name)
        db:close()
        assert(#assert(core.database(name, {read_only = true})):rows "SELECT * FROM t" == 0)
        assert(assert(core.salvage(name, name .. ".new")).whole)
      end
    ]])
    assert.is_true((os.execute(("cd '%s' && mkdir 'file:%%2e%%2e' && '%s' s.lua"):format(folder, check.program))))
    local names = {}
    for line in io.popen(("cd '%s' && find . -type f"):format(folder)):lines() do
      local of_sqlite = line:find "%-wal$" or line:find "%-shm$" -- a reader leaves them
      if not of_sqlite then names[#names + 1] = line end
    end
    table.sort(names)
    assert.same({"./:memory:", "./:memory:.new", "./file:%2e%2e/z", "./file:%2e%2e/z.new", "./file:x?mode=memory",
      "./file:x?mode=memory.new", "./file:y?vfs=none", "./file:y?vfs=none.new", "./s.lua"}, names)
  end)

  it("is saved from regular files only, which end", function()
    local folder = check.folder()
    os.execute(("mkfifo '%s/pipe'"):format(folder))
    for _, name in ipairs {"/dev/full", "/dev/zero", folder .. "/pipe", folder} do
      local start = core.seconds()
      check.fails("io", "a file expected", core.salvage(name, folder .. "/new"))
      assert.is_nil(io.open(folder .. "/new.reading"))
      assert.is_true(core.seconds() - start < 60)
    end
  end)

  it("is not used by a job, which may have one of its own on the same file", function()
    local path = check.folder() .. "/a.study"
    local db = filled(path, 5)
    local job = core.job(function()
      local ok, message = pcall(db.rows, db, "SELECT 1")
      assert(not ok and message:find "another process")
      db:close()
      local own = assert(core.database(path))
      assert(own:change("INSERT INTO trial (key) VALUES (?)", "of the job") == 1)
      return tostring(own:rows "SELECT count(*) AS n FROM trial"[1].n)
    end)
    core.wait {job}
    assert.equal("6", assert(job:result()))
    assert.equal(6, db:rows "SELECT count(*) AS n FROM trial"[1].n)
    assert.is_true(db:check())
    db:close()
  end)

  it("keeps what was committed when its process is killed", function()
    local path = check.folder() .. "/a.study"
    local job = core.job(function()
      local db = filled(path, 5)
      db:execute "BEGIN"
      db:change("INSERT INTO trial (key) VALUES (?)", "not committed")
      os.execute "kill -KILL $PPID"
      return ""
    end)
    core.wait {job}
    check.fails("crashed", "killed", job:result())
    local db <close> = assert(core.database(path))
    assert.equal(5, db:rows "SELECT count(*) AS n FROM trial"[1].n)
    assert.is_true(db:check())
  end)

  it("waits for another writer, as long as it was told", function()
    local path = check.folder() .. "/a.study"
    local db <close> = filled(path, 5)
    local other <close> = assert(core.database(path, {busy_seconds = 0.05}))
    assert(db:execute "BEGIN IMMEDIATE")
    check.fails("busy", "another process", other:change "DELETE FROM trial")
    assert.equal(5, #other:rows "SELECT * FROM trial") -- readers go on
    assert(db:execute "COMMIT")
    assert.equal(5, other:change "DELETE FROM trial")
  end)

  it("that is damaged is reported, and what is readable is saved", function()
    local folder = check.folder()
    local path = folder .. "/a.study"
    filled(path, 2000):close()
    local bytes = check.read(path)
    local page = 30 * 4096
    check.write(path, bytes:sub(1, page) .. ("\0"):rep(3 * 4096) .. bytes:sub(page + 3 * 4096 + 1))
    local db = assert(core.database(path))
    local rows, message, details = db:rows "SELECT * FROM trial NOT INDEXED"
    check.fails("damaged", "salvage", rows, message, details)
    local sound, problems = db:check()
    assert.is_false(sound)
    assert.truthy(#problems > 0)
    db:close()
    local saved = assert(core.salvage(path, folder .. "/saved.study"))
    assert.equal(1, saved.tables)
    assert.equal(2000, saved.rows + saved.lost)
    assert.truthy(saved.lost > 0 and saved.lost < 200)
    assert.is_false(saved.whole)
    assert.truthy(saved.log[1]:find("could not be read", 1, true))
    local new <close> = assert(core.database(folder .. "/saved.study"))
    assert.equal(saved.rows, new:rows "SELECT count(*) AS n FROM trial"[1].n)
    assert.equal(0, new:rows "SELECT count(*) AS n FROM trial WHERE mass <> number / 3.0"[1].n)
    check.fails("io", "already", core.salvage(path, folder .. "/saved.study"))
    check.fails("io", "No such file", core.salvage(folder .. "/none", folder .. "/other"))
  end)

  it("says that the disk is full", function()
    local folder = check.folder()
    local path = folder .. "/a.study"
    check.write(folder .. "/s.lua", [[
      local core = require "barwright.core"
      local db = assert(core.database(arg[1]))
      assert(db:execute "CREATE TABLE t (a)")
      local _, message, details
      for i = 1, 100000 do
        _, message, details = db:change("INSERT INTO t VALUES (?)", ("x"):rep(500))
        if not _ then break end
      end
      print(details.status, #db:rows "SELECT a FROM t" > 10)
    ]])
    local pipe <close> = assert(io.popen(("trap '' XFSZ; ulimit -f 300; '%s' %s/s.lua %s"):format(
      check.program, folder, path)))
    assert.equal("full\ttrue\n", pipe:read "a")
    local db <close> = assert(core.database(path))
    assert.is_true(db:check())
  end)
end)
