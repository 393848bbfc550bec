-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One scenario while it runs. Every expectation, note, table and picture is a line of JSON in a file as
-- soon as it is known, so that it is still there when the process that runs the scenario is not.
local core = require "barwright.core"
local files = require "barwright.scenario.files"
local json = require "barwright.json"

local raise = core.raise

local record = {}

local library = debug.getinfo(1, "S").source:match "^(.*)scenario/record%.lua$" or "barwright/scenario"

local max_calls = 20 -- of a traceback

local running -- the scenario that runs in this process

--- The running scenario; raises where there is none.
function record.running(who)
  return running or raise(who .. ": only inside a scenario")
end

local function write(line)
  running.file:write(json.encode(line), "\n")
  running.file:flush()
end

-- The line of the scenario file that is on the way out, also where a helper was called.
local function line_of()
  for level = 3, 200 do
    local at = debug.getinfo(level, "Sl")
    if not at then return nil end
    if at.source == "@" .. running.scenario_file then return at.currentline end
  end
end

--- Keeps one judged expectation.
function record.expectation(entry)
  entry.kind, entry.line = "expectation", line_of()
  running.expectations = running.expectations + 1
  if not entry.good then running.failed = running.failed + 1 end
  write(entry)
  return entry.good, entry.message
end

-- ---- what a scenario's function is given -----------------------------------------------------------------

local methods = {}
record.methods = methods

-- Raised to leave a scenario; anything else that is raised is an error of it.
local Stop = {__tostring = function(self) return self.message end}

--- Goes on only with a value: like assert, but what failed before stands and nothing is a fault of the
--- script. Also takes what an expectation returns: t:require(expect(x):below(1)).
function methods.require(_, value, message, ...)
  if value == nil or value == false then
    local line = line_of()
    error(setmetatable({line = line, judged = value == false and running.failed > 0 and message == running.said,
      message = message and tostring(message) or "a value was required, but there is none"}, Stop), 0)
  end
  return value, message, ...
end

--- Leaves the scenario without judging it: what it needs is not there.
function methods.skip(_, reason)
  if type(reason) ~= "string" then raise("skip: the reason expected, got " .. core.got(reason)) end
  error(setmetatable({skip = reason}, Stop), 0)
end

--- A sentence for the report and the manual.
function methods.note(_, text, ...)
  if type(text) ~= "string" then raise("note: a text expected, got " .. core.got(text)) end
  if select("#", ...) > 0 then
    local ok, filled = pcall(string.format, text, ...)
    if not ok then
      raise("note: the values do not fit the text: " .. tostring(filled):gsub("^bad argument ", "argument "))
    end
    text = filled
  end
  write {kind = "note", text = text}
end

--- A plain table for the report and the manual: {heads = {...}, rows = {{...}, ...}, text = "..."}.
function methods.table(_, given)
  if type(given) ~= "table" or type(given.heads) ~= "table" or type(given.rows) ~= "table" then
    raise("table: {heads = {...}, rows = {{...}, ...}} expected, got " .. (type(given) == "table"
      and ("heads = %s and rows = %s"):format(core.got(given.heads), core.got(given.rows)) or core.got(given)))
  end
  local rows = json.list {}
  for i, row in ipairs(given.rows) do
    if type(row) ~= "table" then raise(("table: row %d: a list of cells expected, got %s"):format(i,
      core.got(row))) end
    rows[i] = json.list {}
    for k = 1, #given.heads do rows[i][k] = row[k] == nil and "" or tostring(row[k]) end
  end
  write {kind = "table", heads = json.list(given.heads), rows = rows, text = given.text}
end

--- Drawn when the scenario fails: an object with a picture (static, modes, worst case, mesh, ...; for
--- modes the number comes in `options.mode`), a figure of bw.plot, or a function of a path.
function methods.picture_of(_, object, options)
  if type(object) ~= "function" and type(object) ~= "userdata" and type(object) ~= "table" then
    raise(("picture_of: an object with a picture expected, got %s"):format(core.got(object)))
  end
  table.insert(running.pictures, {object = object, options = options, line = line_of()})
end

local Test = {__name = "barwright.test", __tostring = function() return "test: " .. running.title end}

-- t.folder is made when it is asked for, and removed at the end.
function Test.__index(_, name)
  if name == "folder" then
    running.scratch = running.scratch or files.scratch()
    return running.scratch
  end
  return methods[name] or raise(("a test has no '%s': %s"):format(tostring(name),
    core.suggestion(tostring(name), {"require", "skip", "note", "table", "picture_of", "folder"})))
end

-- ---- pictures ----------------------------------------------------------------------------------------------

local function method(object, name)
  local ok, found = pcall(function() return object[name] end)
  return ok and type(found) == "function" and found
end

local function draw_one(picture, stem)
  local object, options = picture.object, picture.options or {}
  local title = options.caption
  local given = {}
  for key, value in pairs(options) do given[key] = value end
  given.caption, given.mode = nil, nil
  local path = stem .. ".png"
  local ok, why
  if type(object) == "function" then
    ok, why = object(path)
    if ok == nil and why == nil then ok = files.kind(path) == "file" end
  elseif method(object, "picture") then
    if method(object, "shape") and method(object, "picture") and object.frequencies then
      ok, why = object:picture(options.mode or 1, path, given)
    else
      ok, why = object:picture(path, given)
    end
  elseif method(object, "write") and method(object, "svg") then
    path = stem .. ".svg"
    ok, why = object:write(path)
  else
    why = "this object has no picture"
  end
  if not ok then return nil, why end
  return path, title
end

local function draw(folder, stem)
  for i, picture in ipairs(running.pictures) do
    local name = ("%s-%d"):format(stem, i)
    local done, path, title = pcall(draw_one, picture, folder .. "/" .. name)
    local made = done and path
    if made then
      write {kind = "picture", file = made:match "[^/]*$", caption = title or running.title, line = picture.line}
    else
      write {kind = "note", text = ("a picture could not be drawn: %s"):format(tostring(done and title or path))}
    end
  end
end

-- ---- running -------------------------------------------------------------------------------------------------

-- The calls of the script on the way to an error: from where the library called it.
local function trace()
  local out = {}
  for level = 3, 200 do
    local at = debug.getinfo(level, "Sln")
    if not at then break end
    if at.currentline > 0 and not at.source:find(library, 1, true) then
      if #out == max_calls then return table.concat(out, "\n") .. "\n..." end
      out[#out + 1] = ("%s:%d:%s"):format(at.short_src, at.currentline, at.name and " in " .. at.name or "")
    end
  end
  return #out > 1 and table.concat(out, "\n") or nil
end

local function on_error(message)
  if getmetatable(message) == Stop then return message end
  local meta = getmetatable(message)
  local text = type(message) == "string" and message
    or type(meta) == "table" and meta.__tostring and tostring(message) or ("raised a %s"):format(type(message))
  return {text = text, trace = trace(), line = line_of()}
end

local function ending(ok, raised)
  if ok then
    if running.failed > 0 then return {status = "failed"} end
    if running.expectations == 0 then return {status = "failed", message = "it states no expectation"} end
    return {status = "passed"}
  end
  if getmetatable(raised) == Stop then
    if raised.skip then
      if running.failed > 0 then return {status = "failed"} end
      return {status = "skipped", message = raised.skip}
    end
    return {status = "failed", message = not raised.judged and raised.message or nil, line = raised.line}
  end
  if type(raised) == "string" then -- without memory, Lua calls no handler
    collectgarbage()
    return {status = "memory", message = raised}
  end
  return {status = "error", message = raised.text, trace = raised.trace, line = raised.line}
end

--- Runs a scenario of a file, whose lines go to the file at `path`. options: update (of baselines),
--- pictures (folder or nil), all_pictures, stem (how their names begin).
function record.run(scenario, scenario_file, path, options)
  running = {file = assert(io.open(path, "wb")), scenario_file = scenario_file, title = scenario.title,
    expectations = 0, failed = 0, pictures = {}, options = options}
  local t = setmetatable({}, Test)
  local start = core.seconds()
  local ok, raised = xpcall(scenario.work, on_error, t)
  local last = ending(ok, raised)
  last.kind, last.seconds_run = "end", core.seconds() - start
  if options.pictures and (options.all_pictures or last.status == "failed" or last.status == "error") then
    draw(options.pictures, options.stem)
  end
  if running.scratch then files.remove_scratch(running.scratch) end
  write(last)
  running.file:close()
  running = nil
  return last.status
end

return record
