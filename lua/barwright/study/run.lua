-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Running a study: its design asks for points; what the file knows is answered from it, the rest goes to
-- the executor, and each result is in the file before anybody sees it. Nothing of a design's state is
-- kept: a study that is run again asks the same points and gets the same answers.
local core = require "barwright.core"
local designs = require "barwright.study.designs"
local executor = require "barwright.study.executor"
local key = require "barwright.study.key"
local options = require "barwright.options"
local store = require "barwright.study.store"
local trial = require "barwright.study.trial"
local trials = require "barwright.study.trials"

local run = {}

local rules = {
  design = {type = "table"}, -- another one than the study's own, on the same file
  workers = {type = "integer", min = 1, max = 4096},
  seconds = {type = "number", above = 0}, -- of one trial, by the clock
  bytes = {type = "number", above = 0}, -- of one trial, beyond what is loaded; default: executor.lua
  stop_when = {type = "any"},
  evaluations = {type = "integer", min = 1}, -- how many different points the design may ask for
  seconds_total = {type = "number", above = 0},
  retry = {type = "boolean", default = false}, -- trials that failed are run again
  continue = {type = "boolean", default = false}, -- with a script that has changed
  output = {type = "boolean", default = false}, -- what trials print goes to output.txt in their folder
  executor = {type = "any"}, -- an object as in executor.lua, or a function (study, options) that makes one
  shard = {type = "any"}, -- {2, 10}: the second of ten parts of the points, for a file of its own
}

-- Raised through the design when no more trials are wanted, and caught here alone.
local halt = {__name = "halt", __tostring = function(self) return self.reason or self.message end}
local function stop(reason) error(setmetatable({reason = reason}, halt), 0) end
local function give_up(message, details) error(setmetatable({message = message, details = details}, halt), 0) end

local runner = {}
runner.__index = runner

-- New trials take the least numbers that are free, so that those that a damaged file lost get their own again.
local function to_next_free(self)
  while self.taken[self.next] do self.next = self.next + 1 end
end

-- The trials of the file, and those that are asked for, by key.
local function load(self)
  local list, message, details = self.store:load()
  if not list then return nil, message, details end
  self.by_key, self.taken, self.next = {}, {}, 1
  for _, record in ipairs(list) do
    self.by_key[record.key] = trials.present(record, self.study.problem, self.study)
    self.taken[record.number] = true
  end
  to_next_free(self)
  return true
end

-- The trial of a point, a new one where the file has none.
local function trial_of(self, point, new)
  local study = self.study
  local name = key.of(study.name, study.seed, study.problem.sorted, point)
  local record = self.by_key[name]
  if not record then
    record = trials.present({number = self.next, key = name, seed = key.seed(study.seed, name),
      status = "asked", attempts = 0, point = point}, study.problem, study)
    self.taken[self.next] = true
    to_next_free(self)
    self.by_key[name] = record
    new[#new + 1] = record
  end
  return record
end

local function save(self, method, what)
  local ok, message, details = self.store[method](self.store, what)
  if not ok then
    give_up(store.explain(self.store.path, message, details))
  end
end

-- Trials that nothing is waiting for any more, in the order asked, so that what stops a study does not
-- depend on which trial happened to end first.
local function look_at_finished(self)
  while true do
    local record = self.order[self.seen + 1]
    if not record or record.status == "asked" or self.pending[record] then return end
    self.seen = self.seen + 1
    self.live[self.seen] = record
    if self.opts.stop_when and self.opts.stop_when(self.live) then stop "stop_when returned true" end
  end
end

local function interrupted(self)
  return ("interrupted: %d trials more are in %s; run it again to go on"):format(self.finished, self.store.path),
    {status = "cancelled"}
end

local function show_progress(self, now)
  if now - self.shown < 0.1 then return end
  self.shown = now
  local left = #self.missing - self.finished_of_batch
  local total = self.total and self.total - self.reused or 0
  total = math.max(total, self.finished + left)
  if not core.report_progress(self.stage, total > 0 and self.finished / total or 1) then
    give_up(interrupted(self))
  end
end

local function take(self, record, outcome)
  self.running = self.running - 1
  if outcome.status == "cancelled" then return end
  record.seconds, record.processor_seconds = outcome.seconds, outcome.processor_seconds
  record.peak_bytes = outcome.peak_bytes and math.floor(outcome.peak_bytes)
  record.attempts = (record.attempts or 0) + 1
  if outcome.text then
    trial.read(self.study, record, outcome.text)
  else
    record.status, record.message, record.results = outcome.status, outcome.message, nil
    core.sweep(record.folder) -- what its process was writing when it was ended
  end
  save(self, "finish", record)
  self.pending[record] = nil
  self.finished, self.finished_of_batch = self.finished + 1, self.finished_of_batch + 1
end

local function out_of_time(self)
  return self.opts.seconds_total and core.seconds() - self.began >= self.opts.seconds_total
end

local function wait_for_one(self)
  local record, outcome = self.executor:wait(0.25)
  if record then
    take(self, record, outcome)
  elseif outcome == "cancelled" or core.interrupted() then
    give_up(interrupted(self))
  elseif outcome then
    give_up(outcome, {status = "internal"})
  end
  if out_of_time(self) then stop(("%g seconds have passed"):format(self.opts.seconds_total)) end
end

-- Runs what is missing of a batch.
local function work_off(self)
  self.finished_of_batch = 0
  local at = 1
  look_at_finished(self)
  while at <= #self.missing or self.running > 0 do
    while at <= #self.missing and self.running < self.executor.capacity do
      local ok, message, details = self.executor:start(self.missing[at])
      if not ok then give_up(message, details) end
      self.running = self.running + 1
      at = at + 1
    end
    wait_for_one(self)
    look_at_finished(self)
    show_progress(self, core.seconds())
  end
end

local ended_badly = {failed = true, time = true, memory = true, crashed = true}

-- What of the trials has to be run, and is this process's to run.
local function find_missing(self, asked)
  local missing, others = {}, false
  for _, record in ipairs(asked) do
    local again = record.status == "asked" or self.opts.retry and ended_badly[record.status]
      and not self.retried[record]
    if again and not self.pending[record] then
      if self.mine(self.place[record]) then
        missing[#missing + 1] = record
        self.pending[record], self.retried[record] = true, true
      else
        others = true
      end
    end
  end
  return missing, others
end

-- The trials of a list of points, written down; cut: the limit on evaluations was met.
local function ask(self, points)
  local asked, new, cut = {}, {}, false
  for i, given in ipairs(points) do
    local point = self.study.problem:check(given, ("study %s: point %d"):format(self.study.name, i))
    local record = trial_of(self, point, new)
    if not self.place[record] then
      if self.opts.evaluations and #self.order >= self.opts.evaluations then
        cut = true
        if new[#new] == record then -- it was not asked for
          new[#new], self.by_key[record.key] = nil, nil
          self.taken[record.number], self.next = nil, record.number
        end
        break
      end
      self.order[#self.order + 1] = record
      self.place[record] = #self.order
      if record.status ~= "asked" then self.reused = self.reused + 1 end
    end
    asked[i] = record
  end
  if #new > 0 then save(self, "ask", new) end
  return asked, cut
end

-- What a design calls: results of the points in their order, false where a trial has none; and the trials.
local function evaluate(self, points)
  local asked, cut = ask(self, points)
  local others
  self.missing, others = find_missing(self, asked)
  work_off(self)
  if others then stop "the other parts are run elsewhere" end
  if cut then stop(("%d evaluations were made"):format(self.opts.evaluations)) end
  local results = {}
  for i, record in ipairs(asked) do results[i] = record.results or false end
  return results, asked
end

local function shard_of(opts)
  if opts == nil then return function() return true end end
  local i, n = type(opts) == "table" and opts[1], type(opts) == "table" and opts[2]
  if math.type(i) ~= "integer" or math.type(n) ~= "integer" or i < 1 or i > n then
    local got = type(opts) == "table" and ("{%s, %s}"):format(core.got(i), core.got(n)) or core.got(opts)
    core.raise(("study:run: option 'shard': two whole numbers {which, of how many}, such as {2, 10}, expected, "
      .. "got %s"):format(got))
  end
  return function(place) return (place - 1) % n == i - 1 end
end

-- What may run trials: see executor.lua.
local function check_executor(own)
  local good = type(own) == "table" and math.type(own.capacity) == "integer" and own.capacity > 0
  for _, name in ipairs {"start", "wait", "close"} do good = good and type(own[name]) == "function" end
  if not good then
    core.raise("study:run: option 'executor': {capacity, start, wait, close}, or a function that returns it, "
      .. "expected, got " .. core.got(own))
  end
end

local function read_options(given)
  local opts = options.read("study:run", given, rules)
  if opts.stop_when ~= nil and type(opts.stop_when) ~= "function" then
    core.raise("study:run: option 'stop_when': a function of the trials so far expected, got "
      .. core.got(opts.stop_when))
  end
  return opts
end

-- The trials that have ended, in the order in which they were asked for.
local function finished_trials(self, summary)
  local list = {}
  for _, record in ipairs(self.order) do
    if record.status ~= "asked" then list[#list + 1] = record end
  end
  local out = trials.new(self.study, list)
  out.summary = summary or {}
  local objectives = #self.study.problem.objectives
  if objectives == 1 then out.summary.best = out:best() end
  if objectives > 1 then out.summary.front = out:front() end
  return out
end

local function run_design(self, design)
  local ok, summary = pcall(design.run, function(points) return evaluate(self, points) end, self.study.problem,
    design.opts)
  if ok then
    if type(summary) == "number" or type(summary) == "string" then summary = {value = summary} end
    return finished_trials(self, type(summary) == "table" and summary or {})
  end
  if getmetatable(summary) ~= halt then error(summary, 0) end
  if summary.reason then
    local out = finished_trials(self)
    out.stopped = summary.reason
    return out
  end
  return nil, summary.message, summary.details
end

--- study:run. Trials, or nil and a message where the file cannot be used or Ctrl-C was pressed.
function run.run(study, given)
  local opts = read_options(given)
  local mine = shard_of(opts.shard)
  local design = opts.design and designs.read("study:run", opts.design, study.problem, study.seed) or study.design
  if opts.shard and not (design.kind and design.kind.points) then
    core.raise(("study:run: option 'shard': the points of design '%s' depend on results, and cannot be split")
      :format(design.name))
  end
  local lock <close>, message, details = core.lock(study.file .. ".lock", 0.3) -- status looks at it
  if not lock then
    if details.limit == "lock" then
      message = ("%s: this study is being run by %s; wait for it, or end it"):format(study.file, details.holder)
      details.status = "busy"
    end
    return nil, message, details
  end
  local file <close>, why, more = store.open(study, study.file, {continue = opts.continue})
  if not file then return nil, why, more end
  local self = setmetatable({study = study, opts = opts, store = file, mine = mine,
    order = {}, place = {}, pending = {}, retried = {}, missing = {}, seen = 0, live = trials.new(study),
    running = 0, finished = 0, finished_of_batch = 0, reused = 0, shown = -1, began = core.seconds(),
    total = design.total, stage = "study " .. study.name}, runner)
  local ok
  ok, message, details = load(self)
  if not ok then return nil, message, details end
  local make = opts.executor or executor.new
  local own = make
  if type(make) == "function" then
    own, message, details = make(study, opts)
    if not own then return nil, message, details end
  end
  check_executor(own)
  self.executor = own
  local closing <close> = setmetatable({}, {__close = function() own:close() end})
  local out
  out, message, details = run_design(self, design)
  if not core.report_progress(self.stage, 1) then return nil, interrupted(self) end
  assert(closing)
  if not out then return nil, message, details end
  return out
end

--- All points of the study's design with their keys: {{point, key}, ...}; nil where they depend on results.
function run.planned(study)
  local points = designs.points(study.design, study.problem)
  if not points then return nil end
  local out = {}
  for i, given in ipairs(points) do
    local point = study.problem:check(given, "point " .. i)
    out[i] = {point = point, key = key.of(study.name, study.seed, study.problem.sorted, point)}
  end
  return out
end

return run
