-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Runs scenarios: every file is loaded in a process of its own to see what it states, then every scenario
-- in one of its own, so that a crash, a hang or what an earlier one left behind fails that one alone.
-- Answers come in the order of files and lines, however many run side by side.
local core = require "barwright.core"
local files = require "barwright.scenario.files"
local json = require "barwright.json"
local read_file = require "barwright.read_file"
local record = require "barwright.scenario.record"
local text = require "barwright.text"

local run = {}

local max_output = 65536 -- bytes of what a scenario printed that are kept

-- ---- tasks -------------------------------------------------------------------------------------------------

-- How a task ended: {text = what it returned} or {message =, status =, limit =, signal =}.
local function here(task)
  -- what a file's modules are called, others' may be called, too
  local path, loaded = package.path, {}
  for name in pairs(package.loaded) do loaded[name] = true end
  local ok, answer, message = pcall(task.work)
  package.path = path
  for name in pairs(package.loaded) do
    if not loaded[name] and not name:find "^barwright" then package.loaded[name] = nil end
  end
  if ok and answer then return {text = answer} end
  return {status = core.interrupted() and "cancelled" or "failed", message = tostring(ok and message or answer)}
end

local function ended(job)
  local answer, message, details = job:result()
  local out = {seconds = job.seconds, processor = job.processor_seconds, peak_bytes = job.peak_bytes}
  if answer then
    out.text = answer
  else
    details = details or {}
    out.status, out.message, out.limit, out.signal = details.status or "failed", message, details.limit,
      details.signal
  end
  return out
end

-- Runs tasks {work, name, seconds, bytes, output}, up to `parallel` at a time; calls done(i, ending) in
-- their order as early as that is known. nil, message where it was interrupted.
local function all(tasks, parallel, in_process, done)
  local ends, reported = {}, 0
  local function report()
    while ends[reported + 1] do
      reported = reported + 1
      done(reported, ends[reported])
      ends[reported] = true
    end
  end
  if in_process then
    for i, task in ipairs(tasks) do
      ends[i] = here(task)
      if core.interrupted() then return nil, "interrupted" end
      report()
    end
    return true
  end
  local jobs, numbers, next_task = {}, {}, 1
  while next_task <= #tasks or #jobs > 0 do
    while next_task <= #tasks and #jobs < parallel do
      local task = tasks[next_task]
      local job, message, details = core.job(task.work, {name = task.name, seconds = task.seconds,
        bytes = task.bytes, output = task.output})
      if job then
        jobs[#jobs + 1], numbers[#numbers + 1] = job, next_task
      else
        ends[next_task] = {status = details and details.status or "failed", message = message}
      end
      next_task = next_task + 1
    end
    if #jobs > 0 then
      local at, why = core.wait(jobs, 3600)
      if not at and why then
        for _, job in ipairs(jobs) do job:cancel() end
        return nil, why
      end
      if at then
        ends[numbers[at]] = ended(jobs[at])
        table.remove(jobs, at)
        table.remove(numbers, at)
      end
    end
    report()
  end
  report()
  return true
end

-- ---- what files state ----------------------------------------------------------------------------------------

-- Done in the process of the file: the scenarios as plain data, and what is wrong with the file.
local function stated(path)
  local collection, message = files.load(path)
  local list = json.list {}
  for i, one in ipairs(collection.list) do
    list[i] = {title = one.title, line = one.line, tags = json.list(one.tags), skip = one.skip,
      about = one.about, seconds = one.seconds, bytes = one.bytes}
  end
  return json.encode {title = collection.title, text = collection.text, list = list, message = message}
end

local function read_output(path)
  local output = read_file(path)
  if not output or output == "" then return nil end
  if #output > max_output then output = output:sub(1, max_output) .. "\n(the rest was left out)" end
  return text.clean(output)
end

-- A sentence about a process that did not end by itself.
local function because(ending)
  return ending.message or "it ended without a word"
end

--- What the files state: a list of {file, title, text, list = {scenarios}, message}. options: parallel,
--- in_process, seconds, bytes, scratch.
function run.read(paths, options)
  local tasks, found = {}, {}
  for i, path in ipairs(paths) do
    tasks[i] = {work = function() return stated(path) end, name = path, seconds = options.seconds,
      bytes = options.bytes, output = options.scratch .. "/load.out"}
  end
  local ok, why = all(tasks, 1, options.in_process, function(i, ending)
    local read = ending.text and text.clean_all(json.decode(ending.text)) or {list = {}, message = paths[i] .. ": "
      .. because(ending)}
    read.file, found[i] = paths[i], read
  end)
  if not ok then return nil, why end
  return found
end

-- ---- scenarios ------------------------------------------------------------------------------------------------

-- Done in the process of the scenario: the file again, and of it this one.
local function work_of(item, path, options)
  return function()
    local collection, message = files.load(item.file)
    local one = collection.list[item.number]
    if message or not one or text.clean(one.title) ~= item.title then
      return nil, message or item.file .. ": states other scenarios than a moment ago"
    end
    record.run(one, item.file, path, options)
    return "ran"
  end
end

-- The lines that were written, as far as they are whole.
local function lines_of(path)
  local list = {}
  for line in (read_file(path) or ""):gmatch "([^\n]*)\n" do
    local entry = json.decode(line)
    if type(entry) == "table" then list[#list + 1] = text.clean_all(entry) end
  end
  return list
end

local statuses = {time = true, memory = true, crashed = true}

local function finish(item, ending, path)
  local out = {file = item.file, title = item.title, line = item.line, tags = item.tags, about = item.about,
    entries = json.list {}, seconds_run = ending.seconds, seconds_processor = ending.processor,
    memory_bytes = ending.peak_bytes}
  local last
  for _, entry in ipairs(lines_of(path)) do
    if entry.kind == "end" then last = entry else out.entries[#out.entries + 1] = entry end
  end
  if last and ending.text then
    out.status, out.message, out.trace = last.status, last.message, last.trace
    out.at_line = last.line
    out.seconds_run = out.seconds_run or last.seconds_run
  else
    local status = ending.limit or ending.status
    out.status = statuses[status] and status or "error"
    out.message = because(ending)
    local count = 0
    for _, entry in ipairs(out.entries) do count = count + (entry.kind == "expectation" and 1 or 0) end
    if count > 0 then
      out.message = ("%s (after %d expectation%s)"):format(out.message, count, count > 1 and "s" or "")
    end
  end
  return out
end

--- Runs items {file, number, title, line, tags, skip, about, seconds, bytes}; calls done(i, result) in
--- their order. options: parallel, in_process, seconds, bytes, scratch, update, pictures, all_pictures. The
--- list of results, and why it is not whole.
function run.items(items, options, done)
  local tasks, numbers, results = {}, {}, {}
  local reported = 0
  local function report()
    while results[reported + 1] do
      reported = reported + 1
      done(reported, results[reported])
    end
  end
  for i, item in ipairs(items) do
    if item.message then
      results[i] = {file = item.file, title = item.title, tags = json.list {}, entries = json.list {},
        status = "error", message = item.message, line = item.line}
    elseif item.skip then
      results[i] = {file = item.file, title = item.title, line = item.line, tags = item.tags, about = item.about,
        entries = json.list {}, status = "skipped", message = item.skip ~= true and item.skip or nil}
    else
      local stem = ("%s/%04d"):format(options.scratch, i)
      tasks[#tasks + 1] = {work = work_of(item, stem .. ".lines", {update = options.update,
        pictures = options.pictures, all_pictures = options.all_pictures, stem = ("%04d"):format(i)}),
        name = item.title, seconds = item.seconds or options.seconds, bytes = item.bytes or options.bytes,
        output = stem .. ".out"}
      numbers[#tasks] = i
    end
  end
  report()
  local ok, why = all(tasks, options.parallel, options.in_process, function(k, ending)
    local i = numbers[k]
    local stem = ("%s/%04d"):format(options.scratch, i)
    results[i] = finish(items[i], ending, stem .. ".lines")
    results[i].output = read_output(stem .. ".out")
    report()
  end)
  -- interrupted: those that ended, in their order
  local ended_ones = {}
  for i = 1, #items do ended_ones[#ended_ones + 1] = results[i] end
  return ended_ones, not ok and why or nil
end

return run
