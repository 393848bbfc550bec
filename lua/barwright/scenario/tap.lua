-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Results as TAP, version 14: one line for each scenario, and under those that did not pass a block that
-- says why.
local json = require "barwright.json"
local numbers = require "barwright.scenario.numbers"

local tap = {}

-- A description must not have what begins a directive, and is one line.
local function escaped(text)
  return (text:gsub("\\", "\\\\"):gsub("#", "\\#"):gsub("%s+", " "):gsub("%c", "?"))
end

-- A text in YAML, which takes JSON's strings.
local function quoted(text)
  return json.encode(text)
end

function tap.plan(count)
  return ("TAP version 14\n1..%d"):format(count)
end

local function name_of(result)
  return ("%s: %s"):format(result.file, result.title)
end
tap.name_of = name_of

--- Where a result was decided: "file:line".
function tap.place(result, line)
  line = line or result.at_line or result.line
  return line and ("%s:%d"):format(result.file, line) or result.file
end

--- A message with its place in front, unless it begins with one.
function tap.placed(result, message, line)
  if message:find(result.file, 1, true) == 1 then return message end
  return ("%s: %s"):format(tap.place(result, line), message)
end

local function failures(result, out)
  for _, entry in ipairs(result.entries) do
    if entry.kind == "expectation" and not entry.good then
      out[#out + 1] = ("    - message: %s"):format(quoted(entry.message))
      out[#out + 1] = ("      at: %s"):format(quoted(tap.place(result, entry.line)))
      if entry.source then out[#out + 1] = ("      source: %s"):format(quoted(entry.source)) end
    end
  end
end

--- The lines of the result with this number. `verbose`: also every expectation that was met.
function tap.lines(number, result, verbose)
  local good = result.status == "passed" or result.status == "skipped"
  local out = {("%s %d - %s%s"):format(good and "ok" or "not ok", number, escaped(name_of(result)),
    result.status == "skipped" and " # SKIP" .. (result.message and " " .. escaped(result.message) or "") or "")}
  if not good then
    out[#out + 1] = "  ---"
    out[#out + 1] = "  status: " .. result.status
    if result.message then
      out[#out + 1] = "  message: " .. quoted(result.message)
      if tap.placed(result, result.message) ~= result.message then
        out[#out + 1] = "  at: " .. quoted(tap.place(result))
      end
    end
    local list = {}
    failures(result, list)
    if #list > 0 then out[#out + 1] = "  expectations:" end
    table.move(list, 1, #list, #out + 1, out)
    for _, entry in ipairs(result.entries) do
      if entry.kind == "picture" then out[#out + 1] = "  picture: " .. quoted(entry.file) end
    end
    if result.trace then out[#out + 1] = "  traceback: " .. quoted(result.trace) end
    if result.output then out[#out + 1] = "  output: " .. quoted(result.output) end
    out[#out + 1] = "  ..."
  end
  if verbose then
    for _, entry in ipairs(result.entries) do
      if entry.kind == "expectation" and entry.good then
        out[#out + 1] = escaped(("%s: %s%s (%s)"):format(entry.quantity or entry.form,
          numbers.show(entry.figure), entry.unit and " " .. entry.unit or "", entry.allowed)):gsub("^", "# ", 1)
      end
    end
  end
  return out
end

return tap
