-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Values that nobody expects. Paths and texts that may become paths are relative: files stay in the folder that
-- the run has for itself.
local hostile = {}

local names = setmetatable({}, {__mode = "k"}) -- of functions, tables and threads, for the log

local function named(name, value)
  names[value] = name
  return value
end

--- What a value is, for the log.
function hostile.name(value)
  return names[value]
end

hostile.numbers = {0, -0.0, 1, -1, 2, 3, 7, 0.5, -0.5, 1.5, 1e-300, 1e300, -1e300, 5e-324, 0 / 0, math.huge,
  -math.huge, 255, 256, 65536, 1000000, 2^31 - 1, 2^31, -2^31, 2^32, 2^53, 2^63, 2147483647, 2147483648,
  -2147483648, 4294967295, 4294967296, 1 << 40, 1 << 53, 1 << 61, 1 << 62, math.maxinteger, math.mininteger,
  math.maxinteger // 8, math.maxinteger // 24, -1000, 1e9, 1e18}

hostile.texts = {"", " ", "\0", "a\0b", "x", "nan", "inf", "1e999", "-1", "0x10", "1", "%s%n%d", "\255\254",
  "é", "\n",
  "no/such/folder/x.vtu", ".", "..", "a/b/../c.stl", "file:x?mode=memory", "-", "x^2 + y^2 + z^2 - 1", "x/0",
    "x +",
  ("("):rep(300), ("-"):rep(5000) .. "x", ("x+"):rep(3000) .. "x", ("n"):rep(5000), ("1"):rep(400),
  ("a"):rep(100000), ("[1,"):rep(2000), "<svg/>", "where(x>0,1,0)", "f'", "nil", "'; drop table trial; --"}

local raised = setmetatable({}, {__tostring = function() return "raised by the fuzzer" end})
hostile.raised = raised -- an error value that callbacks raise, beside texts that begin with "fuzz:"

local function deep(depth)
  local t = {}
  for _ = 1, depth do t = {t} end
  return t
end

local function long(count, value)
  local t = {}
  for i = 1, count do t[i] = value end
  return t
end

local function cycle()
  local t = {1, 2, 3}
  t[2], t.x, t.self = t, t, t
  return t
end

local function with(name, meta, content)
  return named(name, setmetatable(content or {}, meta))
end

local function raising(name)
  return with("<" .. name .. " raises>", {[name] = function() error("fuzz: " .. name, 0) end}, {1, 2, 3})
end

-- Made for each use: what is called may keep or change them.
hostile.tables = {
  function() return {} end,
  function() return {{}} end,
  function() return {1} end,
  function() return {1, 2} end,
  function() return {1, 2, 3} end,
  function() return {0 / 0, 0, 0} end,
  function() return {math.huge, 0, 1e300} end,
  function() return {1, "two", {3}} end,
  function() return {[1] = 1, [3] = 3, [1000000] = 2} end,
  function() return {[0.5] = 1, [true] = 2} end,
  function() return {x = 1, y = 2, z = 3} end,
  function() return {{1, 2}, {3}} end,
  function() return {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}} end,
  function() return {false, false, false} end,
  function() return named("<200 deep>", deep(200)) end,
  function() return named("<5000 deep>", deep(5000)) end,
  function() return named("<20000 ones>", long(20000, 1)) end,
  function() return named("<300 empty>", long(300, "")) end,
  function() return named("<cycle>", cycle()) end,
  function() return raising "__index" end,
  function() return raising "__newindex" end,
  function() return raising "__len" end,
  function() return raising "__pairs" end,
  function() return raising "__tostring" end,
  function() return raising "__eq" end,
  function() return raising "__call" end,
  function() return raising "__close" end,
  function() return with("<len huge>", {__len = function() return 1 << 53 end}, {1, 2, 3}) end,
  function() return with("<len -1>", {__len = function() return -1 end}, {1, 2, 3}) end,
  function() return with("<len text>", {__len = function() return "3" end}, {1, 2, 3}) end,
  function() return with("<index number>", {__index = function() return 1 end}) end,
  function() return with("<index text>", {__index = function() return "x" end}) end,
  function()
    local t = {}
    return with("<index itself>", {__index = function() return t end}, t)
  end,
  function()
    local n = 0
    return with("<index changes>", {__index = function()
      n = n + 1
      return ({1, {}, "x", 0 / 0, -1, false})[n % 6 + 1]
    end})
  end,
  function() return with("<name a number>", {__name = 5}) end,
  function() return with("<name a text>", {__name = "barwright.mesh", __tostring = function()
    return 5 end}) end,
  function() return with("<metatable false>", {__metatable = false}) end,
  function() return with("<metatable number>", {__metatable = 5}) end,
  function() return with("<pairs odd>", {__pairs = function() return function() return nil end end}, {1}) end,
  function() return with("<called>", {__call = function() return 1 end}) end,
}

local function closed_file()
  local file = assert(io.tmpfile())
  file:close()
  return file
end

-- Of other kinds.
hostile.others = {
  function() return true end,
  function() return false end,
  function() return io.stderr end,
  function() return named("<closed file>", closed_file()) end,
  function() return named("<new thread>", coroutine.create(function() end)) end,
  function()
    local thread = coroutine.create(function() end)
    coroutine.resume(thread)
    return named("<dead thread>", thread)
  end,
  function() return named("<wrapped>", coroutine.wrap(function() coroutine.yield(1) end)) end,
}

-- Functions that the engine may call. `about` has what the call is of: self (or nil), call (does it again),
-- pool, engine (any harmless call of the engine).
hostile.callbacks = {
  {"returns 1", function() return function() return 1 end end},
  {"returns 0.1", function() return function() return 0.1 end end},
  {"returns true", function() return function() return true end end},
  {"returns false", function() return function() return false end end},
  {"returns nothing", function() return function() end end},
  {"returns nan", function() return function() return 0 / 0 end end},
  {"returns -inf", function() return function() return -math.huge end end},
  {"returns 1e300", function() return function() return 1e300 end end},
  {"returns a text", function() return function() return "garbage" end end},
  {"returns a table", function() return function() return {} end end},
  {"returns many", function() return function() return table.unpack(long(200, 1)) end end},
  {"returns its argument", function() return function(...) return ... end end},
  {"sums", function() return function(x, y, z) return (tonumber(x) or 0) + (tonumber(y) or 0) + (tonumber(z)
    or 0) end
  end},
  {"raises a text", function() return function() error("fuzz: callback", 0) end end},
  {"raises a table", function() return function() error(raised) end end},
  {"raises nil", function() return function() error(nil) end end},
  {"yields", function() return function(...) return coroutine.yield(...) end end},
  {"calls the engine", function(about) return function()
    about.engine()
    return 1
  end end},
  {"calls the engine protected", function(about) return function()
    pcall(about.engine)
    return 1
  end end},
  {"closes", function(about) return function()
    if about.self then about.self:close() end
    return 1
  end end},
  {"closes protected", function(about) return function()
    if about.self then pcall(function() about.self:close() end) end
    return 1
  end end},
  {"closes others", function(about) return function()
    for _, object in ipairs(about.used) do pcall(function() object:close() end) end
    return 1
  end end},
  {"calls again", function(about) return function()
    if about.depth < 3 then
      about.depth = about.depth + 1
      about.again()
    end
    return 1
  end end},
  {"collects", function() return function()
    collectgarbage()
    return 1
  end end},
  {"in a thread", function(about) return coroutine.wrap(function()
    while true do
      pcall(about.engine)
      coroutine.yield(1)
    end
  end) end},
  {"print", function() return print end},
  {"deep", function()
    local function f(x) return 1 + f(x) end
    return f
  end},
}

--- One of the functions above.
function hostile.callback(random, about)
  local one = random:one_of(hostile.callbacks)
  return named("<" .. one[1] .. ">", one[2](about))
end

--- Any value; `pool` gives objects.
function hostile.value(random, pool, about)
  local kind = random:integer(14)
  if kind == 1 then return nil end
  if kind <= 5 then return random:one_of(hostile.numbers) end
  if kind <= 7 then return random:one_of(hostile.texts) end
  if kind <= 10 then return random:one_of(hostile.tables)() end
  if kind == 11 then return random:one_of(hostile.others)() end
  if kind == 12 then return hostile.callback(random, about) end
  if kind == 13 then return pool:any(random) end
  return pool:closed(random)
end

hostile.named = named

return hostile
