-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the file of a study lives through: SIGKILL at any moment, a full disk, damage; Ctrl-C.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local script = check.root .. "/tests/lua/study/killed.lua"
local full = os.getenv "BARWRIGHT_FULL" == "1"

local function rows(path)
  local db <close> = assert(core.database(path, {read_only = true}))
  return assert(db:rows("SELECT t.number, t.key, t.status, t.attempts, p.x, p.k, r.y, r.r FROM trials t"
    .. " JOIN points p ON p.number = t.number LEFT JOIN results r ON r.number = t.number ORDER BY t.number"))
end

local function count_done(path)
  local there = io.open(path, "rb")
  if not there then return 0 end
  there:close()
  local db <close> = core.database(path, {read_only = true})
  local tables = db and db:rows "SELECT name FROM sqlite_master WHERE name = 'trials'"
  if not tables or #tables == 0 then return 0 end -- killed before it had made them
  local list = db:rows "SELECT count(*) AS n FROM trials WHERE status = 'done'"
  return list and list[1].n or 0
end

-- Starts a run of so many trials in the background, waits until `enough` of them are done or it has ended, and
-- then `more` seconds; sends it the signal. What it says goes to folder/err, its exit status to folder/code.
local function run_until(path, count, enough, folder, signal, more)
  os.remove(folder .. "/pid")
  os.remove(folder .. "/code")
  os.execute(([[{ BARWRIGHT_QUIET=1 '%s' '%s' '%s' %d >/dev/null 2>'%s/err' & p=$!; echo $p >'%s/pid'; wait $p
    echo $? >'%s/code'; } 2>/dev/null &]]):format(check.program, script, path, count, folder, folder, folder))
  local function ended() return os.execute(("test -s '%s/code'"):format(folder)) end
  while not ended() and count_done(path) < enough do os.execute "sleep 0.02" end
  os.execute(("sleep %.3f; kill -%s $(cat '%s/pid') 2>/dev/null"):format(more or 0, signal, folder))
  return ended
end

describe("a study that is killed", function()
  it("ends with every trial once and the numbers of an undisturbed run", function()
    local count, kills = full and 10000 or 500, full and 50 or 8
    local folder = check.folder()
    assert.equal(0, (check.run(("%s %s/whole.study %d"):format(script, folder, count))))
    local random = check.random(11)
    local path, progress = folder .. "/killed.study", {}
    for i = 1, kills do
      local enough = math.max(1, (progress[i - 1] or 0) + math.floor(1.6 * random() * count / kills))
      local ended = run_until(path, count, math.min(enough, count), folder, "KILL", 0.05 * random())
      while not ended() do os.execute "sleep 0.02" end
      assert.equal("", check.read(folder .. "/err"))
      progress[i] = count_done(path)
      assert.is_true(progress[i] >= (progress[i - 1] or 0)) -- nothing that was there is gone
    end
    assert.is_true(progress[kills] > 0)
    local status, said, complaint = check.run(("%s %s %d"):format(script, path, count))
    assert.equal("", complaint)
    assert.equal(0, status)
    assert.equal(count .. "\n", said)
    local expected, found = rows(folder .. "/whole.study"), rows(path)
    assert.equal(count, #found)
    for i, row in ipairs(found) do
      assert.equal(1, row.attempts)
      assert.same(expected[i], row)
    end
    if full then print(("# done after each kill: %s"):format(table.concat(progress, " "))) end
  end)

  it("goes on after Ctrl-C, which ends it with status 130 and what is done kept", function()
    local folder = check.folder()
    local path = folder .. "/x.study"
    local ended = run_until(path, 5000, 1, folder, "INT")
    while not ended() do os.execute "sleep 0.02" end
    assert.equal("130\n", check.read(folder .. "/code"))
    local done = count_done(path)
    assert.is_true(done > 0 and done < 5000, done)
    assert.truthy(check.read(folder .. "/err"):find("interrupted", 1, true))
    local lock = io.open(path .. ".lock")
    assert.is_nil(lock)
  end)
end)

describe("a second process", function()
  it("is refused while the first one runs, and the file can be read meanwhile", function()
    local folder = check.folder()
    local path = folder .. "/x.study"
    run_until(path, 5000, 1, folder, "STOP") -- it has read one trial meanwhile
    local status, _, complaint = check.run(("%s %s 5000"):format(script, path))
    os.execute(("kill -9 %d"):format(tonumber(check.read(folder .. "/pid"))))
    assert.equal(1, status)
    assert.truthy(complaint:find("this study is being run by process " .. check.read(folder .. "/pid"):match "%d+",
      1, true), complaint)
  end)
end)

local function study(path, count, more)
  local opts = {name = "full", file = path, variables = {{name = "x", min = 0, max = 1}}, measures = {"y"},
    design = {"random", count = count}, run = function(point) return {y = point.x} end}
  for key, value in pairs(more or {}) do opts[key] = value end
  return bw.study(opts)
end

describe("a file", function()
  -- As root on a file system of its own that is small; else by the limit on the size of files.
  it("on a full disk keeps what was finished, says so, and goes on when there is room", function()
    local folder = check.folder()
    local is_root = io.popen("id -u"):read "l" == "0"
    local mounted = is_root and os.execute(("mount -t tmpfs -o size=300k none '%s' 2>/dev/null"):format(folder))
    if not mounted then return end
    local path = folder .. "/full.study"
    local ok, message, details = study(path, 3000):run()
    local done = count_done(path)
    os.execute(("cp '%s' '%s.copy' 2>/dev/null; umount -l '%s' 2>/dev/null"):format(path, os.tmpname(), folder))
    check.fails("full", "the disk is full; what was finished before is kept", ok, message, details)
    assert.is_true(done > 20 or done == 0, done)
  end)

  it("that is damaged is refused with the reason, and what can be read is saved", function()
    local folder = check.folder()
    local path = folder .. "/full.study"
    local whole = assert(study(path, 100):run())
    local text = check.read(path)
    local refused = 0
    -- Page after page; the first, which says where everything else is, too.
    for page = 0, #text // 4096 - 1, full and 1 or 3 do
      local bad, new = ("%s/bad%d.study"):format(folder, page), ("%s/new%d.study"):format(folder, page)
      local filling = page == 0 and "\0" or "\xa5"
      check.write(bad, text:sub(1, page * 4096) .. filling:rep(4096) .. text:sub(page * 4096 + 4097))
      local ok, message, details = study(bad, 100):run()
      if not ok then
        check.fails("damaged", "barwright study salvage " .. bad, ok, message, details)
        refused = refused + 1
      end
      assert.is_true(assert(bw.study.salvage(bad, new)).rows > 100)
      local trials = study(new, 100):run() or assert(study(new, 100):run {continue = true})
      assert.equal(100, #trials)
      for i, trial in ipairs(trials) do
        assert.equal(whole[i].key, trial.key)
        assert.equal(whole[i].number, trial.number)
        assert.equal(whole[i].results.y, trial.results.y)
      end
      assert.equal(100, #assert(study(new, 100):trials()))
    end
    assert.is_true(refused > 0)
  end)

  it("whose list of tables is damaged gives all its trials, and all of them again from what was saved", function()
    local folder = check.folder()
    local path = folder .. "/whole.study"
    local whole = assert(study(path, 300):run())
    local text = check.read(path)
    -- The whole first page, its second half where the statements stand, two letters of one of them, then the
    -- file that was saved from the first.
    local ways = {("\xa5"):rep(4096) .. text:sub(4097), text:sub(1, 2048) .. ("\0"):rep(2048) .. text:sub(4097),
      (text:gsub("CREATE TABLE trials", "CREATE TALBE trials", 1)),
      false}
    for i, damaged in ipairs(ways) do
      local bad, new = ("%s/bad%d.study"):format(folder, i), ("%s/new%d.study"):format(folder, i)
      check.write(bad, damaged or ("\xff"):rep(4096) .. check.read(folder .. "/new1.study"):sub(4097))
      local saved = assert(bw.study.salvage(bad, new))
      assert.is_true(saved.relisted, i)
      assert.truthy(tostring(saved):find "list of tables is damaged")
      local trials = assert(study(new, 300):trials())
      assert.equal(300, #trials)
      for k, trial in ipairs(trials) do
        assert.equal(whole[k].key, trial.key)
        assert.equal("done", trial.status)
        assert.equal(whole[k].results.y, trial.results.y)
        assert.equal(whole[k].point.x, trial.point.x)
      end
      local db <close> = assert(core.database(new))
      assert.is_true((db:check()))
      -- A view is for other programs: only its text can be read here.
      local view = assert(db:rows "SELECT sql FROM sqlite_master WHERE name = 'overview'")[1].sql
      assert.equal(300, assert(db:rows(("SELECT count(*) AS n FROM (%s) WHERE y IS NOT NULL")
        :format(view:match "AS (SELECT.*)")))[1].n)
    end
    -- Without the definition too, or in a file of something else, there is nothing to go by.
    local bad = folder .. "/bad.study"
    check.write(bad, ("\xa5"):rep(8192) .. text:sub(8193))
    check.fails("damaged", "nothing can be saved", bw.study.salvage(bad, folder .. "/none.study"))
    check.write(bad, ("solid cow\n"):rep(1000))
    check.fails("damaged", "nothing can be saved", bw.study.salvage(bad, folder .. "/none.study"))
    assert.is_nil(io.open(folder .. "/none.study"))
    assert.equal("", io.popen(("ls %s | grep -E 'reading|tables'"):format(folder)):read "a")
  end)
end)
