-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Numbers as people and files see them, and how far two of them, or two lists of them, are apart.
local core = require "barwright.core"

local numbers = {}

--- A figure with so many digits that it can be judged.
function numbers.show(x, digits)
  if type(x) ~= "number" then return tostring(x) end
  if math.type(x) == "integer" then return tostring(x) end
  if x ~= x then return "nan" end
  local a = math.abs(x)
  if a ~= 0 and (a < 1e-3 or a >= 1e5) and a ~= math.huge then
    return (("%%.%de"):format((digits or 6) - 1):format(x):gsub("%.(%d-)0*e", ".%1e"):gsub("%.e", "e"))
  end
  return ("%%.%dg"):format(digits or 6):format(x)
end

--- Two figures with as many digits as it takes to tell them apart.
function numbers.apart(x, y)
  for _, digits in ipairs {6, 9, 12, 17} do
    local a, b = numbers.show(x, digits), numbers.show(y, digits)
    if a ~= b or x == y then return a, b end
  end
  return ("%.17g"):format(x), ("%.17g"):format(y)
end

--- A number as JSON can hold it: what is not finite becomes its name.
function numbers.plain(x)
  if type(x) ~= "number" then return x end
  if x ~= x then return "nan" end
  if x == math.huge then return "inf" end
  if x == -math.huge then return "-inf" end
  return x
end

--- Whether a figure is above a bound; what is not a number is.
function numbers.over(x, bound)
  return x > bound or x ~= x
end

--- The values of a number, an array or a list of numbers (also of rows), one after the other, and how
--- they are shaped; nil for anything else.
function numbers.flat(value, depth)
  if type(value) == "number" then return {value}, "a number" end
  if core.class_name(value) == "array" then
    local rows, columns = value.row_count, value.column_count
    local out = {}
    for _, row in ipairs(value:totable()) do
      if type(row) == "table" then table.move(row, 1, #row, #out + 1, out) else out[#out + 1] = row end
    end
    return out, columns == 1 and ("%d values"):format(rows) or ("%d x %d values"):format(rows, columns)
  end
  depth = depth or 1
  if type(value) ~= "table" or getmetatable(value) or depth > 8 then return nil end
  local out, shape = {}, ("%d values"):format(#value)
  for i, item in ipairs(value) do
    if type(item) == "number" then
      out[#out + 1] = item
    else
      local inner, inner_shape = numbers.flat(item, depth + 1)
      if not inner then return nil end
      table.move(inner, 1, #inner, #out + 1, out)
      if i == 1 then shape = ("%d x %s"):format(#value, inner_shape) end
    end
  end
  local count = 0
  for _ in pairs(value) do count = count + 1 end
  if count ~= #value then return nil end
  return out, shape
end

--- The largest difference of two lists of the same length, the largest magnitude of the second, and
--- where the difference is; a value that is not a number differs by infinity.
function numbers.largest(a, b)
  local max, size, at = 0, 0, 1
  for i = 1, #b do
    local d = math.abs(a[i] - b[i])
    if a[i] == b[i] then d = 0 end
    if d ~= d then d = math.huge end
    if d > max then max, at = d, i end
    local m = math.abs(b[i])
    if m > size then size = m end
  end
  return max, size, at
end

return numbers
