-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a study costs beside its trials: seconds for each of many trials that do nothing, what of them is
-- the fork, the file, the key; two workers beside one on trials that compute for some 20 ms; memory of the
-- process that runs it; keys, seeds and the file alone, without forks; going on with a file that has everything.
local bw = require "barwright"
local core = require "barwright.core"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "what a study costs beside its trials",
  about = "Prints one JSON object.",
  options = {
    {name = "out", value = "FILE.json", type = "file", what = "where the object goes, too"},
    {name = "trials", value = "N", type = "integer", default = 2000, min = 1, what = "trials that do nothing"},
    {name = "seconds", value = "TIME", type = "number", unit = "s", default = 0.02, above = 0,
      what = "how long each trial that computes takes"},
    {name = "work", value = "N", type = "integer", default = 200, min = 1, what = "trials that compute"},
  },
}

local temporary = assert(core.temporary_folder())
local folder = temporary.path

local function study(name, count, run)
  return bw.study {name = name, file = ("%s/%s.study"):format(folder, name), measures = {"y"},
    variables = {{name = "x", min = 0, max = 1}, {name = "n", kind = "integer", min = 0, max = 9}},
    design = {"random", count = count}, run = run}
end

local function timed(f)
  local start, processor = core.seconds(), os.clock()
  f()
  return core.seconds() - start, os.clock() - processor
end

local function nothing(point) return {y = point.x} end

local result = {trials = opts.trials, processors = core.processors()}

-- ---- overhead ------------------------------------------------------------------------------------------

local empty = study("empty", opts.trials, nothing)
local peak = bw.results.peak_memory()
local one, own = timed(function() assert(empty:run {workers = 1}) end)
result.overhead = {seconds_of_trial_one_worker = one / opts.trials, processor_seconds_of_trial = own / opts.trials,
  memory_bytes_before = peak, memory_bytes_after = bw.results.peak_memory()}
local again = timed(function() assert(empty:run()) end)
result.overhead.seconds_of_trial_that_is_there = again / opts.trials
os.remove(empty.file)
local two = timed(function() assert(empty:run {workers = 2}) end)
result.overhead.seconds_of_trial_two_workers = two / opts.trials
local fork = timed(function()
  for _ = 1, 500 do
    local job = assert(core.job(function() return "" end, {}))
    core.wait({job}, 60)
    job:close()
  end
end)
result.overhead.seconds_of_fork = fork / 500
local file = assert(io.open(empty.file, "rb"))
result.overhead.file_bytes_of_trial = file:seek "end" / opts.trials
file:close()

-- ---- keys, seeds, the file -----------------------------------------------------------------------------

-- Trials that run here, one after the other: no fork.
local trial = require "barwright.study.trial"
local books = study("books", 10000, nothing)
local here = {capacity = 1}
function here:start(record)
  self.record = record
  return true
end
function here:wait()
  return self.record, {text = trial.perform(books, self.record), seconds = 0, processor_seconds = 0}
end
function here.close() end
local _, spent = timed(function() assert(books:run {executor = here}) end)
result.bookkeeping = {trials = 10000, processor_seconds_of_trial = spent / 10000,
  memory_bytes_after = bw.results.peak_memory()}

-- ---- two workers beside one ----------------------------------------------------------------------------

-- So many turns as take the wanted time here and now.
local function turns(count)
  local x = 0.5
  for _ = 1, count do x = 3.9 * x * (1 - x) end
  return x
end
local rate = 2000000 / select(2, timed(function() turns(2000000) end))
local count = math.floor(rate * opts.seconds)
local function work() return {y = turns(count)} end

local seconds = {}
for round = 1, 3 do -- the best of three: the machine has other things to do
  for workers = 1, 2 do
    local own_study = study(("work_%d_%d"):format(round, workers), opts.work, work)
    local took = timed(function() assert(own_study:run {workers = workers}) end)
    seconds[workers] = math.min(seconds[workers] or took, took)
  end
end
result.throughput = {trial_seconds = opts.seconds, trials = opts.work, seconds_one_worker = seconds[1],
  seconds_two_workers = seconds[2], gain = seconds[1] / seconds[2]}

temporary:close()
local text = bw.json.encode(result, "  ")
print(text)
if opts.out then assert(core.write_file(opts.out, text .. "\n")) end
