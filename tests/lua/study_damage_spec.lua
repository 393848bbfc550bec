-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Damaged files of a study: every reader gives what was written or says that the file is damaged. Fixed seed.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"
local definition = require "barwright.study.definition"

local full = os.getenv "BARWRIGHT_FULL" == "1"
local PAGE = 4096

local function study(path, count)
  return bw.study {name = "damage", file = path,
    variables = {{name = "x", min = 0, max = 1}, {name = "k", kind = "integer", min = 1, max = 9},
      {name = "of", of = {true, false, "steel", 2.5}}},
    measures = {"y", {name = "z", unit = "m", optional = true}}, objectives = {{name = "y", goal = "min"}},
    design = {"random", count = count},
    run = function(point)
      if point.k == 9 then return nil, "no such beam" end
      return {y = point.x * point.k, z = point.of == true and 3 or nil}, {y = {x = point.k + 0.5}}
    end}
end

-- ---- a study's file, and states that it went through ------------------------------------------------------

-- The file after its end, and what it and its -wal were when a third and two thirds of its trials were there.
local function made(folder, count)
  local path = folder .. "/whole.study"
  local own, states, seen = study(path, count), {}, 0
  assert(own:run {evaluations = count // 3})
  states[1] = {main = check.read(path)}
  assert(own:run {workers = 1, stop_when = function(trials)
    seen = #trials
    if not states[2] and seen > 2 * count // 3 then
      states[2] = {main = check.read(path), wal = check.read(path .. "-wal")}
    end
  end})
  assert(states[2])
  return path, check.read(path), states
end

-- ---- ways to damage it ---------------------------------------------------------------------------------

local function page(text, i) return text:sub((i - 1) * PAGE + 1, i * PAGE) end

local function with_page(text, i, bytes)
  return text:sub(1, (i - 1) * PAGE) .. bytes .. text:sub(i * PAGE + 1)
end

local ways = {
  function(text, r) -- bytes anywhere
    for _ = 1, r(8) do
      local at = r(#text)
      text = text:sub(1, at - 1) .. string.char(r(256) - 1) .. text:sub(at + 1)
    end
    return text
  end,
  function(text, r) -- one bit where something stands
    local at
    repeat at = r(#text) until text:byte(at) ~= 0
    return text:sub(1, at - 1) .. string.char(text:byte(at) ~ 1 << (r(8) - 1)) .. text:sub(at + 1)
  end,
  function(text, r) return with_page(text, r(#text // PAGE), ("\0"):rep(PAGE)) end,
  function(text, r) return with_page(text, r(#text // PAGE), ("\xa5"):rep(PAGE)) end,
  function(text, r) return text:sub(1, r(#text)) end,
  function(text, r) -- two pages exchanged
    local a, b = r(#text // PAGE), r(#text // PAGE)
    return with_page(with_page(text, a, page(text, b)), b, page(text, a))
  end,
  function(text, r) -- one page twice
    return with_page(text, r(#text // PAGE), page(text, r(#text // PAGE)))
  end,
  function(text, r, states) -- a page as it was before
    local old = states[r(2)].main
    local i = r(math.min(#old, #text) // PAGE)
    return with_page(text, i, page(old, i))
  end,
  function(text, r, states) -- several pages as they were
    local old = states[r(2)].main
    for _ = 1, 3 do
      local i = r(math.min(#old, #text) // PAGE)
      text = with_page(text, i, page(old, i))
    end
    return text
  end,
  function(text, _, states) return text, states[2].wal end, -- what was ahead of the file once
  function(text, r, states) -- that, damaged
    local wal = states[2].wal
    local at = r(#wal)
    return text, wal:sub(1, at - 1) .. string.char(r(256) - 1) .. wal:sub(at + 1)
  end,
  function(_, r, states) -- a killed process's files, damaged
    local old = states[2]
    local at = r(#old.wal)
    return old.main, old.wal:sub(1, at - 1) .. string.char(r(256) - 1) .. old.wal:sub(at + 1), "killed"
  end,
}

-- ---- readers -------------------------------------------------------------------------------------------

-- The trials as a table without what a clock decides.
local function table_of(trials)
  local lines = {}
  for i, t in ipairs(trials) do
    local x = t.results
    lines[i] = ("%d %s %d %s %s %.17g %d %s %s %s %s"):format(t.number, t.key, t.seed, t.status, t.message,
      t.point.x, t.point.k, t.point.of, x and ("%.17g"):format(x.y), x and x.z, t.gradients and t.gradients.y.x)
  end
  return table.concat(lines, "\n")
end

local function number_of(trials, which)
  for _, t in ipairs(trials) do
    if t.key == which.key then return t end
  end
end

local function copy_to(path, main, wal)
  for _, ending in ipairs {"", "-wal", "-shm", "-journal", ".lock"} do os.remove(path .. ending) end
  check.write(path, main)
  if wal then check.write(path .. "-wal", wal) end
end

-- Every reader but the whole run gives the same answer or says what is wrong, and none raises. Returns whether the
-- file was refused.
local function read_all(folder, count, whole, expected, path)
  local refused
  local function judged(name, value, message, details, same)
    if value == nil then
      assert.truthy(type(message) == "string" and message:find(path, 1, true), name .. ": " .. tostring(message))
      assert.is_string(details.status, name)
      refused = message
    else
      assert.is_true(same(value), name .. " gives other numbers")
    end
  end
  local s = study(path, count)
  local trials, message, details = s:trials()
  judged("trials", trials, message, details, function(t) return table_of(t) == expected end)
  local out = folder .. "/out"
  local ok
  ok, message, details = s:csv(out .. ".csv")
  judged("csv", ok, message, details, function() return check.read(out .. ".csv") == whole.csv end)
  ok, message, details = s:status()
  judged("status", ok, message, details, function(t) return t.done == whole.done and t.missing == 0 end)
  ok, message, details = s:trial(whole.trials[7].key)
  judged("trial", ok, message, details, function(t) return t.same end)
  if trials then
    judged("plot", trials:plot "history", nil, nil, function() return true end)
    judged("report", trials:report(out .. ".html"), nil, nil, function() return true end)
  end
  os.remove(out .. ".study")
  ok, message, details = study(out .. ".study", count):merge(path, {continue = true})
  judged("merge", ok, message, details, function(t) return t.taken == count end)
  return refused
end

local function run_again(path, count, whole, expected)
  local trials, message, details = study(path, count):run()
  if not trials then
    assert.truthy(message:find(path, 1, true), message)
    assert.is_string(details.status)
    return message
  end
  assert.equal(expected, table_of(trials))
  assert.equal(#whole.trials, #trials)
end

-- What is saved holds only what was written; run again, it holds all.
local function save(folder, path, count, whole)
  local new = folder .. "/saved.study"
  for _, ending in ipairs {"", "-wal", "-shm"} do os.remove(new .. ending) end
  local report, message, details = bw.study.salvage(path, new)
  if not report then
    assert.equal("damaged", details.status, message)
    assert.is_nil(io.open(new))
    return 0
  end
  local s = study(new, count)
  local before = s:trials()
  for _, t in ipairs(before or {}) do
    assert.equal(table_of {number_of(whole.trials, t)}, table_of {t})
  end
  local trials = s:run()
  if not trials then trials = assert(s:run {continue = true}) end -- which study it was of may be lost
  assert.equal(count, #trials)
  for _, t in ipairs(trials) do
    local other = number_of(whole.trials, t)
    assert.equal(other.status, t.status)
    assert.same(other.results, t.results)
  end
  assert.equal(count, #assert(s:trials()))
  local db <close> = assert(core.database(new))
  assert.is_true((db:check()))
  return before and #before or 0
end

describe("a damaged file", function()
  it("changes no number without a word, ends nothing in a traceback, and its sound trials are saved", function()
    local count, copies = full and 240 or 90, full and 200 or 24
    local folder = check.folder()
    local path, text, states = made(folder, count)
    local whole = {trials = assert(study(path, count):trials())}
    assert(study(path, count):csv(folder .. "/whole.csv"))
    whole.csv, whole.done = check.read(folder .. "/whole.csv"), whole.trials:counts().done
    local expected = table_of(whole.trials)
    local random = check.random(20261122)
    local function r(n) return math.floor(n * random()) + 1 end
    local refused, same, saved = 0, 0, 0
    local bad = folder .. "/bad.study"
    for i = 1, copies do
      local main, wal, killed = ways[(i - 1) % #ways + 1](text, r, states)
      copy_to(bad, main, wal)
      local ok, why = xpcall(function()
        local wrong
        if not killed then wrong = read_all(folder, count, whole, expected, bad) end
        if wrong then
          refused = refused + 1
          copy_to(bad, main, wal)
          saved = saved + save(folder, bad, count, whole)
        else
          same = same + 1
        end
        copy_to(bad, main, wal)
        run_again(bad, count, whole, expected)
      end, debug.traceback)
      if not ok then
        error(("copy %d (way %d): %s"):format(i, (i - 1) % #ways + 1, tostring(why)))
      end
    end
    assert.is_true(refused > copies // 3, refused)
    if full then
      print(("# refused %d, same %d; trials saved of %d each: %d"):format(refused, same, count, saved))
    end
  end)
end)

-- A change that SQLite cannot see, made by SQL.
local function changed(folder, text, ...)
  local path = folder .. "/changed.study"
  copy_to(path, text)
  local db <close> = assert(core.database(path))
  for _, sql in ipairs {...} do assert(db:execute(sql)) end
  db:execute "PRAGMA journal_mode = DELETE"
  return path
end

-- The file as a version that knew no checksums made it.
local function plain(folder, from, name)
  local path = folder .. "/" .. name
  local about = definition.of(study(from, 1))
  local old <close> = assert(core.database(from))
  local new <close> = assert(core.database(path))
  for _, statement in ipairs(definition.schema(about, true)) do assert(new:execute(statement)) end
  for table_name in pairs(definition.tables(about)) do
    for _, row in ipairs(assert(old:rows("SELECT * FROM " .. table_name))) do
      row.checksum = nil
      if table_name == "study" and row.name == "format" then row.value = "barwright study 1" end
      if not (table_name == "study" and row.name:find "^checksum of") then
        local names, values = {}, {}
        for column, value in pairs(row) do
          names[#names + 1], values[#values + 1] = '"' .. column .. '"', value
        end
        assert(new:change(("INSERT INTO %s (%s) VALUES (%s)"):format(table_name, table.concat(names, ", "),
          ("?, "):rep(#names - 1) .. "?"), table.unpack(values)))
      end
    end
  end
  new:execute "PRAGMA journal_mode = DELETE"
  return path
end

describe("a file whose rows were changed", function()
  local folder = check.folder()
  local path = folder .. "/whole.study"
  local whole = assert(study(path, 60):run())
  local text = check.read(path)

  it("names the trials and the file, also those that are gone, exchanged or older", function()
    local done = {}
    for _, t in ipairs(whole) do
      if t.results then done[#done + 1] = t.number end
    end
    local one, two = done[3], done[9]
    local asked = "UPDATE trials SET status = 'asked', seconds = NULL, attempts = 0 WHERE number = "
    local ways_of = {
      {("trial %d does not match its checksum"):format(one),
        "UPDATE results SET y = y + 1e-9 WHERE number = " .. one},
      {("trial %d does not match its checksum"):format(two),
        "UPDATE points SET x = x / 2 WHERE number = " .. two},
      {"trial 5 does not match its checksum", "UPDATE trials SET key = 'a' || key WHERE number = 5"},
      {"trial 5 does not match its checksum", "UPDATE trials SET seconds = seconds + 1 WHERE number = 5"},
      {("2 of 60 trials do not match their checksums (%d, %d)"):format(one, two),
        ("UPDATE results SET number = 1000 WHERE number = %d"):format(one),
        ("UPDATE results SET number = %d WHERE number = %d"):format(one, two),
        ("UPDATE results SET number = %d WHERE number = 1000"):format(two)},
      {("trial %d does not match its checksum"):format(one), asked .. one,
        "DELETE FROM results WHERE number = " .. one},
      {"1 of 60 trials that were written are gone", "DELETE FROM trials WHERE number = 60",
        "DELETE FROM points WHERE number = 60", "DELETE FROM results WHERE number = 60"},
      {"out of order, doubled or of no trial", "INSERT INTO results (number, y) VALUES (77, 1)"},
      {"the number of its trials is lost", "DELETE FROM study WHERE name = 'checksum of trials'"},
      {"does not match its checksum (manifests)", "UPDATE manifests SET manifest = '{}'"},
      {"does not match its checksum (scripts)", "UPDATE scripts SET text = 'return 1'"},
      {"does not match its checksum (study)", "UPDATE study SET value = '2' WHERE name = 'seed'"},
      {"does not match its checksum (variables)", "UPDATE variables SET min = 3 WHERE name = 'x'"},
      {"does not match its checksum (measures)", "UPDATE measures SET unit = 'ft' WHERE name = 'z'"},
      {"its format is lost", "UPDATE study SET value = 'barwright study 1' WHERE name = 'format'"},
    }
    for _, way in ipairs(ways_of) do
      local bad = changed(folder, text, table.unpack(way, 2))
      local s = study(bad, 60)
      check.fails("damaged", bad .. ": the file is damaged", s:trials())
      check.fails("damaged", way[1], s:trials())
      check.fails("damaged", way[1], s:status())
      check.fails("damaged", way[1], s:csv(folder .. "/none.csv"))
      check.fails("damaged", way[1], s:trial(1))
      check.fails("damaged", way[1], s:run())
      check.fails("damaged", way[1], study(folder .. "/other.study", 60):merge(bad))
      assert.is_nil(io.open(folder .. "/none.csv"))
      os.remove(folder .. "/saved.study")
      local report = assert(bw.study.salvage(bad, folder .. "/saved.study"))
      assert.is_false(report.whole)
      local again = assert(study(folder .. "/saved.study", 60):run())
      assert.equal(table_of(whole), table_of(again), way[1])
      assert.equal(60, #assert(study(folder .. "/saved.study", 60):trials()))
    end
  end)

  it("ends every command with status 3 and a sentence, and salvage and a run bring it back", function()
    check.write(folder .. "/damage.lua", [[
      return require("barwright").study {name = "command", file = arg[0]:gsub("[^/]*$", "command.study"),
        variables = {{name = "x", min = 0, max = 1}}, measures = {"y"}, design = {"random", count = 20},
        run = function(point) return {y = point.x} end}]])
    local script, file = folder .. "/damage.lua", folder .. "/command.study"
    assert.equal(0, (check.run("study run " .. script)))
    local db = assert(core.database(file))
    assert(db:execute "UPDATE results SET y = y + 1 WHERE number = 7")
    db:execute "PRAGMA journal_mode = DELETE"
    db:close()
    for _, words in ipairs {"run %s", "status %s", "csv %s", "trial %s 3", "plot %s history", "report %s",
      "merge %s " .. file .. " --file " .. folder .. "/merged.study"} do
      local status, _, complaint = check.run("study " .. words:format(script))
      assert.equal(3, status, words)
      assert.truthy(complaint:find(file .. ": the file is damaged: trial 7 does not match its checksum", 1, true),
        complaint)
      assert.is_nil(complaint:find("traceback", 1, true))
    end
    local status, said = check.run(("study salvage %s %s"):format(file, folder .. "/new.study"))
    assert.equal(0, status)
    assert.truthy(said:find("1 trials are not what was written", 1, true), said)
    assert.equal(0, (check.run(("study run %s --file %s/new.study"):format(script, folder))))
    assert.equal(0, (check.run(("study csv %s --file %s/new.study"):format(script, folder))))
  end)

  it("is read, gone on with and merged where it has no checksums yet, with a warning", function()
    local old = plain(folder, path, "old.study")
    bw.warnings()
    assert.equal(table_of(whole), table_of(assert(study(old, 60):trials())))
    assert.truthy(bw.warnings()[1]:find("an older version made it without checksums", 1, true))
    assert.equal(80, #assert(study(old, 80):run()))
    assert.equal(80, #assert(study(old, 80):trials()))
    assert.equal(80, assert(study(folder .. "/sealed.study", 80):merge(old)).taken)
    assert.equal(table_of(assert(study(old, 80):trials())),
      table_of(assert(study(folder .. "/sealed.study", 80):trials())))
    bw.warnings()
    assert(study(folder .. "/sealed.study", 80):trials())
    assert.same({}, bw.warnings())
    -- what can be reported without them is reported: a point that is not its key's, a row that is gone
    for _, sql in ipairs {"UPDATE points SET x = x / 2 WHERE number = 9", "DELETE FROM points WHERE number = 9",
      "UPDATE trials SET seed = 5 WHERE number = 9", "UPDATE trials SET status = 'dome' WHERE number = 9"} do
      local bad = changed(folder, check.read(old), sql)
      check.fails("damaged", "trial 9 is not what was written", study(bad, 80):trials())
      os.remove(folder .. "/saved.study")
      assert(bw.study.salvage(bad, folder .. "/saved.study"))
      assert.equal(80, #assert(study(folder .. "/saved.study", 80):run()))
    end
  end)
end)
