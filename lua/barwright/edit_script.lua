-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Sessions as scripts. A saved script, and the journal that grows by a line with every edit, both
-- look like this and are ordinary Lua:
--
--   local session = require("barwright").edit.begin("part.lua", ...)
--   assert(session:bone("neck"):scale{1, 1.2, 1.2})
--   assert(session:undo())
--
-- part.lua returns the part and the options of bw.edit, or a session. So `barwright edits.lua` replays the whole,
-- and bw.edit.load("edits.lua", session) replays into a session at hand. Numbers are written so that
-- they read back with the same bits.
local core = require "barwright.core"
local read_file = require "barwright.read_file"

local raise = core.raise

local edit_script = {}

-- ---- values ----------------------------------------------------------------------------------------

local function number(value)
  if math.type(value) == "integer" then return ("%d"):format(value) end
  for digits = 15, 17 do
    local text = ("%%.%dg"):format(digits):format(value)
    if tonumber(text) == value then return text end
  end
  raise(("a finite number expected, got %s"):format(core.got(value)))
end

local function is_list(value)
  local count = 0
  for _ in pairs(value) do count = count + 1 end
  return count == #value
end

--- A value as Lua text: numbers exactly, keys in order.
function edit_script.value(value)
  local kind = type(value)
  if kind == "number" then return number(value) end
  if kind == "string" then return (("%q"):format(value):gsub("\\\n", "\\n")) end
  if core.class_name(value) == "array" then return edit_script.value(value:totable()) end
  if kind ~= "table" then return tostring(value) end
  local parts = {}
  if is_list(value) then
    for i, entry in ipairs(value) do parts[i] = edit_script.value(entry) end
  else
    local keys = {}
    for key in pairs(value) do keys[#keys + 1] = key end
    table.sort(keys, function(a, b) return tostring(a) < tostring(b) end)
    for _, key in ipairs(keys) do
      local name = type(key) == "string" and key:match "^[%a_][%w_]*$" or nil
      parts[#parts + 1] = (name and name .. " = " or "[" .. edit_script.value(key) .. "] = ")
        .. edit_script.value(value[key])
    end
  end
  return "{" .. table.concat(parts, ", ") .. "}"
end

edit_script.list = edit_script.value
edit_script.vector = edit_script.value

-- ---- writing -----------------------------------------------------------------------------------------

local function head(script)
  return "-- Edits of a barwright session: run it with `barwright`, or replay it into a session with\n"
    .. "-- bw.edit.load.\n"
    .. ("local session = require(\"barwright\").edit.begin(%s, ...)\n"):format(
      edit_script.value(script))
end

--- The edits in force.
function edit_script.save(session, path)
  local lines = {head(session.opts.script)}
  for i = 2, session.position do
    lines[#lines + 1] = ("assert(%s)\n"):format(session.history[i].script)
  end
  lines[#lines + 1] = "return session\n"
  return core.write_file(path, table.concat(lines))
end

local journal = {}
journal.__index = journal

local function io_failure(path, why)
  return nil, ("%s: %s"):format(path, why), {status = "io", file = path}
end

-- Opens the file for more lines; `size` bytes of it are good.
local function append(self)
  local file, why = io.open(self.path, "ab")
  if not file then return nil, why, {status = "io", file = self.path} end
  self.file, self.size = file, file:seek "end"
  return self
end

-- After a line that could not be written (a full disk): what came of it is cut off.
local function cut_torn_line(self)
  local text, why = read_file(self.path)
  if not text then return nil, why, {status = "io", file = self.path} end
  if #text > self.size then
    local ok, message, details = core.write_file(self.path, text:sub(1, self.size))
    if not ok then return nil, message, details end
  end
  return append(self)
end

--- A line that is on its way to the disk before the edit counts.
function journal:add(script)
  if not self.file then
    local ok, message, details = cut_torn_line(self)
    if not ok then return nil, message, details end
  end
  local line = ("assert(%s)\n"):format(script)
  local ok, why = self.file:write(line)
  if ok then ok, why = self.file:flush() end
  if not ok then
    self.file:close()
    self.file = false
    return io_failure(self.path, why)
  end
  self.size = self.size + #line
  return true
end

function journal:close()
  if self.file then self.file:close() else cut_torn_line(self) end
  self.file = false
end

local function go_on(path)
  return append(setmetatable({path = path, file = false}, journal))
end

--- A new journal. One that is there already is kept beside it, as edits.lua~; what is no journal (a
--- part's script, a folder, a device) is left alone.
function edit_script.open_journal(path, script)
  local old = io.open(path, "rb")
  if old then
    local text, why = old:read(4096)
    old:close()
    if why or text and not text:find("edit.begin(", 1, true) then
      return io_failure(path, "is there already and is no journal of edits: give the journal another name")
    end
    local kept = not text -- nothing to keep of an empty file
    if text then kept, why = os.rename(path, path .. "~") end
    if not kept then return nil, why, {status = "io", file = path} end
  end
  local ok, message, details = core.write_file(path, head(script))
  if not ok then return nil, message, details end
  return go_on(path)
end

--- From now on the session's journal is at this path; it begins with the edits in force. One that is
--- there already is kept beside it.
function edit_script.keep(session, path)
  local record, message, details = edit_script.open_journal(path, session.opts.script)
  if not record then return nil, message, details end
  for i = 2, session.position do
    local ok
    ok, message, details = record:add(session.history[i].script)
    if not ok then return nil, message, details end
  end
  if session.record then session.record:close() end
  session.record = record
  return session
end

-- ---- replaying -----------------------------------------------------------------------------------------

-- Of the script at hand, while load runs it: the session that it began (a journal does not return it), and
-- the details of what failed in it.
local begun, failure
local loads = 0 -- that run, one within the other

local function began(session)
  if loads > 0 then begun = session end
  return session
end

-- What a script runs in: all there is, and an assert that keeps the details.
local function globals()
  local function keeping(value, message, details, ...)
    if value then return value, message, details, ... end
    failure = details
    error(message, 0)
  end
  return setmetatable({assert = keeping}, {__index = _G, __newindex = _G})
end

local function exists(path)
  local file = io.open(path, "rb")
  if file then file:close() end
  return file ~= nil
end

-- As given, else beside the script that asks for it.
local function find(path, asking)
  if exists(path) then return path end
  local folder = asking:match "^@(.*[/\\])"
  return folder and exists(folder .. path) and folder .. path or path
end

--- The session of a saved script: the one that it is replayed into, or a new one on the part that
--- the file `script` returns with the options, or the session that it returns. `asking` is the source
--- that calls.
function edit_script.begin(edit, asking, script, given)
  if getmetatable(given) == edit.class then
    return began(given)
  end
  if not script then
    raise("these edits name no script that makes their part: "
      .. "replay them with bw.edit.load(path, session)")
  end
  local part, given_with = dofile(find(script, asking))
  if getmetatable(part) == edit.class then
    part.opts.script = part.opts.script or script
    return began(part)
  end
  local opts = {}
  for key, value in pairs(given_with or {}) do opts[key] = value end
  opts.journal, opts.script = nil, opts.script or script
  local session, message, details = edit(part, opts)
  if session then return began(session) end
  failure = loads > 0 and details or nil
  raise(message)
end

-- The lines of a script; what stands after the last line end was cut off in the middle.
local function read_whole_lines(path)
  local text, why = read_file(path)
  if not text then return nil, why, {status = "io", file = path} end
  local whole = text:match "^(.*\n)" or ""
  return whole, whole ~= text
end

-- What went wrong, with the line of the script that it happened on.
local function with_line(path)
  return function(message)
    message = type(message) == "string" and message or tostring(message)
    local level = 2
    local info = debug.getinfo(level, "Sl")
    while info and info.source ~= "@" .. path do
      level = level + 1
      info = debug.getinfo(level, "Sl")
    end
    if not info then return message end
    local position = ("%s:%d: "):format(info.short_src, info.currentline)
    if message:sub(1, #position) == position then message = message:sub(#position + 1) end
    return ("line %d: %s"):format(info.currentline, message)
  end
end

-- These are not the script's fault.
local passed_on = {cancelled = true, memory = true, io = true}

local function not_replayed(path, why, details, moved)
  local status = core.interrupted() and "cancelled" or details and passed_on[details.status]
    and details.status or "format"
  return nil, ("%s %s: %s%s"):format(path, status == "cancelled" and "was interrupted while it was replayed"
    or "could not be replayed", why, moved and "; the edits on the lines before are made" or ""),
    {status = status, file = path}
end

--- Replays a script into a session, or into the one it begins. {resume = true} goes on with the file
--- as the session's journal.
function edit_script.load(edit, path, session, given)
  if type(path) ~= "string" then raise("edit.load: path: a string expected, got " .. core.got(path)) end
  if session ~= nil and getmetatable(session) ~= edit.class then
    raise("edit.load: session: a session expected, got " .. core.got(session))
  end
  local opts = require "barwright.options".read("edit.load", given,
    {resume = {type = "boolean", default = false}})
  local text, cut, details = read_whole_lines(path)
  if not text then return nil, cut, details end
  local chunk, message = load(text, "@" .. path, "t", globals())
  if not chunk then return nil, message, {status = "format", file = path} end
  begun, failure = nil, nil
  local before = session and session.position
  loads = loads + 1
  local ok, result = xpcall(chunk, with_line(path), session)
  loads = loads - 1
  local made, why = begun, failure
  begun, failure = nil, nil
  if not ok then return not_replayed(path, result, why, session and session.position ~= before) end
  session = getmetatable(result) == edit.class and result or made or session
  if not session then
    return nil, path .. ": not a script of an edit session", {status = "format", file = path}
  end
  if opts.resume then
    text = text:gsub("return session\n$", "")
    ok, message, details = core.write_file(path, text)
    if not ok then return nil, message, details end
    if session.record then session.record:close() end
    session.record = false
    local record
    record, message, details = go_on(path)
    if not record then return nil, message, details end
    session.record = record
  end
  return session, cut
end

return edit_script
