-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A study on several ranks: rank 0 holds the file and hands out trials, the others run them, one at a time
-- each, in a forked job as the local executor does: whatever a trial does costs that trial and nothing
-- else. All ranks load the same script; which trial runs where is of no matter to its numbers.
local core = require "barwright.core"
local distributed = require "barwright.distributed"
local executor = require "barwright.study.executor"
local pack = require "barwright.study.pack"

local mpi = {}

-- Tags. A worker says who it is, then answers each trial with an outcome, until it is asked to end.
local HELLO, TRIAL, OUTCOME, END = 1, 2, 3, 4

-- What must be the same on all ranks: the same name, seed and text of the script.
local function identity(study)
  return pack.encode {study.name, study.seed, study.script.text}
end

-- ---- rank 0 ------------------------------------------------------------------------------------------

local methods = {}
methods.__index = methods

-- All workers are there, with the same study.
local function greet(self)
  local own = identity(self.study)
  for _ = 1, self.capacity do
    local rank, tag, text = distributed.receive(120)
    if not rank then return nil, tag or "not all ranks have loaded the study within 120 s" end
    if tag ~= HELLO or text ~= own then
      return nil, ("rank %d has loaded another study: all ranks must see the same script"):format(rank)
    end
    self.free[#self.free + 1] = rank
  end
  table.sort(self.free, function(a, b) return a > b end)
  return true
end

--- For study:run {executor = mpi.executor}; to be closed by mpi.finish.
function mpi.executor(study)
  local self = setmetatable({study = study, capacity = distributed.size() - 1, free = {}, busy = {}}, methods)
  local ok, message = greet(self)
  if not ok then return nil, message, {status = "failed"} end
  return self
end

function methods:start(record)
  local rank = table.remove(self.free)
  local ok, message, details = distributed.send(rank, TRIAL,
    pack.encode {number = record.number, key = record.key, seed = record.seed, point = record.point})
  if not ok then return nil, message, details end
  self.busy[rank] = record
  return true
end

function methods:wait(seconds)
  local rank, tag, text = distributed.receive(seconds)
  if not rank then return nil, tag end
  assert(tag == OUTCOME, tag)
  local record = self.busy[rank]
  self.busy[rank] = nil
  self.free[#self.free + 1] = rank
  return record, assert(pack.decode(text))
end

function methods.close() end -- what still runs is ended by mpi.finish

--- Lets the workers go. Rank 0 calls it whatever became of the study.
function mpi.finish()
  for rank = 1, distributed.size() - 1 do distributed.send(rank, END, "") end
end

-- ---- the others --------------------------------------------------------------------------------------

local function perform(here, record)
  local ok, message = here:start(record)
  if not ok then return {status = "failed", message = message} end
  while true do
    local ended, outcome = here:wait(0.25)
    if ended then return outcome end
    if outcome or core.interrupted() then return {status = "cancelled"} end
    -- Rank 0 sends nothing while a trial runs but the end.
    local rank, tag = distributed.receive(0)
    if rank or tag then return nil end
  end
end

local function work(study, opts)
  opts = setmetatable({workers = 1}, {__index = opts})
  local here = executor.new(study, opts)
  assert(distributed.send(0, HELLO, identity(study)))
  while true do
    local rank, tag, text = distributed.receive(-1)
    if not rank or tag == END then break end
    local outcome = perform(here, assert(pack.decode(text)))
    if not outcome then break end
    assert(distributed.send(0, OUTCOME, pack.encode(outcome)))
  end
  here:close()
end

--- Runs the study's trials for rank 0 until that one ends. opts: seconds, bytes, output. An error here
--- ends all ranks: rank 0 would wait for ever.
function mpi.work(study, opts)
  local ok, message = xpcall(work, debug.traceback, study, opts)
  if not ok then distributed.abort(message) end
end

--- study:run on all ranks: on rank 0 its results; on the others true when rank 0 has ended.
function mpi.run(study, opts)
  local rank, size = distributed.join()
  if not rank then return nil, size end
  if rank > 0 then
    mpi.work(study, opts)
    return true
  end
  if size < 2 then
    return nil, "--mpi: rank 0 only hands out trials, and there is no other rank: start as mpirun -n 3 or more",
      {status = "unsupported"}
  end
  local finish <close> = setmetatable({}, {__close = mpi.finish})
  local own = {}
  for key, value in pairs(opts) do own[key] = value end
  own.workers, own.executor = nil, mpi.executor
  local trials, message, details = study:run(own)
  assert(finish)
  return trials, message, details
end

return mpi
