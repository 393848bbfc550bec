-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Kills runs at random moments by SIGKILL, and runs them again: nothing is lost, the end is that of an undisturbed
-- run, and no file is left behind.
--   build/barwright tests/fuzz/kills.lua [--kills N] [--seed S] [--only NAME] [--keep]
-- The kills (12) go round over a study with files and a cache of its own, a library with a checkpoint, the worst
-- command, and scripts/reproduce. Ends with status 1 where one of them finds something.
local core = require "barwright.core"

local root = arg[0]:match "^(.*)/tests/fuzz/[^/]*$" or "."
local opts, i = {kills = 12, seed = 1}, 1
while arg[i] do
  local name = arg[i]:match "^%-%-(%l+)$"
  if name == "keep" then
    opts.keep = true
  elseif name == "only" then
    i = i + 1
    opts.only = arg[i]
  elseif opts[name or ""] and tonumber(arg[i + 1]) then
    i = i + 1
    opts[name] = math.tointeger(tonumber(arg[i]))
  else
    error(("kills: unknown option '%s': see the head of tests/fuzz/kills.lua"):format(arg[i]), 0)
  end
  i = i + 1
end

local function quoted(text) return "'" .. text:gsub("'", "'\\''") .. "'" end

local function output_of(command)
  local pipe <close> = assert(io.popen(command))
  return pipe:read "a"
end

local here = output_of "pwd":gsub("\n$", "")
if root:sub(1, 1) ~= "/" then root = here .. "/" .. root end
local program = root .. "/build/barwright"

local function read(path)
  local file <close> = io.open(path, "rb")
  return file and file:read "a"
end

-- ---- what is run ---------------------------------------------------------------------------------------

local study = [[
local bw = require "barwright"
local core = require "barwright.core"
local study = bw.study {name = "killed", seed = 3, cache = {folder = "cache"},
  variables = {{name = "x", min = -1, max = 1}}, measures = {"y", "r"}, design = {"random", count = 150},
  run = function(point, trial)
    local box = trial:cached({"box", trial.number % 7}, function()
      return bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1 + trial.number % 7}, cells = {6, 6, 6}}
    end)
    assert(core.write_file(trial.folder .. "/text", ("x"):rep(100000) .. trial.key))
    return {y = point.x * box.volume, r = trial:random()}
  end}
assert(#assert(study:run {workers = 2}) == 150)
]]

local library = [[
local bw = require "barwright"
local materials = {}
for k, modulus in ipairs {1e5, 1e6} do
  materials[k] = bw.hyperelastic {young = modulus, poisson = 0.4}
end
local made = assert(bw.metamaterial.build(materials, {directions = 12, magnitudes = 1, stretches = 20,
  voids = false, seed = 3, checkpoint = "two.bwm.checkpoint"}))
assert(made:write "two.bwm")
os.remove "two.bwm.checkpoint"
]]

local function rows(path)
  local db <close> = core.database(path, {read_only = true})
  if not db or #(db:rows "SELECT name FROM sqlite_master WHERE name = 'results'" or {}) == 0 then return {} end
  return db:rows("SELECT t.number, t.key, t.attempts, p.x, r.y, r.r FROM trials t JOIN points p"
    .. " ON p.number = t.number JOIN results r ON r.number = t.number ORDER BY t.number") or {}
end

local function size_of(path)
  local file <close> = io.open(path, "rb")
  return file and file:seek "end" or 0
end

-- Each: its script where it has one, the command, how far it is (what may not become less), and what must be the
-- same at its end.
local works = {
  {name = "study", script = study, command = "%s script.lua", progress = function(folder)
    return #rows(folder .. "/killed.study")
  end, result = function(folder)
    local out = {}
    for k, row in ipairs(rows(folder .. "/killed.study")) do
      out[k] = ("%d %s %d %.17g %.17g %.17g"):format(row.number, row.key, row.attempts, row.x, row.y, row.r)
    end
    return table.concat(out, "\n")
  end},
  {name = "library", script = library, command = "%s script.lua", progress = function(folder)
    if read(folder .. "/two.bwm") then return math.maxinteger end
    return size_of(folder .. "/two.bwm.checkpoint") // 1024 -- a record that was cut short is cut off
  end, result = function(folder) return read(folder .. "/two.bwm") end},
  {name = "worst", script = [[
    local bw = require "barwright"
    assert(assert(bw.surface.box {min = {0, 0, 0}, max = {0.08, 0.01, 0.01}}):write "part.stl")]],
    command = "%s worst part.stl --unit m --elements 1500 --modes 3 --regions 1 --quiet --out out",
    result = function(folder) return read(folder .. "/out/worst.vtu") end},
  {name = "reproduce", at_root = true,
    command = "%s scripts/reproduction/run.lua --quick --only responsive_thermal --out %s/out",
    result = function(folder)
      local text = read(folder .. "/out/quick/responsive_thermal/part.json")
      return text and text:match '"status": "done"'
    end},
}

-- ---- runs ----------------------------------------------------------------------------------------------

local base = assert(core.temporary_folder())

-- Runs a command in a session of its own; after `delay` seconds (nil: never) its first process is killed. Waits
-- until all of its processes are gone. The exit status, and what it said.
local function run(work, folder, delay)
  local said = folder .. ".said"
  -- behind a process's name: state, parent, group, session
  local alive = [[cat /proc/[0-9]*/stat 2>/dev/null | sed 's/.*) //' | awk -v s=$p ]]
    .. [['$4 == s && $1 != "Z" {n++} END {exit n == 0}']]
  local ending = delay and ("sleep %.4f; kill -9 $p 2>/dev/null;"):format(delay) or ""
  local _, _, code = os.execute(("cd %s; BARWRIGHT_QUIET=1 setsid %s >%s 2>&1 </dev/null & p=$!; %s "
    .. "wait $p 2>/dev/null; code=$?; while %s; do sleep 0.01; done; exit $code"):format(
    quoted(work.at_root and root or folder), work.command:format(quoted(program), quoted(folder)),
    quoted(said), ending, alive))
  return code, read(said) or ""
end

local function new_folder(work, name)
  local folder = ("%s/%s-%s"):format(base.path, work.name, name)
  assert(core.make_folder(folder))
  if work.script then
    assert(core.write_file(folder .. "/script.lua", work.script))
    if work.name == "worst" then
      assert(os.execute(("cd %s && %s script.lua"):format(quoted(folder), quoted(program))))
    end
  end
  return folder
end

local function files_in(folder)
  return output_of(("cd %s && find . -type f | LC_ALL=C sort"):format(quoted(folder)))
end

-- What is in one list of lines and not in the other.
local function more(list, other)
  local there, out = {}, {}
  for line in other:gmatch "[^\n]+" do there[line] = true end
  for line in list:gmatch "[^\n]+" do
    if not there[line] then out[#out + 1] = line end
  end
  return table.concat(out, " ")
end

local state = opts.seed
local function random()
  state = (state * 1103515245 + 12345) % 2147483648
  return state / 2147483648
end

local faults, killed, inside = 0, 0, 0
local function fault(work, text, ...)
  faults = faults + 1
  print(("%s: %s"):format(work.name, text:format(...)))
end

-- Some kills of one run, then the end of it.
local function torture(work, whole, count, name)
  local folder, progress = new_folder(work, name), 0
  for _ = 1, count do
    local delay = random() * 0.95 * whole.seconds / (work.progress and count or 1)
    local code, said = run(work, folder, delay)
    killed = killed + 1
    if code == 137 then inside = inside + 1 elseif code ~= whole.code then
      fault(work, "status %d: %s", code, said)
    end
    local now = work.progress and work.progress(folder) or 0
    if now < progress then fault(work, "%d after a kill, %d before", now, progress) end
    progress = now
    local made = not work.progress and work.result(folder)
    if made and work.name == "worst" and made ~= whole.result then fault(work, "a part of a result") end
  end
  local code, said = run(work, folder)
  if code ~= whole.code then fault(work, "status %d, undisturbed %d: %s", code, whole.code, said) end
  if work.result(folder) ~= whole.result then fault(work, "another result than that of an undisturbed run") end
  local files = files_in(folder)
  if files ~= whole.files then
    fault(work, "left behind: %s; missing: %s", more(files, whole.files), more(whole.files, files))
  end
end

local chosen = {}
for _, work in ipairs(works) do
  if not opts.only or work.name == opts.only then chosen[#chosen + 1] = work end
end
for k, work in ipairs(chosen) do
  local start = core.seconds()
  local folder = new_folder(work, "whole")
  local whole = {}
  whole.code = run(work, folder)
  whole.seconds, whole.result, whole.files = core.seconds() - start, work.result(folder), files_in(folder)
  if not whole.result then
    fault(work, "the undisturbed run gave nothing: %s", read(folder .. ".said"))
  else
    local left = opts.kills // #chosen + (k <= opts.kills % #chosen and 1 or 0)
    local round, before = 0, killed
    while left > 0 do -- five kills, then a folder of its own again
      round = round + 1
      torture(work, whole, math.min(left, 5), tostring(round))
      left = left - 5
    end
    print(("%s: %d kills, %.1f s undisturbed"):format(work.name, killed - before, whole.seconds))
  end
end
print(("%d kills, %d of them before the end; %d faults"):format(killed, inside, faults))
if opts.keep then print(base.path) else base:close() end
os.exit(faults == 0 and killed == opts.kills, not opts.keep)
