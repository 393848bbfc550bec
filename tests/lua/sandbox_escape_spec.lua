-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Scripts that try to get out of the sandbox, with both walls and with the first one alone (the program
-- first_wall is barwright on a kernel that closes nothing). Canaries outside stay what they are, unread.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"
local escapes = require "escapes"

local MARK = "canary_4711"

local function shell(command, ...)
  local quoted = {}
  for i, word in ipairs {...} do quoted[i] = "'" .. word:gsub("'", "'\\''") .. "'" end
  local pipe = io.popen((command:gsub("%?", function() return table.remove(quoted, 1) end)))
  local text = pipe:read "a"
  assert(pipe:close(), command)
  return text
end

local function absolute(path) return (shell("realpath ?", path):gsub("\n", "")) end
local walls = {["both walls"] = absolute(check.program), ["the first wall alone"] = absolute(check.first_wall)}

-- OUT with canaries: a surface, a script, a file whose name is a number, a database, an empty folder. OUT/in
-- is the sandbox's folder, with links that lead outside under every name that something may use.
local function place()
  local out = shell("cd ? && pwd -P", check.folder()):gsub("\n", "")
  local within = out .. "/in"
  shell("mkdir ? ? ?", out .. "/empty", within, within .. "/modules")
  shell("mkdir -p ?", within .. "/file:" .. out)
  assert(bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.01}}:write(within .. "/box.stl"))
  check.write(out .. "/secret.stl", "solid " .. MARK .. "\nendsolid\n")
  check.write(out .. "/secret.lua", ("return %q"):format(MARK))
  check.write(out .. "/secret.svg", '<svg xmlns="http://www.w3.org/2000/svg"><path id="a" d="M0 0h9v9z"/></svg>')
  check.write(out .. "/777", ("return %q"):format(MARK))
  assert(bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.01}}:picture(out .. "/one.png"))
  local db = assert(core.database(out .. "/secret.db"))
  assert(db:execute "CREATE TABLE t (a); CREATE TABLE kept (a)")
  db:change("INSERT INTO kept VALUES (?)", MARK)
  db:execute "PRAGMA journal_mode = DELETE"
  db:close()
  for _, name in ipairs {"ahead", "shared", "journal", "leak"} do
    local other = assert(core.database(within .. "/" .. name .. ".db"))
    assert(other:execute "CREATE TABLE t (a)")
    other:execute "PRAGMA journal_mode = DELETE"
    other:close()
  end
  local links = {["link.stl"] = "secret.stl", ["link.db"] = "secret.db", ["ahead.db-wal"] = "secret.db",
    ["shared.db-shm"] = "secret.db", ["journal.db-journal"] = "secret.db", ["leak.db-wal"] = "secret.db",
    ["trap.db.reading"] = "secret.stl", ["trap.db.reading.tables"] = "secret.stl", ["up"] = "",
    ["trap.db-wal"] = "secret.stl", ["trap.db.reading-wal"] = "secret.stl"}
  for name, to in pairs(links) do shell("ln -s ? ?", out .. "/" .. to, within .. "/" .. name) end
  shell("ln -s link.stl ?; ln -s loop ?; ln -s /nowhere/at/all ?; ln -s ../dangling.stl ?", within .. "/second",
    within .. "/loop", within .. "/dangling", within .. "/dangling.stl")
  -- Read two days before it was changed: reading it again changes that, where the file system keeps it.
  shell("touch -a -d '2 days ago' ?/secret.* ?/777 ?/one.png ?", out, out, out, out .. "/empty")
  return out
end

-- Names, kinds, sizes and times of what is outside, the time of reading among them, and what is in it.
local function state(out)
  return shell("cd ? && find . -path ./in -prune -o ! -path . -printf '%p %y %s %T@ %A@ %m\\n' | sort; ", out)
end

local function contents(out)
  return shell("cd ? && sha256sum secret.* 777 one.png; ls -A empty", out)
end

local head = [[
  local OUT, IN, MARK = %q, %q, %q
  local bw, core = require "barwright", require "barwright.core"
  local named = setmetatable({}, {__tostring = function() return OUT .. "/secret.stl" end,
    __name = OUT .. "/secret.stl", __len = function() return 1 end, __concat = function() return OUT end,
    __index = function() return OUT .. "/secret.stl" end})
  -- What follows may change any of these for others.
  local pcall, tostring, type, stdout, write = pcall, tostring, type, io.stdout, io.stdout.write
  stdout:setvbuf "no"
  local function try(text, attempt)
    local ok, value = pcall(attempt)
    write(stdout, (not ok or not value) and "refused\t" or "GOT OUT\t", text, "\t",
      type(value) == "string" and value or tostring(value), "\n")
  end
]]

local function script_of(group, out)
  local lines, count = {head:format(out, out .. "/in", MARK), group.start}, 0
  for attempt in group.attempts:gmatch "[^\n]+" do
    attempt = attempt:match "^%s*(.-)%s*$"
    if attempt ~= "" then
      count = count + 1
      lines[#lines + 1] = ("try(%q, function() return %s end)"):format(attempt, attempt)
    end
  end
  return table.concat(lines, "\n"), count
end

local function run(program, group)
  local out = place()
  local script, count = script_of(group, out)
  check.write(out .. "/in/script.lua", script)
  local was = contents(out)
  shell("touch -a -d '2 days ago' ?/secret.* ?/777 ?/one.png", out, out, out) -- the sum has read them
  local before = state(out)
  local log = check.folder()
  local _, _, status = os.execute(("cd '%s%s' && HOME=/root BARWRIGHT_QUIET=1 '%s' --seconds 100 "
    .. "--sandbox '%s/in' '%s/in/script.lua' >'%s/out' 2>'%s/err' </dev/null")
    :format(out, group.where, program, out, out, log, log))
  local text, err = check.read(log .. "/out"), check.read(log .. "/err")
  assert.equal(0, status, err .. text:sub(-500))
  local refused = 0
  for line in text:gmatch "[^\n]+" do
    assert.is_nil(line:find("GOT OUT", 1, true), line)
    for _, slip in ipairs {"index", "call", "perform", "concatenate", "compare"} do
      assert.is_nil(line:find("attempt to " .. slip, 1, true), line) -- of the attempt itself
    end
    if line:match "^refused\t" then refused = refused + 1 end
  end
  assert.equal(count, refused)
  assert.is_nil(text:find(MARK, 1, true))
  assert.is_nil(err:find(MARK, 1, true))
  assert.equal(before, state(out))
  assert.equal(was, contents(out))
  -- Nothing of the canaries has come inside, either.
  assert.equal("", shell("grep -rlsI ? ? --exclude=script.lua || true", MARK, out .. "/in"))
  return count
end

local total = 0
for wall, program in pairs(walls) do
  describe("a script behind " .. wall, function()
    for _, group in ipairs(escapes) do
      it("does not get out by " .. group.name, function() total = total + run(program, group) end)
    end
  end)
end

describe("the attempts", function()
  it("are many, behind the first wall alone as well (S7)", function() assert.truthy(total > 2 * 350, total) end)
end)
