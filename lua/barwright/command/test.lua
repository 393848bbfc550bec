-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright test: scenarios of files and folders, checked, reported as TAP, kept as JUnit, JSON and a page.
local core = require "barwright.core"
local files = require "barwright.scenario.files"
local json = require "barwright.json"
local junit = require "barwright.scenario.junit"
local manual = require "barwright.scenario.manual"
local output = require "barwright.command.output"
local page = require "barwright.scenario.page"
local read_file = require "barwright.read_file"
local results = require "barwright.results"
local run = require "barwright.scenario.run"
local tap = require "barwright.scenario.tap"

local function words(text)
  local list = {}
  for word in (text or ""):gmatch "[^,%s]+" do list[#list + 1] = word end
  return list
end

local function has_any(tags, wanted)
  for _, tag in ipairs(tags) do
    for _, word in ipairs(wanted) do
      if tag == word then return true end
    end
  end
  return false
end

-- What is to run, in order; a file with a fault is an item of its own, whatever is asked for.
local function select_from(found, opts)
  local items, total, tags = {}, 0, {}
  local with, without = words(opts.tag), words(opts.skip_tag)
  for _, file in ipairs(found) do
    for number, one in ipairs(file.message and {} or file.list) do
      total = total + 1
      for _, tag in ipairs(one.tags) do tags[tag] = true end
      local wanted = (not opts.only or (file.file .. ": " .. one.title):find(opts.only, 1, true))
        and (#with == 0 or has_any(one.tags, with)) and not has_any(one.tags, without)
      if wanted then
        one.file, one.number = file.file, number
        items[#items + 1] = one
      end
    end
    if file.message then
      items[#items + 1] = {file = file.file, title = "the file", message = file.message,
        line = tonumber(file.message:match(":(%d+):"))}
    end
  end
  local known = {}
  for tag in pairs(tags) do known[#known + 1] = tag end
  table.sort(known)
  return items, total, known
end

local function nothing(opts, total, known)
  local parts = {}
  for _, name in ipairs {"only", "tag", "skip_tag"} do
    if opts[name] then parts[#parts + 1] = ("--%s %s"):format((name:gsub("_", "-")), opts[name]) end
  end
  return ("none of %d scenarios is asked for by %s%s"):format(total, table.concat(parts, " "),
    #known > 0 and (" (tags: %s)"):format(table.concat(known, ", ")) or "")
end

local function count(list)
  local sums = {passed = 0, failed = 0, skipped = 0}
  for _, result in ipairs(list) do
    local kind = sums[result.status] and result.status or "failed"
    sums[kind] = sums[kind] + 1
  end
  return sums
end

-- What of an earlier run is taken where this one leaves scenarios out.
local function earlier(path, list, about)
  local text, why = read_file(path)
  local read = text and json.decode(text)
  if type(read) ~= "table" or type(read.scenarios) ~= "table" or type(read.files) ~= "table" then
    return nil, why or path .. ": not the result.json of `barwright test`"
  end
  local have, seen = {}, {}
  for _, result in ipairs(list) do have[tap.name_of(result)] = true end
  for _, file in ipairs(about) do seen[file.file] = file end
  for _, file in ipairs(read.files) do
    if not seen[file.file] then
      about[#about + 1] = file
      seen[file.file] = file
    end
  end
  for _, result in ipairs(read.scenarios) do
    if not have[tap.name_of(result)] then list[#list + 1] = result end
  end
  table.sort(about, function(a, b) return a.file < b.file end)
  local order = {}
  for i, result in ipairs(list) do order[result] = i end
  table.sort(list, function(a, b)
    if a.file ~= b.file then return a.file < b.file end
    if (a.line or 0) ~= (b.line or 0) then return (a.line or 0) < (b.line or 0) end
    return order[a] < order[b]
  end)
  local folder = files.split(path)
  local manifest = read_file(folder .. "/manifest.json")
  return manifest and json.decode(manifest) or {version = "unknown"}
end

-- The files of the output folder.
local function keep(opened, summary)
  local ok, message = opened:write(summary)
  if not ok then return nil, message end
  ok, message = core.write_file(opened:path "junit.xml", junit.document(summary.scenarios))
  if not ok then return nil, message end
  return core.write_file(opened:path "index.html", page.document(summary, opened.manifest,
    opened:path "pictures"))
end

local function options_of(opts)
  return {only = opts.only, tag = opts.tag, skip_tag = opts.skip_tag, parallel = opts.parallel,
    seconds = opts.seconds, memory = opts.memory, update = opts.update or nil}
end

local function open(opts, paths)
  if not opts.out then return nil end
  local opened, message = results.open(opts.out, {inputs = paths, options = options_of(opts)})
  if not opened then return nil, message end
  -- pictures of the run before, and nothing else
  local before = read_file(opened:path "result.json")
  for _, result in ipairs(before and (json.decode(before) or {}).scenarios or {}) do
    for _, entry in ipairs(result.entries) do
      if entry.kind == "picture" then os.remove(opened:path("pictures/" .. entry.file)) end
    end
  end
  local ok
  ok, message = files.make_folder(opened:path "pictures")
  if not ok then return nil, message end
  return opened
end

-- Runs and reports; the list of results, and why it is not whole.
local function run_items(items, opts, out, options)
  io.stdout:setvbuf "line"
  out:say(tap.plan(#items))
  return run.items(items, options, function(i, result)
    for _, line in ipairs(tap.lines(i, result, opts.verbose)) do out:say(line) end
  end)
end

local function write_manual(opts, summary, manifests)
  if not opts.manual then return true end
  local command = {"barwright test", table.concat(opts.scenarios, " ")}
  for _, name in ipairs {"only", "tag", "skip_tag"} do
    if opts[name] then command[#command + 1] = ("--%s %s"):format((name:gsub("_", "-")), opts[name]) end
  end
  command[#command + 1] = "--manual " .. opts.manual
  return core.write_file(opts.manual, manual.document(summary, table.concat(command, " "), manifests))
end

-- What is kept of a run: its scenarios, and the files that they are of.
local function summary_of(list, found)
  local sums, ran, about = count(list), {}, json.list {}
  for _, result in ipairs(list) do ran[result.file] = true end
  for _, file in ipairs(found) do
    if ran[file.file] then about[#about + 1] = {file = file.file, title = file.title, text = file.text} end
  end
  return {passed = sums.passed, failed = sums.failed, skipped = sums.skipped, scenarios = json.list(list),
    files = about}
end

-- Puts in what earlier runs found; the manifests of all, or nil and why not.
local function add_earlier(opts, summary, opened)
  local manifests = {opened and opened.manifest or results.surroundings()}
  for _, path in ipairs(words(opts.with)) do
    local manifest, message = earlier(path, summary.scenarios, summary.files)
    if not manifest then return nil, message end
    manifests[#manifests + 1] = manifest
  end
  return manifests
end

-- The scenarios that are asked for, what their files state, and where results go; or nil and the exit code.
local function prepared(opts, out, scratch)
  local paths, message, details = files.find(opts.scenarios)
  if not paths then return nil, details and out:fail(message, details) or out:misuse(message) end
  local opened
  opened, message = open(opts, paths)
  if message then return nil, out:misuse(message) end
  local options = {parallel = opts.parallel, in_process = opts.in_process, seconds = opts.seconds,
    bytes = opts.memory, scratch = scratch, update = opts.update, pictures = opened and opened:path "pictures",
    all_pictures = opts.all_pictures}
  local found
  found, message = run.read(paths, options)
  if not found then return nil, out:fail(message, {status = "cancelled"}) end
  local items, total, known = select_from(found, opts)
  if #items == 0 then return nil, out:misuse(nothing(opts, total, known)) end
  return {items = items, found = found, opened = opened, options = options}
end

local function work(opts, out, scratch)
  local ready, code = prepared(opts, out, scratch)
  if not ready then return code end
  local opened = ready.opened
  local list, interrupted = run_items(ready.items, opts, out, ready.options)
  local summary = summary_of(list, ready.found)
  local manifests, message = add_earlier(opts, summary, opened)
  if not manifests then return out:misuse(message) end
  out:json(summary)
  local ok = true
  if opened then ok, message = keep(opened, summary) end
  if ok and interrupted then
    return out:fail(("interrupted; %d of %d scenarios have run"):format(#list, #ready.items),
      {status = "cancelled"})
  end
  if ok then ok, message = write_manual(opts, summary, manifests) end
  if not ok then return out:fail(message) end
  out:say(("# %d passed, %d failed, %d skipped%s"):format(summary.passed, summary.failed, summary.skipped,
    opened and (": " .. opened:path "index.html") or ""))
  return summary.failed > 0 and output.NO or output.DONE
end

return {
  summary = "run scenarios: scripts that check requirements",
  about = "Each scenario of the files and folders runs in a process of its own. Results are printed as TAP; with\n"
    .. "--out they are kept as junit.xml, result.json, index.html and pictures of what failed. Files in\n"
    .. "folders named lib are helpers; baselines lie in folders named baselines beside the files.",
  arguments = {{name = "scenarios", what = "files or folders of scenarios", many = true}},
  options = {
    {name = "only", value = "TEXT", type = "string", what = "scenarios whose file or title holds the text"},
    {name = "tag", value = "NAMES", type = "string", what = "scenarios with one of these tags"},
    {name = "skip-tag", value = "NAMES", type = "string", what = "scenarios with none of these tags"},
    {name = "parallel", value = "N", type = "integer", default = 1, min = 1, what = "so many side by side"},
    {name = "seconds", value = "TIME", type = "number", unit = "s", default = 600, above = 0,
      what = "time for one scenario that names no limit of its own"},
    {name = "memory", value = "SIZE", type = "number", unit = "bytes", above = 0,
      what = "memory for one scenario that names no limit of its own"},
    {name = "update", type = "flag", what = "write baselines that are missing or do not fit any more"},
    {name = "out", value = "FOLDER", type = "folder", what = "where results are kept"},
    {name = "manual", value = "FILE", type = "file", what = "write a manual of all figures in Markdown"},
    {name = "with", value = "FILES", type = "string",
      what = "results of earlier runs (result.json) for what this one leaves out, in manual and page"},
    {name = "all-pictures", type = "flag", what = "draw the pictures of scenarios that pass, too"},
    {name = "verbose", type = "flag", what = "report the expectations that were met, too"},
    {name = "in-process", type = "flag", what = "one after the other in this process, without limits"},
  },
  examples = {"barwright test scenarios/", "barwright test scenarios/ --skip-tag slow --parallel 2 --out result",
    "barwright test scenarios/bracket.lua --update"},
  run = function(opts, out)
    local scratch = files.scratch()
    local ok, code = xpcall(work, debug.traceback, opts, out, scratch)
    files.remove_scratch(scratch)
    if not ok then error(code, 0) end
    return code
  end,
}
