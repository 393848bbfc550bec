-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How far a study is: what its file says, beside what its design will ask for.
local core = require "barwright.core"
local run = require "barwright.study.run"
local store = require "barwright.study.store"
local trials = require "barwright.study.trials"

local status = {}

local meta = {__name = "study status"}
function meta.__tostring(self)
  local lines = {("study %s, file %s: %s"):format(self.name, self.file, trials.counts_text(self))}
  if self.missing then
    lines[#lines + 1] = self.missing == 0 and "all of the design's trials are there"
      or ("%d of the design's %d trials are missing"):format(self.missing, self.planned)
  elseif self.asked > 0 then
    lines[#lines + 1] = ("%d trials were begun or asked for and have not ended"):format(self.asked)
  end
  if self.mean_seconds then
    lines[#lines + 1] = ("%s for each trial, %s in all"):format(
      core.quantity(self.mean_seconds, "s"), core.quantity(self.seconds, "s"))
  end
  if self.running then lines[#lines + 1] = "it is being run by " .. self.running end
  for _, problem in ipairs(self.messages) do
    lines[#lines + 1] = ("%d x %s"):format(problem.count, problem.message)
  end
  return table.concat(lines, "\n")
end

local function read(self, out)
  local file <close>, message, details = store.open(self, self.file, {read_only = true})
  if not file then return nil, message, details end
  local list, why, more = file:load()
  if not list then return nil, why, more end
  local ended, by_message = {}, {}
  for _, record in ipairs(list) do
    out[record.status] = (out[record.status] or 0) + 1
    if record.status ~= "asked" then ended[record.key] = true end
    out.seconds = out.seconds + (record.seconds or 0)
    if record.message then
      local common = trials.common(record.message)
      local entry = by_message[common]
      if not entry then
        entry = {message = common, count = 0, first = record.number}
        by_message[common] = entry
        out.messages[#out.messages + 1] = entry
      end
      entry.count = entry.count + 1
    end
  end
  local finished = #list - out.asked
  if finished > 0 then out.mean_seconds = out.seconds / finished end
  table.sort(out.messages, function(a, b)
    if a.count ~= b.count then return a.count > b.count end
    return a.first < b.first
  end)
  while #out.messages > 5 do out.messages[#out.messages] = nil end
  return ended
end

--- {name, file, done, failed, time, memory, crashed, asked, planned, missing, seconds, mean_seconds, running,
--- messages}: planned and missing where the design's points are known.
function status.of(study)
  local out = setmetatable({name = study.name, file = study.file, done = 0, failed = 0, time = 0, memory = 0,
    crashed = 0, asked = 0, seconds = 0.0, messages = {}}, meta)
  local there = io.open(study.file, "rb")
  local ended = {}
  if there then
    there:close()
    local message, details
    ended, message, details = read(study, out)
    if not ended then return nil, message, details end
  end
  local lock, _, about = core.lock(study.file .. ".lock", 0)
  if lock then lock:close() else out.running = about.holder end
  local planned = run.planned(study)
  if planned then
    out.planned, out.missing = 0, 0
    local seen = {}
    for _, each in ipairs(planned) do
      if not seen[each.key] then
        seen[each.key] = true
        out.planned = out.planned + 1
        if not ended[each.key] then out.missing = out.missing + 1 end
      end
    end
  end
  return out
end

return status
