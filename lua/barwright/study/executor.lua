-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Who runs trials on this machine: a forked job for each, so that no trial sees what an earlier one left
-- behind. An executor is an object with
--   capacity              how many trials run side by side
--   start(record)         begins one; true, or nil and a message where none can be begun any more
--   wait(seconds)         the record of one that has ended, and its outcome {text = what trial.perform
--                         gave, or status and message, seconds, processor_seconds, peak_bytes}; nil when
--                         the time passed; nil, "cancelled" after Ctrl-C
--   close()               ends those that still run
local core = require "barwright.core"
local trial = require "barwright.study.trial"

local executor = {}
executor.__index = executor

-- A trial that fills memory is ended before the machine is: nine tenths of it, shared by the workers. Counted
-- are addresses, of which libraries take more than they use: no less than 4 GB.
local function fraction_of_memory(workers)
  local file = io.open "/proc/meminfo"
  local kilobytes = file and file:read("a"):match "MemTotal:%s*(%d+)"
  if file then file:close() end
  return kilobytes and math.max(4e9, 0.9 * 1024 * tonumber(kilobytes) / workers) or nil
end

--- opts: workers, seconds, bytes for each trial; output: what trials print goes into their folders.
function executor.new(study, opts)
  local capacity = opts.workers or core.processors()
  return setmetatable({study = study, opts = opts, capacity = capacity,
    bytes = opts.bytes or fraction_of_memory(capacity), jobs = {}, records = {}}, executor)
end

function executor:start(record)
  local study, output = self.study, nil
  if self.opts.output then
    local path = trial.folder_of(study, record.key)
    local ok, message, details = core.make_folder(path)
    if not ok then return nil, message, details end
    output = path .. "/output.txt"
  end
  local job, message, details = core.job(function() return trial.perform(study, record) end, {
    name = "trial " .. record.number, seconds = self.opts.seconds, bytes = self.bytes, output = output})
  if not job then return nil, message, details end
  self.jobs[#self.jobs + 1] = job
  self.records[#self.records + 1] = record
  return true
end

local function outcome_of(job)
  local text, message, details = job:result()
  local outcome = {text = text, message = message, seconds = job.seconds,
    processor_seconds = job.processor_seconds, peak_bytes = job.peak_bytes}
  if not text then
    local status = details and details.status
    outcome.status = status == "limit" and (details.limit == "memory" and "memory" or "time")
      or status == "crashed" and "crashed" or status == "memory" and "memory"
      or status == "cancelled" and "cancelled" or "failed"
  end
  return outcome
end

function executor:wait(seconds)
  local i, message = core.wait(self.jobs, seconds)
  if not i then return nil, message end
  local job, record = table.remove(self.jobs, i), table.remove(self.records, i)
  local outcome = outcome_of(job)
  job:close()
  return record, outcome
end

function executor:close()
  for _, job in ipairs(self.jobs) do job:close() end
  self.jobs, self.records = {}, {}
end

return executor
