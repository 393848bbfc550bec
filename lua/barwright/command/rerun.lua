-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright rerun MANIFEST: runs an experiment again from what its manifest says, into a new folder, and
-- says which of its numbers are others.
local core = require "barwright.core"
local differences = require "barwright.experiment.differences"
local files = require "barwright.scenario.files"
local json = require "barwright.json"
local output = require "barwright.command.output"
local read_file = require "barwright.read_file"
local results = require "barwright.results"
local shown = require "barwright.shown"

local max_listed = 40

-- nil, message where a file cannot be read as a JSON object.
local function read_json(path)
  local text, why = read_file(path)
  if not text then return nil, why end
  local value, message = json.decode(text)
  if type(value) ~= "table" then return nil, ("%s: %s"):format(path, message or "an object expected") end
  return value
end

local function trimmed(folder)
  return (folder:gsub("(.)/+$", "%1"))
end

-- A path below a folder, or the folder itself ("").
local function below(path, folder)
  path, folder = trimmed(path), trimmed(folder)
  if path == folder then return "" end
  if path:sub(1, #folder + 1) == folder .. "/" then return path:sub(#folder + 1) end
end

-- The word that names the folder of the run: its place, what stands before the folder in it, and where the
-- folder is below what it names. --out counts first, then a word that is the folder, then one above it.
local function folder_word(manifest)
  local words, named = manifest.started_by, {}
  for i = 2, #words do
    local joined = words[i]:match "^%-%-out=(.*)$"
    local value = joined or words[i]
    local inner = below(manifest.folder, value)
    if inner and (joined or words[i - 1] == "--out") then return i, joined and "--out=" or "", inner end
    if inner then table.insert(named, inner == "" and 1 or #named + 1, {i, inner}) end
  end
  if named[1] then return named[1][1], "", named[1][2] end
end

-- The words of the run with the new folder in place of the old one, and where below it the result is.
local function redirected(manifest, folder)
  local words = table.move(manifest.started_by, 1, #manifest.started_by, 1, {})
  local at, before, inner = folder_word(manifest)
  if at then
    words[at] = before .. folder
    return words, inner
  end
  if #words == 1 then -- a script with a folder of its own choice
    words[2] = folder
    return words, ""
  end
  return words, nil
end

local function free_folder(folder)
  local base = trimmed(folder) .. ".again"
  local path, n = base, 1
  while files.kind(path) do
    n = n + 1
    path = base .. n
  end
  return path
end

-- What of the inputs is missing or changed, as sentences.
local function check_inputs(manifest)
  local faults = {}
  for _, input in ipairs(manifest.inputs or {}) do
    local digest, message = core.sha256(input.file)
    if not digest then
      faults[#faults + 1] = message .. (input.file:sub(1, 1) == "/" and ""
        or " from here; was the run started in another folder?")
    elseif digest ~= input.sha256 then
      faults[#faults + 1] = ("%s: is not the file it was: its SHA-256 is %s, %s expected"):format(input.file,
        digest, tostring(input.sha256))
    end
  end
  return faults
end

-- What is another than it was, as {what, before, now}.
local function surroundings(manifest)
  local list = {}
  local function compare(what, before, now)
    before, now = before ~= json.null and before or nil, now ~= json.null and now or nil
    if before ~= nil and before ~= now then
      list[#list + 1] = {what = what, before = tostring(before), now = tostring(now)}
    end
  end
  local now = results.surroundings()
  compare("version", manifest.version, now.version)
  compare("commit", manifest.commit, now.commit)
  compare("script", manifest.script_sha256, manifest.started_by[1] and core.sha256(manifest.started_by[1]))
  for _, one in ipairs(manifest.required or {}) do
    compare("module " .. one.module, one.sha256, core.sha256(one.file) or "not there")
  end
  local seen = {}
  for _, line in ipairs(now.libraries) do seen[line:match "^%S+" or line] = line end
  for _, line in ipairs(manifest.libraries or {}) do
    local name = line:match "^%S+" or line
    compare("library " .. name, line, seen[name] or "not there")
  end
  compare("threads", manifest.threads, now.threads)
  for _, key in ipairs {"processor", "processors", "memory_bytes", "system"} do
    compare(key:gsub("_", " "), (manifest.machine or {})[key], now.machine[key])
  end
  return list
end

-- Runs the words in this program; what it prints goes to a file. The exit status.
local function run(words, log)
  local pipe = assert(io.popen "readlink /proc/$PPID/exe")
  local program = pipe:read "l"
  pipe:close()
  local line = {files.quoted(program)}
  for i, word in ipairs(words) do line[i + 1] = files.quoted(word) end
  local _, how, code = os.execute(("%s >%s 2>&1 </dev/null"):format(table.concat(line, " "), files.quoted(log)))
  return how == "exit" and code or 128 + code
end

local function report(out, title, list, max)
  if #list == 0 then return end
  out:say(title)
  for i, entry in ipairs(list) do
    if i > max then
      out:say("  and %d more", #list - max)
      break
    end
    out:say("  %s: %s, was %s%s", entry.path, differences.show(entry.after), differences.show(entry.before),
      entry.relative and ", apart by " .. shown.percent(entry.relative) or "")
  end
end

local function plain(list)
  local rows = json.list {}
  for i, entry in ipairs(list) do
    rows[i] = {path = entry.path, before = entry.before, after = entry.after, relative = entry.relative}
  end
  return rows
end

local function prepared(opts, out)
  if files.kind(opts.manifest) == "folder" then opts.manifest = trimmed(opts.manifest) .. "/manifest.json" end
  local manifest, message = read_json(opts.manifest)
  if not manifest then return nil, out:fail(message) end
  if type(manifest.started_by) ~= "table" or not manifest.started_by[1] or type(manifest.folder) ~= "string" then
    return nil, out:misuse(opts.manifest .. ": does not say what was run: no manifest, or of an earlier version")
  end
  local before
  before, message = read_json(files.split(opts.manifest) .. "/result.json")
  if not before then return nil, out:fail(message) end
  local faults = check_inputs(manifest)
  if #faults > 0 then
    for i = opts.anyway and 1 or 2, #faults do out:say(faults[i]) end -- the first is in what follows
    out:json {inputs = json.list(faults)}
    if not opts.anyway then
      return nil, out:fail(("%d of %d inputs are missing or changed: %s (--anyway runs it with what is there)")
        :format(#faults, #manifest.inputs, faults[1]), {status = "invalid"})
    end
  end
  return manifest, before
end

local function work(opts, out)
  local manifest, before = prepared(opts, out)
  if not manifest then return before end
  local folder = opts.out or free_folder(manifest.folder)
  local words, place = redirected(manifest, folder)
  if not place then
    return out:fail(("the run does not name its folder %s among its words: %s"):format(manifest.folder,
      table.concat(words, " ")))
  end
  local made, message = files.make_folder(folder)
  if not made then return out:fail(message) end
  local changed = surroundings(manifest)
  for _, entry in ipairs(changed) do
    local what = entry.what == "script" and ("script %s: SHA-256"):format(words[1]) or entry.what .. ":"
    out:say("%s %s, was %s", what, entry.now, entry.before)
  end
  out:say("barwright %s", table.concat(words, " "))
  local start = core.seconds()
  local status = run(words, folder .. "/rerun.log")
  if core.interrupted() then return out:fail("interrupted", {status = "cancelled"}) end
  local after
  after, message = read_json(folder .. place .. "/result.json")
  if not after then
    return out:fail(("the run ended with exit status %d and without a result: %s (it printed %s)"):format(status,
      message, folder .. "/rerun.log"))
  end
  -- texts may name the folder
  local old = trimmed(manifest.folder):gsub("%p", "%%%0")
  local new = (folder .. place):gsub("%%", "%%%%")
  local found = differences.of(before, after, {tolerance = opts.tolerance, same = function(a, b)
    return (a:gsub(old, new)) == b
  end})
  out:say("it took %.1f s; %d values compared", core.seconds() - start, found.count)
  report(out, ("different as the clock and the machine decide: %d"):format(#found.timings), found.timings,
    opts.verbose and math.huge or 5)
  report(out, ("different: %d"):format(#found.differences), found.differences,
    opts.verbose and math.huge or max_listed)
  out:say(#found.differences == 0 and "the same" or "not the same")
  out:json {same = #found.differences == 0, compared = found.count, folder = folder, exit_status = status,
    differences = plain(found.differences), timings = plain(found.timings), surroundings = json.list(changed)}
  return #found.differences == 0 and output.DONE or output.NO
end

return {
  summary = "run an experiment again and say which numbers are others",
  about = "A folder of results has manifest.json, which says what was run, and result.json. The same words are "
    .. "run again into a new folder, from the folder you are in: relative paths mean what they meant there. "
    .. "Inputs must be the same files; other versions, libraries and machines are reported.",
  arguments = {{name = "manifest", type = "file", what = "the manifest.json of the run, or its folder"}},
  options = {
    {name = "out", value = "FOLDER", type = "folder", what = "where the new run goes (default: FOLDER.again)"},
    {name = "tolerance", value = "FRACTION", type = "number", default = 0, min = 0,
      what = "numbers that are apart by no more than this fraction of themselves are the same"},
    {name = "verbose", type = "flag", what = "list all that is other, however much it is"},
    {name = "anyway", type = "flag", what = "run it although inputs are missing or changed"},
  },
  examples = {"barwright rerun result/manifest.json"},
  run = work,
}
