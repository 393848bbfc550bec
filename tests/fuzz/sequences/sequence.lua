-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One sequence: a subject of a kind, operations on it with and without trouble, what is proved after each.
--
-- A kind gives make(): a subject; operations: {name = {weight, function(subject) ...}}, each of which returns
-- something true, or nil and a message; seen(subject): all that can be seen, as one string; check(subject),
-- which raises where parts do not belong together; close(subject).
local bw = require "barwright"
local core = require "barwright.core"
local fuse = require "fuse"

local sequence = {}

-- ---- trouble -------------------------------------------------------------------------------------

local troubles = {}
local time_limit = 2 -- seconds of processor time, after which an operation is asked to end

-- Calls `work` with a progress function; that which was there before is back when it returns.
local function with_progress(progress, work)
  local former = bw.progress(progress)
  local results = table.pack(pcall(work))
  bw.progress(former)
  return table.unpack(results, 1, results.n)
end

function troubles.none(work)
  local begin = os.clock()
  return with_progress(function() return os.clock() - begin < time_limit end, work)
end

-- Allocation n of the engine fails, or all from there on.
function troubles.memory(work)
  core.fail_allocation(math.random(1, math.random() < 0.5 and 40 or 600), math.random() < 0.5)
  local results = table.pack(troubles.none(work))
  core.fail_allocation(0)
  return table.unpack(results, 1, results.n)
end

-- The progress function asks to stop, or raises, after some calls.
local function interrupted(answer)
  return function(work)
    local left = math.random(0, 3)
    return with_progress(function()
      left = left - 1
      if left < 0 then return answer() end
    end, work)
  end
end
troubles.cancel = interrupted(function() return false end)
troubles.raise = interrupted(function() error("progress raises", 0) end)

-- Conditions given as functions raise, or are no numbers, after some calls.
function troubles.callback(work)
  fuse.light(math.random(0, math.random() < 0.5 and 5 or 200))
  local results = table.pack(troubles.none(work))
  fuse.out()
  return table.unpack(results, 1, results.n)
end

local function choose_trouble()
  local at = math.random()
  return at < 0.5 and "none" or at < 0.7 and "memory" or at < 0.8 and "callback" or at < 0.9 and "cancel"
    or "raise"
end

-- ---- operations ----------------------------------------------------------------------------------

local function choose(operations)
  local names, total = {}, 0
  for name, operation in pairs(operations) do
    names[#names + 1] = name
    total = total + operation[1]
  end
  table.sort(names)
  local at = math.random() * total
  for _, name in ipairs(names) do
    at = at - operations[name][1]
    if at <= 0 then return name end
  end
  return names[#names]
end

-- An error that tells of a slip in the library, not of misuse.
local function is_slip(message)
  message = tostring(message)
  return message:find "attempt to " or message:find "lua/barwright/[%w_/]+%.lua:%d+:"
    or message:find "stack overflow" or message:find "check: "
end

--- {operations =, failed =, findings = {{what =, trace =}}}
function sequence.run(name, seed, number, length, report)
  local kind = require("kind_" .. name)
  math.randomseed(seed, number)
  local result, trace = {operations = 0, failed = 0, findings = {}}, {}
  local function found(what)
    result.findings[#result.findings + 1] = {what = what, trace = name .. ":\n" .. table.concat(trace, "\n")}
  end
  local function say(text)
    trace[#trace + 1] = text
    report(text)
  end
  local made, subject = xpcall(kind.make, debug.traceback)
  if not made then
    found("it was not made: " .. tostring(subject))
    return result
  end
  for step = 1, length do
    local what, trouble = choose(kind.operations), choose_trouble()
    local before = kind.seen(subject)
    say(("%d %s, %s"):format(step, what, trouble))
    local operation = kind.operations[what][2]
    local ok, done, message = troubles[trouble](function() return operation(subject, kind) end)
    local failed = not (ok and done)
    result.operations = result.operations + 1
    say(("  %s"):format(not failed and "done" or ok and tostring(message) or "raised " .. tostring(done)))
    if not ok and is_slip(done) then found("an error within the library: " .. tostring(done)) end
    local sound, why = pcall(kind.check, subject)
    if not sound then
      found("the check fails: " .. tostring(why))
      break
    end
    if failed then
      result.failed = result.failed + 1
      local after = kind.seen(subject)
      if after ~= before then
        local at = 1
        while before:byte(at) == after:byte(at) do at = at + 1 end
        local from = math.max(1, at - 8)
        found(("a failed operation changed what is seen, from byte %d of %d and %d: %q became %q"):format(at,
          #before, #after, before:sub(from, at + 24), after:sub(from, at + 24)))
        break
      end
    end
    if #result.findings > 0 then break end
  end
  local closed, why = pcall(kind.close, subject)
  if not closed then found("it cannot be closed: " .. tostring(why)) end
  return result
end

return sequence
