-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Batches of calls in forked children of a process that has made the objects: what they say, what ended them, and
-- which call makes it again.
local bw = require "barwright"
local call = require "call"
local core = require "barwright.core"
local entries = require "entries"
local files = require "files"
local new_pool = require "fixtures"
local record = require "barwright.scenario.record"
local values = require "values"

local batch_size = 250
local bytes = 3e9 -- that a batch may take
local hang_seconds = 60 -- of processor time, or five times as long on the clock, that a call may take

-- Overwrites what earlier calls left on Lua's stack: the collector takes it for objects in use.
local wipe = load("local function wipe(n) local " .. ("a, "):rep(180) .. "a if n > 0 then wipe(n - 1) end end "
  .. "return wipe")()

-- Blocks of memory that the engine holds when nothing is in use.
local function blocks()
  bw.warnings()
  bw.threads(1)
  wipe(8)
  local allocated, same = -1, 0
  repeat -- an object that only another one holds goes a cycle after it
    collectgarbage()
    local now = select(2, core.external())
    same = now == allocated and same + 1 or 0
    allocated = now
  until same == 3
  return allocated
end

local at_rest, with_objects -- without objects, and with those that the parent made

-- Whether more are allocated once all objects are let go.
local function leak(pool, what)
  pool:drop()
  local allocated = blocks()
  if allocated <= at_rest then return nil end
  local more = allocated - at_rest
  at_rest = allocated
  return {name = "memory", finding = "leaves memory behind", text = what,
    message = ("%d blocks; --leaks names the call"):format(more)}
end

-- ---- the child ----------------------------------------------------------------------------------

-- Calls first to last; what it returns is read by the parent.
local function work(opts, pool, first, last, log)
  local counts, findings, longest = {}, {}, {seconds = 0}
  log:setvbuf "no"
  local stat = io.open "/proc/self/stat"
  log:write("process ", stat:read "n", "\n")
  stat:close()
  for number = first, last do
    local one = call.make(opts.seed, number, pool, opts.seconds, function(text)
      log:write(("%d %s\n"):format(number, text))
    end)
    local count = counts[one.name] or {done = 0, failed = 0, raised = 0, late = 0, seconds = 0}
    counts[one.name] = count
    count.seconds = count.seconds + one.seconds
    count[one.outcome] = count[one.outcome] + 1
    if one.seconds > longest.seconds then longest = {seconds = one.seconds, number = number,
      text = one.text} end
    if one.finding then
      findings[#findings + 1] = {number = number, name = one.name, finding = one.finding, message = one.message,
        text = one.text}
    end
    if opts.call then
      print(("%s\n  %s after %.3f s%s"):format(one.text, one.outcome, one.seconds,
        one.message and ": " .. tostring(one.message) or ""))
    end
    if one.finding == "leaves the engine busy" then break end
    local kept = opts.leaks and leak(pool, one.text)
    if kept then
      kept.number, kept.name = number, one.name
      findings[#findings + 1] = kept
    end
  end
  log:write "end\n"
  return {counts = counts, findings = bw.json.list(findings), longest = longest}
end

-- The child works inside of a scenario, so that there are expectations.
local function start(opts, pool, slot, first, last, log_name)
  local log = assert(io.open(log_name, "wb"))
  local job = assert(core.job(function()
    local result, why
    files.begin(slot)
    pool.expect = bw.scenario.expect
    record.run({title = "fuzz", work = function(t)
      pool.test = t
      at_rest = at_rest + blocks() - with_objects -- the jobs are the parent's
      bw.threads(1 + first // batch_size % 2)
      local ok
      ok, result = xpcall(work, debug.traceback, opts, pool, first, last, log)
      if not ok then result, why = nil, "the fuzzer's own error: " .. result end
    end}, "fuzz.lua", log_name .. ".record", {})
    if not result then return nil, why end
    pool.expect, pool.test = nil, nil
    local kept = leak(pool, ("calls %d to %d"):format(first, last))
    if kept then
      kept.number = last
      table.insert(result.findings, kept)
    end
    return bw.json.encode(result)
  end, {name = "calls from " .. first, output = log_name .. ".out", bytes = bytes}))
  log:close()
  return {job = job, slot = slot, first = first, last = last, log_name = log_name, grown = core.seconds(),
    size = 0}
end

-- ---- the parent ---------------------------------------------------------------------------------

local function read(path)
  local file = io.open(path, "rb")
  local text = file and file:read "a" or ""
  if file then file:close() end
  return text
end

-- Processor seconds of a process and its children that have ended.
local function processor_seconds(process)
  local file = io.open("/proc/" .. process .. "/stat")
  local text = file and file:read "a"
  if file then file:close() end
  local fields = {}
  for word in (text or ""):gsub("^.*%)", ""):gmatch "%S+" do fields[#fields + 1] = tonumber(word) or 0 end
  return fields[15] and (fields[12] + fields[13] + fields[14] + fields[15]) / 100 or 0
end

local function last_line(log_name)
  local text = read(log_name)
  return text:match "([^\n]*)\n[^\n]*$" or text, text:match "^process (%d+)"
end

-- Ends a batch whose call neither ended nor could be ended.
local function watch(batch)
  local file = io.open(batch.log_name)
  local size = file and file:seek "end" or 0
  if file then file:close() end
  local now = core.seconds()
  if size ~= batch.size then
    local _, process = last_line(batch.log_name)
    batch.size, batch.grown, batch.process = size, now, process
    batch.spent = process and processor_seconds(process) or 0
  elseif batch.process and (processor_seconds(batch.process) - batch.spent > hang_seconds
    or now - batch.grown > 5 * hang_seconds) then
    batch.hangs = true
    batch.job:cancel()
  end
end

-- What is the same in two findings of the same defect.
local function signature(finding)
  local text = tostring(finding.message or "")
  local place = text:match "lua/barwright/[%w_/]+%.lua:%d+:[^\n]*"
  if not place then place = finding.name .. ": " .. text end
  return finding.finding .. " " .. place:gsub("0x%x+", ""):gsub("'[^']*'", ""):sub(1, 120)
end

local function crash(batch, message)
  local line = last_line(batch.log_name)
  local number, text = line:match "^(%d+) (.*)$"
  local output = read(batch.log_name .. ".out")
  local report = output:match "[^\n]*ERROR: %w+Sanitizer.*" or output:match "[^\n]*runtime error:.*"
  local place = (report or ""):match "#%d+ 0x%x+ in ([%w_]+ /[^\n]*/engine/[^\n]*)"
    or (report or ""):match "#%d+ 0x%x+ in ([%w_]+ /[^\n]*/lua/bind/[^\n]*)"
  return {number = tonumber(number) or batch.first, text = text or line, name = (text
    or line):match "%S*[:.]%S*%(" or line,
    finding = batch.hangs and "does not end" or "ends the process",
    message = message .. (place and ": " .. place or "") .. (report and "\n" .. report:sub(1, 3000) or "\n"
      .. output:sub(-1500))}
end

local function add(into, result)
  for name, count in pairs(result.counts) do
    local sum = into.counts[name] or {done = 0, failed = 0, raised = 0, late = 0, seconds = 0}
    into.counts[name] = sum
    for key, n in pairs(count) do sum[key] = sum[key] + n end
  end
  for _, finding in ipairs(result.findings) do into.findings[#into.findings + 1] = finding end
  if result.longest.seconds > into.longest.seconds then into.longest = result.longest end
end

local function report(opts, batch, finding, seen)
  local key = signature(finding)
  seen[key] = (seen[key] or 0) + 1
  if seen[key] > 1 then return end
  io.stdout:write(("FOUND %s: %s\n  %s\n  again: --seed %d --call %d%s (or with --from %d)\n"):format(finding.text,
    finding.finding, tostring(finding.message):gsub("\n", "\n  "), opts.seed, finding.number,
    opts.only and " --only " .. opts.only or "", batch.first))
  io.stdout:flush()
end

local function finish(opts, batch, sum, seen)
  local text, message = batch.job:result()
  if text then
    local result = bw.json.decode(text)
    add(sum, result)
    for _, finding in ipairs(result.findings) do report(opts, batch, finding, seen) end
    sum.calls = sum.calls + batch.last - batch.first + 1
    if opts.call then io.stdout:write(read(batch.log_name .. ".out")) end
  else
    local finding = crash(batch, tostring(message))
    sum.findings[#sum.findings + 1] = finding
    report(opts, batch, finding, seen)
    sum.calls = sum.calls + finding.number - batch.first + 1
    if opts.call then io.stdout:write(read(batch.log_name .. ".out")) end
    if finding.number < batch.last then return finding.number + 1 end
  end
  for _, ending in ipairs {"", ".out", ".record"} do os.remove(batch.log_name .. ending) end
end

-- Names that were never called with success, for who wants to bring the fuzzer farther.
local function never(list, counts)
  local out = {}
  for _, entry in ipairs(list) do
    local count = counts[entry.name]
    if (entry.kind == "function" or entry.kind == "method" or entry.kind == "call") and not (count
      and count.done > 0) then
      out[#out + 1] = entry.name .. (count and "" or " (not called)")
    end
  end
  return out
end

--- The exit status.
return function(opts, stubs_folder)
  bw.threads(1)
  local list, by_name = entries.of(stubs_folder)
  at_rest = blocks()
  local pool, class_names = new_pool(list)
  if opts.only then
    local some = {}
    for _, entry in ipairs(list) do
      if entry.name:find(opts.only, 1, true) then some[#some + 1] = entry end
    end
    list = some
  end
  if #list == 0 then error("api: no entry of the stubs has the text of --only", 0) end
  call.begin(list)
  values.begin(by_name)
  -- What forked children cannot have, and what stands for files of the batch's folder.
  local later = {Expectation = true, Test = true, LiveServer = true, Results = true, Study = true, Trial = true,
    Trials = true}
  for _, name in ipairs(class_names) do
    if not later[name] then pool:get("bw." .. name) end
  end
  pool.used = {}
  with_objects = blocks()
  local begin = core.seconds()
  local sum, seen = {counts = {}, findings = {}, longest = {seconds = 0}, calls = 0}, {}
  local first = opts.call and (opts.from or opts.call) or 1
  local last = opts.call or opts.calls
  local running, number, slots = {}, 0, {}
  for i = 1, opts.parallel or core.processors() do slots[i] = i end
  local waiting = {} -- rests of batches that were ended
  while first <= last or #running > 0 or #waiting > 0 do
    while #slots > 0 and (first <= last or #waiting > 0) do
      local range = table.remove(waiting) or {first, math.min(last, first + batch_size - 1)}
      first = math.max(first, range[2] + 1)
      number = number + 1
      running[#running + 1] = start(opts, pool, table.remove(slots), range[1], range[2],
        opts.folder .. "/" .. number)
    end
    local jobs = {}
    for i, batch in ipairs(running) do jobs[i] = batch.job end
    local which = core.wait(jobs, 1)
    if which then
      local batch = table.remove(running, which)
      local rest = finish(opts, batch, sum, seen)
      if rest then waiting[#waiting + 1] = {rest, batch.last} end
      batch.job:close()
      slots[#slots + 1] = batch.slot
    end
    for _, batch in ipairs(running) do watch(batch) end
  end
  if opts.call then return #sum.findings > 0 and 1 or 0 end
  for name, reason in pairs(entries.left_out) do print(("left out: %s: %s"):format(name, reason)) end
  local unused = never(list, sum.counts)
  print(("never with success (%d): %s"):format(#unused, table.concat(unused, " ")))
  local outcome, slowest = {done = 0, failed = 0, raised = 0, late = 0, seconds = 0}, {}
  for name, count in pairs(sum.counts) do
    slowest[#slowest + 1] = {name = name, seconds = count.seconds}
    for key, n in pairs(count) do outcome[key] = outcome[key] + n end
  end
  table.sort(slowest, function(a, b) return a.seconds > b.seconds end)
  for i = 1, math.min(12, #slowest) do slowest[i] = ("%s %.2f s"):format(slowest[i].name, slowest[i].seconds) end
  print(("slowest, of %.2f s in calls: %s"):format(outcome.seconds,
    table.concat(slowest, ", ", 1, math.min(12, #slowest))))
  local distinct = 0
  for _ in pairs(seen) do distinct = distinct + 1 end
  print(("longest: %.2f s, call %s: %s"):format(sum.longest.seconds, sum.longest.number, sum.longest.text))
  local text = "seed %d: %d calls of %d entries in %.0f s: %d done, %d failed, %d raised, %d asked to end"
  print(text:format(opts.seed, sum.calls, #list, core.seconds() - begin, outcome.done, outcome.failed,
    outcome.raised, outcome.late))
  print(("%d findings, %d different"):format(#sum.findings, distinct))
  return #sum.findings > 0 and 1 or 0
end
