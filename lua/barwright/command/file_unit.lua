-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The unit of the numbers in a file: whether the size that it gives makes sense, and what the user is asked,
-- and what is printed, where the format has no unit.
local core = require "barwright.core"
local json = require "barwright.json"
local shown = require "barwright.shown"

local file_unit = {}

--- The names that --unit takes.
file_unit.names = {"mm", "cm", "m", "km", "um", "in", "ft"}

--- The names in words.
file_unit.words = {mm = "millimetres", cm = "centimetres", m = "metres", km = "kilometres", um = "micrometres",
  ["in"] = "inches", ft = "feet"}

local lengths = {mm = 1e-3, cm = 1e-2, m = 1, km = 1e3, um = 1e-6, ["in"] = 0.0254, ft = 0.3048}

--- The length of a unit in m; nil where there is none of the name.
function file_unit.metres(name) return lengths[name] end

--- The length in m that one of the numbers in the file was taken for.
function file_unit.taken(read) return read.metres_per_unit or 1 end

-- What is made, printed, cast and tested lies mostly between these lengths.
local SMALLEST, LARGEST = 5e-3, 3
local units = {{"mm", 1e-3}, {"in", 0.0254}, {"cm", 1e-2}, {"m", 1}}

-- How the units that are likely are offered on a command line.
local by_option = {each = function(unit, shown_size) return ("--unit %s makes it %s"):format(unit, shown_size) end,
  none = " Is that what is meant? (--unit)"}

--- Whether the size makes sense, or a sentence on what unit the file may be in. `size` in metres as read with
--- `metres` to a unit of the file; asked: whether the unit was given; words: how units are offered.
function file_unit.guess(size, metres, asked, words)
  words = words or by_option
  local longest = math.max(table.unpack(size))
  if asked or longest >= SMALLEST and longest <= LARGEST then return nil end
  local likely = {}
  for _, unit in ipairs(units) do
    local length = longest / metres * unit[2]
    if length >= SMALLEST and length <= LARGEST and math.abs(unit[2] - metres) > 1e-9 then
      likely[#likely + 1] = unit
    end
  end
  local head = ("The numbers were taken as %s, which makes it %s: %s for a part."):format(
    metres == 1 and "metres" or metres == 1e-3 and "millimetres" or ("%g m"):format(metres),
    shown.size(size), longest < SMALLEST and "small" or "large")
  if #likely == 0 then return head .. words.none, {} end
  local texts, names = {}, {}
  local function scaled(by)
    return {by * size[1], by * size[2], by * size[3]}
  end
  for i, unit in ipairs(likely) do
    names[i] = unit[1]
    texts[i] = words.each(unit[1], shown.size(scaled(unit[2] / metres)))
  end
  return head .. " " .. table.concat(texts, ", ") .. ".", names
end

-- Formats that have a unit.
local function has_unit(read)
  for _, format in ipairs {"3MF", "glTF", "STEP", "IGES"} do
    if read.format:sub(1, #format) == format then return true end
  end
  return false
end

-- Formats whose numbers are metres by definition: those of meshes, of surfaces too. The readers say so.
local function in_metres(read)
  return file_unit.taken(read) == 1 and not has_unit(read) and not read.by_environment
end

--- The lengths of a box along the axes.
function file_unit.size_of(box)
  local size = {}
  for i = 1, #box.min do size[i] = box.max[i] - box.min[i] end
  return size
end

--- The name of a length as a unit, or nil.
function file_unit.name_of(metres)
  for _, name in ipairs(file_unit.names) do
    if math.abs(metres / lengths[name] - 1) < 1e-9 then return name end
  end
end

-- Asks on the terminal until a unit is given; nil at the end of the input. default: nil where it is in doubt.
local function ask(question, default)
  while true do
    io.stdout:write(question, default and (" Unit [%s]: "):format(default) or " Unit: ")
    io.stdout:flush()
    local line = io.stdin:read "l"
    if not line then
      io.stdout:write "\n"
      return nil
    end
    line = line:match "^%s*(.-)%s*$"
    if line == "" and default then return default end
    if lengths[line] then return line end
    question = ("One of %s is expected."):format(table.concat(file_unit.names, ", "))
  end
end

-- Whether somebody is there to answer.
local function can_ask(opts)
  return not opts.json and not opts.quiet and core.terminal() and core.terminal(true)
end

-- The environment's unit; nil where there is none.
local function environment()
  local name = os.getenv "BARWRIGHT_UNIT"
  return name ~= "" and name or nil
end

--- The unit that the environment gives to a file that was read and has none, or nil; false and a sentence where it
--- is no unit. Meshes are in metres whatever it says.
function file_unit.of_environment(read)
  local name = environment()
  if not name or read.kind == "outline" or has_unit(read) or in_metres(read) then return nil end
  if lengths[name] then return name end
  return false, ("BARWRIGHT_UNIT: one of %s expected, got '%s'"):format(table.concat(file_unit.names, ", "), name)
end

--- What is to be done about the unit of a file that was read: nil, it stays as it was taken; the name of the unit
--- that the user gave on the terminal; or false and a sentence that refuses it. Says what was assumed.
function file_unit.settle(read, path, opts, out)
  if opts.unit or read.kind == "outline" then return nil end
  local size, metres = file_unit.size_of(read.box), file_unit.taken(read)
  local doubt, likely = file_unit.guess(size, metres)
  local name, known = file_unit.name_of(metres), read.by_environment or has_unit(read)
  out:json {unit_assumed = not known, unit_suggestions = likely and json.list(likely)}
  if (doubt or not known and not environment()) and can_ask(opts) then
    local unit = ask(doubt and ("%s: %s"):format(path, doubt)
      or ("%s: the file has no unit; in %s it is %s."):format(path, name, shown.size(size)), not doubt and name)
    if unit then
      out:json {unit_assumed = false}
      out:say("Without a question: --unit %s%s.", unit, in_metres(read) and ""
        or (", or BARWRIGHT_UNIT=%s for all surfaces that have no unit"):format(unit))
      return unit
    end
  end
  if doubt then return false, ("%s: %s Nothing was computed; --unit confirms a unit."):format(path, doubt) end
  if read.by_environment or not known then
    out:say("The file has no unit: its numbers are taken as %s (%s gives another).", name,
      read.by_environment and "BARWRIGHT_UNIT; --unit" or "--unit")
  end
  return nil
end

return file_unit
