-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Batches of sequences in forked children: what they found, what ended them, and what makes it again.
local bw = require "barwright"
local core = require "barwright.core"
local sequence = require "sequence"

local names = {"sheet", "cantilever", "vibration", "flow", "thermal", "plate", "bridge", "mesh_motion", "session",
  "solid", "transient", "controller"}
local batch_size = 5 -- sequences
local seconds, bytes = 600, 4e9 -- of processor time and memory that a batch may take

local function kinds_of(opts)
  if not opts.kind then return names end
  for _, name in ipairs(names) do
    if name == opts.kind then return {name} end
  end
  error(("sequences: no kind '%s': %s"):format(opts.kind, table.concat(names, ", ")), 0)
end

-- Sequence n is of a kind in turn.
local function run_one(opts, kinds, n, log)
  return sequence.run(kinds[(n - 1) % #kinds + 1], opts.seed, n, opts.length, log)
end

local function work(opts, kinds, first, last, path)
  local log = assert(io.open(path, "wb"))
  log:setvbuf "no"
  local result = {operations = 0, failed = 0, findings = bw.json.list {}}
  for n = first, last do
    log:write(("sequence %d\n"):format(n))
    local one = run_one(opts, kinds, n, function(text) log:write(text, "\n") end)
    result.operations, result.failed = result.operations + one.operations, result.failed + one.failed
    for _, finding in ipairs(one.findings) do
      finding.sequence = n
      result.findings[#result.findings + 1] = finding
    end
  end
  log:close()
  return bw.json.encode(result)
end

local function read(path)
  local file = io.open(path, "rb")
  local text = file and file:read "a" or ""
  if file then file:close() end
  return text
end

local function report(opts, n, what, about)
  print(("FOUND in sequence %d: %s\n  %s\n  again: --seed %d --sequence %d --length %d%s"):format(n, what,
    about:gsub("\n", "\n  "), opts.seed, n, opts.length, opts.kind and " --kind " .. opts.kind or ""))
  io.stdout:flush()
end

-- The child ended without an answer: the last line of its log is what it did.
local function crashed(opts, batch, message)
  local log, output = read(batch.path), read(batch.path .. ".out")
  local n
  for number in log:gmatch "sequence (%d+)\n" do n = tonumber(number) end
  local trace = log:match ".*sequence %d+\n(.*)$" or ""
  local sanitizer = output:match "[^\n]*ERROR: %w+Sanitizer.*" or output:match "[^\n]*runtime error:.*" or output
  report(opts, n or batch.first, message, trace:sub(-1500) .. "\n" .. sanitizer:sub(1, 4000))
  return n or batch.first
end

local function finish(opts, batch, sum)
  local text, message = batch.job:result()
  local rest
  if text then
    local result = bw.json.decode(text)
    sum.operations, sum.failed = sum.operations + result.operations, sum.failed + result.failed
    for _, finding in ipairs(result.findings) do
      sum.findings = sum.findings + 1
      report(opts, finding.sequence, finding.what, finding.trace)
    end
  else
    sum.findings = sum.findings + 1
    rest = crashed(opts, batch, tostring(message)) + 1
    sum.operations = sum.operations + opts.length * (rest - batch.first)
  end
  batch.job:close()
  os.remove(batch.path)
  os.remove(batch.path .. ".out")
  if rest and rest <= batch.last then return {rest, batch.last} end
end

--- The exit status.
return function(opts)
  local kinds = kinds_of(opts)
  if opts.sequence then
    local one = run_one(opts, kinds, opts.sequence, print)
    for _, finding in ipairs(one.findings) do report(opts, opts.sequence, finding.what, "") end
    return #one.findings > 0 and 1 or 0
  end
  bw.threads(1)
  local begin, count = core.seconds(), math.ceil(opts.operations / opts.length)
  local sum = {operations = 0, failed = 0, findings = 0}
  local first, running, waiting, slots = 1, {}, {}, opts.parallel or core.processors()
  while first <= count or #running > 0 or #waiting > 0 do
    while #running < slots and (first <= count or #waiting > 0) do
      local range = table.remove(waiting) or {first, math.min(count, first + batch_size - 1)}
      first = math.max(first, range[2] + 1)
      local path = os.tmpname()
      running[#running + 1] = {first = range[1], last = range[2], path = path,
        job = assert(core.job(function() return work(opts, kinds, range[1], range[2], path) end,
          {name = "sequences from " .. range[1], output = path .. ".out", bytes = bytes, seconds = seconds}))}
    end
    local jobs = {}
    for i, batch in ipairs(running) do jobs[i] = batch.job end
    local which = core.wait(jobs, 1)
    if which then waiting[#waiting + 1] = finish(opts, table.remove(running, which), sum) end
  end
  local text = "seed %d: %d operations in %d sequences of %s in %.0f s, %d failed as they may: %d findings"
  print(text:format(opts.seed, sum.operations, count, opts.kind or ("%d kinds"):format(#kinds),
    core.seconds() - begin, sum.failed, sum.findings))
  return sum.findings > 0 and 1 or 0
end
