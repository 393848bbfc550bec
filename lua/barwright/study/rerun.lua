-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One trial once more, beside the numbers that the file has of it.
local core = require "barwright.core"
local executor = require "barwright.study.executor"
local key = require "barwright.study.key"
local options = require "barwright.options"
local store = require "barwright.study.store"
local trial = require "barwright.study.trial"
local trials = require "barwright.study.trials"

local rerun = {}

local rules = {
  inside = {type = "boolean", default = false}, -- in this process: what it prints is seen, a debugger works
  seconds = {type = "number", above = 0},
  bytes = {type = "number", above = 0},
}

local meta = {__name = "trial run again"}
function meta.__tostring(self)
  local lines = {tostring(self.trial)}
  if not self.before then
    lines[#lines + 1] = "it is not in the file: nothing to compare with"
  elseif self.same then
    lines[#lines + 1] = self.trial.status == "done" and "the same numbers, bit for bit, as in the file"
      or "it ended as it did in the file"
  else
    for _, each in ipairs(self.differences) do
      lines[#lines + 1] = ("%s: %s in the file, %s now"):format(each.name, tostring(each.before),
        tostring(each.now))
    end
  end
  return table.concat(lines, "\n")
end

local function read_all(study)
  local there = io.open(study.file, "rb")
  if not there then return {} end
  there:close()
  local file <close>, message, details = store.open(study, study.file, {read_only = true})
  if not file then return nil, message, details end
  local list, why, more = file:load()
  return list, why, more
end

-- The record of a number, of the beginning of a key, or of a point.
local function find(study, list, which)
  if type(which) == "table" then
    local point = study.problem:check(which, "study:trial")
    local name = key.of(study.name, study.seed, study.problem.sorted, point)
    for _, record in ipairs(list) do
      if record.key == name then return record end
    end
    local seed = key.seed(study.seed, name)
    return {number = 0, key = name, seed = seed, point = point, status = "asked"}
  end
  if math.type(which) == "integer" then
    for _, record in ipairs(list) do
      if record.number == which then return record end
    end
    return nil, ("%s has no trial %d; its %d trials have numbers up to %d"):format(study.file, which, #list,
      #list > 0 and list[#list].number or 0), {status = "empty"}
  end
  if type(which) ~= "string" or not which:match "^%x%x%x%x%x*$" then
    core.raise("study:trial: a number, four or more digits that a key begins with, or a point expected, got "
      .. core.got(which))
  end
  local found
  for _, record in ipairs(list) do
    if record.key:sub(1, #which) == which then
      if found then
        return nil, ("two keys of %s begin with %s: give more digits"):format(study.file, which),
          {status = "empty"}
      end
      found = record
    end
  end
  if found then return found end
  return nil, ("%s has no trial whose key begins with %s"):format(study.file, which), {status = "empty"}
end

local function run_inside(study, record)
  local start = core.seconds()
  local text = trial.perform(study, record)
  trial.read(study, record, text)
  record.seconds = core.seconds() - start
  return true
end

local function run_in_job(study, record, opts)
  local own = executor.new(study, {workers = 1, seconds = opts.seconds, bytes = opts.bytes})
  local closing <close> = setmetatable({}, {__close = function() own:close() end})
  local ok, message, details = own:start(record)
  if not ok then return nil, message, details end
  local ended, outcome
  repeat ended, outcome = own:wait(60) until ended or outcome
  assert(closing)
  if not ended then return nil, outcome, {status = "cancelled"} end
  record.seconds, record.processor_seconds, record.peak_bytes = outcome.seconds, outcome.processor_seconds,
    outcome.peak_bytes
  if outcome.text then
    trial.read(study, record, outcome.text)
  else
    record.status, record.message = outcome.status, outcome.message
  end
  return true
end

--- {trial, before, same, differences}: the trial as it came out now, that of the file, whether all numbers
--- are the same bits, and those that are not.
function rerun.trial(study, which, given)
  local opts = options.read("study:trial", given, rules)
  local list, message, details = read_all(study)
  if not list then return nil, message, details end
  local before
  before, message, details = find(study, list, which)
  if not before then return nil, message, details end
  local now = trials.present({number = before.number, key = before.key, seed = before.seed, point = before.point,
    status = "asked"}, study.problem, study)
  local ok
  ok, message, details = (opts.inside and run_inside or run_in_job)(study, now, opts)
  if not ok then return nil, message, details end
  local out = setmetatable({trial = now, differences = {}, same = false}, meta)
  if before.status == "asked" then return out end
  out.before = trials.present(before, study.problem, study)
  if now.status ~= before.status then
    out.differences[1] = {name = "status", before = before.status, now = now.status}
  end
  for _, m in ipairs(study.problem.measures) do
    local a, b = before.results and before.results[m.name], now.results and now.results[m.name]
    if a ~= b or math.type(a) ~= math.type(b) then
      out.differences[#out.differences + 1] = {name = m.name, before = a, now = b}
    end
  end
  out.same = #out.differences == 0
  return out
end

return rerun
