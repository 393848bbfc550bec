-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a command reports: sentences for people on standard output, or with --json one object and nothing
-- else there; errors on standard error either way.
local core = require "barwright.core"
local json = require "barwright.json"
local lengths = require "barwright.command.lengths"

local output = {}
output.__index = output
output.__name = "output"

--- Exit codes, the same of every command: yes or done; no; misuse or refused; not computed, which includes files
--- that cannot be read or written; Ctrl-C.
output.DONE, output.NO, output.MISUSED, output.FAILED, output.INTERRUPTED = 0, 1, 2, 3, 130

--- What the exit codes mean, for the help of commands: `yes` and `no` are what 0 and 1 say; `no` is left out where
--- nothing is judged.
function output.codes(yes, no)
  return ("Exit status: 0 %s; %s2 misuse or refused; 3 it could not be computed, or a file could not be read or "
    .. "written."):format(yes, no and ("1 %s; "):format(no) or "")
end

-- Statuses of failures that say that the input or the request is refused.
local refused = {misuse = true, invalid = true, unsupported = true, empty = true, different = true}

-- Whether standard output shows colours: a terminal, and nobody asked for none (no-color.org).
local function in_colour()
  local none, kind = os.getenv "NO_COLOR", os.getenv "TERM"
  return core.terminal() and (not none or none == "") and kind ~= nil and kind ~= "dumb"
end

--- For the command `name`; `opts.json` and `opts.quiet` count.
function output.create(name, opts)
  return setmetatable({name = name, machine = opts.json, quiet = opts.quiet, object = {},
    colour = in_colour()}, output)
end

-- What cannot be written is reported once, at the end.
local function write(self, text)
  local ok, why = io.stdout:write(text, "\n")
  if not ok then self.unwritten = self.unwritten or why end
end

-- Words of a verdict on a terminal, each with its colour: green, amber, red. One of a line is coloured.
local coloured = {{"too close to decide", 33}, {"the error is too large to decide", 33}, {"it holds", 32},
  {"it breaks", 31}, {"it stays below the strength", 32}, {"Sound:", 32}, {"Not sound", 31}}

--- A line with the words of verdicts in colours.
function output.paint(text)
  for _, one in ipairs(coloured) do
    local from, to = text:find(one[1], 1, true)
    if from then
      return ("%s\27[1;%dm%s\27[0m%s"):format(text:sub(1, from - 1), one[2], one[1], text:sub(to + 1))
    end
  end
  return text
end

--- A line for people; with more arguments a format and its values. Returns the line.
function output:say(text, ...)
  if select("#", ...) > 0 then text = text:format(...) end
  if self.lines then self.lines[#self.lines + 1] = text end
  if not (self.machine or self.quiet) then write(self, self.colour and output.paint(text) or text) end
  return text
end

--- A list that grows by each line that is said from now on, for a page: quiet or not.
function output:record()
  self.lines = {}
  return self.lines
end

--- The sentences among recorded lines as one text, for a page that has tables in place of the indented lists.
function output.sentences(lines)
  local kept = {}
  for _, text in ipairs(lines) do
    local first = text:match "^[^\n]*"
    if first ~= "" and not first:find "^  " and not first:find ":$" then kept[#kept + 1] = first end
  end
  return table.concat(kept, "\n")
end

--- A function that says a line, and the list of the lines that it said, for a page: quiet or not.
function output:recorded()
  local lines = {}
  return function(...) lines[#lines + 1] = self:say(...) end, lines
end

--- Fields of the object that --json prints; later ones are added to earlier ones.
function output:json(fields)
  for key, value in pairs(fields) do self.object[key] = value end
end

-- What of a table of details a JSON object can hold.
local function plain(value, depth)
  local kind = type(value)
  if kind == "string" or kind == "number" or kind == "boolean" then return value end
  if kind ~= "table" or getmetatable(value) or depth > 3 then return nil end
  local out = {}
  for key, inner in pairs(value) do
    if math.type(key) == "integer" or type(key) == "string" then out[key] = plain(inner, depth + 1) end
  end
  return out
end

--- An error: one sentence on standard error, and in the object. Returns the exit code, by the status in the
--- details.
function output:fail(message, details)
  message = tostring(message)
  if details then message = lengths(message) end -- the engine's, not those of somebody's script
  self.object.error = plain(details or {}, 0) or {}
  self.object.error.message = message
  io.stdout:flush()
  io.stderr:write("barwright ", self.name, ": ", message, "\n")
  local status = type(details) == "table" and details.status
  if core.interrupted() or status == "cancelled" then return output.INTERRUPTED end
  return refused[status] and output.MISUSED or output.FAILED
end

--- Writes files, a list of {path, function}; where there is no path there is no file. Returns the exit code of a
--- failure.
function output:write_files(list)
  local written = json.list {}
  for _, file in ipairs(list) do
    if file[1] then
      local ok, message, details = file[2]()
      if not ok then return self:fail(message, details) end
      written[#written + 1] = file[1]
    end
  end
  if #written > 0 then self:say("Written: %s.", table.concat(written, ", ")) end
  self:json {files = written}
end

--- The same for a wrong use of the command.
function output:misuse(message)
  return self:fail(message .. (" (see barwright %s --help)"):format(self.name), {status = "misuse"})
end

--- What the engine warned of meanwhile ("the surface was repaired: ..."), reported and kept in the object.
function output:warnings()
  local list = core.warnings()
  for i, warning in ipairs(list) do
    warning = lengths(warning)
    list[i] = warning
    self:say("  " .. warning)
    self.object.remarks = self.object.remarks or json.list {}
    table.insert(self.object.remarks, warning)
  end
  return list
end

--- Prints the object where it is wanted, and sees that all was written. Returns the exit code.
function output:finish(code)
  if self.machine then
    self.object.command, self.object.exit_code = self.name, code
    local ok, text = pcall(json.encode, self.object, "  ")
    if not ok then
      io.stderr:write("barwright ", self.name, ": ", tostring(text), "\n")
      return output.FAILED
    end
    write(self, text)
  end
  local ok, why = io.stdout:flush()
  if self.unwritten or not ok then
    io.stderr:write("barwright ", self.name, ": standard output: ", tostring(self.unwritten or why), "\n")
    return output.FAILED
  end
  return code
end

return output
