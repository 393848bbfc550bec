-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One call: its entry and arguments by seed and number, made within limits, and what is a finding about it.
local bw = require "barwright"
local core = require "barwright.core"
local entries = require "entries"
local hostile = require "hostile"
local new_random = require "random"
local special = require "special"
local values = require "values"

local call = {}

-- What ends a call: a hook raises it, as Ctrl-C does, and the progress function then stops the engine.
local late = "fuzz: too late"

local shares = {{0.66, {"function", "call", "method"}}, {0.8, {"field"}}, {0.85, {"assignment"}},
  {0.89, {"unknown"}}, {1, {"operator"}}}

--- The entries by kind, to draw from.
function call.begin(list)
  call.by_kind = {}
  for i, fraction in ipairs(shares) do
    call.by_kind[i] = {}
    for _, entry in ipairs(list) do
      for _, kind in ipairs(fraction[2]) do
        if entry.kind == kind then table.insert(call.by_kind[i], entry) end
      end
    end
  end
end

local function draw(random) -- at least one kind has entries: run.lua refuses an empty list
  local x = random:uniform()
  for i, fraction in ipairs(shares) do
    -- With --only some kinds have no entry: the next kind that has one is drawn.
    if x < fraction[1] and #call.by_kind[i] > 0 then return random:one_of(call.by_kind[i]) end
  end
  return draw(random)
end

local function of_path(path)
  local value = bw
  for i = 2, #path do value = value[path[i]] end
  return value
end

-- The function to be called without arguments, and the text of the call.
local function prepare(entry, self, list, wrong)
  local kind, member = entry.kind, entry.member
  if kind == "function" then
    return function() return of_path(entry.path)[member](table.unpack(list, 1, list.n)) end
  elseif kind == "call" then
    return function() return of_path(entry.path)(table.unpack(list, 1, list.n)) end
  elseif kind == "method" then
    return function()
      local object = self
      if wrong then object = wrong[1] end
      return self[member](object, table.unpack(list, 1, list.n))
    end
  elseif kind == "field" then
    return function() return self[member] end
  elseif kind == "assignment" then
    return function() self[member] = list[1] end
  elseif kind == "unknown" then
    return function() return (self or of_path(entry.path))[list[1]] end
  end
  return function() return entries.operators[member](self, list[1], list[2]) end
end

local function text_of(entry, self, list, way)
  local parts = {}
  for i = 1, list.n do parts[i] = values.describe(list[i]) end
  local object = self ~= nil and values.describe(self) .. " " or ""
  return ("%s%s(%s)%s"):format(object, entry.name, table.concat(parts, ", "), way)
end

-- ---- what is wrong ------------------------------------------------------------------------------

local statuses = {}
for word in ([[io format geometry unconstrained singular convergence infeasible limit memory cancelled unsupported
  empty busy damaged failed different foreign rejected]]):gmatch "%S+" do
  statuses[word] = true
end

-- The place of a line of the library; the folder of the tests may be in one of its name.
local LIBRARY = "lua/barwright/[%w_/]+%.lua:%d+:"

--- Why an error value that was raised is a finding, or nil.
local function bad_error(message)
  -- A callback's own: coroutine.wrap names the line that called it.
  if type(message) == "string" and message:find "cannot resume [%w-]+ coroutine" then return nil end
  if message == late or message == hostile.raised or message == nil then return nil end
  if type(message) ~= "string" then
    local meta = debug.getmetatable(message)
    return not (meta and meta.__tostring and special.raises[meta.__name or ""]) and "raises a " .. type(message)
  end
  if message:find(LIBRARY) then return "names a line of the library" end
  if message:find "attempt to"
    and not message:find "^[^\n]-fuzz/api/" and not message:find "attempt to yield" then
    return "is Lua's own"
  end
end

-- Why what a call returned is a finding, or nil.
local function bad_results(entry, results)
  if entry.kind ~= "function" and entry.kind ~= "method" and entry.kind ~= "call" then return nil end
  local first, message, details = results[1], results[2], results[3]
  if first ~= nil or type(message) ~= "string" then return nil end
  message = message:match "^[^\n]*" -- what is behind is the way to an error of the script's own
  if message:find(LIBRARY) then return "names a line of the library" end
  if type(details) == "table" and details.status ~= nil and not statuses[details.status] then
    return "has the status " .. tostring(details.status)
  end
end

-- ---- limits and ways ----------------------------------------------------------------------------

local deadline = math.huge

local function hook()
  if os.clock() > deadline then error(late, 0) end
end

local function on_time()
  return os.clock() <= deadline
end

local progress_functions = {
  function() return on_time end,
  function(random, about)
    local f = hostile.callback(random, about)
    return function(...)
      if not on_time() then return false end
      return f(...)
    end
  end,
}

-- In a thread, which is resumed while it yields, and closed.
local function in_thread(f)
  local thread = coroutine.create(f)
  debug.sethook(thread, hook, "", 10000)
  local got
  for _ = 1, 4 do
    got = table.pack(coroutine.resume(thread, 0.5))
    if coroutine.status(thread) ~= "suspended" then break end
  end
  coroutine.close(thread)
  return got
end

local function engine()
  local array <close> = bw.array.zeros(1)
  return bw.mesh.box({min = {0, 0, 0}, max = {1, 1, 1}, cells = {1, 1, 1}}), array
end

local function release(results, pool, number, entry)
  if entry.returns and results[1] and results[2] ~= nil then pool:keep(entry.returns, results[2], number) end
end

--- Makes the call of a number: {name, outcome = "done" | "failed" | "raised" | "late", finding, message, text,
--- seconds}. `report` is given the text before the call; `limit`: seconds until it is asked to end.
function call.make(seed, number, pool, limit, report)
  local random = new_random(seed, number)
  local entry = draw(random)
  local about = {used = pool.used, depth = 0, engine = engine}
  local self
  if entry.class then
    self = random:chance(0.03) and pool:like(pool:get(entry.class, random), random) or pool:get(entry.class,
      random)
  end
  about.self = type(self) == "userdata" and self or nil
  local list = values.arguments(random, pool, entry, about)
  if special.arguments[entry.name] then special.arguments[entry.name](list) end
  if entry.kind == "method" and random:chance(0.03) then about.wrong = {hostile.value(random, pool, about)} end
  local f = prepare(entry, self, list, about.wrong)
  about.again = function() pcall(f) end
  local way = random:uniform()
  local text = text_of(entry, self, list, (about.wrong and " of " .. values.describe(about.wrong[1]) or "")
    .. (way < 0.1 and " in a thread" or way < 0.2 and " with odd progress" or way < 0.23 and " without memory"
    or ""))
  report(text)
  local start = os.clock()
  deadline = start + limit
  bw.progress(progress_functions[way >= 0.1 and way < 0.2 and 2 or 1](random, about))
  debug.sethook(hook, "", 10000)
  local got
  -- The hook may raise between the end of the call and here: that is late too, and no fault of the library.
  local ok, why = pcall(function()
    if way < 0.1 then
      got = in_thread(f)
    elseif way >= 0.2 and way < 0.23 then
      core.fail_allocation(random:integer(random:one_of {3, 30, 1000}), random:chance(0.5))
      got = table.pack(pcall(f))
      core.fail_allocation(0, false)
    else
      got = table.pack(pcall(f))
    end
    deadline = math.huge
  end)
  core.fail_allocation(0, false)
  if not ok then got = {n = 2, false, why} end
  deadline = math.huge
  debug.sethook()
  local out = {name = entry.name, text = text, seconds = os.clock() - start}
  if got[1] then
    local results = table.pack(table.unpack(got, 2, got.n))
    out.outcome = results[1] == nil and type(results[2]) == "string" and "failed" or "done"
    out.finding, out.message = bad_results(entry, results), out.outcome == "failed" and results[2] or nil
    release(got, pool, number, entry)
  else
    out.outcome, out.finding = got[2] == late and "late" or "raised", bad_error(got[2])
    out.message = type(got[2]) == "string" and got[2] or values.describe(got[2])
  end
  -- The engine is at rest: it can be entered, and nothing is kept in use.
  bw.progress(nil)
  ok, why = pcall(engine)
  if not ok then out.finding, out.message = "leaves the engine busy", tostring(why) end
  -- A field that a script sets on a plain table of results is the script's own doing.
  if entry.kind == "assignment" and out.outcome == "done" then pool:forget() end
  pool:settle(text:find("close", 1, true) ~= nil)
  return out
end

return call
