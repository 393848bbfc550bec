-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Histories: values that change in time, as a number, a function, rows {time, value} or a CSV file with such rows.
local core = require "barwright.core"
local read_file = require "barwright.read_file"

local raise = core.raise

local history = {}

-- The value at a time of {{time, value}, ...}, linear between the rows and constant outside.
local function interpolate(rows, time)
  local low, high = 1, #rows
  if time <= rows[low][1] then return rows[low][2] end
  if time >= rows[high][1] then return rows[high][2] end
  while high - low > 1 do
    local middle = (low + high) // 2
    if rows[middle][1] <= time then low = middle else high = middle end
  end
  local a, b = rows[low], rows[high]
  return a[2] + (b[2] - a[2]) * (time - a[1]) / (b[1] - a[1])
end

local function finite(number)
  return type(number) == "number" and number == number and math.abs(number) < math.huge
end

-- Why a row may not follow the one before it, or nil; `name` of its first value.
local function fault(row, before, name)
  if not finite(row[1]) then return ("a %s is missing or not a finite number"):format(name) end
  if not finite(row[2]) then return "a value is missing or not a finite number" end
  if before and row[1] <= before[1] then
    return ("the %s %g does not follow the %s %g before it: %s must ascend"):format(name, row[1], name, before[1],
      ((name .. "s"):gsub("ys$", "ies")))
  end
end

-- Raises for what are no rows of ascending times.
local function check_rows(what, rows)
  if type(rows) ~= "table" or type(rows[1]) ~= "table" then
    raise(("%s: a number, a function of time, rows {time, value} of ascending times or the path of a CSV file "
      .. "expected, got %s"):format(what, core.got(rows)))
  end
  for i, row in ipairs(rows) do
    local wrong = type(row) ~= "table" and "{time, value} expected, got " .. core.got(row)
      or fault(row, rows[i - 1], "time")
    if wrong then raise(("%s: row %d: %s"):format(what, i, wrong)) end
  end
end

--- Rows {time, value} of a file: two columns behind comments (#) and one line of headings. `name`: of the first
--- column, where it is no time. Also the line of the last row.
function history.rows(path, name)
  name = name or "time"
  local text, why = read_file(path)
  if not text then return nil, why, {status = "io", file = path} end
  if text:find "[%z\1-\8\14-\31]" then
    return nil, ("%s: no text file: rows of a %s and a value expected"):format(path, name),
      {status = "format", file = path}
  end
  local rows, number, last, headings = {}, 0, 0, false
  for line in text:gsub("^\xEF\xBB\xBF", ""):gmatch "([^\n]*)\n?" do
    number = number + 1
    local plain = line:gsub("\r$", ""):gsub("#.*", "")
    if plain:find "%S" then
      local first, second, rest = plain:match "^%s*([^,;%s]*)%s*[,;%s]%s*([^,;%s]*)%s*(.*)$"
      local row = {tonumber(first or plain), tonumber(second)}
      local wrong = fault(row, rows[#rows], name)
        or rest ~= "" and "two columns, with decimal points, expected; there is more on the line"
      if wrong and #rows == 0 and not headings and first ~= "" and not tonumber(first) then
        headings = true
      elseif wrong then
        return nil, ("%s: line %d: %s"):format(path, number, wrong),
          {status = "format", file = path, line = number}
      else
        rows[#rows + 1], last = row, number
      end
    end
  end
  if #rows == 0 then
    return nil, ("%s: no row with a %s and a value"):format(path, name), {status = "format", file = path}
  end
  return rows, last
end

--- A function of time, its rows where it has some, and of a file the place of the last one in words; nil, a
--- message and details for a file that cannot be read. Raises, with `what` in front, for what is no history.
function history.read(what, given)
  if type(given) == "function" then return given end
  if finite(given) then return function() return given end end
  local rows, place = given, nil
  if type(given) == "string" then
    local read, more, details = history.rows(given)
    if not read then return nil, more, details end
    rows, place = read, ("%s: line %d"):format(given, more)
  else
    check_rows(what, given)
  end
  return function(time) return interpolate(rows, time) end, rows, place
end

-- The number of the first row behind a time.
local function first_behind(rows, time)
  local low, high = 1, #rows + 1
  while low < high do
    local middle = (low + high) // 2
    if rows[middle][1] > time then high = middle else low = middle + 1 end
  end
  return low
end

--- Ascending times inside of a span where a history is looked at: those of its rows, else an interval apart.
function history.times(rows, from, to, interval)
  local times = {}
  if rows then
    local i = first_behind(rows, from)
    while i <= #rows and rows[i][1] < to do
      times[#times + 1] = rows[i][1]
      i = i + 1
    end
  else
    for i = 1, math.ceil((to - from) / interval - 1e-9) - 1 do times[i] = from + i * interval end
  end
  return times
end

--- The value of such a function at a time, a finite number.
function history.value(what, f, time)
  local value = f(time)
  if not finite(value) then
    raise(("%s must return a finite number, it returned %s at %g s"):format(what, core.got(value), time))
  end
  return value
end

return history
